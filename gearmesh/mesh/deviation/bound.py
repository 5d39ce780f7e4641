"""How far a tooth's mesh, or a whole solid, is from the exact surfaces at most, both ways: facets, sharp edges, body and rounding.

Facets are held against the surface of their link, which goes on beyond its ends (see `facets`); where links meet in an edge,
and at toe and heel, chords are held against both surfaces (see `edges`). Together these bound the distance of the mesh from the
exact tooth and of the tooth from the mesh, to first order in distance over radius of curvature: both are closed and the closest
points of one on the other leave nothing out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc
from gearmesh.kernel.surface.surface import Surface
from gearmesh.mesh.deviation.drawn import DrawnSurface
from gearmesh.mesh.deviation.edges import Chords, EdgeSide, FaceChords, edge_bounds, known, mirrored
from gearmesh.mesh.deviation.facets import FacetBounds, Index, facet_bounds
from gearmesh.mesh.deviation.revolution import facet_distances, polygon_distance
from gearmesh.mesh.patch import PatchMesh
from gearmesh.mesh.solid import chords
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import BODY_REGIONS, FEATURE_REGIONS, GAP_REGIONS, RARE_REGIONS, Region

#: regions of a body that are planes across the axis, cylinders or cones round it
ROUND = tuple(
    {*BODY_REGIONS, *RARE_REGIONS, *GAP_REGIONS, *FEATURE_REGIONS}
    - {Region.KEYWAY, Region.HOLE, Region.BOLT, Region.SPOKE}
)


@dataclass(frozen=True)
class DeviationBound:
    """The distance (mm) that is not exceeded anywhere, and the largest one measured."""

    largest: float = 0.0
    sampled: float = 0.0

    def join(self, *others: DeviationBound) -> DeviationBound:
        """Of several parts together."""
        every = (self, *others)
        return DeviationBound(max(one.largest for one in every), max(one.sampled for one in every))

    @staticmethod
    def of(bounds: Array, sampled: Array) -> DeviationBound:
        """Of bounds and measured distances (M,), mm."""
        return DeviationBound(float(bounds.max(initial=0.0)), float(np.abs(sampled).max(initial=0.0)))


def patch_bounds(patch: PatchMesh, sampled: float = 0.0, allowed: float = np.inf) -> FacetBounds:
    """Of the facets of one link, as `facet_bounds`."""
    surface, parameters = _surface(patch)
    return facet_bounds(surface, parameters, patch.points, patch.triangles, sampled, allowed)


def _surface(patch: PatchMesh) -> tuple[Surface, Array]:
    """The surface of a link, and its parameters (N, 2) at the nodes."""
    nodes = patch.nodes
    surface: Surface | None = nodes.tooth.chain[patch.region].surface
    if surface is None or nodes.parameters is None:
        return DrawnSurface(nodes.tooth, patch.region), np.stack((nodes.s, nodes.t), axis=-1)
    return surface, nodes.parameters


def tooth_bound(mesh: ToothMesh, shared: tuple[int, ...] = ()) -> DeviationBound:
    """Of a meshed tooth, or a part of one, with its sharp edges; of a whole one also those towards the next tooth, at toe and heel.

    `shared`: ends of it (0 toe, 1 heel) at which its image follows instead of an end face.
    """
    facets, sampled = list[FacetBounds](), 0.0
    for patch in mesh.patches:
        facets.append(patch_bounds(patch, sampled, mesh.tolerance))
        sampled = facets[-1].sampled
    parts, here = list(zip(mesh.patches, facets, strict=True)), Rigid.identity()
    edges = [
        (_side(*before, before[0].nodes.line(1.0), here), _side(*after, after[0].nodes.line(0.0), here))
        for before, after in pairwise(parts)
    ]
    if mesh.whole:
        (last, _), (first, _) = parts[-1], parts[0]
        following = mesh.tooth.joint.to(mesh.tooth.pitch_angle)
        edges.append(
            (_side(*parts[-1], last.nodes.line(1.0), here), _side(*parts[0], first.nodes.line(0.0), following))
        )
        edges += [_end(*part, which, which in shared) for part in parts for which in (0, 1)]
    largest = max(found.largest for found in facets)
    for one, other in edges:
        bounds, sampled = edge_bounds(one, other, sampled, mesh.tolerance)
        largest = max(largest, float(bounds.max()))
    return DeviationBound(largest, sampled)


def _side(patch: PatchMesh, found: FacetBounds, line: Index, place: Rigid) -> EdgeSide:
    """The chords of a line of a link's nodes over its surface, which `place` takes to the other side's."""
    surface, parameters = _surface(patch)
    ends, at = (np.stack((given[line[:-1]], given[line[1:]]), axis=1) for given in (patch.points, parameters))
    return EdgeSide(known(patch.triangles, line, found.sides, place), Chords(surface, ends, at, place).measure)


def _end(patch: PatchMesh, found: FacetBounds, which: int, shared: bool) -> tuple[EdgeSide, EdgeSide]:
    """The chords of a link at its toe (0) or heel (1), over its own surface and over the end face, or its image."""
    line = patch.nodes.end(float(which))
    own = _side(patch, found, line, Rigid.identity())
    every = np.arange(line.size - 1), np.zeros(line.size - 1), np.ones(line.size - 1)
    blank, ends = patch.nodes.tooth.blank, np.stack((patch.points[line[:-1]], patch.points[line[1:]]), axis=1)
    toe, heel = blank.extent
    face = FaceChords(blank.axial, ends, (1.0 if which else -1.0) * float(np.sign(heel - toe))).measure
    other = mirrored(own.measure) if shared else face
    return own, EdgeSide(other(*every), other)


def solid_bound(member: Member, tooth_meshes: Sequence[ToothMesh], closed: TriangleMesh) -> DeviationBound:
    """Of a whole member: its different teeth, and the body in its mesh, `closed`, before keyway and holes are cut.

    Facets of the body are between points of the planes, cylinders and cones that it is bounded by.
    """
    shared = tuple({end for half in member.halves for end in half.shared})
    bound = DeviationBound().join(*(tooth_bound(mesh, shared) for mesh in tooth_meshes))
    body = np.isin(closed.regions, [k for k, name in enumerate(closed.region_names) if name in ROUND])
    distances = facet_distances(closed.vertices[closed.triangles[body]])
    bound = bound.join(DeviationBound.of(distances, distances))
    for pattern in member.features.patterns:
        # all of them are alike
        for curve in pattern.outlines[0]:
            if isinstance(curve, PlaneArc):
                part = 2.0 * np.pi / abs(curve.width)
                wall = polygon_distance(curve.radius, part * chords(curve, tooth_meshes[0].tolerance))
                bound = bound.join(DeviationBound(wall, wall))
    return bound
