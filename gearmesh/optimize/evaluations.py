"""Evaluations of designs: rows of figures from the work of a study, kept in its store, computed by its runners."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field
from functools import cached_property
from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.optimize.error_rows import ErrorRows
from gearmesh.optimize.objectives import Measure, Target
from gearmesh.records import dataclass
from gearmesh.study.plan import Value
from gearmesh.study.rows.work import StudyWork
from gearmesh.study.runners import Run
from gearmesh.study.statistics import as_number
from gearmesh.study.store import Rows, StudyStore


@dataclass(frozen=True)
class Evaluated:
    """A design with its figures."""

    #: values of the varied keys
    values: tuple[Value, ...]
    #: values (O,) of the objectives; NaN where unknown
    objectives: Array
    #: values (C,) of the figures with limits; NaN where unknown
    limited: Array
    #: room (C,) up to the limits, relative to them
    room: Array
    #: mean over the errors of every recorded figure; None if unknown
    means: tuple[float | None, ...]
    #: reason why it has no figures; "" if it has all
    reason: str

    @property
    def feasible(self) -> bool:
        """True if the design has its figures and keeps all limits."""
        return not self.reason and bool((self.room > 0.0).all())

    @property
    def violation(self) -> float:
        """Sum of the relative violations: 0 only if all limits are kept, infinite for a failed design."""
        if self.reason or self.feasible:
            return float("inf") if self.reason else 0.0
        # a figure on its limit does not keep it
        return max(float(np.maximum(-self.room, 0.0).sum()), float(np.finfo(float).tiny))


@dataclass
class Evaluations:
    """Designs evaluated so far; each is computed once, however often it is asked for."""

    #: objectives and constraints
    target: Target
    #: value of a figure over the rows of all errors
    measure: Measure
    #: errors with which each design is evaluated
    errors: ErrorRows
    #: varied keys
    keys: tuple[str, ...]
    #: work of rows with the varied keys and the errors
    work: StudyWork
    #: rows computed so far, in memory or in a file
    store: StudyStore
    #: runner of rows
    run: Run[Any]
    #: called after each computed design
    report: Callable[[Evaluations], None]
    #: designs in the order in which they were asked for
    asked: dict[tuple[Value, ...], Evaluated] = field(default_factory=dict)
    #: designs that are computed, but not among `asked` yet
    in_work: int = 0

    @cached_property
    def _kept(self) -> dict[tuple[Value, ...], Rows]:
        """Rows in the store, by the values of the varied keys."""
        return {self._values(rows): rows for _, rows in sorted(self.store.chunks.items())}

    def _values(self, rows: Rows) -> tuple[Value, ...]:
        first = len(self.target.recorded)
        return tuple(rows[0][first : first + len(self.keys)])

    def __call__(self, designs: Sequence[tuple[Value, ...]]) -> list[Evaluated]:
        """Return designs with their figures, in order."""
        new = {values: self.errors.rows(self.keys, values) for values in designs if values not in self.asked}
        self._compute(self.work, new)
        for values in new:
            self.asked[values] = self._evaluated(values, self._kept[values])
        self.in_work = 0
        return [self.asked[values] for values in designs]

    def unchanged(self, work: StudyWork, rows: list[tuple[Value, ...]]) -> Evaluated:
        """Return the design itself, by its own work and rows, if it does not set all varied keys."""
        unset: tuple[Any, ...] = (None,) * len(self.keys)
        self._compute(work, {unset: rows})
        return self._evaluated(unset, self._kept[unset])

    def confirmed(self, work: StudyWork, design: Evaluated) -> Evaluated:
        """Return a design with the figures of another work, which are not kept; the design itself if it does not set all
        varied keys."""
        if None in design.values:
            return design
        rows = work(self.errors.rows(self.keys, design.values))
        return self._evaluated(design.values, rows)

    def _compute(self, work: StudyWork, designs: Mapping[tuple[Value, ...], list[tuple[Value, ...]]]) -> None:
        """Compute the rows of designs that are not in the store, and keep them."""
        missing = [values for values in designs if values not in self._kept]
        first = max(self.store.chunks, default=-1) + 1
        chunks = ((first + k, list(designs[values])) for k, values in enumerate(missing))
        for number, rows in self.run(work, chunks):
            values = missing[number - first]
            kept = [[*row[:-1], *values, row[-1]] for row in rows]
            self.store.add(number, kept)
            self._kept[values] = kept
            self.in_work += 1
            self.report(self)

    def _evaluated(self, values: tuple[Value, ...], rows: Rows) -> Evaluated:
        names = self.target.recorded
        table = np.array([[as_number(value) for value in row[: len(names)]] for row in rows]).reshape(len(rows), -1)
        columns = dict(zip(names, table.T, strict=True))
        objectives = np.array([each.of(columns, self.measure) for each in self.target.objectives])
        limited = np.array([each.of(columns, self.measure) for each in self.target.constraints])
        room = np.array(
            [each.room(value) for each, value in zip(self.target.constraints, limited.tolist(), strict=True)]
        )
        reason = next((str(row[-1]) for row in rows if row[-1]), "")
        if not reason:
            unknown = [name for name, column in columns.items() if not np.isfinite(column).all()]
            reason = f"no {', '.join(unknown)}" if unknown else ""
        means = tuple(float(column.mean()) if np.isfinite(column).all() else None for column in columns.values())
        return Evaluated(values, objectives, limited, room, means, reason)

    @property
    def best(self) -> Evaluated | None:
        """Best design of the first objective that keeps all limits; the one nearest to them if none does."""
        return best_of(self.asked.values(), self.target)


def best_of(designs: Iterable[Evaluated], target: Target) -> Evaluated | None:
    """Return the best of some designs by the first objective; None if all have failed."""
    known = [each for each in designs if not each.reason]
    if not known:
        return None
    # of designs that differ by rounding the first one counts
    objective = target.comparable(np.array([each.objectives for each in known]))[:, 0]
    order = np.lexsort((objective, np.array([each.violation for each in known])))
    return known[int(order[0])]


def front_of(designs: Iterable[Evaluated], target: Target) -> list[Evaluated]:
    """Return the designs that keep all limits and that no other one dominates, by the first objective.

    A single objective has no front.
    """
    good = [each for each in designs if each.feasible]
    if not good or len(target.objectives) == 1:
        return []
    table = target.comparable(np.array([each.objectives for each in good]))
    better = (table[:, None] <= table).all(axis=2) & (table[:, None] < table).any(axis=2)
    # of equal designs the first one stays
    equal = (table[:, None] == table).all(axis=2) & (np.arange(len(good))[:, None] < np.arange(len(good)))
    alone = ~(better | equal).any(axis=0)
    order = np.lexsort(table[alone].T[::-1])
    front = [each for each, kept in zip(good, alone.tolist(), strict=True) if kept]
    return [front[k] for k in order.tolist()]
