"""Gears ground by disk-shaped tools against the racks that determine the disks, and against worms [LF04 17.6-17.8]."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

from gearmesh import DesignError, Rigid, load
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import Arc, Envelope, FeedEnvelope, Jet, Parabola, Profile, RackLine, RackRoll, RackSurface, Surface
from gearmesh.tools.disk import Disk
from gearmesh.tools.worm import Worm

ALPHA, MODULE, TEETH = np.radians(20.0), 4.0, 21
LINE = RackLine(ALPHA, MODULE, 0.25 * np.pi * MODULE)
PLUNGE = 2e-4


def rounding(radius: float) -> Arc:
    """Tip rounding that touches the flank and a tip plane 5 mm deep; radius 0: the sharp tip."""
    point, _, normal, _ = LINE.section(np.array(LINE.at_height(-5.0 + radius * (1.0 - np.sin(ALPHA)))))
    return Arc((float(point[0] + radius * normal[0]), float(point[1] + radius * normal[1])), -radius)


#: profile and range of its parameter
PROFILES: dict[str, tuple[Profile, float, float]] = {
    "straight": (LINE, 1.5, 7.5),
    "parabolic": (Parabola(LINE, 0.01, LINE.at_height(0.0)), 2.0, 7.5),
    "rounding": (rounding(1.2), ALPHA, 0.5 * np.pi),
    "sharp tip": (rounding(0.0), ALPHA, 0.5 * np.pi),
}


def ground(
    name: str, helix: float = 0.35, side: int = 1, radius: float = 70.0, aside: float = 0.5, plunge: float = 0.0
) -> tuple[Disk, RackSurface, FeedEnvelope, Array, Array]:
    """Disk, rack, the tooth ground, and parameters (p, s) on it."""
    profile, low, high = PROFILES[name]
    rack, disk = RackSurface(profile, helix, 0.0, side), Disk(radius, TEETH, MODULE, helix, aside)
    p, s = np.meshgrid(np.linspace(low, high, 5), np.linspace(-20.0, 20.0, 7), indexing="ij")
    return disk, rack, disk.tooth(rack, plunge), p, s


def off(surface: Surface, points: Array, u: Array, v: Array) -> tuple[Array, Jet]:
    """Signed distance (...,) of points (..., 3) from a surface, along its normal there, and its jet; u, v: near them."""
    jet = nearest(surface, points, u, v).jet
    return dot(points - jet.r, jet.n), jet


def covering() -> Iterator[tuple[str, float, int, float, float]]:
    """Every profile on every helix; every radius with either of them, both sides and both places beside with all three."""
    for i, name in enumerate(PROFILES):
        for k, helix in enumerate((0.35, -0.7, 0.0)):
            yield name, helix, 1 - 2 * ((i + k) % 2), (0.25, 0.5)[(i // 2 + k) % 2], (8.0, 70.0, 1000.0)[(i + k) % 3]


@pytest.mark.quick
@pytest.mark.parametrize(("name", "helix", "side", "aside", "radius"), list(covering()))
def test_disk_without_plunge_grinds_what_the_rack_generates(
    name: str, helix: float, side: int, aside: float, radius: float
) -> None:
    disk, rack, tooth, p, s = ground(name, helix, side, radius, aside)
    gear, jet = Envelope(rack, RackRoll(disk.gear_radius)), tooth.jet(p, s)
    # the screw motion of the feed moves the touched point along the rack's teeth
    v = tooth.generation(p, s).v + s / np.cos(helix)
    apart, same = off(gear, jet.r, p, v)
    assert np.abs(apart).max() < 1e-12
    np.testing.assert_allclose(jet.n, same.n, rtol=0, atol=1e-12)


@dataclass(frozen=True)
class Turned:
    """The disk's surface by its definition, parameters (p, angle about its axis z): where normals of the tooth meet the axis."""

    tooth: Surface
    to_disk: Rigid
    start: Array

    def touching(self, p: Array) -> Array:
        """Second parameter of the tooth: secant steps on the volume that normal, axis and arm span."""

        def volume(v: Array) -> Array:
            jet = self.tooth.jet(p, v).move(self.to_disk)
            return jet.r[..., 0] * jet.n[..., 1] - jet.r[..., 1] * jet.n[..., 0]

        before, v = self.start, self.start + 0.1
        for _ in range(12):
            f, f_before = volume(v), volume(before)
            before, v = v, np.where(f == f_before, v, v - f * (v - before) / np.where(f == f_before, 1.0, f - f_before))
        return v

    def points(self, p: Array, angle: Array) -> tuple[Array, Array]:
        jet = self.tooth.jet(p, self.touching(p)).move(self.to_disk)
        turn = Rigid.about_z(angle)
        return turn.point(jet.r), turn.vector(jet.n)


