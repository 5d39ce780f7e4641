"""Undercut and pointing [LF04 17.9]: closed forms, second routes, and what the command prints."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.command_line import messages, refused, run
from oracles.places import SAMPLES
from oracles.stretched import stretched
from scipy.optimize import brentq

import gearmesh as gm
from gearmesh import Member, load
from gearmesh.kernel.envelope.limiting_line import limiting_line, singular_at, zeros
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kinds import Envelope, Parabola, RackLine, RackRoll, RackSurface
from gearmesh.systems.face_gear.build import shaped_gear
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank
from gearmesh.teeth.limits import fewest_teeth, member_limits, pitch_height, pointed_station, undercut_station
from gearmesh.tools.worm import Worm

ALPHA = np.radians(20.0)
LINE = RackLine(ALPHA, 1.0, 0.25 * np.pi)


@cache
def member(sample: str, name: str = "pinion", *settings: str) -> Member:
    return pair_of(load(SAMPLES / f"{sample}.toml", list(settings))).members[name]


def rack_flank(radius: float, helix: float, profile: RackLine | Parabola = LINE) -> Envelope:
    return Envelope(RackSurface(profile, helix, 0.0), RackRoll(radius))


def figure() -> Any:
    """The sample of [LF04] Fig. 17.9.2."""
    spec = importlib.util.spec_from_file_location("fig17_9_2_limits", SAMPLES / "fig17_9_2_limits.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


# ---------------------------------------------------------------- the limiting line


@pytest.mark.quick
@pytest.mark.parametrize("helix", [0.0, 0.3, -0.6])
@pytest.mark.parametrize("teeth", [8, 20, 55])
def test_a_straight_rack_makes_singular_points_on_the_base_circle(teeth: int, helix: float) -> None:
    radius, transverse = 0.5 * teeth / np.cos(helix), np.arctan(np.tan(ALPHA) / np.cos(helix))
    line = limiting_line(
        rack_flank(radius, helix), (LINE.at_height(1.0), LINE.at_height(-8.0)), np.linspace(-9.0, 9.0, 7)
    )
    assert line.p.shape == (7,)
    assert LINE.section(line.p)[0][:, 0] == pytest.approx(-radius * np.sin(transverse) ** 2, abs=1e-11)
    # the distance from the base circle is of second order in p
    assert np.hypot(*line.on_surface[:, :2].T) == pytest.approx(radius * np.cos(transverse), abs=1e-13 * radius)
    assert line.on_tool[:, 0] == pytest.approx(LINE.section(line.p)[0][:, 0], abs=1e-13)


@pytest.mark.quick
def test_a_sound_range_has_no_limiting_line() -> None:
    line = limiting_line(rack_flank(10.0, 0.2), (LINE.at_height(1.0), LINE.at_height(-1.0)), np.zeros(3))
    assert line.p.shape == line.v.shape == (0,)
    assert line.on_tool.shape == line.on_surface.shape == (0, 3)


@pytest.mark.quick
def test_the_velocity_of_contact_vanishes_on_the_limiting_line() -> None:
    """(17.9.1) with (17.9.2), whose derivatives are differences along the motion, on a spiral bevel pinion."""
    flank = member("spiral_bevel_basic").tooth.left.flank
    assert isinstance(flank, Envelope)
    side = member("spiral_bevel_basic").tooth.left
    line = limiting_line(
        flank, (side.tip, side.tip - 4.0 * (side.tip - side.form_point[0])), np.array([-0.05, 0.0, 0.05])
    )
    assert line.p.size == 3

    def meshing(p: Array, v: Array, phi: Array) -> Array:
        tool, state = flank.tool.jet(p, v), flank.motion.at(phi)
        return dot(tool.n, np.cross(state.omega, tool.r) + state.tau)

    def rate(p: Array, v: Array) -> Array:
        """df/dt along u' and v' that make v_r + v_12 = 0, over the largest term of it."""
        phi = flank.parameter(p, v)
        tool, state = flank.tool.jet(p, v), flank.motion.at(phi)
        w = np.cross(state.omega, tool.r) + state.tau
        basis = np.stack((tool.r_u, tool.r_v), axis=-1)
        du, dv = np.moveaxis(np.linalg.pinv(basis) @ -w[..., None], -2, 0)[..., 0]
        assert np.abs(tool.r_u * du[:, None] + tool.r_v * dv[:, None] + w).max() < 1e-11
        h = 1e-6
        terms = [
            du * (meshing(p + h, v, phi) - meshing(p - h, v, phi)),
            dv * (meshing(p, v + h, phi) - meshing(p, v - h, phi)),
            meshing(p, v, phi + h) - meshing(p, v, phi - h),
        ]
        return np.abs(sum(terms)) / np.abs(terms).max(axis=0)

    assert rate(line.p, line.v).max() < 1e-7
    assert rate(line.p + 0.1, line.v).min() > 1e-3


def by_differences(surface: Any, p: Array, v: Array, h: float = 1e-4) -> Array:
    """Area element (K,) from points alone."""
    across = surface.jet(p + h, v).r - surface.jet(p - h, v).r
    along = surface.jet(p, v + h).r - surface.jet(p, v - h).r
    return np.linalg.norm(np.cross(across, along), axis=-1) / (4.0 * h * h)


@pytest.mark.quick
@pytest.mark.parametrize("plunge", [0.0, 2e-4])
def test_worms_and_racks_have_their_limits_in_common(plunge: float) -> None:
    worm = Worm(radius=98.0, threads=1, teeth=17, module=5.08, helix=0.35)
    line = RackLine(np.radians(25.0), 5.08, 0.25 * np.pi * 5.08)
    rack = RackSurface(Parabola(line, 0.016739, line.at_height(0.0)), 0.35, 0.0)
    span, feeds = (line.at_height(2.0), line.at_height(-5.0)), np.linspace(-30.0, 30.0, 4)
    by_rack = limiting_line(Envelope(rack, RackRoll(worm.gear_radius)), span, np.zeros(1), 17)
    ground = worm.tooth(rack, plunge)
    found = limiting_line(ground, span, feeds, 17)
    assert found.v.tolist() == feeds.tolist()
    assert by_differences(ground, found.p, found.v).max() < 1e-4 * by_differences(ground, found.p + 1.0, found.v).min()
    if plunge == 0.0:
        assert found.p == pytest.approx(by_rack.p[0], abs=1e-9)
    else:
        # the plunge takes the limit with it; least where the thread touches at s = 0
        assert np.abs(found.p - by_rack.p[0]).min() < 0.05
        assert np.abs(found.p - by_rack.p[0]).max() > 0.1


@pytest.mark.quick
@pytest.mark.parametrize("teeth", [10, 17, 40])
def test_h1_of_the_figure_obeys_euler_and_savary(teeth: int) -> None:
    """In the transverse plane, from the pitch point along the normal: 1/l = 1/(r sin a) + 1/l_rack.

    l and l_rack lead to the centres of curvature; that of a singular point is the point of contact itself.
    """
    sample = figure()
    bend = -2.0 * sample.PARABOLA * np.array([np.sin(sample.ALPHA), -np.cos(sample.ALPHA) / np.cos(sample.BETA)])
    profile = Parabola(sample.LINE, sample.PARABOLA, sample.LINE.at_height(0.0))

    def residual(p: float) -> float:
        point, tangent, _, _ = profile.section(np.array(p))
        x, y = tangent * np.array([1.0, 1.0 / np.cos(sample.BETA)])
        rack_radius, angle = np.hypot(x, y) ** 3 / (x * bend[1] - y * bend[0]), np.arctan2(y, x)
        contact = -point[0] / np.sin(angle)
        return float(1.0 / contact - 1.0 / (sample.pitch_radius(teeth) * np.sin(angle)) - 1.0 / (contact + rack_radius))

    root = brentq(residual, sample.LINE.at_height(-7.0), sample.LINE.at_height(-0.2), xtol=1e-14)
    assert -profile.section(np.array(root))[0][0] == pytest.approx(sample.h1(teeth), abs=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("teeth", [10, 23, 40])
def test_the_figure_with_a_straight_rack_is_the_involute(teeth: int) -> None:
    sample = figure()
    assert (sample.h1(teeth, 0.0), sample.h2(teeth, 0.0)) == pytest.approx(sample.involute(teeth), abs=1e-11)


@pytest.mark.quick
def test_zeros_are_not_poles_and_hide_at_no_edge() -> None:
    def tangent(x: Array, row: Any) -> Array:
        return np.tan(x) * (1.0 + row)

    row, x = zeros(tangent, np.array([0.5, 8.0]), np.array([8.0, 0.5]), 40)
    assert row.tolist() == [0, 0, 1, 1]
    assert x == pytest.approx(np.pi * np.array([1, 2, 2, 1]), abs=1e-12)
    # defined from 0.31 on, with the zero between there and the next sample
    _, x = zeros(lambda x, row: np.sqrt(x - 0.31) - 0.05, np.array([0.0]), np.array([1.0]), 6)
    assert x.tolist() == pytest.approx([0.3125], abs=1e-12)
    # a value of exactly 0: of a sample, and of the first point tried between two
    for samples in (3, 4):
        _, x = zeros(lambda x, row: x - 0.5, np.array([0.0]), np.array([1.0]), samples)
        assert x.tolist() == [0.5]


# ---------------------------------------------------------------- members


@pytest.mark.quick
def test_undercut_begins_where_the_trimmed_tooth_says() -> None:
    """The limiting line over the form point, against bisection for the sign of the area on the trimmed tooth."""
    part = member("beveloid_crossed", "pinion", "pinion.teeth=19")
    tooth, limits = part.tooth, member_limits(part)
    ends = [undercut_station(tooth, side) for side in (tooth.right, tooth.left)]
    inside = sorted(z for z in ends if tooth.blank.extent[0] < z < tooth.blank.extent[1])
    assert tooth.stations(tooth.breaks) == pytest.approx(inside, abs=1e-9)
    for side in limits.sides.values():
        assert side.undercut.tolist() == (side.form_point_depth > side.h1).tolist()
        assert ((side.lost > 0.0) == side.undercut).all()
        assert (side.flank_radius > side.singular_radius).all()


@pytest.mark.sweep
@pytest.mark.sweep_cases("worm_plunge")
@pytest.mark.parametrize("crowning", ["worm_plunge", "disk"])
def test_a_crowned_pinion_has_its_racks_limits_within_the_crowning(crowning: str) -> None:
    by_rack, ground = (
        member_limits(member("modified_involute", "pinion", f"pinion.crowning={name}"), count=2)
        for name in ("none", crowning)
    )
    assert ground.fewest_teeth == by_rack.fewest_teeth is not None
    for name, side in ground.sides.items():
        assert side.h1 == pytest.approx(by_rack.sides[name].h1, abs=0.06)
        assert side.h2 == pytest.approx(by_rack.sides[name].h2, abs=0.06)
        assert (side.h1 != by_rack.sides[name].h1).all()


def test_the_fewest_teeth_are_just_not_undercut() -> None:
    tooth = member("spur").tooth
    fewest = fewest_teeth(tooth)
    assert fewest is not None
    # rounding of the rack's tip and profile shift included
    depth = float(member_limits(member("spur")).right.form_point_depth[0])
    assert fewest == np.ceil(2.0 * depth / (3.0 * np.sin(ALPHA) ** 2))
    for teeth, undercut in ((fewest - 1, True), (fewest, False)):
        found = member_limits(
            member("spur", "pinion", f"pinion.teeth={teeth}", f"assembly.center_distance={1.5 * (teeth + 40)}")
        )
        assert found.right.undercut.all() == found.left.undercut.all() == undercut


@pytest.mark.parametrize("sample", ["spur", "helical", "beveloid_crossed", "spiral_bevel_basic"])
@pytest.mark.parametrize("land", [0.3, 1.0])
@pytest.mark.sweep_cases(
    "0.3-beveloid_crossed", "0.3-spiral_bevel_basic", "0.3-spur", "1.0-beveloid_crossed", "1.0-helical", "1.0-spur"
)
def test_a_tip_raised_to_the_limit_has_the_land_asked_for(sample: str, land: float) -> None:
    part = member(sample)
    limits = member_limits(part, land, count=3)
    tooth = replace(part.tooth, tip_edge=None)
    for k, t in enumerate((0.0, 0.5, 1.0)):
        tip = replace(tooth.blank.tip, offset=tooth.blank.tip.offset + limits.rise[k])
        raised = replace(tooth, blank=replace(tooth.blank, tip=tip)).sections(t)
        assert limits.land_radius[k] * (raised.left.tip_angle - raised.right.tip_angle)[0] == pytest.approx(
            land, abs=1e-9
        )


@pytest.mark.quick
def test_pointing_along_the_face() -> None:
    tooth = member("beveloid_crossed").tooth
    at = pointed_station(tooth, 1.5)
    longer = stretched(tooth, tooth.blank.extent[0], at)
    sections = longer.sections(1.0)
    tip = tooth.blank.tip
    radius = tip.radius + tip.slope * at
    assert radius * (sections.left.tip_angle - sections.right.tip_angle)[0] == pytest.approx(1.5, abs=1e-9)
    assert np.isnan(pointed_station(member("helical").tooth))


@pytest.mark.quick
def test_bevel_pitch_plane_is_a_dedendum_over_the_tip_plane() -> None:
    design = load(SAMPLES / "spiral_bevel_basic.toml")
    blank, gears = basic_blank(design.in_mm()), pair_of(design)
    for name, part in gears.members.items():
        found = pitch_height(part.tooth, part.tooth.left, np.array([blank.gear.mean_cone_distance]))
        assert found == pytest.approx(
            getattr(blank, name).mean_dedendum * _cosine(part, getattr(blank, name)), rel=1e-6
        )


def _cosine(part: Member, own: Any) -> float:
    """Cosine of the dedendum angle: the tip plane leans by it against the pitch cone's generatrix."""
    return float(np.cos(own.pitch_angle - own.root_angle))


