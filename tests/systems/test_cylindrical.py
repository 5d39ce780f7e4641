"""Cylindrical gears: what ISO 21771 says in closed form against what is measured on the exact teeth, external and internal."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.app.cli import main
from gearmesh.kinds import Side, along
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, distance_of
from gearmesh.systems.cylindrical.geometry.interference import reserves
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.system import complete_design

ARCSEC = math.pi / 180.0 / 3600.0


def parsed(pinion: dict[str, Any], gear: dict[str, Any], **keys: Any) -> Any:
    """A pair of 20 mm face width unless told otherwise."""
    members = {name: {"face_width": 20, **own} for name, own in (("pinion", pinion), ("gear", gear))}
    return gm.parse({"kind": "cylindrical", "module": 2, **keys, **members})


#: pairs of many sorts: shifted, helical of either hand, shaped, internal on either side
PAIRS: dict[str, Any] = {
    "shifted": ({"teeth": 18, "profile_shift": 0.3}, {"teeth": 45, "profile_shift": -0.1}, {}),
    "left_helical": ({"teeth": 17}, {"teeth": 31, "profile_shift": 0.4}, {"helix_angle": 24, "hand": "left"}),
    "shaped": ({"teeth": 25, "shaper": {"teeth": 20}}, {"teeth": 40}, {"helix_angle": 12}),
    "internal": ({"teeth": 20, "profile_shift": 0.2}, {"teeth": -61, "profile_shift": 0.1}, {}),
    "internal_helical": ({"teeth": 23}, {"teeth": 71, "internal": True}, {"helix_angle": 18, "module": 1.5}),
    "internal_oblique": ({"teeth": 20}, {"teeth": -60}, {"helix_angle": 15}),
    "few_and_many": ({"teeth": 17}, {"teeth": 45}, {"helix_angle": 5.56}),
    "ring_drives": ({"teeth": -67, "profile_shift": -0.1}, {"teeth": 19}, {"helix_angle": 30, "hand": "left"}),
}


@pytest.fixture(params=PAIRS, scope="module")
def pair(request: pytest.FixtureRequest) -> tuple[Any, gm.Gears]:
    pinion, gear, keys = PAIRS[request.param]
    design = parsed(pinion, gear, backlash=0.08, **keys)
    return proportions(design), gm.build(design)


def test_teeth_are_as_thick_as_the_closed_form_says_at_every_radius(pair: tuple[Any, gm.Gears]) -> None:
    found, gears = pair
    for name, tip in zip(("pinion", "gear"), found.tips, strict=True):
        own: Toothing = getattr(found.mesh, name)
        tooth = gears.members[name].tooth
        for which in Side:
            side = tooth.side(which)
            p = np.repeat(np.linspace(side.form_point[0], tooth.even.of(which).tip[12], 7), 3)
            z = np.tile([-9.0, 0.5, 8.0], 7)
            r = along(side.flank, p, tooth.blank.axial.value(np.stack((0 * z, 0 * z, z), axis=-1)), tooth.blank.axial)[
                1
            ].r
            rho = np.hypot(r[:, 0], r[:, 1])
            assert abs(rho - tip).min() < 1e-9
            angle = np.arctan2(r[:, 1], r[:, 0]) - own.twist * r[:, 2]
            exact = np.array([own.half_angle(float(each)) for each in rho])
            assert np.abs((-which.sign * angle - exact) * rho).max() < 1e-11
            assert r[:, 2] == pytest.approx(z, abs=1e-12)


@pytest.mark.sweep_cases(
    "internal_oblique", "ring_drives", "few_and_many", "internal", "internal_helical", "left_helical", "shaped"
)
def test_backlash_wanted_is_backlash_measured(pair: tuple[Any, gm.Gears]) -> None:
    found, gears = pair
    summary = gears.contact(cycle=True).summary
    assert found.mesh.normal_backlash == pytest.approx(0.08, abs=1e-12)
    for end in ("min", "max"):
        assert summary[f"backlash_normal_{end}_mm"] == pytest.approx(0.08, abs=1e-9)
    turn = math.degrees(found.mesh.working_backlash / found.mesh.working_radius(found.mesh.gear))
    assert summary["backlash_min_deg"] == pytest.approx(turn, abs=1e-9)
    assert summary["mesh_te_peak_to_peak_arcsec"] < 1e-7


@pytest.mark.sweep
@pytest.mark.sweep_cases(
    "ring_drives", "internal_helical", "few_and_many", "internal_oblique", "left_helical", "shaped", "shifted"
)
def test_contact_ratio_is_the_closed_form(pair: tuple[Any, gm.Gears]) -> None:
    found, gears = pair
    mesh = found.mesh
    first, second = mesh.pinion.roll_length(found.tips[0]), mesh.gear.roll_length(found.tips[1])
    begins = mesh.mating_roll_length(second, mesh.gear)
    length = abs(first - begins)
    summary = gears.contact(cycle=True).summary
    assert summary["transverse_contact_ratio"] == pytest.approx(length / mesh.pinion.base_pitch, abs=1e-9)
    overlap = 20.0 * abs(math.sin(mesh.pinion.beta)) / (math.pi * mesh.pinion.module)
    assert summary["overlap_ratio"] == pytest.approx(overlap, abs=1e-9)
    assert summary["contact_ratio"] == pytest.approx(length / mesh.pinion.base_pitch + overlap, abs=1e-9)


@pytest.mark.sweep
def test_rolled_solids_of_an_internal_pair_agree_and_have_the_exact_volume() -> None:
    design = parsed(
        {"teeth": 20, "tip_chamfer": 0.2}, {"teeth": -61, "tip_rounding": 0.25}, helix_angle=20, backlash=0.1
    )
    gears = gm.build(design)
    checked = gears.check(0.005)
    assert not checked.complaints
    for name, member in gears.members.items():
        solid = gears.solid(name, 0.001)
        assert solid.figures["watertight"]
        assert solid.figures["max_deviation_um"] <= 1.0
        assert solid.figures["volume_mm3"] == pytest.approx(member.tooth.volume(), rel=5e-5)


@pytest.mark.sweep_cases(
    "sliding-62.6-teeth1-0.0",
    "sliding-65.6-teeth2-22.0",
    "sliding-64.0-teeth0-0.0",
    "equal-44.3-teeth3-15.0",
    "equal-64.0-teeth0-0.0",
    "teeth-44.3-teeth3-15.0",
    "teeth-65.6-teeth2-22.0",
    "teeth-62.6-teeth1-0.0",
    "equal-62.6-teeth1-0.0",
    "equal-65.6-teeth2-22.0",
    "sliding-44.3-teeth3-15.0",
)
@pytest.mark.parametrize(
    ("distance", "teeth", "helix"),
    [(64.0, (18, 45), 0.0), (62.6, (18, 45), 0.0), (65.6, (17, 43), 22.0), (44.3, (20, -64), 15.0)],
)
@pytest.mark.parametrize("sharing", ["sliding", "equal", "teeth"])
def test_shifts_for_a_centre_distance_leave_no_backlash(
    distance: float, teeth: tuple[int, int], helix: float, sharing: str
) -> None:
    keys = {"helix_angle": helix, "assembly": {"center_distance": distance}, "shift_sharing": sharing}
    design = parsed({"teeth": teeth[0]}, {"teeth": teeth[1]}, **keys)
    first, second = design.pinion.profile_shift, design.gear.profile_shift
    if sharing == "equal":
        assert first == second
    if sharing == "teeth":
        assert first * abs(teeth[1]) == pytest.approx(second * teeth[0])
    summary = gm.build(design).contact(cycle=True).summary
    assert summary["backlash_normal_min_mm"] == pytest.approx(0.0, abs=1e-9)
    if sharing == "sliding":
        _slides_alike(design)


def _slides_alike(design: Any) -> None:
    """Specific sliding, measured from how fast the point of contact wanders over either flank, is the same at A and E."""
    found = proportions(design)
    mesh = found.mesh
    lengths = (
        mesh.pinion.roll_length(found.tips[0]),
        mesh.mating_roll_length(mesh.gear.roll_length(found.tips[1]), mesh.gear),
    )
    measured = []
    for own, mating, length in ((mesh.pinion, mesh.gear, lengths[1]), (mesh.gear, mesh.pinion, lengths[0])):
        at = length if own is mesh.pinion else mesh.mating_roll_length(length, mesh.pinion)
        there = mesh.mating_roll_length(at, own)
        step = 1e-6
        # arcs of both involutes that pass through the contact while the pinion's base circle turns by `step`
        arcs = [
            abs((x + sign * step) ** 2 - x**2) / 2.0 / each.base_radius
            for each, x, sign in ((own, at, 1.0), (mating, there, 1.0))
        ]
        measured.append(1.0 - arcs[1] / arcs[0])
    assert measured[0] == pytest.approx(measured[1], abs=1e-5)


def _fewest_against_trimming(cutter: Toothing, addendum: float, ring_addendum: float = 1.0, shift: float = 0.0) -> int:
    """The smallest number of teeth of an internal gear of profile shift `shift` whose tips a shaper cutter does not trim.

    `addendum` of the cutter and `ring_addendum` in normal modules, over the shifted pitch lines.
    """
    tip = cutter.radius + (addendum + cutter.shift) * cutter.module
    teeth = cutter.teeth + 1
    while True:
        ring = replace(cutter, teeth=teeth, shift=shift, internal=True)
        ring_tip = ring.radius_at((ring_addendum + shift) * ring.module)
        distance = distance_of(cutter, ring)
        if ring_tip > ring.base_radius and not math.isnan(distance):
            left = reserves(InvolutePair(cutter, ring, distance), (tip, ring_tip))
            if left.trimming >= 0.0:
                return teeth
        teeth += 1


@pytest.mark.sweep
def test_the_least_internal_gears_against_trimming_are_the_published_ones() -> None:
    """Table "limit to prevent an internal gear from trimming interference" of gear makers' handbooks, 20 deg, no shifts."""
    published = {
        15: 34,
        16: 34,
        17: 35,
        18: 36,
        19: 37,
        20: 38,
        21: 39,
        22: 40,
        24: 42,
        25: 43,
        27: 45,
        28: 46,
        30: 48,
        31: 49,
    }
    published |= {
        32: 50,
        33: 51,
        34: 52,
        35: 53,
        38: 56,
        40: 58,
        42: 60,
        44: 62,
        48: 66,
        50: 68,
        56: 74,
        60: 78,
        64: 82,
        66: 84,
    }
    published |= {80: 98, 96: 114, 100: 118}
    cutters = {teeth: Toothing(teeth, 1.0, math.radians(20.0)) for teeth in published}
    assert {teeth: _fewest_against_trimming(cutter, 1.25) for teeth, cutter in cutters.items()} == published


