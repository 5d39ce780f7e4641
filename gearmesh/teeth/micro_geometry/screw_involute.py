"""Screw involutes in closed form, with micro-geometry: the flank of every spur and helical gear [ISO 21771-1].

In the transverse plane at z the string of length L leaves the base circle at the angle phi. On a right flank (y < 0 of
a tooth centred on +x) of an external gear

    r = r_b e_r(phi) - L e_t(phi) + z e_z,   phi = start + L / r_b + rate z,   rate = tan(beta_b) / r_b

          | r          The string is the normal of the flank. A flank set back by the amount a along it is the involute
        L |            unwound by a further a / r_b. Its point of roll length L stays on its circle and turns about
    ------+ base       the axis by that angle, into the material.
    circle

Signs: h = +1 where the string is unwound in the sense of rising angles (right flanks of external gears, left flanks of
internal gears), s = +1 on the right side, a(L, z) positive where material is removed. Then

    phi = start + (h L + s a) / r_b + rate z,   r_L = s a_L e_t + h L phi_L e_r,   r_z = (r_b e_t + h L e_r) phi_z + e_z
    r_L x r_z = (L / r_b) (q e_r - (1 + h s a_L) e_t + r_b phi_z e_z),   q = s r_b a_L / L

The normal is therefore smooth through the base circle, L = 0, to the other branch, like the normal of an `Envelope`.
This holds wherever the amount does not change along the profile at the base circle.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass


@dataclass(frozen=True)
class AmountJet:
    """An amount and its partials by roll length L and face position z, (...,) each."""

    #: amount, mm
    a: Array
    #: first partial by L
    a_l: Array
    #: first partial by z
    a_z: Array
    #: second partial by L, 1/mm
    a_ll: Array
    #: mixed partial, 1/mm
    a_lz: Array
    #: second partial by z, 1/mm
    a_zz: Array


class Amount(Protocol):
    """Distance by which a flank is set back, positive where material is removed."""

    def jet(self, length: Array, z: Array) -> AmountJet:
        """Return amount and partials at roll lengths and face positions (...,), mm."""


@dataclass(frozen=True)
class ScrewInvolute:
    """Involute helicoid in its gear's frame (axis z, tooth centred on +x); parameters: roll length L and z, both mm.

    The normal leaves the material. L < 0 is the other branch.
    """

    #: base radius r_b, mm
    base_radius: float
    #: turn of the involute along the axis, rad/mm, positive right-handed
    rate: float
    #: angle at z = 0 where the involute begins on the base circle, rad
    start: float
    #: +1 right (y < 0), -1 left
    side: int = 1
    #: True for a tooth of an internal gear, with its material outside
    internal: bool = False
    #: micro-geometry; None for the true involute
    amount: Amount | None = None

    @property
    def hand(self) -> int:
        """+1 where angles rise along the profile from the base circle outwards, otherwise -1."""
        return -self.side if self.internal else self.side

    @property
    def lean(self) -> float:
        """Axial over transverse part of the normal, h tan(beta_b): contact lines are L + lean z = const."""
        return self.hand * self.rate * self.base_radius

    def length_at(self, radius: float) -> float:
        """Return the roll length (mm) at a radius (mm), NaN below the base circle."""
        square = radius**2 - self.base_radius**2
        return float(np.sqrt(square)) if square >= 0.0 else float("nan")

    @staticmethod
    def through(jet: Jet, side: int, internal: bool = False) -> ScrewInvolute:
        """Return the true involute through the point and with the normal of a jet (1,) off the base circle."""
        (length,), ((c, s),), (n,), (r,) = ScrewInvolute.roll_length(jet, internal), _in_plane(jet), jet.n, jet.r
        base_radius = float(abs(r[0] * s - r[1] * c))
        rate = float(side * n[2] / np.hypot(n[0], n[1]) / base_radius)
        made = ScrewInvolute(base_radius, rate, 0.0, side, internal)
        # n = -s e_t(phi)
        start = np.arctan2(side * c, -side * s) - made.hand * length / base_radius - rate * r[2]
        return replace(made, start=float(start - 2.0 * np.pi * np.round(start / (2.0 * np.pi))))

    @staticmethod
    def roll_length(jet: Jet, internal: bool = False) -> Array:
        """Roll lengths (...,), mm, of points of involutes, from their normals."""
        flat = _in_plane(jet)
        length: Array = (flat[..., 0] * jet.r[..., 0] + flat[..., 1] * jet.r[..., 1]) * (-1.0 if internal else 1.0)
        return length

    def jet(self, u: Array, v: Array) -> Jet:
        length, z = broadcast_pair(u, v)
        if self.amount is None:
            return self._jet(length, z, NO_AMOUNT)
        return self._jet(length, z, self.amount.jet(length, z))

    def _jet(self, length: Array, z: Array, given: AmountJet) -> Jet:
        """Return the jet for known amounts; formulas in the head of this module."""
        r_b, h, s = self.base_radius, self.hand, self.side
        phi = self.start + (h * length + s * given.a) / r_b + self.rate * z
        phi_l, phi_z = (h + s * given.a_l) / r_b, self.rate + s * given.a_z / r_b
        local = _Local(np.cos(phi), np.sin(phi))
        # q = s r_b a_L / L and its partials: a_L is 0 at the base circle, L = 0, where they are 0
        over = np.divide(1.0, length, out=np.zeros_like(length), where=length != 0.0)
        q, q_l, q_z = (
            s * r_b * rate for rate in (given.a_l * over, (given.a_ll - given.a_l * over) * over, given.a_lz * over)
        )
        # tangential component -w and axial component k of the normal, with their partials
        w, w_l, w_z = 1.0 + h * s * given.a_l, h * s * given.a_ll, h * s * given.a_lz
        k, k_l, k_z = r_b * phi_z, s * given.a_lz, s * given.a_zz
        normal = local.vector(q, -w, k)
        size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
        n = s * size * normal

        def normal_change(q_x: Array, w_x: Array, k_x: Array, phi_x: Array) -> Array:
            """Return the derivative (..., 3) of the unit normal from derivatives of q, w, k and phi."""
            changed = s * size * local.vector(q_x + w * phi_x, q * phi_x - w_x, k_x)
            change: Array = changed - n * dot(n, changed)[..., None]
            return change

        along = h * length
        return Jet(
            r=local.vector(r_b, -along, z),
            n=n,
            r_u=local.vector(along * phi_l, s * given.a_l, 0.0),
            r_v=local.vector(along * phi_z, r_b * phi_z, 1.0),
            n_u=normal_change(q_l, w_l, k_l, phi_l),
            n_v=normal_change(q_z, w_z, k_z, phi_z),
        )


def _in_plane(jet: Jet) -> Array:
    """Directions (..., 2) of the normals in the transverse plane."""
    flat: Array = jet.n[..., :2] / np.hypot(jet.n[..., 0], jet.n[..., 1])[..., None]
    return flat


#: an amount of 0 at any place
_ZERO_AMOUNT = np.zeros(())
#: no modification
NO_AMOUNT = AmountJet(*(_ZERO_AMOUNT,) * 6)


@dataclass(frozen=True)
class _Local:
    """Directions e_r = (c, s, 0), e_t = (-s, c, 0), e_z at points (...,)."""

    c: Array
    s: Array

    def vector(self, radial: Array | float, tangential: Array | float, axial: Array | float) -> Array:
        """Return vectors (..., 3) of components (...,)."""
        made = np.empty((*self.c.shape, 3))
        made[..., 0] = radial * self.c - tangential * self.s
        made[..., 1] = radial * self.s + tangential * self.c
        made[..., 2] = axial
        return made
