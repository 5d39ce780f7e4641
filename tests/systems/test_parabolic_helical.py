"""Novikov-Wildhaber and modified involute helical gears [LF04 17], against a rack that is itself plunged, closed forms, mirrors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from oracles.built import contact_of, pair_of
from oracles.examples import some
from oracles.places import SAMPLES

from gearmesh import DesignError, GearPair, load, parse
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, cross, dot, unit
from gearmesh.kernel.surface.meridian import Meridian
from gearmesh.kinds import Envelope, FeedEnvelope, Jet, PlacedSurface, RackSurface, Side
from gearmesh.tools.disk import Disk
from gearmesh.tools.worm import Worm

KINDS = ("novikov", "modified_involute")


@cache
def gears(kind: str, *settings: str) -> GearPair:
    return pair_of(load(SAMPLES / f"{kind}.toml", settings))


def over_a_pitch(pair: GearPair, count: int = 11) -> ContactPath:
    return analyse(pair, np.linspace(-0.5, 0.5, count) * pair.pitch)


# ---- the transmission error of Table 17.8.1


@dataclass(frozen=True)
class PlungedRack:
    """A rack cutter whose teeth are bent into parabolas along the blank's axis: the rack stands a_pl z^2 deeper at z."""

    rack: RackSurface
    plunge: float

    def _normal(self, u: Array, v: Array) -> tuple[Array, Array, Jet]:
        jet = self.rack.jet(u, v)
        z, deeper = jet.r[..., 2:], np.array([-2.0 * self.plunge, 0.0, 0.0])
        r_u, r_v = (d + deeper * z * d[..., 2:] for d in (jet.r_u, jet.r_v))
        n = unit(cross(r_u, r_v))
        return n * np.sign(dot(n, jet.n))[..., None], np.stack((r_u, r_v)), jet

    def jet(self, u: Array, v: Array) -> Jet:
        n, (r_u, r_v), jet = self._normal(u, v)
        h = 1e-4
        n_u = (self._normal(u + h, v)[0] - self._normal(u - h, v)[0]) / (2.0 * h)
        n_v = (self._normal(u, v + h)[0] - self._normal(u, v - h)[0]) / (2.0 * h)
        r = jet.r - np.array([self.plunge, 0.0, 0.0]) * jet.r[..., 2:] ** 2
        return Jet(r, n, r_u, r_v, n_u, n_v)


@cache
def rack_plunged(kind: str) -> ContactPath:
    """Contact of the pair whose pinion a plunged rack generates, in one enveloping: the second route."""
    pair = gears(kind, "pinion.crowning=none")
    flanks = solver_pair(pair)
    flank = flanks.pinion.surface
    assert isinstance(flank, Envelope)
    assert isinstance(flank.tool, RackSurface)
    plunge = load(SAMPLES / f"{kind}.toml").pinion.plunge_coefficient
    surface = Envelope(PlungedRack(flank.tool, plunge), flank.motion)
    phi1 = np.linspace(-0.5, 0.5, 11) * pair.pitch
    return contact_path(replace(flanks, pinion=replace(flanks.pinion, surface=surface)), phi1)


@pytest.mark.sweep_cases("novikov")
@pytest.mark.parametrize("kind", KINDS)
def test_parabola_of_eight_arc_seconds(kind: str) -> None:
    """[LF04] Table 17.8.1: 8 arcsec at the change of teeth, which for Novikov gears differ on the two sides."""
    path = over_a_pitch(gears(kind))
    assert (path.kind == "point").all()
    assert path.residual.max() < 1e-11
    assert path.te.max() == pytest.approx(0.0, abs=1e-3 * ARCSEC)
    assert -path.te[[0, -1]].mean() / ARCSEC == pytest.approx(8.0, abs=0.7)
    # both members are counted from where the pitch point touches
    assert path.phi2[5] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(path.point[5], (0.5 * 17 * 5.08 / np.cos(np.radians(20.0)), 0.0, 0.0), rtol=0, atol=1e-9)
    # the path runs along the tooth
    assert np.ptp(path.point1[:, 2]) > 7.0 * np.ptp(np.hypot(path.point1[:, 0], path.point1[:, 1]))