@pytest.mark.sweep
def test_tips_that_collide_beside_the_mesh_are_told_and_measured() -> None:
    free, stuck = (parsed({"teeth": teeth}, {"teeth": -60}, backlash=0.02) for teeth in (50, 54))
    found = [proportions(design) for design in (free, stuck)]
    left = [reserves(each.mesh, each.tips).trochoid for each in found]
    assert left[0] > 0.0 > left[1]
    slack = [gm.build(design).contact().summary["backlash_normal_min_mm"] for design in (free, stuck)]
    assert slack[0] == pytest.approx(0.02, abs=1e-9)
    # both flanks lead by the figure where the tips meet, which is a little more than where they are sampled
    assert slack[1] < -0.05
    (line,) = (line for line in gm.build(stuck).warnings if "trochoid" in line)
    bound = float(line.split("tip_diameter of at least ")[1].split()[0])
    for diameter, colliding in ((bound - 0.05, True), (bound + 0.01, False)):
        moved = gm.build(parsed({"teeth": 54}, {"teeth": -60, "tip_diameter": diameter}, backlash=0.02))
        assert any("trochoid" in line for line in moved.warnings) == colliding


@pytest.mark.sweep
def test_spur_and_helical_gears_are_the_beveloids_with_no_cone() -> None:
    for helix in (0.0, 17.0):
        own = parsed(
            {"teeth": 18, "profile_shift": 0.2}, {"teeth": 45, "tip_chamfer": 0.1}, helix_angle=helix, backlash=0.06
        )
        beveloid = gm.parse(
            {
                "kind": "beveloid",
                "module": 2,
                "backlash": 0.06,
                "pinion": {"teeth": 18, "face_width": 20, "profile_shift": 0.2, "helix_angle": helix},
                "gear": {"teeth": 45, "face_width": 20, "tip_chamfer": 0.1, "helix_angle": -helix},
            }
        )
        phi1 = np.array([-7.0, 0.0, 3.0])
        found = [gm.build(design).contact(phi1, cycle=False).path for design in (own, beveloid)]
        # tips give way so that the clearance is kept, which the beveloid's do not
        assert own.pinion.tip_alteration < 0.0
        assert found[0].phi2 == pytest.approx(found[1].phi2, abs=1e-12)
        assert (found[0].kind == found[1].kind).all()


