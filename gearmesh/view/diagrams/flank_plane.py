"""A flank laid into a plane, as makers of gears look at it, and what lies on it: path, ellipses, lines and pattern of contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

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
#: part of a line's length by which the next one, if it is shorter, is away at most, if nothing but flank lies between them
APART = 0.5
#: part of either of two lines that is beside the other at least, if they bound one strip
PARTNERS = 0.25


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
    """Strips of quadrilaterals (Q, 4, 2) between lines (K, 2) of neighbouring positions, None where there is none.

    Lines have pieces, with NaN between them, which part, join and vanish from one position to the next.
    """
    pieces = [_pieces(line) for line in lines]
    return [strip for before, here in pairwise(pieces) for strip in _between(before, here)]


def _pieces(line: Array | None) -> list[Array]:
    """Evenly spaced points (LINE_POINTS, 2) of each piece of a line (K, 2)."""
    known = np.zeros(0, dtype=np.intp) if line is None else np.flatnonzero(np.isfinite(line).all(axis=1))
    runs = [run for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1) if len(run) > 1]
    return [] if line is None else [_part(line[run], 0.0, 1.0) for run in runs]


def _part(points: Array, first: float, last: float) -> Array:
    """Evenly spaced points (LINE_POINTS, 2) of what is between two shares of the length of a line (K, 2)."""
    way = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=-1).cumsum()]
    places = np.linspace(first, last, LINE_POINTS) * way[-1]
    return np.stack([np.interp(places, way, column) for column in points.T], axis=-1)


def _between(before: list[Array], here: list[Array]) -> Iterator[Array]:
    """Strips (Q, 4, 2) between the pieces of two lines, each between what of them is beside the other."""
    beside = {(i, j): (_share(a, b), _share(b, a)) for i, a in enumerate(before) for j, b in enumerate(here)}
    beside = {pair: ways for pair, ways in beside.items() if max(float(np.ptp(way)) for way in ways) > PARTNERS}
    for (i, j), (of_a, of_b) in beside.items():
        with_a, with_b = ([w[k] for pair, w in beside.items() if pair[k] == (i, j)[k]] for k in (0, 1))
        a, b = _part(before[i], *_outermost(of_a, with_a)), _part(here[j], *_outermost(of_b, with_b))
        if ((a - b) ** 2).sum() > ((a - b[::-1]) ** 2).sum():
            b = b[::-1]
        # of a line that has grown short ends may be far from those of the one before, which it lies beside
        short, long = sorted((a, b), key=lambda side: float(np.linalg.norm(side[-1] - side[0])))
        away = np.linalg.norm(short[:, None] - long, axis=-1).min(axis=1)
        if away.max() <= APART * np.linalg.norm(long[-1] - long[0]):
            yield np.stack((a[:-1], a[1:], b[1:], b[:-1]), axis=1)


def _share(line: Array, other: Array) -> Array:
    """Between which shares (2,) of its way a line (K, 2) is beside another: where it is nearest to the other's ends."""
    away = np.linalg.norm(line[:, None] - other[[0, -1]], axis=-1)
    return np.sort(away.argmin(axis=0)) / (len(line) - 1.0)


def _outermost(own: Array, every: list[Array]) -> tuple[float, float]:
    """The shares (2,) `own` of a line that is beside several, up to its ends where no other is nearer to these."""
    first = 0.0 if own[0] <= min(shares[0] for shares in every) else float(own[0])
    last = 1.0 if own[1] >= max(shares[1] for shares in every) else float(own[1])
    return first, last
