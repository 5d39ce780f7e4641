"""Position of a flank of the pinion when it meets its mating flank: the index of the blank on the machine is free.

Settings and cutter say what a flank is, not how the blank was turned when it was cut. A flank whose settings are given is turned
about the pinion's axis until it touches the gear's, which stands where the mean point is in contact; of a flank that local
synthesis has put there nothing has to be turned. Teeth get their thickness from there: see `cutting`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions, Flank
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot, polar_angle
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.teeth.mount import Mount

if TYPE_CHECKING:
    from gearmesh.kernel.surface.surface import Surface
    from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.machine.generated import Generated

#: distance (mm) from the mean point, or of touching flanks, that counts as none
REACHED = 1e-10
#: the farthest (pitches) that flanks through one point are turned until they touch somewhere else
FARTHEST = 0.1

_NO_GRID = np.zeros((1, 1, 2))


def touching_turn(
    side: Generated, mating: tuple[Surface, Rigid], parameters: tuple[float, float], blank: BevelBlank
) -> float:
    """Rotation (rad) about its axis that brings a flank of the pinion, as cut, to its mating gear, the gear's flank as cut and
    where it is in the pinion's own frame; `parameters` are those of the gear's mean point.

    To a point of contact near the mean point, or where there is none through it. Raises NoSolutionError where the flank has no
    point as high at this cone distance.
    """
    surface, standing = mating
    point = standing.point(surface.jet(*(np.array(x) for x in parameters)).r)
    flank = side.side(0.0).flank
    at = _at(side, point, blank)
    turn = _wrap(float(polar_angle(point) - polar_angle(flank.jet(at[:1], at[1:]).r)[0]))
    # the gear stands still, and it is the pinion that turns to it
    still = Flank(surface, Mount(standing), {}, blank.gear.stations, blank.gear.extent, _NO_GRID)
    turning = Flank(flank, Mount(Rigid.identity()), {}, blank.pinion.stations, blank.pinion.extent, _NO_GRID)
    conditions = Conditions((still, turning), np.zeros(1), blank.mean_normal_module)
    start = np.array([[*parameters, *at, turn]])
    with np.errstate(all="ignore"):
        solution = newton.solve(conditions, start, tolerance=REACHED)
    touch = float(solution.values[0, 4])
    near = abs(touch - turn) < FARTHEST * 2.0 * np.pi / blank.pinion.teeth
    return touch if solution.converged[0] and near else turn


def _at(side: Generated, point: Array, blank: BevelBlank) -> Array:
    """Parameters (2,) of the flank's point as high over the pitch cone, and as far from the apex, as a point (3,)."""
    levels = (blank.pinion.stations, ConeLevel(blank.pinion.pitch_angle - 0.5 * np.pi))
    wanted = np.array([float(level.value(point)) for level in levels])
    flank = side.side(0.0).flank

    def apart(x: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = flank.jet(x[:, 0], x[:, 1])
        values = np.stack([level.value(jet.r) for level in levels], axis=-1)
        rows = [[dot(level.gradient(jet.r), d) for d in (jet.r_u, jet.r_v)] for level in levels]
        return values - wanted, np.moveaxis(np.array(rows), -1, 0)

    start = np.array([side.blade.at_height(0.5 * blank.mean_depth), 0.0])
    with np.errstate(all="ignore"):
        solution = newton.solve(apart, start[None, :], tolerance=REACHED)
    if not solution.converged[0]:
        raise NoSolutionError("pinion", reason="its cutter does not generate the mean point: check its settings")
    return np.asarray(solution.values[0])


def _wrap(angle: float) -> float:
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
