"""Designs of a pinion and a rack: what their keys say of both, against closed forms, rolled meshes and solids."""

from __future__ import annotations

import math
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.examples import some
from oracles.overlap import overlap

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.contact.fit.fit import fit
from gearmesh.contact.fit.freeing import shift_gear
from gearmesh.kinds import Region
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian, volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid, whole_rim


def rack(*, module: float = 2.0, **keys: Any) -> gm.Gears:
    """A pinion of 20 teeth and a rack of 12, 20 mm wide, with other keys of both and of the design."""
    pinion = {"teeth": 20, "face_width": 22, **keys.pop("pinion", {})}
    bar = {"teeth": 12, "face_width": 20, **keys.pop("rack", {})}
    return gm.build(gm.parse({"kind": "rack", "module": module, "pinion": pinion, "rack": bar, **keys}))


#: prints the volume of the one solid of a STEP file
READER = """
import sys, gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
((dimension, tag),) = gmsh.model.occ.importShapes(sys.argv[1])
print(gmsh.model.occ.getMass(dimension, tag))
"""

#: keys of a design, the pinion's profile shift and how far (mm) the rack stands off beyond it, the backlash along the rack (mm)
CASES: dict[str, Any] = {
    "spur": ({"backlash": 0.06}, 0.0, 0.0, 0.06 / math.cos(math.radians(20.0))),
    "shifted": (
        {"helix_angle": 15, "circumferential_backlash": 0.05, "pinion": {"profile_shift": 0.3}},
        0.3,
        0.0,
        0.05,
    ),
    # 20.70552 + 0.2 * 2 + 18 from the axis to the back
    "mounted": (
        {
            "helix_angle": 15,
            "hand": "left",
            "contact": {"flank": "left"},
            "rack": {"height": 20},
            "assembly": {"mounting_distance": 20.0 / math.cos(math.radians(15.0)) + 0.4 + 18.0},
        },
        0.2,
        0.0,
        0.0,
    ),
    "apart": (
        {
            "pinion": {"profile_shift": 0.1},
            "rack": {"height": 16, "addendum": 0.9},
            "assembly": {"mounting_distance": 20.0 + 0.2 + 16.0 - 1.8 + 0.15},
        },
        0.1,
        0.15,
        2.0 * 0.15 * math.tan(math.radians(20.0)),
    ),
    "thinned": (
        {
            "pinion": {"thickness_allowance": {"upper": -0.02, "lower": -0.06}},
            "rack": {"thickness_allowance": {"upper": -0.03, "lower": -0.03}},
        },
        0.0,
        0.0,
        0.07,
    ),
    "shaped": (
        {"helix_angle": 12, "backlash": 0.04, "pinion": {"shaper": {"teeth": 30}, "profile_shift": 0.2}},
        0.2,
        0.0,
        0.04 / math.cos(math.radians(20.0)) / math.cos(math.radians(12.0)),
    ),
}


@pytest.mark.sweep
@pytest.mark.parametrize("case", some(CASES, 3))
def test_contact_is_that_of_the_closed_form(case: str) -> None:
    """ISO 21771: path of contact from the rack's tip plane to the pinion's tip, both on the line of action at alpha_t."""
    keys, shift, off, play = CASES[case]
    gears = rack(**keys)
    beta = math.radians(keys.get("helix_angle", 0.0))
    addendum = keys.get("rack", {}).get("addendum", 1.0)
    alpha_t = math.atan(math.tan(math.radians(20.0)) / math.cos(beta))
    m_t = 2.0 / math.cos(beta)
    r, pitch = 10.0 * m_t, math.pi * m_t
    tip = r + 2.0 * (1.0 + shift)
    recess = math.sqrt(tip**2 - (r * math.cos(alpha_t)) ** 2) - r * math.sin(alpha_t)
    approach = (2.0 * addendum - 2.0 * shift - off) / math.sin(alpha_t)
    contact = gears.contact()
    found = contact.summary
    assert found["transverse_contact_ratio"] == pytest.approx((recess + approach) / pitch / math.cos(alpha_t), abs=1e-9)
    assert found["overlap_ratio"] == pytest.approx(20.0 * math.sin(beta) / (2.0 * math.pi), abs=1e-9)
    assert found["displacement_per_turn_mm"] == pytest.approx(20 * pitch, abs=1e-9)
    for key in ("backlash_transverse_min_mm", "backlash_transverse_max_mm"):
        assert found[key] == pytest.approx(play, abs=1e-9)
    assert found["mesh_te_peak_to_peak_um"] < 1e-6
    assert found["interference_um"] == 0.0
    # the rack follows: a pitch for every tooth of the pinion
    rows = [each.row for each in contact.positions()]
    per_deg = 20 * pitch / 360.0
    first, last = rows[0], rows[-1]
    travelled = last["displacement_mm"] - first["displacement_mm"]
    assert travelled == pytest.approx(per_deg * (last["phi1_deg"] - first["phi1_deg"]), abs=1e-9)
    assert travelled > pitch


