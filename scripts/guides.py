"""The guides of samples/guides, run as a reader would run them: each block in its order, in a folder of its own.

Usage: python scripts/guides.py [NAME ...] [--write] [--keep FOLDER]

A guide is samples/guides/NN-name.md. Of its fenced blocks

    ```toml pair.toml           of any language, with the name of a file: written into that file
    ```bash                     run by bash, `gearmesh` is the program of this checkout; a status other than 0 fails
    ```python                   run by one interpreter for the whole guide, which keeps its names from block to block
    ```text                     right after a block that ran: what that printed

and others are only shown. In a ```text block a line `...` stands for any lines. Blanks count as one, and decimals may differ by one
in the last digit that is given. `--write` puts the numbers that are printed now in the place of those that stand there. Above a
block that runs, a comment `<!-- needs: PROGRAM -->` has it left out, with its output and pictures, where there is no such program.

A picture that a guide shows is samples/guides/pictures/NN-name_FILE.png, and a block writes FILE.png. `--write` keeps a small copy,
else the kept one must look like it.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Self

ROOT = Path(__file__).resolve().parents[1]
GUIDES = ROOT / "samples" / "guides"
PICTURES = GUIDES / "pictures"
#: largest width of a kept picture, pixels
WIDTH = 900
#: size to which pictures are scaled down to be compared, and the largest mean difference of their greys, of 255: gross change
GLANCE, UNLIKE = (48, 36), 12.0
#: seconds that one block may take
PATIENCE = 600
FENCE = re.compile(r"^(?:<!-- needs: (\S+) -->\n+)?```(\w+)(?: +(\S+))?\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
ANY = "..."

#: Program of a guide's interpreter: run each text that it receives, and return the printed text and the error.
SESSION = """
import contextlib, io, json, os, sys, traceback
answers = os.fdopen(os.dup(1), "w")
os.dup2(2, 1)
names = {"__name__": "__main__"}
for line in sys.stdin:
    printed, error = io.StringIO(), ""
    with contextlib.redirect_stdout(printed):
        try:
            exec(compile(json.loads(line), "guide", "exec"), names)
        except BaseException:
            error = traceback.format_exc()
    print(json.dumps([printed.getvalue(), error]), file=answers, flush=True)
