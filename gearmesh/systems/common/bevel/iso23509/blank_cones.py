"""Tip and root cones: the pinion's tip follows the wheel's root, and its root the wheel's tip.

A plane touches the wheel's root cone at an offset angle about the wheel's axis. The pinion's tip cone touches a plane
parallel to it at the clearance, and has its apex on the pinion's axis. The wheel's tip cone and the pinion's root cone
correspond in the same way. Lengths in mm, angles in rad; tuples are (pinion, wheel). Equation numbers refer to ISO
23509:2016, clause 7.4.
"""

from __future__ import annotations

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones

#: residual (rad) of the pinion's cone angle at which the iteration ends
MAX_ANGLE_RESIDUAL = 1e-14
#: largest number of steps towards the plane of a given pinion angle
MAX_PLANE_STEPS = 200


@dataclass(frozen=True)
class MatingPlane:
    """A plane that touches a cone of the wheel."""

    #: auxiliary angle phi, rad
    auxiliary_angle: float
    #: offset angle zeta of the line of contact about the wheel's axis, rad
    offset_angle: float
    #: angle between the plane and the pinion's axis, rad: the angle of the pinion's cone
    pinion_angle: float


@dataclass(frozen=True)
class BlankCones:
    """Tip and root cones of both members; tuples are (pinion, wheel)."""

    #: face angles delta_a, rad
    face_angles: tuple[float, float]
    #: root angles delta_f, rad
    root_angles: tuple[float, float]
    #: t_zF: apexes of the tip cones beyond the crossing points, mm
    face_apexes: tuple[float, float]
    #: t_zR: apexes of the root cones beyond the crossing points, mm
    root_apexes: tuple[float, float]
    #: plane on the wheel's root cone: phi_R, zeta_R
    root_plane: MatingPlane
    #: plane on the wheel's tip cone: phi_o, zeta_o
    face_plane: MatingPlane


def blank_cones(
    pitch: PitchCones, tapers: tuple[float, float], depths: tuple[float, float], clearance: float
) -> BlankCones:
    """Return the cones of both members by the wheel's angles and depths.

    - `tapers`: addendum and dedendum angle of the wheel, theta_a2 and theta_f2, rad
    - `depths`: mean addendum and dedendum of the wheel, h_am2 and h_fm2, mm, across the pitch cone
    - `clearance`: clearance, mm
    """
    angle, mean, apex = pitch.pitch_angles[1], pitch.mean_cone_distances[1], pitch.pitch_apexes[1]
    (addendum_angle, dedendum_angle), (addendum, dedendum) = tapers, depths
    face, root = angle + addendum_angle, angle - dedendum_angle
    root_plane, face_plane = _plane(pitch, dedendum_angle), _plane(pitch, -addendum_angle)
    # apexes of the wheel's cones beyond its crossing point: (150), (151)
    face_apex = apex - (mean * np.sin(addendum_angle) - addendum * np.cos(addendum_angle)) / np.sin(face)
    root_apex = apex + (mean * np.sin(dedendum_angle) - dedendum * np.cos(dedendum_angle)) / np.sin(root)
    return BlankCones(
        (root_plane.pinion_angle, float(face)),
        (face_plane.pinion_angle, float(root)),
        (_pinion_apex(pitch, root_plane, root, root_apex, clearance), float(face_apex)),
        (_pinion_apex(pitch, face_plane, face, face_apex, clearance), float(root_apex)),
        root_plane,
        face_plane,
    )


def _plane(pitch: PitchCones, lean: float) -> MatingPlane:
    """Return the plane that touches the wheel's cone whose angle is the pitch angle less `lean` (rad)."""
    if pitch.offset == 0.0:
        return MatingPlane(0.0, 0.0, pitch.pitch_angles[0] + lean)
    angle, beyond = pitch.pitch_angles[1] - lean, pitch.shaft_angle - 0.5 * np.pi
    along = pitch.mean_cone_distances[1] * np.cos(lean) - pitch.pitch_apexes[1] * np.cos(angle)
    # auxiliary angle (142), (143), then offset angle (144), (145)
    auxiliary = np.arctan(pitch.offset * np.tan(beyond) * np.cos(angle) / along)
    turn = np.arcsin(pitch.offset * np.cos(auxiliary) * np.sin(angle) / along) - auxiliary
    # angle between the plane and the pinion's axis: (146), (147)
    sine = np.sin(beyond) * np.sin(angle) + np.cos(beyond) * np.cos(angle) * np.cos(turn)
    return MatingPlane(float(auxiliary), float(turn), float(np.arcsin(sine)))


def lean_of_plane(pitch: PitchCones, pinion_angle: float) -> float:
    """Return the `lean` (rad) of the wheel's cone whose plane makes `pinion_angle` (rad) with the pinion's axis.

    This is the inverse of (142)-(147). It is found by fixed-point steps: each step leaves about 1 - cos(zeta) of the
    error. `lean` is the angle by which the wheel's cone is within its pitch cone.

    Raises DesignError, naming the key, for a root angle of the pinion that no plane has.
    """
    lean = pinion_angle - pitch.pitch_angles[0]
    for _ in range(MAX_PLANE_STEPS):
        missing = pinion_angle - _plane(pitch, lean).pinion_angle
        if abs(missing) <= MAX_ANGLE_RESIDUAL:
            return lean
        lean += missing
    raise DesignError(
        "pinion.root_angle",
        np.degrees(pinion_angle),
        unit="deg",
        reason="no tip cone of the gear follows it",
        allowed=f"nearer to the pitch angle, {np.degrees(pitch.pitch_angles[0]):.6g} deg",
    )


def _pinion_apex(pitch: PitchCones, plane: MatingPlane, angle: float, apex: float, clearance: float) -> float:
    """Apex of the pinion's cone beyond its crossing point (mm), by the wheel's cone [ISO 23509 (152), (153)].

    `angle` (rad) and `apex` (mm) belong to the wheel's cone that `plane` touches.
    """
    offset = pitch.offset * np.sin(plane.offset_angle) * np.cos(angle)
    return float((offset - apex * np.sin(angle) - clearance) / np.sin(plane.pinion_angle))
