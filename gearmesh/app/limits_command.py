"""The command `limits`: how deep the tools may cut and how high the tips may stand."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from gearmesh.app.options import DesignFile, Json, Set, load_design
from gearmesh.app.terminal import refuse_unwritable, warn, working, write_text
from gearmesh.errors import DesignError

#: normal modules; no tooth is wider at its tip
_WIDEST = 3.0


def limits(
    design_file: DesignFile,
    json_file: Json = None,
    land: Annotated[
        float, typer.Option("--land", metavar="MODULES", help="Narrowest top land allowed; 0 is a pointed tooth.")
    ] = 0.0,
    settings: Set = None,
) -> None:
    """Undercut and pointing: limits of tool depth, tip and tooth number."""
    if not 0.0 <= land <= _WIDEST:
        raise DesignError(f"--land = {land:g}: must be a number of modules from 0 to {_WIDEST:g}")
    design = load_design(design_file, settings)
    refuse_unwritable(json_file)
    from gearmesh.app import limits_job, report

    with working("limits"):
        result = limits_job.limits(design, land)
    write_text(json_file, lambda: report.json_text(limits_job.document(design, result)))
    if json_file != "-":
        report.show(limits_job.listings(result), sys.stdout)
    warn(result.warnings)
