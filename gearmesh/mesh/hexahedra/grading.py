"""Spacing of nodes along a line: fine within a window around a focus, growing steadily away from it."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Spacing:
    """Cell size h(x) on [0, 1]: constant where |x - focus| <= width, then growing with the distance."""

    #: half width of the window of finest cells
    width: float
    #: size of the finest cells
    finest: float
    #: growth of the cell size per unit of distance
    growth: float = 0.25

    @staticmethod
    def of(width: float, count: int, focus: float, growth: float = 0.25) -> Spacing:
        """Return the finest spacing with `count` cells on [0, 1], at most evenly spaced; `focus` in [0, 1]."""

        # the number of cells falls steadily with their size: bisection
        def many(size: Array, _: NDArray[np.intp]) -> NDArray[np.bool_]:
            trial = Spacing(width, float(np.exp(size[0])), growth)
            return trial._count(np.array([1.0 - focus])) - trial._count(np.array([-focus])) >= count

        _, largest = last_true(many, np.log([1e-9]), np.log([1.0 / count]))
        return Spacing(width, float(np.exp(largest[0])), growth)

    def cells(self, focus: ArrayLike) -> int:
        """Return the number of cells on [0, 1] for a focus, the largest number for several `focus` (...,)."""
        first, last = (self._count(end - np.asarray(focus, dtype=float)) for end in (0.0, 1.0))
        return int(np.ceil((last - first).max() - 1e-9))

    def nodes(self, count: int, focus: ArrayLike = 0.0) -> Array:
        """Return the nodes (count + 1, ...) from 0 to 1 of `count` cells, for each `focus` (...,)."""
        focus = np.asarray(focus, dtype=float)
        first, last = self._count(0.0 - focus), self._count(1.0 - focus)
        share = np.linspace(0.0, 1.0, count + 1).reshape(-1, *(1,) * focus.ndim)
        places = focus + self._place(first + share * (last - first))
        places[0], places[-1] = 0.0, 1.0
        return places

    def _count(self, y: Array) -> Array:
        """Return the number of cells between the focus and y: the integral of dx / h."""
        beyond = np.maximum(np.abs(y) - self.width, 0.0)
        inside = np.minimum(np.abs(y), self.width)
        return np.sign(y) * (inside / self.finest + np.log1p(self.growth * beyond / self.finest) / self.growth)

    def _place(self, cells: Array) -> Array:
        """Return the place at a number of cells from the focus, the inverse of `_count`."""
        core = self.width / self.finest
        beyond = np.maximum(np.abs(cells) - core, 0.0)
        return np.sign(cells) * (
            np.minimum(np.abs(cells), core) * self.finest + self.finest * np.expm1(self.growth * beyond) / self.growth
        )


def uniform(count: int) -> Array:
    """Return the nodes (count + 1,) of equal cells on [0, 1]."""
    return np.linspace(0.0, 1.0, count + 1)
