"""The command `explore`."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from gearmesh.app.options import Set, option, present
from gearmesh.errors import ArgumentError
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX

if TYPE_CHECKING:
    from gearmesh.explore.state import Origin


def explore(
    what: Annotated[str | None, typer.Argument(metavar="[DESIGN|KIND]", show_default=False)] = None,
    port: Annotated[
        int,
        option("--port N", "Port on this machine. [default: any free one]", show_default=False),
    ] = 0,
    no_browser: Annotated[bool, option("--no-browser", "Do not open the page in the browser.")] = False,
    settings: Set = None,
) -> None:
    """A page in the browser: change a key, and gears and figures follow. Without an argument it offers kinds and samples.

    It is served until Ctrl-C, to the browser of this machine alone.
    """
    from gearmesh.explore.explorer import Explorer, refuse_port, require_server

    refuse_port(port)
    require_server()
    if what is None and settings:
        raise ArgumentError("--set", settings[0], reason="needs a design or a kind")
    with Explorer(lambda: _opened(what, settings or ()), port, browser=not no_browser) as page:
        # a stop is how this command ends, and no failure
        before = {number: signal.signal(number, lambda *_: page.stop()) for number in (signal.SIGINT, signal.SIGTERM)}
        try:
            print(f"{page.url}\nCtrl-C ends the page; the address is good once.", flush=True)
            page.wait()
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)


def _opened(what: str | None, settings: Sequence[str]) -> Origin | None:
    """Return the design of the page; None for a page that offers kinds and samples."""
    from gearmesh.explore.explorer import origin_of_file, origin_of_kind

    if what is None:
        return None
    is_file = Path(what).suffix.lower() in (TOML_SUFFIX, JSON_SUFFIX)
    return origin_of_file(present(Path(what)), settings) if is_file else origin_of_kind(what, settings)
