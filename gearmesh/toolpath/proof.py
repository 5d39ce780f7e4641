r"""What a motion leaves, measured on the exact surfaces by a route that knows nothing of how it was planned.

The ball sweeps a capsule along each straight way of its centre. Where the normal n in a point q of the exact surface enters
a capsule
from a to b first, at q + z n, the finished surface stands z over the exact one. With c(l) = a + l (b - a), w = c - q and w'
the part of w across n,

    z = min over l in [0, 1] of  n . w - sqrt(R^2 - |w'|^2)

which is a convex function of l: with d' the part of b - a across n and D its length, beta = n . (b - a), m the least |w'| of the
line, at l0, and W^2 = R^2 - m^2, its least value is at l = l0 - beta W / (D sqrt(D^2 + beta^2)), or at the end of the range
next to it.
The least z of all capsules is left, less the stock: a negative one is a gouge. Points beside the walls, on lands, tip edges
and other teeth, are gouged where they are nearer than R to the way of the centre.

Only ways whose middle is near a point are asked, all of them: those farther off cannot reach it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.ball import BallCutter, ToolCylinder
from gearmesh.toolpath.motion import ToolMotion
from gearmesh.toolpath.passes import Passes
from gearmesh.toolpath.space import CutSpace

#: points of a wall in the step of a pass, beside the pass itself and the middle between two, and the fewest across a wall
IN_STEP, FEWEST = 2, 25
#: most chords along a wall whose ends and middles are among the points, to know how close passes have to be, and for the proof
DRAFT, CHORDS = 12, 60
#: points across what is not finished
BESIDE = 9
#: longest way (radii of the ball) that is asked as one
PIECE = 0.12
#: most pieces, of which there are some hundred bytes each
MOST_PIECES = 5_000_000
#: points asked at once
BLOCK = 20_000
#: distance of points (radii of the ball) that stand for the teeth beside a shank, and clearance up to which it is measured
SPACING, MEASURED = 0.125, 0.25
#: most stations of these points
ALONG = 2001
#: most positions of a shank that are measured, all if there are fewer than twice as many
MOST = 3000
#: positions at once
CENTRES = 256
#: places on the way from one space to the next
STEPS = 33


@dataclass(frozen=True)
class Left:
    """What is left over the exact surface, less the stock: largest and least height (mm) on the walls that are finished, by region,
    and the deepest gouge (mm, positive) anywhere."""

    largest: dict[Region, float]
    least: dict[Region, float]
    gouge: float
    points: int

    @property
    def scallop(self) -> float:
        """Largest height, mm."""
        return max(self.largest.values())


@dataclass(frozen=True)
class _Ways:
    """Straight ways (M, 3) of the ball's centre, none longer than a piece, and their tree by the middles."""

    start: Array
    end: Array
    radius: float
    tree: Any
    longest: float

    @staticmethod
    def of(ways: tuple[Array, Array], radius: float) -> _Ways:
        from scipy.spatial import cKDTree

        start, end = ways
        way = end - start
        pieces = np.maximum(1, np.ceil(np.sqrt(dot(way, way)) / (PIECE * radius))).astype(int)
        if pieces.sum() > MOST_PIECES:
            length = float(np.sqrt(dot(way, way)).sum())
            raise NoSolutionError(
                reason=f"the path through a space is {length:.3g} mm long, more than {PIECE * MOST_PIECES:g} radii of the ball",
                remedy="choose a larger ball or a larger scallop",
            )
        owner = np.repeat(np.arange(len(start)), pieces)
        number = np.arange(owner.size) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        first, last = (start[owner] + ((number + k) / pieces[owner])[:, None] * way[owner] for k in (0, 1))
        longest = float(np.sqrt((dot(way, way) / pieces**2).max()))
        return _Ways(first, last, radius, cKDTree(0.5 * (first + last)), longest)

    def near(self, points: Array, reach: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Numbers of points (Q, 3), and of ways that are nearer to them than radius and `reach` (mm)."""
        return _pairs(self.tree, points, self.radius + 0.5 * self.longest + reach)


def _pairs(tree: Any, points: Array, distance: float) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Numbers of points (Q, 3), and of those of a tree that are nearer to them than a distance."""
    lists = tree.query_ball_point(points, distance, return_sorted=False)
    sizes = np.fromiter(map(len, lists), dtype=np.int64, count=len(lists))
    near = np.fromiter(chain.from_iterable(lists), dtype=np.int64, count=int(sizes.sum()))
    return np.repeat(np.arange(len(points)), sizes), near


def measure_left(
    space: CutSpace,
    walls: Sequence[int],
    passes: Passes,
    motion: ToolMotion,
    stock: float,
    scallop: float,
    chords: int = CHORDS,
) -> Left:
    """What a motion in this space leaves on its walls, and what it gouges. Heights beyond two scallops count as infinite."""
    ways, reach = _Ways.of(motion.cuts, motion.radius), stock + 2.0 * scallop
    sections = space.tooth.sections(_stations(passes.sections.t, chords))
    largest, least, gouge, count = {}, {}, 0.0, 0
    for k, wall in enumerate(space.walls):
        shares = _lines(passes.line[passes.wall == k])
        jets = [wall.jet(s, sections) for s in _places(passes, k, shares, sections)]
        points, normals = (np.concatenate([getattr(jet, name).reshape(-1, 3) for jet in jets]) for name in ("r", "n"))
        heights = _heights(points, normals, ways, reach) - stock
        count += heights.size
        gouge = max(gouge, -float(heights.min()) - (0.0 if k in walls else stock))
        if k in walls:
            largest[wall.region], least[wall.region] = float(heights.max()), float(heights.min())
    beyond = np.concatenate((space.beyond(np.linspace(0.0, 1.0, BESIDE), sections), space.beside, space.far[0]))
    every = _Ways.of(motion.rapids, motion.radius)
    beside = np.concatenate([_distances(beyond, own) for own in (ways, every)])
    return Left(largest, least, max(gouge, -float(beside.min())), count + beside.size)


def _stations(t: Array, chords: int) -> Array:
    """Stations at ends and middles of chords that end at t (T,), of some where there are many."""
    k = np.unique(np.linspace(0, t.size - 2, min(t.size - 1, chords)).round().astype(int))
    return np.unique(np.concatenate((t[k], 0.5 * (t[k] + t[k + 1]), t[k + 1])))


def _lines(passes: Array) -> Array:
    """Places across a wall: evenly, and at its passes (P,) and in their middles."""
    ends = np.unique(np.concatenate(([0.0], passes, [1.0])))
    even = np.linspace(0.0, 1.0, max(FEWEST, IN_STEP * ends.size + 1))
    return np.unique(np.concatenate((even, ends, 0.5 * (ends[1:] + ends[:-1]))))


def _places(passes: Passes, wall: int, shares: Array, sections: Sections) -> list[Array]:
    """s (S,) or (S, T) at which a wall is measured: shares of what is reached of it, and of what is not, evenly."""
    s = passes.parts.s(wall, shares, sections)
    if s.ndim == 1:
        return [s]
    even = np.linspace(0.0, 1.0, BESIDE)[:, None]
    return [s, s[0] * even, s[-1] + (1.0 - s[-1]) * even]


def _heights(points: Array, normals: Array, ways: _Ways, reach: float) -> Array:
    """Heights (Q,) at which normals enter the swept balls first; infinite beyond `reach`."""
    blocks = [slice(k, k + BLOCK) for k in range(0, len(points), BLOCK)]
    return np.concatenate([_heights_of_block(points[block], normals[block], ways, reach) for block in blocks])


def _heights_of_block(points: Array, normals: Array, ways: _Ways, reach: float) -> Array:
    point, way = ways.near(points, reach)
    n, start = normals[point], ways.start[way] - points[point]
    along = ways.end[way] - ways.start[way]
    rise, beta = dot(n, start), dot(n, along)
    across, aside = along - beta[:, None] * n, start - rise[:, None] * n
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
    """Distances (Q,), mm, of points from the swept balls, negative within them; infinite of those that are far."""
    point, way = ways.near(points, 0.0)
    along, start = ways.end[way] - ways.start[way], points[point] - ways.start[way]
    length = dot(along, along)
    share = np.clip(np.divide(dot(start, along), length, out=np.zeros_like(length), where=length > 0.0), 0.0, 1.0)
    away = start - share[:, None] * along
    distances = np.full(len(points), np.inf)
    np.minimum.at(distances, point, np.sqrt(dot(away, away)) - ways.radius)
    return distances


def clear_of_teeth(space: CutSpace, motion: ToolMotion, places: Sequence[Rigid]) -> bool:
    """Whether the ball on its way from the end of a motion in one place to its start in the next stays clear of the teeth."""
    from scipy.spatial import cKDTree

    start, end = motion.centres[0], motion.centres[-1]
    ways = [(before.point(end), after.point(start)) for before, after in pairwise(places)]
    steps = np.linspace(0.0, 1.0, STEPS)[:, None]
    centres = np.concatenate([a + steps * (b - a) for a, b in ways])
    return bool(cKDTree(np.concatenate((space.beside, space.far[0]))).query(centres)[0].min() > motion.radius)


def shank_clearance(space: CutSpace, motion: ToolMotion, ball: BallCutter) -> float:
    """Least distance (mm) of shank and holder from the teeth while the ball is at work, infinite from MEASURED radii on.

    The teeth beside the space are points of exact surfaces not farther from each other than e = SPACING radii; a shank could be
    nearer to the surface between them by e^2 / 4R, which is taken off. Of all other teeth, which are far, as much is taken off as
    their points may be from any other. A holder begins e sooner, as its rim might come between points.
    """
    touching = np.flatnonzero(np.isfinite(motion.contacts[:, 0]))
    at = touching[:: max(1, len(touching) // MOST)]
    centres, axes = motion.centres[at], unit(motion.axes[at])
    near = np.concatenate((_dense(space, SPACING * ball.radius), space.beside))
    spacing = SPACING * ball.radius
    least = np.inf
    for part in ball.cylinders:
        clouds = ((near, 0.25 * spacing**2 / part.radius), space.far)
        own = replace(part, low=max(0.0, part.low - spacing))
        least = min(least, *(_clearance(cloud, centres, axes, own, gap) for cloud, gap in clouds))
    return least


def _clearance(teeth: Array, centres: Array, axes: Array, part: ToolCylinder, gap: float) -> float:
    """Least distance (mm), less a gap, of points (K, 3) from a cylinder over centres along axes (N, 3)."""
    from scipy.spatial import cKDTree

    if not len(teeth):
        return np.inf
    tree, least, step = cKDTree(teeth), np.inf, 0.5 * part.radius
    widest = part.radius * (1.0 + MEASURED) + gap
    # no tooth is farther than the teeth and the centres are from each other
    every = np.concatenate((teeth, centres))
    high = min(part.high, float(np.linalg.norm(np.ptp(every, axis=0))))
    up_to = np.arange(part.low, high + step, step)
    if not up_to.size:
        return np.inf
    for k in range(0, len(centres), CENTRES):
        centre, axis = centres[k : k + CENTRES], axes[k : k + CENTRES]
        samples = (centre[:, None] + up_to[:, None] * axis[:, None]).reshape(-1, 3)
        sample, point = _pairs(tree, samples, float(np.hypot(widest, 0.5 * step)))
        own = sample // up_to.size
        way = teeth[point] - centre[own]
        up = dot(way, axis[own])
        beside = np.sqrt(np.maximum(dot(way, way) - up**2, 0.0)) - part.radius
        least = min(least, float(beside[(up > part.low) & (up < part.high)].min(initial=np.inf)))
    return least - gap


def _dense(space: CutSpace, spacing: float) -> Array:
    """Points (K, 3) of the walls and what is beside them, about `spacing` (mm) apart."""
    along = int(np.clip(np.ceil(1.2 * space.length / spacing), 9, ALONG))
    sections = space.tooth.sections(np.linspace(0.0, 1.0, along))
    points = [space.beyond(np.linspace(0.0, 1.0, BESIDE), sections)]
    for wall in space.walls:
        line = wall.jet(np.linspace(0.0, 1.0, BESIDE), sections[:: along - 1]).r
        width = float(np.linalg.norm(np.diff(line, axis=0), axis=-1).sum(axis=0).max())
        s = np.linspace(0.0, 1.0, int(np.clip(np.ceil(1.2 * width / spacing), 1, 200)) + 1)
        points.append(wall.jet(s, sections).r.reshape(-1, 3))
    return np.concatenate(points)
