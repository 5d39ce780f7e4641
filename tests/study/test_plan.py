"""Plan of a study: grids, samples, distributions, and refusals."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.places import SAMPLES
from scipy import stats

import gearmesh as gm
from gearmesh import DesignError, load
from gearmesh.study.plan import KeyReader, grid, key_and_value, sample_plan
from gearmesh.study.spreads import Spread, read_spreads, spread_of

pytestmark = pytest.mark.quick

BEVEL = load(SAMPLES / "spiral_bevel_basic.toml")
READ = KeyReader(BEVEL)


def test_grid_rows_count_like_digits_in_units_of_keys() -> None:
    lists = {
        "assembly.dV": READ.values("assembly.dV", "-100um:0.1mm:3"),
        "pinion.teeth": READ.values("pinion.teeth", "13,14"),
        "contact.side": READ.values("contact.side", "pinion_concave"),
        "assembly.d_delta": READ.values("assembly.d_delta", "0:0.3:4"),
    }
    plan = grid(lists)
    assert plan.shape == (3, 2, 1, 4)
    assert plan.rows(0, 5) == [
        (-0.1, 13, "pinion_concave", 0.0),
        (-0.1, 13, "pinion_concave", 0.1),
        (-0.1, 13, "pinion_concave", 0.2),
        (-0.1, 13, "pinion_concave", 0.3),
        (-0.1, 14, "pinion_concave", 0.0),
    ]
    assert plan.rows(23, 99) == [(0.1, 14, "pinion_concave", 0.3)]
    assert len(set(plan.rows(0, 24))) == len(plan) == 24
    inch = KeyReader(load(SAMPLES / "circular_arc.toml"))
    assert inch.values("assembly.dC", "2.54mm,0.2") == [0.1, 0.2]


@pytest.mark.parametrize("method", ["lhs", "sobol", "random"])
def test_samples_have_the_distributions_asked_for(method: str) -> None:
    """Compare samples with scipy's own distributions by the Kolmogorov-Smirnov distance. The same seed gives the same sample."""
    spreads = {
        "a": Spread("normal", (0.3, 0.02)),
        "b": Spread("uniform", (-1.0, 2.0)),
        "c": Spread("triangular", (0.0, 0.25, 1.0)),
        "d": Spread("truncated", (0.0, 1.0, -1.0, 2.0)),
    }
    known = stats.norm(0.3, 0.02), stats.uniform(-1, 3), stats.triang(0.25), stats.truncnorm(-1, 2)
    plan = sample_plan(spreads, 1000, method, seed=5)
    for column, law in zip(plan.columns.values(), known, strict=True):
        # at random 1.63 / sqrt(N) is exceeded once in a hundred times
        assert stats.kstest(column, law.cdf).statistic < (0.052 if method == "random" else 0.006)
    table = np.array(list(plan.columns.values()))
    assert np.abs(np.corrcoef(table) - np.eye(4)).max() < 0.12
    assert (
        sample_plan(spreads, 1000, method, seed=5).digest
        == plan.digest
        != sample_plan(spreads, 1000, method, seed=6).digest
    )


def test_a_latin_hypercube_has_one_row_in_every_layer() -> None:
    plan = sample_plan({"a": Spread("uniform", (0.0, 1.0)), "b": Spread("uniform", (0.0, 1.0))}, 40)
    for column in plan.columns.values():
        assert sorted(np.floor(40.0 * np.array(column)).astype(int).tolist()) == list(range(40))


