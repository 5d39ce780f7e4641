"""The data sheet of a cylindrical pair: symbols, words, units and values of ISO 21771-1, for both members.

Lengths are in mm, angles in deg. All are positive except the number of teeth, which is negative for an internal member.
Start and end of flanks are taken from the teeth as built, including undercut and broken edges. All else is closed form
(see `geometry`, `measures`, `line_of_action`), except the root (`root`) and the masses (`mass`). Assembly errors are
neglected.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.metrology.iso1328 import TOLERANCE_NAMES
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.racks.rack_tooth import tip_rounding
from gearmesh.systems.common.standards.iso286 import Deviations
from gearmesh.systems.common.symbol_table import (
    Missing,
    Row,
    Values,
    attempt,
    side_by_side,
    table,
    tables_by_title,
    tables_of,
    values_of,
)
from gearmesh.systems.cylindrical.cutting.run_out import tool_radius
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.double_helical import gap_heights, half_of, half_width
from gearmesh.systems.cylindrical.geometry import measures
from gearmesh.systems.cylindrical.geometry.accuracy import tolerance_sizes
from gearmesh.systems.cylindrical.geometry.allowances import Allowances, allowances_of
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, both_flanks, flank_sides
from gearmesh.systems.cylindrical.geometry.interference import Reserves, reserves
from gearmesh.systems.cylindrical.geometry.line_of_action import (
    Flank,
    LineOfAction,
    SetBackFillet,
    form_roll_length,
    set_back_fillet,
    tight_distance,
    undercut_reserve,
)
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.nominal_stress import NominalFactors, nominal_factors
from gearmesh.systems.cylindrical.geometry.proportions import (
    GearProportions,
    GearsProportions,
    PairProportions,
    gear_proportions,
    proportions,
    rounding_in_mesh,
    tool_rounding,
)
from gearmesh.systems.cylindrical.geometry.root import CriticalSection, critical_section, lever
from gearmesh.systems.cylindrical.measured import flanks_of
from gearmesh.systems.system import Reserve, Sheet, SheetTable, complete_design
from gearmesh.teeth.blank.moments import member_moments
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.micro_geometry.modified import modification_of
from gearmesh.teeth.micro_geometry.radial_feed import FedCrowning, twist_of
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import (
        CylindricalDesign,
        CylindricalKeys,
        CylindricalMember,
        HalvesKeys,
        Hob,
    )

#: title of the table of basic racks
BASIC_RACK_TITLE = "Basic rack"
#: title of the table of both sides of asymmetric teeth
SIDES_TITLE = "Sides of asymmetric teeth"
#: words for the sides of asymmetric teeth, by number
SIDE_WORDS = ("drive", "coast")
#: symbols and words of the normal backlash of asymmetric teeth
NORMAL_BACKLASH_ROWS = ("j_bn", "normal, of the drive side"), ("j_bn_coast", "normal, of the coast side")
#: symbols of rows of a mesh that differ on both sides of asymmetric teeth
SIDE_SYMBOLS = frozenset(("alpha_n", "alpha_t", "alpha_wt", "beta_b", "p_et", "eps_alpha", "eps_gamma", "s_u"))
#: symbols of rows of members that asymmetric teeth have in the table of their sides
FLANK_SYMBOLS = frozenset(("d_b", "d_Ff", "d_Nf", "d_Fa", "d_Na"))
#: shorter run-outs are rounding
LEAST_RUN_OUT_MM = 1e-9
#: largest difference of a proportion of a standard basic rack
BASIC_RACK_TOLERANCE_MODULES = 1e-9
#: reasons of missing values
UNDERCUT_REASON = "the tool undercuts the flank"
NO_SPAN = "no number of teeth has a span that touches the flank within the face width"
HOLLOW_FLANKS = "flat anvils cannot touch the hollow flanks of a helical internal gear; measure between balls, M_dK"
PIN_ENDS = "a straight pin touches a helical internal space at its ends; measure between balls, M_dK"
NEVER_NEAR = "the tips never come near each other"
LARGER_THAN_HOLE = "the pinion is larger than the hole of the ring and goes in from its end alone"
NARROW_FACE = "the face is narrower than {:.4g} mm, the distance along the axis of the points that it touches"
NARROW_FOR_PINS = (
    "the face is narrower than {:.4g} mm, over which pins of an odd number of teeth slide to stand opposite"
)
NO_BALL = "no ball or pin touches the flank, stands out of the space and clears its ground"
NO_TANGENT = "no tangent of the fillet has that angle"
OFF_FLANK = "its ends are not on the flank"
NO_ASYMMETRIC_CHORD = "a rack touches the flanks of asymmetric teeth at two heights"
NO_ASYMMETRIC_SECTION = "ISO 6336-3 has the critical section of symmetric teeth only"


def data_sheet(design: CylindricalDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a cylindrical design and the gear set built from it.

    It contains the tables that every system has.
    """
    own = complete_design(design).in_mm()
    derived, *plain = plain_sheet(own, train).tables
    pair = _sheet_pair(own, train)
    warnings = pair.fillet_interference(MEMBER_NAMES)
    return Sheet((derived, *half_tables(own, pair.members), *pair_tables(pair), *plain), {}, warnings=warnings)


def pair_reserves(design: CylindricalDesign, train: GearTrain) -> tuple[Reserve, ...]:
    """Return the reserves of a pair against interference of its teeth."""
    return _sheet_pair(complete_design(design).in_mm(), train).interference_reserves(0, MEMBER_NAMES)


def _sheet_pair(own: CylindricalDesign, train: GearTrain) -> SheetPair:
    """Return the pair of a complete design in mm and the gear set built from it."""
    return pair_of_members(own, tuple(train.members[name] for name in MEMBER_NAMES))


def pair_of_members(own: CylindricalDesign, members: tuple[Member, ...]) -> SheetPair:
    """Return the pair of a complete design in mm and its pinion and gear as built."""
    half = half_of(own)
    return SheetPair(half, proportions(half), members)


def pair_factors(design: CylindricalDesign, pair: GearPair) -> NominalFactors | None:
    """Return the factors of the nominal stresses of a pair [ISO 6336-2, -3]; None for asymmetric teeth and gears apart."""
    return factors_of(pair_of_members(complete_design(design).in_mm(), pair.both), pair)


def factors_of(known: SheetPair, pair: GearPair) -> NominalFactors | None:
    """Return the factors of the nominal stresses of a mesh; None for asymmetric teeth and gears apart."""
    if known.asymmetric or not known.overlap > 0.0 or not known.line.contact_ratio > 0.0:
        return None
    first, second = (
        critical_section(member.tooth, teeth) for member, teeth in zip(known.members, known.teeth, strict=True)
    )
    return nominal_factors(known.line, (first, second), known.overlap, len(pair.halves))


