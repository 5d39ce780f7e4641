"""Cylindrical gears and their meshes in closed form [ISO 21771].

Tooth numbers, diameters and distances are positive. `sense` is +1 for external teeth and -1 for internal teeth; ISO
21771 gives this sign to the tooth number. Profile shifts are counted as in the standard: positive towards the tip,
which thickens external and internal teeth alike. All lengths share one unit, and angles are in rad. "Transverse" means
the section across the axis.

Teeth whose sides have different pressure angles are asymmetric. Each of their flanks is a flank of symmetric teeth with
its own angle (`Toothing.sides`), and has its own base circle. Figures of one flank are those of the drive side; figures
of whole teeth are sums over both sides.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side

#: largest working pressure angle (rad) that is searched
MAX_WORKING_ANGLE = 1.5


def involute(angle: float) -> float:
    """Return inv(angle) = tan(angle) - angle [ISO 21771]."""
    return math.tan(angle) - angle


def angle_of(involute_value: float) -> float:
    """Return the angle (rad) whose involute function is `involute_value`.

    NaN if the angle is not between 0 and MAX_WORKING_ANGLE.
    """
    return common_angle(involute_value, (1.0,))


def common_angle(mean_involute: float, ratios: Sequence[float]) -> float:
    """Return the angle a (rad) with a given mean of the involute functions of arccos(ratio cos(a)).

    `ratios`: base radii of the flanks over the largest of them, which is 1. NaN if the angle is not between 0 and
    MAX_WORKING_ANGLE.
    """

    def mean(angle: Array) -> Array:
        angles = [angle if ratio == 1.0 else np.arccos(ratio * np.cos(angle)) for ratio in ratios]
        return np.asarray(sum(np.tan(a) - a for a in angles) / len(ratios))

    ends = np.zeros(1), np.array([MAX_WORKING_ANGLE])
    if not mean(ends[0])[0] <= mean_involute <= mean(ends[1])[0]:
        return math.nan
    roots = bracketed_root(lambda a, _: mean(a) - mean_involute, *ends, tolerance=1e-15)
    return float(roots.values[0])


def mean_of(values: Sequence[float]) -> float:
    """Return the mean of a figure of all sides of teeth."""
    return sum(values) / len(values)


@dataclass(frozen=True)
class Toothing:
    """Teeth of one member."""

    #: number of teeth, positive
    teeth: int
    #: normal module m_n
    module: float
    #: normal pressure angle alpha_n, rad
    alpha: float
    #: helix angle, rad, positive right-handed
    beta: float = 0.0
    #: profile shift coefficient x
    shift: float = 0.0
    #: True for internal teeth
    internal: bool = False
    #: allowance A_sn of the normal tooth thickness at the reference cylinder
    allowance: float = 0.0
    #: normal pressure angle of the coast side of asymmetric teeth, rad; None for symmetric teeth
    coast_alpha: float | None = None
    #: drive side of asymmetric teeth: their right or left flanks
    drive: Side = Side.RIGHT

    @property
    def sides(self) -> tuple[Toothing, ...]:
        """Symmetric teeth with the flanks of each side: drive and coast side, or these teeth alone if they are symmetric."""
        if self.coast_alpha is None:
            return (self,)
        return tuple(replace(self, alpha=alpha, coast_alpha=None) for alpha in (self.alpha, self.coast_alpha))

    def side(self, side: Side) -> Toothing:
        """Return symmetric teeth with the right or the left flanks of these teeth."""
        return self.sides[0 if side is self.drive else -1]

    @property
    def asymmetric(self) -> bool:
        """True if both sides have different pressure angles."""
        return self.coast_alpha is not None

    @property
    def both_tangents(self) -> float:
        """Sum of tan(alpha_n) of both sides: the growth of the normal thickness with height on the rack."""
        return 2.0 * mean_of([math.tan(side.alpha) for side in self.sides])

    @property
    def sense(self) -> int:
        """+1 for external teeth, -1 for internal teeth."""
        return -1 if self.internal else 1

    @property
    def signed_teeth(self) -> int:
        """Tooth number with the sign of ISO 21771."""
        return self.sense * self.teeth

    @property
    def alpha_t(self) -> float:
        """Transverse pressure angle, rad."""
        return math.atan(math.tan(self.alpha) / math.cos(self.beta))

    @property
    def beta_b(self) -> float:
        """Helix angle at the base cylinder, rad."""
        return math.asin(math.sin(self.beta) * math.cos(self.alpha))

    @property
    def transverse_module(self) -> float:
        return self.module / math.cos(self.beta)

    @property
    def radius(self) -> float:
        """Radius of the reference cylinder."""
        return 0.5 * self.teeth * self.transverse_module

    @property
    def base_radius(self) -> float:
        return self.radius * math.cos(self.alpha_t)

    @property
    def largest_base_radius(self) -> float:
        """Base radius of the side with the larger one: below it a side has no involute."""
        return max(side.base_radius for side in self.sides)

    @property
    def base_pitch(self) -> float:
        """Transverse base pitch p_et."""
        return math.pi * self.transverse_module * math.cos(self.alpha_t)

    @property
    def twist(self) -> float:
        """Rotation of the transverse section per length along the axis, rad, right-handed positive."""
        return math.tan(self.beta) / self.radius

    @property
    def thickness(self) -> float:
        """Normal tooth thickness at the reference cylinder, including the allowance."""
        return self.module * (0.5 * math.pi + self.shift * self.both_tangents) + self.allowance

    @property
    def generating_shift(self) -> float:
        """Generating profile shift coefficient x_E = x + A_sn / (2 m_n tan(alpha_n)) for this thickness.

        Asymmetric teeth have the sum of the tangents of both sides in place of 2 tan(alpha_n).
        """
        return self.shift + self.allowance / (self.module * self.both_tangents)

    def half_angle(self, radius: float) -> float:
        """Return half of the tooth's transverse thickness at a radius, as an angle (rad) about the axis.

        The angle is positive up to the radius where the tooth is pointed. Half of the thickness of asymmetric teeth is
        the mean of both sides.
        """
        if self.asymmetric:
            return mean_of([side.half_angle(radius) for side in self.sides])
        at_reference = 0.5 * self.thickness / math.cos(self.beta) / self.radius
        pressure = math.acos(min(1.0, self.base_radius / radius))
        return at_reference + self.sense * (involute(self.alpha_t) - involute(pressure))

    def roll_length(self, radius: float) -> float:
        """Return the length of the involute's generator, from the base circle, at a radius.

        The radius must not be below the base circle.
        """
        return math.sqrt(max(0.0, radius**2 - self.base_radius**2))

    def rack_form_roll_length(self, depth: float, rounding: float) -> float:
        """Return the roll length on an external member of the end of a rack's straight flank.

        The roll length is negative if the rack undercuts the member.

        - depth: depth of the root below the reference cylinder.
        - rounding: radius of the rack's tip.
        """
        straight = depth - rounding * (1.0 - math.sin(self.alpha))
        return self.radius * math.sin(self.alpha_t) - straight / math.sin(self.alpha_t)

    def radius_at(self, height: float) -> float:
        """Return the radius at a `height` over the reference cylinder, counted towards the tip."""
        return self.radius + self.sense * height


def flank_sides(teeth: Toothing) -> tuple[Side, ...]:
    """Return the flanks of drive and coast side of asymmetric teeth; of symmetric teeth those of the drive side alone."""
    return (teeth.drive, teeth.drive.other) if teeth.asymmetric else (teeth.drive,)


def both_flanks(teeth: Toothing, normal: float) -> float:
    """Return the change of the normal thickness at the reference cylinder if both flanks move outwards.

    `normal`: distance of the flanks along their normals.
    """
    return 2.0 * mean_of([normal / math.cos(side.alpha) for side in teeth.sides])


@dataclass(frozen=True)
class InvolutePair:
    """Two members on parallel axes at a centre distance; at most one member is internal."""

    pinion: Toothing
    gear: Toothing
    distance: float

    @property
    def sum_of_teeth(self) -> int:
        """|z1 + z2|, with the signs of ISO 21771."""
        return abs(self.pinion.signed_teeth + self.gear.signed_teeth)

    @property
    def reference_distance(self) -> float:
        return 0.5 * self.sum_of_teeth * self.pinion.transverse_module

    @property
    def sides(self) -> tuple[InvolutePair, ...]:
        """Pairs of the flanks of each side, symmetric teeth: drive and coast side, or this pair alone if it is symmetric."""
        if not self.pinion.asymmetric:
            return (self,)
        both = zip(self.pinion.sides, self.gear.sides, strict=True)
        return tuple(replace(self, pinion=pinion, gear=gear) for pinion, gear in both)

    def working_side(self, flank: Side) -> InvolutePair:
        """Return the pair of the side that works when the right or the left flanks of the pinion drive."""
        return self.sides[0 if flank is self.pinion.drive else -1]

    @property
    def least_distance(self) -> float:
        """Sum (with an internal gear: difference) of the base radii, of the side with the larger ones."""
        return max(self.reference_distance * math.cos(side.alpha_t) for side in self.pinion.sides)

    @property
    def working_angle(self) -> float:
        """Transverse working pressure angle alpha_wt, rad."""
        return math.acos(self.reference_distance * math.cos(self.pinion.alpha_t) / self.distance)

    def working_radius(self, member: Toothing) -> float:
        """Return the radius of a member's working pitch cylinder."""
        return member.base_radius / math.cos(self.working_angle)

    @property
    def working_helix(self) -> float:
        """Helix angle (rad) of the pinion at its working pitch cylinder."""
        return math.atan(self.pinion.twist * self.working_radius(self.pinion))

    @property
    def working_backlash(self) -> float:
        """Circumferential backlash at the working pitch circles, j_wt."""
        pitch = 2.0 * math.pi * self.working_radius(self.pinion) / self.pinion.teeth
        arcs = (
            2.0 * radius * member.half_angle(radius)
            for member, radius in ((toothing, self.working_radius(toothing)) for toothing in (self.pinion, self.gear))
        )
        return pitch - sum(arcs)

    @property
    def normal_backlash(self) -> float:
        """Normal backlash j_bn = j_wt cos(alpha_wt) cos(beta_b)."""
        return self.normal_of(self.working_backlash)

    @property
    def normal_backlashes(self) -> tuple[float, ...]:
        """Normal backlash to the flanks of drive and coast side, or the one of symmetric teeth."""
        return tuple(side.normal_of(self.working_backlash) for side in self.sides)

    def normal_of(self, circumferential: float) -> float:
        """Return the normal backlash for a circumferential backlash at the working pitch circles."""
        return circumferential * math.cos(self.working_angle) * math.cos(self.pinion.beta_b)

    @property
    def generator(self) -> float:
        """Length a sin(alpha_wt) between the points where the line of action touches the base circles."""
        return self.distance * math.sin(self.working_angle)

    def mating_roll_length(self, length: float, of: Toothing) -> float:
        """Return the roll length on the mating gear where the member `of` has roll length `length`."""
        other = self.gear if of is self.pinion else self.pinion
        if other.internal or of.internal:
            return length + self.generator if other.internal else length - self.generator
        return self.generator - length

    def sliding(self, length: float) -> tuple[float, float]:
        """Return the specific sliding of pinion and gear at a roll length of the pinion.

        zeta = 1 - (speed of the mating gear along the flank) / (speed of the member itself). It is -inf where the
        member's flank is at rest, at its base circle.
        """
        speeds = length / self.pinion.teeth, self.mating_roll_length(length, self.pinion) / self.gear.teeth
        of_pinion, of_gear = (1.0 - mating / own if own > 0.0 else -math.inf for own, mating in (speeds, speeds[::-1]))
        return of_pinion, of_gear


