"""A mesh under torque: load sharing of the tooth pairs, pressures, and rotation of the gears.

Every position of the pinion is one contact problem (`complementarity`). It has these parts:

- gaps of all near tooth pairs (`separation`).
- compliance of both members (`compliance`).
- local contact compliance of both flanks (`contact_compliance`).
- the torque.

The rotation theta is the rotation of the pinion against the fixed gear. The gear lags by theta N1/N2, which adds to the
transmission error.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache
from itertools import chain
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.hertz import STEEL, Material, contact_modulus
from gearmesh.errors import ArgumentError, NoSolutionError, Status
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.complementarity import PRESSURE_TOLERANCE, Displacements, Pressures, pressures, tangent_stiffness
from gearmesh.loaded.compliance.compliance import (
    COARSER_CELLS,
    SECTOR_CELLS,
    BodyOutline,
    FlankCompliance,
    flank_compliance,
    rim_depth,
)
from gearmesh.loaded.compliance.contact_compliance import ContactCompliance, half_space_pressures
from gearmesh.loaded.compliance.half_space import rectangle_influence
from gearmesh.loaded.compliance.threads import one_thread
from gearmesh.loaded.mounts import FlexibleMount, Supports
from gearmesh.loaded.peaks import RowGrid, coarser, edge_zone, peaks
from gearmesh.loaded.root_stress import Pressed, RootStress, root_stress
from gearmesh.loaded.separation import NearPairs, Separation, advances_of_halves, near_pairs, separation
from gearmesh.progress import in_turn, side_by_side, tell
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import FLANK_REGIONS, Side
from gearmesh.teeth.tooth import Tooth

#: places up the profile at which modifications of two teeth are compared
SHIFT_ROWS = np.linspace(0.0, 1.0, 65)
#: distance along the axis, mm, within which points are in one plane
SAME_PLANE_MM = 1e-9
#: stations along the face at which the angle that a flank covers is measured
REACH_STATIONS = 33
#: default numbers of cells along and across a contact
CONTACT_CELLS = (40, 24)
#: the same of level "quick"
QUICK_CELLS = (20, 12)
#: tolerance of the pressures (`complementarity`) at level "quick"
QUICK_TOLERANCE = 1e-6
#: the same of variants that take grids and bodies of another design: rotations err by 1e-6 of themselves
VARIANT_TOLERANCE = 1e-5
#: largest difference of teeth over their whole depth up to which a variant takes bodies and grids of another design
MAX_VARIANT_SHIFT = 0.01
#: the same at level "full": largest bending stress then errs by less than 2e-3
MAX_BODY_SHIFT = 0.001
#: deflection of teeth, mm, over force / (face width E*): estimates how near tooth pairs come under load
UNIT_DEFLECTION_MM = 25.0
#: error of the peak pressure over its difference from cells twice as large: 1 for first order, 1/3 for second
CELL_ERROR_SHARE = 1.0
#: largest distance, in cells, between end faces of both bodies that count as one place
SAME_END_CELLS = 0.5
#: largest number of outlines of teeth in memory, 5 kB each
MAX_KEPT_OUTLINES = 16
#: largest number of rounds in which members move to where their mounts let them go
MAX_MOUNT_ROUNDS = 8
#: largest number of these rounds if springs hold members
MAX_HELD_ROUNDS = 30
#: change of the mean displacement in a round, mm, below which the mounts have converged
MOUNT_TOLERANCE_MM = 1e-5
#: change of displacements that springs hold, mm: less than 0.1 N is then left in a spring
HELD_TOLERANCE_MM = 1e-6
#: steps from a rotation of the gear to that of the pinion: transmission errors change by less than 1e-3 of it
DRIVING_STEPS = 2
#: largest number of rounds in which grids are fitted to the contact
MAX_GRID_ROUNDS = 6
#: least and largest share of a grid's half width that the contact may fill
FILL_RANGE = (0.45, 0.97)
#: factor for the width of a grid that the contact fills
WIDENING_FACTOR = 1.6
#: the same with coarse cells: the outermost of 12 is pressed from 0.83 of the half width on, where the grid may fit
COARSE_WIDENING_FACTOR = 1.25
#: least share of a grid's length that the contact may fill
MIN_LENGTH_SHARE = 0.25
#: length of a contact, over that for which its grid was made, below which the grid is cut to the contact
SHRUNK_SHARE = 0.7
#: room at both ends of a grid that is cut so, over the length of the contact
SHRUNK_ROOM_SHARE = 0.2
#: way of an end that the contact then reaches, over the length of the grid
MOVED_END_SHARE = 0.25
#: width of a grid whose contact no cell meets, over its width before
MISSED_SHARE = 0.15
#: overlap at first touch, over the approach of the bodies, from which such a contact counts
MISSED_OVERLAP_SHARE = 0.01
#: least width of a grid over the width within which its gaps are known
MIN_NARROW_SHARE = 0.6
#: share of the largest force at a position below which a contact keeps such a grid: its error hardly counts
LIGHT_LOAD_SHARE = 0.05
#: exponent of the torque in the length of an ellipse
LENGTH_EXPONENT = 1.0 / 3.0
#: exponent of the torque in the width of a contact: 1/2 for lines, 1/3 for ellipses
WIDTH_EXPONENT = 0.4
#: least numbers of cells along and across with which grids are fitted before the cells are halved
MIN_FITTED_CELLS = (16, 10)
#: tolerance of the pressures (`complementarity`) while grids are fitted
FIT_TOLERANCE = 1e-4
#: search distance over the approach of bodies with such cells
APPROACH_MARGIN = 1.05


#: models of contact under load: "quick" has coarse elements and cells and estimates no errors
Level = Literal["full", "quick"]
#: names of these models
LOAD_LEVELS = ("full", "quick")


@dataclass(frozen=True)
class PairLoad:
    """Load on the tooth pairs (M,) that come near at positions of the pinion, under one torque."""

    #: position (M,) of each pair in the rotations of the pinion
    position: NDArray[np.intp]
    #: number (M,) of each pair, as in `NearPairs`
    number: NDArray[np.intp]
    #: half (M,) of a double helical gear, 0 or 1, as in `NearPairs`
    half: NDArray[np.intp]
    #: forces (M,), N, along the normals
    force: Array
    #: peak pressures (M,), MPa, without the rise towards sharp edges (`peaks`); NaN if only this rise is pressed
    peak: Array
    #: places (M, 3), mm, of the peaks, fixed frame
    place: Array
    #: pairs (M,) with pressure on an edge of a flank
    on_edge: NDArray[np.bool_]
    #: pairs (M,) with pressure on a sharp edge, where it is singular and grows as cells get finer
    sharp: NDArray[np.bool_]
    #: pressures (M, X, Y), MPa, on the grids of `separation`
    pressure: Array
    #: unloaded gaps, on the grids of cells that were fitted to the contact
    separation: Separation
    #: stress in the fillets of both members
    roots: RootStress
    #: estimated relative errors (M,) of the peaks
    error: Array

    @property
    def edge_contact(self) -> NDArray[np.bool_]:
        """Pairs (M,) under load that have no peak: all their pressure is on a sharp edge or in its zone."""
        return np.asarray((self.force > 0.0) & np.isnan(self.peak))

    @cached_property
    def moment(self) -> Array:
        """Part (M,) of the pinion's torque on each tooth pair, N mm; the parts at a position sum to the torque."""
        grid = self.separation
        line = self.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None]
        moments: Array = (line * grid.levers[0]).sum(axis=1)
        return moments

    def some(self, rows: NDArray[np.intp]) -> PairLoad:
        """Return the load on some pairs, `rows` (N,)."""
        parts = {f.name: getattr(self, f.name) for f in fields(self)}
        arrays: dict[str, Any] = {name: part[rows] for name, part in parts.items() if isinstance(part, np.ndarray)}
        return replace(self, **arrays, separation=self.separation.some(rows), roots=self.roots.some(rows))

    def share(self, count: int) -> Array:
        """Return part of the torque, peak pressure and largest force (P, 3), as in `MeshShare`, at `count` positions."""
        most = np.full((2, count), np.nan)
        for row, values in zip(most, (self.peak, self.force), strict=True):
            np.fmax.at(row, self.position, values)
        return np.column_stack((np.bincount(self.position, self.moment, count), *most))

    def at(self, first: int, count: int) -> PairLoad:
        """Return the load at `count` positions from the position `first` on."""
        part = self.some(np.flatnonzero((self.position >= first) & (self.position < first + count)))
        return replace(part, position=part.position - first)


@dataclass(frozen=True)
class MeshShare:
    """Load on one of several pairs that share a torque."""

    #: part (T, P) of the pinions' torque, N mm
    moment: Array
    #: peak pressure (T, P), MPa, as `PairLoad.peak`; NaN without load away from edges
    peak: Array
    #: largest normal force (T, P) on a tooth pair, N
    force: Array


