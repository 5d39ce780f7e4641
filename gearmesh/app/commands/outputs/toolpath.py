"""The command `toolpath`: passes of a ball-end cutter through the spaces between teeth."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import DesignFile, Json, Member, Set, load_alone, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.formats import PNG_SUFFIX, TOOL_PATH_SUFFIXES, refuse_suffix
from gearmesh.numerals import parse_whole_number

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.bodies.toolpath import ToolPathAnswer


def toolpath(
    design_file: DesignFile,
    member: Member,
    tool: Annotated[
        str,
        option(
            "--tool ball:D[,L[,H]]",
            "Ball-end cutter: diameter of ball and shank, length of the shank beyond the ball's centre, and diameter of the "
            "holder that follows, as ball:3mm,40mm,20mm; bare = mm. [default: length 5 D, no holder]",
        ),
    ],
    scallop: Annotated[
        str,
        option(
            "--scallop LEN", "Largest height left over the exact surfaces, chords included: 10um, 0.01mm; bare = mm."
        ),
    ],
    output: Annotated[
        Path | None,
        option(
            "-o --output FILE.(cls|csv|vtp|png)",
            "APT cutter location file, table, lines for VTK, or a picture of the passes.",
        ),
    ] = None,
    stock: Annotated[str, option("--stock LEN", "Stock left over the exact surfaces, along the normals.")] = "0",
    tol: Annotated[
        str | None,
        option("--tol LEN", "Part of the scallop that chords between points may take. [default: a tenth]"),
    ] = None,
    flank: Annotated[str, option("--flank right|left|both", "Flanks that are finished.")] = "both",
    surfaces: Annotated[str, option("--surfaces all|flanks", "Flanks with fillets and root, or flanks alone.")] = "all",
    spaces: Annotated[
        str, option("--spaces all|K", "All spaces, or the space before tooth K; tooth 0 is on the x axis.")
    ] = "0",
    order: Annotated[str, option("--order zigzag|one-way", "Feed order.")] = "zigzag",
    lead: Annotated[
        float | None, option("--lead DEG", "Angle of the tool axis towards the heel. [default: chosen]")
    ] = None,
    tilt: Annotated[
        float | None,
        option(
            "--tilt DEG",
            "Angle of the tool axis from the middle of the space, away from the flank that is cut. [default: chosen]",
        ),
    ] = None,
    feed: Annotated[float, option("--feed MMPM", "Feed in mm/min, for .cls.")] = 500.0,
    json_file: Json = None,
    settings: Set = None,
) -> None:
    """Finishing passes of a ball-end cutter on a five-axis machine, with step-over by the scallop and tool axes clear of all
    teeth. The remaining height is measured on the exact surfaces."""
    if output is not None:
        refuse_suffix(output, *TOOL_PATH_SUFFIXES, PNG_SUFFIX)
    for file in (output, json_file):
        refuse_unwritable(file)

    def ask(gears: Gears) -> ToolPathAnswer:
        return gears.toolpath(
            member,
            tool,
            scallop,
            stock=stock,
            tolerance=tol,
            flank=flank,
            surfaces=surfaces,
            spaces=spaces if (count := parse_whole_number(spaces)) is None else count,
            order=order,
            lead=lead,
            tilt=tilt,
            feed=feed,
        )

    gears = load_alone(design_file, settings, ask, member)
    with working("tool path"):
        path = ask(gears)
        if output is not None and output.suffix.lower() == PNG_SUFFIX:
            gears.picture("toolpath", of=path).save(output)
        elif output is not None:
            path.save(output)
    write_text(json_file, path.json)
    if json_file != "-":
        show(path.listings)
    warn(gears.warnings)
