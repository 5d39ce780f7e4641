"""Theoretical profile and helix charts: the traces of exact flanks, with the band of the class (K chart).

A trace is minus the amount that the modifications remove, in the middle of the face or at mid height. The range of
evaluation is shaded:

    design trace     solid
    . . . .          two copies of the design trace around it, as far apart as the total deviation that the class allows

A measured trace that fits between them, moved as a whole, is within the class.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.inspection.inspection import Inspection, theoretical_involutes
from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.region import Side
from gearmesh.view.diagrams.modification_diagrams import CLOSED_FORM_FLANKS, POINTS_PER_TRACE, flank_map
from gearmesh.view.diagrams.plots import new_figure, save_figure
from gearmesh.view.palette import CURVE_COLOURS, EDGE_COLOUR, FAINT_COLOUR, GRID_LINE_COLOUR, GROUND_COLOUR, INK_COLOUR

#: width and height of the figure
FIGURE_SIZE_INCHES = (11.0, 7.5)


def plot_k_chart(file: Path | str, inspection: Inspection) -> None:
    """Plot the charts of both flanks of a member that was not measured.

    Raises DesignError for flanks that are not involutes or have deviations, OutputError if the file cannot be written.
    """
    involutes, asked = theoretical_involutes(inspection)
    flanks = [inspection.member.tooth.side(side).flank for side in Side]
    if None in involutes.values() or not all(isinstance(flank, CLOSED_FORM_FLANKS) for flank in flanks):
        raise ArgumentError(
            "member",
            inspection.member.name,
            reason="its flanks have no theoretical profile and helix charts",
            allowed="cylindrical gears with the modifications of their design alone",
        )
    figure = new_figure(FIGURE_SIZE_INCHES)
    rows = figure.subplots(2, 2, gridspec_kw={"height_ratios": (1.2, 1.0)})
    for column, side in enumerate((Side.LEFT, Side.RIGHT)):
        own = flank_map(inspection.member, side, POINTS_PER_TRACE)
        half, involute = POINTS_PER_TRACE // 2, involutes[side]
        assert involute is not None
        profile, helix = -own.removed[:, half], -own.removed[half]
        _draw(
            rows[0, column], own.length, profile, involute.profile.evaluated, inspection.tolerance("F_a"), upwards=True
        )
        _draw(rows[1, column], own.z, helix, involute.helix_trace.evaluated, inspection.tolerance("F_b"), upwards=False)
        rows[0, column].set(xlabel="deviation (µm), + is material", ylabel="roll length (mm)")
        rows[0, column].set_title(f"{side} flank: profile, mid face", fontsize=10, color=INK_COLOUR)
        rows[1, column].set(xlabel="z along the face (mm)", ylabel="deviation (µm), + is material")
        rows[1, column].set_title(f"{side} flank: helix, mid height", fontsize=10, color=INK_COLOUR)
    figure.suptitle(f"{inspection.member.name}: theoretical charts{asked and f', {asked}'}", color=INK_COLOUR)
    save_figure(figure, file)


def _draw(
    axes: Any, positions: Array, trace: Array, ends: tuple[float, float], total: float | None, *, upwards: bool
) -> None:
    """Draw a trace (N,), um, at positions (N,), mm, and the band of a total tolerance (um) over the range of
    evaluation.
    """

    def draw(x: Array, y: Array, **style: Any) -> None:
        axes.plot(*((y, x) if upwards else (x, y)), **style)

    low, high = sorted(ends)
    draw(positions, trace, color=CURVE_COLOURS[0], lw=1.4, label="design")
    if total is not None:
        inside = (positions >= low) & (positions <= high)
        for k, sign in enumerate((0.5, -0.5)):
            label = "" if k else f"total tolerance, {total:g} µm"
            draw(positions[inside], trace[inside] + sign * total, color=EDGE_COLOUR, lw=1.1, ls=":", label=label)
    (axes.axhspan if upwards else axes.axvspan)(low, high, facecolor=GROUND_COLOUR, edgecolor="none", zorder=0)
    (axes.axvline if upwards else axes.axhline)(0.0, color=FAINT_COLOUR, lw=0.9)
    # an unmodified flank must not look like a signal
    room = max(1.5 * float(np.ptp(trace)), 2.0 * (total or 0.0), 10.0)
    middle = 0.5 * float(trace.max() + trace.min())
    (axes.set_xlim if upwards else axes.set_ylim)(middle - room, middle + room)
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
    axes.legend(fontsize=7, framealpha=0.85, loc="best")
    axes.tick_params(labelsize=8, colors=INK_COLOUR)
