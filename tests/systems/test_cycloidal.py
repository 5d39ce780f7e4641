"""Cycloidal drives against closed forms that the core does not know: curve, curvature, area, lost motion, undercut."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.spatial import KDTree

import gearmesh as gm
from gearmesh.answers.contact.shared import shared_touch
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.train_turns import leading_turns
from gearmesh.contact.fit.fit import fit, reversed_pair
from gearmesh.kernel.envelope.limiting_line import limiting_line
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Arc, RackSurface, Region, Side
from gearmesh.loaded.separation import advances_of_halves, near_pairs
from gearmesh.metrology.measured_teeth import pitch_radius
from gearmesh.systems.cycloidal.build import Drive, _lobe_tip
from gearmesh.systems.cycloidal.forces import disc_shares, pin_forces
from gearmesh.systems.cycloidal.geometry import PinCurve
from gearmesh.systems.cycloidal.sheet import lobe_area
from gearmesh.systems.displaced import displaced_bases
from gearmesh.teeth.limits import member_limits
from gearmesh.teeth.offset import offset_tooth
from gearmesh.view.report.card import mesh_card

SAMPLES = Path(__file__).parents[2] / "samples"
#: both forms with a difference of one and of two teeth
FORMS = [
    pytest.param("pins_in_ring", 19, id="pins in ring"),
    pytest.param("pins_in_ring", 18, id="pins in ring, two"),
    pytest.param("pins_in_disc", 19, id="pins in disc"),
    pytest.param("pins_in_disc", 18, id="pins in disc, two"),
]


def design(*overrides: str) -> Any:
    """The sample without modification, with other keys."""
    return gm.load(SAMPLES / "cycloidal.toml", ["modification.equidistant=0", "ring.face_width=12", *overrides])


def drive_of(form: str, teeth: int, *overrides: str) -> Drive:
    return Drive(design(f'form="{form}"', f"disc.teeth={teeth}", *overrides))


def curve(drive: Drive, phi: Array) -> tuple[Array, Array, Array]:
    """Return the pin's centre and its first two derivatives as complex numbers, by hand from the two turns."""
    own = drive.ground
    rate, out = own.pins / own.lobes, own.outside
    big, small = own.circle, -out * own.eccentricity
    turns = [(1.0 - rate, big), (-rate, small)]
    value, slope, bend = (sum((1j * w) ** k * r * np.exp(1j * w * phi) for w, r in turns) for k in range(3))
    return value, slope, bend


@pytest.mark.parametrize(("form", "teeth"), FORMS)
def test_lobes_are_the_curve_beside_the_trochoid(form: str, teeth: int) -> None:
    drive = drive_of(form, teeth, "modification.equidistant=0.07", "modification.offset=-0.1")
    phi = np.linspace(0.05, np.pi, 7)
    centre, slope, _ = curve(drive, phi)
    # the profile lies towards the lobes: inside of an epitrochoid that runs clockwise, outside of a hypotrochoid
    profile = centre + drive.grinding_pin * 1j * slope / np.abs(slope) * -1
    left = drive.envelope(Side.LEFT).jet(phi, np.zeros_like(phi)).r
    half = np.exp(1j * np.pi / drive.ground.lobes)
    shown = (left[:, 0] + 1j * left[:, 1]) / half
    # the left side runs the other way for lobes around the pins
    assert np.abs(shown - (profile if drive.ground.outside > 0 else profile.conj())).max() < 1e-12


@pytest.mark.parametrize(("form", "teeth"), FORMS)
def test_largest_pin_is_where_the_limiting_line_begins(form: str, teeth: int) -> None:
    drive = drive_of(form, teeth)
    phi, largest = drive.ground.sharpest
    _, slope, bend = curve(drive, np.array(phi))
    turning = (slope.conj() * bend).imag / abs(slope) ** 3
    assert abs(abs(1.0 / turning) - largest) < 1e-9
    for more, found in ((-1e-9, 0), (1e-9, 2)):
        # a pin larger by a millionth of a micrometre has two singular points, a smaller one none
        pin = RackSurface(Arc((0.0, 0.0), -(largest + more)), 0.0, 0.0)
        surface = replace(drive.envelope(Side.RIGHT), tool=pin)
        assert limiting_line(surface, (phi - 1e-3, phi + 1.1e-3), np.zeros(1), samples=4097).p.size == found


def test_pins_that_undercut_are_refused_with_the_largest() -> None:
    with pytest.raises(gm.DesignError, match=r"^pin_diameter = 15 mm: the pins undercut .* allowed is less than 6\.59"):
        gm.build(design("pin_diameter=15", "eccentricity=2.4"))
    with pytest.raises(
        gm.DesignError,
        match=r"^modification\.equidistant = 6 mm: the pins undercut .* allowed is less than 4\.41433",
    ):
        gm.build(design("modification.equidistant=6"))


@pytest.mark.sweep_cases("pins in ring, two", "pins in disc", "pins in disc, two")
@pytest.mark.parametrize(("form", "teeth"), FORMS)
def test_unmodified_drives_turn_evenly_on_half_of_the_pins(form: str, teeth: int) -> None:
    gears = gm.build(design(f'form="{form}"', f"disc.teeth={teeth}"))
    contact = gears.contact().summary
    assert contact["mesh_te_peak_to_peak_arcsec"] < 1e-12 * np.degrees(3600.0)
    assert abs(contact["backlash_max_deg"]) < 1e-9
    assert contact["interference_um"] == 0.0
    pins = 20 if form == "pins_in_ring" else teeth
    # with a difference of two the lobes are cut off, and fewer pins touch
    assert contact["contact_ratio"] > (0.45 if teeth == 19 else 0.2) * pins


