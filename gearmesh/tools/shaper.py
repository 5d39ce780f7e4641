"""The involute shaper that generates a face gear: a spur pinion with slightly longer teeth [LF04 18.5].

Cross section in the frame of the racks: x points from the shaper's pitch cylinder towards the shaper's axis, which is
outward from the face gear's root; y points across. The gear's tooth is in the space of the shaper, which is centred on
y = 0.

          x ^   axis of the shaper far above
        ---+---  base circle: the involute begins, theta_s = 0
           |  /
        ---+-/--  pitch cylinder
           |/  involute, outward normal of the gear's tooth n = (sin, -cos)
      ____ (   tip rounding: generates the fillet; a sharp edge for a radius of 0
           top cylinder: generates the root

The surface is the cylinder over this section, `RackSurface(profile, helix=0, cone=0, side)`.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError, VagueError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.records import dataclass
from gearmesh.tools.description import Dimension, HeightZero, ToolDescription
from gearmesh.tools.drawing import ShaperDrawing
from gearmesh.tools.rack import Arc


@dataclass(frozen=True)
class Involute:
    """Involute of the circle of `base_radius` (mm) that begins at the angle `start` (rad) from x [LF04 18.5.2].

    The parameter is theta_s, rad: the tangent of the pressure angle. x is 0 at `pitch_radius` (mm).
    """

    base_radius: float
    start: float
    pitch_radius: float

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        c, s = np.cos(self.start + p), np.sin(self.start + p)
        outward, normals = np.stack((c, s), axis=-1), np.stack((s, -c), axis=-1)
        away = self.base_radius * np.asarray(p)[..., None]
        points = np.array([self.pitch_radius, 0.0]) - self.base_radius * outward - away * normals
        return points, -away * outward, normals, outward


@dataclass(frozen=True)
class ShaperFlank:
    """Flank of a shaper's tooth: pressure angle and additional thickness of symmetric teeth with this flank, tip rounding."""

    #: pressure angle, rad
    pressure_angle: float
    #: additional tooth thickness on the pitch circle, mm
    thicker: float = 0.0
    #: rounding of the tip, mm; None: as on the other flank
    tip_radius: float | None = None


