"""The files of a run appear together, or not at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import gearmesh as gm
from gearmesh import NoSolutionError, OutputError, io
from gearmesh.io.atomic import files_together, written_whole

GEAR = {"kind": "cylindrical", "module": 2, "gear": {"teeth": 12, "face_width": 10}}


def test_a_run_that_fails_leaves_the_folder_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object, **__: object) -> None:
        raise NoSolutionError("gear", reason="no such figure")

    monkeypatch.setattr("gearmesh.reports.run.limits_of", refused)
    gears, folder = gm.build(gm.parse(GEAR), alone=True), tmp_path / "new" / "out"
    with pytest.raises(NoSolutionError):
        gears.run(folder, 0.1, page=False)
    assert not (tmp_path / "new").exists()
    folder.mkdir(parents=True)
    (folder / "gear.stl").write_text("of an earlier run")
    (folder / "report.json").write_text('{"files": ["gear.stl", "gone.png"]}')
    with pytest.raises(NoSolutionError):
        gears.run(folder, 0.1, page=False)
    assert {file.name: file.read_text() for file in folder.iterdir()} == {
        "gear.stl": "of an earlier run",
        "report.json": '{"files": ["gear.stl", "gone.png"]}',
    }


def write_both(folder: Path) -> None:
    with files_together(folder) as temporary:
        io.whole_text(temporary / "a.txt", "newer")
        io.whole_text(temporary / "b.txt", "newer")


def test_files_and_folders_come_into_place_together(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    with files_together(folder) as temporary:
        io.whole_text(temporary / "a.txt", "new")
        with io.whole_folder(temporary / "a_pieces", ".vtp") as pieces:
            (pieces / "b.vtp").write_text("new")
        assert [file.name for file in folder.iterdir()] == [temporary.name]
    assert {file.name for file in folder.iterdir()} == {"a.txt", "a_pieces"}
    assert written_whole()[-2:] == (folder / "a_pieces", folder / "a.txt")
    (folder / "b.txt").mkdir()
    with pytest.raises(OutputError, match=r"cannot write .*out.b\.txt: it is a folder"):
        write_both(folder)
    assert (folder / "a.txt").read_text() == "new"
    assert len(os.listdir(folder)) == 3


def test_refusals_name_files_where_they_would_have_been(tmp_path: Path) -> None:
    with pytest.raises(OutputError) as refused, files_together(tmp_path / "out") as temporary:
        io.whole_text(temporary / "none" / "a.txt", "new")
    assert ".gearmesh-" not in str(refused.value)
    assert str(tmp_path / "out" / "none" / "a.txt") in str(refused.value)