@pytest.mark.parametrize("form", ["pins_in_ring", "pins_in_disc"])
@pytest.mark.sweep_cases("pins_in_disc")
def test_clearance_does_not_bring_pins_of_the_other_half_into_mesh(form: str) -> None:
    """17.8 of 19 pins, or 13.4 on the other flank: pins behind the eccentric touch if the ring turns back by 16 deg."""
    for flank, sense in (("right", 1), ("left", -1)):
        gears = gm.build(design(f'form="{form}"', "modification.equidistant=0.03", f'contact.flank="{flank}"'))
        contact = gears.contact().summary
        begin, end = sorted(sense * np.array(contact["engagement_phi1_deg"]))
        assert -1e-9 < begin < 20.0
        assert 150.0 < end < 180.0
        assert contact["contact_ratio"] == pytest.approx((end - begin) * 19 / 360.0)


@pytest.mark.parametrize("form", ["pins_in_ring", "pins_in_disc"])
def test_volume_is_that_of_the_closed_form(form: str) -> None:
    gears = gm.build(design(f'form="{form}"'))
    inside = lobe_area(PinCurve(50.0, 1.5, *((20, 19) if form == "pins_in_ring" else (19, 20))), 5.0)
    assert inside is not None
    member = gears.members["disc" if form == "pins_in_ring" else "ring"]
    body = np.pi * member.tooth.blank.body.profile[0][0] ** 2
    assert member.plain_volume() == pytest.approx(12.0 * abs(inside - body), rel=1e-10)


def test_area_is_the_integral_along_the_lobes() -> None:
    own = PinCurve(50.0, 1.5, 20, 19)
    drive = drive_of("pins_in_ring", 19)

    def rate(phi: float) -> float:
        jet = drive.envelope(Side.LEFT).jet(np.array(phi), np.array(0.0))
        return 0.5 * float(jet.r[0] * jet.r_u[1] - jet.r[1] * jet.r_u[0])

    assert 19 * abs(quad(rate, 0.0, 2.0 * np.pi, epsabs=1e-12)[0]) == pytest.approx(lobe_area(own, 5.0), rel=1e-12)


@pytest.mark.sweep
@pytest.mark.sweep_cases("offset", "turned", "disc, offset", "disc, turned")
@pytest.mark.parametrize(
    ("form", "overrides"),
    [
        pytest.param("pins_in_ring", ("equidistant=0.02",), id="equidistant"),
        pytest.param("pins_in_ring", ("equidistant=0.03", "offset=0.02"), id="offset"),
        pytest.param("pins_in_ring", ("rotation=0.05", "equidistant=0.01"), id="turned"),
        pytest.param("pins_in_disc", ("equidistant=0.02", "offset=-0.01"), id="disc, offset"),
        pytest.param("pins_in_disc", ("rotation=0.05", "equidistant=0.01"), id="disc, turned"),
    ],
)
def test_lost_motion_is_the_closed_form_in_the_best_place(form: str, overrides: tuple[str, ...]) -> None:
    given = design(f'form="{form}"', *(f"modification.{key}" for key in overrides))
    contact, closed = gm.build(given).contact().summary, np.degrees(Drive(given).lost_motion)
    # of 20 pins one is never farther than half a pitch from the best place
    assert closed * (1.0 - 2e-4) < contact["backlash_min_deg"] < closed * 1.02


@pytest.mark.sweep
@pytest.mark.sweep_cases("4 lobes", "pins in disc")
@pytest.mark.parametrize(
    ("form", "teeth", "sizes", "rotation"),
    [
        pytest.param("pins_in_ring", 6, (6.789, 130.28, 23.65), 0.099, id="6 lobes"),
        pytest.param("pins_in_ring", 4, (3.55, 100.0, 25.22), 0.071, id="4 lobes"),
        pytest.param("pins_in_disc", 6, (3.733, 100.0, 34.88), 0.114, id="pins in disc"),
    ],
)
def test_few_pointed_lobes_pass_from_pin_to_pin(
    form: str, teeth: int, sizes: tuple[float, float, float], rotation: float
) -> None:
    """The middle of such a flank faces the ring far from its tip: 14.7 deg on 6 lobes."""
    keys = dict(zip(("eccentricity", "pin_circle", "pin_diameter"), sizes, strict=True))
    made = gm.parse(
        {"kind": "cycloidal", "units": "mm", "form": form, **keys, "modification": {"rotation": rotation}}
        | {"disc": {"teeth": teeth, "face_width": 10}, "ring": {"teeth": teeth + 1, "face_width": 10}}
    )
    drive, pair = Drive(made), gm.build(made).pairs[0]
    found = fit(pair)
    assert found is not None
    assert not found.jammed
    assert not found.collisions
    assert found.backlash == pytest.approx((drive.lost_motion, drive.lost_motion), rel=1e-9)
    # by the distances of all points of the lobes from all pins, next to the place where a lobe passes a pin
    own = drive.curve
    right = drive.lobe_points(np.linspace(0.0, _lobe_tip(drive)[0], 2001)) @ np.array([1.0, 1j, 0.0])
    both = np.concatenate((right, right.conj()))
    lobes = (both * np.exp(2j * np.pi * np.arange(own.lobes) / own.lobes)[:, None]).ravel()
    pins = own.circle * np.exp(2j * np.pi * np.arange(own.pins) / own.pins)
    phi1 = np.radians(np.array([0.0, 150.0, 166.2, 172.0, 178.0, 183.98, 191.54]))
    play = drive.lost_motion
    for beyond, free in ((-1e-5, False), (1e-5, True), (play - 1e-5, True), (play + 1e-5, False)):
        phi2 = found.turns(phi1) + pair.drive * beyond
        if form == "pins_in_ring":
            # the disc turns about 0 and the ring about -e, both clockwise; seen from the lobes
            centres = (np.exp(-1j * phi2)[:, None] * pins - made.eccentricity) * np.exp(1j * phi1)[:, None]
        else:
            centres = (np.exp(-1j * phi1)[:, None] * pins + made.eccentricity) * np.exp(1j * phi2)[:, None]
        apart = np.array([np.abs(lobes[:, None] - row).min() for row in centres])
        assert ((apart > drive.pin) == free).all(), (beyond, apart - drive.pin)


