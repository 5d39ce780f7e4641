"""Fit of gears: closed forms of spur gears, whole members rolled, and answers of the commands."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from oracles.built import contact_of, pair_of
from oracles.examples import some
from oracles.overlap import overlap
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Contact, GearPair, Rigid, load
from gearmesh.answers.contact import fit as warned
from gearmesh.answers.contact.contact import total_ratio
from gearmesh.app.cli import main
from gearmesh.check.members import roll_members
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.engagement.symmetry import image
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.fit import freeing as freeing_module
from gearmesh.contact.fit.fit import fit, reversed_pair
from gearmesh.contact.fit.freeing import EFFORT_OF_SLACK, MAX_EFFORT, FreeingShift, freeing_shift, shift_gear
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.mesh.solid import gear_solid

CORPUS = Path(__file__).parents[1] / "corpus"
BEVEL = {
    "kind": "spiral_bevel",
    "module": 4.0,
    "spiral_angle": 35.0,
    "face_width": 25.0,
    "pinion": {"teeth": 15},
    "gear": {"teeth": 40},
}


def sample(name: str, *keys: str) -> GearPair:
    return pair_of(load(SAMPLES / f"{name}.toml", keys))


def test_a_spur_pair_fits_as_involutes_have_it() -> None:
    """Centre distance 90.4 for 90: play of 2 r_b (inv a' - inv a) beside the backlash, clearance 0.25 modules more by 0.4 mm."""
    gears = sample("spur", "assembly.dx=0.4")
    found = fit(gears)
    assert found is not None
    assert found.fits
    base = np.array([10.0, 20.0]) * 3.0 * np.cos(np.radians(20.0))
    new, old = np.arccos(base.sum() / 90.4), np.radians(20.0)
    normal = 0.06 + 2.0 * base.sum() * ((np.tan(new) - new) - (np.tan(old) - old))
    np.testing.assert_allclose(found.normal_backlash, normal, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.backlash, normal / base[1], rtol=0, atol=1e-11)
    # the clearance is the same all along the face: its middle is told
    places = [clearance.point[2] for clearance in found.clearances if clearance is not None]
    np.testing.assert_allclose(places, [0.0, 0.0], atol=1e-12)
    assert found.pitch_radius == pytest.approx(90.4 * 40.0 / 60.0, abs=1e-9)
    np.testing.assert_allclose(found.transverse_backlash, normal / np.cos(new), rtol=0, atol=1e-9)
    for clearance in found.clearances:
        assert clearance is not None
        assert clearance.distance == pytest.approx(0.75 + 0.4, abs=1e-6)


@pytest.mark.parametrize("helix", [0.0, 17.0])
@pytest.mark.parametrize("widths", [(32.0, 30.0), (18.0, 25.0)])
@pytest.mark.sweep_cases("widths0-17.0", "widths1-0.0", "widths1-17.0")
def test_contact_ratio_of_unequal_faces_to_nine_digits(helix: float, widths: tuple[float, float]) -> None:
    design = gm.BeveloidDesign(
        module=3.0,
        pinion={"teeth": 19, "helix_angle": helix, "face_width": widths[0]},
        gear={"teeth": 47, "helix_angle": -helix, "face_width": widths[1]},
    )
    gears = pair_of(design)
    cycle = mesh_cycle(solver_pair(gears), gears.pitch)
    assert cycle is not None
    beta = np.radians(helix)
    alpha = np.arctan(np.tan(np.radians(20.0)) / np.cos(beta))
    reference = 0.5 * np.array([19.0, 47.0]) * 3.0 / np.cos(beta)
    base, tip = reference * np.cos(alpha), reference + 3.0
    action = np.sqrt(tip**2 - base**2).sum() - reference.sum() * np.sin(alpha)
    transverse = action / (np.pi * 3.0 / np.cos(beta) * np.cos(alpha))
    overlap_ratio = min(widths) * np.sin(beta) / (np.pi * 3.0)
    assert cycle.transverse_ratio == pytest.approx(transverse, abs=1e-9)
    assert cycle.overlap_ratio == pytest.approx(overlap_ratio, abs=1e-9)
    assert cycle.contact_ratio == pytest.approx(transverse + overlap_ratio, abs=1e-9)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "keys",
    some(
        [
            ("helical", "assembly.gamma_h=0.05"),
            ("spur", "assembly.dz=0.5"),
            ("face_gear", "assembly.dq=0.1"),
            ("modified_involute",),
            ("internal",),
            ("beveloid_intersected",),
        ],
        2,
        whole=True,
    ),
    ids=lambda keys: keys[0],
)
def test_other_flanks_that_are_the_image_are_solved_once(
    keys: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Following them gives the same as the image."""
    gears = sample(*keys)
    known = fit(gears)
    # a gear that stands otherwise where it is at rest, and counts its turns from there
    mount, angle = gears.gear.mount, 0.3
    base, zero = mount.base @ Rigid.about_z(angle), mount.zero + mount.sign * angle
    other = fit(replace(gears, gear=replace(gears.gear, mount=replace(mount, base=base, zero=zero))))
    flanks = solver_pair(gears)
    cycle = mesh_cycle(flanks, gears.pitch)
    assert cycle is not None
    assert cycle.curve is not None
    assert image(cycle.curve, solver_pair(reversed_pair(gears))) is not None
    monkeypatch.setattr("gearmesh.contact.fit.fit.image", lambda *_: None)
    followed = fit(gears)
    assert followed is not None
    for each in (known, other):
        assert each is not None
        np.testing.assert_allclose(each.backlash, followed.backlash, rtol=0, atol=1e-13)
        np.testing.assert_allclose(each.normal_backlash, followed.normal_backlash, rtol=0, atol=1e-11)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "keys",
    some(
        [
            ("helical", "assembly.gamma_v=0.05"),
            ("internal", "pinion.modifications_right.helix_slope=0.01"),
            ("spiral_bevel_basic",),
            ("face_gear", "assembly.dE=0.1"),
        ],
        2,
        whole=True,
    ),
    ids=lambda keys: keys[0],
)
def test_other_flanks_that_are_no_image_are_followed(keys: tuple[str, ...]) -> None:
    gears = sample(*keys)
    cycle = mesh_cycle(solver_pair(gears), gears.pitch)
    assert cycle is not None
    assert cycle.curve is not None
    assert image(cycle.curve, solver_pair(reversed_pair(gears))) is None


@pytest.fixture(scope="module")
def filleted() -> Contact:
    """The contact of a face gear whose pinion's root is as round as is standard; how far it were to be moved is not asked."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(warned, "freeing_shift", lambda *_: None)
        return contact_of(load(SAMPLES / "face_gear.toml", ["pinion.dedendum=1.25", "pinion.tool_tip_radius=0.25"]))


@pytest.mark.sweep
@pytest.mark.parametrize("keys", [("worm_drive_zk_oversize",), ("spiral_bevel_basic",)])
def test_backlash_over_a_pitch_is_between_first_touches_of_both_flanks(keys: tuple[str, ...]) -> None:
    """Whole members, solved anew at every rotation: the tooth pair that is ahead on either side."""
    gears = sample(*keys)
    found = fit(gears)
    assert found is not None
    phi1 = gears.pitch * np.array([0.03, 0.21, 0.4, 0.58, 0.77, 0.95])
    sides = []
    for pair in (gears, reversed_pair(gears)):
        every = phi1[:, None] + gears.pitch * np.arange(-3, 4)
        path = contact_path(solver_pair(pair), every.ravel())
        # as of tooth pair 0 at rotations pitches away
        ahead = np.where(path.touching, pair.drive * (path.phi2 - pair.ratio * path.rotation), -np.inf)
        sides.append(ahead.reshape(every.shape).max(axis=1))
    apart = -(sides[0] + sides[1])
    step = gears.gear.tooth.pitch_angle
    play = found.play(phi1)
    np.testing.assert_allclose((apart - play + 0.5 * step) % step - 0.5 * step, 0.0, atol=2e-9)
    assert found.backlash[0] - 1e-9 <= play.min() < play.max() <= found.backlash[1] + 1e-9


@pytest.mark.sweep
def test_backlash_of_positions_and_curve_are_one() -> None:
    """In the table of positions, over a pitch, and as limits in the summary."""
    contact = contact_of(load(SAMPLES / "worm_drive_zk_oversize.toml", []))
    curve, rows = contact.backlash(1441), contact.positions()
    pitch = np.degrees(contact.pair.pitch)
    along = np.interp(np.mod([row.phi1 for row in rows], pitch), curve.phi1, curve.backlash)
    np.testing.assert_allclose([row.backlash for row in rows], along, atol=2e-5)
    assert curve.least == pytest.approx(contact.summary["backlash_min_deg"], abs=1e-12)
    assert curve.greatest == pytest.approx(contact.summary["backlash_max_deg"], abs=1e-12)
    assert curve.least <= curve.backlash.min() + 1e-12
    assert np.ptp(curve.backlash) > 0.9 * (curve.greatest - curve.least)


@pytest.mark.sweep
def test_a_tip_in_a_fillet_is_told_with_depth_and_place(filleted: Contact) -> None:
    """The gear's tips stand in the pinion's fillets, whole members say how much."""
    gears, found = filleted.pair, filleted.fit
    assert found is not None
    assert not found.fits
    driving, coast = found.interference
    assert (driving.driving, coast.driving) == (True, False)
    assert driving.fillet_of == coast.fillet_of == 0
    # no backlash, and both sides alike
    assert driving.depth == pytest.approx(coast.depth, rel=1e-3)
    (rolled,) = roll_members(gears, driving.phi1, 40, coast=False)
    assert rolled.drive is not None
    flanks = solver_pair(gears).parts[0]
    cycle = mesh_cycle(flanks, gears.pitch)
    assert cycle is not None
    assert cycle.curve is not None
    free = gears.ratio * driving.phi1 + gears.drive * cycle.curve.advance(np.array([driving.phi1]))[0]
    advance = gears.drive * (rolled.drive.phi2 - free)
    # the lever of the fillet's normal is a little less than the radius
    radius = float(np.hypot(*(driving.point - gears.gear.mount.origin)[[0, 1]]))
    assert 0.5 * radius * advance < driving.depth < 1.05 * np.linalg.norm(driving.point) * advance


@pytest.mark.sweep
def test_a_jammed_pair_overlaps_and_a_moved_one_does_not() -> None:
    gears = sample("spur", "assembly.dx=-0.3")
    found = fit(gears)
    assert found is not None
    assert found.normal_backlash[0] < -0.1
    (rolled,) = roll_members(gears, 0.05, 20)
    assert found.backlash[0] - 0.05 * ARCSEC < rolled.backlash < found.backlash[1] + 0.05 * ARCSEC
    freeing = freeing_shift(gears, found, np.inf)
    assert freeing is not None
    assert freeing.least
    shift = freeing.length
    # the backlash of 0.06 mm is used up 0.0864 mm before the nominal distance, by the involutes
    base, distance = 30.0 * 3.0 * np.cos(np.radians(20.0)), np.linspace(89.9, 90.0, 200_001)
    angle, nominal = np.arccos(base / distance), np.radians(20.0)
    play = 0.06 + 2.0 * base * ((np.tan(angle) - angle) - (np.tan(nominal) - nominal))
    least = 0.3 - (90.0 - float(np.interp(0.0, play, distance)))
    assert least - 1e-6 < shift < 1.01 * least
    tolerance = 0.002
    solids = [gear_solid(member, tolerance) for member in gears.both]
    for pair, thick in ((gears, True), (shift_gear(gears, shift), False)):
        (rolled,) = roll_members(pair, 0.05, 20)
        assert rolled.drive is not None
        assert rolled.coast is not None
        middle = 0.5 * (rolled.drive.phi2 + rolled.coast.phi2)
        pieces = overlap(pair, (solids[0], solids[1]), 0.05, middle).beyond(tolerance, tolerance)
        assert bool(pieces) == thick


@pytest.mark.sweep
def test_the_search_for_a_freeing_shift_ends_after_so_much_effort(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tips of an undercut pinion in fillets took twelve solutions of the whole engagement, each as long as the pair's own."""
    tables = {"pinion": {"teeth": 20, "face_width": 20, "profile_shift": -0.9}, "gear": {"teeth": 40, "face_width": 20}}
    (gears,) = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **tables})).train.pairs
    found, least, tried = fit(gears), 0.2722, []
    assert found is not None

    def slack(moved: GearPair) -> float:
        """The depth of the tips in the fillets, to about what the engagement gives, and the backlash beyond."""
        tried.append(float(moved.gear.mount.origin[0] - gears.gear.mount.origin[0]))
        return 0.13 if tried[-1] > least else -1.1 * (least - tried[-1]) ** 2 - 1e-4

    monkeypatch.setattr(freeing_module, "slack_of", slack)
    for effort, is_least in ((MAX_EFFORT, False), (np.inf, True)):
        tried.clear()
        freeing = freeing_shift(gears, found, effort)
        assert freeing is not None
        assert freeing.least == is_least
        assert (len(tried) <= MAX_EFFORT / EFFORT_OF_SLACK) != is_least
        assert freeing.length == pytest.approx(min(shift for shift in tried if shift > least), rel=1e-12)
        assert least < freeing.length < (1.008 if is_least else 1.25) * least


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("keys", "sense"),
    [(("internal", "assembly.dx=-0.15"), -1.0), (("beveloid_intersected", "assembly.dz=-0.2"), 1.0)],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_the_shift_that_is_told_is_the_least_that_frees(keys: tuple[str, ...], sense: float) -> None:
    gears = sample(*keys)
    found = fit(gears)
    assert found is not None
    freeing = freeing_shift(gears, found, np.inf)
    assert freeing is not None
    shift = freeing.length
    assert np.sign(shift) == sense
    there = [fit(shift_gear(gears, share * shift)) for share in (1.0, 0.98)]
    assert [each is not None and each.fits for each in there] == [True, False]


