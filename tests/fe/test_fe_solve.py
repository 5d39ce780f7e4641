"""Models that ccx solves: beams exactly, contact against Hertz, a torque from touching bodies."""

from __future__ import annotations

import shutil
from pathlib import Path

import meshio
import numpy as np
import pytest
from oracles.fe_blocks import CORNERS, block, graded, pressed, rounded
from oracles.fe_cases import crossed_cylinders

from gearmesh import NoSolutionError, OutputError, Rigid
from gearmesh.contact.hertz import STEEL, Material
from gearmesh.fe import ccx
from gearmesh.fe.decks.vtu import write_mesh
from gearmesh.fe.model import ContactPair, Model, NodeForces, RigidTie, Support
from gearmesh.fe.results import contact_figures, largest_principal
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.mesh.hexahedra.hex_quality import volumes
from gearmesh.mesh.hexahedra.hexes import join

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")


@pytest.mark.quick
@needs_ccx
@pytest.mark.parametrize("second_order", [False, True])
def test_beam_under_a_moment(second_order: bool) -> None:
    """Pure bending of a bar without lateral strain, askew in space: rotation M L / (E I), stress M c / I, both exact."""
    length, moment, modulus = 8.0, 500.0, 2e5
    inertia = 1.5 * 2.0**3 / 12.0
    turn = Rigid(rotation_about("x", 0.7) @ rotation_about("z", -1.1), np.array([3.0, -2.0, 1.0]))
    bar = block(
        np.linspace(0, length, 9), np.linspace(-0.75, 0.75, 3), np.linspace(-1, 1, 5), second_order=second_order
    ).move(turn)
    load = tuple(turn.vector(np.array([0.0, moment, 0.0])))
    free = (None,) * 6
    model = Model(
        "bar",
        bar,
        {"all": Material(modulus, 0.0)},
        ties=(
            RigidTie("x0", turn.point(np.zeros(3)), motion=(0.0,) * 6),
            RigidTie("x1", turn.point(np.array([length, 0.0, 0.0])), free, (0.0, 0.0, 0.0, *load)),
        ),
    )
    solution = ccx.solve(model)
    end = solution.references["x1"]
    theta = moment * length / (modulus * inertia)
    np.testing.assert_allclose(turn.inverse.vector(end.rotation), [0, theta, 0], atol=1e-5 * theta)
    sag = -moment * length**2 / (2 * modulus * inertia)
    np.testing.assert_allclose(turn.inverse.vector(end.displacement), [0, 0, sag], atol=-1e-5 * sag)
    held = turn.inverse.vector(solution.references["x0"].moment)
    np.testing.assert_allclose(held, [0, -moment, 0], atol=1e-3 * moment)
    # tension on the upper side
    tension, node = largest_principal(bar, solution, "z1")
    assert tension == pytest.approx(moment / inertia, rel=1e-4)
    assert node in bar.node_sets["z1"]
    assert largest_principal(bar, solution, "z0")[0] == pytest.approx(0.0, abs=1e-3 * tension)


@pytest.mark.quick
@needs_ccx
def test_stresses_at_integration_points_stand_in_their_order(tmp_path: Path) -> None:
    """A bar of twelve unequal elements bent in both planes by forces at its end: F (L - x) y / I within 2 % (its ends do not warp);
    with the points in another order along any axis it is more than 6 % off."""
    import pyvista

    length, width, height, modulus = 6.0, 1.5, 2.0, 2e5
    bar = block(
        np.array([0.0, 1.0, 4.0, length]),
        np.array([-0.75, 0.5, 0.75]),
        np.array([-1.0, -0.3, 1.0]),
        second_order=True,
    )
    push = (0.0, 30.0, -50.0)
    ties = (
        RigidTie("x0", np.zeros(3), motion=(0.0,) * 6),
        RigidTie("x1", np.array([length, 0.0, 0.0]), (None,) * 6, (*push, 0.0, 0.0, 0.0)),
    )
    model = Model("bar", bar, {"all": Material(modulus, 0.0)}, ties=ties, notes=("bent -- twice",))
    solution = ccx.solve(model, keep=tmp_path / "kept")
    places = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) / np.sqrt(3.0)
    shares = np.prod(1.0 + (2.0 * CORNERS - 1.0) * places[:, None], axis=-1) / 8.0
    x, y, z = np.einsum("pc,ecj->jep", shares, bar.nodes[bar.elements[:, :8]])
    area = width * height
    wanted = -12.0 * (length - x) * (push[1] * y / width**2 + push[2] * z / height**2) / area
    assert solution.point_stress is not None
    assert solution.point_stress.shape == (12, 8, 6)
    error = np.abs(solution.point_stress[..., 0] - wanted).max() / np.abs(wanted).max()
    orders = [np.arange(8).reshape(2, 2, 2)[s].ravel() for s in (np.s_[:, :, ::-1], np.s_[:, ::-1], np.s_[::-1])]
    others = [np.abs(solution.point_stress[..., 0] - wanted[:, order]).max() for order in orders]
    assert error < 0.02 < 0.06 < min(others) / np.abs(wanted).max()
    # shear: the mean over the bar is the force over the area, y along xy and z along zx
    weight = volumes(bar.nodes, bar.elements)[:, None] * np.ones(8) / 8.0
    for component, force in ((3, push[1]), (5, push[2])):
        mean = (weight * solution.point_stress[..., component]).sum() / weight.sum()
        assert mean == pytest.approx(force / area, rel=1e-4)
    # files of ccx, and results in a file of VTK
    assert {".inp", ".frd", ".dat"} <= {file.suffix for file in (tmp_path / "kept").iterdir()}
    write_mesh(bar, tmp_path / "bar.vtu", solution.nodal_fields, model.note_lines, solution.element_fields)
    grid, read = pyvista.read(tmp_path / "bar.vtu"), meshio.read(tmp_path / "bar.vtu")
    for name, values in solution.nodal_fields.items():
        np.testing.assert_array_equal(grid.point_data[name], values)
        np.testing.assert_array_equal(read.point_data[name], values)
    for k in range(8):
        name = f"stress_at_point_{k + 1}_mpa"
        np.testing.assert_array_equal(grid.cell_data[name], solution.point_stress[:, k])
        np.testing.assert_array_equal(read.cell_data[name][0], solution.point_stress[:, k])


