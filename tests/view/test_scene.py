"""Pictures: numbers prove that things lie where they should, pixels that they are seen there."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from gearmesh import GearPair, Member, NoSolutionError, OutputError, Rigid
from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.path import ContactPath
from gearmesh.kernel.numeric.algebra import ARCSEC, dot, rotation_about, unit
from gearmesh.kinds import Mount, Side
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.view import opengl
from gearmesh.view import render as lettering
from gearmesh.view.diagrams import plots
from gearmesh.view.lettering import fit_title
from gearmesh.view.offscreen import shapes
from gearmesh.view.offscreen.letters import LetteredImage, ticks
from gearmesh.view.offscreen.shapes import Viewer, corner_normals, region_edges
from gearmesh.view.on_tooth import closest_gap, ellipse_edges, ellipses_on_surface, union_level
from gearmesh.view.palette import COLOUR_MAP, COMPOUND_COLOUR, LINE_COLOUR, PATH_COLOUR
from gearmesh.view.render import render
from gearmesh.view.scene import (
    STEEL_PAINT,
    Camera,
    MemberContact,
    Paint,
    PatternArea,
    Scene,
    SceneBody,
    ToothView,
    Word,
    beside_bar,
    contact_on,
)
from gearmesh.view.views import frame, gap_scene, member_scene, pair_scene, pattern_scene

SIZE = (480, 360)
# A bar as a tooth: its flank is part of a cylinder with an axis parallel to z, 6 mm high and 16 mm long.
RADIUS, AXIS, REACH, HALF_WIDTH = 30.0, np.array([20.0, -30.0]), 0.1, 8.0


def flank_point(angle, z):
    x, y = AXIS[0] + RADIUS * np.sin(angle), AXIS[1] + RADIUS * np.cos(angle)
    return np.stack(np.broadcast_arrays(x, y, z), axis=-1)


def flank_normal(angle):
    return np.stack((np.sin(angle), np.cos(angle), np.zeros_like(angle)), axis=-1)


class OntoFlank:
    """Closest points of the flank, NaN beyond its edges."""

    def __call__(self, points):
        angle = np.arctan2(points[..., 0] - AXIS[0], points[..., 1] - AXIS[1])
        return np.where((self.beyond(points) > 0.0)[..., None], np.nan, flank_point(angle, points[..., 2]))

    def beyond(self, points):
        angle = np.arctan2(points[..., 0] - AXIS[0], points[..., 1] - AXIS[1])
        return np.maximum(RADIUS * (np.abs(angle) - REACH), np.abs(points[..., 2]) - HALF_WIDTH)


project = OntoFlank()


def flank_grid(count=(41, 81)):
    return flank_point(np.linspace(-REACH, REACH, count[0])[:, None], np.linspace(-HALF_WIDTH, HALF_WIDTH, count[1]))


def bar(segments=24):
    """The tooth as a closed mesh with the regions flank_left, root (sides and back) and end."""
    angle = np.linspace(-REACH, REACH, segments + 1)
    arc = flank_point(angle, 0.0)[:, :2]
    section = np.concatenate((arc, [[arc[-1, 0], -4.0], [arc[0, 0], -4.0]]))
    n = len(section)
    vertices = np.concatenate([np.c_[section, np.full(n, z)] for z in (-HALF_WIDTH, HALF_WIDTH)])
    i = np.arange(n)
    j = (i + 1) % n
    sides = np.concatenate((np.stack((i, i + n, j), -1), np.stack((j, i + n, j + n), -1)))
    # Both ends are fans about a corner of the back, from which the whole convex section is seen.
    k = np.arange(n - 2)
    cap = np.stack((np.full(n - 2, n - 1), k, k + 1), -1)
    triangles = np.concatenate((sides, cap, cap[:, ::-1] + n))
    regions = np.concatenate((np.where(i < segments, 0, 1), np.where(i < segments, 0, 1), np.full(2 * (n - 2), 2)))
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    normals = unit(np.cross(b - a, c - a))
    middle = (angle[1:] + angle[:-1]) / 2
    normals[: 2 * n][regions[: 2 * n] == 0] = np.tile(flank_normal(middle), (2, 1))
    names = ("flank_left", "root", "end")
    return TriangleMesh(vertices, triangles.astype(np.int64), regions.astype(np.int32), names, normals)


def contact(z, angle=0.0, semi=(3.0, 0.8), edge=None):
    """Contact at positions z (P,) and angles of the flank: ellipses turned by 0.3 rad from the axis."""
    z = np.asarray(z, dtype=float)
    angle = np.broadcast_to(np.asarray(angle, dtype=float), z.shape)
    normal = flank_normal(angle)
    along, up = np.array([0.0, 0.0, 1.0]), np.cross(normal, [0.0, 0.0, 1.0])
    edge = np.zeros(len(z), dtype=bool) if edge is None else np.asarray(edge)
    a, b = (np.where(edge, np.nan, s) for s in semi)
    major, minor = np.cos(0.3) * along + np.sin(0.3) * up, np.cos(0.3) * up - np.sin(0.3) * along
    return MemberContact(flank_point(angle, z), normal, major, minor, a, b, edge, (None,) * len(z))


def view(title="bar"):
    return ToothView(bar(), project, title=title, size=SIZE)


# --- numbers ---


@pytest.mark.quick
def test_bar_is_a_closed_solid():
    mesh = bar()
    chord = RADIUS**2 * (REACH / 12 - np.sin(REACH / 12)) / 2 * 24
    cap = RADIUS**2 * (2 * REACH - np.sin(2 * REACH)) / 2 - chord
    width, drop = 2 * RADIUS * np.sin(REACH), RADIUS * (1 - np.cos(REACH))
    assert mesh.volume() == pytest.approx(2 * HALF_WIDTH * (cap + width * (4.0 - drop)), rel=1e-12)


@pytest.mark.quick
def test_ellipses_lie_on_the_surface_and_end_at_its_edges():
    here = contact([0.0, 6.5, -6.5], angle=[0.02, 0.0, 0.08])
    lift = 0.02
    discs, outlines = ellipses_on_surface(here, np.arange(3), project, lift)
    outline = outlines.reshape(-1, 3)

    def height(points):
        return np.hypot(points[..., 0] - AXIS[0], points[..., 1] - AXIS[1]) - RADIUS

    # The lift is along the contact's normal, a few degrees off the local one: 1 % of it.
    assert np.isfinite(discs).all()
    np.testing.assert_allclose(height(discs), lift, rtol=0.01)
    drawn = outline[np.isfinite(outline[:, 0])]
    np.testing.assert_allclose(height(drawn), 1.5 * lift, rtol=0.01)

    # Inside the ellipse seen along the normal; on it where it is not cut off.
    offset = discs - here.point[:, None, None]
    level = np.hypot(
        dot(offset, here.major[:, None, None]) / here.semi_major[:, None, None],
        dot(offset, here.minor[:, None, None]) / here.semi_minor[:, None, None],
    )
    assert level.max() < 1.01
    np.testing.assert_allclose(level[0, -1], 1.0, atol=0.01)

    # Cut off exactly at the end of the flank, not at the nearest sample; and really cut.
    assert discs[1, ..., 2].max() == pytest.approx(HALF_WIDTH, abs=1e-5)
    assert np.isnan(outline[146:291]).any()
    assert np.nanmax(outline[146:291, 2]) == pytest.approx(HALF_WIDTH, abs=1e-5)
    reached = np.arctan2(discs[2, ..., 0] - AXIS[0], discs[2, ..., 1] - AXIS[1])
    # 1 um: the lift along the contact's normal moves the edge sideways a little.
    assert RADIUS * reached.max() == pytest.approx(RADIUS * REACH, abs=1e-3)


@pytest.mark.quick
def test_ends_of_ellipses_take_few_projections():
    """Distances from the edge give 95 ends with 560 points; trial needs 2,000."""
    asked = []

    class Counting(OntoFlank):
        def beyond(self, points):
            asked.append(points[..., 0].size)
            return super().beyond(points)

    edges = ellipse_edges(contact([6.5, -6.5], angle=[0.0, 0.08]), np.arange(2), Counting(), 97)
    assert edges[0, :, 2].max() == pytest.approx(HALF_WIDTH, abs=1e-4)
    assert sum(asked) < 800


@pytest.mark.quick
def test_union_of_circles_along_a_line_is_distance_to_line():
    """Circles of radius 0.7 swept along a segment fill a capsule; edge contact in between parts it in two."""
    grid = np.stack(np.broadcast_arrays(np.linspace(17, 23, 61)[:, None], 0.0, np.linspace(-8, 8, 161)), axis=-1)
    positions = np.array([-5.0, -3.0, -1.0, 1.0, 3.0, 5.0])
    circles = replace(contact(positions, semi=(0.7, 0.7)), point=np.c_[0 * positions + 20, 0 * positions, positions])

    def distance(first, last):
        beyond = np.maximum(np.abs(grid[..., 2] - (first + last) / 2) - (last - first) / 2, 0.0)
        return np.hypot(grid[..., 0] - 20.0, beyond) / 0.7

    # Steps of an eighth of the radius: at most (1/16)^2 / 2 too far at level 1, 1/16 at level 0.
    level, exact = union_level(circles, grid), distance(-5.0, 5.0)
    assert np.all(level >= exact - 1e-12)
    assert np.all(level[exact > 0.9] < exact[exact > 0.9] + 0.0023)
    assert np.all(level < exact + 0.0626)

    edge = np.array([False, False, True, True, False, False])
    parted = replace(circles, edge=edge, semi_major=np.where(edge, np.nan, 0.7), semi_minor=np.where(edge, np.nan, 0.7))
    exact = np.minimum(distance(-5.0, -3.0), distance(3.0, 5.0))
    np.testing.assert_allclose(union_level(parted, grid), exact, atol=0.0626)


@pytest.mark.quick
def test_closest_gap_is_the_smallest_over_the_positions():
    grid = flank_grid()

    def bowl(points, z0):
        return 1e-4 * ((points[..., 2] - z0) ** 2 + 4.0 * (points[..., 0] - 20.0) ** 2)

    patches = []
    for z0 in (-1.0, 1.0):
        angle, z = np.meshgrid(np.linspace(-0.07, 0.07, 33), np.linspace(z0 - 2.5, z0 + 2.5, 65), indexing="ij")
        points = flank_point(angle, z)
        patches.append((points, np.where(bowl(points, z0) < 6e-4, bowl(points, z0), np.nan)))
    gap = closest_gap(grid, patches)
    exact = np.minimum(bowl(grid, -1.0), bowl(grid, 1.0))
    inside = exact < 5e-4
    # Linear interpolation over cells of 0.13 x 0.08 mm: at most (4 x 0.13^2 + 0.08^2) / 8 x 2e-4 = 2e-6 mm.
    np.testing.assert_allclose(gap[inside], exact[inside], atol=2.5e-6)
    assert np.isnan(gap[exact > 7e-4]).all()


def pair_in(*mounts):
    """A pair of members in these mounts, of whose teeth the number alone is known, and that they are no ring's."""
    outside = SimpleNamespace(body=SimpleNamespace(around=False))
    pinion, gear = (
        Member(name, SimpleNamespace(teeth=20, blank=outside), None, mount=mount)
        for name, mount in zip(("pinion", "gear"), mounts, strict=True)
    )
    return GearPair(pinion, gear, (Side.RIGHT, Side.RIGHT), 1, -1.0, 0.00635)


