"""Cylindrical stages of REXS models read as pairs, and written."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import READ_VERSIONS, Component
from gearmesh.exchange.stage import POSITION_ATTRIBUTES, StageReader
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.common.standards import iso286
from gearmesh.systems.cylindrical.allowance_keys import CENTER_GRADES
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.rexs.gears import (
    DIAMETER_DECIMALS,
    EXTERNAL_GEAR,
    FIGURE_ROUNDING,
    INTERNAL_GEAR,
    GearReader,
    write_gear,
)

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign

#: component of a cylindrical stage
STAGE_TYPE = "cylindrical_stage"
#: attribute of the tolerance class of the centre distance
TOLERANCE_FIELD = "center_distance_tolerance_field_din_3964_1980"
#: attributes of the amounts of the deviations, um: their ranges begin above 0
DISTANCE_ENDS = "upper_center_distance_allowance", "lower_center_distance_allowance"
#: micrometres in a millimetre
MICROMETRES_PER_MM = 1e3
#: keys of the limits of the tip diameter
TIP_LIMITS = "tip_diameter_tolerance.upper", "tip_diameter_tolerance.lower"
#: versions in which the range of helix angles begins at 0
UNSIGNED_HELIX = READ_VERSIONS[:3]
#: largest difference, in modules, between the shifts of a file and those of its centre distance without backlash
SHIFT_FITS = 0.02
#: keys of the size of teeth
SIZE_KEYS = ("module", "diametral_pitch", "transverse_module", "transverse_diametral_pitch")
#: keys of the pressure angle
ANGLE_KEYS = ("pressure_angle", "transverse_pressure_angle", "coast_pressure_angle")
#: keys that attributes of the file represent
WRITTEN_KEYS = (*SIZE_KEYS, *ANGLE_KEYS, "kind", "units", "helix_angle", "hand", "backlash", "circumferential_backlash")


def read_toothing(file: StageReader, gears: tuple[GearReader, ...]) -> dict[str, Any]:
    """Return the keys that the gears of one mesh share: module, pressure angle, helix angle, hand."""
    first, modules = gears[0], [gear.module() for gear in gears]
    for gear, module in zip(gears, modules, strict=True):
        if abs(module - modules[0]) > FIGURE_ROUNDING:
            reason = f"must be {modules[0]:g} mm, as the mating gear, {first.gear.in_full}, has it"
            raise file.refusal(gear.gear, "normal_module", reason, module)
        sense = 1.0 if gear is first or gear.internal or first.internal else -1.0
        if abs(gear.beta - sense * first.beta) > FIGURE_ROUNDING:
            _refuse_helix(file, gear, sense * first.beta, first)
    drive, coast = _pressure_angles(file, gears)
    hand = "left" if first.beta < 0.0 else "right"
    asymmetric = {"coast_pressure_angle": coast} if abs(coast - drive) > FIGURE_ROUNDING else {}
    return {"module": modules[0], "pressure_angle": drive, **asymmetric, "helix_angle": abs(first.beta), "hand": hand}


def _pressure_angles(file: StageReader, gears: tuple[GearReader, ...]) -> tuple[float, float]:
    """Return the normal pressure angles (deg) of drive and coast side, which all gears of a mesh must have."""
    first, inside = gears[0], any(gear.internal for gear in gears)
    known: list[tuple[GearReader, tuple[float, float]]] = []
    for gear in gears:
        # right flanks touch right flanks of an external gear, left flanks of an internal one
        angles = gear.pressure_angles("left" if inside and gear is not first else "right")
        known += [] if angles is None else [(gear, angles)]
    if not known:
        raise file.refusal(first.gear, "normal_pressure_angle", "missing (on the flanks of the gear)")
    (one, wanted), *others = known
    for gear, angles in others:
        for angle, wanted_angle in zip(angles, wanted, strict=True):
            if abs(angle - wanted_angle) > FIGURE_ROUNDING:
                reason = f"must be {wanted_angle:g} deg, as the mating gear, {one.gear.in_full}, has it"
                flank = next(iter(gear.flanks.values()), gear.gear)
                raise file.refusal(flank, "normal_pressure_angle", reason, angle)
    return wanted


def _refuse_helix(file: StageReader, one: GearReader, wanted: float, first: GearReader) -> None:
    """Refuse a helix angle that does not match the mating gear's.

    Files of versions whose helix angles have no sign are only noted.
    """
    if abs(abs(one.beta) - abs(wanted)) < FIGURE_ROUNDING and file.model.version in UNSIGNED_HELIX:
        hand = "left" if first.beta < 0.0 else "right"
        file.notes.append(
            f"{file.stage}: helix angles of version {file.model.version} have no sign: the hand of {first.gear} is taken as {hand}"
        )
        return
    reason = f"must be {wanted:g} deg, as the mating gear, {first.gear.in_full}, has {first.beta:g}"
    raise file.refusal(one.gear, "helix_angle_reference_diameter", reason, one.beta)


def read_pair(file: StageReader) -> dict[str, Any]:
    """Return the keys of the design of a stage."""
    own = file.own_keys(file.stage)
    pinion, gear = file.gears()
    gears = GearReader(file, pinion, MEMBER_NAMES[0]), GearReader(file, gear, MEMBER_NAMES[1])
    common = read_toothing(file, gears)
    distance = file.size(file.stage, "center_distance", "assembly.center_distance")
    count_shift(file, gears, common, distance)
    keys: dict[str, Any] = {"kind": "cylindrical", "units": "mm", "name": file.stage.name or None, **own, **common}
    for one in gears:
        keys |= member_keys(one, common, own)
    keys |= file.materials({one.name: one.gear for one in gears})
    keys["assembly.center_distance"] = distance
    keys |= read_allowance(file, distance)
    aside = file.apart(pinion, gear)
    keys["assembly.dz"] = aside if aside is not None and abs(aside) > FIGURE_ROUNDING else None
    return {key: value for key, value in keys.items() if value is not None}


def member_keys(one: GearReader, common: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Return the dotted keys of a member, except those that keys of this program replace."""
    drive = common["pressure_angle"]
    made = one.keys(common["module"], (drive, common.get("coast_pressure_angle", drive)), common["helix_angle"])
    keys = {f"{one.name}.{key}": value for key, value in made.items()}
    said = {"dedendum": ("root_diameter",), "tip_diameter_tolerance.grade": TIP_LIMITS}
    for key, others in said.items():
        if f"{one.name}.{key}" in own:
            keys = {id: value for id, value in keys.items() if id not in {f"{one.name}.{other}" for other in others}}
    return keys


