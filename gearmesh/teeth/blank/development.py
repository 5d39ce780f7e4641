r"""Stations laid flat: the plane, cone or cylinder of a station is developed into a plane, which keeps lengths and
angles.

    station                     X, Y in the plane                              land of a tooth
    plane across the axis       x, y as they are                               circle about the origin, or line of a rack
    cone, apex on the axis      L cos(psi), L sin(psi), L from the apex,       circle about the apex
                                psi = theta |cos|, of the normal to the axis
    cylinder                    z, rho theta                                   line X = const

A drawing in the transverse section of a cylindrical gear is thus also one on the back cone of a bevel gear, and on the
cylinder of a face gear. Angles theta (rad) count from an angle `about` of each station.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.numeric.algebra import Array, components, dot
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Development:
    """Development of the stations of `axial`; `joint` is the motion from one tooth to the next."""

    axial: Level
    joint: Joint = REVOLUTE_JOINT

    @cached_property
    def _normal(self) -> tuple[float, float]:
        """Radial and axial component of the stations' unit normal."""
        return station_normal(self.axial)

    @property
    def _flat(self) -> bool:
        """True if the stations are planes."""
        return self._normal[0] == 0.0

    @property
    def _straight(self) -> bool:
        """True if a land is a line, not a circle."""
        return self._normal[1] == 0.0 or self.joint.travel is not None

    def about(self, r: Array) -> Array:
        """Return the angles (...,), rad, of points (..., 3), from which other angles count; 0 if stations are
        planes.
        """
        return np.zeros(r.shape[:-1]) if self._flat else np.asarray(np.arctan2(r[..., 1], r[..., 0]))

    def flat(self, r: Array, about: Array) -> Array:
        """Return X, Y (..., 2), mm, of points (..., 3) on their stations."""
        if self._flat:
            return r[..., :2]
        rho, theta = np.hypot(r[..., 0], r[..., 1]), self._angle(r, about)
        up = abs(self._normal[1])
        if up == 0.0:
            return components(r[..., 2], rho * theta)
        return components(rho / up * np.cos(theta * up), rho / up * np.sin(theta * up))

    def flat_vector(self, w: Array, r: Array, about: Array) -> Array:
        """Return the components (..., 2) of vectors (..., 3) in the stations of points r (..., 3)."""
        if self._flat:
            return w[..., :2]
        theta, turn = np.arctan2(r[..., 1], r[..., 0]), self._angle(r, about) * abs(self._normal[1])
        out, around = self._axes(theta)
        a, b = dot(w, out), dot(w, around)
        return components(a * np.cos(turn) - b * np.sin(turn), a * np.sin(turn) + b * np.cos(turn))

    def lift(self, q: Array, on: Array, about: Array) -> Array:
        """Return points (..., 3) of X, Y (..., 2) on the stations of points `on` (..., 3)."""
        rho = np.hypot(on[..., 0], on[..., 1])
        if self._flat:
            return components(q[..., 0], q[..., 1], on[..., 2])
        across, up = self._normal
        if up == 0.0:
            theta = about + q[..., 1] / rho
            return components(rho * np.cos(theta), rho * np.sin(theta), q[..., 0])
        cone_distance = np.hypot(q[..., 0], q[..., 1]) * abs(up)
        theta = about + np.arctan2(q[..., 1], q[..., 0]) / abs(up)
        return components(
            cone_distance * np.cos(theta),
            cone_distance * np.sin(theta),
            on[..., 2] - across / up * (cone_distance - rho),
        )

    def lift_vector(self, w: Array, r: Array, about: Array) -> Array:
        """Return vectors (..., 3) in the stations of points r (..., 3) from vectors (..., 2) in the plane."""
        if self._flat:
            return components(w[..., 0], w[..., 1], 0.0)
        theta, turn = np.arctan2(r[..., 1], r[..., 0]), self._angle(r, about) * abs(self._normal[1])
        out, around = self._axes(theta)
        a = w[..., 0] * np.cos(turn) + w[..., 1] * np.sin(turn)
        b = w[..., 1] * np.cos(turn) - w[..., 0] * np.sin(turn)
        vector: Array = a[..., None] * out + b[..., None] * around
        return vector

    def reach(self, q: Array) -> Array:
        """Coordinate (...,), mm, at right angles to the lands: radius about the origin, or X."""
        return np.asarray(q[..., 0] if self._straight else np.hypot(q[..., 0], q[..., 1]))

    def beside(self, q: Array, reach: Array, way: Array | float = 0.0) -> Array:
        """Return X, Y (..., 2), mm, at another reach, `way` farther round than q; `way` is an arc at the reach of q."""
        if self._straight:
            return components(reach, q[..., 1] + way)
        angle = np.arctan2(q[..., 1], q[..., 0]) + way / np.hypot(q[..., 0], q[..., 1])
        return components(reach * np.cos(angle), reach * np.sin(angle))

    def _angle(self, r: Array, about: Array) -> Array:
        """Polar angle (...,), rad, less `about`, between -pi and pi."""
        return REVOLUTE_JOINT.within(np.arctan2(r[..., 1], r[..., 0]) - about)

    def _axes(self, theta: Array) -> tuple[Array, Array]:
        """Unit vectors (..., 3) at polar angles (...,): along the generatrix of a station as X or L grows, and round
        the axis.
        """
        across, up = self._normal
        away = -across * np.sign(up) if up else 1.0
        out = components(abs(up) * np.cos(theta), abs(up) * np.sin(theta), away)
        return out, components(-np.sin(theta), np.cos(theta), 0.0)
