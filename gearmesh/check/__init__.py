"""Meshes against the exact surfaces, and the roll test, of flanks and of whole members, which never sees the solver.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "deviation": (
            "INSIDE",
            "deviations",
            "triangle_distance",
        ),
        "members": (
            "MemberRoll",
            "ToothTouch",
            "roll_flanks",
            "roll_members",
            "roll_teeth",
            "root_clearance",
        ),
        "roll": ("RollContact",),
    },
)
