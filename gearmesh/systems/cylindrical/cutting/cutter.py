"""The shaper cutter of a member: its teeth, its position at the last cut, and its tool surface."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.systems.cylindrical.cutting.cutter_choice import CutterChoice, generating, sharp_tool, standard_teeth
from gearmesh.systems.cylindrical.cutting.formed import form_tool
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing
from gearmesh.systems.cylindrical.geometry.nominal import MEMBERS, nominal_mesh, toothing, with_allowances
from gearmesh.systems.cylindrical.geometry.shifts import addendum, tip_radius
from gearmesh.tools.shaper import Shaper

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember


def cutter_of(design: CylindricalDesign, spec: CylindricalMember) -> Toothing:
    """The teeth of the cutter that shapes a member: those given, or about two fifths of the member's.

    Of an internal gear whose tips that cutter would leave without involute: the fewest that do not.
    """
    cutter, name = _cutter(design, spec), "pinion" if spec is design.pinion else "gear"
    if spec.shaper is not None or not spec.internal:
        return cutter
    own = getattr(with_allowances(design, nominal_mesh(design)), name)
    chosen = CutterChoice(own, root_radius(design, name, own), cutter)
    return replace(cutter, teeth=chosen.default_teeth(tip_radius(spec, own)))


def _cutter(design: CylindricalDesign, spec: CylindricalMember) -> Toothing:
    """The cutter that is given, or the standard one."""
    own = toothing(design, "pinion" if spec is design.pinion else "gear")
    given = spec.shaper
    return Toothing(
        teeth=standard_teeth(own) if given is None else given.teeth,
        module=own.module,
        alpha=own.alpha,
        beta=own.beta if own.internal else -own.beta,
        shift=0.0 if given is None else given.profile_shift,
    )


def cut_addendum(design: CylindricalDesign, name: str, mesh: InvolutePair) -> float:
    """The addendum that is not given: `shifts.addendum`, or, of an internal gear, what there is a cutter for."""
    spec, own = getattr(design, name), getattr(with_allowances(design, mesh), name)
    height = addendum(design, name, mesh)
    if not own.internal or spec.formed or spec.tip_diameter is not None:
        return height
    chosen = CutterChoice(own, root_radius(design, name, own), _cutter(design, spec))
    tip = tip_radius(spec, own, height, 0.0)
    return float(height - (chosen.default_tip(tip, given=spec.shaper is not None) - tip) / own.module)


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
    """The cutter of a shaped member, or the form tool of a formed one, in the transverse section, without rounding.

    Raises DesignError for one that cannot cut these teeth.
    """
    spec, own = getattr(design, name), getattr(with_allowances(design, mesh), name)
    if spec.formed:
        return form_tool(design.name_in_texts(name), spec, own, root_radius(design, name, own))
    cutter = cutter_of(design, spec)
    if own.internal and cutter.teeth >= own.teeth:
        key = design.name_in_texts(f"{name}.shaper.teeth")
        raise DesignError(key, cutter.teeth, must_be=f"fewer than the internal gear's, {own.teeth}")
    apart = generating(cutter, own).distance
    if math.isnan(apart):
        raise DesignError(
            design.name_in_texts(f"{name}.profile_shift"),
            own.shift,
            reason=f"no cutter of {cutter.teeth} teeth generates it",
            allowed="a smaller one",
        )
    return sharp_tool(generating(cutter, own), root_radius(design, name, own))


def trimming_warnings(design: CylindricalDesign, mesh: InvolutePair, tips: tuple[float, float]) -> tuple[str, ...]:
    """A line for an internal gear whose tips its cutter trims as it is fed in radially, with the cutters that do not."""
    warnings = []
    for name, own, tip in (("pinion", mesh.pinion, tips[0]), ("gear", mesh.gear, tips[1])):
        spec = getattr(design, name)
        if not own.internal or spec.formed:
            continue
        cutter = cutter_of(design, spec)
        chosen, teeth = CutterChoice(own, root_radius(design, name, own), cutter), cutter.teeth
        if not chosen.clears(teeth, tip):
            member = design.name_in_texts(name)
            warnings.append(
                f"{member}.shaper.teeth = {teeth}: the cutter trims the tips as it is fed in radially; "
                f"{chosen.possible(member, tip)}"
            )
    return tuple(warnings)


def other_cutters(design: CylindricalDesign, mesh: InvolutePair) -> tuple[str, ...]:
    """A line for an internal gear whose cutter is not given and not the standard one."""
    warnings = []
    for name, own in zip(MEMBERS, (mesh.pinion, mesh.gear), strict=True):
        spec, standard = getattr(design, name), standard_teeth(own)
        if (
            own.internal
            and spec.shaped
            and spec.shaper is None
            and (teeth := cutter_of(design, spec).teeth) != standard
        ):
            warnings.append(
                f"{design.name_in_texts(name)}.shaper.teeth = {teeth}: the default, instead of {standard}, which leave no "
                "involute up to the tip"
            )
    return tuple(warnings)