def half_tables(design: HalvesKeys, members: tuple[Member, ...]) -> list[SheetTable]:
    """Return the table of both halves together; empty for gears that are not double helical."""
    if not design.double_helical:
        return []
    specs = tuple(design.specs.values())
    gaps = [next(iter(member.gaps), None) for member in members]
    bars = [member.tooth.joint.travel is not None for member in members]
    rows: list[Row] = [
        ("b", "face width, 2 b_B and the gap", "mm", tuple(spec.face_width for spec in specs)),
        ("b_B", "face width of one half", "mm", tuple(half_width(design, spec) for spec in specs)),
        ("gap", "width of the gap", "mm", tuple(design.gap for _ in specs)),
        (
            "d_gap",
            "diameter of the gap",
            "mm",
            tuple(None if bar or gap is None else gap.diameter for bar, gap in zip(bars, gaps, strict=True)),
        ),
    ]
    if any(bars):
        heights = tuple(
            next(iter(gap_heights(member)), None) if bar else None for member, bar in zip(members, bars, strict=True)
        )
        rows.append(("H_gap", "height of the gap's floor over the back", "mm", heights))
    return [table("Double helical", tuple(design.specs), rows)]


def pair_tables(pair: SheetPair, names: tuple[str, str] = MEMBER_NAMES) -> tuple[SheetTable, ...]:
    """Return the tables of a pair; `names` are the names of its pinion and gear."""
    own, thickness, *others = member_tables(pair, names)
    of_mesh = tables_of(
        ("Pair", lambda: side_tables("Pair", [_mesh_rows(pair, number) for number in pair.side_numbers])),
        ("Backlash", lambda: table("Backlash", *_backlash(pair))),
    )
    of_contact = contact_tables(pair, names, lambda number: _contact_rows(pair, number))
    return (*of_mesh, own, thickness, *of_contact, *others)


def contact_tables(
    pair: SheetPair, names: tuple[str, str], rows: Callable[[int], Sequence[Row]]
) -> tuple[SheetTable, ...]:
    """Return the table of the points A to E, with columns of both members for each side of the teeth.

    `rows`: returns the rows of a side by its number.
    """
    numbers = pair.side_numbers
    columns = tuple(name for number in numbers for name in _side_columns(pair, names)[number :: len(numbers)])
    return tables_by_title({"Contact from A to E": (columns, lambda: side_by_side([rows(k) for k in numbers]))})


def side_tables(title: str, rows: Sequence[Sequence[Row]]) -> tuple[SheetTable, ...]:
    """Return the table of rows of each side of a pair or gear, or both tables of asymmetric teeth.

    The second table has the rows that differ on both sides, with a column for each.
    """
    first = rows[0]
    if len(rows) == 1:
        return (table(title, ("",), first),)
    columns = tuple(f"{word} side" for word in SIDE_WORDS)
    of_sides = [row for row in side_by_side(rows) if row[0] in SIDE_SYMBOLS]
    whole = [row for row in first if row[0] not in SIDE_SYMBOLS]
    return table(title, ("",), whole), table(f"{title}, both sides", columns, of_sides)


def member_tables(pair: SheetGears, names: tuple[str, ...] = MEMBER_NAMES) -> tuple[SheetTable, ...]:
    """Return the tables with one column per member.

    They are members, measures, root, reserves, bodies and tolerances. Rows that depend on a mesh are left out for gears
    that do not mesh.
    """
    sides = {SIDES_TITLE: (_side_columns(pair, names), lambda: _side_rows(pair))} if pair.asymmetric else {}
    return tables_by_title(
        {
            "Members": (names, lambda: _member_rows(pair)),
            **sides,
            "Measures of the tooth thickness": (names, lambda: _measures(pair)),
            "As cut by feeding the tool for the allowance": (names, lambda: _cut_rows(pair)),
            BASIC_RACK_TITLE: (names, lambda: _basic_rack_rows(pair)),
            "Root: tangent of 30 deg, internal 60 deg": (names, lambda: _root_rows(pair)),
            "Reserves (negative: none)": (_side_columns(pair, names), lambda: _reserves(pair)),
            "Bodies": (names, lambda: _bodies(pair)),
            "Flank tolerances [ISO 1328-1:2013]": (names, lambda: _tolerances(pair)),
        }
    )


@dataclass(frozen=True)
class SheetGears:
    """A complete design in mm, its gears in closed form and as built: one gear, or pinion and gear of a mesh."""

    #: the design
    design: CylindricalKeys
    #: proportions of the gears
    geometry: GearsProportions
    #: gears as built
    members: tuple[Member, ...]
    #: tables that give the thicknesses of the members, if the design only repeats their results
    stated: tuple[CylindricalMember | None, ...] | None = field(default=None, kw_only=True)

    @property
    def teeth(self) -> tuple[Toothing, ...]:
        """Teeth of all gears."""
        return tuple(gear.own for gear in self.geometry.gears)

    @property
    def specs(self) -> tuple[CylindricalMember, ...]:
        """Tables of all gears."""
        return tuple(gear.spec for gear in self.geometry.gears)

    @cached_property
    def side_flanks(self) -> tuple[tuple[Flank, ...], ...]:
        """Radii d_Ff / 2 and d_Fa / 2 at which the usable flanks begin and end, of every member and each of its sides.

        They are those in the middle of the face.
        """
        return tuple(flanks_of(own, member) for own, member in zip(self.teeth, self.members, strict=True))

    @property
    def flanks(self) -> tuple[Flank, ...]:
        """Radii d_Ff / 2 and d_Fa / 2 of the drive side of every member."""
        return tuple(sides[0] for sides in self.side_flanks)

    @property
    def asymmetric(self) -> bool:
        """True if drive and coast side have different pressure angles."""
        return self.teeth[0].asymmetric

    def of_all(self, value: Callable[[int], float | int | str | Missing | None]) -> Values:
        """Return a value of all members, by their number; a refused value is missing."""
        return values_of(range(len(self.members)), value)

    def of_sides(self, value: Callable[[int, int], float | int | str | Missing | None]) -> Values:
        """Return a value of all sides of all members, by their numbers; symmetric teeth have one side, number 0."""
        numbers = [(k, side) for k, own in enumerate(self.teeth) for side in range(len(own.sides))]
        return values_of(numbers, lambda both: value(*both))

    def fed_rounding(self, k: int, gear: GearProportions) -> float:
        """Return the default tip rounding (modules) of the tool of member k, fed for its allowance.

        `gear`: the member as this tool cuts it.
        """
        return tool_rounding(gear)

    @property
    def stated_specs(self) -> tuple[CylindricalMember | None, ...]:
        """Tables that give the thicknesses of all members; None for a member that is not part of the order."""
        return self.specs if self.stated is None else self.stated

    @cached_property
    def allowances(self) -> tuple[Allowances | None, ...]:
        """Thickness allowances of all members; None for a member without its own allowance."""
        own = zip(self.geometry.gears, self.stated_specs, strict=True)
        return tuple(None if spec is None else allowances_of(gear.name, spec, gear.own) for gear, spec in own)

    @property
    def ranged(self) -> bool:
        """True if a member has a thickness allowance with two ends."""
        return any(given is not None and given.upper != given.lower for given in self.allowances)

    @property
    def meshing(self) -> SheetPair | None:
        """The pair, if the gears mesh."""
        return None


