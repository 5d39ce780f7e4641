"""The matrix of patterns: how contact moves over a flank, and what becomes of the transmission error, under one or two errors.

Every cell is one assembly: the flank in its plane with pattern and path, and below it the transmission error of one tooth pair, of
its neighbours and of the gears over two pitches, all to one scale. What failed says why in its place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.diagrams.flank_diagrams import (
    ContactPanel,
    Window,
    draw_contact,
    draw_outline,
    flank_window,
    name_edges,
)
from gearmesh.view.diagrams.flank_plane import FlankPlane
from gearmesh.view.diagrams.plots import new_figure, save_figure
from gearmesh.view.palette import CURVE_COLOURS, FAINT_COLOUR, GRID_LINE_COLOUR, INK_COLOUR
from gearmesh.view.scene import MemberContact

#: inches: width of a cell, height of its transmission error, room of labels
WIDTH, ERROR, LABELS = 2.6, 0.75, 0.7
#: inches beside and above a flank, in which the words stand, and their size
ROOM, WORDS = (0.22, 0.13), 6.0
#: least range (arcsec, um) of transmission errors that is shown, and the part of one that is only rounding
LEAST, NOTHING = 0.5, 1e-3
#: what is put before figures that are estimates, in the legend and in the cells
ESTIMATE, APPROXIMATELY = "estimate of ", "\u2248 "
#: least width of a figure, inches, for what its legend says
LEGEND = 8.5
#: letters of a line of a reason, and of all of it
LINE, REASON = 34, 200


@dataclass(frozen=True)
class PatternCell:
    """One assembly: its flank; transmission errors of one tooth `pair` (2, N) and over a pitch of the `gears` (2, Q), deg and the
    unit's, NaN where not known; or why there is none. `mesh_te`: peak to peak of the gears' over the exact mesh cycle, NaN
    where there is none, None where that is not solved."""

    panel: ContactPanel | None = None
    pair: Array | None = None
    gears: Array | None = None
    unit: str = "arcsec"
    reason: str = ""
    mesh_te: float | None = None

    @property
    def peak_to_peak(self) -> float:
        """Of the gears' transmission error: the exact one, or an estimate by the points of `gears`; NaN where it is not known."""
        if self.mesh_te is not None:
            return self.mesh_te
        return float(np.ptp(self.gears[1])) if self.gears is not None and self.gears.size else np.nan


def pattern_cell(
    plane: FlankPlane, contact: MemberContact, pair: Array, gears: Array, unit: str, mesh_te: float | None = None
) -> PatternCell:
    """The cell of one assembly from its contact on the flank of a plane, and its transmission errors as a PatternCell has them."""
    pattern = plane.pattern(contact) if contact.ellipses.size else None
    panel = ContactPanel(
        "", plane, plane.path(contact), contact.edge, np.empty((0, 2, 2)), (), plane.swept(contact), pattern
    )
    return PatternCell(panel, pair, gears, unit, mesh_te=mesh_te)


def plot_matrix(
    file: Path | str,
    cells: Sequence[Sequence[PatternCell]],
    rows: tuple[str, Sequence[object]],
    columns: tuple[str, Sequence[object]],
    title: str,
    dpi: int = 150,
) -> None:
    """Cells over two quantities, each a label with its unit and the values: of the rows upwards, of the columns rightwards.

    `cells[i][j]` is at the i-th value of the rows. Raises OutputError where the file cannot be written.
    """
    known = [cell for row in cells for cell in row if cell.panel is not None]
    window = _common_window([cell.panel for cell in known if cell.panel is not None])
    (left, right), (low, high), magnified = window
    tall = WIDTH * (high - low) * magnified / (right - left)
    across, down = len(columns[1]), len(rows[1])
    inches = max(across * (WIDTH + 0.15) + LABELS + 0.5, LEGEND), down * (tall + ERROR + 0.3) + 2.0 * LABELS + 0.3
    figure = new_figure(inches, dpi)
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=(tall, ERROR) * down)
    errors = _error_limits(known)
    for i in range(down):
        leftmost = next((j for j in range(across) if cells[i][j].panel is not None), 0)
        grid[2 * (down - 1 - i), 0].set_ylabel(_word(rows[1][i]), rotation=0, ha="right", va="center", color=INK_COLOUR)
        for j in range(across):
            above, below = grid[2 * (down - 1 - i) : 2 * (down - i), j]
            _draw_cell(above, below, cells[i][j], window, errors)
            if j == leftmost and known:
                below.set_ylabel(f"TE ({known[0].unit.replace('um', 'µm')})", fontsize=7)
            else:
                below.tick_params(labelleft=False)
            if i == 0:
                below.set_xlabel(_word(columns[1][j]), fontsize=10, color=INK_COLOUR)
    handles = {
        label: handle for axes in grid.flat for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    if handles:
        # the label stands above what is explained: two things below the axes would be put upon each other
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=6,
            frameon=False,
            fontsize=8,
            title=columns[0],
            title_fontproperties={"size": 12},
        )
    else:
        figure.supxlabel(columns[0], color=INK_COLOUR)
    figure.supylabel(rows[0], color=INK_COLOUR)
    figure.suptitle(title + (f" ({magnified:g} times as high)" if magnified > 1.0 else ""), color=INK_COLOUR)
    save_figure(figure, file)


