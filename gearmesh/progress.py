"""How far a long piece of work is."""

from __future__ import annotations

from collections.abc import Callable

#: Told how far a long piece of work is (0 to 1) and what it is doing.
Progress = Callable[[float, str], None]


def silent(fraction: float, doing: str) -> None:
    """Progress of which nobody wants to know."""
