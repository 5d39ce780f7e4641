"""Real flanks: flanks of a member from files of measured points, and the teeth with these flanks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearmesh.errors import DesignError, FileError
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.metrology.flanks.alignment import align
from gearmesh.metrology.flanks.point_file import (
    DEVIATION_COLUMNS,
    LINE_COLUMNS,
    NORMAL_COLUMNS,
    PLACE_COLUMNS,
    POINT_COLUMNS,
    PointTable,
    read_points,
)
from gearmesh.metrology.flanks.projection import FlankProjection, FootPoints
from gearmesh.metrology.flanks.smoothing import SmoothDeviations, smooth_deviations
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid, deviating_tooth, lowest_share
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: largest deviation, mm
MAX_DEVIATION_MM = 1.0
#: mm; if all deviations of a file are smaller, they may have been meant in mm
MEANT_IN_MM = 2e-5
#: least number of points of a flank
MIN_FLANK_POINTS = 4
#: shares of the flank beyond its ends within which points may lie
MAX_SHARE_BEYOND = 0.02
#: largest difference of a normal's length from 1: normals of two decimals
LENGTH_TOLERANCE = 0.01
#: largest number of outliers that a message names
MAX_NAMED_OUTLIERS = 3


@dataclass(frozen=True)
class MeasuringMode:
    """Settings for reading files."""

    #: True if the axial position is free
    axial: bool = False
    #: stiffness of smoothing; None for cross-validation, 0 to pass through all points of a whole grid
    stiffness: float | None = None


@dataclass(frozen=True)
class MeasuredFlank:
    """Deviations of a flank, measured and smoothed."""

    #: deviations on a grid, for the tooth
    grid: DeviationGrid
    #: foot points of the measured points
    feet: FootPoints
    #: measured deviations (N,), mm, at the foot points; NaN if missing
    deviations: Array
    #: smoothing spline through them; None for a whole grid
    smooth: SmoothDeviations | None
    #: rotation of measured points, rad
    rotation: float = 0.0
    #: axial shift of measured points, mm
    shift: float = 0.0
    #: remarks on the file
    notes: tuple[str, ...] = ()


def with_measured_flanks(
    member: Member, files: Mapping[Side, Path], mode: MeasuringMode, keys: Mapping[Side, str]
) -> tuple[Member, tuple[str, ...]]:
    """Return the member with the measured flanks of files, and remarks on the files; `keys` name the files in messages.

    Raises FileError for a file that is no file of points, and DesignError for points that do not fit or make no tooth.
    """
    flanks = measured_flanks(member.one_tooth, files, mode, keys)
    try:
        tooth = deviating_tooth(member.one_tooth, {side: flank.grid for side, flank in flanks.items()})
    except DesignError as failure:
        raise DesignError(" and ".join(keys[side] for side in flanks), reason=str(failure)) from failure
    notes = tuple(f"{keys[side]}: {note}" for side, flank in flanks.items() for note in flank.notes)
    return replace(member, tooth=tooth), notes


def measured_flanks(
    tooth: Tooth, files: Mapping[Side, Path], mode: MeasuringMode, keys: Mapping[Side, str]
) -> dict[Side, MeasuredFlank]:
    """Return the measured flanks of a tooth from files. Raises the errors of `with_measured_flanks`."""
    tables = {side: read_points(path).of_flank(side) for side, path in files.items()}
    free = {side: table for side, table in tables.items() if _in_space(table)}
    flanks = {side: _of_deviations(tooth, side, table, mode) for side, table in tables.items() if side not in free}
    # points of both flanks in one file are aligned together
    for path in dict.fromkeys(files[side] for side in free):
        tables_of_path = {side: table for side, table in free.items() if files[side] == path}
        flanks |= _of_points(tooth, tables_of_path, mode, keys)
    return {side: flanks[side] for side in files}


def _in_space(table: PointTable) -> bool:
    """Return True if a file has measured points and no deviations."""
    return table.deviations is None


def _of_points(
    tooth: Tooth, tables: Mapping[Side, PointTable], mode: MeasuringMode, keys: Mapping[Side, str]
) -> dict[Side, MeasuredFlank]:
    points = {side: table.side_by_side(POINT_COLUMNS) for side, table in tables.items()}
    try:
        fit = align(
            tooth,
            {side: side_points for side, side_points in points.items() if side_points is not None},
            axial=mode.axial,
        )
    except DesignError as failure:
        raise DesignError(keys[next(iter(tables))], reason=str(failure)) from failure
    flanks = {}
    for side, feet in fit.feet.items():
        flank = _flank(tooth, side, tables[side], feet, feet.distances, mode)
        flanks[side] = replace(flank, rotation=fit.rotation, shift=fit.shift)
    return flanks


def _of_deviations(tooth: Tooth, side: Side, table: PointTable, mode: MeasuringMode) -> MeasuredFlank:
    d, points, normals = table.deviations, table.side_by_side(POINT_COLUMNS), table.side_by_side(NORMAL_COLUMNS)
    assert d is not None
    is_given = np.isfinite(d)
    if is_given.sum() < MIN_FLANK_POINTS:
        raise FileError(
            table.path, reason=f"{int(is_given.sum())} deviations of the {side} flank, at least {MIN_FLANK_POINTS}"
        )
    _refuse_large(table, d)
    if points is None:
        places = table.side_by_side(PLACE_COLUMNS)
        assert places is not None
        _refuse_off(table, places)
        feet = _at_shares(tooth, side, places)
        return _flank(tooth, side, table, feet, d, mode)
    # the measured point is the nominal point displaced by its deviation; a point without one stays
    measured_points = points.copy()
    if normals is not None:
        _refuse_lengths(table, np.where(is_given, np.linalg.norm(normals, axis=1), 1.0))
        measured_points[is_given] += d[is_given, None] * unit(normals[is_given])
    feet = FlankProjection(tooth, side).foot_points(measured_points)
    if normals is not None:
        _refuse_inward(table, normals, feet)
    values = feet.distances + (d if normals is None else np.where(is_given, 0.0, np.nan))
    return _flank(tooth, side, table, feet, values, mode)


def _at_shares(tooth: Tooth, side: Side, places: Array) -> FootPoints:
    """Return the points of a flank at shares (N, 2) of profile and face."""
    (s, rows), (t, columns) = (np.unique(places[:, k], return_inverse=True) for k in (0, 1))
    if len(s) * len(t) <= 4 * len(places):
        grid = tooth.flank_grid(side, s, t)
        points, normals = grid.points[rows, columns], grid.normals[rows, columns]
    else:
        grids = [tooth.flank_grid(side, [a], [b]) for a, b in places]
        points, normals = (np.concatenate([getattr(g, name)[0] for g in grids]) for name in ("points", "normals"))
    return FootPoints(places[:, 0], places[:, 1], points, normals, np.zeros(len(places)))


def _flank(
    tooth: Tooth, side: Side, table: PointTable, feet: FootPoints, d: Array, mode: MeasuringMode
) -> MeasuredFlank:
    _refuse_large(table, d)
    # points on the flank or a little beyond its ends
    on = np.isfinite(d)
    for share in (feet.s, feet.t):
        on &= (share > -MAX_SHARE_BEYOND) & (share < 1.0 + MAX_SHARE_BEYOND)
    if on.sum() < MIN_FLANK_POINTS:
        raise FileError(
            table.path,
            reason=f"{int(on.sum())} of {len(d)} points lie on the {side} flank, at least {MIN_FLANK_POINTS}",
        )
    notes = []
    off_flank = int((np.isfinite(d) & ~on).sum())
    if off_flank:
        notes.append(f"{off_flank} of {len(d)} points lie beside the flank and are left out")
    if np.abs(d[on]).max() < MEANT_IN_MM and np.abs(d[on]).max() > 0.0:
        notes.append(f"all deviations are below {1e3 * MEANT_IN_MM:g} um: were they meant in mm?")
    # a whole grid keeps its points; other points are smoothed by a spline
    whole_grid = _whole_grid(table, feet, d, on) if mode.stiffness in (None, 0.0) else None
    missing, total = _missing(table, on)
    if missing and whole_grid is None:
        notes.append(
            f"{missing} of {total} points of its grid have no deviation: the flank is the spline that bends least near the others"
        )
    smooth = smooth_deviations(feet.s[on], feet.t[on], d[on], mode.stiffness)
    outliers = np.flatnonzero(on)[smooth.outliers]
    if outliers.size:
        named = ", ".join(f"line {table.lines[k]} ({1e3 * d[k]:.1f} um)" for k in outliers[:MAX_NAMED_OUTLIERS])
        further = f" and {outliers.size - MAX_NAMED_OUTLIERS} more" if outliers.size > MAX_NAMED_OUTLIERS else ""
        notes.append(f"far from their neighbours: {named}{further}")
    if whole_grid is not None:
        return MeasuredFlank(whole_grid, feet, d, None, notes=tuple(notes))
    # the flank has no points beside its edges; towards the root, where deviations fade out, they are not used
    s, t = smooth.inside(lowest_share(tooth, side))
    nominal = tooth.flank_grid(side, s, t)
    grid = DeviationGrid(nominal.points, nominal.normals, smooth.at(s, t))
    return MeasuredFlank(grid, feet, d, smooth, notes=tuple(notes))


def _whole_grid(table: PointTable, feet: FootPoints, d: Array, on: Array) -> DeviationGrid | None:
    """Return the points as a grid if the file numbers its rows and columns and no point is missing; otherwise None."""
    lines = table.side_by_side(LINE_COLUMNS)
    if lines is None and table.side_by_side(PLACE_COLUMNS) is not None:
        lines = table.side_by_side(PLACE_COLUMNS)
    if lines is None or not on.all():
        return None
    (rows, i), (columns, j) = (np.unique(lines[:, k], return_inverse=True) for k in (0, 1))
    shape = len(rows), len(columns)
    if min(shape) < 2 or len(d) != shape[0] * shape[1] or len(np.unique(i * shape[1] + j)) < len(d):
        return None
    order = np.argsort(i * shape[1] + j)
    points, normals = (values[order].reshape(*shape, 3) for values in (feet.points, feet.normals))
    return DeviationGrid(points, normals, d[order].reshape(shape))


def _missing(table: PointTable, on: Array) -> tuple[int, int]:
    """Return the number of grid points without a deviation on the flank, and of all grid points; both 0 if the file
    does not number rows and columns."""
    lines = table.side_by_side(LINE_COLUMNS)
    if lines is None or not np.isfinite(lines).all():
        return 0, 0
    rows, columns = (np.unique(lines[:, k]).size for k in (0, 1))
    return max(rows * columns - int(on.sum()), 0), rows * columns


def _refuse_large(table: PointTable, d: Array) -> None:
    large = np.abs(d) > MAX_DEVIATION_MM
    if large.any():
        k = int(large.argmax())
        unit = next((name for name in DEVIATION_COLUMNS if name in table.columns), None)
        meant = " (deviation_um counts micrometres)" if unit == "deviation_um" else ""
        raise FileError(
            table.path,
            reason=f"line {table.lines[k]}: {1e3 * d[k]:.4g} um from the flank, at most {1e3 * MAX_DEVIATION_MM:g}{meant}",
        )


def _refuse_lengths(table: PointTable, lengths: Array) -> None:
    """Refuse normals along which a deviation would be longer or shorter than it was measured."""
    wrong = np.abs(lengths - 1.0) > LENGTH_TOLERANCE
    if wrong.any():
        k = int(wrong.argmax())
        raise FileError(
            table.path,
            reason=f"line {table.lines[k]}: nx,ny,nz have a length of {lengths[k]:.4g}: must be unit vectors",
        )


def _refuse_inward(table: PointTable, normals: Array, feet: FootPoints) -> None:
    inward = dot(normals, feet.normals) < 0.0
    if inward.any():
        raise FileError(
            table.path,
            reason=f"line {table.lines[int(inward.argmax())]}: nx,ny,nz point into the material, as {int(inward.sum())} of "
            f"{len(normals)} do: must point out of it",
        )


def _refuse_off(table: PointTable, places: Array) -> None:
    wrong = ~((places >= 0.0) & (places <= 1.0)).all(axis=1)
    if wrong.any():
        k = int(wrong.argmax())
        raise FileError(
            table.path, reason=f"line {table.lines[k]}: s,t = {places[k, 0]:g},{places[k, 1]:g}: allowed is from 0 to 1"
        )
