"""Measured gears from files: flanks as in the table `measured` of a design, and pitch deviations tooth by tooth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from gearmesh.answers.inspection.inspection import Inspection, inspect
from gearmesh.design.core import Design
from gearmesh.design.measured import MeasuredTable
from gearmesh.errors import ArgumentError
from gearmesh.files.reading import refuse_missing
from gearmesh.metrology.flanks.measured_field import MeasuredField
from gearmesh.metrology.flanks.measured_flank import MeasuredFlank, measured_flanks
from gearmesh.metrology.flanks.measured_members import MeasuredPlaces, flank_files, flank_keys, measuring_mode
from gearmesh.metrology.flanks.point_file import read_points
from gearmesh.metrology.measured_teeth import MeasuredTeeth
from gearmesh.metrology.pitch_file import read_pitch
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.region import Side

#: value of `flank` for both flanks
BOTH_FLANKS = "both"


def inspect_files(
    design: Design, name: str, flanks: Path | None, flank: str = BOTH_FLANKS, pitch: Path | None = None
) -> Inspection:
    """Return the inspection of a member of a design, compared with its nominal teeth.

    - `flanks`: a file of deviations or points; by default the files in the table `measured` of the design.
    - `flank`: "right" or "left", or "both" for all that the file or the table has.
    - `pitch`: a file of index deviations; by default those of the table `measured`.

    Raises DesignError for an unknown member or flank and if nothing is given, and FileError for an unreadable file.
    """
    places = MeasuredPlaces(design)
    if pitch is not None:
        refuse_missing(pitch)
    nominal, train, measured = flanks_of_files(
        design, name, flanks, flank, needed=pitch is None and not places.says(name)
    )
    tooth = train.members[name].one_tooth
    fields = {side: MeasuredField.of(tooth, side, own_flank) for side, own_flank in measured.items()}
    teeth = MeasuredTeeth(fields)
    if pitch is not None or places.says(name):
        inspection = systems.system_of(nominal).inspection
        basis = None if inspection is None else inspection(nominal, train, name)
        pitch_deviations = places.pitch(name, tooth.teeth, basis) if pitch is None else read_pitch(pitch, tooth.teeth)
        teeth = replace(teeth, pitch=pitch_deviations.sides, runout=pitch_deviations.runout)
    answer = inspect(nominal, train, name, teeth)
    return replace(answer, notes=tuple(f"{side} flank: {note}" for side in measured for note in measured[side].notes))


def flanks_of_files(
    design: Design, name: str, flanks: Path | None, flank: str = BOTH_FLANKS, *, needed: bool = True
) -> tuple[Design, GearTrain, dict[Side, MeasuredFlank]]:
    """Return the design without measured flanks, its gear set, and the measured flanks of a member by side.

    The flanks come from a file or from the files that the design names. Raises the errors of `inspect_files`, also if
    no file is given although files are `needed`.
    """
    table: MeasuredTable | None = getattr(design, "measured", None)
    nominal = design if table is None else design.model_copy(update={"measured": None})
    if nominal.member_names is not None:
        nominal.member_names.refuse_other_member(name)
    table_name = design.table_named(name)
    keys = flank_keys(table_name)
    wanted = _wanted(flank)
    if flanks is None:
        files = {side: file for side, file in flank_files(design, table_name).items() if side in wanted}
    else:
        files = dict.fromkeys(wanted if len(wanted) == 1 else _sides(flanks), flanks)
    if not files and needed:
        allowed = f"a file, or {' and '.join(keys[side] for side in wanted)} of the design"
        raise ArgumentError("measured", reason="missing", allowed=allowed)
    train = systems.build(nominal)
    train.names.refuse_other_member(name)
    sources = dict.fromkeys(Side, "measured") if flanks else keys
    tooth = train.members[name].one_tooth
    made = measured_flanks(tooth, files, measuring_mode(table), sources) if files else {}
    return nominal, train, made


def _wanted(flank: str) -> tuple[Side, ...]:
    """Return the flanks that are asked for. Raises ArgumentError for a word that is none."""
    if flank == BOTH_FLANKS:
        return tuple(Side)
    if flank not in tuple(Side):
        raise ArgumentError("flank", flank, must_be=f"one of {', '.join(Side)}, {BOTH_FLANKS}")
    return (Side(flank),)


def _sides(path: Path) -> list[Side]:
    """Return the flanks in the column "flank" of a file."""
    words = read_points(path).words.get("flank")
    if words is None:
        raise ArgumentError(
            "flank",
            BOTH_FLANKS,
            reason="the file has no column flank that says which points are of which",
            allowed="right, left",
        )
    return [side for side in Side if str(side) in words]
