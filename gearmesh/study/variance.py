"""Shares of a figure's variance that keys account for, whatever the response is like: Sobol's indices.

First order S_i = Var(E[y | x_i]) / Var(y) is the share of key i alone, total order S_Ti = E[Var(y | x_~i)] / Var(y) that of all in
which it has a part: what is between them is what it does together with others. How they are found depends on the rows:

    a grid                   exactly, by sums over its axes: shares of the grid's own variance
    a Saltelli sample        first and total order, from A, B and A with one column of B [Saltelli et al. 2010, table 2 (b), (f)]
    any other sample         first order alone, from the means of y in bins of equal numbers of rows

Saltelli et al., Comput. Phys. Comm. 181 (2010) 259.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearmesh import figures
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.study.plan import Plan

#: share of all keys by themselves below which most is what they do together
HALF = 0.5
#: least points of a Saltelli sample, and least rows of others, that tell anything
FEWEST_POINTS, FEWEST_ROWS = 8, 40
#: most bins, and groups of rows that are left out in turn for the errors of bins
MOST_BINS, GROUPS = 50, 20


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
        """By what keys are ordered: the total share where it is known."""
        return self.first if self.total is None else self.total


def variance_shares(plan: Plan, keys: Mapping[str, Array], figure: str, values: Array) -> list[VarianceShare]:
    """Of keys (N,) in a figure (N,) of the rows of a plan, the greatest first; none where there are too few rows, where a grid
    has holes and where nothing varies."""
    known = values[np.isfinite(values)]
    if not known.size or np.ptp(known) <= 1e-12 * np.abs(known).max():
        return []
    shares: Array | None
    if plan.shape:
        shares = grid_shares(values.reshape(plan.shape))
        every: tuple[str, ...] = plan.keys
    elif plan.points:
        table = values.reshape(-1, plan.points)
        shares, every = saltelli_shares(table[0], table[1], table[2:]), plan.keys
    else:
        even = plan.about.get("method") == "sobol"
        shares, every = binned_shares(np.stack(list(keys.values()), axis=1), values, even), tuple(keys)
    if shares is None:
        return []
    rows = [
        VarianceShare(key, figure, *(None if np.isnan(share) else float(share) for share in row))  # type: ignore[arg-type]
        for key, row in zip(every, shares, strict=True)
        if key in keys
    ]
    return sorted(rows, key=lambda variance_share: -variance_share.rank)


def grid_shares(values: Array) -> Array | None:
    """First order, its error, total order and its error (K, 4) of the axes of a full grid; None where a value is missing."""
    variance = values.var()
    if not np.isfinite(variance):
        return None
    axes = range(values.ndim)
    first = [values.mean(axis=tuple(j for j in axes if j != i)).var() / variance for i in axes]
    total = [values.var(axis=i).mean() / variance for i in axes]
    zero = np.zeros(values.ndim)
    return np.stack((np.array(first), zero, np.array(total), zero), axis=1)


def saltelli_shares(a: Array, b: Array, ab: Array) -> Array | None:
    """The same (K, 4) from values at points of A (n,), of B (n,) and of A with column i of B (K, n).

    Points of which a value is missing are left out; None where fewer than FEWEST_POINTS are left. The errors are those of ratios
    of means of independent points: points of a Sobol sequence have smaller ones.
    """
    known = np.isfinite(a) & np.isfinite(b) & np.isfinite(ab).all(axis=0)
    count = int(known.sum())
    if count < FEWEST_POINTS:
        return None
    middle = 0.5 * (a[known].mean() + b[known].mean())
    a, b, ab = a[known] - middle, b[known] - middle, ab[:, known] - middle
    squares = 0.5 * (a**2 + b**2)
    variance = squares.mean()
    columns = []
    for part in (b * (ab - a), 0.5 * (a - ab) ** 2):
        share = part.mean(axis=1) / variance
        columns += [share, (part - share[:, None] * squares).std(axis=1, ddof=1) / (variance * np.sqrt(count))]
    return np.stack(columns, axis=1)


def binned_shares(keys: Array, values: Array, even: bool = False) -> Array | None:
    """The same (K, 4), without total orders (NaN), from keys (N, K) and values (N,) of independent rows.

    Rows are put into bins of equal numbers by one key after the other. The variance of the bins' means is that of E[y | x_i] and,
    by chance, of the rest over the rows of a bin, which is taken off. Rows of a sequence, `even` in all keys, have next to nothing
    of it. The error is that of leaving out a twentieth of the rows in turn (the jackknife), and as much as is by chance besides.
    None with fewer than FEWEST_ROWS.
    """
    known = np.isfinite(values)
    count = int(known.sum())
    if count < FEWEST_ROWS:
        return None
    y = values[known] - values[known].mean()
    bins = int(np.clip(np.sqrt(count) / 2.0, 2, MOST_BINS))
    place = keys[known].argsort(axis=0, kind="stable").argsort(axis=0, kind="stable") * bins // count
    # rows of a sequence have a pattern: groups must not
    group = np.random.default_rng(0).permutation(count) % GROUPS
    shares = np.full((keys.shape[1], 4), np.nan)
    for k in range(keys.shape[1]):
        cell = group * bins + place[:, k]
        table = np.stack(
            [np.bincount(cell, weight, GROUPS * bins).reshape(GROUPS, bins) for weight in (np.ones(count), y, y**2)]
        )
        whole = table.sum(axis=1, keepdims=True)
        (share,), (chance,) = _of_bins(whole)
        without = np.subtract(*_of_bins(whole - table))
        shares[k, 0] = share if even else share - chance
        shares[k, 1] = np.hypot(np.sqrt((GROUPS - 1) / GROUPS * ((without - without.mean()) ** 2).sum()), chance)
    return shares


def _of_bins(table: Array) -> tuple[Array, Array]:
    """Shares (G,), and what of them is by chance (G,), from number, sum and sum of squares (3, G, B) of the rows in B bins."""
    number, total, square = table
    count, bins = number.sum(axis=1), number.shape[1]
    middle = total.sum(axis=1) ** 2 / count
    every = square.sum(axis=1) - middle
    between = (total**2 / np.maximum(number, 1.0)).sum(axis=1) - middle
    return between / every, (bins - 1) * (every - between) / (count - bins) / every
