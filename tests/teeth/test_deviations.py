"""Deviations along the normals of flanks of any kind: what they are followed by, closed teeth, and contact by other routes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.contact.flanks import contact_flank
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import shape_operator, tangent_basis
from gearmesh.kernel.surface.offset import Offset
from gearmesh.kinds import Level, Side, Surface, Tooth
from gearmesh.systems.common.micro_geometry import with_true_involutes
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid, with_deviations
from gearmesh.teeth.micro_geometry.screw_involute import AmountJet, ScrewInvolute
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS
from gearmesh.teeth.section import Grid
from gearmesh.view.diagrams.modification_diagrams import is_modified

SAMPLES = Path(gm.__file__).parents[1] / "samples"
CORPUS = Path(__file__).parents[1] / "corpus"
#: rows and columns of 45 deviations, as bevel gears are measured
S, T = np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 9)
#: points between them
FINE = np.linspace(0.1, 0.9, 41)


def smooth(tooth: Tooth, which: Side, s: Array, t: Array) -> Array:
    """Deviations (S, T), mm, over a range of some 50 um: a function of two coordinates, from -1 to 1 along and across the flank."""
    middle, heel, tip = (
        np.array([level.value(tooth.flank_grid(which, [at[0]], [at[1]]).points[0, 0]) for level in flank_levels(tooth)])
        for at in ((0.5, 0.5), (0.5, 1.0), (1.0, 0.5))
    )
    points = tooth.flank_grid(which, s, t).points
    x, y = (level.value(points) - zero for level, zero in zip(flank_levels(tooth), middle, strict=True))
    x, y = x / (heel - middle)[0], y / (tip - middle)[1]
    return np.asarray(0.02 * np.sin(1.5 * x + y) + 0.015 * x**2 - 0.01 * x * y + 0.005 * y**2)


def flank_levels(tooth: Tooth) -> tuple[Level, Level]:
    return tooth.blank.axial, tooth.blank.across


def noisy(tooth: Tooth, which: Side, most: float = 0.002) -> Array:
    """At the points of the grid, by up to `most` (mm) off the smooth ones."""
    return smooth(tooth, which, S, T) + most * np.random.default_rng(1).uniform(-1.0, 1.0, (S.size, T.size))


def sample(name: str, *overrides: str) -> gm.Gears:
    return gm.build(gm.load(SAMPLES / f"{name}.toml", overrides))


def away(surface: Surface, grid: Grid) -> Array:
    """Return distances (mm) of a surface from points of a grid along the normals there, found by Newton's method."""
    assert grid.p is not None
    assert grid.v is not None
    p, v, d = grid.p, grid.v, np.zeros(grid.p.shape)
    for _ in range(10):
        jet = surface.jet(p, v)
        matrix = np.stack((jet.r_u, jet.r_v, -grid.normals), axis=-1)
        step = np.linalg.solve(matrix, (grid.points + d[..., None] * grid.normals - jet.r)[..., None])[..., 0]
        p, v, d = p + step[..., 0], v + step[..., 1], d + step[..., 2]
    assert np.abs(step).max() < 1e-9
    return np.asarray(d)


@dataclass(frozen=True)
class Pair:
    """A spiral bevel pair, with what the pinion's working flank deviates, and the pair that has it."""

    nominal: gm.Gears
    values: Array
    real: gm.Gears


@pytest.fixture(scope="module")
def bevel() -> Pair:
    gears = sample("spiral_bevel_basic")
    values = noisy(gears.member("pinion").tooth, Side.RIGHT)
    return Pair(gears, values, gears.with_deviations("pinion", "right", values))


