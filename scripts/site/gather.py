"""The pages that stand in the checkout, in a scratch folder laid out as it is, so that links between them hold.

Pages of packages and samples keep their paths, those of scripts/site/pages go to the top. Files that pages link to, as pictures,
sources and designs, are copied with them. A line that links to a table of scripts/measured becomes the table.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import sys
from base64 import b64decode
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1]))
from tables import shown

from gearmesh import __version__

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PAGES = HERE / "pages"
#: pages beside a README that the site lists under it
BESIDE = ("measured", "notes", "theory")
#: targets of links and pictures in Markdown and in HTML
LINK = re.compile(r"(?<=\]\()([^)\s#]+)|(?<=src=\")([^\"]+)")
MARKDOWN_LINK = re.compile(r"\[([^][]*)\]\(([^)\s#]+)\)")
#: languages of fenced blocks that are followed by the name of their file
NAMED = re.compile(r"^```(\w+) (\S+)$", re.MULTILINE)
#: the rows of a table that a notebook shows
TABLE = re.compile(r"<table[^>]*>(.*)</table>", re.DOTALL)


def gather(source: Path) -> None:
    """Put all pages that exist as files into `source`, with the files that they link to."""
    shutil.copytree(PAGES, source)
    cite = source / "citation.md"
    cite.write_text(cite.read_text(encoding="utf-8").replace("VERSION", __version__), encoding="utf-8")
    for path in checkout_pages():
        _stage(path, path.relative_to(ROOT), source)
    for path in sorted(PAGES.rglob("*.md")):
        _with_linked(path.read_text(encoding="utf-8"), path.relative_to(PAGES), source)
    folder = source / "samples" / "guides"
    for path in sorted((ROOT / "samples" / "guides").glob("*.ipynb")):
        _notebook(path, folder)
    _list_under(folder / "README.md", sorted(path.stem for path in folder.glob("*.md") if path.stem != "README"))
    for page in sorted(path for top in ("gearmesh", "scripts") for path in (source / top).rglob("README.md")):
        if beside := sorted(path.stem for path in page.parent.glob("*.md") if path.stem in BESIDE):
            _list_under(page, beside)


def _list_under(page: Path, names: list[str]) -> None:
    """List pages under a page in the site's contents; they are listed nowhere else."""
    known = page.read_text(encoding="utf-8")
    page.write_text("\n".join([known, "```{toctree}", ":hidden:", "", *names, "```", ""]), encoding="utf-8")


def _notebook(path: Path, folder: Path) -> None:
    """A notebook as a page: its cells in order, each with the texts, tables and pictures that it gave."""
    parts = []
    for number, cell in enumerate(json.loads(path.read_text(encoding="utf-8"))["cells"]):
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
        for place, output in enumerate(cell.get("outputs", [])):
            data = output.get("data", {})
            if "image/png" in data:
                picture = folder / "pictures" / f"{path.stem}_{number}_{place}.png"
                picture.parent.mkdir(exist_ok=True)
                picture.write_bytes(b64decode("".join(data["image/png"])))
                parts.append(f"![output of the cell above](pictures/{picture.name})")
            elif table := TABLE.search("".join(data.get("text/html", ""))):
                # as Furo has its own; without blank lines, which end what is HTML
                rows = re.sub(r"\s*\n\s*", "\n", table[1].strip())
                parts.append(f'<div class="table-wrapper"><table class="docutils">\n{rows}\n</table></div>')
            elif printed := "".join(output.get("text", data.get("text/plain", ""))):
                parts.append(f"```text\n{printed.rstrip()}\n```")
    page = folder / f"{path.stem}.md"
    page.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    _with_linked(page.read_text(encoding="utf-8"), Path("samples/guides") / page.name, folder.parents[1])


def checkout_pages() -> list[Path]:
    """The pages of packages, samples, guides and scripts, and the changes."""
    readmes = [path for top in ("gearmesh", "samples", "scripts") for path in (ROOT / top).rglob("*.md")]
    return sorted(path for path in readmes if not path.is_relative_to(HERE))


def _stage(path: Path, place: Path, source: Path) -> None:
    """Copy a page, as Sphinx reads it, and what it links to."""
    text = path.read_text(encoding="utf-8")
    # the page of the checkout itself is the site's first
    up = "../" * (len(place.parts) - 1)
    text = re.sub(rf"\]\((?:{re.escape(up)}|\./)README\.md(#\S*?)?\)", f"]({up}index.md)", text) if up else text
    # the site's own pages are at its top
    text = text.replace(f"]({os.path.relpath(PAGES, path.parent)}/", f"]({up}")
    text = shown(text)
    text = NAMED.sub(_captioned, text)
    # folders have no page
    text = MARKDOWN_LINK.sub(lambda link: link[1] if (path.parent / link[2]).is_dir() else link[0], text)
    target = source / place
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text, encoding="utf-8")
    _with_linked(text, place, source)


def _captioned(opening: re.Match[str]) -> str:
    """The opening of a fenced block that is a file, as Sphinx shows its name."""
    return f"```{{code-block}} {opening[1]}\n:caption: {opening[2]}\n"


def _with_linked(text: str, place: Path, source: Path) -> None:
    """Copy the files of the checkout that a page at a place links to, but for pages."""
    for match in LINK.finditer(text):
        named = match[1] or match[2]
        linked = (ROOT / place.parent / named).resolve()
        if "://" in named or linked.suffix == ".md" or not linked.is_file() or not linked.is_relative_to(ROOT):
            continue
        copy = source / linked.relative_to(ROOT)
        if not copy.exists():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(linked, copy)
