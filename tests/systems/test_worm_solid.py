"""Worms as parts: the thread against the surface that the rack leaves on the worm, solids, singular points, length [LF04 17.7]."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.command_line import messages
from oracles.places import SAMPLES
from scipy.spatial import cKDTree

from gearmesh import DesignError, Rigid, load
from gearmesh.app import cli
from gearmesh.check import deviation
from gearmesh.check.deviation import SURFACE_SAMPLE_WEIGHTS, deviations, triangle_distance
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import (
    Blank,
    Body,
    ConeLevel,
    Envelope,
    FeedEnvelope,
    Parabola,
    PlaneLevel,
    RackLine,
    RackRoll,
    RackSurface,
    RackTooth,
    ToolDescription,
    Tooth,
    ToothSide,
    along,
)
from gearmesh.mesh.solid import gear_solid, prove, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.systems.common.racks.rack_tooth import Heights, round_tips
from gearmesh.systems.parabolic_helical.worm_thread import touching_range, worm_member
from gearmesh.systems.system import worm as part_of_design
from gearmesh.tools.worm import Worm

MODULE, ADDENDUM, DEDENDUM = 4.0, 4.0, 5.0
NOVIKOV = SAMPLES / "novikov.toml"


def racks(tip_radius: float = 0.3, angles: tuple[float, float] = (25.0, 20.0)) -> tuple[RackTooth, RackTooth]:
    """Right and left side of a space with parabolic flanks of different pressure angles (deg)."""
    lines = [RackLine(float(np.radians(angle)), MODULE, 0.25 * np.pi * MODULE) for angle in angles]
    right, left = (Parabola(line, 0.008, line.at_height(0.0)) for line in lines)
    spec = SimpleNamespace(tool_tip_radius=tip_radius, dedendum=DEDENDUM / MODULE)
    return round_tips("pinion", spec, MODULE, (right, left), Heights(ADDENDUM, -DEDENDUM))


def worm(threads: int = 1, hand: int = 1, radius: float = 40.0) -> Worm:
    return Worm(radius, threads, 21, MODULE, 0.35, hand)


@pytest.mark.quick
@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("threads", [1, 2])
def test_thread_is_what_the_rack_leaves_on_the_worm(threads: int, hand: int) -> None:
    """Worm.thread and the thread of the part are two routes from one rack: the same points, opposite normals."""
    tool, both = worm(threads, hand), racks()
    tooth = worm_member(tool, both, 30.0).tooth
    # the rack's right side leaves the left side of the thread
    for rack, part, side in ((both[0], tooth.left, 1), (both[1], tooth.right, -1)):
        assert part.tip_corner is not None
        for profile, surface, span in (
            (rack.flank, part.flank, (rack.form_point[0], rack.tip)),
            (rack.rounding, part.tip_corner.surface, (rack.form_point[1], part.tip_corner.end)),
        ):
            p, v = np.meshgrid(np.linspace(*span, 7), np.linspace(-15.0, 15.0, 5), indexing="ij")
            left = tool.thread(RackSurface(profile, tool.helix, 0.0, side)).jet(p, v)
            turn = Rigid.about_z(side * np.pi / threads)
            points = turn.point(left.r)
            jet = nearest(surface, points, p, along(surface, p, points[..., 2], PlaneLevel(0.0))[0]).jet
            np.testing.assert_allclose(jet.r, points, rtol=0, atol=1e-11)
            np.testing.assert_allclose(jet.n, -turn.vector(left.n), rtol=0, atol=1e-11)


@pytest.mark.sweep
@pytest.mark.parametrize(("threads", "tip_radius"), [(1, 0.3), (3, 0.3), (1, 0.0)])
@pytest.mark.sweep_cases("1-0.3", "3-0.3")
def test_solid_of_a_worm(threads: int, tip_radius: float) -> None:
    """Closed, within the tolerance, of the volume of its exact sections, with the radii that the rack's heights say."""
    member = worm_member(worm(threads, radius=70.0), racks(tip_radius), 25.0, bore=50.0)
    sections = member.tooth.sections(np.linspace(0.0, 1.0, 5))
    links = [member.tooth.grid(region, np.array([0.0, 1.0]), sections).points for region in member.tooth.regions]
    for link, following in pairwise(links):
        np.testing.assert_allclose(link[1], following[0], rtol=0, atol=1e-10)
    volume = member.tooth.volume()
    for tolerance in (0.1, 0.025):
        mesh = tessellate(member.tooth, tolerance)
        solid = gear_solid(member, tolerance, mesh)
        proof = prove(solid, genus=1)
        assert proof.ok
        assert mesh.deviation <= tolerance
        a, b, c = np.moveaxis(solid.corners(), 1, 0)
        area = 0.5 * float(np.sqrt(dot(cross(b - a, c - a), cross(b - a, c - a))).sum())
        # the distance from the surface is mostly less than the largest, and of both signs on saddles
        assert abs(proof.volume - volume) < 0.5 * tolerance * area
        assert proof.volume == pytest.approx(volume, rel=0.03 * tolerance)
    radii = [np.hypot(*np.moveaxis(patch.points, -1, 0)[:2]) for patch in mesh.patches]
    assert max(rho.max() for rho in radii) == pytest.approx(70.0 + DEDENDUM, abs=1e-9)
    least = min(rho.min() for rho in radii)
    assert 70.0 - ADDENDUM - 0.25 * MODULE - 1e-9 <= least < 70.0 - ADDENDUM


