"""Dedendum and root rounding of a worm whose design leaves them open: those of DIN 3975, or less where flanks or spaces end sooner.

Towards its root a flank ends in a cusp, an involute on its base cylinder and what a disk grinds near it: a rounding of the radius R
needs the root cylinder within R below that. The steeper the threads, the farther from the axis it is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.worm_drive.build import root_rounding, worm_thread
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
        own = design.fill({"worm.dedendum": dedendum})
        if (rounding := next(_roundings(own), None)) is not None:
            return {"worm.dedendum": dedendum, "worm.root_rounding": rounding}
    return usual


def _roundings(design: WormDriveDesign) -> Iterator[float]:
    """Coefficients of root roundings that suit a dedendum, the largest first: `ROUNDING`, or parts of it that leave those of both
    flanks of a space side by side; of a stated one whether flanks reach it."""
    spec, m = design.worm, design.axial_module
    # of threads that grow thicker along the axis spaces are narrowest at one end
    narrower = abs(spec.dual_lead) * (0.5 * spec.length + spec.run_out)
    stated = math.isfinite(spec.root_rounding)
    rounding: float
    for rounding in [spec.root_rounding] if stated else (ROUNDING * ROUNDING_SHARES).round(6).tolist():
        own = design.fill({"worm.root_rounding": rounding})
        try:
            sides = [(worm_thread(own, side).axial_pitch, root_rounding(own, side)) for side in (1, -1)]
        except DesignError:
            # smaller ones even less
            return
        # arcs end on the root under their centres
        if stated or all(0.5 * pitch - narrower + own.arc.centre[1] > LEAST_LAND * m for pitch, own in sides):
            yield rounding
