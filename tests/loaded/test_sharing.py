"""Gears under torque against closed forms: Hertz, ISO 6336-1, the ratio of torques, no load, symmetry; and finer grids."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.examples import some
from oracles.loaded import geared
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, LoadedContact, Rigid
from gearmesh.contact.flanks import analyse, separation_curvatures
from gearmesh.contact.hertz import STEEL, contact_modulus, line_contact, point_contact
from gearmesh.errors import Status
from gearmesh.loaded import sharing
from gearmesh.loaded.separation import near_pairs
from gearmesh.loaded.sharing import LoadedMesh, inside, loaded_mesh, reach_of
from gearmesh.teeth.blank.halves import SINGLE_ROW

#: bore and root radii and widths, mm, of the spur sample
DISCS = (10.86, 27.15, 30.0), (22.14, 55.35, 28.0)
MODULUS = contact_modulus(STEEL, STEEL)
ARCSEC = np.pi / 648000.0


def under(torques: list[float], phases: list[float], sample: str, *keys: str) -> LoadedMesh:
    """The mesh of a sample under torques, Nm, at phases of a pitch."""
    pair, bodies = geared(sample, *keys)
    return loaded_mesh(pair, pair.pitch * np.array(phases), 1e3 * np.array(torques), bodies)


def discs(first: int, second: int, module: float, width: float) -> tuple[str, ...]:
    """A pair of standard spur gears as discs of one width, with bores of half the reference diameter."""
    sides = (("pinion", first), ("gear", second))
    each = [
        f"{name}.{key}"
        for name, z in sides
        for key in (f"teeth={z}", f"bore={0.5 * z * module}", f"face_width={width}", "profile_shift=0")
    ]
    return (*each, f"module={module}", f"assembly.center_distance={0.5 * (first + second) * module}", "backlash=0")


@pytest.mark.sweep
@pytest.mark.sweep_cases("25-75-2.0-20.0")
@pytest.mark.parametrize(
    ("first", "second", "module", "width"), some([(20, 40, 3.0, 28.0), (30, 30, 4.0, 30.0), (25, 75, 2.0, 20.0)], 2)
)
def test_stiffness_of_one_pair_is_that_of_iso_6336(first: int, second: int, module: float, width: float) -> None:
    """c' of ISO 6336-1:2019, 8.3, method B, solid discs of steel, 100 N/mm: 10 %. Held at the bore."""
    base = 0.5 * first * module * np.cos(np.radians(20.0))
    # at the pitch point there is one pair
    found = under([0.1 * width * base], [-0.25], "spur", *discs(first, second, module, width))
    (load,) = found.loads
    assert (load.force > 0.0).sum() == 1
    c = 100.0 / (1e3 * found.rotation[0, 0] * base)
    flexible = 0.04723 + 0.15551 / first + 0.25791 / second
    assert c == pytest.approx(0.8 / flexible, rel=0.10)


@pytest.mark.sweep
@pytest.mark.quick
def test_a_symmetric_pair_is_symmetric() -> None:
    """Equal gears at equal distances before and after the pitch point: rotation, loads, stresses of pinion and gear change over."""
    found = under([200.0], [-0.45, -0.32, -0.18, -0.05], "spur", *discs(30, 30, 4.0, 30.0))
    np.testing.assert_allclose(found.rotation[0], found.rotation[0, ::-1], rtol=2e-3)
    np.testing.assert_allclose(found.root_stress[0], found.root_stress[0, ::-1, ::-1], rtol=5e-3)


@pytest.mark.sweep
def test_positions_are_solved_as_if_alone() -> None:
    """Positions whose grids did not fit are solved again among others that did: pressures, forces, stresses as alone."""
    phases = [0.1, 0.3, 0.45]
    together = under([300.0], phases, "helical")
    for k, phase in enumerate(phases):
        alone = under([300.0], [phase], "helical")
        for name in ("rotation", "tangent", "gear_torque", "root_stress", "tangent_stress"):
            np.testing.assert_allclose(
                getattr(together, name)[:, k], getattr(alone, name)[:, 0], rtol=1e-5, err_msg=name
            )
        (whole,), (part,) = together.loads, alone.loads
        here = whole.position == k
        for name in ("force", "peak", "pressure"):
            values, expected = getattr(whole, name)[here], getattr(part, name)
            np.testing.assert_allclose(values, expected, rtol=1e-3, atol=1e-4 * np.nanmax(expected), err_msg=name)


