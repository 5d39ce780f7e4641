"""Tables of numbers as text, exact and fast."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray


def lines(template: str, table: NDArray[np.generic], chunk: int = 50_000) -> Iterator[str]:
    """Yield the rows of `table` (N, K) as text, `chunk` rows at a time; `template` is the %-template of one line, K fields.

    With %r a float has the fewest digits that read back exactly.
    """
    for start in range(0, len(table), chunk):
        rows = table[start : start + chunk]
        yield template * len(rows) % tuple(rows.ravel().tolist())
