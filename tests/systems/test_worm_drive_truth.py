"""Worm drives against second computations: sections of the five forms, the disk by brute force, uniform transmission."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

import gearmesh as gm
from gearmesh import DesignError, load
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Envelope, RackLine, RackRoll, RackSurface, Region, Side, Surface, Tooth
from gearmesh.systems import diagnosis
from gearmesh.systems.system import complete_design
from gearmesh.systems.worm_drive import build as worm_build
from gearmesh.systems.worm_drive.build import build, wheel_hob, worm_thread
from gearmesh.systems.worm_drive.thread import WormThread

FORMS = ("ZA", "ZN", "ZI", "ZK", "ZC")
OVERSIZED = "hob.reference_diameter=63"


def drive(*overrides: str) -> Any:
    return complete_design(load(SAMPLES / "worm_drive.toml", list(overrides)))


def heights(thread: WormThread) -> Array:
    """Parameters of the flank from below to above the reference cylinder."""
    return np.linspace(*(thread.at_radius(thread.radius + x * thread.module) for x in (-0.9, 1.0)), 15)


def off_line(x: Array, y: Array) -> tuple[float, float]:
    """Slope of the straight line through the ends of a plane curve and the largest distance from it."""
    slope = (y[-1] - y[0]) / (x[-1] - x[0])
    return slope, float(np.abs(y - y[0] - slope * (x - x[0])).max() / np.hypot(1.0, slope))


# ---------------------------------------------------------------- the worm


def test_za_is_straight_in_the_axial_section() -> None:
    thread = worm_thread(drive("worm.form=ZA"))
    x, z = np.moveaxis(thread.section.axial_section(heights(thread))[0], -1, 0)
    slope, off = off_line(x, z)
    assert slope == pytest.approx(-np.tan(np.radians(20.0)), abs=1e-12)
    assert off < 1e-12
    # and no other form is
    for form in ("ZN", "ZI", "ZK", "ZC"):
        other = worm_thread(drive(f"worm.form={form}"))
        assert off_line(*np.moveaxis(other.section.axial_section(heights(other))[0], -1, 0))[1] > 1e-3


@pytest.mark.parametrize(("section", "middle"), [("space", 0.5), ("thread", 0.0)])
def test_zn_is_straight_across_the_helix(section: str, middle: float) -> None:
    """In the plane through the middle of space or thread at the reference cylinder, both flanks beside it, found by bisection."""
    thread = worm_thread(drive("worm.form=ZN", f"worm.section={section}"))
    tangent = np.array([0.0, np.cos(thread.lead_angle), np.sin(thread.lead_angle)])
    centre = np.array([0.0, 0.0, middle * thread.axial_pitch])
    across = np.cross([1.0, 0.0, 0.0], tangent)
    both = []
    for side in (1, -1):
        flank = thread.flank(side)
        # the flank beyond the space is that of the following thread
        lift = centre * 2.0 if side < 0 else 0.0 * centre
        points = []
        for p in heights(thread):

            def off_plane(v: float, p: float = p, flank: Surface = flank, lift: Array = lift) -> float:
                return float((flank.jet(np.array(p), np.array(v)).r + lift - centre) @ tangent)

            v = brentq(off_plane, -0.5, 0.5, xtol=1e-15)
            points.append(flank.jet(np.array(p), np.array(v)).r + lift - centre)
        x, y = np.array(points)[:, 0], np.array(points) @ across
        slope, off = off_line(x, y)
        assert abs(slope) == pytest.approx(np.tan(np.radians(20.0)), abs=1e-12)
        assert off < 1e-12
        both.append(y[7])
    assert both[0] == pytest.approx(-both[1], abs=1e-12)


@pytest.mark.parametrize("hand", [1, -1])
def test_zi_is_a_helical_gear(hand: int) -> None:
    """The transverse section is that of a gear of z1 teeth, helix angle 90 deg - gamma, which a rack generates."""
    thread = worm_thread(drive("worm.form=ZI", f"worm.right_hand={'true' if hand > 0 else 'false'}"))
    normal = thread.module * np.cos(thread.lead_angle)
    rack = RackSurface(
        RackLine(thread.angle, 0.0, 0.25 * np.pi * normal), hand * (0.5 * np.pi - thread.lead_angle), 0.0
    )
    u, p = np.meshgrid(np.linspace(-3.0, 3.0, 7), np.linspace(-2.0, 2.0, 5))
    r = Envelope(rack, RackRoll(thread.radius)).jet(p, u).r
    rho = np.hypot(r[..., 0], r[..., 1])
    turned = np.arctan2(r[..., 1], r[..., 0]) - r[..., 2] / (hand * thread.screw)
    own = np.array([thread.at_radius(float(radius)) for radius in rho.ravel()]).reshape(rho.shape)
    point = thread.flank(1).jet(own, np.zeros_like(own)).r
    angle = np.arctan2(point[..., 1], point[..., 0]) - point[..., 2] / (hand * thread.screw)
    miss = np.remainder(turned - angle + np.pi, 2.0 * np.pi) - np.pi
    assert np.abs(rho * miss).max() < 1e-12 * thread.radius


def disk_section(thread: WormThread, width: Callable[[float, float], float], radii: Array, half: float) -> Array:
    """z (mm) of the axial section that a disk leaves, the least over all points of the disk in all places of its screw motion.

    `width` (b, x): half the disk's width at the height x over the reference cylinder, b that at x = 0.
    """
    assert thread.grinding is not None
    disk, gamma, screw = thread.grinding, thread.lead_angle, thread.screw
    distance, middle = thread.radius - disk.depth + disk.disk_radius, 0.5 * thread.axial_pitch

    def point(b: float, x: float, delta: float) -> tuple[float, float]:
        """Radius and section height of the disk's point at the angle delta, towards the thread below."""
        over, aside = distance - thread.radius - x, -width(b, x)
        back, forth = distance - over * np.cos(delta), -over * np.sin(delta)
        y = forth * np.cos(gamma) - aside * np.sin(gamma)
        z = middle + forth * np.sin(gamma) + aside * np.cos(gamma)
        return float(np.hypot(back, y)), float(z - screw * np.arctan2(y, back))

    def least(b: float, rho: float) -> float:
        def height(delta: float) -> float:
            x = brentq(lambda x: point(b, x, delta)[0] - rho, -disk.depth - 2.0, 12.0, xtol=1e-14)
            return point(b, x, delta)[1]

        coarse = np.linspace(-0.06, 0.06, 13)
        k = int(np.argmin([height(float(delta)) for delta in coarse]))
        assert 0 < k < len(coarse) - 1
        return float(minimize_scalar(height, bracket=tuple(coarse[k - 1 : k + 2]), options={"xtol": 1e-9}).fun)

    b = brentq(lambda b: least(b, thread.radius) - half, 0.5 * half, 2.0 * half, xtol=1e-10)
    return np.array([least(b, float(rho)) for rho in radii])


