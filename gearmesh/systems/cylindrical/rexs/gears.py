"""One gear of a cylindrical stage in REXS models: its toothing, flanks, tool and material."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.exchange.versions import SETTINGS_ATTRIBUTES
from gearmesh.systems.common.racks.rack_tooth import tip_rounding
from gearmesh.systems.common.standards import din3967, iso286
from gearmesh.systems.cylindrical.rexs.flank_changes import read_changes, write_changes
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions

#: component of an external gear
EXTERNAL_GEAR = "cylindrical_gear"
#: component of an internal gear
INTERNAL_GEAR = "ring_gear"
#: component of a flank
FLANK_TYPE = "cylindrical_gear_flank"
#: component of the settings of a manufacturing step
SETTINGS_TYPE = "cylindrical_gear_manufacturing_settings"
#: component of a hob
HOB_TYPE = "rack_shaped_tool"
#: component of a shaper cutter
CUTTER_TYPE = "cutter_wheel_tool"
#: attribute of the tolerance series
SERIES_ATTRIBUTE = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
#: attributes of a tool's tip rounding, in modules and in mm
TIP_RADIUS = "tip_radius_factor", "tip_radius"
#: difference of figures of two gears or flanks that is rounding
FIGURE_ROUNDING = 1e-9
#: decimals of differences of two diameters, mm
DIAMETER_DECIMALS = 9


class GearReader:
    """The gear of a file that becomes the member `name` of a design."""

    def __init__(self, file: StageReader, gear: Component, name: str) -> None:
        self.file, self.gear, self.name = file, gear, name
        self.teeth = file.required_count(gear, "number_of_teeth", f"{name}.teeth")
        self.internal = gear.type == INTERNAL_GEAR or file.is_negative(gear, "number_of_teeth")
        self.flanks = file.flanks(gear)
        self.alphas, self.transverses = (
            self._by_side(id) for id in ("normal_pressure_angle", "pressure_angle_in_the_transverse_section")
        )
        self.beta = self._helix_angle()
        #: -1 for a ring whose profile shift the file counts away from its axis
        self.shift_sense = 1
        #: flanks of the drive side, "left" or "right"; `pressure_angles` says it
        self.drive = "right"

    def _by_side(self, id: str) -> dict[str, float]:
        """Return an attribute of the flanks that have it, by "left" and "right"."""
        values = {side: self.file.number(flank, id) for side, flank in self.flanks.items()}
        return {side: value for side, value in values.items() if value is not None}

    def _helix_angle(self) -> float:
        """Return the helix angle at the reference diameter, deg."""
        beta = self.file.number(self.gear, "helix_angle_reference_diameter", "helix_angle", zero=True)
        base = self.file.number(self.gear, "helix_angle_base_circle", zero=True)
        if beta is None and base and self.alphas:
            alpha, *others = self.alphas.values()
            if any(abs(other - alpha) > FIGURE_ROUNDING for other in others):
                reason = "flanks of different pressure angles have two; helix_angle_reference_diameter is missing"
                raise self.file.refusal(self.gear, "helix_angle_base_circle", reason, base)
            sine = math.sin(math.radians(base)) / math.cos(math.radians(alpha))
            if abs(sine) >= 1.0:
                reason = f"too large for a normal pressure angle of {alpha:g} deg"
                raise self.file.refusal(self.gear, "helix_angle_base_circle", reason, base)
            return math.degrees(math.asin(sine))
        return beta or 0.0

    def pressure_angles(self, drive: str) -> tuple[float, float] | None:
        """Return the normal pressure angles of drive and coast side, deg; None if the file has none.

        `drive`: "left" or "right" flanks of the drive side. A flank without an angle has that of the other flank.
        """
        self.drive = drive
        angles = dict(self.alphas)
        for side, transverse in self.transverses.items():
            tangent = math.tan(math.radians(transverse)) * math.cos(math.radians(self.beta))
            angles.setdefault(side, math.degrees(math.atan(tangent)))
        if not angles:
            return None
        other = "right" if drive == "left" else "left"
        one = next(iter(angles.values()))
        return angles.get(drive, one), angles.get(other, one)

    def module(self) -> float:
        """Return the normal module, mm."""
        number, gear, beta = self.file.number, self.gear, math.radians(self.beta)
        normal, transverse = number(gear, "normal_module", "module"), number(gear, "transverse_module")
        pitch, axial = number(gear, "normal_circular_pitch"), number(gear, "axial_module")
        if normal is not None:
            return normal
        if transverse is not None:
            return transverse * math.cos(beta)
        if pitch is not None:
            return pitch / math.pi
        if axial is not None and beta:
            return axial * abs(math.sin(beta))
        return self.file.required_number(gear, "normal_module")

    def flank_figure(self, *ids: tuple[str, float], key: str = "") -> float | None:
        """Return the first attribute that a flank has, times its scale; both flanks must agree.

        `ids`: pairs of attribute and scale.
        """
        for id, scale in ids:
            values = [(flank, self.file.number(flank, id, key)) for flank in self.flanks.values()]
            known = [(flank, value * scale) for flank, value in values if value is not None]
            for flank, value in known[1:]:
                if abs(value - known[0][1]) > FIGURE_ROUNDING:
                    reason = f"the other flank, {known[0][0].in_full}, has {known[0][1]:g}; flanks must be alike"
                    raise self.file.refusal(flank, id, reason, value)
            if known:
                return known[0][1]
        return None

    def keys(self, module: float, angles: tuple[float, float], beta: float) -> dict[str, Any]:
        """Return the keys of the gear in a design with this module (mm) and these normal angles (deg).

        `angles`: normal pressure angles of drive and coast side. `beta`: helix angle.
        """
        alpha, coast = angles
        file, gear = self.file, self.gear
        keys: dict[str, Any] = {"teeth": self.teeth, "internal": self.internal}
        keys["face_width"] = self._face_width()
        keys["profile_shift"] = shift = self.shift(module)
        keys |= self._tip_chamfers()
        if not self.internal:
            keys["bore"] = file.number(gear, "inner_diameter", f"{self.name}.bore")
        keys |= self._tip(module, beta, shift or 0.0)
        keys |= self._tool(module, angles, beta)
        if not any(keys.get(key) is not None for key in ("dedendum", "shaper.addendum")):
            keys["root_diameter"] = self._root(module, beta, shift or 0.0)
        keys |= self._thickness(module, angles, beta, shift)
        # a length along the path of contact is no diameter where flanks have two base circles
        base = self._base(module, alpha, beta) if alpha == coast else math.inf
        tip = keys.get("tip_diameter")
        keys |= read_changes(file, gear, self.flanks, lambda end, length: _start(end, length, tip, base))
        return {key: value for key, value in keys.items() if value is not None}

    def _tip_chamfers(self) -> dict[str, Any]:
        """Return the keys of the tip chamfers, which both sides may have in different sizes."""
        sizes = self._by_side("tooth_tip_chamfer")
        drive, (coast, *_) = sizes.get(self.drive), [*(v for side, v in sizes.items() if side != self.drive), None]
        if drive and coast and abs(drive - coast) > FIGURE_ROUNDING:
            return {"tip_chamfer": drive, "coast_tip_edge": coast}
        return {"tip_chamfer": self.flank_figure(("tooth_tip_chamfer", 1.0), key=f"{self.name}.tip_chamfer") or None}

    def shift(self, module: float) -> float | None:
        """Return the profile shift, in modules, positive towards the tip of a ring as in ISO 21771."""
        own = ("addendum_modification_coefficient", 1.0), ("addendum_modification", 1.0 / module)
        shift = self.flank_figure(*own, key=f"{self.name}.profile_shift")
        return None if shift is None else self.shift_sense * shift

    def _face_width(self) -> float:
        """Return the face width of the gear, or else the common face width of the stage."""
        width = self.file.number(self.gear, "face_width", f"{self.name}.face_width")
        common = self.file.number(self.file.stage, "common_face_width")
        if width is None and common is None:
            return self.file.required_number(self.gear, "face_width")
        if width is None:
            self.file.notes.append(f"{self.gear}: no face_width in the file: common_face_width of the stage is taken")
        return width or common or 0.0

    def _reference(self, module: float, beta: float) -> float:
        """Return the reference diameter, mm."""
        return self.teeth * module / math.cos(math.radians(beta))

    def _base(self, module: float, alpha: float, beta: float) -> float:
        """Return the base diameter, mm."""
        transverse = math.atan(math.tan(math.radians(alpha)) / math.cos(math.radians(beta)))
        return self._reference(module, beta) * math.cos(transverse)

    def _beyond(self, diameter: float, module: float, beta: float, shift: float) -> float:
        """Return the distance (modules) of a diameter from the shifted pitch plane, positive towards the tip."""
        sense = -1.0 if self.internal else 1.0
        return sense * (diameter - self._reference(module, beta)) / (2.0 * module) - shift

    def _tip(self, module: float, beta: float, shift: float) -> dict[str, Any]:
        """Return the keys of the tip: its diameter and tolerance, or the addendum."""
        diameter = self.file.size(self.gear, "tip_diameter", f"{self.name}.tip_diameter")
        if diameter and self._beyond(diameter, module, beta, shift) > 0.0:
            return {"tip_diameter": diameter, **self._tip_tolerance(diameter)}
        if diameter:
            self.file.notes.append(f"{self.gear}: tip_diameter = {diameter:g} mm is not used: no tooth is that low")
            self.file.used.discard((self.gear.id, "tip_diameter"))
        height = self.flank_figure(("addendum_coefficient_basic_profile", 1.0), key=f"{self.name}.addendum")
        length = self.file.number(self.gear, "addendum_basic_profile", f"{self.name}.addendum")
        return {"addendum": length / module if height is None and length is not None else height}

    def _tip_tolerance(self, diameter: float) -> dict[str, Any]:
        """Return the deviations of the tip diameter, from its limits."""
        largest, smallest = (self.file.size(self.gear, f"{end}_tip_diameter") for end in ("maximum", "minimum"))
        if largest is None or smallest is None:
            return {}
        ends = {"upper": largest - diameter, "lower": smallest - diameter}
        return {f"tip_diameter_tolerance.{end}": round(value, DIAMETER_DECIMALS) for end, value in ends.items()}

    def _root(self, module: float, beta: float, shift: float) -> float | None:
        """Return the root diameter, mm; None if it cannot be used."""
        diameter = self.file.size(self.gear, "root_diameter", f"{self.name}.root_diameter")
        if diameter and self._beyond(diameter, module, beta, shift) < 0.0:
            return diameter
        if diameter:
            self.file.notes.append(f"{self.gear}: root_diameter = {diameter:g} mm is not used: no tooth is that short")
            self.file.used.discard((self.gear.id, "root_diameter"))
        return None

    def _tool(self, module: float, angles: tuple[float, float], beta: float) -> dict[str, Any]:
        """Return the keys of the first step that generates teeth; both flanks have the same step."""
        sides = sorted(self.flanks, key=lambda side: side != self.drive)
        steps = [step for side in sides for step in self.file.steps(self.flanks[side])]
        generating = self._generating(steps)
        for tool, _ in generating:
            if not self._fits(tool, module, angles):
                return {}
            if tool.type == CUTTER_TYPE:
                keys = self._cutter(tool, module, beta)
            else:
                settings = [own for other, own in generating if other is tool and own is not None]
                keys = self._hob(tool, settings, module)
            return keys | self._coast_rounding(sides, tool, keys, module)
        kept = f"{steps[0][0].in_full} generates no root" if steps else "no tool in the file"
        self.file.notes.append(f"{self.gear}: {kept}: root and fillet are those of the basic rack, profile A")
        return {}

    def _generating(self, steps: list[tuple[Component, Component | None]]) -> list[tuple[Component, Component | None]]:
        """Return the steps that generate teeth, those that a ring can have first."""
        generating = [step for step in steps if step[0].type in (HOB_TYPE, CUTTER_TYPE)]
        return sorted(generating, key=lambda step: self.internal and step[0].type != CUTTER_TYPE)

    def _coast_rounding(self, sides: list[str], tool: Component, keys: dict[str, Any], module: float) -> dict[str, Any]:
        """Return the key of the tip rounding of the coast side, whose flank may have a tool of its own.

        `sides`: drive side first. `tool`, `keys`: the tool of the drive side, and its keys.
        """
        *_, coast = sides
        own = next((one for one, _ in self._generating(self.file.steps(self.flanks[coast]))), tool)
        if own is tool or own.type != tool.type:
            return {}
        radius = self._relative(own, *TIP_RADIUS, module, f"{self.name}.coast_tool_tip_radius")
        rounding = keys["tool_tip_radius"]
        same = radius is None or (rounding is not None and abs(radius - rounding) <= FIGURE_ROUNDING)
        return {} if same else {"coast_tool_tip_radius": radius}

    def _fits(self, tool: Component, module: float, angles: tuple[float, float]) -> bool:
        """True if a tool has the gear's module and a pressure angle of its flanks, which a design assumes."""
        for id, wanted in (("normal_module", (module,)), ("normal_pressure_angle", angles)):
            own = self.file.number(tool, id)
            if own is not None and all(abs(own - value) > FIGURE_ROUNDING for value in wanted):
                reason = f"{id} = {own:g} is not the gear's, {wanted[0]:g}"
                self.file.notes.append(
                    f"{self.gear}: {tool.in_full} is not used: {reason}: root and fillet are those of profile A"
                )
                self.file.used -= {(tool.id, name) for name in tool.attributes}
                return False
        return True

    def _relative(self, tool: Component, factor: str, length: str, module: float, key: str = "") -> float | None:
        """Return a length in modules; only a tip rounding may be 0."""
        rounding = factor == "tip_radius_factor"
        relative = self.file.number(tool, factor, key, zero=rounding)
        absolute = self.file.number(tool, length, key)
        return absolute / module if relative is None and absolute is not None else relative

    def _hob(self, tool: Component, settings: list[Component], module: float) -> dict[str, Any]:
        """Return the keys of a hob."""
        file, name = self.file, self.name
        height = "addendum_coefficient_reference_profile", "addendum_reference_profile"
        keys: dict[str, Any] = {
            "dedendum": self._relative(tool, *height, module, f"{name}.dedendum"),
            "tool_tip_radius": self._relative(tool, *TIP_RADIUS, module, f"{name}.tool_tip_radius"),
        }
        if self.internal:
            file.notes.append(
                f"{self.gear}: {tool.in_full} cannot cut an internal gear: a shaper cutter of its height is taken"
            )
            return keys
        protuberance = self._relative(tool, "protuberance_amount_factor", "protuberance_amount", module)
        if protuberance:
            keys["hob.protuberance"] = protuberance * module
            keys["hob.protuberance_angle"] = file.number(tool, "protuberance_angle", f"{name}.hob.protuberance_angle")
        stocks = [file.number(one, "machining_allowance", f"{name}.hob.stock") or 0.0 for one in settings]
        if stocks and max(stocks) - min(stocks) > FIGURE_ROUNDING:
            reason = f"the step of the other flank has {stocks[0]:g}; both must leave the same"
            raise file.refusal(settings[-1], "machining_allowance", reason, stocks[-1])
        keys["hob.stock"] = max(stocks, default=0.0) or None
        return keys

    def _cutter(self, tool: Component, module: float, beta: float) -> dict[str, Any]:
        """Return the keys of a shaper cutter."""
        file, name = self.file, self.name
        teeth = file.required_count(tool, "number_of_teeth", f"{name}.shaper.teeth")
        shift = self._relative(tool, "addendum_modification_coefficient", "addendum_modification", module) or 0.0
        heights = "addendum_coefficient_reference_profile", "addendum_reference_profile"
        height, tip = self._relative(tool, *heights, module), file.size(tool, "tip_diameter")
        if height is not None:
            height += shift
        elif tip is not None:
            height = 0.5 * (tip / module - teeth / math.cos(math.radians(beta)))
        return {
            "shaper.teeth": teeth,
            "shaper.profile_shift": shift,
            "shaper.addendum": height,
            "tool_tip_radius": self._relative(tool, *TIP_RADIUS, module, f"{name}.tool_tip_radius"),
        }

    def _thickness(
        self, module: float, angles: tuple[float, float], beta: float, shift: float | None
    ) -> dict[str, Any]:
        """Return the keys of the thickness allowance: a series, its ends, or the generated profile shift."""
        number, gear, allowance = self.file.number, self.gear, f"{self.name}.thickness_allowance"
        ends = ("upper", "lower")
        normal = [number(gear, f"chordal_tooth_thickness_{end}_deviation", f"{allowance}.{end}") for end in ends]
        series = self.file.text(gear, SERIES_ATTRIBUTE, f"{allowance}.series")
        given = {f"thickness_allowance.{end}": value for end, value in zip(ends, normal, strict=True)}
        if series is not None and (None in normal or _is_series(normal, series, self._reference(module, beta))):
            return {"thickness_allowance.series": series}
        if None not in normal:
            if series is not None:
                self.file.notes.append(
                    f"{self.gear}: {SERIES_ATTRIBUTE} = {series} is not used: the deviations in the file are others"
                )
                self.file.used.discard((self.gear.id, SERIES_ATTRIBUTE))
            return given
        settings = [one for flank in self.flanks.values() for _, one in self.file.steps(flank) if one is not None]
        for one in [*settings, *self.flanks.values()]:
            generated = number(one, "generated_addendum_modification_coefficient")
            if generated is not None and shift is not None and abs(generated - shift) > FIGURE_ROUNDING:
                tangents = sum(math.tan(math.radians(angle)) for angle in angles)
                thinner = (generated - shift) * module * tangents
                made = {f"thickness_allowance.{end}": thinner for end in ends}
                return {**made, "allowance_by": "feed"}
        return {}


