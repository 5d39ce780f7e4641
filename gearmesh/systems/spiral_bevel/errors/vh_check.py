"""V-H check: displacements that bring the centre of contact to the toe, the middle and the heel of the gear.

The centre of contact is the point at which the gears turn at the ratio of their teeth, the vertex of the transmission
error. Its six conditions (`common.pattern.meshing_place`) have six unknowns, solved by Newton with exact derivatives.
Two of four displacements are unknowns; the others keep the values of the design:

- V of the pinion across both axes (assembly.dV)
- H of the pinion along its axis (dA)
- J of the gear along its axis (dG)
- alpha of the shaft angle (d_delta)

These conditions are local. The first touch of the displaced teeth, over both whole flanks, decides whether the contact
exists: it must be at this point. If the gear runs ahead at the change of teeth, as in [AB], neighbouring teeth touch
before it.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property, partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.assemblies import assembly_paths
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, polar_angle
from gearmesh.kernel.surface.levels import perpendicular
from gearmesh.kernel.surface.surface import Jet
from gearmesh.progress import in_turn, tell
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.displacements import displaced_bases
from gearmesh.systems.common.pattern.meshing_place import MeshingPlace, Moves
from gearmesh.systems.common.pattern.targets import gear_targets, on_flank
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES
from gearmesh.systems.spiral_bevel.synthesis.settings import meshing_turns
from gearmesh.systems.system import PatternShift
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import HandedDesign

#: shares of the face, from toe to heel, by name of the place
PLACE_SHARES = {"toe": 0.25, "middle": 0.5, "heel": 0.75}
#: displacements and their keys in the table assembly
ASSEMBLY_MOVES = Moves({"V": "dV", "H": "dA", "J": "dG", "alpha": "d_delta"})
#: residual (mm) at which a contact is solved
CONTACT_TOLERANCE_MM = 1e-10
#: largest number of Newton steps
MAX_NEWTON_STEPS = 60
#: steps of a hundredth of the face from the middle to toe and to heel, in which possible places are sought
SWEEP_STEPS = 25
#: largest distance (mm) of the first touch from the requested contact
MAX_FIRST_TOUCH_DISTANCE_MM = 1e-6


def vh_check(
    design: HandedDesign, train: GearTrain, clearance: float, moved: tuple[str, ...] = ("V", "H")
) -> list[PatternShift]:
    """Return the displacements of both sides of the pinion for all places in PLACE_SHARES.

    - `design`: the design in mm
    - `train`: its gear set
    - `clearance`: clearance between tips and roots, mm
    - `moved`: two displacements of ASSEMBLY_MOVES that are determined

    All four displacements are values of the table assembly. If the contact cannot be brought to a place, the row has
    the nearest possible place. Raises NoSolutionError if no place between toe and heel is possible.
    """
    (pair,) = train.pairs
    now = np.array([getattr(design.assembly, key) for key in ASSEMBLY_MOVES.keys.values()])
    pattern_shifts = []
    for name in in_turn(BLADE_SIDES):
        shares, extra = _Side.of(pair, name, HAND_SIGNS[design.hand], clearance, moved).places()
        for (place, asked), share, shift in zip(PLACE_SHARES.items(), shares, now + extra, strict=True):
            pinion_offset, pinion_axial, gear_axial, alpha = (float(x) for x in shift)
            pattern_shifts.append(
                PatternShift(
                    f"pinion_{name}", place, asked, pinion_offset, pinion_axial, gear_axial, alpha, float(share)
                )
            )
    return pattern_shifts


@dataclass(frozen=True)
class _Side:
    """One side of the pinion."""

    #: the pair that contacts on this side
    pair: GearPair
    #: "concave" or "convex"
    name: str
    #: clearance between tips and roots, mm
    clearance: float
    #: the two displacements that are determined
    moved: tuple[str, ...]

    @classmethod
    def of(cls, pair: GearPair, name: str, hand: int, clearance: float, moved: tuple[str, ...]) -> _Side:
        """Return the side `name` of a gear set's pair, on whichever side the pair contacts.

        Eccentricities are neglected.
        """
        flanks = _flank(name == "concave", hand), _flank(MATING_SIDES[name] == "concave", -hand)
        members = [replace(member, mount=replace(member.mount, eccentricity=(0.0, 0.0))) for member in pair.both]
        pair_on_side = replace(pair, pinion=members[0], gear=members[1], flanks=flanks, drive=BLADE_SIDES[name])
        return cls(pair_on_side, name, clearance, moved)

    def places(self) -> tuple[Array, Array]:
        """Return the possible shares (3,) of the face nearest to PLACE_SHARES, and their displacements (3, 4).

        Raises NoSolutionError if no place is possible.
        """
        asked = np.array(list(PLACE_SHARES.values()))
        shares, unknowns = asked, self._solve(asked, None)
        tell(0.2)
        possible = self._holds(unknowns)
        if not possible.all():
            # where a place is impossible, places between toe and heel are swept as substitutes
            swept = self._swept()
            shares, unknowns = np.append(asked, swept[0]), np.concatenate((unknowns, swept[1]))
            possible = np.append(possible, self._holds(swept[1]))
        if not possible.any():
            raise NoSolutionError(
                f"pinion.{self.name}",
                reason=f"no values of {' and '.join(self.moved)} bring the contact to any place from {asked[0]:g} to "
                f"{asked[-1]:g} of "
                "the face: check its settings",
            )
        shares, unknowns = shares[possible], unknowns[possible]
        # the nearest possible place to each requested one
        nearest = np.abs(shares - asked[:, None]).argmin(axis=-1)
        values = ASSEMBLY_MOVES.values(unknowns, self.moved)
        return shares[nearest], np.stack([values[key] for key in ASSEMBLY_MOVES.keys.values()], axis=-1)[nearest]

    def _swept(self) -> tuple[Array, Array]:
        """Return shares (N,) over the whole range of PLACE_SHARES and the unknowns (N, 6).

        The unknowns of a share start from those of its neighbour, from the middle to both ends.
        """
        shares, x = [], []
        for end in (PLACE_SHARES["toe"], PLACE_SHARES["heel"]):
            start: Array | None = None
            for share in np.round(np.linspace(PLACE_SHARES["middle"], end, SWEEP_STEPS + 1), 6):
                unknowns = self._solve(np.array([share]), start)
                start = unknowns if np.isfinite(unknowns).all() else start
                shares.append(share)
                x.append(unknowns[0])
        return np.array(shares), np.array(x)

    def _solve(self, shares: Array, start: Array | None) -> Array:
        """Return the unknowns (N, 6) of contacts at `shares` (N,) of the face; NaN where there is no contact."""
        mating = gear_targets(self.pair.gear, self.pair.flanks[1], self.clearance, shares)
        jet = self.pair.gear.tooth.side(self.pair.flanks[1]).flank.jet(mating[:, 0], mating[:, 1])
        conditions = MeshingPlace(
            self.pair, jet, self.moved, ASSEMBLY_MOVES, partial(displaced_bases, self.pair.mounts)
        )
        begin = _start(self.pair, jet) if start is None else start
        with np.errstate(all="ignore"):
            solution = newton.solve(conditions, begin, tolerance=CONTACT_TOLERANCE_MM, max_iterations=MAX_NEWTON_STEPS)
        lost = ~solution.converged | np.isnan(mating).any(axis=-1)
        return np.where(lost[:, None], np.nan, solution.values)

    @cached_property
    def _solver(self) -> Pair:
        return solver_pair(self.pair)

    def _holds(self, x: Array) -> NDArray[np.bool_]:
        """Return True (N,) where the displaced teeth first touch at the point of the unknowns x (N, 6)."""
        touches_first: NDArray[np.bool_] = np.asarray(np.isfinite(x).all(axis=-1))
        if not touches_first.any():
            return touches_first
        x, mount = x[touches_first], self.pair.pinion.mount
        # the first touch of all teeth at the rotation of the vertex
        vertex = mount.zero + mount.sign * x[:, 2]
        vertex = (vertex + np.pi) % (2.0 * np.pi) - np.pi
        bases = displaced_bases(self.pair.mounts, ASSEMBLY_MOVES.values(x, self.moved))
        paths = assembly_paths(self._solver, bases, vertex[:, None])
        # it must be the vertex's point
        r = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1]).r
        with np.errstate(invalid="ignore"):
            touches_first[touches_first] = paths.surface[:, 0] & (
                np.linalg.norm(paths.point[:, 0] - r, axis=-1) <= MAX_FIRST_TOUCH_DISTANCE_MM
            )
        return touches_first


def _flank(concave: bool, hand: int) -> Side:
    """Return the flank of a side: the concave side of a right-hand member is its left flank."""
    return Side.LEFT if concave == (hand > 0) else Side.RIGHT


def _start(pair: GearPair, mating: Jet) -> Array:
    """Return start values (N, 6) for the gear's points.

    They are the turns at which undisplaced points are in contact, and the pinion's points.

    The pinion's points have the same station and height as the gear's points.
    """
    pinion_base, gear_base = (mount.base for mount in pair.mounts)
    sense = int(pair.pinion.mount.sign)
    turns = meshing_turns(mating, pinion_base.inverse @ gear_base, sense, pair.ratio)
    r = (pinion_base.inverse @ gear_base @ Rigid.about_z(turns)).point(mating.r)
    tooth, side = pair.pinion.tooth, pair.flanks[0]
    levels = tooth.blank.axial, perpendicular(tooth.blank.axial)
    wanted = np.stack([level.value(r) for level in levels], axis=-1)
    toe, heel = tooth.blank.extent
    t = np.clip((wanted[:, 0] - toe) / (heel - toe), 0.0, 1.0)
    start = tooth.flank_grid(side, [0.5], t).parameters[0]
    x, jet = on_flank(tooth.side(side).flank, start, levels, wanted)
    turned = polar_angle(r) - polar_angle(jet.r)
    zero = np.zeros_like(turned)
    return np.stack((x[:, 0], x[:, 1], turned, turns, zero, zero), axis=-1)