@pytest.mark.sweep
def test_samples_are_free_and_say_so() -> None:
    for name in ("face_gear", "zerol", "circular_arc"):
        contact = contact_of(load(SAMPLES / f"{name}.toml"))
        assert contact.fit is not None
        assert contact.fit.fits
        assert contact.summary["interference_um"] == 0.0
        assert contact.summary["tip_clearance_gear_mm"] > 0.0
        assert not [line for line in contact.warnings if "interference" in line or "jammed" in line]


def test_the_document_says_where_tips_are_in_fillets(filleted: Contact) -> None:
    contact = filleted
    told = contact.document()["fit"]
    assert not told["fits"]
    first, second = told["interference"]
    assert (first["flanks"], second["flanks"]) == ("driving", "coast")
    assert (first["tip_of"], first["fillet_of"]) == ("gear", "pinion")
    assert 20.0 < first["depth_um"] < 25.0
    # on the gear's tip plane, and beyond the pinion's form diameter
    tip = contact.pair.gear.tooth.blank.tip
    assert tip.value(np.array(first["gear_point_mm"])) == pytest.approx(0.0, abs=1e-6)
    assert np.hypot(*first["pinion_point_mm"][:2]) < 0.5 * 25 * 6.35
    assert first["depth_um"] == pytest.approx(contact.summary["interference_um"], rel=1e-2)
    assert sum("interference" in line for line in contact.warnings) == 2