@pytest.mark.quick
@pytest.mark.parametrize("name", PROFILES)
def test_plunged_disk_against_its_own_surface(name: str) -> None:
    """The disk built from its definition and put where it stands at s: touches the tooth at its angle, penetrates nowhere."""
    disk, rack, tooth, p, s = ground(name, plunge=PLUNGE)
    found, jet = tooth.generation(p, s), tooth.jet(p, s)
    # from the disk to the gear, written out: turned to the space, fed with the screw motion, moved in by the plunge
    z = np.array([0.0, np.cos(0.35), -np.sin(0.35)])
    axes = np.stack((np.array([1.0, 0.0, 0.0]), np.cross(z, [1.0, 0.0, 0.0]), z), axis=-1)

    def placed(feed: Array) -> Rigid:
        away = disk.gear_radius + 70.0 - PLUNGE * feed**2
        at = Rigid(axes, np.stack((away, np.zeros_like(feed), feed), axis=-1))
        return Rigid.about_z(feed * np.tan(0.35) / disk.gear_radius - np.pi / TEETH) @ at

    determining = Envelope(rack, RackRoll(disk.gear_radius))
    turned = Turned(determining, placed(np.zeros(())).inverse, tooth.start(p, s)[0])
    points, normals = turned.points(p, found.psi)
    np.testing.assert_allclose(placed(s).point(points), jet.r, rtol=0, atol=1e-10)
    np.testing.assert_allclose(placed(s).vector(normals), jet.n, rtol=0, atol=1e-11)
    for step in (-0.02, 0.02):
        beside = placed(s).point(turned.points(p, found.psi + step)[0])
        # n points into the disk, which stays off the tooth beside the point that grinds
        assert (dot(beside - jet.r, jet.n) > 1e-4).all()


@pytest.mark.quick
@pytest.mark.parametrize("name", PROFILES)
def test_partials_are_the_derivatives(name: str) -> None:
    _, _, tooth, p, s = ground(name, plunge=PLUNGE)
    jet, h = tooth.jet(p, s), 1e-5 * np.ptp(p)
    for (dp, ds), r_x, n_x in (((h, 0.0), jet.r_u, jet.n_u), ((0.0, 1e-3), jet.r_v, jet.n_v)):
        ahead, behind = tooth.jet(p + dp, s + ds), tooth.jet(p - dp, s - ds)
        for change, exact in ((ahead.r - behind.r, r_x), (ahead.n - behind.n, n_x)):
            np.testing.assert_allclose(change / (2.0 * (dp + ds)), exact, rtol=0, atol=2e-7 * np.abs(exact).max())
        assert np.abs(dot(jet.n, r_x)).max() < 1e-11 * np.abs(r_x).max()


@pytest.mark.quick
def test_section_of_a_spur_gears_disk_is_its_space() -> None:
    """Without a helix the disk's section is the transverse section of the space, whatever the radius of the disk."""
    disk, rack, _, p, _ = ground("straight", helix=0.0, radius=40.0)
    rho, height = disk.section(rack, p[:, 0])
    gear = Envelope(rack, RackRoll(disk.gear_radius)).jet(p[:, 0], np.zeros(5)).r
    space = Rigid.about_z(np.pi / TEETH).point(gear)
    np.testing.assert_allclose(rho, disk.gear_radius + 40.0 - space[:, 0], rtol=0, atol=1e-11)
    np.testing.assert_allclose(height, space[:, 1], rtol=0, atol=1e-11)


