"""Arguments and options that several commands share."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import gearmesh as gm
from gearmesh.errors import DesignError

if TYPE_CHECKING:
    from gearmesh import Design, Gears

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
Timing = Annotated[
    bool, typer.Option("--timing/--no-timing", help="Run times in the JSON, under the key timing.", show_default=False)
]
Pair = Annotated[
    str | None,
    typer.Option(
        "--pair",
        metavar="A-B",
        help="Which mesh: the names of its members, as sun-planet_1. [default: the first]",
        show_default=False,
    ),
]

SheetTorque = Annotated[
    float | None,
    typer.Option(
        "--torque", metavar="NM", help="Torque on the pinion: adds the forces on the members, of bevel gears."
    ),
]


def refuse_torque(torque: float | None) -> None:
    """Raises DesignError for a torque that is none."""
    if torque is not None and not 0.0 < torque < math.inf:
        raise DesignError(f"--torque = {torque:g}: must be a finite number of Nm above 0")


def load_design(path: Path, overrides: list[str] | None) -> Design:
    """The design of the command line."""
    return gm.load(path, overrides or [])


def load_gears(path: Path, overrides: list[str] | None) -> Gears:
    """The gears of the design of the command line."""
    return gm.build(load_design(path, overrides))


def design_text(path: Path, overrides: list[str] | None) -> str:
    """The design file of the command line as it stands, or, with keys set anew, as TOML that has them."""
    if overrides:
        from gearmesh.design.files import override, read, toml

        return toml(override(read(path), overrides))
    return path.read_bytes().decode("utf-8-sig")


def chosen_pair(gears: Gears, names: str | None) -> str:
    """Name of the mesh that --pair names, of the first one without it. Raises DesignError for another."""
    try:
        return gears.train.pair(0 if names is None else names).name
    except DesignError as failure:
        raise DesignError(f"--{failure}") from failure
