"""Settings that look like something else are reported, not refused; refused ones say what may be meant."""

from __future__ import annotations

from typing import Any

import pytest

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.design.unusual import unusual_settings
from gearmesh.systems.kinds import FIELD_WORDS, OWN_KINDS
from gearmesh.systems.system import design_class

PAIR: dict[str, Any] = {"pinion": {"teeth": 18, "face_width": 20}, "gear": {"teeth": 45, "face_width": 20}}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("keys", "lines"),
    [
        ({"module": 2}, []),
        ({"units": "inch", "module": 0.1}, []),
        ({"units": "inch", "module": 4}, ['module = 4 inch is 101.6 mm; a module of 4 mm is module = "4mm"']),
        (
            {"module": 2, "helix_angle": 0.2618},
            ["helix_angle = 0.2618 deg: angles are in degrees; 0.2618 rad is 15 deg"],
        ),
        (
            {"module": 2, "pinion": PAIR["gear"], "gear": PAIR["pinion"]},
            ["pinion.teeth = 45 is more than gear.teeth = 18: are pinion and gear swapped?"],
        ),
        ({"module": 2, "gear": {"teeth": -45, "face_width": 20}}, []),
    ],
    ids=["mm", "inch", "inch-module", "radians", "swapped", "ring"],
)
def test_unusual_settings_are_reported_and_count(keys: dict[str, Any], lines: list[str]) -> None:
    gears = gm.build(gm.parse({"kind": "cylindrical", **PAIR, **keys}))
    assert [line for line in gears.warnings if "swapped" in line or "rad is" in line or "a module of" in line] == [
        line for line in gears.warnings if line.startswith(tuple(lines))
    ]
    assert len([line for line in gears.warnings if line.startswith(tuple(lines))]) == len(lines)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("cutter", "silent"),
    [
        ({"toprem_angle": 11.0}, ["gear.cutter.toprem_angle = 11"]),
        ({"toprem_angle": 11.0, "toprem_height": 0.0}, ["gear.cutter.toprem_angle = 11"]),
        ({"toprem_radius": 25.0}, ["gear.cutter.toprem_radius = 25"]),
        ({"toprem_radius": 0.0}, []),
        ({"toprem_angle": 11.0, "toprem_height": 0.9}, []),
        ({"toprem_angle": 11.0, "inside": {"toprem_height": 0.9}}, []),
        ({"toprem_angle": 11.0, "toprem_height": 0.9, "inside": {"toprem_angle": 9.0}}, []),
        (
            {"toprem_angle": 11.0, "toprem_height": 0.9, "inside": {"toprem_height": 0.0, "toprem_angle": 9.0}},
            ["gear.cutter.inside.toprem_angle = 9"],
        ),
    ],
)
def test_keys_without_the_one_beside_which_they_count_are_reported(cutter: dict[str, Any], silent: list[str]) -> None:
    """A blade with toprem_angle alone was cut without a toprem, and nothing said so."""
    design = gm.parse(
        {"kind": "spiral_bevel", "module": 4, "pinion": {"teeth": 15}, "gear": {"teeth": 38, "cutter": cutter}}
    )
    assert list(unusual_settings(design)) == [f"{key} has no effect without toprem_height" for key in silent]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("kind", "tables", "lines"),
    [
        (
            "cylindrical",
            {"assembly": {"gear_phase": 40}},
            ["assembly.gear_phase = 40 has no effect without gear_eccentricity"],
        ),
        ("cylindrical", {"assembly": {"gear_phase": 40, "gear_eccentricity": 0.01}}, []),
        (
            "spiral_bevel",
            {"gear": {"teeth": 45, "cutter": {"swivel": 30}}},
            ["gear.cutter.swivel = 30 has no effect without tilt or tilt_motion"],
        ),
        ("spiral_bevel", {"gear": {"teeth": 45, "cutter": {"swivel": 30, "tilt_motion": [0.0, 1.0]}}}, []),
        (
            "spiral_bevel",
            {"pinion": {"teeth": 18, "concave": {"swivel_motion": [0.0, 3.0]}}},
            ["pinion.concave.swivel_motion = [0.0, 3.0] has no effect without tilt or tilt_motion"],
        ),
        ("spiral_bevel", {"pinion": {"teeth": 18, "concave": {"swivel": 30, "tilt": 2}}}, []),
    ],
)
def test_directions_of_nothing_are_reported(kind: str, tables: dict[str, Any], lines: list[str]) -> None:
    """A direction counts beside its size alone."""
    teeth = {name: {"teeth": member["teeth"]} for name, member in PAIR.items()}
    members = teeth if kind == "spiral_bevel" else PAIR
    assert list(unusual_settings(gm.parse({"kind": kind, "module": 2, **members, **tables}))) == lines