def test_tolerances_come_from_a_file(tmp_path: Path) -> None:
    file = tmp_path / "t.toml"
    file.write_text(
        'assembly.dV = { distribution = "normal", sigma = "20um" }\n'
        'assembly.dG = "triangular:-0.1:0:0.2"\n'
        '[assembly.dA]\ndistribution = "uniform"\nlow = -0.1\nhigh = "100um"\n'
    )
    assert read_spreads(str(file), READ.number) == {
        "assembly.dV": Spread("normal", (0.0, 0.02)),
        "assembly.dG": Spread("triangular", (-0.1, 0.0, 0.2)),
        "assembly.dA": Spread("uniform", (-0.1, 0.1)),
    }


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: READ.values("assembly.dv", "0:1:3"), "vary assembly.dv: .* did you mean assembly.dV?"),
        (lambda: READ.values("assembly.dV", "0:1"), "LOW:HIGH:COUNT"),
        (lambda: READ.values("assembly.dV", "0:1:1"), "LOW:HIGH:COUNT"),
        (lambda: READ.values("assembly.dV", "0:one:3"), "assembly.dV = .*one.*must be a number"),
        (lambda: READ.values("assembly.d_delta", "1um,2um"), "assembly.d_delta = .*must be a number"),
        (lambda: READ.values("pinion.teeth", "13:14:3"), "pinion.teeth = 13.5: must be a whole number"),
        (lambda: READ.values("contact.side", "1:2:3"), "contact.side = .*must be a number"),
        (lambda: READ.range("assembly.dV", "1:0"), "HIGH above LOW"),
        (lambda: READ.range("pinion.teeth", "13:15"), "whole numbers can be varied in a grid"),
        (lambda: spread_of("x", ["normal", "0"], READ.number), "must be one of normal:mean:sigma"),
        (lambda: spread_of("assembly.dV", ["normal", "0", "0"], READ.number), "sigma = 0: must be above 0"),
        (lambda: spread_of("assembly.dV", ["uniform", "1", "0"], READ.number), "high = 0: must be above low, 1"),
        (lambda: sample_plan({"a": Spread("uniform", (0, 1))}, 3, "monte"), "method = monte: must be one of lhs"),
        (lambda: sample_plan({"a": Spread("uniform", (0, 1))}, 0), "sample = 0"),
        (lambda: grid({"a": [0.0] * 10_000, "b": [0.0] * 10_000}), "100000000 rows; allowed is up to"),
        (lambda: key_and_value("--vary", "assembly.dV"), "must look like dotted.key="),
    ],
)
def test_what_cannot_be_varied_is_refused_in_one_line(make: object, words: str) -> None:
    with pytest.raises(DesignError, match=words) as failure:
        make()  # type: ignore[operator]
    assert "\n" not in str(failure.value)


def test_samples_are_those_of_scipy_to_the_bit() -> None:
    """Seeds give the points that they gave when scipy.stats drew them."""
    count, spreads = 1000, {key: Spread("uniform", (0.0, 1.0)) for key in "abc"}
    plan = sample_plan(spreads, count, "lhs", 7)
    points = stats.qmc.LatinHypercube(3, rng=np.random.default_rng(7)).random(count)
    assert [plan.columns[key] for key in "abc"] == points.T.tolist()
    share = points[:, 0]
    for spread, expected in (
        (Spread("normal", (0.3, 0.02)), stats.norm.ppf(share, 0.3, 0.02)),
        (Spread("triangular", (-1.0, 0.2, 3.0)), stats.triang.ppf(share, 0.3, -1.0, 4.0)),
        (Spread("triangular", (0.0, 0.0, 3.0)), stats.triang.ppf(share, 0.0, 0.0, 3.0)),
    ):
        np.testing.assert_array_equal(spread.at(share), expected)


def test_samples_are_drawn_without_all_of_scipy_stats() -> None:
    code = (
        "import sys; from gearmesh.study.plan import sample_plan; from gearmesh.study.spreads import Spread; "
        "sample_plan({'a': Spread('normal', (0, 1)), 'b': Spread('triangular', (0, 1, 2))}, 5); "
        "print('scipy.stats' in sys.modules)"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "False"


def test_unknown_keys_are_refused_under_what_gave_them() -> None:
    gears = gm.Gears(gm.load(SAMPLES / "spur.toml", complete=False))
    for of, ask in {
        "vary": lambda: gears.study({"pinion.tooth": "1:2:2"}),
        "tolerance": lambda: gears.study(sample=4, tolerance={"pinion.tooth": "normal:0:1"}),
        "find_limits": lambda: gears.largest_errors({"pinion.tooth": 1.0}),
    }.items():
        with pytest.raises(gm.DesignError, match=r"did you mean pinion[.]teeth") as failure:
            ask()
        assert failure.value.key == of
