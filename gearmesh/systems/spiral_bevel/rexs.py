"""Conversion of bevel stages of REXS models to spiral bevel and hypoid pairs with machine settings, and back.

Settings have the makers' axes and signs (`machine.maker_settings`). The concave flank of a right-hand gear is its left
flank.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.spiral_bevel.hobbing.head import refuse_hobbing
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import MemberBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: type of the component of a stage
STAGE_TYPE = "bevel_stage"
#: type of the component of a gear
GEAR_TYPE = "bevel_gear"
#: type of the component of a flank
FLANK_TYPE = "bevel_gear_flank"
#: type of the component of a tool
TOOL_TYPE = "bevel_gear_tool"
#: type of the component of machine settings
SETTINGS_TYPE = "bevel_gear_manufacturing_settings"
#: names of the members in order
MEMBER_NAMES = ("pinion", "gear")
#: largest difference of values that count as equal
MAX_ROUNDING = 1e-9
#: key of a machine -> attribute of the settings, except settings along the blank's axis and the ratio of roll
MACHINE_ATTRIBUTES = {
    "radial": "radial_distance",
    "cradle_angle": "center_roll_position",
    "machining_offset": "work_offset",
    "machine_root_angle": "machine_root_angle",
    "tilt": "cutter_tilt",
    "swivel": "cutter_swivel",
}
#: attribute of the machine centre to back, along the blank's axis
CENTRE_ATTRIBUTE = "machine_center_to_crossing_point"
#: attribute of the sliding base
BASE_ATTRIBUTE = "sliding_base"
#: attribute of the ratio of roll, blank over cradle
RATIO_ATTRIBUTE = "ratio_of_roll"
#: key of a blade -> attribute of the tool
BLADE_ATTRIBUTES = {"edge_radius": "tool_edge_radius_bevel_gear_tool", "blade_radius": "blade_spheric_radius"}
#: attribute of the tip radius
TIP_ATTRIBUTE = "blade_point_radius"
#: attribute of the blade angle
ANGLE_ATTRIBUTE = "blade_pressure_angle"
#: least ratio of roll, blank over cradle: a smaller ratio is cradle over blank
MIN_ROLL_RATIO = 0.9
#: keys that the settings of a flank must have
NEEDED_KEYS = (
    "radial",
    "cradle_angle",
    "ratio_of_roll",
    "machine_root_angle",
    "machine_centre_to_back",
    "tip_radius",
    "blade_angle",
)


def is_hypoid(file: StageReader) -> bool:
    """Return True if the axes of a stage are offset."""
    return abs(file.number(file.stage, "hypoid_offset") or 0.0) > MAX_ROUNDING


def read_bevel(file: StageReader) -> dict[str, Any]:
    """Return the keys of the design of a stage."""
    stage, own_keys = file.stage, file.own_keys(file.stage)
    pinion, gear = sorted(file.gears(), key=lambda component: file.required_count(component, "number_of_teeth"))
    offset = file.number(stage, "hypoid_offset", "offset") or 0.0
    module = file.number(stage, "outer_transverse_module", "module")
    teeth = {
        name: file.required_count(component, "number_of_teeth", f"{name}.teeth")
        for name, component in zip(MEMBER_NAMES, (pinion, gear), strict=True)
    }
    if module is None:
        module = file.required_number(gear, "outer_pitch_diameter") / teeth["gear"]
    hand = file.text(pinion, "spiral_angle_pitch_direction", "hand")
    spiral = file.number(pinion, "mean_spiral_angle", "spiral_angle")
    file.number(gear, "mean_spiral_angle")
    keys: dict[str, Any] = {
        "kind": "hypoid" if abs(offset) > MAX_ROUNDING else "spiral_bevel",
        "units": "mm",
        "name": stage.name or None,
        **own_keys,
        "module": module,
        "shaft_angle": file.number(stage, "shaft_angle", "shaft_angle"),
        "pressure_angle": file.number(stage, "nominal_design_pressure_angle_drive", "pressure_angle"),
        "spiral_angle": None if spiral is None else abs(spiral),
        "hand": hand or ("left" if (spiral or 0.0) < 0.0 else None),
        "face_width": file.number(gear, "face_width", "face_width"),
        "offset": offset if abs(offset) > MAX_ROUNDING else None,
    }
    for name, component in zip(MEMBER_NAMES, (pinion, gear), strict=True):
        keys[f"{name}.teeth"] = teeth[name]
        for key in ("root_angle", "face_angle"):
            keys[f"{name}.{key}"] = file.number(component, key, f"{name}.{key}")
    keys |= file.materials(dict(zip(MEMBER_NAMES, (pinion, gear), strict=True)))
    right = (keys["hand"] or own_keys.get("hand") or "left") == "right"
    formate = "formate" in str(own_keys.get("process", ""))
    for side, machine in _sides(file, pinion, right, False).items():
        keys |= {f"pinion.{side}.{key}": value for key, value in machine.items()}
    keys |= {
        f"gear.cutter.{key}": value
        for key, value in _one_cutter(file, gear, _sides(file, gear, not right, formate)).items()
    }
    if "gear.cutter.tip_radius" not in keys:
        keys["gear.cutter.tip_radius"] = file.number(stage, "cutter_radius", "gear.cutter.tip_radius")
    return {key: value for key, value in keys.items() if value is not None}


def _sides(file: StageReader, gear: Component, right: bool, formate: bool) -> dict[str, dict[str, float]]:
    """Return the settings of machine and tool of both sides of a gear, concave and convex; none if the file lacks some."""
    sides = {}
    for name, flank in file.flanks(gear).items():
        for tool, settings in file.steps(flank):
            machine = _machine(file, settings, tool) if tool.type == TOOL_TYPE and settings is not None else {}
            missing = [
                key for key in NEEDED_KEYS if machine.get(key) is None and not (formate and key == "ratio_of_roll")
            ]
            if len(missing) < len(NEEDED_KEYS) and missing:
                file.notes.append(f"{flank}: settings are not used, {', '.join(missing)} missing")
            if not missing:
                sides["concave" if (name == "left") == right else "convex"] = machine
                break
    if len(sides) == 1:
        file.notes.append(f"{gear}: settings of one flank alone are not used")
    return sides if len(sides) == 2 else {}


def _machine(file: StageReader, settings: Component, tool: Component) -> dict[str, float]:
    """Return the settings of one side, in mm and deg, by key of the design."""
    values = {key: file.number(settings, attribute) for key, attribute in MACHINE_ATTRIBUTES.items()}
    values |= {key: file.number(tool, attribute) for key, attribute in BLADE_ATTRIBUTES.items()}
    values |= {"tip_radius": file.number(tool, TIP_ATTRIBUTE), "blade_angle": file.number(tool, ANGLE_ATTRIBUTE)}
    behind, base, root = (
        file.number(settings, CENTRE_ATTRIBUTE),
        file.number(settings, BASE_ATTRIBUTE),
        values["machine_root_angle"],
    )
    if behind is not None and root is not None:
        # from the maker's axes to the root line: see `machine.maker_settings`
        root = math.radians(root)
        values |= {
            "machine_centre_to_back": -behind * math.cos(root),
            "sliding_base": (base or 0.0) + behind * math.sin(root),
        }
    roll = file.number(settings, RATIO_ATTRIBUTE)
    if roll is not None and roll < MIN_ROLL_RATIO:
        raise file.refusal(
            settings, RATIO_ATTRIBUTE, f"must be that of blank over cradle, at least {MIN_ROLL_RATIO}", roll
        )
    values["ratio_of_roll"] = None if roll is None else 1.0 / roll
    return {key: value for key, value in values.items() if value is not None}


def _one_cutter(file: StageReader, gear: Component, sides: Mapping[str, dict[str, float]]) -> dict[str, Any]:
    """Return the keys of the gear's cutter, whose blades cut both sides with the same settings."""
    if not sides:
        return {}
    outside, inside = sides["concave"], sides["convex"]
    of_blades = ("tip_radius", "blade_angle")
    unequal = [key for key in outside if key not in of_blades and abs(outside[key] - inside.get(key, math.inf)) > 1e-6]
    if unequal:
        file.notes.append(
            f"{gear}: settings are not used: a design cuts both flanks with the same {', '.join(unequal)}"
        )
        return {}
    radii = outside["tip_radius"], inside["tip_radius"]
    keys = {**outside, "tip_radius": 0.5 * (radii[0] + radii[1]), "point_width": radii[0] - radii[1]}
    if abs(outside["blade_angle"] - inside["blade_angle"]) > MAX_ROUNDING:
        keys |= {"outside.blade_angle": outside["blade_angle"], "inside.blade_angle": inside["blade_angle"]}
    return keys


