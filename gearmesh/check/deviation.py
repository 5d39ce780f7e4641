"""How far a meshed tooth is from its exact surfaces, both ways, at many points between the vertices.

The mesher steers by a few estimates; this measures what came out: every facet is sampled at 13 points whose distances
from the surface are taken, every cell at 16 exact surface points whose distances from the facets are.

Only the largest distance is asked for. Any point of the other side is at least as far as the closest one, so every
sample first gets such a bound, and the closest point is only sought, in the order of the bounds, where the bound is above
the largest distance found until then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.algebra import Array, cross, dot
from gearmesh.kernel.nearest import nearest, tangential
from gearmesh.kernel.rigid import Rigid
from gearmesh.mesh.tessellate import PatchMesh, ToothMesh
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections

#: barycentric places on a facet: 10 inside and the middles of the edges
PLACES = np.array(
    [(i / 6, j / 6, (6 - i - j) / 6) for i in range(1, 5) for j in range(1, 6 - i)]
    + [(0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5)]
)
#: exact points inside a cell, as fractions across and along
INSIDE = np.array([0.125, 0.375, 0.625, 0.875])
#: facets or cells measured at once: as many as stay in the cache (20,000 take twice the time on a worm)
BLOCK = 4_000
#: samples whose closest points are sought at first, and by how much more of them every further time
BATCH, MORE = 64, 4
#: columns of the neighbouring teeth's cells that may be closest to a point
BESIDE = 4
#: a cell and those round it, as steps (9, 2) in either direction
AROUND = np.array([(i, j) for i in (0, -1, 1) for j in (0, -1, 1)])


@dataclass(frozen=True)
class Deviation:
    """Largest distances (mm) of one link: facets from the surface, and surface from the facets."""

    facets_to_surface: float
    surface_to_facets: float

    @property
    def largest(self) -> float:
        return max(self.facets_to_surface, self.surface_to_facets)


def deviations(mesh: ToothMesh) -> dict[Region, Deviation]:
    """Largest distances for every link with an exact surface: flanks, fillets and lands."""
    chain = _chain(mesh)
    nodes = mesh.tooth.sections(mesh.t)
    between = mesh.tooth.sections((mesh.t[:-1, None] + np.diff(mesh.t)[:, None] * INSIDE).ravel())
    found, first = {}, BESIDE
    for patch in mesh.patches:
        last = first + patch.rising.shape[0]
        if mesh.tooth.chain[patch.region].surface is not None:
            found[patch.region] = Deviation(
                _facets_to_surface(mesh, patch, nodes), _surface_to_facets(mesh, patch, chain, first, between)
            )
        first = last
    return found


def _chain(mesh: ToothMesh) -> Array:
    """Facets (S + 2 BESIDE, T, 2, 3, 3) of all links in order, with the neighbouring teeth's next ones before and after.

    Where links pass smoothly into each other, a point of one may lie over a facet of the next. A mesh of a part of the
    chain has no neighbours: its own first and last cells are repeated.
    """
    links = np.concatenate([_facets(patch.points, patch) for patch in mesh.patches])
    wrapped = np.arange(BESIDE) % len(links)
    before, after = links[::-1][wrapped][::-1], links[wrapped]
    if len(mesh.patches) == len(mesh.tooth.regions):
        pitch = mesh.tooth.pitch_angle
        before, after = Rigid.about_z(-pitch).point(before), Rigid.about_z(pitch).point(after)
    else:
        before, after = after, before
    return np.concatenate((before, links, after))


def _facets(values: Array, patch: PatchMesh) -> Array:
    """Corner values (S, T, 2, 3, ...) of the two facets of every cell, from node values (S+1, T+1, ...)."""
    a, b, c, d = values[:-1, :-1], values[1:, :-1], values[1:, 1:], values[:-1, 1:]
    up = patch.rising.reshape(patch.rising.shape + (1,) * (values.ndim - 2))
    first = np.stack((a, b, np.where(up, c, d)), axis=2)
    second = np.stack((np.where(up, a, b), c, d), axis=2)
    return np.stack((first, second), axis=2)


def _facets_to_surface(mesh: ToothMesh, patch: PatchMesh, nodes: Sections) -> float:
    surface = mesh.tooth.chain[patch.region].surface
    assert surface is not None
    grid = mesh.tooth.grid(patch.region, patch.s, nodes)
    corners = _facets(patch.points, patch).reshape(-1, 3, 3)
    parameters = _facets(grid.parameters, patch).reshape(-1, 3, 2)
    worst = 0.0
    for start in range(0, len(corners), BLOCK):
        block = slice(start, start + BLOCK)
        q, uv = (PLACES @ corners[block]).reshape(-1, 3), (PLACES @ parameters[block]).reshape(-1, 2)
        jet = surface.jet(*uv.T)
        ahead = uv + np.stack(tangential(jet, q - jet.r), axis=-1)
        # where the step leads nowhere the start stands, and where there is none either nothing is known
        bound = np.fmin(np.fmin(_length(q - jet.r), _length(q - surface.jet(*ahead.T).r)), np.inf)

        def closest(which: NDArray[np.intp], q: Array = q, uv: Array = ahead, bound: Array = bound) -> Array:
            # where the surface is all but singular the search may lead away
            return np.fmin(bound[which], _length(q[which] - nearest(surface, q[which], *uv[which].T).jet.r))

        worst = _largest(bound, closest, worst)
    return worst


def _surface_to_facets(mesh: ToothMesh, patch: PatchMesh, chain: Array, first: int, between: Sections) -> float:
    """`first`: number of the column of `chain` (see `_chain`) with which the link begins."""
    s = (patch.s[:-1, None] + np.diff(patch.s)[:, None] * INSIDE).ravel()
    exact = mesh.tooth.grid(patch.region, s, between).points
    k, (count, rows) = len(INSIDE), patch.rising.shape
    points = exact.reshape(count, k, rows, k, 3).swapaxes(1, 2).reshape(-1, k * k, 3)
    cells = np.stack(np.meshgrid(first + np.arange(count), np.arange(rows), indexing="ij"), axis=-1).reshape(-1, 2)
    worst = 0.0
    for start in range(0, len(cells), BLOCK):
        block = slice(start, start + BLOCK)
        own = chain[cells[block, 0], cells[block, 1]][:, None]
        bound = np.minimum(*(triangle_distance(points[block], own[:, :, which]) for which in (0, 1))).ravel()
        q, at = points[block].reshape(-1, 3), np.repeat(cells[block], k * k, axis=0)

        def closest(which: NDArray[np.intp], q: Array = q, at: NDArray[np.intp] = at) -> Array:
            return _walked(q[which], at[which], chain)

        worst = _largest(bound, closest, worst)
    return worst


def _walked(q: Array, at: NDArray[np.intp], chain: Array) -> Array:
    """Distances (M,) of points q (M, 3) from the facets, by steps from cells `at` (M, 2) to ever closer neighbours.

    Where cells are long and skew, the facet that is closest to a point of one cell may be several cells away.
    """
    at, distance, active = at.copy(), np.full(len(q), np.inf), np.arange(len(q))
    last = np.array(chain.shape[:2]) - 1
    while active.size:
        cells = np.clip(at[active, None] + AROUND, 0, last)
        facets = chain[cells[..., 0], cells[..., 1]]
        around = triangle_distance(q[active, None, None], facets).min(axis=-1)
        best, rows = around.argmin(axis=-1), np.arange(active.size)
        distance[active] = around[rows, best]
        at[active] = cells[rows, best]
        # the first of those round a cell is the cell itself
        active = active[best != 0]
    return distance


def _largest(bound: Array, closest: Callable[[NDArray[np.intp]], Array], least: float) -> float:
    """Largest of distances (M,) of which each is at most its `bound` (M,), or `least`; `closest` gives those asked for."""
    open_ = np.flatnonzero(bound > least)
    order = open_[np.argsort(-bound[open_])]
    start, size = 0, BATCH
    while start < order.size and bound[order[start]] > least:
        least = max(least, float(closest(order[start : start + size]).max()))
        start, size = start + size, MORE * size
    return least


def _length(w: Array) -> Array:
    return np.sqrt(dot(w, w))


def triangle_distance(q: Array, corners: Array) -> Array:
    """Distances (...,) of points q (..., 3) from triangles (..., 3, 3), in mm; also from those that are lines or points."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    normal = cross(b - a, c - a)
    with np.errstate(invalid="ignore"):
        normal = normal / np.sqrt(dot(normal, normal))[..., None]
    height = dot(q - a, normal)
    inside = np.ones(height.shape, dtype=bool)
    edge_distance = np.full(height.shape, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        inside &= dot(cross(normal, along), q - start) >= 0.0
        length = dot(along, along)
        share = np.clip(dot(q - start, along) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        off = q - start - share[..., None] * along
        edge_distance = np.minimum(edge_distance, np.sqrt(dot(off, off)))
    return np.where(inside, np.abs(height), edge_distance)
