"""Digits of files: coordinates lie on a grid far finer than any tolerance and far coarser than rounding.

The last digits of a result depend on the processor (its kernels for matrices, its loops for sines). The grid removes them,
so the same command writes the same bytes. A value within rounding of the middle between two grid points can still go to
either. With rounding of 1e-14 mm this happens to one coordinate in a million or less.
"""

from __future__ import annotations

import re
from collections.abc import Iterable

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import on_grid

#: grid of vertices of meshes
VERTEX_STEPS_PER_MM = 1e7
#: grid of points of CAD solids, which programs join within 1e-7 mm
POINT_STEPS_PER_MM = 1e8
#: grid of curves of sections, whose ends meet within two steps
CURVE_STEPS_PER_MM = 1e9
#: grid of angles, deg, and of numbers without unit
STEPS_PER_UNIT = 1e11
#: grid of parameters of surfaces: a step of an angle, rad, is 1e-7 mm at a radius of 1 m
PARAMETER_STEPS_PER_UNIT = 1e10

#: a real number of ISO 10303-21
_STEP_REAL = re.compile(r"(-?[0-9]+\.[0-9]*(?:E[-+]?[0-9]+)?)")


def reals_on_grid(text: str, per_unit: float) -> str:
    """Return the text of a STEP file with all reals on a grid of `per_unit` steps per unit, in the fewest digits."""
    pieces = _STEP_REAL.split(text)
    pieces[1::2] = values_on_grid(map(float, pieces[1::2]), per_unit)
    return "".join(pieces)


def values_on_grid(values: Iterable[float], per_unit: float) -> list[str]:
    """Return the texts of a STEP file of values on a grid of `per_unit` steps per unit, in the fewest digits."""
    # always with a point, and with a capital E [ISO 10303-21]
    return [
        _with_exponent(digits) if "e" in digits else digits[:-1] if digits.endswith(".0") else digits
        for digits in map(repr, on_grid(np.fromiter(values, dtype=float), per_unit).tolist())
    ]


def _with_exponent(digits: str) -> str:
    """Return the digits of a real with an exponent as ISO 10303-21 writes it."""
    digits, _, exponent = digits.partition("e")
    return f"{digits if '.' in digits else f'{digits}.'}E{exponent}"


def vertices_on_grid(points: Array) -> Array:
    """Return vertices (..., 3), mm, of meshes on their grid."""
    return on_grid(points, VERTEX_STEPS_PER_MM)


def points_on_grid(points: Array) -> Array:
    """Return points and control points (..., 3), mm, of CAD solids on their grid."""
    return on_grid(points, POINT_STEPS_PER_MM)


def parameters_on_grid(values: Array) -> Array:
    """Return parameters (...) of surfaces, rad or mm, on their grid."""
    return on_grid(values, PARAMETER_STEPS_PER_UNIT)


def curve_on_grid(values: Array) -> Array:
    """Return points, control points and radii (...), mm, of curves of sections on their grid."""
    return on_grid(values, CURVE_STEPS_PER_MM)


def angle_on_grid(values: Array) -> Array:
    """Return angles (...), deg, parameters and other numbers without unit on their grid."""
    return on_grid(values, STEPS_PER_UNIT)
