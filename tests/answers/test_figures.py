"""Figures: every one is declared with unit and meaning, and keys, rows and columns follow from that."""

from __future__ import annotations

import ast
import importlib
import math
import pkgutil
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import pytest
from oracles.places import PACKAGE

import gearmesh
from gearmesh import DesignSheet, Summary, parse
from gearmesh.answers.result import times_apart
from gearmesh.answers.tables import Listing, align, figures
from gearmesh.figures import KEY_ENDINGS, MEMBER_PLACE, Entry, Figures, figure
from gearmesh.kinds import SheetTable

pytestmark = pytest.mark.quick


@dataclass(frozen=True)
class Spot(Figures):
    """An example."""

    size: float = figure("size", "mm", "s")
    place: list[float] = figure("place", "mm", vector=True)


@dataclass(frozen=True)
class Example(Figures):
    """Another one, with all that there is."""

    ratio: float = figure("ratio", symbol="u")
    waves: list[float] = figure("amplitudes", "arcsec", singular="wave")
    stress: Mapping[str, float] = figure("stress", "MPa", key="{member}_stress_mpa")
    spot: Spot = figure("spot")
    spots: Mapping[str, Spot] = figure("spots by member", key="{member}")
    rest: float | None = figure("what some have", "%", optional=True)
    hidden: float = figure("no column", shown=False)


MADE = Example(
    2.0, [3.0, 4.0], {"pinion": 5.0}, Spot(6.0, [7.0, 8.0, 9.0]), {"gear": Spot(1.0, [1.0, 2.0, 3.0])}, None, 0.0
)


def test_keys_follow_from_names_and_units() -> None:
    spot = {"size_mm": 6.0, "place_mm": [7.0, 8.0, 9.0]}
    own = {"size_mm": 1.0, "place_mm": [1.0, 2.0, 3.0]}
    assert MADE.row == {
        "ratio": 2.0,
        "waves_arcsec": [3.0, 4.0],
        "pinion_stress_mpa": 5.0,
        "spot": spot,
        "gear": own,
        "hidden": 0.0,
    }
    assert list(MADE.flat) == [
        "ratio",
        "waves_arcsec",
        "pinion_stress_mpa",
        *(f"spot_{key}" for key in ("size_mm", "place_x_mm", "place_y_mm", "place_z_mm")),
        *(f"gear_{key}" for key in ("size_mm", "place_x_mm", "place_y_mm", "place_z_mm")),
    ]


def test_summaries_keep_units_and_number_lists() -> None:
    whole = Summary(MADE, [Entry(MADE.entries[0].figure, 7.0)])
    assert whole["ratio"] == 7.0
    assert {"wave_1_arcsec": 3.0, "wave_2_arcsec": 4.0}.items() <= whole.flat.row.items()
    assert {each.key: each.figure.unit for each in whole.entries}["pinion_stress_mpa"] == "MPa"
    assert MADE.entries[1].figure.in_um().item(2).key == "wave_2_um"


def test_a_unit_that_nobody_knows_is_refused() -> None:
    with pytest.raises(ValueError, match="unit furlong: must be one of"):
        figure("length", "furlong")


def kinds() -> Iterator[type[Figures]]:
    """All kinds of figures that the program declares."""
    for module in pkgutil.walk_packages(gearmesh.__path__, "gearmesh."):
        if "__main__" not in module.name:
            importlib.import_module(module.name)
    waiting = [Figures]
    while waiting:
        found = waiting.pop().__subclasses__()
        waiting += found
        yield from (each for each in found if each.__module__.startswith("gearmesh."))


def test_every_figure_says_what_it_is() -> None:
    """A meaning of its own within its kind, a unit at the end of the key, and one meaning to a key and unit in all the program."""
    known = list(kinds())
    assert len(known) > 10
    for kind in known:
        told = kind.declared_figures()
        assert len({each.key for each in told}) == len(told), kind
        assert kind.__doc__, kind
        for each in told:
            assert len(each.meaning) > 3, (kind, each)
            assert not each.meaning.endswith("."), each
            assert each.key.endswith(KEY_ENDINGS[each.unit]) or MEMBER_PLACE in each.key, each


#: methods of strings that take something off an end, or look whether it is there
PARSING = {"endswith", "startswith", "removesuffix", "removeprefix", "partition", "rpartition", "split", "rsplit"}
#: how units and run times stand in keys
ENDS = {*KEY_ENDINGS.values(), *(end.removeprefix("_") for end in KEY_ENDINGS.values()), "seconds"} - {""}
#: one of them as a whole text, or as a part of one with braces
WRITTEN = re.compile(rf"""["'}}](?:{"|".join(map(re.escape, sorted(ENDS)))})["'{{]""")


def parsed(source: str) -> list[int]:
    """Lines that read a unit, or that it is a run time, out of the name of a figure."""
    lines: list[int] = []
    # a tree takes a hundred times as long as a look
    if not WRITTEN.search(source):
        return lines
    for node in ast.walk(ast.parse(source)):
        known = {n.value for n in ast.walk(node) if isinstance(n, ast.Constant) and isinstance(n.value, str)}
        called = isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr in PARSING
        compared = isinstance(node, ast.Compare) and not ast.unparse(node.left).endswith(".unit")
        written = isinstance(node, ast.Assign) and isinstance(node.value, ast.Tuple) and "seconds" in known
        if known & ENDS and (called or compared or written):
            lines.append(node.lineno)
    return lines


