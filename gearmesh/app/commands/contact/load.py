"""The command `load`: the contact of a pair under torque."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearmesh.answers.tables import Listing
from gearmesh.app.options import (
    Csv,
    DesignFile,
    Json,
    LoadLevel,
    Pair,
    Positions,
    Set,
    Speed,
    Timing,
    chosen_pair,
    load_gears,
    meshes_not_loaded,
    option,
    positions_in_degrees,
    refuse_one_stream,
    torques_in_nm,
)
from gearmesh.app.terminal import output_folder, refuse_folder, refuse_unwritable, show, warn, working, write_text
from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX, refuse_suffix


def load(
    design_file: DesignFile,
    torque: Annotated[str, option("--torque NM[,NM...]", "One torque on the pinion, or several.")],
    phi1: Positions = None,
    level: LoadLevel = "full",
    json_file: Json = None,
    csv_file: Csv = None,
    output: Annotated[
        Path | None, option("-o --output DIR", "Folder for loaded.json, loaded.csv and pictures.")
    ] = None,
    dynamics: Annotated[
        str | None,
        option(
            "--dynamics FILE",
            "Write static transmission error and mesh stiffness over torque and rotation for rotor dynamics, in JSON with "
            "harmonics and phases of all meshes: .json or .csv.",
        ),
    ] = None,
    tribology: Annotated[
        str | None,
        option(
            "--tribology FILE",
            "Write load, curvature, sliding and rolling along every loaded contact: .json or .csv.",
        ),
    ] = None,
    speed: Speed = None,
    friction: Annotated[
        float | None,
        option(
            "--friction MU", "Coefficient of friction: efficiency; with --speed friction power and flash temperature."
        ),
    ] = None,
    viscosity: Annotated[
        float | None,
        option("--viscosity MPAS", "Dynamic viscosity of the oil at the temperature of the teeth: film thickness."),
    ] = None,
    pressure_viscosity: Annotated[
        float | None, option("--pressure-viscosity N", "Pressure-viscosity coefficient of the oil, 1/GPa.")
    ] = None,
    roughness: Annotated[
        float | None,
        option(
            "--roughness RA", "Roughness Ra of the flanks, um: friction of ISO/TR 14179-2 and the efficiency with it."
        ),
    ] = None,
    pair: Pair = None,
    timing: Timing = True,
    settings: Set = None,
) -> None:
    """Contact under load: load of each tooth pair, transmission error, pressures, stiffness, root stress over a mesh cycle."""
    refuse_one_stream(json_file, csv_file)
    torques, positions = torques_in_nm(torque), positions_in_degrees(phi1)
    for table in (dynamics, tribology):
        if table is not None:
            refuse_suffix(Path(table), JSON_SUFFIX, CSV_SUFFIX)
    running = {
        "speed": speed,
        "friction": friction,
        "viscosity": viscosity,
        "pressure_viscosity": pressure_viscosity,
        "roughness": roughness,
    }
    for name, value in running.items():
        if tribology is None and value is not None:
            raise ArgumentError(name, value, must_be="left out without --tribology, which it is for")
    if tribology is not None:
        from gearmesh.answers.load.tribology import RunningConditions

        RunningConditions(**running)
    for file in (json_file, csv_file, dynamics, tribology):
        refuse_unwritable(file)
    refuse_folder(output)
    gears = load_gears(
        design_file,
        settings,
        lambda gears: gears.loaded_contact(torques, positions, pair=chosen_pair(gears, pair), level=level),
    )
    mesh = chosen_pair(gears, pair)
    if dynamics is not None and positions is not None:
        import numpy as np

        from gearmesh.answers.load.dynamics import whole_pitches

        whole_pitches(gears.pair(mesh), np.radians(positions))
    with working("loaded contact") as progress:
        answer = gears.loaded_contact(torques, positions, pair=mesh, progress=progress, level=level)
    write_text(json_file, lambda: answer.json(timing=timing))
    write_text(csv_file, answer.csv)
    more: list[Listing] = []
    notes: list[str] = []
    if dynamics is not None:
        with working("tables for dynamics") as progress:
            tables = gears.dynamics(
                torques, positions, pair=None if pair is None else mesh, progress=progress, loaded=answer
            )
        tables.save(dynamics, timing=timing)
        more += tables.listings
    if tribology is not None:
        with working("rows of the contacts"):
            rows = answer.tribology(**running)
        rows.save(tribology, timing=timing)
        more += rows.listings
        notes = rows.notes
    if output is not None:
        with output_folder(output):
            answer.save(output / "loaded.json", timing=timing)
            answer.save(output / "loaded.csv")
            with working("pictures"):
                gears.save_pictures(answer, output)
    if "-" not in (json_file, csv_file):
        show([*answer.listings, *more])
    warn(answer.warnings, notes, meshes_not_loaded(gears, mesh), answer.complaints)
    if answer.complaints:
        raise typer.Exit(NoSolutionError.exit_status)