@dataclass(frozen=True)
class LoadedMesh:
    """Gears under T torques on the pinion at P of its rotations."""

    #: rotations (P,) of the pinion, rad
    phi1: Array
    #: torques (T,) on the pinion, N mm
    torque: Array
    #: transmission error phi2 - phi1 N1/N2 (P,), rad, without load
    unloaded: Array
    #: transmission error (T, P), rad, under load
    te: Array
    #: rotation (T, P) of the pinion ahead of its position without load, rad
    rotation: Array
    #: tangent stiffness (T, P), N mm/rad: change of torque over change of rotation
    tangent: Array
    #: torque (T, P) on the gear, N mm
    gear_torque: Array
    #: loads on the tooth pairs, one record per torque
    loads: tuple[PairLoad, ...]
    #: largest principal stress (T, P, 2), MPa, in the fillets of pinion and gear on their loaded sides, away from the
    #: contact
    root_stress: Array
    #: place (T, P, 2, 3), mm, of `root_stress`, fixed frame
    root_place: Array
    #: largest principal stress (T, P, 2), MPa, where the fillets' tangents are at 30 deg to the teeth
    #: (internal teeth: 60); NaN without such a tangent
    tangent_stress: Array
    #: estimated relative error (T, P, 2) of `bending`
    root_error: Array
    #: largest stress (T, P, 2), MPa, in the part of the fillets that the contact's own field reaches; NaN if there is
    #: none (`root_stress`)
    contact_stress: Array
    #: displacements (T, P, 2, 6), mm and rad, of both members in the frames of their mounts (`mounts`); 0 for rigid
    #: mounts
    displacement: Array
    #: residual (T, P), mm, of the contact problem
    residual: Array
    #: codes (T, P) of `errors.Status`; also not converged if the contact reaches beyond its grid or the mounts do not
    #: converge
    status: NDArray[np.int64]
    #: load on each of several pairs that share the torque, the own pair first; `loads` and stresses belong to the own
    #: pair, all other figures to the pairs together
    shares: tuple[MeshShare, ...] = ()

    @property
    def bending(self) -> Array:
        """Bending stress (T, P, 2), MPa, at the tangents of 30 deg; the largest in the fillet for a member without such
        a tangent."""
        without_tangent = np.isnan(self.tangent_stress).all(axis=(0, 1))
        return np.where(without_tangent, self.root_stress, self.tangent_stress)

    @property
    def te_peak_to_peak(self) -> Array:
        """Transmission error (T,), rad, under load, peak to peak over the positions."""
        return np.asarray(np.ptp(self.te, axis=1))

    @property
    def stiffness(self) -> Array:
        """Secant stiffness (T, P), N mm/rad: torque over rotation."""
        secants: Array = self.torque[:, None] / self.rotation
        return secants

    @property
    def carried(self) -> Array:
        """Torque (T,) on the pinion of the own pair, N mm, mean over the positions: all of it unless pairs share it."""
        return np.asarray(self.shares[0].moment.mean(axis=1)) if self.shares else self.torque


def compliances(
    gears: GearPair,
    materials: tuple[Material, Material] = (STEEL, STEEL),
    by_rim: tuple[bool, bool] = (False, False),
    level: Level = "full",
) -> tuple[FlankCompliance, FlankCompliance]:
    """Compute the compliance of both members' working flanks with the elements of a level; a member is held at its bore,
    or at its rim where `by_rim`."""
    reach = reach_of(gears)
    cells, coarser = (SECTOR_CELLS, COARSER_CELLS) if level == "full" else (COARSER_CELLS, None)

    def compliance_of(member: Member, side: Side, material: Material, rim: bool) -> FlankCompliance:
        tooth = member.one_tooth
        rim_below_root = rim_depth(tooth) if rim else None
        return flank_compliance(
            tooth, side, material, cells=cells, rim=rim_below_root, reach=reach, coarser=coarser, idler=member.idler
        )

    with one_thread():
        pinion, gear = side_by_side(compliance_of, gears.both, gears.flanks, materials, by_rim)
    return pinion, gear


def reach_of(gears: GearPair) -> int:
    """Return the largest number of teeth between two pairs that are in contact at the same time, at least 3.

    It covers the angle of a flank in pitches, and one more pitch for contact along the profile. Threads are not
    counted: the mating gear limits the part of a thread that is in contact. Coupled members touch all round.
    """
    if solver_pair(gears).coupled:
        return gears.pinion.tooth.teeth // 2
    spans = [0.0]
    for member, side in zip(gears.both, gears.flanks, strict=True):
        if member.one_tooth.screw is not None:
            continue
        joint = member.tooth.joint
        points = member.tooth.flank_grid(side, np.array([0.5]), np.linspace(0.0, 1.0, REACH_STATIONS)).points[0]
        spans.append(np.ptp(joint.running(joint.angle(points))) / member.tooth.pitch_angle)
    return max(3, int(np.ceil(max(spans))) + 1)


def whole_cycle(gears: GearPair, phi1: Array) -> bool:
    """Return True if rotations (P,) of the pinion cover a whole pitch, including the step back to the start."""
    turns = np.sort(phi1)
    closing_step = turns[0] + gears.pitch - turns[-1]
    return len(turns) > 2 and bool(0.0 < closing_step < 1.5 * np.diff(turns).max())


@dataclass(frozen=True)
class SecondMesh:
    """The other mesh of a planet that both meshes load, with its bodies, materials and mounts as in `loaded_mesh`."""

    #: its pair
    gears: GearPair
    #: number of the planet in the first mesh: 0 pinion, 1 gear; it is the other one in this mesh
    shared: int
    bodies: tuple[FlankCompliance, FlankCompliance]
    materials: tuple[Material, Material]
    flexible: tuple[FlexibleMount | None, FlexibleMount | None]

    def on_mounts(self, first: NearPairs, most: float, level: Level) -> Callable[[float], _OnMounts]:
        """Return the function that gives this mesh while the first one has a torque, N mm, on its pinion.

        `first`: tooth pairs of the first mesh, at whose rotations of the planet this mesh is solved. `most`: largest torque.
        """
        model = _Model(self.bodies, self.materials, CONTACT_CELLS if level == "full" else QUICK_CELLS, level)
        # the planet is the gear of the mesh with the sun, and the pinion of that with the ring
        if self.shared == 1:
            phi1, share = first.phi2, 1.0 / abs(first.pair.ratio)
        else:
            phi1, share = _driving(self.gears, first.phi1), abs(self.gears.ratio)
        reached, limit = _reached(self.gears, phi1, share * most, model)
        own = 1 - self.shared
        supports = _supports(self.gears, self.flexible, reached.near, own)
        return lambda torque: _OnMounts(self.gears, reached.near, share * torque, model, supports, limit, own)


def _driving(gears: GearPair, phi2: Array) -> Array:
    """Return the rotations (P,), rad, of the pinion at which the unloaded gear has rotations phi2 (P,)."""
    phi1 = phi2 / gears.ratio
    for _ in range(DRIVING_STEPS):
        advance = advances_of_halves(gears, phi1).max(axis=0)
        phi1 = (phi2 - gears.drive * advance) / gears.ratio
    return phi1


def _supports(
    gears: GearPair, flexible: tuple[FlexibleMount | None, FlexibleMount | None], near: NearPairs, shared: int | None
) -> Supports:
    """Return the mounts of a pair that is not displaced yet; another mesh loads its member number `shared` too."""
    tilting = None
    if shared is not None:
        blank = gears.both[shared].tooth.blank
        tilting = shared, float(np.ptp(blank.faces))
    return Supports.of(gears, flexible, len(near.phi1), both_hands=bool(near.half.any()), tilting=tilting)


