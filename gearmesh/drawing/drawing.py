"""Workshop drawings, painted when they are saved."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from gearmesh.answers.gearset import GearSet
from gearmesh.drawing.gear_data import facts_of
from gearmesh.drawing.page import Page, compose, paint
from gearmesh.drawing.paper import scale_name
from gearmesh.drawing.views import views_of
from gearmesh.errors import OutputError
from gearmesh.formats import DRAWING_SUFFIXES
from gearmesh.view.diagrams.plots import save_figure
from gearmesh.view.picture import saved_bytes


@dataclass(frozen=True, repr=False)
class WorkshopDrawing:
    """A workshop drawing of one member: views with dimensions, table of gear data, title block."""

    member: str
    _page: Page

    def __repr__(self) -> str:
        return f"<Drawing: {self.member}, {self.sheet} at {self.scale}>"

    @property
    def sheet(self) -> str:
        """Size of the paper, "A4" or "A3"."""
        return self._page.paper.name

    @property
    def scale(self) -> str:
        """Scale of the views, as "1:2"."""
        return scale_name(self._page.scale)

    @property
    def texts(self) -> tuple[str, ...]:
        """All texts on the drawing."""
        return tuple(letters.text for letters in self._page.canvas.letters if letters.text)

    def save(self, path: str | PathLike[str]) -> Path:
        """Write a .pdf, .svg or .png file, whole or not at all, with the same bytes every time.

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
            For another suffix, and for a file that cannot be written.

        Examples
        --------
        >>> gears.drawing("pinion").save("pinion.svg").name
        'pinion.svg'
        """
        target = Path(path)
        if target.suffix.lower() not in DRAWING_SUFFIXES:
            raise OutputError("cannot write", target, reason=f"its suffix must be one of {', '.join(DRAWING_SUFFIXES)}")
        save_figure(paint(self._page), target)
        return target

    def _repr_png_(self) -> bytes:
        return saved_bytes(self.save, "drawing.png")

    def __dir__(self) -> list[Any]:
        return ["member", "save", "scale", "sheet", "texts"]


def drawing_of(gears: GearSet, name: str) -> WorkshopDrawing:
    """Return the drawing of a member, as for `Gears.drawing`."""
    member = gears.member(name)
    facts = facts_of(gears, member)
    return WorkshopDrawing(name, compose(views_of(member, facts), facts))