@pytest.mark.quick
def test_bevel_limits_go_on_smoothly_from_toe_to_heel() -> None:
    """Singular points at stations are the limiting line: found again at their own v."""
    tooth = member("zerol").tooth
    side, stations = tooth.left, tooth.stations(np.linspace(0.0, 1.0, 9))
    p = singular_at(side.flank, (side.tip, side.form_point[0] - 3.0), stations, tooth.blank.axial)
    assert np.isfinite(p).all()
    assert np.abs(np.diff(p, 3)).max() < 0.1 * np.abs(np.diff(p)).max()
    found = member_limits(member("zerol"), count=9).left
    again = limiting_line(side.flank, (side.tip, side.form_point[0] - 3.0), found.v)  # type: ignore[arg-type]
    assert again.p == pytest.approx(p, abs=1e-9)
    assert again.on_surface == pytest.approx(found.on_tooth, abs=1e-8)


@pytest.mark.quick
@pytest.mark.parametrize("sample", ["face_gear", "face_gear_conjugate"])
def test_radii_of_a_face_gear_by_two_routes(sample: str) -> None:
    """Limiting line and land of the generated surface, against the closed forms of shaper and instantaneous axis."""
    design: Any = load(SAMPLES / f"{sample}.toml").in_mm()
    tooth, shaped = pair_of(design).gear.tooth, shaped_gear(design)
    height = design.gear.addendum * design.given_module
    for side in (tooth.right, tooth.left):
        assert undercut_station(tooth, side) == pytest.approx(shaped.undercut_radius(), abs=1e-7)
    for land in (0.0, 0.4):
        assert pointed_station(tooth, land) == pytest.approx(shaped.pointing_radius(height, land), abs=1e-7)
    assert fewest_teeth(tooth) is None


