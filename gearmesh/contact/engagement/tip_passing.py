"""Tips that pass each other, where a tooth enters or leaves the spaces of its mating gear beside the mesh.

A point of the pinion's tip moves on a circle. It is between the teeth of the gear while it is inside the surface that the gear's
tip sweeps: a surface of revolution, or a plane for a rack. The crossing of the circle with this surface is a root in phi1. The
rotation of the gear that brings its tip to the point is known in closed form there, and gives the transmission advance of tips
that meet. Such contact may last any small part of a pitch, so that sampling in phi1 can miss it; the roots are always found.

A flank that a land continues smoothly has no tip that could meet another such flank: they touch where their normals
agree, as flanks do.

Where tips come near each other, all lines of both profiles, with chamfers and roundings, are treated in the same way. A tip that
never leaves the tip surface counts half a turn away from the mesh.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.numeric.splines import Polynomials, spline_through
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass

#: places on the circle of a tip point at which the point is compared with the gear's tip surface
PLACES_PER_TURN = 48
#: rounds that refine the place nearest to the surface, so that a circle that hardly crosses the surface is found
VERTEX_ROUNDS = 2
#: width of a round by the width of the round before
VERTEX_SHRINK = 0.1
#: clearance of tips, by the gear's pitch, from which on the other lines of the profiles are not tried
NEAR_PITCHES = 0.03
#: stations at which tips are compared; near tips are compared at all columns of the grid, whole profiles at three
FEW_STATIONS = 7
#: degree of splines along the face
SPLINE_DEGREE = 5
#: distance (mm) beside the gear's face up to which a meeting counts
FACE_SLACK_MM = 1e-9


@dataclass(frozen=True)
class TipMeetings:
    """Meetings of the profiles of a tooth pair, where the circles of two points cross."""

    #: rotation (M,) of the pinion, rad
    phi1: Array
    #: advance (M,) of the gear over the reference, rad
    excess: Array
    #: points (M, 3), fixed frame, mm
    point: Array
    #: distance (M,) of the pinion's normal from the gear's axis, mm
    arm: Array
    #: True (M,) where both points are on tips
    tips: NDArray[np.bool_]

    def rows(self, which: NDArray[np.intp]) -> TipMeetings:
        """Return the meetings `which`."""
        return TipMeetings(*(getattr(self, field.name)[which] for field in fields(self)))


@dataclass(frozen=True)
class _Line:
    """Line along the face of a flank or of its tip edge, in the member's frame."""

    #: stations (J,), mm, ascending
    station: Array
    #: points (J, 3), mm
    points: Array
    #: unit normals (J, 3)
    normals: Array
    #: distance (mm) of points of the member's frame beyond the surface that the line sweeps
    outside: Callable[[Array], Array]
    #: angle (rad) about the axis as a function of the station
    angle: Polynomials

    @staticmethod
    def of(flank: Flank, points: Array, normals: Array, *, tip: bool) -> _Line:
        """Return the line through points (J, 3) of a flank; `tip` is True for the tip of the flank."""
        joint, axial = flank.mount.joint, flank.axial
        order = np.argsort(axial.value(points))
        points, normals = points[order], normals[order]
        station = axial.value(points)
        angle = spline_through(station, joint.running(joint.angle(points)), min(SPLINE_DEGREE, len(station) - 1))
        if tip:
            return _Line(station, points, normals, flank.edges["tip"].value, angle)
        across, up = station_normal(axial)

        def height(r: Array) -> Array:
            return np.asarray(up * joint.radius(r) - across * r[..., 2])

        curve = spline_through(station, height(points), min(SPLINE_DEGREE, len(station) - 1))
        sense = flank.heights.sign
        return _Line(station, points, normals, lambda r: sense * (height(r) - curve(axial.value(r))), angle)


@dataclass(frozen=True)
class _Points:
    """Points and normals (M, 3) of lines of the pinion, in its frame."""

    points: Array
    normals: Array

    @staticmethod
    def of(lines: list[_Line], columns: NDArray[np.intp]) -> _Points:
        """Collect points and normals of `columns` of the lines."""
        return _Points(
            np.concatenate([line.points[columns] for line in lines]),
            np.concatenate([line.normals[columns] for line in lines]),
        )


