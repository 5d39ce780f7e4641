"""The V-H check: how far members are moved so that the centre of contact goes to the toe, the middle and the heel of the gear.

The centre of contact is where the gears turn at the ratio of their teeth, the vertex of the transmission error: six unknowns of six
conditions (`common.pattern.meshing_place`), solved by Newton with exact derivatives. The displacements are two of V of the pinion
across both axes (assembly.dV), H along its own (dA), J of the gear along its axis (dG) and alpha of the shaft angle (d_delta); the
others stay what the design says.

These are conditions in the small. Whether the contact is there is decided by the first touch of the displaced teeth, over the whole
of both: it must be that point. Pairs whose gear runs ahead at the change of teeth, as in [AB], have neighbouring teeth ahead of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
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
from gearmesh.systems.common.pattern.meshing_place import MeshingPlace, Moves
from gearmesh.systems.common.pattern.targets import gear_targets, on_flank
from gearmesh.systems.spiral_bevel.errors.displacements import displaced_bases
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES
from gearmesh.systems.spiral_bevel.synthesis.settings import meshing_turns
from gearmesh.systems.system import PatternShift
from gearmesh.teeth.gear_train import GearPair, GearTrain
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import BevelDesign

#: places along the face from toe to heel
PLACES = {"toe": 0.25, "middle": 0.5, "heel": 0.75}
#: displacements, and their keys of the table assembly
MOVES = Moves({"V": "dV", "H": "dA", "J": "dG", "alpha": "d_delta"})
#: residual (mm) of a contact, and Newton steps at most
TOLERANCE, ITERATIONS = 1e-10, 60
#: from the middle to toe and to heel: steps of a hundredth of the face, in which another place is looked for
STEPS = 25
#: distance (mm) of the first touch from the contact asked for that counts as none
THERE = 1e-6


def vh_check(
    design: BevelDesign, train: GearTrain, clearance: float, moved: tuple[str, ...] = ("V", "H")
) -> list[PatternShift]:
    """Displacements `moved`, two of MOVES, for both sides of the pinion and all PLACES, of a design in mm; `clearance`: between its
    tips and roots, mm.

    All four displacements are values of the table assembly. A place that the contact cannot be brought to has those of the nearest
    one that it can be brought to. Raises NoSolutionError where there is none between toe and heel.
    """
    (pair,) = train.pairs
    now = np.array([getattr(design.assembly, key) for key in MOVES.keys.values()])
    pattern_shifts = []
    for name in in_turn(BLADE_SIDES):
        shares, extra = _Side.of(pair, name, HAND_SIGNS[design.hand], clearance, moved).places()
        for (place, asked), share, shift in zip(PLACES.items(), shares, now + extra, strict=True):
            v, h, j, alpha = (float(x) for x in shift)
            pattern_shifts.append(PatternShift(f"pinion_{name}", place, asked, v, h, j, alpha, float(share)))
    return pattern_shifts


@dataclass(frozen=True)
class _Side:
    """One side of the pinion, `name`, and the `pair` that contacts on it; displacements `moved` are looked for."""

    pair: GearPair
    name: str
    clearance: float
    moved: tuple[str, ...]

    @classmethod
    def of(cls, pair: GearPair, name: str, hand: int, clearance: float, moved: tuple[str, ...]) -> _Side:
        """Of a gear set's pair, whichever of its sides that is of. Eccentricities are neglected."""
        flanks = _flank(name == "concave", hand), _flank(MATING_SIDES[name] == "concave", -hand)
        members = [replace(member, mount=replace(member.mount, eccentricity=(0.0, 0.0))) for member in pair.both]
        own = replace(pair, pinion=members[0], gear=members[1], flanks=flanks, drive=BLADE_SIDES[name])
        return cls(own, name, clearance, moved)

    def places(self) -> tuple[Array, Array]:
        """Shares (3,) of the face nearest PLACES at which the contact can be, and the displacements (3, 4) that bring it there.

        Raises NoSolutionError where there are none.
        """
        asked = np.array(list(PLACES.values()))
        shares, x = asked, self._solve(asked, None)
        tell(0.2)
        good = self._holds(x)
        if not good.all():
            swept = self._swept()
            shares, x = np.append(asked, swept[0]), np.concatenate((x, swept[1]))
            good = np.append(good, self._holds(swept[1]))
        if not good.any():
            raise NoSolutionError(
                f"pinion.{self.name}",
                reason=f"no values of {' and '.join(self.moved)} bring the contact to any place from {asked[0]:g} to "
                f"{asked[-1]:g} of "
                "the face: check its settings",
            )
        shares, x = shares[good], x[good]
        nearest = np.abs(shares - asked[:, None]).argmin(axis=-1)
        values = MOVES.values(x, self.moved)
        return shares[nearest], np.stack([values[key] for key in MOVES.keys.values()], axis=-1)[nearest]

    def _swept(self) -> tuple[Array, Array]:
        """Shares (N,) over all PLACES and the unknowns (N, 6), each found from its neighbour's, from the middle to both ends."""
        shares, x = [], []
        for end in (PLACES["toe"], PLACES["heel"]):
            start: Array | None = None
            for share in np.round(np.linspace(PLACES["middle"], end, STEPS + 1), 6):
                unknowns = self._solve(np.array([share]), start)
                start = unknowns if np.isfinite(unknowns).all() else start
                shares.append(share)
                x.append(unknowns[0])
        return np.array(shares), np.array(x)

    def _solve(self, shares: Array, start: Array | None) -> Array:
        """Unknowns (N, 6) of contacts at `shares` (N,) of the face; NaN where there are none."""
        mating = gear_targets(self.pair.gear, self.pair.flanks[1], self.clearance, shares)
        jet = self.pair.gear.tooth.side(self.pair.flanks[1]).flank.jet(mating[:, 0], mating[:, 1])
        conditions = MeshingPlace(self.pair, jet, self.moved, MOVES, partial(displaced_bases, self.pair.mounts))
        begin = _start(self.pair, jet) if start is None else start
        with np.errstate(all="ignore"):
            solution = newton.solve(conditions, begin, tolerance=TOLERANCE, max_iterations=ITERATIONS)
        lost = ~solution.converged | np.isnan(mating).any(axis=-1)
        return np.where(lost[:, None], np.nan, solution.values)

    @cached_property
    def _solver(self) -> Pair:
        return solver_pair(self.pair)

    def _holds(self, x: Array) -> NDArray[np.bool_]:
        """Whether (N,) the displaced teeth touch first where the unknowns x (N, 6) have it."""
        good: NDArray[np.bool_] = np.asarray(np.isfinite(x).all(axis=-1))
        if not good.any():
            return good
        x, mount = x[good], self.pair.pinion.mount
        vertex = mount.zero + mount.sign * x[:, 2]
        vertex = (vertex + np.pi) % (2.0 * np.pi) - np.pi
        bases = displaced_bases(self.pair.mounts, MOVES.values(x, self.moved))
        paths = assembly_paths(self._solver, bases, vertex[:, None])
        r = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1]).r
        with np.errstate(invalid="ignore"):
            good[good] = paths.surface[:, 0] & (np.linalg.norm(paths.point[:, 0] - r, axis=-1) <= THERE)
        return good