def test_equidistant_alone_has_the_textbook_lost_motion() -> None:
    assert Drive(design("modification.equidistant=0.02")).lost_motion == pytest.approx(2.0 * 0.02 / 30.0, rel=1e-9)


def test_relief_is_removed_along_the_normal_and_stays_smooth() -> None:
    plain, relieved = (
        gm.build(design(*asked)).members["disc"].tooth for asked in ((), ("modification.tip_relief=0.1",))
    )
    t = np.array([0.5])
    points = [tooth.grid(Region.LAND, np.array([0.5]), tooth.sections(t)).points[0, 0] for tooth in (plain, relieved)]
    assert points[0][0] - points[1][0] == pytest.approx(0.1, abs=1e-12)
    ends = [
        relieved.grid(region, np.array([s]), relieved.sections(t)).normals[0, 0]
        for region, s in ((Region.FLANK_RIGHT, 1.0), (Region.LAND, 0.0))
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-12
    assert relieved.unmodified_tooth.volume() == pytest.approx(plain.volume(), rel=1e-12)


def test_solid_is_within_its_tolerance_of_whole_lobes() -> None:
    gears = gm.build(gm.load(SAMPLES / "cycloidal.toml"))
    for name in ("disc", "ring"):
        solid = gears.solid(name, tolerance="20um")
        assert solid.figures["watertight"]
        assert solid.figures["max_deviation_um"] <= 20.0
    assert len(gears.members["disc"].openings) == 6


def test_moved_lobes_keep_their_land() -> None:
    tooth = gm.build(design()).members["disc"].tooth
    moved = offset_tooth(tooth, 0.1)
    land = moved.grid(Region.LAND, np.array([0.5]), moved.sections(np.array([0.5]))).points[0, 0]
    assert land[0] == pytest.approx(46.6, abs=1e-12)
    # a pin that is smaller by the distance grinds the same lobes
    smaller = gm.build(design("modification.equidistant=-0.1")).members["disc"].tooth
    assert moved.volume() == pytest.approx(smaller.volume(), rel=1e-10)


def test_limits_of_lobes_have_no_undercut() -> None:
    limits = member_limits(gm.build(design()).members["disc"])
    assert not limits.right.undercut.any()
    assert limits.tip_radius == pytest.approx(46.5)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (("eccentricity=2.6",), r"^eccentricity = 2\.6 mm: the curve of the pins' centres has loops"),
        (("ring.teeth=22",), r"^ring\.teeth = 22: must be 20 or 21"),
        (("pin_diameter=16",), r"^pin_diameter = 16 mm: 20 pins on this circle touch"),
        (("support_diameter=112",), r"^support_diameter = 112 mm: .* allowed is between 96 and 108\.775 mm"),
        (("lobe_diameter=95",), r"^lobe_diameter = 95 mm: the lobes do not reach it"),
        (("ring.rim=4",), r"^ring\.rim = 4 mm: the pins stand out of the ring; allowed is more than 5 mm"),
        (("module=3",), r"^module: follows from eccentricity"),
        (("disc.tip_chamfer=0.2",), r"^disc\.tip_chamfer: the lobes"),
        (("output.circle=85",), r"^output\.circle = 85 mm: .* allowed is from 43\.224 to 73\.776 mm"),
        (("assembly.disc_ahead=[0, 0.01]",), r"^assembly\.disc_ahead = \"?2 values\"?: there is one disc"),
        (("disc_gap=1",), r"^disc_gap = 1 mm: there is one disc"),
        (("discs=2",), r"^ring\.face_width = 12 mm: 2 discs are wider; allowed is at least 25\.2 mm"),
        (
            ("measured.disc_radial_um=[1, 2]",),
            r'^measured\.disc_radial_um = "2 values": the disc has lobes; allowed is',
        ),
        (("measured.ring_radial_um=[1, 2]",), r"^measured\.ring_radial_um = 2 values: must be 20 values"),
        (("output.pins=20",), r"^output\.pin_diameter = 8 mm: 20 holes of 11\.02 mm have no room"),
        (
            ("modification.tip_relief=0.1", "modification.tip_relief_start=80"),
            r"^modification\.tip_relief_start = 80 mm",
        ),
    ],
)
def test_bad_keys_are_refused_in_one_line(overrides: tuple[str, ...], message: str) -> None:
    with pytest.raises(gm.DesignError, match=message):
        gm.build(design(*overrides))


