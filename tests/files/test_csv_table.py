"""Tables of text: what spreadsheets would run is neutralised, numbers stay numbers, and what is written is read."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.command_line import run
from oracles.examples import examples

from gearmesh.answers import tables
from gearmesh.errors import FileError
from gearmesh.files.csv_table import csv_rows, csv_text
from gearmesh.study import table

pytestmark = pytest.mark.quick

RUN = ("=1+1", "+A1", "-A1", "@SUM(A1)", "\t=1", " =1", "\uff1d1", "=cmd|' /C calc'!A0", "-1.5 mm", "-", "\r=1")


@pytest.mark.parametrize("text", RUN)
def test_no_text_is_run(text: str) -> None:
    """Cell as a spreadsheet reads it, by the parser of the standard library: it begins with an apostrophe."""
    for written in (
        csv_text(["a", text], [[text, 1.0]]),
        tables.csv_text([{"a": text, text: -2}]),
        table.csv_text({"a": [text], text: [None]}),
    ):
        head, row = csv.reader(io.StringIO(written, newline=""))
        assert head[1] == row[0] == f"'{text}"


def test_numbers_stay_numbers() -> None:
    assert csv_text(["x", "y"], [[-1.5, -3], [1e-300, None], [float("nan"), "-1.5"], ["+2e-7", True]]) == (
        "x,y\n-1.5,-3\n1e-300,\n,-1.5\n+2e-7,True\n"
    )


CELLS = st.text(st.sampled_from("'=+-@1.e \t\r\n\",;a\uff0b\0"), max_size=6) | st.sampled_from(RUN)


@examples(100)
@given(st.lists(st.lists(CELLS, min_size=2, max_size=2), min_size=1, max_size=4))
def test_what_is_written_is_read(rows: list[list[str]]) -> None:
    text = csv_text(["a", "b"], rows)
    assert [row for _, row in csv_rows(text, "t.csv")] == [["a", "b"], *rows]


@pytest.mark.parametrize(("mark", "name"), [(";", "semicolons"), ("\t", "tabs")])
def test_other_separators_are_refused_by_name(mark: str, name: str) -> None:
    rows = f"# of a spreadsheet\n\nx_mm{mark}y_mm\n1,5{mark}2,5\n"
    with pytest.raises(FileError) as refusal:
        list(csv_rows(rows, "points.csv"))
    says = f"points.csv: line 3: columns are separated by {name}: must be by commas, and numbers have a decimal point"
    assert str(refusal.value) == says
    # one column with such a mark in a later line is a table of commas
    assert [row for _, row in csv_rows(f"a\n1{mark}2\n", "t.csv")] == [["a"], [f"1{mark}2"]]


def test_commas_behind_the_last_column_name_none() -> None:
    """Measuring machines end every line with a separator, spreadsheets fill lines up to their longest."""
    rows = [row for _, row in csv_rows("# points,,,\na,b, ,\n1,2,,\n3,,,\n,4\n5,6,,7\n8\n", "t.csv")]
    assert rows == [["# points"], ["a", "b"], ["1", "2"], ["3", ""], ["", "4"], ["5", "6", "", "7"], ["8"]]
    assert [row for _, row in csv_rows(",,\n,1\n", "t.csv")] == [[""], ["", "1"]]


def test_reasons_of_a_study_are_texts(tmp_path: Path) -> None:
    """The one column in which a row says what a design said, which says what its file does."""
    columns: dict[str, list[Any]] = {"row": [0], "dx": [-0.25], "reason": ['=HYPERLINK("http://x")']}
    assert table.csv_text(columns) == 'row,dx,reason\n0,-0.25,"\'=HYPERLINK(""http://x"")"\n'


def test_contact_tables_are_numbers() -> None:
    from oracles.places import SAMPLES

    status, out, _ = run("tca", SAMPLES / "beveloid_crossed.toml", "--csv", "-")
    assert status == 0
    assert "'" not in out
    assert ",-" in out
