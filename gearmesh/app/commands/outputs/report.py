"""The command `report`."""

from __future__ import annotations

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
    unique_keys,
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
    errors: Annotated[
        list[str] | None,
        option("--errors KEY=A,B,C", "With OTHER: patterns of both at errors of assembly, of one key or two."),
    ] = None,
    settings: Set = None,
) -> None:
    """All results of a design as one HTML page that needs no network: a 3-D view of the gears in mesh, figures, plots, the data
    sheet.

    --tol sets the tolerance of the gears in the view, by default 10 um. With a second design OTHER, the page shows both side
    by side: figures and their changes, keys that differ, transmission errors, patterns; with --torque also under load.
    """
    torques = None if torque is None else torques_in_nm(torque)
    if other_file is not None:
        for name, value in {"tol": tol, "check": check or None, "study": study}.items():
            if value:
                raise ArgumentError(name, must_be="left out where two designs are compared")
        _compare(design_file, other_file, output, settings, torques, unique_keys("--errors", errors) or None)
        return
    if errors:
        raise ArgumentError("errors", entry=errors[0], reason="needs OTHER, a second design; --study has those of one")
    target = Path(f"{stem(design_file)}.html") if output is None else output
    refuse_suffix(target, HTML_SUFFIX)
    refuse_unwritable(target)
    tolerance = tolerance_in_mm(tol)
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
    design_file: Path,
    other_file: Path,
    output: Path | None,
    settings: list[str] | None,
    torques: list[float] | None,
    errors: dict[str, str] | None,
) -> None:
    """Write the page that compares two designs."""
    target = Path(f"{stem(design_file)}-{stem(other_file)}.html") if output is None else output
    refuse_suffix(target, HTML_SUFFIX)
    refuse_unwritable(target)
    first, second = (load_gears(file, settings, lambda gears: gears.contact()) for file in (design_file, other_file))
    with working("comparison"):
        page = first.compare(second, torque=torques, errors=errors)
        page.save(target)
    warn(page.warnings)
    if page.stuck:
        raise typer.Exit(NoSolutionError.exit_status)
