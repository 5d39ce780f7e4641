"""Boundaries of flank and fillet at tip, form point and root, through exact points, for the contact solver."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from gearmesh.contact.first_touch.spline_table import SplineTable
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.splines import spline_through, splines_through
from gearmesh.kernel.surface.levels import CurveLevel, Level, ScrewLevel, Shifted
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth

#: degree of the splines
SPLINE_DEGREE = 5
#: points of the curve of form points between two places where undercut begins or ends
FORM_POINT_SAMPLES = 25
#: difference of a tip's heights, by the largest coordinate, that is rounding
HEIGHT_ROUNDING = 1e-11
#: length of undercut at an end of the face, by the face, that does not count
MIN_UNDERCUT_SHARE = 1e-6
#: difference of the second parameter, by its range, up to which a point is on the same sheet of the surface
SHEET_SLACK = 0.1
#: relative change of the stations along the second parameter up to which a surface has one sheet
ONE_SHEET_VARIATION = 1e-9
#: distance (mm along the profile) past form point or root up to which the place of a point decides, not its parameters
PARAMETER_SLACK_MM = 1e-3


class FormPoints:
    """Form points of a flank, where the fillet begins, as a curve through exact points; `level` bounds the flank there.

    The surface may return to this level behind a line of regression. A call with parameters and points of the member's frame
    returns their distance (mm along the profile) past the form point by their parameters, less `PARAMETER_SLACK_MM`. Points on
    another sheet of the surface count as past it.
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
            cuts = np.concatenate(
                ([0.0], breaks[(breaks > MIN_UNDERCUT_SHARE) & (breaks < 1.0 - MIN_UNDERCUT_SHARE)], [1.0])
            )
            t = np.stack([np.linspace(low, high, FORM_POINT_SAMPLES) for low, high in pairwise(cuts)])
            form_point = tooth.flank_grid(side, [0.0], t.ravel())
            assert form_point.p is not None
            r, p = form_point.points[0].reshape(*t.shape, 3), form_point.p[0].reshape(t.shape)
        if heel < toe:
            r, p = r[::-1, ::-1], p[::-1, ::-1]
        self.level = _through(axial, across, r, grid.points[-1])
        self._axial, self._parameter = axial, splines_through(axial.value(r), p, SPLINE_DEGREE)
        speed = float(np.linalg.norm(grid.jet.r_u[len(grid.points) // 2, grid.points.shape[1] // 2]))
        self._scale = speed * float(np.sign((grid.p[0] - grid.p[-1]).mean()))
        self._sheet = OwnSheet.of(grid, axial, tooth.even.stations)

    def __call__(self, parameters: Array, r: Array) -> Array:
        past = self._scale * (parameters[..., 0] - self._parameter(self._axial.value(r))) - PARAMETER_SLACK_MM
        outside: Array = past if self._sheet is None else np.maximum(past, self._sheet(parameters, r))
        return outside


@dataclass(frozen=True)
class OwnSheet:
    """Second parameter of a trimmed flank or fillet as a function of the first parameter and the station.

    A tool that turns back may generate two points at a station from one point of its profile. The second point is on another sheet
    of the surface, which is no part of the tooth. A call with parameters and points of the member's frame returns -inf on the
    tooth's sheet and the difference of the second parameter on other sheets.
    """

    #: station coordinate
    axial: Level
    #: stations (T,), equally spaced, mm
    stations: Array
    #: first parameters (T,) at both ends of the profile
    ends: tuple[Array, Array]
    #: table of the second parameter
    second: SplineTable
    #: difference of the second parameter up to which a point is on the tooth's sheet
    slack: float

    @staticmethod
    def of(grid: Grid, axial: Level, stations: Array) -> OwnSheet | None:
        """Return the sheet of a grid at equally spaced stations (T,); None where the surface has only one sheet.

        The rows of the grid are equally spaced from one end of the profile to the other. A surface has one sheet if the station
        grows with the second parameter at one rate everywhere.
        """
        assert grid.p is not None
        assert grid.v is not None
        assert grid.jet is not None
        along = dot(axial.gradient(grid.points), grid.jet.r_v)
        if np.ptp(along) < ONE_SHEET_VARIATION * np.abs(along).max():
            return None
        return OwnSheet(
            axial, stations, (grid.p[0], grid.p[-1]), SplineTable.of(grid.v), SHEET_SLACK * float(np.ptp(grid.v))
        )

    def __call__(self, parameters: Array, r: Array) -> Array:
        place = _place(self.axial.value(r), self.stations)
        first, last = (_cubic(end, place) for end in self.ends)
        row = np.clip((parameters[..., 0] - first) / (last - first), 0.0, 1.0) * self.second.last[0]
        away = np.abs(parameters[..., 1] - self.second.at(row, place))
        return np.where(away > self.slack, away, -np.inf)


def tip_of(tooth: Tooth, grid: Grid) -> Level:
    """Return the level that bounds a flank, given by its grid, at its tip.

    This is a level of the tip surface, or a level through the beginning of a chamfer or rounding. A chamfer that the tool
    made, or a broken edge, begins at different heights along the face of a modified flank.
    """
    tips, tip = grid.points[-1], tooth.blank.tip
    heights = tip.value(tips)
    if np.ptp(heights) <= HEIGHT_ROUNDING * np.abs(tips).max():
        return Shifted(tip, float(heights[tips.shape[0] // 2]))
    toe, heel = tooth.blank.extent
    return _through(tooth.blank.axial, tooth.blank.across, tips[None, :: int(np.sign(heel - toe))], grid.points[0])


def _through(axial: Level, across: Level, r: Array, inside: Array) -> CurveLevel:
    """Return the level through smooth curves (K, N, 3), stations ascending, that is negative at points `inside` (M, 3)."""
    curve = splines_through(axial.value(r), across.value(r), SPLINE_DEGREE)
    above = np.sign((across.value(inside) - curve(axial.value(inside))).mean())
    return CurveLevel(axial, across, curve, float(above))


def root_of(axial: Level, grid: Grid, stations: Array, joint: Joint) -> ScrewLevel:
    """Return the level that bounds a fillet, given by its grid at `stations` (T,), at its root.

    The fillet is tangent to a surface of revolution there.
    """
    angle = joint.running(joint.angle(grid.points[0]))
    order = np.argsort(stations)
    curve = spline_through(stations[order], angle[order], SPLINE_DEGREE)
    level = ScrewLevel(axial, curve, float(joint.arm(grid.points[0, 0])), joint)
    inside = level.value(grid.points[1]).mean() < 0.0
    return level if inside else replace(level, radius=-level.radius)


class Between:
    """Distance (mm along the profile) of points past the last row of a fillet or tip edge, or past its first row less `back`.

    Points on another sheet of the surface count as past it.
    """

    def __init__(self, grid: Grid, axial: Level, stations: Array, back: float = PARAMETER_SLACK_MM) -> None:
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
    """Return axial coordinates in steps of equally spaced stations (T,), clipped to the ends."""
    last = len(stations) - 1.0
    place: Array = np.clip((axial - stations[0]) * (last / (stations[-1] - stations[0])), 0.0, last)
    return place


def _cubic(values: Array, place: Array) -> Array:
    """Interpolate a row of values (K,) at places (M,), in steps, by the cubic through the nearest four; return (M,)."""
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
