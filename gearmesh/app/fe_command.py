"""The command `fe`: finite-element models of teeth in mesh, written and solved."""

from __future__ import annotations

import math
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gearmesh.app.options import DesignFile, Json, MemberName, Set, load_design
from gearmesh.app.terminal import refuse_suffix, refuse_unwritable, warn, working, write_text
from gearmesh.errors import DesignError


class FiniteElementProgram(StrEnum):
    """A program that an .inp is written for."""

    calculix = "calculix"
    abaqus = "abaqus"


#: deg; a linear solution means nothing beyond
_LARGEST_ROTATION = 1.0


def fe(
    design_file: DesignFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="FILE", help="Model to write: .inp, .msh or .vtu.")
    ] = None,
    teeth: Annotated[
        str | None,
        typer.Option("--teeth", metavar="K|all", help="Teeth of each member, an odd number, or all of them."),
    ] = None,
    phi1: Annotated[float, typer.Option("--phi1", metavar="DEG", help="Position of the pinion.")] = 0.0,
    torque: Annotated[float | None, typer.Option("--torque", metavar="NM", help="Torque on the pinion.")] = None,
    rotation: Annotated[
        float | None, typer.Option("--rotation", metavar="DEG", help="Turn the pinion by this instead of a torque.")
    ] = None,
    program: Annotated[
        FiniteElementProgram | None, typer.Option("--for", help="Whose .inp.", show_default="calculix")
    ] = None,
    member: Annotated[MemberName, typer.Option("--member", help="One member, or both in mesh.")] = MemberName.both,
    solve: Annotated[bool, typer.Option("--solve", help="Run CalculiX and read back stress and pressure.")] = False,
    json_file: Json = None,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="FILE.png", help="With --solve: pressure and stress in colours.")
    ] = None,
    settings: Set = None,
) -> None:
    """Finite-element model of the teeth in mesh, ready to run; how many teeth and elements the table [fe] says."""
    _refuse_fe_options(phi1, rotation, output, picture, solve)
    design = load_design(design_file, [*(settings or []), *_fe_overrides(teeth, torque)])
    for file in (output, json_file, picture):
        refuse_unwritable(file)
    from gearmesh.app import fe_job, report
    from gearmesh.fe.decks import write_model

    if solve:
        from gearmesh.fe.ccx import program as ccx

        ccx()
    members = fe_job.MEMBERS if member is MemberName.both else (member.value,)
    angle = None if rotation is None else math.radians(rotation)
    with working("finite-element model") as progress:
        problem = fe_job.fe_model(design, math.radians(phi1), members, angle)
        if output is not None:
            write_model(problem.model, output, None if program is None else program.value)
        solved = fe_job.solve(problem, progress) if solve else None
        if picture is not None and solved is not None:
            fe_job.picture(problem, solved, picture)
    found = None if solved is None else solved.figures
    write_text(json_file, lambda: report.json_text(report.fe_document(design, problem.figures, found)))
    if json_file != "-":
        report.show(report.fe_listings(problem.figures, found), sys.stdout)
    warn(problem.warnings)


def _refuse_fe_options(
    phi1: float, rotation: float | None, output: Path | None, picture: Path | None, solve: bool
) -> None:
    """What of `fe`'s options can be refused before the design is read."""
    if output is None and not solve:
        raise DesignError("--output: missing; name a file to write, or ask for --solve")
    if picture is not None and not solve:
        raise DesignError(f"--picture = {picture}: must be left out without --solve")
    if picture is not None:
        refuse_suffix(picture, ".png")
    if not math.isfinite(phi1):
        raise DesignError(f"--phi1 = {phi1}: must be a finite number of degrees")
    if rotation is not None and not 0.0 < rotation <= _LARGEST_ROTATION:
        raise DesignError(f"--rotation = {rotation:g}: must be above 0 and up to {_LARGEST_ROTATION:g} deg")


def _fe_overrides(teeth: str | None, torque: float | None) -> list[str]:
    """Options of `fe` as keys of the design, which checks them."""
    if teeth is not None and teeth != "all" and not (teeth.isdecimal() and int(teeth) % 2 == 1):
        raise DesignError(f"--teeth = {teeth}: must be an odd number, or all")
    overrides = [] if teeth is None else [f"fe.teeth={0 if teeth == 'all' else int(teeth)}"]
    return overrides if torque is None else [*overrides, f"fe.torque={torque!r}"]
