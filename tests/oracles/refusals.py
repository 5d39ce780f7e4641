"""Keys of a design pushed until they are refused, and the refusals held to their own fields.

A design is named by its kind, whose example it is, or by its sample.

A refusal names a key of the kind with the value that the design sets; a bound that it states is a value of that key, in its unit,
excludes the value, is accepted when it is put back, and refused a twentieth beyond.
"""

from __future__ import annotations

import math
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
from pydantic_core import PydanticCustomError

import gearmesh as gm
from gearmesh import Design, GearmeshError
from gearmesh.design.dotted import with_keys
from gearmesh.kinds import Key, Table
from gearmesh.systems import diagnosis
from gearmesh.systems.system import complete_design, design_class

SAMPLES = Path(__file__).parents[2] / "samples"
#: seed of choices of keys
SEED = 53
#: tables that have no part in the geometry
ASIDE = ("fe", "mesh", "material", "mount", "contact", "measured", "rexs")
#: values of keys without a default, by the units of the keys: a length in modules
FIRST = {"length": 1.0, "angle": 1.0, "number": 0.5, "coefficient": 0.5, "count": 5, "curvature": 0.01}
#: factors of a value, steps from 0 in units of its first value, and a count's
FACTORS, STEPS, COUNTS = (1.2, 2.0, 5.0, 25.0), (0.1, 0.5, 2.0, 10.0, 40.0), (1, 2, 5, 15, 90)
#: by how much of a bound a value lies beyond it, and inside one that is not allowed itself
BEYOND, INSIDE = 0.05, 1e-5
#: the nearest value that is refused, which rough bounds state; and what is said of bounds behind which another refusal follows
NEAREST_REFUSED, FOLLOWED = (
    re.compile(r", (-?[\d.]+(?:e[-+]?\d+)?)(?: [\w/]+)? is refused as well"),
    "another refusal then follows",
)
#: units of bounds of keys
UNITS = {"length": "mm", "angle": "deg", "curvature": "1/mm"}
#: keys that others need beside them, by the table
BESIDE: dict[str, dict[str, Any]] = {
    **{
        name: {"amount": 0.02, "length": 2.0}
        for name in ("end_relief_toe", "end_relief_heel", "triangular_end_relief_tip", "triangular_end_relief_root")
    },
    "thickness_allowance": {"upper": -0.05, "lower": -0.1},
    "tip_diameter_tolerance": {"upper": 0.0, "lower": -0.1},
    "keyway": {"width": 3.0, "depth": 1.0},
    "hub": {"diameter": 24.0, "length": 5.0},
    "toe_hub": {"diameter": 24.0, "length": 5.0},
    "bolts": {"count": 4, "diameter": 3.0},
    "spokes": {"count": 4, "width": 3.0},
    "web": {"thickness": 5.0},
    "holes": {"count": 4},
    "shaper": {"teeth": 26},
    "hob": {"protuberance": 0.05},
}


@dataclass
class Verdict:
    """Refusals of a key that was pushed: how many, their stated bounds that build, those behind which another refusal follows,
    CPU seconds of the longest, and what is wrong with them."""

    refusals: int = 0
    built: int = 0
    followed: int = 0
    longest: float = 0.0
    faults: list[str] = field(default_factory=list)


def example(name: str) -> tuple[type[Design], dict[str, Any]]:
    """Class and set keys of the example of a kind, or of a sample."""
    if name in gm.kinds():
        cls = design_class(name)
        return cls, dict(cls(**cls.example).own())
    design = gm.load(SAMPLES / f"{name}.toml")
    return type(design), dict(design.own())


def numeric_keys(name: str, count: int | None = None) -> list[str]:
    """Dotted keys of a design that take one number and have a part in the geometry; at most `count`, by a seeded choice."""
    keys = [name for name, key in _leaves(example(name)[0]) if key.unit in FIRST and not key.most]
    if count is None or count >= len(keys):
        return keys
    # a larger choice contains every smaller one
    chosen = set(np.random.default_rng(SEED).permutation(len(keys))[:count].tolist())
    return [key for place, key in enumerate(keys) if place in chosen]


def _leaves(table: type[Table], prefix: str = "") -> Iterator[tuple[str, Key]]:
    for name in table.names():
        below, key = table.table_of(name), table.key_of(name)
        if below is not None and name not in ASIDE:
            yield from _leaves(below, f"{prefix}{name}.")
        elif key is not None and below is None:
            yield prefix + name, key


def faults(name: str, dotted: str) -> list[str]:
    """Return the faults of the refusals of a key that is pushed up and down from its value in a design."""
    return verdict(name, dotted).faults


