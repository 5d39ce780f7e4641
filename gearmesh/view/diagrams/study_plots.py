"""Plots of studies: response curves, tornado diagrams of sensitivities, histograms with limits.

All take plain arrays and write one file each, as the plots of `plots.py` do.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.view.diagrams.plots import SCREEN_DPI, new_figure, save_figure
from gearmesh.view.palette import CURVE_COLOURS, INK_COLOUR

#: lines of a response plot that can be distinguished by colour
_MAX_COLOURED_LINES = 9
#: letters in a line of the label of a key
KEY_LINE_LETTERS = 38
#: letters in a line of the label of a figure beside an axis
FIGURE_LINE_LETTERS = 34
#: letters in a line of the label of a figure under an axis
TITLE_LINE_LETTERS = 80
#: total orders, and counts of histograms
PALE_COLOUR = "#b9c9df"


@dataclass(frozen=True)
class StudyFigure:
    """A figure of a design over all rows of a study."""

    #: its whole name
    name: str
    #: its name without the unit
    stem: str
    #: its unit
    unit: str
    #: values (N,), NaN where missing
    values: Array
    #: limits that it has to keep
    limits: tuple[float, ...] = ()
    #: its meaning in words
    meaning: str = ""

    def label(self, letters: int) -> str:
        """Meaning and unit in lines of so many `letters`; the name of a figure without a meaning."""
        return label_lines(
            f"{self.meaning} ({self.unit})" if self.meaning and self.unit else self.meaning or self.name, letters
        )


def label_lines(text: str, letters: int) -> str:
    """Return a label in lines of so many letters; words are kept whole."""
    return fill(text, letters, break_long_words=False, break_on_hyphens=False)


def plot_responses(
    file: Path | str,
    keys: Sequence[tuple[str, Array]],
    figures: Sequence[StudyFigure],
    shape: tuple[int, ...],
    title: str,
) -> None:
    """Plot figures over every key (N,): lines if the rows are a grid of one or two keys, otherwise dots."""
    down, across = len(figures), len(keys)
    figure = new_figure((max(3.4 * across, 4.4) + 1.4, 2.5 * down + 0.7), SCREEN_DPI)
    figure.suptitle(title)
    axes = figure.subplots(down, across, squeeze=False, sharey="row")
    lines = len(shape) in (1, 2) and all(n <= _MAX_COLOURED_LINES for n in shape[:-1] or (1,))
    for i, response in enumerate(figures):
        for j, (key, values) in enumerate(keys):
            own = axes[i, j]
            if lines and (len(shape) == 1 or shape[1 - j] <= _MAX_COLOURED_LINES):
                _draw_lines(own, keys, j, response.values, shape)
            else:
                own.plot(values, response.values, ls="", marker=".", ms=3, color=CURVE_COLOURS[0], alpha=0.6)
            for limit in response.limits:
                own.axhline(limit, color=CURVE_COLOURS[1], lw=1.0, ls="--")
            if i == down - 1:
                own.set_xlabel(label_lines(key, KEY_LINE_LETTERS), fontsize=9)
            if j == 0:
                own.set_ylabel(response.label(FIGURE_LINE_LETTERS), fontsize=8)
    save_figure(figure, file)


def _draw_lines(axes: Any, keys: Sequence[tuple[str, Array]], j: int, values: Array, shape: tuple[int, ...]) -> None:
    if len(shape) == 1:
        axes.plot(keys[0][1], values, color=CURVE_COLOURS[0], marker="o", ms=3)
        return
    table, x, other = (np.moveaxis(v.reshape(shape), j, 0) for v in (values, keys[j][1], keys[1 - j][1]))
    from matplotlib import colormaps

    shades = colormaps["viridis"](np.linspace(0.0, 0.85, table.shape[1]))
    for k in range(table.shape[1]):
        axes.plot(x[:, k], table[:, k], color=shades[k], marker="o", ms=2.5, lw=1.1, label=f"{other[0, k]:.4g}")
    axes.legend(title=keys[1 - j][0].partition(" (")[0], fontsize=7, title_fontsize=7)


@dataclass(frozen=True)
class SwingBars:
    """Effects of keys on a figure that depends linearly on them."""

    #: key of the figure
    name: str
    #: figure in the middle of all keys
    middle: float
    #: keys with the figure at their 5th and 95th percentile, the largest swing first
    keys: Sequence[tuple[str, float, float]]
    #: meaning and unit of the figure
    label: str = ""
    #: ends of the range of each key, in words
    ends: tuple[str, str] = ("key at its 5th percentile", "at its 95th")
    #: place of the middle of the range, in words
    place: str = "in the middle"


@dataclass(frozen=True)
class ShareBars:
    """Shares of the variance of a figure that does not depend linearly on its keys."""

    #: name of the figure
    name: str
    #: R^2 of the linear model
    explained: float
    #: for each key its first order, error, total order and error (NaN if unknown), largest first; empty if too few rows
    keys: Sequence[tuple[str, float, float, float, float]]
    #: a note in the diagram
    remark: str = ""
    #: meaning and unit of the figure
    label: str = ""


def plot_tornado(
    file: Path | str, bars: Sequence[SwingBars | ShareBars], title: str, labels: Mapping[str, str] | None = None
) -> None:
    """Plot sensitivities, one diagram for each figure: its swing with each key, or each key's share of its variance.

    `labels`: words for keys.
    """
    words = {} if labels is None else {key: label_lines(text, KEY_LINE_LETTERS) for key, text in labels.items()}
    heights = [
        1.2 + sum(0.2 + 0.17 * (1 + words.get(key, key).count("\n")) for key, *_ in own_bars.keys) for own_bars in bars
    ]
    figure = new_figure((8.0, 0.8 + sum(heights)), SCREEN_DPI)
    figure.suptitle(title)
    for own, own_bars in zip(
        figure.subplots(len(bars), 1, squeeze=False, height_ratios=heights)[:, 0], bars, strict=True
    ):
        if isinstance(own_bars, SwingBars):
            _draw_swings(own, own_bars)
        else:
            _draw_shares(own, own_bars)
        own.set_yticks(range(len(own_bars.keys)), [words.get(key, key) for key, *_ in own_bars.keys], fontsize=8)
        if own_bars.keys:
            own.set_ylim(len(own_bars.keys) - 0.5, -0.5)
            # above the axis, where no bar is
            own.legend(fontsize=7, ncols=2, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save_figure(figure, file)


def _draw_swings(axes: Any, bars: SwingBars) -> None:
    for label, colour, ends in zip(
        bars.ends, (CURVE_COLOURS[0], CURVE_COLOURS[3]), zip(*(e[1:] for e in bars.keys), strict=True), strict=True
    ):
        at = np.array(ends) - bars.middle
        axes.barh(range(len(bars.keys)), at, left=bars.middle, color=colour, height=0.65, label=label)
        for row, end in enumerate(ends):
            axes.annotate(
                f"{end:.3g}",
                (end, row),
                (3 if end >= bars.middle else -3, 0),
                textcoords="offset points",
                ha="left" if end >= bars.middle else "right",
                va="center",
                fontsize=7,
            )
    axes.axvline(bars.middle, color=INK_COLOUR, lw=0.8)
    axes.margins(x=0.12)
    axes.set_xlabel(
        f"{label_lines(bars.label or bars.name, TITLE_LINE_LETTERS)}; {bars.middle:.3g} {bars.place}", fontsize=9
    )


def _draw_shares(axes: Any, bars: ShareBars) -> None:
    """Draw total orders behind first orders, with two standard errors either way."""
    why = f"not linear (R\u00b2 = {bars.explained:.2g})"
    if not bars.keys:
        # words alone: axes without bars look as if something were missing
        axes.set_axis_off()
        what = label_lines(bars.label or bars.name, TITLE_LINE_LETTERS)
        words = f"{what}: {why};\nkeys are not ranked: too few rows, or an incomplete grid"
        axes.text(0.5, 0.5, words, ha="center", va="center", fontsize=9)
        return
    first, first_error, total, total_error = np.array([share[1:] for share in bars.keys]).T
    rows = np.arange(len(bars.keys))
    kinds = [("first order: the key alone", first, first_error, CURVE_COLOURS[0], 0.4, 0.0)]
    if np.isfinite(total).all():
        kinds.insert(0, ("total: with interactions", total, total_error, PALE_COLOUR, 0.75, 0.28))
    for label, values, errors, colour, height, shift in kinds:
        axes.barh(rows, np.maximum(values, 0.0), color=colour, height=height, label=label)
        if (errors > 0.0).any():
            axes.errorbar(
                np.maximum(values, 0.0), rows + shift, xerr=2.0 * errors, ls="", color=INK_COLOUR, lw=0.9, capsize=2
            )
    if bars.remark:
        axes.text(0.98, 0.06, bars.remark, transform=axes.transAxes, ha="right", fontsize=8)
    axes.set_xlim(0.0, max(1.0, 1.05 * float(np.nanmax([first, np.where(np.isfinite(total), total, 0.0)]))))
    for row, share in enumerate(np.maximum(first, 0.0).tolist()):
        axes.text(share, row, f" {100.0 * share:.0f} %", va="center", fontsize=7)
    what = label_lines(f"share of the variance of: {bars.label or bars.name}", TITLE_LINE_LETTERS)
    axes.set_xlabel(f"{what}\n{why}", fontsize=9)


def plot_histograms(file: Path | str, figures: Sequence[StudyFigure], percentiles: Sequence[int], title: str) -> None:
    """Plot histograms of figures with percentiles and limits; a yield belongs into the title."""
    figure = new_figure((7.0, 2.4 * len(figures) + 0.6), SCREEN_DPI)
    figure.suptitle(title)
    for own, own_figure in zip(figure.subplots(len(figures), 1, squeeze=False)[:, 0], figures, strict=True):
        known = own_figure.values[np.isfinite(own_figure.values)]
        if known.size:
            own.hist(
                known, bins=min(60, max(8, int(np.sqrt(known.size)))), color=PALE_COLOUR, edgecolor="white", lw=0.4
            )
            top = own.get_ylim()[1]
            for at, label in percentile_marks(known, percentiles):
                own.axvline(at, color=INK_COLOUR, lw=0.8, ls=":")
                own.text(at, top, label, rotation=90, fontsize=6, ha="right", va="top")
        for limit in own_figure.limits:
            own.axvline(limit, color=CURVE_COLOURS[1], lw=1.4, ls="--")
        own.set_xlabel(own_figure.label(TITLE_LINE_LETTERS), fontsize=9)
        own.set_ylabel("rows", fontsize=8)
    save_figure(figure, file)


def percentile_marks(values: Array, percentiles: Sequence[int]) -> list[tuple[float, str]]:
    """Values of percentiles of values (N,), with their names; equal percentiles share a mark."""
    marks: dict[float, list[str]] = {}
    for p, at in zip(percentiles, np.percentile(values, percentiles).tolist(), strict=True):
        marks.setdefault(at, []).append(str(p))
    return [(at, f"{', '.join(names)} %") for at, names in marks.items()]
