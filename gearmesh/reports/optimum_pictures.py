"""Pictures of an optimum: the best value over the designs or the front, and the sensitivities."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmesh.optimize.optimum import SENSITIVITY_SHARE, Optimum
from gearmesh.view.diagrams.optimum_plots import ObjectivePlot, plot_front, plot_progress
from gearmesh.view.diagrams.study_plots import SwingBars, plot_tornado

#: step of a key for its sensitivity, in words
SENSITIVITY_STEP = f"{100.0 * SENSITIVITY_SHARE:g} %"
#: ends of the bars of sensitivities, in words
BAR_ENDS = (f"key smaller by {SENSITIVITY_STEP} of its range", f"larger by {SENSITIVITY_STEP}")


def optimum_pictures(optimum: Optimum, folder: Path) -> list[Path]:
    """Write the pictures of an optimum and return their files."""
    title, columns, summary = optimum.design.title, optimum.to_dict(), optimum.summary
    feasible = np.array(columns["feasible"], dtype=bool)
    labels = {name: f"{name}, {unit}" if unit else name for name, unit in optimum.units.items()}
    objectives = [
        ObjectivePlot(
            labels[name],
            -1 if way == "minimize" else 1,
            np.array(columns[name], dtype=float),
            summary.before.objectives[name],
            summary.best.objectives[name],
        )
        for name, way in summary.objectives.items()
    ]
    keys = ", ".join(each.key for each in summary.variables)
    made = []
    if len(objectives) == 1:
        made.append(folder / "progress.png")
        plot_progress(made[-1], objectives[0], feasible, f"{title}: best over {keys}")
    else:
        made.append(folder / "front.png")
        plot_front(
            made[-1], objectives, feasible, np.array(columns["front"], dtype=bool), f"{title}: front over {keys}"
        )
    bars = [
        SwingBars(
            name,
            value,
            [
                (each.key, each.low, each.high)
                for each in summary.sensitivities
                if each.changed == name and each.low is not None and each.high is not None
            ],
            labels[name],
            BAR_ENDS,
            "at the optimum",
        )
        for name, value in {**summary.best.objectives, **summary.best.limited}.items()
    ]
    bars = [each for each in bars if each.keys]
    if bars:
        made.append(folder / "sensitivities.png")
        plot_tornado(made[-1], bars, f"{title}: one key leaves the optimum by {SENSITIVITY_STEP} of its range")
    return made
