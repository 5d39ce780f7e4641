"""Tip and root cones of both members: the pinion's tip follows the wheel's root at the clearance, its root the wheel's tip.

A plane touches the wheel's root cone at an offset angle about the wheel's axis; the pinion's tip cone touches the plane at the
clearance from it, its apex where the pinion's axis meets that plane. So do wheel's tip and pinion's root. Lengths in mm, angles in
rad; (pinion, wheel) each. Equation numbers are those of ISO 23509:2016, clause 7.4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones

#: what is left (rad) of an angle that counts as none, and steps towards it at most
REACHED, MOST_STEPS = 1e-14, 200


@dataclass(frozen=True)
class MatingPlane:
    """A plane that touches a cone of the wheel: its auxiliary angle phi and its offset angle zeta, and the angle that it makes
    with the pinion's axis.
    """

    auxiliary_angle: float
    offset_angle: float
    pinion_angle: float


@dataclass(frozen=True)
class BlankCones:
    """Face angles delta_a, root angles delta_f, and the apexes t_zF and t_zR of these cones beyond the crossing points;
    `root_plane`, `face_plane`: of the wheel (phi_R, zeta_R and phi_o, zeta_o).
    """

    face_angles: tuple[float, float]
    root_angles: tuple[float, float]
    face_apexes: tuple[float, float]
    root_apexes: tuple[float, float]
    root_plane: MatingPlane
    face_plane: MatingPlane


def blank_cones(
    pitch: PitchCones, tapers: tuple[float, float], depths: tuple[float, float], clearance: float
) -> BlankCones:
    """The cones by the wheel's addendum and dedendum angles `tapers` (theta_a2, theta_f2) and its mean addendum and dedendum
    `depths` (h_am2, h_fm2) across the pitch cone.
    """
    angle, mean, apex = pitch.pitch_angles[1], pitch.mean_cone_distances[1], pitch.pitch_apexes[1]
    (addendum_angle, dedendum_angle), (addendum, dedendum) = tapers, depths
    face, root = angle + addendum_angle, angle - dedendum_angle
    root_plane, face_plane = _plane(pitch, dedendum_angle), _plane(pitch, -addendum_angle)
    # (150), (151)
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
    """The plane on the wheel's cone that is `lean` within the pitch cone."""
    if pitch.offset == 0.0:
        return MatingPlane(0.0, 0.0, pitch.pitch_angles[0] + lean)
    angle, beyond = pitch.pitch_angles[1] - lean, pitch.shaft_angle - 0.5 * np.pi
    along = pitch.mean_cone_distances[1] * np.cos(lean) - pitch.pitch_apexes[1] * np.cos(angle)
    # (142), (143), then (144), (145)
    auxiliary = np.arctan(pitch.offset * np.tan(beyond) * np.cos(angle) / along)
    turn = np.arcsin(pitch.offset * np.cos(auxiliary) * np.sin(angle) / along) - auxiliary
    # (146), (147)
    sine = np.sin(beyond) * np.sin(angle) + np.cos(beyond) * np.cos(angle) * np.cos(turn)
    return MatingPlane(float(auxiliary), float(turn), float(np.arcsin(sine)))


def lean_of_plane(pitch: PitchCones, pinion_angle: float) -> float:
    """Angle (rad) within the wheel's pitch cone of the cone whose plane makes `pinion_angle` (rad) with the pinion's axis: the
    inverse of (142)-(147), by steps of which each takes all but about 1 - cos(zeta) of what is missing.

    Raises DesignError, naming the key, for a root angle of the pinion that no plane has.
    """
    lean = pinion_angle - pitch.pitch_angles[0]
    for _ in range(MOST_STEPS):
        missing = pinion_angle - _plane(pitch, lean).pinion_angle
        if abs(missing) <= REACHED:
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
    """Apex of the pinion's cone beyond its crossing point, from that of the wheel's cone [ISO 23509 (152), (153)]."""
    offset = pitch.offset * np.sin(plane.offset_angle) * np.cos(angle)
    return float((offset - apex * np.sin(angle) - clearance) / np.sin(plane.pinion_angle))
