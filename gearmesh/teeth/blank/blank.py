"""The blank: the levels that limit the teeth, and the gear body."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearmesh.kernel.surface.levels import LandLevel, Level
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.end_edge import SHARP_ENDS, EndChamfers


@dataclass(frozen=True)
class Blank:
    """Levels that limit the teeth, and the gear body under them.

    A station is a plane, cone or cylinder about z; its coordinate is the distance between stations.
    """

    #: station coordinate of a point, mm
    axial: Level
    #: station coordinates (mm) of toe and heel; with end chamfers, of the face between them
    extent: tuple[float, float]
    #: level of the top lands
    tip: LandLevel
    #: level of the root lands
    root: LandLevel
    #: gear body between the end faces
    body: Body
    #: chamfers at toe and heel, None for a sharp end
    ends: EndChamfers = SHARP_ENDS

    @property
    def faces(self) -> tuple[float, float]:
        """Station coordinates (mm) of the end faces at toe and heel."""
        (toe, heel), (first, last) = self.extent, (0.0 if end is None else end.depth for end in self.ends)
        return (toe - first, heel + last) if heel > toe else (toe + first, heel - last)

    @property
    def sharp(self) -> Blank:
        """The blank without end chamfers: its teeth go on to the end faces."""
        return self if self.ends == SHARP_ENDS else replace(self, extent=self.faces, ends=SHARP_ENDS)

    def with_ends(self, ends: EndChamfers) -> Blank:
        """Return the blank with chamfers at its end faces, which do not move.

        Parameters
        ----------
        ends : tuple of EndChamfer or None
            At toe and heel; None for a sharp edge.

        Returns
        -------
        Blank

        Examples
        --------
        >>> blank = gears.members["pinion"].tooth.blank
        >>> broken = blank.with_ends((gm.EndChamfer(0.5, 0.5), None))
        >>> round(broken.extent[0] - blank.extent[0], 9)
        0.5
        """
        (toe, heel), (first, last) = self.faces, (0.0 if end is None else end.depth for end in ends)
        extent = (toe + first, heel - last) if heel > toe else (toe - first, heel + last)
        return replace(self, extent=extent, ends=ends)

    @property
    def across(self) -> Level:
        """Coordinate (mm) at right angles to the station coordinate, along a section from root to tip or back."""
        return self.tip.across(self.axial)

    @property
    def corners(self) -> tuple[float, ...]:
        """Station coordinates (mm) where lands or roots have corners along the face."""
        return *self.tip.corners(self.axial), *self.root.corners(self.axial)