@pytest.mark.parametrize("form", ["ZK", "ZC"])
@pytest.mark.sweep_cases("ZC")
def test_ground_flanks_are_what_the_disk_leaves(form: str) -> None:
    thread = worm_thread(drive(f"worm.form={form}", "worm.disk_diameter=150"))
    assert thread.grinding is not None
    alpha, rho = thread.angle, thread.grinding.profile_radius

    def straight(b: float, x: float) -> float:
        return float(b + x * np.tan(alpha))

    def arc(b: float, x: float) -> float:
        return float(b - rho * np.cos(alpha) + np.sqrt(rho**2 - (x - rho * np.sin(alpha)) ** 2))

    p = heights(thread)[::7]
    x, z = np.moveaxis(thread.section.axial_section(p)[0], -1, 0)
    brute = disk_section(thread, straight if form == "ZK" else arc, x, thread.half_thickness(thread.radius))
    np.testing.assert_allclose(z, brute, rtol=0, atol=1e-6)


# ---------------------------------------------------------------- the wheel


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.sweep_cases("ZC")
def test_jets_of_threads_and_wheels(form: str) -> None:
    """Derivatives by differences, and normals across both."""
    design = drive(f"worm.form={form}", OVERSIZED, "worm.right_hand=false")
    hob, thread = wheel_hob(design), worm_thread(design)
    surfaces: list[tuple[Surface, Array]] = [(thread.flank(side), heights(thread)) for side in (1, -1)]
    surfaces += [(hob.flank(side, 25.0), heights(hob.thread)[3:]) for side in (1, -1)]
    for surface, p in surfaces:
        p, v = np.meshgrid(p, np.linspace(-4.0, 4.0, 5))
        jet, step = surface.jet(p, v), 1e-5
        by_p, by_v = (
            [(getattr(ahead, name) - getattr(back, name)) / (2.0 * step) for name in ("r", "n")]
            for ahead, back in (
                (surface.jet(p + step, v), surface.jet(p - step, v)),
                (surface.jet(p, v + step), surface.jet(p, v - step)),
            )
        )
        for exact, difference in zip((jet.r_u, jet.n_u, jet.r_v, jet.n_v), (*by_p, *by_v), strict=True):
            size = 1.0 + np.abs(exact).max()
            np.testing.assert_allclose(difference, exact, rtol=0, atol=2e-7 * size)
        assert np.abs((jet.n * jet.r_u).sum(axis=-1)).max() < 1e-9 * np.abs(jet.r_u).max()
        assert np.abs((jet.n * jet.r_v).sum(axis=-1)).max() < 1e-9 * np.abs(jet.r_v).max()


