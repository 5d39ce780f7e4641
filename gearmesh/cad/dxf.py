"""DXF files of sections in mm, with a layer for every kind of contour.

The entities are ARC, CIRCLE, LINE and SPLINE, or a closed LWPOLYLINE round each contour with its arcs as bulges.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from io import StringIO
from typing import Any

import numpy as np

from gearmesh.cad.contours.curves import Contour, PlaneSpline
from gearmesh.cad.programs.requirements import require
from gearmesh.cad.section import MemberSection
from gearmesh.formats import DEFAULT_DXF_VERSION, DXF_VERSION_WITHOUT_SPLINES
from gearmesh.io.atomic import PathLike, whole_file
from gearmesh.io.digits import angle_on_grid, curve_on_grid
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve

#: name of the line type of axes
AXIS_LINE = "CENTER"
#: length of its pattern, then dashes and (negative) gaps, mm
AXIS_LINE_PATTERN = (12.0, 8.0, -1.5, 1.0, -1.5)


def require_ezdxf() -> None:
    """Raise OutputError with the package to install if ezdxf cannot be loaded."""
    require("ezdxf", "DXF needs ezdxf", "cad")


def write_dxf(
    section: MemberSection, path: PathLike, description: str, joined: bool = False, version: str = DEFAULT_DXF_VERSION
) -> None:
    """Write the contours of a section, curve by curve, on layers named after member and contour.

    `description` is a comment at the beginning, `version` one of DXF_VERSIONS. `joined` contours consist of arcs and lines,
    and each becomes one polyline.
    Raises OutputError for a file that cannot be written, and without ezdxf.
    """
    require_ezdxf()
    from ezdxf import units
    from ezdxf.filemanagement import new

    with _without_dates():
        document = new(version)
        if version != DXF_VERSION_WITHOUT_SPLINES:
            document.units = units.MM
        space, reach = document.modelspace(), float(curve_on_grid(np.asarray(section.reach)))
        space.reset_extents((-reach, -reach, 0.0), (reach, reach, 0.0))
        for layer, contour in zip(section.layers, section.contours, strict=True):
            if layer not in document.layers:
                document.layers.add(layer)
            if joined:
                _add_joined(space, contour, layer)
                continue
            for curve in contour.curves:
                _add(space, curve, layer)
        if section.axis is not None:
            document.linetypes.add(AXIS_LINE, AXIS_LINE_PATTERN, description="long dash, dot")
            document.layers.add(section.axis_layer, linetype=AXIS_LINE)
            _add(space, section.axis, section.axis_layer)
        stream = StringIO()
        document.write(stream)
    text = f"999\n{description}\n{stream.getvalue()}"
    with whole_file(path) as temporary:
        temporary.write_bytes(text.encode(document.output_encoding, errors="replace"))


def _add(space: Any, curve: PlaneCurve, layer: str) -> None:
    attributes = {"layer": layer}
    if isinstance(curve, PlaneSpline):
        spline = space.add_spline(dxfattribs={**attributes, "degree": 3})
        spline.control_points = np.column_stack((curve_on_grid(curve.control), np.zeros(len(curve.control))))
        spline.knots = angle_on_grid(curve.knots).tolist()
        return
    if not isinstance(curve, PlaneArc):
        space.add_line(curve_on_grid(curve.start).tolist(), curve_on_grid(curve.end).tolist(), dxfattribs=attributes)
        return
    centre, radius = curve_on_grid(curve.centre).tolist(), float(curve_on_grid(np.asarray(curve.radius)))
    if curve.closed:
        space.add_circle(centre, radius, dxfattribs=attributes)
    else:
        # DXF has counterclockwise arcs only
        first, last = angle_on_grid(np.sort(np.degrees((curve.first, curve.first + curve.width)))).tolist()
        space.add_arc(centre, radius, first, last, dxfattribs=attributes)


def _add_joined(space: Any, contour: Contour, layer: str) -> None:
    first = contour.curves[0]
    if isinstance(first, PlaneArc) and first.closed:
        _add(space, first, layer)
        return
    points = [
        # the bulge is the tangent of a quarter of the arc's angle
        (
            *curve_on_grid(curve.start).tolist(),
            float(angle_on_grid(np.tan(0.25 * np.asarray(curve.width)))) if isinstance(curve, PlaneArc) else 0.0,
        )
        for curve in contour.curves
    ]
    old = space.doc.acad_release == DXF_VERSION_WITHOUT_SPLINES
    add = space.add_polyline2d if old else space.add_lwpolyline
    add(points, format="xyb", close=True, dxfattribs={"layer": layer})


@contextmanager
def _without_dates() -> Iterator[None]:
    """Keep ezdxf from writing the time or a new identifier: the same command writes the same bytes."""
    from ezdxf._options import options

    before = options.write_fixed_meta_data_for_testing
    options.write_fixed_meta_data_for_testing = True
    try:
        yield
    finally:
        options.write_fixed_meta_data_for_testing = before
