"""The command `report`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearmesh.app.options import (
    DesignFile,
    Set,
    Tolerance,
    design_text,
    load_gears,
    option,
    present,
    stem,
    torques_in_nm,
)
from gearmesh.app.terminal import refuse_unwritable, tolerance_in_mm, warn, working
from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.formats import HTML_SUFFIX, refuse_suffix
from gearmesh.progress import Progress, silent
from gearmesh.view.opengl import begin_drawing

if TYPE_CHECKING:
    from gearmesh import Gears, ReportPage


def report(
    design_file: DesignFile,
    other_file: Annotated[
        Path | None,
        typer.Argument(
            metavar="OTHER",
            help="Another design: the page compares both.",
            show_default=False,
            callback=lambda path: None if path is None else present(path),
        ),
    ] = None,
    output: Annotated[Path | None, option("-o --output FILE.html", "Page to write. [default: DESIGN.html]")] = None,
    tol: Tolerance = None,
    check: Annotated[
        bool, option("--check", "Also check meshes and contact, as `check` does, with the verdicts on the page.")
    ] = False,
    study: Annotated[
        list[Path] | None, option("--study DIR", "Folder of a finished study to include. Repeatable.")
    ] = None,
    torque: Annotated[
        str | None, option("--torque NM[,NM...]", "One torque on the pinion, or several: adds contact under load.")
    ] = None,
    settings: Set = None,
) -> None:
    """All results of a design as one HTML page that needs no network: a 3-D view of the gears in mesh, figures, plots, the data
    sheet.

    --tol is that of the gears in the view, by default 10 um. With OTHER, a second design, the page has both side by side:
    figures with their change, keys that differ, transmission errors, patterns.
    """
    if other_file is not None:
        given = {"tol": tol, "check": check or None, "study": study, "torque": torque}
        _compare(design_file, other_file, output, settings, [name for name, value in given.items() if value])
        return
    target = Path(f"{stem(design_file)}.html") if output is None else output
    refuse_suffix(target, HTML_SUFFIX)
    refuse_unwritable(target)
    tolerance = tolerance_in_mm(tol)
    torques = None if torque is None else torques_in_nm(torque)
    begin_drawing()

    def ask(gears: Gears, source: str | None = None, progress: Progress = silent) -> ReportPage:
        return gears.report(
            tolerance, check=check, source=source, studies=study or (), torque=torques, progress=progress
        )

    gears = load_gears(design_file, settings, ask)
    with working("report page") as progress:
        page = ask(gears, design_text(design_file, settings), progress)
        page.save(target)
    warn(page.warnings)
    if page.stuck or page.complaints:
        raise typer.Exit(NoSolutionError.exit_status)


def _compare(
    design_file: Path, other_file: Path, output: Path | None, settings: list[str] | None, given: Sequence[str]
) -> None:
    """Write the page that compares two designs; options `given` that belong to one design are refused."""
    for name in given:
        raise ArgumentError(name, must_be="left out where two designs are compared")
    target = Path(f"{stem(design_file)}-{stem(other_file)}.html") if output is None else output
    refuse_suffix(target, HTML_SUFFIX)
    refuse_unwritable(target)
    first, second = (load_gears(file, settings, lambda gears: gears.contact()) for file in (design_file, other_file))
    with working("comparison"):
        page = first.compare(second)
        page.save(target)
    warn(page.warnings)
    if page.stuck:
        raise typer.Exit(NoSolutionError.exit_status)
