r"""Hexahedra of a turned body with keyways and other forms of the bore, holes, bolt holes and spokes.

The plane across the axis is divided into quadrilaterals (`plane_quads`) whose edges follow the cuts, the circles of the body's
steps, and the nodes on the rim's inner face. They are repeated along the axis at the lines of the axial half plane
(`meridian_grid`), where the body is and nothing is cut.

        rim     ---- w = 1     nodes at the angles of the rim, which turn with the teeth
                 \  \  \
        cuts    ---- w = 0     nodes in line along the axis: cuts are prisms
        bore    ----
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.polylines import contains
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve
from gearmesh.mesh.hexahedra.hexahedra import ToothedRim
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HexMesh
from gearmesh.mesh.hexahedra.meridian_grid import MeridianGrid
from gearmesh.mesh.hexahedra.plane_quads import Line, NodeLine, PlaneMeshError, PlaneQuads, plane_quads
from gearmesh.records import dataclass
from gearmesh.teeth.blank.bores import BoreForm, ClosedLine
from gearmesh.teeth.blank.features import Opening

#: least number of edges of triangles around a circle
LEAST_AROUND = 16
#: least number of edges of triangles on a line or arc of a cut
LEAST_ON_CURVE = 1
#: places along a curve at which it is drawn as a polygon
OUTLINE_PLACES = 33
#: largest distance, as a share of the body's radius, of a step from a cylinder, and of a hole's bottom from a line
STRAIGHT_SHARE = 1e-7

Index = NDArray[np.int64]


class PiercingError(Exception):
    """The cuts do not fit the body's lines."""


@dataclass(frozen=True)
class Cuts:
    """All that is cut along the axis out of a turned body."""

    #: form of the bore; None if it is round
    bore: BoreForm | None
    #: holes, bolt holes, openings between spokes
    openings: tuple[Opening, ...]

    def __bool__(self) -> bool:
        return self.bore is not None or bool(self.openings)

    def reach(self, bore_radius: float) -> tuple[float, float]:
        """Return the smallest and largest distance, mm, of the cuts from the axis."""
        reaches = [opening.reach for opening in self.openings]
        if self.bore is not None:
            reaches.append((min(self.bore.on_x(bore_radius)), self.bore.reach(bore_radius)))
        return min(low for low, _ in reaches), max(high for _, high in reaches)

    @property
    def floors(self) -> list[float]:
        """z, mm, at which openings end inside of the body."""
        return sorted({opening.floor for opening in self.openings if opening.floor is not None})


def join_pierced(rim: ToothedRim, laid: MeridianGrid, cuts: Cuts, size: float, body_set: str) -> HexMesh:
    """Return one mesh of all teeth, rim and pierced body, which share the nodes on the rim's inner face.

    - size: largest size, mm, of the body's elements.
    - body_set: name of the element set of the body.

    Raises PiercingError.
    """
    if not rim.closed or laid.axis != 1 or rim.inner.shape[1] % (2 * rim.step):
        raise PiercingError
    body = _Body(rim, laid, cuts, size)
    return body.mesh(body_set)


