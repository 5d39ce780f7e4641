"""Objectives and constraints of an optimisation: figures that studies record, without load or under torques.

A figure is named by its key in a study, or without unit and without `mesh_` or `loaded_`. Torques follow @ :
"te_peak_to_peak@500,1000:mean" is the mean of the loaded transmission errors under both.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import TypeVar

import numpy as np

from gearmesh.errors import ArgumentError, nearest
from gearmesh.figures import KEY_ENDINGS, ZERO_SIZES, at_resolution
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.numerals import parse_number, parse_numbers
from gearmesh.records import dataclass
from gearmesh.study.rows.names import recordable
from gearmesh.study.rows.work import LOAD_GROUP
from gearmesh.study.statistics import Limit
from gearmesh.teeth.gear_train import GearPair

#: key of a figure, or the parts of the keys of one under load
Key = TypeVar("Key", str, tuple[str, str])

#: prefixes of keys that a name may leave out
OPTIONAL_PREFIXES = ("mesh_", "loaded_")
#: significant digits in which designs are compared; further ones are rounding
COMPARED_DIGITS = 9
#: text of the measure that takes the worst row
WORST_TEXT = "worst"

_FIGURE_PATTERN = re.compile(r"\s*(\w+)\s*(?:@([^:<>]*))?(?::(\w+))?\s*", re.ASCII)
_LIMIT_PATTERN = re.compile(r"([^<>]+)([<>])([^<>]+)")
_SIGMA_PATTERN = re.compile(r"mean(?:\+(.+?)\s*sigma)?")


@dataclass(frozen=True)
class WantedFigure:
    """Figure as a text names it: its name, the torques (Nm) it is wanted under, and how they count together."""

    #: the whole text
    text: str
    #: option or argument that gives it
    option: str
    #: key of the figure
    name: str
    #: torques, Nm; () if the text names none
    torque: tuple[float, ...]
    #: "mean", "max" or "min"; "" if the text leaves it out
    together: str


@dataclass(frozen=True)
class Measure:
    """Value that stands for a figure over the rows of all errors: the worst, or the mean and some standard deviations."""

    #: number of standard deviations; None for the worst row
    sigmas: float | None

    @property
    def text(self) -> str:
        """Measure as it is written for `robust_by`."""
        return WORST_TEXT if self.sigmas is None else f"mean+{self.sigmas:g}sigma"

    def of(self, values: Array, sense: int) -> float:
        """Return the value for a figure (R,) that is better when smaller (sense -1) or larger (+1); NaN if any is unknown."""
        if self.sigmas is None or len(values) == 1:
            return float(values.max() if sense < 0 else values.min())
        return float(values.mean() - sense * self.sigmas * values.std())


def measure_of(text: str) -> Measure:
    """Return the measure of a text. Raises ArgumentError naming what is allowed."""
    match = _SIGMA_PATTERN.fullmatch(text.replace(" ", ""))
    sigmas = parse_number(match[1] or "0") if match else None
    if text.strip() == WORST_TEXT:
        return Measure(None)
    if sigmas is None or not 0.0 <= sigmas < np.inf:
        raise ArgumentError("robust_by", text, must_be=f"{WORST_TEXT}, mean or mean+Ksigma, as mean+3sigma")
    return Measure(sigmas)


@dataclass(frozen=True)
class Objective:
    """Figure that is made as small (sense -1) or as large (+1) as possible."""

    #: the objective as it was given
    text: str
    #: -1 for a small figure, +1 for a large figure
    sense: int
    #: keys of the recorded figure, one per torque
    names: tuple[str, ...]
    #: True for the mean over the torques, False for the worst
    mean: bool

    @property
    def resolution(self) -> float:
        """Least size of the figure, in its unit; anything smaller is 0."""
        return _resolution(self.names[0])

    def comparable(self, values: Array) -> Array:
        """Return values (N,) that are smaller where the design is better, without the digits that are rounding."""
        sizes = np.where(np.abs(values) < self.resolution, 0.0, np.abs(values))
        known = np.isfinite(sizes) & (sizes > 0.0)
        scale = 10.0 ** (np.floor(np.log10(sizes, out=np.zeros_like(sizes), where=known)) + 1.0 - COMPARED_DIGITS)
        rounded: Array = -self.sense * np.sign(values) * np.where(known, np.round(sizes / scale) * scale, sizes)
        return rounded

    def of(self, columns: Mapping[str, Array], measure: Measure) -> float:
        """Return the value of a design whose rows have these columns (R,)."""
        table = np.stack([columns[name] for name in self.names])
        worst = table.max(axis=0) if self.sense < 0 else table.min(axis=0)
        return measure.of(table.mean(axis=0) if self.mean else worst, self.sense)


@dataclass(frozen=True)
class Constraint:
    """Limit of a figure, under all its torques."""

    text: str
    limits: tuple[Limit, ...]

    @property
    def sense(self) -> int:
        """-1 for a figure that must be below its limit, +1 for one above."""
        return self.limits[0].sense

    @property
    def resolution(self) -> float:
        """Least size of the figure, in its unit; anything smaller is 0."""
        return _resolution(self.limits[0].figure)

    @property
    def value(self) -> float:
        """The limit."""
        return self.limits[0].value

    def of(self, columns: Mapping[str, Array], measure: Measure) -> float:
        """Return the figure of a design whose rows have these columns (R,), under the torque that is worst."""
        values = [measure.of(columns[limit.figure], self.sense) for limit in self.limits]
        return max(values) if self.sense < 0 else min(values)

    def room(self, value: float) -> float:
        """Return the distance of the figure from its limit, relative to the limit; it holds above 0."""
        return float(self.limits[0].room(np.array(value))) / max(abs(self.value), 1e-12 if self.value else 1.0)


@dataclass(frozen=True)
class Target:
    """All that is asked of a design: objectives, constraints, and the torques and figures that they need."""

    #: figures that are made small or large
    objectives: tuple[Objective, ...]
    #: limits that hold at the optimum
    constraints: tuple[Constraint, ...]
    #: torques (T,), Nm, on the pinion
    torque: tuple[float, ...]
    #: keys of the recorded figures, in the order of the rows; () before the work is known
    recorded: tuple[str, ...] = ()

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of all figures that are needed."""
        own = [name for objective in self.objectives for name in objective.names]
        limits = [limit.figure for constraint in self.constraints for limit in constraint.limits]
        return tuple(dict.fromkeys([*own, *limits]))

    @property
    def signs(self) -> Array:
        """Signs (O,) that make objectives small."""
        return np.array([-each.sense for each in self.objectives], dtype=float)

    def comparable(self, table: Array) -> Array:
        """Return objectives (N, O) that are smaller where the design is better, without the digits that are rounding."""
        return np.stack(
            [each.comparable(column) for each, column in zip(self.objectives, table.T, strict=True)], axis=1
        )

    def shown(self, values: Iterable[float]) -> list[float]:
        """Return values of the objectives and limits, or of the objectives alone, as a table shows them."""
        sizes = [*(each.resolution for each in self.objectives), *(each.resolution for each in self.constraints)]
        return [at_resolution(value, size) for value, size in zip(values, sizes, strict=False)]

    @property
    def texts(self) -> list[str]:
        """Objectives and constraints as they were given."""
        return [*(each.text for each in self.objectives), *(each.text for each in self.constraints)]


