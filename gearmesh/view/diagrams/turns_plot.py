"""Plot of the transmission error over whole turns of eccentric members, and of its waves."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.view.diagrams.plots import MIN_TE_RANGE, new_figure, save_figure, sheet, widen_errors
from gearmesh.view.palette import CURVE_COLOURS, FAINT_COLOUR, GRID_LINE_COLOUR, INK_COLOUR

#: height of the bars' plot relative to its tallest bar: room for the legend
BAR_ROOM_FACTOR = 1.25


def plot_turns(
    file: Path | str,
    turns: FullTurns,
    title: str,
    unit: tuple[float, str] = (ARCSEC, "arcsec"),
    size: tuple[int, int] | None = None,
    dpi: int = 150,
) -> None:
    """Plot the TE over the pinion's turns until it repeats, and its waves as bars.

    `unit`: rad and name of the unit of errors; `size` in pixels. Raises OutputError if the file cannot be written.
    """
    rad, name = unit[0], unit[1].replace("um", "µm")
    inches, dots = sheet((10.5, 5.0), size, dpi)
    figure = new_figure(inches, dots)
    axes, bars = figure.subplots(1, 2, width_ratios=(3.2, 1.0))
    axes.plot(turns.phi1 / (2.0 * np.pi), turns.te / rad, color=CURVE_COLOURS[0], lw=0.9)
    axes.set(xlabel="turns of the pinion, until the same teeth mesh again", ylabel=f"transmission error ({name})")
    axes.margins(x=0.01)
    widen_errors(axes, float(np.nanmin(turns.te)) / rad, float(np.nanmax(turns.te)) / rad)
    place, names = np.arange(len(turns.waves)), [_name(wave.member, wave.per_turn) for wave in turns.waves]
    bars.bar(
        place, [wave.amplitude / rad for wave in turns.waves], color=CURVE_COLOURS[0], width=0.7, label="exact contact"
    )
    closed = np.array([wave.closed_amplitude / rad for wave in turns.waves])
    if np.isfinite(closed).any():
        bars.plot(place, closed, ls="", marker="_", ms=22, mew=2.0, color=INK_COLOUR, label="closed form")
    bars.set_xticks(place, names, rotation=90, fontsize=9)
    tallest = np.nanmax([wave.amplitude / rad for wave in turns.waves] + [*closed], initial=0.5 * MIN_TE_RANGE)
    bars.set(ylabel=f"amplitude ({name})", ylim=(0.0, BAR_ROOM_FACTOR * tallest))
    bars.legend(fontsize=8, framealpha=0.85)
    for plot in (axes, bars):
        plot.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
        plot.set_axisbelow(True)
    axes.axhline(0.0, color=FAINT_COLOUR, lw=0.8)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)


def _name(member: str, per_turn: int) -> str:
    return "mesh" if member == "mesh" else f"{member}, {per_turn} per turn"
