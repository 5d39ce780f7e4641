"""scripts/load_checks.py: loaded contact against CalculiX, its smallest case."""

from __future__ import annotations

import csv
import importlib
import shutil
import sys
from dataclasses import replace
from types import ModuleType

import pytest
from oracles.places import ROOT


@pytest.fixture
def checks(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "load_checks", raising=False)
    return importlib.import_module("load_checks")


@pytest.mark.sweep
@pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")
def test_a_spur_pair_under_load_is_that_of_calculix(checks: ModuleType) -> None:
    """Two pairs in contact, three teeth of each held alike, of as many elements: rotation 3 %, shares 3 points, root stress 5 %."""
    case = checks.SMALLEST
    pair = checks.pair_of(case)
    at = checks.places(case, pair)[1]
    (found,) = checks.by_loaded(case, pair, [at], checks.bodies_of(case, pair, replace(case.deck, flank=10)))
    wanted = checks.by_elements(case, pair, at)
    assert set(found.forces) == {n for n, force in wanted.forces.items() if force > 0.0} == {"0", "1"}
    assert found.rotation == pytest.approx(wanted.rotation - found.springs, rel=0.03)
    assert found.share["0"] == pytest.approx(wanted.share["0"], abs=3.0)
    assert [found.root(0), found.root(1)] == pytest.approx([wanted.root(0), wanted.root(1)], rel=0.05)


def test_the_table_has_its_columns(checks: ModuleType) -> None:
    titles = (ROOT / "scripts" / "measured" / "truth.csv").read_text(encoding="utf-8").splitlines()[0]
    assert next(csv.reader([titles])) == [*checks.COLUMNS.values()]
