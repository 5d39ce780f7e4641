"""Parts and assemblies for build123d and CadQuery, which are optional: the same OpenCASCADE shapes, in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearmesh.cad.occ import location
from gearmesh.cad.programs.requirements import require
from gearmesh.cad.step import Part, PartAssembly

if TYPE_CHECKING:
    import build123d
    import cadquery


def require_build123d() -> None:
    """Raise OutputError with the package to install if build123d cannot be loaded."""
    require("build123d", "to_build123d needs build123d", "build123d")


def build123d_shape(made: Part | PartAssembly) -> build123d.Solid | build123d.Compound:
    """Return a part as a Solid in its own frame, open shells as a Compound, or an assembly as a Compound of placed Solids.

    Shapes have names; Solids of an assembly also have colours. Occurrences of one part have the same colour and the same surfaces,
    but separate topologies. Raises OutputError without build123d.
    """
    require_build123d()
    import build123d

    if isinstance(made, Part):
        kind = build123d.Solid if made.closed else build123d.Compound
        return kind(made.solid, label=made.name)
    known, solids = set[int](), []
    for own, colour in zip(made.occurrences, made.colours, strict=True):
        shape = _copy_topology(own.part.solid) if id(own.part) in known else own.part.solid
        known.add(id(own.part))
        placed = shape.Moved(location(own.place))
        solids.append(build123d.Solid(placed, label=own.name, color=build123d.Color(*colour)))
    return build123d.Compound(label=made.name, children=solids)


def _copy_topology(shape: Any) -> Any:
    """TopoDS_Shape with the same curves and surfaces.

    build123d's export_step gives all solids that share a shape the label of the last one (version 0.13.0).
    """
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy

    return BRepBuilderAPI_Copy(shape, False).Shape()


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