@one_thread()
def loaded_mesh(
    gears: GearPair,
    phi1: Array,
    torque: Array,
    bodies: tuple[FlankCompliance, FlankCompliance],
    materials: tuple[Material, Material] = (STEEL, STEEL),
    cells: tuple[int, int] | None = None,
    flexible: tuple[FlexibleMount | None, FlexibleMount | None] = (None, None),
    level: Level = "full",
    reference: Reference | None = None,
    second: SecondMesh | None = None,
) -> LoadedMesh:
    """Solve the mesh at P rotations of the pinion under T torques.

    - `phi1` (P,): rotations of the pinion, rad.
    - `torque` (T,): torques on the pinion in the sense that drives, N mm.
    - `bodies`: compliance of the working flanks of pinion and gear.
    - `materials`: of pinion and gear.
    - `cells`: numbers of cells along and across each contact; by default those of the level.
    - `level`: with "quick" no errors are estimated.
    - `reference`: the solved mesh of nearly equal gears on rigid mounts, whose grids and bodies are taken.
    - `flexible`: compliance of the mounts of pinion and gear; None if rigid.
    - `second`: other mesh of a member on an elastic mount.

    Raises DesignError for a torque that is not above 0. Raises NoSolutionError if no teeth touch without load, or if
    they touch beyond their flanks only.
    """
    wrong = ~(np.isfinite(torque) & (torque > 0.0))
    if wrong.any():
        raise ArgumentError("torque", 0.001 * torque[wrong][0], unit="Nm", allowed="a finite number above 0")
    model = _Model(bodies, materials, cells or (CONTACT_CELLS if level == "full" else QUICK_CELLS), level)
    free, displacement = np.zeros(len(phi1)), np.zeros((len(torque), len(phi1), 2, 6))
    results: dict[int, _Results] = {}
    if reference is not None:
        assert flexible == (None, None)
        near = reference.near.of_flanks(gears)
        problem = reference.problem.of_near(near.repeated(len(reference.torque)))
        at_once = _Results.of(problem, gears, reference.errors).parts(len(reference.torque))
        results = {k: at_once[int(np.argmax(reference.torque == value))] for k, value in enumerate(torque)}
        # cells have the same error on both
        free = problem.free_rotation() - reference.problem.free_rotation()
        free = free.reshape(len(reference.torque), -1)[reference.torque.argmax()]
    else:
        reached, limit = _reached(gears, phi1, torque.max(), model)
        near, rigid, supports, beside = reached.near, None, None, None
        shared = None if second is None else second.shared
        if flexible != (None, None):
            supports = _supports(gears, flexible, near, shared)
        if second is not None:
            beside = second.on_mounts(near, float(torque.max()), level)
        # the largest torque first: the grids of smaller ones follow from its grids
        for k in in_turn(np.argsort(-torque, kind="stable")):
            applied_torque, mounts_converged = float(torque[k]), True
            # one problem per torque; members on elastic mounts are displaced until they have converged
            if supports is not None:
                problem, mounts_converged = _solve_on_mounts(
                    [
                        _OnMounts(gears, near, applied_torque, model, supports, limit, shared),
                        *([] if beside is None else [beside(applied_torque)]),
                    ]
                )
                displacement[k] = problem.displacement()
            elif rigid is None:
                problem = rigid = reached.finished(applied_torque)
            else:
                problem = rigid
                problem.press(applied_torque)
            tell(0.6)
            results[k] = _Results.of(problem, gears)
            if not mounts_converged:
                results[k].status[:] = Status.MAX_ITERATIONS
    ratio, every = abs(near.pair.ratio), [results[k] for k in range(len(torque))]
    unloaded = near.phi2 - near.pair.ratio * phi1 - near.pair.drive * ratio * free
    # displaced gears begin to touch at another rotation, which counts as part of the rotation under load
    rotation = np.stack(
        [
            found.rotation + near.pair.drive * (unloaded - (found.phi2 - near.pair.ratio * phi1)) / ratio
            for found in every
        ]
    )
    # under load the gear lags by the pinion's rotation times the ratio
    te = unloaded - near.pair.drive * ratio * rotation
    return LoadedMesh(
        phi1,
        torque,
        unloaded,
        te,
        rotation,
        np.stack([found.tangent for found in every]),
        np.stack([found.gear_torque for found in every]),
        tuple(found.load for found in every),
        np.stack([found.root_stress for found in every]),
        np.stack([found.root_place for found in every]),
        np.stack([found.tangent_stress for found in every]),
        np.stack([found.root_error for found in every]),
        np.stack([found.contact_stress for found in every]),
        displacement,
        np.stack([found.residual for found in every]),
        np.stack([found.status for found in every]),
        tuple(
            MeshShare(*np.moveaxis(np.stack([found.shares[:, pair] for found in every]), -1, 0))
            for pair in range(every[0].shares.shape[1])
        ),
    )


@dataclass(frozen=True)
class _Results:
    """Figures of a solved problem at P positions, as in `LoadedMesh`."""

    #: rotations (P,) of the gear at first touch, rad
    phi2: Array
    #: rotation (P,) of the pinion from there, rad
    rotation: Array
    #: tangent stiffness (P,)
    tangent: Array
    #: torque (P,) on the gear
    gear_torque: Array
    #: largest stress (P, 2) in the fillets
    root_stress: Array
    #: its places (P, 2, 3)
    root_place: Array
    #: stress (P, 2) at tangents of 30 deg
    tangent_stress: Array
    #: estimated relative error (P, 2) of bending stress
    root_error: Array
    #: largest stress (P, 2) within the contact's own field
    contact_stress: Array
    #: residual (P,)
    residual: Array
    #: status (P,)
    status: NDArray[np.int64]
    #: values (P, K, 3) of `MeshShare` of K pairs that share the torque, the own pair first; none for a single pair
    shares: Array
    #: load on the tooth pairs of the own pair
    load: PairLoad

    @staticmethod
    def of(problem: _Problem, gears: GearPair, errors: tuple[Array, Array] | None = None) -> _Results:
        """Return the results of a problem of gears; `errors` as of `loads`.

        Raises NoSolutionError if other pairs carry all of the torque.
        """
        near, solution, load = problem.near, problem.solution, problem.loads(errors)
        own, shares = gears.own_halves, np.empty((len(near.phi1), 0, 3))
        if gears.fellows:
            parts = [
                load.some(np.flatnonzero(np.maximum(load.half - own + 1, 0) == k))
                for k in range(len(gears.fellows) + 1)
            ]
            shares = np.stack([part.share(len(near.phi1)) for part in parts], axis=1)
            load = parts[0]
            if not load.force.any():
                raise NoSolutionError(
                    reason=f"{gears.name} carries nothing of {1e-3 * problem.torque.max():g} Nm: other meshes carry all of it",
                    remedy="a larger torque, or the figures of another mesh (--pair)",
                )
        # status: contact must neither fill its grid to the sides nor reach its open ends
        status = solution.status.copy()
        status[near.position[(problem.fill() > FILL_RANGE[1]) | problem.reaches_ends().any(axis=0)]] = (
            Status.MAX_ITERATIONS
        )
        tangent, tangent_status = problem.tangent_stiffness()
        # root stress at each position, from the tooth pair with the largest stress
        roots, members = load.roots, np.arange(2)
        worst_bending, worst_largest, worst_contact = (
            (roots.worst(values, load.position, len(near.phi1)), members)
            for values in (roots.nominal, roots.largest, roots.contact)
        )
        return _Results(
            near.phi2,
            solution.rotation,
            tangent,
            problem.gear_torque(),
            roots.largest[worst_largest],
            roots.place[worst_largest],
            roots.bending[worst_bending],
            roots.error[worst_bending],
            roots.contact[worst_contact],
            solution.residual,
            np.where(tangent_status == Status.CONVERGED, status, tangent_status),
            shares,
            load,
        )

    def parts(self, count: int) -> list[_Results]:
        """Return the results of `count` equal parts of the positions."""
        size = len(self.phi2) // count
        arrays = {name: np.split(values, count) for name, values in vars(self).items() if name != "load"}
        return [
            replace(self, **{name: parts[k] for name, parts in arrays.items()}, load=self.load.at(k * size, size))
            for k in range(count)
        ]


@dataclass(frozen=True)
class Reference:
    """A solved mesh whose grids and bodies serve nearly equal gears at the same positions."""

    #: torques (T,) on the pinion, N mm
    torque: Array
    #: the mesh at P positions under all torques, one after the other, as T P positions
    problem: _Problem
    #: tooth pairs at the positions
    near: NearPairs
    #: relative errors of peak pressures (T M,) and of bending stresses (T M, 2), estimated; those of the variants are
    #: taken to be the same
    errors: tuple[Array, Array]

    @staticmethod
    def of(
        gears: GearPair,
        phi1: Array,
        torque: Array,
        bodies: tuple[FlankCompliance, FlankCompliance],
        materials: tuple[Material, Material],
        level: Level,
    ) -> Reference:
        """Solve a mesh at P rotations under the torques (T,), N mm, of its variants."""
        model = _Model(bodies, materials, CONTACT_CELLS if level == "full" else QUICK_CELLS, level)
        applied = np.unique(torque)[::-1]
        reached, _ = _reached(gears, phi1, applied[0], model)
        problem = reached.finished(float(applied[0]))
        grids = [problem.grids.copy()]
        for smaller in applied[1:]:
            problem.press(float(smaller))
            grids.append(problem.grids.copy())
        near = problem.near.repeated(len(applied))
        at_once = _Problem(near, np.repeat(applied, len(phi1)), model, _Grids.join(grids), tolerance=model.tolerance)
        at_once.fit(WIDENING_FACTOR, ends=True)
        load = at_once.loads()
        return Reference(applied, at_once, problem.near, (load.error, load.roots.error))

    @property
    def bodies(self) -> tuple[FlankCompliance, FlankCompliance]:
        """Compliance of the working flanks of pinion and gear."""
        return self.problem.bodies

    def at_positions(self, phi1: Array) -> bool:
        """Return True if the mesh is solved at these rotations (P,), rad."""
        own = self.near.phi1
        return len(own) == len(phi1) and bool(np.allclose(own, phi1, rtol=0.0, atol=1e-9))


