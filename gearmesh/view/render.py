"""The renderer of scenes: VTK draws the bodies in a process of its own, Pillow letters the picture.

The lettering (title, legend, colour bar, scale, axes) is two-dimensional and never covers the middle of the picture.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmesh.errors import OutputError
from gearmesh.formats import PNG_SUFFIX
from gearmesh.io.png import write_png
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.view.lettering import MAX_TITLE_WIDTH_SHARE, break_lines
from gearmesh.view.offscreen.colour_tables import colour_table
from gearmesh.view.offscreen.finish import finish
from gearmesh.view.offscreen.letters import Image, LetteredImage, PixelBox, ticks
from gearmesh.view.offscreen.shapes import drawing_order
from gearmesh.view.opengl import draw
from gearmesh.view.palette import CURVE_COLOURS, MARKING_COLOUR, RUBBED_COLOUR
from gearmesh.view.scene import BODIES_WIDTH_SHARE, Camera, Scene, ValueMap, beside_bar

#: suffixes of the files that can be written
_PICTURE_SUFFIXES = (PNG_SUFFIX, ".jpg", ".jpeg", ".tif", ".tiff")


def render(scene: Scene, path: Path | str | None = None, size: tuple[int, int] | None = None) -> Image:
    """Return the picture of a scene as RGB pixels (H, W, 3), and write it to `path` if given.

    The suffix of the path selects PNG, JPEG or TIFF. `size` in pixels, width by height, overrides the scene's. Equal
    scenes give equal pixels. Raises OutputError if the file cannot be written, and if OpenGL does not work: VTK would
    end the process.
    """
    if path is not None and Path(path).suffix.lower() not in _PICTURE_SUFFIXES:
        raise OutputError(
            "cannot write", path, reason=f"the suffix of a picture must be {', '.join(_PICTURE_SUFFIXES)}"
        )
    size = size or scene.size
    heading = _Heading.of(scene, size)
    # a heading higher than the room left by scenes gets additional height
    above = max(0, heading.height - round(_HEADING_SHARE * size[1]))
    inner = beside_bar(size)[0] if scene.maps else size[0], size[1] - above
    tell(0.2)
    photograph = _photograph(scene, inner)
    tell(0.8)
    # heading and colour bar are on white, not on the teeth
    image = np.pad(photograph, ((above, 0), (0, size[0] - inner[0]), (0, 0)), constant_values=255)
    image[: heading.height] = 255
    image = _letter(image, scene, heading, inner)
    if path is not None:
        from gearmesh.io.atomic import whole_file

        with whole_file(path) as unfinished:
            if Path(path).suffix.lower() == PNG_SUFFIX:
                write_png(unfinished, image, shaded=True)
            else:
                from PIL import Image as pillow

                pillow.fromarray(image).save(unfinished)
    return image


def _photograph(scene: Scene, size: tuple[int, int]) -> Image:
    """Return the three-dimensional part of the picture, (H, W, 3)."""
    order = drawing_order(scene, size)
    return finish(scene, order, draw(order), size)


# --- lettering ---

#: share of a picture's height that scenes leave for a heading: a title of one line and a legend of one row
_HEADING_SHARE = 0.09
#: top of the title, as a share of the picture's height
_TITLE_TOP = 0.015
#: middle of the legend's first row below a title of one line, as a share of the picture's height
_LEGEND_MIDDLE = 0.055
#: height of a row of the legend, as a share of the picture's height
_ROW_HEIGHT = 0.031
#: largest number of entries in a row of the legend
_MAX_COLUMNS = 4
#: size of the letters of a title
_TITLE_POINTS = 13.0
#: size of the letters of words
_WORD_POINTS = 12.0
#: size of the letters of the legend
_ENTRY_POINTS = 10.5
#: size of the letters of the colour bar's label
_LABEL_POINTS = 11.0
#: size of the letters of numbers
_NUMBER_POINTS = 10.0
#: width of an entry's mark, in heights of its letters
_MARK_WIDTH = 2.0
#: gap after the mark, in heights of the letters
_MARK_GAP = 0.8
#: gap before the next entry, in heights of the letters
_ENTRY_GAP = 2.0
#: smallest distance of a word's place from the picture's edges, as shares of its width and height
_EDGE_MARGINS = (0.035, 0.03)
#: distance of a word from its point and from the edges, as a share of the picture's height
_WORD_CLEARANCE = 0.009


def _letter(image: Image, scene: Scene, heading: _Heading, inner: tuple[int, int]) -> Image:
    """Return the picture with title and legend on top, colour bar at the side, axes, scale and words; none has a frame.

    The camera sees the lower left part of the size `inner`.
    """
    sheet = LetteredImage((image.shape[1], image.shape[0]), image)
    if scene.maps:
        _draw_colour_bar(sheet, scene.maps[0])
    heading.draw(sheet)
    for place, text, across in _placed_words(sheet, scene, inner):
        sheet.text(place, text, _WORD_POINTS, across=across)
    _draw_axes(sheet, scene.camera)
    if scene.camera.parallel:
        _draw_scale(sheet, scene.camera, inner)
    return sheet.pixels()


def _placed_words(sheet: LetteredImage, scene: Scene, inner: tuple[int, int]) -> list[tuple[Array, str, float]]:
    """Places (2,) in pixels, words, and the share of each word's width that is left of its place.

    A word lies wholly beyond its point. If the point is outside of the picture, the word is at the edge, with an arrow.
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
        top = above + _HEADING_SHARE * size[1]
        low = _EDGE_MARGINS[0] * size[0], top + 0.035 * size[1]
        kept = np.clip(place, low, (inner[0] - _EDGE_MARGINS[0] * size[0], (1.0 - _EDGE_MARGINS[1]) * size[1]))
        if not word.beyond and np.abs((kept - place) / size).max() <= 0.03:
            placed.append((_clear_place(sheet, word.text, at, way, inner[0], top), word.text, 0.5))
        elif at[0] < 0.5 * size[0] if word.beyond else way[0] < 0.0:
            placed.append((kept, f"\N{LEFTWARDS ARROW} {word.text}", 0.0))
        else:
            placed.append((kept, f"{word.text} \N{RIGHTWARDS ARROW}", 1.0))
    return _apart(sheet, placed)


