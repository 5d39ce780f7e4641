"""The matrix of patterns: every cell at its place, with its own contact and error, one scale for all."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.view.diagrams import pattern_matrix
from gearmesh.view.diagrams.flank_plane import FlankPlane
from gearmesh.view.diagrams.pattern_matrix import PatternCell, pattern_cell, plot_matrix
from gearmesh.view.scene import contact_on

RACK = Path(__file__).parents[2] / "samples" / "rack.toml"


@pytest.mark.sweep
def test_cells_stand_where_their_errors_are(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = []
    monkeypatch.setattr(pattern_matrix, "save_figure", lambda figure, file: kept.append(figure))
    twists = (-0.02, 0.02)
    found = [gm.build(gm.load(RACK, [f"assembly.gamma_h={twist}"])).contact() for twist in twists]
    cells = []
    for each in found:
        pair = each.pair
        curves = ((np.degrees(phi1), 1e3 * pair.output.travel * te) for phi1, te in (each.cycle.pair, each.cycle.gears))
        own, gears = (np.stack(curve) for curve in curves)
        plane = FlankPlane.of(pair.pinion, pair.flanks[0])
        cells.append(
            pattern_cell(
                plane,
                contact_on(0, each.path, pair.mounts),
                own,
                gears,
                "um",
                1e3 * pair.output.travel * each.cycle.peak_to_peak,
            )
        )
    plot_matrix("a.png", [[PatternCell(reason="no contact"), cells[0]], [cells[1], cells[0]]],
                ("up (mm)", (1.0, 2.0)), ("right", ("three", 4)), "rack")  # fmt: skip
    # two axes a cell, from the top; rows grow upwards
    axes = np.array(kept[0].axes).reshape(2, 2, 2)
    (above, below), (other, error) = axes[0, :, 0], axes[0, :, 1]
    places = [np.concatenate([line.get_xydata() for line in each.lines if line.get_label() == "path of contact"])
              for each in (above, other)]  # fmt: skip
    for place, cell in zip(places, (cells[1], cells[0]), strict=True):
        np.testing.assert_allclose(place, cell.panel.path)
    # the twist moves the contact along the face
    assert np.abs(np.nanmean(places[0], axis=0) - np.nanmean(places[1], axis=0))[0] > 1.0
    assert above.get_xlim() == other.get_xlim()
    assert below.get_ylim() == error.get_ylim()
    assert (above.get_ylabel(), axes[1, 0, 0].get_ylabel()) == ("2", "1")
    assert [each.get_xlabel() for each in axes[1, 1]] == ["three", "φ₁ (deg)\n4"]
    assert [text.get_text() for text in axes[1, 0, 0].texts] == ["no contact"]
    for each, cell in zip((below, error), cells[::-1], strict=True):
        assert [text.get_text() for text in each.texts] == [f"{cell.mesh_te:.3g}"]
        lines = {line.get_label(): line.get_xydata().T for line in each.lines}
        np.testing.assert_array_equal(lines["tooth pair"], cell.pair)
        np.testing.assert_array_equal(lines["gears, peak to peak at the right"], cell.gears)
    # what is not solved is an estimate, and called one
    plot_matrix("a.png", [[replace(cells[0], mesh_te=None)]], ("", ("",)), ("", ("",)), "rack")
    estimate = kept[1].axes[1]
    assert [text.get_text() for text in estimate.texts] == [f"\u2248 {np.ptp(cells[0].gears[1]):.3g}"]
    assert "gears, estimate of peak to peak at the right" in {line.get_label() for line in estimate.lines}
    assert {text.get_text() for text in above.texts} == {"toe", "heel", "tip", "root"}
    legend = kept[0].legends[0]
    assert legend.get_title().get_text() == "right"
    assert {"contact pattern", "path of contact"} <= {text.get_text() for text in legend.get_texts()}
