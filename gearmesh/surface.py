"""What a surface is: a map (u, v) -> point, unit normal and their first partials (the jet).

Everything else (curvature, contact, tessellation) needs nothing more. Shapes are (..., 3) for vectors and (...,) for
parameters; lengths in mm. The normal points out of the material of the body that the surface bounds.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearmesh.frames import Array, Rigid, cross, dot


@dataclass(frozen=True)
class Jet:
    """Point r, unit normal n and their first partials, each (..., 3), at parameters (u, v) (...,)."""

    r: Array
    n: Array
    r_u: Array
    r_v: Array
    n_u: Array
    n_v: Array

    def moved(self, transform: Rigid) -> Jet:
        """The jet of the same surface in another frame."""
        r, *turned = transform.vectors(self.r, self.n, self.r_u, self.r_v, self.n_u, self.n_v)
        return Jet(r + transform.translation, *turned)

    def along(self, du: Array, dv: Array) -> tuple[Array, Array]:
        """Differentials (dr, dn), (..., 3), of point and normal for parameter differentials (...,)."""
        du, dv = du[..., None], dv[..., None]
        return self.r_u * du + self.r_v * dv, self.n_u * du + self.n_v * dv


class Surface(Protocol):
    """A surface with an exact jet."""

    def jet(self, u: Array, v: Array) -> Jet:
        """Jet at parameters u, v (...,)."""


def second_form(jet: Jet, first: tuple[Array, Array], second: tuple[Array, Array]) -> Array:
    """Second fundamental form -dn(first) . dr(second), (...,), of two parameter directions (du, dv)."""
    return -dot(jet.along(*first)[1], jet.along(*second)[0])


class Level(Protocol):
    """A function g(r) whose zero level bounds a body (g < 0 inside), with gradient and Hessian."""

    def value(self, r: Array) -> Array:
        """g at points (..., 3), (...,)."""

    def gradient(self, r: Array) -> Array:
        """Gradient, (..., 3)."""

    def hessian(self, r: Array, w: Array) -> Array:
        """Hessian applied to vectors w (..., 3), (..., 3)."""


@dataclass(frozen=True)
class PlaneLevel:
    """g = sign (z - z0): an end face across the axis; `sign` +1 bounds z < z0."""

    z0: float
    sign: float = 1.0

    def value(self, r: Array) -> Array:
        return self.sign * (r[..., 2] - self.z0)

    def gradient(self, r: Array) -> Array:
        return np.broadcast_to(np.array([0.0, 0.0, self.sign]), r.shape)

    def hessian(self, r: Array, w: Array) -> Array:
        return np.zeros_like(w)


@dataclass(frozen=True)
class ConeLevel:
    """g = rho - radius - slope z, a cone (slope 0: cylinder) about z; g < 0 on the side of the axis."""

    radius: float
    slope: float = 0.0

    def value(self, r: Array) -> Array:
        return np.hypot(r[..., 0], r[..., 1]) - self.radius - self.slope * r[..., 2]

    def gradient(self, r: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        return np.stack((r[..., 0] / rho, r[..., 1] / rho, np.full_like(rho, -self.slope)), axis=-1)

    def hessian(self, r: Array, w: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        x, y = r[..., 0] / rho, r[..., 1] / rho
        across = (x * w[..., 1] - y * w[..., 0]) / rho
        return np.stack((-y * across, x * across, np.zeros_like(rho)), axis=-1)


@dataclass(frozen=True)
class SlantLevel:
    """g = sin(angle) rho + cos(angle) z - offset: coaxial cones across a pitch cone of half angle `angle` (rad).

    The value is the distance along the pitch cone's generatrix (cone distance), mm; angle 0: planes across the axis.
    """

    angle: float
    offset: float = 0.0

    def value(self, r: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        return np.sin(self.angle) * rho + np.cos(self.angle) * r[..., 2] - self.offset

    def gradient(self, r: Array) -> Array:
        outward = np.sin(self.angle) / np.hypot(r[..., 0], r[..., 1])
        return np.stack((r[..., 0] * outward, r[..., 1] * outward, np.full_like(outward, np.cos(self.angle))), axis=-1)

    def hessian(self, r: Array, w: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        x, y = r[..., 0] / rho, r[..., 1] / rho
        across = np.sin(self.angle) * (x * w[..., 1] - y * w[..., 0]) / rho
        return np.stack((-y * across, x * across, np.zeros_like(rho)), axis=-1)


@dataclass(frozen=True)
class ConeSurface:
    """The cone rho = radius + slope z about z, parameters u = angle (rad) and v = z (mm); `sign` +1: normal outward."""

    radius: float
    slope: float = 0.0
    sign: float = 1.0

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        c, s, zero, one = np.cos(u), np.sin(u), np.zeros_like(u), np.ones_like(u)
        rho = self.radius + self.slope * v
        k = self.sign / np.hypot(1.0, self.slope)
        return Jet(
            r=np.stack((rho * c, rho * s, v), axis=-1),
            n=k * np.stack((c, s, -self.slope * one), axis=-1),
            r_u=np.stack((-rho * s, rho * c, zero), axis=-1),
            r_v=np.stack((self.slope * c, self.slope * s, one), axis=-1),
            n_u=k * np.stack((-s, c, zero), axis=-1),
            n_v=np.zeros((*u.shape, 3)),
        )


def area_normal(jet: Jet) -> Array:
    """r_u x r_v, (..., 3): its length is the area element, zero where the parametrisation degenerates."""
    return cross(jet.r_u, jet.r_v)


@dataclass(frozen=True)
class Shifted:
    """sign * (level - offset): the same family of surfaces, another member of it, either side."""

    level: Level
    offset: float
    sign: float = 1.0

    def value(self, r: Array) -> Array:
        return self.sign * (self.level.value(r) - self.offset)

    def gradient(self, r: Array) -> Array:
        return self.sign * self.level.gradient(r)

    def hessian(self, r: Array, w: Array) -> Array:
        return self.sign * self.level.hessian(r, w)
