"""Proof of a motion: the material that it leaves, measured on the exact surfaces independently of the plan.

The ball sweeps a capsule along each straight path of its centre. Let n be the normal in a point q of the exact surface.
If n first enters a capsule from a to b at q + z n, the finished surface is z above the exact surface. Let
c(l) = a + l (b - a), w = c - q and w' the part of w across n:

    z = min over l in [0, 1] of  n . w - sqrt(R^2 - |w'|^2)

This is a convex function of l. Let d' be the part of b - a across n and D its length, and let beta = n . (b - a). m is
the least |w'| on the line, at l0, and W^2 = R^2 - m^2. The minimum is at l = l0 - beta W / (D sqrt(D^2 + beta^2)), or
at the nearest end of the range. The least z of all capsules, less the stock, is the height left; a negative height is a
gouge. Points beside the walls, on lands, tip edges and other teeth, are gouged if they are nearer than R to the path of
the centre.

For each point all paths whose middle is near enough are evaluated; paths farther away cannot reach the point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import chain, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.ball import BallCutter, ToolCylinder
from gearmesh.toolpath.motion import ToolMotion
from gearmesh.toolpath.order import PathOrder
from gearmesh.toolpath.passes import Passes
from gearmesh.toolpath.space import CutSpace

#: points of a wall per step between passes, besides the pass itself and the middle between two passes
POINTS_PER_STEP = 2
#: smallest number of points across a wall
MIN_POINTS_ACROSS = 25
#: chords along a wall whose ends and middles are measured first, to find the density of the passes
DRAFT_CHORDS = 12
#: chords along a wall whose ends and middles are measured in the proof
PROOF_CHORDS = 60
#: points across surfaces that are not finished
POINTS_ACROSS_UNFINISHED = 9
#: longest piece of a path that is evaluated as one, in radii of the ball
MAX_PIECE_RADII = 0.12
#: limit of the pieces; each takes a few hundred bytes
MAX_PIECES = 5_000_000
#: points that are evaluated at once
POINTS_PER_BLOCK = 20_000
#: spacing of the points that represent the teeth beside a shank, in radii of the ball
TEETH_SPACING_RADII = 0.125
#: clearance up to which a shank is measured, in radii of the ball
MEASURED_CLEARANCE_RADII = 0.25
#: limit of the stations of the points beside a shank
MAX_STATIONS = 2001
#: number of measured positions of a shank; all positions if there are fewer than twice as many
SHANK_POSITIONS = 3000
#: positions of a shank that are evaluated at once
POSITIONS_PER_BLOCK = 256
#: points on the path from one space to the next
POINTS_BETWEEN_SPACES = 33


@dataclass(frozen=True)
class Left:
    """Heights left over the exact surface, less the stock, on the finished walls, and gouges anywhere."""

    #: largest height (mm) by region
    largest: dict[Region, float]
    #: smallest height (mm) by region
    least: dict[Region, float]
    #: depth of the deepest gouge, mm, positive
    gouge: float
    #: number of measured points
    points: int

    @property
    def scallop(self) -> float:
        """Largest height, mm."""
        return max(self.largest.values())


@dataclass(frozen=True)
class _Ways:
    """Straight paths of the ball's centre, divided into pieces, with a search tree of their middles."""

    #: starts (M, 3) of the pieces, mm
    start: Array
    #: ends (M, 3) of the pieces, mm
    end: Array
    #: radius of the ball, mm
    radius: float
    #: cKDTree of the middles
    tree: Any
    #: length of the longest piece, mm
    longest: float

    @staticmethod
    def of(ways: tuple[Array, Array], radius: float) -> _Ways:
        """Return the paths `ways`, starts and ends (M, 3), as pieces. Raises NoSolutionError for too many pieces."""
        from scipy.spatial import cKDTree

        start, end = ways
        way = end - start
        pieces = np.maximum(1, np.ceil(np.sqrt(dot(way, way)) / (MAX_PIECE_RADII * radius))).astype(int)
        if pieces.sum() > MAX_PIECES:
            length = float(np.sqrt(dot(way, way)).sum())
            raise NoSolutionError(
                reason=f"the path through a space is {length:.3g} mm long, "
                f"more than {MAX_PIECE_RADII * MAX_PIECES:g} radii of the ball",
                remedy="choose a larger ball or a larger scallop",
            )
        owner = np.repeat(np.arange(len(start)), pieces)
        number = np.arange(owner.size) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        first, last = (start[owner] + ((number + k) / pieces[owner])[:, None] * way[owner] for k in (0, 1))
        longest = float(np.sqrt((dot(way, way) / pieces**2).max()))
        return _Ways(first, last, radius, cKDTree(0.5 * (first + last)), longest)

    def near(self, points: Array, reach: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return numbers of points (Q, 3) and of pieces, in pairs that may be within radius plus `reach` (mm)."""
        return _pairs(self.tree, points, self.radius + 0.5 * self.longest + reach)


def _pairs(tree: Any, points: Array, distance: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return numbers of points (Q, 3) and of points of a tree, in pairs nearer to each other than a distance."""
    lists = tree.query_ball_point(points, distance, return_sorted=False)
    sizes = np.fromiter(map(len, lists), dtype=np.int64, count=len(lists))
    near = np.fromiter(chain.from_iterable(lists), dtype=np.int64, count=int(sizes.sum()))
    return np.repeat(np.arange(len(points)), sizes), near


def measure_left(
    space: CutSpace,
    walls: Sequence[int],
    passes: Passes,
    motion: ToolMotion,
    order: PathOrder,
    chords: int = PROOF_CHORDS,
) -> Left:
    """Return the heights left on the walls of this space by a motion, and its gouges.

    Heights above two scallops count as infinite.
    """
    ways, reach = _Ways.of(motion.cuts, motion.radius), order.stock + 2.0 * order.scallop
    sections = space.tooth.sections(_stations(passes.sections.t, chords))
    largest, least, gouge, count = {}, {}, 0.0, 0
    # heights along the normals on all walls: gouges count on every wall, heights on the finished walls
    for k, wall in enumerate(space.walls):
        shares = _lines(passes.line[passes.wall == k])
        jets = [wall.jet(s, sections) for s in _places(passes, k, shares, sections)]
        points, normals = (np.concatenate([getattr(jet, name).reshape(-1, 3) for jet in jets]) for name in ("r", "n"))
        heights = _heights(points, normals, ways, reach) - order.stock
        count += heights.size
        gouge = max(gouge, -float(heights.min()) - (0.0 if k in walls else order.stock))
        if k in walls:
            largest[wall.region], least[wall.region] = float(heights.max()), float(heights.min())
    # distances of all other surfaces from the swept balls, rapid paths included
    beyond = np.concatenate(
        (space.beyond(np.linspace(0.0, 1.0, POINTS_ACROSS_UNFINISHED), sections), space.beside, space.far[0])
    )
    rapid_ways = _Ways.of(motion.rapids, motion.radius)
    beside = np.concatenate([_distances(beyond, own) for own in (ways, rapid_ways)])
    return Left(largest, least, max(gouge, -float(beside.min())), count + beside.size)


def _stations(t: Array, chords: int) -> Array:
    """Return stations at ends and middles of chords that end at t (T,), of at most `chords` chords."""
    k = np.unique(np.linspace(0, t.size - 2, min(t.size - 1, chords)).round().astype(int))
    return np.unique(np.concatenate((t[k], 0.5 * (t[k] + t[k + 1]), t[k + 1])))


def _lines(passes: Array) -> Array:
    """Return places across a wall: evenly spaced, at its passes (P,) and half way between passes."""
    ends = np.unique(np.concatenate(([0.0], passes, [1.0])))
    even = np.linspace(0.0, 1.0, max(MIN_POINTS_ACROSS, POINTS_PER_STEP * ends.size + 1))
    return np.unique(np.concatenate((even, ends, 0.5 * (ends[1:] + ends[:-1]))))


def _places(passes: Passes, wall: int, shares: Array, sections: Sections) -> list[Array]:
    """Return s (S,) or (S, T) at which a wall is measured.

    The places are given shares of the reached part of the wall, and even shares of the rest.
    """
    s = passes.parts.s(wall, shares, sections)
    if s.ndim == 1:
        return [s]
    even = np.linspace(0.0, 1.0, POINTS_ACROSS_UNFINISHED)[:, None]
    return [s, s[0] * even, s[-1] + (1.0 - s[-1]) * even]


def _heights(points: Array, normals: Array, ways: _Ways, reach: float) -> Array:
    """Return heights (Q,) at which normals first enter the swept balls; infinite beyond `reach`."""
    blocks = [slice(k, k + POINTS_PER_BLOCK) for k in range(0, len(points), POINTS_PER_BLOCK)]
    return np.concatenate([_heights_of_block(points[block], normals[block], ways, reach) for block in blocks])


def _heights_of_block(points: Array, normals: Array, ways: _Ways, reach: float) -> Array:
    """Return heights (Q,) of one block of points, as in the module's docstring."""
    point, way = ways.near(points, reach)
    n, start = normals[point], ways.start[way] - points[point]
    along = ways.end[way] - ways.start[way]
    rise, beta = dot(n, start), dot(n, along)
    across, aside = along - beta[:, None] * n, start - rise[:, None] * n
    # minimum of the convex function of the share l along a piece; a piece along the normal has its minimum at an end
    square = dot(across, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        nearest = np.where(square > 0.0, -dot(aside, across) / square, 0.0)
        least = dot(aside, aside) - nearest**2 * square
        half = np.sqrt(np.maximum(ways.radius**2 - least, 0.0))
        share = nearest - np.where(square > 0.0, beta * half / np.sqrt(square * (square + beta**2)), 0.0)
        share = np.clip(np.where(square > 0.0, share, np.where(beta < 0.0, 1.0, 0.0)), 0.0, 1.0)
        inside = ways.radius**2 - least - (share - nearest) ** 2 * square
        height = rise + share * beta - np.sqrt(inside)
    heights = np.full(len(points), np.inf)
    np.minimum.at(heights, point, np.where(np.isfinite(height), height, np.inf))
    return heights


def _distances(points: Array, ways: _Ways) -> Array:
    """Return distances (Q,), mm, of points from the swept balls, negative inside; infinite for points far away."""
    point, way = ways.near(points, 0.0)
    along, start = ways.end[way] - ways.start[way], points[point] - ways.start[way]
    length = dot(along, along)
    share = np.clip(np.divide(dot(start, along), length, out=np.zeros_like(length), where=length > 0.0), 0.0, 1.0)
    away = start - share[:, None] * along
    distances = np.full(len(points), np.inf)
    np.minimum.at(distances, point, np.sqrt(dot(away, away)) - ways.radius)
    return distances


def clear_of_teeth(space: CutSpace, motion: ToolMotion, places: Sequence[Rigid]) -> bool:
    """Return True if the ball stays clear of the teeth between the motions in successive places.

    It moves straight from the end of the motion in one place to the start of the motion in the next place.
    """
    from scipy.spatial import cKDTree

    start, end = motion.centres[0], motion.centres[-1]
    ways = [(before.point(end), after.point(start)) for before, after in pairwise(places)]
    steps = np.linspace(0.0, 1.0, POINTS_BETWEEN_SPACES)[:, None]
    centres = np.concatenate([a + steps * (b - a) for a, b in ways])
    return bool(cKDTree(np.concatenate((space.beside, space.far[0]))).query(centres)[0].min() > motion.radius)


def shank_clearance(space: CutSpace, motion: ToolMotion, ball: BallCutter) -> float:
    """Return the least distance (mm) of shank and holder from the teeth at work.

    It is infinite above MEASURED_CLEARANCE_RADII. The teeth beside the space are points of exact surfaces at a spacing
    e of TEETH_SPACING_RADII. A shank could be nearer to the surface between the points by e^2 / 4R, which is
    subtracted. For all other teeth, which are far, the largest distance of a surface point from its nearest sampled
    point is subtracted. A holder begins e sooner, as its rim might come between points.
    """
    touching = np.flatnonzero(np.isfinite(motion.contacts[:, 0]))
    measured = touching[:: max(1, len(touching) // SHANK_POSITIONS)]
    centres, axes = motion.centres[measured], unit(motion.axes[measured])
    near = np.concatenate((_dense(space, TEETH_SPACING_RADII * ball.radius), space.beside))
    spacing = TEETH_SPACING_RADII * ball.radius
    least = np.inf
    for part in ball.cylinders:
        clouds = ((near, 0.25 * spacing**2 / part.radius), space.far)
        extended_part = replace(part, low=max(0.0, part.low - spacing))
        least = min(least, *(_clearance(cloud, centres, axes, extended_part, gap) for cloud, gap in clouds))
    return least


def _clearance(teeth: Array, centres: Array, axes: Array, part: ToolCylinder, gap: float) -> float:
    """Return the least distance (mm), less `gap`, of points (K, 3) from a cylinder over centres along axes (N, 3)."""
    from scipy.spatial import cKDTree

    if not len(teeth):
        return np.inf
    tree, least, step = cKDTree(teeth), np.inf, 0.5 * part.radius
    widest = part.radius * (1.0 + MEASURED_CLEARANCE_RADII) + gap
    # limit an endless holder to the extent of teeth and centres
    all_points = np.concatenate((teeth, centres))
    high = min(part.high, float(np.linalg.norm(np.ptp(all_points, axis=0))))
    up_to = np.arange(part.low, high + step, step)
    if not up_to.size:
        return np.inf
    # samples along the axis find the points of the teeth near the cylinder, whose exact distance is then taken
    for k in range(0, len(centres), POSITIONS_PER_BLOCK):
        centre, axis = centres[k : k + POSITIONS_PER_BLOCK], axes[k : k + POSITIONS_PER_BLOCK]
        samples = (centre[:, None] + up_to[:, None] * axis[:, None]).reshape(-1, 3)
        sample, point = _pairs(tree, samples, float(np.hypot(widest, 0.5 * step)))
        position = sample // up_to.size
        way = teeth[point] - centre[position]
        up = dot(way, axis[position])
        beside = np.sqrt(np.maximum(dot(way, way) - up**2, 0.0)) - part.radius
        least = min(least, float(beside[(up > part.low) & (up < part.high)].min(initial=np.inf)))
    return least - gap


def _dense(space: CutSpace, spacing: float) -> Array:
    """Return points (K, 3) of the walls and of the surfaces beside them, about `spacing` (mm) apart."""
    along = int(np.clip(np.ceil(1.2 * space.length / spacing), 9, MAX_STATIONS))
    sections = space.tooth.sections(np.linspace(0.0, 1.0, along))
    points = [space.beyond(np.linspace(0.0, 1.0, POINTS_ACROSS_UNFINISHED), sections)]
    for wall in space.walls:
        line = wall.jet(np.linspace(0.0, 1.0, POINTS_ACROSS_UNFINISHED), sections[:: along - 1]).r
        width = float(np.linalg.norm(np.diff(line, axis=0), axis=-1).sum(axis=0).max())
        s = np.linspace(0.0, 1.0, int(np.clip(np.ceil(1.2 * width / spacing), 1, 200)) + 1)
        points.append(wall.jet(s, sections).r.reshape(-1, 3))
    return np.concatenate(points)
