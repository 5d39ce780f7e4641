"""Colours that distinguish regions, for the formats that have colours."""

from __future__ import annotations

import colorsys


def region_colours(count: int) -> list[tuple[float, float, float]]:
    """`count` different sRGB colours (0..1), hues around the circle, neighbours also unlike in brightness."""
    return [colorsys.hsv_to_rgb(i / count, 0.65 - 0.2 * (i % 2), 0.6 + 0.35 * (i % 2)) for i in range(count)]
