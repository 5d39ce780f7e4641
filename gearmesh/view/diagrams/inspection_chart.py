"""Inspection charts: traces of profile and helix with their tolerances, deviations over the flanks, pitch deviations.

Left flanks are at the left. A trace has its material on the right (profiles, tip on top) or above (helices). Over the
range of evaluation there are

    mean line    the line of least squares, whose rise is the slope deviation
    - - - -      the slopes that the class allows, from the beginning of the mean line
    . . . .      two design lines around the trace, as far apart as the total deviation that the class allows (K chart)
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.inspection.figures import UM_PER_MM
from gearmesh.answers.inspection.flank_map import DeviationMap, MeasuredTrace
from gearmesh.answers.inspection.inspection import Inspection
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.region import Side
from gearmesh.view.diagrams.flank_diagrams import draw_outline, flank_window, name_edges
from gearmesh.view.diagrams.flank_plane import FlankPlane
from gearmesh.view.diagrams.plots import new_figure, save_figure
from gearmesh.view.palette import CURVE_COLOURS, EDGE_COLOUR, FAINT_COLOUR, GRID_LINE_COLOUR, GROUND_COLOUR, INK_COLOUR

#: width of the chart
SHEET_WIDTH_INCHES = 12.0
#: height of a row of maps
MAP_HEIGHT_INCHES = 2.6
#: height of a row of traces
TRACE_HEIGHT_INCHES = 3.4
#: height of a row of pitch deviations
PITCH_HEIGHT_INCHES = 2.2
#: rows and columns of a map at which the deviation is written
WRITTEN_GRID = (5, 9)
#: steps of colour of a map
COLOUR_LEVELS = 12
#: smallest range of deviations that is shown
MIN_RANGE_UM = 1.0
#: matplotlib's name of the colours of less and more material than nominal
DIVERGING_COLOURS = "RdBu_r"
#: sides from left to right
SIDE_ORDER = (Side.LEFT, Side.RIGHT)


def plot_inspection(file: Path | str, inspection: Inspection) -> None:
    """Plot the chart of a measured gear. Raises OutputError if the file cannot be written."""
    rows = [
        (draw, height)
        for draw, height, there in (
            (_draw_profiles, TRACE_HEIGHT_INCHES, inspection.profiles),
            (_draw_helices, TRACE_HEIGHT_INCHES, inspection.helices),
            (_draw_maps, MAP_HEIGHT_INCHES, inspection.maps),
            (_draw_pitches, PITCH_HEIGHT_INCHES, inspection.measured.pitch),
        )
        if there
    ]
    figure = new_figure((SHEET_WIDTH_INCHES, sum(height for _, height in rows) + 0.7))
    axes = figure.subplots(len(rows), 2, squeeze=False, gridspec_kw={"height_ratios": [height for _, height in rows]})
    for own, (draw, _) in zip(axes, rows, strict=True):
        draw(own, inspection)
    figure.suptitle(inspection.headline, color=INK_COLOUR)
    save_figure(figure, file)


def _draw_profiles(axes: Any, inspection: Inspection) -> None:
    for plot, side in zip(axes, SIDE_ORDER, strict=True):
        if side not in inspection.profiles:
            plot.set_axis_off()
            continue
        own = inspection.profiles[side]
        _draw_trace(plot, own, (inspection.tolerance("f_Ha"), inspection.tolerance("F_a")), upwards=True)
        plot.set(xlabel="deviation (µm), + is material", ylabel="roll length (mm)")
        plot.set_title(f"{side} flank: profile    {_values(own, 'a')}", fontsize=10, color=INK_COLOUR)
        first, last = own.trace.range.applies
        for place, word, up in ((first, "root", "bottom"), (last, "tip", "top")):
            plot.annotate(word, (0.01, place), xycoords=("axes fraction", "data"), ha="left", va=up, fontsize=8)
        if first > last:
            plot.invert_yaxis()
        plot.legend(fontsize=7, framealpha=0.85, loc="center right" if own.trace.slope < 0.0 else "center left")


def _draw_helices(axes: Any, inspection: Inspection) -> None:
    for plot, side in zip(axes, SIDE_ORDER, strict=True):
        if side not in inspection.helices:
            plot.set_axis_off()
            continue
        own = inspection.helices[side]
        _draw_trace(plot, own, (inspection.tolerance("f_Hb"), inspection.tolerance("F_b")), upwards=False)
        plot.set(xlabel="z along the face (mm)", ylabel="deviation (µm), + is material")
        plot.set_title(f"{side} flank: helix    {_values(own, 'b')}", fontsize=10, color=INK_COLOUR)


def _values(own: MeasuredTrace, letter: str) -> str:
    """Text of the figures of a trace, um."""
    values = (("f_H", own.sign * own.trace.slope), ("f_f", own.trace.form), ("F_", own.trace.total))
    text = "  ".join(f"{name}{letter} {UM_PER_MM * value:.1f}" for name, value in values)
    return f"{text}  C_{letter} {UM_PER_MM * own.trace.crowning:.1f} µm"


def _draw_trace(axes: Any, own: MeasuredTrace, tolerances: tuple[float | None, float | None], upwards: bool) -> None:
    """Draw a trace with its mean line and the tolerances (um) of the slope and of the total deviation."""

    def draw(x: Any, y: Any, **style: Any) -> None:
        axes.plot(*((y, x) if upwards else (x, y)), **style)

    d, trace = UM_PER_MM * own.deviations, own.trace
    ends, line = np.array(trace.range.evaluated), UM_PER_MM * np.array(trace.line)
    draw(own.positions, d, color=CURVE_COLOURS[0], lw=1.3, label="measured")
    draw(ends, line, color=CURVE_COLOURS[1], lw=1.3, label="mean line")
    slope, total = tolerances
    if slope is not None:
        begin, end = trace.range.slope
        steep = slope * (ends - ends[0]) / (end - begin)
        for k, sign in enumerate((1.0, -1.0)):
            draw(ends, line[0] + sign * steep, color=INK_COLOUR, lw=0.9, ls="--", label="" if k else "slope tolerance")
    if total is not None:
        low, high = sorted(ends)
        inside = d[(own.positions >= low) & (own.positions <= high) & np.isfinite(d)]
        middle = 0.5 * (inside.max() + inside.min())
        for k, sign in enumerate((0.5, -0.5)):
            level = np.full(2, middle + sign * total)
            draw(ends, level, color=EDGE_COLOUR, lw=1.1, ls=":", label="" if k else "total tolerance")
    span = axes.axhspan if upwards else axes.axvspan
    span(*sorted(trace.range.evaluated), facecolor=GROUND_COLOUR, edgecolor="none", zorder=0)
    (axes.axvline if upwards else axes.axhline)(0.0, color=FAINT_COLOUR, lw=0.9)
    _finish(axes)


def _draw_maps(axes: Any, inspection: Inspection) -> None:
    most = max(float(np.nanmax(np.abs(own.deviations), initial=0.0)) for own in inspection.maps.values())
    for plot, side in zip(axes, SIDE_ORDER, strict=True):
        if side not in inspection.maps:
            plot.set_axis_off()
            continue
        plane = FlankPlane.of(inspection.member, side)
        _draw_map(plot, plane, inspection.maps[side], max(UM_PER_MM * most, MIN_RANGE_UM))
        order = inspection.figures.flanks[str(side)].second_order
        assert order is not None
        title = (
            f"{side} flank: deviations (µm)\npressure angle {_arc(order.pressure_angle_error)}, spiral angle "
            f"{_arc(order.spiral_angle_error)}, crowning {order.profile_crowning:+.1f} up, {order.length_crowning:+.1f} "
            f"along, twist {order.twist:+.1f} µm"
        )
        plot.set_title(title, fontsize=9, color=INK_COLOUR)


def _arc(arcsec: float) -> str:
    """Text of an angle in minutes of arc."""
    return f"{arcsec / 60.0:+.2f}'"


def _draw_map(axes: Any, plane: FlankPlane, own: DeviationMap, most: float) -> None:
    """Draw deviations over a flank, as colours and as numbers on a grid."""
    from matplotlib.ticker import MaxNLocator

    places, d = plane.frame.places(own.points), np.ma.masked_invalid(UM_PER_MM * own.deviations)
    levels = MaxNLocator(COLOUR_LEVELS, symmetric=True).tick_values(-most, most)
    x, y = places[..., 0], places[..., 1]
    drawn = axes.contourf(x, y, d, levels=levels, cmap=DIVERGING_COLOURS, zorder=1)
    axes.contour(x, y, d, levels=levels, colors=[INK_COLOUR], linewidths=0.4, zorder=2)
    i, j = (
        np.linspace(0, size - 1, count).round().astype(int) for size, count in zip(d.shape, WRITTEN_GRID, strict=True)
    )
    for place, value in zip(places[np.ix_(i, j)].reshape(-1, 2), _flat(d[np.ix_(i, j)]), strict=True):
        if np.isfinite(value):
            axes.annotate(
                f"{value:+.1f}", place, ha="center", va="center", fontsize=6.5, color=INK_COLOUR, zorder=9,
                bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.6},
            )  # fmt: skip
    lengths = plane.frame.extent[:, 0]
    window = flank_window(plane.frame.extent, (float(lengths[0]), float(lengths[1])), 0.5 * SHEET_WIDTH_INCHES - 1.4)
    draw_outline(axes, plane, window)
    name_edges(axes, plane.frame, window[0])
    axes.set_xlabel(plane.labels[0], fontsize=9)
    axes.set_ylabel(plane.labels[1], fontsize=9)
    axes.tick_params(labelsize=8)
    bar = axes.figure.colorbar(drawn, cax=axes.inset_axes((1.02, 0.0, 0.02, 1.0)))
    bar.ax.tick_params(labelsize=7)


def _flat(d: Any) -> Array:
    return np.asarray(d.filled(np.nan), dtype=float).ravel()


def _draw_pitches(axes: Any, inspection: Inspection) -> None:
    """Draw single pitch deviations as bars and index deviations as a line, over the teeth."""
    for plot, side in zip(axes, SIDE_ORDER, strict=True):
        if side not in inspection.measured.pitch:
            plot.set_axis_off()
            continue
        own = inspection.measured.pitch[side]
        teeth = np.arange(own.index.size)
        plot.bar(teeth, UM_PER_MM * own.single, color=CURVE_COLOURS[0], width=0.7, label="single pitch f_pi")
        plot.plot(
            teeth,
            UM_PER_MM * (own.index - own.index.mean()),
            color=CURVE_COLOURS[1],
            marker=".",
            lw=1.2,
            label="index deviation",
        )
        plot.axhline(0.0, color=FAINT_COLOUR, lw=0.8)
        plot.set(xlabel="tooth", ylabel="deviation (µm)")
        plot.set_title(
            f"{side} flank: pitch    f_p {UM_PER_MM * own.single_pitch:.1f}  F_p {UM_PER_MM * own.cumulative:.1f} µm",
            fontsize=10,
            color=INK_COLOUR,
        )
        _finish(plot)


def _finish(axes: Any) -> None:
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
    axes.legend(fontsize=7, framealpha=0.85, loc="best")
    axes.tick_params(labelsize=8, colors=INK_COLOUR)
