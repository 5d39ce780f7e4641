"""Dimensions [ISO 129-1]: extension lines, dimension lines with arrows, and texts that do not overlap."""

from __future__ import annotations

import numpy as np

from gearmesh.drawing.canvas import ARROW_SIZE_MM, LETTER_HEIGHT_MM, Canvas, Lettering, Pen, text_width
from gearmesh.records import dataclass

#: from the outline to the first dimension line
FIRST_DISTANCE_MM = 9.0
#: from one dimension line to the next
NEXT_DISTANCE_MM = 8.0
#: length of extension lines beyond the dimension line
EXTENSION_OVERRUN_MM = 1.5
#: gap between the outline and extension lines
EXTENSION_GAP_MM = 1.0
#: from a dimension line to the middle of its text
TEXT_DISTANCE_MM = 0.5 * LETTER_HEIGHT_MM + 1.0


@dataclass(frozen=True)
class Span:
    """A dimension on paper, lengths in mm."""

    #: start along the dimension
    low: float
    #: end along the dimension
    high: float
    #: its text
    text: str
    #: positions across the dimension at which its extension lines begin, at start and end
    near: tuple[float, float]


def stack(canvas: Canvas, spans: list[Span], edge: float, side: int, upright: bool) -> None:
    """Draw dimensions beside each other, the shortest next to the outline.

    `edge`: position of the outline; `side`: 1 to larger, -1 to smaller coordinates; `upright`: True for vertical
    dimension lines.
    """
    for k, span in enumerate(sorted(spans, key=lambda span: span.high - span.low)):
        _dimension(canvas, span, edge + side * (FIRST_DISTANCE_MM + k * NEXT_DISTANCE_MM), side, upright)


def room(count: int) -> float:
    """Width in mm of a number of dimensions beside each other."""
    return FIRST_DISTANCE_MM + max(0, count - 1) * NEXT_DISTANCE_MM + 2.0 * TEXT_DISTANCE_MM + 1.0 if count else 0.0


def _dimension(canvas: Canvas, span: Span, place: float, side: int, upright: bool) -> None:
    """Draw one dimension with its line at `place`."""

    def at(along: float, across: float) -> tuple[float, float]:
        return (across, along) if upright else (along, across)

    for along, near in zip((span.low, span.high), span.near, strict=True):
        canvas.line(
            at(along, near + side * EXTENSION_GAP_MM), at(along, place + side * EXTENSION_OVERRUN_MM), pen=Pen.THIN
        )
    length, needed = span.high - span.low, text_width(span.text, LETTER_HEIGHT_MM)
    inside = length > 3.0 * ARROW_SIZE_MM[0]
    reach = 0.0 if inside else 2.0 * ARROW_SIZE_MM[0]
    canvas.line(at(span.low - reach, place), at(span.high + reach, place), pen=Pen.THIN)
    for along, way in ((span.low, -1.0), (span.high, 1.0)):
        outward = way if inside else -way
        canvas.arrow(np.array(at(along, place)), np.array(at(outward, 0.0)))
    # the text is over the middle of its line, otherwise beyond one of the ends
    beyond = 0.5 * needed + reach + 1.0
    middle = 0.5 * (span.low + span.high)
    text_positions = [middle] if needed < length - 1.0 else []
    text_positions += [span.high + beyond, span.low - beyond, middle]
    if text_positions[0] != middle:
        farthest = span.high + beyond + 0.5 * needed
        canvas.line(at(span.high, place), at(farthest, place), pen=Pen.THIN)
    # above a horizontal line, to the left of a vertical one
    across = place - TEXT_DISTANCE_MM if upright else place + TEXT_DISTANCE_MM
    letters = [Lettering(*at(along, across), span.text, angle=90.0 if upright else 0.0) for along in text_positions]
    canvas.text(next((lettering for lettering in letters if canvas.is_free(lettering.box)), letters[0]))


def note(canvas: Canvas, tip: tuple[float, float], corner: tuple[float, float], text: str) -> None:
    """Draw a text at a leader line with an arrow at `tip`."""
    way = np.array(tip) - corner
    canvas.arrow(np.array(tip), way / np.linalg.norm(way))
    right = corner[0] >= tip[0]
    end = corner[0] + (1.0 if right else -1.0) * (text_width(text, LETTER_HEIGHT_MM) + 1.0)
    canvas.line(tip, corner, (end, corner[1]), pen=Pen.THIN)
    canvas.text(Lettering(min(corner[0], end) + 0.5, corner[1] + TEXT_DISTANCE_MM, text, align="left"))
