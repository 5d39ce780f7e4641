"""Order for a tool path, which all steps of planning and proof take, and the material that passes and chords may leave."""

from __future__ import annotations

import math
from typing import Self

from gearmesh.errors import ArgumentError
from gearmesh.lengths import Length, in_mm
from gearmesh.records import dataclass

#: feed order in which passes alternate in direction
ZIGZAG_ORDER = "zigzag"
#: feed order in which all passes go from toe to heel
ONE_WAY_ORDER = "one-way"
#: choices of the flanks to finish
FLANK_CHOICES = ("right", "left", "both")
#: choices of the surfaces to finish
SURFACE_CHOICES = ("all", "flanks")
#: choices of the feed order
FEED_ORDERS = (ZIGZAG_ORDER, ONE_WAY_ORDER)
#: smallest and largest scallop
SCALLOP_RANGE_MM = (1e-4, 1.0)
#: smallest and largest lead and tilt
AXIS_ANGLE_RANGE_DEG = (-85.0, 85.0)
#: largest part of the scallop that chords may use
MAX_CHORD_SHARE = 0.5
#: share of the scallop for chords if no tolerance is given
DEFAULT_CHORD_SHARE = 0.1
#: share of the scallop reserved for effects of higher order
RESERVED_SCALLOP_SHARE = 0.05


@dataclass(frozen=True)
class Budget:
    """Allowed material left, mm."""

    #: material left between passes
    scallop: float
    #: material left along passes, by chords
    chord: float


@dataclass(frozen=True)
class PathOrder:
    """Order for a tool path; lengths in mm, angles in rad."""

    #: largest height over the surface (or over the stock), chords included
    scallop: float
    #: part of the scallop for chords; None for a tenth
    chord: float | None = None
    #: material left along the normals on purpose
    stock: float = 0.0
    #: "left", "right" or "both"
    flank: str = "both"
    #: "all" (with fillets and root) or "flanks"
    surfaces: str = "all"
    #: number of the space to cut, which is the number of the tooth after it; None for all spaces of all rows
    spaces: int | None = 0
    #: "zigzag" or "one-way"
    feed: str = ZIGZAG_ORDER
    #: lead of the tool axis; None to choose it
    lead: float | None = None
    #: tilt of the tool axis; None to choose it
    tilt: float | None = None

    @classmethod
    def of(
        cls,
        scallop: Length,
        *,
        stock: Length = 0.0,
        tolerance: Length | None = None,
        flank: str = "both",
        surfaces: str = "all",
        spaces: int | str = 0,
        order: str = ZIGZAG_ORDER,
        lead: float | None = None,
        tilt: float | None = None,
    ) -> Self:
        """Return the order for arguments of `Gears.toolpath`: lengths as texts or in mm, angles in deg.

        Raises ArgumentError for a wrong argument.
        """
        for name, value, allowed in (
            ("flank", flank, FLANK_CHOICES),
            ("surfaces", surfaces, SURFACE_CHOICES),
            ("order", order, FEED_ORDERS),
        ):
            if value not in allowed:
                raise ArgumentError(name, value, must_be=f"one of {', '.join(allowed)}")
        low, high = AXIS_ANGLE_RANGE_DEG
        for name, angle in (("lead", lead), ("tilt", tilt)):
            if angle is not None and not low <= angle <= high:
                raise ArgumentError(name, angle, must_be=f"an angle from {low:g} to {high:g} deg")
        if spaces != "all" and not (isinstance(spaces, int) and not isinstance(spaces, bool)):
            raise ArgumentError("spaces", spaces, must_be="all, or the number of one")
        height = in_mm("scallop", scallop, *SCALLOP_RANGE_MM, "10um, 0.01mm or 0.0004in")
        chord = None
        if tolerance is not None:
            chord_range = (1e-2 * SCALLOP_RANGE_MM[0], MAX_CHORD_SHARE * height)
            chord = in_mm("tolerance", tolerance, *chord_range, "1um or 0.001mm")
        return cls(
            scallop=height,
            chord=chord,
            stock=in_mm("stock", stock, 0.0, 100.0, "0.1, 100um or 0.004in"),
            flank=flank,
            surfaces=surfaces,
            spaces=None if spaces == "all" else int(spaces),
            feed=order,
            lead=None if lead is None else math.radians(lead),
            tilt=None if tilt is None else math.radians(tilt),
        )

    @property
    def budget(self) -> Budget:
        """Parts of the scallop for passes and chords."""
        chord = DEFAULT_CHORD_SHARE * self.scallop if self.chord is None else self.chord
        return Budget((1.0 - RESERVED_SCALLOP_SHARE) * self.scallop - chord, chord)
