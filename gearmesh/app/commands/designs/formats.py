"""The command `formats`: the files that the program writes and reads."""

from __future__ import annotations

from typing import Annotated

import typer

from gearmesh.answers.tables import Listing
from gearmesh.app.terminal import show
from gearmesh.errors import ArgumentError
from gearmesh.formats import FILE_FORMATS, FORMAT_COLUMNS, format_row


def formats(
    suffix: Annotated[str | None, typer.Argument(metavar="[SUFFIX]", show_default=False)] = None,
) -> None:
    """List the files that the commands write and read, by suffix: contents, precision, what must be installed."""
    wanted = None if suffix is None else f".{suffix.lstrip('.').lower()}"
    known = dict.fromkeys(one for entry in FILE_FORMATS for one in entry.suffixes)
    if wanted is not None and wanted not in map(str.lower, known):
        raise ArgumentError("suffix", suffix, must_be=f"one of {', '.join(known)}")
    rows = [format_row(entry) for entry in FILE_FORMATS if wanted is None or wanted in map(str.lower, entry.suffixes)]
    show([Listing("", FORMAT_COLUMNS, rows)])
