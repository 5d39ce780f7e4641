"""Real flanks: what a file of measured points says of the flanks of a member, and the teeth that have them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from gearmesh.errors import DesignError, FileError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.metrology.flanks.alignment import align
from gearmesh.metrology.flanks.point_file import DEVIATIONS, LINES, NORMALS, PLACES, POINTS, PointTable, read_points
from gearmesh.metrology.flanks.projection import FlankProjection, FootPoints
from gearmesh.metrology.flanks.smoothing import SmoothDeviations, smooth_deviations
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid, deviating_tooth, lowest_share
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: largest deviation, mm, and largest of a file all of whose are so small that they may have been meant in mm
MOST, MEANT_IN_MM = 1.0, 2e-5
#: points of a flank at least
FEWEST = 4
#: shares of the flank beyond its ends by which points may be off it
BEYOND = 0.02
#: outliers that a message names
NAMED = 3


@dataclass(frozen=True)
class MeasuringMode:
    """How files are read: with the `axial` position free, `stiffness` of smoothing (None: by cross-validation; 0 goes through all
    points of a whole grid)."""

    axial: bool = False
    stiffness: float | None = None


@dataclass(frozen=True)
class MeasuredFlank:
    """Deviations of a flank: the `grid` that it takes, what was measured at foot points, and how: the `smooth` spline through them
    where they are no whole grid, rotation (rad) and shift (mm) of measured points."""

    grid: DeviationGrid
    feet: FootPoints
    deviations: Array
    smooth: SmoothDeviations | None
    rotation: float = 0.0
    shift: float = 0.0
    notes: tuple[str, ...] = ()


def with_measured_flanks(
    member: Member, files: Mapping[Side, Path], mode: MeasuringMode, keys: Mapping[Side, str]
) -> tuple[Member, tuple[str, ...]]:
    """The member with the flanks that files say, and what is to be noted of these; `keys` name them in refusals.

    Raises FileError for what is no file of points, DesignError for points that do not fit, or that make no tooth.
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
    """What files say of the flanks of a tooth. Raises as `with_measured_flanks`."""
    tables = {side: read_points(path).of_flank(side) for side, path in files.items()}
    free = {side: table for side, table in tables.items() if _in_space(table)}
    flanks = {side: _of_deviations(tooth, side, table, mode) for side, table in tables.items() if side not in free}
    # points of both flanks in one file are laid on the tooth together
    for path in dict.fromkeys(files[side] for side in free):
        together = {side: table for side, table in free.items() if files[side] == path}
        flanks |= _of_points(tooth, together, mode, keys)
    return {side: flanks[side] for side in files}


def _in_space(table: PointTable) -> bool:
    """Whether a file has measured points, not deviations."""
    return table.deviations is None


def _of_points(
    tooth: Tooth, tables: Mapping[Side, PointTable], mode: MeasuringMode, keys: Mapping[Side, str]
) -> dict[Side, MeasuredFlank]:
    points = {side: table.side_by_side(POINTS) for side, table in tables.items()}
    try:
        fit = align(tooth, {side: own for side, own in points.items() if own is not None}, axial=mode.axial)
    except DesignError as failure:
        raise DesignError(keys[next(iter(tables))], reason=str(failure)) from failure
    flanks = {}
    for side, feet in fit.feet.items():
        made = _flank(tooth, side, tables[side], feet, feet.distances, mode)
        flanks[side] = replace(made, rotation=fit.rotation, shift=fit.shift)
    return flanks


