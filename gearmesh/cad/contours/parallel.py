"""Parallels of contours at a distance: the path of the centre of a wire or beam, trimmed so that it does not cut into the part.

Every curve is moved along its normals. At a corner that opens a gap, an arc about the corner joins the parallels. Where parallels
cross, the path is cut and continues on the other branch:

       ___     ___              crossing: in along one branch, out along the other; the loop behind the
          \\   /                 crossing is nearer to the part than the distance and is dropped
           \\ /
            X                   [Chen & McMains, ASME DETC2005-85513: loops of winding number 1]
           / \\
          (   )

The remaining path has the distance everywhere. Stock stays in corners that are sharper than the wire.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gearmesh.cad.contours.curves import Contour, PlaneSpline
from gearmesh.cad.contours.redrawn import Curves, Smooth, redraw
from gearmesh.kernel.numeric.algebra import Array, plane_cross
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

#: error of the distance, as a share of the tolerance, below which an arc that joins parallels of splines is left out
SHORT_ARC_SHARE = 0.05
#: angle between splines below which no arc joins their parallels: the error of fitted splines
TANGENT_ANGLE_RAD = 1e-4
#: angle between arcs and lines below which they are tangent
ROUNDING_ANGLE_RAD = 1e-9
#: least number of points on a curve
MIN_POINTS_PER_CURVE = 48
#: largest spacing of points, as a share of the offset
SPACING_PER_OFFSET = 0.1
#: largest spacing of points, as a share of the size of the contour
SPACING_PER_SIZE = 2e-3
#: share of the distance by which a dropped path is nearer to the contour
NEARER_SHARE = 2e-2
#: spacing of the points that measure the distance of a path, as a share of the distance: the error is below 1/64 of the distance
SAMPLING_SHARE = 0.25
#: largest number of Newton steps from a crossing of chords to a crossing of curves
MAX_NEWTON_STEPS = 30
#: gap between two curves at which Newton's method ends
MEETING_GAP_MM = 1e-13


@dataclass(frozen=True)
class ParallelCurve:
    """The parallel of a spline, or of a part of it."""

    #: spline
    spline: PlaneSpline
    #: distance to the right of the spline's direction, mm
    right: float
    #: parameter of the spline at the beginning
    first: float = 0.0
    #: parameter of the spline at the end
    last: float = 1.0
    #: movements (2, 2) of both ends, mm, of the size of rounding errors
    shifts: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0))

    def at(self, s: Array) -> Array:
        parameters = self.first + s * (self.last - self.first)
        slope = self.spline.slope(parameters)
        right = np.stack((slope[:, 1], -slope[:, 0]), axis=-1) / np.linalg.norm(slope, axis=-1, keepdims=True)
        near, far = (np.array(way) for way in self.shifts)
        return np.asarray(
            self.spline.at(parameters) + self.right * right + (1.0 - s)[:, None] * near + s[:, None] * far
        )

    def slope(self, s: Array) -> Array:
        return self.spline.slope(self.first + s * (self.last - self.first))


#: untrimmed parallel of a curve, and True for a line that only joins others and is never part of a path
_Raw: TypeAlias = tuple[Smooth, bool]


def parallels(contour: Contour, offset: float, kind: Curves, tolerance: float) -> tuple[tuple[Contour, ...], float]:
    """Return the contours at a distance `offset` (mm) from a contour, positive away from the material, and their deviation (mm).

    There are none if the contour has no room for the offset. `tolerance` (mm) applies to curves that are no arcs or lines.
    """
    from scipy.spatial import cKDTree

    right = offset if contour.material else -offset
    whole = _whole_circle(contour, right)
    if whole is not None:
        paths = [] if whole.radius <= 0.0 else [redraw(whole, kind, tolerance)]
    else:
        loops = _loops(_raw(contour.curves, right, tolerance), _spacing(contour, offset))
        near = cKDTree(points_along(contour.curves, SAMPLING_SHARE * abs(offset)))
        paths = [_path(loop, kind, tolerance) for loop in loops if _is_path(loop, near, abs(offset))]
    contours = tuple(Contour(contour.name, curves, contour.material) for curves, _ in paths)
    return contours, max((miss for _, miss in paths), default=0.0)


def points_along(curves: Sequence[PlaneCurve], apart: float) -> Array:
    """Return points (N, 2) of curves, at most `apart` (mm) from each other."""
    return np.concatenate([curve.at(_parameters(curve, apart)[:-1]) for curve in curves])


def _spacing(contour: Contour, offset: float) -> float:
    size = float(np.ptp(np.concatenate([curve.at(np.linspace(0.0, 1.0, 9)) for curve in contour.curves]), axis=0).max())
    return max(min(SPACING_PER_OFFSET * abs(offset), SPACING_PER_SIZE * size), 1e-4 * size)


def _whole_circle(contour: Contour, right: float) -> PlaneArc | None:
    """Return the parallel of a whole circle, None for other contours; its radius is positive if there is room for it."""
    first = contour.curves[0]
    if not isinstance(first, PlaneArc) or not first.closed:
        return None
    return PlaneArc(first.centre, first.radius + right, 0.0, 2.0 * np.pi)


def _raw(curves: Sequence[PlaneCurve], right: float, tolerance: float) -> list[_Raw]:
    """Return the untrimmed parallels of all curves in order, with the arcs and lines that join them at corners."""
    raw: list[_Raw] = []
    for curve, after in zip(curves, (*curves[1:], curves[0]), strict=True):
        raw.append((_parallel(curve, right), False))
        before, behind = curve.slope(np.ones(1))[0], after.slope(np.zeros(1))[0]
        turn = float(np.arctan2(plane_cross(before, behind), before @ behind))
        spline = isinstance(curve, PlaneSpline) or isinstance(after, PlaneSpline)
        if abs(turn) <= (
            max(TANGENT_ANGLE_RAD, np.sqrt(8.0 * SHORT_ARC_SHARE * tolerance / abs(right)))
            if spline
            else ROUNDING_ANGLE_RAD
        ):
            continue
        heading = float(np.arctan2(before[1], before[0]))
        corner = PlaneArc(curve.end, abs(right), heading - 0.5 * np.pi if right > 0.0 else heading + 0.5 * np.pi, turn)
        # an arc at a corner that opens a gap; parallels at an inner corner cross, and a line joins their ends, too near to the part
        raw.append((corner, False) if turn * right > 0.0 else (PlaneLine(corner.start, corner.end), True))
    return raw


def _parallel(curve: PlaneCurve, right: float) -> Smooth:
    if isinstance(curve, PlaneSpline):
        return ParallelCurve(curve, right)
    if isinstance(curve, PlaneArc):
        return PlaneArc(curve.centre, curve.radius + (right if curve.width > 0.0 else -right), curve.first, curve.width)
    slope = curve.slope(np.zeros(1))[0]
    return curve.move(right * np.array([slope[1], -slope[0]]) / np.linalg.norm(slope))


def _parameters(curve: Smooth, apart: float) -> Array:
    rough = curve.at(np.linspace(0.0, 1.0, 17))
    length = float(np.linalg.norm(np.diff(rough, axis=0), axis=-1).sum())
    return np.linspace(
        0.0, 1.0, max(MIN_POINTS_PER_CURVE if not isinstance(curve, PlaneLine) else 2, int(length / apart) + 1) + 1
    )


@dataclass(frozen=True)
class _ParallelStretch:
    """A part of a curve between two crossings, or between an end of the curve and a crossing."""

    #: curve
    curve: Smooth
    #: parameter of the beginning
    first: float
    #: parameter of the end
    last: float
    #: crossing (2,) at the beginning, mm, None at an end of the curve
    start: Array | None = None
    #: crossing (2,) at the end, mm, None at an end of the curve
    end: Array | None = None
    #: True for a line that only joins others
    joining: bool = False

    @property
    def ends(self) -> tuple[Array, Array]:
        """Points (2,) of the beginning and the end, mm."""
        points = self.curve.at(np.array([self.first, self.last]))
        return (points[0] if self.start is None else self.start), (points[1] if self.end is None else self.end)

    def between(self, start: Array, end: Array) -> tuple[Smooth, float]:
        """Return the curve between these ends, and the distance (mm) by which its ends were moved across its direction."""
        curve = self.curve
        if isinstance(curve, ParallelCurve):
            first, last = (_nearest(curve, s, to) for s, to in ((self.first, start), (self.last, end)))
            points = curve.at(np.array([first, last]))
            (a, b), (c, d) = start - points[0], end - points[1]
            trimmed = ParallelCurve(
                curve.spline, curve.right, first, last, ((float(a), float(b)), (float(c), float(d)))
            )
            return trimmed, max(float(np.hypot(a, b)), float(np.hypot(c, d)))
        if isinstance(curve, PlaneArc):
            first, width = curve.first + self.first * curve.width, (self.last - self.first) * curve.width
            return PlaneArc(curve.centre, curve.radius, first, width), 0.0
        return PlaneLine(start, end), 0.0


def _nearest(curve: ParallelCurve, s: float, to: Array) -> float:
    """Return the parameter, near s, of the point of a curve nearest to the point `to` (2,); it may be slightly beyond the ends."""
    for _ in range(3):
        rate = _rate(curve, s)
        s += float((to - curve.at(np.array([s]))[0]) @ rate / (rate @ rate))
    return s


def _loops(raw: list[_Raw], apart: float) -> list[list[_ParallelStretch]]:
    """Return the closed paths into which crossings cut the parallels."""
    # chords of all curves in order, and their crossings
    places = [_parameters(curve, apart) for curve, _ in raw]
    count = [len(s) - 1 for s in places]
    owner, s = np.repeat(np.arange(len(raw)), count), np.concatenate([p[:-1] for p in places])
    s_next = np.concatenate([p[1:] for p in places])
    start = np.concatenate([curve.at(p[:-1]) for (curve, _), p in zip(raw, places, strict=True)])
    end = np.concatenate([curve.at(p[1:]) for (curve, _), p in zip(raw, places, strict=True)])
    one, other, u, v = _crossings(start, end)
    total, crossings = float(len(owner)), len(one)
    cuts = np.concatenate((one + u, other + v))
    # cut k of one branch is the same point as cut k + crossings of the other branch: solve for it on the curves
    meeting_points = np.empty((crossings, 2))
    parameters = np.empty(2 * crossings)
    for k in range(crossings):
        i, j = int(one[k]), int(other[k])
        a, b = raw[owner[i]][0], raw[owner[j]][0]
        guess = np.array([s[i] + u[k] * (s_next[i] - s[i]), s[j] + v[k] * (s_next[j] - s[j])])
        (parameters[k], parameters[k + crossings]), meeting_points[k] = _meeting(a, b, guess)
    # follow the parallels from each cut to the next cut, and continue on the other branch, until the path is closed
    order = np.argsort(cuts, kind="stable")
    if not crossings:
        return [[_ParallelStretch(curve, 0.0, 1.0, joining=joining) for curve, joining in raw]]
    rank = np.empty(2 * crossings, dtype=int)
    rank[order] = np.arange(2 * crossings)
    unused, loops = set(range(2 * crossings)), []
    while unused:
        loop, at = list[_ParallelStretch](), min(unused)
        while at in unused:
            unused.remove(at)
            nxt = int(order[(rank[at] + 1) % (2 * crossings)])
            ends = (int(owner[int(cuts[at])]), parameters[at]), (int(owner[int(cuts[nxt] % total)]), parameters[nxt])
            beyond = cuts[nxt] <= cuts[at]
            loop += _stretches(raw, ends, beyond, (meeting_points[at % crossings], meeting_points[nxt % crossings]))
            at = (nxt + crossings) % (2 * crossings)
        loops.append(loop)
    return loops


def _stretches(
    raw: list[_Raw],
    ends: tuple[tuple[int, float], tuple[int, float]],
    beyond: bool,
    meeting_points: tuple[Array, Array],
) -> list[_ParallelStretch]:
    """Return the parts of the curves between two cuts; each cut is a curve's number and a parameter on it."""
    (first, s), (last, t) = ends
    if first == last and not beyond:
        curve, joining = raw[first]
        return [_ParallelStretch(curve, s, t, *meeting_points, joining=joining)]
    numbers = [k % len(raw) for k in range(first + 1, last + (len(raw) if last <= first else 0))]
    inner = [_ParallelStretch(raw[k][0], 0.0, 1.0, joining=raw[k][1]) for k in numbers]
    begin = _ParallelStretch(raw[first][0], s, 1.0, start=meeting_points[0], joining=raw[first][1])
    return [begin, *inner, _ParallelStretch(raw[last][0], 0.0, t, end=meeting_points[1], joining=raw[last][1])]


