"""Micro-geometry of involute flanks: amounts over roll length and face position, with exact partials [ISO 21771-1; REXS 1.6].

Of racks they are over the height above the reference plane.

Every amount is in mm, positive where material is removed, along the line of action in the transverse plane. Fields add up. Each is
a bend, a function of one variable, along a direction of the (L, z) plane, a product of two of them, or a spline over a grid:

    tip and root relief, profile slope and crowning     bends over the roll length L, between root and tip form circle
    helix slope and crowning, end relief                bends over the face position z, between toe and heel
    triangular end relief                               a bend across the contact lines, L + h tan(beta_b) z
    profile twist                                       slope over L times slope over z
    topography                                          a cubic spline through amounts on a grid

Below the root form circle of an external gear, and above the tip form circle's lesser roll length of an internal one, amounts
level off: on the base circle nothing changes along the profile, and the involute begins there as the true one does.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair
from gearmesh.kernel.numeric.grid_spline import GridSpline
from gearmesh.teeth.micro_geometry.screw_involute import Amount, AmountJet

Shape = Literal["linear", "parabolic", "circular"]
ProfileEnd = Literal["tip", "root"]
FaceEnd = Literal["toe", "heel"]
#: how a relief may begin: with a corner, or tangent to the flank as a parabola or a circle is
SHAPES: tuple[Shape, ...] = ("linear", "parabolic", "circular")
#: amounts change by at most this much per length
STEEPEST = 0.1
#: share of the least roll length over which amounts level off below it
LEVELLING = 0.5


@dataclass(frozen=True)
class Extent:
    """Where a flank is evaluated: roll lengths at the root and tip form circles, or heights of a rack, face positions of toe and
    heel, mm. `levels`: amounts level off below it, towards the base circle."""

    root: float
    tip: float
    toe: float
    heel: float
    levels: bool = True

    @property
    def least(self) -> float:
        """The roll length nearest to the base circle."""
        return min(self.root, self.tip)


@dataclass(frozen=True)
class Kinks:
    """Lines on which a field is not smooth: roll lengths and face positions, mm, ascending.

    `creases`, `ridges`: those of either over which the flank has a corner, not only a jump of its curvature.
    """

    lengths: tuple[float, ...] = ()
    positions: tuple[float, ...] = ()
    creases: tuple[float, ...] = ()
    ridges: tuple[float, ...] = ()

    @staticmethod
    def together(parts: list[Kinks]) -> Kinks:
        """All of them, once each."""
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
    """amount ((x - zero) / scale)^degree, of degree 1 or 2."""

    amount: float
    zero: float
    scale: float
    degree: int

    def at(self, x: Array) -> tuple[Array, Array, Array]:
        t, slope = (x - self.zero) / self.scale, self.amount / self.scale
        if self.degree == 1:
            return self.amount * t, np.full_like(t, slope), np.zeros_like(t)
        return self.amount * t**2, 2.0 * slope * t, np.full_like(t, 2.0 * slope / self.scale)


@dataclass(frozen=True)
class Ramp:
    """0 up to `start`, `amount` at `end`, and on beyond: a line, a parabola, or a circle that touches the flank at the start."""

    amount: float
    start: float
    end: float
    shape: Shape = "linear"

    def at(self, x: Array) -> tuple[Array, Array, Array]:
        span, sense = abs(self.end - self.start), np.sign(self.end - self.start)
        s = np.maximum(sense * (x - self.start), 0.0)
        # at the start itself what comes after it counts
        on = (sense * (x - self.start) >= 0.0).astype(float)
        if self.shape == "linear":
            slope = self.amount / span
            return slope * s, sense * slope * on, np.zeros_like(s)
        if self.shape == "parabolic":
            bend = 2.0 * self.amount / span**2
            return 0.5 * bend * s**2, sense * bend * s, bend * on
        radius = (span**2 + self.amount**2) / (2.0 * self.amount)
        height = np.sqrt(radius**2 - s**2)
        return s**2 / (radius + height) * on, sense * s / height, radius**2 / height**3 * on

    def straight(self, x: float) -> Power:
        """The straight line that a linear ramp follows at x."""
        rises = (x - self.start) * (self.end - self.start) >= 0.0
        return Power(self.amount if rises else 0.0, self.start, self.end - self.start, 1)


@dataclass(frozen=True)
class Along:
    """A bend over x = by_length L + by_z z, with the `kinks` that it has."""

    bend: Bend
    by_length: float
    by_z: float
    kinks: Kinks = Kinks()

    def smooth(self, length: float, z: float) -> Along:
        """The field as it is at a place (mm), without the corner of a linear ramp."""
        if not isinstance(self.bend, Ramp) or self.bend.shape != "linear":
            return self
        return Along(self.bend.straight(self.by_length * length + self.by_z * z), self.by_length, self.by_z)

    def jet(self, length: Array, z: Array) -> AmountJet:
        a, a_x, a_xx = self.bend.at(self.by_length * length + self.by_z * z)
        k, m = self.by_length, self.by_z
        return AmountJet(a, k * a_x, m * a_x, k * k * a_xx, k * m * a_xx, m * m * a_xx)


@dataclass(frozen=True)
class ProfileTwist:
    """amount x y, of x and y that go from -1/2 to 1/2 over the profile and over the face."""

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
    """The cubic spline through amounts (I, J), mm, at roll lengths (I,) and face positions (J,), mm, both ascending.

    Beyond the grid it goes on straight.
    """

    lengths: tuple[float, ...]
    positions: tuple[float, ...]
    amounts: tuple[tuple[float, ...], ...]
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
        """Those of all fields that lie inside the extent."""
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
        """What it is about a place (mm), continued over the lines on which it has corners."""
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
    """Roll lengths (...,) for which amounts are taken, and two derivatives: the same from `least` on, level below half of it.

    With x from 0 to 1 on the way down its change is 1 - 3 x^2 + 2 x^3, smooth to the second derivative.
    """
    span = LEVELLING * least
    x = np.clip((least - length) / span, 0.0, 1.0)
    down = x - x**3 + 0.5 * x**4
    return (
        np.where(length >= least, length, least - span * down),
        np.where(length >= least, 1.0, 1.0 - 3.0 * x**2 + 2.0 * x**3),
        (6.0 * x - 6.0 * x**2) / span,
    )


def tip_relief(amount: float, start: float, extent: Extent, shape: Shape = "linear") -> FlankField:
    """From the roll length `start` to the tip form circle."""
    return _over_profile(Ramp(amount, start, extent.tip, shape))


def root_relief(amount: float, start: float, extent: Extent, shape: Shape = "linear") -> FlankField:
    """From the roll length `start` to the root form circle."""
    return _over_profile(Ramp(amount, start, extent.root, shape))


def end_relief(amount: float, length: float, extent: Extent, end: FaceEnd, shape: Shape) -> FlankField:
    """Over the last `length` mm of the face before an end."""
    last, other = (extent.toe, extent.heel) if end == "toe" else (extent.heel, extent.toe)
    ramp = Ramp(amount, last + np.copysign(length, other - last), last, shape)
    return Along(ramp, 0.0, 1.0, Kinks(positions=(ramp.start,), ridges=(ramp.start,) if shape == "linear" else ()))


def _over_profile(ramp: Ramp) -> FlankField:
    return Along(ramp, 1.0, 0.0, Kinks(lengths=(ramp.start,), creases=(ramp.start,) if ramp.shape == "linear" else ()))


def profile_crowning(amount: float, extent: Extent) -> FlankField:
    """A parabola: 0 in the middle of the profile, `amount` at both form circles."""
    return Along(Power(amount, 0.5 * (extent.root + extent.tip), 0.5 * (extent.tip - extent.root), 2), 1.0, 0.0)


def profile_slope(amount: float, extent: Extent) -> FlankField:
    """`amount` at the tip form circle and 0 at the root's; a negative one is removed at the root."""
    zero, end = (extent.root, extent.tip) if amount > 0.0 else (extent.tip, extent.root)
    return Along(Power(abs(amount), zero, end - zero, 1), 1.0, 0.0)


