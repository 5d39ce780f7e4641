"""Which pictures suit a study, and what is in them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.assemblies import AssemblyPaths
from gearmesh.contact.path import ARCSEC
from gearmesh.study.path_figures import PHASES, carries, gears_lead
from gearmesh.study.statistics import PERCENTILES
from gearmesh.view.study_plots import (
    PatternCell,
    StudyFigure,
    plot_histograms,
    plot_pattern_matrix,
    plot_responses,
    plot_tornado,
)

if TYPE_CHECKING:
    from gearmesh.api.study import Study
    from gearmesh.api.study_work import Variant

#: values of a key up to which a grid is a matrix of patterns
CELLS = 9
#: rows from which on a histogram says something
MANY = 20


def study_pictures(study: Study, folder: Path) -> list[Path]:
    """Responses, sensitivities of two keys or more, histograms of many rows, the matrix of patterns of small grids."""
    name = study.design.name or study.design.kind
    figures = [_figure(study, each) for each in study.plotted]
    numeric = {key: study.numbers(key) for key in study.plan.keys}
    keys = [(_labelled(study, key), values) for key, values in numeric.items() if np.isfinite(values).all()]
    made: list[Path] = []

    def file(stem: str) -> Path:
        made.append(folder / f"{stem}.png")
        return made[-1]

    if figures and keys:
        shape = study.plan.shape if len(keys) == len(study.plan.keys) else ()
        plot_responses(file("responses"), keys, figures, shape, f"{name}: response to {', '.join(study.plan.keys)}")
    effects = study.effects
    if len({each.key for each in effects}) > 1:
        bars = []
        for each in figures:
            own = [(e.key, e.low, e.high) for e in effects if e.figure == each.name]
            if own:
                bars.append((each.name, own, float(np.nanmean(each.values))))
        plot_tornado(file("tornado"), bars, f"{name}: sensitivities")
    if figures and len(study.plan) >= MANY:
        good = "" if study.good is None else f", yield {100.0 * study.good:.4g} %"
        plot_histograms(file("histograms"), figures, PERCENTILES, f"{name}: {len(study.plan)} rows{good}")
    if 1 <= len(study.plan.shape) <= 2 and max(study.plan.shape) <= CELLS:
        _matrix(study, file("patterns"), name)
    return made


def _figure(study: Study, name: str) -> StudyFigure:
    return StudyFigure(name, study.numbers(name), tuple(each.value for each in study.limits if each.figure == name))


def _labelled(study: Study, key: str) -> str:
    """A key with its unit."""
    known = type(study.design).key_at(key)
    unit = "" if known is None else {"length": study.design.units, "angle": "deg"}.get(known.unit, "")
    return f"{key} ({unit})" if unit else key


def _matrix(study: Study, file: Path, name: str) -> None:
    """The first key from left to right, the second from the top down."""
    plan = study.plan
    found = study.work.paths(plan.rows(0, len(plan)))
    cells = [each if isinstance(each, str) else _cell(*each) for each in found]
    across, down = (*plan.shape, 1)[:2]
    table = [[cells[j * down + i] for j in range(across)] for i in range(down)]
    first, *rest = plan.keys
    values = [row[0] for row in plan.rows(0, len(plan))][::down]
    columns = [f"{first} = {_short(value)}" for value in values]
    rows = [f"{rest[0]}\n= {_short(plan.columns[rest[0]][i])}" for i in range(down)] if rest else [""]
    plot_pattern_matrix(file, table, columns, rows, f"{name}: contact on the pinion over {', '.join(plan.keys)}")


def _short(value: object) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _cell(variant: Variant, paths: AssemblyPaths) -> PatternCell | str:
    """One assembly as it is drawn; transmission errors are counted from that of the gears at its greatest lead."""
    from gearmesh.api.study_work import NO_CONTACT

    if not paths.touching.any():
        return NO_CONTACT
    pair, frame = variant.pair, variant.frame
    lead = gears_lead(paths, pair.pitch)[0]
    top = float(np.nanmax(lead)) if np.isfinite(lead).any() else float(np.nanmax(paths.lead))
    phase = np.degrees(np.arange(PHASES + 1) * pair.pitch / PHASES)
    te = pair.drive * (np.append(lead, lead[0]) - top) / ARCSEC
    return PatternCell(
        outline=frame.outline,
        path=frame.places(paths.point[0]),
        surface=paths.surface[0],
        edge=(paths.touching & ~paths.surface & carries(paths, pair.pitch))[0],
        axes=frame.directions(paths.point[0][:, None], paths.axes[0]),
        phi1=np.degrees(paths.phi1),
        te=pair.drive * (paths.lead[0] - top) / ARCSEC,
        gears=np.stack((phase, te)),
        pitch=float(np.degrees(pair.pitch)),
    )
