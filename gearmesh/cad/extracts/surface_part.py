"""Flanks, or all surfaces of some teeth, for CAD: open shells of spline faces without a body.

A shell holds faces that share edges: the smooth parts of one flank, or all faces of a row of teeth.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Any

from gearmesh.cad.brep import SplineTooth
from gearmesh.cad.faces.drawn_face import Sides
from gearmesh.cad.occ import edge, transformation, vertex
from gearmesh.cad.solid_part import LinkCurves, drawn_faces
from gearmesh.cad.step import NamedFace, Part, require_occ
from gearmesh.cad.volume import QUADRATURE_ERROR
from gearmesh.errors import DesignError
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region


def surface_part(
    member: Member, teeth: SplineTooth, count: int, regions: Sequence[Region] | None, rows: Sequence[HalfGear]
) -> Part:
    """Build open shells of the first `count` teeth of some rows of a member.

    With `regions` each flank in these regions is a shell; without regions all surfaces of the teeth of a row are one shell. Faces
    are named as in `solid_part`; normals point out of the material. Raises DesignError for invalid shells, OutputError without
    OpenCASCADE.
    """
    require_occ()
    from OCP.BRepCheck import BRepCheck_Analyzer

    member.check_alike()
    shells = list[list[NamedFace]]()
    for half in rows:
        row = _Row(teeth.place(half), count)
        if regions is None:
            shells.append([face for k in range(count) for i in range(row.links) for face in row.faces(k, i)])
        else:
            links = {region: [i for i, link in enumerate(teeth.links) if link.region is region] for region in regions}
            shells += [[face for i in own for face in row.faces(k, i)] for k in range(count) for own in links.values()]
    made = _compound([_shell(faces) for faces in shells])
    if not BRepCheck_Analyzer(made).IsValid():
        raise DesignError(member.name, reason="the faces do not make valid shells; choose a larger tolerance")
    faces = tuple(face for shell in shells for face in shell)
    return Part(member.name, made, faces, tuple(teeth.tooth.regions if regions is None else regions), closed=False)


def area(part: Part) -> float:
    """Return the area (mm^2) of all faces of a part, by OpenCASCADE."""
    from OCP.BRepGProp import BRepGProp_Domain, BRepGProp_Face, BRepGProp_Sinert
    from OCP.gp import gp_Pnt

    origin, total = gp_Pnt(0.0, 0.0, 0.0), 0.0
    for named in part.faces:
        own = BRepGProp_Sinert(BRepGProp_Face(named.shape), BRepGProp_Domain(named.shape), origin, QUADRATURE_ERROR)
        total += float(own.Mass())
    return total


def _shell(faces: Sequence[NamedFace]) -> Any:
    """TopoDS_Shell of faces that share edges."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Shell

    builder, made = BRep_Builder(), TopoDS_Shell()
    builder.MakeShell(made)
    for named in faces:
        builder.Add(made, named.shape)
    return made


def _compound(shapes: Sequence[Any]) -> Any:
    """TopoDS_Compound of shapes."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    builder, made = BRep_Builder(), TopoDS_Compound()
    builder.MakeCompound(made)
    for shape in shapes:
        builder.Add(made, shape)
    return made


class _Row:
    """Faces of the first teeth of a row, by tooth k from 0 and link i of the chain. Neighbours share vertices and edges."""

    def __init__(self, teeth: SplineTooth, count: int) -> None:
        self.teeth, self.links = teeth, len(teeth.links)
        joint = teeth.tooth.joint
        first = int(joint.places(teeth.count)[0])
        self._moves = [transformation(joint.to((first + k) * teeth.step)) for k in range(count + 1)]
        self._curves, self._drawn = cache(self._link_curves), cache(self._drawn_faces)
        self._corner, self._along, self._across = (
            cache(self._vertex),
            cache(self._edges_along),
            cache(self._edges_across),
        )

    def faces(self, k: int, i: int) -> list[NamedFace]:
        """Return the faces of link i of tooth k, from toe to heel."""
        n = k * self.links + i
        made = []
        for part in self._drawn(i):
            toe, heel = (self._across(n)[row] for row in part.rows)
            span = slice(*part.rows)
            shape = part.face(
                part.surface.Transformed(self._moves[k]),
                Sides(toe, self._along(n + 1)[span], heel, self._along(n)[span]),
            )
            name = f"{part.region}_{k + 1}{self.teeth.half.suffix}"
            made.append(NamedFace(shape, name, part.region, tooth=k + 1))
        return made

    def _link_curves(self, i: int) -> LinkCurves:
        return LinkCurves.of(self.teeth, i)

    def _drawn_faces(self, i: int) -> Any:
        return drawn_faces(self.teeth, i)

    def _vertex(self, n: int, row: int) -> Any:
        k, i = divmod(n, self.links)
        return vertex(self.teeth.corners[i, row], self._moves[k])

    def _edges_along(self, n: int) -> list[Any]:
        k, i = divmod(n, self.links)
        return [
            edge(curve.Transformed(self._moves[k]), self._corner(n, g), self._corner(n, g + 1), 0.0, 1.0)
            for g, curve in enumerate(self._curves(i).along)
        ]

    def _edges_across(self, n: int) -> dict[int, Any]:
        k, i = divmod(n, self.links)
        return {
            row: edge(curve.Transformed(self._moves[k]), self._corner(n, row), self._corner(n + 1, row), 0.0, last)
            for row, (curve, last) in self._curves(i).across.items()
        }
