"""Finite-element models of gears: teeth in mesh as tooth contact analysis places them, or one member under the same load.

The model's frame is the pinion's bearing (its axis of rotation is z): one rotation is then all that a torque or a prescribed
angle needs. The gear is held at its rim and at the cut faces; the pinion's are rigid, and turn about z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmesh.contact import hertz_path, solver_pair
from gearmesh.errors import NoSolutionError
from gearmesh.fe_model import STIFFNESS_RATIO, ContactPair, Model, NodeForces, RigidTie, Support
from gearmesh.frames import Array, Rigid
from gearmesh.hertz import STEEL, Material
from gearmesh.hexmesh import Cells, Focus, HexGrid, focused_grid, hex_mesh, plain_grid
from gearmesh.mesh import HexMesh, joined
from gearmesh.pair import GearPair
from gearmesh.path import ContactPath
from gearmesh.tca import contact_path
from gearmesh.tooth import Tooth

#: step in s and t of the difference quotients that give the directions of the flank's lines
STEP = 1e-4
#: points along the radius at which the pressure on a loaded ellipse is taken
PRESSURE_POINTS = 12
#: neighbouring tooth pairs among which the leading one is looked for, either way
NEIGHBOURS = 1


@dataclass(frozen=True)
class Request:
    """What a model shall hold.

    `members`: "pinion", "gear" or both, in mesh; `teeth` of each, None for all; `cells`: least numbers of elements;
    `ellipse`: elements over each half axis of the contact ellipse, 0 for evenly spaced lines; `rim`: mm under the root, None
    for the default; `torque` (N mm) on the pinion in the sense that drives, or the `rotation` (rad) it is turned by instead.
    """

    members: tuple[str, ...] = ("pinion", "gear")
    teeth: int | None = 3
    cells: Cells = Cells()
    ellipse: int = 0
    rim: float | None = None
    second_order: bool = False
    torque: float = 1e5
    rotation: float | None = None
    materials: tuple[Material, Material] = (STEEL, STEEL)


@dataclass(frozen=True)
class Placed:
    """The leading tooth pair at a position: its contact (a path of one position), loaded by all of the torque.

    `force` N; `semi_major`, `semi_minor` mm of the loaded ellipse and `pressure` MPa at its middle by Hertz, NaN at an edge.
    `frame`: the fixed frame in the model's.
    """

    path: ContactPath
    force: float
    pressure: float
    semi_major: float
    semi_minor: float
    approach: float
    frame: Rigid

    @property
    def turns(self) -> dict[str, float]:
        """Rotations of the members, rad."""
        return {"pinion": float(self.path.rotation[0]), "gear": float(self.path.phi2[0])}


def placed(pair: GearPair, phi1: float, request: Request) -> Placed:
    """Where the members stand at phi1 (rad, counted as the source counts it), the gear as far on as the leading teeth push it.

    Raises NoSolutionError if no teeth touch there.
    """
    flanks = solver_pair(pair)
    start = contact_path(flanks, np.array([phi1]), pair.generation)
    turns = float(start.rotation[0]) if start.touching[0] else phi1
    path = contact_path(flanks, turns + pair.assembly.pitch * np.arange(-NEIGHBOURS, NEIGHBOURS + 1.0))
    if not path.touching.any():
        raise NoSolutionError(f"no teeth touch at phi1 = {np.degrees(phi1):g} deg; tca shows where they do")
    ahead = np.where(path.touching, pair.drive * path.te, -np.inf)
    leading = contact_path(flanks, path.phi1[[int(np.argmax(ahead))]])
    hertz = hertz_path(pair, leading, 1e-3 * request.torque, request.materials)
    return Placed(
        leading,
        force=float(hertz.force[0]),
        pressure=float(hertz.peak_pressure[0]),
        semi_major=float(hertz.semi_major[0]),
        semi_minor=float(hertz.semi_minor[0]),
        approach=float(hertz.approach[0]),
        frame=pair.assembly.pinion.base.inverse,
    )


def gear_model(pair: GearPair, request: Request, at: Placed, title: str = "gearmesh") -> Model:
    """The model of the members asked for, at a position found by `placed`.

    Sets are those of `hex_mesh` with pinion_ or gear_ before them, and pinion_held, gear_held: rim and cut faces. Raises
    TrimError for teeth that cannot be trimmed, DesignError for a rim that does not fit.
    """
    meshes = {name: member_mesh(pair, name, request, at) for name in request.members}
    mesh = joined(meshes)
    materials = dict(zip(("pinion", "gear"), request.materials, strict=True))
    model = Model(title, mesh, {name: materials[name] for name in request.members})
    if len(request.members) == 1:
        (name,) = request.members
        return replace(
            model, supports=(Support(f"{name}_held"),), forces=(_hertz_forces(pair, name, model, request, at),)
        )
    stiffness = STIFFNESS_RATIO * max(material.youngs_modulus for material in request.materials)
    arm = float(np.cross(at.frame.point(at.path.point[0]), at.frame.vector(at.path.normal[0]))[2])
    # the pinion pushes with its outward normal
    sense = float(np.sign(arm))
    if request.rotation is None:
        tie = RigidTie("pinion_held", np.zeros(3), load=(0.0,) * 5 + (sense * request.torque,))
    else:
        tie = RigidTie("pinion_held", np.zeros(3), motion=(0.0,) * 5 + (sense * request.rotation,))
    return replace(
        model,
        supports=(Support("gear_held"),),
        ties=(tie,),
        contacts=tuple(ContactPair(*names, stiffness) for names in facing(mesh, pair.flanks)),
    )


def member_mesh(pair: GearPair, name: str, request: Request, at: Placed) -> HexMesh:
    """One member's mesh in the model's frame, its fine lines round the contact point of the leading tooth."""
    member, mount = pair.members[name], getattr(pair.assembly, name)
    grid = grid_of(pair, name, request, at)
    count = min(request.teeth or member.tooth.teeth, member.tooth.teeth)
    teeth = np.arange(count) - (count - 1) // 2
    mesh = hex_mesh(member.tooth, teeth, grid, request.rim, second_order=request.second_order)
    held = [mesh.node_sets[key] for key in ("rim", "cut_right", "cut_left") if key in mesh.node_sets]
    mesh = replace(mesh, node_sets=mesh.node_sets | {"held": np.unique(np.concatenate(held))})
    return mesh.moved(at.frame @ mount.at(at.turns[name]))


def grid_of(pair: GearPair, name: str, request: Request, at: Placed) -> HexGrid:
    """Lines of a member: even, or following the loaded ellipse if elements over it are asked for and there is one."""
    if not request.ellipse or np.isnan(at.pressure):
        return plain_grid(request.cells)
    return focused_grid(request.cells, focus_on(pair, name, at, request.ellipse))


def focus_on(pair: GearPair, name: str, at: Placed, cells: int = 1) -> Focus:
    """The loaded ellipse (or line, or point on an edge) in the coordinates of a member's working flank."""
    first = name == "pinion"
    tooth, side = pair.members[name].tooth, pair.flanks[not first]
    own = getattr(pair.assembly, name).at(at.turns[name]).inverse
    s, t = flank_place(tooth, side, (at.path.params1 if first else at.path.params2)[0])
    if np.isnan(at.pressure):
        return Focus(s, t, 0.0, 0.0, 0.0, 0.0, cells)
    # differences inside the flank: its grid ends at 0 and 1
    s_mid, t_mid = (float(np.clip(x, 2.0 * STEP, 1.0 - 2.0 * STEP)) for x in (s, t))
    nodes = STEP * np.array([-1.0, 1.0])
    points = tooth.flank_grid(side, s_mid + nodes, t_mid + nodes).points
    along_s = (points[1, 0] + points[1, 1] - points[0, 0] - points[0, 1]) / (4.0 * STEP)
    along_t = (points[0, 1] + points[1, 1] - points[0, 0] - points[1, 0]) / (4.0 * STEP)
    axes = own.vector(np.stack((at.semi_major * _major(at.path), at.semi_minor * _minor(at.path))))
    in_plane = np.linalg.lstsq(np.stack((along_s, along_t), axis=-1), axes.T, rcond=None)[0]
    inverse = in_plane @ in_plane.T
    form = np.linalg.inv(inverse)
    here, there = (
        tooth.flank_grid(name, np.array([s_mid]), np.array([t_mid])).points[0, 0] for name in ("right", "left")
    )
    return Focus(
        s,
        t,
        slope=float(-form[0, 1] / form[0, 0]),
        half_s=1.0 / float(np.sqrt(form[0, 0])),
        half_t=float(np.sqrt(inverse[1, 1])),
        half_depth=2.0 * at.semi_minor / float(np.linalg.norm(here - there)),
        cells=cells,
    )


