"""Double helical gears: both halves and the gap as solids, CAD and sections; contact of one half."""

from __future__ import annotations

from typing import Any

import manifold3d
import numpy as np
import pytest
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, Rigid
from gearmesh.cad.brep import exact_volume
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.blank.moments import member_moments

GEAR = {"teeth": 43, "face_width": 46, "bore": 30}
WHEEL = {
    **GEAR,
    "web": {"thickness": 10},
    "hub": {"diameter": 60, "length": 5},
    "holes": {"count": 5},
    "keyway": {"standard": "DIN 6885"},
}
DESIGNS: dict[str, dict[str, Any]] = {
    "gap": {"gap": 8},
    "herringbone": {"hand": "left"},
    "internal": {"gap": 6, "gear": {"teeth": -63, "face_width": 46, "holes": {"count": 4, "diameter": 2}}},
    "internal_herringbone": {"gear": {"teeth": -63, "face_width": 46}},
    "featured": {"gap": 8, "gear": WHEEL, "pinion": {"teeth": 21, "face_width": 48, "gap_diameter": 50}},
}


def design_of(name: str, **more: Any) -> gm.Design:
    keys: dict[str, Any] = {
        "kind": "cylindrical",
        "module": 3,
        "helix_angle": 25,
        "arrangement": "double_helical",
        "pinion": {"teeth": 21, "face_width": 48, "bore": 20},
        "gear": GEAR,
        "backlash": 0.1,
    }
    return gm.parse({**keys, **DESIGNS[name], **more})


def single(name: str) -> gm.Gears:
    """One half of it as a pair of its own: no features, the same bores and rims."""
    design = design_of(name)
    keys = dict(DESIGNS[name])
    gap = keys.pop("gap", 0.0)
    for member in ("pinion", "gear"):
        spec = getattr(design, member)
        own = {"teeth": -spec.teeth if spec.internal else spec.teeth, "face_width": 0.5 * (spec.face_width - gap)}
        keys[member] = own if spec.bore is None else {**own, "bore": spec.bore}
    return gm.build(gm.parse({"kind": "cylindrical", "module": 3, "helix_angle": 25, "backlash": 0.1, **keys}))


def plane_of(member: gm.Member) -> float:
    low, high = member.plain_body.ends
    return 0.5 * (low + high)


def body(mesh: TriangleMesh) -> manifold3d.Manifold:
    return manifold3d.Manifold(
        manifold3d.Mesh64(np.ascontiguousarray(mesh.vertices), np.ascontiguousarray(mesh.triangles, dtype=np.uint64))
    )


@pytest.mark.sweep_cases("internal", "featured", "gap", "internal_herringbone")
@pytest.mark.parametrize("name", DESIGNS)
def test_the_whole_is_two_halves_and_the_gap(name: str) -> None:
    gears, halves = gm.build(design_of(name)), single(name)
    gap = DESIGNS[name].get("gap", 0.0)
    for key, member in gears.members.items():
        solid = gears.solid(key, 0.01)
        assert solid.figures["watertight"]
        assert solid.figures["max_deviation_um"] <= 10.0
        whole = exact_volume(member)
        # facets take or add less than their tolerance over the surface, and that of a bore's polygon
        area = solid.to_trimesh().area
        assert solid.figures["volume_mm3"] == pytest.approx(whole, abs=0.01 * area)
        assert member_moments(member).volume == pytest.approx(whole, rel=1e-10)
        if name == "featured":
            continue
        half = halves.members[key]
        groove = {} if gap == 0.0 else {"d": gears.sheet().plain_tables["Double helical"]["d_gap"]}
        ring = 0.0
        if groove:
            radius = 0.5 * groove["d"][1 + (key == "gear")]
            inner = half.tooth.blank.body.profile[0][0]
            ring = np.pi * abs(radius**2 - inner**2) * gap
        holes = 0.0 if member.holes is None else 4 * np.pi * 1.0 * 46.0
        assert whole == pytest.approx(2.0 * half.tooth.volume() + ring - holes, rel=1e-11)


