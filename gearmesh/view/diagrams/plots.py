"""Plots on paper: transmission error, cost against accuracy, and labelled curves.

Every function draws one figure and writes it as PNG, SVG or PDF by the file's suffix, whole or not at all. Figures are
made through matplotlib's objects: no global state changes, and no window is needed.
"""

from __future__ import annotations

import hashlib
import re
import sys
from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any, Literal

import numpy as np

from gearmesh.answers.contact.fit import BacklashCurve
from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.path import ContactPath
from gearmesh.figures import at_resolution
from gearmesh.formats import PDF_SUFFIX, PNG_SUFFIX, SVG_SUFFIX, refuse_suffix
from gearmesh.io.png import write_png
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.memory import is_own_process
from gearmesh.records import dataclass
from gearmesh.view.lettering import fit_title
from gearmesh.view.palette import (
    CURVE_COLOURS,
    EDGE_COLOUR,
    FAINT_COLOUR,
    GRID_LINE_COLOUR,
    INK_COLOUR,
    LINE_COLOUR,
    PATH_COLOUR,
)

#: markers of curves, in their order
_CURVE_MARKERS = "osD^v*"
#: smallest range of transmission errors that is shown
MIN_TE_RANGE = 0.01
#: smallest harmonic (arcsec, um) of a cycle whose harmonics are shown
_MIN_HARMONIC = 1e-3
#: smallest range of backlash that is shown, as a share of the backlash
_MIN_PLAY_RANGE_SHARE = 0.05
#: backlash that counts as zero
_ZERO_PLAY_DEG = 1e-7
#: range either way that is drawn for zero backlash
_ZERO_PLAY_RANGE_DEG = 1e-3
#: width of an entry of a legend
_LEGEND_ENTRY_INCHES = 1.9
#: size of titles
TITLE_POINTS = 12.0
#: approximate room for numbers, labels and titles beside axes: left, below, right, above
_LABEL_ROOM_INCHES = (0.6, 0.45, 0.1, 0.25)
#: pixels per inch of figures that are read on a screen
SCREEN_DPI = 100
#: share of the room that a figure needs in which its words are still clear of each other
_MIN_ROOM_SHARE = 0.8
#: share of that room down to which letters stay legible
_LEAST_ROOM_SHARE = 0.55
#: pixels per inch with which numbers, of 8 points, have 8 pixels
LEGIBLE_DPI = 72.0
#: pitches that are shown beyond the engagement of a pair
_PITCHES_BEYOND = 0.6
#: metadata of drawings by suffix: matplotlib's dates are switched off
_FILE_METADATA: dict[str, dict[str, Any]] = {
    SVG_SUFFIX: {"Date": None},
    PDF_SUFFIX: {"CreationDate": None},
}


@dataclass(frozen=True)
class CostRun:
    """Cost of a series of meshes against their accuracy."""

    #: errors (N,), um
    error_um: Array
    #: numbers (N,) of triangles
    triangles: Array
    #: times (N,), s
    seconds: Array
    #: fewest possible triangles (N,), or None
    bound: Array | None = None


def plot_transmission_error(
    file: Path | str,
    path: ContactPath,
    cycle: Cycle | None = None,
    title: str = "Transmission error",
    unit: tuple[float, str] = (ARCSEC, "arcsec"),
    size: tuple[int, int] | None = None,
    dpi: int = 150,
) -> None:
    """Plot the TE against the pinion's rotation (deg): positions of a path, and a mesh cycle if given.

    The cycle has the curves of three neighbouring tooth pairs over their whole engagement. The curve of the gears
    passes from one pair to the next at marked roots; jumps are marked too. The amplitudes of its harmonics are bars.

    `unit`: rad and name of the unit of errors; `size` in pixels. Raises OutputError if the file cannot be written.
    """
    rad, name = unit[0], unit[1].replace("um", "µm")
    heard = _harmonics(cycle, rad)
    inches, dots = sheet((10.5 if heard.size else 8.0, 5.0), size, dpi)
    figure = new_figure(inches, dots)
    axes, *others = figure.subplots(
        1, 1 + bool(heard.size), squeeze=False, width_ratios=(3.2, 1.0)[: 1 + bool(heard.size)]
    )[0]
    _draw_errors(axes, path, cycle, rad, name)
    if others:
        _draw_harmonics(others[0], heard, name)
    # outside of the plot, where it hides no curve
    columns = max(1, int(inches[0] / _LEGEND_ENTRY_INCHES))
    figure.legend(
        *axes.get_legend_handles_labels(), fontsize=9, loc="outside lower center", ncols=columns, frameon=False
    )
    for plot in (axes, *others):
        plot.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
        plot.set_axisbelow(True)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)


