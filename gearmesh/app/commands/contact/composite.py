"""The command `composite`: single-flank and double-flank composite test."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from gearmesh.app.options import Csv, DesignFile, Json, Pair, Set, chosen_pair, load_gears, option, refuse_one_stream
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.formats import DIAGRAM_SUFFIXES, refuse_suffix


def composite(
    design_file: DesignFile,
    json_file: Json = None,
    csv_file: Csv = None,
    output: Annotated[Path | None, option("-o --output FILE", "Draw the charts: .png, .svg or .pdf.")] = None,
    pair: Pair = None,
    settings: Set = None,
) -> None:
    """Composite tests of gears with measured pitch deviations or eccentric members, until the same teeth meet again.

    Single flank: transmission error, F_i' and f_i'. Double flank, on parallel axes: centre distance without backlash, F_i'', f_i''.
    """
    refuse_one_stream(json_file, csv_file)
    if output is not None:
        refuse_suffix(output, *DIAGRAM_SUFFIXES)
    for file in (output, json_file, csv_file):
        refuse_unwritable(file)
    gears = load_gears(design_file, settings, lambda gears: gears.composite(pair=chosen_pair(gears, pair)))
    mesh = chosen_pair(gears, pair)
    with working("composite test"):
        answer = gears.composite(pair=mesh)
        if output is not None:
            gears.composite_chart(answer).save(output)
    write_text(json_file, answer.json)
    write_text(csv_file, answer.csv)
    if "-" not in (json_file, csv_file):
        show(answer.listings)
    warn(answer.warnings)
