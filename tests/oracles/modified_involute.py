"""Positions of two spur gears that touch at a point of a modified profile, in closed form, and their transmission error.

One of the flanks is a true involute: the common normal touches its base circle. The normal at roll length L of a flank that gives
way by a(L) leans by eps from that of the involute, tan(eps) = r_b a' / (L (1 + a')), and passes its axis at
rho = r_b cos(eps) - L sin(eps), so that the working pressure angle is cos(alpha) = (rho + r_b2) / A. Nothing has to be solved. On a
corner of the profile the slope a' takes all values between those on its sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: amount and slope at roll lengths
Profile = Callable[[Array], tuple[Array, Array]]


@dataclass(frozen=True)
class SpurPair:
    """Base radii of pinion and gear, and the distance of their axes, mm.

    Angles of a gear are those of its involutes' beginnings on the base circle, against the line of centres seen from its own axis.
    """

    pinion: float
    gear: float
    distance: float

    @property
    def line_of_action(self) -> float:
        """Its length between the base circles: roll lengths of pinion and gear add up to it."""
        return float(np.sqrt(self.distance**2 - (self.pinion + self.gear) ** 2))

    def standing(self, length: Array, a: Array, slope: Array, *, of_gear: bool = False) -> tuple[Array, Array]:
        """Angles (...,), rad, of pinion and gear that touch where one of them has these roll lengths, amounts and slopes."""
        own, mating = (self.gear, self.pinion) if of_gear else (self.pinion, self.gear)
        lean = np.arctan2(own * slope, length * (1.0 + slope))
        alpha = np.arccos((own * np.cos(lean) - length * np.sin(lean) + mating) / self.distance)
        phi = alpha - lean
        x, y = own * np.cos(phi) + length * np.sin(phi), own * np.sin(phi) - length * np.cos(phi)
        # of the normal, what is left to the mating gear's base circle
        rest = (self.distance - x) * np.sin(alpha) + y * np.cos(alpha)
        found = phi - (length + a) / own, alpha - rest / mating
        return found[::-1] if of_gear else found

    def advance(self, pinion: Array, gear: Array) -> Array:
        """Return the angle (...,), rad, by which the gear is ahead of its place with true involutes."""
        alpha = np.arccos((self.pinion + self.gear) / self.distance)
        true = (self.pinion + self.gear) * alpha - self.line_of_action
        found: Array = gear + (self.pinion * pinion - true) / self.gear
        return found


def pair_curve(
    pair: SpurPair,
    path: tuple[float, float],
    relieved: tuple[Profile, Profile],
    corners: tuple[float, float],
    count: int,
) -> tuple[Array, Array]:
    """Pinion angles, ascending, and advances of one pair of teeth whose contact goes over roll lengths `path` of the pinion.

    `relieved`: profiles of pinion and gear over their own roll lengths, of which those above `corners` are not 0; they do not meet.
    """
    whole, found = pair.line_of_action, []
    for of_gear, (profile, corner) in enumerate(zip(relieved, corners, strict=True)):
        last = whole - path[0] if of_gear else path[1]
        length = np.concatenate((np.full(count, corner), corner + (last - corner) * np.linspace(1e-9, 1.0, count)))
        a, slope = profile(length)
        slope[:count] = np.linspace(0.0, slope[count], count)
        found.append(pair.standing(length, a, slope, of_gear=bool(of_gear)))
    plain = np.linspace(whole - corners[1], corners[0], count)
    found.append(pair.standing(plain, 0.0 * plain, 0.0 * plain))
    pinion, gear = (np.concatenate(each) for each in zip(*found, strict=True))
    order = np.argsort(pinion)
    return pinion[order], pair.advance(pinion, gear)[order]


def peak_to_peak(angle: Array, advance: Array, pitch: float, count: int = 20_001) -> float:
    """Return the peak to peak, rad, of the greatest advance of all tooth pairs, one pitch (rad) apart; its least is refined."""

    def envelope(phase: Array) -> Array:
        pairs = [np.interp(phase + k * pitch, angle, advance, left=-np.inf, right=-np.inf) for k in range(-1, 4)]
        found: Array = np.max(pairs, axis=0)
        return found

    phase = np.linspace(angle[0], angle[0] + pitch, count)
    seen = envelope(phase)
    assert np.isfinite(seen).all()
    step, least = phase[1] - phase[0], phase[seen.argmin()]
    return float(seen.max() - envelope(np.linspace(least - step, least + step, count)).min())
