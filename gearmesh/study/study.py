"""Studies: a design with some of its keys varied, with all rows computed, stored and summarized."""

from __future__ import annotations

import math
import os
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from gearmesh import __version__
from gearmesh.answers.load.loaded import required_level, required_torques
from gearmesh.answers.result import Result, StatedDesign, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import ArgumentError, NoSolutionError, OutputError, UnknownFigureError, nearest
from gearmesh.figures import Content, Summary
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX, PARQUET_SUFFIX
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.study.plan import KeyReader, Plan, Value, planned
from gearmesh.study.rows.names import recordable
from gearmesh.study.rows.path_figures import PathFigures, PathShift
from gearmesh.study.rows.patterns import AssemblyContact, assembly_contacts
from gearmesh.study.rows.work import (
    CONTACT_GROUPS,
    LOAD_GROUP,
    NO_CONTACT,
    TURNS_GROUP,
    StudyWork,
    displacing_keys,
    own_keys,
)
from gearmesh.study.spreads import Spread, read_spreads, spread_of
from gearmesh.study.statistics import (
    MIN_LINEAR_R2,
    REPORTED_PERCENTILES,
    Effect,
    Limit,
    as_number,
    effects,
    limit_of,
    percentiles,
)
from gearmesh.study.store import StudyStore
from gearmesh.study.summary import StudySummary
from gearmesh.study.tolerance_class import CLASS_KEY, class_spreads
from gearmesh.study.variance import MIN_FIRST_ORDER_SUM, MIN_SAMPLE_ROWS, VarianceShare, variance_shares
from gearmesh.systems import system as systems
from gearmesh.systems.designs import parse

if TYPE_CHECKING:
    from gearmesh.study.runners import Chunk, Scheduler

#: called with the finished share (0 to 1) of a long computation and a text on what is being computed
Progress = Callable[[float, str], None]

#: smallest number of chunks for which starting processes pays
MIN_PARALLEL_CHUNKS = 8
#: smallest number of chunks under load for which starting processes pays
MIN_PARALLEL_LOADED_CHUNKS = 3
#: limit of the figures that are plotted
MAX_PLOTTED_FIGURES = 4
#: figures that are plotted first if they are recorded
MAIN_FIGURES = (
    "turns_te_peak_to_peak_arcsec",
    "turns_te_tooth_to_tooth_arcsec",
    "mesh_te_peak_to_peak_arcsec",
    "contact_ratio",
    "path_shift_length_mm",
    "path_shift_height_mm",
    "backlash_normal_min_mm",
    "mesh_te_estimate_arcsec",
    "contact_ratio_estimate",
    "loaded_te_peak_to_peak_1_arcsec",
    "max_pressure_1_mpa",
)


