"""Rows of panels to scale: words and numbers have the room that they need, and contents fill the rest.

Matplotlib's constrained layout neither knows that axes to scale are smaller than their cells, nor which arrangement of
panels fills a picture. Here all room is counted in inches, and letters in small pictures stay legible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from gearmesh.records import dataclass
from gearmesh.view.diagrams.plots import LEGIBLE_DPI, TITLE_POINTS, new_figure
from gearmesh.view.lettering import break_lines
from gearmesh.view.palette import INK_COLOUR

#: size of labels, and of the legend's letters
LABEL_POINTS = 9.0
#: size of numbers at axes
NUMBER_POINTS = 8.0
#: size of titles of panels
NAME_POINTS = 10.0
#: distance of lines of a text, in sizes of its letters
LINE_SPACING = 1.35
#: room left of contents, before their numbers and labels are known
FIRST_LEFT_INCHES = 0.65
#: room of ticks and gaps beside numbers and labels
TICK_ROOM_INCHES = 0.22
#: room right of contents without and with a colour bar of their own
RIGHT_INCHES = (0.16, 0.62)
#: room below contents for numbers, and for a label besides
NUMBER_ROOM_INCHES, X_LABEL_INCHES = 0.27, 0.2
#: room above contents, beside the lines of their title
ABOVE_INCHES = 0.14
#: gap above and below titles and legends of figures
EDGE_GAP_INCHES = 0.09
#: width of the mark of a legend's entry, with its gaps
MARK_INCHES = 0.55
#: share of the width of a figure that its title and legend take at most
WORDS_SHARE = 0.97
#: share of the width of a cell that a line of its words takes at most
CELL_WORDS_SHARE = 0.9
#: smallest share of a figure that contents take; letters shrink in figures that are too small
MIN_CONTENT_SHARE = 0.12
#: pixels per inch of the smallest letters that are tried, as a share of legible ones, and ratio of a step towards them
SMALLEST_LETTERS, LETTER_STEP = 0.4, 0.93
#: share of the needed room in which a figure has letters of its own size
OWN_ROOM_SHARE = 0.8
#: rounds in which shapes of contents and their widths are found
SHAPE_ROUNDS = 4
#: smallest ratio by which contents shrink, and their smallest width in inches
SMALLEST_SCALE = 0.02
#: gain of contents for which another arrangement replaces the given one
WORTHWHILE_GAIN = 1.15


@dataclass(frozen=True)
class PanelSlot:
    """Shape of a panel's content."""

    #: height of the content over its width
    shape: float
    #: False: the content is as wide as its cell, whatever its height
    to_scale: bool = True
    #: True with a colour bar at the right
    bar: bool = False


@dataclass(frozen=True)
class Arrangement:
    """Rows of panels, and how their shapes follow from their width."""

    #: slots by rows, for contents of a width (inches)
    slots: Callable[[float], list[list[PanelSlot]]]
    #: width of a figure without a given size, inches
    width: float


@dataclass(frozen=True)
class _Rooms:
    """Room for words, inches."""

    #: left of contents, by columns
    left: list[float]
    #: above contents, by rows
    above: list[float]
    #: below contents, by rows
    below: list[float]
    #: of the figure's title
    top: float
    #: of the figure's legend
    bottom: float
    #: right of all panels
    aside: float


@dataclass(frozen=True)
class _Plan:
    """Places of contents in a figure."""

    #: boxes (left, bottom, width, height) by rows, inches
    boxes: list[list[tuple[float, float, float, float]]]
    #: left and right ends of their cells by rows, inches
    cells: list[list[tuple[float, float]]]
    #: width and height of the figure, inches
    inches: tuple[float, float]

    @property
    def share(self) -> float:
        """Share of the figure that contents take."""
        return sum(box[2] * box[3] for row in self.boxes for box in row) / (self.inches[0] * self.inches[1])


