"""Worm drives of steep threads: tips at every station of the face, and the face width that is left to the default."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import WormDriveDesign
from gearmesh.design.dotted import with_keys
from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.numeric.effort import Effort, limit_effort
from gearmesh.kinds import Side, along
from gearmesh.systems.system import complete_design
from gearmesh.systems.worm_drive.build import build, nominal_thread, wheel_hob
from gearmesh.systems.worm_drive.thread import LAND_PARAMETER

CORPUS = SAMPLES.parent / "tests" / "corpus"


def face_width(gears: gm.Gears) -> float:
    assert isinstance(gears.design, WormDriveDesign)
    return gears.design.wheel.face_width


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["tip_worm_drive_19", "tip_worm_drive_53"])
def test_every_station_has_the_tip_next_to_its_neighbours(name: str) -> None:
    """Beside each other at 2,001 stations, on the tip; by halving the flank's parameter at the station where it failed."""
    tooth = gm.build(gm.load(CORPUS / f"{name}.toml")).members["wheel"].tooth
    t = np.linspace(0.0, 1.0, 2001)
    tips = tooth.ends(Side.RIGHT, t).tip
    assert np.abs(np.diff(tips)).max() < 0.02 * np.ptp(tips)
    k = int(np.argmin(np.abs(t - (0.01 if name.endswith("19") else 0.995))))
    side, station = tooth.right, tooth.stations(t[[k]])
    low, high = side.form_point[0], tips[k] + (tips[k] - side.form_point[0])
    for _ in range(60):
        middle = 0.5 * (low + high)
        r = along(side.flank, np.array([middle]), station, tooth.blank.axial)[1].r
        low, high = (middle, high) if tooth.blank.tip.value(r)[0] < 0.0 else (low, middle)
    assert tips[k] == pytest.approx(low, abs=1e-9 * abs(side.tip - side.form_point[0]))


@pytest.mark.parametrize(
    "name",
    [
        "land_worm_drive_53",
        pytest.param("land_worm_drive_132", marks=pytest.mark.sweep),
    ],
)
def test_teeth_are_sound_at_every_station(name: str) -> None:
    """At 2,001 and where the throat ends, of wheels whose face width or addendum is left open."""
    tooth = gm.build(gm.load(CORPUS / f"{name}.toml")).members["wheel"].tooth
    corners = np.interp(tooth.blank.tip.corners(tooth.blank.axial), tooth.blank.extent, (0.0, 1.0))
    tooth.prove_land(np.union1d(np.linspace(0.0, 1.0, 2001), corners))


@pytest.mark.sweep
def test_open_face_width_is_no_reason_for_a_refusal() -> None:
    """The default face width is a number of eighths of the width of DIN 3975. The teeth are sound; one eighth more is refused.
    If the whole width is sound, it stays."""
    steep = gm.load(CORPUS / "face_worm_drive_10.toml")
    gears = gm.build(steep)
    width = face_width(gears)
    usual = 2.0 * gears.design.given_module * (np.sqrt(8.478 + 1.0) + 0.5)
    assert width == pytest.approx(np.round(8.0 * width / usual) / 8.0 * usual, rel=1e-12)
    assert 0.5 * usual <= width < usual
    (line,) = gears.train.warnings
    assert line.startswith(f"wheel.face_width = {width:.4g}: the default, instead of {usual:g} because the flanks")
    assert not gm.build(steep.with_values({"wheel.face_width": width})).train.warnings
    with pytest.raises(gm.DesignError, match=r"^wheel\.face_width"):
        gm.build(steep.with_values({"wheel.face_width": width + usual / 8.0}))
    keys = {"kind": "worm_drive", "module": 5, "worm": {"threads": 4, "quotient": 10}, "wheel": {"teeth": 38}}
    assert face_width(gm.build(gm.parse(keys))) == pytest.approx(10.0 * (np.sqrt(11.0) + 0.5))


#: seeds 30 and 58 of scripts/worm_sweep.py, which were refused for the addendum 1, pointed and with flanks that end below the tip
TALL: dict[str, dict[str, Any]] = {
    "pointed": {
        "module": 2.322,
        "pressure_angle": 24.76,
        "shaft_angle": 100.23,
        "worm": {"threads": 2, "form": "ZA", "quotient": 14.801},
        "wheel": {"teeth": 22, "profile_shift": 0.664},
        "hob": {"reference_diameter": 37.243},
    },
    "does not reach the tip": {
        "module": 1.882,
        "pressure_angle": 19.62,
        "worm": {"threads": 6, "form": "ZK", "quotient": 11.696},
        "wheel": {"teeth": 26, "profile_shift": 0.658},
    },
}


