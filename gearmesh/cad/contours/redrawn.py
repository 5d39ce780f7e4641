"""Approximation of smooth curves for machines: by tangent arcs, cubic splines or chords, within a tolerance.

Every stretch between two nodes becomes a biarc: two arcs that are tangent to the curve at the nodes and to each other at the
joint J. J lies half-way between the corners of the tangents, which are d from the nodes:

          J                   d = v.v / (v.t + sqrt((v.t)^2 + 2 (1 - t0.t1) v.v)),  v = P1 - P0,  t = t0 + t1
        _-*-_
    P0 /     \\ P1             the biarc with tangents of equal length [Bolton, Comput.-Aided Des. 7 (1975) 29]
    t0        t1

Nodes are placed so that every stretch has the same error. The error of arcs falls with the third power of the length, the error of
chords with the second power.
"""

from __future__ import annotations

from collections.abc import Callable
from enum import StrEnum
from typing import Protocol, TypeAlias

import numpy as np

from gearmesh.cad.contours.curves import CUBIC_DEGREE, PlaneSpline
from gearmesh.cad.nodes import Nodes
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, plane_cross
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine, lines_through

#: share of the tolerance that curves keep at the measured places
TOLERANCE_SHARE = 0.95
#: measured places of a stretch
PLACES_PER_STRETCH = 12
#: largest number of rounds of placing nodes
MAX_ROUNDS = 12
#: largest number of nodes of a curve
MAX_NODES = 5000
#: height of an arc below which it is drawn as a line
FLAT_ARC_MM = 1e-9


class Curves(StrEnum):
    """Kind of the curves that draw flanks and fillets of a section."""

    SPLINES = "splines"
    ARCS = "arcs"
    POLYLINE = "polyline"


class Smooth(Protocol):
    """A curve without corners over s from 0 to 1."""

    def at(self, s: Array) -> Array:
        """Return points (K, 2), mm."""

    def slope(self, s: Array) -> Array:
        """Return tangent vectors (K, 2) of any length."""


#: curves in order, and their largest distance (mm) from the exact curve
Redrawn: TypeAlias = tuple[tuple[PlaneCurve, ...], float]

#: function of a curve and parameters of nodes (N,); it returns a function that makes the pieces of the curve, and distances
#: (N - 1, PLACES_PER_STRETCH), mm, between the nodes
_Fit = Callable[[Smooth, Array], tuple[Callable[[], tuple[PlaneCurve, ...]], Array]]


def redraw(curve: Smooth, kind: Curves, tolerance: float) -> Redrawn:
    """Draw a smooth curve by curves of a kind within `tolerance` (mm). Raises NoSolutionError if the tolerance is not met."""
    if isinstance(curve, PlaneLine) or (isinstance(curve, PlaneArc) and kind is not Curves.POLYLINE):
        return (curve,), 0.0
    fit, degree = {Curves.ARCS: (_biarcs, 2), Curves.POLYLINE: (_chords, 1), Curves.SPLINES: (_spline, CUBIC_DEGREE)}[
        kind
    ]
    nodes, allowed = (
        Nodes(np.linspace(0.0, 1.0, degree + 1), degree=degree, most=MAX_NODES),
        TOLERANCE_SHARE * tolerance,
    )
    for turn in range(MAX_ROUNDS):
        pieces, miss = fit(curve, nodes.y)
        if miss.max() <= allowed:
            return pieces(), float(miss.max())
        nodes = nodes.spread(miss.max(axis=1) / allowed, turn)
    raise NoSolutionError(
        reason=f"{kind} with {nodes.y.size} points deviate by {1000.0 * miss.max():.3g} um, more than the tolerance of "
        f"{1000.0 * tolerance:g} um; choose a larger tolerance"
    )


def _between(y: Array) -> Array:
    """Return parameters (N - 1, PLACES_PER_STRETCH) between neighbouring nodes (N,)."""
    return y[:-1, None] + np.diff(y)[:, None] * (np.arange(1, PLACES_PER_STRETCH + 1) / (PLACES_PER_STRETCH + 1))


def _points(curve: Smooth, s: Array) -> Array:
    return curve.at(s.ravel()).reshape(*s.shape, 2)


