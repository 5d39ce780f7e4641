"""Bounds that refusals state, over the keys of every kind: values of the key that is named, and true."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES
from oracles.refusals import faults, faults_at, numeric_keys, refusal

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.design.dotted import with_keys
from gearmesh.systems.system import design_class

#: kinds whose gears are built in milliseconds, and how many of their keys are pushed by default
QUICK_KINDS, QUICK_KEYS = ("cylindrical", "beveloid", "rack"), 2


def _some() -> list[tuple[str, str]]:
    rng = np.random.default_rng(53)
    return [
        (kind, str(key)) for kind in QUICK_KINDS for key in rng.choice(numeric_keys(kind), QUICK_KEYS, replace=False)
    ]


@pytest.mark.parametrize(("kind", "key"), _some())
@pytest.mark.sweep_cases(
    "cylindrical-gear.modifications_left.helix_slope",
    "cylindrical-pressure_angle",
    "rack-rack.modifications_left.triangular_end_relief_tip.length",
)
def test_bounds_are_values_of_the_key_that_build(kind: str, key: str) -> None:
    assert faults(kind, key) == []


@pytest.mark.sweep_cases(
    "worm_drive-center_distance-120.0", "circular_arc-pinion.bolts.circle-4.2", "planetary-ring.tip_diameter-2.4"
)
@pytest.mark.parametrize(
    ("kind", "key", "value"),
    [
        # without a unit
        ("rack", "rack.length", 2.4),
        ("worm_drive", "center_distance", 120.0),
        # of another key, with which another refusal followed
        pytest.param("rack", "rack.bolts.pitch", 2.4, marks=pytest.mark.sweep),
        ("circular_arc", "pinion.bolts.circle", 4.2),
        # of the number of spokes, stated for their width
        ("cylindrical", "gear.spokes.count", 94),
        # from a lower bound to an upper one that is less
        pytest.param("worm_drive", "worm.spokes.inner_diameter", 4.8, marks=pytest.mark.sweep),
        # without the value
        ("planetary", "ring.bore", 2.4),
        # a bare error of mathematics
        pytest.param("planetary", "ring.root_diameter", 2.4, marks=pytest.mark.sweep),
        ("planetary", "ring.tip_diameter", 2.4),
        # without their unit
        pytest.param("novikov", "pinion.face_width", 2250.0, marks=pytest.mark.sweep),
        ("novikov", "pinion.parabola", 0.0139492),
        # of the tip that follows from other values
        pytest.param("novikov", "pinion.parabola", 0.418475, marks=pytest.mark.sweep),
        # of the pitch angle that follows
        pytest.param("spiral_bevel", "shaft_angle", 108.0, marks=pytest.mark.sweep),
    ],
)
def test_bounds_that_were_of_something_else(kind: str, key: str, value: float) -> None:
    assert faults_at(kind, key, value) == []


@pytest.mark.parametrize(
    ("key", "value", "bound"),
    [
        # half the tip diameter at which the tooth is pointed, 42.0408 mm, less the reference radius, over the module
        ("pinion.addendum", 4.0, 1.5102),
        ("pinion.tip_diameter", 150.0, 42.0408),
        # the slope is proportional to the amount, and 0.1 at most
        ("pinion.modifications.helix_crowning", 2.0, 0.5),
    ],
)
@pytest.mark.sweep_cases("pinion.addendum-4.0-1.5102")
def test_bounds_are_of_the_key_and_not_of_what_follows_from_it(key: str, value: float, bound: float) -> None:
    """A tip diameter was stated for an addendum that is too large; a tip far beyond the pointed tooth was accepted."""
    cls = design_class("cylindrical")
    error = refusal(cls, {**dict(cls(**cls.example).own()), key: value})
    assert error is not None
    assert error.bounds is not None
    assert (error.key, error.value) == (key, value)
    assert error.bounds.high == pytest.approx(bound, rel=5e-4)


def test_refusal_of_centre_distance_gives_sum_of_shifts_and_range() -> None:
    """inv(alpha_w) - inv(alpha) = 2 tan(alpha) (x1 + x2) / (z1 + z2), cos(alpha_w) = 61 cos(alpha) / 75."""
    pair = {"pinion": {"teeth": 20, "face_width": 20}, "gear": {"teeth": 41, "face_width": 20}}
    with pytest.raises(
        DesignError, match=r"^assembly.center_distance = 75 mm: allowed is from .* add up to 10\.73,"
    ) as found:
        gm.parse({"kind": "cylindrical", "module": 2, **pair, "assembly": {"center_distance": 75}})
    bounds = found.value.bounds
    assert bounds is not None
    assert bounds.low is not None
    assert bounds.high is not None
    cls, own = design_class("cylindrical"), {"module": 2, "pinion": pair["pinion"], "gear": pair["gear"]}
    for distance, good in (
        (bounds.low, True),
        (bounds.high, True),
        (0.99 * bounds.low, False),
        (1.01 * bounds.high, False),
    ):
        assert (refusal(cls, {**own, "assembly.center_distance": distance}, diagnosed=False) is None) is good


def test_refusals_of_derived_values_are_in_the_units_of_the_design() -> None:
    """They were in the design's units and counted as mm: 2.0 inch was shown as 0.0787402 inch."""
    pair = {"pinion": {"teeth": 20, "face_width": 0.8}, "gear": {"teeth": 41, "face_width": 0.8}}
    with pytest.raises(DesignError, match=r"^assembly.center_distance = 2 inch: .* 2\.29285 inch"):
        gm.parse({"kind": "cylindrical", "units": "inch", "module": 0.08, **pair, "assembly": {"center_distance": 2.0}})


