"""Finite-element models of gears: a tooth pair in mesh as tooth contact analysis places it, or one member alone.

A member of a pair has the same load as in mesh. A member without a mating gear is held and not loaded, in its own
frame. The model's frame is the pinion's bearing, with z as axis of rotation: a torque or a prescribed angle then needs
one rotation only. The gear is held at its rim and at the cut faces. The pinion's rim and cut faces are rigid and rotate
about z.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.contact.hertz import STEEL, Material
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.fe.model import ContactPair, CyclicSymmetry, Model, NodeForces, RigidTie, Support
from gearmesh.fe.placing import PlacedPair, arc_centre, focus_on, major_axis, neighbours, stations_under_load
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, distinct, plane_cross, unit
from gearmesh.mesh.hexahedra.cyclic import pair_cuts
from gearmesh.mesh.hexahedra.hexahedra import Cells, CoarsestLines, Focus, HexGrid, focused_grid, hex_mesh, plain_grid
from gearmesh.mesh.hexahedra.hexes import HexMesh, join
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.mesh.hexahedra.pierced_body import Cuts
from gearmesh.mesh.hexahedra.turned_body import CORE_SET, SHAFT_END_SET, whole_mesh
from gearmesh.progress import in_turn, part
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import CUT_REGIONS, Side
from gearmesh.teeth.tooth import Tooth

#: initial overlap of the flanks under a torque, over the Hertz approach: CalculiX makes contact elements only where
#: faces overlap (see notes.md)
INITIAL_OVERLAP = 0.5
#: least initial overlap over the distance of the insides of coarse facets, where CalculiX searches contact
FACET_OVERLAP_FACTOR = 1.5
#: places across a face, as shares of its sides, inside of which CalculiX searches contact
INNER_PLACES = (0.2, 0.5, 0.8)
#: distance, in semi-axes of the contact and one element, within which facets may touch first
NEAR_SEMI_AXES = 2.0
#: elements over a semi-axis of the contact ellipse that resolve the pressure
ELEMENTS_PER_SEMI_AXIS = 4.0
#: elements into the tooth over the smaller semi-axis that resolve the pressure
ELEMENTS_INWARD = 0.7
#: largest sag of an element's edge along the ellipse over the approach (see notes.md)
MAX_SAG_RATIO = 0.11
#: penetration of the contact springs under the largest pressure over the approach, both by Hertz (see notes.md)
SPRING_PENETRATION = 0.015
#: contact stiffness at an edge over Young's modulus, 1/mm; converges where harder springs do not
EDGE_STIFFNESS = 50.0
#: node sets at which a member is held: the first that it has
HELD_SETS = ("rim", "bore", SHAFT_END_SET, CORE_SET)
#: default numbers of elements
DEFAULT_CELLS = Cells()
#: points along the radius of a loaded ellipse at which its pressure is evaluated
PRESSURE_POINTS = 12
#: points along a line of contact, many for each element
LINE_POINTS = 1000


@dataclass(frozen=True)
class MeshRequest:
    """Contents of every member's mesh, in contact or alone."""

    #: number of teeth; None for all
    teeth: int | None = 3
    #: numbers of elements
    cells: Cells = DEFAULT_CELLS
    #: depth of the rim below the root, mm; None for the default
    rim: float | None = None
    #: True for elements with mid-side nodes
    second_order: bool = False
    #: number of pitches in a sector with cyclic symmetry, instead of `teeth`
    sector: int | None = None
    #: True to include the turned body under the rim
    whole: bool = False
    #: size of the body's elements, mm
    size: float | None = None


@dataclass(frozen=True)
class Request(MeshRequest):
    """Contents of a model of a pair."""

    #: "pinion", "gear" or both, in mesh
    members: tuple[str, ...] = ("pinion", "gear")
    #: elements over each semi-axis of the contact ellipse; 0 for as many as `cells` allow
    ellipse: int = 0
    #: True for equally spaced lines
    even: bool = False
    #: torque on the pinion in the driving sense, N mm
    torque: float = 1e5
    #: prescribed rotation of the pinion instead of a torque, rad
    rotation: float | None = None
    #: coefficient of Coulomb friction on the flanks
    friction: float = 0.0
    #: True to add lines until the contact ellipse is resolved
    resolved: bool = False
    #: materials of pinion and gear
    materials: tuple[Material, Material] = (STEEL, STEEL)
    #: True if lines follow the contact on the teeth beside the leading teeth too
    every_tooth: bool = False


