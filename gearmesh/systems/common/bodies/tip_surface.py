r"""Tips that are turned to a surface of revolution other than the tooth's own: cones and throats.

    tip_cone_angle            rho = d_a / 2 + z tan(angle)
    tip_throat_radius R       arc in the axial plane through d_a / 2 at mid face, centre at R + d_a / 2

z = 0 is at mid face. A throat is higher at both ends of the face. The tips of internal gears extend towards the axis;
the centre of the arc is then at d_a / 2 - R.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.effort import EffortSpentError
from gearmesh.kernel.surface.levels import ConeLevel, LandLevel
from gearmesh.kernel.surface.meridian import CircularMeridian, Meridian
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.tooth_edges import goes, largest_trimmed
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from gearmesh.design.core import TurnedTip


def with_tip_surface(member: Member, spec: TurnedTip, tip: float | None = None) -> Member:
    """Return a member with the tip surface that its part `spec` of a design asks for.

    `tip`: its tip radius at mid face (mm), if known. Raises DesignError naming the key, its value and the limit if the
    teeth have no such tip.
    """
    own = member.tooth.blank.tip
    tip = float(own.at(0.0)) if tip is None else tip
    if spec.tip_cone_angle is not None and spec.tip_cone_angle != np.degrees(np.arctan(_slope(own))):
        return replace(member, tooth=_conical_tooth(member, spec.tip_cone_angle, tip))
    if spec.tip_throat_radius is not None:
        return replace(member, tooth=_throated_tooth(member, spec.tip_throat_radius, tip))
    return member


def _slope(level: LandLevel) -> float:
    """Return the slope of the radius of a cone or cylinder along z."""
    return float(level.at(1.0) - level.at(0.0))


def _conical_tooth(member: Member, angle: float, tip: float) -> Tooth:
    """Return the tooth with a conical tip."""
    inwards = member.tooth.blank.body.around
    own = float(np.degrees(np.arctan(_slope(member.tooth.blank.tip))))

    def tooth(share: float) -> Tooth:
        slope = np.tan(np.radians(own + share * (angle - own)))
        level = ConeLevel.of(tip, slope)
        if inwards:
            level = ConeLevel(level.angle + np.pi, -level.offset)
        return _with_tip(member.tooth, level)

    def allowed() -> str:
        limit = own + largest_trimmed(lambda share: tooth(share).prove()) * (angle - own)
        bound = at_most(abs(limit)) if (limit > 0.0) == (angle > own) else at_least(abs(limit))
        return f"{'at most' if angle > own else 'at least'} {'-' if limit < 0.0 else ''}{bound} deg"

    if goes(tooth(1.0).prove):
        return tooth(1.0)
    raise _refusal(member, "tip_cone_angle", angle, "deg", allowed)


def _throated_tooth(member: Member, radius: float, tip: float) -> Tooth:
    """Return the tooth with a throated tip."""
    blank = member.tooth.blank
    half, height = 0.5 * abs(blank.extent[1] - blank.extent[0]), -tip if blank.body.around else tip

    def tooth(share: float) -> Tooth:
        arc = CircularMeridian((0.0, height + radius / share), radius / share)
        return _with_tip(member.tooth, Meridian(arc, blank.axial))

    def trim(share: float) -> None:
        if radius <= share * half:
            raise TrimError("tip", 0.0, "the arc ends before the face")
        tooth(share).prove()

    def allowed() -> str:
        share = largest_trimmed(trim)
        return Allowed.at_least(radius / share, "mm") if share > 0.0 else "left out"

    if goes(lambda: trim(1.0)):
        return tooth(1.0)
    raise _refusal(member, "tip_throat_radius", radius, "mm", allowed)


def _with_tip(tooth: Tooth, level: LandLevel) -> Tooth:
    """Return the tooth with another tip surface."""
    return replace(tooth, blank=replace(tooth.blank, tip=level))


def _refusal(member: Member, key: str, value: float, unit: str, allowed: Callable[[], str]) -> DesignError:
    """Return the refusal of a tip surface, whose bound is searched for when it is read, and left out if that takes too long."""
    key, reason = f"{member.name}.{key}", "the teeth have no such tip from end to end"

    def tell() -> DesignError:
        try:
            bound = allowed()
        except EffortSpentError:
            bound = ""
        return DesignError(key, value, unit=unit, reason=reason, allowed=bound)

    return DesignError.later(tell, f"{key}: {reason}")
