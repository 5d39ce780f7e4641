"""Two versions side by side: what of their figures is compared, and what a run of a command takes."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from oracles.scripts import script

against = script("against")


def test_figures_are_compared_by_their_paths_and_times_are_not() -> None:
    before = {"mesh": {"pinion": {"max": 4.0, "seconds": 1.0}}, "path": [1.0, None, 2.0], "ok": True}
    now = {"mesh": {"pinion": {"max": 4.0 + 1e-9, "seconds": 2.0}}, "path": [1.0 + 1e-13, None, 2.0], "ok": False}
    assert against.differing(before, now) == (5, ["mesh.pinion.max", "ok"])
    assert against.differing(before, before) == (5, [])
    assert against.error_of({"mesh": {"pinion": {"max": 4.0}, "gear": {"max": 5.0}}}, "mesh.*.max") == 5.0
    assert against.figures_of("triangles  9024\nwatertight  true\nmax_deviation_um  9.48\n") == {
        "triangles": 9024.0,
        "max_deviation_um": 9.48,
    }


@pytest.mark.sweep
def test_a_command_beside_itself_has_the_same_figures(tmp_path: Path) -> None:
    command = against.Command("describe samples/spur.toml --json -", "", "seconds_are_no_figure")
    pythons = (Path(sys.executable), Path(sys.executable))
    with pytest.raises(KeyError, match="seconds_are_no_figure"):
        against.row("describe", command, pythons, 1, tmp_path)
    (tmp_path / "again").mkdir()
    row = against.row("describe", against.Command(command.words, ""), pythons, 1, tmp_path / "again")
    assert row["figures"] > 100
    assert row["differ"] == 0
    # the command's own peak, not that of the process that asks for it
    assert 0 < row["megabytes"] < 150
    with pytest.raises(SystemExit, match="must be a version number or a revision"):
        against.revision("no such version")


def test_rows_of_commands_that_are_not_measured_again_stay(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the order of the commands, once each; of another version none stays."""
    monkeypatch.setattr(against.tables, "MEASURED", tmp_path / "measured")
    names = [*against.COMMANDS]
    row = {"version": "0.17.0", "cpu_before": 3.0, "cpu": 1.5, "ratio": 2.0, "rounds": 1}
    rows = [{"command": name, **row} for name in names[:4]]
    against.keep([rows[3], rows[0]])
    against.keep([rows[1], {**rows[3], "ratio": 2.5}])
    known = against.tables.kept("against")
    assert [line["command"] for line in known] == [names[k] for k in (0, 1, 3)]
    assert [line["before / now"] for line in known] == ["2", "2", "2.5"]
    against.keep([{**rows[0], "version": "0.16.0"}])
    assert [line["version before"] for line in against.tables.kept("against")] == ["0.16.0"]
