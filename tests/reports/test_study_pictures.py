"""The matrix of patterns of a study: its cells, from paths in one batch, against the contact of each design solved alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.reports import study_pictures
from gearmesh.view.diagrams.pattern_matrix import PatternCell
from gearmesh.view.scene import contact_on

Matrix = tuple[list[list[PatternCell]], tuple[str, list[Any]], tuple[str, list[Any]]]


@pytest.fixture
def matrices(monkeypatch: pytest.MonkeyPatch) -> list[Matrix]:
    """Answers of the matrix are kept, and no picture is drawn."""
    kept: list[Matrix] = []
    monkeypatch.setattr(
        study_pictures, "plot_matrix", lambda file, cells, rows, columns, title: kept.append((cells, rows, columns))
    )
    for name in ("plot_responses", "plot_tornado"):
        monkeypatch.setattr(study_pictures, name, lambda *args: None)
    return kept


@pytest.mark.sweep
def test_cells_are_the_contact_of_each_design(matrices: list[Matrix], tmp_path: Path) -> None:
    sample, own = SAMPLES / "spiral_bevel_basic.toml", ["contact.phi1.count=21"]
    vary = {"assembly.dV": [-0.1, 0.0, 0.1], "assembly.dA": ["0", "50um"]}
    study = gm.build(gm.load(sample, own)).study(vary, record=("path_shift_length_mm",), workers=1)
    study_pictures.study_pictures(study, tmp_path)
    [(cells, rows, columns)] = matrices
    assert columns == ("dV, mm (+: pinion axis offset (dE), along y)", [-0.1, 0.0, 0.1])
    assert rows == ("dA, mm (+: pinion moved along its axis, away from the apex)", [0.0, 0.05])
    cell = cells[1][0]
    assert cell.panel is not None
    assert cell.pair is not None
    phi1 = cell.pair[0]
    contact = gm.build(gm.load(sample, ["assembly.dV=-0.1", "assembly.dA=0.05"])).contact(phi1)
    known = contact.path.kind == "point"
    np.testing.assert_allclose(
        cell.panel.path[known], cell.panel.plane.frame.places(contact.path.point1[known]), atol=1e-8
    )
    # on edges only where the gear is carried there
    assert 0 < cell.panel.edge.sum() < (contact.path.kind == "edge").sum()
    assert not np.isfinite(cell.panel.path[~known & ~cell.panel.edge]).any()
    where, level = cell.panel.pattern
    wanted = cell.panel.plane.pattern(contact_on(0, contact.path, contact.pair.mounts))
    np.testing.assert_allclose(where, wanted[0])
    assert 0.2 < (level <= 1.0).mean() < 0.5
    np.testing.assert_allclose(level, wanted[1], rtol=1e-6)
    # one tooth pair is below the gears by as much as in the mesh cycle
    np.testing.assert_allclose(np.ptp(cell.pair[1, known]), np.ptp(contact.path.te[known]) / ARCSEC, rtol=1e-6)
    assert cell.mesh_te is None
    assert cell.peak_to_peak == pytest.approx(contact.summary["mesh_te_peak_to_peak_arcsec"], rel=0.02)
    # members only moved have one flank
    assert len({id(each.panel.plane) for row in cells for each in row if each.panel is not None}) == 1


@pytest.mark.sweep
def test_cells_have_the_exact_transmission_error_where_rows_do(matrices: list[Matrix], tmp_path: Path) -> None:
    sample, own = SAMPLES / "spiral_bevel_basic.toml", ["contact.phi1.count=9"]
    study = gm.build(gm.load(sample, own)).study({"assembly.dV": [0.0, 0.1]}, record="cycle", workers=1)
    study_pictures.study_pictures(study, tmp_path)
    [([cells], _, _)] = matrices
    wanted = study.rows["mesh_te_peak_to_peak_arcsec"]
    np.testing.assert_allclose([cell.peak_to_peak for cell in cells], wanted, rtol=1e-9)
    contact = gm.build(gm.load(sample, [*own, "assembly.dV=0.1"])).contact()
    assert cells[1].peak_to_peak == pytest.approx(contact.summary["mesh_te_peak_to_peak_arcsec"], rel=1e-6)
    assert abs(np.ptp(cells[1].gears[1]) / wanted[1] - 1.0) > 1e-5


@pytest.mark.sweep
def test_lines_sweep_and_what_fails_says_why(matrices: list[Matrix], tmp_path: Path) -> None:
    sample = SAMPLES / "spur.toml"
    study = gm.build(gm.load(sample)).study({"pinion.teeth": [2, 20, 21]}, record=("path",), workers=1)
    study_pictures.study_pictures(study, tmp_path)
    [([cells], rows, columns)] = matrices
    assert (rows, columns) == (("", [""]), ("pinion.teeth (number of teeth)", [2, 20, 21]))
    assert cells[0].panel is None
    assert "pinion.teeth" in cells[0].reason
    first, second = (each.panel for each in cells[1:])
    assert first is not None
    assert second is not None
    assert cells[1].pair is not None
    assert first.plane is not second.plane
    contact = gm.build(gm.load(sample)).contact(cells[1].pair[0], cycle=False)
    wanted = first.plane.swept(contact_on(0, contact.path, contact.pair.mounts))
    assert len(first.strips) == len(wanted) > 5
    np.testing.assert_allclose(first.strips, wanted, atol=1e-9)