@pytest.mark.quick
def test_contact_in_own_frames():
    """Points, axes and lines known in the member's own frame, told in the fixed frame, come back."""
    mounts = (
        Mount(Rigid(rotation_about("x", 0.4), np.array([1.0, 2.0, 3.0]))),
        Mount(Rigid(rotation_about("y", 1.1), np.array([-40.0, 5.0, 0.0])), sign=-1.0, zero=0.2),
    )
    own = contact([-1.0, 0.0, 2.0], edge=[False, True, False])
    phi = np.array([-0.3, 0.0, 0.5])
    for member, sign in ((0, 1.0), (1, -1.0)):
        to_fixed = mounts[member].at(phi)
        line = np.array([[20.0, 0.0, -1.0], [20.0, 0.0, 1.0]])
        at_last = mounts[member].at(phi[2])
        path = path_of(own, phi)
        path = replace(
            path,
            normal=sign * to_fixed.vector(own.normal),
            major=to_fixed.vector(own.major),
            minor=to_fixed.vector(own.minor),
            lines=(None, None, at_last.point(line)),
        )
        found = contact_on(member, path, mounts)
        for name in ("point", "normal", "major", "minor"):
            np.testing.assert_allclose(getattr(found, name), getattr(own, name), atol=1e-14)
        np.testing.assert_allclose(found.lines[2], line, atol=1e-13)
        assert found.edge.tolist() == [False, True, False]
        assert found.ellipses.tolist() == [0, 2]


