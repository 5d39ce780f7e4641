"""Trains of several stages: kinematics, positions, overlap of solids, transmission error, refusals."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair
from gearmesh.check.roll import roll
from gearmesh.contact.engagement.cycle import gears_curve
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.train_turns import leading_turns
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.kinds import Side
from gearmesh.systems.cylindrical.planetary.motion import phases
from gearmesh.trains.bodies import bodies_of
from gearmesh.trains.layout import layout_of, stages_of
from gearmesh.trains.stage import Stage

TWO_STAGE = SAMPLES / "trains" / "train_two_stage.toml"
PLANETARY = SAMPLES / "trains" / "train_planetary.toml"
#: tolerance, mm, of the solids that are looked at for overlap
TOLERANCE_MM = 0.02
#: area, mm^2, of the flanks in contact, above that of the largest contact zone of the samples
FLANK_AREA_MM2 = 200.0

#: a straight bevel pair whose gear drives a helical pinion on its shaft
BEVEL_AND_HELICAL: dict[str, Any] = {
    "kind": "train",
    "stages": {
        "bevel": {
            "kind": "straight_bevel",
            "module": 3,
            "face_width": 16,
            "backlash": 0.08,
            "pinion": {"teeth": 16},
            "gear": {"teeth": 31},
        },
        "helical": {
            "kind": "cylindrical",
            "module": 2,
            "helix_angle": 20,
            "backlash": 0.06,
            "pinion": {"teeth": 19, "face_width": 20},
            "gear": {"teeth": 58, "face_width": 18},
        },
    },
    "shafts": {
        "input": {"members": ["bevel.pinion"]},
        "middle": {"members": ["bevel.gear", {"member": "helical.pinion", "position": 60, "turn": 90, "phase": 7}]},
        "output": {"members": ["helical.gear"]},
    },
}


@pytest.fixture(scope="module")
def two_stage() -> gm.MultistageTrain:
    return gm.load_train(TWO_STAGE)


@pytest.fixture(scope="module")
def planetary() -> gm.MultistageTrain:
    return gm.load_train(PLANETARY)


@pytest.fixture(scope="module")
def bevel() -> gm.MultistageTrain:
    return gm.load_train(BEVEL_AND_HELICAL)


# ---------------------------------------------------------------- kinematics


@pytest.mark.quick
def test_external_pairs_turn_against_each_other_by_the_ratio_of_their_teeth(two_stage: gm.MultistageTrain) -> None:
    speeds = {shaft.shaft: shaft.speed_fraction for shaft in two_stage.shafts}
    assert speeds == {"input": "1", "middle": "-1/2", "output": str(Fraction(24, 48) * Fraction(17, 53))}
    assert two_stage.figures.ratio == pytest.approx(48 / 24 * 53 / 17, rel=1e-15)
    torques = [shaft.torque * shaft.speed for shaft in two_stage.shafts]
    assert torques == pytest.approx([1.0, 1.0, 1.0], rel=1e-15)
    # the same two teeth: lcm(24, 48) = 48 teeth of a pinion of 24; lcm(17, 53) teeth of a pinion that turns half as fast
    assert [mesh.turns_until_repeat for mesh in two_stage.meshes] == [2.0, 2.0 * 53]
    assert [mesh.hunting for mesh in two_stage.meshes] == [False, True]
    assert two_stage.figures.turns_until_repeat == 106.0


def willis(sun: int, ring: int, fixed: str, driver: str) -> dict[str, float]:
    """Speeds of a planetary set, from (n_sun - n_c) z_sun + (n_ring - n_c) z_ring = 0 as linear equations."""
    names = ["sun", "ring", "carrier"]
    rows = [[sun, ring, -(sun + ring)], [name == fixed for name in names], [name == driver for name in names]]
    return dict(zip(names, np.linalg.solve(np.array(rows, dtype=float), [0.0, 0.0, 1.0]), strict=True))


@pytest.fixture(scope="module")
def planets() -> Stage:
    """A set of two planets, whose meshes are solved once."""
    return Stage.of("set", gm.build(gm.load(SAMPLES / "planetary.toml", ["planets=2"])))


@pytest.mark.quick
@pytest.mark.parametrize(
    ("fixed", "driver"), [("ring", "sun"), ("ring", "carrier"), ("carrier", "ring"), ("sun", "ring")]
)
@pytest.mark.sweep_cases("ring-sun")
def test_planetary_stages_turn_as_willis_says(fixed: str, driver: str, planets: Stage) -> None:
    """Also in contact: flanks without modifications turn uniformly."""
    stage = replace(planets, fixed=fixed)
    speeds = {name: float(speed) for name, speed in stage.speeds(driver).items()}
    wanted = willis(18, 72, fixed, driver)
    assert speeds == pytest.approx(wanted, abs=1e-15)
    theta = np.array([0.0, 0.4, 3.0])
    for sense in (1, -1):
        turned = stage.driving(driver, sense).follow({driver: theta})
        for name, speed in wanted.items():
            assert turned[name] - turned[name][0] == pytest.approx(speed * theta, abs=2e-11), (sense, name)
    # what is driven drives back: the relation is solved either way
    (driven,) = (name for name in stage.free if name != driver)
    back = stage.follow({driven: stage.follow({driver: theta})[driven]})
    assert back[driver] == pytest.approx(theta, abs=1e-12)


@pytest.mark.quick
def test_carrier_and_pinion_of_a_train_turn_as_one(planetary: gm.MultistageTrain) -> None:
    carrier = willis(18, 72, "ring", "sun")["carrier"]
    assert {shaft.shaft: shaft.speed for shaft in planetary.shafts} == pytest.approx(
        {"input": 1.0, "middle": carrier, "output": -carrier * 17 / 53}, rel=1e-14
    )
    assert [shaft.torque * shaft.speed for shaft in planetary.shafts] == pytest.approx([1.0] * 3, rel=1e-14)


def set_of_phases(planets: int) -> dict[str, Any]:
    """A set in which planets mesh at different phases with the 19 teeth of the sun."""
    tables = {"design": str(SAMPLES / "planetary.toml"), "planets": planets, "sun": {"teeth": 19}, "planet": {"teeth": 26},
              "ring": {"teeth": -71}}  # fmt: skip
    shafts = {"input": {"members": ["set.sun"]}, "output": {"members": ["set.carrier"]}}
    return {"kind": "train", "stages": {"set": tables}, "shafts": shafts}


@pytest.mark.sweep
@pytest.mark.parametrize("reverse", [False, True])
@pytest.mark.sweep_cases("False")
def test_phases_of_planets_are_those_of_the_set(reverse: bool) -> None:
    """19 teeth of the sun in thirds of a turn: three phases, in both senses."""
    train = gm.load_train({**set_of_phases(3), "reverse": reverse})
    flank = gm.load(SAMPLES / "planetary.toml").contact.flank
    sense = (1 if flank == "right" else -1) * (-1 if reverse else 1)
    wanted = np.array(phases(19, [0.0, 120.0, 240.0], sense))
    own = np.array([mesh.phase for mesh in train.meshes])
    for first in (0, 3):
        apart = own[first : first + 3] - own[first] - wanted
        assert apart - np.round(apart) == pytest.approx(np.zeros(3), abs=1e-6), first


@pytest.mark.sweep
def test_planets_move_as_their_own_meshes_say() -> None:
    """Without the curve of the first planet, the relation of the second one is the same."""
    stage = Stage.of("set", gm.build(gm.load_train(set_of_phases(2)).file.stages["set"]))
    theta, path = np.linspace(0.0, 1.0, 5), stage.paths[1]
    known, turned = path.output(theta)[-1], theta
    for mesh in path.meshes:
        phi1 = mesh.phi1(turned)
        phi2, mount = leading_turns(mesh.pair, phi1)[1], mesh.pair.gear.mount
        turned = mesh.ahead[1] + mount.sign * (phi2 - mount.zero)
    pitch, apart = 2.0 * np.pi / 71, turned - known
    assert apart - np.round(apart / pitch) * pitch == pytest.approx(np.zeros(5), abs=1e-9)


# ---------------------------------------------------------------- positions


def test_axes_are_where_the_shafts_have_them(bevel: gm.MultistageTrain) -> None:
    shafts = {shaft.shaft: shaft for shaft in bevel.shafts}
    axis = {name: np.array(shaft.axis) for name, shaft in shafts.items()}
    assert abs(axis["input"] @ axis["middle"]) < 1e-12
    assert axis["middle"] == pytest.approx(axis["output"], abs=1e-12)
    between = np.array(shafts["output"].origin) - np.array(shafts["middle"].origin)
    distance = 2 * (19 + 58) / (2 * math.cos(math.radians(20)))
    assert np.linalg.norm(np.cross(between, axis["middle"])) == pytest.approx(distance, abs=1e-9)
    # turned by 90 deg from the plane of both bevel axes
    across = between - (between @ axis["middle"]) * axis["middle"]
    assert across @ axis["input"] == pytest.approx(0.0, abs=1e-9)
    assert shafts["output"].speed == pytest.approx(
        -16 / 31 * -19 / 58 * (1 if shafts["middle"].speed < 0 else -1), rel=1e-12
    )
    places = bevel.places(33.0)
    assert places["helical.pinion"].translation @ axis["middle"] == pytest.approx(60.0, abs=1e-9)


def test_turn_is_counted_from_straight_on_for_offset_axes_too() -> None:
    """A hypoid pinion's mate is beside its own x axis: at turn 0 both gears of the input are on opposite sides of it."""
    pair = {
        "kind": "cylindrical",
        "module": 2,
        "pinion": {"teeth": 20, "face_width": 10},
        "gear": {"teeth": 40, "face_width": 10},
    }
    stages: dict[str, Stage] = {}
    for reversed_pinion, turn in ((False, 0.0), (True, 0.0), (False, 50.0)):
        train = gm.load_train(
            {
                "kind": "train",
                "stages": {"a": pair, "b": {"design": str(SAMPLES / "hypoid.toml")}},
                "shafts": {
                    "input": {
                        "members": [
                            "a.pinion",
                            {"member": "b.pinion", "position": 90, "turn": turn, "reversed": reversed_pinion},
                        ]
                    },
                    "one": {"members": ["a.gear"]},
                    "other": {"members": ["b.gear"]},
                },
            }
        )
        stages = stages or stages_of(train.file)
        layout = layout_of(train.file, stages)
        axis, (first, second) = layout.shafts["input"].frame.rotation[:, 2], layout.steps
        wheel = second.stage.gears.train.members["gear"]
        middle = (second.place @ wheel.mount.base).point(
            np.array([0.0, 0.0, second.stage.gears.train.pairs[0].middle(wheel)])
        )
        away = middle - np.array([0.0, 0.0, 90.0])
        away -= (away @ axis) * axis
        angle = math.atan2(np.cross(first.place.rotation[:, 0], away) @ axis, first.place.rotation[:, 0] @ away)
        assert math.degrees(angle) % 360.0 == pytest.approx(180.0 + turn, abs=1e-6), (reversed_pinion, turn)


