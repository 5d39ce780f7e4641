"""Number of threads of linear algebra while bodies are condensed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES
from threadpoolctl import threadpool_info, threadpool_limits

import gearmesh as gm
from gearmesh.contact.hertz import STEEL
from gearmesh.loaded.compliance import compliance
from gearmesh.loaded.sharing import compliances
from gearmesh.mesh.hexahedra.hexahedra import Cells

pytestmark = pytest.mark.quick


def threads() -> set[int]:
    return {each["num_threads"] for each in threadpool_info() if each["user_api"] == "blas"}


def test_both_bodies_side_by_side_on_one_thread_each(monkeypatch: pytest.MonkeyPatch) -> None:
    """Meanwhile linear algebra has one thread, before and after it what was set; the bodies are those of one after the other."""
    pair = gm.build(gm.load(SAMPLES / "spur.toml")).pairs[0]
    few, seen = Cells(flank=3, fillet=2, thickness=3, rim=2, face=2), []
    of = compliance.Sector.of

    def told(tooth: Any, side: Any, material: Any, cells: Any, rim: Any) -> compliance.Sector:
        seen.append(threads())
        return of(tooth, side, material, few, rim)

    monkeypatch.setattr(compliance.Sector, "of", told)
    with threadpool_limits(2, user_api="blas"):
        together = compliances(pair)
        assert threads() == {2}
        compliance._KEPT_RINGS.clear()
        alone = [
            compliance.flank_compliance(each.tooth, side, STEEL)
            for each, side in zip(pair.both, pair.flanks, strict=True)
        ]
        assert threads() == {2}
    # two bodies and the coarser meshes that estimate their errors, then the two alone
    assert seen == [{1}] * 6
    for one, other in zip(together, alone, strict=True):
        np.testing.assert_array_equal(one.smooth, other.smooth)
        np.testing.assert_array_equal(one.stress, other.stress)
