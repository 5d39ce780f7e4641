"""Flanks in their planes: a panel with path, ellipses and pattern of contact, or with ease-off or sliding velocity.

Every panel is drawn to scale, with the toe at the left and the tip on top. A flank much longer than high is cut off
beside its contact. If it is still too long, its heights are magnified, and the title gives the factor.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, every_nth
from gearmesh.records import dataclass
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.view.diagrams.flank_plane import FlankPlane
from gearmesh.view.diagrams.panel_rows import Arrangement, PanelRows, PanelSlot
from gearmesh.view.diagrams.plots import save_figure
from gearmesh.view.palette import (
    COMPOUND_COLOUR,
    EDGE_COLOUR,
    FAINT_COLOUR,
    GROUND_COLOUR,
    INK_COLOUR,
    LINE_COLOUR,
    OUTLINE_COLOUR,
    PATH_COLOUR,
    PATTERN_COLOUR,
)
from gearmesh.view.scene import MemberContact

#: arrows of a field, up the profile and along the face
ARROW_GRID = (4, 11)
#: largest number of ellipses that are drawn
MAX_ELLIPSES = 11
#: largest number of contact lines that are drawn
MAX_LINES = 25
#: length of a flank, in its heights, up to which a panel shows all of it
WHOLE_LENGTH_HEIGHTS = 6.0
#: length, in heights, up to which it is drawn to scale
SCALE_LENGTH_HEIGHTS = 7.0
#: width of a figure with one column
FIGURE_WIDTH_INCHES = 10.5
#: height that a number of a colour bar needs
BAR_NUMBER_INCHES = 0.15
#: width of a panel's content down to which the flank's edges are named beside it; room beside smaller flanks
SMALL_PANEL_INCHES, SMALL_ROOM_INCHES = 2.8, (0.1, 0.08)
#: width of a panel's content for which room beside the flank is counted at least
LEAST_PANEL_INCHES = 0.5
#: share of the room around it that the largest arrow takes
ARROW_ROOM_SHARE = 0.9
#: distance within which the edges of two flanks coincide
SAME_EDGE_MM = 1e-6
#: smallest component of arrows in the plane, as a share of the largest amount; below it none are drawn
MIN_ARROW_SHARE = 0.25
#: smallest extent of a line of equal values, as a share of the flank's
MIN_RING_SHARE = 0.03
#: percentiles between which the values of a uniform field lie
UNIFORM_PERCENTILES = (1.0, 99.0)
#: colour of a uniform field
UNIFORM_COLOUR = "#ebd03f"
#: id of the lines of equal values, which are labelled last
RINGS_ID = "rings"
#: id of the areas that cover a field beyond its values
COVER_ID = "cover"
#: room for words beside and above a flank
WORD_ROOM_INCHES = (0.5, 0.25)


@dataclass(frozen=True)
class ContactPanel:
    """A flank with its contact, all in its plane, mm."""

    #: title of the panel
    name: str
    #: the flank and its plane
    plane: FlankPlane
    #: path of contact (P, 2) at the positions, NaN without a point of contact
    path: Array
    #: True (P,) for edge contact
    edge: NDArray[np.bool_]
    #: outlines (E, K, 2) of contact ellipses
    ellipses: Array
    #: contact lines, each (K, 2)
    lines: Sequence[Array] = ()
    #: areas between neighbouring contact lines, each (Q, 4, 2)
    strips: Sequence[Array] = ()
    #: places (I, J, 2) and levels (I, J), at most 1 inside the pattern; None: no ellipses
    pattern: tuple[Array, Array] | None = None
    #: another path (P, 2) to compare with, or None
    nominal: Array | None = None
    #: path of contact (W, 2) at more than the positions, or None
    curve: Array | None = None

    @property
    def extent(self) -> tuple[float, float]:
        """Smallest and largest length with contact; NaN without contact."""
        parts = [
            self.path[:, 0],
            *(() if self.curve is None else (self.curve[:, 0],)),
            self.ellipses[..., 0].ravel(),
            *(line[:, 0] for line in self.lines),
        ]
        parts += [strip[..., 0].ravel() for strip in self.strips]
        if self.pattern is not None:
            parts.append(self.pattern[0][self.pattern[1] <= 1.0, 0])
        lengths = np.concatenate(parts)
        known = lengths[np.isfinite(lengths)]
        return (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)


@dataclass(frozen=True)
class FieldPanel:
    """A quantity over a flank."""

    #: title of the panel
    name: str
    #: the flank and its plane
    plane: FlankPlane
    #: places (I, J, 2), mm
    places: Array
    #: values (I, J), NaN where undefined
    values: Array
    #: range of values below which differences are not significant
    least: float
    #: vectors (I, J, 2) in the plane, or None
    arrows: Array | None = None
    #: values (I, J) continued beyond their end; None: cells without a value stay empty
    continued: Array | None = None
    #: distance (I, J) of a place beyond the end of the values, mm, negative before it; or None
    beyond: Array | None = None
    #: unit of the values
    unit: str = ""
    #: meaning of the arrows, for the legend
    sense: str = ""

    @property
    def is_flat(self) -> bool:
        """True if all values are equal but for insignificant differences; a few nodes may deviate twice as much."""
        known = self.values[np.isfinite(self.values)]
        return (
            bool(known.size)
            and self.range < 2.0 * self.least
            and float(np.ptp(np.percentile(known, UNIFORM_PERCENTILES))) < self.least
        )

    @property
    def range(self) -> float:
        """Largest minus smallest value."""
        return float(np.ptp(self.values[np.isfinite(self.values)]))

    @property
    def extent(self) -> tuple[float, float]:
        """Smallest and largest length with values."""
        lengths = self.places[..., 0]
        return float(lengths.min()), float(lengths.max())


Panel = ContactPanel | FieldPanel


def contact_panel(
    plane: FlankPlane,
    contact: MemberContact,
    name: str,
    whole: MemberContact | None = None,
    nominal: Array | None = None,
) -> ContactPanel:
    """Return the panel of a member's flank with its contact; the pattern is the contact of the `whole` engagement if
    given.

    `nominal` (P, 3), own frame, is another path to compare with.
    """
    whole = contact if whole is None else whole
    return ContactPanel(
        name,
        plane,
        plane.path(contact),
        contact.edge,
        plane.ellipses(contact, every_nth(contact.ellipses, MAX_ELLIPSES)),
        plane.lines(contact),
        plane.swept(whole),
        plane.pattern(whole) if whole.ellipses.size else None,
        None if nominal is None else plane.frame.places(nominal),
        plane.frame.places(contact.path[0]),
    )


def is_long(planes: Sequence[FlankPlane]) -> bool:
    """True if all flanks are so much longer than high that panels fit better above each other than side by side."""
    spans = np.array([np.ptp(plane.frame.outline, axis=0) for plane in planes])
    return bool((spans[:, 0] > 3.0 * spans[:, 1]).all())


def beside(panels: Sequence[Panel]) -> list[list[Panel]]:
    """Return rows of panels: long flanks above each other, short ones side by side."""
    return [[panel] for panel in panels] if is_long([panel.plane for panel in panels]) else [list(panels)]


def plot_flanks(
    file: Path | str,
    rows: Sequence[Sequence[Panel]],
    title: str,
    size: tuple[int, int] | None = None,
    dpi: int = 150,
) -> None:
    """Plot rows of panels as one figure; `size` in pixels, by default the size that the panels need.

    Raises OutputError if the file cannot be written.
    """
    ways = [rows, [list(way) for way in zip(*rows, strict=True)]] if len({len(row) for row in rows}) == 1 else [rows]
    made = PanelRows([_arrangement(way) for way in ways], size, dpi, titled=bool(title))
    shown = {
        axes: panel
        for row, places in zip(ways[made.index], made.axes, strict=True)
        for panel, axes in zip(row, places, strict=True)
    }
    for axes, panel in shown.items():
        width = made.width(axes)
        _draw(axes, panel, _window_of(panel, width), small=width <= SMALL_PANEL_INCHES)

    def fit(axes: Any, width: float) -> None:
        show_window(axes, shown[axes].plane, _window_of(shown[axes], width))

    made.finish(title, fit)
    # labels of lines need free room, which is known when everything else has its place
    for axes, panel in shown.items():
        if isinstance(panel, FieldPanel) and panel.arrows is None:
            _label_rings(axes, panel.plane.frame.outline)
    save_figure(made.figure, file)


def panel_window(flank: Array, extent: tuple[float, float], width: float) -> Window:
    """Return the window of a flank in a content of a width, as `flank_window`; small ones have no room for words."""
    room = WORD_ROOM_INCHES if width > SMALL_PANEL_INCHES else SMALL_ROOM_INCHES
    return flank_window(flank, extent, max(width, LEAST_PANEL_INCHES), room)


def _window_of(panel: Panel, width: float) -> Window:
    return panel_window(panel.plane.frame.extent, panel.extent, width)


def window_shape(window: Window) -> float:
    """Height of a window over its width."""
    (left, right), (low, high), magnified = window
    return (high - low) * magnified / (right - left)


def _arrangement(rows: Sequence[Sequence[Panel]]) -> Arrangement:
    """Return how rows of panels are arranged."""

    def slots(width: float) -> list[list[PanelSlot]]:
        return [
            [
                PanelSlot(
                    window_shape(_window_of(panel, width)), bar=isinstance(panel, FieldPanel) and not panel.is_flat
                )
                for panel in row
            ]
            for row in rows
        ]

    return Arrangement(slots, FIGURE_WIDTH_INCHES if max(map(len, rows)) == 1 else 15.0)


#: factors by which heights can be magnified
HEIGHT_MAGNIFICATIONS = (1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 8.0, 10.0, 15.0, 20.0, 50.0)

Window = tuple[tuple[float, float], tuple[float, float], float]


def flank_window(
    flank: Array, extent: tuple[float, float], width: float, room: tuple[float, float] = WORD_ROOM_INCHES
) -> Window:
    """Return the lengths and heights that a panel of a width (inches) shows, and the magnification of its heights.

    - `flank` (2, 2): smallest and largest length and height of the flank
    - `extent`: smallest and largest length with contact
    - `room`: inches beside and above the flank
    """
    low, high = flank
    height = float(high[1] - low[1])
    left, right = float(low[0]), float(high[0])
    first, last = extent
    if right - left > WHOLE_LENGTH_HEIGHTS * height and np.isfinite(first):
        # too long: the part around the contact that can be drawn to scale
        middle, half = (
            0.5 * (first + last),
            max(0.5 * WHOLE_LENGTH_HEIGHTS * height, 0.5 * (last - first) + 0.5 * height),
        )
        near = max(left, middle - half), min(right, middle + half)
        # an end that the room beside the flank would show is drawn whole, with its name
        aside = room[0] * (near[1] - near[0]) / (width - 2.0 * room[0])
        left = near[0] if near[0] - left > aside else left
        right = near[1] if right - near[1] > aside else right
    wanted = (right - left) / (SCALE_LENGTH_HEIGHTS * height)
    magnified = (
        1.0
        if wanted <= 1.0
        else min(step for step in HEIGHT_MAGNIFICATIONS if step >= min(wanted, HEIGHT_MAGNIFICATIONS[-1]))
    )
    inch = (right - left) / (width - 2.0 * room[0])
    aside, above = room[0] * inch, room[1] * inch / magnified
    return (left - aside, right + aside), (float(low[1]) - above, float(high[1]) + above), magnified


def _draw(axes: Any, panel: Panel, window: Window, *, small: bool) -> None:
    plane = panel.plane
    if isinstance(panel, ContactPanel):
        draw_contact(axes, panel, small)
    else:
        _draw_field(axes, panel)
    draw_outline(axes, plane, window)
    (left, right), _, magnified = window
    notes = [f"{magnified:g} times as high"] if magnified > 1.0 else []
    if isinstance(panel, FieldPanel) and panel.is_flat:
        notes.insert(0, f"uniform within {max(panel.least, np.ceil(10.0 * panel.range) / 10.0):g} {panel.unit}")
    low, high = plane.frame.outline[:, 0].min(), plane.frame.outline[:, 0].max()
    if left > low or right < high:
        notes.append(f"cut off: flank from {low:.4g} to {high:.4g} mm")
    axes.set_title(panel.name + (f"  ({', '.join(notes)})" if notes else ""))
    label_plane(axes, plane, (left, right), small=small)


def label_plane(axes: Any, plane: FlankPlane, seen: tuple[float, float], *, small: bool) -> None:
    """Label the axes of a flank's plane, and name the flank's edges; in a `small` panel by the label of lengths."""
    axes.set(xlabel=plane.labels[0], ylabel=plane.labels[1])
    if small:
        # toe and heel are always at the left and right, the tip is on top
        axes.set_xlabel(f"toe \N{LEFTWARDS ARROW} {plane.labels[0]} \N{RIGHTWARDS ARROW} heel")
    else:
        name_edges(axes, plane.frame, seen)


def draw_outline(axes: Any, plane: FlankPlane, window: Window) -> None:
    """Draw a flank's ground and outline, toe at the left and tip on top, in a window of `flank_window`."""
    from matplotlib.patches import Polygon

    axes.add_artist(Polygon(plane.frame.outline, facecolor=GROUND_COLOUR, edgecolor="none", zorder=0))
    axes.plot(*plane.frame.outline.T, color=INK_COLOUR, lw=1.3, zorder=6)
    show_window(axes, plane, window)


