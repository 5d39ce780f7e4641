"""The command `run`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gearmesh as gm
from gearmesh.app.options import (
    DesignFile,
    Set,
    Timing,
    Tolerance,
    design_text,
    load_design,
    option,
    stem,
    torques_in_nm,
)
from gearmesh.app.terminal import output_folder, refuse_folder, show, tolerance_in_mm, warn, working
from gearmesh.errors import NoSolutionError
from gearmesh.view.opengl import begin_drawing


def run(
    design_file: DesignFile,
    output: Annotated[Path | None, option("-o --output DIR", "Folder for the results. [default: out/DESIGN]")] = None,
    tol: Tolerance = None,
    torque: Annotated[
        str | None,
        option(
            "--torque NM[,NM...]",
            "One torque on the pinion of the first mesh, or several: adds loaded contact of every mesh, as `load`.",
        ),
    ] = None,
    timing: Timing = True,
    no_report: Annotated[bool, option("--no-report", "Do not write report.html, the page of `report`.")] = False,
    settings: Set = None,
) -> None:
    """The main job: solids, contact, check and pictures in a folder."""
    tolerance = tolerance_in_mm(tol)
    torques = None if torque is None else torques_in_nm(torque)
    folder = Path("out") / stem(design_file) if output is None else output
    refuse_folder(folder)
    design = load_design(design_file, settings, lambda gears: gears.run(folder, tolerance, torque=torques))
    source = None if no_report else design_text(design_file, settings)
    begin_drawing()
    with output_folder(folder), working("starting") as progress:
        gears, page = gm.build(design), not no_report
        report = gears.run(
            folder, tolerance, progress=progress, timing=timing, page=page, source=source, torque=torques
        )
    show(report.listings)
    warn(report.warnings, report.complaints, [report.skipped] if report.skipped else [])
    if report.stuck or report.complaints:
        raise typer.Exit(NoSolutionError.exit_status)
