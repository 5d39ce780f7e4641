"""Sheets: what is derived from a design, machine settings first of all, and the settings that compensate assembly errors."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, plain
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.figures import ZERO_SIZES, Content, Figures, at_resolution, figure
from gearmesh.systems import system as systems
from gearmesh.systems.common.plain_sheet import (
    MASS_TITLE,
    MID_FACE_TITLE,
    TOOLS_TITLE,
    mass_table,
    member_table,
    plain_sheet,
    tool_table,
)
from gearmesh.systems.common.symbol_table import FIRST_VALUE_COLUMN, column_of, tables_of
from gearmesh.systems.system import MissingValue, Setting, SheetTable

#: what counts as 0 in a row without unit
NOTHING = 1e-12


class Filling(Result):
    """Values for keys of a design; as ".toml" the design with those values given is saved."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (".json", ".toml")

    @abstractmethod
    def apply(self) -> Design:
        """The design with the values given.

        Returns
        -------
        Design
            It no longer depends on the defaults that they were.

        Examples
        --------
        >>> gears.sheet().apply().kind
        'cylindrical'
        """

    def _write(self, target: Path) -> None:
        from gearmesh.design.files import design_text
        from gearmesh.io.atomic import whole_text

        whole_text(target, design_text(self.apply(), target.parent))


@dataclass(frozen=True)
class MissingFigures(Figures):
    """A value that a table of a sheet has not, and why."""

    table: str = figure("title of the table")
    symbol: str = figure("symbol of the row; empty of a table that is missing as a whole")
    column: str = figure("heading of the column")
    reason: str = figure("why there is no such value")

    @staticmethod
    def of(table: SheetTable, value: MissingValue) -> MissingFigures:
        """Of a value that a table has not."""
        return MissingFigures(table.title, value.symbol, value.column, value.reason)


@dataclass(frozen=True, repr=False)
class DesignSheet(Filling):
    """Tables of what is derived from a design, and the derived values under the design's keys, in its own units, which take the
    place of the keys `replaced`."""

    design: Design
    tables: tuple[SheetTable, ...]
    values: dict[str, float]
    warnings: tuple[str, ...] = ()
    replaced: tuple[str, ...] = ()

    @property
    def headline(self) -> str:
        return ", ".join(table.title for table in self.tables)

    @property
    def listings(self) -> list[Listing]:
        return [*(_listing(table) for table in self.tables), *_missing_listing(self.missing)]

    @property
    def missing(self) -> list[MissingFigures]:
        """The values that the tables have not, and why."""
        return [MissingFigures.of(table, value) for table in self.tables for value in table.missing]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([{"key": key, "value": value} for key, value in self.values.items()])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.design),
            "tables": self.plain_tables,
            "values": self.values,
            **({"missing": self.missing} if self.missing else {}),
        }

    @property
    def plain_tables(self) -> dict[str, dict[str, list[Any]]]:
        """By title and symbol, or item where there are no symbols: the unit and the values of a row."""
        return {
            table.title: {
                str(key): list(row[1:])
                for key, row in zip(table.symbols or (row[0] for row in table.rows), table.rows, strict=True)
            }
            for table in self.tables
        }

    def apply(self) -> Design:
        """The design with all the values given.

        Returns
        -------
        Design
            It no longer depends on the defaults that they were.

        Examples
        --------
        >>> gears.sheet().apply().kind
        'cylindrical'
        """
        return self.design.with_values({**self.values, **dict.fromkeys(self.replaced)})


def _missing_listing(missing: list[MissingFigures]) -> list[Listing]:
    """The values that there are not, one line for all of a table and a column that have one reason; empty where there are none."""
    symbols: dict[tuple[str, str, str], list[str]] = {}
    for value in missing:
        symbols.setdefault((value.table, value.column, value.reason), []).append(value.symbol)
    rows = [[", ".join(filter(None, own)) or title, of, why] for (title, of, why), own in symbols.items()]
    return [Listing("Dashes, and why", ("value", "of", "reason"), rows)] if rows else []


def _listing(table: SheetTable) -> Listing:
    """A table to print, its symbols before its items; what rounding leaves is 0."""
    rows = [[at_resolution(plain(value), ZERO_SIZES.get(row[1], NOTHING)) for value in row] for row in table.rows]
    if table.symbols:
        columns = ("symbol", "", "unit", *table.columns)
        return Listing(table.title, columns, [[symbol, *row] for symbol, row in zip(table.symbols, rows, strict=True)])
    return Listing(table.title, ("", "unit", *table.columns), rows)


@dataclass(frozen=True)
class SettingFigures(Figures):
    """A setting that compensates assembly errors."""

    key: str = figure("key of the design")
    value_before: Any = figure("value in the design, in its own units")
    value_after: Any = figure("value that compensates the errors, in the design's units")
    unit: str = figure("unit of the values")
    effect: str = figure("effect of the change")