# ---------------------------------------------------------------- the command


@pytest.mark.sweep
def test_the_command_tells_what_is_undercut(tmp_path: Path) -> None:
    file = tmp_path / "limits.json"
    status, out, err = run("limits", SAMPLES / "spur.toml", "--set", "pinion.teeth=10", "--json", file)
    assert status == 0
    assert "Undercut of the pinion" in out
    assert "Pointing of the gear" in out
    assert "form point depth mm" in out
    assert err.count("of the pinion is undercut from -15 to 15 mm (z)") == 2
    document = json.loads(file.read_text())
    pinion, gear = document["members"]["pinion"], document["members"]["gear"]
    assert (pinion["undercut"], pinion["fewest_teeth"], gear["undercut"]) == (True, 12, False)
    assert pinion["h1_mm"] == pytest.approx(15.0 * np.sin(ALPHA) ** 2, abs=1e-9)
    right = pinion["sides"]["right"]
    assert right["undercut"] == [True] * 5
    assert right["undercut_from_mm"] is None
    assert np.shape(right["limiting_line"]["on_tool_mm"]) == np.shape(right["limiting_line"]["on_tooth_mm"]) == (5, 3)
    assert [2.0 * np.hypot(x, y) for x, y, _ in right["limiting_line"]["on_tooth_mm"]] == pytest.approx(
        right["singular_diameter_mm"]
    )
    assert pinion["largest_tip_diameter_mm"][0] > pinion["tip_diameter_mm"][0]


