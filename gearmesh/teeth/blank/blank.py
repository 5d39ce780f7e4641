"""The blank: what limits the teeth."""

from __future__ import annotations

from dataclasses import dataclass

from gearmesh.kernel.surface.levels import LandLevel, Level
from gearmesh.teeth.blank.body import Body


@dataclass(frozen=True)
class Blank:
    """What limits the teeth. `axial` is the station coordinate, from `extent[0]` (toe) to `extent[1]` (heel), mm.

    A station is a plane, cone or cylinder about z; the coordinate is the distance between stations. `tip` and `root` are
    the levels of the lands; `body` is the gear body under the teeth.
    """

    axial: Level
    extent: tuple[float, float]
    tip: LandLevel
    root: LandLevel
    body: Body

    @property
    def across(self) -> Level:
        """The coordinate (mm) at right angles to the station's, along a section from root to tip or back."""
        return self.tip.across(self.axial)

    @property
    def corners(self) -> tuple[float, ...]:
        """Station coordinates (mm) where lands or roots have corners along the face."""
        return *self.tip.corners(self.axial), *self.root.corners(self.axial)
