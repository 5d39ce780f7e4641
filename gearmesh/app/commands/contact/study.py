"""The command `study`."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
    is_train,
    load_gears,
    option,
    tls_files,
    tolerances,
    torques_in_nm,
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
from gearmesh.errors import ArgumentError
from gearmesh.progress import Progress

#: figures of rows by default
DEFAULT_RECORD = "path,cycle"

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.study.largest_errors import LargestErrors
    from gearmesh.study.study import Study


def study(
    design_file: DesignFile,
    vary: Annotated[
        list[str] | None,
        option(
            "--vary KEY=LOW:HIGH:N|A,B,C",
            "Vary a key of the design, as assembly.dV=-0.1:0.1:5; several make a grid. With --sample KEY=LOW:HIGH.",
        ),
    ] = None,
    sample: Annotated[int | None, option("--sample N", "Draw N rows instead of a grid.")] = None,
    tolerance: Annotated[
        list[str] | None,
        option(
            "--tolerance FILE.toml|KEY=SPREAD|class:N",
            "Distributions of keys: normal:MEAN:SIGMA, uniform:LOW:HIGH, triangular:LOW:MODE:HIGH, "
            "truncated:MEAN:SIGMA:LOW:HIGH; a file of them; flanks of cylindrical gears in a class of ISO 1328-1.",
        ),
    ] = None,
    method: Annotated[
        str,
        option(
            "--method lhs|sobol|random|saltelli", "Sampling method; saltelli: N (keys + 2) rows, for Sobol indices."
        ),
    ] = "lhs",
    seed: Annotated[int, option("--seed S", "Seed of the samples.")] = 0,
    record: Annotated[
        str,
        option(
            "--record FIGURES",
            "path (ms per row), cycle (0.1 s), fit (backlash, clearance: 0.1 s more), load (2 s per torque; "
            "needs --torque), turns (whole turns: 1 s), all (all but turns), or names of figures; separated by commas.",
        ),
    ] = DEFAULT_RECORD,
    torque: Annotated[
        str | None,
        option(
            "--torque NM[,NM]", "Torques on the pinion, for --record load: each has its own figures, counted from 1."
        ),
    ] = None,
    level: LoadLevel = "full",
    limit: Annotated[
        list[str] | None, option("--limit FIGURE>X|FIGURE<X", "Criterion of a good row, for the yield. Repeatable.")
    ] = None,
    find_limits: Annotated[
        list[str] | None,
        option(
            "--find-limits KEY[=REACH]",
            "Instead of rows: find the largest values of a key with which every --limit holds. "
            "[default limit: contact_ratio>1]",
        ),
    ] = None,
    output: Annotated[
        Path | None, option("-o --output DIR", "Folder of results; finished rows are kept and not computed again.")
    ] = None,
    workers: Workers = None,
    scheduler: SchedulerAddress = None,
    tls_ca_file: TlsCaFile = None,
    tls_client_cert: TlsClientCert = None,
    tls_client_key: TlsClientKey = None,
    parquet: Annotated[
        bool | None, option("--parquet/--no-parquet", "Write Parquet. [default: where pyarrow is installed]")
    ] = None,
    pictures: Annotated[bool, option("--pictures/--no-pictures", "Draw the figures.")] = True,
    json_file: Json = None,
    pair: Pair = None,
    settings: Set = None,
) -> None:
    """Many assemblies or designs: grids, samples of tolerances, largest permissible errors.

    Writes study.csv (.parquet), study.json and figures into DIR. If interrupted, the same command continues. For a train, keys are
    such as stages.first.assembly.dx, and figures are on the transmission error of its output.
    """
    refuse_unwritable(json_file)
    rows = {"vary": vary, "tolerance": tolerance, "sample": sample}
    tls = {"tls_ca_file": tls_ca_file, "tls_client_cert": tls_client_cert, "tls_client_key": tls_client_key}
    of_train = is_train(design_file)
    torques = None if torque is None else torques_in_nm(torque)
    if of_train:
        of_one_set = {"torque": torque, "find_limits": find_limits, "pair": pair, "scheduler": scheduler, **tls}
        of_one_set["level"] = None if level == "full" else level
        _refuse_given(of_one_set, "is for studies of one gear set, not of a train")
    elif find_limits:
        _refuse_beside_limits(output, {**rows, "workers": workers, "scheduler": scheduler, **tls})
        _find_limits(design_file, settings, find_limits, limit, torques, level, pair, json_file)
        return
    files = tls_files(tls_ca_file, tls_client_cert, tls_client_key)
    if parquet:
        from gearmesh.study.table import require_pyarrow

        require_pyarrow()
    writes_parquet = _has_pyarrow() if parquet is None else parquet

    def plan() -> dict[str, Any]:
        """Return the arguments of studies that gear sets and trains share."""
        return {
            **rows,
            "vary": unique_keys("--vary", vary),
            "tolerance": tolerances("--tolerance", tolerance),
            "method": method,
            "seed": seed,
            "limits": limit or (),
            "folder": output,
            "workers": workers,
        }

    if of_train:
        refuse_folder(output)
        with working("stages"):
            train = gm.load_train(design_file, settings or [])
        with working("study") as progress:
            recorded = "all" if record == DEFAULT_RECORD else record
            answer = train.study(**plan(), record=recorded, progress=at_times(progress))
            _save_rows(answer, output, writes_parquet)
        _show(answer, json_file)
        return

    def ask(gears: Gears, progress: Progress | None = None) -> Study:
        return gears.study(
            **plan(),
            record=record,
            torque=torques,
            level=level,
            scheduler=scheduler,
            tls=files,
            pair=chosen_pair(gears, pair),
            progress=progress,
        )

    refuse_folder(output)
    gears = load_gears(design_file, settings, ask)
    with working("study") as progress:
        answer = ask(gears, at_times(progress))
        if output is not None:
            progress(1.0, "study: files and figures")
            _save_rows(answer, output, writes_parquet)
            if pictures:
                with output_folder(output):
                    gears.save_pictures(answer, output)
    _show(answer, json_file)


def _refuse_given(options: Mapping[str, object], reason: str) -> None:
    """Raise ArgumentError for the first of some options that is given."""
    for name, value in options.items():
        if value is not None:
            raise ArgumentError(name, reason=reason, allowed="left out")


def _refuse_beside_limits(output: Path | None, rows: Mapping[str, object]) -> None:
    """Raise ArgumentError for options of rows, which a search for limits has none of."""
    if output is not None:
        why = "--find-limits writes no folder: its table is printed, and --json FILE writes it"
        raise ArgumentError("-o", output, reason=why)
    for name, value in rows.items():
        if value is not None:
            why = f"searches from the design itself and has no rows: it cannot be given together with --{name.replace('_', '-')}"
            raise ArgumentError("find_limits", reason=why)


def _find_limits(
    design_file: Path,
    settings: list[str] | None,
    keys: list[str],
    limits: list[str] | None,
    torques: list[float] | None,
    level: str,
    pair: str | None,
    json_file: str | None,
) -> None:
    """Find the largest values of keys with which every limit holds, and show them."""
    reaches = dict(text.partition("=")[::2] for text in keys)
    wanted = {key: reach or "1" for key, reach in reaches.items()}

    def find(gears: Gears, progress: Progress | None = None) -> LargestErrors:
        criteria, mesh = limits or ["contact_ratio>1"], chosen_pair(gears, pair)
        return gears.largest_errors(wanted, criteria, torque=torques, level=level, pair=mesh, progress=progress)

    gears = load_gears(design_file, settings, find)
    with working("limits") as progress:
        largest = find(gears, progress)
    write_text(json_file, largest.json)
    if json_file != "-":
        show(largest.listings)


def _save_rows(answer: Study, folder: Path | None, parquet: bool) -> None:
    """Write rows and summary of a study to files of a folder, if there is one."""
    if folder is None:
        return
    with output_folder(folder):
        answer.save(folder / "study.csv")
        answer.save(folder / "study.json")
        if parquet:
            answer.save(folder / "study.parquet")


def _show(answer: Study, json_file: str | None) -> None:
    """Print the tables of a study, and warn of its faults."""
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
    warn(answer.complaints)
    count = answer.columns["status"].count("ok")
    if count < len(answer.plan):
        warn([f"{len(answer.plan) - count} of {len(answer.plan)} rows have no figures: see the column reason"])


def _has_pyarrow() -> bool:
    from importlib.util import find_spec

    return find_spec("pyarrow") is not None