@pytest.mark.parametrize(
    "changes",
    [
        ["worm.form=ZK"],
        [OVERSIZED],
        ["worm.form=ZA", "worm.right_hand=false", "shaft_angle=80", OVERSIZED],
        ["worm.dual_lead=0.02"],
        ["worm.form=ZN", "hob.threads=3", "hob.reference_diameter=90"],
        ["hob.threads=1"],
    ],
    ids=str,
)
@pytest.mark.sweep_cases(
    "['hob.threads=1']",
    "['worm.dual_lead=0.02']",
    "['worm.form=ZA', 'worm.right_hand=false', 'shaft_angle=80', 'hob.reference_diameter=63']",
    "['worm.form=ZN', 'hob.threads=3', 'hob.reference_diameter=90']",
)
def test_the_hob_touches_every_point_of_the_wheel_and_cuts_into_none(changes: list[str]) -> None:
    """Brute force: distance of the wheel's points from the hob in every position of the roll, by the axial section of its
    thread alone."""
    design = drive(*changes)
    wheel = build(design).pairs[0].gear.tooth
    shares = np.linspace(0.05, 0.95, 6)
    for side in Side:
        hob = wheel_hob(design, side.sign * (1 if design.worm.right_hand else -1))
        thread, place = hob.thread, hob.place(side.sign)
        radii = np.linspace(0.55 * thread.radius, hob.form_radius, 200)
        p = np.array([thread.at_radius(float(radius)) for radius in radii])
        section = CubicSpline(radii, thread.section.axial_section(p)[0][:, 1])
        points = wheel.flank_grid(side, shares, shares).points.reshape(-1, 3)

        def outside(phi: Array, hob: Any = hob, place: Any = place, section: Any = section, side: Side = side) -> Array:
            """Axial distance of the points from the thread's flank, beyond the hob's form radius none."""
            over = hob.roll.at(phi).tool_to_blank.inverse.point(points)  # noqa: B023
            r = place.inverse.point(over)
            rho, screw = np.hypot(r[..., 0], r[..., 1]), hob.thread.hand * hob.thread.screw
            away = side.sign * (r[..., 2] - screw * np.arctan2(r[..., 1], r[..., 0])) - section(rho)
            return np.where((rho <= hob.form_radius + 1e-9) & (rho >= section.x[0]), away, np.inf)

        step = 1e-3
        coarse = np.linspace(-0.4, 0.4, 801)
        at = coarse[np.argmin([outside(np.full(len(points), phi)) for phi in coarse], axis=0)]
        for _ in range(3):
            before, here, after = (outside(at + k * step) for k in (-1.0, 0.0, 1.0))
            at = at + 0.5 * step * (before - after) / (before - 2.0 * here + after)
            step *= 0.1
        np.testing.assert_allclose(outside(at), 0.0, rtol=0, atol=1e-7)