def path_of(own, phi):
    """A contact path whose frames all coincide."""
    p = len(phi)
    nothing = np.full((p, 2), np.nan)
    return ContactPath(
        phi1=phi,
        rotation=phi,
        phi2=phi,
        te=-2.0 * ARCSEC * (phi / 0.1) ** 2,
        kind=np.where(own.edge, "edge", "point"),
        edge=np.where(own.edge, "gear_tip", ""),
        status=np.zeros(p, dtype=np.int64),
        residual=np.zeros(p),
        point=own.point,
        normal=own.normal,
        point1=own.point,
        point2=own.point,
        params1=nothing,
        params2=nothing,
        semi_major=own.semi_major,
        semi_minor=own.semi_minor,
        angle=np.full(p, 0.3),
        major=own.major,
        minor=own.minor,
        lines=(None,) * p,
        seconds=0.0,
        part=np.zeros(p, dtype=np.intp),
    )


@pytest.mark.quick
def test_shading_normals_are_smooth_in_a_region_and_sharp_between_regions():
    mesh = bar()
    normals = corner_normals(mesh)
    flank = mesh.regions == 0
    corners = mesh.corners()[flank]
    angle = np.arctan2(corners[..., 0] - AXIS[0], corners[..., 1] - AXIS[1])
    inner = np.abs(angle) < REACH - 1e-9
    # Angles at a corner weigh the two neighbours unequally: off by less than half a cell, 0.0042 rad.
    exact = flank_normal(angle)
    assert np.abs(normals[flank] - exact)[inner].max() < 0.0042 * 0.7
    # The sides and the back share the region "root" but meet at right angles: no blending across.
    np.testing.assert_allclose(normals[~flank], np.broadcast_to(mesh.normals[~flank, None], normals[~flank].shape))
    # A normal that contradicts the facet would come out black.
    wrong = corner_normals(replace(mesh, normals=-mesh.normals))
    a, b, c = np.moveaxis(mesh.corners(), 1, 0)
    assert (dot(wrong, np.cross(b - a, c - a)[:, None]) > 0).all()


@pytest.mark.quick
def test_region_edges_of_the_bar():
    """A box has twelve edges; two of them follow the flank's ends in 24 segments."""
    box = bar(segments=24)
    assert len(region_edges(box)) == 10 + 2 * 24
    # of a box three edges are hidden; of its hollow mould no more than three are seen
    mould = replace(box, triangles=box.triangles[:, ::-1], normals=-box.normals)
    viewer = Viewer(Camera(np.array([30.0, 60.0, 90.0]), np.zeros(3), np.eye(3)[1], 20.0), 0.1)
    assert len(region_edges(box, viewer.faces(box.corners()))) == 7 + 2 * 24
    assert len(region_edges(mould, viewer.faces(mould.corners()))) == 3


