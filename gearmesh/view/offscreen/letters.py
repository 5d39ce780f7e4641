"""Letters, lines and boxes on a picture, in DejaVu Sans by Pillow's FreeType.

Loading Matplotlib would take longer than drawing a tooth. The font comes from Matplotlib's files.
"""

from __future__ import annotations

from functools import lru_cache
from importlib.util import find_spec
from math import ceil, floor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.view.palette import INK_COLOUR

Image = NDArray[np.uint8]

#: height of every picture in points, so that letters keep their share of it
PICTURE_HEIGHT_POINTS = 540.0
#: pixels of a point of letters in small pictures: those of 10 points, the smallest, stay legible
MIN_POINT_PIXELS = 0.8
#: largest ratio by which letters of small pictures exceed their share of the height: larger ones would leave no room
MAX_LETTER_GROWTH = 2.2
#: letters that reach farthest above and below a line
_TALLEST_LETTERS = "lp"
#: distance of lines of a text, in heights of the tallest letters
_LINE_SPACING = 1.2
#: samples each way from which a mark's share of a pixel is counted
_SAMPLES_PER_PIXEL = 8
#: rim around letters and lines
_RIM_COLOUR = "#ffffff"


@dataclass(frozen=True)
class PixelBox:
    """Edges of a rectangle, pixels."""

    #: left edge, from the left
    left: float
    #: upper edge, from the top
    top: float
    #: right edge, from the left
    right: float
    #: lower edge, from the top
    bottom: float

    @property
    def corners(self) -> Array:
        """Corners (4, 2) in order, from the upper left corner."""
        x, y = (self.left, self.right, self.right, self.left), (self.top, self.top, self.bottom, self.bottom)
        return np.stack((x, y), axis=-1)


