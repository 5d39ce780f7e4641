"""How large errors may be before a criterion fails, one key at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.api.result import Result, columns, header
from gearmesh.api.study import recorded
from gearmesh.api.study_work import displacing_keys, own_keys, with_keys
from gearmesh.api.tables import Listing
from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array
from gearmesh.study.largest import largest
from gearmesh.study.plan import KeyReader
from gearmesh.study.statistics import Limit, limit_of
from gearmesh.systems.designs import parse

#: how far is looked, in the unit of a key, where nobody says
REACH = "1"


@dataclass(frozen=True, repr=False)
class LargestErrors(Result):
    """For each key and way (+1, -1) the largest value, in the design's units, with which all criteria hold, what fails beyond it,
    and the figure of that there; None for what fails where nothing does as far as was looked."""

    design: Design
    criteria: tuple[Limit, ...]
    rows: list[dict[str, Any]]

    @property
    def headline(self) -> str:
        return ", ".join(f"{row['key']} {row['low']:.4g} to {row['high']:.4g}" for row in self.ranges)

    @property
    def ranges(self) -> list[dict[str, Any]]:
        """One dict a key: the values between which all criteria hold."""
        low = {row["key"]: row["value"] for row in self.rows if row["way"] < 0}
        return [
            {"key": row["key"], "low": low[row["key"]], "high": row["value"]} for row in self.rows if row["way"] > 0
        ]

    @property
    def listings(self) -> list[Listing]:
        heads = ["key", "way", "largest", "fails beyond it", "figure there"]
        rows = [
            [
                row["key"],
                "+" if row["way"] > 0 else "-",
                row["value"],
                row["fails"] or "nothing, as far as looked",
                row["figure"],
            ]
            for row in self.rows
        ]
        return [Listing(f"Largest values with which {', '.join(each.text for each in self.criteria)}", heads, rows)]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.rows)

    def document(self) -> dict[str, Any]:
        return {**header(self.design), "criteria": [each.text for each in self.criteria], "largest": self.rows}


def largest_errors(
    design: Design,
    keys: Mapping[str, str | float] | Sequence[str],
    criteria: Sequence[str] = ("contact_ratio>1",),
    *,
    pair: int | str = 0,
    progress: Callable[[float, str], None] | None = None,
) -> LargestErrors:
    """As `Gears.largest_errors`."""
    reaches = dict(keys) if isinstance(keys, Mapping) else dict.fromkeys(keys, REACH)
    read, rows = KeyReader(design), []
    named = tuple(limit_of(text, None) for text in criteria)
    figures = tuple(dict.fromkeys(each.figure for each in named))
    for number, (key, reach) in enumerate(reaches.items()):
        far = read.number(key, reach)
        if not far > 0.0:
            raise DesignError(f"--find-limits {key} = {reach}: must be above 0, how far is looked")
        if progress is not None:
            progress(number / len(reaches), f"limits of {key}")
        rows += _of_key(design, key, far, named, figures, pair)
    return LargestErrors(design, named, rows)


def _of_key(
    design: Design, key: str, far: float, criteria: tuple[Limit, ...], figures: tuple[str, ...], pair: int | str
) -> list[dict[str, Any]]:
    work, nominal = recorded(design, (key,), pair, figures)
    own = own_keys(design)
    for limit in criteria:
        if not limit.holds(np.array([_number(nominal[limit.figure])]))[0]:
            raise DesignError(
                f"--limit {limit.text}: fails for the design itself: {_number(nominal[limit.figure]):.6g}"
            )
    value = dict(_all_keys(design)).get(key)
    if not isinstance(value, float):
        raise DesignError(
            f"--find-limits {key}: has no value in the design to begin at; allowed are keys of real numbers that it has"
        )
    start = value
    ends = np.array([start - far, start + far])
    if key in displacing_keys(design.kind):
        for end in ends.tolist():
            parse(with_keys(own, {key: end}))
    known: dict[float, list[float]] = {}

    def rooms(values: Array) -> Array:
        """Of every criterion (C, N), as a part of what the design itself has."""
        new = [value for value in dict.fromkeys(values.tolist()) if value not in known]
        for value, row in zip(new, work([(value,) for value in new]), strict=True):
            known[value] = [_number(each) for each in row[:-1]]
        table = np.array([known[value] for value in values.tolist()])
        return np.stack(
            [
                limit.room(table[:, work.names.index(limit.figure)])
                / abs(limit.room(np.array([_number(nominal[limit.figure])]))[0])
                for limit in criteria
            ]
        )

    found = largest(lambda values: rooms(values).min(axis=0), start, ends)
    rows = []
    for way, value, beyond in zip((-1, 1), found.values.tolist(), found.beyond.tolist(), strict=True):
        row: dict[str, Any] = {"key": key, "way": way, "value": value, "fails": None, "figure": None}
        if np.isfinite(beyond):
            there = rooms(np.array([beyond]))[:, 0]
            which = criteria[int(np.where(there > 0.0, np.inf, np.where(np.isnan(there), -np.inf, there)).argmin())]
            row |= {"fails": which.text, "figure": known[beyond][work.names.index(which.figure)]}
        rows.append(row)
    return rows


def _all_keys(design: Design) -> list[tuple[str, Any]]:
    """Every key of a design with its value, dotted."""
    found: list[tuple[str, Any]] = []

    def walk(table: Mapping[str, Any], prefix: str) -> None:
        for name, value in table.items():
            if isinstance(value, Mapping):
                walk(value, f"{prefix}{name}.")
            else:
                found.append((prefix + name, value))

    walk(design.resolved(), "")
    return found


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) else np.nan
