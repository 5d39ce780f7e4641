"""Finite-element models of gears: teeth in mesh as tooth contact analysis places them, one member under the same load, or one
without a mating gear, held and not loaded, in its own frame.

The model's frame is the pinion's bearing (its axis of rotation is z): one rotation is then all that a torque or a prescribed
angle needs. The gear is held at its rim and at the cut faces; the pinion's are rigid, and turn about z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmesh.contact.hertz import STEEL, Material
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.fe.model import ContactPair, CyclicSymmetry, Model, NodeForces, RigidTie, Support
from gearmesh.fe.placing import PlacedPair, arc_centre, focus_on, major_axis, neighbours, stations_under_load
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, plane_cross, unit
from gearmesh.mesh.hexahedra.cyclic import pair_cuts
from gearmesh.mesh.hexahedra.hexahedra import Cells, CoarsestLines, Focus, HexGrid, focused_grid, hex_mesh, plain_grid
from gearmesh.mesh.hexahedra.hexes import HexMesh, join
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.mesh.hexahedra.turned_body import CORE_SET, SHAFT_END_SET, whole_mesh
from gearmesh.progress import in_turn, part
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import CUT_REGIONS, Side
from gearmesh.teeth.tooth import Tooth

#: overclosure that a model under a torque starts with, over the approach by Hertz. CalculiX makes contact elements only where
#: faces overlap, so that flanks that just touch at a point have none, and a pinion free to turn is singular. From 0.3 to 1
#: it takes 4 to 7 iterations, from 0.01 19; the solution does not depend on it
OVERCLOSURE = 0.5
#: nor has it any where only a corner of a face overlaps: it looks inside of faces, and facets that touch at a node are apart
#: there, more so the coarser they are. The overlap is at least so many times that
BEYOND_APART = 1.5
#: places across a face, of its sides, inside of which contact is looked for
INNER = (0.2, 0.5, 0.8)
#: where facets may touch first: this many semi-axes of the contact, lengthened by an element
NEAR = 2.0
#: elements over a semi-axis of the contact ellipse, and into the tooth over the smaller one, that resolve the pressure; sag of
#: an element's edge along the ellipse over the approach of the flanks. One pair of bevel teeth (spiral_bevel_basic, 50 Nm, half
#: axes 6.6 and 0.21 mm) with 4 elements over each semi-axis sags by 0.46 and is pressed 23 % harder than by Hertz; with 12 along,
#: 4 across and 0.7 inwards, which sag by 0.05, 7 % less than by Hertz, with twice as many inwards 12 % less
OVER, INWARDS, SAG = 4.0, 0.7, 0.11
#: penetration of the contact springs under the largest pressure over the approach of the flanks, both by Hertz. Harder springs
#: press where facets happen to stand out: crossed cylinders (semi-axes 2.4 and 0.7 mm) in meshes of 4 and 5 elements over a
#: semi-axis have pressures that scatter by 6.5 % of the largest with 0.006 and by 2.7 % with 0.015; the contact's area is 0.91
#: and 0.98 of Hertz's, the largest pressure 1.08 and 1.01; with 0.03 the area is 1.04, the pressure 0.98
SPRINGS = 0.015
#: the same where contact is on an edge: contact stiffness over Young's modulus, 1/mm; converges where harder springs do not
EDGE_STIFFNESS = 50.0
#: where a member is held, the first of these sets that it has
HELD = ("rim", "bore", SHAFT_END_SET, CORE_SET)
#: default numbers of elements
CELLS = Cells()
#: points along the radius at which the pressure on a loaded ellipse is taken
PRESSURE_POINTS = 12
#: points along a line of contact, many for each element
LINE_POINTS = 1000


@dataclass(frozen=True)
class MeshRequest:
    """What every member's mesh shall hold, in contact or without.

    `teeth`: their number, None for all; `cells`: numbers of elements; `rim`: mm under the root, None for the default; `sector`:
    instead of some teeth so many pitches, for cyclic symmetry; `whole`: with the body under the rim, as it is turned, its
    elements of about `size` (mm).
    """

    teeth: int | None = 3
    cells: Cells = CELLS
    rim: float | None = None
    second_order: bool = False
    sector: int | None = None
    whole: bool = False
    size: float | None = None


@dataclass(frozen=True)
class Request(MeshRequest):
    """What a model of a pair shall hold.

    `members`: "pinion", "gear" or both, in mesh; `ellipse`: elements over each semi-axis of the contact ellipse, 0 for what
    `cells` allow; `even`: evenly spaced lines; `torque` (N mm) on the pinion in the sense that drives, or the
    `rotation` (rad) it is turned by instead; `friction`: coefficient of Coulomb on the flanks; `resolved`: more
    lines than `cells` say where the contact ellipse takes them; `every_tooth`: lines follow the contact on the teeth beside the
    leading ones too.
    """

    members: tuple[str, ...] = ("pinion", "gear")
    ellipse: int = 0
    even: bool = False
    torque: float = 1e5
    rotation: float | None = None
    friction: float = 0.0
    resolved: bool = False
    materials: tuple[Material, Material] = (STEEL, STEEL)
    every_tooth: bool = False


@dataclass(frozen=True)
class GearModel:
    """A model of gears, and how it was placed.

    `preload`: angle (rad) by which the pinion was turned into the gear beforehand, to be added to the rotation that a solver
    finds under a torque: half the approach by Hertz, or more where facets are coarse; `gap`: of the facets, mm, where the
    flanks touch; the gear was turned back by it.
    """

    model: Model
    at: PlacedPair
    preload: float
    gap: float


def gear_model(pair: GearPair, request: Request, at: PlacedPair, title: str = "gearmesh") -> GearModel:
    """The model of the members asked for, at a position found by `placing.place`.

    Sets are those of `hex_mesh` with pinion_ or gear_ before them, and pinion_held, gear_held: rim and cut faces. Raises
    TrimError for teeth that cannot be trimmed, DesignError for a rim that does not fit.
    """
    with part(0.0, 0.5):
        own = {name: member_mesh(pair, name, request, at) for name in in_turn(request.members)}
    turns, both = list(at.turns), len(request.members) == 2
    gap = preload = 0.0
    if both:
        with part(0.5, 0.9):
            gap, apart = _facet_gap(pair, own, at)
        lever = float(at.path.normal[0] @ pair.gear.mount.velocity(at.path.point[0]))
        turns[1] -= pair.drive * gap / abs(lever)
        overlap = max(OVERCLOSURE * at.approach, BEYOND_APART * apart)
        preload = overlap / abs(at.arm) if request.rotation is None else 0.0
    placed = {
        name: mesh.move(at.frame @ pair.members[name].mount.at(turns[pair.index(name)])) for name, mesh in own.items()
    }
    if both:
        placed[pair.pinion.name] = placed[pair.pinion.name].move(Rigid.about_z(at.sense * preload))
    mesh = join(placed)
    materials = dict(zip(pair.members, request.materials, strict=True))
    model = Model(title, mesh, {name: materials[name] for name in request.members})
    if both:
        model = _in_contact(model, pair, request, at)
    else:
        (name,) = request.members
        forces = _hertz_forces(pair, name, model, request, at)
        model = replace(model, supports=(Support(f"{name}_held"),), forces=(forces,))
        own_to_model = at.frame @ pair.members[name].mount.at(turns[pair.index(name)])
        model = replace(model, cyclic=cyclic_symmetry(pair.members[name], request, own_to_model))
    return GearModel(model, at, preload, gap)


def _in_contact(model: Model, pair: GearPair, request: Request, at: PlacedPair) -> Model:
    """The gear held, the pinion's rim rigid and turned, the facing flanks of teeth in contact."""
    turned = f"{pair.pinion.name}_held"
    if request.rotation is None:
        tie = RigidTie(turned, np.zeros(3), load=(0.0,) * 5 + (at.sense * request.torque,))
    else:
        tie = RigidTie(turned, np.zeros(3), motion=(0.0,) * 5 + (at.sense * request.rotation,))
    stiffness = contact_stiffness(request.materials, at)
    contacts = tuple(ContactPair(*names, stiffness, request.friction) for names in facing(model.mesh, pair))
    return replace(model, supports=(Support(f"{pair.gear.name}_held"),), ties=(tie,), contacts=contacts)


