"""Hexahedra of a whole gear: teeth and rim, and under them the turned body with web, hubs, shafts and steps of the bore.

The quadrilaterals of the axial half plane (`meridian_grid`) are repeated around the axis at the polar angles of the rim's
nodes, and share these nodes. The nodes of a line have the angles of the station at which it begins, so that cut faces follow
the tooth.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian
from gearmesh.mesh.hexahedra.hexahedra import (
    RIM_WHOLE_DEPTHS,
    HexGrid,
    ToothedRim,
    halve,
    least_room,
    on_breaks,
    rim_of,
    toothed_rim,
    whole_depth,
    with_stations,
)
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HexMesh
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.mesh.hexahedra.meridian_grid import (
    MeridianGrid,
    MeridianOutline,
    OutlineError,
    meridian_grid,
    rim_corners,
)
from gearmesh.mesh.hexahedra.pierced_body import Cuts, PiercingError, join_pierced
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Body, end_names
from gearmesh.teeth.region import CUT_REGIONS, Region
from gearmesh.teeth.tooth import Tooth

#: thickest rim that a body joins, as a share of the depth under the roots; below it lines may bend
RIM_SHARE = 0.8
#: thickest rim over a cut, as a share of the depth from the roots to the cut; below it elements turn out of the teeth's lead
CUT_RIM_SHARE = 0.4
#: radius of the core that is left out of a body without bore, as a share of its smallest radius
CORE_SHARE = 0.2
#: default size of the body's elements, in whole depths: half the default rim
BODY_CELL_WHOLE_DEPTHS = 0.5 * RIM_WHOLE_DEPTHS
#: least number of cells along the rim between two corners of the body, as the faces of a web
LEAST_BETWEEN = 2
#: node and face set of the core's surface
CORE_SET = "core"
#: element set of the body
BODY_SET = "body"
#: node and face set of a shaft's end
SHAFT_END_SET = "shaft_end"

Index = NDArray[np.int64]


def core_radius(tooth: Tooth, body: Body) -> float:
    """Return the radius, mm, of the core that is left out of a body without bore; 0 for other bodies."""
    root = tooth.grid(Region.ROOT, np.array([0.5]), tooth.sections([0.0, 1.0])).points[0]
    radii = [float(tooth.joint.radius(root).min()), *(rho for rho, _ in body.profile if rho > 0.0)]
    return CORE_SHARE * min(radii) if body.solid else 0.0


def whole_mesh(
    tooth: Tooth,
    body: Body,
    teeth: Index,
    grid: HexGrid,
    rim: float | None = None,
    size: float | None = None,
    *,
    second_order: bool = False,
    cuts: Cuts | None = None,
) -> HexMesh:
    """Return the hexahedra of teeth and rim, as `hexahedra.hex_mesh` does, and of the body under the rim.

    - body: as `Member.body`.
    - size: size, mm, of the body's elements; by default BODY_CELL_WHOLE_DEPTHS whole depths.
    - cuts: keyway, holes and the like, for a mesh of all teeth; they are left out where the body's lines do not fit them.

    There are further sets:

    - regions of the body: bore, web, hub, shaft, counterbore, face_toe, face_heel.
    - shaft_end.
    - core: surface of the core that is left out of a body without bore.
    - walls of the cuts: keyway, bore_flat, hole, bolt, spoke.
    - the element set body.

    The set rim exists for internal gears only; it is their outside.

    Raises TrimError for a tooth that cannot be trimmed, DesignError for a body that cannot be meshed by rings of hexahedra.
    """
    core = CORE_SET if body.solid else Region.BORE.value
    if cuts:
        try:
            return _rings(tooth, _with_floors(body, cuts), teeth, grid, rim, size, second_order, core, cuts)
        except PiercingError:
            pass
    return _rings(tooth, body, teeth, grid, rim, size, second_order, core, None)


def _rings(
    tooth: Tooth,
    body: Body,
    teeth: Index,
    grid: HexGrid,
    rim: float | None,
    size: float | None,
    second_order: bool,
    core: str,
    cuts: Cuts | None,
) -> HexMesh:
    """Return the mesh of `whole_mesh`, with or without cuts; `core`: name of the inner surface of the body.

    Raises PiercingError if the cuts do not fit the body's lines.
    """
    tooth = replace(tooth, blank=replace(tooth.blank, body=_with_core(tooth, body)))
    grid = on_breaks(tooth, grid)
    rim = _thickness(tooth, grid, rim, cuts)
    cells = BODY_CELL_WHOLE_DEPTHS * whole_depth(tooth, grid.t) if size is None else size
    for axis in _axes(tooth, grid, rim):
        try:
            body_grid = _with_corners(tooth, grid, rim, axis)
            stations = _meridian(tooth, (halve(body_grid) if second_order else body_grid).t, rim)
            step = 2 if second_order else 1
            laid = meridian_grid(_outline(tooth, stations, core), stations, axis, cells, step)
        except OutlineError:
            continue
        toothed = toothed_rim(tooth, teeth, body_grid, rim, second_order=second_order)
        mesh = _with_cuts(toothed, laid, cuts, cells) if cuts else _join(toothed, laid).mesh
        under = mesh.element_sets[BODY_SET]
        if scaled_jacobian(mesh.nodes, mesh.elements[under]).min() > 0.0:
            return mesh
    if cuts is not None:
        raise PiercingError
    raise DesignError("fe.body", "whole", reason="the body has no rings of hexahedra", allowed='"rim"')


def _with_core(tooth: Tooth, body: Body) -> Body:
    """Return the body, with a hole around its axis if it has no bore."""
    radius = core_radius(tooth, body)
    return Body(tuple((max(rho, radius), z) for rho, z in body.profile), body.bands)


def _with_floors(body: Body, cuts: Cuts) -> Body:
    """Return the body with points of its bore, or of the outside of a ring, at the bottoms of holes."""
    band = body.bands.index(Region.RIM if body.around else Region.BORE)
    (radius, first), (_, last) = body.profile[band : band + 2]
    inside = [z for z in cuts.floors if min(first, last) < z < max(first, last)]
    points = [(radius, z) for z in (inside if last > first else inside[::-1])]
    bands = (*body.bands[: band + 1], *(body.bands[band],) * len(points), *body.bands[band + 1 :])
    return Body((*body.profile[: band + 1], *points, *body.profile[band + 1 :]), bands)


def _thickness(tooth: Tooth, grid: HexGrid, rim: float | None, cuts: Cuts | None) -> float:
    """Return the thickness, mm, of the rim: that of `hex_mesh`, or less if the body is thinner anywhere, or cut."""
    chart, inner = rim_of(layers(tooth, grid.t), rim)
    room = RIM_SHARE * least_room(tooth, grid.t)
    if cuts is not None:
        radii = tooth.joint.radius(tooth.grid(Region.ROOT, np.array([0.5]), tooth.sections(grid.t)).points[0])
        low, high = cuts.reach(tooth.blank.body.profile[tooth.blank.body.bands.index(Region.BORE)][0])
        away = low - float(radii.max()) if tooth.blank.body.around else float(radii.min()) - high
        room = min(room, CUT_RIM_SHARE * away)
    if room <= 0.0:
        raise DesignError("fe.body", "whole", reason="the body reaches up to the roots", allowed='"rim"')
    return min(float((chart.reference - inner).max()), room)


def _meridian(tooth: Tooth, t: Array, rim: float) -> Array:
    """Return the rim's inner face (T, 2), (rho, z), mm, at stations t (T,)."""
    chart, inner = rim_of(layers(tooth, t), rim)
    depth = chart.depth(inner)
    points = chart.from_chart(np.stack((depth, np.zeros_like(depth)), axis=-1))
    return np.stack((np.hypot(points[:, 0], points[:, 1]), points[:, 2]), axis=-1)


