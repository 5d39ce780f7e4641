"""Cholesky factor of a stiff body in layers: in meshes that run from toe to heel only neighbouring layers are coupled.

Unknowns are grouped by layer, so that the stiffness K is block tridiagonal. Its factor K = L L^T is block bidiagonal:

    L_k L_k^T = K_kk - W_k W_k^T        W_k = K_k,k-1 L_(k-1)^-T

Results are products Y^T Y of columns Y = L^-1 F, the forward half of a solution. They give responses F_a^T K^-1 F_b to
loads F, and the stiffness of the body to unknowns that were excluded. They are sums over the layers, so that no more
than two layers of L and Y are in memory: all of Y took 0.13 GB for a gear.

Layers may run from toe to heel, or from the top of a tooth down. Of most teeth the latter are more layers with fewer
unknowns each.
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


def responses(
    stiffness: csr_array,
    layer: Index,
    loads: csr_array,
    asked: Sequence[tuple[slice, slice]],
    top: Index | None = None,
) -> list[Array]:
    """Return F_a^T K^-1 F_b for pairs of ranges of columns of the loads F (N, M) over all unknowns.

    Unknown k of the stiffness K (N, N) belongs to layer `layer` (N,); unknowns of layer -1 are held. If `top` is given,
    layers by the distance from these unknowns are taken where they need fewer operations. Raises NoSolutionError if
    elements are turned inside out.
    """
    from scipy.linalg import LinAlgError, cholesky, solve_triangular

    loads = loads.tocsr()
    every = np.arange(loads.shape[1])
    products = [np.zeros((every[one].size, every[other].size)) for one, other in asked]
    ranges = {(part.start, part.stop) for parts in asked for part in parts}
    members = _members(layer)
    if top is not None:
        members = _cheaper(members, _members(_levels(stiffness, top, layer < 0)), loads)
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


def _members(layer: Index) -> list[Index]:
    """Return the unknowns of each layer."""
    return [np.flatnonzero(layer == k) for k in range(int(layer.max()) + 1)]


def _levels(stiffness: csr_array, start: Index, held: NDArray[np.bool_]) -> Index:
    """Return how many couplings each unknown (N,) is away from the unknowns `start`.

    It is -1 for unknowns that are `held` (N,), and for those beyond them. Unknowns of levels that are not next to each
    other are not coupled.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import dijkstra

    free = np.flatnonzero(~held)
    row = np.repeat(np.arange(stiffness.shape[0]), np.diff(stiffness.indptr))
    coupled = csr_array((np.ones(row.size), (row, stiffness.indices)), shape=stiffness.shape)[free][:, free]
    steps = dijkstra(coupled, indices=np.flatnonzero(np.isin(free, start)), unweighted=True, min_only=True)
    level = np.full(stiffness.shape[0], -1)
    level[free] = np.where(np.isfinite(steps), steps, -1)
    return level


def _cheaper(first: list[Index], second: list[Index], loads: csr_array) -> list[Index]:
    """Return those of two layerings that take fewer operations for the loads; the first if the second lacks unknowns."""

    def operations(members: list[Index]) -> float:
        sizes = np.array([float(len(own)) for own in members])
        last, begun = np.append(0.0, sizes[:-1]), _order(loads, members)[1].astype(float)
        # Cholesky factor of a layer, coupling to the layer before, both of all columns that have begun
        per_layer = sizes**3 / 3.0 + last**2 * sizes + 2.0 * sizes**2 * last
        return float((per_layer + (sizes**2 + 2.0 * sizes * last) * begun).sum())

    whole = sum(map(len, second)) == sum(map(len, first))
    return second if whole and operations(second) < operations(first) else first
