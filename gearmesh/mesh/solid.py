"""Solids of whole gears: a meshed tooth repeated around the axis, closed by end faces and bore, and proved. Racks: see `row`.

Neighbouring patches and neighbouring teeth share their vertices, so the surface is closed by construction. manifold3d cuts
keyway and openings and keeps the regions of triangles.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, lines_through
from gearmesh.mesh.body import gear_body, ring_count, triangulate, without_needles
from gearmesh.mesh.gear_mesh import GearMesh
from gearmesh.mesh.labelled import labelled_mesh
from gearmesh.mesh.pitch import SLACK_PITCHES, Pitch, least_room
from gearmesh.mesh.ring import TeethRing
from gearmesh.mesh.row import row_mesh
from gearmesh.mesh.tessellate import ToothMesh, tessellate_alike
from gearmesh.mesh.triangles import Facets, TriangleMesh, facet_normals, join, with_area
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.bores import BoreForm, ClosedLine
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region

if TYPE_CHECKING:
    import manifold3d

#: sides of a hole beside the axis, or a multiple of them
HOLE_SIDES = 8
#: largest volume that counts as rounding, as a share of the cube of the solid's size
ROUNDING_VOLUME_SHARE = 1e-15
#: status of a gear whose teeth leave their sectors: one pitch does not prove it
BEYOND_SECTOR = "BeyondSector"


@dataclass(frozen=True)
class Proof:
    """Findings about a solid from two independent checks."""

    #: status of manifold3d, "NoError" for a solid
    status: str
    #: True if each edge is run along once in either direction, by count
    watertight: bool
    #: Euler characteristic, by count
    euler: int
    #: expected genus: 1 with a bore, 0 without
    genus: int
    #: enclosed volume, mm^3
    volume: float

    @property
    def ok(self) -> bool:
        """True if all findings agree."""
        return self.status == "NoError" and self.watertight and self.euler == 2 - 2 * self.genus and self.volume > 0.0


def gear_solid(member: Member, tolerance: float, *tooth_meshes: ToothMesh, lean: bool = True) -> TriangleMesh:
    """Return the whole member as a closed mesh, in its own frame.

    - tolerance: largest distance, mm, from the exact surfaces.
    - tooth_meshes: meshes of its different teeth with lines at common stations, if they exist already.
    - lean: as in `tessellate`.

    Raises TrimError for teeth that cannot be trimmed.
    """
    return gear_facets(member, tolerance, *tooth_meshes, lean=lean).whole()


def gear_facets(
    member: Member, tolerance: float, *tooth_meshes: ToothMesh, lean: bool = True
) -> GearMesh | TriangleMesh:
    """Return the member as `gear_solid` does; gears without keyway and openings as repeated teeth, which take little memory."""
    kinds = member.different_teeth
    tooth_meshes = tooth_meshes or tessellate_alike(kinds, tolerance, lean=lean)
    if len(tooth_meshes) != len(kinds):
        raise ValueError(f"{len(kinds)} different teeth need as many meshes, not {len(tooth_meshes)}")
    if member.tooth.joint.travel is not None:
        tooth_mesh = tooth_meshes[0]
        row = row_mesh(tooth_mesh, member)
        names = (*_names(tooth_mesh), *member.body_regions)
        regions = np.array([names.index(region) for region in row.regions], dtype=np.int32)
        normals = np.concatenate([half.vectors(_normals(tooth_mesh, 1)) for half in member.halves])[row.of_tooth]
        bar = labelled_mesh(row.vertices, row.triangles, regions, names, normals, member.name)
        return _with_features(bar, member, tolerance) if member.features.is_cut else bar
    body = member.body
    if not member.features.is_cut:
        return _close(tooth_meshes, body, member)
    full = _close(tooth_meshes, body if member.bore_form is None else body.without_bore, member).whole()
    return _with_features(full, member, tolerance)


def some_teeth(member: Member, tooth_meshes: Sequence[ToothMesh], count: int) -> TriangleMesh:
    """Return the open mesh of `count` teeth of a member, from the meshes of its different teeth."""
    places = member.tooth.joint.places(count)
    kinds = member.order[:count] if member.others else np.zeros(count, dtype=np.int64)
    meshes = [teeth_mesh(tooth_meshes[kind], member.name, places[kinds == kind]) for kind in distinct(kinds)]
    return join(meshes)


def teeth_mesh(tooth_mesh: ToothMesh, name: str, places: NDArray[np.int64]) -> TriangleMesh:
    """Return the open mesh of the teeth at `places` (K,), without end faces and body; place 0 is the tooth on +x.

    The tooth mesh may consist of a few links, e.g. one flank.
    """
    welded, joint = tooth_mesh.weld(), tooth_mesh.tooth.joint
    moved = joint.to(places * tooth_mesh.tooth.pitch_angle)
    points, corners, kept = welded.vertices, welded.triangles, np.arange(len(welded.triangles))
    if tooth_mesh.whole:
        # a whole tooth ends at the first line of the next tooth
        following = joint.to(tooth_mesh.tooth.pitch_angle).point(points)
        points = np.concatenate((points, following))
        corners, kept = with_area(points, corners)
        used, corners = np.unique(corners, return_inverse=True)
        points = points[used]
    shift = np.arange(len(places))[:, None, None] * len(points)
    triangles = (corners.reshape(-1, 3) + shift).reshape(-1, 3)
    vertices = np.einsum("kij,nj->kni", moved.rotation, points) + moved.translation[..., None, :]
    normals = np.einsum("kij,nj->kni", moved.rotation, _normals(tooth_mesh, 1)[kept]).reshape(-1, 3)
    regions = np.tile(_regions(tooth_mesh, 1)[kept], len(places))
    return labelled_mesh(vertices.reshape(-1, 3), triangles, regions, _names(tooth_mesh), normals, name)


def prove(mesh: Facets, genus: int) -> Proof:
    """Return the proof of a solid: the status of manifold3d, and a count of the directed edges.

    One pitch proves a gear that repeats its teeth (see `pitch`), unless it leaves its sector. Other solids, and gears that
    one pitch does not prove, are checked as a whole. trimesh gives the same counts and checks the files in the tests; it takes
    as long to load as a gear takes to mesh.
    """
    pitch = Pitch.of(mesh) if isinstance(mesh, GearMesh) else None
    if pitch is not None and isinstance(mesh, GearMesh):
        proof = prove_pitch(mesh, pitch, genus)
        if proof.ok:
            return proof
    whole = mesh.whole()
    body = manifold_of(whole.vertices, {0: whole.triangles})
    ends = whole.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(np.int64)
    there, back = (np.sort(ends[:, k] * len(whole.vertices) + ends[:, 1 - k]) for k in (0, 1))
    once = bool((there[1:] != there[:-1]).all())
    edges = distinct(ends.min(axis=1) * len(whole.vertices) + ends.max(axis=1)).size
    euler = int(distinct(whole.triangles).size - edges + len(whole.triangles))
    return _proof(body.status().name, once and np.array_equal(there, back), euler, genus, whole)


def prove_pitch(mesh: GearMesh, pitch: Pitch, genus: int) -> Proof:
    """Return the proof of a gear by one of its pitches."""
    status = BEYOND_SECTOR
    if least_room(mesh) >= -SLACK_PITCHES:
        points, triangles = pitch.ring(mesh)
        status = manifold_of(points, {0: triangles}).status().name
    return _proof(status, pitch.closed, pitch.euler, genus, mesh)


def _proof(status: str, closed: bool, euler: int, genus: int, mesh: Facets) -> Proof:
    """Return the proof with the volume, which must be above rounding."""
    volume, extremes = mesh.volume(), [(piece.min(axis=0), piece.max(axis=0)) for piece in mesh.vertex_pieces()]
    low, high = np.min([low for low, _ in extremes], axis=0), np.max([high for _, high in extremes], axis=0)
    least = ROUNDING_VOLUME_SHARE * float((high - low).max()) ** 3
    sound = closed and bool(np.isfinite(high - low).all()) and volume > least
    return Proof(status=status, watertight=sound, euler=euler, genus=genus, volume=volume)


def _names(tooth_mesh: ToothMesh) -> tuple[Region, ...]:
    """Return the regions of a tooth and of the chamfers of its ends."""
    return *(patch.region for patch in tooth_mesh.patches), *tooth_mesh.end_meshes()


def _regions(tooth_mesh: ToothMesh, end_rows: int) -> NDArray[np.int32]:
    """Return the region (M,) of each triangle of a tooth, as an index in `_names`."""
    ends = tooth_mesh.end_meshes(end_rows).values()
    sizes = [len(patch.triangles) for patch in tooth_mesh.patches] + [len(mesh.triangles) for mesh in ends]
    return np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)


def _normals(tooth_mesh: ToothMesh, end_rows: int) -> Array:
    """Return the exact normals (M, 3) at the centres of a tooth's triangles; 0 on the chamfers of its ends."""
    ends = [np.zeros(mesh.triangles.shape) for mesh in tooth_mesh.end_meshes(end_rows).values()]
    return np.concatenate([patch.normals for patch in tooth_mesh.patches] + ends)