@dataclass(frozen=True)
class SheetPair(SheetGears):
    """A complete design in mm, its proportions and its members as built, pinion and gear."""

    design: CylindricalDesign
    geometry: PairProportions

    @property
    def mesh(self) -> InvolutePair:
        return self.geometry.mesh

    @property
    def meshing(self) -> SheetPair:
        return self

    @property
    def line(self) -> LineOfAction:
        """Line of action of the drive side."""
        return self.lines[0]

    @cached_property
    def lines(self) -> tuple[LineOfAction, ...]:
        """Lines of action of drive and coast side, or the one of symmetric teeth."""
        return tuple(self._line(number, mesh) for number, mesh in enumerate(self.mesh.sides))

    @property
    def side_numbers(self) -> range:
        """Numbers of drive and coast side, or 0 alone for symmetric teeth."""
        return range(len(self.mesh.sides))

    def working_line(self, flank: Side) -> LineOfAction:
        """Return the line of action of the side that works when right or left flanks of the pinion drive."""
        return self.lines[0 if flank is self.teeth[0].drive else -1]

    def _line(self, number: int, mesh: InvolutePair) -> LineOfAction:
        """Return the line of action of one side, which has the `mesh`."""
        first, second = (
            (teeth.roll_length(root), teeth.roll_length(tip))
            for teeth, (root, tip) in zip(
                (mesh.pinion, mesh.gear), (sides[number] for sides in self.side_flanks), strict=True
            )
        )
        return LineOfAction(mesh, (first, second), self._where(number))

    def _where(self, number: int) -> str:
        """Return the words for a side of asymmetric teeth after the name of a member."""
        return f", {SIDE_WORDS[number]} side" if self.asymmetric else ""

    def fillet_interference(self, names: tuple[str, str]) -> tuple[str, ...]:
        """Return a warning for each member below whose flank the mating gear's tip reaches.

        `names`: names of pinion and gear.
        """
        return tuple(
            warning
            for number, line in enumerate(self.lines)
            for warning in line.fillet_interference(names, self.set_back_fillets(number))
        )

    def set_back_fillets(self, number: int) -> list[SetBackFillet | None]:
        """Return the reasons why fillets of a side lie behind the involutes of its flanks; None for other fillets."""
        return [set_back_fillet(gear, flank_sides(gear.own)[number]) for gear in self.geometry.gears]

    def fillet_reserves(self) -> list[float | None]:
        """Return the least interference reserve of pinion and gear; None where tips meet only fillets that are set back."""
        of_sides = [line.fillet_reserves(self.set_back_fillets(number)) for number, line in enumerate(self.lines)]
        found = [[value for value in of_member if value is not None] for of_member in zip(*of_sides, strict=True)]
        return [min(values, default=None) for values in found]

    def interference_reserves(self, number: int, names: tuple[str, str]) -> tuple[Reserve, ...]:
        """Return the reserves of the pair against interference of its teeth.

        - number: number of the pair in its gear set.
        - names: names of pinion and gear.
        """
        reserves_of_pair = [
            Reserve(number, f"interference_{name}", value, "mm")
            for name, value in zip(names, self.fillet_reserves(), strict=True)
            if value is not None
        ]
        if any(teeth.internal for teeth in self.teeth):
            left = reserves(self.mesh, self.geometry.tips)
            reserves_of_pair.append(Reserve(number, "involute", left.involute, "mm"))
            if math.isfinite(left.trochoid):
                reserves_of_pair.append(Reserve(number, "trochoid", math.degrees(left.trochoid), "deg"))
        return tuple(reserves_of_pair)

    def fed_rounding(self, k: int, gear: GearProportions) -> float:
        return rounding_in_mesh(gear, self.mesh, (self.mesh.gear, self.mesh.pinion)[k], self.geometry.tips[1 - k])

    @property
    def distance_deviations(self) -> Deviations | None:
        """Allowances of the centre distance, mm; None if there are none."""
        return self.design.assembly.center_distance_deviations(self.mesh.distance)

    @property
    def overlap(self) -> float:
        """Common face width, mm."""
        first, second = (0.5 * spec.face_width for spec in self.specs)
        aside = self.design.assembly.dz
        return max(0.0, min(first, aside + second) - max(-first, aside - second))

    @property
    def overlap_ratio(self) -> float:
        """Overlap ratio eps_beta."""
        pinion = self.mesh.pinion
        return self.overlap * abs(math.sin(pinion.beta)) / (math.pi * pinion.module)

    @property
    def contact_ratio(self) -> float:
        """Total contact ratio eps_gamma of the drive side."""
        return self.line.contact_ratio + self.overlap_ratio


def _degrees(value: float) -> float:
    return math.degrees(value)


# ---------------------------------------------------------------- the pair


def _mesh_rows(pair: SheetPair, number: int) -> list[Row]:
    """Return the rows of the mesh of one side."""
    mesh, line = pair.mesh.sides[number], pair.lines[number]
    pinion = mesh.pinion
    values = (
        ("u", "gear ratio z2 / z1", "-", mesh.gear.teeth / pinion.teeth),
        ("m_n", "normal module", "mm", pinion.module),
        ("m_t", "transverse module", "mm", pinion.transverse_module),
        ("alpha_n", "normal pressure angle", "deg", _degrees(pinion.alpha)),
        ("alpha_t", "transverse pressure angle", "deg", _degrees(pinion.alpha_t)),
        ("alpha_wt", "working transverse pressure angle", "deg", _degrees(mesh.working_angle)),
        ("beta", "helix angle", "deg", _degrees(abs(pinion.beta))),
        ("beta_b", "base helix angle", "deg", _degrees(abs(pinion.beta_b))),
        ("beta_w", "working helix angle", "deg", _degrees(abs(mesh.working_helix))),
        ("p_et", "transverse base pitch", "mm", pinion.base_pitch),
        ("a", "centre distance", "mm", mesh.distance),
        *_distance_allowances(pair),
        ("a_d", "reference centre distance", "mm", mesh.reference_distance),
        ("eps_alpha", "transverse contact ratio", "-", line.contact_ratio),
        ("eps_beta", "overlap ratio", "-", pair.overlap_ratio),
        ("eps_gamma", "total contact ratio", "-", line.contact_ratio + pair.overlap_ratio),
    )
    return [(symbol, words, unit, (value,)) for symbol, words, unit, value in values]


