"""The space before the tooth on +x: its walls between the tips of both teeth, and the surfaces beside it.

At a fixed station the walls, counterclockwise about the axis (seen from +z), are

    flank_left, fillet_left (of the previous tooth) | root | fillet_right, flank_right

s in [0, 1] runs along each wall in this direction, and t from toe to heel, as on the links of a tooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Region, Side
from gearmesh.teeth.section import Link, Sections
from gearmesh.teeth.tooth import Tooth

#: points across a link and along the face that represent the two teeth beside the space
NEAR_TEETH_GRID = (9, 33)
#: points across a link and along the face that represent all other teeth
FAR_TEETH_GRID = (5, 33)
#: smallest number of points along the face per depth of the space
MIN_POINTS_PER_DEPTH = 4.0
#: limit of the points along the face
MAX_POINTS_ALONG = 401
#: smallest cosine between the normal of the root and the direction to the middle between the tips
MIN_OPENING_COSINE = 0.5
#: stations at which this cosine is examined
OPENING_STATIONS = 5
#: points of an edge by which its length is measured
POINTS_PER_EDGE = 65


@dataclass(frozen=True)
class SpaceWall:
    """One surface of the space: a link of a tooth's section moved to its `place`."""

    link: Link
    place: Rigid

    @property
    def region(self) -> Region:
        return self.link.region

    @property
    def side(self) -> int:
        """-1 left of the middle (flank and fillet of the previous tooth), 0 for the root, 1 right of the middle."""
        return self.region.side.sign if self.region.side else 0

    def jet(self, s: Array, sections: Sections, stock: float = 0.0) -> Jet:
        """Return jets (S, T) at s (S,) or (S, T) of the surface moved by `stock` (mm) along its normals."""
        jet = self.link.grid(s, sections).jet
        assert jet is not None
        return jet.parallel(stock).move(self.place)


@dataclass(frozen=True)
class SpaceFrames:
    """Directions in the space at T stations, unit vectors (T, 3) each."""

    #: along the space, from toe to heel
    feed: Array
    #: out of the space, between the tips
    opening: Array
    #: across the space, towards its right wall
    across: Array

    def at(self, station: int) -> SpaceFrames:
        """Return the directions at one of the stations."""
        return SpaceFrames(*(of[station : station + 1] for of in (self.feed, self.opening, self.across)))

    def axis(self, lead: Array, tilt: Array, side: Array) -> Array:
        """Return unit tool axes (..., T, 3) from the ball to the shank for angles (...,), rad.

        `tilt` leans from the opening away from the wall on a side (...,); `lead` leans towards the heel.
        """
        out, sideways = np.cos(lead) * np.cos(tilt), -np.where(side == 0, 1.0, side) * np.cos(lead) * np.sin(tilt)
        parts = ((out, self.opening), (sideways, self.across), (np.sin(lead), self.feed))
        return np.asarray(sum(np.asarray(share)[..., None, None] * direction for share, direction in parts))


