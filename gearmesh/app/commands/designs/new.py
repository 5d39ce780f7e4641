"""The command `new`: a commented design file."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

import gearmesh as gm
from gearmesh.app.options import option
from gearmesh.app.terminal import refuse_unwritable, write_text
from gearmesh.errors import OutputError
from gearmesh.formats import TOML_SUFFIX, refuse_suffix


def new(
    kind: Annotated[str, typer.Argument(metavar="KIND", show_default=False, help="A kind of design, see describe.")],
    every_key: Annotated[bool, option("--all", "Every key, not only those that most designs set.")] = False,
    output: Annotated[Path | None, option("-o --output FILE.toml", "File to write. [default: standard output]")] = None,
) -> None:
    """A commented design file of a kind: the required keys with starting values, and usual keys with their defaults."""
    text = gm.new(kind, short=not every_key)
    if output is None:
        sys.stdout.write(text)
        return
    refuse_suffix(output, TOML_SUFFIX)
    refuse_unwritable(output)
    if output.exists():
        raise OutputError("cannot write", output, reason="it exists already")
    write_text(str(output), lambda: text)
