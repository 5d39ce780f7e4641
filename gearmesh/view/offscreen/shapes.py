"""A scene as surfaces, lines and dots for VTK: plain arrays.

Curves, areas and maps on a surface are moved towards the viewer along the lines of sight. Otherwise the facets of the
surface would hide parts of them.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.records import dataclass
from gearmesh.view.offscreen.colour_tables import colour_table
from gearmesh.view.offscreen.drawing_process import PLAIN_PRIMITIVE, Order, Primitive
from gearmesh.view.offscreen.front_plane import cut_front, section_lines
from gearmesh.view.palette import INK_COLOUR, MARKING_COLOUR, REGION_EDGE, RUBBED_COLOUR, rgb
from gearmesh.view.scene import Camera, CompoundFilm, Curve, Dots, PatternArea, Scene, SceneBody, ValueMap

#: section of a body that has no colour of its own for it
SECTION_COLOUR = "#c4d2e3"
#: cosine of the largest angle between a normal of a region and their mean at a vertex; beyond it is a sharp edge
_MIN_SMOOTH_COSINE = np.cos(np.radians(35.0))
#: directions to the lamps in camera axes (right, up, towards the viewer) and their strengths; no side stays black
_CAMERA_LAMPS = (
    ((-0.5, 0.6, 1.0), 0.34),
    ((0.6, 0.1, 0.8), 0.31),
    ((-0.7, 0.1, 0.7), 0.22),
    ((0.0, -1.0, 0.2), 0.10),
)
#: smallest sine of the slope between the triangles beside an edge that stands out
_MIN_FOLD_SINE = 0.05
#: drawn pixels per pixel of the picture, each way, which `finish` averages; widths are scaled by it
OVERSAMPLING_FACTOR = 2
#: cosine up to which a triangle is seen as a line
_EDGE_ON_COSINE = 1e-6
#: strength of the colours of bodies beyond their section, relative to bodies that are not cut
BEYOND_SECTION_STRENGTH = 0.4
#: height of a picture in which lines and dots have their own widths
USUAL_HEIGHT_PIXELS = 1200.0
#: smallest ratio of their widths to these
MIN_STROKE_RATIO = 0.5
#: width of the outline of a section
SECTION_LINE_PIXELS = 1.6
#: size of the cells in which lines are counted, pixels
CROWD_CELL_PIXELS = 16.0
#: lines across a cell, in front and behind, from which they are a dark band and left out
MAX_CROWD_LINES = 14.0
#: distance of the drawn pixels whose depth is known
DEPTH_STEP = 4
#: slope from which a triangle is seen as a line
_MAX_SLOPE = 50.0
#: light from everywhere
AMBIENT_SHARE = 0.36
#: share of a lamp's light that is mirrored
SPECULAR_SHARE = 0.12
#: power of the cosine by which mirrored light falls off
SHININESS_EXPONENT = 20
#: distance beyond an edge of the picture from which nothing reaches into it
EDGE_MARGIN_PIXELS = 8.0
#: layers of translucent bodies one behind the other: a ring has four
_PEEL_LAYERS = 8


def drawing_order(scene: Scene, size: tuple[int, int]) -> Order:
    """Return the order that draws a scene in a picture of a `size` in pixels."""
    scene = _from_camera(scene)
    camera = scene.camera
    viewer = Viewer(camera, camera.height / size[1], size[0] / size[1])
    primitives = sorted((primitive for body in scene.bodies for primitive in _body(body, viewer)), key=_late)
    primitives += [primitive for area in scene.areas for primitive in _area(area, viewer)]
    primitives += [primitive for film in scene.films for primitive in _film(film, viewer)]
    primitives += [primitive for value_map in scene.maps for primitive in _map(value_map, viewer)]
    primitives += [primitive for curve in scene.curves for primitive in _curve(curve, viewer)]
    primitives += [primitive for dots in scene.dots for primitive in _dots(dots, viewer)]
    return Order(
        size=(OVERSAMPLING_FACTOR * size[0], OVERSAMPLING_FACTOR * size[1]),
        position=camera.position.tolist(),
        focus=camera.focus.tolist(),
        up=camera.axes[1].tolist(),
        parallel=camera.parallel,
        height=camera.height,
        angle=float(np.degrees(2 * np.arctan2(camera.height / 2, camera.distance))),
        peels=_PEEL_LAYERS if any(body.opacity < 1.0 for body in scene.bodies) else 0,
        primitives=primitives,
        depth_step=DEPTH_STEP if camera.parallel else 0,
    )


def section_colours(scene: Scene) -> tuple[str, ...]:
    """Return the colours of the sections of bodies that the front plane cuts, each once."""
    if scene.camera.front is None:
        return ()
    return tuple(dict.fromkeys(body.section or SECTION_COLOUR for body in scene.bodies if body.yields))


def _from_camera(scene: Scene) -> Scene:
    """Return the scene in the frame of its camera, which looks at the origin along -z.

    Moving triangles back by different amounts then changes z alone. In a parallel picture their common corners stay at
    the same x and y to the bit, and no pixel between them stays empty.
    """
    camera = scene.camera
    place = Rigid(camera.axes, -camera.axes @ camera.focus)
    return replace(
        scene,
        bodies=tuple(replace(body, own_to_scene=place @ body.own_to_scene) for body in scene.bodies),
        areas=tuple(replace(area, points=place.point(area.points)) for area in scene.areas),
        films=tuple(
            replace(film, points=place.point(film.points), normals=place.vector(film.normals)) for film in scene.films
        ),
        maps=tuple(replace(value_map, points=place.point(value_map.points)) for value_map in scene.maps),
        curves=tuple(replace(curve, points=place.point(curve.points)) for curve in scene.curves),
        dots=tuple(replace(dots, points=place.point(dots.points)) for dots in scene.dots),
        camera=replace(
            camera,
            position=np.array([0.0, 0.0, camera.distance]),
            focus=np.zeros(3),
            up=np.array([0.0, 1.0, 0.0]),
            front_normal=None if camera.front_normal is None else camera.axes @ camera.front_normal,
            measured=None,
        ),
    )


@dataclass(frozen=True)
class Viewer:
    """A camera with the length of a `pixel` (mm) at its focus and the picture's `shape`, width over height."""

    camera: Camera
    pixel: float
    shape: float = 4.0 / 3.0

    @property
    def stroke(self) -> float:
        """Ratio of the widths of curves and dots to those in a picture of the usual height: less in small pictures,
        where they would hide what is under them, but not in proportion.
        """
        return max(float(np.sqrt(self.camera.height / (self.pixel * USUAL_HEIGHT_PIXELS))), MIN_STROKE_RATIO)

    def move_back(self, points: Array, pixels: Array | float) -> Array:
        """Move points (..., 3) away from the viewer along the lines of sight, by the length of `pixels` pixels.

        Their places in the picture stay the same.
        """
        away = pixels * self.pixel
        if self.camera.parallel:
            shifted: Array = points - away * self.camera.axes[2]
            return shifted
        return points + away / self.camera.distance * (points - self.camera.position)

    def sees(self, corners: Array) -> NDArray[np.bool_]:
        """True (T,) for triangles (T, 3, 3) that may be in the picture: not wholly beyond one of its edges.

        In a perspective all are.
        """
        if not self.camera.parallel:
            return np.ones(len(corners), dtype=bool)
        across = (corners - self.camera.focus) @ self.camera.axes[:2].T
        edge = 0.5 * self.camera.height * np.array([self.shape, 1.0]) + EDGE_MARGIN_PIXELS * self.pixel
        inside: NDArray[np.bool_] = ((across.min(axis=1) < edge) & (across.max(axis=1) > -edge)).all(axis=1)
        return inside

    def apart(self, points: Array, edges: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the edges (E, 2) of points (V, 3) that are not so close to others that they would be a dark band.

        There is none if half of their length is crowded.
        """
        if not len(edges) or not self.camera.parallel:
            return edges
        start, end = np.moveaxis(points[edges] @ self.camera.axes[:2].T / (self.pixel * CROWD_CELL_PIXELS), 1, 0)
        length = np.hypot(*(end - start).T)
        count = np.ceil(length).astype(np.int64) + (length == 0.0)
        edge = np.repeat(np.arange(len(edges)), count)
        part = (np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[edge]
        places = np.floor(start[edge] + part[:, None] * (end - start)[edge]).astype(np.int64)
        places -= places.min(axis=0)
        cell = places[:, 0] * (places[:, 1].max() + 1) + places[:, 1]
        cell = np.unique(cell, return_inverse=True)[1].reshape(-1)
        # length of lines in a cell, in lengths of the cell
        crowd = np.bincount(cell, (length / count)[edge])
        around = np.bincount(edge, crowd[cell]) / count
        if length[around > MAX_CROWD_LINES].sum() > 0.5 * length.sum():
            return edges[:0]
        kept: NDArray[np.int64] = edges[around < 2.0 * MAX_CROWD_LINES]
        return kept

    def light(self, points: Array, normals: Array, colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Colours (N, 3) of points (N, 3) in the light of all lamps; normals (N, 3) may have either sense.

        Colours are linear between the corners of a triangle. Computing the light for every pixel would take twice as
        long and change no colour by more than a few parts of 255.
        """
        right_up_back = normals @ self.camera.axes.T
        facing = right_up_back * np.where(right_up_back[:, 2:] < 0.0, -1.0, 1.0)
        towards = unit((self.camera.position - points) @ self.camera.axes.T)
        bright, shine = np.full(len(points), AMBIENT_SHARE), np.zeros(len(points))
        # a flank that is looked at is turned towards the strongest lamps
        front = self.camera.front_normal
        side = -1.0 if front is not None and front @ self.camera.axes[0] > 0.0 else 1.0
        for direction, strength in _CAMERA_LAMPS:
            lamp = unit(np.array(direction)) * np.array([side, 1.0, 1.0])
            falls = facing @ lamp
            bright += strength * np.maximum(falls, 0.0)
            mirrored = 2.0 * falls * dot(facing, towards) - towards @ lamp
            shine += np.where(falls > 0.0, strength * np.maximum(mirrored, 0.0) ** SHININESS_EXPONENT, 0.0)
        lit = colours * bright[:, None] + 255.0 * SPECULAR_SHARE * shine[:, None]
        seen: NDArray[np.uint8] = np.rint(np.minimum(lit, 255.0)).astype(np.uint8)
        return seen

    def slopes(self, corners: Array) -> Array:
        """Pixels (T,) by which triangles (T, 3, 3) recede from the viewer over one drawn pixel."""
        sides = corners[:, 1:] - corners[:, :1]
        across = np.abs(cross(sides[:, 0], sides[:, 1]) @ self.camera.axes.T)
        steep = across[:, :2].max(axis=1) > _MAX_SLOPE * across[:, 2]
        return (
            np.where(steep, _MAX_SLOPE, across[:, :2].max(axis=1) / np.where(steep, 1.0, across[:, 2]))
            / OVERSAMPLING_FACTOR
        )

    def faces(self, corners: Array) -> NDArray[np.bool_]:
        """True (T,) for triangles (T, 3, 3) whose outside is seen."""
        return self.facing(corners) > _EDGE_ON_COSINE

    def edge_on(self, corners: Array) -> NDArray[np.bool_]:
        """True (T,) for triangles (T, 3, 3) that are seen as lines."""
        return np.abs(self.facing(corners)) <= _EDGE_ON_COSINE

    def facing(self, corners: Array, normals: Array | None = None) -> Array:
        """Cosines (T,) of the angles between the direction to the viewer and the outside of triangles (T, 3, 3).

        `normals` (T, 3) replace the normals of the triangles.
        """
        outward = normals
        if outward is None:
            outward = cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        towards = self.camera.axes[2] if self.camera.parallel else self.camera.position - corners[:, 0]
        size = np.sqrt(dot(outward, outward) * dot(towards, towards))
        return dot(outward, towards) / np.where(size > 0.0, size, 1.0)

    def depth(self, points: Array, pixels: float) -> Array:
        """Distance (N,), mm, behind the front plane, of points (N, 3) that were moved back by `pixels` pixels."""
        camera = self.camera
        assert camera.front is not None
        normal = camera.axes[2] if camera.front_normal is None else camera.front_normal
        front = camera.front - pixels * self.pixel * float(camera.axes[2] @ normal)
        behind: Array = front - (points - camera.focus) @ normal
        return behind


def corner_normals(mesh: TriangleMesh) -> Array:
    """Normals (T, 3, 3) for smooth shading, at the corners of every triangle.

    They are the mean of the cell normals of the same region around the vertex, weighted with the corner angles. A cell
    at a sharp edge inside a region keeps its cell normal. A cell normal that contradicts its facet's orientation would
    be shaded black; the facet's normal replaces it.
    """
    corners = mesh.corners()
    sides = np.roll(corners, -1, axis=1) - corners
    facet = cross(sides[:, 0], sides[:, 1])
    cell = np.where((dot(facet, mesh.normals) > 0.0)[:, None], mesh.normals, facet)
    length = np.sqrt(dot(cell, cell))
    cell = cell / np.where(length > 0.0, length, 1.0)[:, None]
    back = np.roll(corners, 1, axis=1) - corners
    angle = np.arctan2(np.linalg.norm(cross(sides, back), axis=-1), dot(sides, back))
    group = mesh.triangles * len(mesh.region_names) + mesh.regions[:, None]
    member = np.unique(group, return_inverse=True)[1].reshape(-1)
    weighted = (angle[..., None] * cell[:, None, :]).reshape(-1, 3)
    total = np.stack([np.bincount(member, weighted[:, k]) for k in range(3)], axis=-1).astype(float)
    size = np.sqrt(dot(total, total))
    mean = (total / np.where(size > 0.0, size, 1.0)[:, None])[member].reshape(-1, 3, 3)
    repeated = np.broadcast_to(cell[:, None, :], mean.shape)
    return np.where((dot(mean, repeated) > _MIN_SMOOTH_COSINE)[..., None], mean, repeated)


def region_edges(mesh: TriangleMesh, seen: NDArray[np.bool_] | None = None) -> NDArray[np.int64]:
    """Edges (E, 2), vertex indices, between two regions, at sharp corners and along open boundaries.

    If `seen` (T,) is given, it is True for triangles seen from outside, and only visible edges are returned.
    """
    edges = np.sort(mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    cell = np.repeat(np.arange(len(mesh.triangles)), 3)
    order = np.lexsort(edges.T)
    edges, cell = edges[order], cell[order]
    first = np.flatnonzero(np.r_[True, (edges[1:] != edges[:-1]).any(axis=1)])
    count = np.diff(np.r_[first, len(edges)])
    left, right = cell[first], cell[first + count - 1]
    bent = dot(mesh.normals[left], mesh.normals[right]) < np.cos(np.radians(50.0))
    marked = (count != 2) | (mesh.regions[left] != mesh.regions[right]) | bent
    if seen is not None:
        # an edge that stands out is seen if either of its triangles is, a re-entrant edge only if both are
        start, end = np.moveaxis(mesh.vertices[edges[first]], 1, 0)
        along, inward = unit(end - start), mesh.corners()[right].mean(axis=1) - start
        inward = inward - dot(inward, along)[:, None] * along
        reentrant = dot(mesh.normals[left], inward) > -_MIN_FOLD_SINE * np.sqrt(dot(inward, inward))
        marked &= np.where(reentrant, seen[left] & seen[right], seen[left] | seen[right])
    shown: NDArray[np.int64] = edges[first[marked]]
    return shown


def _late(primitive: Primitive) -> int:
    """Rank of a primitive in the order of drawing: the outside of a body comes first; drawing hidden parts after it
    costs less.
    """
    return 0 if primitive["colours"] is not None else 1 if primitive["corners"] == 3 else 2


def _nearest_first(cells: NDArray[np.int64], points: Array) -> NDArray[np.int64]:
    """Triangles (T, 3) sorted by depth in the frame of the camera, nearest first: hidden pixels are then not drawn."""
    ordered: NDArray[np.int64] = cells[np.argsort(-points[cells, 2].max(axis=1), kind="stable")]
    return ordered


def _seen_part(mesh: TriangleMesh, viewer: Viewer) -> TriangleMesh:
    """Return the triangles of a mesh that may be in the picture, and all that share a vertex with them, for shading."""
    seen = viewer.sees(mesh.corners())
    if seen.all():
        return mesh
    near = np.zeros(len(mesh.vertices), dtype=bool)
    near[mesh.triangles[seen]] = True
    kept = near[mesh.triangles].any(axis=1)
    return replace(mesh, triangles=mesh.triangles[kept], regions=mesh.regions[kept], normals=mesh.normals[kept])


def _primitive(points: Array, cells: NDArray[np.int64], colour: str, **others: Any) -> Primitive:
    """Return a primitive of points (V, 3) and cells (C, K) in one unlit colour; `others` replace entries."""
    count, corners = cells.shape
    plain = {
        "points": _floats(points),
        "cells": cells.astype(np.int64).tobytes(),
        "starts": np.arange(0, count * corners + 1, corners, dtype=np.int64).tobytes(),
        "corners": corners,
        "colour": _share(colour),
    }
    return cast("Primitive", {**PLAIN_PRIMITIVE, **plain, **others})


# --- bodies ---


def _inside(
    mesh: TriangleMesh, corners: Array, cells: NDArray[np.int64], colour: str, behind: float, viewer: Viewer
) -> Iterator[Primitive]:
    """Yield the inside of a solid that is cut open, unlit like a section, `behind` pixels back; it is drawn before the
    lines on it.
    """
    pixels = behind - 2.0
    points = viewer.move_back(corners.reshape(-1, 3), pixels)
    points, cells, _ = cut_front(points, _nearest_first(cells, points), viewer.depth(points, pixels))
    yield _primitive(points, cells, colour)
    # a face seen as a line has material behind it on one side only; lines farther away would be seen beside it
    ends = mesh.triangles[viewer.edge_on(corners)]
    if len(ends):
        sides = np.unique(np.sort(ends[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
        lines = viewer.move_back(mesh.vertices, behind)
        lines, sides, _ = cut_front(lines, sides, viewer.depth(lines, behind))
        yield _primitive(lines, sides, colour, width=1.0 * OVERSAMPLING_FACTOR)


def _body(body: SceneBody, viewer: Viewer) -> Iterator[Primitive]:
    mesh = _seen_part(body.mesh.move(body.own_to_scene), viewer)
    if not len(mesh.triangles):
        return
    corners = mesh.corners()
    cells = np.arange(corners[..., 0].size).reshape(-1, 3)
    colours = np.array([rgb(body.paint.of(name)) for name in mesh.region_names], dtype=np.uint8)[mesh.regions]
    behind = 4.0 if body.yields else 0.0
    opened = body.yields and viewer.camera.front is not None
    outer = cells
    if opened:
        # both the facet and its exact normal must face the viewer: facets seen nearly edge-on change sides along a
        # horizon and would be drawn as a row of specks
        turned = viewer.faces(corners) & (viewer.facing(corners, mesh.normals) > 0.0)
        outer = cells[turned]
        yield from _inside(mesh, corners, cells[~turned], body.section or SECTION_COLOUR, behind, viewer)
    # a section has no lines that triangles must stay behind; moving it back by its slopes would pass its plane
    back = behind if body.section is not None else behind + viewer.slopes(corners)[:, None, None]
    points = viewer.move_back(corners, back).reshape(-1, 3)
    lit = viewer.light(points, corner_normals(mesh).reshape(-1, 3), np.repeat(colours, 3, axis=0))
    if body.section is not None:
        # what is beyond a section is pale
        lit = np.rint(255.0 - BEYOND_SECTION_STRENGTH * (255.0 - lit)).astype(np.uint8)
    outer = _nearest_first(outer, points)
    if opened:
        points, outer, shades = cut_front(points, outer, viewer.depth(points, behind), lit)
        assert shades is not None
        lit = shades
    yield _primitive(points, outer, body.paint.colour, colours=lit.tobytes(), opacity=body.opacity)
    if opened:
        pixels = behind - 3.0
        lines = viewer.move_back(mesh.vertices, pixels)
        ends = section_lines(lines, mesh.triangles, viewer.depth(lines, pixels)).reshape(-1, 3)
        if len(ends):
            pairs = np.arange(len(ends)).reshape(-1, 2)
            yield _primitive(ends, pairs, INK_COLOUR, width=viewer.stroke * SECTION_LINE_PIXELS * OVERSAMPLING_FACTOR)
    # lines on the far side would show through a section
    edges = viewer.apart(mesh.vertices, region_edges(mesh, viewer.faces(corners) if opened else None))
    if len(edges) and body.section is None:
        pixels = behind - 0.5
        lines = viewer.move_back(mesh.vertices, pixels)
        if opened:
            lines, edges, _ = cut_front(lines, edges, viewer.depth(lines, pixels))
        yield _primitive(lines, edges, REGION_EDGE, width=1.0 * OVERSAMPLING_FACTOR)


# --- what lies on them ---


def _is_finite(points: Array) -> NDArray[np.bool_]:
    """True (...,) for points (..., 3) without NaN."""
    return np.asarray(np.isfinite(points).all(axis=-1))


def _patch(points: Array, values: Array) -> tuple[Array, NDArray[np.int64], Array]:
    """Points, quadrilaterals and values of a patch (..., M, N, 3) with `values` (..., M, N), without cells that have a
    NaN.
    """
    shape = points.shape[:-1]
    index = np.arange(int(np.prod(shape))).reshape(shape)
    quads = np.stack(
        (index[..., :-1, :-1], index[..., 1:, :-1], index[..., 1:, 1:], index[..., :-1, 1:]), axis=-1
    ).reshape(-1, 4)
    known = _is_finite(points) & np.isfinite(values)
    quads = quads[known.reshape(-1)[quads].all(axis=1)]
    used, cells = np.unique(quads, return_inverse=True)
    return points.reshape(-1, 3)[used], cells.reshape(-1, 4), values.reshape(-1)[used]


def _area(area: PatternArea, viewer: Viewer) -> Iterator[Primitive]:
    level = np.zeros(area.points.shape[:-1]) if area.level is None else area.level
    points, cells, values = _patch(area.points, level)
    if len(cells):
        yield _primitive(viewer.move_back(points, -0.5), cells, area.colour, values=_floats(values), cut=1.0)


def _film(film: CompoundFilm, viewer: Viewer) -> Iterator[Primitive]:
    """Yield compound and bare steel, mixed by the share of the compound that stays."""
    index = np.arange(film.share.size).reshape(film.share.shape)
    points, cells, kept = _patch(film.points, index.astype(float))
    used = kept.astype(np.int64)
    share = np.clip(film.share.reshape(-1)[used], 0.0, 1.0)[:, None]
    mixed = share * np.array(rgb(MARKING_COLOUR)) + (1.0 - share) * np.array(rgb(RUBBED_COLOUR))
    lit = viewer.light(points, film.normals.reshape(-1, 3)[used], np.rint(mixed).astype(np.uint8))
    if len(cells):
        yield _primitive(viewer.move_back(points, -0.5), cells, MARKING_COLOUR, colours=lit.tobytes())


def _map(value_map: ValueMap, viewer: Viewer) -> Iterator[Primitive]:
    points, cells, values = _patch(value_map.points, value_map.values)
    if len(cells):
        # Unlit, so that a colour on the tooth is exactly the colour in the bar.
        points, limit = viewer.move_back(points, -0.5), value_map.limit
        table = colour_table(value_map.colours).tobytes()
        yield _primitive(points, cells, INK_COLOUR, values=_floats(values), limit=limit, table=table, cut=limit)


def _curve(curve: Curve, viewer: Viewer) -> Iterator[Primitive]:
    known = _is_finite(curve.points)
    start = np.flatnonzero(known[:-1] & known[1:])
    if len(start):
        place = np.cumsum(known)[start] - 1
        segments, width = np.stack((place, place + 1), axis=-1), viewer.stroke * curve.width * OVERSAMPLING_FACTOR
        yield _primitive(viewer.move_back(curve.points[known], -1.0), segments, curve.colour, width=width)


def _dots(dots: Dots, viewer: Viewer) -> Iterator[Primitive]:
    points = dots.points[_is_finite(dots.points)]
    if len(points):
        # A dot is drawn as a ball: its front half stands out by itself.
        width = viewer.stroke * dots.size * OVERSAMPLING_FACTOR
        yield _primitive(points, np.arange(len(points))[:, None], dots.colour, width=width)


def _floats(values: Array) -> bytes:
    return values.astype(np.float32).tobytes()


def _share(colour: str) -> tuple[float, float, float]:
    red, green, blue = rgb(colour)
    return red / 255.0, green / 255.0, blue / 255.0