@pytest.mark.sweep
def test_a_bevel_flank_follows_45_deviations(bevel: Pair) -> None:
    """To rounding at the points; between them a smooth function to 0.1 um, and noise is not made larger."""
    nominal, real = (gears.member("pinion").tooth for gears in (bevel.nominal, bevel.real))
    at_points, between = (nominal.flank_grid("right", *grid) for grid in ((S, T), (FINE, FINE)))
    np.testing.assert_allclose(away(real.right.flank, at_points), bevel.values, atol=1e-11)
    assert np.ptp(bevel.values) > 0.045
    wanted = smooth(nominal, Side.RIGHT, FINE, FINE)
    assert np.abs(away(real.right.flank, between) - wanted).max() < 0.004
    plain = bevel.nominal.with_deviations("pinion", "right", noisy(nominal, Side.RIGHT, 0.0)).member("pinion").tooth
    assert np.abs(away(plain.right.flank, between) - wanted).max() < 1e-4


@pytest.mark.sweep
def test_normals_and_curvatures_of_a_bevel_flank(bevel: Pair) -> None:
    """Compare with differences of points and of normals, whose own error is of the second order in the step."""
    tooth = bevel.real.member("pinion").tooth
    surface, grid = tooth.right.flank, tooth.flank_grid("right", np.linspace(0.15, 0.8, 4), np.linspace(0.15, 0.8, 6))
    assert grid.jet is not None
    basis, missed = tangent_basis(grid.jet), []
    for h in (4e-4, 1e-4):
        rows = []
        for du, dv in ((h, 0.0), (0.0, h)):
            ahead, behind = (surface.jet(grid.p + k * du, grid.v + k * dv) for k in (1, -1))
            rows.append([(ahead.r - behind.r) / (2.0 * h), (ahead.n - behind.n) / (2.0 * h)])
        (r_u, n_u), (r_v, n_v) = rows
        n = np.cross(r_u, r_v)
        n *= (np.sign(dot(n, grid.normals)) / np.linalg.norm(n, axis=-1))[..., None]
        bent = shape_operator(replace(grid.jet, r_u=r_u, r_v=r_v, n_u=n_u, n_v=n_v), *basis)
        missed.append([np.abs(n - grid.normals).max(), np.abs(bent - shape_operator(grid.jet, *basis)).max()])
    assert missed[1][0] < missed[0][0] / 15.0 + 1e-10
    assert missed[1][1] < missed[0][1] / 15.0 + 1e-9
    # far more than that is what the deviations change
    before = bevel.nominal.member("pinion").tooth.right.flank.jet(grid.p, grid.v)
    assert np.abs(shape_operator(before, *tangent_basis(before)) - shape_operator(grid.jet, *basis)).max() > 1e-3


@pytest.mark.sweep
def test_the_ease_off_of_other_settings_gives_their_transmission_error() -> None:
    """A pinion that is cut with other settings, and one with its deviations; the gear is the same. What is left of the flank
    between 9 x 17 points, at a lever of 60 mm or more about the gear's axis, bounds what is left of the rotation."""
    own, settings = (sample("spiral_bevel_basic", f"pinion.concave.te_at_change={te}") for te in (10, 16))
    pinion = replace(own.member("pinion"), tooth=settings.member("pinion").tooth)
    other = gm.Gears(own.design, own.train.with_member(pinion))
    tooth, wanted = own.member("pinion").tooth, pinion.tooth.right.flank
    s, t = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 17)
    values = away(wanted, tooth.flank_grid("right", s, t))
    assert np.ptp(values) > 0.003
    real = own.with_deviations("pinion", "right", values, s=s, t=t)
    fine = np.linspace(0.0, 1.0, 33)
    left = np.abs(away(wanted, real.member("pinion").tooth.flank_grid("right", fine, fine))).max()
    assert left < 1e-4
    phi1 = np.linspace(-12.0, 22.0, 9)
    nominal, found, expected = (gears.contact(phi1, cycle=False).path for gears in (own, real, other))
    bound = 2.0 * left / 60.0
    assert np.abs(found.te - expected.te).max() < bound
    assert np.abs(found.phi2 - expected.phi2).max() < bound
    assert np.abs(nominal.te - expected.te).max() > 10.0 * bound
    points = found.kind == "point"
    assert points.sum() > 5
    np.testing.assert_allclose(found.semi_major[points], expected.semi_major[points], rtol=0.02)


