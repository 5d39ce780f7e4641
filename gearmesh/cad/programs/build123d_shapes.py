"""Parts and assemblies for build123d: the same OpenCASCADE shapes, in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.cad.occ import location
from gearmesh.cad.programs.requirements import require
from gearmesh.cad.step import Part, PartAssembly

if TYPE_CHECKING:
    import build123d


def require_build123d() -> None:
    """Raise OutputError, naming what to install, where build123d cannot be loaded."""
    require("build123d", "to_build123d needs build123d", "build123d")


def build123d_shape(made: Part | PartAssembly) -> build123d.Solid | build123d.Compound:
    """A part as a Solid in its own frame, open shells as a Compound, or an assembly as a Compound of placed Solids; with names and
    colours.

    What occurs several times has one colour, and one shape in memory. Raises OutputError where build123d is missing.
    """
    require_build123d()
    import build123d

    if isinstance(made, Part):
        kind = build123d.Solid if made.closed else build123d.Compound
        return kind(made.solid, label=made.name)
    solids = [
        build123d.Solid(own.part.solid.Moved(location(own.place)), label=own.name, color=build123d.Color(*colour))
        for own, colour in zip(made.occurrences, made.colours, strict=True)
    ]
    return build123d.Compound(label=made.name, children=solids)
