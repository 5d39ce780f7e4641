"""Free end faces against elements, and the sums that make the contact compliance of them."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from oracles.fe_blocks import block, graded
from scipy.sparse import csr_array

from gearmesh import NoSolutionError
from gearmesh.contact.hertz import STEEL, Material
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.compliance.compliance import assemble
from gearmesh.loaded.compliance.condensation import condensed
from gearmesh.loaded.compliance.contact_compliance import ContactCompliance
from gearmesh.loaded.compliance.half_space import rectangle_influence
from gearmesh.loaded.compliance.incompatible_modes import unknowns
from gearmesh.loaded.compliance.quarter_space import WEDGE_RELEASE, release


def held_back(x: Array, d: Array, y: Array, poisson_ratio: float) -> Array:
    """`release` at places x, y from forces at d."""
    found: Array = np.polynomial.polynomial.polyval(
        ((x - d) / (x + d)) ** 2, release(np.arctan2(y, x + d), poisson_ratio), tensor=False
    )
    return found


def test_free_ends_are_those_of_elements() -> None:
    """A block with the end face free, less the same block with the end face held along x, which is the image alone: 0.05 of the
    image, two elements and more from the end, but for one shift of all, as the block ends somewhere."""
    material = Material(2e5, 0.3)
    lines = graded(2.0, 0.5, 40.0, 2.2)
    mesh = block(lines, lines, lines)
    whole, nodes = csr_array(assemble(mesh, material)), mesh.nodes
    on_top = np.flatnonzero((nodes[:, 2] == 0.0) & (nodes[:, :2].max(axis=1) < 2.1))
    forces = on_top[(nodes[on_top, 1] == 0.0) & (nodes[on_top, 0] > 0.9)]
    right = csr_array((np.ones(len(on_top)), (3 * on_top + 2, np.arange(len(on_top)))), (3 * len(nodes), len(on_top)))
    outer = unknowns(np.flatnonzero((nodes == lines[-1]).any(axis=1))[:, None]).ravel()
    moved = []
    for held in ([], 3 * mesh.node_sets["x0"]):
        column = np.repeat(np.searchsorted(lines, nodes[:, 1] - 1e-9), 3)
        column[np.concatenate((outer, 3 * mesh.node_sets["y0"] + 1, held)).astype(int)] = -1
        *_, under_all = condensed(whole, column, np.array([], np.intp), right, right.shape[1])
        moved.append(under_all[:, np.isin(on_top, forces)])
    # half the block bears half the force
    more = 0.5 * (moved[0] - moved[1]) * material.plane_modulus * np.pi
    x, y, d = nodes[on_top, 0][:, None], nodes[on_top, 1][:, None], nodes[forces, 0]
    image = 1.0 / np.hypot(x + d, y)
    apart = more - held_back(x, d, y, material.poisson_ratio) * image
    np.testing.assert_allclose((apart - np.median(apart)) / image, 0.0, atol=0.05)
    assert abs(np.median(apart)) < 0.08


@pytest.mark.quick
def test_elements_inside_out_have_no_compliance() -> None:
    with pytest.raises(NoSolutionError, match="turned inside out"):
        condensed(
            csr_array(np.diag([2.0, 1.0, -1e-3])), np.array([0, 0, 1]), np.array([], np.intp), csr_array((3, 1)), 1
        )


def test_condensed_body_is_that_of_the_inverse_in_little_memory() -> None:
    """A body in two directions, with held and retained unknowns, against dense matrices; what each front needs is forgotten."""
    random = np.random.default_rng(5)
    width, size, count, pressed = 8, 12, 2500, 40
    column = np.repeat(np.arange(width**2), size)
    across, along = column // width, column % width
    near = (np.abs(across[:, None] - across) <= 1) & (np.abs(along[:, None] - along) <= 1)
    lower = np.tril(random.normal(size=near.shape)) * near + 60.0 * np.eye(len(column))
    stiffness = np.where(near, lower + lower.T, 0.0)
    retained, held = np.flatnonzero(across == width - 1)[::-1], np.arange(0, 600, 37)
    column[retained] = column[held] = -1
    loads = random.normal(size=(len(column), count)) * (random.random((len(column), count)) < 0.004)
    free = column >= 0
    inverse = np.linalg.inv(stiffness[np.ix_(free, free)])
    coupling = stiffness[np.ix_(retained, free)] @ inverse
    kept = stiffness[np.ix_(retained, retained)] - coupling @ stiffness[np.ix_(free, retained)]
    # what scipy loads at the first call does not count
    condensed(csr_array(np.eye(2)), np.array([0, 1]), np.array([], np.intp), csr_array((2, 1)), 1)
    tracemalloc.start()
    found = condensed(csr_array(stiffness), column, retained, csr_array(loads), pressed)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    wanted = kept, loads[retained] - coupling @ loads[free], loads[free].T @ inverse @ loads[free, :pressed]
    for values, expected in zip(found, wanted, strict=True):
        np.testing.assert_allclose(values, expected, rtol=0.0, atol=1e-12)
    # the solutions of all loads, or the whole factor
    assert most < 8 * len(column) * count


@pytest.mark.quick
def test_free_ends_in_closed_forms() -> None:
    """Without Poisson's ratio an even line of force at right angles to the end presses nothing on it; far along the edge a
    wedge."""
    m, right_angle = np.array([0.0, 1.0]), 0.5 * np.pi
    even = release(np.zeros(1), 0.0).sum()
    assert even == pytest.approx(0.0, abs=2e-3)
    far = release(np.array(right_angle), 0.3)
    np.testing.assert_allclose([(far * n ** (2 * np.arange(3))).sum() for n in m], WEDGE_RELEASE, rtol=1e-9)


@pytest.mark.quick
def test_dents_beside_ends_are_sums_over_images() -> None:
    """The sum over waves against every cell on every other: one body that ends before the grid, one that ends at its other end."""
    rng = np.random.default_rng(5)
    shape, dx, dy = (6, 5), 0.3, 0.07
    steel, other = STEEL, Material(1.1e5, 0.1)
    pressure = rng.random((1, 1, *shape))
    ends = np.array([[0.4, np.inf], [np.inf, 0.0]])[..., None, None]
    sizes = np.full((1, 1), dx), np.full((1, 1), dy)
    found, without = (
        ContactCompliance.of(*sizes, shape, (steel, other), each)
        .under(pressure, np.zeros(1, dtype=np.intp))[0, 0]
        .ravel()
        for each in (ends, None)
    )
    i, j = (each.ravel() for each in np.meshgrid(*map(np.arange, shape), indexing="ij"))
    y = np.abs(j[:, None] - j) * dy
    total = np.zeros(len(i))
    for body, x in ((steel, 0.4 + (i + 0.5) * dx), (other, (shape[0] - i - 0.5) * dx)):
        table = rectangle_influence(x[:, None] + x, y, dx, dy) / body.plane_modulus
        total += (table * (1.0 + held_back(x[:, None], x, y, body.poisson_ratio))) @ pressure.ravel()
    np.testing.assert_allclose(found - without, total, rtol=1e-10)
