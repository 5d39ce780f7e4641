"""Diagrams of the zone of contact and of backlash."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.view.diagrams import plots, zone_diagram
from gearmesh.view.diagrams.plots import sheet


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    kept: list[Any] = []
    for module in (plots, zone_diagram):
        monkeypatch.setattr(module, "save_figure", lambda figure, file: kept.append(figure))
    return kept


@pytest.mark.sweep
def test_small_zone_has_whole_legend_and_lines_without_dots(figures: list[Any]) -> None:
    gm.build(gm.load(SAMPLES / "worm_drive.toml")).picture("zone", size=(1000, 800)).save("zone.png")
    (figure,) = figures
    FigureCanvasAgg(figure).draw()
    boxes = [text.get_window_extent() for text in figure.legends[0].get_texts()]
    assert all(box.x0 >= 0.0 and box.x1 <= 1000.0 for box in boxes)
    words = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "contact lines" in words
    assert not any(word.startswith(("contact at", "path")) for word in words)


def test_no_backlash_is_drawn_as_none(figures: list[Any]) -> None:
    pair = {"teeth": 20, "face_width": 10}
    contact = gm.build(gm.parse({"kind": "cylindrical", "module": 2, "pinion": pair, "gear": pair})).contact()
    plots.plot_backlash("backlash.png", contact.backlash())
    axes = figures[0].axes[0]
    assert [line.get_label() for line in axes.lines] == ["backlash", "greatest 0°", "least 0°"]
    assert np.ptp(axes.get_ylim()) == pytest.approx(2e-3, rel=1e-6)


@pytest.mark.quick
@pytest.mark.parametrize("size", [(1600, 1200), (640, 480), (480, 1200)])
def test_figures_with_little_room_have_smaller_letters(size: tuple[int, int]) -> None:
    """All pixels, and at least so many inches that words stand clear."""
    inches, dots = sheet((10.0, 8.0), size, 150.0)
    assert np.multiply(inches, dots) == pytest.approx(size)
    assert dots <= 150.0
    assert inches[0] >= 8.0 - 1e-9
    assert inches[1] >= 6.4 - 1e-9
    assert sheet((10.0, 8.0), None, 150.0) == ((10.0, 8.0), 150.0)
