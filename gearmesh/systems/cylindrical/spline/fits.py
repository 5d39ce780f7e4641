"""Limits of tooth thickness and space width of a spline, actual and effective, and the clearance between them [ISO 4156-1].

Deviations of pitch, profile and helix let a shaft act thicker, and a hub narrower, by the effective variation lambda:
S_v = s + lambda, E_v = e - lambda.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.geometry.allowances import allowances_of
from gearmesh.systems.cylindrical.spline.build import effective_variation
from gearmesh.systems.cylindrical.spline.design import HUB_NAME, MEMBER_NAMES, SplineDesign

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions, GearsProportions


@dataclass(frozen=True)
class SplineLimits:
    """Tooth thickness of the shaft or space width of the hub, on the reference circle, mm."""

    #: without allowance
    nominal: float
    #: at the maximum of material
    most: float
    #: at the minimum of material
    least: float
    #: of the teeth as built
    made: float
    #: effective variation
    variation: float
    #: +1 for a thickness, -1 for a space width
    sense: int

    @property
    def tolerance(self) -> float:
        """Tolerance of the actual size."""
        return abs(self.most - self.least)

    @property
    def effective_most(self) -> float:
        """Effective size at the maximum of material."""
        return self.most + self.sense * self.variation

    @property
    def effective_least(self) -> float:
        """Effective size at the minimum of material."""
        return self.least + self.sense * self.variation


@dataclass(frozen=True)
class SplineFit:
    """Thickness and space width, and the circumferential clearance between them, mm on the reference circle."""

    #: tooth thickness of the shaft
    shaft: SplineLimits
    #: space width of the hub
    hub: SplineLimits
    #: reference radius, mm
    radius: float
    #: base radius, mm
    base_radius: float

    @property
    def effective_least(self) -> float:
        """Least effective clearance c_v."""
        return self.hub.effective_most - self.shaft.effective_most

    @property
    def effective_largest(self) -> float:
        """Largest effective clearance c_v."""
        return self.hub.effective_least - self.shaft.effective_least

    @property
    def made(self) -> float:
        """Clearance of the teeth as built, without deviations."""
        return self.hub.made - self.shaft.made


def fit_of(design: SplineDesign, gears: GearsProportions) -> SplineFit:
    """Return the limits of a complete design in mm and the clearance between them."""
    shaft, hub = (_limits(design, name, gear) for name, gear in zip(MEMBER_NAMES, gears.gears, strict=True))
    own = gears.gears[0].own
    return SplineFit(shaft, hub, own.radius, own.base_radius)


def _limits(design: SplineDesign, name: str, gear: GearProportions) -> SplineLimits:
    """Return the limits of a member."""
    own, inside, given = gear.own, name == HUB_NAME, allowances_of(gear.name, gear.spec, gear.own)
    assert given is not None

    def size(allowance: float) -> float:
        """Return the thickness of a tooth with an allowance, or the width that it leaves of the pitch."""
        thickness = own.thickness - own.allowance + allowance
        return math.pi * own.module - thickness if inside else thickness

    return SplineLimits(
        nominal=size(0.0),
        most=size(given.upper),
        least=size(given.lower),
        made=size(own.allowance),
        variation=effective_variation(design, name),
        sense=-1 if inside else 1,
    )
