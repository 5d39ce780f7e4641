"""Points where flank and fillet of a tooth meet: the tool's form point, or their intersection where the flank is
undercut.

An undercut flank turns back at its singular point, the cusp. The branch from there to the tool's form point is not part
of the tooth. The fillet begins at the end of that branch and cuts the sound branch in a curve. The flank may turn twice
before it reaches the form point, in a loop with a cusp at either end. It is cut there as well, if the fillet reaches
the sound branch.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution
from gearmesh.kernel.envelope.limiting_line import area_density, singular_at
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, distinct, dot, polar_angle
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.stations import Followed, TrimError, along, follow
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.tooth_side import ToothSide

#: largest residual of a trimming solve, mm
TRIM_TOLERANCE = 1e-11
#: largest residual as a share of the largest coordinate, if that is more
TRIM_ROUNDING = 1e-12
#: samples of flank and fillet between which a start of their intersection is looked for
SECTION_SAMPLES = 300
#: stations at which starts are looked for; the other stations interpolate them
START_STATIONS = 17
#: a flank is cut off where its area density at the form point, over that near the tip, is below minus this value; a
#: smaller undercut removes about half its square of the flank's height, less than 1e-12 mm
MIN_UNDERCUT_DENSITY = 1e-7
#: samples between tip and form point that are tested for loops with two cusps
FOLD_SAMPLES = 24
#: share of a parameter range by which flank and fillet, modified after cutting, may miss each other at the form point
MAX_FORM_POINT_MISS = 0.1
#: share of the flank's parameter range up to which the loop between cusp and form point is small
SMALL_LOOP_SHARE = 1e-2
#: the same share up to which rounding decides where the loop crosses itself: it is narrower than the third power, 1e-12
#: of the flank. A solution as near to the form point is the form point itself, where flank and fillet are tangent
ROUNDED_LOOP_SHARE = 1e-4


@dataclass(frozen=True)
class Undercut:
    """Intersection of flank and fillet of a side at K stations.

    `stations`: station coordinates (K,), mm. `x`: both parameters of the flank and of the fillet (K, 4).
    """

    stations: Array
    x: Array

    def at(self, stations: Array) -> Array:
        """Return parameters (T, 4) at stations (T,), interpolated linearly."""
        order = np.argsort(self.stations)
        return np.stack([np.interp(stations, self.stations[order], column[order]) for column in self.x.T], axis=-1)


#: ratio of true to nominal flank length, or its inverse, above which samples keep their nominal places, up to the true
#: tip
NEAR_TIP_RATIO = 0.8


def trim_tolerance(r: Array) -> float:
    """Largest residual (mm) of a trimming solve at points near r (..., 3)."""
    return max(TRIM_TOLERANCE, TRIM_ROUNDING * float(np.abs(r).max(initial=0.0)))


def form_point(
    side: ToothSide,
    tip: tuple[Array, Jet],
    at: tuple[Array, Array],
    axial: Level,
    root: Level,
    near: Undercut | None = None,
    *,
    folds: bool = False,
) -> tuple[Array, Array, Undercut]:
    """Solve for the points where flank and fillet meet.

    - `tip`: flank parameter (T,) and jet at the tip.
    - `at`: t and station coordinates (T,), mm.
    - `root`: level of the root land.
    - `near`: undercut of the same side at other stations, from which the solution starts.
    - `folds`: True if the flank has a loop with two cusps.

    Returns the parameters (T,) of flank and fillet, and the stations with undercut. Raises TrimError where undercut
    removes the whole flank, or where a loop ends in the flank itself.
    """
    t, stations = at
    p, q = np.full_like(stations, side.form_point[0]), np.full_like(stations, side.form_point[1])
    cut = cut_off(side, tip[1], stations, axial, MIN_UNDERCUT_DENSITY)
    if folds:
        cut |= singular_stations(side, stations, axial, tip[0])
    undercut = Undercut(stations[cut], np.empty((0, 4)))
    if cut.any():
        nearby_starts = None if near is None or not near.stations.size else near.at(undercut.stations)
        undercut = replace(
            undercut, x=_intersection(side, tip[0][cut], (t[cut], stations[cut]), axial, root, nearby_starts)
        )
        p[cut], q[cut] = undercut.x[:, 0], undercut.x[:, 2]
    if side.crossed and not cut.all():
        ends = tip[0][~cut]
        if side.crossing_end is not None:
            ends = np.full_like(ends, side.crossing_end)
        p[~cut], q[~cut] = _crossing(side, ends, (t[~cut], stations[~cut]), axial, root)
    return p, q, undercut


def _crossing(side: ToothSide, tip: Array, at: tuple[Array, Array], axial: Level, root: Level) -> tuple[Array, Array]:
    """Solve for the parameters (T,) of flank and fillet where they cross near the form point, at stations without
    undercut.

    Flank and fillet overlap up to the form point. If they were modified after cutting, they may cross a little beyond
    it. Raises TrimError where they do not cross.
    """
    t, stations = at
    form_point = [np.full_like(stations, parameter) for parameter in side.form_point]
    reach = 0.0 if side.generated is None else -MAX_FORM_POINT_MISS
    start = [
        x
        for surface, p in zip((side.flank, side.fillet), form_point, strict=True)
        for x in (p, along(surface, p, stations, axial)[0])
    ]

    def crossing(start: Array, which: NDArray[np.bool_]) -> tuple[Array, NDArray[np.bool_]]:
        """Return solutions (M, 4) from a start, and an array that is True where they are intersections in the
        overlap.
        """
        solution = intersection((side.flank, side.fillet), start, stations[which], axial)
        p, q = solution.values[:, 0], solution.values[:, 2]
        past = (
            (x - begins) / (ends - begins)
            for x, begins, ends in ((p, side.form_point[0], tip[which]), (q, side.form_point[1], side.root))
        )
        return solution.values, solution.converged & np.all([(x >= reach) & (x <= 1.0) for x in past], axis=0)

    x, solved = crossing(np.stack(start, axis=-1), np.ones(stations.shape, dtype=bool))
    lost = ~solved
    if lost.any():
        # the form point is far from the intersection: start from sampled sections
        x[lost], solved[lost] = crossing(_start(side, tip[lost], (t[lost], stations[lost]), axial, root), lost)
    if not solved.all():
        k = int(np.argmin(solved))
        raise TrimError("crossing", float(t[k]), "the toprem does not meet the flank that it relieves")
    return x[:, 0], x[:, 2]


def cut_off(side: ToothSide, sound: Jet, stations: Array, axial: Level, just_begun: float = 0.0) -> NDArray[np.bool_]:
    """True (T,) where the flank at the tool's form point is turned inside out against its jet `sound` near the tip.

    Down to minus `just_begun` of the area density there, the form point is the cusp itself and cuts nothing off.
    """
    turned: NDArray[np.bool_] = regularity(side, sound, stations, axial) <= -just_begun
    return turned


def regularity(side: ToothSide, sound: Jet, stations: Array, axial: Level) -> Array:
    """Area density (T,) of the flank at the tool's form point, over that of its jet `sound` near the tip.

    It is 0 where undercut begins, and negative beyond.
    """
    lost = along(side.flank, np.full_like(stations, side.form_point[0]), stations, axial)[1]
    return np.asarray(area_density(lost) / area_density(sound))


def singular_stations(side: ToothSide, stations: Array, axial: Level, tip: Array | None = None) -> NDArray[np.bool_]:
    """True (T,) at stations where the flank is turned inside out between tip and form point, against its sense near the
    tip.

    `tip`: flank parameter (T,) at the tip; the nominal one by default.
    """
    share = np.linspace(1.0, 0.0, FOLD_SAMPLES + 1)[:-1, None]
    reach = np.full_like(stations, side.tip - side.form_point[0])
    if tip is not None:
        true = (tip - side.form_point[0]) / reach
        near_by = (true > NEAR_TIP_RATIO) & (true * NEAR_TIP_RATIO < 1.0)
        # beyond the tip, where the nominal one may lie, flanks may end or be turned inside out
        share = np.minimum(share * np.where(near_by, 1.0, true), true)
    p = side.form_point[0] + share * reach
    curves = follow(side.flank, np.broadcast_to(p, (FOLD_SAMPLES, stations.size)), stations, axial)
    density = area_density(curves.jet)
    turned: NDArray[np.bool_] = (curves.converged & (density / density[0] < 0.0)).any(axis=0)
    return turned


def _intersection(
    side: ToothSide,
    tip: Array,
    at: tuple[Array, Array],
    axial: Level,
    root: Level,
    start: Array | None,
) -> Array:
    """Solve for both parameters of flank and fillet (T, 4) on their intersection at each station; `start` is near
    it.
    """
    t, stations = at
    if start is None:
        start_indices = distinct(np.linspace(0, stations.size - 1, START_STATIONS).round().astype(np.intp))
        known_starts = _start(side, tip[start_indices], (t[start_indices], stations[start_indices]), axial, root)
        start = Undercut(stations[start_indices], known_starts).at(stations)
    solution = intersection((side.flank, side.fillet), start, stations, axial)
    x = solution.values
    # solutions astray: not converged, or at the form point, which is no intersection of the sound branch
    astray = ~solution.converged | (
        np.abs(x[:, 0] - side.form_point[0]) <= ROUNDED_LOOP_SHARE * np.abs(tip - side.form_point[0])
    )
    if astray.any():
        new_start = _start(side, tip[astray], (t[astray], stations[astray]), axial, root)
        second_solution = intersection((side.flank, side.fillet), new_start, stations[astray], axial)
        x[astray] = np.where(second_solution.converged[:, None], second_solution.values, np.nan)
    # loops that rounding decides are placed by the closed form of `_start`
    tiny = ~(np.abs(x[:, 0] - side.form_point[0]) > 2.0 * ROUNDED_LOOP_SHARE * np.abs(tip - side.form_point[0]))
    if tiny.any():
        x[tiny] = _in_rounding(side, tip[tiny], (t[tiny], stations[tiny]), axial, x[tiny])
    return x


def _in_rounding(side: ToothSide, tip: Array, at: tuple[Array, Array], axial: Level, x: Array) -> Array:
    """Replace the parameters x (T, 4) where rounding decides where flank and fillet cross; see `_start`.

    Raises TrimError where no solution was found and the loop is too large for that.
    """
    t, stations = at
    form_point = np.full_like(stations, side.form_point[0])
    cusp = singular_at(side.flank, (tip, form_point), stations, axial)
    lost = np.abs(cusp - form_point) < ROUNDED_LOOP_SHARE * np.abs(tip - form_point)
    missing = ~lost & ~(np.abs(x[:, 0] - form_point) > ROUNDED_LOOP_SHARE * np.abs(tip - form_point))
    if missing.any():
        raise _undercut_error(t[int(np.argmax(missing))])
    p, q = cusp + 0.5 * (cusp - form_point), np.full_like(stations, side.form_point[1])
    v, flank = along(side.flank, p, stations, axial)
    # the flank reaches the form point along the fillet: follow the fillet back to the point on the flank
    fillet = along(side.fillet, q, stations, axial)[1]
    gradient = axial.gradient(fillet.r)
    way = fillet.r_u - (dot(gradient, fillet.r_u) / dot(gradient, fillet.r_v))[:, None] * fillet.r_v
    q = q + dot(flank.r - fillet.r, way) / dot(way, way)
    w = along(side.fillet, q, stations, axial)[0]
    return np.where(lost[:, None], np.stack((p, v, q, w), axis=-1), x)


def intersection(surfaces: tuple[Surface, Surface], start: Array, stations: Array, axial: Level) -> Solution:
    """Solve for both parameters of both surfaces (T, 4) at their common points on stations (T,), from a start (T,
    4).
    """
    one, other = surfaces

    def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (M, 4), mm, and Jacobian: the distance of both points, and the station of the first."""
        flank, fillet = one.jet(x[:, 0], x[:, 1]), other.jet(x[:, 2], x[:, 3])
        gradient = axial.gradient(flank.r)
        f = np.concatenate((flank.r - fillet.r, (axial.value(flank.r) - stations[index])[:, None]), axis=-1)
        jacobian = np.zeros((x.shape[0], 4, 4))
        jacobian[:, :3, 0], jacobian[:, :3, 1] = flank.r_u, flank.r_v
        jacobian[:, :3, 2], jacobian[:, :3, 3] = -fillet.r_u, -fillet.r_v
        jacobian[:, 3, 0], jacobian[:, 3, 1] = dot(gradient, flank.r_u), dot(gradient, flank.r_v)
        return f, jacobian

    near = one.jet(start[:, 0], start[:, 1]).r
    return newton.solve(residual, start, tolerance=trim_tolerance(near))


