"""Involute splines: shaft and hub on one axis [DIN 5480, ISO 4156, ANSI B92.1]."""

from gearmesh.systems.cylindrical.spline.build import ASSEMBLY_DISPLACEMENTS, build, derived_values, pinned_values
from gearmesh.systems.cylindrical.spline.design import SplineDesign
from gearmesh.systems.cylindrical.spline.sheet import DRAWN_ROWS, spline_sheet
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "spline",
        SplineDesign,
        build,
        derive=derived_values,
        sheet=spline_sheet,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=pinned_values,
        drawn=DRAWN_ROWS,
    ),
)
