"""scripts/stress.py: designs from dice, what counts as a failure, and processes that hang or die."""

from __future__ import annotations

import importlib
import os
import sys
import time
from pathlib import Path
from types import ModuleType

import pytest
from oracles.places import ROOT

import gearmesh as gm


@pytest.fixture
def stress(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "stress", raising=False)
    return importlib.import_module("stress")


def test_every_kind_has_designs_that_its_seed_makes_again(stress: ModuleType) -> None:
    assert set(stress.KINDS) == set(gm.kinds())
    for kind in stress.KINDS:
        for name in stress.RANGES:
            keys = stress.random_design(kind, 3, name)
            assert keys == stress.random_design(kind, 3, name)
            assert keys != stress.random_design(kind, 4, name)
            known = {line.key for line in gm.system(kind).design.key_lines()}
            assert {dotted for dotted, _ in leaves(keys)} <= known


def leaves(table: dict[str, object], prefix: str = "") -> list[tuple[str, object]]:
    found: list[tuple[str, object]] = []
    for key, value in table.items():
        found += leaves(value, f"{prefix}{key}.") if isinstance(value, dict) else [(prefix + key, value)]
    return found


@pytest.mark.parametrize(
    ("message", "named"),
    [
        ("pinion.teeth = 5: too few", True),
        ("pinion.addendum: the tooth is pointed at z = -15 mm", False),
        ("gear.face_width: missing", False),
        ("assembly: cannot be", True),
        ("the fillets of neighbouring teeth overlap", False),
        ("module: missing", True),
    ],
)
def test_a_refusal_must_begin_with_a_key_that_is_set(stress: ModuleType, message: str, named: bool) -> None:
    keys = {"kind": "beveloid", "module": 2.0, "pinion": {"teeth": 5}, "assembly": {"dx": 0.1}}
    assert stress.names_a_set_key(message, keys) is named


@pytest.mark.sweep
def test_what_hangs_or_dies_or_breaks_is_a_failure(stress: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    def fake(task: object) -> object:
        seed = task.seed  # type: ignore[attr-defined]
        if seed == 0:
            time.sleep(60.0)
        if seed == 1:
            os._exit(7)
        return stress.Outcome("beveloid", seed, "edge")

    monkeypatch.setattr(stress, "tried", fake)
    tasks = [stress.Task("beveloid", seed, "edge") for seed in range(4)]
    found = {outcome.seed: outcome for outcome in stress.many(tasks, 2, 3.0)}
    assert {seed: outcome.state for seed, outcome in found.items()} == {0: "timeout", 1: "died", 2: "built", 3: "built"}
    assert set(found[0].failures) == {"timeout"}
    rows = stress.summary(list(found.values()))
    assert rows[0]["lost"] == 2
    assert set(rows[0]) == set(stress.COLUMNS)


def test_exceptions_that_are_not_of_gearmesh_are_kept(stress: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(design: object) -> object:
        raise ZeroDivisionError("here")

    monkeypatch.setattr(stress.gm, "build", broken)
    outcome = stress.tried(stress.Task("beveloid", 1, "sensible"))
    assert outcome.state == "traceback"
    assert "ZeroDivisionError: here" in outcome.failures["traceback"]


def test_failures_are_designs_that_load_again(stress: ModuleType, tmp_path: Path) -> None:
    outcome = stress.Outcome("spiral_bevel", 5, "sensible", failures={"contact": "off\nby two", "jam": "no play"})
    stress.saved_failures(outcome, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "spiral_bevel_sensible_5_contact.toml",
        "spiral_bevel_sensible_5_jam.toml",
    ]
    keys = stress.random_design("spiral_bevel", 5, "sensible")
    for path in tmp_path.iterdir():
        assert gm.load(path).plain() == gm.parse(keys).plain()


@pytest.mark.sweep
def test_a_contact_that_is_off_is_told(stress: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    """The roll finds what it should in a sample, and a contact turned by 0.1 arcsec is wrong."""
    gears = gm.build(gm.load(ROOT / "samples" / "spiral_bevel_basic.toml"))
    outcome = stress.Outcome("spiral_bevel", 0, "sensible")
    stress.contact(gears, outcome)
    assert "contact" not in outcome.failures
    right = stress.roll_flanks

    def off(*args: object) -> object:
        (found,) = right(*args)
        return (
            None
            if found is None
            else stress.ToothTouch(found.phi2 + 0.1 * stress.ARCSEC, *list(vars(found).values())[1:]),
        )

    monkeypatch.setattr(stress, "roll_flanks", off)
    stress.contact(gears, outcome)
    assert "contact" in outcome.failures


@pytest.mark.parametrize(
    ("least", "clearance", "region", "wrong"),
    [
        (0.001, -1.75, "root", False),
        (0.001, 0.2, "root", True),
        (0.001, -1.75, "fillet_right", True),
        (0.001, None, "root", True),
        (-0.001, 0.2, "fillet_right", False),
    ],
)
def test_a_tip_in_a_root_is_told_as_clearance(
    stress: ModuleType, least: float, clearance: float | None, region: str, wrong: bool
) -> None:
    """Backlash is that of flanks and fillets: a roll that stands on a root is against it only where no tip is said to be in one."""
    regions = stress.Region(region), stress.Region("flank_right")
    drive, coast = (stress.ToothTouch(phi2, 0, regions, (False, False), None) for phi2 in (0.01, 0.0))
    rolled = stress.MemberRoll(0.0, 1, drive, coast, {}, {})
    summary = {"backlash_min_deg": least, "tip_clearance_pinion_mm": 5.0, "tip_clearance_gear_mm": clearance}
    assert bool(stress.figures_against(summary, rolled)) is wrong
