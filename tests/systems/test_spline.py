"""Splines: sizes and measures of standards, measures on the built flanks, contact of all teeth, hubs out of place."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.contact.hertz import STEEL
from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.loaded.compliance.compliance import flank_compliance
from gearmesh.loaded.sharing import loaded_mesh, reach_of
from gearmesh.mesh.hexahedra.hexahedra import Cells
from gearmesh.systems.common.standards import ansi_b92_1, din5480, iso4156
from gearmesh.systems.cylindrical.spline.designation import Designation, parse_designation
from gearmesh.systems.cylindrical.spline.sheet import tooth_gaps

DIN = {"kind": "spline", "designation": "DIN 5480 W 45x2x21", "shaft": {"face_width": 30}, "hub": {"face_width": 30}}


def spline(**more: Any) -> gm.Gears:
    """Return the DIN 5480 spline 45 x 2 x 21 with more keys; those of shaft and hub are added to their tables."""
    tables = {name: {**DIN[name], **more.pop(name, {})} for name in ("shaft", "hub")}  # type: ignore[dict-item]
    return gm.build(gm.parse({**DIN, **tables, **more}))


def cell(gears: gm.Gears, symbol: str, column: str, title: str = "") -> Any:
    """Return a value of the sheet by the symbol of its row and the name of its column."""
    for table in gears.sheet().tables:
        if symbol in table.symbols and column in table.columns and table.title.startswith(title):
            return table.rows[table.symbols.index(symbol)][2 + table.columns.index(column)]
    raise KeyError(symbol)


def flank(gears: gm.Gears, name: str, side: Side) -> Array:
    """Return points (500, 2) of a flank in the middle of the face, from form point to beyond the tip, own frame, mm."""
    tooth = gears.members[name].tooth
    own = tooth.side(side)
    p = np.linspace(own.form_point[0], own.tip, 500)
    points: Array = own.flank.jet(p, np.zeros_like(p)).r[:, :2]
    return points


def test_din_5480_45x2x21_has_the_sizes_of_the_standard() -> None:
    gears = spline(shaft={"pins": {"diameter": 4}}, hub={"pins": {"diameter": 3.5}})
    for symbol, shaft, hub in (("d_a", 44.6, 41.0), ("d_f", 40.4, 45.0), ("x", 0.2, -0.2)):
        assert cell(gears, symbol, "shaft", "Members") == pytest.approx(shaft, abs=1e-9)
        assert cell(gears, symbol, "hub", "Members") == pytest.approx(hub, abs=1e-9)
    assert cell(gears, "M_dR", "shaft") == pytest.approx(48.93831, abs=5e-6)
    assert cell(gears, "M_dR", "hub") == pytest.approx(37.60349, abs=5e-6)


@pytest.mark.parametrize(("name", "pin"), [("shaft", 4.0), ("hub", 3.5)])
def test_pins_touch_the_built_flanks_at_the_measure(name: str, pin: float) -> None:
    """Measure the surfaces: the centre of the pin is half a pin from the nearest point of the flank beside its space."""
    gears = spline(**{name: {"pins": {"diameter": pin}, "thickness_allowance": {"upper": -0.05, "lower": -0.05}}})
    points = flank(gears, name, Side.LEFT)
    # the space beside the tooth on +x, turned on to +x, with 200,000 points along its flank
    fine = np.linspace(0.0, len(points) - 1.0, 200_001)
    x, y = (np.interp(fine, np.arange(len(points)), own) for own in (points @ _turn(-np.pi / 21)).T)
    middle = 0.5 * float(np.hypot(x, y).min() + np.hypot(x, y).max())

    def apart(radius: float) -> float:
        return float(np.hypot(x - radius, y).min()) - 0.5 * pin

    # the pin of the shaft is farther out than that of the hub is in
    radius = brentq(apart, middle - 1.5, middle + 1.5, xtol=1e-10)
    sense = 1.0 if name == "shaft" else -1.0
    over = 2.0 * radius * math.cos(0.5 * math.pi / 21) + sense * pin
    assert cell(gears, "M_dR", name) == pytest.approx(over, abs=2e-5)


def _turn(angle: float) -> Array:
    """Return the matrix that turns rows of points by an angle (rad)."""
    return np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("DIN 5480 W 45x2x21 8f / N 9H", Designation("DIN 5480", 21, 2.0, None, 45.0, "8f", "9H")),
        ("DIN 5480 - N 120 x 3 x 38 x 9H", Designation("DIN 5480", 38, 3.0, None, 120.0, "", "9H")),
        ("ISO 4156 INT/EXT 24z x 2,5m x 30R x 5H/5f", Designation("ISO 4156 30 fillet", 24, 2.5, shaft="5f", hub="5H")),
        ("ISO 4156 EXT 24z x 2.5m x 37.5R x 6h", Designation("ISO 4156 37.5 fillet", 24, 2.5, shaft="6h")),
        ("ANSI B92.1 24T 12/24P 30 flat", Designation("ANSI B92.1 30 flat", 24, diametral_pitch=12.0)),
    ],
)
def test_designations_are_read(text: str, said: Designation) -> None:
    assert parse_designation(text) == said


@pytest.mark.parametrize(
    ("keys", "line"),
    [
        ({"designation": "W 45x2"}, 'designation = "W 45x2": must be as "DIN 5480 W 45x2x21 8f / N 9H"'),
        ({"designation": "ISO 4156 EXT 24z x 2m x 20P"}, "must be one of"),
        (
            {"designation": "DIN 5480 W 45x2x99"},
            'designation = "DIN 5480 W 45x2x99": 99 teeth need a profile shift of -38.8 for this diameter',
        ),
        ({"module": 3}, 'module = 3 mm: the designation "DIN 5480 W 45x2x21" gives 2'),
        ({"teeth": 20}, "teeth = 20: the designation"),
        ({"backlash": 0.1}, "backlash: the clearance follows from the thickness allowances of shaft and hub"),
        ({"hub": {"face_width": 30, "bore": 10}}, "hub.bore: the hub has its body outside of the teeth"),
        (
            {"designation": "ISO 4156 EXT 24z x 2m x 30P", "shaft": {"face_width": 3, "tolerance": "9f"}},
            "shaft.tolerance",
        ),
    ],
)
def test_wrong_designations_and_keys_are_refused_in_one_line(keys: dict[str, Any], line: str) -> None:
    with pytest.raises(DesignError) as refused:
        gm.parse({**DIN, **keys})
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_designation_is_stated_once_and_in_any_units() -> None:
    design = gm.parse(DIN)
    assert (design.module, design.teeth, design.profile) == (2.0, 21, "DIN 5480")
    assert [key for key, _ in design.own()] == ["kind", "designation", "shaft.face_width", "hub.face_width"]
    other = design.with_values({"designation": "DIN 5480 W 50x2x24"})
    assert other.teeth == 24
    inches = gm.parse({**DIN, "units": "inch", "shaft": {"face_width": 1}, "hub": {"face_width": 1}})
    assert inches.in_mm().module == pytest.approx(2.0, rel=1e-12)
    assert inches.in_mm().reference_diameter == pytest.approx(45.0, rel=1e-12)


def test_tolerances_of_iso_4156_are_those_worked_by_hand() -> None:
    """24 x 2.5, class 5: i(60) = 1.82169, i(3.92699) = 0.71388 um; F_p 43.463, F_alpha 24.125, F_beta 10.477 um at 30 mm."""
    own = iso4156.tolerance(5, "f", 2.5, 24, 30.0)
    assert 1e3 * own.total == pytest.approx(16 * 1.82169 + 64 * 0.71388, abs=2e-3)
    assert 1e3 * own.variation == pytest.approx(0.6 * math.sqrt(43.463**2 + 24.125**2 + 10.477**2), abs=2e-3)
    assert own.effective == -0.030
    assert iso4156.tolerance(5, "k", 2.5, 24, 30.0).effective == own.total


@pytest.mark.sweep
def test_limits_of_iso_4156_are_effective_and_actual() -> None:
    gears = spline(designation="ISO 4156 INT/EXT 24z x 2.5m x 30R x 5H/5f")
    known, basic = iso4156.tolerance(5, "f", 2.5, 24, 30.0), 0.5 * math.pi * 2.5
    title = "Thickness of the shaft"
    for symbol, shaft, hub in (
        ("max_v", basic - 0.03, basic),
        ("max", basic - 0.03 - known.variation, basic + known.variation),
        ("min", basic - 0.03 - known.total, basic + known.total),
    ):
        assert cell(gears, symbol, "shaft", title) == pytest.approx(shaft, abs=1e-9)
        assert cell(gears, symbol, "hub", title) == pytest.approx(hub, abs=1e-9)
    assert cell(gears, "c_v", "least effective") == pytest.approx(0.03, abs=1e-9)
    # the shaft of deviation f is smaller by twice 0.03 / (2 tan 30 deg) on its diameters
    assert cell(gears, "d_a", "shaft", "Members") == pytest.approx(62.5 - 0.03 / math.tan(math.pi / 6), abs=1e-9)
    assert cell(gears, "d_f", "hub", "Members") == pytest.approx(2.5 * 25.8, abs=1e-9)


def test_tolerances_of_din_5480_are_steps_of_its_tables() -> None:
    """45 x 2: the fourth size step, with a unit of 11 um; grade 8 has T_act 32 and T_eff 18, grade 9 has 45 and 26 um."""
    shaft, hub = din5480.tolerance(8, "f", 2.0, 45.0), din5480.tolerance(9, "H", 2.0, 45.0)
    assert (shaft.effective, shaft.total, shaft.variation) == pytest.approx((-0.022, 0.050, 0.018))
    assert (hub.effective, hub.total, hub.variation) == pytest.approx((0.0, 0.071, 0.026))
    # deviations are symmetric about h, a hub of K has narrower spaces, thicker teeth
    assert din5480.tolerance(8, "k", 2.0, 45.0).effective == -shaft.effective
    assert din5480.tolerance(9, "K", 2.0, 45.0).effective == pytest.approx(0.022)
    # the smallest and the largest size step
    assert din5480.tolerance(5, "a", 1.5, 12.0).effective == pytest.approx(-0.080)
    assert din5480.tolerance(12, "v", 10.0, 500.0).total == pytest.approx(0.360)


@pytest.mark.sweep
def test_limits_of_din_5480_are_effective_and_actual() -> None:
    gears = spline(designation="DIN 5480 W 45x2x21 8f / N 9H")
    basic = math.pi + 4.0 * 0.2 * math.tan(math.pi / 6)
    title = "Thickness of the shaft"
    for symbol, shaft, hub in (("max_v", -0.022, 0.0), ("max", -0.040, 0.026), ("min", -0.072, 0.071)):
        assert cell(gears, symbol, "shaft", title) == pytest.approx(basic + shaft, abs=1e-9)
        assert cell(gears, symbol, "hub", title) == pytest.approx(basic + hub, abs=1e-9)
    assert cell(gears, "c_v", "least effective") == pytest.approx(0.022, abs=1e-9)
    # tips and roots are nominal
    assert cell(gears, "d_a", "shaft", "Members") == pytest.approx(44.6, abs=1e-9)
    assert not gears.warnings
    with pytest.raises(DesignError, match=r"^shaft\.tolerance = \"4f\": must be a class, 5 to 12, and one of a, b"):
        spline(shaft={"tolerance": "4f"})


def test_hob_that_is_swept_by_brute_force_leaves_the_shaft() -> None:
    """The rack's rounded tooth, in 24,001 positions of its roll, reaches every point of a space and cuts into none."""
    gears = spline()
    tooth, radius, module, alpha = gears.members["shaft"].tooth, 21.0, 2.0, math.pi / 6
    regions = [region for region in tooth.regions if "flank" in region or "fillet" in region or region == "root"]
    sections = tooth.sections(np.array([0.5]))
    points = np.concatenate(
        [tooth.grid(r, np.linspace(0.02, 0.98, 25), sections).points.reshape(-1, 3) for r in regions]
    )
    # seen from the middle of a space, where the rack's tooth is
    apart = np.arctan2(points[:, 1], points[:, 0])[:, None]
    apart = np.abs(apart) - math.pi / 21
    away = np.hypot(points[:, 0], points[:, 1])[:, None]
    roll = np.linspace(-0.6, 0.6, 24_001)
    x, y = away * np.sin(apart + roll) - radius * roll, away * np.cos(apart + roll)
    # a tooth of the rack is a trapezoid that is smaller by the rounding, and all within the rounding of it
    rounding, datum = 0.16 * module, radius + 0.2 * module
    tip = datum - 0.6 * module + rounding
    half = 0.25 * math.pi * module - rounding / math.cos(alpha)
    corner = half + (tip - datum) * math.tan(alpha)
    across, up = np.abs(x) - corner, y - tip
    beside = across / math.cos(alpha)
    below = -up - beside * math.sin(alpha)
    near = np.hypot(across, up)
    outside = np.maximum(-up, across * math.cos(alpha) - up * math.sin(alpha))
    outside = np.where((beside >= 0.0) & (below >= 0.0), near, outside)
    cut = (rounding - outside).max(axis=1)
    assert np.abs(cut).max() < 1e-6