def _distance_allowances(pair: SheetPair) -> list[tuple[str, str, str, float]]:
    """Return the rows of the allowances of the centre distance; empty if there are none."""
    given = pair.distance_deviations
    if given is None:
        return []
    return [
        ("A_ae", "upper allowance of the centre distance", "mm", given.upper),
        ("A_ai", "lower allowance of the centre distance", "mm", given.lower),
    ]


def _backlash(pair: SheetPair) -> tuple[tuple[str, ...], list[Row]]:
    """Return columns and rows of the backlash.

    Columns: nominal teeth, teeth as made, and the ends of the allowances of thickness and centre distance, if there are
    any.
    """
    meshes = {"theoretical": pair.geometry.nominal, "working": pair.mesh}
    if pair.ranged or pair.distance_deviations is not None:
        meshes |= {"least": _at_end(pair, "upper"), "largest": _at_end(pair, "lower")}

    def row(symbol: str, words: str, value: Callable[[InvolutePair], float]) -> Row:
        return symbol, words, "mm", tuple(value(mesh) for mesh in meshes.values())

    return tuple(meshes), [
        row("j_wt", "circumferential, at the working pitch circles", lambda mesh: mesh.working_backlash),
        *normal_backlash_rows([mesh.normal_backlashes for mesh in meshes.values()]),
        row("j_r", "radial: change of a that eliminates it", _radial_backlash),
    ]


def normal_backlash_rows(backlashes: Sequence[tuple[float, ...]]) -> list[Row]:
    """Return the rows of the normal backlash of each side of the teeth.

    `backlashes`: values of all sides (mm) for each column.
    """
    of_sides = tuple(zip(*backlashes, strict=True))
    named = NORMAL_BACKLASH_ROWS if len(of_sides) > 1 else (("j_bn", "normal"),)
    return [(symbol, words, "mm", values) for (symbol, words), values in zip(named, of_sides, strict=True)]


def _radial_backlash(mesh: InvolutePair) -> float:
    """Return the change of the centre distance that eliminates the backlash, mm."""
    away = mesh.distance - tight_distance(mesh)
    return -away if mesh.pinion.internal or mesh.gear.internal else away


def _at_end(pair: SheetPair, end: str) -> InvolutePair:
    """Return the mesh at one end, "upper" or "lower", of the thickness allowances.

    The centre distance is at the end that changes the backlash in the same sense.
    """
    pinion, gear = (_at_allowance(pair, k, end) for k in (0, 1))
    given = pair.distance_deviations
    deviation = 0.0
    if given is not None:
        # in an internal pair a larger centre distance reduces the backlash
        nearer = (end == "upper") != (pinion.internal or gear.internal)
        deviation = given.lower if nearer else given.upper
    return replace(pair.mesh, pinion=pinion, gear=gear, distance=pair.mesh.distance + deviation)


def _at_allowance(pair: SheetGears, k: int, end: str) -> Toothing:
    """Return a member's teeth at one end of its allowance; as made if it has none."""
    given = pair.allowances[k]
    return pair.teeth[k] if given is None else replace(pair.teeth[k], allowance=getattr(given, end))


# ---------------------------------------------------------------- members


def _run_out_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of teeth that go on beyond the face width, where any do, and of the tool that leaves them there."""
    beyond = (
        float(np.ptp(member.tooth.blank.faces)) - spec.face_width
        for member, spec in zip(pair.members, pair.specs, strict=True)
    )
    lengths = [length if length > LEAST_RUN_OUT_MM else None for length in beyond]
    if not any(lengths):
        return []
    words = "run-outs of the teeth beyond the face width, of both ends"
    radii = [
        None if length is None else tool_radius(gear) for gear, length in zip(pair.geometry.gears, lengths, strict=True)
    ]
    return [
        ("l_o", words, "mm", pair.of_all(lambda k: lengths[k])),
        ("r_o", "radius of the tool that leaves run-outs", "mm", pair.of_all(lambda k: radii[k])),
    ]


def _member_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of the members."""
    teeth, specs, geometry = pair.teeth, pair.specs, pair.geometry
    hands = ("left", "spur", "right")

    def diameter(symbol: str, words: str, radius: Callable[[int], float]) -> Row:
        return symbol, words, "mm", pair.of_all(lambda k: 2.0 * radius(k))

    rows: list[Row] = [
        ("z", "teeth; internal: negative", "-", pair.of_all(lambda k: teeth[k].signed_teeth)),
        ("hand", "hand of the helix", "", pair.of_all(lambda k: hands[1 + int(np.sign(teeth[k].beta))])),
        (*_width(pair), "mm", pair.of_all(lambda k: specs[k].face_width)),
        *_run_out_rows(pair),
        ("x", "profile shift", "m_n", pair.of_all(lambda k: teeth[k].shift)),
        ("k", "tip alteration", "m_n", pair.of_all(lambda k: _alteration(pair, k))),
        diameter("d", "reference diameter", lambda k: teeth[k].radius),
        diameter("d_b", "base diameter", lambda k: teeth[k].base_radius),
        diameter("d_a", "tip diameter", lambda k: geometry.tips[k]),
        *_tip_tolerances(pair),
        diameter("d_f", "root diameter", lambda k: geometry.roots[k]),
        *_meshing_row(pair, "d_w", "working pitch diameter", lambda both, k: 2.0 * both.mesh.working_radius(teeth[k])),
        diameter("d_Ff", "root form diameter", lambda k: pair.flanks[k][0]),
        *_meshing_row(pair, "d_Nf", "active root diameter", lambda both, k: 2.0 * _active_radius(both, k, 0)),
        diameter("d_Fa", "tip form diameter", lambda k: pair.flanks[k][1]),
        *_meshing_row(pair, "d_Na", "active tip diameter", lambda both, k: 2.0 * _active_radius(both, k, 1)),
        ("h", "tooth depth", "mm", pair.of_all(lambda k: abs(geometry.tips[k] - geometry.roots[k]))),
        *_meshing_row(
            pair, "c", "clearance between its tip and the mating root", lambda both, k: both.geometry.clearance(k)
        ),
        ("A_sn", "allowance of the normal thickness, as made", "mm", pair.of_all(lambda k: teeth[k].allowance)),
        *_thickness_allowances(pair),
        ("s_n", "normal thickness at d", "mm", pair.of_all(lambda k: teeth[k].thickness)),
        (
            "s_t",
            "transverse thickness at d",
            "mm",
            pair.of_all(lambda k: teeth[k].thickness / math.cos(teeth[k].beta)),
        ),
        (
            "s_an",
            "normal thickness at d_a",
            "mm",
            pair.of_all(lambda k: measures.thickness_at(teeth[k], geometry.tips[k])),
        ),
        *_crowning_feed_rows(pair),
    ]
    return [row for row in rows if not (pair.asymmetric and row[0] in FLANK_SYMBOLS)]


