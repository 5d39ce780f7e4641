"""Worms that grind face gears: the thread against a shaper that is really moved, the ground gear against the closed form."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.curvature import undercut_indicator
from oracles.places import SAMPLES

from gearmesh import DesignError, Member, load
from gearmesh.check.deviation import deviations
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region, Side
from gearmesh.mesh.patch import LinkNodes
from gearmesh.mesh.solid import gear_solid
from gearmesh.mesh.tessellate import tessellate
from gearmesh.systems import system
from gearmesh.systems.face_gear.grinding import Grinding
from gearmesh.systems.face_gear.worm_thread import grinding_in_place

KAPPA, THETA = np.radians(np.linspace(4.0, 50.0, 6))[:, None], np.linspace(0.2, 0.65, 5)


def design(*overrides: str, sample: str = "face_gear") -> Any:
    return system.complete_design(load(SAMPLES / f"{sample}.toml", list(overrides))).in_mm()


def grinding(*overrides: str, sample: str = "face_gear") -> Grinding:
    return grinding_in_place(design(*overrides, sample=sample))


def outside(found: Grinding, r: Array, psi: Array) -> Array:
    """Distance (mm), > 0 outside, of points (..., 3) of the worm's frame from the involute of the shaper turned by psi (...,).

    Written out: the worm is turned back, put where it stands, and the shaper turned back in its own frame. Both flanks of the
    shaper's nearest tooth bound it.
    """
    worm, shaper = found.worm, found.worm.shaper
    c, s = np.cos(worm.turn * psi), np.sin(worm.turn * psi)
    x, y, z = r[..., 0] * c - r[..., 1] * s, r[..., 0] * s + r[..., 1] * c, r[..., 2]
    lead = worm.hand * np.arcsin(0.5 * worm.threads * shaper.module / worm.radius)
    fixed_x, fixed_y = x + shaper.pitch_radius - worm.radius, -np.sin(lead) * y + np.cos(lead) * z
    radius, angle = np.hypot(fixed_x, fixed_y), np.arctan2(fixed_y, fixed_x) - psi
    pitch = 2.0 * np.pi / shaper.teeth
    beside = np.abs(angle - pitch * np.round(angle / pitch))
    # below the base circle all is metal
    theta = np.sqrt(np.maximum((radius / shaper.base_radius) ** 2 - 1.0, 0.0))
    away: Array = shaper.base_radius * (shaper.theta_0 + theta - np.arctan(theta) - beside)
    return np.where(theta > 0.0, away, -np.inf)


@pytest.mark.parametrize(
    "overrides", [(), ("worm.threads=2", "worm.right_hand=false", "worm.pitch_radius=130")], ids=" ".join
)
def test_thread_touches_the_shaper_and_stays_inside_it(overrides: tuple[str, ...]) -> None:
    """Points of the thread, in all positions of the shaper about the one that generates them: no equation of meshing."""
    found = grinding(*overrides)
    for side in Side:
        worm = found.own(side)[1]
        thread = found.worm.thread(found.worm.shaper.involute, side.sign)
        theta, z = np.broadcast_arrays(THETA, worm.along(KAPPA))
        points = thread.jet(theta, z).r.reshape(-1, 1, 3)
        psi = side.sign * (KAPPA - THETA - found.worm.shaper.theta_0).reshape(-1, 1)
        away = outside(found, points, psi + np.linspace(-0.004, 0.004, 81))
        # in the metal of the shaper's tooth, which is beyond its flank
        assert away.max() < 1e-9
        np.testing.assert_allclose(outside(found, points, psi), 0.0, rtol=0, atol=1e-9)
        assert (away[:, [0, -1]] < -1e-7).all()


def test_singularity_is_that_of_the_envelope_and_bounds_the_thread() -> None:
    found = grinding("worm.pitch_radius=120")
    flank = found.worm.thread(found.worm.shaper.involute, 1)
    theta, z = np.broadcast_arrays(THETA, found.worm.along(KAPPA))
    closed = found.worm.singularity(THETA, KAPPA)
    np.testing.assert_allclose(closed, undercut_indicator(flank, theta, z), rtol=1e-10)
    bound = found.worm.singular_kappa(THETA)
    assert (bound > np.radians(0.3)).all()
    for factor, sign in ((1.0 - 1e-6, 1.0), (1.0 + 1e-6, -1.0)):
        at = undercut_indicator(flank, THETA, found.worm.along(factor * bound))
        assert (sign * at > 0.0).all()


@pytest.mark.parametrize(
    ("sample", "overrides"),
    [
        ("face_gear", ()),
        ("face_gear_offset", ("worm.threads=2", "worm.right_hand=false")),
        ("face_gear", ("shaft_angle=70", "offset=-60", "worm.pitch_radius=300")),
    ],
)
def test_fed_along_the_shaper_the_worm_grinds_the_shaped_flank(sample: str, overrides: tuple[str, ...]) -> None:
    """The envelope of roll and feed, nested in that of the shaper, against the closed form of the shaped flank."""
    found = grinding(*overrides, sample=sample)
    feed = np.linspace(-35.0, 45.0, 7)[:, None]
    for side in Side:
        gear, worm = found.own(side)
        ground = found.flank(side).generation(np.broadcast_to(THETA, (7, 5)), feed)
        assert ground.solution.converged.all()
        points = ground.state.tool_to_blank.point(ground.tool.r)
        z = found.place + feed + ground.v
        expected = gear.point(np.broadcast_to(THETA, z.shape), z) * [1.0, side.sign, 1.0]
        c, s = np.cos(found.shaped.lean(found.place)), np.sin(found.shaped.lean(found.place))
        turned = expected @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        np.testing.assert_allclose(points, turned, rtol=0, atol=1e-9)
        assert (gear.pressure_angle(z) > worm.singular_kappa(THETA)).all()


@pytest.mark.sweep
def test_worm_is_a_closed_body_whose_sections_are_whole() -> None:
    part = system.worm(load(SAMPLES / "face_gear.toml", ["worm.bore=200", "worm.threads=2"]))
    assert isinstance(part.member, Member)
    tooth = part.member.tooth
    mesh = gear_solid(part.member, 0.5)
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    # chords with a sag of 0.5 mm on a radius of 180 mm lose 0.4 %
    assert volume == pytest.approx(tooth.volume(48), rel=4e-3)
    edges = np.sort(np.concatenate([mesh.triangles[:, [k, (k + 1) % 3]] for k in range(3)]), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    # a ring: V - E + F = 0
    assert len(mesh.vertices) - len(edges) // 2 + len(mesh.triangles) == 0
    assert part.figures["ground_from_shaped_um"] < 1e-6
    assert part.figures["length_mm"] >= part.figures["needed_length_mm"]
    # crests by (q, Z), not (q, y), were 17 mm off: Z is far from even across them
    assert max(each.largest for each in deviations(tessellate(tooth, 0.5)).values()) < 0.5
    # the thread is as high as the shaper's tooth in the middle, less towards the ends
    rho = np.hypot(mesh.vertices[:, 0], mesh.vertices[:, 1])
    shaper = grinding("worm.threads=2").worm.shaper
    assert rho.max() == pytest.approx(2.0 * shaper.pitch_radius + shaper.addendum, abs=1e-2)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (
            ["worm.pitch_radius=80"],
            "worm.pitch_radius = 80 mm: must be more than the shaper's pitch radius and threads m / 2, 88.9",
        ),
        (["worm.length=190"], "worm.length = 190 mm: the thread has singular points there; allowed is at most 161."),
        (["worm.bore=500"], "worm.bore = 500 mm"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
@pytest.mark.sweep_cases("worm.bore=500-", "worm.length=190-")
def test_refusals_name_key_value_and_limit(overrides: list[str], words: str) -> None:
    with pytest.raises(DesignError) as failure:
        system.worm(load(SAMPLES / "face_gear.toml", overrides))
    assert words in str(failure.value)


def test_single_thread_root_is_wider_than_half_a_turn_at_ends() -> None:
    """Seen across the worm; it was refused as a root that fillets overlap in."""
    tooth = system.worm(load(SAMPLES / "face_gear.toml")).member.tooth
    ends = tooth.sections([0.0, 0.5, 1.0])
    width = np.degrees(ends.right.root_angle - ends.left.root_angle) + 360.0
    # the ends are alike, and the thread is thinner there
    assert width[0] == pytest.approx(width[2], abs=1e-6)
    assert 180.0 < width[0] < 270.0
    assert width[1] < 120.0


def test_root_of_the_worm_takes_one_strip_whose_diagonals_are_its_rulings() -> None:
    """Its width varies over four turns: diagonals that followed slopes taken straight between samples missed it by 860 um."""
    tooth = system.worm(load(SAMPLES / "face_gear.toml")).member.tooth
    root = tessellate(tooth, 0.02, (Region.ROOT,))
    (patch,) = root.patches
    assert np.unique(patch.nodes.s[(patch.nodes.t > 0.0) & (patch.nodes.t < 1.0)]).size == 2
    assert root.deviation < 0.02
    # the middles of all edges, by closed form: it is a cylinder
    points = patch.points[patch.triangles]
    middles = 0.5 * (points + points[:, [1, 2, 0]])
    radius = np.hypot(*np.moveaxis(points, -1, 0)[:2]).max()
    assert radius - np.hypot(*np.moveaxis(middles, -1, 0)[:2]).min() < 0.02


@pytest.mark.sweep
def test_links_that_end_alike_everywhere_are_measured_without_trimming(monkeypatch: pytest.MonkeyPatch) -> None:
    """The thread of a worm without undercut: points over its facets are those of trimmed stations."""
    mesh = tessellate(
        system.worm(load(SAMPLES / "face_gear.toml")).member.tooth, 0.1, (Region.FLANK_RIGHT, Region.ROOT)
    )
    places = np.array([[0.2, 0.3, 0.5], [0.6, 0.3, 0.1]])
    found = []
    for patch, constant in zip(
        mesh.patches, (patch.region is Region.FLANK_RIGHT for patch in mesh.patches), strict=True
    ):
        assert (patch.nodes._constant_span is not None) == constant
        found.append(patch.nodes.over(patch.triangles[::40], places))
    monkeypatch.setattr(LinkNodes, "_constant_span", None)
    for patch, points in zip(mesh.patches, found, strict=True):
        trimmed = replace(patch.nodes).over(patch.triangles[::40], places)
        np.testing.assert_allclose(points, trimmed, rtol=0.0, atol=1e-12)
