"""Progress of a piece of work: parts within parts, and messages of long answers."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from oracles.built import pair_of
from oracles.command_line import run
from oracles.places import ROOT, SAMPLES

import gearmesh as gm
from gearmesh import load
from gearmesh.kinds import Tooth
from gearmesh.loaded import sharing
from gearmesh.loaded.compliance.compliance import FlankCompliance, flank_compliance
from gearmesh.progress import in_turn, listening, part, tell


@pytest.mark.quick
def test_parts_are_fractions_of_the_whole() -> None:
    told: list[float] = []
    with listening(told.append):
        with part(0.0, 0.4):
            tell(0.5)
        with part(0.4, 1.0):
            for _ in in_turn("ab"):
                tell(0.5)
    tell(0.1)
    assert told == pytest.approx([0.2, 0.4, 0.55, 0.7, 0.85, 1.0, 1.0])


@pytest.mark.sweep_cases("<lambda>-5", "<lambda>-8")
@pytest.mark.parametrize(
    ("ask", "least"),
    [
        (lambda gears: gears.check(0.05), 8),
        (lambda gears: gears.finite_elements(), 5),
        (lambda gears: gears.composite(), 4),
    ],
)
def test_long_answers_say_how_far_they_are(ask: Callable[[gm.Gears], object], least: int) -> None:
    tables = {"pinion": {"teeth": 18, "face_width": 10}, "gear": {"teeth": 24, "face_width": 10}}
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **tables}))
    told: list[float] = []
    with listening(told.append):
        ask(gears)
    assert told == sorted(told)
    assert len(set(told)) > least


@pytest.mark.sweep
def test_search_for_bevel_contact_reports_progress() -> None:
    told: list[float] = []
    with listening(told.append):
        # a pair of no other test: what was searched for before is known
        gm.build(gm.load(ROOT / "samples" / "spiral_bevel_basic.toml", ["spiral_angle=34.7"]))
    assert told == sorted(told)
    # of the first flank, of both
    assert 0.0 < told[0] < 0.5 < told[-2] < told[-1] == 1.0


@pytest.mark.quick
@pytest.mark.parametrize(
    ("words", "stage"),
    [
        (("size", "--ratio", "2", "--center-distance", "90", "--module", "2.5"), "sizes"),
        (("limits", SAMPLES / "spur.toml"), "limits"),
        (("pin", SAMPLES / "spur.toml", "-o", "pinned.toml"), "pin"),
        (("grid", SAMPLES / "spur.toml", "--member", "gear", "-o", "grid.csv"), "measuring grid"),
        (("solid", SAMPLES / "spur.toml", "--member", "gear", "-o", "gear.svg"), "section of the gear"),
    ],
)
@pytest.mark.sweep_cases("words1-limits")
def test_stages_are_lines_in_a_pipe_however_short_they_are(
    words: tuple[str | Path, ...], stage: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Work that may take long always says so: no clock decides what is printed."""
    monkeypatch.chdir(tmp_path)
    status, _, err = run(*words)
    lines = err.splitlines()
    assert (status, lines[0], lines.count(lines[0])) == (0, f"gearmesh: {stage}", 1)


def test_compliances_end_where_nobody_waits_for_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """One member's cannot be found: the other's stops at its next layer, in place of taking its seconds."""
    pair = pair_of(load(SAMPLES / "helical.toml"))
    done: list[FlankCompliance] = []

    def compliance(tooth: Tooth, *arguments: Any, **keys: Any) -> FlankCompliance:
        if tooth is pair.pinion.one_tooth:
            raise KeyboardInterrupt
        done.append(flank_compliance(tooth, *arguments, **keys))
        return done[-1]

    monkeypatch.setattr(sharing, "flank_compliance", compliance)
    with pytest.raises(KeyboardInterrupt):
        sharing.compliances(pair)
    assert not done
