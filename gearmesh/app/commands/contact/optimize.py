"""The command `optimize`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import gearmesh as gm
from gearmesh.app.options import (
    DesignFile,
    Json,
    LoadLevel,
    Pair,
    SchedulerAddress,
    Set,
    TlsCaFile,
    TlsClientCert,
    TlsClientKey,
    Workers,
    chosen_pair,
    design_text,
    load_gears,
    option,
    tls_files,
    tolerances,
    unique_keys,
)
from gearmesh.app.terminal import (
    at_times,
    output_folder,
    refuse_folder,
    refuse_unwritable,
    show,
    warn,
    working,
    write_text,
)
from gearmesh.errors import NoSolutionError
from gearmesh.progress import Progress, silent

if TYPE_CHECKING:
    from gearmesh import Gears, Optimum


#: page of the design and the best one
COMPARISON_FILE = "comparison.html"


def optimize(
    design_file: DesignFile,
    output: Annotated[
        Path, option("-o --output DIR", "Folder of results; finished designs are kept and not computed again.")
    ],
    vary: Annotated[
        list[str] | None,
        option(
            "--vary KEY=LOW:HIGH|A,B,C",
            "Vary a key of the design, as pinion.modifications.helix_crowning=0:20um; repeatable.",
        ),
    ] = None,
    minimize: Annotated[
        list[str] | None,
        option(
            "--minimize FIGURE[@NM,NM...][:mean|max]",
            "Figure that study records; torques follow @, and :mean takes their mean. Two or three make a front.",
        ),
    ] = None,
    maximize: Annotated[
        list[str] | None, option("--maximize FIGURE[@NM,NM...][:mean|min]", "The same, as large as possible.")
    ] = None,
    subject: Annotated[
        list[str] | None,
        option("--subject FIGURE[@NM,NM...]<X|>X", "Limit that the design keeps, under all torques; repeatable."),
    ] = None,
    robust: Annotated[
        list[str] | None,
        option(
            "--robust FILE.toml|KEY=SPREAD|KEY=A,B,C|class:N",
            "Errors that every design has: distributions as --tolerance of study takes them, or lists, of which all "
            "combinations count.",
        ),
    ] = None,
    robust_rows: Annotated[int, option("--robust-rows N", "Rows drawn from distributions of errors.")] = 12,
    robust_by: Annotated[
        str, option("--robust-by worst|mean+Ksigma", "Value of a figure over all errors that counts.")
    ] = "mean+3sigma",
    method: Annotated[
        str | None,
        option(
            "--method cobyqa|evolution",
            "Trust regions, or differential evolution. [default: evolution for whole numbers and lists, else cobyqa]",
        ),
    ] = None,
    budget: Annotated[
        str | None, option("--budget N|TIME", "Designs, or time of this run, as 90s, 10min, 2h. [default: 100]")
    ] = None,
    level: LoadLevel = "full",
    seed: Annotated[int, option("--seed S", "Seed of samples, errors and evolution.")] = 0,
    workers: Workers = None,
    scheduler: SchedulerAddress = None,
    tls_ca_file: TlsCaFile = None,
    tls_client_cert: TlsClientCert = None,
    tls_client_key: TlsClientKey = None,
    pictures: Annotated[bool, option("--pictures/--no-pictures", "Draw the figures.")] = True,
    report: Annotated[
        bool,
        option(
            "--report/--no-report", "Write comparison.html: the design and the best one, under load and over errors."
        ),
    ] = True,
    json_file: Json = None,
    pair: Pair = None,
    settings: Set = None,
) -> None:
    """Values of keys at which figures are best, within limits and over errors: best design, front, sensitivities.

    Writes best.toml, optimum.csv with all designs, optimum.json and pictures into DIR. If interrupted, the same command continues.
    """
    refuse_unwritable(json_file)
    tls = tls_files(tls_ca_file, tls_client_cert, tls_client_key)

    def ask(gears: Gears, source: str | None = None, progress: Progress = silent) -> Optimum:
        return gears.optimize(
            unique_keys("--vary", vary),
            minimize or (),
            maximize=maximize or (),
            subject=subject or (),
            robust=tolerances("--robust", robust),
            robust_rows=robust_rows,
            robust_by=robust_by,
            method=method,
            budget=budget,
            level=level,
            seed=seed,
            folder=output,
            workers=workers,
            scheduler=scheduler,
            tls=tls,
            pair=chosen_pair(gears, pair),
            source=source,
            progress=progress,
        )

    refuse_folder(output)
    gears = load_gears(design_file, settings, ask)
    with working("optimize") as progress:
        answer = ask(gears, design_text(design_file, settings), at_times(progress))
        progress(1.0, "optimize: files and pictures")
        with output_folder(output):
            answer.save_all(output)
            if pictures:
                gears.save_pictures(answer, output)
        if report:
            progress(1.0, "optimize: comparison")
            page = gears.compare(
                gm.build(answer.best_design), torque=answer.torque or None, errors=answer.error_box or None
            )
            page.save(output / COMPARISON_FILE)
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
    warn(answer.complaints)
    if not answer.feasible:
        raise typer.Exit(NoSolutionError.exit_status)
