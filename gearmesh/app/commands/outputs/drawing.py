"""The command `drawing`: a workshop drawing of one member."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from gearmesh.app.options import DesignFile, Member, Set, load_gears, option
from gearmesh.app.terminal import refuse_unwritable, warn, working
from gearmesh.formats import DRAWING_SUFFIXES, refuse_suffix


def drawing(
    design_file: DesignFile,
    member: Member,
    output: Annotated[Path, option("-o --output FILE.(pdf|svg|png)", "File to write; its suffix is the format.")],
    settings: Set = None,
) -> None:
    """A workshop drawing of one gear: section, view along the axis, dimensions, gear data, title block.

    The sheet is A4 if the gear fits at full size or larger, otherwise A3, at a scale of ISO 5455.
    """
    refuse_suffix(output, *DRAWING_SUFFIXES)
    refuse_unwritable(output)
    gears = load_gears(design_file, settings, lambda gears: gears.drawing(member))
    with working(f"drawing of the {member}", at_once=True):
        page = gears.drawing(member)
        page.save(output)
    print(f"{output}: {page.sheet} at {page.scale}")
    warn(gears.warnings)