def test_inputs_that_say_the_same_are_the_same() -> None:
    cosine = math.cos(math.radians(20.0))
    normal = parsed({"teeth": 18}, {"teeth": 45}, helix_angle=20)
    for keys in (
        {"module": None, "transverse_module": 2.0 / cosine},
        {"module": None, "diametral_pitch": 12.7},
        {"module": None, "transverse_diametral_pitch": 12.7 * cosine},
        {"transverse_pressure_angle": math.degrees(math.atan(math.tan(math.radians(20.0)) / cosine))},
    ):
        given = {key: value for key, value in {"module": 2, **keys}.items() if value is not None}
        other = complete_design(
            gm.parse(
                {
                    "kind": "cylindrical",
                    "helix_angle": 20,
                    **given,
                    **{n: {"teeth": z, "face_width": 20} for n, z in (("pinion", 18), ("gear", 45))},
                }
            )
        )
        assert proportions(other).roots == pytest.approx(proportions(normal).roots, abs=1e-12)
        assert proportions(other).mesh.distance == pytest.approx(proportions(normal).mesh.distance, abs=1e-12)
    for design in (normal, parsed({"teeth": 20}, {"teeth": -61}, circumferential_backlash=0.1)):
        again = gm.parse(design.resolve())
        assert again.resolve() == design.resolve()
        assert proportions(again).mesh.normal_backlash == pytest.approx(
            proportions(design).mesh.normal_backlash, abs=1e-14
        )


