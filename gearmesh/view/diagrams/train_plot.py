"""Plot of the transmission error of a train's output: the sum and the shares of its stages."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.diagrams.plots import new_figure, save_figure, sheet, widen_errors
from gearmesh.view.palette import CURVE_COLOURS, GRID_LINE_COLOUR, INK_COLOUR

#: width of the sum and of the shares, points
LINE_WIDTHS = (1.3, 0.9)


def plot_train_error(
    file: Path | str,
    turns: Array,
    errors: Array,
    parts: Mapping[str, Array],
    title: str,
    pitch: float,
    dpi: int = 150,
    unit: str = "arcsec",
) -> None:
    """Plot errors (P,) in a unit over turns (P,) of the input, with the shares (P,) of the stages.

    `pitch`: turns of the input during a pitch of the slowest mesh; the second plot shows three of them. Raises OutputError if the
    file cannot be written.
    """
    inches, dots = sheet((10.5, 4.6), None, dpi)
    figure = new_figure(inches, dots)
    whole, near = figure.subplots(1, 2, width_ratios=(1.6, 1.0), sharey=True)
    for axes, last in ((whole, float(turns[-1])), (near, min(3.0 * pitch, float(turns[-1])))):
        shown = turns <= last
        for k, (stage, part) in enumerate(parts.items()):
            axes.plot(
                turns[shown], part[shown], color=CURVE_COLOURS[k % len(CURVE_COLOURS)], lw=LINE_WIDTHS[1], label=stage
            )
        axes.plot(turns[shown], errors[shown], color=INK_COLOUR, lw=LINE_WIDTHS[0], label="output")
        axes.set(xlabel="turns of the input", xlim=(0.0, last))
        axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
        axes.set_axisbelow(True)
    widen_errors(whole, float(errors.min()), float(errors.max()))
    whole.set_ylabel(f"transmission error of the output ({unit.replace('um', 'µm')})")
    whole.set_title("all turns", color=INK_COLOUR, fontsize=10)
    near.set_title("three pitches of the slowest mesh", color=INK_COLOUR, fontsize=10)
    near.legend(fontsize=8, framealpha=0.85)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)
