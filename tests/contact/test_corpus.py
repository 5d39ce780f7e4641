"""Random designs whose contact was once wrong: another place touched first, or none was found where the flanks meet."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.examples import some

import gearmesh as gm
from gearmesh import GearPair, load
from gearmesh.check.members import roll_flanks, roll_members
from gearmesh.contact.conditions.refinement import Contacts, Trial, refine_candidates
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.fit.fit import fit, reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC

CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("contact_*.toml"))
CYCLES = sorted((Path(__file__).parents[1] / "corpus").glob("cycle_*.toml"))
PEAKS = sorted((Path(__file__).parents[1] / "corpus").glob("peak_*.toml"))
NODES = sorted((Path(__file__).parents[1] / "corpus").glob("nodes_*.toml"))
SHEETS = sorted((Path(__file__).parents[1] / "corpus").glob("sheet_*.toml"))
OVERLAPS = sorted((Path(__file__).parents[1] / "corpus").glob("overlap_*.toml"))
BACKLASHES = sorted((Path(__file__).parents[1] / "corpus").glob("backlash_*.toml"))


@cache
def wide() -> GearPair:
    """A pair whose teeth wind round their axis."""
    return pair_of(load(CORPUS[0].with_name("wide_circular_arc_edge_2050.toml")))


@pytest.mark.sweep_cases(
    "contact_spiral_bevel_edge_15",
    "contact_spiral_bevel_sensible_15",
    "contact_circular_arc_edge_214",
    "contact_beveloid_sensible_0",
    "contact_beveloid_edge_6",
    "contact_beveloid_edge_17",
    "contact_beveloid_edge_18",
    "contact_spiral_bevel_conjugate_edge_15",
    "contact_worm_drive_concave_four",
    "contact_worm_drive_inch_single_za",
    "contact_worm_drive_zi_errors",
    "contact_worm_drive_zn_100deg",
    "contact_beveloid_edge_8",
    "contact_circular_arc_edge_2021",
    "contact_circular_arc_sensible_10",
    "contact_face_gear_sensible_1",
    "contact_spiral_bevel_conjugate_edge_17",
    "contact_spiral_bevel_conjugate_edge_2",
    "contact_worm_drive_helical_left_82",
    "contact_worm_drive_left_six_zk",
)
@pytest.mark.parametrize("file", CORPUS, ids=lambda file: file.stem)
def test_the_flanks_touch_where_they_roll(file: Path) -> None:
    pair = pair_of(load(file))
    phi1 = np.array([-0.45, -0.25, -0.1, 0.3, 0.5]) * pair.pitch
    found = contact_path(solver_pair(pair).parts[0], phi1)
    rolled = roll_flanks(pair, phi1, 60, found.phi2)
    assert found.touching.tolist() == [each is not None for each in rolled]
    apart = [abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each is not None]
    assert len(apart) >= 3
    assert max(apart) < 0.05 * ARCSEC


@pytest.mark.sweep
def test_a_contact_far_narrower_than_the_cells_of_the_grid_is_found() -> None:
    """A wide circular-arc pair: the advance falls by 1,500 arcsec between sampled columns, seven pairs touch at once."""
    pair = pair_of(load(CORPUS[0].with_name("contact_circular_arc_edge_214.toml")))
    phi1 = np.radians([-57.0, -56.0, -50.0, -41.0, 25.0, 26.0, 55.0, 56.0, 57.0])
    found = contact_path(solver_pair(pair).parts[0], phi1)
    rolled = roll_flanks(pair, found.rotation, 96, found.phi2)
    assert found.kind.tolist() == ["edge"] * 2 + ["point"] * 7
    assert max(abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each) < 0.05 * ARCSEC
    assert all(rolled)
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    # the place of contact wanders along the face
    overlap = 116.0 * np.cos(np.radians(50.791)) / (3.105 * np.pi)
    assert overlap - 0.005 < cycle.contact_ratio < overlap


@pytest.mark.sweep
@pytest.mark.sweep_cases("sheet_face_gear_edge_2067")
@pytest.mark.parametrize("file", SHEETS, ids=lambda file: file.stem)
def test_what_the_tool_generates_twice_touches_once(file: Path) -> None:
    """Aligned face gears turn evenly and without backlash, which a contact on another sheet of a surface would take from them."""
    pair = pair_of(load(file))
    found = fit(pair)
    assert found is not None
    assert np.abs(found.normal_backlash).max() < 1e-6
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    assert cycle.peak_to_peak < 1e-3 * ARCSEC


@pytest.mark.sweep
def test_sampling_of_a_wide_face_is_as_fine_as_the_tooth_height() -> None:
    pair = wide()
    found = contact_path(solver_pair(pair).parts[0], np.radians([46.726, 47.0]))
    rolled = roll_flanks(pair, found.rotation, 120, found.phi2)
    assert found.kind.tolist() == ["point"] * 2
    assert max(abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each) < 0.05 * ARCSEC
    assert all(rolled)


@pytest.mark.sweep
def test_wound_teeth_meet_as_another_pair_a_turn_later() -> None:
    """The same wide pair: its teeth touch again a turn on, seven pitches of the gear from where they belong."""
    pair = wide()
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    begin, end = cycle.engagement
    # the screw motion of the pair makes the whole of its contact that of the surfaces
    assert (end - begin) / pair.pitch == pytest.approx(cycle.contact_ratio, abs=1e-9)
    assert cycle.contact_ratio * pair.pitch > 2.0 * np.pi
    assert cycle.curve is not None
    phi2 = pair.ratio * 0.3 + pair.drive * float(cycle.curve.advance(np.array([0.3]))[0])
    (rolled,) = roll_members(pair, 0.3, coast=False)
    assert rolled.drive is not None
    assert abs(rolled.drive.phi2 - phi2) < 0.05 * ARCSEC


@pytest.mark.sweep
def test_rest_of_a_line_beside_a_crossing_of_edges_leads() -> None:
    """A helical pair whose gear is undercut: the advance rises 2 arcsec from its form point at the pinion's end to the line."""
    pair = pair_of(load(CORPUS[0].with_name("line_cylindrical_undercut.toml")))
    phi1 = np.array([-0.0875, -0.0873])
    found = contact_path(solver_pair(pair), phi1)
    rolled = roll_flanks(pair, phi1, 96, found.phi2)
    assert found.kind.tolist() == ["line"] * 2
    assert all(rolled)
    assert max(abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each) < 1e-4 * ARCSEC


