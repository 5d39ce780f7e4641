"""Gearboxes of several stages in REXS files, made by hand, as trains."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from exchange.gearboxes import Gearbox
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm

#: distance of the axes of both stages, mm, and angle of the second from the first, deg
DISTANCES, ANGLE_DEG = (76.0, 93.0), 70.0


def gearbox() -> Gearbox:
    """Two spur stages of modules 2 and 3, 25/51 and 20/42; the second axis is turned about the shaft in the middle."""
    made = Gearbox()
    unit = made.add("gear_unit", "gearbox")
    angle = math.radians(ANGLE_DEG)
    # the axis u is x; the shaft in the middle is at the origin, and straight on is y
    output = (0.0, DISTANCES[1] * math.cos(angle), DISTANCES[1] * math.sin(angle))
    axes = {"input": (0.0, -DISTANCES[0], 0.0), "middle": (0.0, 0.0, 0.0), "output": output}
    shafts = {name: made.add("shaft", name, defines_speed=name == "input") for name in axes}
    places = {
        "a1": ("input", 25, 2.0, 30.0),
        "a2": ("middle", 51, 2.0, 30.0),
        "b1": ("middle", 20, 3.0, 75.0),
        "b2": ("output", 42, 3.0, 75.0),
    }
    gears = {}
    for name, (shaft, teeth, module, along) in places.items():
        _, y, z = axes[shaft]
        gears[name] = made.add(
            "cylindrical_gear", name, number_of_teeth=teeth, normal_module=(module, "mm"), face_width=(20.0, "mm"),
            helix_angle=(0.0, "deg"), support_vector=([along, y, z], "mm"), u_axis_vector=([1.0, 0.0, 0.0], "mm"),
            reference_component_for_position=unit,
        )  # fmt: skip
        made.relate("assembly", assembly=shafts[shaft], part=gears[name])
        flanks = {
            side: made.add("cylindrical_gear_flank", f"{name} {side}", normal_pressure_angle=(20.0, "deg"))
            for side in ("left", "right")
        }
        made.relate("flank", gear=gears[name], **flanks)
    for first, second_gear, distance in (("a1", "a2", DISTANCES[0]), ("b1", "b2", DISTANCES[1])):
        stage = made.add("cylindrical_stage", f"{first} {second_gear}", center_distance=(distance, "mm"))
        made.relate("assembly", assembly=unit, part=stage)
        made.relate("stage", stage=stage, gear_1=gears[first], gear_2=gears[second_gear])
    return made


def test_a_gearbox_of_two_stages_is_a_train(tmp_path: Path) -> None:
    file = gearbox().write(tmp_path)
    train = gm.load_train(file)
    assert train.figures.ratio == pytest.approx(51 / 25 * 42 / 20, rel=1e-15)
    names = [shaft.members for shaft in train.shafts]
    assert [len(members.split(", ")) for members in names] == [1, 2, 1]
    places = list(train.places().values())
    origins = [place.translation for place in places]
    # distances of axes, place along the shaft, and the angle between both stages
    assert np.linalg.norm(origins[1] - origins[0]) == pytest.approx(DISTANCES[0], abs=1e-9)
    assert origins[2] - origins[1] == pytest.approx([0.0, 0.0, 45.0], abs=1e-9)
    assert np.linalg.norm(origins[3] - origins[2]) == pytest.approx(DISTANCES[1], abs=1e-9)
    straight, ahead = origins[1] - origins[0], origins[3] - origins[2]
    angle = math.degrees(math.atan2(np.cross(straight, ahead)[2], straight @ ahead))
    assert angle == pytest.approx(ANGLE_DEG, abs=1e-6)


def test_the_train_of_a_gearbox_is_written_and_read_again(tmp_path: Path) -> None:
    file, made = gearbox().write(tmp_path), tmp_path / "train.toml"
    assert "name one" in refused("convert", file, "-o", made)
    status, out, err = run("convert", file, "-o", made, "--stage", "all")
    assert status == 0, err
    assert "1071/250" in out
    first, second = gm.load_train(file), gm.load_train(made)
    for name, place in first.places(12.0).items():
        assert second.places(12.0)[name].translation == pytest.approx(place.translation, abs=1e-12)
        assert second.places(12.0)[name].rotation == pytest.approx(place.rotation, abs=1e-12)


def test_a_planetary_set_is_a_train_of_one_stage(tmp_path: Path) -> None:
    """The file has shafts of sun, ring and planets; the carrier gets one, and the ring is taken as fixed, with a note."""
    file = gm.build(gm.load(SAMPLES / "planetary.toml")).rexs().save(tmp_path / "set.rexs")
    train = gm.load_train(file)
    assert [shaft.members for shaft in train.shafts] == ["stage_1.sun", "stage_1.carrier"]
    assert train.figures.ratio == pytest.approx(1.0 + 72 / 18, rel=1e-15)
    assert "stage_1: the ring is taken as fixed" in train.warnings
