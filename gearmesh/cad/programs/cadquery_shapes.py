"""Parts and assemblies for CadQuery: the same OpenCASCADE shapes, in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.cad.occ import location
from gearmesh.cad.programs.requirements import require
from gearmesh.cad.step import Part, PartAssembly

if TYPE_CHECKING:
    import cadquery


def require_cadquery() -> None:
    """Raise OutputError with the package to install if CadQuery cannot be loaded."""
    require("cadquery", "to_cadquery needs CadQuery", "cadquery")


def cadquery_shape(made: Part | PartAssembly) -> cadquery.Workplane | cadquery.Assembly:
    """Return a part as a Workplane with its solid or open shells, or an assembly as an Assembly of placed Workplanes.

    Members of an assembly have names and colours. The faces of each region are tagged by its name. Raises OutputError without
    CadQuery.
    """
    require_cadquery()
    import cadquery

    if isinstance(made, Part):
        return _workplane(made)
    workplanes = {id(part): _workplane(part) for part in made.parts}
    assembly = cadquery.Assembly(name=made.name)
    for own, colour in zip(made.occurrences, made.colours, strict=True):
        assembly.add(
            workplanes[id(own.part)],
            name=own.name,
            loc=cadquery.Location(location(own.place)),
            color=cadquery.Color(*colour),
        )
    return assembly


def _workplane(part: Part) -> cadquery.Workplane:
    import cadquery

    workplane = cadquery.Workplane(obj=cadquery.Shape.cast(part.solid))
    regions: dict[str, list[cadquery.Face]] = {}
    for face in part.faces:
        regions.setdefault(str(face.region), []).append(cadquery.Face(face.shape))
    for region, faces in regions.items():
        workplane.newObject(faces).tag(region)
    return workplane
