"""Pictures and figures that are drawn when they are saved or shown."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from os import PathLike
from pathlib import Path
from typing import Any

from gearmesh.errors import ArgumentError, OutputError
from gearmesh.formats import DIAGRAM_SUFFIXES, GIF_SUFFIX, MP4_SUFFIX, PNG_SUFFIX, refuse_suffix
from gearmesh.io.atomic import scratch_folder
from gearmesh.records import dataclass
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
#: views that show all members of a mesh
VIEWS_OF_ALL_MEMBERS = ("pair", "section", "zone", "te", "backlash", "turns", *LOADED_VIEWS[2:])


def refuse_member(view: str, member: str | None) -> None:
    """Raise ArgumentError for a member in a view that shows all."""
    if member is not None and view in VIEWS_OF_ALL_MEMBERS:
        raise ArgumentError("member", member, reason=f"the view {view} shows all members; leave member out")


class Saved(ABC):
    """A picture, drawing or page that is drawn when it is saved, with the same bytes every time."""

    @property
    @abstractmethod
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""

    def save(self, path: str | PathLike[str]) -> Path:
        """Write to a file, whole or not at all; the suffix is the format.

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
            If the suffix is not one of `suffixes`, if the file cannot be written, and if something that draws it is missing: OpenGL
            for pictures and animations, the program ffmpeg for .mp4.

        Examples
        --------
        >>> gears.picture("te").save("te.svg").name
        'te.svg'
        """
        target = Path(path)
        refuse_suffix(target, *self.suffixes)
        self._write(target)
        return target

    @abstractmethod
    def _write(self, target: Path) -> None:
        """Draw into a file with one of the suffixes."""

    def __dir__(self) -> list[Any]:
        return [name for name in super().__dir__() if not str(name).startswith("_")]


class SavedPicture(Saved):
    """A picture or drawing that notebooks show."""

    def _repr_png_(self) -> bytes:
        return saved_bytes(self, PNG_SUFFIX)


def saved_bytes(saved: Saved, suffix: str) -> bytes:
    """Return the bytes of the file that is saved with a suffix."""
    with scratch_folder() as folder:
        return saved.save(folder / f"saved{suffix}").read_bytes()


@dataclass(frozen=True, repr=False)
class Picture(SavedPicture):
    """A picture of gears; drawing needs off-screen OpenGL."""

    _scene: Scene

    def __repr__(self) -> str:
        width, height = self._scene.size
        return f"<Picture: {self._scene.title}, {width} x {height}>"

    @property
    def suffixes(self) -> tuple[str, ...]:
        return (PNG_SUFFIX,)

    def _write(self, target: Path) -> None:
        from gearmesh.view.opengl import missing_opengl_message
        from gearmesh.view.render import render

        missing = missing_opengl_message()
        if missing:
            raise OutputError(reason=missing)
        render(self._scene, target)


@dataclass(frozen=True, repr=False)
class Diagram(SavedPicture):
    """A figure on paper with its `title`; it needs no OpenGL. `draw` writes it to a file."""

    title: str
    draw: Callable[[Path], None]
    #: True if the figure is made of pixels
    _pixels: bool = False

    def __repr__(self) -> str:
        return f"<Diagram: {self.title}>"

    @property
    def suffixes(self) -> tuple[str, ...]:
        return (PNG_SUFFIX,) if self._pixels else DIAGRAM_SUFFIXES

    def _write(self, target: Path) -> None:
        self.draw(target)


@dataclass(frozen=True, repr=False)
class Animation(Saved):
    """Gears that roll through one pitch, or contact that rolls over a tooth, over and over.

    Drawing needs off-screen OpenGL.
    """

    _scenes: tuple[Scene, ...]
    #: True if the last picture is shown for longer
    _hold: bool = False

    def __repr__(self) -> str:
        return f"<Animation: {self._scenes[0].title}, {len(self._scenes)} pictures>"

    @property
    def suffixes(self) -> tuple[str, ...]:
        return (GIF_SUFFIX, MP4_SUFFIX)

    def _write(self, target: Path) -> None:
        from gearmesh.view.animation import write_animation

        write_animation(target, list(self._scenes), hold=self._hold)
