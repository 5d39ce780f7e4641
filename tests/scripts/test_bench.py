"""scripts/bench.py: that it still measures what the package is now."""

from __future__ import annotations

import importlib
import runpy
import sys
from dataclasses import replace

import numpy as np
import pytest
from oracles.places import ROOT
from oracles.scripts import script


@pytest.mark.sweep
def test_contact_by_one_batch_is_that_by_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "bench", raising=False)
    bench = importlib.import_module("bench")
    rows = bench.contact(1)
    assert [row["positions"] for row in rows] == [201, 10_000, 201, 201]
    assert all(row["solved"] == row["positions"] for row in rows)
    assert max(row["residual_mm"] for row in rows) < 1e-11


def test_kept_tables_have_the_columns_of_the_bench(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "bench", raising=False)
    bench = importlib.import_module("bench")
    for name, columns in bench.COLUMNS.items():
        assert [*bench.tables.kept(name)[0]] == [*columns.values()]


def test_the_bench_of_start_up_knows_what_each_dependency_is_loaded_for() -> None:
    bench = script("start_bench")
    assert sorted(bench.USES) == sorted(bench.direct_dependencies())


@pytest.mark.sweep
def test_growth_of_loaded_contact_is_measured_against_the_finest(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "load_bench", raising=False)
    bench = importlib.import_module("load_bench")
    monkeypatch.setattr(bench, "alone", bench.measured)
    case = bench.Case("spur", (20.0,), 1, elements=bench.FINER[0])
    rows = bench.finer([replace(case, cells=(12, 8)), replace(case, cells=(24, 16))])
    assert [row["cells"] for row in rows] == ["12 x 8", "24 x 16"]
    assert all(row["converged"] for row in rows)
    assert 0.0 < rows[0]["rotation"] < 5.0
    assert "rotation" not in rows[1]
    for name, columns in (("loads", bench.COLUMNS), ("design_torque", bench.UNDER_TORQUE)):
        assert [*bench.tables.kept(name)[0]] == [*columns.values()]


@pytest.mark.sweep
def test_the_sample_of_growing_torque_runs() -> None:
    sample = runpy.run_path(str(ROOT / "samples" / "te_under_torque.py"))
    pair = sample["Crowned"]("spur", "spur_relieved", (), (1.0, 20.0))
    rows, te, phase = sample["under_torque"](pair)
    assert [row["torque"] for row in rows] == [1.0, 20.0]
    assert te.shape == (2, len(phase))
    assert [row["peak_to_peak_arcsec"] for row in rows] == pytest.approx(np.ptp(te, axis=1).tolist())
    assert rows[1]["pressure_mpa"] > rows[0]["pressure_mpa"] > 0.0


def test_borders_have_no_extra_edges_and_seams_suit_both_sides(monkeypatch: pytest.MonkeyPatch) -> None:
    """The worm's tip line is bent twice as much over its land as over its flank: a chord of both is one edge."""
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "bench", raising=False)
    bench = importlib.import_module("bench")
    mesh = bench.tessellate(bench._member("worm_drive", "worm").tooth, 0.1)
    needed = bench.borders(mesh.tooth, mesh.deviation, mesh.deviation)
    for patch in mesh.patches:
        nodes = [patch.nodes.line(0.0), patch.nodes.line(1.0), patch.nodes.end(0.0), patch.nodes.end(1.0)]
        edges = sum(of.size - 1 for of in nodes) - 2
        assert 0.9 * edges <= needed[patch.region] <= edges
