"""Optimum: the best design of an optimisation, its front, its sensitivities, and all designs that were evaluated."""

from __future__ import annotations

import json
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves, with_keys
from gearmesh.design.files import counted_from, stated_text
from gearmesh.design.rewriting import rewritten
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, at_resolution, figure
from gearmesh.files import csv_table
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX, TOML_SUFFIX
from gearmesh.optimize.error_rows import ErrorRows
from gearmesh.optimize.evaluations import Evaluated, best_of, front_of
from gearmesh.optimize.objectives import Measure, Target, unit_of
from gearmesh.optimize.variables import Variable
from gearmesh.records import dataclass
from gearmesh.study.rows.work import displacing_keys, own_keys
from gearmesh.systems.designs import parse

#: share of the range by which a key leaves the optimum, for its sensitivities
SENSITIVITY_SHARE = 0.05
#: share of its range within which a variable is at the end of the range
END_SHARE = 1e-3
#: file of the best design
BEST_FILE = "best.toml"
#: file of all evaluated designs
TABLE_FILE = "optimum.csv"
#: file of the summary
SUMMARY_FILE = "optimum.json"
#: file of the front
FRONT_FILE = "front.csv"
#: limit of the designs of a front in the table of the terminal
MAX_LISTED_DESIGNS = 20


@dataclass(frozen=True)
class Sensitivity(Figures):
    """Change of an objective, or of a figure with a limit, when one key leaves the optimum."""

    key: str = figure("key of the design")
    changed: str = figure("objective or limit, as it was given", key="figure")
    low_value: float = figure("smaller value of the key, in the design's units")
    high_value: float = figure("larger value of the key, in the design's units")
    low: float | None = figure("figure at the smaller value; none if that design failed")
    best: float = figure("figure at the optimum")
    high: float | None = figure("figure at the larger value; none if that design failed")
    slope: float | None = figure("change of the figure over that of the key, between both values")


@dataclass(frozen=True)
class DesignFigures(Figures):
    """A design of an optimisation, and its figures over all errors."""

    values: Mapping[str, Any] = figure("values of the varied keys, in the design's units; none if the design sets none")
    objectives: Mapping[str, float] = figure("objectives, as they were given")
    limited: Mapping[str, float] = figure("figures with limits, under the torque and with the errors that are worst")
    feasible: bool = figure("whether all limits are kept")
    figures: Mapping[str, float | None] = figure("recorded figures, means over the errors")


@dataclass(frozen=True)
class VariableFigures(Figures):
    """Varied key."""

    key: str = figure("key of the design")
    values: str = figure("range or list of its values, in the design's units")


@dataclass(frozen=True)
class OptimumSummary(Figures):
    """Optimisation and its result."""

    headline: str = figure("the optimisation in one line")
    variables: list[VariableFigures] = figure("varied keys")
    objectives: Mapping[str, str] = figure("objectives, each minimize or maximize")
    subject: list[str] = figure("limits")
    errors: Mapping[str, Any] | None = figure("errors over which figures count, and how; none without", key="robust")
    torque: list[float] = figure("torques on the pinion", "Nm", "T_1")
    method: str = figure("method of the search")
    seed: int = figure("seed", whole=True)
    evaluations: int = figure("number of designs of the search", whole=True)
    failed: int = figure("number of designs that failed", whole=True)
    converged: bool = figure("whether the search ended before its budget, because nothing more was gained")
    before: DesignFigures = figure("the design itself")
    best: DesignFigures = figure("the best design; of several objectives the one nearest to the best of all")
    front: list[DesignFigures] = figure("designs that no other one dominates, by the first objective")
    confirmed: list[DesignFigures] = figure(
        "the design itself and the best one by level full, after a search with level quick"
    )
    sensitivities: list[Sensitivity] = figure("changes of figures when one key leaves the optimum")
    failures: Mapping[str, int] = figure("reasons why designs failed, and of how many", whole=True)
    warnings: list[str] = figure("warnings")