@dataclass(frozen=True)
class OptimumRequest:
    """Objectives and constraints as texts name them; no gears are known yet."""

    #: figures with their sense
    objectives: tuple[tuple[WantedFigure, int], ...]
    #: figures with the sense and the value of their limit
    constraints: tuple[tuple[WantedFigure, int, float], ...]

    @property
    def torque(self) -> tuple[float, ...]:
        """All torques, Nm, in order."""
        wanted = [*(each for each, _ in self.objectives), *(each for each, *_ in self.constraints)]
        return tuple(sorted({torque for each in wanted for torque in each.torque}))

    def target(self, pair: GearPair) -> Target:
        """Return what is asked of a pair of gears. Raises ArgumentError for a figure that it does not have."""
        torque = self.torque
        names = _FigureNames.of(pair)
        objectives = tuple(
            Objective(each.text.strip(), sense, names.keys(each, torque), each.together == "mean")
            for each, sense in self.objectives
        )
        constraints = tuple(
            Constraint(each.text.strip(), tuple(Limit(key, sense, value) for key in names.keys(each, torque)))
            for each, sense, value in self.constraints
        )
        return Target(objectives, constraints, torque)


def request_of(minimize: Sequence[str], maximize: Sequence[str], subject: Sequence[str]) -> OptimumRequest:
    """Return the request of texts. Raises ArgumentError naming what is allowed."""
    if not minimize and not maximize:
        raise ArgumentError("minimize", reason="missing; give a figure, as te_peak_to_peak@100 or max_pressure@100")
    objectives = (
        *((_wanted(text, "minimize"), -1) for text in minimize),
        *((_wanted(text, "maximize"), 1) for text in maximize),
    )
    texts = [each.text.strip() for each, _ in objectives]
    for text in texts:
        if texts.count(text) > 1:
            raise ArgumentError("minimize", entry=text, reason="is given twice")
    return OptimumRequest(objectives, tuple(map(_constraint, subject)))


def _wanted(text: str, option: str) -> WantedFigure:
    match = _FIGURE_PATTERN.fullmatch(text)
    worst = "min" if option == "maximize" else "max"
    if match is None or match[3] not in (None, "mean", worst):
        must_be = f"FIGURE[@NM,NM...][:mean|{worst}], as te_peak_to_peak@50,100:{worst}"
        raise ArgumentError(option, entry=text, reason=f"must be {must_be}")
    return WantedFigure(text, option, match[1], _torques(text, option, match[2]), match[3] or "")


