"""The blank: what limits the teeth."""

from __future__ import annotations

from dataclasses import dataclass

from gearmesh.kernel.surface.barrel import Barrel
from gearmesh.kernel.surface.flat import FlatLevel
from gearmesh.kernel.surface.levels import ConeLevel, CurveLevel, Level
from gearmesh.teeth.blank.body import Body


@dataclass(frozen=True)
class Blank:
    """What limits the teeth. `axial` is the station coordinate, from `extent[0]` (toe) to `extent[1]` (heel), mm.

    A station is a plane, cone or cylinder about z; the coordinate is the distance between stations. `tip` and `root` are
    the levels of the lands; `body` is the gear body under the teeth.
    """

    axial: Level
    extent: tuple[float, float]
    tip: ConeLevel | Barrel | FlatLevel
    root: ConeLevel | Barrel | FlatLevel
    body: Body

    @property
    def tip_cone(self) -> ConeLevel | FlatLevel:
        """The tip of a gear: a cone, cylinder or plane. Tools alone have barrels."""
        assert not isinstance(self.tip, Barrel)
        return self.tip

    @property
    def across(self) -> Level:
        """The coordinate (mm) at right angles to the station's, along a section from root to tip or back."""
        if isinstance(self.tip, FlatLevel):
            return FlatLevel(0.0, self.tip.joint)
        return CurveLevel.across_stations(self.axial)
