"""A stiff body in layers, factorised layer by layer: meshes that run from toe to heel couple only neighbouring ones.

With the unknowns of a layer together the stiffness is block tridiagonal, and its Cholesky factor K = L L^T bidiagonal:

    L_k L_k^T = K_kk - W_k W_k^T        W_k = K_k,k-1 L_(k-1)^-T

Everything that is asked for is made of products Y^T Y of columns Y = L^-1 F, the forward half of a solution: responses
F_a^T K^-1 F_b to loads F, and the body's stiffness to unknowns that were left out.
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
    """Cholesky factor of a stiffness: `members` the unknowns of each layer, `diagonal` their L_k, `lower` the W_k."""

    members: tuple[Index, ...]
    diagonal: tuple[Array, ...]
    lower: tuple[Array, ...]

    @staticmethod
    def of(stiffness: csr_array, layer: Index) -> LayeredStiffness:
        """Factor of a stiffness (N, N), of which unknown k is in layer `layer` (N,); those of layer -1 are left out (held).

        Raises NoSolutionError where elements are turned inside out.
        """
        from scipy.linalg import LinAlgError, cholesky, solve_triangular

        members = tuple(np.flatnonzero(layer == k) for k in range(int(layer.max()) + 1))
        diagonal: list[Array] = []
        lower: list[Array] = []
        for k, own in enumerate(members):
            go_on()
            rows = stiffness[own]
            block = rows[:, own].toarray()
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
        """L^-1 F (n, M), in the order of the layers, of columns F (N, M) over all unknowns."""
        from scipy.linalg import solve_triangular

        loads = loads.tocsr()
        blocks: list[Array] = []
        # a column begins with its first load
        order, begins = self._order(loads)
        back = np.argsort(order)
        for k, own in enumerate(self.members):
            go_on()
            count = int(begins[k])
            right = loads[own][:, order[:count]].toarray()
            if k:
                before = blocks[-1][:, :count]
                right[:, : before.shape[1]] -= self.lower[k - 1] @ before
            solved = solve_triangular(self.diagonal[k], right, lower=True, overwrite_b=True, check_finite=False)
            blocks.append(solved)
        total = np.zeros((sum(map(len, self.members)), loads.shape[1]))
        row = 0
        for own, block in zip(self.members, blocks, strict=True):
            total[row : row + len(own), : block.shape[1]] = block
            row += len(own)
        return total[:, back]

    def _order(self, loads: csr_array) -> tuple[Index, Index]:
        """The columns by their first layer, and how many begin up to each layer."""
        first = np.full(loads.shape[1], len(self.members))
        for k in range(len(self.members) - 1, -1, -1):
            first[np.unique(loads[self.members[k]].indices)] = k
        order = np.argsort(first, kind="stable")
        return order, np.searchsorted(first[order], np.arange(len(self.members)), side="right")
