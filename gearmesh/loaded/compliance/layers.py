"""Cholesky factor of a stiff body in layers: in meshes that run from toe to heel only neighbouring layers are coupled.

Unknowns are grouped by layer, so that the stiffness K is block tridiagonal. Its factor K = L L^T is block bidiagonal:

    L_k L_k^T = K_kk - W_k W_k^T        W_k = K_k,k-1 L_(k-1)^-T

Results are products Y^T Y of columns Y = L^-1 F, the forward half of a solution. They give responses F_a^T K^-1 F_b to
loads F, and the stiffness of the body to unknowns that were excluded.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import go_on

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Index = NDArray[np.int64]


@dataclass(frozen=True)
class LayeredStiffness:
    """Cholesky factor of a stiffness: `members`, the unknowns of each layer; `diagonal`, the L_k; `lower`, the W_k."""

    members: tuple[Index, ...]
    diagonal: tuple[Array, ...]
    lower: tuple[Array, ...]

    @staticmethod
    def of(stiffness: csr_array, layer: Index) -> LayeredStiffness:
        """Factorise a stiffness (N, N), in which unknown k belongs to layer `layer` (N,).

        Unknowns of layer -1 are held. Raises NoSolutionError if elements are turned inside out.
        """
        from scipy.linalg import LinAlgError, cholesky, solve_triangular

        members = tuple(np.flatnonzero(layer == k) for k in range(int(layer.max()) + 1))
        diagonal: list[Array] = []
        lower: list[Array] = []
        for k, layer_unknowns in enumerate(members):
            go_on()
            rows = stiffness[layer_unknowns]
            block = rows[:, layer_unknowns].toarray()
            if k:
                coupling = rows[:, members[k - 1]].toarray()
                lower.append(solve_triangular(diagonal[-1], coupling.T, lower=True, check_finite=False).T)
                block -= lower[-1] @ lower[-1].T
            try:
                diagonal.append(cholesky(block, lower=True, overwrite_a=True, check_finite=False))
            except LinAlgError as failure:
                reason = "the finite elements of a tooth are turned inside out: no compliance follows from them"
                raise NoSolutionError(reason=reason, remedy="fe shows them in a picture") from failure
        return LayeredStiffness(members, tuple(diagonal), tuple(lower))

    def forward(self, loads: csr_array) -> Array:
        """Return L^-1 F (n, M), in the order of the layers, for columns F (N, M) over all unknowns."""
        from scipy.linalg import solve_triangular

        loads = loads.tocsr()
        blocks: list[Array] = []
        # a column is 0 up to the layer of its first load: columns are sorted by this layer
        order, active_columns = self._order(loads)
        inverse_order = np.argsort(order)
        for k, layer_unknowns in enumerate(self.members):
            go_on()
            count = int(active_columns[k])
            right = loads[layer_unknowns][:, order[:count]].toarray()
            if k:
                last_block = blocks[-1][:, :count]
                right[:, : last_block.shape[1]] -= self.lower[k - 1] @ last_block
            solved = solve_triangular(self.diagonal[k], right, lower=True, overwrite_b=True, check_finite=False)
            blocks.append(solved)
        result = np.zeros((sum(map(len, self.members)), loads.shape[1]))
        row = 0
        for layer_unknowns, block in zip(self.members, blocks, strict=True):
            result[row : row + len(layer_unknowns), : block.shape[1]] = block
            row += len(layer_unknowns)
        return result[:, inverse_order]

    def _order(self, loads: csr_array) -> tuple[Index, Index]:
        """Return the columns in the order of their first layer, and the number of columns that have begun at each
        layer."""
        first_layer = np.full(loads.shape[1], len(self.members))
        for k in range(len(self.members) - 1, -1, -1):
            first_layer[np.unique(loads[self.members[k]].indices)] = k
        order = np.argsort(first_layer, kind="stable")
        return order, np.searchsorted(first_layer[order], np.arange(len(self.members)), side="right")
