"""Parameters of flanks: every member declares units and meanings, and the units are those of the values."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.tables import align, as_html
from gearmesh.teeth.source_parameters import SourceParameter

#: factor of all lengths, and the power of it by unit of a key
FACTOR = 1.5
POWERS = {"mm": 1, "um": 1, "1/mm": -1}
#: power of the factor by unit of a parameter
PARAMETER_POWERS = {"mm": 1, "deg": 0, "rad": 0, "": 0}
#: samples without standard sizes, as of cutters, which do not grow with the gear: together every function of parameters
QUICK = ("face_gear", "helical", "spiral_bevel_geometry2", "worm_drive")
SWEPT = ("beveloid_parallel", "circular_arc", "internal", "modified_involute", "rack", "worm_drive_zk_oversize")


def larger(values: Mapping[str, Any], units: Mapping[str, str], prefix: str = "") -> dict[str, Any]:
    """The same design with all lengths multiplied."""
    made: dict[str, Any] = {}
    for key, value in values.items():
        unit = units.get(f"{prefix}{key}", "").partition("|")[0]
        if isinstance(value, Mapping):
            made[key] = larger(value, units, f"{prefix}{key}.")
        elif unit in POWERS and isinstance(value, int | float):
            made[key] = value * FACTOR ** POWERS[unit]
        else:
            made[key] = value
    return made


def contact(design: gm.Design) -> gm.Contact:
    """Contact at phi1 = 0 alone."""
    return gm.build(design).contact([0.0], cycle=False)


@pytest.mark.parametrize("sample", [*QUICK, *(pytest.param(name, marks=pytest.mark.sweep) for name in SWEPT)])
@pytest.mark.sweep_cases("face_gear", "spiral_bevel_geometry2", "worm_drive")
def test_units_are_those_of_the_values(sample: str) -> None:
    design = gm.load(SAMPLES / f"{sample}.toml")
    units = {line.key: line.unit for line in type(design).key_lines()}
    small, large = contact(design), contact(gm.parse(larger(design.stated(), units)))
    for member in small.pair.both:
        declared = member.declared_parameters
        known, scaled = small.params[member.name][0], large.params[member.name][0]
        assert list(declared) == list(known)
        for name, value in known.items():
            power = PARAMETER_POWERS[declared[name].unit]
            assert scaled[name] == pytest.approx(value * FACTOR**power, rel=1e-6, abs=1e-6), name
            assert len(declared[name].meaning.split()) > 4


@pytest.fixture(scope="module")
def curved() -> gm.Contact:
    """Contact of a pair whose pinion has a curved blade and whose gear has a straight one."""
    return contact(gm.load(SAMPLES / "spiral_bevel_geometry2.toml"))


def test_tables_show_units_and_meanings(curved: gm.Contact) -> None:
    table = curved.listings[0]
    assert table.columns[6:] == ["pinion u_P, rad", "pinion theta_P, deg", "gear u_G, mm", "gear theta_G, deg"]
    text = align(table)
    assert "\nu_P: angle of the arc of the blade\n" in text
    assert "\nu_G: distance along the straight blade, from its tip plane\n" in text
    # one line for both members where they mean the same
    assert [note.partition(":")[0] for note in table.notes] == ["u_P", "theta_P, theta_G", "u_G"]
    assert max(map(len, text.splitlines())) <= 80
    assert '<p class="note">u_P: angle of the arc of the blade</p>' in as_html([table])


def test_files_keep_their_keys_and_have_the_meanings(curved: gm.Contact) -> None:
    document = json.loads(curved.json())
    assert document["positions"][0]["gear"]["params"].keys() == {"u_G", "theta_G"}
    assert "gear_u_G" in curved.csv().splitlines()[0].split(",")
    meanings = document["surface_parameters"]
    assert meanings["gear"]["u_G"] == {
        "unit": "mm",
        "meaning": "distance along the straight blade, from its tip plane",
    }
    assert {name: entry["unit"] for name, entry in meanings["pinion"].items()} == {"u_P": "rad", "theta_P": "deg"}


def test_a_function_without_declarations_has_columns_without_units(curved: gm.Contact) -> None:
    pinion = replace(curved.pair.pinion, source_parameters=lambda p, v: {"u_P": p, "theta_P": v})
    plain = replace(curved, pair=replace(curved.pair, pinion=pinion))
    assert plain.listings[0].columns[6:8] == ["pinion u_P", "pinion theta_P"]
    assert json.loads(plain.json())["surface_parameters"]["pinion"] == {}


@pytest.mark.parametrize(
    ("name", "unit", "heading"),
    [("z_mm", "mm", "z, mm"), ("roll_length_mm", "mm", "roll length, mm"), ("u_c", "mm", "u_c, mm"), ("p", "", "p")],
)
def test_headings_state_the_unit_once(name: str, unit: str, heading: str) -> None:
    assert SourceParameter(name, unit, "length").heading == heading