@pytest.mark.quick
def test_thread_of_a_worm_repeats_along_its_lead() -> None:
    """Sections of the part, a lead apart, are the same, and in between turned by their part of it."""
    tool = worm(2)
    tooth, lead = worm_member(tool, racks(), 60.0).tooth, 2.0 * np.pi * MODULE / np.cos(tool.lead_angle)
    z = np.array([-0.5 * lead, -0.3 * lead, 0.5 * lead])
    sections = tooth.sections(z / 60.0 + 0.5)
    for region in tooth.regions:
        points = tooth.grid(region, np.linspace(0.0, 1.0, 9), sections).points
        np.testing.assert_allclose(points[:, 2, :2], points[:, 0, :2], rtol=0, atol=1e-11)
        turned = Rigid.about_z(0.4 * np.pi).point(points[:, 0])
        np.testing.assert_allclose(points[:, 1, :2], turned[:, :2], rtol=0, atol=1e-11)


def test_worm_must_be_longer_than_what_it_touches() -> None:
    """Without crowning the normal passes through the pitch point: a point x high touches at x cos(lambda) cot(alpha) of it."""
    tool, both = worm(), racks()
    low, high = touching_range(tool.tooth, tool, both, (-15.0, 15.0))
    reach = []
    for rack, sign in zip(both, (-1.0, 1.0), strict=True):
        for profile, span in (
            (rack.flank, (rack.form_point[0], rack.tip)),
            (rack.rounding, (rack.form_point[1], 0.5 * np.pi)),
        ):
            points, _, normals, _ = profile.section(np.linspace(*span, 200))
            reach.append(sign * points[:, 0] * np.cos(tool.lead_angle) * normals[:, 1] / normals[:, 0])
    assert low == pytest.approx(min(z.min() for z in reach), abs=1e-9)
    assert high == pytest.approx(max(z.max() for z in reach), abs=1e-9)
    # a plunge moves the places of contact
    plunged = touching_range(lambda rack: tool.tooth(rack, plunge=2e-4), tool, both, (-15.0, 15.0))
    assert 0.0 < np.abs(np.subtract(plunged, (low, high))).max() < 0.5


