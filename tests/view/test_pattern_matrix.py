"""The matrix of patterns: every cell at its place, with its own contact and error, one scale for all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.view import PatternCell, pattern_cell, pattern_matrix, plot_matrix

RACK = Path(__file__).parents[2] / "samples" / "rack.toml"


def test_cells_stand_where_their_errors_are(monkeypatch: pytest.MonkeyPatch) -> None:
    kept = []
    monkeypatch.setattr(pattern_matrix, "save_figure", lambda figure, file: kept.append(figure))
    twists = (-0.02, 0.02)
    found = [gm.build(gm.load(RACK, [f"assembly.gamma_h={twist}"])).contact() for twist in twists]
    cells = [pattern_cell(each.pair, "pinion", each.path, each.cycle) for each in found]
    plot_matrix("a.png", [[PatternCell(reason="no contact"), cells[0]], [cells[1], cells[0]]],
                ("up (mm)", (1.0, 2.0)), ("right (mm)", (3.0, 4.0)), "rack")  # fmt: skip
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
    assert [each.get_xlabel() for each in axes[1, 1]] == ["3", "4"]
    assert [text.get_text() for text in axes[1, 0, 0].texts] == ["no contact"]
    for each, contact in zip((below, error), found[::-1], strict=True):
        curve = 1e3 * contact.pair.slide * contact.cycle.gears[1]
        assert [text.get_text() for text in each.texts] == [f"{np.ptp(curve):.3g}"]