def _crossings(start: Array, end: Array) -> tuple[Array, Array, Array, Array]:
    """Return numbers (K,) of the crossing chords of a closed path, and the places (K,) of the crossings as shares of both."""
    from scipy.spatial import cKDTree

    along = end - start
    # chords of straight lines may be long: they are looked for in pieces as long as the others
    length = np.linalg.norm(along, axis=-1)
    piece = max(float(np.median(length)), 1e-2 * float(length.max()))
    parts = np.maximum(1, np.ceil(length / piece).astype(int))
    number = np.repeat(np.arange(len(start)), parts)
    share = (np.arange(len(number)) - np.repeat(np.cumsum(parts) - parts, parts) + 0.5) / np.repeat(parts, parts)
    middle = start[number] + share[:, None] * along[number]
    near = number[cKDTree(middle).query_pairs(1.001 * piece, output_type="ndarray")]
    near = np.unique(np.sort(near, axis=1), axis=0)
    i, j = near.T
    apart = (j - i) % len(start)
    keep = (apart > 1) & (apart < len(start) - 1)
    i, j = i[keep], j[keep]
    slope = plane_cross(along[i], along[j])
    with np.errstate(divide="ignore", invalid="ignore"):
        u = plane_cross(start[j] - start[i], along[j]) / slope
        v = plane_cross(start[j] - start[i], along[i]) / slope
    hit = (u >= 0.0) & (u < 1.0) & (v >= 0.0) & (v < 1.0)
    return i[hit], j[hit], u[hit], v[hit]