def _crowning_feed_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of flanks that a radial feed crowns: feed and twist; empty if there is no such flank."""
    flanks = [[_crowned_flank(member.tooth, side) for side in (Side.RIGHT, Side.LEFT)] for member in pair.members]
    if not any(feed for of_member in flanks for feed, _ in of_member):
        return []
    words = "twist of the {} flank: amount removed from root to tip, at the heel less at the toe"
    return [
        (
            "f_r",
            "radial feed of the tool at toe and heel, for the crowning",
            "mm",
            pair.of_all(lambda k: max(feed for feed, _ in flanks[k]) or None),
        ),
        *(
            (f"S_{side.value}", words.format(side.value), "mm", tuple(of_member[n][1] for of_member in flanks))
            for n, side in enumerate((Side.RIGHT, Side.LEFT))
        ),
    ]


def _crowned_flank(tooth: Tooth, side: Side) -> tuple[float, float | None]:
    """Return the radial feed at the ends of a flank that crowns it, mm, and the twist of all its modifications, mm.

    The feed is 0 and the twist None without such a crowning.
    """
    made = modification_of(tooth.side(side).flank)
    if made is None:
        return 0.0, None
    feeds = [each.feed for each in made.fields if isinstance(each, FedCrowning)]
    return sum(feeds), twist_of(made, made.extent) if feeds else None


def _side_columns(pair: SheetGears, names: tuple[str, ...]) -> tuple[str, ...]:
    """Return names of columns for both sides of every member, or for every member with symmetric teeth."""
    if not pair.asymmetric:
        return names
    return tuple(f"{name}, {side}" for name, own in zip(names, pair.teeth, strict=True) for side in flank_sides(own))


def _side_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of both sides of asymmetric teeth."""
    both = pair.meshing

    def of_flank(value: Callable[[Toothing], float]) -> Values:
        return pair.of_sides(lambda k, side: value(pair.teeth[k].sides[side]))

    def active(end: int) -> list[Values]:
        if both is None:
            return []
        return [both.of_sides(lambda k, side: 2.0 * _active_radius(both, k, end, side))]

    return [
        ("side", "side of the teeth", "", pair.of_sides(lambda _, side: SIDE_WORDS[side])),
        ("alpha_n", "normal pressure angle", "deg", of_flank(lambda own: _degrees(own.alpha))),
        ("alpha_t", "transverse pressure angle", "deg", of_flank(lambda own: _degrees(own.alpha_t))),
        ("beta_b", "base helix angle", "deg", of_flank(lambda own: _degrees(abs(own.beta_b)))),
        ("p_et", "transverse base pitch", "mm", of_flank(lambda own: own.base_pitch)),
        ("d_b", "base diameter", "mm", of_flank(lambda own: 2.0 * own.base_radius)),
        (
            "s_n/2",
            "normal thickness at d, from the middle of the rack's space",
            "mm",
            of_flank(lambda own: 0.5 * own.thickness),
        ),
        ("d_Ff", "root form diameter", "mm", pair.of_sides(lambda k, side: 2.0 * pair.side_flanks[k][side][0])),
        *(("d_Nf", "active root diameter", "mm", values) for values in active(0)),
        ("d_Fa", "tip form diameter", "mm", pair.of_sides(lambda k, side: 2.0 * pair.side_flanks[k][side][1])),
        *(("d_Na", "active tip diameter", "mm", values) for values in active(1)),
        *_side_root_rows(pair),
    ]


def _side_root_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of the tangents of 30 deg in the fillets of both sides of asymmetric teeth."""
    sections = [
        [attempt(partial(critical_section, member.tooth, teeth, side)) for side in flank_sides(teeth)]
        for member, teeth in zip(pair.members, pair.teeth, strict=True)
    ]

    def of_tangent(value: Callable[[CriticalSection], float]) -> Values:
        def at(k: int, side: int) -> float | Missing:
            section = sections[k][side]
            return section if isinstance(section, Missing) else _or_missing(value(section), NO_TANGENT)

        return pair.of_sides(at)

    where = "tangent of 30 deg, internal 60 deg"
    return [
        (
            "s_Fn/2",
            f"{where}: distance from the middle of the rack's space",
            "mm",
            of_tangent(lambda own: 0.5 * own.chord),
        ),
        ("rho_F", f"{where}: radius of the fillet", "mm", of_tangent(lambda own: own.fillet_radius)),
        ("d_F", f"{where}: diameter", "mm", of_tangent(lambda own: 2.0 * own.radius)),
    ]


def _basic_rack_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of the basic rack of each member that a hob or rack cutter generates; none if there is no such
    member.
    """
    specs, teeth, roots = pair.specs, pair.teeth, pair.geometry.roots
    if not any(spec.hobbed for spec in specs):
        return []

    def of_hobbed(value: Callable[[int], float | str]) -> Values:
        return pair.of_all(lambda k: value(k) if specs[k].hobbed else None)

    def dedendum(k: int) -> float:
        own = teeth[k]
        return (own.radius - roots[k]) / own.module + own.shift

    def rounding(side: int) -> Callable[[int], float]:
        return lambda k: tip_rounding(specs[k], coast=bool(side)).modules

    def profile(k: int) -> str:
        """Return the name of the basic rack, if the tooth has all of its proportions."""
        given = specs[k].addendum, dedendum(k), *(rounding(side)(k) for side in range(len(teeth[k].sides)))
        standard = *BASIC_RACKS[pair.design.profile], BASIC_RACKS[pair.design.profile][2]
        is_standard = max(abs(a - b) for a, b in zip(given, standard, strict=False)) < BASIC_RACK_TOLERANCE_MODULES
        return f"ISO 53, {pair.design.profile}" if is_standard else "as below"

    def of_hob(value: Callable[[Hob], float]) -> Values:
        """Return a value of the hobs of all members; None without one."""
        return pair.of_all(lambda k: None if (hob := specs[k].hob) is None else value(hob))

    protuberance, stock = of_hob(lambda hob: hob.protuberance), of_hob(lambda hob: hob.stock)
    of_hobs: list[Row] = [
        row
        for row in (
            ("pr_P0", "protuberance of the hob", "mm", protuberance),
            ("q", "stock that the hob leaves on each flank", "mm", stock),
        )
        if any(row[-1])
    ]
    return [
        ("rack", "basic rack profile", "", of_hobbed(profile)),
        *_rack_angle_rows(pair, of_hobbed),
        ("h_aP", "addendum of the basic rack", "m_n", of_hobbed(lambda k: specs[k].addendum)),
        ("h_fP", "dedendum of the basic rack", "m_n", of_hobbed(dedendum)),
        *(
            (f"rho_fP{which}", f"fillet of the basic rack{words}", "m_n", of_hobbed(rounding(side)))
            for side, (which, words) in enumerate(side_suffixes(teeth[0]))
        ),
        *of_hobs,
    ]


