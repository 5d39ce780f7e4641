"""Pictures and figures that are drawn when they are saved or shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from gearmesh.errors import OutputError
from gearmesh.formats import PNG_SUFFIX
from gearmesh.io.atomic import scratch_folder
from gearmesh.view.scene import Scene

#: smallest side of a picture
MIN_SIDE_PIXELS = 16
#: largest side of a picture
MAX_SIDE_PIXELS = 16384
#: views of gears that are figures on paper
FIGURE_VIEWS = ("flank", "sliding", "zone", "te", "backlash", "turns")
#: views of gears that a picture can show
PICTURE_VIEWS = ("contact", "pattern", "gap", "pair", "section", "tool", "contact_lines", *FIGURE_VIEWS)
#: look of a picture with lines and colours that tell quantities
PLAIN_LOOK = "plain"
#: look of a painted tooth from which contact has rubbed the marking compound
COMPOUND_LOOK = "compound"
#: looks of pictures
PICTURE_LOOKS = (PLAIN_LOOK, COMPOUND_LOOK)
#: views that can be seen with marking compound
COMPOUND_VIEWS = ("pattern", "gap")
#: views that an animation can show
MOVING_VIEWS = ("section", "pair", "contact", "pattern")
#: what pictures of loaded contact show; all but the first are figures on paper
LOADED_VIEWS = ("loaded", "loaded_flank", "loaded_te", "loaded_share", "loaded_stress", "loaded_pair")


def saved_bytes(save: Callable[[Path], Path], name: str) -> bytes:
    """Return the bytes that `save` writes to a file of this name."""
    with scratch_folder() as folder:
        return save(folder / name).read_bytes()


@dataclass(frozen=True, repr=False)
class Picture:
    """A picture of gears; drawing needs off-screen OpenGL."""

    _scene: Scene

    def __repr__(self) -> str:
        width, height = self._scene.size
        return f"<Picture: {self._scene.title}, {width} x {height}>"

    def save(self, path: str | PathLike[str]) -> Path:
        """Draw into a .png file, whole or not at all.

        Parameters
        ----------
        path : str or os.PathLike
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        OutputError
            Naming the missing system package where there is no OpenGL, and for another suffix.

        Examples
        --------
        >>> gears.picture("pair", size=(160, 120)).save("pair.png").name
        'pair.png'
        """
        from gearmesh.view.opengl import missing_opengl_message
        from gearmesh.view.render import render

        target = Path(path)
        if target.suffix.lower() != PNG_SUFFIX:
            raise OutputError("cannot write", target, reason="its suffix must be .png")
        missing = missing_opengl_message()
        if missing:
            raise OutputError(reason=missing)
        render(self._scene, target)
        return target

    def _repr_png_(self) -> bytes:
        return saved_bytes(self.save, "picture.png")

    def __dir__(self) -> list[Any]:
        return ["save"]


@dataclass(frozen=True, repr=False)
class Diagram:
    """A figure on paper with its `title`; it needs no OpenGL. `draw` writes it to a file."""

    title: str
    draw: Callable[[Path], None]

    def __repr__(self) -> str:
        return f"<Diagram: {self.title}>"

    def save(self, path: str | PathLike[str]) -> Path:
        """Draw into a .png, .svg or .pdf file, whole or not at all.

        Parameters
        ----------
        path : str or os.PathLike
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        OutputError
            For another suffix.

        Examples
        --------
        >>> gears.picture("te").save("te.svg").name
        'te.svg'
        """
        self.draw(Path(path))
        return Path(path)

    def _repr_png_(self) -> bytes:
        return saved_bytes(self.save, "diagram.png")

    def __dir__(self) -> list[Any]:
        return ["save", "title"]


@dataclass(frozen=True, repr=False)
class Animation:
    """Gears that roll through one pitch, or contact that rolls over a tooth, over and over.

    Drawing needs off-screen OpenGL.
    """

    _scenes: tuple[Scene, ...]
    #: True if the last picture is shown for longer
    _hold: bool = False

    def __repr__(self) -> str:
        return f"<Animation: {self._scenes[0].title}, {len(self._scenes)} pictures>"

    def save(self, path: str | PathLike[str]) -> Path:
        """Draw into a .gif or .mp4 file, whole or not at all. The program ffmpeg writes .mp4.

        Parameters
        ----------
        path : str or os.PathLike
            The file.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        OutputError
            For another suffix, where there is no OpenGL, or no ffmpeg for .mp4.

        Examples
        --------
        >>> gears.animation(size=(160, 120)).save("mesh.gif").name
        'mesh.gif'
        """
        from gearmesh.view.animation import write_animation

        write_animation(Path(path), list(self._scenes), hold=self._hold)
        return Path(path)

    def __dir__(self) -> list[Any]:
        return ["save"]