@pytest.mark.sweep
def test_positions_left_out_are_the_whole_engagement() -> None:
    """From where a tooth pair begins to touch to where it ceases; what the design sets counts."""
    design = gm.parse({**BEVEL, "contact": {"phi1": {"count": 9}}})
    contact = contact_of(design)
    assert contact.cycle is not None
    path = contact.path
    np.testing.assert_allclose(path.phi1[[0, -1]], contact.cycle.engagement, rtol=0, atol=1e-12)
    assert contact.document()["design"]["contact"]["phi1"]["start"] == pytest.approx(np.degrees(path.phi1[0]))
    begin, end = contact.cycle.surface
    assert path.phi1[0] <= begin < end <= path.phi1[-1] + 1e-12
    # no pair is behind its neighbours by more at the ends than it is where teeth change over
    assert contact.neighbours is not None
    given = contact_of(gm.parse({**BEVEL, "contact": {"phi1": {"start": -3, "stop": 3, "count": 3}}}))
    np.testing.assert_allclose(np.degrees(given.path.phi1), [-3.0, 0.0, 3.0], atol=1e-12)


@pytest.mark.sweep
def test_neighbours_are_the_pair_itself_a_pitch_away() -> None:
    contact = contact_of(load(SAMPLES / "spiral_bevel_basic.toml"))
    assert contact.neighbours is not None
    path, pair = contact.path, contact.pair
    shifted = [contact_path(solver_pair(pair), path.rotation + k * pair.pitch) for k in (-1, 1)]
    advances = [pair.drive * (each.phi2 - pair.ratio * each.rotation) for each in (path, *shifted)]
    ahead = np.fmax(advances[1], advances[2]) - advances[0]
    known = np.isfinite(contact.neighbours)
    assert known.sum() >= 15
    np.testing.assert_allclose(contact.neighbours[known], ahead[known], rtol=0, atol=1e-11)
    # over one pitch about the middle the pair carries
    assert (contact.neighbours[np.abs(path.rotation) < 0.3 * pair.pitch] < 0.0).all()


