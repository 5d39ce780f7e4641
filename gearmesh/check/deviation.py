"""How far a meshed tooth is from its exact surfaces, both ways, at many points between the vertices.

The mesher steers by a few estimates; this measures what came out: every facet is sampled at 13 points whose distances
from the surface are taken, and over every facet there are 10 exact surface points whose distances from the facets are.

Only the largest distance is asked for. Any point of the other side is at least as far as the closest one, so every
sample first gets such a bound, and the closest point is only sought, in the order of the bounds, where the bound is above
the largest distance found until then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot
from gearmesh.kernel.surface.nearest import nearest, tangential
from gearmesh.mesh.patch import PatchMesh, trim
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.teeth.region import Region

#: barycentric places on a facet: 10 inside and the middles of the edges
PLACES = np.array(
    [(i / 6, j / 6, (6 - i - j) / 6) for i in range(1, 5) for j in range(1, 6 - i)]
    + [(0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5)]
)
#: of these, where the exact points over a facet are
INSIDE = PLACES[:10]
#: facets measured at once: as many as stay in the cache (20,000 take twice the time on a worm)
BLOCK = 4_000
#: samples whose closest points are sought at first, and by how much more of them every further time
BATCH, MORE = 64, 4
#: where the closest facet is sought, one after the other: 0 so many facets along the strip on either side, else so many rings
REACHES = (0, 1, 2, 3)
STEPS = np.array([0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64])
#: distances (mm) that differ by no more are the same
TOLERANCE = 1e-9


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
    around, by_region, first = _Around.of(mesh), {}, 0
    for patch in mesh.patches:
        if mesh.tooth.chain[patch.region].surface is not None:
            by_region[patch.region] = Deviation(_facets_to_surface(patch), _surface_to_facets(patch, around, first))
        first += len(patch.triangles)
    return by_region


@dataclass(frozen=True)
class _Around:
    """Facets (M, 3, 3) of a tooth and, unless it is a part of one, of both its neighbours, the tooth's own first.

    `facets_of`: the facets of every vertex, one after the other, those of vertex k from `begins`[k] on; `vertices` (M, 3).
    Where links pass smoothly into each other, a point of one may lie over a facet of the next.
    """

    corners: Array
    vertices: NDArray[np.int64]
    facets_of: NDArray[np.int64]
    begins: NDArray[np.int64]

    @staticmethod
    def of(mesh: ToothMesh) -> _Around:
        one = mesh.weld()
        count, pitch = len(one.vertices), mesh.tooth.pitch_angle
        points = one.vertices
        if mesh.whole:
            points = np.concatenate(
                [mesh.tooth.joint.to(turn).point(points) for turn in (0.0, pitch, -pitch, 2.0 * pitch)]
            )
            # the next tooth's vertices are count + k, those of the one before come after them, and of the one after the next
            following = one.triangles + count
            following[following >= 2 * count] += count
            before = np.where(one.triangles < count, one.triangles + 2 * count, one.triangles - count)
            triangles = np.concatenate((one.triangles, following, before))
        else:
            triangles = one.triangles
        order = np.argsort(triangles.ravel(), kind="stable")
        begins = np.searchsorted(triangles.ravel()[order], np.arange(len(points) + 1))
        return _Around(points[triangles], triangles, order // 3, begins)

    def beside(self, facets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
        """Facets on either side, along their strip, of each of `facets` (A,), and the owner of each, in order."""
        steps = np.concatenate((STEPS, -STEPS[1:]))
        numbers = np.clip(facets[:, None] + steps, 0, len(self.corners) - 1)
        return numbers.ravel(), np.repeat(np.arange(len(facets)), steps.size)

    def from_all(self, q: Array, distance: float) -> float:
        """Distance (mm) of a point (3,) from the closest of all facets, which is at most `distance`."""
        low, high = self._boxes
        outside = np.maximum(np.maximum(low - q, q - high), 0.0)
        near = np.flatnonzero((outside**2).sum(axis=1) < distance**2)
        return min(distance, float(triangle_distance(q, self.corners[near]).min())) if near.size else distance

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """Least and greatest coordinates (M, 3) of the facets."""
        return self.corners.min(axis=1), self.corners.max(axis=1)

    def rings(self, facets: NDArray[np.int64], owner: NDArray[np.intp]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
        """The facets that share a vertex with `facets` (A,) of each owner (A,), once each, and their owners, in order."""
        corners, owner = self.vertices[facets].ravel(), np.repeat(owner, 3)
        sizes = self.begins[corners + 1] - self.begins[corners]
        places = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes - self.begins[corners], sizes)
        pairs = distinct(np.repeat(owner, sizes) * len(self.corners) + self.facets_of[places])
        return pairs % len(self.corners), pairs // len(self.corners)


def _facets_to_surface(patch: PatchMesh) -> float:
    """Where a search ends without a foot the surface may be at its end, as a flank at its base: then the next links count, too."""
    nodes = patch.nodes
    surface = nodes.tooth.chain[patch.region].surface
    assert surface is not None
    assert nodes.parameters is not None
    worst = 0.0
    for start in range(0, len(patch.triangles), BLOCK):
        block = patch.triangles[start : start + BLOCK]
        q, uv = (PLACES @ nodes.points[block]).reshape(-1, 3), (PLACES @ nodes.parameters[block]).reshape(-1, 2)
        jet = surface.jet(*uv.T)
        ahead = uv + np.stack(tangential(jet, q - jet.r), axis=-1)
        # where the step leads nowhere the start stands, and where there is none either nothing is known
        bound = np.fmin(np.fmin(_length(q - jet.r), _length(q - surface.jet(*ahead.T).r)), np.inf)
        t = (nodes.t[block] @ PLACES.T).ravel()

        def closest(
            which: NDArray[np.intp], least: float, q: Array = q, t: Array = t, uv: Array = ahead, bound: Array = bound
        ) -> Array:
            # where the surface is all but singular the search may lead away
            foot = nearest(surface, q[which], *uv[which].T)
            away = _length(q[which] - foot.jet.r)
            distance = np.fmin(bound[which], away)
            lost = np.flatnonzero((distance > least) & ~(foot.converged & (away <= distance + TOLERANCE)))
            if lost.size:
                distance[lost] = np.fmin(distance[lost], _beside(patch, q[which[lost]], t[which[lost]]))
            return distance

        worst = _largest(bound, closest, worst)
    return worst


def _beside(patch: PatchMesh, q: Array, t: Array) -> Array:
    """Distances (M,) of points q (M, 3), at about t (M,), from the generated links next to the patch's; inf where they are not."""
    tooth = patch.nodes.tooth
    regions, (toe, heel) = tooth.regions, tooth.blank.extent
    distance = np.full(len(q), np.inf)
    for place, end in ((regions.index(patch.region) + step, end) for step, end in ((-1, 1.0), (1, 0.0))):
        over, k = divmod(place, len(regions))
        link = tooth.chain[regions[k]]
        if link.surface is None or not link.generated:
            continue
        turned = tooth.joint.to(-over * tooth.pitch_angle).point(q)
        start = link.grid(np.full((1, len(q)), end), trim(tooth, t)).parameters[0]
        foot = nearest(link.surface, turned, *start.T)
        at = np.clip((np.asarray(tooth.blank.axial.value(foot.jet.r)) - toe) / (heel - toe), 0.0, 1.0)
        first, last = link.span(trim(tooth, np.where(foot.converged, at, t)))
        p = foot.values[:, 0]
        within = foot.converged & ((p - first) * (p - last) <= 0.0)
        distance = np.where(within, np.fmin(distance, _length(turned - foot.jet.r)), distance)
    return distance


