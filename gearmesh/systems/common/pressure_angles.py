"""Pressure angles and tool roundings of asymmetric teeth: of the drive side and of the coast side.

The drive side are the right flanks of the pinion and the flanks of its mating gear that they touch: right flanks of an
external gear, left flanks of an internal one.
"""

from __future__ import annotations

from typing import Any, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.keys import Table, conflict


def coast_pressure_angle_key() -> Any:
    """Return the key of the pressure angle of the coast side."""
    return keys.angle(
        "normal pressure angle of the coast side of asymmetric teeth: the pinion's left flanks and the gear's that they touch",
        None,
        low=1,
        high=45,
        default="pressure_angle",
    )


class CoastSide(Table):
    """Keys of the coast side of members with a `tool_tip_radius` and broken tip edges: tip rounding of the tool, tip edge."""

    coast_tool_tip_radius: float | None = keys.coefficient(
        "tool_tip_radius of the coast side: of the pinion's left flanks and the gear's that they touch",
        None,
        low=0,
        high=2,
        default="tool_tip_radius",
    )
    coast_tip_edge: float | None = keys.length(
        "tip_chamfer or tip_rounding of the coast side, where it is not that of the drive side",
        None,
        above=0,
        default="as on the drive side",
    )

    @property
    def sides_differ(self) -> bool:
        """True if the coast side has another tip rounding of the tool or another tip edge."""
        return self.coast_tip_edge is not None or self.coast_tool_tip_radius not in (
            None,
            getattr(self, "tool_tip_radius", None),
        )

    @model_validator(mode="after")
    def _edge_has_a_shape(self) -> Self:
        if self.coast_tip_edge is not None and not any(
            getattr(self, key, None) for key in ("tip_chamfer", "tip_rounding")
        ):
            raise conflict("coast_tip_edge", self.coast_tip_edge, reason="needs tip_chamfer or tip_rounding")
        return self