def _apart(sheet: LetteredImage, words: list[tuple[Array, str, float]]) -> list[tuple[Array, str, float]]:
    """Return words, each moved up or down so far that it does not meet those before it, as names of axes one behind the
    other would.
    """
    placed: list[tuple[Array, str, float]] = []
    boxes: list[PixelBox] = []
    gap = _WORD_CLEARANCE * sheet.size[1]
    for place, text, across in words:
        for other in boxes:
            box = sheet.box(place, text, _WORD_POINTS, across)
            if box.left < other.right and other.left < box.right:
                down, up = other.bottom + gap - box.top, box.bottom + gap - other.top
                if min(down, up) > 0.0:
                    place = place + np.array([0.0, down if down < up else -up])
        boxes.append(sheet.box(place, text, _WORD_POINTS, across))
        placed.append((place, text, across))
    return placed


def _clear_place(sheet: LetteredImage, text: str, at: Array, way: Array, right: float, top: float) -> Array:
    """Middle (2,) of a word beyond its point `at` (2,), in the direction `way` (2,).

    Its box covers neither the point nor an edge of the picture. `right` may be the edge of a colour bar, `top` the edge
    of the heading.
    """
    box, high = sheet.box(at, text, _WORD_POINTS), sheet.size[1]
    half = 0.5 * np.array([box.right - box.left, box.bottom - box.top])
    far = max(float((half / np.maximum(np.abs(way), 1e-9)).min()) + _WORD_CLEARANCE * high, 0.028 * high)
    first, last = (
        half + np.array([_WORD_CLEARANCE * high, top]),
        np.array([right, (1.0 - _WORD_CLEARANCE) * high]) - half,
    )
    return np.asarray(np.clip(at + far * way, first, np.maximum(last, first)))


