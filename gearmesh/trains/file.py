"""Files of trains: stages, each a design file or a table with the keys of one, and the shafts that hold their members."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, ClassVar, TypeVar

from pydantic import ValidationError

from gearmesh import __version__
from gearmesh.design import files, keys
from gearmesh.design.changes import unknown_version
from gearmesh.design.core import Design
from gearmesh.design.dotted import values_of
from gearmesh.design.explain import explain
from gearmesh.design.keys import MM_PER, Table
from gearmesh.design.shown import value_text
from gearmesh.errors import DesignError, FileError, GearmeshError, nearest
from gearmesh.records import dataclass
from gearmesh.systems import designs
from gearmesh.systems.system import complete_design, system

TableT = TypeVar("TableT", bound=Table)

#: kind of the files of trains
TRAIN_KIND = "train"
#: key of a stage that names the file of its design
DESIGN_KEY = "design"
#: tables of the file that hold named tables
NAMED_TABLES = ("stages", "shafts")


class TrainKeys(Table):
    """Keys of a train beside its stages and shafts."""

    kind: str = keys.text("train")
    gearmesh: str | None = keys.text("version that the file was written for", None)
    units: str = keys.choice("unit of every length beside the stages, which have their own", tuple(MM_PER), "mm")
    name: str | None = keys.text("title for reports and pictures", None)
    input: str | None = keys.text("shaft that drives", None, default="the first")
    output: str | None = keys.text("shaft whose transmission error is asked for", None, default="the last")
    reverse: bool = keys.flag("the input turns so that the coast flanks of its first stage carry", False)


class Seat(Table):
    """One member on a shaft."""

    usual: ClassVar[tuple[str, ...]] = ("position",)

    member: str = keys.text('stage and member, as "first.gear"; a planetary stage has a carrier too')
    position: float | None = keys.length(
        "place of the origin of the member's frame along the shaft", None, default="0 for the first member"
    )
    phase: float = keys.angle("rotation of tooth 0 about the shaft", 0.0)
    turn: float = keys.angle(
        "rotation about the shaft of the stage that it joins to; at 0 the stage leads straight on", 0.0
    )
    reversed: bool = keys.flag("the z axis of the member is against that of the shaft", False)


class ShaftKeys(Table):
    """Keys of a shaft beside its members."""

    joined: bool = keys.flag("all gears of the shaft are one body", False)
    speed: float | None = keys.number(
        "turns per turn of the input: a second shaft that drives a differential, or 0 for a shaft that is held",
        None,
        default="follows from the stages",
    )
    coaxial: str | None = keys.text("another shaft, on whose axis this shaft has to be", None, default="not asked for")


@dataclass(frozen=True)
class ShaftTable:
    """A shaft as the file states it."""

    name: str
    keys: ShaftKeys
    seats: tuple[Seat, ...]


@dataclass(frozen=True)
class TrainFile:
    """A train as its file states it, with complete designs of all stages; lengths of shafts are in mm."""

    keys: TrainKeys
    stages: Mapping[str, Design]
    shafts: Mapping[str, ShaftTable]

    @property
    def title(self) -> str:
        """Title of reports and pictures."""
        return self.keys.name or f"Train of {len(self.stages)} stages"

    @property
    def input(self) -> str:
        """Name of the driving shaft."""
        return self._shaft("input", 0)

    @property
    def output(self) -> str:
        """Name of the shaft whose transmission error is asked for."""
        return self._shaft("output", -1)

    def _shaft(self, key: str, place: int) -> str:
        name = getattr(self.keys, key)
        if name is None:
            return list(self.shafts)[place]
        if name not in self.shafts:
            raise DesignError(key, name, shown=value_text(name), must_be=f"one of {', '.join(self.shafts)}")
        return str(name)

    def resolve(self) -> dict[str, Any]:
        """Return the train as plain tables with every default filled in, lengths of shafts in mm."""
        shafts = {
            name: {**shaft.keys.plain(), "members": [seat.plain() for seat in shaft.seats]}
            for name, shaft in self.shafts.items()
        }
        stages = {name: design.resolve() for name, design in self.stages.items()}
        return {**self.keys.plain(), "units": "mm", "stages": stages, "shafts": shafts}


def read_train(path: str | os.PathLike[str], overrides: Sequence[str] = ()) -> TrainFile:
    """Return the train in a TOML or JSON file; names of design files in it are relative to its folder.

    `overrides`: keys that are put in before validation, as "stages.second.gear.teeth=41". Raises DesignError in one line naming
    key, value and what is allowed.
    """
    return train_of(files.override(files.read(path), overrides), Path(path).parent)


def train_of(data: Mapping[str, Any], folder: Path) -> TrainFile:
    """Return the train in plain tables; names of design files are relative to `folder`. Raises DesignError as `read_train` does."""
    kind = data.get("kind")
    if kind != TRAIN_KIND:
        hint = "" if kind is None else "; the design of a gear set is a stage of a train, or has other commands, as run"
        raise DesignError("kind", kind, shown=value_text(kind), must_be=f'"{TRAIN_KIND}"{hint}')
    plain = {name: value for name, value in data.items() if name not in NAMED_TABLES}
    units = str(plain.get("units", "mm"))
    own = _table(TrainKeys, plain, "", units, NAMED_TABLES)
    if own.gearmesh is not None and (why := unknown_version(own.gearmesh, __version__)):
        raise DesignError("gearmesh", own.gearmesh, reason=why)
    stages = {name: _design(name, table, folder) for name, table in _named(data, "stages").items()}
    shafts = {name: _shaft(name, table, units) for name, table in _named(data, "shafts").items()}
    return TrainFile(own, stages, shafts)


def _named(data: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    """Return the named tables of a key. Raises DesignError where there are none, and for values that are no tables."""
    tables = data.get(key)
    example = {"stages": '[stages.first] with design = "FILE" or the keys of a design',
               "shafts": '[shafts.input] with members = ["first.pinion"]'}[key]  # fmt: skip
    if not isinstance(tables, Mapping) or not tables:
        shown = None if tables is None else value_text(tables)
        raise DesignError(key, tables, shown=shown, must_be=f"tables with names, as {example}")
    for name, table in tables.items():
        if not isinstance(table, Mapping):
            raise DesignError(f"{key}.{name}", table, shown=value_text(table), must_be=f"a table, as {example}")
        if not name or "." in name:
            raise DesignError(f"{key}.{value_text(name)}", reason="a name has no point in it")
    return tables


def _design(name: str, table: Mapping[str, Any], folder: Path) -> Design:
    """Return the complete design of a stage: the keys of its file, replaced by those of its table."""
    key = f"stages.{name}"
    own = {other: value for other, value in table.items() if other != DESIGN_KEY}
    with naming_stage(name):
        if DESIGN_KEY not in table:
            if "kind" not in own:
                raise DesignError("kind", reason=f"missing; a stage has a kind, or a file of its design: {DESIGN_KEY}")
            return complete_design(designs.parse_as_stated(_anchored(own, folder)))
        file = table[DESIGN_KEY]
        if not isinstance(file, str) or not file:
            raise DesignError(DESIGN_KEY, file, shown=value_text(file), must_be="the name of a design file")
        path = folder / file
        changed = tuple(f"{dotted}={_toml_value(value)}" for dotted, value in values_of(own))
        try:
            return designs.load(path, changed)
        except FileError as failure:
            raise failure.rename(f"{key}.{DESIGN_KEY}: {failure.key}") from failure


def _anchored(own: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the keys of a design with names of files relative to the working folder."""
    return files.anchor(own, system(own["kind"]).of_keys(own).design, folder)


