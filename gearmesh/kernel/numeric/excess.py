"""Division of an interval between an allowed and a refused value, where refused values know how far a figure is beyond its limit.

The root of the excess is looked for from the refused side alone: an allowed value says only that it is allowed. Values are tried on
either side of the root in turn, so that both ends of the interval close in on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

#: distance from the root at which a value is tried: part of that from the root to the nearest refused value while only two of them
#: are known, then times the difference of two estimates; and part of the width that is wanted, at least
OF_DISTANCE, OF_DIFFERENCE, OF_WANTED = 0.1, 2.0, 0.4
#: divisions towards a root that must halve an interval
HALVING = 2

#: A refused value and its excess, None where no figure says so.
Refused = tuple[float, float | None]


class Division:
    """Divides one interval again and again."""

    def __init__(self) -> None:
        #: widths before the last divisions towards a root
        self._widths: list[float] = []
        #: whether the last value that was tried was refused
        self.last_refused = False

    def beside_root(self, good: float, bad: float, refused: Sequence[Refused], wanted: float) -> float | None:
        """Value next to the root of the excess between both ends, on the side that was not tried last.

        `refused`: values from `bad` on, away from `good`; `wanted`: width of the interval in the end. None where no root is known
        between the ends, or going by it did not narrow the interval.
        """
        aim = self._aim(good, bad, refused, wanted)
        if aim is None:
            self._widths.clear()
        else:
            self._widths.append(abs(good - bad))
        return aim

    def _aim(self, good: float, bad: float, refused: Sequence[Refused], wanted: float) -> float | None:
        if len(self._widths) >= HALVING and abs(good - bad) > 0.5 * self._widths[-HALVING]:
            return None
        points = _falling(refused)
        if len(points) < 2 or points[0][0] != bad:
            return None
        (x0, e0), (x1, e1) = points[:2]
        root = x0 - e0 * (x0 - x1) / (e0 - e1)
        apart = OF_DISTANCE * abs(root - x0)
        if len(points) > 2:
            closer = _inverse_quadratic(points[:3])
            root, apart = closer, OF_DIFFERENCE * abs(closer - root)
        apart = max(apart, OF_WANTED * wanted)
        inwards = math.copysign(1.0, good - bad)
        if not 0.0 < (root - bad) * inwards < (good - bad) * inwards:
            return None
        if self.last_refused:
            aim = root + inwards * apart
            return aim if (good - aim) * inwards > 0.0 else None
        aim = root - inwards * apart
        return aim if (aim - bad) * inwards > 0.0 else 0.5 * (bad + root)


def _falling(refused: Sequence[Refused]) -> list[tuple[float, float]]:
    """The first of the refused values as far as the excess rises from one to the next."""
    points: list[tuple[float, float]] = []
    for value, excess in refused:
        if excess is None or not 0.0 < excess < math.inf or (points and excess <= points[-1][1]):
            break
        points.append((value, excess))
    return points


def _inverse_quadratic(points: Sequence[tuple[float, float]]) -> float:
    """Value at which the excess is 0, by the quadratic through three points of the value over the excess."""
    total = 0.0
    for k, (value, excess) in enumerate(points):
        others = [other for j, (_, other) in enumerate(points) if j != k]
        total += value * others[0] * others[1] / ((excess - others[0]) * (excess - others[1]))
    return total