def test_worm_plunges_as_the_rack_does_on_modified_involute_gears() -> None:
    worm, rack = over_a_pitch(gears("modified_involute")), rack_plunged("modified_involute")
    assert np.abs(worm.te - rack.te).max() < 0.02 * ARCSEC
    np.testing.assert_allclose(-worm.te[[0, -1]] / ARCSEC, 8.1, rtol=0, atol=0.3)


@pytest.mark.sweep
def test_worm_touches_novikov_gears_off_its_feed_position() -> None:
    """Off the pitch cylinder the worm touches at z while it stands at s, nearer to the middle. The worm plunges by a_pl s^2,
    the rack by a_pl z^2. That explains the difference of their transmission errors."""
    pair = gears("novikov")
    worm, rack = over_a_pitch(pair), rack_plunged("novikov")
    np.testing.assert_allclose(-rack.te[[0, -1]] / ARCSEC, (6.64, 9.17), rtol=0, atol=0.02)
    s, z = worm.params1[:, 1], worm.point1[:, 2]
    assert (np.abs(s) <= np.abs(z) + 1e-9).all()
    flank = pair.pinion.tooth.right.flank
    assert isinstance(flank, FeedEnvelope)
    assert isinstance(flank.tool, Envelope)
    assert isinstance(flank.tool.tool, PlacedSurface)
    steepness = flank.tool.tool.surface.jet(worm.params1[:, 0], np.zeros(11)).n[:, 0]
    gear = pair.gear.mount
    arm = np.abs(dot(worm.normal, cross(gear.axis, worm.point - gear.origin)))
    less = 5e-5 * (z**2 - s**2) * steepness / arm
    off = worm.te - rack.te
    assert 0.5 * ARCSEC < off[0] < off[-1] < 0.6 * ARCSEC
    np.testing.assert_allclose(off, less, rtol=0, atol=0.1 * off.max())


@pytest.mark.parametrize("kind", KINDS)
def test_without_crowning_along_the_teeth_the_pair_is_conjugate(kind: str) -> None:
    """Both racks touch along a line that every section shares [LF04 17.5]: no transmission error, contact in a point."""
    path = over_a_pitch(gears(kind, "pinion.crowning=none"), 5)
    assert (path.kind == "point").all()
    assert np.abs(path.te).max() < 1e-6 * ARCSEC


@pytest.mark.sweep
@pytest.mark.parametrize(("kind", "near"), [("modified_involute", 0.1), ("novikov", 0.7)])
def test_plunge_and_modified_roll_give_almost_the_same_contact(kind: str, near: float) -> None:
    """[LF04 17.8]. A turn works by the cosine of the pressure angle, a plunge by its sine, which changes on Novikov paths."""
    plunged, rolled = over_a_pitch(gears(kind)), over_a_pitch(gears(kind, "pinion.crowning=worm_roll"))
    assert np.abs(rolled.te - plunged.te).max() < near * ARCSEC
    np.testing.assert_allclose(rolled.point1, plunged.point1, rtol=0, atol=0.6)
    # the coast side, turned the other way, is crowned as well: there too the gear lags, towards larger phi2
    coast = over_a_pitch(gears(kind, "pinion.crowning=worm_roll", "contact.flank=left"), 5)
    assert coast.te.min() > -1e-3 * ARCSEC
    assert coast.te[[0, -1]].min() > 5.5 * ARCSEC


