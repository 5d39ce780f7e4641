"""Table of gear data [ISO 1340, DIN 3966] and title block of one member, from the sheet of its design."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from gearmesh import __version__
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.sheet import sheet_of
from gearmesh.cad.brep import exact_volume
from gearmesh.design.core import Design
from gearmesh.design.keys import Key, Table
from gearmesh.drawing.facts import DataRow, Facts, number
from gearmesh.systems import system as systems
from gearmesh.systems.common.plain_sheet import MASS_TITLE, TOOLS_TITLE
from gearmesh.systems.system import DrawnRows, SheetTable
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.blank.end_edge import SHARP_ENDS
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import HEEL_END, TOE_END, Region
from gearmesh.teeth.tooth import Tooth

#: keys that appear elsewhere on the drawing
KEYS_SHOWN_ELSEWHERE = (
    *("gearmesh", "hand", "name", "kind", "units", "teeth", "stock"),
    *("end_chamfer", "end_chamfer_toe", "end_chamfer_heel", "end_chamfer_angle"),
    *("end_rounding", "end_rounding_toe", "end_rounding_heel"),
)
#: units of keys as written on the drawing
KEY_UNITS = {"length": "mm", "angle": "deg", "coefficient": "m_n"}
#: symbols of the deviations of the tip diameter
TIP_DEVIATIONS = ("A_dae", "A_dai")
#: symbols of rows that are words, because no standard has a symbol for them
WORD_SYMBOLS = frozenset(
    (
        "fixed",
        "feed",
        "rack",
        "form",
        "gap",
        "hand",
        "interference",
        "taper",
        "tool",
        "trimming",
        "trochoid",
        "undercut",
    )
)
#: names of rows that have words of another kind in the sheet
ROW_NAMES = {"tool": "tool"}
#: tolerances of profile (a) and helix (b), of ISO 1328-1
DEVIATION_SYMBOL = re.compile(r"([fF])_([fH]?)([ab])T")
#: index of profile and helix in these symbols
TRACE_INDICES = {"a": "alpha", "b": "beta"}
#: symbols as ISO 23509 prints them, letter and index, which the sheet joins
LETTER_AND_INDEX = re.compile(r"([Rbdhstx])([acefimnorstwxzFR]{1,3})")
#: largest turn (rad), and smallest advance (mm), of teeth without a hand
STRAIGHT_TURN_RAD = 1e-9
#: m^3 per mm^3
M3_PER_MM3 = 1e-9


def facts_of(gears: GearSet, member: Member) -> Facts:
    """Return the data on a drawing of a member. Raises the errors of its sheet."""
    design, tables = gears.design, sheet_of(gears).tables
    drawn_rows = systems.system_of(design).drawn
    if drawn_rows is not None:
        # false goes before true
        tables = tuple(sorted(tables, key=lambda table: table.title != drawn_rows.measured))
    mates = [
        name for pair in gears.pairs if member.name in pair.members for name in pair.members if name != member.name
    ]
    if drawn_rows is None:
        keys = _keys(design, member.name)
        rows = [
            *keys,
            *_hand(member),
            *(row for row in _everything(tables, member.name) if row not in keys),
            *_teeth_of_mates(gears, mates),
        ]
    else:
        rows = _rows(tables, member.name, mates, drawn_rows, drawn_rows.accuracy in design.model_fields_set)
    own_rows = next((k for k, row in enumerate(rows) if row.heading), len(rows))
    reference = None if drawn_rows is None or drawn_rows.reference is None else drawn_rows.reference
    ends = tuple(_value(tables, symbol, member.name) for symbol in reference or ())
    deviations = tuple(_value(tables, symbol, member.name) for symbol in TIP_DEVIATIONS)
    in_mm = design.in_mm()
    density = in_mm.density(member.name)
    modulus, _ = in_mm.elastic(member.name)
    own = [*rows[:own_rows], *_end_chamfers(member), *_stock(gears.stock(member.name))]
    return Facts(
        rows=(
            *own,
            *_tools(tables, member.name, {row.symbol for row in own}),
            *_material(modulus, density),
            *rows[own_rows:],
        ),
        tip=None if drawn_rows is None else _value(tables, drawn_rows.tip, member.name),
        reference=(float(ends[0]), float(ends[1])) if len(ends) == 2 and None not in ends else None,
        tip_deviations=(float(deviations[0]), float(deviations[1])) if None not in deviations else None,
        title=design.title,
        part=f"{member.name.replace('_', ' ')}, {_count(member.tooth)}",
        mass=f"{number(density * M3_PER_MM3 * exact_volume(member))} kg",
        version=f"gearmesh {__version__}",
        units="mm, deg",
    )


def _hand(member: Member) -> list[DataRow]:
    """Return a row for the hand of the teeth, from the middle of the tooth at both ends; none for straight teeth."""
    tooth = member.one_tooth
    angles, levels = [], []
    for station in (0.0, 1.0):
        section = tooth.sections([station])
        # middle of the land
        land = tooth.grid(Region.LAND, np.array([0.0, 1.0]), section).points[0]
        middle = land.mean(axis=0)
        angles.append(np.arctan2(middle[1], middle[0]))
        levels.append(middle[2])
    turn, advance = np.diff(angles)[0], np.diff(levels)[0]
    if abs(turn) < STRAIGHT_TURN_RAD or abs(advance) < STRAIGHT_TURN_RAD:
        return []
    return [DataRow("hand of the teeth", "", "right" if turn * advance > 0.0 else "left")]


def _teeth_of_mates(gears: GearSet, mates: Iterable[str]) -> list[DataRow]:
    """Return a heading for each mating gear, and its number of teeth."""
    rows: list[DataRow] = []
    for name in {_column(mate): mate for mate in mates}.values():
        rows += [
            DataRow(f"Mating gear: {_column(name)}", heading=True),
            DataRow("teeth", "z", str(gears.member(name).tooth.teeth)),
        ]
    return rows


def _material(modulus: float, density: float) -> list[DataRow]:
    """Return the rows of Young's modulus (MPa) and density (kg/m^3)."""
    return [
        DataRow("Young's modulus", "E", f"{number(modulus / 1000.0)} GPa"),
        DataRow("density", "rho", f"{number(density)} kg/m\N{SUPERSCRIPT THREE}"),
    ]


