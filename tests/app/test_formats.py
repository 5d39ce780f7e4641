"""The table of file formats says what commands and answers do."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from oracles.places import PACKAGE, SAMPLES
from oracles.sources import nodes

import gearmesh as gm
from gearmesh import formats, io
from gearmesh.app import cli

SPUR, BEVEL = str(SAMPLES / "spur.toml"), str(SAMPLES / "spiral_bevel_basic.toml")
#: command, and arguments that lead to a file of a suffix that no format has; a command with several files has several rows
WRONG_SUFFIXES = (
    ("new", ["new", "cylindrical", "-o", "a.xyz"]),
    ("pin", ["pin", SPUR, "-o", "a.xyz"]),
    ("size", ["size", "--ratio", "2", "--center-distance", "64", "--module", "2", "-o", "a.xyz"]),
    ("settings", ["settings", BEVEL, "-o", "a.xyz"]),
    ("gear", ["gear", "--teeth", "20", "--module", "2", "--face", "9", "-o", "a.xyz"]),
    ("convert", ["convert", SPUR, "-o", "a.xyz"]),
    ("convert", ["convert", "a.rexs", "-o", "a.xyz"]),
    ("solid", ["solid", SPUR, "--member", "pinion", "-o", "a.xyz"]),
    ("drawing", ["drawing", SPUR, "--member", "pinion", "-o", "a.xyz"]),
    ("report", ["report", SPUR, "-o", "a.xyz"]),
    ("freecad", ["freecad", SPUR, "-o", "a.xyz"]),
    ("topography", ["topography", SPUR, "--member", "pinion", "--flank", "right", "-o", "a.xyz"]),
    ("toolpath", ["toolpath", SPUR, "--member", "pinion", "--tool", "ball:1mm", "--scallop", "10um", "-o", "a.xyz"]),
    ("grid", ["grid", SPUR, "--member", "pinion", "-o", "a.xyz"]),
    ("grid", ["grid", SPUR, "--member", "pinion", "--chart", "a.xyz"]),
    ("composite", ["composite", SPUR, "-o", "a.xyz"]),
    ("evaluate", ["evaluate", SPUR, "--member", "pinion", "-o", "a.xyz"]),
    ("correct", ["correct", BEVEL, "--member", "pinion", "--measured", "m.csv", "-o", "a.xyz"]),
    ("correct", ["correct", BEVEL, "--member", "pinion", "--measured", "m.csv", "--residual", "a.xyz"]),
    ("fe", ["fe", SPUR, "-o", "a.xyz"]),
    ("fe", ["fe", SPUR, "--solve", "--picture", "a.xyz"]),
    ("render", ["render", SPUR, "--view", "te", "-o", "a.xyz"]),
    ("render", ["render", SPUR, "--animate", "a.xyz"]),
)
#: contents that no suffix of an own option leads to: texts of --json, --csv and --names, and what `run` puts into its folder
NOT_BY_SUFFIX = {"tca", "load", "study", "run", "check", "describe", "limits", "vh", "prove", "all", "optimize"}


def refused(arguments: Sequence[str], capsys: pytest.CaptureFixture[str]) -> set[str]:
    """Return the suffixes that a command says it takes."""
    assert cli.main(arguments) == 2, arguments
    said = capsys.readouterr().err
    assert "xyz" in said, said
    return set(re.findall(r"(?<![\w/])\.[A-Za-z0-9]+\b", said.replace("a.xyz", "").replace(".xyz", "")))


@pytest.mark.quick
def test_commands_write_the_suffixes_of_the_table(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.rexs").touch()
    written: dict[str, set[str]] = {}
    for command, arguments in WRONG_SUFFIXES:
        written.setdefault(command, set()).update(refused(arguments, capsys))
    for command, suffixes in written.items():
        listed = {suffix for entry in formats.FILE_FORMATS if command in entry.writers for suffix in entry.suffixes}
        assert suffixes - {formats.JSON_SUFFIX} <= listed, command
        # texts of --json, --csv and --names are not known by a suffix alone
        assert listed - suffixes <= {formats.JSON_SUFFIX, formats.CSV_SUFFIX}, command
    assert {writer for entry in formats.FILE_FORMATS for writer in entry.writers} - NOT_BY_SUFFIX == set(written)


@pytest.mark.quick
def test_commands_of_the_table_are_there() -> None:
    named = {command for entry in formats.FILE_FORMATS for command in (*entry.writers, *entry.readers)}
    assert named - {"all"} <= set(cli.COMMAND_FOLDERS)


@pytest.mark.quick
def test_suffixes_of_answers_and_meshes_are_in_the_table() -> None:
    known = {suffix for entry in formats.FILE_FORMATS for suffix in entry.suffixes}
    assert set(io.formats()) <= known
    names = {name for name in vars(formats) if name.endswith(("_SUFFIX", "_SUFFIXES"))}
    for name in gm.__all__:
        suffixes = getattr(getattr(gm, name), "suffixes", None)
        if isinstance(suffixes, property):
            source = inspect.getsource(suffixes.fget)  # type: ignore[arg-type]
            assert not re.search(r"\"\.\w+\"", source), name
            assert re.findall(r"\b[A-Z_]+_SUFFIX(?:ES)?\b", source), name
            assert set(re.findall(r"\b[A-Z_]+_SUFFIX(?:ES)?\b", source)) <= names


@pytest.mark.quick
def test_a_suffix_stands_in_one_place() -> None:
    known = {suffix for entry in formats.FILE_FORMATS for suffix in entry.suffixes}
    found = set()
    for path in PACKAGE.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        # a tree takes ten times as long as a look
        if not any(f'"{suffix}"' in text for suffix in known):
            continue
        tree = nodes(text)
        # ends of names of files: f"{member}.png"
        ends = {id(part) for node in tree if isinstance(node, ast.JoinedStr) for part in node.values}
        if any(isinstance(node, ast.Constant) and node.value in known and id(node) not in ends for node in tree):
            found.add(path.relative_to(PACKAGE).as_posix())
    # samples are listed before anything is imported; a REXS file may have two suffixes
    assert found <= {"formats.py", "samples.py", "exchange/rexs_file.py"}


@pytest.mark.quick
def test_the_command_prints_the_table(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["formats", "VTU"]) == 0
    said = capsys.readouterr().out
    assert said.count(".vtu") == 3
    assert cli.main(["formats", "doc"]) == 2
    assert capsys.readouterr().err.startswith("gearmesh: error: suffix = doc: must be one of .toml, .json, ")
