"""Report page of a train: picture, figures, transmission error of the output, data sheets of the stages."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.sheet import sheet_of
from gearmesh.answers.tables import Listing
from gearmesh.formats import SVG_SUFFIX
from gearmesh.reports.report import ReportPage, jpeg, tables_html
from gearmesh.view.opengl import missing_opengl_message
from gearmesh.view.picture import Diagram, saved_bytes
from gearmesh.view.render import render
from gearmesh.view.report import page as pages
from gearmesh.view.report.page import PageSection, drawing, picture
from gearmesh.view.scene import Scene


def train_page(
    title: str,
    summary: str,
    listings: Sequence[Listing],
    chart: Diagram,
    scene: Callable[[], Scene],
    stages: Mapping[str, GearSet],
    warnings: tuple[str, ...],
) -> ReportPage:
    """Return the page of a train; without OpenGL it has no picture.

    - title, summary: head of the page and the line below it.
    - listings: tables of figures.
    - chart: transmission error of the output.
    - scene: makes the scene of all gears.
    - stages: gears of the stages by their names, for the data sheets.
    """
    skipped = missing_opengl_message()
    sections = [PageSection("Figures", tables_html(listings))]
    if skipped is None:
        shot = picture("All gears in mesh, the input at 0", jpeg(render(scene())))
        sections.insert(0, PageSection("Gears", f'<div class="plots">{shot}</div>'))
    drawn = drawing("Transmission error of the output", saved_bytes(chart, SVG_SUFFIX))
    sections.append(PageSection("Transmission error", f'<div class="plots">{drawn}</div>'))
    for name, gears in stages.items():
        sections.append(PageSection(f"Stage {name}: {gears.title}", tables_html(sheet_of(gears).listings)))
    lines = tuple(dict.fromkeys((*warnings, *([skipped] if skipped else []))))
    if lines:
        sections.insert(0, PageSection("Warnings", tables_html([Listing("", ("",), [[line] for line in lines])])))
    return ReportPage(title, pages.plain_page(title, summary, sections), lines, skipped)
