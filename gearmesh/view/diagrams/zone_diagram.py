"""The zone of contact as a figure: contact lines on both flanks, and in the plane of action.

Contact lines of a tooth pair from first to last contact are faint. Lines of all tooth pairs at one rotation of the
pinion are marked. Flanks are drawn as in `flank_diagrams`; below them is the zone in space, which is at rest while the
gears turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.zone import ZoneOfContact
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.flank_frame import FlankFrame
from gearmesh.view.diagrams.flank_diagrams import (
    FIGURE_WIDTH_INCHES,
    SMALL_PANEL_INCHES,
    ContactPanel,
    Window,
    contact_panel,
    draw_contact,
    draw_outline,
    is_long,
    label_plane,
    panel_window,
    show_window,
    swept_patch,
    window_shape,
)
from gearmesh.view.diagrams.flank_plane import FlankPlane, strips
from gearmesh.view.diagrams.panel_rows import Arrangement, PanelRows, PanelSlot
from gearmesh.view.diagrams.plots import save_figure
from gearmesh.view.palette import (
    CURVE_COLOURS,
    EDGE_COLOUR,
    GRID_LINE_COLOUR,
    INK_COLOUR,
    LINE_COLOUR,
    PATH_COLOUR,
)
from gearmesh.view.scene import contact_on, jumps

#: distance beyond a flank, in its heights, up to which a limit line is shown; one farther away is named in the title
LIMIT_REACH_HEIGHTS = 0.2
#: largest height of the zone in space, as a share of its width
MAX_ZONE_HEIGHT_SHARE = 0.45
#: height of the zone in space that is not to scale, as a share of its width
MIN_ZONE_HEIGHT_SHARE = 0.14
#: width of the zone in space, as a share of its height, below which its axes are exchanged
MIN_UPRIGHT_SHARE = 0.7
#: margin around the zone in space, as a share of its height
ZONE_MARGIN = 0.15
#: length of the zone in space, in its heights, up to which it is drawn to scale
MAX_SCALE_LENGTH = 7.0
#: labels of limit lines, by `undercut`: True for the limiting line of the tool
LIMIT_LABELS = {True: "limiting line of the tool (undercut)", False: "envelope of the contact lines (none beyond)"}


@dataclass(frozen=True)
class _ZoneLines:
    """The lines of a zone of contact in the plane of action, mm."""

    #: contact lines of one tooth pair, each (K, 2)
    lines: Sequence[Array]
    #: areas that they sweep, each (Q, 4, 2)
    strips: Sequence[Array]
    #: contact lines of all tooth pairs at the rotation shown
    now: Sequence[Array]
    #: path of contact (P, 2)
    path: Array
    #: limit lines (L, 2), each with True for an undercut limit
    limits: Sequence[tuple[Array, bool]]
    #: True if length is drawn upwards and the other coordinate to the right
    lying: bool = False

    @property
    def turned(self) -> _ZoneLines:
        """The lines with exchanged coordinates."""
        return _ZoneLines(
            [line[:, ::-1] for line in self.lines],
            [strip[..., ::-1] for strip in self.strips],
            [line[:, ::-1] for line in self.now],
            self.path[:, ::-1],
            [(line[:, ::-1], undercut) for line, undercut in self.limits],
            True,
        )


def plot_zone(
    file: Path | str, shown: ZoneOfContact, title: str, size: tuple[int, int] | None = None, dpi: int = 150
) -> None:
    """Plot the zone of contact. Raises OutputError if the file cannot be written."""
    pair = shown.pair
    panels = [_panel(shown, name) for name in pair.members]
    space = _in_space(shown)
    # long flanks are above each other, short ones side by side, as on other diagrams
    ways = [[[panel] for panel in panels], [panels]]
    if not is_long([panel.plane for panel in panels]):
        ways.reverse()
    made = PanelRows([_arrangement(shown, way, space) for way in ways], size, dpi, titled=bool(title))
    *flanks, [below] = made.axes
    drawn = dict(zip((axes for row in flanks for axes in row), panels, strict=True))
    for axes, panel in drawn.items():
        width = made.width(axes)
        _draw_flank(axes, shown, panel, _window(shown, panel, width), small=width <= SMALL_PANEL_INCHES)
    _draw_space(below, shown, space)

    def fit(axes: Any, width: float) -> None:
        if axes in drawn:
            show_window(axes, drawn[axes].plane, _window(shown, drawn[axes], width))

    made.finish(title, fit)
    save_figure(made.figure, file)


def _arrangement(shown: ZoneOfContact, rows: Sequence[Sequence[ContactPanel]], space: _ZoneLines) -> Arrangement:
    """Return rows of flanks and the zone below them."""
    (left, right), (low, high) = _extent(space)
    least = 0.0 if _is_to_scale(space) else MIN_ZONE_HEIGHT_SHARE
    # axes to scale are smaller than their place
    below = PanelSlot(min(max((high - low) / (right - left), least), MAX_ZONE_HEIGHT_SHARE), to_scale=False)

    def slots(width: float) -> list[list[PanelSlot]]:
        return [[PanelSlot(window_shape(_window(shown, panel, width))) for panel in row] for row in rows] + [[below]]

    return Arrangement(slots, FIGURE_WIDTH_INCHES)


def _panel(shown: ZoneOfContact, name: str) -> ContactPanel:
    pair = shown.pair
    which = pair.index(name)
    side = pair.flanks[which]
    plane = FlankPlane.of(pair.members[name], side)
    words = [f"{name}, {side} flank"]
    if shown.zone is not None and which == 1:
        words.append(f"contact passes over {100.0 * shown.zone.share:.3g} % of it")
    return contact_panel(plane, contact_on(which, shown.whole, pair.mounts), ": ".join(words))


def _window(shown: ZoneOfContact, panel: ContactPanel, width: float) -> Window:
    """Window of a flank and of the part of its limit line near it."""
    frame = panel.plane.frame
    (left, low), (right, high) = frame.extent
    limit = shown.limits.get(panel.plane.member.name)
    if limit is not None:
        near = _near(frame, limit.own)
        if near.size:
            low, high = min(low, float(near[:, 1].min())), max(high, float(near[:, 1].max()))
    return panel_window(np.array([[left, low], [right, high]]), panel.extent, width)


def _near(frame: FlankFrame, limit: Array) -> Array:
    """Return the places (N, 2) of a limit line, own frame (L, 3), that are on a flank or near it."""
    (left, low), (right, high) = frame.extent
    lengths, places = frame.places(limit).T
    reach = LIMIT_REACH_HEIGHTS * (high - low)
    near = (lengths >= left) & (lengths <= right) & (places > low - reach) & (places < high + reach)
    return np.asarray(np.stack((lengths, places), axis=-1)[near])


def _far_words(frame: FlankFrame, limit: Array, *, undercut: bool) -> str:
    """Return where a limit line is that is too far from the flank to be drawn; "" if some of it is near."""
    if _near(frame, limit).size:
        return ""
    (left, low), (right, high) = frame.extent
    lengths, places = frame.places(limit).T
    beside = places[(lengths >= left) & (lengths <= right)]
    if not beside.size:
        return ""
    away = float(np.minimum(np.abs(beside - low), np.abs(beside - high)).min())
    return f"{LIMIT_LABELS[undercut]}: {away:.3g} mm away"


def _draw_flank(axes: Any, shown: ZoneOfContact, panel: ContactPanel, window: Window, *, small: bool) -> None:
    plane, pair = panel.plane, shown.pair
    which = pair.index(plane.member.name)
    draw_contact(axes, panel, small=True)
    draw_outline(axes, plane, window)
    _mark(axes, plane.lines(contact_on(which, shown.now, pair.mounts)), shown)
    limit = shown.limits.get(plane.member.name)
    if limit is not None and _near(plane.frame, limit.own).size:
        _draw_limit(axes, plane.frame.places(limit.own), undercut=limit.undercut)
    low, high = plane.frame.outline[:, 0].min(), plane.frame.outline[:, 0].max()
    (left, right), _, magnified = window
    notes = [f"{magnified:g} times as high"] if magnified > 1.0 else []
    notes += [f"cut off: flank from {low:.4g} to {high:.4g} mm"] if left > low or right < high else []
    far = "" if limit is None else _far_words(plane.frame, limit.own, undercut=limit.undercut)
    title = panel.name + (f"  ({', '.join(notes)})" if notes else "") + (f"\n{far}" if far else "")
    axes.set_title(title)
    label_plane(axes, plane, (left, right), small=small)


def _in_space(shown: ZoneOfContact) -> _ZoneLines:
    """Return the lines of the zone in space, in the plane of action."""
    places, whole = shown.plane.places, shown.whole
    lines = [None if line is None else places(line) for line in whole.lines]
    path = places(whole.point)
    path[[line is not None for line in lines]] = np.nan
    path = np.insert(path, jumps(whole.point1, whole.edge, whole.rotation) + 1, np.nan, axis=0)
    made = _ZoneLines(
        [line for line in lines if line is not None],
        strips(lines),
        [places(line) for line in shown.now.lines if line is not None],
        path,
        [(places(limit.fixed), limit.undercut) for limit in shown.limits.values()],
    )
    (left, right), (low, high) = _extent(made)
    return made if right - left >= MIN_UPRIGHT_SHARE * (high - low) else made.turned


def _extent(space: _ZoneLines) -> Array:
    """Smallest and largest length and width of the zone in space with its margin, (2, 2)."""
    every = np.concatenate((*space.lines, space.path))
    low, high = np.nanmin(every, axis=0), np.nanmax(every, axis=0)
    room = ZONE_MARGIN * max(float((high - low).min()), 0.1 * float((high - low).max()))
    return np.stack((low - room, high + room), axis=-1)


def _is_to_scale(space: _ZoneLines) -> bool:
    (left, right), (low, high) = _extent(space)
    return bool((right - left) <= MAX_SCALE_LENGTH * (high - low))


def _draw_space(axes: Any, shown: ZoneOfContact, space: _ZoneLines) -> None:
    from matplotlib.collections import LineCollection

    if space.strips:
        axes.add_patch(swept_patch(space.strips))
    if space.lines:
        axes.add_collection(LineCollection(list(space.lines), colors=LINE_COLOUR, linewidths=1.1, zorder=3))
    known = np.asarray(np.isfinite(space.path).all(axis=1))
    # a path is drawn only where neighbouring positions have points of contact
    if (known[1:] & known[:-1]).any():
        axes.plot(*space.path.T, color=PATH_COLOUR, lw=1.8, zorder=5, label="path of contact")
        points = shown.now.touching & np.array([line is None for line in shown.now.lines])
        if points.any():
            at = shown.plane.places(shown.now.point[points])[:, :: -1 if space.lying else 1]
            axes.plot(
                *at.T, color=CURVE_COLOURS[1], ls="", marker="o", ms=6.0, zorder=7, label=f"contact at {_at(shown)}"
            )
    _mark(axes, space.now, shown)
    (left, right), (low, high) = _extent(space)
    for limit, undercut in space.limits:
        within = (limit >= [left, low]) & (limit <= [right, high])
        if within.all(axis=-1).any():
            _draw_limit(axes, limit, undercut=undercut)
    axes.set_xlim(left, right)
    axes.set_ylim(low, high)
    if _is_to_scale(space):
        axes.set_aspect("equal", adjustable="box")
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
    count = int(shown.now.touching.sum())
    pairs = f"{count} tooth pair{'' if count == 1 else 's'} in contact"
    axes.set_title(f"zone of contact, {shown.plane.name}: {pairs}")
    across, up = shown.plane.labels[:: -1 if space.lying else 1]
    axes.set(xlabel=across, ylabel=up)


def _at(shown: ZoneOfContact) -> str:
    return f"φ₁ = {np.degrees(shown.phi1):.4g}°"


def _mark(axes: Any, lines: Sequence[Array], shown: ZoneOfContact) -> None:
    label = f"contact lines at {_at(shown)}"
    for k, line in enumerate(lines):
        axes.plot(*line.T, color=CURVE_COLOURS[1], lw=2.6, zorder=7, **({"label": label} if k == 0 else {}))


def _draw_limit(axes: Any, places: Array, *, undercut: bool) -> None:
    colour = INK_COLOUR if undercut else EDGE_COLOUR
    axes.plot(
        *places.T, color=colour, lw=1.6, ls="--", zorder=7, label=LIMIT_LABELS[undercut], scalex=False, scaley=False
    )