def count_shift(
    file: StageReader, gears: tuple[GearReader, GearReader], common: Mapping[str, Any], a: float | None
) -> None:
    """Determine the sense in which a file counts the profile shift of a ring, by the centre distance `a` (mm).

    ISO 21771 counts it towards the tip, some programs away from the axis. The centre distance agrees with one of them.
    """
    ring = next((one for one in gears if one.internal), None)
    shifts = [one.shift(common["module"]) for one in gears]
    if ring is None or a is None or None in shifts or not shifts[gears.index(ring)]:
        return
    first, second = (shift or 0.0 for shift in shifts)
    own, mate = (second, first) if ring is gears[1] else (first, second)
    needed = _sum_of_shifts(gears, common, a)
    if needed is None or abs(mate + own - needed) < abs(mate - own - needed):
        return
    if abs(mate - own - needed) < SHIFT_FITS:
        ring.shift_sense = -1
        file.notes.append(
            f"{ring.gear}: the file counts its profile shift away from the axis, as the centre distance shows"
        )


def _sum_of_shifts(gears: tuple[GearReader, GearReader], common: Mapping[str, Any], a: float) -> float | None:
    """Return x1 + x2 of an internal pair without backlash at a centre distance [ISO 21771].

    The ring's shift is positive towards its tip.
    """
    teeth = abs(gears[0].teeth - gears[1].teeth)
    drive, beta = common["pressure_angle"], math.radians(common["helix_angle"])
    involutes, tangents = [], []
    for angle in (drive, common.get("coast_pressure_angle", drive)):
        alpha = math.radians(angle)
        transverse = math.atan(math.tan(alpha) / math.cos(beta))
        cosine = teeth * common["module"] / math.cos(beta) * math.cos(transverse) / (2.0 * a)
        if not teeth or cosine >= 1.0:
            return None
        working = math.acos(cosine)
        involutes.append(math.tan(working) - working - math.tan(transverse) + transverse)
        tangents.append(math.tan(alpha))
    return -teeth * sum(involutes) / (2.0 * sum(tangents))


