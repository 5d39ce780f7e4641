"""Meshes to files and back: `write(mesh, "gear.stl")`, `read("gear.stl")`; the suffix picks the format.

`write_scene` and `read_scene` take several named meshes, `formats` lists what there is, `mesh_in_file` is what a file would
hold of a mesh, and `whole_file`, `whole_text` are for everything else that writes a file. Importing this loads no mesh
or graphics library.
"""

from __future__ import annotations

from gearmesh.io.atomic import whole_file, whole_folder, whole_text

# Importing a format registers it.
from gearmesh.io.meshes import glb, obj, ply, stl, threemf, vtk, vtm  # noqa: F401
from gearmesh.io.registry import Scene, formats, mesh_in_file, read, read_scene, write, write_scene
from gearmesh.io.single import rounding

__all__ = [
    "Scene",
    "formats",
    "mesh_in_file",
    "read",
    "read_scene",
    "rounding",
    "whole_file",
    "whole_folder",
    "whole_text",
    "write",
    "write_scene",
]
