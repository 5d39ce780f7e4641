"""Spur pair of tooth pairs of constant stiffness with linear tip relief, in closed form and by solving its equilibrium.

The force F is shared by tooth pairs of stiffness c each. With a relief C of both tips that begins where the double contact
ends (long relief), the reliefs of the two tooth pairs in double contact sum to C everywhere. The deflection is F / c in
single contact and F / (2 c) + C / 2 in double contact: equal for C = F / c, where the transmission error is constant.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from gearmesh import Summary
from gearmesh.contact.assemblies import assembly_paths
from gearmesh.study.rows.work import StudyWork, Variant

#: contact ratio, force (N), stiffness of a tooth pair (N/um): the best long relief is 1000 / 80 = 12.5 um
CONTACT_RATIO, FORCE_N, STIFFNESS = 1.6, 1000.0, 80.0
BEST_RELIEF_UM = FORCE_N / STIFFNESS
#: phases of a pitch
PHASES = np.linspace(0.0, 1.0, 101)


def deflection(relief: NDArray[np.float64]) -> NDArray[np.float64]:
    """Approach (P,), um, of tooth pairs with reliefs (K, P), um, NaN where a pair is out of mesh, under FORCE_N."""
    gaps = np.sort(np.where(np.isnan(relief), np.inf, relief), axis=0)
    count = np.arange(1, len(gaps) + 1)[:, None]
    # approach if the k nearest pairs carry: the right k is the largest whose last pair is still pressed
    approach = (FORCE_N / STIFFNESS + np.cumsum(np.where(np.isinf(gaps), 0.0, gaps), axis=0)) / count
    carries = (approach > gaps) & np.isfinite(gaps)
    last = carries.sum(axis=0) - 1
    return np.asarray(np.take_along_axis(approach, last[None], axis=0)[0])


def peak_to_peak(relief_um: float, length: float = 1.0) -> float:
    """Transmission error, um, for a relief over a `length`, in parts of the double contact (1: long relief)."""
    double = CONTACT_RATIO - 1.0
    place = PHASES + np.arange(-1, 3)[:, None]
    ends = np.minimum(place, CONTACT_RATIO - place)
    relief = relief_um * np.clip(1.0 - ends / (length * double), 0.0, None)
    return float(np.ptp(deflection(np.where(ends < 0.0, np.nan, relief))))


@dataclass(frozen=True)
class Model(StudyWork):
    """Work of a study whose figures are those of a function of the varied keys."""

    function: Callable[..., Sequence[float]] = lambda *_: ()

    def __call__(self, rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
        found: list[list[Any]] = []
        for row in rows:
            if not row:  # the design itself, which sets no varied key
                found.append([None] * len(self.names) + [""])
                continue
            try:
                found.append([*map(float, self.function(**dict(zip(self.keys, row, strict=True)))), ""])
            except ArithmeticError as failure:
                found.append([None] * len(self.names) + [str(failure)])
        return found


@dataclass(frozen=True)
class ExactFlanks(StudyWork):
    """Work of a study of spur gears with exact flanks, and tooth pairs of constant stiffness.

    The positions of the design must divide a pitch equally.
    """

    def __call__(self, rows: Sequence[Sequence[Any]]) -> list[list[Any]]:
        found: list[list[Any]] = []
        for variant, _, _ in self._variants(rows):
            assert isinstance(variant, Variant), variant
            paths = assembly_paths(variant.flanks, variant.bases({"": np.zeros(1)}), variant.phi1)
            gear = variant.pair.gear.tooth
            base = 0.5 * variant.design.in_mm().module * gear.teeth * np.cos(np.radians(20.0))
            # relief of a tooth pair: how far it lags, along the line of action
            relief = np.where(paths.surface, -1e3 * base * paths.advance, np.nan)[0]
            steps = round(variant.pair.pitch / float(np.diff(variant.phi1).mean()))
            columns = len(relief) // steps * steps
            found.append([float(np.ptp(deflection(relief[:columns].reshape(-1, steps)))), ""])
        return found


def replace_work(monkeypatch: pytest.MonkeyPatch, function: Callable[..., Sequence[float]]) -> list[dict[str, Any]]:
    """Let optimisations evaluate a function of short names of the varied keys; return the calls that it gets."""
    from gearmesh.optimize import optimize

    calls: list[dict[str, Any]] = []

    def counted(**keys: Any) -> Sequence[float]:
        own = {key.rpartition(".")[2]: value for key, value in keys.items()}
        calls.append(own)
        return function(**own)

    def work(
        design: Any, keys: tuple[str, ...], pair: Any, names: tuple[str, ...], torque: Any, level: str
    ) -> tuple[Model, Summary]:
        return Model(design.stated(), keys, pair, (), tuple(names), torque=torque or (), function=counted), Summary()

    monkeypatch.setattr(optimize, "work_and_nominal", work)
    return calls


def replace_work_by_exact_flanks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let optimisations evaluate exact flanks with tooth pairs of constant stiffness."""
    from gearmesh.optimize import optimize

    def work(
        design: Any, keys: tuple[str, ...], pair: Any, names: tuple[str, ...], torque: Any, level: str
    ) -> tuple[ExactFlanks, Summary]:
        return ExactFlanks(design.stated(), keys, pair, ("path",), tuple(names), torque=torque or ()), Summary()

    monkeypatch.setattr(optimize, "work_and_nominal", work)