@dataclass(frozen=True)
class GearModel:
    """A model of gears with its position."""

    #: finite-element model
    model: Model
    #: leading tooth pair at the position
    at: PlacedPair
    #: angle, rad, by which the pinion was rotated into the gear beforehand: half the Hertz approach, or more for coarse
    #: facets; it is added to the rotation that a solver finds under a torque
    preload: float
    #: gap of the facets, mm, where the flanks touch; the gear was rotated back by it
    gap: float


def gear_model(request: Request, at: PlacedPair, title: str = "gearmesh") -> GearModel:
    """Build the model of the requested members at a position that `placing.place` found.

    Sets are those of `hex_mesh` with the prefix pinion_ or gear_, and the sets pinion_held and gear_held of rim and cut
    faces. Raises TrimError for teeth that cannot be trimmed, and DesignError for a rim that does not fit.
    """
    pair = at.pair
    with part(0.0, 0.5):
        meshes = {name: member_mesh(name, request, at) for name in in_turn(request.members)}
    turns, in_mesh = list(at.turns), len(request.members) == 2
    gap = preload = 0.0
    if in_mesh:
        with part(0.5, 0.9):
            # facets of convex flanks do not touch at first touch: close the gap, and overlap both enough for CalculiX
            # to find contact
            gap, apart = _facet_gap(meshes, at)
        lever = float(at.path.normal[0] @ pair.gear.mount.velocity(at.path.point[0]))
        turns[1] -= pair.drive * gap / abs(lever)
        overlap = max(INITIAL_OVERLAP * at.approach, FACET_OVERLAP_FACTOR * apart)
        preload = overlap / abs(at.arm) if request.rotation is None else 0.0
    placed = {
        name: mesh.move(at.frame @ pair.members[name].mount.at(turns[pair.index(name)]))
        for name, mesh in meshes.items()
    }
    if in_mesh:
        placed[pair.pinion.name] = placed[pair.pinion.name].move(Rigid.about_z(at.sense * preload))
    mesh = join(placed)
    materials = dict(zip(pair.members, request.materials, strict=True))
    model = Model(title, mesh, {name: materials[name] for name in request.members})
    if in_mesh:
        model = _in_contact(model, request, at)
    else:
        (name,) = request.members
        forces = _hertz_forces(name, model, request, at)
        model = replace(model, supports=(Support(f"{name}_held"),), forces=(forces,))
        own_to_model = at.frame @ pair.members[name].mount.at(turns[pair.index(name)])
        model = replace(model, cyclic=cyclic_symmetry(pair.members[name], request, own_to_model))
    return GearModel(model, at, preload, gap)


def _in_contact(model: Model, request: Request, at: PlacedPair) -> Model:
    """Return the model with the gear held, the pinion's rim rigid and rotated, and the facing flanks in contact."""
    pair, turned = at.pair, f"{at.pair.pinion.name}_held"
    if request.rotation is None:
        tie = RigidTie(turned, np.zeros(3), load=(0.0,) * 5 + (at.sense * request.torque,))
    else:
        tie = RigidTie(turned, np.zeros(3), motion=(0.0,) * 5 + (at.sense * request.rotation,))
    stiffness = contact_stiffness(request.materials, at)
    contacts = tuple(ContactPair(*names, stiffness, request.friction) for names in facing(model.mesh, pair))
    return replace(model, supports=(Support(f"{pair.gear.name}_held"),), ties=(tie,), contacts=contacts)


def contact_stiffness(materials: tuple[Material, Material], at: PlacedPair) -> float:
    """Return pressure over penetration, MPa/mm, of the contact springs between the flanks of a placed pair."""
    if np.isnan(at.pressure):
        return EDGE_STIFFNESS * max(material.youngs_modulus for material in materials)
    return at.pressure / (SPRING_PENETRATION * at.approach)


