"""The data sheet of a pinion and a rack: symbols, words, units and values of ISO 21771-1, as for a cylindrical pair.

Lengths are in mm, angles in deg. Start and end of flanks are taken from the teeth as built. All else is closed form,
except the pinion's root and the masses. Heights of the rack are over its reference plane. Assembly errors are
neglected.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.racks.rack_tooth import tip_rounding
from gearmesh.systems.common.symbol_table import (
    Missing,
    Row,
    columns_of,
    table,
    tables_by_title,
    tables_of,
)
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.allowances import allowances_of
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, flank_sides, mean_of
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction, SetBackFillet, set_back_fillet
from gearmesh.systems.cylindrical.geometry.measures import STANDARD_DIAMETERS_MM
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import GearProportions, tool_rounding
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.member import RackMesh
from gearmesh.systems.cylindrical.rack.proportions import RackPairProportions, rack_proportions, with_allowances
from gearmesh.systems.cylindrical.sheet import (
    SheetPair,
    contact_tables,
    half_tables,
    member_tables,
    normal_backlash_rows,
    side_suffixes,
    side_tables,
)
from gearmesh.systems.system import Reserve, Sheet, SheetTable, complete_design
from gearmesh.teeth.blank.moments import M3_PER_MM3
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.region import FLANK_REGIONS, Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.allowance_keys import ThicknessAllowance
    from gearmesh.systems.cylindrical.rack.design import RackDesign, RackKeys


#: value of a pin where no pin fits
NO_PIN = Missing("no standard pin touches the flanks, stands out of the space and clears its ground")


@dataclass(frozen=True)
class RackAction(LineOfAction):
    """The line of action of a pinion and a rack.

    The usable flank of the rack is given by the roll lengths at which the pinion meets it.
    """

    def pinion_length(self, length: float) -> float:
        return length

    def interference_reserve(self, number: int) -> float:
        own, mating = self.flanks
        # roll lengths fall towards the rack's tip
        return mating[1] - own[0] if number == 0 else mating[0] - own[1]

    def clearing_tip(self, number: int, name: str) -> str:
        pinion = self.mesh.pinion
        if number == 0:
            lower = -self.interference_reserve(0) * math.sin(pinion.alpha_t) / pinion.module
            return f"{name}.addendum smaller by at least {at_least(lower)}"
        return f"{name}.tip_diameter at most {at_most(2.0 * math.hypot(pinion.base_radius, self.flanks[1][0]))} mm"


@dataclass(frozen=True)
class RackSheetPair(SheetPair):
    """The pair whose pinion meshes with a rack, and this mesh; figures of the other gear have no meaning."""

    rack_mesh: RackMesh
    rack: Member

    def _line(self, number: int, mesh: InvolutePair) -> LineOfAction:
        root, tip = (mesh.pinion.roll_length(rho) for rho in self.side_flanks[0][number])
        with_rack, side = self.rack_mesh.sides[number], flank_sides(self.teeth[0])[number]
        low, high = (with_rack.roll_length_at(height) for height in rack_flank(self.rack, side))
        return RackAction(mesh, ((root, tip), (low, high)), self._where(number))

    def fed_rounding(self, k: int, gear: GearProportions) -> float:
        # the tool's own rounding leaves the flank that the rack's tips need
        return min(gear.spec.tool_tip_radius, tool_rounding(gear))

    def set_back_fillets(self, number: int) -> list[SetBackFillet | None]:
        gear = self.geometry.gears[0]
        return [set_back_fillet(gear, flank_sides(gear.own)[number]), None]


def rack_flank(rack: Member, side: Side = Side.RIGHT) -> tuple[float, float]:
    """Return the heights (mm) over the reference plane between which a rack has flank."""
    tooth = rack.tooth
    heights = tooth.grid(FLANK_REGIONS[side], np.array([0.0, 1.0]), tooth.sections([0.5])).points[:, 0, 0]
    low, high = heights[:: 1 if side is Side.RIGHT else -1]
    return float(low), float(high)


def rack_reserves(design: RackDesign, train: GearTrain) -> tuple[Reserve, ...]:
    """Return the reserves of pinion and rack against interference of their teeth."""
    own = half_of(complete_design(design).in_mm())
    return _sheet_pair(own, rack_proportions(own), train).interference_reserves(0, (PINION_NAME, RACK_NAME))


def _sheet_pair(own: RackDesign, geometry: RackPairProportions, train: GearTrain) -> RackSheetPair:
    """Return the pair of a complete design in mm and the gear set built from it."""
    pinion, rack = train.members[PINION_NAME], train.members[RACK_NAME]
    # the pair has only the keys that shape the pinion's teeth
    pair = geometry.pair.model_copy(update={"accuracy_class": own.accuracy_class, "material": own.material})
    stated = own.pinion, None
    return RackSheetPair(pair, geometry.of_pair, (pinion, pinion), geometry.mesh, rack, stated=stated)


def rack_sheet(design: RackDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design of pinion and rack and the gear set built from it."""
    whole = complete_design(design).in_mm()
    own = half_of(whole)
    geometry = rack_proportions(own)
    # the table of axes has no meaning for a rack
    derived, plain, _ = plain_sheet(whole, train).tables
    rack, sheet = train.members[RACK_NAME], _sheet_pair(own, geometry, train)
    numbers = sheet.side_numbers
    members, measures, *others = (_of_pinion(of_both, len(numbers)) for of_both in member_tables(sheet))
    return Sheet(
        (
            derived,
            *half_tables(whole, (train.members[PINION_NAME], rack)),
            *tables_of(
                ("Pair", lambda: side_tables("Pair", [_mesh_rows(sheet, number) for number in numbers])),
                ("Backlash", lambda: table("Backlash", *_backlash(own, geometry))),
            ),
            _with_clearance(members, geometry.mesh.root_clearance),
            measures,
            *contact_tables(sheet, (PINION_NAME, RACK_NAME), lambda number: _contact_rows(sheet, number)),
            *others,
            *tables_by_title({"Rack": ((RACK_NAME,), lambda: rack_rows(own, geometry.mesh, rack, geometry.root))}),
            plain,
        ),
        {},
        warnings=sheet.fillet_interference((PINION_NAME, RACK_NAME)),
    )


