r"""One pitch of a gear that repeats its teeth, and what it proves of the whole.

The gear is turned onto itself by a pitch, which takes vertex (c, s) to (c, s + 1): c is its class, s counts pitches, mod the
number of teeth N. A class on the axis has one vertex, and no s. Triangles of the gear are those of one pitch, N times, so that

- a directed edge (c, s) -> (d, t) is there as often as there are edges of the pitch with the same c, d and t - s mod N: the gear
  runs along all edges once in either direction if the pitch has each (c, d, t - s) once, and each (d, c, s - t);
- cuts between pitches fit, as a vertex on a cut is one vertex of both;
- vertices, edges and triangles are N times those of the pitch, but for vertices on the axis, which count once;
- teeth cannot pass through each other if each stays in its sector, between the line where it begins and that line turned.

Three pitches closed to a ring have the same edges (c, d, t - s), now mod 3, and are what manifold3d is asked about.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.gear_mesh import GearMesh

Index = NDArray[np.int64]

#: teeth from which on one pitch stands for all of them: three are proved
FEWEST_TEETH = 4
#: pitches that are closed to a ring
CLOSED_PITCHES = 3
#: share of a pitch by which vertices beside a tooth's first line may leave its sector by rounding, and by chords of that line
SLACK_PITCHES = 1e-5


@dataclass(frozen=True)
class Pitch:
    """Triangles of one pitch of a gear.

    teeth      number of pitches
    classes    class (M, 3) of every corner
    shifts     pitch (M, 3) of every corner, 0 on the axis
    on_axis    True for the classes (C,) on the axis
    """

    teeth: int
    classes: Index
    shifts: Index
    on_axis: NDArray[np.bool_]

    @staticmethod
    def of(mesh: GearMesh) -> Pitch | None:
        """The first pitch of a gear; None where the others are not the same, turned, or where there are too few."""
        teeth = mesh.ring.teeth
        if len(mesh.ring.kinds) > 1 or teeth < FEWEST_TEETH:
            return None
        tooth, body = mesh.ring.kinds[0], mesh.body
        size = len(tooth.vertices)
        sizes = np.array(body.rings)
        single = sizes == 1
        if (sizes[~single] % teeth).any() or (np.array(body.blocks) % teeth).any():
            return None
        per_pitch = np.where(single, 1, sizes // teeth)
        firsts = size + np.cumsum(per_pitch) - per_pitch
        on_axis = np.repeat(np.concatenate(([False], single)), np.concatenate(([size], per_pitch)))
        # class and pitch of every vertex of the body
        place = np.concatenate([np.arange(count) for count in sizes]) if sizes.size else np.zeros(0, dtype=np.int64)
        ring = np.repeat(np.arange(sizes.size), sizes)
        of_body = np.stack((firsts[ring] + place % per_pitch[ring], place // per_pitch[ring]))
        classes, shifts = [tooth.triangles % size], [tooth.triangles // size]
        begin = 0
        for count in body.blocks:
            block = body.triangles[begin : begin + count].reshape(teeth, -1, 3)
            begin += count
            outer = block < mesh.ring.size
            inside = np.where(outer, 0, block - mesh.ring.size)
            own, on = (
                np.where(outer, *pair)
                for pair in ((block % size, of_body[0][inside]), (block // size, of_body[1][inside]))
            )
            turned = np.where(on_axis[own], 0, (on - np.arange(teeth)[:, None, None]) % teeth)
            if (own != own[0]).any() or (turned != turned[0]).any():
                return None
            classes.append(own[0])
            shifts.append(turned[0])
        return Pitch(teeth, np.concatenate(classes), np.concatenate(shifts), on_axis)

    @property
    def edges(self) -> tuple[Index, Index]:
        """Number (3 M,) of every edge along which a triangle runs, by its classes and the pitches between them; and of the same
        edge run back."""
        a, b = self.classes, np.roll(self.classes, -1, axis=1)
        ahead = np.where(self.on_axis[a] | self.on_axis[b], 0, np.roll(self.shifts, -1, axis=1) - self.shifts)
        classes = len(self.on_axis)
        there = (a * classes + b) * self.teeth + ahead % self.teeth
        back = (b * classes + a) * self.teeth + -ahead % self.teeth
        return there.ravel(), back.ravel()

    @property
    def closed(self) -> bool:
        """True where the gear runs along each of its edges once in either direction."""
        there, back = (np.sort(of) for of in self.edges)
        along_axis = (self.on_axis[self.classes].sum(axis=1) > 1).any()
        return not along_axis and bool((there[1:] != there[:-1]).all()) and np.array_equal(there, back)

    @property
    def euler(self) -> int:
        """Euler number of the whole gear."""
        there, back = self.edges
        halved = distinct(there[there == back]).size
        # an edge that half a turn takes to itself run back
        edges = self.teeth * distinct(np.minimum(there, back)).size - self.teeth // 2 * halved
        used = distinct(self.classes)
        alone = int(self.on_axis[used].sum())
        return int(self.teeth * (used.size - alone) + alone - edges + self.teeth * len(self.classes))

    def ring(self, mesh: GearMesh) -> tuple[Array, Index]:
        """Vertices (V, 3), those of as many pitches of the gear, and triangles (T, 3) of a few pitches closed to a ring."""
        count = len(self.on_axis)
        # from one corner to the others, either way round
        first = self.shifts[np.arange(len(self.shifts)), self.on_axis[self.classes].argmin(axis=1)]
        ahead = (self.shifts - first[:, None] + self.teeth // 2) % self.teeth - self.teeth // 2
        on = (ahead[None] + np.arange(CLOSED_PITCHES)[:, None, None]) % CLOSED_PITCHES
        triangles = np.where(self.on_axis[self.classes], 0, on) * count + self.classes
        points = np.empty((CLOSED_PITCHES, count, 3))
        size = len(mesh.ring.kinds[0].vertices)
        places = np.arange(CLOSED_PITCHES)
        points[:, :size] = mesh.ring.turn(0, mesh.ring.kinds[0].vertices, places).reshape(CLOSED_PITCHES, size, 3)
        first, begin = size, 0
        for of_ring in mesh.body.rings:
            per_pitch = 1 if of_ring == 1 else of_ring // self.teeth
            for k in places.tolist():
                start = begin if of_ring == 1 else begin + k * per_pitch
                points[k, first : first + per_pitch] = mesh.body.vertices[start : start + per_pitch]
            first, begin = first + per_pitch, begin + of_ring
        return points.reshape(-1, 3), triangles.reshape(-1, 3)


def least_room(mesh: GearMesh) -> float:
    """Least angle, in pitches, by which a tooth stays between the line where it begins and the same line of the next tooth;
    0 on these lines, negative beyond them."""
    tooth, pitch = mesh.ring.kinds[0], mesh.ring.pitch
    lines = np.split(tooth.first_line, len(tooth.numbers))
    least = np.inf
    for numbers, line in zip(tooth.numbers, lines, strict=True):
        points, cut = tooth.vertices[numbers], tooth.vertices[line]
        stations = np.asarray(mesh.level.value(cut))
        order = np.argsort(stations)
        angles = np.unwrap(np.arctan2(cut[:, 1], cut[:, 0]))
        begins = np.interp(np.asarray(mesh.level.value(points)), stations[order], angles[order])
        beyond_middle = np.arctan2(points[:, 1], points[:, 0]) - begins - 0.5 * pitch
        beyond_middle -= 2.0 * np.pi * np.rint(beyond_middle / (2.0 * np.pi))
        least = min(least, float(0.5 - np.abs(beyond_middle).max() / pitch))
    return least
