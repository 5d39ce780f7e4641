"""Whatever somebody hands in as a file: read, or refused in one line, at once and without eating the memory."""

from __future__ import annotations

import json
import os
import socket
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

from gearmesh import DesignError, GearmeshError, OutputError, load
from gearmesh.design import files
from gearmesh.design.topography_file import read_topography
from gearmesh.files.reading import BYTES_PER_MIB, file_text
from gearmesh.io import read as read_mesh
from gearmesh.study.plan import KeyReader
from gearmesh.study.spreads import read_spreads
from gearmesh.study.store import StudyStore

pytestmark = pytest.mark.quick

HEAD = "roll_length_mm,z_mm,amount_um\n"
PLAN = {"rows": 5, "chunk": 4, "record": ["a", "b"]}
CHUNK: list[list[object]] = [[1.5, None, ""], [2, None, ""], [3.0, "x", ""], [None, None, "no contact"]]


def topography(path: Path) -> object:
    return read_topography(path)


def design(path: Path) -> object:
    return files.read(path)


def tolerances(path: Path) -> object:
    return read_spreads(str(path), lambda key, value: float(value))


def plan(path: Path) -> object:
    folder = path.parent / "study"
    folder.mkdir()
    os.rename(path, folder / "plan.json")
    with StudyStore(folder, PLAN).open() as store:
        return store.chunks


READERS = (topography, design, tolerances, plan)


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("what", ["fifo", "socket", "zero", "folder", "loop", "large", "not_text"])
def test_what_is_no_file_to_be_read_is_refused(read: Callable[[Path], object], what: str, tmp_path: Path) -> None:
    """None of these may be opened and waited for, nor read to its end."""
    path = tmp_path / "it.toml"
    if what == "fifo":
        os.mkfifo(path)
    elif what == "socket":
        socket.socket(socket.AF_UNIX).bind(os.path.relpath(path))
    elif what == "zero":
        path.symlink_to("/dev/zero")
    elif what == "folder":
        path.mkdir()
    elif what == "loop":
        path.symlink_to(path)
    elif what == "large":
        path.touch()
        os.truncate(path, 1 << 40)
    else:
        path.write_bytes(b"# \xff\xfe")
    words = {
        "folder": "is a folder",
        "loop": "cannot be read",
        "large": " MiB, the limit for a",
        "not_text": "not UTF-8 text",
    }
    with pytest.raises(GearmeshError, match=words.get(what, "not a regular file")) as failure:
        read(path)
    assert "\n" not in str(failure.value)