class _Body:
    """Pierced body under a rim."""

    def __init__(self, rim: ToothedRim, laid: MeridianGrid, cuts: Cuts, size: float) -> None:
        self._rim, self._laid, self._step, self._size = rim, laid, rim.step, size
        used = np.pad(laid.cells, 1)
        used = used[1:, 1:] | used[1:, :-1] | used[:-1, 1:] | used[:-1, :-1]
        rho = np.where(used, laid.points[..., 0], 0.0)
        #: distance (A,) of each line from the axis, the mean over its nodes
        self._radii = rho.sum(axis=1) / used.sum(axis=1)
        self._rim_line = int(laid.on_rim[0, 0])
        self._outwards = self._rim_line > 0
        self._tolerance = STRAIGHT_SHARE * float(self._radii.max())
        self._cuts, self._reach = cuts, cuts.reach(float(self._radii[0]))
        rim_radius = float(self._radii[self._rim_line])
        if not (self._reach[1] < rim_radius if self._outwards else self._reach[0] > rim_radius):
            raise PiercingError
        #: cells (A, L) of elements, and names of the outline's edges by their first node
        self._cells = laid.cells[:: self._step, :: self._step]
        self._names = [dict[tuple[int, int], str](), dict[tuple[int, int], str]()]
        for axis, first, name in zip(laid.edges.axis, laid.edges.first, laid.edges.names, strict=True):
            self._names[axis][tuple((first // self._step).tolist())] = name
        self._angles = np.unwrap(np.arctan2(rim.points[..., 1], rim.points[..., 0]), axis=1)
        #: station at which the plane across the axis has the rim's nodes
        self._station = len(self._angles) // 2
        try:
            self._plane = self._quads()
        except PlaneMeshError:
            raise PiercingError from None
        self._check()

    def _steps(self) -> list[int]:
        """Return the lines, of elements, between the bore and the rim at which the body or the name of an end face changes."""
        ends = self._end_names()
        changed = (self._cells[1:] != self._cells[:-1]).any(axis=1) | (ends[1:] != ends[:-1]).any(axis=1)
        return [int(k) + 1 for k in np.flatnonzero(changed)]

    def _end_names(self) -> NDArray[np.str_]:
        """Return the names (A, L + 1) of end faces by band and line; empty where there is none."""
        bands, layers = self._cells.shape
        return np.array(
            [[self._names[1].get((band, line), "") for line in range(layers + 1)] for band in range(bands)], dtype=str
        )

    def _quads(self) -> PlaneQuads:
        """Return the quadrilaterals in the plane across the axis; lines are rim, other boundary, steps, cuts."""
        theta = self._angles[self._station]
        radius = float(self._radii[self._rim_line])
        nodes = radius * np.stack((np.cos(theta), np.sin(theta)), axis=-1)
        self._line_names: list[tuple[str, ...]] = [("",)]
        lines = [Line((NodeLine(nodes),), (len(theta) // (2 * self._step),), fixed=True)]
        far = float(self._radii[0] if self._outwards else self._radii[-1])
        form = self._cuts.bore
        if form is None:
            self._add(lines, (PlaneArc.circle(far),), ("",))
        else:
            curves = form.in_bore(far)
            names = tuple("" if isinstance(curve, PlaneArc) else form.region.value for curve in curves)
            self._add(lines, curves, names)
        for k in self._steps():
            circle = float(self._radii[:: self._step][k])
            low, high = self._reach
            if low < circle < high and any(part[0] < circle < part[1] for part in self._reaches()):
                raise PiercingError
            if (circle <= high) if self._outwards else (circle >= low):
                self._need_cylinder(k)
            self._add(lines, (PlaneArc.circle(circle),), ("",))
        for opening in self._cuts.openings:
            self._add(lines, opening.curves, (opening.region.value,) * len(opening.curves))
        if not self._outwards:
            # the rim is the inner boundary
            lines[:2], self._line_names[:2] = lines[1::-1], self._line_names[1::-1]
        return plane_quads(lines, 2.0 * self._size)

    def _reaches(self) -> list[tuple[float, float]]:
        """Return smallest and largest distance of each cut from the axis."""
        own = [opening.reach for opening in self._cuts.openings]
        form, radius = self._cuts.bore, float(self._radii[0])
        return own if form is None else [*own, (0.0, form.reach(radius))]

    def _need_cylinder(self, line: int) -> None:
        """Raise PiercingError if a line of elements is no cylinder where the body ends on it."""
        at = [node for node in self._names[0] if node[0] == line]
        for _, layer in at:
            first = self._step * layer
            rho = self._laid.points[self._step * line, first : first + self._step + 1, 0]
            if np.ptp(rho) > self._tolerance:
                raise PiercingError

    def _add(self, lines: list[Line], curves: ClosedLine, names: tuple[str, ...]) -> None:
        edges = tuple(self._edges_on(curve) for curve in curves)
        lines.append(Line(tuple(curves), edges))
        self._line_names.append(names)

    def _edges_on(self, curve: PlaneCurve) -> int:
        """Return the number of edges of triangles on a curve."""
        length = float(np.linalg.norm(np.diff(curve.at(np.linspace(0.0, 1.0, OUTLINE_PLACES)), axis=0), axis=-1).sum())
        even = int(np.ceil(length / (2.0 * self._size) - 1e-9))
        around = LEAST_AROUND * abs(curve.width) / (2.0 * np.pi) if isinstance(curve, PlaneArc) else 0.0
        return max(even, int(np.ceil(around - 1e-9)), LEAST_ON_CURVE)

    def _share(self, radius: Array) -> Array:
        """Return the shares (N,) of the rim's places that nodes take: 0 at the cuts, 1 at the rim."""
        last = float(self._radii[self._rim_line])
        first = self._reach[1] if self._outwards else self._reach[0]
        return np.asarray(np.clip((radius - first) / (last - first), 0.0, 1.0))

    def _anchors(self) -> tuple[Array, Array]:
        """Return distances (K,) from the axis, rising, and what they are (K, B), mm, at each line along the axis.

        Nodes at the cuts are in line along the axis, wherever the grid's lines are; those on the rim and on the steps between
        are on the grid's lines.
        """
        edge = self._reach[1] if self._outwards else self._reach[0]
        outer = [0, *(self._step * step for step in self._steps()), len(self._radii) - 1]
        free = [k for k in outer if (self._radii[k] > edge) == self._outwards and self._radii[k] != edge]
        straight = [k for k in outer if k not in free]
        radii = [*self._radii[straight], edge, *self._radii[free]]
        count = self._laid.points.shape[1]
        rho = [np.full(count, r) for r in (*self._radii[straight], edge)] + [self._laid.points[k, :, 0] for k in free]
        order = np.argsort(radii, kind="stable")
        actual = np.array(rho)[order]
        if (np.diff(actual, axis=0) < 0.0).any():
            raise PiercingError
        return np.array(radii)[order], actual

    def _level_until(self, anchors: Array) -> float:
        """Return the distance from the axis, mm, up to which lines may be level: the first step or the rim beyond the cuts.

        It is 0 if the end faces up to there are not plane.
        """
        edge, step = self._reach[1], self._step
        beyond = anchors[anchors > edge]
        if not self._outwards or not beyond.size:
            return 0.0
        for band, line in self._names[1]:
            ends = self._laid.points[step * band : step * (band + 1) + 1, step * line]
            level = np.abs(ends[:, 1] - self._laid.points[0, step * line, 1]).max() <= self._tolerance
            if self._radii[step * (band + 1)] <= beyond[0] and not level:
                return 0.0
        return float(beyond[0])

    def _places(self, points: Array) -> Array:
        """Return the places (N, B, 3), mm, at all lines along the axis of nodes (N, 2) of the plane."""
        laid, radii = self._laid, self._radii
        radius = np.hypot(points[:, 0], points[:, 1])
        theta = np.arctan2(points[:, 1], points[:, 0])
        inside = np.clip(radius, radii[0], radii[-1])
        share, (anchors, actual) = self._share(radius), self._anchors()
        level = self._level_until(anchors)
        # lines are level at the cuts, so that holes end on planes
        bent = (
            np.clip((radius - self._reach[1]) / (level - self._reach[1]), 0.0, 1.0) if level else np.ones_like(radius)
        )
        reference = self._angles[self._station]
        result = np.empty((len(points), laid.points.shape[1], 3))
        for b, station in enumerate(laid.station):
            line = laid.points[:, b]
            rho = np.interp(inside, anchors, actual[:, b])
            z = bent * np.interp(rho, line[:, 0], line[:, 1]) + (1.0 - bent) * line[0, 1]
            turned = np.interp(theta, reference, self._angles[station] - reference, period=2.0 * np.pi)
            angle = theta + share * turned
            rho += radius - inside
            result[:, b] = np.stack((rho * np.cos(angle), rho * np.sin(angle), z), axis=-1)
        return result

    @property
    def _bands(self) -> Index:
        """Band (Q,) of the elements' grid in which each quadrilateral is."""
        centre = self._plane.points[self._plane.quads].mean(axis=1)
        band = np.searchsorted(self._radii[:: self._step], np.hypot(*centre.T)) - 1
        return np.asarray(np.clip(band, 0, len(self._cells) - 1))

    def _check(self) -> None:
        """Raise PiercingError if a hole's bottom is not on a line along the axis."""
        for opening in self._cuts.openings:
            if opening.floor is None:
                continue
            rho = np.linspace(*opening.reach, 5)
            heights = self._places(np.column_stack((rho, 0.0 * rho)))[:, :: self._step, 2]
            if np.abs(heights - opening.floor).max(axis=0).min() > self._tolerance:
                raise PiercingError

    def _solid(self) -> tuple[NDArray[np.bool_], Index]:
        """Return True (Q, L) where there is an element, and the opening (Q,) in which a quadrilateral is; -1 for none."""
        plane, bands = self._plane, self._bands
        centre = plane.points[plane.quads].mean(axis=1)
        solid, opening_of = self._cells[bands].copy(), np.full(len(centre), -1)
        heights = self._places(centre)[:, :: self._step, 2]
        middle = 0.5 * (heights[:, 1:] + heights[:, :-1])
        s = np.linspace(0.0, 1.0, OUTLINE_PLACES)[:-1]
        for k, opening in enumerate(self._cuts.openings):
            inside = contains(np.concatenate([curve.at(s) for curve in opening.curves]), centre)
            opening_of[inside] = k
            z = middle[inside]
            solid[inside] &= (z < opening.low) | (z > opening.high)
        return solid, opening_of

    def mesh(self, body_set: str) -> HexMesh:
        """Return the mesh of teeth, rim and body."""
        mesh, plane, step = self._rim.mesh, self._plane, self._step
        corners, middles = self._places(plane.points), self._places(plane.middles)
        count, levels = len(plane.points), corners.shape[1]
        numbers = len(mesh.nodes) + np.arange((count + len(middles)) * levels).reshape(-1, levels)
        # nodes on the rim's inner face are those of the rim
        around = self._rim.inner.shape[1]
        place = np.concatenate((plane.node_place, plane.middle_place))
        on_rim = np.flatnonzero(~np.isnan(place))
        column = np.rint(place[on_rim] * around).astype(int) % around
        lines = self._laid.on_rim[:, 1]
        shared = self._rim.inner[:, column].T
        numbers[on_rim[:, None], lines] = np.where(shared >= 0, shared, numbers[on_rim[:, None], lines])
        solid, opening_of = self._solid()
        quad, layer = np.nonzero(solid)
        elements = self._elements(numbers, count, quad, layer)
        at = np.full(solid.shape, -1)
        at[quad, layer] = np.arange(len(elements))
        first = len(mesh.elements)
        everything = np.concatenate((mesh.nodes, np.concatenate((corners, middles)).reshape(-1, 3)))
        kept = distinct(np.append(np.arange(len(mesh.nodes)), elements))
        whole = np.concatenate((mesh.elements, np.searchsorted(kept, elements)))
        sets = {name: faces for name, faces in mesh.face_sets.items() if name not in ("rim", "bore")}
        for name, faces in self._faces(at, opening_of).items():
            made = faces + np.array([first, 0])
            sets[name] = np.concatenate((sets[name], made)) if name in sets else made
        own = first + np.arange(len(elements))
        element_sets = {**mesh.element_sets, body_set: np.concatenate((mesh.element_sets.get(body_set, own[:0]), own))}
        joined = HexMesh(everything[kept], whole, {}, element_sets, sets)
        if step > 1 and distinct(whole).size != len(kept):
            raise PiercingError
        return replace(joined, node_sets={name: joined.face_nodes(name) for name in sets})

    def _elements(self, numbers: Index, count: int, quad: Index, layer: Index) -> Index:
        """Return the elements (E, 8 or 20) on quadrilaterals (E,) in layers (E,)."""
        step, plane = self._step, self._plane
        low = step * layer[:, None]
        corner = plane.quads[quad]
        sides = (numbers[corner, low], numbers[corner, low + step])
        if step == 1:
            return np.concatenate(sides, axis=1)
        edge = count + plane.edges_of[quad]
        # edges in the order of HEX_EDGES: bottom, top, upright
        assert HEX_EDGES[0] == (0, 1)
        return np.concatenate((*sides, numbers[edge, low], numbers[edge, low + step], numbers[corner, low + 1]), axis=1)

    def _faces(self, at: Index, opening_of: Index) -> dict[str, Index]:
        """Return the face sets (n, 2) of the body from its elements (Q, L), -1 for none."""
        found: dict[str, list[tuple[int, int]]] = {}
        plane, bands = self._plane, self._bands
        beside = self._neighbours()
        radii = self._radii[:: self._step]
        # upright faces: on a cut, or on a cylinder of the body
        for k in range(4):
            other = beside[:, k]
            covered = np.where((other >= 0)[:, None], at[other], -1) >= 0
            quads, heights = np.nonzero((at >= 0) & ~covered)
            for quad, height in zip(quads.tolist(), heights.tolist(), strict=True):
                edge = plane.edges_of[quad, k]
                line = int(plane.line[edge])
                if line == (0 if self._outwards else 1):
                    # the rim's inner face, or what is beyond it
                    name = self._names[0].get((self._rim_line // self._step, height), "")
                    if not name:
                        continue
                else:
                    name = self._line_names[line][plane.curve[edge]]
                if not name:
                    radius = float(np.hypot(*plane.middles[edge]))
                    name = self._names[0][int(np.abs(radii - radius).argmin()), height]
                found.setdefault(name, []).append((int(at[quad, height]), 2 + k))
        # faces across the axis
        padded = np.pad(at, ((0, 0), (1, 1)), constant_values=-1)
        for face, here, there in ((0, padded[:, 1:], padded[:, :-1]), (1, padded[:, :-1], padded[:, 1:])):
            quads, level = np.nonzero((here >= 0) & (there < 0))
            for quad, line in zip(quads.tolist(), level.tolist(), strict=True):
                name = self._names[1].get((int(bands[quad]), line), "")
                if not name or (opening_of[quad] >= 0 and self._is_floor(opening_of[quad], line)):
                    name = self._cuts.openings[opening_of[quad]].region.value
                found.setdefault(name, []).append((int(here[quad, line]), face))
        return {name: np.array(faces) for name, faces in found.items()}

    def _is_floor(self, opening: int, line: int) -> bool:
        """True if an opening ends on a line along the axis."""
        floor = self._cuts.openings[opening].floor
        z = self._laid.points[0, self._step * line, 1]
        return floor is not None and abs(z - floor) <= self._tolerance

    def _neighbours(self) -> Index:
        """Return the quadrilateral (Q, 4) beyond each edge; -1 for none."""
        edges = self._plane.edges_of
        order = np.argsort(edges.ravel(), kind="stable")
        result = np.full(edges.size, -1)
        sorted_edges = edges.ravel()[order]
        same = np.flatnonzero(sorted_edges[1:] == sorted_edges[:-1])
        result[order[same]], result[order[same + 1]] = order[same + 1] // 4, order[same] // 4
        return result.reshape(edges.shape)
