"""Mesh of the body under the teeth: end faces from the toothed outline inwards, bore and back.

The body is a profile of points (rho, z) (see `teeth.blank.body`); each point becomes a ring of vertices. A toothed end face lies on
a station surface: a plane, the front or back cone of a bevel gear, or the inner or outer cylinder of a face gear. It is
triangulated in a plane chart in which the generatrices of the station are rays and polar angles stay. On a plane any
triangles do. On cones and cylinders edges follow the rays, which needs no vertices besides those of outline and ring. If that
is not possible, the triangles are split until their inner edges are within the tolerance of the station. Edges shared with
teeth and neighbours are never split.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import KindError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.mesh.ring import TeethRing
from gearmesh.mesh.strip_triangulation import MIN_GAIN_MM, Miss, StripTriangulation
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Body, end_regions
from gearmesh.teeth.blank.halves import HalfEnd
from gearmesh.teeth.region import BODY_REGIONS, FEATURE_REGIONS, GAP_REGIONS, RARE_REGIONS

#: guard of the splitting of edges; each round splits the edges that are the worst of both their triangles
MAX_SPLITTING_ROUNDS = 10_000
#: largest distance of a new vertex from its station, as a share of the largest coordinate; farther off, halves of an edge
#: would miss the station as much as the edge
MAX_STATION_MISS_SHARE = 1e-8
#: rounds of turning the edges of an end face; each round can save inner vertices
TURNING_ROUNDS = 8
#: step of the grid on which polygons are triangulated, as a share of their largest coordinate
TRIANGULATION_STEP = 2.0**-24
#: distance of two rings on a plane, in tolerances, below which both have the same number of points
NARROW_RING_TOLERANCES = 4.0

Index = NDArray[np.int64]


@dataclass(frozen=True)
class BodyMesh:
    """Mesh of the body under the teeth."""

    #: vertices (V, 3), mm, besides those of the teeth
    vertices: Array
    #: triangles (n, 3); indices below the number of the teeth's vertices are vertices of the teeth
    triangles: Index
    #: regions (n,), as indices in BODY_, RARE_, GAP_ and FEATURE_REGIONS, one after the other
    regions: NDArray[np.int32]
    #: sizes (R,) of the groups of vertices: a ring, or the inner vertices of an end face, tooth by tooth
    rings: tuple[int, ...]
    #: sizes (B,) of the groups of triangles, each tooth by tooth
    blocks: tuple[int, ...]

    def join(self, other: BodyMesh, offset: int) -> BodyMesh:
        """Return this body and another one of the same teeth, which have `offset` vertices."""
        shift = np.where(other.triangles < offset, 0, len(self.vertices))
        return BodyMesh(
            np.concatenate((self.vertices, other.vertices)),
            np.concatenate((self.triangles, other.triangles + shift)),
            np.concatenate((self.regions, other.regions)),
            (*self.rings, *other.rings),
            (*self.blocks, *other.blocks),
        )


def gear_body(
    round_axis: TeethRing, ends: tuple[HalfEnd, HalfEnd], level: Level, body: Body, tolerance: float
) -> BodyMesh:
    """Return the body that closes the teeth between two ends of their halves.

    - round_axis: all teeth; their vertices come first.
    - ends: ends at the toe and at the heel.
    - level: axial station of points.
    - body: profile of the body.
    - tolerance: largest distance, mm, of the end faces from their stations.
    """
    teeth, profile, first = round_axis.teeth, body.profile, round_axis.kinds[0]
    corner = first.vertices[first.end(ends[0])[0]]
    start = float(np.arctan2(corner[1], corner[0]))
    counts = ring_counts(teeth, profile, tolerance)
    firsts = [int(f) for f in round_axis.size + np.concatenate(([0], np.cumsum(counts)))]
    vertices = []
    for (rho, z), count in zip(profile, counts, strict=True):
        angle = start + 2.0 * np.pi * np.arange(count) / count
        vertices.append(np.column_stack((rho * np.cos(angle), rho * np.sin(angle), np.full(count, z))))
    triangles, regions = [], []
    added = firsts[-1]
    for end, k in ((0, 0), (1, len(profile) - 1)):
        corner = first.vertices[first.end(ends[end])[0]]
        per_tooth = counts[k] // teeth if counts[k] > 1 else 0  # a single centre is no ring, of one tooth either
        shift = round((float(np.arctan2(corner[1], corner[0])) - start) * counts[k] / (2.0 * np.pi))
        turns = (shift + np.arange(per_tooth, -1, -1)) if per_tooth else np.zeros(1, dtype=np.int64)
        for kind, tooth in enumerate(round_axis.kinds):
            row, places = tooth.end(ends[end]), round_axis.places(kind)[:, None]
            chain = tooth.vertices[row]
            chain = np.concatenate((chain, (Rigid.about_z(round_axis.pitch).rotation @ chain[0])[None]))
            sector = _end_face(chain, vertices[k][turns % counts[k]], level, profile[k], tolerance)
            outer = round_axis.numbers(kind, np.append(row, len(tooth.vertices) + row[0]))
            inner = firsts[k] + (turns + places * per_tooth) % counts[k]
            fresh = added + np.arange(len(places) * len(sector.added)).reshape(len(places), -1)
            vertices.append(round_axis.turn(kind, sector.added))
            added += fresh.size
            face = np.concatenate((outer, inner, fresh), axis=1)[:, sector.triangles].reshape(-1, 3)
            # one tooth follows itself: triangles at the cut from its rim to the axis have a vertex twice
            face = face[(face != np.roll(face, 1, axis=1)).all(axis=1)]
            triangles.append(face if end else face[:, ::-1])
            regions.append(end_regions(level)[end])
    for k, name in enumerate(body.bands):
        if counts[k] > 1 or counts[k + 1] > 1:
            triangles.append(band_triangles(firsts[k], counts[k], firsts[k + 1], counts[k + 1]))
            regions.append(name)
    listed = (*BODY_REGIONS, *RARE_REGIONS, *GAP_REGIONS, *FEATURE_REGIONS)
    labels = np.repeat(
        [listed.index(name) for name in regions],
        [len(t) for t in triangles],
    )
    rings, blocks = (tuple(len(part) for part in parts) for parts in (vertices, triangles))
    return BodyMesh(np.concatenate(vertices), np.concatenate(triangles), labels.astype(np.int32), rings, blocks)


def ring_count(teeth: int, radius: float, tolerance: float) -> int:
    """Return the number of points on a circle with chords within the tolerance, a multiple of the number of teeth."""
    if radius == 0.0:
        return teeth
    step = 2.0 * np.arccos(max(1.0 - tolerance / radius, 0.5))
    return teeth * max(1, int(np.ceil(2.0 * np.pi / step / teeth)))


def ring_counts(teeth: int, profile: Sequence[tuple[float, float]], tolerance: float) -> list[int]:
    """Return the number of points on the ring of each point (rho, z) of a profile, by its radius; 1 on the axis.

    Both rings of a cone have equal numbers, so that edges stay as close to the cone as chords. Both rings of a narrow plane
    have equal numbers, so that chords of the outer ring do not cross the inner ring.
    """
    counts = [ring_count(teeth, rho, tolerance) if rho > 0.0 else 1 for rho, _ in profile]
    pairs = list(enumerate(pairwise(profile)))
    for k, ((rho, z), (other, end)) in (*pairs, *reversed(pairs)):
        if min(rho, other) > 0.0 and (z != end or abs(rho - other) < NARROW_RING_TOLERANCES * tolerance):
            counts[k] = counts[k + 1] = max(counts[k : k + 2])
    return counts


def band_triangles(low: int, low_count: int, high: int, high_count: int) -> Index:
    """Return the triangles between two rings of vertices that begin at the same polar angle; a ring may be a single centre."""
    low_steps, high_steps = low_count - (low_count == 1), high_count - (high_count == 1)
    ahead = np.concatenate((np.arange(1, low_steps + 1) * high_count, np.arange(1, high_steps + 1) * low_count))
    on_low = np.argsort(ahead, kind="stable") < low_steps
    i: Index = np.cumsum(on_low) - on_low
    j: Index = np.cumsum(~on_low) - ~on_low
    following = np.where(on_low, low + (i + 1) % low_count, high + (j + 1) % high_count)
    return np.stack((low + i % low_count, high + j % high_count, following), axis=1)


@dataclass(frozen=True)
class _Sector:
    """Part of an end face that belongs to one tooth."""

    #: triangles (n, 3) of the polygon's vertices, then of the added ones
    triangles: Index
    #: added vertices (m, 3), mm
    added: Array


def _end_face(chain: Array, inner: Array, level: Level, ring: tuple[float, float], tolerance: float) -> _Sector:
    """Return the triangles between the outline of a tooth (C, 3) and its part of the ring (P, 3), both on one station."""
    across, along = station_normal(level)
    # direction of the generatrix outwards, in (rho, z)
    out = np.array([along, -across])

    def chart(r: Array) -> Array:
        """Return points (N, 2) of the chart for points (N, 3)."""
        rho = np.hypot(r[:, 0], r[:, 1])
        radius = ring[0] + out[0] * (rho - ring[0]) + out[1] * (r[:, 2] - ring[1])
        with np.errstate(invalid="ignore", divide="ignore"):
            flat = r[:, :2] * (radius / rho)[:, None]
        return np.where(rho[:, None] > 0.0, flat, 0.0)

    def lift(q: Array) -> Array:
        """Return points (N, 3) on the station for points (N, 2) of the chart."""
        radius = np.hypot(q[:, 0], q[:, 1])
        rho, z = ring[0] + out[0] * (radius - ring[0]), ring[1] + out[1] * (radius - ring[0])
        return np.column_stack((q * (rho / radius)[:, None], z))

    r = np.concatenate((chain, inner))
    q, polygon = chart(r), len(r)
    station = float(level.value(chain[0]))

    def miss_of(r: Array) -> Miss:
        """Return the function of distances of edges from the station."""
        return lambda edges: np.abs(np.asarray(level.value(0.5 * (r[edges[:, 0]] + r[edges[:, 1]]))) - station)

    triangles = triangulate(q) if across == 0.0 else _spokes(q, len(chain), miss_of(r))
    triangles, r = split_long(triangles, (q, r), level, lift, tolerance)
    return _Sector(without_needles(triangles, chart(r), r, miss_of(r), tolerance), r[polygon:])


def split_long(
    triangles: Index, points: tuple[Array, Array], level: Level, lift: Callable[[Array], Array], tolerance: float
) -> tuple[Index, Array]:
    """Return triangles whose inner edges are within the tolerance, mm, of their station, and the points of all.

    - triangles: (n, 3).
    - points: points in a chart of the station (N, 2), and in space (N, 3).
    - level: axial station of points.
    - lift: function from the chart to space.

    Raises KindError if the chart does not lift to the station: then no splitting would end.
    """
    q, r = points
    station = float(level.value(r[0]))
    for _ in range(MAX_SPLITTING_ROUNDS):
        edges, owners = _inner_edges(triangles)
        miss = np.abs(np.asarray(level.value(0.5 * (r[edges[:, 0]] + r[edges[:, 1]]))) - station)
        chosen = _worst_of_both(miss, owners, len(triangles), tolerance)
        if not chosen.size:
            break
        middle = 0.5 * (q[edges[chosen, 0]] + q[edges[chosen, 1]])
        lifted = lift(middle)
        off = float(np.abs(np.asarray(level.value(lifted)) - station).max())
        if not off <= MAX_STATION_MISS_SHARE * float(np.abs(lifted).max()):
            raise KindError(
                "end face",
                reason=f"its triangles are {off:.3g} mm off the station {station:.6g} mm",
                must_be="a plane, cone or cylinder about the axis through teeth and body",
            )
        triangles = _split(triangles, edges[chosen], owners[chosen], len(q))
        q, r = np.concatenate((q, middle)), np.concatenate((r, lifted))
    else:
        raise NoSolutionError(
            "end face", reason=f"{MAX_SPLITTING_ROUNDS} rounds of splitting do not bring it within the tolerance"
        )
    return triangles, r


def _spokes(polygon: Array, outer: int, miss: Miss) -> Index:
    """Return the triangles (n, 3) of a polygon between an outline and a ring, with edges along generatrices.

    The first `outer` vertices of the polygon go around the axis, the others go back, closer to the axis. Edges along the
    generatrices of cones and cylinders stay on the surface: they join outline and ring at about the same polar angle. If the
    outline turns back, as around an undercut, this may be impossible, and any triangles are taken.
    """
    if len(polygon) - outer < 2:
        return triangulate(polygon)
    angle = np.unwrap(np.arctan2(polygon[:, 1], polygon[:, 0]))
    none: Index = np.zeros(0, dtype=np.int64)
    numbers = np.arange(len(polygon))
    plain = StripTriangulation.of([numbers[outer:][::-1], numbers[:outer]], [none], [none], angle, miss)
    turned = plain
    for _ in range(TURNING_ROUNDS):
        turned = turned.flip(miss)
    for triangulation in (turned, plain):
        triangles, _ = triangulation.triangles()
        (x, y), (u, v) = (np.moveaxis(polygon[triangles[:, k]] - polygon[triangles[:, 0]], -1, 0) for k in (1, 2))
        if (x * v > y * u).all():
            return triangles
    return triangulate(polygon)


def triangulate(polygon: Array) -> Index:
    """Return the triangles (n, 3), counterclockwise, of a simple counterclockwise polygon (K, 2), without new points.

    Teeth are symmetric, so two diagonals are often equally good. The vertices are put on a grid far coarser than rounding:
    the last digits, which differ between processors, do not choose between them.
    """
    import manifold3d

    step = TRIANGULATION_STEP * float(np.abs(polygon).max())
    for points in (np.rint(polygon / step) * step, polygon):
        triangles = np.asarray(manifold3d.triangulate([points]), dtype=np.int64)
        (x, y), (u, v) = (np.moveaxis(polygon[triangles[:, k]] - polygon[triangles[:, 0]], -1, 0) for k in (1, 2))
        if (x * v > y * u).all():
            break
    return triangles


def thickness(corners: Array) -> Array:
    """Return the least heights (M,) of triangles with corners (M, 3, 3)."""
    sides = np.roll(corners, -1, axis=1) - corners
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=-1)
    heights: Array = area / np.linalg.norm(sides, axis=-1).max(axis=1)
    return heights


def without_needles(triangles: Index, q: Array, r: Array, miss: Miss, tolerance: float) -> Index:
    """Return triangles with inner edges turned that make triangles thicker which are thinner than the tolerance, mm.

    - q: vertices (N, 2) in the chart.
    - r: vertices (N, 3) in space.
    - miss: distances of edges from the station; a turned edge stays within the tolerance, or is no worse than before.
    """
    for _ in range(TURNING_ROUNDS):
        thin = thickness(r[triangles])
        if thin.min() >= tolerance:
            break
        # both triangles of each inner edge, and the two triangles with the edge turned
        edges, owners = _inner_edges(triangles)
        corners = triangles[owners]
        apart = (corners[..., None] != edges[:, None, None, :]).all(axis=-1).argmax(axis=-1)
        apex, other = (corners[np.arange(len(edges)), k, apart[:, k]] for k in (0, 1))
        a, b = (corners[np.arange(len(edges)), 0, (apart[:, 0] + k) % 3] for k in (1, 2))
        turned = np.stack((np.stack((apex, a, other), axis=-1), np.stack((apex, other, b), axis=-1)), axis=1)
        (x, y), (u, v) = (np.moveaxis(q[turned[..., k]] - q[turned[..., 0]], -1, 0) for k in (1, 2))
        before = thin[owners].min(axis=1)
        gain = thickness(r[turned].reshape(-1, 3, 3)).reshape(-1, 2).min(axis=1) - before
        good = (x * v > y * u).all(axis=1) & (before < tolerance)
        good &= miss(np.stack((apex, other), axis=1)) <= np.maximum(tolerance, miss(edges))
        chosen = _worst_of_both(np.where(good, gain, 0.0), owners, len(triangles), MIN_GAIN_MM)
        if not chosen.size:
            break
        triangles = triangles.copy()
        triangles[owners[chosen]] = turned[chosen]
    return triangles


def _inner_edges(triangles: Index) -> tuple[Index, Index]:
    """Return the edges (E, 2) shared by two triangles, and their triangles (E, 2)."""
    ends = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    ends, owner = ends[order], order // 3
    twin = np.flatnonzero((ends[1:] == ends[:-1]).all(axis=1))
    return ends[twin], np.stack((owner[twin], owner[twin + 1]), axis=1)


def _worst_of_both(miss: Array, owners: Index, count: int, tolerance: float) -> Index:
    """Return the edges beyond the tolerance that are the worst of both their triangles: no triangle is split twice."""
    order = np.argsort(miss, kind="stable")
    rank = np.empty(len(miss), dtype=np.int64)
    rank[order] = np.arange(len(miss))
    worst = np.full(count, -1)
    np.maximum.at(worst, owners.ravel(), np.repeat(rank, 2))
    return np.flatnonzero((miss > tolerance) & (worst[owners] == rank[:, None]).all(axis=1))


def _split(triangles: Index, edges: Index, owners: Index, fresh: int) -> Index:
    """Cut both triangles of each edge (E, 2) at its middle, which is vertex `fresh` + k for edge k."""
    which = owners.ravel()
    corners = triangles[which]
    middle = np.repeat(fresh + np.arange(len(edges)), 2)
    # rotate the corners of each triangle so that the edge is between the first two
    apart = (corners[:, :, None] != np.repeat(edges, 2, axis=0)[:, None, :]).all(axis=2).argmax(axis=1)
    a, b, c = (corners[np.arange(len(which)), (apart + k) % 3] for k in (1, 2, 0))
    kept = np.delete(triangles, which, axis=0)
    return np.concatenate((kept, np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)))
