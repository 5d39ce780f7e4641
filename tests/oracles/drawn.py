"""Numbers that a design may have, for hypothesis."""

from __future__ import annotations

from hypothesis import strategies as st

#: least size (mm, deg) drawn: above the least that keys allow, in inches too (`gearmesh.design.keys`)
LEAST = 1e-8


def zero_or_more(low: float, high: float) -> st.SearchStrategy[float]:
    """Floats from low to high that are 0 or at least `LEAST` in size: a design refuses numbers nearer to 0."""
    return st.floats(low, high).filter(lambda number: number == 0.0 or abs(number) >= LEAST)
