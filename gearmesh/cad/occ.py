"""Elementary OpenCASCADE shapes from arrays in mm: points, edges, wires, faces, splines.

Vertices and control points of splines are rounded to the grid of CAD solids (`io/digits.py`) here, before they are moved. Last
digits differ between processors; rounded like this they are in none of the copies of a tooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from io import BytesIO
from typing import Any

import numpy as np

from gearmesh.cad.nodes import SPLINE_DEGREE
from gearmesh.errors import DesignError
from gearmesh.io.digits import points_on_grid
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array

#: default tolerance of edges and vertices: OpenCASCADE treats closer points as equal
PRECISION_MM = 1e-7

#: modules and names in OpenCASCADE 7 (CadQuery 2.8) of the collections of OpenCASCADE 8
_COLLECTIONS_OF_7 = {
    "Array1_double": ("TColStd", "TColStd_Array1OfReal"),
    "Array1_int": ("TColStd", "TColStd_Array1OfInteger"),
    "Array1_gp_Pnt": ("TColgp", "TColgp_Array1OfPnt"),
    "Array1_gp_Pnt2d": ("TColgp", "TColgp_Array1OfPnt2d"),
    "Array2_gp_Pnt": ("TColgp", "TColgp_Array2OfPnt"),
    "List_TopoDS_Shape": ("TopTools", "TopTools_ListOfShape"),
    "IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher": ("TopTools", "TopTools_IndexedMapOfShape"),
}


def point(r: Sequence[float] | Array) -> Any:
    """gp_Pnt of a point (3,), mm."""
    from OCP.gp import gp_Pnt

    return gp_Pnt(float(r[0]), float(r[1]), float(r[2]))


def vertex(r: Sequence[float] | Array, move: Any = None) -> Any:
    """TopoDS_Vertex at a point (3,), mm, moved by the gp_Trsf `move`, as curves and surfaces are."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex

    at = point(points_on_grid(np.asarray(r)))
    return BRepBuilderAPI_MakeVertex(at if move is None else at.Transformed(move)).Vertex()


def edge(curve: Any, start: Any, end: Any, first: float, last: float) -> Any:
    """TopoDS_Edge on a curve between its parameters `first` and `last`, where the vertices lie."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

    made = BRepBuilderAPI_MakeEdge(curve, start, end, first, last)
    if not made.IsDone():
        raise DesignError(
            "solid", reason=f"one of its edges cannot be made ({made.Error().name}); choose a larger tolerance"
        )
    return made.Edge()


def point_edge(at: Any, last: float) -> Any:
    """TopoDS_Edge without length at a vertex, for a side of a surface that is a point; its parameter goes from 0 to `last`."""
    from OCP.BRep import BRep_Builder
    from OCP.TopAbs import TopAbs_Orientation
    from OCP.TopoDS import TopoDS_Edge

    builder, made = BRep_Builder(), TopoDS_Edge()
    builder.MakeEdge(made)
    builder.Degenerated(made, True)
    builder.Add(made, at.Oriented(TopAbs_Orientation.TopAbs_FORWARD))
    builder.Add(made, at.Oriented(TopAbs_Orientation.TopAbs_REVERSED))
    builder.Range(made, 0.0, last)
    return made


def straight_edge(start: Any, end: Any) -> Any:
    """TopoDS_Edge on the line between two vertices; its parameter is the length from the first."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge

    return BRepBuilderAPI_MakeEdge(start, end).Edge()


