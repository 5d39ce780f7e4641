"""Design of a hypoid pair: bevel gears with offset axes; the blank follows method 1 of ISO 23509."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from gearmesh.design import keys
from gearmesh.systems.kinds import OWN_KINDS
from gearmesh.systems.spiral_bevel.design import FaceMilledDesign


class HypoidDesign(FaceMilledDesign):
    """A hypoid pair cut by head cutters."""

    own_kind: ClassVar[str] = "hypoid"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 4.5,
        "offset": 25,
        "pinion": {"teeth": 12},
        "gear": {"teeth": 41},
    }
    about: ClassVar[str] = OWN_KINDS["hypoid"].about
    called: ClassVar[str] = "Hypoid gears"

    offset: float = keys.length(
        "offset of the axes, > 0 where it makes the pinion's spiral angle the larger one", source="ISO 23509 a"
    )
    spiral_angle: float = keys.angle("mean spiral angle of the pinion", 50.0, low=0, high=80, source="ISO 23509")
    limit_share: float = keys.number(
        "share of the limit pressure angle that the gear's blades compensate: 1 = equal conditions on both sides",
        1.0,
        low=0,
        high=1,
        source="ISO 23509 f_alim",
    )
