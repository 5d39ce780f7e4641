"""A drawn link as a surface over (s, t), so that distances from it are measured as from those that tools generate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.mesh.patch import trim
from gearmesh.teeth.region import Region
from gearmesh.teeth.tooth import Tooth

#: step of s and t over which a drawn link is differentiated
STEP = 1e-3


@dataclass(frozen=True)
class DrawnSurface:
    """A link that has points in the sections alone: parameters s and t; derivatives are central differences over STEP."""

    tooth: Tooth
    region: Region

    def jet(self, u: Array, v: Array) -> Jet:
        """Points are exact; normals and derivatives are of second order in STEP."""
        s, t = (np.asarray(given, dtype=float).ravel() for given in (u, v))
        t = np.clip(t, 0.0, 1.0)
        middle = np.clip(t, STEP, 1.0 - STEP)
        places = [t, middle - STEP, middle, middle + STEP]
        sections = trim(self.tooth, np.concatenate(places))
        s_there = np.concatenate([s + k * STEP for k in (-1, 0, 1)]).reshape(3, -1)
        grid = self.tooth.grid(self.region, np.tile(s_there, 4), sections)
        points = grid.points.reshape(3, 4, -1, 3)
        here, r = points[1, 0], points[:, 1:]
        r_s, r_t = 0.5 * (r[2, 1] - r[0, 1]) / STEP, 0.5 * (r[1, 2] - r[1, 0]) / STEP
        r_ss, r_tt = (r[2, 1] - 2.0 * r[1, 1] + r[0, 1]) / STEP**2, (r[1, 2] - 2.0 * r[1, 1] + r[1, 0]) / STEP**2
        r_st = 0.25 * (r[2, 2] - r[2, 0] - r[0, 2] + r[0, 0]) / STEP**2
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