def _plan(arrangement: Arrangement, rooms: _Rooms, width: float, height: float | None) -> _Plan:
    """Place contents in a figure of a width and height (None: as high as it needs), inches."""
    fixed = rooms.top + rooms.bottom + sum(rooms.above) + sum(rooms.below)
    # shapes depend a little on widths, which depend on shapes
    seen = width / len(rooms.left)
    for _ in range(SHAPE_ROUNDS):
        slots = arrangement.slots(seen)
        columns = [_columns(slots, row, rooms.left, width - rooms.aside) for row in slots]
        full = [content * max(slot.shape for slot in row) for row, (_, content) in zip(slots, columns, strict=True)]
        scale = 1.0 if height is None else min(1.0, max((height - fixed) / sum(full), SMALLEST_SCALE))
        seen = scale * min(content for _, content in columns)
    height = fixed + sum(full) if height is None else height
    spare = max(height - fixed - scale * sum(full), 0.0) / len(slots)
    boxes, cells, floor = [], [], height - rooms.top
    for k, (row, (starts, content), most) in enumerate(zip(slots, columns, full, strict=True)):
        floor -= rooms.above[k] + 0.5 * spare + scale * most
        of_row = []
        for slot, start in zip(row, starts, strict=True):
            wide, high = (scale if slot.to_scale else 1.0) * content, scale * content * slot.shape
            of_row.append((start + 0.5 * (content - wide), floor + 0.5 * (scale * most - high), wide, high))
        boxes.append(of_row)
        ends = [start - room for start, room in zip(starts, rooms.left, strict=False)] + [width - rooms.aside]
        cells.append(list(pairwise(ends)))
        floor -= rooms.below[k] + 0.5 * spare
    return _Plan(boxes, cells, (width, height))


def _columns(
    slots: Sequence[Sequence[PanelSlot]], row: Sequence[PanelSlot], left: Sequence[float], wide: float
) -> tuple[list[float], float]:
    """Left ends of the contents of a row, and their width; aligned over rows of as many panels."""
    alike = [other for other in slots if len(other) == len(row)]
    right = [RIGHT_INCHES[any(other[k].bar for other in alike)] for k in range(len(row))]
    content = max((wide - sum(right) - sum(left[: len(row)])) / len(row), SMALLEST_SCALE)
    ends = np.cumsum([room + content + beside for room, beside in zip(left, right, strict=False)])
    return [float(end - content - beside) for end, beside in zip(ends, right, strict=True)], content


def text_inches(figure: Any, text: str, points: float) -> float:
    """Width of a line of text in letters of a size."""
    from matplotlib.font_manager import FontProperties

    renderer = figure.canvas.get_renderer()
    return float(
        renderer.get_text_width_height_descent(text, FontProperties(size=points), ismath=False)[0] / figure.dpi
    )


def _lines(figure: Any, text: str, points: float, inches: float) -> tuple[str, float]:
    """Return a text in lines of at most a width, and the height of the lines, inches."""
    text = break_lines(text, lambda line: text_inches(figure, line, points) <= inches)
    return text, (text.count("\n") + 1) * LINE_SPACING * points / 72.0 if text else 0.0


