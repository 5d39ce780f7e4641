"""The command `explore`."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Annotated

import typer

from gearmesh.app.options import Set, present
from gearmesh.errors import ArgumentError
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX


def explore(
    what: Annotated[str | None, typer.Argument(metavar="[DESIGN|KIND]", show_default=False)] = None,
    port: Annotated[
        int,
        typer.Option("--port", metavar="N", help="Port on this machine. [default: any free one]", show_default=False),
    ] = 0,
    no_browser: Annotated[bool, typer.Option("--no-browser", help="Do not open the page in the browser.")] = False,
    settings: Set = None,
) -> None:
    """A page on this machine on which turning a number turns the gear. Without an argument it offers kinds and samples.

    It is served until Ctrl-C, to the browser of this machine alone.
    """
    from gearmesh.explore.explorer import Explorer, origin_of_file, origin_of_kind, refuse_port, require_server

    refuse_port(port)
    require_server()
    opened = None
    if what is not None:
        is_file = Path(what).suffix.lower() in (TOML_SUFFIX, JSON_SUFFIX)
        opened = (
            origin_of_file(present(Path(what)), settings or ()) if is_file else origin_of_kind(what, settings or ())
        )
    elif settings:
        raise ArgumentError("--set", settings[0], reason="needs a design or a kind")
    with Explorer(opened, port, browser=not no_browser) as page:
        # a stop is how this command ends, and no failure
        before = {number: signal.signal(number, lambda *_: page.stop()) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            print(f"{page.url}\nCtrl-C ends the page; the address is good once.", flush=True)
            page.wait()
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
