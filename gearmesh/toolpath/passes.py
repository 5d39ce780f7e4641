r"""Passes along the tooth: lines s = const of the walls, as far apart as the scallop allows, with points as the chords allow.

Near a point of contact the ball leaves the surface by the quadratic form of A = 1/R - K, K the shape operator (n_i = -K r_i, hollow
positive), in the directions 1 along the pass and 2 across it. As the ball goes along the pass the least over all its places
is left,

    z = 1/2 (A22 - A12^2 / A11) y^2 = 1/2 (det A / A11) y^2

at a distance y from the pass, so that passes a step s apart leave the scallop h with s^2 = 8 h A11 / det A; where A12 = 0 this is
8 h / (1/R - k22) = 8 h R rho / (rho +- R), + where the surface is convex across the pass, - where it is hollow.

Between two points the ball goes along a chord, which is beside the true path of its centre by the sag e. Where the chord is nearer
to the surface than that path, e . n < 0, both ends are lifted by as much, so that what is left grows and nothing is gouged.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.curvature import shape_operator
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.corners import InnerCorner, WallParts, wall_parts
from gearmesh.toolpath.space import CutSpace, SpaceFrames

#: lines across a wall, and stations, at which the step is asked
LINES, STATIONS = 65, 33
#: chords along the face at first, rounds in which they are refined, and the most there may be
CHORDS, ROUNDS, MOST_CHORDS = 8, 8, 4000
#: least share of the curvature of the ball that is left between it and the surface, so that steps stay finite
LEAST = 1e-3
#: most passes of a wall
MOST_PASSES = 20_000
#: most positions of the ball in one space: more take minutes, and more memory than there is
MOST_POSITIONS = 1_000_000
#: distance (mm) below which passes of neighbouring walls are one
SAME = 1e-6


@dataclass(frozen=True)
class Budget:
    """What may be left, mm: `scallop` between passes and `chord` along them."""

    scallop: float
    chord: float


@dataclass(frozen=True)
class Passes:
    """P passes of N points at the stations of `sections`: contact points on the exact surface, normals, ball centres, (P, N, 3) in
    mm; `side` (P,) -1, 0 or 1 and `wall` (P,), the number of the wall, and `line` (P,), the share of its wall's `parts`;
    directions of the space at the stations; `reach` (mm) of the ball's centre from the exact surface, where it is not lifted."""

    sections: Sections
    frames: SpaceFrames
    contacts: Array
    normals: Array
    centres: Array
    side: Array
    wall: NDArray[np.int64]
    line: Array
    reach: float
    parts: WallParts = field(default_factory=WallParts)

    @property
    def step_over(self) -> tuple[float, float]:
        """Least and largest distance (mm) between neighbouring passes of a wall, at the surface; 0 where there is one alone."""
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
    stock: float,
    budget: Budget,
    denser: Array,
    corners: Sequence[InnerCorner] = (),
) -> Passes:
    """Passes of some walls, which end where the ball touches both walls of a corner.

    `denser` (W,): by what factor the passes of each wall of the space are closer than planned. Raises NoSolutionError
    where there would be too many, and as `wall_parts`.
    """
    within = wall_parts(space, corners, ball.radius + stock)
    sections = space.tooth.sections(np.linspace(0.0, 1.0, STATIONS))
    lines = {}
    for k in walls:
        s = np.linspace(0.0, 1.0, LINES)
        jet = space.walls[k].jet(within.s(k, s, sections), sections, stock)
        per_unit = denser[k] * _passes_per_unit(jet, s, ball.radius, budget.scallop)
        lines[k] = _evenly(s, per_unit)
    if sum(map(len, lines.values())) > MOST_PASSES:
        raise NoSolutionError(
            reason=f"the scallop takes more than {MOST_PASSES} passes", remedy="allow a larger scallop or a larger ball"
        )
    return _with_points(space, lines, within, ball, stock, budget.chord)


def _passes_per_unit(jet: Jet, s: Array, radius: float, scallop: float) -> Array:
    """Passes (S,) per unit of s that a wall needs where it needs most along the face."""
    feed = unit(_tangent(np.gradient(jet.r, axis=1), jet.n))
    across = cross(jet.n, feed)
    k = shape_operator(jet, feed, across)
    a11, a22, a12 = (1.0 / radius - k[..., 0, 0], 1.0 / radius - k[..., 1, 1], -k[..., 0, 1])
    least = LEAST / radius
    left = np.maximum(a22 - a12**2 / np.maximum(a11, least), least)
    distance = np.abs(dot(np.gradient(jet.r, s, axis=0), across))
    needed: Array = np.nanmax(distance * np.sqrt(left / (8.0 * scallop)), axis=1)
    return needed


