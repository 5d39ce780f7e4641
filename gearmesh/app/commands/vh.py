"""The command `vh`."""

from __future__ import annotations

from gearmesh.app.options import DesignFile, Json, Set, load_gears
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text


def vh(design_file: DesignFile, json_file: Json = None, settings: Set = None) -> None:
    """V-H check of bevel gears: displacements of the pinion that bring the contact to toe and heel, on both sides.

    With --set assembly.dG and assembly.d_delta (J and alpha) for a gear that stands otherwise.
    """
    refuse_unwritable(json_file)
    gears = load_gears(design_file, settings)
    with working("V-H check"):
        found = gears.vh()
    write_text(json_file, found.json)
    if json_file != "-":
        show(found.listings)
    warn(found.warnings)
