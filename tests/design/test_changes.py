"""The version and what changed with it: a design that states one is told, and no default changes without an entry."""

from __future__ import annotations

import importlib.util
import json
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.design.changes import DEFAULT_CHANGES, changes_since, parse_version

ROOT = SAMPLES.parent
SAY = (
    "a default changed: raise the version and add an entry to gearmesh/CHANGES.md (the table is gearmesh/design/changes.py), then "
    "run scripts/defaults_snapshot.py"
)
#: samples whose derived values are looked at: of every kind one that is soon built
SOON = (
    *("spur", "internal", "planetary", "rack", "beveloid_crossed", "circular_arc", "face_gear"),
    *("spiral_bevel_basic", "spiral_bevel_geometry1"),
)


def script() -> Any:
    spec = importlib.util.spec_from_file_location("defaults_snapshot", ROOT / "scripts" / "defaults_snapshot.py")
    assert spec is not None
    assert spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


def test_no_default_has_changed_without_an_entry() -> None:
    snapshot = script()
    stored = json.loads(snapshot.SNAPSHOT.read_text(encoding="utf-8"))
    assert stored["gearmesh"] == gm.__version__, SAY
    kinds = {kind: json.loads(json.dumps(dict(snapshot.defaults(gm.system(kind).design)))) for kind in gm.kinds()}
    kinds = {kind: kinds[kind] for kind in stored["defaults"]}
    changed = snapshot.differences(stored["defaults"], kinds)
    for name in SOON:
        changed += snapshot.differences(stored["samples"][name], snapshot.derived(SAMPLES / f"{name}.toml"), name)
    assert not changed, "\n".join((SAY, *changed))


@pytest.mark.quick
def test_a_changed_default_or_rule_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    snapshot = script()
    stored = json.loads(snapshot.SNAPSHOT.read_text(encoding="utf-8"))
    monkeypatch.setattr("gearmesh.systems.common.bodies.body.DEFAULT_BORE", 0.41)
    assert snapshot.differences(stored["samples"]["spur"], snapshot.derived(SAMPLES / "spur.toml"))
    assert snapshot.differences({"a": {"b": 20.0}}, {"a": {"b": 25.0, "c": "x"}}) == [
        "a b: 20.0 -> 25.0",
        "a c: absent -> x",
    ]


@pytest.mark.quick
def test_version_log_and_table_agree() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    assert project["project"]["dynamic"] == ["version"]
    assert project["tool"]["hatch"]["version"]["path"] == "gearmesh/__init__.py"
    snapshot = script()
    log = snapshot.LOG.read_text(encoding="utf-8")
    entries = re.findall(r"^## ([\d.]+)$", log, re.MULTILINE)
    assert entries[0] == gm.__version__
    assert entries == sorted(entries, key=parse_version, reverse=True)
    assert {each.version for each in DEFAULT_CHANGES} <= set(entries)
    assert [each.version for each in DEFAULT_CHANGES] == sorted(
        (each.version for each in DEFAULT_CHANGES), key=parse_version
    )
    assert snapshot.logged(log) == log, "run scripts/defaults_snapshot.py"
    for each in DEFAULT_CHANGES:
        for kind in each.kinds or gm.kinds():
            assert gm.system(kind).design.key_at(each.key) is not None, each
    assert run("--version") == (0, f"gearmesh {gm.__version__}\n", "")


@pytest.mark.quick
def test_a_design_of_an_older_version_is_told_what_has_changed_since(tmp_path: Path) -> None:
    keys = {"kind": "face_gear", "module": 3, "pinion": {"teeth": 25}, "gear": {"teeth": 120}, "shaper": {"teeth": 28}}
    said = [line for line in gm.build(gm.parse({**keys, "gearmesh": "0.1"})).warnings if "since gearmesh 0.1" in line]
    assert len(said) == 1
    assert "pinion.dedendum: 1.25 -> 1.25, or what clears the gear's tips (0.2.0)" in said[0]
    # not of what it gives itself, nor of what another kind has
    given = {**keys, "gearmesh": "0.1.0", "pinion": {"teeth": 25, "dedendum": 1.25}}
    (line,) = (each for each in gm.build(gm.parse(given)).warnings if "since gearmesh 0.1.0" in each)
    assert "pinion.dedendum" not in line
    assert "path_angle" not in line
    for version in (None, "0.2", gm.__version__):
        own = keys if version is None else {**keys, "gearmesh": version}
        assert not any("since gearmesh" in each for each in gm.build(gm.parse(own)).warnings)
    assert changes_since("0.1", "spiral_bevel")
    assert not changes_since(gm.__version__, "spiral_bevel")


@pytest.mark.quick
def test_keys_of_one_end_of_an_older_ring_are_warned_of() -> None:
    keys = ["gear.toe_bore={diameters=[170],lengths=[2]}", "gear.rim=20", "pinion.end_chamfer_toe=0.2"]
    for version, count in (("0.10", 1), (gm.__version__, 0)):
        design = gm.load(SAMPLES / "internal.toml", [*keys, f'gearmesh="{version}"'])
        said = [
            line
            for line in gm.build(design).warnings
            if line.startswith("gear.toe_bore.diameters: since gearmesh 0.11.0 the toe")
        ]
        assert len(said) == count


@pytest.mark.quick
def test_a_version_that_is_none_or_newer_is_refused_in_one_line() -> None:
    sample = SAMPLES / "spur.toml"
    line = refused("tca", sample, "--set", 'gearmesh="99.0"')
    assert line.startswith('gearmesh = "99.0": newer than this program, ')
    assert "must be a version" in refused("tca", sample, "--set", 'gearmesh="two"')


def test_whatever_writes_a_design_states_the_version(tmp_path: Path) -> None:
    for name, arguments in {
        "new": ("new", "cylindrical"),
        "size": ("size", "--ratio", "2.5", "--center-distance", "64", "--module", "2"),
        "pin": ("pin", SAMPLES / "spur.toml"),
        "settings": ("settings", SAMPLES / "circular_arc.toml", "--set", "assembly.dgamma=0.05"),
    }.items():
        file = tmp_path / f"{name}.toml"
        status, _, error = run(*arguments, "-o", file)
        assert status == 0, error
        assert tomllib.loads(file.read_text(encoding="utf-8"))["gearmesh"] == gm.__version__, name
