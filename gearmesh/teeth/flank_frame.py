"""Coordinates on a flank: length along the face, height from root to tip, mm.

The length is the tooth's station coordinate, the height the coordinate at right angles to it in the axial half plane:

         tip                       stations are     length           height
      .-----------.                planes           z                radius
    toe  flank   heel              cylinders        radius           along the axis
      '-----------'                cones            cone distance    at right angles to the pitch cone
         root                      of a rack        z                over its reference plane

Both count from the middle of the flank towards heel and tip, or as in drawings (`as_drawn`).
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.kept_by_tooth import KeptByTooth
from gearmesh.teeth.region import HEEL_END, TOE_END, Side
from gearmesh.teeth.tooth import Tooth

#: points of the outline along each edge
EDGE_POINTS = 41


@dataclass(frozen=True)
class FlankFrame:
    """The two coordinates of a flank, with their zero and their signs.

    Frame coordinate = sign (level value - zero). Level values are station coordinate and height, mm.
    """

    #: levels whose values are the station coordinate and the height
    levels: tuple[Level, Level]
    #: level values (2,) at which the frame coordinates are 0
    zero: Array
    #: +1 or -1 (2,) for each coordinate
    signs: Array
    #: level values (2,) at the middle of the flank
    middle: Array
    #: level values (2, EDGE_POINTS, 2) of root and tip, from toe to heel
    along: Array
    #: level values (EDGE_POINTS, 2, 2) of toe and heel, from root to tip
    up: Array

    @staticmethod
    def of(member: Member, side: Side) -> FlankFrame:
        """Return the frame of a member's flank; it counts from the middle to heel and tip. Frames of the last flanks are
        kept.

        `side`: the flank. Raises NoSolutionError where the flank cannot be trimmed.
        """
        return _KEPT_FRAMES.get(member.tooth, side, lambda: FlankFrame._of_tooth(member.tooth, side))

    @staticmethod
    def _of_tooth(tooth: Tooth, side: Side) -> FlankFrame:
        levels = (tooth.blank.axial, tooth.blank.across)
        steps, ends, thirds = np.linspace(0.0, 1.0, EDGE_POINTS), [0.0, 1.0], [0.0, 0.5, 1.0]
        way = slice(None, None, 1 if end_names(tooth.blank.axial) == (TOE_END, HEEL_END) else -1)
        cross, along, up = (
            _values(levels, grid.points[:, way])
            for grid in tooth.flank_grids(side, (thirds, thirds), (ends, steps), (steps, ends))
        )
        signs = np.sign([cross[1, 2, 0] - cross[1, 0, 0], cross[2, 1, 1] - cross[0, 1, 1]])
        return FlankFrame(levels, cross[1, 1], signs, cross[1, 1], along, up)

    @property
    def as_drawn(self) -> FlankFrame:
        """The frame with z, radius and cone distance themselves; other heights count from the middle to the tip."""
        (across, up), (out, _) = (station_normal(level) for level in self.levels)
        if across == 0.0:
            return replace(self, zero=np.zeros(2), signs=np.array([up, out]))
        return replace(self, zero=np.array([0.0, self.middle[1]]), signs=np.array([1.0, self.signs[1]]))

    @cached_property
    def outline(self) -> Array:
        """Edges of the flank as a closed line (K, 2): root, heel, tip, toe."""
        edges = self.edges
        return np.concatenate((edges["root"], edges["heel"][1:], edges["tip"][-2::-1], edges["toe"][-2::-1]))

    @property
    def extent(self) -> Array:
        """Least and greatest length and height on the outline, (2, 2)."""
        return np.stack((self.outline.min(axis=0), self.outline.max(axis=0)))

    @cached_property
    def edges(self) -> dict[str, Array]:
        """Edges (EDGE_POINTS, 2) by name: root and tip run from toe to heel, toe and heel from root to tip."""
        along, up = (self.signs * (edges - self.zero) for edges in (self.along, self.up))
        return {"root": along[0], "tip": along[1], "toe": up[:, 0], "heel": up[:, 1]}

    @property
    def marks(self) -> dict[str, Array]:
        """Middles (2,) of the edges, by name."""
        return {name: edge[EDGE_POINTS // 2] for name, edge in self.edges.items()}

    @property
    def inverted(self) -> tuple[bool, bool]:
        """True for each coordinate that grows the other way: length to the toe, height to the root."""
        marks = self.marks
        return bool(marks["heel"][0] < marks["toe"][0]), bool(marks["tip"][1] < marks["root"][1])

    def places(self, points: Array) -> Array:
        """Return length and height of points of the flank.

        `points`: in the member's own frame, mm. Result: length along the face and height, mm.
        """
        return np.asarray(self.signs * (_values(self.levels, points) - self.zero))

    def shares(self, places: Array) -> Array:
        """Return places (..., 2), mm, as shares of the face from toe to heel and of the working height from root to tip.

        The working height is that of the usable flank, from its root limit to its tip edge. Inside the flank both
        shares are from 0 to 1.
        """
        length, height = places[..., 0], places[..., 1]
        toe, heel = (_along(self.edges[name][:, ::-1], height) for name in ("toe", "heel"))
        root, tip = (_along(self.edges[name], length) for name in ("root", "tip"))
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.stack(((length - toe) / (heel - toe), (height - root) / (tip - root)), axis=-1)

    def directions(self, points: Array, vectors: Array) -> Array:
        """Resolve vectors at points of the flank into length and height.

        `points`: in the member's own frame, mm.
        """
        parts = [dot(level.gradient(points), vectors) for level in self.levels]
        return np.asarray(self.signs * np.stack(parts, axis=-1))


#: frames of the last flanks
_KEPT_FRAMES = KeptByTooth[FlankFrame]()


def _along(edge: Array, at: Array) -> Array:
    """Return the second coordinate of an edge (K, 2) where its first coordinate is `at`; beyond its ends that of the end."""
    across, other = edge[np.argsort(edge[:, 0], kind="stable")].T
    return np.asarray(np.interp(at, across, other))


def _values(levels: tuple[Level, Level], points: Array) -> Array:
    """Return the values (..., 2) of both levels at points (..., 3)."""
    return np.stack([level.value(points) for level in levels], axis=-1)
