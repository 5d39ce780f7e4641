"""The command `describe`: gear systems, their keys, the figures of answers, and what is derived from a design."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import gearmesh as gm
from gearmesh.answers.tables import Listing
from gearmesh.app.options import Json, Set, SheetSpeed, SheetTorque, load_alone, load_gears, refuse_speed, refuse_torque
from gearmesh.app.terminal import refuse_unwritable, show, warn, write_text
from gearmesh.errors import ArgumentError

if TYPE_CHECKING:
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
) -> None:
    """The gear systems, every key of one of them, the data sheet of a design, or the meaning of figures."""
    if figures:
        for option, given in (("--torque", torque), ("--speed", speed), ("--member", member), ("--set", settings)):
            if given:
                raise ArgumentError(option, must_be="left out with --figures")
        _figures(what or "", json_file)
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
        ("--json", json_file),
        ("--torque", torque),
        ("--speed", speed),
        ("--member", member),
        ("--set", settings),
    ):
        if given:
            raise ArgumentError(option, reason="needs a design file to describe")
    show([_kinds()] if what is None else _keys(what))


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
    design_file: Path, settings: list[str] | None, load: tuple[float | None, float | None], member: str | None
) -> DesignSheet:
    """The sheet of a design, or of one of its members; `load`: torque and speed."""
    torque, speed = load
    if member is None:
        return load_gears(design_file, settings).sheet(torque=torque, speed=speed)
    return load_alone(design_file, settings).sheet(torque=torque, speed=speed, member=member)


def _kinds() -> Listing:
    """The kinds of design, one per line."""
    return Listing("", ("kind", "what"), [(kind, gm.system(kind).design.about) for kind in gm.kinds()])


def _keys(kind: str) -> list[Listing]:
    """Every key of a kind, and of tables that stand in several places of it."""
    tables = []
    for name, lines in gm.system(kind).design.key_groups().items():
        rows = []
        for line in lines:
            allowed = ", ".join(part for part in (line.unit, line.range) if part)
            source = f" {line.source}" if line.source else ""
            rows.append((line.key, allowed, line.default, line.about + source))
        tables.append(Listing(name or f'kind = "{kind}"', ("key", "unit, allowed", "default", "what"), rows))
    return tables
