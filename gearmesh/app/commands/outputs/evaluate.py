"""The command `evaluate`: deviations and tolerance classes of a measured member."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import DesignFile, Json, MeasuredFile, MeasuredFlanks, Member, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.formats import DIAGRAM_SUFFIXES, refuse_suffix
from gearmesh.progress import part

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.inspection.inspection import Inspection


def evaluate(
    design_file: DesignFile,
    member: Member,
    measured: MeasuredFile = None,
    flank: MeasuredFlanks = "both",
    pitch: Annotated[
        Path | None,
        option(
            "--pitch FILE.csv",
            "Index deviations of all teeth: columns tooth, right_um, left_um, runout_um. [default: the file of the table "
            "measured]",
        ),
    ] = None,
    output: Annotated[Path | None, option("-o --output FILE", "Draw the chart: .png, .svg or .pdf.")] = None,
    json_file: Json = None,
    settings: Set = None,
) -> None:
    """Deviations of a measured gear and its tolerance classes: ISO 1328-1 for cylindrical gears, ISO 17485 for bevel gears.

    Profile and helix slope, form and crowning; pressure and spiral angle, crownings and twist of flanks of any kind; pitch, runout.
    """
    if output is not None:
        refuse_suffix(output, *DIAGRAM_SUFFIXES)
    for file in (output, json_file):
        refuse_unwritable(file)

    def ask(gears: Gears) -> Inspection:
        return gears.evaluate(member, measured, flank=flank, pitch=pitch)

    gears = load_gears(design_file, settings, ask)
    with working("evaluation"):
        with part(0.0, 0.6):
            answer = ask(gears)
        if output is not None:
            gears.inspection_chart(answer).save(output)
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
    warn([*answer.warnings, *answer.complaints])