def verdict(name: str, dotted: str) -> Verdict:
    """Refusals of a key that is pushed up and down from its value in a design."""
    (cls, own), keys = example(name), _keys_beside(name, dotted)
    whole, key = complete_design(cls(**with_keys({}, own.items()))), cls.key_at(dotted)
    assert key is not None, "a key of the kind"
    value: Any = whole
    for part in dotted.split("."):
        value = getattr(value, part, None)
    found = Verdict()
    first = FIRST[key.unit] * (whole.given_module if key.unit == "length" else 1.0)
    value = keys.get(dotted, value)
    for tried in _pushed(first if value is None or math.isnan(value) else value, first, key):
        allowed = [number for number in tried if _takes(key, number)]

        def refused(number: float) -> bool:
            return refusal(cls, {**keys, dotted: number}, diagnosed=False) is not None

        # where the farthest value is accepted nearer ones are not tried: that spares half of all builds
        if allowed and refused(allowed[-1]):
            pushed = next((number for number in allowed[:-1] if refused(number)), allowed[-1])
            _judge(cls, {**keys, dotted: pushed}, f"{dotted} = {pushed:.6g}", found)
    return found


def faults_at(name: str, dotted: str, value: float) -> list[str]:
    """Return the faults of the refusal of a value of a key in a design."""
    found = Verdict()
    _judge(example(name)[0], {**_keys_beside(name, dotted), dotted: value}, f"{dotted} = {value:.6g}", found)
    return found.faults


def _keys_beside(name: str, dotted: str) -> dict[str, Any]:
    """Keys of a design, and those that a key needs beside it."""
    (_, keys), table = example(name), dotted.split(".")[-2:-1]
    for other, given in BESIDE.get(table[0] if table else "", {}).items():
        keys[dotted.rpartition(".")[0] + f".{other}"] = given
    return keys


def _pushed(value: float, first: float, key: Key) -> tuple[list[float], list[float]]:
    """Ever larger and ever smaller values."""
    if key.unit == "count":
        return [value + step for step in COUNTS], [value - step for step in COUNTS]
    if value == 0.0:
        return [step * first for step in STEPS], [-step * first for step in STEPS]
    return [value * factor for factor in FACTORS], [value / factor for factor in FACTORS]


def _takes(key: Key, value: float) -> bool:
    """True for a value in the range of its key, in any design."""
    try:
        key.check(int(value) if key.unit == "count" else value, 1.0)
    except PydanticCustomError:
        return False
    return True


def refusal(cls: type[Design], keys: dict[str, Any], *, diagnosed: bool = True) -> GearmeshError | None:
    """The refusal of a design; None if it can be built."""
    try:
        with patch.object(diagnosis, "MAX_EFFORT", diagnosis.MAX_EFFORT if diagnosed else 0.0):
            gm.build(cls(**with_keys({}, keys.items())))
    except GearmeshError as error:
        return error
    return None


def _judge(cls: type[Design], keys: dict[str, Any], about: str, found: Verdict) -> None:
    """Add the refusal of a design to what was found."""
    start = time.process_time()
    error = refusal(cls, keys)
    assert error is not None, "it is refused"
    found.longest = max(found.longest, time.process_time() - start)
    found.refusals += 1
    found.faults += [f"{about}: {error}: {fault}" for fault in _untrue(cls, keys, error, found)]


def _untrue(cls: type[Design], keys: dict[str, Any], error: GearmeshError, found: Verdict) -> Iterator[str]:
    bounds, key = error.bounds, cls.key_at(error.key)
    if key is None or error.key not in keys:
        # a part of the gears, or a key that is missing
        if key is not None and bounds is not None and error.value:
            yield "bounds of what is no key"
    elif error.value != keys[error.key]:
        yield f"the value is {error.value!r}"
    elif bounds is None:
        if error.bounds_another:
            yield "bounds another quantity"
    elif bounds.unit != UNITS.get(key.unit, ""):
        yield f"the bound's unit is {bounds.unit}"
    else:
        yield from _bound_faults(cls, keys, error, found)


def _bound_faults(cls: type[Design], keys: dict[str, Any], error: GearmeshError, found: Verdict) -> Iterator[str]:
    value, bounds = keys[error.key], error.bounds
    assert bounds is not None, "of refusals that state some"
    outside = False
    for end, included, inwards in ((bounds.low, bounds.includes_low, 1), (bounds.high, bounds.includes_high, -1)):
        if end is None or (value - end) * inwards > 0.0 or (included and value == end):
            continue
        outside, whole = True, isinstance(value, int)
        inside = end if included else end + inwards * (1 if whole else INSIDE * (abs(end) or 1.0))
        beyond = end - inwards * (1 if whole else BEYOND * (abs(end) or 1.0))
        if (rough := NEAREST_REFUSED.search(error.allowed)) is not None:
            beyond = float(rough[1])
        told = refusal(cls, {**keys, error.key: int(inside) if whole else inside}, diagnosed=False)
        if told is None:
            found.built += 1
        elif FOLLOWED in str(error):
            found.followed += 1
        else:
            yield f"refused when it is put back, {told}"
        if refusal(cls, {**keys, error.key: int(beyond) if whole else beyond}, diagnosed=False) is None:
            yield f"{beyond:.6g} is accepted"
    if not outside:
        yield "the bounds do not exclude the value"
