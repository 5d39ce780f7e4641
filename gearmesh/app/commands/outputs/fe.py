"""The command `fe`: finite-element models of teeth in mesh, written and solved."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import gearmesh as gm
from gearmesh.app.options import (
    DesignFile,
    Json,
    Pair,
    Positions,
    Set,
    Timing,
    chosen_pair,
    load_gears,
    option,
    positions_in_degrees,
    sector_option,
)
from gearmesh.app.terminal import (
    output_folder,
    refuse_folder,
    refuse_unwritable,
    show,
    warn,
    working,
    write_text,
)
from gearmesh.errors import ArgumentError, OutputError
from gearmesh.formats import JSON_SUFFIX, PNG_SUFFIX, VTU_SUFFIX, refuse_suffix
from gearmesh.numerals import parse_whole_number
from gearmesh.progress import Progress, part

if TYPE_CHECKING:
    from gearmesh.answers.bodies.finite_element_model import UnloadedFiniteElements
    from gearmesh.answers.bodies.finite_elements import FiniteElementDecks, FiniteElements, FiniteElementSolution


class FiniteElementProgram(StrEnum):
    """Program for which a file is written: the suffix tells it for all but the first two."""

    calculix = "calculix"
    abaqus = "abaqus"
    ansys = "ansys"
    aster = "aster"
    lsdyna = "lsdyna"
    nastran = "nastran"


#: suffixes of the files that hold a solution
SOLUTION_SUFFIXES = (VTU_SUFFIX, JSON_SUFFIX)

#: value of --member for both members
BOTH_MEMBERS = "both"


def fe(
    design_file: DesignFile,
    output: Annotated[
        Path | None,
        option(
            "-o --output FILE|DIR",
            "Model to write: .inp, .bdf, .cdb, .k, .med; mesh alone: .msh, .vtu; with --solve results: .vtu, or a "
            "folder; for several positions a folder of decks.",
        ),
    ] = None,
    teeth: Annotated[str | None, option("--teeth K|all", "Teeth of each member: an odd number, or all.")] = None,
    sector: Annotated[
        int | None,
        sector_option(
            "K pitches of one member with cyclic symmetry; K divides its number of teeth. Loads act on every sector."
        ),
    ] = None,
    phi1: Positions = None,
    torque: Annotated[float | None, option("--torque NM", "Torque on the pinion.")] = None,
    rotation: Annotated[
        float | None,
        option("--rotation DEG", "Rotate the pinion by this angle, instead of a torque."),
    ] = None,
    friction: Annotated[float | None, option("--friction MU", "Coefficient of friction on the flanks.")] = None,
    program: Annotated[
        FiniteElementProgram | None,
        option(
            "--for", "Program of an .inp model; every other suffix belongs to one program.", show_default="calculix"
        ),
    ] = None,
    member: Annotated[str, option("--member pinion|gear|both", "One member, or both in mesh.")] = BOTH_MEMBERS,
    pair: Pair = None,
    solve: Annotated[bool, option("--solve", "Run CalculiX and read back stress and pressure.")] = False,
    json_file: Json = None,
    frequencies: Annotated[
        int | None,
        option("--frequencies N", "Lowest natural frequencies of one member, by CalculiX."),
    ] = None,
    keep: Annotated[Path | None, option("--keep DIR", "With --solve: keep deck, .frd and .dat in a folder.")] = None,
    picture: Annotated[
        Path | None, option("--picture FILE.png", "With --solve: pressure and stress in colours.")
    ] = None,
    timing: Timing = True,
    settings: Set = None,
) -> None:
    """Finite-element model of the teeth in mesh, ready to run. The table [fe] sets the numbers of teeth and elements."""
    positions = positions_in_degrees(phi1) or [0.0]
    _refuse_fe_options(output, picture, keep, solve, frequencies)
    folder = output is not None and not output.suffix and (solve or len(positions) > 1)
    if len(positions) > 1:
        _refuse_for_several(str(phi1), output, solve, program)
    elif output is not None and output.suffix.lower() != JSON_SUFFIX and not folder:
        from gearmesh.fe.decks import format_of

        chosen_format = format_of(output, None if program is None else program.value)
        if sector is not None and not chosen_format.sectors:
            raise ArgumentError("sector", sector, must_be=f"left out for {output.suffix} files")
    if sector is not None:
        _refuse_for_sector(sector, teeth, len(positions), frequencies)
    for file in (None if folder else output, json_file, picture):
        refuse_unwritable(file)
    for each in (output if folder else None, keep):
        refuse_folder(each)

    def model_of(gears: gm.Gears) -> FiniteElements | UnloadedFiniteElements:
        mesh, members = modelled_members(gears)
        return gears.finite_elements(
            positions[0], members=members, rotation=rotation, friction=friction or 0.0, pair=mesh, sector=sector
        )

    def modelled_members(gears: gm.Gears) -> tuple[str | int, tuple[str, ...] | None]:
        """Return the pair and the modelled members."""
        if not gears.names.pairs:
            _refuse_unpaired(gears, phi1=phi1, rotation=rotation, friction=friction, pair=pair, solve=solve or None)
        mesh = chosen_pair(gears, pair) if gears.names.pairs else 0
        names = gears.names.pairs[gears.names.pair_number(mesh)] if gears.names.pairs else gears.names.members
        if frequencies is not None and gears.names.pairs and member == BOTH_MEMBERS:
            raise ArgumentError("frequencies", frequencies, must_be="left out for members in mesh; choose one member")
        return mesh, _members(gears, names, member, friction)

    overrides = [*(settings or []), *_fe_overrides(teeth, torque)]
    if solve or frequencies is not None:
        _require_programs(picture)
    gears = load_gears(design_file, overrides, model_of)
    mesh, members = modelled_members(gears)
    answer: FiniteElements | UnloadedFiniteElements | FiniteElementSolution | FiniteElementDecks
    with working("finite-element model") as progress:
        chosen = None if program is None else program.value
        if len(positions) > 1 and output is not None:
            answer = gears.finite_element_decks(
                output,
                positions,
                members=members,
                rotation=rotation,
                friction=friction or 0.0,
                pair=mesh,
                program=chosen,
                progress=progress,
            )
            warnings = answer.warnings
        else:
            with part(0.0, 0.0 if solve else 0.8):
                model = model_of(gears)
            if output is not None and not (solve and output.suffix.lower() in ("", *SOLUTION_SUFFIXES)):
                model.save(output, program=chosen)
            warnings = model.warnings
            if solve:
                answer = _solve(gears, model, output, keep, picture, progress)
                warnings = answer.warnings
            else:
                answer = model if frequencies is None else model.with_frequencies(frequencies, progress, keep=keep)
    write_text(json_file, lambda: answer.json(timing=timing))
    if json_file != "-":
        show(answer.listings)
    warn(warnings)


def _refuse_unpaired(gears: gm.Gears, **options: object) -> None:
    """Refuse given options that need a mating gear."""
    for name, value in options.items():
        if value is not None:
            raise gears.names.needs_pair(name, value)


def _members(gears: gm.Gears, names: tuple[str, ...], member: str, friction: float | None) -> tuple[str, ...] | None:
    """Return the names of the modelled members of the chosen pair, None for both members."""
    if member not in (BOTH_MEMBERS, *names):
        elsewhere = next(
            (f"{first}-{second}" for first, second in gears.names.pairs if member in (first, second)), None
        )
        remedy = "" if elsewhere is None else f"it is in --pair {elsewhere}"
        raise ArgumentError("member", member, must_be=f"one of {', '.join((*names, BOTH_MEMBERS))}", remedy=remedy)
    if friction and member != BOTH_MEMBERS:
        raise ArgumentError(
            "friction", friction, must_be=f"left out with --member {member}, which has no contact alone"
        )
    return None if member == BOTH_MEMBERS else (member,)


def _solve(
    gears: gm.Gears,
    model: FiniteElements | UnloadedFiniteElements,
    output: Path | None,
    keep: Path | None,
    picture: Path | None,
    progress: Progress,
) -> FiniteElementSolution:
    """Solve a model by CalculiX, and save results and a picture of the solution where they are wanted.

    A folder as output gets results and figures, and what `keep` would get.
    """
    folder = output if output is not None and not output.suffix else None
    solution = model.solve(progress, keep=keep or folder)
    if folder is not None:
        with output_folder(folder):
            solution.save(folder / f"result{VTU_SUFFIX}")
            solution.save(folder / f"result{JSON_SUFFIX}")
    elif output is not None and output.suffix.lower() in SOLUTION_SUFFIXES:
        solution.save(output)
    if picture is not None:
        gears.picture("stress", of=solution).save(picture)
    return solution


def _refuse_fe_options(
    output: Path | None, picture: Path | None, keep: Path | None, solve: bool, frequencies: int | None
) -> None:
    """Refuse options of `fe` that are wrong for any design."""
    if frequencies is not None:
        from gearmesh.answers.bodies.finite_element_model import refuse_mode_count

        refuse_mode_count(frequencies)
        if solve:
            raise ArgumentError("frequencies", frequencies, must_be="left out with --solve")
    elif output is None and not solve:
        raise ArgumentError("output", reason="missing; name a file to write, or give --solve")
    if picture is not None and not solve:
        raise ArgumentError("picture", picture, must_be="left out without --solve")
    if keep is not None and not solve and frequencies is None:
        raise ArgumentError("keep", keep, must_be="left out without --solve")
    if picture is not None:
        refuse_suffix(picture, PNG_SUFFIX)


def _require_programs(picture: Path | None) -> None:
    """Raise OutputError without CalculiX, or without OpenGL for a picture."""
    from gearmesh.fe.ccx import program

    program()
    if picture is not None:
        from gearmesh.view.opengl import missing_opengl_message

        if missing := missing_opengl_message():
            raise OutputError(reason=missing)


def _refuse_for_several(phi1: str, output: Path | None, solve: bool, program: FiniteElementProgram | None) -> None:
    """Refuse options that exclude several positions."""
    if solve:
        raise ArgumentError("phi1", phi1, must_be="one position with --solve; run.sh in the folder -o solves several")
    if program not in (None, FiniteElementProgram.calculix, FiniteElementProgram.abaqus):
        raise ArgumentError("program", program.value, must_be="calculix or abaqus for several positions")
    if output is not None and (output.suffix or output.is_file()):
        raise ArgumentError("output", output, must_be="a folder for several positions, a name without suffix")


def _refuse_for_sector(sector: int, teeth: str | None, positions: int, frequencies: int | None) -> None:
    """Refuse options that exclude a sector."""
    if frequencies is not None:
        raise ArgumentError("frequencies", frequencies, must_be="left out for a sector")
    if teeth is not None:
        raise ArgumentError("teeth", teeth, must_be="left out with --sector")
    if positions > 1:
        raise ArgumentError("sector", sector, must_be="left out for several positions")


def _fe_overrides(teeth: str | None, torque: float | None) -> list[str]:
    """Return options of `fe` as overridden keys of the design, which checks them."""
    count = 0 if teeth in (None, "all") else parse_whole_number(str(teeth)) or 0
    if teeth not in (None, "all") and (count < 0 or count % 2 == 0):
        raise ArgumentError("teeth", teeth, must_be="an odd number, or all")
    overrides = [] if teeth is None else [f"fe.teeth={count}"]
    return overrides if torque is None else [*overrides, f"fe.torque={torque!r}"]