def _turning_back(tool: Worm, rack: RackTooth) -> Array:
    """Radii at which the axial section of the thread turns back on itself: extremes of the radius along the profile."""
    surface = tool.thread(RackSurface(rack.rounding, tool.helix, 0.0))
    rho = np.hypot(
        *np.moveaxis(surface.jet(np.linspace(rack.form_point[1], 0.5 * np.pi, 20001), np.zeros(20001)).r, -1, 0)[:2]
    )
    inner = np.diff(rho)
    return rho[1:-1][inner[1:] * inner[:-1] < 0.0]


@pytest.mark.quick
def test_thread_with_singular_points_is_refused() -> None:
    both = racks(angles=(25.0, 25.0))
    with pytest.raises(
        DesignError, match=r"worm.pitch_radius = 8 mm: the thread has singular points at the radius"
    ) as refused:
        worm_member(worm(radius=8.0), both, 30.0)
    radius, allowed = (float(str(refused.value).split(word)[1].split()[0]) for word in ("the radius", "at least"))
    turning = _turning_back(worm(radius=8.0), both[0])
    assert turning.size == 1
    # as printed
    assert radius == pytest.approx(turning[0], abs=5e-3)
    # at the limit that it names, rounded up to 1 um, the radius runs evenly again
    assert not _turning_back(worm(radius=allowed), both[0]).size
    assert _turning_back(worm(radius=allowed - 0.002), both[0]).size
    assert worm_member(worm(radius=allowed), both, 30.0).tooth.sections([0.0, 1.0]).t.size == 2


@pytest.mark.quick
def test_bore_that_reaches_the_root_is_refused() -> None:
    with pytest.raises(
        DesignError,
        match=r"worm.bore = 80 mm: the root lies below the bore; allowed is less than the root diameter, 7\d.\d+ mm",
    ):
        worm_member(worm(), racks(), 30.0, bore=80.0)


def test_teeth_may_go_round_more_than_half_a_turn() -> None:
    """A gear so wide that its teeth pass behind the axis: every section is the first one turned, area times width the volume."""
    helix, width = 0.9, 200.0
    rack = racks()[0]
    pitch_radius = 0.5 * 11 * MODULE / np.cos(helix)
    sides = {}
    for side in (1, -1):
        flank, fillet = (
            Envelope(RackSurface(profile, helix, 0.0, side), RackRoll(pitch_radius))
            for profile in (rack.flank, rack.rounding)
        )
        sides[side] = ToothSide(
            flank, fillet, rack.form_point, 0.5 * np.pi, rack.tip, tool=ToolDescription("rack cutter")
        )
    tip, root = ConeLevel.of(pitch_radius + ADDENDUM), ConeLevel.of(pitch_radius - DEDENDUM)
    body = Body.tube(10.0, -0.5 * width, 0.5 * width)
    tooth = Tooth(11, sides[1], sides[-1], Blank(PlaneLevel(0.0), (-0.5 * width, 0.5 * width), tip, root, body))
    assert np.tan(helix) * width / pitch_radius > 2.0 * np.pi
    sections = tooth.sections(np.linspace(0.0, 1.0, 21))
    angles = [getattr(side, name) for side in (sections.right, sections.left) for name in ("tip_angle", "root_angle")]
    for angle in angles:
        np.testing.assert_allclose(np.diff(angle), np.tan(helix) * width / pitch_radius / 20, rtol=0, atol=1e-11)
    middle = tooth.sections([0.5])
    area = 0.0
    for region in tooth.regions:
        grid = tooth.grid(region, np.linspace(0.0, 1.0, 4001), middle).points[:, 0]
        area += 0.5 * float((grid[:-1, 0] * grid[1:, 1] - grid[:-1, 1] * grid[1:, 0]).sum())
    assert tooth.volume() == pytest.approx(width * (11 * area - np.pi * 100.0), rel=1e-7)


# ---------------------------------------------------------------- meshes of threads


