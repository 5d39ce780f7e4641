"""The matrix of patterns: how contact moves over a flank, and what becomes of the transmission error, under two errors.

Every cell is one assembly: the flank in its plane with pattern and path, and below it the transmission error of the pair and of the
gears over two pitches, all to one scale. What failed says why in its place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.contact.cycle import Cycle
from gearmesh.contact.path import ContactPath, error_unit
from gearmesh.kernel.algebra import Array
from gearmesh.teeth.train import GearPair
from gearmesh.view.flank_diagrams import ContactPanel, Window, draw_contact, draw_outline, flank_window
from gearmesh.view.flank_plane import FlankPlane
from gearmesh.view.palette import CURVES, FAINT, GRID_LINES, INK
from gearmesh.view.plots import save_figure
from gearmesh.view.scene import contact_on

#: inches: width of a cell, height of its transmission error, room of labels
WIDTH, ERROR, LABELS = 2.6, 0.75, 0.7
#: points across and along the flank, by which the patterns of cells are drawn
GRID = (61, 121)
#: least range (arcsec, um) of transmission errors that is shown
LEAST = 0.1


@dataclass(frozen=True)
class PatternCell:
    """One assembly: its flank, and the transmission error; `pair` and `gears` (2, N), deg and the unit's; or why there is none."""

    panel: ContactPanel | None = None
    pair: Array | None = None
    gears: Array | None = None
    unit: str = "arcsec"
    reason: str = ""

    @property
    def peak_to_peak(self) -> float:
        """Of the gears' transmission error; NaN where it is not known."""
        return float(np.ptp(self.gears[1])) if self.gears is not None and self.gears.size else np.nan


def pattern_cell(
    pair: GearPair, name: str, path: ContactPath, cycle: Cycle | None, plane: FlankPlane | None = None
) -> PatternCell:
    """The cell of one assembly from its contact, on the flank of a member; a `plane` that is known saves making it again."""
    index = pair.index(name)
    if not path.touching.any():
        return PatternCell(reason="no contact")
    contact = contact_on(index, path, pair.mounts)
    plane = plane or FlankPlane.of(pair.members[name], pair.flanks[index])
    pattern = replace(plane, count=GRID).pattern(contact) if contact.ellipses.size else None
    panel = ContactPanel(
        "", plane, plane.path(contact), contact.edge, np.empty((0, 2, 2)), (), plane.swept(contact), pattern
    )
    rad, unit = error_unit(pair.slide)
    if cycle is None or cycle.pair is None or cycle.gears is None:
        return PatternCell(panel, np.stack((np.degrees(path.phi1), path.te / rad)), unit=unit)
    own, gears = (np.stack((np.degrees(phi1), te / rad)) for phi1, te in (cycle.pair, cycle.gears))
    return PatternCell(panel, own, gears, unit)


def plot_matrix(
    file: Path | str,
    cells: Sequence[Sequence[PatternCell]],
    rows: tuple[str, Sequence[float]],
    columns: tuple[str, Sequence[float]],
    title: str,
    size: tuple[int, int] | None = None,
    dpi: int = 150,
) -> None:
    """Cells over two quantities, each a label with its unit and the values: of the rows upwards, of the columns rightwards.

    `cells[i][j]` is at the i-th value of the rows. `size` in pixels, by default what the cells need. Raises OutputError where the
    file cannot be written.
    """
    from matplotlib.figure import Figure

    known = [cell for row in cells for cell in row if cell.panel is not None]
    window = _common_window([cell.panel for cell in known if cell.panel is not None])
    (left, right), (low, high), magnified = window
    tall = WIDTH * (high - low) * magnified / (right - left)
    across, down = len(columns[1]), len(rows[1])
    inches = (
        (across * (WIDTH + 0.15) + LABELS + 0.5, down * (tall + ERROR + 0.3) + 2.0 * LABELS)
        if size is None
        else (size[0] / dpi, size[1] / dpi)
    )
    figure = Figure(figsize=inches, dpi=dpi, layout="constrained")
    grid = figure.subplots(2 * down, across, squeeze=False, height_ratios=(tall, ERROR) * down)
    errors = _error_limits(known)
    for i in range(down):
        for j in range(across):
            above, below = grid[2 * (down - 1 - i) : 2 * (down - i), j]
            _draw_cell(above, below, cells[i][j], window, errors)
            if j > 0:
                below.tick_params(labelleft=False)
            else:
                above.set_ylabel(f"{rows[1][i]:g}", rotation=0, ha="right", va="center", fontsize=10, color=INK)
                below.set_ylabel(f"TE ({known[0].unit.replace('um', 'µm')})" if known else "", fontsize=7)
            if i == 0:
                below.set_xlabel(f"{columns[1][j]:g}", fontsize=10, color=INK)
    figure.supxlabel(columns[0], color=INK)
    figure.supylabel(rows[0], color=INK)
    figure.suptitle(title, color=INK)
    save_figure(figure, file)


def _common_window(panels: Sequence[ContactPanel]) -> Window:
    """A window in which the contact of all panels is seen."""
    if not panels:
        return (0.0, 4.0), (0.0, 1.0), 1.0
    extents = np.array([panel.extent for panel in panels])
    return flank_window(
        panels[0].plane.frame.extent, (np.nanmin(extents[:, 0]), np.nanmax(extents[:, 1])), WIDTH, (0.06, 0.06)
    )


def _error_limits(cells: Sequence[PatternCell]) -> tuple[float, float]:
    """Between what the errors of the gears are, of all cells."""
    errors = [cell.gears[1] if cell.gears is not None else cell.pair[1] for cell in cells if cell.pair is not None]
    finite = np.concatenate([*errors, np.zeros(0)])
    finite = finite[np.isfinite(finite)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
    room = max(0.15 * (high - low), LEAST / 2)
    return low - room, high + room


def _draw_cell(above: Any, below: Any, cell: PatternCell, window: Window, errors: tuple[float, float]) -> None:
    above.set_xticks([])
    above.set_yticks([])
    below.tick_params(labelsize=6, labelbottom=False, bottom=False)
    below.grid(True, color=GRID_LINES, lw=0.6)
    if cell.panel is None:
        above.text(0.5, 0.5, cell.reason, ha="center", va="center", fontsize=8, transform=above.transAxes, wrap=True)
        below.set_axis_off()
        return
    draw_contact(above, cell.panel, small=True)
    draw_outline(above, cell.panel.plane, window)
    for spine in above.spines.values():
        spine.set_visible(False)
    if cell.pair is not None:
        below.plot(*cell.pair, color=FAINT if cell.gears is not None else CURVES[0], lw=0.9)
    if cell.gears is not None:
        pitch = cell.gears[0, -1]
        for k in (-1, 0):
            below.plot(cell.gears[0] + k * pitch, cell.gears[1], color=CURVES[0], lw=1.6)
        below.set_xlim(-pitch, pitch)
        below.text(
            0.98, 0.06, f"{cell.peak_to_peak:.3g}", ha="right", va="bottom", fontsize=7, transform=below.transAxes
        )
    below.set_ylim(errors)