@pytest.mark.sweep
@pytest.mark.parametrize("name", some([name for name in DESIGNS if name != "featured"], 2))
def test_halves_are_mirror_images_and_first_has_pinions_hand(name: str) -> None:
    gears = gm.build(design_of(name))
    for key, member in gears.members.items():
        plane = plane_of(member)
        mesh = gears.solid(key, 0.02).mesh
        tree = {tuple(point) for point in np.round(mesh.vertices, 7) + 0.0}
        image = np.round(mesh.vertices * (1.0, 1.0, -1.0) + (0.0, 0.0, 2.0 * plane), 7) + 0.0
        teeth = np.isin(mesh.regions, [i for i, region in enumerate(mesh.region_names) if region.startswith("fl")])
        flank = np.unique(mesh.triangles[teeth])
        assert all(tuple(point) in tree for point in image[flank])
        # the flanks of either half wind the other way: normals of right flanks lean along +z or -z
        right = mesh.regions == mesh.region_names.index("flank_right")
        below = mesh.vertices[mesh.triangles].mean(axis=1)[:, 2] < plane
        first, second = mesh.normals[right & below, 2], mesh.normals[right & ~below, 2]
        assert np.sign(first).tolist() == [np.sign(first[0])] * len(first)
        assert np.allclose(np.sort(first), np.sort(-second), atol=1e-12)
        of_half = single(name).solid(key, 0.02).mesh
        there = of_half.regions == of_half.region_names.index("flank_right")
        assert np.sign(of_half.normals[there, 2][0]) == np.sign(first[0])


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["gap", "internal"])
def test_contact_is_that_of_one_half_and_the_other_one_touches_alike(name: str) -> None:
    gears = gm.build(design_of(name))
    contact, half = gears.contact(), single(name).contact()
    # faces of 20 and 19 mm beside each other, or 21 and 20
    narrow = 0.5 * (46.0 - DESIGNS[name]["gap"])
    overlap = narrow * np.sin(np.radians(25.0)) / (np.pi * 3.0)
    assert contact.summary["overlap_ratio"] == pytest.approx(overlap, abs=1e-9)
    for key in ("contact_ratio", "transverse_contact_ratio", "backlash_normal_min_mm"):
        assert contact.summary[key] == pytest.approx(half.summary[key], abs=1e-8)
    assert any("for one half" in line for line in contact.warnings)
    tolerance = 0.004
    parts = {key: part.mesh for key, part in gears.solids(tolerance).parts.items()}
    # both planes of symmetry lie in each other
    planes = [member.mount.base.translation[2] + plane_of(member) for member in gears.members.values()]
    assert planes[0] == pytest.approx(planes[1], abs=1e-12)
    first, second = (body(mesh) for mesh in parts.values())
    assert (first ^ second).volume() < 2.0 * tolerance * 46.0
    # turned into each other by 20 um, either half is in the way, and both as much as each other
    sense = -1.0 if contact.pair.drive * contact.pair.mounts[1].sign > 0 else 1.0
    mount = gears.members["gear"].mount.base
    angle = sense * 0.02 / (3.0 * gears.members["gear"].tooth.teeth / 2.0)
    turned = parts["gear"].move(mount.inverse).move(Rigid.about_z(angle)).move(mount)
    common = first ^ body(turned)
    below, above = (piece.volume() for piece in common.split_by_plane((0.0, 0.0, 1.0), planes[0]))
    assert min(below, above) > 0.3
    assert below == pytest.approx(above, rel=0.02)