def write_bevel(file: StageWriter, design: FaceMilledDesign, known: Component | None) -> Component:
    """Write a complete design in mm with all values stated; return the component of its stage."""
    refuse_hobbing(design, "the file has settings of face-milling machines")
    blank, keys = bevel_teeth(design).cut.blank, file.keys
    stage = file.stage(STAGE_TYPE, known, design.name or "")
    gears = file.gears(stage, (GEAR_TYPE, GEAR_TYPE), MEMBER_NAMES)
    counts = [gear.attributes.get("number_of_teeth") for gear in gears]
    if counts[0] is not None and counts[1] is not None and float(str(counts[0].text)) > float(str(counts[1].text)):
        gears = (gears[1], gears[0])
    file.put(stage, "shaft_angle", file.take("shaft_angle"))
    file.put(stage, "hypoid_offset", file.take("offset") or 0.0)
    file.put(stage, "outer_transverse_module", design.given_module)
    file.put(stage, "cutter_radius", blank.cutter_radius)
    for side in ("drive", "coast"):
        file.put(stage, f"nominal_design_pressure_angle_{side}", keys.get("pressure_angle"))
    right = design.hand == "right"
    spirals = [keys.get("spiral_angle"), math.degrees(blank.gear.spiral_angle)]
    width = file.take("face_width")
    for name, gear, member, spiral in zip(MEMBER_NAMES, gears, blank.members, spirals, strict=True):
        hand = right == (name == "pinion")
        file.put(gear, "face_width", width if name == "gear" else member.face_width)
        file.put(gear, "mean_spiral_angle", spiral)
        file.put(gear, "spiral_angle_pitch_direction", "right" if hand else "left")
        _write_member(file, gear, member, name)
        flanks = file.flanks(gear, FLANK_TYPE)
        for flank, component in flanks.items():
            _write_side(file, component, name, "concave" if (flank == "left") == hand else "convex")
        for key in _keys_given(file, name):
            file.take(key)
    for key in ("module", "diametral_pitch", "hand", "spiral_angle", "pressure_angle", "kind", "units"):
        file.take(key)
    return stage