def _tools(tables: Iterable[SheetTable], name: str, shown: set[str]) -> list[DataRow]:
    """Return the rows of the tools of a member: both flanks beside each other if their tools differ.

    `shown`: symbols that the drawing has already.
    """
    table = next((table for table in tables if table.title == TOOLS_TITLE), None)
    if table is None:
        return []
    columns = [k for k, column in enumerate(table.columns) if column.partition(",")[0] in (name, _column(name))][:2]
    suffix = ", right / left" if len(columns) > 1 else ""
    rows: list[DataRow] = []
    for symbol, (words, unit, *values) in zip(table.symbols, table.rows, strict=True):
        ends = [values[k] for k in columns]
        if not ends or ends[0] is None or drawn_symbol(symbol) in shown - {""}:
            continue
        words = words if symbol == "tool" else f"tool: {words}"
        if len(set(ends)) == 1:
            rows.append(_row(symbol, words, unit, ends[0]))
        else:
            joined = " / ".join("-" if end is None else number(end) if isinstance(end, float) else end for end in ends)
            rows.append(_row(symbol, words + suffix, unit, joined))
    return rows


def _stock(stock: float) -> list[DataRow]:
    """Return a row for the stock (mm) on the flanks, if there is any."""
    return [DataRow("stock on each flank, not drawn", "q", f"{number(stock)} mm")] if stock else []


def _count(tooth: Tooth) -> str:
    """Number of teeth, or of threads, in words."""
    one, several = ("tooth", "teeth") if tooth.screw is None else ("thread", "threads")
    return f"{tooth.teeth} {one if tooth.teeth == 1 else several}"


