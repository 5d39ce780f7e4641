"""Pictures as scenes, the renderer, plots.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "fe_views": (
            "STRESS_SHARE",
            "pressure_scene",
            "stress_scene",
        ),
        "flank_diagrams": (
            "ContactPanel",
            "FieldPanel",
            "beside",
            "contact_panel",
            "plot_flanks",
        ),
        "flank_plane": ("FlankPlane",),
        "on_tooth": (
            "closest_gap",
            "ellipses_on_surface",
            "spread",
            "union_level",
        ),
        "opengl": ("missing_opengl_message",),
        "palette": (
            "COLOUR_MAP",
            "COMPOUND",
            "LINES",
            "PATH",
        ),
        "pattern_matrix": (
            "PatternCell",
            "pattern_cell",
            "plot_matrix",
        ),
        "pictures": ("flank_panel",),
        "plots": (
            "CostRun",
            "plot_cost",
            "plot_curves",
        ),
        "render": (
            "corner_normals",
            "region_edges",
        ),
        "scene": (
            "Camera",
            "MemberContact",
            "Paint",
            "PatternArea",
            "STEEL",
            "Scene",
            "SceneBody",
            "ToothView",
            "contact_on",
        ),
        "views": (
            "framed",
            "gap_scene",
            "member_scene",
            "pair_scene",
            "pattern_scene",
        ),
    },
)
