"""The shaper cutter of a member: its teeth, where it stands at the last cut, and what it is as a tool."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry import InvolutePair, Toothing, distance_of
from gearmesh.systems.cylindrical.interference import reserves
from gearmesh.systems.cylindrical.nominal import toothing, with_allowances
from gearmesh.tools.shaper import Shaper

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember

#: teeth of a cutter that is not given: part of the member's, and between which numbers
CUTTER, FEWEST, MOST = 0.4, 12, 50


def cutter_of(design: CylindricalDesign, spec: CylindricalMember) -> Toothing:
    """The teeth of the cutter that shapes a member: those given, or about two fifths of the member's."""
    own = toothing(design, "pinion" if spec is design.pinion else "gear")
    given = spec.shaper
    return Toothing(
        teeth=min(max(FEWEST, round(CUTTER * own.teeth)), MOST, own.teeth - 1) if given is None else given.teeth,
        module=own.module,
        alpha=own.alpha,
        beta=own.beta if own.internal else -own.beta,
        shift=0.0 if given is None else given.profile_shift,
    )


def generating(cutter: Toothing, own: Toothing) -> InvolutePair:
    """Cutter and member as they stand when the last cut is made: without backlash."""
    signed = own.signed + cutter.teeth
    thicknesses = (own.thickness + cutter.thickness) / own.module
    # the sum of shifts that belongs to these thicknesses
    shifts = (thicknesses - math.pi) / (2.0 * math.tan(own.alpha))
    even = replace(cutter, shift=shifts, allowance=0.0), replace(own, shift=0.0, allowance=0.0)
    return InvolutePair(cutter, own, distance_of(*even) if signed else math.nan)


def root_radius(design: CylindricalDesign, name: str, own: Toothing) -> float:
    """Root radius of a member: from its root diameter, its cutter's addendum or its dedendum, which the profile says by default."""
    spec = getattr(design, name)
    if spec.root_diameter is not None:
        return float(0.5 * spec.root_diameter)
    if spec.shaper is not None and spec.shaper.addendum is not None:
        cutter = cutter_of(design, spec)
        top = cutter.radius + (spec.shaper.addendum + cutter.shift) * own.module
        return float(generating(cutter, own).distance - own.sense * top)
    return own.radius_at((own.shift - given_or(spec.dedendum, PROFILES[design.profile][1])) * own.module)


def sharp_shaper(design: CylindricalDesign, name: str, mesh: InvolutePair) -> Shaper:
    """The cutter of a shaped member as a tool in the transverse section, without rounding.

    Raises DesignError for one that cannot cut these teeth.
    """
    spec, own = getattr(design, name), getattr(with_allowances(design, mesh), name)
    cutter = cutter_of(design, spec)
    if own.internal and cutter.teeth >= own.teeth:
        raise DesignError(
            f"{name}.shaper.teeth = {cutter.teeth}: allowed are fewer than the internal gear's, {own.teeth}"
        )
    apart = generating(cutter, own).distance
    if math.isnan(apart):
        raise DesignError(
            f"{name}.profile_shift = {own.shift:g}: no cutter of {cutter.teeth} teeth generates it; allowed is a smaller one"
        )
    root = root_radius(design, name, own)
    top = own.sense * (apart - root)
    return Shaper(
        teeth=cutter.teeth,
        module=cutter.transverse_module,
        pressure_angle=cutter.alpha_t,
        addendum=top - cutter.radius,
        profile_shift=cutter.shift * math.cos(cutter.beta),
    )


def trimmed(design: CylindricalDesign, mesh: InvolutePair, tips: tuple[float, float]) -> tuple[str, ...]:
    """A line for an internal gear whose tips its cutter trims as it is fed in radially, with the most teeth that do not."""
    found = []
    for name, own, tip in (("pinion", mesh.pinion, tips[0]), ("gear", mesh.gear, tips[1])):
        if not own.internal:
            continue
        spec = getattr(design, name)
        root = root_radius(design, name, own)
        given = cutter_of(design, spec)

        def clears(
            teeth: int, own: Toothing = own, ends: tuple[float, float] = (root, tip), given: Toothing = given
        ) -> bool:
            cutting = generating(replace(given, teeth=teeth), own)
            return reserves(cutting, (ends[0] - cutting.distance, ends[1])).trimming >= 0.0

        if not clears(given.teeth):
            allowed = next((z for z in range(given.teeth - 1, 0, -1) if clears(z)), None)
            remedy = "" if allowed is None else f"; allowed are at most {allowed}"
            found.append(f"{name}.shaper.teeth = {given.teeth}: the cutter trims the tips as it is fed in{remedy}")
    return tuple(found)
