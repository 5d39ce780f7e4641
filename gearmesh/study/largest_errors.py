"""How large errors may be before a criterion fails, one key at a time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmesh.answers.load.loaded import required_torques
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.study.plan import KeyReader
from gearmesh.study.rows.largest import STEPS, largest
from gearmesh.study.rows.work import StudyWork, displacing_keys, own_keys
from gearmesh.study.statistics import Limit, limit_of
from gearmesh.study.study import work_and_nominal
from gearmesh.systems.designs import parse
from gearmesh.systems.system import complete_design

#: how far is looked, in the unit of a key, where nobody says
REACH = "1"
#: values of a key that are solved, about: steps each way, then places between two; and the part of the work that they are at most
ROWS, MOST = 2 * STEPS + 12, 0.97


@dataclass(frozen=True)
class LargestFigures(Figures):
    """The largest value of a key one way."""

    key: str = figure("key of the design")
    way: int = figure("way in which the key changes: 1 or -1", whole=True)
    value: float = figure("largest value with which all criteria hold, in the design's units")
    fails: str | None = figure("criterion that fails beyond it; none if all hold in the range searched")
    there: float | None = figure("value of the criterion's figure there", key="figure")


@dataclass(frozen=True)
class KeyRange(Figures):
    """The values of a key between which all criteria hold."""

    key: str = figure("key of the design")
    low: float = figure("smallest value, in the design's units")
    high: float = figure("largest value, in the design's units")


@dataclass(frozen=True, repr=False)
class LargestErrors(Result):
    """For each key and way (+1, -1) the largest value, in the design's units, with which all criteria hold, what fails beyond it,
    and the figure of that there; None for what fails where nothing does as far as was looked."""

    design: Design
    criteria: tuple[Limit, ...]
    rows: list[LargestFigures]

    @property
    def headline(self) -> str:
        return ", ".join(f"{range.key} {range.low:.4g} to {range.high:.4g}" for range in self.ranges)

    @property
    def ranges(self) -> list[KeyRange]:
        """The values between which all criteria hold, one per key."""
        low = {row.key: row.value for row in self.rows if row.way < 0}
        return [KeyRange(row.key, low[row.key], row.value) for row in self.rows if row.way > 0]

    @property
    def listings(self) -> list[Listing]:
        heads = ["key", "way", "largest", "fails beyond it", "figure there"]
        rows = [
            [
                row.key,
                "+" if row.way > 0 else "-",
                row.value,
                row.fails or "none within the range searched",
                row.there,
            ]
            for row in self.rows
        ]
        return [
            Listing(
                f"Largest values with which {', '.join(criterion.text for criterion in self.criteria)}", heads, rows
            )
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.design),
            "criteria": [criterion.text for criterion in self.criteria],
            "largest": self.rows,
        }


def largest_errors(
    design: Design,
    keys: Mapping[str, str | float] | Sequence[str],
    criteria: Sequence[str] = ("contact_ratio>1",),
    *,
    torque: Sequence[float] | None = None,
    pair: int | str = 0,
    progress: Callable[[float, str], None] | None = None,
) -> LargestErrors:
    """As `Gears.largest_errors`."""
    reaches = dict(keys) if isinstance(keys, Mapping) else dict.fromkeys(keys, REACH)
    if not criteria:
        raise ArgumentError("criteria", [], must_be="one limit at least, as contact_ratio>1")
    named = tuple(limit_of(text, None) for text in criteria)
    if torque is not None:
        required_torques(torque)
    far = {key: _reach(design, key, reach) for key, reach in reaches.items()}
    looked = {key: _ends(complete_design(design), key, far[key]) for key in far}
    work, nominal = work_and_nominal(design, (), pair, tuple(dict.fromkeys(limit.figure for limit in named)), torque)
    for limit in named:
        own = _number(nominal[limit.figure])
        if not limit.holds(np.array([own]))[0]:
            raise ArgumentError(
                "limit",
                entry=limit.text,
                reason=f"the design itself does not meet it: {f'{own:.6g}' if np.isfinite(own) else 'the figure is missing'}",
            )
    rows = []
    for number, (key, (start, ends)) in enumerate(looked.items()):

        def after(count: int, number: int = number, key: str = key) -> None:
            if progress is not None:
                progress((number + min(count / ROWS, MOST)) / len(looked), f"limits of {key}")

        after(0)
        rows += _of_key(replace(work, keys=(key,)), nominal, named, start, ends, after)
    return LargestErrors(design, named, rows)


def _reach(design: Design, key: str, reach: str | float) -> float:
    """How far from its own value a key is looked at. Raises DesignError for what is no distance."""
    far = KeyReader(design).number(key, reach)
    if not far > 0.0:
        raise ArgumentError("find_limits", reach, entry=key, must_be="above 0, the distance to search")
    return far


def _ends(design: Design, key: str, far: float) -> tuple[float, Array]:
    """The design's own value of a key, and how far down and up (2,) is looked."""
    start = dict(_all_keys(design.resolve())).get(key)
    if not isinstance(start, float):
        raise ArgumentError("find_limits", entry=key, must_be="a key of real numbers that has a value in the design")
    ends = np.array([start - far, start + far])
    if key in displacing_keys(design.kind):
        for end in ends.tolist():
            parse(with_keys(own_keys(design), [(key, end)]))
    return start, ends


def _of_key(
    work: StudyWork,
    nominal: Summary,
    criteria: tuple[Limit, ...],
    start: float,
    ends: Array,
    after: Callable[[int], None],
) -> list[LargestFigures]:
    """The figures of a key; `after` is called with how many values of it are solved."""
    known: dict[float, list[float]] = {}

    def rooms(values: Array) -> Array:
        """Of every criterion (C, N), as a part of what the design itself has."""
        new = [value for value in dict.fromkeys(values.tolist()) if value not in known]
        for value, row in zip(new, work([(value,) for value in new]), strict=True):
            known[value] = [_number(value) for value in row[:-1]]
        after(len(known))
        table = np.array([known[value] for value in values.tolist()])
        return np.stack(
            [
                limit.room(table[:, work.names.index(limit.figure)])
                / abs(limit.room(np.array([_number(nominal[limit.figure])]))[0])
                for limit in criteria
            ]
        )

    bounds = largest(lambda values: rooms(values).min(axis=0), start, ends)
    rows = []
    for way, value, beyond in zip((-1, 1), bounds.values.tolist(), bounds.beyond.tolist(), strict=True):
        fails, there = None, None
        if np.isfinite(beyond):
            room = rooms(np.array([beyond]))[:, 0]
            which = criteria[int(np.where(room > 0.0, np.inf, np.where(np.isnan(room), -np.inf, room)).argmin())]
            fails, there = which.text, known[beyond][work.names.index(which.figure)]
        rows.append(LargestFigures(work.keys[0], way, value, fails, there))
    return rows


def _all_keys(table: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Every key of nested tables with its value, dotted."""
    for name, value in table.items():
        if isinstance(value, Mapping):
            yield from _all_keys(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) else np.nan
