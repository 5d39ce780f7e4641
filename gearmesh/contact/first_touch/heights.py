"""Table of a flank over circles: the polar angle at which a circle about the member's axis meets the flank.

For a rack the circles are straight lines along which it slides; `Joint` defines their angles and radii.

Every circle has a radius and a height, (rho, z). The station coordinate a is linear in both, and w is perpendicular to it in the
axial half plane. A flank is one function theta(a, w) between toe and heel, form point and tip. The table holds exact points on a
lattice of equal steps between these limits, and is continued a little beyond them. Cubic splines read it fast enough for every
point of a mating gear at every position. The table decides where contact is searched, never the result.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.first_touch.spline_table import SplineTable
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass

#: rows of the lattice from form point to tip
LATTICE_ROWS = 33
#: degree of the first and last row of the lattice over the face, where they bend
ROW_DEGREE = 4
#: bend of a row, by w, up to which it is straight
STRAIGHT_ROW = 1e-12
#: error (mm) of a lattice point
LATTICE_TOLERANCE_MM = 1e-9


@dataclass(frozen=True)
class Circles:
    """Meeting of circles with a flank: polar angle `theta` (...,), rad, of the flank, and distances `beyond` its limits.

    `beyond` (4, ...), mm, counts past form point, tip, toe and heel, negative inside.
    """

    theta: Array
    beyond: Array


@dataclass(frozen=True)
class FlankHeights:
    """Table of a flank over circles, made by `heights`."""

    #: coefficients of the station coordinate: of rho, of z, and the constant (mm)
    station: tuple[float, float, float]
    #: sign of w: positive towards the tip
    sign: float
    #: stations of toe and heel, mm
    extent: tuple[float, float]
    #: theta on the lattice, rad
    theta: SplineTable
    #: w (C,) at the form point by station, mm
    low: Array
    #: w (C,) at the tip by station, mm
    high: Array
    #: w of the first row, and from first to last row, as polynomials of the place on the face from -1 to 1; None if straight
    rows: tuple[Array, Array] | None
    #: surface parameters (LATTICE_ROWS, C, 2) of the lattice
    parameters: Array

    def at(self, rho: Array, z: Array) -> Circles:
        """Return the meeting of circles (...,), member's frame, with the flank."""
        a, w, column, low, high = self._places(rho, z)
        return Circles(self.theta.at(self._row(w, column, low, high), column), self._outside(a, w, low, high))

    def beyond(self, rho: Array, z: Array) -> Array:
        """Return distances (4, ...), mm, of circles (...,), member's frame, beyond form point, tip, toe and heel."""
        a, w, _, low, high = self._places(rho, z)
        return self._outside(a, w, low, high)

    @cached_property
    def steepness(self) -> Array:
        """Largest changes (4,) of the distances `beyond` by the movement of a circle."""
        width = np.abs(self.extent[1] - self.extent[0]) / (len(self.low) - 1)
        return 1.0 + np.array([*(np.abs(np.diff(limit)).max() / width for limit in (self.low, self.high)), 0.0, 0.0])

    @cached_property
    def _steps(self) -> tuple[Array, Array]:
        """Steps (C - 1,) of w at form point and tip from station to station, mm."""
        return np.diff(self.low), np.diff(self.high)

    def _outside(self, a: Array, w: Array, low: Array, high: Array) -> Array:
        toe, heel = self.extent
        sense = np.sign(heel - toe)
        return np.stack((low - w, w - high, sense * (toe - a), sense * (a - heel)))

    def parameters_at(self, rho: Array, z: Array) -> Array:
        """Return surface parameters (C, 2) near the meeting of circles (C,) with the flank, or nearest to it on the rim."""
        _, w, column, low, high = self._places(rho, z)
        last, row = np.array(self.parameters.shape[:2]) - 1.0, self._row(w, column, low, high)
        return bilinear(self.parameters, np.clip(np.stack((row, column), axis=-1), 0.0, last))

    def _places(self, rho: Array, z: Array) -> tuple[Array, ...]:
        """Return station and w (mm), column of the lattice, and w at form point and tip, of circles (...,)."""
        across, up, zero = self.station
        a, w = across * rho + up * z + zero, self.sign * (up * rho - across * z)
        toe, heel = self.extent
        last = len(self.low) - 1
        column = (a - toe) * (last / (heel - toe))
        # NaN counts as 0
        k = np.fmin(np.fmax(column, 0.0), last - 1.0).astype(np.intp)
        share = column - k
        low, high = (limit[k] + share * step[k] for limit, step in zip((self.low, self.high), self._steps, strict=True))
        return a, w, column, low, high

    def _row(self, w: Array, column: Array, low: Array, high: Array) -> Array:
        """Return the row (...,) of the lattice at w (mm) and column, between w at form point and tip."""
        first, span = low, high - low
        if self.rows is not None:
            first, span = (np.asarray(np.polyval(row, column * (2.0 / (len(self.low) - 1)) - 1.0)) for row in self.rows)
        return (w - first) * ((LATTICE_ROWS - 1) / span)


