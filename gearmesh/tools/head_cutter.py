r"""Head cutters: a blade profile turned about the cutter's axis (face milling), or a cutting edge (face hobbing).

Cutter frame: origin in the tip plane on the axis, z along the axis from the cutter into the blank. The blade profile is
a curve (x, y) of `tools.rack`. x is the height over the tip plane. y is the radius for outside blades and minus the
radius for inside blades. Both then follow the rack's rule: the blank's outward normal is (sin, -cos).

      x ^        inside blade   outside blade
        |             \  _____  /             radius at height x: r - x tan(alpha) inside,
        |              \/     \/                                  r + x tan(alpha) outside
        +----- axis ------ r ------> radius

Outside blades generate the concave flanks of the blank, inside blades the convex flanks [AB Figs. 4, 5]. A toprem is a
part of the blade next to its tip. It protrudes from the rest of the blade and relieves the flank towards the root.

      x ^             / cutting edge
        |            /
        |           /   <- toprem begins: at an angle (straight) or tangent (arc)
        |          |
        |         _/    <- tip rounding of the edge radius
        +-------------------> radius
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.envelope.swept_curve import Edge
from gearmesh.kernel.numeric.algebra import Array, about_axis, broadcast_pair, components
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.tools.description import Dimension, HeightZero, ToolDescription
from gearmesh.tools.drawing import TurnedDrawing
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, ProfilePieces, RackLine

#: side of an outside blade
OUTSIDE_BLADE = 1
#: side of an inside blade
INSIDE_BLADE = -1
#: range of the parameter over a sharp edge next to a toprem
SHARP_EDGE_LENGTH_MM = 0.1


@dataclass(frozen=True)
class Revolved:
    """Surface of revolution of a blade profile; parameters (p, v): profile parameter and angle (rad) from `angle0`.

    `side` is OUTSIDE_BLADE or INSIDE_BLADE. The normal points out of the blank's tooth, into the cutter.
    """

    profile: Profile
    side: int
    angle0: float = 0.0

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        c, s = np.cos(self.angle0 + v), np.sin(self.angle0 + v)
        # points, tangents, normals and dn/dp in the axial plane, turned to the angle v; z is minus the height
        plane = np.array(self.profile.section(u))
        radial, space = self.side * plane[..., 1], np.empty((*plane.shape[:-1], 3))
        space[..., 0], space[..., 1], space[..., 2] = radial * c, radial * s, -plane[..., 0]
        points, tangents, normals, bent = space
        return Jet(points, normals, tangents, about_axis(points), bent, about_axis(normals))


@dataclass(frozen=True)
class BladeEdge:
    """Cutting edge of a blade in the cutter frame; the blade's face is a plane parallel to the cutter's axis.

    The face contains the point at the cutter's `radius` on the x axis. It is turned there by `offset_angle` about the
    direction of z; at 0 it contains the axis. `SweptCurve.sense` is minus the side of the blade.
    """

    #: profile of the blade
    profile: Profile
    #: OUTSIDE_BLADE or INSIDE_BLADE
    side: int
    #: radius of the cutter at which the blade's face is turned, mm
    radius: float
    #: angle between the blade's face and the radius of the cutter, rad
    offset_angle: float

    def at(self, u: Array) -> Edge:
        """Return points and tangents of the edge at the profile's parameter u (...,)."""
        points, derivatives, normals, bent = self.profile.section(u)
        # the tangent turned by -90 deg is the profile's normal, even at a corner of the edge
        tangent, tangent_u = (np.stack((-a[..., 1], a[..., 0]), axis=-1) for a in (normals, bent))
        c, s = np.cos(self.offset_angle), np.sin(self.offset_angle)

        def in_space(plane: Array, radius: float = 0.0) -> Array:
            across = self.side * plane[..., 1] - radius
            return components(radius + c * across, s * across, -plane[..., 0])

        return Edge(in_space(points, self.radius), *map(in_space, (tangent, derivatives, tangent_u)))


@dataclass(frozen=True)
class Toprem:
    """Part of a blade next to its tip, from `height` (mm) over the tip plane down.

    The toprem is straight at `angle` (rad) to the cutter's axis. With `radius` > 0 (mm) it is instead an arc that is
    tangent to the cutting edge and bends away from it.
    """

    height: float
    angle: float = 0.0
    radius: float = 0.0

    @property
    def kinked(self) -> bool:
        """True if the toprem meets the cutting edge in a corner."""
        return self.radius == 0.0


