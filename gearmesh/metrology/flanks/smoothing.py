"""Smoothing of measured deviations: the bicubic spline that is near the measured points and bends least.

Over s and t the spline f minimises

    sum (f(s_k, t_k) - d_k)^2  +  stiffness N  integral of f_ss^2 + 2 f_st^2 + f_tt^2

for N points. By default the stiffness has the least generalised cross-validation [Craven and Wahba 1979],

    GCV = N |d - H d|^2 / (N - tr H)^2

H is the matrix that maps measured to fitted values. Noise is smoothed, and deviations without noise are kept.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: largest numbers of pieces of the spline across and along a flank
MAX_PIECES = (8, 14)
#: stiffnesses that are tried: from nearly 0 to a plane
TRIED_STIFFNESSES = 10.0 ** np.arange(-14.0, 3.0, 0.5)
#: robust standard deviations above which a residual is an outlier
OUTLIER_SIGMAS = 6.0
#: least residual of an outlier, mm
MIN_OUTLIER_MM = 0.003
#: median of absolute values of a normal distribution over its standard deviation
NORMAL_MEDIAN = 0.6745
#: degree of the spline
SPLINE_DEGREE = 3
#: points that are summed at once: limits memory
POINTS_PER_BATCH = 4_000


@dataclass(frozen=True)
class SmoothDeviations:
    """Deviations, mm, as a spline."""

    #: bases in s and t
    bases: tuple[SplineBasis, SplineBasis]
    #: coefficients (F, G), mm
    coefficients: Array
    #: measured minus fitted deviations (N,), mm
    residuals: Array
    #: stiffness of the spline
    stiffness: float

    def at(self, s: Array, t: Array) -> Array:
        """Return deviations (I, J), mm, at shares s (I,) and t (J,)."""
        values: Array = self.bases[0].at(s) @ self.coefficients @ self.bases[1].at(t).T
        return values

    def inside(self, lowest: float) -> tuple[Array, Array]:
        """Return lines s (I,) and t (J,) from the first to the last point, two per piece, within `lowest` .. 1 and 0 ..
        1."""
        lows = (lowest, 0.0)
        s, t = (
            np.linspace(max(basis.low, low), min(basis.high, 1.0), 2 * basis.pieces + 1)
            for basis, low in zip(self.bases, lows, strict=True)
        )
        return s, t

    @property
    def outliers(self) -> NDArray[np.bool_]:
        """Points (N,) whose deviation is far from the value that their neighbours suggest."""
        scale = float(np.median(np.abs(self.residuals))) / NORMAL_MEDIAN
        far: NDArray[np.bool_] = np.abs(self.residuals) > max(OUTLIER_SIGMAS * scale, MIN_OUTLIER_MM)
        return far


def smooth_deviations(s: Array, t: Array, d: Array, stiffness: float | None) -> SmoothDeviations:
    """Fit the spline to deviations d (N,), mm, at s and t (N,)."""
    # fewer pieces than different values of s and t
    pieces = [min(most, max(2, len(np.unique(np.round(x, 3))) - 1)) for most, x in zip(MAX_PIECES, (s, t), strict=True)]
    bases = [SplineBasis.over(float(x.min()), float(x.max()), count) for x, count in zip((s, t), pieces, strict=True)]
    count = bases[0].size * bases[1].size
    batches = [slice(k, k + POINTS_PER_BATCH) for k in range(0, len(d), POINTS_PER_BATCH)]
    normal, right_side = np.zeros((count, count)), np.zeros(count)
    # normal equations, and the matrix of the bending integral
    for batch in batches:
        rows = _rows(bases[0].at(s[batch]), bases[1].at(t[batch]))
        normal += rows.T @ rows
        right_side += rows.T @ d[batch]
    gram = [[basis.gram(order) for order in range(3)] for basis in bases]
    bending = sum(
        weight * np.kron(gram[0][a], gram[1][b]) for weight, a, b in ((1.0, 2, 0), (2.0, 1, 1), (1.0, 0, 2))
    ) + 1e-12 * np.eye(count)
    used_stiffness = _least_gcv(normal, right_side, bending, d) if stiffness is None else stiffness
    # a tiny stiffness determines the parts that no point determines
    penalty = len(d) * max(used_stiffness, float(TRIED_STIFFNESSES[0]))
    coefficients = np.linalg.solve(normal + penalty * bending, right_side)
    grid = coefficients.reshape(bases[0].size, bases[1].size)
    fit = [((bases[0].at(s[batch]) @ grid) * bases[1].at(t[batch])).sum(axis=1) for batch in batches]
    return SmoothDeviations(
        (bases[0], bases[1]), np.asarray(grid, dtype=float), d - np.concatenate(fit), used_stiffness
    )


def _least_gcv(normal: Array, right_side: Array, bending: Array, d: Array) -> float:
    """Return the stiffness of least generalised cross-validation, by the generalised eigenvalues of bending."""
    from scipy.linalg import eigh

    count, square = len(d), float(d @ d)
    # bending v = w (normal + bending) v: all stiffnesses are then diagonal in the components along v
    w, v = eigh(bending, normal + bending)
    w = np.clip(w, 0.0, 1.0)
    components = v.T @ right_side
    best, least = float(TRIED_STIFFNESSES[0]), np.inf
    for stiffness in TRIED_STIFFNESSES:
        a = count * stiffness
        inverse = 1.0 / np.maximum((1.0 - w) + a * w, 1e-300)
        fit = components * inverse
        trace = float(((1.0 - w) * inverse).sum())
        residual_square = square - 2.0 * float(fit @ components) + float(((1.0 - w) * fit**2).sum())
        if count - trace > 1e-6 * count:
            score = count * max(residual_square, 0.0) / (count - trace) ** 2
            if score < least * (1.0 - 1e-9):
                best, least = float(stiffness), score
    return best


@dataclass(frozen=True)
class SplineBasis:
    """Cubic B-splines over even pieces from `low` to `high`."""

    low: float
    high: float
    pieces: int

    @staticmethod
    def over(low: float, high: float, pieces: int) -> SplineBasis:
        return SplineBasis(low, high if high > low else low + 1.0, pieces)

    @property
    def size(self) -> int:
        return self.pieces + SPLINE_DEGREE

    @property
    def knots(self) -> Array:
        inner = np.linspace(self.low, self.high, self.pieces + 1)
        return np.concatenate(([self.low] * SPLINE_DEGREE, inner, [self.high] * SPLINE_DEGREE))

    def at(self, x: Array, order: int = 0) -> Array:
        """Derivatives (X, size) of an order at x (X,)."""
        from scipy.interpolate import BSpline

        basis = BSpline(self.knots, np.eye(self.size), SPLINE_DEGREE)
        values: Array = basis.derivative(order)(x) if order else basis(x)
        return values

    def gram(self, order: int) -> Array:
        """Integrals (size, size) of products of derivatives, by Gauss's rule."""
        nodes, weights = np.polynomial.legendre.leggauss(SPLINE_DEGREE + 1)
        width = (self.high - self.low) / self.pieces
        x = self.low + width * (np.arange(self.pieces)[:, None] + 0.5 * (nodes + 1.0)).ravel()
        values = self.at(x, order)
        product: Array = (values * np.tile(0.5 * width * weights, self.pieces)[:, None]).T @ values
        return product


def _rows(first: Array, second: Array) -> Array:
    """Products (N, F S) of two bases at the same points."""
    return np.asarray((first[:, :, None] * second[:, None, :]).reshape(len(first), -1))
