"""Rack cutters: a profile in the normal section, swept straight along the tooth trace.

Normal section S_n as in Fig. 1 of [LT02]: x points outward from the blank's axis, y along the pitch plane. The blank's
tooth is in the space of the rack. This space is centred on y = 0, and its right side is y < 0.

          x ^
            |   /  space of the rack = tooth of the blank
        ----+--/---- pitch plane
            | /  flank, outward normal of the blank's tooth n = (sin, -cos)
       ____ |(   tip rounding: generates the fillet
            tip plane: generates the root

The section is swept along u. The sweep is tilted by the helix angle beta in the pitch plane, and the pitch plane is
tilted by the cone angle delta against the blank's axis [LT02 2]. [LT85 8] is the case delta = 0 with beta = 90 deg -
lead angle.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.tools.description import Dimension, HeightZero, RolledRack, ToolDescription
from gearmesh.tools.drawing import StraightDrawing
from gearmesh.tools.profile import Profile

#: Newton steps to a height of a profile; a line needs one
MAX_HEIGHT_STEPS = 8


@dataclass(frozen=True)
class RackLine:
    """Straight flank [LT02 1]: x = p cos(alpha) - a + shift, y = p sin(alpha) - a tan(alpha) - b."""

    #: angle between flank and x axis, rad
    alpha: float
    #: height of the origin of p below the pitch plane, mm
    a: float
    #: half width of the space at x = 0, mm
    b: float
    #: displacement of the line along x (profile shift), mm
    shift: float = 0.0

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        c, s, below, along_line, normal = self._constants
        points = components(p * c - self.a + self.shift, p * s - below - self.b)
        along, normals = np.empty(points.shape), np.empty(points.shape)
        along[...], normals[...] = along_line, normal
        return points, along, normals, np.zeros(points.shape)

    @cached_property
    def _constants(self) -> tuple[float, float, float, Array, Array]:
        """Cosine and sine of alpha, a tan(alpha), direction (2,) and normal (2,) of the line."""
        c, s = np.cos(self.alpha), np.sin(self.alpha)
        return float(c), float(s), float(self.a * np.tan(self.alpha)), np.array((c, s)), np.array((s, -c))

    @property
    def line(self) -> RackLine:
        """The tangent of a `Parabola`, which is this line."""
        return self

    @property
    def coefficient(self) -> float:
        return 0.0

    def at_height(self, x: float) -> float:
        """Return the parameter p (mm) of the point at a height x, mm."""
        p: float = (x + self.a - self.shift) / np.cos(self.alpha)
        return p

    def bend_limit(self, x: float) -> float:
        """Return the coefficient from which on a parabola bends back before a height: infinity, as a line is none."""
        return np.inf


@dataclass(frozen=True)
class Parabola:
    """Flank that deviates from its tangent `line` by `coefficient` (p - `vertex`)^2 [LF04 17.7, Table 17.8.1].

    A `coefficient` (1/mm) > 0 removes material from the blank's tooth on either side of the vertex (mm); < 0 leaves
    more material.
    """

    line: RackLine
    coefficient: float
    vertex: float

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        points, along, normals, _ = self.line.section(p)
        away = np.asarray(p - self.vertex)[..., None]
        slope = 2.0 * self.coefficient * away
        shorter = 1.0 / np.sqrt(1.0 + slope**2)
        tangents = along - slope * normals
        turned = 2.0 * self.coefficient * shorter**3 * tangents
        return points - self.coefficient * away**2 * normals, tangents, (normals + slope * along) * shorter, turned

    def at_height(self, x: float) -> float:
        """Return the parameter p (mm) of the parabola's point at a height x, mm; NaN if it bends back before this
        height."""
        c, s = np.cos(self.line.alpha), np.sin(self.line.alpha)
        rise = (self.line.at_height(x) - self.vertex) * c
        with np.errstate(invalid="ignore"):
            root = np.sqrt(c**2 - 4.0 * self.coefficient * s * rise)
        return float(self.vertex + 2.0 * rise / (c + root))

    def bend_limit(self, x: float) -> float:
        """Return the size (1/mm) of the coefficient from which on the parabola bends back before a height x, mm."""
        c, s = np.cos(self.line.alpha), np.sin(self.line.alpha)
        rise = (self.line.at_height(x) - self.vertex) * c
        return float(c**2 / (4.0 * s * abs(rise)))


@dataclass(frozen=True)
class Arc:
    """Circular arc centre + radius n, n = (sin p, -cos p), p in rad [LT85 5]; centre (x, y) and radius in mm.

    A radius > 0 makes the blank's tooth convex, and a radius < 0 makes it concave (a tool's tip rounding). A radius of
    0 is a sharp tool edge, whose normals fan out: the envelope is the trochoid of the edge.
    """

    centre: tuple[float, float]
    radius: float

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        c, s = np.cos(p), np.sin(p)
        normals, turned = components(s, -c), components(c, s)
        return np.array(self.centre) + self.radius * normals, self.radius * turned, normals, turned


def at_height(profile: Profile, x: float, start: float) -> float:
    """Return p of the point of a profile at height x (mm), by Newton's method from p = `start`; NaN if it fails."""
    p = start
    with np.errstate(divide="ignore", invalid="ignore"):
        for _ in range(MAX_HEIGHT_STEPS):
            point, tangent, _, _ = profile.section(np.array(p))
            p = p - float((point[0] - x) / tangent[0])
    return p


