"""Bodies of members as designs ask for them: keyways by the standard, webs, holes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import ring
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Member
from gearmesh.cad.brep import exact_volume
from gearmesh.cad.section import member_section
from gearmesh.kinds import BodyFeatures
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.systems.common.standards.din6885 import keyway_in_hub
from gearmesh.teeth.blank.features import Drilling
from gearmesh.teeth.region import BODY_REGIONS

#: Ganter, technical information "DIN 6885 keyway, key details", extract page 1: bores, width, depth in the hub, mm
GANTER = (
    ((6, 7, 8), 2, 1.0),
    ((9, 10), 3, 1.4),
    ((11, 12), 4, 1.8),
    ((13, 14, 15, 16, 17), 5, 2.3),
    ((18, 20, 22), 6, 2.8),
    ((24, 25, 26, 28, 30), 8, 3.3),
    ((32, 34, 35, 36, 38), 10, 3.3),
    ((40, 42, 44), 12, 3.3),
)
#: Siemens MD 31.1, 2016, p. 7/3: diameters above, up to, width, d + t2 less d, mm
SIEMENS = (
    (38, 44, 12, 3.3),
    (44, 50, 14, 3.8),
    (50, 58, 16, 4.3),
    (58, 65, 18, 4.4),
    (65, 75, 20, 4.9),
    (75, 85, 22, 5.4),
    (85, 95, 25, 5.4),
    (95, 110, 28, 6.4),
    (110, 130, 32, 7.4),
    (130, 150, 36, 8.4),
    (150, 170, 40, 9.4),
    (170, 200, 45, 10.4),
    (200, 230, 50, 11.4),
)


#: case -> sample, the gear's keys, and radii of recess and hub, thickness of the web, number, radius and length of the holes:
#: defaults; a boss as wide as the web's hub, keyed; a boss narrower, no bore; conical gear; no web, hub and keyway
GEARS = {
    "plain web": ("spur", ["gear.web={thickness=8}"], (47.25, 35.424), 8.0, (0, 0.0, 0.0)),
    "all": (
        "spur",
        [
            "gear.bore=30",
            "gear.keyway={}",
            "gear.hub={diameter=50, length=10}",
            "gear.web={thickness=8}",
            "gear.holes={count=6, diameter=12}",
        ],
        (47.25, 25.0),
        8.0,
        (6, 6.0, 8.0),
    ),
    "no bore": (
        "spur",
        [
            "gear.bore=0",
            "gear.hub={diameter=50, length=10}",
            "gear.web={thickness=8, hub_diameter=60, rim_diameter=95}",
            "gear.holes={count=5, diameter=9, circle=77}",
        ],
        (47.5, 30.0),
        8.0,
        (5, 4.5, 8.0),
    ),
    "conical": (
        "beveloid_crossed",
        [
            "gear.bore=60",
            "gear.web={thickness=7, rim_diameter=130, hub_diameter=80}",
            "gear.holes={count=4, diameter=15}",
        ],
        (65.0, 40.0),
        7.0,
        (4, 7.5, 7.0),
    ),
    "no web": (
        "spur",
        ["gear.bore=25", "gear.keyway={}", "gear.hub={diameter=60, length=10}", "gear.holes={count=5, diameter=10}"],
        (0.0, 0.0),
        0.0,
        (5, 5.0, 28.0),
    ),
}


def gear(case: str) -> tuple[Member, float]:
    """A gear and its volume (mm^3): that of the one without web and holes, less both, in closed form."""
    sample, changes, (outer, inner), thickness, (count, radius, length) = GEARS[case]
    design = gm.load(SAMPLES / f"{sample}.toml", changes)
    member, recess = gm.build(design).members["gear"], design.in_mm().gear.face_width - thickness
    plain = [change for change in changes if not change.startswith(("gear.web", "gear.holes"))]
    whole = exact_volume(gm.build(gm.load(SAMPLES / f"{sample}.toml", plain)).members["gear"])
    return member, whole - np.pi * (recess * (outer**2 - inner**2) + count * radius**2 * length)


def pinion(*changes: str) -> Member:
    return gm.build(gm.load(SAMPLES / "spur.toml", list(changes))).members["pinion"]


@pytest.mark.quick
def test_keyways_are_those_of_the_catalogues() -> None:
    for bores, width, depth in GANTER:
        assert [keyway_in_hub(bore) for bore in bores] == [(width, depth)] * len(bores)
    for above, most, width, depth in SIEMENS:
        assert keyway_in_hub(above + 0.01) == keyway_in_hub(most) == (width, depth)
    assert keyway_in_hub(5.99) is keyway_in_hub(230.01) is None


@pytest.mark.parametrize("keyway", ["{}", '{standard = "DIN 6885"}'])
@pytest.mark.parametrize(("bore", "size"), [("17", (5.0, 2.3)), ("0.67in", (6.0, 2.8))])
def test_a_keyway_without_a_size_goes_by_the_bore(keyway: str, bore: str, size: tuple[float, float]) -> None:
    design = gm.load(SAMPLES / "spur.toml", [f"pinion.bore={bore}", f"pinion.keyway={keyway}"])
    member = gm.build(design).members["pinion"]
    assert member.keyway is not None
    assert (member.keyway.width, member.keyway.depth) == size
    assert design.resolve()["pinion"]["keyway"] == {"standard": "DIN 6885"}
    assert gm.parse(design.resolve()) == design


@pytest.mark.parametrize("case", GEARS)
@pytest.mark.sweep_cases("conical", "all", "no bore", "no web")
def test_webs_and_holes_make_solids_of_the_right_volume(case: str) -> None:
    member, expected = gear(case)
    tolerance = 2e-3
    solid = gear_solid(member, tolerance)
    proof = prove(solid, member.genus)
    assert proof.ok
    assert proof.genus == (0 if case == "no bore" else 1) + GEARS[case][4][0]
    assert proof.volume == pytest.approx(expected, rel=1e-4)
    assert exact_volume(member) == pytest.approx(expected, rel=1e-12)
    assert solid.region_names[-2:] == ("web", "hole")
    # walls of the holes, by their triangles
    named = [str(solid.region_names[k]) for k in solid.regions]
    count, radius, length = GEARS[case][4]
    walls = solid.triangles[[name == "hole" for name in named]]
    assert len(walls) > 0 or count == 0
    if count:
        assert member.holes is not None
        points = solid.vertices[walls]
        apart = np.linalg.norm(points[..., None, :2] - member.holes.centres, axis=-1).min(axis=-1)
        assert np.abs(apart - radius).max() <= tolerance
        assert np.ptp(points[..., 2]) == pytest.approx(length, abs=1e-9)
        # as many in every direction, the first on +x
        assert member.holes.centres[0] == pytest.approx([0.5 * member.holes.circle, 0.0])
        assert member.holes.centres.sum(axis=0) == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.quick
def test_bodies_without_them_have_the_regions_that_they_had() -> None:
    """And so the same files, colours included."""
    assert gear_solid(pinion("pinion.keyway={}"), 0.1).region_names[-len(BODY_REGIONS) :] == BODY_REGIONS
    assert BODY_REGIONS[-1] == "rim"


@pytest.mark.sweep
@pytest.mark.sweep_cases("no web")
@pytest.mark.parametrize("case", some(GEARS, 2))
def test_webs_and_holes_are_in_step_files(case: str, tmp_path: Path) -> None:
    """Read back: one valid solid, with the volume of the closed form."""
    pytest.importorskip("OCP")
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader
    from OCP.TopAbs import TopAbs_ShapeEnum

    _, expected = gear(case)
    sample, changes, *_, (count, _, _) = GEARS[case]
    file = tmp_path / "gear.step"
    gm.build(gm.load(SAMPLES / f"{sample}.toml", changes)).cad("gear", 1e-3).save(file)
    reader, mass = STEPControl_Reader(), GProp_GProps()
    reader.ReadFile(str(file))
    reader.TransferRoots()
    shape = reader.OneShape()
    assert shape.ShapeType() == TopAbs_ShapeEnum.TopAbs_SOLID
    assert BRepCheck_Analyzer(shape).IsValid()
    BRepGProp.VolumeProperties_s(shape, mass)
    assert mass.Mass() == pytest.approx(expected, rel=2e-6)
    text = file.read_text(encoding="latin-1")
    assert (f"'hole_{count}'" in text, f"'hole_{count + 1}'" in text) == (count > 0, False)


@pytest.mark.quick
@pytest.mark.parametrize("case", ["all", "no web"])
@pytest.mark.sweep_cases("all")
def test_sections_show_webs_and_holes(case: str) -> None:
    """Their areas, above, in and below the web, make the volume of the face."""
    member, _ = gear(case)
    assert member.hub is not None
    assert member.keyway is not None
    bare = replace(member, features=replace(member.features, hub=None))
    assert member.holes is not None
    low, high = member.body.levels(member.holes.reach, True)
    inside, outside = (member_section(member, z, 1e-5) for z in (0.5 * (low + high), 13.9))
    face = 28.0
    assert inside.area * (high - low) + outside.area * (face - high + low) == pytest.approx(
        exact_volume(bare), rel=1e-7
    )
    names = [each.name for each in inside.contours]
    assert names == ["teeth", "bore", *["holes"] * GEARS[case][4][0]]
    if case == "all":
        assert [(each.name, each.material) for each in outside.contours] == [
            ("teeth", True),
            ("web", False),
            ("web", True),
            ("bore", False),
        ]


def test_rings_have_holes_in_their_rim() -> None:
    from gearmesh.cad.brep import spline_tooth
    from gearmesh.cad.solid_part import solid_part
    from gearmesh.cad.volume import volume

    pytest.importorskip("OCP")
    member = replace(ring.ring(-1.0), features=BodyFeatures(holes=Drilling(7, 6.0, 106.0)))
    expected = ring.ring_volume() - 7 * np.pi * 9.0 * 2.0 * ring.HALF
    proof = prove(gear_solid(member, 2e-3), member.genus)
    assert proof.ok
    assert proof.volume == pytest.approx(expected, rel=1e-4)
    assert exact_volume(member) == pytest.approx(expected, rel=1e-6)
    assert volume(solid_part(member, spline_tooth(member.tooth, 1e-4))) == pytest.approx(expected, rel=1e-6)
    section = member_section(member, 0.0, 1e-5)
    assert section.area == pytest.approx(expected / (2.0 * ring.HALF), rel=1e-6)


@pytest.mark.parametrize(
    ("gear", "member", "web", "count"),
    [({"teeth": 45}, "pinion", True, 5), ({"teeth": -60, "holes": {"count": 8, "diameter": 4}}, "gear", False, 8)],
    ids=["shaped", "internal"],
)
def test_shaped_gears_have_them_too(gear: dict[str, Any], member: str, web: bool, count: int) -> None:
    own = {"teeth": 25, "face_width": 12, "shaper": {"teeth": 20}, "web": {"thickness": 5}, "holes": {"count": 5}}
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, "pinion": own, "gear": {"face_width": 12, **gear}}))
    found = gears.members[member]
    assert found.holes is not None
    assert ((found.tooth.blank.body.web is not None), found.holes.count) == (web, count)
    proof = prove(gear_solid(found, 2e-3), found.genus)
    assert proof.ok
    assert proof.volume == pytest.approx(exact_volume(found), rel=2e-4)


def test_an_internal_gear_has_no_web() -> None:
    gear = {"teeth": -60, "face_width": 12, "web": {"thickness": 5}}
    with pytest.raises(gm.DesignError, match=r"^gear\.web: an internal gear has none"):
        gm.parse({"kind": "cylindrical", "module": 2, "pinion": {"teeth": 25, "face_width": 12}, "gear": gear})


def test_finite_element_models_say_what_they_leave_out() -> None:
    keys = ["gear.web={thickness=8}", "fe.teeth=1", "fe.flank=4", "fe.fillet=3", "fe.face=4", "fe.thickness=2"]
    gears = gm.build(gm.load(SAMPLES / "spur.toml", keys))
    assert (
        'the finite-element model has none of: web (gear); fe.body = "whole" has those that are turned'
        in gears.finite_elements().warnings
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            ["pinion.keyway={}", "pinion.bore=5.9"],
            "pinion.keyway.standard = DIN 6885: has no keyway for a bore of 5.9 mm; "
            "allowed is a pinion.bore from 6 to 230 mm, or pinion.keyway.width and depth",
        ),
        (
            ["pinion.keyway={}", "pinion.bore=0"],
            "pinion.bore = 0 mm: allowed is at least 6.001 mm, with the other keys unchanged: a keyway needs a bore",
        ),
        (
            ["pinion.keyway={}", "pinion.bore=50"],
            "pinion.bore = 50 mm: allowed is at most 44.58 mm, with the other keys unchanged: "
            "pinion.keyway.depth = 3.8 mm: allowed is less than 1.09234 mm (to the root)",
        ),
        (
            ["pinion.keyway={width=3}"],
            "pinion.keyway.width = 3 mm: depth is missing; give both, or neither for the standard sizes",
        ),
        (
            ['pinion.keyway={width=3, depth=1, standard="DIN 6885"}'],
            "pinion.keyway.width = 3 mm: cannot be given together with standard",
        ),
        (
            ["pinion.web={thickness=30}"],
            "pinion.web.thickness = 30 mm: allowed is less than the face width, 30 mm",
        ),
        (
            ["pinion.bore=25", "pinion.web={thickness=5}"],
            "pinion.web.thickness = 5 mm: there is no room for a web between a hub of 40 mm and the root, 54.3 mm, "
            "less a rim of 1.2 whole depths; allowed is another web.hub_diameter or rim_diameter",
        ),
        (
            ["pinion.bore=10", "pinion.web={thickness=5, hub_diameter=9}"],
            "pinion.web.hub_diameter = 9 mm: allowed is more than the bore, 10 mm",
        ),
        (
            ["pinion.bore=10", "pinion.web={thickness=5, hub_diameter=39}"],
            "pinion.web.hub_diameter = 39 mm: allowed is less than web.rim_diameter, by default 38.1 mm",
        ),
        (
            ["pinion.bore=10", "pinion.web={thickness=5, rim_diameter=55}"],
            "pinion.web.rim_diameter = 55 mm: allowed is less than the smallest root diameter, 54.3 mm",
        ),
        (
            ["pinion.bore=10", "pinion.web={thickness=5, rim_diameter=15}"],
            "pinion.web.rim_diameter = 15 mm: allowed is more than web.hub_diameter, 16 mm, and less than the root, 54.3 mm",
        ),
        (
            ["pinion.bore=10", "pinion.web={thickness=5, hub_diameter=12}", "pinion.keyway={}"],
            "pinion.web.hub_diameter = 12 mm: allowed is at least 13.42 mm, with the other keys unchanged: "
            "pinion.keyway.depth = 1.4 mm: allowed is less than 0.66994 mm (to the hub of the web)",
        ),
        (
            ["pinion.bore=10", "pinion.web={thickness=5, hub_diameter=17}", "pinion.hub={diameter=18, length=3}"],
            "pinion.hub.diameter = 18 mm: allowed is between 10 (bore) and 17 mm (hub of the web)",
        ),
        (
            ["pinion.bore=10", "pinion.holes={count=3, diameter=25}"],
            "pinion.holes.diameter = 25 mm: allowed is less than the room for them, 21.88 mm",
        ),
        (
            ["pinion.bore=10", "pinion.holes={count=3, diameter=5, circle=15}"],
            "pinion.holes.circle = 15 mm: allowed is between 15.27 and 49.03 mm",
        ),
        (
            ["pinion.bore=10", "pinion.holes={count=20, diameter=8, circle=40}"],
            "pinion.holes.count = 20: holes of 8 mm overlap; allowed is at most 15",
        ),
    ],
)
@pytest.mark.sweep_cases("changes1-message1", "changes11-message11", "changes2-message2")
def test_bodies_that_cannot_be_are_refused(changes: list[str], message: str) -> None:
    with pytest.raises(gm.DesignError) as refused:
        pinion(*changes)
    assert str(refused.value) == message
