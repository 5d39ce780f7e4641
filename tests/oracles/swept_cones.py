"""Tooth contact of the straight-bladed pair of [AB] from its printed settings, position by position: no code of the package.

Cones of the cutters are turned by matrices, the equation of meshing and the contact are left to scipy's fsolve. Frame S_f: origin
at the apex, z along the pitch line, x in the axial plane from the pinion to the gear. Lengths in mm, angles in rad.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import fsolve

Array = NDArray[np.float64]
TEETH = 10, 41
X, Y, Z = np.eye(3)


def turned(axis: Array, angle: float) -> Array:
    """Rotation (3, 3) about a unit vector, by Rodrigues."""
    k = np.cross(np.eye(3), axis)
    found: Array = np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k
    return found


@dataclass(frozen=True)
class Cut:
    """A flank: `which` -1 pinion, +1 gear; `blade` (deg) < 0 for an inside blade; radial, cradle angle (deg), E_m counted opposite
    to the printed machining offset, L_m along the root line, ratio of roll and tip radius as in Table 3; `root` angle (deg)."""

    which: int
    root: float
    radial: float
    cradle: float
    offset: float
    along: float
    roll: float
    tip: float
    blade: float

    @property
    def axis(self) -> Array:
        """Return the axis of the blank, from the apex to the heel."""
        pitch = np.arctan(TEETH[0] / TEETH[1])
        pitch = pitch if self.which < 0 else 0.5 * np.pi - pitch
        return np.array([self.which * np.sin(pitch), 0.0, np.cos(pitch)])

    def frame(self) -> tuple[Array, Array]:
        """Root line and axis of the cradle."""
        dedendum = np.arctan2(abs(self.axis[0]), self.axis[2]) - np.radians(self.root)
        s, c = np.sin(dedendum), np.cos(dedendum)
        return np.array([self.which * s, 0.0, c]), np.array([-self.which * c, 0.0, s])

    def start(self, height: float) -> tuple[float, float]:
        """Parameters near the mean point: height above the blade's tip, angle on the cutter."""
        line, _ = self.frame()
        way = 81.94 * Z - self._centre()[1]
        return height, float(np.arctan2(way @ line, way @ Y))

    def _centre(self) -> tuple[Array, Array]:
        """Return the centres of the cradle and of the cutter."""
        line, _ = self.frame()
        cradle, angle = self.offset * Y + self.along * line, np.radians(self.cradle)
        return cradle, cradle + self.radial * (np.sin(angle) * Y + np.cos(angle) * line)

    def at(self, height: float, angle: float) -> tuple[Array, Array]:
        """Point and normal of the flank in the blank, which the point of the cutter at some height and angle generates."""
        line, cradle = self.frame()
        middle, centre = self._centre()
        blade, out = np.radians(abs(self.blade)), np.cos(angle) * Y + np.sin(angle) * line
        sense = float(np.sign(self.blade))
        r = centre + (self.tip + sense * height * np.tan(blade)) * out + height * cradle
        n = sense * np.cos(blade) * out - np.sin(blade) * cradle

        def meshing(roll: Array) -> float:
            turn = turned(cradle, float(roll[0]))
            p = middle + turn @ (r - middle)
            return float((turn @ n) @ (np.cross(cradle, p - middle) + np.cross(self.axis, p) / self.roll))

        roll = float(root_of(meshing, np.zeros(1), 1e-13)[0])
        turn, back = turned(cradle, roll), turned(self.axis, roll / self.roll)
        return back @ (middle + turn @ (r - middle)), back @ turn @ n


def _pinion(radial: float, cradle: float, offset: float, along: float, roll: float, tip: float, blade: float) -> Cut:
    return Cut(-1, 12.0 + 1.0 / 60.0, radial, cradle, offset, along, roll, tip, blade)


def _gear(tip: float, blade: float) -> Cut:
    """The gear's settings to all digits [AB 4-7]: cutter diameter 152.399 mm, spiral angle 35 deg at the mean cone distance."""
    root, spiral, radius = 72.0 + 25.0 / 60.0, np.radians(35.0), 76.1995
    pitch = 0.5 * np.pi - np.arctan(TEETH[0] / TEETH[1])
    dedendum = np.cos(pitch - np.radians(root))
    x, y = 81.94 * dedendum - radius * np.sin(spiral), radius * np.cos(spiral)
    radial, cradle = float(np.hypot(x, y)), float(np.degrees(np.arctan2(y, x)))
    return Cut(1, root, radial, cradle, 0.0, 0.0, float(np.sin(pitch) / dedendum), tip, blade)


#: pinion and gear of either side of the pinion [AB Tables 2, 3]
PAIRS = {
    "concave": (
        _pinion(76.030, 63.1869, -4.421, 0.539, 0.229, 75.303, 16.5561),
        _gear(76.1995 - 1.016, -20.0),
    ),
    "convex": (
        _pinion(68.525, 54.1910, 6.213, 1.324, 0.25348, 77.987, -22.9907),
        _gear(76.1995 + 1.016, 20.0),
    ),
}


@dataclass(frozen=True)
class SweptContact:
    """Contact at rotations phi1 (P,) from where the pinion was cut at cradle rotation 0: rotations of the gear phi2 (P,), rad, from
    where it was cut, and points (P, 3), mm, with z along the pinion's axis and x from there towards the pitch line."""

    phi1: Array
    phi2: Array
    points: Array

    @property
    def transmission_error(self) -> Array:
        """phi2 - phi1 N1/N2 (P,), rad, relative to phi1[0]."""
        error = self.phi2 - self.phi1 * TEETH[0] / TEETH[1]
        return np.asarray(error - error[0])


def root_of(equations: Callable[[Array], Any], start: Array, tolerance: float) -> Array:
    """Root by scipy's fsolve, which warns where rounding stops its progress: the residual says whether it is one."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        x: Array = fsolve(equations, start, xtol=tolerance)
    assert np.abs(equations(x)).max() < 1e-9
    return x


def contact(side: str, phi1: Array, axial: float = 0.0, across: float = 0.0) -> SweptContact:
    """Contact with the pinion displaced along its axis and across both axes (mm)."""
    first, second = PAIRS[side]
    x = np.array([*first.start(4.3), *second.start(4.2), 0.0])
    angles, points = [], []
    own = np.stack((np.cross(Y, first.axis), Y, first.axis))
    for turn in phi1:
        about, shift = turned(first.axis, float(turn)), axial * first.axis + across * Y

        def apart(x: Array, about: Array = about, shift: Array = shift) -> Array:
            (r1, n1), (r2, n2) = first.at(x[0], x[1]), second.at(x[2], x[3])
            gear = turned(second.axis, x[4])
            crossed = 80.0 * np.cross(about @ n1, gear @ n2)
            return np.array([*(about @ r1 + shift - gear @ r2), crossed @ X, crossed @ Z])

        x = root_of(apart, x, 1e-12)
        # the gear turns against the pinion's sense about its own axis
        angles.append(-x[4])
        points.append(own @ (about @ first.at(x[0], x[1])[0] + shift))
    return SweptContact(phi1, np.array(angles), np.array(points))
