"""Transmission error of the output of a train: the sum of the errors of its stages, each divided by the ratio behind it.

With psi the rotation of the input, and u_i the rotation of the member A of stage i in the frame of its carrier,

    TE_out(psi) = sum over i of  G_i [E_i(u_i(0) + du_i/dpsi psi) - E_i(u_i(0))]

- E_i(u) = f_i(u) - slope_i u: error of the exact relation of the stage.
- G_i: rotation of the output per E_i.
- du_i/dpsi: nominal speed.

u_i(0) belongs to the whole train in contact, so that the phases of the meshes are right. The errors of earlier stages shift u_i
by a few arc seconds; this is of second order, and neglected.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.trains.layout import Layout, TrainStep
from gearmesh.trains.stage import CARRIER_NAME

#: positions in a pitch of the fastest mesh
POSITIONS_PER_PITCH = 48
#: least positions in a pitch; over many turns pitches have fewer
MIN_POSITIONS_PER_PITCH = 8
#: most positions
MAX_POSITIONS = 200_000


@dataclass(frozen=True)
class MeshMotion:
    """Nominal motion of a mesh per turn of the input, without its sign."""

    #: turns of the pinion in the frame of the carrier
    pinion_turns: Fraction
    #: tooth pairs that pass
    teeth: Fraction


def mesh_motions(layout: Layout, step: TrainStep) -> tuple[MeshMotion, ...]:
    """Return the motions of all meshes of a stage, in the order of `Stage.meshes`."""
    relative = abs(relative_speed(layout, step))
    found = []
    for k in range(len(step.stage.paths[0].meshes)):
        for path in step.stage.paths:
            turns = relative
            for mesh in path.meshes[:k]:
                turns *= abs(mesh.slope)
            found.append(MeshMotion(turns, turns * path.meshes[k].pair.pinion.tooth.teeth))
    return tuple(found)


def relative_speed(layout: Layout, step: TrainStep) -> Fraction:
    """Return the turns of A in the frame of the carrier per turn of the input."""
    source, driver = step.driver
    speeds = step.stage.speeds(driver.port)
    return layout.speeds[source] * driver.sense * (speeds[step.stage.members[0]] - speeds[CARRIER_NAME])


def steps_to(layout: Layout, shaft: str) -> tuple[TrainStep, ...]:
    """Return the stages between the input and a shaft, in the order of the motion."""
    way: list[TrainStep] = []
    while shaft != layout.file.input:
        step = next(step for step in layout.steps if step.driven[0] == shaft)
        way.append(step)
        shaft = step.driver[0]
    return tuple(reversed(way))


@dataclass(frozen=True)
class ShaftError:
    """Transmission error of a shaft."""

    #: rotations (P,) of the input from 0 on, rad, in the sense in which it turns
    psi: Array
    #: errors (P,) of the shaft about its axis, rad, by stage
    parts: dict[str, Array]

    @property
    def te(self) -> Array:
        """Error (P,) of the shaft, rad, relative to that at 0."""
        return np.asarray(sum(self.parts.values(), np.zeros_like(self.psi)))


def output_error(layout: Layout, shaft: str, turns: float | None) -> ShaftError:
    """Return the transmission error of a shaft over turns of the input, by default those of one turn of the shaft.

    Raises ArgumentError for too many turns.
    """
    way = steps_to(layout, shaft)
    if turns is None:
        turns = float(1 / abs(layout.speeds[shaft]))
    fastest = max((float(motion.teeth) for step in way for motion in mesh_motions(layout, step)), default=1.0)
    most = MAX_POSITIONS / (MIN_POSITIONS_PER_PITCH * fastest)
    if not 0.0 < turns <= most:
        raise ArgumentError("turns", turns, must_be=f"turns of the input above 0, {most:.6g} at most")
    count = int(np.ceil(min(POSITIONS_PER_PITCH * fastest * turns, MAX_POSITIONS))) + 1
    psi = np.linspace(0.0, 2.0 * np.pi * turns, count)
    start, parts = layout.follow(np.zeros(1))[1], {}
    for number, step in enumerate(way):
        stage, driver, turned = step.stage, step.driver[1], start[step.stage.name]
        at_zero = turned[stage.members[0]] - turned[CARRIER_NAME]
        rate = layout.sense * float(relative_speed(layout, step))
        error = stage.relation(at_zero + rate * psi) - float(stage.slope) * rate * psi - stage.relation(at_zero)
        gain = stage.gain(driver.port, step.driven[1].port) * step.driven[1].sense
        for later in way[number + 1 :]:
            _, after = later.driver
            gain *= after.sense * float(later.stage.speeds(after.port)[later.driven[1].port]) * later.driven[1].sense
        # adding 0.0 makes -0.0 of no error 0.0
        parts[stage.name] = gain * error + 0.0
    return ShaftError(psi, parts)