@dataclass(frozen=True)
class Transverse:
    """Amounts that remove the deviations of a surface `moved` along the line of action, as micro-geometry counts."""

    involute: ScrewInvolute
    moved: Offset

    def jet(self, length: Array, z: Array) -> AmountJet:
        lean = np.cos(np.arctan(self.involute.rate * self.involute.base_radius))
        a = -self.moved.field.jet(self.involute.jet(length, z).r).value / lean
        return AmountJet(a, *(np.zeros_like(a) for _ in range(5)))


def test_amounts_by_normals_and_line_of_action_agree_to_second_order() -> None:
    """Half the deviations leave a quarter of the difference, which is about amount times steepness."""
    member, left = with_true_involutes(sample("helical").member("pinion")), []
    tooth = member.tooth
    for share in (1.0, 0.5):
        values = share * smooth(tooth, Side.RIGHT, S, T)
        real = with_deviations(member, {Side.RIGHT: DeviationGrid.of(tooth, Side.RIGHT, values)}).tooth
        moved = real.right.flank
        assert isinstance(moved, Offset)
        assert isinstance(moved.surface, ScrewInvolute)
        other = replace(moved.surface, amount=Transverse(moved.surface, moved))
        left.append(np.abs(away(other, real.flank_grid("right", FINE, FINE))).max())
    assert left[0] < 1e-3
    assert left[1] == pytest.approx(0.25 * left[0], rel=0.1)


#: undercut all along, and in part; a fillet of no height; sharp joints, of a tool in two parts; a chamfered tip; a ring; a bar
ODD: dict[str, tuple[Any, str]] = {
    "undercut": ("line_cylindrical_undercut", "gear"),
    "partly_undercut": ("undercut_modified_involute_sensible_2066", "pinion"),
    "sharp_shaper": ("face_gear_sharp_shaper", "gear"),
    "novikov": ("solid_novikov_sensible_1", "pinion"),
    "beveloid": ("contact_beveloid_edge_1000", "pinion"),
    "ring": ("cutter_internal_16_24", "gear"),
    "rack": ("rack", "rack"),
    "protuberance": ("hob_protuberance", "pinion"),
    "chamfer": (
        {
            "kind": "cylindrical",
            "module": 2,
            "helix_angle": 20,
            "pinion": {
                "teeth": 30,
                "face_width": 20,
                "hob": {"protuberance": 0.2, "stock": 0.1, "chamfer_diameter": 67.5, "chamfer_angle": 38},
            },
            "gear": {"teeth": 41, "face_width": 20},
        },
        "pinion",
    ),
}


@pytest.mark.sweep_cases(
    "novikov", "partly_undercut", "sharp_shaper", "chamfer", "protuberance", "beveloid", "ring", "undercut"
)
@pytest.mark.parametrize("name", ODD)
def test_teeth_stay_closed(name: str) -> None:
    """Links share their ends; flank and fillet stay smooth where they were; the root and the land begin where they did."""
    source, member = ODD[name]
    if isinstance(source, str):
        source = next(path for folder in (CORPUS, SAMPLES) if (path := folder / f"{source}.toml").exists())
    gears = gm.build(gm.load(source) if isinstance(source, Path) else gm.parse(source))
    before = gears.member(member)
    grids = {
        side: DeviationGrid.of(before.tooth, side, min(1.0, before.tooth.height / 10.0) * noisy(before.tooth, side))
        for side in Side
    }
    t = np.linspace(0.0, 1.0, 9)
    chains = []
    for tooth in (before.tooth, with_deviations(before, grids).tooth):
        sections = tooth.sections(t)
        chains.append([tooth.grid(region, [0.0, 1.0], sections) for region in tooth.regions])
    for old, link, new, after in zip(*(x for chain in chains for x in (chain[:-1], chain[1:])), strict=True):
        # (old, link): neighbours before; (new, after): the same ones with deviations
        np.testing.assert_allclose(new.points[-1], after.points[0], atol=1e-9)
        was, now = (np.abs(a.normals[-1] - b.normals[0]).max() for a, b in ((old, link), (new, after)))
        assert now < 1e-9 or was > 1e-4
    nominal, real = chains
    fillets = [k for k, region in enumerate(before.tooth.regions) if region in FILLET_REGIONS.values()]
    for k, end in zip(fillets, (0, -1), strict=True):
        np.testing.assert_allclose(real[k].points[end], nominal[k].points[end], atol=1e-12)
    flanks = [k for k, region in enumerate(before.tooth.regions) if region in FLANK_REGIONS.values()]
    assert all(np.abs(real[k].points - nominal[k].points).max() > 1e-3 for k in flanks)


