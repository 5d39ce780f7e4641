"""Allowances of an order: DIN 3967 letters, centre distances, tip diameters, in the sheet and in what is refused."""

from __future__ import annotations

import math
from typing import Any

import pytest

import gearmesh as gm
from gearmesh.systems.common.standards import din3967, iso286

#: mm: the sheet has nine decimals
EXACT = 1e-9


def design_of(kind: str = "cylindrical", **more: Any) -> gm.Design:
    """A design of example sizes; keys of members and of assembly are added to theirs."""
    keys: dict[str, Any] = {"kind": kind, "module": 2}
    for name, table in gm.system(kind).design.example.items():
        keys[name] = dict(table) if isinstance(table, dict) else table
    for name, value in more.items():
        keys[name] = {**keys.get(name, {}), **value} if isinstance(value, dict) else value
    return gm.parse({name: value for name, value in keys.items() if value is not None})


def tables_of(design: gm.Design) -> dict[str, dict[str, list[Any]]]:
    """Symbol -> values without their unit, by the title of the table."""
    tables = gm.build(design).sheet().plain_tables
    return {title: {key: row[1:] for key, row in rows.items()} for title, rows in tables.items()}


@pytest.mark.quick
def test_tables_of_din_3967_have_example_ends_and_preferred_steps() -> None:
    """The standard's example, 27 cd at 100 mm; the corners of both tables; each series is the next one a range lower."""
    assert din3967.allowances("27 cd", 100.0) == pytest.approx((-0.070, -0.170), abs=1e-12)
    assert din3967.allowances("cd25", 36.0) == pytest.approx((-0.054, -0.084), abs=1e-12)
    for diameter, upper in ((10.0, -0.1), (10.001, -0.135), (50.0, -0.135), (10000.0, -2.0)):
        assert din3967.allowances("a21", diameter)[0] == pytest.approx(upper, abs=1e-12)
    assert [din3967.allowances(f"h{n}", d)[1] for n, d in ((21, 5.0), (30, 9000.0))] == pytest.approx([-0.003, -2.4])
    # from series to series by the factor 1.6, rounded to preferred numbers
    for lower, higher in zip(range(21, 30), range(22, 31), strict=True):
        ratios = [
            b / a for a, b in zip(din3967.TOLERANCE_SERIES_UM[lower], din3967.TOLERANCE_SERIES_UM[higher], strict=True)
        ]
        assert all(1.19 < ratio < 1.70 for ratio in ratios), (lower, ratios)
    for row in zip(*din3967.UPPER_ALLOWANCES_UM.values(), strict=True):
        assert list(row) == sorted(row)


@pytest.mark.quick
def test_standard_tolerances_follow_the_formula_of_iso_286() -> None:
    """i = 0.45 D^(1/3) + 0.001 D (um, mm) of a range, times 7, 10 ... 160, before the standard rounds."""
    factors = {5: 7, 6: 10, 7: 16, 8: 25, 9: 40, 10: 64, 11: 100, 12: 160}
    for grade, factor in factors.items():
        for k, (low, high) in enumerate(zip(iso286.SIZE_LIMITS_MM, iso286.SIZE_LIMITS_MM[1:], strict=False), 1):
            middle = math.sqrt(low * high)
            unit = 0.45 * middle ** (1 / 3) + 0.001 * middle if high <= 500 else 0.004 * middle + 2.1
            assert iso286.STANDARD_TOLERANCES_UM[grade][k] == pytest.approx(factor * unit, rel=0.08, abs=1.0)
    assert iso286.deviations("js7", 51.5) == iso286.Deviations(0.015, -0.015)
    assert iso286.deviations("h8", 40.0) == iso286.Deviations(0.0, -0.039)
    assert iso286.deviations("H8", 40.0) == iso286.Deviations(0.039, 0.0)


