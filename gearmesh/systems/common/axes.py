"""Frames of gears on intersecting and crossed axes, and their displacement by assembly errors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about


def gear_base(shaft_angle: float, aside: float = 0.0) -> Rigid:
    """Return the transformation from the gear's own frame to the pinion's.

    The apexes coincide, and the gear's x axis points towards the pitch line.

    `aside`: offset (mm) of the gear's axis along y; the origins are then the feet of the common perpendicular.
    """
    axis = np.array([np.sin(shaft_angle), 0.0, np.cos(shaft_angle)])
    # x is in the axial plane, a right angle before the gear's axis
    x = np.array([-np.cos(shaft_angle), 0.0, np.sin(shaft_angle)])
    return Rigid(np.stack((x, np.array([0.0, -1.0, 0.0]), axis), axis=-1), np.array([0.0, aside, 0.0]))


def shifts(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Array:
    """Return displacements (M, 3), mm, from components that are arrays (M,) or single values."""
    return np.stack(np.broadcast_arrays(*(np.asarray(component, dtype=float) for component in (x, y, z))), axis=-1)


def tilts(gamma_h: ArrayLike, gamma_v: ArrayLike) -> Array:
    """Return rotations (..., 3, 3) of an axis by misalignments about x and y, deg."""
    return rotation_about("x", -np.radians(gamma_h)) @ rotation_about("y", np.radians(gamma_v))
