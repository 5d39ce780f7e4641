"""What a cylindrical mesh asks of its members: tips, roots, tool roundings, and every default that follows from them [ISO 21771].

Everything is in the design's own unit of length, so that it can be reported under the design's keys.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearmesh.design.keys import given_or
from gearmesh.systems.common.defaults import straight_rounding
from gearmesh.systems.cylindrical.cutting.cutter import cut_addendum, root_radius, sharp_shaper
from gearmesh.systems.cylindrical.cutting.last_cut import FixedCut, LastCut
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair
from gearmesh.systems.cylindrical.geometry.nominal import MEMBERS, nominal_mesh, with_allowances
from gearmesh.systems.cylindrical.geometry.shifts import shifts, tip_alterations, tip_radius
from gearmesh.tools.shaper import Shaper

if TYPE_CHECKING:
    from gearmesh.design.core import Design
    from gearmesh.systems.cylindrical.design import CylindricalDesign

#: part of the room on a cutter's tip that a rounding takes that is not given
ROOM = 0.8


@dataclass(frozen=True)
class PairProportions:
    """A pair with everything that its mesh says: teeth with their allowances, centre distance, radii of tips and roots."""

    mesh: InvolutePair
    nominal: InvolutePair
    tips: tuple[float, float]
    roots: tuple[float, float]

    def clearance(self, k: int) -> float:
        """Radial clearance between the tip of a member, 0 the pinion, and the mating root."""
        own, mating = (self.mesh.pinion, self.mesh.gear)[:: 1 if k == 0 else -1]
        tip, root = own.sense * self.tips[k], mating.sense * self.roots[1 - k]
        return own.sense * mating.sense * self.mesh.distance - tip - root


def proportions(design: CylindricalDesign) -> PairProportions:
    """Teeth, centre distance, tips and roots of a complete design. Raises DesignError where there is no working pressure angle."""
    nominal = nominal_mesh(design)
    mesh = with_allowances(design, nominal)
    tips = tip_radius(design.pinion, mesh.pinion), tip_radius(design.gear, mesh.gear)
    return PairProportions(
        mesh, nominal, tips, (root_radius(design, "pinion", mesh.pinion), root_radius(design, "gear", mesh.gear))
    )


def derived_values(design: CylindricalDesign) -> dict[str, float]:
    """What the mesh says of keys that the file leaves out, by dotted key, in the design's units.

    Raises DesignError for a centre distance or profile shifts that no working pressure angle belongs to.
    """
    defaults = still_open(design, dict(zip(_keys("profile_shift"), shifts(design), strict=True)))
    made = design.fill(defaults)
    nominal = nominal_mesh(made)
    tips = dict(zip(_keys("tip_alteration"), tip_alterations(made, nominal), strict=True))
    defaults |= still_open(
        design, {**tips, **{f"{name}.addendum": cut_addendum(made, name, nominal) for name in MEMBERS}}
    )
    made = design.fill(defaults)
    roundings = {f"{name}.tool_tip_radius": _rounding(made, name, nominal) for name in MEMBERS}
    backlash = with_allowances(made, nominal).normal_backlash
    return defaults | still_open(design, {**roundings, "backlash": backlash})


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
    """The tip rounding of the profile, or what the tool's tooth has room for."""
    spec, own = getattr(design, name), getattr(mesh, name)
    standard, m = PROFILES[design.profile][2], own.module
    alpha = math.degrees(own.alpha)
    if spec.hobbed:
        if spec.root_diameter is not None:
            depth = own.shift + (own.radius - 0.5 * spec.root_diameter) / m
        else:
            depth = given_or(spec.dedendum, PROFILES[design.profile][1])
        given = getattr(with_allowances(design, mesh), name).allowance
        if spec.hob is not None:
            # the tip's flanks stand out of the finished flanks by this
            given -= 2.0 * (spec.hob.protuberance - spec.hob.stock) / math.cos(own.alpha)
        return straight_rounding(0.5 * math.pi - given / m, depth, (alpha, alpha), standard)
    sharp = sharp_shaper(design, name, mesh)
    return float(_clear(design, name, mesh, sharp, min(standard * m, ROOM * sharp.largest_tip_radius)) / m)


def _clear(design: CylindricalDesign, name: str, mesh: InvolutePair, sharp: Shaper, most: float) -> float:
    """The largest rounding of a cutter, up to `most`, with which the involute begins before the mating gear's tip; `most` if
    none does."""
    own, other = getattr(with_allowances(design, mesh), name), "gear" if name == "pinion" else "pinion"
    mating = getattr(mesh, other)
    tip = mating.roll_length(tip_radius(getattr(design, other), mating))
    reached = mesh.mating_roll_length(tip, mating)
    cut = FixedCut if getattr(design, name).formed else LastCut
    return cut(sharp, own, root_radius(design, name, own)).largest_rounding(reached, most)