def distance_of(pinion: Toothing, gear: Toothing) -> float:
    """Return the centre distance at which nominal teeth mesh without backlash; NaN if there is none.

    inv(alpha_wt) = inv(alpha_t) + 2 tan(alpha_n) (x1 + x2) / (z1 + z2), with the signs of ISO 21771. For asymmetric
    teeth the equation holds for the means of both sides.
    """
    signed = pinion.signed_teeth + gear.signed_teeth
    nominal = mean_of([involute(side.alpha_t) for side in pinion.sides])
    cosines = [math.cos(side.alpha_t) for side in pinion.sides]
    working = common_angle(
        nominal + pinion.both_tangents * (pinion.shift + gear.shift) / signed,
        [cosine / max(cosines) for cosine in cosines],
    )
    return 0.5 * abs(signed) * pinion.transverse_module * max(cosines) / math.cos(working)


def sum_of_shifts(pinion: Toothing, gear: Toothing, distance: float) -> float:
    """Return the sum x1 + x2 with which nominal teeth mesh without backlash at a centre distance.

    NaN if the distance is below the sum (with an internal gear: the difference) of the base radii.
    """
    signed = pinion.signed_teeth + gear.signed_teeth
    cosines = [0.5 * abs(signed) * side.transverse_module * math.cos(side.alpha_t) / distance for side in pinion.sides]
    return math.nan if max(cosines) > 1.0 else _shifts_with(pinion, signed, [math.acos(cosine) for cosine in cosines])


