"""Teeth of a member that differ: closed solids and sections in which each is its own, contact of each, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
from oracles.examples import some
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh import DesignError, Rigid
from gearmesh.answers.bodies.extract import WHOLE_MEMBER
from gearmesh.cad.brep import exact_volume
from gearmesh.contact.flanks import contact_flank
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kinds import Side, Tooth
from gearmesh.mesh.tessellate import tessellate_alike
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS

SAMPLES = Path(gm.__file__).parents[1] / "samples"
TOLERANCE = 0.02
#: mm, 0.01 to 0.03 over a flank
VALUES = 0.02 + 0.01 * np.linspace(-1.0, 1.0, 9) * np.ones((5, 1))
#: waves of 0.08 mm, which take more stations and lines than other teeth need
WAVES = 0.04 * np.cos(0.5 * np.pi * np.arange(9)) * np.ones((5, 1))


@cache
def differing(sample: str) -> tuple[gm.Gears, gm.Gears]:
    """Nominal gears, and those of which two neighbours and a third tooth of the pinion differ, in three kinds."""
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    made = gears.with_deviations("pinion", "right", VALUES, teeth=(3, 7))
    return gears, made.with_deviations("pinion", "left", [-VALUES, WAVES], teeth=(7, 8))


def offset_volume(tooth: Tooth, nominal: Tooth) -> float:
    """Volume (mm^3) between flanks and fillets of two teeth with the same parameters: facets of one times how far they moved."""
    total, sections = 0.0, nominal.sections(np.linspace(0.0, 1.0, 121))
    for region in (*FLANK_REGIONS.values(), *FILLET_REGIONS.values()):
        grid, surface = nominal.grid(region, np.linspace(0.0, 1.0, 41), sections), tooth.chain[region].surface
        assert surface is not None
        height = dot(surface.jet(*np.moveaxis(grid.parameters, -1, 0)).r - grid.points, grid.normals)
        over = 0.25 * (height[1:, 1:] + height[:-1, 1:] + height[1:, :-1] + height[:-1, :-1])
        across = grid.points[1:, 1:] - grid.points[:-1, :-1], grid.points[1:, :-1] - grid.points[:-1, 1:]
        total += float((over * 0.5 * np.linalg.norm(cross(*across), axis=-1)).sum())
    return total


@pytest.mark.sweep
@pytest.mark.parametrize("sample", some(["spiral_bevel_basic", "helical", "double_helical"], 2))
def test_a_solid_has_each_tooth_as_it_is(sample: str, tmp_path: Path) -> None:
    """Watertight as it is written, each tooth's vertices its own, the volume that of the teeth, by sections and by what moved."""
    nominal, real = differing(sample)
    member, teeth = real.member("pinion"), real.member("pinion").tooth.teeth
    solid = real.solid("pinion", TOLERANCE, file=tmp_path / "pinion.stl")
    assert solid.complaints == []
    solid.save(tmp_path / "pinion.stl")
    assert trimesh.load_mesh(tmp_path / "pinion.stl").is_watertight
    meshes = tessellate_alike(member.different_teeth, TOLERANCE)
    assert len({len(mesh.weld().vertices) for mesh in meshes}) > 1
    assert member.order.tolist() == [{3: 1, 7: 2, 8: 3}.get(k, 0) for k in range(teeth)]
    flanks = [np.concatenate([patch.points for patch in mesh.patches if patch.region.is_flank]) for mesh in meshes]
    # a solid whose bound is above the tolerance is meshed again, finer
    whole = WHOLE_MEMBER.mesh(member, TOLERANCE, None).mesh.vertices
    for k in (0, 3, 6, 7, 8, 9):
        vertices = cKDTree(Rigid.about_z(-2.0 * np.pi * k / teeth).point(whole))
        away = [vertices.query(points)[0].max() for points in flanks]
        own = away.pop(member.order[k])
        assert own < 1e-9
        assert min(away) > 1e-3
    exact = exact_volume(member)
    assert solid.measured.volume == pytest.approx(exact, rel=2e-3)
    offsets = sum(offset_volume(member.tooth_at(k), member.tooth) for k in (3, 7, 8)) * len(member.halves)
    assert exact - exact_volume(nominal.member("pinion")) == pytest.approx(offsets, rel=5e-3)