@pytest.mark.sweep
@pytest.mark.sweep_cases("disk")
@pytest.mark.parametrize("crowning", ["worm_plunge", "disk"])
def test_tools_without_plunge_leave_what_the_rack_does_whatever_the_lead(crowning: str) -> None:
    errors = ("assembly.d_lambda1=0.05", "assembly.d_gamma=0.02")
    ground = over_a_pitch(gears("novikov", *errors, f"pinion.crowning={crowning}", "pinion.plunge_coefficient=0"), 5)
    rack = over_a_pitch(gears("novikov", *errors, "pinion.crowning=none"), 5)
    np.testing.assert_allclose(ground.te, rack.te, rtol=0, atol=1e-6 * ARCSEC)
    np.testing.assert_allclose(ground.point1, rack.point1, rtol=0, atol=1e-6)


@pytest.mark.sweep
@pytest.mark.sweep_cases("novikov-0.67-0.35")
@pytest.mark.parametrize(("kind", "share", "near"), [("modified_involute", None, 0.25), ("novikov", 0.67, 0.35)])
def test_disk_crowns_the_driving_flank_as_the_worm_does(kind: str, share: float | None, near: float) -> None:
    """[LF04 17.8]. The disk stands in the middle of the space, half a space beside the flank on the pitch cylinder: it sinks
    into the flank by the sine of alpha_t and that angle instead of sin(alpha_t), on Novikov paths by more still. It touches
    beside its middle plane, on the other side of it for the other flank, so that only one has its crown at mid face."""
    alpha_t = np.arctan(np.tan(np.radians(25.0)) / np.cos(np.radians(20.0)))
    share = share or np.sin(alpha_t) / np.sin(alpha_t + np.pi / 17 * 0.7 / 1.7)
    coefficient = share * load(SAMPLES / f"{kind}.toml").pinion.plunge_coefficient
    settings = ("pinion.crowning=disk", f"pinion.plunge_coefficient={coefficient}")
    plunged, disk = over_a_pitch(gears(kind)), over_a_pitch(gears(kind, *settings))
    assert np.abs(disk.te - plunged.te).max() < near * ARCSEC
    coast = over_a_pitch(gears(kind, *settings, "contact.flank=left"), 3)
    assert coast.te[0] / coast.te[-1] > 2.5
    centred = over_a_pitch(gears(kind, *settings, "contact.flank=left", "disk.vertex=-2.8"), 3)
    assert centred.te[0] / centred.te[-1] < 1.6


# ---- errors of alignment


@pytest.mark.sweep
def test_the_axes_stand_apart_by_the_error() -> None:
    aligned, apart = gears("novikov"), gears("novikov", "assembly.dE=0.07")
    assert apart.gear.mount.origin[0] - aligned.gear.mount.origin[0] == pytest.approx(0.07, abs=1e-12)
    # [LF04] Fig. 17.8.2 (a): the path shifts
    assert over_a_pitch(apart).point1[5, 2] == pytest.approx(3.31, abs=0.01)


@pytest.mark.sweep
@pytest.mark.sweep_cases("novikov")
@pytest.mark.parametrize("kind", KINDS)
def test_lead_correction_restores_the_path(kind: str) -> None:
    """[LF04] Fig. 17.8.2: errors of shaft angle and lead shift the path alike, d_gamma + d_lambda1 = 0 brings it back."""
    aligned = over_a_pitch(gears(kind))
    shifted, by_lead, restored = (
        over_a_pitch(gears(kind, *(f"assembly.{name}={value}" for name, value in errors.items())))
        for errors in ({"d_gamma": 0.05}, {"d_lambda1": 0.05}, {"d_gamma": 0.05, "d_lambda1": -0.05})
    )
    assert shifted.point1[5, 2] > 1.4
    np.testing.assert_allclose(by_lead.point1, shifted.point1, rtol=0, atol=0.05)
    np.testing.assert_allclose(restored.point1, aligned.point1, rtol=0, atol=0.06)


@pytest.mark.sweep
def test_both_leads_changed_alike_cancel() -> None:
    """A lead angle that grows on both members is another pair of opposite helices: the path stays."""
    aligned = over_a_pitch(gears("novikov"))
    both = over_a_pitch(gears("novikov", "assembly.d_lambda1=0.05", "assembly.d_lambda2=0.05"))
    np.testing.assert_allclose(both.point1, aligned.point1, rtol=0, atol=0.05)


