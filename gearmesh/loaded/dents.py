"""Dents of half-spaces under pressures on a grid of cells: a convolution with Love's rectangle, by Fourier transforms."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2

from gearmesh.kernel.algebra import Array
from gearmesh.loaded.half_space import rectangle_influence


@dataclass(frozen=True)
class Dents:
    """Grids (..., X, Y) of cells; `spectrum` (..., X', Y'') of the displacements, mm, of both bodies under 1 MPa on a cell."""

    shape: tuple[int, int]
    padded: tuple[int, int]
    spectrum: NDArray[np.complex128]

    @staticmethod
    def of(dx: Array, dy: Array, shape: tuple[int, int], modulus: float) -> Dents:
        """Of cells dx by dy (...,), mm, on bodies of E* `modulus` (MPa)."""
        padded = (next_fast_len(2 * shape[0], real=False), next_fast_len(2 * shape[1], real=True))
        places = [np.minimum(np.arange(n), n - np.arange(n)) for n in padded]
        width, height = dx[..., None, None], dy[..., None, None]
        table = rectangle_influence(places[0][:, None] * width, places[1] * height, width, height) / modulus
        return Dents(shape, padded, rfft2(table))

    def under(self, pressure: Array, which: NDArray[np.intp]) -> Array:
        """Displacements (B, ..., X, Y), mm, under pressures (B, ..., X, Y), MPa, on grids `which` (B,) of the first axis."""
        found = irfft2(rfft2(pressure, self.padded) * self.spectrum[which], self.padded)
        return np.asarray(found[..., : self.shape[0], : self.shape[1]])