@pytest.mark.quick
@pytest.mark.parametrize(("teeth", "reach"), [(21, 10), (12, 6)])
def test_bodies_of_splines_are_coupled_all_round(teeth: int, reach: int) -> None:
    """Half of the teeth either way; the teeth of gears a few pitches away do not matter."""
    size = f"DIN 5480 W {2 * teeth + 3}x2x{teeth}"
    for errors in ({}, {"gamma_h": 0.02}):
        assert reach_of(spline(designation=size, assembly=errors).train.pairs[0]) == reach
    spur = gm.parse(
        {
            "kind": "cylindrical",
            "module": 2,
            "pinion": {"teeth": 21, "face_width": 9},
            "gear": {"teeth": 40, "face_width": 9},
        }
    )
    assert reach_of(gm.build(spur).train.pairs[0]) == 3


@pytest.mark.sweep_cases(
    "DIN 5480 W 120x3x38",
    "ISO 4156 INT/EXT 24z x 2.5m x 30P x 7H/7d",
    "ANSI B92.1 24T 12/24P 30 flat",
    "ANSI B92.1 20T 16/32P 37.5 fillet",
    "ANSI B92.1 36T 24/48P 45 fillet",
    "ISO 4156 INT/EXT 24z x 1m x 37.5R x 5H/5h",
    "ISO 4156 INT/EXT 32z x 0.5m x 45R x 6H/6f",
)
@pytest.mark.parametrize(
    "text",
    [
        "DIN 5480 W 120x3x38",
        "ISO 4156 INT/EXT 24z x 2.5m x 30P x 7H/7d",
        "ISO 4156 INT/EXT 24z x 1m x 37.5R x 5H/5h",
        "ISO 4156 INT/EXT 32z x 0.5m x 45R x 6H/6f",
        "ANSI B92.1 24T 12/24P 30 flat",
        "ANSI B92.1 16T 20/40P 30 fillet",
        "ANSI B92.1 20T 16/32P 37.5 fillet",
        "ANSI B92.1 36T 24/48P 45 fillet",
    ],
)
def test_splines_of_every_profile_fit_and_run_true(text: str) -> None:
    """Nominal or toleranced teeth: no jam beyond rounding, all pairs in contact, backlash is the clearance of the sheet."""
    gears = spline(designation=text, shaft={"face_width": 8}, hub={"face_width": 8})
    contact = gears.contact()
    teeth = gears.design.teeth
    assert contact.summary["contact_ratio"] == pytest.approx(teeth, abs=1e-9)
    assert contact.summary["mesh_te_peak_to_peak_arcsec"] < 1e-6
    made = cell(gears, "phi_v", "as built")
    assert contact.summary["backlash_min_deg"] == pytest.approx(made, abs=1e-8)
    assert contact.summary["interference_um"] == 0.0
    assert min(contact.summary["tip_clearance_shaft_mm"], contact.summary["tip_clearance_hub_mm"]) > 0.0