def _of_pinion(of: SheetTable, sides: int) -> SheetTable:
    """Return the columns of the pinion: one, or one for each side of its teeth."""
    count = sides if len(of.columns) > len(MEMBER_NAMES) else 1
    return replace(columns_of(of, range(count)), title=f"Pinion: {of.title}")


def _with_clearance(members: SheetTable, clearance: float) -> SheetTable:
    """Return the pinion's table with its clearance to the rack's root."""
    rows = [
        (*row[:2], clearance) if symbol == "c" else row
        for symbol, row in zip(members.symbols, members.rows, strict=True)
    ]
    return replace(members, rows=tuple(rows))


def _mesh_rows(pair: RackSheetPair, number: int) -> list[Row]:
    """Return the rows of the mesh of one side."""
    mesh = pair.rack_mesh.sides[number]
    own = mesh.pinion
    ratio, overlap = pair.lines[number].contact_ratio, _overlap_ratio(pair)
    values = (
        ("m_n", "normal module", "mm", own.module),
        ("m_t", "transverse module", "mm", own.transverse_module),
        ("alpha_n", "normal pressure angle", "deg", math.degrees(own.alpha)),
        ("alpha_t", "transverse pressure angle, and the working one", "deg", math.degrees(own.alpha_t)),
        ("beta", "helix angle", "deg", math.degrees(abs(own.beta))),
        ("beta_b", "base helix angle", "deg", math.degrees(abs(own.beta_b))),
        ("p_n", "normal pitch", "mm", math.pi * own.module),
        ("p_t", "transverse pitch, along the rack", "mm", mesh.pitch),
        ("p_et", "transverse base pitch", "mm", own.base_pitch),
        ("s_1", "travel of the rack per turn of the pinion", "mm", mesh.travel),
        ("s_u", "travel over which all tooth pairs can be in contact", "mm", _full_way(mesh, ratio + overlap)),
        ("a_M", "mounting distance: axis to the back of the bar", "mm", mesh.mounting_distance),
        ("a_0", "distance from the axis to the reference plane", "mm", mesh.distance),
        ("eps_alpha", "transverse contact ratio", "-", ratio),
        ("eps_beta", "overlap ratio", "-", overlap),
        ("eps_gamma", "total contact ratio", "-", ratio + overlap),
    )
    return [(symbol, words, unit, (value,)) for symbol, words, unit, value in values]


