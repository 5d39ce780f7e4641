"""The page: the smallest sheet and largest scale that the views fit, the table of gear data, the title block."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gearmesh.drawing.canvas import CAPITALS, POINTS, Canvas, Lettering, Pen, text_width
from gearmesh.drawing.facts import DataRow, Facts
from gearmesh.drawing.paper import PAPERS, SCALES, Paper, scale_name
from gearmesh.drawing.views import Views

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: mm: widths of the columns of gear data, height of its rows, of the title block, and free space round the views
COLUMNS, ROW, TITLE, SPACE = (58.0, 14.0, 34.0), 4.6, 28.0, 5.0
#: mm: widths of the columns of the title block
FIELDS = (64.0, 46.0, 36.0, 34.0)
#: Greek letters by what symbols in ASCII call them, alone or before a number or a mark
GREEK = {
    **dict(
        zip(("alpha", "beta", "gamma", "delta", "zeta", "eta", "theta", "kappa", "lambda"), "αβγδζηθκλ", strict=True)
    ),
    **dict(zip(("mu", "xi", "rho", "tau", "phi", "psi", "eps", "Sigma", "Delta"), "μξρτφψεΣΔ", strict=True)),
}
GREEK_NAME = re.compile(rf"^({'|'.join(GREEK)})(?=$|[\d'*])")
#: between the words of a symbol
SPACE_IN_FORMULA = r"\ "
#: letters in tables, mm
SMALL = 2.0


@dataclass(frozen=True)
class Page:
    """A drawing on paper: what is on it, the sheet and the scale."""

    canvas: Canvas
    paper: Paper
    scale: float


def compose(views: Views, facts: Facts) -> Page:
    """Views, gear data and title block on a sheet: A4 where they fit at full size or larger, else A3 at the scale that fits."""
    rows = ROW * (len(facts.rows) + 1)
    for paper in PAPERS:
        left, low, right, high = paper.frame
        room = right - left - sum(COLUMNS) - 2.0 * SPACE, high - low - TITLE - 2.0 * SPACE
        fitting = (s for s in SCALES if all(size <= most for size, most in zip(views.size(s), room, strict=True)))
        scale = next(fitting, None)
        last = paper is PAPERS[-1]
        if last or (scale is not None and scale >= paper.scale and rows <= room[1] + SPACE):
            break
    scale = SCALES[-1] if scale is None else scale
    canvas = Canvas()
    wide, tall = views.size(scale)
    corner = left + SPACE + 0.5 * (room[0] - wide), low + TITLE + SPACE + 0.5 * (room[1] - tall)
    views.draw(canvas, scale, *corner)
    canvas.line((left, low), (right, low), (right, high), (left, high), (left, low), pen=Pen.FRAME)
    _data(canvas, facts, low, right, high)
    _title(canvas, facts, paper, scale)
    return Page(canvas, paper, scale)


def _data(canvas: Canvas, facts: Facts, low: float, right: float, high: float) -> None:
    """The table of gear data in the upper right corner."""
    left = right - sum(COLUMNS)
    most = int((high - low - TITLE) / ROW) - 1
    rows = (
        facts.rows
        if len(facts.rows) <= most
        else (*facts.rows[: most - 1], DataRow("more: gearmesh describe", heading=True))
    )
    first, second = left + COLUMNS[0], left + COLUMNS[0] + COLUMNS[1]
    canvas.text(Lettering(left + 1.0, high - 0.5 * ROW, "Gear data", SMALL, align="left", bold=True))
    for k, row in enumerate(rows):
        y = high - ROW * (k + 1.5)
        canvas.line((left, y + 0.5 * ROW), (right, y + 0.5 * ROW), pen=Pen.THIN)
        canvas.text(_lettering(left + 1.0, y, row.words, COLUMNS[0] - 2.0, bold=row.heading))
        if not row.heading:
            # as long as its letters are, not their names in ASCII
            size = _lettering(first + 1.0, y, "".join(symbol_parts(row.symbol)), COLUMNS[1] - 2.0)
            canvas.text(replace(size, text=row.symbol, symbol=True))
            canvas.text(
                _lettering(
                    right - 1.0,
                    y,
                    row.value.replace("m_n", "m\N{LATIN SUBSCRIPT SMALL LETTER N}"),
                    COLUMNS[2] - 2.0,
                    "right",
                )
            )
    low = high - ROW * (len(rows) + 1)
    for x in (left, first, second):
        top = high if x == left else high - ROW
        canvas.line((x, low), (x, top), pen=Pen.OUTLINE if x == left else Pen.THIN)
    canvas.line((left, low), (right, low))


def _lettering(x: float, y: float, text: str, width: float, align: str = "left", bold: bool = False) -> Lettering:
    """A text in letters so small that it is no longer than so many mm."""
    height = SMALL * min(1.0, 0.95 * width / max(text_width(text, SMALL), 1e-9))
    return Lettering(x, y, text, height, align=align, bold=bold)


def _title(canvas: Canvas, facts: Facts, paper: Paper, scale: float) -> None:
    """The title block in the lower right corner [ISO 7200], with the symbol of first-angle projection [ISO 5456-2]."""
    _, low, right, _ = paper.frame
    left, rows = right - sum(FIELDS), 3
    high, step = low + TITLE - 2.0, (TITLE - 2.0) / rows
    cells = (
        (("Design", facts.title), ("Part", facts.part), ("Scale", scale_name(scale)), ("Sheet", paper.name)),
        (("Material", facts.material), ("Mass", facts.mass), ("Units", facts.units), ("Projection", "")),
        (("Made with", facts.version), ("Gear teeth", "ISO 2203"), ("Dimensions", "ISO 129-1"), ("", "")),
    )
    canvas.line((left, low), (left, high), (right, high))
    for k in range(1, rows):
        canvas.line((left, high - k * step), (right if k < 2 else right - FIELDS[-1], high - k * step), pen=Pen.THIN)
    x = left
    for column, width in enumerate(FIELDS):
        if column:
            canvas.line((x, low), (x, high), pen=Pen.THIN)
        for k in range(rows):
            words, value = cells[k][column]
            y = high - k * step
            canvas.text(Lettering(x + 1.0, y - 2.0, words, 1.4, align="left"))
            canvas.text(_lettering(x + 1.5, y - 5.8, value, width - 3.0))
        x += width
    _first_angle(canvas, right - 0.5 * FIELDS[-1], low + 0.85 * step)


def _first_angle(canvas: Canvas, x: float, y: float) -> None:
    """A truncated cone in first-angle projection."""
    large, small, length = 3.6, 1.8, 7.0
    left = x - length - 1.0
    canvas.line(
        (left, y - small), (left + length, y - large), (left + length, y + large), (left, y + small), (left, y - small)
    )
    for radius in (small, large):
        canvas.circle(x + 5.0, y, radius)
    canvas.line((left - 1.5, y), (left + length + 1.5, y), pen=Pen.CHAIN)
    canvas.line((x + 5.0 - large - 1.0, y), (x + 5.0 + large + 1.0, y), pen=Pen.CHAIN)
    canvas.line((x + 5.0, y - large - 1.0), (x + 5.0, y + large + 1.0), pen=Pen.CHAIN)


def paint(page: Page) -> Figure:
    """The page as a figure of matplotlib, of the size of its sheet."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.figure import Figure

    wide, tall = page.paper.width, page.paper.height
    figure = Figure(figsize=(wide / 25.4, tall / 25.4), dpi=150)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, wide), ylim=(0.0, tall))
    axes.axis("off")
    for pen in Pen:
        lines = [stroke.points for stroke in page.canvas.strokes if stroke.pen is pen]
        width, dashes = pen.value
        style = (0.0, dashes) if dashes else "solid"
        axes.add_collection(
            LineCollection(
                lines, colors="black", linewidths=width * POINTS, linestyles=[style], capstyle="butt", zorder=2
            )
        )
    axes.add_collection(PolyCollection(page.canvas.arrows, facecolors="black", linewidths=0.0, zorder=3))
    for letters in page.canvas.letters:
        if letters.text:
            _letter(axes, letters)
    return figure


def symbol_parts(symbol: str) -> list[str]:
    """What is between the _ of a symbol of the sheet, names of Greek letters as these."""
    return [GREEK_NAME.sub(lambda match: GREEK[match[0]], part) for part in symbol.split("_")]


def formula(symbol: str) -> str:
    """A symbol of the sheet, as alpha_n, as mathtext: with Greek letters, and below the line what is after the first _."""
    words = []
    for word in symbol.split():
        letter, *below = symbol_parts(word)
        words.append(letter + (f"_{{{''.join(below)}}}" if below else ""))
    return rf"$\mathregular{{{SPACE_IN_FORMULA.join(words)}}}$" if words else ""


def _letter(axes: object, letters: Lettering) -> None:
    axes.text(  # type: ignore[attr-defined]
        letters.x,
        letters.y,
        formula(letters.text) if letters.symbol else letters.text,
        fontsize=letters.height / CAPITALS * POINTS,
        rotation=letters.angle,
        rotation_mode="anchor",
        ha=letters.align,
        va="center_baseline" if letters.angle else "center",
        weight="bold" if letters.bold else "normal",
        parse_math=letters.symbol,
        zorder=4,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6} if letters.height > SMALL else None,
    )
