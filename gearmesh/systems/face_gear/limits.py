"""Radii between which a face gear can have teeth: undercut inside, pointing outside, in closed form [LF04 18.1, 18.5].

In the cross section of the shaper at the distance z from the apex, the contact normal is tangent to the base circle. It
passes through the instantaneous axis IA_s2, at the height z tan(gamma_s) over the shaper's axis [LF04 18.4.1]:

    cos(kappa) = r_b / (z tan(gamma_s)),   kappa the pressure angle at z, alpha at the pitch point P.

The shaper's point theta_s is on this normal at the rotation psi_s = kappa - theta_s - theta_0. Every point of the flank
is therefore explicit in (theta_s, z), and so are its singular points and the width of the tooth.

Crossed axes, with the gear's axis at y = -E, have no instantaneous axis. The condition n . v = 0 of shaper and gear,
with n = (sin kappa, -cos kappa) in the section and q = Ns / N2, is

    z tan(gamma_s) cos(kappa) + e sin(kappa) = r_b,   e = -q E cos(gamma) / (1 + q cos(gamma)).

It is explicit as well; on axes at 90 deg kappa is unchanged. The left flank is the mirror image of the right flank of
the gear with -E.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.errors import VagueError
from gearmesh.kernel.numeric.algebra import Array, polar_angle
from gearmesh.kernel.numeric.effort import ROOT_STEP, spend
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.tools.shaper import Shaper

#: number of sections of the shaper that are searched
SEARCH_SECTIONS = 2000
#: largest pressure angle (rad) of these sections
MAX_PRESSURE_ANGLE = 1.3
#: pressure angle (rad) beyond the least one at which the search begins
FIRST_ANGLE_STEP = 1e-4
#: largest number of steps from a plane to the cone parallel to the shaper's axis; each adds about two digits
MAX_CONE_STEPS = 20
#: relative change of a distance that is rounding
ROUNDING_TOLERANCE = 4e-16


@dataclass(frozen=True)
class ShapedGear:
    """A face gear that a shaper generates.

    Without an offset the axes intersect in the apex. With an offset the apex is the foot of the common perpendicular on
    each axis. In the gear's frame z points from its apex to the back, and tips point to -z. A tooth is centred on x at
    psi_s = 0 and y = 0 of the shaper's frame. Methods give the right side, y < 0 (see `mirror_image`).
    """

    #: the shaper
    shaper: Shaper
    #: number of teeth of the gear
    teeth: int
    #: angle between the axes, rad
    shaft_angle: float
    #: shortest distance of the axes, mm; the gear's axis is at y = -offset of the shaper's frame
    offset: float = 0.0

    @property
    def mirror_image(self) -> ShapedGear:
        """Gear whose right flank is the mirror image of this gear's left flank."""
        return replace(self, offset=-self.offset)

    @property
    def sides(self) -> tuple[ShapedGear, ShapedGear]:
        """This gear and its mirror image, which give the right and the left flank."""
        return self, self.mirror_image

    @property
    def ratio(self) -> float:
        """Ns / N2, rotation of the gear per rotation of the shaper [LF04 18.3.1]."""
        return self.shaper.teeth / self.teeth

    @property
    def axis_slope(self) -> float:
        """tan(gamma_s): slope of the instantaneous axis against the shaper's axis [LF04 18.4.1]."""
        return float(self.ratio * np.sin(self.shaft_angle) / (1.0 + self.ratio * np.cos(self.shaft_angle)))

    @property
    def pitch_distance(self) -> float:
        """Distance (mm) of the pitch point P from the apex, along the shaper's axis."""
        return self.shaper.pitch_radius / self.axis_slope

    @property
    def largest_offset(self) -> float:
        """Offset (mm) at which flanks begin at the shaper's pressure angle; inf on axes at 90 deg."""
        c = abs(self.ratio * float(np.cos(self.shaft_angle)))
        least = self.shaper.base_radius * float(np.sin(self.shaper.pressure_angle))
        return float(np.inf) if c < 1e-12 else least * (1.0 + self.ratio * float(np.cos(self.shaft_angle))) / c

    @property
    def path_radius(self) -> float:
        """Radius (mm) on the gear of a pinion's right-flank contact on the pitch line, for any number of teeth."""
        return float(self.radius_of(self.distance(np.array(self.shaper.pressure_angle))))

    def place_of(self, radius: Array | float) -> Array:
        """Return z (...,), mm, of points of the pitch line at radii (...,), mm, on the gear.

        The pitch line is x = r_ps, y = 0 in the shaper's frame.
        """
        outward = np.sqrt(np.maximum(np.asarray(radius) ** 2 - self.offset**2, 0.0))
        z: Array = (outward + self.shaper.pitch_radius * np.cos(self.shaft_angle)) / np.sin(self.shaft_angle)
        return z

    def radius_of(self, z: Array | float) -> Array:
        """Return the radii (...,), mm, on the gear of points of the pitch line at z (...,), mm."""
        outward = np.asarray(z) * np.sin(self.shaft_angle) - self.shaper.pitch_radius * np.cos(self.shaft_angle)
        radius: Array = np.hypot(outward, self.offset)
        return radius

    def lean(self, place: float) -> float:
        """Return the polar angle (rad) on the gear, at psi_s = 0, of the point of the pitch line at z = `place` mm."""
        outward = place * np.sin(self.shaft_angle) - self.shaper.pitch_radius * np.cos(self.shaft_angle)
        return float(np.arctan2(-self.offset, outward))

    def cone_offset(self, height: float) -> float:
        """Distance (mm) from the apex, along its normal, of a cone about the gear's axis parallel to the pitch cone.

        The cone is `height` mm over the pitch point, towards the tips. On intersecting axes, lines at that height along
        the shaper's axis sweep the cone. On crossed axes they sweep a hyperboloid that touches the cone.
        """
        over = self._over(np.array(self.shaper.pitch_radius / self.ratio), np.array(0.0))
        return float(height - self.shaper.pitch_radius + over)

    def tip_line(self, height: float, y: Array, z: Array | float) -> Array:
        """Return x (...,), mm, in the shaper's frame of the tip cone at y and z (...,), mm.

        The tip cone is `height` mm over the pitch cone.
        """
        outward = z * np.sin(self.shaft_angle) + self.cone_offset(height) * np.cos(self.shaft_angle)
        return -self.cone_offset(height) + self._over(outward, y)

    def pressure_angle(self, z: Array, arm: Array | None = None) -> Array:
        """Return kappa (...,), rad, in sections at z (...,) mm from the apex; NaN where nothing is generated.

        `arm` (...,): distance of the normal from the shaper's axis, mm; by default that of the involute's normal.
        """
        along = z * self.axis_slope
        with np.errstate(invalid="ignore"):
            past = (self.shaper.base_radius if arm is None else arm) / np.hypot(along, self._aside)
            return np.arctan2(self._aside, along) + np.arccos(past)

    def distance(self, kappa: Array) -> Array:
        """Return z (...,), mm, of the section with the pressure angle kappa."""
        return (self.shaper.base_radius - self._aside * np.sin(kappa)) / (self.axis_slope * np.cos(kappa))

    @property
    def least_pressure_angle(self) -> float:
        """kappa (rad) of the innermost section in which the shaper generates; 0 where the axes intersect."""
        return float(np.arcsin(self._aside / self.shaper.base_radius))

    def contact(self, theta: Array, kappa: Array) -> tuple[Array, Array]:
        """Return the contact point (x, y), mm, from the shaper's axis, x towards the gear."""
        base, c, s = self.shaper.base_radius, np.cos(kappa), np.sin(kappa)
        return base * (c + theta * s), base * (s - theta * c)

    def point(self, theta: Array, z: Array) -> Array:
        """Return points (..., 3) of the right flank in the gear's frame, by theta_s (rad) and z (mm)."""
        kappa = self.pressure_angle(z)
        x, y = self.contact(theta, kappa)
        c, s = np.cos(self.shaft_angle), np.sin(self.shaft_angle)
        outward, across = z * s - x * c, y + self.offset
        turned = self.ratio * (kappa - theta - self.shaper.theta_0)
        angle, rho = np.arctan2(-across, outward) + turned, np.hypot(outward, across)
        return np.stack((rho * np.cos(angle), rho * np.sin(angle), x * s + z * c), axis=-1)

    def singularity(self, theta: Array, z: Array) -> Array:
        """Return the area (R_u x R_v) . N over its value on the shaper, (...,).

        It is 0 on the limiting line [LF04 17.9.1-3], < 0 beyond it.
        """
        kappa, q = self.pressure_angle(z), self.ratio
        x, y = self.contact(theta, kappa)
        c, s = q * np.cos(self.shaft_angle), q * np.sin(self.shaft_angle)
        # velocity of the shaper over the gear, along the profile and along the axis
        across = np.stack((np.cos(kappa), np.sin(kappa)), axis=-1)
        sliding = np.stack((-(1.0 + c) * y - c * self.offset, (1.0 + c) * x - s * z), axis=-1)
        along_profile = sliding[..., 0] * across[..., 0] + sliding[..., 1] * across[..., 1]
        # d kappa = d theta + d psi: the equation of meshing for v_r + v_12 = 0
        opened = s * (y + self.offset) * self._opening(kappa, z)
        area: Array = 1.0 - along_profile / (self.shaper.base_radius * theta) + opened
        return area

    def theta_at_height(self, height: float, z: Array) -> Array:
        """Return theta_s (...,) where the flank meets a cone, in sections at z (...,).

        The cone is `height` mm over the pitch cone, towards the tips.
        """
        kappa, level = self.pressure_angle(z), -self.cone_offset(height)
        base, theta = self.shaper.base_radius, np.zeros_like(z)
        spend(theta.size, 1, ROOT_STEP)
        # fixed-point steps from the plane at the level of the cone to the cone itself
        x = np.full_like(z, level)
        for _ in range(MAX_CONE_STEPS):
            theta = (x / base - np.cos(kappa)) / np.sin(kappa)
            outward = z * np.sin(self.shaft_angle) - x * np.cos(self.shaft_angle)
            last_x, x = x, level + self._over(outward, self.contact(theta, kappa)[1])
            if np.array_equal(x, last_x, equal_nan=True):
                break
        return theta

    def tip_edge(self, height: float, radii: Array) -> Array:
        """Return points (T, 3) of the right tip edge at `radii` (T,), mm, or the nearest possible.

        The tip cone is `height` mm over the pitch cone.
        """
        least = self.least_pressure_angle + FIRST_ANGLE_STEP
        nearest, c, s = float(self.distance(np.array(least))), np.cos(self.shaft_angle), np.sin(self.shaft_angle)
        # Newton steps for the z at which the edge has the radius
        z = np.maximum(self.place_of(radii), nearest)
        for _ in range(MAX_CONE_STEPS):
            theta, kappa = self.theta_at_height(height, z), self.pressure_angle(z)
            x, y = self.contact(theta, kappa)
            outward, across = z * s - x * c, y + self.offset
            rho = np.hypot(outward, across)
            # x is nearly constant along the edge, and y = (r_b - x cos(kappa)) / sin(kappa)
            slide = (x - self.shaper.base_radius * np.cos(kappa)) / np.sin(kappa) ** 2 * self._opening(kappa, z)
            last_z, z = z, np.maximum(z - (rho - radii) * rho / (outward * s + across * slide), nearest)
            if not (np.abs(z - last_z) > ROUNDING_TOLERANCE * z).any():
                break
        return self.point(self.theta_at_height(height, z), z)

    def undercut_radius(self) -> float:
        """Inner limit (mm): the outermost point of both flanks at which the limiting line crosses the involute's end.

        Raises VagueError for a flank that is undercut at the pitch point.
        """
        return max(side.undercut_radius_of_right() for side in self._different)

    def involute_radius(self, height: float) -> float:
        """Return the inner limit (mm) at which the shaper's base circle generates the tip cone; 0 if there is none.

        The tip cone is `height` mm over the pitch cone. The involute begins lowest where the pressure angle is least,
        towards the inner end.
        """
        return max(side._involute_radius(height) for side in self._different)

    def highest(self, radius: float) -> float:
        """Return the height (mm) over the pitch cone up to which the involute generates at a `radius` (mm)."""
        level = [side._lowest_involute(float(self.place_of(radius))) for side in self._different]
        return self.shaper.pitch_radius - max(level)

    def pointing_radius(self, height: float, land: float = 0.0) -> float:
        """Outer limit (mm) at which the land on the tip cone, `height` mm over the pitch cone, is `land` mm wide.

        Raises VagueError if the land is not wider at the pitch point.
        """

        def excess(radii: Array) -> Array:
            """Return the width of the land beyond `land` at radii (T,), mm."""
            # the left flank is the mirror image of the mirrored gear's right flank
            angles = [polar_angle(side.tip_edge(height, radii)) for side in self._different]
            return -radii * (angles[0] + angles[-1]) - land

        # the first radius, from outside the shaper's pressure angle on both flanks, at which the land is too narrow
        outer = max(self.sides, key=lambda side: side.path_radius)
        kappa = np.linspace(self.shaper.pressure_angle, MAX_PRESSURE_ANGLE, SEARCH_SECTIONS)
        radii = outer.radius_of(outer.distance(kappa))
        width = excess(radii)
        if width[0] <= 0.0:
            raise VagueError(
                "gear.addendum",
                height / self.shaper.module,
                reason=f"the top land at the pitch point is {width[0] + land:.4g} mm wide",
                allowed=f"an addendum that leaves more than {land:g} mm",
                excess=-float(width[0]),
            )
        k = int(np.flatnonzero(width <= 0.0)[0])
        return float(bracketed_root(lambda at, _: excess(at), radii[k - 1 : k], radii[k : k + 1]).values[0])

    @property
    def _aside(self) -> float:
        """e (mm) of the equation of meshing: 0 where the axes intersect or are at 90 deg."""
        c = self.ratio * float(np.cos(self.shaft_angle))
        return -c * self.offset / (1.0 + c)

    @property
    def _different(self) -> tuple[ShapedGear, ...]:
        """Sides that differ: one where the axes intersect."""
        return self.sides if self.offset else (self,)

    def _over(self, outward: Array, y: Array) -> Array:
        """Return the height (mm), along the shaper's x, of a point over the pitch cone's generatrix.

        The height is due to the point's position beside the axial plane.
        """
        height: Array = np.cos(self.shaft_angle) * (np.hypot(outward, y + self.offset) - outward)
        return height

    def _opening(self, kappa: Array, z: Array) -> Array:
        """Return d kappa / d z, rad/mm, along the equation of meshing."""
        slope = self.axis_slope
        return slope * np.cos(kappa) / (slope * z * np.sin(kappa) - self._aside * np.cos(kappa))

    def undercut_radius_of_right(self) -> float:
        """Return the `undercut_radius` of the right flank."""
        theta = self.shaper.form_point[0]
        z = self.distance(
            np.linspace(self.least_pressure_angle + FIRST_ANGLE_STEP, self.shaper.pressure_angle, SEARCH_SECTIONS)
        )
        sound = self.singularity(np.full_like(z, theta), z) > 0.0
        if not sound[-1]:
            raise VagueError(
                "shaper.addendum",
                self.shaper.addendum / self.shaper.module,
                unit="modules with the shift",
                reason="undercut at the pitch point",
                allowed="less, or more teeth",
            )
        lost = np.flatnonzero(~sound)
        if not lost.size:
            return self._radius(theta, float(z[0]))
        # the outermost change of sign bounds the limit
        k = int(lost[-1])
        roots = bracketed_root(lambda at, _: self.singularity(np.array(theta), at), z[k : k + 1], z[k + 1 : k + 2])
        return self._radius(theta, float(roots.values[0]))

    def _involute_radius(self, height: float) -> float:
        """Return the `involute_radius` of the right flank."""
        cosine = (self.shaper.pitch_radius - height) / self.shaper.base_radius
        if cosine >= np.cos(self.least_pressure_angle):
            return 0.0
        return float(self.radius_of(self.distance(np.arccos(max(cosine, 1e-3)))))

    def _lowest_involute(self, z: float) -> float:
        """Return x (mm) at which the involute begins in the section at z (mm), or in the innermost section."""
        kappa = self.pressure_angle(np.maximum(z, self.distance(np.array(self.least_pressure_angle))))
        return float(self.shaper.base_radius * np.cos(kappa))

    def _radius(self, theta: float, z: float) -> float:
        """Return the radius (mm) on the gear of the flank's point (theta_s, z)."""
        r = self.point(np.array(theta), np.array(z))
        return float(np.hypot(r[0], r[1]))
