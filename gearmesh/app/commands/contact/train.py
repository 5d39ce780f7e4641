"""The command `train`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearmesh.app.options import Csv, Json, Set, Tolerance, option, present, refuse_one_stream
from gearmesh.app.terminal import refuse_unwritable, show, tolerance_in_mm, warn, working, write_text
from gearmesh.errors import ArgumentError


def train(
    train_file: Annotated[
        Path,
        typer.Argument(
            metavar="TRAIN",
            help="File of a train, TOML or JSON; - is standard input.",
            show_default=False,
            callback=present,
        ),
    ],
    output: Annotated[
        Path | None,
        option("-o --output FILE", "All gears in mesh, gears on a joined shaft as one body; the suffix is the format."),
    ] = None,
    json_file: Json = None,
    csv_file: Csv = None,
    turns: Annotated[
        float | None,
        option(
            "--turns N", "Turns of the input for --csv and the transmission error. [default: one turn of the output]"
        ),
    ] = None,
    phi: Annotated[float | None, option("--phi DEG", "Rotation of the input shaft for --output. [default: 0]")] = None,
    tol: Tolerance = None,
    settings: Set = None,
) -> None:
    """Trains of several stages: ratio, speeds, hunting, phases, transmission error of the output, and all gears in mesh.

    --json has all figures, --csv the transmission error at every position.
    """
    import gearmesh as gm
    from gearmesh import io
    from gearmesh.formats import refuse_suffix

    refuse_one_stream(json_file, csv_file)
    if output is None:
        for name, value in (("phi", phi), ("tol", tol)):
            if value is not None:
                raise ArgumentError(name, value, must_be="left out without --output")
    else:
        refuse_suffix(output, *io.formats(several=True))
    for file in (output, json_file, csv_file):
        refuse_unwritable(file)
    tolerance = tolerance_in_mm(tol)
    with working("stages"):
        answer = gm.load_train(train_file, settings or [])
        listings = answer.listings
    with working("transmission error"):
        error = answer.transmission_error(turns)
    if output is not None:
        with working("solids"):
            made = answer.solids(tolerance, file=output, phi=phi or 0.0)
            made.save(output)
        listings = [*listings, *error.listings, *made.listings]
        complaints = made.complaints
    else:
        listings, complaints = [*listings, *error.listings], []
    write_text(json_file, error.json)
    write_text(csv_file, error.csv)
    if "-" not in (json_file, csv_file):
        show(listings)
    warn(answer.warnings, complaints)
