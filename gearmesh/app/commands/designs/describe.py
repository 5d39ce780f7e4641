"""The command `describe`: gear systems, their keys, the figures of answers, and what is derived from a design."""

from __future__ import annotations

import os
import sys
import textwrap
from dataclasses import asdict
from pathlib import Path
from shutil import get_terminal_size
from typing import TYPE_CHECKING, Annotated

import typer

import gearmesh as gm
from gearmesh.answers.tables import WIDTH, Listing
from gearmesh.app.options import Json, Set, SheetSpeed, SheetTorque, load_alone, load_gears, refuse_speed, refuse_torque
from gearmesh.app.terminal import refuse_unwritable, show, warn, write_text
from gearmesh.errors import ArgumentError

#: what --schema takes beside kinds
REPORT = "report"
#: characters that keys are padded to, and by which a key's lines below its first are indented
KEY, INDENT = 28, "    "

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.sheet import DesignSheet


def describe(
    what: Annotated[str | None, typer.Argument(metavar="[KIND|DESIGN]", show_default=False)] = None,
    json_file: Json = None,
    torque: SheetTorque = None,
    speed: SheetSpeed = None,
    member: Annotated[
        str | None,
        typer.Option("--member", metavar="NAME", help="Only this member, without its mating gear.", show_default=False),
    ] = None,
    settings: Set = None,
    figures: Annotated[
        bool,
        typer.Option(
            "--figures",
            help="The meaning of every figure in JSON and tables; add a word to list the keys that contain it.",
        ),
    ] = False,
    schema: Annotated[
        bool,
        typer.Option(
            "--schema",
            help="The JSON Schema of the design files of a kind, for editors, or with report that of report.json.",
        ),
    ] = False,
) -> None:
    """The gear systems, every key of one of them, the data sheet of a design, or the meaning of figures."""
    if figures:
        for option, given in (("--torque", torque), ("--speed", speed), ("--member", member), ("--set", settings)):
            if given:
                raise ArgumentError(option, must_be="left out with --figures")
        _figures(what or "", json_file)
        return
    if schema:
        if what not in (*gm.kinds(), REPORT):
            allowed = f"{', '.join(gm.kinds())}, or {REPORT} for report.json"
            raise ArgumentError("--schema", reason="needs a kind", allowed=allowed)
        refuse_unwritable(json_file)
        write_text(json_file or "-", lambda: _schema(str(what)))
        return
    if what is not None and (what == "-" or Path(what).suffix in (".toml", ".json")):
        refuse_torque(torque)
        refuse_speed(speed)
        refuse_unwritable(json_file)
        sheet = _sheet(Path(what), settings, (torque, speed), member)
        write_text(json_file, sheet.json)
        if json_file != "-":
            show(sheet.listings)
        warn(sheet.warnings)
        return
    for option, given in (
        ("--torque", torque),
        ("--speed", speed),
        ("--member", member),
        ("--set", settings),
    ):
        if given:
            raise ArgumentError(option, reason="needs a design file to describe")
    refuse_unwritable(json_file)
    write_text(json_file, lambda: _document(what))
    if json_file == "-":
        return
    if what is None:
        show([_kinds()])
    else:
        sys.stdout.write(_keys(what, _width()))


def _figures(word: str, json_file: str | None) -> None:
    """What figures mean whose key contains a word. Raises DesignError where there are none."""
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
    """The sheet of a design, or of one of its members; `asked`: torque and speed."""
    torque, speed = asked

    def ask(gears: Gears) -> DesignSheet:
        return gears.sheet(torque=torque, speed=speed, member=member)

    load = load_gears if member is None else load_alone
    return ask(load(design_file, settings, ask))


def _kinds() -> Listing:
    """The kinds of design, one per line."""
    from gearmesh.systems.system import about

    return Listing("", ("kind", "what"), [(kind, about(kind)) for kind in gm.kinds()])


def _schema(kind: str) -> str:
    """The JSON Schema of a kind's files, or of report.json."""
    from gearmesh.answers.tables import json_text
    from gearmesh.api.design_schema import design_schema
    from gearmesh.systems.system import design_class

    if kind == REPORT:
        from gearmesh.api.report_schema import report_schema

        return json_text(report_schema())
    return json_text(design_schema(design_class(kind), kind))


def _document(kind: str | None) -> str:
    """The kinds, or all keys of one of them and of the tables that stand in several places of it, as JSON."""
    from gearmesh.answers.tables import json_text
    from gearmesh.systems.system import about, design_class

    if kind is None:
        return json_text({"gearmesh": gm.__version__, "kinds": {name: about(name) for name in gm.kinds()}})
    design = design_class(kind)
    groups = {name: [asdict(line) for line in lines] for name, lines in design.key_groups().items()}
    return json_text(
        {
            "gearmesh": gm.__version__,
            "kind": kind,
            "about": design.about,
            "keys": groups.pop(""),
            "tables": groups,
        }
    )


def _width() -> int:
    """Characters in a line: those of the terminal or of COLUMNS; in a pipe each key has a line for itself."""
    if sys.stdout.isatty() or "COLUMNS" in os.environ:
        return get_terminal_size((WIDTH, 24)).columns
    return sys.maxsize


def _keys(kind: str, width: int) -> str:
    """Every key of a kind, and of tables that stand in several places of it, a line each where the width has room for it."""
    from gearmesh.systems.system import design_class

    text = []
    for name, lines in design_class(kind).key_groups().items():
        text.append(name or f'kind = "{kind}"')
        column = min(max(len(line.key) for line in lines), KEY)
        for line in lines:
            default = line.default if line.default == "required" else f"default {line.default}"
            allowed = ", ".join(part for part in (line.unit, line.range) if part)
            source = f" {line.source}" if "[" in line.source else f" [{line.source}]" if line.source else ""
            said = f"{line.key.ljust(column)}  ({allowed}; {default}) {line.about}{source}"
            text += textwrap.wrap(said, width, subsequent_indent=INDENT, break_long_words=False, break_on_hyphens=False)
        text.append("")
    return "\n".join(text)
