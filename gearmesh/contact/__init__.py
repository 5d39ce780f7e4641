"""Where two teeth touch: starts, conditions, path, mesh cycle, Hertz pressure.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "cycle": (
            "Cycle",
            "mesh_cycle",
        ),
        "flanks": (
            "PathHertz",
            "analyse",
            "contact_flank",
            "hertz_path",
            "separation_curvatures",
            "solver_pair",
        ),
        "hertz": (
            "Material",
            "PointContact",
            "STEEL",
            "contact_modulus",
            "line_contact",
            "normal_force",
            "point_contact",
        ),
        "meshing": (
            "Conditions",
            "Flank",
        ),
        "path": (
            "ARCSEC",
            "ContactPath",
        ),
        "pair": ("Pair",),
        "tca": ("contact_path",),
    },
)