def contact_stiffness(materials: tuple[Material, Material], at: PlacedPair) -> float:
    """Pressure over penetration, MPa/mm, of the contact springs between flanks of a placed pair."""
    if np.isnan(at.pressure):
        return EDGE_STIFFNESS * max(material.youngs_modulus for material in materials)
    return at.pressure / (SPRINGS * at.approach)


def member_mesh(pair: GearPair, name: str, request: Request, at: PlacedPair) -> HexMesh:
    """One member's mesh in its own frame, its fine lines round the contact point of the leading tooth; with the set held."""
    return held_mesh(pair.members[name], request, grid_of(pair, name, request, at))


def held_mesh(member: Member, request: MeshRequest, grid: HexGrid) -> HexMesh:
    """One member's mesh in its own frame, its lines those of a grid; with the set held: rim or, of a whole body, bore (without one
    the ends of its shafts, or else the core) and cut faces, of a sector without these."""
    tooth = member.one_tooth
    whole = tooth.teeth if tooth.screw is None else _threads_in_length(tooth)
    count = min(request.sector or request.teeth or whole, whole)
    teeth = np.arange(count) - (count - 1) // 2
    if request.whole:
        body = member.turned_body
        if body is None or tooth.screw is not None:
            why = f"hexahedra of the {member.name} end with its rim, as of all racks, threads and double helical gears"
            raise DesignError("fe.body", "whole", reason=why, allowed='"rim"')
        mesh = whole_mesh(tooth, body, teeth, grid, request.rim, request.size, second_order=request.second_order)
    else:
        mesh = hex_mesh(tooth, teeth, grid, request.rim, second_order=request.second_order)
    inner = next(name for name in HELD if name in mesh.node_sets)
    if request.sector is not None:
        mesh = pair_cuts(mesh, tooth.joint.to(request.sector * tooth.pitch_angle))
        # what follows the first cut face is held with it
        own = np.setdiff1d(mesh.node_sets[inner], mesh.node_sets["cut_left"])
        return replace(mesh, node_sets=mesh.node_sets | {"held": own})
    # an arc of threads is cut at its ends too
    cuts = CUT_REGIONS if tooth.screw is None else (*CUT_REGIONS, "toe", "heel")
    held = [mesh.node_sets[key] for key in (inner, *cuts) if key in mesh.node_sets]
    return replace(mesh, node_sets=mesh.node_sets | {"held": np.unique(np.concatenate(held))})