def _word(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _common_window(panels: Sequence[ContactPanel]) -> Window:
    """A window in which the flank and the contact of all panels are seen."""
    if not panels:
        return (0.0, 4.0), (0.0, 1.0), 1.0
    flanks, extents = (
        np.array(windows) for windows in zip(*((p.plane.frame.extent, p.extent) for p in panels), strict=True)
    )
    flank = np.stack((flanks[:, 0].min(axis=0), flanks[:, 1].max(axis=0)))
    return flank_window(flank, (np.fmin.reduce(extents[:, 0]), np.fmax.reduce(extents[:, 1])), WIDTH, ROOM)


def _error_limits(cells: Sequence[PatternCell]) -> tuple[float, float]:
    """Between what the errors of the gears are, of all cells; of their pairs where those of no gears are known."""
    gears, pairs = (
        np.concatenate([np.zeros(0), *(curve[1] for curve in curves if curve is not None)])
        for curves in ([cell.gears for cell in cells], [cell.pair for cell in cells])
    )
    shown = gears if np.isfinite(gears).any() else pairs
    finite = shown[np.isfinite(shown)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    room = max(0.15 * (high - low), 0.5 * (LEAST - (high - low)))
    return low - room, high + room


def _draw_cell(above: Any, below: Any, cell: PatternCell, window: Window, errors: tuple[float, float]) -> None:
    from matplotlib.patheffects import withStroke

    above.set_xticks([])
    above.set_yticks([])
    for spine in above.spines.values():
        spine.set_visible(False)
    below.tick_params(labelsize=6, labelbottom=False, bottom=False)
    below.grid(True, color=GRID_LINE_COLOUR, lw=0.6)
    if cell.panel is None:
        reason = fill(cell.reason, LINE) if len(cell.reason) <= REASON else fill(f"{cell.reason[:REASON]} ...", LINE)
        above.text(0.5, 0.5, reason, ha="center", va="center", fontsize=7, color=INK_COLOUR, transform=above.transAxes)
        below.set(xticks=[], yticks=[])
        for spine in below.spines.values():
            spine.set_visible(False)
        return
    draw_contact(above, cell.panel, small=True)
    draw_outline(above, cell.panel.plane, window)
    name_edges(above, cell.panel.plane.frame, window[0], WORDS)
    pitch = cell.gears[0, -1] if cell.gears is not None else 0.0
    if cell.pair is not None:
        for k in (-1, 1, 0) if pitch else (0,):
            colour, label = (FAINT_COLOUR, "neighbouring tooth pairs") if k else (INK_COLOUR, "tooth pair")
            below.plot(cell.pair[0] + k * pitch, cell.pair[1], color=colour, lw=0.9, label=label)
    if cell.gears is not None:
        what = ESTIMATE if cell.mesh_te is None else ""
        shown = f"gears, {what}peak to peak at the right" if np.isfinite(cell.gears[1]).any() else ""
        for k in (-1, 0):
            below.plot(cell.gears[0] + k * pitch, cell.gears[1], color=CURVE_COLOURS[0], lw=2.6, alpha=0.5, label=shown)
        below.set_xlim(-pitch, pitch)
    if np.isfinite(cell.peak_to_peak):
        about = APPROXIMATELY if cell.mesh_te is None else ""
        told = f"{about}{cell.peak_to_peak:.3g}" if cell.peak_to_peak >= NOTHING else f"< {NOTHING:g}"
        below.text(
            0.98, 0.06, told, ha="right", va="bottom", fontsize=7, color=INK_COLOUR, transform=below.transAxes,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )  # fmt: skip
    below.set_ylim(errors)