@pytest.mark.quick
def test_line_contact_shows_lines_and_no_path_through_them():
    """Four positions along lines, then two in a point: only the last two make a path."""
    z = np.linspace(-7.0, 7.0, 30)
    angles = np.array([-0.08, -0.05, -0.02, 0.01, 0.04, 0.07])
    lines = tuple(flank_point(np.array(a), z) if a < 0.02 else None for a in angles)
    ends = np.where(angles < 0.02, np.nan, 1.0)
    here = replace(contact(0 * angles, angles), lines=lines, semi_major=ends, semi_minor=ends)
    for scene in (member_scene(view(), here), pattern_scene(view(), here, flank_grid())):
        drawn = {}
        for curve in scene.curves:
            drawn.setdefault(curve.colour, []).append(curve.points[np.isfinite(curve.points[:, 0])])
        assert len(drawn[LINE_COLOUR]) == 4
        np.testing.assert_allclose(drawn[LINE_COLOUR][2], lines[2], atol=0.02)
        (path,) = drawn[PATH_COLOUR]
        assert np.arctan2(path[:, 0] - AXIS[0], path[:, 1] - AXIS[1]).min() > 0.0399
    only_lines = replace(here, semi_major=ends * np.nan, semi_minor=ends * np.nan)
    assert pattern_scene(view(), only_lines, flank_grid()).areas == ()


@pytest.mark.quick
def test_cameras_hold_what_they_show():
    points = np.random.default_rng(5).normal(size=(200, 3)) * [30.0, 5.0, 10.0] + [100.0, -20.0, 3.0]
    for back, up in (([1, 2, 3], [0, 0, 1]), ([0, -1, 0.1], [1, 0, 0])):
        seen = frame(np.array(back, dtype=float), np.array(up, dtype=float), points, SIZE, margin=1.25).pixels(
            points, SIZE
        )
        low, high = seen.min(axis=0), seen.max(axis=0)
        np.testing.assert_allclose((low + high)[:2] / 2, np.array(SIZE) / 2, atol=1e-9)
        assert ((high - low)[:2] / SIZE).max() == pytest.approx(1 / 1.25, rel=1e-12)
        assert low[2] > 0
    pair = pair_in(Mount(Rigid(np.eye(3), np.array([0.0, 40.0, 0.0]))), Mount(Rigid.identity()))
    point = np.array([20.0, 0.0, 5.0])
    near = pair_scene(bar(), bar(), pair, (0.0, 0.0), size=SIZE, close_up=(point, 6.0)).camera
    np.testing.assert_allclose(near.pixels(point, SIZE)[:2], np.array(SIZE) / 2)
    np.testing.assert_allclose(near.pixels(point + 6.0 * near.axes[1], SIZE)[:2], [SIZE[0] / 2, 0.0], atol=1e-9)


@pytest.mark.quick
def test_words_are_beyond_what_they_name():
    """A long name of a line that goes level: its box begins where the line ends, and is inside of the picture."""
    camera = frame(
        np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([[-10.0, -8.0, 0.0], [10.0, 8.0, 0.0]]), SIZE
    )
    middle, end = np.zeros(3), np.array([4.0, 0.2, 0.0])
    scene = Scene((), camera, words=(Word("axis of a head cutter", end, middle),))
    sheet = LetteredImage(SIZE)
    ((place, text, across),) = lettering._placed_words(sheet, scene, SIZE)
    box = sheet.box(place, text, lettering._WORD_POINTS, across)
    assert camera.pixels(end, SIZE)[0] < box.left < box.right < SIZE[0]


@pytest.mark.quick
def test_names_of_lines_one_behind_the_other_stay_apart():
    """Axes of a shaper and of a face gear with an offset; the second name goes up or down, not away."""
    camera = frame(
        np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0]), np.array([[-10.0, -8.0, 0.0], [10.0, 8.0, 0.0]]), SIZE
    )
    middle, end = np.zeros(3), np.array([4.0, 0.2, 0.0])
    sheet, boxes = LetteredImage(SIZE), []
    for shift in (0.1, -0.1):
        words = (
            Word("axis of the shaper", end, middle),
            Word("axis of the gear", end + np.array([0.0, shift, 5.0]), middle),
        )
        placed = lettering._placed_words(sheet, Scene((), camera, words=words), SIZE)
        first, second = (sheet.box(place, text, lettering._WORD_POINTS, across) for place, text, across in placed)
        assert not (first.top < second.bottom and second.top < first.bottom)
        assert max(first.bottom, second.bottom) - min(first.top, second.top) < 2.5 * (first.bottom - first.top)
        boxes.append(second.top > first.top)
    assert boxes == [False, True]


@pytest.mark.quick
def test_letters_are_where_they_were_measured_to_be():
    """Letters are inside their measured box, except for their rim, and take nearly all of the box."""
    sheet = LetteredImage(SIZE, np.full((SIZE[1], SIZE[0], 3), 128, dtype=np.uint8))
    sheet.text((200.3, 90.7), "flank lines\nlp", 20.0, across=0.25, down=0.0, colour="#000000")
    box = sheet.box((200.3, 90.7), "flank lines\nlp", 20.0, across=0.25, down=0.0)
    for letters, rim in ((sheet.pixels() < 64, 0.0), (sheet.pixels() > 192, 1.5)):
        rows, columns = np.nonzero(letters.any(axis=-1))
        for seen, low, high in ((columns, box.left, box.right), (rows, box.top, box.bottom)):
            assert low - rim - 1.0 <= seen.min() <= low + 3.0
            assert high - 4.0 <= seen.max() <= high + rim