@pytest.mark.sweep
def test_smaller_torques_on_the_grids_of_larger_ones() -> None:
    """A small torque after a large one, whose contacts are twice as long, against the small torque alone; in any order."""
    phases = [0.1, 0.67, 0.71]
    both, alone = under([20.0, 150.0], phases, "spiral_bevel_basic"), under([20.0], phases, "spiral_bevel_basic")
    np.testing.assert_allclose(both.rotation[0], alone.rotation[0], rtol=4e-4)
    np.testing.assert_allclose(both.bending[0], alone.bending[0], rtol=3e-3)
    peaks = [np.nanmax(found.loads[0].peak) for found in (both, alone)]
    np.testing.assert_allclose(peaks[0], peaks[1], rtol=2e-3)
    # results of one torque are not those of the next one
    for load, torque in zip(both.loads, both.torque, strict=True):
        np.testing.assert_allclose(np.bincount(load.position, load.moment), torque, rtol=1e-6)
    turned = under([150.0, 20.0], phases, "spiral_bevel_basic")
    np.testing.assert_array_equal(turned.rotation[::-1], both.rotation)


@pytest.mark.sweep_cases("spur")
@pytest.mark.parametrize("sample", ["spur", "helical"])
def test_torques_and_hertz_on_lines(sample: str) -> None:
    """T2/T1 = z2/z1, and along each line, away from its ends, the pressure of Hertz under the load per length there: 1 %.

    Tip edges on which lines go on press elsewhere than on the line of action: T2/T1 is z2/z1 of what lies on flanks.
    """
    found = under([200.0], [0.1, 0.45], sample)
    assert (found.status == Status.CONVERGED).all()
    (load,) = found.loads
    grid = load.separation
    exact = np.abs(grid.levers[1] / grid.levers[0] - 2.0) < 2e-9
    assert exact[load.force > 0.0].mean() > 0.85
    if sample == "spur":
        np.testing.assert_allclose(found.gear_torque / found.torque[:, None], 2.0, rtol=1e-9)
    np.testing.assert_allclose(found.gear_torque / found.torque[:, None], 2.0, rtol=5e-5)
    own = (load.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None] * grid.levers[0]).sum(axis=1)
    np.testing.assert_allclose(np.bincount(load.position, own), 200e3, rtol=1e-9)
    whole = grid.on[:, 15:25].all(axis=(1, 2))
    carrying = np.flatnonzero((load.force > 0.1 * load.force.max()) & (grid.dx > 0.2) & whole)
    assert len(carrying) >= 2
    for m in carrying:
        line = load.pressure[m].sum(axis=1) * grid.dy[m]
        middle = slice(15, 25)
        # relative curvatures from the gaps themselves
        eta = (np.arange(24) - 11.5) * grid.dy[m]
        kappa = 2.0 * np.polyfit(eta, grid.gap[m, middle].T, 2)[0]
        hertz = line_contact(kappa, line[middle], MODULUS)
        np.testing.assert_allclose(load.pressure[m].max(axis=1)[middle], hertz.peak_pressure, rtol=0.01)


@pytest.mark.sweep
def test_point_contact_is_that_of_hertz() -> None:
    """A spiral bevel pair under little load, away from edges: one ellipse, 1 %."""
    found = under([0.5], [0.0], "spiral_bevel_basic")
    (load,) = found.loads
    pair, _ = geared("spiral_bevel_basic")
    kappa = separation_curvatures(pair, analyse(pair, np.array([0.0])))[0]
    m = int(load.force.argmax())
    assert load.force[m] == load.force.sum()
    assert not load.on_edge[m]
    hertz = point_contact(*kappa, load.force[m], MODULUS)
    assert load.peak[m] == pytest.approx(float(hertz.peak_pressure), rel=0.01)
    assert found.gear_torque[0, 0] / found.torque[0] == pytest.approx(44 / 13, rel=1e-3)


