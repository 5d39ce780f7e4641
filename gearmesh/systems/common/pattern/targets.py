"""Places on a gear's flank for its contact: at shares of the face, in the middle of the working depth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side

#: distance from the wanted place that is rounding
MAX_DISTANCE_MM = 1e-10


@dataclass(frozen=True)
class HalfwayLevel:
    """Mean g of two levels, 0 half way between them."""

    first: Level
    second: Level

    def value(self, r: Array) -> Array:
        return 0.5 * (self.first.value(r) + self.second.value(r))

    def gradient(self, r: Array) -> Array:
        return 0.5 * (self.first.gradient(r) + self.second.gradient(r))

    def hessian(self, r: Array, w: Array) -> Array:
        return 0.5 * (self.first.hessian(r, w) + self.second.hessian(r, w))


def on_flank(surface: Surface, start: Array, levels: tuple[Level, Level], wanted: Array) -> tuple[Array, Jet]:
    """Return parameters (N, 2) at which two levels have the values `wanted` (N, 2), and the jet there.

    The search starts from `start` (N, 2); NaN where it finds none.
    """

    def apart(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = surface.jet(x[:, 0], x[:, 1])
        values = np.stack([level.value(jet.r) for level in levels], axis=-1) - wanted[index]
        rows = [[dot(level.gradient(jet.r), d) for d in (jet.r_u, jet.r_v)] for level in levels]
        return values, np.moveaxis(np.array(rows), -1, 0)

    with np.errstate(all="ignore"):
        solution = newton.solve(apart, start, tolerance=MAX_DISTANCE_MM)
    x = np.where(solution.converged[:, None], solution.values, np.nan)
    return x, surface.jet(x[:, 0], x[:, 1])


def gear_targets(gear: Member, which: Side, clearance: float, shares: Array) -> Array:
    """Return parameters (N, 2) of the gear's flank at `shares` (N,) of the face from the toe.

    The points are in the middle of the working depth, between the gear's tip and the mating gear's tip. `clearance`:
    clearance of the mating tip over the gear's root, mm.
    """
    tooth = gear.tooth
    toe, heel = tooth.blank.extent
    start = tooth.flank_grid(which, [0.5], shares).parameters[0]
    middle = HalfwayLevel(tooth.blank.root, tooth.blank.tip)
    wanted = np.stack((toe + shares * (heel - toe), np.full_like(shares, 0.5 * clearance)), axis=-1)
    parameters, _ = on_flank(tooth.side(which).flank, start, (tooth.blank.axial, middle), wanted)
    return parameters