def bilinear(table: Array, place: Array) -> Array:
    """Interpolate a table (I, J, K) at places (C, 2), in steps, within its rim; return (C, K)."""
    last = np.array(table.shape[:2]) - 1
    cell = np.clip(place.astype(np.intp), 0, last - 1)
    share = place - cell
    i, j = cell.T
    a, b = share[:, :1], share[:, 1:]
    values: Array = (1.0 - a) * ((1.0 - b) * table[i, j] + b * table[i, j + 1]) + a * (
        (1.0 - b) * table[i + 1, j] + b * table[i + 1, j + 1]
    )
    return values


def heights(surface: Surface, grid: Array, joint: Joint, *, axial: Level, extent: tuple[float, float]) -> FlankHeights:
    """Make the table of a flank that moves in a joint.

    The columns are the columns of the flank's `grid` (I, J, 2) of surface parameters, between `extent` of the station coordinate
    `axial`. Places without a point of the surface are filled from their neighbours.
    """
    # limits of the flank in w by station: form point and tip
    across, up = station_normal(axial)
    zero = float(axial.value(np.zeros(3)))
    r = surface.jet(grid[..., 0], grid[..., 1]).r
    rho = joint.radius(r)
    w = up * rho - across * r[..., 2]
    sign = 1.0 if (w[-1] - w[0]).mean() > 0.0 else -1.0
    w = sign * w
    count = w.shape[1]
    a = across * rho + up * r[..., 2] + zero
    low_a, high_a = (float(np.clip(end, a.min(), a.max())) for end in extent)
    stations = np.linspace(low_a, high_a, count)
    low, high = w[0], w[-1]
    first, span = low, high - low
    bent = [np.abs(np.diff(ends, 2)).max() > STRAIGHT_ROW * np.abs(ends).max() for ends in (first, span)]
    rows = None
    if any(bent):
        # smooth rows even if form point or tip line have corners: otherwise splines would be wrong between the nodes
        along = np.linspace(-1.0, 1.0, count)
        rows = np.polyfit(along, first, ROW_DEGREE), np.polyfit(along, span, ROW_DEGREE)
        first, span = (np.polyval(row, along) for row in rows)
    # solve a = station, w = row for the surface parameters, from starts interpolated on the flank's grid
    wanted = first + np.linspace(0.0, 1.0, LATTICE_ROWS)[:, None] * span
    start = np.empty((LATTICE_ROWS, count, 2))
    for j in range(count):
        for k in range(2):
            start[:, j, k] = np.interp(wanted[:, j], w[:, j], grid[:, j, k])

    def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return the errors of a and w, mm, and their derivatives by the surface parameters."""
        jet = surface.jet(x[:, 0], x[:, 1])
        radius, outward = joint.radius(jet.r), joint.outward(jet.r)
        a, b = across * radius + up * jet.r[:, 2] + zero, sign * (up * radius - across * jet.r[:, 2])
        f = np.stack((a - stations[index % count], b - wanted.ravel()[index]), axis=-1)
        slopes = [(d[:, 0] * outward[:, 0] + d[:, 1] * outward[:, 1], d[:, 2]) for d in (jet.r_u, jet.r_v)]
        rows = [[across * o + up * d for o, d in slopes], [sign * (up * o - across * d) for o, d in slopes]]
        return f, np.moveaxis(np.array(rows), -1, 0)

    spans = np.abs(np.ptp(grid.reshape(-1, 2), axis=0))
    met = newton.solve(
        residual, start.reshape(-1, 2), tolerance=LATTICE_TOLERANCE_MM, max_step=0.5 * spans, max_iterations=12
    )
    angle = joint.angle(surface.jet(met.values[:, 0], met.values[:, 1]).r)
    parameters = np.where(met.converged[:, None], met.values, start.reshape(-1, 2)).reshape(LATTICE_ROWS, count, 2)
    theta = _without_gaps(np.where(met.converged, angle, np.nan).reshape(LATTICE_ROWS, count), joint)
    return FlankHeights((across, up, zero), sign, (low_a, high_a), SplineTable.of(theta), low, high, rows, parameters)


def _without_gaps(theta: Array, joint: Joint) -> Array:
    """Return angles (R, C) without jumps by full turns; gaps are filled along columns, empty columns from the nearest column."""
    rows = np.arange(len(theta))
    filled = np.full_like(theta, np.nan)
    there = np.flatnonzero(np.isfinite(theta).any(axis=0))
    if not there.size:
        return filled
    for j in there:
        known = np.isfinite(theta[:, j])
        filled[:, j] = np.interp(rows, rows[known], joint.running(theta[known, j]))
    columns = np.arange(theta.shape[1])
    filled = filled[:, there[np.abs(columns[:, None] - there).argmin(axis=1)]]
    middle = len(theta) // 2
    turns = joint.running(filled[middle]) - filled[middle]
    whole: Array = filled + turns
    return whole
