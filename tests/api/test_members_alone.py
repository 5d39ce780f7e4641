"""Members of a gear set that are built when they are asked for, one without the other."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import messages, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearmeshError, Member
from gearmesh.kinds import Side
from gearmesh.systems import diagnosis
from gearmesh.systems.spiral_bevel.synthesis import teeth_choice

#: all settings of both members given
GIVEN = SAMPLES / "spiral_bevel_abdullah_straight.toml"


def alone(file: Path, *given: str) -> gm.Gears:
    return gm.build(gm.load(file, list(given), complete=False), alone=True)


def flanks(member: Member) -> Any:
    s, t = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 4)
    return np.array([member.tooth.flank_grid(which, s, t).points for which in Side])


@pytest.fixture(scope="module")
def of_the_pair() -> dict[str, Any]:
    """Flanks of both members of the pair."""
    return {name: flanks(member) for name, member in gm.build(gm.load(GIVEN)).members.items()}


@pytest.mark.quick
@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_a_member_alone_is_that_of_the_pair(name: str, of_the_pair: dict[str, Any]) -> None:
    np.testing.assert_array_equal(flanks(alone(GIVEN).members[name]), of_the_pair[name])


@pytest.mark.sweep_cases("gear-pinion.convex.blade_angle=50")
@pytest.mark.parametrize(
    ("name", "mating"), [("pinion", "gear.cutter.edge_radius=3"), ("gear", "pinion.convex.blade_angle=50")]
)
def test_the_sheet_of_a_member_has_the_figures_of_the_pairs(name: str, mating: str) -> None:
    """Beside a gear that cannot be cut: every figure is that of the pair's sheet, what needs a mating gear is left out."""
    sheet, of_pair = alone(GIVEN, mating).sheet(member=name), gm.build(gm.load(GIVEN)).sheet().plain_tables
    own = sheet.plain_tables
    columns = {table.title: table.columns for table in gm.build(gm.load(GIVEN)).sheet().tables}
    compared = 0
    for title in own.keys() & of_pair.keys():
        mine = [k for k, column in enumerate(columns[title]) if not column or column.startswith(name)]
        for item, (_, *values) in own[title].items():
            theirs = [of_pair[title][item][1 + k] for k in mine]
            if isinstance(values[0], str):
                assert values == theirs, item
            elif values != [None]:
                assert values == pytest.approx(theirs, rel=1e-9, abs=1e-12), item
                compared += len(values)
    assert compared > 60
    assert "mean normal thickness" not in own["Blank"]
    assert own["Members at mid face"]["teeth"][1] in (10, 41)
    (said,) = (line for line in sheet.warnings if "one member alone" in line)
    assert said.startswith(f"{name}: ")


@pytest.mark.quick
def test_the_sheet_of_a_member_by_the_command_line() -> None:
    status, text, said = run("describe", GIVEN, "--member", "gear", "--set", "pinion.convex.blade_angle=50")
    assert status == 0
    assert "s_mn" in text
    assert (
        said
        == "gearmesh: warning: gear: one member alone: its sheet has no axes, ratio, backlash, contact ratios or forces\n"
    )
    for more, refusal in (
        (["--member", "wheel"], "--member = wheel: must be one of pinion, gear"),
        (["--member", "gear", "--torque", "5"], "--torque = 5: forces need both members; leave member out"),
    ):
        assert run("describe", GIVEN, *more) == (2, "", f"gearmesh: error: {refusal}\n")
    assert run("describe", "cylindrical", "--member", "gear")[0] == 2


def test_a_gear_is_built_without_looking_for_the_contact_of_its_pinion(monkeypatch: pytest.MonkeyPatch) -> None:
    def looked_for(*_: object) -> None:
        raise AssertionError("the gear does not depend on it")

    monkeypatch.setattr(teeth_choice, "contact_choice", looked_for)
    # what another test has built is remembered
    for remembered in (teeth_choice._search, teeth_choice._best_teeth):
        remembered.cache_clear()
    solid = alone(SAMPLES / "hypoid_formate.toml").solid("gear", 0.05)
    assert not solid.complaints
    with pytest.raises(AssertionError, match="does not depend"):
        alone(SAMPLES / "hypoid_formate.toml").solid("pinion", 0.05)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("name", "mating"), [("pinion", "gear.cutter.edge_radius=3"), ("gear", "pinion.convex.blade_angle=50")]
)
def test_member_with_own_settings_needs_no_feasible_mating_gear(
    name: str, mating: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, of_the_pair: dict[str, Any]
) -> None:
    gears = alone(GIVEN, mating)
    other = "gear" if name == "pinion" else "pinion"
    np.testing.assert_array_equal(flanks(gears.members[name]), of_the_pair[name])
    assert not gears.solid(name, 0.05).complaints
    assert gears.cad(name).parts[0].name == name
    # that the pair and the other member are refused is asked here, not why
    monkeypatch.setattr(diagnosis, "MAX_EFFORT", 0.0)
    for refused in (lambda: gm.build(gm.load(GIVEN, [mating])), lambda: gears.pairs, lambda: gears.members[other]):
        with pytest.raises(GearmeshError, match=other):
            refused()
    status, _, said = run(
        "solid", GIVEN, "--set", mating, "--member", name, "--tol", "0.1mm", "-o", tmp_path / "one.stl"
    )
    assert (status, messages(said)) == (0, "")
    monkeypatch.undo()
    status, _, said = run("solid", GIVEN, "--set", mating, "--member", other, "-o", tmp_path / "other.stl")
    key, _, value = mating.partition("=")
    assert status == 2
    assert not (tmp_path / "other.stl").exists()
    found = re.match(rf"gearmesh: error: {re.escape(key)} = {value} (mm|deg): allowed is at most (\S+) ", said)
    # what is said to be allowed is
    assert found is not None
    assert flanks(alone(GIVEN, f"{key}={found[2]}").members[other]).shape == of_the_pair[other].shape


@pytest.mark.sweep
def test_one_member_of_a_pair_built_together_has_its_sheet_columns() -> None:
    gears = gm.build(gm.load(SAMPLES / "planetary.toml"))
    whole, own = gears.sheet().tables, gears.sheet(member="planet_1").plain_tables
    for table in whole:
        if "planet" not in table.columns or table.title == "Tools":
            continue
        column = 2 + table.columns.index("planet")
        theirs = [row[column] for row in table.rows if row[column] is not None]
        assert [value for _, value in own[table.title].values()] == theirs, table.title
    assert "Backlash" not in "".join(own)
