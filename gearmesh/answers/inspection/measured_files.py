"""What files say of a measured gear: flanks as the table `measured` of a design reads them, and pitch deviations tooth by tooth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gearmesh.answers.inspection.inspection import Inspection, inspect
from gearmesh.design.core import Design
from gearmesh.design.measured import MeasuredTable
from gearmesh.errors import ArgumentError
from gearmesh.files.reading import refuse_missing
from gearmesh.metrology.flanks.measured_field import MeasuredField
from gearmesh.metrology.flanks.measured_flank import MeasuredFlank, MeasuringMode, measured_flanks
from gearmesh.metrology.flanks.measured_members import MeasuredPlaces
from gearmesh.metrology.flanks.point_file import read_points
from gearmesh.metrology.measured_teeth import MeasuredTeeth
from gearmesh.metrology.pitch_file import read_pitch
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.region import Side

#: both flanks
BOTH = "both"


def inspect_files(
    design: Design, name: str, flanks: Path | None, flank: str = BOTH, pitch: Path | None = None
) -> Inspection:
    """A member of a design, against its nominal teeth: `flanks`, a file of deviations or points of the `flank` "right", "left" or
    "both", those that it has; by default what the table `measured` of the design names; `pitch`: a file of index deviations, by
    default what that table says of them.

    Raises DesignError for a member or flank that there is not and where nothing is given, FileError for what cannot be read.
    """
    places = MeasuredPlaces(design)
    if pitch is not None:
        refuse_missing(pitch)
    nominal, train, made = flanks_of_files(design, name, flanks, flank, needed=pitch is None and not places.says(name))
    tooth = train.members[name].one_tooth
    fields = {side: MeasuredField.of(tooth, side, own_flank) for side, own_flank in made.items()}
    teeth = MeasuredTeeth(fields)
    if pitch is not None or places.says(name):
        inspection = systems.system_of(nominal).inspection
        basis = None if inspection is None else inspection(nominal, train, name)
        own = places.pitch(name, tooth.teeth, basis) if pitch is None else read_pitch(pitch, tooth.teeth)
        teeth = replace(teeth, pitch=own.sides, runout=own.runout)
    answer = inspect(nominal, train, name, teeth)
    return replace(answer, notes=tuple(f"{side} flank: {note}" for side in made for note in made[side].notes))


def flanks_of_files(
    design: Design, name: str, flanks: Path | None, flank: str = BOTH, *, needed: bool = True
) -> tuple[Design, GearTrain, dict[Side, MeasuredFlank]]:
    """The design without measured flanks, its gear set, and what a file, or the design's own, says of the flanks of a member.

    Raises as `inspect_files`; where files are `needed`, also where there are none.
    """
    table: MeasuredTable | None = getattr(design, "measured", None)
    nominal = design if table is None else design.model_copy(update={"measured": None})
    if nominal.member_names is not None:
        nominal.member_names.refuse_other_member(name)
    own = design.table_named(name)
    files = _of_table(design, own) if flanks is None else dict.fromkeys(_sides(flanks, flank), flanks)
    if not files and needed:
        raise ArgumentError(
            "measured",
            reason="missing",
            allowed=f"a file, or measured.{own}_right and measured.{own}_left of the design",
        )
    train = systems.build(nominal)
    train.names.refuse_other_member(name)
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
