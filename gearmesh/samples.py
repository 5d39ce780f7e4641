"""Samples of the package: design files, files of trains, scripts that compute a figure from them, guides and notebooks.

In a checkout and in an editable install they are in the folder `samples` beside the package. In a wheel they are inside the
package as `sample_files` (see pyproject.toml), without the pictures of guides.
"""

from __future__ import annotations

import ast
import difflib
import json
import re
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from gearmesh.errors import ArgumentError, OutputError

#: suffixes of samples: designs and scripts
SAMPLE_SUFFIXES = (".toml", ".py")
#: suffixes of guides: texts with commands and programs, and notebooks
GUIDE_SUFFIXES = (".md", ".ipynb")
#: names of other files in a design
_NAMED_FILES = re.compile(r'^\w+ = "([\w-]+\.csv)"', re.MULTILINE)


def names() -> list[str]:
    """Return all samples in alphabetical order, by file name without the suffix: "spur", "fig9_beveloid_ellipse"."""
    return sorted(name for name, file in _files().items() if file.name.endswith(SAMPLE_SUFFIXES))


def guides() -> list[str]:
    """Return all guides in their order, then all notebooks, by file name without the suffix: "01-spur-pair", "gears-in-3d"."""
    return sorted(name for name, file in _files().items() if file.name.endswith(GUIDE_SUFFIXES))


def text(name: str) -> str:
    """Return the text of a sample or guide. Raises DesignError, with the most similar name, if it does not exist."""
    return _find(name).read_text(encoding="utf-8")


def headline(name: str) -> str:
    """Return a sample's first comment or docstring, up to a colon or the end of a sentence; the title of a guide."""
    lines = text(name).splitlines()
    file = _find(name).name
    if file.endswith(".ipynb"):
        lines = "".join(json.loads("\n".join(lines))["cells"][0]["source"]).splitlines()
    if file.endswith(GUIDE_SUFFIXES):
        return lines[0].removeprefix("# ")
    if file.endswith(".py"):
        opening = ast.get_docstring(ast.parse("\n".join(lines))) or ""
    else:
        comment = [line.lstrip("# ") if line.startswith("#") else "" for line in lines]
        opening = "\n".join(comment[: comment.index("")] if "" in comment else comment)
    return re.split(r"[.:] |(?<=[?]) ", " ".join(opening.partition("\n\n")[0].split()))[0].rstrip(".")


def copy(name: str, folder: str | Path) -> Path:
    """Write a sample or guide, and the files that it names, into an existing folder; return its path.

    Scripts need their designs beside them; guides copy their files themselves. Raises DesignError for a sample that does not
    exist, OutputError for a file that exists already or cannot be written.
    """
    from gearmesh.io.atomic import whole_text

    sample = _find(name)
    named = sorted(set(_NAMED_FILES.findall(text(name)))) if sample.name.endswith(SAMPLE_SUFFIXES[0]) else []
    targets = {Path(folder) / file: _folder().joinpath(file) for file in named}
    targets = {Path(folder) / sample.name: sample, **targets}
    for target in targets:
        if target.exists():
            raise OutputError("cannot write", target, reason="it exists already")
    for target, source in reversed(targets.items()):
        whole_text(target, source.read_text(encoding="utf-8"))
    return Path(folder) / sample.name


def folder_path() -> Path:
    """Return the folder of the samples."""
    return Path(str(_folder()))


def path(name: str) -> Path:
    """Return the file of a sample or guide. Raises as `text`."""
    return Path(str(_find(name)))


def _find(name: str) -> Traversable:
    """Return the file of a sample or guide, named with or without its suffix."""
    files = _files()
    stem = next((name.removesuffix(s) for s in (*SAMPLE_SUFFIXES, *GUIDE_SUFFIXES) if name.endswith(s)), name)
    if stem in files and name in (stem, files[stem].name):
        return files[stem]
    close = difflib.get_close_matches(stem, list(files), n=1, cutoff=0.55)
    hint = f'did you mean "{close[0]}"?' if close else "gearmesh sample lists them"
    raise ArgumentError("name", name, shown=f'"{name}"', reason=f"no sample has this name; {hint}")


def _files() -> dict[str, Traversable]:
    entries = [
        *(entry for entry in _folder().iterdir() if entry.name.endswith(SAMPLE_SUFFIXES)),
        *(entry for entry in (_folder() / "trains").iterdir() if entry.name.endswith(SAMPLE_SUFFIXES)),
        *(entry for entry in (_folder() / "guides").iterdir() if entry.name.endswith(GUIDE_SUFFIXES)),
    ]
    return {entry.name.rpartition(".")[0]: entry for entry in entries if entry.name != "README.md"}


def _folder() -> Traversable:
    package = resources.files("gearmesh")
    inside = package / "sample_files"
    return inside if inside.is_dir() else package / ".." / "samples"
