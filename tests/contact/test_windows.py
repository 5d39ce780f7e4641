"""Close bounds of the advance about sampled places: against dense samples, and against contacts that use no such bounds."""

from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.assemblies import many_assemblies
from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.first_touch.windows import INSIDE_LINE, LAST_ROW, POINT_REACH, Windows
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.study.rows.work import _build, displacing_keys

#: nodes of a sampled field along its sides, and its middle
NODE_COUNT, FIELD_MIDDLE = 9, (4.0, 4.0)
#: places of dense samples in a window about the middle, and as far beyond it as a point reaches
DENSE_PLACES = np.linspace(2.0 - POINT_REACH, 6.0 + POINT_REACH, 401)

Function = Callable[[Array, Array], Array]


def bound(
    field: Function,
    line: int = INSIDE_LINE,
    limit: Function | None = None,
    place: tuple[float, float] = FIELD_MIDDLE,
    around: int = 2,
) -> float:
    """Bound of a field(i, j), rad, about a place; the flank of the gear ends where limit(i, j) is above 0."""
    i, j = np.meshgrid(np.arange(float(NODE_COUNT)), np.arange(float(NODE_COUNT)), indexing="ij")
    beyond = np.full((4, 1, NODE_COUNT, NODE_COUNT), -1.0)
    if limit is not None:
        beyond[0, 0] = limit(i, j)
    zero = np.zeros(1, dtype=np.intp)
    windows = Windows.of(field(i, j)[None], beyond, zero, np.array([place]), zero + around, zero + line)
    return float(windows.most(1e-9)[0])


def ridge(rise: float, bend: float) -> Function:
    """A straight ridge that rises along itself and bends about its middle."""

    def field(i: Array, j: Array) -> Array:
        along = j - 0.7 * i
        return np.asarray(-3e-4 * (i + 0.7 * j - 7.0) ** 2 + rise * along - bend * (along - 1.0) ** 2)

    return field


def wavy_ridge(seed: int) -> Function:
    """A ridge in a random direction whose bend changes along it, with waves of some seconds of arc."""
    rng = np.random.default_rng(seed)
    angle, shift = rng.uniform(0.0, np.pi), rng.uniform(-1.0, 1.0)
    waves, phase = rng.uniform(0.1, 0.35, 2), rng.uniform(0.0, 6.0)

    def field(i: Array, j: Array) -> Array:
        across = np.cos(angle) * (i - 4.0) + np.sin(angle) * (j - 4.0) - shift
        return np.asarray(
            -3e-4 * across**2 * (1.0 + 0.1 * np.sin(waves[1] * i)) + 4e-5 * np.sin(waves[0] * (j - i) + phase)
        )

    return field


def test_a_ridge_that_rises_has_no_summit() -> None:
    """Second differences across the ridge are 6e-4 rad, the rise along it is 120 times less."""
    assert bound(ridge(5e-6, 0.0)) == -np.inf
    assert bound(ridge(-5e-6, 1e-7)) == -np.inf
    # the same ridge with a summit within the window
    assert 0.0 <= bound(ridge(0.0, 1e-5)) < 1e-5


@pytest.mark.parametrize("seed", range(12))
def test_bounds_are_above_dense_samples_and_close_to_them(seed: int) -> None:
    field = wavy_ridge(seed)
    dense = field(*np.meshgrid(DENSE_PLACES, DENSE_PLACES, indexing="ij"))
    inner = dense[1:-1, 1:-1]
    steps = [(a, b) for a in (-1, 0, 1) for b in (-1, 0, 1) if (a, b) != (0, 0)]
    higher = np.any([np.roll(dense, step, (0, 1))[1:-1, 1:-1] > inner for step in steps], axis=0)
    within = np.abs(DENSE_PLACES[1:-1] - 4.0) <= 2.0
    summits = np.where(higher | ~(within[:, None] & within), -np.inf, inner)
    assert summits.max() <= bound(field) <= dense.max() + 1e-5

    # along a slanted limit of the gear, and along the last row of the pinion
    def limit(i: Array, j: Array) -> Array:
        return np.asarray(0.4 * (i - 4.3) + (j - 3.6))

    inside, rim = np.abs(DENSE_PLACES - 4.0) <= 2.0, np.full(DENSE_PLACES.shape, 8.0)
    along = field(DENSE_PLACES, 3.6 - 0.4 * (DENSE_PLACES - 4.3))
    assert along[inside].max() <= bound(field, 0, limit) <= along.max() + 1e-5
    along = field(rim, DENSE_PLACES)
    assert along[inside].max() <= bound(field, LAST_ROW, place=(8.0, 4.0)) <= along.max() + 1e-5


def test_summits_beyond_a_limit_or_far_from_the_place_do_not_count() -> None:
    def field(i: Array, j: Array) -> Array:
        return np.asarray(-1e-4 * ((i - 4.0) ** 2 + (j - 5.7) ** 2))

    assert bound(field) >= 0.0
    assert bound(field, limit=lambda i, j: np.asarray(j - 4.0)) == -np.inf
    assert bound(field, around=1) == -np.inf


def contacts_of(name: str, count: int, scale: float) -> Contacts:
    """First touch of a sample in random assemblies; errors of 0.03 mm and 0.01 deg times the scale."""
    design = gm.load(SAMPLES / f"{name}.toml")
    variant = _build(json.dumps(design.stated(), sort_keys=True, default=str), 0)
    rng = np.random.default_rng(5)
    keys = displacing_keys(str(design.stated()["kind"]))
    errors = {key: rng.normal(0.0, scale * (0.01 if "delta" in key else 0.03), count) for key in keys}
    return many_assemblies(variant.flanks, variant.bases(errors), variant.phi1)


@pytest.mark.sweep
@pytest.mark.sweep_cases("asymmetric", "face_gear_conjugate", "hypoid", "internal", "straight_bevel", "spline")
@pytest.mark.parametrize(
    "name",
    [
        "helical",
        "spur",
        "spiral_bevel_basic",
        "asymmetric",
        "face_gear_conjugate",
        "hypoid",
        "internal",
        "straight_bevel",
        "spline",
    ],
)
def test_contacts_are_those_without_close_bounds(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without them all places are solved that second differences do not exclude."""
    scales = (0.3, 2.0)
    with_bounds = [contacts_of(name, 6, scale) for scale in scales]
    monkeypatch.setattr(Windows, "most", lambda windows, slack: np.full(len(windows.line), np.inf))
    for contacts, scale in zip(with_bounds, scales, strict=True):
        every = contacts_of(name, 6, scale)
        np.testing.assert_array_equal(contacts.edges, every.edges)
        np.testing.assert_allclose(contacts.advance, every.advance, rtol=0.0, atol=1e-12)
