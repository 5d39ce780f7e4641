"""Corrections of ground flanks: deviations in closed form give the modifications back that were off, and what is left, removed as a
topography, makes the flank whole."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.built import built_sample
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, load
from gearmesh.answers.inspection.correction import correct_settings, residual_text
from gearmesh.answers.inspection.inspection import inspect
from gearmesh.answers.inspection.machine_settings import GRINDER_SETTINGS
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.metrology.measured_teeth import InvoluteFlank, MeasuredTeeth
from gearmesh.systems.system import system_of
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid

#: what was ground too much, mm, by flanks
OFF = {
    Side.RIGHT: {"helix_slope": 0.006, "profile_slope": -0.004, "profile_twist": 0.002},
    Side.LEFT: {"helix_crowning": 0.005, "profile_crowning": -0.003, "helix_slope": -0.002},
}


def involute_of(gears: gm.Gears, name: str) -> InvoluteFlank:
    inspection = system_of(gears.design).inspection
    assert inspection is not None
    involute = inspection(gears.design, gears.train, name).involute
    assert involute is not None
    return involute


def removed(u: Array, w: Array, amounts: dict[str, float]) -> Array:
    """Amounts (I, J), mm, by ISO 21771-1, at shares of roll length from root to tip and of the face from toe to heel."""

    def slope(share: Array, amount: float | Array) -> Array:
        return np.where(np.asarray(amount) >= 0.0, amount * share, amount * (share - 1.0))

    own = dict.fromkeys(GRINDER_SETTINGS, 0.0) | amounts
    return np.asarray(
        slope(u, own["profile_slope"])
        + own["profile_crowning"] * (2.0 * u - 1.0) ** 2
        + slope(w, own["helix_slope"])
        + own["helix_crowning"] * (2.0 * w - 1.0) ** 2
        + own["profile_twist"] * (u - 0.5) * (w - 0.5)
    )


def ground(gears: gm.Gears, name: str, off: dict[Side, dict[str, float]]) -> dict[Side, DeviationGrid]:
    """Deviations of flanks that were ground so, in closed form, on 5 x 9 points."""
    involute, tooth, grids = involute_of(gears, name), gears.train.members[name].tooth, {}
    for side, amounts in off.items():
        grid = tooth.flank_grid(side, np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 9))
        ends = tooth.flank_grid(side, [0.0, 1.0], [0.0, 1.0]).points
        rolls, first, last = (
            involute.roll_length(np.hypot(points[..., 0], points[..., 1])) for points in (grid.points, ends[0], ends[1])
        )
        u = (rolls - first[0]) / (last[0] - first[0])
        width = abs(ends[0, 1, 2] - ends[0, 0, 2])
        w = grid.points[..., 2] / width + 0.5
        d = -np.cos(involute.base_helix) * removed(u, w, amounts)
        grids[side] = DeviationGrid(grid.points, grid.normals, d)
    return grids


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "name"), [("helical", "pinion"), pytest.param("internal", "gear", marks=pytest.mark.sweep)]
)
def test_what_was_ground_too_much_comes_back(sample: str, name: str, tmp_path: Path) -> None:
    """All modifications of both flanks are free, the thickness and the rotation of the teeth too: 12 um thicker, turned by 20."""
    gears = built_sample(sample)
    involute, file = involute_of(gears, name), tmp_path / "flanks.csv"
    turned, thicker = 0.020, 0.012
    grids = {
        side: replace(grid, values=grid.values + 0.5 * thicker + side.sign * turned)
        for side, grid in ground(gears, name, OFF).items()
    }
    file.write_text(residual_text(grids))
    made = correct_settings(gears.design, name, file)
    changes = {s.name: change for s, change in zip(made.settings, made.solution.changes, strict=True)}
    assert len(changes) == 2 * len(GRINDER_SETTINGS)
    for side in Side:
        for setting in GRINDER_SETTINGS:
            wanted = -OFF[side].get(setting, 0.0)
            assert changes[f"{side}.{setting}"] == pytest.approx(wanted, rel=0.01, abs=3e-5)
    for left in made.residual.values():
        assert np.abs(left.values).max() < 5e-5
    # a slope and its opposite together remove as much everywhere: what is measured of thickness and rotation is less by that
    right, left = (
        np.cos(involute.base_helix) * sum(abs(x) for key, x in OFF[side].items() if key.endswith("slope"))
        for side in Side
    )
    assert made.thickness == pytest.approx(thicker - right - left, abs=3e-5)
    assert made.rotation is not None
    base = involute.base * np.cos(involute.base_helix)
    assert abs(made.rotation) * base == pytest.approx(turned - 0.5 * (right - left), abs=3e-5)


@pytest.mark.sweep
def test_what_is_left_is_dressed(tmp_path: Path) -> None:
    """A wave over the profile, which no slope or crowning takes away: removed as a topography the flank is what was asked for."""
    gears = built_sample("helical")
    grids = ground(gears, "pinion", {Side.RIGHT: {"helix_slope": 0.004}})
    grid = grids[Side.RIGHT]
    wave = 0.003 * np.cos(3.0 * np.pi * np.linspace(0.0, 1.0, 5))[:, None] * np.ones(9)
    file, new, cut = (tmp_path / name for name in ("flank.csv", "new.toml", "cut.csv"))
    file.write_text(residual_text({Side.RIGHT: replace(grid, values=grid.values + wave)}))
    status, out, _ = run(
        *("correct", SAMPLES / "helical.toml", "--member", "pinion", "--measured", file, "-o", new),
        *("--topography", cut, "--noise", "0.1"),
    )
    assert status == 0
    assert "right.helix_slope" in out
    keys = [f"pinion.modifications_right.topography={cut}"]
    design = load(new)
    slope = design.plain()["pinion"]["modifications_right"]["helix_slope"]
    assert slope == pytest.approx(-0.004, abs=2e-5)
    made = correct_settings(gears.design, "pinion", file, noise=0.1)
    left = made.residual[Side.RIGHT].values
    dressed = gm.build(load(SAMPLES / "helical.toml", keys)).members["pinion"].tooth
    nominal = gears.train.members["pinion"].tooth
    t = np.linspace(0.1, 0.9, 9)
    both = [tooth.flank_grid(Side.RIGHT, np.linspace(0.1, 0.9, 5), t).points for tooth in (nominal, dressed)]
    moved = np.einsum("ijk,ijk->ij", both[1] - both[0], grid.normals)
    assert np.abs(left).max() > 1e-3
    # what is removed is what was left, but for how far the ends of the flank move its shares
    assert moved == pytest.approx(-left, abs=2e-4)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--settings", "radial"],
            "--settings = radial: must be one of profile_slope, profile_crowning, profile_twist",
        ),
        (
            ["--settings", "left.helix_slope"],
            "--settings = left.helix_slope: does not move the flanks that were measured",
        ),
    ],
)
@pytest.mark.sweep_cases("options1---settings = left.helix_slope: does not move the flanks that were measured")
def test_other_settings_are_refused(options: list[str], message: str, tmp_path: Path) -> None:
    file = tmp_path / "flank.csv"
    file.write_text(residual_text(ground(built_sample("helical"), "pinion", {Side.RIGHT: {"helix_slope": 0.004}})))
    told = refused("correct", SAMPLES / "helical.toml", "--member", "pinion", "--measured", file, *options)
    assert message in told


def test_cones_without_modifications_say_so(tmp_path: Path) -> None:
    """It was "none moves the flanks that were measured"."""
    file = tmp_path / "level.csv"
    file.write_text("s,t,deviation_um\n" + "".join(f"{s},{t},2\n" for s in (0, 0.5, 1) for t in (0, 0.5, 1)))
    gears = gm.build(load(SAMPLES / "beveloid_crossed.toml"))
    with pytest.raises(
        DesignError, match=r"none can be set: pinion\.cone_angle = 20 deg: must be 0 where modifications"
    ):
        gears.correct("pinion", file, flank="right")


def test_theoretical_charts_have_the_band_of_the_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lines of the profile chart: the design trace, and two as far apart as F_aT, over the range of evaluation."""
    from gearmesh.view.diagrams import k_chart

    drawn: list[Figure] = []
    monkeypatch.setattr(k_chart, "save_figure", lambda figure, _: drawn.append(figure))
    keys = ("pinion.modifications.profile_crowning=0.006", "accuracy_class=7")
    gears = built_sample("helical", *keys)
    gears.theoretical_chart("pinion").save(tmp_path / "k.png")
    inspection = inspect(gears.design, gears.train, "pinion", MeasuredTeeth())
    profile = drawn[0].axes[1]
    design, upper, lower = (np.array(line.get_xdata()) for line in profile.lines[:3])
    assert upper - lower == pytest.approx(inspection.tolerance("F_a"))
    assert design[[0, 200, 400]] == pytest.approx([-6.0, 0.0, -6.0], abs=1e-6)
    first, last = involute_of(gears, "pinion").profile.evaluated
    height = np.array(profile.lines[1].get_ydata())
    assert first <= height.min() < first + 0.1
    assert last - 0.1 < height.max() <= last
    with pytest.raises(DesignError, match="no theoretical profile and helix charts"):
        built_sample("hypoid").theoretical_chart("pinion").save(tmp_path / "k.png")
