"""Elements of a drawing: strokes, hatching, arrows and lettering on paper, in mm from its lower left corner.

Line types follow ISO 128-2: wide continuous outlines, narrow continuous dimensions, narrow long-dashed dotted axes and
reference lines. A text that would lie on another text is moved, or its dimension is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field
from enum import Enum
from functools import cache

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: height of capitals
LETTER_HEIGHT_MM = 2.5
#: height of capitals as a share of the font size [DejaVu Sans]
CAPITALS_SHARE = 0.729
#: pt in a mm
POINTS_PER_MM = 72.0 / 25.4
#: length and half width of arrow heads
ARROW_SIZE_MM = (2.8, 0.45)
#: distance between lines of a hatch
HATCH_SPACING_MM = 2.2
#: free space round a text
TEXT_MARGIN_MM = 0.5


class Pen(Enum):
    """Width of a line (mm), and its dashes as multiples of the width."""

    OUTLINE = (0.5, ())
    THIN = (0.25, ())
    CHAIN = (0.25, (24.0, 5.0, 2.0, 5.0))
    FRAME = (0.7, ())
    HATCHING = (0.18, ())


@dataclass(frozen=True)
class Stroke:
    """A line through points (N, 2)."""

    points: Array
    pen: Pen


@dataclass(frozen=True)
class Lettering:
    """A text on paper, centred across its direction."""

    #: horizontal position, mm
    x: float
    #: vertical position, mm
    y: float
    #: the text
    text: str
    #: height of its capitals, mm
    height: float = LETTER_HEIGHT_MM
    #: direction of the text, deg
    angle: float = 0.0
    #: alignment along the text: left, center or right
    align: str = "center"
    #: True for bold letters
    bold: bool = False
    #: True if the text is a symbol of the sheet, as alpha_n
    symbol: bool = False

    @property
    def box(self) -> Box:
        """Rectangle that the text covers."""
        length, high = text_width(self.text, self.height), 1.35 * self.height
        shift = {"left": 0.0, "center": 0.5, "right": 1.0}[self.align] * length
        if self.angle:
            return Box(self.x - 0.5 * high, self.y - shift, self.x + 0.5 * high, self.y - shift + length)
        return Box(self.x - shift, self.y - 0.5 * high, self.x - shift + length, self.y + 0.5 * high)


@dataclass(frozen=True)
class Box:
    """An upright rectangle, mm."""

    #: smallest x
    left: float
    #: smallest y
    low: float
    #: largest x
    right: float
    #: largest y
    high: float

    def overlaps(self, other: Box, room: float = TEXT_MARGIN_MM) -> bool:
        """True if two boxes are nearer than `room` (mm)."""
        return (
            self.left < other.right + room
            and other.left < self.right + room
            and self.low < other.high + room
            and other.low < self.high + room
        )


@dataclass
class Canvas:
    """Strokes, filled arrow heads and texts, in the order in which they are drawn."""

    strokes: list[Stroke] = field(default_factory=list)
    arrows: list[Array] = field(default_factory=list)
    letters: list[Lettering] = field(default_factory=list)

    def line(self, *points: Sequence[float], pen: Pen = Pen.OUTLINE) -> None:
        """Draw a line through points."""
        self.stroke(np.array(points, dtype=float), pen)

    def stroke(self, points: Array, pen: Pen = Pen.OUTLINE) -> None:
        """Draw a line through points (N, 2)."""
        self.strokes.append(Stroke(points, pen))

    def circle(self, x: float, y: float, radius: float, pen: Pen = Pen.OUTLINE) -> None:
        """Draw a circle."""
        angle = np.linspace(0.0, 2.0 * np.pi, 181)
        self.stroke(np.stack((x + radius * np.cos(angle), y + radius * np.sin(angle)), axis=-1), pen)

    def arrow(self, tip: Array, way: Array) -> None:
        """Draw an arrow head at a tip (2,) that points along `way`, a unit vector (2,)."""
        length, half = ARROW_SIZE_MM
        aside = np.array([-way[1], way[0]])
        self.arrows.append(np.array([tip, tip - length * way + half * aside, tip - length * way - half * aside]))

    def text(self, lettering: Lettering) -> None:
        """Add a text at its position."""
        self.letters.append(lettering)

    def is_free(self, box: Box) -> bool:
        """True if no text lies in a box."""
        return not any(box.overlaps(letters.box) for letters in self.letters)

    def hatch(self, outlines: Sequence[Array], flipped: bool = False) -> None:
        """Hatch the area inside closed outlines (N, 2), by the even-odd rule."""
        slope = np.array([1.0, -1.0 if flipped else 1.0]) / np.sqrt(2.0)
        across = np.array([-slope[1], slope[0]])
        starts = np.concatenate(list(outlines))
        ends = np.concatenate([np.roll(outline, -1, axis=0) for outline in outlines])
        low, high = starts @ across, ends @ across
        for level in (
            np.arange(np.ceil(low.min() / HATCH_SPACING_MM), np.floor(low.max() / HATCH_SPACING_MM) + 1.0)
            * HATCH_SPACING_MM
        ):
            crossing = (low <= level) != (high <= level)
            share = ((level - low[crossing]) / (high[crossing] - low[crossing]))[:, None]
            along = np.sort((starts[crossing] + share * (ends[crossing] - starts[crossing])) @ slope)
            for first, last in along.reshape(-1, 2):
                self.line(first * slope + level * across, last * slope + level * across, pen=Pen.HATCHING)


@cache
def text_width(text: str, height: float) -> float:
    """Width (mm) of a text in letters of a height."""
    from matplotlib.textpath import TextPath

    if not text:
        return 0.0
    return float(TextPath((0.0, 0.0), text + ".", size=height / CAPITALS_SHARE).get_extents().x1)