def _toml_value(value: Any) -> str:
    """Return a value as TOML."""
    return files.toml({"value": value}).partition("=")[2].strip()


@contextmanager
def naming_stage(name: str) -> Iterator[None]:
    """Run the body of the context; its refusals then begin with the stage."""
    try:
        yield
    except FileError:
        raise
    except GearmeshError as failure:
        key = f"stages.{name}"
        own = failure.key
        raise failure.rename(own if own.startswith(key) else f"{key}.{own}" if own else key) from failure


def _shaft(name: str, table: Mapping[str, Any], units: str) -> ShaftTable:
    """Return a shaft of the file."""
    key = f"shafts.{name}"
    beside = {other: value for other, value in table.items() if other != "members"}
    own = _table(ShaftKeys, beside, key, units, ("members",))
    given = table.get("members")
    if not isinstance(given, Sequence) or isinstance(given, str) or not given:
        shown = None if given is None else value_text(given)
        raise DesignError(
            f"{key}.members", given, shown=shown, must_be='a list of members, as ["first.gear", "second.pinion"]'
        )
    seats = []
    for number, entry in enumerate(given, start=1):
        stated = {"member": entry} if isinstance(entry, str) else entry
        if not isinstance(stated, Mapping):
            example = 'members, as "first.gear" or { member = "first.gear", position = 0 }'
            raise DesignError(f"{key}.members", entry, shown=value_text(entry), must_be=example)
        word = stated.get("member")
        where = f"{key}.members.{word if isinstance(word, str) and stated is entry else number}"
        seats.append(_table(Seat, stated, where, units).scale(MM_PER.get(units, 1.0)))
    return ShaftTable(name, own, tuple(seats))


def _table(
    kind: type[TableT], given: Mapping[str, Any], prefix: str, units: str, beside: tuple[str, ...] = ()
) -> TableT:
    """Return a validated table. Raises DesignError with the place of the key; `beside`: other keys that may be there."""
    unit = "inch" if units == "inch" else "mm"
    for name in given:
        if name not in kind.model_fields and (close := nearest(name, (*kind.names(), *beside))):
            raise DesignError(f"{prefix}.{name}" if prefix else name, reason=f"unknown key; did you mean {close}?")
    try:
        return kind.model_validate(dict(given), context={"mm_per_unit": MM_PER[unit]})
    except ValidationError as error:
        refusal = explain(error, kind, unit, given)
        raise (refusal.rename(f"{prefix}.{refusal.key}") if prefix else refusal) from None
