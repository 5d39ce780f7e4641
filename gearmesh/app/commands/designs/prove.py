"""The command `prove`: a kind of gears against itself."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import gearmesh as gm
from gearmesh.app.options import Json, Set
from gearmesh.app.terminal import refuse_unwritable, show, working, write_text
from gearmesh.errors import ArgumentError
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX


def prove(
    what: Annotated[str, typer.Argument(metavar="KIND|DESIGN", show_default=False)],
    json_file: Json = None,
    settings: Set = None,
) -> None:
    """A kind of gears, by its example or a design: derivatives, normals, joins, motions and keys, compared with each other."""
    is_file = what == "-" or Path(what).suffix in (TOML_SUFFIX, JSON_SUFFIX)
    if settings and not is_file:
        raise ArgumentError("--set", reason="needs a design file")
    refuse_unwritable(json_file)
    subject: str | gm.Design = gm.load(what, settings or (), complete=False) if is_file else what
    with working("prove"):
        answer = gm.prove(subject)
    write_text(json_file, answer.json)
    if json_file != "-":
        show(answer.listings)
