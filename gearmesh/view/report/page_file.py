"""Scripts, styles and parts of pages, which the report page and the local page share."""

from __future__ import annotations

from importlib.resources import files


def page_file(name: str) -> str:
    """Return a text of this folder."""
    return (files(__package__) / name).read_text(encoding="utf-8")