def _start(side: ToothSide, tip: Array, at: tuple[Array, Array], axial: Level, root: Level) -> Array:
    """Start values (T, 4) from sampled sections: the heights at which the polar angles of flank and fillet are equal.

    Samples crowd towards cusp and form point, because the loop between them may be tiny. A loop too small for the
    samples has a start of its own. With s = p - cusp the flank's height is A s^2 / 2 and its offset B s^3 / 3. The
    fillet leaves the flank at s = -e along the tangent of slope -(B / A) e. It meets the flank again at h = 3/8,
    s = e / 2, where

        -1/3 + h = (1 - 2 h)^(3/2) / 3
    """
    t, stations = at
    crowded = np.linspace(0.0, 1.0, SECTION_SAMPLES)[:, None] ** 4
    cusp = singular_at(side.flank, (tip, side.form_point[0]), stations, axial)
    if side.crossed:
        # a flank without undercut goes on to the form point
        cusp = np.where(np.isnan(cusp), side.form_point[0], cusp)
    if np.isnan(cusp).any():
        raise _undercut_error(t[int(np.argmax(np.isnan(cusp)))])
    # a modified flank may cross the fillet beyond the end at which its tool stops
    p = cusp + crowded * (tip - cusp)
    reach = 1.0 + MAX_FORM_POINT_MISS if side.crossed and side.generated is not None else 1.0
    q = side.root + (1.0 - crowded[::-1]) * reach * (side.form_point[1] - side.root)
    flank, fillet = (
        follow(surface, np.broadcast_to(x, p.shape), stations, axial)
        for surface, x in ((side.flank, p), (side.fillet, q))
    )
    start = np.empty((stations.size, 4))
    for k in range(stations.size):
        (p_there, v, height, angle), (q_there, w, height_fillet, angle_fillet) = (
            _section_samples(curve, x, k, root) for curve, x in ((flank, p), (fillet, np.broadcast_to(q, p.shape)))
        )
        if not (height.size and height_fillet.size):
            raise _undercut_error(t[k])
        # difference of the polar angles over common heights: its last change of sign is the intersection nearest to
        # the tip
        levels = np.linspace(height[0], min(height[-1], height_fillet[-1]), SECTION_SAMPLES)[1:-1]
        apart = np.interp(levels, height, angle) - np.interp(levels, height_fillet, angle_fillet)
        crossing = np.flatnonzero(apart[:-1] * apart[1:] <= 0.0)
        if levels[-1] > levels[0] and crossing.size:
            place = levels[crossing[-1]]
        elif abs(cusp[k] - side.form_point[0]) < SMALL_LOOP_SHARE * abs(tip[k] - side.form_point[0]):
            beside = cusp[k] + 0.5 * (cusp[k] - side.form_point[0])
            place = np.interp(abs(beside - cusp[k]), np.abs(p_there - cusp[k]), height)
        else:
            raise _undercut_error(t[k])
        start[k, :2] = np.interp(place, height, p_there), np.interp(place, height, v)
        start[k, 2:] = np.interp(place, height_fillet, q_there), np.interp(place, height_fillet, w)
    return start


def _section_samples(curve: Followed, p: Array, k: int, root: Level) -> tuple[Array, Array, Array, Array]:
    """Samples of the section at station k: both parameters, height over the root, polar angle."""
    there = curve.converged[:, k]
    r = curve.jet.r[there, k]
    return p[there, k], curve.values[there, k], root.value(r), polar_angle(r)


def _undercut_error(t: float) -> TrimError:
    """Return the error for a flank and a fillet that do not intersect."""
    return TrimError(
        "undercut",
        float(t),
        "flank and fillet do not intersect: the undercut removes the flank, or the flank has a cusp",
    )
