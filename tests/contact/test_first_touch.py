"""First touch over the whole of both teeth: against the roll of exact grids, which shares no equation with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.built import pair_of
from oracles.places import SAMPLES

from gearmesh import DesignError, GearPair, Rigid, load
from gearmesh.check.members import roll_flanks, roll_members
from gearmesh.contact.assemblies import many_assemblies
from gearmesh.contact.conditions import refinement
from gearmesh.contact.conditions.refinement import Trial, solve
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.first_touch import field, first_touch
from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, rotation_about

#: designs whose contact was once on a wrong branch, missed, or none: keys, positions in pitches
HARD = {
    "geometry2": ("spiral_bevel_geometry2", ["assembly.d_delta=-0.3"], (-0.8, -0.6, 0.8)),
    "geometry1": ("spiral_bevel_geometry1", ["assembly.d_delta=-0.5"], (-0.8, -0.5)),
    "conjugate face gear": ("face_gear_conjugate", ["assembly.d_gamma=0.05"], (-0.8, -0.2, 0.3)),
    "face gear": ("face_gear", ["assembly.dq=-1"], (0.4, 0.8)),
    "zerol": ("zerol", [], (-0.8, 0.8)),
    "helical": ("helical", ["assembly.gamma_h=0.3"], (-0.8, 0.0, 0.5)),
    "crossed": ("beveloid_crossed", ["assembly.gamma_h=2", "assembly.dx=2"], (0.6, 0.8)),
    "novikov": ("novikov", ["assembly.d_gamma=0.2"], (-0.8, 0.6)),
    "concave": ("spiral_bevel_basic", ["assembly.dV=0.3"], (-0.4, 0.2, 0.7)),
}


def sample(name: str, *keys: str) -> GearPair:
    return pair_of(load(SAMPLES / f"{name}.toml", keys))


@pytest.mark.sweep
@pytest.mark.sweep_cases("novikov", "geometry1", "concave", "crossed")
@pytest.mark.parametrize("case", HARD)
def test_flanks_touch_first_where_the_roll_says(case: str) -> None:
    name, keys, shares = HARD[case]
    gears = sample(name, *keys)
    phi1 = np.array(shares) * gears.pitch
    flanks = solver_pair(gears).parts[0]
    found = contact_path(flanks, phi1)
    rolled = roll_flanks(gears, phi1, 60, found.phi2)
    compared = 0
    for k, other in enumerate(rolled):
        assert (other is not None) == bool(found.touching[k])
        if other is not None and "joint" not in str(found.edge[k]):
            assert abs(other.phi2 - found.phi2[k]) < 0.05 * ARCSEC
            compared += 1
    assert compared >= 1


@pytest.mark.sweep
def test_tips_on_fillets_touch_where_whole_members_do() -> None:
    """A pinion's root that is too shallow for the gear: its fillet touches before the flanks do."""
    gears = sample("face_gear", "pinion.dedendum=1.25", "pinion.tool_tip_radius=0.25")
    phi1 = np.array([-0.27]) * gears.pitch
    found = contact_path(solver_pair(gears), phi1)
    assert (found.kind[0], found.edge[0]) == ("edge", "gear_tip")
    assert [region[0] for region in found.regions] == ["fillet", "flank"]
    alone = contact_path(solver_pair(gears).parts[0], phi1)
    assert gears.drive * (found.phi2[0] - alone.phi2[0]) > 5.0 * ARCSEC
    (rolled,) = roll_members(gears, phi1, 40, found.phi2, coast=False)
    assert rolled.drive is not None
    assert abs(rolled.drive.phi2 - found.phi2[0]) < 0.05 * ARCSEC


def test_many_positions_are_what_each_of_them_is_alone() -> None:
    """Followed from nodes, 3,000 positions at once; some of them solved over the whole of the flanks."""
    gears = sample("spiral_bevel_basic", "assembly.dV=0.05")
    pair = solver_pair(gears)
    phi1 = np.linspace(-0.9, 0.9, 3000) * gears.pitch
    path = contact_path(pair, phi1)
    some = np.arange(7, 3000, 61)
    alone = touches(pair, phi1[some])[0]
    assert path.touching.all()
    np.testing.assert_allclose(path.phi2[some], alone.x[:, 4], rtol=0, atol=1e-12)


