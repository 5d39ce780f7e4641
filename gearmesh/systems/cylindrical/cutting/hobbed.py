"""Teeth cut by a hob with protuberance or chamfer and by a finishing tool: fillet, flank, tip [ISO 6336-3, ISO 53].

In the normal section, x out of the blank, the hob on the left and the blank's tooth on the right:

        x ^   hob     /q/   blank's tooth    q: stock, from the hob's flank to the finished flank
          |          / /
          |         | /     line of the pressure angle alpha_prP0, from the hob's flank to the rounding
          |         |/
          |         (|      rounding: at most pr_P0 beyond the hob's flank, pr_P0 - q beyond the finished flank
        __|________/        tip plane

Hob and finishing tool generate curves in one transverse section, the same in all of them. Each part of a tool's profile
generates a curve as far as it is sound. Curves cross where a tool's profile has a hollow corner, and where one tool
cuts the surface that the other left. The tooth ends at their exact intersection.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.polylines import first_crossing
from gearmesh.kernel.surface.levels import PlaneLevel
from gearmesh.kernel.surface.stations import along
from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.racks.rack_member import ROOT_PARAMETER
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTipCorner, RackTooth, round_tips, tip_roundings
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.teeth.region import Side
from gearmesh.teeth.undercut import intersection
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, ProfilePieces, RackLine, RackSurface, RolledArc

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalMember, Hob

#: samples of a curve between which crossings are searched
CURVE_SAMPLES = 400
#: default pressure angle of a hob's root that cuts chamfers
DEFAULT_CHAMFER_ANGLE_DEG = 45.0
#: smaller lengths are rounding
ROUNDING_MODULES = 1e-9


@dataclass(frozen=True)
class ToothCut:
    """A part of a tool's profile that generates a sound curve, with its parameters towards root and tip."""

    profile: Profile
    root: float
    tip: float


def flank_line(own: Toothing, outwards: float = 0.0) -> RackLine:
    """Return the rack's flank that generates a member's flank, or a line `outwards` of it (mm, along its normal)."""
    half = 0.25 * math.pi * own.module + 0.5 * own.allowance
    return RackLine(own.alpha, own.module, half + outwards / math.cos(own.alpha), own.shift * own.module)


def hobbed_racks(name: str, spec: CylindricalMember, own: Toothing, heights: Heights) -> tuple[RackTooth, RackTooth]:
    """Return both sides of the space of the hob, or of hob and finishing tool, that generate a member.

    Raises DesignError naming key, value and limit: no room for the rounding, a protuberance longer than the flank, or
    no flank left.
    """
    hob, sides = spec.hob, [own.side(side) for side in (Side.RIGHT, Side.LEFT)]
    remaining_stock, relief = (0.0, 0.0) if hob is None else (hob.remaining_stock, hob.relief)
    # the tip rounding touches this line, which projects beyond the final flank by the relief
    right, left = (flank_line(side, remaining_stock - relief) for side in sides)
    racks = round_tips(name, spec, own.module, (right, left), heights, tip_roundings(spec, own.drive.other))
    if hob is None:
        return racks
    if not own.asymmetric:
        made = _hobbed_side(name, hob, own, heights, racks[0])
        _check_chamfered_land(name, hob, own, heights, (made, made))
        return made, made
    first, second = (_hobbed_side(name, hob, side, heights, rack) for side, rack in zip(sides, racks, strict=True))
    _check_chamfered_land(name, hob, own, heights, (first, second))
    return first, second


def _hobbed_side(name: str, hob: Hob, own: Toothing, heights: Heights, made: RackTooth) -> RackTooth:
    """Return one side of the space of hob and finishing tool.

    - own: symmetric teeth with the flanks of this side.
    - made: this side of a rack with the hob's tip.
    """
    remaining_stock, relief = hob.remaining_stock, hob.relief
    final = flank_line(own, remaining_stock)
    hobbing = _Hobbing(
        name, hob, replace(own, allowance=own.allowance + 2.0 * remaining_stock / math.cos(own.alpha)), heights, made
    )
    if abs(relief) >= ROUNDING_MODULES * own.module:
        hob_flank = flank_line(own, hob.stock)
        parts = hobbing.hob_parts(hob_flank) if relief < 0.0 else hobbing.tip_parts(hob_flank)
        # curves of the hob, cut where the final flank begins
        *fillet, flank = hobbing.relieve(parts, final) if relief > 0.0 else hobbing.notch(parts, final)
        # parameters of the fillet's pieces grow with their lengths, in modules, towards the tip
        knots = ROOT_PARAMETER - np.cumsum([0.0, *(hobbing.length(part) / own.module for part in fillet)])
        pieces = ProfilePieces(
            tuple(part.profile for part in fillet),
            tuple(float(knot) for knot in knots),
            tuple((part.root, part.tip) for part in fillet),
        )
        made = replace(made, flank=final, form_point=(flank.root, pieces.knots[-1]), pieces=pieces)
    if hob.chamfer_diameter is not None:
        made = replace(made, tip_corner=hobbing.chamfer(final, made.form_point[0]))
    return made


