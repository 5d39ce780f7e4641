"""Flank forms of worms, and the lead angle for a normal module [ISO 10828:2015]."""

from __future__ import annotations

import math
from enum import StrEnum


class ThreadForm(StrEnum):
    """Flank forms of ISO 10828."""

    ZA = "ZA"
    ZN = "ZN"
    ZI = "ZI"
    ZK = "ZK"
    ZC = "ZC"


def lead_angle(normal_module: float, threads: int, diameter: float) -> float:
    """Return the lead angle (rad) of threads of a normal module on a reference cylinder.

    sin(gamma) = m_n z / d, with both lengths in one unit. The angle is a right angle if the cylinder is too small for
    the threads.
    """
    return math.asin(min(1.0, normal_module * threads / diameter))
