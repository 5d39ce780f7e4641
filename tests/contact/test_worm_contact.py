"""Contact of worm drives: lines that bend over the throated wheel and have pieces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

from gearmesh import load
from gearmesh.contact.conditions.bent_lines import line_over_face, pieces
from gearmesh.contact.conditions.lines import trace
from gearmesh.contact.conditions.meshing import Bound, Conditions, Flank
from gearmesh.contact.engagement.curve import MeshCurve
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.first_touch.field import advances
from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.first_touch.search import circle_contacts
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Jet
from gearmesh.teeth.generation.tool_in_place import generation

CORPUS = SAMPLES.parent / "tests" / "corpus"
#: radii of the wheel's throat and the worm's tip about the worm's axis, mm
THROAT, TIP = 25.0, 35.0


@pytest.mark.sweep
def test_contact_lines_of_an_identical_hob_end_at_edges_of_both_members() -> None:
    """Against the wheel's generation: along a line of contact the hob's roll, which the solver does not know, is one."""
    gears = pair_of(load(SAMPLES / "worm_drive.toml"))
    pair = solver_pair(gears).parts[0]
    phi1 = np.radians([-185.0, -135.0, -60.0, 15.0, 140.0])
    x = touches(pair, phi1)[0].x
    plain = Conditions(pair.flanks, phi1, pair.length)
    own = pieces(pair, plain, x, 13)
    # over the throat a line has two pieces
    assert own.line.tolist() == [0, 0, 1, 2, 3, 4]
    touch = plain.touch(own.x.reshape(-1, 5), np.repeat(own.line, 13))
    one, two = touch.fixed
    assert np.abs(one.r - two.r).max() < 1e-12
    flank = generation(gears.gear.tooth.side(gears.flanks[1]), "contact_lines")[0]
    roll = flank.progress(own.x[..., 2], own.x[..., 3])[0]
    assert np.ptp(roll, axis=1).max() < 1e-11
    # the ends, and nothing between, are on the throat, the end faces or the worm's tip
    margins = np.array([flank.margin(at, r) for flank, at, r in _sides(pair.flanks, own.x, touch.own)]).max(axis=0)
    margins = margins.reshape(-1, 13)
    assert np.abs(margins[:, [0, -1]]).max() < 1e-10
    assert margins[:, 1:-1].max() < -1e-3


def _sides(flanks: tuple[Flank, Flank], x: Array, jets: tuple[Jet, Jet]) -> list[tuple[Flank, Array, Array]]:
    return [
        (flank, x.reshape(-1, 5)[:, 2 * member : 2 * member + 2], jet.r)
        for member, (flank, jet) in enumerate(zip(flanks, jets, strict=True))
    ]


def test_path_of_line_contact_is_the_middle_of_the_longest_piece() -> None:
    gears = pair_of(load(SAMPLES / "worm_drive.toml"))
    path = contact_path(solver_pair(gears), np.radians(np.linspace(-200.0, 170.0, 12)))
    assert (path.kind == "line").all()
    for line, point in zip(path.lines, path.point, strict=True):
        assert line is not None
        about_worm = np.hypot(line[:, 0], line[:, 1])
        assert np.nanmin(about_worm) > THROAT - 1e-9
        assert np.nanmax(about_worm) < TIP + 1e-9
        runs = line[None] if len(line) == 13 else np.stack((line[:13], line[14:]))
        lengths = np.linalg.norm(np.diff(runs, axis=1), axis=-1).sum(axis=1)
        assert np.linalg.norm(runs[lengths.argmax(), 6] - point) < 1e-9


@pytest.mark.sweep
def test_tip_line_corners_touch_if_no_point_around_is_ahead() -> None:
    """Contact in the corner where the throat passes into the outside cylinder. Second route: a lattice of points of the worm
    about the contact. No circle through one of these points meets the wheel ahead of the contact."""
    gears = pair_of(load(SAMPLES / "worm_drive.toml", ["hob.reference_diameter=66"]))
    pair = solver_pair(gears).parts[0]
    phi1 = np.array([-2.2, -1.83, -1.5]) * pair.pitch
    path = contact_path(pair, phi1)
    assert path.edge.tolist() == 3 * ["gear_tip"]
    corner = np.sqrt(THROAT**2 - (125.0 - 102.5) ** 2)
    assert np.abs(path.point2[:, 2] + corner).max() < 1e-9
    contacts = touches(pair, phi1)[0]
    steps = 5e-3 * np.linspace(-1.0, 1.0, 41)
    ways = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    near = np.repeat(contacts.x, len(ways), axis=0)
    near[:, :2] += np.tile(ways, (3, 1))
    conditions = Conditions(pair.flanks, phi1, pair.length)
    ahead = circle_contacts(pair, conditions, np.repeat(np.arange(3), len(ways)), near)[1].reshape(3, -1)
    # points that both flanks have lie on one side of the corner: none is ahead, and it is reached by them
    assert np.isfinite(ahead).sum(axis=1).min() > 200
    below = contacts.advance - ahead.max(axis=1)
    assert below.min() > -1e-12
    assert below.max() < 1e-5


@pytest.mark.parametrize("keys", [[], ["worm.form=ZA", "worm.threads=1"]], ids=["ZI", "ZA"])
@pytest.mark.sweep_cases("ZA")
def test_lines_end_where_no_point_of_them_is_left(keys: list[str]) -> None:
    """Second route: 401 stations of the wheel's face at rotations beside the ends, which lie between two nodes."""
    gears = pair_of(load(SAMPLES / "worm_drive.toml", keys))
    pair = solver_pair(gears).parts[0]
    engagement = whole_engagement(pair, gears.pitch)
    assert engagement is not None
    surface = MeshCurve(engagement, gears.pitch).surface
    last = np.flatnonzero(engagement.contacts.line)[[0, -1]]
    for k, end, beyond in zip(last, (surface.begin, surface.end), (-1.0, 1.0), strict=True):
        phi1 = end + 1e-3 * beyond * np.array([-1.0, 1.0])
        assert abs(end - engagement.phi1[k]) < gears.pitch / 12.0
        x = np.repeat(engagement.contacts.x[[k]], 2, axis=0)
        x[:, 4] += pair.ratio * (phi1 - engagement.phi1[k])
        plain = Conditions(pair.flanks, phi1, pair.length)
        states, there, _ = line_over_face(pair, plain, x, np.linspace(*pair.gear.extent, 401))
        touch = plain.repeat(np.repeat([0, 1], 401)).touch(states.reshape(-1, 5), np.arange(802))
        margin = np.max([flank.margin(at, r) for flank, at, r in _sides(pair.flanks, states, touch.own)], axis=0)
        inside, outside = np.where(there, margin.reshape(2, 401), np.inf).min(axis=1)
        # 1e-3 rad are 1 to 3 um of margin; stations are 0.1 mm apart
        assert -5e-3 < inside < -5e-4
        assert 5e-4 < outside < 5e-3