def _is_series(ends: list[float | None], series: str, diameter: float) -> bool:
    """True if both ends of an allowance belong to a series [DIN 3967]."""
    if diameter > din3967.DIAMETER_LIMITS_MM[-1]:
        return False
    return all(
        abs((one or 0.0) - own) < FIGURE_ROUNDING
        for one, own in zip(ends, din3967.allowances(series, diameter), strict=True)
    )


def _start(end: str, length: float, tip: float | None, base: float) -> float | None:
    """Return the diameter at which a tip relief of a `length` along the path of contact begins."""
    if end != "tip_relief" or tip is None or tip <= base:
        return None
    roll = math.sqrt(tip**2 - base**2) - 2.0 * length
    return math.hypot(base, roll) if roll > 0.0 else None


def write_gear(file: StageWriter, gear: Component, of: GearProportions, name: str) -> None:
    """Write a gear of a complete design in mm, including derived figures that other programs need."""
    own, keys = of.own, file.keys
    module, angles = own.module, _angles(file, of)
    file.put(gear, "number_of_teeth", own.teeth)
    file.put(gear, "normal_module", module)
    file.put(gear, "helix_angle_reference_diameter", math.copysign(keys["helix_angle"], own.beta))
    file.put(gear, "face_width", file.take(f"{name}.face_width"))
    file.put(gear, "reference_circle_diameter", 2.0 * own.radius)
    # flanks of asymmetric teeth have two base circles, the format one for both
    file.put(gear, "base_circle_diameter", None if own.asymmetric else 2.0 * own.base_radius)
    file.put(gear, "tip_diameter", 2.0 * of.tip)
    file.put(gear, "root_diameter", 2.0 * of.root)
    _write_tip_limits(file, gear, 2.0 * of.tip, name)
    if not own.internal:
        file.put(gear, "inner_diameter", file.take(f"{name}.bore"))
    for key in ("teeth", "internal", "addendum", "tip_alteration", "tip_diameter", "root_diameter"):
        file.take(f"{name}.{key}")
    _write_thickness(file, gear, of, name)
    flanks = file.flanks(gear, FLANK_TYPE)
    chamfer = file.take(f"{name}.tip_chamfer")
    coast = None if chamfer is None else file.take(f"{name}.coast_tip_edge")
    for side, flank in flanks.items():
        file.put(flank, "normal_pressure_angle", angles[side])
        file.put(flank, "addendum_modification_coefficient", own.shift)
        other = coast is not None and side != str(own.drive)
        file.put(flank, "tooth_tip_chamfer", coast if other else chamfer)
    file.take(f"{name}.profile_shift")
    if keys.get(f"{name}.manufacture") == "generated":
        _write_tool(file, flanks, of, name)
    write_changes(file, gear, name, flanks)
    file.put_material(gear, name)


