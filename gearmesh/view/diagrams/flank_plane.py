"""A flank laid into a plane, as makers of gears look at it, and what lies on it: path, ellipses, lines and pattern of contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.view.on_tooth import ellipses_on_surface, union_level
from gearmesh.view.projection import flank_projection
from gearmesh.view.scene import MemberContact, Project

#: exact points across and along a flank, by which a pattern is drawn
GRID = (121, 241)
#: points of a line of contact from which the area that lines sweep is made
LINE_POINTS = 41
#: part of a line's length by which the ends of the next one are away at most, if nothing but flank lies between them
APART = 0.5


@dataclass(frozen=True)
class FlankPlane:
    """One flank of a member with its coordinates, length along the face and height, mm, as drawings have them; patterns are drawn
    by `count` exact points across and along it."""

    member: Member
    side: Side
    frame: FlankFrame
    count: tuple[int, int] = GRID

    @staticmethod
    def of(member: Member, side: Side) -> FlankPlane:
        """The plane of a member's flank. Raises TrimError where the flank cannot be trimmed."""
        return FlankPlane(member, side, FlankFrame.of(member, side).as_drawn)

    @property
    def labels(self) -> tuple[str, str]:
        """What length and height are, with their unit."""
        across, up = station_normal(self.member.tooth.blank.axial)
        if across == 0.0:
            return "z (mm)", f"{self.member.tooth.joint.radius_name} (mm)"
        return ("radius (mm)" if up == 0.0 else "cone distance (mm)"), "height (mm)"

    @cached_property
    def grid(self) -> Array:
        """Exact points (I, J, 3) of the trimmed flank, own frame, from form point to tip and from toe to heel."""
        s, t = (np.linspace(0.0, 1.0, n) for n in self.count)
        return self.member.tooth.flank_grid(self.side, s, t).points

    @cached_property
    def _project(self) -> Project:
        return flank_projection(self.member, self.side)

    def ellipses(self, contact: MemberContact, chosen: NDArray[np.int64], rays: int = 97) -> Array:
        """Contact ellipses of positions `chosen` (E,), laid on the flank and cut off at its edges: closed lines (E, rays, 2)."""
        if not len(chosen):
            return np.empty((0, rays, 2))
        return self.frame.places(ellipses_on_surface(contact, chosen, self._project, 0.0, rays, rings=2)[0][:, -1])

    def path(self, contact: MemberContact) -> Array:
        """The path of contact (P, 2); NaN where there is none or contact is along a line, of which no point counts."""
        where = self.frame.places(contact.point)
        where[contact.along_lines] = np.nan
        return where

    def lines(self, contact: MemberContact) -> list[Array]:
        """Contact lines, each (K, 2)."""
        return [self.frame.places(line) for line in contact.lines if line is not None]

    def pattern(self, contact: MemberContact) -> tuple[Array, Array]:
        """Places (I, J, 2) of `grid`, and there how far (I, J) outside of the pattern: at most 1 inside.

        The pattern is the area that the ellipses of all positions sweep.
        """
        return self.frame.places(self.grid), union_level(contact, self.grid)

    def swept(self, contact: MemberContact) -> list[Array]:
        """The areas that contact lines sweep: strips of quadrilaterals (Q, 4, 2), one from each line to the next position's."""
        return strips([None if line is None else self.frame.places(line) for line in contact.lines])


def strips(lines: Sequence[Array | None]) -> list[Array]:
    """Strips of quadrilaterals (Q, 4, 2) between lines (K, 2) of neighbouring positions, None where there is none."""
    swept, before, last = [], None, -2
    share = np.linspace(0.0, 1.0, LINE_POINTS)
    for k, line in enumerate(lines):
        if line is None or len(line) < 2:
            continue
        here = _evenly(line, share)
        if before is not None and last == k - 1:
            if np.nansum((here - before) ** 2) > np.nansum((here[::-1] - before) ** 2):
                here = here[::-1]
            if (np.linalg.norm((here - before)[[0, -1]], axis=-1) > APART * np.linalg.norm(here[-1] - here[0])).any():
                before, last = here, k
                continue
            quads = np.stack((before[:-1], before[1:], here[1:], here[:-1]), axis=1)
            swept.append(quads[np.isfinite(quads).all(axis=(1, 2))])
        before, last = here, k
    return swept


def _evenly(line: Array, share: Array) -> Array:
    """Points (S, 2) at shares of the way along a line (K, 2); NaN in the gaps between its pieces."""
    known = np.isfinite(line[:, 0])
    points = line[known]
    way = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=-1).cumsum()]
    places = share * way[-1]
    evenly = np.stack([np.interp(places, way, column) for column in points.T], axis=-1)
    for first in np.flatnonzero(np.diff(np.flatnonzero(known)) > 1):
        evenly[(places > way[first]) & (places < way[first + 1])] = np.nan
    return evenly
