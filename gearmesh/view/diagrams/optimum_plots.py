"""Plots of an optimisation: the best value over the evaluated designs, and fronts of two or three objectives.

All take plain arrays and write one file each, as the plots of `plots.py` do.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.view.diagrams.plots import SCREEN_DPI, new_figure, save_figure
from gearmesh.view.diagrams.study_plots import FIGURE_LINE_LETTERS, PALE_COLOUR, TITLE_LINE_LETTERS, label_lines
from gearmesh.view.palette import CURVE_COLOURS, INK_COLOUR

#: room beside the shown range of an axis, relative to the range
AXIS_MARGIN = 0.08
#: share of the designs whose values an axis shows at least; designs far off are left out
SHOWN_QUANTILE = 0.9


@dataclass(frozen=True)
class ObjectivePlot:
    """An objective over all evaluated designs."""

    #: name and unit
    label: str
    #: -1 if it is made small, +1 if large
    sense: int
    #: values (N,), NaN where a design failed
    values: Array
    #: value of the design itself
    before: float
    #: value of the best design
    best: float


def plot_progress(file: Path | str, objective: ObjectivePlot, feasible: NDArray[np.bool_], title: str) -> None:
    """Plot an objective over the evaluated designs, with the best value so far."""
    values, number = objective.values, np.arange(1, len(objective.values) + 1)
    figure = new_figure((7.2, 4.0), SCREEN_DPI)
    figure.suptitle(label_lines(title, TITLE_LINE_LETTERS))
    axes = figure.subplots()
    kept = np.where(feasible, values, np.nan)
    sign = -objective.sense
    running = sign * np.fmin.accumulate(sign * kept)
    if np.isfinite(values[~feasible]).any():
        axes.plot(
            number,
            np.where(feasible, np.nan, values),
            ls="",
            marker="x",
            ms=4,
            color=PALE_COLOUR,
            label="misses a limit",
        )
    axes.plot(number, kept, ls="", marker="o", ms=3.5, color=PALE_COLOUR, label="evaluated design")
    axes.step(number, running, where="post", color=CURVE_COLOURS[0], lw=1.6, label="best so far")
    if np.isfinite(objective.before):
        axes.axhline(objective.before, color=INK_COLOUR, lw=1.0, ls="--", label="design itself")
    axes.set_ylim(*_range(values, objective, objective.before))
    axes.set_xlabel("evaluated designs")
    axes.set_ylabel(label_lines(objective.label, FIGURE_LINE_LETTERS))
    # where values are worst there are fewest designs
    axes.legend(fontsize=8, loc="upper right" if objective.sense < 0 else "lower right")
    save_figure(figure, file)


def plot_front(
    file: Path | str,
    objectives: Sequence[ObjectivePlot],
    feasible: NDArray[np.bool_],
    front: NDArray[np.bool_],
    title: str,
) -> None:
    """Plot the designs over every two objectives, with those that no other one dominates."""
    pairs = list(itertools.combinations(objectives, 2))
    figure = new_figure((4.6 * len(pairs) + 0.8, 4.4), SCREEN_DPI)
    figure.suptitle(label_lines(title, TITLE_LINE_LETTERS * len(pairs)))
    for axes, (first, second) in zip(figure.subplots(1, len(pairs), squeeze=False)[0], pairs, strict=True):
        _draw_front(axes, first, second, feasible, front, joined=len(pairs) == 1)
    save_figure(figure, file)


def _draw_front(
    axes: Any,
    first: ObjectivePlot,
    second: ObjectivePlot,
    feasible: NDArray[np.bool_],
    front: NDArray[np.bool_],
    *,
    joined: bool,
) -> None:
    x, y = first.values, second.values
    other = feasible & ~front
    missing = ~feasible & np.isfinite(x) & np.isfinite(y)
    if missing.any():
        axes.plot(x[missing], y[missing], ls="", marker="x", ms=4, color=PALE_COLOUR, label="misses a limit")
    axes.plot(x[other], y[other], ls="", marker="o", ms=3.5, color=PALE_COLOUR, label="evaluated design")
    order = np.flatnonzero(front)[np.argsort(x[front], kind="stable")]
    line = "-" if joined else ""
    axes.plot(x[order], y[order], ls=line, lw=1.2, marker="o", ms=4.5, color=CURVE_COLOURS[0], label="front")
    if np.isfinite([first.before, second.before]).all():
        axes.plot(
            [first.before],
            [second.before],
            ls="",
            marker="s",
            ms=7,
            mfc="none",
            color=INK_COLOUR,
            label="design itself",
        )
    axes.plot([first.best], [second.best], ls="", marker="*", ms=13, color=CURVE_COLOURS[1], label="best.toml")
    axes.set_xlim(*_range(x, first, first.before, first.best))
    axes.set_ylim(*_range(y, second, second.before, second.best))
    axes.set_xlabel(label_lines(first.label, FIGURE_LINE_LETTERS))
    axes.set_ylabel(label_lines(second.label, FIGURE_LINE_LETTERS))
    up, right = ("upper" if second.sense < 0 else "lower"), ("right" if first.sense < 0 else "left")
    axes.legend(fontsize=8, loc=f"{up} {right}")


def _range(values: Array, objective: ObjectivePlot, *more: float) -> tuple[float, float]:
    """Return the ends of an axis: from the best values to most of the others, and to `more` values."""
    known = values[np.isfinite(values)]
    far = np.quantile(known, SHOWN_QUANTILE if objective.sense < 0 else 1.0 - SHOWN_QUANTILE)
    near = known.min() if objective.sense < 0 else known.max()
    shown = np.array([near, far, *more])
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    margin = AXIS_MARGIN * ((high - low) or abs(high) or 1.0)
    return low - margin, high + margin