@dataclass(frozen=True)
class _Entry:
    """An entry of the legend: a mark and its text."""

    #: text beside the mark
    text: str
    #: colour of the mark
    colour: str
    #: kind of the mark: area, line or dot
    mark: str
    #: width of a line or diameter of a dot, points
    points: float = 0.0

    def width(self, sheet: LetteredImage) -> float:
        """Width in a row, pixels."""
        return (_MARK_WIDTH + _MARK_GAP) * _ENTRY_POINTS * sheet.point + sheet.width(self.text, _ENTRY_POINTS)

    def draw(self, sheet: LetteredImage, left: float, y: float) -> None:
        """Draw the entry to the right of `left`, with its middle at the height `y`."""
        unit = _ENTRY_POINTS * sheet.point
        right = left + _MARK_WIDTH * unit
        if self.mark == "area":
            sheet.fill(PixelBox(left, y - 0.35 * unit, right, y + 0.35 * unit).corners, self.colour)
        elif self.mark == "line":
            sheet.line((left, y), (right, y), self.points, self.colour, rim=False)
        else:
            sheet.disc(((left + right) / 2, y), self.points, self.colour)
        sheet.text((right + _MARK_GAP * unit, y), self.text, _ENTRY_POINTS, across=0.0)


@dataclass(frozen=True)
class _Heading:
    """Title and legend of a picture."""

    #: title, with line breaks
    title: str
    #: entries of the legend, row by row
    rows: tuple[tuple[_Entry, ...], ...]
    #: middle of the legend's first row, pixels from the top
    first: float
    #: height of the heading, pixels
    height: int

    @classmethod
    def of(cls, scene: Scene, size: tuple[int, int]) -> _Heading:
        """Return the heading of a scene for a picture of a `size`; its height is 0 without title and legend."""
        entries = [_Entry(area.label, area.colour, "area") for area in scene.areas if area.label]
        for film in scene.films:
            entries.append(_Entry(film.label, MARKING_COLOUR, "area"))
            entries.append(_Entry(film.rubbed_label, RUBBED_COLOUR, "area"))
        entries += [_Entry(curve.label, curve.colour, "line", curve.width) for curve in scene.curves if curve.label]
        entries += [_Entry(dots.label, dots.colour, "dot", 6.0) for dots in scene.dots if dots.label]
        if not entries and not scene.title:
            return cls("", (), 0.0, 0)
        sheet, high = LetteredImage(size), size[1]
        title = break_lines(
            scene.title, lambda text: sheet.width(text, _TITLE_POINTS) <= MAX_TITLE_WIDTH_SHARE * size[0]
        )
        bottom = _TITLE_TOP * high + (sheet.height(title, _TITLE_POINTS) if title else 0.0)
        rows = _rows(sheet, entries)
        # the rows are below the title
        first = max(_LEGEND_MIDDLE * high, bottom + 0.5 * _ROW_HEIGHT * high)
        if rows:
            bottom = first + (len(rows) - 1) * _ROW_HEIGHT * high + 0.5 * sheet.height("", _ENTRY_POINTS)
        return cls(title, rows, first, round(bottom + _WORD_CLEARANCE * high))

    def draw(self, sheet: LetteredImage) -> None:
        """Draw the heading, centred on the picture's width."""
        wide, high = sheet.size
        sheet.text((0.5 * wide, _TITLE_TOP * high), self.title, _TITLE_POINTS, down=0.0)
        between = _ENTRY_GAP * _ENTRY_POINTS * sheet.point
        for k, row in enumerate(self.rows):
            left = 0.5 * (wide - sum(entry.width(sheet) for entry in row) - between * (len(row) - 1))
            for entry in row:
                entry.draw(sheet, left, self.first + k * _ROW_HEIGHT * high)
                left += entry.width(sheet) + between