class Overlaps:
    """Volumes that pairs of solids of a train have in common; the solids are made once, and moved."""

    def __init__(self, train: gm.MultistageTrain, tolerance: float) -> None:
        self.train = train
        self.solids = {name: part.to_manifold() for name, part in train.solids(tolerance).parts.items()}
        self.start = {body.name: body.place for body in bodies_of(train.layout, 0.0)}

    def at(self, phi: float) -> dict[tuple[str, str], float]:
        """Volumes above 0, mm^3, at a rotation of the input, deg."""
        moved = {}
        for body in bodies_of(self.train.layout, math.radians(phi)):
            motion = body.place @ self.start[body.name].inverse
            moved[body.name] = self.solids[body.name].transform(np.column_stack((motion.rotation, motion.translation)))
        common = {pair: float((moved[pair[0]] ^ moved[pair[1]]).volume()) for pair in combinations(moved, 2)}
        return {pair: volume for pair, volume in common.items() if volume > 0.0}


@pytest.mark.parametrize("name", ["two_stage", "planetary", "bevel"])
@pytest.mark.sweep
def test_no_two_solids_overlap_at_20_rotations(name: str, request: pytest.FixtureRequest) -> None:
    """Beyond the tolerance of both meshes on the flanks in contact; bodies that do not mesh have nothing in common."""
    train: gm.MultistageTrain = request.getfixturevalue(name)
    meshing = [{f"{m.stage}.{word}" for word in m.mesh.split("-")} for m in train.meshes]
    speed = min(abs(shaft.speed) for shaft in train.shafts)
    overlaps = Overlaps(train, TOLERANCE_MM)
    for phi in np.linspace(0.0, 360.0 / speed, 20, endpoint=False):
        for pair, volume in overlaps.at(float(phi)).items():
            names = {"first.gear": "middle", "second.pinion": "middle"} if name == "two_stage" else {}
            assert any({names.get(word, word) for word in own} == set(pair) for own in meshing), (phi, pair)
            assert volume < 2.0 * TOLERANCE_MM * FLANK_AREA_MM2, (phi, pair, volume)


