"""The V-H check: how far the pinion is moved so that the centre of contact goes to the toe, the middle and the heel of the gear.

The centre of contact is where the gears turn at the ratio of their teeth, the vertex of the transmission error. For a point of the
gear's flank there are a rotation of either gear, a point of the pinion's flank and displacements V, across both axes, and
H, along the pinion's axis, at which the flanks touch there and n . v12 = 0: six unknowns of six conditions

    r1 = r2 (3),    n1 + n2 = 0 in the tangent plane (2),    n2 . (w1 x (r - o1) - w2 x (r - o2)) = 0

solved by Newton with exact derivatives. V and H only translate, so that o1 alone moves. The gear's own displacement J and the
shaft angle alpha stay what the design says (assembly.dG, d_delta).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, cross, dot, polar_angle, unit
from gearmesh.kernel.levels import CurveLevel, Level
from gearmesh.kernel.rigid import Rigid
from gearmesh.kernel.surface import Jet
from gearmesh.systems.spiral_bevel.pair import HANDS, MATES, SIDES
from gearmesh.systems.spiral_bevel.settings import meshing_turns
from gearmesh.systems.spiral_bevel.teeth_choice import bevel_teeth
from gearmesh.systems.spiral_bevel.tooth_measures import on_flank
from gearmesh.systems.system import PatternShift
from gearmesh.teeth.region import Side
from gearmesh.teeth.train import GearPair, Member, Train

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: places along the face from toe to heel
PLACES = {"toe": 0.25, "middle": 0.5, "heel": 0.75}
#: residual (mm) of a contact, and Newton steps at most
TOLERANCE, ITERATIONS = 1e-10, 60


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


def vh_check(design: FaceMilledDesign, train: Train) -> list[PatternShift]:
    """Displacements of the pinion, in mm, for both of its sides and all PLACES, of a design in mm.

    V and H are values of assembly.dV and assembly.dA. Raises NoSolutionError where the contact cannot be brought there.
    """
    (pair,) = train.pairs
    blank = bevel_teeth(design).cut.blank
    found = []
    for name in SIDES:
        v, h = _displacements(pair, name, HANDS[design.hand], blank.clearance)
        for k, place in enumerate(PLACES):
            shift = design.assembly.dV + float(v[k]), design.assembly.dA + float(h[k])
            found.append(PatternShift(name, place, *shift, design.assembly.dG, design.assembly.d_delta))
    return found


def gear_targets(gear: Member, which: Side, clearance: float) -> Array:
    """Parameters (3, 2) of the gear's flank at PLACES, in the middle of the working depth: between its tip and the mate's."""
    tooth = gear.tooth
    toe, heel = tooth.blank.extent
    t = np.array(list(PLACES.values()))
    start = tooth.flank_grid(which, [0.5], t).parameters[0]
    middle = HalfwayLevel(tooth.blank.root, tooth.blank.tip)
    wanted = np.stack((toe + t * (heel - toe), np.full_like(t, 0.5 * clearance)), axis=-1)
    found, _ = on_flank(tooth.side(which).flank, start, (tooth.blank.axial, middle), wanted)
    return found


def _displacements(pair: GearPair, name: str, hand: int, clearance: float) -> tuple[Array, Array]:
    """V and H (3,), mm, beside what the pair has, of the pinion's side `name`."""
    which = {member: _flank(side == "concave", sense) for member, side, sense in
             (("pinion", name, hand), ("gear", MATES[name], -hand))}  # fmt: skip
    mate = gear_targets(pair.gear, which["gear"], clearance)
    jet = pair.gear.tooth.side(which["gear"]).flank.jet(mate[:, 0], mate[:, 1])
    conditions = _Conditions(pair, which["pinion"], jet)
    found = newton.solve(conditions, conditions.start(), tolerance=TOLERANCE, max_iterations=ITERATIONS)
    if not (np.isfinite(mate).all() and found.converged.all()):
        places = [place for place, good in zip(PLACES, found.converged, strict=True) if not good]
        raise NoSolutionError(
            f"pinion.{name}: no V and H bring the contact to the {' and '.join(places) or 'face'}: check its settings"
        )
    return found.values[:, 4], found.values[:, 5]


