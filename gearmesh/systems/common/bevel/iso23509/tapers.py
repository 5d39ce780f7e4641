"""Depth tapers: addendum and dedendum angles of the wheel. ISO 23509:2016, annex C.5."""

from __future__ import annotations

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.common.bevel.iso23509.taper_names import TAPER_NAMES

#: largest sum of the dedendum angles with a tilted root line, over the sum of the standard taper
MAX_TILT_RATIO = 1.3


def standard_dedendum_angle(dedendum: float, mean_cone_distance: float) -> float:
    """Return theta_f (rad) of a root line through the pitch apex."""
    return float(np.arctan(dedendum / mean_cone_distance))


def duplex_sum(cones: PitchCones, pressure_angle: float, cutter_radius: float) -> float:
    """Sum of the dedendum angles (rad) at which a face-milling cutter of one point width makes constant slots.

    The slots then have the same width from toe to heel.
    """
    mean, spiral = cones.mean_cone_distances[1], cones.spiral_angles[1]
    # m_et2 / R_e2 = 2 sin(delta_2) / z_2
    share = 2.0 * np.sin(cones.pitch_angles[1]) / cones.teeth[1]
    full = 0.5 * np.pi * share / (np.tan(pressure_angle) * np.cos(spiral))
    return float(full * (1.0 - mean * np.sin(spiral) / cutter_radius))


def taper_angles(
    taper: str,
    cones: PitchCones,
    dedenda: tuple[float, float],
    wheel_addendum: float,
    working_depth: float,
    pressure_angle: float,
    cutter_radius: float,
) -> tuple[float, float]:
    """Return theta_a2, theta_f2 (rad) of a taper.

    - `taper`: a name in TAPER_NAMES
    - `cones`: pitch cones of both members
    - `dedenda`: mean dedenda h_fm1, h_fm2, mm
    - `wheel_addendum`, `working_depth`: h_am2, h_mw, mm
    - `pressure_angle`: mean normal pressure angle alpha_n, rad
    - `cutter_radius`: radius of the cutter, mm

    Raises DesignError, naming the key, for a taper that is unknown or would be reversed.
    """
    if taper not in TAPER_NAMES:
        raise DesignError(
            "taper",
            taper,
            shown=f"{taper!r}",
            must_be=f"one of {', '.join(TAPER_NAMES)}, or left out for both angles of the wheel",
        )
    if taper == "uniform":
        return 0.0, 0.0
    pinion_angle, wheel_angle = (
        standard_dedendum_angle(dedendum, cones.mean_cone_distances[1]) for dedendum in dedenda
    )
    if taper == "standard":
        return pinion_angle, wheel_angle
    angle_sum = duplex_sum(cones, pressure_angle, cutter_radius)
    if not angle_sum > 0.0:
        least = cones.mean_cone_distances[1] * np.sin(cones.spiral_angles[1])
        raise DesignError(
            "gear.cutter.tip_radius",
            cutter_radius,
            unit="mm",
            reason=f"a {taper} taper would make the teeth deeper at the toe",
            allowed=Allowed.more_than(float(least), "mm", note=", or another taper"),
        )
    if taper == "tilted_root_line":
        angle_sum = min(angle_sum, MAX_TILT_RATIO * (pinion_angle + wheel_angle))
    addendum = angle_sum * wheel_addendum / working_depth
    return addendum, angle_sum - addendum
