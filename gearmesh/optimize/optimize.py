"""Optimisation of a design: the values of its keys at which figures are best."""

from __future__ import annotations

import math
import os
import re
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from gearmesh import __version__
from gearmesh.answers.load.loaded import required_level
from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves
from gearmesh.errors import ArgumentError
from gearmesh.numerals import parse_number, parse_whole_number
from gearmesh.optimize.error_rows import ErrorRows, error_rows
from gearmesh.optimize.evaluations import Evaluated, Evaluations, best_of, front_of
from gearmesh.optimize.objectives import Measure, OptimumRequest, Target, measure_of, request_of, unit_of
from gearmesh.optimize.optimum import SENSITIVITY_SHARE, Optimum
from gearmesh.optimize.searches import Search, method_of
from gearmesh.optimize.variables import Variable, variables_of
from gearmesh.progress import Progress
from gearmesh.records import dataclass
from gearmesh.study import runners
from gearmesh.study.plan import KeyReader, Value
from gearmesh.study.rows.work import StudyWork
from gearmesh.study.store import StudyStore
from gearmesh.study.study import work_and_nominal
from gearmesh.systems import system as systems

if TYPE_CHECKING:
    from gearmesh.study.runners import Scheduler

#: evaluations of an optimisation, by default
DEFAULT_BUDGET = 100
#: limit of the evaluations
MAX_EVALUATIONS = 1_000_000
#: fewest evaluations of an optimisation, beyond one per variable
MIN_EVALUATIONS = 5
#: seconds of the units of a budget of time
SECONDS_BY_UNIT = {"s": 1.0, "min": 60.0, "h": 3600.0}
#: times that the optimum may move to a better neighbour
MAX_MOVES = 3
#: limit of the objectives of a front
MAX_OBJECTIVES = 3

_TIME_PATTERN = re.compile(r"([\d.]+)\s*(s|min|h)")


@dataclass(frozen=True)
class EvaluationBudget:
    """Number of designs that an optimisation evaluates, or the time it takes."""

    #: number of designs; None for a budget of time
    evaluations: int | None
    #: time of this run, s; infinite for a number of designs
    seconds: float


@dataclass(frozen=True)
class Task:
    """Question of an optimisation, checked; nothing is built yet."""

    #: design whose keys are varied
    design: Design
    #: varied keys
    variables: tuple[Variable, ...]
    #: objectives and constraints as texts name them
    request: OptimumRequest
    #: errors with which each design is evaluated
    errors: ErrorRows
    #: value of a figure over the rows of all errors
    measure: Measure
    #: method of the search
    method: str
    #: number of designs or time of the search
    budget: EvaluationBudget
    #: seed of the search
    seed: int
    #: mesh whose figures are taken, by number or name
    pair: int | str
    #: model of contact under load in the search
    level: str = "full"

    @property
    def keys(self) -> tuple[str, ...]:
        """Varied keys."""
        return tuple(each.key for each in self.variables)


def budget_of(budget: int | str | None, variables: int) -> EvaluationBudget:
    """Return the budget of a number or a text such as "200" or "10min". Raises ArgumentError for another one."""
    if budget is None:
        return EvaluationBudget(max(DEFAULT_BUDGET, variables + MIN_EVALUATIONS), math.inf)
    match = _TIME_PATTERN.fullmatch(budget.strip()) if isinstance(budget, str) else None
    seconds = parse_number(match[1]) if match else None
    if match and seconds is not None and seconds > 0.0:
        return EvaluationBudget(None, seconds * SECONDS_BY_UNIT[match[2]])
    count = parse_whole_number(budget) if isinstance(budget, str) else budget
    least = variables + MIN_EVALUATIONS
    if count is None or not least <= count <= MAX_EVALUATIONS:
        must_be = f"a number of designs from {least} to {MAX_EVALUATIONS}, or a time, as 90s, 10min or 2h"
        raise ArgumentError("budget", budget, must_be=must_be)
    return EvaluationBudget(count, math.inf)


