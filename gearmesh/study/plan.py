"""Plans: the values that a study varies, as a grid over lists or as samples of ranges and tolerances, in a fixed order.

Rows of a grid are counted like digits: the last varied key changes fastest. A sample has N points of the unit cube, at
random, as a Latin hypercube or as a Sobol sequence. The distribution of each key maps the points to values, so that the
seed and the number of rows determine them. A Saltelli sample of N points and K keys has N (K + 2) rows: A, B, and for
every key the points A with the key's column of B.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.design.shown import shown_key, value_text
from gearmesh.errors import ArgumentError, DesignError, nearest
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.lengths import LENGTH_EXAMPLES, length
from gearmesh.numerals import parse_number, parse_whole_number
from gearmesh.records import dataclass
from gearmesh.study.spreads import WHOLE_NUMBERS, Spread

#: methods of sampling, the default first
SAMPLE_METHODS = ("lhs", "sobol", "random", "saltelli")
#: limit of the size of a number in a plan
MAX_NUMBER_SIZE = 1e300
#: limit of the rows of a plan
MAX_PLAN_ROWS = 50_000_000
#: significant digits of the values between the ends of a range, so that a third of 0.3 is 0.1
RANGE_DIGITS = 12
#: distance of a sample's share from 0 and 1, at which the values of a normal distribution would be infinite
MIN_SHARE = 1e-12

Value = float | int | str | bool
#: values of a key as they are given: a list, or "low:high:count", "low:high", "a,b,c"
Given = str | Sequence[Value]


@dataclass(frozen=True)
class Plan:
    """Rows of a study, in a fixed order."""

    #: values (N,) by dotted key, in the design's units
    columns: dict[str, list[Value]]
    #: number of values of each key of a grid; () for samples
    shape: tuple[int, ...] = ()
    #: number of points A of a Saltelli sample; 0 for other plans
    points: int = 0
    #: description of the plan, as the summary of the study shows it
    about: Mapping[str, Any] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(self.columns)

    def rows(self, start: int, stop: int) -> list[tuple[Value, ...]]:
        """Return the values of some rows, in the order of the keys.

        `start`: the first row, counted from 0. `stop`: the one after the last.
        """
        return list(zip(*(column[start:stop] for column in self.columns.values()), strict=True))

    @property
    def digest(self) -> str:
        """Fingerprint of all rows."""
        text = json.dumps([list(self.keys), list(self.columns.values())], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def planned(
    vary: Mapping[str, Given],
    tolerances: Callable[[], Mapping[str, Spread]] | None,
    sample: int | None,
    method: str,
    seed: int,
    *,
    values: Callable[[str, Given], Sequence[Value]],
    spread: Callable[[str, Given], Spread],
    missing: str,
) -> Plan:
    """Return a grid of keys, or a sample of keys and tolerances if their number of rows is given.

    - `tolerances`: returns the distributions of keys; None if none are given.
    - `values`, `spread`: read the values of a key of a grid, and the range of one that is sampled.
    - `missing`: reason of the refusal if nothing is varied.

    Raises ArgumentError naming key, value and what is allowed.
    """
    if sample is None:
        if tolerances is not None:
            raise ArgumentError("tolerance", reason="needs sample, the number of rows to draw")
        if not vary:
            raise ArgumentError("vary", reason=missing)
        if method != SAMPLE_METHODS[0]:
            raise ArgumentError("method", method, reason="needs sample, the number of rows to draw")
        return grid({key: values(key, given) for key, given in vary.items()})
    spreads = {key: spread(key, given) for key, given in vary.items()}
    for key, drawn in tolerances().items() if tolerances is not None else ():
        if key in spreads:
            raise ArgumentError("tolerance", entry=key, reason="vary gives it already")
        spreads[key] = drawn
    if not spreads:
        raise ArgumentError("sample", reason="needs vary (KEY=LOW:HIGH) or tolerance to draw from")
    return sample_plan(spreads, sample, method, seed)


def grid(lists: Mapping[str, Sequence[Value]]) -> Plan:
    """Return all combinations of lists of values."""
    for key, values in lists.items():
        if not len(values):
            raise ArgumentError("vary", entry=key, reason="no values", must_be="one value at least")
    shape = tuple(len(values) for values in lists.values())
    count = int(np.prod([float(n) for n in shape]))
    _refuse_size("vary", count)
    columns: dict[str, list[Value]] = {}
    for k, (key, values) in enumerate(lists.items()):
        repeats = int(np.prod(shape[k + 1 :], dtype=int))
        columns[key] = [value for value in values for _ in range(repeats)] * (count // (repeats * len(values)))
    return Plan(columns, shape, about={"grid": {key: list(values) for key, values in lists.items()}})


def sample_plan(spreads: Mapping[str, Spread], count: int, method: str = "lhs", seed: int = 0) -> Plan:
    """Return `count` samples of spreads, or a Saltelli sample of `count` points.

    Raises ArgumentError if the method is not one of SAMPLE_METHODS.
    """
    if method not in SAMPLE_METHODS:
        raise ArgumentError("method", method, must_be=f"one of {', '.join(SAMPLE_METHODS)}")
    if count < 1:
        raise ArgumentError("sample", count, must_be="a whole number above 0")
    if seed < 0:
        raise ArgumentError("seed", seed, must_be="0 or a whole number above it")
    if method == "saltelli" and count & (count - 1):
        raise ArgumentError(
            "sample", count, must_be="a power of 2 with the method saltelli, which draws N (keys + 2) rows"
        )
    points = count if method == "saltelli" else 0
    _refuse_size("sample", count * (len(spreads) + 2) if points else count)
    shares = np.clip(_shares(len(spreads), count, method, seed), MIN_SHARE, 1.0 - MIN_SHARE)
    columns: dict[str, list[Value]] = {
        key: list(map(int if spread.distribution == WHOLE_NUMBERS else float, spread.at(shares[:, k])))
        for k, (key, spread) in enumerate(spreads.items())
    }
    about = {key: [spread.distribution, *spread.parameters] for key, spread in spreads.items()}
    return Plan(columns, points=points, about={"sample": count, "method": method, "seed": seed, "tolerance": about})


def _shares(keys: int, count: int, method: str, seed: int) -> Array:
    """Return points (count, keys) of the unit cube; (count (keys + 2), keys) for a Saltelli sample."""
    rng = np.random.default_rng(seed)
    if method == "random":
        return rng.random((count, keys))
    if method == "lhs":
        return _latin_hypercube(keys, count, rng)
    from scipy.stats import qmc

    points: Array
    if method == "saltelli":
        both = qmc.Sobol(2 * keys, rng=rng).random(count)
        a, b = both[:, :keys], both[:, keys:]
        points = np.concatenate((a, b, *(np.where(np.arange(keys) == k, b, a) for k in range(keys))))
    else:
        # a Sobol sequence is balanced at powers of 2: draw the next power, and keep its first points
        points = qmc.Sobol(keys, rng=rng).random_base2(max(int(np.ceil(np.log2(count))), 0))[:count]
    return points


def _latin_hypercube(keys: int, count: int, rng: np.random.Generator) -> Array:
    """Return points (count, keys) of the unit cube, one in each layer of each key.

    The points equal those of scipy.stats.qmc.LatinHypercube to the last bit; that class takes half a second to load.
    """
    generator = rng.spawn(1)[0]
    place_in_layer = generator.uniform(size=(count, keys))
    layers = np.tile(np.arange(1, count + 1), (keys, 1))
    for key_layers in layers:
        generator.shuffle(key_layers)
    return np.asarray((layers.T - place_in_layer) / count)


def _refuse_size(option: str, count: int) -> None:
    if count > MAX_PLAN_ROWS:
        raise ArgumentError(option, reason=f"{count} rows", allowed=f"up to {MAX_PLAN_ROWS}")


# ---------------------------------------------------------------- texts


@dataclass(frozen=True)
class KeyReader:
    """Reader of values of the keys of a design; lengths may have units."""

    design: Design
    #: option or argument that gives the keys
    option: str = "vary"

    def number(self, key: str, value: Any) -> float:
        """Return a number in the key's unit. Raises DesignError naming key, value and what is allowed."""
        unit = self._unit(key)
        if isinstance(value, str):
            known = parse_number(value)
            if known is None and unit == "length":
                known = length(value, self.design.units)
            parsed = np.nan if known is None else known
        else:
            # whole numbers too large for a float are refused, too
            number = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < MAX_NUMBER_SIZE
            parsed = float(value) if number else np.nan
        if unit in ("choice", "text", "file", "flag") or not np.isfinite(parsed):
            more = f", or a length with its unit, as {LENGTH_EXAMPLES}" if unit == "length" else ""
            raise DesignError(key, value, shown=value_text(value), must_be=f"a number{more}, to be varied over a range")
        return parsed

    def ends(self, key: str, low: str, high: str) -> tuple[float, float]:
        """Return both ends of a range; an end without a unit has the unit of the other end."""
        return self.number(key, low), self.number(key, high)

    def value(self, key: str, text: Any) -> Value:
        """Return one value of a list in the type of the key."""
        unit = self._unit(key)
        if unit == "flag":
            if text not in ("true", "false", True, False):
                raise DesignError(key, text, shown=value_text(text), must_be="true or false")
            return text in ("true", True)
        if unit in ("choice", "text", "file"):
            return str(text)
        return self._whole_number(key, self.number(key, text))

    def values(self, key: str, text: str) -> list[Value]:
        """Return the values of "low:high:count" or "a,b,c"."""
        low, *rest = text.split(":")
        if not rest:
            return [self.value(key, part.strip()) for part in text.split(",")]
        count = (parse_whole_number(rest[1]) or 0) if len(rest) == 2 else 0
        if count < 2:
            raise ArgumentError(
                self.option, text, entry=key, must_be="LOW:HIGH:COUNT with 2 values at least, or a list A,B,C"
            )
        first, last = self.ends(key, low, rest[0])
        _refuse_size(self.option, count)
        steps = np.linspace(first, last, count)
        return [self._whole_number(key, float(f"{value:.{RANGE_DIGITS}g}") + 0.0) for value in steps.tolist()]

    def range(self, key: str, text: str) -> Spread:
        """Return the uniform spread of "low:high", from which samples are drawn."""
        low, _, high = text.partition(":")
        ends = self.ends(key, low, high.partition(":")[0])
        if not ends[0] < ends[1]:
            raise ArgumentError(self.option, text, entry=key, must_be="LOW:HIGH, with HIGH above LOW, to be sampled")
        if self._unit(key) == "count":
            raise ArgumentError(
                self.option, text, entry=key, reason="whole numbers can be varied in a grid, not sampled"
            )
        return Spread("uniform", ends)

    def _whole_number(self, key: str, value: float) -> float | int:
        if self._unit(key) != "count":
            return value
        if value != round(value):
            raise DesignError(key, value, must_be="a whole number")
        return round(value)

    def _unit(self, key: str) -> str:
        kind = type(self.design)
        known = kind.key_at(key)
        if known is None or known.most:
            known_keys = [line.key for line in kind.key_lines()]
            close = nearest(key, known_keys)
            hint = f"did you mean {close}?" if close else f"gearmesh describe {self.design.kind} lists them"
            raise ArgumentError(
                self.option,
                entry=shown_key([key]),
                reason=f"{self.design.kind} has no key of this name that can be varied; {hint}",
            )
        return known.unit


def key_and_value(option: str, text: str) -> tuple[str, str]:
    """Return the key and the rest of "key=...". Raises DesignError for another text."""
    key, equals, rest = text.partition("=")
    if not equals or not key.strip() or not rest.strip():
        raise ArgumentError(option, entry=value_text(text), reason="must look like dotted.key=...")
    return key.strip(), rest.strip()
