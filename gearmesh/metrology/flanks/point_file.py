"""Files of points on flanks: input and output of measuring machines.

The first line that is no comment names the columns; comments begin with #. Cells are separated by commas (.csv) or,
with another suffix, by blanks (.txt).

    flank,surface,row,column,s,t,x_mm,y_mm,z_mm,nx,ny,nz,...,deviation_um
    right,flank,1,1,0.1,0.1,23.14,-3.52,71.2,0.0934,-0.7704,-0.6307,...,-3.5

Points are in the member's own frame. Deviations are along the outward normals, positive where there is more material
than nominal. A measured file needs s, t and a deviation, or x, y, z. With a deviation x, y, z are nominal points,
without one they are measured points.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np

from gearmesh.design.shown import value_text
from gearmesh.errors import FileError
from gearmesh.files.csv_table import csv_rows, csv_text, refused_cell
from gearmesh.files.reading import BYTES_PER_MIB, file_text
from gearmesh.formats import CSV_SUFFIX
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.metrology.flanks.measuring_grid import MeasuringGrid
from gearmesh.numerals import parse_number, parse_numbers
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side

#: largest file, bytes: about 10^6 points
MAX_FILE_BYTES = 128 * BYTES_PER_MIB
#: shares of profile and face
PLACE_COLUMNS = ("s", "t")
#: coordinates of points
POINT_COLUMNS = ("x_mm", "y_mm", "z_mm")
#: components of unit normals
NORMAL_COLUMNS = ("nx", "ny", "nz")
#: numbers of grid rows and columns
LINE_COLUMNS = ("row", "column")
#: columns of deviations, and their unit in mm
DEVIATION_COLUMNS = {"deviation_um": 1e-3, "deviation_mm": 1.0}
#: columns of texts, and the words allowed in them
WORD_COLUMNS: Mapping[str, tuple[str, ...]] = {"flank": tuple(Side), "surface": ("flank", "fillet")}
#: columns that are written for the operator and not read
UNREAD_COLUMNS = ("diameter_mm", "roll_length_mm", "ball_x_mm", "ball_y_mm", "ball_z_mm")
#: all columns that a file may have
ALL_COLUMNS = (
    *WORD_COLUMNS,
    *LINE_COLUMNS,
    *PLACE_COLUMNS,
    *POINT_COLUMNS,
    *NORMAL_COLUMNS,
    *DEVIATION_COLUMNS,
    *UNREAD_COLUMNS,
)
#: cells of missing deviations: empty, or nan between blanks
MISSING_CELLS = ("", "nan")
#: largest coordinate, mm
MAX_COORDINATE_MM = 1e5


@dataclass(frozen=True)
class PointTable:
    """Rows of a file of points, N in number."""

    #: path of the file
    path: str
    #: columns (N,) of numbers by name; NaN for an empty cell
    columns: Mapping[str, Array]
    #: columns of texts by name
    words: Mapping[str, Sequence[str]]
    #: line numbers (N,) in the file
    lines: Array

    def of_flank(self, side: Side) -> PointTable:
        """Return the rows of one side's flank; all rows if the file has no columns that tell."""
        kept = np.ones(len(self.lines), dtype=bool)
        for name, allowed_word in (("flank", str(side)), ("surface", "flank")):
            if name in self.words:
                kept &= np.array([word == allowed_word for word in self.words[name]], dtype=bool)
        if not kept.any():
            raise FileError(self.path, reason=f"has no points of a {side} flank in its columns flank and surface")
        return PointTable(
            self.path,
            {name: values[kept] for name, values in self.columns.items()},
            {
                name: [word for word, keep in zip(words, kept, strict=True) if keep]
                for name, words in self.words.items()
            },
            self.lines[kept],
        )

    @property
    def deviations(self) -> Array | None:
        """Deviations (N,), mm; NaN for a point without one. None for a file of measured points."""
        name = next((name for name in DEVIATION_COLUMNS if name in self.columns), None)
        return None if name is None else DEVIATION_COLUMNS[name] * self.columns[name]

    def side_by_side(self, names: Sequence[str]) -> Array | None:
        """Return columns side by side, (N, K); None if one is missing."""
        if not all(name in self.columns for name in names):
            return None
        return np.stack([self.columns[name] for name in names], axis=-1)


def point_text(grids: Iterable[MeasuringGrid], comments: Sequence[str], ball: float | None, suffix: str) -> str:
    """Return the text of a file of grids, with centres of a probe's `ball` of this radius (mm). Reading it gives the
    same points to the last digit."""
    grids = list(grids)
    head = [*WORD_COLUMNS, *LINE_COLUMNS, *PLACE_COLUMNS, *POINT_COLUMNS, *NORMAL_COLUMNS]
    optional = {
        "diameter_mm": [grid.diameters for grid in grids],
        "roll_length_mm": [grid.roll_lengths for grid in grids],
    }
    head += [name for name, values in optional.items() if any(value is not None for value in values)]
    head += [] if ball is None else [name for name in UNREAD_COLUMNS if name.startswith("ball")]
    rows = [dict(zip(head, row, strict=False)) | extra for grid in grids for row, extra in _rows(grid, ball)]
    cells = [[row.get(name) for name in head] for row in rows]
    note = "".join(f"# {line}\n" for line in comments)
    if suffix == CSV_SUFFIX:
        return note + csv_text(head, cells)
    lines = [head, *([_cell(value) for value in row] for row in cells)]
    return note + "".join(f"{' '.join(line)}\n" for line in lines)


