"""Basic racks of involute splines: proportions of shaft and hub in modules, and what follows from them.

All heights count from the pitch plane that the profile shift x moves; the hub has the shift -x. With h the addendum and
d = m z the tips are d + 2 m (x + h) of the shaft and d + 2 m (x - h) of the hub; roots with the dedendum likewise.
"""

from __future__ import annotations

import math

from gearmesh.records import dataclass

#: profile of a design that names none
DEFAULT_PROFILE = "DIN 5480"
#: form clearance of ISO 4156, modules
ISO_FORM_CLEARANCE = 0.1
#: diametral pitch from which on fillet roots of 30 deg of ANSI B92.1 are deeper
FINE_PITCH = 16.0
#: reference diameter less pitch diameter and twice the shift, modules [DIN 5480-1]
REFERENCE_MODULES = 1.1
#: range of profile shifts of DIN 5480-1
DIN_SHIFTS = (-0.05, 0.45)


@dataclass(frozen=True)
class SplineProfile:
    """Basic rack of a spline: heights and roundings in modules."""

    #: pressure angle, deg
    pressure_angle: float
    #: addendum, dedendum and tip rounding of the shaft's tool
    shaft: tuple[float, float, float]
    #: addendum, dedendum and root fillet of the hub; an addendum of NaN ends at the shaft's form diameter and form clearance
    hub: tuple[float, float, float]
    #: depth h_s of the shaft's form diameter under the pitch plane [ISO 4156]
    form_depth: float = math.nan
    #: space width of the hub beyond half a pitch
    wider_space: float = 0.0
    #: dedendum of shafts of a diametral pitch from FINE_PITCH on
    fine_dedendum: float = math.nan

    def hub_addendum(self, teeth: int) -> float:
        """Return the addendum of the hub, modules, for a number of teeth."""
        addendum = self.hub[0]
        if not math.isnan(addendum):
            return addendum
        return 0.5 * teeth - self.form_radius(teeth) - ISO_FORM_CLEARANCE

    def form_radius(self, teeth: int) -> float:
        """Return the largest radius of the shaft's form diameter, modules [ISO 4156]; NaN for other standards."""
        if math.isnan(self.form_depth):
            return math.nan
        alpha = math.radians(self.pressure_angle)
        roll = max(0.0, 0.5 * teeth * math.sin(alpha) - self.form_depth / math.sin(alpha))
        return math.hypot(0.5 * teeth * math.cos(alpha), roll)


_BY_FORM = math.nan

#: basic racks by name
SPLINE_PROFILES = {
    "DIN 5480": SplineProfile(30.0, (0.45, 0.60, 0.16), (0.45, 0.55, 0.16)),
    "ISO 4156 30 flat": SplineProfile(30.0, (0.5, 0.75, 0.2), (_BY_FORM, 0.75, 0.2), 0.6),
    "ISO 4156 30 fillet": SplineProfile(30.0, (0.5, 0.9, 0.4), (_BY_FORM, 0.9, 0.4), 0.6),
    "ISO 4156 37.5 fillet": SplineProfile(37.5, (0.45, 0.7, 0.3), (_BY_FORM, 0.7, 0.3), 0.55),
    "ISO 4156 45 fillet": SplineProfile(45.0, (0.4, 0.6, 0.25), (_BY_FORM, 0.6, 0.25), 0.5),
    "ANSI B92.1 30 flat": SplineProfile(30.0, (0.5, 0.675, 0.2), (0.5, 0.675, 0.2)),
    "ANSI B92.1 30 fillet": SplineProfile(30.0, (0.5, 0.9, 0.4), (0.5, 0.9, 0.4), fine_dedendum=1.0),
    "ANSI B92.1 37.5 fillet": SplineProfile(37.5, (0.5, 0.65, 0.3), (0.4, 0.8, 0.3), wider_space=0.1),
    "ANSI B92.1 45 fillet": SplineProfile(45.0, (0.5, 0.5, 0.25), (0.3, 0.7, 0.25), wider_space=0.1),
}
