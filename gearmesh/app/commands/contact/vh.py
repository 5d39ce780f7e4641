"""The command `vh`."""

from __future__ import annotations

from typing import Annotated

import typer

from gearmesh.app.options import DesignFile, Json, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.errors import NoSolutionError

Moved = Annotated[
    str | None,
    option(
        "--move A[,B]",
        "Displacements to find: V, H (pinion), J (gear), alpha (shaft angle). Two for bevel gears; for worm drives one of V, "
        "J and alpha.  [default: V,H; worm drives: J]",
    ),
]


def vh(design_file: DesignFile, json_file: Json = None, settings: Set = None, move: Moved = None) -> None:
    """V-H check of bevel gears and worm drives: displacements that bring the contact to toe, middle and heel, on both sides.

    For worm drives the places are the middle, the entering and the leaving side of the wheel's face. --set assembly.dG and
    assembly.d_delta (J and alpha) mount the gear otherwise. Every place is proved by the first touch of the displaced
    members. If a place is out of reach, the refusal names the nearest place within reach.
    """
    refuse_unwritable(json_file)
    moved = None if move is None else tuple(move.split(","))
    gears = load_gears(design_file, settings, lambda gears: gears.vh(moved))
    with working("V-H check"):
        answer = gears.vh(moved)
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
    warn(answer.warnings, answer.complaints)
    if answer.complaints:
        raise typer.Exit(NoSolutionError.exit_status)
