"""Forms of a bore that is not round: keyway, hexagon, flats. Each is a round bore together with a polygon, or inside it.

The outline is a closed line of arcs about the axis and of straight lines. Lengths are in mm, angles in rad.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine, lines_through
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region

#: a closed line of curves, counterclockwise
ClosedLine = tuple[PlaneCurve, ...]

#: half the angle between the corners of a hexagon
HALF_SIXTH_RAD = np.pi / 6.0


class BoreForm(Protocol):
    """A bore that is not round. `radius` is that of the round bore, mm, everywhere."""

    @property
    def name(self) -> str:
        """Name in texts."""

    @property
    def region(self) -> Region:
        """Region of the plane walls."""

    @property
    def symmetry(self) -> int:
        """Number of turns about the axis, up to a full turn, after which the bore looks the same."""

    @property
    def mark(self) -> str:
        """Letters after the number of its dimension."""

    @property
    def limits(self) -> bool:
        """True if the bore is inside both circle and polygon, False if it has all that is inside one of them."""

    def polygon(self, radius: float) -> Array:
        """Return the corners (N, 2), counterclockwise, of the polygon."""

    def in_bore(self, radius: float) -> ClosedLine:
        """Return the outline of the bore, in the plane across the axis."""

    def reach(self, radius: float) -> float:
        """Return the largest distance from the axis."""

    def on_x(self, radius: float) -> tuple[float, float]:
        """Return the distances of the outline from the axis on +x and on -x."""

    def across(self, radius: float) -> tuple[float, float] | None:
        """Return the y of both ends of the dimension along y; None without one."""

    def along(self, radius: float) -> tuple[float, float] | None:
        """Return the x of both ends of the dimension along x; None without one."""


@dataclass(frozen=True)
class Slot:
    """Keyway in the bore, mm: `width`, and `depth` beyond the bore's radius."""

    width: float
    depth: float

    @property
    def name(self) -> str:
        return "keyway"

    @property
    def region(self) -> Region:
        return Region.KEYWAY

    @property
    def symmetry(self) -> int:
        return 1

    @property
    def mark(self) -> str:
        return ""

    @property
    def limits(self) -> bool:
        return False

    def polygon(self, radius: float) -> Array:
        half, bottom = 0.5 * self.width, radius + self.depth
        return np.array([(0.0, -half), (bottom, -half), (bottom, half), (0.0, half)])

    def in_bore(self, radius: float) -> ClosedLine:
        """Return the outline of a bore with the keyway on +x: the arc, and from its end the three lines.

        `radius`: radius of the bore, mm. Result: closed, counterclockwise, in the plane across the axis, mm.
        """
        half, bottom = 0.5 * self.width, radius + self.depth
        first = float(np.arcsin(half / radius))
        near = radius * np.cos(first)
        arc = PlaneArc(np.zeros(2), radius, first, 2.0 * (np.pi - first))
        return arc, *lines_through([(near, -half), (bottom, -half), (bottom, half), (near, half)])

    def reach(self, radius: float) -> float:
        """Return the distance of its corners from the axis.

        `radius`: radius of the bore, mm. Result: mm.
        """
        return float(np.hypot(radius + self.depth, 0.5 * self.width))

    def on_x(self, radius: float) -> tuple[float, float]:
        return radius + self.depth, radius

    def across(self, radius: float) -> tuple[float, float]:
        return -0.5 * self.width, 0.5 * self.width

    def along(self, radius: float) -> tuple[float, float]:
        return -radius, radius + self.depth


