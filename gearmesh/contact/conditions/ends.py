"""What bounds flank and fillet at their form point and at the root, through exact points of both, for the contact solver."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from gearmesh.contact.first_touch.spline_table import SplineTable
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.splines import spline_through, splines_through
from gearmesh.kernel.surface.levels import CurveLevel, Level, ScrewLevel, Shifted
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth

#: degree of the curves
DEGREE = 5
#: points of a flank's form point, where undercut neither begins nor ends between them
FORM_POINT_SAMPLES = 25
#: part of the largest coordinate up to which a tip's heights count as one
EVEN = 1e-11
#: share of the face below which undercut at its very end does not count
SHORTEST = 1e-6
#: share of the range of the second parameter by which a point's may differ from it and be on the same sheet of the surface
SHEET = 0.1
#: by how much of itself the way of the stations along the second parameter may change and there be but one sheet
SAME = 1e-9
#: mm along the profile by which a point may lie past form point or root by its parameters and be told by its place alone
BACK = 1e-3


class FormPoints:
    """The form points of a flank, where the fillet begins, as a curve through exact ones: `level` bounds the flank there.

    The surface may come back to that level behind a line of regression; called with parameters and own-frame points it gives how
    far (mm along the profile) they lie past the form point by their parameters, less `BACK`, or that they lie on another sheet.
    """

    def __init__(self, tooth: Tooth, side: Side, grid: Grid) -> None:
        assert grid.p is not None
        assert grid.jet is not None
        axial, (toe, heel) = tooth.blank.axial, tooth.blank.extent
        across = tooth.blank.across
        undercut = tooth.even.of(side).form_point_flank != tooth.side(side).form_point[0]
        self.smooth = not (undercut.any() or tooth.side(side).sharp)
        r, p = grid.points[:1], grid.p[:1]
        if undercut.any() and not undercut.all():
            breaks = tooth.breaks_of(side)
            cuts = np.concatenate(([0.0], breaks[(breaks > SHORTEST) & (breaks < 1.0 - SHORTEST)], [1.0]))
            t = np.stack([np.linspace(low, high, FORM_POINT_SAMPLES) for low, high in pairwise(cuts)])
            form_point = tooth.flank_grid(side, [0.0], t.ravel())
            assert form_point.p is not None
            r, p = form_point.points[0].reshape(*t.shape, 3), form_point.p[0].reshape(t.shape)
        if heel < toe:
            r, p = r[::-1, ::-1], p[::-1, ::-1]
        self.level = _through(axial, across, r, grid.points[-1])
        self._axial, self._parameter = axial, splines_through(axial.value(r), p, DEGREE)
        speed = float(np.linalg.norm(grid.jet.r_u[len(grid.points) // 2, grid.points.shape[1] // 2]))
        self._scale = speed * float(np.sign((grid.p[0] - grid.p[-1]).mean()))
        self._sheet = OwnSheet.of(grid, axial, tooth.even.stations)

    def __call__(self, parameters: Array, r: Array) -> Array:
        past = self._scale * (parameters[..., 0] - self._parameter(self._axial.value(r))) - BACK
        outside: Array = past if self._sheet is None else np.maximum(past, self._sheet(parameters, r))
        return outside


@dataclass(frozen=True)
class OwnSheet:
    """The second parameter of a trimmed flank or fillet, by the first one and the station.

    A tool that turns back may generate at a station another point from the same point of its profile: on another sheet of the
    surface, which is no part of the tooth. Called with parameters and own-frame points it gives -inf on the tooth's own sheet and
    what the second parameter is off on others. `slack`: by how much it may be off on the own one.
    """

    axial: Level
    stations: Array
    ends: tuple[Array, Array]
    second: SplineTable
    slack: float

    @staticmethod
    def of(grid: Grid, axial: Level, stations: Array) -> OwnSheet | None:
        """The sheet of a grid, at even stations (T,), its rows evenly from one end of the profile to the other.

        None where there is but one: where the station grows alike with the second parameter everywhere.
        """
        assert grid.p is not None
        assert grid.v is not None
        assert grid.jet is not None
        along = dot(axial.gradient(grid.points), grid.jet.r_v)
        if np.ptp(along) < SAME * np.abs(along).max():
            return None
        return OwnSheet(axial, stations, (grid.p[0], grid.p[-1]), SplineTable.of(grid.v), SHEET * float(np.ptp(grid.v)))

    def __call__(self, parameters: Array, r: Array) -> Array:
        place = _place(self.axial.value(r), self.stations)
        first, last = (_cubic(end, place) for end in self.ends)
        row = np.clip((parameters[..., 0] - first) / (last - first), 0.0, 1.0) * self.second.last[0]
        away = np.abs(parameters[..., 1] - self.second.at(row, place))
        return np.where(away > self.slack, away, -np.inf)


def tip_of(tooth: Tooth, grid: Grid) -> Level:
    """What bounds a flank, given by its grid, at its tip: a level of the land's, or one through where an edge of the tip begins.

    An edge that the tool made, or that is broken, begins elsewhere at every station, once the flank was modified.
    """
    tips, tip = grid.points[-1], tooth.blank.tip
    heights = tip.value(tips)
    if np.ptp(heights) <= EVEN * np.abs(tips).max():
        return Shifted(tip, float(heights[tips.shape[0] // 2]))
    toe, heel = tooth.blank.extent
    return _through(tooth.blank.axial, tooth.blank.across, tips[None, :: int(np.sign(heel - toe))], grid.points[0])


def _through(axial: Level, across: Level, r: Array, inside: Array) -> CurveLevel:
    """The level through smooth curves (K, N, 3), stations ascending, which is negative at points `inside` (M, 3)."""
    curve = splines_through(axial.value(r), across.value(r), DEGREE)
    above = np.sign((across.value(inside) - curve(axial.value(inside))).mean())
    return CurveLevel(axial, across, curve, float(above))


def root_of(axial: Level, grid: Grid, stations: Array, joint: Joint) -> ScrewLevel:
    """What bounds a fillet, given by its grid at `stations` (T,), at its root, where it is tangent to a surface of revolution."""
    angle = joint.running(joint.angle(grid.points[0]))
    order = np.argsort(stations)
    curve = spline_through(stations[order], angle[order], DEGREE)
    level = ScrewLevel(axial, curve, float(joint.arm(grid.points[0, 0])), joint)
    inside = level.value(grid.points[1]).mean() < 0.0
    return level if inside else replace(level, radius=-level.radius)


class Between:
    """Distance (mm along the profile) of points of a fillet or tip edge past its last row, or past its first row less `back`.

    Points on another sheet of the surface count as past it.
    """

    def __init__(self, grid: Grid, axial: Level, stations: Array, back: float = BACK) -> None:
        assert grid.p is not None
        assert grid.jet is not None
        self._back = back
        self._sheet = OwnSheet.of(grid, axial, stations)
        self._axial, self._stations = axial, stations
        self._first, self._last = grid.p[0], grid.p[-1]
        self._speed = float(np.linalg.norm(grid.jet.r_u[len(grid.points) // 2, grid.points.shape[1] // 2]))

    def __call__(self, parameters: Array, r: Array) -> Array:
        place = _place(self._axial.value(r), self._stations)
        first, last = (_cubic(end, place) for end in (self._first, self._last))
        p, sense = parameters[..., 0], np.sign(last - first)
        past = np.maximum(self._speed * sense * (p - last), self._speed * sense * (first - p) - self._back)
        outside: Array = past if self._sheet is None else np.maximum(past, self._sheet(parameters, r))
        return outside


def _place(axial: Array, stations: Array) -> Array:
    """Places of axial coordinates in steps of even stations (T,), none beyond the ends."""
    last = len(stations) - 1.0
    place: Array = np.clip((axial - stations[0]) * (last / (stations[-1] - stations[0])), 0.0, last)
    return place


def _cubic(values: Array, place: Array) -> Array:
    """Values (M,) between those of a row (K,) at places (M,) in its steps, by the cubic through the nearest four."""
    first = np.clip(np.nan_to_num(np.floor(place)).astype(np.intp) - 1, 0, len(values) - 4)
    t = place - first
    weights = (
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    )
    interpolated: Array = sum((w * values[first + k] for k, w in enumerate(weights)), np.zeros(len(place)))
    return interpolated
