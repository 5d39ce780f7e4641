"""Tips, roots, tool roundings and other defaults that follow from a cylindrical mesh [ISO 21771].

Everything is in the design's own unit of length, so that it can be reported under the design's keys.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.design.keys import given_or
from gearmesh.errors import VagueError
from gearmesh.records import dataclass
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.cylindrical.cutting.cutter import cut_addendum, root_radius, sharp_shaper
from gearmesh.systems.cylindrical.cutting.last_cut import FixedCut, LastCut
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, both_flanks
from gearmesh.systems.cylindrical.geometry.nominal import (
    MEMBER_NAMES,
    ToothedGear,
    nominal_mesh,
    toothed_gear,
    with_allowances,
)
from gearmesh.systems.cylindrical.geometry.shifts import addendum, shifts, tip_alterations, tip_radius
from gearmesh.tools.shaper import Shaper

if TYPE_CHECKING:
    from gearmesh.design.core import Design
    from gearmesh.systems.cylindrical.design import CylindricalDesign

#: part of the largest rounding on a cutter's tip that the default takes
TIP_ROUNDING_SHARE = 0.8


@dataclass(frozen=True)
class GearProportions(ToothedGear):
    """A gear with the radii of its tip and its root."""

    #: tip radius
    tip: float
    #: root radius
    root: float


def gear_proportions(gear: ToothedGear) -> GearProportions:
    """Return a gear of a complete design with its tip and root radii."""
    return GearProportions(
        gear.table,
        gear.name,
        gear.spec,
        gear.own,
        gear.profile,
        tip=tip_radius(gear.spec, gear.own),
        root=root_radius(gear),
    )


@dataclass(frozen=True)
class GearsProportions:
    """Proportions of gears that may or may not mesh."""

    gears: tuple[GearProportions, ...]

    @property
    def tips(self) -> tuple[float, ...]:
        """Tip radii of all gears."""
        return tuple(gear.tip for gear in self.gears)

    @property
    def roots(self) -> tuple[float, ...]:
        """Root radii of all gears."""
        return tuple(gear.root for gear in self.gears)


@dataclass(frozen=True)
class PairProportions(GearsProportions):
    """A pair with the results of its mesh: allowances, centre distance, radii of tips and roots."""

    #: pinion and gear
    gears: tuple[GearProportions, GearProportions]
    #: mesh with the allowances of the tooth thickness
    mesh: InvolutePair
    #: mesh of nominal teeth
    nominal: InvolutePair

    @property
    def tips(self) -> tuple[float, float]:
        """Tip radii of pinion and gear."""
        return self.gears[0].tip, self.gears[1].tip

    @property
    def roots(self) -> tuple[float, float]:
        """Root radii of pinion and gear."""
        return self.gears[0].root, self.gears[1].root

    def gear(self, name: str) -> GearProportions:
        """Return pinion or gear by its name."""
        return self.gears[MEMBER_NAMES.index(name)]

    def clearance(self, k: int) -> float:
        """Return the radial clearance between the tip of a member (0 the pinion) and the mating root."""
        own, mating = (self.mesh.pinion, self.mesh.gear)[:: 1 if k == 0 else -1]
        tip, root = own.sense * self.tips[k], mating.sense * self.roots[1 - k]
        return own.sense * mating.sense * self.mesh.distance - tip - root


def proportions(design: CylindricalDesign) -> PairProportions:
    """Return teeth, centre distance, tips and roots of a complete design.

    Raises DesignError if there is no working pressure angle.
    """
    nominal = nominal_mesh(design)
    mesh = with_allowances(design, nominal)
    first, second = (gear_proportions(toothed_gear(design, name, mesh)) for name in MEMBER_NAMES)
    return PairProportions((first, second), mesh, nominal)


def derived_values(design: CylindricalDesign) -> dict[str, float]:
    """Return the values of keys left out in the file that follow from the mesh, by dotted key.

    Values are in the design's units. Raises DesignError if no working pressure angle belongs to the centre distance or
    profile shifts.
    """
    defaults = still_open(design, dict(zip(_keys("profile_shift"), shifts(design), strict=True)))
    _refuse_large_shifts(design, defaults)
    made = design.fill(defaults)
    nominal = nominal_mesh(made)
    tips = dict(zip(_keys("tip_alteration"), tip_alterations(made, nominal), strict=True))
    mesh = with_allowances(made, nominal)
    addenda = {
        f"{name}.addendum": cut_addendum(toothed_gear(made, name, mesh), addendum(made, name, nominal))
        for name in MEMBER_NAMES
    }
    defaults |= still_open(design, {**tips, **addenda})
    made = design.fill(defaults)
    mesh = with_allowances(made, nominal)
    roundings = {f"{name}.tool_tip_radius": _rounding(made, name, mesh) for name in MEMBER_NAMES}
    return defaults | still_open(design, {**roundings, "backlash": mesh.normal_backlash})


def _refuse_large_shifts(design: CylindricalDesign, derived: dict[str, float]) -> None:
    """Refuse a centre distance whose sum of profile shifts exceeds the range of a member's key."""
    distance = design.assembly.center_distance
    ranges = {name: type(design).key_at(name) for name in derived}
    large = [name for name, key in ranges.items() if key is not None and not key.low <= derived[name] <= key.high]
    if distance is None or not large:
        return
    shifts = [derived.get(f"{name}.profile_shift", getattr(design, name).profile_shift) for name in MEMBER_NAMES]
    raise VagueError(
        "assembly.center_distance",
        distance,
        unit="mm",
        reason=f"needs profile shifts that add up to {sum(shifts):.2f}, {design.name_in_texts(large[0])} = "
        f"{derived[large[0]]:.4g} among them",
        remedies={"assembly.center_distance": 0},
    )


