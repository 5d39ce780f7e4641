"""A flank laid into a plane, as makers of gears look at it: length along the face, height from root to tip, mm.

The length is the tooth's station coordinate, the height the coordinate at right angles to it in the axial half plane:

         tip                       stations are     length           height
      .-----------.                planes           z                radius
    toe  flank   heel              cylinders        radius           along the axis
      '-----------'                cones            cone distance    at right angles to the pitch cone
         root                      of a rack        z                over its reference plane

Radii and heights of a rack are as they are; other heights are counted from the middle of the flank towards the tip.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.levels import station_normal
from gearmesh.teeth.region import Side
from gearmesh.teeth.train import Member
from gearmesh.view.on_tooth import ellipses_on_surface, union_level
from gearmesh.view.projection import flank_projection
from gearmesh.view.scene import MemberContact, Project

#: exact points across and along a flank by which it is laid out
GRID = (41, 81)
#: the same for patterns
FINE_GRID = (121, 241)
#: points of a line of contact from which the area that lines sweep is made
LINE_POINTS = 41


@dataclass(frozen=True)
class FlankPlane:
    """One flank of a member, its trimmed edges, and what lies on it, as (length, height) in mm.

    `middle` is the height (mm) that counts as 0; `sense` tells which way length and height count, +1 as the levels of the blank.
    """

    member: Member
    side: Side
    middle: float
    sense: tuple[float, float]

    @staticmethod
    def of(member: Member, side: Side) -> FlankPlane:
        """The plane of a member's flank. Raises TrimError where the flank cannot be trimmed."""
        blank = member.tooth.blank
        across, up = station_normal(blank.axial)
        if across == 0.0:
            return FlankPlane(member, side, 0.0, (up, station_normal(blank.across)[0]))
        root, tip = blank.across.value(member.tooth.flank_grid(side, [0.0, 1.0], [0.5]).points[:, 0])
        return FlankPlane(member, side, 0.5 * float(root + tip), (1.0, float(np.sign(tip - root))))

    @property
    def labels(self) -> tuple[str, str]:
        """What length and height are, with their unit."""
        across, up = station_normal(self.member.tooth.blank.axial)
        if across == 0.0:
            turns = self.member.tooth.course.drift is None
            return "z (mm)", "radius (mm)" if turns else "height (mm)"
        return ("radius (mm)" if up == 0.0 else "cone distance (mm)"), "height (mm)"

    @property
    def inverted(self) -> tuple[bool, bool]:
        """Whether lengths have to grow leftwards, heights downwards, so that the toe is left and the tip on top."""
        marks = self.marks
        return bool(marks["heel"][0] < marks["toe"][0]), bool(marks["tip"][1] < marks["root"][1])

    def places(self, points: Array) -> Array:
        """(length, height) (..., 2), mm, of points (..., 3), own frame of the member, mm."""
        blank = self.member.tooth.blank
        return np.stack((blank.axial.value(points), blank.across.value(points) - self.middle), axis=-1) * self.sense

    def directions(self, points: Array, vectors: Array) -> Array:
        """(length, height) (..., 2) of vectors (..., 3) at points (..., 3), own frame."""
        blank = self.member.tooth.blank
        along = [dot(level.gradient(points), vectors) for level in (blank.axial, blank.across)]
        return np.stack(along, axis=-1) * self.sense

    def grid(self, count: tuple[int, int] = GRID) -> Array:
        """Exact points (I, J, 3) of the trimmed flank, own frame, from joint to tip and from toe to heel."""
        s, t = (np.linspace(0.0, 1.0, n) for n in count)
        return self.member.tooth.flank_grid(self.side, s, t).points

    @cached_property
    def outline(self) -> Array:
        """The edges of the flank as a closed line (K, 2): root, heel, tip, toe."""
        places = self._coarse
        return np.concatenate((places[0], places[1:, -1], places[-1, -2::-1], places[-2::-1, 0]))

    @cached_property
    def marks(self) -> dict[str, Array]:
        """Where the middles of the edges are, (2,), by what they are called: toe, heel, tip, root."""
        places = self._coarse
        i, j = (n // 2 for n in places.shape[:2])
        return {"toe": places[i, 0], "heel": places[i, -1], "tip": places[-1, j], "root": places[0, j]}

    def edge(self, name: str) -> Array:
        """The edge (K, 2) that is called tip or root, from toe to heel."""
        edge: Array = self._coarse[-1 if name == "tip" else 0]
        return edge

    @cached_property
    def _coarse(self) -> Array:
        return self.places(self.grid())

    @cached_property
    def _project(self) -> Project:
        return flank_projection(self.member, self.side)

    def ellipses(self, contact: MemberContact, chosen: NDArray[np.int64], rays: int = 97) -> Array:
        """Contact ellipses of positions `chosen` (E,), laid on the flank and cut off at its edges: closed lines (E, rays, 2)."""
        if not len(chosen):
            return np.empty((0, rays, 2))
        return self.places(ellipses_on_surface(contact, chosen, self._project, 0.0, rays, rings=2)[0][:, -1])

    def path(self, contact: MemberContact) -> Array:
        """The path of contact (P, 2); NaN where there is none or contact is along a line, of which no point counts."""
        where = self.places(contact.point)
        where[contact.along_lines] = np.nan
        return where

    def lines(self, contact: MemberContact) -> list[Array]:
        """Contact lines, each (K, 2)."""
        return [self.places(line) for line in contact.lines if line is not None]

    def pattern(self, contact: MemberContact, count: tuple[int, int] = FINE_GRID) -> tuple[Array, Array]:
        """Places (I, J, 2) of a grid over the flank, and there how far (I, J) outside of the pattern: at most 1 inside.

        The pattern is the area that the ellipses of all positions sweep.
        """
        grid = self.grid(count)
        return self.places(grid), union_level(contact, grid)

    def swept(self, contact: MemberContact) -> list[Array]:
        """The areas that contact lines sweep: strips of quadrilaterals (Q, 4, 2), one from each line to the next position's."""
        strips, before, last = [], None, -2
        share = np.linspace(0.0, 1.0, LINE_POINTS)
        for k, line in enumerate(contact.lines):
            if line is None or len(line) < 2:
                continue
            way = np.r_[0.0, np.linalg.norm(np.diff(line, axis=0), axis=-1).cumsum()]
            here = self.places(np.stack([np.interp(share * way[-1], way, column) for column in line.T], axis=-1))
            if before is not None and last == k - 1:
                if (np.abs(here - before) ** 2).sum() > (np.abs(here[::-1] - before) ** 2).sum():
                    here = here[::-1]
                strips.append(np.stack((before[:-1], before[1:], here[1:], here[:-1]), axis=1))
            before, last = here, k
        return strips
