"""The command `run`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gearmesh as gm
from gearmesh.app.options import DesignFile, Set, Timing, Tolerance, load_design
from gearmesh.app.terminal import output_folder, show, tolerance_in_mm, warn, working


def run(
    design_file: DesignFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="DIR", help="Folder for the results. [default: out/DESIGN]")
    ] = None,
    tol: Tolerance = None,
    timing: Timing = True,
    settings: Set = None,
) -> None:
    """The main job: solids, contact, check and pictures in a folder."""
    design = load_design(design_file, settings)
    tolerance = tolerance_in_mm(tol)
    folder = Path("out") / design_file.stem if output is None else output
    with output_folder(folder), working("starting") as progress:
        report = gm.build(design).run(folder, tolerance, progress=progress, timing=timing)
    show(report.listings)
    warn(report.warnings, report.complaints, [report.skipped] if report.skipped else [])