def task_of(
    design: Design,
    vary: Mapping[str, str | Sequence[Value]],
    minimize: Sequence[str],
    maximize: Sequence[str],
    subject: Sequence[str],
    robust: Mapping[str, str] | str | PathLike[str] | None,
    robust_rows: int,
    robust_by: str,
    method: str | None,
    budget: int | str | None,
    seed: int,
    pair: int | str,
    level: str = "full",
) -> Task:
    """Return the task of the arguments of `Gears.optimize`. Raises ArgumentError naming key, value and what is allowed."""
    request = request_of(minimize, maximize, subject)
    if len(request.objectives) > MAX_OBJECTIVES:
        raise ArgumentError(
            "minimize", reason=f"{len(request.objectives)} objectives", allowed=f"up to {MAX_OBJECTIVES}"
        )
    if required_level(level) == "quick" and not request.torque:
        raise ArgumentError("level", level, reason="is for figures under load, as te_peak_to_peak@50")
    if seed < 0:
        raise ArgumentError("seed", seed, must_be="0 or a whole number above it")
    if robust_rows < 2:
        raise ArgumentError("robust_rows", robust_rows, must_be="2 or a whole number above it")
    read = KeyReader(design)
    variables = variables_of(read, vary)
    return Task(
        design,
        variables,
        request,
        error_rows(read, robust, variables, robust_rows, seed, pair),
        measure_of(robust_by),
        method_of(method, variables),
        budget_of(budget, len(variables)),
        seed,
        pair,
        required_level(level),
    )


def optimize(
    task: Task,
    folder: str | PathLike[str] | None,
    workers: int | None,
    scheduler: Scheduler | None,
    source: str | None,
    progress: Progress,
) -> Optimum:
    """Return the optimum of a task; other arguments as for `Gears.optimize`."""
    target = task.request.target(systems.build(task.design).pair(task.pair))
    work, _ = work_and_nominal(
        task.design, (*task.keys, *task.errors.keys), task.pair, target.names, target.torque or None, task.level
    )
    spec = {
        "gearmesh": __version__,
        "design": work.own,
        "pair": task.pair,
        "vary": task.keys,
        "robust": task.errors.plan.digest,
        "record": [*work.names, *task.keys],
        "torque_nm": work.torque,
        **work.level_entry,
        "chunk": len(task.errors.plan),
        "rows": MAX_EVALUATIONS * len(task.errors.plan),
    }
    target = replace(target, recorded=work.names)
    store = StudyStore(folder, spec)
    many = workers if workers is not None else os.cpu_count() or 1
    with store.open(), runners.runner(many, scheduler) as run:
        return _Optimisation(task, target, work, store, run, progress).optimum(source)


