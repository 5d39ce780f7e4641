"""Keys of a worm that grinds a member, for every system with such a worm."""

from __future__ import annotations

from gearmesh.design import keys
from gearmesh.design.keys import DERIVED_VALUE, Table


class WormTool(Table):
    """The worm that grinds a member."""

    pitch_radius: float = keys.length(
        "pitch radius r_w", DERIVED_VALUE, above=0, default="20 m_n", source="[LF04] (17.7.4)"
    )
    threads: int = keys.count("number of threads", 1, low=1, high=20, source="[LF04] (17.7.5)")
    right_hand: bool = keys.flag("right-hand threads; else left-hand", True)
    length: float | None = keys.length(
        "length of the worm", None, above=0, default="as needed to grind the whole tooth, plus a pitch"
    )
    bore: float | None = keys.length(
        "bore diameter of the worm; 0 = no bore", None, low=0, default="40 % of the root diameter"
    )
