"""The command `describe`: gear systems, their keys, the figures of answers, and the data sheet of a design."""

from __future__ import annotations

import os
import sys
import textwrap
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Annotated, Any

import typer

import gearmesh as gm
from gearmesh.answers.tables import LINE_WIDTH, Listing
from gearmesh.app.options import (
    Json,
    Set,
    SheetSpeed,
    SheetTorque,
    load_alone,
    load_gears,
    option,
    refuse_torque,
)
from gearmesh.app.terminal import refuse_unwritable, show, warn, write_text
from gearmesh.arguments import refuse_speed
from gearmesh.errors import ArgumentError
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX

#: name of the schema of report.json, beside the kinds
REPORT_SCHEMA = "report"
#: width of the column of keys, characters
KEY_COLUMN_WIDTH = 28
#: indentation of the second and later lines of a key
KEY_INDENT = "    "

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.sheet import DesignSheet
    from gearmesh.design.keys import KeyLine


def describe(
    what: Annotated[str | None, typer.Argument(metavar="[KIND|DESIGN]", show_default=False)] = None,
    table: Annotated[
        str | None,
        typer.Argument(
            metavar="[TABLE]", help="Only the keys of this table of the kind, as pinion.keyway.", show_default=False
        ),
    ] = None,
    every_key: Annotated[bool, option("--all", "Every key of the kind, not only those that most designs set.")] = False,
    json_file: Json = None,
    torque: SheetTorque = None,
    speed: SheetSpeed = None,
    member: Annotated[str | None, option("--member NAME", "Only this member, without its mating gear.")] = None,
    settings: Set = None,
    figures: Annotated[
        bool,
        option(
            "--figures", "The meaning of every figure in JSON and tables; add a word to list the keys that contain it."
        ),
    ] = False,
    schema: Annotated[
        bool,
        option(
            "--schema",
            "The JSON Schema of the design files of a kind, for editors, or with report that of report.json.",
        ),
    ] = False,
) -> None:
    """The gear systems, the keys of one of them, the data sheet of a design, or the meaning of figures."""
    of_sheet = (("--torque", torque), ("--speed", speed), ("--member", member), ("--set", settings))
    of_kind = (("TABLE", table), ("--all", every_key))
    if figures:
        _refuse((*of_sheet, *of_kind), must_be="left out with --figures")
        _figures(what or "", json_file)
        return
    if schema:
        _refuse(of_kind, must_be="left out with --schema")
        if what not in (*gm.kinds(), REPORT_SCHEMA):
            allowed = f"{', '.join(gm.kinds())}, or {REPORT_SCHEMA} for report.json"
            raise ArgumentError("--schema", reason="needs a kind", allowed=allowed)
        refuse_unwritable(json_file)
        write_text(json_file or "-", lambda: _schema(str(what)))
        return
    if what is not None and (what == "-" or Path(what).suffix in (TOML_SUFFIX, JSON_SUFFIX)):
        _refuse(of_kind, reason="needs a kind")
        refuse_torque(torque)
        refuse_speed(speed)
        refuse_unwritable(json_file)
        sheet = _sheet(Path(what), settings, (torque, speed), member)
        write_text(json_file, sheet.json)
        if json_file != "-":
            show(sheet.listings)
        warn(sheet.warnings)
        return
    _refuse(of_sheet, reason="needs a design file to describe")
    if what is None:
        _refuse(of_kind, reason="needs a kind")
    elif table is not None:
        _refuse((("--all", every_key),), must_be="left out with a table, whose keys are all listed")
    groups = {} if what is None else _groups(what, table)
    refuse_unwritable(json_file)
    write_text(json_file, lambda: _document(what, table, groups))
    if json_file == "-":
        return
    if what is None:
        show([_kinds()])
    elif every_key or table is not None:
        sys.stdout.write(_keys(what, groups, _width()))
    else:
        sys.stdout.write(_usual_keys(what, groups, _width()))


def _refuse(options: Iterable[tuple[str, object]], *, reason: str = "", must_be: str = "") -> None:
    """Raise ArgumentError for the first option that is given."""
    for name, given in options:
        if given:
            raise ArgumentError(name, reason=reason, must_be=must_be)


def _figures(word: str, json_file: str | None) -> None:
    """Print the meaning of figures whose key contains a word. Raises ArgumentError if there are none."""
    from gearmesh.answers.tables import json_text
    from gearmesh.api.reference import figure_groups, figures_document

    refuse_unwritable(json_file)
    groups = figure_groups(word)
    if not groups:
        raise ArgumentError("figures", entry=word, must_be="part of the key of a figure; --figures alone lists all")
    write_text(json_file, lambda: json_text(figures_document(groups)))
    if json_file != "-":
        show([group.listing for group in groups])


def _sheet(
    design_file: Path, settings: list[str] | None, asked: tuple[float | None, float | None], member: str | None
) -> DesignSheet:
    """Return the data sheet of a design or of one member; `asked`: torque and speed."""
    torque, speed = asked

    def ask(gears: Gears) -> DesignSheet:
        return gears.sheet(torque=torque, speed=speed, member=member)

    if member is None:
        return ask(load_gears(design_file, settings, ask))
    return ask(load_alone(design_file, settings, ask, member))


