"""Between which radii a face gear can have teeth: undercut inside, pointing outside, in closed form [LF04 18.1, 18.5].

In the cross section of the shaper at the distance z from the apex the contact normal is tangent to the base circle and
passes through the instantaneous axis IA_s2, which stands z tan(gamma_s) over the shaper's axis [LF04 18.4.1]:

    cos(kappa) = r_b / (z tan(gamma_s)),   kappa the pressure angle at z, alpha at the pitch point P.

The shaper's point theta_s has come there when it is turned to psi_s = kappa - theta_s - theta_0. With both, every
point of the flank is explicit in (theta_s, z): so are its singular points and its width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import VagueError
from gearmesh.kernel.algebra import Array, polar_angle
from gearmesh.kernel.roots import bracketed_root
from gearmesh.tools.shaper import Shaper

#: sections of the shaper that are searched, and the largest pressure angle (rad) among them
SECTIONS, STEEPEST = 2000, 1.3
#: rounds from the plane to the cone parallel to the shaper's axis: each gains about two digits
ROUNDS = 20


@dataclass(frozen=True)
class ShapedGear:
    """A face gear of `teeth` teeth that `shaper` generates on axes at `shaft_angle` (rad) that meet in the apex.

    Frame of the gear: z from the apex to the back, tips point to -z, tooth centred on x; right side, y < 0.
    """

    shaper: Shaper
    teeth: int
    shaft_angle: float

    @property
    def ratio(self) -> float:
        """Ns / N2, turn of the gear for one of the shaper [LF04 18.3.1]."""
        return self.shaper.teeth / self.teeth

    @property
    def axis_slope(self) -> float:
        """tan(gamma_s): slope of the instantaneous axis against the shaper's [LF04 18.4.1]."""
        return float(self.ratio * np.sin(self.shaft_angle) / (1.0 + self.ratio * np.cos(self.shaft_angle)))

    @property
    def pitch_distance(self) -> float:
        """Distance (mm) of the pitch point P from the apex, along the shaper's axis."""
        return self.shaper.pitch_radius / self.axis_slope

    @property
    def pitch_point_radius(self) -> float:
        """Radius (mm) of the pitch point on the gear."""
        return self.shaper.pitch_radius / self.ratio

    def pressure_angle(self, z: Array) -> Array:
        """kappa (...,), rad, in the shaper's sections at z (...,) mm from the apex; NaN where nothing is generated."""
        with np.errstate(invalid="ignore"):
            return np.arccos(self.shaper.base_radius / (z * self.axis_slope))

    def distance(self, kappa: Array) -> Array:
        """z (...,), mm, of the section with the pressure angle kappa."""
        return self.shaper.base_radius / (self.axis_slope * np.cos(kappa))

    def point(self, theta: Array, z: Array) -> Array:
        """Points (..., 3) of the right flank in the gear's frame, by theta_s (rad) and z (mm)."""
        kappa = self.pressure_angle(z)
        x, y = self._contact(theta, kappa)
        c, s = np.cos(self.shaft_angle), np.sin(self.shaft_angle)
        outward = z * s - x * c
        turned = self.ratio * (kappa - theta - self.shaper.theta_0)
        angle, rho = np.arctan2(-y, outward) + turned, np.hypot(outward, y)
        return np.stack((rho * np.cos(angle), rho * np.sin(angle), x * s + z * c), axis=-1)

    def singularity(self, theta: Array, z: Array) -> Array:
        """(R_u x R_v) . N over that of the shaper, (...,): 0 on the limiting line [LF04 17.9.1-3], < 0 beyond."""
        kappa, q = self.pressure_angle(z), self.ratio
        x, y = self._contact(theta, kappa)
        c, s = q * np.cos(self.shaft_angle), q * np.sin(self.shaft_angle)
        # velocity of the shaper over the gear, along the profile and along the axis
        across = np.stack((np.cos(kappa), np.sin(kappa)), axis=-1)
        sliding = np.stack((-(1.0 + c) * y, (1.0 + c) * x - s * z), axis=-1)
        along_profile = sliding[..., 0] * across[..., 0] + sliding[..., 1] * across[..., 1]
        # d kappa = d theta + d psi: what v_r + v_12 = 0 leaves of the equation of meshing
        found: Array = 1.0 - along_profile / (self.shaper.base_radius * theta) + s * y / (z * np.tan(kappa))
        return found

    def theta_at_height(self, height: float, z: Array) -> Array:
        """theta_s (...,) where the flank meets the cone `height` mm over the pitch cone (towards the tips), at z (...,)."""
        kappa, level = self.pressure_angle(z), self.shaper.pitch_radius - height
        c, s = np.cos(self.shaft_angle), np.sin(self.shaft_angle)
        base, theta = self.shaper.base_radius, np.zeros_like(z)
        x = np.full_like(z, level)
        for _ in range(ROUNDS):
            theta = (x / base - np.cos(kappa)) / np.sin(kappa)
            y, outward = self._contact(theta, kappa)[1], z * s - x * c
            x = level + c * (np.hypot(outward, y) - outward)
        return theta

    def undercut_radius(self) -> float:
        """Inner limit (mm): where the limiting line crosses the end of the shaper's involute, the outermost such place.

        Raises VagueError where the flank is undercut at the pitch point.
        """
        theta = self.shaper.joint[0]
        z = self.distance(np.linspace(1e-4, self.shaper.pressure_angle, SECTIONS))
        sound = self.singularity(np.full_like(z, theta), z) > 0.0
        if not sound[-1]:
            raise VagueError(
                f"shaper.addendum = {self.shaper.addendum / self.shaper.module:g} modules with the shift: undercut at the "
                "pitch point; allowed is less, or more teeth"
            )
        lost = np.flatnonzero(~sound)
        if not lost.size:
            return self._radius(theta, float(z[0]))
        k = int(lost[-1])
        found = bracketed_root(lambda at, _: self.singularity(np.array(theta), at), z[k : k + 1], z[k + 1 : k + 2])
        return self._radius(theta, float(found.values[0]))

    def involute_radius(self, height: float) -> float:
        """Inner limit (mm): where the shaper's base circle generates the tip cone, `height` mm over the pitch cone; 0 if nowhere.

        The involute begins lowest where the pressure angle is least, towards the inner end.
        """
        cosine = (self.shaper.pitch_radius - height) / self.shaper.base_radius
        if cosine >= 1.0:
            return 0.0
        z = float(self.distance(np.arccos(max(cosine, 1e-3))))
        return float(z * np.sin(self.shaft_angle) - self.shaper.pitch_radius * np.cos(self.shaft_angle))

    def pointing_radius(self, height: float, land: float = 0.0) -> float:
        """Outer limit (mm): where the land on the tip cone, `height` mm over the pitch cone, is only `land` mm wide.

        Raises VagueError where it is no wider at the pitch point.
        """

        def excess(z: Array) -> Array:
            r = self.point(self.theta_at_height(height, z), z)
            return -2.0 * np.hypot(r[..., 0], r[..., 1]) * polar_angle(r) - land

        z = self.distance(np.linspace(self.shaper.pressure_angle, STEEPEST, SECTIONS))
        width = excess(z)
        if width[0] <= 0.0:
            raise VagueError(
                f"gear.addendum = {height / self.shaper.module:g}: the top land at the pitch point is {width[0] + land:.4g} mm "
                f"wide; allowed is an addendum that leaves more than {land:g} mm"
            )
        k = int(np.flatnonzero(width <= 0.0)[0])
        at = bracketed_root(lambda at, _: excess(at), z[k - 1 : k], z[k : k + 1]).values
        return self._radius(float(self.theta_at_height(height, at)[0]), float(at[0]))

    def _contact(self, theta: Array, kappa: Array) -> tuple[Array, Array]:
        """Contact point (x, y), mm, from the shaper's axis, x towards the gear."""
        base, c, s = self.shaper.base_radius, np.cos(kappa), np.sin(kappa)
        return base * (c + theta * s), base * (s - theta * c)

    def _radius(self, theta: float, z: float) -> float:
        r = self.point(np.array(theta), np.array(z))
        return float(np.hypot(r[0], r[1]))