def flank_place(tooth: Tooth, side: str, params: Array) -> tuple[float, float]:
    """Coordinates (s, t) on the trimmed flank, s from joint to tip, of a point with surface parameters (2,)."""
    flank = getattr(tooth, side).flank
    toe, heel = tooth.blank.extent
    t = float((tooth.blank.axial.value(flank.jet(*params).r) - toe) / (heel - toe))
    ends = tooth.flank_grid(side, np.array([0.0, 1.0]), np.array([np.clip(t, 0.0, 1.0)])).p
    assert ends is not None
    return float((params[0] - ends[0, 0]) / (ends[1, 0] - ends[0, 0])), t


def _major(path: ContactPath) -> Array:
    """Unit vector along the major axis, or along a line of contact from its first to its last point; fixed frame."""
    line = path.lines[0]
    if line is None:
        return path.major[0]
    return (line[-1] - line[0]) / np.linalg.norm(line[-1] - line[0])


def _minor(path: ContactPath) -> Array:
    return path.minor[0] if path.lines[0] is None else np.cross(path.normal[0], _major(path))


def facing(mesh: HexMesh, flanks: tuple[str, str]) -> list[tuple[str, str]]:
    """Face sets (of the pinion, of the gear) of the working flanks that face each other, by their nearest middles."""
    names = [
        [name for name in mesh.face_sets if name.startswith(f"{member}_flank_{side}_")]
        for member, side in zip(("pinion", "gear"), flanks, strict=True)
    ]
    middles = [np.array([mesh.nodes[mesh.face_corners(n)].mean(axis=(0, 1)) for n in each]) for each in names]
    apart = np.linalg.norm(middles[0][:, None] - middles[1][None], axis=-1)
    nearest = apart.argmin(axis=1)
    mutual = [i for i in range(len(names[0])) if apart[:, nearest[i]].argmin() == i]
    return [(names[0][i], names[1][nearest[i]]) for i in mutual]


