"""The command `train`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearmesh.app.options import Csv, Json, Set, Tolerance, option, present, refuse_one_stream
from gearmesh.app.terminal import refuse_unwritable, show, tolerance_in_mm, warn, working, write_text
from gearmesh.errors import ArgumentError
from gearmesh.formats import DIAGRAM_SUFFIXES, HTML_SUFFIX, PNG_SUFFIX, STEP_SUFFIXES, refuse_suffix


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
        option(
            "-o --output FILE",
            "All gears in mesh, gears on a joined shaft as one body; the suffix is the format: meshes, .step, .png for a "
            "picture, .html for the report page.",
        ),
    ] = None,
    chart: Annotated[Path | None, option("--chart FILE", "Draw the transmission error: .png, .svg or .pdf.")] = None,
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

    refuse_one_stream(json_file, csv_file)
    suffix = _refuse_output(output, phi, tol)
    if chart is not None:
        refuse_suffix(chart, *DIAGRAM_SUFFIXES)
    for file in (output, chart, json_file, csv_file):
        refuse_unwritable(file)
    tolerance = tolerance_in_mm(tol)
    with working("stages"):
        answer = gm.load_train(train_file, settings or [])
        listings = answer.listings
    with working("transmission error"):
        error = answer.transmission_error(turns)
        listings += error.listings
        if chart is not None:
            answer.chart(error).save(chart)
    warnings, complaints = [*answer.warnings], list[str]()
    if output is not None:
        with working("page" if suffix == HTML_SUFFIX else "picture" if suffix == PNG_SUFFIX else "solids"):
            if suffix == HTML_SUFFIX:
                page = answer.page(turns)
                page.save(output)
                warnings += page.warnings
            elif suffix == PNG_SUFFIX:
                answer.picture(phi or 0.0).save(output)
            else:
                in_step = suffix in STEP_SUFFIXES
                made = (
                    answer.cad(tolerance, phi=phi or 0.0)
                    if in_step
                    else answer.solids(tolerance, file=output, phi=phi or 0.0)
                )
                made.save(output)
                listings, complaints = [*listings, *made.listings], made.complaints
    write_text(json_file, error.json)
    write_text(csv_file, error.csv)
    if "-" not in (json_file, csv_file):
        show(listings)
    warn(warnings, complaints)


def _refuse_output(output: Path | None, phi: float | None, tol: str | None) -> str:
    """Return the suffix of the output, "" without one. Raises ArgumentError or OutputError for options that it has not."""
    from gearmesh import io

    if output is not None:
        refuse_suffix(output, *io.formats(several=True), *STEP_SUFFIXES, PNG_SUFFIX, HTML_SUFFIX)
    suffix = "" if output is None else output.suffix.lower()
    if suffix in STEP_SUFFIXES:
        from gearmesh.cad.step import require_occ

        require_occ()
    for name, value, without in (("phi", phi, ("", HTML_SUFFIX)), ("tol", tol, ("", HTML_SUFFIX, PNG_SUFFIX))):
        if value is not None and suffix in without:
            where = f"for {suffix}" if suffix else "without --output"
            raise ArgumentError(name, value, must_be=f"left out {where}")
    return suffix
