"""Dimensions on which the flank tolerances of a cylindrical gear depend [ISO 1328-1:2013]."""

from __future__ import annotations

from gearmesh.metrology.iso1328 import CylindricalSizes
from gearmesh.systems.cylindrical.geometry.geometry import Toothing


def tolerance_sizes(teeth: Toothing, width: float) -> CylindricalSizes:
    """Return the dimensions of teeth with a face `width` (mm) that enter the tolerances."""
    return CylindricalSizes(teeth.teeth, teeth.module, 2.0 * teeth.radius, width, teeth.beta)
