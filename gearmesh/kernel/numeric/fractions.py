"""Linear equations of fractions, solved exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction


def solve_fractions(matrix: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> list[Fraction] | None:
    """Return the solution (N,) of M equations `matrix` (M, N) x = `right` (M,); None unless there is exactly one."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    count = len(rows[0]) - 1
    for column in range(count):
        pivot = next((k for k in range(column, len(rows)) if rows[k][column]), None)
        if pivot is None:
            return None
        rows[column], rows[pivot] = rows[pivot], rows[column]
        rows[column] = [value / rows[column][column] for value in rows[column]]
        for k, row in enumerate(rows):
            if k != column and row[column]:
                factor = row[column]
                rows[k] = [value - factor * unit for value, unit in zip(row, rows[column], strict=True)]
    return None if any(row[count] for row in rows[count:]) else [row[count] for row in rows[:count]]