@pytest.mark.sweep
def test_check_fails_where_gears_are_jammed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = tmp_path / "check.json"
    arguments = [
        "check",
        str(SAMPLES / "spur.toml"),
        "--json",
        str(told),
        "--set",
        "assembly.dx=-0.3",
        "--tol",
        "0.1mm",
    ]
    assert main(arguments) == 3
    out = capsys.readouterr()
    assert "FAILED" in out.out
    assert "the pair is jammed" in out.err
    assert "free with a centre distance of at least" in out.err
    verdicts = {each["what"]: each for each in json.loads(told.read_text())["verdicts"]}
    assert not verdicts["fit: least backlash_normal_mm"]["ok"]
    assert verdicts["fit: sides on which the flanks meet"]["ok"]
    assert verdicts["fit: tip_clearance_gear_mm"]["ok"]


@pytest.mark.sweep
def test_tips_deeper_than_roots_are_reported_before_the_refusal(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A gear's addendum of 1.4 modules in a pinion's dedendum of 1.25: what overlaps, how deep, is printed before the refusal."""
    monkeypatch.setattr(warned, "freeing_shift", lambda *_: None)
    assert main(["tca", str(SAMPLES / "spur.toml"), "--set", "gear.addendum=1.4"]) == 3
    err = capsys.readouterr().err
    assert "no contact at any position" in err
    found = re.search(r"the tip of the gear is ([\d.]+) um inside the root of the pinion", err)
    assert found is not None
    assert float(found[1]) == pytest.approx(1e3 * 0.15 * 3.0, abs=0.1)


def test_teeth_that_meet_nowhere_are_told_of(capsys: pytest.CaptureFixture[str]) -> None:
    contact = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml", ["assembly.dz=40"])).contact(0.0)
    assert contact.fit is None
    assert any("flanks touch nowhere" in line for line in contact.warnings)
    assert main(["check", str(SAMPLES / "beveloid_crossed.toml"), "--set", "assembly.dz=40", "--tol", "0.1mm"]) == 3
    assert "fit: sides on which the flanks meet" in capsys.readouterr().out


@pytest.mark.sweep
def test_gears_that_jam_on_fillets_have_no_transmission_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """The overlap is that to which whole members roll; figures are null, positions say why, the remedy frees them."""
    shifts: list[FreeingShift | None] = []
    monkeypatch.setattr(
        warned, "freeing_shift", lambda *asked: shifts.append(freeing_shift(*asked, np.inf)) or shifts[-1]
    )
    contact = contact_of(load(CORPUS / "jammed_spiral_bevel_geometry1.toml"))
    found = contact.fit
    assert found is not None
    assert found.jammed
    assert np.isnan(contact.summary["mesh_te_peak_to_peak_arcsec"])
    assert contact.summary["te_peak_to_peak_arcsec"] is None
    assert [(row.status, row.contact) for row in contact.positions()] == [("jammed", "none")] * 3
    assert np.isnan([row.te for row in contact.positions()]).all()
    assert any("no transmission error is reported; to free it move the gear" in line for line in contact.warnings)
    assert contact.document()["fit"]["jammed"]
    (rolled,) = roll_members(contact.pair, 0.0, 16)
    assert found.play(np.zeros(1))[0] == pytest.approx(rolled.backlash, rel=1e-3)
    (freeing,) = shifts
    assert freeing is not None
    shift = freeing.length
    there = [fit(shift_gear(contact.pair, share * shift)) for share in (1.0, 0.98)]
    assert [each is not None and each.fits for each in there] == [True, False]


@pytest.mark.sweep
def test_fit_is_unknown_where_a_part_of_the_cycle_has_no_contact(capsys: pytest.CaptureFixture[str]) -> None:
    file = CORPUS / "unknown_beveloid_crossed.toml"
    contact = contact_of(load(file))
    found = contact.fit
    assert found is not None
    assert found.fits is None
    told = contact.document()["fit"]
    assert (told["fits"], told["verdict"]) == (None, "unknown")
    assert "the coast flanks have no contact at phi1 = " in told["reason"]
    (gap,) = told["no_contact"]
    assert gap["flanks"] == "coast"
    # nothing touches in the middle of it, and something does beside it and a pitch on
    begin, end = np.radians(gap["phi1_deg"])
    width, pitch = end - begin, contact.pair.pitch
    phi1 = np.array([0.5 * (begin + end), end + 0.1 * width, begin - 0.1 * width])
    other = solver_pair(reversed_pair(contact.pair))
    advances = [first_touch(other, phi1 + k * pitch).advance for k in range(-3, 4)]
    assert np.isfinite(np.max(advances, axis=0)).tolist() == [False, True, True]
    assert 0.0 < contact.summary["backlash_normal_min_mm"] < contact.summary["backlash_normal_max_mm"]
    assert any("it is unknown whether the gears fit" in line for line in contact.warnings)
    assert main(["check", str(file), "--tol", "0.1mm"]) == 3
    assert "fit: parts of the cycle without contact" in capsys.readouterr().out


def test_contact_ratio_warning_needs_a_total_ratio_below_one() -> None:
    """A crowned helical pair touches in points, over less than a pitch without load; the total ratio is that of its involutes."""
    member = {"face_width": 20.0, "addendum": 0.4}
    crowned = {"profile_crowning": "8um", "helix_crowning": "30um"}
    design = {"kind": "cylindrical", "module": 2.0, "helix_angle": 30.0, "backlash": 0.1}
    pair = {"pinion": {"teeth": 19, **member, "modifications": crowned}, "gear": {"teeth": 33, **member}}
    contact = contact_of(gm.parse({**design, **pair}))
    assert contact.cycle is not None
    assert contact.cycle.contact_ratio < 1.0
    assert not any("is below 1" in line for line in contact.warnings)
    (line,) = (line for line in contact.warnings if "the transmission error jumps" in line)
    assert f"the contact ratio is {contact.cycle.contact_ratio:.4g}, with conjugate flanks it would be" in line
    beta = np.radians(30.0)
    alpha = np.arctan(np.tan(np.radians(20.0)) / np.cos(beta))
    reference = np.array([19.0, 33.0]) / np.cos(beta)
    base = reference * np.cos(alpha)
    action = np.sqrt((reference + 0.8) ** 2 - base**2).sum() - reference.sum() * np.sin(alpha)
    total = action / (2.0 * np.pi / np.cos(beta) * np.cos(alpha)) + 20.0 * np.sin(beta) / (2.0 * np.pi)
    # to the positions at which advances are taken
    assert total_ratio(contact.pair, contact.cycle) == pytest.approx(total, abs=0.1)
