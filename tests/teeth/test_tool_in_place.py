"""The tool in its place touches the finished flank at its middle, and is nowhere in the finished tooth."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES
from scipy.interpolate import CubicSpline

import gearmesh as gm
from gearmesh import DesignError, Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.systems.system import worm
from gearmesh.systems.worm_drive.build import wheel_hob
from gearmesh.teeth.generation.tool_in_place import ToolInPlace, tool_in_place
from gearmesh.view.projection import flank_projection

#: mm: depth that counts as none, where a tool of the flank's own making touches it, and points of the flank looked at
DEEP, TOUCHES, GRID = 1e-6, 1e-9, (np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 41))


def in_ring(tool: ToolInPlace, sheet: int, r: Array, n: Array) -> tuple[Array, Array]:
    """Return depths (...,) of points r (..., 3), own frame, in a turned tool, by the tangent at the nearest point of its section,
    and the differences of its normals there from n (..., 3)."""
    back = tool.tool_to_own.inverse
    seen, normal = back.point(r), back.vector(n)
    points, normals = (_in_axial_plane(each[:, 0], tool.sheets[sheet].points[:, 0]) for each in _arrays(tool, sheet))
    at = _in_axial_plane(seen, seen)
    nearest = np.linalg.norm(at[..., None, :] - points, axis=-1).argmin(axis=-1)
    depth = ((at - points[nearest]) * normals[nearest]).sum(axis=-1)
    # in the axial plane, or not normal to a surface of revolution
    aside = np.abs(np.linalg.norm(_in_axial_plane(normal, seen), axis=-1) - 1.0)
    return depth, np.abs(_in_axial_plane(normal, seen) - normals[nearest]).max(axis=-1) + aside


def _arrays(tool: ToolInPlace, sheet: int) -> tuple[Array, Array]:
    return tool.sheets[sheet].points, tool.sheets[sheet].normals


def _in_axial_plane(vectors: Array, at: Array) -> Array:
    """Radial and axial components (..., 2) of vectors (..., 3) at points (..., 3)."""
    outwards = at[..., :2] / np.linalg.norm(at[..., :2], axis=-1)[..., None]
    return np.stack(((vectors[..., :2] * outwards).sum(axis=-1), vectors[..., 2]), axis=-1)


def in_thread(design: gm.Design, tool: ToolInPlace, r: Array) -> Array:
    """Return depths (...,) of points r (..., 3) in the thread of the worm that is made as a part, along arcs about its axis."""
    part, given = worm(design), design.worm
    tooth, sine = part.member.tooth, 0.5 * given.threads * design.given_module / given.pitch_radius
    winding = (1.0 if given.right_hand else -1.0) * np.sqrt(1.0 - sine**2) / sine / given.pitch_radius
    r = (tool.tool_to_own @ part.own_to_tool).inverse.point(r)
    radius, pitch, depths = np.hypot(r[..., 0], r[..., 1]), 2.0 * np.pi / tooth.teeth, []
    for side in Side:
        line = tooth.flank_grid(side, np.linspace(0.0, 1.0, 400), [0.5]).points[:, 0]
        angles = np.arctan2(line[:, 1], line[:, 0]) - winding * line[:, 2]
        section = CubicSpline(np.hypot(line[:, 0], line[:, 1]), np.unwrap(angles), extrapolate=False)
        angle = np.arctan2(r[..., 1], r[..., 0]) - winding * r[..., 2] - section(radius)
        depths.append(side.sign * radius * ((angle + 0.5 * pitch) % pitch - 0.5 * pitch))
    return np.minimum(*depths)


@pytest.mark.parametrize(
    ("sample", "name", "both"),
    [
        ("spiral_bevel_basic", "pinion", False),
        ("spiral_bevel_basic", "gear", True),
        ("hypoid", "pinion", False),
        ("spiral_bevel_formate", "gear", True),
        ("novikov", "pinion", None),
    ],
)
@pytest.mark.sweep_cases("novikov-pinion-None")
def test_touches_and_does_not_cut_into_the_finished_tooth(sample: str, name: str, both: bool | None) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    tooth = gears.members[name].tooth
    for side in Side:
        tool = tool_in_place(tooth, side)
        flank = tooth.flank_grid(side, *GRID)
        middle = tuple(n // 2 for n in flank.points.shape[:2])
        np.testing.assert_allclose(tool.touching.r, flank.points[middle], atol=TOUCHES)
        np.testing.assert_allclose(tool.touching.n, flank.normals[middle], atol=TOUCHES)
        if both is None:
            depth = in_thread(gears.design, tool, flank.points)
        else:
            assert len(tool.sheets) == (5 if both else 2)
            depth, apart = in_ring(tool, 0, flank.points, flank.normals)
            assert apart[middle] < TOUCHES
        assert np.isfinite(depth).mean() > 0.5
        assert abs(depth[middle]) < TOUCHES
        assert np.nanmax(depth) < DEEP
        if both:
            # beyond the space stands the other side of the next tooth
            other = tooth.flank_grid(Side.LEFT if side is Side.RIGHT else Side.RIGHT, *GRID)
            beyond = Rigid.about_z(-side.sign * tooth.pitch_angle)
            depth, _ = in_ring(tool, 2, beyond.point(other.points), beyond.vector(other.normals))
            assert -1e-2 < np.max(depth) < DEEP


@pytest.mark.sweep
def test_worm_touches_the_shaped_flank_of_a_face_gear_without_cutting() -> None:
    gears = gm.build(gm.load(SAMPLES / "face_gear.toml"))
    gear, part = gears.members["gear"], gears.part("worm")
    assert part.ground == "gear"
    assert part.tooth is not None
    assert part.own_to_tool is not None
    for side in Side:
        tool = tool_in_place(part.tooth, side)
        assert tool.as_part
        assert [axis.name for axis in tool.axes] == ["axis of the grinding worm"]
        worm_to_gear = tool.tool_to_own @ part.own_to_tool
        # the flank of a right-hand thread that faces the gear's, sought without the envelope's parameters
        project = flank_projection(part.member, Side.LEFT if side is Side.RIGHT else Side.RIGHT)
        flank = gear.tooth.flank_grid(side, np.linspace(0.3, 0.7, 21), np.linspace(0.3, 0.7, 41))
        nearest = worm_to_gear.point(project(worm_to_gear.inverse.point(flank.points)))
        # how deep points of the gear are in the thread, along the gear's normal
        depth = ((flank.points - nearest) * flank.normals).sum(axis=-1)
        assert np.isfinite(depth).mean() > 0.5
        assert np.nanmax(depth) < DEEP
        touching = flank_projection(gear, side)(tool.touching.r[None])
        assert np.linalg.norm(touching - tool.touching.r) < DEEP
        assert np.linalg.norm(worm_to_gear.point(project(worm_to_gear.inverse.point(touching))) - touching) < DEEP


@pytest.mark.sweep
def test_view_of_the_worm_is_that_of_the_member_that_it_grinds() -> None:
    pinion = gm.build(gm.load(SAMPLES / "novikov.toml"))
    assert repr(pinion.picture("tool", "worm")) == repr(pinion.picture("tool", "pinion"))
    disk = gm.build(gm.load(SAMPLES / "novikov.toml", ["pinion.crowning=disk"]))
    with pytest.raises(DesignError, match="member = worm: the pinion is generated by a grinding disk"):
        disk.picture("tool", "worm")
    with pytest.raises(DesignError, match="member = worm: must be one of"):
        pinion.picture("contact_lines", "worm")


def test_helical_shaper_stands_in_its_place() -> None:
    """It touches the flank where it generates it, one tooth's flanks on either side; in a ring it has the ring's hand."""
    gears = gm.build(gm.load(SAMPLES / "internal.toml"))
    tooth = gears.members["gear"].tooth.unmodified_tooth
    tool = tool_in_place(tooth, Side.LEFT)
    flank = tooth.side(Side.LEFT).flank.jet(*tool.place)
    assert np.abs(tool.touching.r - flank.r).max() < 1e-11
    assert np.abs(tool.touching.n - flank.n).max() < 1e-11
    sheets = [sheet for sheet in tool.sheets if sheet.region == "flank"]
    own = {dimension.symbol: dimension.value for dimension in tool.description.dimensions}
    radius = 0.5 * own["z_0"] * own["m_t0"]
    # the whole shaper, up to its tip circle on all sides
    assert len(sheets) == 2 * own["z_0"]
    reach = np.concatenate([sheet.points.reshape(-1, 3) for sheet in tool.sheets])
    around = np.hypot(reach[:, 0] - radius, reach[:, 1])
    assert 2.0 * around.max() == pytest.approx(own["d_a0"], abs=1e-9)
    assert np.ptp(np.arctan2(reach[:, 1], reach[:, 0] - radius)) > 6.0
    assert [axis.name for axis in tool.axes] == ["axis of the shaper"]
    twist = np.tan(np.radians(gears.design.helix_angle)) * (1.0 if gears.design.hand == "right" else -1.0) / radius
    for sheet in sheets:
        x, y, z = np.moveaxis(sheet.points[:, [0, -1]], -1, 0)
        turned = np.diff(np.unwrap(np.arctan2(y, x - radius)), axis=1) / np.diff(z, axis=1)
        assert turned == pytest.approx(np.full_like(turned, twist), rel=1e-12)


def test_unknown_tool_is_refused() -> None:
    gears = gm.build(gm.load(SAMPLES / "rack.toml"))
    with pytest.raises(
        DesignError,
        match="view = tool: the planing tool that cuts this flank cannot be shown; allowed is a flank of head cutters",
    ):
        gears.picture("tool", "rack")
    with pytest.raises(DesignError, match="phi1 = 3"):
        gears.picture("tool", "pinion", phi1=3.0)


@pytest.mark.parametrize(
    "changes", [[], ["hob.reference_diameter=75", "shaft_angle=82", "worm.right_hand=false", "worm.threads=1"]], ids=str
)
@pytest.mark.sweep_cases("['hob.reference_diameter=75', 'shaft_angle=82', 'worm.right_hand=false', 'worm.threads=1']")
def test_hob_of_a_worm_wheel_touches_its_flank_without_cutting(changes: list[str]) -> None:
    """Compare with the drawn section of the hob's thread alone. Points of seven teeth of the wheel are carried into it by the
    screw motion."""
    gears = gm.build(gm.load(SAMPLES / "worm_drive.toml", changes))
    tooth, side = gears.members["wheel"].tooth, gears.pairs[0].flanks[1]
    tool = tool_in_place(tooth, side)
    assert {sheet.region for sheet in tool.sheets} == {"flank", "fillet", "land", "root"}
    hob = wheel_hob(gears.design)
    to_hob = (tool.tool_to_own @ hob.place(1)).inverse
    screw, pitch = hob.thread.hand * hob.thread.screw, hob.thread.axial_pitch

    def section(r: Array) -> tuple[Array, Array]:
        own = to_hob.point(r)
        return np.hypot(own[..., 0], own[..., 1]), own[..., 2] - screw * np.arctan2(own[..., 1], own[..., 0])

    (outline,) = tool.outlines
    rho, z = section(tool.tool_to_own.point(outline))
    half = len(rho) // 2
    # the 25 points of the flanks: where they end in the tip rounding the curvature jumps
    low, high = (CubicSpline(r, h) for r, h in ((rho[:25], z[:25]), (rho[:-26:-1], z[:-26:-1])))
    middle = 0.5 * (z[half - 1] + z[half])

    def depth(r: Array) -> Array:
        at, height = section(r)
        height = middle + np.remainder(height - middle + 0.5 * pitch, pitch) - 0.5 * pitch
        return np.where(at > rho.min(), np.minimum(height - low(at), high(at) - height), -np.inf)

    grid = tooth.sections(np.linspace(0.0, 1.0, 21))
    for region in tooth.regions:
        points = tooth.grid(region, np.linspace(0.0, 1.0, 15), grid).points.reshape(-1, 3)
        for k in range(-3, 4):
            away, at = depth(turned := Rigid.about_z(k * tooth.pitch_angle).point(points)), section(turned)[0]
            assert away[at < hob.form_radius].max(initial=-1.0) < DEEP
    assert depth(tool.touching.r) == pytest.approx(0.0, abs=1e-6)
    for sheet in tool.sheets:
        if sheet.region == "flank":
            assert np.abs(depth(tool.tool_to_own.point(sheet.points[1:-1]))).max() < DEEP
    normals = np.concatenate([sheet.normals.reshape(-1, 3) for sheet in tool.sheets])
    assert np.abs(np.linalg.norm(normals, axis=1) - 1.0).max() < 1e-12