class _Optimisation:
    """Optimisation in an open store, with a runner."""

    def __init__(
        self,
        task: Task,
        target: Target,
        work: StudyWork,
        store: StudyStore,
        run: runners.Run[list[list[object]]],
        progress: Progress,
    ) -> None:
        self.task, self.target, self.work, self.progress = task, target, work, progress
        self.evaluations = Evaluations(
            target, task.measure, task.errors, task.keys, work, store, run, report=self._report
        )
        self._begun = time.monotonic()

    def optimum(self, source: str | None) -> Optimum:
        """Search, then evaluate the neighbours of the best design."""
        before = self._before()
        task, target = self.task, self.target
        search = Search(
            task.variables,
            target,
            task.method,
            task.seed,
            task.budget.evaluations,
            self._evaluate,
            lambda: list(self.evaluations.asked.values()),
        )
        converged = search()
        found = tuple(self.evaluations.asked.values())
        best = self._chosen(found)
        for _ in range(MAX_MOVES):
            neighbours = self._neighbours(best)
            around = [each for _, *both in neighbours for each in both]
            better = self._better(best, around)
            if better is best:
                break
            best = better
        else:
            neighbours = self._neighbours(best)
        every = tuple(self.evaluations.asked.values())
        confirmed: tuple[Evaluated, ...] | None = None
        if task.level != "full":
            full = replace(self.work, level="full")
            confirmed = tuple(self.evaluations.confirmed(full, each) for each in (before, best))
        return Optimum(
            task.design,
            task.variables,
            target,
            task.measure,
            task.errors,
            task.method,
            task.seed,
            converged,
            before,
            every,
            best,
            neighbours,
            source,
            confirmed,
        )

    def _before(self) -> Evaluated:
        """Return the design itself; if it is in the ranges, it is the first design of the search."""
        known = dict(leaves(self.task.design.resolve()))
        values = tuple(known[key] for key in self.task.keys if known.get(key) is not None)
        if len(values) == len(self.task.keys):
            inside = all(each.share(value) is not None for each, value in zip(self.task.variables, values, strict=True))
            (before,) = self.evaluations([values])
            if not inside:
                del self.evaluations.asked[values]
            return before
        plan = self.task.errors.plan
        keys = tuple(key for key in plan.keys if key)
        rows: list[tuple[Value, ...]] = plan.rows(0, len(plan)) if keys else [()]
        return self.evaluations.unchanged(replace(self.work, keys=keys), rows)

    def _evaluate(self, designs: list[tuple[Value, ...]]) -> list[Evaluated] | None:
        """Return designs with their figures; None when the budget is spent, which the first of them may use up."""
        if time.monotonic() - self._begun > self.task.budget.seconds:
            return None
        if self.task.budget.evaluations is not None:
            room = self.task.budget.evaluations - len(self.evaluations.asked)
            new = [values for values in dict.fromkeys(designs) if values not in self.evaluations.asked]
            if len(new) > room:
                self.evaluations(new[:room])
                return None
        return self.evaluations(designs)

    def _chosen(self, designs: Sequence[Evaluated]) -> Evaluated:
        """Return the best design; of a front the one whose largest distance from the best values is smallest."""
        front = front_of(designs, self.target)
        if front:
            table = np.array([each.objectives for each in front]) * self.target.signs
            width = np.ptp(table, axis=0)
            distance = ((table - table.min(axis=0)) / np.where(width > 0.0, width, 1.0)).max(axis=1)
            return front[int(distance.argmin())]
        best = best_of(designs, self.target)
        assert best is not None
        return best

    def _better(self, best: Evaluated, around: list[Evaluated]) -> Evaluated:
        """Return the best design or a better one around it; of several objectives one that is better in some and worse in none."""
        if len(self.target.objectives) == 1:
            return self._chosen([best, *around])
        front = front_of([best, *around], self.target)
        if not front or any(each is best for each in front):
            return best
        table = self.target.comparable(np.array([best.objectives, *(each.objectives for each in front)]))
        nowhere_worse = (table[1:] <= table[0]).all(axis=1).tolist()
        return self._chosen(
            [each for each, kept in zip(front, nowhere_worse, strict=True) if kept or not best.feasible]
        )

    def _neighbours(self, best: Evaluated) -> tuple[tuple[Variable, Evaluated, Evaluated], ...]:
        """Return the designs on both sides of the best one along each range or list of numbers, at its end at most."""
        beside = [
            (k, each, both)
            for k, (each, value) in enumerate(zip(self.task.variables, best.values, strict=True))
            if (both := each.beside(value, SENSITIVITY_SHARE)) is not None
        ]
        designs = self.evaluations(
            [(*best.values[:k], value, *best.values[k + 1 :]) for k, _, both in beside for value in both]
        )
        varied = [each for _, each, _ in beside]
        return tuple(zip(varied, designs[::2], designs[1::2], strict=True))

    def _report(self, evaluations: Evaluations) -> None:
        """Report the number of designs and the best one so far."""
        budget, count = self.task.budget, len(evaluations.asked) + evaluations.in_work
        spent = (
            count / budget.evaluations
            if budget.evaluations is not None
            else (time.monotonic() - self._begun) / budget.seconds
        )
        best, first = evaluations.best, self.target.objectives[0]
        unit = unit_of(first.names[0])
        value = "none yet" if best is None else f"{best.objectives[0]:.4g}{f' {unit}' if unit else ''}"
        kept = "" if best is None or best.feasible else ", limits not kept yet"
        self.progress(min(spent, 1.0), f"optimize: best {first.text} {value}{kept}")