def _flank(concave: bool, hand: int) -> Side:
    """The concave side of a right-hand member is its left."""
    return Side.LEFT if concave == (hand > 0) else Side.RIGHT


def _start(pair: GearPair, mating: Jet) -> Array:
    """Turns at which the gear's points are in contact if nothing is displaced, and points of the pinion as far out."""
    first, second = (mount.base for mount in pair.mounts)
    sense = int(pair.pinion.mount.sign)
    turns = meshing_turns(mating, first.inverse @ second, sense, pair.ratio)
    r = (first.inverse @ second @ Rigid.about_z(turns)).point(mating.r)
    tooth, which = pair.pinion.tooth, pair.flanks[0]
    levels = tooth.blank.axial, perpendicular(tooth.blank.axial)
    wanted = np.stack([level.value(r) for level in levels], axis=-1)
    toe, heel = tooth.blank.extent
    t = np.clip((wanted[:, 0] - toe) / (heel - toe), 0.0, 1.0)
    start = tooth.flank_grid(which, [0.5], t).parameters[0]
    x, jet = on_flank(tooth.side(which).flank, start, levels, wanted)
    turned = polar_angle(r) - polar_angle(jet.r)
    zero = np.zeros_like(turned)
    return np.stack((x[:, 0], x[:, 1], turned, turns, zero, zero), axis=-1)
