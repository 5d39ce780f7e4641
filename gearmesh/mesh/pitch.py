r"""One pitch of a gear that repeats its teeth, as a proof of the whole gear.

A turn by one pitch maps the gear onto itself. It takes vertex (c, s) to (c, s + 1), where c is the class of the vertex and s
counts pitches, mod the number of teeth N. A class on the axis has one vertex and no s. The triangles of the gear are those of
one pitch, N times. It follows:

- The number of directed edges (c, s) -> (d, t) of the gear is the number of edges of the pitch with the same c, d and
  t - s mod N. The gear is closed if the pitch has each (c, d, t - s) once, and each (d, c, s - t) once.
- The cuts between pitches fit, because a vertex on a cut is one vertex of both pitches.
- Vertices, edges and triangles are N times those of the pitch; vertices on the axis count once.
- Teeth do not pass through each other if each stays in its sector, between its first line and that line turned by a pitch.

Three pitches closed to a ring have the same edges (c, d, t - s), mod 3. manifold3d checks this ring.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.gear_mesh import GearMesh
from gearmesh.records import dataclass

Index = NDArray[np.int64]

#: least number of teeth for which one pitch proves all; with fewer teeth the whole gear is proved
MIN_TEETH = 4
#: pitches of the closed ring
CLOSED_PITCHES = 3
#: largest angle, in pitches, by which a vertex may leave its tooth's sector, for rounding and for chords of the first line
SLACK_PITCHES = 1e-5


@dataclass(frozen=True)
class Pitch:
    """Triangles of one pitch of a gear."""

    #: number of pitches
    teeth: int
    #: class (M, 3) of each corner
    classes: Index
    #: pitch (M, 3) of each corner; 0 on the axis
    shifts: Index
    #: True (C,) for classes on the axis
    on_axis: NDArray[np.bool_]

    @staticmethod
    def of(mesh: GearMesh) -> Pitch | None:
        """Return the first pitch of a gear; None if the other pitches are not its images, or if there are too few."""
        teeth = mesh.ring.teeth
        if len(mesh.ring.kinds) > 1 or teeth < MIN_TEETH:
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
            vertex_class, vertex_pitch = (
                np.where(outer, *pair)
                for pair in ((block % size, of_body[0][inside]), (block // size, of_body[1][inside]))
            )
            turned = np.where(on_axis[vertex_class], 0, (vertex_pitch - np.arange(teeth)[:, None, None]) % teeth)
            if (vertex_class != vertex_class[0]).any() or (turned != turned[0]).any():
                return None
            classes.append(vertex_class[0])
            shifts.append(turned[0])
        return Pitch(teeth, np.concatenate(classes), np.concatenate(shifts), on_axis)

    @property
    def edges(self) -> tuple[Index, Index]:
        """Codes (3 M,) of the directed edges of the triangles, by classes and pitches between them, and of the reversed edges."""
        a, b = self.classes, np.roll(self.classes, -1, axis=1)
        ahead = np.where(self.on_axis[a] | self.on_axis[b], 0, np.roll(self.shifts, -1, axis=1) - self.shifts)
        classes = len(self.on_axis)
        there = (a * classes + b) * self.teeth + ahead % self.teeth
        back = (b * classes + a) * self.teeth + -ahead % self.teeth
        return there.ravel(), back.ravel()

    @property
    def closed(self) -> bool:
        """True if the gear has each of its edges once in either direction."""
        there, back = (np.sort(codes) for codes in self.edges)
        along_axis = (self.on_axis[self.classes].sum(axis=1) > 1).any()
        return not along_axis and bool((there[1:] != there[:-1]).all()) and np.array_equal(there, back)

    @property
    def euler(self) -> int:
        """Euler characteristic of the whole gear."""
        there, back = self.edges
        halved = distinct(there[there == back]).size
        # edges that half a turn maps onto their reverse count half
        edges = self.teeth * distinct(np.minimum(there, back)).size - self.teeth // 2 * halved
        used = distinct(self.classes)
        alone = int(self.on_axis[used].sum())
        return int(self.teeth * (used.size - alone) + alone - edges + self.teeth * len(self.classes))

    def ring(self, mesh: GearMesh) -> tuple[Array, Index]:
        """Return the vertices (V, 3), mm, of CLOSED_PITCHES pitches, and the triangles (T, 3) that close them to a ring."""
        count = len(self.on_axis)
        # pitches from one corner to the others, the shorter way around
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
    """Return the least angle, in pitches, of a tooth's vertices to its first line and to the first line of the next tooth.

    It is 0 on these lines and negative outside the sector between them.
    """
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