class LetteredImage:
    """A picture to letter: pixels (H, W, 3), or a size (W, H) alone to measure texts. Places are pixels from left and
    top.
    """

    def __init__(self, size: tuple[int, int], image: Image | None = None) -> None:
        from PIL import Image as pillow

        self.size, self.point = size, size[1] / PICTURE_HEIGHT_POINTS
        self._image = None if image is None else pillow.fromarray(image)

    def pixels(self) -> Image:
        """Return the picture with everything drawn, (H, W, 3)."""
        return np.array(self._image)

    def width(self, text: str, points: float) -> float:
        """Width (pixels) of the longest line of a text in letters of a size in points."""
        font = self._font(points)
        return max(float(font.getlength(line)) for line in text.split("\n"))

    def height(self, text: str, points: float) -> float:
        """Height (pixels) of all lines of a text."""
        above, below = self._reach(points)
        return (above + below) * (1.0 + _LINE_SPACING * text.count("\n"))

    def box(self, at: ArrayLike, text: str, points: float, across: float = 0.5, down: float = 0.5) -> PixelBox:
        """Box of a text; the shares `across` of its width and `down` of its height lie left of and above the place `at`
        (2,).
        """
        (x, y), wide, high = np.asarray(at, dtype=float), self.width(text, points), self.height(text, points)
        left, top = float(x) - across * wide, float(y) - down * high
        return PixelBox(left, top, left + wide, top + high)

    def text(
        self,
        at: ArrayLike,
        text: str,
        points: float,
        *,
        across: float = 0.5,
        down: float = 0.5,
        colour: str = INK_COLOUR,
    ) -> None:
        """Write a text, its lines centred in its `box`, with a white rim that makes it legible on any ground."""
        box = self.box(at, text, points, across, down)
        left, top = floor(box.left), floor(box.top)
        masks, margin = self._masks(text, points, (box.left - left, box.top - top))
        for ground, mask in zip((_RIM_COLOUR, colour), masks, strict=True):
            self._stamp(ground, mask, (left - margin, top - margin))

    def text_upwards(self, at: ArrayLike, text: str, points: float) -> None:
        """Write lines from bottom to top; the place `at` (2,) is the middle of their left edge."""
        from PIL.Image import Transpose

        x, y = np.asarray(at, dtype=float)
        masks, margin = self._masks(text, points)
        for ground, mask in zip((_RIM_COLOUR, INK_COLOUR), masks, strict=True):
            corner = round(x) - margin, round(y - 0.5 * self.width(text, points)) - margin
            self._stamp(ground, mask.transpose(Transpose.ROTATE_90), corner)

    def line(self, begin: ArrayLike, end: ArrayLike, points: float, colour: str = INK_COLOUR, rim: bool = True) -> None:
        """Draw a straight line between two places (2,), `points` wide, with a white rim unless `rim` is False."""
        begin, end, half = np.asarray(begin, dtype=float), np.asarray(end, dtype=float), 0.5 * points * self.point
        way = end - begin
        aside = np.array([-way[1], way[0]]) / max(float(np.hypot(*way)), 1e-9)
        for ground, reach in ((_RIM_COLOUR, half + self.point), (colour, half)) if rim else ((colour, half),):
            self.fill((begin + reach * aside, end + reach * aside, end - reach * aside, begin - reach * aside), ground)

    def disc(self, middle: ArrayLike, points: float, colour: str) -> None:
        """Draw a disc of `points` in diameter."""
        angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
        round_ = 0.5 * points * self.point * np.stack((np.cos(angle), np.sin(angle)), axis=-1)
        self.fill(np.asarray(middle) + round_, colour)

    def fill(self, corners: ArrayLike, colour: str) -> None:
        """Fill a polygon with corners (N, 2); it covers a pixel by its share in it."""
        from PIL import Image as pillow
        from PIL.ImageDraw import Draw

        places = np.asarray(corners, dtype=float)
        low, high = np.floor(places.min(axis=0)), np.ceil(places.max(axis=0))
        size = np.maximum(high - low, 1.0).astype(int)
        mask = pillow.new("L", tuple((_SAMPLES_PER_PIXEL * size).tolist()))
        # corners of a polygon are middles of places, and these belong to it
        Draw(mask).polygon([tuple(place) for place in (_SAMPLES_PER_PIXEL * (places - low) - 0.5).tolist()], fill=255)
        self._stamp(colour, mask.resize(tuple(size.tolist()), pillow.Resampling.BOX), (int(low[0]), int(low[1])))

    def paste(self, colours: Image, box: PixelBox) -> None:
        """Paste colours (H, W, 3) into a box, stretched to whole pixels."""
        from PIL import Image as pillow

        assert self._image is not None
        left, top, right, bottom = (round(edge) for edge in (box.left, box.top, box.right, box.bottom))
        stretched = pillow.fromarray(colours).resize((max(right - left, 1), max(bottom - top, 1)))
        self._image.paste(stretched, (left, top))

    def _stamp(self, colour: str, mask: Any, corner: tuple[int, int]) -> None:
        """Colour the pixels that a mask covers, its upper left at `corner`, as far as they are on the picture."""
        assert self._image is not None
        self._image.paste(colour, (*corner, corner[0] + mask.width, corner[1] + mask.height), mask)

    def _masks(self, text: str, points: float, at: tuple[float, float] = (0.0, 0.0)) -> tuple[tuple[Any, Any], int]:
        """Masks of a text's rim and of its letters, and the margin (pixels) around its box, which begins at `at` within
        it.
        """
        from PIL import Image as pillow
        from PIL.ImageDraw import Draw

        rim, font, (above, below) = max(1, round(1.5 * self.point)), self._font(points), self._reach(points)
        wide, margin = self.width(text, points), rim + ceil(above)
        size = ceil(at[0] + wide) + 2 * margin, ceil(at[1] + self.height(text, points)) + 2 * margin
        covered, letters = pillow.new("L", size), pillow.new("L", size)
        for k, line in enumerate(text.split("\n")):
            x = margin + at[0] + 0.5 * (wide - float(font.getlength(line)))
            y = margin + at[1] + above + k * _LINE_SPACING * (above + below)
            for mask, stroke in ((covered, rim), (letters, 0)):
                Draw(mask).text((x, y), line, 255, font, "ls", stroke_width=stroke)
        return (covered, letters), margin

    def _font(self, points: float) -> Any:
        return _font(points * max(self.point, min(MIN_POINT_PIXELS, MAX_LETTER_GROWTH * self.point)))

    def _reach(self, points: float) -> tuple[float, float]:
        """Heights of the tallest letters above and below their line, pixels."""
        _, top, _, bottom = self._font(points).getbbox(_TALLEST_LETTERS, anchor="ls")
        return -float(top), float(bottom)


def ticks(limit: float, most: int = 9) -> tuple[Array, tuple[str, ...]]:
    """Round values from 0 to a limit, with at most `most` steps between them, and their texts."""
    power = 10.0 ** np.floor(np.log10(limit / most))
    step = next(part * power for part in (1.0, 2.0, 2.5, 5.0, 10.0) if limit <= most * part * power)
    values = step * np.arange(np.floor(limit / step + 1e-9) + 1)
    decimals = next(n for n in range(20) if abs(step * 10.0**n - round(step * 10.0**n)) < 1e-6)
    return values, tuple(f"{value:.{decimals}f}" for value in values)


@lru_cache(maxsize=32)
def _font(pixels: float) -> Any:
    from PIL.ImageFont import Layout, truetype

    return truetype(str(_font_file()), pixels, layout_engine=Layout.BASIC)


@lru_cache(maxsize=1)
def _font_file() -> Path:
    """Path of the font in Matplotlib's files; Matplotlib is loaded only if they are not in its folder."""
    spec = find_spec("matplotlib")
    files = Path(spec.origin).parent / "mpl-data" if spec is not None and spec.origin is not None else Path("mpl-data")
    if not files.is_dir():
        from matplotlib import get_data_path

        files = Path(get_data_path())
    return files / "fonts" / "ttf" / "DejaVuSans.ttf"
