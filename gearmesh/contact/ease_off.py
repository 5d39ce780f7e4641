"""Start values for the contact solver: the ease-off of two flanks on a coarse grid.

Every grid point of the pinion flank meets the gear flank at one gear rotation phi2; the point of first touch is the
extreme of phi2 over the part of the grid that meets the trimmed gear flank.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.meshing import Flank
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.levels import Level

#: share of a grid cell by which a seed may lie outside the trimmed gear flank
SLACK = 0.5


class FlankPair(Protocol):
    """The part of a pair that start values are made from (see `tca.Pair`)."""

    @property
    def pinion(self) -> Flank: ...
    @property
    def gear(self) -> Flank: ...
    @property
    def ratio(self) -> float: ...
    @property
    def drive(self) -> int: ...


@dataclass(frozen=True)
class Seeds:
    """Start values x (Q, 5); `feasible` (Q,) where any grid point meets the gear flank; `interior` (Q,) where the
    extreme is not on the boundary of the pinion's grid; `cells`: steps (2,) of the
    pinion's and the gear's grid in rho and z, mm."""

    x: Array
    feasible: NDArray[np.bool_]
    interior: NDArray[np.bool_]
    cells: tuple[Array, Array]


def ease_off(pair: FlankPair, phi1: Array) -> Seeds:
    """First touch on the grid of the pinion flank, at rotations phi1 (Q,)."""
    # scipy.spatial takes as long to load as all the rest of the solver
    from scipy.spatial import cKDTree

    pinion, gear = pair.pinion, pair.gear
    grid = pinion.grid.reshape(-1, 2)
    own = pinion.surface.jet(grid[:, 0], grid[:, 1]).r
    # circles are about the axis of rotation, which need not be the gear's own
    shift = gear.mount.own_to_turning.translation
    fixed = pinion.mount.at(phi1[:, None]).point(own)
    target = gear.mount.base.inverse.point(fixed).reshape(-1, 3)
    rho, z = np.hypot(target[:, 0], target[:, 1]), target[:, 2]

    gear_grid = gear.grid.reshape(-1, 2)
    gear_points = gear.surface.jet(gear_grid[:, 0], gear_grid[:, 1]).r + shift
    gear_rho = np.hypot(gear_points[:, 0], gear_points[:, 1])
    places = np.stack((gear_rho, gear_points[:, 2]), axis=-1)
    cell = _cell_size(gear, places)
    distance, nearest = cKDTree(places / cell).query(np.stack((rho, z), axis=-1) / cell)
    near = np.flatnonzero(distance <= 2.0)

    def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = gear.surface.jet(x[:, 0], x[:, 1])
        place = jet.r + shift
        radius = np.hypot(place[:, 0], place[:, 1])
        outward = place * np.array([1.0, 1.0, 0.0]) / radius[:, None]
        k = near[index]
        f = np.stack((radius - rho[k], place[:, 2] - z[k]), axis=-1)
        rows = [[dot(outward, d) for d in (jet.r_u, jet.r_v)], [jet.r_u[:, 2], jet.r_v[:, 2]]]
        return f, np.moveaxis(np.array(rows), -1, 0)

    span = np.ptp(gear_grid, axis=0)
    met = newton.solve(residual, gear_grid[nearest[near]], tolerance=1e-6, max_step=0.25 * span, max_iterations=12)
    meeting = gear.surface.jet(met.values[:, 0], met.values[:, 1]).r
    turned = np.arctan2(target[near, 1], target[near, 0])
    turned = turned - np.arctan2(meeting[:, 1] + shift[1], meeting[:, 0] + shift[0])
    phi2 = gear.mount.zero + gear.mount.sign * turned
    lag = pair.ratio * np.repeat(phi1, len(grid))[near]
    # one turn of the gear is one contact: count phi2 - phi1 N1/N2 from -90 to 270 deg, as the sources do
    phi2 = (phi2 - lag + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi + lag
    with np.errstate(invalid="ignore"):
        usable = met.converged & _inside(gear, met.values, meeting, cell)

    reach = np.full(len(target), -np.inf)
    reach[near[usable]] = (pair.drive * (phi2 - lag))[usable]
    x = np.zeros((len(target), 5))
    x[near, 2:4], x[near, 4] = met.values, phi2
    x[:, 0:2] = np.tile(grid, (len(phi1), 1))
    best = (reach.reshape(len(phi1), -1) - _off_middle(pinion.grid.shape[:2])).argmax(axis=1)
    rows = np.arange(len(phi1)) * len(grid) + best
    i, j = np.divmod(best, pinion.grid.shape[1])
    inner = (i > 0) & (i < pinion.grid.shape[0] - 1) & (j > 0) & (j < pinion.grid.shape[1] - 1)
    own_places = np.stack((np.hypot(own[:, 0], own[:, 1]), own[:, 2]), axis=-1)
    return Seeds(x[rows], np.isfinite(reach[rows]), inner, (_cell_size(pinion, own_places), cell))


def _cell_size(flank: Flank, places: Array) -> Array:
    """Largest steps (2,), mm, in rho and z between neighbouring points of a flank's grid."""
    cells = places.reshape(*flank.grid.shape[:2], 2)
    steps = [np.abs(np.diff(cells, axis=axis)).max(axis=(0, 1)) for axis in (0, 1)]
    return np.maximum(*steps)


def _off_middle(shape: tuple[int, ...]) -> Array:
    """A bias (I * J,), rad, far below what matters: of grid points that touch alike, as along a line, the middle one."""
    i, j = (np.linspace(-1.0, 1.0, n) ** 2 for n in shape)
    return 1e-7 * (i[:, None] + j).ravel()


def across(level: Level, r: Array, cell: Array) -> Array:
    """How much a level's value (...,) changes over a grid cell (2,) in rho and z, at points r (..., 3)."""
    gradient = level.gradient(r)
    return np.hypot(gradient[..., 0], gradient[..., 1]) * cell[0] + np.abs(gradient[..., 2]) * cell[1]


def _inside(flank: Flank, parameters: Array, r: Array, cell: Array) -> NDArray[np.bool_]:
    """Points (...,) on the trimmed flank, or outside by no more than half a cell."""
    inside = np.ones(r.shape[:-1], dtype=bool)
    for level in flank.edges.values():
        inside &= level.value(r) <= SLACK * across(level, r, cell)
    if flank.beyond_joint is not None:
        inside &= flank.beyond_joint(parameters, r) <= SLACK * cell[0]
    return inside