def _tangent(vectors: Array, normals: Array) -> Array:
    return vectors - dot(vectors, normals)[..., None] * normals


def _evenly(s: Array, per_unit: Array) -> Array:
    """Lines from 0 to 1, evenly over the integral of their number, which is rounded up."""
    total = np.concatenate(([0.0], np.cumsum(0.5 * (per_unit[1:] + per_unit[:-1]) * np.diff(s))))
    count = max(1, int(np.ceil(total[-1])))
    if total[-1] <= 0.0:
        return np.array([0.0, 1.0])
    return np.interp(np.linspace(0.0, total[-1], count + 1), total, s)


def _with_points(
    space: CutSpace, lines: dict[int, Array], within: WallParts, ball: BallCutter, stock: float, chord: float
) -> Passes:
    """Stations at which every chord is within its tolerance, and the passes over them."""
    fixed = np.unique(np.concatenate(([0.0, 1.0], space.tooth.breaks)))
    t = np.unique(np.concatenate((np.linspace(0.0, 1.0, CHORDS + 1), fixed)))
    for _ in range(ROUNDS):
        if t.size * sum(map(len, lines.values())) > MOST_POSITIONS:
            raise NoSolutionError(
                reason=f"the scallop takes more than {MOST_POSITIONS} positions of the ball in a space",
                remedy="allow a larger scallop or a larger ball",
            )
        sections = space.tooth.sections(_with_middles(t))
        contacts, normals = _points(space, lines, within, sections)
        centres = contacts + (ball.radius + stock) * normals
        sag = _sag(centres)
        worst = np.sqrt(dot(sag, sag)).max(axis=0)
        if (worst <= chord).all() or t.size > MOST_CHORDS:
            break
        t = _finer(t, np.sqrt(np.maximum(worst, 1e-3 * worst.max()) / chord), fixed)
    if (worst > chord).any():
        raise NoSolutionError(
            reason=f"the tolerance of the chords, {1e3 * chord:.3g} um, takes more than {MOST_CHORDS} points a pass",
            remedy="allow a larger tolerance or scallop",
        )
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
    fine = np.empty(2 * t.size - 1)
    fine[::2], fine[1::2] = t, 0.5 * (t[1:] + t[:-1])
    return fine


def _points(space: CutSpace, lines: dict[int, Array], within: WallParts, sections: Sections) -> tuple[Array, Array]:
    """Points and normals (P, T, 3) of the exact surface on lines of several walls."""
    jets = [space.walls[k].jet(within.s(k, s, sections), sections) for k, s in lines.items()]
    return np.concatenate([jet.r for jet in jets]), np.concatenate([jet.n for jet in jets])


def _sag(centres: Array) -> Array:
    """Vectors (P, N-1, 3) from the path of the ball's centre, known at 2N-1 stations (P, 2N-1, 3), to its chords."""
    start, middle, end = centres[:, :-2:2], centres[:, 1::2], centres[:, 2::2]
    chord, away = end - start, middle - start
    length = dot(chord, chord)
    share = np.divide(dot(chord, away), length, out=np.zeros_like(length), where=length > 0.0)
    return np.asarray(share[..., None] * chord - away)


def _finer(t: Array, per_chord: Array, fixed: Array) -> Array:
    """Stations with about `per_chord` (N-1,) new chords in each old one, among them the fixed ones."""
    total = np.concatenate(([0.0], np.cumsum(1.05 * np.maximum(per_chord, 1e-3))))
    at = np.interp(fixed, t, total)
    cells = np.maximum(1, np.ceil(np.diff(at)).astype(int))
    parts = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(at[:-1], at[1:], cells, strict=True)]
    made = np.interp(np.append(np.concatenate(parts), total[-1]), total, t)
    return np.unique(np.concatenate((made, fixed)))


def _without_twins(passes: Passes) -> Passes:
    """Without the first pass of a wall where the last one of the wall before is the same."""
    apart = np.diff(passes.centres, axis=0)
    keep = np.append(True, np.sqrt(dot(apart, apart)).max(axis=1) > SAME)
    fields = ("contacts", "normals", "centres", "side", "wall", "line")
    return replace(passes, **{name: getattr(passes, name)[keep] for name in fields})