@pytest.mark.quick
def test_letters_of_small_pictures_are_legible():
    """Letters keep their share of the height down to 432 pixels, and their size in pixels below."""
    heights = {high: LetteredImage((4 * high // 3, high)).height("x", 10.0) for high in (1080, 540, 300, 200)}
    assert heights[1080] == pytest.approx(2.0 * heights[540], rel=0.1)
    assert heights[300] == heights[200] >= 8.0


def test_marks_cover_the_share_of_pixels_that_they_take():
    """A turned square, a disc and a line cut off by the edge of the picture."""
    middle, side = np.array([100.25, 80.5]), np.array([10.0, 0.0])
    for draw, area in (
        (
            lambda sheet: sheet.fill(
                [middle + side, middle + side[::-1], middle - side, middle - side[::-1]], "#000000"
            ),
            200.0,
        ),
        (lambda sheet: sheet.disc(middle, 30.0, "#000000"), np.pi * 10.0**2),
        (lambda sheet: sheet.line((-5.0, 40.0), (20.0, 40.0), 6.0, "#000000", rim=False), 20.0 * 4.0),
    ):
        sheet = LetteredImage(SIZE, np.full((SIZE[1], SIZE[0], 3), 255, dtype=np.uint8))
        draw(sheet)
        # half of a place more or less along the outline
        assert (1.0 - sheet.pixels()[..., 0] / 255.0).sum() == pytest.approx(area, abs=4.0)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        (6.35, "0 1 2 3 4 5 6"),
        (0.5, "0.0 0.1 0.2 0.3 0.4 0.5"),
        (20.0, "0.0 2.5 5.0 7.5 10.0 12.5 15.0 17.5 20.0"),
        (1234.0, "0 200 400 600 800 1000 1200"),
    ],
)
def test_colour_bars_have_round_numbers(limit, expected):
    values, numbers = ticks(limit)
    assert " ".join(numbers) == expected
    assert list(map(float, numbers)) == pytest.approx(values)


@pytest.mark.quick
def test_titles_are_broken_where_they_do_not_fit():
    figure, title = (
        Figure(figsize=(4.0, 3.0)),
        "A pair of gears with a long name: pinion, largest pressure over a mesh cycle",
    )
    lines = fit_title(title, figure, 12.0).split("\n")
    assert " ".join(lines) == title
    assert len(lines) > 1
    FigureCanvasAgg(figure)
    widths = [figure.text(0.5, 0.5, line, fontsize=12.0).get_window_extent().width for line in lines]
    assert max(widths) < figure.bbox.width
    assert fit_title("short", figure, 12.0) == "short"


@pytest.mark.quick
def test_scene_without_contact_is_refused():
    nowhere = contact([0.0, 1.0])
    nowhere = replace(nowhere, point=nowhere.point * np.nan, normal=nowhere.normal * np.nan)
    with pytest.raises(NoSolutionError, match="bar: no position has contact"):
        member_scene(view(), replace(nowhere, semi_major=np.full(2, np.nan)))


# --- the process that draws ---


@pytest.fixture
def program(monkeypatch):
    """Another program in the place of the process that draws."""
    opengl._end()
    monkeypatch.setattr(opengl, "_begun", [])

    def take(text):
        monkeypatch.setattr(opengl, "_DRAWING_PROGRAM", ("-c", text))
        opengl._failure.cache_clear()

    yield take
    opengl._failure.cache_clear()


@pytest.mark.quick
@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="needs POSIX signals")
def test_a_crashing_driver_becomes_one_line(program, monkeypatch, tmp_path):
    program("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    message = opengl.missing_opengl_message()
    assert message is not None
    assert "SIGSEGV" in message
    assert "libegl1 libgl1-mesa-dri (or libosmesa6 libx11-6)" in message
    assert "\n" not in message
    with pytest.raises(OutputError, match="SIGSEGV"):
        render(Scene((), Camera(np.ones(3), np.zeros(3), np.eye(3)[2], 1.0)), tmp_path / "a.png")
    assert not list(tmp_path.iterdir())
    # The answer is kept: no second child is started.
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("probed twice"))
    opengl.begin_drawing()
    assert opengl.missing_opengl_message() == message


@pytest.mark.quick
def test_a_child_that_fails_says_why(program, monkeypatch):
    program("raise SystemExit('no library of this name')")
    opengl.begin_drawing()
    # the child that began early is the one that is asked
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("probed twice"))
    assert "test rendering failed: no library of this name" in (opengl.missing_opengl_message() or "")


#: a driver that draws nothing: every picture is white, and the second ends the process if `deadly`
WHITE = """
import os, sys
for k in range(9):
    order = sys.stdin.buffer.read(int.from_bytes(sys.stdin.buffer.read(8), "little"))
    if len(order) < 9 or k > {last}:
        break
    pixels = bytes(4 * [{darkest}] + 16380 * [255])
    sys.stdout.buffer.write(len(pixels).to_bytes(8, "little") + pixels)
    sys.stdout.buffer.flush()
"""


@pytest.mark.quick
def test_an_empty_picture_is_a_failure(program):
    program(WHITE.format(darkest=255, last=9))
    assert "the picture came out empty" in (opengl.missing_opengl_message() or "")


