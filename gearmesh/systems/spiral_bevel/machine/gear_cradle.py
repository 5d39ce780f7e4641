"""Machines of a pinion whose gear is not generated (Formate): the cradle takes the gear's place.

A flank that was not generated is a cone, the cutter's. What it generates as the tooth of a gear that turns about the gear's own
axis fits it all over; so the cradle's axis is the gear's, and the pinion's cutter leans against it as the gear's did. Where it
stands upright on the pinion's root line, as both root lines are next to parallel, it leaves the pinion's root as well: local
synthesis has then only little to change.

With an offset the gear's axis is not parallel to the plane through the pinion's axis and the mean point. The machine's root line is
in the plane that is; the pinion is turned from there by the mean point's azimuth after it was cut. Without offset both are one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.machine.pair import HANDS, nominal_base

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.machine.generated import Generated


def turned_after_cut(design: FaceMilledDesign, blank: BevelBlank) -> float:
    """How far (rad) the pinion is turned about its axis after it was cut, for its mean point to be over the x axis."""
    return -HANDS[design.hand] * blank.azimuths[0] if design.formate else 0.0


def root_normal(own: MemberBlank, azimuth: float = 0.0) -> Array:
    """Normal (3,) of the root cone's tangent plane at an azimuth (rad), into the blank, in the member's own frame."""
    c, s = np.cos(own.root_angle), np.sin(own.root_angle)
    return np.array([-c * np.cos(azimuth), -c * np.sin(azimuth), s])


def machine_axes(root_angle: float) -> tuple[Array, Array, Array]:
    """Machine root line, what is across it, and the cradle's axis into the blank, (3,) each, of a machine root angle (rad)."""
    c, s = np.cos(root_angle), np.sin(root_angle)
    root, cradle = np.array([s, 0.0, c]), np.array([-c, 0.0, s])
    return root, np.cross(cradle, root), cradle


def upright_cutter(
    design: FaceMilledDesign, blank: BevelBlank, gear: Generated, root_angle: float
) -> tuple[float, float]:
    """Tilt and swivel (rad) of a cutter upright on the pinion's root line at its mean, at a machine root angle (rad).

    The swivel counts from where the `gear`'s cutter (as it is cut) stands, which is where the pinion's will be, but for what local
    synthesis changes.
    """
    hand, turned = HANDS[design.hand], turned_after_cut(design, blank)
    root, across, cradle = machine_axes(root_angle)
    axis = root_normal(blank.pinion, -turned)
    tilt = float(np.arccos(np.clip(axis @ cradle, -1.0, 1.0)))
    towards = float(np.arctan2(axis @ across, axis @ root))
    gear_to_machine = Rigid.about_z(-turned) @ nominal_base(blank, hand)
    from_axis = gear_to_machine.point(gear.settings.standing(gear.hand, 0.0).translation) - gear_to_machine.translation
    place = float(np.arctan2(from_axis @ across, from_axis @ root))
    swivel = hand * (towards - place) - 0.5 * np.pi
    return tilt, float((swivel + np.pi) % (2.0 * np.pi) - np.pi)
