"""Leftovers of a killed process are removed by the next process that writes there, and nothing else is."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from oracles.places import ROOT

pytestmark = pytest.mark.skipif(os.name != "posix", reason="elsewhere leftovers stay")

HALF_WRITTEN = """
import time
from gearmesh import io
with io.whole_file("gear.stl") as file, io.whole_folder("gear_pieces", ".vtp") as folder:
    file.write_text("half")
    (folder / "a.vtp").write_text("half")
    print("busy", flush=True)
    time.sleep(600)
"""
#: stopped between the two renames that exchange a folder
EXCHANGE = """
import os, time
from gearmesh import io
rename = os.rename
def once(source, target):
    rename(source, target)
    print("busy", flush=True)
    time.sleep(600)
os.rename = once
with io.whole_folder('gear_pieces', '.vtp') as temporary:
    (temporary / 'new.vtp').write_text('new')
"""


@contextmanager
def busy(folder: Path, program: str) -> Iterator[subprocess.Popen[str]]:
    """A child process in the middle of `program`, killed at the end if not before."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, cwd=folder, env=environment, stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        try:
            assert child.stdout.readline() == "busy\n"
            yield child
        finally:
            child.kill()


def killed(folder: Path, program: str) -> None:
    with busy(folder, program) as child:
        child.send_signal(signal.SIGKILL)
        assert child.wait() == -signal.SIGKILL


def write_elsewhere(folder: Path, name: str) -> None:
    """Another process writes a file into the folder."""
    program = f"from gearmesh import io; io.whole_text({name!r}, 'whole')"
    subprocess.run([sys.executable, "-c", program], cwd=folder, env={**os.environ, "PYTHONPATH": str(ROOT)}, check=True)


def names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_leftovers_of_killed_processes_go_and_all_else_stays(tmp_path: Path) -> None:
    killed(tmp_path, HALF_WRITTEN)
    file, folder = sorted(tmp_path.iterdir(), key=lambda path: path.is_dir())
    assert file.read_text() == "half"
    assert folder.is_dir()
    _, place, process, token = file.stem.split("-")
    others = {
        f".gearmesh-{int(place, 16) ^ 1:08x}-{process}-{token}.stl",  # of another machine
        f".gearmesh-{place}-{os.getppid()}-{token}.stl",  # of a process that may belong to somebody else
        f".gearmesh-{place}-{process}-{token[1:]}.stl",
        f"x.gearmesh-{place}-{process}-{token}.stl",
        ".gearmesh-notes",
        "gear.stl",
    }
    for name in others:
        (tmp_path / name).write_text("mine")
    # names alone decide, and a link is removed, not what it leads to
    (tmp_path / "precious").mkdir()
    (tmp_path / "precious" / "a").write_text("mine")
    (tmp_path / f".gearmesh-{place}-{process}-{'0' * 12}").symlink_to("precious")
    with busy(tmp_path, HALF_WRITTEN):
        live = (
            names(tmp_path) - others - {file.name, folder.name, "precious", f".gearmesh-{place}-{process}-{'0' * 12}"}
        )
        assert len(live) == 2
        write_elsewhere(tmp_path, "report.json")
        assert names(tmp_path) == others | live | {"precious", "report.json"}
        assert (tmp_path / "precious" / "a").read_text() == "mine"
    (tmp_path / "below").mkdir()
    write_elsewhere(tmp_path, "below/report.json")
    assert live < names(tmp_path), "only the folder that is written to is looked at"
    write_elsewhere(tmp_path, "report.json")
    assert names(tmp_path) == others | {"precious", "report.json", "below"}


@pytest.mark.quick
def test_a_folder_retired_by_a_killed_process_comes_back(tmp_path: Path) -> None:
    (tmp_path / "gear_pieces").mkdir()
    (tmp_path / "gear_pieces" / "old.vtp").write_text("old")
    killed(tmp_path, EXCHANGE)
    assert "gear_pieces" not in names(tmp_path)
    write_elsewhere(tmp_path, "report.json")
    assert names(tmp_path) == {"gear_pieces", "report.json"}
    assert (tmp_path / "gear_pieces" / "old.vtp").read_text() == "old"