@pytest.mark.parametrize("why", ["pointed", pytest.param("does not reach the tip", marks=pytest.mark.sweep)])
def test_an_addendum_that_is_left_open_is_no_reason_for_a_refusal(why: str) -> None:
    """The default addendum, below 1, is sound; an addendum of 1, as stated, is refused. The throat follows the default addendum."""
    keys = {"kind": "worm_drive", **TALL[why]}
    gears = gm.build(gm.parse(keys))
    own = gears.design
    assert isinstance(own, WormDriveDesign)
    addendum = own.wheel.addendum
    assert 0.5 <= addendum < 1.0
    assert own.wheel.throat_radius == pytest.approx(own.center_distance - 0.5 * own.wheel_tip_diameter, rel=1e-12)
    line = gears.train.warnings[-1]
    assert line.startswith(f"wheel.addendum = {addendum:.4g}: the default, instead of 1 because teeth would be pointed")
    stated = gm.parse(with_keys(keys, [("wheel.addendum", addendum)]))
    assert not any("addendum" in line for line in gm.build(stated).train.warnings)
    usual = [("wheel.addendum", 1.0), ("wheel.face_width", own.usual_face_width)]
    with pytest.raises(gm.DesignError, match=rf"^wheel\.addendum = 1: .*{why}"):
        build(complete_design(gm.parse(with_keys(keys, usual))).in_mm())


@pytest.mark.sweep
def test_where_no_addendum_is_enough_a_narrower_face_is_taken_or_named() -> None:
    """Seed 45: flanks reach the tip on 0.3 of the usual face, the largest part tried on which they do."""
    keys = {
        "kind": "worm_drive",
        "module": 8.383,
        "pressure_angle": 22.54,
        "worm": {"threads": 5, "form": "ZA", "quotient": 7.755},
        "wheel": {"teeth": 65},
        "hob": {"reference_diameter": 68.233},
    }
    gears = gm.build(gm.parse(keys))
    design = gears.design
    assert isinstance(design, WormDriveDesign)
    usual, width = design.usual_face_width, face_width(gears)
    assert (width, design.wheel.addendum) == (pytest.approx(0.3 * usual, rel=1e-12), 1.0)
    assert gears.train.warnings[0].startswith(f"wheel.face_width = {width:.4g}: the default, instead of {usual:g}")
    wider = complete_design(gm.parse(with_keys(keys, [("wheel.face_width", 0.75 * usual)])))
    with pytest.raises(
        gm.DesignError, match=r"^wheel\.face_width = .*not reach the tip.* 0\.5 to 1 it has.*less"
    ) as refused:
        build(wider.in_mm())
    assert refused.value.remedies["wheel.face_width"] == -1
    stated = gm.parse(with_keys(keys, [("wheel.face_width", usual), ("wheel.addendum", 1.0)]))
    with pytest.raises(gm.DesignError, match=r"^wheel\.addendum = 1: the flank does not reach the tip"):
        build(complete_design(stated).in_mm())


#: seeds 87 and 113 of scripts/worm_sweep.py: steep threads, whose flanks end above the rounding of a root 1.2 modules deep
SHORT: dict[str, dict[str, Any]] = {
    "ZI": {"module": 3.701, "pressure_angle": 20.21, "worm": {"threads": 3, "form": "ZI", "quotient": 6.385}},
    "ZK": {"module": 2.428, "pressure_angle": 15.55, "worm": {"threads": 5, "form": "ZK", "quotient": 9.099}},
}


def steep_worm(form: str, **worm: float) -> WormDriveDesign:
    """A drive of `SHORT` in mm, with a wheel that does not matter."""
    keys = SHORT[form]
    wheel = {"teeth": 40, "face_width": 10.0, "addendum": 0.5}
    data = {"kind": "worm_drive", **keys, "wheel": wheel, "worm": {**keys["worm"], **worm}}
    design = complete_design(gm.parse(data))
    assert isinstance(design, WormDriveDesign)
    return design