def test_a_file_is_read_up_to_its_limit(tmp_path: Path) -> None:
    path = tmp_path / "it"
    path.write_bytes(b"\xef\xbb\xbf" + b"x" * 17)
    assert file_text(path, 20) == "x" * 17
    with pytest.raises(DesignError, match="is larger than 19 bytes, the limit for a file"):
        file_text(path, 19)
    with pytest.raises(OutputError, match="cannot be read"):
        file_text("a\0b", BYTES_PER_MIB, error=OutputError)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"1,2,{'9' * 200_000}\n", "line 2: field larger than field limit"),
        (f"1,2,{'9' * 4000}\n", 'line 2: amount_um = "9+...": must be a finite number'),
        ("\n\n1,2,3\n\n1,2,1e300\n", 'line 6: "1,2,1e300": a line needs .* amounts up to 5000 um'),
        ("-1,2,3\n", "line 2: "),
        ("1,nan,3\n", "line 2: "),
        ("1,2,3\n1,2,3\n", "line 3: "),
        ("1,2,3\0\n", "line 2: "),
    ],
)
def test_what_is_no_topography_is_one_short_line(text: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "t.csv"
    path.write_text(HEAD + text, encoding="utf-8")
    with pytest.raises(DesignError, match=message) as failure:
        read_topography(path)
    assert len(str(failure.value)) < 300


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.toml", ".".join(["a"] * 100_000) + " = 1"),  # the parser takes a minute for each 50,000 of them
        ("a.toml", " . ".join(["'a'"] * 100_000) + " = 1"),
        ("a.toml", "a = " + "[" * 200_000),
        ("a.json", "[" * 200_000),
        ("a.json", '{"a":' * 200_000),
    ],
)
def test_what_is_nested_deeply_is_refused_at_once(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(DesignError, match=r"a\.\w+: nested too deeply"):
        files.read(tmp_path / name)


def line(done: object) -> bytes:
    """A line of rows as the store writes it, whatever is in it."""
    text = done if isinstance(done, str) else json.dumps(done, separators=(",", ":"))
    return f'{{"done":{text},"crc":{zlib.crc32(text.encode())}}}\n'.encode()


@pytest.fixture
def kept(tmp_path: Path) -> Path:
    """A study of which the first chunk is done."""
    with StudyStore(tmp_path, PLAN).open() as store:
        store.add(0, CHUNK)
    return tmp_path


def chunks(folder: Path) -> dict[int, list[list[object]]]:
    with StudyStore(folder, PLAN).open() as store:
        return store.chunks


@pytest.mark.parametrize(
    "torn", [b'{"done":[1,[[1', b"[" * 200_000, b"[" * 200_000 + b"\n", b"\0\xff\n", line([1, "x"])[:-1]]
)
def test_what_is_torn_at_the_end_is_cut_off(torn: bytes, kept: Path) -> None:
    rows = kept / "rows.jsonl"
    whole = rows.read_bytes()
    rows.write_bytes(whole + torn)
    assert chunks(kept) == {0: CHUNK}
    assert rows.read_bytes() == whole


FORGED = (
    [7, CHUNK],  # there is no such chunk
    [-1, CHUNK],
    [True, CHUNK],
    [1, CHUNK],  # the last one has one row
    [1, [[1.0, ""]]],
    [1, [[1.0, 2.0, 3.0]]],
    [1, [[10**400, 2.0, ""]]],
    [1, [[{}, 2.0, ""]]],
    [1, {"a": 1}],
    [1, None],
    "[1,[[NaN,2.0,\"\"]]]",
)  # fmt: skip


@pytest.mark.parametrize("done", FORGED, ids=str)
def test_rows_that_the_plan_has_not_are_refused_and_kept(done: object, kept: Path) -> None:
    """Their checksum is right: they are of another study, or somebody wrote them."""
    rows = kept / "rows.jsonl"
    rows.write_bytes(rows.read_bytes() + line(done) + line([1, [[1.0, 2.0, ""]]]))
    before = rows.read_bytes()
    with pytest.raises(OutputError, match="line 2: not a finished chunk of this study"):
        chunks(kept)
    assert rows.read_bytes() == before


def test_rows_without_their_plan_are_not_touched(kept: Path) -> None:
    (kept / "plan.json").unlink()
    with pytest.raises(OutputError, match=r"holds rows\.jsonl without its plan\.json"):
        chunks(kept)
    (kept / "rows.jsonl").unlink()
    os.mkfifo(kept / "rows.jsonl")
    with pytest.raises(OutputError, match="is not a regular file"):
        chunks(kept)


def test_a_design_whose_topography_is_a_fifo_is_one_line(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "amounts.csv")
    own = tmp_path / "design.toml"
    sample = (SAMPLES / "spur.toml").read_text(encoding="utf-8")
    own.write_text(sample.replace("[pinion]", '[pinion]\nmodifications = { topography = "amounts.csv" }'))
    assert refused("tca", own) == f"{tmp_path / 'amounts.csv'}: is not a regular file; it must be a topography"


def test_a_folder_with_anything_as_a_study_is_one_line(tmp_path: Path) -> None:
    from gearmesh.reports.report import study_section

    file = tmp_path / "study.json"
    for text in ('{"headline": 3}', "[" * 200_000, '{"headline":"","nominal":[],"percentiles":{"a":3}}', "[]"):
        file.write_text(text)
        with pytest.raises(OutputError, match=rf"study = {tmp_path}: holds no finished study \(study\.json\)"):
            study_section(tmp_path)
    file.unlink()
    os.mkfifo(file)
    with pytest.raises(OutputError, match="is not a regular file"):
        study_section(tmp_path)


@pytest.mark.parametrize(
    "key", ["module", "pinion.face_width", "pinion.bore", "backlash", "assembly.dx", "diametral_pitch"]
)
@pytest.mark.parametrize("value", ["1e-300", "1e-40", "1e300"])
def test_numbers_that_nothing_can_be_made_of_are_named(key: str, value: str) -> None:
    assert refused("describe", SAMPLES / "helical.toml", "--set", f"{key}={value}").startswith(
        (f"{key} = ", f"{key}: ")
    )


def test_small_numbers_that_sweeps_leave_are_numbers() -> None:
    assert run("describe", SAMPLES / "helical.toml", "--set", "assembly.dx=1e-17", "--set", "backlash=0.0")[0] == 0
    assert refused("describe", SAMPLES / "helical.toml", "--set", "pinion.bore=1e-10").endswith(
        "must be a length in mm from 0 to 1000000; 0 or at least 1e-09 in size"
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f'assembly.dx = {{ distribution = "normal", sigma = {"9" * 400} }}', "assembly.dx = 9"),
        (f'assembly.{"x" * 9999} = {{ distribution = "normal", sigma = 1 }}', "vary "),
        (f'{"x" * 9999} = 3', 'tolerance "xxx'),
        (f'assembly.dx = {{ distribution = "normal", {"x" * 9999} = 3 }}', "tolerance assembly.dx: sigma: missing"),
        (f'assembly.dx = {{ distribution = "normal", sigma = 1, {"x" * 9999} = 3 }}', 'tolerance assembly.dx: "xxx'),
        ('assembly.dx = { distribution = [1] }', "tolerance assembly.dx: distribution = [1]: must be one of"),
        (f'assembly.dx = "{"x" * 9999}"', 'tolerance assembly.dx = '),
        ('assembly.dx = "normal:0"', 'tolerance assembly.dx = normal:0: must be one of normal:mean:sigma'),
    ],
)  # fmt: skip
def test_files_of_tolerances_are_refused_in_short_lines(text: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "t.toml"
    path.write_text(text)
    read = KeyReader(load(SAMPLES / "beveloid_crossed.toml"))
    with pytest.raises(DesignError) as failure:
        read_spreads(str(path), read.number)
    assert str(failure.value).startswith(said)
    assert len(str(failure.value)) < 300


def test_a_mesh_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "gear.stl")
    with pytest.raises(OutputError, match="is not a regular file"):
        read_mesh(tmp_path / "gear.stl")
