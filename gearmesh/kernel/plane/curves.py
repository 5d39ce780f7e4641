"""Curves in a plane: the common interface of all curves of sections, straight lines and arcs.

Points are (x, y), mm.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass


class PlaneCurve(Protocol):
    """A curve in the plane of a section."""

    @property
    def start(self) -> Array:
        """First point (2,), mm."""

    @property
    def end(self) -> Array:
        """Last point (2,), mm."""

    @property
    def swept(self) -> float:
        """Area (mm^2) swept by the line from the origin to the curve's point, positive counterclockwise."""

    def at(self, s: Array) -> Array:
        """Return points of the curve.

        `s`: (K,), from 0 to 1. Result: (K, 2), mm.
        """

    def slope(self, s: Array) -> Array:
        """Return derivatives of the points.

        `s`: (K,), from 0 to 1. Result: (K, 2), mm, with respect to s.
        """

    def turn(self, angle: float) -> PlaneCurve:
        """Return the curve turned about the origin.

        `angle`: rad, counterclockwise.
        """

    def move(self, way: Array) -> PlaneCurve:
        """Return the curve moved by a vector.

        `way`: (2,), mm.
        """


@dataclass(frozen=True)
class PlaneLine:
    """A straight line between two points (2,), mm."""

    start: Array
    end: Array

    @property
    def swept(self) -> float:
        return 0.5 * float(self.start[0] * self.end[1] - self.start[1] * self.end[0])

    def at(self, s: Array) -> Array:
        return np.asarray(self.start + s[:, None] * (self.end - self.start))

    def slope(self, s: Array) -> Array:
        return np.broadcast_to(self.end - self.start, (len(s), 2))

    def turn(self, angle: float) -> PlaneLine:
        turned = rotation(angle)
        return PlaneLine(turned @ self.start, turned @ self.end)

    def move(self, way: Array) -> PlaneLine:
        return PlaneLine(self.start + way, self.end + way)


def lines_through(points: Iterable[Sequence[float] | Array]) -> tuple[PlaneLine, ...]:
    """Return the lines from each point (2,), mm, to the next."""
    return tuple(PlaneLine(start, end) for start, end in pairwise(np.asarray(point) for point in points))


@dataclass(frozen=True)
class PlaneArc:
    """An arc of a circle."""

    #: centre (2,), mm
    centre: Array
    #: radius, mm
    radius: float
    #: polar angle of the first point, rad
    first: float
    #: angle of the arc, rad, negative for a clockwise arc
    width: float

    @staticmethod
    def circle(radius: float, centre: Sequence[float] | Array = (0.0, 0.0)) -> PlaneArc:
        """Return a full circle.

        `centre`: (2,), mm.
        """
        return PlaneArc(np.array(centre, dtype=float), radius, 0.0, 2.0 * np.pi)

    @property
    def closed(self) -> bool:
        """True for a full circle."""
        return abs(self.width) == 2.0 * np.pi

    @property
    def start(self) -> Array:
        return np.asarray(self.at(np.zeros(1))[0])

    @property
    def end(self) -> Array:
        return np.asarray(self.at(np.ones(1))[0])

    @property
    def swept(self) -> float:
        (x, y), last_angle = self.centre, self.first + self.width
        lever = x * (np.sin(last_angle) - np.sin(self.first)) - y * (np.cos(last_angle) - np.cos(self.first))
        return 0.5 * self.radius * float(self.radius * self.width + lever)

    def at(self, s: Array) -> Array:
        angle = self.first + s * self.width
        return np.asarray(self.centre + self.radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1))

    def slope(self, s: Array) -> Array:
        angle = self.first + s * self.width
        return self.radius * self.width * np.stack((-np.sin(angle), np.cos(angle)), axis=-1)

    def turn(self, angle: float) -> PlaneArc:
        return PlaneArc(rotation(angle) @ self.centre, self.radius, self.first + angle, self.width)

    def move(self, way: Array) -> PlaneArc:
        return PlaneArc(self.centre + way, self.radius, self.first, self.width)


def rotation(angle: float) -> Array:
    """Return the matrix (2, 2) of a counterclockwise turn by an angle (rad)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(c, -s), (s, c)])
