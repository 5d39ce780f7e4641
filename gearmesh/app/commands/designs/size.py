"""The command `size`: pairs of cylindrical gears that have a ratio, a module and a centre distance."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gearmesh as gm
from gearmesh.app.options import Json
from gearmesh.app.terminal import refuse_suffix, refuse_unwritable, show, working, write_text
from gearmesh.design.files import with_version
from gearmesh.errors import ArgumentError, OutputError
from gearmesh.lengths import in_mm


def size(
    ratio: Annotated[float, typer.Option("--ratio", metavar="Z2/Z1", help="Gear ratio.", show_default=False)],
    center_distance: Annotated[
        str, typer.Option("--center-distance", metavar="LEN", help="Centre distance; bare = mm.", show_default=False)
    ],
    module: Annotated[
        str, typer.Option("--module", metavar="LEN", help="Normal module; bare = mm.", show_default=False)
    ],
    internal: Annotated[bool, typer.Option("--internal", help="The gear is internal.")] = False,
    helix: Annotated[str, typer.Option("--helix", metavar="DEG[:DEG]", help="Helix angle, or its range.")] = "0",
    shifts: Annotated[
        str, typer.Option("--shifts", metavar="X[:X]", help="Range of the sum of the profile shifts.")
    ] = "-0.5:1.2",
    tolerance: Annotated[
        float, typer.Option("--tolerance", metavar="PERCENT", help="Permissible relative error of the ratio.")
    ] = 1.0,
    pressure_angle: Annotated[
        float, typer.Option("--pressure-angle", metavar="DEG", help="Normal pressure angle.")
    ] = 20.0,
    face_width: Annotated[
        str | None, typer.Option("--face-width", metavar="LEN", help="Width of both faces. [default: 10 modules]")
    ] = None,
    most: Annotated[int, typer.Option("--most", metavar="N", help="Number of pairs to print, at most.", min=1)] = 20,
    choose: Annotated[int, typer.Option("--choose", metavar="N", help="The pair whose design to write.")] = 1,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.toml", help="Write the design of the chosen pair."),
    ] = None,
    json_file: Json = None,
) -> None:
    """Tooth numbers, helix angles and profile shifts with which cylindrical gears have a ratio and a centre distance.

    All pairs, those without faults first, then by the worst specific sliding. Strength is not considered.
    """
    if output is not None:
        refuse_suffix(output, ".toml")
        if output.exists():
            raise OutputError("cannot write", output, reason="it exists already")
    for file in (output, json_file):
        refuse_unwritable(file)
    with working("sizes"):
        sizing = gm.size(
            ratio,
            _length("--center-distance", center_distance),
            _length("--module", module),
            internal=internal,
            pressure_angle=pressure_angle,
            helix=_range("--helix", helix),
            shifts=_range("--shifts", shifts),
            tolerance=0.01 * tolerance,
            face_width=None if face_width is None else _length("--face-width", face_width),
        )
    text = with_version(sizing.keys(choose))
    write_text(json_file, sizing.json)
    if output is not None:
        write_text(str(output), lambda: text)
    if json_file != "-":
        show(sizing.first_pairs(most))


def _length(option: str, text: str) -> float:
    return in_mm(option, text, examples="64mm or 2.5in; bare = mm")


def _range(option: str, text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    try:
        return float(low), float(high if colon else low)
    except ValueError:
        raise ArgumentError(option, text, must_be="a number, or two as LOW:HIGH") from None
