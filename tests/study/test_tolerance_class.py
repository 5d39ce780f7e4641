"""Studies of flanks within a tolerance class: what is drawn is what an inspection of these flanks measures."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.command_line import refused
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Member, load
from gearmesh.answers.inspection.inspection import inspect
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.metrology.drawn_pitch import drawn_pitch
from gearmesh.metrology.measured_teeth import MeasuredTeeth
from gearmesh.study.study import plan_of
from gearmesh.study.tolerance_class import class_spreads
from gearmesh.systems.system import system_of

#: deviations by the keys that make them
MEASURED = {"profile_slope": "f_Ha", "profile_crowning": "f_fa", "helix_slope": "f_Hb", "helix_crowning": "f_fb"}


@dataclass(frozen=True)
class RemovedAmounts:
    """Amounts that modifications remove from a flank, as deviations along its normals; helix angle at the base cylinder, rad."""

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


@pytest.mark.sweep
@pytest.mark.parametrize(("sample", "member"), [("helical", "pinion"), ("internal", "gear")])
def test_the_ends_of_what_is_drawn_are_the_tolerances(sample: str, member: str) -> None:
    """Every key alone at the end of its spread: the inspection finds the tolerance, within what sampling misses of a form."""
    gears = built_sample(sample)
    nominal = gears.train.members[member]
    basis = inspect(gears.design, gears.train, member, MeasuredTeeth())._basis
    assert basis is not None
    assert basis.involute is not None
    spreads = {key: own for key, own in class_spreads(gears.design, 0, "6").items() if key.startswith(member)}
    assert len(spreads) == len(MEASURED)
    for key, spread in spreads.items():
        name, low, high = key.rpartition(".")[2], *spread.parameters[2:]
        side = Side(key.split(".")[1].removeprefix("modifications_"))
        assert spread.parameters[:2] == (0.0, pytest.approx(high / 3.0))
        assert low == -high
        modified = built_sample(sample, f"{key}={high}").train.members[member]
        removed = RemovedAmounts(nominal, modified, side, basis.involute.base_helix)
        answer = inspect(gears.design, gears.train, member, MeasuredTeeth({side: removed}))
        limit = (basis.sizes.tolerances(6) or {})[f"{MEASURED[name]}T"]
        assert abs(answer.deviations[MEASURED[name]]) == pytest.approx(limit, rel=1e-4)


def test_a_class_is_drawn_about_the_design_and_beside_other_keys() -> None:
    design = built_sample("spur", "pinion.modifications_right.helix_crowning=0.004").design
    plan = plan_of(design, {}, {"class": "5", "assembly.dx": "normal:0:10um"}, 64, "lhs", 0)
    assert len(plan.columns) == 13
    seeds = plan.columns["measured.pinion_pitch_seed"]
    assert len(set(seeds)) == 64
    assert all(isinstance(seed, int) and 0 <= seed < 10**6 for seed in seeds)
    assert set(plan.columns["measured.gear_pitch_class"]) == {5}
    crowning = np.array(plan.columns["pinion.modifications_right.helix_crowning"])
    assert crowning.mean() == pytest.approx(0.004, abs=5e-5)
    low, high = class_spreads(design, 0, 5)["pinion.modifications_right.helix_crowning"].parameters[2:]
    assert low < crowning.min() < crowning.max() < high
    alone = plan_of(design, {}, "class:5", 4, "lhs", 0)
    assert len(alone.columns) == 12
    # the class that the design asks for needs no key, and teeth that were measured are not drawn
    asked = built_sample("spur", "accuracy_class=5", f"measured.gear_runout_um={[k % 2 for k in range(40)]}").design
    own = plan_of(asked, {}, "class:5", 4, "lhs", 0).columns
    assert [key for key in own if key.startswith("measured")] == ["measured.pinion_pitch_seed"]


@pytest.mark.parametrize(("sample", "name"), [("helical", "pinion"), ("hypoid", "gear")])
@pytest.mark.sweep_cases("hypoid-gear")
def test_drawn_teeth_are_within_their_class(sample: str, name: str) -> None:
    """Single pitch deviations have a third of their tolerance as standard deviation, neighbours share half of it with the other
    sign; both sides have one eccentricity; nothing is beyond the class; one number draws one gear."""
    gears = built_sample(sample)
    inspection = system_of(gears.design).inspection
    assert inspection is not None
    basis, teeth = inspection(gears.design, gears.train, name), gears.train.members[name].tooth.teeth
    limits = basis.sizes.tolerances(5) or {}
    single, total = 1e-3 * limits.get("f_pT", limits.get("f_ptT", 0.0)), 1e-3 * limits["F_pT"]
    drawn = [drawn_pitch(basis, teeth, 5, (seed, 1)) for seed in range(400)]
    both = [own[side] for own in drawn for side in Side]
    assert max(own.single_pitch for own in both) <= single
    assert max(own.cumulative for own in both) <= total
    assert max(own.cumulative for own in both) > 0.8 * total
    # without the wave of the eccentricity
    number = np.arange(teeth)
    wave = np.stack((np.ones(teeth), np.cos(2 * np.pi * number / teeth), np.sin(2 * np.pi * number / teeth)), axis=-1)
    index = np.array([own.index for own in both])
    fitted = index @ wave @ np.linalg.inv(wave.T @ wave)
    errors = index - fitted @ wave.T
    steps = errors - np.roll(errors, 1, axis=1)
    kept = (teeth - 3) / teeth
    assert np.sqrt(np.mean(steps**2)) == pytest.approx(single / 3.0 * np.sqrt(kept), rel=0.1)
    assert np.mean(steps * np.roll(steps, 1, axis=1)) / np.mean(steps**2) == pytest.approx(-0.5, abs=0.1)
    size = np.hypot(*fitted[:, 1:].T).reshape(-1, 2)
    assert np.corrcoef(size.T)[0, 1] > 0.8
    assert np.sqrt(np.mean(fitted[:, 1:] ** 2)) == pytest.approx(total / 6.0, rel=0.25)
    again = drawn_pitch(basis, teeth, 5, (7, 1))
    assert all((again[side].index == drawn[7][side].index).all() for side in Side)


@pytest.mark.sweep
def test_a_study_of_a_class_has_the_long_transmission_error(tmp_path: Path) -> None:
    """Every row is the design with its keys, rolled over whole turns."""
    keys = ("pinion.teeth=16", "gear.teeth=32", "assembly.center_distance=72")
    gears = built_sample("spur", *keys)
    study = gears.study(tolerance="class:6", sample=3, record="turns", folder=tmp_path, workers=1)
    varied = {key: values for key, values in study.columns.items() if key in study.plan.keys}
    assert study.columns["status"] == ["ok"] * 3
    row = gm.build(load(SAMPLES / "spur.toml", [*keys, *(f"{key}={values[1]}" for key, values in varied.items())]))
    figures = row.contact(turns=True).summary
    for name in ("turns_te_peak_to_peak_arcsec", "turns_te_tooth_to_tooth_arcsec", "turns_backlash_min_deg"):
        assert study.columns[name][1] == pytest.approx(figures[name], rel=1e-9)
    assert row.evaluate("pinion").deviations["F_p"] >= study.columns["pinion_cumulative_pitch_um"][1] > 0.0


@pytest.mark.parametrize(
    ("sample", "text", "message"),
    [
        ("helical", "class:12", "--tolerance class = 12: must be a whole number from 1 to 11"),
        (
            "beveloid_crossed",
            "class:6",
            "flanks of beveloid gears have no tolerances; allowed is cylindrical and bevel gears",
        ),
    ],
)
@pytest.mark.sweep_cases(
    "beveloid_crossed-class:6-flanks of beveloid gears have no tolerances; allowed is cylindrical and bevel gears"
)
def test_classes_that_there_are_not_are_refused(sample: str, text: str, message: str) -> None:
    assert message in refused("study", SAMPLES / f"{sample}.toml", "--sample", "4", "--tolerance", text)
