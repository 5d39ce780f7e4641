"""The command `freecad`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from gearmesh.app.options import DesignFile, Set, design_text, load_design, option
from gearmesh.app.terminal import refuse_unwritable, tolerance_in_mm, write_text
from gearmesh.formats import MACRO_SUFFIX, refuse_suffix


def freecad(
    design_file: DesignFile,
    output: Annotated[Path, option("-o --output FILE.FCMacro", "File to write.")],
    tol: Annotated[
        str, option("--tol LEN", "Largest distance from the exact surface: 10um, 0.01mm, 0.0004in; bare = mm.")
    ] = "0.1um",
    settings: Set = None,
) -> None:
    """A macro for FreeCAD: the design and each member as a feature, rebuilt when a key of the design changes."""
    from gearmesh.answers.bodies.freecad import macro
    from gearmesh.design.files import is_input, override, read

    refuse_suffix(output, MACRO_SUFFIX)
    refuse_unwritable(output)
    tolerance_in_mm(tol)
    design = load_design(design_file, settings)
    folder = Path.cwd() if is_input(design_file) else design_file.resolve().parent
    data = override(read(design_file), settings or [])
    write_text(str(output), lambda: macro(design, data, design_text(design_file, settings), folder, tol))
