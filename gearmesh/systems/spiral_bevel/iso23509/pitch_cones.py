"""Pitch cones of a bevel or hypoid pair: two cones about axes with or without offset that touch at the mean point.

The common tangent plane at the mean point P, seen from the wheel's axis:

    O1 .
          `  .                  O1, O2: apexes of pinion and wheel, R_m1 and R_m2 before P
    O2 ----------`P-----> g2    g1, g2: directions of the generatrices; zeta_mp is the angle between them
                     `  .       beta_m1, beta_m2: angles from the tooth to g1, g2, so that beta_m1 - beta_m2 = zeta_mp
                           ` g1

The pinion's axis makes delta_1 with g1 on one side of the plane, the wheel's delta_2 with g2 on the other. Thus, exactly and
whatever the method,

    cos(Sigma) = cos(delta_1) cos(delta_2) cos(zeta_mp) - sin(delta_1) sin(delta_2)              tangent cones
    a sin(Sigma) = sin(zeta_mp) (r_m1 cos(delta_2) + r_m2 cos(delta_1))                          offset of their axes
    r_m1 cos(beta_m1) / z_1 = r_m2 cos(beta_m2) / z_2                                            one normal module

and the methods of ISO 23509 differ in the size and the spiral angle that are given, and in the one condition that is left: see
`methods`. Lengths in mm, angles in rad; (pinion, wheel) each; "mean" is at P. Equation numbers are those of ISO 23509:2016.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.spiral_bevel.iso23509.tooth_line import FaceCutter, ToothLine


@dataclass(frozen=True)
class TangentCones:
    """Pairs of cones that touch at a point: half angles, cone distances of the point and spiral angles there, (2, ...) each,
    of pinion and wheel.
    """

    pitch_angles: Array
    cone_distances: Array
    spiral_angles: Array

    @property
    def offset_angle(self) -> Array:
        """zeta_mp (...): between both generatrices."""
        return np.asarray(self.spiral_angles[0] - self.spiral_angles[1])

    @property
    def radii(self) -> Array:
        """r_m (2, ...): of the pitch circles."""
        return self.cone_distances * np.sin(self.pitch_angles)

    @property
    def limit_pressure_angle(self) -> Array:
        """alpha_lim (...): of the normal whose flank has contact lines along the direction of sliding [ISO 23509 (32), (117)]."""
        tangent, sine = np.tan(self.pitch_angles), np.sin(self.spiral_angles)
        distances = self.cone_distances
        skew = (distances[0] * sine[0] - distances[1] * sine[1]) / (distances * tangent).sum(axis=0)
        return np.asarray(-np.arctan(tangent[0] * tangent[1] / np.cos(self.offset_angle) * skew))

    @property
    def limit_curvature(self) -> Array:
        """1 / rho_lim (...), 1/mm, nan without offset: lengthwise curvature of a flank with that normal [ISO 23509 (33)]."""
        limit, spiral = self.limit_pressure_angle, np.tan(self.spiral_angles)
        distances = self.cone_distances
        twist = (spiral / (distances * np.tan(self.pitch_angles))).sum(axis=0)
        across = 1.0 / (distances * np.cos(self.spiral_angles))
        with np.errstate(divide="ignore", invalid="ignore"):
            turned = (-np.tan(limit) * twist + across[0] - across[1]) / (spiral[0] - spiral[1])
        return np.asarray(np.cos(limit) * turned)


def bevel_pitch_angles(teeth: tuple[int, int], shaft_angle: float) -> tuple[float, float]:
    """delta_1, delta_2 (rad) of a pair without offset [ISO 23509 (2), (3); AB 1, 2]."""
    pinion = float(np.arctan2(np.sin(shaft_angle), teeth[1] / teeth[0] + np.cos(shaft_angle)))
    return pinion, shaft_angle - pinion


def crown_shaft_angle(teeth: tuple[int, int]) -> float:
    """Shaft angle (rad) of a pair without offset at which the larger member is a crown gear: its pitch angle is 90 deg."""
    return float(np.arccos(-min(teeth) / max(teeth)))


@dataclass(frozen=True)
class PitchCones:
    """Pitch cones of a pair, its mean point, and the wheel's face; `method` is that of ISO 23509 they were found by.

    `face_width` b_2 and `outer_cone_distance` R_e2 are the wheel's.
    """

    method: int
    teeth: tuple[int, int]
    shaft_angle: float
    offset: float
    pitch_angles: tuple[float, float]
    mean_cone_distances: tuple[float, float]
    spiral_angles: tuple[float, float]
    face_width: float
    outer_cone_distance: float

    @property
    def tangent(self) -> TangentCones:
        return TangentCones(
            *(np.array(values) for values in (self.pitch_angles, self.mean_cone_distances, self.spiral_angles))
        )

    @property
    def ratio(self) -> float:
        """u."""
        return self.teeth[1] / self.teeth[0]

    @property
    def mean_diameters(self) -> tuple[float, float]:
        """d_m1, d_m2 [ISO 23509 (110), (111)]."""
        first, second = (
            float(2.0 * distance * np.sin(angle))
            for distance, angle in zip(self.mean_cone_distances, self.pitch_angles, strict=True)
        )
        return first, second

    @property
    def inner_cone_distance(self) -> float:
        """R_i2 [ISO 23509 (123)]."""
        return self.outer_cone_distance - self.face_width

    @property
    def face_width_factor(self) -> float:
        """c_be2: share of the wheel's face outside the mean point [ISO 23509 (7), (41), (83), (109)]."""
        return (self.outer_cone_distance - self.mean_cone_distances[1]) / self.face_width

    @property
    def axial_offset_angle(self) -> float:
        """zeta_m: offset angle in the pinion's axial plane [ISO 23509 (113)]."""
        (first, second), cosine = self.mean_diameters, np.cos(self.pitch_angles)
        return float(np.arcsin(2.0 * self.offset / (second + first * cosine[1] / cosine[0])))

    @property
    def offset_angle(self) -> float:
        """zeta_mp: offset angle in the pitch plane [ISO 23509 (114)]."""
        return self.spiral_angles[0] - self.spiral_angles[1]

    @property
    def pitch_plane_offset(self) -> float:
        """a_p [ISO 23509 (115)]."""
        return float(self.mean_cone_distances[1] * np.sin(self.offset_angle))

    @property
    def mean_normal_module(self) -> float:
        """m_mn [ISO 23509 (116)]."""
        return float(self.mean_diameters[1] * np.cos(self.spiral_angles[1]) / self.teeth[1])

    @property
    def limit_pressure_angle(self) -> float:
        """alpha_lim [ISO 23509 (117)]."""
        return float(self.tangent.limit_pressure_angle)

    @property
    def crossing_distances(self) -> tuple[float, float]:
        """t_zm1, t_zm2: from the crossing point to the mean point along each axis [ISO 23509 (129), (130)].

        The crossing point of an axis is the foot of the common perpendicular of both.
        """
        (first, second), cosine = self.mean_diameters, np.cos(self.pitch_angles)
        beyond, turn = self.shaft_angle - 0.5 * np.pi, np.cos(self.axial_offset_angle)
        wheel = first * np.sin(self.pitch_angles[1]) / (2.0 * cosine[0])
        wheel -= 0.5 * turn * np.tan(beyond) * (second + first * cosine[1] / cosine[0])
        pinion = 0.5 * second * turn * np.cos(beyond) - wheel * np.sin(beyond)
        return float(pinion), float(wheel)

    @property
    def pitch_apexes(self) -> tuple[float, float]:
        """t_z1, t_z2: pitch apexes beyond the crossing points, away from the mean point [ISO 23509 (131)]."""
        first, second = (
            float(distance * np.cos(angle) - crossing)
            for distance, angle, crossing in zip(
                self.mean_cone_distances, self.pitch_angles, self.crossing_distances, strict=True
            )
        )
        return first, second

    def tooth_line(self, cutter: FaceCutter) -> ToothLine:
        """The wheel's tooth line by a cutter."""
        crown = self.teeth[1] / np.sin(self.pitch_angles[1])
        return ToothLine(cutter, self.mean_cone_distances[1], self.spiral_angles[1], float(crown))
