"""Rows of teeth of a member: one row, or the two halves of a double helical member, mirror images of each other."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Protocol

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.region import Region

#: an end of one of the halves: number of the half, and 0 for its toe, 1 for its heel
HalfEnd = tuple[int, int]


@dataclass(frozen=True)
class HalfGear:
    """A row of teeth: the member's tooth, or its image in the plane z = `plane` (mm), turned round the axis.

    `number`: 1 or 2, None for the only row. `shared`: ends of the outline (0 toe, 1 heel) that the row shares with the
    first half.
    """

    plane: float | None = None
    number: int | None = None
    shared: tuple[int, ...] = ()

    @property
    def hand_sign(self) -> int:
        """+1 for the member's tooth, -1 for its image, whose triangles and surfaces are wound the other way."""
        return 1 if self.plane is None else -1

    @property
    def suffix(self) -> str:
        """Suffix of the names of the row's faces."""
        return "" if self.plane is None else "_mirrored"

    @property
    def motion(self) -> Rigid:
        """Motion, or reflection, from the member's tooth to this row."""
        if self.plane is None:
            return Rigid.identity()
        return Rigid(np.diag([1.0, 1.0, -1.0]), np.array([0.0, 0.0, 2.0 * self.plane]))

    def points(self, points: Array) -> Array:
        """Return points of the tooth in this row.

        `points`: (..., 3), of the member's tooth as it is, own frame, mm. Result: (..., 3), mm.
        """
        return points if self.plane is None else self.motion.point(points)

    def vectors(self, vectors: Array) -> Array:
        """Return vectors, such as normals, of the tooth in this row.

        `vectors`: (..., 3), of the member's tooth as it is, own frame. Result: (..., 3).
        """
        return vectors if self.plane is None else self.motion.vector(vectors)


@dataclass(frozen=True)
class AxialGap:
    """The gap between two halves.

    `body`: the cylinder in the gap. `ends`: ends of the halves at the gap, in the order of the body's profile. `flat`:
    True between the halves of a rack, where the floor is a plane and the body's radii are its heights x.
    """

    body: Body
    ends: tuple[HalfEnd, HalfEnd]
    flat: bool = False

    @property
    def floor(self) -> float:
        """Radius of the cylinder, or height x of the plane between the halves of a rack, mm."""
        return self.body.profile[0][0]

    @property
    def diameter(self) -> float:
        """Diameter of the cylinder, mm."""
        return 2.0 * self.floor


class Rows(Protocol):
    """The rows of teeth of a member and their positions; lengths in mm, in the member's own frame."""

    @property
    def halves(self) -> tuple[HalfGear, ...]:
        """Every row; the first is the member's tooth itself."""

    @property
    def outer(self) -> tuple[HalfEnd, HalfEnd]:
        """The two outermost ends of the halves, toe or heel, in the order of the whole body's profile."""

    @property
    def gaps(self) -> tuple[AxialGap, ...]:
        """Gaps between rows that do not meet."""

    @property
    def face_width(self) -> tuple[str, str]:
        """Symbol and name of the face width of a row [ISO 21771]."""

    def body(self, own: Body) -> Body:
        """Return the gear body under all rows.

        `own`: body under the member's tooth.
        """

    def extent(self, own: tuple[float, float]) -> tuple[float, float]:
        """Return first and last station of the whole member.

        `own`: first and last station of the member's tooth, mm. Result: first and last station of the whole member,
        mm.
        """

    def station(self, z: float) -> float:
        """Return the station of the member's tooth that has the section of the whole member at z, outside gaps.

        `z`: z of the section of the whole member, mm. Result: z of the tooth's section, mm.
        """

    def volume(self, row: float, own: Body) -> float:
        """Return the volume of the whole member.

        `row`: volume of the row of the member's tooth, on its own body, mm3. `own`: body of that row.
        """


@dataclass(frozen=True)
class SingleRow:
    """One row of teeth."""

    @property
    def halves(self) -> tuple[HalfGear, ...]:
        return (HalfGear(),)

    @property
    def outer(self) -> tuple[HalfEnd, HalfEnd]:
        return (0, 0), (0, 1)

    @property
    def gaps(self) -> tuple[AxialGap, ...]:
        return ()

    @property
    def face_width(self) -> tuple[str, str]:
        return "b", "face width"

    def body(self, own: Body) -> Body:
        return own

    def extent(self, own: tuple[float, float]) -> tuple[float, float]:
        return own

    def station(self, z: float) -> float:
        return z

    def volume(self, row: float, own: Body) -> float:
        return row


@dataclass(frozen=True)
class DoubleHelical:
    """A second half beyond an end face of the first, which is the member's tooth; lengths in mm."""

    #: z of the plane of symmetry
    plane: float
    #: z of the first half's end face at the gap
    near: float
    #: True if that face is its heel, False if it is its toe
    beyond_heel: bool
    #: radius of the cylinder in the gap; None if the halves meet
    groove: float | None
    #: gear body of both halves
    whole: Body

    @property
    def halves(self) -> tuple[HalfGear, ...]:
        met = (int(self.beyond_heel),) if self.groove is None else ()
        return HalfGear(number=1), HalfGear(self.plane, 2, met)

    @property
    def outer(self) -> tuple[HalfEnd, HalfEnd]:
        return ((0, 0), (1, 0)) if self.beyond_heel else ((1, 1), (0, 1))

    @cached_property
    def gaps(self) -> tuple[AxialGap, ...]:
        if self.groove is None:
            return ()
        first, last = (self.groove, self.near), (self.groove, 2.0 * self.plane - self.near)
        if self.beyond_heel:
            return (AxialGap(Body((last, first), (Region.GAP,)), ((1, 1), (0, 1))),)
        return (AxialGap(Body((first, last), (Region.GAP,)), ((0, 0), (1, 0))),)

    @property
    def face_width(self) -> tuple[str, str]:
        return "b_B", "face width of one half"

    def body(self, own: Body) -> Body:
        return self.whole

    def extent(self, own: tuple[float, float]) -> tuple[float, float]:
        return self.whole.ends

    def station(self, z: float) -> float:
        return min(z, 2.0 * self.plane - z)

    def volume(self, row: float, own: Body) -> float:
        gap = sum(gap.body.cut_off() for gap in self.gaps)
        return 2.0 * (row + own.cut_off()) - gap - self.whole.cut_off()


@dataclass(frozen=True)
class DoubleHelicalBar(DoubleHelical):
    """The second half of a rack; `groove` and `whole` have heights x in place of radii.

    `length`: length of the bar, mm.
    """

    length: float = 0.0

    @cached_property
    def gaps(self) -> tuple[AxialGap, ...]:
        return tuple(replace(gap, flat=True) for gap in super().gaps)

    def volume(self, row: float, own: Body) -> float:
        back = self.whole.profile[0][0]
        gaps = sum((gap.floor - back) * float(np.ptp(gap.body.ends)) for gap in self.gaps)
        return 2.0 * row + self.length * gaps


#: rows of a member with one row of teeth
SINGLE_ROW = SingleRow()


def row_stations(rows: Rows) -> list[tuple[HalfEnd, ...]]:
    """Return the ends of all rows by their stations, in the order of the whole body's profile.

    Rows that meet share a station.
    """
    first, last = rows.outer
    if len(rows.halves) == 1:
        return [(first,), (last,)]
    inner = [(half, 1 - which) for half, which in rows.outer]
    return [(first,), *([(end,) for end in inner] if rows.gaps else [tuple(inner)]), (last,)]
