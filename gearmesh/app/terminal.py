"""Functions that commands share: lengths and sizes as texts, files that can be written, progress, warnings."""

from __future__ import annotations

import errno
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
from gearmesh.progress import Progress, listening

if TYPE_CHECKING:
    from gearmesh.contact.path import ContactPath

#: share of the work between two lines of progress in a pipe
REPORTED_SHARE = 0.1
#: largest width or height of a picture, pixels
_LARGEST_PICTURE = 16384
#: time over which the speed of work is averaged: all of it
_AVERAGING_SECONDS = 1e9
#: number of characters in a line that is wide enough for any table
_ENDLESS_LINE = 100_000


# ---------------------------------------------------------------- input


def tolerance_in_mm(text: str | None) -> float | None:
    """Return the tolerance of --tol in mm, None without the option."""
    return None if text is None else lengths.tolerance_in_mm("--tol", text)


def picture_size(text: str) -> tuple[int, int]:
    """Return width and height of --size in pixels. Raises ArgumentError for other texts."""
    match = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text, re.ASCII)
    width, height = (int(match[1]), int(match[2])) if match else (0, 0)
    if not (16 <= width <= _LARGEST_PICTURE and 16 <= height <= _LARGEST_PICTURE):
        raise ArgumentError("size", text, must_be=f"WIDTHxHEIGHT in pixels, each from 16 to {_LARGEST_PICTURE}")
    return width, height


# ---------------------------------------------------------------- output


def refuse_unwritable(path: str | Path | None) -> None:
    """Raise OutputError, before the work, for a file that cannot be written."""
    if path is None or path == "-":
        return
    folder = Path(path).parent
    if Path(path).is_dir():
        raise OutputError("cannot write", path, reason="it is a folder")
    if not folder.is_dir():
        raise OutputError("cannot write", path, reason=f"the folder {folder} does not exist")
    if not os.access(folder, os.W_OK):
        raise OutputError("cannot write", path, reason=f"the folder {folder} is not writable")


def refuse_folder(path: Path | None) -> None:
    """Raise OutputError, before the work, for an output folder that can be neither made nor written to."""
    if path is None:
        return
    known = next(folder for folder in (path, *path.absolute().parents) if folder.exists())
    if not known.is_dir():
        why = os.strerror(errno.EEXIST if known == path else errno.ENOTDIR)
        raise OutputError("cannot make the folder", path, reason=why)
    if not os.access(known, os.W_OK):
        raise OutputError("cannot write", path, reason=f"the folder {known} is not writable")


def write_text(target: str | None, text: Callable[[], str]) -> None:
    """Write a text to a file, or to standard output for "-"; None writes nothing."""
    if target is None:
        return
    if target == "-":
        sys.stdout.write(text())
        return
    from gearmesh.io import whole_text

    whole_text(target, text())


@contextmanager
def output_folder(path: Path) -> Iterator[None]:
    """Make an output folder if it does not exist, and remove it again if it stays empty."""
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
    """Show the progress of work: a bar on a terminal, one line per stage elsewhere.

    The bar shows the elapsed time and the remaining time, and pulses until the progress is known. The command reports stages by the
    yielded function. Without such reports, the progress reported by the work itself moves the bar, and `what` is the only stage.
    Elsewhere than on a terminal this stage has a line as soon as the work reports progress, or immediately for work `at_once`.
    """
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
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as ProgressBar

    words = TextColumn("{task.description}", markup=False)
    columns = (words, BarColumn(), TimeElapsedColumn(), TextColumn("remaining"), TimeRemainingColumn())
    # average the speed from the beginning, because there are few stages
    with ProgressBar(
        *columns, console=Console(stderr=True), transient=True, speed_estimate_period=_AVERAGING_SECONDS
    ) as bar:
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


def at_times(progress: Progress) -> Progress:
    """Return a progress that reports always on a terminal, and after each REPORTED_SHARE in a pipe."""
    if sys.stderr.isatty():
        return progress
    told = [0.0]

    def tell(fraction: float, doing: str) -> None:
        if fraction >= told[0] + REPORTED_SHARE or fraction == 1.0:
            told[0] = fraction
            progress(fraction, f"{doing}, {100.0 * fraction:.0f} %")

    return tell


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
    needed = console.measure(table, options=console.options.update(width=_ENDLESS_LINE)).minimum
    # a window that is too narrow for the numbers breaks lines; numbers are never cut
    console.width = max(console.width, needed)
    console.print(table, soft_wrap=True)
    for note in listing.notes:
        console.print(Text(note))


def warn(*sources: Iterable[str]) -> None:
    """Print warnings on standard error, each once, after what is printed already where both go to one file or pipe."""
    sys.stdout.flush()
    for line in dict.fromkeys(line for source in sources for line in source):
        print(f"gearmesh: warning: {one_line(line)}", file=sys.stderr)


def require_contact(path: ContactPath) -> None:
    """Raise NoSolutionError, with positions and reason, if no position of a contact path has contact."""
    if not path.touching.any():
        raise NoSolutionError(reason=f"no contact at any position: {_nowhere(path)}")


def without_contact(path: ContactPath) -> list[str]:
    """Return a warning about positions without contact, nothing if all positions have contact."""
    missing = int((~path.touching).sum())
    return [f"no contact at {missing} of {path.touching.size} positions: {_nowhere(path)}"] if missing else []


def _nowhere(path: ContactPath) -> str:
    """Return the range of positions without contact, with reason and advice for the first of them."""
    phi1 = path.phi1[~path.touching] * (180.0 / math.pi)
    status = Status(int(path.status[~path.touching][0]))
    return f"phi1 = {phi1.min():g} to {phi1.max():g} deg, {status.name.lower()}; {status.advice}"


def one_line(message: str) -> str:
    """Return a message in one line of printable characters."""
    return "".join(c if c.isprintable() else "?" for c in " ".join(message.split()))