@pytest.mark.quick
@pytest.mark.parametrize("units", ["mm", "inch"])
def test_a_letter_gives_the_allowances_of_the_reference_diameter(units: str) -> None:
    """In any unit, and of another module others; what is pinned has letter and ends, and loads back."""
    scale = 1.0 if units == "mm" else 1.0 / 25.4
    width = {"face_width": 20 * scale}
    design = design_of(
        units=units,
        module=2 * scale,
        helix_angle=15,
        pinion={**width, "thickness_allowance": "cd25"},
        gear={**width, "thickness_allowance": {"series": "25 cd"}},
    )
    for module, ends in ((2, [(-0.054, -0.084), (-0.07, -0.11)]), (6, [(-0.07, -0.11), (-0.095, -0.145)])):
        keys = design.with_values({"module": module * scale}).resolve()
        given = [keys[name]["thickness_allowance"] for name in ("pinion", "gear")]
        assert [(own["upper"], own["lower"]) for own in given] == [
            pytest.approx((upper * scale, lower * scale), abs=1e-12) for upper, lower in ends
        ]
    assert gm.parse(design.resolve()) == design


@pytest.mark.sweep
def test_the_sheet_states_letters_and_limits() -> None:
    """Sheet of a design with letters has the figures of the same limits given as numbers."""
    ends = {"pinion": (-0.054, -0.084), "gear": (-0.07, -0.11)}
    letters = {name: {"thickness_allowance": "cd25"} for name in ends}
    numbers = {name: {"thickness_allowance": {"upper": a, "lower": b}} for name, (a, b) in ends.items()}
    tables, same = (tables_of(design_of(helix_angle=15, **keys)) for keys in (letters, numbers))
    members = tables["Members"]
    assert members["A_sne"] == pytest.approx([-0.054, -0.07], abs=EXACT)
    assert members["A_sni"] == pytest.approx([-0.084, -0.11], abs=EXACT)
    assert members["T_sn"] == pytest.approx([0.03, 0.04], abs=EXACT)
    assert members["A_sn"] == pytest.approx([-0.069, -0.09], abs=EXACT)
    assert members["E_sn"] == ["cd25", "cd25"]
    for title in ("Backlash", "Measures of the tooth thickness"):
        for symbol, values in same[title].items():
            assert tables[title][symbol] == pytest.approx(values, abs=EXACT), symbol


@pytest.mark.sweep
@pytest.mark.sweep_cases("True")
@pytest.mark.parametrize("internal", [False, True])
def test_backlash_is_least_and_largest_at_the_ends_of_all_allowances(internal: bool) -> None:
    """Both ends are gears of their own, at their own centre distance, with one thickness."""
    teeth = {"gear": {"teeth": -60}} if internal else {}
    thick = {name: {**teeth.get(name, {}), "thickness_allowance": "e24"} for name in ("pinion", "gear")}
    tables = tables_of(design_of(**thick, assembly={"center_distance_allowance": "js7"}))
    pair, members, backlash = tables["Pair"], tables["Members"], tables["Backlash"]
    assert [pair["A_ae"][0], pair["A_ai"][0]] == pytest.approx([0.015, -0.015] if not internal else [0.0125, -0.0125])
    for column, end, away in ((2, "A_sne", -1.0), (3, "A_sni", 1.0)):
        own = {
            name: {**teeth.get(name, {}), "thickness_allowance": {"upper": value, "lower": value}}
            for name, value in zip(("pinion", "gear"), members[end], strict=True)
        }
        distance = pair["a"][0] + (-away if internal else away) * pair["A_ae"][0]
        tips = dict(zip(own, members["d_a"], strict=True))
        for name, table in own.items():
            table |= {"tip_diameter": tips[name], "profile_shift": 0}
        there = tables_of(design_of(**own, assembly={"center_distance": distance}))["Backlash"]
        for symbol in ("j_wt", "j_bn", "j_r"):
            assert backlash[symbol][column] == pytest.approx(there[symbol][1], abs=EXACT), symbol
    assert backlash["j_bn"][2] < backlash["j_bn"][1] < backlash["j_bn"][3]


