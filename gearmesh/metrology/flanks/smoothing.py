"""Deviations between the points where they were measured: the bicubic spline that is near them and bends least.

Over s and t it minimises

    sum (f(s_k, t_k) - d_k)^2  +  stiffness N  integral of f_ss^2 + 2 f_st^2 + f_tt^2

for N points. Where no stiffness is given it is the one of least generalised cross-validation [Craven and Wahba 1979],

    GCV = N |d - H d|^2 / (N - tr H)^2

H the matrix that takes measured values to fitted ones: noise is smoothed, and figures without it are kept.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

#: pieces of the spline across and along a flank, at most
PIECES = (8, 14)
#: stiffnesses that are tried: from next to nothing to a plane
STIFFNESSES = 10.0 ** np.arange(-14.0, 3.0, 0.5)
#: a deviation is an outlier by so many robust standard deviations, and by so many mm
OUTLIER, LEAST_OUTLIER = 6.0, 0.003
#: median of absolute values of a normal distribution, over the standard deviation
MEDIAN = 0.6745
CUBIC = 3
#: points that are summed together: the memory that they take is bounded
BATCH = 4_000


@dataclass(frozen=True)
class SmoothDeviations:
    """Deviations, mm, as the spline of `coefficients` (F, G) over bases in s and t; what it leaves of those measured, `residuals`
    (N,), mm, and its stiffness."""

    bases: tuple[SplineBasis, SplineBasis]
    coefficients: Array
    residuals: Array
    stiffness: float

    def at(self, s: Array, t: Array) -> Array:
        """Deviations (I, J), mm, at shares s (I,) and t (J,)."""
        values: Array = self.bases[0].at(s) @ self.coefficients @ self.bases[1].at(t).T
        return values

    def inside(self, lowest: float) -> tuple[Array, Array]:
        """Lines s (I,) and t (J,) from the first point to the last, two for each piece, from `lowest` and 0 to 1."""
        lows = (lowest, 0.0)
        first, second = (
            np.linspace(max(basis.low, low), min(basis.high, 1.0), 2 * basis.pieces + 1)
            for basis, low in zip(self.bases, lows, strict=True)
        )
        return first, second

    @property
    def outliers(self) -> NDArray[np.bool_]:
        """Whether (N,) a point is far from where its neighbours would have it."""
        scale = float(np.median(np.abs(self.residuals))) / MEDIAN
        far: NDArray[np.bool_] = np.abs(self.residuals) > max(OUTLIER * scale, LEAST_OUTLIER)
        return far


def smooth_deviations(s: Array, t: Array, d: Array, stiffness: float | None) -> SmoothDeviations:
    """Of deviations d (N,), mm, at s and t (N,)."""
    pieces = [min(most, max(2, len(np.unique(np.round(x, 3))) - 1)) for most, x in zip(PIECES, (s, t), strict=True)]
    bases = [SplineBasis.over(float(x.min()), float(x.max()), count) for x, count in zip((s, t), pieces, strict=True)]
    count = bases[0].size * bases[1].size
    batches = [slice(k, k + BATCH) for k in range(0, len(d), BATCH)]
    normal, right = np.zeros((count, count)), np.zeros(count)
    for some in batches:
        rows = _rows(bases[0].at(s[some]), bases[1].at(t[some]))
        normal += rows.T @ rows
        right += rows.T @ d[some]
    gram = [[basis.gram(order) for order in range(3)] for basis in bases]
    bending = sum(
        weight * np.kron(gram[0][a], gram[1][b]) for weight, a, b in ((1.0, 2, 0), (2.0, 1, 1), (1.0, 0, 2))
    ) + 1e-12 * np.eye(count)
    chosen = _least_gcv(normal, right, bending, d) if stiffness is None else stiffness
    # a tiny one keeps those parts that no point determines
    amount = len(d) * max(chosen, float(STIFFNESSES[0]))
    coefficients = np.linalg.solve(normal + amount * bending, right)
    grid = coefficients.reshape(bases[0].size, bases[1].size)
    fit = [((bases[0].at(s[some]) @ grid) * bases[1].at(t[some])).sum(axis=1) for some in batches]
    return SmoothDeviations((bases[0], bases[1]), np.asarray(grid, dtype=float), d - np.concatenate(fit), chosen)


def _least_gcv(normal: Array, right: Array, bending: Array, d: Array) -> float:
    """The stiffness of least generalised cross-validation, by the eigenvalues of points against bending."""
    from scipy.linalg import eigh

    count, square = len(d), float(d @ d)
    # bending v = w (normal + bending) v: 1 / (1 + a) of either in every direction
    w, v = eigh(bending, normal + bending)
    w = np.clip(w, 0.0, 1.0)
    part = v.T @ right
    best, least = float(STIFFNESSES[0]), np.inf
    for stiffness in STIFFNESSES:
        a = count * stiffness
        inverse = 1.0 / np.maximum((1.0 - w) + a * w, 1e-300)
        fit = part * inverse
        trace = float(((1.0 - w) * inverse).sum())
        left = square - 2.0 * float(fit @ part) + float(((1.0 - w) * fit**2).sum())
        if count - trace > 1e-6 * count:
            score = count * max(left, 0.0) / (count - trace) ** 2
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
        return self.pieces + CUBIC

    @property
    def knots(self) -> Array:
        inner = np.linspace(self.low, self.high, self.pieces + 1)
        return np.concatenate(([self.low] * CUBIC, inner, [self.high] * CUBIC))

    def at(self, x: Array, order: int = 0) -> Array:
        """Derivatives (X, size) of an order at x (X,)."""
        from scipy.interpolate import BSpline

        basis = BSpline(self.knots, np.eye(self.size), CUBIC)
        values: Array = basis.derivative(order)(x) if order else basis(x)
        return values

    def gram(self, order: int) -> Array:
        """Integrals (size, size) of products of derivatives, by Gauss's rule."""
        nodes, weights = np.polynomial.legendre.leggauss(CUBIC + 1)
        width = (self.high - self.low) / self.pieces
        x = self.low + width * (np.arange(self.pieces)[:, None] + 0.5 * (nodes + 1.0)).ravel()
        values = self.at(x, order)
        product: Array = (values * np.tile(0.5 * width * weights, self.pieces)[:, None]).T @ values
        return product


def _rows(first: Array, second: Array) -> Array:
    """Products (N, F S) of two bases at the same points."""
    return np.asarray((first[:, :, None] * second[:, None, :]).reshape(len(first), -1))
