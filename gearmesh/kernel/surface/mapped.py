"""A surface with other parameters: r(u, v) = R(a(u, v), b(u, v)), with its exact jet by the chain rule."""

from __future__ import annotations

from collections.abc import Callable

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Mapping:
    """Parameters a, b of a surface at (u, v), and their partial derivatives."""

    #: first parameter (...,) of the surface
    a: Array
    #: second parameter (...,) of the surface
    b: Array
    #: derivative of a with respect to u
    a_u: Array
    #: derivative of a with respect to v
    a_v: Array
    #: derivative of b with respect to u
    b_u: Array
    #: derivative of b with respect to v
    b_v: Array

    def over(self, own: Jet) -> Jet:
        """Return the jet with respect to u, v of a surface with the jet `own` at a, b."""
        r_u, n_u = own.along(self.a_u, self.b_u)
        r_v, n_v = own.along(self.a_v, self.b_v)
        return Jet(own.r, own.n, r_u, r_v, n_u, n_v)


@dataclass(frozen=True)
class MappedSurface:
    """A `surface` with the parameters (u, v); `mapping` takes (u, v) to the parameters of the surface."""

    surface: Surface
    mapping: Callable[[Array, Array], Mapping]

    def jet(self, u: Array, v: Array) -> Jet:
        at = self.mapping(u, v)
        return at.over(self.surface.jet(at.a, at.b))