def rigid_gaps(gears: gm.Gears) -> Array:
    """Return the gaps (21,), mm, of a hub out of place by brute force: points of the shaft's flanks turned on to involutes.

    A dense grid of each flank of the shaft is seen from the hub, where the polar angle of its involute is known in closed form.
    The grid is densest at the ends of the face, which end the flanks of the hub, too.
    """
    pair, alpha = gears.train.pairs[0], math.pi / 6
    own = gears.members["shaft"].tooth.side(pair.flanks[0])
    ends = 15.0 - np.linspace(0.0, 0.02, 21)
    stations = np.concatenate((-ends, np.linspace(-14.98, 14.98, 201), ends))
    tip_at = brentq(
        lambda p: math.hypot(*own.flank.jet(np.array(p), np.array(0.0)).r[:2]) - 22.3, own.form_point[0], own.tip
    )
    p, z = np.meshgrid(np.linspace(own.form_point[0], tip_at, 801), stations, indexing="ij")
    points = own.flank.jet(p.ravel(), z.ravel()).r
    base, tip, root = 21.0 * math.cos(alpha), 20.5, 0.5 * cell(gears, "d_Ff", "hub", "Form")
    width, advances = cell(gears, "made", "hub", "Thickness"), []
    for angle in 2.0 * math.pi * np.arange(21) / 21:
        seen = pair.gear.mount.base.inverse.point(np.column_stack((points[:, :2] @ _turn(angle), points[:, 2])))
        radius = np.hypot(seen[:, 0], seen[:, 1])
        on_flank = (radius >= tip) & (radius <= root) & (np.abs(seen[:, 2]) <= 15.0)
        pressure = np.arccos(base / radius[on_flank])
        # half of the space's angle at this radius; the middle of the space is half a pitch ahead in the hub's frame
        half = 0.5 * width / 21.0 + (math.tan(alpha) - alpha) - (np.tan(pressure) - pressure)
        ahead = np.arctan2(seen[on_flank, 1], seen[on_flank, 0]) - angle - math.pi / 21
        ahead = (ahead + math.pi) % (2.0 * math.pi) - math.pi
        advances.append(float(-(half + ahead).min()))
    return (max(advances) - np.array(advances)) * base


