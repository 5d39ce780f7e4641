"""Members of a gear set that are built when they are asked for, one without the other."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.errors import GearmeshError
from gearmesh.systems import blame
from gearmesh.systems.spiral_bevel import teeth_choice
from gearmesh.teeth import Member, Side

#: all settings of both members given
GIVEN = SAMPLES / "spiral_bevel_abdullah_straight.toml"


def alone(file: Path, *given: str) -> gm.Gears:
    return gm.build(gm.load(file, list(given), complete=False), alone=True)


def flanks(member: Member) -> Any:
    s, t = np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 4)
    return np.array([member.tooth.flank_grid(which, s, t).points for which in Side])


def test_a_member_alone_is_that_of_the_pair() -> None:
    pair, apart = gm.build(gm.load(GIVEN)), alone(GIVEN)
    for name in ("pinion", "gear"):
        np.testing.assert_array_equal(flanks(apart.members[name]), flanks(pair.members[name]))


def test_a_gear_is_built_without_looking_for_the_contact_of_its_pinion(monkeypatch: pytest.MonkeyPatch) -> None:
    def looked_for(*_: object) -> None:
        raise AssertionError("the gear does not depend on it")

    monkeypatch.setattr(teeth_choice, "contact_choice", looked_for)
    solid = alone(SAMPLES / "hypoid_formate.toml").solid("gear", 0.2)
    assert not solid.complaints
    with pytest.raises(AssertionError, match="does not depend"):
        _ = alone(SAMPLES / "hypoid_formate.toml").members["pinion"]


@pytest.mark.parametrize(
    ("name", "mate"), [("pinion", "gear.cutter.edge_radius=3"), ("gear", "pinion.convex.blade_angle=50")]
)
def test_a_member_with_settings_of_its_own_needs_no_mate_that_can_be_cut(
    name: str, mate: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gears = alone(GIVEN, mate)
    other = "gear" if name == "pinion" else "pinion"
    # that the pair is refused is asked here, not why
    monkeypatch.setattr(blame, "MOST_EFFORT", 0.0)
    with pytest.raises(GearmeshError):
        _ = gears.pairs
    assert gears.cad(name, 0.2).parts[0].name == name
    status, _, said = run("solid", GIVEN, "--set", mate, "--member", name, "--tol", "0.2mm", "-o", tmp_path / "one.stl")
    assert (status, said) == (0, "")
    # enough to find the key
    monkeypatch.setattr(blame, "MOST_EFFORT", 0.6)
    status, _, said = run("solid", GIVEN, "--set", mate, "--member", other, "-o", tmp_path / "other.stl")
    assert status == 2
    assert said.startswith(f"gearmesh: error: {mate.partition('=')[0]} = ")
