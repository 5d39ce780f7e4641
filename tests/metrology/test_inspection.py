"""Inspections of gears whose deviations are known: those of a gear that was cut with other angles, and of a bevel pinion."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, Inspection, Member
from gearmesh.answers.inspection.inspection import inspect
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.kinds import Side
from gearmesh.metrology.evaluation import helix_sign
from gearmesh.metrology.flanks.measuring_grid import MeasuringGrid
from gearmesh.metrology.flanks.point_file import point_text
from gearmesh.metrology.measured_teeth import GridDeviations, MeasuredTeeth
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute
from gearmesh.view.diagrams.inspection_chart import plot_inspection


@dataclass(frozen=True)
class OtherGear:
    """Deviations of one involute flank from another: arcs between both at equal radius and z, along the nominal normal."""

    nominal: Member
    real: Member
    side: Side
    extent = ((0.0, 1.0), (0.0, 1.0))

    def involute(self, member: Member) -> ScrewInvolute:
        jet = member.tooth.side(self.side).flank.jet(*member.tooth.flank_grid(self.side, [0.5], [0.5]).parameters[0].T)
        return ScrewInvolute.through(jet, self.side.sign)

    def angle(self, member: Member, rho: Array, z: Array) -> Array:
        own = self.involute(member)
        roll = np.sqrt(rho**2 - own.base_radius**2) / own.base_radius
        return own.start + own.hand * (roll - np.arctan(roll)) + own.rate * z

    def at(self, s: Array, t: Array) -> Array:
        s, t = np.broadcast_arrays(s, t)
        us, i = np.unique(s, return_inverse=True)
        ut, j = np.unique(t, return_inverse=True)
        grid = self.nominal.tooth.flank_grid(self.side, us, ut)
        points, normals = (x[i.ravel(), j.ravel()].reshape(*s.shape, 3) for x in (grid.points, grid.normals))
        rho = np.hypot(points[..., 0], points[..., 1])
        around = (points[..., 0] * normals[..., 1] - points[..., 1] * normals[..., 0]) / rho
        arcs = self.angle(self.real, rho, points[..., 2]) - self.angle(self.nominal, rho, points[..., 2])
        return np.asarray(arcs * rho * around)


def inspected(hand: str, helix: float, alpha: float) -> tuple[Inspection, float, float]:
    """A helical gear that was cut with other helix and normal pressure angles (deg more), its tooth thickness kept."""
    nominal, real = (
        gm.gear(25, module=5, helix=15 + more, hand=hand, face=40, pressure_angle=20 + larger)
        for more, larger in ((0.0, 0.0), (helix, alpha))
    )
    members = [next(iter(gears.train.members.values())) for gears in (nominal, real)]
    measured = MeasuredTeeth({side: OtherGear(*members, side) for side in Side})
    answer = inspect(nominal.design, nominal.train, members[0].name, measured)
    flanks = [measured.flanks[Side.LEFT].involute(member) for member in members]  # type: ignore[attr-defined]
    return answer, *(getattr(flanks[1], name) - getattr(flanks[0], name) for name in ("rate", "base_radius"))


@pytest.mark.parametrize("hand", ["right", "left"])
@pytest.mark.sweep_cases("right")
def test_larger_helix_angle_gives_a_positive_helix_slope(hand: str) -> None:
    """A turn of w per mm more along the axis is r_b w b on the tangent to the base cylinder, on both flanks."""
    answer, rate, _ = inspected(hand, 0.01, 0.0)
    base = answer._basis.involute.base  # type: ignore[union-attr]
    for flank in answer.figures.flanks.values():
        assert flank.helix.slope_deviation == pytest.approx(1e3 * abs(rate) * base * 40.0, rel=2e-3)
    # at the radius of the middle of the flank
    rho = np.hypot(*answer.maps[Side.LEFT].points[6, 12, :2])
    nominal = answer._basis.involute.helix  # type: ignore[union-attr]
    lead = np.tan(nominal) / (12.5 * 5.0 / np.cos(nominal))
    larger = abs(np.arctan(rho * (lead + rate))) - abs(np.arctan(rho * lead))
    for flank in answer.figures.flanks.values():
        assert flank.second_order.spiral_angle_error * ARCSEC == pytest.approx(larger, rel=2e-3)
        assert flank.helix.form_deviation < 0.01
    assert answer.deviations["f_Hb"] > 0.0


def test_larger_pressure_angle_gives_a_negative_profile_slope() -> None:
    """Slope deviation of the profile is dr_b / r_b times the difference of roll lengths L between the ends of the evaluation
    range. It is negative, because a larger pressure angle has a smaller base circle."""
    answer, _, base_change = inspected("right", 0.0, 0.02)
    base = answer._basis.involute.base  # type: ignore[union-attr]
    first, last = answer._basis.involute.profile.slope  # type: ignore[union-attr]
    for flank in answer.figures.flanks.values():
        # a smaller base circle: at radius rho the string lies along another tangent, by d(inv) rho cos(alpha) = L dr_b / r_b
        assert flank.profile.slope_deviation == pytest.approx(1e3 * base_change / base * (last - first), rel=1e-2)
        assert flank.profile.slope_deviation < 0.0
        assert flank.second_order.pressure_angle_error * ARCSEC == pytest.approx(np.radians(0.02), rel=0.05)
    assert answer.deviations["f_Ha"] < 0.0


def test_files_are_evaluated(tmp_path: Path) -> None:
    """Deviations that rise by 8 um from toe to heel on a grid, and index deviations of a gear of 24 teeth."""
    gears = built_sample("helical")
    member = gears.train.members["pinion"]
    t = np.linspace(0.1, 0.9, 9)
    grids = [MeasuringGrid.of(member, side, (5, 9)) for side in Side]
    head, *lines = [line for line in point_text(grids, [], None, ".csv").splitlines() if line[0] != "#"]
    flanks, pitch = tmp_path / "flanks.csv", tmp_path / "pitch.csv"
    done = [f"{line},{8.0 * t[k % 9]}" for k, line in enumerate(lines)]
    flanks.write_text("\n".join([f"{head},deviation_um", *done]) + "\n")
    pitch.write_text("tooth,left_um\n0,3\n" + "".join(f"{k},0\n" for k in range(1, 24)))
    status, out, warnings = run(
        "evaluate",
        SAMPLES / "helical.toml",
        "--member",
        "pinion",
        "--measured",
        flanks,
        "--pitch",
        pitch,
        "--json",
        "-",
    )
    assert status == 0
    document = json.loads(out)
    involute = inspect(gears.design, gears.train, "pinion", MeasuredTeeth())._basis.involute  # type: ignore[union-attr]
    for side in Side:
        rise = document["flanks"][side]["helix"]["slope_deviation_um"]
        wanted = 8.0 / np.cos(involute.base_helix) * helix_sign(side.sign, involute.helix)  # type: ignore[union-attr]
        assert rise == pytest.approx(wanted, rel=1e-4)
    assert document["flanks"]["left"]["pitch"]["single_pitch_um"] == pytest.approx(3.0)
    assert "pitch" not in document["flanks"]["right"]
    assert "the helix trace of the right flank was measured over 89 %" in warnings
    # the flanks of a design that has them are held against its nominal teeth
    own = built_sample("helical", f"measured.pinion_left={flanks}")
    assert (
        own.evaluate("pinion").figures.flanks["left"].row
        == own.evaluate("pinion", flanks, flank="left").figures.flanks["left"].row
    )
    for text, message in (
        ("tooth,right\n0,1\n", "line 1: allowed is tooth, and right_um, left_um and runout_um"),
        ("tooth,right_um\n24,1\n", 'line 2: tooth = "24": must be a tooth from 0 to 23, 0 is on x'),
        ("tooth,right_um\n0,1\n", "has no tooth 1; the gear has 24, counted from 0"),
    ):
        pitch.write_text(text)
        assert message in refused("evaluate", SAMPLES / "helical.toml", "--member", "pinion", "--pitch", pitch)
    assert "--measured: missing" in refused("evaluate", SAMPLES / "helical.toml", "--member", "pinion")


@pytest.mark.sweep
def test_classes_of_a_bevel_pinion_and_its_chart(tmp_path: Path) -> None:
    gears = built_sample("spiral_bevel_basic")
    teeth = gears.train.members["pinion"].tooth.teeth
    s, t = np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 9)
    flat = GridDeviations.of(s, t, np.full((5, 9), 4e-3))
    wave = np.sin(2.0 * np.pi * np.arange(teeth) / teeth)
    pitch = {Side.RIGHT: PitchDeviations.of_index(5e-3 * wave)}
    answer = inspect(gears.design, gears.train, "pinion", MeasuredTeeth({Side.RIGHT: flat}, pitch, runout=15e-3))
    assert flat.at(np.array([0.05, 0.5]), np.array([0.5, 0.5])).tolist() == pytest.approx([np.nan, 4e-3], nan_ok=True)
    order = answer.figures.flanks["right"].second_order
    assert order.thickness_deviation == pytest.approx(4.0)
    assert max(abs(order.spiral_angle_error), abs(order.pressure_angle_error), abs(order.twist)) < 1e-9
    classes = {own.symbol: own for own in answer.figures.classes}
    limits = answer._basis.sizes  # type: ignore[union-attr]
    for symbol, value in (("F_p", 1e3 * np.ptp(5e-3 * wave)), ("F_r", 15.0)):
        assert classes[symbol].deviation == pytest.approx(value)
        own = classes[symbol].tolerance_class
        assert value <= classes[symbol].tolerance
        assert value > limits.tolerances(own - 1)[f"{symbol}T"]
    assert answer.figures.limited_by == ["F_r"]
    document = answer.document()
    assert set(document["flanks"]) == {"right"}
    assert "profile" not in document["flanks"]["right"]
    plot_inspection(tmp_path / "chart.svg", answer)
    text = (tmp_path / "chart.svg").read_text()
    assert "svg" in text[:200]
    with pytest.raises(DesignError, match=f"must be {teeth}, one a tooth"):
        inspect(gears.design, gears.train, "pinion", MeasuredTeeth(pitch={Side.LEFT: PitchDeviations(np.zeros(3))}))
    with pytest.raises(DesignError, match="must be one of pinion, gear"):
        inspect(gears.design, gears.train, "ring", MeasuredTeeth())


def test_unmeasured_ends_are_reported_and_figures_beyond_the_class_too() -> None:
    gears = built_sample("helical", "accuracy_class=4")
    s, t = np.linspace(0.3, 0.9, 7), np.linspace(0.0, 1.0, 9)
    bent = GridDeviations.of(s, t, np.broadcast_to(0.02 * (t - 0.5), (7, 9)))
    answer = inspect(gears.design, gears.train, "pinion", MeasuredTeeth({Side.LEFT: bent}))
    (warning,) = answer.warnings
    assert warning.startswith("the profile trace of the left flank was measured over")
    involute = answer._basis.involute  # type: ignore[union-attr]
    # 20 um along the normal, over the face; in the transverse plane
    assert answer.deviations["f_Hb"] == pytest.approx(
        20.0 / np.cos(involute.base_helix) * (1 if involute.helix > 0 else -1)
    )
    assert any(line.startswith("f_Hb (helix slope) is ") for line in answer.complaints)
