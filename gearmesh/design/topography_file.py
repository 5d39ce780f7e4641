"""Topographies as CSV files: a row for every point of a grid over the profile and the face.

    roll_length_mm,z_mm,amount_um          or          diameter_mm,z_mm,amount_um
    4.0,-10.0,3.5

z is counted along the gear's axis from the middle of the face; amounts are positive where material is removed.
"""

from __future__ import annotations

import math
from pathlib import Path

from gearmesh.design.keys import LARGEST_LENGTH_MM
from gearmesh.design.modifications import MAX_AMOUNT_MM
from gearmesh.design.shown import value_text
from gearmesh.errors import FileError
from gearmesh.files.csv_table import cell_number, csv_rows, csv_text
from gearmesh.files.reading import BYTES_PER_MIB, file_text
from gearmesh.records import dataclass

#: columns of the position on the profile, by roll length or by diameter
PROFILE_COLUMNS = ("roll_length_mm", "diameter_mm")
#: columns of the position on the face and of the amount
OTHER_COLUMNS = ["z_mm", "amount_um"]
#: largest file: some 300,000 amounts
MAX_FILE_BYTES = 16 * BYTES_PER_MIB


@dataclass(frozen=True)
class TopographyGrid:
    """Amounts of removed material on a grid over profile and face."""

    #: roll lengths or diameters (I,), mm, ascending
    across: tuple[float, ...]
    #: positions (J,), mm, on the face, ascending
    z: tuple[float, ...]
    #: amounts (I, J), mm
    amounts: tuple[tuple[float, ...], ...]
    #: True if `across` holds diameters
    diameters: bool = False


def topography_text(grid: TopographyGrid) -> str:
    """Return the text of a file that reads back to the same grid, to the last digit."""
    rows = (
        (float(x), float(z), 1e3 * float(amount))
        for x, amounts in zip(grid.across, grid.amounts, strict=True)
        for z, amount in zip(grid.z, amounts, strict=True)
    )
    return csv_text([PROFILE_COLUMNS[grid.diameters], *OTHER_COLUMNS], rows)


def read_topography(path: Path) -> TopographyGrid:
    """Return the grid of a file. Raises FileError with file, line and the allowed form."""
    lines = csv_rows(file_text(path, MAX_FILE_BYTES, "topography"), path)
    head = [name.strip() for name in next(lines, (1, []))[1]]
    if len(head) != 3 or head[0] not in PROFILE_COLUMNS or head[1:] != OTHER_COLUMNS:
        heads = (",".join((first, *OTHER_COLUMNS)) for first in PROFILE_COLUMNS)
        raise FileError(path, reason=f"line 1: allowed is {' or '.join(heads)}")
    points: dict[tuple[float, float], float] = {}
    for number, row in lines:
        across, z, amount = _numbers(path, number, head, row)
        if (
            not (
                0.0 <= across <= LARGEST_LENGTH_MM
                and abs(z) <= LARGEST_LENGTH_MM
                and abs(amount) <= 1e3 * MAX_AMOUNT_MM
            )
            or (across, z) in points
        ):
            raise FileError(
                path,
                reason=f"line {number}: {value_text(','.join(row))}: a line needs three numbers, with each place once, places "
                f"up to {LARGEST_LENGTH_MM:.7g} mm and amounts up to {1000.0 * MAX_AMOUNT_MM:g} um",
            )
        points[across, z] = 1e-3 * amount
    first, second = (tuple(sorted({place[k] for place in points})) for k in (0, 1))
    if len(first) < 2 or len(second) < 2 or len(points) != len(first) * len(second):
        raise FileError(
            path,
            reason=f"{len(points)} amounts at {len(first)} places across the profile and {len(second)} along the "
            "face; the file must have one for each of them, a full grid of at least 2 x 2",
        )
    amounts = tuple(tuple(points[x, z] for z in second) for x in first)
    return TopographyGrid(first, second, amounts, head[0] == PROFILE_COLUMNS[1])


def _numbers(path: Path, line: int, head: list[str], row: list[str]) -> tuple[float, float, float]:
    """Return the numbers of a line; NaN if it has not three cells."""
    if len(row) != len(head):
        return math.nan, math.nan, math.nan
    across, z, amount = (cell_number(path, line, name, cell) for name, cell in zip(head, row, strict=True))
    return across, z, amount
