"""The space before the tooth on +x: the walls between the tips of the tooth before and of this one, and all that is beside it.

Going round the axis counterclockwise (seen from +z) at a fixed station the walls are

    flank_left, fillet_left (of the tooth before) | root | fillet_right, flank_right

s in [0, 1] runs along each of them in this direction and t from toe to heel, as along the links of a tooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLETS, FLANKS, Region, Side
from gearmesh.teeth.section import Link, Sections
from gearmesh.teeth.tooth import Tooth

#: points across a link and along the face that stand for the two teeth beside the space, and for all others; fewest along the
#: face for each depth of the space that a tooth is long, and most
NEAR, FAR = (9, 33), (5, 33)
A_DEPTH, MOST = 4.0, 401
#: least rise of the middle between the tips over the root, as a share of its distance, and stations at which it is looked at
LEAST_RISE, LOOKED_AT = 0.5, 5
#: points of an edge by which its length is measured
EDGE = 65


@dataclass(frozen=True)
class SpaceWall:
    """One surface of the space, a link of a tooth's section taken to its `place`."""

    link: Link
    place: Rigid

    @property
    def region(self) -> Region:
        return self.link.region

    @property
    def side(self) -> int:
        """-1 left of the middle of the space (flank and fillet of the tooth before), 0 the root, 1 right of it."""
        return self.region.side.sign if self.region.side else 0

    def jet(self, s: Array, sections: Sections, stock: float = 0.0) -> Jet:
        """Jets (S, T) at s (S,) or (S, T) of the surface moved by `stock` (mm) along its normals."""
        jet = self.link.grid(s, sections).jet
        assert jet is not None
        return jet.parallel(stock).move(self.place)


@dataclass(frozen=True)
class SpaceFrames:
    """Directions in the space at T stations, (T, 3) each: `feed` along it from toe to heel, `opening` out of it between the tips,
    and `across` it towards its right wall."""

    feed: Array
    opening: Array
    across: Array

    def at(self, station: int) -> SpaceFrames:
        """Directions at one of the stations."""
        return SpaceFrames(*(of[station : station + 1] for of in (self.feed, self.opening, self.across)))

    def axis(self, lead: Array, tilt: Array, side: Array) -> Array:
        """Unit tool axes (..., T, 3) from the ball to the shank for angles (..., rad): `tilt` from the opening away from the
        wall on a side (...,), `lead` towards the heel."""
        out, sideways = np.cos(lead) * np.cos(tilt), -np.where(side == 0, 1.0, side) * np.cos(lead) * np.sin(tilt)
        parts = ((out, self.opening), (sideways, self.across), (np.sin(lead), self.feed))
        return np.asarray(sum(np.asarray(share)[..., None, None] * direction for share, direction in parts))


