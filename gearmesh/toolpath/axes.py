"""Tool axes: one lead and one tilt per pass, from the opening of the space, that keep the shank clear of teeth.

A shank of radius R lies along the axis a from the ball's centre c. A point q beside it, 0 < (q - c) . a < L, is at the
distance

    |(q - c) - ((q - c) . a) a| - R

The axis a rises from the tangent plane at the point of contact by beta (sin beta = a . n). The distance of the shank
from this plane is R (1 / cos beta - 1).

Of all tried directions with the wanted clearance, the direction nearest to the opening of the space is taken. If no
direction has the wanted clearance, the direction with the largest clearance is taken. Directions are chosen at a few
passes and stations, and the angles of the passes between are interpolated. `proof` measures the clearance of the
resulting axes at the points of all passes.
"""

from __future__ import annotations

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.records import dataclass
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.order import PathOrder
from gearmesh.toolpath.passes import Passes
from gearmesh.toolpath.space import CutSpace

#: tilts that are tried, away from the wall
TRIED_TILTS_DEG = np.arange(-40.0, 85.0, 5.0)
#: leads that are tried, towards the heel; leads after the first only where no tilt alone keeps the shank clear
TRIED_LEADS_DEG = (0.0, 20.0, -20.0, 40.0, -40.0, 60.0, -60.0)
#: wanted clearance, in radii of the ball
WANTED_CLEARANCE_RADII = 0.05
#: passes for which axes are chosen
MAX_CHOSEN_PASSES = 21
#: stations at which axes are chosen
MAX_CHOSEN_STATIONS = 7
#: points across a wall of the teeth near a station
POINTS_ACROSS_WALL = 25
#: distances from a station, in radii of the ball, of the sections that represent the teeth near it
SECTION_OFFSETS_RADII = (-0.5, -0.25, 0.0, 0.25, 0.5)
#: points of the teeth that are processed at once
POINTS_PER_BLOCK = 2_000


@dataclass(frozen=True)
class Axes:
    """Lead and tilt (P,), rad, of each pass, and unit axes (P, N, 3) from the ball to the shank at its points."""

    lead: Array
    tilt: Array
    vectors: Array


@dataclass(frozen=True)
class _Tried:
    """Directions that were tried, with their clearances."""

    #: lead (K,), rad
    lead: Array
    #: tilt (K,), rad
    tilt: Array
    #: clearance (P, K) of the shank, mm
    clearance: Array
    #: longest shank (P, K) that stays clear, mm
    clear: Array


def choose_axes(space: CutSpace, passes: Passes, ball: BallCutter, order: PathOrder) -> Axes:
    """Return the axes of all passes. Lead and tilt are kept if the order gives them.

    Raises NoSolutionError, with the longest clear shank, if the shank is not clear of the teeth.
    """
    chosen = np.unique(np.linspace(0, len(passes.centres) - 1, MAX_CHOSEN_PASSES).round().astype(int))
    if order.lead is not None and order.tilt is not None:
        angles = np.full((2, chosen.size), [[order.lead], [order.tilt]])
    else:
        angles = _choose(space, passes, ball, chosen, order.lead, order.tilt)
    # angles are interpolated separately on either side of the root, because a tilt leans away from the wall of its side
    all_angles = np.empty((2, len(passes.centres)))
    for side in np.unique(passes.side):
        passes_of_side, of_side = np.flatnonzero(passes.side == side), passes.side[chosen] == side
        passes_with_angles, values = (chosen[of_side], angles[:, of_side]) if of_side.any() else (chosen, angles)
        all_angles[:, passes_of_side] = [np.interp(passes_of_side, passes_with_angles, row) for row in values]
    return Axes(all_angles[0], all_angles[1], passes.frames.axis(all_angles[0], all_angles[1], passes.side))