@pytest.mark.parametrize(
    "source",
    [
        'stem, unit = (key[:-3], "_mm") if key.endswith("_mm") else (key, "")',
        'RUN_TIMES = ("seconds", "solver_seconds")',
        'times = [key for key in row if key in ("seconds", "timing")]',
        'name = unit in ("arcsec", "mm", "um", "deg")',
        'unit = "um" if key.removesuffix("_um") != key else "arcsec"',
    ],
)
def test_parsing_a_key_is_seen(source: str) -> None:
    """Lines that once stood in tables, results, the report, plots of studies and the roll test."""
    assert {*parsed(source)} == {1}


def test_no_name_of_a_figure_is_parsed() -> None:
    files = [file for package in ("answers", "study", "api", "view") for file in (PACKAGE / package).rglob("*.py")]
    assert len(files) > 60
    assert {str(file): lines for file in files if (lines := parsed(file.read_text(encoding="utf-8")))} == {}


@dataclass(frozen=True)
class Timed(Figures):
    """An example with a run time and a vector that is not known."""

    size: float = figure("size", "mm")
    place: list[float] = figure("place", "mm", vector=True, nullable=True)
    spent: float = figure("run time", "s", timing=True)

    @property
    def known(self) -> bool:
        return not math.isnan(self.size)


def test_run_times_and_what_is_not_known_are_so_by_declaration() -> None:
    some, none = Timed(1.0, [math.nan] * 3, 5.0), Timed(math.nan, [0.0] * 3, 6.0)
    kept, times = times_apart({"first": some, "list": [some, none], "nothing": none, "rest": {"deep": Summary(some)}})
    own = {"size_mm": 1.0, "place_mm": None}
    assert kept == {"first": own, "list": [own, None], "nothing": None, "rest": {"deep": own}}
    assert times == {"first": {"spent": 5.0}, "rest": {"deep": {"spent": 5.0}}}
    table = figures("", some)
    assert [row[0] for row in table.rows] == ["size_mm", "place_x_mm", "place_y_mm", "place_z_mm", "spent"]
    assert [row[0] for row in table.timeless.rows] == ["size_mm", "place_x_mm", "place_y_mm", "place_z_mm"]
    columns = replace(table, columns=("key", "spent"), rows=[["a", 1.0]])
    assert (columns.timeless.columns, columns.timeless.rows) == (["key"], [["a"]])


PAIR = {
    "kind": "cylindrical",
    "module": 2,
    "pinion": {"teeth": 20, "face_width": 10},
    "gear": {"teeth": 41, "face_width": 10},
}


@dataclass(frozen=True)
class Noisy(Figures):
    """An example with what rounding leaves."""

    error: float = figure("error", "arcsec")
    harmonics: list[float] = figure("harmonics", "arcsec")
    gap: float = figure("gap", "mm")
    ratio: float = figure("ratio")
    residual: float = figure("residual", "mm", rounding=True)


def test_tables_print_values_below_resolution_as_0_and_json_keeps_them() -> None:
    noisy = Noisy(9.16e-11, [2.9e-11, 0.4], -8.3e-16, 1e-13, 2e-14)
    assert [row[1] for row in figures("", noisy).rows] == [0.0, "0, 0.4", 0.0, 0.0, 2e-14]
    assert noisy.row["error_arcsec"] == 9.16e-11
    (least,) = {declared.resolution for declared in Noisy.declared_figures() if declared.unit == "arcsec"}
    assert figures("", replace(noisy, error=1.01 * least)).rows[0][1] == 1.01 * least
    columns = ("", "unit", "pinion")
    rows = (("backlash", "", -3.2e-15), ("offset", "mm", 3e-10), ("module", "mm", 2.0))
    sheet = DesignSheet(parse(PAIR), (SheetTable("sheet", columns[2:], rows),), {})
    assert [row[2] for row in sheet.listings[0].rows] == [0.0, 0.0, 2.0]


def test_tables_show_edges_in_words() -> None:
    """Names of JSON stay; in a table there is no underscore, at which no line can be broken.

    The axes are out of parallel, so that one end of the face leads by far more than rounding.
    """
    sizes = {
        "pinion": {"teeth": 7, "face_width": 22},
        "gear": {"teeth": 9, "face_width": 20},
        "assembly": {"gamma_v": -0.1},
    }
    contact = gearmesh.build(parse({"kind": "cylindrical", "module": 2, **sizes})).contact(cycle=False)
    assert "gear_heel+gear_joint" in {position.edge for position in contact.positions()}
    listing = contact.listings[0]
    column = {str(row[list(listing.columns).index("contact")]) for row in listing.rows}
    assert "edge: gear heel, gear form point" in column
    assert not any("_" in text for text in column)


def test_columns_fold_between_words() -> None:
    """Columns that do not fit beside the others go on in a further block rather than break a word."""
    words = ["interferences", "circumferential", "uncharacteristically", "undercut", "semi-topping"]
    columns = [f"{word} column" for word in words]
    text = align(Listing("", columns, [[f"{word} of {word}" for word in reversed(words)]] * 2))
    assert max(map(len, text.splitlines())) <= 80
    assert set(text.split()) == {*words, "column", "of"}
