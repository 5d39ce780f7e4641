"""How many digits files have: coordinates are on a grid far finer than any tolerance and far coarser than rounding.

Last digits differ between processors (their kernels for matrices, their loops for sines). On the grid they are gone, so that the
same command writes the same bytes. A value that lies within rounding of a border of the grid can still fall to either side: with
rounding of 1e-14 mm that is one coordinate in a million or less.
"""

from __future__ import annotations

import re

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import on_grid

#: steps of the grid per mm: of vertices of meshes; of points of CAD solids, which programs join if they are within 1e-7 mm; of
#: curves of sections, whose ends meet within two steps
VERTEX_STEPS_PER_MM, POINT_STEPS_PER_MM, CURVE_STEPS_PER_MM = 1e7, 1e8, 1e9
#: steps of the grid of angles (deg) and numbers without unit, and of parameters of surfaces: a radian at 1 m in steps of 1e-7 mm
STEPS_PER_UNIT, PARAMETER_STEPS_PER_UNIT = 1e11, 1e10

_REAL = re.compile(r"(-?[0-9]+\.[0-9]*(?:E[-+]?[0-9]+)?)")


def reals_on_grid(text: str, per_unit: float) -> str:
    """A text of STEP files with its reals on a grid of so many steps per unit, as few digits as they take."""
    pieces = _REAL.split(text)
    values = np.array(list(map(float, pieces[1::2])))
    pieces[1::2] = map(_real, on_grid(values, per_unit).tolist())
    return "".join(pieces)


def _real(value: float) -> str:
    """The text of a real by ISO 10303-21, which has a point always and a capital E."""
    digits = repr(value)
    if "e" not in digits:
        return digits.removesuffix("0") if digits.endswith(".0") else digits
    digits, _, exponent = digits.partition("e")
    return f"{digits if '.' in digits else f'{digits}.'}E{exponent}"


def vertices_on_grid(points: Array) -> Array:
    """Vertices (..., 3) of meshes, mm."""
    return on_grid(points, VERTEX_STEPS_PER_MM)


def curve_on_grid(values: Array) -> Array:
    """Points, control points and radii (...) of curves of sections, mm."""
    return on_grid(values, CURVE_STEPS_PER_MM)


def angle_on_grid(values: Array) -> Array:
    """Angles (...), deg, parameters and other numbers without length."""
    return on_grid(values, STEPS_PER_UNIT)