def _end_chamfers(member: Member) -> list[DataRow]:
    """Return a row for the broken edges of the end faces, if there are any."""
    ends, names = member.tooth.blank.ends, end_names(member.tooth.blank.axial)
    if ends == SHARP_ENDS:
        return []
    toe, heel = (
        "sharp"
        if end is None
        else f"R {number(end.width)} mm"
        if end.rounded
        else f"{number(end.width)} mm x {number(np.degrees(np.arctan2(end.depth, end.width)), 2)}°"
        for end in (ends[names.index(TOE_END)], ends[names.index(HEEL_END)])
    )
    name = "rounding" if any(end is not None and end.rounded for end in ends) else "chamfer"
    if any(end is not None and not end.rounded for end in ends) and name == "rounding":
        name = "broken edge"
    return [DataRow(f"{name} of the end faces, toe / heel", value=toe if toe == heel else f"{toe} / {heel}")]


def _column(name: str) -> str:
    """Name of a member in tables: planets are alike, and have no numbers."""
    return re.sub(r"_\d+$", "", name)


def _cells(
    tables: Iterable[SheetTable], name: str, ranges: tuple[tuple[str, ...], ...] = ()
) -> Iterator[tuple[str, str, str, Any]]:
    """Yield symbol, words, unit and value of all rows about a member, or about its pairs.

    Values of both sides of a member, in columns such as "pinion, right", are beside each other. For a table with other
    columns the values come from the first of `ranges` that it has, beside each other.
    """
    for table in tables:
        head, colon, _ = table.title.partition(": ")
        if colon and _column(name) not in head.lower().split():
            continue
        column = next(
            (k for k, column_name in enumerate(table.columns) if column_name in (name, _column(name), "")), None
        )
        if column is None:
            beside = [k for k, other in enumerate(table.columns) if other.partition(", ")[0] in (name, _column(name))]
            if len(beside) > 1 and table.title != TOOLS_TITLE:
                yield from _of_sides(table, beside)
            else:
                yield from _of_range(table, ranges)
            continue
        for symbol, (words, unit, *values) in zip(table.symbols or ("",) * len(table.rows), table.rows, strict=True):
            if values[column] is not None:
                yield symbol, words, unit, values[column]


def _of_sides(table: SheetTable, columns: list[int]) -> Iterator[tuple[str, str, str, Any]]:
    """Yield rows with the values of both sides of a member in some columns of a table."""
    sides = " / ".join(table.columns[k].partition(", ")[2] for k in columns)
    for symbol, (words, unit, *values) in zip(table.symbols, table.rows, strict=True):
        ends = [values[k] for k in columns]
        if None in ends:
            continue
        joined = " / ".join(number(end, 4) if isinstance(end, float) else str(end) for end in ends)
        yield symbol, f"{words}, {sides}", unit, joined


def _of_range(table: SheetTable, ranges: tuple[tuple[str, ...], ...]) -> Iterator[tuple[str, str, str, Any]]:
    """Yield rows of a table of pairs with the values of several columns, as the least and the largest backlash."""
    names = next((names for names in ranges if set(names) <= set(table.columns)), None)
    if names is None:
        return
    for symbol, (words, unit, *values) in zip(table.symbols, table.rows, strict=True):
        ends = [values[table.columns.index(name)] for name in names]
        if None not in ends:
            suffix = f" ({' / '.join(names)})" if len(names) > 1 else ""
            value = " / ".join(number(value_of_end, 4) for value_of_end in ends) if suffix else ends[0]
            yield symbol, f"{table.title.rpartition(': ')[2].lower()}: {words.partition(',')[0]}{suffix}", unit, value


def _value(tables: Iterable[SheetTable], symbol: str, name: str) -> Any:
    """Return the value of a symbol, None if the sheet has none."""
    return next((value for cell_symbol, _, _, value in _cells(tables, name) if cell_symbol == symbol), None)


