"""The page "Where good guesses are wrong": every row names a test that is there."""

from __future__ import annotations

import re

from oracles.places import ROOT

#: the page, and the tests that it names
PAGE = ROOT / "scripts" / "site" / "pages" / "theory" / "wrong_guesses.md"
NAMED = re.compile(r"`(tests/[\w/]+\.py)::(test_\w+)`")


def test_every_row_names_a_test_that_is_there() -> None:
    rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| ")]
    guesses = [row for row in rows if not row.startswith("| a good guess")]
    assert len(guesses) > 10
    for row in guesses:
        named = NAMED.findall(row)
        assert named, row
        for file, test in named:
            assert f"def {test}(" in (ROOT / file).read_text(encoding="utf-8"), f"{file}: {test}"