@pytest.mark.quick
def test_a_process_that_ends_at_a_picture_is_replaced(program):
    program(WHITE.format(darkest=0, last=0))
    assert opengl.missing_opengl_message() is None
    first = opengl._begun[0]
    with pytest.raises(OutputError, match="a picture was not drawn: OpenGL ended with exit code 0"):
        opengl.draw(opengl._TRIAL_ORDER)
    assert first.child.poll() is not None
    assert len(opengl.draw(opengl._TRIAL_ORDER)) == 16384


#: program in which a library has restored the default action of SIGPIPE, as gmsh 4.15.2 does in `gmsh.initialize`
PIPE_SIGNAL = """
import os, signal
from gearmesh.pipes import closed_pipes_raise

signal.signal(signal.SIGPIPE, signal.SIG_DFL)
reading, writing = os.pipe()
os.close(reading)
for _ in range(2):
    try:
        with closed_pipes_raise():
            os.write(writing, b"order")
    except BrokenPipeError:
        print("raised", flush=True)
os.write(writing, b"order")
"""


@pytest.mark.quick
@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals of POSIX")
def test_a_closed_pipe_is_an_error_whatever_the_action_of_its_signal():
    done = subprocess.run([sys.executable, "-c", PIPE_SIGNAL], capture_output=True, text=True)
    assert done.stdout.split() == ["raised", "raised"], done.stderr
    # outside of the block the action is the library's again
    assert done.returncode == -signal.SIGPIPE


@pytest.mark.quick
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_process_has_a_drawing_process_of_its_own(program):
    program(WHITE.format(darkest=0, last=9))
    assert opengl.missing_opengl_message() is None
    begun = opengl._begun[0].child.pid
    if (child := os.fork()) == 0:
        try:
            opengl.draw(opengl._TRIAL_ORDER)
            same = opengl._begun[0].child.pid == begun
            opengl._end()
            os._exit(same)
        finally:
            os._exit(2)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
    assert len(opengl.draw(opengl._TRIAL_ORDER)) == 16384
    opengl._end()


def test_pictures_load_nothing_heavy_before_they_are_drawn():
    heavy = "{'pyvista', 'vtkmodules', 'matplotlib', 'trimesh', 'meshio'}"
    code = f"import sys, gearmesh.view.render, gearmesh.view.diagrams.plots; print(*{heavy}.intersection(sys.modules))"
    loaded = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert loaded.split() == []


# --- pixels ---


@pytest.fixture(scope="module")
def needs_opengl():
    message = opengl.missing_opengl_message()
    if message is not None:
        pytest.skip(message)


def rgb(colour):
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)], dtype=float)


def colour_at(image, camera, point):
    """Colours (..., 3) of the pixels at which points (..., 3) appear."""
    x, y = np.moveaxis(camera.pixels(point, (image.shape[1], image.shape[0]))[..., :2], -1, 0)
    return image[np.floor(y).astype(int), np.floor(x).astype(int)].astype(float)


@pytest.mark.usefixtures("needs_opengl")
@pytest.mark.parametrize("parallel", [True, False])
def test_ellipse_is_seen_where_it_lies_and_hidden_from_behind(parallel):
    here = contact([0.0])
    scene = member_scene(view(title=""), here)
    camera = replace(scene.camera, parallel=parallel)
    image = render(replace(scene, camera=camera))
    # Within the ellipse along its axes: blue; beyond it: steel, neither black nor coloured.
    out = np.array([-1.0, 1.0])[:, None]
    a, b = here.semi_major[0] * here.major[0], here.semi_minor[0] * here.minor[0]
    for axis in (a, b):
        inside = colour_at(image, camera, here.point[0] + 0.85 * out * axis)
        assert np.abs(inside - rgb(COMPOUND_COLOUR)).max() < 3
        outside = colour_at(image, camera, project(here.point[0] + 1.15 * out * axis))
        assert np.ptp(outside, axis=-1).max() < 30
        assert outside.min() > 90
    behind = replace(camera, position=2 * camera.focus - camera.position)
    image = render(replace(scene, camera=behind))[45:-75]  # without legend and axes
    assert np.abs(image - rgb(COMPOUND_COLOUR)).max(axis=-1).min() > 30


