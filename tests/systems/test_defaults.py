"""Defaults that adapt: a key that the design leaves out is never what it is refused for, and what it becomes is said."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, SpiralBevelDesign
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.teeth.region import FILLET_REGIONS

# sample, what is set, the key whose default gives way, its standard value
ADAPTED = [
    ("spur", ["pressure_angle=25"], "pinion.tool_tip_radius", 0.38),
    ("helical", ["pressure_angle=31"], "gear.tool_tip_radius", 0.38),
    ("spur", ["pressure_angle=25", "gear.root_diameter=110"], "gear.tool_tip_radius", 0.38),
    ("novikov", ["rack_parameter=1"], "gear.tool_tip_radius", 0.3),
    ("novikov", ["rack_parameter=1.2"], "gear.dedendum", 1.25),
    ("modified_involute", ["rack_parameter=1.2"], "gear.tool_tip_radius", 0.3),
    ("face_gear", ["pressure_angle=27.5"], "pinion.tool_tip_radius", 0.25),
    ("face_gear", ["pressure_angle=28"], "pinion.tool_tip_radius", 0.25),
    ("face_gear", ["pressure_angle=30"], "shaper.addendum", 1.25),
    ("face_gear", ["pressure_angle=20"], "pinion.dedendum", 1.25),
    ("zerol", ["module=0.2", "face_width=1"], "contact.delta", 0.00635),
    pytest.param(
        "spiral_bevel_basic", ["face_width=2"], "pinion.concave.semi_major_axis", 0.5, marks=pytest.mark.sweep
    ),
]


@pytest.mark.parametrize(("sample", "given", "key", "standard"), some(ADAPTED, 5))
@pytest.mark.sweep_cases(
    "face_gear-given6-pinion.tool_tip_radius-0.25",
    "face_gear-given8-shaper.addendum-1.25",
    "novikov-given3-gear.tool_tip_radius-0.3",
)
def test_a_default_gives_way_and_says_so(sample: str, given: list[str], key: str, standard: float) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml", given))
    (line,) = (line for line in gears.warnings if line.startswith(f"{key} = "))
    assert f"{standard:g}" in line
    # a design that sets the key is told nothing, and refused for what the default could not be
    adapted = float(line.split()[2].rstrip(":"))
    assert adapted != standard
    stated = gm.build(gm.load(SAMPLES / f"{sample}.toml", [*given, f"{key}={adapted}"]))
    assert not any(line.startswith(f"{key} = ") for line in stated.warnings)


@pytest.mark.sweep
def test_where_there_is_room_the_standard_stays() -> None:
    for sample in ("spur", "helical", "novikov", "modified_involute", "face_gear", "spiral_bevel_basic", "zerol"):
        assert gm.build(gm.load(SAMPLES / f"{sample}.toml")).warnings == ()


@pytest.mark.sweep
@pytest.mark.parametrize("module", some([0.05, 0.1, 0.2], 1))
def test_small_bevel_teeth(module: float) -> None:
    """The marking compound is no thicker than small teeth bear: the same gears in any size."""
    small, large = (
        gm.build(SpiralBevelDesign(module=m, pinion={"teeth": 13}, gear={"teeth": 44})).contact(cycle=False).path
        for m in (module, 0.5)
    )
    np.testing.assert_allclose(small.semi_major, large.semi_major * module / 0.5, rtol=1e-6)


@pytest.mark.parametrize("backlash", ["0.1mm", "0.1"])
@pytest.mark.sweep_cases("0.1")
def test_circular_arc_gears_turn_by_their_backlash(backlash: str) -> None:
    """At theta0 on either side the play on the pitch circle is j / (cos(theta0) sin(lambda)); a bare 0.1 is in inches."""
    turns = []
    for given in (backlash, "0"):
        for flank in ("right", "left"):
            keys = [f"backlash={given}", f"contact.flank={flank}", "contact.count_phi1=rotation"]
            gears = gm.build(gm.load(SAMPLES / "circular_arc.toml", keys))
            turns.append(gears.contact([0.0], cycle=False).path.phi2[0])
            assert any("backlash" in line for line in gears.warnings) == (given == "0.1")
    # without backlash both flanks touch at once, but for whole pitches
    play = abs(abs(turns[0] - turns[1]) - abs(turns[2] - turns[3])) * 25.929381226 * 25.4
    normal = 0.1 if backlash == "0.1mm" else 2.54
    assert play == pytest.approx(normal / np.cos(np.radians(30.0)) / np.sin(np.radians(75.0)), rel=1e-6)


# ---------------------------------------------------------------- the face gear's tips and the pinion's root


@pytest.mark.sweep
@pytest.mark.sweep_cases("face_gear-given0", "face_gear-given1", "face_gear-given2", "face_gear-given3")
@pytest.mark.parametrize(
    ("sample", "given"),
    [
        ("face_gear", []),
        ("face_gear", ["backlash=0.2", "contact.flank=left"]),
        ("face_gear", ["shaft_angle=70"]),
        ("face_gear", ["pressure_angle=20"]),
        ("face_gear_conjugate", []),
    ],
)
def test_the_tips_of_a_face_gear_clear_the_pinions_root(sample: str, given: list[str]) -> None:
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml", given)).pairs[0]
    # a conjugate gear touches the very ends of the pinion's flanks: rounding, and the chords of the sampled fillet
    assert _deepest(pair) <= (1e-4 if sample == "face_gear_conjugate" else -1e-3)


@pytest.mark.sweep
def test_the_distance_sees_a_root_that_is_too_round() -> None:
    pair = gm.build(gm.load(SAMPLES / "face_gear.toml", ["pinion.tool_tip_radius=0.25", "pinion.dedendum=1.25"])).pairs[
        0
    ]
    assert _deepest(pair) == pytest.approx(0.0226, abs=2e-4)


def _deepest(pair: GearPair) -> float:
    """Return the depth (mm) of the gear's exact tip edges in the pinion's exact fillets, phi1 from -20 to 20 deg; < 0: clear."""
    pinion, gear = pair.both
    sections, phi1 = gear.tooth.sections(np.linspace(0.0, 1.0, 33)), np.radians(np.linspace(-20.0, 20.0, 321))
    middle, half = pinion.tooth.sections([0.5]), 0.5 * pinion.tooth.pitch_angle
    fillet = pinion.tooth.grid(FILLET_REGIONS[Side.LEFT], np.linspace(0.0, 1.0, 2001), middle)
    curve, normals = fillet.points[:, 0, :2], fillet.normals[:, 0, :2]
    radii = np.hypot(*curve.T)
    deepest = -1.0
    for side in Side:
        edge = gear.tooth.flank_grid(side, [1.0], sections.t).points[0]
        for k in range(-3, 4):
            at = _seen_from(pair, edge, phi1, k * gear.tooth.pitch_angle)
            rho, angle = np.hypot(at[..., 0], at[..., 1]), np.arctan2(at[..., 1], at[..., 0])
            # both fillets of a tooth are mirror images, and all teeth are alike
            angle = np.abs((angle + half) % (2.0 * half) - half)
            near = (rho < radii.max()) & (rho > radii.min() - 1.0)
            points = np.stack((rho[near] * np.cos(angle[near]), rho[near] * np.sin(angle[near])), axis=-1)
            for part in np.array_split(points, max(1, len(points) // 500)):
                apart = part[:, None] - curve
                nearest = (apart**2).sum(axis=-1).argmin(axis=1)
                inside = -(apart[np.arange(len(part)), nearest] * normals[nearest]).sum(axis=-1)
                deepest = max(deepest, float(inside.max(initial=-1.0)))
    return deepest


def _seen_from(pair: GearPair, edge: Array, phi1: Array, beside: float) -> Array:
    """Points of the gear (T, 3), turned by `beside` in its own frame, in the pinion's frame at phi1 (P,): (P, T, 3)."""
    c, s = np.cos(beside), np.sin(beside)
    turned = edge @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    to_pinion = pair.pinion.mount.at(phi1).inverse @ pair.gear.mount.at(pair.ratio * phi1)
    found: Array = np.einsum("pij,tj->pti", to_pinion.rotation, turned) + to_pinion.translation[:, None]
    return found