def _headings(curve: Smooth, s: Array) -> Array:
    slope = curve.slope(s)
    return np.asarray(slope / np.linalg.norm(slope, axis=-1, keepdims=True))


def _chords(curve: Smooth, y: Array) -> tuple[Callable[[], tuple[PlaneCurve, ...]], Array]:
    points = curve.at(y)
    along, away = np.diff(points, axis=0), _points(curve, _between(y)) - points[:-1, None]
    length = np.linalg.norm(along, axis=-1)
    # a whole circle begins as a chord without length
    closed = length == 0.0
    along /= np.where(closed, 1.0, length)[:, None]
    miss = np.where(closed[:, None], np.linalg.norm(away, axis=-1), np.abs(plane_cross(along[:, None], away)))
    return lambda: lines_through(points), miss


def _spline(curve: Smooth, y: Array) -> tuple[Callable[[], tuple[PlaneCurve, ...]], Array]:
    from scipy.interpolate import make_interp_spline

    spline = make_interp_spline(y, curve.at(y), k=CUBIC_DEGREE)
    s = _between(y)
    miss = np.linalg.norm(spline(s) - _points(curve, s), axis=-1)
    return lambda: (PlaneSpline(spline.c, spline.t),), miss


def _biarcs(curve: Smooth, y: Array) -> tuple[Callable[[], tuple[PlaneCurve, ...]], Array]:
    points, headings = curve.at(y), _headings(curve, y)
    start, end, first, last = points[:-1], points[1:], headings[:-1], headings[1:]
    chord, both = end - start, first + last
    square, way = (chord * chord).sum(-1), (chord * both).sum(-1)
    turn = 1.0 - (first * last).sum(-1)
    reach = (square / (way + np.sqrt(way**2 + 2.0 * turn * square)))[:, None]
    joint = 0.5 * (start + reach * first + end - reach * last)
    # both arcs go from a node to the joint; the second one is reversed afterwards
    arcs = (_Arcs(start, first, joint), _Arcs(end, -last, joint))
    exact = _points(curve, _between(y))
    along = end - reach * last - start - reach * first
    ahead = ((exact - joint[:, None]) * along[:, None]).sum(-1)
    miss = np.where(ahead < 0.0, arcs[0].distance(exact), arcs[1].distance(exact))
    return lambda: tuple(c for k in range(len(joint)) for c in (arcs[0].curve(k), arcs[1].curve(k, back=True))), miss


class _Arcs:
    """Arcs (N,) from points (N, 2) with headings (N, 2) to other points."""

    def __init__(self, start: Array, heading: Array, end: Array) -> None:
        chord = end - start
        self.start, self.end = start, end
        self.half = np.arctan2(plane_cross(heading, chord), (heading * chord).sum(-1))
        self.length = np.linalg.norm(chord, axis=-1)
        self.normal = np.stack((-heading[:, 1], heading[:, 0]), axis=-1)
        self.curvature = 2.0 * np.sin(self.half) / self.length

    def distance(self, points: Array) -> Array:
        """Return distances (N, K), mm, of points (N, K, 2) from the circles; exact for nearly straight arcs, too."""
        to = points - self.start[:, None]
        k = self.curvature[:, None]
        # a point at distance h inside a circle of curvature k: k |to|^2 - 2 to.n = -2 h + k h^2
        q = k * (to * to).sum(-1) - 2.0 * (to * self.normal[:, None]).sum(-1)
        return np.asarray(np.abs(q / (1.0 + np.sqrt(np.maximum(1.0 + k * q, 0.0)))))

    def curve(self, k: int, back: bool = False) -> PlaneCurve:
        """Return arc number k, or the reversed arc."""
        start, end = (self.end[k], self.start[k]) if back else (self.start[k], self.end[k])
        if abs(0.5 * self.length[k] * np.tan(0.5 * self.half[k])) <= FLAT_ARC_MM:
            return PlaneLine(start, end)
        centre = self.start[k] + self.normal[k] / self.curvature[k]
        arm, width = start - centre, 2.0 * float(self.half[k]) * (-1.0 if back else 1.0)
        return PlaneArc(centre, float(np.linalg.norm(arm)), float(np.arctan2(arm[1], arm[0])), width)
