"""Files of pitch deviations tooth by tooth, and of runout.

    tooth,right_um,left_um,runout_um
    0,0.0,0.0,2.1

Index deviations are distances of each tooth's flank from its place, on the circle of the standard, positive in the
direction of increasing angle. Runout is the outward displacement of a ball in the space before the tooth. Some of the
three columns may be missing.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmesh.errors import FileError
from gearmesh.files.csv_table import cell_number, csv_rows, refused_cell
from gearmesh.files.reading import BYTES_PER_MIB, file_text
from gearmesh.metrology.pitch import MeasuredPitch, PitchDeviations
from gearmesh.teeth.region import Side

#: name of the column of tooth numbers
TOOTH_COLUMN = "tooth"
#: name of the column of runout, um
RUNOUT_COLUMN = "runout_um"
#: side of a column of index deviations, um
SIDE_OF_COLUMN = {f"{side}_um": side for side in Side}
#: mm in a um
MM_PER_UM = 1e-3
#: largest amount of a deviation, um
MAX_DEVIATION_UM = 1000.0


def read_pitch(path: Path, teeth: int) -> MeasuredPitch:
    """Read the pitch deviations and runout of a gear with `teeth` teeth. Raises FileError that names the file, the line
    and what is allowed."""
    lines = csv_rows(file_text(path, BYTES_PER_MIB, "pitch deviations"), path)
    head = [name.strip() for name in next(lines, (1, []))[1]]
    columns = head[1:]
    if (
        head[:1] != [TOOTH_COLUMN]
        or not columns
        or not {*columns} <= {*SIDE_OF_COLUMN, RUNOUT_COLUMN}
        or len({*columns}) < len(columns)
    ):
        raise FileError(
            path,
            reason=f"line 1: allowed is {TOOTH_COLUMN}, and {', '.join(SIDE_OF_COLUMN)} and {RUNOUT_COLUMN}, or some of them",
        )
    values = np.full((teeth, len(columns)), np.nan)
    for number, row in lines:
        if len(row) != len(head):
            raise FileError(
                path, reason=f"line {number}: must be a tooth from 0 to {teeth - 1} and {len(columns)} numbers, um"
            )
        tooth, *um = (cell_number(path, number, name, cell) for name, cell in zip(head, row, strict=True))
        if tooth not in range(teeth):
            raise refused_cell(path, number, TOOTH_COLUMN, row[0], f"a tooth from 0 to {teeth - 1}, 0 is on x")
        if np.abs(um).max() > MAX_DEVIATION_UM:
            raise FileError(
                path, reason=f"line {number}: {max(um, key=abs):g} um, at most {MAX_DEVIATION_UM:g} in size"
            )
        if np.isfinite(values[int(tooth)]).any():
            raise FileError(path, reason=f"line {number}: tooth {int(tooth)} is given twice")
        values[int(tooth)] = um
    if np.isnan(values).any():
        missing = int(np.flatnonzero(np.isnan(values).any(axis=1))[0])
        raise FileError(path, reason=f"has no tooth {missing}; the gear has {teeth}, counted from 0")
    mm = {name: MM_PER_UM * values[:, k] for k, name in enumerate(columns)}
    sides = {SIDE_OF_COLUMN[name]: PitchDeviations(index) for name, index in mm.items() if name in SIDE_OF_COLUMN}
    return MeasuredPitch(sides, mm.get(RUNOUT_COLUMN))
