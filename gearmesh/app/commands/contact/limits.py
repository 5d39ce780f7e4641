"""The command `limits`: largest depth of the tools and largest height of the tips."""

from __future__ import annotations

from typing import Annotated

import gearmesh as gm
from gearmesh.app.options import DesignFile, Json, Set, option
from gearmesh.app.terminal import refuse_unwritable, show, warn, working, write_text
from gearmesh.errors import ArgumentError, DesignError

#: largest top land, in normal modules: no tooth is wider at its tip
_MAX_LAND_MODULES = 3.0


def limits(
    design_file: DesignFile,
    json_file: Json = None,
    land: Annotated[float, option("--land MODULES", "Narrowest top land allowed; 0 is a pointed tooth.")] = 0.0,
    settings: Set = None,
) -> None:
    """Limits against undercut and pointing: tool depth, tip and number of teeth. Also for designs beyond these limits."""
    from gearmesh.design import files
    from gearmesh.systems.designs import parse_as_stated

    if not 0.0 <= land <= _MAX_LAND_MODULES:
        raise ArgumentError("land", land, must_be=f"a number of modules from 0 to {_MAX_LAND_MODULES:g}")
    refuse_unwritable(json_file)
    design = parse_as_stated(files.override(files.read(design_file), settings or []))
    with working("limits", at_once=True):
        try:
            answer = gm.build(design).limits(land)
        except DesignError as refused:
            from gearmesh.answers.limits import limits_beyond

            answer = limits_beyond(design, refused, land)
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
    warn(answer.warnings)
