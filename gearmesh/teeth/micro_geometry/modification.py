"""Micro-geometry of involute flanks: amounts over roll length and face position, with exact partials [ISO 21771-1; REXS
1.6].

For racks the amounts are functions of the height above the reference plane instead of the roll length. Every amount is
in mm, positive where material is removed, along the line of action in the transverse plane. Fields add up. A field is a
bend (a function of one variable) along a direction of the (L, z) plane, a product of two bends, or a spline over a
grid:

    tip and root relief, profile slope and crowning     bends over the roll length L, between root and tip form circle
    helix slope and crowning, end relief                bends over the face position z, between toe and heel
    triangular end relief                               a bend across the contact lines, L + h tan(beta_b) z
    profile twist                                       slope over L times slope over z
    topography                                          a cubic spline through amounts on a grid

Amounts level off below the root form circle of an external gear, and beyond the smaller roll length (at the tip form
circle) of an internal one. On the base circle they do not change along the profile, and the involute begins there as
the true one does.
"""

from __future__ import annotations

from functools import cached_property
from typing import Literal, Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair
from gearmesh.kernel.numeric.grid_spline import GridSpline
from gearmesh.records import dataclass
from gearmesh.teeth.micro_geometry.screw_involute import Amount, AmountJet

Shape = Literal["linear", "parabolic", "circular"]
ProfileEnd = Literal["tip", "root"]
FaceEnd = Literal["toe", "heel"]
#: shapes of the beginning of a relief: a corner, or a parabola or circle tangent to the flank
RELIEF_SHAPES: tuple[Shape, ...] = ("linear", "parabolic", "circular")
#: largest slope of an amount, mm/mm
MAX_AMOUNT_SLOPE = 0.1
#: share of the least roll length over which amounts level off below it
LEVELLING_SHARE = 0.5


@dataclass(frozen=True)
class Extent:
    """Range in which a flank is evaluated, mm."""

    #: roll length at the root form circle, or height of a rack
    root: float
    #: roll length at the tip form circle, or height of a rack
    tip: float
    #: face position of the toe
    toe: float
    #: face position of the heel
    heel: float
    #: True if amounts level off below the range, towards the base circle
    levels: bool = True

    @property
    def least(self) -> float:
        """Roll length nearest to the base circle."""
        return min(self.root, self.tip)


@dataclass(frozen=True)
class Kinks:
    """Lines on which a field is not smooth; mm, ascending."""

    #: roll lengths of the lines along the face
    lengths: tuple[float, ...] = ()
    #: face positions of the lines along the profile
    positions: tuple[float, ...] = ()
    #: those of `lengths` over which the flank has a corner, not only a jump of its curvature
    creases: tuple[float, ...] = ()
    #: those of `positions` over which the flank has a corner
    ridges: tuple[float, ...] = ()

    @staticmethod
    def together(parts: list[Kinks]) -> Kinks:
        """Return all lines of several fields, once each."""
        names = ("lengths", "positions", "creases", "ridges")
        return Kinks(*(tuple(sorted({x for part in parts for x in getattr(part, name)})) for name in names))


class Bend(Protocol):
    """A function of one variable x (...,), mm, with its first two derivatives (...,)."""

    def at(self, x: Array) -> tuple[Array, Array, Array]: ...


class FlankField(Amount, Protocol):
    """An amount over a flank that knows where it is not smooth."""

    @property
    def kinks(self) -> Kinks: ...


@dataclass(frozen=True)
class Power:
    """amount ((x - zero) / scale)^degree"""

    #: amount at x = zero + scale, mm
    amount: float
    #: x at which the bend is 0, mm
    zero: float
    #: length over which it reaches `amount`, mm; signed
    scale: float
    #: 1 or 2
    degree: int

    def at(self, x: Array) -> tuple[Array, Array, Array]:
        t, slope = (x - self.zero) / self.scale, self.amount / self.scale
        if self.degree == 1:
            return self.amount * t, np.full_like(t, slope), np.zeros_like(t)
        return self.amount * t**2, 2.0 * slope * t, np.full_like(t, 2.0 * slope / self.scale)


