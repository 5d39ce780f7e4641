"""Tables of the sheet of any gear system: derived keys, members at mid face, tools, axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.systems.common.symbol_table import Row, table, tables_of
from gearmesh.systems.system import Sheet, SheetTable
from gearmesh.teeth.blank.moments import member_moments
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.region import Region, Side
from gearmesh.tools.description import ToolDescription

#: title of the table of masses
MASS_TITLE = "Mass and inertia"
#: title of the table of the sections at mid face
MID_FACE_TITLE = "Members at mid face"
#: title of the table of tools
TOOLS_TITLE = "Tools"
#: title of the table of axes
AXES_TITLE = "Axes"


def plain_sheet(design: Design, train: GearTrain) -> Sheet:
    """Return the tables of any gear system: derived keys, diameters of the members, axes of the pairs."""
    derived = tuple((key, "", value) for key, value in design.in_mm().derived_keys())
    return Sheet((SheetTable("Derived keys (lengths in mm)", ("",), derived), *_common_tables(train)), {})


def _common_tables(train: GearTrain) -> tuple[SheetTable, ...]:
    """Return the tables of the sections of all members and of the axes of all pairs."""
    pairs = tuple(f"{p.pinion.name} and {p.gear.name}" for p in train.pairs)
    return tables_of(
        (
            MID_FACE_TITLE,
            lambda: SheetTable(
                MID_FACE_TITLE,
                tuple(train.members),
                _beside([_at_mid_face(member) for member in train.members.values()]),
            ),
        ),
        (AXES_TITLE, lambda: SheetTable(AXES_TITLE, pairs, _beside([_axes(pair) for pair in train.pairs]))),
    )


def member_table(member: Member) -> SheetTable:
    """Return the table of the section of one member at mid face."""
    return SheetTable(MID_FACE_TITLE, (member.name,), _beside([_at_mid_face(member)]))


def mass_table(design: Design, members: Mapping[str, Member]) -> SheetTable:
    """Return the table of mass, centre of gravity and inertia of members, in their own frames."""
    given = all(design.given_density(name) is not None for name in members)
    densities = [design.density(name) for name in members]
    moments = [member_moments(member) for member in members.values()]
    rigid = [
        np.concatenate((own.centre, np.diag(own.about_centre(density)))).tolist()
        for own, density in zip(moments, densities, strict=True)
    ]
    turning = [
        None if member.body.bore_diameter is None else own.about_axis(density)
        for own, density, member in zip(moments, densities, members.values(), strict=True)
    ]
    columns = list(zip(*rigid, strict=True))
    rows: list[Row] = [
        ("rho", "density" if given else "density, by default", "kg/m^3", tuple(densities)),
        ("V", "volume of the whole", "mm^3", tuple(own.volume for own in moments)),
        ("m", "mass", "kg", tuple(own.mass(density) for own, density in zip(moments, densities, strict=True))),
        *((f"{axis}_S", f"centre of gravity, {axis}", "mm", columns[k]) for k, axis in enumerate("xyz")),
        ("J", "moment of inertia about the axis", "kg mm^2", tuple(turning)),
        *(
            (f"J_{axis}", f"moment of inertia about {axis} through the centre of gravity", "kg mm^2", columns[3 + k])
            for k, axis in enumerate("xyz")
        ),
    ]
    return table(MASS_TITLE, tuple(members), rows)


def tool_table(members: Mapping[str, Member]) -> SheetTable:
    """Return the table of the tools of members, with one column for both flanks if their tools are equal."""
    columns: dict[str, ToolDescription] = {}
    for name, member in members.items():
        right, left = (member.one_tooth.side(side).tool for side in Side)
        equal = (right.name, right.dimensions) == (left.name, left.dimensions)
        columns |= (
            {name: right}
            if equal
            else {f"{name}, {side}": tool for side, tool in zip(Side, (right, left), strict=True)}
        )
    tools = [*columns.values()]
    rows: list[Row] = [("tool", "name", "", tuple(tool.name for tool in tools))]
    for symbol, words, unit in dict.fromkeys((d.symbol, d.name, d.unit) for tool in tools for d in tool.dimensions):
        of = [{d.name: d.value for d in tool.dimensions if d.symbol == symbol} for tool in tools]
        rows.append((symbol, words, unit or "-", tuple(values.get(words) for values in of)))
    return table(TOOLS_TITLE, tuple(columns), rows)


def _beside(parts: Sequence[Mapping[tuple[str, str], float | None]]) -> tuple[tuple[Any, ...], ...]:
    """Return rows of item, unit and the value of every part; None if a part has no such item."""
    items = dict.fromkeys(item for part in parts for item in part)
    return tuple((item, unit, *(part.get((item, unit)) for part in parts)) for item, unit in items)


def _at_mid_face(member: Member) -> dict[tuple[str, str], float | None]:
    """Return the figures of a member's section at mid face; diameters are None for a member that slides."""
    tooth = member.one_tooth
    section = tooth.sections([0.5])

    def places(region: Region) -> list[float]:
        """Return the shares of a link that are measured: the ends, or the middle of a land or root that a tool generates."""
        return [0.5] if region in (Region.LAND, Region.ROOT) and tooth.chain[region].generated else [0.0, 1.0]

    at = {
        region: tooth.grid(region, places(region), section).points[:, 0]
        for region in (Region.ROOT, Region.FLANK_RIGHT, Region.FLANK_LEFT, Region.LAND)
    }
    measured = (
        ("tip diameter", "z of the tip", at[Region.LAND]),
        ("root diameter", "z of the root", at[Region.ROOT]),
        ("flank begins at diameter, right", "flank begins at z, right", at[Region.FLANK_RIGHT][:1]),
        ("flank begins at diameter, left", "flank begins at z, left", at[Region.FLANK_LEFT][1:]),
    )
    # the section of a face gear is on a cylinder and has one diameter
    on_cylinder = station_normal(tooth.blank.axial)[1] == 0.0
    diameters = {
        (words, "mm"): None if on_cylinder else tooth.joint.diameter(float(tooth.joint.radius(points).mean()))
        for words, _, points in measured
    }
    toe, heel = member.extent
    width = (section.left.tip_angle - section.right.tip_angle)[0]
    land = float(tooth.joint.arm(at[Region.LAND])[0] * width)
    figures: dict[tuple[str, str], float | None] = {
        ("teeth", "-"): tooth.teeth,
        ("face width", "mm"): heel - toe,
        **diameters,
        ("top land", "mm"): land,
        ("bore diameter", "mm"): tooth.blank.body.bore_diameter,
        ("volume", "mm^3"): member_moments(member).volume if member.features.names else member.plain_volume(),
    }
    if on_cylinder:
        figures |= {("inner diameter of the teeth", "mm"): 2.0 * toe, ("outer diameter of the teeth", "mm"): 2.0 * heel}
        figures |= {(words, "mm"): float(points[:, 2].mean()) for _, words, points in measured}
    return figures


def _axes(pair: GearPair) -> dict[tuple[str, str], float]:
    """Return ratio, shaft angle and distance of a pair's axes."""
    pinion, gear = pair.mounts
    offset, perpendicular = gear.origin - pinion.origin, np.cross(pinion.axis, gear.axis)
    length = np.linalg.norm(perpendicular)
    parallel = bool(length < 1e-12)
    distance = (
        np.linalg.norm(offset - (offset @ pinion.axis) * pinion.axis)
        if parallel
        else abs(offset @ perpendicular) / length
    )
    return {
        ("ratio, arm at rest" if pair.arm_turns else "ratio", "-"): 1.0 / pair.ratio,
        ("shaft angle", "deg"): float(np.degrees(pair.shaft_angle)),
        ("shaft angle (acute)", "deg"): float(np.degrees(pair.acute_angle)),
        ("distance of the axes", "mm"): float(distance),
    }