def test_errors_are_told_in_micrometres_of_travel() -> None:
    """A crowned profile parts by a parabola: the error in um is the pinion's angle times its reference radius."""
    contact = rack(pinion={"modifications": {"profile_crowning": 0.01, "helix_crowning": 0.01}}).contact()
    um = 20.0 * math.pi / 648000.0 * 1e3
    assert contact.summary["mesh_te_peak_to_peak_um"] > 0.1
    for key in ("mesh_te_peak_to_peak", "te_peak_to_peak"):
        assert contact.summary[f"{key}_um"] == pytest.approx(um * contact.summary[f"{key}_arcsec"], rel=1e-12)
    te = np.array([(row.te_um, row.te) for row in contact.positions()])
    assert te[:, 0] == pytest.approx(um * te[:, 1], rel=1e-12)
    listing = contact.listings[0]
    assert list(listing.columns[1:3]) == ["displacement mm", "TE um"]
    assert np.ptp(te[:, 0]) == pytest.approx(contact.summary["te_peak_to_peak_um"], rel=1e-9)


@pytest.mark.sweep
@pytest.mark.parametrize("case", some(["shifted", "shaped"], 1))
def test_solids_touch_and_do_not_overlap(case: str) -> None:
    gears = rack(**CASES[case][0])
    check = gears.check(0.005)
    assert not check.complaints
    rolled = {each.what: each for each in check.verdicts}["roll: te_difference_um"]
    assert rolled.value < 0.3
    (pair,) = gears.pairs
    meshes = [gears.solid(name, 0.005).mesh for name in gears.members]
    (phi2,) = gears.contact([0.0], cycle=False).path.phi2
    assert not overlap(pair, (meshes[0], meshes[1]), 0.0, phi2).beyond(0.005, 0.005)
    # against the pinion by a twentieth of a millimetre it is in the way
    back = phi2 - pair.drive * 0.05 / (pair.output.travel or math.nan)
    pushed = overlap(pair, (meshes[0], meshes[1]), 0.0, back).beyond(0.005, 0.005)
    assert pushed
    assert pushed[0].thickness > 0.02


@pytest.mark.parametrize("helix", [0, 25])
@pytest.mark.sweep_cases("25")
def test_a_bar_is_as_long_as_it_is_said_to_be(helix: int) -> None:
    """Mesh, B-rep, section and closed form agree on a bar that is longer than its teeth take."""
    pitch = 2.0 * math.pi / math.cos(math.radians(helix))
    gears = rack(helix_angle=helix, rack={"teeth": 5, "length": 5 * pitch + 7.0, "height": 14})
    member = gears.members["rack"]
    solid = gears.solid("rack", 0.002)
    back = solid.mesh.vertices[np.isclose(solid.mesh.vertices[:, 0], -12.0)]
    assert len(back) == 4
    assert np.ptp(back[back[:, 2] < 0.0, 1]) == pytest.approx(5 * pitch + 7.0, abs=1e-9)
    # root lands of 3.5 mm beyond the last pitch at either end
    plain = rack(helix_angle=helix, rack={"teeth": 5, "height": 14}).members["rack"]
    more = 7.0 * (12.0 - 2.5) * 20.0
    assert member.plain_volume() == pytest.approx(plain.plain_volume() + more, rel=1e-12)
    assert solid.mesh.volume() == pytest.approx(member.plain_volume(), rel=1e-4)
    section = gears.section("rack", 3.0)
    assert section.cut.area * 20.0 == pytest.approx(member.plain_volume(), rel=1e-6)
    assert section.cut.gap < 1e-9
    pytest.importorskip("OCP")
    figures = gears.cad("rack").figures["rack"]
    # points of CAD solids are rounded to 1e-8 mm
    assert abs(figures["volume_error"]) < 1e-9
    assert figures["max_deviation_um"] < 1e-9
    # six links of five teeth less a root that is half of each end's, back, two ends, toe and heel
    assert figures["faces"] == 6 * 5 + 1 + 5