@pytest.mark.sweep
@pytest.mark.sweep_cases("gap")
@pytest.mark.parametrize("name", some(DESIGNS, 2))
def test_cad_and_sections(name: str) -> None:
    gears = gm.build(design_of(name))
    gap = DESIGNS[name].get("gap", 0.0)
    for key, member in gears.members.items():
        made = gears.cad(key, 0.002)
        assert abs(made.figures[key]["volume_error"]) < 3e-6
        names = {face.name for face in made.parts[0].faces}
        assert {"flank_right_1", "flank_right_1_mirrored"} < names
        assert ("gap" in names) == (gap > 0.0)
        low, high = member.plain_body.ends
        # of sections as far from either end the teeth stand alike, of others they do not
        sections = [gears.section(key, z, 0.001) for z in (low + 1.0, high - 1.0, high - 5.0)]
        places = [
            np.array([curve.at(0.5) for loop in each.loops if loop.name == "teeth" for curve in loop.curves])
            for each in sections
        ]
        np.testing.assert_allclose(places[0], places[1], atol=1e-9)
        assert np.abs(places[0] - places[2]).max() > 0.1
        assert sections[0].area == pytest.approx(sections[2].area, rel=1e-5)
        if gap:
            loops = gears.section(key, 0.5 * (low + high)).loops
            assert any("gap" in str(loop) for loop in loops)


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"helix_angle": 0}, "helix_angle = 0 deg: must be above 0"),
        ({"gap": 46}, "gap = 46 mm: must be below the face width, 46"),
        ({"arrangement": "single"}, 'gap = 8 mm: needs arrangement = "double_helical"'),
        ({"assembly": {"dz": 0.1}}, "assembly.dz = 0.1 mm: must be 0 for double helical"),
        ({"gap": 0, "gear": {**GEAR, "gap_diameter": 100}}, "gear.gap_diameter = 100 mm: needs a gap above 0"),
        ({"gear": {**GEAR, "gap_diameter": 140}}, "gear.gap_diameter = 140 mm: allowed is between 30"),
    ],
)
def test_what_cannot_be_is_refused(keys: dict[str, Any], named: str) -> None:
    with pytest.raises(DesignError) as failure:
        gm.build(design_of("gap", **keys))
    assert named in str(failure.value)
    assert "\n" not in str(failure.value)


@pytest.mark.sweep
def test_the_sample_is_what_it_says() -> None:
    gears = gm.build(gm.load(SAMPLES / "double_helical.toml"))
    found = gears.contact().summary
    assert found["overlap_ratio"] == pytest.approx(1.12, abs=0.005)
    assert found["contact_ratio"] == pytest.approx(2.5, abs=0.05)
    members = gears.sheet().plain_tables["Members"]
    assert members["b_B"][1:] == [30.0, 30.0]
    assert members["hand"][1:] == ["right", "left"]


@pytest.mark.sweep
def test_limits_are_those_of_either_half() -> None:
    """Those of one half as a pair of its own, and a line that says so; an undercut half is told of once."""
    keys: dict[str, Any] = {"pinion": {"teeth": 12, "face_width": 48, "bore": 0}}
    whole = gm.build(design_of("gap", **keys)).limits()
    half = gm.build(
        gm.parse(
            {
                "kind": "cylindrical",
                "module": 3,
                "helix_angle": 25,
                "backlash": 0.1,
                "pinion": {"teeth": 12, "face_width": 20, "bore": 0},
                "gear": {"teeth": 43, "face_width": 19},
            }
        )
    ).limits()
    for name in ("pinion", "gear"):
        mine, theirs = (each.document()["members"][name] for each in (whole, half))
        np.testing.assert_equal(mine["sides"], theirs["sides"])
    lines = [line for line in whole.warnings if "first half" in line]
    assert lines == [
        f"the limits of the {name} are those of its first half; the other half is its mirror image about z = {z} mm"
        for name, z in (("pinion", 14), ("gear", 13.5))
    ]
    assert [line for line in half.warnings if line not in half.train.warnings] == [
        line for line in whole.warnings if "undercut" in line
    ]


