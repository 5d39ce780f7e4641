"""Cholesky factor of a stiff body in layers: in meshes that run from toe to heel only neighbouring layers are coupled.

Unknowns are grouped by layer, so that the stiffness K is block tridiagonal. Its factor K = L L^T is block bidiagonal:

    L_k L_k^T = K_kk - W_k W_k^T        W_k = K_k,k-1 L_(k-1)^-T

Results are products Y^T Y of columns Y = L^-1 F, the forward half of a solution. They give responses F_a^T K^-1 F_b to
loads F, and the stiffness of the body to unknowns that were excluded. They are sums over the layers, so that no more
than two layers of L and Y are in memory: all of Y took 0.13 GB for a gear.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import go_on

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Index = NDArray[np.int64]


def levels(stiffness: csr_array, start: Index, held: Index) -> Index:
    """Return the level (N,) of each unknown: how many couplings it is away from the unknowns `start`; -1 for the
    unknowns `held`, and beyond them.

    Unknowns of levels that are not next to each other are not coupled. There are more levels, with fewer unknowns, from
    the top of a tooth down than from toe to heel.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    free = np.setdiff1d(np.arange(stiffness.shape[0]), held)
    row = np.repeat(np.arange(stiffness.shape[0]), np.diff(stiffness.indptr))
    coupled = csr_array((np.ones(row.size), (row, stiffness.indices)), shape=stiffness.shape)[free][:, free]
    begin = np.flatnonzero(np.isin(free, start))
    steps = dijkstra(coupled, indices=begin, unweighted=True, min_only=True)
    level = np.full(stiffness.shape[0], -1)
    level[free] = np.where(np.isfinite(steps), steps, -1)
    return level


def cheapest(layerings: Sequence[Index], loads: csr_array) -> Index:
    """Return the layering (N,) with the fewest operations for loads (N, M), among those that contain as many unknowns
    as the first."""
    unknowns_of_first = np.count_nonzero(layerings[0] >= 0)
    whole = [layer for layer in layerings if np.count_nonzero(layer >= 0) == unknowns_of_first]

    def operations(layer: Index) -> float:
        members = [np.flatnonzero(layer == k) for k in range(int(layer.max()) + 1)]
        sizes = np.array([float(len(own)) for own in members])
        last, begun = np.append(0.0, sizes[:-1]), _order(loads, members)[1].astype(float)
        # Cholesky factor of a layer, coupling to the layer before, both of all columns that have begun
        per_layer = sizes**3 / 3.0 + last**2 * sizes + 2.0 * sizes**2 * last
        return float((per_layer + (sizes**2 + 2.0 * sizes * last) * begun).sum())

    return min(whole, key=operations)


def responses(
    stiffness: csr_array, layer: Index, loads: csr_array, asked: Sequence[tuple[slice, slice]]
) -> list[Array]:
    """Return F_a^T K^-1 F_b for pairs of ranges of columns of the loads F (N, M) over all unknowns.

    Unknown k of the stiffness K (N, N) belongs to layer `layer` (N,); unknowns of layer -1 are held. Raises
    NoSolutionError if elements are turned inside out.
    """
    from scipy.linalg import LinAlgError, cholesky, solve_triangular

    loads = loads.tocsr()
    every = np.arange(loads.shape[1])
    products = [np.zeros((every[one].size, every[other].size)) for one, other in asked]
    ranges = {(part.start, part.stop) for parts in asked for part in parts}
    members = [np.flatnonzero(layer == k) for k in range(int(layer.max()) + 1)]
    # a column is 0 up to the layer of its first load: columns are sorted by this layer
    order, active_columns = _order(loads, members)
    in_order = np.argsort(order)
    factor, last = np.zeros((0, 0)), np.zeros((0, 0))
    for k, (own, count) in enumerate(zip(members, active_columns.tolist(), strict=True)):
        go_on()
        rows = stiffness[own]
        block = rows[:, own].toarray()
        columns = loads[own][:, order[:count]].toarray()
        # what the layer before leaves of the layer's own stiffness and loads
        if k:
            coupling = rows[:, members[k - 1]].toarray()
            lower = solve_triangular(factor, coupling.T, lower=True, overwrite_b=True, check_finite=False).T
            block -= lower @ lower.T
            columns[:, : last.shape[1]] -= lower @ last
        try:
            factor = cholesky(block, lower=True, overwrite_a=True, check_finite=False)
        except LinAlgError as failure:
            reason = "the finite elements of a tooth are turned inside out: no compliance follows from them"
            raise NoSolutionError(reason=reason, remedy="fe shows them in a picture") from failure
        last = solve_triangular(factor, columns, lower=True, overwrite_b=True, check_finite=False)
        # products of the columns that have begun
        begun = {}
        for first, end in ranges:
            columns_of_range = in_order[first:end]
            which = np.flatnonzero(columns_of_range < count)
            begun[first, end] = which, last[:, columns_of_range[which]]
        for product, (one, other) in zip(products, asked, strict=True):
            (rows, left), (columns_of, right) = begun[one.start, one.stop], begun[other.start, other.stop]
            product[np.ix_(rows, columns_of)] += left.T @ right
    return products


def _order(loads: csr_array, members: Sequence[Index]) -> tuple[Index, Index]:
    """Return the columns in the order of their first layer, and the number of columns that have begun at each layer."""
    first_layer = np.full(loads.shape[1], len(members))
    for k in range(len(members) - 1, -1, -1):
        first_layer[np.unique(loads[members[k]].indices)] = k
    order = np.argsort(first_layer, kind="stable")
    return order, np.searchsorted(first_layer[order], np.arange(len(members)), side="right")