@pytest.mark.quick
def test_as_many_teeth_as_a_length_has_room_for() -> None:
    """100 mm at a pitch of 6.2832: fifteen teeth, and 2.876 mm at either end."""
    design = {"kind": "rack", "module": 2, "pinion": {"teeth": 20, "face_width": 20}}
    gears = gm.build(gm.parse({**design, "rack": {"length": 100, "face_width": 20}}))
    assert gears.members["rack"].tooth.teeth == 15
    assert gears.members["rack"].overhang == pytest.approx(0.5 * (100.0 - 30.0 * math.pi), abs=1e-12)


@pytest.mark.sweep
@pytest.mark.sweep_cases("shaped", "mounted")
@pytest.mark.parametrize("case", some(CASES, 3))
def test_the_sheet_says_what_is_there(case: str) -> None:
    """Figures of the sheet against the contact solver, and the pin of its measure laid into a space of the exact rack."""
    gears = rack(**CASES[case][0])
    tables = gears.sheet().plain_tables
    summary = gears.contact().summary

    def value(title: str, symbol: str, column: int = 0) -> float:
        return float(tables[title][symbol][1 + column])

    assert value("Pair", "eps_alpha") == pytest.approx(summary["transverse_contact_ratio"], abs=1e-8)
    assert value("Pair", "eps_beta") == pytest.approx(summary["overlap_ratio"], abs=1e-8)
    assert value("Backlash", "j_wt", 1) == pytest.approx(summary["backlash_transverse_min_mm"], abs=1e-8)
    assert value("Backlash", "j_bn", 1) == pytest.approx(summary["backlash_normal_min_mm"], abs=1e-8)
    assert value("Pinion: Members", "c") == pytest.approx(summary["tip_clearance_pinion_mm"], abs=1e-6)
    assert value("Rack", "c") == pytest.approx(summary["tip_clearance_rack_mm"], abs=1e-6)
    tooth, pin = gears.members["rack"].tooth, value("Rack", "D_M")
    height = value("Rack", "M_r") - value("Rack", "H_0") - 0.5 * pin
    flank = tooth.grid(Region.FLANK_RIGHT, np.linspace(0.0, 1.0, 400), tooth.sections([0.5])).points[:, 0]
    trace = tooth.grid(Region.FLANK_RIGHT, np.array([0.5]), tooth.sections([0.0, 1.0])).points[0]
    along = (trace[1] - trace[0]) / np.linalg.norm(trace[1] - trace[0])
    # the middle of the space before the tooth on y = 0
    away = flank - np.array([height, -0.5 * tooth.pitch_angle * tooth.joint.travel, 0.0])  # type: ignore[operator]
    assert np.linalg.norm(away - (away @ along)[:, None] * along, axis=1).min() == pytest.approx(0.5 * pin, abs=1e-5)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("keys", "named"),
    [
        ({"rack": {"teeth": None}}, "rack.teeth: missing; give teeth or length"),
        ({"rack": {"length": 50}}, "rack.length = 50 mm: must be at least 75.3983 mm, the length of 12 teeth"),
        ({"rack": {"height": 4}}, "rack.height = 4 mm: the root lies below the back of the bar; allowed is more than"),
        ({"rack": {"addendum": 2.3}}, "rack.addendum = 2.3: the rack's teeth are pointed; allowed is less than 2.15"),
        ({"rack": {"tool_tip_radius": 0.6}}, "rack.tool_tip_radius = 0.6: the cutter's tooth is too narrow"),
        ({"backlash": 8}, "unchanged: leaves no tooth of the pinion"),
        ({"pinion": {"internal": True}}, "pinion.internal = true: the pinion of a rack is external"),
        ({"assembly": {"mounting_distance": 60}}, "unchanged: the pinion would need"),
        (
            {"backlash": 0.1, "rack": {"thickness_allowance": {"upper": 0, "lower": 0}}},
            "backlash = 0.1 mm: cannot be given together with rack.thickness_allowance",
        ),
    ],
)
@pytest.mark.sweep_cases(
    "keys4-rack.tool_tip_radius = 0.6: the cutter's tooth is too narrow",
    "keys5-unchanged: leaves no tooth of the pinion",
)
def test_what_cannot_be_is_refused_in_a_line(keys: dict[str, Any], named: str) -> None:
    with pytest.raises(DesignError) as failure:
        rack(**keys)
    assert named in str(failure.value)
    assert "\n" not in str(failure.value)