def test_many_assemblies_are_what_each_of_them_is_alone() -> None:
    gears = sample("spiral_bevel_basic")
    pair, rng = solver_pair(gears), np.random.default_rng(3)
    first, second = pair.pinion.mount.base, pair.gear.mount.base
    shifts, angles = 0.05 * rng.normal(size=(6, 3)), 0.001 * rng.normal(size=6)
    pinions = Rigid(np.broadcast_to(first.rotation, (6, 3, 3)), first.translation + shifts)
    mating_gears = Rigid(rotation_about("y", angles) @ second.rotation, np.broadcast_to(second.translation, (6, 3)))
    phi1 = np.linspace(-0.5, 0.5, 5) * gears.pitch
    together = many_assemblies(pair, (pinions, mating_gears), phi1)
    for m in range(6):
        bases = (Rigid(each.rotation[m], each.translation[m]) for each in (pinions, mating_gears))
        pinion, gear = (
            replace(flank, mount=replace(flank.mount, base=base))
            for flank, base in zip(pair.flanks, bases, strict=True)
        )
        alone = touches(replace(pair, pinion=pinion, gear=gear), phi1)[0]
        np.testing.assert_allclose(together.advance.reshape(6, 5)[m], alone.advance, rtol=0, atol=1e-12)
    assert np.ptp(together.advance.reshape(6, 5), axis=0).min() > 10.0 * ARCSEC


def test_an_edge_ahead_of_a_summit_is_found_among_many_assemblies() -> None:
    """Zerol pair off its place by some 0.02 mm: an edge is 0.35 arcsec ahead of tangency inside both flanks."""
    pair, rng, count = solver_pair(sample("zerol")), np.random.default_rng(0), 20
    bases = [flank.mount.base for flank in pair.flanks]
    shifts = [rng.normal(scale=0.02, size=(count, 3)) for _ in bases]
    moved = [
        Rigid(np.broadcast_to(base.rotation, (count, 3, 3)), base.translation + shift)
        for base, shift in zip(bases, shifts, strict=True)
    ]
    phi1 = np.linspace(-0.5, 0.5, 21) * pair.pitch
    together = many_assemblies(pair, (moved[0], moved[1]), phi1)
    alone = [Rigid(base.rotation[16:17], base.translation[16:17]) for base in moved]
    single = many_assemblies(pair, (alone[0], alone[1]), phi1[1:2])
    assert together.edges[16 * 21 + 1].tolist() == single.edges[0].tolist() == [1, -1]
    assert together.advance[16 * 21 + 1] == pytest.approx(single.advance[0], abs=1e-12)