@pytest.mark.sweep
def test_without_torque_the_transmission_error_is_the_unloaded_one() -> None:
    """And the rotation falls with the torque, nearly in proportion: on lines more slowly by a logarithm, by a root on points."""
    for sample in ("spur", "spiral_bevel_basic"):
        found = under([1e-2, 1.0, 100.0], [0.1, 0.6], sample)
        assert (found.status == Status.CONVERGED).all()
        assert np.abs(found.te[0] - found.unloaded).max() < 0.2 * ARCSEC
        slopes = np.diff(np.log(found.rotation), axis=0) / np.log(100.0)
        assert (slopes > 0.6).all()
        assert (slopes < 1.0).all()


@pytest.mark.sweep_cases("spiral_bevel_basic")
@pytest.mark.parametrize("sample", ["spur", "spiral_bevel_basic"])
def test_tangents_are_slopes_of_torque_over_rotation(sample: str) -> None:
    """Against a central difference, each torque on grids of its own: 1 %, where the secant is 3 to 36 % less."""
    found = under([196.0, 200.0, 204.0], [0.1, 0.4] if sample == "spur" else [0.1], sample)
    slope = (found.torque[2] - found.torque[0]) / (found.rotation[2] - found.rotation[0])
    np.testing.assert_allclose(found.tangent[1], slope, rtol=0.01)
    assert (found.stiffness[1] < 0.98 * slope).all()


@pytest.mark.sweep
def test_finer_grids_agree() -> None:
    """Cells half as long and wide: rotation 0.3 %, loads 1 %."""
    pair, bodies = geared("spiral_bevel_basic")
    phi1, torque = pair.pitch * np.array([0.4]), np.array([1e5])
    coarse, fine = (loaded_mesh(pair, phi1, torque, bodies, cells=cells) for cells in ((40, 24), (80, 48)))
    np.testing.assert_allclose(coarse.rotation, fine.rotation, rtol=3e-3)
    np.testing.assert_allclose(coarse.loads[0].force, fine.loads[0].force, atol=0.01 * fine.loads[0].force.max())
    np.testing.assert_allclose(coarse.root_stress, fine.root_stress, rtol=0.01)


@pytest.mark.sweep
def test_grids_follow_short_contacts() -> None:
    """Under little load the askew teeth of wide gears touch over a hundredth of the face: cells half as long and wide agree to
    1 % (from one grid over the whole face the rotation were 80 % too large), and without load no error is left."""
    pair, bodies = geared("helical", "assembly.gamma_h=0.1")
    phi1, torque = pair.pitch * np.array([0.25]), np.array([100.0, 1e5])
    coarse, fine = (loaded_mesh(pair, phi1, torque, bodies, cells=cells) for cells in ((40, 24), (80, 48)))
    assert (coarse.status == Status.CONVERGED).all()
    np.testing.assert_allclose(coarse.rotation, fine.rotation, rtol=0.01)
    assert np.abs(coarse.te[0] - coarse.unloaded).max() < 0.8 * ARCSEC
    (load, _), carrying = coarse.loads, coarse.loads[0].force > 0.0
    assert (40 * load.separation.dx[carrying] < 0.5).all()


@pytest.mark.sweep
def test_a_corner_carries_beside_its_ridge() -> None:
    """One pair of askew teeth begins to touch at a corner of its flank and carries a tenth of the load along the edge from
    there. Cells half as long and wide agree to 1.2e-4 of the rotation and 0.2 % of the load. A grid that ended at the corner
    gave the pair 3 %.

    Rotations agreed to 1e-4 while the finer grid was 1.8 times as wide as the contact needs, and so no finer.
    """
    pair, bodies = geared("helical", "assembly.gamma_h=0.02")
    phi1, torque = pair.pitch * np.array([19.0 / 21.0]), np.array([5e5])
    coarse, fine = (loaded_mesh(pair, phi1, torque, bodies, cells=cells) for cells in ((40, 24), (80, 48)))
    assert (coarse.status == Status.CONVERGED).all()
    (load,), (finer,) = coarse.loads, fine.loads
    assert 0.08 < load.force[load.number == 0] / load.force.sum() < 0.15
    np.testing.assert_allclose(coarse.rotation, fine.rotation, rtol=1.2e-4)
    np.testing.assert_allclose(load.force, finer.force, atol=2e-3 * load.force.sum())