def test_the_command_and_a_narrowest_land() -> None:
    lowest = []
    for land in ("0", "0.3"):
        status, out, err = run("limits", SAMPLES / "helical.toml", "--land", land, "--json", "-")
        assert (status, messages(err)) == (0, "")
        document = json.loads(out)
        assert document["least_top_land_mm"] == pytest.approx(5.0 * float(land))
        lowest.append(document["members"]["pinion"]["h2_mm"])
    assert lowest[1] < lowest[0]


@pytest.mark.sweep
def test_the_command_refuses() -> None:
    assert (
        refused("limits", SAMPLES / "spur.toml", "--land", "9") == "--land = 9: must be a number of modules from 0 to 3"
    )
    assert "--land = -0.1: must be" in refused("limits", SAMPLES / "spur.toml", "--land=-0.1")
    assert "--land = nan" in refused("limits", SAMPLES / "spur.toml", "--land", "nan")
    assert "does not exist" in refused("limits", SAMPLES / "spur.toml", "--json", "/nowhere/x.json")
    # beyond the limits they are what is asked for
    status, _, said = run("limits", SAMPLES / "spur.toml", "--set", "pinion.addendum=1.9")
    assert status == 0
    assert "pointed" in said
    assert "the limits shown are for the design without pinion.addendum" in said


@pytest.mark.quick
def test_limits_of_a_rack_and_its_pinion_are_columns_of_one_table() -> None:
    """A rack has heights where a gear has diameters: what a member has not is None."""
    found = gm.build(gm.load(SAMPLES / "rack.toml")).limits().to_dict()
    assert len({len(column) for column in found.values()}) == 1
    diameters = dict(zip(found["member"], found["flank_from_diameter_mm"], strict=True))
    assert diameters["rack"] is None
    assert diameters["pinion"] > 0.0
