"""Matrix of patterns: the contact on a flank and the transmission error under one or two assembly errors.

Every cell is one assembly. It shows the flank in its plane with pattern and path. Below are the transmission errors of
one tooth pair, of its neighbours and of the gears over two pitches, at the same scale in all cells. A cell without
contact gives the reason.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
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
from gearmesh.view.diagrams.study_plots import label_lines
from gearmesh.view.palette import CURVE_COLOURS, FAINT_COLOUR, GRID_LINE_COLOUR, INK_COLOUR
from gearmesh.view.scene import MemberContact

#: width of a cell
CELL_WIDTH_INCHES = 2.6
#: height of its transmission error
ERROR_HEIGHT_INCHES = 0.75
#: room for labels
LABEL_ROOM_INCHES = 0.7
#: room for words beside and above a flank
CELL_ROOM_INCHES = (0.22, 0.13)
#: size of these words
WORD_POINTS = 6.0
#: smallest range (arcsec, um) of transmission errors that is shown
MIN_ERROR_RANGE = 0.5
#: transmission error (arcsec, um) that is only rounding
ROUNDING_ERROR = 1e-3
#: text before an estimate in the legend
ESTIMATE_PREFIX = "estimate of "
#: text before an estimate in a cell
APPROXIMATE_SIGN = "\u2248 "
#: smallest width of a figure, for its legend
MIN_FIGURE_WIDTH_INCHES = 8.5
#: width of a figure whose legend has one row
MIN_LEGEND_ROW_INCHES = 12.0
#: letters of a label on an inch
LETTERS_PER_INCH = 8.0
#: letters in a line of a reason
REASON_LINE_LETTERS = 34
#: letters of a whole reason
MAX_REASON_LETTERS = 200


@dataclass(frozen=True)
class PatternCell:
    """One assembly, or the reason why it has no contact."""

    #: its flank with the contact; None without contact
    panel: ContactPanel | None = None
    #: transmission error (2, N) of one tooth pair: rotation, deg, and error in `unit`, NaN if unknown
    pair: Array | None = None
    #: transmission error (2, Q) of the gears over a pitch, likewise
    gears: Array | None = None
    #: unit of the transmission errors
    unit: str = "arcsec"
    #: reason why there is no contact
    reason: str = ""
    #: peak to peak of the gears over the exact mesh cycle: NaN without a cycle, None if it is not solved
    mesh_te: float | None = None

    @property
    def peak_to_peak(self) -> float:
        """Peak to peak of the gears' transmission error: exact, or estimated from the points of `gears`; NaN if
        unknown.
        """
        if self.mesh_te is not None:
            return self.mesh_te
        return float(np.ptp(self.gears[1])) if self.gears is not None and self.gears.size else np.nan


def pattern_cell(
    plane: FlankPlane, contact: MemberContact, pair: Array, gears: Array, unit: str, mesh_te: float | None = None
) -> PatternCell:
    """Return the cell of one assembly from its contact on a flank and its transmission errors (see PatternCell)."""
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
    """Plot cells over two quantities, each a label with unit and its values: rows upwards, columns to the right.

    `cells[i][j]` is at the i-th value of the rows. Raises OutputError if the file cannot be written.
    """
    known = [cell for row in cells for cell in row if cell.panel is not None]
    window = _common_window([cell.panel for cell in known if cell.panel is not None])
    (left, right), (low, high), magnified = window
    tall = CELL_WIDTH_INCHES * (high - low) * magnified / (right - left)
    across, down = len(columns[1]), len(rows[1])
    inches = (
        max(across * (CELL_WIDTH_INCHES + 0.15) + LABEL_ROOM_INCHES + 0.5, MIN_FIGURE_WIDTH_INCHES),
        down * (tall + ERROR_HEIGHT_INCHES + 0.3) + 2.0 * LABEL_ROOM_INCHES + 0.3,
    )
    figure = new_figure(inches, dpi)
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=(tall, ERROR_HEIGHT_INCHES) * down)
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
                # the rotation has an axis in the lowest row alone: it is the same in all rows
                if cells[i][j].panel is not None:
                    below.tick_params(labelbottom=True, bottom=True)
                angle = "φ₁ (deg)\n" if cells[i][j].panel is not None else ""
                below.set_xlabel(f"{angle}{_word(columns[1][j])}", fontsize=9, color=INK_COLOUR)
    handles = {
        label: handle for axes in grid.flat for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    if handles:
        # the label is the legend's title: two things below the axes would overlap
        figure.legend(
            handles.values(),
            handles.keys(),
            loc="outside lower center",
            ncols=6 if inches[0] >= MIN_LEGEND_ROW_INCHES else 3,
            frameon=False,
            fontsize=8,
            title=label_lines(columns[0], int(LETTERS_PER_INCH * inches[0])),
            title_fontproperties={"size": 12},
        )
    else:
        figure.supxlabel(label_lines(columns[0], int(LETTERS_PER_INCH * inches[0])), color=INK_COLOUR)
    figure.supylabel(label_lines(rows[0], int(LETTERS_PER_INCH * inches[1])), color=INK_COLOUR)
    figure.suptitle(title + (f" ({magnified:g} times as high)" if magnified > 1.0 else ""), color=INK_COLOUR)
    save_figure(figure, file)


def _word(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _common_window(panels: Sequence[ContactPanel]) -> Window:
    """Return a window that shows the flank and the contact of all panels."""
    if not panels:
        return (0.0, 4.0), (0.0, 1.0), 1.0
    flanks, extents = (
        np.array(windows) for windows in zip(*((p.plane.frame.extent, p.extent) for p in panels), strict=True)
    )
    flank = np.stack((flanks[:, 0].min(axis=0), flanks[:, 1].max(axis=0)))
    return flank_window(
        flank, (np.fmin.reduce(extents[:, 0]), np.fmax.reduce(extents[:, 1])), CELL_WIDTH_INCHES, CELL_ROOM_INCHES
    )


def _error_limits(cells: Sequence[PatternCell]) -> tuple[float, float]:
    """Smallest and largest error of the gears in all cells, or of the tooth pairs if the gears' errors are unknown."""
    gears, pairs = (
        np.concatenate([np.zeros(0), *(curve[1] for curve in curves if curve is not None)])
        for curves in ([cell.gears for cell in cells], [cell.pair for cell in cells])
    )
    shown = gears if np.isfinite(gears).any() else pairs
    finite = shown[np.isfinite(shown)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    room = max(0.15 * (high - low), 0.5 * (MIN_ERROR_RANGE - (high - low)))
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
        reason = (
            fill(cell.reason, REASON_LINE_LETTERS)
            if len(cell.reason) <= MAX_REASON_LETTERS
            else fill(f"{cell.reason[:MAX_REASON_LETTERS]} ...", REASON_LINE_LETTERS)
        )
        above.text(0.5, 0.5, reason, ha="center", va="center", fontsize=7, color=INK_COLOUR, transform=above.transAxes)
        below.set(xticks=[], yticks=[])
        for spine in below.spines.values():
            spine.set_visible(False)
        return
    draw_contact(above, cell.panel, small=True)
    draw_outline(above, cell.panel.plane, window)
    name_edges(above, cell.panel.plane.frame, window[0], WORD_POINTS)
    pitch = cell.gears[0, -1] if cell.gears is not None else 0.0
    if cell.pair is not None:
        for k in (-1, 1, 0) if pitch else (0,):
            colour, label = (FAINT_COLOUR, "neighbouring tooth pairs") if k else (INK_COLOUR, "tooth pair")
            below.plot(cell.pair[0] + k * pitch, cell.pair[1], color=colour, lw=0.9, label=label)
    if cell.gears is not None:
        what = ESTIMATE_PREFIX if cell.mesh_te is None else ""
        shown = f"gears, {what}peak to peak at the right" if np.isfinite(cell.gears[1]).any() else ""
        for k in (-1, 0):
            below.plot(cell.gears[0] + k * pitch, cell.gears[1], color=CURVE_COLOURS[0], lw=2.6, alpha=0.5, label=shown)
        below.set_xlim(-pitch, pitch)
    if np.isfinite(cell.peak_to_peak):
        about = APPROXIMATE_SIGN if cell.mesh_te is None else ""
        told = f"{about}{cell.peak_to_peak:.3g}" if cell.peak_to_peak >= ROUNDING_ERROR else f"< {ROUNDING_ERROR:g}"
        below.text(
            0.98, 0.06, told, ha="right", va="bottom", fontsize=7, color=INK_COLOUR, transform=below.transAxes,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )  # fmt: skip
    below.set_ylim(errors)
