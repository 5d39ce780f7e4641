"""Spreads of keys of a design: distributions of tolerances, read from texts such as "normal:0:20um" and from TOML
files.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from gearmesh.design.shown import shown_key, value_text
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.files.reading import BYTES_PER_MIB, read_toml
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: limit of the size of a file of tolerances, bytes
MAX_FILE_BYTES = BYTES_PER_MIB
#: parameters of each distribution, in the order of a text
DISTRIBUTION_PARAMETERS = {
    "normal": ("mean", "sigma"),
    "uniform": ("low", "high"),
    "triangular": ("low", "mode", "high"),
    "truncated": ("mean", "sigma", "low", "high"),
}
#: characters of a wrong text that its refusal repeats, so that the line stays short
LONGEST_SHOWN_TEXT = 60
#: distribution of whole numbers from low to high - 1; only seeds and classes have it, no text names it
WHOLE_NUMBERS = "whole"

#: a number that a text or a file gives, in the unit of its key; raises DesignError
Reader = Callable[[str, Any], float]


@dataclass(frozen=True)
class Spread:
    """Distribution of a key and its parameters, in the unit of the key.

    "truncated" is normal between two limits. WHOLE_NUMBERS has whole numbers from the first parameter up to, but
    without, the second.
    """

    distribution: str
    parameters: tuple[float, ...]

    def at(self, share: Array) -> Array:
        """Return the values (N,) at cumulative probabilities `share` (N,), 0 to 1."""
        if self.distribution == WHOLE_NUMBERS:
            low, high = self.parameters
            return np.floor(low + share * (high - low))
        p = dict(zip(DISTRIBUTION_PARAMETERS[self.distribution], self.parameters, strict=True))
        values: Array
        if self.distribution == "normal":
            # scipy.stats as a whole takes seven times as long to load as this function
            from scipy.special import ndtri

            values = ndtri(share) * p["sigma"] + p["mean"]
        elif self.distribution == "uniform":
            values = p["low"] + share * (p["high"] - p["low"])
        elif self.distribution == "triangular":
            width = p["high"] - p["low"]
            mode = (p["mode"] - p["low"]) / width
            rising, falling = np.sqrt(mode * share), 1.0 - np.sqrt((1.0 - mode) * (1.0 - share))
            values = np.where(share < mode, rising, falling) * width + p["low"]
        else:
            from scipy.stats import truncnorm

            ends = [(p[key] - p["mean"]) / p["sigma"] for key in ("low", "high")]
            values = truncnorm.ppf(share, *ends, loc=p["mean"], scale=p["sigma"])
        return values


def spread_of(key: str, words: list[Any], read: Reader) -> Spread:
    """Return the spread of a key from its distribution and parameters.

    Raises ArgumentError naming the key and what is allowed.
    """
    name, *values = words
    names = DISTRIBUTION_PARAMETERS.get(name) if isinstance(name, str) else None
    if names is None or len(values) != len(names):
        forms = ", ".join(":".join((form, *parts)) for form, parts in DISTRIBUTION_PARAMETERS.items())
        text = ":".join(map(str, words))
        shown = text if len(text) <= LONGEST_SHOWN_TEXT else text[:LONGEST_SHOWN_TEXT] + "..."
        raise ArgumentError("tolerance", text, shown=shown, entry=key, must_be=f"one of {forms}")
    parameters = dict(zip(names, (read(key, value) for value in values), strict=True))
    _refuse_disorder(key, name, parameters)
    return Spread(name, tuple(parameters.values()))


def _refuse_disorder(key: str, name: str, parameters: Mapping[str, float]) -> None:
    if "sigma" in parameters and not 0.0 < parameters["sigma"] < math.inf:
        raise ArgumentError("tolerance", entry=key, reason=f"sigma = {parameters['sigma']:g}: must be above 0")
    if "low" in parameters and not parameters["low"] < parameters["high"]:
        raise ArgumentError(
            "tolerance", entry=key, reason=f"high = {parameters['high']:g}: must be above low, {parameters['low']:g}"
        )
    if name == "triangular" and not parameters["low"] <= parameters["mode"] <= parameters["high"]:
        raise ArgumentError(
            "tolerance", entry=key, reason=f"mode = {parameters['mode']:g}: must be between low and high"
        )


def read_spreads(path: str, read: Reader) -> dict[str, Spread]:
    """Return the spreads of a TOML file with lines as key = { distribution = "normal", mean = 0, sigma = "20um" }
    or key = "normal:0:20um".

    The default of `mean` is 0 in tables. Raises ArgumentError naming file or key, and what is allowed.
    """
    try:
        tables = read_toml(path, MAX_FILE_BYTES, "file of tolerances")
    except DesignError as failure:
        raise ArgumentError("tolerance", entry=failure.key, reason=failure.reason) from None
    return {
        key: spread_of(key, list(entry.split(":")), read) if isinstance(entry, str) else _of_table(key, entry, read)
        for key, entry in _entries(tables, "")
    }


def _entries(table: Mapping[str, Any], prefix: str) -> list[tuple[str, Mapping[str, Any] | str]]:
    """Return the keys of a file with their distributions, each a table or a text."""
    entries: list[tuple[str, Mapping[str, Any] | str]] = []
    for name, below in table.items():
        if isinstance(below, str) or (isinstance(below, Mapping) and "distribution" in below):
            entries.append((prefix + name, below))
        elif isinstance(below, Mapping):
            entries += _entries(below, f"{prefix}{name}.")
        else:
            shown = shown_key([*prefix.split(".")[:-1], name])
            raise ArgumentError(
                "tolerance",
                below,
                shown=value_text(below),
                entry=shown,
                must_be='a distribution, as "normal:0:20um" or { distribution = "normal", mean = 0, sigma = "20um" }',
            )
    return entries


def _of_table(key: str, table: Mapping[str, Any], read: Reader) -> Spread:
    name, shown = table["distribution"], shown_key(key.split("."))
    if not isinstance(name, str) or name not in DISTRIBUTION_PARAMETERS:
        raise ArgumentError(
            "tolerance",
            entry=shown,
            reason=f"distribution = {value_text(name)}: must be one of {', '.join(DISTRIBUTION_PARAMETERS)}",
        )
    wanted = DISTRIBUTION_PARAMETERS[name]
    known = {"mean": 0.0, **table} if "mean" in wanted else dict(table)
    for parameter in (*wanted, *known):
        if parameter not in known or parameter not in (*wanted, "distribution"):
            what = "missing" if parameter not in known else "not a parameter"
            raise ArgumentError(
                "tolerance", entry=shown, reason=f"{shown_key([parameter])}: {what}; {name} has {', '.join(wanted)}"
            )
    return spread_of(key, [name, *(known[parameter] for parameter in wanted)], read)
