"""Conical and throated tips, of cylindrical gears against solids that are turned by brute force."""

from __future__ import annotations

from typing import Any

import manifold3d
import numpy as np
import pytest
from oracles.built import built
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.cad.brep import exact_volume
from gearmesh.contact.flanks import analyse
from gearmesh.kinds import Region
from gearmesh.mesh.solid import gear_solid, prove

TOLERANCE = 0.01


def design(**pinion: Any) -> dict[str, Any]:
    gear = {"teeth": 37, "face_width": 20}
    pinion = {"teeth": 19, "face_width": 20, "bore": 0, **pinion}
    return {"kind": "cylindrical", "module": 3, "helix_angle": 12, "pinion": pinion, "gear": gear}


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("key", "value", "meridian"),
    [
        ("tip_cone_angle", 4.0, lambda z: 31.5 + z * np.tan(np.radians(4.0))),
        ("tip_throat_radius", 60.0, lambda z: 31.5 + 60.0 - np.sqrt(60.0**2 - z**2)),
    ],
)
def test_a_tip_surface_is_what_turning_leaves_of_higher_teeth(key: str, value: float, meridian: Any) -> None:
    """Teeth with a cylindrical tip as high as the highest place, less all beyond the body that the meridian bounds."""
    member = built(design(tip_diameter=63.0, **{key: value})).members["pinion"]
    assert prove(gear_solid(member, TOLERANCE), member.genus).ok
    land = member.tooth.grid(Region.LAND, [0.0, 0.3, 1.0], member.tooth.even).points
    assert np.hypot(land[..., 0], land[..., 1]) == pytest.approx(meridian(land[..., 2]), abs=1e-9)
    higher = built(design(tip_diameter=2.0 * float(meridian(np.array([10.0]))[0]))).members["pinion"]
    mesh = gear_solid(higher, 0.2 * TOLERANCE)
    whole = manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices.copy(), mesh.triangles.astype(np.uint64)))
    z = np.linspace(-10.5, 10.5, 43)
    profile = np.array([(0.0, -10.5), *zip(meridian(z).tolist(), z.tolist(), strict=True), (0.0, 10.5)])
    cut = whole ^ manifold3d.CrossSection([profile]).revolve(2000)
    removed = higher.plain_volume() - member.plain_volume()
    assert whole.volume() - cut.volume() == pytest.approx(removed, rel=5e-3)


@pytest.mark.quick
def test_contact_goes_up_to_the_cone() -> None:
    """A line of contact of spur teeth lies at one radius of the pinion: it begins where the cone has that radius."""
    slope = 1.2 / 20.0
    keys = design(tip_diameter=63.0, tip_cone_angle=float(np.degrees(np.arctan(slope)))) | {"helix_angle": 0}
    pair = built(keys).pairs[0]
    path = analyse(pair, np.linspace(-1.0, 1.0, 33) * pair.pitch)
    begins = []
    for line in path.lines:
        if line is not None and np.hypot(*line[0, :2]) > 31.5 - 10.0 * slope:
            begins.append((line[:, 2].min(), (np.hypot(*line[0, :2]) - 31.5) / slope))
    assert len(begins) > 2
    assert [z for z, _ in begins] == pytest.approx([z for _, z in begins], abs=1e-6)


@pytest.mark.quick
def test_internal_tips() -> None:
    base = {"kind": "cylindrical", "module": 2, "pinion": {"teeth": 20, "face_width": 16}}
    for more, meridian in (
        ({"tip_cone_angle": -3.0}, lambda z, tip: tip - z * np.tan(np.radians(3.0))),
        ({"tip_throat_radius": 50.0}, lambda z, tip: tip - 50.0 + np.sqrt(50.0**2 - z**2)),
    ):
        ring = {"teeth": -60, "face_width": 14, "tip_diameter": 117.0, **more}
        tooth = gm.build(gm.parse({**base, "gear": ring})).pairs[0].gear.tooth
        grid = tooth.grid(Region.LAND, [0.5], tooth.even)
        land = grid.points[0]
        # the material is outside
        assert ((grid.normals[0] * land)[:, :2].sum(axis=1) < 0.0).all()
        assert np.hypot(land[:, 0], land[:, 1]) == pytest.approx(meridian(land[:, 2], 58.5), abs=1e-9)


#: sample, member, key, value in the design's unit, and mm in it; a throat far above the tool's tip is the circular arc's
OTHERS = (
    ("beveloid_crossed", "gear", "tip_cone_angle", 3.0, 1.0),
    ("circular_arc", "gear", "tip_throat_radius", 60.0, 25.4),
    ("novikov", "pinion", "tip_cone_angle", -1.5, 1.0),
    ("modified_involute", "gear", "tip_throat_radius", 400.0, 1.0),
    ("face_gear", "pinion", "tip_cone_angle", 2.0, 1.0),
)


@pytest.mark.sweep
@pytest.mark.sweep_cases("novikov", "circular_arc", "face_gear", "modified_involute")
@pytest.mark.parametrize(("sample", "name", "key", "value", "unit"), OTHERS, ids=[case[0] for case in OTHERS])
def test_tips_of_other_kinds_are_turned_as_asked(sample: str, name: str, key: str, value: float, unit: float) -> None:
    """Lands on the cone or arc, through the tip circle at mid face; solids as heavy as quadrature says."""
    plain = gm.build(gm.load(SAMPLES / f"{sample}.toml")).members[name]
    member = gm.build(gm.load(SAMPLES / f"{sample}.toml", [f"{name}.{key}={value}"])).members[name]
    tip = float(plain.tooth.blank.tip.at(0.0))
    land = member.tooth.grid(Region.LAND, [0.0, 0.4, 1.0], member.tooth.even).points
    z, rho = land[..., 2], np.hypot(land[..., 0], land[..., 1])
    radius = value * unit
    away = z * np.tan(np.radians(value)) if key == "tip_cone_angle" else radius - np.sqrt(radius**2 - z**2)
    assert rho == pytest.approx(tip + away, abs=1e-9 * tip)
    mesh = gear_solid(member, 1e-4 * tip)
    assert prove(mesh, member.genus).ok
    assert mesh.volume() == pytest.approx(exact_volume(member), rel=3e-3)
    assert exact_volume(member) != pytest.approx(exact_volume(plain), rel=3e-6)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"tip_cone_angle": 40.0}, r"pinion.tip_cone_angle = 40 deg: the teeth have no such tip .* at most \d"),
        ({"tip_throat_radius": 9.0}, r"pinion.tip_throat_radius = 9 mm: the teeth have no such tip .* at least \d"),
        ({"tip_cone_angle": 1.0, "tip_throat_radius": 90.0}, "cannot be given together with tip_cone_angle"),
        ({"tip_cone_angle": 1.0, "modifications": {"helix_crowning": 0.01}}, "cannot be given together with modific"),
    ],
)
@pytest.mark.sweep_cases("keys0-pinion.tip_cone_angle = 40 deg: the teeth have no such tip .* at most \\\\d")
def test_tips_that_teeth_cannot_have(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        gm.build(gm.parse(design(**keys)))
