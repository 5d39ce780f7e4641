"""Profiles of the parabolic rack cutters, and the room on the tips of their teeth [LF04 17.7, Table 17.8.1]."""

from __future__ import annotations

import numpy as np

from gearmesh.systems.common.racks.rack_tooth import largest_rounding, tip_land
from gearmesh.tools.rack import Parabola

#: points of a flank between which the tooth's tip is searched
LAND_SAMPLES = 65

#: right and left flank of a cutter's space
Flanks = tuple[Parabola, Parabola]


def rounding_room(flanks: Flanks, depth: float, most: float) -> float:
    """Return the largest rounding of a rack's tip at a `depth`, up to `most`; 0 if the tip is pointed or bent back."""
    if not has_room(flanks, depth, 0.0):
        return 0.0
    return largest_rounding(flanks, -depth, flanks[0].line.a, most)


def has_room(flanks: Flanks, depth: float, radius: float) -> bool:
    """True if a rack's tip at a `depth` has room for roundings of a `radius`."""
    if not np.isfinite([flank.at_height(-depth) for flank in flanks]).all():
        return False
    rounded = np.array([radius])
    return bool(tip_land(flanks, (rounded, rounded), -depth, flanks[0].line.a)[0] >= 0.0)


def land(flanks: Flanks, roll: tuple[float, float], height: float, sunk: float) -> float:
    """Return the width across the axis of the land of the tooth that a rack generates; NaN if there is no such tooth.

    - roll: pitch radius and helix angle (rad).
    - height: height of the land above the pitch cylinder.
    - sunk: depth of the rack's pitch plane below the pitch cylinder.

    The rack touches the tooth where the transverse normal passes through the pitch point: y = x n_y / n_x on the line
    of action.
    """
    radius, helix = roll
    width = 0.0
    for flank in flanks:
        p = np.linspace(flank.at_height(sunk), flank.at_height(height + sunk), LAND_SAMPLES)
        point, _, normal, _ = flank.section(p)
        x, aside = point[:, 0] - sunk, (point[:, 0] - sunk) * normal[:, 1] / normal[:, 0] * np.cos(helix)
        turn = (point[:, 1] / np.cos(helix) - aside) / radius
        reached = np.hypot(radius + x, aside)
        inside = float(np.interp(radius + height, reached, turn + np.arctan2(aside, radius + x), right=np.nan))
        width -= (radius + height) * inside
    return width
