r"""Generating curves of worm flanks [ISO 10828]: a straight or rounded edge in a plane, an involute, a grinding disk.

Every curve lies on the flank of a right-hand thread that faces +z, and sweeps the flank in a screw motion. The thread
is centred on +x at z = 0 of the worm's frame. Profiles are those of `rack`: x outward from the reference cylinder,
n = (sin, -cos) out of the thread, and -y along the section's second axis.

      x ^   ____  thread     ZA  edge in the axial plane
        |  /    \            ZN  edge in the plane across the helix, in the middle of the space (or thread)
     ---+-/------\---> -y    ZI  involute of the transverse section
        |/        \          ZK, ZC  disk, axis across the helix in the middle of the space, profile a line or an arc
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.envelope.helicoid import Generatrix, swept
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, about_axis, components, dot
from gearmesh.records import dataclass
from gearmesh.tools.profile import Profile


@dataclass(frozen=True)
class PlaneEdge:
    """An edge in a plane that contains a line parallel to x and is turned out of the axial plane."""

    #: profile of the edge
    profile: Profile
    #: radius of the reference cylinder, mm
    radius: float
    #: axial advance of the thread, mm/rad
    screw: float
    #: angle of the plane out of the axial plane, rad
    tilt: float = 0.0
    #: height of the line parallel to x, mm
    middle: float = 0.0

    def at(self, p: Array) -> Generatrix:
        points, tangents, normals, turned = self.profile.section(np.asarray(p, dtype=float))
        # the unit tangent is the normal turned by a right angle, in the direction of growing x
        c, c_p = self._lift(points), self._lift(tangents)
        along, along_p = (self._lift(components(-b[..., 1], b[..., 0])) for b in (normals, turned))
        c = c + np.array([self.radius, 0.0, self.middle])
        return swept(c, (along, along_p), c_p, self.screw)

    def _lift(self, plane: Array) -> Array:
        x, w = plane[..., 0], -plane[..., 1]
        return components(x, -w * np.sin(self.tilt), w * np.cos(self.tilt))


@dataclass(frozen=True)
class TransverseInvolute:
    """Transverse section of ZI worms: an involute whose parameter p is the roll angle (rad)."""

    #: radius of the base circle, mm
    radius: float
    #: axial advance of the thread, mm/rad
    screw: float
    #: polar angle (rad) at which the involute begins on the base circle
    angle: float
    #: height z of the section, mm
    middle: float

    def at(self, p: Array) -> Generatrix:
        p = np.asarray(p, dtype=float)
        turn, r, screw = self.angle + p, self.radius, self.screw
        c, s, p_r = np.cos(turn), np.sin(turn), r * p
        # the normal is tangent x path = (c, s, 0) x (r e_s + p_r e_c + P e_z); its length is constant
        across = screw / np.hypot(screw, r)
        s_n, c_n = across * s, across * c
        return Generatrix(
            components(r * c + p_r * s, r * s - p_r * c, self.middle),
            components(s_n, -c_n, across * r / screw),
            components(p_r * c, p_r * s, 0.0),
            components(c_n, s_n, 0.0),
        )


@dataclass(frozen=True)
class DiskLine:
    """Line on which a disk touches the flank that it grinds: n . (e_z x r + P e_z) = 0.

    The line is the same at every place of the screw motion. Normals of the disk meet its axis at a point that does not
    depend on the angle delta about the axis. A shift of r along n does not change the equation. Let n_x and n_w be
    the components of the profile's normal across and along the disk's axis, rho the distance from this axis and w the
    coordinate along it:

        g sin(tilt) cos(delta) - n_x (a cos(tilt) + P sin(tilt)) sin(delta) + n_w (P cos(tilt) - a sin(tilt)) = 0,
        g = rho n_w - w n_x

    a is `distance`. The root nearer to 0 is the physical one. NaN where the profile does not touch the thread.
    """

    #: profile of the disk
    profile: Profile
    #: radius of the worm's reference cylinder, mm
    radius: float
    #: axial advance P of the thread, mm/rad
    screw: float
    #: angle between the axes of disk and worm, rad
    tilt: float
    #: height z of the disk's axis at the common perpendicular, mm
    middle: float
    #: distance a between the axes, mm
    distance: float

    def at(self, p: Array) -> Generatrix:
        points, tangents, normals, turned = self.profile.section(np.asarray(p, dtype=float))
        over, along = self.distance - self.radius - points[..., 0], points[..., 1]
        sin, cos = np.sin(self.tilt), np.cos(self.tilt)
        across, round_ = np.array([0.0, -sin, cos]), np.array([0.0, cos, sin])
        n_x, n_w = normals[..., 0], -normals[..., 1]
        inward, aside = _towards(self._half_angle(over, along, (n_x, n_w)), round_)
        axis = np.array([self.distance, 0.0, self.middle])
        r = axis - over[..., None] * inward - along[..., None] * across
        n = n_x[..., None] * inward + n_w[..., None] * across
        # partial derivatives by the disk's angle and along its profile
        r_d, n_d = -over[..., None] * aside, n_x[..., None] * aside
        r_p = tangents[..., :1] * inward - tangents[..., 1:] * across
        n_p = turned[..., :1] * inward - turned[..., 1:] * across
        # the derivative of the angle by p follows from df = 0 along the line
        path = about_axis(r) + self.screw * Z_AXIS
        f_d = dot(n_d, path) + dot(n, about_axis(r_d))
        rate = -((dot(n_p, path) + dot(n, about_axis(r_p))) / f_d)[..., None]
        return Generatrix(r, n, r_p + rate * r_d, n_p + rate * n_d)

    def _half_angle(self, over: Array, along: Array, normal: tuple[Array, Array]) -> Array:
        """Return tan(delta / 2) (...,) at which the disk touches; NaN where it does not."""
        sin, cos = np.sin(self.tilt), np.cos(self.tilt)
        n_x, n_w = normal
        level, swing = n_w * (self.screw * cos - self.distance * sin), (over * n_w - along * n_x) * sin
        slope = n_x * (self.distance * cos + self.screw * sin)
        # a negative square means that the thread passes the profile without touching it
        with np.errstate(invalid="ignore"):
            root = np.sqrt(slope**2 - level**2 + swing**2)
            return np.asarray((level + swing) / (slope + np.copysign(root, slope)))


def _towards(half: Array, round_: Array) -> tuple[Array, Array]:
    """Return unit vectors (..., 3) from a disk's rim to its axis and their derivatives by its angle.

    `half` (...,) is the tangent of half the angle.
    """
    scale = 1.0 / (1.0 + half**2)
    c, s = ((1.0 - half**2) * scale)[..., None], (2.0 * half * scale)[..., None]
    x = np.array([1.0, 0.0, 0.0])
    return c * x - s * round_, -s * x - c * round_
