"""What a hob with protuberance or chamfer generates, and the finishing tool after it: fillet, flank, tip [ISO 6336-3, ISO 53].

In the normal section, x out of the blank, the hob on the left and the blank's tooth on the right:

        x ^   hob     /q/   blank's tooth    q: stock, from the hob's flank to the finished one
          |          / /
          |         | /     line of the pressure angle alpha_prP0, from the hob's flank to the rounding
          |         |/
          |         (|      rounding: at most pr_P0 beyond the hob's flank, pr_P0 - q beyond the finished one
        __|________/        tip plane

What hob and finishing tool generate are curves in one transverse section, the same in all of them. Each part of a tool's profile
generates one as far as it is sound; where the tools' profiles have a corner that is hollow, and where one tool cuts what the other
one left, the curves cross, and the tooth ends at their true intersection.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.polylines import first_crossing
from gearmesh.kernel.surface.levels import PlaneLevel
from gearmesh.kernel.surface.stations import along
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.racks.rack_member import ROOT
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTipCorner, RackTooth, round_tips
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.teeth.undercut import intersection
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, ProfilePieces, RackLine, RackSurface, RolledArc

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalMember, Hob

#: samples of a curve between which crossings are looked for
SAMPLES = 400
#: pressure angle (deg) of a hob's root that is not given
CHAMFER = 45.0
#: part of the module that is nothing
NOTHING = 1e-9


@dataclass(frozen=True)
class ToothCut:
    """A part of a tool's profile that generates a sound curve; its parameters towards the root and towards the tip."""

    profile: Profile
    root: float
    tip: float


def flank_line(own: Toothing, outwards: float = 0.0) -> RackLine:
    """The rack's flank that generates a member's, or a line `outwards` of it (mm, normal to it)."""
    half = 0.25 * math.pi * own.module + 0.5 * own.allowance
    return RackLine(own.alpha, own.module, half + outwards / math.cos(own.alpha), own.shift * own.module)


def hobbed_racks(name: str, spec: CylindricalMember, own: Toothing, heights: Heights) -> tuple[RackTooth, RackTooth]:
    """Both sides of the space of the hob, or of hob and finishing tool, that generate a member.

    Raises DesignError naming key, value and limit: no room for the rounding, protuberance longer than the flank or no flank left.
    """
    hob = spec.hob
    left, depth = (0.0, 0.0) if hob is None else (hob.remaining_stock, hob.relief)
    cutting, final = flank_line(own, left - depth), flank_line(own, left)
    racks = round_tips(name, spec, own.module, (cutting, cutting), heights)
    if hob is None:
        return racks
    made = racks[0]
    hobbing = _Hobbing(
        name, hob, replace(own, allowance=own.allowance + 2.0 * left / math.cos(own.alpha)), heights, made
    )
    if abs(depth) >= NOTHING * own.module:
        hob_flank = flank_line(own, hob.stock)
        parts = hobbing.hob_parts(hob_flank) if depth < 0.0 else hobbing.tip_parts(hob_flank)
        *fillet, flank = hobbing.relieve(parts, final) if depth > 0.0 else hobbing.notch(parts, final)
        knots = ROOT - np.cumsum([0.0, *(hobbing.length(part) / own.module for part in fillet)])
        pieces = ProfilePieces(
            tuple(part.profile for part in fillet),
            tuple(float(knot) for knot in knots),
            tuple((part.root, part.tip) for part in fillet),
        )
        made = replace(made, flank=final, form_point=(flank.root, pieces.knots[-1]), pieces=pieces)
    if hob.chamfer_diameter is not None:
        made = replace(made, tip_corner=hobbing.chamfer(final, made.form_point[0]))
    return made, made