@pytest.mark.sweep
def test_distance_from_the_facets_is_that_of_the_closest_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against all facets of the thread: where cells are long and skew the closest one is often not the point's own."""
    monkeypatch.setattr(deviation, "FIRST_BATCH", 1)
    mesh = tessellate(worm_member(worm(), racks(), 6.0).tooth, 0.2)
    facets = teeth_mesh(mesh, "worm", np.array([0]))
    corners = facets.vertices[facets.triangles]
    found = deviations(mesh)
    for patch in mesh.patches:
        s, t = (SURFACE_SAMPLE_WEIGHTS @ each[patch.triangles][..., None] for each in (patch.nodes.s, patch.nodes.t))
        sections = mesh.tooth.sections(np.unique(t))[np.unique(t, return_inverse=True)[1].ravel()]
        points = mesh.tooth.grid(patch.region, s.reshape(1, -1), sections).points[0]
        largest = max(triangle_distance(q[:, None], corners).min(axis=1).max() for q in np.array_split(points, 20))
        assert found[patch.region].surface_to_facets == pytest.approx(largest, abs=1e-10)
        assert found[patch.region].largest <= 0.2


def test_distance_from_facets_without_area() -> None:
    """A link without width, as the root between full fillets, has facets that are lines."""
    a, b = np.array([0.0, 0.0, 0.0]), np.array([3.0, 0.0, 0.0])
    q = np.array([[1.0, 2.0, 0.0], [5.0, 0.0, 0.0], [-3.0, 4.0, 0.0]])
    for line in ((a, b, b), (a, a, b), (b, a, b)):
        np.testing.assert_allclose(triangle_distance(q, np.stack(line)), [2.0, 2.0, 5.0], rtol=0, atol=1e-15)
    np.testing.assert_allclose(triangle_distance(q, np.stack((a, a, a))), [np.sqrt(5.0), 5.0, 5.0], rtol=0, atol=1e-15)


@pytest.mark.sweep
def test_distance_from_the_surface_is_right_next_to_singular_points() -> None:
    """Against a cloud of exact points: near singular points a search for the closest point may lead away from it."""
    design = load(NOVIKOV, ["worm.pitch_radius=9.86", "worm.length=12"])
    mesh = tessellate(part_of_design(design).member.tooth, 0.1)
    found, sections = deviations(mesh), mesh.tooth.sections(np.linspace(0.0, 1.0, 701))
    cloud = [mesh.tooth.grid(patch.region, np.linspace(0.0, 1.0, 701), sections).points for patch in mesh.patches]
    tree, seen = cKDTree(np.concatenate(cloud).reshape(-1, 3)), 0.0
    for patch in mesh.patches:
        # away from the end faces, beyond which the exact surface goes on and the cloud does not
        inner = patch.triangles[((patch.nodes.t > 0.0) & (patch.nodes.t < 1.0))[patch.triangles].all(axis=1)]
        middles = 0.5 * (patch.points[inner] + np.roll(patch.points[inner], 1, axis=1))
        seen = max(seen, float(tree.query(middles.reshape(-1, 3))[0].max()))
    assert max(each.facets_to_surface for each in found.values()) == pytest.approx(seen, rel=0.05)
    assert max(each.largest for each in found.values()) <= 0.1


def _bevel() -> Tooth:
    return pair_of(load(SAMPLES / "spiral_bevel_basic.toml", [])).pinion.tooth


