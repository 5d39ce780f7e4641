"""Conversion of worm stages of REXS models to worm drives, and back.

The format has no hand of the thread: a left-hand worm has a negative lead angle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.worm_drive.design import FORMS_WITH_KEY

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: type of the component of a stage
STAGE_TYPE = "worm_stage"
#: type of the component of a worm
WORM_TYPE = "worm_gear"
#: type of the component of a wheel
WHEEL_TYPE = "worm_wheel"
#: type of the component of a flank
FLANK_TYPE = "worm_gear_flank"
#: type of the component of machine settings
SETTINGS_TYPE = "worm_gear_manufacturing_settings"
#: type of the component of a grinding disk
DISK_TYPE = "worm_grinding_disc_tool"
#: type of the component of a hob
HOB_TYPE = "worm_wheel_hob_tool"
#: names of the members in order
MEMBER_NAMES = ("worm", "wheel")
#: decimals of heights in modules that follow from diameters of a file
HEIGHT_DIGITS = 12
#: keys of module and diameter
SIZE_KEYS = (
    "module",
    "diametral_pitch",
    "module_section",
    "worm.reference_diameter",
    "worm.quotient",
    "worm.lead_angle",
)
#: keys that other attributes give
GIVEN_KEYS = (*SIZE_KEYS, "kind", "units", "pressure_angle", "worm.form", "worm.right_hand")
#: attribute of the wheel's profile shift
WHEEL_SHIFT_ATTRIBUTE = "addendum_modification_coefficient_worm_wheel"
#: attribute of the reference diameter
DIAMETER_ATTRIBUTE = "reference_diameter_worm_gear"
#: attribute of the tip diameter
TIP_ATTRIBUTE = "tip_diameter_worm_gear"
#: attribute of the root diameter
ROOT_ATTRIBUTE = "root_diameter_worm_gear"


def read_worm_drive(file: StageReader) -> dict[str, Any]:
    """Return the keys of the design of a stage."""
    stage, own_keys = file.stage, file.own_keys(file.stage)
    worm, wheel = sorted(file.gears(), key=lambda one: one.type != WORM_TYPE)
    lead = file.number(worm, "lead_angle_worm_gear", "worm.lead_angle", zero=True)
    diameter = file.number(worm, DIAMETER_ATTRIBUTE, "worm.reference_diameter")
    axial, normal = file.number(worm, "axial_module", "module"), file.number(worm, "normal_module", "module")
    form = file.text(worm, "flank_form", "worm.form")
    if axial is None and normal is None:
        raise file.refusal(worm, "axial_module", "missing, and so is normal_module")
    by_axial = axial is not None and own_keys.get("module_section") != "normal"
    module = axial if axial is not None else (normal or 0.0) / math.cos(math.radians(abs(lead or 0.0)))
    quotient = file.number(worm, "form_factor_worm_gear", "worm.quotient")
    if diameter is None and quotient is not None:
        diameter = quotient * module
    keys: dict[str, Any] = {
        "kind": "worm_drive",
        "units": "mm",
        "name": stage.name or None,
        **own_keys,
        "module": axial if by_axial else normal,
        "module_section": "axial" if by_axial else "normal",
        "pressure_angle": _either(file, (worm, wheel), "pressure_angle_worm_gear", "pressure_angle"),
        "center_distance": file.size(stage, "center_distance", "center_distance"),
        "worm.threads": file.required_count(worm, "number_of_teeth", "worm.threads"),
        "worm.form": None if form is None else form.upper(),
        "worm.length": file.number(worm, "length_worm_gear", "worm.length"),
        "worm.reference_diameter": diameter,
        "worm.lead_angle": abs(lead) if lead and diameter is None else None,
        "wheel.teeth": file.required_count(wheel, "number_of_teeth", "wheel.teeth"),
        "wheel.face_width": _width(file, wheel),
        "wheel.profile_shift": file.number(wheel, WHEEL_SHIFT_ATTRIBUTE, "wheel.profile_shift"),
        "wheel.throat_radius": file.number(wheel, "throat_radius_worm_wheel", "wheel.throat_radius"),
        "wheel.outside_diameter": file.number(wheel, "outer_diameter_worm_wheel", "wheel.outside_diameter"),
    }
    left = lead is not None and lead < 0.0
    if lead or file.is_negative(worm, "number_of_teeth"):
        keys["worm.right_hand"] = not (left or file.is_negative(worm, "number_of_teeth"))
    if diameter is not None:
        tip, root = (
            file.number(worm, TIP_ATTRIBUTE, "worm.addendum"),
            file.number(worm, ROOT_ATTRIBUTE, "worm.dedendum"),
        )
        keys["worm.addendum"] = None if tip is None else round(0.5 * (tip - diameter) / module, HEIGHT_DIGITS)
        keys["worm.dedendum"] = None if root is None else round(0.5 * (diameter - root) / module, HEIGHT_DIGITS)
    _read_tools(file, worm, wheel, module, keys)
    _read_wheel_heights(file, wheel, module, keys)
    if keys["center_distance"] is not None:
        # the profile shift follows from the centre distance
        keys["wheel.profile_shift"] = None
    keys |= file.materials(dict(zip(MEMBER_NAMES, (worm, wheel), strict=True)))
    return {key: value for key, value in keys.items() if value is not None}


def _either(file: StageReader, gears: tuple[Component, Component], id: str, key: str) -> float | None:
    """Return a value that both gears of a stage may have: that of the first gear that has it."""
    values = [file.number(gear, id, key) for gear in gears]
    return next((value for value in values if value is not None), None)


def _width(file: StageReader, wheel: Component) -> float | None:
    """Return the face width of the wheel, else its effective face width, else the width of its rim."""
    for id in ("face_width_worm_wheel", "effective_face_width_worm_wheel", "rim_width_worm_wheel"):
        if (width := file.number(wheel, id, "wheel.face_width")) is not None:
            if not id.startswith("face_width"):
                file.notes.append(f"{wheel}: no face_width_worm_wheel in the file: {id} is taken")
            return width
    return None


def _read_wheel_heights(file: StageReader, wheel: Component, module: float, keys: dict[str, Any]) -> None:
    """Read the addendum of the wheel and of its hob from the diameters of the wheel in the middle plane."""
    reference = module * keys["wheel.teeth"]
    shift, distance, worm = keys["wheel.profile_shift"], keys["center_distance"], keys["worm.reference_diameter"]
    if shift is None and distance is not None and worm is not None:
        shift = (distance - 0.5 * (worm + reference)) / module
    if shift is None or "wheel.addendum" in keys:
        return
    file.number(wheel, DIAMETER_ATTRIBUTE)
    tip, root = file.number(wheel, TIP_ATTRIBUTE, "wheel.addendum"), file.number(wheel, ROOT_ATTRIBUTE, "hob.addendum")
    if tip is not None:
        keys["wheel.addendum"] = round(0.5 * (tip - reference) / module - shift, HEIGHT_DIGITS)
    if root is not None and keys.get("hob.addendum") is None:
        keys["hob.addendum"] = round(0.5 * (reference - root) / module + shift, HEIGHT_DIGITS)


def _read_tools(file: StageReader, worm: Component, wheel: Component, module: float, keys: dict[str, Any]) -> None:
    """Read the disk of the worm and the hob of the wheel."""
    tools = [tool for gear in (worm, wheel) for flank in file.flanks(gear).values() for tool, _ in file.steps(flank)]
    for tool in tools:
        if tool.type == DISK_TYPE:
            attributes = {"disk_diameter": "grinding_disk_diameter", "profile_radius": "profile_radius_zc_disc"}
            for key, attribute in attributes.items():
                if (keys["worm.form"] or "ZI") in FORMS_WITH_KEY[key]:
                    keys[f"worm.{key}"] = file.number(tool, attribute, f"worm.{key}")
        if tool.type == HOB_TYPE:
            height = file.number(tool, "tooth_addendum_worm_wheel_hob", "hob.addendum")
            tip = file.number(tool, TIP_ATTRIBUTE, "hob.reference_diameter")
            keys["hob.threads"] = file.count(tool, "number_of_teeth", "hob.threads")
            keys["hob.addendum"] = None if height is None else height / module
            keys["hob.reference_diameter"] = None if height is None or tip is None else tip - 2.0 * height


def write_worm_drive(file: StageWriter, design: WormDriveDesign, known: Component | None) -> Component:
    """Write a complete design in mm with all values stated; return the component of its stage."""
    stage = file.stage(STAGE_TYPE, known, design.name or "")
    worm, wheel = file.gears(stage, (WORM_TYPE, WHEEL_TYPE), MEMBER_NAMES)
    module, spec = design.axial_module, design.worm
    diameter, form = design.reference_diameter, str(spec.form).lower()
    sense = 1.0 if spec.right_hand else -1.0
    file.put(stage, "center_distance", file.take("center_distance"))
    file.put(stage, "gear_ratio", design.wheel.teeth / spec.threads)
    for gear in (worm, wheel):
        file.put(gear, "flank_form", form)
        file.put(gear, "axial_module", module)
        file.put(gear, "normal_module", design.normal_module)
        file.put(gear, "pressure_angle_worm_gear", design.pressure_angle)
    file.put(worm, "number_of_teeth", file.take("worm.threads"))
    file.put(worm, DIAMETER_ATTRIBUTE, diameter)
    file.put(worm, "form_factor_worm_gear", diameter / module)
    file.put(worm, "lead_angle_worm_gear", sense * math.degrees(design.lead_angle))
    file.put(worm, "lead", math.pi * module * spec.threads)
    file.put(worm, "length_worm_gear", file.take("worm.length"))
    file.put(worm, TIP_ATTRIBUTE, diameter + 2.0 * module * file.take("worm.addendum"))
    file.put(worm, ROOT_ATTRIBUTE, diameter - 2.0 * module * file.take("worm.dedendum"))
    reference = design.wheel_reference_diameter
    file.put(wheel, "number_of_teeth", file.take("wheel.teeth"))
    file.put(wheel, DIAMETER_ATTRIBUTE, reference)
    file.put(wheel, "face_width_worm_wheel", file.take("wheel.face_width"))
    file.put(wheel, WHEEL_SHIFT_ATTRIBUTE, file.take("wheel.profile_shift"))
    file.put(wheel, "throat_radius_worm_wheel", file.take("wheel.throat_radius"))
    file.put(wheel, "outer_diameter_worm_wheel", file.take("wheel.outside_diameter"))
    file.put(wheel, TIP_ATTRIBUTE, reference + 2.0 * module * (design.wheel.profile_shift + design.wheel.addendum))
    _write_tools(file, design, worm, wheel, form)
    for name, gear in zip(MEMBER_NAMES, (worm, wheel), strict=True):
        file.put_material(gear, name)
    for key in GIVEN_KEYS:
        file.take(key)
    if design.module_section == "normal":
        file.keys["module_section"] = "normal"
    return stage


def _write_tools(file: StageWriter, design: WormDriveDesign, worm: Component, wheel: Component, form: str) -> None:
    """Write the disk of the worm and the hob of the wheel."""
    module = design.axial_module
    ground = (
        {key: file.take(f"worm.{key}") for key in ("disk_diameter", "profile_radius")} if form in ("zk", "zc") else {}
    )
    hob = {key: file.take(f"hob.{key}") for key in ("threads", "addendum", "reference_diameter")}
    shared: Component | None = None
    if ground:
        for flank in file.flanks(worm, FLANK_TYPE).values():
            shared, _ = file.step(flank, DISK_TYPE, SETTINGS_TYPE, shared)
            file.put(shared, "flank_form", form)
            file.put(shared, "grinding_disk_diameter", ground["disk_diameter"])
            file.put(shared, "profile_radius_zc_disc", ground["profile_radius"] if form == "zc" else None)
        if form == "zk":
            file.keys["worm.profile_radius"] = ground["profile_radius"]
    if design.wheel.form == "helical":
        file.keys["hob.addendum"] = hob["addendum"]
        return
    shared = None
    for flank in file.flanks(wheel, FLANK_TYPE).values():
        shared, _ = file.step(flank, HOB_TYPE, SETTINGS_TYPE, shared)
        file.put(shared, "number_of_teeth", hob["threads"])
        height, across = hob["addendum"] * module, hob["reference_diameter"]
        file.put(shared, "tooth_addendum_worm_wheel_hob", height)
        file.put(shared, TIP_ATTRIBUTE, None if across is None else across + 2.0 * height)


#: stages of worm drives
WORM_DRIVE = StageForm((STAGE_TYPE,), read_worm_drive, write_worm_drive)
