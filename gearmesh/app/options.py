"""Arguments and options that several commands share."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from gearmesh.design import Design


class MemberName(StrEnum):
    """A member of the pair, or both where a file can place them."""

    pinion = "pinion"
    gear = "gear"
    both = "both"


class PartName(StrEnum):
    """What `solid` makes."""

    pinion = "pinion"
    gear = "gear"
    both = "both"
    worm = "worm"


DesignFile = Annotated[Path, typer.Argument(metavar="DESIGN", help="Design file, TOML or JSON.", show_default=False)]
Set = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set a key of the design, as pinion.teeth=25; may be repeated."),
]
Tolerance = Annotated[
    str | None,
    typer.Option(
        "--tol", metavar="LEN", help="Largest distance of mesh and exact surface: 10um, 0.01mm, 0.0004in; bare = mm."
    ),
]
Json = Annotated[str | None, typer.Option("--json", metavar="FILE|-", help="Write JSON; - is standard output.")]


def load_design(path: Path, overrides: list[str] | None) -> Design:
    from gearmesh.design import load

    return load(path, overrides or [])
