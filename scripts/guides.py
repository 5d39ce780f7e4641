"""The guides of samples/guides, run as a reader would run them: each block in order, in a folder of its own.

Usage: python scripts/guides.py [NAME ...] [--write] [--keep FOLDER]

A guide is samples/guides/NAME.md. Of its fenced blocks

    ```toml pair.toml     any language followed by a file name: written into that file
    ```bash               run by bash, with `gearmesh` the program of this checkout; a status that is not 0 ends the guide
    ```python             run by one interpreter, which keeps its names from block to block of the guide
    ```text               right after a block that ran: what that printed

and others are only shown. Each line of a ```text block must be printed, in that order and one right after the other; a line `...`
stands for any lines. Blanks count as one, and numbers may differ by one in their last digit. A guide begins in an empty folder:
samples come by `gearmesh sample NAME`.

Pictures that a guide shows are samples/guides/pictures/FILE.png, and its blocks write FILE.png into their folder: `--write` puts
them beside the guide, at most 720 pixels wide. A guide that shows a picture which no block writes fails.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
GUIDES = ROOT / "samples" / "guides"
#: largest width of a picture, pixels
WIDTH = 720
#: seconds that one block may take
PATIENCE = 600
NUMBER = re.compile(r"[-+]?\d[\d,]*(?:\.\d+)?(?:[eE][-+]?\d+)?")


class GuideError(Exception):
    """A block that failed, or did not print what stands after it."""


@dataclass(frozen=True)
class Block:
    """A fenced block: its line in the file, language, the file that it is written to ("" if none) and its text."""

    line: int
    language: str
    file: str
    text: str


def blocks(guide: str) -> list[Block]:
    """The fenced blocks of a Markdown text, in order."""
    return [
        Block(guide[: match.start()].count("\n") + 1, match[1], match[2] or "", match[3])
        for match in re.finditer(r"^```(\w+)(?: +(\S+))?[^\n]*\n(.*?)^```$", guide, re.DOTALL | re.MULTILINE)
    ]


def pictures(guide: str) -> list[str]:
    """Names of the pictures that a guide shows, of its own folder."""
    return list(dict.fromkeys(re.findall(r"\]\(pictures/([^)\s]+)\)", guide)))


def missing_line(wanted: str, printed: str) -> str | None:
    """The first line of a ```text block that the printed text does not have in its place; None if it has all."""
    lines = [words for line in printed.splitlines() if (words := " ".join(line.split()))]
    place, anywhere = 0, True
    for line in wanted.splitlines():
        words = " ".join(line.split())
        if not words:
            continue
        if words == "...":
            anywhere = True
            continue
        places = range(place, len(lines)) if anywhere else range(place, min(place + 1, len(lines)))
        match = next((k for k in places if same(words, lines[k])), None)
        if match is None:
            return line
        place, anywhere = match + 1, False
    return None


def same(wanted: str, printed: str) -> bool:
    """Whether two lines have the same words, and numbers that differ by no more than one in the last digit that is wanted."""
    if NUMBER.sub("#", wanted) != NUMBER.sub("#", printed):
        return False
    return all(map(near, NUMBER.findall(wanted), NUMBER.findall(printed)))


def near(wanted: str, printed: str) -> bool:
    """Whether two printed numbers differ by at most one in the last digit of the first."""
    if wanted == printed:
        return True
    mantissa, _, exponent = wanted.lower().replace(",", "").partition("e")
    decimals = len(mantissa.partition(".")[2])
    digit = 10.0 ** (int(exponent or 0) - decimals)
    # a whole number is a count, and counts agree
    if "." not in mantissa and not exponent:
        return False
    return abs(float(wanted.replace(",", "")) - float(printed.replace(",", ""))) <= 1.001 * digit


def run(path: Path, folder: Path) -> dict[str, str]:
    """Run a guide in a folder: what each block printed, by its line. Raises GuideError."""
    guide = path.read_text(encoding="utf-8")
    names: dict[str, Any] = {"__name__": "__main__"}
    printed: dict[str, str] = {}
    output: str | None = None
    for block in blocks(guide):
        place = f"{path.name}:{block.line}"
        if block.file:
            (folder / block.file).write_text(block.text, encoding="utf-8")
            output = None
        elif block.language == "bash":
            output = printed[place] = shell(block.text, folder, place)
        elif block.language == "python":
            output = printed[place] = python(block.text, names, folder, place)
        elif block.language == "text" and output is not None:
            line = missing_line(block.text, output)
            if line is not None:
                raise GuideError(f"{place}: not printed: {line.strip()!r}; printed was\n{output}")
            output = None
    for picture in pictures(guide):
        if not (folder / picture).is_file():
            raise GuideError(f"{path.name}: no block writes {picture}, which the guide shows")
    return printed


def shell(text: str, folder: Path, place: str) -> str:
    """Run a bash block: what it printed, on either stream."""
    program = f'gearmesh() {{ "{sys.executable}" -m gearmesh "$@"; }}\n'
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "100", "NO_COLOR": "1"}
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", program + text],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        encoding="utf-8",
        timeout=PATIENCE,
        check=False,
    )
    if done.returncode:
        raise GuideError(f"{place}: status {done.returncode}\n{done.stdout}")
    return done.stdout


def python(text: str, names: dict[str, Any], folder: Path, place: str) -> str:
    """Run a Python block among the names of those before it: what it printed."""
    stream = io.StringIO()
    with contextlib.chdir(folder), contextlib.redirect_stdout(stream):
        try:
            exec(compile(text, place, "exec"), names)
        except Exception as error:
            raise GuideError(f"{place}: {type(error).__name__}: {error}\n{stream.getvalue()}") from error
    return stream.getvalue()


def keep(path: Path, folder: Path) -> Iterator[Path]:
    """Put the pictures that a guide shows beside it, small: those that its blocks have written into `folder`."""
    from gallery import painted
    from PIL import Image

    target = GUIDES / "pictures"
    for name in pictures(path.read_text(encoding="utf-8")):
        target.mkdir(exist_ok=True)
        with Image.open(folder / name) as image:
            size = (min(WIDTH, image.width), round(image.height * min(1.0, WIDTH / image.width)))
            painted(image.convert("RGB").resize(size, Image.Resampling.LANCZOS)).save(target / name, optimize=True)
        yield target / name


def guides(names: list[str] | None = None) -> list[Path]:
    """The guides' files, or those of these names."""
    paths = sorted(GUIDES.glob("*.md"))
    return [path for path in paths if path.name != "README.md" and (not names or path.stem in names)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--write", action="store_true", help="put the pictures that the guides show beside them")
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER", help="run in FOLDER/NAME, and keep what is written there"
    )
    options = parser.parse_args()
    paths = guides(options.names)
    if set(options.names) - {path.stem for path in paths}:
        parser.error(f"the guides are {', '.join(path.stem for path in guides())}")
    failed = False
    for path in paths:
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(options.keep or scratch).resolve() / path.stem
            folder.mkdir(parents=True, exist_ok=True)
            try:
                run(path, folder)
            except GuideError as error:
                failed = True
                print(error, file=sys.stderr)
                continue
            print(f"{path.stem}: as printed", flush=True)
            if options.write:
                for picture in keep(path, folder):
                    print(f"  {picture.relative_to(ROOT)}: {picture.stat().st_size / 1000:.0f} kB", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
