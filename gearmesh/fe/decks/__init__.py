"""Finite-element models to files: `write_model(model, "pair.inp")`; the suffix, or a name, picks the format."""

from __future__ import annotations

# Importing a format registers it.
from gearmesh.fe.decks import aster, dyna, inp, mapdl, msh, nastran, vtu  # noqa: F401
from gearmesh.fe.decks.registry import DeckFormat, format_of, formats, write_model

__all__ = ["DeckFormat", "format_of", "formats", "write_model"]
