"""Tips that pass each other: where a tooth leaves the spaces of its mating gear, or enters them, beside the mesh.

A point of the pinion's tip goes round its axis. It is between the teeth of the gear as long as it is inside the surface that the
gear's tip sweeps, a surface of revolution (a plane of a rack). Where it crosses that surface is a root in phi1, and there the
rotation of the gear that brings its tip to the point is a closed figure: the transmission advance of tips that meet. Such contact
lasts for any part of a pitch, however small, so that no sampling in phi1 is sure to see it; the roots are always found.

Where tips come near, all lines of both profiles, with their chamfers and roundings, are tried likewise: circles of any two of them
cross at roots, too. A tip that never leaves counts where it is half round.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.numeric.splines import Polynomials, spline_through
from gearmesh.kernel.surface.levels import station_normal

#: places on the circle of a tip point at which it is looked whether it is inside the gear's tip surface
PLACES_PER_TURN = 48
#: rounds in which the places nearest to that surface are refined, so that a circle that hardly crosses it is seen to
VERTEX_ROUNDS = 2
#: width of a round over that of the one before
VERTEX_SHRINK = 0.1
#: share of the gear's pitch by which tips must stay clear for their profiles not to be looked at
NEAR_PITCHES = 0.03
#: stations at which tips are looked at; where they come near it is all columns of the grid, and three for whole profiles
FEW_STATIONS = 7
#: degree of curves along the face
DEGREE = 5
#: mm by which a meeting may lie beside the gear's face
BESIDE_FACE = 1e-9


@dataclass(frozen=True)
class TipMeetings:
    """Meetings (M,) of the profiles of a tooth pair where circles of their points cross: `phi1`, rad; by how much the gear is then
    further ahead than the reference, rad; the point (M, 3), fixed frame, mm; the `arm` (M,), mm, of the pinion's normal there
    about the gear's axis; `tips` (M,): whether both points are on tips."""

    phi1: Array
    excess: Array
    point: Array
    arm: Array
    tips: NDArray[np.bool_]

    def rows(self, which: NDArray[np.intp]) -> TipMeetings:
        """Some of the meetings."""
        return TipMeetings(*(getattr(self, field.name)[which] for field in fields(self)))


@dataclass(frozen=True)
class _Line:
    """A line along the face of a flank or of its tip edge: points (J, 3) and normals (J, 3), own frame, at stations (J,), mm;
    `outside`: how far (mm) own points are beyond the surface that it sweeps; `angle` (rad) by station."""

    station: Array
    points: Array
    normals: Array
    outside: Callable[[Array], Array]
    angle: Polynomials

    @staticmethod
    def of(flank: Flank, points: Array, normals: Array, *, tip: bool) -> _Line:
        """The line through points (J, 3) of a flank, its `tip` or another one."""
        joint, axial = flank.mount.joint, flank.axial
        order = np.argsort(axial.value(points))
        points, normals = points[order], normals[order]
        station = axial.value(points)
        angle = spline_through(station, joint.running(joint.angle(points)), min(DEGREE, len(station) - 1))
        if tip:
            return _Line(station, points, normals, flank.edges["tip"].value, angle)
        across, up = station_normal(axial)

        def height(r: Array) -> Array:
            return np.asarray(up * joint.radius(r) - across * r[..., 2])

        curve = spline_through(station, height(points), min(DEGREE, len(station) - 1))
        sense = flank.heights.sign
        return _Line(station, points, normals, lambda r: sense * (height(r) - curve(axial.value(r))), angle)


@dataclass(frozen=True)
class _Points:
    """Points and normals (M, 3), own frame, of lines of the pinion."""

    points: Array
    normals: Array

    @staticmethod
    def of(lines: list[_Line], columns: NDArray[np.intp]) -> _Points:
        """Those of some columns of the lines."""
        return _Points(
            np.concatenate([line.points[columns] for line in lines]),
            np.concatenate([line.normals[columns] for line in lines]),
        )


