r"""Tools of straight bevel gears: one side of a space of the crown gear, the bevel gear with a flat pitch cone.

Machine frame: the apex is the origin, x is along the pitch line from the apex to the heel, z along the crown gear's axis
into the blank. The blank's right flank has y < 0; its left flank is the mirror image.

          -z ^   / space of the crown gear = tooth of the blank
             |  /
         ----+-/------ pitch plane, y towards the middle of the tooth
             |/  flank, outward normal of the blank's tooth (0, -cos(alpha), -sin(alpha)) on the pitch plane
       _____ (   tip rounding of the tool: generates the fillet
            tip cone about the crown gear's axis: generates the root cone

Every flank is a cone over the apex: r = R e(u), with a curve e(u) on the unit sphere and a normal n(u). The curve is a
great circle (octoid) or a spherical involute. A ball that rolls along flank and tip cone sweeps the tip rounding.
"""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components, dot
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: largest number of Newton steps to the line in which a ball touches flank and tip cone
MAX_FORM_STEPS = 30
#: step (rad) at which the iteration ends
FORM_STEP_RAD = 1e-15


@dataclass(frozen=True)
class CurvePoint:
    """Point of a curve on the unit sphere."""

    #: points (..., 3)
    e: Array
    #: derivatives (..., 3) of the points by u
    e_u: Array
    #: outward unit normals (..., 3) of the flank
    n: Array
    #: derivatives (..., 3) of the normals by u
    n_u: Array


class CrownCurve(Protocol):
    """Right flank of a space of the crown gear on the unit sphere, by u (rad): 0 on the pitch plane, > 0 to the tip."""

    def at(self, u: Array) -> CurvePoint:
        """Return the curve at u (...,)."""


@dataclass(frozen=True)
class OctoidCurve:
    """Great circle: the crown gear's flank is a plane through the apex, as straight cutting edges make it."""

    #: pressure angle, rad
    pressure_angle: float

    def at(self, u: Array) -> CurvePoint:
        s, c = np.sin(self.pressure_angle), np.cos(self.pressure_angle)
        cosine, sine, zero = np.cos(u), np.sin(u), np.zeros_like(u)
        normal = np.broadcast_to(np.array([0.0, -c, -s]), (*np.shape(u), 3))
        return CurvePoint(
            components(cosine, s * sine, -c * sine),
            components(-sine, s * cosine, -c * cosine),
            normal,
            components(zero, zero, zero),
        )


@dataclass(frozen=True)
class SphericalInvoluteCurve:
    """Spherical involute: a great circle rolls without sliding on the base circle, a circle of the unit sphere.

    The base circle has the polar distance 90 deg - alpha from the crown gear's axis. psi = 90 deg - u / tan(alpha) is
    the arc of the great circle from the point of rolling to the curve.
    """

    #: pressure angle, rad
    pressure_angle: float

    @property
    def reach(self) -> float:
        """Largest |u| (rad): the cusps of the curve on both base circles."""
        return float(0.5 * np.pi * np.tan(self.pressure_angle))

    def at(self, u: Array) -> CurvePoint:
        s, c, tangent = np.sin(self.pressure_angle), np.cos(self.pressure_angle), np.tan(self.pressure_angle)
        roll, turn = u / tangent, u / s
        sine, cosine = np.cos(roll), np.sin(roll)  # of psi
        ct, st, zero = np.cos(turn), np.sin(turn), np.zeros_like(u)
        # at the point of rolling: outward from the axis, around the axis, and normal to the rolling circle's plane
        outward = components(st, -ct, zero)
        around = components(-ct, -st, zero)
        axis = components(zero, zero, zero - 1.0)
        rolling = c * outward + s * axis
        upwards = c * axis - s * outward
        e = cosine[..., None] * rolling - sine[..., None] * around
        n = sine[..., None] * rolling + cosine[..., None] * around
        return CurvePoint(e, sine[..., None] * upwards, n, -cosine[..., None] * upwards)