def _of_deviations(tooth: Tooth, side: Side, table: PointTable, mode: MeasuringMode) -> MeasuredFlank:
    d, points, normals = table.deviations, table.side_by_side(POINTS), table.side_by_side(NORMALS)
    assert d is not None
    given = np.isfinite(d)
    if given.sum() < FEWEST:
        raise FileError(table.path, reason=f"{int(given.sum())} deviations of the {side} flank, at least {FEWEST}")
    _refuse_large(table, d)
    if points is None:
        places = table.side_by_side(PLACES)
        assert places is not None
        _refuse_off(table, places)
        feet = _at_shares(tooth, side, places)
        return _flank(tooth, side, table, feet, d, mode)
    # a point is where its deviation takes it; without one it stays
    moved = points if normals is None else points + np.where(given, d, 0.0)[:, None] * normals
    feet = FlankProjection(tooth, side).foot_points(moved)
    if normals is not None:
        _refuse_inward(table, normals, feet)
    values = feet.distances + (d if normals is None else np.where(given, 0.0, np.nan))
    return _flank(tooth, side, table, feet, values, mode)


def _at_shares(tooth: Tooth, side: Side, places: Array) -> FootPoints:
    """The points of a flank at shares (N, 2) of profile and face."""
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
    on = np.isfinite(d)
    for share in (feet.s, feet.t):
        on &= (share > -BEYOND) & (share < 1.0 + BEYOND)
    if on.sum() < FEWEST:
        raise FileError(
            table.path, reason=f"{int(on.sum())} of {len(d)} points lie on the {side} flank, at least {FEWEST}"
        )
    notes = []
    off = int((np.isfinite(d) & ~on).sum())
    if off:
        notes.append(f"{off} of {len(d)} points lie beside the flank and are left out")
    if np.abs(d[on]).max() < MEANT_IN_MM and np.abs(d[on]).max() > 0.0:
        notes.append(f"all deviations are below {1e3 * MEANT_IN_MM:g} um: were they meant in mm?")
    whole = _whole_grid(table, feet, d, on) if mode.stiffness in (None, 0.0) else None
    missing, every = _missing(table, on)
    if missing and whole is None:
        notes.append(
            f"{missing} of {every} points of its grid have no deviation: the flank is the spline that bends least near the others"
        )
    smooth = smooth_deviations(feet.s[on], feet.t[on], d[on], mode.stiffness)
    far = np.flatnonzero(on)[smooth.outliers]
    if far.size:
        named = ", ".join(f"line {table.lines[k]} ({1e3 * d[k]:.1f} um)" for k in far[:NAMED])
        more = f" and {far.size - NAMED} more" if far.size > NAMED else ""
        notes.append(f"far from their neighbours: {named}{more}")
    if whole is not None:
        return MeasuredFlank(whole, feet, d, None, notes=tuple(notes))
    # beside its edges the flank has no points, and where they fade towards the root deviations are not taken
    s, t = smooth.inside(lowest_share(tooth, side))
    nominal = tooth.flank_grid(side, s, t)
    grid = DeviationGrid(nominal.points, nominal.normals, smooth.at(s, t))
    return MeasuredFlank(grid, feet, d, smooth, notes=tuple(notes))


def _whole_grid(table: PointTable, feet: FootPoints, d: Array, on: Array) -> DeviationGrid | None:
    """The points as a grid, where the file numbers its rows and columns and none is missing."""
    lines = table.side_by_side(LINES)
    if lines is None and table.side_by_side(PLACES) is not None:
        lines = table.side_by_side(PLACES)
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
    """How many points of a grid, whose rows and columns the file numbers, have no deviation on the flank, and how many it has; none
    without such numbers."""
    lines = table.side_by_side(LINES)
    if lines is None or not np.isfinite(lines).all():
        return 0, 0
    rows, columns = (np.unique(lines[:, k]).size for k in (0, 1))
    return max(rows * columns - int(on.sum()), 0), rows * columns


def _refuse_large(table: PointTable, d: Array) -> None:
    large = np.abs(d) > MOST
    if large.any():
        k = int(large.argmax())
        unit = next((name for name in DEVIATIONS if name in table.columns), None)
        meant = " (deviation_um counts micrometres)" if unit == "deviation_um" else ""
        raise FileError(
            table.path,
            reason=f"line {table.lines[k]}: {1e3 * d[k]:.4g} um from the flank, at most {1e3 * MOST:g}{meant}",
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
