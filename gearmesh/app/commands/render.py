"""The command `render`."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from gearmesh.app.options import DesignFile, Pair, Set, chosen_pair, load_gears
from gearmesh.app.terminal import picture_size, refuse_suffix, refuse_unwritable, warn, working
from gearmesh.errors import DesignError


class View(StrEnum):
    """What a picture shows."""

    contact = "contact"
    pattern = "pattern"
    gap = "gap"
    pair = "pair"


def render(
    design_file: DesignFile,
    output: Annotated[Path, typer.Option("-o", "--output", metavar="FILE.png", help="Picture to write.")],
    view: Annotated[
        View,
        typer.Option(
            "--view",
            help="Path and ellipses on a tooth, the pattern as their union, the pattern by the roll test, or the pair in mesh.",
        ),
    ] = View.contact,
    member: Annotated[
        str | None, typer.Option("--member", metavar="NAME", help="Whose tooth. [default: pinion]", show_default=False)
    ] = None,
    phi1: Annotated[
        float | None, typer.Option("--phi1", metavar="DEG", help="One position. [default: the design's]")
    ] = None,
    pair: Pair = None,
    size: Annotated[str, typer.Option("--size", metavar="WxH", help="Width and height in pixels.")] = "1600x1200",
    settings: Set = None,
) -> None:
    """A picture of the contact on a tooth, or of the pair in mesh."""
    pixels = picture_size(size)
    refuse_suffix(output, ".png")
    refuse_unwritable(output)
    if phi1 is not None and not math.isfinite(phi1):
        raise DesignError(f"--phi1 = {phi1}: must be a finite number of degrees")
    gears = load_gears(design_file, settings)
    mesh = chosen_pair(gears, pair)
    names = tuple(gears.train.pair(mesh).members)
    if member is not None and member not in names:
        raise DesignError(f"--member = {member}: must be one of {', '.join(names)}")
    with working("picture"):
        gears.picture(view.value, member, phi1=phi1, size=pixels, pair=mesh).save(output)
    warn(gears.warnings)
