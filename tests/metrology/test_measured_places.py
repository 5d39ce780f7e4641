"""Teeth at the places that the table `measured` of a design says: closed forms of eccentric spur gears, files and lists, solids."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, load
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.kinds import Side
from gearmesh.metrology.pitch import BallInSpace, MeasuredPitch, PitchDeviations
from gearmesh.systems.system import system_of
from gearmesh.teeth.micro_geometry.placed_teeth import turned_grid

SPUR = ("pinion.teeth=16", "gear.teeth=32", "assembly.center_distance=72")
#: an eccentricity, mm, and its direction, rad
SIZE, PHASE = 0.02, 0.7


def ball_of(gears: gm.Gears, name: str) -> BallInSpace:
    inspection = system_of(gears.design).inspection
    assert inspection is not None
    ball = inspection(gears.design, gears.train, name).ball
    assert ball is not None
    return ball


def spur(*keys: str) -> gm.Gears:
    return gm.build(load(SAMPLES / "spur.toml", [*SPUR, *keys]))


def as_key(key: str, mm: Array) -> str:
    return f"measured.{key}_um={json.dumps((1e3 * mm).tolist())}"


@pytest.mark.parametrize(("sample", "name"), [("helical", "pinion"), ("internal", "gear")])
def test_an_eccentric_gear_in_closed_form(sample: str, name: str) -> None:
    """Its pitch deviations are those of its exact flanks on the reference circle, displaced; a ball rides on them as on the
    eccentricity, and from runout and one side, or from runout alone, the other deviations come back."""
    gears = built_sample(sample)
    member, ball = gears.train.members[name], ball_of(gears, name)
    teeth = member.tooth.teeth
    inspection = system_of(gears.design).inspection
    assert inspection is not None
    radius = 0.5 * inspection(gears.design, gears.train, name).sizes.diameter
    closed = ball.eccentric(SIZE, PHASE, teeth)
    turns = 2.0 * np.pi * np.arange(teeth) / teeth
    for side in Side:
        # the flank's point at the reference circle, mid face, and its transverse normal
        grid = member.tooth.flank_grid(side, np.linspace(0.0, 1.0, 4001), [0.5])
        k = int(np.abs(np.hypot(*grid.points[:, 0, :2].T) - radius).argmin())
        (x, y, _), (n_x, n_y, _) = grid.points[k, 0], grid.normals[k, 0]
        along = n_x * np.cos(PHASE - turns) + n_y * np.sin(PHASE - turns)
        exact = SIZE * along * radius / (x * n_y - y * n_x)
        assert closed[side].index == pytest.approx(exact, abs=2e-3 * SIZE)
    right, left = closed[Side.RIGHT], closed[Side.LEFT]
    heights = ball.heights(right, left)
    spaces = turns - np.pi / teeth
    assert np.abs(heights) == pytest.approx(np.abs(SIZE * np.cos(PHASE - spaces)), abs=1e-12)
    assert ball.eccentricity(right, left) == pytest.approx(SIZE, abs=1e-12)
    uneven = heights + 1e-3 * np.random.default_rng(2).normal(size=teeth)
    for given in ({Side.RIGHT: right}, {Side.LEFT: left}, {}):
        made = MeasuredPitch(given, uneven).complete(ball)
        assert ball.heights(made[Side.RIGHT], made[Side.LEFT]) == pytest.approx(uneven - uneven.mean(), abs=1e-12)
        assert all(made[side] is own for side, own in given.items())
    alone = MeasuredPitch({}, heights).complete(ball)
    assert alone[Side.LEFT].index == pytest.approx(left.index, abs=1e-12)


@pytest.mark.sweep
def test_runout_of_a_spur_gear_makes_its_composite_deviations() -> None:
    """An eccentricity e turns the gear by waves of amplitude e / r_b, and moves the axes by 2 e when both flanks touch: less what
    steps of whole teeth leave out."""
    teeth = 16
    ball = ball_of(spur(), "pinion")
    closed = ball.eccentric(SIZE, PHASE, teeth)
    heights = ball.heights(closed[Side.RIGHT], closed[Side.LEFT])
    gears = spur(as_key("pinion_runout", heights))
    test = gears.composite()
    # half a pitch away from the middle of the steps, and what a step is of the wave
    step = 1.0 - math.cos(np.pi / teeth)
    waves = {(wave.member, wave.per_turn): wave.amplitude for wave in test.single.waves}
    base = 48.0 * math.cos(math.radians(20.0))
    assert waves["pinion", 1] == pytest.approx(SIZE / base, rel=2.0 * step)
    assert test.figures.double_flank_total == pytest.approx(2e3 * SIZE, rel=5.0 * step)
    assert test.figures.turns_pinion == 1.0
    eccentric = spur(f"assembly.pinion_eccentricity={SIZE}", f"assembly.pinion_phase={math.degrees(PHASE)}")
    real = {(w.member, w.per_turn): w for w in whole_turns(eccentric.pairs[0]).waves}["pinion", 1]
    own = next(wave for wave in test.single.waves if (wave.member, wave.per_turn) == ("pinion", 1))
    assert own.amplitude == pytest.approx(real.amplitude, rel=2.0 * step)
    # the wave of teeth is as long behind as half of what one takes over from another
    assert math.remainder(own.crest - real.crest, 2.0 * np.pi) == pytest.approx(0.0, abs=np.pi / teeth)


def test_files_and_lists_of_pitch_deviations_are_one(tmp_path: Path) -> None:
    file = tmp_path / "pitch.csv"
    index = 8.0 * np.cos(2.0 * np.pi * np.arange(16) / 16)
    file.write_text("tooth,right_um,left_um\n" + "".join(f"{k},{x},{x + 1.0}\n" for k, x in enumerate(index)))
    by_file = spur(f"measured.pinion_pitch={file}").members["pinion"].index
    by_list = spur(*(as_key(f"pinion_pitch_{side}", 1e-3 * index) for side in Side)).members["pinion"].index
    # the mean of a side does not count
    for side in Side:
        assert by_file.of(side, 16) == pytest.approx(index * 1e-3 / 24.0, abs=1e-15)
        assert by_list.of(side, 16) == pytest.approx(by_file.of(side, 16), abs=1e-15)


@pytest.mark.sweep
def test_commands_roll_measured_teeth(tmp_path: Path) -> None:
    file, chart = tmp_path / "pitch.csv", tmp_path / "turns.png"
    index = 8.0 * np.cos(2.0 * np.pi * np.arange(16) / 16)
    file.write_text("tooth,right_um,left_um\n" + "".join(f"{k},{x},{x}\n" for k, x in enumerate(index)))
    keys = [part for key in (*SPUR, f"measured.pinion_pitch={file}") for part in ("--set", key)]
    assert run("composite", SAMPLES / "spur.toml", *keys, "--json", tmp_path / "c.json", "-o", chart)[0] == 0
    assert run("tca", SAMPLES / "spur.toml", *keys, "--turns", "--csv", tmp_path / "t.csv")[0] == 0
    own = json.loads((tmp_path / "c.json").read_text())
    te = [float(row["te_arcsec"]) for row in csv.DictReader((tmp_path / "t.csv").open())]
    assert own["single_flank_te_arcsec"] == pytest.approx(np.ptp(te), abs=1e-9)
    # the deviations of the pinion are arcs of its own circle, that of the gear is twice as large
    assert np.ptp(te) == pytest.approx(16e-3 / 48.0 / ARCSEC, rel=0.05)
    assert chart.stat().st_size > 10_000
    answer = spur(f"measured.pinion_pitch={file}").evaluate("pinion")
    assert answer.figures.flanks["left"].pitch is not None
    assert answer.deviations["F_p"] == pytest.approx(16.0)


@pytest.mark.sweep
def test_teeth_of_a_solid_are_at_their_places() -> None:
    """Vertices of its flanks, against the nominal involute turned by whole pitches; the flank that is turned is found along the
    normals of its place."""
    index = 1e-3 * (20.0 * np.cos(2.0 * np.pi * np.arange(16) / 16) + np.arange(16) % 3)
    gears = spur(as_key("pinion_pitch_right", index))
    solid = gears.solid("pinion", 0.01)
    assert not solid.complaints
    tooth, mesh = gears.members["pinion"].tooth, solid.mesh
    line = tooth.flank_grid(Side.RIGHT, np.linspace(0.0, 1.0, 801), [0.5]).points[:, 0]
    names = [str(name) for name in mesh.region_names]
    for side, wanted in ((Side.RIGHT, index - index.mean()), (Side.LEFT, np.zeros(16))):
        r = mesh.vertices[np.unique(mesh.triangles[mesh.regions == names.index(f"flank_{side}")])]
        radii = np.hypot(r[:, 0], r[:, 1])
        own, radii = r[radii > 22.7], radii[radii > 22.7]
        place = np.interp(radii, np.hypot(line[:, 0], line[:, 1]), np.arctan2(line[:, 1], line[:, 0]))
        place = place if side is Side.RIGHT else -place
        away = np.arctan2(own[:, 1], own[:, 0]) - place
        number = np.round(away / (np.pi / 8.0)).astype(int)
        arcs = 24.0 * (away - number * np.pi / 8.0)
        assert set(number % 16) == set(range(16))
        assert arcs == pytest.approx(wanted[number % 16], abs=1e-5)
    grid = turned_grid(tooth, Side.RIGHT, 1e-3)
    base = 24.0 * math.cos(math.radians(20.0))
    # involutes of one base circle are parallel: turned forwards a right flank is inside of its place
    assert grid.values == pytest.approx(-1e-3 * base, abs=1e-9)


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (["measured.pinion_pitch_right_um=[1,2]"], "measured.pinion_pitch_right_um = 2 values: must be 16 values"),
        (["measured.pinion_runout_um=[]"], "measured.pinion_runout_um = 0 values: must be 16 values"),
        (["measured.pinion_pitch_left_um=[1,2000]"], "measured.pinion_pitch_left_um"),
        (["measured.pinion_pitch=nowhere.csv"], "nowhere.csv"),
        (
            ["measured.pinion_pitch=nowhere.csv", "measured.pinion_runout_um=[1]"],
            "cannot be given together with measured.pinion_pitch",
        ),
        (
            ["measured.pinion_pitch_seed=3", "measured.pinion_runout_um=[1]"],
            "measured.pinion_pitch_seed = 3: cannot be given together with measured.pinion_runout_um",
        ),
        (["measured.pinion_pitch_class=12"], "measured.pinion_pitch_class = 12: must be a whole number from 1 to 11"),
    ],
)
def test_wrong_pitch_deviations_are_refused(keys: list[str], message: str) -> None:
    told = refused("tca", SAMPLES / "spur.toml", *(part for key in (*SPUR, *keys) for part in ("--set", key)))
    assert message in told


def test_wrong_files_of_pitch_deviations_are_refused(tmp_path: Path) -> None:
    file = tmp_path / "pitch.csv"
    for text, message in (
        ("tooth,right_um\n0,1\n0,2\n", "line 3: tooth 0 is given twice"),
        ("tooth,right_um\n0,nan\n", 'line 2: right_um = "nan": must be a finite number'),
        ("tooth,right_um\n0,5000\n", "line 2: 5000 um, at most 1000"),
        ("tooth,right\n0,1\n", "line 1: allowed is tooth, and right_um, left_um and runout_um"),
        ("tooth,runout_um\n" + "".join(f"{k},1\n" for k in range(15)), "has no tooth 15; the gear has 16"),
    ):
        file.write_text(text)
        assert message in refused(
            "tca", SAMPLES / "spur.toml", *(p for k in (*SPUR, f"measured.pinion_pitch={file}") for p in ("--set", k))
        )


@pytest.mark.sweep
def test_runout_of_a_bevel_gear_needs_pitch_deviations() -> None:
    teeth = built_sample("spiral_bevel_basic").train.members["pinion"].tooth.teeth
    design = load(SAMPLES / "spiral_bevel_basic.toml", [as_key("pinion_runout", np.zeros(teeth))])
    with pytest.raises(DesignError, match=r"measured\.pinion_runout_um: how a ball rests in its spaces is not known"):
        gm.build(design).train  # noqa: B018
    assert PitchDeviations.of_single([0.0, 1.0]).index.tolist() == [-0.5, 0.0]


def loaded_spur(pinion: Array, positions: Array, torque: float, *keys: str) -> gm.LoadedContact:
    """Under a torque, Nm, at pinion rotations, rad, with index deviations (16,), mm, of the pinion's right flanks."""
    gears = spur(*keys, as_key("pinion_pitch_right", pinion), as_key("pinion_pitch_left", pinion))
    return gears.loaded_contact([torque], np.degrees(positions))


