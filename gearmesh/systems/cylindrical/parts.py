"""Cylindrical pairs as parts of other designs, with the keys that they take from the whole design."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry import proportions as closed

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import ToothingKeys

Pair = TypeVar("Pair", bound=CylindricalDesign)

#: keys of the whole design that its pairs take over
SHARED_KEYS = (
    "units",
    "module",
    "diametral_pitch",
    "transverse_module",
    "transverse_diametral_pitch",
    "profile",
    "pressure_angle",
    "transverse_pressure_angle",
    "coast_pressure_angle",
    "helix_angle",
    "shift_sharing",
    "arrangement",
    "gap",
)


def shared_keys(design: ToothingKeys) -> dict[str, Any]:
    """Return the given keys of a design that its pairs take over."""
    return {key: getattr(design, key) for key in SHARED_KEYS if is_given(design, key)}


def is_given(design: ToothingKeys, key: str) -> bool:
    """True if a design sets a key."""
    return design.sets(key) and getattr(design, key) is not None


def nest(own: Mapping[str, Any], names: Mapping[str, str]) -> dict[str, dict[str, Any]]:
    """Return the given keys of some members as tables under other names."""
    tables: dict[str, dict[str, Any]] = {name: {} for name in names.values()}
    for dotted, value in own.items():
        *path, last = dotted.split(".")
        if path and path[0] in names:
            table = tables[names[path[0]]]
            for name in path[1:]:
                table = table.setdefault(name, {})
            table[last] = value
    return tables


def completed_pair(kind: type[Pair], keys: Mapping[str, Any]) -> Pair:
    """Return the design of a pair with all values that follow from its mesh.

    Raises DesignError if the pair cannot exist.
    """
    design = kind(**keys)
    return design if design.complete else design.fill(closed.derived_values(design))
