"""The command `sample`: the design files, guides and notebooks that come with the package."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from gearmesh import samples
from gearmesh.answers.tables import Listing
from gearmesh.app.options import option
from gearmesh.app.terminal import show
from gearmesh.errors import OutputError


def sample(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", show_default=False)] = None,
    output: Annotated[Path, option("-o --output DIR", "Folder to copy it to.")] = Path(),
) -> None:
    """List the samples, guides and notebooks that come with the package, or copy one into a folder."""
    if name is None:
        show(
            Listing("", (title, "what"), [(one, samples.headline(one)) for one in names])
            for title, names in (("sample", samples.names()), ("guide", samples.guides()))
        )
        return
    if not output.is_dir():
        raise OutputError("cannot write to", output, reason="it is not a folder")
    show([Listing("", ("",), [(str(samples.copy(name, output)),)])])
