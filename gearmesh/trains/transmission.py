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


def mesh_motions(step: TrainStep) -> tuple[MeshMotion, ...]:
    """Return the motions of all meshes of a stage, in the order of `Stage.meshes`."""
    relative = abs(step.relative_speed)
    found = []
    for k in range(len(step.stage.paths[0].meshes)):
        for path in step.stage.paths:
            turns = relative
            for mesh in path.meshes[:k]:
                turns *= abs(mesh.slope)
            found.append(MeshMotion(turns, turns * path.meshes[k].pair.pinion.tooth.teeth))
    return tuple(found)


def gains_to(layout: Layout, shaft: str) -> dict[str, float]:
    """Return the turns of a shaft per turn of every shaft before it, all others that drive being held, by their names.

    A stage that closes a loop passes nothing on.
    """
    gains = {shaft: 1.0}
    for step in reversed(layout.steps):
        target, _ = step.driven
        if target not in gains or step.closes_loop:
            continue
        for source, driver in step.drivers:
            gains[source] = gains.get(source, 0.0) + gains[target] * step.rate(driver)
    return gains


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
    gains = gains_to(layout, shaft)
    way = [step for step in layout.steps if step.driven[0] in gains and not step.closes_loop]
    if turns is None:
        # a shaft that is held has one turn of the input
        turns = float(1 / abs(layout.speeds[shaft])) if layout.speeds[shaft] else 1.0
    fastest = max((float(motion.teeth) for step in way for motion in mesh_motions(step)), default=1.0)
    most = MAX_POSITIONS / (MIN_POSITIONS_PER_PITCH * max(fastest, 1.0))
    if not 0.0 < turns <= most:
        raise ArgumentError("turns", turns, must_be=f"turns of the input above 0, {most:.6g} at most")
    count = int(np.ceil(min(POSITIONS_PER_PITCH * fastest * turns, MAX_POSITIONS))) + 1
    psi = np.linspace(0.0, 2.0 * np.pi * turns, count)
    start, parts = layout.follow(np.zeros(1))[1], {}
    for step in way:
        stage, (target, driven), turned = step.stage, step.driven, start[step.stage.name]
        at_zero = turned[stage.members[0]] - turned[CARRIER_NAME]
        rate = layout.sense * float(step.relative_speed)
        error = stage.relation(at_zero + rate * psi) - float(stage.slope) * rate * psi - stage.relation(at_zero)
        # adding 0.0 makes -0.0 of no error 0.0
        parts[stage.name] = gains[target] * stage.gain(driven.port) * driven.sense * error + 0.0
    return ShaftError(psi, parts)
