"""Words in pictures and figures: titles broken into lines that fit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

#: part of a figure's width that a title takes at most
WIDEST = 0.96


def break_lines(title: str, fits: Callable[[str], bool]) -> str:
    """A title with line breaks between words where a line does not fit."""
    lines = []
    for line in title.split("\n"):
        words = line.split(" ")
        while words:
            count = next((n for n in range(len(words), 1, -1) if fits(" ".join(words[:n]))), 1)
            lines.append(" ".join(words[:count]))
            words = words[count:]
    return "\n".join(lines)


def fit_title(title: str, figure: Any, size: float) -> str:
    """A title in letters of a `size` (points) in lines that are not wider than their figure."""

    def fits(text: str) -> bool:
        """Whether a text is narrow enough as the figure itself letters it."""
        drawn = figure.text(0.5, 0.5, text, fontsize=size)
        width = drawn.get_window_extent().width
        drawn.remove()
        return bool(width <= WIDEST * figure.bbox.width)

    return break_lines(title, fits)