def wire(*parts: tuple[Any, bool]) -> Any:
    """TopoDS_Wire of (edge, forward) in order."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Wire

    builder, made = BRep_Builder(), TopoDS_Wire()
    builder.MakeWire(made)
    for edge, forward in parts:
        builder.Add(made, edge if forward else edge.Reversed())
    made.Closed(True)
    return made


def face(surface: Any, wires: Sequence[Any], outward: bool) -> Any:
    """TopoDS_Face with counterclockwise wires (holes clockwise) on the surface, reversed if not `outward`."""
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Face

    builder, made = BRep_Builder(), TopoDS_Face()
    builder.MakeFace(made, surface, PRECISION_MM)
    for wire in wires:
        builder.Add(made, wire)
    if not outward:
        made.Reverse()
    return made


def frame(origin: Sequence[float], axis: float, angle: float) -> Any:
    """gp_Ax3 with z along `axis` (+1 or -1) and x at a polar angle (rad)."""
    from OCP.gp import gp_Ax3, gp_Dir

    return gp_Ax3(point(origin), gp_Dir(0.0, 0.0, axis), gp_Dir(float(np.cos(angle)), float(np.sin(angle)), 0.0))


def location(place: Rigid) -> Any:
    """TopLoc_Location that takes a shape from its own frame to another."""
    from OCP.TopLoc import TopLoc_Location

    return TopLoc_Location(transformation(place))


def transformation(place: Rigid) -> Any:
    """gp_Trsf that takes curves and surfaces from their own frame to another."""
    from OCP.gp import gp_Trsf

    made = gp_Trsf()
    rows = [(*map(float, row), float(x)) for row, x in zip(place.rotation, place.translation, strict=True)]
    made.SetValues(*(value for row in rows for value in row))
    return made


def spline_curve(control: Array, knots: Array) -> Any:
    """Geom_BSplineCurve from a control polygon (K, 3) and its clamped knot vector."""
    from OCP.Geom import Geom_BSplineCurve

    poles = collection("Array1_gp_Pnt")(1, len(control))
    for i, r in enumerate(points_on_grid(control).tolist()):
        poles.SetValue(i + 1, point(r))
    return Geom_BSplineCurve(poles, *_knots(knots), len(knots) - len(control) - 1)


def translation(way: Array) -> Any:
    """gp_Trsf that moves by `way` (3,), mm."""
    from OCP.gp import gp_Trsf, gp_Vec

    made = gp_Trsf()
    made.SetTranslation(gp_Vec(*way.tolist()))
    return made


def spline_curve2d(control: Array, knots: Array) -> Any:
    """Geom2d_BSplineCurve from a control polygon (K, 2) and its knot vector."""
    from OCP.Geom2d import Geom2d_BSplineCurve
    from OCP.gp import gp_Pnt2d

    poles = collection("Array1_gp_Pnt2d")(1, len(control))
    for i, (u, v) in enumerate(control.tolist()):
        poles.SetValue(i + 1, gp_Pnt2d(u, v))
    return Geom2d_BSplineCurve(poles, *_knots(knots), SPLINE_DEGREE)


def straight2d(start: tuple[float, float], direction: tuple[float, float]) -> Any:
    """Geom2d_Line from a point; its parameter is the length from this point."""
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Dir2d, gp_Pnt2d

    return Geom2d_Line(gp_Pnt2d(*start), gp_Dir2d(*direction))


def spline_surface(control: Array, s_knots: Array, t_knots: Array) -> Any:
    """Geom_BSplineSurface from a control net (S, T, 3) and its knot vectors."""
    from OCP.Geom import Geom_BSplineSurface

    poles = collection("Array2_gp_Pnt")(1, control.shape[0], 1, control.shape[1])
    for i, row in enumerate(points_on_grid(control).tolist()):
        for j, r in enumerate(row):
            poles.SetValue(i + 1, j + 1, point(r))
    (s, s_counts), (t, t_counts) = _knots(s_knots), _knots(t_knots)
    degrees = (len(knots) - size - 1 for knots, size in zip((s_knots, t_knots), control.shape, strict=False))
    return Geom_BSplineSurface(poles, s, t, s_counts, t_counts, *degrees)


def _knots(knots: Array) -> tuple[Any, Any]:
    """Return the different knots and their multiplicities."""
    values, counts = np.unique(knots, return_counts=True)
    different, often = (collection(name)(1, values.size) for name in ("Array1_double", "Array1_int"))
    for i, (value, count) in enumerate(zip(values.tolist(), counts.tolist(), strict=True)):
        different.SetValue(i + 1, value)
        often.SetValue(i + 1, count)
    return different, often


def mapped_shapes(shape: Any, kind: str) -> Any:
    """Map of the solids or faces (`kind` "SOLID" or "FACE") of a shape, each once, in their order in the shape.

    `FindKey` and `FindIndex` count from 1.
    """
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp

    parts = collection("IndexedMap_TopoDS_Shape_TopTools_ShapeMapHasher")()
    TopExp.MapShapes_s(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}"), parts)
    return parts


def solids_in(shape: Any) -> list[Any]:
    """Return the solids of a shape, each once."""
    parts = mapped_shapes(shape, "SOLID")
    return [parts.FindKey(k) for k in range(1, parts.Extent() + 1)]


def collection(name: str) -> Any:
    """Return a collection class of OpenCASCADE by its name in OpenCASCADE 8."""
    try:
        return getattr(import_module("OCP.collections"), name)
    except ModuleNotFoundError:
        module, own_name = _COLLECTIONS_OF_7[name]
        return getattr(import_module(f"OCP.{module}"), own_name)


def shapes_as_bytes(shapes: Sequence[Any]) -> bytes:
    """Return shapes as bytes for `shapes_from_bytes`; what they share is stored once."""
    from OCP.BinTools import BinTools
    from OCP.BRep import BRep_Builder
    from OCP.TopoDS import TopoDS_Compound

    builder, whole, stream = BRep_Builder(), TopoDS_Compound(), BytesIO()
    builder.MakeCompound(whole)
    for shape in shapes:
        builder.Add(whole, shape)
    BinTools.Write_s(whole, stream)
    return stream.getvalue()


def shapes_from_bytes(content: bytes) -> list[Any]:
    """Return the shapes of bytes, which share with each other what they shared."""
    from OCP.BinTools import BinTools
    from OCP.TopoDS import TopoDS_Iterator, TopoDS_Shape

    whole, shapes = TopoDS_Shape(), []
    BinTools.Read_s(whole, BytesIO(content))
    children = TopoDS_Iterator(whole)
    while children.More():
        shapes.append(children.Value())
        children.Next()
    return shapes
