r"""Sharp inner corners between two walls of a space: which part of either wall a ball reaches, and what it leaves between.

             \    (c)    /                  the ball touches both walls, r R tan(phi / 2) from the corner, phi the angle between
              \   / \   /                   their normals; on the normals at the corner it leaves
               \ /   \ /
       wall k   `-- --'   wall k + 1            R (1 - sqrt(1 - tan^2(phi / 2)))
                   V

Where it touches both is solved on the surfaces: r_k(s, t) + R n_k = r_k+1(s', t') + R n_k+1 for s, s' and t' at given t. There the
passes of both walls end. Along the tooth a corner may turn into an outer edge (phi < 0), up to which the ball goes on either wall.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.space import CutSpace

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

#: normals (rad) that are no farther apart are one: a ball that touches one wall there cuts R angle^2 / 2 of the other
SMOOTH = 1e-3
#: stations at which corners are looked at
STATIONS = 33
#: Newton steps, the step of s and t of their differences, and the distance (mm) at which the ball touches both walls
STEPS, STEP, TOUCHES = 12, 1e-6, 1e-9
#: by how much farther from the corner passes end than where the ball touches both walls: what is interpolated between stations,
#: and extrapolated to the ends, is far less
MARGIN = 1.02
#: rounds in which the largest ball of a corner is found
REFINED = 4
#: least share of the stations with a corner at which the ball has to touch both walls within the face
FEWEST = 0.27


@dataclass(frozen=True)
class InnerCorner:
    """The corner between wall `before` and the next one of a space: angles (STATIONS,), rad, between their normals, negative where
    it is an outer edge."""

    before: int
    angles: Array

    @property
    def angle(self) -> float:
        """The largest angle, rad."""
        return float(self.angles.max())


def inner_corners(space: CutSpace, walls: Sequence[int]) -> tuple[InnerCorner, ...]:
    """The sharp inner corners between walls (neighbours in their order) of a space."""
    sections = space.tooth.sections(np.linspace(0.0, 1.0, STATIONS))
    made = []
    for k in walls:
        if k + 1 not in walls:
            continue
        last, first = (space.walls[j].jet(np.array(s), sections) for j, s in ((k, [1.0]), (k + 1, [0.0, 1e-3])))
        into = dot(first.r[1] - first.r[0], last.n[0]) > 0.0
        sine = np.linalg.norm(np.cross(last.n[0], first.n[0]), axis=-1)
        angles = np.where(into, 1.0, -1.0) * np.arctan2(sine, dot(last.n[0], first.n[0]))
        if angles.max() > SMOOTH:
            made.append(InnerCorner(k, angles))
    return tuple(made)


@dataclass(frozen=True)
class WallParts:
    """The part of every wall of a space that a ball reaches: s from `first` to `last`, splines over t, by the numbers of walls; all
    of a wall that they do not have."""

    first: Mapping[int, CubicSpline] = field(default_factory=dict)
    last: Mapping[int, CubicSpline] = field(default_factory=dict)

    def s(self, wall: int, share: Array, sections: Sections) -> Array:
        """s (S,) or, where a corner bounds the wall, (S, T), of shares (S,) of what is reached."""
        if wall not in self.first and wall not in self.last:
            return share
        low, high = (
            np.clip(ends[wall](sections.t), 0.0, 1.0) if wall in ends else np.full(sections.t.size, end)
            for ends, end in ((self.first, 0.0), (self.last, 1.0))
        )
        return np.asarray(low + share[:, None] * (high - low))


def largest_between(
    space: CutSpace, corners: Sequence[InnerCorner], most: float, stock: float, left: float
) -> tuple[float, InnerCorner | None]:
    """Radius (mm), stock included and at most `most`, of the largest ball that leaves no more than `left` (mm) in any corner, and
    the corner that limits it; None where none does."""
    limit = None
    for corner in corners:
        radius = most
        height = _left_between(space, corner, radius, stock)
        if height <= left:
            continue
        # what is left grows a little faster than the ball: of two radii on either side of the limit
        low, low_height = 0.0, 0.0
        for _ in range(REFINED):
            share = (left - low_height) / (height - low_height) if np.isfinite(height) else 0.5
            tried = low + share * (radius - low)
            own = _left_between(space, corner, tried, stock)
            if own <= left:
                low, low_height = tried, own
            else:
                radius, height = tried, own
        most, limit = low, corner
    return most, limit


def _left_between(space: CutSpace, corner: InnerCorner, radius: float, stock: float) -> float:
    """The most (mm) that passes `radius` (mm) from both walls, the last ones before a corner, leave in it over the stock; infinite
    where the ball does not reach into it."""
    if radius <= stock:
        return 0.0
    try:
        parts = wall_parts(space, [corner], radius)
    except NoSolutionError:
        return np.inf
    sections = space.tooth.sections(np.linspace(0.0, 1.0, STATIONS))
    ends = ((corner.before, 1.0), (corner.before + 1, 0.0))
    least = np.full((2, STATIONS), np.inf)
    at = [space.walls[k].jet(np.array([end]), sections) for k, end in ends]
    along = unit(np.gradient(at[0].r[0], sections.t, axis=0))
    for k, end in ends:
        jet = space.walls[k].jet(parts.s(k, np.array([end]), sections), sections)
        way = jet.r[0] + radius * jet.n[0] - at[0].r[0]
        way -= dot(way, along)[:, None] * along
        for own, height in zip(at, least, strict=True):
            rise = dot(way, own.n[0])
            inside = (radius - stock) ** 2 - (dot(way, way) - rise**2)
            np.minimum(height, np.where(inside > 0.0, rise - np.sqrt(np.maximum(inside, 0.0)), np.inf), out=height)
    return float(least[:, corner.angles > SMOOTH].max()) - stock


def wall_parts(space: CutSpace, corners: Sequence[InnerCorner], radius: float) -> WallParts:
    """What a ball whose centre is `radius` (mm) from the walls reaches beside their corners.

    Raises NoSolutionError where it does not touch both walls of a corner, or nothing of a wall.
    """
    from scipy.interpolate import CubicSpline

    first: dict[int, CubicSpline] = {}
    last: dict[int, CubicSpline] = {}
    for corner in corners:
        t, s = _contacts(space, corner, radius)
        for ends, wall, end, own in ((last, corner.before, 1.0, s[0]), (first, corner.before + 1, 0.0, s[1])):
            ends[wall] = CubicSpline(t, end + MARGIN * (own - end))
    made, sections = WallParts(first, last), space.tooth.sections(np.linspace(0.0, 1.0, STATIONS))
    for wall in {*first, *last}:
        s = made.s(wall, np.array([0.0, 1.0]), sections)
        if (s[0] >= s[1]).any():
            raise _too_large(space, wall, radius)
    return made


def _contacts(space: CutSpace, corner: InnerCorner, radius: float) -> tuple[Array, Array]:
    """t (T,) and s (2, T) on both walls at which a ball touches both, without stations where it touches one beyond the face; beyond
    the corner, s > 1 and s < 0, where it is an outer edge."""
    before, after = (space.walls[k] for k in (corner.before, corner.before + 1))
    t = np.linspace(0.0, 1.0, STATIONS)
    sections = space.tooth.sections(t)
    away = radius * np.tan(0.5 * corner.angles)
    widths = [
        np.linalg.norm(np.diff(wall.jet(np.array([end, end + step]), sections).r, axis=0)[0], axis=-1) / abs(step)
        for wall, end, step in ((before, 1.0, -1e-3), (after, 0.0, 1e-3))
    ]
    ends = np.stack((1.0 - away / widths[0], away / widths[1]))
    inner = np.flatnonzero(corner.angles > SMOOTH)
    own = sections[inner]
    x = np.clip(np.concatenate((ends[:, inner], t[None, inner])), 0.0, 1.0)

    def apart(x: Array) -> Array:
        """Vectors (T, 3) between the centres over both walls."""
        one = before.jet(x[0][None], own)
        other = after.jet(x[1][None], space.tooth.sections(x[2]))
        return np.asarray((one.r + radius * one.n - other.r - radius * other.n)[0])

    for _ in range(STEPS):
        miss = apart(x)
        if np.abs(miss).max() < TOUCHES:
            break
        slopes = []
        for k in range(3):
            # into the face, where there is something
            step = np.where(x[k] > 0.5, -STEP, STEP)
            moved = x.copy()
            moved[k] += step
            slopes.append((apart(moved) - miss) / step[:, None])
        x = np.clip(x - np.linalg.solve(np.stack(slopes, axis=-1), miss[..., None])[..., 0].T, 0.0, 1.0)
    good = np.linalg.norm(apart(x), axis=-1) < 1e3 * TOUCHES
    if good.mean() < FEWEST:
        raise _too_large(space, corner.before, radius)
    ends[:, inner] = x[:2]
    used = np.delete(np.arange(STATIONS), inner[~good])
    return t[used], ends[:, used]


def _too_large(space: CutSpace, wall: int, radius: float) -> NoSolutionError:
    name = str(space.walls[wall].region).replace("_", " ")
    return NoSolutionError(
        "tool",
        f"ball:{2.0 * radius:g}",
        reason=f"the ball does not reach into the sharp inner corner beside the {name}",
        remedy="choose a smaller ball",
    )
