"""The command `correct`: machine settings that remove measured deviations."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import DesignFile, Json, MeasuredFile, MeasuredFlanks, Member, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.formats import CSV_SUFFIX, TOML_SUFFIX, refuse_suffix

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.inspection.correction import Correction


def correct(
    design_file: DesignFile,
    member: Member,
    measured: MeasuredFile = None,
    flank: MeasuredFlanks = "both",
    settings: Annotated[
        str | None,
        option(
            "--settings NAME,...",
            "Settings that may change, as radial,concave.tilt,helical_motion.2. [default: the usual settings]",
        ),
    ] = None,
    noise: Annotated[
        float | None,
        option(
            "--noise UM",
            "Standard deviation of a measured deviation. [default: estimated from the remaining deviations]",
        ),
    ] = None,
    residual: Annotated[Path | None, option("--residual FILE.csv", "Write the remaining deviations.")] = None,
    topography: Annotated[
        Path | None,
        option(
            "--topography FILE.csv",
            "Write the remaining deviations as amounts to remove, for dressing; two flanks: FILE_right.csv, FILE_left.csv.",
        ),
    ] = None,
    output: Annotated[Path | None, option("-o --output FILE.toml", "Write the design with the new settings.")] = None,
    json_file: Json = None,
    changes: Set = None,
) -> None:
    """Machine settings of bevel, hypoid and face gears, and corrections of ground flanks (slopes, crownings, twist), that
    remove measured deviations, and the resulting contact.

    Least squares on the exact flanks. The new settings are for the machine: the flanks of the design with these settings deviate
    with the opposite sign.
    """
    for file, suffix in ((output, TOML_SUFFIX), (residual, CSV_SUFFIX), (topography, CSV_SUFFIX)):
        if file is not None:
            refuse_suffix(file, suffix)
    for target in (output, residual, topography, json_file):
        refuse_unwritable(target)
    names = [] if settings is None else [name.strip() for name in settings.split(",")]

    def ask(gears: Gears) -> Correction:
        return gears.correct(member, measured, flank=flank, settings=names, noise=noise)

    gears = load_gears(design_file, changes, ask)
    with working("correction"):
        answer = ask(gears)
        listings = answer.listings
    for file in (output, residual):
        if file is not None:
            answer.save(file)
    if topography is not None:
        for side in answer.residual:
            own = topography.with_stem(f"{topography.stem}_{side}") if len(answer.residual) > 1 else topography
            write_text(str(own), partial(answer.topography, side))
    write_text(json_file, answer.json)
    if json_file != "-":
        show(listings)
    warn([*answer.warnings, *answer.complaints])