def _close(tooth_meshes: Sequence[ToothMesh], body: Body, member: Member) -> GearMesh:
    """Return the gear with its teeth closed by the body, and by the bodies in its gaps."""
    ring, halves = TeethRing.of(tooth_meshes, member.order, member.halves), member.halves
    axial, tolerance = member.tooth.blank.axial, tooth_meshes[0].tolerance
    rows = max(mesh.end_rows for mesh in tooth_meshes)
    under = gear_body(ring, member.rows.outer, axial, body, tolerance)
    for gap in member.gaps:
        under = under.join(gear_body(ring, gap.ends, axial, gap.body, tolerance), ring.size)
    names = _names(tooth_meshes[0])
    return GearMesh(
        ring,
        under,
        axial,
        (*names, *member.body_regions),
        tuple(np.tile(_regions(mesh, rows), len(halves)) for mesh in tooth_meshes),
        tuple(np.concatenate([half.vectors(_normals(mesh, rows)) for half in halves]) for mesh in tooth_meshes),
        under.regions + np.int32(len(names)),
        member.name,
    )


def _with_features(full: TriangleMesh, member: Member, tolerance: float) -> TriangleMesh:
    """Return the mesh with bore, keyway and openings cut; each triangle keeps the region of the solid that it comes from."""
    import manifold3d

    (low, top), bore, teeth = member.body.ends, member.plain_body.bore_radius, member.tooth.teeth
    gear_id, sources = manifold3d.Manifold.reserve_ids(1), {}
    gear = manifold_of(full.vertices, {gear_id: full.triangles}, _faces(full))

    def cut(tool: Any, region: Region) -> None:
        """Subtract a solid; the cut faces get the region."""
        nonlocal gear
        sources[tool.original_id()] = region
        gear = gear - tool

    if member.bore_form is not None:
        gear = _with_bore(gear, member.bore_form, bore, (low - 1.0, top + 1.0), (teeth, tolerance), sources)
    for opening in member.openings:
        # through openings reach beyond the body
        ends = low - 1.0, top + 1.0
        if opening.floor is not None:
            ends = (opening.floor, ends[1]) if opening.floor == opening.low else (ends[0], opening.floor)
        # chords of arcs about the axis must stay within the wall between opening and bore
        inner = max((rho for rho, _ in member.body.profile if rho < opening.reach[0]), default=0.0)
        cut(_prism(opening.curves, ends, min(tolerance, 0.5 * (opening.reach[0] - inner))), opening.region)
    if gear.status().name != "NoError" or gear.is_empty():
        raise DesignError(
            member.name,
            reason=f"its body with bore, keyway and openings is no solid ({gear.status().name}); change their sizes",
        )
    return _thick(_from_manifold(gear, full, sources, gear_id), tolerance)


