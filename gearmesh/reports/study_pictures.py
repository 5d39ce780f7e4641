"""Pictures of a study: a selection that suits its plan, and their contents."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from gearmesh.design.core import Design
from gearmesh.kernel.numeric.algebra import ARCSEC, cross
from gearmesh.kernel.numeric.algebra import unit as unit_vector
from gearmesh.study.rows.path_figures import carries
from gearmesh.study.rows.patterns import AssemblyContact
from gearmesh.study.rows.work import displacing_keys
from gearmesh.study.statistics import REPORTED_PERCENTILES
from gearmesh.study.study import Study
from gearmesh.study.variance import MIN_FIRST_ORDER_SUM
from gearmesh.view.diagrams.flank_plane import FlankPlane
from gearmesh.view.diagrams.pattern_matrix import PatternCell, pattern_cell, plot_matrix
from gearmesh.view.diagrams.study_plots import (
    ShareBars,
    StudyFigure,
    SwingBars,
    plot_histograms,
    plot_responses,
    plot_tornado,
)
from gearmesh.view.scene import MemberContact

#: exact transmission error of the gears, if the study records it
MESH_TE_KEY = "mesh_te_peak_to_peak_arcsec"
#: limit of the values of each key of a grid that is drawn as a matrix of patterns
MAX_MATRIX_VALUES = 9
#: points across and along the flank on which its patterns are drawn
PATTERN_GRID = (61, 121)
#: letters in a line of a label, which is broken where it is drawn
LINE_LETTERS = 999
#: smallest number of rows for a histogram
MIN_HISTOGRAM_ROWS = 20


def study_pictures(study: Study, folder: Path) -> list[Path]:
    """Write the pictures of a study and return their files.

    These are responses, sensitivities of two keys or more, histograms of many rows, and the matrix of patterns of small
    grids.
    """
    name = study.design.title
    figures = [_figure(study, name_of_figure) for name_of_figure in study.plotted_figures]
    numeric = {key: study.numbers(key) for key in study.plan.keys}
    keys = [(_label(study, key), values) for key, values in numeric.items() if np.isfinite(values).all()]
    made: list[Path] = []

    def file(stem: str) -> Path:
        made.append(folder / f"{stem}.png")
        return made[-1]

    if figures and keys:
        shape = study.plan.shape if len(keys) == len(study.plan.keys) else ()
        plot_responses(file("responses"), keys, figures, shape, f"{name}: response to {', '.join(study.plan.keys)}")
    if len({effect.key for effect in study.effects}) > 1:
        labels = {key: _label(study, key) for key in study.plan.keys}
        plot_tornado(file("tornado"), sensitivity_bars(study), f"{name}: sensitivities", labels)
    if figures and len(study.plan) >= MIN_HISTOGRAM_ROWS:
        good = "" if study.good is None else f", yield {100.0 * study.good:.4g} %"
        plot_histograms(file("histograms"), figures, REPORTED_PERCENTILES, f"{name}: {len(study.plan)} rows{good}")
    if 1 <= len(study.plan.shape) <= 2 and max(study.plan.shape) <= MAX_MATRIX_VALUES:
        pattern_matrix(study, file("patterns"), name)
    return made


def _figure(study: Study, name: str) -> StudyFigure:
    entry = study.nominal.entry(name)
    stem, unit = (name, "") if entry is None else (entry.figure.stem, entry.figure.unit.replace("um", "\u00b5m"))
    limits = tuple(limit.value for limit in study.limits if limit.figure == name)
    meaning = "" if entry is None else entry.figure.meaning
    return StudyFigure(name, stem, unit, study.numbers(name), limits, meaning)


def sensitivity_bars(study: Study) -> list[SwingBars | ShareBars]:
    """Return bars for every figure with effects of keys: swings if it is nearly linear, else shares of its variance."""
    bars: list[SwingBars | ShareBars] = []
    for name in study.plotted_figures:
        figure_effects = [effect for effect in study.effects if effect.figure == name]
        label = _figure(study, name).label(LINE_LETTERS)
        if figure_effects and figure_effects[0].linear:
            middle = float(np.nanmean(study.numbers(name)))
            bars.append(
                SwingBars(
                    name,
                    middle,
                    [(effect.key, effect.low, effect.high) for effect in figure_effects],
                    label,
                )
            )
        elif figure_effects:
            shares = [
                (share.key, share.first, share.first_error, _number(share.total), _number(share.total_error))
                for share in study.variance
                if share.figure == name
            ]
            alone = sum(first for _, first, *_ in shares)
            hidden = shares and np.isnan(shares[0][3]) and alone < MIN_FIRST_ORDER_SUM
            remark = f"first order {100.0 * max(alone, 0.0):.0f} %: most of it are interactions" if hidden else ""
            bars.append(ShareBars(name, figure_effects[0].explained, shares, remark, label))
    return bars


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _label(study: Study, key: str) -> str:
    """Return the name of a key with its unit, and what it means; of an assembly error, what it means if it is positive."""
    design = study.design
    known = design.key_at(key) if isinstance(design, Design) else None
    if known is None or not isinstance(design, Design):
        return key
    unit = {"length": design.units, "angle": "deg"}.get(known.unit, "")
    moving = key in displacing_keys(design.kind)
    named = f"{key.rpartition('.')[2] if moving else key}{f', {unit}' if unit else ''}"
    return f"{named} ({'+: ' if moving else ''}{known.about})" if known.about else named


def pattern_matrix(study: Study, file: Path, name: str) -> None:
    """Draw the matrix of patterns of a grid of one or two keys: the first key from left to right, the second upwards."""
    plan = study.plan
    given = plan.rows(0, len(plan))
    planes: dict[int, FlankPlane] = {}
    exact = study.numbers(MESH_TE_KEY).tolist() if MESH_TE_KEY in study.figures else [None] * len(given)
    cells = [
        PatternCell(reason=assembly) if isinstance(assembly, str) else _cell(assembly, planes, peak_to_peak)
        for assembly, peak_to_peak in zip(study.assemblies(), exact, strict=True)
    ]
    down = plan.shape[1] if len(plan.shape) > 1 else 1
    axes: list[tuple[str, Sequence[object]]] = [
        (_label(study, key), [row[k] for row in values])
        for k, (key, values) in enumerate(zip(plan.keys, (given[::down], given[:down]), strict=False))
    ]
    columns, rows = (*axes, ("", [""]))[:2]
    title = f"{name}: contact on the pinion over {', '.join(plan.keys)}"
    plot_matrix(file, [cells[i::down] for i in range(down)], rows, columns, title)


def _cell(contact: AssemblyContact, planes: dict[int, FlankPlane], peak_to_peak: float | None) -> PatternCell:
    """Return one cell of the matrix. Transmission errors are relative to the largest advance of the gears.

    `peak_to_peak` (arcsec) is the exact value of the mesh cycle, None if the study has not recorded it. `planes` caches
    the planes of designs; assemblies of the same built design share them.
    """
    pair, frame, advance = contact.pair, contact.frame, contact.advance
    plane = planes.setdefault(id(frame), FlankPlane(pair.pinion, pair.flanks[0], frame.as_drawn, PATTERN_GRID))
    top = float(np.nanmax(advance)) if np.isfinite(advance).any() else float(np.nanmax(contact.paths.advance))
    rad, unit = pair.output.reading.error
    tooth_pair, gears = (
        pair.drive * (values - top) / rad for values in (contact.paths.advance[0], np.append(advance, advance[0]))
    )
    curves = np.stack((np.degrees(contact.paths.phi1), tooth_pair)), np.stack((np.degrees(contact.phase), gears))
    mesh_te = None if peak_to_peak is None else peak_to_peak * ARCSEC / rad
    return pattern_cell(plane, _on_pinion(contact), *curves, unit, mesh_te)


def _on_pinion(contact: AssemblyContact) -> MemberContact:
    """Return the contact of one assembly on its pinion: inside both flanks, or on an edge that carries load."""
    paths = contact.paths
    surface = paths.surface[0]
    edge = (paths.touching & ~paths.surface & carries(paths, contact.pair.pitch))[0]
    point, axes = np.where((surface | edge)[:, None], paths.point[0], np.nan), paths.axes[0]
    half = np.where(surface[:, None], np.linalg.norm(axes, axis=-1), np.nan)
    major, minor = np.moveaxis(unit_vector(axes), 1, 0)
    return MemberContact(point, cross(major, minor), major, minor, half[:, 0], half[:, 1], edge, contact.lines)
