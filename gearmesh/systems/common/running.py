"""Rows of torque, speed and power of members that turn."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gearmesh.systems.common.symbol_table import Row


def running_rows(torques: Sequence[float], speeds: Sequence[float] | None) -> list[Row]:
    """Return the rows of torques (Nm), speeds (1/min) and powers; only torques if there are no `speeds`."""
    rows: list[Row] = [("T", "torque", "Nm", tuple(torques))]
    if speeds is None:
        return rows
    power = tuple(1e-3 * torque * math.pi * speed / 30.0 for torque, speed in zip(torques, speeds, strict=True))
    return [*rows, ("n", "speed", "1/min", tuple(speeds)), ("P", "power, without losses", "kW", power)]