def _rows(grid: MeasuringGrid, ball: float | None) -> Iterable[tuple[list[object], dict[str, object]]]:
    centres = grid.points if ball is None else grid.probe_centres(ball)
    words = [str(grid.side), "fillet" if grid.fillet else "flank"]
    for i, s in enumerate(grid.s.tolist()):
        for j, t in enumerate(grid.t.tolist()):
            point, normal = (values[i, j].tolist() for values in (grid.points, grid.normals))
            extra: dict[str, object] = dict(zip(UNREAD_COLUMNS[2:], centres[i, j].tolist(), strict=True))
            for name, values in (("diameter_mm", grid.diameters), ("roll_length_mm", grid.roll_lengths)):
                if values is not None:
                    extra[name] = float(values[i, j])
            yield [*words, i + 1, j + 1, s, t, *point, *normal], extra


def _cell(value: object) -> str:
    return MISSING_CELLS[1] if value is None else str(value)


def read_points(path: Path) -> PointTable:
    """Read the points of a file. Raises FileError that names the file, the line and what is allowed."""
    text = file_text(path, MAX_FILE_BYTES, "file of points")
    lines = [
        (number, row)
        for number, row in (csv_rows(text, path) if path.suffix.lower() == CSV_SUFFIX else _blank_rows(text))
        if not row[0].lstrip().startswith("#")
    ]
    if not lines:
        raise FileError(path, reason="has no line with the names of columns")
    (_, head), rows = lines[0], lines[1:]
    head = [name.strip() for name in head]
    _refuse_head(path, head)
    for number, row in rows:
        if len(row) != len(head):
            raise FileError(path, reason=f"line {number}: {len(row)} cells, must be {len(head)}, as many as columns")
    if not rows:
        raise FileError(path, reason="has no points")
    numbers = np.array([number for number, _ in rows])
    cells = {name: [row[k] for _, row in rows] for k, name in enumerate(head)}
    words = {name: [cell.strip() for cell in cells[name]] for name in WORD_COLUMNS if name in cells}
    for name, column in words.items():
        for number, word in zip(numbers, column, strict=True):
            if word not in WORD_COLUMNS[name]:
                raise FileError(
                    path,
                    reason=f"line {number}: {name} = {value_text(word)}: must be {' or '.join(WORD_COLUMNS[name])}",
                )
    columns = {
        name: _numbers(path, name, numbers, cells[name])
        for name in head
        if name not in (*WORD_COLUMNS, *UNREAD_COLUMNS)
    }
    return PointTable(str(path), columns, words, numbers)


def _blank_rows(text: str) -> Iterable[tuple[int, list[str]]]:
    return ((number, line.split()) for number, line in enumerate(text.splitlines(), 1) if line.strip())


def _refuse_head(path: Path, head: Sequence[str]) -> None:
    unknown = next((name for name in head if name not in ALL_COLUMNS), None)
    if not set(head) & set(ALL_COLUMNS):
        # points without a head, or another format, as PLY
        line, example = value_text(" ".join(head)), " ".join(POINT_COLUMNS)
        raise FileError(
            path,
            reason=f"the first line {line} names no column: it must name each, as {example}",
            remedy=f"allowed are {', '.join(ALL_COLUMNS)}",
        )
    if unknown is not None or len(set(head)) < len(head):
        named = value_text(max(head, key=head.count) if unknown is None else unknown)
        raise FileError(path, reason=f"column {named}: allowed, each once: {', '.join(ALL_COLUMNS)}")
    with_deviation = [name for name in DEVIATION_COLUMNS if name in head]
    if len(with_deviation) == 2:
        raise FileError(path, reason=f"allowed is one of the columns {' and '.join(with_deviation)}")
    places, points = (all(name in head for name in names) for names in (PLACE_COLUMNS, POINT_COLUMNS))
    if not (points or (places and with_deviation)):
        raise FileError(path, reason="needs the columns x_mm, y_mm, z_mm, or s, t and deviation_um")


def _numbers(path: Path, name: str, lines: Array, cells: Sequence[str]) -> Array:
    """Return a column of numbers; deviations may be missing."""
    missing = np.array(
        [name in DEVIATION_COLUMNS and cell.strip().lower() in MISSING_CELLS for cell in cells], dtype=bool
    )
    present_cells = [cell for cell, left_out in zip(cells, missing, strict=True) if not left_out]
    values = np.full(len(cells), math.nan)
    try:
        values[~missing] = parse_numbers(present_cells)
    except ValueError:
        values[~missing] = [math.inf if (value := parse_number(cell)) is None else value for cell in present_cells]
    wrong = ~(np.abs(values) <= MAX_COORDINATE_MM) & ~missing
    if wrong.any():
        k = int(wrong.argmax())
        raise refused_cell(path, lines[k], name, cells[k], "a finite number")
    return values