@pytest.mark.sweep
def test_sets_and_racks_state_exactly_the_given_allowances() -> None:
    thick = {"thickness_allowance": "e24"}
    tables = tables_of(design_of("planetary", sun=thick, assembly={"center_distance_allowance": "js6"}))
    inner, outer = (tables[f"{pair}: Members"] for pair in ("Sun and planet", "Planet and ring"))
    assert inner["A_sne"] == [-0.03, None]
    assert "A_sne" not in outer
    for pair in ("Sun and planet", "Planet and ring"):
        assert tables[f"{pair}: Pair"]["A_ae"] == pytest.approx([0.008], abs=EXACT)
        assert len(tables[f"{pair}: Backlash"]["j_bn"]) == 4
    tables = tables_of(design_of("rack", pinion=thick, rack=thick))
    assert tables["Rack"]["A_sne"] == tables["Pinion: Members"]["A_sne"] == [-0.03]
    measures = tables["Pinion: Measures of the tooth thickness"]
    for symbol in ("W_k", "M_dK", "s_c", "s_nc"):
        ends = [measures[f"{symbol}_{end}"][0] for end in ("lower", "upper")]
        assert ends[0] < measures[symbol][0] < ends[1], symbol
    assert "A_sne" not in tables_of(design_of("rack", backlash=0.1))["Pinion: Members"]


def test_tip_diameters_have_their_deviations_in_the_sheet() -> None:
    given = design_of(
        pinion={"tip_diameter_tolerance": "h8"},
        gear={"teeth": -60, "tip_diameter_tolerance": {"upper": 0.1, "lower": -0.02}},
    )
    members = tables_of(given)["Members"]
    assert members["A_dae"] == [0.0, 0.1]
    assert members["A_dai"] == [-0.039, -0.02]


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"pinion": {"thickness_allowance": "cf25"}}, 'pinion.thickness_allowance = "cf25": must be a letter'),
        ({"pinion": {"thickness_allowance": "cd31"}}, 'the nearest is "cd30"'),
        ({"pinion": {"thickness_allowance": "CD25"}}, 'the nearest is "cd25"'),
        ({"pinion": {"thickness_allowance": {"series": "x"}}}, 'pinion.thickness_allowance.series = "x"'),
        ({"pinion": {"thickness_allowance": {"upper": 0.1}}}, "pinion.thickness_allowance.lower: missing"),
        ({"pinion": {"thickness_allowance": {"series": "cd25", "upper": 0.1}}}, "together with series = cd25"),
        ({"pinion": {"thickness_allowance": "cd25"}, "backlash": 0.1}, "together with pinion.thickness_allowance"),
        ({"module": 500, "gear": {"thickness_allowance": "a30"}}, "DIN 3967 ends at a reference diameter of 10000 mm"),
        (
            {"kind": "rack", "pinion": None, "rack": {"thickness_allowance": "e24"}},
            'rack.thickness_allowance.series = "e24": goes by a reference diameter',
        ),
        ({"assembly": {"center_distance_allowance": "js12"}}, 'must be "js5" to "js11"; the nearest is "js11"'),
        ({"assembly": {"center_distance_allowance": "h7"}}, 'must be "js5" to "js11"'),
        ({"pinion": {"tip_diameter_tolerance": "k7"}}, 'pinion.tip_diameter_tolerance = "k7": must be "h5" to "h12"'),
        ({"pinion": {"tip_diameter_tolerance": {"upper": 0.1}}}, "pinion.tip_diameter_tolerance.lower: missing"),
    ],
)
def test_what_is_no_allowance_is_refused_in_one_line(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(gm.DesignError) as failure:
        gm.build(design_of(**keys))
    assert said in str(failure.value)
    assert "\n" not in str(failure.value)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("module", "teeth", "shift", "tip", "tolerance"),
    [
        (3.2, 24, -0.5, 80.0, 0.074),
        (1.8, 99, -0.5, 180.0, 0.1),
        (2.1, 149, -0.5, 315.0, 0.13),
        (1.6, 249, -0.5, 400.0, 0.14),
    ],
)
def test_tip_diameter_at_a_limit_has_the_tolerance_of_the_range_below(
    module: float, teeth: int, shift: float, tip: float, tolerance: float
) -> None:
    """ISO 286-1: ranges are above one limit up to and including the next; m (z + 2 + 2 x) is above it by rounding alone."""
    assert 0.0 < module * teeth + 2.0 * module * (1.0 + shift) - tip < 1e-9
    member = {"teeth": teeth, "face_width": 10, "profile_shift": shift, "tip_diameter_tolerance": "h9"}
    rows = tables_of(design_of(module=module, pinion=member, gear={"profile_shift": -shift, "teeth": teeth}))["Members"]
    assert rows["d_a"][0] == pytest.approx(tip, abs=EXACT)
    assert rows["A_dai"][0] == pytest.approx(-tolerance, abs=EXACT)
