"""The samples that come with the package: design files, scripts that compute a figure from some of them, guides and notebooks.

In a checkout and in an editable install they are the folder `samples` beside the package; the wheel carries them inside it,
as `sample_files` (see pyproject.toml), without the pictures of guides.
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

#: What a sample can be: a design or a script.
SUFFIXES = (".toml", ".py")
#: What a guide can be: a text with commands and programs, or a notebook.
GUIDES = (".md", ".ipynb")
#: names of other files in a design
_NAMED = re.compile(r'^\w+ = "([\w-]+\.csv)"', re.MULTILINE)


def names() -> list[str]:
    """All samples in alphabetical order, by file name without the suffix: "spur", "fig9_beveloid_ellipse"."""
    return sorted(name for name, file in _files().items() if file.name.endswith(SUFFIXES))


def guides() -> list[str]:
    """All guides in their order, then all notebooks, by file name without the suffix: "01-spur-pair", "gears-in-3d"."""
    return sorted(name for name, file in _files().items() if file.name.endswith(GUIDES))


def text(name: str) -> str:
    """What is in a sample or a guide. Raises DesignError, with the name that is nearest, for one that does not exist."""
    return _find(name).read_text(encoding="utf-8")


def headline(name: str) -> str:
    """What a sample is, in a few words: its comment or docstring up to the first colon or end of a sentence, or a guide's title."""
    lines = text(name).splitlines()
    file = _find(name).name
    if file.endswith(".ipynb"):
        lines = "".join(json.loads("\n".join(lines))["cells"][0]["source"]).splitlines()
    if file.endswith(GUIDES):
        return lines[0].removeprefix("# ")
    if file.endswith(".py"):
        opening = ast.get_docstring(ast.parse("\n".join(lines))) or ""
    else:
        comment = [line.lstrip("# ") if line.startswith("#") else "" for line in lines]
        opening = "\n".join(comment[: comment.index("")] if "" in comment else comment)
    return re.split(r"[.:] |(?<=[?]) ", " ".join(opening.partition("\n\n")[0].split()))[0].rstrip(".")


def copy(name: str, folder: str | Path) -> Path:
    """Write a sample or a guide into an existing folder, with the files that it names, and say where it is; the scripts want
    their designs beside them, guides copy what they use themselves.

    Raises DesignError for a sample that does not exist, OutputError for a file that is there already or cannot be written.
    """
    from gearmesh.io.atomic import whole_text

    sample = _find(name)
    named = sorted(set(_NAMED.findall(text(name)))) if sample.name.endswith(SUFFIXES[0]) else []
    targets = {Path(folder) / file: _folder().joinpath(file) for file in named}
    targets = {Path(folder) / sample.name: sample, **targets}
    for target in targets:
        if target.exists():
            raise OutputError("cannot write", target, reason="it exists already")
    for target, source in reversed(targets.items()):
        whole_text(target, source.read_text(encoding="utf-8"))
    return Path(folder) / sample.name


def _find(name: str) -> Traversable:
    """The file of a sample or guide, named with or without its suffix."""
    files = _files()
    stem = next((name.removesuffix(s) for s in (*SUFFIXES, *GUIDES) if name.endswith(s)), name)
    if stem in files and name in (stem, files[stem].name):
        return files[stem]
    close = difflib.get_close_matches(stem, list(files), n=1, cutoff=0.55)
    hint = f'did you mean "{close[0]}"?' if close else "gearmesh sample lists them"
    raise ArgumentError("name", name, shown=f'"{name}"', reason=f"no sample has this name; {hint}")


def _files() -> dict[str, Traversable]:
    entries = [
        *(entry for entry in _folder().iterdir() if entry.name.endswith(SUFFIXES)),
        *(entry for entry in (_folder() / "guides").iterdir() if entry.name.endswith(GUIDES)),
    ]
    return {entry.name.rpartition(".")[0]: entry for entry in entries if entry.name != "README.md"}


def _folder() -> Traversable:
    package = resources.files("gearmesh")
    inside = package / "sample_files"
    return inside if inside.is_dir() else package / ".." / "samples"
