"""Shares of the variance, on functions whose shares are known in closed form and against scipy's."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import run
from oracles.places import SAMPLES
from scipy.stats import sobol_indices

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.reports.report import study_section
from gearmesh.reports.study_pictures import sensitivity_bars
from gearmesh.study.plan import Plan, grid, sample_plan
from gearmesh.study.spreads import Spread
from gearmesh.study.statistics import effects
from gearmesh.study.variance import variance_shares
from gearmesh.view.diagrams.study_plots import ShareBars, SwingBars, plot_tornado

KEYS = ("x1", "x2", "x3")
CUBE = {key: Spread("uniform", (-np.pi, np.pi)) for key in KEYS}
A, B = 7.0, 0.1
#: variance and first and total order of Ishigami's function (Ishigami & Homma 1990), in closed form
V1 = 0.5 * (1.0 + B * np.pi**4 / 5.0) ** 2
V2 = A**2 / 8.0
V13 = B**2 * np.pi**8 * 8.0 / 225.0
V = V1 + V2 + V13
FIRST = dict(zip(KEYS, np.array([V1, V2, 0.0]) / V, strict=True))
TOTAL = dict(zip(KEYS, np.array([V1 + V13, V2, V13]) / V, strict=True))


def ishigami(plan: Plan) -> tuple[dict[str, Array], Array]:
    x = {key: np.array(plan.columns[key], dtype=float) for key in KEYS}
    return x, np.sin(x["x1"]) + A * np.sin(x["x2"]) ** 2 + B * x["x3"] ** 4 * np.sin(x["x1"])


def test_a_saltelli_sample_finds_both_orders() -> None:
    plan = sample_plan(CUBE, 2048, "saltelli", 1)
    assert len(plan) == 2048 * 5
    keys, values = ishigami(plan)
    found = variance_shares(plan, keys, "y", values)
    assert [each.key for each in found] == ["x1", "x2", "x3"]
    for each in found:
        assert each.total is not None
        assert abs(each.first - FIRST[each.key]) < 0.02
        assert abs(each.total - TOTAL[each.key]) < 0.02
        assert each.first_error < 0.03
    # straight lines have next to nothing of it, and say so
    assert max(each.explained for each in effects(keys, "y", values)) < 0.25


def test_it_is_what_scipy_finds() -> None:
    plan = sample_plan(CUBE, 256, "saltelli", 5)
    keys, values = ishigami(plan)
    table = values.reshape(-1, 1, 256)
    wanted = sobol_indices(func={"f_A": table[0], "f_B": table[1], "f_AB": table[2:]}, n=256)
    found = {each.key: each for each in variance_shares(plan, keys, "y", values)}
    np.testing.assert_allclose([found[key].first for key in KEYS], wanted.first_order, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose([found[key].total for key in KEYS], wanted.total_order, rtol=1e-10, atol=1e-12)
    # values that are missing are points that are left out
    values[[3, 256 + 9, 1000]] = np.nan
    kept = np.delete(np.arange(256), [3, 9, 1000 % 256])
    table = values.reshape(5, 256)[:, kept]
    again = {each.key: each.first for each in variance_shares(plan, keys, "y", values)}
    b = table[1] - table[:2].mean()
    for k, key in enumerate(KEYS):
        assert again[key] == pytest.approx(np.mean(b * (table[2 + k] - table[0])) / np.var(table[:2]), abs=1e-12)


@pytest.mark.parametrize("method", ["lhs", "sobol", "random"])
def test_bins_find_the_first_order_within_their_errors(method: str) -> None:
    """Over 30 draws as many are within one and two standard errors as ought to be, or more: sequences have smaller errors."""
    off = []
    for seed in range(30):
        plan = sample_plan(CUBE, 512, method, seed)
        keys, values = ishigami(plan)
        for each in variance_shares(plan, keys, "y", values):
            assert each.total is None
            off.append((each.first - FIRST[each.key]) / each.first_error)
    assert np.mean(np.abs(off) < 1.0) > 0.5
    assert np.mean(np.abs(off) < 2.0) > 0.85
    assert abs(np.mean(off)) < 1.0


def test_a_grid_has_its_own_shares_exactly() -> None:
    plan = grid({"a": [-1.0, 0.0, 1.0], "b": [0.0, 1.0, 2.0, 3.0], "c": [5.0]})
    keys = {key: np.array(column, dtype=float) for key, column in plan.columns.items()}
    found = {each.key: each for each in variance_shares(plan, keys, "y", keys["a"] ** 2 + 2.0 * keys["b"])}
    va, vb = 2.0 / 9.0, 4.0 * 1.25
    for key, share in (("a", va / (va + vb)), ("b", vb / (va + vb)), ("c", 0.0)):
        assert (found[key].first, found[key].total) == (pytest.approx(share), pytest.approx(share))
    # a product: nothing of it is a key's alone
    product = {each.key: each for each in variance_shares(plan, keys, "y", keys["a"] * (keys["b"] - 1.5))}
    assert (product["a"].first, product["a"].total) == (pytest.approx(0.0, abs=1e-15), pytest.approx(1.0))
    with_hole = np.where(keys["b"] == 3.0, np.nan, keys["a"])
    assert variance_shares(plan, keys, "y", with_hole) == []
    assert variance_shares(plan, keys, "y", np.full(12, 3.0)) == []


def test_what_a_saltelli_sample_needs() -> None:
    with pytest.raises(DesignError, match=r"^sample = 100: must be a power of 2 with the method saltelli"):
        sample_plan(CUBE, 100, "saltelli")
    assert (
        variance_shares(sample_plan(CUBE, 4, "saltelli"), {key: np.zeros(20) for key in KEYS}, "y", np.arange(20.0))
        == []
    )
    assert variance_shares(sample_plan(CUBE, 30), {key: np.zeros(30) for key in KEYS}, "y", np.arange(30.0)) == []


@pytest.mark.sweep
def test_figures_that_are_not_linear_are_ranked_by_shares(tmp_path: Path) -> None:
    """Figures put in the place of a study's own: one a straight line, one a product, one that half of the rows have not."""
    gears = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml"))
    study = gears.study(
        {"assembly.dx": "-0.1:0.1", "assembly.dy": "-0.1:0.1"}, sample=16, method="saltelli", record="path"
    )
    assert len(study.plan) == 64
    x, y = (study.numbers(key) for key in study.plan.keys)
    made = {"path_shift_length_mm": 3.0 * x + y, "path_shift_height_mm": x * y}
    made["mesh_te_estimate_arcsec"] = np.where(x > 0.0, x * y, np.nan)
    study = replace(study, columns={**study.columns, **{name: list(v) for name, v in made.items()}})
    said = dict(zip(("path_shift_height_mm", "mesh_te_estimate_arcsec"), study.complaints, strict=False))
    for name, line in said.items():
        assert line.startswith(f"{name} is not linear in the keys (R^2 = ")
    assert said["path_shift_height_mm"].endswith("use their shares of its variance")
    assert "so few rows, or an incomplete grid" in said["mesh_te_estimate_arcsec"]
    assert not [line for line in study.complaints if "path_shift_length_mm" in line]
    # of the same rows as they were drawn otherwise: the product is all that both do together
    drawn = replace(study, plan=replace(study.plan, points=0))
    assert "for the interactions use the method saltelli" in drawn.complaints[0]
    assert (
        "most of it are interactions"
        in vars({each.name: each for each in sensitivity_bars(drawn)}["path_shift_height_mm"])["remark"]
    )
    bars = {each.name: each for each in sensitivity_bars(study)}
    assert isinstance(bars["path_shift_length_mm"], SwingBars)
    product = bars["path_shift_height_mm"]
    assert isinstance(product, ShareBars)
    for _, first, error, total, _ in product.keys:
        assert abs(first) < 3.0 * error
        assert total > 0.5
    lost = bars["mesh_te_estimate_arcsec"]
    assert isinstance(lost, ShareBars)
    assert not lost.keys
    document = study.document()
    assert {row["linear"] for row in document["sensitivities"] if row["figure"] == "path_shift_height_mm"} == {False}
    assert {row["figure"] for row in document["variance"]} >= {"path_shift_length_mm", "path_shift_height_mm"}
    assert document["warnings"] == study.complaints
    assert "Shares of the variance" in str(study)
    assert max(map(len, str(study).splitlines())) <= 80
    plot_tornado(tmp_path / "tornado.png", list(bars.values()), "bars")
    study.save(tmp_path / "study.json")
    assert "is not linear in the keys" in study_section(tmp_path).body


@pytest.mark.sweep
def test_the_command_warns_of_slopes_that_do_not_rank() -> None:
    vary = (word for key in ("dV", "dA") for word in ("--vary", f"assembly.{key}=-0.1:0.1:3"))
    status, out, err = run("study", SAMPLES / "spiral_bevel_basic.toml", *vary, "--record", "path")
    assert status == 0
    assert "Shares of the variance" in out
    assert "gearmesh: warning: mesh_te_estimate_arcsec is not linear in the keys" in err