def _overlap_ratio(pair: RackSheetPair) -> float:
    """Return the overlap ratio of the common face width."""
    own, width = pair.rack_mesh.pinion, min(pair.specs[0].face_width, pair.rack_mesh.rack.face_width)
    return width * abs(math.sin(own.beta)) / (math.pi * own.module)


def _full_way(mesh: RackMesh, ratio: float) -> float:
    """Return the travel over which all tooth pairs can be in contact.

    It lasts from where the first tooth pair could replace a preceding one to the same point of the last pair.
    """
    return max(0.0, mesh.rack.teeth + 1.0 - ratio) * mesh.pitch


def _backlash(design: RackDesign, geometry: RackPairProportions) -> tuple[tuple[str, ...], list[Row]]:
    """Return columns and rows of the backlash.

    Columns: nominal teeth, teeth as made, and the ends of the thickness allowances, if there are any.
    """
    meshes = {"theoretical": geometry.nominal, "working": geometry.mesh}
    given = [allowances_of(name, getattr(design, name), geometry.nominal.pinion) for name in (PINION_NAME, RACK_NAME)]
    if any(allowance is not None and allowance.lower != allowance.upper for allowance in given):
        made = geometry.mesh.pinion.allowance, geometry.mesh.rack.allowance
        for column, end in (("least", "upper"), ("largest", "lower")):
            first, second = (
                own if allowance is None else getattr(allowance, end)
                for own, allowance in zip(made, given, strict=True)
            )
            meshes[column] = with_allowances(geometry.mesh, first, second)

    def row(symbol: str, words: str, value: Callable[[RackMesh], float]) -> Row:
        return symbol, words, "mm", tuple(value(mesh) for mesh in meshes.values())

    return tuple(meshes), [
        row("j_wt", "along the rack", lambda mesh: mesh.circumferential_backlash),
        *normal_backlash_rows([mesh.normal_backlashes for mesh in meshes.values()]),
        row("j_r", "radial: change of the mounting distance that eliminates it", lambda mesh: mesh.radial_backlash),
    ]


def _contact_rows(pair: RackSheetPair, number: int) -> list[Row]:
    """Return the rows of the points A to E of one side."""
    mesh = pair.rack_mesh.sides[number]
    base = mesh.pinion.base_radius
    rows: list[Row] = []
    for where, length in pair.lines[number].points.items():
        rows += [
            (f"d_{where}", f"diameter at {where}", "mm", (2.0 * math.hypot(base, length), None)),
            (f"h_{where}", f"height at {where}", "mm", (None, mesh.rack_height(length))),
            (f"xi_{where}", f"roll angle at {where}", "deg", (math.degrees(length / base), None)),
            (f"zeta_{where}", f"specific sliding at {where}", "-", mesh.sliding(length)),
        ]
    return rows