@pytest.mark.sweep
def test_pairs_that_only_load_brings_together_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """However little teeth were guessed to give: at a torque that bends them by 0.06 mm more pairs carry than touch before."""
    pair, bodies = geared("spur")
    given = pair.pitch * np.array([0.0]), np.array([3e6]), bodies
    found = loaded_mesh(pair, *given)
    assert len(near_pairs(pair, given[0], 1e-3).number) == 1
    assert (found.loads[0].force > 0.0).sum() >= 2
    monkeypatch.setattr(sharing, "UNIT_DEFLECTION_MM", 0.01)
    again = loaded_mesh(pair, *given)
    np.testing.assert_allclose(again.rotation, found.rotation, rtol=1e-6)
    np.testing.assert_allclose(again.loads[0].force.sum(), found.loads[0].force.sum(), rtol=1e-6)


@pytest.mark.sweep
def test_of_equal_planets_one_carries_the_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    """And is said to; not where there is one mesh."""
    said: list[tuple[str, ...]] = []
    monkeypatch.setattr("gearmesh.answers.load.loaded.loaded_contact_of", lambda *given, **_: said.append(given[3]))
    for sample, pair in (("planetary", 0), ("planetary", "planet_2-ring"), ("spur", 0)):
        gm.build(gm.load(SAMPLES / f"{sample}.toml")).loaded_contact(5.0, pair=pair)
    first, second, none = ([line for line in each if "equally loaded" in line] for each in said)
    assert first == ["sun-planet_1 is one of 3 equally loaded meshes: the torque is that of this mesh alone"]
    assert second == ["planet_2-ring is one of 3 equally loaded meshes: the torque is that of this mesh alone"]
    assert none == []


@pytest.mark.sweep
def test_what_is_told_of_edges_converges() -> None:
    """A helical pair: one line ends on a tip, whose pressure has no limit; the other where both faces end, which has one. Cells
    half as long and wide: the peak that is not told grows by half, those that are told change by 0.5 and 5 %."""
    pair, bodies = geared("helical")
    phi1, torque = np.array([0.45 * pair.pitch]), np.array([2e5])
    coarse, fine = (loaded_mesh(pair, phi1, torque, bodies, cells=cells).loads[0] for cells in ((40, 24), (80, 48)))
    carrying = np.flatnonzero(coarse.force > 0.0)
    assert coarse.on_edge[carrying].all()
    (tip,), (ends,) = (carrying[coarse.sharp[carrying] == sharp] for sharp in (True, False))
    assert fine.sharp[[tip, ends]].tolist() == [True, False]
    for load in (coarse, fine):
        # a face that ends with its mating gear is less pressed there, not more
        assert load.pressure[ends][[0, -1]].max() < 0.98 * load.pressure[ends].max()
        assert load.peak[ends] == load.pressure[ends].max()
    assert fine.pressure[tip].max() > 1.5 * coarse.pressure[tip].max()
    np.testing.assert_allclose(fine.peak[ends], coarse.peak[ends], rtol=0.005)
    np.testing.assert_allclose(fine.peak[tip], coarse.peak[tip], rtol=0.05)


@pytest.mark.sweep
@pytest.mark.sweep_cases("helical-500.0-8.8", "helical-500.0-12.6")
@pytest.mark.parametrize(
    ("sample", "torque", "start"),
    [("spiral_bevel_basic", 60.0, 10.0), ("helical", 500.0, 8.8), ("helical", 500.0, 12.6)],
)
def test_pressure_and_bending_are_smooth_where_tooth_pairs_begin_and_end(
    sample: str, torque: float, start: float
) -> None:
    """Steps of 0.3 and 0.1 deg beside edge contact. Pressures went up and down by 8 to 10 %, and the gear's bending stress fell
    from 38 to 7 MPa in one step."""
    pair, bodies = geared(sample)
    step = 0.3 if sample.startswith("spiral") else 0.1
    phi1 = np.radians(start + step * np.arange(6))
    found = loaded_mesh(pair, phi1, np.array([1e3 * torque]), bodies, cells=(20, 12))
    (load,) = found.loads
    assert load.sharp.any()
    for number in np.unique(load.number):
        own = (load.number == number) & (load.force > 0.0)
        if own.sum() < len(phi1):
            continue
        peak, bending = load.peak[own], load.roots.bending[own]
        known = np.isfinite(peak)
        # what there is of a curve is in one piece
        assert np.abs(np.diff(known.astype(int))).sum() <= 1
        assert (np.abs(np.diff(peak[known])) < 0.06 * peak[known][1:]).all()
        assert (np.abs(np.diff(bending, axis=0)) < 0.06 * load.roots.bending.max(axis=0)).all()