class PanelRows:
    """A figure of rows of panels, of a size in pixels or of the size that it needs.

    The caller draws on `axes`, with titles, labels and entries of the legend; `finish` finds room for these.
    """

    def __init__(
        self,
        arrangements: Sequence[Arrangement],
        size: tuple[int, int] | None,
        dpi: float,
        *,
        titled: bool = True,
        aside: float = 0.0,
    ) -> None:
        """Choose the arrangement that fills a size best (the first without a size), and make the figure.

        `aside` is room (inches) at the right of all panels.
        """
        line, below = LINE_SPACING / 72.0, NUMBER_ROOM_INCHES + X_LABEL_INCHES
        self._size, self._aside = size, aside

        def first(arrangement: Arrangement) -> _Rooms:
            slots = arrangement.slots(arrangement.width)
            above, left = [line * NAME_POINTS + ABOVE_INCHES] * len(slots), [FIRST_LEFT_INCHES] * max(map(len, slots))
            top = line * TITLE_POINTS if titled else 0.0
            gap = 2.0 * EDGE_GAP_INCHES
            return _Rooms(left, above, [below] * len(slots), top + gap, line * LABEL_POINTS + gap, aside)

        plans = []
        for arrangement in arrangements if size is not None else arrangements[:1]:
            rooms = first(arrangement)
            own = _plan(arrangement, rooms, arrangement.width, None)
            if size is None:
                plans.append((own, dpi))
            else:
                plans.append(_fitted(arrangement, rooms, own.inches, size, dpi))
        self.index = 0
        for k, (plan, dots) in enumerate(plans):
            best, most = plans[self.index]
            if plan.share * min(dots, LEGIBLE_DPI) > WORTHWHILE_GAIN * best.share * min(most, LEGIBLE_DPI):
                self.index = k
        plan, dots = plans[self.index]
        self._arrangement = arrangements[self.index]
        self.figure = new_figure(plan.inches, dots, layout=None)
        self.axes = [[self.figure.add_axes(_shares(box, plan.inches)) for box in row] for row in plan.boxes]

    def finish(self, title: str, fit: Callable[[Any, float], None]) -> None:
        """Write title and legend, and place everything; `fit` sets the limits of axes for a width in inches."""
        figure = self.figure
        width, height = figure.get_size_inches()
        title, high = _lines(figure, title, TITLE_POINTS, WORDS_SHARE * width)
        gap = EDGE_GAP_INCHES
        if title:
            figure.suptitle(title, color=INK_COLOUR, fontsize=TITLE_POINTS, y=1.0 - gap / height, va="top")
        bottom = self._write_legend()
        below = self._below()
        rooms = _Rooms(self._left(), self._above(), below, high + (2.0 if title else 1.0) * gap, bottom, self._aside)
        plan = _plan(self._arrangement, rooms, width, None if self._size is None else height)
        figure.set_size_inches(plan.inches)
        if title:
            figure.suptitle(title, color=INK_COLOUR, fontsize=TITLE_POINTS, y=1.0 - gap / plan.inches[1], va="top")
        if figure.legends:
            figure.legends[0].set_bbox_to_anchor((0.5, 0.5 * gap / plan.inches[1]), transform=figure.transFigure)
        for row, boxes, cells in zip(self.axes, plan.boxes, plan.cells, strict=True):
            for axes, box, (left, right) in zip(row, boxes, cells, strict=True):
                axes.set_position(_shares(box, plan.inches))
                fit(axes, box[2])
                axes.apply_aspect()
                # the title is above the middle of the content, as far as it has room there
                widths = [text_inches(figure, line, NAME_POINTS) for line in axes.get_title().split("\n")]
                middle, half = box[0] + 0.5 * box[2], 0.5 * max(widths)
                moved = max(min(middle, right - half), left + half) - middle
                axes.title.set_x(0.5 + moved / box[2])

    def width(self, axes: Any) -> float:
        """Width of the content of axes, inches."""
        return float(axes.get_position(original=True).width * self.figure.get_size_inches()[0])

    def _above(self) -> list[float]:
        """Break titles of panels into lines that fit; return the room above contents by rows, inches."""
        wide = float(self.figure.get_size_inches()[0]) - self._aside
        rooms = []
        for row in self.axes:
            highest = 0.0
            for axes in row:
                lines, high = _lines(self.figure, axes.get_title(), NAME_POINTS, CELL_WORDS_SHARE * wide / len(row))
                # a height of its own: otherwise all numbers are measured again, in case some stand above the axes
                axes.set_title(lines, fontsize=NAME_POINTS, color=INK_COLOUR, y=1.0)
                highest = max(highest, high)
            rooms.append(highest + ABOVE_INCHES)
        return rooms

    def _below(self) -> list[float]:
        """Leave out labels of lengths that stand below, too; return the room below contents by rows, inches."""
        for row, under in pairwise(self.axes):
            for axes, other in zip(row, under, strict=False):
                if len(row) == len(under) and axes.get_xlabel() == other.get_xlabel():
                    axes.set_xlabel("")
        wide, rooms = float(self.figure.get_size_inches()[0]) - self._aside, []
        for row in self.axes:
            highest = 0.0
            for axes in row:
                lines, high = _lines(self.figure, axes.get_xlabel(), LABEL_POINTS, CELL_WORDS_SHARE * wide / len(row))
                axes.set_xlabel(lines, fontsize=LABEL_POINTS)
                highest = max(highest, high)
            rooms.append(NUMBER_ROOM_INCHES + highest)
        return rooms

    def _left(self) -> list[float]:
        """Break labels of heights into lines that fit; return the room left of contents by columns, inches."""
        rooms = [0.0] * max(map(len, self.axes))
        for row in self.axes:
            # from the right: the label at the left stays
            for before, axes in reversed(list(pairwise(row))):
                if axes.get_ylabel() == before.get_ylabel():
                    axes.set_ylabel("")
        high = float(self.figure.get_size_inches()[1])
        for k, axes in ((k, axes) for row in self.axes for k, axes in enumerate(row)):
            axes.tick_params(labelsize=NUMBER_POINTS)
            tall = axes.get_position().height * high + NUMBER_ROOM_INCHES
            lines, across = _lines(self.figure, axes.get_ylabel(), LABEL_POINTS, tall)
            axes.set_ylabel(lines, fontsize=LABEL_POINTS)
            numbers = max((text_inches(self.figure, text, NUMBER_POINTS) for text in _numbers(axes.yaxis)), default=0.0)
            rooms[k] = max(rooms[k], numbers + across + TICK_ROOM_INCHES)
        return rooms

    def _write_legend(self) -> float:
        """Write the legend in as many columns as fit; return its room at the bottom, inches."""
        handles = {
            label: handle
            for axes in self.figure.axes
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        gap = EDGE_GAP_INCHES
        if not handles:
            return gap
        wide = WORDS_SHARE * float(self.figure.get_size_inches()[0])
        entries = [text_inches(self.figure, label, LABEL_POINTS) + MARK_INCHES for label in handles]
        columns = next((n for n in range(len(entries), 1, -1) if _columns_inches(entries, n) <= wide), 1)
        self.figure.legend(
            handles.values(), handles.keys(), loc="lower center", bbox_to_anchor=(0.5, 0.0), ncols=columns, frameon=False,
            fontsize=LABEL_POINTS, borderaxespad=0.0, borderpad=0.2,
        )  # fmt: skip
        return -(-len(entries) // columns) * 1.15 * LINE_SPACING * LABEL_POINTS / 72.0 + 2.0 * gap


def _columns_inches(entries: Sequence[float], count: int) -> float:
    """Width of entries in columns, filled one after the other as by Matplotlib."""
    return sum(max(float(width) for width in column) for column in np.array_split(np.array(entries), count))


def _numbers(axis: Any) -> Iterator[str]:
    """Numbers at an axis."""
    low, high = sorted(axis.get_view_interval())
    places = axis.get_major_locator()()
    texts = axis.get_major_formatter().format_ticks(places)
    yield from (text for place, text in zip(places, texts, strict=True) if low <= place <= high)


def _shares(box: tuple[float, float, float, float], inches: tuple[float, float]) -> tuple[float, float, float, float]:
    left, bottom, width, height = box
    return left / inches[0], bottom / inches[1], width / inches[0], height / inches[1]


def _fitted(
    arrangement: Arrangement, rooms: _Rooms, needed: tuple[float, float], size: tuple[int, int], dpi: float
) -> tuple[_Plan, float]:
    """Return the plan of a figure of a size in pixels, and its pixels per inch.

    Letters are those of a figure of the `needed` inches or legible, and smaller where contents would have no room.
    """
    own = min(size[0] / needed[0], size[1] / needed[1]) / OWN_ROOM_SHARE
    dots = min(dpi, max(own, LEGIBLE_DPI))
    while True:
        plan = _plan(arrangement, rooms, size[0] / dots, size[1] / dots)
        if plan.share >= MIN_CONTENT_SHARE or dots <= max(own, SMALLEST_LETTERS * LEGIBLE_DPI):
            return plan, dots
        dots *= LETTER_STEP