class RowWork(Protocol):
    """Function that computes rows of a study, of plain data that can be sent to any worker."""

    @property
    def own(self) -> Mapping[str, Any]:
        """Keys of the unchanged design or train, as nested tables."""

    @property
    def pair(self) -> int | str:
        """Name or number of the pair."""

    @property
    def groups(self) -> tuple[str, ...]:
        """Groups of figures that are computed."""

    @property
    def names(self) -> tuple[str, ...]:
        """Figures that are kept."""

    @property
    def torque(self) -> tuple[float, ...]:
        """Torques, Nm, of figures under load."""

    @property
    def level_entry(self) -> dict[str, str]:
        """Entry of the level of contact under load for what tells studies apart."""

    def chunk_rows(self, rows: int) -> int:
        """Return the number of rows that are computed together in a study of so many `rows`."""

    def __call__(self, rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
        """Return the values of `names` of each row, None where there is no value, and last the reason."""


@dataclass(frozen=True, repr=False)
class Study(Result):
    """Rows of a study as columns of equal length."""

    #: the design, or the train, whose keys are varied
    design: StatedDesign
    #: values of the varied keys, row by row
    plan: Plan
    #: columns (N,) by name: row, varied keys (in the design's units), figures, status (ok, no contact or failed),
    #: reason
    columns: dict[str, list[Any]]
    #: figures of the unchanged design
    nominal: Summary
    #: limits that a good row keeps
    limits: tuple[Limit, ...]
    #: function that computes rows
    _work: RowWork

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX, PARQUET_SUFFIX)

    @property
    def figures(self) -> tuple[str, ...]:
        """Names of the recorded figures."""
        return self._work.names

    @property
    def rows(self) -> dict[str, Array]:
        """Columns as arrays (N,): numbers as floats, NaN where there is no value."""
        return {name: self.numbers(name) if name in self.figures else np.array(v) for name, v in self.columns.items()}

    def numbers(self, name: str) -> Array:
        """Return one column as numbers.

        Parameters
        ----------
        name : str
            Name of a varied key or of a figure.

        Returns
        -------
        ndarray, (N,)
            NaN where there is no value or a text.

        Examples
        --------
        >>> study = gears.study({"assembly.dx": "0:0.1:2"}, record="cycle", workers=1)
        >>> study.numbers("assembly.dx")
        array([0. , 0.1])
        """
        if name not in self.columns:
            raise UnknownFigureError.among(name, self.columns)
        return np.array([as_number(value) for value in self.columns[name]], dtype=float)

    @property
    def plotted_figures(self) -> list[str]:
        """Figures that the plots show: figures with limits first."""
        wanted = dict.fromkeys([*(limit.figure for limit in self.limits), *MAIN_FIGURES, *self.figures])
        many = [name for name in wanted if name in self.figures and np.isfinite(self.numbers(name)).any()]
        return many[:MAX_PLOTTED_FIGURES]

    @property
    def good(self) -> float | None:
        """Yield: share of all rows that keep every limit; None without limits."""
        if not self.limits:
            return None
        return float(np.all([limit.holds(self.numbers(limit.figure)) for limit in self.limits], axis=0).mean())

    @cached_property
    def effects(self) -> list[Effect]:
        """Effects of each key on each plotted figure by linear regression, largest first.

        They rank the keys if R^2 is high.
        """
        keys = self._numeric
        return (
            [effect for name in self.plotted_figures for effect in effects(keys, name, self.numbers(name))]
            if keys
            else []
        )

    @cached_property
    def variance(self) -> list[VarianceShare]:
        """Share of each key in the variance of each plotted figure, largest first; valid for responses of any shape."""
        keys = self._numeric
        return [
            share
            for name in self.plotted_figures
            for share in (variance_shares(self.plan, keys, name, self.numbers(name)) if keys else [])
        ]

    @property
    def _numeric(self) -> dict[str, Array]:
        """Values of the varied keys that are numbers."""
        keys = {key: self.numbers(key) for key in self.plan.keys}
        return {key: values for key, values in keys.items() if np.isfinite(values).all()}

    @property
    def complaints(self) -> list[str]:
        """Warnings, one line for each figure whose slopes do not rank several keys."""
        if len(self._numeric) < 2:
            return []
        shares = self.variance
        lines = []
        for name, share in {effect.figure: effect.explained for effect in self.effects if not effect.linear}.items():
            advice = _ranking([share for share in shares if share.figure == name])
            lines.append(
                f"{name} is not linear in the keys (R^2 = {share:.2g}, below {MIN_LINEAR_R2:g}): "
                f"its slopes do not rank the keys; {advice}"
            )
        return lines

    @property
    def failures(self) -> dict[str, int]:
        """Number of rows by their reason for having no figures."""
        return dict(Counter(filter(None, self.columns["reason"])).most_common())

    @property
    def headline(self) -> str:
        count = self.columns["status"].count("ok")
        good = "" if self.good is None else f", yield {100.0 * self.good:.4g} %"
        return f"{len(self.plan)} rows over {', '.join(self.plan.keys)}, {count} with contact{good}"

    @cached_property
    def summary(self) -> StudySummary:
        """Summary of all rows."""
        return StudySummary(
            headline=self.headline,
            plan={"rows": len(self.plan), **self.plan.about},
            torque=list(self._work.torque) or None,
            nominal=self.nominal,
            percentiles={
                name: dict(zip(map(str, REPORTED_PERCENTILES), percentiles(self.numbers(name)), strict=True))
                for name in dict.fromkeys([*self.plotted_figures, *self.figures])
            },
            sensitivities=self.effects,
            variance=self.variance,
            warnings=self.complaints,
            limits={limit.text: float(limit.holds(self.numbers(limit.figure)).mean()) for limit in self.limits},
            good=self.good,
            failures=self.failures,
        )

    @property
    def listings(self) -> list[Listing]:
        return self.summary.tables

    def to_dict(self) -> dict[str, list[Any]]:
        return dict(self.columns)

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), **Summary(self.summary)}

    def csv(self) -> str:
        """Return the rows as a table.

        Returns
        -------
        str
            CSV, one row per row of the study.

        Examples
        --------
        >>> len(gears.study({"assembly.dx": "0:0.1:2"}, record="cycle", workers=1).csv().splitlines())
        3
        """
        from gearmesh.study.table import csv_text

        return csv_text(self.columns)

    def _write(self, target: Path) -> None:
        from gearmesh.study.table import write_csv, write_parquet

        (write_csv if target.suffix.lower() == CSV_SUFFIX else write_parquet)(target, self.columns)

    def assemblies(self) -> list[AssemblyContact | str]:
        """Return the contact of every row, to be drawn.

        Returns
        -------
        list of AssemblyContact or str
            A str is the reason why a row has no contact. Rows of a train have no contact to draw: the list is empty.

        Examples
        --------
        >>> len(gears.study({"assembly.dx": "0:0.1:2"}, record="path", workers=1).assemblies())
        2
        """
        if not isinstance(self._work, StudyWork):
            return []
        return assembly_contacts(self._work, self.plan.rows(0, len(self.plan)))