@dataclass(frozen=True)
class _Hobbing:
    """A hob over a member: `rack` is that of its tip, with the line that its rounding touches where it projects most."""

    name: str
    hob: Hob
    own: Toothing
    heights: Heights
    rack: RackTooth

    def tip_parts(self, flank: RackLine) -> list[ToothCut]:
        """The tip rounding and the line from the protuberance to the hob's `flank`, as far as their curves bound the tooth."""
        hob, own, arc = self.hob, self.own, self.rack.rounding
        rounding = ToothCut(RolledArc(arc), ROOT, RolledArc.parameter(own.alpha))
        if not hob.protuberance:
            return [rounding]
        angle = 0.5 * own.alpha if hob.protuberance_angle is None else math.radians(hob.protuberance_angle)
        if angle >= own.alpha:
            raise DesignError(
                f"{self.name}.hob.protuberance_angle",
                math.degrees(angle),
                unit="deg",
                allowed=f"less than the pressure angle, {math.degrees(own.alpha):g} deg",
            )
        if hob.protuberance <= -arc.radius * (1.0 - math.cos(own.alpha - angle)):
            # so little that the rounding itself meets the hob's flank
            ends = own.alpha - math.acos(1.0 + hob.protuberance / arc.radius)
            return [replace(rounding, tip=RolledArc.parameter(ends))]
        (x, y), _, _, _ = arc.section(np.array(angle))
        ramp = RackLine(angle, 0.0, -float(y), float(x))
        away = np.array([x, y]) - flank.section(np.array(flank.at_height(float(x))))[0]
        _, _, normal, _ = flank.section(np.array(0.0))
        length = -float(away @ normal) / math.sin(own.alpha - angle)
        top = float(x) + length * math.cos(angle)
        if top >= self._tip_height(flank):
            raise VagueError(
                f"{self.name}.hob.protuberance",
                hob.protuberance,
                unit="mm",
                reason=f"its line of {math.degrees(angle):g} deg is longer than the flank",
                allowed="less, or a smaller protuberance_angle",
            )
        rounding = replace(rounding, tip=RolledArc.parameter(angle))
        # below this its curve is inside out, and what it generates has been cut off by the rounding
        begins = (self._singular_height(ramp) - float(x)) / math.cos(angle)
        if begins <= 0.0:
            return [rounding, ToothCut(ramp, 0.0, length)]
        if begins >= length:
            return [rounding]
        return self._cross([rounding], [ToothCut(ramp, begins, length)]) or [rounding]

    def hob_parts(self, flank: RackLine) -> list[ToothCut]:
        """The parts that bound the tooth as the hob, whose `flank` it is, leaves it."""
        whole = self._sound(flank)
        parts = self.tip_parts(flank)
        touch = self.rack.form_point[0]
        if not self.hob.protuberance and whole.root <= touch:
            return [*parts, replace(whole, root=touch)]
        return self._cross(parts, [whole]) or self._none_left()

    def relieve(self, parts: list[ToothCut], flank: RackLine) -> list[ToothCut]:
        """The `parts` of the hob and the `flank` that they undercut."""
        return self._cross(parts, [self._sound(flank)]) or self._none_left()

    def notch(self, parts: list[ToothCut], flank: RackLine) -> list[ToothCut]:
        """The `parts` of the hob and those of a finishing tool with a sharp tip, its `flank` last."""
        own, diameter = self.own, self.hob.finishing_diameter
        assert diameter is not None
        key = f"{self.name}.hob.finishing_diameter"
        lowest = max(own.base_radius, self._radius(own.alpha, max(self._singular_height(flank), self.heights.root)))
        highest = own.radius + self.heights.tip
        if not lowest < 0.5 * diameter < highest:
            raise DesignError(
                key,
                diameter,
                unit="mm",
                allowed=f"above {at_least(2.0 * lowest)} and below {at_most(2.0 * highest)} mm",
            )
        height = self._height(own.alpha, 0.5 * diameter)
        edge = flank.at_height(height)
        (x, y), _, _, _ = flank.section(np.array(edge))
        # the tip plane is a line whose normal is x, from the middle of the tool's tooth on
        plane = ToothCut(RackLine(0.5 * math.pi, 0.0, 0.0, float(x)), -0.5 * math.pi * own.module, float(y))
        tip = ToothCut(RolledArc(Arc((float(x), float(y)), 0.0)), ROOT, RolledArc.parameter(own.alpha))
        crossed = self._cross(parts, [plane, tip, replace(self._sound(flank), root=edge)])
        if crossed is None:
            raise VagueError(key, diameter, unit="mm", reason="the finishing tool's tip cuts the root", allowed="more")
        return crossed

    def chamfer(self, flank: RackLine, begins: float) -> RackTipCorner:
        """The line that cuts a chamfer from a diameter of the `flank` on, which has its form point at `begins`."""
        hob, own, diameter = self.hob, self.own, self.hob.chamfer_diameter
        assert diameter is not None
        radius, tip = 0.5 * diameter, own.radius + self.heights.tip
        angle = math.radians(CHAMFER if hob.chamfer_angle is None else hob.chamfer_angle)
        if angle <= own.alpha:
            raise DesignError(
                f"{self.name}.hob.chamfer_angle",
                math.degrees(angle),
                unit="deg",
                allowed=f"more than the pressure angle, {math.degrees(own.alpha):g} deg",
            )
        key = f"{self.name}.hob.chamfer_diameter"
        lowest = self._radius(own.alpha, float(flank.section(np.array(begins))[0][0]))
        if not lowest < radius < tip:
            raise DesignError(
                key,
                diameter,
                unit="mm",
                allowed=f"between the root form diameter, {at_least(2.0 * lowest)}, and the tip, {at_most(2.0 * tip)} mm",
            )
        # the line's curve passes through the flank's point of that radius
        height = self._height(angle, radius)
        aside = -height / math.tan(self._transverse(angle))
        turn = own.half_angle(radius) + math.atan2(aside, own.radius + height)
        line = RackLine(angle, 0.0, (own.radius * turn - aside) * math.cos(own.beta), height)
        end = (self._height(angle, tip) - height) / math.cos(angle)
        if self._section_curve(ToothCut(line, 0.0, end))[2][0, 1] >= 0.0:
            raise VagueError(
                key,
                diameter,
                unit="mm",
                reason="the chamfers leave no land",
                allowed="more, or a smaller chamfer_angle",
            )
        return RackTipCorner(line, (flank.at_height(self._height(own.alpha, radius)), 0.0), end)

    def _none_left(self) -> list[ToothCut]:
        raise VagueError(
            f"{self.name}.hob.protuberance",
            self.hob.protuberance,
            unit="mm",
            reason="leaves no flank below the tip",
            allowed="less",
        )

    def _sound(self, flank: RackLine) -> ToothCut:
        """The part of a flank whose curve is sound and ends at the blank's tip."""
        lowest = max(self._singular_height(flank), self.heights.root)
        return ToothCut(flank, flank.at_height(lowest), flank.at_height(self._tip_height(flank)))

    def _transverse(self, angle: float) -> float:
        return math.atan(math.tan(angle) / math.cos(self.own.beta))

    def _singular_height(self, line: RackLine) -> float:
        """Height x of a line's point that generates the foot of its involute; what is below is inside out."""
        return -self.own.radius * math.sin(self._transverse(line.alpha)) ** 2

    def _height(self, angle: float, radius: float) -> float:
        """Height x of the point of a line with a pressure angle that generates the radius: on the line of action."""
        slope = self._transverse(angle)
        foot = self.own.radius * math.cos(slope)
        return (math.sqrt(radius**2 - foot**2) - self.own.radius * math.sin(slope)) * math.sin(slope)

    def _radius(self, angle: float, height: float) -> float:
        """The other way round."""
        slope = self._transverse(angle)
        length = self.own.radius * math.sin(slope) + height / math.sin(slope)
        return math.hypot(self.own.radius * math.cos(slope), length)

    def _tip_height(self, flank: RackLine) -> float:
        return self._height(flank.alpha, self.own.radius + self.heights.tip)

    # ------------------------------------------------------------ curves

    def _cross(self, lower: Sequence[ToothCut], upper: Sequence[ToothCut]) -> list[ToothCut] | None:
        """Two chains of parts, each from root to tip, cut where their curves cross next to the upper one's tip; None if nowhere."""
        for k, above in reversed(list(enumerate(upper))):
            met = [
                (crossing, n) for n, below in enumerate(lower) if (crossing := self._meeting(above, below)) is not None
            ]
            if met:
                (p, q), n = min(met, key=lambda crossing_and_part: abs(crossing_and_part[0][0] - above.tip))
                return [*lower[:n], replace(lower[n], tip=q), replace(above, root=p), *upper[k + 1 :]]
        return None

    def _meeting(self, above: ToothCut, below: ToothCut) -> tuple[float, float] | None:
        """Parameters where the curves of two parts cross, the crossing next to the tip of `above`; None where there is none."""
        (p, v, one), (q, w, other) = self._section_curve(above), self._section_curve(below)
        at = first_crossing(one, other)
        if at is None:
            return None
        number = np.arange(SAMPLES)
        start = np.array([[np.interp(at[k], number, x) for k, x in ((0, p), (0, v), (1, q), (1, w))]])
        solution = intersection((self._surface(above), self._surface(below)), start, np.zeros(1), PlaneLevel(0.0))
        if not solution.converged[0]:
            return None
        return float(solution.values[0, 0]), float(solution.values[0, 2])

    def length(self, part: ToothCut) -> float:
        """Length (mm) of what a part generates."""
        return float(np.hypot(*np.diff(self._section_curve(part)[2], axis=0).T).sum())

    def _section_curve(self, part: ToothCut) -> tuple[Array, Array, Array]:
        """Both parameters (N,) and the points (N, 2) of a part's curve in the transverse section, from its tip on."""
        p = np.linspace(part.tip, part.root, SAMPLES)
        v, jet = along(self._surface(part), p, np.zeros_like(p), PlaneLevel(0.0))
        return p, v, jet.r[:, :2]

    def _surface(self, part: ToothCut) -> Envelope:
        return Envelope(RackSurface(part.profile, self.own.beta, 0.0), RackRoll(self.own.radius))
