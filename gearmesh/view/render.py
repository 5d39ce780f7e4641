"""The one renderer of scenes: VTK draws the bodies in a process of its own, Pillow letters the picture.

The lettering (title, legend, colour bar, scale, axes) is two-dimensional and never covers the middle of the picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from gearmesh.errors import OutputError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.view.lettering import WIDEST, break_lines
from gearmesh.view.offscreen.letters import Image, LetteredImage, PixelBox, ticks
from gearmesh.view.offscreen.shapes import colour_table, drawing_order
from gearmesh.view.opengl import draw
from gearmesh.view.palette import CURVES
from gearmesh.view.scene import BESIDE_BAR, Camera, Scene, ValueMap, beside_bar

_KINDS = (".png", ".jpg", ".jpeg", ".tif", ".tiff")


def render(scene: Scene, path: Path | str | None = None, size: tuple[int, int] | None = None) -> Image:
    """The picture of a scene as RGB pixels (H, W, 3), also written to `path` if one is given.

    PNG, JPEG or TIFF by the path's suffix; `size` in pixels, width by height, overrides the scene's. Equal scenes
    give equal pixels. Raises OutputError where OpenGL does not work, because going on would end the process, or where
    the file cannot be written.
    """
    if path is not None and Path(path).suffix.lower() not in _KINDS:
        raise OutputError("cannot write", path, reason=f"the suffix of a picture must be {', '.join(_KINDS)}")
    size = size or scene.size
    heading = _Heading.of(scene, size)
    # what is higher than the room that scenes leave for it takes its own
    above = max(0, heading.height - round(_ROOM * size[1]))
    inner = beside_bar(size)[0] if scene.maps else size[0], size[1] - above
    tell(0.2)
    photograph = _photograph(scene, inner)
    tell(0.8)
    # heading and colour bar are on white, not on the teeth
    image = np.pad(photograph, ((above, 0), (0, size[0] - inner[0]), (0, 0)), constant_values=255)
    image[: heading.height] = 255
    image = _letter(image, scene, heading, inner)
    if path is not None:
        from PIL import Image as pillow

        from gearmesh.io.atomic import whole_file

        with whole_file(path) as unfinished:
            pillow.fromarray(image).save(unfinished)
    return image


def _photograph(scene: Scene, size: tuple[int, int]) -> Image:
    """The three-dimensional part of the picture, (H, W, 3)."""
    from PIL import Image as pillow

    order = drawing_order(scene, size)
    # a pixel is the mean, by their distances from its middle, of four by four
    # what is transparent of none of them is not asked: Pillow has no need to look at it
    large = pillow.frombuffer("RGBX", order["size"], draw(order), "raw", "RGBX", 0, -1)
    return np.asarray(large.resize(size, pillow.Resampling.BILINEAR).convert("RGB"))


# --- lettering ---

#: part of a picture's height that scenes leave for a heading: a title of one line and a legend of one row
_ROOM = 0.09
#: where a heading begins, where the middle of a legend's first row is below a title of one line, and the height of a row
_FIRST, _LEGEND, _ROW = 0.015, 0.055, 0.031
#: entries of the legend in a row at most
_COLUMNS = 4
#: letters of titles, words, entries of the legend, the colour bar's label, and numbers, points
_TITLE, _WORD, _ENTRY, _LABEL, _NUMBER = 13.0, 12.0, 10.5, 11.0, 10.0
#: of an entry of the legend, in heights of its letters: its mark, the gap after it, the gap before the next entry
_MARK, _GAP, _BETWEEN = 2.0, 0.8, 2.0
#: nearest that a word may come to the picture's edges, as parts of it
_MARGIN = (0.035, 0.03)
#: how far a word stays from what it names and from the edges, as a part of the picture's height
_CLEAR = 0.009


def _letter(image: Image, scene: Scene, heading: _Heading, inner: tuple[int, int]) -> Image:
    """The picture with title and legend on top, a colour bar at the side, axes, scale and words; nothing of it is boxed.

    The camera sees what is `inner`, in the lower left.
    """
    sheet = LetteredImage((image.shape[1], image.shape[0]), image)
    if scene.maps:
        _draw_colour_bar(sheet, scene.maps[0])
    heading.draw(sheet)
    for place, text, across in _placed_words(sheet, scene, inner):
        sheet.text(place, text, _WORD, across=across)
    _draw_axes(sheet, scene.camera)
    if scene.camera.parallel:
        _draw_scale(sheet, scene.camera, inner)
    return sheet.pixels()


def _placed_words(sheet: LetteredImage, scene: Scene, inner: tuple[int, int]) -> list[tuple[Array, str, float]]:
    """Places (2,) in pixels, words and the part of its width that each has to the left of its place.

    All of a word is beyond its point, or at the edge of the picture where the point is not in it.
    """
    size, placed = np.array(sheet.size), []
    above = size[1] - inner[1]
    for word in scene.words:
        at, inside = (
            scene.camera.pixels(point, inner)[:2] + np.array([0.0, above]) for point in (word.point, word.inside)
        )
        way = at - inside
        way = way / max(float(np.hypot(*way)), 1e-9)
        place = at + 0.028 * size[1] * way
        top = above + _ROOM * size[1]
        low = _MARGIN[0] * size[0], top + 0.035 * size[1]
        kept = np.clip(place, low, (inner[0] - _MARGIN[0] * size[0], (1.0 - _MARGIN[1]) * size[1]))
        if not word.beyond and np.abs((kept - place) / size).max() <= 0.03:
            placed.append((_clear_place(sheet, word.text, at, way, inner[0], top), word.text, 0.5))
        elif at[0] < 0.5 * size[0] if word.beyond else way[0] < 0.0:
            placed.append((kept, f"\N{LEFTWARDS ARROW} {word.text}", 0.0))
        else:
            placed.append((kept, f"{word.text} \N{RIGHTWARDS ARROW}", 1.0))
    return placed


def _clear_place(sheet: LetteredImage, text: str, at: Array, way: Array, right: float, top: float) -> Array:
    """Middle (2,) of a word, on its `way` (2,) from what it names `at` (2,), whose box covers neither that nor an edge of the
    picture; the `right` one may be that of a colour bar, the `top` one that of the heading."""
    box, high = sheet.box(at, text, _WORD), sheet.size[1]
    half = 0.5 * np.array([box.right - box.left, box.bottom - box.top])
    far = max(float((half / np.maximum(np.abs(way), 1e-9)).min()) + _CLEAR * high, 0.028 * high)
    first, last = half + np.array([_CLEAR * high, top]), np.array([right, (1.0 - _CLEAR) * high]) - half
    return np.asarray(np.clip(at + far * way, first, np.maximum(last, first)))


@dataclass(frozen=True)
class _Entry:
    """What a legend says of a colour, and how that is drawn: an area, a line so many points wide, or a dot of so many."""

    text: str
    colour: str
    mark: str
    points: float = 0.0

    def width(self, sheet: LetteredImage) -> float:
        """Pixels that it takes in a row."""
        return (_MARK + _GAP) * _ENTRY * sheet.point + sheet.width(self.text, _ENTRY)

    def draw(self, sheet: LetteredImage, left: float, y: float) -> None:
        """Draw it from a place on to the right, and so much above as below it."""
        unit = _ENTRY * sheet.point
        right = left + _MARK * unit
        if self.mark == "area":
            sheet.fill(PixelBox(left, y - 0.35 * unit, right, y + 0.35 * unit).corners, self.colour)
        elif self.mark == "line":
            sheet.line((left, y), (right, y), self.points, self.colour, rim=False)
        else:
            sheet.disc(((left + right) / 2, y), self.points, self.colour)
        sheet.text((right + _GAP * unit, y), self.text, _ENTRY, across=0.0)


@dataclass(frozen=True)
class _Heading:
    """Title and legend of a picture and the `height` in pixels that they take; `first` is the middle of the legend's first row."""

    title: str
    rows: tuple[tuple[_Entry, ...], ...]
    first: float
    height: int

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int]) -> _Heading:
        """That of a scene for a picture of a `size`, without any height where there is neither."""
        entries = [_Entry(area.label, area.colour, "area") for area in scene.areas if area.label]
        entries += [_Entry(curve.label, curve.colour, "line", curve.width) for curve in scene.curves if curve.label]
        entries += [_Entry(dots.label, dots.colour, "dot", 6.0) for dots in scene.dots if dots.label]
        if not entries and not scene.title:
            return cls("", (), 0.0, 0)
        sheet, high = LetteredImage(size), size[1]
        title = break_lines(scene.title, lambda text: sheet.width(text, _TITLE) <= WIDEST * size[0])
        bottom = _FIRST * high + (sheet.height(title, _TITLE) if title else 0.0)
        rows = _rows(sheet, entries)
        # rows stand one below the other, and all of them below the title
        first = max(_LEGEND * high, bottom + 0.5 * _ROW * high)
        if rows:
            bottom = first + (len(rows) - 1) * _ROW * high + 0.5 * sheet.height("", _ENTRY)
        return cls(title, rows, first, round(bottom + _CLEAR * high))

    def draw(self, sheet: LetteredImage) -> None:
        """Draw it in the middle of the picture's width."""
        wide, high = sheet.size
        sheet.text((0.5 * wide, _FIRST * high), self.title, _TITLE, down=0.0)
        between = _BETWEEN * _ENTRY * sheet.point
        for k, row in enumerate(self.rows):
            left = 0.5 * (wide - sum(entry.width(sheet) for entry in row) - between * (len(row) - 1))
            for entry in row:
                entry.draw(sheet, left, self.first + k * _ROW * high)
                left += entry.width(sheet) + between


