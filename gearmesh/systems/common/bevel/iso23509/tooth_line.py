"""Tooth line on the crown gear: the circle of a face-milling cutter or the epicycloid of a face-hobbing cutter.

The pitch plane, with the crown gear's centre O, the mean point P and the cutter's centre C at the cutter radius from P:

            C
          . |
        .   |  rho_P0
      P-----O        the angle at P is 90 deg - beta + nu
         R_m
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least

#: one value, or a batch of values (...)
Value: TypeAlias = "float | Array"


@dataclass(frozen=True)
class FaceCutter:
    """A face cutter."""

    #: cutter radius r_c0, mm; infinite for a tool that moves in a straight line
    radius: float
    #: number of blade groups z_0; 0 for face milling
    blade_groups: int = 0

    def __post_init__(self) -> None:
        if not self.radius > 0.0:
            raise DesignError("gear.cutter.tip_radius", self.radius, unit="mm", allowed="more than 0")
        if self.blade_groups < 0:
            raise DesignError("blade_groups", self.blade_groups, allowed="0 (face milling) or more (face hobbing)")


@dataclass(frozen=True)
class ToothLine:
    """Tooth line of a cutter on a crown gear. Each value may be a batch (...)."""

    #: face cutter
    cutter: FaceCutter
    #: mean cone distance R_m, mm
    mean_cone_distance: Value
    #: spiral angle at the mean cone distance, rad
    spiral_angle: Value
    #: number of teeth of the crown gear, z_p = z_2 / sin(delta_2)
    crown_teeth: Value

    @property
    def lead_angle(self) -> Value:
        """Lead angle nu of the cutter's blades, rad [ISO 23509 (98), (176)].

        It is 0 in face milling, and nan for a cutter that is too small.
        """
        rolled = self.cutter.blade_groups * self.mean_cone_distance * np.cos(self.spiral_angle)
        return np.arcsin(_sine(rolled / (self.cutter.radius * self.crown_teeth)))

    @property
    def centre_angle(self) -> Value:
        """Angle lambda at the mean point, from the crown gear's centre to the cutter's, rad [ISO 23509 (36), (43)]."""
        return 0.5 * np.pi - self.spiral_angle + self.lead_angle

    @property
    def centre_distance(self) -> Value:
        """Distance rho_P0 from the crown gear's centre to the cutter's, mm [ISO 23509 (37), (79), (177)]."""
        mean, radius = self.mean_cone_distance, self.cutter.radius
        if math.isinf(radius):
            return radius
        return np.sqrt(mean**2 + radius**2 - 2.0 * mean * radius * np.cos(self.centre_angle))

    @property
    def base_radius(self) -> Value:
        """Radius rho_b of the base circle on which the cutter's circle rolls, mm [ISO 23509 (178)].

        In face milling it equals `centre_distance`.
        """
        return self.centre_distance / (1.0 + self.cutter.blade_groups / self.crown_teeth)

    @property
    def curvature(self) -> Value:
        """Curvature 1 / rho_mbeta at the mean point, 1/mm, > 0 towards the cutter [ISO 23509 (34)-(40)]."""
        across, radius, lead = self.mean_cone_distance * np.cos(self.spiral_angle), self.cutter.radius, self.lead_angle
        # tan(eta_1): angle at the crown gear's centre from the tooth's normal to the cutter's centre (52)
        beside = radius * np.cos(lead) - self.mean_cone_distance * np.sin(self.spiral_angle)
        tan_eta = beside / (across + radius * np.sin(lead))
        spiral = np.tan(self.spiral_angle)
        rolling = 1.0 + np.tan(lead) * (spiral + tan_eta)
        return rolling / (across * (spiral * rolling + tan_eta))

    def spiral_angle_at(self, cone_distance: Value) -> Value:
        """Return the spiral angle (rad) at a cone distance (mm) [ISO 23509 (179)-(184), (189)-(194)].

        The angle is 90 deg at a cone distance that the line does not reach.
        """
        radius, centre = self.cutter.radius, self.centre_distance
        if not self.cutter.blade_groups:
            mean = self.mean_cone_distance
            sine = mean / cone_distance * np.sin(self.spiral_angle)
            sine = sine + (cone_distance**2 - mean**2) / (2.0 * cone_distance * radius)
            return np.arcsin(np.clip(sine, -1.0, 1.0))
        turn = _angle(cone_distance, centre, radius)
        return np.arctan2(cone_distance - self.base_radius * np.cos(turn), self.base_radius * np.sin(turn))

    def turn_at(self, cone_distance: Value) -> Value:
        """Return the angle (rad) about the crown gear's centre from the mean point to the line at a cone distance (mm).

        It is > 0 towards the cutter. The cutter's centre is in the direction in which the circle of the blades lies; the
        crown gear turns by z_0 / z_p of the cutter's rotation from the mean point.
        """
        mean, radius, centre = self.mean_cone_distance, self.cutter.radius, self.centre_distance
        at_crown, at_cutter = [], []
        for distance in (mean, cone_distance):
            at_crown.append(_angle(distance, centre, radius))
            at_cutter.append(_angle(radius, centre, distance))
        rolled = self.cutter.blade_groups / self.crown_teeth * (at_cutter[1] - at_cutter[0])
        return at_crown[0] - at_crown[1] + rolled

    @property
    def inner_distance(self) -> float:
        """Least cone distance of the line, mm."""
        if math.isinf(self.cutter.radius):
            return abs(float(self.mean_cone_distance * np.sin(self.spiral_angle)))
        return abs(float(self.centre_distance) - self.cutter.radius)

    def reaches(self, cone_distance: float) -> bool:
        """Return True if the line crosses a cone distance (mm)."""
        return bool(self.inner_distance < cone_distance < float(self.centre_distance) + self.cutter.radius)


def reaching(line: ToothLine, distances: tuple[float, ...]) -> None:
    """Raise DesignError for a cutter that does not reach all given cone distances (mm)."""
    for distance in distances:
        if not line.reaches(distance):
            raise DesignError(
                "gear.cutter.tip_radius",
                line.cutter.radius,
                unit="mm",
                reason=f"does not reach the cone distance {distance:.6g} mm",
                allowed=f"a radius whose tooth line goes from {at_least(line.inner_distance)} mm over both ends of the face",
            )


def _angle(side: Value, other: Value, opposite: Value) -> Value:
    """Return the angle (rad) of a triangle between two sides, by the law of cosines; 0 or 180 deg if it does not close."""
    cosine = (side**2 + other**2 - opposite**2) / (2.0 * side * other)
    angle: Array = np.arccos(np.clip(cosine, -1.0, 1.0))
    return angle


def _sine(value: Value) -> Value:
    """Return the value where it is a possible sine, else nan."""
    return np.where(np.abs(value) <= 1.0, value, np.nan)
