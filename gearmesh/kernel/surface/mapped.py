"""A surface by other parameters: r(u, v) = R(a(u, v), b(u, v)), with its exact jet by the chain rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Jet, Surface


@dataclass(frozen=True)
class Mapping:
    """Parameters a, b of a surface at (u, v), and their partials, (...,) each."""

    a: Array
    b: Array
    a_u: Array
    a_v: Array
    b_u: Array
    b_v: Array

    def over(self, own: Jet) -> Jet:
        """The jet by u, v of a surface whose jet at a, b is its `own`."""
        r_u, n_u = own.along(self.a_u, self.b_u)
        r_v, n_v = own.along(self.a_v, self.b_v)
        return Jet(own.r, own.n, r_u, r_v, n_u, n_v)


@dataclass(frozen=True)
class MappedSurface:
    """`surface` by the parameters (u, v) that `mapping` takes to its own."""

    surface: Surface
    mapping: Callable[[Array, Array], Mapping]

    def jet(self, u: Array, v: Array) -> Jet:
        at = self.mapping(u, v)
        return at.over(self.surface.jet(at.a, at.b))