@pytest.mark.sweep
@pytest.mark.parametrize("keys", some([("assembly.gamma_v=0.2",), ()], 1, whole=True))
def test_where_contact_is_with_a_tip_no_peak_is_told(keys: tuple[str, ...]) -> None:
    """A tip edge begins to touch beside a line over the face, which it halves the share of: cells half as long and wide agree to
    0.1 % of the load (a grid that left the edge of askew teeth gave it two thirds), peaks that are told to 2 %."""
    design, (pair, bodies) = gm.load(SAMPLES / "spur.toml", list(keys)), geared("spur", *keys)
    phi1, torque = pair.pitch * np.array([0.0, 0.75]), np.array([2e5])
    meshes = [loaded_mesh(pair, phi1, torque, bodies, cells=cells) for cells in ((40, 24), (80, 48))]
    for mesh in meshes:
        assert (mesh.status == Status.CONVERGED).all()
    coarse, fine = (mesh.loads[0] for mesh in meshes)
    np.testing.assert_allclose(coarse.force, fine.force, atol=1e-3 * fine.force.max())
    np.testing.assert_array_equal(coarse.edge_contact, fine.edge_contact)
    light = (coarse.force > 0.0) & (coarse.force < 0.3 * coarse.force.max())
    assert (coarse.edge_contact == light).all()
    assert light.sum() == (2 if keys else 1)
    # with the power -0.4 of the cells' width and more; of a contact as narrow as that grids are not always fitted alike
    narrower = (coarse.separation.dy / fine.separation.dy)[light].max()
    assert narrower > 1.1
    assert fine.pressure[light].max() > narrower**0.4 * coarse.pressure[light].max()
    told = np.isfinite(coarse.peak)
    assert (told == (coarse.force > 0.0) & ~light).all()
    np.testing.assert_allclose(coarse.peak[told], fine.peak[told], rtol=0.02)
    # lines have all of the face, 28 mm
    np.testing.assert_allclose(40.0 * coarse.separation.dx[told], 28.0, rtol=1e-3)
    found = LoadedContact(design, pair, meshes[0], (), 0.0)
    row = found.document()["positions"][1]
    assert [each["edge_contact"] for each in row["tooth_pairs"]] == [True, False]
    # the pair whose peak it is has its number, the one on an edge its mark, and in the curve of one pair a gap
    assert row["peak_pressure_pair"] == row["tooth_pairs"][1]["pair"]
    cells = found.listings[-2].rows[1]
    assert cells[4:6] == [str(row["tooth_pairs"][1]["pair"]), str(row["tooth_pairs"][0]["pair"])]
    curve = {each["phi1_deg"]: each for each in found.document()["tooth_pair"]}
    turned = np.degrees(phi1[1] - pair.pitch * np.array([each["pair"] for each in row["tooth_pairs"]])).round(12)
    assert [curve[each]["edge_contact"] for each in turned] == [True, False]
    assert [curve[each]["peak_pressure_mpa"] for each in turned] == [None, row["peak_pressure_mpa"]]
    assert list(curve) == sorted(curve)
    assert row["tooth_pairs"][0]["peak_pressure_mpa"] is None
    assert row["peak_pressure_mpa"] == row["tooth_pairs"][1]["peak_pressure_mpa"]
    assert row["edge_contact"]
    assert found.totals[0].edge_contact
    assert found.totals[0].max_pressure == np.nanmax(coarse.peak)


@pytest.mark.sweep
def test_what_the_gear_torque_lacks_is_in_the_teeth() -> None:
    """At a torque that stays, elastic energy changes from position to position by what the pinion gives and the gear does not take:
    of T1 that is the mean, over the torques up to it, of the slope of the transmission error. A few per cent, by differences."""
    pair, bodies = geared("spur", "assembly.gamma_v=0.2")
    node, weight = np.polynomial.legendre.leggauss(5)
    share, step = 0.5 * (node + 1.0), np.radians(0.1)
    torque = np.append(2e5 * share**2, 2e5)
    found = loaded_mesh(pair, step * np.array([-1.0, 0.0, 1.0]), torque, bodies)
    slope = (found.te[:-1, 2] - found.te[:-1, 0]) / (2.0 * step)
    mean = float((weight * share * slope).sum()) / pair.ratio
    lacking = 1.0 - found.gear_torque[-1, 1] * abs(pair.ratio) / torque[-1]
    assert 0.002 < lacking < 0.004
    assert abs(mean) == pytest.approx(lacking, rel=0.06)


