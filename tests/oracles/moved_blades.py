"""Blades of a face-hobbing head moved as its machine moves them, axis by axis: the second route to flanks and cuts."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.systems.common.bevel.machine_frame import own_axes
from gearmesh.systems.spiral_bevel.machine.generated import Generated


def machine_points(side: Generated, roll: Array, turn: Array, p: Array, *, rounding: bool = False) -> Array:
    """Points (M, 3) of the blade on the blank, M of each: rotations of cradle and cutter, and parameters of the edge.

    The machine's axes turn one by one; the blank turns for roll and indexing. With `rounding` the points are on the
    rounding of the blade's tip.
    """
    settings, indexing = side.settings, side.indexing
    assert indexing is not None
    angle = settings.cradle_angle
    outwards = np.array([np.cos(angle), side.hand * np.sin(angle), 0.0])
    # a tilted axis leans by the swivel, from growing cradle angle
    tilt, swivel = (
        moved(settings.tilt, settings.tilt_motion, roll),
        moved(settings.swivel, settings.swivel_motion, roll),
    )
    lean = side.hand * (angle + 0.5 * np.pi + swivel)
    axes = (
        rotation_about("z", lean) @ rotation_about("y", tilt)
        if settings.tilted
        else np.broadcast_to(np.eye(3), (len(roll), 3, 3))
    )
    first = side.hand * (angle + 0.5 * np.pi + settings.swivel)
    still = rotation_about("z", first) @ rotation_about("y", settings.tilt) if settings.tilted else np.eye(3)
    machine_centre = np.array([settings.machine_centre_to_back, -side.hand * settings.machining_offset, 0.0])
    towards = (np.array([side.mean, 0.0, 0.0]) - machine_centre - settings.radial * outwards) @ still
    radial = np.append(towards[:2] / np.linalg.norm(towards[:2]), 0.0)
    across = rotation_about("z", indexing.offset_angle) @ radial
    profile = side.blade.rounding if rounding else side.blade.flank
    height, beside = np.moveaxis(profile.section(p)[0], -1, 0)
    out = side.blade.side * beside - indexing.radius
    edge = indexing.radius * radial + out[:, None] * across + np.multiply.outer(-height, [0.0, 0.0, 1.0])
    centre = np.multiply.outer(moved(settings.radial, settings.radial_motion, roll), outwards)
    on_cradle = (axes @ rotation_about("z", turn) @ edge[..., None])[..., 0] + centre
    rolled = (rotation_about("z", side.hand * roll) @ on_cradle[..., None])[..., 0]
    # the blank moves away along the machine's axes
    offset = moved(settings.machining_offset, settings.vertical_motion, roll)
    base = moved(settings.sliding_base, settings.helical_motion, roll)
    placed = rolled + np.stack(
        (np.full_like(roll, settings.machine_centre_to_back), -side.hand * offset, -base), axis=-1
    )
    on_blank = placed @ own_axes(settings.machine_root_angle).T
    blank_turn = turn * indexing.blade_groups / indexing.teeth
    if not settings.formate:
        lag = moved(0.0, (0.0, *settings.modified_roll), roll)
        blank_turn = blank_turn - side.hand * (roll - lag) / settings.ratio_of_roll
    return (rotation_about("z", blank_turn) @ on_blank[..., None])[..., 0]


def moved(setting: float, motion: tuple[float, ...], roll: Array) -> Array:
    """Setting (M,) with its motion a1 q + a2 q^2 + ... at rolls (M,)."""
    return np.asarray(setting + sum((a * roll**k for k, a in enumerate(motion, start=1)), np.zeros_like(roll)))


def clearances(
    side: Generated, roll: Array, points: tuple[Array, Array], start: Array, *, rounding: bool = False
) -> Array:
    """Unknowns (M, 3): rotation of the cutter, parameter of the edge, and distance (mm) of the blade along normals."""
    r, n = points
    x, step = start.copy(), np.array([1e-6, 1e-6])

    def edge(x: Array, turned: float = 0.0, moved: float = 0.0) -> Array:
        return machine_points(side, roll, x[:, 0] + turned, x[:, 1] + moved, rounding=rounding)

    for _ in range(8):
        at = edge(x)
        columns = [(edge(x, *d) - at) / d.sum() for d in np.diag(step)]
        matrix = np.stack((*columns, -n), axis=-1)
        x -= np.linalg.solve(matrix, (at - r - x[:, 2:] * n)[..., None])[..., 0]
    return x
