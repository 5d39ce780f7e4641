"""Plots of studies: response curves, tornado of sensitivities, histograms with limits.

All take plain arrays and write one file each, as the plots of `plots.py` do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.kernel.algebra import Array
from gearmesh.view.palette import CURVES, INK
from gearmesh.view.plots import save_figure

#: lines of a response plot that are told apart by colour
_LINES = 9


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
