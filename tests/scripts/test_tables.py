"""scripts/tables.py: Markdown tables, and the blocks of a file that they replace."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from oracles.places import ROOT
from oracles.scripts import script

TEXT = "before\n<!-- bench:a -->\nold\n<!-- /bench -->\nbetween\n<!-- bench:b -->\n<!-- /bench -->\nafter\n"


tables = script("tables")


def test_a_table_has_the_columns_asked_for_and_numbers_at_the_right() -> None:
    rows = [{"what": "a|b", "count": 1054560, "seconds": 0.01234}, {"what": "c", "seconds": 1234.6, "more": 1}]
    assert tables.table(rows, {"what": "step", "seconds": "time, s", "count": "triangles"}) == (
        "| step | time, s | triangles |\n| --- | ---: | ---: |\n| a\\|b | 0.0123 | 1,054,560 |\n| c | 1,230 |  |"
    )
    with pytest.raises(ValueError, match="needs rows"):
        tables.table([], {"what": "step"})


@pytest.mark.parametrize(
    ("value", "shown"), [(3.3e-14, "3.3e-14"), (0.0, "0"), (-12.0, "-12"), (7, "7"), (999.9, "1e+03")]
)
def test_numbers_are_shown_to_three_digits(value: float, shown: str) -> None:
    assert tables.cell(value) == shown


def test_only_the_block_of_that_name_is_replaced() -> None:
    assert tables.replaced(TEXT, "b", r"\1 new") == TEXT.replace("bench:b -->\n", "bench:b -->\n\\1 new\n")
    once = tables.replaced(TEXT, "a", "new\n")
    assert once == TEXT.replace("old", "new")
    assert tables.replaced(once, "a", "new") == once


@pytest.mark.parametrize(
    ("text", "count"), [(TEXT + TEXT, 2), ("<!-- bench:b -->\n<!-- /bench -->\n", 0), ("<!-- bench:a -->\n", 0)]
)
def test_a_block_must_be_there_once_and_be_closed(text: str, count: int) -> None:
    with pytest.raises(ValueError, match=f"one block <!-- bench:a --> .* not {count}"):
        tables.replaced(text, "a", "new")


def test_a_block_that_is_not_closed_does_not_swallow_the_next() -> None:
    with pytest.raises(ValueError, match="one block"):
        tables.replaced("<!-- bench:a -->\n<!-- bench:b -->\n<!-- /bench -->\n", "a", "new")


def test_a_file_is_rewritten_whole_or_not_at_all(tmp_path: Path) -> None:
    path = tmp_path / "README.md"
    path.write_text(TEXT, encoding="utf-8")
    with pytest.raises(ValueError, match="bench:c"):
        tables.rewrite(path, {"a": "new", "c": "new"})
    assert path.read_text(encoding="utf-8") == TEXT
    tables.rewrite(path, {"a": "5 µm", "b": "6"})
    assert path.read_text(encoding="utf-8").count("µm\n") == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_kept_table_is_shown_where_a_line_links_to_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tables, "MEASURED", tmp_path / "measured")
    rows = [{"what": "a, b|c", "count": 1054560, "off": "+3.1"}, {"what": "d", "count": 7, "seconds": 1234.6}]
    columns = {"what": "step", "count": "triangles", "seconds": "time, s", "off": "time, s"}
    tables.keep("times", rows, columns)
    assert tables.kept("times") == [
        {"step": "a, b|c", "triangles": "1054560", "time, s": "", "time, s 2": "+3.1"},
        {"step": "d", "triangles": "7", "time, s": "1.23e+03", "time, s 2": ""},
    ]
    page = "before\n[Times](../../scripts/measured/times.csv)\nSee [times](measured/times.csv).\n"
    assert tables.shown(page) == f"before\n{tables.table(rows, columns)}\nSee [times](measured/times.csv).\n"
    with pytest.raises(ValueError, match="no table nothing"):
        tables.shown("[Nothing](measured/nothing.csv)")


def test_kept_tables_are_written_by_scripts_and_shown_on_pages() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "scripts").glob("*.py"))
    pages = [*(ROOT / "scripts").glob("*.md"), *(ROOT / "gearmesh").rglob("*.md")]
    shown = [name for path in pages for _, name in tables.SHOWN.findall(path.read_text(encoding="utf-8"))]
    kept = [path.stem for path in tables.MEASURED.iterdir()]
    assert sorted(shown) == sorted(kept)
    assert [name for name in kept if f'"{name}"' not in source] == []


def test_every_block_of_figures_is_written_by_a_script() -> None:
    source = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "scripts").glob("*.py"))
    pages = [ROOT / "README.md", *(ROOT / "scripts").rglob("*.md"), *(ROOT / "gearmesh").rglob("*.md")]
    found = [
        name
        for path in pages
        for name in re.findall(r"^<!-- bench:(.+) -->$", path.read_text(encoding="utf-8"), re.MULTILINE)
    ]
    assert len(found) == len(set(found)) > 0
    assert [name for name in found if f'"{name}"' not in source] == []
