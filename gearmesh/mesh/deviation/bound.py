"""How far a tooth's mesh, or a whole solid, is from the exact surfaces at most, both ways: facets, sharp edges, body and rounding.

Facets are held against the surface of their link, which goes on beyond its ends (see `facets`); where links meet in an edge,
and at toe and heel, chords are held against both surfaces (see `edges`). Together these bound the distance of the mesh from the
exact tooth and of the tooth from the mesh, to first order in distance over radius of curvature: both are closed and the closest
points of one on the other leave nothing out.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
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
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import BODY_REGIONS, FEATURE_REGIONS, GAP_REGIONS, RARE_REGIONS, Region

#: facets of chamfers of end faces are that much farther at most than on the lattice where they are measured. Of distances that go
#: with the square of the way it misses less than 9 %: its points are 1/4 of an edge apart, none of the facet more than 0.15 away,
#: and from where the distance is greatest to where it is none it is half an edge. At random places it was 2 % on nine chamfers
CHAMFER = 1.10
#: share of the tolerance above which bounds are as close as can be: rounding of a file adds to them
ROOM = 0.95
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
    """Of a meshed tooth, or a part of one, with its sharp edges and those at toe and heel; of a whole one also to the next tooth.

    `shared`: ends of it (0 toe, 1 heel) at which its image follows instead of an end face.
    """
    here, joint = Rigid.identity(), mesh.tooth.joint
    links = [(patch, here) for patch in mesh.patches]
    last = (mesh.patches[0], joint.to(mesh.tooth.pitch_angle)) if mesh.whole else None
    chamfers = [DeviationBound(CHAMFER * end.deviation, end.deviation) for end in mesh.end_meshes().values()]
    return _chain_bound(links, last, mesh.tolerance, shared).join(*chamfers)


def space_bound(parts: tuple[ToothMesh, ToothMesh]) -> DeviationBound:
    """Of a meshed space between two teeth, by both parts: from the root to the tip surface, and the side of the tooth before."""
    (here, before), tooth = parts, parts[0].tooth
    back = tooth.joint.to(-tooth.pitch_angle)
    links = [*((patch, Rigid.identity()) for patch in here.patches), *((patch, back) for patch in before.patches)]
    return _chain_bound(links, links[0], here.tolerance)


#: a link, and where it is
Placed = tuple[PatchMesh, Rigid]


def _chain_bound(
    links: Sequence[Placed], following: Placed | None, tolerance: float, shared: tuple[int, ...] = ()
) -> DeviationBound:
    """Of links, each of which ends where the next one begins, the last where the `following` one, which is one of them, does."""
    facets, sampled, allowed = dict[Region, FacetBounds](), 0.0, ROOM * tolerance
    for patch, _ in links:
        facets[patch.region] = patch_bounds(patch, sampled, allowed)
        sampled = facets[patch.region].sampled
    pairs = list(pairwise([*links, following] if following else links))
    edges = [(_side(before, facets, 1.0), _side(after, facets, 0.0)) for before, after in pairs]
    edges += [_end(patch, facets[patch.region], which, which in shared) for patch, _ in links for which in (0, 1)]
    largest = max(measured.largest for measured in facets.values())
    for one, other in edges:
        bounds, sampled = edge_bounds(one, other, sampled, allowed)
        largest = max(largest, float(bounds.max()))
    return DeviationBound(largest, sampled)


def _side(link: Placed, facets: Mapping[Region, FacetBounds], s: float) -> EdgeSide:
    """The chords of the first (s = 0) or last (1) line of a link over its surface."""
    patch, place = link
    return _chords(patch, facets[patch.region], patch.nodes.line(s), place)


def _chords(patch: PatchMesh, measured: FacetBounds, line: Index, place: Rigid) -> EdgeSide:
    """The chords of a line of a link's nodes over its surface, which `place` takes to the other side's."""
    surface, parameters = _surface(patch)
    ends, at = (np.stack((given[line[:-1]], given[line[1:]]), axis=1) for given in (patch.points, parameters))
    return EdgeSide(
        known(patch.triangles, line, measured.sides, place), Chords(surface, ends, at, place, measured.lengths).measure
    )


def _end(patch: PatchMesh, measured: FacetBounds, which: int, shared: bool) -> tuple[EdgeSide, EdgeSide]:
    """The chords of a link at its toe (0) or heel (1), over its own surface and over the end face, its image or a chamfer."""
    line = patch.nodes.end(float(which))
    own = _chords(patch, measured, line, Rigid.identity())
    every = np.arange(line.size - 1), np.zeros(line.size - 1), np.ones(line.size - 1)
    blank, ends = patch.nodes.tooth.blank, np.stack((patch.points[line[:-1]], patch.points[line[1:]]), axis=1)
    toe, heel = blank.extent
    face = FaceChords(blank.axial, ends, (1.0 if which else -1.0) * float(np.sign(heel - toe))).measure
    other = mirror(own.measure) if shared else face if blank.ends[which] is None else in_face(own.measure, face)
    return own, EdgeSide(other(*every), other)


def solid_bound(member: Member, tooth_meshes: Sequence[ToothMesh], solid: Facets) -> DeviationBound:
    """Of a whole member, `solid` by the meshes of its different teeth: teeth, and body.

    A keyway is plane, and what it and holes cut off is off the surfaces by no more than what they leave.
    """
    bound, tolerance = teeth_bound(member, tooth_meshes), tooth_meshes[0].tolerance
    if member.features.is_cut:
        solid = gear_facets(replace(member, features=member.features.uncut), tolerance, *tooth_meshes)
    return bound.join(body_bound(solid), *_walls(member, tolerance))


def _walls(member: Member, tolerance: float) -> Iterator[DeviationBound]:
    """Of the walls of holes and the like."""
    for pattern in member.features.patterns:
        # all of them are alike
        for curve in pattern.outlines[0]:
            if isinstance(curve, PlaneArc):
                part = 2.0 * np.pi / abs(curve.width)
                wall = polygon_distance(curve.radius, part * chords(curve, tolerance))
                yield DeviationBound(wall, wall)


def teeth_bound(member: Member, tooth_meshes: Sequence[ToothMesh]) -> DeviationBound:
    """Of a member's teeth, or parts of them."""
    shared = tuple({end for half in member.halves for end in half.shared})
    return DeviationBound().join(*(tooth_bound(mesh, shared) for mesh in tooth_meshes))


def body_bound(solid: Facets) -> DeviationBound:
    """Of the facets of bodies and end faces, whose corners are on planes across the axis, cylinders and cones."""
    body = [k for k, name in enumerate(solid.region_names) if name in ROUND]
    distances = [facet_distances(corners) for corners in solid.corner_pieces(body)]
    return DeviationBound().join(*(DeviationBound.of(piece, piece) for piece in distances))