def largest_shift(
    first: GearPair,
    second: GearPair,
    outlines: tuple[BodyOutline, BodyOutline],
    other_outlines: tuple[BodyOutline, BodyOutline],
) -> float:
    """Return the largest distance between the same places of two mounted pairs over the depth of the teeth; infinite for
    other flanks or bodies. `outlines` and `other_outlines` are those of their members."""
    if first.flanks != second.flanks:
        return np.inf
    return max(
        mine.shift(other) + mine.moved(*(each.at(0.0) for each in mounts))
        for mine, other, mounts in zip(
            outlines, other_outlines, zip(first.mounts, second.mounts, strict=True), strict=True
        )
    )


def modified_shift(first: GearPair, second: GearPair, outlines: tuple[BodyOutline, BodyOutline]) -> float | None:
    """Return `largest_shift` of two pairs that differ in modifications of their flanks alone; None for others.

    `outlines` are those of the members of the first pair.
    """
    if first.flanks != second.flanks:
        return None
    shift = 0.0
    for member, other, outline in zip(first.both, second.both, outlines, strict=True):
        tooth, other_tooth = member.one_tooth, other.one_tooth
        bases = member.mount.base, other.mount.base
        mounted = all(
            np.array_equal(getattr(bases[0], part), getattr(bases[1], part)) for part in ("rotation", "translation")
        )
        if not mounted or not _same_tools(tooth, other_tooth):
            return None
        if tooth is not other_tooth and tooth != other_tooth:
            for region in FLANK_REGIONS.values():
                places, others = (each.grid(region, SHIFT_ROWS, each.even).points for each in (tooth, other_tooth))
                apart = _aside(places, others)
                if apart is None:
                    return None
                shift = max(shift, apart / outline.depth)
    return shift


def _aside(places: Array, others: Array) -> float | None:
    """Return the largest distance, mm, along the circumference between two flanks with rows of points (I, J, 3); None where
    their columns are not in the same planes across the axis."""
    if places.shape != others.shape or np.abs(np.ptp([*places[..., 2], *others[..., 2]], axis=0)).max() > SAME_PLANE_MM:
        return None
    largest = 0.0
    for column, other in zip(places.swapaxes(0, 1), others.swapaxes(0, 1), strict=True):
        (radius, angle), (other_radius, other_angle) = (
            (np.hypot(p[:, 0], p[:, 1]), np.arctan2(p[:, 1], p[:, 0])) for p in (column, other)
        )
        order = np.argsort(radius)
        known = np.interp(other_radius, radius[order], angle[order])
        largest = max(largest, float((other_radius * np.abs(other_angle - known)).max()))
    return largest


def _same_tools(tooth: Tooth, other: Tooth) -> bool:
    """Return True for teeth that are the same without their modifications; False if that cannot be told."""
    try:
        return tooth is other or bool(tooth.unmodified_tooth == other.unmodified_tooth)
    except ValueError:
        # surfaces with arrays, as those of bevel gears
        return False


def outlines_of(gears: GearPair) -> tuple[BodyOutline, BodyOutline]:
    """Return the outlines of both members of a pair; that of the tooth of another design, if it is equal."""
    pinion, gear = (_outline_of(member.one_tooth, side) for member, side in zip(gears.both, gears.flanks, strict=True))
    return pinion, gear


def _outline_of(tooth: Tooth, side: Side) -> BodyOutline:
    """Return the outline of a gear of teeth that are loaded on one side, from those of the last teeth if these can be
    compared."""
    try:
        return _kept_outline(tooth, side)
    except TypeError:
        # surfaces with arrays, as those of bevel gears
        return BodyOutline.of(tooth, side)


#: outlines of the last teeth: variants of one member have the other member's tooth of the unchanged design
_kept_outline = lru_cache(maxsize=MAX_KEPT_OUTLINES)(BodyOutline.of)


def _reached(gears: GearPair, phi1: Array, torque: float, model: _Model) -> tuple[_Problem, float]:
    """Return the problem of all tooth pairs loaded under the largest torque, N mm, on grids that are fitted with coarse
    cells, and the search distance, mm.

    The deflection of the teeth is estimated. Bodies may deflect more, soft webs above all; the search is then repeated
    with a larger distance.
    """
    points = model.bodies[0].points
    face = float(np.linalg.norm(points[0, -1] - points[0, 0]))
    arm = float(np.hypot(points[..., 0], points[..., 1]).mean())
    limit = 3.0 * UNIT_DEFLECTION_MM * torque / (arm * face * contact_modulus(*model.materials))
    while True:
        near = near_pairs(gears, phi1, limit)
        problem = _fit_grids(near, torque, model, coarse=True)
        largest_approach = float((problem.solution.rotation[near.position] * problem.lever).max())
        if APPROACH_MARGIN * largest_approach < limit:
            return problem, limit
        limit = 1.5 * largest_approach


@dataclass(frozen=True)
class _Model:
    """Model of the members under load."""

    #: compliance of the working flanks of pinion and gear
    bodies: tuple[FlankCompliance, FlankCompliance]
    #: materials of pinion and gear
    materials: tuple[Material, Material]
    #: numbers of cells along and across each contact
    cells: tuple[int, int]
    #: with "quick", no errors are estimated
    level: Level = "full"

    @property
    def tolerance(self) -> float:
        """Tolerance of the pressures."""
        return PRESSURE_TOLERANCE if self.level == "full" else QUICK_TOLERANCE

    @property
    def coarse(self) -> _Model:
        """The model with cells twice as long and wide, with which grids are fitted; the same if it has few cells."""
        along, across = self.cells[0] // 2, self.cells[1] // 2
        few = along < MIN_FITTED_CELLS[0] or across < MIN_FITTED_CELLS[1]
        return self if few else replace(self, cells=(along, across))

    def fine(self, grids: _Grids) -> _Grids:
        """Return grids that were fitted with `coarse` cells, with their pressures on the cells of this model."""
        return grids if self.coarse is self else grids.with_halved_cells()


@dataclass(frozen=True)
class _Grids:
    """Sizes of the grids of tooth pairs (M,), and the pressures from which they are solved."""

    #: torque, N mm, from which lengths and widths are estimated
    torque: float
    #: widths (M,) of the grids over the estimate
    widen: Array
    #: start and end (2, M) of the grids as shares of the estimated length
    part: Array
    #: pressures (M, X, Y), MPa, on the grids before; None if there are none
    pressure: Array | None = None

    @staticmethod
    def estimated(count: int, torque: float) -> _Grids:
        """Return grids as long and as wide as estimated from a torque, N mm."""
        return _Grids(torque, np.ones(count), np.repeat([[0.0], [1.0]], count, axis=1))

    def some(self, rows: NDArray[np.intp]) -> _Grids:
        """Return the grids of some pairs."""
        pressure = None if self.pressure is None else self.pressure[rows]
        return _Grids(self.torque, self.widen[rows], self.part[:, rows], pressure)

    def copy(self) -> _Grids:
        """Return the grids with arrays of their own."""
        pressure = None if self.pressure is None else self.pressure.copy()
        return _Grids(self.torque, self.widen.copy(), self.part.copy(), pressure)

    @staticmethod
    def join(grids: Sequence[_Grids]) -> _Grids:
        """Return grids of the same torque, one after the other."""
        pressures_before = [each.pressure for each in grids if each.pressure is not None]
        return _Grids(
            grids[0].torque,
            np.concatenate([each.widen for each in grids]),
            np.concatenate([each.part for each in grids], axis=1),
            np.concatenate(pressures_before),
        )

    def with_halved_cells(self) -> _Grids:
        """Return the grids with their pressures on cells half as long and half as wide."""
        assert self.pressure is not None
        return replace(self, pressure=self.pressure.repeat(2, axis=1).repeat(2, axis=2))

    def carried(self, old: NearPairs, new: NearPairs) -> _Grids:
        """Return the grids of the pairs that are near after members have moved; pairs that were not near have grids as
        estimated, without pressure."""
        keys, new_keys = (
            list(zip(near.position.tolist(), near.number.tolist(), near.half.tolist(), strict=True))
            for near in (old, new)
        )
        row_of = {key: row for row, key in enumerate(keys)}
        known = np.array([key in row_of for key in new_keys])
        rows = np.array([row_of[key] for key in new_keys if key in row_of], dtype=np.intp)
        grids = _Grids.estimated(len(new_keys), self.torque)
        grids.widen[known], grids.part[:, known] = self.widen[rows], self.part[:, rows]
        if self.pressure is None:
            return grids
        pressure = np.zeros((len(new_keys), *self.pressure.shape[1:]))
        pressure[known] = self.pressure[rows]
        return replace(grids, pressure=pressure)