def _check_chamfered_land(
    name: str, hob: Hob, own: Toothing, heights: Heights, sides: tuple[RackTooth, RackTooth]
) -> None:
    """Refuse chamfers that leave no land between them."""
    corners = [side.tip_corner for side in sides]
    ends = [
        _section_curve(ToothCut(corner.profile, corner.form_point[1], corner.end), own)[2][0]
        for corner in corners
        if corner is not None
    ]
    if ends and sum(math.atan2(y, x) for x, y in ends) >= 0.0:
        raise VagueError(
            f"{name}.hob.chamfer_diameter",
            hob.chamfer_diameter,
            unit="mm",
            reason="the chamfers leave no land",
            allowed="more, or a smaller chamfer_angle",
        )


def _section_curve(part: ToothCut, own: Toothing) -> tuple[Array, Array, Array]:
    """Return both parameters (N,) and the points (N, 2), from its tip, of a part's transverse curve."""
    p = np.linspace(part.tip, part.root, CURVE_SAMPLES)
    v, jet = along(_surface(part, own), p, np.zeros_like(p), PlaneLevel(0.0))
    return p, v, jet.r[:, :2]


def _surface(part: ToothCut, own: Toothing) -> Envelope:
    """Return the surface that a part generates."""
    return Envelope(RackSurface(part.profile, own.beta, 0.0), RackRoll(own.radius))


