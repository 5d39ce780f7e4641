"""Bricks, half-spaces and whole gears give way as closed forms and plain solutions say."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.fe_blocks import block
from oracles.places import SAMPLES
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

import gearmesh as gm
from gearmesh import DesignError, GearPair, Rigid, parse
from gearmesh.contact.hertz import STEEL, Material
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.loaded.compliance import compliance
from gearmesh.loaded.compliance.compliance import FlankCompliance, assemble, flank_compliance, held_teeth
from gearmesh.loaded.compliance.half_space import point_displacements, rectangle_influence
from gearmesh.loaded.compliance.incompatible_modes import corner_stresses, elasticity, unknowns
from gearmesh.loaded.compliance.sector_grid import crowd
from gearmesh.loaded.compliance.twist import twist_compliance
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid


@lru_cache
def spur() -> GearPair:
    return pair_of(gm.load(SAMPLES / "spur.toml"))


def solved(stiffness: object, free: Array, right: Array) -> Array:
    """Displacements of unknowns that are free, the others held."""
    found = np.zeros(right.shape)
    matrix = csc_array(stiffness)[free][:, free]
    found[free] = splu(csc_array(matrix)).solve(right[free])
    return found


@pytest.mark.quick
def test_constant_strain_is_exact_in_bricks_of_any_shape() -> None:
    """Patch test: a linear displacement leaves no forces inside and has its stress at every corner."""
    rng = np.random.default_rng(7)
    mesh = block(*(np.linspace(0.0, 1.0, 4),) * 3, shape=lambda r: r + 0.06 * rng.standard_normal(r.shape))
    gradient = 1e-3 * rng.standard_normal((3, 3))
    moved = (mesh.nodes @ gradient.T).ravel()
    forces = (assemble(mesh, STEEL) @ moved).reshape(-1, 3)
    outside = np.unique(np.concatenate(list(mesh.node_sets.values())))
    inside = np.setdiff1d(np.arange(len(mesh.nodes)), outside)
    assert len(inside) == 8
    assert np.abs(forces[inside]).max() < 1e-12 * np.abs(forces).max()
    both = gradient + gradient.T
    strain = np.array([*np.diag(gradient), both[0, 1], both[1, 2], both[2, 0]])
    own = corner_stresses(mesh.nodes[mesh.elements], STEEL) @ moved[unknowns(mesh.elements)][:, None, :, None]
    np.testing.assert_allclose(own[..., 0], np.broadcast_to(elasticity(STEEL) @ strain, own.shape[:3]), rtol=1e-9)


@pytest.mark.quick
def test_one_layer_of_bricks_bends_exactly() -> None:
    """A bar without lateral strain, one brick high, under a moment: sag M L^2 / (2 E I), stress M c / I."""
    length, moment, modulus = 8.0, 500.0, 2e5
    bar, material = block(np.linspace(0, length, 5), [-0.75, 0.75], [-1.0, 1.0]), Material(modulus, 0.0)
    inertia = 1.5 * 2.0**3 / 12.0
    right = np.zeros((len(bar.nodes), 3))
    end = bar.node_sets["x1"]
    right[end, 0] = moment / 4.0 * bar.nodes[end, 2]
    free = np.setdiff1d(np.arange(3 * len(bar.nodes)), unknowns(bar.node_sets["x0"][:, None]))
    moved = solved(assemble(bar, material), free, right.ravel())
    np.testing.assert_allclose(moved.reshape(-1, 3)[end, 2], -moment * length**2 / (2 * modulus * inertia), rtol=1e-9)
    stress = (corner_stresses(bar.nodes[bar.elements], material) @ moved[unknowns(bar.elements)][:, None, :, None])[
        ..., 0
    ]
    np.testing.assert_allclose(stress[..., 0], moment / inertia * bar.nodes[bar.elements][..., 2], rtol=1e-9)


@pytest.mark.quick
def test_a_rectangle_is_many_points() -> None:
    """Love's rectangle against Boussinesq's point, integrated over it by Gauss; and the known value at its middle [J85 3.27]."""
    x, w = np.polynomial.legendre.leggauss(24)
    width, height = 0.7, 1.9
    for place in ([1.0, 0.3, 0.0], [-0.6, 1.6, 0.0], [2.0, -4.0, 0.0]):
        at = np.array([[[place[0] - 0.5 * width * a, place[1] - 0.5 * height * b, 0.0] for a in x] for b in x])
        points = 0.25 * width * height * np.einsum("i,j,ij", w, w, point_displacements(at, STEEL)[..., 2])
        found = rectangle_influence(*map(np.array, place[:2]), width, height) / STEEL.plane_modulus
        assert found == pytest.approx(points, rel=1e-8)
    square = rectangle_influence(np.array(0.0), np.array(0.0), 1.0, 1.0)
    assert square == pytest.approx(4.0 * np.log(1.0 + np.sqrt(2.0)) / np.pi, rel=1e-12)


COARSE = Cells(flank=4, fillet=3, thickness=2, rim=2, face=4)


@pytest.mark.sweep
def test_a_ring_of_sectors_is_the_whole_gear() -> None:
    """Displacements and stresses of teeth -2 .. 2 from the condensed sector, against all teeth solved at once."""
    tooth, side = spur().pinion.tooth, spur().flanks[0]
    found = flank_compliance(tooth, side, STEEL, COARSE, rim=5.0, reach=2)
    mesh = hex_mesh(tooth, np.arange(tooth.teeth), crowd(plain_grid(COARSE)), 5.0)
    free = np.setdiff1d(np.arange(3 * len(mesh.nodes)), unknowns(mesh.node_sets["rim"][:, None]))
    right = np.zeros((len(mesh.nodes), 3))
    right[node_at(mesh.nodes, found.points[2, 1])] = -found.normals[2, 1]
    moved = solved(assemble(mesh, STEEL), free, right.ravel()).reshape(-1, 3)
    column = np.ravel_multi_index((2, 1), found.points.shape[:2])
    for way in (-2, -1, 1, 2):
        turn = 2.0 * np.pi * way / tooth.teeth
        c, s = np.cos(turn), np.sin(turn)
        turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        points, normals = (each.reshape(-1, 3) @ turned.T for each in (found.points, found.normals))
        own = -(moved[[node_at(mesh.nodes, r) for r in points]] * normals).sum(axis=1)
        np.testing.assert_allclose(found.smooth[2 + way][:, column], own, rtol=1e-7, atol=1e-9 * np.abs(own).max())
    stress = (
        corner_stresses(mesh.nodes[mesh.elements], STEEL) @ moved.ravel()[unknowns(mesh.elements)][:, None, :, None]
    )
    for k in (0, len(found.fillet) // 2):
        element, corner = np.nonzero(mesh.elements == node_at(mesh.nodes, found.fillet[k]))
        own = stress[element, corner, :, 0].mean(axis=0)
        np.testing.assert_allclose(found.stress[2, k, :, column], own, rtol=1e-6, atol=1e-7 * np.abs(own).max())


@pytest.mark.quick
@pytest.mark.parametrize("loaded", [-1, 0])
@pytest.mark.sweep_cases("-1")
def test_a_few_teeth_with_held_cuts(loaded: int) -> None:
    """Displacements and stresses of three teeth, one of them loaded, against the same three solved at once."""
    tooth, side = spur().pinion.tooth, spur().flanks[0]
    found = held_teeth(tooth, side, STEEL, COARSE, rim=5.0, teeth=3).of_tooth(loaded)
    mesh = hex_mesh(tooth, np.array([-1, 0, 1]), crowd(plain_grid(COARSE)), 5.0)
    held = np.concatenate([mesh.node_sets[name] for name in ("rim", "cut_right", "cut_left")])
    free = np.setdiff1d(np.arange(3 * len(mesh.nodes)), unknowns(held[:, None]))

    def of_tooth(k: int, vectors: Array) -> Array:
        return vectors @ Rigid.about_z(k * tooth.pitch_angle).rotation.T

    right = np.zeros((len(mesh.nodes), 3))
    right[node_at(mesh.nodes, of_tooth(loaded, found.points[2, 1]))] = -of_tooth(loaded, found.normals[2, 1])
    moved = solved(assemble(mesh, STEEL), free, right.ravel()).reshape(-1, 3)
    column = np.ravel_multi_index((2, 1), found.points.shape[:2])
    for way in np.setdiff1d(np.array([-1, 0, 1]) - loaded, 0):
        points, normals = (of_tooth(loaded + way, each.reshape(-1, 3)) for each in (found.points, found.normals))
        own = -(moved[[node_at(mesh.nodes, r) for r in points]] * normals).sum(axis=1)
        np.testing.assert_allclose(
            found.smooth[found.reach + way][:, column], own, rtol=1e-7, atol=1e-9 * np.abs(own).max()
        )
    # loaded tooth -1 has no tooth -2
    assert np.any(found.smooth[found.reach - 1]) == (loaded == 0)
    stress = (
        corner_stresses(mesh.nodes[mesh.elements], STEEL) @ moved.ravel()[unknowns(mesh.elements)][:, None, :, None]
    )
    element, corner = np.nonzero(mesh.elements == node_at(mesh.nodes, found.fillet[len(found.fillet) // 2]))
    own = stress[element, corner, :, 0].mean(axis=0)
    np.testing.assert_allclose(
        found.stress[found.reach - loaded, len(found.fillet) // 2, :, column],
        own,
        rtol=1e-6,
        atol=1e-7 * np.abs(own).max(),
    )


@pytest.mark.quick
def test_held_teeth_are_odd() -> None:
    with pytest.raises(DesignError, match=r"teeth = 4: must be an odd number below 20"):
        held_teeth(spur().pinion.tooth, Side.RIGHT, STEEL, COARSE, teeth=4)


def node_at(nodes: Array, place: Array) -> int:
    return int(((nodes - place) ** 2).sum(axis=1).argmin())


def under_a_line(found: FlankCompliance, row: int) -> tuple[float, float]:
    """Displacement, mm/N, of a row of nodes under a force spread evenly along it: its mean, and at the toe."""
    count = found.points.shape[1]
    own = found.smooth[found.reach].reshape(-1, count, found.points.shape[0], count)[row][:, row]
    weight = np.ones(count)
    weight[[0, -1]] = 0.5
    weight /= weight.sum()
    return float(weight @ own @ weight), float(own[0] @ weight)


@pytest.mark.sweep
def test_it_does_not_matter_how_deep_a_dent_is_held() -> None:
    """Smooth part of the compliance under a line of load half way up, with the dent held 3 or 4 elements deep, that is three
    tenths of the tooth's thickness or half of it: 2 %, at the toe too; with elements half as long: 2.5 %."""
    tooth, side = spur().gear.tooth, spur().flanks[1]
    cells = Cells(flank=8, fillet=5, thickness=4, rim=3, face=8)
    found = [under_a_line(flank_compliance(tooth, side, STEEL, cells, 6.0, depth, 0), 4) for depth in (3, 4)]
    mean, toe = np.transpose(found)
    np.testing.assert_allclose(mean, mean[-1], rtol=0.02)
    np.testing.assert_allclose(toe, toe[-1], atol=0.02 * mean[-1])
    finer = Cells(flank=12, fillet=6, thickness=4, rim=3, face=14)
    finest, _ = under_a_line(flank_compliance(tooth, side, STEEL, finer, 6.0, reach=0), 6)
    assert finest == pytest.approx(mean[-1], rel=0.025)