@pytest.mark.parametrize("form", SHORT)
@pytest.mark.sweep_cases("ZI")
def test_rounding_is_reached_where_the_flank_end_has_room(form: str) -> None:
    """The flank ends at the base cylinder, a ground one where it is nearest to the axis, looked for on 200,001 points: a
    rounding is as large as that is above the root, or larger, and touches the flank above, on this side of its end."""
    thread = nominal_thread(steep_worm(form, dedendum=0.8))
    p = thread.start + np.linspace(-1.0, 1.0, 200001) * (thread.start if form == "ZI" else 2.0 * thread.module)
    points, normals = thread.section.axial_section(p)
    i = int(points[:, 0].argmin())
    lowest, end, slant = points[i, 0], p[i], normals[i, 0]
    assert lowest == pytest.approx(thread.base_radius, rel=1e-9) if form == "ZI" else lowest < thread.radius
    for depth in (0.3, 0.8, 1.2):
        land = thread.radius - depth * thread.module
        # where the end's normal is along the rounding's
        least = max((lowest - land) / (1.0 - slant), 0.0)
        for radius in (least + np.array([0.001, 0.1, 0.3]) * thread.module).tolist():
            rounding = thread.root_rounding(land, radius)
            assert end < rounding.form_point[0] < thread.start
            # it touches: centre one radius off along the normal, and one over the root
            (x, z), (n_x, n_z) = (v[0] for v in thread.section.axial_section(np.array([rounding.form_point[0]])))
            assert x + radius * n_x == pytest.approx(land + radius, rel=1e-12)
            assert rounding.arc.centre == pytest.approx((land + radius - thread.radius, -z - radius * n_z), abs=1e-9)
        if least:
            with pytest.raises(gm.DesignError, match="does not reach"):
                thread.root_rounding(land, 0.999 * least)


def test_a_dedendum_that_is_left_open_is_no_reason_for_a_refusal() -> None:
    """The largest step of 0.05 at which the rounding 0.2 begins below the base cylinder; the wheel's tip keeps its clearance."""
    design = steep_worm("ZI")
    base = (design.reference_diameter / 2.0 - nominal_thread(design).base_radius) / design.axial_module
    dedendum = 0.05 * np.floor((base + 0.2) / 0.05)
    assert design.worm.dedendum == pytest.approx(dedendum, rel=1e-9)
    (line,) = build(design).warnings
    assert line.startswith(f"worm.dedendum = {dedendum:.4g}: the default, instead of 1.2 because the flanks")
    assert not build(steep_worm("ZI", dedendum=design.worm.dedendum)).warnings
    with pytest.raises(gm.DesignError, match=r"^worm\.root_rounding = 0\.2: the flank does not reach"):
        build(steep_worm("ZI", dedendum=design.worm.dedendum + 0.05))
    wheel = {"wheel": {"teeth": 58}, "shaft_angle": 104.13, "hob": {"reference_diameter": 26.877}}
    free = gm.parse({**SHORT["ZI"], "kind": "worm_drive", **wheel})
    assert isinstance(own := complete_design(free), WormDriveDesign)
    assert own.wheel.addendum == pytest.approx(dedendum - 0.2, rel=1e-9)


@pytest.mark.sweep
def test_a_tooth_by_adapted_defaults_reaches_its_tip_all_along_the_face() -> None:
    """Seed 13: at the stations of the proof it did on 1.14 times the width, and not between them."""
    keys = {
        "module": 1.524,
        "pressure_angle": 18.88,
        "worm": {"threads": 4, "form": "ZK", "quotient": 8.066, "right_hand": False},
        "wheel": {"teeth": 29, "profile_shift": -0.304},
        "hob": {"reference_diameter": 12.592},
    }
    gears = gm.build(gm.parse({"kind": "worm_drive", **keys}))
    sections = gears.members["wheel"].tooth.sections(np.linspace(0.0, 1.0, 301))
    assert np.isfinite(sections.right.tip).all()
    assert gears.limits().members["wheel"].sides["right"].lost_share >= 0.0


@pytest.mark.parametrize(
    ("file", "changes", "most"),
    [
        (CORPUS / "refused_worm_drive_62.toml", [], 0.1),
        pytest.param(SAMPLES / "worm_drive.toml", ["worm.threads=10"], 1.2, marks=pytest.mark.sweep),
        pytest.param(SAMPLES / "worm_drive.toml", ["pressure_angle=5"], 4.5, marks=pytest.mark.sweep),
    ],
)
def test_no_long_search_for_a_face_width(file: Path, changes: list[str], most: float) -> None:
    """Ten to twenty times the effort, up to 60 s, when every width and tip was tried whose fillets overlap in the middle plane, and
    ends of loops were looked for before the flanks had been found to be lost elsewhere."""
    with limit_effort(Effort(most)):
        own = complete_design(gm.load(file, changes, complete=False))
    assert isinstance(own, WormDriveDesign)
    assert own.wheel.face_width <= own.usual_face_width