def _kinds() -> Listing:
    """Return the list of the kinds of design, one per line."""
    from gearmesh.systems.system import about

    return Listing("", ("kind", "what"), [(kind, about(kind)) for kind in gm.kinds()])


def _schema(kind: str) -> str:
    """Return the JSON Schema of the files of a kind, or of report.json."""
    from gearmesh.answers.tables import json_text
    from gearmesh.api.design_schema import design_schema
    from gearmesh.systems.system import design_class

    if kind == REPORT_SCHEMA:
        from gearmesh.api.report_schema import report_schema

        return json_text(report_schema())
    return json_text(design_schema(design_class(kind), kind))


def _groups(kind: str, table: str | None) -> dict[str, list[KeyLine]]:
    """Return the keys of a kind by the titles of their tables, or only the keys of one table or title. Raises ArgumentError."""
    from gearmesh.errors import nearest
    from gearmesh.systems.system import design_class

    groups = design_class(kind).key_groups()
    if table is None:
        return groups
    lines = list(design_class(kind).key_lines())
    found = [line for line in lines if line.key == table or line.key.startswith(f"{table}.")] or groups.get(table)
    if found:
        return {"": found}
    paths = [line.key.split(".") for line in lines]
    known = {".".join(path[:depth]) for path in paths for depth in range(1, len(path) + 1)} | groups.keys()
    close = nearest(table, sorted(known))
    hint = f"did you mean {close}?" if close else f"gearmesh describe {kind} lists its tables"
    raise ArgumentError("TABLE", table, reason=f"no table or key of {kind}; {hint}")


def _document(kind: str | None, table: str | None, groups: Mapping[str, list[KeyLine]]) -> str:
    """Return, as JSON, the kinds, all keys of a kind, or the keys of one table; a table used several times is listed once."""
    from gearmesh.answers.tables import json_text
    from gearmesh.systems.system import about

    if kind is None:
        return json_text({"gearmesh": gm.__version__, "kinds": {name: about(name) for name in gm.kinds()}})
    document: dict[str, Any] = {"gearmesh": gm.__version__, "kind": kind, "about": about(kind)}
    keys = {name: [asdict(line) for line in lines] for name, lines in groups.items()}
    if table is not None:
        return json_text({**document, "table": table, "keys": keys[""]})
    return json_text({**document, "keys": keys.pop(""), "tables": keys})


def _width() -> int:
    """Return the characters in a line: of the terminal, of COLUMNS, or unlimited in a pipe."""
    if sys.stdout.isatty() or "COLUMNS" in os.environ:
        return get_terminal_size((LINE_WIDTH, 24)).columns
    return sys.maxsize


def _keys(kind: str, groups: Mapping[str, list[KeyLine]], width: int) -> str:
    """Return the lines of keys by the titles of their tables, broken at the width."""
    text = []
    for name, lines in groups.items():
        text.append(name or f'kind = "{kind}"')
        column = min(max(len(line.key) for line in lines), KEY_COLUMN_WIDTH)
        for line in lines:
            default = line.default if line.default == "required" else f"default {line.default}"
            allowed = ", ".join(part for part in (line.unit, line.range) if part)
            source = f" {line.source}" if "[" in line.source else f" [{line.source}]" if line.source else ""
            said = f"{line.key.ljust(column)}  ({allowed}; {default}) {line.about}{source}"
            text += _wrapped(said, width)
        text.append("")
    return "\n".join(text)


def _usual_keys(kind: str, groups: Mapping[str, list[KeyLine]], width: int) -> str:
    """Return the lines of the keys that most designs of a kind set, with the number and the tables of the other keys."""
    from gearmesh.systems.system import design_class

    design = design_class(kind)
    usual = set(design.usual_keys())
    shown = [line for line in groups[""] if line.key in usual]
    left_out = [line.key for line in design.key_lines() if line.key not in usual]
    notes = (
        f"{len(left_out)} more keys, which few designs set, are listed by gearmesh describe {kind} --all, "
        f"and those of one table by gearmesh describe {kind} TABLE.",
        *_tables(left_out),
    )
    return "\n".join([_keys(kind, {"": shown}, width), *(line for note in notes for line in _wrapped(note, width)), ""])


def _tables(keys: Iterable[str]) -> Iterator[str]:
    """Yield the names of the tables of keys: of the file, then in each table; tables with the same contents share a line."""
    inner: dict[str, dict[str, None]] = {}
    for key in keys:
        table, *rest = key.split(".")[:-1] or [""]
        if table:
            inner.setdefault(table, {}).update(dict.fromkeys(rest[:1]))
    yield f"Tables: {', '.join(inner)}."
    alike: dict[tuple[str, ...], list[str]] = {}
    for table, inside in inner.items():
        alike.setdefault(tuple(inside), []).append(table)
    for names, tables in alike.items():
        if names:
            yield f"Tables in {', '.join(tables)}: {', '.join(names)}."


def _wrapped(text: str, width: int) -> list[str]:
    """Return the lines of a text, broken at the width; all lines but the first are indented."""
    return textwrap.wrap(text, width, subsequent_indent=KEY_INDENT, break_long_words=False, break_on_hyphens=False)