def read_allowance(file: StageReader, distance: float | None) -> dict[str, Any]:
    """Return the tolerance class of the centre distance, given or found by its deviations [DIN 3964]."""
    key = "assembly.center_distance_allowance"
    grade = file.text(file.stage, TOLERANCE_FIELD, key)
    upper, lower = (file.size(file.stage, id, key) for id in DISTANCE_ENDS)
    if grade is not None:
        return {key: f"js{grade}"}
    if distance is None or upper is None or lower is None:
        return {}
    for grade_number in CENTER_GRADES:
        if (
            max(
                abs(end - MICROMETRES_PER_MM * iso286.deviations(f"js{grade_number}", distance).upper)
                for end in (upper, lower)
            )
            < FIGURE_ROUNDING
        ):
            return {key: f"js{grade_number}"}
    file.notes.append(
        f"{file.stage}: {DISTANCE_ENDS[0]}, {DISTANCE_ENDS[1]} are not used: {upper:g} and {lower:g} mum are no class of DIN 3964"
    )
    file.used -= {(file.stage.id, id) for id in DISTANCE_ENDS}
    return {}


def write_allowance(file: StageWriter, stage: Component, distance: float) -> None:
    """Write the tolerance class of the centre distance, and the amounts of its deviations."""
    given = file.keys.get("assembly.center_distance_allowance")
    if file.put(stage, TOLERANCE_FIELD, None if given is None else given.removeprefix("js").strip()):
        file.take("assembly.center_distance_allowance")
    ends = None if given is None or distance > iso286.SIZE_LIMITS_MM[-1] else iso286.deviations(given, distance)
    for id, end in zip(DISTANCE_ENDS, (None, None) if ends is None else (ends.upper, ends.lower), strict=True):
        file.put(stage, id, None if end is None else round(MICROMETRES_PER_MM * abs(end), DIAMETER_DECIMALS))


def write_pair(file: StageWriter, design: CylindricalDesign, known: Component | None) -> Component:
    """Write a complete design in mm, with all its keys."""
    pair = proportions(half_of(design))
    stage = file.stage(STAGE_TYPE, known, design.name or "")
    types = [INTERNAL_GEAR if gear.own.internal else EXTERNAL_GEAR for gear in pair.gears]
    gears = file.gears(stage, (types[0], types[1]), MEMBER_NAMES)
    file.put(stage, "center_distance", pair.mesh.distance)
    file.take("assembly.center_distance")
    write_allowance(file, stage, pair.mesh.distance)
    for gear, of, name in zip(gears, pair.gears, MEMBER_NAMES, strict=True):
        write_gear(file, gear, of, name)
    place(file, gears, file.take("assembly.dz") or 0.0, pair.mesh.distance)
    for key in WRITTEN_KEYS:
        file.take(key)
    return stage


def place(file: StageWriter, gears: tuple[Component, Component], aside: float, distance: float) -> None:
    """Write positions of both gears in one frame, u along the first gear's axis; the second is `aside` (mm).

    Gears that have a position already keep their axes.
    """
    frame = next((one for one in file.model.components if one.type == "gear_unit"), gears[0])
    for gear, support in zip(gears, ([0.0, 0.0, 0.0], [aside, distance, 0.0]), strict=True):
        if POSITION_ATTRIBUTES[1] not in gear.attributes:
            put_position(file, gear, frame, support)


def put_position(file: StageWriter, gear: Component, frame: Component, support: list[float]) -> None:
    """Write the position of a gear in a frame, with the frame's axes."""
    file.put(gear, POSITION_ATTRIBUTES[0], frame.id)
    for id, value in zip(POSITION_ATTRIBUTES[1:], (support, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), strict=True):
        file.put(gear, id, value)
