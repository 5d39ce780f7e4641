"""Charts of composite tests: transmission error over whole turns, and centre distance of gears pressed together.

Two thin lines enclose the range of F_i' and F_i''. The pitch with the largest change, f_i' and f_i'', is shaded.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.inspection.composite import CompositeTest
from gearmesh.answers.inspection.figures import UM_PER_MM
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.diagrams.plots import new_figure, save_figure
from gearmesh.view.palette import CURVE_COLOURS, FAINT_COLOUR, GRID_LINE_COLOUR, GROUND_COLOUR, INK_COLOUR

#: width of the figure
CHART_WIDTH_INCHES = 10.5
#: height of a chart
CHART_HEIGHT_INCHES = 2.9


def plot_composite(file: Path | str, test: CompositeTest) -> None:
    """Plot the charts of a test. Raises OutputError if the file cannot be written."""
    own, single, double = test.figures, test.single, test.double
    charts = [
        (
            single.phi1,
            UM_PER_MM * test.radius * (single.te - single.te.mean()),
            single.per_pitch,
            "single flank: transmission error,\narc of the gear (µm)",
            f"F_i' {own.single_flank_total:.1f}  f_i' {own.single_flank_tooth:.1f} µm",
        )
    ]
    if double is not None:
        charts.append(
            (
                double.phi1,
                UM_PER_MM * (double.distance - double.nominal),
                double.per_pitch,
                "double flank: centre distance\nmore than a'' (µm)",
                f"F_i'' {own.double_flank_total:.1f}  f_i'' {own.double_flank_tooth:.1f} µm"
                f"    a'' {own.tight_center_distance:.4f} mm",
            )
        )
    figure = new_figure((CHART_WIDTH_INCHES, CHART_HEIGHT_INCHES * len(charts) + 0.4))
    for axes, chart in zip(figure.subplots(len(charts), 1, squeeze=False)[:, 0], charts, strict=True):
        _draw(axes, *chart)
    figure.suptitle(f"{own.pair}: composite deviations", color=INK_COLOUR)
    save_figure(figure, file)


def _draw(axes: Any, phi1: Array, values: Array, per_pitch: int, label: str, title: str) -> None:
    """Draw values (P,), um, over rotations phi1 (P,), rad, and shade the pitch with the largest change."""
    turns = phi1 / (2.0 * np.pi)
    ring = np.concatenate((values, values[:per_pitch]))
    windows = np.ptp(np.lib.stride_tricks.sliding_window_view(ring, per_pitch + 1), axis=1)
    begin, step = int(windows.argmax()), float(turns[1] - turns[0])
    end = turns[begin] + per_pitch * step
    axes.axvspan(turns[begin], min(end, turns[-1] + step), facecolor=GROUND_COLOUR, edgecolor="none", zorder=0)
    for level in (values.min(), values.max()):
        axes.axhline(level, color=INK_COLOUR, lw=0.7, ls="--")
    axes.axhline(0.0, color=FAINT_COLOUR, lw=0.8)
    axes.plot(turns, values, color=CURVE_COLOURS[0], lw=1.0)
    axes.set(xlabel="turns of the pinion, until the same teeth mesh again", ylabel=label)
    axes.set_title(title, fontsize=10, color=INK_COLOUR)
    axes.margins(x=0.01)
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
