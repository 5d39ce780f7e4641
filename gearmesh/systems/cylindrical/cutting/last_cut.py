"""A tool with the profile of a shaper cutter over a member at the last cut, in closed form."""

from __future__ import annotations

import math
from dataclasses import replace

from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass
from gearmesh.systems.common.defaults import deepest
from gearmesh.systems.common.racks.ring_member import tool_surface
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.tools.profile import Profile
from gearmesh.tools.shaper import Shaper


@dataclass(frozen=True)
class LastCut:
    """A tool in the transverse section, the teeth that it cuts, and their root radius (mm)."""

    shaper: Shaper
    own: Toothing
    root: float

    @property
    def distance(self) -> float:
        """Distance (mm) of the axes of tool and member."""
        return self.root + self.own.sense * self.shaper.top_radius

    @property
    def generator(self) -> float:
        """Length (mm) of the line of action between the base circles."""
        between = self.own.base_radius + self.own.sense * self.shaper.base_radius
        return math.sqrt(self.distance**2 - between**2)

    @property
    def form_roll_length(self) -> float:
        """Roll length (mm) of the member's root form point, which the end of the tool's involute cuts."""
        return float(self.generator - self.own.sense * self.shaper.form_point[0] * self.shaper.base_radius)

    @property
    def tool_twist(self) -> float:
        """Twist (rad/mm) of the helical tool of a helical member: both rotate with the stroke as they roll."""
        return -self.own.sense * self.own.twist * self.own.teeth / self.shaper.teeth

    def tool(self, profile: Profile, side: int, twist: float) -> Surface:
        """Return the surface of one side of the tool for a profile, in the tool's frame (see `tools.shaper`).

        `twist`: twist (rad/mm) of the section about the tool's axis.
        """
        return tool_surface(self.shaper, profile, side, twist)

    def theta(self, radius: float) -> float:
        """Return the parameter theta_s (rad) of the tool's involute that cuts a radius (mm) of the member."""
        length = self.own.roll_length(radius) - self.generator
        return -self.own.sense * length / self.shaper.base_radius

    def largest_rounding(self, reached: float, most: float) -> float:
        """Return the largest rounding (mm) of the tool that leaves involute from the roll length `reached` on.

        The rounding is at most `most`; it is `most` if no rounding leaves involute.
        """

        def leaves(radius: float) -> bool:
            rounded = replace(self, shaper=replace(self.shaper, tip_radius=radius))
            return self.own.sense * (reached - rounded.form_roll_length) >= 0.0

        return deepest(leaves, 0.0, most)


@dataclass(frozen=True)
class FixedCut(LastCut):
    """A tool that fills the member's spaces: as many teeth on the same axis, with the same base circle."""

    @property
    def distance(self) -> float:
        return 0.0

    @property
    def generator(self) -> float:
        return 0.0

    @property
    def tool_twist(self) -> float:
        return self.own.twist