@pytest.mark.sweep
def test_a_planetary_set_of_halves_of_other_widths_meshes_on_both() -> None:
    """Planes of symmetry in one place, no overlap as it stands, the same in both halves of a planet that is turned; the ring's mesh
    as far ahead of the sun's as the solver begins both."""
    tables = {
        "sun": {"teeth": 18, "face_width": 30},
        "planet": {"teeth": 27, "face_width": 26},
        "ring": {"teeth": -72, "face_width": 24, "manufacture": "formed", "addendum": 0.8},
    }
    keys = {"module": 2, "helix_angle": 25, "arrangement": "double_helical", "gap": 4, "planets": 2, "backlash": 0.08}
    gears = gm.build(gm.parse({"kind": "planetary", **keys, **tables}))
    members = gears.members
    planes = [member.mount.base.translation[2] + plane_of(member) for member in members.values()]
    np.testing.assert_allclose(planes, planes[0], atol=1e-12)
    gaps = gears.sheet().plain_tables["Double helical"]["d_gap"][1:]
    for name, gap in zip(("sun", "planet_1", "ring"), gaps, strict=True):
        half = members[name].tooth
        groove = np.pi * 4.0 * abs(0.25 * gap**2 - half.blank.body.profile[0][0] ** 2)
        assert exact_volume(members[name]) == pytest.approx(2.0 * half.volume() + groove, rel=1e-11)
    tolerance = 0.01
    parts = {name: part.mesh for name, part in gears.solids(tolerance).parts.items()}
    sun, planet, ring = (body(parts[name]) for name in ("sun", "planet_1", "ring"))
    assert (sun ^ planet).volume() + (planet ^ ring).volume() < 4.0 * tolerance * 26.0
    mount = members["planet_1"].mount.base
    turned = body(parts["planet_1"].move(mount.inverse).move(Rigid.about_z(0.02)).move(mount))
    for other in (sun, ring):
        below, above = (piece.volume() for piece in (turned ^ other).split_by_plane((0.0, 0.0, 1.0), planes[0]))
        assert min(below, above) > 1.0
        assert below == pytest.approx(above, rel=0.01)
    inner, outer = (gears.contact([0.0], pair=mesh) for mesh in ("sun-planet_1", "planet_1-ring"))
    begins = [
        np.sort(np.radians(contact.summary["engagement_phi1_deg"]) - before)[0] / contact.pair.pitch
        for contact, before in ((inner, 0.0), (outer, inner.path.phi2[0]))
    ]
    of_set = gears.sheet().plain_tables["Set"]
    apart = begins[0] - begins[1] - of_set["phi_r"][1]
    assert apart - round(apart) == pytest.approx(0.0, abs=5e-7)
    for contact, symbol in ((inner, "eps_s"), (outer, "eps_r")):
        assert contact.summary["contact_ratio"] == pytest.approx(of_set[symbol][1], abs=1e-8)
        assert contact.summary["backlash_normal_min_mm"] == pytest.approx(0.08, abs=1e-9)


@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"helix_angle": 0}, "helix_angle = 0 deg: must be above 0"),
        ({"gap": 24}, "gap = 24 mm: must be below the face width, 24"),
        ({"arrangement": "single"}, 'gap = 6 mm: needs arrangement = "double_helical"'),
        ({"sun": {"teeth": 18, "face_width": 30, "gap_diameter": 60}}, "sun.gap_diameter = 60 mm: allowed is between"),
        (
            {"gap": 0, "ring": {"teeth": 72, "face_width": 30, "gap_diameter": 170}},
            "ring.gap_diameter = 170 mm: needs a gap",
        ),
    ],
)
def test_what_no_set_can_be_is_refused(keys: dict[str, Any], named: str) -> None:
    tables = {name: {"teeth": teeth, "face_width": 30} for name, teeth in (("sun", 18), ("ring", 72))}
    whole = {"kind": "planetary", "module": 2, "helix_angle": 25, "arrangement": "double_helical", "gap": 6, **tables}
    with pytest.raises(DesignError) as failure:
        gm.build(gm.parse({**whole, "planet": {"teeth": 27, "face_width": 24}, **keys}))
    assert named in str(failure.value)
    assert "\n" not in str(failure.value)
