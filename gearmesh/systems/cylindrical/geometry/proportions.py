"""What a cylindrical mesh asks of its members: tips, roots, tool roundings, and every default that follows from them [ISO 21771].

Everything is in the design's own unit of length, so that it can be reported under the design's keys.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearmesh.design.keys import given_or
from gearmesh.errors import VagueError
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.cylindrical.cutting.cutter import cut_addendum, root_radius, sharp_shaper
from gearmesh.systems.cylindrical.cutting.last_cut import FixedCut, LastCut
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing
from gearmesh.systems.cylindrical.geometry.nominal import (
    MEMBERS,
    ToothedGear,
    nominal_mesh,
    toothed_gear,
    with_allowances,
)
from gearmesh.systems.cylindrical.geometry.shifts import addendum, shifts, tip_alterations, tip_radius

if TYPE_CHECKING:
    from gearmesh.design.core import Design
    from gearmesh.systems.cylindrical.design import CylindricalDesign

#: part of the room on a cutter's tip that a rounding takes that is not given
ROOM = 0.8


@dataclass(frozen=True)
class GearProportions(ToothedGear):
    """A gear with the radii of its tip and its root."""

    tip: float
    root: float


def gear_proportions(gear: ToothedGear) -> GearProportions:
    """Tip and root of a gear of a complete design."""
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
    """Gears, whether they mesh or not."""

    gears: tuple[GearProportions, ...]

    @property
    def tips(self) -> tuple[float, ...]:
        """Tip radii of all."""
        return tuple(gear.tip for gear in self.gears)

    @property
    def roots(self) -> tuple[float, ...]:
        """Root radii of all."""
        return tuple(gear.root for gear in self.gears)


@dataclass(frozen=True)
class PairProportions(GearsProportions):
    """A pair with everything that its mesh says: teeth with their allowances, centre distance, radii of tips and roots."""

    gears: tuple[GearProportions, GearProportions]
    mesh: InvolutePair
    nominal: InvolutePair

    @property
    def tips(self) -> tuple[float, float]:
        """Tip radii of both."""
        return self.gears[0].tip, self.gears[1].tip

    @property
    def roots(self) -> tuple[float, float]:
        """Root radii of both."""
        return self.gears[0].root, self.gears[1].root

    def gear(self, name: str) -> GearProportions:
        """One of both by its name."""
        return self.gears[MEMBERS.index(name)]

    def clearance(self, k: int) -> float:
        """Radial clearance between the tip of a member, 0 the pinion, and the mating root."""
        own, mating = (self.mesh.pinion, self.mesh.gear)[:: 1 if k == 0 else -1]
        tip, root = own.sense * self.tips[k], mating.sense * self.roots[1 - k]
        return own.sense * mating.sense * self.mesh.distance - tip - root


def proportions(design: CylindricalDesign) -> PairProportions:
    """Teeth, centre distance, tips and roots of a complete design. Raises DesignError where there is no working pressure angle."""
    nominal = nominal_mesh(design)
    mesh = with_allowances(design, nominal)
    first, second = (gear_proportions(toothed_gear(design, name, mesh)) for name in MEMBERS)
    return PairProportions((first, second), mesh, nominal)


def derived_values(design: CylindricalDesign) -> dict[str, float]:
    """What the mesh says of keys that the file leaves out, by dotted key, in the design's units.

    Raises DesignError for a centre distance or profile shifts that no working pressure angle belongs to.
    """
    defaults = still_open(design, dict(zip(_keys("profile_shift"), shifts(design), strict=True)))
    _refuse_large_shifts(design, defaults)
    made = design.fill(defaults)
    nominal = nominal_mesh(made)
    tips = dict(zip(_keys("tip_alteration"), tip_alterations(made, nominal), strict=True))
    mesh = with_allowances(made, nominal)
    addenda = {
        f"{name}.addendum": cut_addendum(toothed_gear(made, name, mesh), addendum(made, name, nominal))
        for name in MEMBERS
    }
    defaults |= still_open(design, {**tips, **addenda})
    made = design.fill(defaults)
    mesh = with_allowances(made, nominal)
    roundings = {f"{name}.tool_tip_radius": _rounding(made, name, mesh) for name in MEMBERS}
    return defaults | still_open(design, {**roundings, "backlash": mesh.normal_backlash})


def _refuse_large_shifts(design: CylindricalDesign, derived: dict[str, float]) -> None:
    """Refuse a centre distance whose sum of profile shifts asks for more of one member than its key takes."""
    distance = design.assembly.center_distance
    ranges = {name: type(design).key_at(name) for name in derived}
    large = [name for name, key in ranges.items() if key is not None and not key.low <= derived[name] <= key.high]
    if distance is None or not large:
        return
    shifts = [derived.get(f"{name}.profile_shift", getattr(design, name).profile_shift) for name in MEMBERS]
    raise VagueError(
        "assembly.center_distance",
        distance,
        unit="mm",
        reason=f"needs profile shifts that add up to {sum(shifts):.2f}, {design.name_in_texts(large[0])} = "
        f"{derived[large[0]]:.4g} among them",
        remedies={"assembly.center_distance": 0},
    )


def _keys(key: str) -> list[str]:
    return [f"{name}.{key}" for name in MEMBERS]


def still_open(design: Design, values: dict[str, float]) -> dict[str, float]:
    """Those of values by dotted key that count in a design and are still to be derived."""
    plain = design.plain()
    return {key: value for key, value in values.items() if _counts_and_is_open(plain, key)}


def _counts_and_is_open(plain: dict[str, object], dotted: str) -> bool:
    """Whether a key counts in a plain design and is still to be derived."""
    table, _, key = dotted.rpartition(".")
    values = plain[table] if table else plain
    assert isinstance(values, dict)
    return isinstance(values.get(key), float) and math.isnan(values[key])


def _rounding(design: CylindricalDesign, name: str, mesh: InvolutePair) -> float:
    """The tip rounding, in modules, of the tool of a member that the design does not give."""
    other = "gear" if name == "pinion" else "pinion"
    mating = getattr(mesh, other)
    return rounding_in_mesh(toothed_gear(design, name, mesh), mesh, mating, tip_radius(getattr(design, other), mating))


def rounding_in_mesh(gear: ToothedGear, mesh: InvolutePair, mating: Toothing, tip: float) -> float:
    """The tip rounding of the profile, in modules, or what the tool's tooth has room for; of a cutter the largest with which the
    involute begins before the `tip` (radius) of the `mating` gear of the mesh, if one does."""
    most = tool_rounding(gear)
    if gear.spec.hobbed:
        return most
    reached, m = mesh.mating_roll_length(mating.roll_length(tip), mating), gear.own.module
    cut = FixedCut if gear.spec.formed else LastCut
    return cut(sharp_shaper(gear), gear.own, root_radius(gear)).largest_rounding(reached, most * m) / m


def tool_rounding(gear: ToothedGear) -> float:
    """The tip rounding of the profile, in modules, or what the tool's tooth has room for."""
    spec, own = gear.spec, gear.own
    _, dedendum, standard = PROFILES[gear.profile]
    if not spec.hobbed:
        return min(standard, ROOM * sharp_shaper(gear).largest_tip_radius / own.module)
    m, alpha = own.module, math.degrees(own.alpha)
    if spec.root_diameter is not None:
        depth = own.shift + (own.radius - 0.5 * spec.root_diameter) / m
    else:
        depth = given_or(spec.dedendum, dedendum)
    # a tool that is fed for it has its own width
    given = 0.0 if spec.allowance_by == "feed" else own.allowance
    if spec.hob is not None:
        # the tip's flanks stand out of the finished flanks by this
        given -= 2.0 * (spec.hob.protuberance - spec.hob.stock) / math.cos(own.alpha)
    return straight_rounding(0.5 * math.pi - given / m, depth, (alpha, alpha), standard)
