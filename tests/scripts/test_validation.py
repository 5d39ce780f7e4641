"""scripts/validation.py: the table of the site is the one that it computes, and a figure that moves shows."""

from __future__ import annotations

import re

import pytest
from oracles.places import ROOT
from oracles.scripts import script

validation = script("validation")
PAGE = (ROOT / "scripts" / "site" / "pages" / "validation.md").read_text(encoding="utf-8")
#: parts that take less than half a second
FAST = ("cr3553", "iso23509", "hertz", "calculix", "random_designs")


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip("| ").split(" | ")]


@pytest.mark.quick
def test_every_part_is_in_the_table_of_the_site() -> None:
    rows = [cells(line) for line in PAGE.splitlines() if line.startswith("| ")]
    parts = {match[1] for row in rows if (match := re.fullmatch(r"`(\w+)`", row[-1]))}
    assert parts == set(validation.PARTS) - {"calculix", "random_designs"}
    assert len(rows) >= 30


@pytest.mark.sweep_cases("lt85", "iso23509")
@pytest.mark.parametrize("part", [*FAST, "lt85"])
def test_lines_are_those_that_are_computed(part: str) -> None:
    """Texts and figures as printed; what is below rounding differs from processor to processor, and is not among these."""
    for line in validation.lines([part]):
        row = [line.claim, line.reference, line.stated, line.computed, line.difference, line.script]
        assert any(cells(known) == [cell.strip() for cell in row] for known in PAGE.splitlines()), row


@pytest.mark.quick
def test_the_furthest_figure_is_the_largest_by_amount() -> None:
    assert validation.furthest(["", "-3", "2.5"]) == -3.0