def member_mesh(name: str, request: Request, at: PlacedPair) -> HexMesh:
    """Return one member's mesh in its own frame, with its set `held`, and with fine lines around the contact of the
    leading tooth."""
    return held_mesh(at.pair.members[name], request, grid_of(name, request, at))


def held_mesh(member: Member, request: MeshRequest, grid: HexGrid) -> HexMesh:
    """Return one member's mesh in its own frame, with the lines of a grid and the set `held`.

    The set has the rim and the cut faces. In a whole body the bore replaces the rim; without a bore, the ends of its
    shafts do, or else its core. A sector has no cut faces in the set.
    """
    tooth = member.one_tooth
    all_teeth = tooth.teeth if tooth.screw is None else _threads_in_length(tooth)
    count = min(request.sector or request.teeth or all_teeth, all_teeth)
    teeth = np.arange(count) - (count - 1) // 2
    if request.whole:
        body = member.turned_body
        if body is None or tooth.screw is not None:
            why = f"hexahedra of the {member.name} end with its rim, as of all racks, threads and double helical gears"
            raise DesignError("fe.body", "whole", reason=why, allowed='"rim"')
        # a part of the gear has no whole keyway or hole
        cuts = Cuts(member.bore_form, member.openings) if count == all_teeth and request.sector is None else None
        mesh = whole_mesh(
            tooth, body, teeth, grid, request.rim, request.size, second_order=request.second_order, cuts=cuts
        )
    else:
        mesh = hex_mesh(tooth, teeth, grid, request.rim, second_order=request.second_order)
    held_set = next(name for name in HELD_SETS if name in mesh.node_sets)
    if request.sector is not None:
        mesh = pair_cuts(mesh, tooth.joint.to(request.sector * tooth.pitch_angle))
        # nodes of the last cut face follow those of the first, which are held
        held_nodes = np.setdiff1d(mesh.node_sets[held_set], mesh.node_sets["cut_left"])
        return replace(mesh, node_sets=mesh.node_sets | {"held": held_nodes})
    # an arc of threads is cut at its ends too
    cut_faces = CUT_REGIONS if tooth.screw is None else (*CUT_REGIONS, "toe", "heel")
    held = [mesh.node_sets[key] for key in (held_set, *cut_faces) if key in mesh.node_sets]
    return replace(mesh, node_sets=mesh.node_sets | {"held": distinct(np.concatenate(held))})


def _threads_in_length(tooth: Tooth) -> int:
    """Return the number of threads side by side along a member, an odd number."""
    toe, heel = tooth.blank.extent
    return 2 * int(0.5 * abs((heel - toe) / layers(tooth, [0.5]).step.translation[2])) + 1


