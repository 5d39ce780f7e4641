"""What files say of a measured gear: flanks as the table `measured` of a design reads them, and pitch deviations tooth by tooth.

tooth,right_um,left_um        index deviations: how far the flank of each tooth is from its place, on the circle
0,0.0,0.0                     of the standard, as angles grow; either side may be missing
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from gearmesh.answers.inspection.inspection import Inspection, inspect
from gearmesh.design.core import Design
from gearmesh.design.measured import MeasuredTable
from gearmesh.errors import ArgumentError, FileError
from gearmesh.files.csv_table import csv_rows
from gearmesh.files.reading import MIB, file_text
from gearmesh.metrology.flanks.measured_field import MeasuredField
from gearmesh.metrology.flanks.measured_flank import MeasuredFlank, MeasuringMode, measured_flanks
from gearmesh.metrology.flanks.point_file import read_points
from gearmesh.metrology.measured_teeth import MeasuredTeeth
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.region import Side

#: both flanks
BOTH = "both"
TOOTH, UM_OF = "tooth", {f"{side}_um": side for side in Side}


def inspect_files(
    design: Design, name: str, flanks: Path | None, flank: str = BOTH, pitch: Path | None = None
) -> Inspection:
    """A member of a design, against its nominal teeth: `flanks`, a file of deviations or points of the `flank` "right", "left" or
    "both", those that it has; by default what the table `measured` of the design names; `pitch`: a file of index deviations.

    Raises DesignError for a member or flank that there is not and where nothing is given, FileError for what cannot be read.
    """
    nominal, train, made = flanks_of_files(design, name, flanks, flank, needed=pitch is None)
    tooth = train.members[name].one_tooth
    fields = {side: MeasuredField.of(tooth, side, own_flank) for side, own_flank in made.items()}
    answer = inspect(
        nominal, train, name, MeasuredTeeth(fields, {} if pitch is None else read_pitch(pitch, tooth.teeth))
    )
    return replace(answer, notes=tuple(f"{side} flank: {note}" for side in made for note in made[side].notes))


def flanks_of_files(
    design: Design, name: str, flanks: Path | None, flank: str = BOTH, *, needed: bool = True
) -> tuple[Design, GearTrain, dict[Side, MeasuredFlank]]:
    """The design without measured flanks, its gear set, and what a file, or the design's own, says of the flanks of a member.

    Raises as `inspect_files`; where files are `needed`, also where there are none.
    """
    table: MeasuredTable | None = getattr(design, "measured", None)
    nominal = design if table is None else design.model_copy(update={"measured": None})
    train = systems.build(nominal)
    if name not in train.members:
        raise ArgumentError("member", name, must_be=f"one of {', '.join(train.members)}")
    own = design.table_named(name)
    files = _of_table(design, own) if flanks is None else dict.fromkeys(_sides(flanks, flank), flanks)
    if not files and needed:
        raise ArgumentError(
            "measured",
            reason="missing",
            allowed=f"a file, or measured.{own}_right and measured.{own}_left of the design",
        )
    mode = MeasuringMode() if table is None else MeasuringMode(table.axial_position == "free", table.stiffness)
    keys = {side: "measured" if flanks else f"measured.{own}_{side}" for side in Side}
    made = measured_flanks(train.members[name].one_tooth, files, mode, keys) if files else {}
    return nominal, train, made


def _of_table(design: Design, own: str) -> dict[Side, Path]:
    """The files of a member's flanks that a design names."""
    named = {side: getattr(getattr(design, "measured", None), f"{own}_{side}", None) for side in Side}
    return {side: Path(file) for side, file in named.items() if file}


def _sides(path: Path, flank: str) -> list[Side]:
    """The flanks asked for: of both those that the file's column flank has."""
    if flank in tuple(Side):
        return [Side(flank)]
    if flank != BOTH:
        raise ArgumentError("flank", flank, must_be=f"one of {', '.join(Side)}, {BOTH}")
    words = read_points(path).words.get("flank")
    if words is None:
        raise ArgumentError(
            "flank",
            flank,
            reason="the file has no column flank that says which points are of which",
            allowed="right, left",
        )
    return [side for side in Side if str(side) in words]


def read_pitch(path: Path, teeth: int) -> dict[Side, PitchDeviations]:
    """Index deviations of the sides that a file has. Raises FileError naming file, line and what is wanted."""
    lines = csv_rows(file_text(path, MIB, "pitch deviations"), path)
    head = [name.strip() for name in next(lines, (1, []))[1]]
    sides = [UM_OF[name] for name in head[1:] if name in UM_OF]
    if head[:1] != [TOOTH] or not sides or len(sides) != len(head) - 1 or len(set(sides)) < len(sides):
        raise FileError(path, reason=f"line 1: allowed is {TOOTH}, and {' or '.join(UM_OF)} or both")
    index = np.full((teeth, len(sides)), np.nan)
    for number, row in lines:
        try:
            tooth, *um = (float(cell) for cell in row)
        except ValueError:
            tooth, um = np.nan, []
        if len(um) != len(sides) or not np.isfinite(um).all() or tooth not in range(teeth):
            raise FileError(
                path, reason=f"line {number}: must be a tooth from 0 to {teeth - 1} and {len(sides)} numbers, um"
            )
        index[int(tooth)] = um
    if np.isnan(index).any():
        missing = int(np.flatnonzero(np.isnan(index).any(axis=1))[0])
        raise FileError(path, reason=f"has no tooth {missing}; the gear has {teeth}, counted from 0")
    return {side: PitchDeviations(1e-3 * index[:, k]) for k, side in enumerate(sides)}


def pitch_text(pitch: Mapping[Side, PitchDeviations]) -> str:
    """The file that reads back to pitch deviations."""
    from gearmesh.files.csv_table import csv_text

    sides = [side for side in Side if side in pitch]
    rows = np.column_stack([1e3 * pitch[side].index for side in sides])
    return csv_text([TOOTH, *(f"{side}_um" for side in sides)], ([k, *row] for k, row in enumerate(rows.tolist())))
