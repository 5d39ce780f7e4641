"""What a study varies: a grid over lists of values, or samples of ranges and tolerances, as rows in a fixed order.

Rows of a grid are counted like digits: the last key that is varied changes fastest. Samples are N points of the unit cube - at
random, as a Latin hypercube or as a Sobol sequence - put through the distribution of every key, so that seed and number of
rows decide them. A Saltelli sample of N points and K keys has N (K + 2) rows: A, B, and for every key A with its column of B.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.design.shown import shown_key, value_text
from gearmesh.errors import ArgumentError, DesignError, nearest
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.lengths import LENGTH_EXAMPLES, length
from gearmesh.numerals import parse_number, parse_whole_number
from gearmesh.study.spreads import WHOLE, Spread

METHODS = ("lhs", "sobol", "random", "saltelli")
#: numbers beyond which no key has any
MOST_NUMBER = 1e300
#: most rows of a plan
MOST = 50_000_000
#: significant digits of the values between the ends of a range, so that a third of 0.3 is 0.1
DIGITS = 12
#: shares of a sample that are as good as 0 and 1
TINY = 1e-12

Value = float | int | str | bool


@dataclass(frozen=True)
class Plan:
    """`columns` (N,) of values by dotted key, in the design's units; `shape`: of a grid the number of values of every key, else ();
    `points`: of a Saltelli sample those of A, else 0; `about`: how it was made."""

    columns: dict[str, list[Value]]
    shape: tuple[int, ...] = ()
    points: int = 0
    about: Mapping[str, Any] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    @property
    def keys(self) -> tuple[str, ...]:
        return tuple(self.columns)

    def rows(self, start: int, stop: int) -> list[tuple[Value, ...]]:
        """Values of some rows, in the order of the keys.

        Parameters
        ----------
        start : int
            The first row, counted from 0.
        stop : int
            The one after the last.

        Returns
        -------
        list of tuple
            One tuple of values a row.

        Examples
        --------
        >>> gears.study({"assembly.dx": "-0.02:0.02:3"}).plan.rows(0, 2)
        [(-0.02,), (0.0,)]
        """
        return list(zip(*(column[start:stop] for column in self.columns.values()), strict=True))

    @property
    def digest(self) -> str:
        """A fingerprint of all rows."""
        text = json.dumps([list(self.keys), list(self.columns.values())], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def grid(lists: Mapping[str, Sequence[Value]]) -> Plan:
    """All combinations of lists of values."""
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
    """`count` samples of spreads, of a Saltelli sample so many points. Raises DesignError for another method than METHODS."""
    if method not in METHODS:
        raise ArgumentError("method", method, must_be=f"one of {', '.join(METHODS)}")
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
    shares = np.clip(_shares(len(spreads), count, method, seed), TINY, 1.0 - TINY)
    columns: dict[str, list[Value]] = {
        key: list(map(int if spread.distribution == WHOLE else float, spread.at(shares[:, k])))
        for k, (key, spread) in enumerate(spreads.items())
    }
    about = {key: [spread.distribution, *spread.parameters] for key, spread in spreads.items()}
    return Plan(columns, points=points, about={"sample": count, "method": method, "seed": seed, "tolerance": about})


def _shares(keys: int, count: int, method: str, seed: int) -> Array:
    """Points (count, keys) of the unit cube; of a Saltelli sample (count (keys + 2), keys)."""
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
        # whole powers of 2 are what a Sobol sequence is balanced at: the first of them
        points = qmc.Sobol(keys, rng=rng).random_base2(max(int(np.ceil(np.log2(count))), 0))[:count]
    return points


def _latin_hypercube(keys: int, count: int, rng: np.random.Generator) -> Array:
    """Points (count, keys) of the unit cube, one in every layer of every key: to the bit those of scipy.stats.qmc.LatinHypercube,
    which takes half a second to load."""
    own = rng.spawn(1)[0]
    inside = own.uniform(size=(count, keys))
    layers = np.tile(np.arange(1, count + 1), (keys, 1))
    for of_key in layers:
        own.shuffle(of_key)
    return np.asarray((layers.T - inside) / count)


def _refuse_size(option: str, count: int) -> None:
    if count > MOST:
        raise ArgumentError(option, reason=f"{count} rows", allowed=f"up to {MOST}")


# ---------------------------------------------------------------- texts


@dataclass(frozen=True)
class KeyReader:
    """Reads values of the keys of a design; lengths may have units."""

    design: Design

    def number(self, key: str, value: Any) -> float:
        """A number in the key's unit. Raises DesignError naming key, value and what is allowed."""
        unit = self._unit(key)
        if isinstance(value, str):
            known = parse_number(value)
            if known is None and unit == "length":
                known = length(value, self.design.units)
            parsed = np.nan if known is None else known
        else:
            # whole numbers beyond those of floats are none either
            number = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < MOST_NUMBER
            parsed = float(value) if number else np.nan
        if unit in ("choice", "text", "file", "flag") or not np.isfinite(parsed):
            more = f", or a length with its unit, as {LENGTH_EXAMPLES}" if unit == "length" else ""
            raise DesignError(key, value, shown=value_text(value), must_be=f"a number{more}, to be varied over a range")
        return parsed

    def ends(self, key: str, low: str, high: str) -> tuple[float, float]:
        """Both ends of a range; the one without a unit has that of the other."""
        return self.number(key, low), self.number(key, high)

    def value(self, key: str, text: Any) -> Value:
        """One value of a list, as the key takes it."""
        unit = self._unit(key)
        if unit == "flag":
            if text not in ("true", "false", True, False):
                raise DesignError(key, text, shown=value_text(text), must_be="true or false")
            return text in ("true", True)
        if unit in ("choice", "text", "file"):
            return str(text)
        return self._whole_number(key, self.number(key, text))

    def values(self, key: str, text: str) -> list[Value]:
        """The values of "low:high:count" or "a,b,c"."""
        low, *rest = text.split(":")
        if not rest:
            return [self.value(key, part.strip()) for part in text.split(",")]
        count = (parse_whole_number(rest[1]) or 0) if len(rest) == 2 else 0
        if count < 2:
            raise ArgumentError(
                "vary", text, entry=key, must_be="LOW:HIGH:COUNT with 2 values at least, or a list A,B,C"
            )
        first, last = self.ends(key, low, rest[0])
        _refuse_size("vary", count)
        steps = np.linspace(first, last, count)
        return [self._whole_number(key, float(f"{value:.{DIGITS}g}") + 0.0) for value in steps.tolist()]

    def range(self, key: str, text: str) -> Spread:
        """The even spread of "low:high", of which samples are taken."""
        low, _, high = text.partition(":")
        ends = self.ends(key, low, high.partition(":")[0])
        if not ends[0] < ends[1]:
            raise ArgumentError("vary", text, entry=key, must_be="LOW:HIGH, with HIGH above LOW, to be sampled")
        if self._unit(key) == "count":
            raise ArgumentError("vary", text, entry=key, reason="whole numbers can be varied in a grid, not sampled")
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
            every = [line.key for line in kind.key_lines()]
            close = nearest(key, every)
            hint = f"did you mean {close}?" if close else f"gearmesh describe {self.design.kind} lists them"
            raise ArgumentError(
                "vary",
                entry=shown_key([key]),
                reason=f"{self.design.kind} has no key of this name that can be varied; {hint}",
            )
        return known.unit


def key_and_value(option: str, text: str) -> tuple[str, str]:
    """Key and the rest of "key=...". Raises DesignError for another text."""
    key, equals, rest = text.partition("=")
    if not equals or not key.strip() or not rest.strip():
        raise ArgumentError(option, entry=value_text(text), reason="must look like dotted.key=...")
    return key.strip(), rest.strip()