@pytest.mark.sweep
@pytest.mark.sweep_cases("d_gamma")
@pytest.mark.parametrize("error", some(["d_gamma", "d_lambda1", "d_lambda2", "dE"], 2))
def test_a_left_hand_pinion_is_the_mirror_image(error: str) -> None:
    """In a transverse plane: z turns round, the transmission error stays, whatever the error."""
    settings = (f"assembly.{error}=0.03", "worm.right_hand=false", "helix_angle=-20")
    left, right = over_a_pitch(gears("novikov", *settings), 5), over_a_pitch(gears("novikov", settings[0]), 5)
    np.testing.assert_allclose(left.te, right.te, rtol=0, atol=1e-6 * ARCSEC)
    np.testing.assert_allclose(left.point1 * [1.0, 1.0, -1.0], right.point1, rtol=0, atol=1e-7)


@pytest.mark.sweep
def test_the_coast_side_is_the_other_one_with_its_own_angle() -> None:
    """The left flank of a pair with angles (18, 25) does what the right one does with (25, 18), in an axial mirror."""
    swapped = ("pressure_angle=18", "coast_pressure_angle=25", "contact.flank=left", "helix_angle=-20")
    coast = over_a_pitch(gears("novikov", *swapped, "worm.right_hand=false"), 5)
    drive = over_a_pitch(gears("novikov", "coast_pressure_angle=18"), 5)
    # turning the other way, a lag has the other sign
    np.testing.assert_allclose(coast.te[::-1], -drive.te, rtol=0, atol=1e-6 * ARCSEC)
    np.testing.assert_allclose(coast.point1[::-1] * [1.0, -1.0, 1.0], drive.point1, rtol=0, atol=1e-7)


@pytest.mark.sweep
def test_breaks_are_where_surface_contact_ends() -> None:
    """[LF04 17.8]: errors too large for the parabola. At the phi1 named the surface contact of one pair ends ahead of the next."""
    pair = gears("novikov", "assembly.d_gamma=0.09")
    flanks, pitch = solver_pair(pair), pair.pitch
    result = contact_of(load(SAMPLES / "novikov.toml", ["assembly.d_gamma=0.09"]))
    assert result.cycle is not None
    (broken,) = result.cycle.breaks
    outwards = -1.0 if broken.beginning else 1.0
    near = broken.phi1 + outwards * pitch * np.array([-2e-3, 2e-3])
    np.testing.assert_array_equal(contact_path(flanks, near, edges=False).touching, [True, False])
    own, other = contact_path(flanks, np.array([broken.phi1, broken.phi1 - outwards * pitch]), edges=False).te
    assert flanks.drive * (own - other) == pytest.approx(broken.jump, abs=1e-3 * ARCSEC)
    assert broken.jump > 0.1 * ARCSEC
    assert result.summary["te_breaks_phi1_deg"] == [pytest.approx(np.degrees(broken.phi1))]
    assert any(f"jumps: at phi1 = {np.degrees(broken.phi1):.5g} deg" in line for line in result.warnings)
    assert mesh_cycle(solver_pair(gears("novikov")), pitch).breaks == ()  # type: ignore[union-attr]


@pytest.mark.sweep
def test_a_gap_between_the_pairs_is_a_break_as_well() -> None:
    result = contact_of(load(SAMPLES / "novikov.toml", ["assembly.d_gamma=0.11"]))
    assert result.cycle is not None
    (broken,) = result.cycle.breaks
    assert result.cycle.contact_ratio < 1.0
    assert np.isnan(broken.jump)
    assert any(
        "the surface contact of a tooth pair ends before that of the next pair begins" in line
        for line in result.warnings
    )


# ---- teeth


