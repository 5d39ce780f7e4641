"""Modifications of a member's flanks: from the tables of a design to modified teeth."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.design.modifications import EndRelief, Modifications, Modified, ProfileRelief, TriangularRelief
from gearmesh.design.topography_file import TopographyGrid, read_topography
from gearmesh.errors import DesignError
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry import modification as fields
from gearmesh.teeth.micro_geometry.modification import (
    MAX_AMOUNT_SLOPE,
    Extent,
    FaceEnd,
    FlankField,
    Modification,
    ProfileEnd,
    Topography,
)
from gearmesh.teeth.micro_geometry.modified import TrueFlank, TrueInvolute, modified_side, true_flank
from gearmesh.teeth.micro_geometry.radial_feed import DiskSetting, disk_crowning, worm_crowning
from gearmesh.teeth.region import Side
from gearmesh.teeth.source_parameters import NamedParameters
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide

#: points, across and along a flank, at which the slope of a modification is checked
PROOF_SAMPLES = 33

#: stations of a tooth whose land is proved: both ends of the face and its middle
LAND_STATIONS = np.array([0.0, 0.5, 1.0])

#: key, its amount in mm or its text, and the field of the modification, which is proportional to the amount
Asked = tuple[str, float | str, FlankField]


def with_modifications(
    member: Member, spec: Modified, *, internal: bool = False, reference_radius: float | None = None
) -> Member:
    """Return the member with the flanks that its part `spec` of a design (in mm) asks for.

    `reference_radius`: radius (mm) of the circle on which the tool that crowns the flanks works; None for a member that
    no radial feed crowns. A member without modifications is returned unchanged. Raises DesignError naming key, value
    and what is allowed, and for flanks that are no screw involutes.
    """
    tooth, own = member.tooth, f"{member.name}.modifications"
    tables = {
        Side.RIGHT: {own: spec.modifications, f"{own}_right": spec.modifications_right},
        Side.LEFT: {own: spec.modifications, f"{own}_left": spec.modifications_left},
    }
    if not any(table is not None for side_tables in tables.values() for table in side_tables.values()):
        return member
    flanks = {side: true_flank(tooth, side, internal=internal) for side in tables}
    asked = {side: _asked(tooth, own, flanks[side], reference_radius) for side, own in tables.items()}
    right, left = (_side(tooth, side, asked[side], flanks[side]) for side in tables)
    made = replace(tooth, right=right, left=left)
    try:
        made.prove_land(LAND_STATIONS)
    except TrimError as failure:
        raise _no_land(made, failure, [*asked[Side.RIGHT], *asked[Side.LEFT]]) from failure
    return replace(
        member,
        tooth=made,
        source_parameters=NamedParameters(flanks[Side.RIGHT].parameters, lambda p, v: (p, v)),
        tool_parameters=member.source_parameters,
    )


def with_true_involutes(member: Member, *, internal: bool = False) -> Member:
    """Return the member with its flanks as screw involutes in closed form.

    They take a third of the time of a tool's envelope. Raises DesignError if the flanks are no screw involutes.
    """
    tooth = member.tooth
    right, left = (
        modified_side(tooth, side, TrueInvolute.of(tooth, side, internal=internal), None)
        for side in (Side.RIGHT, Side.LEFT)
    )
    return replace(
        member,
        tooth=replace(tooth, right=right, left=left),
        source_parameters=NamedParameters(TrueInvolute.PARAMETERS, lambda p, v: (p, v)),
        tool_parameters=member.source_parameters,
    )


def _asked(
    tooth: Tooth, tables: dict[str, Modifications | None], true: TrueFlank, reference_radius: float | None
) -> list[Asked]:
    """Return the modifications that the tables of one side ask for."""
    given = [(name, table) for name, table in tables.items() if table is not None]
    return [entry for name, table in given for entry in _fields(name, table, tooth, true, reference_radius)]


def _side(tooth: Tooth, which: Side, asked: list[Asked], true: TrueFlank) -> ToothSide:
    """Return one side of the tooth with the modifications that are asked for."""
    for key, value, field in asked:
        _prove(key, value, field, true.extent)
    made = Modification(tuple(field for _, _, field in asked), true.extent) if asked else None
    return modified_side(tooth, which, true, made)


def _no_land(tooth: Tooth, failure: TrimError, asked: list[Asked]) -> DesignError:
    """Return the refusal of a tooth that has no land with its modifications; it names the largest amount."""
    key, value, _ = max(asked, key=lambda entry: abs(entry[1]) if isinstance(entry[1], float) else 0.0)
    return DesignError(
        key,
        value,
        unit="mm" if isinstance(value, float) else "",
        reason=f"{failure.reason} at z = {tooth.stations(failure.station):.4g} mm with this flank",
        allowed="a smaller amount, or a lower tip",
    )


def _fields(
    name: str, table: Modifications, tooth: Tooth, true: TrueFlank, reference_radius: float | None
) -> Iterator[Asked]:
    """Yield the modifications that a table, called `name`, asks for."""
    e = true.extent
    helix_crowning = _crowning_by_tool(name, table, tooth, true, reference_radius)
    for key, make in (
        ("profile_crowning", fields.profile_crowning),
        ("profile_slope", fields.profile_slope),
        ("profile_twist", fields.profile_twist),
        ("helix_crowning", helix_crowning),
        ("helix_slope", fields.helix_slope),
    ):
        amount = getattr(table, key)
        if amount:
            yield f"{name}.{key}", float(amount), make(amount, e)
    reliefs: dict[ProfileEnd, ProfileRelief | None] = {"tip": table.tip_relief, "root": table.root_relief}
    for end, relief in reliefs.items():
        if relief is not None:
            yield _profile_relief(f"{name}.{end}_relief", relief, true, end)
    ends: dict[FaceEnd, EndRelief | None] = {"toe": table.end_relief_toe, "heel": table.end_relief_heel}
    for face, at_end in ends.items():
        if at_end is not None:
            yield _end_relief(f"{name}.end_relief_{face}", at_end, e, face)
    corners: dict[ProfileEnd, TriangularRelief | None] = {
        "tip": table.triangular_end_relief_tip,
        "root": table.triangular_end_relief_root,
    }
    for end, corner in corners.items():
        if corner is not None:
            yield _triangular(f"{name}.triangular_end_relief_{end}", corner, true, end)
    if table.topography is not None:
        key = f"{name}.topography"
        yield key, f'"{table.topography}"', _topography(key, read_topography(Path(table.topography)), true)


def _crowning_by_tool(
    name: str, table: Modifications, tooth: Tooth, true: TrueFlank, reference_radius: float | None
) -> Callable[[float, Extent], FlankField]:
    """Return the function that makes the helix crowning of a table, called `name`, as its tool makes it."""
    tool = table.crowning_tool
    if tool == "none":
        return fields.helix_crowning
    if reference_radius is None or not isinstance(true, TrueInvolute):
        raise DesignError(
            f"{name}.crowning_tool",
            tool,
            reason="racks and conical gears are not crowned by a radial feed here",
            allowed='"none"',
        )
    if tool == "worm":
        if true.involute.internal:
            raise DesignError(
                f"{name}.crowning_tool",
                tool,
                reason="no hob or threaded wheel fits into a ring",
                allowed='"disk" or "none"',
            )
        return partial(worm_crowning, involute=true.involute, reference_radius=reference_radius)
    assert table.crowning_disk_diameter is not None
    setting = DiskSetting(tooth.teeth, reference_radius, 0.5 * table.crowning_disk_diameter)
    return partial(disk_crowning, key=f"{name}.crowning_disk_diameter", involute=true.involute, setting=setting)


def _profile_relief(key: str, table: ProfileRelief, true: TrueFlank, end: ProfileEnd) -> Asked:
    """Return the relief of tip or root, from its start to the end of the flank."""
    e = true.extent
    low, high = sorted((e.root, e.tip))
    name, given = table.start
    place, start_key = true.places.get(name), f"{key}.start_{name}"
    if place is None:
        others = " or ".join(f"{key}.start_{other}" for other in sorted(true.places))
        raise DesignError(start_key, given, unit="mm", reason="this flank has none", allowed=others)
    start = place(given)
    if not low < start < high:
        bounds = [true.length_of(name, end) for end in (low, high)]
        raise DesignError(
            start_key,
            given,
            unit="mm",
            allowed=f"between the flank's own ends, above {at_least(bounds[0])} and below {at_most(bounds[1])} mm",
        )
    make = fields.tip_relief if end == "tip" else fields.root_relief
    return f"{key}.amount", float(table.amount), make(table.amount, start, e, _shape(table.shape))


def _end_relief(key: str, table: EndRelief, e: Extent, end: FaceEnd) -> Asked:
    """Return the relief of an end of the face."""
    _check_length(key, table.length, e)
    field = fields.end_relief(table.amount, table.length, e, end, _shape(table.shape))
    return f"{key}.amount", float(table.amount), field


def _triangular(key: str, table: TriangularRelief, true: TrueFlank, end: ProfileEnd) -> Asked:
    """Return the triangular relief of a corner between an end of the face and tip or root."""
    _check_length(key, table.length, true.extent)
    if abs(true.lean) < 1e-9:
        raise DesignError(key, reason="contact lines of spur gears have no such corner; allowed on helical teeth only")
    field = fields.triangular_end_relief(table.amount, table.length, true.extent, true.lean, end)
    return f"{key}.amount", float(table.amount), field


def _check_length(key: str, length: float, e: Extent) -> None:
    """Refuse a length not below the face width."""
    width = abs(e.heel - e.toe)
    if length >= width:
        raise DesignError(f"{key}.length", length, unit="mm", allowed=Allowed.less_than(width, "mm", "the face width"))


def _shape(name: str) -> fields.Shape:
    """Return the shape of this name."""
    return next(shape for shape in fields.RELIEF_SHAPES if shape == name)


def _topography(key: str, grid: TopographyGrid, true: TrueFlank) -> FlankField:
    """Return the modification of a topography file."""
    name = "diameter" if grid.diameters else "roll_length"
    place = true.places.get(name)
    if place is None:
        raise DesignError(key, reason=f"this flank has no {name.replace('_', ' ')}s; a rack takes no topography")
    lengths = tuple(place(across) for across in grid.across)
    if not np.isfinite(lengths).all():
        raise DesignError(
            key,
            reason=f"diameter_mm = {grid.across[0]:g}: allowed is from the base circle on, "
            f"{at_least(true.length_of(name, 0.0))} mm",
        )
    return Topography(lengths, grid.z, grid.amounts)


def _prove(key: str, value: float | str, field: FlankField, e: Extent) -> None:
    """Refuse a modification so steep that the flank would bend back."""
    length, z = np.meshgrid(np.linspace(e.root, e.tip, PROOF_SAMPLES), np.linspace(e.toe, e.heel, PROOF_SAMPLES))
    jet = field.jet(length, z)
    steepest = float(max(np.abs(jet.a_l).max(), np.abs(jet.a_z).max()))
    if steepest <= MAX_AMOUNT_SLOPE:
        return
    reason, remedy = f"the flank would get a slope of {steepest:.3g} mm/mm", "a smaller amount or a greater length"
    if isinstance(value, str):
        raise DesignError(key, value, reason=f"{reason}, above {MAX_AMOUNT_SLOPE:g} mm/mm", allowed=remedy)
    bound = value * MAX_AMOUNT_SLOPE / steepest
    allowed = Allowed.at_most(bound) if value > 0.0 else Allowed.at_least(bound)
    raise DesignError(
        key,
        value,
        unit="mm",
        reason=f"{reason}, above {MAX_AMOUNT_SLOPE:g} mm/mm",
        allowed=f"{allowed} mm, or a greater length",
    )