@pytest.mark.quick
def test_limits_are_heights() -> None:
    """The rack's land is 0.4 mm wide where the rest of the tooth is used up by the pressure angle."""
    gears = rack(backlash=0.05)
    found = gears.limits(0.2).document()["members"]["rack"]
    thickness = math.pi - 0.5 * 0.05 / math.cos(math.radians(20.0))
    tangent = math.tan(math.radians(20.0))
    assert found["largest_tip_height_mm"] == pytest.approx([0.5 * (thickness - 0.4) / tangent] * 5)
    assert found["tip_height_mm"] == pytest.approx([2.0] * 5)
    assert found["top_land_mm"] == pytest.approx([thickness - 4.0 * tangent] * 5)
    assert "tip_diameter_mm" not in found


@pytest.mark.quick
def test_hexahedra_of_all_teeth_are_the_bar() -> None:
    """Down to its back, open at both ends, with the volume of the exact bar but for the chords of its fillets."""
    tooth = rack(backlash=0.05).members["rack"].tooth
    places = tooth.joint.places(tooth.teeth)
    bar = hex_mesh(tooth, places, plain_grid(Cells()), whole_rim(tooth, np.linspace(0.0, 1.0, 3)))
    assert {"cut_right", "cut_left", f"flank_right_{tooth.teeth}"} <= set(bar.node_sets)
    assert scaled_jacobian(bar.nodes, bar.elements).min() > 0.3
    assert volumes(bar.nodes, bar.elements).sum() == pytest.approx(tooth.volume(), rel=1e-4)


@pytest.mark.sweep
def test_a_rack_too_near_is_told_of_in_millimetres() -> None:
    gears = rack(assembly={"dx": -0.1}, backlash=0.02)
    (line,) = (line for line in gears.contact().warnings if line.startswith("the pair is jammed"))
    assert "mm of the rack" in line
    found = re.search(r"; to free it move the rack (0\.0\d+) mm away$", line)
    assert found is not None
    # that and about no less: the search ends with its effort, 3 % above the least
    freed = [fit(shift_gear(gears.pairs[0], share * float(found[1]))) for share in (1.0, 0.95)]
    assert [each is not None and each.fits for each in freed] == [True, False]


@pytest.mark.sweep
def test_overlap_begins_where_racks_tip_meets_end_of_flank() -> None:
    """A rounding of 0.38 leaves straight flank down to 0.99997 modules: tips come 0.1 um deeper, and its end ends the lines."""
    keys = {"helix_angle": 15, "backlash": 0.08, "pinion": {"profile_shift": 0.2, "tool_tip_radius": 0.38}}
    summary = rack(**keys).contact().summary
    assert summary["overlap_ratio"] == pytest.approx(20.0 * math.sin(math.radians(15.0)) / (2.0 * math.pi), abs=1e-9)


@pytest.mark.sweep_cases("0")
@pytest.mark.parametrize("helix", [0, 25])
def test_a_step_file_reads_back_as_the_bar_that_it_was(helix: int, tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    pytest.importorskip("gmsh")
    gears = rack(helix_angle=helix, hand="left", rack={"teeth": 4, "length": 60})
    file = gears.cad("rack").save(tmp_path / "rack.step")
    # a process of its own: both have an OpenCASCADE
    found = subprocess.run([sys.executable, "-c", READER, str(file)], check=True, capture_output=True, text=True)
    assert float(found.stdout) == pytest.approx(gears.members["rack"].plain_volume(), rel=1e-10)


@pytest.mark.sweep
def test_warning_of_racks_tip_in_fillet_names_addendum_that_clears_it() -> None:
    long = {"addendum": 1.1}
    (line,) = rack(pinion={"tool_tip_radius": 0.38}, rack=long).sheet().warnings
    found = re.fullmatch(
        r"pinion: interference: the rack's tip reaches .*; it clears the fillet with rack\.addendum smaller by at least (.*)",
        line,
    )
    assert found is not None
    short = {"addendum": 1.1 - float(found[1])}
    assert not rack(pinion={"tool_tip_radius": 0.38}, rack=short).sheet().warnings
    # the pinion's tip in the rack's fillet
    pinion = {"teeth": 60, "addendum": 1.2}
    lines = rack(pinion=pinion, rack={"tool_tip_radius": 0.39}).sheet().warnings
    (line,) = (each for each in lines if each.startswith("rack: interference: the pinion's tip"))
    diameter = float(re.findall(r"pinion\.tip_diameter at most ([\d.]+) mm", line)[0])
    clear = rack(pinion={"teeth": 60, "tip_diameter": diameter}, rack={"tool_tip_radius": 0.39}).sheet().warnings
    assert not any("interference" in each for each in clear)
