"""Design of a hypoid pair: bevel gears with offset axes; the blank follows method 1 of ISO 23509."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from gearmesh.design.keys import Key
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

    offset: Annotated[
        float,
        Key(
            "length",
            "offset of the axes, > 0 where it makes the pinion's spiral angle the larger one",
            source="ISO 23509 a",
        ),
    ]
    spiral_angle: Annotated[
        float, Key("angle", "mean spiral angle of the pinion", low=0, high=80, source="ISO 23509")
    ] = 50.0
    limit_share: Annotated[
        float,
        Key(
            "number",
            "share of the limit pressure angle that the gear's blades compensate: 1 = equal conditions on both sides",
            low=0,
            high=1,
            source="ISO 23509 f_alim",
        ),
    ] = 1.0
