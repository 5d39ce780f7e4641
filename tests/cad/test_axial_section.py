"""Axial sections of worms: flank forms of ISO 10828, sections across the axis, and the files as other programs read them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Member
from gearmesh.cad.contours.axial import axial_section
from gearmesh.cad.contours.curves import PlaneSpline
from gearmesh.kernel.numeric.algebra import Array, plane_cross

#: tolerance of the sections, mm
WITHIN = 1e-4


def worm(sample: str, *keys: str) -> Member:
    return gm.build(gm.load(SAMPLES / f"{sample}.toml", list(keys))).members["worm"]


def across(member: Member, z: float) -> Array:
    """Distances (2,) from the axis, mm, of the outline in the plane at z, on the sides +x and -x: by 4,001 points on every link."""
    tooth = member.tooth
    toe, heel = tooth.blank.extent
    sections = tooth.sections([(z - toe) / (heel - toe)])
    links = [tooth.grid(region, np.linspace(0.0, 1.0, 4001), sections).points[:, 0, :2] for region in tooth.regions]
    x, y = np.concatenate(links).T
    rho, theta = np.hypot(x, y), np.unwrap(np.arctan2(y, x))
    order = np.argsort(theta)
    return np.array([np.interp(at, theta[order], rho[order], period=tooth.pitch_angle) for at in (0.0, np.pi)])


def profile(member: Member) -> tuple[Array, Array]:
    """Points (K, 2), z and distance from the axis, mm, of the threads of an axial section: on the sides +x and -x."""
    section = axial_section(member, WITHIN)
    assert section.gap < 1e-9
    sides = []
    for contour, sign in zip(section.contours, (1.0, -1.0), strict=True):
        assert contour.area > 0.0
        points = np.concatenate([curve.at(np.linspace(0.0, 1.0, 401)) for curve in contour.curves])
        sides.append(points[sign * points[:, 1] > 0.6 * np.abs(points[:, 1]).max()] * np.array([1.0, sign]))
    return sides[0], sides[1]


@pytest.mark.sweep_cases("dual lead", "left rounded", "run out")
@pytest.mark.parametrize(
    "case",
    [
        pytest.param(("worm_drive",), id="involute"),
        pytest.param(("worm_drive_dual_lead",), id="dual lead"),
        pytest.param(
            ("worm_drive", "worm.right_hand=false", "worm.threads=3", "worm.tip_rounding=0.3"), id="left rounded"
        ),
        pytest.param(("worm_drive_zk_oversize",), id="run out"),
    ],
)
def test_axial_section_is_where_sections_across_the_axis_meet_its_plane(case: tuple[str, ...]) -> None:
    """Also in the run-outs, on both sides of the axis."""
    member = worm(*case)
    low, high = sorted(member.tooth.blank.extent)
    drawn = profile(member)
    for z in low + (high - low) * np.array([0.02, 0.063, 0.31, 0.5, 0.77, 0.945]):
        for side, exact in zip(drawn, across(member, float(z)), strict=True):
            # a point of a flank is as far off along z as it is across
            reached = np.hypot(side[:, 0] - z, side[:, 1] - exact).min()
            assert reached < 2e-2
            near = side[np.argsort(np.abs(side[:, 0] - z))[:2]]
            slope = (near[1, 1] - near[0, 1]) / (near[1, 0] - near[0, 0]) if near[1, 0] != near[0, 0] else 0.0
            assert abs(near[0, 1] + slope * (z - near[0, 0]) - exact) < 3.0 * WITHIN * np.hypot(1.0, slope) + 1e-5


@pytest.mark.sweep
def test_flanks_of_za_are_straight_in_the_axial_section() -> None:
    """At the pressure angle; those of ZI are not."""
    bent = {}
    for form in ("ZA", "ZI"):
        section = axial_section(worm("worm_drive", f"worm.form={form}"), WITHIN)
        curves = [
            c for c in section.contours[0].curves if isinstance(c, PlaneSpline) and abs(c.end[1] - c.start[1]) > 8.0
        ]
        assert len(curves) >= 8
        chords = [c.end - c.start for c in curves]
        away = [
            np.abs(plane_cross(c.at(np.linspace(0.0, 1.0, 101)) - c.start, way / np.linalg.norm(way))).max()
            for c, way in zip(curves, chords, strict=True)
        ]
        bent[form] = max(away)
        if form == "ZA":
            angles = np.degrees([np.arctan(abs(way[0] / way[1])) for way in chords])
            np.testing.assert_allclose(angles, 20.0, atol=2e-3)
    assert bent["ZA"] < WITHIN
    assert bent["ZI"] > 50.0 * WITHIN


@pytest.mark.sweep
def test_file_is_read_again(tmp_path: Path) -> None:
    """Splines and lines that ezdxf reads are those of the section."""
    ezdxf = pytest.importorskip("ezdxf")
    file = tmp_path / "worm.dxf"
    run("solid", str(SAMPLES / "worm_drive.toml"), "--member", "worm", "-o", str(file), "--section", "axial")
    space = ezdxf.readfile(file).modelspace()
    drawn = np.concatenate(profile(worm("worm_drive")))
    count = 0
    for entity in space:
        assert entity.dxf.layer == "worm_teeth"
        count += 1
        if entity.dxftype() != "SPLINE":
            continue
        points = np.array([(point.x, point.y) for point in entity.construction_tool().approximate(9)])
        points[:, 1] = np.abs(points[:, 1])
        apart = np.linalg.norm(points[:, None] - drawn, axis=-1).min(axis=1)
        assert apart.max() < 2e-2
    assert count == sum(len(contour.curves) for contour in axial_section(worm("worm_drive"), WITHIN).contours)


def test_teeth_that_are_no_threads_are_refused(tmp_path: Path) -> None:
    message = refused(
        "solid",
        str(SAMPLES / "helical.toml"),
        "--member",
        "gear",
        "-o",
        str(tmp_path / "a.dxf"),
        "--section",
        "axial",
    )
    assert "no threads" in message
    assert not list(tmp_path.iterdir())
