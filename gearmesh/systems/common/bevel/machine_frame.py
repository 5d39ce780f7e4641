"""Frame of a cradle machine at the blank of a bevel gear."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array


def own_axes(root_angle: float) -> Array:
    """Return the axes of the machine frame in the member's frame as columns (3, 3).

    x is along the machine root line from the apex to the heel, z along the cradle axis into the blank.

    `root_angle`: angle between the machine plane and the member's axis, rad.
    """
    c, s = np.cos(root_angle), np.sin(root_angle)
    return np.array([[s, 0.0, -c], [0.0, 1.0, 0.0], [c, 0.0, s]])