@pytest.mark.sweep
def test_flanks_that_overlap_by_less_than_a_cell_of_the_grid_touch() -> None:
    """Long before its turn a corner of the gear's flank comes to the pinion's: nothing else of the two overlaps."""
    pair = pair_of(load(CORPUS[0].with_name("contact_beveloid_sensible_0.toml")))
    phi1 = np.array([-31.0, -30.0, -29.0]) / 24.0 * pair.pitch
    found = contact_path(solver_pair(pair).parts[0], phi1)
    rolled = roll_flanks(pair, phi1, 48, found.phi2)
    assert found.edge.tolist() == ["gear_tip+gear_toe"] * 3
    assert max(abs(each.phi2 - phi2) for each, phi2 in zip(rolled, found.phi2, strict=True) if each) < 0.05 * ARCSEC
    assert all(rolled)


@pytest.mark.sweep
@pytest.mark.parametrize("file", some(CYCLES, 1), ids=lambda file: file.stem)
def test_the_gears_have_a_whole_cycle(file: Path) -> None:
    """The gears stand where whole members roll to, and peak to peak is that of the curve."""
    pair = pair_of(load(file))
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    assert cycle.curve is not None
    phi1 = 0.3 * pair.pitch
    phi2 = float(pair.ratio * phi1 + pair.drive * cycle.curve.advance(np.array([phi1]))[0])
    rolled = roll_members(pair, phi1, guess_phi2=phi2, coast=False)[0]
    assert rolled.drive is not None
    assert abs(rolled.drive.phi2 - phi2) < 0.05 * ARCSEC
    sampled = np.ptp(cycle.curve.advance(np.linspace(0.0, pair.pitch, 500)))
    assert 0.0 <= cycle.peak_to_peak - sampled < 0.01 * sampled


@pytest.mark.sweep
@pytest.mark.sweep_cases("peak_cylindrical_profile_crowning")
@pytest.mark.parametrize("file", PEAKS, ids=lambda file: file.stem)
def test_what_leads_between_nodes_counts_in_peak_to_peak(file: Path) -> None:
    """Against all tooth pairs solved at even phases, each over the whole of its flanks."""
    pair = pair_of(load(file))
    flanks = solver_pair(pair)
    cycle = mesh_cycle(flanks, pair.pitch)
    assert cycle is not None
    phase = np.linspace(0.0, pair.pitch, 150)
    sampled = np.ptp(np.max([first_touch(flanks, phase + k * pair.pitch).advance for k in (-2, -1, 0)], axis=0))
    assert 0.0 <= cycle.peak_to_peak - sampled < 0.015 * sampled


@pytest.mark.sweep
@pytest.mark.sweep_cases("backlash_beveloid_edge_2093")
@pytest.mark.parametrize("file", BACKLASHES, ids=lambda file: file.stem)
def test_no_position_has_less_backlash_than_the_least(file: Path) -> None:
    pair = pair_of(load(file))
    curves = [mesh_cycle(solver_pair(each), pair.pitch).curve for each in (pair, reversed_pair(pair))]
    found = fit(pair, curves[0])
    assert found is not None
    play = -sum(curve.advance(np.linspace(0.0, pair.pitch, 500)) for curve in curves)
    least, most = np.array(found.backlash) - (play.min(), play.max())
    step = 2.0 * np.pi / pair.gear.tooth.teeth
    least, most = (np.array([least, most]) + 0.5 * step) % step - 0.5 * step
    assert -0.01 * ARCSEC < least < 1e-12
    assert -1e-12 < most < 1.0 * ARCSEC


