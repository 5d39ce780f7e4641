"""Several solids as one body: the union of parts that touch or overlap, with the names of their faces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gearmesh.cad.occ import collection, solids_in
from gearmesh.cad.step import Part, faces_after
from gearmesh.errors import DesignError


def joined_part(parts: Sequence[Part], name: str) -> Part:
    """Return the union of parts in one frame; faces are named "part face", as "first.gear flank_left_1".

    Raises DesignError if OpenCASCADE makes no single valid solid of them.
    """
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Fuse
    from OCP.BRepCheck import BRepCheck_Analyzer

    lists = [collection("List_TopoDS_Shape")() for _ in range(2)]
    for number, part in enumerate(parts):
        lists[min(number, 1)].Append(part.solid)
    fuse = BRepAlgoAPI_Fuse()
    fuse.SetArguments(lists[0])
    fuse.SetTools(lists[1])
    fuse.Build()
    solids = solids_in(fuse.Shape())
    if len(solids) != 1 or not BRepCheck_Analyzer(solids[0]).IsValid():
        raise DesignError(
            name,
            reason=f"{', '.join(part.name for part in parts)} make {len(solids)} bodies, or none that is valid",
            allowed="members that touch or overlap: longer hubs or shafts, or nearer positions",
        )
    sources = (replace(face, name=f"{part.name} {face.name}") for part in parts for face in part.faces)
    regions = tuple(dict.fromkeys(region for part in parts for region in part.regions))
    return Part(name, solids[0], faces_after(fuse, solids[0], tuple(sources)), regions)