@pytest.mark.quick
def test_loads_between_nodes_are_shared() -> None:
    """Shares of a load at the nodes add up to the load and to its place."""
    found = flank_compliance(spur().pinion.tooth, Side.RIGHT, STEEL, COARSE, 5.0, reach=0)
    places = found.tooth.flank_grid(Side.RIGHT, [0.05, 0.4, 0.99], [0.02, 0.5, 0.8]).points
    nodes, share = found.shares(places)
    np.testing.assert_allclose(share.sum(axis=-1), 1.0, rtol=1e-12)
    middle = (found.points.reshape(-1, 3)[nodes] * share[..., None]).sum(axis=-2)
    # chords of the flank lie off it
    np.testing.assert_allclose(middle, places, atol=0.05)


@pytest.mark.sweep
def test_a_web_twists_as_its_disc() -> None:
    """All teeth loaded alike turn the rim of a gear against its bore. Against a solid body: the torsion of the web,
    T / (4 pi G) (1/r1^2 - 1/r2^2) (1/h - 1/b), and what the steps from b to h at either end add, those of strips in
    antiplane shear (as of heat that flows through a step; conformal mapping), at radii r T s / (2 pi G r^3)."""
    teeth, width, inner, outer = 24, 20.0, 17.0, 36.0
    cells = Cells(flank=4, fillet=3, thickness=2, rim=5, face=14)
    text = {"kind": "cylindrical", "module": 4.0, "pinion": {"teeth": 20, "face_width": width}}

    def turned(thickness: float) -> float:
        """Rotation under 1 N on each tooth, rad / mm."""
        gear = {"teeth": teeth, "face_width": width, "bore": 20.0}
        if thickness < width:
            gear["web"] = {"thickness": thickness, "rim_diameter": 2.0 * outer, "hub_diameter": 2.0 * inner}
        pair = pair_of(parse({**text, "gear": gear}))
        found = flank_compliance(pair.gear.tooth, pair.flanks[1], STEEL, cells, reach=teeth // 2)
        rows, columns = found.points.shape[:2]
        load = np.zeros((rows, columns))
        load[rows // 2] = np.gradient(found.points[rows // 2, :, 2])
        load = load.ravel() / load.sum()
        arm = load @ np.cross(found.points.reshape(-1, 3), found.normals.reshape(-1, 3))[:, 2]
        return float(load @ found.smooth[1:].sum(axis=0) @ load / arm**2)

    shear = 0.5 * STEEL.youngs_modulus / (1.0 + STEEL.poisson_ratio)
    for thickness in (8.0, 4.0):
        a = thickness / width
        step = ((a + 1.0 / a) * np.log((1.0 + a) / (1.0 - a)) - 2.0 * np.log(4.0 * a / (1.0 - a * a))) / (2.0 * np.pi)
        disc = 0.5 * (inner**-2 - outer**-2) * (1.0 / thickness - 1.0 / width) + step * (inner**-3 + outer**-3)
        assert turned(thickness) - turned(width) == pytest.approx(teeth * disc / (2.0 * np.pi * shear), rel=0.05)


@pytest.mark.sweep
def test_a_rack_is_the_limit_of_large_gears() -> None:
    """Held as deep under the root. What a tooth under load over its whole flank gives way by, and its neighbours do, from gears of
    300 and 900 teeth, linear in 1/z: 0.3 %; both ways alike."""
    rack = pair_of(gm.load(SAMPLES / "rack.toml")).gear.tooth
    keys = ["module=2", "helix_angle=19.5283", "pinion.teeth=20", "pinion.profile_shift=0", "gear.profile_shift=0"]
    # as thick as the rack's
    keys.append("circumferential_backlash=0.05")
    cells, given = Cells(flank=6, fillet=4, thickness=3, rim=4, face=8), []
    for teeth in (300, 900):
        design = gm.load(SAMPLES / "helical.toml", [*keys, f"gear.teeth={teeth}", "gear.bore=20", "gear.face_width=24"])
        # the rack's height less its teeth
        given.append(flank_compliance(pair_of(design).gear.tooth, Side.RIGHT, STEEL, cells, rim=24 - 2 * 2.25))
    whole = []
    for each in (*given, flank_compliance(rack, Side.RIGHT, STEEL, cells)):
        # even pressure: lines crowd down the flank
        height = np.linalg.norm(np.gradient(each.points, axis=0), axis=-1)
        load = height.ravel() / height.sum()
        whole.append(load @ each.smooth @ load)
    np.testing.assert_allclose(1.5 * whole[1][2:5] - 0.5 * whole[0][2:5], whole[2][2:5], rtol=0.003)
    np.testing.assert_allclose(whole[2], whole[2][::-1], rtol=1e-9)


@pytest.mark.sweep
@pytest.mark.quick
def test_what_is_known_of_a_body_is_not_asked_again(monkeypatch: pytest.MonkeyPatch) -> None:
    """Teeth of a design in another assembly are those of the first, to the last byte; another bore or material is another body."""
    cells, rings = Cells(flank=3, fillet=2, thickness=2, rim=2, face=3), []
    monkeypatch.setattr(compliance, "_KEPT_RINGS", {})
    whole = compliance._cuts
    monkeypatch.setattr(compliance, "_cuts", lambda *given, **kinds: rings.append(given) or whole(*given, **kinds))

    def of(material: Material, *keys: str) -> FlankCompliance:
        tooth = pair_of(gm.load(SAMPLES / "spur.toml", list(keys))).pinion.tooth
        return flank_compliance(tooth, Side.RIGHT, material, cells)

    first, askew = of(STEEL), of(STEEL, "assembly.gamma_h=0.01")
    assert len(rings) == 1
    assert askew.smooth is first.smooth
    softer = of(Material(1e5, 0.3))
    bored = of(STEEL, "pinion.bore=30")
    assert len(rings) == 3
    assert np.abs(softer.smooth / first.smooth - 1.0).min() > 0.5
    assert np.abs(bored.smooth - first.smooth).max() > 1e-8


@pytest.mark.sweep
def test_no_torque_reaches_the_bore_of_an_idler() -> None:
    """A planet whose opposite tooth balances the torque: loads on both of two held bodies that are half a pitch less than opposite
    agree to 3 %, and their sum over all teeth, the twist of a body that is held at its bore, is that of rings."""
    planet = gm.build(gm.load(SAMPLES / "planetary.toml")).member("planet_1")
    assert planet.idler
    tooth, cells = planet.one_tooth, Cells(4, 4, 2, 3, 4)
    half = tooth.teeth // 2
    held, idler = (
        flank_compliance(tooth, Side.RIGHT, STEEL, cells, reach=half, idler=own).smooth for own in (False, True)
    )
    opposite = 0.5 * (held[0] + held[-1])
    np.testing.assert_allclose(idler[half].mean(), (held[half] - opposite).mean(), rtol=0.03)
    assert held[half].mean() > 1.1 * idler[half].mean()
    # all teeth together leave their mean alone, on a lever of the base circle
    lever = tooth.teeth * np.cos(np.radians(20.0))
    twist = held.mean() * lever**-2 * len(held) / tooth.teeth
    assert twist == pytest.approx(twist_compliance(tooth, STEEL, by_rim=False), rel=0.03)
    assert abs(idler.mean()) < 0.01 * held.mean()
