"""Profile shifts that add up to the sum for a centre distance, and the tip alterations they require [ISO 21771]."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, specific_sliding, sum_of_shifts
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES, nominal_mesh, toothing

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember

#: margin between an internal gear's default tip and the radius at which the mating gear's or the cutter's involute ends,
#: or at which the cutter trims
TIP_MARGIN_MODULES = 0.02
#: search range about equal parts for the shifts at which sliding is equal
MAX_SHIFT_DIFFERENCE = 2.0
#: number of shifts that are tried in this range
SHIFT_SAMPLES = 81


def shifts(design: CylindricalDesign) -> tuple[float, float]:
    """Return the profile shifts of both members; shifts that are not given share the centre distance's sum."""
    given = design.pinion.profile_shift, design.gear.profile_shift
    open_ = [math.isnan(x) for x in given]
    distance = design.assembly.center_distance
    if not any(open_):
        return given
    if distance is None:
        return 0.0 if open_[0] else given[0], 0.0 if open_[1] else given[1]
    pinion, gear = (toothing(design, name) for name in MEMBER_NAMES)
    # the centre distance fixes the sum; a given shift leaves the rest to the other member
    total = sum_of_shifts(pinion, gear, distance)
    if math.isnan(total):
        nominal_mesh(design)
    if not open_[1]:
        return total - given[1], given[1]
    if not open_[0]:
        return given[0], total - given[0]
    if design.shift_sharing == "teeth":
        first = total * pinion.teeth / (pinion.teeth + gear.teeth)
        return first, total - first
    if design.shift_sharing == "sliding":
        first = _same_sliding(design, InvolutePair(pinion, gear, distance), total)
        if not math.isnan(first):
            return first, total - first
        if design.sets("shift_sharing"):
            raise DesignError(
                "shift_sharing",
                "sliding",
                shown='"sliding"',
                reason=f"no profile shifts that add up to {total:.6g} make specific sliding equal",
                allowed='"equal" or "teeth"',
            )
    return 0.5 * total, 0.5 * total


def _same_sliding(design: CylindricalDesign, mesh: InvolutePair, total: float) -> float:
    """Return the pinion's profile shift at which specific sliding at both ends of contact is equal; NaN if none."""

    def difference(shift: float) -> float:
        pinion, gear = replace(mesh.pinion, shift=shift), replace(mesh.gear, shift=total - shift)
        moved = replace(mesh, pinion=pinion, gear=gear)
        alterations = tip_alterations(design, moved)
        tips = (
            tip_radius(design.pinion, pinion, addendum(design, "pinion", moved), alterations[0]),
            tip_radius(design.gear, gear, addendum(design, "gear", moved), alterations[1]),
        )
        first, second = specific_sliding(moved, tips)
        return first - second

    # sample the difference, and take the change of sign nearest to equal parts
    tried = 0.5 * total + np.linspace(-MAX_SHIFT_DIFFERENCE, MAX_SHIFT_DIFFERENCE, SHIFT_SAMPLES)
    values = np.array([difference(float(x)) for x in tried])
    finite = np.isfinite(values)
    change = np.flatnonzero(finite[:-1] & finite[1:] & (values[:-1] * values[1:] <= 0.0))
    if not change.size:
        return math.nan
    k = change[np.argmin(np.abs(tried[change] - 0.5 * total))]
    roots = bracketed_root(
        lambda x, _: np.array([difference(float(shift)) for shift in x]), tried[k : k + 1], tried[k + 1 : k + 2]
    )
    return float(roots.values[0])


def tip_alterations(design: CylindricalDesign, mesh: InvolutePair) -> tuple[float, float]:
    """Return the tip alterations k of both members, given or such that the profile's clearance is kept.

    k = y - x1 - x2, at most 0.
    """
    m = mesh.pinion.module
    own = 0.0
    if not (mesh.pinion.internal or mesh.gear.internal):
        own = min(0.0, (mesh.distance - mesh.reference_distance) / m - mesh.pinion.shift - mesh.gear.shift)
        # rounding counts as 0
        own = own if own < -1e-12 else 0.0
    first, second = (spec.tip_alteration for spec in (design.pinion, design.gear))
    return given_or(first, own), given_or(second, own)


def addendum(design: CylindricalDesign, name: str, mesh: InvolutePair) -> float:
    """Return the default addendum of a member.

    It is the profile's addendum. For an internal gear it is limited by the start of the mating gear's involute, above
    the form point of its tool.
    """
    standard = BASIC_RACKS[design.profile][0]
    own = getattr(mesh, name)
    if not own.internal:
        return standard
    other = "gear" if name == "pinion" else "pinion"
    mating, spec = getattr(mesh, other), getattr(design, other)
    _, dedendum, rounding = BASIC_RACKS[design.profile]
    m = mating.module
    depth = (given_or(spec.dedendum, dedendum) - mating.shift) * m
    tips = []
    for side in mesh.sides:
        inner, outer = (side.pinion, side.gear) if other == "pinion" else (side.gear, side.pinion)
        form_point = inner.rack_form_roll_length(depth, rounding * m)
        tips.append(math.hypot(outer.base_radius, max(0.0, form_point) + side.generator))
    tip = max(tips)
    return float(min(standard, (own.radius - tip) / m - own.shift - TIP_MARGIN_MODULES))


def tip_radius(
    spec: CylindricalMember, own: Toothing, addendum: float = math.nan, alteration: float = math.nan
) -> float:
    """Return the tip radius of a member.

    `addendum` and tip `alteration` are used where the keys are still to be derived.
    """
    if spec.tip_diameter is not None:
        return 0.5 * spec.tip_diameter
    height = given_or(spec.addendum, addendum) + given_or(spec.tip_alteration, alteration)
    return own.radius_at((height + own.shift) * own.module)