@pytest.mark.sweep
@pytest.mark.parametrize("crowning", [0.0, 0.008])
def test_gaps_of_a_tilted_hub_are_those_of_rigid_flanks(crowning: float) -> None:
    gears = spline(
        shaft={"modifications": {"helix_crowning": crowning}} if crowning else {},
        assembly={"gamma_h": 0.02, "gamma_v": -0.01, "dx": 0.003},
    )
    pair = gears.train.pairs[0]
    gaps = tooth_gaps(pair, 0.5 * 42.0 * math.cos(math.pi / 6))
    assert gaps.min() == 0.0
    assert 1e3 * gaps.max() > 1.0
    assert np.abs(gaps - rigid_gaps(gears)).max() < 2e-6


@pytest.mark.sweep
def test_run_out_into_a_thicker_shaft() -> None:
    gears = spline(shaft={"heel_shaft": {"diameters": [48], "lengths": [10]}, "run_out_radius": 30.0})
    solid = gears.solid("shaft", tolerance=0.05)
    assert solid.figures["watertight"]
    assert cell(gears, "l_o", "shaft", "Members") > 1.0
    assert cell(gears, "r_o", "shaft", "Members") == 30.0
    assert gears.contact().summary["contact_ratio"] == pytest.approx(21, abs=1e-9)


