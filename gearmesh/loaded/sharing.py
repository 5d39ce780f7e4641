"""A mesh under torque: load sharing of the tooth pairs, pressures, and rotation of the gears against the unloaded ones.

At every position of the pinion the gaps of all near tooth pairs (`separation`), the compliance of both members (`compliance`), the
local contact compliance of both flanks and the torque make one problem of contact (`complementarity`). The rotation
theta is that of the pinion against the held gear; the gear stays behind by theta N1/N2, which adds to the transmission error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import STEEL, Material, contact_modulus
from gearmesh.errors import ArgumentError, NoSolutionError, Status
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.complementarity import Displacements, pressures, tangent_stiffness
from gearmesh.loaded.compliance.compliance import COARSER, FlankCompliance, flank_compliance, rim_depth
from gearmesh.loaded.compliance.contact_compliance import ContactCompliance
from gearmesh.loaded.compliance.half_space import rectangle_influence
from gearmesh.loaded.compliance.threads import one_thread
from gearmesh.loaded.mounts import FlexibleMount, Supports
from gearmesh.loaded.peaks import RowGrid, coarser, edge_zone, peaks
from gearmesh.loaded.root_stress import Pressed, RootStress, root_stress
from gearmesh.loaded.separation import NearPairs, Separation, near_pairs, separation
from gearmesh.progress import in_turn, side_by_side, tell
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side

#: stations at which it is seen over how many pitches a flank reaches
STATIONS = 33
#: cells along and across a contact
CELLS = (40, 24)
#: displacement (mm) of teeth under 1 N per mm of face and MPa of E*, to guess how near pairs may come under load
GIVE = 25.0
#: what is left to the limit over the difference from cells twice as long and wide: 1 of first order, a third of second; measured
#: up to 0.4 of lines and ellipses (`peaks`)
LEFT_BY_CELLS = 1.0
#: part of a cell by which the end faces of both bodies may be apart to end at the same place
SAME = 0.5
#: rounds in which members are moved to where their mounts let them go, the same of those that springs hold, and the change, mm,
#: after which they stand there
MOUNT_ROUNDS, HELD_ROUNDS, MOUNTED = 8, 30, 1e-5
#: change, mm, of what springs hold: they leave a tenth of a newton
DRAWN = 1e-6
#: rounds in which grids are fitted to the contact, how much of the half grid it shall fill, and of its length at least
ROUNDS, FILLED, SHORT = 6, (0.45, 0.97), 0.25


@dataclass(frozen=True)
class PairLoad:
    """The load of the tooth pairs (M,) that come near at positions of the pinion, at one torque.

    `position`, `number` and `half` (M,) as of `NearPairs`; `force` (M,) N along the normals; `peak` (M,) MPa, without the rise
    towards sharp edges, NaN where nothing else is pressed (`peaks`), its `place` (M, 3), fixed frame, and `error` (M,), the
    estimate of its error as a share of it; whether there is pressure `on_edge` (M,) of a flank, and on a `sharp` (M,) one: such a
    pressure is singular and grows as cells get finer; `pressure` (M, X, Y), MPa, on the grids of `separation`; `roots`: stress in
    their fillets.
    """

    position: NDArray[np.intp]
    number: NDArray[np.intp]
    half: NDArray[np.intp]
    force: Array
    peak: Array
    place: Array
    on_edge: NDArray[np.bool_]
    sharp: NDArray[np.bool_]
    pressure: Array
    separation: Separation
    roots: RootStress
    error: Array

    @property
    def edge_contact(self) -> NDArray[np.bool_]:
        """Which pairs (M,) are pressed on a sharp edge and in its zone alone, so that they have no peak."""
        return np.asarray((self.force > 0.0) & np.isnan(self.peak))

    @cached_property
    def moment(self) -> Array:
        """Part (M,) of the torque on the pinion on each tooth pair, N mm; at a position they sum to the torque."""
        grid = self.separation
        line = self.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None]
        moments: Array = (line * grid.levers[0]).sum(axis=1)
        return moments


@dataclass(frozen=True)
class LoadedMesh:
    """The gears under torques (T,), N mm on the pinion, at rotations `phi1` (P,), rad.

    `unloaded` (P,) and `te` (T, P): phi2 - phi1 N1/N2 without and with load, rad; `rotation` (T, P): by how much the pinion is
    ahead of its position without load, rad; `tangent` (T, P): torque over rotation of a little more of either, N mm/rad;
    `gear_torque` (T, P), N mm; `loads` (T,); `root_stress` (T, P, 2): largest principal stress, MPa, in the fillets of pinion and
    gear on their loaded sides, away from the contact, `root_place` (T, P, 2, 3) of it, fixed frame; `tangent_stress` (T, P, 2):
    likewise where the fillets' tangents are at 30 deg to the teeth (internal ones: 60), NaN where none are, and `root_error`
    (T, P, 2), the estimate of the error of `bending` as a share of it; `contact_stress` (T, P, 2): the largest in the fillets that
    is the contact's own, NaN where there is none (`root_stress`); `displacement` (T, P, 2, 6), mm and
    rad, of both members in the frames of their mounts (`mounts`), 0 where they are rigid; `residual` (T, P), mm, of the contact;
    `status` (T, P) of `errors.Status`: not converged too where contact reaches beyond its grid or mounts do not converge.
    """

    phi1: Array
    torque: Array
    unloaded: Array
    te: Array
    rotation: Array
    tangent: Array
    gear_torque: Array
    loads: tuple[PairLoad, ...]
    root_stress: Array
    root_place: Array
    tangent_stress: Array
    root_error: Array
    contact_stress: Array
    displacement: Array
    residual: Array
    status: NDArray[np.int64]

    @property
    def bending(self) -> Array:
        """Bending stress (T, P, 2), MPa: at the tangents of 30 deg; of members without such a tangent the largest in the fillet."""
        none = np.isnan(self.tangent_stress).all(axis=(0, 1))
        return np.where(none, self.root_stress, self.tangent_stress)

    @property
    def stiffness(self) -> Array:
        """Torque over rotation (T, P), N mm/rad: secants."""
        secants: Array = self.torque[:, None] / self.rotation
        return secants


def compliances(
    gears: GearPair,
    materials: tuple[Material, Material] = (STEEL, STEEL),
    by_rim: tuple[bool, bool] = (False, False),
) -> tuple[FlankCompliance, FlankCompliance]:
    """Compliance of the working flanks of both members of a pair, with default elements; held at the bore or `by_rim`."""
    away = reach_of(gears)

    def of(member: Member, side: Side, material: Material, rim: bool) -> FlankCompliance:
        tooth = member.one_tooth
        deep = rim_depth(tooth) if rim else None
        return flank_compliance(tooth, side, material, rim=deep, reach=away, coarser=COARSER, idler=member.idler)

    with one_thread():
        first, second = side_by_side(of, gears.both, gears.flanks, materials, by_rim)
    return first, second


def reach_of(gears: GearPair) -> int:
    """How many teeth apart pairs may be that are in contact at once: as many as a flank reaches over, and those that contact
    along the profile adds; 3 at least. Of threads only what the mating gear reaches over is in contact."""
    spans = [0.0]
    for member, side in zip(gears.both, gears.flanks, strict=True):
        if member.one_tooth.screw is not None:
            continue
        joint = member.tooth.joint
        points = member.tooth.flank_grid(side, np.array([0.5]), np.linspace(0.0, 1.0, STATIONS)).points[0]
        spans.append(np.ptp(joint.running(joint.angle(points))) / member.tooth.pitch_angle)
    return max(3, int(np.ceil(max(spans))) + 1)


def whole_cycle(gears: GearPair, phi1: Array) -> bool:
    """Whether rotations (P,) of the pinion go through all of a pitch, even as they begin anew."""
    turns = np.sort(phi1)
    last = turns[0] + gears.pitch - turns[-1]
    return len(turns) > 2 and bool(0.0 < last < 1.5 * np.diff(turns).max())


@one_thread()
def loaded_mesh(
    gears: GearPair,
    phi1: Array,
    torque: Array,
    bodies: tuple[FlankCompliance, FlankCompliance],
    materials: tuple[Material, Material] = (STEEL, STEEL),
    cells: tuple[int, int] = CELLS,
    flexible: tuple[FlexibleMount | None, FlexibleMount | None] = (None, None),
) -> LoadedMesh:
    """The mesh at rotations phi1 (P,), rad, of the pinion under torques (T,), N mm, on it in the sense that drives; `flexible`: how
    compliance of the mounts of pinion and gear, None where they are rigid.

    Raises DesignError for a torque that is not above 0, NoSolutionError where no teeth, or none on their flanks, touch
    without load.
    """
    wrong = ~(np.isfinite(torque) & (torque > 0.0))
    if wrong.any():
        raise ArgumentError("torque", 0.001 * torque[wrong][0], unit="Nm", allowed="a finite number above 0")
    modulus = contact_modulus(*materials)
    points = bodies[0].points
    face = float(np.linalg.norm(points[0, -1] - points[0, 0]))
    arm = float(np.hypot(points[..., 0], points[..., 1]).mean())
    near, most, limit = _reaching(
        gears, phi1, torque.max(), GIVE * torque.max() / (arm * face * modulus), bodies, materials, cells
    )
    supports = None
    if flexible != (None, None):
        supports = Supports.of(gears, flexible, len(phi1), both_hands=bool(near.half.any()))
    shape = (len(torque), len(phi1))
    rotation, tangent, gear_torque, residual = (np.empty(shape) for _ in range(4))
    status, stress, at_tangent, error, own = (np.empty(shape, dtype=np.int64), *np.empty((4, *shape, 2)))
    place, displacement, loads = np.empty((*shape, 2, 3)), np.zeros((*shape, 2, 6)), []
    unloaded, ratio = near.phi2 - near.pair.ratio * phi1, abs(near.pair.ratio)
    for k, own_torque in enumerate(in_turn(torque)):
        stands = True
        if supports is not None:
            problem, stands = _solve_on_mounts(
                gears, near, float(own_torque), bodies, materials, cells, supports, limit
            )
            displacement[k] = problem.displacement()
        else:
            problem = (
                most if own_torque == torque.max() else _fit_grids(near, float(own_torque), bodies, materials, cells)
            )
        tell(0.6)
        solution, moved = problem.solution, problem.near
        # gears that their mounts let move begin to touch elsewhere
        behind = unloaded - (moved.phi2 - moved.pair.ratio * phi1)
        rotation[k] = solution.rotation + moved.pair.drive * behind / ratio
        residual[k], status[k] = solution.residual, solution.status if stands else Status.MAX_ITERATIONS
        status[k, moved.position[(problem.fill() > FILLED[1]) | problem.reaches_ends().any(axis=0)]] = (
            Status.MAX_ITERATIONS
        )
        loads.append(problem.loads())
        gear_torque[k] = problem.gear_torque()
        tangent[k], tangent_status = problem.tangent_stiffness()
        status[k] = np.where(tangent_status == Status.CONVERGED, status[k], tangent_status)
        roots, both = loads[-1].roots, np.arange(2)
        bent, largest, touched = (
            (roots.worst(values, moved.position, len(phi1)), both)
            for values in (roots.nominal, roots.largest, roots.contact)
        )
        at_tangent[k], error[k], own[k] = roots.bending[bent], roots.error[bent], roots.contact[touched]
        stress[k], place[k] = roots.largest[largest], roots.place[largest]
    te = unloaded - near.pair.drive * ratio * rotation
    return LoadedMesh(
        phi1,
        torque,
        unloaded,
        te,
        rotation,
        tangent,
        gear_torque,
        tuple(loads),
        stress,
        place,
        at_tangent,
        error,
        own,
        displacement,
        residual,
        status,
    )


def _reaching(
    gears: GearPair,
    phi1: Array,
    torque: float,
    give: float,
    bodies: tuple[FlankCompliance, FlankCompliance],
    materials: tuple[Material, Material],
    cells: tuple[int, int],
) -> tuple[NearPairs, _Problem, float]:
    """All tooth pairs that are loaded under the largest torque, N mm, its problem, and how far apart (mm) they were looked for;
    teeth are guessed to `give` mm, and bodies may more, soft webs above all: pairs further apart are then looked at too."""
    limit = 3.0 * give
    while True:
        near = near_pairs(gears, phi1, limit)
        problem = _fit_grids(near, torque, bodies, materials, cells)
        moved = float((problem.solution.rotation[near.position] * problem.lever).max())
        if moved < limit:
            return near, problem, limit
        limit = 1.5 * moved


def _fit_grids(
    near: NearPairs,
    torque: float,
    bodies: tuple[FlankCompliance, FlankCompliance],
    materials: tuple[Material, Material],
    cells: tuple[int, int],
    supports: Supports | None = None,
) -> _Problem:
    """The problem of one torque, solved on grids that hold all of the contact and are filled by it."""
    widen = np.ones(len(near.position))
    part: Array = np.repeat([[0.0], [1.0]], len(near.position), axis=1)
    before: Array | None = None
    for last in np.arange(ROUNDS) == ROUNDS - 1:
        problem = _Problem(near, torque, bodies, materials, cells, widen, part, supports, before)
        before = problem.solution.pressure
        filled, (first, used), cut = problem.fill(), problem.used_part(), problem.reaches_ends()
        wrong = (filled > FILLED[1]) | ((filled > 0.0) & (filled < FILLED[0]))
        short = (used > 0.0) & (used < SHORT) & ~cut.any(axis=0)
        if last or not (wrong | short | cut).any():
            break
        widen = np.where(filled > FILLED[1], 1.6 * widen, np.where(wrong, widen * filled / 0.75, widen))
        room = np.maximum(0.5 * used, 2.0 / cells[0])
        ends: Array = np.clip([first - room, first + used + room], 0.0, 1.0)
        # all of the load on less of a length is wider by a root
        widen = np.where(short & (filled > FILLED[0]), widen / np.sqrt(ends[1] - ends[0]), widen)
        part = problem.grid.part
        length = part[1] - part[0]
        part = np.where(short, part[0] + length * ends, part) + cut * length * np.array([[-1.0], [1.0]])
    return problem


def _solve_on_mounts(
    gears: GearPair,
    near: NearPairs,
    torque: float,
    bodies: tuple[FlankCompliance, FlankCompliance],
    materials: tuple[Material, Material],
    cells: tuple[int, int],
    supports: Supports,
    limit: float,
) -> tuple[_Problem, bool]:
    """The problem of one torque with members where their mounts let them go, and whether their mean displacement has converged."""
    for _ in range(HELD_ROUNDS if supports.held else MOUNT_ROUNDS):
        problem = _fit_grids(near, torque, bodies, materials, cells, supports)
        own = problem.displacement()
        size = float(problem.grid.levers.max())
        scale = np.array([1.0, 1.0, 1.0, size, size, size])
        change = np.abs(own.mean(axis=0) - supports.displacement) * scale
        drawn = np.abs(own - supports.anchor) * scale * (supports.holding > 0.0)
        if change.max() < MOUNTED and drawn.max() < DRAWN:
            return problem, True
        supports, moved = supports.displace(gears, own)
        near = near_pairs(moved, near.phi1, limit)
    return problem, False


class _Problem:
    """All positions at one torque: pairs (M,) in slots (P, K), each with a grid (X, Y)."""

    def __init__(
        self,
        near: NearPairs,
        torque: float,
        bodies: tuple[FlankCompliance, FlankCompliance],
        materials: tuple[Material, Material],
        cells: tuple[int, int],
        widen: Array,
        part: Array,
        supports: Supports | None = None,
        before: Array | None = None,
    ) -> None:
        self.near, self.bodies, self.materials, self.supports = near, bodies, materials, supports
        self.torque = torque
        count = len(near.phi1)
        # slots of a position in the order of the pairs
        order = np.argsort(near.position, kind="stable")
        self.slot = np.empty_like(order)
        self.slot[order] = np.arange(len(order)) - np.searchsorted(near.position[order], near.position[order])
        self.most = int(self.slot.max()) + 1
        self.lever = near.levers(0, near.path.point, near.axes[:, :, 2])
        self.grid = separation(near, torque / self.lever, contact_modulus(*materials), cells, widen, part)
        grid = self.grid
        local = self._local_compliance(grid.dx, grid.dy, cells)
        self.area = self._slots(grid.dx * grid.dy)
        # to where the bodies' compliance is known
        self.to_body = [
            body.along_helix(near.rotation(member), places)
            for member, (body, places) in enumerate(zip(bodies, grid.places, strict=True))
        ]
        self.places = [_in_frame(to, places) for to, places in zip(self.to_body, grid.places, strict=True)]
        self.shares = [body.shares(places) for body, places in zip(bodies, self.places, strict=True)]
        smooth = self._smooth()
        full = (count, self.most, *cells)
        on, gap = self._slots(grid.on), self._slots(grid.gap)
        if supports is not None:
            for k, wrench_rows in enumerate(supports.wrenches(near.in_place(grid.middle), near.turn(grid.normal))):
                wrench = self._slots(wrench_rows).reshape(count, -1, 6)
                smooth += wrench @ supports.compliance[k] @ wrench.swapaxes(1, 2)
                # as far as members have been moved, gaps have it already
                already = supports.displacement[k] - supports.pull[:, k]
                gap -= (wrench @ already[..., None]).reshape(*full[:3], 1)
        lever = np.broadcast_to(self._slots(grid.levers[0])[..., None], full)
        area = np.broadcast_to(self.area[..., None, None], full)

        displace = _displacements(local, smooth, self.area, cells)

        eta = (np.arange(cells[1]) + 0.5) * 2.0 / cells[1] - 1.0
        # from the pair that touches without load: others are pressed as soon as they overlap
        with np.errstate(invalid="ignore"):
            least = np.where(on, gap, np.inf).min(axis=(2, 3))
        first = least <= least.min(axis=1, keepdims=True)
        start = np.sqrt(1.0 - eta**2) * on * first[:, :, None, None]
        flat = (count, -1)
        if before is not None:
            # cell by cell those of the grids before
            known = before.reshape(full) * on
            start = np.where(known.any(axis=(1, 2, 3))[:, None, None, None], known, start)
        idle = ~((area * lever * start).reshape(count, -1).sum(axis=1) > 0.0)
        if idle.any():
            raise NoSolutionError(
                reason=f"at phi1 = {np.degrees(near.phi1[np.argmax(idle)]):g} deg the teeth touch beyond their flanks, where "
                "pressures are not known",
                remedy="tca shows the contact and any interference",
            )
        self.moved, self.levers, self.areas = displace, lever.reshape(flat), area.reshape(flat)
        self.smooth, self.gap, self.on = smooth, gap, on
        self.solution = pressures(
            displace,
            gap.reshape(flat),
            self.levers,
            self.areas,
            on.reshape(flat),
            np.full(count, torque),
            start.reshape(flat),
            self._ease(grid.dx, grid.dy, full),
        )
        self.pressure = self.solution.pressure.reshape(full)[near.position, self.slot]
        self.line = self.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None]

    def _slots(self, values: NDArray[Any], empty: float = 0.0) -> NDArray[Any]:
        """Values (M, ...) of the pairs as (P, K, ...)."""
        slots = np.full((len(self.near.phi1), self.most, *values.shape[1:]), empty, dtype=values.dtype)
        slots[self.near.position, self.slot] = values
        return slots

    def _local_compliance(self, dx: Array, dy: Array, cells: tuple[int, int]) -> ContactCompliance:
        """Local contact compliance on grids of `cells` dx by dy (M,), mm."""
        ends = np.stack([[self._slots(distances, np.inf) for distances in of_body] for of_body in self.grid.ends])
        return ContactCompliance.of(self._slots(dx, 1.0), self._slots(dy, 1.0), cells, self.materials, ends)

    def _ease(self, dx: Array, dy: Array, shape: tuple[int, ...]) -> Array:
        """Deflections (P, K X Y) of cells dx by dy (M,), mm, under unit pressure on them alone, up to a factor."""
        middle = np.zeros_like(dx)
        ease = self._slots(rectangle_influence(middle, middle, dx, dy), 1.0)
        return np.broadcast_to(ease[..., None, None], shape).reshape(len(ease), -1)

    def _teeth(self, member: int) -> NDArray[np.intp]:
        """Which tooth (M,) of a member a pair is of, counted the way it moves."""
        pair = self.near.pair
        sense = (pair.pinion.mount.sign, pair.gear.mount.sign * np.sign(pair.ratio))[member]
        return (-sense * self.near.number).astype(np.intp)

    def _couples(self, member: int) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
        """Couples of pairs (first moved, second loaded) at a position, and the way (C,) from the loaded tooth to the moved one, of
        those that the compliance has."""
        near = self.near
        moved, loaded = np.nonzero((near.position[:, None] == near.position) & (near.half[:, None] == near.half))
        teeth = self._teeth(member)
        way = teeth[moved] - teeth[loaded]
        kept = np.abs(way) <= self.bodies[member].reach
        return moved[kept], loaded[kept], way[kept]

    def _smooth(self) -> Array:
        """Displacements (P, K X, K X), mm/N, of the grids' lines under forces on them, of both members together."""
        count, x = len(self.near.phi1), self.grid.middle.shape[1]
        compliance = np.zeros((count, self.most, x, self.most, x))
        for member, (body, (nodes, share)) in enumerate(zip(self.bodies, self.shares, strict=True)):
            teeth = self._teeth(member)
            for first, second, way in zip(*self._couples(member), strict=True):
                table = body.of_tooth(teeth[second]).smooth[way + body.reach]
                part = table[nodes[first][:, :, None, None], nodes[second][None, None]]
                value = np.einsum("xa,xayb,yb->xy", share[first], part, share[second], optimize=True)
                compliance[self.near.position[first], self.slot[first], :, self.slot[second]] += value
        size = self.most * x
        return compliance.reshape(count, size, size)

    def fill(self) -> Array:
        """Half widths (M,) of the contact over those of the grids; 0 where there is none."""
        y = self.pressure.shape[2]
        edge = (np.abs(2.0 * np.arange(y) + 1.0 - y) + 1.0) / y
        fill: Array = np.where(self.pressure > 0.0, edge, 0.0).max(axis=(1, 2))
        return fill

    def tangent_stiffness(self) -> tuple[Array, NDArray[np.int64]]:
        """Torque over rotation (P,), N mm/rad, of a little more of either, and the status (P,)."""
        p = self.solution.pressure
        return tangent_stiffness(self.moved, self.levers, self.areas, p > 0.0, p)

    def reaches_ends(self) -> NDArray[np.bool_]:
        """Whether contacts reach the first and the last end (2, M) of their grid, and the flanks go on beyond it."""
        ends = (self.pressure[:, [0, -1]] > 0.0).any(axis=2).T
        reaching: NDArray[np.bool_] = ends & self.grid.open
        return reaching

    def used_part(self) -> tuple[Array, Array]:
        """Where contacts begin along the grids and how much of these they take (M,), of 1; 0 where there is none."""
        along: NDArray[np.bool_] = np.asarray((self.pressure > 0.0).any(axis=2))
        count = along.shape[1]
        first, last = along.argmax(axis=1), count - along[:, ::-1].argmax(axis=1)
        return first / count, np.where(along.any(axis=1), (last - first) / count, 0.0)

    def displacement(self) -> Array:
        """By how much (P, 2, 6), mm and rad, the pressures displace both members in their mounts."""
        assert self.supports is not None
        displacements = self.supports.pull.copy()
        points, normals = self.near.in_place(self.grid.middle), self.near.turn(self.grid.normal)
        for k, wrench in enumerate(self.supports.wrenches(points, normals)):
            force = np.einsum("mxi,mx->mi", wrench, self.line)
            np.add.at(displacements[:, k], self.near.position, force @ self.supports.compliance[k])
        return displacements

    def gear_torque(self) -> Array:
        """N mm (P,)."""
        moments = (self.line * self.grid.levers[1]).sum(axis=1)
        return np.bincount(self.near.position, moments, len(self.near.phi1)).astype(float)

    def loads(self) -> PairLoad:
        blunt = alike(self.grid)
        on_edge, sharp = (
            np.asarray(((self.pressure > 0.0) & ~inside(self.grid.on, 1, 1, rounded)).any(axis=(1, 2)))
            for rounded in (None, blunt)
        )
        grid, ends = self.grid, self.grid.ridge_ends
        # a contact that goes on along a tip up to the end faces ends at the tip
        whole = blunt & (SAME * grid.dx[:, None] > ends.T)
        rows = RowGrid(self.pressure, grid.on, grid.edged, grid.dx, ends, whole)
        zone = min(edge_zone(body.points) for body in self.bodies)
        largest = peaks(rows, zone)
        of_coarser = peaks(coarser(rows, self.by_coarser_cells()), zone).pressure
        place = self.near.in_place(self.grid.middle[np.arange(len(largest.row)), largest.row])
        return PairLoad(
            self.near.position,
            self.near.number,
            self.near.half,
            self.line.sum(axis=1),
            largest.pressure,
            np.where(np.isfinite(largest.pressure)[:, None], place, np.nan),
            on_edge,
            sharp,
            self.pressure,
            self.grid,
            self.root_stress(),
            LEFT_BY_CELLS * np.abs(largest.pressure - of_coarser) / largest.pressure,
        )

    def by_coarser_cells(self) -> Array:
        """Pressures (M, X/2, Y/2), MPa, on cells twice as long and wide, each in place of four; NaN at positions where no such cell
        that is pressed lies on the flanks."""
        cells = (self.pressure.shape[1] // 2, self.pressure.shape[2] // 2)
        count, most = self.area.shape
        fine, full = (count, most, *self.pressure.shape[1:]), (count, most, *cells)

        def mean(values: Array) -> Array:
            halved: Array = values.reshape(count, most, cells[0], 2, cells[1], 2).mean(axis=(3, 5))
            return halved

        on = np.asarray(mean(self.on.astype(float)) == 1.0)
        start = np.where(on, mean(self.solution.pressure.reshape(fine)), 0.0)
        idle = np.asarray(~start.any(axis=(1, 2, 3)))
        on, start = on | idle[:, None, None, None], np.where(idle[:, None, None, None], 1.0, start)
        lines = most * cells[0]
        smooth = self.smooth.reshape(count, lines, 2, lines, 2).mean(axis=(2, 4))
        dx, dy, area = 2.0 * self.grid.dx, 2.0 * self.grid.dy, 4.0 * self.area
        flat = (count, -1)
        solution = pressures(
            _displacements(self._local_compliance(dx, dy, cells), smooth, area, cells),
            mean(self.gap).reshape(flat),
            mean(self.levers.reshape(fine)).reshape(flat),
            np.broadcast_to(area[..., None, None], full).reshape(flat),
            on.reshape(flat),
            np.full(count, self.torque),
            start.reshape(flat),
            self._ease(dx, dy, full),
        )
        pressure = np.where(idle[:, None], np.nan, solution.pressure).reshape(full)
        return pressure[self.near.position, self.slot]

    def root_stress(self) -> RootStress:
        """Of pinion and gear, its places in the fixed frame."""
        mounts, of_members = self.near.mounts, []
        for member, body in enumerate(self.bodies):
            pressed = Pressed(
                self.line,
                self.places[member],
                self._teeth(member),
                self._couples(member),
                self.materials[member].poisson_ratio,
            )
            own = root_stress(body, body.coarser, pressed)
            turned = mounts[member].at(self.near.turns[member]).point(self.to_body[member].inverse.point(own.place))
            of_members.append(replace(own, place=self.near.in_place(turned)))
        return RootStress.join(*of_members)


def _displacements(local: ContactCompliance, smooth: Array, area: Array, cells: tuple[int, int]) -> Displacements:
    """Displacements, mm, of all `cells` of positions under their pressures: local ones, and `smooth` ones (P, K X, K X) of lines
    across under forces on these; `area` (P, K), mm^2, of cells."""

    def displace(p: Array, which: NDArray[np.intp]) -> Array:
        p = p.reshape(len(p), area.shape[1], *cells)
        line = (p.sum(axis=3) * area[which][:, :, None]).reshape(len(p), -1, 1)
        total: Array = local.under(p, which) + (smooth[which] @ line).reshape(*p.shape[:3], 1)
        return total.reshape(len(p), -1)

    return displace


def _in_frame(motion: Rigid, points: Array) -> Array:
    """Points (M, X, 3) moved by a motion, or by one (M,) each."""
    return motion.point(points) if motion.rotation.ndim == 2 else motion.point(points.swapaxes(0, 1)).swapaxes(0, 1)


def alike(grid: Separation) -> NDArray[np.bool_]:
    """Whether the flanks of both bodies end at the least and the greatest x of grids, (M, 2), at end faces in the same place."""
    return np.asarray((grid.ends < SAME * grid.dx).all(axis=0).T)


def inside(
    on: NDArray[np.bool_], along: int, across: int | None = None, blunt: NDArray[np.bool_] | None = None
) -> NDArray[np.bool_]:
    """Which of cells (M, X, Y) are at least so many cells `along` and `across` (by default as many) away from cells that are not
    `on` the flanks, and from the ends of X but for those that are `blunt` (M, 2)."""
    (x, y), a, b = on.shape[1:], along, along if across is None else across
    padded = np.pad(np.pad(on, ((0, 0), (a, a), (0, 0))), ((0, 0), (0, 0), (b, b)), mode="edge")
    if blunt is not None:
        padded[:, :a] |= blunt[:, 0, None, None] & padded[:, [a]]
        padded[:, -a:] |= blunt[:, 1, None, None] & padded[:, [-a - 1]]
    inner = on.copy()
    for step in range(-a, a + 1):
        inner &= padded[:, a + step : a + step + x, b : b + y]
    for step in range(-b, b + 1):
        inner &= padded[:, a : a + x, b + step : b + step + y]
    return inner