@pytest.mark.quick
@needs_ccx
def test_natural_frequencies_of_a_cantilever_are_those_of_its_density() -> None:
    """A bar of 20 x 1 x 0.8 mm: k^2 / (2 pi) sqrt(E I / (rho A L^4)), both planes, within 0.3 % (shear, rotary inertia)."""
    length, width, height, modulus, density = 20.0, 1.0, 0.8, 2e5, 7800.0
    bar = block(
        *(np.linspace(0.0, end, count) for end, count in ((length, 11), (width, 2), (height, 2))), second_order=True
    )
    load = NodeForces(np.array([1]), np.array([[1.0, 2.0, 3.0]]))
    model = Model("bar", bar, {"all": Material(modulus, 0.0, density)}, supports=(Support("x0"),), forces=(load,))
    found = ccx.frequencies(model, 3)
    slender = 1.8751040687**2 / (2.0 * np.pi * length**2) * np.sqrt(modulus / (1e-12 * density) / 12.0)
    np.testing.assert_allclose(found[:2], slender * np.array([height, width]), rtol=3e-3)
    assert found == sorted(found)


@pytest.mark.sweep
@needs_ccx
def test_crossed_cylinders_against_hertz() -> None:
    """Force on a quarter of two crossed cylinders, 8 elements over each half axis: peak within 3 %."""
    peak, cells = 1500.0, 8
    model, hertz = crossed_cylinders(peak, cells)
    a, b, force = float(hertz.semi_major), float(hertz.semi_minor), 0.25 * float(hertz.force)
    told: list[tuple[float, str]] = []
    solution = ccx.solve(model, lambda share, doing: told.append((share, doing)))
    (found,) = contact_figures(model, solution)
    assert found.peak_pressure == pytest.approx(peak, rel=0.03)
    assert found.force[2] == pytest.approx(force, rel=1e-3)
    assert found.area == pytest.approx(np.pi * a * b / 4, rel=0.1)
    # centre of a quarter of the semi-ellipsoid of pressure: 3/8 of the half axes, to a quarter of an element
    assert np.all(np.abs(found.centre[:2] - [3 * a / 8, 3 * b / 8]) < [a / (4 * cells), b / (4 * cells)])
    lever_arms = np.cross(found.centre, found.force)[:2]
    np.testing.assert_allclose(found.moment[:2], lever_arms, rtol=0.07)
    assert np.all(np.abs(found.place[:2]) <= [a / 3, b / 3])
    assert told == sorted(told)
    assert 0.0 < told[0][0] < told[-1][0] <= 1.0
    assert "contact elements" in told[0][1]


ARM = 10.0


def lever(overlap: float, torque: float) -> Model:
    """Half of a ball on a flat, on a lever that turns freely about y at x = -ARM: as a pinion under a torque.

    It is turned by `overlap` / ARM into the flat from where they touch.
    """
    kappa, a = 0.1, 0.2
    x, depth = graded(1.25 * a, a / 3, 6 * a, 1.6), 6 * a
    both = np.concatenate([-x[:0:-1], x])
    away = Rigid(np.eye(3), np.array([ARM, 0.0, 0.0]))
    turned = away.inverse @ Rigid(rotation_about("y", overlap / ARM), np.zeros(3)) @ away
    upper = block(both, x, x, rounded(depth, kappa, kappa)).move(turned)
    free = (0.0, 0.0, 0.0, 0.0, None, 0.0)
    tie = RigidTie("upper_z1", np.array([-ARM, 0.0, 0.0]), free, (0, 0, 0, 0, torque, 0))
    return pressed(upper, block(both, x, -x[::-1]), tie, "y", 50.0 * STEEL.youngs_modulus)


