r"""Sharp inner corners between two walls of a space: the part of either wall that a ball reaches, and the rest.

             \    (c)    /                  the ball touches both walls, r R tan(phi / 2) from the corner, phi the angle
              \   / \   /                   between their normals; along the normals at the corner it leaves
               \ /   \ /
       wall k   `-- --'   wall k + 1            R (1 - sqrt(1 - tan^2(phi / 2)))
                   V

The contact with both walls is solved on the surfaces: r_k(s, t) + R n_k = r_k+1(s', t') + R n_k+1 for s, s' and t' at
given t. The passes of both walls end there. Along the tooth a corner may turn into an outer edge (phi < 0); on both
walls the ball then goes up to the edge.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.records import dataclass
from gearmesh.teeth.section import Sections
from gearmesh.toolpath.space import CutSpace

if TYPE_CHECKING:
    from scipy.interpolate import CubicSpline

#: largest angle between normals of a smooth joint; a ball on one wall cuts R angle^2 / 2 of the other
MAX_SMOOTH_ANGLE_RAD = 1e-3
#: stations at which corners are examined
STATIONS_ALONG_FACE = 33
#: Newton steps to the contact with both walls
MAX_NEWTON_STEPS = 12
#: step of s and t in the differences of Newton's method
DIFFERENCE_STEP = 1e-6
#: distance between the two centres that counts as contact with both walls
CONTACT_TOLERANCE_MM = 1e-9
#: factor by which passes end farther from the corner than the contact with both walls. The error of interpolation
#: between stations, and of extrapolation to the ends, is far smaller
CORNER_CLEARANCE_FACTOR = 1.02
#: rounds of the search for the largest ball of a corner
REFINING_ROUNDS = 4
#: smallest share of the stations with a corner at which the ball must touch both walls within the face
MIN_CONTACT_SHARE = 0.27


@dataclass(frozen=True)
class InnerCorner:
    """The corner between wall `before` and the next wall of a space."""

    #: number of the wall before the corner
    before: int
    #: angles (STATIONS_ALONG_FACE,) between the normals, rad, negative at an outer edge
    angles: Array

    @property
    def angle(self) -> float:
        """The largest angle, rad."""
        return float(self.angles.max())


def inner_corners(space: CutSpace, walls: Sequence[int]) -> tuple[InnerCorner, ...]:
    """Return the sharp inner corners between those of the given walls that are neighbours in a space."""
    sections = space.tooth.sections(np.linspace(0.0, 1.0, STATIONS_ALONG_FACE))
    made = []
    for k in walls:
        if k + 1 not in walls:
            continue
        last, first = (space.walls[j].jet(np.array(s), sections) for j, s in ((k, [1.0]), (k + 1, [0.0, 1e-3])))
        # the corner is an inner corner if the next wall rises out of the material of this wall
        into = dot(first.r[1] - first.r[0], last.n[0]) > 0.0
        sine = np.linalg.norm(np.cross(last.n[0], first.n[0]), axis=-1)
        angles = np.where(into, 1.0, -1.0) * np.arctan2(sine, dot(last.n[0], first.n[0]))
        if angles.max() > MAX_SMOOTH_ANGLE_RAD:
            made.append(InnerCorner(k, angles))
    return tuple(made)


@dataclass(frozen=True)
class WallParts:
    """The part of every wall of a space that a ball reaches, as splines over t by wall numbers.

    A wall without a spline is reached up to its end.
    """

    #: first reached s of a wall
    first: Mapping[int, CubicSpline] = field(default_factory=dict)
    #: last reached s of a wall
    last: Mapping[int, CubicSpline] = field(default_factory=dict)

    def s(self, wall: int, share: Array, sections: Sections) -> Array:
        """Return s for shares (S,) of the reached part of a wall: (S,), or (S, T) if a corner bounds the wall."""
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
    """Return the radius (mm) of the largest ball that leaves at most `left` (mm) in any corner, and its corner.

    The radius includes the stock and is at most `most`. The corner is the one that limits the ball, or None.
    """
    limit = None
    for corner in corners:
        radius = most
        height = _left_between(space, corner, radius, stock)
        if height <= left:
            continue
        # the height left grows slightly faster than the radius: regula falsi between radii on either side of the limit
        low, low_height = 0.0, 0.0
        for _ in range(REFINING_ROUNDS):
            share = (left - low_height) / (height - low_height) if np.isfinite(height) else 0.5
            tried = low + share * (radius - low)
            tried_height = _left_between(space, corner, tried, stock)
            if tried_height <= left:
                low, low_height = tried, tried_height
            else:
                radius, height = tried, tried_height
        most, limit = low, corner
    return most, limit


def _left_between(space: CutSpace, corner: InnerCorner, radius: float, stock: float) -> float:
    """Return the largest height (mm) over the stock left in a corner by the last passes on both of its walls.

    The ball's centre is `radius` (mm) from the walls on these passes. The height is infinite if the ball does not reach
    into the corner.
    """
    if radius <= stock:
        return 0.0
    try:
        parts = wall_parts(space, [corner], radius)
    except NoSolutionError:
        return np.inf
    sections = space.tooth.sections(np.linspace(0.0, 1.0, STATIONS_ALONG_FACE))
    ends = ((corner.before, 1.0), (corner.before + 1, 0.0))
    lowest = np.full((2, STATIONS_ALONG_FACE), np.inf)
    at = [space.walls[k].jet(np.array([end]), sections) for k, end in ends]
    along = unit(np.gradient(at[0].r[0], sections.t, axis=0))
    # height along the normals at the corner at which the ball of either last pass begins
    for k, end in ends:
        jet = space.walls[k].jet(parts.s(k, np.array([end]), sections), sections)
        way = jet.r[0] + radius * jet.n[0] - at[0].r[0]
        way -= dot(way, along)[:, None] * along
        for corner_jet, height in zip(at, lowest, strict=True):
            rise = dot(way, corner_jet.n[0])
            inside = (radius - stock) ** 2 - (dot(way, way) - rise**2)
            np.minimum(height, np.where(inside > 0.0, rise - np.sqrt(np.maximum(inside, 0.0)), np.inf), out=height)
    return float(lowest[:, corner.angles > MAX_SMOOTH_ANGLE_RAD].max()) - stock


def wall_parts(space: CutSpace, corners: Sequence[InnerCorner], radius: float) -> WallParts:
    """Return the parts of the walls that a ball reaches beside the corners; its centre is `radius` (mm) from the walls.

    Raises NoSolutionError if the ball does not touch both walls of a corner, or reaches no part of a wall.
    """
    from scipy.interpolate import CubicSpline

    first: dict[int, CubicSpline] = {}
    last: dict[int, CubicSpline] = {}
    for corner in corners:
        t, s = _contacts(space, corner, radius)
        for ends, wall, end, contact in ((last, corner.before, 1.0, s[0]), (first, corner.before + 1, 0.0, s[1])):
            ends[wall] = CubicSpline(t, end + CORNER_CLEARANCE_FACTOR * (contact - end))
    made, sections = WallParts(first, last), space.tooth.sections(np.linspace(0.0, 1.0, STATIONS_ALONG_FACE))
    for wall in {*first, *last}:
        s = made.s(wall, np.array([0.0, 1.0]), sections)
        if (s[0] >= s[1]).any():
            raise _too_large(space, wall, radius)
    return made


def _contacts(space: CutSpace, corner: InnerCorner, radius: float) -> tuple[Array, Array]:
    """Return t (T,) and s (2, T) on both walls at which a ball touches both.

    Stations at which the ball touches one wall beyond the face are left out. At an outer edge s lies beyond the corner:
    s > 1 and s < 0.
    """
    before, after = (space.walls[k] for k in (corner.before, corner.before + 1))
    t = np.linspace(0.0, 1.0, STATIONS_ALONG_FACE)
    sections = space.tooth.sections(t)
    # start: contact of flat walls, at the distance R tan(phi / 2) from the corner
    away = radius * np.tan(0.5 * corner.angles)
    widths = [
        np.linalg.norm(np.diff(wall.jet(np.array([end, end + step]), sections).r, axis=0)[0], axis=-1) / abs(step)
        for wall, end, step in ((before, 1.0, -1e-3), (after, 0.0, 1e-3))
    ]
    ends = np.stack((1.0 - away / widths[0], away / widths[1]))
    inner = np.flatnonzero(corner.angles > MAX_SMOOTH_ANGLE_RAD)
    inner_sections = sections[inner]
    x = np.clip(np.concatenate((ends[:, inner], t[None, inner])), 0.0, 1.0)

    def apart(x: Array) -> Array:
        """Return vectors (T, 3) between the ball's centres over both walls."""
        before_jet = before.jet(x[0][None], inner_sections)
        after_jet = after.jet(x[1][None], space.tooth.sections(x[2]))
        return np.asarray((before_jet.r + radius * before_jet.n - after_jet.r - radius * after_jet.n)[0])

    # Newton's method for (s, s', t') with differences for the Jacobian
    for _ in range(MAX_NEWTON_STEPS):
        miss = apart(x)
        if np.abs(miss).max() < CONTACT_TOLERANCE_MM:
            break
        slopes = []
        for k in range(3):
            # the difference step points into the face, where the walls exist
            step = np.where(x[k] > 0.5, -DIFFERENCE_STEP, DIFFERENCE_STEP)
            moved = x.copy()
            moved[k] += step
            slopes.append((apart(moved) - miss) / step[:, None])
        x = np.clip(x - np.linalg.solve(np.stack(slopes, axis=-1), miss[..., None])[..., 0].T, 0.0, 1.0)
    good = np.linalg.norm(apart(x), axis=-1) < 1e3 * CONTACT_TOLERANCE_MM
    if good.mean() < MIN_CONTACT_SHARE:
        raise _too_large(space, corner.before, radius)
    # inner corners take the solution; stations without a solution are left out
    ends[:, inner] = x[:2]
    used = np.delete(np.arange(STATIONS_ALONG_FACE), inner[~good])
    return t[used], ends[:, used]


def _too_large(space: CutSpace, wall: int, radius: float) -> NoSolutionError:
    name = str(space.walls[wall].region).replace("_", " ")
    return NoSolutionError(
        "tool",
        f"ball:{2.0 * radius:g}",
        reason=f"the ball does not reach into the sharp inner corner beside the {name}",
        remedy="choose a smaller ball",
    )