@pytest.mark.quick
def test_teeth_share_the_pitch_by_the_rack_parameter() -> None:
    """b = tooth over space of the pinion's cutter, so space over tooth of the pinion, on the pitch cylinder; each of the
    pair's four flanks gives way by a quarter of the normal backlash."""
    b, pitch = 0.7, np.pi * 5.08 / np.cos(np.radians(20.0))
    for kind, backlash in zip(KINDS, (0.0, 0.4), strict=True):
        pair = gears(kind, "pinion.crowning=none", f"backlash={backlash}")
        less = 0.5 * backlash / np.cos(np.radians(25.0)) / np.cos(np.radians(20.0))
        nominal = 0.5 * 5.08 * (17 + 77) / np.cos(np.radians(20.0))
        assert pair.gear.mount.origin[0] == pytest.approx(nominal, rel=1e-14)
        for member, share in ((pair.pinion, 1.0 / (1.0 + b)), (pair.gear, b / (1.0 + b))):
            tooth = member.tooth
            radius = 0.5 * tooth.teeth * 5.08 / np.cos(np.radians(20.0))
            grid = tooth.flank_grid(Side.RIGHT, np.linspace(0.0, 1.0, 400), [0.5]).points[:, 0]
            half = -np.interp(radius, np.hypot(grid[:, 0], grid[:, 1]), np.arctan2(grid[:, 1], grid[:, 0])) * radius
            assert 2.0 * half == pytest.approx(share * pitch - less, abs=2e-4)


@pytest.mark.parametrize(("kind", "sign"), [("novikov", -1.0), ("modified_involute", 1.0)])
@pytest.mark.sweep_cases("novikov--1.0")
def test_the_gear_s_parabola_takes_off_or_leaves_more(kind: str, sign: float) -> None:
    """Distance of the gear's flank from the involute flank is a_t d^2, d from the pitch plane along the rack's profile.
    Depending on the kind, the flank is concave or convex."""
    a_t, (straight, bent) = 0.004, (gears(kind, f"gear.parabola={a}").gear.tooth.right.flank for a in (1e-12, 0.004))
    for d in (-5.0, 3.0):
        p = np.array(5.08 / np.cos(np.radians(25.0)) + d)
        jet = straight.jet(p, np.array(0.0))
        flat = bent.jet(*np.meshgrid(p + np.linspace(-0.2, 0.2, 81), np.linspace(-2.0, 2.0, 81)))
        # along the normal, at the sample that is nearest to it
        off = flat.r - jet.r
        across = np.linalg.norm(off - dot(off, jet.n)[..., None] * jet.n, axis=-1)
        height = dot(off, jet.n).flat[int(across.argmin())]
        assert height == pytest.approx(-sign * a_t * d**2, rel=0.05)


@pytest.mark.sweep
def test_root_of_a_plunged_tooth_is_what_the_worm_s_crest_leaves() -> None:
    """The crest is a cylinder about the worm's axis: fed with a plunge it leaves a surface of revolution in closed form.

    Normal n = (1, n_y, 2 a s) / |..| with n . axis = 0 touches the blank where y = n_y x, the normal meeting its axis.
    """
    design = load(SAMPLES / "novikov.toml", ["pinion.plunge_coefficient=3e-4"])
    tooth = pair_of(design).pinion.tooth
    root, a, m = tooth.blank.root, 3e-4, 5.08
    assert isinstance(root, Meridian)
    pitch_radius, crest = 0.5 * 17 * m / np.cos(np.radians(20.0)), 98.0 + 0.85 * m
    crossing = np.radians(90.0) - abs(np.radians(20.0) - np.arcsin(0.5 * m / 98.0))
    s = np.linspace(-44.0, 44.0, 23)
    # of either sign of the axis' tilt the radii are the same at s and -s
    slope = 2.0 * a * s
    n_y = -slope / np.tan(crossing)
    length = np.sqrt(1.0 + n_y**2 + slope**2)
    x = pitch_radius + 98.0 - a * s**2 - crest / length
    along = (n_y * x + crest * n_y / length) / np.sin(crossing)
    z = s + along * np.cos(crossing) - crest * slope / length
    inside = np.abs(z) < 45.0
    np.testing.assert_allclose(root.at(z[inside]), (x * np.hypot(1.0, n_y))[inside], rtol=0, atol=1e-9)
    grid = tooth.grid("root", [0.0, 0.5, 1.0], tooth.sections(np.linspace(0.0, 1.0, 5)))
    fillet = tooth.grid("fillet_right", [0.0], tooth.sections(np.linspace(0.0, 1.0, 5)))
    np.testing.assert_allclose(grid.points[-1], fillet.points[0], rtol=0, atol=1e-9)


