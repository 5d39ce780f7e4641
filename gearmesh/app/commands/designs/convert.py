"""The command `convert`: designs from REXS files, and REXS files of designs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearmesh.app.options import Json, Set, load_gears, option, present
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.errors import ArgumentError
from gearmesh.formats import REXS_SUFFIXES, TOML_SUFFIX, refuse_suffix

#: value of --stage for the train of all stages
ALL_STAGES = "all"


def convert(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="IN",
            help="REXS file (.rexs, .rexsj, .rexsz), or a design file.",
            show_default=False,
            callback=present,
        ),
    ],
    output: Annotated[Path, option("-o --output OUT", "Design file (.toml) of a REXS file, or REXS file of a design.")],
    stage: Annotated[
        str | None,
        option("--stage ID|all", "Stage to read from a REXS file with several; all: the train of all stages."),
    ] = None,
    torque: Annotated[
        float | None,
        option(
            "--torque NM",
            "For a design: also write loaded contact under this torque on the pinion, as results of a load case.",
        ),
    ] = None,
    json_file: Json = None,
    changes: Set = None,
) -> None:
    """Read a stage of a REXS file as a design, or write a design as a REXS file (versions 1.0 to 1.7 are read, 1.7 is written).

    Contents of the file that a design cannot hold are listed. They are not lost: a design that was read from a file is written
    together with them.
    """
    import gearmesh
    from gearmesh.exchange.rexs_file import is_rexs

    for file in (output, json_file):
        refuse_unwritable(file)
    if is_rexs(source):
        refuse_suffix(output, TOML_SUFFIX)
        if torque is not None:
            raise ArgumentError("torque", torque, reason="is for designs; the torques of a REXS file are read from it")
        if changes:
            raise ArgumentError(
                "overrides", entry=changes[0], reason="is for designs; change the design that is written"
            )
        if stage == ALL_STAGES:
            _write_train(source, output, json_file)
            return
        with working("reading"):
            reading = gearmesh.load_rexs(source, stage)
        reading.save(output)
        write_text(json_file, reading.json)
        if json_file != "-":
            show(reading.listings)
        warn(reading.warnings)
        return
    refuse_suffix(output, *REXS_SUFFIXES)
    if stage is not None:
        raise ArgumentError("stage", stage, reason="is for REXS files; a design is of one stage")
    gears = load_gears(source, changes, lambda gears: gears.rexs(output.parent, torque=torque))
    with working("conversion", at_once=True):
        model = gears.rexs(output.parent, torque=torque)
    model.save(output)
    write_text(json_file, model.json)
    if json_file != "-":
        show(model.listings)
    warn(gears.warnings, model.warnings)


def _write_train(source: Path, output: Path, json_file: str | None) -> None:
    """Write the train of all stages of a REXS file, and print its figures."""
    import gearmesh
    from gearmesh.design.files import with_version
    from gearmesh.io.atomic import whole_text
    from gearmesh.trains.rexs import train_tables

    with working("reading"):
        tables, notes = train_tables(source)
        train = gearmesh.load_train(tables)
        listings = train.listings
    whole_text(output, with_version(tables))
    write_text(json_file, train.json)
    if json_file != "-":
        show(listings)
    warn(notes, train.warnings)