def _angles(file: StageWriter, of: GearProportions) -> dict[str, float]:
    """Return the normal pressure angles (deg) of the flanks of a gear, by "left" and "right"."""
    own, alpha = of.own, file.keys.get("pressure_angle", math.degrees(of.own.alpha))
    coast = alpha if own.coast_alpha is None else file.keys.get("coast_pressure_angle", math.degrees(own.coast_alpha))
    return {str(side): alpha if side is own.drive else coast for side in (Side.LEFT, Side.RIGHT)}


def _write_tip_limits(file: StageWriter, gear: Component, tip: float, name: str) -> None:
    """Write the largest and the smallest tip diameter; the tolerance class remains a key of this program."""
    stem = f"{name}.tip_diameter_tolerance"
    ends: Any = file.take(f"{stem}.upper"), file.take(f"{stem}.lower")
    if (grade := file.keys.get(f"{stem}.grade")) is not None and tip <= iso286.SIZE_LIMITS_MM[-1]:
        ends = iso286.deviations(grade, tip)
    for id, end in zip(("maximum_tip_diameter", "minimum_tip_diameter"), ends, strict=True):
        file.put(gear, id, None if end is None else tip + end)


def _write_thickness(file: StageWriter, gear: Component, of: GearProportions, name: str) -> None:
    """Write the allowances of the thickness: given, or as the backlash requires."""
    given = [file.keys.get(f"{name}.thickness_allowance.{end}") for end in ("upper", "lower")]
    if any(key.startswith(tuple(f"{name}.{by}." for by in ("span", "balls", "pins"))) for key in file.keys):
        return
    series = f"{name}.thickness_allowance.series"
    if file.put(gear, SERIES_ATTRIBUTE, file.keys.get(series)):
        file.take(series)
    if None not in given:
        for end in ("upper", "lower"):
            file.take(f"{name}.thickness_allowance.{end}")
    upper, lower = given if None not in given else (of.own.allowance, of.own.allowance)
    file.put(gear, "chordal_tooth_thickness_upper_deviation", upper)
    file.put(gear, "chordal_tooth_thickness_lower_deviation", lower)