def test_barrel_jet_and_level() -> None:
    barrel = Meridian.through(lambda z: 30.0 + 0.1 * z - 5e-4 * z**2 + 1e-6 * z**3 + np.sin(0.5 * z), (-9.0, 9.0))
    u, v, h = np.array([0.3, 1.0]), np.array([5.0, -7.0]), 1e-5
    jet = barrel.jet(u, v)
    for r_x, n_x, (du, dv) in ((jet.r_u, jet.n_u, (h, 0.0)), (jet.r_v, jet.n_v, (0.0, h))):
        ahead, behind = barrel.jet(u + du, v + dv), barrel.jet(u - du, v - dv)
        np.testing.assert_allclose((ahead.r - behind.r) / (2.0 * h), r_x, rtol=0, atol=1e-8)
        np.testing.assert_allclose((ahead.n - behind.n) / (2.0 * h), n_x, rtol=0, atol=1e-9)
    np.testing.assert_allclose(unit(barrel.gradient(jet.r)), jet.n, rtol=0, atol=1e-14)
    w = np.array([0.3, -0.7, 0.5])
    change = (barrel.gradient(jet.r + h * w) - barrel.gradient(jet.r - h * w)) / (2.0 * h)
    np.testing.assert_allclose(barrel.hessian(jet.r, np.broadcast_to(w, (2, 3))), change, rtol=0, atol=1e-8)
    with pytest.raises(ValueError, match="not smooth enough"):
        Meridian.through(lambda z: 30.0 + np.abs(z), (-1.0, 1.0))


# ---- designs


@pytest.mark.sweep
def test_inches_and_millimetres_are_the_same_pair() -> None:
    """Lengths, curvatures (1/length) and the modified roll (rad/length^2) are scaled."""
    design = load(SAMPLES / "novikov.toml", ["pinion.crowning=worm_roll"]).resolve()

    def inches(table: Mapping[str, Any]) -> dict[str, Any]:
        power = {"parabola": 1, "plunge_coefficient": 1, "roll_coefficient": 2} | dict.fromkeys(
            ("module", "face_width", "pitch_radius", "delta", "tolerance", "dE", "backlash"), -1
        )
        return {
            key: inches(value)
            if isinstance(value, Mapping)
            else value * 25.4 ** power.get(key, 0)
            if isinstance(value, float)
            else value
            for key, value in table.items()
        }

    other = over_a_pitch(pair_of(parse(inches(design) | {"units": "inch"})), 3)
    np.testing.assert_allclose(other.te, over_a_pitch(pair_of(parse(design)), 3).te, rtol=0, atol=1e-7 * ARCSEC)