def _rack_angle_rows(pair: SheetGears, of_hobbed: Callable[[Callable[[int], float | str]], Values]) -> list[Row]:
    """Return the rows of the pressure angles of the basic rack.

    `of_hobbed`: returns a value of the members that a hob or rack cutter generates.
    """

    def angle(side: int) -> Callable[[int], float]:
        return lambda k: math.degrees(pair.teeth[k].sides[side].alpha)

    return [
        (f"alpha_P{which}", f"pressure angle of the basic rack{words}", "deg", of_hobbed(angle(number)))
        for number, (which, words) in enumerate(side_suffixes(pair.teeth[0]))
    ]


def _tip_tolerances(pair: SheetGears) -> list[Row]:
    """Return the rows of the deviations of the tip diameters; empty if no member has any."""
    given = [
        None if spec.tip_diameter_tolerance is None else spec.tip_diameter_tolerance.deviations(2.0 * tip)
        for spec, tip in zip(pair.specs, pair.geometry.tips, strict=True)
    ]
    if not any(given):
        return []
    return [
        ("A_dae", "upper deviation of the tip diameter", "mm", values_of(given, lambda own: own.upper)),
        ("A_dai", "lower deviation of the tip diameter", "mm", values_of(given, lambda own: own.lower)),
    ]


def _thickness_allowances(pair: SheetGears) -> list[Row]:
    """Return the rows of the thickness allowances and their tolerances; empty if no member has any."""
    given = pair.allowances
    if not any(given):
        return []
    rows: list[Row] = [
        ("A_sne", "upper allowance of the normal thickness", "mm", values_of(given, lambda own: own.upper)),
        ("A_sni", "lower allowance of the normal thickness", "mm", values_of(given, lambda own: own.lower)),
        ("T_sn", "tolerance of the normal thickness", "mm", values_of(given, lambda own: own.upper - own.lower)),
    ]
    tables = [None if spec is None else spec.thickness_allowance for spec in pair.stated_specs]
    series = values_of(tables, lambda own: own.series)
    return [*rows, ("E_sn", "allowance by DIN 3967", "", series)] if any(series) else rows


def _meshing_row(
    pair: SheetGears, symbol: str, words: str, value: Callable[[SheetPair, int], float | Missing]
) -> list[Row]:
    """Return a row (mm) of values that depend on the mesh; empty for gears that do not mesh."""
    both = pair.meshing
    return [] if both is None else [(symbol, words, "mm", both.of_all(lambda k: value(both, k)))]


def _active_radius(pair: SheetPair, k: int, end: int, side: int = 0) -> float:
    """Return the radius at which the active flank of a side begins (`end` 0) or ends (1)."""
    return math.hypot(pair.teeth[k].sides[side].base_radius, pair.lines[side].active(k)[end])


def _width(pair: SheetGears) -> tuple[str, str]:
    """Return symbol and words of the face width."""
    return pair.members[0].rows.face_width


def _alteration(pair: SheetGears, k: int) -> float | None:
    """Return the tip alteration; None if a tip diameter is given instead."""
    return None if pair.specs[k].tip_diameter is not None else pair.specs[k].tip_alteration


