r"""Internal gears that are not generated but broached, wire cut or moulded.

The tool has the profile of the spaces. This is the profile of the gear's external counterpart: as many teeth, involutes
of the same base circle, and roundings of the tips that touch involute and top circle. In the transverse section:

        |    space     |
         \  = tooth   /   involute, outside the base circle, inside of which no flank can be
          \  of the  /
           (  tool  )     arc of the given radius: the root fillet
            `------'      root circle

The tool is a `Shaper` that does not roll; a helical gear is its section, twisted along the axis. Drawings of broached
internal teeth have such fillets, too [DIN 5480, ANSI B92.1]. Without generating there are neither undercut nor trimmed
tips.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.design.keys import given_or
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.surface import PlacedSurface
from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.common.racks.ring_member import formed_surface
from gearmesh.systems.cylindrical.cutting.last_cut import FixedCut
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.teeth.region import Side
from gearmesh.tools.description import ToolDescription
from gearmesh.tools.profile import Profile
from gearmesh.tools.shaper import Shaper, ShaperFlank

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalMember


def counterpart(own: Toothing) -> Toothing:
    """Return the external teeth that fill the spaces of internal teeth."""
    shift = -own.shift - 0.5 * own.allowance / (own.module * math.tan(own.alpha))
    return replace(own, internal=False, shift=shift, allowance=0.0)


def form_tool(name: str, spec: CylindricalMember, own: Toothing, root: float) -> Shaper:
    """Return the tool of an internal gear with a root radius, in the transverse section and without rounding.

    Raises DesignError naming key, value and limit: teeth that leave no spaces, a root inside the base circle, or spaces
    that are pointed above it.
    """
    _check_spaces(name, spec, own)
    _check_root(name, spec, own, root)
    filling, *others = (counterpart(side) for side in own.sides)
    opposite = None
    if others:
        # the other half of the tool's tooth fills the other half of the space, by thickness in place of a shift
        (other,) = others
        thicker = 2.0 * other.module * (other.shift - filling.shift) * math.tan(other.alpha_t)
        opposite = ShaperFlank(other.alpha_t, thicker)
    return Shaper(
        teeth=filling.teeth,
        module=filling.transverse_module,
        pressure_angle=filling.alpha_t,
        addendum=root - filling.radius,
        profile_shift=filling.shift * math.cos(filling.beta),
        opposite=opposite,
    )


def _check_spaces(name: str, spec: CylindricalMember, own: Toothing) -> None:
    """Refuse teeth so thick that they leave no spaces."""
    over = own.thickness - math.pi * own.module
    if over < 0.0:
        return
    given = spec.thickness_allowance
    by_shift = own.shift - over / (own.module * own.both_tangents)
    raise DesignError(
        f"{name}.profile_shift" if given is None else f"{name}.thickness_allowance.upper",
        own.shift if given is None else given.upper,
        unit="" if given is None else "mm",
        reason="leaves no spaces between the teeth",
        allowed=Allowed.less_than(by_shift) if given is None else Allowed.less_than(given.upper - over, "mm"),
    )


def _check_root(name: str, spec: CylindricalMember, own: Toothing, root: float) -> None:
    """Refuse a root inside the base circle, or beyond the point where the spaces are pointed."""
    half_pitch = math.pi / own.teeth

    def open_at(radius: float) -> bool:
        return own.half_angle(radius) < half_pitch

    base = own.largest_base_radius
    if root > base and open_at(root):
        return
    by_diameter = spec.root_diameter is not None
    bounds = [base]
    if root > base:
        most, _ = last_true(lambda r, _: np.array([open_at(float(x)) for x in r]), np.array([base]), np.array([root]))
        bounds = [float(most[0])]
    values = [2.0 * r if by_diameter else (r - own.radius) / own.module + own.shift for r in bounds]
    deep = root > base
    raise DesignError(
        f"{name}.{'root_diameter' if by_diameter else 'dedendum'}",
        spec.root_diameter if by_diameter else given_or(spec.dedendum, math.nan),
        unit="mm" if by_diameter else "",
        reason="the spaces are pointed before the root" if deep else "the root is inside the base circle",
        allowed=Allowed.less_than(values[0]) if deep else Allowed.more_than(values[0]),
    )


@dataclass(frozen=True)
class Forming(FixedCut):
    """A form tool in the spaces of an internal gear, and its tip radius (mm)."""

    tip: float

    def section(self, profile: Profile, which: Side, twist: float = 0.0) -> PlacedSurface:
        """Return the surface that a profile of the tool leaves on one side of the tooth.

        `twist`: twist (rad/mm) of the tool for helical teeth; 0 gives the transverse section of spur teeth.
        """
        return formed_surface(self.shaper, profile, which, twist)

    @property
    def description(self) -> ToolDescription:
        return replace(self.shaper.description, name="form tool")

    def refuse_tip(self, name: str, spec: CylindricalMember, tip_key: str) -> None:
        """Refuse a tip inside the base circle, where there is no involute."""
        base = self.own.base_radius
        if self.tip < base:
            raise DesignError(
                f"{name}.{tip_key}",
                spec.tip_diameter if spec.tip_diameter is not None else spec.addendum,
                reason="the involute ends on the base circle, before the tip",
                allowed=f"a tip diameter of at least {at_least(2.0 * base)} mm, instead of {2.0 * self.tip:.7g} mm",
            )
