"""The command `tca`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from gearmesh.app.options import DesignFile, Json, Pair, Set, Timing, chosen_pair, load_gears, refuse_torque
from gearmesh.app.terminal import refuse_unwritable, require_contact, show, warn, without_contact, working, write_text
from gearmesh.errors import DesignError

if TYPE_CHECKING:
    from gearmesh import Gears


def tca(
    design_file: DesignFile,
    json_file: Json = None,
    csv_file: Annotated[
        str | None, typer.Option("--csv", metavar="FILE|-", help="Write a table; - is standard output.")
    ] = None,
    torque: Annotated[
        float | None,
        typer.Option(
            "--torque",
            metavar="NM",
            help="Torque on the pinion: adds the Hertz pressure, with all of it on one pair of teeth.",
        ),
    ] = None,
    ease_off: Annotated[
        str | None,
        typer.Option("--ease-off", metavar="FILE", help="Write the ease-off map of the pinion's flank: .json or .vtu."),
    ] = None,
    pair: Pair = None,
    timing: Timing = True,
    settings: Set = None,
) -> None:
    """Tooth contact: path, transmission error, ellipses."""
    if json_file == csv_file == "-":
        raise DesignError("--csv = -: standard output is taken by --json")
    refuse_torque(torque)
    for file in (json_file, csv_file, ease_off):
        refuse_unwritable(file)
    gears = load_gears(design_file, settings)
    mesh = chosen_pair(gears, pair)
    with working("tooth contact"):
        contact = gears.contact(torque=torque, pair=mesh)
    require_contact(contact.path)
    write_text(json_file, lambda: contact.json(timing=timing))
    write_text(csv_file, contact.csv)
    if ease_off is not None:
        contact.ease_off().save(ease_off, timing=timing)
    if "-" not in (json_file, csv_file):
        show(contact.listings)
    warn(contact.warnings, _other_meshes(gears, mesh), without_contact(contact.path))


def _other_meshes(gears: Gears, mesh: str) -> list[str]:
    """Which meshes a train has beside the one that was asked for, in one line."""
    others = [pair.name for pair in gears.pairs if pair.name != mesh]
    return [f"the contact is that of {mesh}; --pair has the others: {', '.join(others)}"] if others else []
