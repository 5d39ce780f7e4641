"""Contact compliance under pressures on a grid of cells: half-spaces with free end faces beside the grid.

Displacements follow from Love's solution for pressure on a rectangle.

    end face                          end face       Along x the influence of a cell depends on both cells, because
       |  dist  +--+--+--+--+--+  dist   |           end faces, at right angles to x, lie at fixed places. Along y it
       |<------>|  |  |  |  |  |<------->|           depends on the distance only: a convolution, computed by Fourier
       |        +--+--+--+--+--+         |           transforms, which are real and even.
                      x ->
                                                     Each end face acts as if the other did not exist.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material, contact_modulus
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.compliance.half_space import rectangle_influence
from gearmesh.loaded.compliance.quarter_space import release

#: difference of end faces, in cells along a grid, below which coefficients are the same: at the end by a thousandth of themselves
SAME_END_SHARE = 1e-2
#: wave number of even pressure over that of half a wave along a grid
EVEN_WAVE_SHARE = 0.5


@dataclass(frozen=True)
class ContactCompliance:
    """Influence coefficients of B positions with K grids of X by Y cells, computed when a grid is first pressed."""

    #: lengths (B, K), mm, of the cells
    dx: Array
    #: widths (B, K), mm, of the cells
    dy: Array
    #: numbers of cells along and across
    cells: tuple[int, int]
    #: materials of both bodies
    materials: tuple[Material, Material]
    #: distances (2, 2, B, K), mm, of either body's free end face (first index) from the least and the largest x of the
    #: grids (second index); inf without an end face
    ends: Array
    #: grids (B, K) whose coefficients are known
    known: NDArray[np.bool_]
    #: displacements (B, K, F, X, X), mm, of both bodies in rows X (first index) under 1 MPa on rows X (second), for
    #: each of F waves across
    waves: Array

    @staticmethod
    def of(
        dx: Array, dy: Array, cells: tuple[int, int], materials: tuple[Material, Material], ends: Array | None = None
    ) -> ContactCompliance:
        """Return the compliance for cells dx by dy (B, K), mm, on two bodies; `ends` as in the fields, None for no end
        faces at all."""
        distances = np.full((2, 2, *dx.shape), np.inf) if ends is None else ends
        waves = np.empty((*dx.shape, padded_row(cells[1]) // 2 + 1, cells[0], cells[0]))
        return ContactCompliance(dx, dy, cells, materials, distances, np.zeros(dx.shape, dtype=bool), waves)

    def replace(self, which: NDArray[np.intp], dx: Array, dy: Array, ends: Array) -> None:
        """Replace the sizes of cells (N, K) and the ends (2, 2, N, K) of positions `which` (N,)."""
        self.dx[which], self.dy[which], self.ends[:, :, which], self.known[which] = dx, dy, ends, False

    def take(self, other: ContactCompliance) -> None:
        """Take the known coefficients of grids that have the same cells in another compliance, with end faces in nearly the
        same places."""
        with np.errstate(invalid="ignore"):
            near = (self.ends == other.ends) | (np.abs(self.ends - other.ends) < SAME_END_SHARE * self.dx)
        same = other.known & (self.dx == other.dx) & (self.dy == other.dy) & near.all(axis=(0, 1))
        self.known[same] = True
        self.waves[same] = other.waves[same]

    def under(self, pressure: Array, which: NDArray[np.intp]) -> Array:
        """Return displacements (B, K, X, Y), mm, under pressures (B, K, X, Y), MPa, on the grids of positions `which`
        (B,)."""
        from scipy.fft import irfft, rfft

        # most grids near the contact carry no pressure and are skipped
        row, column = np.nonzero(pressure.any(axis=(2, 3)))
        position, padded = which[row], padded_row(self.cells[1])
        unknown = ~self.known[position, column]
        if unknown.any():
            self._know(position[unknown], column[unknown])
        waves = np.ascontiguousarray(np.moveaxis(rfft(pressure[row, column], padded), -1, -2))
        parts = waves.view(float).reshape(*waves.shape, 2)
        responses = np.empty_like(parts)
        for wave, out, k, grid in zip(parts, responses, position, column, strict=True):
            np.matmul(self.waves[k, grid], wave, out=out)
        displacements = np.zeros_like(pressure)
        response_waves = np.moveaxis(responses.view(complex)[..., 0], -1, -2)
        displacements[row, column] = irfft(response_waves, padded)[..., : pressure.shape[-1]]
        return displacements

    def _know(self, position: NDArray[np.intp], column: NDArray[np.intp]) -> None:
        """Compute the coefficients of the grids `column` (N,) at positions (N,)."""
        x, y = self.cells
        place, padded = np.arange(y), padded_row(y)
        # cosines: the transform of an even row of influence coefficients
        cosines = (
            np.cos(2.0 * np.pi / padded * np.outer(place, np.arange(padded // 2 + 1)))
            * np.where(place, 2.0, 1.0)[:, None]
        )
        dx, dy = self.dx[position, column], self.dy[position, column]
        width, height = dx[:, None, None], dy[:, None, None]
        # half-spaces: coefficients depend on the distance of rows only
        table = rectangle_influence(np.arange(x)[:, None] * width, place * height, width, height)
        spectrum = np.moveaxis(table / contact_modulus(*self.materials) @ cosines, -1, -2)
        # rows of a symmetric matrix whose values depend on the distance are windows of one row of values, back and forth
        back_and_forth = np.concatenate((spectrum[..., :0:-1], spectrum), axis=-1)
        self.waves[position, column] = sliding_window_view(back_and_forth, x, axis=-1)[..., ::-1, :]
        for material, of_body in zip(self.materials, self.ends[:, :, position, column], strict=True):
            for grid_end, distance in enumerate(of_body):
                # end faces: one at the largest x is computed as its mirror image
                near = np.flatnonzero(np.isfinite(distance))
                if near.size:
                    spectra = _end(dx[near], dy[near], distance[near], self.cells, material, cosines)
                    for n, m_squared, coefficients in zip(near, *spectra, strict=True):
                        waves = self.waves[position[n], column[n]]
                        _add_end(waves[:, ::-1, ::-1] if grid_end else waves, m_squared, coefficients)
        self.known[position, column] = True


def padded_row(count: int) -> int:
    """Return the length of a row of cells after zero padding, for the Fourier transform."""
    from scipy.fft import next_fast_len

    return int(next_fast_len(2 * count, real=True))


def half_space_pressures(dx: Array, dy: Array, cells: tuple[int, int]) -> Callable[[Array, NDArray[np.intp]], Array]:
    """Return a function that estimates pressures under displacements, up to a factor, on grids of cells dx by dy (P, K),
    mm.

    A wave of pressure of wave number k moves a half-space by 2 / (E* k) of itself, so that a wave of displacement needs
    k / 2 of itself, times E*. The function takes displacements (B, K X Y) and the indices (B,) of their positions.
    Cosines have an image beyond each side of a grid: the estimate is symmetric, and no grid has to be larger.
    """
    from scipy.fft import dctn, idctn

    along = np.pi * np.arange(cells[0]) / (cells[0] * dx[..., None])
    across = np.pi * np.arange(cells[1]) / (cells[1] * dy[..., None])
    waves = 0.5 * np.hypot(along[..., :, None], across[..., None, :])
    waves[..., 0, 0] = EVEN_WAVE_SHARE * waves[..., 1, 0]

    def pressed(displacements: Array, which: NDArray[np.intp]) -> Array:
        values = displacements.reshape(len(displacements), -1, *cells)
        row, column = np.nonzero(values.any(axis=(2, 3)))
        estimate = np.zeros_like(values)
        spectrum = dctn(values[row, column], axes=(1, 2))
        spectrum *= waves[which[row], column]
        estimate[row, column] = idctn(spectrum, axes=(1, 2), overwrite_x=True)
        return estimate.reshape(displacements.shape)

    return pressed


def _end(
    dx: Array, dy: Array, distance: Array, shape: tuple[int, int], material: Material, cosines: Array
) -> tuple[Array, Array]:
    """Return what a free end face at `distance` (N,), mm, below a grid's least x adds to a half-space.

    It is a polynomial in m^2 (N, X, X), the square of the difference over the sum of the distances of two rows from the
    end face. Its coefficients (N, RELEASE_POWERS, F, 2 X - 1) are waves for each sum of the numbers of both rows.
    """
    x, y = shape
    row = np.arange(x)
    width, height, end_distance = (lengths[:, None, None] for lengths in (dx, dy, distance))
    distance_sum = 2.0 * end_distance + np.arange(1, 2 * x)[:, None] * width
    across = np.arange(y) * height
    # mirror image of each cell, times 1 + release; release is a polynomial in m^2
    image = rectangle_influence(distance_sum, across, width, height) / material.plane_modulus
    coefficients = release(np.arctan2(across, distance_sum), material.poisson_ratio)
    coefficients[0] += 1.0
    m = (row[:, None] - row) * dx[:, None, None] / distance_sum[:, row[:, None] + row, 0]
    spectra = np.moveaxis((coefficients * image) @ cosines, -1, -2)
    return m**2, np.moveaxis(spectra, 0, 1)


def _add_end(waves: Array, m_squared: Array, coefficients: Array) -> None:
    """Add an end face, as `_end` returns it for one grid, to the waves (F, X, X) of the grid."""
    # coefficients (RELEASE_POWERS, F, X, X) of the sums of both rows, as views; Horner's rule
    of_rows = sliding_window_view(coefficients, waves.shape[-1], axis=-1)
    added = of_rows[-1] * m_squared
    for of_power in of_rows[-2:0:-1]:
        added += of_power
        added *= m_squared
    added += of_rows[0]
    waves += added
