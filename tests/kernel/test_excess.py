"""Division of an interval by the excess of refused values."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from gearmesh.kernel.numeric.excess import Division, Refused


def divided(excess: Callable[[float], float | None], wanted: float) -> tuple[float, float, int]:
    """Allowed and refused end of an interval from 0 to 1, and the values that were tried; refused is above 0 or None."""
    good, bad, division, tried = 0.0, 1.0, Division(), 0
    refused: list[Refused] = [(1.0, excess(1.0))]
    while bad - good > wanted:
        aim = division.beside_root(good, bad, refused, wanted)
        aim = 0.5 * (good + bad) if aim is None else aim
        assert good < aim < bad
        beyond, tried = excess(aim), tried + 1
        division.last_refused = beyond is None or beyond > 0.0
        if division.last_refused:
            bad = aim
            refused.insert(0, (aim, beyond))
        else:
            good = aim
    return good, bad, tried


@pytest.mark.parametrize(
    ("excess", "root", "most"),
    [
        (lambda x: math.exp(3.0 * x) - 2.0, math.log(2.0) / 3.0, 14),
        (lambda x: x**3 - 0.2, 0.2 ** (1.0 / 3.0), 14),
        (lambda x: 5.0 * (x - 0.01), 0.01, 10),
        # no figure, a figure that rests and one that jumps: 24 halvings, and a few steps that came to nothing
        (lambda x: None if x > 0.3 else -1.0, 0.3, 24),
        (lambda x: 1.0 if x > 0.3 else -1.0, 0.3, 24),
        (lambda x: 1.0 + x if x > 0.3 else -1.0, 0.3, 36),
    ],
)
def test_interval_closes_on_the_limit(excess: Callable[[float], float | None], root: float, most: int) -> None:
    good, bad, tried = divided(excess, 2.0**-24)
    assert good <= root <= bad
    assert tried <= most