@dataclass(frozen=True)
class Reversed:
    """A profile with its material on the other side, traversed in the opposite direction: p' = -p, n' = -n."""

    profile: Profile

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        points, tangents, normals, turned = self.profile.section(-np.asarray(p, dtype=float))
        return points, -tangents, -normals, turned


@dataclass(frozen=True)
class RolledArc:
    """An arc with the parameter p = pi/2 - cot(angle), in which generated points are about evenly spaced.

    This holds down to small angles: the normal at a point of height x meets the pitch plane at the distance x
    cot(angle) along it.
    """

    arc: Arc

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        cotangent = 0.5 * np.pi - np.asarray(p, dtype=float)
        points, tangents, normals, turned = self.arc.section(np.arctan2(1.0, cotangent))
        rate = (1.0 / (1.0 + cotangent**2))[..., None]
        return points, tangents * rate, normals, turned * rate

    @staticmethod
    def parameter(angle: float) -> float:
        """Return p of an angle (rad)."""
        return float(0.5 * np.pi - 1.0 / np.tan(angle))


@dataclass(frozen=True)
class ProfilePieces:
    """Pieces of profiles in sequence: piece k lies between `knots` k and k + 1.

    The surface generated by the pieces is continuous; the pieces themselves need not be.
    """

    #: profiles of the K pieces
    profiles: tuple[Profile, ...]
    #: parameters p (K + 1,) at the ends of the pieces, decreasing, as p does along a tip
    knots: tuple[float, ...]
    #: the profile's own parameter at both ends of each piece, linear in p between them
    own: tuple[tuple[float, float], ...]

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        p = np.asarray(p, dtype=float)
        number = np.sum([p < knot for knot in self.knots[1:-1]], axis=0, dtype=np.intp)
        points, tangents, normals, turned = (np.empty((*p.shape, 2)) for _ in range(4))
        for k, (profile, (first, last)) in enumerate(zip(self.profiles, self.own, strict=True)):
            here = number == k
            if not here.any():
                continue
            rate = (last - first) / (self.knots[k + 1] - self.knots[k])
            points[here], along, normals[here], turning = profile.section(first + (p[here] - self.knots[k]) * rate)
            tangents[here], turned[here] = along * rate, turning * rate
        return points, tangents, normals, turned


@dataclass(frozen=True)
class RackSurface:
    """Cutter surface swept by `profile`; parameters (p, u): profile parameter and length along the tooth trace, mm.

    The frame is S_c of [LT02 Fig. 2]; the normal points out of the blank's tooth, into the cutter.
    """

    #: profile in the normal section
    profile: Profile
    #: helix angle beta, rad
    helix: float
    #: cone angle delta, rad
    cone: float
    #: +1 for the right side (y < 0), -1 for its mirror image, the left side
    side: int = 1

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        lift, trace = self.directions
        points, tangents, normals, turned = np.array(self.profile.section(u)) @ lift
        along = np.empty((*u.shape, 3))
        along[...] = trace
        return Jet(points + v[..., None] * trace, normals, tangents, along, turned, np.zeros((*u.shape, 3)))

    @cached_property
    def directions(self) -> tuple[Array, Array]:
        """Directions of x_n and y_n (2, 3) and of u (3,) of this side; the left side has y_n reversed."""
        axes = self.axes
        return axes[:2] * np.array([[1.0], [self.side]]), axes[2]

    def cutter(self, tip: Profile, tip_radius: float, radius: float) -> ToolDescription:
        """Return the description of the rack cutter with this flank.

        The cutter rolls on a pitch `radius` (mm), and `tip` generates the fillet.
        """
        dimensions = (
            Dimension("helix angle", float(np.degrees(self.helix)), "deg", "beta_0"),
            Dimension("tip radius", tip_radius, "mm", "rho_a0"),
        )
        rack = RolledRack(self, radius)
        return ToolDescription(
            "rack cutter",
            StraightDrawing(radius),
            dimensions,
            self.profile,
            tip,
            tip_radius,
            HeightZero.PITCH_PLANE,
            rack,
        )

    @property
    def axes(self) -> Array:
        """Rows: the directions of x_n, y_n and u in S_c [LT02 2]."""
        cd, sd, cb, sb = np.cos(self.cone), np.sin(self.cone), np.cos(self.helix), np.sin(self.helix)
        return np.array([[cd, 0.0, -sd], [-sb * sd, cb, -sb * cd], [cb * sd, sb, cb * cd]])
