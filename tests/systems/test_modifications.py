"""Micro-geometry as designs ask for it: what they get, what is refused and how, topography files, checks by independent routes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.examples import some

import gearmesh as gm
from gearmesh import Design, DesignError, load, parse
from gearmesh.answers.bodies.topography import flank_topography
from gearmesh.design.topography_file import TopographyGrid, read_topography, topography_text
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute

PLAIN: dict[str, Any] = {
    "kind": "beveloid",
    "module": 3,
    "backlash": 0.05,
    "pinion": {"teeth": 22, "face_width": 24, "helix_angle": 18},
    "gear": {"teeth": 40, "face_width": 22, "helix_angle": -18},
}


def with_pinion(**tables: Any) -> dict[str, Any]:
    return {**PLAIN, "pinion": {**PLAIN["pinion"], **tables}}


def removed(tables: dict[str, Any], length: Array, z: Array, side: Side = Side.RIGHT) -> Array:
    return amount_of(parse(with_pinion(**tables)), length, z, side)


def amount_of(design: Design, length: Array, z: Array, side: Side = Side.RIGHT) -> Array:
    flank = gm.build(design).members["pinion"].tooth.side(side).flank
    assert isinstance(flank, ScrewInvolute)
    assert flank.amount is not None
    return flank.amount.jet(length, z).a


def test_tables_add_up_on_their_own_sides() -> None:
    length, z = np.linspace(6.0, 17.0, 7), np.linspace(-11.0, 11.0, 7)
    both, left = {"profile_crowning": "20um"}, {"helix_slope": 0.01}
    of_both, of_left = (removed({"modifications": each}, length, z) for each in (both, left))
    tables = {"modifications": both, "modifications_left": left}
    np.testing.assert_allclose(removed(tables, length, z), of_both, atol=1e-16)
    np.testing.assert_allclose(removed(tables, length, z, Side.LEFT), of_both + of_left, atol=1e-16)
    assert of_left == pytest.approx(0.01 * (z + 12.0) / 24.0, abs=1e-15)


def test_starts_by_diameter_or_roll_length_are_one() -> None:
    tooth = gm.build(parse(with_pinion(modifications={"profile_crowning": 0.01}))).members["pinion"].tooth
    assert isinstance(tooth.right.flank, ScrewInvolute)
    diameter = 2.0 * np.hypot(tooth.right.flank.base_radius, 13.0)
    length, z = np.linspace(6.0, 17.0, 7), np.zeros(7)
    by = [
        removed({"modifications": {"tip_relief": {"amount": 0.02, key: value}}}, length, z)
        for key, value in (("start_roll_length", 13.0), ("start_diameter", float(diameter)))
    ]
    np.testing.assert_allclose(by[0], by[1], atol=1e-15)


@pytest.mark.parametrize(
    ("tables", "message"),
    [
        (
            {"tip_relief": {"amount": "20um"}},
            "pinion.modifications.tip_relief.start_diameter: missing; give start_diameter",
        ),
        (
            {"tip_relief": {"amount": "20um", "start_diameter": 20}},
            "pinion.modifications.tip_relief.start_diameter = 20 mm: allowed is between the flank's own ends, above 65.3",
        ),
        (
            {"root_relief": {"amount": "20um", "start_roll_length": 40}},
            "pinion.modifications.root_relief.start_roll_length = 40 mm: allowed is between",
        ),
        (
            {"tip_relief": {"amount": 2, "start_roll_length": 13}},
            "pinion.modifications.tip_relief.amount = 2 mm: the flank would get a slope of 0.319 mm/mm, above 0.1 mm/mm; "
            "allowed is at most 0.62",
        ),
        (
            {"end_relief_heel": {"amount": 0.01, "length": 30}},
            "pinion.modifications.end_relief_heel.length = 30 mm: allowed is less than the face width, 24 mm",
        ),
        (
            {"profile_slope": 1.5, "helix_crowning": "10um"},
            "pinion.modifications.profile_slope = 1.5 mm: the tooth is pointed at z = ",
        ),
        ({"topography": "nowhere.csv"}, "nowhere.csv: cannot be read: "),
        (
            {"tip_relief": {"amount": 0.02, "start_roll_length": 13, "shape": "round"}},
            'pinion.modifications.tip_relief.shape = "round": must be one of "linear", "parabolic", "circular"',
        ),
    ],
)
def test_refused(tables: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError) as found:
        gm.build(parse(with_pinion(modifications=tables)))
    assert str(found.value).startswith(message)
    assert "\n" not in str(found.value)


@pytest.mark.sweep
def test_refused_where_there_is_no_such_flank() -> None:
    with pytest.raises(DesignError, match=r"^pinion\.cone_angle = 5 deg: must be 0 where modifications are given"):
        parse(with_pinion(cone_angle=5.0, modifications={"profile_crowning": 0.01}))
    spur = {**PLAIN, "pinion": {"teeth": 22, "face_width": 24}, "gear": {"teeth": 40, "face_width": 22}}
    spur["pinion"]["modifications"] = {"triangular_end_relief_tip": {"amount": 0.01, "length": 5}}
    with pytest.raises(
        DesignError, match=r"triangular_end_relief_tip: contact lines of spur gears have no such corner"
    ):
        gm.build(parse(spur))


def test_topography_files(tmp_path: Path) -> None:
    """Written and read to the last digit; the flank has the amounts at the grid, by roll length or by diameter."""
    lengths, z = (6.0, 9.0, 12.0, 15.0, 17.0), (-11.0, -5.0, 0.0, 6.0, 11.0)
    amounts = tuple(tuple(0.01 + 0.003 * np.sin(x + 0.3 * y) for y in z) for x in lengths)
    grid, file = TopographyGrid(lengths, z, amounts), tmp_path / "t.csv"
    file.write_text(topography_text(grid), encoding="utf-8")
    read = read_topography(file)
    assert (read.across, read.z, read.diameters) == (lengths, z, False)
    np.testing.assert_allclose(read.amounts, amounts, atol=1e-17)
    at = np.meshgrid(lengths, z, indexing="ij")
    np.testing.assert_allclose(removed({"modifications": {"topography": str(file)}}, *at), amounts, atol=1e-15)
    flank = gm.build(parse(with_pinion(modifications={"helix_slope": 0.01}))).members["pinion"].tooth.right.flank
    assert isinstance(flank, ScrewInvolute)
    by_diameter = TopographyGrid(tuple(2.0 * np.hypot(flank.base_radius, x) for x in lengths), z, amounts, True)
    file.write_text(topography_text(by_diameter), encoding="utf-8")
    np.testing.assert_allclose(removed({"modifications": {"topography": str(file)}}, *at), amounts, atol=1e-12)
    design = tmp_path / "design.json"
    design.write_text(json.dumps(with_pinion(modifications={"topography": "t.csv"})), encoding="utf-8")
    np.testing.assert_allclose(amount_of(load(design), *at), amounts, atol=1e-12)
    for text, message in (
        ("r,z,a\n1,2,3\n", r"line 1: allowed is roll_length_mm,z_mm,amount_um or diameter_mm,z_mm,amount_um"),
        ("roll_length_mm,z_mm,amount_um\n1,2,x\n", r"line 2: amount_um = \"x\": must be a finite number"),
        (
            "roll_length_mm,z_mm,amount_um\n1,2,3\n1,3,3\n2,2,3\n",
            r"3 amounts at 2 places across .* the file must have one for each",
        ),
    ):
        file.write_text(text, encoding="utf-8")
        with pytest.raises(DesignError, match=message):
            read_topography(file)


FACE = {"kind": "face_gear", "module": 3, "pinion": {"teeth": 25}, "gear": {"teeth": 120}, "shaper": {"teeth": 28}}


@pytest.mark.sweep
@pytest.mark.sweep_cases("left-modified_involute", "right-face_gear")
@pytest.mark.parametrize(
    ("base", "name"), some([(FACE, "pinion"), ({}, "gear")], 2), ids=["face_gear", "modified_involute"]
)
@pytest.mark.parametrize("side", ["right", "left"])
def test_a_point_of_contact_gives_way_by_the_amount_there(base: dict[str, Any], name: str, side: str) -> None:
    """Involutes whose mating gears touch them in a point: the mesh turns by amount / base radius, to first order."""
    plain = base or {"kind": "modified_involute", "mesh": {}, **gm.system("modified_involute").design.example}
    plain = {**plain, "contact": {"flank": side, "phi1": {"start": -5, "stop": 5, "count": 5}}}
    fields = {"profile_slope": "0.2um", "helix_slope": "-0.1um", "profile_crowning": "0.1um"}
    relieved = {**plain, name: {**plain[name], f"modifications_{side}": fields}}
    gears, found = gm.build(parse(plain)), gm.build(parse(relieved))
    path, bent = (each.contact(cycle=False).path for each in (gears, found))
    member, of = found.members[name], ("pinion", "gear").index(name)
    flank = member.tooth.side(Side(side)).flank
    assert isinstance(flank, ScrewInvolute)
    assert flank.amount is not None
    r = path.point1 if of == 0 else path.point2
    length = np.sqrt(np.hypot(r[:, 0], r[:, 1]) ** 2 - flank.base_radius**2)
    wanted = flank.amount.jet(length, r[:, 2]).a / flank.base_radius * (gears.pairs[0].ratio if of == 0 else 1.0)
    lag = gears.pairs[0].drive * (path.phi2 - bent.phi2)
    assert wanted.max() > 4e-7
    np.testing.assert_allclose(lag, wanted, rtol=0.02, atol=2e-9)


def test_mating_gears_that_are_no_involutes_have_no_modifications() -> None:
    plain = {**gm.system("modified_involute").design.example, "kind": "modified_involute"}
    crowned = {**plain["gear"], "parabola": 0.001, "modifications": {"helix_slope": 0.001}}
    for design, message in (
        ({**plain, "gear": crowned}, r"^gear.parabola = 0.001 1/mm: must be 0 where modifications are given$"),
        ({**plain, "pinion": {**plain["pinion"], "modifications": {}}}, r"^pinion.modifications: unknown key"),
        ({**FACE, "gear": {"teeth": 120, "modifications": {}}}, r"^gear.modifications: unknown key"),
    ):
        with pytest.raises(DesignError, match=message):
            parse(design)


@pytest.mark.sweep
def test_limits_are_those_of_the_tool() -> None:
    designs = with_pinion(modifications={"profile_slope": 0.01}), PLAIN
    modified, plain = (gm.build(parse(design)).limits().document() for design in designs)
    for key in ("h1_mm", "h2_mm", "sides", "fewest_teeth"):
        np.testing.assert_equal(modified["members"]["pinion"][key], plain["members"]["pinion"][key])


@pytest.mark.sweep
def test_rolled_meshes_agree_with_the_solver() -> None:
    """The roll test, which knows nothing of amounts and corners but the meshed flanks."""
    fields = {
        "helix_crowning": "8um",
        "tip_relief": {"amount": "20um", "start_roll_length": 13.0},
        "end_relief_toe": {"amount": "10um", "length": 3},
    }
    design = with_pinion(modifications=fields)
    relief = {"amount": "15um", "start_roll_length": 20.0, "shape": "parabolic"}
    design["gear"] = {**design["gear"], "modifications": {"tip_relief": relief}}
    train = gm.build(parse(design))
    verdicts = train.check().verdicts
    assert {each.what for each in verdicts if not each.ok} == set()
    assert any(each.what == "roll: te_difference_arcsec" for each in verdicts)


EVERYTHING = {
    "tip_relief": {"amount": "20um", "start_roll_length": 13.0},
    "root_relief": {"amount": "10um", "start_roll_length": 7.0, "shape": "circular"},
    "helix_crowning": "8um",
    "profile_twist": "6um",
    "end_relief_toe": {"amount": "10um", "length": 3, "shape": "parabolic"},
    "triangular_end_relief_tip": {"amount": "5um", "length": 4},
}


@pytest.mark.parametrize("base", [PLAIN, {"kind": "cylindrical", "module": 2, "pinion": {}, "gear": {}}])
@pytest.mark.sweep_cases("base0")
def test_a_topography_written_is_the_flank_again(base: dict[str, Any], tmp_path: Path) -> None:
    """Flank with every modification at once, written and read again: the same to 1e-12 mm at the knots, and to 1e-5 mm
    everywhere."""
    helical = base is PLAIN
    fields = (
        EVERYTHING if helical else {"tip_relief": {"amount": "15um", "start_diameter": 89.0}, "helix_slope": -0.004}
    )
    teeth = {"teeth": -45, "face_width": 20}
    own = with_pinion if helical else lambda **t: {**base, "pinion": {"teeth": 18, "face_width": 18}, "gear": teeth | t}
    name, file = "pinion" if helical else "gear", tmp_path / "left.csv"
    gears = gm.build(parse(own(modifications=fields, modifications_left={"profile_slope": "-3um"})))
    found = gears.topography(name, "left")
    found.save(file)
    again = gm.build(parse(own(modifications_left={"topography": str(file)})))
    flanks = [each.members[name].tooth.left.flank for each in (gears, again)]
    at = np.meshgrid(found.grid.across, found.grid.z, indexing="ij")
    amounts = []
    for flank in flanks:
        assert isinstance(flank, ScrewInvolute)
        assert flank.amount is not None
        amounts.append(flank.amount.jet(*at).a)
    assert np.abs(amounts[0] - amounts[1]).max() < 1e-12
    assert amounts[0].max() > 0.015
    rng = np.random.default_rng(7)
    low, high = (np.array([f(found.grid.across), f(found.grid.z)]) for f in (min, max))
    places = low + (high - low) * rng.random((200_000, 2))
    apart = np.linalg.norm(flanks[0].jet(*places.T).r - flanks[1].jet(*places.T).r, axis=1).max()
    assert 1e-7 < apart < 1e-5
    assert found.missed <= 1e-5


def test_topographies_that_are_refused() -> None:
    gears = gm.build(parse(with_pinion(modifications_left={"tip_relief": EVERYTHING["tip_relief"]})))
    for arguments, message in (
        (
            ("gear", "left"),
            r"^flank = left: this flank has no modification; allowed is a flank with gear.modifications or gear",
        ),
        (
            ("pinion", "right"),
            r"^flank = right: this flank has no modification; allowed .* pinion.modifications_right$",
        ),
        (("pinion", "upper"), r"^flank = upper: must be one of right, left$"),
        (("wheel", "left"), r"^member = wheel: must be one of pinion, gear$"),
        (("pinion", "left", 1e-16), r"^tolerance = 1e-16: must be a length as .* from 0\.01um to 10mm$"),
    ):
        with pytest.raises(DesignError, match=message):
            gears.topography(*arguments)  # type: ignore[arg-type]
    with pytest.raises(DesignError, match=r"^tolerance = 1e-13 um: a topography would need more than 300 knots"):
        flank_topography(gears, "pinion", "left", 1e-16)
