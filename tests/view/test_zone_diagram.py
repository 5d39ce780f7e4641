"""Diagrams of the zone of contact and of backlash."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.view.diagrams import plots, study_plots, zone_diagram
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


def test_far_limit_line_is_said_and_short_flanks_are_side_by_side(figures: list[Any]) -> None:
    """The limiting line of the rack took a third of the panel of the helical gear; it lies 3.7 mm below its root."""
    for name in ("helical", "beveloid_crossed"):
        gm.build(gm.load(SAMPLES / f"{name}.toml")).picture("zone").save("zone.png")
    helical, beveloid = figures
    pinion, gear, _ = helical.axes
    assert "limiting line of the tool (undercut): 3.72 mm away" in gear.get_title()
    assert "limiting line" not in pinion.get_title()
    heights = [np.ptp(axes.get_ylim()) for axes in (pinion, gear)]
    assert heights[1] < 1.4 * heights[0]
    assert not any("limiting" in text.get_text() for text in helical.legends[0].get_texts())
    first, second, zone = (axes.get_position(original=True) for axes in beveloid.axes)
    assert first.y0 < second.y1
    assert second.y0 < first.y1
    assert first.x1 < second.x0
    assert zone.y1 < min(first.y0, second.y0)
    assert zone.width > 0.8
    # a slender path lies down, with its labels
    assert beveloid.axes[2].get_ylabel().replace("\n", " ").startswith("along the axis of the pinion")


def test_tornado_has_words_and_values(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keys were their dotted names and bars had no figures."""
    kept: list[Any] = []
    monkeypatch.setattr(study_plots, "save_figure", lambda figure, file: kept.append(figure))
    bars = [
        study_plots.SwingBars("te", 2.0, [("assembly.dV", 1.25, 2.75)], "transmission error (arcsec)"),
        study_plots.ShareBars(
            "te", 0.5, [("assembly.dV", 0.4, 0.0, np.nan, np.nan)], "", "transmission error (arcsec)"
        ),
    ]
    study_plots.plot_tornado("tornado.png", bars, "title", {"assembly.dV": "dV, mm (+: along y)"})
    swing, share = kept[0].axes
    assert [label.get_text() for label in swing.get_yticklabels()] == ["dV, mm (+: along y)"]
    assert {"1.25", "2.75"} <= {text.get_text() for text in swing.texts}
    assert [text.get_text() for text in share.texts] == [" 40 %"]
    assert swing.get_xlabel() == "transmission error (arcsec); 2 in the middle"
    assert share.get_xlabel().startswith("share of the variance of: transmission error (arcsec)")


def test_no_backlash_is_drawn_as_none(figures: list[Any]) -> None:
    pair = {"teeth": 20, "face_width": 10}
    contact = gm.build(gm.parse({"kind": "cylindrical", "module": 2, "pinion": pair, "gear": pair})).contact()
    plots.plot_backlash("backlash.png", contact.backlash())
    axes = figures[0].axes[0]
    assert [line.get_label() for line in axes.lines] == ["backlash", "greatest 0°", "least 0°"]
    assert np.ptp(axes.get_ylim()) == pytest.approx(2e-3, rel=1e-6)


@pytest.mark.quick
@pytest.mark.parametrize("size", [(1600, 1200), (640, 480), (480, 1200), (240, 180)])
def test_figures_with_little_room_have_smaller_letters(size: tuple[int, int]) -> None:
    """All pixels, and at least so many inches that words stand clear."""
    inches, dots = sheet((10.0, 8.0), size, 150.0)
    assert np.multiply(inches, dots) == pytest.approx(size)
    assert dots <= 150.0
    # of the needed room 0.8, or 0.55 where letters would have less than 8 pixels
    least = 0.8 if dots > 72.0 else 0.55
    assert inches[0] >= least * 10.0 - 1e-9
    assert inches[1] >= least * 8.0 - 1e-9
    assert dots >= 72.0 or min(inches[0] / 10.0, inches[1] / 8.0) == pytest.approx(0.55)
    assert sheet((10.0, 8.0), None, 150.0) == ((10.0, 8.0), 150.0)
