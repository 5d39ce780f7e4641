"""Division of an interval between an allowed and a refused value, by the excess of a figure over its limit at refused values.

Allowed values have no excess. The root of the excess is therefore extrapolated from refused values. Values are tried on both sides
of the root in turn, so that both ends of the interval approach it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

#: distance of a tried value from the root, over the distance of the root from the nearest refused value, for two refused values
DISTANCE_SHARE = 0.1
#: distance of a tried value from the root, over the difference of two estimates of the root, for three refused values
DIFFERENCE_FACTOR = 2.0
#: least distance of a tried value from the root, over the wanted width of the interval
MIN_WANTED_SHARE = 0.4
#: number of divisions towards a root that must halve the interval
HALVING_DIVISIONS = 2

#: refused value and its excess, None if unknown
Refused = tuple[float, float | None]


class Division:
    """Repeated division of one interval."""

    def __init__(self) -> None:
        #: widths before the last divisions towards a root
        self._widths: list[float] = []
        #: True if the last tried value was refused
        self.last_refused = False

    def beside_root(self, good: float, bad: float, refused: Sequence[Refused], wanted: float) -> float | None:
        """Return a value beside the root of the excess, on the side that was not tried last.

        - `good`, `bad`: allowed and refused end of the interval.
        - `refused`: refused values from `bad` on, away from `good`.
        - `wanted`: final width of the interval.

        Returns None if no root between the ends is known, or if the last divisions did not halve the interval.
        """
        aim = self._aim(good, bad, refused, wanted)
        if aim is None:
            self._widths.clear()
        else:
            self._widths.append(abs(good - bad))
        return aim

    def _aim(self, good: float, bad: float, refused: Sequence[Refused], wanted: float) -> float | None:
        if len(self._widths) >= HALVING_DIVISIONS and abs(good - bad) > 0.5 * self._widths[-HALVING_DIVISIONS]:
            return None
        # root by a secant through two refused values, or by inverse interpolation through three
        points = _falling(refused)
        if len(points) < 2 or points[0][0] != bad:
            return None
        (x0, e0), (x1, e1) = points[:2]
        root = x0 - e0 * (x0 - x1) / (e0 - e1)
        apart = DISTANCE_SHARE * abs(root - x0)
        if len(points) > 2:
            closer = _inverse_quadratic(points[:3])
            root, apart = closer, DIFFERENCE_FACTOR * abs(closer - root)
        apart = max(apart, MIN_WANTED_SHARE * wanted)
        inwards = math.copysign(1.0, good - bad)
        if not 0.0 < (root - bad) * inwards < (good - bad) * inwards:
            return None
        # try beyond the root after a refused value, else short of the root
        if self.last_refused:
            aim = root + inwards * apart
            return aim if (good - aim) * inwards > 0.0 else None
        aim = root - inwards * apart
        return aim if (aim - bad) * inwards > 0.0 else 0.5 * (bad + root)


def _falling(refused: Sequence[Refused]) -> list[tuple[float, float]]:
    """Return the first refused values, up to the first value whose excess does not rise."""
    points: list[tuple[float, float]] = []
    for value, excess in refused:
        if excess is None or not 0.0 < excess < math.inf or (points and excess <= points[-1][1]):
            break
        points.append((value, excess))
    return points


def _inverse_quadratic(points: Sequence[tuple[float, float]]) -> float:
    """Return the value with zero excess, by the quadratic of value over excess through three points."""
    total = 0.0
    for k, (value, excess) in enumerate(points):
        others = [other for j, (_, other) in enumerate(points) if j != k]
        total += value * others[0] * others[1] / ((excess - others[0]) * (excess - others[1]))
    return total
