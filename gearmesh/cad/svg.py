"""SVG files of sections: closed paths of arcs, lines and cubic Bezier curves; one unit is a millimetre."""

from __future__ import annotations

from xml.sax.saxutils import escape

import numpy as np

from gearmesh.cad.contours.curves import Contour, PlaneSpline
from gearmesh.cad.section import MemberSection
from gearmesh.io.atomic import PathLike, whole_text
from gearmesh.io.digits import curve_on_grid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve

#: width of the lines
LINE_WIDTH_MM = 0.1
#: dashes and gaps of a line along the axis, mm
AXIS_DASHES = "8 1.5 1 1.5"
#: margin round the drawing, as a share of its radius
MARGIN_SHARE = 0.02


def write_svg(section: MemberSection, path: PathLike, description: str) -> None:
    """Write a section with a path for each contour, named after member and contour. Raises OutputError."""
    reach = (1.0 + MARGIN_SHARE) * section.reach
    size, corner = _number(2.0 * reach), _number(-reach)
    names = section.layers
    paths = [
        f'<path id="{escape(name)}" d="{_path(contour)}"/>'
        for name, contour in zip(names, section.contours, strict=True)
    ]
    if section.axis is not None:
        ends = f"M {_point(section.axis.start)} L {_point(section.axis.end)}"
        paths.append(f'<path id="{escape(section.axis_layer)}" stroke-dasharray="{AXIS_DASHES}" d="{ends}"/>')
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}mm" height="{size}mm" '
        f'viewBox="{corner} {corner} {size} {size}">',
        f"<title>{escape(section.name)}</title>",
        f"<desc>{escape(description)}</desc>",
        f'<g id="{escape(section.name)}" fill="none" stroke="black" stroke-width="{LINE_WIDTH_MM}">',
        *paths,
        "</g>",
        "</svg>",
    ]
    whole_text(path, "\n".join(lines) + "\n")


def _path(contour: Contour) -> str:
    start = contour.curves[0].start
    return " ".join([f"M {_point(start)}", *(_command(curve) for curve in contour.curves), "Z"])


def _command(curve: PlaneCurve) -> str:
    if isinstance(curve, PlaneSpline):
        return " ".join("C " + " ".join(_point(point) for point in bezier[1:]) for bezier in curve.beziers)
    if not isinstance(curve, PlaneArc):
        return f"L {_point(curve.end)}"
    # SVG draws no arc between equal ends: circles are two halves
    steps = np.linspace(0.0, 1.0, 3 if curve.closed else 2)[1:]
    large, back = int(abs(curve.width) / len(steps) > np.pi), int(curve.width < 0.0)
    radius = _number(curve.radius)
    return " ".join(f"A {radius} {radius} 0 {large} {back} {_point(point)}" for point in curve.at(steps))


def _point(point: Array) -> str:
    """Return the text of a point, with y downwards as in SVG."""
    return f"{_number(point[0])} {_number(-point[1])}"


def _number(value: float) -> str:
    return f"{float(curve_on_grid(np.asarray(value))):.9f}".rstrip("0").rstrip(".")
