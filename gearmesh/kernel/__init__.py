"""Mathematics without gears: frames, motions, what a surface is, envelopes, curvature, root finders.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "algebra": (
            "AXIS",
            "Array",
            "cross",
            "dot",
            "plane_cross",
            "polar_angle",
            "rotation_about",
            "turn",
            "unit",
        ),
        "barrel": ("Barrel",),
        "chain": (
            "Chain",
            "Step",
        ),
        "course": (
            "TURNING",
            "Course",
            "Sliding",
            "Turning",
        ),
        "curvature": (
            "contact_ellipse",
            "gaussian_curvature",
            "in_plane",
            "principal",
            "relative_curvature",
            "shape_operator",
            "tangent_basis",
        ),
        "envelope": ("Envelope",),
        "feed_envelope": ("FeedEnvelope",),
        "feed_motion": ("FeedMotion",),
        "flat": (
            "FlatLevel",
            "FlatSurface",
        ),
        "levels": (
            "ConeLevel",
            "ConeSurface",
            "Level",
            "PlaneLevel",
            "Shifted",
            "station_normal",
        ),
        "limiting_line": (
            "GeneratedSurface",
            "area_density",
            "singular_at",
            "zeros",
        ),
        "motion": ("MotionState",),
        "nearest": ("tangential",),
        "newton": ("solve",),
        "rigid": ("Rigid",),
        "rolling": (
            "CradleRoll",
            "RackRoll",
        ),
        "roots": (
            "bracketed_root",
            "last_true",
        ),
        "screw_involute": (
            "Amount",
            "AmountJet",
            "ScrewInvolute",
        ),
        "stations": (
            "TrimError",
            "along",
            "followed",
        ),
        "surface": (
            "Jet",
            "PlacedSurface",
            "Surface",
            "area_normal",
        ),
        "twisted": ("Twisted",),
    },
)