def _rows(sheet: LetteredImage, entries: list[_Entry]) -> tuple[tuple[_Entry, ...], ...]:
    """Entries of a legend in rows that are not wider than the picture."""
    rows: list[list[_Entry]] = []
    between, left = _BETWEEN * _ENTRY * sheet.point, 0.0
    for entry in entries:
        if not rows or len(rows[-1]) == _COLUMNS or left + entry.width(sheet) > WIDEST * sheet.size[0]:
            rows.append([])
            left = 0.0
        rows[-1].append(entry)
        left += entry.width(sheet) + between
    return tuple(map(tuple, rows))


def _draw_axes(sheet: LetteredImage, camera: Camera) -> None:
    """The frame's x, y and z directions in the lower left corner, nearest last."""
    high = sheet.size[1]
    centre, length = np.array([0.078, 1.0 - 0.078]) * high, 0.046 * high
    taken: list[Array] = []
    for k in np.argsort(camera.axes[2]):
        colour = ("#c0392b", CURVES[2], CURVES[0])[k]
        tip = camera.axes[:2, k] * (1.0, -1.0)
        sheet.line(centre, centre + length * tip, 2.0, colour)
        if np.hypot(*tip) > 0.25:
            place = centre + (length + 0.018 * high) * tip
            if any(np.hypot(*(place - other)) < 0.022 * high for other in taken):
                place = place + np.array([0.022 * high, 0.0])
            taken.append(place)
            sheet.text(place, "xyz"[k], _NUMBER, colour=colour)


