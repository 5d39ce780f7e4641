"""Corrected machine settings: a flank cut with one setting off gives that back, noise moves settings by what is stated, what the
machine cannot cut is left, and wrong input is refused in one line."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from oracles.measuring import along_normals, flanks_cut_once
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Design, GearmeshError
from gearmesh.answers.inspection.correction import correct_settings, residual_text
from gearmesh.kinds import Side, Tooth
from gearmesh.metrology.correction import setting_changes
from gearmesh.systems import system as systems
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid

COMMON = ("sliding_base", "machine_root_angle")
SECONDS = 20.0 / 3600.0
CHANGES = {
    "radial": 0.005,
    "machining_offset": 0.005,
    "machine_centre_to_back": 0.005,
    "sliding_base": 0.005,
    "machine_root_angle": SECONDS,
    "index_angle": SECONDS,
}


@pytest.fixture(scope="module", autouse=True)
def _cut_once() -> Iterator[None]:
    with flanks_cut_once():
        yield


@pytest.fixture(scope="module")
def hypoid() -> Design:
    """With every setting stated."""
    design = gm.load(SAMPLES / "hypoid.toml")
    return systems.pin(design, systems.build(design))


def pinion(design: Design, values: dict[str, float] | None = None) -> Tooth:
    """Pinion tooth of a design with `values` added to keys of the concave side. Keys that both sides have in common change on
    both."""
    plain = design.plain()["pinion"]
    changes = {
        f"pinion.{side}.{key}": plain[side][key] + change
        for key, change in (values or {}).items()
        for side in ("concave", *(("convex",) if key in COMMON else ()))
    }
    return cut_pinion(json.dumps(design.with_values(changes).stated()))


@lru_cache(maxsize=16)
def cut_pinion(keys: str) -> Tooth:
    """Pinion tooth of a design given by its keys as JSON; cached, because several tests ask for the same keys."""
    return systems.member(gm.parse(json.loads(keys)), "pinion").member.one_tooth


def measured(path: Path, design: Design, values: dict[str, float], noise: float = 0.0) -> dict[Side, DeviationGrid]:
    """Writes the file of both flanks of a pinion cut with settings off."""
    nominal, off, random = pinion(design), pinion(design, values), np.random.default_rng(3)
    grids = {side: along_normals(off, side, nominal) for side in Side}
    noisy = {
        side: replace(grid, values=grid.values + noise * random.normal(size=grid.values.shape))
        for side, grid in grids.items()
    }
    path.write_text(residual_text(noisy))
    return noisy


@pytest.mark.sweep
@pytest.mark.parametrize("key", CHANGES)
@pytest.mark.sweep_cases("machine_centre_to_back", "machine_root_angle", "machining_offset", "radial", "sliding_base")
def test_a_setting_that_was_off_comes_back(hypoid: Design, key: str, tmp_path: Path) -> None:
    """All usual settings of both sides are free."""
    path = tmp_path / "pinion.csv"
    grids = measured(path, hypoid, {key: CHANGES[key]})
    assert max(np.abs(grid.values).max() for grid in grids.values()) > 1e-4
    made = correct_settings(hypoid, "pinion", path)
    changes = {s.name: change for s, change in zip(made.settings, made.solution.changes, strict=True)}
    assert len(changes) == 12
    name = key if key in COMMON else f"concave.{key}"
    assert changes[name] == pytest.approx(-CHANGES[key], rel=0.01)
    for left in made.residual.values():
        assert np.abs(left.values).max() < 5e-5


@pytest.mark.sweep
def test_noise_moves_settings_by_what_is_stated(hypoid: Design, tmp_path: Path) -> None:
    """And the noise is found by what no setting takes away; the contact after is that of the design again."""
    off = {"radial": 0.05, "machine_root_angle": 0.05}
    path = tmp_path / "pinion.csv"
    grids = measured(path, hypoid, off, noise=5e-4)
    made = correct_settings(hypoid, "pinion", path, settings=["concave.radial", "machine_root_angle"])
    assert made.solution.noise == pytest.approx(5e-4, rel=0.3)
    rows = zip(made.settings, made.solution.changes, made.solution.uncertainties, strict=True)
    for setting, change, spread in rows:
        error = change + off[setting.plain_name]
        assert abs(error) < 4.0 * spread
        assert 0.0 < spread < 0.2 * off[setting.plain_name]
    # what the new settings cut is off by the opposite of the old ones' error, but for the noise
    cut = systems.member(made.new_design, "pinion").member.one_tooth
    for side, grid in grids.items():
        moved = along_normals(cut, side, pinion(hypoid)).values
        assert np.sqrt(np.mean((moved + grid.values) ** 2)) < 7e-4


@pytest.mark.sweep
def test_the_contact_of_the_corrected_pinion_is_that_of_the_design(hypoid: Design, tmp_path: Path) -> None:
    """Machine that is off so far that the contact pattern leaves its place. The corrected pinion has the contact of the design,
    and the saved files say the same again."""
    path = tmp_path / "pinion.csv"
    measured(path, hypoid, {"machining_offset": 0.1})
    made = gm.build(gm.load(SAMPLES / "hypoid.toml")).correct("pinion", path)
    own = made.figures
    assert own.contact_before.mesh_te_peak_to_peak > 1.2 * own.contact_nominal.mesh_te_peak_to_peak
    assert own.contact_after.contact_ratio == pytest.approx(own.contact_nominal.contact_ratio, rel=1e-3)
    assert own.contact_after.mesh_te_peak_to_peak == pytest.approx(own.contact_nominal.mesh_te_peak_to_peak, abs=0.02)
    made.save(tmp_path / "new.toml")
    made.save(tmp_path / "left.csv")
    assert gm.load(tmp_path / "new.toml").plain()["pinion"] == made.new_design.plain()["pinion"]
    again = correct_settings(made.design, "pinion", tmp_path / "left.csv")
    for side, grid in again._flanks.grids.items():
        np.testing.assert_allclose(grid.values, made.residual[side].values, atol=1e-9)
    assert '"contact_after"' in made.json()


@pytest.mark.sweep
def test_what_the_machine_cannot_cut_is_left(hypoid: Design, tmp_path: Path) -> None:
    """A modified roll of third order, corrected by two settings of each side: as far as their exact flanks can follow."""
    path = tmp_path / "pinion.csv"
    grids = measured(path, hypoid, {"modified_roll_c3": 0.02})
    made = correct_settings(hypoid, "pinion", path, settings=["radial", "index_angle"], noise=0.01)
    left = np.concatenate([grid.values.ravel() for grid in made.residual.values()])
    before = np.concatenate([grid.values.ravel() for grid in grids.values()])
    assert 5e-5 < np.sqrt(np.mean(left**2)) < 0.9 * np.sqrt(np.mean(before**2))
    cut = systems.member(made.new_design, "pinion").member.one_tooth
    for side, grid in grids.items():
        moved = along_normals(cut, side, pinion(hypoid)).values
        np.testing.assert_allclose(made.residual[side].values, grid.values + moved, atol=1e-8)
    # no other values of these settings do better
    columns = made.sensitivity / np.linalg.norm(made.sensitivity, axis=0)
    assert np.abs(columns.T @ left).max() < 0.02 * np.linalg.norm(before)


def test_settings_that_act_alike_are_named(hypoid: Design, tmp_path: Path) -> None:
    """A rotation of the cradle is one of the blank."""
    path = tmp_path / "pinion.csv"
    measured(path, hypoid, {"radial": 0.005, "index_angle": SECONDS})
    names = ["concave.radial", "concave.cradle_angle", "concave.index_angle"]
    made = correct_settings(hypoid, "pinion", path, settings=names)
    assert made.solution.changes[0] == pytest.approx(-0.005, rel=0.01)
    assert made.warnings[-1].startswith(
        "concave.cradle_angle, concave.index_angle: some move the flanks as others would"
    )
    # what the one turns the flank by, the other turns it back: by 1 / ratio of roll, and nothing is known of either
    (exchange,) = made._exchanges
    assert sorted(exchange.settings) == names[1:]
    roll = hypoid.in_mm().pinion.concave.ratio_of_roll  # type: ignore[attr-defined]
    changes = dict(zip(exchange.settings, exchange.changes, strict=True))
    ratio = gm.build(hypoid).sheet().values["pinion.concave.ratio_of_roll"] if roll is None else roll
    assert changes[names[1]] / changes[names[2]] == pytest.approx(-ratio, rel=1e-4)
    assert (exchange.moves, exchange.uncertainty, exchange.units) == (0.0, None, ["deg", "deg"])
    assert abs(exchange.correlation) > 0.999
    assert [spread is None for spread in made.to_dict()["uncertainty"]] == [False, True, True]
    assert correct_settings(hypoid, "pinion", path, settings=names[::2]).warnings == made.warnings[:-1]


@pytest.mark.sweep
def test_tilt_is_told_with_its_sense_and_zero(hypoid: Design, tmp_path: Path) -> None:
    path = tmp_path / "pinion.csv"
    measured(path, hypoid, {"radial": 0.005})
    made = correct_settings(hypoid, "pinion", path, settings=["concave.tilt"])
    (note,) = (line for line in made.warnings if line.startswith("concave.tilt: "))
    assert "0 is the cutter's axis parallel to the cradle's; > 0 leans its end in the blank" in note
    assert "swivel of 0 deg" in note


def test_exchangeable_settings_are_named_with_their_difference() -> None:
    """Three settings that nearly do what one another do, one that does the same as two others, one alone; against drawn noise."""
    rng, count, noise = np.random.default_rng(53), 200, 2e-4
    first, second, other, alone = rng.normal(size=(4, count))
    near = first + 0.01 * other
    sensitivity = np.stack([first, 2.0 * near, alone], axis=-1)
    found = setting_changes(noise * rng.normal(size=count), sensitivity, noise)
    (exchange,) = found.exchanges
    assert sorted(exchange.settings) == [0, 1]
    # 1 of the one and 0.5 of the other, against each other, leave what 0.01 of the third vector does
    one = exchange.settings.index(0)
    changes = exchange.changes / exchange.changes[one]
    assert changes[1 - one] == pytest.approx(-0.5, rel=0.01)
    left = sensitivity[:, list(exchange.settings)] @ exchange.changes
    assert exchange.moves == pytest.approx(float(np.sqrt(np.mean(left**2))), rel=1e-6)
    assert exchange.alone == pytest.approx(float(np.sqrt(np.mean(sensitivity[:, exchange.settings[0]] ** 2))), rel=1e-9)
    draws = np.linalg.lstsq(sensitivity, noise * rng.normal(size=(count, 4000)), rcond=None)[0]
    np.testing.assert_allclose(found.uncertainties, draws.std(axis=1), rtol=0.06)
    assert exchange.spread == pytest.approx(draws[exchange.settings[0]].std(), rel=0.06)
    assert exchange.correlation == pytest.approx(np.corrcoef(draws[list(exchange.settings)])[0, 1], abs=1e-3)
    # what others do exactly is not known at all
    exact = np.stack([first, second, first + second, alone], axis=-1)
    found = setting_changes(noise * rng.normal(size=count), exact, noise)
    assert np.isinf(found.uncertainties[:3]).all()
    assert found.uncertainties[3] == pytest.approx(noise / np.linalg.norm(alone), rel=0.05)
    (exchange,) = found.exchanges
    assert (exchange.moves, exchange.spread, sorted(exchange.settings)) == (0.0, np.inf, [0, 1, 2])
    assert np.abs(exact[:, list(exchange.settings)] @ exchange.changes).max() < 1e-12
    # settings that have little in common have none
    assert setting_changes(noise * alone, np.stack([first, second], axis=-1), noise).exchanges == ()


def test_wrong_input_is_one_line(hypoid: Design, tmp_path: Path) -> None:
    path = tmp_path / "pinion.csv"
    sides = measured(path, hypoid, {"radial": 0.005})
    concave = max(sides, key=lambda side: float(np.abs(sides[side].values).max()))
    wrong = [("pinion", ["radius"], "radius"), ("pinion", ["convex.radial"], "does not move"), ("wheel", [], "wheel")]
    for member, settings, word in wrong:
        with pytest.raises(GearmeshError, match=word) as caught:
            correct_settings(hypoid, member, path, str(concave), settings=settings)
        assert "\n" not in str(caught.value)
    arcs = gm.load(SAMPLES / "circular_arc.toml")
    flank = tmp_path / "arcs.csv"
    flank.write_text(
        "s,t,deviation_um,flank\n" + "".join(f"{s},{t},1,right\n" for s in (0.1, 0.5, 0.9) for t in (0.1, 0.9))
    )
    with pytest.raises(GearmeshError, match="machine settings"):
        correct_settings(arcs, "pinion", flank)


@pytest.mark.sweep
def test_the_sample_that_was_measured_says_what_was_off() -> None:
    """Its own text: 0.06 mm of the blank's offset and 1 arcmin of the root angle, with 0.5 um of noise."""
    made = gm.build(gm.load(SAMPLES / "hypoid_measured.toml")).correct(
        "pinion", settings=["concave.machining_offset", "machine_root_angle"]
    )
    for change, off, spread in zip(made.solution.changes, (0.06, 1.0 / 60.0), made.solution.uncertainties, strict=True):
        assert abs(change + off) < 3.0 * spread < 0.15 * off
    assert made.solution.noise == pytest.approx(5e-4, rel=0.2)


@pytest.mark.sweep
def test_one_flank_of_a_measured_design_counts_alone() -> None:
    gears = gm.build(gm.load(SAMPLES / "hypoid_measured.toml"))
    whole, left = (gears.evaluate("pinion", flank=flank).figures.flanks for flank in ("both", "left"))
    assert list(left) == ["left"]
    assert left["left"].row == whole["left"].row
    made = gears.correct("pinion", settings=["convex.radial"], flank="left")
    assert list(made.figures.residuals) == ["left"]
    with pytest.raises(GearmeshError, match=r"missing; allowed is a file, or measured[.]gear_left of the design"):
        gears.evaluate("gear", flank="left")
    with pytest.raises(GearmeshError, match="flank = top: must be one of"):
        gears.evaluate("pinion", flank="top")
