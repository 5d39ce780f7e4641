"""Worm stages of REXS models as worm drives, and back.

The format has no hand of the thread: a left-hand worm has a negative lead angle.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.worm_drive.design import FORMS_OF

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

STAGE, WORM, WHEEL = "worm_stage", "worm_gear", "worm_wheel"
FLANK, SETTINGS = "worm_gear_flank", "worm_gear_manufacturing_settings"
DISK, HOB = "worm_grinding_disc_tool", "worm_wheel_hob_tool"
MEMBERS = ("worm", "wheel")
#: keys of module and diameter, and all that other attributes give
SIZES = ("module", "diametral_pitch", "module_section", "worm.reference_diameter", "worm.quotient", "worm.lead_angle")
GIVEN = (*SIZES, "kind", "units", "pressure_angle", "worm.form", "worm.right_hand")
DIAMETER, TIP, ROOT = "reference_diameter_worm_gear", "tip_diameter_worm_gear", "root_diameter_worm_gear"


def read_worm_drive(file: StageReader) -> dict[str, Any]:
    """Keys of the design of a stage."""
    stage, own = file.stage, file.own_keys(file.stage)
    worm, wheel = sorted(file.gears(), key=lambda one: one.type != WORM)
    lead = file.number(worm, "lead_angle_worm_gear", "deg")
    diameter, axial = file.number(worm, DIAMETER, "mm"), file.number(worm, "axial_module", "mm")
    normal = file.number(worm, "normal_module", "mm")
    form = file.text(worm, "flank_form")
    if axial is None and normal is None:
        raise file.refusal(worm, "axial_module", "missing")
    by_axial = axial is not None and own.get("module_section") != "normal"
    module = axial if axial is not None else (normal or 0.0) / math.cos(math.radians(abs(lead or 0.0)))
    keys: dict[str, Any] = {
        "kind": "worm_drive",
        "units": "mm",
        "name": stage.name or None,
        **own,
        "module": axial if by_axial else normal,
        "module_section": "axial" if by_axial else "normal",
        "pressure_angle": file.number(worm, "pressure_angle_worm_gear", "deg"),
        "center_distance": file.number(stage, "center_distance", "mm"),
        "worm.threads": file.count(worm, "number_of_teeth"),
        "worm.form": None if form is None else form.upper(),
        "worm.length": file.number(worm, "length_worm_gear", "mm"),
        "worm.reference_diameter": diameter,
        "worm.lead_angle": abs(lead) if lead and diameter is None else None,
        "wheel.teeth": file.count(wheel, "number_of_teeth"),
        "wheel.face_width": file.number(wheel, "face_width_worm_wheel", "mm"),
        "wheel.profile_shift": file.number(wheel, "addendum_modification_coefficient_worm_wheel"),
        "wheel.throat_radius": file.number(wheel, "throat_radius_worm_wheel", "mm"),
        "wheel.outside_diameter": file.number(wheel, "outer_diameter_worm_wheel", "mm"),
    }
    if lead:
        keys["worm.right_hand"] = lead > 0.0
    if keys["center_distance"] is not None:
        # the one follows from the other
        keys["wheel.profile_shift"] = None
    if diameter is not None:
        tip, root = file.number(worm, TIP, "mm"), file.number(worm, ROOT, "mm")
        keys["worm.addendum"] = None if tip is None else (tip - diameter) / (2.0 * module)
        keys["worm.dedendum"] = None if root is None else (diameter - root) / (2.0 * module)
    _read_tools(file, worm, wheel, module, keys)
    for name, one in zip(MEMBERS, (worm, wheel), strict=True):
        for material in file.references(one, "material"):
            keys[f"{name}.material.youngs_modulus"] = file.number(material, "elastic_modulus", "N / mm^2")
            keys[f"{name}.material.poisson_ratio"] = file.number(material, "poisson_ratio")
    return {key: value for key, value in keys.items() if value is not None}


def _read_tools(file: StageReader, worm: Component, wheel: Component, module: float, keys: dict[str, Any]) -> None:
    for gear in (worm, wheel):
        for flank in file.flanks(gear).values():
            for tool, _ in file.steps(flank):
                if tool.type == DISK:
                    attributes = {"disk_diameter": "grinding_disk_diameter", "profile_radius": "profile_radius_zc_disc"}
                    for key, attribute in attributes.items():
                        if (keys["worm.form"] or "ZI") in FORMS_OF[key]:
                            keys[f"worm.{key}"] = file.number(tool, attribute, "mm")
                if tool.type == HOB:
                    height = file.number(tool, "tooth_addendum_worm_wheel_hob", "mm")
                    tip = file.number(tool, TIP, "mm")
                    keys["hob.threads"] = file.count(tool, "number_of_teeth")
                    keys["hob.addendum"] = None if height is None else height / module
                    keys["hob.reference_diameter"] = None if height is None or tip is None else tip - 2.0 * height


def write_worm_drive(file: StageWriter, design: WormDriveDesign, known: Component | None) -> Component:
    """A complete design in mm, all of it stated."""
    stage = file.stage(STAGE, known, design.name or "")
    worm, wheel = file.gears(stage, (WORM, WHEEL), MEMBERS)
    module, spec = design.axial_module, design.worm
    diameter, form = design.reference_diameter, str(spec.form).lower()
    sense = 1.0 if spec.right_hand else -1.0
    file.put(stage, "center_distance", file.take("center_distance"), "mm")
    file.put(stage, "gear_ratio", design.wheel.teeth / spec.threads)
    for one in (worm, wheel):
        file.choose(one, "flank_form", form)
        file.put(one, "axial_module", module, "mm")
        file.put(one, "normal_module", design.normal_module, "mm")
        file.put(one, "pressure_angle_worm_gear", design.pressure_angle, "deg")
    file.put(worm, "number_of_teeth", file.take("worm.threads"))
    file.put(worm, DIAMETER, diameter, "mm")
    file.put(worm, "form_factor_worm_gear", diameter / module)
    file.put(worm, "lead_angle_worm_gear", sense * math.degrees(design.lead_angle), "deg")
    file.put(worm, "lead", sense * math.pi * module * spec.threads, "mm")
    file.put(worm, "length_worm_gear", file.take("worm.length"), "mm")
    file.put(worm, TIP, diameter + 2.0 * module * file.take("worm.addendum"), "mm")
    file.put(worm, ROOT, diameter - 2.0 * module * file.take("worm.dedendum"), "mm")
    reference = design.wheel_reference_diameter
    file.put(wheel, "number_of_teeth", file.take("wheel.teeth"))
    file.put(wheel, DIAMETER, reference, "mm")
    file.put(wheel, "face_width_worm_wheel", file.take("wheel.face_width"), "mm")
    file.put(wheel, "addendum_modification_coefficient_worm_wheel", file.take("wheel.profile_shift"))
    file.put(wheel, "throat_radius_worm_wheel", file.take("wheel.throat_radius"), "mm")
    file.put(wheel, "outer_diameter_worm_wheel", file.take("wheel.outside_diameter"), "mm")
    file.put(wheel, TIP, reference + 2.0 * module * (design.wheel.profile_shift + design.wheel.addendum), "mm")
    _write_tools(file, design, worm, wheel, form)
    for name, one in zip(MEMBERS, (worm, wheel), strict=True):
        material = file.refer(one, "material", f"{name} (material)")
        for key, attribute, unit in (
            ("youngs_modulus", "elastic_modulus", "N / mm^2"),
            ("poisson_ratio", "poisson_ratio", "none"),
        ):
            file.put(
                material, attribute, file.keys.get(f"{name}.material.{key}", file.keys.get(f"material.{key}")), unit
            )
    for key in GIVEN:
        file.take(key)
    if design.module_section == "normal":
        file.keys["module_section"] = "normal"
    return stage


def _write_tools(file: StageWriter, design: WormDriveDesign, worm: Component, wheel: Component, form: str) -> None:
    module = design.axial_module
    ground = (
        {key: file.take(f"worm.{key}") for key in ("disk_diameter", "profile_radius")} if form in ("zk", "zc") else {}
    )
    hob = {key: file.take(f"hob.{key}") for key in ("threads", "addendum", "reference_diameter")}
    shared: Component | None = None
    if ground:
        for flank in file.flanks(worm, FLANK).values():
            shared, _ = file.step(flank, DISK, SETTINGS, shared)
            file.choose(shared, "flank_form", form)
            file.put(shared, "grinding_disk_diameter", ground["disk_diameter"], "mm")
            file.put(shared, "profile_radius_zc_disc", ground["profile_radius"] if form == "zc" else None, "mm")
        if form == "zk":
            file.keys["worm.profile_radius"] = ground["profile_radius"]
    if design.wheel.form == "helical":
        file.keys["hob.addendum"] = hob["addendum"]
        return
    shared = None
    for flank in file.flanks(wheel, FLANK).values():
        shared, _ = file.step(flank, HOB, SETTINGS, shared)
        file.put(shared, "number_of_teeth", hob["threads"])
        height, across = hob["addendum"] * module, hob["reference_diameter"]
        file.put(shared, "tooth_addendum_worm_wheel_hob", height, "mm")
        file.put(shared, TIP, None if across is None else across + 2.0 * height, "mm")


WORM_DRIVE = StageForm((STAGE,), read_worm_drive, write_worm_drive)
