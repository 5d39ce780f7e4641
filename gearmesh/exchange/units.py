"""Units of REXS attributes: mm, deg, N/mm^2, Nm and plain numbers are what designs have."""

from __future__ import annotations

import math

#: unit in a file -> the unit in which designs have it, and how many of it it is
_UNITS: dict[str, tuple[str, float]] = {
    "mm": ("mm", 1.0),
    "mum": ("mm", 1e-3),
    "m": ("mm", 1e3),
    "deg": ("deg", 1.0),
    "rad": ("deg", 180.0 / math.pi),
    "N / mm^2": ("N / mm^2", 1.0),
    "MPa": ("N / mm^2", 1.0),
    "N m": ("N m", 1.0),
    "kN m": ("N m", 1e3),
    "1 / min": ("1 / min", 1.0),
    "none": ("none", 1.0),
    "": ("none", 1.0),
    "%": ("none", 1e-2),
}


def factor(unit: str, wanted: str) -> float | None:
    """What a value in a `unit` of a file is multiplied by to be in the `wanted` one; None if it is of something else."""
    base, scale = _UNITS.get(unit, ("", 1.0))
    return scale if base == wanted else None