def _flank(concave: bool, hand: int) -> Side:
    """The concave side of a right-hand member is its left."""
    return Side.LEFT if concave == (hand > 0) else Side.RIGHT


@dataclass(frozen=True)
class _Conditions:
    """Residuals, mm, of unknowns x = (u1, v1, turn 1, turn 2, V, H); `mate` (N,): the gear's jets, its own frame.

    Both members turn about their axes, from as they stand unturned.
    """

    pair: GearPair
    which: Side
    mate: Jet

    @property
    def _bases(self) -> tuple[Rigid, Rigid]:
        return self.pair.pinion.mount.base, self.pair.gear.mount.base

    @property
    def _length(self) -> float:
        """Scale of the conditions on directions: the farthest point's distance from the apex."""
        return float(np.linalg.norm(self.mate.r, axis=-1).max())

    def start(self) -> Array:
        """Turns at which the gear's points are in contact if the pinion stays where it is, and points of the pinion as far out."""
        first, second = self._bases
        sense = int(self.pair.pinion.mount.sign)
        turns = meshing_turns(self.mate, first.inverse @ second, sense, self.pair.ratio)
        r = (first.inverse @ second @ Rigid.about_z(turns)).point(self.mate.r)
        tooth = self.pair.pinion.tooth
        levels = tooth.blank.axial, CurveLevel.across_stations(tooth.blank.axial)
        wanted = np.stack([level.value(r) for level in levels], axis=-1)
        toe, heel = tooth.blank.extent
        t = np.clip((wanted[:, 0] - toe) / (heel - toe), 0.0, 1.0)
        start = tooth.flank_grid(self.which, [0.5], t).parameters[0]
        x, jet = on_flank(tooth.side(self.which).flank, start, levels, wanted)
        turned = polar_angle(r) - polar_angle(jet.r)
        zero = np.zeros_like(turned)
        return np.stack((x[:, 0], x[:, 1], turned, turns, zero, zero), axis=-1)

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        first, second = self._bases
        axis1, axis2 = first.rotation[:, 2], second.rotation[:, 2]
        own = self.pair.pinion.tooth.side(self.which).flank.jet(x[:, 0], x[:, 1]).moved(first @ Rigid.about_z(x[:, 2]))
        mate = Jet(*(getattr(self.mate, key)[index] for key in ("r", "n", "r_u", "r_v", "n_u", "n_v")))
        mate = mate.moved(second @ Rigid.about_z(x[:, 3]))
        # the common perpendicular of both axes
        across, along = unit(cross(axis1, axis2)), axis1
        moved = x[:, 4:5] * across + x[:, 5:6] * along
        f, jacobian = np.zeros((len(x), 6)), np.zeros((len(x), 6, 6))
        f[:, :3] = own.r + moved - mate.r
        by_turn1, by_turn2 = cross(axis1, own.r - first.translation), cross(axis2, mate.r - second.translation)
        for k, column in enumerate((own.r_u, own.r_v, by_turn1, -by_turn2, across, along)):
            jacobian[:, :3, k] = column
        # in two directions of the pinion's tangent plane, held fixed
        e1 = unit(own.r_u)
        for row, direction in ((3, e1), (4, cross(own.n, e1))):
            f[:, row] = self._length * dot(own.n + mate.n, direction)
            columns = (own.n_u, own.n_v, cross(axis1, own.n), cross(axis2, mate.n))
            for k, column in enumerate(columns):
                jacobian[:, row, k] = self._length * dot(column, direction)
        # the pinion turns by its sign, the gear by its own, at the ratio of the teeth; along the axis o1 does not count
        w1 = self.pair.pinion.mount.spin
        w2 = self.pair.ratio * self.pair.gear.mount.spin
        sliding = cross(w1, mate.r - first.translation - x[:, 4:5] * across) - cross(w2, mate.r - second.translation)
        f[:, 5] = dot(mate.n, sliding)
        jacobian[:, 5, 3] = dot(cross(axis2, mate.n), sliding) + dot(mate.n, cross(w1, by_turn2) - cross(w2, by_turn2))
        jacobian[:, 5, 4] = dot(mate.n, -cross(w1, across))
        return f, jacobian
