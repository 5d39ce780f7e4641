"""Pictures: scenes that are drawn when they are saved or shown."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from gearmesh.errors import OutputError
from gearmesh.view.scene import Scene

#: what a picture of gears can show
VIEWS = ("contact", "pattern", "gap", "pair")


@dataclass(frozen=True, repr=False)
class Picture:
    """A picture of gears; drawing needs off-screen OpenGL."""

    scene: Scene

    def __repr__(self) -> str:
        width, height = self.scene.size
        return f"<Picture: {self.scene.title}, {width} x {height}>"

    def save(self, path: str | PathLike[str]) -> Path:
        """Draw into a .png file, whole or not at all.

        Raises OutputError naming the missing system package where there is no OpenGL, and for another suffix.
        """
        from gearmesh.view.opengl import missing_opengl_message
        from gearmesh.view.render import render

        target = Path(path)
        if target.suffix.lower() != ".png":
            raise OutputError(f"cannot write {target}: its suffix must be .png")
        missing = missing_opengl_message()
        if missing:
            raise OutputError(missing)
        render(self.scene, target)
        return target

    def _repr_png_(self) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            return self.save(Path(folder) / "picture.png").read_bytes()

    def __dir__(self) -> list[Any]:
        return ["save", "scene"]
