"""Flank forms of worms, and their lead angle by the normal module. ISO 10828:2015."""

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
    """Lead angle (rad) of threads of a normal module on a reference cylinder, of one unit: sin(gamma) = m_n z / d; a right angle
    where the cylinder is too small for them."""
    return math.asin(min(1.0, normal_module * threads / diameter))