def _choose(
    space: CutSpace, passes: Passes, ball: BallCutter, some: Array, lead: float | None, tilt: float | None
) -> Array:
    """Return lead and tilt (2, S), rad, of the passes numbered `some` (S,)."""
    tilts = np.radians(TRIED_TILTS_DEG) if tilt is None else np.array([tilt])
    leads = np.radians(TRIED_LEADS_DEG) if lead is None else np.array([lead])
    best = np.full((2, some.size), np.nan)
    clear = np.zeros(some.size)
    # each lead is tried for the passes that no earlier lead keeps clear
    for tried_lead in leads:
        undecided = np.flatnonzero(np.isnan(best[0]))
        if not undecided.size:
            break
        tried = _try(space, passes, ball, some[undecided], np.full(tilts.size, tried_lead), tilts)
        # take the smallest tilt with the wanted clearance, or else the tilt with the largest clearance
        order = np.argsort(np.abs(tried.tilt) - 1e-6 * tried.tilt, kind="stable")
        good = tried.clearance[:, order] >= WANTED_CLEARANCE_RADII * ball.radius
        first_good, largest = np.argmax(good, axis=1), np.argmax(tried.clearance[:, order], axis=1)
        taken = order[np.where(good.any(axis=1), first_good, largest)]
        rows = np.arange(undecided.size)
        fits = tried.clearance[rows, taken] > 0.0
        best[:, undecided[fits]] = tried.lead[taken[fits]], tried.tilt[taken[fits]]
        clear[undecided] = np.maximum(clear[undecided], tried.clear.max(axis=1))
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
    """Return clearance and clear length for the passes numbered `some` (P,) with axes of K leads and tilts."""
    clearance = np.full((some.size, tilts.size), np.inf)
    clear = np.full_like(clearance, np.inf)
    count = passes.centres.shape[1]
    for j in np.unique(np.linspace(0, count - 1, MAX_CHOSEN_STATIONS).round().astype(int)):
        centres, normals, side = passes.centres[some, j], passes.normals[some, j], passes.side[some]
        axes = passes.frames.at(j).axis(leads, tilts, side[:, None])[..., 0, :]
        # clearance from the wall that the ball touches, by the angle of the axis over its tangent plane
        rise = dot(axes, normals[:, None])
        wall_clearance = np.where(
            rise > 0.0, ball.radius * (1.0 / np.sqrt(np.maximum(1.0 - rise**2, 1e-12)) - 1.0), rise
        )
        clearance = np.minimum(clearance, wall_clearance)
        clear = np.where(rise > 0.0, clear, 0.0)
        # clearance from points of the teeth: shank and holder as cylinders, and height of an endless shank
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
    """Return distances (P, K, Q), mm, of points (Q, 3) from axes (P, K, 3), and heights over the centres (P, 3)."""
    way = points - centres[:, None]
    up = np.matmul(axes, np.swapaxes(way, 1, 2))
    away = np.sqrt(np.maximum(dot(way, way)[:, None] - up**2, 0.0))
    return away, up


def _in_the_way(space: CutSpace, passes: Passes, ball: BallCutter, j: int) -> list[tuple[Array, float]]:
    """Return blocks of points (Q, 3) of the teeth that the shank may reach at a station, each with a margin (mm).

    The points belong to the teeth about the station and to all other teeth. A tooth may be nearer than its points by
    the margin.
    """
    stations, extent = passes.sections.stations, space.tooth.blank.extent
    at = stations[j] + ball.radius * np.array(SECTION_OFFSETS_RADII)
    sections = space.tooth.sections(np.unique(np.clip((at - extent[0]) / (extent[1] - extent[0]), 0.0, 1.0)))
    s = np.linspace(0.0, 1.0, POINTS_ACROSS_WALL)
    near = [wall.jet(s, sections).r.reshape(-1, 3) for wall in space.walls]
    close = np.concatenate((*near, space.beyond(np.linspace(0.0, 1.0, 5), sections), space.beside))
    (far, gap), middle = space.far, passes.centres[:, j].mean(axis=0)
    reach = ball.length + ball.radius + gap + np.sqrt(((passes.centres[:, j] - middle) ** 2).sum(axis=-1)).max()
    if ball.holder is None:
        far = far[((far - middle) ** 2).sum(axis=-1) < reach**2]
    clouds = ((close, 0.0), (far, gap))
    return [
        (points[k : k + POINTS_PER_BLOCK], margin)
        for points, margin in clouds
        for k in range(0, len(points), POINTS_PER_BLOCK)
    ]