def rack_rows(design: RackKeys, mesh: RackMesh, member: Member, root: float | None = None) -> list[Row]:
    """Return the rows of the rack of a design.

    `root`: root radius of its pinion, for the clearance; None for a rack alone.
    """
    rack, m = mesh.rack, mesh.pinion.module
    flanks = [rack_flank(member, side) for side in flank_sides(mesh.pinion)]
    pin = pin_diameter(mesh, flanks)
    over = NO_PIN if pin is None else over_pin(mesh, pin)
    density = design.density(member.name)
    volume = member.plain_volume()
    helix = mesh.pinion.beta
    values: tuple[tuple[str, str, str, float | int | str | Missing | None], ...] = (
        ("z", "teeth", "-", rack.teeth),
        (
            "hand",
            "hand of the traces, as of a gear",
            "",
            "spur" if helix == 0.0 else "left" if helix > 0.0 else "right",
        ),
        ("L", "length", "mm", mesh.length),
        ("L_e", "of it beyond the teeth, at either end", "mm", rack.overhang),
        (*member.rows.face_width, "mm", rack.face_width),
        ("H", "height from the back to the tips", "mm", rack.height),
        ("H_0", "height of the reference plane over the back", "mm", mesh.pitch_height),
        ("h_a", "addendum", "mm", rack.addendum * m),
        ("h_f", "dedendum", "mm", rack.dedendum * m),
        ("h", "tooth depth", "mm", (rack.addendum + rack.dedendum) * m),
        *(
            (f"h_Ff{which}", f"height at which the flank begins, negative below the reference plane{words}", "mm", low)
            for (which, words), (low, _) in zip(side_suffixes(mesh.pinion), flanks, strict=True)
        ),
        *(
            (
                f"rho_f{which}",
                f"radius of the root fillets, normal{words}",
                "mm",
                m * tip_rounding(rack, coast=coast).modules,
            )
            for (which, words), coast in zip(side_suffixes(mesh.pinion), (False, True), strict=False)
        ),
        *([] if root is None else [_clearance(mesh, root)]),
        ("A_sn", "allowance of the normal thickness, as made", "mm", rack.allowance),
        *_thickness_allowances(design.rack.thickness_allowance),
        ("s_n", "normal thickness on the reference plane", "mm", mesh.rack_thickness),
        ("s_t", "transverse thickness on the reference plane", "mm", mesh.rack_thickness / math.cos(helix)),
        ("s_an", "normal thickness at the tip", "mm", mesh.rack_land),
        ("D_M", "pin", "mm", NO_PIN if pin is None else pin),
        ("M_r", "from the back over the pin in a space", "mm", over),
        ("rho", "density", "kg/m^3", density),
        ("V", "volume", "mm^3", volume),
        ("m", "mass", "kg", volume * M3_PER_MM3 * density),
    )
    return [(symbol, words, unit, (value,)) for symbol, words, unit, value in values]


def _clearance(mesh: RackMesh, root: float) -> tuple[str, str, str, float]:
    """Return the row of the clearance between the rack's tip and the pinion's root."""
    own = mesh.distance - mesh.rack.addendum * mesh.pinion.module - root
    return "c", "clearance of its tip and the pinion's root", "mm", own


def _thickness_allowances(given: ThicknessAllowance | None) -> list[tuple[str, str, str, float]]:
    """Return the rows of the ends of a rack's thickness allowance; none if it has no allowance."""
    if given is None:
        return []
    return [
        ("A_sne", "upper allowance of the normal thickness", "mm", given.upper),
        ("A_sni", "lower allowance of the normal thickness", "mm", given.lower),
        ("T_sn", "tolerance of the normal thickness", "mm", given.upper - given.lower),
    ]


def pin_height(mesh: RackMesh, diameter: float) -> float:
    """Return the height over the reference plane of the centre of a pin that touches both flanks of a space.

    D_M / cos(alpha_n) = e_n + 2 h tan(alpha_n); asymmetric teeth have the means of both sides.
    """
    space = math.pi * mesh.pinion.module - mesh.rack_thickness
    needed = mean_of([diameter / math.cos(side.alpha) for side in mesh.pinion.sides])
    return (needed - space) / mesh.pinion.both_tangents


def over_pin(mesh: RackMesh, diameter: float) -> float:
    """Return the dimension from the back of the bar over a pin in a space."""
    return mesh.pitch_height + pin_height(mesh, diameter) + 0.5 * diameter


def pin_diameter(mesh: RackMesh, flanks: Sequence[tuple[float, float]]) -> float | None:
    """Return the standard pin that touches the flanks nearest to the reference plane; None if none fits.

    The pin stands out of the space and clears its ground. `flanks`: heights of the ends of the flanks of each side; the
    drive side of asymmetric teeth is touched nearest.
    """

    def touches(diameter: float) -> list[float]:
        return [pin_height(mesh, diameter) - 0.5 * diameter * math.sin(side.alpha) for side in mesh.pinion.sides]

    def fits(diameter: float) -> bool:
        middle, half = pin_height(mesh, diameter), 0.5 * diameter
        root = -mesh.rack.dedendum * mesh.pinion.module
        on_flanks = all(low < at < high for at, (low, high) in zip(touches(diameter), flanks, strict=True))
        return on_flanks and middle + half > flanks[0][1] and middle - half > root

    return min(
        (size for size in STANDARD_DIAMETERS_MM if fits(size)), key=lambda size: abs(touches(size)[0]), default=None
    )