def _flat_faces(mesh: TriangleMesh) -> list[NDArray[np.int64]]:
    """Return the triangles (M,) of each plane face square to the axis, by region and z."""
    z = mesh.vertices[mesh.triangles, 2]
    flat = np.flatnonzero((z == z[:, :1]).all(axis=1))
    _, face = np.unique(np.column_stack((mesh.regions[flat], z[flat, 0])), axis=0, return_inverse=True)
    return [flat[face.ravel() == k] for k in range(int(face.max(initial=-1)) + 1)]


def _faces(mesh: TriangleMesh) -> NDArray[np.int64]:
    """Return face ids (M,) of all triangles: the triangle's number, or the number of one triangle of its plane face."""
    numbers = np.arange(len(mesh.triangles))
    for face in _flat_faces(mesh):
        numbers[face] = face[0]
    return numbers


def _thick(mesh: TriangleMesh, tolerance: float) -> TriangleMesh:
    """Return the mesh with fewer thin triangles in plane faces square to the axis, which openings cut to needles."""
    triangles = mesh.triangles.copy()
    for face in _flat_faces(mesh):
        # the face as seen from outside
        seen = mesh.vertices[:, :2] * np.array([1.0, np.sign(mesh.normals[face[0], 2])])
        triangles[face] = without_needles(
            triangles[face], seen, mesh.vertices, lambda edges: np.zeros(len(edges)), tolerance
        )
    return replace(mesh, triangles=triangles)


def _hole(
    radius: float, ends: tuple[float, float], teeth: int, tolerance: float, centre: Sequence[float] = (0.0, 0.0)
) -> Any:
    """Return the cylinder of a round hole, as a solid of manifold3d."""
    import manifold3d

    body = manifold3d.Manifold.cylinder(ends[1] - ends[0], radius, radius, ring_count(teeth, radius, tolerance))
    # the polygon turns with its place, so that holes around the axis are alike
    turned = body.rotate((0.0, 0.0, math.degrees(math.atan2(centre[1], centre[0]))))
    return turned.translate((*centre, ends[0])).as_original()


