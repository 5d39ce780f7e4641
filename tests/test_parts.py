"""Parts of the tests: together they are all, each once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import conftest
import pytest


@pytest.mark.quick
def test_every_test_is_in_one_part() -> None:
    items: list[Any] = [SimpleNamespace(nodeid=f"tests/test_x.py::test_y[{k}]") for k in range(1000)]
    counts = [sum(conftest.in_part(item, (number, 10)) for number in range(1, 11)) for item in items]
    assert counts == [1] * len(items)
    # an even share: 100 of 1000, three standard deviations of a fair draw
    assert all(70 < sum(conftest.in_part(item, (number, 10)) for item in items) < 130 for number in range(1, 11))


@pytest.mark.quick
def test_a_part_is_a_number_up_to_the_count() -> None:
    assert conftest.part("3/10") == (3, 10)
    for text in ("0/10", "11/10"):
        with pytest.raises(ValueError, match="must be K/N"):
            conftest.part(text)
