"""Hubs, shafts, stepped bores, bolt holes and spokes of all kinds: solids, volumes in closed form, STEP, mass, refusals."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from _pytest.mark import ParameterSet
from scipy.integrate import quad

import gearmesh as gm
from gearmesh import DesignError, Member
from gearmesh.cad.brep import exact_volume, spline_tooth
from gearmesh.cad.section import member_section
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.blank.moments import Moments, member_moments

SAMPLES = Path(__file__).parents[2] / "samples"


def member(sample: str, name: str, *keys: str) -> Member:
    design = gm.load(SAMPLES / f"{sample}.toml", [f"{name}.{key}" for key in keys])
    return gm.build(design).members[name]


def disc(diameter: float, length: float, bore: float = 0.0) -> float:
    return 0.25 * math.pi * (diameter**2 - bore**2) * length


def cone(one: float, other: float, length: float) -> float:
    return math.pi / 12.0 * length * (one**2 + one * other + other**2)


def between_spokes(count: int, width: float, inner: float, outer: float) -> float:
    """Area of all openings between spokes with sharp corners: what of the ring the spokes do not take."""
    taken = quad(lambda rho: 2.0 * rho * math.asin(0.5 * width / rho), 0.5 * inner, 0.5 * outer, epsabs=1e-12)[0]
    return 0.25 * math.pi * (outer**2 - inner**2) - count * taken


def thickness(plain: Member) -> float:
    """Axial thickness, mm, of the body beside its bore."""
    (_, low), (_, high) = plain.body.profile[plain.body.bore_band : plain.body.bore_band + 2]
    return high - low


def ring_steps(plain: Member) -> float:
    rim = 2.0 * plain.body.profile[0][0]
    return disc(250, 5, rim) - disc(rim, 4, 190) - disc(rim, 3, 186) - disc(4, 7)


def flat(bore: float, distance: float) -> float:
    """Area between a circle and its chord at a distance from the axis."""
    return 2.0 * quad(lambda x: math.sqrt(0.25 * bore**2 - x**2), distance, 0.5 * bore, epsabs=1e-13)[0]


def beyond_hexagon(across: float, bore: float) -> float:
    """Area of the corners of a hexagon beyond a circle that is at least as wide as the flats."""
    return 0.5 * math.sqrt(3.0) * across**2 - 0.25 * math.pi * bore**2 + 6.0 * flat(bore, 0.5 * across)


@dataclass(frozen=True)
class Case:
    """A member with keys that make its body plain, and those of features, which add a volume (mm^3); holes through it."""

    sample: str
    name: str
    plain: tuple[str, ...]
    features: tuple[str, ...]
    added: Callable[[Member], float]
    genus: int


CASES = {
    "hubs and stepped bore": Case(
        "spur",
        "gear",
        ("bore=20",),
        (
            "hub={diameter=50,length=12}",
            "toe_hub={diameter=45,length=8}",
            "heel_bore={diameters=[40,30],lengths=[5,3]}",
            "toe_bore={diameters=[28],lengths=[9]}",
        ),
        lambda _: disc(50, 12, 20) + disc(45, 8, 20) - disc(40, 5, 20) - disc(30, 3, 20) - disc(28, 9, 20),
        1,
    ),
    "spokes and bolts": Case(
        "spur",
        "gear",
        ("bore=20", "web={thickness=10,hub_diameter=45}"),
        (
            "bolts={count=6,diameter=5,circle=35}",
            "spokes={count=5,width=8,inner_diameter=50,outer_diameter=90,corner_radius=0,start_angle=7}",
        ),
        lambda _: -6 * disc(5, 28) - 10.0 * between_spokes(5, 8.0, 50.0, 90.0),
        1 + 6 + 5,
    ),
    "ring with steps": Case(
        "internal",
        "gear",
        ("rim=25",),
        (
            "heel_bore={diameters=[250],lengths=[5]}",
            "toe_bore={diameters=[190,186],lengths=[4,3]}",
            "bolts={count=1,diameter=4,circle=178,depth=7}",
        ),
        ring_steps,
        1,
    ),
    "bevel pinion on its shaft": Case(
        "spiral_bevel_basic",
        "pinion",
        ("bore=0",),
        (
            "heel_shaft={diameters=[20,15],lengths=[12,20],end_diameters=[18,15]}",
            "toe_shaft={diameters=[10],lengths=[20]}",
        ),
        lambda _: cone(20, 18, 12) + disc(15, 20) + disc(10, 20),
        0,
    ),
    "bevel wheel": Case(
        "spiral_bevel_basic",
        "gear",
        ("bore=30",),
        ("web={thickness=9,hub_diameter=50,rim_diameter=62}", "bolts={count=7,diameter=3,circle=42}"),
        lambda plain: -disc(62, thickness(plain) - 9.0, 50) - 7 * disc(3, thickness(plain)),
        8,
    ),
    "rack with blind holes": Case(
        "rack",
        "rack",
        (),
        ("bolts={count=5,diameter=6,height=8,depth=17}",),
        lambda _: -5 * disc(6, 17),
        0,
    ),
    "rack with holes": Case(
        "rack",
        "rack",
        ("tip_rounding=0.3",),
        ("bolts={count=3,diameter=6,pitch=60}",),
        lambda _: -3 * disc(6, 24),
        3,
    ),
    "hexagon, drilled wider": Case(
        "helical",
        "gear",
        ("bore=43",),
        ("hex_bore={across_flats=40}", "hub={diameter=60,length=9}"),
        lambda plain: disc(60, 9, 43) - beyond_hexagon(40.0, 43.0) * (thickness(plain) + 9.0),
        1,
    ),
    "hexagon of a bevel wheel": Case(
        "spiral_bevel_basic",
        "gear",
        ("bore=30",),
        ("bore=30", "hex_bore={across_flats=30}", "heel_bore={diameters=[60],lengths=[5]}"),
        lambda plain: -disc(60, 5, 30) - beyond_hexagon(30.0, 30.0) * (thickness(plain) - 5.0),
        1,
    ),
    "D bore": Case(
        "spur", "gear", ("bore=20",), ("d_bore={height=16}",), lambda plain: flat(20.0, 6.0) * thickness(plain), 1
    ),
    "two flats": Case(
        "spur",
        "gear",
        ("bore=20",),
        ("d_bore={height=16,flats=2}", "toe_bore={diameters=[40],lengths=[8]}"),
        lambda plain: 2.0 * flat(20.0, 8.0) * (thickness(plain) - 8.0) - disc(40, 8, 20),
        1,
    ),
    "face gear": Case(
        "face_gear",
        "gear",
        ("bore=500",),
        ("toe_hub={diameter=600,length=28}", "holes={count=8,diameter=60,circle=750}"),
        lambda plain: disc(600, 28, 500) - 8 * disc(60, thickness(plain)),
        9,
    ),
}


@cache
def both(case: str) -> tuple[Member, Member]:
    """The member with and without its features."""
    own = CASES[case]
    return member(own.sample, own.name, *own.plain, *own.features), member(own.sample, own.name, *own.plain)


def swept(cases: Iterable[str], always: set[str]) -> list[ParameterSet]:
    """All cases, those that are not always run with the mark sweep."""
    return [pytest.param(case, marks=() if case in always else pytest.mark.sweep) for case in cases]


@pytest.mark.sweep_cases("bevel wheel")
@pytest.mark.parametrize("case", swept(CASES, {"hubs and stepped bore", "spokes and bolts", "bevel wheel", "D bore"}))
def test_features_make_solids_of_the_right_volume(case: str) -> None:
    """Exact volumes in closed form; meshes are proved solids that come to them."""
    whole, plain = both(case)
    expected = CASES[case].added(plain)
    assert whole.genus == CASES[case].genus
    assert exact_volume(whole) - exact_volume(plain) == pytest.approx(expected, rel=1e-9)
    meshed = [prove(gear_solid(one, 0.02), one.genus) for one in (whole, plain)]
    assert meshed[0].ok
    assert meshed[0].volume - meshed[1].volume == pytest.approx(expected, rel=1e-2)


@pytest.mark.sweep
@pytest.mark.sweep_cases("ring with steps", "hexagon of a bevel wheel")
@pytest.mark.parametrize(
    "case",
    swept(
        [
            *("hubs and stepped bore", "spokes and bolts", "ring with steps", "bevel wheel"),
            *("hexagon, drilled wider", "hexagon of a bevel wheel", "D bore", "two flats"),
        ],
        {"spokes and bolts", "ring with steps", "hexagon of a bevel wheel"},
    ),
)
def test_step_files_have_them_as_planes_cylinders_and_cones(case: str) -> None:
    """One valid solid; what the faces of the features change of its volume is the closed form, without facets."""
    pytest.importorskip("OCP")
    from gearmesh.cad.solid_part import solid_part
    from gearmesh.cad.volume import volume

    whole, plain = both(case)
    teeth = spline_tooth(whole.tooth, 1e-3)
    part = solid_part(whole, teeth)
    change = volume(part) - volume(solid_part(plain, teeth))
    assert change == pytest.approx(CASES[case].added(plain), rel=1e-9)
    kinds = {face.region for face in part.faces}
    assert (
        kinds
        >= {
            "hubs and stepped bore": {"hub", "counterbore"},
            "spokes and bolts": {"bolt", "spoke", "web"},
            "ring with steps": {"bolt", "rim"},
            "bevel wheel": {"bolt", "web"},
            "hexagon, drilled wider": {"bore", "bore_flat", "hub"},
            "hexagon of a bevel wheel": {"bore_flat", "counterbore"},
            "D bore": {"bore", "bore_flat"},
            "two flats": {"bore", "bore_flat", "counterbore"},
        }[case]
    )


@pytest.mark.parametrize("case", ["rack with blind holes", pytest.param("rack with holes", marks=pytest.mark.sweep)])
def test_holes_across_a_bar_are_cylinders_in_step_files(case: str) -> None:
    pytest.importorskip("OCP")
    from gearmesh.cad.bar import bar_part, has_straight_faces, spline_bar_part
    from gearmesh.cad.volume import volume

    parts = [
        bar_part(one)[0] if has_straight_faces(one) else spline_bar_part(one, spline_tooth(one.tooth, 1e-3))
        for one in both(case)
    ]
    assert volume(parts[0]) - volume(parts[1]) == pytest.approx(CASES[case].added(both(case)[1]), rel=1e-9)
    walls = 2 if case == "rack with blind holes" else 1
    assert [face.region for face in parts[0].faces].count("bolt") == walls * both(case)[0].features.row.count
    # sections and the sheet have them, too
    areas = [member_section(one, 0.5, 1e-4).area for one in both(case)]
    assert areas[1] - areas[0] == pytest.approx(both(case)[0].features.row.count * disc(6, 1.0), rel=1e-9)


def test_rounded_spokes_lose_what_their_corners_have() -> None:
    """Outlines of lines and arcs are closed and smooth; a corner between two tangents at a right angle has (1 - pi / 4) r^2."""
    whole = member("spur", "gear", "bore=20", "spokes={count=4,width=9,corner_radius=2}")
    spokes = whole.features.spokes
    assert spokes is not None
    for outline in spokes.outlines:
        for curve, after in zip(outline, (*outline[1:], outline[0]), strict=True):
            assert curve.end == pytest.approx(after.start, abs=1e-12)
            ends = curve.slope(np.ones(1))[0], after.slope(np.zeros(1))[0]
            cosine = ends[0] @ ends[1] / np.linalg.norm(ends[0]) / np.linalg.norm(ends[1])
            assert cosine == pytest.approx(1.0, abs=1e-12)
    area = sum(curve.swept for outline in spokes.outlines for curve in outline)
    sharp = between_spokes(4, 9.0, spokes.inner, spokes.outer)
    assert sharp - area == pytest.approx(16 * (1.0 - 0.25 * math.pi) * 4.0, rel=0.25)
    section = member_section(whole, 0.0, 1e-5)
    plain = member_section(member("spur", "gear", "bore=20"), 0.0, 1e-5)
    assert plain.area - section.area == pytest.approx(area, rel=1e-9)


@pytest.mark.parametrize(
    ("keys", "area"),
    [
        (("bore=20", "hex_bore={across_flats=20}"), 0.5 * math.sqrt(3.0) * 400.0),
        (("bore=21.5", "hex_bore={across_flats=20}"), beyond_hexagon(20.0, 21.5) + disc(21.5, 1.0)),
        (("bore=20", "d_bore={height=16}"), disc(20, 1.0) - flat(20.0, 6.0)),
        (("bore=20", "d_bore={height=16,flats=2}"), disc(20, 1.0) - 2.0 * flat(20.0, 8.0)),
    ],
)
def test_bores_that_are_not_round_are_exact_in_sections_and_moments(keys: tuple[str, ...], area: float) -> None:
    whole, plain = member("spur", "gear", *keys), member("spur", "gear", keys[0])
    (form,) = (line.curves for line in member_section(whole, 0.0, 1e-3).contours if line.name == "bore")
    for curve, after in zip(form, (*form[1:], form[0]), strict=True):
        assert curve.end == pytest.approx(after.start, abs=1e-12)
    assert sum(curve.swept for curve in form) == pytest.approx(area, rel=1e-12)
    change = member_moments(whole).volume - member_moments(plain).volume
    assert change == pytest.approx((disc(float(keys[0][5:]), 1.0) - area) * thickness(plain), rel=1e-8)


def test_sectors_keep_a_hexagon_that_repeats() -> None:
    from gearmesh.mesh.extracts.sector import cyclic, sector

    whole = member("helical", "gear", "hex_bore={across_flats=40}")
    alike, none = cyclic(whole, 8)
    assert alike is whole
    assert none == ()
    assert sector(solid := gear_solid(whole, 0.05), whole, 8).volume() == pytest.approx(solid.volume() / 6.0, rel=1e-12)
    bare, (warning,) = cyclic(whole, 5)
    assert bare.bore_form is None
    assert warning.endswith("has no hexagon of the bore, which does not repeat after 5 of 48 pitches")


def mesh_moments(mesh: TriangleMesh) -> tuple[float, Array, Array]:
    """Volume, first and second moments of a closed mesh, by tetrahedra from the origin."""
    corners = mesh.vertices[mesh.triangles]
    volumes = np.linalg.det(corners) / 6.0
    total = corners.sum(axis=1)
    products = np.einsum("nki,nkj->nij", corners, corners) + total[:, :, None] * total[:, None, :]
    return float(volumes.sum()), volumes @ total / 4.0, np.einsum("n,nij->ij", volumes, products) / 20.0


def facet_areas(mesh: TriangleMesh) -> float:
    """Area of all facets, mm^2."""
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    return float(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


#: members without symmetry: one blind hole, a conical gear with a single hole, a rack longer than its teeth; and tolerances, mm
UNEVEN = {
    "ring": (("internal", "gear", "rim=20", "bolts={count=1,diameter=9,depth=7}"), 0.005),
    "conical": (("beveloid_crossed", "gear", "bolts={count=1,diameter=9,circle=90}"), 0.005),
    "bevel": (("spiral_bevel_basic", "pinion", "keyway={width=4,depth=2}"), 0.005),
    "rack": (("rack", "rack", "length=300", "bolts={count=2,diameter=6,pitch=31,height=7,depth=9}"), 0.005),
}


@pytest.mark.parametrize("case", swept(UNEVEN, {"conical", "rack"}))
@pytest.mark.sweep_cases("conical")
def test_moments_are_those_of_meshes(case: str) -> None:
    """Between a mesh and the exact surfaces is at most its tolerance on all of its area, no farther out than it reaches."""
    keys, tolerance = UNEVEN[case]
    whole = member(*keys)
    exact: Moments = member_moments(whole)
    assert exact.volume == pytest.approx(exact_volume(whole), rel=1e-10)
    assert np.abs(exact.centre[:2]).max() > 1e-3
    assert np.abs(exact.second - exact.second.T).max() < 1e-12 * np.abs(exact.second).max()
    mesh = gear_solid(whole, tolerance)
    between, reach = tolerance * facet_areas(mesh), float(np.linalg.norm(mesh.vertices, axis=1).max())
    for power, (own, of_mesh) in enumerate(
        zip((exact.volume, exact.first, exact.second), mesh_moments(mesh), strict=True)
    ):
        assert np.abs(of_mesh - own).max() < between * reach**power
        # and this is less than what is to be proved
        assert between * reach**power < 0.02 * exact.volume * reach**power


#: what is asked for -> sample, member, keys, and the refusal
REFUSED = [
    (
        "spur",
        "gear",
        ["bolts={count=4,diameter=6,circle=104}"],
        "104 mm: leaves a rim of 0.35 mm, 0.12 modules",
    ),
    (
        "spur",
        "gear",
        ["bore=20", "toe_bore={diameters=[110],lengths=[4]}"],
        "at least 3.375 mm of rim, 1.12 modules",
    ),
    ("spur", "gear", ["bore=20", "toe_bore={diameters=[30,40],lengths=[4,4]}"], "falling from the end face inwards"),
    (
        "spur",
        "gear",
        ["bore=20", "hub={diameter=40,length=9}", "heel_bore={diameters=[40],lengths=[4]}"],
        "breaks through",
    ),
    ("spur", "gear", ["bore=20", "keyway={}", "toe_bore={diameters=[25],lengths=[4]}"], "all above the keyway, 26.2"),
    (
        "spur",
        "gear",
        ["web={thickness=8}", "bolts={count=4,diameter=9,circle=94}"],
        "do not begin and end on one plane",
    ),
    ("spur", "gear", ["spokes={count=9,width=30}"], "leaves no opening between the spokes; allowed is less than"),
    (
        "spur",
        "gear",
        ["bore=20", "spokes={count=6,width=8,inner_diameter=1}"],
        "gear.spokes.inner_diameter = 1 mm: allowed is at least 22.4",
    ),
    (
        "spur",
        "gear",
        ["spokes={count=6,width=8,outer_diameter=900}"],
        "spokes.outer_diameter = 900 mm: allowed is more than",
    ),
    (
        "spur",
        "gear",
        ["bolts={count=4,diameter=6,depth=900}"],
        "bolts.depth = 900 mm: the holes do not end in the body",
    ),
    ("spur", "gear", ["spokes={count=4,width=9}", "bolts={count=5,diameter=6,circle=80}"], "meet those of bolts"),
    (
        "spur",
        "gear",
        ["bore=20", "keyway={}", "bolts={count=1,diameter=3,circle=28}"],
        "28 mm: leaves no wall to the keyway; allowed is at least 29.5638 mm, or another start_angle",
    ),
    ("spur", "gear", ["heel_shaft={diameters=[20,30],lengths=[5]}"], "must be 2 lengths, one for each of diameters"),
    ("internal", "gear", ["toe_bore={diameters=[153],lengths=[5]}"], "leaves a rim of 1.13 mm, 0.57 modules"),
    ("internal", "gear", ["heel_shaft={diameters=[20],lengths=[5]}"], "an internal gear has none"),
    pytest.param(
        "spiral_bevel_basic",
        "gear",
        ["bolts={count=6,diameter=4,circle=150,depth=15}"],
        "leaves no rim at the roots",
        marks=pytest.mark.sweep,
    ),
    ("spiral_bevel_basic", "gear", ["web={thickness=9,rim_diameter=170}"], "less than what leaves 0.5 whole depths"),
    ("rack", "rack", ["hub={diameter=6,length=4}"], "a rack is a bar"),
    (
        "rack",
        "rack",
        ["bolts={count=6,diameter=4,height=18}"],
        "leaves no rim at the roots; allowed is at least 2.25 mm of rim",
    ),
    ("rack", "rack", ["bolts={count=6,diameter=4,height=2}"], "break out of the back; allowed is more than 2 mm"),
    ("rack", "rack", ["bolts={count=6,diameter=4,pitch=4}"], "the holes overlap; allowed is more than 4 mm"),
    ("rack", "rack", ["bolts={count=6,diameter=4,pitch=38}"], "allowed is less than 37.4976 mm"),
    ("rack", "rack", ["bolts={count=6,diameter=4,depth=24}"], "allowed is less than the face width, 24 mm"),
]


@pytest.mark.quick
@pytest.mark.parametrize(("sample", "name", "keys", "line"), REFUSED)
@pytest.mark.sweep_cases(
    "rack-rack-keys18-leaves no rim at the roots; allowed is at least 2.25 mm of rim",
    "spur-gear-keys7-gear.spokes.inner_diameter = 1 mm: allowed is at least 22.4",
)
def test_what_does_not_fit_is_refused_with_the_figure(sample: str, name: str, keys: list[str], line: str) -> None:
    with pytest.raises(DesignError) as refusal:
        member(sample, name, *keys)
    assert line in str(refusal.value)


@pytest.mark.sweep
def test_end_chamfers_of_double_helical_racks_keep_off_the_holes() -> None:
    """The bound is that of the same rack in one piece."""
    stub = ["addendum=0.3", "dedendum=0.4", "bolts={count=6,diameter=5,height=19.2}"]
    lines = []
    for arrangement in ("single", "double_helical"):
        keys = [f"rack.{key}" for key in (*stub, "end_chamfer=1")]
        with pytest.raises(DesignError) as refusal:
            gm.build(gm.load(SAMPLES / "rack.toml", [f"arrangement={arrangement}", "helix_angle=30", *keys]))
        lines.append(str(refusal.value))
    assert lines[1] == "rack.end_chamfer = 1 mm: reaches the holes in the end face; allowed is at most 0.899999 mm"
    assert lines[0].rpartition(";")[2] == lines[1].rpartition(";")[2]


#: sample, member, other keys, a key with the place of its value, one that is refused, and the word before the bound
BOUNDS = [
    ("spur", "gear", [], "bolts={count=4,diameter=6,circle=%s}", 104, "at most"),
    ("spur", "gear", [], "bolts={count=4,diameter=%s}", 28, "at most"),
    ("spur", "gear", ["bore=20", "hub={diameter=60,length=5}"], "bolts={count=4,diameter=6,circle=%s}", 104, "at most"),
    ("spur", "gear", ["bore=20"], "toe_bore={diameters=[%s],lengths=[4]}", 110, "at most"),
    ("spur", "gear", ["bore=20"], "toe_bore={diameters=[%s],lengths=[4]}", 123, "at most"),
    ("spur", "gear", ["bore=20"], "spokes={count=6,width=8,outer_diameter=%s}", 900, "at most"),
    ("spur", "gear", ["bore=20"], "spokes={count=6,width=4,inner_diameter=%s}", 1, "at least"),
    ("face_gear", "gear", [], "spokes={count=6,width=30,outer_diameter=%s}", 1000, "at most"),
    ("spur", "gear", ["bore=20"], "keyway={width=6,depth=%s}", 60, "less than"),
    ("spur", "gear", ["bore=20", "keyway={}"], "hub={length=5,diameter=%s}", 26, "between"),
    ("spur", "gear", [], "bolts={count=4,diameter=6,circle=80,depth=%s}", 29, "less than"),
    ("spur", "gear", ["bore=20"], "d_bore={height=%s}", 21, "and"),
    ("spur", "gear", ["bore=20"], "d_bore={height=%s}", 9, "between"),
    ("spur", "gear", ["hex_bore={across_flats=20}"], "bore=%s", 24, "less than"),
    ("spur", "gear", [], "hex_bore={across_flats=%s}", 100, "less than"),
    ("internal", "gear", [], "toe_bore={diameters=[%s],lengths=[5]}", 153, "at least"),
    ("internal", "gear", ["rim=20"], "bolts={count=4,diameter=6,circle=%s}", 156, "at least"),
    ("internal", "gear", ["rim=20"], "bolts={count=4,diameter=%s}", 19, "at most"),
    ("internal", "gear", [], "holes={count=4,circle=157,diameter=%s}", 7, "them,"),
    pytest.param("novikov", "pinion", [], "holes={count=4,diameter=8,circle=%s}", 77, "and", marks=pytest.mark.sweep),
    ("spiral_bevel_basic", "gear", [], "web={thickness=9,rim_diameter=%s}", 170, "roots,"),
    ("spiral_bevel_basic", "gear", [], "bolts={count=6,diameter=4,depth=10,circle=%s}", 163, "at most"),
    ("spur", "gear", ["end_chamfer_toe=0.3"], "end_rounding_heel=%s", 9, "at most"),
    pytest.param(
        "hypoid", "gear", ["end_chamfer_heel=0.3"], "end_rounding_toe=%s", 9, "at most", marks=pytest.mark.sweep
    ),
]


@pytest.mark.quick
@pytest.mark.parametrize(("sample", "name", "others", "key", "value", "word"), BOUNDS)
@pytest.mark.sweep_cases(
    "face_gear-gear-others7-spokes={count=6,width=30,outer_diameter=%s}-1000-at most",
    "internal-gear-others15-toe_bore={diameters=[%s],lengths=[5]}-153-at least",
    "internal-gear-others16-bolts={count=4,diameter=6,circle=%s}-156-at least",
    "internal-gear-others17-bolts={count=4,diameter=%s}-19-at most",
    "internal-gear-others18-holes={count=4,circle=157,diameter=%s}-7-them,",
    "spiral_bevel_basic-gear-others20-web={thickness=9,rim_diameter=%s}-170-roots,",
    "spiral_bevel_basic-gear-others21-bolts={count=6,diameter=4,depth=10,circle=%s}-163-at most",
    "spur-gear-others22-end_rounding_heel=%s-9-at most",
    "spur-gear-others5-spokes={count=6,width=8,outer_diameter=%s}-900-at most",
    "spur-gear-others6-spokes={count=6,width=4,inner_diameter=%s}-1-at least",
)
def test_the_figure_of_a_refusal_is_the_first_that_works(
    sample: str, name: str, others: list[str], key: str, value: float, word: str
) -> None:
    def refused(value: float) -> DesignError | None:
        try:
            member(sample, name, *others, key % value)
        except DesignError as refusal:
            return refusal
        return None

    refusal = refused(value)
    assert refusal is not None
    stated = re.search(rf"\b{word} (\d[\d.]*)", refusal.allowed)
    assert stated is not None, refusal
    bound = float(stated[1])
    way = 1.0 if bound < value else -1.0
    assert refused(bound - way * 1e-5 * bound) is None
    assert refused(bound + way * 1e-3 * bound) is not None


@pytest.mark.sweep
@pytest.mark.parametrize(
    "keys",
    [
        ("bore=30", "spokes={count=3,width=6,inner_diameter=30.3}"),
        (
            "bore=30",
            "web={thickness=12,hub_diameter=50,rim_diameter=90}",
            "spokes={count=5,width=8,inner_diameter=50.3,outer_diameter=89.7}",
        ),
        ("bore=30", "keyway={}", "hub={length=6,diameter=37.6}"),
        ("bore=30", "bolts={count=5,diameter=8,circle=38.4}"),
    ],
)
@pytest.mark.sweep_cases("keys0", "keys1", "keys3")
def test_thinnest_allowed_walls_are_in_meshes_and_cad_solids(keys: tuple[str, ...]) -> None:
    """However coarse the mesh: chords of an opening do not cut through to the bore. Thinner ones are refused."""
    part = member("spur", "gear", *keys)
    for tolerance in (0.4, 0.02):
        mesh = gear_solid(part, tolerance)
        assert prove(mesh, part.genus).ok
        assert abs(mesh.volume() - exact_volume(part)) < tolerance * facet_areas(mesh)
    figures = (
        gm.build(gm.load(SAMPLES / "spur.toml", [f"gear.{key}" for key in keys])).cad("gear", 0.02).figures["gear"]
    )
    assert abs(figures["volume_error"]) < 1e-5
