"""Keys of eccentric members: size and direction of the eccentricity of the teeth [CR3553 3.4]."""

from __future__ import annotations

import math
from typing import Any

from gearmesh.design import keys
from gearmesh.design.core import Design
from gearmesh.design.keys import Table


def eccentricity(member: str) -> Any:
    """Return the key of the eccentricity of a member."""
    return keys.length(
        f"eccentricity of the teeth to the {member}'s axis of rotation", 0.0, low=0, high=1, source="[CR3553] 3.4"
    )


def phase(member: str) -> Any:
    """Return the key of the direction of the eccentricity."""
    return keys.angle(f"its direction in the {member}, from the tooth on x", 0.0, low=-360, high=360)


class PinionRunout(Table):
    """An eccentric pinion."""

    pinion_eccentricity: float = eccentricity("pinion")
    pinion_phase: float = phase("pinion")


class PairRunout(PinionRunout):
    """An eccentric pinion and an eccentric gear."""

    gear_eccentricity: float = eccentricity("gear")
    gear_phase: float = phase("gear")


def runout(design: Design, member: str) -> tuple[float, float]:
    """Return the eccentricity (x, y) of the teeth of a member, in the design's unit and the member's frame."""
    table, key = getattr(design, "assembly", None), Design.table_named(member)
    size, angle = getattr(table, f"{key}_eccentricity", 0.0), math.radians(getattr(table, f"{key}_phase", 0.0))
    return size * math.cos(angle), size * math.sin(angle)
