"""The shaper cutter of a member: its teeth, where it stands at the last cut, and what it is as a tool."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.errors import DesignError
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry import InvolutePair, Toothing, distance_of
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
    if spec.root_diameter is not None:
        root = 0.5 * spec.root_diameter
    elif spec.shaper is not None and spec.shaper.addendum is not None:
        root = apart - own.sense * (cutter.radius + (spec.shaper.addendum + cutter.shift) * own.module)
    else:
        depth = PROFILES[design.profile][1] if math.isnan(spec.dedendum) else spec.dedendum
        root = own.radius_at((own.shift - depth) * own.module)
    top = apart - root if not own.internal else root - apart
    return Shaper(
        teeth=cutter.teeth,
        module=cutter.transverse_module,
        pressure_angle=cutter.alpha_t,
        addendum=top - cutter.radius,
        profile_shift=cutter.shift * math.cos(cutter.beta),
    )