@dataclass(frozen=True)
class CrownSpace:
    """One side of a space of the crown gear: flank, tip rounding and tip cone."""

    #: curve of the flank on the unit sphere
    curve: CrownCurve
    #: pressure angle at the pitch plane, rad
    pressure_angle: float
    #: mean cone distance, mm
    mean: float
    #: depth of the tip cone below the pitch plane at the mean cone distance, mm
    depth: float
    #: tangent of the angle between tip cone and pitch plane, > 0 where the depth grows to the heel
    slope: float
    #: rounding of the tip, mm
    edge_radius: float
    #: +1 for right flanks of the blank (y < 0), -1 for left flanks
    side: int = 1

    @cached_property
    def flank(self) -> CrownFlank:
        """The flank, with p = 0 at the tip rounding."""
        return CrownFlank(self)

    @cached_property
    def tip(self) -> CrownTip:
        """The tip rounding."""
        return CrownTip(self)

    @property
    def mirror(self) -> Array:
        """Factors (3,) of the coordinates for this side."""
        return np.array([1.0, self.side, 1.0])

    def form_line(self, distance: Array) -> tuple[Array, Array]:
        """Return u (...,), rad, of the line in which the ball touches the flank, at cone distances (...,), and du/dR.

        The ball's centre R e + r n is at the radius r over the tip cone.
        """
        radius, slope = self.edge_radius, self.slope
        across = radius * np.hypot(1.0, slope)
        lift = radius * (1.0 - np.sin(self.pressure_angle))
        depth = self.depth + (distance - self.mean) * slope - lift
        u = -np.arcsin(np.clip(depth / distance / np.cos(self.pressure_angle), -1.0, 1.0))
        for _ in range(MAX_FORM_STEPS):
            at = self.curve.at(u)
            centre = distance[..., None] * at.e + radius * at.n
            by_u = distance[..., None] * at.e_u + radius * at.n_u
            rho = np.hypot(centre[..., 0], centre[..., 1])
            above = -centre[..., 2] + self.depth + (rho - self.mean) * slope - across
            above_u = -by_u[..., 2] + slope * (centre[..., 0] * by_u[..., 0] + centre[..., 1] * by_u[..., 1]) / rho
            step = above / above_u
            u = u - step
            if not (np.abs(step) > FORM_STEP_RAD).any():
                break
        above_r = -at.e[..., 2] + slope * (centre[..., 0] * at.e[..., 0] + centre[..., 1] * at.e[..., 1]) / rho
        return u, -above_r / above_u

    def cone_normal(self, r: Array, along: Array) -> tuple[Array, Array]:
        """Return the tip cone's normal (..., 3) into the tool at points r (..., 3), and its derivative along `along`."""
        rho = np.hypot(r[..., 0], r[..., 1])
        flat = r * np.array([1.0, 1.0, 0.0]) / rho[..., None]
        moved = along * np.array([1.0, 1.0, 0.0])
        turned = (moved - flat * dot(flat, moved)[..., None]) / rho[..., None]
        steep = 1.0 / np.hypot(1.0, self.slope)
        return steep * (self.slope * flat - np.array([0.0, 0.0, 1.0])), steep * self.slope * turned


@dataclass(frozen=True)
class CrownFlank:
    """Flank; parameters (p, v): length up the profile at the mean cone distance, mm, and cone distance from there, mm."""

    space: CrownSpace

    def jet(self, u: Array, v: Array) -> Jet:
        p, v = broadcast_pair(u, v)
        space, distance = self.space, self.space.mean + v
        form, form_v = space.form_line(distance)
        at = space.curve.at(form + p / space.mean)
        mirror, rate = space.mirror, 1.0 / space.mean
        e_u, n_u = at.e_u * mirror, at.n_u * mirror
        e = at.e * mirror
        return Jet(
            distance[..., None] * e,
            at.n * mirror,
            rate * distance[..., None] * e_u,
            e + (distance * form_v)[..., None] * e_u,
            rate * n_u,
            form_v[..., None] * n_u,
        )


@dataclass(frozen=True)
class CrownTip:
    """Tip rounding; parameters (q, v): q from 0 at the flank to 1 at the tip cone, and as the flank's v."""

    space: CrownSpace

    def jet(self, u: Array, v: Array) -> Jet:
        q, v = broadcast_pair(u, v)
        space, distance = self.space, self.space.mean + v
        form, form_v = space.form_line(distance)
        at, radius = space.curve.at(form), space.edge_radius
        normal, normal_v = at.n, at.n_u * form_v[..., None]
        centre = distance[..., None] * at.e + radius * normal
        centre_v = at.e + (distance * form_v)[..., None] * at.e_u + radius * normal_v
        cone, cone_v = space.cone_normal(centre, centre_v)
        # the ball's normals turn evenly from the flank's to the tip cone's by `turn`
        cosine = dot(normal, cone)
        turn = np.arccos(cosine)
        sine = np.sin(turn)
        turn_v = -(dot(normal_v, cone) + dot(normal, cone_v)) / sine
        first, second = (1.0 - q) * turn, q * turn
        weights = np.sin(first) / sine, np.sin(second) / sine
        by_q = -turn * np.cos(first) / sine, turn * np.cos(second) / sine
        by_turn = (
            ((1.0 - q) * np.cos(first) - weights[0] * cosine) / sine,
            (q * np.cos(second) - weights[1] * cosine) / sine,
        )
        n = weights[0][..., None] * normal + weights[1][..., None] * cone
        n_q = by_q[0][..., None] * normal + by_q[1][..., None] * cone
        n_v = weights[0][..., None] * normal_v + weights[1][..., None] * cone_v
        n_v = n_v + (turn_v * by_turn[0])[..., None] * normal + (turn_v * by_turn[1])[..., None] * cone
        mirror = space.mirror
        r, r_q, r_v = centre - radius * n, -radius * n_q, centre_v - radius * n_v
        return Jet(*(part * mirror for part in (r, n, r_q, r_v, n_q, n_v)))


@dataclass(frozen=True)
class MeanSection:
    """Profile of a tool at its v = 0, seen along the tooth; x is the height over the tip cone there."""

    #: tool in the machine frame
    surface: Surface
    #: depth of the tip cone below the pitch plane, mm
    depth: float
    #: +1 for right flanks, -1 for left flanks
    side: int

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        jet = self.surface.jet(np.asarray(p, dtype=float), np.zeros(np.shape(p)))
        points, tangents, normals, turned = (
            np.stack((-part[..., 2], self.side * part[..., 1]), axis=-1) for part in (jet.r, jet.r_u, jet.n, jet.n_u)
        )
        return points + np.array([self.depth, 0.0]), tangents, normals, turned
