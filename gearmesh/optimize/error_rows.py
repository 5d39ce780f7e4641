"""Errors over which a design must hold: rows of errors of assembly or of flanks, the same for every design."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import field, replace
from os import PathLike

from gearmesh.errors import ArgumentError
from gearmesh.optimize.variables import Variable
from gearmesh.records import dataclass
from gearmesh.study.plan import KeyReader, Plan, Value, grid, sample_plan
from gearmesh.study.spreads import DISTRIBUTION_PARAMETERS
from gearmesh.study.study import tolerance_spreads


@dataclass(frozen=True)
class ErrorRows:
    """Rows of errors; a single row without keys for an optimisation without errors."""

    #: rows of the errors, in the design's units
    plan: Plan = field(default_factory=lambda: Plan({"": [0.0]}))
    #: keys that are varied, too: their errors are added to the varied values
    added: frozenset[str] = frozenset()

    @property
    def keys(self) -> tuple[str, ...]:
        """Keys that have errors and are not varied."""
        return tuple(key for key in self.plan.keys if key and key not in self.added)

    @property
    def numbers(self) -> dict[str, list[float]]:
        """Columns of the errors that are numbers, by key."""
        columns = {key: column for key, column in self.plan.columns.items() if key}
        return {
            key: [float(value) for value in column]
            for key, column in columns.items()
            if all(isinstance(value, int | float) for value in column)
        }

    def rows(self, keys: Sequence[str], values: Sequence[Value]) -> list[tuple[Value, ...]]:
        """Return the rows (R, n + m) of a design with values (n,) of its varied keys, and of the m `keys` with errors."""
        rows = []
        for number in range(len(self.plan)):
            errors = {key: column[number] for key, column in self.plan.columns.items()}
            own = [
                value + errors[key]  # type: ignore[operator]
                if key in self.added
                else value
                for key, value in zip(keys, values, strict=True)
            ]
            rows.append((*own, *(errors[key] for key in self.keys)))
        return rows


def error_rows(
    read: KeyReader,
    robust: Mapping[str, str] | str | PathLike[str] | None,
    variables: Sequence[Variable],
    count: int,
    seed: int,
    pair: int | str,
) -> ErrorRows:
    """Return the rows of errors: all combinations of lists "A,B,C", or `count` samples of distributions.

    Raises ArgumentError or DesignError naming key, value and what is allowed.
    """
    if robust is None:
        return ErrorRows()
    varied = {each.key: each for each in variables}
    lists = {key: text for key, text in robust.items() if _is_list(text)} if isinstance(robust, Mapping) else {}
    if lists:
        assert isinstance(robust, Mapping)
        for key in robust:
            if key not in lists:
                reason = f"lists A,B,C ({', '.join(lists)}) and distributions cannot be given together"
                raise ArgumentError("robust", entry=key, reason=reason)
        plan = grid({key: replace(read, option="robust").values(key, text) for key, text in lists.items()})
    else:
        text = robust if isinstance(robust, Mapping) else os.fspath(robust)
        spreads = tolerance_spreads(read, text, pair, "robust")
        plan = sample_plan(spreads, count, "lhs", seed)
    for key in plan.keys:
        if key in varied and varied[key].discrete:
            raise ArgumentError("robust", entry=key, reason="is varied over a list, to which no error can be added")
    return ErrorRows(plan, frozenset(key for key in plan.keys if key in varied))


def _is_list(text: str) -> bool:
    return text.partition(":")[0].strip() not in DISTRIBUTION_PARAMETERS and ":" not in text and "," in text