def cyclic_symmetry(member: Member, request: MeshRequest, own_to_model: Rigid) -> CyclicSymmetry | None:
    """Return the cyclic symmetry of a member's sector in the model's frame; None without a sector."""
    if request.sector is None:
        return None
    first, last = (f"{member.name}_{region}" for region in CUT_REGIONS)
    axis = own_to_model.point(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    return CyclicSymmetry(member.tooth.teeth // request.sector, first, last, axis)


def check_sector(member: Member, pitches: int) -> None:
    """Raise DesignError if a number of pitches does not divide the member's teeth, or if the member does not rotate."""
    teeth = member.tooth.teeth
    fitting = [k for k in range(1, teeth) if teeth % k == 0]
    if np.isinf(member.tooth.joint.cycle(teeth)) or member.one_tooth.screw is not None or not fitting:
        raise ArgumentError("sector", pitches, must_be=f"left out for the {member.name}, which has no sectors")
    if pitches not in fitting:
        allowed = ", ".join(map(str, fitting))
        raise ArgumentError(
            "sector", pitches, must_be=f"a divisor of the {teeth} teeth of the {member.name}: {allowed}"
        )


def unloaded_model(member: Member, request: MeshRequest, material: Material, title: str = "gearmesh") -> Model:
    """Build the model of a member without a mating gear, in its own frame.

    The member is held as in a pair and not loaded, and the lines are equally spaced. Sets are those of `gear_model`.
    Raises TrimError for teeth that cannot be trimmed, and DesignError for a rim that does not fit.
    """
    name = member.name
    mesh = join({name: held_mesh(member, request, plain_grid(request.cells))})
    cyclic = cyclic_symmetry(member, request, Rigid.identity())
    return Model(title, mesh, {name: material}, supports=(Support(f"{name}_held"),), cyclic=cyclic)


def grid_of(name: str, request: Request, at: PlacedPair) -> HexGrid:
    """Return the lines of a member; they follow the loaded ellipse unless they are requested to be even or there is no
    ellipse."""
    pair, member_index = at.pair, at.pair.index(name)
    params = (at.path.params1, at.path.params2)[member_index][0]
    centre = arc_centre(pair.both[member_index].tooth, pair.flanks[member_index], params)
    if request.even or np.isnan(at.pressure):
        return replace(plain_grid(request.cells), centre=centre)
    pairs_beside = neighbours(at, request.torque, request.materials) if request.every_tooth else {}
    # a thread that wedges itself into the gear slides far along the gear's flank before it is loaded
    slides = member_index == 0 and pair.pinion.tooth.screw is not None and len(request.members) == 2
    focus, beside = focus_on(name, at, request.ellipse, turned=slides), {}
    for places, beside_at in pairs_beside.items():
        beside_focus = focus_on(name, beside_at, request.ellipse)
        # the contact of an edge under load is about as large as the leading contact
        beside[places[pair.index(name)]] = (
            replace(focus, s=beside_focus.s, t=beside_focus.t) if np.isnan(beside_at.pressure) else beside_focus
        )
    coarsest = resolving(request.second_order, at.approach) if request.resolved else None
    shared = stations_under_load(grid_of(pair.gear.name, request, at), at) if slides else None
    return replace(focused_grid(request.cells, focus, beside, coarsest, shared), centre=centre)


def resolving(second_order: bool, approach: float) -> CoarsestLines:
    """Return the coarsest lines over the contact ellipse that resolve its pressure; edges of second order follow the
    flank."""
    return (
        CoarsestLines(0.5 * ELEMENTS_PER_SEMI_AXIS, 0.5 * ELEMENTS_INWARD, np.inf)
        if second_order
        else CoarsestLines(ELEMENTS_PER_SEMI_AXIS, ELEMENTS_INWARD, MAX_SAG_RATIO * approach)
    )


def _facet_gap(meshes: dict[str, HexMesh], at: PlacedPair) -> tuple[float, float]:
    """Return the facet gap (mm) of the leading flanks, and the distance (mm) at which contact is searched.

    The gap is measured along the normal of contact, between nodes of one flank and facets of the other. The exact
    flanks touch there, and facets of convex flanks lie below them. CalculiX searches contact at the insides of the
    pinion's faces. The second value is their least distance from the gear's facets after the gap is closed. Both are
    heights over the common tangent plane within `NEAR_SEMI_AXES` semi-axes of the contact, plus an element.
    """
    normal = at.path.normal[0]
    along = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    semi_axes = np.zeros(2)
    if not np.isnan(at.pressure):
        along, semi_axes = major_axis(at.path), np.array([at.semi_major, at.semi_minor])
    # faces of both leading flanks in a frame at the contact: x along the ellipse, z along the normal
    axes = np.stack((along, np.cross(normal, along), normal), axis=-1)
    faces = []
    for (name, mesh), side in zip(meshes.items(), at.pair.flanks, strict=True):
        own_to_fixed = at.pair.members[name].mount.at(at.turns[at.pair.index(name)])
        outlines = mesh.face_outlines(f"flank_{side}_{_leading(mesh, side)}")
        faces.append((own_to_fixed.point(mesh.nodes[outlines]) - at.path.point[0]) @ axes)
    # keep faces near the contact
    nearest = [face[np.linalg.norm(face.mean(axis=1), axis=-1).argmin()] for face in faces]
    window = NEAR_SEMI_AXES * (semi_axes + np.max([np.ptp(face[:, :2], axis=0) for face in nearest], axis=0))
    near_faces = [face[(np.abs(face[..., :2]).min(axis=1) < window).all(axis=1)] for face in faces]
    gaps = np.concatenate((_heights(near_faces[1], near_faces[0]), -_heights(near_faces[0], near_faces[1])))
    if not gaps.size:
        return 0.0, 0.0
    inside_distance = -_heights(_inner(near_faces[0]), near_faces[1])
    return float(gaps.min()), float(max(inside_distance.min() - gaps.min(), 0.0)) if inside_distance.size else 0.0


def _inner(faces: Array) -> Array:
    """Return places (K, 1, 3) inside of faces (P, 4 or 8, 3), interpolated between their corners."""
    corners = faces[:, :: faces.shape[1] // 4]
    u, v = (axis.ravel() for axis in np.meshgrid(INNER_PLACES, INNER_PLACES))
    weights = np.stack(((1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v), axis=-1)
    points: Array = np.einsum("ki,pij->pkj", weights, corners).reshape(-1, 1, 3)
    return points


def _heights(faces: Array, under: Array) -> Array:
    """Return heights z (K,) of the nodes of faces (P, 4 or 8, 3) over the triangles of the faces (Q, 4 or 8, 3) under
    them."""
    # sort points by x: the points between the least and the largest x of a triangle are consecutive
    points = np.unique(faces.reshape(-1, 3), axis=0)
    triangles = under[:, _FACE_TRIANGLES[under.shape[1]]].reshape(-1, 3, 3)
    begin, end = (
        points[:, 0].searchsorted(triangles[..., 0].min(axis=1)),
        points[:, 0].searchsorted(triangles[..., 0].max(axis=1), "right"),
    )
    count = end - begin
    triangle_index = np.repeat(np.arange(len(triangles)), count)
    point = points[np.arange(len(triangle_index)) + np.repeat(begin - np.cumsum(count) + count, count)]
    a, b, c = np.moveaxis(triangles[triangle_index], 1, 0)
    edge_ab, edge_ac, from_a = b - a, c - a, point - a
    area = plane_cross(edge_ab, edge_ac)
    with np.errstate(all="ignore"):
        # barycentric coordinates of the points in the plane
        u, v = plane_cross(from_a, edge_ac) / area, plane_cross(edge_ab, from_a) / area
    over = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
    heights: Array = (from_a[:, 2] - u * edge_ab[:, 2] - v * edge_ac[:, 2])[over]
    return heights


def _leading(mesh: HexMesh, side: Side, prefix: str = "") -> int:
    """Return the number of the tooth on +x."""
    return (sum(name.startswith(f"{prefix}flank_{side}_") for name in mesh.face_sets) - 1) // 2 + 1


def facing(mesh: HexMesh, pair: GearPair) -> list[tuple[str, str]]:
    """Return face sets (of the pinion, of the gear) of the working flanks that face each other, by their nearest
    middles."""
    names = [
        [name for name in mesh.face_sets if name.startswith(f"{member}_flank_{side}_")]
        for member, side in zip(pair.members, pair.flanks, strict=True)
    ]
    middles = [
        np.array([mesh.nodes[mesh.face_corners(n)].mean(axis=(0, 1)) for n in flank_names]) for flank_names in names
    ]
    distances = np.linalg.norm(middles[0][:, None] - middles[1][None], axis=-1)
    nearest = distances.argmin(axis=1)
    mutual = [i for i in range(len(names[0])) if distances[:, nearest[i]].argmin() == i]
    return [(names[0][i], names[1][nearest[i]]) for i in mutual]


def _hertz_forces(name: str, model: Model, request: Request, at: PlacedPair) -> NodeForces:
    """Return the Hertz pressure of the leading contact as statically equal forces on the nodes of the loaded flank."""
    pair, member_index = at.pair, at.pair.index(name)
    side, mesh = pair.flanks[member_index], model.mesh
    grid = grid_of(name, request, at)
    s, t, weight = _pressure_points(focus_on(name, at), at)
    flank = f"{name}_flank_{side}_{_leading(mesh, side, f'{name}_')}"
    outlines = mesh.face_outlines(flank)
    outlines = outlines.reshape(-1, len(grid.t) - 1, outlines.shape[1])
    # face of the flank's grid under each point of pressure, and coordinates in the face
    column = np.clip(np.searchsorted(grid.t, t) - 1, 0, outlines.shape[1] - 1)
    lines = (
        grid.lines.flank if grid.lines.flank.ndim == 2 else np.repeat(grid.lines.flank[:, None], len(grid.t), axis=1)
    )
    y_share = np.clip((t - grid.t[column]) / (grid.t[column + 1] - grid.t[column]), 0.0, 1.0)
    lines_at = (1.0 - y_share) * lines[:, column] + y_share * lines[:, column + 1]
    row = np.clip((lines_at < s).sum(axis=0) - 1, 0, outlines.shape[0] - 1)
    low, high = (np.take_along_axis(lines_at, (row + k)[None], axis=0)[0] for k in (0, 1))
    x_share = np.clip((s - low) / (high - low), 0.0, 1.0)
    functions = _shape_functions(x_share, y_share, side, mesh.second_order)
    share = np.zeros(len(mesh.nodes))
    np.add.at(share, outlines[row, column], weight[:, None] * functions)
    nodes = np.flatnonzero(share)
    inward = at.frame.vector(at.path.normal[0]) * (-1.0 if member_index == 0 else 1.0)
    return NodeForces(nodes, at.force * share[nodes, None] / share.sum() * inward)


def _shape_functions(x: Array, y: Array, side: Side, second_order: bool) -> Array:
    """Return shares (K, 4 or 8) that the nodes of a flank's face take of a load at x, y (K,), 0 .. 1 along s and t.

    Faces of second order use all eight nodes.
    """
    corners = 2.0 * np.array(_FACE_CORNERS[side]) - 1.0
    xi, eta = (2.0 * x - 1.0)[:, None], (2.0 * y - 1.0)[:, None]
    product = 0.25 * (1.0 + xi * corners[:, 0]) * (1.0 + eta * corners[:, 1])
    if not second_order:
        return product
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    result = np.empty((len(x), 8))
    result[:, ::2] = product * (xi * corners[:, 0] + eta * corners[:, 1] - 1.0)
    result[:, 1::2] = 0.5 * np.where(
        middles[:, 0] == 0.0,
        (1.0 - xi**2) * (1.0 + eta * middles[:, 1]),
        (1.0 - eta**2) * (1.0 + xi * middles[:, 0]),
    )
    return result


def _pressure_points(focus: Focus, at: PlacedPair) -> tuple[Array, Array, Array]:
    """Return places s, t (K,) on the flank and shares (K,) of the pressure there.

    The pressure is a semi-ellipsoid, or a semi-ellipse along a line of contact; an edge has a single place.
    """
    if np.isnan(at.pressure):
        return np.array([focus.s]), np.array([focus.t]), np.ones(1)
    nodes, weights = np.polynomial.legendre.leggauss(PRESSURE_POINTS)
    if at.path.lines[0] is not None:
        t = focus.half_t * np.linspace(-1.0, 1.0, 2 * LINE_POINTS + 1)[None, 1::2]
        s = focus.half_s * nodes[:, None] + focus.slope * t
        t = np.broadcast_to(t, s.shape)
        share = np.broadcast_to((weights * np.sqrt(1.0 - nodes**2))[:, None], s.shape)
    else:
        radius, angle = 0.5 * (nodes + 1.0), np.pi * np.arange(2 * PRESSURE_POINTS) / PRESSURE_POINTS
        t = focus.half_t * radius[:, None] * np.cos(angle)
        s = focus.half_s * radius[:, None] * np.sin(angle) + focus.slope * t
        share = np.broadcast_to((weights * radius * np.sqrt(1.0 - radius**2))[:, None], s.shape)
    return (focus.s + s).ravel(), (focus.t + t).ravel(), share.ravel()


#: triangles of a face's outline, with 4 corners or with mid-side nodes between them
_FACE_TRIANGLES = {
    4: [(0, 1, 2), (0, 2, 3)],
    8: [(0, 1, 7), (2, 3, 1), (4, 5, 3), (6, 7, 5), (1, 3, 5), (1, 5, 7)],
}
#: steps (s, t) of the corners of a flank's faces, in the order of `HexMesh.face_corners`
_FACE_CORNERS = {Side.RIGHT: ((1, 0), (1, 1), (0, 1), (0, 0)), Side.LEFT: ((0, 0), (0, 1), (1, 1), (1, 0))}
