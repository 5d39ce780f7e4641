"""Sheets: values derived from a design, mainly machine settings, and the settings that compensate assembly errors."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, plain
from gearmesh.arguments import refuse_speed
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.figures import ZERO_SIZES, Content, Figures, at_resolution, figure
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX
from gearmesh.records import dataclass
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
from gearmesh.systems.common.symbol_table import FIRST_VALUE_COLUMN, column_of, columns_of, tables_of
from gearmesh.systems.system import MissingValue, Setting, SheetTable

#: size below which a value without unit is shown as 0
UNITLESS_ZERO = 1e-12


class Filling(Result):
    """Values for keys of a design; a file with the suffix ".toml" is the design with these values given."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, TOML_SUFFIX)

    @abstractmethod
    def apply(self) -> Design:
        """The design with the values given.

        Returns
        -------
        Design
            Independent of the defaults that gave these values.

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
        """Return the figures of a value that a table lacks."""
        return MissingFigures(table.title, value.symbol, value.column, value.reason)


@dataclass(frozen=True, repr=False)
class DesignSheet(Filling):
    """Tables of values derived from a design, and the derived values under keys of the design."""

    #: the design
    design: Design
    #: tables of derived values
    tables: tuple[SheetTable, ...]
    #: derived values by key, in the design's own units
    values: dict[str, float]
    #: warnings, one line each
    warnings: tuple[str, ...] = ()
    #: keys of the design that the derived values replace
    replaced: tuple[str, ...] = ()

    @property
    def headline(self) -> str:
        return ", ".join(table.title for table in self.tables)

    @property
    def listings(self) -> list[Listing]:
        return [*(_listing(table) for table in self.tables), *_missing_listing(self.missing)]

    @property
    def missing(self) -> list[MissingFigures]:
        """Values that the tables lack, with the reasons."""
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
        """Unit and values of each row, by title of the table and symbol; by item in tables without symbols."""
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
            Independent of the defaults that gave these values.

        Examples
        --------
        >>> gears.sheet().apply().kind
        'cylindrical'
        """
        return self.design.with_values({**self.values, **dict.fromkeys(self.replaced)})


def _missing_listing(missing: list[MissingFigures]) -> list[Listing]:
    """Return the missing values, one line per table, column and reason; an empty list if there are none."""
    symbols: dict[tuple[str, str, str], list[str]] = {}
    for value in missing:
        symbols.setdefault((value.table, value.column, value.reason), []).append(value.symbol)
    rows = [
        [", ".join(filter(None, missing_symbols)) or title, of, why]
        for (title, of, why), missing_symbols in symbols.items()
    ]
    return [Listing("Dashes, and why", ("value", "of", "reason"), rows)] if rows else []


