"""Colours of scales as tables, by Matplotlib's names of them; loading Matplotlib takes longer than drawing a tooth."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

#: equally spaced colours of "viridis" (S. van der Walt, N. Smith, CC0); between them lines, within one part of 255
VIRIDIS_COLOURS = (
    "440154 46085c 471063 481769 481d6f 482475 472a7a 46307e 453781 433d84 414287 3f4889 3d4e8a 3a538b 38598c 355e8d 33638d "
    "31688e 2e6d8e 2c718e 2a768e 297b8e 27808e 25848e 23898e 218e8d 20928c 1f978b 1e9c89 1fa188 21a585 24aa83 28ae80 2eb37c "
    "35b779 3dbc74 46c06f 50c46a 5ac864 65cb5e 70cf57 7cd250 89d548 95d840 a2da37 b0dd2f bddf26 cae11f d8e219 e5e419 f1e51d "
    "fde725"
)
#: equally spaced colours of "YlOrRd" (C. Brewer, colorbrewer2.org); between them lines
YLORRD_COLOURS = "ffffcc ffeda0 fed976 feb24c fd8d3c fc4e2a e31a1c bd0026 800026"
#: suffix of the name of a scale that runs the other way
REVERSED_SUFFIX = "_r"
#: number of colours of a table
TABLE_LENGTH = 256


def colour_table(name: str) -> NDArray[np.uint8]:
    """Colours (TABLE_LENGTH, 4) of a scale from zero to the largest."""
    plain = name.removesuffix(REVERSED_SUFFIX)
    anchors = bytes.fromhex({"viridis": VIRIDIS_COLOURS, "YlOrRd": YLORRD_COLOURS}[plain])
    colours = np.frombuffer(anchors, dtype=np.uint8).reshape(-1, 3).astype(float)
    if plain != name:
        colours = colours[::-1]
    places = np.linspace(0.0, len(colours) - 1.0, TABLE_LENGTH)
    parts = [np.interp(places, np.arange(len(colours)), part) for part in colours.T]
    table: NDArray[np.uint8] = np.rint(np.stack((*parts, np.full(TABLE_LENGTH, 255.0)), axis=-1)).astype(np.uint8)
    return table