@pytest.mark.sweep
def test_teeth_touch_and_do_not_overlap(two_stage: gm.MultistageTrain) -> None:
    """The output turned back by little is free of all solids, turned ahead it is not: it is where the contact has it."""
    tolerance = 0.005
    solids = two_stage.solids(tolerance, phi=77.0)
    bodies = {name: part.to_manifold() for name, part in solids.parts.items()}
    assert all(part.measured.watertight for part in solids.parts.values())
    assert (bodies["first.pinion"] ^ bodies["second.gear"]).volume() == 0.0
    shaft = two_stage.layout.shafts["output"].frame
    sense = two_stage.layout.sense * (1 if two_stage.layout.speeds["output"] > 0 else -1)
    for ahead, free in ((3.0, True), (-3.0, False)):
        # the tolerance of both meshes at the pitch radius of the gear, 81 mm
        angle = sense * ahead * tolerance / 81.0
        moved = shaft @ gm.Rigid.about_z(angle) @ shaft.inverse
        turned = bodies["second.gear"].transform(np.column_stack((moved.rotation, moved.translation)))
        assert ((turned ^ bodies["middle"]).volume() == 0.0) == free, ahead


def test_gears_of_a_joined_shaft_are_one_body(two_stage: gm.MultistageTrain) -> None:
    solids = two_stage.solids(0.05)
    assert list(solids.parts) == ["first.pinion", "middle", "second.gear"]
    body = solids.parts["middle"].to_manifold()
    assert len(body.decompose()) == 1
    assert body.genus() == 1
    apart = two_stage.file.stages
    volumes = {
        name: gm.build(apart[stage]).solid(member, 0.05).measured.volume or 0.0
        for name, stage, member in (("gear", "first", "gear"), ("pinion", "second", "pinion"))
    }
    # hub and pinion meet in a plane: nothing is lost
    assert solids.parts["middle"].measured.volume == pytest.approx(sum(volumes.values()), rel=1e-6)
    mesh = solids.parts["middle"].mesh
    assert {"flank_left", "hub", "bore"} <= {str(mesh.region_names[k]) for k in np.unique(mesh.regions)}


# ---------------------------------------------------------------- transmission error


