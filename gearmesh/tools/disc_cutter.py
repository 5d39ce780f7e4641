r"""Disc cutters of straight bevel gears: cutting edges on a dished disc that plunges into one side of a space.

Disc frame: z along the disc's axis, into the tooth that it cuts. The profile is a curve (x, y) of `tools.rack`, turned
about the axis as an inside blade of a head cutter: x is the height over the rim's plane out of the tooth, y is minus the
radius. A disc without dish angle has its edges in a plane.

          axis |
               |        . edge: the dish angle leans it out of the rim's plane
               |   .  '
               +-------( ------ rim's plane        tip rounding and land at the rim
               |<- r ->|
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.records import dataclass
from gearmesh.tools.description import Dimension
from gearmesh.tools.head_cutter import INSIDE_BLADE, Revolved
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, RackLine


@dataclass(frozen=True)
class DiscBlade:
    """Straight cutting edge of a disc, with a rounded tip."""

    #: radius of the disc (mm) where the prolonged edge meets the land
    radius: float
    #: angle (rad) between the edge and the rim's plane
    dish_angle: float
    #: angle (rad) between the edge and the direction across the land: the pressure angle of the tool's tooth
    profile_angle: float
    #: rounding of the tip, mm
    edge_radius: float

    @cached_property
    def flank(self) -> RackLine:
        """Profile of the cutting edge; p is the distance from the land."""
        return RackLine(0.5 * np.pi - self.dish_angle, 0.0, self.radius)

    @cached_property
    def tip(self) -> Arc:
        """Profile of the tip rounding, up to the land at `root`."""
        point, _, normal, _ = self.flank.section(np.array(self.form_point[0]))
        centre = point + self.edge_radius * normal
        return Arc((float(centre[0]), float(centre[1])), -self.edge_radius)

    @property
    def form_point(self) -> tuple[float, float]:
        """Parameters of edge and tip rounding where they join."""
        turned = 0.5 * np.pi - self.profile_angle
        return float(self.edge_radius * np.tan(0.5 * turned)), self.flank.alpha

    @property
    def root(self) -> float:
        """Parameter of the tip rounding where the land begins."""
        return float(np.pi - self.profile_angle - self.dish_angle)

    def surface(self, profile: Profile, angle: float) -> Revolved:
        """Return the surface of revolution of a profile; v counts from an `angle` (rad) about the axis."""
        return Revolved(profile, INSIDE_BLADE, angle)

    @property
    def dimensions(self) -> tuple[Dimension, ...]:
        """Dimensions of the disc."""
        return (
            Dimension("radius", self.radius, "mm", "r_c0"),
            Dimension("dish angle", float(np.degrees(self.dish_angle)), "deg"),
            Dimension("pressure angle", float(np.degrees(self.profile_angle)), "deg", "alpha_0"),
            Dimension("tip radius", self.edge_radius, "mm", "rho_a0"),
        )
