"""Files that a page saves through its browser: the design, solids, sections, the report."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh.answers.bodies.questions import ModelledGears
from gearmesh.design.rewriting import rewritten
from gearmesh.errors import ArgumentError
from gearmesh.explore.state import Origin
from gearmesh.formats import DXF_SUFFIX, HTML_SUFFIX, STEP_SUFFIX, STL_SUFFIX, THREEMF_SUFFIX, TOML_SUFFIX

if TYPE_CHECKING:
    from gearmesh.answers.contact.contact import Contact

#: suffixes of meshes
MESH_SUFFIXES = (STL_SUFFIX, THREEMF_SUFFIX)
#: suffixes of the files that a page can save
SAVED_SUFFIXES = (TOML_SUFFIX, *MESH_SUFFIXES, STEP_SUFFIX, DXF_SUFFIX, HTML_SUFFIX)
#: name for all members in mesh
ALL_MEMBERS = "all"
#: suffixes of files that hold one member
SINGLE_SUFFIXES = (STL_SUFFIX, DXF_SUFFIX)
#: name of files of designs without a name
DEFAULT_STEM = "design"


def refuse_file(suffix: Any, member: Any) -> None:
    """Raise ArgumentError for a file that a page cannot have."""
    if suffix not in SAVED_SUFFIXES:
        raise ArgumentError("suffix", must_be=f"one of {', '.join(SAVED_SUFFIXES)}")
    if not isinstance(member, str):
        raise ArgumentError("member", must_be=f"the name of a member, or {ALL_MEMBERS}")
    if member == ALL_MEMBERS and suffix in SINGLE_SUFFIXES:
        raise ArgumentError("member", member, reason=f"{suffix} holds one member; choose one, or another format")


def design_file(keys: Mapping[str, Any], origin: Origin) -> bytes:
    """Return the design file of the keys of a page, with the comments of the opened file."""
    return rewritten(origin.text, {**keys, **origin.named}).encode()


def gear_file(gears: ModelledGears, contacts: Mapping[int, Contact], name: str, member: str, source: str) -> bytes:
    """Return a file of gears with a `name`, made as the commands `solid` and `report` make it. Raises GearmeshError."""
    suffix = Path(name).suffix
    if suffix == HTML_SUFFIX:
        from gearmesh.reports.report import report_page

        return report_page(gears, contacts, source=source).html.encode()
    with tempfile.TemporaryDirectory(prefix="gearmesh-explore-") as folder:
        # STEP files hold their name
        target = Path(folder) / name
        if suffix == DXF_SUFFIX:
            gears.section(member).save(target)
        elif suffix == STEP_SUFFIX:
            gears.cad(None if member == ALL_MEMBERS else member).save(target)
        elif member == ALL_MEMBERS:
            gears.solids(file=target).save(target)
        else:
            gears.solid(member, file=target).save(target)
        return target.read_bytes()


def file_name(title: str, member: str, suffix: str) -> str:
    """Return a plain name for a file."""
    words = "".join(letter if letter.isascii() and letter.isalnum() else "_" for letter in title.lower())
    stem = "_".join(word for word in words.split("_") if word)[:60] or DEFAULT_STEM
    return f"{stem}{suffix}" if suffix in (TOML_SUFFIX, HTML_SUFFIX) else f"{stem}_{member}{suffix}"
