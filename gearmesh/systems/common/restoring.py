"""Values of a design's keys at which errors of its exact contact vanish."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array

#: largest remaining error
MAX_RESTORED_ERROR = 1e-10
#: step of difference quotients, relative to values above 1
DIFFERENCE_STEP = 1e-5


def restoring(
    errors: Callable[[dict[str, float]], Array], values: Mapping[str, float], free: Sequence[str]
) -> dict[str, float]:
    """Return the values by key with which the `errors` vanish; only the values of the keys `free` are changed.

    There are as many errors (dimensionless or rad) as free keys. Newton's method starts from `values` and uses
    difference quotients. The contact itself is solved exactly at every trial. Raises NoSolutionError.
    """
    if not free:
        return dict(values)

    def with_free(x: Array) -> dict[str, float]:
        return {**values, **{key: float(value) for key, value in zip(free, x, strict=True)}}

    def residual(x: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
        at = x[0]
        f = errors(with_free(at))
        steps = np.diag(DIFFERENCE_STEP * np.maximum(1.0, np.abs(at)))
        columns = [(errors(with_free(at + step)) - f) / step.sum() for step in steps]
        return f[None], np.stack(columns, axis=-1)[None]

    solution = newton.solve(residual, np.array([[values[key] for key in free]]), tolerance=MAX_RESTORED_ERROR)
    if not solution.converged[0]:
        raise NoSolutionError(
            reason=f"no value of {' and '.join(free)} restores the contact", remedy="reduce the assembly errors"
        )
    return with_free(solution.values[0])