def _cut_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of teeth whose tool is fed for the allowance of the thickness.

    They are generating profile shifts, root diameters and root form diameters, for the teeth as made and at the ends of
    the allowances.
    """
    rows: list[Row] = []
    for end, teeth in _states(pair, ends=True).items():
        cut = [attempt(partial(_fed, pair, k, own)) for k, own in enumerate(teeth)]
        suffix = _suffix(end)
        rows += [
            (
                f"x_E{suffix}",
                f"generating profile shift{end}",
                "m_n",
                values_of(teeth, lambda own: own.generating_shift),
            ),
            (f"d_fE{suffix}", f"root diameter{end}", "mm", values_of(cut, lambda gear: 2.0 * gear.root)),
            *(
                (
                    f"d_FfE{which}{suffix}",
                    f"root form diameter{words}{end}",
                    "mm",
                    values_of(cut, _form_diameter(number)),
                )
                for number, (which, words) in enumerate(side_suffixes(pair.teeth[0]))
            ),
        ]
    return rows


def _fed(pair: SheetGears, k: int, own: Toothing) -> GearProportions | None:
    """Return a member with other teeth, its tool fed for their allowance; None for a formed member.

    The tool is the tool of the same order with allowance_by = "feed". A rounding that the order does not give follows
    from the tool's own, narrower tooth.
    """
    gear, stated = pair.geometry.gears[k], pair.stated_specs[k]
    if gear.spec.formed:
        return None
    spec = gear.spec.model_copy(update={"allowance_by": "feed"})
    fed = gear_proportions(replace(gear, spec=spec, own=own))
    if stated is None or "tool_tip_radius" in stated.model_fields_set:
        return fed
    return replace(fed, spec=spec.model_copy(update={"tool_tip_radius": pair.fed_rounding(k, fed)}))


def side_suffixes(teeth: Toothing) -> tuple[tuple[str, str], ...]:
    """Return suffixes of symbols and words for rows of each side of the teeth; empty ones for symmetric teeth."""
    return (("", ", drive side"), ("_coast", ", coast side")) if teeth.asymmetric else (("", ""),)


def _form_diameter(side: int) -> Callable[[GearProportions], float | Missing]:
    """Return the root form diameter of one side in closed form; missing if the tool undercuts the flank."""

    def diameter(gear: GearProportions) -> float | Missing:
        own, length = gear.own.sides[side], form_roll_length(gear, flank_sides(gear.own)[side])
        return Missing(UNDERCUT_REASON) if length < 0.0 else 2.0 * math.hypot(own.base_radius, length)

    return diameter


# ---------------------------------------------------------------- measures


def _measures(pair: SheetGears) -> list[Row]:
    """Return the rows of span, balls and chords, for the teeth as made and at the ends of the allowances."""
    every = range(len(pair.teeth))
    counts = pair.of_all(lambda k: _span_teeth(pair, k))
    sizes = [attempt(partial(_ball_diameter, pair, k)) for k in every]
    balls, pins = values_of(sizes, float), tuple(_pin_diameter(pair, k, sizes[k]) for k in every)

    def by(
        sizes: Values, symbol: str, words: str, value: Callable[[Toothing, float], float | None], *, ends: bool = False
    ) -> list[Row]:
        return [
            (
                symbol + _suffix(end),
                words + end,
                "mm",
                tuple(
                    attempt(partial(value, toothing, size)) if isinstance(size, int | float) else size
                    for toothing, size in zip(teeth, sizes, strict=True)
                ),
            )
            for end, teeth in (_states(pair, ends=ends) | (_stocked(pair) if ends else {})).items()
        ]

    return [
        ("k_W", "teeth of the span; internal: spaces", "-", counts),
        *by(counts, "W_k", "span", lambda toothing, count: measures.span(toothing, int(count)), ends=True),
        *by(counts, "d_W", "diameter of contact", lambda toothing, n: 2.0 * measures.span_radius(toothing, int(n))),
        *by(counts, "b_W", "least face width for it", lambda toothing, n: measures.span_width(toothing, int(n))),
        *_anvil_row(pair, counts),
        ("D_M", "ball or pin", "mm", balls),
        *by(balls, "M_dK", "over (internal: between) balls", measures.over_balls, ends=True),
        *by(pins, "M_dR", "over (internal: between) pins", measures.over_pins, ends=True),
        *by(
            balls,
            "d_K",
            "diameter of the ball's centre",
            lambda toothing, size: 2.0 * measures.ball_radius(toothing, size),
        ),
        *(
            row
            for number, (which, words) in enumerate(side_suffixes(pair.teeth[0]))
            for row in by(balls, f"d_M{which}", f"diameter of contact{words}", _contact_diameter(number))
        ),
        *_chord_rows(pair),
    ]


def _contact_diameter(side: int) -> Callable[[Toothing, float], float]:
    """Return the diameter at which a ball of a diameter touches the flank of one side of teeth."""
    return lambda toothing, diameter: 2.0 * measures.ball_contact_radii(toothing, diameter)[side]


def _anvil_row(pair: SheetGears, counts: Values) -> list[Row]:
    """Return the row of the anvils that an internal span needs; empty for gears without such a span."""
    spans = [
        count if isinstance(count, int) and teeth.internal else None
        for count, teeth in zip(counts, pair.teeth, strict=True)
    ]
    if not any(spans):
        return []
    largest = pair.of_all(lambda k: None if (n := spans[k]) is None else measures.anvil_radius(pair.teeth[k], n))
    return [("r_W", "largest radius of its anvils, which flat ones do not touch", "mm", largest)]


def _span_teeth(pair: SheetGears, k: int) -> int | Missing:
    """Return the teeth of a member's span; missing if no span touches the flanks.

    They are given, or the number that touches nearest to the V cylinder.
    """
    spec = pair.specs[k]
    if spec.span is not None:
        return spec.span.teeth
    if not measures.has_span(pair.teeth[k]):
        return Missing(measures.NO_ASYMMETRIC_SPAN if pair.asymmetric else HOLLOW_FLANKS)
    count = measures.span_teeth(pair.teeth[k], pair.flanks[k], spec.face_width)
    return Missing(NO_SPAN) if count is None else count


def _ball_diameter(pair: SheetGears, k: int) -> float | Missing:
    """Return the diameter of a member's balls or pins, given or proposed; missing if none fits."""
    teeth, spec = pair.teeth[k], pair.specs[k]
    given = spec.balls or spec.pins
    circles = pair.geometry.tips[k], pair.geometry.roots[k]
    size = measures.ball_diameter(teeth, pair.side_flanks[k], circles) if given is None else given.diameter
    if size is None:
        return Missing(NO_BALL)
    least = measures.ball_width(teeth, size)
    return Missing(NARROW_FACE.format(least)) if spec.face_width <= least else size


def _pin_diameter(pair: SheetGears, k: int, size: float | Missing) -> float | Missing:
    """Return the diameter of a member's pins, equal to its balls'.

    It is missing if straight pins cannot be opposite each other.
    """
    teeth = pair.teeth[k]
    if isinstance(size, Missing):
        return size
    if measures.over_pins(teeth, size) is None:
        return Missing(PIN_ENDS)
    least = measures.pin_width(teeth, size)
    return Missing(NARROW_FOR_PINS.format(least)) if pair.specs[k].face_width <= least else size


def _states(pair: SheetGears, *, ends: bool) -> dict[str, tuple[Toothing, ...]]:
    """Return the teeth as made and, with `ends`, at both ends of the allowances, by the suffix of the words."""
    states = {"": pair.teeth}
    if ends and pair.ranged:
        states |= {
            f", {end}": tuple(_at_allowance(pair, k, end) for k in range(len(pair.teeth))) for end in ("upper", "lower")
        }
    return states


def _stocked(pair: SheetGears) -> dict[str, tuple[Toothing, ...]]:
    """Return the teeth with the stock on their flanks, by the suffix of the words; nothing if no member has stock."""
    if not any(spec.stock for spec in pair.specs):
        return {}
    own = zip(pair.teeth, pair.specs, strict=True)
    thicker = (replace(teeth, allowance=teeth.allowance + both_flanks(teeth, spec.stock)) for teeth, spec in own)
    return {", with stock": tuple(thicker)}


def _suffix(words: str) -> str:
    """Return the suffix of a row's symbol for the suffix of its words."""
    return words.replace(", ", "_").replace(" ", "_")


def _chord_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of the constant chord and the normal chord."""
    rows: list[Row] = []
    for symbol, words, chord, radius in (
        ("c", "constant chord", measures.constant_chord, _foot_radius),
        ("nc", "normal chord at d", measures.chord, _reference_radius),
    ):
        for end, teeth in _states(pair, ends=True).items():
            both = [attempt(partial(_on_flank, pair, k, own, chord, radius)) for k, own in enumerate(teeth)]
            rows.append((f"s_{symbol}{_suffix(end)}", words + end, "mm", values_of(both, lambda size: size[0])))
            if not end:
                rows.append((f"h_{symbol}", "height of the tip over it", "mm", values_of(both, lambda size: size[1])))
    return rows


def _on_flank(
    pair: SheetGears,
    k: int,
    teeth: Toothing,
    chord: Callable[[Toothing, float], tuple[float, float]],
    radius: Callable[[Toothing], float],
) -> tuple[float, float] | Missing:
    """Return a chord of a member's teeth and its height; missing if the ends of the chord are not on the flank."""
    if pair.asymmetric and chord is measures.constant_chord:
        return Missing(NO_ASYMMETRIC_CHORD)
    ends = [sorted(flank) for flank in pair.side_flanks[k]]
    low, high = max(first for first, _ in ends), min(last for _, last in ends)
    return chord(teeth, pair.geometry.tips[k]) if low < radius(teeth) < high else Missing(OFF_FLANK)


