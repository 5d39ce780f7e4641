"""Members as CAD solids, of spline faces, planes, cylinders and cones, and their sections: STEP, DXF, SVG.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "brep": (
            "Piece",
            "SplineTooth",
            "TOLERANCE",
            "exact_volume",
            "spline_tooth",
        ),
        "nodes": (
            "planned",
            "samples",
        ),
        "part21": ("condensed",),
        "solid_part": ("volume",),
        "section": (
            "PlaneArc",
            "PlaneCurve",
            "PlaneLine",
            "PlaneSpline",
            "member_section",
        ),
        "step": (
            "Part",
            "SUFFIXES",
            "require_occ",
            "write_step",
        ),
    },
)
