"""Largest errors with which all criteria hold, searched one key at a time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gearmesh.answers.load.loaded import required_torques
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.design.dotted import values_of, with_keys
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.study.plan import KeyReader
from gearmesh.study.rows.largest import SEARCH_STEPS, largest
from gearmesh.study.rows.work import StudyWork, displacing_keys, own_keys
from gearmesh.study.statistics import Limit, as_number, limit_of
from gearmesh.study.study import work_and_nominal
from gearmesh.systems.designs import parse
from gearmesh.systems.system import complete_design

#: distance that is searched each way from the design's own value, as a text in the unit of the key
DEFAULT_REACH = "1"
#: estimate of the solved values of a key, for the progress: the steps each way and the roots between two steps
ESTIMATED_ROWS_PER_KEY = 2 * SEARCH_STEPS + 12
#: largest progress that is reported before a key is finished
MAX_UNFINISHED_PROGRESS = 0.97


@dataclass(frozen=True)
class LargestFigures(Figures):
    """The largest value of a key one way."""

    key: str = figure("key of the design")
    way: int = figure("way in which the key changes: 1 or -1", whole=True)
    value: float = figure("largest value with which all criteria hold, in the design's units")
    fails: str | None = figure("criterion that fails beyond it; none if all hold in the range searched")
    there: float | None = figure(
        "figure of this criterion at the largest value, which is next to its limit", key="figure"
    )


@dataclass(frozen=True)
class KeyRange(Figures):
    """The values of a key between which all criteria hold."""

    key: str = figure("key of the design")
    low: float = figure("smallest value, in the design's units")
    high: float = figure("largest value, in the design's units")


@dataclass(frozen=True, repr=False)
class LargestErrors(Result):
    """Largest value of each key in each direction (+1, -1) with which all criteria hold, in the design's units.

    A row names the criterion that fails beyond the value, and its figure at the value. Both are None if all criteria hold in
    the range that is searched.
    """

    design: Design
    criteria: tuple[Limit, ...]
    rows: list[LargestFigures]

    @property
    def headline(self) -> str:
        return ", ".join(f"{range.key} {range.low:.4g} to {range.high:.4g}" for range in self.ranges)

    @property
    def ranges(self) -> list[KeyRange]:
        """Values between which all criteria hold, one range per key."""
        low = {row.key: row.value for row in self.rows if row.way < 0}
        return [KeyRange(row.key, low[row.key], row.value) for row in self.rows if row.way > 0]

    @property
    def listings(self) -> list[Listing]:
        heads = ["key", "way", "largest", "fails beyond it", "its figure"]
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
    level: str = "full",
    pair: int | str = 0,
    progress: Callable[[float, str], None] | None = None,
) -> LargestErrors:
    """Return the largest errors; arguments as for `Gears.largest_errors`."""
    reaches = dict(keys) if isinstance(keys, Mapping) else dict.fromkeys(keys, DEFAULT_REACH)
    if not criteria:
        raise ArgumentError("criteria", [], must_be="one limit at least, as contact_ratio>1")
    limits = tuple(limit_of(text, None) for text in criteria)
    if torque is not None:
        required_torques(torque)
    distances = {key: _reach(design, key, reach) for key, reach in reaches.items()}
    searched = {key: _ends(complete_design(design), key, distances[key]) for key in distances}
    figures = tuple(dict.fromkeys(limit.figure for limit in limits))
    work, nominal = work_and_nominal(design, (), pair, figures, torque, level)
    for limit in limits:
        value = as_number(nominal[limit.figure])
        if not limit.holds(np.array([value]))[0]:
            raise ArgumentError(
                "limit",
                entry=limit.text,
                reason=f"the design itself does not meet it: {f'{value:.6g}' if np.isfinite(value) else 'the figure is missing'}",
            )
    rows = []
    for number, (key, (start, ends)) in enumerate(searched.items()):

        def after(count: int, number: int = number, key: str = key) -> None:
            if progress is not None:
                progress(
                    (number + min(count / ESTIMATED_ROWS_PER_KEY, MAX_UNFINISHED_PROGRESS)) / len(searched),
                    f"limits of {key}",
                )

        after(0)
        rows += _of_key(replace(work, keys=(key,)), nominal, limits, start, ends, after)
    return LargestErrors(design, limits, rows)


def _reach(design: Design, key: str, reach: str | float) -> float:
    """Return the distance that is searched from the key's own value. Raises ArgumentError if it is not above 0."""
    distance = KeyReader(design, "find_limits").number(key, reach)
    if not distance > 0.0:
        raise ArgumentError("find_limits", reach, entry=key, must_be="above 0, the distance to search")
    return distance


def _ends(design: Design, key: str, far: float) -> tuple[float, Array]:
    """Return the design's own value of a key, and the ends (2,) of the search below and above it."""
    start = dict(values_of(design.resolve())).get(key)
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
    """Return the figures of a key; `after` is called with the number of its values solved so far."""
    known: dict[float, list[float]] = {}

    def rooms(values: Array) -> Array:
        """Return the distances (C, N) of all criteria from their limits, relative to those of the design."""
        new = [value for value in dict.fromkeys(values.tolist()) if value not in known]
        for value, row in zip(new, work([(value,) for value in new]), strict=True):
            known[value] = [as_number(value) for value in row[:-1]]
        after(len(known))
        table = np.array([known[value] for value in values.tolist()])
        return np.stack(
            [
                limit.room(table[:, work.names.index(limit.figure)])
                / abs(limit.room(np.array([as_number(nominal[limit.figure])]))[0])
                for limit in criteria
            ]
        )

    bounds = largest(lambda values: rooms(values).min(axis=0), start, ends)
    rows = []
    for way, value, beyond in zip((-1, 1), bounds.values.tolist(), bounds.beyond.tolist(), strict=True):
        fails, failing_figure = None, None
        if np.isfinite(beyond):
            room = rooms(np.array([beyond]))[:, 0]
            failing_criterion = criteria[
                int(np.where(room > 0.0, np.inf, np.where(np.isnan(room), -np.inf, room)).argmin())
            ]
            fails, failing_figure = failing_criterion.text, known[value][work.names.index(failing_criterion.figure)]
        rows.append(LargestFigures(work.keys[0], way, value, fails, failing_figure))
    return rows