def _prism(curves: ClosedLine, ends: tuple[float, float], tolerance: float) -> Any:
    """Return the prism of an opening between two z, as a solid of manifold3d; chords of arcs are within the tolerance."""
    import manifold3d

    first = curves[0]
    if isinstance(first, PlaneArc) and first.closed:
        return _hole(first.radius, ends, HOLE_SIDES, tolerance, first.centre.tolist())
    outline = np.concatenate([curve.at(np.arange(n) / n) for curve in curves for n in [chords(curve, tolerance)]])
    count, ring = len(outline), np.arange(len(outline))
    after, cap = np.roll(ring, -1), triangulate(outline)
    sides = np.stack((ring, after, ring + count, after, after + count, ring + count), axis=1).reshape(-1, 3)
    points = np.concatenate([np.column_stack((outline, np.full(count, z))) for z in ends])
    corners = np.concatenate((sides, cap[:, ::-1], cap + count)).astype(np.uint64)
    return manifold3d.Manifold(manifold3d.Mesh64(points, np.ascontiguousarray(corners))).as_original()


def chords(curve: PlaneCurve, tolerance: float) -> int:
    """Return the number of chords of a line or arc of an opening that stay within the tolerance."""
    if not isinstance(curve, PlaneArc):
        return 1
    if curve.closed:
        return ring_count(HOLE_SIDES, curve.radius, tolerance)
    step = 2.0 * np.arccos(max(1.0 - tolerance / curve.radius, 0.5))
    return max(1, int(np.ceil(abs(curve.width) / step)))


def _with_bore(
    gear: Any,
    form: BoreForm,
    radius: float,
    ends: tuple[float, float],
    sides: tuple[int, float],
    sources: dict[int, Region],
) -> Any:
    """Return a solid of manifold3d with its bore cut; `sources` gets the regions of the cut faces.

    `sides`: number of teeth and tolerance, which give the sides of the round bore; `ends`: z of both ends of the cut.
    """
    # facets come in the order in which their solids are made
    drilled = any(isinstance(curve, PlaneArc) for curve in form.in_bore(radius))
    hole = _hole(radius, ends, *sides) if drilled else None
    corners = form.polygon(radius)
    walls = _prism(lines_through([*corners, corners[0]]), ends, sides[1])
    sources[walls.original_id()] = form.region
    if hole is None:
        # the round bore is inside the polygon everywhere
        return gear - walls
    sources[hole.original_id()] = Region.BORE
    return gear - (hole ^ walls) if form.limits else gear - hole - walls


def manifold_of(
    vertices: Array, runs: Mapping[int, NDArray[np.int64]], faces: NDArray[np.int64] | None = None
) -> manifold3d.Manifold:
    """Return a solid of manifold3d in double precision; its status tells whether the triangles are a solid.

    - vertices: (V, 3), mm.
    - runs: triangles by id; an id keeps manifold3d from renumbering and merging the faces.
    - faces: face ids (M,); manifold3d merges plane triangles with equal ids. None for the numbers of the triangles.
    """
    import manifold3d

    triangles = np.concatenate(list(runs.values()))
    ends = np.cumsum([0, *(run.size for run in runs.values())])
    return manifold3d.Manifold(
        manifold3d.Mesh64(
            np.array(vertices, order="C"),
            np.array(triangles, dtype=np.uint64, order="C"),
            run_index=ends.astype(np.uint64),
            run_original_id=np.array(list(runs), dtype=np.uint32),
            face_id=np.asarray(np.arange(len(triangles)) if faces is None else faces, dtype=np.uint64),
        )
    )


def facets_of(
    body: manifold3d.Manifold,
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return what a solid of manifold3d consists of.

    They are its vertices (V, 3), mm, its triangles (M, 3), and of each triangle (M,) the id and the face id that
    `manifold_of` gave it.
    """
    made = body.to_mesh64()
    return (
        np.array(made.vert_properties)[:, :3].copy(),
        np.array(made.tri_verts, dtype=np.int64),
        np.repeat(np.asarray(made.run_original_id, dtype=np.int64), np.diff(np.asarray(made.run_index)) // 3),
        np.asarray(made.face_id, dtype=np.int64),
    )


def _from_manifold(body: Any, full: TriangleMesh, sources: dict[int, Region], gear_id: int) -> TriangleMesh:
    """Return the mesh of a cut solid; triangles of the gear keep region and normal, cut faces have those of their tool."""
    vertices, triangles, origin, face = facets_of(body)
    from_gear = origin == gear_id
    regions = np.empty(len(triangles), dtype=np.int32)
    regions[from_gear] = full.regions[face[from_gear]]
    for source, name in sources.items():
        regions[origin == source] = full.region_names.index(name)
    normals = facet_normals(vertices, triangles)
    normals[from_gear] = full.normals[face[from_gear]]
    return replace(full, vertices=vertices, triangles=triangles, regions=regions, normals=normals)
