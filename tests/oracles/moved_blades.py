"""Blades of a face-hobbing head moved as its machine moves them, axis by axis: the second route to flanks and cuts."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.systems.common.bevel.machine_frame import own_axes
from gearmesh.systems.spiral_bevel.machine.generated import Generated


def machine_points(side: Generated, roll: Array, turn: Array, p: Array) -> Array:
    """Points (M, 3) of the blade on the blank, M of each: rotations of cradle and cutter, and parameters of the edge.

    The machine's axes turn one by one; the blank turns for roll and indexing.
    """
    settings, indexing = side.settings, side.indexing
    assert indexing is not None
    angle = settings.cradle_angle
    centre = settings.radial * np.array([np.cos(angle), side.hand * np.sin(angle), 0.0])
    # a tilted axis leans by the swivel, from growing cradle angle
    lean = side.hand * (angle + 0.5 * np.pi + settings.swivel)
    axes = rotation_about("z", lean) @ rotation_about("y", settings.tilt) if settings.tilt else np.eye(3)
    machine_centre = np.array([settings.machine_centre_to_back, -side.hand * settings.machining_offset, 0.0])
    towards = (np.array([side.mean, 0.0, 0.0]) - machine_centre - centre) @ axes
    radial = np.append(towards[:2] / np.linalg.norm(towards[:2]), 0.0)
    across = rotation_about("z", indexing.offset_angle) @ radial
    height, beside = np.moveaxis(side.blade.flank.section(p)[0], -1, 0)
    out = side.blade.side * beside - indexing.radius
    edge = indexing.radius * radial + out[:, None] * across + np.multiply.outer(-height, [0.0, 0.0, 1.0])
    on_cradle = (axes @ rotation_about("z", turn) @ edge[..., None])[..., 0] + centre
    rolled = (rotation_about("z", side.hand * roll) @ on_cradle[..., None])[..., 0]
    placed = rolled + machine_centre - np.array([0.0, 0.0, settings.sliding_base])
    on_blank = placed @ own_axes(settings.machine_root_angle).T
    blank_turn = turn * indexing.blade_groups / indexing.teeth
    if not settings.formate:
        blank_turn = blank_turn - side.hand * roll / settings.ratio_of_roll
    return (rotation_about("z", blank_turn) @ on_blank[..., None])[..., 0]