@dataclass(frozen=True)
class ErrorCurve:
    """Transmission error of gears over one pitch, to be compared with another."""

    #: label
    label: str
    #: rotations (N,) of the pinion, in pitches
    pitches: Array
    #: transmission errors (N,), in `unit`
    errors: Array
    #: amplitudes (H,) of the harmonics of the mesh frequency, in `unit`
    harmonics: Array
    #: unit of the errors
    unit: str


def plot_compared_errors(
    file: Path | str, curves: Sequence[ErrorCurve], title: str = "", size: tuple[int, int] | None = None, dpi: int = 150
) -> None:
    """Plot transmission errors in one unit over a pitch, and the amplitudes of their harmonics side by side.

    Raises OutputError if the file cannot be written.
    """
    unit = curves[0].unit.replace("um", "µm")
    inches, dots = sheet((10.5, 4.2), size, dpi)
    figure = new_figure(inches, dots)
    axes, bars = figure.subplots(1, 2, width_ratios=(2.2, 1.0))
    width = 0.8 / len(curves)
    for k, curve in enumerate(curves):
        colour = CURVE_COLOURS[k % len(CURVE_COLOURS)]
        # from the largest error downwards, as errors have no zero of their own
        axes.plot(curve.pitches, curve.errors - np.nanmax(curve.errors), color=colour, lw=2.0, label=curve.label)
        order = np.arange(1, len(curve.harmonics) + 1)
        bars.bar(order + (k - 0.5 * (len(curves) - 1)) * width, curve.harmonics, color=colour, width=width)
        bars.set_xticks(order)
    low = min(float(np.nanmin(curve.errors) - np.nanmax(curve.errors)) for curve in curves)
    room = max(-0.1 * low, MIN_TE_RANGE / 2)
    axes.set(xlim=(0.0, 1.0), ylim=(low - room, room))
    axes.set(xlabel="pinion rotation, pitches", ylabel=f"transmission error ({unit})")
    bars.set(xlabel="harmonic of the mesh frequency", ylabel=f"amplitude ({unit})")
    for plot in (axes, bars):
        plot.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
        plot.set_axisbelow(True)
    axes.legend(fontsize=9)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)


def plot_backlash(
    file: Path | str,
    curve: BacklashCurve,
    title: str = "Backlash",
    size: tuple[int, int] | None = None,
    dpi: int = 150,
) -> None:
    """Plot the backlash over a pitch of the pinion: rotation of the gear (deg) and arc at its pitch circle (mm).

    Its smallest and largest values are marked. `size` is in pixels. Raises OutputError if the file cannot be written.
    """
    inches, dots = sheet((8.0, 5.0), size, dpi)
    figure = new_figure(inches, dots)
    axes = figure.subplots()
    axes.plot(curve.phi1, curve.backlash, color=CURVE_COLOURS[0], lw=1.8, label="backlash")
    for label, value, style in (("greatest", curve.greatest, "--"), ("least", curve.least, ":")):
        axes.axhline(
            value, color=INK_COLOUR, lw=1.0, ls=style, label=f"{label} {at_resolution(value, _ZERO_PLAY_DEG):.6g}°"
        )
    low, high = (
        min(curve.least, float(np.nanmin(curve.backlash))),
        max(curve.greatest, float(np.nanmax(curve.backlash))),
    )
    most = max(abs(low), abs(high))
    shown_range = _MIN_PLAY_RANGE_SHARE * most if most > _ZERO_PLAY_DEG else 2.0 * _ZERO_PLAY_RANGE_DEG
    room = max(0.15 * (high - low), 0.5 * (shown_range - (high - low)))
    axes.set_ylim(low - room, high + room)
    axes.set_xlim(float(curve.phi1[0]), float(curve.phi1[-1]))
    axes.ticklabel_format(useOffset=False)
    axes.set(xlabel="pinion rotation φ₁ (deg), one pitch", ylabel="rotation of the gear between both flanks (deg)")
    known = np.isfinite(curve.backlash) & (np.abs(curve.backlash) > _ZERO_PLAY_DEG)
    if known.any():
        radius = float(np.median(curve.transverse[known] / curve.backlash[known]))
        other = axes.twinx()
        other.set_ylim(*(radius * end for end in axes.get_ylim()))
        other.set_ylabel("at its pitch circle (mm)")
        other.ticklabel_format(useOffset=False)
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
    figure.legend(*axes.get_legend_handles_labels(), fontsize=9, loc="outside lower center", ncols=3, frameon=False)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)