def _outline(tooth: Tooth, stations: Array, bore: str) -> MeridianOutline:
    """Return the outline of the body under the rim; the faces of its bore get the name `bore`."""
    body = tooth.blank.body
    names = [bore if band is Region.BORE else band.value for band in body.bands]
    if Region.BORE in body.bands:
        for k in (body.bore_band - 1, body.bore_band + 1):
            if 0 <= k < len(names) and body.bands[k] is Region.SHAFT:
                names[k] = SHAFT_END_SET
    points = np.array((stations[0], *body.profile, stations[-1]))
    first, last = end_names(tooth.blank.axial)
    return MeridianOutline(points, (first, *names, last))


def _axes(tooth: Tooth, grid: HexGrid, rim: float) -> tuple[int, int]:
    """Return both directions of the rim to try, the nearer one first: 0 along the axis, 1 square to it."""
    rho, z = np.abs(np.ptp(_meridian(tooth, grid.t, rim), axis=0))
    return (1, 0) if rho > z else (0, 1)


def _with_corners(tooth: Tooth, grid: HexGrid, rim: float, axis: int) -> HexGrid:
    """Return the grid with stations where the lines of the body's corners cross the rim, and enough between for webs to bend."""
    t = np.linspace(0.0, 1.0, 201)
    stations = _meridian(tooth, t, rim)
    way = np.linalg.norm(np.diff(stations, axis=0), axis=-1)
    shares = np.concatenate(([0.0], np.cumsum(way))) / way.sum()
    corners = np.sort(np.interp(rim_corners(_outline(tooth, stations, CORE_SET), stations, axis), shares, t))
    grid = with_stations(grid, corners)
    bounds = np.concatenate(([0.0], corners, [1.0]))
    few = [
        0.5 * (low + high)
        for low, high in pairwise(bounds)
        if np.count_nonzero((grid.t > low + 1e-9) & (grid.t < high - 1e-9)) < LEAST_BETWEEN - 1
    ]
    return with_stations(grid, np.array(sorted((*corners, *few))))


