"""The blank: what limits the teeth."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearmesh.kernel.surface.levels import LandLevel, Level
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.end_edge import SHARP, EndChamfers


@dataclass(frozen=True)
class Blank:
    """What limits the teeth. `axial` is the station coordinate, from `extent[0]` (toe) to `extent[1]` (heel), mm.

    A station is a plane, cone or cylinder about z; the coordinate is the distance between stations. `tip` and `root` are
    the levels of the lands; `body` is the gear body under the teeth. With chamfers at the `ends` the extent is that between them,
    and the body still that between the end faces.
    """

    axial: Level
    extent: tuple[float, float]
    tip: LandLevel
    root: LandLevel
    body: Body
    ends: EndChamfers = SHARP

    @property
    def faces(self) -> tuple[float, float]:
        """Station coordinates (mm) of the end faces at toe and heel."""
        (toe, heel), (first, last) = self.extent, (0.0 if end is None else end.depth for end in self.ends)
        return (toe - first, heel + last) if heel > toe else (toe + first, heel - last)

    @property
    def sharp(self) -> Blank:
        """The blank whose teeth go on to the end faces."""
        return self if self.ends == SHARP else replace(self, extent=self.faces, ends=SHARP)

    def with_ends(self, ends: EndChamfers) -> Blank:
        """The blank with chamfers at its end faces, which stay where they are.

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
        """The coordinate (mm) at right angles to the station's, along a section from root to tip or back."""
        return self.tip.across(self.axial)

    @property
    def corners(self) -> tuple[float, ...]:
        """Station coordinates (mm) where lands or roots have corners along the face."""
        return *self.tip.corners(self.axial), *self.root.corners(self.axial)