def _harmonics(cycle: Cycle | None, rad: float) -> Array:
    """Amplitudes (N,) of the mesh frequency's harmonics, in units of `rad`; empty if they are only rounding."""
    amplitudes = np.zeros(0) if cycle is None else np.abs(cycle.harmonics) / rad
    return amplitudes if amplitudes.size and np.nanmax(amplitudes, initial=0.0) > _MIN_HARMONIC else np.zeros(0)


def _draw_errors(axes: Any, path: ContactPath, cycle: Cycle | None, rad: float, unit: str) -> None:
    if cycle is not None and cycle.pair is not None and cycle.gears is not None:
        _draw_cycle(axes, cycle, cycle.pair, cycle.gears, rad)
    elif cycle is not None:
        phi1 = np.degrees(cycle.phi1)
        axes.plot(phi1, cycle.te.T / rad, color=FAINT_COLOUR, lw=1.2)
        axes.plot([], [], color=FAINT_COLOUR, lw=1.2, label="neighbouring tooth pairs")
        axes.plot(phi1, cycle.envelope / rad, color=CURVE_COLOURS[0], lw=4.0, alpha=0.45, label="envelope")
    phi1, te = np.degrees(path.phi1), path.te / rad
    if cycle is None or cycle.pair is None:
        axes.plot(phi1, te, color=INK_COLOUR, lw=1.4, label="tooth pair")
    size = float(np.clip(200.0 / len(phi1), 2.0, 4.5))
    for kind, colour in (("point", PATH_COLOUR), ("line", LINE_COLOUR), ("edge", EDGE_COLOUR)):
        here = path.kind == kind
        if here.any():
            axes.plot(phi1[here], te[here], ls="", marker="o", ms=size, color=colour, label=f"{kind} contact")
    # Pairs that no longer carry fall back by thousands of arcsec: show what decides, and where they leave it. And
    # rounding (1e-10 arcsec where TE is 0) must not look like a signal.
    decides = te if cycle is None or cycle.envelope is None else np.concatenate((te, cycle.envelope / rad))
    if cycle is not None and cycle.gears is not None:
        decides = cycle.gears[1] / rad
    low, high = (float(end) for end in (np.nanmin(decides), np.nanmax(decides)))
    room = max(0.7 * (high - low), MIN_TE_RANGE / 2)
    axes.set_ylim(low - room, high + room)
    axes.set(xlabel="pinion rotation φ₁ (deg)", ylabel=f"transmission error ({unit})")
    if high - low < _MIN_HARMONIC:
        # a flat curve needs words: its axis has the size of rounding
        axes.set_title(f"no transmission error: below {_MIN_HARMONIC:g} {unit}", fontsize=9, color=INK_COLOUR)


def _draw_cycle(axes: Any, cycle: Cycle, pair: Array, gears: Array, rad: float) -> None:
    """Draw three tooth pairs, the gears from one to the next, the roots at which the pairs change, and jumps."""
    pitch = float(gears[0, -1])
    known = np.isfinite(pair[1])
    first, last = (float(end) for end in (pair[0, known].min(), pair[0, known].max()))
    low, high = first - _PITCHES_BEYOND * pitch, last + _PITCHES_BEYOND * pitch
    for k in (-1, 0, 1):
        label = {0: {"label": "tooth pair"}, 1: {"label": "neighbouring tooth pairs"}}.get(k, {})
        axes.plot(
            np.degrees(pair[0] + k * pitch),
            pair[1] / rad,
            color=FAINT_COLOUR if k else INK_COLOUR,
            lw=1.2 if k else 1.4,
            **label,
        )
    turns = np.arange(np.floor(low / pitch), np.ceil(high / pitch))
    phi1 = (gears[0] + pitch * turns[:, None]).ravel()
    axes.plot(
        np.degrees(phi1),
        np.tile(gears[1], len(turns)) / rad,
        color=CURVE_COLOURS[0],
        lw=4.0,
        alpha=0.45,
        label="envelope",
    )

    def everywhere(marks: Array) -> Array:
        """Marks repeated by the pitch, as far as they are in the plot."""
        every = (marks % pitch + pitch * turns[:, None]).ravel()
        return every[(every >= low) & (every <= high)]

    roots = everywhere(np.array(cycle.handovers, dtype=float))
    if roots.size:
        te = np.interp(roots % pitch, *gears) / rad
        axes.plot(
            np.degrees(roots),
            te,
            ls="",
            marker="D",
            ms=5,
            mfc="white",
            mec=CURVE_COLOURS[0],
            label="change of tooth pairs",
        )
    for k, place in enumerate(everywhere(np.array([gap.phi1 for gap in cycle.breaks], dtype=float))):
        label = {"label": "jump: edge contact bridges it"} if k == 0 else {}
        axes.axvline(np.degrees(place), color=EDGE_COLOUR, lw=1.2, ls="--", **label)
    axes.set_xlim(np.degrees(low), np.degrees(high))