@dataclass(frozen=True)
class CutSpace:
    """The space before the tooth on +x of a member with equal teeth; raises DesignError for unequal teeth."""

    member: Member

    @cached_property
    def tooth(self) -> Tooth:
        return self.member.one_tooth

    @cached_property
    def walls(self) -> tuple[SpaceWall, ...]:
        """All walls in order."""
        chain, unmoved = self.tooth.chain, Rigid.identity()
        to_previous = self.tooth.joint.to(-self.tooth.pitch_angle)
        left, right = ((FLANK_REGIONS[side], FILLET_REGIONS[side]) for side in (Side.LEFT, Side.RIGHT))
        return (
            *(SpaceWall(chain[region], to_previous) for region in left),
            SpaceWall(chain[Region.ROOT], unmoved),
            *(SpaceWall(chain[region], unmoved) for region in right[::-1]),
        )

    def frames(self, sections: Sections) -> SpaceFrames:
        """Return the directions at the stations (T,) of two or more sections."""
        ends, middle = np.array([0.0, 1.0]), np.array([0.5])
        left, right = (self.walls[k].jet(ends, sections).r[j] for k, j in ((0, 0), (-1, -1)))
        root = self.walls[2].jet(middle, sections).r[0]
        feed = unit(np.gradient(0.5 * (left + right), sections.stations, axis=0))
        opening = 0.5 * (left + right) - root
        opening = unit(opening - dot(opening, feed)[:, None] * feed)
        across = cross(feed, opening)
        return SpaceFrames(feed, opening, across * np.sign(dot(across, right - left))[:, None])

    def refuse_threads(self) -> None:
        """Raise NoSolutionError for a thread whose space does not open between its tips across the axis."""
        sections = self.tooth.sections(np.linspace(0.0, 1.0, OPENING_STATIONS))
        left, right = (self.walls[k].jet(np.array([end]), sections).r[0] for k, end in ((0, 0.0), (-1, 1.0)))
        root = self.walls[2].jet(np.array([0.5]), sections)
        rise = dot(unit(0.5 * (left + right) - root.r[0]), root.n[0])
        if rise.min() < MIN_OPENING_COSINE:
            raise NoSolutionError(
                reason="the thread winds too far round the axis: in a section across the axis, from which tool axes "
                "are taken, its space does not open between its tips",
                remedy="turn, mill or grind it as a thread",
            )

    @property
    def numbers(self) -> list[int]:
        """Numbers of all spaces of a row: each has the number of the tooth after it.

        A row that does not close has no space before its first tooth.
        """
        joint, teeth = self.tooth.joint, self.tooth.teeth
        places: list[int] = joint.places(teeth).tolist()
        return places[0 if np.isfinite(joint.cycle(teeth)) else 1 :]

    def place(self, number: int) -> Rigid:
        """Return the motion from the space before tooth 0 to the space of a number."""
        return self.tooth.joint.to(number * self.tooth.pitch_angle)

    @property
    def depth(self) -> float:
        """Depth (mm) from the tips to the root."""
        return self.tooth.height

    @cached_property
    def length(self) -> float:
        """Length (mm) of the longest edge of the space, which is longer than the face for helical teeth."""
        sections = self.tooth.sections(np.linspace(0.0, 1.0, POINTS_PER_EDGE))
        edges = np.concatenate([wall.jet(np.array([0.0, 1.0]), sections).r for wall in self.walls])
        return float(np.linalg.norm(np.diff(edges, axis=1), axis=-1).sum(axis=-1).max())

    @cached_property
    def beside(self) -> Array:
        """Points (K, 3) of the two teeth beside the space, on the grid NEAR_TEETH_GRID."""
        grids = self._grids(*NEAR_TEETH_GRID)
        before = self.tooth.joint.to(-self.tooth.pitch_angle)
        return np.concatenate(
            [place.point(grid).reshape(-1, 3) for grid in grids for place in (before, Rigid.identity())]
        )

    @cached_property
    def far(self) -> tuple[Array, float]:
        """Points (K, 3) of all other teeth of all rows, on the grid FAR_TEETH_GRID, with a distance (mm).

        No point of these surfaces is farther than this distance from its nearest grid point.
        """
        joint, teeth, pitch = self.tooth.joint, self.tooth.teeth, self.tooth.pitch_angle
        grids = self._grids(*FAR_TEETH_GRID)
        cloud = np.concatenate([grid.reshape(-1, 3) for grid in grids])
        places = joint.places(teeth).tolist()
        rows = [
            (row, [k for k in places if i or k not in (-1, 0, teeth - 1)]) for i, row in enumerate(self.member.halves)
        ]
        points = [row.points(joint.to(k * pitch).point(cloud)) for row, numbers in rows for k in numbers]
        across, along = (
            max(float(np.linalg.norm(np.diff(grid, axis=axis), axis=-1).max()) for grid in grids) for axis in (0, 1)
        )
        return np.concatenate(points) if points else np.empty((0, 3)), 0.5 * float(np.hypot(across, along))

    def _grids(self, across: int, along: int) -> list[Array]:
        """Return points (across, along, 3) of all links of the tooth on +x."""
        count = max(along, min(MAX_POINTS_ALONG, int(np.ceil(MIN_POINTS_PER_DEPTH * self.length / self.depth))))
        s, sections = np.linspace(0.0, 1.0, across), self.tooth.sections(np.linspace(0.0, 1.0, count))
        return [self.tooth.grid(region, s, sections).points for region in self.tooth.regions]

    def beyond(self, s: Array, sections: Sections) -> Array:
        """Return points (K, 3) of the surfaces beside the walls at s (S,): lands and tip edges of both teeth."""
        wall_regions = {wall.region for wall in self.walls}
        grids = [self.tooth.grid(region, s, sections) for region in self.tooth.regions if region not in wall_regions]
        places = [self.tooth.joint.to(-self.tooth.pitch_angle), Rigid.identity()]
        return np.concatenate([place.point(grid.points).reshape(-1, 3) for grid in grids for place in places])


def choose_walls(space: CutSpace, flank: str, surfaces: str) -> Sequence[int]:
    """Return numbers of the finished walls: flanks with fillets and root, or flanks alone, on one side or on both."""
    numbers = {"left": (0, 1, 2), "right": (2, 3, 4), "both": (0, 1, 2, 3, 4)}[flank]
    return [k for k in numbers if surfaces == "all" or space.walls[k].region.is_flank]
