"""Bounds of the distance between a mesh (of a tooth or a whole solid) and its exact surfaces, in both directions.

Facets are compared with the surface of their link, which goes on beyond its ends (see `facets`). Chords of sharp edges
between links, and at toe and heel, are compared with both surfaces (see `edges`). Together these bound the distance in
both directions, from the mesh to the exact tooth and back, to first order in distance over radius of curvature. No
point is left out, because both surfaces are closed.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc
from gearmesh.kernel.surface.surface import Surface
from gearmesh.mesh.deviation.drawn import DrawnSurface
from gearmesh.mesh.deviation.edges import Chords, EdgeSide, FaceChords, edge_bounds, in_face, known, mirror
from gearmesh.mesh.deviation.facets import FacetBounds, Index, facet_bounds
from gearmesh.mesh.deviation.revolution import facet_distances, polygon_distance
from gearmesh.mesh.patch import PatchMesh
from gearmesh.mesh.solid import chords, gear_facets
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.mesh.triangles import Facets
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import BODY_REGIONS, FEATURE_REGIONS, GAP_REGIONS, RARE_REGIONS, Region

#: bound of the distance of a chamfer's facets, over the largest distance on the lattice of measurement: no point of a facet is
#: farther than 0.15 of an edge from a lattice point, and the distance grows with the square over half an edge
CHAMFER_BOUND_FACTOR = 1.10
#: share of the tolerance above which bounds are refined as far as possible: the rounding of a file adds to them
CLOSE_BOUND_SHARE = 0.95
#: regions of a body that are planes square to the axis, or cylinders or cones about it
ROUND_REGIONS = tuple(
    {*BODY_REGIONS, *RARE_REGIONS, *GAP_REGIONS, *FEATURE_REGIONS}
    - {Region.KEYWAY, Region.HOLE, Region.BOLT, Region.SPOKE}
)


@dataclass(frozen=True)
class DeviationBound:
    """Bound of a deviation, and the largest deviation measured."""

    #: distance that is exceeded nowhere, mm
    largest: float = 0.0
    #: largest measured distance, mm
    sampled: float = 0.0

    def join(self, *others: DeviationBound) -> DeviationBound:
        """Return the bound of several parts together."""
        every = (self, *others)
        return DeviationBound(max(part.largest for part in every), max(part.sampled for part in every))

    @staticmethod
    def of(bounds: Array, sampled: Array) -> DeviationBound:
        """Return the bound from bounds and measured distances (M,), mm."""
        return DeviationBound(float(bounds.max(initial=0.0)), float(np.abs(sampled).max(initial=0.0)))


def patch_bounds(patch: PatchMesh, sampled: float = 0.0, allowed: float = np.inf) -> FacetBounds:
    """Return the bounds of the facets of one link; `sampled` and `allowed` as in `facet_bounds`."""
    surface, parameters = _surface(patch)
    return facet_bounds(surface, parameters, patch.points, patch.triangles, sampled, allowed)


def _surface(patch: PatchMesh) -> tuple[Surface, Array]:
    """Return the surface of a link, and its parameters (N, 2) at the nodes."""
    nodes = patch.nodes
    surface: Surface | None = nodes.tooth.chain[patch.region].surface
    if surface is None or nodes.parameters is None:
        return DrawnSurface(nodes.tooth, patch.region), np.stack((nodes.s, nodes.t), axis=-1)
    return surface, nodes.parameters


def tooth_bound(mesh: ToothMesh, shared: tuple[int, ...] = ()) -> DeviationBound:
    """Return the bound of a meshed tooth, or a part of one, with its sharp edges and the edges at toe and heel.

    A whole tooth includes the edge to the next tooth. `shared`: ends (0 toe, 1 heel) at which the image of the tooth follows
    instead of an end face.
    """
    here, joint = Rigid.identity(), mesh.tooth.joint
    links = [(patch, here) for patch in mesh.patches]
    last = (mesh.patches[0], joint.to(mesh.tooth.pitch_angle)) if mesh.whole else None
    chamfers = [
        DeviationBound(CHAMFER_BOUND_FACTOR * end.deviation, end.deviation) for end in mesh.end_meshes().values()
    ]
    return _chain_bound(links, last, mesh.tolerance, shared).join(*chamfers)


def space_bound(parts: tuple[ToothMesh, ToothMesh]) -> DeviationBound:
    """Return the bound of a meshed space by its two parts: from the root to the tip surface, and the side of the tooth before."""
    (here, before), tooth = parts, parts[0].tooth
    back = tooth.joint.to(-tooth.pitch_angle)
    links = [*((patch, Rigid.identity()) for patch in here.patches), *((patch, back) for patch in before.patches)]
    return _chain_bound(links, links[0], here.tolerance)


#: a link and its place
Placed = tuple[PatchMesh, Rigid]


def _chain_bound(
    links: Sequence[Placed], following: Placed | None, tolerance: float, shared: tuple[int, ...] = ()
) -> DeviationBound:
    """Return the bound of a chain of links with the edges between them; the last link joins `following`, one of the links."""
    facets, sampled, allowed = dict[Region, FacetBounds](), 0.0, CLOSE_BOUND_SHARE * tolerance
    for patch, _ in links:
        facets[patch.region] = patch_bounds(patch, sampled, allowed)
        sampled = facets[patch.region].sampled
    pairs = list(pairwise([*links, following] if following else links))
    edges = [(_side(before, facets, 1.0), _side(after, facets, 0.0)) for before, after in pairs]
    edges += [_end(patch, facets[patch.region], which, which in shared) for patch, _ in links for which in (0, 1)]
    largest = max(measured.largest for measured in facets.values())
    for first, second in edges:
        bounds, sampled = edge_bounds(first, second, sampled, allowed)
        largest = max(largest, float(bounds.max()))
    return DeviationBound(largest, sampled)


def _side(link: Placed, facets: Mapping[Region, FacetBounds], s: float) -> EdgeSide:
    """Return the chords of the first (s = 0) or last (s = 1) line of a link over its surface."""
    patch, place = link
    return _chords(patch, facets[patch.region], patch.nodes.line(s), place)


def _chords(patch: PatchMesh, measured: FacetBounds, line: Index, place: Rigid) -> EdgeSide:
    """Return the chords of a line of nodes over the link's surface; `place` moves the surface to the other side of the edge."""
    surface, parameters = _surface(patch)
    ends, at = (np.stack((values[line[:-1]], values[line[1:]]), axis=1) for values in (patch.points, parameters))
    return EdgeSide(
        known(patch.triangles, line, measured.sides, place), Chords(surface, ends, at, place, measured.lengths).measure
    )


