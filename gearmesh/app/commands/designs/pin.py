"""The command `pin`: a design with all values given from which its gears are built.

Building the gears reports progress. Reading their values takes a second at most, during which the bar pulses.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import gearmesh as gm
from gearmesh.app.options import DesignFile, Json, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.formats import TOML_SUFFIX, refuse_suffix


def pin(
    design_file: DesignFile,
    output: Annotated[Path, option("-o --output PINNED.toml", "File to write.")],
    json_file: Json = None,
    settings: Set = None,
) -> None:
    """Write the design with every default and derived value given: it builds the same gears in later versions."""
    refuse_suffix(output, TOML_SUFFIX)
    for file in (output, json_file):
        refuse_unwritable(file)
    gears = load_gears(design_file, settings, gm.Gears.pin)
    with working("pin", at_once=True):
        pinned = gears.pin()
    pinned.save(output)
    write_text(json_file, pinned.json)
    if json_file != "-":
        show(pinned.listings)
    warn(gears.warnings)