@pytest.mark.sweep
def test_allowances_of_the_thickness_are_taken_in_their_middle() -> None:
    allowance = {"thickness_allowance": {"upper": -0.04, "lower": -0.07}}
    design = parsed({"teeth": 18, **allowance}, {"teeth": 45}, helix_angle=10)
    summary = gm.build(design).contact().summary
    assert summary["backlash_normal_min_mm"] == pytest.approx(0.055 * math.cos(math.radians(20.0)), abs=1e-9)


@pytest.mark.parametrize(
    ("pinion", "gear", "keys", "named"),
    [
        ({"teeth": 20}, {"teeth": -60, "internal": False}, {}, "gear.teeth = -60"),
        ({"teeth": 61}, {"teeth": -60}, {}, "gear.teeth = 60"),
        ({"teeth": -80}, {"teeth": -60}, {}, "gear.internal"),
        ({"teeth": 20}, {"teeth": -60, "bore": 10}, {}, "gear.bore"),
        ({"teeth": 20, "rim": 5}, {"teeth": 60}, {}, "pinion.rim = 5"),
        ({"teeth": 20}, {"teeth": 60}, {"transverse_module": 2.1}, "transverse_module = 2.1"),
        (
            {"teeth": 20},
            {"teeth": 60},
            {"backlash": 0.1, "circumferential_backlash": 0.1},
            "circumferential_backlash = 0.1",
        ),
        ({"teeth": 20}, {"teeth": 60}, {"assembly": {"center_distance": 70}}, "assembly.center_distance = 70"),
        ({"teeth": 20}, {"teeth": -60, "tip_diameter": 112}, {}, "gear.tip_diameter = 112"),
        ({"teeth": 20, "profile_shift": -3}, {"teeth": 22, "profile_shift": -2}, {}, "pinion.profile_shift = -3"),
        (
            {"teeth": 20, "thickness_allowance": {"upper": -4, "lower": -4}},
            {"teeth": 22},
            {},
            "pinion.thickness_allowance",
        ),
        ({"teeth": 20, "thickness_allowance": {"upper": -0.2, "lower": -0.1}}, {"teeth": 22}, {}, "lower = -0.1"),
    ],
)
@pytest.mark.sweep_cases(
    "pinion7-gear7-keys7-assembly.center_distance = 70",
    "pinion10-gear10-keys10-pinion.thickness_allowance",
    "pinion8-gear8-keys8-gear.tip_diameter = 112",
)
def test_what_cannot_be_is_refused_in_one_line(
    pinion: dict[str, Any], gear: dict[str, Any], keys: dict[str, Any], named: str
) -> None:
    with pytest.raises(DesignError) as failure:
        gm.build(parsed(pinion, gear, **keys))
    assert named in str(failure.value)
    assert "\n" not in str(failure.value)


@pytest.mark.sweep
def test_the_order_of_the_page_is_built_as_it_says(tmp_path: Path) -> None:
    """The design file on the kind's page, through the commands that stand under it."""
    page = (Path(gm.__file__).parent / "systems" / "cylindrical" / "README.md").read_text(encoding="utf-8")
    order = tmp_path / "order.toml"
    order.write_text(page.split("```toml\n")[1].split("```")[0], encoding="utf-8")
    gears = gm.build(gm.load(order))
    (line,) = gears.warnings
    assert "0.1859 mm thicker" in line
    assert "63.39103 mm" in line
    assert main(["check", str(order)]) == 0
    assert main(["solid", str(order), "--member", "both", "-o", str(tmp_path / "pair.3mf")]) == 0
    # the sum of shifts that the warning proposes leaves no thickening
    wanted = float(line.rsplit("must be ", 1)[1].split()[0])
    other = gears.design.with_values({"gear.profile_shift": wanted - 0.3})
    assert gm.build(other).warnings == ()