def _surface_to_facets(patch: PatchMesh, around: _Around, first: int) -> float:
    """`first`: number of the link's first facet among those of the tooth."""
    worst = 0.0
    for start in range(0, len(patch.triangles), BLOCK):
        points = patch.nodes.over(patch.triangles[start : start + BLOCK], INSIDE)
        own = first + start + np.arange(len(points))
        bound = triangle_distance(points, around.corners[own][:, None]).ravel()
        q, at = points.reshape(-1, 3), np.repeat(own, points.shape[1])

        def closest(which: NDArray[np.intp], least: float, q: Array = q, at: NDArray[np.intp] = at) -> Array:
            return _walk(q[which], at[which], around, least)

        worst = _largest(bound, closest, worst)
    return worst


def _walk(q: Array, at: NDArray[np.intp], around: _Around, least: float) -> Array:
    """Distances (M,) of points q (M, 3) from the facets, by steps from facets `at` (M,) to ever closer ones.

    Where facets are long and skew, the one that is closest to a point may be many away from its own, and those between
    farther away than both: points farther than `least` look along the strip of their facet on either side, then round it.
    """
    at, distance = at.copy(), triangle_distance(q, around.corners[at])
    for reach in REACHES:
        active = np.flatnonzero(distance > least)
        while active.size:
            facets, owner = around.beside(at[active]) if reach == 0 else (at[active], np.arange(active.size))
            for _ in range(reach):
                facets, owner = around.rings(facets, owner)
            away = triangle_distance(q[active[owner]], around.corners[facets])
            closest = np.minimum.reduceat(away, np.searchsorted(owner, np.arange(active.size)))
            first = np.flatnonzero(away == closest[owner])
            at[active] = facets[first[np.searchsorted(owner[first], np.arange(active.size))]]
            better = closest < distance[active]
            distance[active] = closest
            active = active[better & (closest > least)]
    # steps may end before the closest facet: what is reported as the farthest point is held against all of them
    known = np.zeros(len(q), dtype=bool)
    while len(q):
        k = int(distance.argmax())
        if known[k] or distance[k] <= least:
            break
        distance[k], known[k] = around.from_all(q[k], distance[k]), True
    return distance


def _largest(bound: Array, closest: Callable[[NDArray[np.intp], float], Array], least: float) -> float:
    """Largest of distances (M,) of which each is at most its `bound` (M,), or `least`.

    `closest` gives those asked for, or anything between those that are below the given number and that number.
    """
    open_ = np.flatnonzero(bound > least)
    order = open_[np.argsort(-bound[open_])]
    start, size = 0, BATCH
    while start < order.size and bound[order[start]] > least:
        least = max(least, float(closest(order[start : start + size], least).max()))
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