@pytest.mark.quick
def test_a_tolerance_of_a_tenth_of_the_module_is_reported() -> None:
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **PAIR}))
    assert not gears.solid("pinion", 0.19).warnings
    (line,) = gears.solid("pinion", 0.21).warnings
    assert line.startswith("the tolerance of 0.21 mm is 0.1 modules: numbers without a unit are in the design")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"helix_angle": -20}, r"^helix_angle = -20: must be .*; the key hand, \"right\" or \"left\", says the hand"),
        ({"pressure_angle": 0.349}, r"^pressure_angle = 0.349: must be .*; 0.349 rad is 20 deg$"),
    ],
)
def test_refused_angles_say_what_is_likely_meant(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        gm.parse({"kind": "cylindrical", "module": 2, **PAIR, **keys})


@pytest.mark.quick
@pytest.mark.parametrize("table", [{"shaft_angle": 30}, {"assembly": {"shaft_angle": 30}}], ids=["top", "assembly"])
def test_a_shaft_angle_of_beveloid_gears_says_what_sets_it(table: dict[str, Any]) -> None:
    with pytest.raises(DesignError, match=r"shaft_angle: .* pinion\.helix_angle \+ gear\.helix_angle"):
        gm.parse({"kind": "beveloid", "module": 2, **PAIR, **table})
    helices = {
        name: {**member, "helix_angle": angle} for (name, member), angle in zip(PAIR.items(), (20, 25), strict=True)
    }
    first, second = gm.build(gm.parse({"kind": "beveloid", "module": 2, **helices})).train.pairs[0].mounts
    assert abs(float(first.axis @ second.axis)) == pytest.approx(0.5**0.5, abs=1e-12)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("word", "hint"),
    [
        ("bevel", 'bevel: kind = "spiral_bevel"'),
        ("Straight bevel gears", 'straight bevel: kind = "straight_bevel"'),
        ("spur", 'spur: kind = "cylindrical"'),
        ("helical_gear", 'helical: kind = "cylindrical" with helix_angle'),
        ("crossed-helical", 'crossed helical: kind = "beveloid"'),
        ("worm", 'worm: kind = "worm_drive"'),
        ("ring gear", 'ring: kind = "cylindrical" with negative gear.teeth'),
        ("crown", 'crown: kind = "face_gear"'),
        ("spiral bevel", 'did you mean "spiral_bevel"?'),
        ("hypoid gears", 'did you mean "hypoid"?'),
        ("bevelod", 'did you mean "beveloid"?'),
    ],
)
def test_words_of_the_field_name_the_kind_that_makes_them(word: str, hint: str) -> None:
    with pytest.raises(DesignError) as refused:
        gm.parse({"kind": word})
    assert hint in str(refused.value)


@pytest.mark.quick
def test_the_table_of_words_names_kinds_and_keys_that_there_are() -> None:
    # a train is no kind: it has a command
    assert all("gearmesh train" in text for text in FIELD_WORDS.values() if "kind = " not in text)
    for text in (text for text in FIELD_WORDS.values() if "kind = " in text):
        kind = text.split('"')[1]
        assert kind in OWN_KINDS
        known = design_class(kind)
        for key in (
            "helix_angle",
            "arrangement",
            "spiral_angle",
            "pinion.cone_angle",
            "gear.helix_angle",
            "gear.internal",
        ):
            assert key not in text.split() or known.key_at(key) is not None
