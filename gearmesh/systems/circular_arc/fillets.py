"""Room for the fillet arcs of the racks of circular-arc gears [LT85 Figs. 4, 5].

The arc about (-b, a) with radius rho and the fillet arc touch. The fillet arc also touches the cutter's tip plane,
`root` under the pitch plane. The arcs touch from outside on rack F (convex teeth), from inside on rack P (concave
teeth):

    F: sin(theta) = (f + b - root) / (rho + f),    P: sin(theta) = (b + root - f) / (rho - f)

Such a theta must exist. The flank must begin before it ends at the tip. The roundings of a cutter's tooth must not
overlap.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.records import dataclass

#: radii that are tried, in modules
TRIED_RADII = np.linspace(0.0, 2.0, 401)
#: part of the available room by which a default stays inside it
ROOM_MARGIN = 0.05


@dataclass(frozen=True)
class ArcRack:
    """The space of a rack; lengths in mm, or in the design's unit."""

    #: True for rack F, False for rack P
    convex: bool
    #: radius of the arc
    rho: float
    #: distance of the arc's centre along the pitch plane
    a: float
    #: distance of the arc's centre from the pitch plane
    b: float
    #: height of the blank's tip above the pitch plane
    tip: float
    #: depth of the cutter's tip plane below the pitch plane
    root: float
    #: half a pitch in the normal section
    half_pitch: float
    #: distance by which the backlash sets the flank back
    thinning: float = 0.0

    @property
    def sine_at_tip(self) -> float:
        """sin(theta) of the arc's point at the blank's tip."""
        return (self.tip + self.b) / self.rho if self.convex else (self.b - self.tip) / self.rho

    def sine(self, fillet: Array) -> Array:
        """Return sin(theta) of the point at which arc and fillet touch."""
        with np.errstate(all="ignore"):
            if self.convex:
                sine: Array = (fillet + self.b - self.root) / (self.rho + fillet)
            else:
                sine = np.where(fillet < self.rho, (self.b + self.root - fillet) / (self.rho - fillet), np.nan)
        return sine

    def centre(self, fillet: Array) -> tuple[Array, Array]:
        """Return the centre of the fillet arc."""
        with np.errstate(all="ignore"):
            sine = self.sine(fillet)
            cosine = np.sqrt(1.0 - sine**2)
        if self.convex:
            return -self.b + (self.rho + fillet) * sine, self.a + self.thinning - (self.rho + fillet) * cosine
        y = -self.a - self.half_pitch + self.thinning + (self.rho - fillet) * cosine
        return self.b - (self.rho - fillet) * sine, y

    def fits(self, fillet: Array) -> NDArray[np.bool_]:
        """Return True where there is room for fillets.

        `fillet`: radii, in the unit of the rack.
        """
        sine = self.sine(fillet)
        flank = sine < self.sine_at_tip if self.convex else sine > self.sine_at_tip
        has_room: NDArray[np.bool_] = (sine > 0.0) & (sine < 1.0) & flank & (self.centre(fillet)[1] >= -self.half_pitch)
        return has_room

    def room(self, module: float) -> tuple[float, float] | None:
        """Return the smallest and the largest fillet that fits.

        `module`: of the design, in the unit of the rack.
        """
        fits = np.flatnonzero(self.fits(TRIED_RADII * module))
        if not fits.size:
            return None
        last = TRIED_RADII.size - 1
        inside = TRIED_RADII[[fits[0], fits[-1]]]
        beside = TRIED_RADII[[max(fits[0] - 1, 0), min(fits[-1] + 1, last)]]
        ends, _ = last_true(lambda f, _: self.fits(f * module), inside, beside)
        return float(ends[0]), float(ends[1])

    def fillet_or_next(self, standard: float, module: float) -> float:
        """Return the standard fillet, or the nearest fillet that fits.

        `module`: of the design, in the unit of the rack.
        """
        room = self.room(module)
        if room is None or self.fits(np.array(standard * module)):
            return standard
        low, high = room
        return low + ROOM_MARGIN * (high - low) if standard < low else high - ROOM_MARGIN * (high - low)
