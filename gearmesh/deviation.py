"""How far a meshed tooth is from its exact surfaces, both ways, at many points between the vertices.

The mesher steers by a few estimates; this measures what came out: every facet is sampled at 13 points whose closest
surface points are solved for, every cell at 16 exact surface points whose distances to the facets are taken.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.frames import Array, Rigid, cross, dot
from gearmesh.nearest import nearest
from gearmesh.surface import Jet
from gearmesh.tessellate import PatchMesh, ToothMesh
from gearmesh.tooth import Sections

#: barycentric places on a facet: 10 inside and the middles of the edges
PLACES = np.array(
    [(i / 6, j / 6, (6 - i - j) / 6) for i in range(1, 5) for j in range(1, 6 - i)]
    + [(0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5)]
)
#: exact points inside a cell, as fractions across and along
INSIDE = np.array([0.125, 0.375, 0.625, 0.875])
#: facets measured at once, to bound the memory
BLOCK = 20_000


@dataclass(frozen=True)
class Deviation:
    """Largest distances (mm) of one link: facets from the surface, and surface from the facets."""

    facets_to_surface: float
    surface_to_facets: float

    @property
    def largest(self) -> float:
        return max(self.facets_to_surface, self.surface_to_facets)


def deviations(mesh: ToothMesh) -> dict[str, Deviation]:
    """Largest distances for every link with an exact surface: flanks, fillets and lands."""
    chain = _chain(mesh)
    nodes = mesh.tooth.sections(mesh.t)
    between = mesh.tooth.sections((mesh.t[:-1, None] + np.diff(mesh.t)[:, None] * INSIDE).ravel())
    found, first = {}, 1
    for patch in mesh.patches:
        last = first + patch.rising.shape[0]
        if mesh.tooth.surface(patch.region) is not None:
            nearby = chain[first - 1 : last + 1]
            found[patch.region] = Deviation(
                _facets_to_surface(mesh, patch, nodes), _surface_to_facets(mesh, patch, nearby, between)
            )
        first = last
    return found


def _chain(mesh: ToothMesh) -> Array:
    """Facets (S + 2, T, 2, 3, 3) of all links in order, with the neighbouring teeth's next ones before and after.

    Where links pass smoothly into each other, a point of one may lie over a facet of the next. A mesh of a part of the
    chain has no neighbours: its own first and last cells are repeated.
    """
    links = np.concatenate([_facets(patch.points, patch) for patch in mesh.patches])
    before, after = links[-1:], links[:1]
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
    surface = mesh.tooth.surface(patch.region)
    assert surface is not None
    grid = mesh.tooth.grid(patch.region, patch.s, nodes)
    assert grid.p is not None
    assert grid.v is not None
    corners = _facets(patch.points, patch).reshape(-1, 3, 3)
    parameters = _facets(np.stack((grid.p, grid.v), axis=-1), patch).reshape(-1, 3, 2)
    worst = 0.0
    for start in range(0, len(corners), BLOCK):
        block = slice(start, start + BLOCK)
        q, uv = PLACES @ corners[block], PLACES @ parameters[block]
        jet = nearest(surface, q, uv[..., 0], uv[..., 1])[2]
        worst = max(worst, _largest(q - jet.r))
    return worst


def _surface_to_facets(mesh: ToothMesh, patch: PatchMesh, nearby: Array, between: Sections) -> float:
    """`nearby` (S + 2, T, 2, 3, 3): facets of this link's cells, and of the cells before and after it in the chain."""
    s = (patch.s[:-1, None] + np.diff(patch.s)[:, None] * INSIDE).ravel()
    exact = mesh.tooth.grid(patch.region, s, between).points
    k, count = len(INSIDE), len(patch.s) - 1
    cells = exact.reshape(count, k, mesh.t.size - 1, k, 3).swapaxes(1, 2).reshape(-1, k * k, 3)
    facets = np.concatenate([nearby[shift : shift + count] for shift in (1, 0, 2)], axis=2).reshape(-1, 6, 3, 3)
    worst = 0.0
    for start in range(0, len(cells), BLOCK):
        block = slice(start, start + BLOCK)
        distance = triangle_distance(cells[block], facets[block, None, 0])
        for which in range(1, 6):
            distance = np.minimum(distance, triangle_distance(cells[block], facets[block, None, which]))
        worst = max(worst, float(distance.max()))
    return worst


def _largest(w: Array) -> float:
    return float(np.sqrt(dot(w, w).max()))


def triangle_distance(q: Array, corners: Array) -> Array:
    """Distances (...,) of points q (..., 3) from triangles (..., 3, 3), in mm."""
    a, b, c = corners[..., 0, :], corners[..., 1, :], corners[..., 2, :]
    facet = Jet(a, a, b - a, c - a, a, a)
    normal = cross(facet.r_u, facet.r_v)
    normal = normal / np.sqrt(dot(normal, normal))[..., None]
    height = dot(q - a, normal)
    inside = np.ones(height.shape, dtype=bool)
    edge_distance = np.full(height.shape, np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        along = end - start
        inside &= dot(cross(normal, along), q - start) >= 0.0
        share = np.clip(dot(q - start, along) / dot(along, along), 0.0, 1.0)
        off = q - start - share[..., None] * along
        edge_distance = np.minimum(edge_distance, np.sqrt(dot(off, off)))
    return np.where(inside, np.abs(height), edge_distance)