@pytest.mark.sweep
@pytest.mark.sweep_cases("nodes_novikov_sensible_205", "nodes_face_gear_edge_202")
@pytest.mark.parametrize("file", NODES, ids=lambda file: file.stem)
def test_no_contact_leads_where_it_is_followed_to(file: Path) -> None:
    """The contact of each node, followed to the next on either side, is not ahead of what touches first there."""
    pair = pair_of(load(file))
    flanks = solver_pair(pair)
    engagement = whole_engagement(flanks, pair.pitch)
    assert engagement is not None
    phi1, own = engagement.phi1, engagement.contacts
    assert own.touching.all()
    known = np.flatnonzero(~np.isnan(engagement.rates[:, 0]))
    ahead = []
    for step in (-1, 1):
        node = known[(known + step >= 0) & (known + step < len(phi1))]
        there = Contacts.nothing(len(phi1))
        x = own.x[node] + (phi1[node + step] - phi1[node])[:, None] * engagement.rates[node]
        for number, part in flanks.parts.items():
            some = own.part[node] == number
            refine_candidates(part, phi1, Trial.of(node[some] + step, x[some], own.edges[node[some]]), there, number)
        ahead.append(there.advance - own.advance)
    assert np.isfinite(ahead).sum() > len(phi1)
    assert np.max(ahead) < 0.01 * ARCSEC


@pytest.mark.sweep
def test_a_corner_of_the_advance_is_no_level_place() -> None:
    """At a form point the slope of the advance jumps: its change of sign is no root."""
    pair = pair_of(load(CORPUS[0].with_name("corner_face_gear_edge_1005.toml")))
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    assert np.isfinite(cycle.peak_to_peak)
    assert np.isfinite(cycle.harmonics).all()


@pytest.mark.sweep
@pytest.mark.sweep_cases("3011")
@pytest.mark.parametrize("seed", [3007, 3011])
def test_teeth_that_meet_again_a_turn_later_are_another_pair(seed: int) -> None:
    pair = pair_of(load(CORPUS[0].with_name(f"turn_cylindrical_edge_{seed}.toml")))
    followed = whole_engagement(solver_pair(pair), pair.pitch)
    assert followed is not None
    assert np.abs(followed.phi1).max() < np.pi
    (rolled,) = roll_members(pair, 0.0, 20, coast=False)
    cycle = mesh_cycle(solver_pair(pair), pair.pitch, followed)
    assert cycle is not None
    assert cycle.curve is not None
    led = pair.drive * float(cycle.curve.advance(np.zeros(1))[0])
    assert rolled.drive is not None
    step = 2.0 * np.pi / pair.gear.tooth.teeth
    apart = (rolled.drive.phi2 - led + 0.5 * step) % step - 0.5 * step
    assert abs(apart) < 0.1 * ARCSEC


@pytest.mark.sweep
def test_takeover_goes_to_the_pair_already_in_contact() -> None:
    """Sun and planet without errors: no phase at which the gears lag behind their line contact."""
    pair = gm.build(load(CORPUS[0].with_name("together_planetary_edge_3021.toml"))).pairs[0]
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    assert cycle.peak_to_peak < 1e-6 * ARCSEC
    assert np.ptp(cycle.curve.advance(np.linspace(0.0, pair.pitch, 200))) < 1e-6 * ARCSEC


@pytest.mark.sweep
@pytest.mark.sweep_cases(
    "overlap_beveloid_twenty_windings",
    "overlap_beveloid_five_teeth_wide",
    "overlap_beveloid_three_teeth",
    "overlap_beveloid_one_tooth",
)
@pytest.mark.parametrize("file", OVERLAPS, ids=lambda file: file.stem)
def test_the_overlap_ratio_of_few_teeth_is_the_closed_form(file: Path) -> None:
    """b sin(beta) / (pi m_n) of the narrower face [ISO 21771]: such teeth go far round their axis along it."""
    design = load(file)
    cycle = mesh_cycle(solver_pair(pair := pair_of(design)), pair.pitch)
    assert cycle is not None
    face = min(design.pinion.face_width, design.gear.face_width)
    overlap = face * np.sin(np.radians(abs(design.pinion.helix_angle))) / (np.pi * design.module)
    assert cycle.overlap_ratio == pytest.approx(overlap, abs=1e-9)
    # involute helicoids are conjugate, on whichever winding they touch
    assert cycle.peak_to_peak < 1e-10
    assert cycle.transverse_ratio > 0.0
    assert cycle.transverse_ratio + cycle.overlap_ratio == pytest.approx(cycle.contact_ratio, abs=1e-12)
