"""Statistics of the rows of a study: percentiles, sensitivities, and yield against limits."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh import figures
from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.numerals import parse_number
from gearmesh.records import dataclass

#: percentiles of each figure that the summary reports
REPORTED_PERCENTILES = (1, 5, 50, 95, 99)
#: smallest R^2 at which slopes rank the keys: the rest of the variance is at most a tenth
MIN_LINEAR_R2 = 0.9


def as_number(value: Any) -> float:
    """Return a recorded value as a number; NaN if there is none, or a text."""
    return float(value) if isinstance(value, int | float) else np.nan


@dataclass(frozen=True)
class Limit:
    """Limit of a figure, which has to be below (sense -1) or above (+1) a value."""

    figure: str
    sense: int
    value: float

    @property
    def text(self) -> str:
        return f"{self.figure} {'<' if self.sense < 0 else '>'} {self.value:g}"

    def room(self, values: Array) -> Array:
        """Return the distances of values of the figure from the limit."""
        return self.sense * (values - self.value)

    def holds(self, values: Array) -> NDArray[np.bool_]:
        """Return where values of the figure keep the limit."""
        with np.errstate(invalid="ignore"):
            good: NDArray[np.bool_] = self.room(values) > 0.0
        return good


def limit_of(text: str, names: Sequence[str] | None) -> Limit:
    """Return the limit of a text such as "contact_ratio>1". If `names` are given, its figure must be one of them.

    Raises ArgumentError naming what is allowed.
    """
    match = re.fullmatch(r"\s*(\w+)\s*([<>])\s*([-+.\deE]+)\s*", text, re.ASCII)
    value = parse_number(match[3]) if match else None
    if match is None or value is None:
        raise ArgumentError("limit", entry=text, reason="must look like contact_ratio>1 or te_peak_to_peak_arcsec<10")
    if names is not None and match[1] not in names:
        raise ArgumentError("limit", entry=text, reason=f"not recorded; the recorded figures are {', '.join(names)}")
    return Limit(match[1], -1 if match[2] == "<" else 1, value)


@dataclass(frozen=True)
class Effect(figures.Figures):
    """Effect of a key of a study on a figure, by least squares over all keys at once."""

    key: str = figures.figure("key of the design")
    figure: str = figures.figure("key of the figure")
    slope: float = figures.figure("change of the figure over that of the key")
    swing: float = figures.figure("slope times the range of the key between its 5th and 95th percentile")
    low: float = figures.figure("figure at the low end of that range, the other keys at their means")
    high: float = figures.figure("figure at the high end of that range, the other keys at their means")
    explained: float = figures.figure(
        "share of the figure's variance that all keys together account for in straight lines", symbol="R^2"
    )
    linear: bool = figures.figure("whether straight lines account for nearly all of the figure's variance")


def effects(keys: Mapping[str, Array], figure: str, values: Array) -> list[Effect]:
    """Return the effects of keys (N,) on a figure (N,), largest swing first; none if there are too few rows."""
    known = np.isfinite(values)
    table = np.stack([column[known] for column in keys.values()], axis=1)
    spread = np.ptp(table, axis=0) if known.any() else np.zeros(len(keys))
    free = np.flatnonzero(spread > 0.0)
    if known.sum() < len(free) + 2 or not free.size:
        return []
    y = values[known]
    middle = table[:, free].mean(axis=0)
    scaled = (table[:, free] - middle) / spread[free]
    slope = np.linalg.lstsq(scaled, y - y.mean(), rcond=None)[0] / spread[free]
    left = y - y.mean() - (table[:, free] - middle) @ slope
    total = float(((y - y.mean()) ** 2).sum())
    # a figure that is the same in all rows leaves no residual
    explained = 1.0 - float((left**2).sum()) / total if total > 0.0 else 1.0
    rows = []
    for k, index in enumerate(free):
        low, high = np.percentile(table[:, index], (5, 95))
        ends = y.mean() + slope[k] * (np.array([low, high]) - middle[k])
        rows.append(
            Effect(
                list(keys)[index],
                figure,
                float(slope[k]),
                float(ends[1] - ends[0]),
                float(ends[0]),
                float(ends[1]),
                explained,
                explained >= MIN_LINEAR_R2,
            )
        )
    return sorted(rows, key=lambda effect: -abs(effect.swing))


def percentiles(values: Array) -> list[float]:
    """Return REPORTED_PERCENTILES of the known values; NaN if none is known."""
    known = values[np.isfinite(values)]
    return (
        [float(percentile) for percentile in np.percentile(known, REPORTED_PERCENTILES)]
        if known.size
        else [np.nan] * len(REPORTED_PERCENTILES)
    )
