"""The V-H check: how far members are moved so that the centre of contact goes to the toe, the middle and the heel of the gear.

The centre of contact is where the gears turn at the ratio of their teeth, the vertex of the transmission error. For a point of the
gear's flank there are a rotation of either gear, a point of the pinion's flank and two displacements at which the flanks touch
there and n . v12 = 0: six unknowns of six conditions

    r1 = r2 (3),    n1 + n2 = 0 in the tangent plane (2),    n2 . (w1 x (r - o1) - w2 x (r - o2)) = 0

solved by Newton with exact derivatives. The displacements are two of V of the pinion across both axes (assembly.dV), H along its
own (dA), J of the gear along its axis (dG) and alpha of the shaft angle (d_delta); the others stay what the design says.

These are conditions in the small. Whether the contact is there is decided by the first touch of the displaced teeth, over the whole
of both: it must be that point. Pairs whose gear runs ahead at the change of teeth, as in [AB], have neighbouring teeth ahead of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.assemblies import assembly_paths
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, polar_angle, unit
from gearmesh.kernel.surface.levels import Level, perpendicular
from gearmesh.kernel.surface.surface import Jet
from gearmesh.systems.spiral_bevel.errors.displacements import displaced_bases
from gearmesh.systems.spiral_bevel.machine.pair import HANDS, MATING, SIDES
from gearmesh.systems.spiral_bevel.sheet.tooth_measures import on_flank
from gearmesh.systems.spiral_bevel.synthesis.settings import meshing_turns
from gearmesh.systems.system import PatternShift
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import BevelDesign

#: places along the face from toe to heel
PLACES = {"toe": 0.25, "middle": 0.5, "heel": 0.75}
#: displacements, and their keys of the table assembly
MOVES = {"V": "dV", "H": "dA", "J": "dG", "alpha": "d_delta"}
#: residual (mm) of a contact, and Newton steps at most
TOLERANCE, ITERATIONS = 1e-10, 60
#: from the middle to toe and to heel: steps of a hundredth of the face, in which another place is looked for
STEPS = 25
#: distance (mm) of the first touch from the contact asked for that counts as none
THERE = 1e-6


@dataclass(frozen=True)
class HalfwayLevel:
    """g: the mean of two levels, 0 half way between them."""

    first: Level
    second: Level

    def value(self, r: Array) -> Array:
        return 0.5 * (self.first.value(r) + self.second.value(r))

    def gradient(self, r: Array) -> Array:
        return 0.5 * (self.first.gradient(r) + self.second.gradient(r))

    def hessian(self, r: Array, w: Array) -> Array:
        return 0.5 * (self.first.hessian(r, w) + self.second.hessian(r, w))


def vh_check(
    design: BevelDesign, train: GearTrain, clearance: float, moved: tuple[str, str] = ("V", "H")
) -> list[PatternShift]:
    """Displacements `moved`, two of MOVES, for both sides of the pinion and all PLACES, of a design in mm; `clearance`: between its
    tips and roots, mm.

    All four displacements are values of the table assembly. A place that the contact cannot be brought to has those of the nearest
    one that it can be brought to. Raises NoSolutionError where there is none between toe and heel.
    """
    (pair,) = train.pairs
    now = np.array([getattr(design.assembly, key) for key in MOVES.values()])
    pattern_shifts = []
    for name in SIDES:
        shares, extra = _Side.of(pair, name, HANDS[design.hand], clearance, moved).places()
        for (place, asked), share, shift in zip(PLACES.items(), shares, now + extra, strict=True):
            v, h, j, alpha = (float(x) for x in shift)
            pattern_shifts.append(PatternShift(name, place, asked, v, h, j, alpha, float(share)))
    return pattern_shifts


def gear_targets(gear: Member, which: Side, clearance: float, shares: Array) -> Array:
    """Parameters (N, 2) of the gear's flank at `shares` (N,) of the face from the toe, in the middle of the working depth: between
    its tip and the mating gear's."""
    tooth = gear.tooth
    toe, heel = tooth.blank.extent
    start = tooth.flank_grid(which, [0.5], shares).parameters[0]
    middle = HalfwayLevel(tooth.blank.root, tooth.blank.tip)
    wanted = np.stack((toe + shares * (heel - toe), np.full_like(shares, 0.5 * clearance)), axis=-1)
    parameters, _ = on_flank(tooth.side(which).flank, start, (tooth.blank.axial, middle), wanted)
    return parameters


@dataclass(frozen=True)
class _Side:
    """One side of the pinion, `name`, and the `pair` that contacts on it; displacements `moved` are looked for."""

    pair: GearPair
    name: str
    clearance: float
    moved: tuple[str, str]

    @classmethod
    def of(cls, pair: GearPair, name: str, hand: int, clearance: float, moved: tuple[str, str]) -> _Side:
        """Of a gear set's pair, whichever of its sides that is of. Eccentricities are neglected."""
        flanks = _flank(name == "concave", hand), _flank(MATING[name] == "concave", -hand)
        members = [replace(member, mount=replace(member.mount, eccentricity=(0.0, 0.0))) for member in pair.both]
        own = replace(pair, pinion=members[0], gear=members[1], flanks=flanks, drive=SIDES[name])
        return cls(own, name, clearance, moved)

    def places(self) -> tuple[Array, Array]:
        """Shares (3,) of the face nearest PLACES at which the contact can be, and the displacements (3, 4) that bring it there.

        Raises NoSolutionError where there are none.
        """
        asked = np.array(list(PLACES.values()))
        shares, x = asked, self._solve(asked, None)
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
        values = displacements(x, self.moved)
        return shares[nearest], np.stack([values[key] for key in MOVES.values()], axis=-1)[nearest]

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
        conditions = _Conditions(self.pair, jet, self.moved)
        begin = conditions.start() if start is None else start
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
        bases = displaced_bases(self.pair.mounts, displacements(x, self.moved))
        paths = assembly_paths(self._solver, bases, vertex[:, None])
        r = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1]).r
        with np.errstate(invalid="ignore"):
            good[good] = paths.surface[:, 0] & (np.linalg.norm(paths.point[:, 0] - r, axis=-1) <= THERE)
        return good