def _rows(sheet: LetteredImage, entries: list[_Entry]) -> tuple[tuple[_Entry, ...], ...]:
    """Return the entries of a legend in rows that are not wider than the picture."""
    rows: list[list[_Entry]] = []
    between, left = _ENTRY_GAP * _ENTRY_POINTS * sheet.point, 0.0
    for entry in entries:
        if (
            not rows
            or len(rows[-1]) == _MAX_COLUMNS
            or left + entry.width(sheet) > MAX_TITLE_WIDTH_SHARE * sheet.size[0]
        ):
            rows.append([])
            left = 0.0
        rows[-1].append(entry)
        left += entry.width(sheet) + between
    return tuple(map(tuple, rows))


def _draw_axes(sheet: LetteredImage, camera: Camera) -> None:
    """Draw the x, y and z directions of the frame in the lower left corner, the nearest last."""
    high = sheet.size[1]
    centre, length = np.array([0.078, 1.0 - 0.078]) * high, 0.046 * high
    taken: list[Array] = []
    for k in np.argsort(camera.axes[2]):
        colour = ("#c0392b", CURVE_COLOURS[2], CURVE_COLOURS[0])[k]
        tip = camera.axes[:2, k] * (1.0, -1.0)
        sheet.line(centre, centre + length * tip, 2.0, colour)
        if np.hypot(*tip) > 0.25:
            place = centre + (length + 0.018 * high) * tip
            if any(np.hypot(*(place - other)) < 0.022 * high for other in taken):
                place = place + np.array([0.022 * high, 0.0])
            taken.append(place)
            sheet.text(place, "xyz"[k], _NUMBER_POINTS, colour=colour)


def _draw_scale(sheet: LetteredImage, camera: Camera, inner: tuple[int, int]) -> None:
    """Draw a bar of a round length in the lower right corner of the camera's part, at most a seventh of the width.

    The bar measures along the camera's `measured` direction if there is one.
    """
    (wide, high), pixel, words = sheet.size, camera.height / inner[1], ""
    if camera.measured is not None:
        pixel, words = pixel / float(np.hypot(*(camera.axes[:2] @ camera.measured))), " along the tooth"
    power = 10.0 ** np.floor(np.log10(wide * pixel / 7))
    length = max(step * power for step in (1, 2, 5) if step * power <= wide * pixel / 7)
    right, y, tick = inner[0] - 0.02 * wide, 0.97 * high, 0.008 * high
    left = right - length / pixel
    sheet.line((left, y), (right, y), 1.5)
    for x in (left, right):
        sheet.line((x, y - tick), (x, y + tick), 1.5)
    place = (right, y - 0.012 * high) if words else ((left + right) / 2, y - 0.012 * high)
    sheet.text(place, f"{length:g} mm{words}", _NUMBER_POINTS, across=1.0 if words else 0.5, down=1.0)


def _draw_colour_bar(sheet: LetteredImage, value_map: ValueMap) -> None:
    """Draw the colours from 0, at the bottom, to the map's limit, with round values and the label beside them."""
    wide, high = sheet.size
    box = PixelBox((BODIES_WIDTH_SHARE + 0.02) * wide, 0.2 * high, (BODIES_WIDTH_SHARE + 0.042) * wide, 0.85 * high)
    sheet.paste(colour_table(value_map.colours)[::-1, None, :3], box)
    for begin, end in zip(box.corners, np.roll(box.corners, 1, axis=0), strict=True):
        sheet.line(begin, end, 0.8, rim=False)
    values, numbers = ticks(value_map.limit)
    tick, gap = 3.5 * sheet.point, 3.5 * sheet.point
    for value, number in zip(values, numbers, strict=True):
        y = box.bottom - value / value_map.limit * (box.bottom - box.top)
        sheet.line((box.right, y), (box.right + tick, y), 0.8, rim=False)
        sheet.text((box.right + tick + gap, y), number, _NUMBER_POINTS, across=0.0)
    beside = box.right + tick + gap + max(sheet.width(number, _NUMBER_POINTS) for number in numbers) + gap
    sheet.text_upwards((beside, (box.top + box.bottom) / 2), value_map.label, _LABEL_POINTS)