def _listing(table: SheetTable) -> Listing:
    """Return a table to print, with symbols before items; rounding errors are shown as 0."""
    rows = [[at_resolution(plain(value), ZERO_SIZES.get(row[1], UNITLESS_ZERO)) for value in row] for row in table.rows]
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
        """Settings, one row each."""
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
            With the values of the column "after".

        Examples
        --------
        >>> arcs = gm.build(gm.load("samples/circular_arc.toml", ["assembly.dC=0.01"]))
        >>> arcs.compensate().apply().kind
        'circular_arc'
        """
        return self.design.with_values({setting.key: setting.after for setting in self.settings})


def sheet_of(gears: GearSet, torque: float | None = None, speed: float | None = None) -> DesignSheet:
    """Return the values derived from a design, as `Gears.sheet` describes them."""
    known = systems.system_of(gears.design)
    if speed is not None and torque is None:
        raise ArgumentError("speed", speed, reason="needs a torque")
    refuse_speed(speed)
    if torque is not None and known.forces is None:
        if systems.system(gears.design.kind).forces is not None:
            raise ArgumentError("torque", torque, reason="forces need a mating gear, which this design has not")
        able = [kind for kind in systems.loaded_kinds() if systems.system(kind).forces is not None]
        raise ArgumentError(
            "torque",
            torque,
            reason=f"the sheet of kind {gears.design.kind} has no forces; allowed with {' or '.join(able)}",
        )
    sheet = (known.sheet or plain_sheet)(gears.design, gears.train)
    # numbered planets are equal: one of them stands for all
    members = {gears.design.table_named(name): member for name, member in gears.train.members.items()}
    common = tables_of(
        (TOOLS_TITLE, lambda: tool_table(members)), (MASS_TITLE, lambda: mass_table(gears.design, members))
    )
    tables = (*sheet.tables, *common)
    if torque is not None and known.forces is not None:
        tables = (*tables, *known.forces(gears.design, torque, speed))
    return DesignSheet(gears.design, tables, sheet.values, (*gears.warnings, *sheet.warnings), sheet.replaced)


def member_sheet_of(gears: GearSet, name: str) -> DesignSheet:
    """Return the values derived from one member, as `Gears.sheet` describes them."""
    part, member_tables = gears.part(name), systems.system_of(gears.design).member_sheet
    of_member = _columns_of(gears, name) if member_tables is None else member_tables(gears.design, name)
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
    """Return the columns of one member in the whole sheet, or those of both sides of its teeth.

    There are none for kinds whose members are built alone, because the whole sheet needs the mating gear.
    """
    known = systems.system_of(gears.design)
    if known.members or known.sheet is None:
        return ()
    names = (name, gears.design.table_named(name))
    found = []
    for table in known.sheet(gears.design, gears.train).tables:
        found += [_own_column(table, k, name) for k, column in enumerate(table.columns) if column in names]
        sides = [
            k for k, column in enumerate(table.columns) if column.partition(", ")[0] in names and column not in names
        ]
        found += [columns_of(table, sides)] if sides else []
    return tuple(found)


def _own_column(table: SheetTable, column: int, name: str) -> SheetTable:
    """Return a table with only one of its columns, and only the rows with a value there or a reason for its absence."""
    single_column = column_of(table, column)
    reasons = {value.symbol for value in single_column.missing}
    symbols = single_column.symbols or ("",) * len(single_column.rows)
    kept = [
        k for k, row in enumerate(single_column.rows) if row[FIRST_VALUE_COLUMN] is not None or symbols[k] in reasons
    ]
    rows = tuple(single_column.rows[k] for k in kept)
    missing = tuple(replace(value, column=name) for value in single_column.missing)
    return SheetTable(
        single_column.title, (name,), rows, tuple(symbols[k] for k in kept) if single_column.symbols else (), missing
    )


def compensation_of(gears: GearSet, refinish: str | None = None) -> Compensation:
    """Return the settings that compensate assembly errors, as `Gears.compensate` describes them."""
    kind_system = systems.system_of(gears.design)
    if kind_system.compensate is None:
        able = [kind for kind in systems.loaded_kinds() if systems.system(kind).compensate is not None]
        raise DesignError("kind", gears.design.kind, reason="has no compensating settings", allowed=" or ".join(able))
    if refinish is None:
        warnings = gears.as_built.warnings
        return Compensation(gears.design, tuple(kind_system.compensate(gears.design)), warnings)
    if kind_system.refinish is None:
        able = [kind for kind in systems.loaded_kinds() if systems.system(kind).refinish is not None]
        raise ArgumentError(
            "refinish",
            refinish,
            reason=f"the settings of kind {gears.design.kind} determine the member; it can be chosen for "
            f"{' or '.join(able)}",
        )
    if refinish not in gears.names.members:
        raise ArgumentError("refinish", refinish, must_be=f"one of {', '.join(gears.names.members)}")
    warnings = gears.as_built.warnings
    return Compensation(gears.design, tuple(kind_system.refinish(gears.design, refinish)), warnings)
