"""Colours that mean the same in every picture and plot, sRGB."""

from __future__ import annotations

# Told apart with any colour vision, and by lightness: the path is at least 3 : 1 on the compound, lines and path on steel.
#: marking compound: ellipses and patterns on a tooth, and the paler inside of a pattern beneath ellipses
COMPOUND, PATTERN = "#8cc0ea", "#d3e5f5"
#: rims of ellipses; contact lines; the path of contact; contact on an edge
OUTLINE, LINES, PATH, EDGE = "#0b3c6f", "#0a5a9c", "#a50026", "#e07b00"
#: lines between the surfaces of a body
REGION_EDGE = "#5b6670"
#: words and edges; what only accompanies; the ground of a flank in its plane; the grid of a plot
INK, FAINT, GROUND, GRID_LINES = "#202830", "#9aa4ad", "#eef1f4", "#e6eaee"
#: curves of a plot, in their order
CURVES = ("#2c5fa8", "#c8102e", "#2e8b57", "#b8720a", "#7a4fa3", "#4d5a66")
#: amounts on flanks, from small to large
COLOUR_MAP = "viridis_r"
