"""Files of pitch deviations tooth by tooth, and of runout.

tooth,right_um,left_um,runout_um      index deviations: how far the flank of each tooth is from its place, on the circle of the
0,0.0,0.0,2.1                         standard, as angles grow; runout: how far outwards a ball rests in the space before the tooth;
                                      any of them may be missing
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from gearmesh.errors import FileError
from gearmesh.files.csv_table import cell_number, csv_rows, refused_cell
from gearmesh.files.reading import BYTES_PER_MIB, file_text
from gearmesh.metrology.pitch import MeasuredPitch, PitchDeviations
from gearmesh.teeth.region import Side

TOOTH, RUNOUT = "tooth", "runout_um"
UM_OF = {f"{side}_um": side for side in Side}
#: mm in a um, and largest deviation, um
UM, MOST = 1e-3, 1000.0


def read_pitch(path: Path, teeth: int) -> MeasuredPitch:
    """What a file has of the teeth of a gear. Raises FileError naming file, line and what is wanted."""
    lines = csv_rows(file_text(path, BYTES_PER_MIB, "pitch deviations"), path)
    head = [name.strip() for name in next(lines, (1, []))[1]]
    columns = head[1:]
    if head[:1] != [TOOTH] or not columns or not {*columns} <= {*UM_OF, RUNOUT} or len({*columns}) < len(columns):
        raise FileError(
            path, reason=f"line 1: allowed is {TOOTH}, and {', '.join(UM_OF)} and {RUNOUT}, or some of them"
        )
    values = np.full((teeth, len(columns)), np.nan)
    for number, row in lines:
        if len(row) != len(head):
            raise FileError(
                path, reason=f"line {number}: must be a tooth from 0 to {teeth - 1} and {len(columns)} numbers, um"
            )
        tooth, *um = (cell_number(path, number, name, cell) for name, cell in zip(head, row, strict=True))
        if tooth not in range(teeth):
            raise refused_cell(path, number, TOOTH, row[0], f"a tooth from 0 to {teeth - 1}")
        if np.abs(um).max() > MOST:
            raise FileError(path, reason=f"line {number}: {max(um, key=abs):g} um, at most {MOST:g} in size")
        if np.isfinite(values[int(tooth)]).any():
            raise FileError(path, reason=f"line {number}: tooth {int(tooth)} is given twice")
        values[int(tooth)] = um
    if np.isnan(values).any():
        missing = int(np.flatnonzero(np.isnan(values).any(axis=1))[0])
        raise FileError(path, reason=f"has no tooth {missing}; the gear has {teeth}, counted from 0")
    mm = {name: UM * values[:, k] for k, name in enumerate(columns)}
    sides = {UM_OF[name]: PitchDeviations(own) for name, own in mm.items() if name in UM_OF}
    return MeasuredPitch(sides, mm.get(RUNOUT))