@pytest.mark.sweep
def test_first_touch_at_the_ends_of_a_line_is_on_it() -> None:
    """First touch, when the contact line has shrunk to one point inside the tip line, is at that point. Other points of the tip
    are 9e-8 rad behind. Second route: a wheel cut by an identical hob has no transmission error."""
    gears = pair_of(load(SAMPLES / "worm_drive_dual_lead.toml"))
    pair = solver_pair(gears).parts[0]
    engagement = whole_engagement(pair, gears.pitch)
    assert engagement is not None
    surface = MeshCurve(engagement, gears.pitch).surface
    contacts = touches(pair, np.array([surface.begin, surface.begin + 1e-6, surface.end - 1e-6, surface.end]))[0]
    assert contacts.line.all()
    assert np.abs(contacts.advance).max() < 1e-12


def test_first_touch_where_a_line_nearly_leaves_over_one_edge_twice() -> None:
    """An identical hob, worm and wheel displaced: the worm's tip touches at one side of the face or at the other. No exact point of
    its tip line is ahead."""
    pair = solver_pair(pair_of(load(SAMPLES / "worm_drive.toml"))).parts[0]
    shifts = ((-0.0258, 0.0079, 0.0086), (0.0139, -0.0152, 0.0284))
    worm, wheel = (
        flank.remount(replace(flank.mount, base=replace(base, translation=base.translation + shift)))
        for flank, shift in zip(pair.flanks, shifts, strict=True)
        if (base := flank.mount.base)
    )
    pair = replace(pair, pinion=worm, gear=wheel)
    phi1 = np.array([0.1, 0.2, 0.3]) * pair.pitch
    contacts = touches(pair, phi1)[0]
    assert contacts.touching.all()
    columns = np.linspace(0.0, 1.0, pair.pinion.grid.shape[1])
    tip = [np.interp(np.linspace(0.0, 1.0, 2001), columns, pair.pinion.grid[-1, :, k]) for k in (0, 1)]
    jet = pair.pinion.surface.jet(*tip)
    there = advances(pair, phi1, jet.r, jet.n, np.arange(3))
    position, k = np.nonzero(np.isfinite(there.advance))
    wheel = pair.gear.heights.parameters_at(there.rho[position, k], there.z[position, k])
    phi2 = pair.drive * there.advance[position, k] + pair.ratio * phi1[position]
    x = np.column_stack((tip[0][k], tip[1][k], wheel, phi2))
    ahead = circle_contacts(pair, Conditions(pair.flanks, phi1, pair.length), position, x)[1]
    assert np.isfinite(ahead).sum() > 100
    assert (ahead - contacts.advance[position]).max() < 1e-9


