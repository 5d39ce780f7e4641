"""Deviation of a meshed tooth from its exact surfaces, in both directions, at many points between the vertices.

The mesher relies on a few estimates; this module measures the result. Every facet has 13 sample points, whose distances
from the surface are measured. Over every facet there are 10 exact surface points, whose distances from the facets are
measured.

Only the largest distance is needed. The distance to any point of the other side is an upper bound of the distance to
the closest point. Every sample therefore first gets such a bound. The closest point is computed in the order of the
bounds, and only where the bound is above the largest distance found until then.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot
from gearmesh.kernel.surface.nearest import nearest, tangential
from gearmesh.mesh.patch import PatchMesh, trim
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region

#: barycentric coordinates of the samples of a facet: 10 inside, and the middles of the edges
SAMPLE_WEIGHTS = np.array(
    [(i / 6, j / 6, (6 - i - j) / 6) for i in range(1, 5) for j in range(1, 6 - i)]
    + [(0.5, 0.5, 0.0), (0.0, 0.5, 0.5), (0.5, 0.0, 0.5)]
)
#: barycentric coordinates of the exact points over a facet
SURFACE_SAMPLE_WEIGHTS = SAMPLE_WEIGHTS[:10]
#: facets measured at once: as many as stay in the cache
FACETS_PER_BLOCK = 4_000
#: samples whose closest points are computed first
FIRST_BATCH = 64
#: growth of the batches after the first
BATCH_GROWTH = 4
#: stages of the search for the closest facet: 0 for facets along the strip, else the number of rings
SEARCH_RINGS = (0, 1, 2, 3)
#: distances, in facets, at which facets along the strip are tried on either side
STRIP_STEPS = np.array([0, 1, 2, 3, 4, 5, 6, 8, 10, 12, 16, 20, 24, 32, 48, 64])
#: difference of distances that count as the same
SAME_DISTANCE_MM = 1e-9


@dataclass(frozen=True)
class Deviation:
    """Largest distances (mm) of one link: from facets to surface, and from surface to facets."""

    facets_to_surface: float
    surface_to_facets: float

    @property
    def largest(self) -> float:
        return max(self.facets_to_surface, self.surface_to_facets)


def deviations(mesh: ToothMesh) -> dict[Region, Deviation]:
    """Return the largest distances for every link with an exact surface: flanks, fillets and lands."""
    around, by_region, first = _Around.of(mesh), {}, 0
    for patch in mesh.patches:
        if mesh.tooth.chain[patch.region].surface is not None:
            by_region[patch.region] = Deviation(_facets_to_surface(patch), _surface_to_facets(patch, around, first))
        first += len(patch.triangles)
    return by_region


@dataclass(frozen=True)
class _Around:
    """Facets of a tooth and, unless it is a part of a tooth, of both neighbours; the tooth's own facets come first.

    Where links join smoothly, a point of one link may lie over a facet of the next link.
    """

    #: corners (M, 3, 3) of the facets, mm
    corners: Array
    #: vertex numbers (M, 3) of the facets
    vertices: NDArray[np.int64]
    #: facets of every vertex, vertex after vertex
    facets_of: NDArray[np.int64]
    #: index in `facets_of` at which the facets of each vertex begin
    begins: NDArray[np.int64]

    @staticmethod
    def of(mesh: ToothMesh) -> _Around:
        welded = mesh.weld()
        count, pitch = len(welded.vertices), mesh.tooth.pitch_angle
        points = welded.vertices
        if mesh.whole:
            points = np.concatenate(
                [mesh.tooth.joint.to(turn).point(points) for turn in (0.0, pitch, -pitch, 2.0 * pitch)]
            )
            # vertices: this tooth k, next tooth count + k, previous tooth 2 count + k, next but one 3 count + k
            following = welded.triangles + count
            following[following >= 2 * count] += count
            before = np.where(welded.triangles < count, welded.triangles + 2 * count, welded.triangles - count)
            triangles = np.concatenate((welded.triangles, following, before))
        else:
            triangles = welded.triangles
        order = np.argsort(triangles.ravel(), kind="stable")
        begins = np.searchsorted(triangles.ravel()[order], np.arange(len(points) + 1))
        return _Around(points[triangles], triangles, order // 3, begins)

    def beside(self, facets: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
        """Return facets on either side of each of `facets` (A,) along its strip, and the owner of each, in order."""
        steps = np.concatenate((STRIP_STEPS, -STRIP_STEPS[1:]))
        numbers = np.clip(facets[:, None] + steps, 0, len(self.corners) - 1)
        return numbers.ravel(), np.repeat(np.arange(len(facets)), steps.size)

    def from_all(self, q: Array, distance: float) -> float:
        """Return the distance (mm) of a point (3,) from the closest of all facets, which is at most `distance`."""
        low, high = self._boxes
        outside = np.maximum(np.maximum(low - q, q - high), 0.0)
        near = np.flatnonzero((outside**2).sum(axis=1) < distance**2)
        return min(distance, float(triangle_distance(q, self.corners[near]).min())) if near.size else distance

    @cached_property
    def _boxes(self) -> tuple[Array, Array]:
        """Smallest and largest coordinates (M, 3) of the facets."""
        return self.corners.min(axis=1), self.corners.max(axis=1)

    def rings(self, facets: NDArray[np.int64], owner: NDArray[np.intp]) -> tuple[NDArray[np.int64], NDArray[np.intp]]:
        """Return the facets that share a vertex with `facets` (A,) of each owner (A,), once each, and their owners.

        Both are in the order of the owners.
        """
        corners, owner = self.vertices[facets].ravel(), np.repeat(owner, 3)
        sizes = self.begins[corners + 1] - self.begins[corners]
        places = np.arange(sizes.sum()) - np.repeat(np.cumsum(sizes) - sizes - self.begins[corners], sizes)
        pairs = distinct(np.repeat(owner, sizes) * len(self.corners) + self.facets_of[places])
        return pairs % len(self.corners), pairs // len(self.corners)


def _facets_to_surface(patch: PatchMesh) -> float:
    """Return the largest distance (mm) of the facets from the exact surface of a patch.

    If a search ends without a foot point, the surface may have ended before it, as a flank ends at its base. The next
    links then count, too.
    """
    nodes = patch.nodes
    surface = nodes.tooth.chain[patch.region].surface
    assert surface is not None
    assert nodes.parameters is not None
    worst = 0.0
    for start in range(0, len(patch.triangles), FACETS_PER_BLOCK):
        block = patch.triangles[start : start + FACETS_PER_BLOCK]
        q, uv = (
            (SAMPLE_WEIGHTS @ nodes.points[block]).reshape(-1, 3),
            (SAMPLE_WEIGHTS @ nodes.parameters[block]).reshape(-1, 2),
        )
        jet = surface.jet(*uv.T)
        ahead = uv + np.stack(tangential(jet, q - jet.r), axis=-1)
        # bound: distance from the start, or after one tangential step; infinite if neither is finite
        bound = np.fmin(np.fmin(_length(q - jet.r), _length(q - surface.jet(*ahead.T).r)), np.inf)
        t = (nodes.t[block] @ SAMPLE_WEIGHTS.T).ravel()

        def closest(
            which: NDArray[np.intp], least: float, q: Array = q, t: Array = t, uv: Array = ahead, bound: Array = bound
        ) -> Array:
            # the search may diverge where the surface is nearly singular
            foot = nearest(surface, q[which], *uv[which].T)
            foot_distance = _length(q[which] - foot.jet.r)
            distance = np.fmin(bound[which], foot_distance)
            lost = np.flatnonzero(
                (distance > least) & ~(foot.converged & (foot_distance <= distance + SAME_DISTANCE_MM))
            )
            if lost.size:
                distance[lost] = np.fmin(distance[lost], _beside(patch, q[which[lost]], t[which[lost]]))
            return distance

        worst = _largest(bound, closest, worst)
    return worst


def _beside(patch: PatchMesh, q: Array, t: Array) -> Array:
    """Return distances (M,) of points q (M, 3), at about t (M,), from the generated links next to the patch's link.

    Distances are inf where the foot point is not on these links.
    """
    tooth = patch.nodes.tooth
    regions, (toe, heel) = tooth.regions, tooth.blank.extent
    distance = np.full(len(q), np.inf)
    for number, end in ((regions.index(patch.region) + step, end) for step, end in ((-1, 1.0), (1, 0.0))):
        tooth_offset, k = divmod(number, len(regions))
        link = tooth.chain[regions[k]]
        if link.surface is None or not link.generated:
            continue
        turned = tooth.joint.to(-tooth_offset * tooth.pitch_angle).point(q)
        start = link.grid(np.full((1, len(q)), end), trim(tooth, t)).parameters[0]
        foot = nearest(link.surface, turned, *start.T)
        at = np.clip((np.asarray(tooth.blank.axial.value(foot.jet.r)) - toe) / (heel - toe), 0.0, 1.0)
        p_start, p_end = link.span(trim(tooth, np.where(foot.converged, at, t)))
        p = foot.values[:, 0]
        within = foot.converged & ((p - p_start) * (p - p_end) <= 0.0)
        distance = np.where(within, np.fmin(distance, _length(turned - foot.jet.r)), distance)
    return distance


def _surface_to_facets(patch: PatchMesh, around: _Around, first: int) -> float:
    """Return the largest distance (mm) of the exact surface of a patch from the facets.

    `first` is the number of the link's first facet among the facets of the tooth.
    """
    worst = 0.0
    for start in range(0, len(patch.triangles), FACETS_PER_BLOCK):
        points = patch.nodes.over(patch.triangles[start : start + FACETS_PER_BLOCK], SURFACE_SAMPLE_WEIGHTS)
        facet = first + start + np.arange(len(points))
        bound = triangle_distance(points, around.corners[facet][:, None]).ravel()
        q, at = points.reshape(-1, 3), np.repeat(facet, points.shape[1])

        def closest(which: NDArray[np.intp], least: float, q: Array = q, at: NDArray[np.intp] = at) -> Array:
            return _walk(q[which], at[which], around, least)

        worst = _largest(bound, closest, worst)
    return worst


def _walk(q: Array, at: NDArray[np.intp], around: _Around, least: float) -> Array:
    """Return distances (M,) of points q (M, 3) from the facets, by steps from facets `at` (M,) to ever closer facets.

    Among long and skew facets the closest one may be many facets away, with farther facets between. Points farther than
    `least` are therefore searched along the strip of their facet on either side first, then in rings around it.
    """
    at, distance = at.copy(), triangle_distance(q, around.corners[at])
    # each stage repeats until no point finds a closer facet
    for reach in SEARCH_RINGS:
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
    # steps may end before the closest facet: the farthest point is compared with all facets until it stays so
    checked = np.zeros(len(q), dtype=bool)
    while len(q):
        k = int(distance.argmax())
        if checked[k] or distance[k] <= least:
            break
        distance[k], checked[k] = around.from_all(q[k], distance[k]), True
    return distance


def _largest(bound: Array, closest: Callable[[NDArray[np.intp], float], Array], least: float) -> float:
    """Return the largest of distances (M,), each of which is at most its `bound` (M,), or `least` if this is larger.

    `closest` returns distances for given numbers. For a distance below the given limit it may return any value up to
    the limit.
    """
    candidates = np.flatnonzero(bound > least)
    order = candidates[np.argsort(-bound[candidates])]
    start, size = 0, FIRST_BATCH
    while start < order.size and bound[order[start]] > least:
        least = max(least, float(closest(order[start : start + size], least).max()))
        start, size = start + size, BATCH_GROWTH * size
    return least


def _length(w: Array) -> Array:
    return np.sqrt(dot(w, w))


def triangle_distance(q: Array, corners: Array) -> Array:
    """Return distances (...,), mm, of points q (..., 3) from triangles (..., 3, 3), which may be degenerate."""
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