@dataclass(frozen=True)
class _Joined:
    """Mesh of rim and body."""

    #: the mesh
    mesh: HexMesh
    #: node numbers (A, B, J) by the nodes of the grid and around the axis; -1 for none
    numbers: Index
    #: their places (A, B, J, 3), mm
    places: Array


def _with_cuts(rim: ToothedRim, laid: MeridianGrid, cuts: Cuts, size: float) -> HexMesh:
    """Return one mesh of rim and pierced body; `size`: size, mm, of the body's elements."""
    return join_pierced(*_down_to_toe(rim, laid), cuts, size, BODY_SET)


def _down_to_toe(rim: ToothedRim, laid: MeridianGrid) -> tuple[ToothedRim, MeridianGrid]:
    """Return the rim and the grid under it, whose lines from the rim go inwards.

    Under a steep rim (axis 0) they go along the axis: the body at larger radii than the rim's smallest station is joined to
    the rim, and what is left of the grid is inside.
    """
    if laid.axis == 1:
        return rim, laid
    last = int(laid.on_rim[:, 0].min())
    outer = np.arange(len(laid.cells)) >= last
    # cell beside each edge
    inwards = laid.edges.first[:, 0] - np.where((laid.edges.axis == 0) & ~laid.edges.above, 1, 0)
    joined = _join(rim, replace(laid, cells=laid.cells & outer[:, None], edges=laid.edges.only(inwards >= last)))
    lines = np.arange(laid.points.shape[1])
    inside = replace(
        laid,
        points=laid.points[: last + 1],
        cells=laid.cells[:last],
        edges=laid.edges.only(inwards < last),
        axis=1,
        station=lines,
        on_rim=np.column_stack((np.full_like(lines, last), lines)),
    )
    return replace(rim, mesh=joined.mesh, inner=joined.numbers[last], points=joined.places[last]), inside