def tip_meetings(pair: Pair, reference: float) -> TipMeetings:
    """Solve for the meetings of tips that pass each other, and of whole profiles where tips come near.

    The gear is ahead of the nominal ratio by the `reference` (rad).
    """
    smooth = [_continues(*both) for both in zip(pair.flanks, pair.tips, strict=True)]
    if all(smooth):
        return _NO_MEETINGS
    with np.errstate(all="ignore"):
        # tips at a few stations decide if tips come near; near tips are compared at all columns, and whole profiles at three
        first, second = map(_tip_lines, pair.flanks, pair.tips)
        columns = distinct(np.rint(np.linspace(0, len(first[0].points) - 1, FEW_STATIONS)).astype(np.intp))
        few_points = _Points.of(first, columns)
        meetings = [_meetings(pair, reference, few_points, line, tips=True) for line in second]
        if max(met.excess.max(initial=-np.inf) for met in meetings) < -NEAR_PITCHES * abs(pair.ratio) * pair.pitch:
            return _concatenate(meetings)
        all_points = _Points.of(first, np.arange(len(first[0].points)))
        meetings = [_meetings(pair, reference, all_points, line, tips=True) for line in second]
        # a profile that goes on smoothly beyond its tip meets the other one there by its tip alone
        first, second = (
            (_tip_lines if smooth[1 - k] else _profile)(*both)
            for k, both in enumerate(zip(pair.flanks, pair.tips, strict=True))
        )
        profile_points = _Points.of(first, columns[:: len(columns) // 2])
        meetings += [_meetings(pair, reference, profile_points, line, tips=False) for line in second]
    return _concatenate(meetings)


#: meetings of flanks that have no tips
_NO_MEETINGS = TipMeetings(np.zeros(0), np.zeros(0), np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=bool))


def _continues(flank: Flank, tip_edge: Flank | None) -> bool:
    """Return True if the tooth continues smoothly beyond the flank without a chamfer or rounding: a generated land."""
    return tip_edge is None and "tip" in flank.smooth


def _concatenate(meetings: list[TipMeetings]) -> TipMeetings:
    """Join meetings."""
    columns = ([getattr(met, field.name) for met in meetings] for field in fields(TipMeetings))
    return TipMeetings(*map(np.concatenate, columns))


def _row(flank: Flank, row: int) -> tuple[Array, Array]:
    """Return points and normals (J, 3) of a row of a flank's grid, in the member's frame."""
    jet = flank.surface.jet(flank.grid[row, :, 0], flank.grid[row, :, 1])
    return jet.r, jet.n


def _tip_lines(flank: Flank, tip_edge: Flank | None) -> list[_Line]:
    """Return the tip line of a flank, and the middle and end lines of its tip edge, if it has one."""
    lines = [_Line.of(flank, *_row(flank, -1), tip=True)]
    if tip_edge is not None:
        lines += [_Line.of(flank, *_row(tip_edge, k), tip=False) for k in (len(tip_edge.grid) // 2, -1)]
    return lines


def _profile(flank: Flank, tip_edge: Flank | None) -> list[_Line]:
    """Return the lines of a flank and of its tip edge, from the form point to the land."""
    last = len(flank.grid) - 1
    lines = [_Line.of(flank, *_row(flank, k), tip=k == last) for k in range(last + 1)]
    if tip_edge is not None:
        lines += [_Line.of(flank, *_row(tip_edge, k), tip=False) for k in range(len(tip_edge.grid))]
    return lines


def _meetings(pair: Pair, reference: float, first: _Points, second: _Line, *, tips: bool) -> TipMeetings:
    """Solve for the crossings of points of the pinion with the surface that a line of the gear sweeps."""
    pinion, gear = (flank.mount for flank in pair.flanks)
    joint, middle = gear.joint, pair.facing - pinion.sign * pair.pinion.azimuth(first.points)

    def phi2(phi1: Array) -> Array:
        """Return the rotations of the gear that is ahead by the reference."""
        return pair.ratio * phi1 + pair.drive * reference

    def positions(phi1: Array, column: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return points (M, 3) in the fixed frame and in the gear's frame."""
        fixed = pinion.at(phi1).point(first.points[column])
        return fixed, gear.at(phi2(phi1)).inverse.point(fixed)

    # rotations at which a point of the pinion crosses the surface that the gear's line sweeps
    phi1, column = _crossings(lambda at, columns: second.outside(positions(at, columns)[1]), middle)
    # rotation of the gear that brings its line to the point; it counts on the gear's face, if the surfaces face each other
    fixed, in_gear = positions(phi1, column)
    station, (low, high) = pair.gear.axial.value(in_gear), second.station[[0, -1]]
    turn = joint.within(joint.angle(in_gear) - second.angle(np.clip(station, low, high)))
    normal = pinion.at(phi1).vector(first.normals[column])
    on_gear = np.stack([np.interp(station, second.station, axis) for axis in second.normals.T], axis=-1)
    on_gear = gear.at(phi2(phi1) + gear.sign * turn).vector(on_gear)
    arm = pair.drive * dot(normal, gear.velocity(fixed))
    kept = (
        (station >= low - FACE_SLACK_MM)
        & (station <= high + FACE_SLACK_MM)
        & (dot(normal, on_gear) < 0.0)
        & (arm > 0.0)
    )
    met = TipMeetings(phi1, pair.drive * gear.sign * turn, fixed, arm, np.full(len(phi1), tips))
    return met.rows(np.flatnonzero(kept))


def _crossings(outside: Callable[[Array, NDArray[np.intp]], Array], middle: Array) -> tuple[Array, NDArray[np.intp]]:
    """Solve for rotations phi1 (M,), rad, within half a turn of the `middle` (J,), at which points cross a surface.

    Also returns the columns (M,) of the points. A point that is inside the surface all round counts at both ends of the turn.
    """
    step = 2.0 * np.pi / PLACES_PER_TURN
    # one place more at each end, because extremes may lie there
    rotations = middle[:, None] + step * (np.arange(PLACES_PER_TURN + 3) - 1.0 - 0.5 * PLACES_PER_TURN)
    columns = np.broadcast_to(np.arange(len(middle))[:, None], rotations.shape)
    value = outside(rotations.ravel(), columns.ravel()).reshape(rotations.shape)
    sides = np.sign(value)
    j, k = np.nonzero(sides[:, 1:-2] != sides[:, 2:-1])
    low, high, column = [rotations[j, k + 1]], [rotations[j, k + 2]], [j]
    # the middle of three places on one side is nearest to the surface: the circle may cross the surface twice near it
    size, inner = np.abs(value), np.s_[:, 1:-1]
    nearest = (sides[:, :-2] == sides[inner]) & (sides[:, 2:] == sides[inner])
    nearest &= (size[inner] <= size[:, :-2]) & (size[inner] <= size[:, 2:])
    j, k = np.nonzero(nearest)
    if j.size:
        vertex, width, three = rotations[j, k + 1], step, np.stack([value[j, k + n] for n in range(3)])
        for _ in range(VERTEX_ROUNDS):
            bend = three[0] - 2.0 * three[1] + three[2]
            vertex = vertex + width * np.clip(np.nan_to_num(0.5 * (three[0] - three[2]) / bend), -1.0, 1.0)
            width *= VERTEX_SHRINK
            tried = np.concatenate((vertex - width, vertex, vertex + width))
            three = outside(tried, np.tile(j, 3)).reshape(3, -1)
        crossed = np.flatnonzero(np.sign(three[1]) != sides[j, k + 1])
        for n in (0, 2):
            low.append(rotations[j, k + n][crossed])
            high.append(vertex[crossed])
            column.append(j[crossed])
    # roots between places on different sides, and between a vertex and its neighbours
    of = np.concatenate(column)
    roots = bracketed_root(lambda at, index: outside(at, of[index]), np.concatenate(low), np.concatenate(high))
    converged = np.flatnonzero(roots.converged)
    enclosed = np.setdiff1d(np.flatnonzero((value < 0.0).all(axis=1)), of[converged], assume_unique=True)
    ends = [middle[enclosed] + way * np.pi for way in (-1.0, 1.0)]
    return np.concatenate((roots.values[converged], *ends)), np.concatenate((of[converged], enclosed, enclosed))
