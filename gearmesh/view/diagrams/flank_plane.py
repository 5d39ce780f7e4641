"""A flank in its plane, as gear makers draw it, with path, ellipses, lines and pattern of contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, SplineCurve
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.view.on_tooth import ellipse_edges, union_level
from gearmesh.view.projection import flank_projection
from gearmesh.view.scene import MemberContact, Project

#: points across and along a flank from which a pattern is drawn
PLANE_GRID = (121, 241)
#: exact points across and along a flank, between which the others lie on splines
EXACT_GRID = (61, 121)
#: points of a piece of a contact line from which the swept area is made
POINTS_PER_PIECE = 41
#: largest distance of the shorter of two lines from the longer, as a share of the longer, if only flank is between them
MAX_STRIP_WIDTH_SHARE = 0.5
#: smallest share of either line beside the other if they bound one strip
MIN_OVERLAP_SHARE = 0.25


@dataclass(frozen=True)
class FlankPlane:
    """A flank of a member in its plane."""

    #: the member
    member: Member
    #: side of the flank
    side: Side
    #: coordinates as in drawings: length along the face and height, mm
    frame: FlankFrame
    #: points across and along the flank from which patterns are drawn
    count: tuple[int, int] = PLANE_GRID

    @staticmethod
    def of(member: Member, side: Side) -> FlankPlane:
        """Return the plane of a member's flank. Raises TrimError if the flank cannot be trimmed."""
        return FlankPlane(member, side, FlankFrame.of(member, side).as_drawn)

    @property
    def labels(self) -> tuple[str, str]:
        """Names of length and height with their unit."""
        across, up = station_normal(self.member.tooth.blank.axial)
        if across == 0.0:
            return "z (mm)", f"{self.member.tooth.joint.radius_name} (mm)"
        return ("radius (mm)" if up == 0.0 else "cone distance (mm)"), "height (mm)"

    @cached_property
    def grid(self) -> Array:
        """Points (I, J, 3) of the trimmed flank, own frame, from form point to tip and from toe to heel.

        They lie on splines through exact points: far nearer to the flank than a pixel, in half of the time.
        """
        exact = [np.linspace(0.0, 1.0, min(n, most)) for n, most in zip(self.count, EXACT_GRID, strict=True)]
        points = self.member.tooth.flank_grid(self.side, *exact).points
        if points.shape[:2] == self.count:
            return points
        s, t = (np.linspace(0.0, 1.0, n) for n in self.count)
        across = SplineCurve.through(exact[0], points, CUBIC_DEGREE)(s)
        return SplineCurve.through(exact[1], across.swapaxes(0, 1), CUBIC_DEGREE)(t).swapaxes(0, 1)

    @cached_property
    def _project(self) -> Project:
        return flank_projection(self.member, self.side)

    def ellipses(self, contact: MemberContact, chosen: NDArray[np.int64], rays: int = 97) -> Array:
        """Contact ellipses of positions `chosen` (E,), on the flank and cut off at its edges: closed lines (E, rays,
        2).
        """
        if not len(chosen):
            return np.empty((0, rays, 2))
        return self.frame.places(ellipse_edges(contact, chosen, self._project, rays))

    def path(self, contact: MemberContact) -> Array:
        """Path of contact (P, 2); NaN without contact, and for contact lines, on which no point is special."""
        where = self.frame.places(contact.point)
        where[contact.along_lines] = np.nan
        return where

    def lines(self, contact: MemberContact) -> list[Array]:
        """Contact lines, each (K, 2)."""
        return [self.frame.places(line) for line in contact.lines if line is not None]

    def pattern(self, contact: MemberContact) -> tuple[Array, Array]:
        """Places (I, J, 2) of `grid` and their levels (I, J), at most 1 inside the pattern.

        The pattern is the area that the ellipses of all positions sweep.
        """
        return self.frame.places(self.grid), union_level(contact, self.grid)

    def swept(self, contact: MemberContact) -> list[Array]:
        """Areas swept by contact lines: strips of quadrilaterals (Q, 4, 2) between lines of neighbouring positions."""
        return strips([None if line is None else self.frame.places(line) for line in contact.lines])


def strips(lines: Sequence[Array | None]) -> list[Array]:
    """Strips of quadrilaterals (Q, 4, 2) between lines (K, 2) of neighbouring positions; None for a position without a
    line.

    Lines have pieces, separated by NaN, which split, join and vanish from one position to the next.
    """
    pieces = [_pieces(line) for line in lines]
    return [strip for before, here in pairwise(pieces) for strip in _between(before, here)]


def _pieces(line: Array | None) -> list[Array]:
    """Evenly spaced points (POINTS_PER_PIECE, 2) of each piece of a line (K, 2)."""
    known = np.zeros(0, dtype=np.intp) if line is None else np.flatnonzero(np.isfinite(line).all(axis=1))
    runs = [run for run in np.split(known, np.flatnonzero(np.diff(known) > 1) + 1) if len(run) > 1]
    return [] if line is None else [_part(line[run], 0.0, 1.0) for run in runs]


def _part(points: Array, first: float, last: float) -> Array:
    """Evenly spaced points (POINTS_PER_PIECE, 2) between two shares of the length of a line (K, 2)."""
    way = np.r_[0.0, np.linalg.norm(np.diff(points, axis=0), axis=-1).cumsum()]
    places = np.linspace(first, last, POINTS_PER_PIECE) * way[-1]
    return np.stack([np.interp(places, way, column) for column in points.T], axis=-1)


def _between(before: list[Array], here: list[Array]) -> Iterator[Array]:
    """Strips (Q, 4, 2) between the pieces of two lines, each between the parts that are beside each other."""
    beside = {(i, j): (_share(a, b), _share(b, a)) for i, a in enumerate(before) for j, b in enumerate(here)}
    beside = {
        pair: ways for pair, ways in beside.items() if max(float(np.ptp(way)) for way in ways) > MIN_OVERLAP_SHARE
    }
    for (i, j), (of_a, of_b) in beside.items():
        with_a, with_b = ([w[k] for pair, w in beside.items() if pair[k] == (i, j)[k]] for k in (0, 1))
        a, b = _part(before[i], *_outermost(of_a, with_a)), _part(here[j], *_outermost(of_b, with_b))
        if ((a - b) ** 2).sum() > ((a - b[::-1]) ** 2).sum():
            b = b[::-1]
        # the ends of a line that became short may be far from the ends of the line before, which it lies beside
        short, long = sorted((a, b), key=lambda side: float(np.linalg.norm(side[-1] - side[0])))
        away = np.linalg.norm(short[:, None] - long, axis=-1).min(axis=1)
        if away.max() <= MAX_STRIP_WIDTH_SHARE * np.linalg.norm(long[-1] - long[0]):
            yield np.stack((a[:-1], a[1:], b[1:], b[:-1]), axis=1)


def _share(line: Array, other: Array) -> Array:
    """Shares (2,) of a line's length (K, 2) between which it is beside another line: nearest to the other's ends."""
    away = np.linalg.norm(line[:, None] - other[[0, -1]], axis=-1)
    return np.sort(away.argmin(axis=0)) / (len(line) - 1.0)


def _outermost(shares_of_line: Array, every: list[Array]) -> tuple[float, float]:
    """Shares (2,) of a line beside several lines, extended to its ends where no other line is nearer to them."""
    first = 0.0 if shares_of_line[0] <= min(shares[0] for shares in every) else float(shares_of_line[0])
    last = 1.0 if shares_of_line[1] >= max(shares[1] for shares in every) else float(shares_of_line[1])
    return first, last
