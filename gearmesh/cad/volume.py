"""Volume of a CAD solid: the sum of the volumes between the origin and each of its faces.

The distance of the origin from the tangent planes of a plane or a cone about the z axis is constant. So the volume between the
origin and a face across or about this axis is a third of the height of its plane, or of the apex of its cone, times the area that
its border encloses in the plane of x and y. OpenCASCADE integrates the other faces.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np

from gearmesh.cad.step import Part
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.splines import basis

#: relative error of a face's share of the volume
QUADRATURE_ERROR = 1e-8
#: distance (mm) and sine of an angle from the z axis that are rounding
AXIS_ROUNDING = 1e-12


def volume(part: Part) -> float:
    """Return the volume of a part (mm^3).

    A face with turned copies is integrated once. With its default order of quadrature, OpenCASCADE has an error of 3e-7 on a
    fillet, more than the error of the fillet itself; therefore QUADRATURE_ERROR is given.
    """
    total = 0.0
    for named in part.faces:
        if named.copies:
            known = _below_border(named.shape)
            total += named.copies * (_below(named.shape) if known is None else known)
    return total


def _below(face: Any) -> float:
    """Return the volume (mm^3) between the origin and a face by OpenCASCADE."""
    from OCP.BRepGProp import BRepGProp_Domain, BRepGProp_Face, BRepGProp_Vinert
    from OCP.gp import gp_Pnt

    origin = gp_Pnt(0.0, 0.0, 0.0)
    return float(BRepGProp_Vinert(BRepGProp_Face(face), BRepGProp_Domain(face), origin, QUADRATURE_ERROR).Mass())


def _below_border(face: Any) -> float | None:
    """Return the volume (mm^3) between the origin and a face by its border.

    None for faces other than planes across the z axis and cones about it, and for borders of other curves than lines, circles and
    whole splines.
    """
    height = _height(face)
    area = None if height is None else _enclosed(face)
    return None if height is None or area is None else height * area / 3.0


def _height(face: Any) -> float | None:
    """Return the height z (mm) of a plane across the z axis, or of the apex of a cone about it; None for other faces."""
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType

    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType()
    if kind == GeomAbs_SurfaceType.GeomAbs_Plane:
        plane = surface.Plane()
        direction = plane.Axis().Direction()
        level = max(abs(direction.X()), abs(direction.Y())) <= AXIS_ROUNDING
        return float(plane.Location().Z()) if level else None
    if kind != GeomAbs_SurfaceType.GeomAbs_Cone:
        return None
    cone = surface.Cone()
    apex, direction = cone.Apex(), cone.Axis().Direction()
    off = max(abs(x) for x in (apex.X(), apex.Y(), direction.X(), direction.Y()))
    return float(apex.Z()) if off <= AXIS_ROUNDING else None


def _enclosed(face: Any) -> float | None:
    """Return the area (mm^2) in the plane of x and y that the border of a face encloses, > 0 counterclockwise.

    None for a border with other curves than lines, circles across z, and whole splines.
    """
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GeomAbs import GeomAbs_CurveType
    from OCP.TopAbs import TopAbs_Orientation, TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    area, splines = 0.0, defaultdict[tuple[float, ...], list[tuple[float, list[float]]]](list)
    explorer = TopExp_Explorer(face, TopAbs_ShapeEnum.TopAbs_EDGE)
    while explorer.More():
        border = TopoDS.Edge(explorer.Current())
        explorer.Next()
        if BRep_Tool.Degenerated_s(border):
            continue
        sense = 1.0 if border.Orientation() == TopAbs_Orientation.TopAbs_FORWARD else -1.0
        curve = BRepAdaptor_Curve(border)
        kind, first, last = curve.GetType(), curve.FirstParameter(), curve.LastParameter()
        if kind == GeomAbs_CurveType.GeomAbs_BSplineCurve:
            spline = curve.BSpline()
            if spline.IsRational() or (spline.FirstParameter(), spline.LastParameter()) != (first, last):
                return None
            numbers = range(1, spline.NbKnots() + 1)
            knots = tuple(spline.Knot(k) for k in numbers for _ in range(spline.Multiplicity(k)))
            poles = map(spline.Pole, range(1, spline.NbPoles() + 1))
            splines[knots].append((sense, [x for pole in poles for x in (pole.X(), pole.Y())]))
            continue
        if kind not in (GeomAbs_CurveType.GeomAbs_Line, GeomAbs_CurveType.GeomAbs_Circle):
            return None
        begin, end = curve.Value(first), curve.Value(last)
        if kind == GeomAbs_CurveType.GeomAbs_Line:
            area += 0.5 * sense * (begin.X() * end.Y() - begin.Y() * end.X())
            continue
        circle = curve.Circle()
        centre, upwards = circle.Location(), circle.Axis().Direction().Z()
        if abs(abs(upwards) - 1.0) > AXIS_ROUNDING:
            return None
        beside = centre.X() * (end.Y() - begin.Y()) - centre.Y() * (end.X() - begin.X())
        area += 0.5 * sense * (upwards * circle.Radius() ** 2 * (last - first) + beside)
    return area + sum(_swept(np.array(knots), curves) for knots, curves in splines.items())


def _swept(knots: Array, curves: list[tuple[float, list[float]]]) -> float:
    """Return the area (mm^2) that the radius to splines sweeps, from their senses and their control points (x, y in turn)."""
    senses, control = np.array([sense for sense, _ in curves]), np.array([points for _, points in curves])
    x, y = control[:, ::2], control[:, 1::2]
    degree = len(knots) - x.shape[1] - 1
    # x dy - y dx has twice the degree less one, which as many points as the degree integrate exactly
    nodes, weights = np.polynomial.legendre.leggauss(degree)
    spans = distinct(knots)
    half = 0.5 * np.diff(spans)[:, None]
    places, weights = (spans[:-1, None] + half * (1.0 + nodes)).ravel(), (half * weights).ravel()
    products = basis(knots, degree, places).T @ (weights[:, None] * basis(knots, degree, places, 1))
    return float(0.5 * senses @ (((x @ (products - products.T)) * y).sum(axis=1)))
