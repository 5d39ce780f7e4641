"""Shares of keys in the variance of a figure, for a response of any shape: Sobol indices.

The first order S_i = Var(E[y | x_i]) / Var(y) is the share of key i alone. The total order S_Ti = E[Var(y | x_~i)] /
Var(y) includes its interactions with other keys; S_Ti - S_i is the share due to interactions. The method depends on the
rows:

    a grid                   exact sums over its axes: shares of the grid's own variance
    a Saltelli sample        first and total order, from A, B and A with one column of B [Saltelli et al. 2010, table 2 (b), (f)]
    any other sample         only first order, from the means of y in bins of equal numbers of rows

Saltelli et al., Comput. Phys. Comm. 181 (2010) 259.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearmesh import figures
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.study.plan import Plan

#: sum of the first-order shares below which most of the variance is due to interactions
MIN_FIRST_ORDER_SUM = 0.5
#: smallest number of points of a Saltelli sample that gives shares
MIN_SALTELLI_POINTS = 8
#: smallest number of rows of another sample that gives shares
MIN_SAMPLE_ROWS = 40
#: limit of the bins of a key
MAX_BINS = 50
#: groups of rows that are left out in turn to estimate the errors of bins
JACKKNIFE_GROUPS = 20


@dataclass(frozen=True)
class VarianceShare(figures.Figures):
    """Share of a figure's variance that is a key's of a study; none in total where the rows do not tell."""

    key: str = figures.figure("key of the design")
    figure: str = figures.figure("key of the figure")
    first: float = figures.figure("share of the figure's variance that is the key's alone: Sobol index", symbol="S_i")
    first_error: float = figures.figure("standard error of the share that is the key's alone")
    total: float | None = figures.figure("share in which the key has a part: total Sobol index", symbol="S_Ti")
    total_error: float | None = figures.figure("standard error of the share in which the key has a part")

    @property
    def rank(self) -> float:
        """Share by which keys are ordered: the total share if it is known, else the first-order share."""
        return self.first if self.total is None else self.total


def variance_shares(plan: Plan, keys: Mapping[str, Array], figure: str, values: Array) -> list[VarianceShare]:
    """Return the shares of keys (N,) in a figure (N,) of the rows of a plan, largest first.

    There are none with too few rows, for a grid with a missing value, and for a figure that does not vary.
    """
    known = values[np.isfinite(values)]
    if not known.size or np.ptp(known) <= 1e-12 * np.abs(known).max():
        return []
    shares: Array | None
    if plan.shape:
        shares = grid_shares(values.reshape(plan.shape))
        key_names: tuple[str, ...] = plan.keys
    elif plan.points:
        table = values.reshape(-1, plan.points)
        shares, key_names = saltelli_shares(table[0], table[1], table[2:]), plan.keys
    else:
        is_sequence = plan.about.get("method") == "sobol"
        shares, key_names = binned_shares(np.stack(list(keys.values()), axis=1), values, is_sequence), tuple(keys)
    if shares is None:
        return []
    rows = [
        VarianceShare(key, figure, *(None if np.isnan(share) else float(share) for share in row))  # type: ignore[arg-type]
        for key, row in zip(key_names, shares, strict=True)
        if key in keys
    ]
    return sorted(rows, key=lambda variance_share: -variance_share.rank)


def grid_shares(values: Array) -> Array | None:
    """Return first order, its error, total order and its error (K, 4) of the axes of a full grid.

    None if a value is missing.
    """
    variance = values.var()
    if not np.isfinite(variance):
        return None
    axes = range(values.ndim)
    first = [values.mean(axis=tuple(j for j in axes if j != i)).var() / variance for i in axes]
    total = [values.var(axis=i).mean() / variance for i in axes]
    zero = np.zeros(values.ndim)
    return np.stack((np.array(first), zero, np.array(total), zero), axis=1)


def saltelli_shares(a: Array, b: Array, ab: Array) -> Array | None:
    """Return first order, its error, total order and its error (K, 4) of a Saltelli sample.

    `a` and `b` are the values at points A and B (n,), `ab` the values at A with column i of B (K, n). Points with a
    missing value are left out; the result is None if fewer than MIN_SALTELLI_POINTS are left. The errors hold for
    ratios of means of independent points; points of a Sobol sequence have smaller errors.
    """
    known = np.isfinite(a) & np.isfinite(b) & np.isfinite(ab).all(axis=0)
    count = int(known.sum())
    if count < MIN_SALTELLI_POINTS:
        return None
    middle = 0.5 * (a[known].mean() + b[known].mean())
    a, b, ab = a[known] - middle, b[known] - middle, ab[:, known] - middle
    squares = 0.5 * (a**2 + b**2)
    variance = squares.mean()
    columns = []
    for products in (b * (ab - a), 0.5 * (a - ab) ** 2):
        share = products.mean(axis=1) / variance
        columns += [share, (products - share[:, None] * squares).std(axis=1, ddof=1) / (variance * np.sqrt(count))]
    return np.stack(columns, axis=1)


def binned_shares(keys: Array, values: Array, even: bool = False) -> Array | None:
    """Return first order and its error (K, 4), without total orders (NaN), from keys (N, K) and values (N,) of
    independent rows.

    Rows are sorted into bins of equal numbers by one key after the other. The variance of the means of bins estimates
    Var(E[y | x_i]), but contains a chance part: the variance of the rest divided by the rows of a bin. This part is
    subtracted, except for rows of a sequence (`even` in all keys), which have almost none of it. The error combines the
    jackknife over JACKKNIFE_GROUPS groups of rows and the chance part. Returns None with fewer than MIN_SAMPLE_ROWS
    rows.
    """
    known = np.isfinite(values)
    count = int(known.sum())
    if count < MIN_SAMPLE_ROWS:
        return None
    y = values[known] - values[known].mean()
    bins = int(np.clip(np.sqrt(count) / 2.0, 2, MAX_BINS))
    bin_number = keys[known].argsort(axis=0, kind="stable").argsort(axis=0, kind="stable") * bins // count
    # groups are drawn at random, because the rows of a sequence have a pattern
    group = np.random.default_rng(0).permutation(count) % JACKKNIFE_GROUPS
    shares = np.full((keys.shape[1], 4), np.nan)
    for k in range(keys.shape[1]):
        cell = group * bins + bin_number[:, k]
        table = np.stack(
            [
                np.bincount(cell, weight, JACKKNIFE_GROUPS * bins).reshape(JACKKNIFE_GROUPS, bins)
                for weight in (np.ones(count), y, y**2)
            ]
        )
        whole = table.sum(axis=1, keepdims=True)
        (share,), (chance,) = _of_bins(whole)
        without = np.subtract(*_of_bins(whole - table))
        shares[k, 0] = share if even else share - chance
        shares[k, 1] = np.hypot(
            np.sqrt((JACKKNIFE_GROUPS - 1) / JACKKNIFE_GROUPS * ((without - without.mean()) ** 2).sum()), chance
        )
    return shares


def _of_bins(table: Array) -> tuple[Array, Array]:
    """Return shares (G,) of bins and the parts (G,) of them that are due to chance.

    `table` (3, G, B): number, sum and sum of squares of the rows in B bins.
    """
    number, total, square = table
    count, bins = number.sum(axis=1), number.shape[1]
    middle = total.sum(axis=1) ** 2 / count
    variation = square.sum(axis=1) - middle
    between_bins = (total**2 / np.maximum(number, 1.0)).sum(axis=1) - middle
    return between_bins / variation, (bins - 1) * (variation - between_bins) / (count - bins) / variation
