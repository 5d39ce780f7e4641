"""Cylindrical stages of REXS models as pairs, and back."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import POSITION, StageReader
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.numerals import parse_whole_number
from gearmesh.systems.cylindrical.double_helical import half_of
from gearmesh.systems.cylindrical.geometry.nominal import MEMBERS
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.rexs.gears import EXTERNAL, INTERNAL, SAME, GearReader, write_gear

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign

STAGE = "cylindrical_stage"
#: keys of module and pressure angle, and all that other attributes give
SIZES = ("module", "diametral_pitch", "transverse_module", "transverse_diametral_pitch")
ANGLES = ("pressure_angle", "transverse_pressure_angle")
GIVEN = (*SIZES, *ANGLES, "kind", "units", "helix_angle", "hand", "backlash", "circumferential_backlash")


def read_toothing(file: StageReader, gears: tuple[GearReader, ...]) -> dict[str, Any]:
    """Keys of what the gears of one mesh have in common: module, pressure angle, helix angle, hand."""
    first, modules = gears[0], [one.module() for one in gears]
    angles = [angle for one in gears if (angle := one.flank_figure(("normal_pressure_angle", "deg", 1.0))) is not None]
    for one, module in zip(gears, modules, strict=True):
        if abs(module - modules[0]) > SAME:
            raise file.refusal(one.gear, "normal_module", f"the mating gear has {modules[0]:g}", module)
        sense = 1.0 if one is first or one.internal or first.internal else -1.0
        if abs(one.beta - sense * first.beta) > SAME:
            reason = f"must be {sense * first.beta:g} deg, as the mating gear has {first.beta:g}"
            raise file.refusal(one.gear, "helix_angle_reference_diameter", reason, one.beta)
    if not angles:
        raise file.refusal(first.gear, "normal_pressure_angle", "missing (on the flanks)")
    if max(angles) - min(angles) > SAME:
        raise file.refusal(
            gears[-1].gear, "normal_pressure_angle", f"the mating gear has {angles[0]:g} deg", angles[-1]
        )
    hand = "left" if first.beta < 0.0 else "right"
    return {"module": modules[0], "pressure_angle": angles[0], "helix_angle": abs(first.beta), "hand": hand}


def read_pair(file: StageReader) -> dict[str, Any]:
    """Keys of the design of a stage."""
    own = file.own_keys(file.stage)
    gears = tuple(GearReader(file, gear) for gear in file.gears())
    common = read_toothing(file, gears)
    keys: dict[str, Any] = {"kind": "cylindrical", "units": "mm", "name": file.stage.name or None, **own, **common}
    module, alpha = common["module"], common["pressure_angle"]
    for name, gear in zip(MEMBERS, gears, strict=True):
        keys |= {f"{name}.{key}": value for key, value in gear.keys(module, alpha, common["helix_angle"]).items()}
        if f"{name}.dedendum" in own:
            keys.pop(f"{name}.root_diameter", None)
    distance = file.number(file.stage, "center_distance", "mm")
    keys["assembly.center_distance"] = None if distance is None else abs(distance)
    aside = file.apart(*(gear.gear for gear in gears))
    keys["assembly.dz"] = aside if aside is not None and abs(aside) > SAME else None
    return {key: value for key, value in keys.items() if value is not None}


def write_pair(file: StageWriter, design: CylindricalDesign, known: Component | None) -> Component:
    """A complete design in mm, all of it stated."""
    pair = proportions(half_of(design))
    stage = file.stage(STAGE, known, design.name or "")
    types = [INTERNAL if gear.own.internal else EXTERNAL for gear in pair.gears]
    gears = file.gears(stage, (types[0], types[1]), MEMBERS)
    file.put(stage, "center_distance", pair.mesh.distance, "mm")
    file.take("assembly.center_distance")
    for gear, of, name in zip(gears, pair.gears, MEMBERS, strict=True):
        write_gear(file, gear, of, name)
    place(file, gears, file.take("assembly.dz") or 0.0, pair.mesh.distance)
    for key in GIVEN:
        file.take(key)
    return stage


def place(file: StageWriter, gears: tuple[Component, Component], aside: float, distance: float) -> None:
    """Both gears in one frame, u along the first's axis, the second `aside` (mm); those that have a place keep their axes."""
    frame = next((one for one in file.model.components if one.type == "gear_unit"), gears[0])
    for gear, support in zip(gears, ([0.0, 0.0, 0.0], [aside, distance, 0.0]), strict=True):
        if POSITION[1] not in gear.attributes:
            file.put(gear, POSITION[0], frame.id if (number := parse_whole_number(frame.id)) is None else number)
            gear.attributes[POSITION[0]].type = "reference_component"
            for id, value in zip(POSITION[1:], (support, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]), strict=True):
                file.put(gear, id, value, "mm")
