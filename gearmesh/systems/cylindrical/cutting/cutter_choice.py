"""Choice of the shaper cutter of an internal gear: few teeth leave no involute at the tips, many teeth trim them.

The involute of a cutter begins at its base circle. The involute of the gear's flank therefore ends at a radius, which
falls as the cutter has more teeth. A cutter that is fed in radially cuts off tips below another radius, which grows
with its teeth (see `interference`). A tip radius not below either of them can be cut.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable
from dataclasses import replace

from gearmesh.errors import DesignError
from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.cylindrical.design import FORMED_MANUFACTURE
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, distance_of
from gearmesh.systems.cylindrical.geometry.interference import least_that, reserves
from gearmesh.systems.cylindrical.geometry.shifts import TIP_MARGIN_MODULES
from gearmesh.tools.shaper import Shaper, ShaperFlank

#: teeth of a default cutter, as part of the member's
CUTTER_TEETH_SHARE = 0.4
#: fewest teeth of a default cutter
MIN_DEFAULT_TEETH = 12
#: most teeth of a default cutter
MAX_DEFAULT_TEETH = 50
#: fewest teeth of any cutter
MIN_CUTTER_TEETH = 6


def standard_teeth(own: Toothing) -> int:
    """Return the number of teeth of a member's standard cutter."""
    return min(max(MIN_DEFAULT_TEETH, round(CUTTER_TEETH_SHARE * own.teeth)), MAX_DEFAULT_TEETH, own.teeth - 1)


def generating(cutter: Toothing, own: Toothing) -> InvolutePair:
    """Return cutter and member at the position of the last cut: without backlash."""
    signed = own.signed_teeth + cutter.teeth
    thicknesses = (own.thickness + cutter.thickness) / own.module
    # sum of the profile shifts that leads to these thicknesses
    shifts = (thicknesses - math.pi) / own.both_tangents
    nominal = replace(cutter, shift=shifts, allowance=0.0), replace(own, shift=0.0, allowance=0.0)
    return InvolutePair(cutter, own, distance_of(*nominal) if signed else math.nan)


def sharp_tool(cutting: InvolutePair, root: float) -> Shaper:
    """Return the cutter of a last cut to a root radius as a tool in the transverse section, without rounding.

    Its profile is the flank that cuts the drive side. Raises DesignError if it cannot exist.
    """
    cutter, own = cutting.pinion, cutting.gear
    flanks = [_flank(side) for side in cutting.sides] if own.asymmetric else [ShaperFlank(cutter.alpha_t)]
    return Shaper(
        teeth=cutter.teeth,
        module=cutter.transverse_module,
        pressure_angle=flanks[0].pressure_angle,
        addendum=own.sense * (cutting.distance - root) - cutter.radius,
        profile_shift=cutter.shift * math.cos(cutter.beta),
        thicker=flanks[0].thicker,
        opposite=flanks[1] if own.asymmetric else None,
    )


def _flank(cutting: InvolutePair) -> ShaperFlank:
    """Return the flank of a cutter that cuts one side of asymmetric teeth.

    Both sides together have no backlash at the last cut. Each side has none where the cutter is turned: one half of its
    tooth is thicker, the other half thinner.
    """
    cutter = cutting.pinion
    thicker = cutting.working_backlash * cutter.radius / cutting.working_radius(cutter)
    return ShaperFlank(cutter.alpha_t, thicker)