def angles_left_by_sweep(design: Any, side: Side, points: Array) -> tuple[Array, float]:
    """Angles (N,) up to which the whole thread, its tip rounding too, removes material at the points' radii and stations, and the
    sense in which it does.

    A point at a radius and a station is seen at every angle from the hob; where the thread's flank passes it there says to which
    angle of the wheel that belongs. The greatest of them bounds the tooth, whichever sheet of the envelope it is on.
    """
    hob = wheel_hob(design, side.sign * (1 if design.worm.right_hand else -1))
    back, screw, roll = hob.place(side.sign).inverse, hob.thread.hand * hob.thread.screw, hob.roll
    radii = np.linspace(0.45 * hob.thread.radius, hob.form_radius, 300)
    half = np.array([hob.thread.half_thickness(float(radius)) for radius in radii])
    section = CubicSpline(radii[np.isfinite(half)], half[np.isfinite(half)])
    centre, radius = hob.tip_radius - hob.rounding_radius, hob.rounding_radius
    level = float(section(hob.form_radius)) - np.sqrt(radius**2 - (hob.form_radius - centre) ** 2)
    rho, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    sense = float(side.sign * back.vector(np.array([0.0, roll.radius, roll.advance]))[2])

    def angle(psi: Array) -> Array:
        """Angle of the wheel for points at the angle psi before the hob, in the sense; -inf where the thread does not reach."""
        over = np.stack((rho * np.cos(psi) - roll.radius, rho * np.sin(psi), z), axis=-1)
        x, y, along = np.moveaxis(back.point(over), -1, 0)
        r = np.hypot(x, y)
        rounded = level + np.sqrt(np.maximum(radius**2 - (r - centre) ** 2, 0.0))
        thick = np.where(r <= hob.form_radius, section(np.minimum(r, hob.form_radius)), rounded)
        phi = side.sign * (side.sign * thick + screw * np.arctan2(y, x) - along) / sense
        inside = (r <= hob.tip_radius) & (r >= section.x[0])
        return np.where(inside, np.sign(sense) * (psi + phi), -np.inf)

    grid = np.linspace(-1.2, 1.2, 1201)
    swept = np.array([angle(np.full(len(rho), psi)) for psi in grid])
    at, best, step = grid[swept.argmax(axis=0)], swept.max(axis=0), grid[1] - grid[0]
    for _ in range(45):
        for way in (-step, step):
            tried = angle(at + way)
            at, best = np.where(tried > best, at + way, at), np.maximum(best, tried)
        step *= 0.6
    return best, float(np.sign(sense))


@pytest.mark.sweep
@pytest.mark.sweep_cases("ZN-5-6.5-24--0.5", "ZI-4-8-30--0.3", "ZC-3-10-18-0.0")
@pytest.mark.parametrize(
    ("form", "threads", "quotient", "teeth", "shift"),
    # undercut, undercut in loops, a single thread on few teeth
    [("ZN", 5, 6.5, 24, -0.5), ("ZI", 4, 8, 30, -0.3), ("ZA", 1, 8, 20, -0.4), ("ZC", 3, 10, 18, 0.0)],
)
def test_teeth_are_what_no_position_of_the_hob_removes(
    form: str, threads: int, quotient: float, teeth: int, shift: float
) -> None:
    """Flanks and fillets are on the right sheet of the envelope: first cut, on the side of the material."""
    worm = {"form": form, "threads": threads, "quotient": quotient}
    keys = {"kind": "worm_drive", "module": 4, "worm": worm, "wheel": {"teeth": teeth, "profile_shift": shift}}
    design = complete_design(gm.parse(keys))
    tooth = build(design).pairs[0].gear.tooth
    sections = tooth.sections(np.linspace(0.0, 1.0, 7))
    for side, regions in zip(
        Side, ((Region.FLANK_RIGHT, Region.FILLET_RIGHT), (Region.FLANK_LEFT, Region.FILLET_LEFT)), strict=True
    ):
        for region in regions:
            points = tooth.grid(region, np.linspace(0.02, 0.98, 9), sections).points.reshape(-1, 3)
            swept, sense = angles_left_by_sweep(design, side, points)
            off = (swept - sense * np.arctan2(points[:, 1], points[:, 0])) * np.hypot(points[:, 0], points[:, 1])
            np.testing.assert_allclose(off, 0.0, rtol=0, atol=1e-6)


# ---------------------------------------------------------------- transmission

PHI1 = np.radians([0.0, -150.0, -60.0, 40.0, 120.0])