@dataclass(frozen=True)
class CutSpace:
    """The space before the tooth on +x of a member all of whose teeth are alike; raises DesignError for others."""

    member: Member

    @cached_property
    def tooth(self) -> Tooth:
        return self.member.one_tooth

    @cached_property
    def walls(self) -> tuple[SpaceWall, ...]:
        """All walls in order."""
        chain, own = self.tooth.chain, Rigid.identity()
        before = self.tooth.joint.to(-self.tooth.pitch_angle)
        left, right = ((FLANKS[side], FILLETS[side]) for side in (Side.LEFT, Side.RIGHT))
        return (
            *(SpaceWall(chain[region], before) for region in left),
            SpaceWall(chain[Region.ROOT], own),
            *(SpaceWall(chain[region], own) for region in right[::-1]),
        )

    def frames(self, sections: Sections) -> SpaceFrames:
        """Directions at its stations (T,), two or more."""
        ends, middle = np.array([0.0, 1.0]), np.array([0.5])
        left, right = (self.walls[k].jet(ends, sections).r[j] for k, j in ((0, 0), (-1, -1)))
        root = self.walls[2].jet(middle, sections).r[0]
        feed = unit(np.gradient(0.5 * (left + right), sections.stations, axis=0))
        opening = 0.5 * (left + right) - root
        opening = unit(opening - dot(opening, feed)[:, None] * feed)
        across = cross(feed, opening)
        return SpaceFrames(feed, opening, across * np.sign(dot(across, right - left))[:, None])

    def refuse_threads(self) -> None:
        """Raise NoSolutionError where the space winds so far round the axis that it does not open between its tips at a station."""
        sections = self.tooth.sections(np.linspace(0.0, 1.0, LOOKED_AT))
        left, right = (self.walls[k].jet(np.array([end]), sections).r[0] for k, end in ((0, 0.0), (-1, 1.0)))
        root = self.walls[2].jet(np.array([0.5]), sections)
        rise = dot(unit(0.5 * (left + right) - root.r[0]), root.n[0])
        if rise.min() < LEAST_RISE:
            raise NoSolutionError(
                reason="the thread winds too far round the axis: in a section across the axis, from which tool axes are "
                "taken, its space does not open between its tips",
                remedy="turn, mill or grind it as a thread",
            )

    @property
    def numbers(self) -> list[int]:
        """Numbers of all spaces of a row: of the tooth after each; a row that does not close has none before its first tooth."""
        joint, teeth = self.tooth.joint, self.tooth.teeth
        places: list[int] = joint.places(teeth).tolist()
        return places[0 if np.isfinite(joint.cycle(teeth)) else 1 :]

    def place(self, number: int) -> Rigid:
        """The motion to the space of a number."""
        return self.tooth.joint.to(number * self.tooth.pitch_angle)

    @property
    def depth(self) -> float:
        """Depth (mm) from the tips to the root."""
        return self.tooth.height

    @cached_property
    def length(self) -> float:
        """Length (mm) of the space along its longest edge, which is more than the face where teeth are helical."""
        sections = self.tooth.sections(np.linspace(0.0, 1.0, EDGE))
        edges = np.concatenate([wall.jet(np.array([0.0, 1.0]), sections).r for wall in self.walls])
        return float(np.linalg.norm(np.diff(edges, axis=1), axis=-1).sum(axis=-1).max())

    @cached_property
    def beside(self) -> Array:
        """Points (K, 3) of the two teeth beside the space, at NEAR."""
        grids = self._grids(*NEAR)
        before = self.tooth.joint.to(-self.tooth.pitch_angle)
        return np.concatenate(
            [place.point(grid).reshape(-1, 3) for grid in grids for place in (before, Rigid.identity())]
        )

    @cached_property
    def far(self) -> tuple[Array, float]:
        """Points (K, 3) of all other teeth of all rows, at FAR, and how far (mm) any other point of theirs is at most from one."""
        joint, teeth, pitch = self.tooth.joint, self.tooth.teeth, self.tooth.pitch_angle
        grids = self._grids(*FAR)
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
        """Points (across, along, 3) of all links of the tooth on +x."""
        count = max(along, min(MOST, int(np.ceil(A_DEPTH * self.length / self.depth))))
        s, sections = np.linspace(0.0, 1.0, across), self.tooth.sections(np.linspace(0.0, 1.0, count))
        return [self.tooth.grid(region, s, sections).points for region in self.tooth.regions]

    def beyond(self, s: Array, sections: Sections) -> Array:
        """Points (K, 3) of what is beside the walls: lands and tip edges of both teeth, s (S,)."""
        own = {wall.region for wall in self.walls}
        grids = [self.tooth.grid(region, s, sections) for region in self.tooth.regions if region not in own]
        places = [self.tooth.joint.to(-self.tooth.pitch_angle), Rigid.identity()]
        return np.concatenate([place.point(grid.points).reshape(-1, 3) for grid in grids for place in places])


def choose_walls(space: CutSpace, flank: str, surfaces: str) -> Sequence[int]:
    """Numbers of the walls that are finished: flanks with fillets and root, or flanks alone; of one side or of both."""
    numbers = {"left": (0, 1, 2), "right": (2, 3, 4), "both": (0, 1, 2, 3, 4)}[flank]
    return [k for k in numbers if surfaces == "all" or space.walls[k].region.is_flank]