@pytest.mark.sweep
@pytest.mark.quick
def test_contacts_that_no_cell_meets_are_found() -> None:
    """A corner that begins to touch, on a grid of 35 by 16 mm of which 3 by 0.4 mm are in contact: 3.5 % of the load."""
    pair, bodies = geared("helical")
    phi1, torque = np.array([20.0 / 21.0 * pair.pitch]), np.array([1e6])
    coarse, fine = (loaded_mesh(pair, phi1, torque, bodies, cells=cells) for cells in ((20, 12), (40, 24)))
    np.testing.assert_allclose(coarse.rotation, fine.rotation, rtol=2e-3)
    shares = [np.sort(found.loads[0].moment)[-3:] / torque for found in (coarse, fine)]
    assert shares[1][0] > 0.02
    np.testing.assert_allclose(shares[0], shares[1], atol=2e-3)


def test_what_is_no_torque_is_refused() -> None:
    pair, bodies = geared("spur")
    with pytest.raises(DesignError, match=r"torque = -3 Nm: allowed is a finite number above 0"):
        loaded_mesh(pair, np.zeros(1), np.array([1e3, -3e3]), bodies)


@pytest.mark.quick
def test_the_answer_says_who_carries() -> None:
    """Shares of tooth pairs make up the torque, the table has them, the document is told from the same figures."""
    design, (pair, _) = gm.load(SAMPLES / "spur.toml"), geared("spur")
    found = LoadedContact(design, pair, under([50.0], [0.0, 0.45], "spur"), (), 0.0)
    first, second = rows = [each.row for each in found.rows]
    assert [each["pair"] for each in first["tooth_pairs"]] == [0]
    assert [each["pair"] for each in second["tooth_pairs"]] == [0, 1]
    # on the base circle, r = 30 cos 20
    for row in rows:
        assert sum(each["force_n"] for each in row["tooth_pairs"]) == pytest.approx(
            50e3 / (30 * np.cos(np.radians(20))), rel=1e-6
        )
        assert row["te_arcsec"] == pytest.approx(-0.5 * row["rotation_arcsec"], abs=1e-3)
        assert row["status"] == "converged"
        for n, (member, radius) in enumerate((("pinion", 27.66), ("gear", 56.03))):
            # the largest is near the tangent of 30 deg, whose radius this is
            assert 0.9 < row[f"{member}_root_stress_30_mpa"] / row[f"{member}_root_stress_mpa"] < 1.0
            place = np.array(row[f"{member}_root_stress_point_mm"]) - pair.mounts[n].origin
            assert np.hypot(*place[:2]) == pytest.approx(radius, abs=0.5)
            bending = [each[f"{member}_bending_stress_mpa"] for each in row["tooth_pairs"]]
            assert row[f"{member}_bending_stress_mpa"] == max(bending) == row[f"{member}_root_stress_30_mpa"]
        assert row["peak_pressure_pair"] == max(row["tooth_pairs"], key=lambda each: each["peak_pressure_mpa"])["pair"]
        # 1 arcsec is 0.13667 um on the base circle
        per_width = row["tangent_stiffness_nm_per_arcsec"] / (0.030 * np.cos(np.radians(20)) * 0.13667 * 28)
        assert row["tangent_stiffness_n_per_mm_um"] == pytest.approx(per_width, rel=1e-4)
    # without the twist of both discs, thick rings of steel down to their bores
    (total,) = found.totals
    shear = 206000.0 / 2.6
    flexible = [(1.0 / bore**2 - 1.0 / root**2) / (4.0 * np.pi * shear * width) for bore, root, width in DISCS]
    twist = flexible[0] + 4.0 * flexible[1]
    unit = 1e3 * (30.0 * np.cos(np.radians(20.0))) ** 2 * 28.0
    assert total.mean_tangent_stiffness_per_width == pytest.approx(found.mesh.tangent.mean() / unit, rel=1e-4)
    assert total.c_gamma == pytest.approx((1.0 / (1.0 / found.mesh.tangent - twist)).mean() / unit, rel=1e-3)
    assert total.c_gamma > 1.05 * total.mean_tangent_stiffness_per_width
    # at the first position one pair has all of the load
    one = 50e3 / (found.mesh.rotation[0, 0] - 50e3 * twist) / unit
    assert total.c_prime == pytest.approx(one, rel=1e-3)
    document = found.document()
    assert document["totals"][0]["te_peak_to_peak_arcsec"] == pytest.approx(
        abs(first["te_arcsec"] - second["te_arcsec"])
    )
    assert "0:100%" in str(found)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("sample", "torque", "words"),
    [
        ("spur", [5.0, -1.0], "torque = -1 Nm: must be one or more finite numbers above 0"),
        ("spur", [], r"torque = \[\] Nm: must be one or more"),
        ("spur", np.nan, "torque = nan: must be finite numbers in Nm, one or several in a row"),
    ],
)
def test_what_cannot_be_loaded_is_said(sample: str, torque: object, words: str) -> None:
    with pytest.raises(DesignError, match=words):
        gm.build(gm.load(SAMPLES / f"{sample}.toml")).loaded_contact(torque)


