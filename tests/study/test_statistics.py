"""Statistics of rows, and the largest error for which a condition holds, on rows whose answers are known."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh import DesignError
from gearmesh.study.rows.largest import SEARCH_STEPS, largest
from gearmesh.study.statistics import REPORTED_PERCENTILES, effects, limit_of, percentiles
from gearmesh.view.diagrams.study_plots import percentile_marks

pytestmark = pytest.mark.quick


def test_effects_of_straight_lines_are_their_slopes() -> None:
    rng = np.random.default_rng(1)
    keys = {"a": rng.normal(3.0, 0.1, 400), "b": rng.uniform(-1.0, 1.0, 400), "still": np.full(400, 2.0)}
    values = 5.0 + 2.0 * keys["a"] - 4.0 * keys["b"]
    values[7] = np.nan
    first, second = effects(keys, "f", values)
    assert (first.key, second.key) == ("b", "a")
    assert abs(first.slope + 4.0) < 1e-12
    assert abs(second.slope - 2.0) < 1e-12
    assert first.explained == pytest.approx(1.0)
    known = np.delete(keys["b"], 7)
    assert first.swing == pytest.approx(-4.0 * np.ptp(np.percentile(known, (5, 95))))
    assert first.high - first.low == pytest.approx(first.swing)
    assert effects({"a": keys["a"][:2]}, "f", values[:2]) == []


def test_limits_hold_strictly_and_never_for_what_is_not_known() -> None:
    limit = limit_of(" contact_ratio > 1.5 ", ["contact_ratio"])
    assert limit.holds(np.array([1.4, 1.5, 1.6, np.nan])).tolist() == [False, False, True, False]
    assert limit_of("te<2e1", None).holds(np.array([19.0, 21.0])).tolist() == [True, False]
    assert percentiles(np.array([np.nan])) != percentiles(np.arange(101.0)) == [float(p) for p in REPORTED_PERCENTILES]
    for text in ("contact_ratio=1", "te<1", "contact_ratio>e"):
        with pytest.raises(DesignError, match=r"^limit "):
            limit_of(text, ["contact_ratio"])


@pytest.mark.parametrize(
    ("room", "low", "high"),
    [
        (lambda x: 0.3 - np.abs(x - 0.02), -0.28, 0.32),
        (lambda x: np.cos(x) - 0.9, -np.arccos(0.9), np.arccos(0.9)),
        (lambda x: np.where(np.abs(x) < 0.123, 1.0, 0.0), -0.123, 0.123),  # a count
        (lambda x: np.where(x < 0.61, 1.0, np.nan), np.nan, 0.61),  # contact is lost; nothing fails on the other side
        (lambda x: np.where(x > 0.5, 1.0, 0.25 - x), np.nan, 0.25),  # fails, and holds again farther off
    ],
)
def test_the_largest_error_is_where_the_condition_ends(room: object, low: float, high: float) -> None:
    calls: list[int] = []

    def counted(x: np.ndarray) -> np.ndarray:
        calls.append(len(x))
        return room(x)  # type: ignore[operator]

    found = largest(counted, 0.0, np.array([-1.0, 1.0]))
    for value, beyond, wanted, end in zip(found.values, found.beyond, (low, high), (-1.0, 1.0), strict=True):
        if np.isnan(wanted):
            assert value == end
            assert np.isnan(beyond)
        else:
            assert abs(value) - 1e-12 <= abs(wanted) <= abs(beyond) + 1e-12
            assert abs(value - beyond) < 1.1e-4
    assert sum(calls) < 2 * SEARCH_STEPS + 50


def test_a_figure_that_never_changes_follows_the_keys_and_has_one_mark() -> None:
    """It was reported as not linear, with R^2 = 0, and the names of its percentiles lay upon each other."""
    keys = {"a": np.linspace(-1.0, 1.0, 40), "b": np.linspace(0.0, 1.0, 40) ** 2}
    values = np.full(40, 19.0)
    unchanged = effects(keys, "converged", values)
    assert all(effect.linear and effect.explained == 1.0 and effect.swing == 0.0 for effect in unchanged)
    assert len(unchanged) == 2
    assert percentile_marks(values, REPORTED_PERCENTILES) == [(19.0, "1, 5, 50, 95, 99 %")]
    assert percentile_marks(np.array([0.0] * 11 + [18.0] * 10), (5, 50, 95)) == [(0.0, "5, 50 %"), (18.0, "95 %")]