def rolled_turns(pair: GearPair, phi1: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Rotations (N,), rad, of the gear by a roll of grids of exact points, of the most advanced of three tooth pairs.

    The roll knows distances of two flanks alone: neither the equations of contact nor curves over a pitch.
    """
    grids = [
        member.tooth.flank_grid(side, np.linspace(0, 1, 81), np.linspace(0, 1, 81)).points
        for member, side in zip(pair.both, pair.flanks, strict=True)
    ]
    pitches = np.round(phi1 / pair.pitch)[:, None] + np.arange(-1.0, 2.0)
    at = (phi1[:, None] - pitches * pair.pitch).ravel()
    contacts = roll(*grids, pair.mounts, pair.ratio, at, pair.drive, pair.delta, pair.ratio * at)
    phi2 = np.array([contact.phi2 for contact in contacts]).reshape(pitches.shape) + pitches * pair.pitch * pair.ratio
    ahead: np.ndarray[Any, Any] = pair.drive * np.nanmax(pair.drive * phi2, axis=1)
    return ahead


def touched_turns(pair: GearPair, phi1: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Rotations (N,), rad, of the gear by first touch of all teeth near phi1."""
    return leading_turns(pair, phi1)[1]


def chained(
    train: gm.MultistageTrain,
    phi: np.ndarray[Any, Any],
    turns: Callable[[GearPair, np.ndarray[Any, Any]], np.ndarray[Any, Any]] = touched_turns,
) -> np.ndarray[Any, Any]:
    """Rotation of the output, rad, by the `turns` of both stages at every position, one after the other.

    The sample is in line: a member's rotation is that of its shaft, and that of the second pinion 3 deg more.
    """
    flanks = {1: ("left", "right"), -1: ("right", "left")}
    first, second = (gm.build(design).train.pairs[0] for design in train.file.stages.values())
    out, lead = np.asarray(phi, dtype=float), [0.0, math.radians(3.0)]
    for stage, pair, phase in zip(("first", "second"), (first, second), lead, strict=True):
        theta = out + phase
        forward = train.layout.sense * (1 if stage == "first" else -1) * pair.pinion.mount.sign
        if forward * pair.drive < 0:
            # the flanks that carry when the pinion turns so
            side = flanks[1][0] if pair.flanks[0] == "right" else "right"
            pair = gm.build(train.file.stages[stage].with_values({"contact.flank": side})).train.pairs[0]
            assert pair.drive == forward
        mount = pair.pinion.mount
        phi2 = turns(pair, mount.zero + mount.sign * theta)
        out = pair.gear.mount.sign * (phi2 - pair.gear.mount.zero)
    return out


def test_output_error_is_that_of_both_stages_rolled_one_after_the_other(two_stage: gm.MultistageTrain) -> None:
    """Against an own chain of first touches, which knows neither curve nor sum."""
    phi = two_stage.layout.sense * np.sort(np.random.default_rng(7).uniform(0.0, 2.0 * np.pi * 6.2, 40))
    phi[0] = 0.0
    rolled = chained(two_stage, phi)
    followed = two_stage.layout.turns(phi)["output"]
    pitch = 2.0 * np.pi / 53
    apart = followed - rolled
    assert apart - np.round(apart / pitch) * pitch == pytest.approx(np.zeros(len(phi)), abs=1e-9)
    te = np.unwrap(rolled - rolled[0] - phi / two_stage.figures.ratio, period=pitch)
    te -= np.round(te / pitch) * pitch
    error = two_stage.transmission_error()
    known = np.interp(np.abs(phi), error.solved.psi, error.solved.te)
    assert np.ptp(te) / ARCSEC > 5.0
    # 12 positions a pitch, between which errors of 10 arcsec are interpolated
    assert (known - te) / ARCSEC == pytest.approx(np.zeros(len(phi)), abs=0.15)
    exact = sum_at(two_stage, phi)
    # of second order: 5 arcsec of the first stage times the slope of the error of the second, 1e-3
    assert (exact - te) / ARCSEC == pytest.approx(np.zeros(len(phi)), abs=0.02)


@pytest.mark.sweep
def test_output_error_is_that_of_a_roll_of_both_stages(two_stage: gm.MultistageTrain) -> None:
    """The roll of exact points of both stages, the second from where the first leaves it: within 0.02 arcsec of the sum of 7."""
    solved = two_stage.transmission_error().solved
    chosen = np.append(0, np.sort(np.random.default_rng(3).integers(1, len(solved.psi), 5)))
    phi = two_stage.layout.sense * solved.psi[chosen]
    rolled = chained(two_stage, phi, rolled_turns)
    pitch = 2.0 * np.pi / 53
    te = rolled - rolled[0] - phi / two_stage.figures.ratio
    te -= np.round(te / pitch) * pitch
    assert np.ptp(te) / ARCSEC > 3.0
    assert (solved.te[chosen] - te) / ARCSEC == pytest.approx(np.zeros(len(phi)), abs=0.02)


def sum_at(train: gm.MultistageTrain, phi: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    """Sum of the errors of both stages at rotations of the input, by the curves of their meshes."""
    start = train.layout.turns(np.zeros(1))
    total, psi, behind = np.zeros(len(phi)), np.asarray(phi, dtype=float), [-17 / 53, 1.0]
    for step, gain in zip(train.layout.steps, behind, strict=True):
        source, driver = step.driver
        at = driver.theta(start[source]) + psi
        error = step.stage.relation(at) - float(step.stage.slope) * at
        zero = driver.theta(start[source])
        total += gain * (error - (step.stage.relation(zero) - float(step.stage.slope) * zero))
        psi = psi * float(step.stage.slope)
    return total


@pytest.mark.sweep
def test_output_error_has_the_pitch_deviations_of_a_stage() -> None:
    """Errors of the gears of one stage as their own contact over whole turns has them: 30 um of one tooth, not 0."""
    places = [0.0] * 32
    places[5] = 30.0
    pair = {
        "kind": "cylindrical",
        "module": 3,
        "pinion": {"teeth": 16, "face_width": 20},
        "gear": {"teeth": 32, "face_width": 20},
    }
    measured = {f"gear_pitch_{side}_um": places for side in Side}
    shafts = {"input": {"members": ["pair.pinion"]}, "output": {"members": ["pair.gear"]}}
    train = gm.load_train({"kind": "train", "stages": {"pair": {**pair, "measured": measured}}, "shafts": shafts})
    error = train.transmission_error(turns=2.0).figures.te_peak_to_peak
    (mesh,) = gm.build(gm.parse({**pair, "measured": measured})).pairs
    assert error == pytest.approx(whole_turns(mesh).peak_to_peak / ARCSEC, rel=1e-3)
    # an angle of 30 um on the pitch circle of 96 mm, less what the neighbours of the tooth take over
    assert error > 0.5 * 0.03 / 48.0 / ARCSEC


def test_conjugate_stages_have_no_error(planetary: gm.MultistageTrain) -> None:
    error = planetary.transmission_error(turns=1.0)
    assert error.figures.te_peak_to_peak < 1e-4
    assert error.to_dict()["te_arcsec"][0] == 0.0


# ---------------------------------------------------------------- files and the command


def changed(**shafts: Any) -> dict[str, Any]:
    return {**BEVEL_AND_HELICAL, "shafts": {**BEVEL_AND_HELICAL["shafts"], **shafts}}


@pytest.mark.quick
@pytest.mark.parametrize(
    ("tables", "words"),
    [
        ({"kind": "cylindrical"}, 'kind = "cylindrical": must be "train"'),
        ({"kind": "train"}, "stages: must be tables with names"),
        ({**BEVEL_AND_HELICAL, "shaft": {}}, "shaft: unknown key; did you mean shafts?"),
        (changed(middle={"members": ["bevel.gea"]}), 'shafts.middle.members = "bevel.gea": no member of a stage that turns'),
        (changed(output={"members": ["bevel.pinion"]}), "it is on the shaft input already"),
        (changed(middle={"members": ["bevel.gear"]}), "stages.helical.pinion: it is on no shaft"),
        (changed(middle={"members": ["bevel.gear", "helical.pinion"]}), "position: missing"),
        (changed(middle={"member": ["bevel.gear"]}), "shafts.middle.member: unknown key; did you mean members?"),
        (
            changed(middle={"members": [{"member": "bevel.gear", "phas": 3}]}),
            "shafts.middle.members.bevel.gear.phas: unknown key; did you mean phase?",
        ),
        (
            changed(output={"members": ["helical.gear"], "coaxial": "input"}),
            'shafts.output.coaxial = "input": the shafts do not coincide',
        ),
        (changed(output={"members": []}), "shafts.output.members = []: must be a list of members"),
        ({**BEVEL_AND_HELICAL, "output": "wheel"}, 'output = "wheel": must be one of input, middle, output'),
        (
            {**BEVEL_AND_HELICAL, "stages": {**BEVEL_AND_HELICAL["stages"], "bevel": {"design": "rack.toml"}}},
            "stages.bevel.design: rack.toml: cannot be read",
        ),
        (
            {**BEVEL_AND_HELICAL, "stages": {**BEVEL_AND_HELICAL["stages"], "bevel": {"kind": "straight_bevel", "modul": 3}}},
            "stages.bevel.modul: unknown key; did you mean module?",
        ),
    ],
)  # fmt: skip
def test_wrong_trains_are_refused_in_one_line(tables: dict[str, Any], words: str) -> None:
    with pytest.raises(gm.DesignError) as refusal:
        _ = gm.load_train(tables).headline
    assert words in str(refusal.value)
    assert len(str(refusal.value).splitlines()) == 1


def loop(center_distance: float) -> dict[str, Any]:
    """Two pairs between the same shafts."""
    pair = {
        "kind": "cylindrical", "module": 2,
        "pinion": {"teeth": 20, "face_width": 10}, "gear": {"teeth": 40, "face_width": 10},
    }  # fmt: skip
    return {
        "kind": "train",
        "stages": {"a": pair, "b": {**pair, "assembly": {"center_distance": center_distance}}},
        "shafts": {
            "input": {"members": ["a.pinion", {"member": "b.pinion", "position": 30, "turn": 180}]},
            "output": {"members": ["a.gear", {"member": "b.gear", "position": 30}]},
        },
    }


@pytest.mark.quick
@pytest.mark.parametrize(
    ("distance", "teeth", "words"),
    [
        (60.4, 40, "0.4 mm and 0 deg apart"),
        (60.0, 39, r"b\.gear would turn it -20/39 times per turn of input, another stage or its speed -1/2 times"),
    ],
)
def test_loops_that_contradict_are_refused(distance: float, teeth: int, words: str) -> None:
    tables = loop(distance)
    tables["stages"]["b"]["gear"] = {**tables["stages"]["b"]["gear"], "teeth": teeth}
    with pytest.raises(gm.DesignError, match=words):
        _ = gm.load_train(tables).headline


def test_teeth_of_both_ways_of_a_loop_mesh() -> None:
    """Two pairs side by side: the second gear has the phase on its shaft with which it meshes, whatever that of its pinion is."""
    tables = loop(60.0)
    tables["shafts"]["input"]["members"][1]["phase"] = 4.0
    train = gm.load_train(tables)
    assert train.figures.ratio_fraction == "-2"
    steps = train.layout.steps
    assert [step.closes_loop for step in steps] == [False, True]
    # 4 deg of a pinion are 2 deg of its gear, the other way; a pitch of the gear is 9 deg
    seated = steps[1].driven[1]
    at_rest = gm.load_train(loop(60.0)).layout.steps[1].driven[1]
    apart = (seated.seat.phase - at_rest.seat.phase + 2.0) / 9.0
    assert apart == pytest.approx(round(apart), abs=1e-9)
    # on its shaft the gear is in mesh at any rotation: spur gears without modifications have no error
    for phi in (0.0, 13.0):
        psi = train.layout.turns(np.radians([phi]))["output"]
        place = train.places(phi)["b.gear"]
        shaft = train.layout.shafts["output"]
        own = shaft.frame @ seated.port_to_shaft
        turned = own.inverse @ place
        theta = np.arctan2(turned.rotation[1, 0], turned.rotation[0, 0])
        pitches = (theta - seated.theta(psi)) * 40 / (2.0 * np.pi)
        assert pitches == pytest.approx(np.round(pitches), abs=1e-9)
    error = train.transmission_error(1.0)
    assert list(error.solved.parts) == ["a"]


def differential(**shafts: dict[str, Any]) -> dict[str, Any]:
    """A planetary set, all of whose members turn."""
    members = {name: {"members": [f"set.{name}"], **shafts.get(name, {})} for name in ("sun", "ring", "carrier")}
    stage = {"design": str(SAMPLES / "planetary.toml"), "planets": 2}
    return {"kind": "train", "stages": {"set": stage}, "shafts": members}


@pytest.mark.quick
@pytest.mark.parametrize(("other", "speed"), [("ring", -0.25), ("ring", 0.0), ("carrier", 2.0)])
@pytest.mark.sweep_cases("carrier-2.0", "ring-0.0")
def test_differentials_turn_as_willis_says(other: str, speed: float) -> None:
    train = gm.load_train(differential(**{other: {"speed": speed}}))
    wanted = np.linalg.solve(
        [[18.0, 72.0, -90.0], [1.0, 0.0, 0.0], [0.0, float(other == "ring"), float(other == "carrier")]],
        [0.0, 1.0, speed],
    )
    found = {shaft.shaft: shaft for shaft in train.shafts}
    assert [found[name].speed for name in ("sun", "ring", "carrier")] == pytest.approx(wanted, abs=1e-15)
    # the power that comes in goes out: torques are in equilibrium, that of the driven shaft drives what follows
    driven = "carrier" if other == "ring" else "ring"
    power = {name: shaft.torque * shaft.speed for name, shaft in found.items()}
    assert power["sun"] + power[other] == pytest.approx(power[driven])
    # in contact, flanks without modifications turn uniformly, and gears in mesh are where the shafts are
    psi = train.layout.turns(np.array([0.0, 0.4, 3.0]))
    for name, own in zip(("sun", "ring", "carrier"), wanted, strict=True):
        assert psi[name] - psi[name][0] == pytest.approx(own * np.array([0.0, 0.4, 3.0]), abs=2e-11)
    assert train.transmission_error(0.1).figures.te_peak_to_peak < 1e-4


@pytest.mark.quick
@pytest.mark.parametrize(
    ("shafts", "words"),
    [
        ({}, r"^shafts\.ring\.speed: missing: a differential"),
        ({"sun": {"speed": 2}}, r"^shafts\.sun\.speed = 2: the speeds of other shafts are per turn of it"),
        (
            {"ring": {"speed": 1}, "carrier": {"speed": 0.5}},
            r"^shafts\.carrier\.speed = 0\.5: set\.carrier gives .* left out",
        ),
    ],
)
def test_speeds_of_differentials_are_asked_for(shafts: dict[str, Any], words: str) -> None:
    with pytest.raises(gm.DesignError, match=words):
        _ = gm.load_train(differential(**shafts)).headline


def power_split() -> dict[str, Any]:
    """The input drives the sun of a set, and by a pair beside it the ring: the carrier is the output."""
    back = {"design": str(SAMPLES / "spur_relieved.toml")}
    tables = differential(
        sun={"members": ["set.sun", {"member": "back.pinion", "position": 80}]},
        ring={"members": [{"member": "set.ring"}, {"member": "last.gear", "position": 160}]},
    )
    tables["stages"] |= {"back": back, "last": back}
    tables["shafts"]["side"] = {"members": ["back.gear", {"member": "last.pinion", "position": 80, "turn": 180}]}
    tables["output"] = "carrier"
    return tables


@pytest.mark.quick
def test_torques_of_a_split_of_power_are_in_equilibrium() -> None:
    """Solve the equilibrium by own equations. A differential closes the loop, so the torques follow without stiffness."""
    train = gm.load_train(power_split())
    found = {shaft.shaft: shaft for shaft in train.shafts}
    i = found["side"].speed
    # torques on the set: sun s, ring 4 s, carrier -5 s; the side shaft gets 4 s / i from the ring and takes 4 s from the input
    ring = found["ring"].speed
    s = 1.0 / (1.0 + 4.0 * ring)
    assert found["carrier"].torque == pytest.approx(5.0 * s)
    assert found["ring"].torque == pytest.approx(4.0 * s)
    assert found["side"].torque == pytest.approx(4.0 * s * ring / i)
    # power in is power out
    assert found["carrier"].torque * found["carrier"].speed == pytest.approx(1.0)
    assert found["sun"].torque == 1.0


@pytest.mark.sweep
def test_error_of_a_differential_is_that_of_both_branches() -> None:
    """A pair drives the ring of a set whose sun is the input: its error reaches the carrier by the ratio of ring and carrier."""
    pair = {"design": str(SAMPLES / "spur_relieved.toml")}
    tables = differential(ring={"members": [{"member": "set.ring"}, {"member": "pair.gear", "position": 80}]})
    tables["stages"]["pair"] = pair
    tables["shafts"]["motor"] = {"members": ["pair.pinion"], "speed": 0.5}
    tables["output"] = "carrier"
    train = gm.load_train(tables)
    (first, second) = train.layout.steps
    assert (first.stage.name, second.stage.name) == ("pair", "set")
    error = train.transmission_error(2.0)
    turned = np.abs(error.solved.parts["pair"]).max()
    assert turned > 1e-6
    # the same flanks, as finely sampled
    (of_ring,) = (shaft for shaft in train.shafts if shaft.shaft == "ring")
    carried = first.stage.paths[0].meshes[0].pair
    curve = gears_curve(solver_pair(carried), carried.pitch)
    assert curve is not None
    alone = np.ptp(curve.advance(np.linspace(0.0, carried.pitch, 2000)))
    assert np.ptp(error.solved.parts["pair"]) == pytest.approx(alone * 72 / 90, rel=0.02)
    assert of_ring.speed == pytest.approx(-0.5 * carried.ratio)


@pytest.mark.quick
def test_lost_contact_names_the_stage() -> None:
    tables = loop(60.0)
    apart = {**tables["stages"]["a"], "assembly": {"dx": 8.0}}
    shafts = {"input": {"members": ["a.pinion"]}, "output": {"members": ["a.gear"]}}
    train = gm.load_train({**tables, "stages": {"a": apart}, "shafts": shafts})
    with pytest.raises(gm.NoSolutionError, match=r"^stages\.a\.pinion-gear: the teeth lose contact"):
        train.places(5.0)


# ---------------------------------------------------------------- racks

#: a helical pair whose gear turns the pinion of a rack
WITH_RACK: dict[str, Any] = {
    "kind": "train",
    "stages": {
        "pair": BEVEL_AND_HELICAL["stages"]["helical"],
        "slide": {"design": str(SAMPLES / "rack.toml"), "helix_angle": 12},
    },
    "shafts": {
        "input": {"members": ["pair.pinion"]},
        "middle": {"members": ["pair.gear", {"member": "slide.pinion", "position": 40, "turn": 70, "phase": 4}]},
        "table": {"members": ["slide.rack"]},
    },
}


@pytest.fixture(scope="module")
def with_rack() -> gm.MultistageTrain:
    return gm.load_train(WITH_RACK)


@pytest.mark.quick
def test_racks_travel_as_their_pinions_roll(with_rack: gm.MultistageTrain) -> None:
    """20 teeth of module 2 at 12 deg on the rack per turn of the pinion, which turns 19 times while the input turns 58 times."""
    travel = 20 * math.pi * 2.0 / math.cos(math.radians(12.0)) * 19 / 58
    rack = with_rack.shafts[-1]
    assert rack.travel is not None
    assert rack.force is not None
    assert abs(rack.travel) == pytest.approx(travel, rel=1e-14)
    assert with_rack.figures.travel == rack.travel
    assert with_rack.figures.ratio is None
    # the work of a turn under 1 Nm, in N mm
    assert rack.force * rack.travel == pytest.approx(2e3 * math.pi, rel=1e-14)
    assert [mesh.turns_until_repeat for mesh in with_rack.meshes] == [58.0, None]
    assert with_rack.figures.turns_until_repeat == 58.0
    places = [with_rack.places(phi)["slide.rack"] for phi in (0.0, 58.0 / 19.0 * 18.0)]
    moved = places[1].translation - places[0].translation
    # a pitch: flanks have no error over it
    along = places[0].rotation @ np.array([0.0, math.copysign(1.0, rack.travel), 0.0])
    assert moved == pytest.approx(along * travel / 20 * 58 / 19, abs=1e-9)


def test_error_of_a_rack_is_the_error_of_its_stage_in_um(with_rack: gm.MultistageTrain) -> None:
    alone = gm.build(with_rack.file.stages["slide"]).contact().summary
    error = with_rack.transmission_error(turns=1.0)
    assert error.figures.way_te_peak_to_peak == pytest.approx(alone["mesh_te_peak_to_peak_um"], rel=1e-3)
    assert np.ptp(error.to_dict()["te_um"]) == pytest.approx(alone["mesh_te_peak_to_peak_um"], rel=1e-3)


@pytest.mark.sweep
def test_teeth_of_a_rack_touch_and_do_not_overlap(with_rack: gm.MultistageTrain) -> None:
    """The rack pushed back by little is free of its pinion, pushed ahead it is not."""
    tolerance, phi = 0.01, 77.0 * with_rack.layout.sense
    solids = with_rack.solids(tolerance, phi=phi)
    pinion, rack = (solids.parts[name].to_manifold() for name in ("slide.pinion", "slide.rack"))
    ahead = with_rack.layout.shafts["table"].frame.rotation[:, 1] * with_rack.layout.sense * with_rack.shafts[-1].speed
    for way, free in ((3.0 * tolerance, True), (-3.0 * tolerance, False)):
        shift = way * ahead / np.linalg.norm(ahead)
        assert ((rack.translate(shift) ^ pinion).volume() == 0.0) == free, way


@pytest.mark.quick
@pytest.mark.parametrize(
    ("shafts", "words"),
    [
        ({"table": {"members": ["slide.rack", {"member": "pair.pinion", "position": 9}]}, "input": {"members": ["slide.pinion"]},
          "middle": {"members": ["pair.gear"]}},
         'shafts.table.members: the rack of slide slides, and pair.pinion would turn; allowed is ["slide.rack"]'),
        ({"table": {"members": [{"member": "slide.rack", "phase": 3}]}}, "shafts.table.members.slide.rack.phase = 3"),
        ({"table": {"members": ["slide.rack"], "speed": 1}}, "shafts.table.speed = 1: must be left out for a rack"),
        (None, "input = table: the rack of slide slides, and drives no train; allowed is one of input, middle"),
    ],
)  # fmt: skip
def test_shafts_of_racks_only_slide(shafts: dict[str, Any] | None, words: str) -> None:
    own = {"input": "table"} if shafts is None else {"shafts": {**WITH_RACK["shafts"], **shafts}}
    with pytest.raises(gm.DesignError) as refusal:
        _ = gm.load_train({**WITH_RACK, **own}).headline
    assert words in str(refusal.value)


@pytest.mark.sweep
def test_gears_of_a_joined_shaft_must_touch() -> None:
    train = gm.load_train(TWO_STAGE, ['shafts.middle.members=["first.gear", {member="second.pinion", position=60}]'])
    with pytest.raises(gm.DesignError, match=r"^shafts\.middle\.joined: first\.gear, second\.pinion make 2 bodies"):
        train.solids(0.1)


@pytest.mark.sweep
def test_the_command_writes_figures_table_and_solids(tmp_path: Path) -> None:
    made, table, solids = tmp_path / "train.json", tmp_path / "te.csv", tmp_path / "train.3mf"
    files = ("--json", made, "--csv", table, "-o", solids)
    status, _, err = run("train", TWO_STAGE, *files, "--tol", "0.1", "--turns", "0.25")
    assert status == 0, err
    document = json.loads(made.read_text())
    assert document["train"]["ratio_fraction"] == "106/17"
    assert [shaft["shaft"] for shaft in document["shafts"]] == ["input", "middle", "output"]
    assert document["transmission_error"]["te_peak_to_peak_first_arcsec"] > 1.0
    assert table.read_text().splitlines()[0] == "input_deg,te_arcsec,te_first_arcsec,te_second_arcsec"
    assert solids.stat().st_size > 10_000


def test_other_commands_name_the_command_of_trains() -> None:
    assert "gearmesh train" in refused("tca", TWO_STAGE)


# ---------------------------------------------------------------- studies


@pytest.mark.sweep
def test_rows_of_a_study_are_trains_with_their_keys(tmp_path: Path) -> None:
    """Every row is the train of a file with its keys; stages whose keys do not vary are built once for all rows."""
    vary = {"stages.second.gear.teeth": "52,54", "stages.first.gear.modifications.helix_crowning": [0.0, 0.02]}
    train = gm.load_train(TWO_STAGE)
    study = train.study(vary, turns=0.1, workers=1, folder=tmp_path, limits=["te_peak_to_peak_arcsec<100"])
    assert study.columns["status"] == ["ok"] * 4
    for k, (teeth, crowning) in enumerate(study.plan.rows(0, 4)):
        keys = [f"stages.second.gear.teeth={teeth}", f"stages.first.gear.modifications.helix_crowning={crowning}"]
        alone = gm.load_train(TWO_STAGE, keys)
        error = alone.transmission_error(0.1).figures
        assert study.numbers("ratio")[k] == alone.figures.ratio
        assert study.numbers("te_peak_to_peak_arcsec")[k] == pytest.approx(error.te_peak_to_peak, rel=1e-12)
        assert study.numbers("te_peak_to_peak_first_arcsec")[k] == pytest.approx(
            error.stage_te_peak_to_peak["first"], rel=1e-12
        )
    assert np.ptp(study.numbers("te_peak_to_peak_first_arcsec")) > 0.1
    assert study.nominal["ratio"] == train.figures.ratio
    assert study.good == 1.0
    # finished rows are read again
    again = gm.load_train(TWO_STAGE).study(vary, turns=0.1, workers=1, folder=tmp_path)
    assert again.columns == study.columns


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({}, "vary: missing; give keys to vary, as stages.first.assembly.dx=-0.1:0.1:5"),
        ({"vary": {"stages.secnd.gear.teeth": [1]}}, "with NAME one of first, second; did you mean stages.second.gear.teeth?"),
        ({"vary": {"stages.second.gear.teth": [1]}}, "vary stages.second.gear.teth: cylindrical has no key of this name"),
        ({"vary": {"stages.second.module": ["x"]}}, 'stages.second.module = "x": must be a number'),
        ({"tolerance": {"stages.second.module": "normal:2:0.1"}}, "tolerance: needs sample"),
        ({"sample": 2, "tolerance": {"class": "6"}}, "tolerance class: tolerance classes are for studies of one stage"),
    ],
)  # fmt: skip
def test_wrong_studies_are_refused_in_one_line(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(gm.DesignError) as refusal:
        gm.load_train(TWO_STAGE).study(**arguments)
    assert words in str(refusal.value)


def test_the_command_studies_trains(tmp_path: Path) -> None:
    tolerance = ("--sample", "2", "--tolerance", "stages.first.assembly.dx=normal:0:20um", "--record", "ratio")
    status, _, err = run("study", TWO_STAGE, *tolerance, "-o", tmp_path / "s", "--workers", "1", "--no-parquet")
    assert status == 0, err
    lines = (tmp_path / "s" / "study.csv").read_text().splitlines()
    assert lines[0] == "row,stages.first.assembly.dx,ratio,status,reason"
    assert len(lines) == 3
    assert refused("study", TWO_STAGE, *tolerance, "--torque", "5").startswith("--torque: is for studies of one")


# ---------------------------------------------------------------- CAD, pictures, page


@pytest.mark.sweep
def test_assemblies_have_a_part_with_a_name_for_every_occurrence(planetary: gm.MultistageTrain, tmp_path: Path) -> None:
    """Planets share a shape, and readers that keep one name per shape would give all of them the last one."""
    pytest.importorskip("OCP")
    build123d = pytest.importorskip("build123d")
    text = {
        **planetary.file.resolve(),
        "shafts": {"input": {"members": ["set.sun"]}, "output": {"members": ["set.carrier"]}},
    }
    text["stages"] = {"set": {**text["stages"]["set"]}}
    train = gm.load_train({key: value for key, value in text.items() if key not in ("input", "output")})
    made = train.cad("0.02mm", phi=20.0)
    read = build123d.import_step(made.save(tmp_path / "train.step"))
    assert [part.label for part in read.children] == [
        "set_sun",
        "set_ring",
        "set_planet_1",
        "set_planet_2",
        "set_planet_3",
    ]
    places = train.places(20.0)
    for part in read.children:
        middle = places[part.label.replace("set_", "set.")].translation
        assert tuple(part.center(build123d.CenterOf.MASS)) == pytest.approx(middle, abs=1e-3)
        assert part.volume == pytest.approx(made.measured[part.label.replace("set_", "set.")].volume, rel=1e-6)


@pytest.mark.sweep
def test_gears_of_a_joined_shaft_are_one_cad_solid(two_stage: gm.MultistageTrain) -> None:
    pytest.importorskip("OCP")
    made = two_stage.cad("0.01mm")
    (body,) = (part for part in made.parts if part.name == "middle")
    apart = [
        gm.build(two_stage.file.stages[stage]).cad(member, "0.01mm")
        for stage, member in (("first", "gear"), ("second", "pinion"))
    ]
    volumes = [next(iter(cad.measured.values())).volume for cad in apart]
    assert made.measured["middle"].volume == pytest.approx(sum(volumes), rel=1e-9)
    # the end of the hub is inside the body, and its face is gone
    faces = sum(len(cad.parts[0].faces) for cad in apart)
    assert len(body.faces) == faces - 1
    names = {face.name for face in body.faces}
    assert {"first.gear flank_left_1", "second.pinion flank_right_17", "first.gear bore"} <= names
    regions = [str(face.region) for cad in apart for face in cad.parts[0].faces]
    assert [str(face.region) for face in body.faces].count("hub") == regions.count("hub") - 1
    assert {face.member for face in made.face_names().faces} == {"first.pinion", "middle", "second.gear"}


def test_the_chart_is_drawn(two_stage: gm.MultistageTrain, tmp_path: Path) -> None:
    error = two_stage.transmission_error(turns=0.5)
    assert two_stage.chart(error).save(tmp_path / "te.svg").read_bytes().count(b"<path") > 5


@pytest.mark.sweep
def test_rounding_is_no_transmission_error() -> None:
    """Gears without modification turn evenly: a title said 9.208e-10 arcsec."""
    train = gm.load_train(SAMPLES / "trains" / "train_planetary.toml")
    error = train.transmission_error(turns=0.2)
    assert np.ptp(error.solved.te) > 0.0
    assert train.chart(error).title.endswith("shaft output, 0 arcsec peak to peak")
    assert "TE 0 arcsec" in error.headline


@pytest.mark.sweep
def test_the_page_has_figures_and_sheets_of_all_stages(two_stage: gm.MultistageTrain, tmp_path: Path) -> None:
    page = two_stage.page(turns=0.5)
    text = page.save(tmp_path / "train.html").read_text()
    for words in ("106/17", "Stage first", "Stage second", "Transmission error of the shaft output"):
        assert words in text
    assert page.title == "Two-stage helical gearbox"
    # the first screen: the picture, and eight figures beside it
    card = text[text.index('<section id="card"') : text.index("<h2>")]
    for words in ("106/17 = 6.235", "<strong>0.1604</strong>", "8.5 to 24", "after 106 turns", "No warnings."):
        assert words in card
    assert card.count("<dt>") == 8


@pytest.mark.quick
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("-o", "a.xyz"), "its suffix must be"),
        (("-o", "a.html", "--phi", "3"), "phi = 3: must be left out for .html"),
        (("--tol", "0.1"), "tol = 0.1: must be left out without --output"),
        (("--chart", "a.jpg"), "its suffix must be"),
    ],
)
def test_options_that_do_not_apply_are_refused(options: tuple[str, ...], words: str) -> None:
    assert words in refused("train", TWO_STAGE, *options)
