"""The command `vh`."""

from __future__ import annotations

from typing import Annotated

import typer

from gearmesh.app.options import DesignFile, Json, Set, load_gears
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.errors import ArgumentError, NoSolutionError

Moved = Annotated[
    str,
    typer.Option(
        "--move",
        metavar="A,B",
        help="The two displacements to find, of V, H (pinion), J (gear) and alpha (shaft angle).",
    ),
]


def vh(design_file: DesignFile, json_file: Json = None, settings: Set = None, move: Moved = "V,H") -> None:
    """V-H check of bevel gears: displacements that bring the contact to toe, middle and heel, on both sides.

    With --set assembly.dG and assembly.d_delta (J and alpha) for another mounting of the gear. Every place is proved by the first
    touch of the displaced members; one that is out of reach is refused with the nearest that is not.
    """
    refuse_unwritable(json_file)
    first, _, second = move.partition(",")
    if not second:
        raise ArgumentError("move", move, must_be="two of V, H, J, alpha, as V,H")
    gears = load_gears(design_file, settings)
    with working("V-H check"):
        answer = gears.vh((first, second))
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
    warn(answer.warnings, answer.complaints)
    if answer.complaints:
        raise typer.Exit(NoSolutionError.exit_status)
