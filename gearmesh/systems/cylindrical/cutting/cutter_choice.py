"""Which shaper cutters leave an internal gear its tips: with few teeth they generate no involute up to there, with many they trim.

A cutter's involute begins at its base circle, so that what it generates of the gear's flank ends at a radius that falls as the
cutter has more teeth; fed in radially it cuts tips off below a radius that grows with them (see `interference`). A tip radius
between both is what a cutter can do.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import dataclass, replace

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.cylindrical.design import FORMED
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, distance_of
from gearmesh.systems.cylindrical.geometry.interference import least_that, reserves
from gearmesh.tools.shaper import Shaper

#: teeth of a cutter that is not given: part of the member's, and between which numbers
CUTTER, FEWEST, MOST = 0.4, 12, 50
#: fewest teeth that any cutter has
LEAST = 6
#: how far, in modules, a default tip stays from where a cutter's involute begins, or where it trims
INSIDE = 0.02


def standard_teeth(own: Toothing) -> int:
    """Teeth of the cutter of a member where nothing speaks against them."""
    return min(max(FEWEST, round(CUTTER * own.teeth)), MOST, own.teeth - 1)


def generating(cutter: Toothing, own: Toothing) -> InvolutePair:
    """Cutter and member as they stand when the last cut is made: without backlash."""
    signed = own.signed_teeth + cutter.teeth
    thicknesses = (own.thickness + cutter.thickness) / own.module
    # the sum of shifts that belongs to these thicknesses
    shifts = (thicknesses - math.pi) / (2.0 * math.tan(own.alpha))
    even = replace(cutter, shift=shifts, allowance=0.0), replace(own, shift=0.0, allowance=0.0)
    return InvolutePair(cutter, own, distance_of(*even) if signed else math.nan)


def sharp_tool(cutting: InvolutePair, root: float) -> Shaper:
    """The cutter of a last cut to a root radius, without rounding, as a tool in the transverse section.

    Raises DesignError for one that cannot exist.
    """
    cutter, own = cutting.pinion, cutting.gear
    return Shaper(
        teeth=cutter.teeth,
        module=cutter.transverse_module,
        pressure_angle=cutter.alpha_t,
        addendum=own.sense * (cutting.distance - root) - cutter.radius,
        profile_shift=cutter.shift * math.cos(cutter.beta),
    )


@dataclass(frozen=True)
class CutterChoice:
    """An internal gear, its root radius, and a cutter, which may have other tooth numbers."""

    own: Toothing
    root: float
    cutter: Toothing

    def cutting(self, teeth: int) -> InvolutePair:
        return generating(replace(self.cutter, teeth=teeth), self.own)

    def involute_from(self, teeth: int) -> float:
        """Least radius at which a cutter generates involute; infinite of one that cannot exist."""
        cutting = self.cutting(teeth)
        try:
            sharp_tool(cutting, self.root)
        except DesignError:
            return math.inf
        return math.hypot(self.own.base_radius, cutting.generator)

    def clears(self, teeth: int, tip: float) -> bool:
        """Whether a cutter that is fed in radially leaves tips of a radius as they are."""
        cutting = self.cutting(teeth)
        if self.root <= cutting.distance:
            # a cutter whose tips do not reach beyond its own axis
            return False
        return reserves(cutting, (self.root - cutting.distance, tip)).trimming >= 0.0

    def untrimmed_from(self, teeth: int) -> float:
        """Least tip radius that a cutter fed in radially leaves as it is."""
        return least_that(lambda tip: self.clears(teeth, tip), self.own.base_radius, self.root)

    @property
    def numbers(self) -> range:
        return range(LEAST, self.own.teeth)

    def generating_from(self, tip: float) -> int:
        """Fewest teeth that generate involute up to a tip radius, the gear's own number where none do."""
        return self._first(lambda teeth: self.involute_from(teeth) <= tip)

    def clearing_up_to(self, tip: float) -> int:
        """Most teeth that do not trim tips of a radius."""
        return self._first(lambda teeth: not self.clears(teeth, tip)) - 1

    def _first(self, holds: Callable[[int], bool]) -> int:
        """The first number that holds, as all that follow do."""
        return LEAST + bisect_left(self.numbers, True, key=holds)

    @property
    def deepest(self) -> tuple[int, float]:
        """The cutter that does both for the least tip radius, and that radius."""
        crossing = self._first(lambda teeth: self.untrimmed_from(teeth) >= self.involute_from(teeth))
        both = [teeth for teeth in (crossing - 1, crossing) if teeth in self.numbers] or [self.numbers[-1]]
        radii = {teeth: max(self.untrimmed_from(teeth), self.involute_from(teeth)) for teeth in both}
        best = min(radii, key=lambda teeth: radii[teeth])
        return best, radii[best]

    def default_teeth(self, tip: float) -> int:
        """The standard cutter's, or, where it leaves no involute up to a tip radius, the fewest that do."""
        standard = standard_teeth(self.own)
        if self.involute_from(standard) <= tip:
            return standard
        return min(max(standard, self.generating_from(tip)), self.own.teeth - 1)

    def default_tip(self, tip: float, *, given: bool) -> float:
        """A tip radius, or what there is a cutter for; only the one there is, if it is `given`."""
        teeth = self.cutter.teeth if given else standard_teeth(self.own)
        least = self.involute_from(teeth)
        if least <= tip:
            return tip
        if not given:
            if self.generating_from(tip) <= self.clearing_up_to(tip):
                return tip
            least = self.deepest[1]
        # without any cutter that can exist the shaper's own refusal says why
        return tip if math.isinf(least) else max(tip, least + INSIDE * self.own.module)

    def possible(self, name: str, tip: float) -> str:
        """Which tooth numbers leave tips of a radius, in words, and which tips there is a cutter for where none do."""
        low, high = self.generating_from(tip), self.clearing_up_to(tip)
        if low <= high:
            return f"allowed are {low} teeth" if low == high else f"allowed are {low} to {high} teeth"
        teeth, radius = self.deepest
        other = f"{name}.tip_diameter of at least {at_least(2.0 * radius)} mm with {teeth} teeth"
        few = f"fewer than {low} teeth leave no involute up to the tip diameter of {2.0 * tip:.7g} mm"
        if low >= self.own.teeth:
            few = f"no cutter generates involute up to the tip diameter of {2.0 * tip:.7g} mm"
        if tip >= self.own.base_radius:
            other += f', or {name}.manufacture = "{FORMED}", which needs no cutter'
        return f"{few}, more than {high} trim the tips; allowed is {other}"
