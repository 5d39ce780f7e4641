"""A run removes files of an earlier run alone: those that its manifest lists, unchanged, under names that runs give."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

import gearmesh as gm
from gearmesh.reports.run import MANIFEST_FILE, REPORT_FILE, RUN_FILE, _listed_files

pytestmark = pytest.mark.quick


def write_manifest(folder: Path, names: Iterable[str], **changed: Any) -> None:
    """A manifest as a run writes it, of files that are there."""
    digests = {name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in names}
    (folder / MANIFEST_FILE).write_text(json.dumps({"gearmesh": gm.__version__, "sha256": digests | changed}))


def test_only_files_of_the_manifest_are_removed(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    for name in ("pinion.stl", "gear.stl", "contact.json", "thesis.txt", "mine.stl", "flank.png"):
        (folder / name).write_text(name)
    (tmp_path / "loaded.json").write_text("beyond")
    (folder / "loaded.json").symlink_to(tmp_path / "loaded.json")
    outside = "../loaded.json"
    write_manifest(
        folder, ["pinion.stl", "contact.json", "thesis.txt", "mine.stl", "loaded.json", outside, "flank.png"]
    )
    (folder / "contact.json").write_text("edited since")
    # what no run writes, is a link, lies elsewhere or has been changed stays
    assert _listed_files(folder) == {"pinion.stl", "flank.png"}
    assert (tmp_path / "loaded.json").exists()


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"sha256": []}', '{"sha256": {"pinion.stl": 5}}', '{"sha256": 1', "\x00"]
)
def test_what_is_no_manifest_removes_nothing(tmp_path: Path, text: str) -> None:
    (tmp_path / "pinion.stl").write_text("solid")
    (tmp_path / MANIFEST_FILE).write_text(text)
    # nor does a report, whoever wrote it
    (tmp_path / REPORT_FILE).write_text(json.dumps({"files": ["pinion.stl", REPORT_FILE]}))
    assert _listed_files(tmp_path) == set()


@pytest.mark.parametrize(
    "name",
    [
        *(
            "pinion.stl",
            "planet_1.stl",
            "contact.json",
            "sun_planet_1_contact.csv",
            "pinion_gear_loaded_te.png",
            "pair.vtm",
        ),
        *("pinion_contact.png", "gear_loaded.png", "rack_modifications.png", "sheet.json", "report.html", "gear.png"),
    ],
)
def test_names_that_runs_give(name: str) -> None:
    assert RUN_FILE.fullmatch(name)


@pytest.mark.parametrize(
    "name", ["notes.txt", "holiday_pair.png", "contact.json.bak", "a/pinion.stl", "..", "my.stl", ""]
)
def test_names_that_no_run_gives(name: str) -> None:
    assert not RUN_FILE.fullmatch(name)
