"""Internal gears of kind beveloid: parallel axes against kind cylindrical, crossed axes against the geometry of the pitch point."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles.built import built

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.cad.brep import exact_volume
from gearmesh.kinds import Side

CROSSED: dict[str, Any] = {
    "kind": "beveloid",
    "module": 1,
    "pinion": {"teeth": 15, "helix_angle": 20, "face_width": 8},
    "gear": {"teeth": -45, "helix_angle": 10, "face_width": 8},
}


def roll_angle(r: np.ndarray, base: float, twist: float) -> np.ndarray:
    """Return the angle (...,), rad, at which the involute through points r (..., 3) begins on the base circle, at z = 0."""
    rho = np.hypot(r[..., 0], r[..., 1])
    theta = np.sqrt((rho / base) ** 2 - 1.0)
    own = np.arctan2(r[..., 1], r[..., 0]) - twist * r[..., 2]
    return own, theta - np.arctan(theta)


def test_case_of_crossed_axes() -> None:
    gears = built(CROSSED)
    pair = gears.train.pair(0)
    assert math.degrees(pair.shaft_angle) == pytest.approx(10.0, abs=1e-12)
    pinion, ring = (member.mount.base for member in pair.both)
    expected = 0.5 * (45.0 / math.cos(math.radians(10.0)) - 15.0 / math.cos(math.radians(20.0)))
    assert np.linalg.norm(ring.translation - pinion.translation) == pytest.approx(expected, abs=1e-12)
    # the tooth traces of both pitch cylinders have one direction at the pitch point
    point = np.array([7.5 / math.cos(math.radians(20.0)), 0.0, 0.0])
    assert ring.inverse.point(point) == pytest.approx([22.5 / math.cos(math.radians(10.0)), 0.0, 0.0], abs=1e-12)
    first, second = (
        base.vector(np.array([0.0, math.sin(beta), math.cos(beta)]))
        for base, beta in ((pinion, math.radians(20.0)), (ring, math.radians(10.0)))
    )
    assert first == pytest.approx(second, abs=1e-12)


def test_flanks_are_screw_involutes_of_the_standard_thickness() -> None:
    keys = {**CROSSED["gear"], "profile_shift": 0.2, "addendum": 0.7}
    tooth = built({**CROSSED, "backlash": 0.1, "gear": keys}).members["gear"].tooth
    beta, alpha = math.radians(10.0), math.radians(20.0)
    radius, alpha_t = 22.5 / math.cos(beta), math.atan(math.tan(alpha) / math.cos(beta))
    base, twist = radius * math.cos(alpha_t), math.tan(beta) / radius
    # s_n = m (pi / 2 + 2 x tan(alpha)), thinner by j_bn / (2 cos(alpha))
    thickness = 0.5 * math.pi + 0.4 * math.tan(alpha) - 0.05 / math.cos(alpha)
    half = 0.5 * thickness / math.cos(beta) / radius
    for side in (Side.RIGHT, Side.LEFT):
        points = tooth.flank_grid(side, np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 5)).points
        own, inv = roll_angle(points, base, twist)
        # an internal tooth is wider outwards
        at = half - (math.tan(alpha_t) - alpha_t) + inv
        assert own == pytest.approx(-side.sign * at, abs=1e-12)


@pytest.mark.sweep
def test_parallel_axes_are_those_of_a_cylindrical_pair() -> None:
    pinion = {"teeth": 18, "face_width": 10, "profile_shift": 0.2}
    ring = {"teeth": -50, "face_width": 10, "profile_shift": -0.1, "tip_diameter": 100}
    given = {"module": 2, "backlash": 0.1}
    helical = {"helix_angle": 12}
    ours = built({"kind": "beveloid", **given, "pinion": {**pinion, **helical}, "gear": {**ring, **helical}})
    theirs = built({"kind": "cylindrical", **given, **helical, "pinion": pinion, "gear": ring})
    distances = [np.linalg.norm(gears.members["gear"].mount.base.translation) for gears in (ours, theirs)]
    assert distances[0] == pytest.approx(distances[1], abs=1e-9)
    first, second = (gears.contact([-5.0, 0.0, 5.0]).summary for gears in (ours, theirs))
    assert first["te_peak_to_peak_arcsec"] < 1e-9
    for key in ("contact_ratio", "backlash_normal_min_mm"):
        assert first[key] == pytest.approx(second[key], abs=1e-9)


@pytest.mark.sweep
def test_crowned_pinion_touches_inside_the_flanks_and_full_teeth_on_edges() -> None:
    wide = {**CROSSED, "backlash": 0.15, "gear": {**CROSSED["gear"], "addendum": 0.7}}
    full = built(wide).contact([-12.0, -6.0, 0.0])
    # both flanks are on one side of their common rack, and the ruling of the pinion's flank cuts the curved flank of the ring
    assert any("edge contact alone" in line for line in full.warnings)
    pinion = {**CROSSED["pinion"], "modifications": {"helix_crowning": 0.06}}
    crowned = built({**wide, "pinion": pinion}).contact([-12.0, -6.0, 0.0])
    assert not any("edge contact alone" in line for line in crowned.warnings)
    assert crowned.summary["te_peak_to_peak_arcsec"] < 5.0
    assert crowned.summary["backlash_normal_min_mm"] == pytest.approx(0.15, abs=1e-3)


@pytest.mark.sweep
def test_solid_and_cad() -> None:
    gears = built({**CROSSED, "gear": {**CROSSED["gear"], "teeth": -24, "addendum": 0.6, "rim": 2}})
    ring, solid = gears.members["gear"], gears.solid("gear", 0.01)
    assert solid.figures["watertight"]
    assert ring.body.profile[0][0] == pytest.approx(0.5 * 24 / math.cos(math.radians(10.0)) + 1.25 + 2.0)
    assert solid.figures["volume_mm3"] == pytest.approx(exact_volume(ring), abs=0.01 * solid.to_trimesh().area)
    assert gears.cad("gear").figures["gear"]["volume_mm3"] == pytest.approx(exact_volume(ring), rel=1e-7)


@pytest.mark.parametrize(
    ("member", "keys", "key"),
    [
        ("pinion", {"teeth": -15}, "pinion.teeth"),
        ("gear", {"teeth": -15}, "gear.teeth"),
        ("gear", {"cone_angle": 5}, "gear.cone_angle"),
        ("gear", {"bore": 5}, "gear.bore"),
        ("gear", {"teeth": 45, "rim": 2}, "gear.rim"),
        ("gear", {"tool_tip_radius": 1.5}, "gear.tool_tip_radius"),
        ("gear", {"addendum": 3}, "gear.addendum"),
        ("gear", {"dedendum": 3.5}, "gear.dedendum"),
        ("gear", {"tip_diameter": 48.1}, "gear.tip_diameter"),
    ],
)
@pytest.mark.sweep_cases("gear-keys6-gear.addendum", "gear-keys8-gear.tip_diameter")
def test_refusals(member: str, keys: dict[str, Any], key: str) -> None:
    with pytest.raises(DesignError) as refusal:
        gm.build(gm.parse({**CROSSED, member: {**CROSSED[member], **keys}}))
    assert refusal.value.key == key
