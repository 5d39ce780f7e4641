"""Triangles to a tolerance, closed solids, hexahedra.

What other packages and the tests use of it is listed here, by module, and loaded when it is asked for.
"""

from gearmesh.front import front_door

__all__, __getattr__, __dir__ = front_door(
    __name__,
    {
        "grading": ("Spacing",),
        "hex_quality": (
            "scaled_jacobian",
            "volumes",
        ),
        "hexahedra": (
            "Cells",
            "Focus",
            "HexGrid",
            "focused_grid",
            "hex_mesh",
            "plain_grid",
            "rim_of",
        ),
        "hexes": (
            "HEX_EDGES",
            "HEX_FACES",
            "HexMesh",
            "joined",
        ),
        "solid": (
            "gear_solid",
            "prove",
            "teeth_mesh",
        ),
        "patch": ("PatchMesh",),
        "tessellate": ("ToothMesh",),
        "triangles": ("TriangleMesh",),
    },
)
