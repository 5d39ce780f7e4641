"""The command `check`."""

from __future__ import annotations

import typer

from gearmesh.app.options import DesignFile, Json, Set, Timing, Tolerance, load_gears
from gearmesh.app.terminal import refuse_unwritable, show, tolerance_in_mm, warn, working, write_text
from gearmesh.errors import NoSolutionError


def check(
    design_file: DesignFile,
    json_file: Json = None,
    tol: Tolerance = None,
    timing: Timing = True,
    settings: Set = None,
) -> None:
    """Meshes against exact surfaces, roll test against solver."""
    tolerance = tolerance_in_mm(tol)
    refuse_unwritable(json_file)
    gears = load_gears(design_file, settings, lambda gears: gears.check(tolerance))
    with working("check"):
        answer = gears.check(tolerance)
    write_text(json_file, lambda: answer.json(timing=timing))
    if json_file != "-":
        show(answer.listings)
    warn(answer.warnings, answer.complaints)
    if answer.complaints:
        raise typer.Exit(NoSolutionError.exit_status)
