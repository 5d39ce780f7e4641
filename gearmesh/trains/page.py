"""Report page of a train: picture with main figures, transmission error of the output, tables, data sheets of the stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.sheet import sheet_of
from gearmesh.answers.tables import Listing
from gearmesh.formats import SVG_SUFFIX
from gearmesh.reports.report import ReportPage, jpeg, known_rows, tables_html
from gearmesh.view.opengl import missing_opengl_message
from gearmesh.view.picture import Diagram, saved_bytes
from gearmesh.view.render import render
from gearmesh.view.report import page as pages
from gearmesh.view.report.card import Card, CardFigure, MeshCard
from gearmesh.view.report.page import PageSection, drawing, picture
from gearmesh.view.scene import Scene


def train_page(
    title: str,
    summary: str,
    figures: Sequence[CardFigure],
    listings: Sequence[Listing],
    chart: Diagram,
    scene: Callable[[], Scene],
    stages: Mapping[str, GearSet],
    warnings: tuple[str, ...],
) -> ReportPage:
    """Return the page of a train; without OpenGL it has no picture.

    - title, summary: head of the page and the line below it.
    - figures: main figures, beside the picture.
    - listings: tables of figures.
    - chart: transmission error of the output.
    - scene: makes the scene of all gears.
    - stages: gears of the stages by their names, for the data sheets.
    """
    skipped = missing_opengl_message()
    shot = "" if skipped else picture("All gears in mesh, the input at 0", jpeg(render(scene())))
    sections = [PageSection("Figures", f'<div class="sheet">{tables_html(listings)}</div>')]
    drawn = drawing("Transmission error of the output", saved_bytes(chart, SVG_SUFFIX))
    sections.append(PageSection("Transmission error", f'<div class="plots">{drawn}</div>'))
    for name, gears in stages.items():
        rows = [listing for listing in map(known_rows, sheet_of(gears).listings) if listing.rows]
        sections.append(PageSection(f"Stage {name}: {gears.title}", f'<div class="sheet">{tables_html(rows)}</div>'))
    lines = tuple(dict.fromkeys((*warnings, *([skipped] if skipped else []))))
    card = Card(
        (MeshCard(title, tuple(figures)),),
        lines,
        remark="Speeds and torques are per those of the input, without losses.",
    )
    return ReportPage(title, pages.plain_page(title, summary, sections, shot, card), lines, skipped)
