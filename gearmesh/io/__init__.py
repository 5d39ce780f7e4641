"""Meshes to files and back: `write(mesh, "gear.stl")`, `read("gear.stl")`; the suffix picks the format.

`write_scene` and `read_scene` take several named meshes, `formats` lists what there is, `mesh_in_file` is what a file would
hold of a mesh, and `whole_file`, `whole_text` are for everything else that writes a file. Importing this loads no mesh
or graphics library, and a format once a file of it is written or read: who writes a text needs none.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gearmesh.io.atomic import whole_file, whole_folder, whole_text

if TYPE_CHECKING:
    from gearmesh.io.known import formats
    from gearmesh.io.registry import Scene, mesh_in_file, most_rounding, read, read_scene, write, write_scene
    from gearmesh.io.single import rounding

__all__ = [
    "Scene",
    "formats",
    "mesh_in_file",
    "most_rounding",
    "read",
    "read_scene",
    "rounding",
    "whole_file",
    "whole_folder",
    "whole_text",
    "write",
    "write_scene",
]

#: modules of the names that are not in the registry
HOMES = {"formats": "known", "rounding": "single"}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'gearmesh.io' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"gearmesh.io.{HOMES.get(name, 'registry')}"), name)
    return value
