"""Plots of studies: matrix of patterns, response curves, tornado of sensitivities, histograms with limits.

All take plain arrays and write one file each, as the plots of `plots.py` do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.algebra import Array
from gearmesh.view.palette import COMPOUND, CURVES, EDGE, FAINT, GROUND, INK, PATH
from gearmesh.view.plots import save_figure

#: least range of transmission errors that is shown, arcsec
_LEAST = 0.5
#: points of an ellipse
_ROUND = 73
#: lines of a response plot that are told apart by colour
_LINES = 9


@dataclass(frozen=True)
class PatternCell:
    """One assembly of a matrix of patterns.

    On the flank, length to the heel and height to the tip, mm: `outline` (K, 2), `path` (P, 2), `surface` (P,): contact inside both
    flanks, `edge` (P,): on an edge that carries, `axes` (P, 2, 2): half axes of the ellipses. `phi1` (P,), deg, and `te` (P,),
    arcsec, of one tooth pair, `gears` (2, Q) of the gears; `pitch`, deg.
    """

    outline: Array
    path: Array
    surface: NDArray[np.bool_]
    edge: NDArray[np.bool_]
    axes: Array
    phi1: Array
    te: Array
    gears: Array
    pitch: float


def plot_pattern_matrix(
    file: Path | str,
    cells: Sequence[Sequence[PatternCell | str]],
    columns: Sequence[str],
    rows: Sequence[str],
    title: str,
) -> None:
    """Patterns over one or two errors: a flank each, its transmission error beneath; a text stands where there is no contact.

    `columns` and `rows` say what was varied. All flanks have one scale, all transmission errors too. Raises OutputError where the
    file cannot be written.
    """
    from matplotlib.figure import Figure

    across, down = len(columns), len(rows)
    figure = Figure(figsize=(2.9 * across + 0.9, 2.5 * down + 0.9), layout="constrained")
    figure.suptitle(title)
    axes = figure.subplots(2 * down, across, squeeze=False, height_ratios=[1.25, 1.0] * down)
    known = [cell for row in cells for cell in row if isinstance(cell, PatternCell)]
    room = max([_LEAST, *(1.15 * float(np.ptp(cell.gears[1])) for cell in known if np.isfinite(cell.gears[1]).all())])
    for i, row in enumerate(cells):
        for j, cell in enumerate(row):
            upper, lower = axes[2 * i, j], axes[2 * i + 1, j]
            if isinstance(cell, str):
                _draw_reason(upper, lower, cell)
            else:
                _draw_pattern(upper, cell)
                _draw_error(lower, cell, room)
            if i == 0:
                upper.set_title(columns[j], fontsize=9)
            if j == 0:
                label = f"{rows[i]}\n" if rows[i] else ""
                upper.set_ylabel(f"{label}height (mm)", fontsize=8)
                lower.set_ylabel("TE (arcsec)", fontsize=8)
    figure.supxlabel(
        "above: length from the middle of the flank to the heel (mm), path of contact, dots where an edge carries; "
        "below: pinion rotation (deg), one tooth pair and the gears",
        fontsize=9,
    )
    save_figure(figure, file)


def _draw_reason(upper: Any, lower: Any, reason: str) -> None:
    for axes in (upper, lower):
        axes.set(xticks=[], yticks=[])
    upper.text(0.5, 0.5, "\n".join(reason[k : k + 30] for k in range(0, min(len(reason), 120), 30)),
               ha="center", va="center", fontsize=7, transform=upper.transAxes)  # fmt: skip


def _draw_pattern(axes: Any, cell: PatternCell) -> None:
    from matplotlib.patches import Polygon

    flank = Polygon(cell.outline, closed=True, facecolor=GROUND, edgecolor=INK, lw=1.0)
    axes.add_patch(flank)
    angle = np.linspace(0.0, 2.0 * np.pi, _ROUND)
    for k in np.flatnonzero(cell.surface & np.isfinite(cell.axes).all(axis=(1, 2))):
        rim = cell.path[k] + np.cos(angle)[:, None] * cell.axes[k, 0] + np.sin(angle)[:, None] * cell.axes[k, 1]
        ellipse = Polygon(rim, closed=True, facecolor=COMPOUND, edgecolor=COMPOUND, alpha=0.45, lw=0.6)
        axes.add_patch(ellipse)
        ellipse.set_clip_path(flank)
    axes.plot(*np.where(cell.surface[:, None], cell.path, np.nan).T, color=PATH, lw=1.6, marker="o", ms=1.8)
    axes.plot(*cell.path[cell.edge].T, ls="", color=EDGE, marker="o", ms=2.6)
    low, high = cell.outline.min(axis=0), cell.outline.max(axis=0)
    margin = 0.06 * (high - low)
    axes.set_xlim(low[0] - margin[0], high[0] + margin[0])
    axes.set_ylim(low[1] - margin[1], high[1] + margin[1])
    axes.set_aspect("equal", adjustable="box")
    axes.tick_params(labelsize=6)


def _draw_error(axes: Any, cell: PatternCell, room: float) -> None:
    for k in (-1, 0, 1):
        axes.plot(cell.phi1 + k * cell.pitch, cell.te, color=INK if k == 0 else FAINT, lw=0.9)
    for k in (-1, 0):
        axes.plot(cell.gears[0] + k * cell.pitch, cell.gears[1], color=CURVES[0], lw=2.6, alpha=0.5)
    known = cell.gears[1][np.isfinite(cell.gears[1])]
    middle = 0.5 * float(known.min() + known.max()) if known.size else 0.0
    axes.set(xlim=(-cell.pitch, cell.pitch), ylim=(middle - 0.6 * room, middle + 0.6 * room))
    axes.tick_params(labelsize=6)


@dataclass(frozen=True)
class StudyFigure:
    """A figure over all rows: its `name`, `values` (N,), NaN where there is none, and `limits` that it has to keep."""

    name: str
    values: Array
    limits: tuple[float, ...] = ()


def plot_responses(
    file: Path | str,
    keys: Sequence[tuple[str, Array]],
    figures: Sequence[StudyFigure],
    shape: tuple[int, ...],
    title: str,
) -> None:
    """Figures over every key (N,): lines where the rows are a grid of one or two keys, else a dot a row."""
    from matplotlib.figure import Figure

    down, across = len(figures), len(keys)
    figure = Figure(figsize=(max(3.4 * across, 4.4) + 1.4, 2.5 * down + 0.7), layout="constrained")
    figure.suptitle(title)
    axes = figure.subplots(down, across, squeeze=False, sharey="row")
    lines = len(shape) in (1, 2) and all(n <= _LINES for n in shape[:-1] or (1,))
    for i, each in enumerate(figures):
        for j, (key, values) in enumerate(keys):
            own = axes[i, j]
            if lines and (len(shape) == 1 or shape[1 - j] <= _LINES):
                _draw_lines(own, keys, j, each.values, shape)
            else:
                own.plot(values, each.values, ls="", marker=".", ms=3, color=CURVES[0], alpha=0.6)
            for limit in each.limits:
                own.axhline(limit, color=CURVES[1], lw=1.0, ls="--")
            if i == down - 1:
                own.set_xlabel(key)
            if j == 0:
                own.set_ylabel(_broken(each.name), fontsize=8)
    save_figure(figure, file)


def _draw_lines(axes: Any, keys: Sequence[tuple[str, Array]], j: int, values: Array, shape: tuple[int, ...]) -> None:
    if len(shape) == 1:
        axes.plot(keys[0][1], values, color=CURVES[0], marker="o", ms=3)
        return
    table, x, other = (np.moveaxis(v.reshape(shape), j, 0) for v in (values, keys[j][1], keys[1 - j][1]))
    from matplotlib import colormaps

    shades = colormaps["viridis"](np.linspace(0.0, 0.85, table.shape[1]))
    for k in range(table.shape[1]):
        axes.plot(x[:, k], table[:, k], color=shades[k], marker="o", ms=2.5, lw=1.1, label=f"{other[0, k]:.4g}")
    axes.legend(title=keys[1 - j][0], fontsize=6, title_fontsize=6)


def plot_tornado(
    file: Path | str, bars: Sequence[tuple[str, Sequence[tuple[str, float, float]], float]], title: str
) -> None:
    """Sensitivities: for each figure (its name, bars, its mean) a bar a key from the figure's value at the key's 5th percentile to
    that at its 95th, the greatest on top."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 0.8 + sum(0.9 + 0.34 * len(each[1]) for each in bars)), layout="constrained")
    figure.suptitle(title)
    axes = figure.subplots(len(bars), 1, squeeze=False, height_ratios=[0.9 + 0.34 * len(each[1]) for each in bars])[
        :, 0
    ]
    for own, (name, keys, middle) in zip(axes, bars, strict=True):
        for k, (_, low, high) in enumerate(keys):
            for end, colour in ((low, CURVES[0]), (high, CURVES[3])):
                own.barh(k, end - middle, left=middle, color=colour, height=0.65)
        own.axvline(middle, color=INK, lw=0.8)
        own.set_yticks(range(len(keys)), [key for key, _, _ in keys])
        own.invert_yaxis()
        own.set_xlabel(name, fontsize=9)
    axes[0].plot([], [], color=CURVES[0], lw=6, label="key at its 5th percentile")
    axes[0].plot([], [], color=CURVES[3], lw=6, label="at its 95th")
    axes[0].legend(fontsize=7)
    save_figure(figure, file)