def test_limits_of_pins_give_the_thickness() -> None:
    gears = spline(shaft={"pins": {"diameter": 4, "upper": 48.9, "lower": 48.86}, "thickness_made": "lower"})
    assert cell(gears, "M_dR_upper", "shaft") == pytest.approx(48.9, abs=1e-9)
    assert cell(gears, "M_dR", "shaft") == pytest.approx(48.86, abs=1e-9)
    assert cell(gears, "c_v", "as built") > 0.03


def shares_of(gears: gm.Gears, torque: float) -> Array:
    """Return the shares (z,) of the torque (Nm) of all tooth pairs at phi1 = 0, by the polar angle of the shaft's tooth."""
    pair, few = gears.train.pairs[0], Cells(flank=4, fillet=4, thickness=2, rim=2, face=6)
    shaft, hub = (
        flank_compliance(member.tooth, side, STEEL, cells=few, reach=reach_of(pair))
        for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    mesh = loaded_mesh(pair, np.zeros(1), np.array([1e3 * torque]), (shaft, hub), cells=(12, 8))
    (load,) = mesh.loads
    assert (mesh.status == Status.CONVERGED).all()
    assert mesh.gear_torque[0, 0] == pytest.approx(1e3 * torque, rel=1e-4)
    shares = np.zeros(gears.design.teeth)
    shares[load.number % len(shares)] = load.moment / (1e3 * torque)
    return shares


#: a small spline for contact under load
SMALL = {"designation": "ISO 4156 INT/EXT 12z x 2m x 30P", "shaft": {"face_width": 12}, "hub": {"face_width": 12}}


def test_torque_is_shared_equally_in_place() -> None:
    """Conforming flanks of all tooth pairs, all round the bodies: every pair has 1 / z of the torque."""
    assert shares_of(spline(**SMALL), 100.0) == pytest.approx(np.full(12, 1 / 12), rel=1e-6)


def test_torque_of_a_tilted_hub_is_shared_as_its_gaps_say() -> None:
    """A tilt is the same seen from either end, half a turn apart; pairs with less gap have more load."""
    gears = spline(**SMALL, assembly={"gamma_h": 0.06})
    shares, gaps = shares_of(gears, 100.0), tooth_gaps(gears.train.pairs[0], 12.0 * math.cos(math.pi / 6))
    assert shares.sum() == pytest.approx(1.0, abs=1e-9)
    assert shares[:6] == pytest.approx(shares[6:], rel=1e-3)
    assert shares.max() > 1.2 * shares.min()
    assert np.corrcoef(shares, gaps)[0, 1] < -0.8


#: pitches at both ends of each range of ANSI B92.1, and machining tolerance and variation allowance of class 5 with 10, 20
#: and 60 teeth, 0.0001 inch
B92_1_ROWS = [
    ((2.5, 3.0), (15.8, 17.6, 24.8), (23.5, 27.0, 41.0)),
    ((4.0, 5.0), (14.5, 16.0, 22.0), (20.3, 22.6, 31.8)),
    ((6.0, 8.0), (12.5, 14.0, 20.0), (17.0, 19.0, 27.0)),
    ((10.0, 12.0), (12.0, 13.0, 17.0), (15.7, 17.4, 24.2)),
    ((16.0, 20.0), (11.7, 12.4, 15.2), (14.2, 15.4, 20.2)),
    ((24.0, 48.0), (11.7, 12.4, 15.2), (12.2, 13.4, 18.2)),
    ((64.0, 80.0), (9.6, 10.2, 12.6), (11.0, 12.0, 16.0)),
    ((128.0, 128.0), (9.5, 10.0, 12.0), (9.8, 10.6, 13.8)),
]


@pytest.mark.quick
@pytest.mark.parametrize(("pitches", "machining", "variation"), B92_1_ROWS)
def test_tolerances_of_b92_1_are_rows_of_its_table(
    pitches: tuple[float, float], machining: tuple[float, ...], variation: tuple[float, ...]
) -> None:
    for pitch in pitches:
        for teeth, own, allowance in zip((10, 20, 60), machining, variation, strict=True):
            for number, factor in ((4, 0.71), (5, 1.0), (6, 1.4), (7, 2.0)):
                found = ansi_b92_1.tolerance(number, pitch, teeth)
                assert found is not None
                assert found.variation == pytest.approx(factor * allowance * 2.54e-3, rel=1e-12)
                assert found.total == pytest.approx(factor * (own + allowance) * 2.54e-3, rel=1e-12)
                assert found.effective == 0.0


@pytest.mark.sweep
def test_sheets_have_the_tolerances_of_b92_1() -> None:
    """Effective sizes at the maximum of material are the basic ones; T is the machining tolerance alone."""
    for number, factor in ((4, 0.71), (7, 2.0)):
        gears = spline(designation=f"ANSI B92.1 20T 12/24P 30 flat {number}")
        for column in ("shaft", "hub"):
            assert cell(gears, "max_v", column) == pytest.approx(cell(gears, "s, e", column), abs=1e-12)
            assert cell(gears, "T", column) == pytest.approx(factor * 13.0 * 2.54e-3)
            assert cell(gears, "lambda", column) == pytest.approx(factor * 17.4 * 2.54e-3)


@pytest.mark.parametrize(("pitch", "teeth"), [(2, 20), (160, 20), (12, 101)])
def test_sizes_outside_of_b92_1_have_no_tolerance(pitch: int, teeth: int) -> None:
    given = gm.parse({**DIN, "designation": f"ANSI B92.1 {teeth}T {pitch}/{2 * pitch}P 30 flat 5"})
    assert given.member_tolerance("hub") is None


def test_a_class_that_b92_1_does_not_have_is_refused() -> None:
    with pytest.raises(DesignError, match=r'^shaft\.tolerance = "?8"?: must be a class from 4 to 7'):
        spline(designation="ANSI B92.1 24T 12/24P 30 flat", shaft={"tolerance": "8"})