@pytest.mark.parametrize(("form", "teeth"), FORMS)
def test_pin_forces_carry_the_torque_through_the_pitch_point(form: str, teeth: int) -> None:
    own = drive_of(form, teeth).curve
    phi = np.array([0.0, 0.1, 0.2])
    forces = pin_forces(own, 50.0, phi)
    places = phi[:, None] + 2.0 * np.pi * np.arange(own.pins) / own.pins
    at = own.circle * np.stack((np.cos(places), np.sin(places)), axis=-1)
    away = at - np.array([own.pitch_radius, 0.0])
    pushed = forces[..., None] * away / np.linalg.norm(away, axis=-1, keepdims=True)
    assert (at[..., 0] * pushed[..., 1] - at[..., 1] * pushed[..., 0]).sum(axis=-1) == pytest.approx(5e4)
    assert pushed[..., 1].sum(axis=-1) == pytest.approx(5e4 / own.pitch_radius)


@pytest.mark.sweep
def test_loaded_pins_share_the_torque_nearly_as_rigid_members_do() -> None:
    given = design()
    loaded = gm.build(given).loaded_contact(50.0, [3.0]).to_dict()
    forces = np.sort([pair["force_n"] for pair in loaded["tooth_pairs"][0]])[::-1]
    own = Drive(given).curve
    closed = [np.sort(pin_forces(own, 50.0 * 20 / 19, np.array(phi)))[::-1] for phi in np.linspace(0.0, np.pi / 10, 91)]
    # the pins' compliance differs from place to place by a few per cent
    apart = min(np.abs(each[: forces.size] - forces).max() for each in closed)
    assert apart < 0.1 * forces[0]


@pytest.mark.sweep
def test_pins_out_of_place_turn_the_ring_as_the_first_pin_says() -> None:
    """To first order, which small deviations keep within a hundredth."""
    chance = np.random.default_rng(3)
    places, gap = np.round(chance.normal(0.0, 0.5, 20), 3), 0.003
    keys = [f"measured.ring_pitch_{side}_um={places.tolist()}" for side in Side]
    gears = gm.build(design(f"modification.equidistant={gap}", *keys))
    turns = whole_turns(gears.train.pair(0))
    angles = 1e-3 * (places - places.mean()) / pitch_radius(gears.members["ring"].tooth, None)
    te = turns.te
    apart = []
    # which pin is at the tooth on x is a matter of the mounting: all are tried
    for first in range(20):
        phi = (np.arange(20) + first + 0.5) * np.pi / 10 - turns.phi1[:, None] * 19 / 20
        levers = -Drive(gears.design).curve.levers(phi)
        with np.errstate(divide="ignore"):
            ahead = np.where(levers > 1e-3, angles - gap / levers, -np.inf).max(axis=-1)
        apart.append(np.abs(ahead - ahead[0] - te).max())
    assert min(apart) < 0.015 * np.ptp(te)
    assert sorted(apart)[1] > 0.1 * np.ptp(te)


@pytest.mark.sweep
def test_ring_turns_as_the_first_of_pins_set_outwards_says() -> None:
    """Both discs see the same pins, half a turn apart; a pin that is farther out opens its gap by the cosine of the lean."""
    away, gap = np.round(np.random.default_rng(3).normal(0.0, 0.1, 20), 3), 0.0004
    gears = gm.build(several(2, f"modification.equidistant={gap}", f"measured.ring_radial_um={away.tolist()}"))
    own, seen = Drive(gears.design).curve, []
    for pair in gears.pairs:
        turns = whole_turns(pair)
        apart = []
        for first in range(20):
            phi = (np.arange(20) + first + 0.5) * np.pi / 10 - turns.phi1[:, None] * 19 / 20
            levers = -own.levers(phi)
            with np.errstate(divide="ignore"):
                gaps = gap + 1e-3 * away * np.cos(own.leans(phi))
                ahead = np.where(levers > 1e-3, -gaps / levers, -np.inf).max(axis=-1)
            apart.append(np.abs(ahead - ahead[0] - turns.te).max())
        assert min(apart) < 0.01 * np.ptp(turns.te)
        assert sorted(apart)[1] > 0.2 * np.ptp(turns.te)
        seen.append(int(np.argmin(apart)))
    assert (seen[0] - seen[1]) % 20 == 10


@pytest.mark.sweep
def test_ring_with_pins_far_out_turns_until_a_pin_meets_the_lobes() -> None:
    """Compare with distances of circles from points of the lobes. To first order pins near the root are 6 arcsec off."""
    away = np.round(np.random.default_rng(5).normal(0.0, 8.0, 20), 1)
    gears = gm.build(design("modification.equidistant=0.02", f"measured.ring_radial_um={away.tolist()}"))
    turns, drive = whole_turns(gears.pairs[0]), Drive(gears.design)
    own, half = drive.ground, np.exp(1j * np.pi / drive.ground.lobes)
    points, slopes, _ = curve(drive, np.linspace(0.0, 2.0 * np.pi * own.lobes, 8000 * own.lobes, endpoint=False))
    inwards = -1j * slopes / np.abs(slopes)
    lobes = (points + drive.grinding_pin * inwards) * half
    tree, outwards = KDTree(np.column_stack((lobes.real, lobes.imag))), -inwards * half
    arms = (drive.curve.circle + 1e-3 * away) * np.exp(2j * np.pi * np.arange(20) / 20)

    def gap(turn: float, phi1: float) -> float:
        """Least distance of a pin from the lobes, mm, where the ring is `turn` (rad) behind its nominal place."""
        places = (arms * np.exp(1j * (turn - np.pi / 20 - 0.95 * phi1)) - own.eccentricity) * np.exp(1j * phi1)
        near = tree.query(np.column_stack((places.real, places.imag)))[1]
        return float(((places - lobes[near]) * outwards[near].conj()).real.min()) - drive.pin

    # every pin is free at some rotation, and one touches farther on
    behind = []
    for phi1 in turns.phi1[::8]:
        trials = np.linspace(-5e-3, 5e-3, 101)
        gaps = np.array([gap(turn, phi1) for turn in trials])
        beyond = np.argmax(gaps) + np.flatnonzero(gaps[np.argmax(gaps) :] < 0.0)[0]
        behind.append(brentq(gap, trials[beyond - 1], trials[beyond], args=(phi1,), xtol=1e-10))
    assert turns.te[::8] == pytest.approx(behind[0] - np.array(behind), abs=0.01 * np.ptp(turns.te))