def test_table_of_a_throated_wheel_is_near_its_flank() -> None:
    """Points half way between those that it is made of; its tip line has corners, over which it is smooth."""
    flank = solver_pair(pair_of(load(SAMPLES / "worm_drive.toml"))).gear
    between = 0.25 * (flank.grid[1:, 1:] + flank.grid[1:, :-1] + flank.grid[:-1, 1:] + flank.grid[:-1, :-1])
    r = flank.surface.jet(between[..., 0], between[..., 1]).r
    joint = flank.mount.joint
    away = joint.radius(r) * joint.within(flank.heights.at(joint.radius(r), r[..., 2]).theta - joint.angle(r))
    # mm: 0.031 at most and 0.0025 in the middle where its rows followed the tip
    assert np.abs(away).max() < 5e-3
    assert np.median(np.abs(away)) < 1e-4


def test_repeated_conditions_keep_what_bounds_each_position() -> None:
    """Places at stations of their own: asked together and some of them apart."""
    pair = solver_pair(pair_of(load(SAMPLES / "helical.toml"))).parts[0]
    phi1, stations = np.zeros(3), np.array([1.0, 2.0, 4.0])
    x = np.tile(touches(pair, phi1[:1])[0].x, (3, 1))
    plain = Conditions(pair.flanks, phi1, pair.length, (Bound(0, pair.pinion.axial, stations),))
    some = np.array([2, 0, 2])
    f = plain(x[some], some)[0]
    np.testing.assert_array_equal(plain.repeat(some)(x[some], np.arange(3))[0], f)
    assert np.ptp(f[:, 3:], axis=0).max() > 1.0


@pytest.mark.sweep_cases("face_worm_drive_10-keys0--1.2")
@pytest.mark.parametrize(
    ("name", "keys", "phi1"),
    [
        ("face_worm_drive_10", ["wheel.face_width=35.65931903616282", "wheel.addendum=1"], -1.2),
        ("tip_worm_drive_19", [], -1.8),
    ],
)
def test_lines_do_not_depend_on_which_of_their_places_is_known(name: str, keys: list[str], phi1: float) -> None:
    """Lines in two pieces, of which the stations of the face show neither end to end from everywhere."""
    pair = solver_pair(pair_of(load(CORPUS / f"{name}.toml", keys))).parts[0]
    x = touches(pair, np.array([phi1]))[0].x
    plain = Conditions(pair.flanks, np.array([phi1]), pair.length)
    own = pieces(pair, plain, x, 13)
    assert own.line.tolist() == [0, 0]
    places = own.x[:, [1, 6, 9]].reshape(-1, 5)
    again = trace(pair, np.full(len(places), phi1), places)
    r = plain.touch(own.x.reshape(-1, 5), np.zeros(26, dtype=np.intp)).fixed[0].r.reshape(2, 13, 3)
    for points in again.points:
        assert points is not None
        assert points.shape == (27, 3)
        assert np.abs(points[[*range(13), *range(14, 27)]].reshape(2, 13, 3) - r).max() < 1e-8
    assert np.abs(again.x - again.x[0]).max() < 1e-8
