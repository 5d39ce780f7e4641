"""One gear of a cylindrical stage in REXS models: its toothing, flanks, tool and material."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.cylindrical.rexs.flank_changes import read_changes, write_changes

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions

EXTERNAL, INTERNAL = "cylindrical_gear", "ring_gear"
FLANK, SETTINGS = "cylindrical_gear_flank", "cylindrical_gear_manufacturing_settings"
HOB, CUTTER = "rack_shaped_tool", "cutter_wheel_tool"
#: figures of two gears or flanks that are the same but for rounding
SAME = 1e-9


class GearReader:
    """A gear as the file has it."""

    def __init__(self, file: StageReader, gear: Component) -> None:
        self.file, self.gear = file, gear
        teeth = file.required_number(gear, "number_of_teeth")
        if teeth != int(teeth) or not teeth:
            raise file.refusal(gear, "number_of_teeth", "not a whole number above zero", teeth)
        self.teeth = abs(int(teeth))
        self.internal = gear.type == INTERNAL or teeth < 0
        self.flanks = file.flanks(gear)
        self.beta = file.number(gear, "helix_angle_reference_diameter", "deg") or 0.0

    def module(self) -> float:
        """Normal module, mm."""
        normal = self.file.number(self.gear, "normal_module", "mm")
        transverse = self.file.number(self.gear, "transverse_module", "mm")
        if normal is None and transverse is not None:
            return transverse * math.cos(math.radians(self.beta))
        return self.file.required_number(self.gear, "normal_module", "mm") if normal is None else normal

    def flank_figure(self, *ids: tuple[str, str, float]) -> float | None:
        """The first of some attributes (id, unit, what it is multiplied by) that a flank has; both flanks must have the same."""
        for id, unit, scale in ids:
            values = [self.file.number(flank, id, unit) for flank in self.flanks.values()]
            known = [value * scale for value in values if value is not None]
            if known and max(known) - min(known) > SAME:
                flank = self.flanks["left"]
                raise self.file.refusal(flank, id, "the right flank has another one; flanks must be alike", known[0])
            if known:
                return known[0]
        return None

    def keys(self, module: float, alpha: float, beta: float) -> dict[str, Any]:
        """Keys of the gear in a design of that module (mm), normal pressure angle and helix angle (deg)."""
        file, gear = self.file, self.gear
        keys: dict[str, Any] = {"teeth": self.teeth, "internal": self.internal}
        keys["face_width"] = file.required_number(gear, "face_width", "mm")
        shift = self.flank_figure(
            ("addendum_modification_coefficient", "none", 1.0), ("addendum_modification", "mm", 1.0 / module)
        )
        keys["profile_shift"] = shift
        keys["tip_chamfer"] = self.flank_figure(("tooth_tip_chamfer", "mm", 1.0)) or None
        if not self.internal:
            keys["bore"] = file.number(gear, "inner_diameter", "mm")
        keys |= self._tip(module, beta, shift or 0.0)
        keys |= self._tool(module)
        if not any(keys.get(key) is not None for key in ("dedendum", "shaper.addendum")):
            keys["root_diameter"] = self._root(module, beta, shift or 0.0)
        keys |= self._thickness(module, alpha, shift)
        for one in file.references(gear, "material"):
            keys["material.youngs_modulus"] = file.number(one, "elastic_modulus", "N / mm^2")
            keys["material.poisson_ratio"] = file.number(one, "poisson_ratio")
        tip, base = keys.get("tip_diameter"), self._base(module, alpha, beta)
        keys |= read_changes(file, self.flanks, lambda end, length: _start(end, length, tip, base))
        return {key: value for key, value in keys.items() if value is not None}

    def _reference(self, module: float, beta: float) -> float:
        return self.teeth * module / math.cos(math.radians(beta))

    def _base(self, module: float, alpha: float, beta: float) -> float:
        transverse = math.atan(math.tan(math.radians(alpha)) / math.cos(math.radians(beta)))
        return self._reference(module, beta) * math.cos(transverse)

    def _beyond(self, diameter: float, module: float, beta: float, shift: float) -> float:
        """How far a diameter lies towards the tip of the shifted pitch plane, in modules."""
        sense = -1.0 if self.internal else 1.0
        return sense * (diameter - self._reference(module, beta)) / (2.0 * module) - shift

    def _tip(self, module: float, beta: float, shift: float) -> dict[str, Any]:
        diameter = self.file.number(self.gear, "tip_diameter", "mm")
        if diameter and self._beyond(abs(diameter), module, beta, shift) > 0.0:
            return {"tip_diameter": abs(diameter)}
        if diameter:
            self.file.notes.append(f"{self.gear}: tip_diameter = {diameter:g} mm is not used: no tooth is that low")
            self.file.used.discard((self.gear.id, "tip_diameter"))
        return {"addendum": self.flank_figure(("addendum_coefficient_basic_profile", "none", 1.0))}

    def _root(self, module: float, beta: float, shift: float) -> float | None:
        diameter = self.file.number(self.gear, "root_diameter", "mm")
        if diameter and self._beyond(abs(diameter), module, beta, shift) < 0.0:
            return abs(diameter)
        if diameter:
            self.file.notes.append(f"{self.gear}: root_diameter = {diameter:g} mm is not used: no tooth is that short")
            self.file.used.discard((self.gear.id, "root_diameter"))
        return None

    def _tool(self, module: float) -> dict[str, Any]:
        """Of the first step that generates teeth; both flanks have the same."""
        for flank in self.flanks.values():
            for tool, settings in self.file.steps(flank):
                if tool.type == HOB and not self.internal:
                    return self._hob(tool, settings, module)
                if tool.type == CUTTER:
                    return self._cutter(tool, module)
        self.file.notes.append(
            f"{self.gear}: no tool in the file: root and fillet are those of the basic rack, profile A"
        )
        return {}

    def _relative(self, tool: Component, factor: str, length: str, module: float) -> float | None:
        """A length in modules."""
        relative, absolute = self.file.number(tool, factor), self.file.number(tool, length, "mm")
        return absolute / module if relative is None and absolute is not None else relative

    def _hob(self, tool: Component, settings: Component | None, module: float) -> dict[str, Any]:
        file = self.file
        keys: dict[str, Any] = {
            "dedendum": self._relative(
                tool, "addendum_coefficient_reference_profile", "addendum_reference_profile", module
            ),
            "tool_tip_radius": self._relative(tool, "tip_radius_factor", "tip_radius", module),
        }
        protuberance = self._relative(tool, "protuberance_amount_factor", "protuberance_amount", module)
        if protuberance:
            keys["hob.protuberance"] = protuberance * module
            keys["hob.protuberance_angle"] = file.number(tool, "protuberance_angle", "deg")
        if settings is not None:
            keys["hob.stock"] = file.number(settings, "machining_allowance", "mm") or None
        for id, unit in (("normal_module", "mm"), ("normal_pressure_angle", "deg")):
            file.number(tool, id, unit)
        return keys

    def _cutter(self, tool: Component, module: float) -> dict[str, Any]:
        file, shift = self.file, self.file.number(tool, "addendum_modification_coefficient") or 0.0
        height = self._relative(tool, "addendum_coefficient_reference_profile", "addendum_reference_profile", module)
        keys = {
            "shaper.teeth": int(file.required_number(tool, "number_of_teeth")),
            "shaper.profile_shift": shift,
            "shaper.addendum": None if height is None else height + shift,
            "tool_tip_radius": self._relative(tool, "tip_radius_factor", "tip_radius", module),
        }
        for id, unit in (("normal_module", "mm"), ("normal_pressure_angle", "deg")):
            file.number(tool, id, unit)
        return keys

    def _thickness(self, module: float, alpha: float, shift: float | None) -> dict[str, Any]:
        upper = self.file.number(self.gear, "chordal_tooth_thickness_upper_deviation", "mm")
        lower = self.file.number(self.gear, "chordal_tooth_thickness_lower_deviation", "mm")
        if upper is not None and lower is not None:
            return {"thickness_allowance.upper": upper, "thickness_allowance.lower": lower}
        for flank in self.flanks.values():
            for _, settings in self.file.steps(flank):
                if settings is None:
                    continue
                generated = self.file.number(settings, "generated_addendum_modification_coefficient")
                if generated is not None and shift is not None and abs(generated - shift) > SAME:
                    allowance = 2.0 * (generated - shift) * module * math.tan(math.radians(alpha))
                    made = {"thickness_allowance.upper": allowance, "thickness_allowance.lower": allowance}
                    return {**made, "allowance_by": "feed"}
        return {}


def _start(end: str, length: float, tip: float | None, base: float) -> float | None:
    """Diameter at which a tip relief of so long a part of the roll length begins."""
    if end != "tip_relief" or tip is None or tip <= base:
        return None
    roll = math.sqrt(tip**2 - base**2) - 2.0 * length
    return math.hypot(base, roll) if roll > 0.0 else None


def write_gear(file: StageWriter, gear: Component, of: GearProportions, name: str, materials: bool = True) -> None:
    """A gear of a complete design in mm: figures that are derived too, for programs that need them."""
    own, keys = of.own, file.keys
    module, alpha = own.module, keys.get("pressure_angle", math.degrees(own.alpha))
    file.put(gear, "number_of_teeth", -own.teeth if own.internal else own.teeth)
    file.put(gear, "normal_module", module, "mm")
    file.put(gear, "helix_angle_reference_diameter", math.copysign(keys["helix_angle"], own.beta), "deg")
    file.put(gear, "face_width", file.take(f"{name}.face_width"), "mm")
    file.put(gear, "reference_circle_diameter", 2.0 * own.radius, "mm")
    file.put(gear, "base_circle_diameter", 2.0 * own.base_radius, "mm")
    file.put(gear, "tip_diameter", 2.0 * of.tip, "mm")
    file.put(gear, "root_diameter", 2.0 * of.root, "mm")
    if not own.internal:
        file.put(gear, "inner_diameter", file.take(f"{name}.bore"), "mm")
    for key in ("teeth", "internal", "addendum", "tip_alteration", "tip_diameter", "root_diameter"):
        file.take(f"{name}.{key}")
    _write_thickness(file, gear, of, name)
    flanks = file.flanks(gear, FLANK)
    chamfer = file.take(f"{name}.tip_chamfer")
    for flank in flanks.values():
        file.put(flank, "normal_pressure_angle", alpha, "deg")
        file.put(flank, "addendum_modification_coefficient", own.shift)
        file.put(flank, "tooth_tip_chamfer", chamfer, "mm")
    file.take(f"{name}.profile_shift")
    if keys.get(f"{name}.manufacture") == "generated":
        _write_tool(file, flanks, of, name)
    write_changes(file, name, flanks)
    modulus, ratio = (
        keys.get(f"{name}.material.{key}", keys.get(f"material.{key}")) for key in ("youngs_modulus", "poisson_ratio")
    )
    if materials:
        material = file.refer(gear, "material", f"{gear.name} (material)")
        file.put(material, "elastic_modulus", modulus, "N / mm^2")
        file.put(material, "poisson_ratio", ratio)


def _write_thickness(file: StageWriter, gear: Component, of: GearProportions, name: str) -> None:
    """Allowances of the thickness: those given, or the one that the backlash makes."""
    given = [file.keys.get(f"{name}.thickness_allowance.{end}") for end in ("upper", "lower")]
    others = any(key.startswith(tuple(f"{name}.{by}." for by in ("span", "balls", "pins"))) for key in file.keys)
    if others or file.keys.get(f"{name}.thickness_allowance.series"):
        return
    if None not in given:
        for end in ("upper", "lower"):
            file.take(f"{name}.thickness_allowance.{end}")
    upper, lower = given if None not in given else (of.own.allowance, of.own.allowance)
    file.put(gear, "chordal_tooth_thickness_upper_deviation", upper, "mm")
    file.put(gear, "chordal_tooth_thickness_lower_deviation", lower, "mm")


def _write_tool(file: StageWriter, flanks: dict[str, Component], of: GearProportions, name: str) -> None:
    type, shared = CUTTER if of.spec.shaped else HOB, None
    module, alpha = of.own.module, file.keys.get("pressure_angle", math.degrees(of.own.alpha))
    taken: dict[str, Any] = {}

    def once(key: str) -> Any:
        if key not in taken:
            taken[key] = file.take(f"{name}.{key}")
        return taken[key]

    fixed_root = f"{name}.root_diameter" in file.keys
    for flank in flanks.values():
        tool, settings = file.step(flank, type, SETTINGS, shared)
        shared = tool
        file.put(tool, "normal_module", module, "mm")
        file.put(tool, "normal_pressure_angle", alpha, "deg")
        file.put(tool, "tip_radius_factor", once("tool_tip_radius"))
        if type == CUTTER:
            file.put(tool, "number_of_teeth", once("shaper.teeth"))
            file.put(tool, "addendum_modification_coefficient", once("shaper.profile_shift"))
            height = once("shaper.addendum")
            file.put(
                tool,
                "addendum_coefficient_reference_profile",
                None if height is None else height - (once("shaper.profile_shift") or 0.0),
            )
            continue
        file.put(tool, "addendum_coefficient_reference_profile", None if fixed_root else once("dedendum"))
        file.put(tool, "protuberance_amount", once("hob.protuberance") or None, "mm")
        file.put(tool, "protuberance_angle", once("hob.protuberance_angle"), "deg")
        file.put(settings, "machining_allowance", once("hob.stock"), "mm")
