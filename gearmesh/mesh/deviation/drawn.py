"""A drawn link as a surface over (s, t), for the same measurements as on generated surfaces."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.mesh.patch import trim
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region
from gearmesh.teeth.tooth import Tooth

#: step of s and t in differences of a drawn link
DIFFERENCE_STEP = 1e-3


@dataclass(frozen=True)
class DrawnSurface:
    """A link whose points are known on sections alone, with parameters s and t; derivatives are central differences."""

    tooth: Tooth
    region: Region

    def jet(self, u: Array, v: Array) -> Jet:
        """Return the jet at s = u, t = v (N,): exact points; normals and derivatives of second order in the step."""
        s, t = (np.asarray(values, dtype=float).ravel() for values in (u, v))
        t = np.clip(t, 0.0, 1.0)
        middle = np.clip(t, DIFFERENCE_STEP, 1.0 - DIFFERENCE_STEP)
        places = [t, middle - DIFFERENCE_STEP, middle, middle + DIFFERENCE_STEP]
        sections = trim(self.tooth, np.concatenate(places))
        s_there = np.concatenate([s + k * DIFFERENCE_STEP for k in (-1, 0, 1)]).reshape(3, -1)
        grid = self.tooth.grid(self.region, np.tile(s_there, 4), sections)
        points = grid.points.reshape(3, 4, -1, 3)
        here, r = points[1, 0], points[:, 1:]
        r_s, r_t = 0.5 * (r[2, 1] - r[0, 1]) / DIFFERENCE_STEP, 0.5 * (r[1, 2] - r[1, 0]) / DIFFERENCE_STEP
        r_ss, r_tt = (
            (r[2, 1] - 2.0 * r[1, 1] + r[0, 1]) / DIFFERENCE_STEP**2,
            (r[1, 2] - 2.0 * r[1, 1] + r[1, 0]) / DIFFERENCE_STEP**2,
        )
        r_st = 0.25 * (r[2, 2] - r[2, 0] - r[0, 2] + r[0, 0]) / DIFFERENCE_STEP**2
        r_t = r_t + r_tt * (t - middle)[:, None]
        r_s = r_s + r_st * (t - middle)[:, None]
        area = cross(r_s, r_t)
        outward = grid.normals.reshape(3, 4, -1, 3)[1, 0]
        length = np.sqrt(dot(area, area))[:, None] * np.sign(dot(area, outward))[:, None]
        with np.errstate(invalid="ignore", divide="ignore"):
            n = area / length
            n_s, n_t = (
                (change - n * dot(n, change)[:, None]) / length
                for change in (cross(r_ss, r_t) + cross(r_s, r_st), cross(r_st, r_t) + cross(r_s, r_tt))
            )
        return Jet(here, n, r_s, r_t, n_s, n_t)
