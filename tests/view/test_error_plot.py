"""The plot of the transmission error: gears pass from one tooth pair to the next where both have the same error."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import gearmesh as gm
from gearmesh.contact.engagement.turns import FullTurns, Wave
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.view.diagrams import plots, turns_plot

RACK = Path(__file__).parents[2] / "samples" / "rack.toml"


@pytest.mark.sweep
def test_curves_of_pairs_and_gears_coincide_where_a_pair_leads(monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves of gears with reliefs, which bend sharply. The edge of the figure cuts no word off, and the legend is outside the
    diagram."""
    kept = []
    monkeypatch.setattr(plots, "save_figure", lambda figure, file: kept.append(figure))
    contact = gm.build(gm.load(RACK.with_name("spur_relieved.toml"))).contact()
    plots.plot_transmission_error("te.png", contact.path, contact.cycle, "error", size=(1000, 600))
    figure, (errors, _) = kept[0], kept[0].axes
    drawn = {line.get_label(): line.get_xydata() for line in errors.lines}
    pitch, envelope = np.degrees(contact.pair.pitch), drawn["envelope"]
    inside = (envelope[:, 0] >= 0.0) & (envelope[:, 0] <= pitch)
    pairs = [
        np.interp(envelope[inside, 0] - k * pitch, *drawn["tooth pair"].T, left=-np.inf, right=-np.inf)
        for k in (-1, 0, 1, 2)
    ]
    np.testing.assert_allclose(np.max(pairs, axis=0), envelope[inside, 1], atol=1e-6)  # arcsec
    FigureCanvasAgg(figure).draw()
    texts = [text for axes in figure.axes for text in (axes.xaxis.label, axes.yaxis.label, *axes.texts)]
    boxes = [text.get_window_extent() for text in (*texts, *figure.legends[0].get_texts())]
    assert all(box.x0 >= 0 and box.y0 >= 0 and box.x1 <= 1000 and box.y1 <= 600 for box in boxes)
    assert errors.get_legend() is None


def test_roots_join_three_pairs_and_bars_are_the_harmonics(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = []
    monkeypatch.setattr(plots, "save_figure", lambda figure, file: kept.append(figure))
    found = gm.build(gm.load(RACK)).contact()
    plots.plot_transmission_error("te.svg", found.path, found.cycle, unit=found.pair.output.reading.error)
    errors, harmonics = kept[0].axes
    drawn = {line.get_label(): line.get_xydata() for line in errors.lines}
    pitch = np.degrees(found.pair.pitch)
    # the pair and its neighbours, whole
    curve = errors.lines[1].get_xydata()
    for line, turns in ((errors.lines[0], -1), (errors.lines[2], 1)):
        np.testing.assert_allclose(line.get_xydata(), curve + np.array([turns * pitch, 0.0]), atol=1e-9)
    assert np.nanmax(np.ptp(curve[:, 0])) > 1.5 * pitch
    roots = drawn["change of tooth pairs"]
    assert len(roots) >= 3
    np.testing.assert_allclose(np.diff(roots[:, 0]), pitch, rtol=1e-9)
    for phi1, te in roots[1:3]:
        ahead = np.interp([phi1 - k * pitch for k in (-1, 0, 1)], *curve.T, left=-np.inf, right=-np.inf)
        assert np.sort(ahead)[-2:] == pytest.approx([te, te], abs=5e-3)
    # amplitudes by a transform of the drawn envelope
    envelope = drawn["envelope"]
    phi1 = np.arange(2048) / 2048 * pitch
    inside = (envelope[:, 0] >= 0.0) & (envelope[:, 0] <= pitch)
    order = np.argsort(envelope[inside, 0], kind="stable")
    spectrum = 2.0 * np.abs(np.fft.rfft(np.interp(phi1, *envelope[inside][order].T))) / 2048
    heights = [bar.get_height() for bar in harmonics.patches]
    np.testing.assert_allclose(heights, spectrum[1 : len(heights) + 1], atol=2e-3)


@pytest.mark.quick
@pytest.mark.parametrize(("amplitude", "lowest", "height"), [(1e-11, 0.009, 0.005), (4.0, 8.0, 4.0)])
@pytest.mark.sweep_cases("1e-11-0.009-0.005")
def test_rounding_is_no_error_over_whole_turns(
    amplitude: float, lowest: float, height: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And no bar stands behind the legend."""
    kept = []
    monkeypatch.setattr(turns_plot, "save_figure", lambda figure, file: kept.append(figure))
    phi1 = np.linspace(0.0, 1.0, 8)
    te = amplitude * ARCSEC * np.sin(2.0 * np.pi * phi1)
    wave = Wave("mesh", 8, amplitude * ARCSEC, 0.0)
    turns_plot.plot_turns("turns.png", FullTurns(1, 8, phi1, te, np.zeros(8, int), np.ones(8), (wave,)), "turns")
    errors, bars = kept[0].axes
    FigureCanvasAgg(kept[0]).draw()
    assert lowest < np.ptp(errors.get_ylim()) < 1.2 * lowest + 0.01
    top = bars.transData.transform((0.0, amplitude))[1]
    assert bars.get_ylim()[1] >= height
    assert top < bars.get_legend().get_window_extent().y0