def _join(rim: ToothedRim, laid: MeridianGrid) -> _Joined:
    """Return one mesh of rim and body, which share the nodes on the rim's inner face."""
    mesh, step, round_ = rim.mesh, rim.step, rim.inner.shape[1]
    angles = np.unwrap(np.arctan2(rim.points[..., 1], rim.points[..., 0]), axis=1)
    grown = laid.station if laid.axis else laid.station[:, None]
    theta = angles[np.broadcast_to(grown, laid.points.shape[:2])]
    rho, z = (np.broadcast_to(laid.points[..., k, None], theta.shape) for k in (0, 1))
    places = np.stack((rho * np.cos(theta), rho * np.sin(theta), z), axis=-1)
    numbers = len(mesh.nodes) + np.arange(theta.size).reshape(theta.shape)
    a, b = laid.on_rim.T
    shared = rim.inner >= 0
    numbers[a[:, None], b[:, None], np.arange(round_)] = np.where(shared, rim.inner, numbers[a, b])
    elements, cells = _elements(laid, numbers, rim.closed, step)
    count, first = len(elements), len(mesh.elements)
    everything = np.concatenate((mesh.nodes, places.reshape(-1, 3)))
    # the nodes of the rim keep their numbers
    kept = distinct(np.append(np.arange(len(mesh.nodes)), elements))
    whole = np.concatenate((mesh.elements, np.searchsorted(kept, elements)))
    sets = {name: faces for name, faces in mesh.face_sets.items() if name not in ("rim", "bore")}
    for name, faces in _faces(laid, cells, first, rim.closed, step).items():
        sets[name] = np.concatenate((sets[name], faces)) if name in sets else faces
    joined = HexMesh(everything[kept], whole, {}, {**mesh.element_sets, BODY_SET: first + np.arange(count)}, sets)
    joined = replace(joined, node_sets={name: joined.face_nodes(name) for name in sets})
    return _Joined(joined, np.where(np.isin(numbers, kept), np.searchsorted(kept, numbers), -1), places)


def _elements(laid: MeridianGrid, numbers: Index, closed: bool, step: int) -> tuple[Index, Index]:
    """Return the elements (E, 8 or 20), cell by cell, then around the axis, and their numbers (A, B, J) by cell; -1 for none."""
    around = numbers.shape[2] if closed else numbers.shape[2] - 1
    inside = laid.cells[::step, ::step]
    i, j = np.nonzero(inside)
    rounds = around // step
    corners = step * np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
    offsets = corners if step == 1 else np.concatenate((corners, corners[np.array(HEX_EDGES)].sum(axis=1) // 2))
    first, k, second = step * i[:, None, None], step * np.arange(rounds)[:, None], step * j[:, None, None]
    elements = numbers[first + offsets[:, 0], second + offsets[:, 2], (k + offsets[:, 1]) % numbers.shape[2]].reshape(
        -1, len(offsets)
    )
    cells = np.full((*inside.shape, rounds), -1)
    cells[i, j] = np.arange(len(elements)).reshape(len(i), rounds)
    return elements, cells


def _faces(laid: MeridianGrid, cells: Index, first: int, closed: bool, step: int) -> dict[str, Index]:
    """Return the face sets (n, 2) of the body, by the names of the outline's edges, and of its cut faces."""
    edges, sets = laid.edges, dict[str, list[Index]]()
    at = edges.first // step
    inner = at - np.where(edges.above, 0, 1)[:, None] * np.eye(2, dtype=np.int64)[edges.axis]
    # faces, as indices in `HEX_FACES`, at small and large rho, at small and large z
    face = np.where(edges.axis == 0, np.where(edges.above, 5, 3), np.where(edges.above, 0, 1))
    for name in dict.fromkeys(edges.names):
        named = np.array([edge_name == name for edge_name in edges.names])
        elements = cells[inner[named, 0], inner[named, 1]]
        sets.setdefault(name, []).append(_pairs(elements, np.repeat(face[named], cells.shape[2])))
    if not closed:
        there = cells[..., 0] >= 0
        for region, (number, which) in zip(CUT_REGIONS, ((0, 2), (-1, 4)), strict=True):
            elements = cells[there][:, number]
            sets.setdefault(region.value, []).append(_pairs(elements, np.full(elements.size, which)))
    return {name: np.concatenate(parts) + np.array([first, 0]) for name, parts in sets.items()}


def _pairs(elements: Index, faces: Index) -> Index:
    """Return pairs (n, 2) of element and face."""
    return np.stack((elements.ravel(), faces), axis=1)
