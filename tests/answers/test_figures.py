"""Figures: every one is declared with unit and meaning, and keys, rows and columns follow from that."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import pytest

import gearmesh
from gearmesh.figures import MEMBER, UNITS, Entry, Figures, Summary, figure

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
    assert MADE.entries[1].figure.in_um().numbered(2).key == "wave_2_um"


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
        told = kind.declared()
        assert len({each.key for each in told}) == len(told), kind
        assert kind.__doc__, kind
        for each in told:
            assert len(each.meaning) > 3, (kind, each)
            assert not each.meaning.endswith("."), each
            assert each.key.endswith(UNITS[each.unit]) or MEMBER in each.key, each