def test_positions_with_a_line_of_contact_are_complete_after_one_round(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing of both flanks is ahead of their line: places beside it were solved for in four rounds."""
    rounds = list[int]()

    def counted(pair: Pair, phi1: Array, trial: Trial) -> None:
        rounds.append(len(trial.position))
        solve(pair, phi1, trial)

    monkeypatch.setattr(refinement, "solve", counted)
    pair = solver_pair(sample("helical"))
    contacts, _ = touches(pair, np.linspace(-0.5, 0.5, 21) * pair.pitch)
    assert contacts.line.all()
    assert len([count for count in rounds if count]) == 1


@pytest.mark.sweep
def test_fillets_and_tip_edges_are_sampled_near_contact_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Internal pair off its place, with contact on fillets in a few positions: contact as if sampled everywhere."""
    pair, rng, count = solver_pair(sample("internal")), np.random.default_rng(2), 10
    tilts = rotation_about("x", rng.normal(scale=0.001, size=count))
    placed = [pair.pinion.mount.base, replace(pair.gear.mount.base, rotation=tilts @ pair.gear.mount.base.rotation)]
    moved = [
        Rigid(np.broadcast_to(base.rotation, (count, 3, 3)), base.translation + rng.normal(scale=0.1, size=(count, 3)))
        for base in placed
    ]
    phi1 = np.linspace(-1.3, 1.3, 7) * pair.pitch
    flanks, of_points, sampled = (pair.pinion.surface, pair.gear.surface), field.advances, [0]

    def counted(pair: Pair, phi1: Array, r: Array, n: Array, index: NDArray[np.intp]) -> field.Advances:
        alone = pair.pinion.surface is flanks[0] and pair.gear.surface is flanks[1]
        sampled[-1] += 0 if alone else r.shape[-2] * len(index)
        return of_points(pair, phi1, r, n, index)

    monkeypatch.setattr(field, "advances", counted)
    near = many_assemblies(pair, (moved[0], moved[1]), phi1)
    monkeypatch.setattr(field, "_ahead", lambda pair, phi1, nodes, floor: np.arange(len(nodes.index)))
    sampled.append(0)
    everywhere = many_assemblies(pair, (moved[0], moved[1]), phi1)
    assert set(near.part) > {0}
    np.testing.assert_array_equal(near.part, everywhere.part)
    np.testing.assert_allclose(near.advance, everywhere.advance, rtol=0, atol=1e-12)
    assert sampled[0] < 0.57 * sampled[1]


@pytest.mark.parametrize(
    ("name", "shift"),
    [("spiral_bevel_basic", 0.05), ("zerol", 0.02), ("internal", 0.1), ("circular_arc", 0.1)],
)
@pytest.mark.sweep_cases("internal-0.1", "spiral_bevel_basic-0.05", "zerol-0.02")
def test_places_beside_a_solved_summit_need_no_solution(
    name: str, shift: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The contact of members off their places is that of all places, solved at once from their samples."""
    pair, rng, count = solver_pair(sample(name)), np.random.default_rng(5), 12
    moved = [
        Rigid(
            np.broadcast_to(base.rotation, (count, 3, 3)),
            base.translation + rng.normal(scale=shift, size=(count, 3)),
        )
        for base in (flank.mount.base for flank in pair.flanks)
    ]
    phi1, solved = np.linspace(-1.0, 1.0, 9) * pair.pitch, [0]

    def counted(pair: Pair, phi1: Array, trial: Trial) -> None:
        solved[-1] += len(trial.position)
        solve(pair, phi1, trial)

    monkeypatch.setattr(refinement, "solve", counted)
    few = many_assemblies(pair, (moved[0], moved[1]), phi1)
    monkeypatch.setattr(first_touch, "_priority", lambda pair, places, worth: None)
    monkeypatch.setattr(field, "_may_rise", lambda advance, position, i, j: np.ones(len(position), dtype=bool))
    monkeypatch.setattr(field, "_vertices", lambda advance, position, place: place)
    monkeypatch.setattr(field, "_bends_along", lambda line: np.full(line.shape, np.inf))
    solved.append(0)
    every = many_assemblies(pair, (moved[0], moved[1]), phi1)
    np.testing.assert_array_equal(few.edges, every.edges)
    np.testing.assert_allclose(few.advance, every.advance, rtol=0, atol=1e-12)
    assert solved[0] < 0.9 * solved[1]


def test_a_pair_whose_drive_is_wrong_is_found_out() -> None:
    gears = sample("spur")
    with pytest.raises(DesignError, match="drive = -1"):
        contact_path(replace(solver_pair(gears), drive=-gears.drive), np.zeros(1))


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["novikov", "zerol"])
def test_the_cycle_is_that_of_the_whole_curve(name: str) -> None:
    """Peak to peak, harmonics and the change of teeth from roots, against the curve sampled as densely as tells them apart."""
    gears = sample(name)
    pair, pitch = solver_pair(gears), gears.pitch
    cycle = mesh_cycle(pair, pitch)
    assert cycle is not None
    assert cycle.curve is not None
    count = 2000
    fine = np.arange(-3 * count, 3 * count) * (pitch / count)
    path = contact_path(pair, fine)
    te = np.where(path.touching, path.te, -np.inf if pair.drive > 0 else np.inf)
    envelope = pair.drive * (pair.drive * te).reshape(-1, count).max(axis=0)
    step = np.abs(np.diff(envelope)).max()
    assert 0.0 <= cycle.peak_to_peak - np.ptp(envelope) < step
    spectrum = np.abs(np.fft.rfft(envelope))[1:6] * 2.0 / count
    np.testing.assert_allclose(cycle.harmonics, spectrum, rtol=1e-4, atol=1e-4 * spectrum.max())
    # where teeth change over both pairs are as far
    (over,) = {round(each, 9) for each in cycle.handovers}
    both = np.array([over, over + pitch]) if over < 0.0 else np.array([over, over - pitch])
    assert abs(np.diff(contact_path(pair, both).te)[0]) < 1e-10


def test_the_ends_of_surface_contact_are_on_an_edge() -> None:
    gears = sample("spiral_bevel_basic")
    pair, pitch = solver_pair(gears), gears.pitch
    cycle = mesh_cycle(pair, pitch, whole_engagement(pair, pitch))
    assert cycle is not None
    for end, inwards in zip(cycle.surface, (1.0, -1.0), strict=True):
        kinds = contact_path(pair, end + inwards * np.array([-1e-7, 1e-7])).kind.tolist()
        assert kinds == ["edge", "point"]
