"""Number of examples of property tests, and the designs on which a claim is tested by default.

Property tests are asked the same examples every time, or, to look for more, other ones:

    EXAMPLES=20000 python -m pytest -n 0 tests/kernel -k "twist or curvature"

asks so many, drawn anew. Without it the examples follow from the test alone, so that no machine turns red by luck.

A claim that is tested on many designs is tested on `some` of them by default. The others have the mark sweep, and so have tests
that take seconds: whole runs, solutions, pairs that are rolled. Single cases have it by their ids,
`@pytest.mark.sweep_cases("novikov-0.01")`. What is left is what a developer waits for. CI runs both:

    python -m pytest -m sweep
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

#: set by who looks for more
WANTED = os.environ.get("EXAMPLES")


def examples(count: int) -> settings:
    """Settings of a property test with `count` examples."""
    return settings(
        max_examples=int(WANTED or count),
        derandomize=WANTED is None,
        database=None,
        deadline=None,
        suppress_health_check=[HealthCheck.too_slow],
    )


def some(values: Iterable[Any], kept: int, *, whole: bool = False) -> list[Any]:
    """Values for `parametrize`: `kept` of them, spread evenly, as they are, the others with the mark sweep.

    `whole`: a tuple is the value of one argument.
    """
    values = list(values)
    spread = {round(k) for k in np.linspace(0.0, len(values) - 1.0, kept)}
    return [value if k in spread else _swept(value, whole=whole) for k, value in enumerate(values)]


def in_turn(first: Iterable[Any], second: Iterable[Any]) -> list[Any]:
    """Values of two arguments for `parametrize`: each of the `first` with one of the `second` in turn, the others with the mark
    sweep."""
    second = list(second)
    pairs = [(k, j, (one, other)) for k, one in enumerate(first) for j, other in enumerate(second)]
    return [pair if j == k % len(second) else _swept(pair, whole=False) for k, j, pair in pairs]


def _swept(value: Any, *, whole: bool) -> Any:
    if hasattr(value, "marks"):
        return pytest.param(*value.values, marks=(*value.marks, pytest.mark.sweep), id=value.id)
    return pytest.param(*(value if isinstance(value, tuple) and not whole else (value,)), marks=pytest.mark.sweep)