@dataclass(frozen=True, repr=False)
class Compensation(Filling):
    """Settings that compensate the assembly errors of a design, before and after."""

    design: Design
    settings: tuple[Setting, ...]
    warnings: tuple[str, ...] = ()

    @property
    def headline(self) -> str:
        return ", ".join(f"{setting.key} {setting.before:.6g} -> {setting.after:.6g}" for setting in self.settings)

    @property
    def rows(self) -> list[SettingFigures]:
        """One per setting."""
        return [SettingFigures(s.key, s.before, s.after, s.unit, s.effect) for s in self.settings]

    @property
    def listings(self) -> list[Listing]:
        return [
            Listing(
                "Settings",
                ("key", "before", "after", "unit", "effect"),
                [[plain(value) for value in row.row.values()] for row in self.rows],
            )
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "settings": self.rows}

    def apply(self) -> Design:
        """The design with the settings that compensate its errors.

        Returns
        -------
        Design
            With the values of the column after.

        Examples
        --------
        >>> arcs = gm.build(gm.load("samples/circular_arc.toml", ["assembly.dC=0.01"]))
        >>> arcs.compensate().apply().kind
        'circular_arc'
        """
        return self.design.with_values({setting.key: setting.after for setting in self.settings})


def sheet_of(gears: GearSet, torque: float | None = None, speed: float | None = None) -> DesignSheet:
    """What is derived from a design, as `Gears.sheet` says."""
    known = systems.system_of(gears.design)
    if speed is not None and torque is None:
        raise ArgumentError("speed", speed, reason="needs a torque")
    if torque is not None and known.forces is None:
        if systems.system(gears.design.kind).forces is not None:
            raise ArgumentError("torque", torque, reason="forces need a mating gear, which this design has not")
        able = [kind for kind in systems.kinds() if systems.system(kind).forces is not None]
        raise ArgumentError(
            "torque",
            torque,
            reason=f"the sheet of kind {gears.design.kind} has no forces; allowed with {' or '.join(able)}",
        )
    sheet = (known.sheet or plain_sheet)(gears.design, gears.train)
    # planets, which are numbered, are made alike
    members = {gears.design.table_named(name): member for name, member in gears.train.members.items()}
    common = tables_of(
        (TOOLS_TITLE, lambda: tool_table(members)), (MASS_TITLE, lambda: mass_table(gears.design, members))
    )
    tables = (*sheet.tables, *common)
    if torque is not None and known.forces is not None:
        tables = (*tables, *known.forces(gears.design, torque, speed))
    return DesignSheet(gears.design, tables, sheet.values, (*gears.warnings, *sheet.warnings), sheet.replaced)


def member_sheet_of(gears: GearSet, name: str) -> DesignSheet:
    """What is derived of one member, as `Gears.sheet` says."""
    part, own = gears.part(name), systems.system_of(gears.design).member_sheet
    of_member = _columns_of(gears, name) if own is None else own(gears.design, name)
    own_members = {name: part.member}
    common = tables_of(
        (MID_FACE_TITLE, lambda: member_table(part.member)),
        (TOOLS_TITLE, lambda: tool_table(own_members)),
        (MASS_TITLE, lambda: mass_table(gears.design, own_members)),
    )
    tables = (*(table for table in of_member if table.title != MID_FACE_TITLE), *common)
    left_out = f"{name}: one member alone: its sheet has no axes, ratio, backlash, contact ratios or forces"
    return DesignSheet(gears.design, tables, {}, (*gears.warnings, *part.warnings, left_out))


def _columns_of(gears: GearSet, name: str) -> tuple[SheetTable, ...]:
    """What the whole sheet says of one member: its columns. Of kinds whose members are made alone it is nothing, as that needs
    the mating gear."""
    known = systems.system_of(gears.design)
    if known.members or known.sheet is None:
        return ()
    names = (name, gears.design.table_named(name))
    return tuple(
        _own_column(table, column, name)
        for table in known.sheet(gears.design, gears.train).tables
        for column in range(len(table.columns))
        if table.columns[column] in names
    )


def _own_column(table: SheetTable, column: int, name: str) -> SheetTable:
    """A table with one of its columns alone, and the rows that have a value there or a reason why not."""
    own = column_of(table, column)
    reasons = {value.symbol for value in own.missing}
    symbols = own.symbols or ("",) * len(own.rows)
    kept = [k for k, row in enumerate(own.rows) if row[FIRST_VALUE_COLUMN] is not None or symbols[k] in reasons]
    rows = tuple(own.rows[k] for k in kept)
    missing = tuple(replace(value, column=name) for value in own.missing)
    return SheetTable(own.title, (name,), rows, tuple(symbols[k] for k in kept) if own.symbols else (), missing)


def compensation_of(gears: GearSet, refinish: str | None = None) -> Compensation:
    """Settings that compensate assembly errors, as `Gears.compensate`."""
    own = systems.system_of(gears.design)
    if own.compensate is None:
        able = [kind for kind in systems.kinds() if systems.system(kind).compensate is not None]
        raise DesignError("kind", gears.design.kind, reason="has no compensating settings", allowed=" or ".join(able))
    if refinish is None:
        warnings = gears.as_built.warnings
        return Compensation(gears.design, tuple(own.compensate(gears.design)), warnings)
    if own.refinish is None:
        able = [kind for kind in systems.kinds() if systems.system(kind).refinish is not None]
        raise ArgumentError(
            "refinish",
            refinish,
            reason=f"the settings of kind {gears.design.kind} determine the member; it can be chosen for "
            f"{' or '.join(able)}",
        )
    if refinish not in gears.names.members:
        raise ArgumentError("refinish", refinish, must_be=f"one of {', '.join(gears.names.members)}")
    warnings = gears.as_built.warnings
    return Compensation(gears.design, tuple(own.refinish(gears.design, refinish)), warnings)