@pytest.mark.parametrize(
    ("kind", "settings", "message"),
    [
        ("novikov", "gear.parabola=0.02", r"gear.parabola = 0.02 1/mm: must be smaller than pinion.parabola, 0.016739"),
        (
            "novikov",
            "backlash=30",
            r"backlash = 30 mm: allowed is at most 4.78\d? mm, .*: leaves no tooth of the pinion",
        ),
        pytest.param(
            "novikov",
            "worm.pitch_radius=2",
            r"worm.pitch_radius = 2 mm: .*must be more than threads m_n / 2, 2.54 mm",
            marks=pytest.mark.sweep,
        ),
        pytest.param(
            "novikov",
            "rack_parameter=0.2",
            r"pinion.dedendum = 0.85: the cutter's tooth is pointed; allowed is a smaller",
            marks=pytest.mark.sweep,
        ),
        (
            "novikov",
            "pinion.tool_tip_radius=0.6",
            r"pinion.tool_tip_radius = 0.6: .* too narrow for the fillet; allowed is at most 0.4486",
        ),
        ("modified_involute", "pinion.crowning=lapping", r'pinion.crowning = "lapping": must be one of "worm_plunge"'),
        pytest.param(
            "modified_involute",
            "pinion.parabola=0.5",
            r"pinion.parabola = 0.5 1.mm: allowed is at most 0.0956.* 1.mm, .*: the profile bends back before the tip or the root",
            marks=pytest.mark.sweep,
        ),
        (
            "novikov",
            "pinion.plunge_coefficient=-0.003",
            r"pinion.plunge_coefficient = -0.003 1/mm: .* allowed is at most 0.00250864 1/mm either way",
        ),
        (
            "novikov",
            "pinion.roll_coefficient=6e-5",
            r"pinion.roll_coefficient = 6e-05 rad/mm\^2: moves .* allowed is at most 5.45936e-05 rad/mm\^2 either way",
        ),
        ("modified_involute", "assembly.dq=1", r"assembly.dq: unknown key"),
    ],
)
@pytest.mark.sweep_cases(
    "novikov-backlash=30-backlash = 30 mm: allowed is at most 4.78\\\\d? mm, .*: leaves no tooth of the pinion",
    "novikov-pinion.tool_tip_radius=0.6-pinion.tool_tip_radius = 0.6: .* too narrow for the fillet; allowed is at most 0.4486",
)
def test_refusals(kind: str, settings: str, message: str) -> None:
    with pytest.raises(DesignError, match=message):
        gears(kind, settings)


def test_default_rounding_is_nine_tenths_of_the_room() -> None:
    straight = ("pinion.parabola=1e-9", "gear.parabola=0", "pinion.dedendum=1.25")
    default = load(SAMPLES / "modified_involute.toml", straight).pinion.tool_tip_radius
    with pytest.raises(DesignError, match=r"allowed is at most 0\.") as refused:
        gears("modified_involute", *straight, "pinion.tool_tip_radius=1")
    assert default == pytest.approx(0.9 * float(str(refused.value).rsplit(" ", 1)[1]), rel=1e-3)


def test_preparing_a_ground_flank_changes_nothing() -> None:
    """Inside and outside its region; and where the solution jumps the envelope is left as it is."""
    flank = gears("novikov").pinion.tooth.right.flank
    assert isinstance(flank, FeedEnvelope)
    assert isinstance(flank.tool, Envelope)
    assert isinstance(flank.tool.tool, PlacedSurface)
    rack = flank.tool.tool.surface
    assert isinstance(rack, RackSurface)
    plain = Worm(98.0, 1, 17, 5.08, rack.helix).tooth(rack, 5e-5)
    u, s = np.meshgrid(np.linspace(2.5, 12.5, 7), np.linspace(-70.0, 70.0, 9), indexing="ij")
    mine, other = flank.jet(u, s), plain.jet(u, s)
    for name in ("r", "n", "r_u", "r_v", "n_u", "n_v"):
        np.testing.assert_allclose(getattr(mine, name), getattr(other, name), rtol=0, atol=2e-9)
    far = plain.jet(u + 12.0, s).r
    np.testing.assert_allclose(flank.jet(u + 12.0, s).r, far, rtol=0, atol=2e-9)
    assert np.isfinite(far).all()
    near = flank.start(u[:, 3:6], s[:, 3:6])[0] - plain.generation(u[:, 3:6], s[:, 3:6]).v
    assert np.abs(near[:6]).max() < 1e-6
    # where the line of action has run to infinity the disk has no flank to follow
    disk = Disk(98.0, 17, 5.08, rack.helix).tooth(rack, 5e-5)
    assert disk.prepare((-9.0, 12.9), (-54.0, 54.0)) is disk
