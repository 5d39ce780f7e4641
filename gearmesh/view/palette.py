"""Colours (sRGB) that mean the same in every picture and plot.

They differ for any colour vision, and in lightness. The contrast of the path is at least 3 : 1 on the compound. Contact
lines and path have this contrast on steel.
"""

from __future__ import annotations

#: marking compound: ellipses and patterns on a tooth
COMPOUND_COLOUR = "#8cc0ea"
#: yellow marking compound, as it is painted on teeth before they are rolled
MARKING_COLOUR = "#e8b923"
#: steel from which the compound is rubbed off
RUBBED_COLOUR = "#8f98a2"
#: inside of a pattern beneath ellipses, paler than the compound
PATTERN_COLOUR = "#d3e5f5"
#: rims of ellipses
OUTLINE_COLOUR = "#0b3c6f"
#: contact lines
LINE_COLOUR = "#0a5a9c"
#: the path of contact
PATH_COLOUR = "#a50026"
#: contact on an edge
EDGE_COLOUR = "#e07b00"
#: lines between the surfaces of a body
REGION_EDGE = "#5b6670"
#: words and edges
INK_COLOUR = "#202830"
#: accompanying lines and words
FAINT_COLOUR = "#9aa4ad"
#: ground of a flank in its plane
GROUND_COLOUR = "#eef1f4"
#: grid of a plot
GRID_LINE_COLOUR = "#e6eaee"
#: curves of a plot, in their order
CURVE_COLOURS = ("#2c5fa8", "#c8102e", "#2e8b57", "#b8720a", "#7a4fa3", "#4d5a66")
#: matplotlib's name of the colours of amounts on flanks, from small to large
COLOUR_MAP = "viridis_r"
#: matplotlib's name of the colours of finite-element results: small is pale, large is warm and dark
RESULT_COLOUR_MAP = "YlOrRd"


def rgb(colour: str) -> tuple[int, int, int]:
    """Return the red, green and blue part (0 to 255) of a colour "#rrggbb"."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