@pytest.mark.sweep
def test_the_tip_edge_of_a_chamfered_flank_is_where_the_chamfer_begins() -> None:
    """At every station at another radius: the contact solver knows, to 0.1 um between the stations whose points it takes."""
    gears = gm.build(gm.parse(ODD["chamfer"][0]))
    member = gears.with_deviations("pinion", "right", noisy(gears.member("pinion").tooth, Side.RIGHT)).member("pinion")
    tips = member.tooth.flank_grid("right", [1.0], FINE).points
    assert np.ptp(np.hypot(tips[..., 0], tips[..., 1])) > 0.01
    np.testing.assert_allclose(contact_flank(member, Side.RIGHT).edges["tip"].value(tips), 0.0, atol=1e-4)


@pytest.mark.sweep
def test_the_roll_test_finds_the_contact_of_a_flank_with_deviations(bevel: Pair) -> None:
    """Meshes of the flanks, rolled without the solver, agree with it as `check` judges them; the solid is closed."""
    contact = bevel.real.contact(cycle=False)
    nominal = bevel.nominal.contact(contact.path.phi1 * 180.0 / np.pi, cycle=False)
    assert np.abs(contact.path.te - nominal.path.te).max() > 5e-5
    verdicts = bevel.real.roll(contact).verdicts
    assert verdicts
    assert all(verdict.ok for verdict in verdicts), verdicts
    assert not bevel.real.solid("pinion", 0.02).complaints


def test_what_is_no_grid_of_deviations_is_refused() -> None:
    gears = sample("spiral_bevel_basic")
    flat = np.zeros((5, 9))
    for values, places, said in (
        (flat[0], {}, "rows and columns"),
        (flat + np.nan, {}, "finite"),
        (flat, {"s": np.linspace(0.0, 1.1, 5)}, "ascending"),
        (flat, {"t": np.linspace(0.9, 0.1, 9)}, "ascending"),
        (1e3 * noisy(gears.member("pinion").tooth, Side.RIGHT), {}, "deviations"),
        (flat + 0.06 * (-1.0) ** np.arange(5)[:, None], {}, "lean"),
    ):
        with pytest.raises(DesignError, match=said):
            gears.with_deviations("pinion", "right", values, **places)
    with pytest.raises(DesignError, match="one of right, left"):
        gears.with_deviations("pinion", "concave", flat)
    with pytest.raises(DesignError, match="linear relief"):
        sample("spur_relieved", "pinion.modifications.tip_relief.shape=linear").with_deviations("pinion", "right", flat)


def test_diagrams_of_modifications_are_of_both_flanks_or_none() -> None:
    gears = sample("spur_relieved")
    real = gears.with_deviations("pinion", "right", np.full((2, 2), 0.001))
    assert [is_modified(each.member("pinion")) for each in (gears, real)] == [True, False]
    assert is_modified(real.member("gear"))


def test_pairs_are_alike_if_both_or_neither_have_the_member() -> None:
    train = sample("planetary").train
    planet, sun = train.members["planet_1"], train.members["sun"]
    assert len(train.different) == 2
    assert len(train.with_member(planet).different) == 4
    assert len(train.with_member(sun).different) == 2
    assert train.with_member(sun).members == train.members
