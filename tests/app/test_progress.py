"""How far a piece of work is: parts within parts, and what long answers say on their way."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from oracles.places import ROOT

import gearmesh as gm
from gearmesh.progress import in_turn, listening, part, tell


@pytest.mark.quick
def test_parts_are_fractions_of_the_whole() -> None:
    told: list[float] = []
    with listening(told.append):
        with part(0.0, 0.4):
            tell(0.5)
        with part(0.4, 1.0):
            for _ in in_turn("ab"):
                tell(0.5)
    tell(0.1)
    assert told == pytest.approx([0.2, 0.4, 0.55, 0.7, 0.85, 1.0, 1.0])


@pytest.mark.parametrize(
    ("ask", "least"), [(lambda gears: gears.check(0.05), 8), (lambda gears: gears.finite_elements(), 5)]
)
def test_long_answers_say_how_far_they_are(ask: Callable[[gm.Gears], object], least: int) -> None:
    tables = {"pinion": {"teeth": 18, "face_width": 10}, "gear": {"teeth": 24, "face_width": 10}}
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **tables}))
    told: list[float] = []
    with listening(told.append):
        ask(gears)
    assert told == sorted(told)
    assert len(set(told)) > least


def test_search_for_the_contact_of_a_bevel_pair_says_how_far_it_is() -> None:
    told: list[float] = []
    with listening(told.append):
        # a pair of no other test: what was searched for before is known
        gm.build(gm.load(ROOT / "samples" / "spiral_bevel_basic.toml", ["spiral_angle=34.7"]))
    assert told == sorted(told)
    # of the first flank, of both
    assert 0.0 < told[0] < 0.5 < told[-2] < told[-1] == 1.0