def _draw_harmonics(axes: Any, heard: Array, unit: str) -> None:
    """Draw the amplitudes over the number of the harmonic."""
    order = np.arange(1, len(heard) + 1)
    axes.bar(order, heard, color=CURVE_COLOURS[0], width=0.7)
    for k, value in zip(order, heard, strict=True):
        axes.annotate(
            f"{value:.2g}",
            (k, value),
            (0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8,
            rotation=90,
        )
    axes.set_xticks(order)
    axes.set(xlabel="harmonic of the\nmesh frequency", ylabel=f"amplitude ({unit})")
    axes.margins(y=0.2)


def plot_cost(file: Path | str, runs: Mapping[str, CostRun], title: str = "Cost of accuracy") -> None:
    """Plot triangles and seconds against the achieved error (um), doubly logarithmic, one series for each run.

    The fewest possible triangles are dashed. Raises OutputError if the file cannot be written.
    """
    figure = new_figure((11.0, 5.0))
    left, right = figure.subplots(1, 2)
    for i, (label, run) in enumerate(runs.items()):
        style: dict[str, Any] = {
            "color": CURVE_COLOURS[i % len(CURVE_COLOURS)],
            "marker": _CURVE_MARKERS[i % len(_CURVE_MARKERS)],
            "ms": 5,
        }
        left.loglog(run.error_um, run.triangles, label=label, **style)
        right.loglog(run.error_um, run.seconds, label=label, **style)
        if run.bound is not None:
            left.loglog(run.error_um, run.bound, ls="--", color=style["color"], label=f"{label}: fewest possible")
    for axes, quantity in ((left, "triangles"), (right, "time (s)")):
        axes.set(xlabel="achieved error (µm)", ylabel=quantity)
        axes.grid(True, which="both", color=GRID_LINE_COLOUR, lw=0.6)
        axes.invert_xaxis()
        axes.legend(fontsize=9)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)


def plot_curves(
    file: Path | str,
    curves: Mapping[str, tuple[Array, Array]],
    labels: tuple[str, str],
    title: str = "",
    log_y: bool = False,
) -> None:
    """Plot curves x (N,), y (N,) by their labels; `labels` of the axes include the units.

    Points that are not finite break a curve. Raises OutputError if the file cannot be written.
    """
    figure, axes = _figure()
    for i, (label, (x, y)) in enumerate(curves.items()):
        style = {"color": CURVE_COLOURS[i % len(CURVE_COLOURS)], "marker": _CURVE_MARKERS[i % len(_CURVE_MARKERS)]}
        axes.plot(x, np.where(np.isfinite(y), y, np.nan), ms=4, lw=1.6, label=label, **style)
    axes.set(xlabel=labels[0], ylabel=labels[1], title=title)
    if log_y:
        axes.set_yscale("log")
    if len(curves) > 1:
        axes.legend()
    save_figure(figure, file)


def widen_errors(axes: Any, low: float, high: float) -> None:
    """Give an axis of errors from `low` to `high` at least MIN_TE_RANGE: rounding must not look like a signal."""
    if high - low < MIN_TE_RANGE:
        axes.set_ylim(0.5 * (low + high - MIN_TE_RANGE), 0.5 * (low + high + MIN_TE_RANGE))