def plot_histograms(file: Path | str, figures: Sequence[StudyFigure], percentiles: Sequence[int], title: str) -> None:
    """How often figures have which values, with percentiles and limits; a yield belongs into the title."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 2.4 * len(figures) + 0.6), layout="constrained")
    figure.suptitle(title)
    for own, each in zip(figure.subplots(len(figures), 1, squeeze=False)[:, 0], figures, strict=True):
        known = each.values[np.isfinite(each.values)]
        if known.size:
            own.hist(known, bins=min(60, max(8, int(np.sqrt(known.size)))), color="#b9c9df", edgecolor="white", lw=0.4)
            top = own.get_ylim()[1]
            for p, at in zip(percentiles, np.percentile(known, percentiles), strict=True):
                own.axvline(at, color=INK, lw=0.8, ls=":")
                own.text(at, top, f"{p} %", rotation=90, fontsize=6, ha="right", va="top")
        for limit in each.limits:
            own.axvline(limit, color=CURVES[1], lw=1.4, ls="--")
        own.set_xlabel(each.name, fontsize=9)
        own.set_ylabel("rows", fontsize=8)
    save_figure(figure, file)


def _broken(name: str) -> str:
    """A figure's name over two lines, its unit on the second."""
    stem, _, unit = name.rpartition("_")
    return f"{stem}\n({unit})" if unit in ("arcsec", "mm", "um", "deg") else name