def _rows(
    tables: Iterable[SheetTable], name: str, mates: Iterable[str], drawn: DrawnRows, has_class: bool
) -> list[DataRow]:
    """Return rows by their symbols, followed by the rows of the mating gears.

    `has_class`: the design sets the accuracy class. Otherwise the drawing has the default class without its tolerances.
    """
    cells = list(_cells(tables, name, drawn.ranges))
    rows: list[DataRow] = []
    for symbol in drawn.own:
        rows += [*(_row(*cell) for cell in _first(cells, symbol)), *_limits(cells, symbol)]
    for symbol in drawn.tolerances if has_class else drawn.tolerances[:1]:
        for _, words, unit, value in _first(cells, symbol):
            rows.append(_row(symbol, words, unit, value if has_class else f"{value}, default"))
    for mate in dict.fromkeys(_column(mate) for mate in mates):
        mate_cells = list(_cells(tables, mate))
        of_mate = [_row(*cell) for symbol in drawn.mating for cell in _first(mate_cells, symbol)]
        if of_mate:
            rows += [DataRow(f"Mating gear: {mate}", heading=True), *of_mate]
    return rows


def _first(cells: Iterable[tuple[str, str, str, Any]], symbol: str) -> list[tuple[str, str, str, Any]]:
    """Return the first cell of a symbol, in a list."""
    return [cell for cell in cells if cell[0] == symbol][:1]


def _everything(tables: Iterable[SheetTable], name: str) -> list[DataRow]:
    """Return all rows about a member, and about its pairs in tables with a column for the member."""
    titles_elsewhere = MASS_TITLE, TOOLS_TITLE
    own = [table for table in tables if table.columns != ("",) and table.title not in titles_elsewhere]
    return [_row(*cell) for cell in _cells(own, name) if cell[1] != "volume"]


def _keys(design: Design, name: str) -> list[DataRow]:
    """Return numbers and words of the design, and of this member's table, by their keys."""
    design_in_mm = design.in_mm()
    tables: list[Table] = [design_in_mm]
    tables += [
        part
        for part in (getattr(design_in_mm, name, None) or getattr(design_in_mm, _column(name), None),)
        if isinstance(part, Table)
    ]
    rows: dict[str, DataRow] = {}
    for table in tables:
        for key, field in type(table).model_fields.items():
            value = getattr(table, key)
            meaning = next(
                (part_of_metadata for part_of_metadata in field.metadata if isinstance(part_of_metadata, Key)), None
            )
            plain = isinstance(value, int | float | str) and not isinstance(value, bool)
            if plain and meaning is not None and key not in KEYS_SHOWN_ELSEWHERE:
                rows[key] = _row("", key.replace("_", " "), KEY_UNITS.get(meaning.unit, ""), value)
    return list(rows.values())


def _limits(cells: list[tuple[str, str, str, Any]], symbol: str) -> list[DataRow]:
    """Return one row for both limits of an allowance, if the sheet has them."""
    upper, lower = (_first(cells, symbol + end) for end in ("_upper", "_lower"))
    if not upper or not lower:
        return []
    (_, words, unit, high), (_, _, _, low) = upper[0], lower[0]
    return [
        DataRow(f"{words.rpartition(',')[0]}, upper / lower", symbol, f"{number(high, 4)} / {number(low, 4)} {unit}")
    ]


def _row(symbol: str, words: str, unit: str, value: Any) -> DataRow:
    """Return a row of gear data; lengths in um have one decimal, other numbers four."""
    if isinstance(value, float):
        value = number(value, 1 if unit == "um" else 4)
    elif isinstance(value, int):
        value = str(value).replace("-", "\N{MINUS SIGN}")
    sign = {"-": "", "deg": "\N{DEGREE SIGN}", "um": "µm", "m_n": "m_n"}.get(unit, unit)
    text = f"{value}{'' if sign == chr(176) else ' '}{sign}".strip()
    return DataRow(ROW_NAMES.get(symbol, words.partition(";")[0]), drawn_symbol(symbol), text)


def drawn_symbol(symbol: str) -> str:
    """Return a symbol of the sheet as a drawing shows it: the symbol of the standard, d_ae for dae; none for words, as
    hand.
    """
    if symbol in WORD_SYMBOLS:
        return ""
    if deviation := DEVIATION_SYMBOL.fullmatch(symbol):
        size, kind, trace = deviation.groups()
        return "_".join(part for part in (size, kind, TRACE_INDICES[trace], "T") if part)
    letters = LETTER_AND_INDEX.fullmatch(symbol)
    return "_".join(letters.groups()) if letters and symbol != "beta" else symbol