def _ranking(shares: Sequence[VarianceShare]) -> str:
    """Return advice on the order of keys from their shares of a figure's variance."""
    if not shares:
        return (
            f"use a sample of which {MIN_SAMPLE_ROWS} rows or more have it; "
            "so few rows, or an incomplete grid, do not rank them either"
        )
    alone = sum(share.first for share in shares)
    if shares[0].total is None and alone < MIN_FIRST_ORDER_SUM:
        return (
            f"their first-order shares are {100.0 * max(alone, 0.0):.0f} % of its variance; for the interactions use the method "
            "saltelli"
        )
    return "use their shares of its variance"


def run_study(
    design: StatedDesign,
    plan: Plan,
    work: RowWork,
    nominal: Summary,
    limits: Sequence[str],
    folder: str | PathLike[str] | None,
    workers: int | None,
    scheduler: Scheduler | None,
    progress: Progress | None,
) -> Study:
    """Compute all rows of a plan; arguments as for `Gears.study`."""
    parsed_limits = tuple(limit_of(text, work.names) for text in limits)
    spec = {
        "gearmesh": __version__,
        "design": work.own,
        "pair": work.pair,
        "plan": plan.about,
        "rows": len(plan),
        "digest": plan.digest,
        "record": list(work.names),
        "chunk": work.chunk_rows(len(plan)),
        **({"torque_nm": work.torque} if work.torque else {}),
        **work.level_entry,
    }
    store = StudyStore(folder, spec)
    with store.open():
        _work(store, plan, work, workers, scheduler, progress)
    return Study(design, plan, _columns(plan, work, store), nominal, parsed_limits, work)


def plan_of(
    design: Design,
    vary: Mapping[str, str | Sequence[Value]],
    tolerance: Mapping[str, str] | str | PathLike[str] | None,
    sample: int | None,
    method: str,
    seed: int,
    pair: int | str = 0,
) -> Plan:
    """Return the rows of a study; a tolerance class applies to the flanks of `pair`.

    Raises ArgumentError naming key, value and what is allowed.
    """
    read = KeyReader(design)
    plan = planned(
        vary,
        None if tolerance is None else lambda: tolerance_spreads(read, tolerance, pair),
        sample,
        method,
        seed,
        values=lambda key, given: (
            read.values(key, given) if isinstance(given, str) else [read.value(key, value) for value in given]
        ),
        spread=lambda key, given: _range(read, key, given),
        missing="missing; give keys to vary, as assembly.dV=-0.1:0.1:5, or sample with tolerance",
    )
    _refuse_impossible(design, plan)
    return plan


def _range(read: KeyReader, key: str, values: str | Sequence[Value]) -> Spread:
    if not isinstance(values, str) or ":" not in values:
        raise ArgumentError("vary", entry=key, must_be="LOW:HIGH, to be sampled")
    return read.range(key, values)


def tolerance_spreads(
    read: KeyReader,
    tolerance: Mapping[str, str] | str | PathLike[str] | None,
    pair: int | str,
    option: str = "tolerance",
) -> dict[str, Spread]:
    """Return the distributions of keys, of a file of them, or of a tolerance class; `option` is what gives them.

    Raises ArgumentError or DesignError naming key, value and what is allowed.
    """
    try:
        return _tolerances(replace(read, option=option), tolerance, pair)
    except ArgumentError as failure:
        raise (failure.rename(option) if failure.key == "tolerance" else failure) from failure


