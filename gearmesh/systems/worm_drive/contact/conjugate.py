"""Contact of a worm's flank with the flank that it generates, in closed form: the field of all its contact lines.

In the fixed frame z is the worm's axis; the wheel's axis passes through (a, 0, 0). A turning thread is equivalent to a
thread that slides along its axis. The points at (p, v) of its flank r(p, v) therefore touch at r + s e_z, with s linear
in the equation of meshing n . v12 = 0, v12 = v1 - v2. With W the shape operator of the worm's flank (dn = W dr) and b =
w12 x n - W v12, the contact moves over the wheel's flank by v_r2:

    b . v_r1 = (w1 x n) . v12 + n . (w12 x v1),   b . v_r2 = b . v_r1 + b . v12,   W2 - W1 = b b^T / (b . v_r2)  [LF04 8.4]

b is perpendicular to the contact line, in the tangent plane. The curvature of the gap along b is -|b|^2 / (b . v_r2).
"""

from __future__ import annotations

import math

import numpy as np

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot
from gearmesh.records import dataclass
from gearmesh.systems.worm_drive.thread import WormThread


@dataclass(frozen=True)
class ContactField:
    """Points of contact and the data of their lines, per rad/s of the worm."""

    #: points of contact (..., 3), mm
    r: Array
    #: unit normals (..., 3) out of the worm
    n: Array
    #: velocities (..., 3) of the worm's flank over the wheel's, mm/rad
    v12: Array
    #: vectors b (..., 3) of the module's text
    b: Array
    #: shifts s (...,), mm
    shift: Array
    #: b . v_r1 (...,)
    over_worm: Array
    #: b . v_r2 (...,)
    over_wheel: Array
    #: b . v_r (...,) over a thread that slides and does not turn
    over_thread: Array
    #: areas (...,) of the flank per dp dv
    area: Array

    @property
    def curvature(self) -> Array:
        """Curvature (...,) of the gap across the contact line, 1/mm.

        It is negative where the worm's flank cuts the wheel's flank away.
        """
        return np.asarray(-dot(self.b, self.b) / self.over_wheel)


@dataclass(frozen=True)
class ThreadMesh:
    """Thread of a worm in mesh with a wheel."""

    #: thread of the worm
    thread: WormThread
    #: side of the thread: +1 right, -1 left
    side: int
    #: number of teeth of the wheel
    teeth: int
    #: centre distance, mm
    distance: float
    #: angle by which the wheel's axis is turned about x out of the right angle, for right-hand threads, rad
    tilt: float

    @property
    def wheel_axis(self) -> Array:
        """Direction (3,) of the wheel's axis."""
        tilt = self.thread.hand * self.tilt
        return np.array([0.0, math.cos(tilt), math.sin(tilt)])

    @property
    def speeds(self) -> tuple[Array, Array]:
        """Angular velocities (3,) of worm and wheel per rad/s of the worm, which turns clockwise about z."""
        return -Z_AXIS, self.thread.hand * self.thread.threads / self.teeth * self.wheel_axis

    def at(self, p: Array, angle: Array) -> ContactField:
        """Return the contact at profile parameters p and polar angles (rad) about the worm's axis, from x."""
        flank = self.thread.flank(self.side)
        start = flank.jet(p, np.zeros_like(p)).r
        jet = flank.jet(p, angle - np.arctan2(start[..., 1], start[..., 0]))
        (w1, w2), centre = self.speeds, np.array([self.distance, 0.0, 0.0])
        w12, n = w1 - w2, jet.n
        # slide along the axis to the position at which the point meets the equation of meshing
        shift = dot(n, cross(w1, jet.r) - cross(w2, jet.r - centre)) / dot(n, cross(w2, Z_AXIS))
        r = jet.r + shift[..., None] * Z_AXIS
        v1 = cross(w1, r)
        v12 = v1 - cross(w2, r - centre)
        normal = cross(jet.r_u, jet.r_v)
        area = dot(normal, normal)
        # components of v12 along the parameters give W v12 by the derivatives of the normal
        along_u, along_v = (dot(cross(v12, jet.r_v), normal) / area, dot(cross(jet.r_u, v12), normal) / area)
        bent = along_u[..., None] * jet.n_u + along_v[..., None] * jet.n_v
        b = cross(w12, n) - bent
        over_worm = dot(cross(w1, n), v12) + dot(n, cross(w12, v1))
        over_thread = over_worm + dot(b, v1 - flank.screw * Z_AXIS)
        return ContactField(r, n, v12, b, shift, over_worm, over_worm + dot(b, v12), over_thread, np.sqrt(area))

    def at_reference(self) -> ContactField:
        """Contact on the worm's reference cylinder, in the plane of common perpendicular and worm axis: arrays (3,)."""
        return self.at(np.array(self.thread.at_radius(self.thread.radius)), np.array(0.0))