def _constraint(text: str) -> tuple[WantedFigure, int, float]:
    match = _LIMIT_PATTERN.fullmatch(text)
    figure = _FIGURE_PATTERN.fullmatch(match[1]) if match else None
    value = parse_number(match[3].strip()) if match else None
    if match is None or figure is None or figure[3] is not None or value is None:
        raise ArgumentError("subject", entry=text, reason="must look like contact_ratio>1.2 or max_pressure@100<1500")
    wanted = WantedFigure(text, "subject", figure[1], _torques(text, "subject", figure[2]), "")
    return wanted, -1 if match[2] == "<" else 1, value


def _torques(text: str, option: str, torques: str | None) -> tuple[float, ...]:
    if torques is None:
        return ()
    try:
        parsed = parse_numbers(torques.split(","))
    except ValueError:
        parsed = []
    if not parsed or not all(0.0 < torque < np.inf for torque in parsed):
        raise ArgumentError(
            option, entry=text, reason="behind @ must be torques on the pinion in Nm, above 0, with commas"
        )
    return tuple(dict.fromkeys(parsed))


@dataclass(frozen=True)
class _FigureNames:
    """Names of the figures of a pair, with their keys; loaded figures have the parts before and after the number of the torque."""

    unloaded: Mapping[str, str]
    loaded: Mapping[str, tuple[str, str]]

    @staticmethod
    def of(pair: GearPair) -> _FigureNames:
        known = recordable(pair, 1)
        free = [key for key, group in known.items() if group != LOAD_GROUP]
        split = [key.rpartition("_1") for key, group in known.items() if group == LOAD_GROUP]
        parts = [(first, last) for first, _, last in split]
        loaded = _named(((first + last, first), (first, last)) for first, last in parts)
        return _FigureNames(_named(((key, _stem(key)), key) for key in free), loaded)

    def keys(self, wanted: WantedFigure, torque: Sequence[float]) -> tuple[str, ...]:
        """Return the keys of a figure, one per torque. Raises ArgumentError for an unknown figure."""
        if wanted.torque and wanted.name in self.loaded:
            first, last = self.loaded[wanted.name]
            return tuple(f"{first}_{torque.index(each) + 1}{last}" for each in wanted.torque)
        if not wanted.torque and wanted.name in self.unloaded:
            return (self.unloaded[wanted.name],)
        if wanted.name in self.loaded:
            raise ArgumentError(
                wanted.option,
                entry=wanted.text,
                reason=f"{wanted.name} is under load: needs torques, as {wanted.name}@100",
            )
        if wanted.name in self.unloaded:
            raise ArgumentError(
                wanted.option, entry=wanted.text, reason=f"{wanted.name} is without load: leave out the torques"
            )
        names = {**self.loaded, **self.unloaded} if wanted.torque else {**self.unloaded, **self.loaded}
        close = nearest(wanted.name, names)
        shown = dict.fromkeys(self.unloaded.values())
        under_load = ", ".join(dict.fromkeys(first for first, _ in self.loaded.values()))
        hint = f"; did you mean {close}?" if close else ""
        raise ArgumentError(
            wanted.option,
            entry=wanted.text,
            reason=f"no figure of this name; there are {', '.join(shown)}, and with @NM {under_load}{hint}",
        )


def _named(entries: Iterable[tuple[tuple[str, str], Key]]) -> dict[str, Key]:
    """Return keys by name: by the key itself, then without unit, then without an optional prefix; the first one counts."""
    every = list(entries)
    named: dict[str, Key] = {}
    for names in (
        [key for (key, _), _ in every],
        [stem for (_, stem), _ in every],
        [_without_prefix(key) for (key, _), _ in every],
        [_without_prefix(stem) for (_, stem), _ in every],
    ):
        for name, (_, value) in zip(names, every, strict=True):
            named.setdefault(name, value)
    return named


def _without_prefix(name: str) -> str:
    return next((name.removeprefix(prefix) for prefix in OPTIONAL_PREFIXES if name.startswith(prefix)), name)


def _stem(key: str) -> str:
    """Return a key without its unit."""
    return key.removesuffix(KEY_ENDINGS[unit_of(key)])


def _resolution(key: str) -> float:
    """Return the least size of a figure, by the unit that its key names."""
    return ZERO_SIZES.get(unit_of(key), 0.0)


def unit_of(key: str) -> str:
    """Return the unit that the end of a key names, "" if it names none."""
    units = [unit for unit, ending in KEY_ENDINGS.items() if ending and key.endswith(ending)]
    return max(units, key=lambda unit: len(KEY_ENDINGS[unit]), default="")