def _tolerances(
    read: KeyReader, tolerance: Mapping[str, str] | str | PathLike[str] | None, pair: int | str
) -> dict[str, Spread]:
    if tolerance is None:
        return {}
    if isinstance(tolerance, str) and tolerance.startswith(f"{CLASS_KEY}:"):
        tolerance = {CLASS_KEY: tolerance.removeprefix(f"{CLASS_KEY}:")}
    if isinstance(tolerance, Mapping):
        spreads = class_spreads(read.design, pair, tolerance[CLASS_KEY]) if CLASS_KEY in tolerance else {}
        keys = {key: text for key, text in tolerance.items() if key != CLASS_KEY}
        given = {key: spread_of(key, list(text.split(":")), read.number) for key, text in keys.items()}
    else:
        spreads, given = {}, read_spreads(os.fspath(tolerance), read.number)
    for key in given:
        if isinstance(read.value(key, 1), int):
            raise ArgumentError("tolerance", entry=key, reason="whole numbers can be varied in a grid, not sampled")
    return {**spreads, **given}


def _refuse_impossible(design: Design, plan: Plan) -> None:
    """Check values of keys that only move members against their ranges; no later step checks them."""
    design_keys = own_keys(design)
    for key in set(plan.keys) & set(displacing_keys(design.kind)):
        column = plan.columns[key]
        numbers = [float(value) for value in column]
        for value in {min(numbers), max(numbers)}:
            parse(with_keys(design_keys, [(key, value)]))


def check_record(record: str | Sequence[str], torque: Sequence[float] | None) -> tuple[tuple[float, ...], list[str]]:
    """Return the torques (Nm) and the names of what is recorded.

    Raises ArgumentError for invalid torques, and for figures under load without a torque.
    """
    torques = () if torque is None else tuple(required_torques(torque))
    tokens = [token.strip() for token in (record.split(",") if isinstance(record, str) else record)]
    if LOAD_GROUP in tokens and not torques:
        raise ArgumentError("record", entry="load", reason="needs torque, in Nm")
    return torques, tokens


def refuse_workers(workers: int | None) -> None:
    """Raise ArgumentError for a number of processes below 1."""
    if workers is not None and workers < 1:
        raise ArgumentError("workers", workers, must_be="a whole number above 0")


def work_and_nominal(
    design: Design,
    keys: tuple[str, ...],
    pair: int | str,
    record: str | Sequence[str],
    torque: Sequence[float] | None = None,
    level: str = "full",
) -> tuple[StudyWork, Summary]:
    """Return the work that records the wanted figures, under torques (Nm) if any at a level, and the figures of the
    unchanged design.

    Raises NoSolutionError if the design has no contact. Raises ArgumentError for a figure that it does not have, for
    torques without figures under load, and for figures under load without torques.
    """
    torques, tokens = check_record(record, torque)
    if required_level(level) == "quick" and not torques:
        raise ArgumentError("level", level, reason="is for figures under load; record = load with torque has them")
    allowed = (*CONTACT_GROUPS, TURNS_GROUP, *([LOAD_GROUP] if torques else []))
    if design.member_names is not None:
        design.member_names.pair_number(pair)
    known = recordable(systems.build(design).sharing(pair), len(torques))
    _refuse_unknown(tokens, allowed, known)
    # refused before anything is solved
    without_load = {*CONTACT_GROUPS, TURNS_GROUP, *(name for name, group in known.items() if group != LOAD_GROUP)}
    if torques and set(tokens) <= without_load:
        torque_text = ",".join(f"{torque:g}" for torque in torques)
        raise ArgumentError("torque", entry=torque_text, reason="needs figures under load; record = load has them")
    whole = StudyWork(own_keys(design), (), pair, CONTACT_GROUPS, torque=torques, level=required_level(level))
    by_group: dict[str, str] = {}
    nominal_figures = Summary()

    def ask(group: str, groups: tuple[str, ...]) -> Summary:
        ((figures, reason),) = replace(whole, groups=groups).figures([()])
        if reason:
            raise NoSolutionError(reason=f"the design itself: {reason}")
        for name in figures:
            by_group.setdefault(name, known.get(name, group))
        return Summary(nominal_figures, figures)

    # compute no more than is recorded: a mesh cycle takes as long as the paths of hundreds of rows
    recorded = {group for name, group in known.items() if {name, group, "all"} & set(tokens)}
    last = max((CONTACT_GROUPS.index(group) for group in recorded - {LOAD_GROUP, TURNS_GROUP}), default=0)
    nominal_figures = ask(CONTACT_GROUPS[last], CONTACT_GROUPS[: last + 1])
    by_group = dict(sorted(by_group.items(), key=lambda item: CONTACT_GROUPS.index(item[1])))
    turning = {TURNS_GROUP, *(name for name, group in known.items() if group == TURNS_GROUP)}
    if turning & set(tokens):
        nominal_figures = ask(TURNS_GROUP, (CONTACT_GROUPS[0], TURNS_GROUP))
    if torques:
        nominal_figures = ask(LOAD_GROUP, (CONTACT_GROUPS[0], LOAD_GROUP))
    _refuse_unknown(tokens, allowed, by_group)
    names = tuple(name for name, group in by_group.items() if {name, group, "all"} & set(tokens))
    groups = (*CONTACT_GROUPS[: last + 1], *sorted({by_group[name] for name in names} & {LOAD_GROUP, TURNS_GROUP}))
    length, height = map(PathFigures.key_of, ("contact_length", "contact_height"))
    middle = nominal_figures[length], nominal_figures[height]
    # the pattern shifts from its place without errors of assembly, also where the design has some
    moving = displacing_keys(whole.kind)
    ((without_errors, _),) = replace(whole, keys=moving, groups=CONTACT_GROUPS[:1]).figures([[0.0] * len(moving)])
    places = [PathFigures.key_of(name) for name in ("pattern_centre_face", "pattern_centre_height")]
    face, working_height = (without_errors.get(key, math.nan) for key in places)
    work = replace(
        whole, keys=keys, groups=groups, names=names, reference=middle, nominal_pattern=(face, working_height)
    )
    shift = PathShift(0.0, 0.0, nominal_figures[places[0]] - face, nominal_figures[places[1]] - working_height)
    recorded_entries = [entry for entry in nominal_figures.entries if entry.key in names]
    shifts = {entry.key: entry for entry in shift.entries}
    nominal = Summary(shifts.get(entry.key, entry) for entry in recorded_entries)
    return work, nominal