def show_window(axes: Any, plane: FlankPlane, window: Window) -> None:
    """Set the limits of axes to a window of `flank_window`, toe at the left and tip on top."""
    lengths, heights, magnified = window
    to_left, downwards = plane.frame.inverted
    axes.set_xlim(lengths[::-1] if to_left else lengths)
    axes.set_ylim(heights[::-1] if downwards else heights)
    axes.set_aspect(magnified, adjustable="box")


def name_edges(axes: Any, frame: FlankFrame, seen: tuple[float, float], size: float = 9.0) -> None:
    """Write toe, heel, tip and root outside of the flank; toe and heel only if they are in the window."""
    aside = {"toe": (-5, 0, "right", "center"), "heel": (5, 0, "left", "center"),
             "tip": (0, 3, "center", "bottom"), "root": (0, -3, "center", "top")}  # fmt: skip
    middle = 0.5 * sum(seen)
    for word, (dx, dy, across, up) in aside.items():
        place = frame.marks[word]
        if word in ("tip", "root"):
            near = frame.edges[word]
            place = np.array([middle, np.interp(middle, *near[np.argsort(near[:, 0])].T)])
        elif not seen[0] <= place[0] <= seen[1]:
            continue
        axes.annotate(
            word,
            place,
            (dx, dy),
            textcoords="offset points",
            ha=across,
            va=up,
            fontsize=size,
            color=INK_COLOUR,
            zorder=8,
        )


