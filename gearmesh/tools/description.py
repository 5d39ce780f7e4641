"""What describes a tool that makes a flank: name and dimensions, profile and what its heights are counted from, its picture.

The teeth know a tool by this alone. A tool of another kind needs a description and, to be shown, a `Drawing`.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Surface
from gearmesh.tools.drawing import Drawing
from gearmesh.tools.profile import Profile


class HeightZero(StrEnum):
    """What heights of a tool's profile are counted from."""

    PITCH_PLANE = "pitch plane"
    TIP_PLANE = "tip plane"
    NOWHERE = "nowhere"


@dataclass(frozen=True)
class Dimension:
    """A dimension of a tool by its name, in `unit`: mm, deg, or "" for a number; `symbol` as of ISO 21771 with the index 0."""

    name: str
    value: float
    unit: str
    symbol: str = ""

    def __str__(self) -> str:
        return " ".join(filter(None, (self.name, f"{self.value:.6g}", self.unit)))


@dataclass(frozen=True)
class RolledRack:
    """The rack that generates a flank, or the tool that grinds it: its surface, and the pitch radius (mm) on which it rolls."""

    surface: Surface
    radius: float


@dataclass(frozen=True)
class ToolDescription:
    """A tool as the flank carries it that it made.

    `drawing`: how it is shown in place, None if it is not. `profile` and `tip`: those of its flank and of what generates the
    fillet, in the parameters of flank and fillet, x being the height; `zero` says over what. `tip_radius`: rounding of its tip, mm.
    """

    name: str
    drawing: Drawing | None = None
    dimensions: tuple[Dimension, ...] = ()
    profile: Profile | None = None
    tip: Profile | None = None
    tip_radius: float = 0.0
    zero: HeightZero = HeightZero.NOWHERE
    rack: RolledRack | None = None

    def height(self, p: Array) -> Array:
        """Height (...,), mm, of its flank's profile at p (...,): over its zero plane; NaN for a tool without a profile."""
        return np.full_like(p, np.nan) if self.profile is None else self.profile.section(p)[0][..., 0]