@pytest.mark.sweep
def test_an_eccentric_ring_has_two_discs_half_a_turn_apart() -> None:
    """The error is that of pins which are out of place by the eccentricity one by one; the other disc is half a turn behind."""
    gap, phase = "modification.equidistant=0.05", np.radians(40.0)
    first, second = (
        gm.build(several(2, gap, "assembly.ring_eccentricity=0.01", f"assembly.ring_phase={degrees}"))
        for degrees in (40, 220)
    )
    te = whole_turns(first.pairs[0]).te
    assert te == pytest.approx(whole_turns(second.pairs[1]).te, abs=1e-12)
    pins, radius = np.arange(20) * np.pi / 10, pitch_radius(first.members["ring"].tooth, None)
    outwards = 10.0 * np.cos(pins - phase)
    # index deviations are arcs of the pitch circle
    arcs = -10.0 * np.sin(pins - phase) * radius / Drive(first.design).curve.circle
    assert np.ptp(te) > 5e-4
    # out of place alone, and half of it by a ring that is half as eccentric
    for eccentricity in (0.0, 0.005):
        share = 1.0 - eccentricity / 0.01
        lists = [f"measured.ring_pitch_{side}_um={(share * arcs).tolist()}" for side in Side]
        radial = f"measured.ring_radial_um={(share * outwards).tolist()}"
        ring = [f"assembly.ring_eccentricity={eccentricity}", "assembly.ring_phase=40"]
        placed = gm.build(several(2, gap, radial, *lists, *ring))
        assert te == pytest.approx(whole_turns(placed.pairs[0]).te, abs=0.003 * np.ptp(te))


@pytest.mark.sweep
def test_pins_set_outwards_are_where_they_touch_under_small_load() -> None:
    away = np.round(np.random.default_rng(3).normal(0.0, 5.0, 20), 2).tolist()
    gears = gm.build(design("modification.equidistant=0.03", f"measured.ring_radial_um={away}"))
    turns, places = whole_turns(gears.pairs[0]), [0, 6, 14, 34]
    loaded = gears.loaded_contact([1e-3], np.degrees(turns.phi1[places]), level="quick").to_dict()
    # 1 mNm turns the ring by a few thousandths of an arc second
    assert loaded["te_arcsec"] == pytest.approx((np.degrees(turns.te[places]) * 3600.0).tolist(), abs=0.01)


@pytest.mark.sweep
def test_torque_on_the_ring_is_that_of_virtual_work() -> None:
    """At a small torque T2 / T1 is d phi1 / d phi2 without load; all normals pass near the pitch point with many pins.

    The pin that leads is half a turn away: neither load nor the place of the members had found it.
    """
    gears = gm.build(design("modification.equidistant=0.05", "modification.offset=0.05"))
    degrees = [2.0, 6.0, 9.0, 14.0]
    around = np.radians(degrees)[:, None] + 1e-4 * np.array([-1.0, 1.0])
    turned, phi2 = (values.reshape(around.shape) for values in leading_turns(gears.pairs[0], around.ravel()))
    ratios = np.diff(turned, axis=1)[:, 0] / np.diff(phi2, axis=1)[:, 0]
    (total,) = gears.loaded_contact([1e-3], degrees, level="quick").totals
    assert total.gear_torque_ripple == pytest.approx(100.0 * np.ptp(ratios) / ratios.mean(), rel=0.02)
    assert total.gear_torque_ripple > 1e-4


def test_solids_of_pins_out_of_place_are_nominal() -> None:
    lists = [1.0] * 19 + [2.0], [float(k) for k in range(20)]
    gears = gm.build(design(f"measured.ring_radial_um={lists[0]}", f"measured.ring_pitch_right_um={lists[1]}"))
    nominal = gm.build(design())
    for made in (gears.solid("ring", 0.05), gears.section("ring", tolerance=0.05)):
        assert any("nominal places" in line for line in made.warnings)
    solids = [each.solid("ring", 0.05).mesh.vertices for each in (gears, nominal)]
    assert solids[0] == pytest.approx(solids[1], abs=1e-12)


def several(discs: int, *overrides: str) -> Any:
    """Discs on eccentrics that are evenly spaced, every pin in contact."""
    return design(f"discs={discs}", f"ring.face_width={14 * discs}", "disc_gap=1.5", *overrides)


@pytest.mark.parametrize(
    ("discs", "keys"),
    [
        (2, ("disc.teeth=19",)),
        (2, ("disc.teeth=20", "ring.teeth=21", "output.pins=5")),
        (3, ("disc.teeth=18", "output.pins=5", 'form="pins_in_disc"')),
    ],
)
@pytest.mark.sweep_cases("2-keys0", "3-keys2")
def test_output_holes_of_all_discs_are_in_line(discs: int, keys: tuple[str, ...]) -> None:
    """Seen from the output pins, whose axes are an eccentricity from those of the holes, at any rotation."""
    gears = gm.build(several(discs, "output.pin_diameter=6", *keys))
    places = gears.places_at(4.0)
    ring = places["ring"].translation
    assert ring == pytest.approx([-1.5, 0.0, 0.5 * (discs - 1) * 13.5])
    found = []
    for k, arm in enumerate(gears.design.arm_angles):
        name, holes = f"disc_{k + 1}", gears.members[f"disc_{k + 1}"].holes
        assert holes is not None
        axis = places[name].translation
        assert axis == pytest.approx([1.5 * np.cos(arm) - 1.5, 1.5 * np.sin(arm), 13.5 * k], abs=1e-12)
        centre = places[name].point(np.append(holes.centres[0], 0.0)) - axis
        found.append(np.arctan2(centre[1], centre[0]) / (2.0 * np.pi) * holes.count)
    apart = np.array(found) - found[0]
    assert apart == pytest.approx(np.round(apart), abs=1e-9)