def swept_patch(strips: Sequence[Array]) -> Any:
    """Patch of the area that contact lines sweep, from strips of quadrilaterals (Q, 4, 2).

    It is one path: a thousand quadrilaterals of their own take 30 times as long, and have seams.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    quads = np.concatenate(strips)
    corners = np.concatenate((quads, quads[:, :1]), axis=1)
    codes = np.tile([Outline.MOVETO, *[Outline.LINETO] * 3, Outline.CLOSEPOLY], len(quads))
    outline = Outline(corners.reshape(-1, 2), codes)
    return PathPatch(outline, facecolor=PATTERN_COLOUR, edgecolor=PATTERN_COLOUR, linewidth=0.5, zorder=1)


def draw_contact(axes: Any, panel: ContactPanel, small: bool = False) -> None:
    """Draw pattern, ellipses, lines and path of a panel; a `small` panel has no marks at its positions."""
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.patheffects import withStroke

    if panel.pattern is not None:
        places, level = panel.pattern
        axes.contourf(places[..., 0], places[..., 1], level, levels=[-1.0, 1.0], colors=[PATTERN_COLOUR], zorder=1)
        axes.contour(
            places[..., 0], places[..., 1], level, levels=[1.0], colors=[LINE_COLOUR], linewidths=0.8, zorder=2
        )
    if panel.strips:
        axes.add_artist(swept_patch(panel.strips))
    if panel.pattern is not None or panel.strips:
        axes.fill([], [], facecolor=PATTERN_COLOUR, edgecolor=LINE_COLOUR, lw=0.8, label="contact pattern")
    if len(panel.ellipses):
        axes.add_collection(
            PolyCollection(
                list(panel.ellipses), facecolors=COMPOUND_COLOUR, edgecolors=OUTLINE_COLOUR, alpha=0.65, linewidths=0.9, zorder=3,
                label="contact ellipses",
            ),
            autolim=False,
        )  # fmt: skip
    if panel.lines:
        shown = every_nth(np.arange(len(panel.lines)), MAX_LINES)
        lines = LineCollection(
            [panel.lines[k] for k in shown], colors=LINE_COLOUR, linewidths=1.1, zorder=3, label="contact lines"
        )
        axes.add_collection(lines, autolim=False)
    if panel.nominal is not None:
        axes.plot(*panel.nominal.T, color=INK_COLOUR, lw=1.3, ls="--", zorder=4, label="aligned")
    size = float(np.clip(150.0 / max(len(panel.path), 1), 2.0, 3.5))
    around = [withStroke(linewidth=3.2, foreground="white")]
    curve = panel.path if panel.curve is None else panel.curve
    if np.isfinite(curve).any():
        axes.plot(*curve.T, color=PATH_COLOUR, lw=1.8, zorder=5, label="path of contact", path_effects=around)
        if not small:
            axes.plot(*panel.path.T, color=PATH_COLOUR, ls="", marker="o", ms=size, zorder=5)
    if panel.edge.any():
        where = panel.path[panel.edge]
        axes.plot(
            *where.T,
            ls="",
            marker="D",
            ms=3.0 if small else size + 1.5,
            color=EDGE_COLOUR,
            mec=INK_COLOUR,
            mew=0.4,
            zorder=7,
            label="edge contact",
        )


def _draw_field(axes: Any, panel: FieldPanel) -> None:
    from matplotlib.ticker import MaxNLocator

    panel = _with_corners(panel)
    known = np.ma.masked_invalid(panel.values)
    if known.count() == 0:
        return
    x, y = panel.places[..., 0], panel.places[..., 1]
    low, high = float(known.min()), float(known.max())
    # a smaller range would show rounding and the error of tables
    levels = MaxNLocator(9).tick_values(low, max(high, low + panel.least))
    shown = known if panel.continued is None else np.ma.masked_invalid(np.clip(panel.continued, levels[0], levels[-1]))
    if panel.is_flat:
        # a uniform field has one colour and no scale
        levels = [float(levels[0]) - panel.least, float(levels[-1]) + panel.least]
    paint = {"colors": [UNIFORM_COLOUR]} if panel.is_flat else {"cmap": "cividis_r"}
    drawn = axes.contourf(x, y, shown, levels=levels, zorder=1, **paint)
    rings = axes.contour(x, y, shown, levels=levels, colors=[INK_COLOUR], linewidths=0.6, zorder=2, gid=RINGS_ID)
    rings.set_paths(_without_specks(rings.get_paths(), panel.places.max(axis=(0, 1)) - panel.places.min(axis=(0, 1))))
    past = None if panel.beyond is None else np.ma.masked_invalid(_past_edges(panel.beyond))
    if past is not None and past.max() > 0.0:
        # cells are cut where the values end; rounding of the end moves it by less than a pixel
        levels = [0.0, float(past.max())]
        axes.contourf(x, y, past, levels=levels, colors=[GROUND_COLOUR], antialiased=True, zorder=2.5).set_gid(COVER_ID)
        axes.fill(
            [], [], facecolor=GROUND_COLOUR, edgecolor=FAINT_COLOUR, lw=0.8, label="not reached by the mating flank"
        )
    if panel.arrows is not None:
        _draw_arrows(axes, panel, max(high, panel.least))
    if panel.is_flat:
        return
    bar = axes.figure.colorbar(drawn, cax=axes.inset_axes((1.015, 0.0, 0.02, 1.0)))
    bar.ax.tick_params(labelsize=8)
    inches = axes.get_position().height * float(axes.figure.get_size_inches()[1])
    every = int(np.ceil(len(drawn.levels) * BAR_NUMBER_INCHES / inches))
    bar.set_ticks(drawn.levels[::every])


def _without_specks(rings: Sequence[Any], size: Array) -> list[Any]:
    """Return lines of equal values without specks; `size` (2,) of the flank.

    A speck is a level that is just reached between nodes.
    """
    from matplotlib.path import Path as Outline

    kept = []
    for ring in rings:
        parts = np.split(ring.vertices, np.flatnonzero(ring.codes == Outline.MOVETO)[1:]) if len(ring) else []
        lines = [Outline(part) for part in parts if (np.ptp(part, axis=0) > MIN_RING_SHARE * size).any()]
        kept.append(Outline.make_compound_path(*lines))
    return kept


def _label_rings(axes: Any, outline: Array) -> None:
    """Label the lines of equal values, inside of the flank and its values, with room around each label."""
    from matplotlib.path import Path as Outline
    from matplotlib.patheffects import withStroke

    flank = Outline(axes.transData.transform(outline))
    covers = [
        axes.transData.transform_path(path)
        for drawn in axes.collections
        if drawn.get_gid() == COVER_ID
        for path in drawn.get_paths()
    ]
    kept: list[tuple[Array, float]] = []
    for rings in [drawn for drawn in axes.collections if drawn.get_gid() == RINGS_ID]:
        places = []
        for label in axes.clabel(rings, fontsize=7, fmt="%g", inline=False):
            # in every orientation of the label its corners lie on this circle
            box = label.get_window_extent()
            reach = 0.5 * np.hypot(box.width, box.height)
            middle = np.array([0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1)])
            round_it = middle + 1.1 * reach * np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
            seen = flank.contains_points(round_it).all() and not any(
                cover.contains_points(round_it).any() for cover in covers
            )
            if seen and all(np.hypot(*(middle - other)) > 1.2 * (reach + far) for other, far in kept):
                kept.append((middle, reach))
                places.append(label.get_position())
        while rings.labelTexts:
            rings.pop_label()
        for label in axes.clabel(rings, fontsize=7, fmt="%g", manual=places) if places else ():
            label.set_path_effects([withStroke(linewidth=1.6, foreground="white")])


def _draw_arrows(axes: Any, panel: FieldPanel, greatest: float) -> None:
    """Draw the arrows of a field whose largest amount is `greatest`; the longest arrow just clears its neighbours."""
    from matplotlib.patheffects import withStroke

    assert panel.arrows is not None
    x, y = panel.places[..., 0], panel.places[..., 1]
    rows, columns = ARROW_GRID
    # rows evenly over the height; rows of the grid are not
    height = ((y - y[0]) / (y[-1] - y[0])).mean(axis=1)
    i = np.unique(np.abs(height - (np.arange(rows)[:, None] + 0.5) / rows).argmin(axis=1))
    j = slice(x.shape[1] // (2 * columns), None, max(x.shape[1] // columns, 1))
    shown = y[i]
    high = min(np.abs(y[[0, -1]] - shown[[0, -1]]).min(), 0.5 * np.abs(np.diff(shown, axis=0)).min())
    room = np.array([0.5 * np.abs(np.diff(x[i, j], axis=1)).min(), high])
    largest = np.nanmax(np.abs(panel.arrows), axis=(0, 1), initial=0.0)
    # vectors across the plane, as on worms, would be drawn as dots
    if largest.max() < MIN_ARROW_SHARE * greatest:
        return
    # arrows are about their places
    axes.quiver(
        x[i, j], y[i, j], panel.arrows[i, j, 0], panel.arrows[i, j, 1], color=PATH_COLOUR, zorder=7, width=0.0025,
        angles="xy", scale_units="xy", scale=(largest / (2.0 * ARROW_ROOM_SHARE * room)).max(), pivot="middle", headlength=3.0,
        headaxislength=3.0, path_effects=[withStroke(linewidth=1.6, foreground="white")],
    )  # fmt: skip
    if panel.sense:
        axes.plot([], [], ls="", marker=r"$\rightarrow$", ms=12, color=PATH_COLOUR, label=panel.sense)


def _with_corners(panel: FieldPanel) -> FieldPanel:
    """Return a field continued over all cells that have a value at a node.

    If the table ends before, as in a corner where two edges cut the cells, the values are continued by straight lines.
    """
    if panel.continued is None or panel.beyond is None:
        return panel
    continued, beyond = panel.continued, panel.beyond
    rows, columns = beyond.shape
    reached, none = np.pad(beyond <= 0.0, 1), np.isnan(beyond)
    beside = np.logical_or.reduce([reached[i : i + rows, j : j + columns] for i in range(3) for j in range(3)])
    # the second round fills the corner itself, from its neighbours' lines
    for _ in range(2):
        lines, ends = _straight_on(continued), _straight_on(beyond)
        # beyond several edges the largest distance counts
        past = np.fmax.reduce(ends)
        new = none & beside & (past > 0.0)
        continued = np.where(new, np.fmax.reduce(np.where(ends == past, lines, np.nan)), continued)
        beyond = np.where(new, past, beyond)
    return replace(panel, continued=np.where(beside, continued, np.nan), beyond=beyond)


def _straight_on(values: Array) -> Array:
    """Values (4, I, J) at nodes, extrapolated through the next two nodes on either side, in both directions."""
    padded = np.pad(values, 2, constant_values=np.nan)
    rows, columns = (slice(2, 2 + count) for count in values.shape)

    def neighbour(i: int, j: int) -> Array:
        return padded[rows.start + i : rows.stop + i, columns.start + j : columns.stop + j]

    return np.stack([2.0 * neighbour(i, j) - neighbour(2 * i, 2 * j) for i, j in ((1, 0), (-1, 0), (0, 1), (0, -1))])


def _past_edges(beyond: Array) -> Array:
    """Distance (I, J) of places beyond the end of the values, without rounding.

    If both flanks end together, the neighbours decide. Unknown places between places that are all beyond count as
    beyond: the border of the cover then shows no colour.
    """
    rows, columns = beyond.shape
    padded = np.pad(beyond, 1, constant_values=np.nan)
    square = np.stack([[padded[i : i + rows, j : j + columns] for j in range(3)] for i in range(3)])
    around = np.fmin.reduce([square[0, 1], square[2, 1], square[1, 0], square[1, 2]])
    past = np.where(np.abs(beyond) < SAME_EDGE_MM, around, beyond)
    least = np.fmin.reduce(square.reshape(9, rows, columns))
    return np.where(np.isnan(beyond) & (least > 0.0), least, past)