def _reference_radius(teeth: Toothing) -> float:
    return teeth.radius


def _foot_radius(teeth: Toothing) -> float:
    """Return the radius of the ends of the constant chord."""
    chord, height = measures.constant_chord(teeth, teeth.radius)
    return math.hypot(teeth.radius_at(-height), 0.5 * chord * math.cos(teeth.beta))


# ---------------------------------------------------------------- contact, root, reserves


def _contact_rows(pair: SheetPair, number: int) -> list[Row]:
    """Return the rows of the points A to E of one side."""
    line = pair.lines[number]
    bases = [teeth.base_radius for teeth in line.members]
    rows: list[Row] = []
    for point, length in line.points.items():
        lengths = length, line.mesh.mating_roll_length(length, line.mesh.pinion)
        both = tuple(zip(bases, lengths, strict=True))
        rows += [
            (
                f"d_{point}",
                f"diameter at {point}",
                "mm",
                tuple(2.0 * math.hypot(*base_and_roll) for base_and_roll in both),
            ),
            (f"xi_{point}", f"roll angle at {point}", "deg", tuple(_degrees(roll / base) for base, roll in both)),
            (f"zeta_{point}", f"specific sliding at {point}", "-", line.mesh.sliding(length)),
        ]
    return rows


def _root_rows(pair: SheetGears) -> list[Row]:
    """Return the rows of the critical section of the root."""
    sections = [
        Missing(NO_ASYMMETRIC_SECTION) if teeth.asymmetric else attempt(partial(critical_section, member.tooth, teeth))
        for member, teeth in zip(pair.members, pair.teeth, strict=True)
    ]

    def of_section(value: Callable[[CriticalSection], float]) -> Values:
        return values_of(sections, lambda section: _or_missing(value(section), NO_TANGENT))

    return [
        ("s_Fn", "chord at the tangent", "mm", of_section(lambda section: section.chord)),
        *_meshing_row(
            pair,
            "h_F",
            "lever of a force at the outer point of single contact",
            lambda both, k: _lever(both, k, sections[k]),
        ),
        ("rho_F", "radius of the fillet at the tangent", "mm", of_section(lambda section: section.fillet_radius)),
        ("d_F", "diameter of the chord's middle", "mm", of_section(lambda section: 2.0 * section.radius)),
    ]


def _lever(pair: SheetPair, k: int, section: CriticalSection | Missing) -> float | Missing:
    """Return the lever of a force on a member over its critical section."""
    if isinstance(section, Missing):
        return section
    return _or_missing(lever(pair.line, k, section), NO_TANGENT)


def _or_missing(value: float, reason: str) -> float | Missing:
    """Return a value; missing if it is not a number."""
    return Missing(reason) if math.isnan(value) else value


def _reserves(pair: SheetGears) -> list[Row]:
    """Return the rows of the reserves against undercut and interference."""
    gears = pair.geometry.gears
    return [
        (
            "undercut",
            "undercut: roll length to where it begins",
            "mm",
            pair.of_sides(lambda k, side: undercut_reserve(gears[k], flank_sides(gears[k].own)[side])),
        ),
        *([] if pair.meshing is None else _mesh_reserves(pair.meshing)),
    ]


def _mesh_reserves(pair: SheetPair) -> list[Row]:
    """Return the rows of the reserves against interference in the mesh."""
    reserve = pair.of_sides(lambda k, side: pair.lines[side].interference_reserve(k))
    words = "interference: roll length from d_Ff to the mating tip"
    return [("interference", words, "mm", reserve), *_internal_reserves(pair)]


def _internal_reserves(pair: SheetPair) -> list[Row]:
    """Return the rows of the reserves of an internal gear.

    They are the angles by which its tips clear the mating gear's tips outside the path of contact, and during radial
    assembly.
    """
    if not any(teeth.internal for teeth in pair.teeth):
        return []
    turns = [reserves(mesh, pair.geometry.tips) for mesh in pair.mesh.sides]

    def shown(reserve: float) -> float | Missing:
        if math.isinf(reserve):
            return Missing(NEVER_NEAR if reserve > 0.0 else LARGER_THAN_HOLE)
        return _degrees(reserve)

    def of_ring(reserve: Callable[[Reserves], float]) -> Values:
        return pair.of_sides(lambda k, side: shown(reserve(turns[side])) if pair.teeth[k].internal else None)

    return [
        ("trochoid", "tips passing each other in rotation", "deg", of_ring(lambda left: left.trochoid)),
        ("trimming", "tips during radial assembly", "deg", of_ring(lambda left: left.trimming)),
    ]


def _bodies(pair: SheetGears) -> list[Row]:
    """Return the rows of density, volume, mass and inertia."""
    densities = tuple(pair.design.density(member.name) for member in pair.members)
    bulks = [attempt(partial(member_moments, member)) for member in pair.members]
    heavy = [
        bulk if bulk is None or isinstance(bulk, Missing) else (bulk, density)
        for bulk, density in zip(bulks, densities, strict=True)
    ]
    return [
        ("rho", "density", "kg/m^3", densities),
        ("V", "volume", "mm^3", values_of(bulks, lambda bulk: bulk.volume)),
        ("m", "mass", "kg", values_of(heavy, lambda own: own[0].mass(own[1]))),
        ("J", "moment of inertia about the axis", "kg mm^2", values_of(heavy, lambda own: own[0].about_axis(own[1]))),
    ]


def _tolerances(pair: SheetGears) -> list[Row]:
    """Return the rows of the flank tolerances; values outside the range of the standard are left out."""
    limits = [
        tolerance_sizes(teeth, spec.face_width).tolerances(pair.design.accuracy_class) or {}
        for teeth, spec in zip(pair.teeth, pair.specs, strict=True)
    ]
    return [
        ("A", "flank tolerance class", "-", pair.of_all(lambda _: pair.design.accuracy_class)),
        *(
            (symbol, words, "um", tuple(of_member.get(symbol) for of_member in limits))
            for symbol, words in TOLERANCE_NAMES.items()
        ),
    ]
