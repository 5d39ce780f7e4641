"""Contact compliance under pressures on a grid of cells: Love's rectangle on half-spaces, and free end faces beside the grid.

end face                          end face       Along x every cell moves every other by a number of its own, as end
   |  dist  +--+--+--+--+--+  dist   |           faces, at right angles to x, lie at fixed places. Along y only the
   |<------>|  |  |  |  |  |<------->|           distance counts, a convolution: by Fourier transforms, real and even.
   |        +--+--+--+--+--+         |
                  x ->                           Both end faces act as if the other were not there.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material, contact_modulus
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.compliance.half_space import rectangle_influence
from gearmesh.loaded.compliance.quarter_space import POWERS, release


@dataclass(frozen=True)
class ContactCompliance:
    """Grids (B, K, X, Y) of cells; `waves` (B, K, F, X, X): along waves across, F of a row of `padded` cells, displacements, mm, of
    both bodies in rows X (first index) under 1 MPa on rows X (second)."""

    padded: int
    waves: Array

    @staticmethod
    def of(
        dx: Array, dy: Array, shape: tuple[int, int], materials: tuple[Material, Material], ends: Array | None = None
    ) -> ContactCompliance:
        """Of cells dx by dy (...,), mm, on two bodies; `ends` (2, 2, ...), mm: how far from the least and the greatest x of
        the grid (second index) either body (first) has a free end face, inf or None: nowhere near."""
        from scipy.fft import next_fast_len

        x, y = shape
        padded = next_fast_len(2 * y, real=True)
        place = np.arange(y)
        waves = (
            np.cos(2.0 * np.pi / padded * np.outer(place, np.arange(padded // 2 + 1)))
            * np.where(place, 2.0, 1.0)[:, None]
        )
        width, height = dx[..., None, None], dy[..., None, None]
        table = rectangle_influence(np.arange(x)[:, None] * width, place * height, width, height)
        spectrum = np.moveaxis(table / contact_modulus(*materials) @ waves, -1, -2)
        row = np.arange(x)
        waves_of_rows = spectrum[..., np.abs(row[:, None] - row)]
        for material, of_body in zip(materials, () if ends is None else ends, strict=ends is not None):
            for which, distance in enumerate(of_body):
                near = np.flatnonzero(np.isfinite(distance).ravel())
                if near.size:
                    size, depth, away = (np.ravel(lengths)[near] for lengths in (dx, dy, distance))
                    added = _end(size, depth, away, shape, material, waves)
                    waves_of_rows.reshape(-1, *waves_of_rows.shape[-3:])[near] += (
                        added[..., ::-1, ::-1] if which else added
                    )
        return ContactCompliance(padded, waves_of_rows)

    def under(self, pressure: Array, which: NDArray[np.intp]) -> Array:
        """Displacements (B, K, X, Y), mm, under pressures (B, K, X, Y), MPa, on grids `which` (B,) of the first axis."""
        from scipy.fft import irfft, rfft

        # most grids near the contact are not pressed at all
        row, column = np.nonzero(pressure.any(axis=(2, 3)))
        waves = np.ascontiguousarray(np.moveaxis(rfft(pressure[row, column], self.padded), -1, -2))
        parts = waves.view(float).reshape(*waves.shape, 2)
        moved = np.empty_like(parts)
        for own, into, k, grid in zip(parts, moved, which[row], column, strict=True):
            np.matmul(self.waves[k, grid], own, out=into)
        displacements = np.zeros_like(pressure)
        total = np.moveaxis(moved.view(complex)[..., 0], -1, -2)
        displacements[row, column] = irfft(total, self.padded)[..., : pressure.shape[-1]]
        return displacements


def _end(dx: Array, dy: Array, distance: Array, shape: tuple[int, int], material: Material, waves: Array) -> Array:
    """Waves (N, F, X, X) that a free end face at `distance` (N,), mm, below the grid's least x adds to those of a half-space."""
    x, y = shape
    row = np.arange(x)
    width, height, away = (lengths[:, None, None] for lengths in (dx, dy, distance))
    both = 2.0 * away + np.arange(1, 2 * x)[:, None] * width
    across = np.arange(y) * height
    image = rectangle_influence(both, across, width, height) / material.plane_modulus
    parts = release(np.arctan2(across, both), material.poisson_ratio)
    parts[0] += 1.0
    # of the distances of two rows from the end face, the difference over the sum
    total = row[:, None] + row
    m = (row[:, None] - row) * dx[:, None, None] / both[:, total, 0]
    added = np.zeros((len(dx), waves.shape[1], x, x))
    for power in range(POWERS):
        spectrum = np.moveaxis((parts[power] * image) @ waves, -1, -2)
        added += spectrum[..., total] * (m ** (2 * power))[:, None]
    return added
