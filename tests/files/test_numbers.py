"""Numbers in files and options: digits, sign, point and exponent; everything else is refused where it stands."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import refused
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, GearmeshError, OutputError, io
from gearmesh.app.options import positions_in_degrees, torques_in_nm
from gearmesh.design.topography_file import read_topography
from gearmesh.files.reading import json_value, toml_value
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.metrology.flanks.point_file import read_points
from gearmesh.metrology.pitch_file import read_pitch
from gearmesh.numerals import parse_number, parse_numbers, parse_whole_number
from gearmesh.study.plan import KeyReader
from gearmesh.study.statistics import limit_of

pytestmark = pytest.mark.quick

#: texts that float() of Python reads and no gear drawing has
FOREIGN = ("1_0", "nan", "inf", "-Infinity", "\u0661\u0662", "\uff11", "1e999")
HELICAL = SAMPLES / "helical.toml"


@pytest.mark.parametrize("text", ["1", "-1.5", "+.5", "2.", "1e3", " 1.25E-3\t", "007"])
def test_numbers_are_what_python_reads(text: str) -> None:
    assert parse_number(text) == parse_numbers([text])[0] == float(text)


@pytest.mark.parametrize("text", [*FOREIGN[:-1], "", "-", "1e", "1 2", "0x10", "1,5", "\u22125", "1.5D3", "--1"])
def test_what_a_file_does_not_write_is_no_number(text: str) -> None:
    assert parse_number(text) is None
    assert parse_whole_number(text) is None
    with pytest.raises(ValueError, match=r"not a number|convert"):
        parse_numbers(["1", text])


def pitch(folder: Path, cell: str) -> object:
    path = folder / "p.csv"
    path.write_text(f"tooth,right_um\n0,{cell}\n1,2\n", encoding="utf-8")
    return read_pitch(path, 2)


def pitch_tooth(folder: Path, cell: str) -> object:
    path = folder / "p.csv"
    path.write_text(f"tooth,right_um\n{cell},1\n1,2\n", encoding="utf-8")
    return read_pitch(path, 2)


def topography(folder: Path, cell: str) -> object:
    path = folder / "t.csv"
    path.write_text(f"roll_length_mm,z_mm,amount_um\n{cell},0,1\n", encoding="utf-8")
    return read_topography(path)


def points(folder: Path, cell: str) -> object:
    path = folder / "d.csv"
    path.write_text(f"flank,x_mm,y_mm,z_mm\nright,{cell},0,1\n", encoding="utf-8")
    return read_points(path)


def deviations(folder: Path, cell: str) -> object:
    path = folder / "d.txt"
    path.write_text(f"s t deviation_um\n0.1 {cell} 1\n", encoding="utf-8")
    return read_points(path)


@pytest.mark.parametrize("cell", FOREIGN)
@pytest.mark.parametrize(
    ("read", "place"),
    [
        (pitch, "p.csv: line 2: right_um = "),
        (pitch_tooth, "p.csv: line 2: tooth = "),
        (topography, "t.csv: line 2: roll_length_mm = "),
        (points, "d.csv: line 2: x_mm = "),
        (deviations, "d.txt: line 2: t = "),
    ],
)
def test_cells_that_are_no_numbers_are_refused_by_file_line_and_column(
    read: Callable[[Path, str], object], place: str, cell: str, tmp_path: Path
) -> None:
    with pytest.raises(DesignError, match=f"{place}{re.escape(json.dumps(cell))}: must be a finite number$"):
        read(tmp_path, cell)


def test_a_decimal_comma_is_answered_with_the_number_to_write(tmp_path: Path) -> None:
    with pytest.raises(DesignError, match=r'line 2: right_um = "2,5": must be a finite number: write 2.5$'):
        pitch(tmp_path, '"2,5"')


def test_missing_deviations_stay_missing(tmp_path: Path) -> None:
    path = tmp_path / "d.csv"
    path.write_text("s,t,deviation_um\n0.1,0.2,\n0.3,0.4,nan\n0.5,0.6,1.5\n", encoding="utf-8")
    assert np.isnan(read_points(path).columns["deviation_um"]).tolist() == [True, True, False]


@pytest.mark.parametrize("text", FOREIGN)
def test_options_and_plans_take_numbers_as_files_do(text: str) -> None:
    reader = KeyReader(gm.load(HELICAL, complete=False))
    asked: list[Callable[[], object]] = [
        lambda: torques_in_nm(text),
        lambda: positions_in_degrees(text),
        lambda: positions_in_degrees(f"0:{text}:3"),
        lambda: positions_in_degrees(f"0:1:{text}"),
        lambda: reader.number("assembly.dx", text),
        lambda: reader.values("assembly.dx", f"0:1:{text}"),
        lambda: limit_of(f"contact_ratio>{text}", None),
        lambda: gm.parse({"kind": "cylindrical", "module": text}),
    ]
    for ask in asked:
        with pytest.raises(DesignError):
            ask()
    assert "--torque" in refused("describe", HELICAL, "--torque", text)
    assert "--sector" in refused("solid", HELICAL, "--member", "gear", "-o", "x.stl", "--sector", text)


def test_numbers_in_meshes_are_digits(tmp_path: Path) -> None:
    normals = np.full((1, 3), 3**-0.5)
    mesh = TriangleMesh(np.eye(3) * 10.0, np.array([[0, 1, 2]]), np.array([0]), ("surface",), normals, "t")
    for suffix, old, new in ((".obj", "v 10.0", "v 1_0.0"), (".obj", "f 1 2", "f 1 \uff12")):
        path = tmp_path / f"m{suffix}"
        io.write(mesh, path)
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new), encoding="utf-8")
        with pytest.raises(OutputError, match=r"is not a (whole )?number"):
            io.read(path)


def test_keys_given_twice_are_refused_in_json_as_in_toml(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"kind": "cylindrical", "pinion": {"teeth": 18, "face_width": 10, "teeth": 20}}', encoding="utf-8")
    assert refused("describe", path) == f'{path}: key "teeth" is given twice in one object: 18 and 20'
    rexs = tmp_path / "a.rexsj"
    rexs.write_text('{"model": {"version": "1.6", "version": "1.7"}}', encoding="utf-8")
    with pytest.raises(GearmeshError, match='key "version" is given twice'):
        gm.load_rexs(rexs)


@pytest.mark.parametrize("word", ["NaN", "Infinity", "-Infinity"])
def test_words_are_no_numbers_of_json(word: str) -> None:
    tables = '"pinion": {"teeth": 18, "face_width": 10}, "gear": {"teeth": 24, "face_width": 10}'
    keys = json_value(f'{{"kind": "cylindrical", "module": {word}, {tables}}}', "a.json")
    with pytest.raises(DesignError, match=f'module = "{word}": must be a length'):
        gm.parse(keys)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a = 1\nmodule = 2,5", "f: line 2: module = 2,5: write module = 2.5"),
        ("module = 1,234", "f: line 1: module = 1,234: write module = 1.234 or 1234"),
        ("x = [1 2]", "f: line 1, column 8: a comma or ] is missing before 2]"),
        ("x = [\n 1.5\n 2,\n 3]", "f: line 3, column 2: a comma or ] is missing before 2,"),
        ("x = {a = 1 b = 2}", "f: line 1, column 12: a comma or } is missing before b = 2}"),
        ("face = 5mm", 'f: line 1: face = 5mm: write face = "5mm"'),
        ("kind = cylindrical  # c", 'f: line 1: kind = cylindrical  # c: write kind = "cylindrical"'),
        ("kind: 5", "f: line 1: kind: 5: write kind = 5"),
        ("x = .5", "f: line 1: x = .5: write x = 0.5"),
        ("x = True", "f: line 1: x = True: write x = true"),
        ('x = "a", y = 2', 'f: line 1: x = "a", y = 2: write each key in a line of its own'),
    ],
)
def test_mistakes_in_toml_are_answered_with_the_line_and_what_to_write(text: str, message: str) -> None:
    with pytest.raises(DesignError, match=f"^{re.escape(message)}$"):
        toml_value(text, "f")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("load", "--torque", "150Nm"), "--torque = 150Nm: must be finite .*: write bare numbers, in Nm"),
        (
            ("describe", "--torque", "1.5kNm"),
            "--torque = 1.5kNm: must be a bare number in Nm, without letters behind it",
        ),
        (("load", "--torque", "5", "--phi1", "0,4.4"), "--phi1 = 0,4.4: must be .*: write 0:4.4:2"),
        (("load", "--torque", "5", "--phi1", "4deg"), "--phi1 = 4deg: must be .*: write a bare number, in deg"),
        (("describe", "--set", "module=2,5"), 'module = "2,5": must be a length .*: write 2.5'),
    ],
)
def test_options_say_what_to_write(arguments: tuple[str, ...], message: str) -> None:
    assert re.fullmatch(message, refused(arguments[0], HELICAL, *arguments[1:]))


def test_a_wrong_way_in_names_the_right_one() -> None:
    with pytest.raises(DesignError, match=r"^path = .*: must be a path: gm.parse makes a design of a mapping$"):
        gm.load({"kind": "cylindrical"})  # type: ignore[arg-type]
    with pytest.raises(
        DesignError, match=r"^mapping = a.toml: must be a mapping of texts to values: gm.load reads files$"
    ):
        gm.parse("a.toml")  # type: ignore[arg-type]


def test_unknown_figures_name_the_nearest() -> None:
    summary = gm.build(gm.load(HELICAL)).contact([0.0], cycle=False).summary
    with pytest.raises(KeyError) as failure:
        summary["te_p2p"]
    assert isinstance(failure.value, GearmeshError)
    assert (failure.value.key, failure.value.value) == ("key", "te_p2p")
    assert "did you mean te_peak_to_peak_arcsec?" in str(failure.value)
    assert summary.get("te_p2p") is None
    assert "te_p2p" not in summary
