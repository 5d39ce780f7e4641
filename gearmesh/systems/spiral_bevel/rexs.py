"""Bevel stages of REXS models as spiral bevel and hypoid pairs with their machine settings, and back.

Settings have the makers' axes and signs (`machine.maker_settings`). The concave flank of a right-hand gear is its left.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank.blank import MemberBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

STAGE, GEAR, FLANK = "bevel_stage", "bevel_gear", "bevel_gear_flank"
TOOL, SETTINGS = "bevel_gear_tool", "bevel_gear_manufacturing_settings"
MEMBERS = ("pinion", "gear")
#: figures that are the same but for rounding
SAME = 1e-9
#: key of a machine -> attribute of the settings; those along the blank's axis, and the ratio, apart
MACHINE = {
    "radial": "radial_distance",
    "cradle_angle": "center_roll_position",
    "machining_offset": "work_offset",
    "machine_root_angle": "machine_root_angle",
    "tilt": "cutter_tilt",
    "swivel": "cutter_swivel",
}
CENTRE, BASE, RATIO = "machine_center_to_crossing_point", "sliding_base", "ratio_of_roll"
BLADE = {"edge_radius": "tool_edge_radius_bevel_gear_tool", "blade_radius": "blade_spheric_radius"}
TIP, ANGLE = "blade_point_radius", "blade_pressure_angle"
#: no blank turns less than the cradle: a ratio below this is that of cradle over blank
LEAST_ROLL = 0.9
#: without these a flank's settings are not whole
NEEDED = (
    "radial",
    "cradle_angle",
    "ratio_of_roll",
    "machine_root_angle",
    "machine_centre_to_back",
    "tip_radius",
    "blade_angle",
)


def is_hypoid(file: StageReader) -> bool:
    """Whether the axes of a stage are offset."""
    return abs(file.number(file.stage, "hypoid_offset") or 0.0) > SAME


def read_bevel(file: StageReader) -> dict[str, Any]:
    """Keys of the design of a stage."""
    stage, own = file.stage, file.own_keys(file.stage)
    pinion, gear = sorted(file.gears(), key=lambda one: file.required_count(one, "number_of_teeth"))
    offset = file.number(stage, "hypoid_offset", "offset") or 0.0
    module = file.number(stage, "outer_transverse_module", "module")
    teeth = {
        name: file.required_count(one, "number_of_teeth", f"{name}.teeth")
        for name, one in zip(MEMBERS, (pinion, gear), strict=True)
    }
    if module is None:
        module = file.required_number(gear, "outer_pitch_diameter") / teeth["gear"]
    hand = file.text(pinion, "spiral_angle_pitch_direction", "hand")
    spiral = file.number(pinion, "mean_spiral_angle", "spiral_angle")
    file.number(gear, "mean_spiral_angle")
    keys: dict[str, Any] = {
        "kind": "hypoid" if abs(offset) > SAME else "spiral_bevel",
        "units": "mm",
        "name": stage.name or None,
        **own,
        "module": module,
        "shaft_angle": file.number(stage, "shaft_angle", "shaft_angle"),
        "pressure_angle": file.number(stage, "nominal_design_pressure_angle_drive", "pressure_angle"),
        "spiral_angle": None if spiral is None else abs(spiral),
        "hand": hand or ("left" if (spiral or 0.0) < 0.0 else None),
        "face_width": file.number(gear, "face_width", "face_width"),
        "offset": offset if abs(offset) > SAME else None,
    }
    for name, one in zip(MEMBERS, (pinion, gear), strict=True):
        keys[f"{name}.teeth"] = teeth[name]
        for key in ("root_angle", "face_angle"):
            keys[f"{name}.{key}"] = file.number(one, key, f"{name}.{key}")
    keys |= file.materials(dict(zip(MEMBERS, (pinion, gear), strict=True)))
    right = (keys["hand"] or own.get("hand") or "left") == "right"
    formate = "formate" in str(own.get("process", ""))
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
    """Settings of the machine and the tool of both sides of a gear, concave and convex; none where the file has not all."""
    sides = {}
    for name, flank in file.flanks(gear).items():
        for tool, settings in file.steps(flank):
            machine = _machine(file, settings, tool) if tool.type == TOOL and settings is not None else {}
            missing = [key for key in NEEDED if machine.get(key) is None and not (formate and key == "ratio_of_roll")]
            if len(missing) < len(NEEDED) and missing:
                file.notes.append(f"{flank}: settings are not used, {', '.join(missing)} missing")
            if not missing:
                sides["concave" if (name == "left") == right else "convex"] = machine
                break
    if len(sides) == 1:
        file.notes.append(f"{gear}: settings of one flank alone are not used")
    return sides if len(sides) == 2 else {}


def _machine(file: StageReader, settings: Component, tool: Component) -> dict[str, float]:
    values = {key: file.number(settings, attribute) for key, attribute in MACHINE.items()}
    values |= {key: file.number(tool, attribute) for key, attribute in BLADE.items()}
    values |= {"tip_radius": file.number(tool, TIP), "blade_angle": file.number(tool, ANGLE)}
    behind, base, root = (
        file.number(settings, CENTRE),
        file.number(settings, BASE),
        values["machine_root_angle"],
    )
    if behind is not None and root is not None:
        root = math.radians(root)
        values |= {
            "machine_centre_to_back": -behind * math.cos(root),
            "sliding_base": (base or 0.0) + behind * math.sin(root),
        }
    roll = file.number(settings, RATIO)
    if roll is not None and roll < LEAST_ROLL:
        raise file.refusal(settings, RATIO, f"must be that of blank over cradle, at least {LEAST_ROLL}", roll)
    values["ratio_of_roll"] = None if roll is None else 1.0 / roll
    return {key: value for key, value in values.items() if value is not None}


def _one_cutter(file: StageReader, gear: Component, sides: Mapping[str, dict[str, float]]) -> dict[str, Any]:
    """The gear's cutter, whose blades cut both sides with the same settings."""
    if not sides:
        return {}
    outside, inside = sides["concave"], sides["convex"]
    of_blades = ("tip_radius", "blade_angle")
    apart = [key for key in outside if key not in of_blades and abs(outside[key] - inside.get(key, math.inf)) > 1e-6]
    if apart:
        file.notes.append(f"{gear}: settings are not used: a design cuts both flanks with the same {', '.join(apart)}")
        return {}
    radii = outside["tip_radius"], inside["tip_radius"]
    keys = {**outside, "tip_radius": 0.5 * (radii[0] + radii[1]), "point_width": radii[0] - radii[1]}
    if abs(outside["blade_angle"] - inside["blade_angle"]) > SAME:
        keys |= {"outside.blade_angle": outside["blade_angle"], "inside.blade_angle": inside["blade_angle"]}
    return keys