def profile_twist(amount: float, extent: Extent) -> FlankField:
    """The profile slope rises by `amount` from toe to heel; 0 in the middle of profile and face."""
    return ProfileTwist(amount, extent)


def helix_crowning(amount: float, extent: Extent) -> FlankField:
    """A parabola: 0 in the middle of the face, `amount` at toe and heel."""
    return Along(Power(amount, 0.5 * (extent.toe + extent.heel), 0.5 * (extent.heel - extent.toe), 2), 0.0, 1.0)


def helix_slope(amount: float, extent: Extent) -> FlankField:
    """`amount` at the heel and 0 at the toe; a negative one is removed at the toe."""
    zero, end = (extent.toe, extent.heel) if amount > 0.0 else (extent.heel, extent.toe)
    return Along(Power(abs(amount), zero, end - zero, 1), 0.0, 1.0)


def triangular_end_relief(amount: float, length: float, extent: Extent, lean: float, end: ProfileEnd) -> FlankField:
    """A parabola across the contact lines, L + lean z = const, in that corner at the tip or root which they cut off.

    `amount` in the corner; the line where it begins meets tip or root `length` mm from it. `lean` = h tan(beta_b), not 0; h = +1
    where the profile's angles rise outwards (see `ScrewInvolute.hand`).
    """
    profile = extent.tip if end == "tip" else extent.root
    away = np.sign(profile - (extent.root if end == "tip" else extent.tip))
    corner = profile + away * max(away * lean * z for z in (extent.toe, extent.heel))
    return Along(Ramp(amount, float(corner - away * abs(lean) * length), float(corner), "parabolic"), 1.0, lean)