@pytest.mark.sweep
def test_discs_and_ring_do_not_overlap() -> None:
    solids = gm.build(several(2, "modification.equidistant=0.03")).solids("10um")
    bodies = [solids.parts[name].to_manifold() for name in ("disc_1", "disc_2", "ring")]
    # both discs touch the ring, within both tolerances of the meshes
    for first, second in ((0, 1), (0, 2), (1, 2)):
        assert (bodies[first] ^ bodies[second]).volume() < 0.1
    # the ring turned back by four tolerances of the meshes is free, turned ahead it is not
    for turn, free in ((-0.08, True), (0.08, False)):
        axis = [-1.5, 0.0, 0.0]
        turned = bodies[2].translate([1.5, 0.0, 0.0]).rotate([0.0, 0.0, turn]).translate(axis)
        assert all(((turned ^ disc).volume() < 1e-3) == free for disc in bodies[:2])


def test_discs_share_the_torque_as_their_pins_do() -> None:
    """Half an odd number of pins apart, the shares differ; they are those of equal rotations."""
    own = PinCurve(50.0, 1.5, 21, 20)
    phi = np.linspace(0.0, 0.3, 5)
    shares = disc_shares(own, (0.0, np.pi), phi)
    assert shares.sum(axis=-1) == pytest.approx(1.0)
    assert np.ptp(shares) > 1e-3
    # under its share of the torque every disc turns alike: force over lever is that of the other disc
    rate = [
        share * 50.0 / (np.maximum(own.levers(phi[:, None] - arm + 2.0 * np.pi * np.arange(21) / 21), 0.0) ** 2).sum(-1)
        for share, arm in zip(shares.T, (0.0, np.pi), strict=True)
    ]
    assert rate[0] == pytest.approx(rate[1])
    assert disc_shares(PinCurve(50.0, 1.5, 20, 19), (0.0, np.pi), phi) == pytest.approx(0.5)


def two_discs(*overrides: str) -> Any:
    """Two discs of 20 lobes, half a turn and half a pitch of the lobes apart."""
    keys = "disc.teeth=20", "ring.teeth=21", "output.pins=5", "output.pin_diameter=6"
    return gm.build(several(2, *keys, *overrides))


def test_bodies_of_turned_discs_say_that_their_lobes_are_not_turned() -> None:
    gears = two_discs("assembly.disc_ahead=[0, 0.004]")
    made = gears.section("disc_2", tolerance=0.1).warnings, gears.solid("disc_2", 0.2).warnings
    for warnings in made:
        assert [line for line in warnings if "disc_2: its teeth are at their nominal places" in line]
    assert not gears.section("disc_1", tolerance=0.1).warnings


@pytest.mark.sweep
@pytest.mark.parametrize("ahead", [0.0, 0.004])
def test_contact_has_the_error_and_the_backlash_of_both_discs(ahead: float) -> None:
    """Against the first touch of both discs on either side, which contact under load begins with."""
    gears = two_discs("modification.equidistant=0.03", *([f"assembly.disc_ahead=[0, {ahead}]"] if ahead else []))
    contact = gears.contact()
    assert contact.cycle is not None
    touch = shared_touch(gears.train.sharing(0), contact.cycle.curve, contact.fit)
    assert touch is not None
    flat = contact.summary
    both = [gears.train, replace(gears.train, pairs=tuple(reversed_pair(pair) for pair in gears.pairs))]
    known = [advances_of_halves(train.sharing(0), touch.phi1) for train in both]
    assert touch.advances == pytest.approx(known[0], abs=1e-12)
    te, coast = (advances.max(axis=0) for advances in known)
    assert flat["set_te_peak_to_peak_arcsec"] == pytest.approx(np.degrees(np.ptp(te)) * 3600.0, rel=1e-9)
    # flanks of one number: up to the pitch of the ring
    between = np.degrees(-te - coast) % (360.0 / 21)
    assert [flat["set_backlash_min_deg"], flat["set_backlash_max_deg"]] == pytest.approx(
        [between.min(), between.max()], abs=1e-9
    )
    first = [flat[f"disc_{k}_first_percent"] for k in (1, 2)]
    # half a pitch apart they take turns; 0.004 deg ahead, 13.7 arcsec on the ring, the second is always first
    assert first == ([0.0, 100.0] if ahead else [50.0, 50.0])
    assert flat["set_te_peak_to_peak_arcsec"] < flat["mesh_te_peak_to_peak_arcsec"] * (1.0 if ahead else 0.5)
    # the disc ahead takes its lead from the backlash
    lost = flat["backlash_min_deg"] - flat["set_backlash_min_deg"]
    assert lost == pytest.approx(ahead * 20 / 21, abs=1e-3)