def test_eccentric_members_are_refused() -> None:
    keys = ["assembly.gear_eccentricity=0.02"]
    with pytest.raises(
        DesignError, match="the gear is eccentric, so every tooth pair is loaded differently; loaded contact needs"
    ):
        gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", keys)).loaded_contact(5.0)


@pytest.mark.sweep
def test_both_halves_of_a_double_helical_pair_carry_alike() -> None:
    """Equal to each other to rounding, and as a pair of one half alone does under half the torque, whose grids are others; the
    other half's places are the mirror image in the middle of the gap."""
    (pair, bodies), phases = geared("double_helical"), np.array([0.1, 0.6])
    both = loaded_mesh(pair, pair.pitch * phases, np.array([400e3]), bodies)
    assert (both.status == Status.CONVERGED).all()
    first, second = (replace(member, rows=SINGLE_ROW) for member in pair.both)
    one = loaded_mesh(replace(pair, pinion=first, gear=second), pair.pitch * phases, np.array([200e3]), bodies)
    np.testing.assert_allclose(both.rotation, one.rotation, rtol=5e-4)
    np.testing.assert_allclose(both.root_stress, one.root_stress, rtol=2e-3)
    (load,), (alone,) = both.loads, one.loads
    for half in (0, 1):
        assert load.number[load.half == half].tolist() == alone.number.tolist()
        np.testing.assert_allclose(load.force[load.half == half], alone.force, atol=2e-3 * alone.force.max())
    np.testing.assert_allclose(load.force[load.half == 0], load.force[load.half == 1], rtol=1e-5)
    plane = pair.pinion.halves[1].plane
    assert plane is not None
    np.testing.assert_array_equal(*(load.edge_contact[load.half == half] for half in (0, 1)))
    middle = (load.place[load.half == 0, 2] + load.place[load.half == 1, 2])[np.isfinite(load.peak[load.half == 0])]
    np.testing.assert_allclose(middle, 2.0 * plane, atol=1e-6)


@pytest.mark.sweep
def test_halves_of_a_double_helical_pair_are_as_stiff_per_width_as_a_pair_of_one_half() -> None:
    """Each half twists, and has its tooth pair, under half the torque."""
    members = {"pinion": {"teeth": 23, "bore": 40}, "gear": {"teeth": 57, "bore": 70}}
    common = {"kind": "cylindrical", "module": 4, "helix_angle": 28, "backlash": 0.12}
    stiff = []
    for width, more, torque in ((72, {"arrangement": "double_helical", "gap": 12}, 300.0), (30, {}, 150.0)):
        widths = {name: {**keys, "face_width": width} for name, keys in members.items()}
        gears = gm.build(gm.parse({**common, **more, **widths}))
        total = gears.loaded_contact(torque, [0.0, 5.0], level="quick").totals[0]
        stiff.append([total.mean_tangent_stiffness_per_width, total.c_gamma, total.c_prime])
    np.testing.assert_allclose(*stiff, rtol=3e-3)


