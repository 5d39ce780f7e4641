"""Rotation of the pinion at which a tooth pair touches at the pitch point: the zero of mesh phases in rotor dynamics.

Gears whose axes are parallel or intersect roll on each other about one line, the instantaneous axis of their relative motion. There
the relative velocity v(r) = Omega x r + w is 0. In the pinion's frame this line sweeps a cylinder or a cone, the pitch
surface. The point of the pinion's flank on it at mid face lies on the line at one rotation, and so does the point of the gear's
flank. There the tooth pair touches without sliding. Skew axes have no such line.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side

#: shares of the flank at which its height over the pitch surface is sampled, in each round
SEARCH_ROWS = 33
#: rounds; each narrows the bracket to one step of the round before
SEARCH_ROUNDS = 4
#: speed of the sliding along the instantaneous axis, as a share of the pinion's speed, below which axes meet or are parallel
MAX_AXIAL_SHARE = 1e-6


def pitch_point_phi1(pair: GearPair) -> tuple[float, float]:
    """Return the rotations (rad) of pinion and gear at which tooth pair 0 touches at the pitch point, at mid face.

    NaN for skew axes, for members that turn with equal speeds, and for flanks that do not reach the pitch surface.
    """
    line = _instantaneous_axis(pair)
    if line is None:
        return np.nan, np.nan
    pinion, gear = (_rotation_on_to(member, side, *line) for member, side in zip(pair.both, pair.flanks, strict=True))
    return pinion, gear


def _rotation_on_to(member: Member, side: Side, point: Array, direction: Array) -> float:
    """Return the rotation (rad) that brings a point of a flank at mid face on to the instantaneous axis; NaN if none does.

    The axis has a point (3,), mm, and a direction (3,), fixed frame.
    """
    mount = member.mount
    # the line in the frame of the unrotated member
    point, direction = mount.base.inverse.point(point), mount.base.inverse.vector(direction)
    joint = member.tooth.joint
    if abs(direction[2]) < MAX_SINE_OF_PARALLEL:
        return np.nan

    def places(s: Array) -> tuple[Array, Array]:
        """Return the flank's points (S, 3) at mid face, and the line's points (S, 3) at their stations."""
        flank = member.tooth.flank_grid(side, s, np.array([0.5])).points[:, 0]
        return flank, point + ((flank[:, 2] - point[2]) / direction[2])[:, None] * direction

    low, high = 0.0, 1.0
    for _ in range(SEARCH_ROUNDS):
        s = np.linspace(low, high, SEARCH_ROWS)
        flank, on_line = places(s)
        height = joint.radius(flank) - joint.radius(on_line)
        crossing = np.flatnonzero((height[:-1] <= 0.0) != (height[1:] <= 0.0))
        if not crossing.size:
            return np.nan
        k = crossing[0]
        low, high, share = s[k], s[k + 1], height[k] / (height[k] - height[k + 1])
    flank, on_line = places(np.array([low + share * (high - low)]))
    turn = joint.within(joint.angle(on_line) - joint.angle(flank))
    return float(mount.zero + mount.sign * turn[0])


def _instantaneous_axis(pair: GearPair) -> tuple[Array, Array] | None:
    """Return a point (3,), mm, and the direction (3,) of the instantaneous axis, fixed frame; None if there is none."""
    pinion, gear = pair.mounts
    spin = pinion.spin - pair.ratio * gear.spin
    rate = float(np.linalg.norm(spin))
    if rate < MAX_SINE_OF_PARALLEL:
        return None
    origin = pinion.origin
    velocity = pinion.velocity(origin) - pair.ratio * gear.velocity(origin)
    direction = spin / rate
    point = origin + np.cross(spin, velocity) / rate**2
    speed = float(np.linalg.norm(velocity))
    if abs(direction @ velocity) > MAX_AXIAL_SHARE * max(speed, 1.0):
        return None
    return point, direction
