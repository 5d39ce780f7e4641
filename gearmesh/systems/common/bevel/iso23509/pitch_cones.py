"""Pitch cones of a bevel or hypoid pair: two cones about axes with or without offset that touch at the mean point.

The common tangent plane at the mean point P, seen from the wheel's axis:

    O1 .
          `  .                  O1, O2: apexes of pinion and wheel, R_m1 and R_m2 before P
    O2 ----------`P-----> g2    g1, g2: directions of the generatrices; zeta_mp is the angle between them
                     `  .       beta_m1, beta_m2: angles from the tooth to g1, g2, so that beta_m1 - beta_m2 = zeta_mp
                           ` g1

The pinion's axis makes delta_1 with g1 on one side of the plane, the wheel's axis delta_2 with g2 on the other. For all
methods, exactly,

    cos(Sigma) = cos(delta_1) cos(delta_2) cos(zeta_mp) - sin(delta_1) sin(delta_2)              tangent cones
    a sin(Sigma) = sin(zeta_mp) (r_m1 cos(delta_2) + r_m2 cos(delta_1))                          offset of their axes
    r_m1 cos(beta_m1) / z_1 = r_m2 cos(beta_m2) / z_2                                            one normal module

The methods of ISO 23509 differ in the given size and spiral angle, and in the one condition that remains: see
`methods`. Lengths in mm, angles in rad; tuples are (pinion, wheel); "mean" is at P. Equation numbers refer to ISO
23509:2016.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine


@dataclass(frozen=True)
class TangentCones:
    """Pairs of cones that touch at a point; rows of the arrays are pinion and wheel."""

    #: half angles of the cones (2, ...), rad
    pitch_angles: Array
    #: cone distances of the point of contact (2, ...), mm
    cone_distances: Array
    #: spiral angles at the point of contact (2, ...), rad
    spiral_angles: Array

    @property
    def offset_angle(self) -> Array:
        """Angles zeta_mp (...) between both generatrices, rad."""
        return np.asarray(self.spiral_angles[0] - self.spiral_angles[1])

    @property
    def radii(self) -> Array:
        """Radii r_m (2, ...) of the pitch circles, mm."""
        return self.cone_distances * np.sin(self.pitch_angles)

    @property
    def limit_pressure_angle(self) -> Array:
        """Limit pressure angles alpha_lim (...), rad [ISO 23509 (32), (117)].

        A flank with this normal has contact lines along the direction of sliding.
        """
        tangent, sine = np.tan(self.pitch_angles), np.sin(self.spiral_angles)
        distances = self.cone_distances
        skew = (distances[0] * sine[0] - distances[1] * sine[1]) / (distances * tangent).sum(axis=0)
        return np.asarray(-np.arctan(tangent[0] * tangent[1] / np.cos(self.offset_angle) * skew))

    @property
    def limit_curvature(self) -> Array:
        """Lengthwise curvatures 1 / rho_lim (...) with the limit normal, 1/mm [ISO 23509 (33)].

        They are nan without offset.
        """
        limit, spiral = self.limit_pressure_angle, np.tan(self.spiral_angles)
        distances = self.cone_distances
        twist = (spiral / (distances * np.tan(self.pitch_angles))).sum(axis=0)
        across = 1.0 / (distances * np.cos(self.spiral_angles))
        with np.errstate(divide="ignore", invalid="ignore"):
            turned = (-np.tan(limit) * twist + across[0] - across[1]) / (spiral[0] - spiral[1])
        return np.asarray(np.cos(limit) * turned)


def bevel_pitch_angles(teeth: tuple[int, int], shaft_angle: float) -> tuple[float, float]:
    """Return delta_1, delta_2 (rad) of a pair without offset [ISO 23509 (2), (3); AB 1, 2]."""
    pinion = float(np.arctan2(np.sin(shaft_angle), teeth[1] / teeth[0] + np.cos(shaft_angle)))
    return pinion, shaft_angle - pinion


def crown_shaft_angle(teeth: tuple[int, int]) -> float:
    """Shaft angle (rad) without offset at which the larger member is a crown gear: its pitch angle is 90 deg."""
    return float(np.arccos(-min(teeth) / max(teeth)))


@dataclass(frozen=True)
class PitchCones:
    """Pitch cones of a pair, its mean point, and the wheel's face; tuples are (pinion, wheel)."""

    #: method of ISO 23509 that gave the cones: 0 to 3
    method: int
    #: numbers of teeth
    teeth: tuple[int, int]
    #: shaft angle, rad
    shaft_angle: float
    #: offset a, mm
    offset: float
    #: pitch angles delta, rad
    pitch_angles: tuple[float, float]
    #: mean cone distances R_m, mm
    mean_cone_distances: tuple[float, float]
    #: mean spiral angles beta_m, rad
    spiral_angles: tuple[float, float]
    #: face width b_2 of the wheel, mm
    face_width: float
    #: outer cone distance R_e2 of the wheel, mm
    outer_cone_distance: float

    @property
    def tangent(self) -> TangentCones:
        return TangentCones(
            *(np.array(values) for values in (self.pitch_angles, self.mean_cone_distances, self.spiral_angles))
        )

    @property
    def ratio(self) -> float:
        """Gear ratio u."""
        return self.teeth[1] / self.teeth[0]

    @property
    def mean_diameters(self) -> tuple[float, float]:
        """Mean pitch diameters d_m1, d_m2 [ISO 23509 (110), (111)]."""
        pinion_diameter, wheel_diameter = (
            float(2.0 * distance * np.sin(angle))
            for distance, angle in zip(self.mean_cone_distances, self.pitch_angles, strict=True)
        )
        return pinion_diameter, wheel_diameter

    @property
    def inner_cone_distance(self) -> float:
        """Inner cone distance R_i2 of the wheel [ISO 23509 (123)]."""
        return self.outer_cone_distance - self.face_width

    @property
    def face_width_factor(self) -> float:
        """Share c_be2 of the wheel's face outside the mean point [ISO 23509 (7), (41), (83), (109)]."""
        return (self.outer_cone_distance - self.mean_cone_distances[1]) / self.face_width

    @property
    def axial_offset_angle(self) -> float:
        """Offset angle zeta_m in the pinion's axial plane [ISO 23509 (113)]."""
        (pinion_diameter, wheel_diameter), cosine = self.mean_diameters, np.cos(self.pitch_angles)
        return float(np.arcsin(2.0 * self.offset / (wheel_diameter + pinion_diameter * cosine[1] / cosine[0])))

    @property
    def offset_angle(self) -> float:
        """Offset angle zeta_mp in the pitch plane [ISO 23509 (114)]."""
        return self.spiral_angles[0] - self.spiral_angles[1]

    @property
    def pitch_plane_offset(self) -> float:
        """Offset a_p in the pitch plane [ISO 23509 (115)]."""
        return float(self.mean_cone_distances[1] * np.sin(self.offset_angle))

    @property
    def mean_normal_module(self) -> float:
        """Mean normal module m_mn [ISO 23509 (116)]."""
        return float(self.mean_diameters[1] * np.cos(self.spiral_angles[1]) / self.teeth[1])

    @property
    def limit_pressure_angle(self) -> float:
        """Limit pressure angle alpha_lim [ISO 23509 (117)]."""
        return float(self.tangent.limit_pressure_angle)

    @property
    def crossing_distances(self) -> tuple[float, float]:
        """Distances t_zm1, t_zm2 from crossing point to mean point along each axis [ISO 23509 (129), (130)].

        The crossing point of an axis is the foot of the axes' common perpendicular.
        """
        (pinion_diameter, wheel_diameter), cosine = self.mean_diameters, np.cos(self.pitch_angles)
        beyond, turn = self.shaft_angle - 0.5 * np.pi, np.cos(self.axial_offset_angle)
        wheel = pinion_diameter * np.sin(self.pitch_angles[1]) / (2.0 * cosine[0])
        wheel -= 0.5 * turn * np.tan(beyond) * (wheel_diameter + pinion_diameter * cosine[1] / cosine[0])
        pinion = 0.5 * wheel_diameter * turn * np.cos(beyond) - wheel * np.sin(beyond)
        return float(pinion), float(wheel)

    @property
    def pitch_apexes(self) -> tuple[float, float]:
        """Pitch apexes t_z1, t_z2 beyond the crossing points, away from the mean point [ISO 23509 (131)]."""
        pinion_apex, wheel_apex = (
            float(distance * np.cos(angle) - crossing)
            for distance, angle, crossing in zip(
                self.mean_cone_distances, self.pitch_angles, self.crossing_distances, strict=True
            )
        )
        return pinion_apex, wheel_apex

    def tooth_line(self, cutter: FaceCutter) -> ToothLine:
        """Return the wheel's tooth line by a cutter."""
        crown = self.teeth[1] / np.sin(self.pitch_angles[1])
        return ToothLine(cutter, self.mean_cone_distances[1], self.spiral_angles[1], float(crown))
