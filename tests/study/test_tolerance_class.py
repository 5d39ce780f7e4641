"""Studies of flanks within a tolerance class: what is drawn is what an inspection of these flanks measures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.command_line import refused
from oracles.places import SAMPLES

from gearmesh.answers.inspection.inspection import inspect
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.metrology.measured_teeth import MeasuredTeeth
from gearmesh.study.study import plan_of
from gearmesh.study.tolerance_class import class_spreads
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side

#: deviations by the keys that make them
MEASURED = {"profile_slope": "f_Ha", "profile_crowning": "f_fa", "helix_slope": "f_Hb", "helix_crowning": "f_fb"}


@dataclass(frozen=True)
class RemovedAmounts:
    """What modifications remove of a flank, as deviations along its normals; helix angle at the base cylinder, rad."""

    nominal: Member
    modified: Member
    side: Side
    base_helix: float
    extent = ((0.0, 1.0), (0.0, 1.0))

    def at(self, s: Array, t: Array) -> Array:
        s, t = np.broadcast_arrays(s, t)
        (us, i), (ut, j) = (np.unique(x, return_inverse=True) for x in (s, t))
        points = self.nominal.tooth.flank_grid(self.side, us, ut).points[i.ravel(), j.ravel()].reshape(*s.shape, 3)
        flank = self.modified.tooth.side(self.side).flank
        roll = np.sqrt((points[..., :2] ** 2).sum(axis=-1) - flank.base_radius**2)
        return np.asarray(-flank.amount.jet(roll, points[..., 2]).a * np.cos(self.base_helix))


@pytest.mark.parametrize(("sample", "member"), [("helical", "pinion"), ("internal", "gear")])
def test_the_ends_of_what_is_drawn_are_the_tolerances(sample: str, member: str) -> None:
    """Every key alone at the end of its spread: the inspection finds the tolerance, within what sampling misses of a form."""
    gears = built_sample(sample)
    nominal = gears.train.members[member]
    spreads = {key: own for key, own in class_spreads(gears.design, 0, "6").items() if key.startswith(member)}
    assert len(spreads) == len(MEASURED)
    for key, spread in spreads.items():
        name, low, high = key.rpartition(".")[2], *spread.parameters[2:]
        side = Side(key.split(".")[1].removeprefix("modifications_"))
        assert spread.parameters[:2] == (0.0, pytest.approx(high / 3.0))
        assert low == -high
        modified = built_sample(sample, f"{key}={high}").train.members[member]
        basis = inspect(gears.design, gears.train, member, MeasuredTeeth()).basis
        assert basis is not None
        assert basis.involute is not None
        removed = RemovedAmounts(nominal, modified, side, basis.involute.base_helix)
        answer = inspect(gears.design, gears.train, member, MeasuredTeeth({side: removed}))
        limit = (basis.sizes.tolerances(6) or {})[f"{MEASURED[name]}T"]
        assert abs(answer.deviations[MEASURED[name]]) == pytest.approx(limit, rel=1e-4)


def test_a_class_is_drawn_about_the_design_and_beside_other_keys() -> None:
    design = built_sample("spur", "pinion.modifications_right.helix_crowning=0.004").design
    plan = plan_of(design, {}, {"class": "5", "assembly.dx": "normal:0:10um"}, 64, "lhs", 0)
    assert len(plan.columns) == 9
    crowning = np.array(plan.columns["pinion.modifications_right.helix_crowning"])
    assert crowning.mean() == pytest.approx(0.004, abs=5e-5)
    low, high = class_spreads(design, 0, 5)["pinion.modifications_right.helix_crowning"].parameters[2:]
    assert low < crowning.min() < crowning.max() < high
    alone = plan_of(design, {}, "class:5", 4, "lhs", 0)
    assert len(alone.columns) == 8


@pytest.mark.parametrize(
    ("sample", "text", "message"),
    [
        ("helical", "class:12", "--tolerance class = 12: must be a whole number from 1 to 11"),
        ("beveloid_crossed", "class:6", "flanks of beveloid gears have no tolerances; allowed is cylindrical gears"),
    ],
)
def test_classes_that_there_are_not_are_refused(sample: str, text: str, message: str) -> None:
    assert message in refused("study", SAMPLES / f"{sample}.toml", "--sample", "4", "--tolerance", text)