@pytest.mark.quick
@pytest.mark.usefixtures("needs_opengl")
@pytest.mark.parametrize("words", [2, 30])
def test_headings_are_on_white_however_near_the_body_is(words):
    camera = frame(np.eye(3)[2], np.eye(3)[1], bar().vertices, SIZE, 0.1)
    scene = Scene((SceneBody(bar(), Rigid.identity(), STEEL_PAINT),), camera, title=words * "reason ", size=SIZE)
    image, plain = render(scene), render(replace(scene, title=""))
    white = (image[:, 2] == 255).all(axis=-1)
    heading = int(np.argmin(white))
    assert white[:heading].all()
    assert not white[heading:].any()
    assert not (plain[:, 2] == 255).all(axis=-1).any()
    letters = (image.min(axis=-1) < 100).any(axis=1)
    assert letters[:heading].any()
    assert not letters[heading : heading + SIZE[1] // 3].any()
    assert (heading > 0.09 * SIZE[1]) == (words > 2)


@pytest.mark.usefixtures("needs_opengl")
def test_long_titles_go_on_in_a_second_line():
    """Nothing of one is cut off at the sides, as the reason of an unresolved pressure was."""
    camera = frame(np.eye(3)[2], np.eye(3)[1], bar().vertices, SIZE, 2.0)
    body = SceneBody(bar(), Rigid.identity(), STEEL_PAINT)
    heading = render(Scene((body,), camera, title="contact pressure, unresolved: " + 12 * "reason and ", size=SIZE))[
        :45
    ]
    assert (heading[:, :4] == 255).all()
    assert (heading[:, -4:] == 255).all()
    assert (heading[22:] < 128).any()


@pytest.mark.usefixtures("needs_opengl")
def test_no_side_of_a_body_is_black_and_nothing_covers_the_silhouette():
    mesh = bar()
    body = SceneBody(mesh, Rigid(rotation_about("y", 0.3), np.array([5.0, 0.0, 0.0])), STEEL_PAINT)
    points = body.own_to_scene.point(mesh.vertices)
    centre = body.own_to_scene.point(mesh.corners().mean(axis=1))
    facing = body.own_to_scene.vector(mesh.normals)
    for back in ([1, 1, 1], [-1, 0.5, 0.3], [0.2, -1, 0.4], [0.3, 0.2, -1]):
        camera = frame(unit(np.array(back, dtype=float)), np.array([0.1, 1.0, 0.2]), points, SIZE)
        image = render(Scene((body,), camera, size=SIZE))
        seen = dot(facing, camera.axes[2]) > 0.2
        assert colour_at(image, camera, centre[seen]).min() > 70
        assert image[20, SIZE[0] // 2].min() == 255


def test_a_flank_is_as_bright_on_either_side_of_the_viewer():
    """Two flanks that are turned away to the left and to the right are images of each other, and so is their light."""
    seen = []
    for side in (-1.0, 1.0):
        normal = unit(np.array([0.6 * side, 0.2, 1.0]))
        camera = Camera(np.array([0.0, 0.0, 50.0]), np.zeros(3), np.array([0.0, 1.0, 0.0]), 10.0, front_normal=normal)
        viewer = Viewer(camera, 10.0 / SIZE[1])
        seen.append(viewer.light(np.zeros((1, 3)), normal[None], np.full((1, 3), 200, dtype=np.uint8)))
    assert np.array_equal(*seen)


@pytest.mark.usefixtures("needs_opengl")
def test_equal_scenes_give_equal_pixels_and_the_file_holds_them(tmp_path):
    scene = pattern_scene(view(), contact([-3.0, 0.0, 3.0]), flank_grid())
    first = render(scene, tmp_path / "pattern.png")
    assert first.shape == (SIZE[1], SIZE[0], 3)
    np.testing.assert_array_equal(first, render(scene))
    read = matplotlib.image.imread(tmp_path / "pattern.png")[..., :3]
    np.testing.assert_array_equal(np.round(255 * read), first)
    # Between two positions, where no single ellipse reaches, the swept pattern still covers the flank.
    between = contact([1.5]).point
    assert np.abs(colour_at(first, scene.camera, between + 0.4 * scene.camera.axes[1]) - rgb(COMPOUND_COLOUR)).max() < 3
    with pytest.raises(OutputError, match=r"must be \.png"):
        render(scene, tmp_path / "pattern.bmp2")
    assert [f.name for f in tmp_path.iterdir()] == ["pattern.png"]


@pytest.mark.usefixtures("needs_opengl")
def test_lines_along_the_edges_of_strips_are_drawn_whole():
    """Pictures are drawn strip by strip: a line that crosses from one to the next at a small angle is equally wide there."""
    from gearmesh.view.offscreen.drawing_process import MAX_STRIP_ROWS

    across = np.array([[-2.0, -0.02, 0.0], [2.0, 0.02, 0.0]])
    line = shapes._primitive(across, np.array([[0, 1]]), "#000000", width=12.0)
    order = {**opengl._TRIAL_ORDER, "size": (2 * MAX_STRIP_ROWS, 2 * MAX_STRIP_ROWS), "primitives": [line]}
    pixels = np.frombuffer(opengl.draw(order), dtype=np.uint8).reshape(2 * MAX_STRIP_ROWS, 2 * MAX_STRIP_ROWS, 4)
    wide = (pixels[..., 0] < 128).sum(axis=0)
    assert wide.max() >= 12
    assert np.ptp(wide) <= 2


@pytest.mark.usefixtures("needs_opengl")
def test_value_map_has_the_colours_of_its_bar():
    here, grid, limit = contact([-6.0, 6.0], semi=(1.0, 1.0)), flank_grid(), 0.006
    gap = 0.004 + 0.001 * grid[..., 2] / 2.0
    scene = gap_scene(view(), here, grid, [(grid, gap)], limit)
    whole, inner = render(scene), beside_bar(SIZE)[0]
    image, angle = whole[:, :inner], 0.05
    for z in (-6.0, -3.0, 0.0, 3.0):
        um = 1e3 * (0.004 + 0.001 * z / 2.0)
        expected = 255 * np.array(matplotlib.colormaps[COLOUR_MAP](um / 6.0)[:3])
        found = colour_at(image, scene.camera, flank_point(np.array(angle), np.array(z)))
        assert np.abs(found - expected).max() < 8
    # Beyond the limit the steel shows.
    assert np.ptp(colour_at(image, scene.camera, flank_point(np.array(angle), np.array(5.5)))) < 30
    # The bar stands on white, however near the camera is.
    near = render(replace(scene, camera=replace(scene.camera, height=scene.camera.height / 5.0)))
    assert near[-20, inner - 3].min() < 255
    assert (near[330:, inner:] == 255).all()


@pytest.mark.quick
@pytest.mark.usefixtures("needs_opengl")
def test_pair_stands_in_its_mounts():
    pair = pair_in(
        Mount(Rigid.identity()), Mount(Rigid(rotation_about("z", np.pi), np.array([55.0, 0.0, 0.0])), sign=-1.0)
    )
    scene = pair_scene(bar(), bar(), pair, (0.4, 0.3), "pair", SIZE)
    image = render(scene)
    end = np.array([20.0, -1.5, HALF_WIDTH])
    blue = colour_at(image, scene.camera, pair.pinion.mount.at(0.4).point(end))
    brass = colour_at(image, scene.camera, pair.gear.mount.at(0.3).point(end))
    assert blue[2] > blue[0] + 20
    assert brass[0] > brass[2] + 20


@pytest.mark.quick
@pytest.mark.usefixtures("needs_opengl")
@pytest.mark.parametrize("raised", [0.0, 0.01])
def test_coarse_facets_tear_neither_an_area_nor_a_fine_body(raised):
    """The bar in 4 facets is up to 9 um below its flank; raised by 10 um it covers it, as one of a concave flank does."""
    coarse = replace(bar(segments=4), vertices=bar(segments=4).vertices + np.array([0.0, raised, 0.0]))
    red = SceneBody(coarse, Rigid.identity(), Paint("#ff0000"))
    scene = pattern_scene(view(title=""), contact([-3.0, 0.0, 3.0]), flank_grid())
    inner = flank_grid()[4:-4, 4:-4]
    area = PatternArea(flank_grid())
    image = render(replace(scene, bodies=(red,), areas=(area,), curves=()))
    assert np.abs(colour_at(image, scene.camera, inner) - rgb(COMPOUND_COLOUR)).max() < 3
    image = render(replace(scene, bodies=(replace(red, yields=True), *view().bodies), areas=(), curves=()))
    assert np.ptp(colour_at(image, scene.camera, inner), axis=-1).max() < 30


@pytest.mark.quick
@pytest.mark.usefixtures("needs_opengl")
def test_who_asks_for_a_picture_does_not_load_what_draws_it():
    code = (
        "import sys; import numpy as np; from gearmesh.view.render import *\n"
        "image = render(Scene((), Camera(np.ones(3), np.zeros(3), np.eye(3)[2], 1.0), size=(64, 48)))\n"
        "print(image.shape, *{'pyvista', 'vtkmodules', 'scipy', 'matplotlib'}.intersection(sys.modules))"
    )
    drawn = subprocess.run([sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, check=True)
    assert (drawn.stdout, drawn.stderr) == ("(48, 64, 3)\n", "")


# --- plots ---


@pytest.fixture
def figures(monkeypatch):
    """Figures that a plot would have written."""
    kept = []
    monkeypatch.setattr(plots, "save_figure", lambda figure, file: kept.append(figure))
    return kept


@pytest.mark.quick
def test_transmission_error_plot_is_in_degrees_and_arc_seconds(figures):
    phi = np.radians([-10.0, 0.0, 10.0])
    path = path_of(contact([-1.0, 0.0, 1.0], edge=[False, False, True]), phi)
    path = replace(path, te=np.array([-3.0, 0.0, -5.0]) * ARCSEC)
    turn = np.radians(np.linspace(-20, 20, 5))
    pairs = np.stack((np.full(5, -4.0), np.full(5, -2.0))) * ARCSEC
    plots.plot_transmission_error("te.png", path, Cycle(turn, pairs, pairs.max(axis=0), np.nan, np.zeros(5)))
    (axes,) = figures[0].axes
    drawn = {line.get_label(): line.get_xydata() for line in axes.lines}
    np.testing.assert_allclose(drawn["tooth pair"], [[-10, -3], [0, 0], [10, -5]], atol=1e-12)
    np.testing.assert_allclose(drawn["edge contact"], [[10, -5]], atol=1e-12)
    np.testing.assert_allclose(drawn["envelope"][:, 1], -2.0)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("pinion rotation φ₁ (deg)", "transmission error (arcsec)")


@pytest.mark.sweep
def test_plots_are_written_whole_repeatable_and_only_in_known_formats(tmp_path):
    runs = {
        "mesh": plots.CostRun(np.array([10.0, 1.0]), np.array([1e3, 1e4]), np.array([0.1, 0.4]), np.array([8e2, 8e3]))
    }
    for name, start in (("cost.png", b"\x89PNG"), ("cost.svg", b"<?xml"), ("cost.pdf", b"%PDF")):
        written = []
        for _ in range(2):
            plots.plot_cost(tmp_path / name, runs)
            written.append((tmp_path / name).read_bytes())
        assert written[0].startswith(start)
        assert written[0] == written[1]
    curves = {"a/b": (np.array([0.0, 5.0, 10.0]), np.array([np.inf, 10.0, 5.0]))}
    plots.plot_curves(tmp_path / "ratio.png", curves, ("cone angle (deg)", "a/b"), log_y=True)
    with pytest.raises(OutputError, match=r"its suffix must be \.png or \.svg or \.pdf"):
        plots.plot_curves(tmp_path / "ratio.xls", curves, ("cone angle (deg)", "a/b"))
    assert sorted(f.name for f in tmp_path.iterdir()) == ["cost.pdf", "cost.png", "cost.svg", "ratio.png"]