def _fit_grids(
    near: NearPairs,
    torque: float,
    model: _Model,
    supports: Supports | None = None,
    grids: _Grids | None = None,
    *,
    coarse: bool = False,
) -> _Problem:
    """Solve the problem of one torque on grids that contain the whole contact and are filled by it.

    `grids` are those to begin with, by default as estimated. Only positions with a grid that does not fit are solved
    again. With `coarse` cells ends stay where they are: whether a contact reaches an open end is seen by the cells
    themselves.
    """
    begin = _Grids.estimated(len(near.position), torque) if grids is None else grids
    tolerance, level = (FIT_TOLERANCE, model.coarse) if coarse else (model.tolerance, model)
    problem = _Problem(near, torque, level, begin, supports, tolerance=tolerance)
    problem.whole_model = model
    problem.fit(COARSE_WIDENING_FACTOR if coarse else WIDENING_FACTOR, ends=not coarse)
    return problem


class _OnMounts:
    """A mesh on elastic mounts under one torque, N mm, with its members displaced so far.

    `shared` is the number of the member that the other mesh loads too, if there is one.
    """

    def __init__(
        self,
        gears: GearPair,
        near: NearPairs,
        torque: float,
        model: _Model,
        supports: Supports,
        limit: float,
        shared: int | None = None,
    ) -> None:
        self.gears, self.near, self.torque, self.model = gears, near, torque, model
        self.supports, self.limit, self.shared = supports, limit, shared
        self.grids: _Grids | None = None
        self.problem: _Problem

    def solve(self, *, coarse: bool) -> None:
        """Solve the mesh with its members where they are."""
        self.problem = _fit_grids(self.near, self.torque, self.model, self.supports, self.grids, coarse=coarse)

    def loaded_by(self, meshes: Sequence[_OnMounts]) -> Supports:
        """Return the supports with what the other of both meshes loads them with."""
        others = np.zeros_like(self.supports.others)
        for other in meshes:
            if other is not self and self.shared is not None and other.shared is not None:
                others[:, self.shared] = other.problem.wrenches()[:, other.shared]
        return replace(self.supports, others=others)

    def settled(self, supports: Supports) -> bool:
        """Return True if the members are where the pressures and `supports` move them."""
        displacements = self.problem.displacement(supports)
        # rotations count as displacements at the largest lever
        largest_lever = float(self.problem.grid.levers.max())
        to_length = np.array([1.0, 1.0, 1.0, largest_lever, largest_lever, largest_lever])
        change = np.abs(displacements.mean(axis=0) - supports.displacement) * to_length
        pull_change = np.abs(supports.pull - self.supports.pull) * to_length
        held_change = np.abs(displacements - supports.anchor) * to_length * (supports.holding > 0.0)
        moved = max(change.max(), pull_change.max())
        return bool(moved < MOUNT_TOLERANCE_MM and held_change.max() < HELD_TOLERANCE_MM)

    def move(self, supports: Supports) -> None:
        """Move the members by the mean displacement, and search contact again."""
        self.supports, displaced = supports.displace(self.gears, self.problem.displacement(supports))
        self.near = near_pairs(displaced, self.near.phi1, self.limit)
        self.grids = self.problem.grids.carried(self.problem.near, self.near)


def _solve_on_mounts(meshes: Sequence[_OnMounts]) -> tuple[_Problem, bool]:
    """Solve a mesh, or both meshes of a planet, with displaced members.

    Returns the problem of the first mesh, and True if the mean displacements have converged. Members find their places with
    coarse cells first.
    """
    _settle(meshes, coarse=True)
    for mesh in meshes:
        mesh.grids = mesh.model.fine(mesh.problem.grids)
    converged = _settle(meshes, coarse=False)
    return meshes[0].problem, converged


def _settle(meshes: Sequence[_OnMounts], *, coarse: bool) -> bool:
    """Move members until their displacement is the mean of those under the pressures; return True if it has converged.

    Both meshes of a planet are solved in turns, each under the load of the other.
    """
    for mesh in meshes:
        mesh.solve(coarse=coarse)
    slow = len(meshes) > 1 or meshes[0].supports.held
    for rounds_left in reversed(range(MAX_HELD_ROUNDS if slow else MAX_MOUNT_ROUNDS)):
        settled = True
        for mesh in meshes:
            supports = mesh.loaded_by(meshes)
            if mesh.settled(supports):
                continue
            settled = False
            if rounds_left:
                mesh.move(supports)
                mesh.solve(coarse=coarse)
        if settled:
            return True
    return False


