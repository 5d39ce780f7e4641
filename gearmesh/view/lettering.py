"""Titles of pictures and figures, broken into lines that fit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

#: largest share of a figure's width that a title takes
MAX_TITLE_WIDTH_SHARE = 0.96


def break_lines(title: str, fits: Callable[[str], bool]) -> str:
    """Return a title with line breaks between words; `fits` tells whether a line is narrow enough."""
    lines = []
    for line in title.split("\n"):
        words = line.split(" ")
        while words:
            count = next((n for n in range(len(words), 1, -1) if fits(" ".join(words[:n]))), 1)
            lines.append(" ".join(words[:count]))
            words = words[count:]
    return "\n".join(lines)


def fit_title(title: str, figure: Any, size: float) -> str:
    """Return a title in lines that are not wider than their figure; `size` of the letters in points."""

    def fits(text: str) -> bool:
        """Measure a text with the figure's own letters; True if it is narrow enough."""
        drawn = figure.text(0.5, 0.5, text, fontsize=size)
        width = drawn.get_window_extent().width
        drawn.remove()
        return bool(width <= MAX_TITLE_WIDTH_SHARE * figure.bbox.width)

    return break_lines(title, fits)
