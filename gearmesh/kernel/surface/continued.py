"""A surface that ends in a line and goes straight on from there, aside from its tangents by an angle.

            n
            |   X(u, v)          the line is u = end, or, if a `shift` e(v) is given, u - e(v) = end:
    _________.-------             parameters u count from the line
            /
        D  /  angle               beyond the line the point is X + (u - end) D, X on the line. D is in the plane of
          /                       X_u and n, `angle` aside from X_u towards the material, `rate` long

Points are continuous at the line, and normals are with the angle 0. Derivatives of X and D along the line, which no jet
has, are differences of fourth order of the values at four places beside v.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, cross, dot, unit
from gearmesh.kernel.numeric.splines import Polynomials
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: places beside v, in steps
NEIGHBOUR_STEPS = (-2.0, -1.0, 1.0, 2.0)
#: factors of the values at these places for the first derivative
FIRST_FACTORS = (1.0 / 12.0, -2.0 / 3.0, 2.0 / 3.0, -1.0 / 12.0)
#: factors of the values at these places for the second derivative
SECOND_FACTORS = (-1.0 / 12.0, 4.0 / 3.0, 4.0 / 3.0, -1.0 / 12.0)
#: factor of the value at v itself for the second derivative
SECOND_FACTOR_AT_V = -2.5


@dataclass(frozen=True)
class Continued:
    """A surface that goes straight on at parameters u beyond its line."""

    #: the surface
    surface: Surface
    #: parameter u of the line
    end: float
    #: 1 if the straight part is at smaller u, -1 if it is at larger u
    sense: float
    #: angle (rad) of the straight part from the tangent of the surface towards the material
    angle: float
    #: length per u of the straight part, mm
    rate: float
    #: step of v for derivatives, about a thousandth of the used range
    step: float
    #: parameter of the surface at the line, less `end`, over v; None for 0
    shift: Polynomials | None = None

    def jet(self, u: Array, v: Array) -> Jet:
        """Return the jet at parameters u, v (...,)."""
        u, v = broadcast_pair(u, v)
        beyond = self.sense * (u - self.end) < 0.0
        whole = self._shifted(np.where(beyond, self.end, u), v)
        if not beyond.any():
            return whole
        straight, values = self._straight(u[beyond] - self.end, v[beyond]), []
        for name in (field.name for field in fields(Jet)):
            value = np.array(getattr(whole, name))
            value[beyond] = getattr(straight, name)
            values.append(value)
        return Jet(*values)

    def _shifted(self, u: Array, v: Array) -> Jet:
        """Return the jet of the surface with u counted from the line."""
        if self.shift is None:
            return self.surface.jet(u, v)
        shift, slope = self.shift.derivatives(v, 0, 1)
        jet = self.surface.jet(u + shift, v)
        r_v, n_v = (along + slope[..., None] * across for along, across in ((jet.r_v, jet.r_u), (jet.n_v, jet.n_u)))
        return Jet(jet.r, jet.n, jet.r_u, r_v, jet.n_u, n_v)

    def _on_line(self, v: Array) -> tuple[Jet, Array]:
        """Return the jet (N,) on the line, and the derivative (N, 3) of points of the straight part by u."""
        jet = self._shifted(np.full_like(v, self.end), v)
        way = np.cos(self.angle) * unit(jet.r_u) + self.sense * np.sin(self.angle) * jet.n
        return jet, np.asarray(self.rate * way)

    def _straight(self, beyond: Array, v: Array) -> Jet:
        """Return the jet (N,) of the straight part at u - end (N,)."""
        (at, way), s = self._on_line(v), beyond[:, None]
        beside = [self._on_line(v + place * self.step) for place in NEIGHBOUR_STEPS]

        def derivative(factors: tuple[float, ...], values: list[Array]) -> Array:
            total: Array = sum((factor * value for factor, value in zip(factors, values, strict=True)), np.zeros(3))
            return total

        ways = [way for _, way in beside]
        way_v = derivative(FIRST_FACTORS, ways) / self.step
        way_vv = (derivative(SECOND_FACTORS, ways) + SECOND_FACTOR_AT_V * way) / self.step**2
        line_vv = derivative(FIRST_FACTORS, [jet.r_v for jet, _ in beside]) / self.step
        r_v = at.r_v + s * way_v
        # the tangent plane at the line is turned about the line: the normal keeps the sense of the surface's area
        normal, sense = cross(way, r_v), np.sign(dot(cross(at.r_u, at.r_v), at.n))
        size = sense[:, None] / np.sqrt(dot(normal, normal))[:, None]
        n = size * normal

        def turned(change: Array) -> Array:
            """Return the change (N, 3) of the unit normal from the change of the normal."""
            scaled = size * change
            return np.asarray(scaled - n * dot(n, scaled)[:, None])

        n_u = turned(cross(way, way_v))
        n_v = turned(cross(way_v, r_v) + cross(way, line_vv + s * way_vv))
        return Jet(at.r + s * way, n, way, r_v, n_u, n_v)