@pytest.mark.sweep
def test_load_meets_the_flanks_where_they_are() -> None:
    """Under hardly any torque the error is that over whole turns; and a tooth that is far behind carries nothing of a large one."""
    index = 1e-3 * np.random.default_rng(5).normal(scale=4.0, size=16)
    gears = spur(as_key("pinion_pitch_right", index), as_key("pinion_pitch_left", index))
    turns = whole_turns(gears.train.pairs[0])
    k = np.array([3, 40, 97, 170])
    light = loaded_spur(index, turns.phi1[k], 1e-3)
    apart = light.mesh.unloaded - turns.te[k]
    assert np.ptp(turns.te[k]) > 5.0 * ARCSEC
    assert np.ptp(apart) < 1e-8
    # the tooth that meets the gear at phi1 = 0 is behind, as angles fall with phi1; or ahead, and has it all
    apart = np.zeros(16)
    apart[0] = 0.2
    at = gears.train.pairs[0].pitch * np.array([-0.2, 0.0, 0.3])
    for index, alone in ((apart, False), (-apart, True)):
        (load,) = loaded_spur(index, at, 100.0).mesh.loads
        for k in range(at.size):
            force = load.force[load.position == k]
            own = force[load.number[load.position == k] == 0].sum()
            assert force.sum() > 1000.0
            assert own == pytest.approx(force.sum() if alone else 0.0)


@pytest.mark.sweep
def test_bodies_that_repeat_a_tooth_say_so(tmp_path: Path) -> None:
    gears = spur(as_key("pinion_pitch_right", 1e-3 * np.arange(16.0)))
    line = "pinion: its teeth are at their nominal places"
    assert any(warning.startswith(line) for warning in gears.finite_elements(members=("pinion",)).warnings)
    assert any(warning.startswith(line) for warning in gears.cad("pinion").warnings)
