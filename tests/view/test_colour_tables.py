"""Colour tables of scales against Matplotlib's."""

import matplotlib
import numpy as np
import pytest

from gearmesh.view.offscreen.colour_tables import TABLE_LENGTH, colour_table
from gearmesh.view.palette import COLOUR_MAP, RESULT_COLOUR_MAP


@pytest.mark.parametrize("name", [COLOUR_MAP, RESULT_COLOUR_MAP, "viridis"])
def test_colours_are_those_of_matplotlib(name: str) -> None:
    expected = 255.0 * matplotlib.colormaps[name](np.linspace(0.0, 1.0, TABLE_LENGTH))
    assert np.abs(colour_table(name) - expected).max() < 1.6