def sheet(needed: tuple[float, float], size: tuple[int, int] | None, dpi: float) -> tuple[tuple[float, float], float]:
    """Return a figure's inches and its pixels per inch: the `needed` inches, or a `size` in pixels.

    A size with much less room than needed gets fewer pixels per inch; otherwise words would overlap.
    """
    if size is None:
        return needed, dpi
    room = min(size[0] / needed[0], size[1] / needed[1])
    dots = min(dpi, max(room / _MIN_ROOM_SHARE, min(LEGIBLE_DPI, room / _LEAST_ROOM_SHARE)))
    return (size[0] / dots, size[1] / dots), dots


def _figure() -> tuple[Any, Any]:
    """Return a figure of one plot with a faint grid."""
    figure = new_figure((8.0, 5.0))
    axes = figure.subplots()
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
    return figure, axes


def new_figure(
    inches: tuple[float, float], dpi: float = 150, layout: Literal["constrained"] | None = "constrained"
) -> Any:
    """Return a figure that computes its margins when it is laid out, and measures letters as in the PNG file.

    Without a `layout` axes stay where they are put.
    """
    _load_matplotlib()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=inches, dpi=dpi, layout=layout)
    # without a canvas that keeps its renderer every measurement makes a new one, with all its pixels
    FigureCanvasAgg(figure)
    return figure


def _load_matplotlib() -> None:
    """Load matplotlib's figures. In a process of gearmesh alone its classes get no texts about their properties, which take
    a third of the time."""
    if not is_own_process() or "matplotlib.figure" in sys.modules:
        return
    from matplotlib import artist

    texts = artist.kwdoc
    vars(artist)["kwdoc"] = lambda _: ""
    try:
        import_module("matplotlib.backends.backend_agg")
        import_module("matplotlib.figure")
    finally:
        vars(artist)["kwdoc"] = texts


def lay_out(figure: Any) -> None:
    """Break the title into lines that fit and place all axes, once: saving the figure does not place them again."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    if title := figure.get_suptitle():
        figure.suptitle(fit_title(title, figure, TITLE_POINTS), fontsize=TITLE_POINTS)
    for axes in figure.axes:
        _guess_first(axes)
    engine.execute(figure)
    # "none" would leave a place holder, for which a file is drawn twice
    figure.set_layout_engine(None)
    for axes in figure.axes:
        axes.apply_aspect()


def _guess_first(axes: Any) -> None:
    """Replace the first of two measurements of axes by a guess: it only brings them near their places."""
    from matplotlib.transforms import Bbox

    def estimate(*_: Any, **__: Any) -> Any:
        del axes.get_tightbbox
        axes.apply_aspect()
        left, below, right, above = (inches * axes.figure.dpi for inches in _LABEL_ROOM_INCHES)
        frame = axes.get_window_extent()
        return Bbox.from_extents(frame.x0 - left, frame.y0 - below, frame.x1 + right, frame.y1 + above)

    axes.get_tightbbox = estimate


def save_figure(figure: Any, file: Path | str) -> None:
    """Write a figure; equal figures give equal files (no date, no random names)."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    from gearmesh.io.atomic import whole_file

    kind = Path(file).suffix.lower()
    refuse_suffix(Path(file), PNG_SUFFIX, *_FILE_METADATA)
    lay_out(figure)
    with rc_context({"svg.hashsalt": "gearmesh"}), whole_file(file) as unfinished:
        if kind == PNG_SUFFIX:
            if not hasattr(figure.canvas, "buffer_rgba"):
                # figures that were made without `new_figure`
                FigureCanvasAgg(figure)
            figure.canvas.draw()
            write_png(unfinished, np.asarray(figure.canvas.buffer_rgba())[..., :3], shaded=False, dpi=figure.dpi)
            return
        figure.savefig(unfinished, metadata=_FILE_METADATA[kind])
        if kind == SVG_SUFFIX:
            unfinished.write_text(_same_clips(unfinished.read_text(encoding="utf-8")), encoding="utf-8")


def _same_clips(svg: str) -> str:
    """Return SVG text with clip paths named after their content; matplotlib names them after memory addresses."""
    names: dict[str, str] = {}

    def definition(match: re.Match[str]) -> str:
        name = "p" + hashlib.sha256(match[2].encode()).hexdigest()[:10]
        known = name in names.values()
        names[match[1]] = name
        return "" if known else f'<clipPath id="{name}">{match[2]}</clipPath>'

    text = re.sub(r'<clipPath id="(\w+)">(.*?)</clipPath>', definition, svg, flags=re.DOTALL)
    return re.sub(r"url\(#(\w+)\)", lambda match: f"url(#{names.get(match[1], match[1])})", text)
