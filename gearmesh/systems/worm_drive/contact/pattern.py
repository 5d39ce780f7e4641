"""Position of the contact of a worm drive on the wheel's face, and the mounting that brings it elsewhere.

Workshops set the wheel along its axis until the pattern is in the middle, or slightly towards the leaving side. There
the threads leave the mesh, and lubricant arrives before the contact does. The position is where the path of contact
crosses the middle of the working depth. One displacement brings it to a share of the face
(`common.pattern.meshing_place`). The search starts where the path crosses without errors and continues in small steps.
As for bevel gears, the first touch of the displaced members over both whole flanks decides whether the contact exists.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.contact.assemblies import assembly_paths
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.records import dataclass
from gearmesh.systems.common.pattern.meshing_place import MeshingPlace, Moves
from gearmesh.systems.common.pattern.targets import HalfwayLevel, gear_targets
from gearmesh.systems.system import PatternShift
from gearmesh.systems.worm_drive.build import build, displaced_bases, wheel_hob
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: shares of the face, from toe to heel: 0.2 beside the middle
PLACE_SHARES = (0.3, 0.5, 0.7)
#: displacements and their keys in the table assembly
ASSEMBLY_MOVES = Moves({"V": "da", "J": "dz2", "alpha": "d_sigma"})
#: residual (mm) at which a contact is solved
CONTACT_TOLERANCE_MM = 1e-10
#: largest number of Newton steps
MAX_NEWTON_STEPS = 60
#: largest step between neighbouring places, as a share of the face
MAX_SHARE_STEP = 0.02
#: largest distance (mm) of the first touch from the requested contact; the gap is flat there
MAX_FIRST_TOUCH_DISTANCE_MM = 1e-4
#: number of positions of the path over two pitches
PATH_POSITIONS = 41


def pattern_shifts(design: WormDriveDesign, train: GearTrain, moved: tuple[str, ...]) -> list[PatternShift]:
    """Return displacements that bring the contact of both flanks to PLACE_SHARES of the face, for a design in mm.

    Raises DesignError for line contact, which fills the face, and NoSolutionError for flanks that touch only on edges.
    """
    still = {f"assembly.{key}": 0.0 for key in ("da", "dz1", "dz2", "d_sigma")}
    shifts: list[PatternShift] = []
    for side in Side:
        aligned = design.with_values({**still, "contact.flank": side.value})
        shifts.extend(_Flank(design, aligned, build(aligned), moved).shifts())
    return shifts


@dataclass(frozen=True)
class _Flank:
    """A working flank."""

    #: design with its errors
    design: WormDriveDesign
    #: design without errors
    own: WormDriveDesign
    #: gear set without errors
    train: GearTrain
    #: displacements that are determined
    moved: tuple[str, ...]

    @property
    def pair(self) -> GearPair:
        """Pair of worm and wheel."""
        return self.train.pairs[0]

    @property
    def _moves(self) -> Moves:
        """Displacements, with the sense in which the shaft angle opens."""
        return replace(ASSEMBLY_MOVES, opens=-1.0 if self.design.worm.right_hand else 1.0)

    @property
    def _clearance(self) -> float:
        """Clearance between the worm's tip and the wheel's root, mm."""
        design, hob = self.design, wheel_hob(self.design)
        tip = 0.5 * design.reference_diameter + design.worm.addendum * design.axial_module
        return design.center_distance - tip - (hob.distance - hob.tip_radius)

    def _bases(self, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
        """Return the bases of worm and wheel with errors (N,) in addition to the design's errors."""
        stated = self.design.assembly
        all_errors = {key: values + getattr(stated, key) for key, values in errors.items()}
        return displaced_bases(self.own, self.train, {**all_errors, "dz1": np.full_like(errors["da"], stated.dz1)})

    def shifts(self) -> list[PatternShift]:
        """Return one shift per place, from the entering to the leaving side.

        Raises NoSolutionError if no displacement brings the contact into the face.
        """
        path = self._path()
        shares, x = self._swept(path)
        possible = self._holds(x)
        name = f"worm_{self.own.contact.flank}"
        if not possible.any():
            raise NoSolutionError(
                "assembly", reason=f"{name}: no value of {self.moved[0]} brings the contact into the face"
            )
        shares, x = shares[possible], x[possible]
        values, stated = self._moves.values(x, self.moved), self.design.assembly
        places = ("entering side", "middle", "leaving side")
        rows = []
        for place, asked in zip(places, PLACE_SHARES if self._leaving(path) > 0.0 else PLACE_SHARES[::-1], strict=True):
            k = int(np.abs(shares - asked).argmin())
            v, j, alpha = (getattr(stated, key) + float(values[key][k]) for key in ASSEMBLY_MOVES.keys.values())
            share = asked if abs(shares[k] - asked) < 1e-9 else float(shares[k])
            rows.append(PatternShift(name, place, asked, v, stated.dz1, j, alpha, share))
        return rows

    def _path(self) -> ContactPath:
        """Return the path of contact without errors. Raises DesignError for line contact."""
        path = contact_path(solver_pair(self.pair), self.pair.pitch * np.linspace(-1.0, 1.0, PATH_POSITIONS))
        if (path.kind == "line").any():
            default = not self.design.sets("hob.reference_diameter")
            raise DesignError(
                "hob.reference_diameter",
                self.own.hob.reference_diameter,
                unit="mm",
                shown=f"{self.own.hob.reference_diameter:.6g} mm (the default, the worm's)" if default else None,
                reason="the wheel touches the worm along lines over all of its face, there is no pattern to be placed",
                allowed=Allowed.more_than(self.own.reference_diameter, "mm"),
            )
        if not (path.kind == "point").any():
            raise NoSolutionError("contact.flank", reason="without errors no flanks touch but on edges")
        return path

    def _leaving(self, path: ContactPath) -> float:
        """Return a number > 0 if the driving worm's threads leave the mesh at the wheel's heel."""
        pair, k = self.pair, int(np.flatnonzero(path.kind == "point")[0])
        velocity = pair.drive * pair.pinion.mount.velocity(path.point[k])
        return float(dot(velocity, pair.gear.mount.axis))

    def _crossing(self, path: ContactPath) -> tuple[float, Array]:
        """Return share of the face and unknowns (4 + K,) near the path's crossing of the middle of the depth."""
        pair, blank = self.pair, self.pair.gear.one_tooth.blank
        k = np.flatnonzero(path.kind == "point")
        r = pair.gear.one_tooth.side(pair.flanks[1]).flank.jet(path.params2[k, 0], path.params2[k, 1]).r
        depth = HalfwayLevel(blank.root, blank.tip).value(r) - 0.5 * self._clearance
        nearest = int(np.abs(depth).argmin())
        (toe, heel), m = blank.extent, k[nearest]
        worm_mount, wheel_mount = pair.mounts
        turns = [
            mount.sign * (turn - mount.zero)
            for mount, turn in ((worm_mount, path.rotation[m]), (wheel_mount, path.phi2[m]))
        ]
        share = (blank.axial.value(r[nearest]) - toe) / (heel - toe)
        return float(share), np.array([*path.params1[m], *turns, *(0.0 for _ in self.moved)])

    def _swept(self, path: ContactPath) -> tuple[Array, Array]:
        """Return shares (N,) over the range of PLACE_SHARES and the unknowns (N, 4 + K).

        The unknowns of each share start from its neighbour's.
        """
        begin, start = self._crossing(path)
        shares: list[float] = []
        unknowns_at: list[Array] = []
        inner = np.clip(begin, PLACE_SHARES[0], PLACE_SHARES[-1])
        for end in (PLACE_SHARES[0], PLACE_SHARES[-1]):
            steps = int(np.ceil(abs(end - inner) / MAX_SHARE_STEP)) + 1
            places = distinct(
                np.append(
                    np.linspace(inner, end, steps), [s for s in PLACE_SHARES if min(inner, end) <= s <= max(inner, end)]
                )
            )
            unknowns = start
            for share in places if end > inner else places[::-1]:
                solved = self._solve(float(share), unknowns)
                unknowns = solved if np.isfinite(solved).all() else unknowns
                shares.append(float(share))
                unknowns_at.append(solved)
        return np.array(shares), np.array(unknowns_at)

    def _solve(self, share: float, start: Array) -> Array:
        """Return the unknowns (4 + K,) of a contact at a share of the face; NaN if there is none."""
        mating = gear_targets(self.pair.gear, self.pair.flanks[1], self._clearance, np.array([share]))
        jet = self.pair.gear.tooth.side(self.pair.flanks[1]).flank.jet(mating[:, 0], mating[:, 1])
        conditions = MeshingPlace(self.pair, jet, self.moved, self._moves, self._bases)
        with np.errstate(all="ignore"):
            solution = newton.solve(
                conditions, start[None], tolerance=CONTACT_TOLERANCE_MM, max_iterations=MAX_NEWTON_STEPS
            )
        lost = ~solution.converged | np.isnan(mating).any(axis=-1)
        unknowns: Array = np.where(lost[:, None], np.nan, solution.values)[0]
        return unknowns

    def _holds(self, x: Array) -> NDArray[np.bool_]:
        """Return True (N,) where the displaced teeth first touch at the point of the unknowns x (N, 4 + K)."""
        touches_first: NDArray[np.bool_] = np.asarray(np.isfinite(x).all(axis=-1))
        if not touches_first.any():
            return touches_first
        x, mount = x[touches_first], self.pair.pinion.mount
        turned = mount.zero + mount.sign * x[:, 2]
        bases = self._bases(self._moves.values(x, self.moved))
        paths = assembly_paths(solver_pair(self.pair), bases, turned[:, None])
        r = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1]).r
        with np.errstate(invalid="ignore"):
            touches_first[touches_first] = paths.surface[:, 0] & (
                np.linalg.norm(paths.point[:, 0] - r, axis=-1) <= MAX_FIRST_TOUCH_DISTANCE_MM
            )
        return touches_first
