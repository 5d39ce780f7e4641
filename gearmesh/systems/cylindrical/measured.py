"""Check of the spans, balls and pins that a design asks for: they must touch the flanks of the teeth as built."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.systems.cylindrical.geometry import measures
from gearmesh.systems.cylindrical.geometry.geometry import flank_sides
from gearmesh.teeth.region import FLANK_REGIONS, Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.geometry import Toothing
    from gearmesh.systems.cylindrical.geometry.line_of_action import Flank
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions
    from gearmesh.teeth.gear_train import Member


def flank_radii(member: Member, side: Side = Side.RIGHT) -> Flank:
    """Return the radii d_Ff / 2 and d_Fa / 2 at which the usable flank begins and ends, in the middle of the face."""
    tooth = member.tooth
    points = tooth.grid(FLANK_REGIONS[side], np.array([0.0, 1.0]), tooth.sections([0.5])).points[:, 0]
    root, tip = np.hypot(points[:, 0], points[:, 1])[:: 1 if side is Side.RIGHT else -1]
    return float(root), float(tip)


def flanks_of(own: Toothing, member: Member) -> tuple[Flank, ...]:
    """Return the radii of the ends of the flanks of each side of a member; of symmetric teeth those of the right flanks."""
    return tuple(flank_radii(member, side) for side in flank_sides(own))


def check_measures(gear: GearProportions, member: Member) -> None:
    """Refuse a span or a ball of a gear (in mm) that does not touch the involute of its member."""
    spec = gear.spec
    if spec.span is None and spec.balls is None and spec.pins is None:
        return
    flanks = flanks_of(gear.own, member)
    if spec.span is not None:
        _check_span(gear, flanks[0])
    for key in ("balls", "pins"):
        if getattr(spec, key) is not None:
            _check_ball(f"{gear.name}.{key}.diameter", gear, flanks, getattr(spec, key).diameter)


def _check_span(gear: GearProportions, flank: Flank) -> None:
    """Refuse a span that does not touch the flanks."""
    assert gear.spec.span is not None
    if not measures.has_span(gear.own):
        raise DesignError(
            f"{gear.name}.span.teeth",
            gear.spec.span.teeth,
            reason=measures.NO_ASYMMETRIC_SPAN
            if gear.own.asymmetric
            else "flat anvils cannot touch the hollow flanks of a helical internal gear",
            remedy="give balls",
        )
    given, fit = gear.spec.span.teeth, measures.span_numbers(gear.own, flank, gear.spec.face_width)
    if given in fit:
        return
    allowed = "no span, with this face width none touches both flanks"
    if fit:
        allowed = f"{fit[0]} to {fit[-1]}" if len(fit) > 1 else f"{fit[0]}"
    raise DesignError(
        f"{gear.name}.span.teeth", given, reason="it does not touch the involutes of both flanks", allowed=allowed
    )


def _check_ball(key: str, gear: GearProportions, flanks: tuple[Flank, ...], given: float) -> None:
    """Refuse a ball or pin that does not touch the flanks or does not stand out of the space."""
    circles = gear.tip, gear.root
    if measures.ball_fits(gear.own, given, flanks, circles):
        return
    between = measures.ball_range(gear.own, flanks, circles)
    raise DesignError(
        key,
        given,
        unit="mm",
        reason="does not touch the involutes of a space, or does not stand out of it",
        allowed="none, no ball does" if between is None else Allowed.from_to(between[0], between[1], "mm"),
    )