def _refuse_unknown(tokens: Sequence[str], allowed: Sequence[str], names: Iterable[str]) -> None:
    """Raise ArgumentError for a token of `record` that is neither an allowed group nor the name of a figure."""
    names = tuple(names)
    for token in tokens:
        if token not in (*allowed, "all", *names):
            close = nearest(token, (*allowed, *names))
            hint = f"; did you mean {close}?" if close else ""
            more = "" if LOAD_GROUP in allowed else f", {LOAD_GROUP} with torque"
            raise ArgumentError(
                "record", entry=token, must_be=f"{', '.join(allowed)}{more}, all or a figure ({', '.join(names)}){hint}"
            )


def _work(
    store: StudyStore,
    plan: Plan,
    work: RowWork,
    workers: int | None,
    scheduler: Scheduler | None,
    progress: Progress | None,
) -> None:
    """Compute all chunks that are not done yet."""
    from gearmesh.study import runners

    size = work.chunk_rows(len(plan))
    count = -(-len(plan) // size)
    left = [number for number in range(count) if number not in store.chunks]

    def chunks() -> Iterator[Chunk]:
        for number in left:
            yield number, plan.rows(number * size, (number + 1) * size)

    worth = MIN_PARALLEL_LOADED_CHUNKS if LOAD_GROUP in work.groups else MIN_PARALLEL_CHUNKS
    many = workers if workers is not None else (os.cpu_count() or 1) if len(left) >= worth else 1
    with runners.runner(min(many, len(left)), scheduler) as run:
        for done, (number, rows) in enumerate(run(work, chunks()), start=1):
            store.add(number, rows)
            if progress is not None:
                progress((count - len(left) + done) / count, f"study: {len(plan)} rows")
    if len(store.chunks) < count:
        raise OutputError(reason="some rows were not computed; run the same command again to continue")


def _columns(plan: Plan, work: RowWork, store: StudyStore) -> dict[str, list[Any]]:
    rows = [row for number in sorted(store.chunks) for row in store.chunks[number]]
    figures = list(zip(*rows, strict=True))
    reasons = list(figures[-1])
    status = ["ok" if not reason else "no contact" if reason == NO_CONTACT else "failed" for reason in reasons]
    named = {name: list(values) for name, values in zip(work.names, figures, strict=False)}
    return {"row": list(range(len(plan))), **plan.columns, **named, "status": status, "reason": reasons}
