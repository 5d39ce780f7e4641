"""Dimensions [ISO 129-1]: extension lines, dimension lines with arrows, and texts that lie on no other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.drawing.canvas import ARROW, LETTERS, Canvas, Lettering, Pen, text_width

#: mm: from the outline to the first dimension line, from one to the next, extension lines beyond and short of them
FIRST, NEXT, BEYOND, SHORT = 9.0, 8.0, 1.5, 1.0
#: mm: from a dimension line to the middle of its text
ABOVE = 0.5 * LETTERS + 1.0


@dataclass(frozen=True)
class Span:
    """What a dimension is of: from `low` to `high` along it, and where (`near`: low and high) its extension lines begin across it,
    all in mm on paper, and what it says."""

    low: float
    high: float
    text: str
    near: tuple[float, float]


def stack(canvas: Canvas, spans: list[Span], edge: float, side: int, upright: bool) -> None:
    """Dimensions beside each other, the shortest next to the outline, whose edge is at `edge`; to larger (`side` 1) or smaller
    coordinates; `upright`: their lines are."""
    for k, span in enumerate(sorted(spans, key=lambda span: span.high - span.low)):
        _dimension(canvas, span, edge + side * (FIRST + k * NEXT), side, upright)


def room(count: int) -> float:
    """mm that so many dimensions beside each other take."""
    return FIRST + max(0, count - 1) * NEXT + 2.0 * ABOVE + 1.0 if count else 0.0


def _dimension(canvas: Canvas, span: Span, place: float, side: int, upright: bool) -> None:
    def at(along: float, across: float) -> tuple[float, float]:
        return (across, along) if upright else (along, across)

    for along, near in zip((span.low, span.high), span.near, strict=True):
        canvas.line(at(along, near + side * SHORT), at(along, place + side * BEYOND), pen=Pen.THIN)
    length, needed = span.high - span.low, text_width(span.text, LETTERS)
    inside = length > 3.0 * ARROW[0]
    reach = 0.0 if inside else 2.0 * ARROW[0]
    canvas.line(at(span.low - reach, place), at(span.high + reach, place), pen=Pen.THIN)
    for along, way in ((span.low, -1.0), (span.high, 1.0)):
        outward = way if inside else -way
        canvas.arrow(np.array(at(along, place)), np.array(at(outward, 0.0)))
    # the text: over the middle of its line, else beyond an end of it
    beyond = 0.5 * needed + reach + 1.0
    middle = 0.5 * (span.low + span.high)
    places = [middle] if needed < length - 1.0 else []
    places += [span.high + beyond, span.low - beyond, middle]
    if places[0] != middle:
        farthest = span.high + beyond + 0.5 * needed
        canvas.line(at(span.high, place), at(farthest, place), pen=Pen.THIN)
    # above a line that lies, to the left of one that stands
    across = place - ABOVE if upright else place + ABOVE
    letters = [Lettering(*at(along, across), span.text, angle=90.0 if upright else 0.0) for along in places]
    canvas.text(next((lettering for lettering in letters if canvas.is_free(lettering.box)), letters[0]))


def note(canvas: Canvas, tip: tuple[float, float], corner: tuple[float, float], text: str) -> None:
    """A text on a leader line with an arrow at `tip`."""
    way = np.array(tip) - corner
    canvas.arrow(np.array(tip), way / np.linalg.norm(way))
    right = corner[0] >= tip[0]
    end = corner[0] + (1.0 if right else -1.0) * (text_width(text, LETTERS) + 1.0)
    canvas.line(tip, corner, (end, corner[1]), pen=Pen.THIN)
    canvas.text(Lettering(min(corner[0], end) + 0.5, corner[1] + ABOVE, text, align="left"))