def _write_tool(file: StageWriter, flanks: dict[str, Component], of: GearProportions, name: str) -> None:
    """Write the tool and the settings of the step that generates the teeth."""
    type, shared = CUTTER_TYPE if of.spec.shaped else HOB_TYPE, None
    module, angles = of.own.module, _angles(file, of)
    taken: dict[str, Any] = {}

    def once(key: str) -> Any:
        if key not in taken:
            taken[key] = file.take(f"{name}.{key}")
        return taken[key]

    fixed_root = f"{name}.root_diameter" in file.keys
    for side, flank in flanks.items():
        tool, settings = file.step(flank, type, SETTINGS_TYPE, shared)
        # the flanks of a tool of asymmetric teeth are two tools of the format
        shared = None if of.own.asymmetric else tool
        for id in SETTINGS_ATTRIBUTES:
            # an earlier version wrote these attributes to the flank
            flank.attributes.pop(id, None)
        file.put(tool, "normal_module", module)
        file.put(tool, "normal_pressure_angle", angles[side])
        rounding = once(tip_rounding(of.spec, coast=side != str(of.own.drive)).key)
        rounded = file.put(tool, "tip_radius_factor", rounding)
        file.put(tool, "tip_radius", None if rounded else rounding)
        if type == CUTTER_TYPE:
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
        file.put(tool, "protuberance_amount", once("hob.protuberance") or None)
        file.put(tool, "protuberance_angle", once("hob.protuberance_angle"))
        file.put(settings, "machining_allowance", once("hob.stock"))