@pytest.mark.parametrize(
    ("tooth", "tolerance"),
    [(lambda: worm_member(worm(), racks(), 20.0).tooth, 0.05), (_bevel, 0.01)],
    ids=["worm", "spiral bevel"],
)
@pytest.mark.sweep_cases("spiral bevel")
def test_edges_of_the_end_faces_keep_the_tolerance(tooth: Any, tolerance: float) -> None:
    """Thread and spiral tooth meet their end faces at acute angles: chords are farther from the edge than from the flank."""
    mesh, places = tessellate(tooth(), tolerance), np.linspace(0.1, 0.9, 9)
    worst = 0.0
    for patch in mesh.patches:
        for end in (0.0, 1.0):
            nodes = patch.nodes.end(end)
            s = patch.nodes.s[nodes]
            exact = mesh.tooth.grid(
                patch.region, (s[:-1, None] + np.diff(s)[:, None] * places).ravel(), mesh.tooth.sections([end])
            ).points
            away = exact.reshape(-1, places.size, 3) - patch.points[nodes[:-1], None]
            chord = np.broadcast_to(np.diff(patch.points[nodes], axis=0)[:, None], away.shape)
            off = away - (dot(away, chord) / dot(chord, chord))[..., None] * chord
            worst = max(worst, float(np.sqrt(dot(off, off).max())))
    assert 0.7 * tolerance < worst <= tolerance
    assert worst <= mesh.deviation * 1.03


# ---------------------------------------------------------------- the worm of a design


def _flanks(design: Any) -> list[tuple[Any, int]]:
    """Right and left side of the ground pinion with the side of its rack."""
    tooth = pair_of(design).pinion.tooth
    return [(tooth.right, 1), (tooth.left, -1)]


@pytest.mark.parametrize("crowning", ["worm_plunge", "worm_roll"])
@pytest.mark.sweep_cases("worm_plunge")
def test_worm_of_a_design_touches_the_pinion_with_its_flanks(crowning: str) -> None:
    """Every point that grinds the pinion of the pair lies on the part, within the length that it says is needed."""
    design = load(NOVIKOV, [f"pinion.crowning={crowning}", "worm.threads=2", "coast_pressure_angle=20"])
    part = part_of_design(design)
    farthest = 0.0
    for side, sign in _flanks(design):
        assert isinstance(side.flank, FeedEnvelope)
        p, feed = np.meshgrid(
            np.linspace(side.form_point[0], side.tip, 31), np.linspace(-45.0, 45.0, 15), indexing="ij"
        )
        touching = Rigid.about_z(sign * np.pi / 2).point(side.flank.generation(p, feed).tool.r)
        thread = part.member.tooth.left if sign > 0 else part.member.tooth.right
        on_part = nearest(thread.flank, touching, p, along(thread.flank, p, touching[..., 2], PlaneLevel(0.0))[0]).jet
        np.testing.assert_allclose(on_part.r, touching, rtol=0, atol=1e-9)
        farthest = max(farthest, float(np.abs(touching[..., 2]).max()))
    needed = part.figures["needed_length_mm"]
    assert needed == pytest.approx(2.0 * farthest, rel=1e-9)
    pitch = np.pi * 5.08 / np.sqrt(1.0 - (5.08 / 98.0) ** 2)
    assert needed + pitch <= part.figures["length_mm"] < needed + pitch + 1.0


def test_worm_of_an_unground_pinion_is_fed_without_crowning() -> None:
    plunged, *others = (
        part_of_design(load(NOVIKOV, [f"pinion.crowning={crowning}"])) for crowning in ("worm_plunge", "disk", "none")
    )
    needed = [part.figures["needed_length_mm"] for part in others]
    assert needed[0] == needed[1]
    assert abs(plunged.figures["needed_length_mm"] - needed[0]) > 1e-3