@pytest.mark.filterwarnings("error")
def test_a_place_far_off_on_the_hob_is_no_warning() -> None:
    """Points far off on the hob, where a step of Newton's method has gone astray, are finite. The polar angle rests there: its
    rate falls to 0 as 1 / v^2."""
    design = gm.load(SAMPLES / "worm_drive.toml")
    assert isinstance(design, WormDriveDesign)
    hob = wheel_hob(complete_design(design).in_mm(), 1)
    flank = hob.flank(1, hob.thread.radius).tool
    p = np.array(hob.rounding.form_point[0])
    far = flank.jet(p, np.array([1e100, 1e200]))
    assert np.isfinite(far.r).all()
    np.testing.assert_allclose(far.r[1], far.r[0], rtol=1e-12)


#: an undercut of two thirds of the flank towards one end, and one that removes it all before the face of DIN 3975 ends
UNDERCUT = {
    "ZN 6/45": {
        "module": 1.008,
        "pressure_angle": 20.9,
        "worm": {"threads": 6, "form": "ZN", "quotient": 8.923},
        "wheel": {"teeth": 45},
    },
    "ZN 3/30": {
        "module": 8.205,
        "pressure_angle": 18.4,
        "worm": {"threads": 3, "form": "ZN", "quotient": 6.845},
        "wheel": {"teeth": 30, "profile_shift": -0.377},
    },
}


@pytest.mark.sweep
@pytest.mark.sweep_cases("ZN 6/45")
@pytest.mark.parametrize("name", sorted(UNDERCUT))
def test_an_undercut_flank_is_of_one_sheet(name: str) -> None:
    """At 61 stations of the face that is left to the default: cut where it turns inside out, or before, not at the form point,
    where flank and fillet touch; with the sense that it has at mid face; and generated by a hob that looks away from the wheel."""
    tooth = gm.build(gm.parse({"kind": "worm_drive", **UNDERCUT[name]})).members["wheel"].tooth
    t = np.linspace(0.0, 1.0, 61)
    most = 0.0
    for which in Side:
        side, ends = tooth.side(which), tooth.ends(which, t)
        lost = (ends.form_point_flank - side.form_point[0]) / (ends.tip - side.form_point[0])
        assert np.abs(np.diff(lost)).max() < 0.2
        most = max(most, float(lost.max()))
        grid = tooth.flank_grid(which, np.linspace(0.0, 1.0, 5), t)
        assert side.generation is not None
        flank, (p, v) = side.generation[0], np.moveaxis(grid.parameters, -1, 0)
        density = area_density(flank.jet(p, v))
        assert (density * density[-1, 30] > 0.0).all()
        assert (flank.tool.jet(*flank.on_tool(p, v)).n[..., 0] > 0.0).all()
    assert most > 0.6