def _draw_scale(sheet: LetteredImage, camera: Camera, inner: tuple[int, int]) -> None:
    """A bar of a round length, at most a seventh of the picture's width, in the lower right corner of what the camera sees."""
    (wide, high), pixel = sheet.size, camera.height / inner[1]
    power = 10.0 ** np.floor(np.log10(wide * pixel / 7))
    length = max(step * power for step in (1, 2, 5) if step * power <= wide * pixel / 7)
    right, y, tick = inner[0] - 0.02 * wide, 0.97 * high, 0.008 * high
    left = right - length / pixel
    sheet.line((left, y), (right, y), 1.5)
    for x in (left, right):
        sheet.line((x, y - tick), (x, y + tick), 1.5)
    sheet.text(((left + right) / 2, y - 0.012 * high), f"{length:g} mm", _NUMBER, down=1.0)


def _draw_colour_bar(sheet: LetteredImage, value_map: ValueMap) -> None:
    """Colours from 0, below, to the map's limit, with round values beside them and what they are."""
    wide, high = sheet.size
    box = PixelBox((BESIDE_BAR + 0.02) * wide, 0.2 * high, (BESIDE_BAR + 0.042) * wide, 0.85 * high)
    sheet.paste(colour_table()[::-1, None, :3], box)
    for begin, end in zip(box.corners, np.roll(box.corners, 1, axis=0), strict=True):
        sheet.line(begin, end, 0.8, rim=False)
    values, numbers = ticks(value_map.limit)
    tick, gap = 3.5 * sheet.point, 3.5 * sheet.point
    for value, number in zip(values, numbers, strict=True):
        y = box.bottom - value / value_map.limit * (box.bottom - box.top)
        sheet.line((box.right, y), (box.right + tick, y), 0.8, rim=False)
        sheet.text((box.right + tick + gap, y), number, _NUMBER, across=0.0)
    beside = box.right + tick + gap + max(sheet.width(number, _NUMBER) for number in numbers) + gap
    sheet.text_upwards((beside, (box.top + box.bottom) / 2), value_map.label, _LABEL)
