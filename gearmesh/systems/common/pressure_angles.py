"""Pressure angles and tool roundings of asymmetric teeth: of the drive side and of the coast side.

The drive side are the right flanks of the pinion and the flanks of its mating gear that they touch: right flanks of an
external gear, left flanks of an internal one.
"""

from __future__ import annotations

from typing import Any

from gearmesh.design import keys
from gearmesh.design.keys import Table


def coast_pressure_angle_key() -> Any:
    """Return the key of the pressure angle of the coast side."""
    return keys.angle(
        "normal pressure angle of the coast side of asymmetric teeth: the pinion's left flanks and the gear's that they touch",
        None,
        low=1,
        high=45,
        default="pressure_angle",
    )


class CoastRounding(Table):
    """Key of the tool's tip rounding on the coast side, of members with a `tool_tip_radius`."""

    coast_tool_tip_radius: float | None = keys.coefficient(
        "tool_tip_radius of the coast side: of the pinion's left flanks and the gear's that they touch",
        None,
        low=0,
        high=2,
        default="tool_tip_radius",
    )