@pytest.mark.sweep
@needs_ccx
def test_torque_turns_as_far_from_any_overlap() -> None:
    """One increment from bodies that overlap by 0.3 and by 1.2 of the approach: same end, moments in balance."""
    torque, approach = 600.0, 0.004
    ends = []
    for share in (0.3, 1.2):
        model = lever(share * approach, torque)
        solution = ccx.solve(model)
        end = solution.references["upper_z1"]
        ends.append(share * approach / ARM + end.rotation[1])
        (found,) = contact_figures(model, solution)
        # the moment about the lever's axis: that about the origin, and the force on its arm
        assert found.moment[1] - ARM * found.force[2] == pytest.approx(-torque, rel=1e-3)
        np.testing.assert_array_equal(end.rotation[[0, 2]], 0.0)
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)
    assert 0.7 * approach < ARM * ends[0] < 1.1 * approach


@needs_ccx
def test_pairs_that_do_not_touch_have_no_figures() -> None:
    """Beside one that does, pressed 1 um together: E u / (2 h) over K / (K + E / (2 h)) of it."""
    line = np.linspace(0.0, 1.0, 3)
    lower = block(line, line, line)
    upper, third = (lower.move(Rigid(np.eye(3), np.array([0.0, 0.0, z]))) for z in (1.0, 2.5))
    mesh, stiffness = join({"upper": upper, "lower": lower, "third": third}), 50.0 * 2e5
    held = (Support("lower_z0"), Support("third_z1"), Support("upper_z1", (0, 1)), Support("upper_z1", (2,), -1e-3))
    contacts = (ContactPair("third_z0", "upper_z1", stiffness), ContactPair("upper_z0", "lower_z1", stiffness))
    materials = dict.fromkeys(("upper", "lower", "third"), Material(2e5, 0.0))
    model = Model("blocks", mesh, materials, held, contacts=contacts)
    apart, pressed = contact_figures(model, ccx.solve(model))
    assert (apart.area, apart.peak_pressure) == (0.0, 0.0)
    assert np.isnan(apart.place).all()
    assert pressed.area == pytest.approx(1.0, rel=1e-6)
    springs = 1.0 / (2.0 / 2e5 + 1.0 / stiffness)
    assert pressed.force[2] == pytest.approx(1e-3 * springs, rel=1e-4)
    assert pressed.peak_pressure == pytest.approx(1e-3 * springs, rel=1e-4)


@pytest.mark.sweep
@needs_ccx
def test_bodies_apart_are_refused_at_once() -> None:
    with pytest.raises(NoSolutionError, match=r"no contact at the start.*let the bodies overlap"):
        ccx.solve(lever(-0.001, 600.0))


@needs_ccx
def test_the_solvers_own_error_is_passed_on(tmp_path: Path) -> None:
    bar = block(np.arange(3.0), np.arange(2.0), np.arange(2.0))
    with pytest.raises(NoSolutionError, match=r"^ccx: .*material") as caught:
        ccx.solve(Model("no material", bar, {}, supports=(Support("x0"), Support("x1", (0,), 0.1))), keep=tmp_path)
    assert "\n" not in str(caught.value)
    # what it said is kept
    assert "material" in (tmp_path / "model.log").read_text()
    assert (tmp_path / "model.inp").exists()


def test_missing_solver_is_named_with_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GEARMESH_CCX", "/nowhere/ccx")
    with pytest.raises(OutputError, match="apt-get install calculix-ccx") as caught:
        ccx.solve(lever(0.0, 600.0))
    assert caught.value.exit_status == 2


@needs_ccx
def test_friction_drags_by_its_share_of_the_pressure() -> None:
    """A block pressed 1 um on another and dragged 3 um along it slides: traction mu p; 0.1 um: it sticks, with less."""
    line = np.linspace(0.0, 1.0, 3)
    lower = block(np.linspace(-1.0, 2.0, 9), line, line)
    upper = block(line, line, line).move(Rigid(np.eye(3), np.array([0.0, 0.0, 1.0])))
    mesh, modulus = join({"upper": upper, "lower": lower}), 2e5
    for drag, mu, sliding in ((3e-3, 0.1, True), (3e-3, 0.3, True), (1e-4, 0.3, False)):
        held = (Support("lower_z0"), Support("upper_z1", (2,), -1e-3), Support("upper_z1", (0,), drag))
        held = (*held, Support("upper_z1", (1,)))
        contact = ContactPair("upper_z0", "lower_z1", 50.0 * modulus, mu)
        model = Model(
            "drag", mesh, dict.fromkeys(("upper", "lower"), Material(modulus, 0.0)), held, contacts=(contact,)
        )
        (found,) = contact_figures(model, ccx.solve(model))
        share = -found.force[0] / found.force[2]
        if sliding:
            assert share == pytest.approx(mu, rel=1e-4)
        else:
            assert 0.0 < share < 0.2 * mu
