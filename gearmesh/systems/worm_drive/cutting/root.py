"""Dedendum and root rounding of a worm whose design leaves them open: those of DIN 3975, or less where flanks or spaces end sooner.

Towards its root a flank ends in a cusp, an involute on its base cylinder and what a disk grinds near it: a rounding of the radius R
needs the root cylinder within R below that. The steeper the threads, the farther from the axis it is.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.design import DEDENDUM, ROUNDING

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: parts of the usual dedendum and rounding that are tried, and the land between two roundings that is left at least, in axial
#: modules
DEDENDUM_SHARES, ROUNDING_SHARES, LEAST_LAND = np.linspace(1.0, 0.5, 13), np.linspace(1.0, 0.0, 11), 0.002


def open_root(design: WormDriveDesign) -> dict[str, float]:
    """Coefficients of dedendum and root rounding of a design with lengths in mm, by their dotted keys: the usual ones, or the
    largest dedendum, and for it the largest rounding, that the flanks reach and the space has room for; the usual ones where none
    is. What the design states is what it says.
    """
    usual = {"worm.dedendum": DEDENDUM, "worm.root_rounding": ROUNDING}
    stated = math.isfinite(design.worm.dedendum)
    for dedendum in (DEDENDUM * (DEDENDUM_SHARES[:1] if stated else DEDENDUM_SHARES)).round(6).tolist():
        if (rounding := _rounding(design.fill({"worm.dedendum": dedendum}))) is not None:
            return {"worm.dedendum": dedendum, "worm.root_rounding": rounding}
    return usual


def _rounding(design: WormDriveDesign) -> float | None:
    """Coefficient of the largest root rounding that suits a dedendum: `ROUNDING`, or a part of it that leaves those of both flanks
    of a space side by side; a stated one where flanks reach it. None where there is none."""
    stated, least = math.isfinite(design.worm.root_rounding), LEAST_LAND * design.axial_module
    largest, *smaller = [design.worm.root_rounding] if stated else (ROUNDING * ROUNDING_SHARES).round(6).tolist()
    land = _land(design, largest)
    # smaller ones are reached even less, and the smallest leaves most land
    if land is None or stated or land > least:
        return None if land is None else largest
    if (most := _land(design, smaller[-1])) is not None and most <= least:
        return None
    return next((rounding for rounding in smaller if (_land(design, rounding) or 0.0) > least), None)


def _land(design: WormDriveDesign, rounding: float) -> float | None:
    """Land (mm) that roundings of a coefficient leave between them at the narrowest; None where flanks do not reach them."""
    spec, m = design.worm, design.axial_module
    root = 0.5 * design.reference_diameter - spec.dedendum * m
    # of threads that grow thicker along the axis spaces are narrowest at one end
    narrower = abs(spec.dual_lead) * (0.5 * spec.length + spec.run_out)
    lands = []
    for thread in dict.fromkeys(worm_thread(design, side) for side in (1, -1)):
        try:
            # arcs end on the root under their centres
            lands.append(0.5 * thread.axial_pitch - narrower + thread.root_rounding(root, rounding * m).arc.centre[1])
        except DesignError:
            return None
    return min(lands)
