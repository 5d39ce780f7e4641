"""Teeth from their surfaces, trimmed; members, how they stand, and which of them mesh.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "blank": ("Blank",),
        "body": (
            "Body",
            "Disc",
            "end_regions",
        ),
        "flank_frame": ("FlankFrame",),
        "limits": (
            "MemberLimits",
            "SideLimits",
            "cutter",
            "fewest_teeth",
            "land_of_width",
            "member_limits",
            "pitch_height",
            "pointed_station",
            "undercut_station",
        ),
        "mount": ("Mount",),
        "region": (
            "BAR_REGIONS",
            "BODY_REGIONS",
            "EDGES",
            "FILLETS",
            "FLANKS",
            "Region",
            "Side",
        ),
        "section": (
            "GeneratedLink",
            "Grid",
            "Sections",
        ),
        "tip_edge": ("TipEdge",),
        "tooth": ("Tooth",),
        "tooth_side": (
            "Crest",
            "ToothSide",
        ),
        "train": (
            "Boss",
            "Drilling",
            "GearPair",
            "Member",
            "Slot",
            "SourceParameters",
            "Train",
        ),
    },
)