@dataclass(frozen=True)
class Ramp:
    """A bend that is 0 up to `start`, `amount` at `end`, and continues beyond."""

    #: amount at the end, mm
    amount: float
    #: x at which the ramp begins, mm
    start: float
    #: x at which it reaches `amount`, mm
    end: float
    #: a line, or a parabola or circle that is tangent to the flank at the start
    shape: Shape = "linear"

    def at(self, x: Array) -> tuple[Array, Array, Array]:
        span, sense = abs(self.end - self.start), np.sign(self.end - self.start)
        s = np.maximum(sense * (x - self.start), 0.0)
        # at the start itself the derivatives are those of the ramp
        on_ramp = (sense * (x - self.start) >= 0.0).astype(float)
        if self.shape == "linear":
            slope = self.amount / span
            return slope * s, sense * slope * on_ramp, np.zeros_like(s)
        if self.shape == "parabolic":
            bend = 2.0 * self.amount / span**2
            return 0.5 * bend * s**2, sense * bend * s, bend * on_ramp
        radius = (span**2 + self.amount**2) / (2.0 * self.amount)
        height = np.sqrt(radius**2 - s**2)
        return s**2 / (radius + height) * on_ramp, sense * s / height, radius**2 / height**3 * on_ramp

    def straight(self, x: float) -> Power:
        """Return the straight line that a linear ramp follows at x."""
        rises = (x - self.start) * (self.end - self.start) >= 0.0
        return Power(self.amount if rises else 0.0, self.start, self.end - self.start, 1)


@dataclass(frozen=True)
class Along:
    """A bend over x = by_length L + by_z z."""

    #: function of x
    bend: Bend
    #: derivative of x by the roll length L
    by_length: float
    #: derivative of x by the face position z
    by_z: float
    #: lines on which the field is not smooth
    kinks: Kinks = Kinks()

    def smooth(self, length: float, z: float) -> Along:
        """Return the field near a place (mm), without the corner of a linear ramp."""
        if not isinstance(self.bend, Ramp) or self.bend.shape != "linear":
            return self
        return Along(self.bend.straight(self.by_length * length + self.by_z * z), self.by_length, self.by_z)

    def jet(self, length: Array, z: Array) -> AmountJet:
        a, a_x, a_xx = self.bend.at(self.by_length * length + self.by_z * z)
        k, m = self.by_length, self.by_z
        return AmountJet(a, k * a_x, m * a_x, k * k * a_xx, k * m * a_xx, m * m * a_xx)


@dataclass(frozen=True)
class ProfileTwist:
    """amount x y, where x and y go from -1/2 to 1/2 over the profile and over the face."""

    amount: float
    extent: Extent
    kinks: Kinks = Kinks()

    def jet(self, length: Array, z: Array) -> AmountJet:
        e = self.extent
        x, y = (length - 0.5 * (e.root + e.tip)) / (e.tip - e.root), (z - 0.5 * (e.toe + e.heel)) / (e.heel - e.toe)
        per_x, per_y, zero = self.amount / (e.tip - e.root), self.amount / (e.heel - e.toe), np.zeros_like(x)
        return AmountJet(self.amount * x * y, per_x * y, per_y * x, zero, zero + per_x / (e.heel - e.toe), zero)


@dataclass(frozen=True)
class Topography:
    """Cubic spline through amounts on a grid, straight beyond it."""

    #: roll lengths (I,), mm, ascending
    lengths: tuple[float, ...]
    #: face positions (J,), mm, ascending
    positions: tuple[float, ...]
    #: amounts (I, J), mm
    amounts: tuple[tuple[float, ...], ...]
    #: the spline has no corners
    kinks: Kinks = Kinks()

    @cached_property
    def _spline(self) -> GridSpline:
        return GridSpline.through(np.array(self.lengths), np.array(self.positions), np.array(self.amounts))

    def jet(self, length: Array, z: Array) -> AmountJet:
        return AmountJet(*self._spline.jet(length, z))


@dataclass(frozen=True)
class Modification:
    """The sum of fields over an extent."""

    fields: tuple[FlankField, ...]
    extent: Extent

    @property
    def kinks(self) -> Kinks:
        """Lines of all fields that lie inside the extent."""
        e = self.extent
        low, high = sorted((e.root, e.tip))
        near, far = sorted((e.toe, e.heel))
        every = Kinks.together([field.kinks for field in self.fields])

        def between(values: tuple[float, ...], first: float, last: float) -> tuple[float, ...]:
            return tuple(x for x in values if first < x < last)

        return Kinks(
            between(every.lengths, low, high),
            between(every.positions, near, far),
            between(every.creases, low, high),
            between(every.ridges, near, far),
        )

    def smooth(self, length: float, z: float) -> Modification:
        """Return the modification near a place (mm), continued over the lines on which it has corners."""
        fields = tuple(field.smooth(length, z) if isinstance(field, Along) else field for field in self.fields)
        return Modification(fields, self.extent)

    def jet(self, length: Array, z: Array) -> AmountJet:
        length, z = broadcast_pair(length, z)
        one = np.ones_like(length)
        x, x_l, x_ll = level_off(length, self.extent.least) if self.extent.levels else (length, one, 0.0 * one)
        parts = [field.jet(x, z) for field in self.fields]
        a, a_l, a_z, a_ll, a_lz, a_zz = (
            sum((getattr(part, name) for part in parts), np.zeros(length.shape))
            for name in ("a", "a_l", "a_z", "a_ll", "a_lz", "a_zz")
        )
        return AmountJet(a, a_l * x_l, a_z, a_ll * x_l**2 + a_l * x_ll, a_lz * x_l, a_zz)


