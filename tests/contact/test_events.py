"""Roots between two ends: of a line, and of a function that is flat but for rounding, without a warning of NumPy."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

from gearmesh.contact.conditions.events import root_between
from gearmesh.kernel.numeric.algebra import Array


@pytest.mark.quick
def test_a_function_that_is_flat_but_for_rounding_has_its_root_anywhere() -> None:
    """Advances of two conjugate tooth pairs differ by nothing all the way: their secant was divided by 0."""

    def flat(x: Array) -> tuple[Array, Array]:
        return np.full(len(x), 2e-15), np.zeros(len(x))

    def cubic(x: Array) -> tuple[Array, Array]:
        return x**3 - 0.2, np.zeros(len(x))

    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert 0.0 <= root_between(flat, 0.0, 1.0) <= 1.0
        assert root_between(cubic, 0.0, 1.0) == pytest.approx(0.2 ** (1.0 / 3.0), abs=1e-11)
