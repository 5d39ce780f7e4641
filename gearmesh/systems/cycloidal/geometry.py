r"""The curve of the pins' centres and the lobes beside it, in closed form; the core computes the same as an envelope.

N pins on a circle of radius R turn by phi, the z lobes by phi N / z, about axes that are e apart; d = |N - z|. Seen from the
lobes the centre of a pin runs on a shortened epitrochoid, or hypotrochoid if the pins are inside (s = -1):

    c = exp(-i phi N / z) (R exp(i phi) - s e),      |c'| = (d / z) |C P|,      |C P|^2 = R^2 + (e N / d)^2 - 2 R (e N / d) cos phi

phi = 0 is in the middle of a space, phi = pi at the tip of a lobe. P is the pitch point, e N / d from the axis of the pins. The
lobes are the curve at the distance of the pin's radius. With A = R d / z, B = e N / z, a = d / z, b = N / z the curvature, positive
where lobes are convex, is

    k = (s A^2 a + B^2 b - A B (b + s a) cos phi) / (A^2 + B^2 - 2 A B cos phi)^1.5
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass


@dataclass(frozen=True)
class PinCurve:
    """Curve of the pins' centres, seen from the lobes; lengths in mm."""

    #: radius of the pins' circle
    circle: float
    #: distance of the axes
    eccentricity: float
    #: number of pins
    pins: int
    #: number of lobes
    lobes: int

    @property
    def outside(self) -> int:
        """+1 if the pins are around the lobes, -1 if the lobes are around the pins."""
        return 1 if self.pins > self.lobes else -1

    @property
    def difference(self) -> int:
        return abs(self.pins - self.lobes)

    @property
    def pitch_radius(self) -> float:
        """Radius of the pins' pitch circle: distance of the pitch point from their axis."""
        return self.eccentricity * self.pins / self.difference

    @property
    def shortening(self) -> float:
        """Pitch radius over the radius of the pins' circle, below 1."""
        return self.pitch_radius / self.circle

    def centres(self, phi: Array) -> Array:
        """Return the centres (..., 2) of a pin at its rotations phi (...,), in the frame of the lobes."""
        turned = np.exp(-1j * phi * self.pins / self.lobes)
        centre = turned * (self.circle * np.exp(1j * phi) - self.outside * self.eccentricity)
        return np.stack((centre.real, centre.imag), axis=-1)

    def radii(self, phi: Array) -> Array:
        """Return the distances (...,) of the centres from the axis of the lobes."""
        return np.asarray(np.linalg.norm(self.centres(phi), axis=-1))

    def leans(self, phi: Array) -> Array:
        """Return the angles (...,), rad, between the normal of the lobes and the ray from the pins' axis to the pin."""
        x, y = self.circle * np.cos(phi) - self.pitch_radius, self.circle * np.sin(phi)
        return np.asarray(np.arctan2(y, x) - phi)

    def levers(self, phi: Array) -> Array:
        """Return the distances (...,), mm, of the normals from the axis of the pins, positive for phi from 0 to pi."""
        far = np.sqrt(self.circle**2 + self.pitch_radius**2 - 2.0 * self.circle * self.pitch_radius * np.cos(phi))
        return np.asarray(self.pitch_radius * self.circle * np.sin(phi) / far)

    @cached_property
    def largest_lean(self) -> float:
        """Largest angle between normal and ray, rad: pins touch within it on both sides."""
        return math.asin(self.shortening)

    def curvatures(self, phi: Array) -> Array:
        """Return the curvatures (...,), 1/mm, positive where the lobes are convex."""
        p, q, r, s = self._coefficients
        return np.asarray((p - q * np.cos(phi)) / (r - s * np.cos(phi)) ** 1.5)

    @property
    def _coefficients(self) -> tuple[float, float, float, float]:
        """Numbers p, q, r, s of the curvature (p - q cos phi) / (r - s cos phi)^1.5."""
        a, b = self.difference / self.lobes, self.pins / self.lobes
        big, small, out = self.circle * a, self.eccentricity * b, self.outside
        return out * big**2 * a + small**2 * b, big * small * (b + out * a), big**2 + small**2, 2.0 * big * small

    @property
    def sharpest(self) -> tuple[float, float]:
        """Rotation phi (rad) at which the curve is most convex, and its radius of curvature there, mm: inf if nowhere."""
        p, q, r, s = self._coefficients
        # the derivative of the curvature by cos phi vanishes at 3 p / q - 2 r / s
        cosine = 3.0 * p / q - 2.0 * r / s
        places = [math.pi, 0.0, *([math.acos(cosine)] if abs(cosine) < 1.0 else [])]
        convex = [(float(self.curvatures(np.array(phi))), phi) for phi in places]
        largest, phi = max(convex)
        return phi, 1.0 / largest if largest > 0.0 else math.inf

    @property
    def largest_pin_radius(self) -> float:
        """Radius of the largest pin that does not undercut the lobes, mm."""
        return self.sharpest[1]