def level_off(length: Array, least: float) -> tuple[Array, Array, Array]:
    """Roll lengths (...,) at which amounts are evaluated, and two derivatives.

    They are `length` itself from `least` on, and constant below half of it. With x from 0 to 1 on the way down the
    slope is 1 - 3 x^2 + 2 x^3, smooth to the second derivative.
    """
    span = LEVELLING_SHARE * least
    x = np.clip((least - length) / span, 0.0, 1.0)
    down = x - x**3 + 0.5 * x**4
    return (
        np.where(length >= least, length, least - span * down),
        np.where(length >= least, 1.0, 1.0 - 3.0 * x**2 + 2.0 * x**3),
        (6.0 * x - 6.0 * x**2) / span,
    )


def tip_relief(amount: float, start: float, extent: Extent, shape: Shape = "linear") -> FlankField:
    """Return a relief from the roll length `start` to the tip form circle."""
    return _over_profile(Ramp(amount, start, extent.tip, shape))


def root_relief(amount: float, start: float, extent: Extent, shape: Shape = "linear") -> FlankField:
    """Return a relief from the roll length `start` to the root form circle."""
    return _over_profile(Ramp(amount, start, extent.root, shape))


def end_relief(amount: float, length: float, extent: Extent, end: FaceEnd, shape: Shape) -> FlankField:
    """Return a relief over the last `length` mm of the face before an end."""
    last, other = (extent.toe, extent.heel) if end == "toe" else (extent.heel, extent.toe)
    ramp = Ramp(amount, last + np.copysign(length, other - last), last, shape)
    return Along(ramp, 0.0, 1.0, Kinks(positions=(ramp.start,), ridges=(ramp.start,) if shape == "linear" else ()))


def _over_profile(ramp: Ramp) -> FlankField:
    """Return the field of a ramp over the roll length."""
    return Along(ramp, 1.0, 0.0, Kinks(lengths=(ramp.start,), creases=(ramp.start,) if ramp.shape == "linear" else ()))


def profile_crowning(amount: float, extent: Extent) -> FlankField:
    """Return a parabola over the profile: 0 in its middle, `amount` at both form circles."""
    return Along(Power(amount, 0.5 * (extent.root + extent.tip), 0.5 * (extent.tip - extent.root), 2), 1.0, 0.0)


def profile_slope(amount: float, extent: Extent) -> FlankField:
    """Return a slope: `amount` at the tip form circle and 0 at the root form circle; a negative amount is removed at
    the root.
    """
    zero, end = (extent.root, extent.tip) if amount > 0.0 else (extent.tip, extent.root)
    return Along(Power(abs(amount), zero, end - zero, 1), 1.0, 0.0)


def profile_twist(amount: float, extent: Extent) -> FlankField:
    """Return a twist: the profile slope rises by `amount` from toe to heel; 0 in the middle of profile and face."""
    return ProfileTwist(amount, extent)


def helix_crowning(amount: float, extent: Extent) -> FlankField:
    """Return a parabola over the face: 0 in its middle, `amount` at toe and heel."""
    return Along(Power(amount, 0.5 * (extent.toe + extent.heel), 0.5 * (extent.heel - extent.toe), 2), 0.0, 1.0)


def helix_slope(amount: float, extent: Extent) -> FlankField:
    """Return a slope: `amount` at the heel and 0 at the toe; a negative amount is removed at the toe."""
    zero, end = (extent.toe, extent.heel) if amount > 0.0 else (extent.heel, extent.toe)
    return Along(Power(abs(amount), zero, end - zero, 1), 0.0, 1.0)


def triangular_end_relief(amount: float, length: float, extent: Extent, lean: float, end: ProfileEnd) -> FlankField:
    """Return a parabola across the contact lines, L + lean z = const, in the corner at tip or root that they cut off.

    `amount`: amount in the corner. `length`: distance from the corner, mm, along tip or root, of the line where the
    relief begins. `lean`: h tan(beta_b), not 0; h = +1 where the profile's angles rise outwards (see
    `ScrewInvolute.hand`).
    """
    profile = extent.tip if end == "tip" else extent.root
    away = np.sign(profile - (extent.root if end == "tip" else extent.tip))
    corner = profile + away * max(away * lean * z for z in (extent.toe, extent.heel))
    return Along(Ramp(amount, float(corner - away * abs(lean) * length), float(corner), "parabolic"), 1.0, lean)
