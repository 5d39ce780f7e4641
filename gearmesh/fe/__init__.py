"""Finite-element models: teeth in mesh, decks, CalculiX, results.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "ccx": ("program",),
        "gear_model": (
            "OVER",
            "GearModel",
            "Request",
            "grid_of",
            "member_mesh",
        ),
        "model": (
            "ContactPair",
            "Model",
            "NodeForces",
            "RigidTie",
            "Support",
        ),
        "placing": (
            "PlacedPair",
            "focus_on",
            "major_axis",
            "minor_axis",
            "placed",
        ),
        "results": (
            "ContactFigures",
            "ContactTotal",
            "NodalSolution",
            "Reference",
            "contact_figures",
            "largest_principal",
            "principal_stresses",
        ),
    },
)