def outline_area(teeth: list[Tooth], z: float) -> float:
    """Area (mm^2) inside the polygon through many points of the sections of teeth in a row round the axis."""
    outline: list[Array] = []
    for k, tooth in enumerate(teeth):
        toe, heel = tooth.blank.extent
        at = tooth.sections([(z - toe) / (heel - toe)])
        points = np.concatenate(
            [link.grid(np.linspace(0.0, 1.0, 300), at).points[:, 0] for link in tooth.chain.values()]
        )
        outline.append(Rigid.about_z(k * tooth.pitch_angle).point(points)[:, :2])
    x, y = np.concatenate(outline).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


@pytest.mark.sweep
def test_a_section_has_each_tooth_as_it_is(tmp_path: Path) -> None:
    """Closed, and its area within the tolerance round the outline of that of the exact points of all teeth."""
    nominal, real = differing("helical")
    member = real.member("pinion")
    section = real.section("pinion", 3.0, 1e-4)
    assert section.complaints == []
    loop = next(loop for loop in section.loops if loop.name == "teeth")
    wanted = outline_area([member.tooth_at(k) for k in range(member.tooth.teeth)], 3.0)
    assert loop.area == pytest.approx(wanted, abs=0.02)
    plain = next(loop for loop in nominal.section("pinion", 3.0, 1e-4).loops if loop.name == "teeth")
    assert abs(loop.area - plain.area) > 0.2
    section.save(tmp_path / "pinion.dxf")


@pytest.mark.sweep
def test_contact_is_that_of_the_tooth_that_is_chosen() -> None:
    """The roll test agrees with each; a tooth with more material drives the gear ahead, by its height over its lever."""
    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml"))
    which = gears.pairs[0].flanks[0]
    real = gears.with_deviations("pinion", which, np.full((5, 9), 0.01), teeth=[2, 5])
    phi1 = np.linspace(-6.0, 10.0, 3)
    paths = {}
    for tooth in (0, 5):
        chosen = real.with_teeth_like("pinion", tooth)
        contact = chosen.contact(phi1, cycle=False)
        paths[tooth] = contact.path
    assert chosen.roll(contact).complaints == []
    plain = gears.contact(phi1, cycle=False).path
    np.testing.assert_array_equal(paths[0].phi2, plain.phi2)
    both = gears.with_deviations("pinion", which, np.full((5, 9), 0.01)).contact(phi1, cycle=False).path
    np.testing.assert_array_equal(paths[5].phi2, both.phi2)
    assert (np.abs(paths[5].phi2 - plain.phi2) > 0.005 / 70.0).all()


def test_what_takes_teeth_to_be_alike_refuses_others() -> None:
    real = differing("helical")[1]
    answers: tuple[Callable[[], object], ...] = (
        lambda: real.contact(),
        lambda: real.loaded_contact(10.0),
        lambda: real.limits(),
        lambda: real.cad("pinion"),
        lambda: real.finite_elements(phi1=0.0),
        lambda: real.solids(),
        lambda: real.check(),
        lambda: real.sheet(member="pinion"),
        lambda: real.with_deviations("pinion", "left", VALUES),
    )
    for answer in answers:
        with pytest.raises(DesignError, match=r"pinion: some of its teeth differ \(3, 7, 8\)"):
            answer()
    # neither does what starts from members instead of gears take the nominal tooth
    with pytest.raises(DesignError, match="some of its teeth differ"):
        contact_flank(real.member("pinion"), Side.RIGHT)


def test_teeth_that_do_not_fit_between_their_neighbours_are_refused() -> None:
    gears = gm.build(gm.load(SAMPLES / "helical.toml"))
    member, gear = gears.member("pinion"), gears.member("gear")
    with pytest.raises(DesignError, match=r"^tooth = 24: must be from 0 to 23 for the pinion"):
        gears.with_deviations("pinion", "left", VALUES, teeth=[24])
    with pytest.raises(DesignError, match=r"tooth 3 cannot be beside the others: it is one of \d+ teeth, they of 24"):
        member.with_teeth({3: gear.tooth})
    turned = gm.build(gm.load(SAMPLES / "helical.toml", ["pinion.profile_shift=0.05"])).member("pinion").tooth
    with pytest.raises(DesignError, match="tooth 3 cannot be beside the others: its blank is another"):
        member.with_teeth({3: turned})
    with pytest.raises(DesignError, match=r"it begins 0\.\d+ mm beside them at the root"):
        member.with_teeth({3: replace(turned, blank=member.tooth.blank)})
    with pytest.raises(DesignError, match="a grid for each of 2 teeth, or one for all"):
        gears.with_deviations("pinion", "left", [VALUES] * 3, teeth=[1, 2])
