"""The command `grid`: points and normals of the flanks of a member, for measuring machines."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from gearmesh.app.options import DesignFile, Json, Member, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.formats import DIAGRAM_SUFFIXES, POINT_SUFFIXES, refuse_suffix

if TYPE_CHECKING:
    from gearmesh import Gears, MeasuringGrids


def grid(
    design_file: DesignFile,
    member: Member,
    flank: Annotated[str, option("--flank right|left|both", "Which flanks.")] = "both",
    surface: Annotated[str, option("--surface flank|fillet|all", "Flanks, fillets under them, or both.")] = "flank",
    shape: Annotated[str, option("--grid ROWSxCOLUMNS", "Points from root to tip and from toe to heel.")] = "5x9",
    margins: Annotated[
        str, option("--margins P,F", "Shares of profile and face next to the edges that are left without points.")
    ] = "0.1,0.1",
    ball: Annotated[
        str | None, option("--ball LEN", "Diameter of the probe's ball; adds the centres of the ball.")
    ] = None,
    output: Annotated[Path | None, option("-o --output FILE", "Write a .csv or .txt file.")] = None,
    chart: Annotated[
        Path | None,
        option(
            "--chart FILE",
            "Draw theoretical profile and helix charts of a cylindrical gear, with the band of its class: .png, .svg, .pdf.",
        ),
    ] = None,
    json_file: Json = None,
    settings: Set = None,
) -> None:
    """Nominal points and unit normals of the exact flanks, for measuring machines.

    With a column deviation_um added, a design reads the file: [measured] pinion_right = "FILE.csv".
    1xN is a helix line at mid height, Nx1 a profile line at mid face.
    """
    if output is not None:
        refuse_suffix(output, *POINT_SUFFIXES)
    if chart is not None:
        refuse_suffix(chart, *DIAGRAM_SUFFIXES)
    for file in (output, chart, json_file):
        refuse_unwritable(file)

    def ask(gears: Gears) -> MeasuringGrids:
        return gears.measuring_grid(member, flank, grid=shape, margins=margins, surface=surface, ball=ball)

    gears = load_gears(design_file, settings, ask)
    with working("measuring grid"):
        points = ask(gears)
    if output is not None:
        points.save(output)
    if chart is not None:
        gears.theoretical_chart(member).save(chart)
    write_text(json_file, points.json)
    if json_file != "-":
        show(points.listings)
    warn(gears.warnings)