def _write_member(file: StageWriter, component: Component, member: MemberBlank, name: str) -> None:
    """Write the data of a member's blank."""
    file.put(component, "number_of_teeth", member.teeth)
    for key in ("root_angle", "face_angle"):
        file.put(component, key, file.take(f"{name}.{key}"))
    file.put(component, "pitch_angle", math.degrees(member.pitch_angle))
    for attribute, value in (
        ("mean_cone_distance", member.mean_cone_distance),
        ("outer_cone_distance", member.outer_cone_distance),
        ("inner_cone_distance", member.inner_cone_distance),
        ("outer_pitch_diameter", 2.0 * member.outer_cone_distance * math.sin(member.pitch_angle)),
        ("mean_addendum", member.mean_addendum),
        ("mean_dedendum", member.mean_dedendum),
        ("pitch_apex_beyond_crossing_point", member.pitch_apex),
        ("root_apex_beyond_crossing_point", member.root_apex),
    ):
        file.put(component, attribute, value)
    file.take(f"{name}.teeth")
    file.put_material(component, name)


def _write_side(file: StageWriter, flank: Component, name: str, side: str) -> None:
    """Write machine settings and tool of one side."""
    stem = f"pinion.{side}" if name == "pinion" else "gear.cutter"
    values = {key[len(stem) + 1 :]: value for key, value in file.keys.items() if key.startswith(f"{stem}.")}
    tool, settings = file.step(flank, TOOL_TYPE, SETTINGS_TYPE)
    for key, attribute in MACHINE_ATTRIBUTES.items():
        file.put(settings, attribute, values.get(key))
    root, centre = math.radians(values["machine_root_angle"]), values["machine_centre_to_back"]
    behind = -centre / math.cos(root)
    file.put(settings, CENTRE_ATTRIBUTE, behind)
    file.put(settings, BASE_ATTRIBUTE, values["sliding_base"] - behind * math.sin(root))
    ratio = values.get("ratio_of_roll")
    file.put(settings, RATIO_ATTRIBUTE, 1.0 / ratio if ratio else None)
    for key, attribute in BLADE_ATTRIBUTES.items():
        if not file.put(tool, attribute, values.get(key)) and key in values:
            # the format has no sharp edge
            file.unsaid.add(f"{stem}.{key}")
    wider = 0.0 if name == "pinion" else (0.5 if side == "concave" else -0.5) * values["point_width"]
    file.put(tool, TIP_ATTRIBUTE, values["tip_radius"] + wider)
    blade = values.get(f"{'outside' if side == 'concave' else 'inside'}.blade_angle", values["blade_angle"])
    file.put(tool, ANGLE_ATTRIBUTE, blade)


def _keys_given(file: StageWriter, name: str) -> list[str]:
    """Return the keys of both sides of a member that attributes state."""
    stems = ("pinion.concave", "pinion.convex") if name == "pinion" else ("gear.cutter",)
    stated = {
        *MACHINE_ATTRIBUTES,
        *BLADE_ATTRIBUTES,
        "machine_centre_to_back",
        "sliding_base",
        "ratio_of_roll",
        "tip_radius",
        "blade_angle",
    }
    stated |= {"point_width", "outside.blade_angle", "inside.blade_angle"}
    given = [f"{stem}.{key}" for stem in stems for key in stated]
    return [key for key in given if key in file.keys and key not in file.unsaid]


#: stages of pairs without offset
BEVEL_FORM = StageForm((STAGE_TYPE,), read_bevel, write_bevel, lambda file: not is_hypoid(file))
#: stages of pairs with offset
HYPOID_FORM = StageForm((STAGE_TYPE,), read_bevel, write_bevel, is_hypoid)