def _run(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> tuple[int, dict[str, str], str]:
    """Exit status, figures, and standard error of `gearmesh solid NOVIKOV --member worm`."""
    status = cli.main(["solid", str(NOVIKOV), "--member", "worm", *map(str, arguments)])
    out, err = capsys.readouterr()
    return status, dict(line.split() for line in out.splitlines()), err


@pytest.mark.sweep
def test_worm_of_a_design_is_lean() -> None:
    """Diagonals cross the thread, whose sections run along it; facets face where the exact surface does, none is folded over."""
    member = part_of_design(load(NOVIKOV, [])).member
    mesh = tessellate(member.tooth, 0.01)
    assert max(each.largest for each in deviations(mesh).values()) <= 0.01
    assert len(gear_solid(member, 0.01, mesh).triangles) <= 60_000
    for patch in mesh.patches:
        a, b, c = np.moveaxis(patch.points[patch.triangles], 1, 0)
        facing = cross(b - a, c - a)
        assert (dot(facing, patch.normals) > 0.99 * np.sqrt(dot(facing, facing))).all()


@pytest.mark.sweep
def test_worm_on_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "worm.stl"
    status, found, err = _run(capsys, "-o", file, "--tol", "0.1mm", "--set", "worm.bore=60")
    assert (status, err, found["watertight"]) == (0, "gearmesh: solid of the worm\n", "true")
    assert float(found["max_deviation_um"]) <= 100.0
    assert file.stat().st_size == 84 + 50 * int(found["triangles"])
    needed, least = float(found["needed_length_mm"]), float(found["least_pitch_radius_mm"])
    # the length of the file, in inches, is shorter than that
    inches = ["--set", "units=inch", "--set", "module=0.2", "--set", "worm.length=0.5"]
    lengths = ("pinion.face_width=3.543307", "gear.face_width=3.543307", "worm.pitch_radius=3.858268")
    curvatures = ("pinion.parabola=0.42517", "gear.parabola=0.3937", "pinion.plunge_coefficient=1.27e-3")
    for each in (*lengths, *curvatures):
        inches += ["--set", each]
    step = tmp_path / "worm.step"
    status, cad, err = _run(capsys, "-o", step, "--tol", "2um", *inches)
    assert status == 0
    assert (
        messages(err) == f"gearmesh: warning: worm.length = 12.7 mm: grinding the whole tooth needs {needed:.6g} mm\n"
    )
    assert (float(cad["length_mm"]), float(cad["needed_length_mm"])) == (12.7, pytest.approx(needed, rel=1e-5))
    # a face for each link of the thread, both ends, and the bore that is the default
    assert cad["faces"] == "11"
    assert abs(float(cad["volume_error"])) < 1e-5
    # what the figure says is where threads are refused
    assert _run(capsys, "-o", file, "--tol", "1mm", "--set", f"worm.pitch_radius={least + 1e-3}")[0] == 0
    err = _run(capsys, "-o", file, "--tol", "1mm", "--set", f"worm.pitch_radius={least - 1e-3}")[2]
    assert "the thread has singular points at the radius" in err
    assert f"allowed is at least {np.ceil(1e3 * least) / 1e3:g} mm" in err


@pytest.mark.parametrize(
    ("sample", "arguments", "message"),
    [
        ("novikov", ["--teeth", "1"], "--teeth = 1: must be left out for --member = worm, which is always made whole"),
        ("helical", [], "--member = worm: must be one of pinion, gear, both, all"),
        ("helical", ["--teeth", "3"], "--member = worm: must be one of pinion, gear, both, all"),
        (
            "novikov",
            ["--set", "worm.bore=190"],
            "worm.bore = 190 mm: the root lies below the bore; allowed is less than the root diameter, 184.21 mm",
        ),
        ("novikov", ["--set", "worm.length=0"], "worm.length = 0: must be a length in mm above 0 and up to 1000000"),
    ],
)
@pytest.mark.sweep_cases(
    "novikov-arguments3-worm.bore = 190 mm: the root lies below the bore; allowed is less than the root diameter, 184.21 mm"
)
def test_worm_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], sample: str, arguments: list[str], message: str
) -> None:
    file = tmp_path / "worm.stl"
    status = cli.main(["solid", str(SAMPLES / f"{sample}.toml"), "--member", "worm", "-o", str(file), *arguments])
    out, err = capsys.readouterr()
    assert (status, out, err) == (2, "", f"gearmesh: error: {message}\n")
    assert not file.exists()