@dataclass(frozen=True)
class Blade:
    """Straight or circular-arc blade with a rounded tip."""

    #: OUTSIDE_BLADE or INSIDE_BLADE
    side: int
    #: radius of the cutter (mm) where the extended cutting edge meets the tip plane
    tip_radius: float
    #: angle (rad) between cutting edge and cutter axis; for an arc the angle at `height`
    blade_angle: float
    #: rounding of the tip, mm; 0 for a sharp tip
    edge_radius: float
    #: radius of the cutting edge, mm; > 0 is convex (its centre in the blade), 0 is straight
    blade_radius: float = 0.0
    #: height over the tip plane (mm) at which an arc has the blade angle
    height: float = 0.0
    #: toprem, which relieves the flank next to the tip
    toprem: Toprem | None = None

    @staticmethod
    def through(
        side: int, radius: float, height: float, blade_angle: float, edge_radius: float, blade_radius: float = 0.0
    ) -> Blade:
        """Return the blade whose cutting edge passes through the cutter's `radius` at `height` over the tip plane."""
        blade = Blade(side, radius, blade_angle, edge_radius, blade_radius, height)
        return replace(blade, tip_radius=2.0 * radius - blade.radius_at(height))

    @property
    def description(self) -> ToolDescription:
        dimensions = (
            Dimension("point radius", self.tip_radius, "mm", "r_P0"),
            Dimension("blade angle", float(np.degrees(self.blade_angle)), "deg", "alpha_0"),
            Dimension("edge radius", self.edge_radius, "mm", "rho_a0"),
        )
        zero = HeightZero.TIP_PLANE
        return ToolDescription("head cutter", TurnedDrawing(), dimensions, self.flank, self.tip, self.edge_radius, zero)

    @cached_property
    def flank(self) -> RackLine | Arc:
        """Profile of the cutting edge."""
        if self.blade_radius == 0.0:
            return RackLine(self.blade_angle, 0.0, -self.side * self.tip_radius)
        radius = self.blade_radius
        centre_x = self.height + radius * np.sin(self.blade_angle)
        # the arc centre - radius n, n = (sin p, -cos p), passes through (0, +-tip_radius)
        # NaN for an arc too small to reach the tip plane; the bounds of `blade_radius` refuse such an arc
        reach = np.sqrt(radius**2 - centre_x**2) if abs(radius) >= abs(centre_x) else np.nan
        centre_y = self.side * self.tip_radius - np.sign(radius) * reach
        return Arc((float(centre_x), float(centre_y)), -radius)

    @cached_property
    def _last(self) -> RackLine | Arc:
        """Profile next to the rounding: the toprem, or the cutting edge if there is no toprem."""
        if self.toprem is None:
            return self.flank
        point, _, normal, _ = self.flank.section(np.array(self.at_height(self.toprem.height)))
        if self.toprem.kinked:
            return RackLine(self.toprem.angle, 0.0, float(point[0] * np.tan(self.toprem.angle) - point[1]))
        centre = point - self.toprem.radius * normal
        return Arc((float(centre[0]), float(centre[1])), self.toprem.radius)

    @cached_property
    def _touch(self) -> tuple[float, float]:
        """Parameter of the profile that the rounding touches, and the rounding's angle (rad) there; NaN if none."""
        last, edge = self._last, self.edge_radius
        if isinstance(last, RackLine):
            return last.at_height(edge * (1.0 - np.sin(last.alpha))), last.alpha
        # the rounding's centre is at the height of its radius, and at the sum of both radii from the arc's centre
        angle = _arcsine((edge - last.centre[0]) / (edge + last.radius))
        return angle, angle

    @cached_property
    def form_point(self) -> tuple[float, float]:
        """Parameters of cutting edge and `tip` where they join smoothly, or at the corner of a straight toprem."""
        if self.toprem is None:
            return self._touch
        return self.at_height(self.toprem.height), self._knots[0]

    @cached_property
    def rounding(self) -> Arc:
        """Profile of the tip rounding, up to the tip plane at p = pi/2."""
        point, _, normal, _ = self._last.section(np.array(self._touch[0]))
        centre = point + self.edge_radius * normal
        return Arc((float(centre[0]), float(centre[1])), -self.edge_radius)

    @cached_property
    def tip(self) -> Profile:
        """Profile of toprem and tip rounding, from the `form_point` to the tip plane at `root`."""
        if self.toprem is None:
            return self.rounding
        piece_parameters = (self._toprem_begins, self._touch[0]), (self._touch[1], 0.5 * np.pi)
        return ProfilePieces((self._last, self.rounding), self._knots, piece_parameters)

    @property
    def _toprem_begins(self) -> float:
        """Parameter of the toprem's profile at the cutting edge."""
        assert self.toprem is not None
        height = self.toprem.height
        return self._last.at_height(height) if isinstance(self._last, RackLine) else self.angle_at(height)

    @cached_property
    def _knots(self) -> tuple[float, float, float]:
        """Parameters of `tip`, lengths (mm) from the tip plane: begin of the toprem, begin of the rounding, 0."""
        rounding = self.edge_radius * (0.5 * np.pi - self._touch[1]) or SHARP_EDGE_LENGTH_MM
        along = self._toprem_begins - self._touch[0]
        if isinstance(self._last, Arc):
            along *= self._last.radius
        return float(rounding + along), float(rounding), 0.0

    @property
    def root(self) -> float:
        """Parameter of `tip` where the tip plane begins."""
        return 0.5 * np.pi if self.toprem is None else 0.0

    @property
    def tip_breaks(self) -> tuple[float, ...]:
        """Parameters of `tip` at jumps of its curvature."""
        return () if self.toprem is None else self._knots[1:-1]

    @property
    def land_radius(self) -> float:
        """Radius of the cutter (mm) where the tip rounding joins the tip plane."""
        return float(self.side * self.rounding.section(np.array(0.5 * np.pi))[0][1])

    def angle_at(self, height: float) -> float:
        """Return the angle (rad) between cutting edge and cutter axis at a height (mm) over the tip plane."""
        return self.blade_angle if isinstance(self.flank, RackLine) else self.at_height(height)

    def at_height(self, height: float) -> float:
        """Return the profile parameter of the cutting edge at a height (mm) over the tip plane."""
        if isinstance(self.flank, RackLine):
            return self.flank.at_height(height)
        return _arcsine((self.flank.centre[0] - height) / self.blade_radius)

    def radius_at(self, height: float) -> float:
        """Return the radius of the cutter (mm) on the cutting edge at a height over the tip plane."""
        point = self.flank.section(np.array(self.at_height(height)))[0]
        return float(self.side * point[1])


def _arcsine(sine: float) -> float:
    """Return the angle (rad) of a sine; NaN where an arc does not reach that far."""
    return float(np.arcsin(sine)) if abs(sine) <= 1.0 else np.nan
