"""Pressure angles of asymmetric teeth: one for the drive side, one for the coast side.

The drive side are the right flanks of the pinion and the flanks of its mating gear that they touch: right flanks of an
external gear, left flanks of an internal one.
"""

from __future__ import annotations

from typing import Any

from gearmesh.design import keys


def coast_pressure_angle_key() -> Any:
    """Return the key of the pressure angle of the coast side."""
    return keys.angle(
        "normal pressure angle of the coast side of asymmetric teeth: the pinion's left flanks and the gear's that they touch",
        None,
        low=1,
        high=45,
        default="pressure_angle",
    )