@pytest.mark.sweep
def test_halves_that_do_not_touch_alike() -> None:
    """A gear that has moved along its axis closes one half and opens the other: they change over with the sign of the move, and
    the lesser torque is carried by one alone."""
    pair, bodies = geared("double_helical")
    forces = []
    for move in (0.004, -0.004):
        base = pair.gear.mount.base
        moved = replace(pair.gear.mount, base=Rigid(base.rotation, base.translation + np.array([0.0, 0.0, move])))
        aside = replace(pair, gear=replace(pair.gear, mount=moved))
        found = loaded_mesh(aside, pair.pitch * np.array([0.3]), np.array([20e3, 400e3]), bodies)
        assert (found.status == Status.CONVERGED).all()
        forces.append([[load.force[load.half == half].sum() for half in (0, 1)] for load in found.loads])
    forward, back = np.array(forces)
    np.testing.assert_allclose(forward, back[:, ::-1], rtol=1e-5, atol=1.0)
    assert forward[0].min() == 0.0
    assert 1.2 * forward[1].min() < forward[1].max() < 5.0 * forward[1].min()


@pytest.mark.sweep
def test_a_rack_is_loaded_as_a_gear_is() -> None:
    """Torques balance by the radius that rolls, at every position, but for what tip edges carry off the line of action; the guide's
    force is told beside it."""
    pair, bodies = geared("rack", "pinion.modifications={}")
    found = loaded_mesh(pair, pair.pitch * np.array([0.1, 0.6]), np.array([60e3]), bodies)
    assert (found.status == Status.CONVERGED).all()
    np.testing.assert_allclose(found.gear_torque, 60e3, rtol=2e-4)
    levers = found.loads[0].separation.levers
    assert (np.abs(levers[1] / levers[0] - 1.0) < 1e-9).mean() > 0.7
    row = LoadedContact(gm.load(SAMPLES / "rack.toml"), pair, found, (), 0.0).rows[0].row
    assert pair.output.travel is not None
    # by the base cylinder of z 20, m_n 2, beta 19.5283 deg and the rack's face, the narrower one
    helix, pressure = np.radians(19.5283), np.radians(20.0)
    base = 20.0 / np.cos(helix) * np.cos(np.arctan(np.tan(pressure) / np.cos(helix)))
    per_width = 1e-3 * found.tangent[0, 0] / (base**2 * 24.0)
    assert row["tangent_stiffness_n_per_mm_um"] == pytest.approx(per_width, rel=2e-3)
    assert row["gear_force_n"] == pytest.approx(found.gear_torque[0, 0] / pair.output.travel)
    assert row["te_um"] - row["unloaded_te_um"] == pytest.approx(
        -1e3 * pair.output.travel * found.rotation[0, 0], rel=1e-6
    )


@pytest.mark.sweep
def test_wide_gears_have_many_pairs_and_any_turn_counts() -> None:
    """Ten pairs of wide helical gears carry; after three turns and a pitch it is three turns of teeth and one further."""
    keys = ("pinion.face_width=240", "gear.face_width=240", "helix_angle=30")
    pair = pair_of(gm.load(SAMPLES / "helical.toml", list(keys)))
    near = near_pairs(pair, pair.pitch * np.array([0.2]), 1e-3)
    lines = np.sum([line is not None for line in near.path.lines])
    figures = gm.build(gm.load(SAMPLES / "helical.toml", list(keys))).contact().summary
    assert lines in (int(figures["contact_ratio"]), int(figures["contact_ratio"]) + 1)
    turns = 3 * pair.pinion.tooth.teeth + 1
    later = near_pairs(pair, pair.pitch * np.array([0.2 + turns]), 1e-3)
    assert (later.number - turns).tolist() == near.number.tolist()
    # and the teeth between those that carry at once are all known to the compliance
    assert np.ptp(near.number) <= reach_of(pair) <= np.ptp(near.number) + 3


@pytest.mark.quick
def test_cells_beside_edges() -> None:
    """Two cells from the ends along, and from those beyond a flank either way; the grid's own sides across are no edges."""
    on = np.ones((1, 8, 6), dtype=bool)
    on[0, 4, 5] = False
    found = inside(on, 2)[0]
    assert found[:, 0].tolist() == [False] * 2 + [True] * 4 + [False] * 2
    assert found[:, 5].tolist() == [False] * 8
    assert found[4].tolist() == [True] * 3 + [False] * 3
    assert inside(on, 1)[0, 1:7, 4].tolist() == [True] * 3 + [False] + [True] * 2