def shifts_at_angle(pinion: Toothing, gear: Toothing, angle: float) -> float:
    """Return the sum x1 + x2 with which nominal teeth mesh without backlash at a working pressure `angle` (rad).

    For asymmetric teeth it is the smaller working pressure angle of both sides.
    """
    cosines = [math.cos(side.alpha_t) for side in pinion.sides]
    ratios = [cosine / max(cosines) for cosine in cosines]
    angles = [angle if ratio == 1.0 else math.acos(ratio * math.cos(angle)) for ratio in ratios]
    return _shifts_with(pinion, pinion.signed_teeth + gear.signed_teeth, angles)


def _shifts_with(pinion: Toothing, signed: int, angles: Sequence[float]) -> float:
    """Return the sum x1 + x2 for the working pressure angles of the sides and the sum of the signed tooth numbers."""
    involutes = [involute(angle) - involute(side.alpha_t) for angle, side in zip(angles, pinion.sides, strict=True)]
    return signed * mean_of(involutes) / pinion.both_tangents


def specific_sliding(mesh: InvolutePair, tips: tuple[float, float]) -> tuple[float, float]:
    """Return the specific sliding at the ends of the path of contact: of the pinion at A, of the gear at E.

    These are the extremes of both members. `tips`: tip radii of pinion and gear. zeta = 1 - (speed of the mating gear
    along the flank) / (speed of the member itself). It is -inf if contact begins at the base circle.
    """
    begins = mesh.mating_roll_length(mesh.gear.roll_length(tips[1]), mesh.gear)
    return mesh.sliding(begins)[0], mesh.sliding(mesh.pinion.roll_length(tips[0]))[1]
