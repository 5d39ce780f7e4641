"""Studies of trains: many variants of one train, with the kinematics and the transmission error of the output of each.

A row sets keys of the designs of stages, as "stages.first.assembly.dx". Only the stages whose keys it sets are built anew.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from os import PathLike, fspath
from typing import Any, TypeVar

import numpy as np

from gearmesh.answers.bodies.questions import ModelledGears
from gearmesh.answers.tables import plain
from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.design.shown import shown_key
from gearmesh.errors import ArgumentError, GearmeshError, nearest
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.records import dataclass
from gearmesh.study.plan import KeyReader, Plan, Value, planned
from gearmesh.study.spreads import Spread, read_spreads, spread_of
from gearmesh.study.tolerance_class import CLASS_KEY
from gearmesh.systems import designs
from gearmesh.systems.system import complete_design
from gearmesh.trains.file import TrainFile, naming_stage
from gearmesh.trains.layout import Layout, layout_of
from gearmesh.trains.stage import Stage
from gearmesh.trains.transmission import output_error

#: beginning of the keys of stages
STAGES_PREFIX = "stages."
#: rows of a chunk
CHUNK_ROWS = 4
#: stages that a process keeps
MAX_KEPT_STAGES = 16

ReadT = TypeVar("ReadT")


@dataclass(frozen=True)
class TrainRowFigures(Figures):
    """Figures of a row, as those of the train."""

    ratio: float | None = figure("speed of the input over that of the output", "", "i", optional=True)
    travel: float | None = figure("travel of a rack on the output per turn of the input", "mm", "s", optional=True)
    te_peak_to_peak: float = figure("transmission error of the output, peak to peak", "arcsec")
    way_te_peak_to_peak: float | None = figure(
        "transmission error of a rack along its travel, peak to peak", "um", key="te_peak_to_peak_um", optional=True
    )
    stage_te_peak_to_peak: Mapping[str, float] = figure(
        "share of a stage, peak to peak, at the output", "arcsec", key="te_peak_to_peak_{member}_arcsec"
    )


@dataclass(frozen=True)
class StageKeyReader:
    """Reader of values of the keys of stages."""

    file: TrainFile
    #: option or argument that gives the keys
    option: str = "vary"

    def of_stage(self, key: str, read: Callable[[KeyReader, str], ReadT]) -> ReadT:
        """Return what `read` returns for the reader of a stage and the key of its design.

        Raises DesignError that begins with the stage, and ArgumentError for keys that are of no stage.
        """
        stage, _, own = key.removeprefix(STAGES_PREFIX).partition(".")
        if not key.startswith(STAGES_PREFIX) or not own or stage not in self.file.stages:
            close = nearest(stage, list(self.file.stages))
            hint = f"; did you mean {STAGES_PREFIX}{close}.{own}?" if close and own else ""
            must_be = f"stages.NAME.KEY with NAME one of {', '.join(self.file.stages)}{hint}"
            raise ArgumentError(self.option, entry=shown_key([key]), must_be=must_be)
        try:
            return read(KeyReader(self.file.stages[stage], self.option), own)
        except ArgumentError as failure:
            if failure.entry != shown_key([own]) or failure.value is not None:
                raise
            raise ArgumentError(self.option, entry=shown_key([key]), reason=failure.reason) from failure
        except GearmeshError as failure:
            raise failure.rename(f"{STAGES_PREFIX}{stage}.{failure.key}") from failure

    def number(self, key: str, value: Any) -> float:
        """Return a number in the unit of a key."""
        return self.of_stage(key, lambda read, own: read.number(own, value))

    def values(self, key: str, given: str | Sequence[Value]) -> list[Value]:
        """Return the values of "low:high:count", "a,b,c" or a list."""
        if isinstance(given, str):
            return self.of_stage(key, lambda read, own: read.values(own, given))
        return self.of_stage(key, lambda read, own: [read.value(own, value) for value in given])

    def range(self, key: str, given: str | Sequence[Value]) -> Spread:
        """Return the uniform spread of "low:high"."""
        if not isinstance(given, str) or ":" not in given:
            raise ArgumentError(self.option, entry=key, must_be="LOW:HIGH, to be sampled")
        return self.of_stage(key, lambda read, own: read.range(own, given))


def train_plan(
    file: TrainFile,
    vary: Mapping[str, str | Sequence[Value]],
    tolerance: Mapping[str, str] | str | PathLike[str] | None,
    sample: int | None,
    method: str,
    seed: int,
) -> Plan:
    """Return the rows of a study of a train. Raises ArgumentError naming key, value and what is allowed."""
    read = StageKeyReader(file)
    return planned(
        vary,
        None if tolerance is None else lambda: _tolerances(replace(read, option="tolerance"), tolerance),
        sample,
        method,
        seed,
        values=read.values,
        spread=read.range,
        missing="missing; give keys to vary, as stages.first.assembly.dx=-0.1:0.1:5",
    )


def _tolerances(read: StageKeyReader, tolerance: Mapping[str, str] | str | PathLike[str]) -> dict[str, Spread]:
    """Return the distributions of keys, or of a file of them."""
    if CLASS_KEY in tolerance if isinstance(tolerance, Mapping) else fspath(tolerance).startswith(f"{CLASS_KEY}:"):
        raise ArgumentError("tolerance", entry=CLASS_KEY, reason="tolerance classes are for studies of one stage")
    if isinstance(tolerance, Mapping):
        return {key: spread_of(key, list(text.split(":")), read.number) for key, text in tolerance.items()}
    return read_spreads(fspath(tolerance), read.number)


@dataclass(frozen=True)
class TrainStudyWork:
    """Function that computes rows of a study of a train."""

    #: file of the train
    file: TrainFile
    #: varied keys, dotted
    keys: tuple[str, ...]
    #: turns of the input for the transmission error; None for one turn of the output
    turns: float | None = None
    #: figures that are kept
    names: tuple[str, ...] = ()
    #: groups of figures of one pair, of which a train has none
    groups: tuple[str, ...] = ()
    #: torques, of which a train has none
    torque: tuple[float, ...] = ()
    #: pair, of which a train has none
    pair: int = 0

    @property
    def own(self) -> Mapping[str, Any]:
        """The train as plain tables, which tell studies apart."""
        stages = {name: design.stated() for name, design in self.file.stages.items()}
        return {**self.file.resolve(), "stages": stages, "turns": self.turns}

    @property
    def level_entry(self) -> dict[str, str]:
        """Entry of the level of contact under load; none."""
        return {}

    def chunk_rows(self, rows: int) -> int:
        """Return the number of rows that are computed together."""
        return CHUNK_ROWS

    def figures(self, row: Sequence[Any]) -> Summary:
        """Return the figures of one row. Raises GearmeshError where it has none."""
        own: dict[str, list[tuple[str, Any]]] = {}
        for key, value in zip(self.keys, row, strict=True):
            stage, _, inner = key.removeprefix(STAGES_PREFIX).partition(".")
            own.setdefault(stage, []).append((inner, value))
        made: dict[str, Stage] = {}
        for name, design in self.file.stages.items():
            tables = with_keys(design.stated(), own.get(name, ()))
            made[name] = _stage(name, json.dumps(tables, sort_keys=True, default=str))
        varied: dict[str, Design] = {name: stage.gears.design for name, stage in made.items()}
        layout = layout_of(replace(self.file, stages=varied), made)
        return Summary(_row_figures(layout, self.turns)).flat

    def __call__(self, rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
        """Return the values of `names` of each row, None where there is no value, and last the reason."""
        found = []
        for row in rows:
            try:
                figures, reason = self.figures(row), ""
            except GearmeshError as failure:
                figures, reason = Summary(), str(failure)
            entries = [figures.entry(name) for name in self.names]
            found.append([*(None if entry is None else plain(entry.value) for entry in entries), reason])
        return found


def _row_figures(layout: Layout, turns: float | None) -> TrainRowFigures:
    """Return the figures of a row from the layout of its train."""
    output = layout.file.output
    speed, port, error = layout.speeds[output], layout.port(output), output_error(layout, output, turns)
    size = float(np.ptp(error.te))
    return TrainRowFigures(
        float(1 / speed) if speed and not port.slides else None,
        port.joint.way(2.0 * math.pi * float(speed)),
        size / ARCSEC,
        port.joint.way(1e3 * size),
        {stage: float(np.ptp(part)) / ARCSEC for stage, part in error.parts.items()},
    )


@lru_cache(maxsize=MAX_KEPT_STAGES)
def _stage(name: str, text: str) -> Stage:
    """Return the stage of the design of a JSON text."""
    with naming_stage(name):
        return Stage.of(name, ModelledGears(complete_design(designs.parse_as_stated(json.loads(text)))))


def train_work(
    file: TrainFile, plan: Plan, record: Sequence[str], turns: float | None
) -> tuple[TrainStudyWork, Summary]:
    """Return the work that records figures of a train, and the figures of the train itself.

    `record`: names of figures, or "all". Raises ArgumentError for a figure that the train does not have.
    """
    nominal = TrainStudyWork(file, (), turns).figures(())
    known = [entry for entry in nominal.entries if entry.value is not None]
    names = [entry.key for entry in known]
    for token in record:
        if token != "all" and token not in names:
            raise ArgumentError("record", entry=token, must_be=f"all or figures of {', '.join(names)}")
    kept = [entry for entry in known if "all" in record or entry.key in record]
    return TrainStudyWork(file, plan.keys, turns, tuple(entry.key for entry in kept)), Summary(kept)