@dataclass(frozen=True)
class Shaper:
    """An involute spur shaper. Its profile is one flank, with half of the tooth up to the tooth's middle.

    A tooth whose other flank is not the mirror image has an `opposite` flank. Both flanks together leave the top land.

    Raises DesignError, with key, value and limit, for a pointed tip or a tip without room for its rounding.
    """

    #: number of teeth
    teeth: int
    #: module, mm
    module: float
    #: pressure angle, rad
    pressure_angle: float
    #: addendum, mm, which includes the profile shift
    addendum: float
    #: rounding of the tip, mm; 0 for a sharp edge
    tip_radius: float = 0.0
    #: profile shift, in modules, which thickens the teeth
    profile_shift: float = 0.0
    #: additional tooth thickness on the pitch circle, mm, without a longer addendum
    thicker: float = 0.0
    #: the tooth's other flank; None for symmetric teeth
    opposite: ShaperFlank | None = None

    def __post_init__(self) -> None:
        if self.top_radius <= self.largest_base_radius:
            limit = (self.largest_base_radius - self.pitch_radius) / self.module
            raise DesignError(
                "shaper.addendum",
                self.addendum / self.module,
                unit="modules with the shift",
                allowed=Allowed.more_than(limit),
            )
        beyond = self._half_space((0.0, 0.0)) - np.pi / self.teeth
        if beyond > 0.0:
            raise VagueError(
                "shaper.addendum",
                self.addendum / self.module,
                unit="modules with the shift",
                reason="the shaper's teeth are pointed",
                allowed="less",
                excess=float(beyond),
            )
        if not self._fits(self.tip_radius):
            raise DesignError(
                "shaper.tip_radius",
                self.tip_radius / self.module,
                reason="the shaper's tooth is too narrow for the fillet",
                allowed=Allowed.at_most(self.largest_tip_radius / self.module),
            )

    @property
    def largest_tip_radius(self) -> float:
        """Largest rounding (mm) for which the tip has room, beside that of the other flank if it has one of its own."""
        ends = np.zeros(1), np.array([self.top_radius - self.largest_base_radius])
        largest, _ = last_true(lambda radius, _: np.array([self._fits(float(r)) for r in radius]), *ends)
        return float(largest[0])

    @property
    def pitch_radius(self) -> float:
        return 0.5 * self.teeth * self.module

    @property
    def base_radius(self) -> float:
        return self._base_radius(self._flank)

    @property
    def other_flank(self) -> Shaper:
        """The tooth seen from its other flank; this tooth itself if it is symmetric."""
        other = self.opposite
        if other is None:
            return self
        if other.tip_radius is None:
            radius, own = self.tip_radius, self._flank
        else:
            radius, own = other.tip_radius, replace(self._flank, tip_radius=self.tip_radius)
        return replace(
            self, pressure_angle=other.pressure_angle, thicker=other.thicker, tip_radius=radius, opposite=own
        )

    def rounded(self, own: float, other: float) -> Shaper:
        """Return the tooth with tip roundings (mm) of its own: of this flank and of the other one."""
        return replace(self, tip_radius=own, opposite=replace(self.opposite or self._flank, tip_radius=other))

    @property
    def largest_base_radius(self) -> float:
        """Base radius of the flank with the larger one, mm."""
        return max(self._base_radius(flank) for flank in self._flanks)

    @property
    def top_radius(self) -> float:
        """Radius of the top cylinder, mm."""
        return self.pitch_radius + self.addendum

    @property
    def theta_0(self) -> float:
        """Half of the space's width on the base circle, rad [LF04 18.5.3]; a profile shift makes the space narrower."""
        return self._theta_0(self._flank)

    @property
    def description(self) -> ToolDescription:
        dimensions = (
            Dimension("teeth", float(self.teeth), "", "z_0"),
            Dimension("tip diameter", 2.0 * self.top_radius, "mm", "d_a0"),
            Dimension("tip radius", self.tip_radius, "mm", "rho_a0"),
            Dimension("transverse module", self.module, "mm", "m_t0"),
            Dimension("transverse pressure angle", float(np.degrees(self.pressure_angle)), "deg", "alpha_t0"),
        )
        zero = HeightZero.PITCH_PLANE
        drawing = ShaperDrawing(Rigid(np.eye(3), np.array([self.pitch_radius, 0.0, 0.0])), self.teeth)
        return ToolDescription("shaper", drawing, dimensions, self.involute, self.rounding, self.tip_radius, zero)

    @cached_property
    def involute(self) -> Involute:
        return Involute(self.base_radius, self.theta_0, self.pitch_radius)

    @cached_property
    def rounding(self) -> Arc:
        """Tip rounding, tangent to involute and top cylinder."""
        centre_radius, angle = self.top_radius - self.tip_radius, self._top_angle(self.tip_radius)
        centre = (float(self.pitch_radius - centre_radius * np.cos(angle)), float(-centre_radius * np.sin(angle)))
        return Arc(centre, -self.tip_radius)

    @property
    def top(self) -> Arc:
        """Top cylinder, with the parameter at which the rounding touches it."""
        return Arc((self.pitch_radius, 0.0), -self.top_radius)

    @property
    def form_point(self) -> tuple[float, float]:
        """Parameters (rad) of involute and rounding where they join."""
        theta = self._centre_roll(self.tip_radius) + self.tip_radius / self.base_radius
        return theta, self.theta_0 + theta

    @property
    def root(self) -> float:
        """Parameter (rad) of the rounding where it touches the top cylinder."""
        return 0.5 * np.pi + self._top_angle(self.tip_radius)

    def theta_at(self, radius: float) -> float:
        """Return theta_s (rad) of the involute's point at a radius (mm), at least the base radius."""
        return float(np.sqrt((radius / self.base_radius) ** 2 - 1.0))

    def _fits(self, radius: float) -> bool:
        """Return True if a rounding of `radius` mm lies above the base circles and leaves a top land."""
        fixed = None if self.opposite is None else self.opposite.tip_radius
        radii = radius, radius if fixed is None else fixed
        above = max(radii) <= self.top_radius - self.largest_base_radius
        return above and self._half_space(radii) <= np.pi / self.teeth

    def _centre_roll(self, radius: float) -> float:
        """Return the distance of the rounding's centre from the base circle, along the tangent, in base radii."""
        # the centre lies on the involute's normal, `radius` away from the involute
        return self.theta_at(self.top_radius - radius)

    @property
    def _flank(self) -> ShaperFlank:
        return ShaperFlank(self.pressure_angle, self.thicker)

    @property
    def _flanks(self) -> tuple[ShaperFlank, ShaperFlank]:
        """Both flanks of the tooth."""
        return self._flank, self.opposite or self._flank

    def _base_radius(self, flank: ShaperFlank) -> float:
        """Return the base radius of a flank, mm."""
        return float(self.pitch_radius * np.cos(flank.pressure_angle))

    def _theta_0(self, flank: ShaperFlank) -> float:
        """Return half of the space's width on the base circle of a flank, rad."""
        tangent = np.tan(flank.pressure_angle)
        half_space = (0.5 * np.pi - 2.0 * self.profile_shift * tangent - flank.thicker / self.module) / self.teeth
        return float(half_space - (tangent - flank.pressure_angle))

    def _top_angle(self, radius: float) -> float:
        """Return the polar angle (rad) at which a rounding of `radius` mm touches the top cylinder.

        The angle is counted from the middle of the space.
        """
        return self._flank_top_angle(self._flank, radius)

    def _half_space(self, radii: tuple[float, float]) -> float:
        """Return half of the polar angle (rad) of a space between roundings of `radii` mm at the top cylinder."""
        angles = (self._flank_top_angle(flank, radius) for flank, radius in zip(self._flanks, radii, strict=True))
        return 0.5 * sum(angles)

    def _flank_top_angle(self, flank: ShaperFlank, radius: float) -> float:
        """Return the polar angle (rad) at which a rounding of `radius` mm on a flank touches the top cylinder."""
        base = self._base_radius(flank)
        roll = float(np.sqrt(((self.top_radius - radius) / base) ** 2 - 1.0))
        return float(self._theta_0(flank) + roll + radius / base - np.arctan(roll))
