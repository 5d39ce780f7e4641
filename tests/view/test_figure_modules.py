"""Texts about properties of matplotlib's classes: left out in processes of gearmesh alone, kept in those of others."""

from __future__ import annotations

import subprocess
import sys

import pytest

#: loads figures, then prints the length of a text about properties and of one asked for later
PROGRAM = """
from matplotlib import artist
from gearmesh.memory import keep_memory
from gearmesh.view.diagrams.plots import new_figure
if {own}:
    keep_memory()
new_figure((1.0, 1.0))
from matplotlib.lines import Line2D
print(len(Line2D.set.__doc__), len(artist.kwdoc(Line2D)))
"""


@pytest.mark.parametrize("own", [True, False])
def test_texts_about_properties_are_left_out_in_own_processes(own: bool) -> None:
    words = [sys.executable, "-c", PROGRAM.format(own=own)]
    result = subprocess.run(words, capture_output=True, text=True, check=True)
    in_class, asked = map(int, result.stdout.split())
    assert (in_class < asked) == own
