"""Where a tooth pair presses and how hard, over its whole engagement, and the largest pressure that each place of a flank sees.

At every position several tooth pairs are loaded; in the order of their phases they show one pair from its first touch to its last.
Positions are steps, contact is not: between neighbouring phases the cells and their pressures are interpolated linearly.

    phase f        f + 1         cells X along by Y across; a place sees the largest of what passes over it
    ||||||||   ->   ||||||||
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.loaded.sharing import LoadedMesh, inside
from gearmesh.teeth.gear_train import GearPair

#: phases farther apart, in pitches, are not joined; nor are contacts that run in directions with less than this cosine between them
STEP, ALIKE = 0.15, 0.8
#: samples to a cell of a raster, and at most from one place to the next
SAMPLES, MOST = 1.4, 200
#: points of a line of contact
ALONG = 81
#: the part of the pressed area that a scale is for, and how far it goes beyond
NEARLY_ALL, BEYOND = 0.95, 1.25


@dataclass(frozen=True)
class Footprints:
    """One tooth pair at one torque: cells (X, Y) at phases (F,), rad, of the pinion, ascending.

    `middle` (F, X, 3), mm, the direction `across` (F, 3) in which the cells are at `y` (F, Y), mm, and the `normal` (F, 3) out of
    the pinion, fixed frame; `own_to_fixed` (F,) of pinion and gear; `pressure` (F, X, Y), MPa, and which cells that are pressed lie
    on an `edge` of a flank; `share` (F,) of the torque; whether phases f and f + 1 are `joined` (F - 1,).
    """

    phase: Array
    middle: Array
    across: Array
    normal: Array
    y: Array
    own_to_fixed: tuple[Rigid, Rigid]
    pressure: Array
    edge: NDArray[np.bool_]
    share: Array
    joined: NDArray[np.bool_]

    @staticmethod
    def of(gears: GearPair, mesh: LoadedMesh, torque: int, half: int = 0) -> Footprints:
        """Of the torque of that number; of double helical gears of that half, 0 or 1: the other one as the image of the first."""
        load = mesh.loads[torque]
        grid = load.separation
        phase = mesh.phi1[load.position] - gears.pitch * load.number
        order = np.flatnonzero(load.half == half)
        order = order[np.argsort(phase[order], kind="stable")]
        middle, across = grid.middle[order], grid.across[order].copy()
        pressure, edge = load.pressure[order], ~inside(grid.on, 1)[order]
        # which way x counts along an ellipse's major axis is chance
        for f in range(1, len(order)):
            as_it_is, turned = (np.abs(line - middle[f - 1]).sum() for line in (middle[f], middle[f, ::-1]))
            if turned < as_it_is:
                middle[f], across[f] = middle[f, ::-1].copy(), -across[f]
                pressure[f], edge[f] = pressure[f, ::-1, ::-1].copy(), edge[f, ::-1, ::-1].copy()
        along = unit(middle[:, -1] - middle[:, 0])
        near = np.diff(phase[order]) < STEP * gears.pitch
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
            near & (dot(along[1:], along[:-1]) > ALIKE),
        )

    @property
    def cells(self) -> Array:
        """Places (F, X, Y, 3), mm, of the cells in the tangent planes, fixed frame."""
        return self.middle[:, :, None] + self.y[:, None, :, None] * self.across[:, None, None]

    def own(self, member: int, points: Array) -> Array:
        """Points (F, ..., 3) of the fixed frame in that of pinion (0) or gear (1), as they are at the phases."""
        to_own = self.own_to_fixed[member].inverse
        turned = np.einsum("fij,f...j->f...i", to_own.rotation, points)
        in_own: Array = turned + to_own.translation.reshape(-1, *(1,) * (points.ndim - 2), 3)
        return in_own

    def bands(self, count: int) -> Array:
        """Of every phase `count` points along its contact: middle of what is pressed across, fixed frame, half width, mm, and
        largest pressure, MPa, (F, count, 5); NaN where nothing is pressed."""
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
        """Places (F, X, 3), fixed frame, of the most pressed of the cells across that lie on an edge; NaN where none does."""
        pressed = np.where(self.edge, self.pressure, 0.0)
        most = pressed.argmax(axis=2)
        places = np.take_along_axis(self.cells, most[:, :, None, None], axis=2)[:, :, 0]
        # the outer cells end there
        places[:, 0] += 0.5 * (self.middle[:, 0] - self.middle[:, 1])
        places[:, -1] += 0.5 * (self.middle[:, -1] - self.middle[:, -2])
        return np.where((pressed.max(axis=2) > 0.0)[..., None], places, np.nan)


def scale_limit(mesh: LoadedMesh, rasters: Sequence[Array]) -> float:
    """Pressure, MPa, at which one scale for all torques ends: the largest away from edges, but not far beyond what nearly all of
    the area in `rasters` of `largest_pressure` has: on corners it grows without limit."""
    peaks = np.concatenate([load.peak for load in mesh.loads])
    pressed = np.concatenate([raster[raster > 0.0] for raster in rasters])
    if not pressed.size:
        return 1.0
    most = BEYOND * float(np.quantile(pressed, NEARLY_ALL))
    return min(float(np.nanmax(peaks)), most) if np.isfinite(peaks).any() else most


def largest_pressure(places: Array, prints: Footprints, extent: Array, count: tuple[int, int]) -> Array:
    """The largest pressure, MPa, that passes over each cell of a raster (rows of heights, columns of lengths), 0 where none does.

    `places` (F, X, Y, 2): where the cells are in the plane; `extent` (2, 2): its least and greatest length and height; `count` of
    rows and columns.
    """
    low, high = extent
    pixels = (places - low) / (high - low) * np.array(count[::-1])
    largest, pressure = np.zeros(count), prints.pressure
    for here, pressed in zip(pixels, pressure, strict=True):
        _cover(largest, here[None], pressed[None])
    # what passes over a place between phases has its largest pressure on the line of them
    lines = [_line(*print_of) for print_of in zip(pixels, pressure, strict=True)]
    for f in np.flatnonzero(prints.joined):
        ends = [line for line in lines[f : f + 2] if line is not None]
        if len(ends) == 2:
            both = np.stack(ends)[:, :, None]
            _cover(largest, both[..., :2], both[..., 2])
    return largest


def _line(places: Array, pressure: Array) -> Array | None:
    """Place and largest pressure (ALONG, 3) along a contact from end to end, from cells (X, Y); None where nothing is pressed."""
    largest = pressure.max(axis=1)
    most = np.where(largest > 0.0, pressure.argmax(axis=1), pressure.shape[1] // 2)
    return _from_end_to_end(places[np.arange(len(most)), most], largest, ALONG)


def _from_end_to_end(track: Array, largest: Array, count: int) -> Array | None:
    """A track (X, K) with the largest pressure (X,) as a last column, (count, K + 1), where it is pressed; None where nowhere.

    It ends where cells are not pressed; so contact that grows from one phase to the next is interpolated from end to end.
    """
    pressed = np.flatnonzero(largest > 0.0)
    if not pressed.size:
        return None
    first, last = pressed[[0, -1]]
    rate = np.diff(track, axis=0)
    # to the middle of the next cell, where there is nothing; the outermost cells end where a flank does
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
    """Raise a raster to pressures (P, X, Y) at `places` (P, X, Y, 2), pixels, and to those between its one or two phases."""
    if not (pressure > 0.0).any():
        return
    spacing = [np.linalg.norm(np.diff(places, axis=k), axis=-1).max(initial=0.0) for k in range(3)]
    steps = int(np.clip(np.ceil(SAMPLES * spacing[0]), 1, MOST))
    along, across = (
        _weights(n, int(np.clip(n * np.ceil(SAMPLES * length), n, n * MOST)) if n > 1 else 1)
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
    """Linear weights (samples, count) of cells for places evenly from end to end of all of them: going on beyond the middles of the
    outer ones, and staying what they are there."""
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
