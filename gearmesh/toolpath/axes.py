r"""Tool axes: for each pass one lead and one tilt from the middle of the space, with which the shank stays clear of all teeth.

A shank of radius R along the axis a from the ball's centre c is as far from a point q beside it (0 < (q - c) . a < L) as

    |(q - c) - ((q - c) . a) a| - R

and from the surface that the ball touches, where a rises from its tangent plane by beta (sin beta = a . n), R (1 / cos beta - 1).
Of the directions tried the one nearest to the middle of the space is taken that keeps the clearance wanted, or, where none
does, the
one that keeps most. Directions are chosen for a few passes and stations; the angles of the passes between are interpolated, and the
clearance of what is taken is measured anew, at all points of all passes (`proof`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.passes import Passes
from gearmesh.toolpath.space import CutSpace

#: deg: tilts and leads that are tried; leads other than the first only where no tilt alone keeps the shank clear
TILTS = np.arange(-40.0, 85.0, 5.0)
LEADS = (0.0, 20.0, -20.0, 40.0, -40.0, 60.0, -60.0)
#: clearance wanted, as a share of the ball's radius
WANTED = 0.05
#: passes and stations for which axes are chosen, and points across a wall beside a station
PASSES, STATIONS, ACROSS = 21, 7, 25
#: places beside a station, in radii of the ball, at which sections of the teeth stand in the way
BESIDE = (-0.5, -0.25, 0.0, 0.25, 0.5)
#: points in the way at once
BLOCK = 2_000


@dataclass(frozen=True)
class Axes:
    """Lead and tilt (P,), rad, of each pass, and unit axes (P, N, 3) from the ball to the shank at its points."""

    lead: Array
    tilt: Array
    vectors: Array


@dataclass(frozen=True)
class _Tried:
    """Directions (K,), rad, with the clearance (P, K), mm, and the length (P, K), mm, of shank that stays clear."""

    lead: Array
    tilt: Array
    clearance: Array
    clear: Array


def choose_axes(
    space: CutSpace, passes: Passes, ball: BallCutter, lead: float | None = None, tilt: float | None = None
) -> Axes:
    """Axes of all passes. Given `lead` and `tilt`, rad, are kept.

    Raises NoSolutionError where the shank is not clear of the teeth, with the longest that is.
    """
    some = np.unique(np.linspace(0, len(passes.centres) - 1, PASSES).round().astype(int))
    if lead is not None and tilt is not None:
        angles = np.full((2, some.size), [[lead], [tilt]])
    else:
        angles = _choose(space, passes, ball, some, lead, tilt)
    # angles are interpolated on either side of the root alone: a tilt is away from the own wall
    full = np.empty((2, len(passes.centres)))
    for side in np.unique(passes.side):
        own, of_side = np.flatnonzero(passes.side == side), passes.side[some] == side
        known, values = (some[of_side], angles[:, of_side]) if of_side.any() else (some, angles)
        full[:, own] = [np.interp(own, known, row) for row in values]
    return Axes(full[0], full[1], passes.frames.axis(full[0], full[1], passes.side))


def _choose(
    space: CutSpace, passes: Passes, ball: BallCutter, some: Array, lead: float | None, tilt: float | None
) -> Array:
    """Lead and tilt (2, S), rad, of some passes (S,)."""
    tilts = np.radians(TILTS) if tilt is None else np.array([tilt])
    leads = np.radians(LEADS) if lead is None else np.array([lead])
    best = np.full((2, some.size), np.nan)
    clear = np.zeros(some.size)
    for own_lead in leads:
        open_ = np.flatnonzero(np.isnan(best[0]))
        if not open_.size:
            break
        tried = _try(space, passes, ball, some[open_], np.full(tilts.size, own_lead), tilts)
        order = np.argsort(np.abs(tried.tilt) - 1e-6 * tried.tilt, kind="stable")
        good = tried.clearance[:, order] >= WANTED * ball.radius
        first, most = np.argmax(good, axis=1), np.argmax(tried.clearance[:, order], axis=1)
        taken = order[np.where(good.any(axis=1), first, most)]
        rows = np.arange(open_.size)
        fits = tried.clearance[rows, taken] > 0.0
        best[:, open_[fits]] = tried.lead[taken[fits]], tried.tilt[taken[fits]]
        clear[open_] = np.maximum(clear[open_], tried.clear.max(axis=1))
    if np.isnan(best).any():
        longest = float(clear[np.isnan(best[0])].min())
        raise NoSolutionError(
            "tool",
            ball.text,
            reason=f"with no tool axis that was tried is a shank of {ball.length:.4g} mm"
            + ("" if ball.holder is None else f" with its holder of {ball.holder:.4g} mm")
            + " clear of the teeth"
            + (f", one of {longest:.4g} mm is" if ball.radius < longest < np.inf else ""),
            remedy=f"give {'a shorter' if ball.holder is None else 'another'} length, or another lead and tilt",
        )
    return best


def _try(space: CutSpace, passes: Passes, ball: BallCutter, some: Array, leads: Array, tilts: Array) -> _Tried:
    """Clearance and clear length of passes (P,) with axes (K,)."""
    clearance = np.full((some.size, tilts.size), np.inf)
    clear = np.full_like(clearance, np.inf)
    count = passes.centres.shape[1]
    for j in np.unique(np.linspace(0, count - 1, STATIONS).round().astype(int)):
        centres, normals, side = passes.centres[some, j], passes.normals[some, j], passes.side[some]
        axes = passes.frames.at(j).axis(leads, tilts, side[:, None])[..., 0, :]
        rise = dot(axes, normals[:, None])
        own = np.where(rise > 0.0, ball.radius * (1.0 / np.sqrt(np.maximum(1.0 - rise**2, 1e-12)) - 1.0), rise)
        clearance = np.minimum(clearance, own)
        clear = np.where(rise > 0.0, clear, 0.0)
        for points, gap in _in_the_way(space, passes, ball, int(j)):
            away, up = _from_axis(centres, axes, points)
            for part in ball.cylinders:
                within = (up > part.low) & (up < part.high)
                beside = np.where(within, away - part.radius - gap, np.inf).min(axis=-1)
                clearance = np.minimum(clearance, beside)
            hit = (up > 0.0) & (away < ball.radius + gap)
            clear = np.minimum(clear, np.where(hit, up, np.inf).min(axis=-1))
    return _Tried(leads, tilts, clearance, clear)


def _from_axis(centres: Array, axes: Array, points: Array) -> tuple[Array, Array]:
    """Distance (P, K, Q), mm, of points (Q, 3) from axes (P, K, 3), and their height over the centres (P, 3)."""
    way = points - centres[:, None]
    up = np.matmul(axes, np.swapaxes(way, 1, 2))
    away = np.sqrt(np.maximum(dot(way, way)[:, None] - up**2, 0.0))
    return away, up


def _in_the_way(space: CutSpace, passes: Passes, ball: BallCutter, j: int) -> list[tuple[Array, float]]:
    """Points (Q, 3) of the teeth about a station and of all others that the shank may reach, in blocks, each with what the teeth
    may be nearer (mm) than their points."""
    stations, extent = passes.sections.stations, space.tooth.blank.extent
    at = stations[j] + ball.radius * np.array(BESIDE)
    sections = space.tooth.sections(np.unique(np.clip((at - extent[0]) / (extent[1] - extent[0]), 0.0, 1.0)))
    s = np.linspace(0.0, 1.0, ACROSS)
    near = [wall.jet(s, sections).r.reshape(-1, 3) for wall in space.walls]
    close = np.concatenate((*near, space.beyond(np.linspace(0.0, 1.0, 5), sections), space.beside))
    (far, gap), middle = space.far, passes.centres[:, j].mean(axis=0)
    reach = ball.length + ball.radius + gap + np.sqrt(((passes.centres[:, j] - middle) ** 2).sum(axis=-1)).max()
    if ball.holder is None:
        far = far[((far - middle) ** 2).sum(axis=-1) < reach**2]
    clouds = ((close, 0.0), (far, gap))
    return [(points[k : k + BLOCK], own) for points, own in clouds for k in range(0, len(points), BLOCK)]
