"""The command `topography`: the material removed from a flank, as a file for designs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from gearmesh.app.options import DesignFile, Json, Member, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, show, tolerance_in_mm, warn, working, write_text
from gearmesh.formats import CSV_SUFFIX, refuse_suffix


def topography(
    design_file: DesignFile,
    member: Member,
    flank: Annotated[str, option("--flank right|left", "Which flank.")],
    output: Annotated[Path | None, option("-o --output FILE.csv", "Write the file that a design reads.")] = None,
    tol: Annotated[
        str | None,
        option("--tol LEN", "Largest distance between the flank and the spline through the amounts. [default: 0.01um]"),
    ] = None,
    json_file: Json = None,
    settings: Set = None,
) -> None:
    """All modifications of a flank together, as amounts over roll length and face position.

    A design can read the file instead of the modifications: modifications_right = { topography = "FILE.csv" }.
    """
    if output is not None:
        refuse_suffix(output, CSV_SUFFIX)
    for file in (output, json_file):
        refuse_unwritable(file)
    tolerance = tolerance_in_mm(tol)
    gears = load_gears(design_file, settings, lambda gears: gears.topography(member, flank, tolerance))
    with working("topography"):
        grid = gears.topography(member, flank, tolerance)
    if output is not None:
        grid.save(output)
    write_text(json_file, grid.json)
    if json_file != "-":
        show(grid.listings)
    warn(gears.warnings)