@dataclass(frozen=True)
class CutterChoice:
    """An internal gear, its root radius, and a cutter whose tooth number is varied."""

    own: Toothing
    root: float
    cutter: Toothing

    def cutting(self, teeth: int) -> InvolutePair:
        return generating(replace(self.cutter, teeth=teeth), self.own)

    def involute_from(self, teeth: int) -> float:
        """Return the least radius at which a cutter generates involute; infinite if the cutter cannot exist."""
        cutting = self.cutting(teeth)
        try:
            sharp_tool(cutting, self.root)
        except DesignError:
            return math.inf
        return max(math.hypot(side.gear.base_radius, side.generator) for side in cutting.sides)

    def clears(self, teeth: int, tip: float) -> bool:
        """True if a cutter that is fed in radially does not trim tips at a radius."""
        cutting = self.cutting(teeth)
        if self.root <= cutting.distance:
            # the cutter's tips do not reach beyond its own axis
            return False
        return reserves(cutting, (self.root - cutting.distance, tip)).trimming >= 0.0

    def untrimmed_from(self, teeth: int) -> float:
        """Return the least tip radius that a cutter fed in radially does not trim."""
        return least_that(lambda tip: self.clears(teeth, tip), self.own.largest_base_radius, self.root)

    @property
    def numbers(self) -> range:
        return range(MIN_CUTTER_TEETH, self.own.teeth)

    def generating_from(self, tip: float) -> int:
        """Return the fewest teeth that generate involute up to a tip radius; the gear's own number if none do."""
        return self._first(lambda teeth: self.involute_from(teeth) <= tip)

    def clearing_up_to(self, tip: float) -> int:
        """Return the most teeth that do not trim tips at a radius."""
        return self._first(lambda teeth: not self.clears(teeth, tip)) - 1

    def _first(self, holds: Callable[[int], bool]) -> int:
        """Return the first tooth number that `holds`; all larger numbers hold, too."""
        return MIN_CUTTER_TEETH + bisect_left(self.numbers, True, key=holds)

    @property
    def deepest(self) -> tuple[int, float]:
        """Cutter with the least tip radius that it neither trims nor leaves without involute, and this radius."""
        # one radius falls with the teeth, the other grows: the least maximum is beside their crossing
        crossing = self._first(lambda teeth: self.untrimmed_from(teeth) >= self.involute_from(teeth))
        neighbours = [teeth for teeth in (crossing - 1, crossing) if teeth in self.numbers] or [self.numbers[-1]]
        radii = {teeth: max(self.untrimmed_from(teeth), self.involute_from(teeth)) for teeth in neighbours}
        best = min(radii, key=lambda teeth: radii[teeth])
        return best, radii[best]

    def default_teeth(self, tip: float) -> int:
        """Return the teeth of the default cutter.

        It is the standard cutter, or the cutter with the fewest teeth that generate involute up to a tip radius.
        """
        standard = standard_teeth(self.own)
        if self.involute_from(standard) <= tip:
            return standard
        return min(max(standard, self.generating_from(tip)), self.own.teeth - 1)

    def default_tip(self, tip: float, *, given: bool) -> float:
        """Return a tip radius, limited by the cutters that exist; only by the cutter itself if it is `given`."""
        teeth = self.cutter.teeth if given else standard_teeth(self.own)
        least = self.involute_from(teeth)
        if least <= tip:
            return tip
        if not given:
            if self.generating_from(tip) <= self.clearing_up_to(tip):
                return tip
            least = self.deepest[1]
        # if no cutter can exist, the refusal of the shaper gives the reason
        return tip if math.isinf(least) else max(tip, least + TIP_MARGIN_MODULES * self.own.module)

    def possible(self, name: str, tip: float) -> str:
        """Return the tooth numbers, as text, that leave tips at a radius, or else the tips that can be cut."""
        low, high = self.generating_from(tip), self.clearing_up_to(tip)
        if low <= high:
            return f"allowed are {low} teeth" if low == high else f"allowed are {low} to {high} teeth"
        teeth, radius = self.deepest
        other = f"{name}.tip_diameter of at least {at_least(2.0 * radius)} mm with {teeth} teeth"
        few = f"fewer than {low} teeth leave no involute up to the tip diameter of {2.0 * tip:.7g} mm"
        if low >= self.own.teeth:
            few = f"no cutter generates involute up to the tip diameter of {2.0 * tip:.7g} mm"
        if tip >= self.own.largest_base_radius:
            other += f', or {name}.manufacture = "{FORMED_MANUFACTURE}", which needs no cutter'
        return f"{few}, more than {high} trim the tips; allowed is {other}"
