"""Where points in space lie on a flank: their foot points along its normals, and how far from it they are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: lines of the lattice from whose nearest point a search begins, across and along the flank
LATTICE = (17, 33)
#: the same for every turn of a thread
PER_TURN = 48
#: points that are projected together: the memory that they take is bounded
BATCH = 20_000


@dataclass(frozen=True)
class FootPoints:
    """Points (N, 3) on a flank: shares `s`, `t` (N,) of the way from form point to tip and from toe to heel, points and unit
    normals (N, 3), and `distances` (N,), mm, of what was projected, positive outside the material. NaN where there are none."""

    s: Array
    t: Array
    points: Array
    normals: Array
    distances: Array


class FlankProjection:
    """Projects points on the flank of one side of a tooth, which may be longer than where it ends."""

    def __init__(self, tooth: Tooth, side: Side) -> None:
        from scipy.spatial import cKDTree

        self.tooth, self.side = tooth, side
        wound = int(np.ceil(PER_TURN * tooth.windings))
        self._t = np.linspace(0.0, 1.0, max(LATTICE[1], wound))
        self._grid = tooth.flank_grid(side, np.linspace(0.0, 1.0, LATTICE[0]), self._t)
        self._tree = cKDTree(self._grid.points.reshape(-1, 3))
        ends = tooth.ends(side, self._t)
        self._form, self._tip = ends.form_point_flank, ends.tip

    def near_distance(self, points: Array) -> float:
        """Median distance (mm) of points (N, 3) from the nearest point of a coarse lattice: how far from the flank they may be."""
        return float(np.median(self._tree.query(points)[0]))

    def foot_points(self, points: Array) -> FootPoints:
        """Of points (N, 3), mm, the tooth's own frame."""
        batches = [self._foot_points(points[k : k + BATCH]) for k in range(0, len(points), BATCH)]
        columns = ([getattr(batch, name) for batch in batches] for name in FootPoints.__dataclass_fields__)
        return FootPoints(*(np.concatenate(column) for column in columns))

    def _foot_points(self, points: Array) -> FootPoints:
        start = self._grid.parameters.reshape(-1, 2)[self._tree.query(points)[1]]
        foot = nearest(self.tooth.side(self.side).flank, points, start[:, 0], start[:, 1])
        jet: Jet = foot.jet
        axial, (toe, heel) = self.tooth.blank.axial, self.tooth.blank.extent
        t = (axial.value(jet.r) - toe) / (heel - toe)
        form, tip = (np.interp(t, self._t, ends) for ends in (self._form, self._tip))
        lost = ~foot.converged
        s = (foot.values[:, 0] - form) / (tip - form)
        distances = dot(points - jet.r, jet.n)
        for values in (s, t, distances):
            values[lost] = np.nan
        return FootPoints(s, t, jet.r, jet.n, distances)
