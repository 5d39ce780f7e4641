"""Answers are the same under the kernels that other processors choose."""

from __future__ import annotations

import importlib
import os
import sys
from types import ModuleType

import pytest
from oracles.places import ROOT, SAMPLES


@pytest.fixture
def kernels(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    monkeypatch.delitem(sys.modules, "kernels", raising=False)
    return importlib.import_module("kernels")


def test_answers_that_differ_are_told_by_key(kernels: ModuleType) -> None:
    one = {"summary": {"te": 1.0, "names": ["a", None]}, "points": [[1.0, 2.0], [3.0]]}
    assert not list(
        kernels.apart(one, {"summary": {"te": 1.0 + 5e-7, "names": ["a", None]}, "points": [[1.0, 2.0], [3.0]]})
    )
    other = {"summary": {"te": 1.00001, "names": ["b", None]}, "points": [[1.0, 2.0], [3.0, 4.0]], "more": True}
    lines = list(kernels.apart(one, other))
    assert [line.split(":")[0] for line in lines] == ["summary.te", "summary.names[0]", "points[1]", "more"]


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["spur", "face_gear_conjugate", "beveloid_parallel", "worm_drive_dual_lead"])
def test_rounding_decides_no_figure_of_samples(kernels: ModuleType, name: str) -> None:
    """On parallel axes, and along lines of contact, many places are as near: which of them is told is no matter of rounding."""
    design = SAMPLES / f"{name}.toml"
    assert "summary" in kernels.contact_of(design, dict(os.environ))
    assert not list(kernels.differing(design, list(kernels.CORES)))