def _keys(key: str) -> list[str]:
    return [f"{name}.{key}" for name in MEMBER_NAMES]


def still_open(design: Design, values: dict[str, float]) -> dict[str, float]:
    """Return those of the values by dotted key that the design uses and has not derived yet."""
    plain = design.plain()
    return {key: value for key, value in values.items() if _counts_and_is_open(plain, key)}


def _counts_and_is_open(plain: dict[str, object], dotted: str) -> bool:
    """True if a plain design uses a key and has not derived it yet."""
    table, _, key = dotted.rpartition(".")
    values = plain[table] if table else plain
    assert isinstance(values, dict)
    return isinstance(values.get(key), float) and math.isnan(values[key])


def _rounding(design: CylindricalDesign, name: str, mesh: InvolutePair) -> float:
    """Return the default tip rounding, in modules, of a member's tool."""
    other = "gear" if name == "pinion" else "pinion"
    mating = getattr(mesh, other)
    return rounding_in_mesh(toothed_gear(design, name, mesh), mesh, mating, tip_radius(getattr(design, other), mating))


def rounding_in_mesh(gear: ToothedGear, mesh: InvolutePair, mating: Toothing, tip: float) -> float:
    """Return the default tip rounding of a tool, in modules.

    It is the profile's rounding, limited by the room on the tool's tooth. For a cutter it is also limited so that the
    involute begins before the `tip` (radius) of the `mating` gear, if any rounding achieves this.
    """
    most = tool_rounding(gear)
    if gear.spec.hobbed:
        return most
    m, of_gear = gear.own.module, mating is mesh.gear
    cut, sharp, root = FixedCut if gear.spec.formed else LastCut, sharp_drive_side(gear), root_radius(gear)
    largest = []
    # a coast side with its own rounding does not limit that of the drive side
    flanks = (sharp, sharp.other_flank) if gear.spec.coast_tool_tip_radius is None else (sharp,)
    for side, own, shaper in zip(mesh.sides, gear.own.sides, flanks, strict=False):
        other = side.gear if of_gear else side.pinion
        reached = side.mating_roll_length(other.roll_length(tip), other)
        largest.append(cut(shaper, own, root).largest_rounding(reached, most * m) / m)
    return min(largest)


def sharp_drive_side(gear: ToothedGear) -> Shaper:
    """Return the tool of `sharp_shaper` without rounding, but for that of the coast side if it has its own and has room."""
    sharp, coast = sharp_shaper(gear), gear.spec.coast_tool_tip_radius
    if coast is None:
        return sharp
    alone = sharp.rounded(0.0, 0.0).other_flank
    return sharp.rounded(0.0, min(coast * gear.own.module, alone.largest_tip_radius))


def tool_rounding(gear: ToothedGear) -> float:
    """Return the profile's tip rounding, in modules, limited by the room on the tool's tooth."""
    spec, own = gear.spec, gear.own
    _, dedendum, standard = BASIC_RACKS[gear.profile]
    if not spec.hobbed:
        return min(standard, TIP_ROUNDING_SHARE * sharp_drive_side(gear).largest_tip_radius / own.module)
    m = own.module
    drive, coast = (math.degrees(own.side(side).alpha) for side in (own.drive, own.drive.other))
    if spec.root_diameter is not None:
        depth = own.shift + (own.radius - 0.5 * spec.root_diameter) / m
    else:
        depth = given_or(spec.dedendum, dedendum)
    # a tool that is fed for the allowance has the width of nominal teeth
    given = 0.0 if spec.allowance_by == "feed" else own.allowance
    if spec.hob is not None:
        # the flanks of the hob's tip project beyond the finished flanks
        given -= both_flanks(own, spec.hob.protuberance - spec.hob.stock)
    return straight_rounding(0.5 * math.pi - given / m, depth, (drive, coast), standard, spec.coast_tool_tip_radius)
