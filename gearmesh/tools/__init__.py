"""Tool surfaces: rack, head cutter, shaper, disk, worm, and their tip roundings.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "disk": ("Disk",),
        "head_cutter": (
            "Blade",
            "INSIDE",
            "OUTSIDE",
            "Revolved",
        ),
        "rack": (
            "Arc",
            "Line",
            "Parabola",
            "Profile",
            "RackSurface",
        ),
        "shaper": ("Shaper",),
        "worm": ("Worm",),
    },
)
