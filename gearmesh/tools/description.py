"""Description of a tool that makes a flank: name, dimensions, profile with the zero of its heights, and drawing.

The teeth know a tool by its description alone. A new kind of tool needs a description and, to be shown, a `Drawing`.
"""

from __future__ import annotations

from enum import StrEnum

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass
from gearmesh.tools.drawing import Drawing
from gearmesh.tools.profile import Profile


class HeightZero(StrEnum):
    """Zero of the heights of a tool's profile."""

    PITCH_PLANE = "pitch plane"
    TIP_PLANE = "tip plane"
    NOWHERE = "nowhere"


@dataclass(frozen=True)
class Dimension:
    """A named dimension of a tool."""

    #: name of the dimension
    name: str
    #: value in `unit`
    value: float
    #: "mm", "deg", or "" for a number
    unit: str
    #: symbol of ISO 21771 with the index 0, or ""
    symbol: str = ""

    def __str__(self) -> str:
        return " ".join(filter(None, (self.name, f"{self.value:.6g}", self.unit)))


@dataclass(frozen=True)
class RolledRack:
    """The rack that generates a flank, or the rack of the tool that grinds it."""

    surface: Surface
    #: radius (mm) of the pitch circle on which the rack rolls
    radius: float


@dataclass(frozen=True)
class ToolDescription:
    """Description of the tool that made a flank, kept with the flank."""

    #: name of the tool
    name: str
    #: how the tool is shown in place; None if it is not shown
    drawing: Drawing | None = None
    #: dimensions of the tool
    dimensions: tuple[Dimension, ...] = ()
    #: profile that generates the flank, in the flank's parameter; x is the height
    profile: Profile | None = None
    #: profile that generates the fillet, in the fillet's parameter; x is the height
    tip: Profile | None = None
    #: rounding of the tip, mm
    tip_radius: float = 0.0
    #: zero of the heights
    zero: HeightZero = HeightZero.NOWHERE
    #: rack that generates the flank, if there is one
    rack: RolledRack | None = None

    def height(self, p: Array) -> Array:
        """Return the height (...,), mm, of the flank's profile at p (...,) over `zero`; NaN without a profile."""
        return np.full_like(p, np.nan) if self.profile is None else self.profile.section(p)[0][..., 0]
