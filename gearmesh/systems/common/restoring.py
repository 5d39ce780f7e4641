"""Values of a design's keys at which errors of its exact contact vanish."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array

#: error that counts as none, and the step of difference quotients, as part of values above 1
RESTORED, STEP = 1e-10, 1e-5


def restoring(
    errors: Callable[[dict[str, float]], Array], values: Mapping[str, float], free: Sequence[str]
) -> dict[str, float]:
    """Values by key of which those of the keys `free` make as many `errors` (of the values; dimensionless or rad) vanish.

    Newton with difference quotients from `values`: the contact itself is solved exactly at every trial. Raises NoSolutionError.
    """
    if not free:
        return dict(values)

    def with_free(x: Array) -> dict[str, float]:
        return {**values, **{key: float(value) for key, value in zip(free, x, strict=True)}}

    def residual(x: Array, _: NDArray[np.intp]) -> tuple[Array, Array]:
        at = x[0]
        f = errors(with_free(at))
        steps = np.diag(STEP * np.maximum(1.0, np.abs(at)))
        columns = [(errors(with_free(at + step)) - f) / step.sum() for step in steps]
        return f[None], np.stack(columns, axis=-1)[None]

    solution = newton.solve(residual, np.array([[values[key] for key in free]]), tolerance=RESTORED)
    if not solution.converged[0]:
        raise NoSolutionError(
            reason=f"no value of {' and '.join(free)} restores the contact", remedy="reduce the assembly errors"
        )
    return with_free(solution.values[0])
