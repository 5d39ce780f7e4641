"""Topographies as CSV files: a row for every point of a grid over the profile and the face.

    roll_length_mm,z_mm,amount_um          or          diameter_mm,z_mm,amount_um
    4.0,-10.0,3.5

z is counted along the gear's axis from the middle of the face; amounts are positive where material is removed.
"""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

from gearmesh.errors import DesignError

ACROSS = ("roll_length_mm", "diameter_mm")
OTHERS = ["z_mm", "amount_um"]


@dataclass(frozen=True)
class TopographyGrid:
    """Amounts (I, J), mm, at places across the profile (I,), roll lengths or `diameters`, and positions z (J,), mm, ascending."""

    across: tuple[float, ...]
    z: tuple[float, ...]
    amounts: tuple[tuple[float, ...], ...]
    diameters: bool = False


def topography_text(grid: TopographyGrid) -> str:
    """The file that reads back to a grid, to the last digit."""
    lines = [",".join([ACROSS[grid.diameters], *OTHERS])]
    for x, amounts in zip(grid.across, grid.amounts, strict=True):
        lines += [
            f"{float(x)!r},{float(z)!r},{1e3 * float(amount)!r}" for z, amount in zip(grid.z, amounts, strict=True)
        ]
    return "\n".join(lines) + "\n"


def read_topography(path: Path) -> TopographyGrid:
    """The grid in a file. Raises DesignError naming file, line and what is wanted."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise DesignError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or 'not UTF-8 text'}") from None
    head, *rows = [row for row in csv.reader(text.splitlines()) if row] or [[]]
    head = [name.strip() for name in head]
    if len(head) != 3 or head[0] not in ACROSS or head[1:] != OTHERS:
        raise DesignError(
            f"{path}: line 1: allowed is {ACROSS[0]},{','.join(OTHERS)} or {ACROSS[1]},{','.join(OTHERS)}"
        )
    points: dict[tuple[float, float], float] = {}
    for number, row in enumerate(rows, start=2):
        try:
            across, z, amount = map(float, row)
        except ValueError:
            across = z = amount = math.nan
        if not all(map(math.isfinite, (across, z, amount))) or (across, z) in points:
            raise DesignError(f"{path}: row {number}: {','.join(row)}: wanted are three numbers, each place once")
        points[across, z] = 1e-3 * amount
    first, second = (tuple(sorted({place[k] for place in points})) for k in (0, 1))
    if len(first) < 2 or len(second) < 2 or len(points) != len(first) * len(second):
        raise DesignError(
            f"{path}: {len(points)} amounts at {len(first)} places across the profile and {len(second)} along the face; "
            "wanted is one for every pair of them, of at least 2 x 2"
        )
    amounts = tuple(tuple(points[x, z] for z in second) for x in first)
    return TopographyGrid(first, second, amounts, head[0] == ACROSS[1])
