"""The blank: the levels that limit the teeth, and the gear body."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.errors import KindError
from gearmesh.kernel.surface.levels import LandLevel, Level
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.end_edge import SHARP_ENDS, EndChamfers
from gearmesh.teeth.region import HEEL_END, TOE_END

#: largest distance of the ends of the body's profile from their end faces, as a share of the largest coordinate
MAX_PROFILE_MISS_SHARE = 1e-8


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

    def __post_init__(self) -> None:
        """Raise KindError if the profile of the body does not begin and end on the end faces of the teeth.

        Chamfers do not move the end faces: the blank without them is compared.
        """
        if self.ends != SHARP_ENDS:
            return
        ends = self.body.profile[0], self.body.profile[-1]
        for end, station, found, (rho, z) in zip((TOE_END, HEEL_END), self.extent, self._body_ends, ends, strict=True):
            miss = found - station
            # NaN is refused, too
            if not abs(miss) <= MAX_PROFILE_MISS_SHARE * max(abs(rho), abs(z), abs(station)):
                raise KindError(
                    f"body profile at the {end}",
                    reason=f"(rho, z) = ({rho:.6g}, {z:.6g}) mm is {abs(miss):.3g} mm from the end face",
                    must_be=f"a point of the station {station:.6g} mm",
                )

    @property
    def faces(self) -> tuple[float, float]:
        """Station coordinates (mm) of the end faces at toe and heel."""
        if self.ends == SHARP_ENDS:
            return self.extent
        (toe, heel), (first, last) = self.extent, (0.0 if end is None else end.depth for end in self.ends)
        # the body says which end is which: chamfers that are tried may be deeper than the face
        begins, ends = self._body_ends
        return (toe - first, heel + last) if ends > begins else (toe + first, heel - last)

    @property
    def _body_ends(self) -> tuple[float, float]:
        """Station coordinates (mm) of the ends of the body's profile."""
        toe, heel = (
            float(self.axial.value(np.array([rho, 0.0, z]))) for rho, z in (self.body.profile[0], self.body.profile[-1])
        )
        return toe, heel

    @property
    def sharp(self) -> Blank:
        """The blank without end chamfers: its teeth go on to the end faces."""
        return self if self.ends == SHARP_ENDS else replace(self, extent=self.faces, ends=SHARP_ENDS)

    def with_ends(self, ends: EndChamfers) -> Blank:
        """Return the blank with chamfers at its end faces at toe and heel, which do not move; None for a sharp edge."""
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