def displacements(x: Array, moved: tuple[str, str]) -> dict[str, Array]:
    """The displacements (N,) of unknowns x (N, 6) by their keys of the table assembly: mm, deg."""
    values = {key: np.zeros(len(x)) for key in MOVES.values()}
    for k, name in enumerate(moved):
        values[MOVES[name]] = np.degrees(x[:, 4 + k]) if name == "alpha" else x[:, 4 + k]
    return values


def _flank(concave: bool, hand: int) -> Side:
    """The concave side of a right-hand member is its left."""
    return Side.LEFT if concave == (hand > 0) else Side.RIGHT


@dataclass(frozen=True)
class _Conditions:
    """Residuals, mm, of unknowns x = (u1, v1, turn 1, turn 2, and the displacements `moved`: mm, rad); `mating` (N,): the gear's
    jets, its own frame.

    Both members turn about their axes, from their unturned positions.
    """

    pair: GearPair
    mating: Jet
    moved: tuple[str, str]

    @property
    def _length(self) -> float:
        """Scale of the conditions on directions: the farthest point's distance from the apex."""
        return float(np.linalg.norm(self.mating.r, axis=-1).max())

    def start(self) -> Array:
        """Turns at which the gear's points are in contact if nothing is displaced, and points of the pinion as far out."""
        first, second = (mount.base for mount in self.pair.mounts)
        sense = int(self.pair.pinion.mount.sign)
        turns = meshing_turns(self.mating, first.inverse @ second, sense, self.pair.ratio)
        r = (first.inverse @ second @ Rigid.about_z(turns)).point(self.mating.r)
        tooth, which = self.pair.pinion.tooth, self.pair.flanks[0]
        levels = tooth.blank.axial, perpendicular(tooth.blank.axial)
        wanted = np.stack([level.value(r) for level in levels], axis=-1)
        toe, heel = tooth.blank.extent
        t = np.clip((wanted[:, 0] - toe) / (heel - toe), 0.0, 1.0)
        start = tooth.flank_grid(which, [0.5], t).parameters[0]
        x, jet = on_flank(tooth.side(which).flank, start, levels, wanted)
        turned = polar_angle(r) - polar_angle(jet.r)
        zero = np.zeros_like(turned)
        return np.stack((x[:, 0], x[:, 1], turned, turns, zero, zero), axis=-1)

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        first, second = displaced_bases(self.pair.mounts, displacements(x, self.moved))
        axis1, axis2 = first.rotation[..., 2], second.rotation[..., 2]
        own = self.pair.pinion.tooth.side(self.pair.flanks[0]).flank.jet(x[:, 0], x[:, 1])
        own = own.move(first @ Rigid.about_z(x[:, 2]))
        mating = Jet(*(getattr(self.mating, key)[index] for key in ("r", "n", "r_u", "r_v", "n_u", "n_v")))
        mating = mating.move(second @ Rigid.about_z(x[:, 3]))
        # the common perpendicular of both axes, about which the shaft angle opens
        across, still = unit(cross(axis1, axis2)), np.zeros_like(axis1)
        arm1, arm2 = own.r - first.translation, mating.r - second.translation
        by_turn1, by_turn2 = cross(axis1, arm1), cross(axis2, arm2)
        # how each displacement moves the pinion, the gear, and the gear's normals
        ways = {
            "V": (across, still, still),
            "H": (axis1, still, still),
            "J": (still, axis2, still),
            "alpha": (still, cross(across, mating.r), cross(across, mating.n)),
        }
        moves = [ways[name] for name in self.moved]
        f, jacobian = np.zeros((len(x), 6)), np.zeros((len(x), 6, 6))
        f[:, :3] = own.r - mating.r
        columns = (own.r_u, own.r_v, by_turn1, -by_turn2, *(pinion - gear for pinion, gear, _ in moves))
        jacobian[:, :3] = np.stack(columns, axis=-1)
        # in two directions of the pinion's tangent plane, held fixed
        e1 = unit(own.r_u)
        for row, direction in ((3, e1), (4, cross(own.n, e1))):
            f[:, row] = self._length * dot(own.n + mating.n, direction)
            columns = (own.n_u, own.n_v, cross(axis1, own.n), cross(axis2, mating.n), *(turned for *_, turned in moves))
            jacobian[:, row] = self._length * np.stack([dot(column, direction) for column in columns], axis=-1)
        # the pinion turns by its sign, the gear by its own, at the ratio of the teeth
        w1, w2 = (mount.sign * axis for mount, axis in zip(self.pair.mounts, (axis1, axis2), strict=True))
        w2 = self.pair.ratio * w2
        sliding = cross(w1, mating.r - first.translation) - cross(w2, arm2)
        f[:, 5] = dot(mating.n, sliding)
        jacobian[:, 5, 3] = dot(cross(axis2, mating.n), sliding) + dot(
            mating.n, cross(w1, by_turn2) - cross(w2, by_turn2)
        )
        for k, (pinion, gear, turned) in enumerate(moves):
            # what moves the gear moves its axis as well: only what the pinion's rotation does changes
            carried = cross(w1, mating.r - first.translation)
            jacobian[:, 5, 4 + k] = dot(mating.n, cross(w1, gear - pinion)) + dot(turned, carried)
        return f, jacobian