@dataclass(frozen=True, repr=False)
class Optimum(Result):
    """Best design of an optimisation.

    A file with the suffix ".toml" is its design file, ".csv" has all designs that were evaluated.
    """

    #: the design whose keys are varied
    design: Design
    #: varied keys
    _variables: tuple[Variable, ...]
    #: objectives and constraints
    _target: Target
    #: value of a figure over the rows of all errors
    _measure: Measure
    #: errors with which each design is evaluated
    _errors: ErrorRows
    #: method of the search
    method: str
    #: seed of the search
    seed: int
    #: True if the search ended before its budget
    converged: bool
    #: figures of the design itself
    _before: Evaluated
    #: all evaluated designs, in the order of the search
    _evaluated: tuple[Evaluated, ...]
    #: the best design
    _best: Evaluated
    #: variables with the designs beside the best one, at a lower and at a higher value
    _neighbours: tuple[tuple[Variable, Evaluated, Evaluated], ...]
    #: text of the design's file, or None
    source: str | None
    #: the design and the best one by the full model of contact under load, after a search with another one; else None
    _confirmed: tuple[Evaluated, ...] | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (TOML_SUFFIX, JSON_SUFFIX, CSV_SUFFIX)

    @property
    def values(self) -> dict[str, Any]:
        """Values of the varied keys of the best design, in the design's units."""
        return dict(zip(self._keys, self._best.values, strict=True))

    @property
    def torque(self) -> list[float]:
        """Torques on the pinion, Nm."""
        return list(self._target.torque)

    @property
    def error_box(self) -> dict[str, list[float]]:
        """Least, middle and largest value of the first two errors that only move members, in the design's units."""
        moving = displacing_keys(self.design.kind)
        ends = {
            key: [min(column), 0.5 * (min(column) + max(column)), max(column)]
            for key, column in self._errors.numbers.items()
            if key in moving and min(column) < max(column)
        }
        return dict(list(ends.items())[:2])

    @property
    def units(self) -> dict[str, str]:
        """Units of objectives and of figures with limits, by their texts; "" for none."""
        objectives = {each.text: unit_of(each.names[0]) for each in self._target.objectives}
        return {**objectives, **{each.text: unit_of(each.limits[0].figure) for each in self._target.constraints}}

    @property
    def _keys(self) -> tuple[str, ...]:
        return tuple(each.key for each in self._variables)

    @property
    def feasible(self) -> bool:
        """True if the best design keeps all limits, with the full model of contact under load."""
        return self._final.feasible

    @property
    def _final(self) -> Evaluated:
        """Best design with the figures that count at last."""
        return self._best if self._confirmed is None else self._confirmed[1]

    @cached_property
    def best_design(self) -> Design:
        """Best design."""
        return self._design(self._best)

    def _design(self, evaluated: Evaluated) -> Design:
        values = zip(self._keys, evaluated.values, strict=True)
        return parse(with_keys(own_keys(self.design), values))

    @cached_property
    def _front(self) -> list[Evaluated]:
        return front_of(self._evaluated, self._target)

    @cached_property
    def front(self) -> list[Design]:
        """Designs of the front of several objectives, by the first objective; [] for one objective."""
        return [self._design(each) for each in self._front]

    @cached_property
    def sensitivities(self) -> list[Sensitivity]:
        """Changes of all objectives and figures with limits when one key leaves the optimum."""
        names = self._target.texts
        at_best = [*self._best.objectives.tolist(), *self._best.limited.tolist()]
        rows = []
        for variable, low, high in self._neighbours:
            k = self._keys.index(variable.key)
            low_value, high_value = (float(each.values[k]) for each in (low, high))
            for name, best, below, above in zip(
                names, at_best, [*low.objectives, *low.limited], [*high.objectives, *high.limited], strict=True
            ):
                slope = (above - below) / (high_value - low_value)
                rows.append(
                    Sensitivity(
                        variable.key, name, low_value, high_value, _known(below), best, _known(above), _known(slope)
                    )
                )
        return rows

    @property
    def _at_ends(self) -> list[str]:
        """Keys whose best value is at an end of its range."""
        shares = [
            (each.key, each.share(value))
            for each, value in zip(self._variables, self._best.values, strict=True)
            if not each.discrete
        ]
        return [key for key, share in shares if share is not None and not END_SHARE < share < 1.0 - END_SHARE]

    @property
    def failures(self) -> dict[str, int]:
        """Number of designs by their reason for having no figures, most frequent first."""
        return dict(Counter(each.reason for each in self._evaluated if each.reason).most_common())

    @property
    def complaints(self) -> list[str]:
        """Warnings, one line each: limits that no design keeps, better neighbours, keys at the ends of their ranges."""
        lines = []
        if not self.feasible:
            broken = [
                f"{each.text} ({value:.5g})"
                for each, value, room in zip(
                    self._target.constraints, self._final.limited.tolist(), self._final.room.tolist(), strict=True
                )
                if room <= 0.0
            ]
            lines.append(f"no design keeps all limits; the nearest one misses {', '.join(broken)}")
        if self._is_surpassed:
            lines.append("a design beside the best one is better: the search needs a larger budget")
        lines += [f"{key} = {self.values[key]:g} is at the end of its range" for key in self._at_ends]
        return lines

    @property
    def _is_surpassed(self) -> bool:
        """True if a design that was evaluated for the sensitivities is better than the best one, in all objectives."""
        if self._front:
            return all(each is not self._best for each in self._front)
        return best_of(self._evaluated, self._target) is not self._best

    @property
    def headline(self) -> str:
        changes = ", ".join(
            f"{each.text} {before:.4g} -> {after:.4g}{f' {unit}' if (unit := unit_of(each.names[0])) else ''}"
            for each, before, after in zip(
                self._target.objectives,
                self._target.shown(self._before.objectives.tolist()),
                self._target.shown(self._best.objectives.tolist()),
                strict=True,
            )
        )
        return f"{changes}, {len(self._evaluated)} designs"

    def _figures(self, each: Evaluated) -> DesignFigures:
        objectives, constraints = self._target.objectives, self._target.constraints
        return DesignFigures(
            values=dict(zip(self._keys, each.values, strict=True)),
            objectives={own.text: value for own, value in zip(objectives, each.objectives.tolist(), strict=True)},
            limited={own.text: value for own, value in zip(constraints, each.limited.tolist(), strict=True)},
            feasible=each.feasible,
            figures=dict(zip(self._target.recorded, each.means, strict=True)),
        )

    @cached_property
    def summary(self) -> OptimumSummary:
        """Summary of the optimisation."""
        return OptimumSummary(
            headline=self.headline,
            variables=[VariableFigures(each.key, each.text) for each in self._variables],
            objectives={each.text: "minimize" if each.sense < 0 else "maximize" for each in self._target.objectives},
            subject=[each.text for each in self._target.constraints],
            errors={"by": self._measure.text, **self._errors.plan.about} if self._errors.plan.about else None,
            torque=self.torque,
            method=self.method,
            seed=self.seed,
            evaluations=len(self._evaluated),
            failed=sum(self.failures.values()),
            converged=self.converged,
            before=self._figures(self._before),
            best=self._figures(self._best),
            front=[self._figures(each) for each in self._front],
            confirmed=[self._figures(each) for each in self._confirmed or ()],
            sensitivities=self.sensitivities,
            failures=self.failures,
            warnings=self.complaints,
        )

    @property
    def listings(self) -> list[Listing]:
        shown = (self._before, self._best, *(self._confirmed or ()))
        both = [self._target.shown([*each.objectives.tolist(), *each.limited.tolist()]) for each in shown]
        names = self._target.texts
        keys = [
            [key, before, best]
            for key, before, best in zip(self._keys, self._before.values, self._best.values, strict=True)
        ]
        tables = [
            Listing("Keys", ["key", "before", "best"], keys),
            Listing(
                f"Figures: {self.headline}",
                ["figure", "before", "best", *(("before, full", "best, full") if self._confirmed else ())],
                [list(row) for row in zip(names, *both, strict=True)],
            ),
        ]
        if self._front:
            rows = [
                [k, *self._target.shown(each.objectives.tolist()), *each.values]
                for k, each in enumerate(self._front[:MAX_LISTED_DESIGNS], start=1)
            ]
            heads = ["design", *(each.text for each in self._target.objectives), *self._keys]
            tables.append(Listing(f"Front: {len(self._front)} designs that no other one dominates", heads, rows))
        target = self._target
        resolution = {each.text: each.resolution for each in target.objectives}
        resolution |= {each.text: each.resolution for each in target.constraints}
        changes = [
            [
                each.key,
                each.changed,
                each.low_value,
                *at_resolution([each.low, each.best, each.high], resolution[each.changed]),
                each.high_value,
            ]
            for each in self.sensitivities
        ]
        if changes:
            heads = ["key", "figure", "from", "figure there", "best", "figure there", "to"]
            tables.append(Listing("Sensitivities: one key leaves the optimum", heads, changes))
        return tables

    def to_dict(self) -> dict[str, list[Any]]:
        return self._columns(self._evaluated)

    def _columns(self, designs: Sequence[Evaluated]) -> dict[str, list[Any]]:
        """Return designs as columns; "evaluation" counts all designs from 1."""
        number = {each.values: k for k, each in enumerate(self._evaluated, start=1)}
        columns: dict[str, list[Any]] = {"evaluation": [number[each.values] for each in designs]}
        for k, key in enumerate(self._keys):
            columns[key] = [each.values[k] for each in designs]
        for k, objective in enumerate(self._target.objectives):
            columns[objective.text] = [_known(each.objectives[k]) for each in designs]
        for k, constraint in enumerate(self._target.constraints):
            columns[constraint.text] = [_known(each.limited[k]) for each in designs]
        for k, name in enumerate(self._target.recorded):
            # over errors a figure has its mean beside the objective of the same name
            own = name if len(self._errors.plan) == 1 else f"{name}_mean"
            columns[own] = [each.means[k] for each in designs]
        columns["feasible"] = [each.feasible for each in designs]
        front = {each.values for each in self._front}
        columns["front"] = [each.values in front for each in designs]
        columns["reason"] = [each.reason for each in designs]
        return columns

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), **self.summary.row}

    def csv(self, *, front: bool = False) -> str:
        """Return all designs that were evaluated as a table.

        Parameters
        ----------
        front : bool
            Only the designs of the front, by the first objective.

        Returns
        -------
        str
            CSV, one row per design.

        Examples
        --------
        >>> vary = {"pinion.modifications.profile_crowning": "1um:20um"}
        >>> optimum = gears.optimize(vary, "mesh_te_estimate", budget=6, workers=1)
        >>> optimum.csv().splitlines()[0].split(",")[0]
        'evaluation'
        """
        columns = self._columns(self._front if front else self._evaluated)
        return csv_table.csv_text(list(columns), zip(*columns.values(), strict=True))

    def design_text(self, number: int | None = None, folder: str = ".") -> str:
        """Return the text of the design file of the best design, or of one of the front.

        Parameters
        ----------
        number : int, optional
            Number of a design of the front, from 1; by default the best design.
        folder : str
            Folder of the file; names of other files become relative to it.

        Returns
        -------
        str
            TOML: the given source with its comments, in which the varied keys have their new values.

        Raises
        ------
        DesignError
            For a number that the front does not have.

        Examples
        --------
        >>> vary = {"pinion.modifications.profile_crowning": "1um:20um"}
        >>> optimum = gears.optimize(vary, "mesh_te_estimate", budget=6, workers=1)
        >>> "profile_crowning" in optimum.design_text()
        True
        """
        if number is not None and not 1 <= number <= len(self._front):
            raise ArgumentError("number", number, must_be=f"from 1 to {len(self._front)}, the designs of the front")
        design = self._best if number is None else self._front[number - 1]
        values = dict(zip(self._keys, design.values, strict=True))
        own, kind = own_keys(self.design), type(self.design)
        if self.source is None:
            return stated_text(with_keys(own, values.items()), kind, Path(folder))
        read = json.loads(self.source) if self.source.lstrip().startswith("{") else tomllib.loads(self.source)
        # names of files in the source are relative to a folder that is not known here; those of the design are whole
        stated = dict(leaves(own))
        files = {
            key: stated[key]
            for key, _ in leaves(read)
            if (known := kind.key_at(key)) is not None and known.unit == "file" and key in stated
        }
        table = counted_from(with_keys(read, [*files.items(), *values.items()]), kind, Path(folder))
        return rewritten(self.source, dict(leaves(table)))

    def save_all(self, folder: str | PathLike[str]) -> tuple[Path, ...]:
        """Write the best design, all designs, the summary, and of several objectives the front to a folder.

        Parameters
        ----------
        folder : str or os.PathLike
            Existing folder.

        Returns
        -------
        tuple of pathlib.Path
            The files best.toml, optimum.csv, optimum.json and front.csv.

        Raises
        ------
        OutputError
            If a file cannot be written.

        Examples
        --------
        >>> vary = {"pinion.modifications.profile_crowning": "1um:20um"}
        >>> optimum = gears.optimize(vary, "mesh_te_estimate", budget=6, workers=1)
        >>> [path.name for path in optimum.save_all(".")]
        ['best.toml', 'optimum.csv', 'optimum.json']
        """
        from gearmesh.io.atomic import whole_text

        files = [self.save(Path(folder) / name) for name in (BEST_FILE, TABLE_FILE, SUMMARY_FILE)]
        if self._front:
            files.append(Path(folder) / FRONT_FILE)
            whole_text(files[-1], self.csv(front=True))
        return tuple(files)

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        text = self.csv() if target.suffix.lower() == CSV_SUFFIX else self.design_text(folder=str(target.parent))
        whole_text(target, text)


def _known(value: float) -> float | None:
    """Return a number, None if it is not known."""
    return float(value) if np.isfinite(value) else None
