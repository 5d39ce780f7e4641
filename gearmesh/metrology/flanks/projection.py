"""Projection of points on a flank: foot points along its normals, and distances from the flank."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: lines, across and along the flank, of the lattice whose nearest point starts the search
LATTICE_LINES = (17, 33)
#: lines along a thread, for every turn
LATTICE_LINES_PER_TURN = 48
#: points that are projected at once: limits memory
POINTS_PER_BATCH = 20_000


@dataclass(frozen=True)
class FootPoints:
    """Foot points of N points on a flank; NaN where there is none."""

    #: shares (N,) from form point to tip
    s: Array
    #: shares (N,) from toe to heel
    t: Array
    #: foot points (N, 3), mm
    points: Array
    #: unit normals (N, 3) there
    normals: Array
    #: distances (N,), mm, of the projected points from the flank, positive outside the material
    distances: Array


class FlankProjection:
    """Projects points on the flank of one side of a tooth; its surface may continue beyond the ends of the flank."""

    def __init__(self, tooth: Tooth, side: Side) -> None:
        from scipy.spatial import cKDTree

        self.tooth, self.side = tooth, side
        lines_of_thread = int(np.ceil(LATTICE_LINES_PER_TURN * tooth.windings))
        self._t = np.linspace(0.0, 1.0, max(LATTICE_LINES[1], lines_of_thread))
        self._grid = tooth.flank_grid(side, np.linspace(0.0, 1.0, LATTICE_LINES[0]), self._t)
        self._tree = cKDTree(self._grid.points.reshape(-1, 3))
        ends = tooth.ends(side, self._t)
        self._form, self._tip = ends.form_point_flank, ends.tip

    def near_distance(self, points: Array) -> float:
        """Return the median distance (mm) of points (N, 3) from the nearest points of a coarse lattice."""
        return float(np.median(self._tree.query(points)[0]))

    def foot_points(self, points: Array) -> FootPoints:
        """Return foot points of points (N, 3), mm, in the tooth's own frame."""
        batches = [self._foot_points(points[k : k + POINTS_PER_BATCH]) for k in range(0, len(points), POINTS_PER_BATCH)]
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
