"""Meshes to files and back: `write(mesh, "gear.stl")`, `read("gear.stl")`; the suffix picks the format.

- `write_scene` and `read_scene` take several named meshes.
- `formats` lists the formats.
- `mesh_in_file` returns a mesh with the precision of a format.
- `whole_file` and `whole_text` write any other file.

Importing this package loads no mesh library and no graphics library. The module of a format is loaded when the first file
of that format is written or read.
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

#: module of each name that is not in `registry`
MODULES_BY_NAME = {"formats": "known", "rounding": "single"}


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"module 'gearmesh.io' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"gearmesh.io.{MODULES_BY_NAME.get(name, 'registry')}"), name)
    return value