def tip_meetings(pair: Pair, reference: float) -> TipMeetings:
    """Where tips of a tooth pair meet as they pass each other, and what else of their profiles does where they come near.

    The gear is ahead of the nominal ratio by the `reference` (rad).
    """
    with np.errstate(all="ignore"):
        first, second = map(_tip_lines, pair.flanks, pair.tips)
        columns = np.unique(np.rint(np.linspace(0, len(first[0].points) - 1, FEW_STATIONS)).astype(np.intp))
        few = _Points.of(first, columns)
        meetings = [_meetings(pair, reference, few, line, tips=True) for line in second]
        if max(met.excess.max(initial=-np.inf) for met in meetings) < -NEAR_PITCHES * abs(pair.ratio) * pair.pitch:
            return _concatenate(meetings)
        every = _Points.of(first, np.arange(len(first[0].points)))
        meetings = [_meetings(pair, reference, every, line, tips=True) for line in second]
        first, second = map(_profile, pair.flanks, pair.tips)
        whole = _Points.of(first, columns[:: len(columns) // 2])
        meetings += [_meetings(pair, reference, whole, line, tips=False) for line in second]
    return _concatenate(meetings)


def _concatenate(meetings: list[TipMeetings]) -> TipMeetings:
    """All of several meetings."""
    columns = ([getattr(met, field.name) for met in meetings] for field in fields(TipMeetings))
    return TipMeetings(*map(np.concatenate, columns))


def _row(flank: Flank, row: int) -> tuple[Array, Array]:
    """Points and normals (J, 3), own frame, of a row of a flank's grid."""
    jet = flank.surface.jet(flank.grid[row, :, 0], flank.grid[row, :, 1])
    return jet.r, jet.n


def _tip_lines(flank: Flank, tip_edge: Flank | None) -> list[_Line]:
    """The tip of a flank, and the middle and the end of its tip edge, if it has one."""
    lines = [_Line.of(flank, *_row(flank, -1), tip=True)]
    if tip_edge is not None:
        lines += [_Line.of(flank, *_row(tip_edge, k), tip=False) for k in (len(tip_edge.grid) // 2, -1)]
    return lines


def _profile(flank: Flank, tip_edge: Flank | None) -> list[_Line]:
    """Lines of a flank and of its tip edge, from the form point to the land."""
    last = len(flank.grid) - 1
    lines = [_Line.of(flank, *_row(flank, k), tip=k == last) for k in range(last + 1)]
    if tip_edge is not None:
        lines += [_Line.of(flank, *_row(tip_edge, k), tip=False) for k in range(len(tip_edge.grid))]
    return lines


def _meetings(pair: Pair, reference: float, first: _Points, second: _Line, *, tips: bool) -> TipMeetings:
    """Where points of a line of the pinion cross the surface that a line of the gear sweeps."""
    pinion, gear = (flank.mount for flank in pair.flanks)
    joint, middle = gear.joint, pair.facing - pinion.sign * pair.pinion.azimuth(first.points)

    def phi2(phi1: Array) -> Array:
        """Rotations of the gear where it is ahead by the reference."""
        return pair.ratio * phi1 + pair.drive * reference

    def positions(phi1: Array, column: NDArray[np.intp]) -> tuple[Array, Array]:
        """Points (M, 3), fixed frame, and as the gear has them."""
        fixed = pinion.at(phi1).point(first.points[column])
        return fixed, gear.at(phi2(phi1)).inverse.point(fixed)

    phi1, column = _crossings(lambda at, columns: second.outside(positions(at, columns)[1]), middle)
    fixed, own = positions(phi1, column)
    station, (low, high) = pair.gear.axial.value(own), second.station[[0, -1]]
    turn = joint.within(joint.angle(own) - second.angle(np.clip(station, low, high)))
    normal = pinion.at(phi1).vector(first.normals[column])
    on_gear = np.stack([np.interp(station, second.station, axis) for axis in second.normals.T], axis=-1)
    on_gear = gear.at(phi2(phi1) + gear.sign * turn).vector(on_gear)
    arm = pair.drive * dot(normal, gear.velocity(fixed))
    kept = (station >= low - BESIDE_FACE) & (station <= high + BESIDE_FACE) & (dot(normal, on_gear) < 0.0) & (arm > 0.0)
    met = TipMeetings(phi1, pair.drive * gear.sign * turn, fixed, arm, np.full(len(phi1), tips))
    return met.rows(np.flatnonzero(kept))


def _crossings(outside: Callable[[Array, NDArray[np.intp]], Array], middle: Array) -> tuple[Array, NDArray[np.intp]]:
    """Rotations phi1 (M,) within half a turn of the `middle` (J,), rad, at which points cross a surface, and their columns; of
    those that are inside it all round, both ends."""
    step = 2.0 * np.pi / PLACES_PER_TURN
    # one place more at either end, about which extremes may lie
    place = middle[:, None] + step * (np.arange(PLACES_PER_TURN + 3) - 1.0 - 0.5 * PLACES_PER_TURN)
    every = np.broadcast_to(np.arange(len(middle))[:, None], place.shape)
    value = outside(place.ravel(), every.ravel()).reshape(place.shape)
    sides = np.sign(value)
    j, k = np.nonzero(sides[:, 1:-2] != sides[:, 2:-1])
    low, high, column = [place[j, k + 1]], [place[j, k + 2]], [j]
    # of three places on one side the middle one is nearest to the surface: about it the circle may cross it twice
    size, inner = np.abs(value), np.s_[:, 1:-1]
    nearest = (sides[:, :-2] == sides[inner]) & (sides[:, 2:] == sides[inner])
    nearest &= (size[inner] <= size[:, :-2]) & (size[inner] <= size[:, 2:])
    j, k = np.nonzero(nearest)
    if j.size:
        vertex, width, three = place[j, k + 1], step, np.stack([value[j, k + n] for n in range(3)])
        for _ in range(VERTEX_ROUNDS):
            bend = three[0] - 2.0 * three[1] + three[2]
            vertex = vertex + width * np.clip(np.nan_to_num(0.5 * (three[0] - three[2]) / bend), -1.0, 1.0)
            width *= VERTEX_SHRINK
            tried = np.concatenate((vertex - width, vertex, vertex + width))
            three = outside(tried, np.tile(j, 3)).reshape(3, -1)
        crossed = np.flatnonzero(np.sign(three[1]) != sides[j, k + 1])
        for n in (0, 2):
            low.append(place[j, k + n][crossed])
            high.append(vertex[crossed])
            column.append(j[crossed])
    of = np.concatenate(column)
    roots = bracketed_root(lambda at, index: outside(at, of[index]), np.concatenate(low), np.concatenate(high))
    converged = np.flatnonzero(roots.converged)
    enclosed = np.setdiff1d(np.flatnonzero((value < 0.0).all(axis=1)), of[converged])
    ends = [middle[enclosed] + way * np.pi for way in (-1.0, 1.0)]
    return np.concatenate((roots.values[converged], *ends)), np.concatenate((of[converged], enclosed, enclosed))