def _threads_in_length(tooth: Tooth) -> int:
    """How many threads follow each other along a member, an odd number."""
    toe, heel = tooth.blank.extent
    return 2 * int(0.5 * abs((heel - toe) / layers(tooth, [0.5]).step.translation[2])) + 1


def cyclic_symmetry(member: Member, request: MeshRequest, own_to_model: Rigid) -> CyclicSymmetry | None:
    """That of the sector of a member in a model's frame; None where none is asked for."""
    if request.sector is None:
        return None
    first, last = (f"{member.name}_{region}" for region in CUT_REGIONS)
    axis = own_to_model.point(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    return CyclicSymmetry(member.tooth.teeth // request.sector, first, last, axis)


def check_sector(member: Member, pitches: int) -> None:
    """Raise DesignError for pitches that do not divide a member, and for one that does not turn."""
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
    """The model of a member without a mating gear: held as in a pair, not loaded, its lines evenly spaced; its own frame.

    Sets are those of `gear_model`. Raises TrimError for teeth that cannot be trimmed, DesignError for a rim that does not fit.
    """
    name = member.name
    mesh = join({name: held_mesh(member, request, plain_grid(request.cells))})
    cyclic = cyclic_symmetry(member, request, Rigid.identity())
    return Model(title, mesh, {name: material}, supports=(Support(f"{name}_held"),), cyclic=cyclic)


def grid_of(pair: GearPair, name: str, request: Request, at: PlacedPair) -> HexGrid:
    """Lines of a member, following the loaded ellipse unless they shall be even or there is none."""
    which = pair.index(name)
    params = (at.path.params1, at.path.params2)[which][0]
    centre = arc_centre(pair.both[which].tooth, pair.flanks[which], params)
    if request.even or np.isnan(at.pressure):
        return replace(plain_grid(request.cells), centre=centre)
    near = neighbours(pair, at, request.torque, request.materials) if request.every_tooth else {}
    # where a thread wedges itself in, its flank slides far along the gear's before it carries the load
    slides = which == 0 and pair.pinion.tooth.screw is not None and len(request.members) == 2
    focus, beside = focus_on(pair, name, at, request.ellipse, turned=slides), {}
    for places, beside_at in near.items():
        own = focus_on(pair, name, beside_at, request.ellipse)
        # on an edge the contact under load is about as large as the leading one
        beside[places[pair.index(name)]] = replace(focus, s=own.s, t=own.t) if np.isnan(beside_at.pressure) else own
    wanted = resolving(request.second_order, at.approach) if request.resolved else None
    shared = stations_under_load(pair, grid_of(pair, pair.gear.name, request, at), at) if slides else None
    return replace(focused_grid(request.cells, focus, beside, wanted, shared), centre=centre)


def resolving(second_order: bool, approach: float) -> CoarsestLines:
    """The coarsest lines over the contact ellipse that resolve its pressure; edges of second order follow the flank."""
    return (
        CoarsestLines(0.5 * OVER, 0.5 * INWARDS, np.inf)
        if second_order
        else CoarsestLines(OVER, INWARDS, SAG * approach)
    )


def _facet_gap(pair: GearPair, meshes: dict[str, HexMesh], at: PlacedPair) -> tuple[float, float]:
    """Smallest gap (mm), along the normal of contact, between the leading flanks' nodes and the facets of the other; and how far
    the insides of the pinion's faces, where CalculiX looks for contact, are from the gear's facets at least once that is closed.

    The flanks themselves touch there; facets of convex flanks lie below them. Both are taken as heights over the common
    tangent plane, within `NEAR` semi-axes of the contact, each lengthened by an element.
    """
    normal = at.path.normal[0]
    along = unit(np.cross(normal, np.eye(3)[np.abs(normal).argmin()]))
    half = np.zeros(2)
    if not np.isnan(at.pressure):
        along, half = major_axis(at.path), np.array([at.semi_major, at.semi_minor])
    axes = np.stack((along, np.cross(normal, along), normal), axis=-1)
    faces = []
    for (name, mesh), side in zip(meshes.items(), pair.flanks, strict=True):
        own_to_fixed = pair.members[name].mount.at(at.turns[pair.index(name)])
        outlines = mesh.face_outlines(f"flank_{side}_{_leading(mesh, side)}")
        faces.append((own_to_fixed.point(mesh.nodes[outlines]) - at.path.point[0]) @ axes)
    nearest = [face[np.linalg.norm(face.mean(axis=1), axis=-1).argmin()] for face in faces]
    window = NEAR * (half + np.max([np.ptp(face[:, :2], axis=0) for face in nearest], axis=0))
    near = [face[(np.abs(face[..., :2]).min(axis=1) < window).all(axis=1)] for face in faces]
    gaps = np.concatenate((_heights(near[1], near[0]), -_heights(near[0], near[1])))
    if not gaps.size:
        return 0.0, 0.0
    inside = -_heights(_inner(near[0]), near[1])
    return float(gaps.min()), float(max(inside.min() - gaps.min(), 0.0)) if inside.size else 0.0


def _inner(faces: Array) -> Array:
    """Places (K, 1, 3) inside of faces (P, 4 or 8, 3), taken as those between their corners."""
    corners = faces[:, :: faces.shape[1] // 4]
    u, v = (axis.ravel() for axis in np.meshgrid(INNER, INNER))
    weights = np.stack(((1.0 - u) * (1.0 - v), u * (1.0 - v), u * v, (1.0 - u) * v), axis=-1)
    points: Array = np.einsum("ki,pij->pkj", weights, corners).reshape(-1, 1, 3)
    return points


def _heights(faces: Array, under: Array) -> Array:
    """Heights z (K,) of the nodes of faces (P, 4 or 8, 3) over the triangles of faces (Q, 4 or 8, 3) that they lie over."""
    # by rising x, so that those between the least and the largest x of a triangle follow each other
    points = np.unique(faces.reshape(-1, 3), axis=0)
    triangles = under[:, _FANS[under.shape[1]]].reshape(-1, 3, 3)
    begin, end = (
        points[:, 0].searchsorted(triangles[..., 0].min(axis=1)),
        points[:, 0].searchsorted(triangles[..., 0].max(axis=1), "right"),
    )
    count = end - begin
    which = np.repeat(np.arange(len(triangles)), count)
    point = points[np.arange(len(which)) + np.repeat(begin - np.cumsum(count) + count, count)]
    a, b, c = np.moveaxis(triangles[which], 1, 0)
    first, second, from_a = b - a, c - a, point - a
    area = plane_cross(first, second)
    with np.errstate(all="ignore"):
        u, v = plane_cross(from_a, second) / area, plane_cross(first, from_a) / area
    over = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0)
    heights: Array = (from_a[:, 2] - u * first[:, 2] - v * second[:, 2])[over]
    return heights


def _leading(mesh: HexMesh, side: Side, prefix: str = "") -> int:
    """Number of the tooth on +x."""
    return (sum(name.startswith(f"{prefix}flank_{side}_") for name in mesh.face_sets) - 1) // 2 + 1


def facing(mesh: HexMesh, pair: GearPair) -> list[tuple[str, str]]:
    """Face sets (of the pinion, of the gear) of the working flanks that face each other, by their nearest middles."""
    names = [
        [name for name in mesh.face_sets if name.startswith(f"{member}_flank_{side}_")]
        for member, side in zip(pair.members, pair.flanks, strict=True)
    ]
    middles = [np.array([mesh.nodes[mesh.face_corners(n)].mean(axis=(0, 1)) for n in own]) for own in names]
    apart = np.linalg.norm(middles[0][:, None] - middles[1][None], axis=-1)
    nearest = apart.argmin(axis=1)
    mutual = [i for i in range(len(names[0])) if apart[:, nearest[i]].argmin() == i]
    return [(names[0][i], names[1][nearest[i]]) for i in mutual]


def _hertz_forces(pair: GearPair, name: str, model: Model, request: Request, at: PlacedPair) -> NodeForces:
    """The Hertz pressure of the leading contact as forces on nodes of the loaded flank, statically equal to it."""
    which = pair.index(name)
    side, mesh = pair.flanks[which], model.mesh
    grid = grid_of(pair, name, request, at)
    s, t, weight = _pressure_points(focus_on(pair, name, at), at)
    flank = f"{name}_flank_{side}_{_leading(mesh, side, f'{name}_')}"
    outlines = mesh.face_outlines(flank)
    outlines = outlines.reshape(-1, len(grid.t) - 1, outlines.shape[1])
    column = np.clip(np.searchsorted(grid.t, t) - 1, 0, outlines.shape[1] - 1)
    lines = (
        grid.lines.flank if grid.lines.flank.ndim == 2 else np.repeat(grid.lines.flank[:, None], len(grid.t), axis=1)
    )
    y = np.clip((t - grid.t[column]) / (grid.t[column + 1] - grid.t[column]), 0.0, 1.0)
    across = (1.0 - y) * lines[:, column] + y * lines[:, column + 1]
    row = np.clip((across < s).sum(axis=0) - 1, 0, outlines.shape[0] - 1)
    low, high = (np.take_along_axis(across, (row + k)[None], axis=0)[0] for k in (0, 1))
    x = np.clip((s - low) / (high - low), 0.0, 1.0)
    functions = _shape_functions(x, y, side, mesh.second_order)
    share = np.zeros(len(mesh.nodes))
    np.add.at(share, outlines[row, column], weight[:, None] * functions)
    nodes = np.flatnonzero(share)
    into = at.frame.vector(at.path.normal[0]) * (-1.0 if which == 0 else 1.0)
    return NodeForces(nodes, at.force * share[nodes, None] / share.sum() * into)


def _shape_functions(x: Array, y: Array, side: Side, second_order: bool) -> Array:
    """Shares (K, 4 or 8) of a load at x, y (K,), 0 .. 1 along s and t of a flank's face, that its nodes take.

    Of second-order faces all eight nodes: with corners alone C3D20R moved 20 times as far under a line of contact.
    """
    corners = 2.0 * np.array(_FACE_CORNERS[side]) - 1.0
    along, beyond = (2.0 * x - 1.0)[:, None], (2.0 * y - 1.0)[:, None]
    product = 0.25 * (1.0 + along * corners[:, 0]) * (1.0 + beyond * corners[:, 1])
    if not second_order:
        return product
    middles = 0.5 * (corners + np.roll(corners, -1, axis=0))
    result = np.empty((len(x), 8))
    result[:, ::2] = product * (along * corners[:, 0] + beyond * corners[:, 1] - 1.0)
    result[:, 1::2] = 0.5 * np.where(
        middles[:, 0] == 0.0,
        (1.0 - along**2) * (1.0 + beyond * middles[:, 1]),
        (1.0 - beyond**2) * (1.0 + along * middles[:, 0]),
    )
    return result


def _pressure_points(focus: Focus, at: PlacedPair) -> tuple[Array, Array, Array]:
    """Places (s, t) on the flank and shares (K,) of a semi-ellipsoid of pressure, of a semi-ellipse all along a line of
    contact; a single place for an edge.
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
_FANS = {
    4: [(0, 1, 2), (0, 2, 3)],
    8: [(0, 1, 7), (2, 3, 1), (4, 5, 3), (6, 7, 5), (1, 3, 5), (1, 5, 7)],
}
#: steps (s, t) of the corners of a flank's faces, in the order of `HexMesh.face_corners`
_FACE_CORNERS = {Side.RIGHT: ((1, 0), (1, 1), (0, 1), (0, 0)), Side.LEFT: ((0, 0), (0, 1), (1, 1), (1, 0))}