@pytest.mark.quick
def test_both_sides_of_the_space_have_one_disk() -> None:
    """In the middle of the space the sections for both flanks are mirror images."""
    p = np.linspace(1.5, 7.5, 9)
    disk = Disk(70.0, TEETH, MODULE, 0.35)
    (rho, height), (other, mirrored) = (disk.section(RackSurface(LINE, 0.35, 0.0, side), p) for side in (1, -1))
    np.testing.assert_allclose(rho, other, rtol=0, atol=1e-11)
    np.testing.assert_allclose(height, -mirrored, rtol=0, atol=1e-11)
    assert (height > 0.0).all()


@pytest.mark.quick
def test_vertex_of_the_plunge() -> None:
    """At the feed of the vertex the disk touches where it would without plunge; `feed_at_mid_face` puts that at z = 0."""
    disk, rack, p = Disk(70.0, TEETH, MODULE, 0.35), RackSurface(LINE, 0.35, 0.0), np.linspace(1.5, 7.5, 5)
    vertex = disk.feed_at_mid_face(rack, 4.0)
    assert abs(vertex) > 1.0
    plunged, plain = (disk.tooth(rack, plunge, vertex).jet(p, np.full(5, vertex)) for plunge in (PLUNGE, 0.0))
    np.testing.assert_allclose(plunged.r, plain.r, rtol=0, atol=1e-10)
    assert abs(disk.tooth(rack, PLUNGE, vertex).jet(np.array(4.0), np.array(vertex)).r[2]) < 1e-10
    apart = (
        disk.tooth(rack, PLUNGE, vertex).jet(p, np.full(5, vertex + 9.0)).r
        - disk.tooth(rack).jet(p, np.full(5, vertex + 9.0)).r
    )
    assert np.linalg.norm(apart, axis=-1).min() > 0.3 * PLUNGE * 81.0


@pytest.mark.quick
def test_disk_that_reaches_its_axis_is_refused() -> None:
    with pytest.raises(DesignError, match=r"disk.pitch_radius = 4 mm: must be more than the normal module, 4 mm"):
        Disk(4.0, TEETH, MODULE, 0.35)


# ---- the pair of [LF04] Table 17.8.1 (b)


@pytest.fixture(scope="module")
def table() -> tuple[Pair, RackSurface, float]:
    """Pair with a placeholder for the pinion's flank, the pinion's parabolic rack, the pinion's pitch (rad)."""
    gears = pair_of(load(SAMPLES / "modified_involute.toml", ["rack_parameter=1", "pinion.crowning=none"]))
    straight = gears.pinion.tooth.right.flank
    assert isinstance(straight, Envelope)
    assert isinstance(straight.tool, RackSurface)
    pair = solver_pair(gears)
    stations = straight.jet(pair.pinion.grid[..., 0], pair.pinion.grid[..., 1]).r[..., 2]
    grid = np.stack((pair.pinion.grid[..., 0], stations), axis=-1)
    return replace(pair, pinion=replace(pair.pinion, grid=grid)), straight.tool, gears.pitch


def errors(table: tuple[Pair, RackSurface, float], surface: Surface) -> tuple[float, Array]:
    """Return the place of the largest transmission error, in pitches, and its course (33,) over one pitch about it, arc seconds."""
    pair, _, pitch = table
    pair, vertex = replace(pair, pinion=replace(pair.pinion, surface=surface)), 0.0
    for _ in range(3):
        turns = vertex + np.linspace(-0.5, 0.5, 33)
        path = contact_path(pair, turns * pitch, edges=False)
        assert (path.kind == "point").all()
        square, slope, height = np.polyfit(turns[12:21] - vertex, path.te[12:21] / ARCSEC, 2)
        vertex -= 0.5 * slope / square
    return vertex, path.te / ARCSEC - height + 0.25 * slope**2 / square