class _Problem:
    """Contact problem of all positions: tooth pairs (M,), each with a grid of cells (X, Y).

    The torque is one for all, or one for each position (P,).
    Arrays by position have slots (P, K) for the pairs: K is the largest number of pairs at a position.
    """

    def __init__(
        self,
        near: NearPairs,
        torque: float | Array,
        model: _Model,
        grids: _Grids,
        supports: Supports | None = None,
        slots: tuple[NDArray[np.intp], int] | None = None,
        tolerance: float = PRESSURE_TOLERANCE,
        known: ContactCompliance | None = None,
    ) -> None:
        bodies, materials, cells = model.bodies, model.materials, model.cells
        self.whole_model = model
        self.near, self.model, self.supports, self.tolerance = near, model, supports, tolerance
        self.bodies, self.materials = bodies, materials
        count = len(near.phi1)
        self.torque = np.broadcast_to(torque, count)
        self.slot, self.most = slots or _slots_of(near)
        # gaps on grids whose size is estimated from the whole torque on each pair alone
        self.lever = near.levers(0, near.path.point, near.axes[:, :, 2])
        self.estimate, modulus = grids.torque, contact_modulus(*materials)
        self.grid = separation(near, grids.torque / self.lever, modulus, cells, grids.widen, grids.part)
        self.widen = grids.widen.copy()
        # part of each grid's length that the contact filled under the torque for which it was made; 0 before it is known
        self.filled = np.zeros(len(self.widen))
        grid = self.grid
        dx, dy, ends = self._cells_and_ends()
        self.contact = ContactCompliance.of(dx, dy, cells, materials, ends)
        if known is not None:
            self.contact.take(known)
        self.area = self._slots(grid.dx * grid.dy)
        # motions from the teeth that touch to the tooth of which the compliance is known
        self.to_body = [
            body.along_helix(near.rotation(member), places)
            for member, (body, places) in enumerate(zip(bodies, grid.places, strict=True))
        ]
        self.places = [_in_frame(motion, places) for motion, places in zip(self.to_body, grid.places, strict=True)]
        self.shares = [body.shares(places) for body, places in zip(bodies, self.places, strict=True)]
        # compliance of both bodies, and of the mounts if they are elastic
        smooth = self._smooth()
        slot_shape = (count, self.most, *cells)
        on, gap = self._slots(grid.on), self._slots(grid.gap)
        if supports is not None:
            for k, wrench_rows in enumerate(supports.wrenches(near.in_place(grid.middle), near.turn(grid.normal))):
                wrench = self._slots(wrench_rows).reshape(count, -1, 6)
                smooth += wrench @ supports.compliance[k] @ wrench.swapaxes(1, 2)
                # the gaps already contain the displacement by which members have been moved
                present = supports.displacement[k] - supports.pull[:, k]
                gap -= (wrench @ present[..., None]).reshape(*slot_shape[:3], 1)
        lever = np.broadcast_to(self._slots(grid.levers[0])[..., None], slot_shape)
        area = np.broadcast_to(self.area[..., None, None], slot_shape)

        # initial pressure: semi-ellipses across the contact
        eta = (np.arange(cells[1]) + 0.5) * 2.0 / cells[1] - 1.0
        # only the pair that touches first is pressed initially; others follow as soon as they overlap
        with np.errstate(invalid="ignore"):
            pair_gap = np.where(on, gap, np.inf).min(axis=(2, 3))
        touches_first = pair_gap <= pair_gap.min(axis=1, keepdims=True)
        start = np.sqrt(1.0 - eta**2) * on * touches_first[:, :, None, None]
        flat_shape = (count, -1)
        if grids.pressure is not None:
            # or the pressures of the last grids, cell by cell
            last_values = self._slots(grids.pressure) * on
            start = np.where(last_values.any(axis=(1, 2, 3))[:, None, None, None], last_values, start)
        idle = ~((area * lever * start).reshape(count, -1).sum(axis=1) > 0.0)
        if idle.any():
            raise NoSolutionError(
                reason=f"at phi1 = {np.degrees(near.phi1[np.argmax(idle)]):g} deg the teeth touch beyond their flanks, where "
                "pressures are not known",
                remedy="tca shows the contact and any interference",
            )
        self.levers, self.areas = lever.reshape(flat_shape), area.reshape(flat_shape).copy()
        self.smooth, self.gap, self.on = smooth, gap, on
        # what elastic mounts add to the gaps
        self.added = gap - self._slots(grid.gap)
        self.solution = Pressures.empty(*self.levers.shape)
        self.pressure, self.line = np.empty_like(grid.gap), np.empty_like(grid.middle[..., 0])
        self._solve(np.arange(count), start.reshape(flat_shape))

    def _solve(self, which: NDArray[np.intp], start: Array) -> None:
        """Solve the positions `which` (B,) from pressures `start` (B, K X Y)."""
        grid, flat = self.grid, (len(which), -1)
        solution = pressures(
            self._moved(which),
            self.gap[which].reshape(flat),
            self.levers[which],
            self.areas[which],
            self.on[which].reshape(flat),
            self.torque[which],
            start,
            self._ease(grid.dx, grid.dy, self.gap.shape)[which],
            self._estimate(which),
            self.tolerance,
        )
        self.solution = self.solution.replaced(which, solution)
        self.pressure = self.solution.pressure.reshape(self.gap.shape)[self.near.position, self.slot]
        self.line = self.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None]

    def _moved(self, which: NDArray[np.intp]) -> Displacements:
        """Return the function that maps pressures on all cells of positions `which` to displacements, mm."""
        whole = _displacements(self.contact, self.smooth, self.area, self.model.cells)
        return lambda p, rows: whole(p, which[rows])

    def _estimate(self, which: NDArray[np.intp]) -> Displacements:
        """Return the function that estimates pressures under displacements at positions `which`, up to a factor."""
        sizes = self._slots(self.grid.dx, 1.0)[which], self._slots(self.grid.dy, 1.0)[which]
        return half_space_pressures(*sizes, self.model.cells)

    @property
    def grids(self) -> _Grids:
        """Sizes and pressures of the grids."""
        return _Grids(self.estimate, self.widen, self.grid.part, self.pressure)

    def finished(self, torque: float) -> _Problem:
        """Return the problem solved with the cells of the whole model under a torque, N mm."""
        model = self.whole_model
        if model is not self.model:
            return _fit_grids(self.near, torque, model, grids=model.fine(self.grids))
        if torque != self.torque[0]:
            self.press(torque)
        if self.tolerance == model.tolerance:
            return self
        self.tolerance = model.tolerance
        # gaps of grids that have become narrower are computed anew
        narrowed = np.bincount(self.near.position, self.grid.narrow < 1.0, len(self.near.phi1)) > 0
        if not narrowed.all():
            self._solve(np.flatnonzero(~narrowed), self.solution.pressure[~narrowed])
        if narrowed.any():
            self.solve_again(narrowed, self.grids)
        self.fit(WIDENING_FACTOR, ends=True)
        return self

    def of_near(self, near: NearPairs) -> _Problem:
        """Return the problem of the same pairs of nearly equal gears, from the grids and pressures of these, with the same
        bodies."""
        slots = self.slot, self.most
        problem = _Problem(near, self.torque, self.model, self.grids, None, slots, VARIANT_TOLERANCE, self.contact)
        problem.fit(WIDENING_FACTOR, ends=True)
        return problem

    def free_rotation(self) -> Array:
        """Return the rotations (P,), rad, at which the first tooth pair touches without load."""
        with np.errstate(divide="ignore", invalid="ignore"):
            ways = np.where(self.grid.on, self.grid.gap / self.grid.levers[0][:, :, None], np.inf).min(axis=(1, 2))
        # or at the place where the reference touches first
        ways = np.minimum(ways, self.near.first_gap / self.lever)
        free = np.full(len(self.near.phi1), np.inf)
        np.minimum.at(free, self.near.position, ways)
        return free

    def press(self, torque: float) -> None:
        """Solve again under another torque, N mm, from the grids and the pressures of the last one.

        Results of the last torque keep their arrays.
        """
        ratio = min(torque / float(self.torque[0]), 1.0)
        share = np.full(len(self.widen), ratio**WIDTH_EXPONENT)
        (start, length), loaded = self.used_part(), self._counting()
        self.torque, self.grid = np.full(len(self.torque), torque), self.grid.copy()
        self.pressure, self.line = self.pressure.copy(), self.line.copy()
        self.solution = self.solution.copy()
        self.filled = np.where(self.filled > 0.0, self.filled, length)
        # contacts that end within their grids get shorter, ellipses by the cube root of the torque
        shorter = np.where((start > 0.0) & (start + length < 1.0), ratio**LENGTH_EXPONENT, 1.0) * length
        shrunk = loaded & (shorter < SHRUNK_SHARE * self.filled)
        anew = shrunk | (loaded & (share * self.grid.narrow < MIN_NARROW_SHARE))
        apart = np.bincount(self.near.position, anew, len(self.near.phi1)) > 0
        if not apart.all():
            self._narrow(np.flatnonzero(~apart), share, self.solution.pressure.copy())
        if apart.any():
            ends = np.where(
                shrunk, self._cut(start + 0.5 * (length - shorter), shorter, SHRUNK_ROOM_SHARE), self.grid.part
            )
            self.solve_again(apart, _Grids(self.estimate, share * self.widen, ends, self.pressure))
        self.fit(WIDENING_FACTOR, ends=True)

    def _counting(self) -> NDArray[np.bool_]:
        """Return True (M,) for pairs whose force is more than a small part of the largest at their position."""
        force, largest = self.line.sum(axis=1), np.zeros(len(self.near.phi1))
        np.maximum.at(largest, self.near.position, force)
        return np.asarray(force > LIGHT_LOAD_SHARE * largest[self.near.position])

    def _cut(self, start: Array, length: Array, room: Array | float) -> Array:
        """Return the ends (2, M) of grids that are cut to contacts from `start` (M,) and of a `length` (M,), as shares of
        the grids; `room` at both ends is a share of the length."""
        at_end = np.maximum(room * length, 2.0 / self.model.cells[0])
        ends: Array = np.clip([start - at_end, start + length + at_end], 0.0, 1.0)
        part = self.grid.part
        cut: Array = part[0] + (part[1] - part[0]) * ends
        return cut

    def fit(self, widening: float, *, ends: bool) -> None:
        """Solve positions again until all grids fit; arguments are those of `better_grids`."""
        for _ in range(MAX_GRID_ROUNDS - 1):
            wrong, better = self.better_grids(widening, ends=ends)
            if not wrong.any():
                break
            # grids that become narrower alone need no surfaces
            share = better.widen / self.widen
            longer = (better.part != self.grid.part).any(axis=0) | (share > 1.0)
            longer |= share * self.grid.narrow < MIN_NARROW_SHARE
            elsewhere = wrong & (np.bincount(self.near.position, longer, len(wrong)) > 0)
            if elsewhere.any():
                self.solve_again(elsewhere, better)
            narrower = np.flatnonzero(wrong & ~elsewhere)
            if narrower.size:
                share = np.where(np.isin(self.near.position, narrower), better.widen / self.widen, 1.0)
                self._narrow(narrower, share, self._at_places(share))

    def better_grids(self, widening: float, *, ends: bool) -> tuple[NDArray[np.bool_], _Grids]:
        """Return the positions (P,) with a grid that does not fit the contact, and grids that fit better.

        `widening` is the factor for grids that are too narrow; True for `ends` moves open ends out.
        """
        filled_width, (used_from, used_share), open_end = self.fill(), self.used_part(), self.reaches_ends() & ends
        # grids to change: too narrow or too wide, much longer than the contact, or ended by an open end
        misfit = (filled_width > FILL_RANGE[1]) | ((filled_width > 0.0) & (filled_width < FILL_RANGE[0]))
        short = (used_share > 0.0) & (used_share < MIN_LENGTH_SHARE) & ~open_end.any(axis=0)
        # or much shorter than under the torque for which the grid was made, with a load that counts
        shrunk = (used_share < SHRUNK_SHARE * self.filled) & self._counting()
        shrunk &= (used_share > 0.0) & ~short & ~open_end.any(axis=0)
        # or so much larger than a contact that no cell is where the bodies overlap
        missed, touch = self._missed()
        # too wide: fill three quarters of the width
        widen = np.where(
            filled_width > FILL_RANGE[1],
            widening * self.widen,
            np.where(misfit, self.widen * filled_width / 0.75, self.widen),
        )
        # much longer than the contact: cut to the contact and some room at both ends
        cut = self._cut(used_from, used_share, np.where(short, 0.5, SHRUNK_ROOM_SHARE))
        part = self.grid.part
        part_length = part[1] - part[0]
        # the width grows with the square root of the load per length
        shortened = np.sqrt((cut[1] - cut[0]) / part_length)
        widen = np.where(short & (filled_width > FILL_RANGE[0]), widen / shortened, widen)
        widen = np.where(missed, MISSED_SHARE * widen, widen)
        cut = np.where(missed, self._cut(touch, np.zeros_like(touch), 0.0), cut)
        # an open end that the contact reaches moves out by the length of the grid, or by less if it was where a larger
        # torque had it
        way = np.where(self.filled > 0.0, MOVED_END_SHARE, 1.0) * part_length
        part = np.where(short | shrunk | missed, cut, part) + open_end * way * np.array([[-1.0], [1.0]])
        wrong = np.zeros(len(self.near.phi1), dtype=bool)
        wrong[self.near.position[misfit | short | shrunk | missed | open_end.any(axis=0)]] = True
        return wrong, _Grids(self.estimate, widen, part, self.pressure)

    def _missed(self) -> tuple[NDArray[np.bool_], Array]:
        """Return pairs (M,) without pressure whose bodies overlap where they would touch first, and the places (M,) of
        first touch along the grids, as shares of their lengths."""
        near, grid = self.near, self.grid
        cells = self.pressure.shape[1]
        touch = (grid.ridge_ends[0] - near.range[0]) / (cells * grid.dx)
        row = np.clip(np.floor(cells * touch), 0, cells - 1).astype(np.intp)
        every = np.arange(len(row))
        moved = (self.smooth @ self._slots(self.line).reshape(len(self.smooth), -1, 1)).reshape(*self.gap.shape[:3])
        approach = self.solution.rotation[near.position] * grid.levers[0, every, row]
        added = self.added[near.position, self.slot, row, 0]
        overlap = approach - moved[near.position, self.slot, row] - near.first_gap - added
        on_grid = (np.abs(touch - 0.5) < 0.5 + 1.0 / cells) & ~self.pressure.any(axis=(1, 2))
        return np.asarray(on_grid & (overlap > MISSED_OVERLAP_SHARE * approach)), touch

    def solve_again(self, positions: NDArray[np.bool_], grids: _Grids) -> None:
        """Solve some of the positions (P,) again on other grids, and replace what was found there."""
        near = self.near.at_positions(positions)
        rows = np.flatnonzero(positions[self.near.position])
        part = _Problem(
            near,
            self.torque[positions],
            self.model,
            grids.some(rows),
            None if self.supports is None else self.supports.at_positions(positions),
            (self.slot[rows], self.most),
            self.tolerance,
        )
        moved_ends = (part.grid.part != self.grid.part[:, rows]).any(axis=0)
        self.filled[rows] = np.where(moved_ends, part.used_part()[1], self.filled[rows])
        self.grid.put(rows, part.grid)
        for whole, replaced in zip(self._of_pairs(), part._of_pairs(), strict=True):
            whole[rows] = replaced
        for whole, replaced in zip(self._of_positions(), part._of_positions(), strict=True):
            whole[positions] = replaced

    def _narrow(self, which: NDArray[np.intp], share: Array, start: Array) -> None:
        """Solve positions `which` (B,) again on grids that have a `share` (M,) of their width, from pressures `start`
        (P, K X Y)."""
        rows = np.flatnonzero(np.isin(self.near.position, which))
        grid, cells = self.grid, self.model.cells
        grid.narrowed(rows, share[rows])
        self.widen[rows] *= share[rows]
        self.contact.replace(which, *(values[..., which, :] for values in self._cells_and_ends()))
        self.area = self._slots(grid.dx * grid.dy)
        self.areas[which] = np.repeat(self.area[which], cells[0] * cells[1], axis=1)
        self.on, self.gap = self._slots(grid.on), self._slots(grid.gap) + self.added
        self._solve(which, np.where(self.on.reshape(start.shape), start, 0.0)[which])

    def _at_places(self, share: Array) -> Array:
        """Return the pressures (P, K X Y) at the places of the cells of grids with a `share` (M,) of their width."""
        count = self.model.cells[1]
        eta = (np.arange(count) + 0.5) * 2.0 / count - 1.0
        old = np.clip(np.floor(0.5 * count * (share[:, None] * eta + 1.0)), 0, count - 1).astype(np.intp)
        values = self._slots(np.take_along_axis(self.pressure, old[:, None, :], axis=2))
        return values.reshape(len(values), -1)

    def _of_pairs(self) -> list[NDArray[Any]]:
        """Return all arrays by pair (M, ...), apart from those of `grid`."""
        moved = [
            values
            for motion in self.to_body
            for values in (motion.rotation, motion.translation)
            if motion.rotation.ndim > 2
        ]
        return [self.widen, self.pressure, self.line, *self.places, *chain(*self.shares), *moved]

    def _of_positions(self) -> list[NDArray[Any]]:
        """Return all arrays by position (P, ...)."""
        solved = self.solution
        return [
            *(self.contact.dx, self.contact.dy, self.contact.known, self.contact.waves),
            np.moveaxis(self.contact.ends, 2, 0),
            *(self.area, self.levers, self.areas, self.smooth, self.gap, self.on, self.added),
            *(solved.pressure, solved.rotation, solved.residual, solved.status),
        ]

    def _slots(self, values: NDArray[Any], empty: float = 0.0) -> NDArray[Any]:
        """Return values (M, ...) of the pairs as values (P, K, ...) of the slots; empty slots have the value
        `empty`."""
        slots = np.full((len(self.near.phi1), self.most, *values.shape[1:]), empty, dtype=values.dtype)
        slots[self.near.position, self.slot] = values
        return slots

    def _cells_and_ends(self) -> tuple[Array, Array, Array]:
        """Return lengths and widths (P, K) of cells, and distances (2, 2, P, K) of end faces, mm, in slots."""
        ends = np.stack([[self._slots(distances, np.inf) for distances in of_body] for of_body in self.grid.ends])
        return self._slots(self.grid.dx, 1.0), self._slots(self.grid.dy, 1.0), ends

    def _ease(self, dx: Array, dy: Array, shape: tuple[int, ...]) -> Array:
        """Return deflections (P, K X Y) of cells dx by dy (M,), mm, under unit pressure on each cell alone, up to a
        factor."""
        middle = np.zeros_like(dx)
        ease = self._slots(rectangle_influence(middle, middle, dx, dy), 1.0)
        return np.broadcast_to(ease[..., None, None], shape).reshape(len(ease), -1)

    def _teeth(self, member: int) -> NDArray[np.intp]:
        """Return the number (M,) of the member's tooth in each pair, counted in the direction of motion."""
        pair = self.near.pair
        sense = (pair.pinion.mount.sign, pair.gear.mount.sign * np.sign(pair.ratio))[member]
        return (-sense * self.near.number).astype(np.intp)

    def _couples(self, member: int) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
        """Return couples of pairs at the same position: moved pairs (C,), loaded pairs (C,) and steps (C,).

        Steps lead from the loaded to the moved tooth. Only steps within the reach of the member's compliance are
        returned.
        """
        near = self.near
        moved, loaded = np.nonzero((near.position[:, None] == near.position) & (near.half[:, None] == near.half))
        teeth = self._teeth(member)
        tooth_step = teeth[moved] - teeth[loaded]
        if near.pair.coupled:
            # the shorter way round
            around = round(2.0 * np.pi / near.pair.pitch)
            tooth_step = (tooth_step + around // 2) % around - around // 2
        kept = np.abs(tooth_step) <= self.bodies[member].reach
        return moved[kept], loaded[kept], tooth_step[kept]

    def _smooth(self) -> Array:
        """Return displacements (P, K X, K X), mm/N, of the grids' rows under forces on the rows, as the sum of both
        members."""
        count, x = len(self.near.phi1), self.grid.middle.shape[1]
        compliance = np.zeros((count, self.most, x, self.most, x))
        for member, (body, (nodes, share)) in enumerate(zip(self.bodies, self.shares, strict=True)):
            teeth = self._teeth(member)
            for moved, loaded, tooth_step in zip(*self._couples(member), strict=True):
                table = body.of_tooth(teeth[loaded]).smooth[tooth_step + body.reach]
                node_compliance = table[nodes[moved][:, :, None, None], nodes[loaded][None, None]]
                of_nodes = np.einsum("xayb,yb->xay", node_compliance, share[loaded])
                row_compliance = np.einsum("xay,xa->xy", of_nodes, share[moved])
                compliance[self.near.position[moved], self.slot[moved], :, self.slot[loaded]] += row_compliance
        size = self.most * x
        return compliance.reshape(count, size, size)

    def fill(self) -> Array:
        """Return the half width (M,) of each contact over the half width of its grid; 0 without contact."""
        y = self.pressure.shape[2]
        edge = (np.abs(2.0 * np.arange(y) + 1.0 - y) + 1.0) / y
        fill: Array = np.where(self.pressure > 0.0, edge, 0.0).max(axis=(1, 2))
        return fill

    def tangent_stiffness(self) -> tuple[Array, NDArray[np.int64]]:
        """Return the tangent stiffness (P,), N mm/rad, and its status (P,)."""
        p = self.solution.pressure
        every = np.arange(len(p))
        return tangent_stiffness(self._moved(every), self.levers, self.areas, p > 0.0, p, self._estimate(every))

    def reaches_ends(self) -> NDArray[np.bool_]:
        """Return True (2, M) where a contact reaches the first or the last end of its grid and the flanks continue
        beyond this end."""
        ends = (self.pressure[:, [0, -1]] > 0.0).any(axis=2).T
        reaching: NDArray[np.bool_] = ends & self.grid.open
        return reaching

    def used_part(self) -> tuple[Array, Array]:
        """Return the start of each contact along its grid, and its length, (M,), as shares of the grid; the length is 0
        without contact."""
        along: NDArray[np.bool_] = np.asarray((self.pressure > 0.0).any(axis=2))
        count = along.shape[1]
        first, last = along.argmax(axis=1), count - along[:, ::-1].argmax(axis=1)
        return first / count, np.where(along.any(axis=1), (last - first) / count, 0.0)

    def wrenches(self) -> Array:
        """Return forces and moments (P, 2, 6), N and N mm, of the pressures on both members, in the frames of their mounts;
        0 for rigid mounts."""
        assert self.supports is not None
        total = np.zeros((len(self.near.phi1), 2, 6))
        points, normals = self.near.in_place(self.grid.middle), self.near.turn(self.grid.normal)
        for k, wrench in enumerate(self.supports.wrenches(points, normals)):
            np.add.at(total[:, k], self.near.position, np.einsum("mxi,mx->mi", wrench, self.line))
        return total

    def displacement(self, supports: Supports | None = None) -> Array:
        """Return displacements (P, 2, 6), mm and rad, of both members in their mounts, or in other `supports`, under the
        pressures."""
        own = supports or self.supports
        assert own is not None
        displacements: Array = own.pull + (own.compliance @ self.wrenches()[..., None])[..., 0]
        return displacements

    def gear_torque(self) -> Array:
        """Return the torque (P,) on the gear, N mm."""
        moments = (self.line * self.grid.levers[1]).sum(axis=1)
        return np.bincount(self.near.position, moments, len(self.near.phi1)).astype(float)

    def loads(self, errors: tuple[Array, Array] | None = None) -> PairLoad:
        """Return the load on every tooth pair, with peak pressure, its error, and root stress.

        `errors`: known relative errors of peak pressures (M,) and of bending stresses (M, 2); by default at level "full"
        they are estimated.
        """
        blunt = alike(self.grid)
        on_edge, sharp = (
            np.asarray(((self.pressure > 0.0) & ~inside(self.grid.on, 1, 1, rounded)).any(axis=(1, 2)))
            for rounded in (None, blunt)
        )
        grid, ends = self.grid, self.grid.ridge_ends
        # an end is blunt only if the ridge ends there too: a contact that continues along a tip to the end faces ends
        # at the tip
        blunt_ends = blunt & (SAME_END_CELLS * grid.dx[:, None] > ends.T)
        rows = RowGrid(self.pressure, grid.on, grid.edged, grid.dx, ends, blunt_ends)
        zone = min(edge_zone(body.points) for body in self.bodies)
        largest = peaks(rows, zone)
        error = np.full(len(largest.pressure), np.nan) if errors is None else errors[0]
        if errors is None and self.model.level == "full":
            of_coarser = peaks(coarser(rows, self.by_coarser_cells()), zone).pressure
            error = CELL_ERROR_SHARE * np.abs(largest.pressure - of_coarser) / largest.pressure
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
            self.root_stress() if errors is None else replace(self.root_stress(estimate=False), error=errors[1]),
            error,
        )

    def by_coarser_cells(self) -> Array:
        """Solve for pressures (M, X/2, Y/2), MPa, on cells twice as long and wide, each in place of four cells.

        They are NaN at positions where no pressed cell of this size lies on the flanks.
        """
        cells = (self.pressure.shape[1] // 2, self.pressure.shape[2] // 2)
        count, slots = self.area.shape
        fine_shape, slot_shape = (count, slots, *self.pressure.shape[1:]), (count, slots, *cells)

        def mean(values: Array) -> Array:
            halved: Array = values.reshape(count, slots, cells[0], 2, cells[1], 2).mean(axis=(3, 5))
            return halved

        # a coarse cell is on the flanks if its four cells are
        on = np.asarray(mean(self.on.astype(float)) == 1.0)
        start = np.where(on, mean(self.solution.pressure.reshape(fine_shape)), 0.0)
        # positions without such a pressed cell are solved with all cells pressed, and then dropped
        idle = np.asarray(~start.any(axis=(1, 2, 3)))
        on, start = on | idle[:, None, None, None], np.where(idle[:, None, None, None], 1.0, start)
        row_count = slots * cells[0]
        smooth = self.smooth.reshape(count, row_count, 2, row_count, 2).mean(axis=(2, 4))
        dx, dy, area = 2.0 * self.grid.dx, 2.0 * self.grid.dy, 4.0 * self.area
        slot_dx, slot_dy, ends = self._cells_and_ends()
        local = ContactCompliance.of(2.0 * slot_dx, 2.0 * slot_dy, cells, self.materials, ends)
        flat_shape = (count, -1)
        solution = pressures(
            _displacements(local, smooth, area, cells),
            mean(self.gap).reshape(flat_shape),
            mean(self.levers.reshape(fine_shape)).reshape(flat_shape),
            np.broadcast_to(area[..., None, None], slot_shape).reshape(flat_shape),
            on.reshape(flat_shape),
            self.torque,
            start.reshape(flat_shape),
            self._ease(dx, dy, slot_shape),
            half_space_pressures(self._slots(dx, 1.0), self._slots(dy, 1.0), cells),
        )
        pressure = np.where(idle[:, None], np.nan, solution.pressure).reshape(slot_shape)
        return pressure[self.near.position, self.slot]

    def root_stress(self, *, estimate: bool = True) -> RootStress:
        """Return the root stress of pinion and gear, with its places in the fixed frame; errors are NaN without an
        `estimate`."""
        mounts, stresses = self.near.mounts, []
        for member, body in enumerate(self.bodies):
            pressed = Pressed(
                self.line,
                self.places[member],
                self._teeth(member),
                self._couples(member),
                self.materials[member].poisson_ratio,
            )
            member_stress = root_stress(body, body.coarser if estimate else None, pressed)
            fixed_place = (
                mounts[member]
                .at(self.near.turns[member])
                .point(self.to_body[member].inverse.point(member_stress.place))
            )
            stresses.append(replace(member_stress, place=self.near.in_place(fixed_place)))
        return RootStress.join(*stresses)


def _slots_of(near: NearPairs) -> tuple[NDArray[np.intp], int]:
    """Return the slot (M,) of each pair at its position, in the order of the pairs, and the number of slots."""
    order = np.argsort(near.position, kind="stable")
    slot = np.empty_like(order)
    slot[order] = np.arange(len(order)) - np.searchsorted(near.position[order], near.position[order])
    return slot, int(slot.max()) + 1


def _displacements(local: ContactCompliance, smooth: Array, area: Array, cells: tuple[int, int]) -> Displacements:
    """Return the function that maps pressures on all `cells` of positions to displacements, mm.

    - `local`: local contact compliance.
    - `smooth` (P, K X, K X), mm/N: displacements of rows of cells under forces on rows.
    - `area` (P, K), mm^2: area of the cells.
    """

    # compliance of the positions that were asked last: most are asked again and again
    last, of_last = np.arange(len(smooth)), smooth

    def displace(p: Array, which: NDArray[np.intp]) -> Array:
        nonlocal last, of_last
        if not np.array_equal(which, last):
            last, of_last = which, smooth[which]
        p = p.reshape(len(p), area.shape[1], *cells)
        line = (p.sum(axis=3) * area[which][:, :, None]).reshape(len(p), -1, 1)
        total: Array = local.under(p, which) + (of_last @ line).reshape(*p.shape[:3], 1)
        return total.reshape(len(p), -1)

    return displace


def _in_frame(motion: Rigid, points: Array) -> Array:
    """Return points (M, X, 3) after one motion, or after one motion (M,) each."""
    return motion.point(points) if motion.rotation.ndim == 2 else motion.point(points.swapaxes(0, 1)).swapaxes(0, 1)


def alike(grid: Separation) -> NDArray[np.bool_]:
    """Return True (M, 2) where the flanks of both bodies end at end faces in the same place, at the least and the
    largest x of a grid."""
    return np.asarray((grid.ends < SAME_END_CELLS * grid.dx).all(axis=0).T)


def inside(
    on: NDArray[np.bool_], along: int, across: int | None = None, blunt: NDArray[np.bool_] | None = None
) -> NDArray[np.bool_]:
    """Return the cells (M, X, Y) that are away from cells off the flanks.

    The distance is at least `along` rows and `across` cells from every cell that is not `on` the flanks. `across`
    defaults to `along`. The ends of X count like cells off the flanks, except where `blunt` (M, 2). The sides of Y do
    not count.
    """
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
