"""Units of REXS attributes [REXS 1.0 to 1.7]: factors from a unit in a file to the unit that the format states."""

from __future__ import annotations

import math
import re

#: sizes of units in a file by the unit of the format, in that unit
_UNIT_SIZES: dict[str, dict[str, float]] = {
    "mm": {"mm": 1.0, "mum": 1e-3, "um": 1e-3, "µm": 1e-3, "μm": 1e-3, "m": 1e3},
    "deg": {"deg": 1.0, "°": 1.0, "rad": 180.0 / math.pi},
    "N / mm^2": {"N / mm^2": 1.0, "MPa": 1.0, "Pa": 1e-6},
    "N m": {"N m": 1.0, "N mm": 1e-3, "kN m": 1e3},
    "kg / dm^3": {"kg / dm^3": 1.0, "g / cm^3": 1.0, "kg / m^3": 1e-3},
    "none": {"none": 1.0, "": 1.0, "-": 1.0, "%": 1e-2},
}
_UNIT_SIZES["mum"] = {unit: 1e3 * size for unit, size in _UNIT_SIZES["mm"].items()}
#: units that the format lists; the others are read, too
LISTED_UNITS = ("mm", "mum", "deg", "°", "rad", "N / mm^2", "MPa", "Pa", "N m", "kg / dm^3", "none", "%")
#: unit that versions up to 1.3 state for angles, and its name since
OLD_UNITS = {"°": "deg"}


def _plain(unit: str) -> str:
    """Return a unit without spaces."""
    return re.sub(r"\s+", "", unit)


#: the same sizes, with units written without spaces
_UNIT_FACTORS = {wanted: {_plain(unit): size for unit, size in same.items()} for wanted, same in _UNIT_SIZES.items()}


def factor(unit: str, wanted: str) -> float | None:
    """Return the factor from a `unit` of a file to the `wanted` unit of the format; None if they measure different
    quantities.
    """
    return _UNIT_FACTORS.get(wanted, {wanted: 1.0}).get(_plain(unit))


def units_in_words(wanted: str) -> str:
    """Return the units of the format that are read in place of the `wanted` unit."""
    return ", ".join(unit for unit in _UNIT_SIZES.get(wanted, {wanted: 1.0}) if unit in LISTED_UNITS or unit == wanted)
