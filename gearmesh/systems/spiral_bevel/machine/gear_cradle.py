"""Machines of a pinion whose gear is not generated (Formate): the cradle takes the gear's place.

A flank that is not generated is the cone of its cutter. Moved as the tooth of a gear about the gear's axis, this cone
generates a pinion flank that fits it everywhere. The axis of the cradle is therefore the gear's axis, and the pinion's
cutter is tilted against it like the gear's cutter. The root lines of both members are nearly parallel. A cutter that is
upright on the pinion's root line therefore has nearly this tilt, and it leaves the pinion's root as well. Local
synthesis then has little to change.

With an offset, the gear's axis is not parallel to the plane through the pinion's axis and the mean point. The machine
root line is in a plane parallel to the gear's axis; after cutting, the pinion is turned from there by the azimuth of
the mean point. Without offset both planes coincide.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.machine.pair import HAND_SIGNS, nominal_base

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.machine.generated import Generated


def turned_after_cut(design: FaceMilledDesign, blank: BevelBlank) -> float:
    """Rotation (rad) of the pinion about its axis, after cutting, that brings its mean point over the x axis."""
    return -HAND_SIGNS[design.hand] * blank.azimuths[0] if design.formate else 0.0


def root_normal(member: MemberBlank, azimuth: float = 0.0) -> Array:
    """Normal (3,) of the root cone's tangent plane at an azimuth (rad), into the blank, in the member's frame."""
    c, s = np.cos(member.root_angle), np.sin(member.root_angle)
    return np.array([-c * np.cos(azimuth), -c * np.sin(azimuth), s])


def machine_axes(root_angle: float) -> tuple[Array, Array, Array]:
    """Return the axes, (3,) each, of a machine with a given root angle (rad).

    The axes are the machine root line, the direction across it, and the cradle axis into the blank.
    """
    c, s = np.cos(root_angle), np.sin(root_angle)
    root, cradle = np.array([s, 0.0, c]), np.array([-c, 0.0, s])
    return root, cross(cradle, root), cradle


def upright_cutter(
    design: FaceMilledDesign, blank: BevelBlank, gear: Generated, root_angle: float
) -> tuple[float, float]:
    """Return tilt and swivel (rad) of a cutter that is upright on the pinion's root line at the mean cone distance.

    `root_angle`: machine root angle, rad. The swivel counts from the radius of the `gear`'s cutter about the cradle
    axis. The pinion's cutter has nearly the same radius; local synthesis changes it a little.
    """
    hand, turned = HAND_SIGNS[design.hand], turned_after_cut(design, blank)
    root, across, cradle = machine_axes(root_angle)
    # the tilt is the angle between the root's normal and the cradle axis; `lean_azimuth` is the direction of the lean
    axis = root_normal(blank.pinion, -turned)
    tilt = float(np.arccos(np.clip(axis @ cradle, -1.0, 1.0)))
    lean_azimuth = float(np.arctan2(axis @ across, axis @ root))
    # azimuth of the gear's cutter about the cradle axis, which is the gear's axis
    gear_to_machine = Rigid.about_z(-turned) @ nominal_base(blank, hand)
    # with the axis of the gear's head, the tip plane of the pinion's head is at the other end of the blades
    centre = np.array([0.0, 0.0, -blank.mean_depth if design.hobbed else 0.0])
    standing = gear_to_machine @ gear.settings.standing(gear.hand, 0.0)
    from_axis = standing.point(centre) - gear_to_machine.translation
    cutter_azimuth = float(np.arctan2(from_axis @ across, from_axis @ root))
    swivel = hand * (lean_azimuth - cutter_azimuth) - 0.5 * np.pi
    return tilt, float((swivel + np.pi) % (2.0 * np.pi) - np.pi)
