"""The roll test of meshes against the solver, and the whole mesh cycle against ISO 21771."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, load
from gearmesh.answers import check
from gearmesh.answers.check import flank_meshes
from gearmesh.check.roll import RollContact, roll
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.mesh.triangles import TriangleMesh

CORPUS = Path(__file__).parents[1] / "corpus"
OFFSET = ["assembly.dx=0.3", "assembly.dy=0.3", "assembly.dz=0.3"]
CASES = {4: [], 6: [*OFFSET, "assembly.gamma_h=0.5", "assembly.gamma_v=-0.5"]}
PHI1 = np.radians([-6.0, 0.0, 6.0])


@cache
def case(number: int) -> tuple[GearPair, ContactPath]:
    gears = pair_of(load(SAMPLES / "beveloid_crossed.toml", CASES[number]))
    return gears, analyse(gears, PHI1)


@cache
def rolled(number: int, tolerance: float) -> tuple[RollContact, ...]:
    gears, path = case(number)
    pinion, gear = flank_meshes(gears, tolerance)
    return roll(pinion, gear, gears.mounts, gears.ratio, path.rotation, gears.drive, gears.delta, path.phi2)


@pytest.mark.sweep
@pytest.mark.sweep_cases("6")
@pytest.mark.parametrize("number", CASES)
def test_meshes_touch_where_the_solver_says(number: int) -> None:
    """[LT02] cases 4 and 6 with facets within 0.1 um, of which each is worth about 0.2 arcsec at a radius of 90 mm."""
    _, path = case(number)
    for k, found in enumerate(rolled(number, 1e-4)):
        assert abs(found.phi2 - path.phi2[k]) < 1.0 * ARCSEC
        assert not found.cut_by_edge
        np.testing.assert_allclose(found.semi_major, path.semi_major[k], rtol=0.03)
        np.testing.assert_allclose(found.semi_minor, path.semi_minor[k], rtol=0.03)
        assert abs(found.major @ path.major[k]) > np.cos(np.radians(1.0))
        assert np.linalg.norm(found.centre_limit - path.point[k]) < 0.020


@pytest.mark.sweep
def test_te_error_shrinks_with_the_tolerance() -> None:
    _, path = case(4)
    tolerances = np.array([1e-2, 1e-3, 1e-4])
    errors = [max(abs(f.phi2 - p) for f, p in zip(rolled(4, float(t)), path.phi2, strict=True)) for t in tolerances]
    # a facet lies off the surface by at most its tolerance, which both members' facets may spend
    radius = 0.5 * 36 * 5.0
    assert (np.array(errors) < 2.5 * tolerances / (radius * np.cos(np.radians(20.0)))).all()
    assert 0.7 < np.polyfit(np.log(tolerances), np.log(errors), 1)[0] < 1.4


@pytest.mark.sweep
def test_dense_exact_grids_agree_to_a_twentieth_of_an_arc_second() -> None:
    gears, path = case(6)
    s, t = np.linspace(0.0, 1.0, 81), np.linspace(0.0, 1.0, 81)
    grids = [
        member.tooth.flank_grid(side, s, t).points
        for member, side in zip((gears.pinion, gears.gear), gears.flanks, strict=True)
    ]
    differences = []
    for delta in (0.00635, 0.00635 / 4, 0.00635 / 16):
        contacts = roll(*grids, gears.mounts, gears.ratio, path.rotation, gears.drive, delta, path.phi2)
        scale = np.sqrt(delta / gears.delta)
        for k, found in enumerate(contacts):
            assert abs(found.phi2 - path.phi2[k]) < 0.05 * ARCSEC
        ratios = [
            (f.semi_major / path.semi_major[k] / scale, f.semi_minor / path.semi_minor[k] / scale)
            for k, f in enumerate(contacts)
        ]
        differences.append(np.abs(np.array(ratios) - 1.0).max())
    # the ellipse is the second-order term of the gap; the next that changes the axes is smaller by delta
    order = np.polyfit(np.log([1.0, 1 / 4, 1 / 16]), np.log(differences), 1)[0]
    assert 0.75 < order < 1.25
    assert differences[-1] < 1e-3


def iso_contact_ratio(design_name: str) -> float:
    """eps_alpha + eps_beta of an external pair [ISO 21771], from its design file."""
    design = load(SAMPLES / f"{design_name}.toml")
    gears = pair_of(design)
    helix, alpha = np.radians(design.helix_angle), np.radians(design.pressure_angle)  # type: ignore[attr-defined]
    transverse = np.arctan(np.tan(alpha) / np.cos(helix))
    module = design.given_module
    centre = float(np.linalg.norm(gears.gear.mount.origin[:2]))
    length, base = 0.0, []
    for member in gears.members.values():
        reference = 0.5 * member.tooth.teeth * module / np.cos(helix)
        base.append(reference * np.cos(transverse))
        length += np.sqrt(member.tooth.blank.tip.radius**2 - base[-1] ** 2)
    working = np.arccos(sum(base) / centre)
    length -= centre * np.sin(working)
    face = min(design.pinion.face_width, design.gear.face_width)
    overlap = face * np.sin(helix) / (np.pi * module)
    return float(length / (np.pi * module / np.cos(helix) * np.cos(transverse)) + overlap)


@pytest.mark.parametrize("name", ["spur", "helical"])
@pytest.mark.sweep_cases("helical")
def test_contact_ratio_is_that_of_iso_21771(name: str) -> None:
    gears = pair_of(load(SAMPLES / f"{name}.toml"))
    cycle = mesh_cycle(solver_pair(gears), gears.pitch)
    assert cycle is not None
    assert abs(cycle.contact_ratio - iso_contact_ratio(name)) < 1e-3
    # conjugate: no transmission error at all, by a tooth pair or by the gears
    assert cycle.peak_to_peak < 1e-6 * ARCSEC


@pytest.mark.quick
def test_beyond_the_path_tips_take_over() -> None:
    gears = pair_of(load(SAMPLES / "spur.toml"))
    pitch = gears.pitch
    path = contact_path(solver_pair(gears), np.array([-0.95, 0.95]) * pitch)
    assert path.kind.tolist() == ["edge", "edge"]
    assert sorted(path.edge.tolist()) == ["gear_tip", "pinion_tip"]
    # and the pair that has left its path lags behind: another one carries
    assert (path.te < -10.0 * ARCSEC).all()


@pytest.mark.sweep
def test_misaligned_line_contact_gives_a_cycle_with_harmonics() -> None:
    gears = pair_of(load(SAMPLES / "spur.toml", ["assembly.gamma_h=0.05"]))
    cycle = mesh_cycle(solver_pair(gears), gears.pitch)
    # without tangency anywhere inside both flanks there is no surface contact to count, but edges carry on
    assert cycle is not None
    assert np.isnan(cycle.contact_ratio)
    assert np.isfinite(cycle.envelope).all()
    # the heel edge is an involute itself, conjugate but for cos(gamma): a slope of 6e-4 arcsec a degree over 18 deg
    assert 0.005 * ARCSEC < cycle.peak_to_peak < 0.02 * ARCSEC
    gears = pair_of(load(SAMPLES / "circular_arc.toml", ["assembly.dgamma=0.1", "contact.count_phi1=rotation"]))
    cycle = mesh_cycle(solver_pair(gears), gears.pitch)
    assert cycle is not None
    te = cycle.te / ARCSEC
    np.testing.assert_array_equal(cycle.envelope / ARCSEC, np.nanmax(te, axis=0))
    # one pair alone falls by 2.994 arcsec a degree ([LT85] Table 1); edge contact of the next softens the hand-over
    slopes = np.diff(cycle.envelope / ARCSEC) / np.degrees(cycle.phi1[1])
    assert (np.abs(slopes + 2.994) < 0.01).sum() > 10
    assert 0.5 * 2.994 * 30.0 < cycle.peak_to_peak / ARCSEC < 2.994 * 30.0
    # harmonics and peak to peak are those of the whole curve, of which 24 places say little and 1,500 enough
    pair, pitch = solver_pair(gears), gears.pitch
    fine = np.arange(-3000, 3000) * (pitch / 1500)
    path = contact_path(pair, fine)
    advance = np.where(path.touching, path.te, -np.inf).reshape(-1, 1500).max(axis=0)
    k = np.arange(1, 6)[:, None]
    sums = np.abs((advance * np.exp(-2j * np.pi * k * np.arange(1500) / 1500)).sum(axis=1)) / 750.0
    np.testing.assert_allclose(cycle.harmonics, sums, rtol=2e-3)
    assert np.ptp(advance) < cycle.peak_to_peak < np.ptp(advance) + 2e-3 * pitch / ARCSEC * ARCSEC


@pytest.mark.sweep
def test_what_a_fillet_carries_is_rolled_with_the_fillet() -> None:
    """Tips on fillets are ahead of the flanks, here by up to 229 arcsec: there exact whole teeth are rolled, and agree far
    within what facets of flanks are allowed; a transmission error that is off by 3 arcsec is seen."""
    gears = gm.build(gm.load(CORPUS / "fillet_cylindrical.toml"))
    mixed, fillets = (gears.contact(phi1, cycle=False) for phi1 in ([-9.0, -7.0, 0.0], [-9.0, -7.0]))
    assert mixed.path.regions[0].tolist() == ["fillet", "fillet", "flank"]
    rows = gears.roll(mixed).rows
    assert [row.rolled for row in rows] == ["flanks", "whole teeth", "whole teeth"]
    assert max(abs(row.te_difference) for row in rows[1:]) < 0.01
    rolled = gears.roll(fillets)
    assert [each.what for each in rolled.verdicts] == ["roll: te_difference_arcsec"]
    assert rolled.verdicts[0].ok
    off = replace(mixed.path, phi2=mixed.path.phi2 + ARCSEC * np.array([3.0, 0.0, 0.0]))
    assert not gears.roll(replace(mixed, path=off)).verdicts[0].ok


@pytest.mark.sweep
def test_facets_of_huge_teeth_are_as_many_as_of_large_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    """Facets of the roll test grow with the teeth: 20 times the module is not 20 times the triangles; their limit grows alike."""
    asked: list[tuple[float, int]] = []

    def meshes(pair: GearPair, tolerance: float) -> tuple[TriangleMesh, TriangleMesh]:
        made = flank_meshes(pair, tolerance)
        asked.append((tolerance, sum(len(mesh.triangles) for mesh in made)))
        return made

    monkeypatch.setattr(check, "flank_meshes", meshes)
    for module in (1.0, 20.0, 400.0):
        members = {name: {"teeth": z, "face_width": 8 * module} for name, z in (("pinion", 20), ("gear", 33))}
        gears = gm.build(gm.parse({"kind": "cylindrical", "module": module, "helix_angle": 12, **members}))
        rolled = gears.roll(gears.contact([0.0], cycle=False))
        (te,) = (each for each in rolled.verdicts if each.what == "roll: te_difference_arcsec")
        assert te.ok
    (_, small), (_, large), (_, huge) = asked
    assert [tolerance for tolerance, _ in asked] == pytest.approx([1e-4, 3e-6 * 45, 3e-6 * 900])
    assert small < large == pytest.approx(huge, rel=0.02)
