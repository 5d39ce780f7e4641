"""The site: guides, reference, theory, validation, glossary, and the pages of the packages, as files for a browser.

Usage: python scripts/site [-o FOLDER]

Pages are gathered into a scratch folder laid out as the checkout is, so that their links hold. The reference is written there
from the registry of gear systems, the declared figures, the command line and the docstrings; Sphinx makes HTML of all of it
(`pip install ".[site]"`). The site needs no network and no server. Warnings of Sphinx, as of links that lead nowhere, end the
build with 1.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import gather
import reference
from sphinx.cmd.build import build_main

HERE = Path(__file__).resolve().parent


def build(target: Path) -> int:
    """Write the site into a folder; the status of Sphinx."""
    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch) / "source"
        gather.gather(source)
        reference.write(source)
        arguments = ["-q", "-W", "--keep-going", "-c", str(HERE), "-d", f"{scratch}/doctrees", str(source), str(target)]
        return build_main(arguments)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/site"), metavar="FOLDER")
    options = parser.parse_args()
    status = build(options.output)
    if not status:
        print(f"{options.output / 'index.html'}")
    sys.exit(status)


if __name__ == "__main__":
    main()