@pytest.mark.sweep
def test_contact_of_both_discs_has_all_pins_as_they_are() -> None:
    places = np.round(np.random.default_rng(3).normal(0.0, 5.0, 21), 2).tolist()
    gears = two_discs("modification.equidistant=0.03", f"measured.ring_pitch_left_um={places}")
    flat = gears.contact(phi1=[0.0], turns=True).summary
    phi1 = gears.pairs[0].pitch * np.arange(21 * 12) / 12
    # rotation of the second disc by hand: lobes half a pitch beside those of the first
    own = [phi1, phi1 + np.radians(9.0)]
    turns = np.array(
        [advances_of_halves(pair, at)[0] + at * 20 / 21 for pair, at in zip(gears.pairs, own, strict=True)]
    )
    te = turns.max(axis=0) - phi1 * 20 / 21
    assert flat["set_te_peak_to_peak_arcsec"] == pytest.approx(np.degrees(np.ptp(te)) * 3600.0, rel=1e-6)
    assert flat["disc_1_first_percent"] == pytest.approx(100.0 * np.mean(turns[0] > turns[1]), abs=1e-9)
    assert "set_backlash_min_deg" not in flat


@pytest.mark.quick
@pytest.mark.parametrize("member", ["disc", "ring"])
def test_stiffness_of_mounts_is_for_one_disc(member: str) -> None:
    stiffness = f"{member}.mount.stiffness=[1e6, 1e6, 1e6, 1e9, 1e9, 1e9]"
    with pytest.raises(gm.DesignError, match=rf"^{member}\.mount\.stiffness.*several discs share the torque"):
        several(2, stiffness)
    assert design(stiffness).mount(member).stiffness is not None


@pytest.mark.sweep
def test_the_disc_whose_pin_touches_first_carries_a_small_torque() -> None:
    places = np.round(np.random.default_rng(3).normal(0.0, 5.0, 21), 2).tolist()
    gears = two_discs("modification.equidistant=0.03", f"measured.ring_pitch_left_um={places}")
    degrees = np.array([2.0, 50.0, 100.0, 200.0, 300.0])
    # rotation of the second disc by hand: lobes half a pitch beside those of the first
    turns = [near_pairs(pair, np.radians(degrees + k * 9.0), 1e-3).phi2 for k, pair in enumerate(gears.pairs)]
    first = np.argmax(turns, axis=0)
    assert set(first.tolist()) == {0, 1}
    rows = gears.loaded_contact([1e-3], degrees, level="quick").rows
    shares = np.array([[mesh.share for mesh in row.meshes.values()] for row in rows])
    assert shares == pytest.approx(np.eye(2)[first], abs=1e-6)
    ring = np.degrees(np.max(turns, axis=0) - np.radians(degrees) * 20 / 21) * 3600.0
    assert [row.unloaded_te for row in rows] == pytest.approx(ring - ring[0], abs=1e-3)


@pytest.mark.sweep
def test_a_study_records_the_contact_of_all_discs() -> None:
    """Rows have the figures of a design with the errors of the row; the discs differ by half a pitch."""
    gears = two_discs("modification.equidistant=0.03")
    study = gears.study({"assembly.dx": [0.0, 0.02]}, record="cycle,fit", workers=1)
    wanted = two_discs("modification.equidistant=0.03", "assembly.dx=0.02").contact().summary
    for name in ("set_te_peak_to_peak_arcsec", "set_backlash_min_deg", "set_backlash_max_deg", "disc_2_first_percent"):
        assert study.numbers(name)[1] == pytest.approx(wanted[name], rel=1e-6, abs=1e-9)
    assert study.numbers("set_te_peak_to_peak_arcsec")[0] < study.numbers("mesh_te_peak_to_peak_arcsec")[0]


def test_a_study_moves_the_second_disc_as_its_design_does() -> None:
    errors = {"assembly.dx": 0.1, "assembly.dy": -0.2, "assembly.dz": 0.3}
    aligned, moved = two_discs(), two_discs(*(f"{key}={value}" for key, value in errors.items()))
    given = {key: np.array([value]) for key, value in errors.items()}
    found = displaced_bases(aligned.design, aligned.train, aligned.pairs[1], given)
    for base, mount in zip(found, moved.pairs[1].mounts, strict=True):
        assert base.translation[0] == pytest.approx(mount.base.translation, abs=1e-12)
        assert base.rotation[0] == pytest.approx(mount.base.rotation, abs=1e-12)


@pytest.mark.sweep
def test_a_disc_that_is_turned_carries_more_by_its_stiffness() -> None:
    """Both discs are springs of k each: turned by a, the shares are 1/2 -+ k a / (2 T)."""
    torque, turned = 50.0, 0.001
    (even,) = two_discs().loaded_contact([torque], [2.0], level="quick").rows
    (row,) = two_discs(f"assembly.disc_ahead=[0, {turned}]").loaded_contact([torque], [2.0], level="quick").rows
    moved = 0.5 * even.tangent_stiffness * 3600.0 * turned / (2.0 * torque)
    before, after = ([mesh.share for mesh in each.meshes.values()] for each in (even, row))
    assert moved > 0.05
    assert np.subtract(after, before) == pytest.approx([-moved, moved], rel=0.02)


@pytest.mark.sweep
def test_two_discs_lose_as_one_under_half_of_the_torque() -> None:
    one, both = (gm.build(given) for given in (design("ring.face_width=28"), several(2)))
    lost = [
        100.0 - gears.loaded_contact([torque], [3.0], level="quick").tribology(friction=0.05).totals[0].efficiency
        for gears, torque in ((one, 25.0), (both, 50.0))
    ]
    assert lost[1] == pytest.approx(lost[0], rel=0.01)