def _end(patch: PatchMesh, measured: FacetBounds, which: int, shared: bool) -> tuple[EdgeSide, EdgeSide]:
    """Return the chords of a link at its toe (0) or heel (1), over its surface and over the end face, its image or a chamfer."""
    line = patch.nodes.end(float(which))
    link_side = _chords(patch, measured, line, Rigid.identity())
    every = np.arange(line.size - 1), np.zeros(line.size - 1), np.ones(line.size - 1)
    blank, ends = patch.nodes.tooth.blank, np.stack((patch.points[line[:-1]], patch.points[line[1:]]), axis=1)
    toe, heel = blank.extent
    face = FaceChords(blank.axial, ends, (1.0 if which else -1.0) * float(np.sign(heel - toe))).measure
    other = (
        mirror(link_side.measure) if shared else face if blank.ends[which] is None else in_face(link_side.measure, face)
    )
    return link_side, EdgeSide(other(*every), other)


def solid_bound(member: Member, tooth_meshes: Sequence[ToothMesh], solid: Facets) -> DeviationBound:
    """Return the bound of a whole member, teeth and body; `solid` is made of the meshes of its different teeth.

    A keyway is plane. Where keyway and holes cut the surfaces, the rest of these is no farther from the exact surface.
    """
    bound, tolerance = teeth_bound(member, tooth_meshes), tooth_meshes[0].tolerance
    if member.features.is_cut:
        solid = gear_facets(replace(member, features=member.features.uncut), tolerance, *tooth_meshes)
    flat = tuple(Region.GAP for gap in member.gaps if gap.flat)
    return bound.join(body_bound(solid, flat), *_walls(member, tolerance))


def _walls(member: Member, tolerance: float) -> Iterator[DeviationBound]:
    """Yield the bounds of the walls of holes and openings."""
    for pattern in member.features.patterns:
        # all openings of a pattern are alike
        for curve in pattern.outlines[0]:
            if isinstance(curve, PlaneArc):
                part = 2.0 * np.pi / abs(curve.width)
                wall = polygon_distance(curve.radius, part * chords(curve, tolerance))
                yield DeviationBound(wall, wall)


def teeth_bound(member: Member, tooth_meshes: Sequence[ToothMesh]) -> DeviationBound:
    """Return the bound of a member's teeth, or parts of them."""
    shared = tuple({end for half in member.halves for end in half.shared})
    return DeviationBound().join(*(tooth_bound(mesh, shared) for mesh in tooth_meshes))


def body_bound(solid: Facets, flat: tuple[Region, ...] = ()) -> DeviationBound:
    """Return the bound of the facets of bodies and end faces on planes square to the axis, cylinders and cones.

    `flat`: regions that are plane in this solid.
    """
    body = [k for k, name in enumerate(solid.region_names) if name in ROUND_REGIONS and name not in flat]
    distances = [facet_distances(corners) for corners in solid.corner_pieces(body)]
    return DeviationBound().join(*(DeviationBound.of(piece, piece) for piece in distances))
