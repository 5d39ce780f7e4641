"""Index position of a pinion flank in contact with its mating flank; the index of the blank on the machine is free.

Settings and cutter determine the form of a flank, but not the rotation of the blank when it was cut. A flank with given
settings is turned about the pinion's axis until it touches the gear's flank, whose position has the mean point in
contact. A flank from local synthesis already has that position. The thickness of the teeth follows from there: see
`cutting`.
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
    from gearmesh.systems.common.bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.machine.generated import Generated

#: distance (mm) from the mean point, or between touching flanks, that counts as 0
CONTACT_TOLERANCE_MM = 1e-10
#: largest turn (pitches) from flanks through one point to flanks that touch at another point
MAX_CONTACT_TURN_PITCHES = 0.1

_NO_GRID = np.zeros((1, 1, 2))


def touching_turn(
    side: Generated, mating: tuple[Surface, Rigid], parameters: tuple[float, float], blank: BevelBlank
) -> float:
    """Return the rotation (rad) about its axis that brings a pinion flank, as cut, into contact with its mating gear.

    - `side`: the pinion's side as cut
    - `mating`: the gear's flank as cut, and its position in the pinion's frame
    - `parameters`: parameters of the gear's mean point
    - `blank`: blank of the pair

    The flanks touch at a point near the mean point. If there is no such point, the pinion's flank passes through the
    mean point. Raises NoSolutionError if the pinion's flank has no point at the mean point's height and cone distance.
    """
    surface, standing = mating
    point = standing.point(surface.jet(*(np.array(x) for x in parameters)).r)
    flank = side.side(0.0).flank
    # first the rotation at which the pinion's flank passes through the gear's mean point
    pinion_parameters = _at(side, point, blank)
    turn = _wrap(float(polar_angle(point) - polar_angle(flank.jet(pinion_parameters[:1], pinion_parameters[1:]).r)[0]))
    # then the rotation at which the flanks touch: the gear is fixed, and the pinion turns
    still = Flank(surface, Mount(standing), {}, blank.gear.stations, blank.gear.extent, _NO_GRID)
    turning = Flank(flank, Mount(Rigid.identity()), {}, blank.pinion.stations, blank.pinion.extent, _NO_GRID)
    conditions = Conditions((still, turning), np.zeros(1), blank.mean_normal_module)
    start = np.array([[*parameters, *pinion_parameters, turn]])
    with np.errstate(all="ignore"):
        solution = newton.solve(conditions, start, tolerance=CONTACT_TOLERANCE_MM)
    touch = float(solution.values[0, 4])
    # contact far from the mean point belongs to another part of the flank
    near = abs(touch - turn) < MAX_CONTACT_TURN_PITCHES * 2.0 * np.pi / blank.pinion.teeth
    return touch if solution.converged[0] and near else turn


def _at(side: Generated, point: Array, blank: BevelBlank) -> Array:
    """Return the parameters (2,) of the flank's point at the same height and cone distance as a point (3,).

    The height is over the pitch cone, the cone distance from the apex.
    """
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
        solution = newton.solve(apart, start[None, :], tolerance=CONTACT_TOLERANCE_MM)
    if not solution.converged[0]:
        raise NoSolutionError("pinion", reason="its cutter does not generate the mean point: check its settings")
    return np.asarray(solution.values[0])


def _wrap(angle: float) -> float:
    """Return an angle (rad) between -pi and pi."""
    return (angle + np.pi) % (2.0 * np.pi) - np.pi