@pytest.mark.sweep
@pytest.mark.parametrize("name", sorted(UNDERCUT))
def test_share_of_the_flank_that_undercut_removes(name: str) -> None:
    """Brute force: the hob's flank on a grid, carried to where it generates. A point is lost if any part of the thread cuts it
    away in another position of the roll. The thread is its axial section with the rounding of its tip."""
    gears = gm.build(gm.parse({"kind": "worm_drive", **UNDERCUT[name]}))
    assert isinstance(gears.design, WormDriveDesign)
    tooth, t, share = gears.members["wheel"].tooth, np.linspace(0.0, 1.0, 81), np.linspace(0.0, 1.0, 61)[:, None]
    side, hob = tooth.right, wheel_hob(gears.design.in_mm(), 1)
    tip = tooth.ends(Side.RIGHT, t).tip
    p = side.form_point[0] + share * (tip - side.form_point[0])
    v, jet = along(side.flank, p, tooth.stations(t), tooth.blank.axial)
    assert side.generation is not None
    on_hob = side.generation[0].tool.jet(p, v).r
    thread, rounding = hob.thread, hob.thread.rounding_surface(hob.rounding, 1)
    radii = np.linspace(hob.thread.base_radius if name[:2] == "ZI" else 0.5 * thread.radius, hob.form_radius, 400)
    flank = thread.section.axial_section(np.array([thread.at_radius(float(rho)) for rho in radii]))[0]
    arc = rounding.axial_section(np.linspace(hob.rounding.form_point[1], LAND_PARAMETER, 200))[0]
    section = np.concatenate((flank, arc[1:]))
    place = hob.place(1)
    deepest = np.full(p.shape, np.inf)
    for phi in np.linspace(-0.9, 0.9, 1201):
        r = place.inverse.point(hob.roll.at(np.array(phi)).tool_to_blank.inverse.point(jet.r))
        rho, turn = np.hypot(r[..., 0], r[..., 1]), np.arctan2(r[..., 1], r[..., 0])
        away = r[..., 2] - thread.hand * thread.screw * turn - np.interp(rho, *section.T)
        deepest = np.minimum(deepest, np.where((rho > radii[0]) & (rho < hob.tip_radius), away, np.inf))
    lost = deepest < -1e-5 * thread.module
    area = np.linalg.norm(np.cross(*np.gradient(on_hob, axis=(0, 1))), axis=-1)
    area[[0, -1]] *= 0.5
    area[:, [0, -1]] *= 0.5
    known = gears.limits().members["wheel"].sides["right"]
    assert known.lost_share == pytest.approx(area[lost].sum() / area.sum(), abs=0.01)
    assert known.undercut_face_share == pytest.approx(lost.any(axis=0).mean(), abs=0.03)
    assert known.greatest_lost_share == pytest.approx(lost.mean(axis=0).max(), abs=0.05)
    assert 0.0 < known.lost_share < 0.25


@pytest.mark.sweep
def test_what_undercut_loses_is_in_sheet_and_tables_as_in_json() -> None:
    """Shares lost on either side; a wheel that is not undercut loses nothing."""
    gears = gm.build(gm.parse({"kind": "worm_drive", **UNDERCUT[min(UNDERCUT)]}))
    sides = gears.limits().members["wheel"].sides
    shares = [(s.lost_share, s.undercut_face_share, s.greatest_lost_share, s.greatest_lost_at) for s in sides.values()]
    assert all(0.0 < share < 1.0 for own in shares for share in own[:3])
    (lost,) = [table for table in gears.limits().listings if "what of the tool's flank is lost" in table.title]
    assert [row[0] for row in lost.rows] == list(sides)
    np.testing.assert_allclose([row[1:] for row in lost.rows], shares, rtol=1e-4)
    np.testing.assert_allclose(undercut_rows(gears), np.transpose(shares), rtol=1e-6)
    whole = gm.build(gm.load(SAMPLES / "worm_drive.toml"))
    assert undercut_rows(whole) == [[0.0, 0.0]] * 3 + [[None, None]]
    assert not any("lost" in table.title for table in whole.limits().listings)


def undercut_rows(gears: gm.Gears) -> list[list[Any]]:
    """Values of the sheet's table of the wheel's undercut, right and left."""
    (table,) = [table for table in gears.sheet().tables if table.title == "Wheel: undercut"]
    return [list(row[2:]) for row in table.rows]


def test_throat_angle_is_refused_where_it_does_nothing() -> None:
    keys = {"kind": "worm_drive", "module": 5, "worm": {"threads": 2}, "wheel": {"teeth": 38, "throat_angle": 30.0}}
    with pytest.raises(
        gm.DesignError, match=r"^wheel\.throat_angle = 30 deg: .* wheel\.tip_form is throated; .*chamfered"
    ):
        gm.build(gm.parse(keys))


@pytest.mark.sweep
def test_wheels_with_adapted_addendum_are_sound_between_proof_stations() -> None:
    """Seed 172: with the usual face its solid failed; the face of three quarters is meshed, and closed."""
    gears = gm.build(gm.load(CORPUS / "solid_worm_drive_172.toml"))
    assert any("wheel.addendum" in line for line in gears.warnings)
    assert gears.solid("wheel", 0.05).measured.watertight


@pytest.mark.sweep
def test_a_nominal_tip_beyond_the_end_of_a_flank_is_no_undercut() -> None:
    """Single stations of many were taken for undercut: there the flank ends between its tip and the nominal one."""
    tooth = gm.build(gm.load(CORPUS / "stations_worm_drive_137.toml")).members["wheel"].tooth
    sections = tooth.sections(np.linspace(0.55, 0.65, 410))
    for side, ends in ((tooth.right, sections.right), (tooth.left, sections.left)):
        assert (ends.form_point_flank == side.form_point[0]).all()