"""


class GuideError(Exception):
    """A block that failed, or whose output differs from the text after it."""


@dataclass(frozen=True)
class Block:
    """A fenced block: position of its text in the guide, its line, the program that it needs, its language, and the file that
    it is written to; each text is "" if there is none."""

    start: int
    line: int
    needs: str
    language: str
    file: str
    text: str

    @property
    def possible(self) -> bool:
        """True if the program that the block needs is installed."""
        return not self.needs or shutil.which(self.needs) is not None


def blocks(guide: str) -> list[Block]:
    """The fenced blocks of a Markdown text, in order."""
    return [
        Block(match.start(4), guide[: match.start(4)].count("\n"), match[1] or "", match[2], match[3] or "", match[4])
        for match in FENCE.finditer(guide)
    ]


def pictures(path: Path) -> dict[str, Path]:
    """Return the pictures that a guide shows: kept files by the names that its blocks use."""
    prefix = f"{path.stem}_"
    shown = dict.fromkeys(re.findall(r"\]\(pictures/([^)\s]+)\)", path.read_text(encoding="utf-8")))
    if alien := [name for name in shown if not name.startswith(prefix)]:
        raise GuideError(f"{path.name}: {alien[0]}: names of its pictures begin with {prefix}")
    return {name.removeprefix(prefix): PICTURES / name for name in shown}


def refreshed(wanted: str, printed: str) -> str:
    """A ```text block with the numbers that are printed now, where they differ by more than rounding.

    Raises GuideError with the first line that is not printed in its place, but for its numbers.
    """
    lines = [line for line in printed.splitlines() if line.strip()]
    keys = [key(line) for line in lines]
    made, place, anywhere = [], 0, False
    for line in wanted.splitlines():
        if line.strip() in (ANY, ""):
            made.append(line)
            anywhere = anywhere or bool(line)
            continue
        places = range(place, len(keys) if anywhere else min(place + 1, len(keys)))
        match = next((k for k in places if same(line, lines[k])), None)
        if match is None:
            match = next((k for k in places if keys[k] == key(line)), None)
        if match is None:
            raise GuideError(f"not printed: {line.strip()!r}; of\n{printed}")
        made.append(line if same(line, lines[match]) else lines[match].rstrip())
        place, anywhere = match + 1, False
    if place < len(lines) and not anywhere:
        raise GuideError(f"printed, too: {lines[place].strip()!r}; of\n{printed}")
    return "".join(f"{line}\n" for line in made)


def key(line: str) -> str:
    """A line without its numbers."""
    return " ".join(NUMBER.sub("#", line).split())


def same(wanted: str, printed: str) -> bool:
    """True for lines of the same words whose decimals differ by one in the last wanted digit at most."""
    return key(wanted) == key(printed) and all(map(near, NUMBER.findall(wanted), NUMBER.findall(printed)))


def near(wanted: str, printed: str) -> bool:
    """True for numbers that differ by one in the last digit of the first at most; whole numbers are counts and must agree."""
    mantissa, _, exponent = wanted.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    if not decimals and not exponent:
        return float(wanted) == float(printed)
    return abs(float(wanted) - float(printed)) <= 1.001 * 10.0 ** (int(exponent or 0) - decimals)


class Session:
    """One interpreter for the Python blocks of a guide, in its folder."""

    def __init__(self, folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", SESSION],
            cwd=folder,
            env=environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            encoding="utf-8",
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.process.kill()
        self.process.communicate()

    def run(self, text: str) -> str:
        """Run a block: what it printed."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps(text), file=self.process.stdin, flush=True)
        answer = self.process.stdout.readline()
        if not answer:
            raise GuideError("the interpreter ended")
        printed, error = json.loads(answer)
        if error:
            raise GuideError(error)
        return str(printed)


def environment() -> dict[str, str]:
    """Return the environment of the programs of a guide: this checkout, a narrow terminal."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "80", "NO_COLOR": "1"}


#: lines of progress, which commands print into a pipe in place of a terminal's progress bar
STAGE = re.compile(r"^gearmesh: (?!warning|error).*\n", re.MULTILINE)


def shell(text: str, folder: Path) -> str:
    """Run a bash block: what it printed, on either stream, as a terminal keeps it."""
    program = f'gearmesh() {{ "{sys.executable}" -m gearmesh "$@"; }}\n'
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", program + text],
        cwd=folder,
        env=environment(),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=PATIENCE,
        check=False,
    )
    if done.returncode:
        raise GuideError(f"status {done.returncode}\n{done.stdout}")
    return STAGE.sub("", done.stdout)


def run(path: Path, folder: Path, *, write: bool = False) -> None:
    """Run a guide in a folder, and compare what it prints and draws; or write that into the guide.

    Raises GuideError.
    """
    guide = path.read_text(encoding="utf-8")
    parts, end, printed, whole = [], 0, None, True
    with Session(folder) as session:
        for block in blocks(guide):
            parts += [guide[end : block.start], block.text]
            end = block.start + len(block.text)
            whole = whole and block.possible
            try:
                if block.language == "text" and printed is not None:
                    parts[-1] = refreshed(block.text, printed)
                    refuse_change(block.text, parts[-1], printed, write=write)
                    printed = None
                else:
                    printed = outcome(block, session, folder)
            except GuideError as error:
                raise GuideError(f"{path.name}:{block.line}: {error}") from None
    if write:
        path.write_text("".join(parts) + guide[end:], encoding="utf-8")
    for drawn, kept in pictures(path).items():
        if not (folder / drawn).is_file():
            if whole:
                raise GuideError(f"{path.name}: no block writes {drawn}, which it shows")
        elif write:
            keep(folder / drawn, kept)
        elif (change := difference(folder / drawn, kept)) > UNLIKE:
            raise GuideError(f"{path.name}: {kept.name} looks unlike {drawn}, by {change:.1f} of 255")


def outcome(block: Block, session: Session, folder: Path) -> str | None:
    """Return the output of a block; None for a block that does not run."""
    if block.file:
        (folder / block.file).write_text(block.text, encoding="utf-8")
    elif block.language == "bash" and block.possible:
        return shell(block.text, folder)
    elif block.language == "python" and block.possible:
        return session.run(block.text)
    return None


def refuse_change(wanted: str, now: str, printed: str, *, write: bool) -> None:
    """Raise GuideError for a block whose numbers have changed, unless it is to be written anew."""
    for old, new in zip(wanted.splitlines(), now.splitlines(), strict=True):
        if old != new and not write:
            raise GuideError(f"printed: {new.strip()!r}, not {old.strip()!r}; of\n{printed}")


def keep(drawn: Path, kept: Path) -> None:
    """Write a small copy of a picture."""
    from gallery import painted
    from PIL import Image

    kept.parent.mkdir(exist_ok=True)
    with Image.open(drawn) as image:
        size = (min(WIDTH, image.width), round(image.height * min(1.0, WIDTH / image.width)))
        opaque = Image.new("RGB", image.size, "white")
        opaque.paste(image, mask=image.getchannel("A") if "A" in image.getbands() else None)
        painted(opaque.resize(size, Image.Resampling.LANCZOS)).save(kept, optimize=True)


def difference(drawn: Path, kept: Path) -> float:
    """Mean difference of the greys of two pictures, both made small; of all of 255 if the copy is missing or of another shape."""
    import numpy as np
    from PIL import Image

    if not kept.is_file():
        return 255.0
    with Image.open(drawn) as new, Image.open(kept) as old:
        if abs(new.width / new.height - old.width / old.height) > 0.02:
            return 255.0
        greys = [
            np.asarray(image.convert("RGB").resize(GLANCE, Image.Resampling.BOX).convert("L"), dtype=float)
            for image in (new, old)
        ]
    return float(np.abs(greys[0] - greys[1]).mean())


def guides() -> list[Path]:
    """The files of all guides, in their order."""
    return sorted(GUIDES.glob("[0-9][0-9]-*.md"))


def run_named(
    about: str | None, what: str, files: list[Path], run: Callable[..., None], verdict: Callable[[Path], str]
) -> None:
    """Run the guides or notebooks that the command line names, or all; exits with 1 if one of them fails."""
    parser = argparse.ArgumentParser(description=about, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--write", action="store_true", help=f"write what is printed and drawn into the {what}s")
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="run in FOLDER/NAME, emptied first, and keep what is written there"
    )
    options = parser.parse_args()
    paths = {path.stem: path for path in files}
    if unknown := [name for name in options.names if name not in paths]:
        parser.error(f"no {what} is called {unknown[0]}; there are {', '.join(paths)}")
    failed = False
    for name, path in paths.items():
        if options.names and name not in options.names:
            continue
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(options.keep or scratch).resolve() / name
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True, exist_ok=True)
            try:
                run(path, folder, write=options.write)
            except GuideError as error:
                failed = True
                print(error, file=sys.stderr)
            else:
                print(f"{name}: {verdict(path)}", flush=True)
    sys.exit(failed)


def main() -> None:
    run_named(__doc__, "guide", guides(), run, lambda path: "as it says")


if __name__ == "__main__":
    main()
