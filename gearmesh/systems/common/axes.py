"""Frames of gears on intersecting and on crossed axes, and how errors of assembly move them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, rotation_about


def gear_base(shaft_angle: float, aside: float = 0.0) -> Rigid:
    """The gear's own frame to the pinion's: apexes together, the gear's x axis towards the pitch line.

    `aside` (mm): how far the gear's axis is to the side, along y; the origins are then the feet of the common perpendicular.
    """
    axis = np.array([np.sin(shaft_angle), 0.0, np.cos(shaft_angle)])
    # in the axial plane, a right angle before the gear's axis
    x = np.array([-np.cos(shaft_angle), 0.0, np.sin(shaft_angle)])
    return Rigid(np.stack((x, np.array([0.0, -1.0, 0.0]), axis), axis=-1), np.array([0.0, aside, 0.0]))


def shifts(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Array:
    """Displacements (M, 3), mm, by components (M,) or single ones."""
    return np.stack(np.broadcast_arrays(*(np.asarray(component, dtype=float) for component in (x, y, z))), axis=-1)


def tilts(gamma_h: ArrayLike, gamma_v: ArrayLike) -> Array:
    """Rotations (..., 3, 3) of an axis by misalignments about x and y, deg."""
    return rotation_about("x", -np.radians(gamma_h)) @ rotation_about("y", np.radians(gamma_v))