def path(*overrides: str) -> ContactPath:
    return contact_path(solver_pair(pair_of(drive(*overrides))), PHI1)


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.sweep_cases("right")
def test_oversized_zi_is_uniform_under_errors_and_both_hands_are_mirror_images(side: str) -> None:
    """Under errors of all four kinds at once; in the mirror the worm is displaced the other way."""
    errors = (OVERSIZED, "assembly.da=0.05", "assembly.dz2=0.2", "assembly.d_sigma=0.05", f"contact.flank={side}")
    right = path(*errors, "assembly.dz1=0.1")
    left = path(*errors, "assembly.dz1=-0.1", "worm.right_hand=false")
    for one in (right, left):
        assert one.touching.all()
        assert np.abs(one.te).max() < 1e-9
    mirror = np.array([1.0, 1.0, -1.0])
    np.testing.assert_allclose(left.point, right.point * mirror, rtol=0, atol=1e-12 * 125.0)
    np.testing.assert_allclose(left.phi2, right.phi2, rtol=0, atol=1e-12)


@pytest.mark.parametrize("form", ["ZA", "ZN", "ZI", "ZK"])
@pytest.mark.sweep_cases("ZA", "ZK", "ZN")
def test_a_hob_like_the_worm_makes_no_transmission_error(form: str) -> None:
    for hand in ("true", "false"):
        one = path(f"worm.form={form}", f"worm.right_hand={hand}")
        assert one.touching.all()
        assert np.abs(one.te).max() < 1e-9
        assert (one.kind == "line").all()


# ---------------------------------------------------------------- what cannot be


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (["hob.reference_diameter=58"], "hob.reference_diameter = 58 mm: smaller than the worm's, .* at least 60 mm"),
        (["worm.form=ZK", "worm.disk_diameter=20"], "worm.disk_diameter = 20 mm: .* more than 22 mm"),
        (
            ["hob.threads=16"],
            "hob.threads = 16: allowed is at most 10, .*: a hob of the reference .* 60 mm has no lead angle with more than 12$",
        ),
        (["wheel.throat_radius=23"], "wheel.throat_radius = 23 mm: the throat is inside the worm's root; .* 24 mm"),
        (["worm.lead_angle=9"], "worm.reference_diameter = 60 mm: cannot be given together with lead_angle"),
        (
            ["wheel.outside_diameter=190"],
            "wheel.outside_diameter = 190 mm: allowed is at least 195.1 mm, .* the throat, at 200 mm, and .* 250 mm$",
        ),
        (
            ["wheel.face_width=100"],
            r"wheel.face_width = 100 mm: allowed is at most 48.7\d mm, with the other keys unchanged: a hob of the tip "
            "diameter 72 mm does not reach over so wide a face$",
        ),
        (["worm.dual_lead=0.3"], "worm.dual_lead = 0.3: must be a number from -0.2 to 0.2"),
        (["hob.addendum=4"], "hob.addendum = 4: must be a multiple of the axial module from 0 to 3"),
    ],
)
@pytest.mark.sweep_cases("changes2-message2", "changes5-message5", "changes6-message6")
def test_what_cannot_be_is_refused_in_one_line(changes: list[str], message: str) -> None:
    with pytest.raises(DesignError, match=f"^{message}"):
        gm.build(drive(*changes))


def test_a_wheel_that_is_undercut_above_its_tip_is_proved_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """A lower tip leaves still less of the flank: ten more addenda were tried twice each, 0.8 s in the place of 0.1."""
    proofs: list[float] = []
    prove = worm_build.prove_wheel

    def count(tooth: Tooth) -> None:
        proofs.append(float(tooth.blank.tip.at(0.0)))
        prove(tooth)

    monkeypatch.setattr(worm_build, "prove_wheel", count)
    monkeypatch.setattr(diagnosis, "MAX_EFFORT", 0.0)
    with pytest.raises(DesignError, match="no flank is left between the form point") as refused:
        gm.build(load(SAMPLES / "worm_drive.toml", ["wheel.face_width=50.5"]))
    assert len(proofs) == 1
    # the form point is above the tip by a figure with which the bound is looked for
    assert refused.value.excess is not None
    assert refused.value.excess > 0.0