@pytest.mark.sweep
def test_discs_share_the_torque_as_rigid_discs_on_springs() -> None:
    """Pins out of place: pin i of stiffness c pushes with c (A_i - x) l_i, A_i the ring's rotation at which it touches."""
    places, gap, torque = np.round(np.random.default_rng(3).normal(0.0, 3.0, 20), 3), 0.01, 60.0
    gears = gm.build(several(2, f"modification.equidistant={gap}", f"measured.ring_pitch_left_um={places.tolist()}"))
    degrees = np.array([1.0, 9.0, 60.0, 100.0, 150.0])
    rows = gears.loaded_contact([torque], degrees, level="quick").rows
    shares = np.array([[mesh.share for mesh in row.meshes.values()] for row in rows])
    angles = 1e-3 * (places - places.mean()) / pitch_radius(gears.members["ring"].tooth, None)
    own, apart = Drive(gears.design).curve, []
    for first in range(20):
        found = []
        for phi1 in np.radians(degrees):
            pins = np.arange(20) + first + np.array([[0], [10]])
            levers = np.maximum(-own.levers((pins + 0.5) * np.pi / 10 - phi1 * 19 / 20), 1e-9)
            touching = angles - gap / levers

            def carried(x: float, touching: Array = touching, levers: Array = levers) -> Array:
                return np.asarray((3.4e5 * levers**2 * np.maximum(touching - x, 0.0)).sum(axis=1))

            rest = brentq(lambda x: float(carried(x).sum()) - 1e3 * torque * 20 / 19, -0.1, touching.max())
            found.append(carried(rest) / carried(rest).sum())
        apart.append(np.abs(np.array(found) - shares).max())
    # pins are up to a tenth softer where lobes are hollow
    assert np.ptp(shares) > 0.5
    assert min(apart) < 0.08
    assert sorted(apart)[1] > 0.15


def test_a_disc_that_fits_as_its_copy_is_told() -> None:
    """Half a lobe pitch is no whole number of hole pitches with 20 lobes and 5 holes; with 4 holes it is not either."""
    for teeth, pins, same in ((19, 6, "yes"), (20, 5, "no"), (10, 4, "yes"), (10, 2, "no")):
        gears = gm.build(several(2, f"disc.teeth={teeth}", f"ring.teeth={teeth + 1}", f"output.pins={pins}"))
        sheet = {table.title: table for table in gears.sheet().tables}["Discs"]
        (row,) = [row for row in sheet.rows if row[0] == "same part as the first disc"]
        assert row[-1] == same, (teeth, pins)


@pytest.mark.sweep
def test_output_pins_stand_in_the_holes_of_both_discs() -> None:
    """A pin that has half of the clearance on one side reaches every hole from inside, at any rotation."""
    gears = gm.build(several(2, "output.clearance=0.04", "assembly.dx=0.01"))
    solids = gears.solids("2um", phi1=7.0)
    assert [name for name in solids.parts if name.startswith("output")] == [f"output_pin_{k}" for k in range(1, 7)]
    pin = solids.parts["output_pin_1"]
    assert pin.figures["watertight"]
    assert pin.figures["max_deviation_um"] <= 2.0
    # from a quarter of a face width before the first disc to as much behind the second
    assert np.ptp(pin.mesh.vertices[:, 2]) == pytest.approx(12.0 + 13.5 + 6.0)
    middle = pin.mesh.vertices.mean(axis=0)
    places = gears.places_at(7.0)
    for name, arm in (("disc_1", 0.0), ("disc_2", np.pi)):
        holes = gears.members[name].holes
        assert holes is not None
        centres = places[name].point(np.column_stack((holes.centres, np.zeros(6))))
        apart = (centres - middle)[:, :2]
        nearest = apart[np.linalg.norm(apart, axis=1).argmin()]
        # with an error of the eccentricity the second disc is ahead of the first one by a few arc seconds
        assert nearest == pytest.approx(1.51 * np.array([np.cos(arm), np.sin(arm)]), abs=1e-4)
        assert holes.diameter == pytest.approx(8.0 + 2.0 * 1.5 + 0.04)


def test_output_pins_are_parts_of_the_assembly() -> None:
    cad = gm.build(design()).cad(None, 0.05)
    assert [name for name in cad.figures if name.startswith("output")] == [f"output_pin_{k}" for k in range(1, 7)]
    assert cad.figures["output_pin_1"]["volume_mm3"] == pytest.approx(np.pi * 16.0 * 18.0, rel=1e-12)


@pytest.mark.quick
def test_gears_at_rest_touch_with_the_pin_that_touches_first() -> None:
    """Tooth 0 is not the first to touch with an equidistant; solids that it places overlap by its gap."""
    gears = gm.build(design("modification.equidistant=0.03"))
    at_rest, beside = (gears.places_at(phi1)["ring"].rotation for phi1 in (0.0, 1e-6))
    assert at_rest == pytest.approx(beside, abs=1e-7)


@pytest.mark.sweep
def test_a_drive_has_the_ratio_of_its_eccentric() -> None:
    """The card had 1.05, the ratio of the teeth with the arm at rest. Reference: the disc rolls inside of the ring, by hand."""
    gears = gm.build(design("ring.teeth=20", "disc.teeth=18", "pin_diameter=6"))
    (ratio,) = [figure for figure in mesh_card(gears.contact(cycle=False)).figures if figure.label == "Gear ratio"]
    assert ratio.amount == pytest.approx(-18 / 2)
    assert ratio.note == "eccentric to disc, ring at rest; 10 to ring, disc not turning"
    # no test presses the members of an eccentric together
    test = gears.composite()
    assert test.double is None
    assert test.figures.double_flank_total is None
