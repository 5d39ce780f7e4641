"""What commands share: lengths and sizes in words, files that can be written, progress, warnings."""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from gearmesh import lengths
from gearmesh.answers.tables import Listing, align
from gearmesh.errors import ArgumentError, NoSolutionError, OutputError, Status
from gearmesh.progress import listening

if TYPE_CHECKING:
    from gearmesh.contact.path import ContactPath

#: Told how far a long piece of work is (0 to 1) and what it is doing.
Progress = Callable[[float, str], None]

_LARGEST_PICTURE = 16384
#: seconds over which the speed of work is averaged
_EVER = 1e9
#: characters in a line of a window that is wide enough for anything
_ENDLESS = 100_000


# ---------------------------------------------------------------- input


def tolerance_in_mm(text: str | None) -> float | None:
    """The tolerance asked for, in mm, None where none is."""
    return None if text is None else lengths.tolerance_in_mm("--tol", text)


def picture_size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text, re.ASCII)
    width, height = (int(match[1]), int(match[2])) if match else (0, 0)
    if not (16 <= width <= _LARGEST_PICTURE and 16 <= height <= _LARGEST_PICTURE):
        raise ArgumentError("size", text, must_be=f"WIDTHxHEIGHT in pixels, each from 16 to {_LARGEST_PICTURE}")
    return width, height


# ---------------------------------------------------------------- output


def refuse_unwritable(path: str | Path | None) -> None:
    """Find out before the work, not after it, that its result has no place to go."""
    if path is None or path == "-":
        return
    folder = Path(path).parent
    if Path(path).is_dir():
        raise OutputError("cannot write", path, reason="it is a folder")
    if not folder.is_dir():
        raise OutputError("cannot write", path, reason=f"the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise OutputError("cannot write", path, reason=f"the folder {folder} is not writable")


def refuse_suffix(path: Path, *suffixes: str) -> None:
    if path.suffix.lower() not in map(str.lower, suffixes):
        raise OutputError("cannot write", path, reason=f"its suffix must be {' or '.join(suffixes)}")


def write_text(target: str | None, text: Callable[[], str]) -> None:
    if target is None:
        return
    if target == "-":
        sys.stdout.write(text())
        return
    from gearmesh.io import whole_text

    whole_text(target, text())


@contextmanager
def output_folder(path: Path) -> Iterator[None]:
    """An output folder, made if need be, and gone again if nothing was put into it."""
    made = not path.exists()
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError("cannot make the folder", path, reason=error.strerror or str(error)) from None
    try:
        yield
    finally:
        if made and not any(path.iterdir()):
            path.rmdir()


@contextmanager
def working(what: str, *, at_once: bool = False) -> Iterator[Progress]:
    """A progress bar on a terminal, with the time that it took and, once the progress is known, that which remains; until then the
    bar pulses. Elsewhere one line per stage. What the work itself tells on its way counts where the command tells nothing: then
    `what` is the stage, of work that tells anything, which no clock decides, or of any work `at_once`."""
    if not sys.stderr.isatty():
        stage = ""

        def line(fraction: float, doing: str) -> None:
            nonlocal stage
            if doing != stage:
                stage = doing
                sys.stderr.write(f"gearmesh: {doing}\n")

        def first_line(fraction: float) -> None:
            if not stage:
                line(fraction, what)

        if at_once:
            first_line(0.0)
        with listening(first_line):
            yield line
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    words = TextColumn("{task.description}", markup=False)
    columns = (words, BarColumn(), TimeElapsedColumn(), TextColumn("remaining"), TimeRemainingColumn())
    # the speed is that since the beginning: stages are few
    with Progress(*columns, console=Console(stderr=True), transient=True, speed_estimate_period=_EVER) as bar:
        task = bar.add_task(what, total=None)
        most = 0.0

        def own(fraction: float, doing: str) -> None:
            nonlocal most
            most = math.inf
            bar.update(task, total=1.0, completed=fraction, description=doing)

        def on_its_way(fraction: float) -> None:
            nonlocal most
            if fraction > most:
                most = fraction
                bar.update(task, total=1.0, completed=fraction)

        with listening(on_its_way):
            yield own


def show(listings: Iterable[Listing]) -> None:
    """Print tables on standard output: ruled and coloured on a terminal, aligned plain text elsewhere."""
    terminal = sys.stdout.isatty()
    for index, listing in enumerate(listings):
        if terminal:
            _show_ruled(listing)
        else:
            sys.stdout.write(("\n" if index else "") + align(listing))


def _show_ruled(listing: Listing) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    table = Table(
        title=listing.title or None, title_justify="left", box=box.SIMPLE_HEAD, show_header=any(listing.columns)
    )
    for k, (column, numeric) in enumerate(zip(listing.columns, listing.numeric, strict=True)):
        if numeric:
            table.add_column(column.replace(" ", "\n"), justify="right", no_wrap=True)
        else:
            table.add_column(column, no_wrap=k == 0, overflow="fold")
    for row in listing.cells:
        table.add_row(*(Text(text) for text in row))
    console = Console()
    needed = console.measure(table, options=console.options.update(width=_ENDLESS)).minimum
    # a window too narrow for the numbers breaks lines; it never cuts a number short
    console.width = max(console.width, needed)
    console.print(table, soft_wrap=True)


def warn(*sources: Iterable[str]) -> None:
    for line in dict.fromkeys(line for source in sources for line in source):
        print(f"gearmesh: warning: {one_line(line)}", file=sys.stderr)


def require_contact(path: ContactPath) -> None:
    """NoSolutionError if no position of a contact path has contact, saying where and why."""
    if not path.touching.any():
        raise NoSolutionError(reason=f"no contact at any position: {_nowhere(path)}")


def without_contact(path: ContactPath) -> list[str]:
    missing = int((~path.touching).sum())
    return [f"no contact at {missing} of {path.touching.size} positions: {_nowhere(path)}"] if missing else []


def _nowhere(path: ContactPath) -> str:
    """Where a contact path has no contact, and what to try, judged by the first such position."""
    phi1 = path.phi1[~path.touching] * (180.0 / math.pi)
    status = Status(int(path.status[~path.touching][0]))
    return f"phi1 = {phi1.min():g} to {phi1.max():g} deg, {status.name.lower()}; {status.advice}"


def one_line(message: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in " ".join(message.split()))
