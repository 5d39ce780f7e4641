"""Passes along the tooth: lines s = const of the walls, spaced by the scallop, with points spaced by the chords.

Near a point of contact the ball leaves the surface by the quadratic form of A = 1/R - K. K is the shape operator
(n_i = -K r_i, hollow positive); direction 1 is along the pass and direction 2 across it. As the ball moves along the
pass, the least distance over all its positions remains at a distance y from the pass:

    z = 1/2 (A22 - A12^2 / A11) y^2 = 1/2 (det A / A11) y^2

Passes at a step s therefore leave the scallop h with s^2 = 8 h A11 / det A. For A12 = 0 this is
8 h / (1/R - k22) = 8 h R rho / (rho +- R): + for a surface that is convex across the pass, - for a hollow surface.

Between two points the ball moves along a chord, which differs from the true path of its centre by the sag e. If the
chord is nearer to the surface than this path, e . n < 0, both ends are lifted by the sag. This leaves more material and
never gouges.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.curvature import shape_operator
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.corners import InnerCorner, WallParts, wall_parts
from gearmesh.toolpath.order import Budget, PathOrder
from gearmesh.toolpath.space import CutSpace, SpaceFrames

#: lines across a wall at which the step is computed
STEP_LINES = 65
#: stations at which the step is computed
STEP_STATIONS = 33
#: chords along the face before the refinement
INITIAL_CHORDS = 8
#: rounds of the refinement of chords
REFINING_ROUNDS = 8
#: limit of the chords along the face
MAX_CHORDS = 4000
#: smallest curvature between ball and surface, relative to the ball's, so that steps stay finite
MIN_RELATIVE_CURVATURE = 1e-3
#: limit of the passes of all walls
MAX_PASSES = 20_000
#: limit of the ball's positions in one space; more take minutes and exhaust the memory
MAX_POSITIONS = 1_000_000
#: distance below which passes of neighbouring walls are the same
MIN_PASS_DISTANCE_MM = 1e-6


@dataclass(frozen=True)
class Passes:
    """P passes of N points each, at the stations of `sections`."""

    #: sections of the tooth at the N stations
    sections: Sections
    #: directions of the space at the stations
    frames: SpaceFrames
    #: contact points (P, N, 3) on the exact surface, mm
    contacts: Array
    #: unit normals (P, N, 3) there
    normals: Array
    #: centres (P, N, 3) of the ball, mm
    centres: Array
    #: side (P,) of the wall: -1, 0 or 1
    side: Array
    #: number (P,) of the wall
    wall: NDArray[np.int64]
    #: position (P,) of the pass, as a share of its wall's `parts`
    line: Array
    #: distance of the ball's centre from the exact surface, without lifts, mm
    reach: float
    #: parts of the walls that the ball reaches
    parts: WallParts = field(default_factory=WallParts)

    @property
    def step_over(self) -> tuple[float, float]:
        """Smallest and largest distance (mm) between neighbouring passes of a wall, at the surface.

        Both are 0 if each wall has only one pass.
        """
        same = self.wall[1:] == self.wall[:-1]
        if not same.any():
            return 0.0, 0.0
        way = np.diff(self.contacts, axis=0)[same]
        along = unit(np.gradient(self.contacts, axis=1))[:-1][same]
        away = np.sqrt(np.maximum(dot(way, way) - dot(way, along) ** 2, 0.0)).max(axis=1)
        return float(away.min()), float(away.max())


def plan_passes(
    space: CutSpace,
    walls: Sequence[int],
    ball: BallCutter,
    order: PathOrder,
    budget: Budget,
    denser: Array,
    corners: Sequence[InnerCorner] = (),
) -> Passes:
    """Return the passes of some walls; they end where the ball touches both walls of a corner.

    `denser` (W,) is the factor by which the passes of each wall are closer than the scallop requires. Raises
    NoSolutionError for too many passes, and where `wall_parts` does.
    """
    within = wall_parts(space, corners, ball.radius + order.stock)
    sections = space.tooth.sections(np.linspace(0.0, 1.0, STEP_STATIONS))
    lines = {}
    for k in walls:
        s = np.linspace(0.0, 1.0, STEP_LINES)
        jet = space.walls[k].jet(within.s(k, s, sections), sections, order.stock)
        per_unit = denser[k] * _passes_per_unit(jet, s, ball.radius, budget.scallop)
        lines[k] = _evenly(s, per_unit)
    if sum(map(len, lines.values())) > MAX_PASSES:
        raise NoSolutionError(
            reason=f"the scallop takes more than {MAX_PASSES} passes", remedy="allow a larger scallop or a larger ball"
        )
    return _with_points(space, lines, within, ball, order.stock, budget.chord)


def _passes_per_unit(jet: Jet, s: Array, radius: float, scallop: float) -> Array:
    """Return the number of passes (S,) per unit of s, at the station that needs most."""
    feed = unit(_tangent(np.gradient(jet.r, axis=1), jet.n))
    across = cross(jet.n, feed)
    k = shape_operator(jet, feed, across)
    # A = 1/R - K, and det A / A11 for the height left beside a pass
    a11, a22, a12 = (1.0 / radius - k[..., 0, 0], 1.0 / radius - k[..., 1, 1], -k[..., 0, 1])
    smallest = MIN_RELATIVE_CURVATURE / radius
    remaining = np.maximum(a22 - a12**2 / np.maximum(a11, smallest), smallest)
    distance = np.abs(dot(np.gradient(jet.r, s, axis=0), across))
    needed: Array = np.nanmax(distance * np.sqrt(remaining / (8.0 * scallop)), axis=1)
    return needed


def _tangent(vectors: Array, normals: Array) -> Array:
    """Return the part of vectors (..., 3) at right angles to unit normals (..., 3)."""
    return vectors - dot(vectors, normals)[..., None] * normals


def _evenly(s: Array, per_unit: Array) -> Array:
    """Return lines from 0 to 1 that divide the integral of `per_unit` evenly; their number is rounded up."""
    total = np.concatenate(([0.0], np.cumsum(0.5 * (per_unit[1:] + per_unit[:-1]) * np.diff(s))))
    count = max(1, int(np.ceil(total[-1])))
    if total[-1] <= 0.0:
        return np.array([0.0, 1.0])
    return np.interp(np.linspace(0.0, total[-1], count + 1), total, s)


def _with_points(
    space: CutSpace, lines: dict[int, Array], within: WallParts, ball: BallCutter, stock: float, chord: float
) -> Passes:
    """Return the passes over stations at which every chord is within its tolerance."""
    fixed = np.unique(np.concatenate(([0.0, 1.0], space.tooth.breaks)))
    t = np.unique(np.concatenate((np.linspace(0.0, 1.0, INITIAL_CHORDS + 1), fixed)))
    # refine the stations until the sag at the middle of every chord is within the tolerance
    for _ in range(REFINING_ROUNDS):
        if t.size * sum(map(len, lines.values())) > MAX_POSITIONS:
            raise NoSolutionError(
                reason=f"the scallop takes more than {MAX_POSITIONS} positions of the ball in a space",
                remedy="allow a larger scallop or a larger ball",
            )
        sections = space.tooth.sections(_with_middles(t))
        contacts, normals = _points(space, lines, within, sections)
        centres = contacts + (ball.radius + stock) * normals
        sag = _sag(centres)
        worst = np.sqrt(dot(sag, sag)).max(axis=0)
        if (worst <= chord).all() or t.size > MAX_CHORDS:
            break
        t = _finer(t, np.sqrt(np.maximum(worst, 1e-3 * worst.max()) / chord), fixed)
    if (worst > chord).any():
        raise NoSolutionError(
            reason=f"the tolerance of the chords, {1e3 * chord:.3g} um, takes more than {MAX_CHORDS} points a pass",
            remedy="allow a larger tolerance or scallop",
        )
    # lift both ends of each chord that is nearer to the surface than the true path
    nearer = np.maximum(-dot(sag, normals[:, 1::2]), 0.0)
    lift = np.pad(nearer, ((0, 0), (1, 0))), np.pad(nearer, ((0, 0), (0, 1)))
    ends = sections[::2]
    lifted = centres[:, ::2] + np.maximum(*lift)[..., None] * normals[:, ::2]
    number = np.concatenate([np.full(len(s), k) for k, s in lines.items()])
    side = np.array([space.walls[k].side for k in number])
    made = Passes(
        ends,
        space.frames(ends),
        contacts[:, ::2],
        normals[:, ::2],
        lifted,
        side,
        number,
        np.concatenate(list(lines.values())),
        ball.radius + stock,
        within,
    )
    return _without_twins(made)


def _with_middles(t: Array) -> Array:
    """Return stations t (T,) with their middles, (2 T - 1,)."""
    fine = np.empty(2 * t.size - 1)
    fine[::2], fine[1::2] = t, 0.5 * (t[1:] + t[:-1])
    return fine


def _points(space: CutSpace, lines: dict[int, Array], within: WallParts, sections: Sections) -> tuple[Array, Array]:
    """Return points and normals (P, T, 3) of the exact surface on lines of several walls."""
    jets = [space.walls[k].jet(within.s(k, s, sections), sections) for k, s in lines.items()]
    return np.concatenate([jet.r for jet in jets]), np.concatenate([jet.n for jet in jets])


def _sag(centres: Array) -> Array:
    """Return vectors (P, N-1, 3) from the path of the ball's centre to its chords.

    The path is given at 2N-1 stations, (P, 2N-1, 3).
    """
    start, middle, end = centres[:, :-2:2], centres[:, 1::2], centres[:, 2::2]
    chord, away = end - start, middle - start
    length = dot(chord, chord)
    share = np.divide(dot(chord, away), length, out=np.zeros_like(length), where=length > 0.0)
    return np.asarray(share[..., None] * chord - away)


def _finer(t: Array, per_chord: Array, fixed: Array) -> Array:
    """Return stations with about `per_chord` (N-1,) new chords in each old chord; `fixed` stations are kept."""
    total = np.concatenate(([0.0], np.cumsum(1.05 * np.maximum(per_chord, 1e-3))))
    at = np.interp(fixed, t, total)
    cells = np.maximum(1, np.ceil(np.diff(at)).astype(int))
    parts = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(at[:-1], at[1:], cells, strict=True)]
    made = np.interp(np.append(np.concatenate(parts), total[-1]), total, t)
    return np.unique(np.concatenate((made, fixed)))


def _without_twins(passes: Passes) -> Passes:
    """Return the passes without the first pass of a wall if it equals the last pass of the wall before."""
    apart = np.diff(passes.centres, axis=0)
    keep = np.append(True, np.sqrt(dot(apart, apart)).max(axis=1) > MIN_PASS_DISTANCE_MM)
    fields = ("contacts", "normals", "centres", "side", "wall", "line")
    return replace(passes, **{name: getattr(passes, name)[keep] for name in fields})
