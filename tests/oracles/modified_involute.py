"""Transmission error of a spur pinion with any profile against a gear with true involutes, in closed form.

The common normal touches the gear's base circle. The normal at roll length L of a flank that gives way by a(L) leans by eps from
that of the involute, tan(eps) = r_b a' / (L (1 + a')), and passes the pinion's axis at rho = r_b cos(eps) - L sin(eps), so that
the working pressure angle is cos(alpha) = (rho + r_b2) / A. This fixes how pinion and gear stand, without any solving.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel import Array


@dataclass(frozen=True)
class Turned:
    """Angles (...,), rad: by how much the pinion's involute has to turn so that it touches there, and how far the gear is ahead."""

    theta: Array
    lead: Array


def turned(base: tuple[float, float], distance: float, length: Array, a: Array, slope: Array) -> Turned:
    """At roll lengths (...,) of the pinion, mm, with amounts (...,), mm, and their slopes (...,); base radii and distance, mm.

    The lead is less than 0 by what is removed; `theta` is the angle in space at which the pinion's involute begins.
    """
    pinion, gear = base
    lean = np.arctan2(pinion * slope, length * (1.0 + slope))
    rho = pinion * np.cos(lean) - length * np.sin(lean)
    alpha = np.arccos((rho + gear) / distance)
    theta = alpha - lean - (length + a) / pinion
    # the point, and how much of the normal is left to the gear's base circle
    phi = alpha - lean
    point = np.stack((pinion * np.cos(phi) + length * np.sin(phi), pinion * np.sin(phi) - length * np.cos(phi)))
    rest = (distance - point[0]) * np.sin(alpha) + point[1] * np.cos(alpha)
    true = np.arccos(sum(base) / distance)
    nominal = true - distance * np.sin(true) / gear + pinion / gear * true
    return Turned(theta, alpha - rest / gear + pinion / gear * theta - nominal)
