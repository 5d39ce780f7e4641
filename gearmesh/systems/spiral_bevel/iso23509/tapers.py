"""Depth tapers: the addendum and dedendum angles of the wheel that a cutter, or habit, asks for. ISO 23509:2016, annex C.5."""

from __future__ import annotations

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.spiral_bevel.iso23509.taper_names import TAPERS

#: sum of the dedendum angles with a tilted root line over that of the standard taper, at most
MOST_TILT = 1.3


def standard_dedendum_angle(dedendum: float, mean_cone_distance: float) -> float:
    """theta_f (rad): the root line passes through the pitch apex."""
    return float(np.arctan(dedendum / mean_cone_distance))


def duplex_sum(cones: PitchCones, pressure_angle: float, cutter_radius: float) -> float:
    """Sum of the dedendum angles (rad) at which a face-milling cutter of one point width makes slots of constant width."""
    mean, spiral = cones.mean_cone_distances[1], cones.spiral_angles[1]
    # m_et2 / R_e2 is 2 sin(delta_2) / z_2
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
    """theta_a2, theta_f2 (rad) by a taper of TAPERS, the mean `dedenda` h_fm1, h_fm2, h_am2, h_mw (mm) and alpha_n (rad).

    Raises DesignError, naming the key, for a taper that is unknown or would turn round.
    """
    if taper not in TAPERS:
        raise DesignError(
            "taper",
            taper,
            shown=f"{taper!r}",
            must_be=f"one of {', '.join(TAPERS)}, or left out for both angles of the wheel",
        )
    if taper == "uniform":
        return 0.0, 0.0
    first, second = (standard_dedendum_angle(dedendum, cones.mean_cone_distances[1]) for dedendum in dedenda)
    if taper == "standard":
        return first, second
    both = duplex_sum(cones, pressure_angle, cutter_radius)
    if not both > 0.0:
        least = cones.mean_cone_distances[1] * np.sin(cones.spiral_angles[1])
        raise DesignError(
            "gear.cutter.tip_radius",
            cutter_radius,
            unit="mm",
            reason=f"a {taper} taper would make the teeth deeper at the toe",
            allowed=f"more than {at_least(float(least))} mm, or another taper",
        )
    if taper == "tilted_root_line":
        both = min(both, MOST_TILT * (first + second))
    addendum = both * wheel_addendum / working_depth
    return addendum, both - addendum