@pytest.mark.parametrize("units", ["mm", "inch"])
@pytest.mark.parametrize(
    ("keys", "key", "bound"),
    [
        ({"pinion.tip_diameter": 30.0, "pinion.root_diameter": 32.0}, "pinion.tip_diameter", 32.0),
        ({"pinion.bore": 8.0, "pinion.keyway": {"width": 9.0, "depth": 1.0}}, "pinion.keyway.width", 8.0),
        ({"arrangement": "double_helical", "helix_angle": 20.0, "gap": 25.0}, "gap", 20.0),
        # it stated no bounds
        ({"pinion.thickness_allowance": {"upper": -0.2, "lower": -0.1}}, "pinion.thickness_allowance.lower", -0.2),
    ],
)
def test_bounds_by_other_keys_have_the_unit_of_the_design(
    keys: dict[str, object], key: str, bound: float, units: str
) -> None:
    cls = design_class("cylindrical")
    own = {**dict(cls(**cls.example).own()), "units": units, "module": 2.0 if units == "mm" else 0.1}
    with pytest.raises(DesignError) as refused:
        cls(**with_keys({}, {**own, **keys}.items()))
    bounds = refused.value.bounds
    assert bounds is not None
    assert refused.value.key == key
    assert bounds.unit == units
    assert bound in (bounds.low, bounds.high)


CONFLICTS = [
    ("face_gear", "pinion.teeth", 40, "at most those of the shaper, 28"),
    ("face_gear", "shaper.teeth", 900, "at most those of the gear, 160"),
    ("planetary", "planet.teeth", 90, "at most 71, fewer than the ring has"),
    ("double_helical", "pinion.face_width", 1.0, "above the gap, 12 mm, which is part of it"),
    ("helical", "pinion.thickness_allowance.upper", -0.2, "given with lower"),
]


@pytest.mark.parametrize(("sample", "key", "value", "must_be"), CONFLICTS, ids=[row[1] for row in CONFLICTS])
def test_conflicts_name_the_key_that_was_changed(sample: str, key: str, value: float, must_be: str) -> None:
    with pytest.raises(DesignError) as refused:
        gm.load(SAMPLES / f"{sample}.toml", [f"{key}={value}"], complete=False)
    assert refused.value.key == key
    assert str(refused.value).endswith(f"must be {must_be}")
    design = gm.load(SAMPLES / f"{sample}.toml", complete=False)
    with pytest.raises(DesignError) as refused:
        design.with_values({key: value})
    assert refused.value.key == key


def test_limits_out_of_order_name_the_changed_limit() -> None:
    ends = {"pinion.thickness_allowance.upper": -0.05, "pinion.thickness_allowance.lower": -0.1}
    design = gm.load(SAMPLES / "helical.toml", complete=False).with_values(ends)
    for end, value in (("upper", -0.2), ("lower", 0.1)):
        with pytest.raises(DesignError) as refused:
            design.with_values({f"pinion.thickness_allowance.{end}": value})
        assert refused.value.key.endswith(end)
