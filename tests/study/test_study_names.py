"""Names of the figures that a study can record: known without solving."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest
from oracles.examples import some
from oracles.loaded import few_elements
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.load import loaded
from gearmesh.loaded.sharing import loaded_mesh
from gearmesh.study.rows.names import recordable
from gearmesh.study.rows.work import TURNS_GROUP, StudyWork
from gearmesh.study.study import work_and_nominal


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "torque"),
    some([("spur", [20.0, 50.0]), ("rack", None), ("spiral_bevel_basic", None), ("beveloid_crossed", None)], 2),
)
def test_what_rows_have_is_known_of_the_pair(
    sample: str, torque: list[float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All names that the design, solved on few elements, has, in their order; none beside them but ratios of line contact."""
    monkeypatch.setattr("gearmesh.loaded.sharing.flank_compliance", few_elements)
    monkeypatch.setattr(loaded, "loaded_mesh", partial(loaded_mesh, cells=(12, 8)))
    design = gm.load(SAMPLES / f"{sample}.toml", ["contact.phi1.count=5"])
    work, _ = work_and_nominal(design, (), 0, "all", torque)
    known = recordable(gm.build(design).pairs[0], len(torque or ()))
    assert len(work.names) > 30
    assert [name for name in known if name in work.names] == list(work.names)
    # whole turns are recorded by their own name alone
    others = {name for name, group in known.items() if group != TURNS_GROUP}
    assert others - set(work.names) <= {"transverse_contact_ratio", "overlap_ratio"}


def test_an_unknown_figure_is_refused_before_anything_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    def solved(*_: Any) -> Any:
        raise AssertionError("solved")

    monkeypatch.setattr(StudyWork, "figures", solved)
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    with pytest.raises(
        gm.DesignError, match=r"^record backlash_normal_mm: must be path, cycle, fit, turns, load with torque"
    ) as told:
        gears.study({"assembly.dz": [0.0, 0.01]}, record="cycle,backlash_normal_mm")
    assert "backlash_normal_min_mm, backlash_normal_max_mm" in str(told.value)
    assert str(told.value).endswith("; did you mean backlash_normal_min_mm?")
    with pytest.raises(
        gm.DesignError, match=r"^record max_pressure_3_mpa: must be path, cycle, fit, turns, load, all or"
    ):
        gears.study({"assembly.dz": [0.0, 0.01]}, record="max_pressure_3_mpa", torque=[10.0, 20.0])
