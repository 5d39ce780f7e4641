"""scripts/bench.py: that it still measures what the package is now."""

from __future__ import annotations

import importlib
import sys

import pytest
from oracles.places import ROOT


def test_contact_by_one_batch_is_that_by_scipy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "bench", raising=False)
    bench = importlib.import_module("bench")
    rows = bench.contact(1)["rows"]
    assert [row["positions"] for row in rows] == [201, 10_000, 201, 201]
    assert all(row["solved"] == row["positions"] for row in rows)
    assert max(row["residual_mm"] for row in rows) < 1e-11


def test_every_block_of_the_tables_has_its_columns(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "bench", raising=False)
    bench = importlib.import_module("bench")
    text = (ROOT / "scripts" / "README.md").read_text(encoding="utf-8")
    for name, columns in bench.COLUMNS.items():
        block = text.split(f"<!-- bench:{name} -->\n")[1].split("<!-- /bench -->")[0]
        assert block.splitlines()[0] == f"| {' | '.join(columns.values())} |"
