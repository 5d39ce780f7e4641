"""The shaper cutter of a member: its teeth, its position at the last cut, and its tool surface."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.systems.cylindrical.cutting.cutter_choice import (
    CutterChoice,
    generating,
    sharp_tool,
    standard_teeth,
)
from gearmesh.systems.cylindrical.cutting.formed import form_tool
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.nominal import ToothedGear
from gearmesh.systems.cylindrical.geometry.shifts import TIP_MARGIN_MODULES, tip_radius
from gearmesh.teeth.region import Side
from gearmesh.tools.shaper import Shaper


def cutter_of(gear: ToothedGear) -> Toothing:
    """Return the teeth of the cutter that shapes a gear: the given cutter, or the standard one.

    If the standard cutter would leave no involute at the tips of an internal gear, the fewest teeth that do are taken.
    """
    cutter = _cutter(gear)
    if gear.spec.shaper is not None or not gear.spec.internal:
        return cutter
    chosen = CutterChoice(gear.own, root_radius(gear), cutter)
    return replace(cutter, teeth=chosen.default_teeth(tip_radius(gear.spec, gear.own)))


def _cutter(gear: ToothedGear) -> Toothing:
    """Return the given cutter, or the standard cutter."""
    own, given = gear.own, gear.spec.shaper
    return Toothing(
        teeth=standard_teeth(own) if given is None else given.teeth,
        module=own.module,
        alpha=own.alpha,
        beta=own.beta if own.internal else -own.beta,
        shift=0.0 if given is None else given.profile_shift,
        coast_alpha=own.coast_alpha,
    )


def cut_addendum(gear: ToothedGear, height: float) -> float:
    """Return the default addendum of a gear.

    `height`: the addendum for which the mating gear leaves room. The addendum of an internal gear is limited by the
    cutters that can exist; for a formed gear it is limited by the base circle.
    """
    spec, own = gear.spec, gear.own
    if not own.internal or spec.tip_diameter is not None:
        return height
    tip = tip_radius(spec, own, height, 0.0)
    if spec.formed:
        base = own.largest_base_radius
        least = tip if tip > base else base + TIP_MARGIN_MODULES * own.module
    else:
        least = CutterChoice(own, root_radius(gear), _cutter(gear)).default_tip(tip, given=spec.shaper is not None)
    return float(height - (least - tip) / own.module)


def root_radius(gear: ToothedGear) -> float:
    """Return the root radius of a gear, from its root diameter, its cutter's addendum or its dedendum.

    The default dedendum is that of the profile. If the tool is fed for the allowance of the thickness, the root radius
    includes this feed.
    """
    spec = gear.spec
    by_cutter = spec.root_diameter is None and spec.shaper is not None and spec.shaper.addendum is not None
    # a given addendum of the cutter already includes the feed
    return _root_at_shift(gear) + (_fed(gear) if spec.allowance_by == "feed" and not by_cutter else 0.0)


def _fed(gear: ToothedGear) -> float:
    """Return the change of the root radius when the tool is fed for the allowance of the thickness.

    For a cutter it is the difference of the centre distances, for a rack sense (x_E - x) m_n.
    """
    own = gear.own
    if not gear.spec.shaped:
        return own.sense * (own.generating_shift - own.shift) * own.module
    cutter = cutter_of(replace(gear, spec=gear.spec.model_copy(update={"allowance_by": "flanks"})))
    return generating(cutter, own).distance - generating(cutter, replace(own, allowance=0.0)).distance


def _root_at_shift(gear: ToothedGear) -> float:
    """Return the root radius that belongs to the profile shift."""
    spec, own = gear.spec, gear.own
    if spec.root_diameter is not None:
        return float(0.5 * spec.root_diameter)
    if spec.shaper is not None and spec.shaper.addendum is not None:
        cutter = cutter_of(gear)
        top = cutter.radius + (spec.shaper.addendum + cutter.shift) * own.module
        return float(generating(cutter, own).distance - own.sense * top)
    return own.radius_at((own.shift - given_or(spec.dedendum, BASIC_RACKS[gear.profile][1])) * own.module)


def sharp_shaper(gear: ToothedGear) -> Shaper:
    """Return the cutter of a shaped gear, or the form tool of a formed gear, without rounding.

    The tool is given in the transverse section, by the flank that cuts the drive side. Raises DesignError if it cannot cut
    these teeth.
    """
    name, own = gear.name, gear.own
    if gear.spec.formed:
        return form_tool(name, gear.spec, own, root_radius(gear))
    cutter = cutter_of(gear)
    if own.internal and cutter.teeth >= own.teeth:
        raise DesignError(f"{name}.shaper.teeth", cutter.teeth, must_be=f"fewer than the internal gear's, {own.teeth}")
    distance = generating(cutter, own).distance
    if math.isnan(distance):
        raise DesignError(
            f"{name}.profile_shift",
            own.shift,
            reason=f"no cutter of {cutter.teeth} teeth generates it",
            allowed="a smaller one",
        )
    return sharp_tool(generating(cutter, own), root_radius(gear))


def cutting_flank(gear: ToothedGear, sharp: Shaper, which: Side) -> Shaper:
    """Return a tool of `sharp_shaper` by the flank that cuts the right or left flanks of a gear."""
    return sharp if which is gear.own.drive else sharp.other_flank


def trimming_warnings(gears: Iterable[ToothedGear]) -> tuple[str, ...]:
    """Return a warning for each internal gear whose tips its cutter trims when it is fed in radially.

    The warning lists cutters that do not trim the tips.
    """
    warnings = []
    for gear in gears:
        if not gear.own.internal or gear.spec.formed:
            continue
        cutter, tip = cutter_of(gear), tip_radius(gear.spec, gear.own)
        chosen, teeth = CutterChoice(gear.own, root_radius(gear), cutter), cutter.teeth
        if not chosen.clears(teeth, tip):
            warnings.append(
                f"{gear.name}.shaper.teeth = {teeth}: the cutter trims the tips as it is fed in radially; "
                f"{chosen.possible(gear.name, tip)}"
            )
    return tuple(warnings)


def other_cutters(gears: Iterable[ToothedGear]) -> tuple[str, ...]:
    """Return a warning for each internal gear whose default cutter is not the standard one."""
    warnings = []
    for gear in gears:
        spec, own, standard = gear.spec, gear.own, standard_teeth(gear.own)
        generated = own.internal and spec.shaped and spec.shaper is None
        if generated and (teeth := cutter_of(gear).teeth) != standard:
            warnings.append(
                f"{gear.name}.shaper.teeth = {teeth}: the default, instead of {standard}, which leave no involute up to the tip"
            )
    return tuple(warnings)