def _hertz_forces(pair: GearPair, name: str, model: Model, request: Request, at: Placed) -> NodeForces:
    """The Hertz pressure of the leading contact as forces on nodes of the loaded flank, statically equal to it."""
    first = name == "pinion"
    side, mesh = pair.flanks[not first], model.mesh
    grid = grid_of(pair, name, request, at)
    focus = focus_on(pair, name, at)
    s, t, weight = _pressed(focus, not np.isnan(at.pressure))
    count = sum(key.startswith(f"{name}_flank_{side}_") for key in mesh.face_sets)
    corners = mesh.face_corners(f"{name}_flank_{side}_{(count - 1) // 2 + 1}").reshape(-1, len(grid.t) - 1, 4)
    column = np.clip(np.searchsorted(grid.t, t) - 1, 0, corners.shape[1] - 1)
    lines = (
        grid.lines.flank if grid.lines.flank.ndim == 2 else np.repeat(grid.lines.flank[:, None], len(grid.t), axis=1)
    )
    y = np.clip((t - grid.t[column]) / (grid.t[column + 1] - grid.t[column]), 0.0, 1.0)
    across = (1.0 - y) * lines[:, column] + y * lines[:, column + 1]
    row = np.clip((across < s).sum(axis=0) - 1, 0, corners.shape[0] - 1)
    low, high = (np.take_along_axis(across, (row + k)[None], axis=0)[0] for k in (0, 1))
    x = np.clip((s - low) / (high - low), 0.0, 1.0)
    share = np.zeros(len(mesh.nodes))
    for k, (ahead, beyond) in enumerate(_FACE_CORNERS[side]):
        part = weight * (x if ahead else 1.0 - x) * (y if beyond else 1.0 - y)
        np.add.at(share, corners[row, column, k], part)
    nodes = np.flatnonzero(share)
    into = at.frame.vector(at.path.normal[0]) * (-1.0 if first else 1.0)
    return NodeForces(nodes, at.force * share[nodes, None] / share.sum() * into)


def _pressed(focus: Focus, spread: bool) -> tuple[Array, Array, Array]:
    """Places (s, t) on the flank and shares (K,) of a semi-ellipsoid of pressure; a single place for an edge."""
    if not spread:
        return np.array([focus.s]), np.array([focus.t]), np.ones(1)
    nodes, weights = np.polynomial.legendre.leggauss(PRESSURE_POINTS)
    radius, angle = 0.5 * (nodes + 1.0), np.pi * np.arange(2 * PRESSURE_POINTS) / PRESSURE_POINTS
    t = focus.half_t * radius[:, None] * np.cos(angle)
    s = focus.half_s * radius[:, None] * np.sin(angle) + focus.slope * t
    share = np.broadcast_to((weights * radius * np.sqrt(1.0 - radius**2))[:, None], s.shape)
    return (focus.s + s).ravel(), (focus.t + t).ravel(), share.ravel()


#: steps (s, t) of the corners of a flank's faces, in the order of `HexMesh.face_corners`
_FACE_CORNERS = {"right": ((1, 0), (1, 1), (0, 1), (0, 0)), "left": ((0, 0), (0, 1), (1, 1), (1, 0))}