@dataclass(frozen=True)
class _Hobbing:
    """A hob over a member."""

    #: name of the member
    name: str
    #: the hob's keys
    hob: Hob
    #: teeth as cut, including the remaining stock
    own: Toothing
    #: heights of tip and root over the reference cylinder, mm
    heights: Heights
    #: rack of the hob's tip, with the line that its rounding touches where it projects most
    rack: RackTooth

    def tip_parts(self, flank: RackLine) -> list[ToothCut]:
        """Return the tip rounding and the line from it to the hob's `flank`, as far as they bound the tooth.

        The line is that of the protuberance.
        """
        hob, own, arc = self.hob, self.own, self.rack.rounding
        rounding = ToothCut(RolledArc(arc), ROOT_PARAMETER, RolledArc.parameter(own.alpha))
        if not hob.protuberance:
            return [rounding]
        angle = 0.5 * own.alpha if hob.protuberance_angle is None else math.radians(hob.protuberance_angle)
        if angle >= own.alpha:
            raise DesignError(
                f"{self.name}.hob.protuberance_angle",
                math.degrees(angle),
                unit="deg",
                allowed=Allowed.less_than(math.degrees(own.alpha), "deg", "the pressure angle"),
            )
        if hob.protuberance <= -arc.radius * (1.0 - math.cos(own.alpha - angle)):
            # the protuberance is so small that the rounding itself meets the hob's flank
            ends = own.alpha - math.acos(1.0 + hob.protuberance / arc.radius)
            return [replace(rounding, tip=RolledArc.parameter(ends))]
        # the line is tangent to the rounding and ends where it meets the hob's flank
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
        # below this height the line's curve is inside out, and the rounding has cut it off
        begins = (self._singular_height(ramp) - float(x)) / math.cos(angle)
        if begins <= 0.0:
            return [rounding, ToothCut(ramp, 0.0, length)]
        if begins >= length:
            return [rounding]
        return self._cross([rounding], [ToothCut(ramp, begins, length)]) or [rounding]

    def hob_parts(self, flank: RackLine) -> list[ToothCut]:
        """Return the parts that bound the tooth as cut by the hob with this `flank`."""
        whole = self._sound(flank)
        parts = self.tip_parts(flank)
        touch = self.rack.form_point[0]
        if not self.hob.protuberance and whole.root <= touch:
            return [*parts, replace(whole, root=touch)]
        return self._cross(parts, [whole]) or self._none_left()

    def relieve(self, parts: list[ToothCut], flank: RackLine) -> list[ToothCut]:
        """Return the `parts` of the hob and the finished `flank` that they undercut."""
        return self._cross(parts, [self._sound(flank)]) or self._none_left()

    def notch(self, parts: list[ToothCut], flank: RackLine) -> list[ToothCut]:
        """Return the `parts` of the hob and the parts of a finishing tool with a sharp tip, its `flank` last."""
        own, diameter = self.own, self.hob.finishing_diameter
        assert diameter is not None
        key = f"{self.name}.hob.finishing_diameter"
        # the flank can end anywhere between its lowest sound point and the tip
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
        # the tip plane is a line with the normal x, from the middle of the tool's tooth
        plane = ToothCut(RackLine(0.5 * math.pi, 0.0, 0.0, float(x)), -0.5 * math.pi * own.module, float(y))
        tip = ToothCut(RolledArc(Arc((float(x), float(y)), 0.0)), ROOT_PARAMETER, RolledArc.parameter(own.alpha))
        crossed = self._cross(parts, [plane, tip, replace(self._sound(flank), root=edge)])
        if crossed is None:
            raise VagueError(key, diameter, unit="mm", reason="the finishing tool's tip cuts the root", allowed="more")
        return crossed

    def chamfer(self, flank: RackLine, begins: float) -> RackTipCorner:
        """Return the line that cuts a chamfer from a diameter of the `flank` on.

        `begins`: the flank's parameter at its form point.
        """
        hob, own, diameter = self.hob, self.own, self.hob.chamfer_diameter
        assert diameter is not None
        radius, tip = 0.5 * diameter, own.radius + self.heights.tip
        angle = math.radians(DEFAULT_CHAMFER_ANGLE_DEG if hob.chamfer_angle is None else hob.chamfer_angle)
        if angle <= own.alpha:
            raise DesignError(
                f"{self.name}.hob.chamfer_angle",
                math.degrees(angle),
                unit="deg",
                allowed=Allowed.more_than(math.degrees(own.alpha), "deg", "the pressure angle"),
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
        # the curve of the line passes through the flank's point at this radius
        height = self._height(angle, radius)
        aside = -height / math.tan(self._transverse(angle))
        turn = own.half_angle(radius) + math.atan2(aside, own.radius + height)
        line = RackLine(angle, 0.0, (own.radius * turn - aside) * math.cos(own.beta), height)
        end = (self._height(angle, tip) - height) / math.cos(angle)
        return RackTipCorner(line, (flank.at_height(self._height(own.alpha, radius)), 0.0), end)

    def _none_left(self) -> list[ToothCut]:
        """Refuse a protuberance that leaves no flank below the tip."""
        raise VagueError(
            f"{self.name}.hob.protuberance",
            self.hob.protuberance,
            unit="mm",
            reason="leaves no flank below the tip",
            allowed="less",
        )

    def _sound(self, flank: RackLine) -> ToothCut:
        """Return the part of a flank whose curve is sound and ends at the blank's tip."""
        lowest = max(self._singular_height(flank), self.heights.root)
        return ToothCut(flank, flank.at_height(lowest), flank.at_height(self._tip_height(flank)))

    def _transverse(self, angle: float) -> float:
        """Return the transverse angle (rad) that belongs to a normal angle."""
        return math.atan(math.tan(angle) / math.cos(self.own.beta))

    def _singular_height(self, line: RackLine) -> float:
        """Return the height x of the line's point that generates the foot of its involute.

        Below this point the generated curve is inside out.
        """
        return -self.own.radius * math.sin(self._transverse(line.alpha)) ** 2

    def _height(self, angle: float, radius: float) -> float:
        """Return the height x of the line's point that generates a radius.

        `angle`: pressure angle of the line. The point is on the line of action.
        """
        slope = self._transverse(angle)
        foot = self.own.radius * math.cos(slope)
        return (math.sqrt(radius**2 - foot**2) - self.own.radius * math.sin(slope)) * math.sin(slope)

    def _radius(self, angle: float, height: float) -> float:
        """Return the radius that a line of a pressure angle generates at height x; the inverse of `_height`."""
        slope = self._transverse(angle)
        length = self.own.radius * math.sin(slope) + height / math.sin(slope)
        return math.hypot(self.own.radius * math.cos(slope), length)

    def _tip_height(self, flank: RackLine) -> float:
        """Return the height x of the flank's point that generates the tip."""
        return self._height(flank.alpha, self.own.radius + self.heights.tip)

    # ------------------------------------------------------------ curves

    def _cross(self, lower: Sequence[ToothCut], upper: Sequence[ToothCut]) -> list[ToothCut] | None:
        """Return two chains of parts joined where they cross next to the upper chain's tip; None if they do not.

        Both chains go from root to tip.
        """
        for k, above in reversed(list(enumerate(upper))):
            crossings = [
                (crossing, n) for n, below in enumerate(lower) if (crossing := self._meeting(above, below)) is not None
            ]
            if crossings:
                (p, q), n = min(crossings, key=lambda crossing_and_part: abs(crossing_and_part[0][0] - above.tip))
                return [*lower[:n], replace(lower[n], tip=q), replace(above, root=p), *upper[k + 1 :]]
        return None

    def _meeting(self, above: ToothCut, below: ToothCut) -> tuple[float, float] | None:
        """Return the parameters at which the curves of two parts cross; None if they do not.

        Of several crossings it is the crossing next to the tip of `above`.
        """
        (p, v, curve_above), (q, w, curve_below) = _section_curve(above, self.own), _section_curve(below, self.own)
        crossing = first_crossing(curve_above, curve_below)
        if crossing is None:
            return None
        # start at the crossing of the polylines; Newton's method finds the crossing of the curves
        number = np.arange(CURVE_SAMPLES)
        start = np.array([[np.interp(crossing[k], number, x) for k, x in ((0, p), (0, v), (1, q), (1, w))]])
        solution = intersection(
            (_surface(above, self.own), _surface(below, self.own)), start, np.zeros(1), PlaneLevel(0.0)
        )
        if not solution.converged[0]:
            return None
        return float(solution.values[0, 0]), float(solution.values[0, 2])

    def length(self, part: ToothCut) -> float:
        """Return the length (mm) of the curve that a part generates."""
        return float(np.hypot(*np.diff(_section_curve(part, self.own)[2], axis=0).T).sum())
