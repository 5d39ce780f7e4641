"""Parallels of contours at a distance: the path of a wire's or a beam's centre, trimmed where it would cut into the part.

Every curve is moved along its normals, an arc about each corner joins the parallels that part there, and where parallels cross
the path is cut open and joined anew, always changing over to the other branch:

       ___     ___              crossing: in along one branch, out along the other; the loop behind it
          \\   /                 is a path of its own, and nearer to the part than the distance: dropped
           \\ /
            X                   [Chen & McMains, ASME DETC2005-85513: loops of winding number 1]
           / \\
          (   )

What is left has the distance everywhere. Where a wire does not reach, in corners sharper than itself, stock stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from gearmesh.cad.contours.curves import Contour, PlaneSpline
from gearmesh.cad.contours.redrawn import Curves, Smooth, redraw
from gearmesh.kernel.numeric.algebra import Array, plane_cross
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

#: arcs that would join parallels of splines are left out where the path then misses their distance by less than this share of
#: the tolerance, and always where the curves turn by less (rad): that much their fit is off
SHORT, TANGENT = 0.05, 1e-4
#: rad: arcs and lines are tangent to this
ROUNDING = 1e-9
#: points on every curve, at least, and their distance (mm) at most, as a share of the offset and of the contour's size
FEWEST, APART, OF_SIZE = 48, 0.1, 2e-3
#: a path is nearer than the distance where it is so by this share of it; points of the contour so far from each other, as a share
#: of the distance, show that: between them it looks larger by the square of an eighth
NEARER, SAMPLED = 2e-2, 0.25
#: rounds of Newton's method from a crossing of chords, and the gap (mm) that ends them
ROUNDS, EXACT = 30, 1e-13


@dataclass(frozen=True)
class ParallelCurve:
    """The parallel of a spline at a distance (mm) to the right of its direction; `first`, `last`: its stretch of the spline;
    its ends are moved by `shifts` (2, 2), mm, a rounding error."""

    spline: PlaneSpline
    right: float
    first: float = 0.0
    last: float = 1.0
    shifts: tuple[tuple[float, float], tuple[float, float]] = ((0.0, 0.0), (0.0, 0.0))

    def at(self, s: Array) -> Array:
        own = self.first + s * (self.last - self.first)
        slope = self.spline.slope(own)
        right = np.stack((slope[:, 1], -slope[:, 0]), axis=-1) / np.linalg.norm(slope, axis=-1, keepdims=True)
        near, far = (np.array(way) for way in self.shifts)
        return np.asarray(self.spline.at(own) + self.right * right + (1.0 - s)[:, None] * near + s[:, None] * far)

    def slope(self, s: Array) -> Array:
        return self.spline.slope(self.first + s * (self.last - self.first))


#: the parallel of a curve as it is, and whether it is there to join others only, and never part of a path
_Raw: TypeAlias = tuple[Smooth, bool]


def parallels(contour: Contour, offset: float, kind: Curves, tolerance: float) -> tuple[tuple[Contour, ...], float]:
    """The contours at a distance `offset` (mm) from one, positive away from the material, and their deviation (mm).

    Of a contour that leaves no room for it there are none. `tolerance` (mm) is that of what is not an arc or line.
    """
    from scipy.spatial import cKDTree

    right = offset if contour.material else -offset
    whole = _whole_circle(contour, right)
    if whole is not None:
        paths = [] if whole.radius <= 0.0 else [redraw(whole, kind, tolerance)]
    else:
        loops = _loops(_raw(contour.curves, right, tolerance), _spacing(contour, offset))
        near = cKDTree(points_along(contour.curves, SAMPLED * abs(offset)))
        paths = [_path(loop, kind, tolerance) for loop in loops if _is_path(loop, near, abs(offset))]
    contours = tuple(Contour(contour.name, curves, contour.material) for curves, _ in paths)
    return contours, max((miss for _, miss in paths), default=0.0)


def points_along(curves: Sequence[PlaneCurve], apart: float) -> Array:
    """Points (N, 2) of curves, `apart` (mm) at most."""
    return np.concatenate([curve.at(_parameters(curve, apart)[:-1]) for curve in curves])


def _spacing(contour: Contour, offset: float) -> float:
    size = float(np.ptp(np.concatenate([curve.at(np.linspace(0.0, 1.0, 9)) for curve in contour.curves]), axis=0).max())
    return max(min(APART * abs(offset), OF_SIZE * size), 1e-4 * size)


def _whole_circle(contour: Contour, right: float) -> PlaneArc | None:
    """Of a circle another one, which has a positive radius if there is room for it; None of anything else."""
    first = contour.curves[0]
    if not isinstance(first, PlaneArc) or not first.closed:
        return None
    return PlaneArc(first.centre, first.radius + right, 0.0, 2.0 * np.pi)


def _raw(curves: Sequence[PlaneCurve], right: float, tolerance: float) -> list[_Raw]:
    """Parallels of all curves in their order, with what joins them at corners."""
    raw: list[_Raw] = []
    for curve, after in zip(curves, (*curves[1:], curves[0]), strict=True):
        raw.append((_parallel(curve, right), False))
        before, behind = curve.slope(np.ones(1))[0], after.slope(np.zeros(1))[0]
        turn = float(np.arctan2(plane_cross(before, behind), before @ behind))
        spline = isinstance(curve, PlaneSpline) or isinstance(after, PlaneSpline)
        if abs(turn) <= (max(TANGENT, np.sqrt(8.0 * SHORT * tolerance / abs(right))) if spline else ROUNDING):
            continue
        heading = float(np.arctan2(before[1], before[0]))
        corner = PlaneArc(curve.end, abs(right), heading - 0.5 * np.pi if right > 0.0 else heading + 0.5 * np.pi, turn)
        # away from an inner corner the parallels cross, and what joins their ends is nearer than the distance
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
    return np.linspace(0.0, 1.0, max(FEWEST if not isinstance(curve, PlaneLine) else 2, int(length / apart) + 1) + 1)


@dataclass(frozen=True)
class _ParallelStretch:
    """A curve from one parameter to another, and its ends (2,), mm, where these are crossings."""

    curve: Smooth
    first: float
    last: float
    start: Array | None = None
    end: Array | None = None
    joining: bool = False

    @property
    def ends(self) -> tuple[Array, Array]:
        """Its ends (2,), mm."""
        own = self.curve.at(np.array([self.first, self.last]))
        return (own[0] if self.start is None else self.start), (own[1] if self.end is None else self.end)

    def between(self, start: Array, end: Array) -> tuple[Smooth, float]:
        """The curve of the stretch alone, between these ends, and how far (mm) it was moved for them, but for along itself."""
        curve = self.curve
        if isinstance(curve, ParallelCurve):
            first, last = (_nearest(curve, s, to) for s, to in ((self.first, start), (self.last, end)))
            own = curve.at(np.array([first, last]))
            (a, b), (c, d) = start - own[0], end - own[1]
            trimmed = ParallelCurve(
                curve.spline, curve.right, first, last, ((float(a), float(b)), (float(c), float(d)))
            )
            return trimmed, max(float(np.hypot(a, b)), float(np.hypot(c, d)))
        if isinstance(curve, PlaneArc):
            first, width = curve.first + self.first * curve.width, (self.last - self.first) * curve.width
            return PlaneArc(curve.centre, curve.radius, first, width), 0.0
        return PlaneLine(start, end), 0.0


def _nearest(curve: ParallelCurve, s: float, to: Array) -> float:
    """Where on a curve, near s and a little beyond its ends too, it is nearest to a point (2,) close to that."""
    for _ in range(3):
        rate = _rate(curve, s)
        s += float((to - curve.at(np.array([s]))[0]) @ rate / (rate @ rate))
    return s


def _loops(raw: list[_Raw], apart: float) -> list[list[_ParallelStretch]]:
    """The closed paths into which crossings cut the parallels."""
    places = [_parameters(curve, apart) for curve, _ in raw]
    count = [len(s) - 1 for s in places]
    owner, s = np.repeat(np.arange(len(raw)), count), np.concatenate([p[:-1] for p in places])
    s_next = np.concatenate([p[1:] for p in places])
    start = np.concatenate([curve.at(p[:-1]) for (curve, _), p in zip(raw, places, strict=True)])
    end = np.concatenate([curve.at(p[1:]) for (curve, _), p in zip(raw, places, strict=True)])
    one, other, u, v = _crossings(start, end)
    total, crossings = float(len(owner)), len(one)
    cuts = np.concatenate((one + u, other + v))
    # cut k of branch one is where cut k + crossings of the other is
    meeting_points = np.empty((crossings, 2))
    parameters = np.empty(2 * crossings)
    for k in range(crossings):
        i, j = int(one[k]), int(other[k])
        a, b = raw[owner[i]][0], raw[owner[j]][0]
        guess = np.array([s[i] + u[k] * (s_next[i] - s[i]), s[j] + v[k] * (s_next[j] - s[j])])
        (parameters[k], parameters[k + crossings]), meeting_points[k] = _meeting(a, b, guess)
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
    """What lies between two cuts, each the number of a curve and a parameter on it."""
    (first, s), (last, t) = ends
    if first == last and not beyond:
        curve, joining = raw[first]
        return [_ParallelStretch(curve, s, t, *meeting_points, joining=joining)]
    numbers = [k % len(raw) for k in range(first + 1, last + (len(raw) if last <= first else 0))]
    inner = [_ParallelStretch(raw[k][0], 0.0, 1.0, joining=raw[k][1]) for k in numbers]
    begin = _ParallelStretch(raw[first][0], s, 1.0, start=meeting_points[0], joining=raw[first][1])
    return [begin, *inner, _ParallelStretch(raw[last][0], 0.0, t, end=meeting_points[1], joining=raw[last][1])]


def _crossings(start: Array, end: Array) -> tuple[Array, Array, Array, Array]:
    """Numbers of the chords that cross, of a closed path, and the shares of both at which they do, all (K,)."""
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
    """Parameters (2,) and place (2,) of a crossing, near those of chords."""
    best = guess
    for _ in range(ROUNDS):
        a, b = one.at(best[:1])[0], other.at(best[1:])[0]
        gap = a - b
        if np.linalg.norm(gap) <= EXACT:
            break
        slopes = np.stack((_rate(one, best[0]), -_rate(other, best[1])), axis=-1)
        best = best - np.linalg.solve(slopes, gap)
    return best, 0.5 * (one.at(best[:1])[0] + other.at(best[1:])[0])


def _rate(curve: Smooth, s: float) -> Array:
    """Derivative (2,) of the point by the parameter."""
    step = 1e-5
    ends = curve.at(np.array([s - step, s + step]))
    return np.asarray(ends[1] - ends[0]) / (2.0 * step)


def _is_path(loop: list[_ParallelStretch], contour: cKDTree, distance: float) -> bool:
    """Whether a path has the distance from the points of its contour everywhere, and runs as the contour does: a pocket that it
    closes off is out of a wire's reach."""
    points = np.concatenate([piece.curve.at(np.linspace(piece.first, piece.last, FEWEST)) for piece in loop])
    x, y = points.T
    if float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) <= 0.0:
        return False
    return float(contour.query(points)[0].min()) > (1.0 - NEARER) * distance


def _path(loop: list[_ParallelStretch], kind: Curves, tolerance: float) -> tuple[tuple[PlaneCurve, ...], float]:
    """A path as curves of a kind, which meet."""
    own = [piece.ends for piece in loop]
    # what is free to move is moved by arcs and lines beside it, and to half to another
    free = [isinstance(piece.curve, ParallelCurve) for piece in loop]
    joints = []
    for k in range(len(loop)):
        before, here = own[k - 1][1], own[k][0]
        joints.append(0.5 * (before + here) if free[k - 1] and free[k] else before if free[k] else here)
    curves, largest = list[PlaneCurve](), 0.0
    for k, piece in enumerate(loop):
        ends = (joints[k], joints[(k + 1) % len(loop)]) if free[k] else own[k]
        curve, shift = piece.between(*ends)
        pieces, miss = redraw(curve, kind, tolerance)
        curves += pieces
        largest = max(largest, miss + shift)
    return tuple(curves), largest
