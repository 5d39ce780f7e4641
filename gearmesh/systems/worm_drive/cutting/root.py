"""Default dedendum and root rounding of a worm: those of DIN 3975, or less where flanks or spaces end sooner.

Towards its root a flank ends in a cusp: an involute on its base cylinder, a ground flank near it. A rounding of the
radius R needs the root cylinder within R below the cusp. For steeper threads the cusp is farther from the axis.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.design import DEDENDUM_MODULES, ROUNDING_MODULES

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: dedenda that are tried, over the usual dedendum
DEDENDUM_SHARES = np.linspace(1.0, 0.5, 13)
#: roundings that are tried, over the usual rounding
ROUNDING_SHARES = np.linspace(1.0, 0.0, 11)
#: least land between two roundings, in axial modules
MIN_LAND_MODULES = 0.002


def open_root(design: WormDriveDesign) -> dict[str, float]:
    """Return the coefficients of dedendum and root rounding of a design with lengths in mm, by dotted key.

    They are the usual values, or the largest dedendum, and for it the largest rounding, that the flanks reach and the
    space has room for. If there are none, they are the usual values. Values that the design states are kept.
    """
    usual = {"worm.dedendum": DEDENDUM_MODULES, "worm.root_rounding": ROUNDING_MODULES}
    stated = math.isfinite(design.worm.dedendum)
    for dedendum in (DEDENDUM_MODULES * (DEDENDUM_SHARES[:1] if stated else DEDENDUM_SHARES)).round(6).tolist():
        if (rounding := _rounding(design.fill({"worm.dedendum": dedendum}))) is not None:
            return {"worm.dedendum": dedendum, "worm.root_rounding": rounding}
    return usual


def _rounding(design: WormDriveDesign) -> float | None:
    """Return the coefficient of the largest root rounding for a dedendum, or None if there is none.

    It is ROUNDING_MODULES, or a share of it with which the roundings of both flanks of a space do not overlap, or a
    stated value that the flanks reach.
    """
    stated, least = math.isfinite(design.worm.root_rounding), MIN_LAND_MODULES * design.axial_module
    largest, *smaller = (
        [design.worm.root_rounding] if stated else (ROUNDING_MODULES * ROUNDING_SHARES).round(6).tolist()
    )
    land = _land(design, largest)
    # flanks that do not reach a rounding do not reach smaller ones either; the smallest rounding leaves the most land
    if land is None or stated or land > least:
        return None if land is None else largest
    if (most := _land(design, smaller[-1])) is not None and most <= least:
        return None
    return next((rounding for rounding in smaller if (_land(design, rounding) or 0.0) > least), None)


def _land(design: WormDriveDesign, rounding: float) -> float | None:
    """Return the least land (mm) between two roundings of a coefficient, or None if flanks do not reach them."""
    spec, m = design.worm, design.axial_module
    root = 0.5 * design.reference_diameter - spec.dedendum * m
    # spaces between dual-lead threads are narrowest at one end
    narrower = abs(spec.dual_lead) * (0.5 * spec.length + spec.run_out)
    lands = []
    for thread in dict.fromkeys(worm_thread(design, side) for side in (1, -1)):
        try:
            # an arc ends on the root below its centre
            lands.append(0.5 * thread.axial_pitch - narrower + thread.root_rounding(root, rounding * m).arc.centre[1])
        except DesignError:
            return None
    return min(lands)