def test_disk_and_worm_crown_almost_the_same(table: tuple[Pair, RackSurface, float]) -> None:
    """[LF04 17.7]: the approaches give almost the same. Over the flank, the disk does so with the worm's own coefficient."""
    rack = table[1]
    vertex, worm = errors(table, Worm(98.0, 1, 17, 5.08, rack.helix).tooth(rack, plunge=3.15e-5))
    beside, flank = errors(table, Disk(98.0, 17, 5.08, rack.helix, aside=0.25).tooth(rack, 3.15e-5))
    assert beside == pytest.approx(vertex, abs=1e-4)
    assert np.abs(flank - worm).max() == pytest.approx(0.15, abs=0.02)
    # in the middle of the space the normal that the disk touches at the pitch point is steeper against its plunge
    tooth = Disk(98.0, 17, 5.08, rack.helix).tooth(rack, 3.15e-5)
    _, space = errors(table, tooth)
    normal = tooth.jet(np.array(5.08 / np.cos(np.radians(25.0))), np.array(0.0)).n
    steeper = Rigid.about_z(np.pi / 17).vector(normal)[0] / np.sin(np.radians(25.0))
    assert steeper > 1.1
    assert (space / flank)[[0, -1]].mean() == pytest.approx(steeper, rel=0.01)
    # and with less plunge it is the worm's again
    _, less = errors(table, Disk(98.0, 17, 5.08, rack.helix).tooth(rack, 2.7466e-5))
    assert np.abs(less - worm).max() < 0.03


@pytest.mark.quick
def test_past_a_limiting_line_the_disk_goes_on_from_the_sound_flank() -> None:
    """There it would touch the tooth in two places: the one that it goes on to runs off with the line of action."""
    line = RackLine(np.radians(19.859), 9.387, 0.5 * np.pi * 9.387 / 2.7693)
    flank = Parabola(line, 0.030295, line.at_height(0.0))
    disk = Disk(187.74, 34, 9.387, np.radians(30.965))
    p = np.linspace(20.0, 4.7, 60)
    for side in (1, -1):
        touched = disk.tooth(RackSurface(flank, disk.helix, 0.0, side)).generation(p, np.zeros_like(p)).v
        assert np.ptp(touched) > 100.0
        assert (np.diff(touched) * side > 0.0).all()


@pytest.mark.quick
@pytest.mark.parametrize("helix", [0.35, -0.7, 0.0])
def test_the_rim_leaves_the_root_between_the_fillets(helix: float) -> None:
    """It ends where either fillet does, plunged or not, and without a plunge it is the cylinder of the rack's tip plane."""
    racks = tuple(ground("rounding", helix, side)[1] for side in (1, -1))
    disk, vertex = ground("rounding", helix)[0], 3.0
    rim, ends = disk.rim((racks[0], racks[1]), 0.5 * np.pi, PLUNGE, vertex)
    s = np.linspace(-20.0, 20.0, 9)
    # the left fillet of the space is that of the tooth before, a pitch back
    turns = Rigid.about_z(np.zeros(())), Rigid.about_z(np.array(-2.0 * np.pi / TEETH))
    for rack, turn, end in zip(racks, turns, ends[::-1], strict=True):
        fillet = disk.tooth(rack, PLUNGE, vertex).jet(np.full_like(s, 0.5 * np.pi), s)
        left = rim.jet(np.full_like(s, end), s)
        np.testing.assert_allclose(left.r, turn.point(fillet.r), rtol=0, atol=1e-11)
        np.testing.assert_allclose(left.n, turn.vector(fillet.n), rtol=0, atol=1e-11)
    assert ends[1] - ends[0] > 0.005
    plain, (low, high) = disk.rim((racks[0], racks[1]), 0.5 * np.pi)
    u, s = np.meshgrid(np.linspace(low, high, 4), s, indexing="ij")
    points = plain.jet(u, s).r
    np.testing.assert_allclose(np.hypot(points[..., 0], points[..., 1]), disk.gear_radius - 5.0, rtol=0, atol=1e-10)
