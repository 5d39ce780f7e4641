"""Pressure of a tooth pair over its whole engagement, and the largest pressure at each point of a flank.

At every position several tooth pairs are loaded. Ordered by their phases they show one pair from first to last contact.
Positions are discrete, contact is not: cells and pressures are interpolated linearly between neighbouring phases.

    phase f        f + 1         cells X along by Y across; a point sees the largest pressure that passes over it
    ||||||||   ->   ||||||||
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.loaded.sharing import LoadedMesh, inside
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: largest distance of phases that are joined
MAX_JOINED_STEP_PITCHES = 0.15
#: smallest cosine between the directions of contacts that are joined
MIN_JOINED_COSINE = 0.8
#: samples for each cell of a raster
SAMPLES_PER_CELL = 1.4
#: largest number of samples from one place to the next
MAX_SAMPLES_PER_STEP = 200
#: points along a contact
POINTS_PER_CONTACT = 81
#: quantile of the pressures of the pressed area from which the scale is computed
SCALE_QUANTILE = 0.95
#: end of the scale relative to this quantile
SCALE_FACTOR = 1.25


@dataclass(frozen=True)
class Footprints:
    """One tooth pair at one torque: cells (X, Y) at F phases."""

    #: phases (F,) of the pinion, rad, ascending
    phase: Array
    #: middles (F, X, 3) of the rows of cells, mm, fixed frame
    middle: Array
    #: directions (F, 3) across the contact, along which the cells of a row lie, fixed frame
    across: Array
    #: normals (F, 3) out of the pinion, fixed frame
    normal: Array
    #: coordinates (F, Y) of the cells across, mm
    y: Array
    #: motions (F,) of pinion and gear from their own frames
    own_to_fixed: tuple[Rigid, Rigid]
    #: pressures (F, X, Y), MPa
    pressure: Array
    #: True (F, X, Y) for pressed cells on an edge of a flank
    edge: NDArray[np.bool_]
    #: shares (F,) of the torque
    share: Array
    #: True (F - 1,) if the contact continues from phase f to f + 1
    joined: NDArray[np.bool_]

    @staticmethod
    def of(gears: GearPair, mesh: LoadedMesh, torque: int, half: int = 0) -> Footprints:
        """Return the footprints under a torque (by index), for one half (0 or 1) of double helical gears.

        The second half is returned as the image of the first.
        """
        load = mesh.loads[torque]
        grid = load.separation
        phase = mesh.phi1[load.position] - gears.pitch * load.number
        order = np.flatnonzero(load.half == half)
        order = order[np.argsort(phase[order], kind="stable")]
        middle, across = grid.middle[order], grid.across[order].copy()
        pressure, edge = load.pressure[order], ~inside(grid.on, 1)[order]
        # the sense of x along an ellipse's major axis is arbitrary: each phase takes the sense nearer to the phase
        # before
        for f in range(1, len(order)):
            as_it_is, turned = (np.abs(line - middle[f - 1]).sum() for line in (middle[f], middle[f, ::-1]))
            if turned < as_it_is:
                middle[f], across[f] = middle[f, ::-1].copy(), -across[f]
                pressure[f], edge[f] = pressure[f, ::-1, ::-1].copy(), edge[f, ::-1, ::-1].copy()
        along = unit(middle[:, -1] - middle[:, 0])
        near = np.diff(phase[order]) < MAX_JOINED_STEP_PITCHES * gears.pitch
        count = pressure.shape[2]
        first, second = (Rigid(own.rotation[order], own.translation[order]) for own in grid.own_to_fixed)
        return Footprints(
            phase[order],
            middle,
            across,
            unit(grid.normal[order].mean(axis=1)),
            grid.dy[order, None] * (np.arange(count) + 0.5 - 0.5 * count),
            (first, second),
            pressure,
            edge & (pressure > 0.0),
            (load.moment / mesh.torque[torque])[order],
            near & (dot(along[1:], along[:-1]) > MIN_JOINED_COSINE),
        )

    @property
    def cells(self) -> Array:
        """Places (F, X, Y, 3), mm, of the cells in the tangent planes, fixed frame."""
        return self.middle[:, :, None] + self.y[:, None, :, None] * self.across[:, None, None]

    def own(self, member: int, points: Array) -> Array:
        """Points (F, ..., 3) of the fixed frame in the own frame of pinion (0) or gear (1), at the phases."""
        to_own = self.own_to_fixed[member].inverse
        turned = np.einsum("fij,f...j->f...i", to_own.rotation, points)
        in_own: Array = turned + to_own.translation.reshape(-1, *(1,) * (points.ndim - 2), 3)
        return in_own

    def bands(self, count: int) -> Array:
        """Bands (F, count, 5) of pressed area: middle across the contact, fixed frame, half width, mm, largest
        pressure, MPa.

        Every phase has `count` points along its contact; NaN without pressure.
        """
        along = np.full((len(self.phase), count, 5), np.nan)
        for f, pressure in enumerate(self.pressure):
            pressed = pressure > 0.0
            known, y = pressed.any(axis=1), self.y[f]
            low = np.where(known, y[pressed.argmax(axis=1)], 0.0)
            high = np.where(known, y[::-1][pressed[:, ::-1].argmax(axis=1)], 0.0)
            half = np.where(known, 0.5 * (high - low + y[1] - y[0]), 0.0)
            middle = self.middle[f] + 0.5 * (low + high)[:, None] * self.across[f]
            band = _from_end_to_end(np.column_stack((middle, half)), pressure.max(axis=1), count)
            if band is not None:
                along[f] = np.maximum(band, [-np.inf, -np.inf, -np.inf, 0.0, 0.0])
        return along

    @property
    def on_edges(self) -> Array:
        """Places (F, X, 3), fixed frame, of the cell with the largest pressure across among edge cells; NaN without
        one.
        """
        pressed = np.where(self.edge, self.pressure, 0.0)
        most = pressed.argmax(axis=2)
        places = np.take_along_axis(self.cells, most[:, :, None, None], axis=2)[:, :, 0]
        # the outer cells end half a cell beyond their middles
        places[:, 0] += 0.5 * (self.middle[:, 0] - self.middle[:, 1])
        places[:, -1] += 0.5 * (self.middle[:, -1] - self.middle[:, -2])
        return np.where((pressed.max(axis=2) > 0.0)[..., None], places, np.nan)


def scale_limit(mesh: LoadedMesh, rasters: Sequence[Array]) -> float:
    """Return the pressure, MPa, at which the scale for all torques ends: the largest pressure away from edges.

    It is limited by a quantile of the pressed area in `rasters` of `largest_pressure`: at corners the pressure is
    singular.
    """
    peaks = np.concatenate([load.peak for load in mesh.loads])
    pressed = np.concatenate([raster[raster > 0.0] for raster in rasters])
    if not pressed.size:
        return 1.0
    most = SCALE_FACTOR * float(np.quantile(pressed, SCALE_QUANTILE))
    return min(float(np.nanmax(peaks)), most) if np.isfinite(peaks).any() else most


def largest_pressure(places: Array, prints: Footprints, extent: Array, count: tuple[int, int]) -> Array:
    """Largest pressure, MPa, that passes over each cell of a raster (rows of heights, columns of lengths); 0 without.

    - `places` (F, X, Y, 2): places of the cells in the plane
    - `extent` (2, 2): smallest and largest length and height of the raster
    - `count`: rows and columns of the raster
    """
    low, high = extent
    pixels = (places - low) / (high - low) * np.array(count[::-1])
    largest, pressure = np.zeros(count), prints.pressure
    for here, pressed in zip(pixels, pressure, strict=True):
        _cover(largest, here[None], pressed[None])
    # between phases the largest pressure at a place lies on the line of largest pressures
    lines = [_line(*print_of) for print_of in zip(pixels, pressure, strict=True)]
    for f in np.flatnonzero(prints.joined):
        ends = [line for line in lines[f : f + 2] if line is not None]
        if len(ends) == 2:
            both = np.stack(ends)[:, :, None]
            _cover(largest, both[..., :2], both[..., 2])
    return largest


def _line(places: Array, pressure: Array) -> Array | None:
    """Place and largest pressure (POINTS_PER_CONTACT, 3) along a contact, from cells (X, Y); None without pressure."""
    largest = pressure.max(axis=1)
    most = np.where(largest > 0.0, pressure.argmax(axis=1), pressure.shape[1] // 2)
    return _from_end_to_end(places[np.arange(len(most)), most], largest, POINTS_PER_CONTACT)


def _from_end_to_end(track: Array, largest: Array, count: int) -> Array | None:
    """Pressed part of a track (X, K) with its largest pressure (X,) as last column, (count, K + 1); None without
    pressure.

    It ends where the pressure ends, so that a contact that grows between phases is interpolated from end to end.
    """
    pressed = np.flatnonzero(largest > 0.0)
    if not pressed.size:
        return None
    first, last = pressed[[0, -1]]
    rate = np.diff(track, axis=0)
    # a contact ends in the middle of the next cell, where the pressure is 0; at the outermost cells it ends at their
    # edge, where the flank ends
    outer = first == 0, last == len(largest) - 1
    low, high = (0.5 if end else 1.0 for end in outer)
    ends = track[first] - low * rate[max(first - 1, 0)], track[last] + high * rate[min(last, len(rate) - 1)]
    at = np.r_[first - low, np.arange(first, last + 1), last + high]
    values = np.column_stack((
        np.vstack((ends[0], track[first : last + 1], ends[1])),
        np.r_[largest[first] * outer[0], largest[first : last + 1], largest[last] * outer[1]],
    ))  # fmt: skip
    wanted = np.linspace(at[0], at[-1], count)
    return np.stack([np.interp(wanted, at, column) for column in values.T], axis=-1)


def _cover(raster: Array, places: Array, pressure: Array) -> None:
    """Raise a raster to the pressures (P, X, Y) at `places` (P, X, Y, 2), pixels, and between the P = 1 or 2 phases."""
    if not (pressure > 0.0).any():
        return
    spacing = [np.linalg.norm(np.diff(places, axis=k), axis=-1).max(initial=0.0) for k in range(3)]
    steps = int(np.clip(np.ceil(SAMPLES_PER_CELL * spacing[0]), 1, MAX_SAMPLES_PER_STEP))
    along, across = (
        _weights(n, int(np.clip(n * np.ceil(SAMPLES_PER_CELL * length), n, n * MAX_SAMPLES_PER_STEP)) if n > 1 else 1)
        for n, length in zip(pressure.shape[1:], spacing[1:], strict=True)
    )
    later = np.linspace(0.0, 1.0, steps + 1 if len(places) > 1 else 1)[:, None, None]

    def finer(values: Array, part: int) -> Array:
        ends = [along[part] @ value @ across[part].T for value in values]
        between: Array = (1.0 - later) * ends[0] + later * ends[-1]
        return between

    column, row, value = finer(places[..., 0], 0), finer(places[..., 1], 0), finer(pressure, 1)
    seen = (row >= 0.0) & (row < raster.shape[0]) & (column >= 0.0) & (column < raster.shape[1]) & (value > 0.0)
    np.maximum.at(raster, (row[seen].astype(int), column[seen].astype(int)), value[seen])


def _weights(count: int, samples: int) -> tuple[Array, Array]:
    """Linear weights (samples, count) of cells, for samples evenly from end to end of the row.

    Beyond the middles of the outer cells the first matrix extrapolates, the second is constant.
    """
    if count == 1:
        return np.ones((samples, 1)), np.ones((samples, 1))
    at = (np.arange(samples) + 0.5) * count / samples - 0.5
    low = np.clip(np.floor(at).astype(int), 0, count - 2)
    matrices = []
    for part in (at - low, np.clip(at - low, 0.0, 1.0)):
        weights = np.zeros((samples, count))
        weights[np.arange(samples), low] = 1.0 - part
        weights[np.arange(samples), low + 1] += part
        matrices.append(weights)
    return matrices[0], matrices[1]
