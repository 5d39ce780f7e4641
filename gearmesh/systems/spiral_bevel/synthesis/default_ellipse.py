"""Contact ellipse of a pair whose design leaves its length open."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: largest difference of curvatures along the default ellipse, in 1/module
MAX_ELLIPSE_CURVATURE = 0.025


def default_semi_major_axis(design: FaceMilledDesign, blank: BevelBlank) -> float:
    """Return a quarter of the face width (mm), or more on a narrow face, where flanks cannot separate within it."""
    return max(
        0.25 * blank.gear.face_width,
        float(np.sqrt(2.0 * design.contact.delta * design.given_module / MAX_ELLIPSE_CURVATURE)),
    )
