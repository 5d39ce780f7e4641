"""The page: the smallest sheet and the largest scale that hold the views, the table of gear data, the title block."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.drawing.canvas import CAPITALS_SHARE, POINTS_PER_MM, Canvas, Lettering, Pen, text_width
from gearmesh.drawing.facts import DataRow, Facts
from gearmesh.drawing.paper import (
    DRAWING_SCALES,
    INTERMEDIATE_GAIN,
    INTERMEDIATE_SCALES,
    PAPER_SIZES,
    Paper,
    scale_name,
)
from gearmesh.drawing.views import Views
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: widths of the columns of gear data
DATA_COLUMN_WIDTHS_MM = (58.0, 14.0, 34.0)
#: height of its rows
DATA_ROW_HEIGHT_MM = 4.6
#: height of the title block
TITLE_HEIGHT_MM = 28.0
#: free space round the views
VIEW_MARGIN_MM = 5.0
#: widths of the columns of the title block
TITLE_COLUMN_WIDTHS_MM = (64.0, 46.0, 36.0, 34.0)
#: Greek letters by their names in symbols
GREEK_LETTERS = {
    **dict(
        zip(("alpha", "beta", "gamma", "delta", "zeta", "eta", "theta", "kappa", "lambda"), "αβγδζηθκλ", strict=True)
    ),
    **dict(zip(("mu", "xi", "rho", "tau", "phi", "psi", "eps", "Sigma", "Delta"), "μξρτφψεΣΔ", strict=True)),
}
#: name of a Greek letter, alone or before a number or a mark
GREEK_NAME = re.compile(rf"^({'|'.join(GREEK_LETTERS)})(?=$|[\d'*])")
#: space between the words of a symbol
SPACE_IN_FORMULA = r"\ "
#: height of letters in tables
TABLE_LETTER_HEIGHT_MM = 2.0
#: smallest height of letters in names of quantities
MIN_WORD_HEIGHT_MM = 1.4


@dataclass(frozen=True)
class Page:
    """A drawing on paper: its elements, its sheet and its scale."""

    canvas: Canvas
    paper: Paper
    scale: float


def compose(views: Views, facts: Facts) -> Page:
    """Arrange views, gear data and title block on a sheet.

    The sheet is A4 if the views fit at full size or larger, otherwise A3 at the largest scale that fits. Intermediate
    scales are used where they draw the views a fifth larger, so that they fill the sheet.
    """
    rows = DATA_ROW_HEIGHT_MM * (len(facts.rows) + 1)
    for paper in PAPER_SIZES:
        left, low, right, high = paper.frame
        room = (
            right - left - sum(DATA_COLUMN_WIDTHS_MM) - 2.0 * VIEW_MARGIN_MM,
            high - low - TITLE_HEIGHT_MM - 2.0 * VIEW_MARGIN_MM,
        )
        scale = _largest(views, room)
        last = paper is PAPER_SIZES[-1]
        if last or (scale is not None and scale >= paper.scale and rows <= room[1] + VIEW_MARGIN_MM):
            break
    scale = DRAWING_SCALES[-1] if scale is None else scale
    canvas = Canvas()
    views_width, views_height = views.size(scale)
    corner = (
        left + VIEW_MARGIN_MM + 0.5 * (room[0] - views_width),
        low + TITLE_HEIGHT_MM + VIEW_MARGIN_MM + 0.5 * (room[1] - views_height),
    )
    views.draw(canvas, scale, *corner)
    canvas.line((left, low), (right, low), (right, high), (left, high), (left, low), pen=Pen.FRAME)
    _data(canvas, facts, low, right, high)
    _title(canvas, facts, paper, scale)
    return Page(canvas, paper, scale)


def _largest(views: Views, room: tuple[float, float]) -> float | None:
    """Return the largest recommended scale at which views fit; an intermediate one if it is much larger. None if no
    scale is small enough.
    """
    recommended, intermediate = (
        next((s for s in scales if all(size <= most for size, most in zip(views.size(s), room, strict=True))), None)
        for scales in (DRAWING_SCALES, INTERMEDIATE_SCALES)
    )
    if recommended is None or intermediate is None or intermediate < INTERMEDIATE_GAIN * recommended:
        return recommended
    return intermediate


def _data(canvas: Canvas, facts: Facts, low: float, right: float, high: float) -> None:
    """Draw the table of gear data in the upper right corner."""
    left = right - sum(DATA_COLUMN_WIDTHS_MM)
    most = int((high - low - TITLE_HEIGHT_MM) / DATA_ROW_HEIGHT_MM) - 1
    rows = (
        facts.rows
        if len(facts.rows) <= most
        else (*facts.rows[: most - 1], DataRow("more: gearmesh describe", heading=True))
    )
    first, second = left + DATA_COLUMN_WIDTHS_MM[0], left + DATA_COLUMN_WIDTHS_MM[0] + DATA_COLUMN_WIDTHS_MM[1]
    canvas.text(
        Lettering(
            left + 1.0, high - 0.5 * DATA_ROW_HEIGHT_MM, "Gear data", TABLE_LETTER_HEIGHT_MM, align="left", bold=True
        )
    )
    for k, row in enumerate(rows):
        y = high - DATA_ROW_HEIGHT_MM * (k + 1.5)
        canvas.line((left, y + 0.5 * DATA_ROW_HEIGHT_MM), (right, y + 0.5 * DATA_ROW_HEIGHT_MM), pen=Pen.THIN)
        canvas.text(_lettering(left + 1.0, y, _readable(row.words), DATA_COLUMN_WIDTHS_MM[0] - 2.0, bold=row.heading))
        if not row.heading:
            # size for the Greek letters, not for their names in ASCII
            size = _lettering(first + 1.0, y, "".join(symbol_parts(row.symbol)), DATA_COLUMN_WIDTHS_MM[1] - 2.0)
            canvas.text(replace(size, text=row.symbol, symbol=True))
            canvas.text(
                _lettering(
                    right - 1.0,
                    y,
                    row.value.replace("m_n", "m\N{LATIN SUBSCRIPT SMALL LETTER N}"),
                    DATA_COLUMN_WIDTHS_MM[2] - 2.0,
                    "right",
                )
            )
    low = high - DATA_ROW_HEIGHT_MM * (len(rows) + 1)
    for x in (left, first, second):
        top = high if x == left else high - DATA_ROW_HEIGHT_MM
        canvas.line((x, low), (x, top), pen=Pen.OUTLINE if x == left else Pen.THIN)
    canvas.line((left, low), (right, low))


def _readable(words: str) -> str:
    """Return the name of a quantity without its last clauses, as many as make its letters too small to read."""
    while "," in words and _lettering(0.0, 0.0, words, DATA_COLUMN_WIDTHS_MM[0] - 2.0).height < MIN_WORD_HEIGHT_MM:
        words = words.rpartition(",")[0]
    return words


def _lettering(x: float, y: float, text: str, width: float, align: str = "left", bold: bool = False) -> Lettering:
    """Return a text whose letters are small enough for a width in mm."""
    height = TABLE_LETTER_HEIGHT_MM * min(1.0, 0.95 * width / max(text_width(text, TABLE_LETTER_HEIGHT_MM), 1e-9))
    return Lettering(x, y, text, height, align=align, bold=bold)


def _title(canvas: Canvas, facts: Facts, paper: Paper, scale: float) -> None:
    """Draw the title block in the lower right corner [ISO 7200], with the symbol of first-angle projection [ISO
    5456-2].
    """
    _, low, right, _ = paper.frame
    left, rows = right - sum(TITLE_COLUMN_WIDTHS_MM), 3
    high, step = low + TITLE_HEIGHT_MM - 2.0, (TITLE_HEIGHT_MM - 2.0) / rows
    cells = (
        (("Design", facts.title), ("Part", facts.part), ("Scale", scale_name(scale)), ("Sheet", paper.name)),
        (("Material and heat treatment", ""), ("Mass", facts.mass), ("Units", facts.units), ("Projection", "")),
        (("Made with", facts.version), ("Gear teeth", "ISO 2203"), ("Dimensions", "ISO 129-1"), ("", "")),
    )
    canvas.line((left, low), (left, high), (right, high))
    for k in range(1, rows):
        canvas.line(
            (left, high - k * step),
            (right if k < 2 else right - TITLE_COLUMN_WIDTHS_MM[-1], high - k * step),
            pen=Pen.THIN,
        )
    x = left
    for column, width in enumerate(TITLE_COLUMN_WIDTHS_MM):
        if column:
            canvas.line((x, low), (x, high), pen=Pen.THIN)
        for k in range(rows):
            words, value = cells[k][column]
            y = high - k * step
            canvas.text(Lettering(x + 1.0, y - 2.0, words, 1.4, align="left"))
            canvas.text(_lettering(x + 1.5, y - 5.8, value, width - 3.0))
        x += width
    _first_angle(canvas, right - 0.5 * TITLE_COLUMN_WIDTHS_MM[-1], low + 0.85 * step)


def _first_angle(canvas: Canvas, x: float, y: float) -> None:
    """Draw a truncated cone in first-angle projection."""
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
    """Return the page as a figure of matplotlib with the size of its sheet."""
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
                lines, colors="black", linewidths=width * POINTS_PER_MM, linestyles=[style], capstyle="butt", zorder=2
            )
        )
    axes.add_collection(PolyCollection(page.canvas.arrows, facecolors="black", linewidths=0.0, zorder=3))
    for letters in page.canvas.letters:
        if letters.text:
            _letter(axes, letters)
    return figure


def symbol_parts(symbol: str) -> list[str]:
    """Split a symbol of the sheet at each _, with names of Greek letters replaced by the letters."""
    return [GREEK_NAME.sub(lambda match: GREEK_LETTERS[match[0]], part) for part in symbol.split("_")]


def formula(symbol: str) -> str:
    """Return a symbol of the sheet, as alpha_n, as mathtext: Greek letters, and everything after the first _ as an
    index.
    """
    words = []
    for word in symbol.split():
        letter, *below = symbol_parts(word)
        words.append(letter + (f"_{{{''.join(below)}}}" if below else ""))
    return rf"$\mathregular{{{SPACE_IN_FORMULA.join(words)}}}$" if words else ""


def _letter(axes: object, letters: Lettering) -> None:
    """Draw a text."""
    axes.text(  # type: ignore[attr-defined]
        letters.x,
        letters.y,
        formula(letters.text) if letters.symbol else letters.text,
        fontsize=letters.height / CAPITALS_SHARE * POINTS_PER_MM,
        rotation=letters.angle,
        rotation_mode="anchor",
        ha=letters.align,
        va="center_baseline" if letters.angle else "center",
        weight="bold" if letters.bold else "normal",
        parse_math=letters.symbol,
        zorder=4,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.6}
        if letters.height > TABLE_LETTER_HEIGHT_MM
        else None,
    )