def _meeting(one: Smooth, other: Smooth, guess: Array) -> tuple[Array, Array]:
    """Solve for the parameters (2,) and the point (2,) of a crossing, from the guess by its chords."""
    best = guess
    for _ in range(MAX_NEWTON_STEPS):
        a, b = one.at(best[:1])[0], other.at(best[1:])[0]
        gap = a - b
        if np.linalg.norm(gap) <= MEETING_GAP_MM:
            break
        slopes = np.stack((_rate(one, best[0]), -_rate(other, best[1])), axis=-1)
        best = best - np.linalg.solve(slopes, gap)
    return best, 0.5 * (one.at(best[:1])[0] + other.at(best[1:])[0])


def _rate(curve: Smooth, s: float) -> Array:
    """Return the derivative (2,) of the point by the parameter."""
    step = 1e-5
    ends = curve.at(np.array([s - step, s + step]))
    return np.asarray(ends[1] - ends[0]) / (2.0 * step)


def _is_path(loop: list[_ParallelStretch], contour: cKDTree, distance: float) -> bool:
    """Return True if a path has the distance from its contour everywhere and runs in the sense of the contour.

    A path in the opposite sense encloses a pocket that the wire cannot reach.
    """
    points = np.concatenate(
        [piece.curve.at(np.linspace(piece.first, piece.last, MIN_POINTS_PER_CURVE)) for piece in loop]
    )
    x, y = points.T
    if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) <= 0.0:
        return False
    return float(contour.query(points)[0].min()) > (1.0 - NEARER_SHARE) * distance


def _path(loop: list[_ParallelStretch], kind: Curves, tolerance: float) -> tuple[tuple[PlaneCurve, ...], float]:
    """Return a path as curves of a kind, which meet, and its deviation (mm)."""
    piece_ends = [piece.ends for piece in loop]
    # parallels of splines may move: to the ends of neighbouring arcs and lines, and half-way to a neighbouring parallel of a spline
    free = [isinstance(piece.curve, ParallelCurve) for piece in loop]
    joints = []
    for k in range(len(loop)):
        before, here = piece_ends[k - 1][1], piece_ends[k][0]
        joints.append(0.5 * (before + here) if free[k - 1] and free[k] else before if free[k] else here)
    curves, largest = list[PlaneCurve](), 0.0
    for k, piece in enumerate(loop):
        ends = (joints[k], joints[(k + 1) % len(loop)]) if free[k] else piece_ends[k]
        curve, shift = piece.between(*ends)
        pieces, miss = redraw(curve, kind, tolerance)
        curves += pieces
        largest = max(largest, miss + shift)
    return tuple(curves), largest