@dataclass(frozen=True)
class Hexagon:
    """Hexagon with corners on +x and -x, mm: `across_flats`. A wider round bore is drilled before it is broached."""

    across_flats: float

    @property
    def name(self) -> str:
        return "hexagon of the bore"

    @property
    def region(self) -> Region:
        return Region.BORE_FLAT

    @property
    def symmetry(self) -> int:
        return 6

    @property
    def mark(self) -> str:
        return " A/F"

    @property
    def limits(self) -> bool:
        return False

    @property
    def corner(self) -> float:
        """Distance of the corners from the axis, mm."""
        return float(0.5 * self.across_flats / np.cos(HALF_SIXTH_RAD))

    def polygon(self, radius: float) -> Array:
        return np.array([self._corner(k) for k in range(6)])

    def in_bore(self, radius: float) -> ClosedLine:
        inner, ends = 0.5 * self.across_flats, self.polygon(radius)
        if radius <= inner:
            return lines_through([*ends, ends[0]])
        # in the middle of each flat the outline follows the round bore
        half, curves = float(np.arccos(inner / radius)), list[PlaneCurve]()
        for k in range(6):
            middle = (2 * k + 1) * HALF_SIXTH_RAD
            arc = PlaneArc(np.zeros(2), radius, middle - half, 2.0 * half)
            following = PlaneArc(np.zeros(2), radius, middle + 2.0 * HALF_SIXTH_RAD - half, 2.0 * half)
            curves += [arc, *lines_through([arc.end, ends[(k + 1) % 6], following.start])]
        return tuple(curves)

    def reach(self, radius: float) -> float:
        return max(self.corner, radius)

    def on_x(self, radius: float) -> tuple[float, float]:
        return self.reach(radius), self.reach(radius)

    def across(self, radius: float) -> tuple[float, float]:
        return -0.5 * self.across_flats, 0.5 * self.across_flats

    def along(self, radius: float) -> None:
        return None

    def _corner(self, k: int) -> Array:
        angle = 2.0 * k * HALF_SIXTH_RAD
        return self.corner * np.array([np.cos(angle), np.sin(angle)])


@dataclass(frozen=True)
class Flats:
    """Round bore with one flat on +x (a D), or with a second one on -x; mm."""

    #: distance from the flat on +x to the opposite side of the bore, or to the second flat
    height: float
    #: number of flats, 1 or 2
    count: int = 1

    @property
    def name(self) -> str:
        return "flat of the bore" if self.count == 1 else "flats of the bore"

    @property
    def region(self) -> Region:
        return Region.BORE_FLAT

    @property
    def symmetry(self) -> int:
        return self.count

    @property
    def mark(self) -> str:
        return ""

    @property
    def limits(self) -> bool:
        return True

    def polygon(self, radius: float) -> Array:
        high, low = self.on_x(radius)
        # where there is no flat the polygon is wider than the bore
        left, half = -low if self.count > 1 else -2.0 * radius, 2.0 * radius
        return np.array([(left, -half), (high, -half), (high, half), (left, half)])

    def in_bore(self, radius: float) -> ClosedLine:
        half = float(np.arccos(self.on_x(radius)[0] / radius))
        turn = 2.0 * np.pi / self.count
        arcs = [PlaneArc(np.zeros(2), radius, k * turn + half, turn - 2.0 * half) for k in range(self.count)]
        following = [*arcs[1:], arcs[0]]
        return tuple(
            curve
            for arc, after in zip(arcs, following, strict=True)
            for curve in (arc, PlaneLine(arc.end, after.start))
        )

    def reach(self, radius: float) -> float:
        return radius

    def on_x(self, radius: float) -> tuple[float, float]:
        return (self.height - radius, radius) if self.count == 1 else (0.5 * self.height, 0.5 * self.height)

    def across(self, radius: float) -> None:
        return None

    def along(self, radius: float) -> tuple[float, float]:
        high, low = self.on_x(radius)
        return -low, high


def beside_circle(outline: ClosedLine, radius: float) -> tuple[ClosedLine, ...]:
    """Return closed lines round the areas between the outline of a bore and its circle.

    Areas that the outline adds to the circle are counterclockwise, areas that it lacks clockwise. If no part of the outline
    is on the circle, outline and circle, which is clockwise, are one element.
    """
    arcs = [(k, curve) for k, curve in enumerate(outline) if isinstance(curve, PlaneArc)]
    if not arcs:
        return ((*outline, PlaneArc(np.zeros(2), radius, 0.0, -2.0 * np.pi)),)
    parts = []
    for (k, arc), (after, following) in zip(arcs, [*arcs[1:], arcs[0]], strict=True):
        way = outline[k + 1 : after] if after > k else (*outline[k + 1 :], *outline[:after])
        width = (following.first - arc.first - arc.width) % (2.0 * np.pi)
        parts.append((*way, PlaneArc(arc.centre, radius, following.first, -width)))
    return tuple(parts)
