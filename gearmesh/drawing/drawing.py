"""Workshop drawings, painted when they are saved."""

from __future__ import annotations

from pathlib import Path

from gearmesh.answers.gearset import GearSet
from gearmesh.drawing.gear_data import facts_of
from gearmesh.drawing.page import Page, compose, paint
from gearmesh.drawing.paper import scale_name
from gearmesh.drawing.views import views_of
from gearmesh.formats import DRAWING_SUFFIXES
from gearmesh.records import dataclass
from gearmesh.view.diagrams.plots import save_figure
from gearmesh.view.picture import SavedPicture


@dataclass(frozen=True, repr=False)
class WorkshopDrawing(SavedPicture):
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

    @property
    def suffixes(self) -> tuple[str, ...]:
        return DRAWING_SUFFIXES

    def _write(self, target: Path) -> None:
        save_figure(paint(self._page), target)


def drawing_of(gears: GearSet, name: str) -> WorkshopDrawing:
    """Return the drawing of a member, as for `Gears.drawing`."""
    member = gears.member(name)
    facts = facts_of(gears, member)
    return WorkshopDrawing(name, compose(views_of(member, facts), facts))