def write_bevel(file: StageWriter, design: FaceMilledDesign, known: Component | None) -> Component:
    """A complete design in mm, all of it stated."""
    blank, keys = bevel_teeth(design).cut.blank, file.keys
    stage = file.stage(STAGE, known, design.name or "")
    gears = file.gears(stage, (GEAR, GEAR), MEMBERS)
    counts = [one.attributes.get("number_of_teeth") for one in gears]
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
    for name, one, member, spiral in zip(MEMBERS, gears, blank.members, spirals, strict=True):
        hand = right == (name == "pinion")
        file.put(one, "face_width", width if name == "gear" else member.face_width)
        file.put(one, "mean_spiral_angle", spiral)
        file.put(one, "spiral_angle_pitch_direction", "right" if hand else "left")
        _write_member(file, one, member, name)
        flanks = file.flanks(one, FLANK)
        for flank, component in flanks.items():
            _write_side(file, component, name, "concave" if (flank == "left") == hand else "convex")
        for key in _keys_given(file, name):
            file.take(key)
    for key in ("module", "diametral_pitch", "hand", "spiral_angle", "pressure_angle", "kind", "units"):
        file.take(key)
    return stage


def _write_member(file: StageWriter, one: Component, member: MemberBlank, name: str) -> None:
    file.put(one, "number_of_teeth", member.teeth)
    for key in ("root_angle", "face_angle"):
        file.put(one, key, file.take(f"{name}.{key}"))
    file.put(one, "pitch_angle", math.degrees(member.pitch_angle))
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
        file.put(one, attribute, value)
    file.take(f"{name}.teeth")
    file.put_material(one, name)


def _write_side(file: StageWriter, flank: Component, name: str, side: str) -> None:
    stem = f"pinion.{side}" if name == "pinion" else "gear.cutter"
    values = {key[len(stem) + 1 :]: value for key, value in file.keys.items() if key.startswith(f"{stem}.")}
    tool, settings = file.step(flank, TOOL, SETTINGS)
    for key, attribute in MACHINE.items():
        file.put(settings, attribute, values.get(key))
    root, centre = math.radians(values["machine_root_angle"]), values["machine_centre_to_back"]
    behind = -centre / math.cos(root)
    file.put(settings, CENTRE, behind)
    file.put(settings, BASE, values["sliding_base"] - behind * math.sin(root))
    ratio = values.get("ratio_of_roll")
    file.put(settings, RATIO, 1.0 / ratio if ratio else None)
    for key, attribute in BLADE.items():
        if not file.put(tool, attribute, values.get(key)) and key in values:
            # a sharp edge, which the format does not have
            file.unsaid.add(f"{stem}.{key}")
    wider = 0.0 if name == "pinion" else (0.5 if side == "concave" else -0.5) * values["point_width"]
    file.put(tool, TIP, values["tip_radius"] + wider)
    blade = values.get(f"{'outside' if side == 'concave' else 'inside'}.blade_angle", values["blade_angle"])
    file.put(tool, ANGLE, blade)


def _keys_given(file: StageWriter, name: str) -> list[str]:
    """Keys of both sides of a member that attributes say."""
    stems = ("pinion.concave", "pinion.convex") if name == "pinion" else ("gear.cutter",)
    said = {*MACHINE, *BLADE, "machine_centre_to_back", "sliding_base", "ratio_of_roll", "tip_radius", "blade_angle"}
    said |= {"point_width", "outside.blade_angle", "inside.blade_angle"}
    given = [f"{stem}.{key}" for stem in stems for key in said]
    return [key for key in given if key in file.keys and key not in file.unsaid]


BEVEL = StageForm((STAGE,), read_bevel, write_bevel, lambda file: not is_hypoid(file))
HYPOID = StageForm((STAGE,), read_bevel, write_bevel, is_hypoid)
