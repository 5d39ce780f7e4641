"""Secondary cuts and second passes of face-hobbing heads, against blades moved as the machine moves them."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from oracles.moved_blades import machine_points

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import Array, rotation_about
from gearmesh.kinds import Side, VagueError
from gearmesh.systems.spiral_bevel.build import try_build
from gearmesh.systems.spiral_bevel.hobbing.secondary_cut import (
    ROOM_HEIGHTS,
    ROOM_STATIONS,
    HeadRoom,
    cradle_rolls,
    second_pass,
)
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import MATING_SIDES
from gearmesh.systems.spiral_bevel.sheet.dimension_sheet import BLADE_OVERLAP_MM
from gearmesh.systems.spiral_bevel.sheet.slots import slot_widths
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import BevelTeeth, bevel_teeth

NAMES = ("concave", "convex")
BASIC: dict[str, Any] = {
    **{"kind": "spiral_bevel", "process": "face_hobbed", "module": 5, "spiral_angle": 32},
    **{"pinion": {"teeth": 14}, "gear": {"teeth": 39}},
}
#: head of many groups and a small spiral angle: slots taper to less than half of their width at the toe
TAPERED: dict[str, Any] = {
    **{"kind": "spiral_bevel", "process": "face_hobbed", "module": 5.077, "spiral_angle": 20.4, "pressure_angle": 22.8},
    **{"head": {"blade_groups": 16}, "pinion": {"teeth": 13}, "gear": {"teeth": 25}},
}
#: a small head, which does not clear the gear; slots are narrow at the heel
SMALL_HEAD: dict[str, Any] = {**BASIC, "head": {"radius": 30}}


@cache
def made(pair: str) -> BevelTeeth:
    designs: dict[str, Any] = {"tapered": TAPERED, "small_head": SMALL_HEAD, "usual": BASIC}
    design = gm.parse(designs[pair]) if pair in designs else gm.load("samples/hypoid_face_hobbed.toml")
    design = design.with_values({"process": "face_hobbed"}) if pair == "hypoid" else design
    return bevel_teeth(design.in_mm())  # type: ignore[arg-type]


def member_of(pair: str, member: str) -> tuple[dict[str, Generated], dict[str, float], Any]:
    teeth = made(pair)
    cut, k = teeth.cut, ("pinion", "gear").index(member)
    return (cut.pinion, cut.gear)[k], cut.places[k], (teeth.pinion, teeth.gear)[k].member


def deepest(back: Generated, place: float, points: Array, normals: Array, start: tuple[Array, Array, Array]) -> Array:
    """Least distance (N,) along normals, over rotation of the head and roll, of an edge that is moved axis by axis."""
    turned = rotation_about("z", np.full(len(points), back.turned + place))

    def at(x: Array, roll: Array) -> Array:
        here = (turned @ machine_points(back, roll, x[:, 0], x[:, 1])[..., None])[..., 0]
        return here - points - x[:, 2:] * normals

    def gap(x: Array, roll: Array) -> Array:
        for _ in range(8):
            f = at(x, roll)
            matrix = np.stack([(at(x + 1e-6 * e, roll) - f) / 1e-6 for e in np.eye(3)], axis=-1)
            x = x - np.linalg.solve(matrix, f[..., None])[..., 0]
        return x

    roll, x, step = start[2], np.stack((*start[:2], np.zeros(len(points))), axis=-1), 0.02
    for _ in range(7):
        # least of three rolls, and the vertex of the parabola through them
        tried = [gap(x, roll + k * step)[:, 2] for k in (-1.0, 0.0, 1.0)]
        bend, slope = tried[0] - 2.0 * tried[1] + tried[2], 0.5 * (tried[2] - tried[0])
        assert (bend > 0.0).all()
        roll, step = roll - step * slope / bend, 0.4 * step
        x = gap(x, roll)
    return np.asarray(x[:, 2])


@pytest.mark.parametrize(
    ("pair", "member", "cuts"),
    [
        ("tapered", "gear", "toe"),
        ("small_head", "pinion", "heel"),
        ("usual", "gear", ""),
        ("hypoid_formate", "pinion", ""),
        pytest.param("hypoid", "gear", "", marks=pytest.mark.sweep),
    ],
)
@pytest.mark.sweep_cases("small_head-pinion-heel", "tapered-gear-toe", "usual-gear-")
def test_room_is_that_of_blades_moved_by_the_machine(pair: str, member: str, cuts: str) -> None:
    """At toe, middle and heel, over rotation and roll; where the cut begins, the blade grazes the flank."""
    sides, places, own = member_of(pair, member)
    room, tooth, found = HeadRoom.of(own, sides, places), own.tooth, set()
    widest = slot_widths(tooth, tooth.stations(ROOM_STATIONS)).max()
    for name in NAMES:
        cut, side, other = room.sides[name], sides[name], MATING_SIDES[name]
        turn = -tooth.pitch_angle if side.flank is Side.RIGHT else tooth.pitch_angle
        place = places[other] + turn
        # a blade of each side, one after the other, clear the widest slot
        blades = [each.blade.tip_radius for each in (sides[other], cut.back)]
        assert 2.0 * abs(blades[0] - blades[1]) == pytest.approx(widest + BLADE_OVERLAP_MM)
        stations = np.concatenate((ROOM_STATIONS[::2], cut.ends))
        grid = tooth.flank_grid(side.flank, ROOM_HEIGHTS, stations)
        points, normals = grid.points.reshape(-1, 3), grid.normals.reshape(-1, 3)
        u, v = np.moveaxis(grid.parameters.reshape(-1, 2), -1, 0)
        edge = side.blade.flank.section(u)[0][:, 0] / np.cos(cut.back.blade.blade_angle)
        start = v, edge, cradle_rolls(cut.back, edge, v)
        least = deepest(cut.back, place, points, normals, start).reshape(3, -1)
        assert cut.room[::2] == pytest.approx(least.min(axis=0)[:3], abs=1e-6)
        for graze in np.abs(least[:, 3:]).min(axis=0):
            assert graze < 1e-5
        if cut.least < 0.0:
            found.add("heel" if cut.at_heel else "toe")
    assert found == ({cuts} if cuts else set())
    assert all(cuts in line and line.startswith(f"{member}: secondary cut") for line in room.warnings)
    assert bool(room.warnings) == bool(cuts)


@pytest.mark.sweep
def test_secondary_cut_is_reported() -> None:
    """Two warnings of the pair and a row of the sheet report the secondary cut."""
    gears = gm.build(gm.parse(TAPERED))
    assert sum("secondary cut" in line for line in gears.warnings) == 2
    (head,) = [table for table in gears.sheet().tables if table.title.startswith("Face hobbing head")]
    rows = dict(zip(head.symbols, head.rows, strict=True))
    assert [value < 0.0 for value in rows["j_b"][2:]] == [False, False, True, True]


@pytest.mark.parametrize("member", ["pinion", "gear"])
def test_second_pass_is_that_of_blades_moved_by_the_machine(member: str) -> None:
    """A head of 30 mm cuts the gear again at the other end of its circle, and clears the pinion."""
    sides, _, own = member_of("small_head", member)
    tooth, pair = own.tooth, made("small_head").cut.blank
    blank = pair.pinion if member == "pinion" else pair.gear
    (toe, heel), depths = tooth.blank.extent, []
    for side in sides.values():
        grid = tooth.flank_grid(side.flank, np.array([0.0, 1.0]), ROOM_STATIONS)
        rolls = cradle_rolls(side, grid.parameters[..., 0], grid.parameters[..., 1])
        roll, turn = np.meshgrid(np.linspace(rolls.min(), rolls.max(), 9), np.linspace(1.5, 4.8, 400))
        p = np.full(roll.size, side.blade.at_height(0.0))
        r = machine_points(side, roll.ravel(), turn.ravel(), p)
        station = tooth.blank.axial.value(r)
        depth = np.where((station > toe) & (station < heel), -tooth.blank.tip.value(r), 0.0)
        # the blade's rounding leaves less of its tip
        assert second_pass(side, blank) == pytest.approx(max(depth.max(), 0.0), abs=0.7 * side.blade.edge_radius)
        depths.append(second_pass(side, blank))
    assert (min(depths) > 3.0) if member == "gear" else (max(depths) == 0.0)


def test_head_too_small_to_clear_is_refused_by_its_key() -> None:
    with pytest.raises(VagueError) as refusal:
        try_build(gm.parse(SMALL_HEAD).in_mm())  # type: ignore[arg-type]
    assert "too small to clear" in str(refusal.value)
    assert refusal.value.remedies["head.radius"] == 1


@pytest.mark.sweep
def test_usual_heads_clear_the_blank() -> None:
    """The usual radius for 45 mm cone distance, 40 mm, would cut the gear 10/18 a second time: a larger head is taken."""
    values = {"module": 5.15, "spiral_angle": 20.42, "pressure_angle": 22.01, "head": {"blade_groups": 8}}
    gears = gm.build(gm.parse({**BASIC, **values, "pinion": {"teeth": 10}, "gear": {"teeth": 18}}))
    teeth = bevel_teeth(gears.design.in_mm())
    blank = teeth.cut.blank
    assert blank.cutter_radius == 55.0
    assert not any(second_pass(side, blank.gear) for side in teeth.cut.gear.values())


#: hypoid pairs whose usual head cuts the pinion twice, or leaves no flank up to its tip; and one whose blades only enter the
#: space that they cut, at the end of the roll
HYPOIDS: dict[str, dict[str, Any]] = {
    "twice": {
        **{"module": 2.254, "pressure_angle": 18.87, "hand": "right", "spiral_angle": 39.57, "offset": 13.757},
        **{"head": {"blade_groups": 11}, "pinion": {"teeth": 20}, "gear": {"teeth": 41}},
    },
    "no_tip": {
        **{"module": 2.968, "pressure_angle": 20.64, "spiral_angle": 34.67, "offset": 7.442},
        **{"head": {"blade_groups": 12}, "pinion": {"teeth": 13}, "gear": {"teeth": 18}},
    },
    "same_space": {
        **{"module": 3.398, "pressure_angle": 19.85, "spiral_angle": 43.96, "offset": 7.181},
        **{"head": {"blade_groups": 17}, "pinion": {"teeth": 10}, "gear": {"teeth": 21}},
    },
}


@pytest.mark.sweep
@pytest.mark.parametrize("pair", list(HYPOIDS))
def test_hypoid_pairs_get_a_head_that_cuts_them(pair: str) -> None:
    """A larger head than the usual one where that is refused, which is written; contact on both sides."""
    design = gm.parse({**HYPOIDS[pair], "kind": "hypoid", "process": "face_hobbed"})
    filled = design.head.radius  # type: ignore[attr-defined]
    assert (filled is None) == (pair == "same_space")
    gears = gm.build(design)
    teeth = bevel_teeth(gears.design.in_mm())
    if filled is not None:
        assert teeth.cut.blank.cutter_radius == pytest.approx(filled)
    for sides, own in ((teeth.cut.pinion, teeth.cut.blank.pinion), (teeth.cut.gear, teeth.cut.blank.gear)):
        assert not any(second_pass(side, own) for side in sides.values())
    assert gears.contact().summary["contact_ratio"] > 1.0


def test_eccentricity_that_is_too_large_is_refused() -> None:
    with pytest.raises(gm.DesignError) as refusal:
        gm.build(gm.parse({**BASIC, "head": {"radius": 75, "eccentricity": 60}}))
    assert refusal.value.key == "head.eccentricity"
    assert "between 0 and 37.5 mm" in str(refusal.value)
