"""Keys of a worm that grinds a member, for every system with such a worm."""

from __future__ import annotations

from typing import Annotated

from gearmesh.design.keys import DERIVED_VALUE, Key, Table


class WormTool(Table):
    """The worm that grinds a member."""

    pitch_radius: Annotated[
        float, Key("length", "pitch radius r_w", low=0, above=True, default="20 m_n", source="[LF04] (17.7.4)")
    ] = DERIVED_VALUE
    threads: Annotated[int, Key("count", "number of threads", low=1, high=20, source="[LF04] (17.7.5)")] = 1
    right_hand: Annotated[bool, Key("flag", "right-hand threads; else left-hand")] = True
    length: Annotated[
        float | None,
        Key(
            "length",
            "length of the worm",
            low=0,
            above=True,
            default="as needed to grind the whole tooth, plus a pitch",
        ),
    ] = None
    bore: Annotated[
        float | None,
        Key("length", "bore diameter of the worm; 0 = no bore", low=0, default="40 % of the root diameter"),
    ] = None
