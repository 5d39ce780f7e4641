"""One stage of a REXS model as a gear system reads it: its gears, their flanks and tools, and which attributes were used."""

from __future__ import annotations

import base64
import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from gearmesh.errors import DesignError, FileError
from gearmesh.exchange.attributes import ATTRIBUTES
from gearmesh.exchange.model import OWN, Attribute, Component, RexsModel
from gearmesh.exchange.units import factor, units_in_words
from gearmesh.files.reading import json_value
from gearmesh.numerals import parse_number

#: ids of attributes with a position in space
POSITION = ("reference_component_for_position", "support_vector", "u_axis_vector", "w_axis_vector")
#: directions, whose lengths do not matter
DIRECTIONS = POSITION[2:]
#: key of the material of a member -> attribute
MATERIAL = {"youngs_modulus": "elastic_modulus", "poisson_ratio": "poisson_ratio"}
#: attribute with the density, and kg/m^3 in its unit, kg/dm^3
DENSITY, KG_PER_M3 = "density", 1e3
#: encodings of numbers -> their form in bytes
CODES = {"float64": "<d", "float32": "<f", "int32": "<i"}


@dataclass
class StageReader:
    """A stage in the model of a file.

    All that is asked for counts as used; every question raises FileError in one line that names file, component and attribute.
    `key`, where a question has it, is the key of a design that the answer is for: a refusal of the key names the attribute, too.
    """

    path: str
    model: RexsModel
    stage: Component
    used: set[tuple[str, str]] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)
    origins: dict[str, tuple[Component, Attribute]] = field(default_factory=dict)

    def of(self, stage: Component) -> StageReader:
        """Another stage of the same model, with the same account."""
        return StageReader(self.path, self.model, stage, self.used, self.notes, self.origins)

    def refusal(self, component: Component, attribute: str, reason: str, value: Any = None) -> FileError:
        """The refusal of an attribute, or of a component that lacks it."""
        known = component.attributes.get(attribute)
        name, where = attribute, component.in_full
        if known is not None:
            name, where = known.name, known.moved_from or where
        shown = "" if value is None else f" = {str(value)[:40]}"
        return FileError(self.path, reason=f"{where}: {name}{shown}: {reason}")

    def name_origin(self, refusal: DesignError) -> DesignError:
        """The refusal of a design that was read, which names the attribute of the file."""
        origin = self.origins.get(refusal.key)
        if origin is None:
            return FileError(self.path, reason=f"{self.stage.in_full}: {refusal}")
        component, one = origin
        unit = "" if one.unit in ("none", "") else f" {one.unit}"
        value = f"{one.text}{unit}" if isinstance(one.text, str) else None
        return self.refusal(component, one.id, f"as a design, {refusal}", value)

    # values

    def _attribute(self, component: Component, id: str, key: str) -> Attribute | None:
        one = component.attributes.get(id)
        if one is None or one.text == "":
            return None
        if one.type == "boolean" and id in ATTRIBUTES and ATTRIBUTES[id].type != "boolean":
            # a program has it so for values that it does not hand over
            self.notes.append(f"{one.name}: a boolean is no value of this attribute and is not used")
            return None
        self.used.add((component.id, id))
        if key:
            self.origins[key] = component, one
        return one

    def number(self, component: Component, id: str, key: str = "", zero: bool = False) -> float | None:
        """A number in the unit of the format; None if the file has none.

        0 means that none is given where the range of the attribute excludes it, except with `zero`.
        """
        one = self._attribute(component, id, key)
        if one is None:
            return None
        form = ATTRIBUTES[id]
        scale = factor(one.unit, form.unit)
        if scale is None:
            raise self.refusal(component, id, f"must be in {units_in_words(form.unit)}, is in {one.unit[:20]}")
        value = self._finite(component, one, one.text) * scale
        if value == 0.0 and form.excludes_zero:
            return 0.0 if zero else None
        if not form.holds(value):
            raise self.refusal(
                component, id, f"must be {form.range_in_words}", f"{one.text} {one.unit}".removesuffix(" none")
            )
        return value

    def size(self, component: Component, id: str, key: str = "") -> float | None:
        """A number without its sign, of an attribute that some programs give a sign as ISO 21771 does for internal gears."""
        one = component.attributes.get(id)
        if one is None or not isinstance(one.text, str) or not one.text.startswith("-"):
            return self.number(component, id, key)
        plain = Component(component.id, component.type, component.name, dict(component.attributes), component.old_type)
        plain.attributes[id] = replace(one, text=one.text[1:])
        return self.number(plain, id, key)

    def _finite(self, component: Component, one: Attribute, text: Any) -> float:
        value = parse_number(text) if isinstance(text, str) else None
        if value is None:
            raise self.refusal(component, one.id, "not a number", text)
        return value

    def numbers(self, component: Component, id: str) -> list[float] | None:
        """Several of them in the unit of the format, written out or encoded [REXS 1.3]."""
        one = self._attribute(component, id, "")
        if one is None:
            return None
        wanted = ATTRIBUTES[id].unit
        scale = 1.0 if id in DIRECTIONS else factor(one.unit, wanted)
        if scale is None:
            raise self.refusal(component, id, f"must be in {units_in_words(wanted)}, is in {one.unit[:20]}")
        if not one.code:
            return (
                [self._finite(component, one, text) * scale for text in one.text]
                if isinstance(one.text, list)
                else None
            )
        form = CODES.get(one.code)
        if form is None:
            raise self.refusal(component, id, f"must be one of {', '.join(CODES)}", f'code "{one.code[:20]}"')
        try:
            content = base64.b64decode(str(one.text), validate=True)
            values = [float(value) for (value,) in struct.iter_unpack(form, content)]
        except (ValueError, struct.error):
            raise self.refusal(component, id, f"not base64 text of {one.code} numbers") from None
        if not all(map(math.isfinite, values)):
            raise self.refusal(component, id, "not finite numbers")
        return [value * scale for value in values]

    def count(self, component: Component, id: str, key: str = "") -> int | None:
        """A whole number, without its sign."""
        value = self.size(component, id, key)
        if value is not None and value != int(value):
            raise self.refusal(component, id, "not a whole number", value)
        return None if value is None else int(value)

    def required_count(self, component: Component, id: str, key: str = "") -> int:
        """A whole number that must be there."""
        value = self.count(component, id, key)
        if value is None:
            raise self.refusal(component, id, "missing" if id not in component.attributes else "must be above 0")
        return value

    def is_negative(self, component: Component, id: str) -> bool:
        """True where a number has a sign."""
        one = component.attributes.get(id)
        return one is not None and str(one.text).startswith("-")

    def text(self, component: Component, id: str, key: str = "") -> str | None:
        """A word; of an attribute with choices, one of them in small letters."""
        one = self._attribute(component, id, key)
        if one is None:
            return None
        choices = ATTRIBUTES[id].choices if id in ATTRIBUTES else ()
        word = str(one.text).lower() if choices else str(one.text)
        if choices and word.endswith(".0"):
            # a choice that is a number, as some programs write it
            word = word.removesuffix(".0")
        if choices and word not in choices:
            shown = ", ".join(choices) if len(choices) < 12 else f"{choices[0]} to {choices[-1]}"
            raise self.refusal(component, id, f"must be one of {shown}", one.text)
        return word

    def required_number(self, component: Component, id: str, key: str = "") -> float:
        """A number that must be there."""
        value = self.number(component, id, key)
        if value is None:
            raise self.refusal(component, id, "missing" if id not in component.attributes else "must be above 0")
        return value

    def materials(self, gears: Mapping[str, Component]) -> dict[str, float]:
        """Keys of the materials of the members of a design by their names; a figure of 0 is not given."""
        keys: dict[str, float] = {}
        densities: dict[str, float] = {}
        for name, gear in gears.items():
            for one in self.references(gear, "material"):
                for key, id in MATERIAL.items():
                    if value := self.number(one, id, f"{name}.material.{key}"):
                        keys[f"{name}.material.{key}"] = value
                if density := self.number(one, DENSITY, "material.density"):
                    densities[str(one)] = density
        if len(set(densities.values())) == 1:
            keys["material.density"] = KG_PER_M3 * next(iter(densities.values()))
        elif densities:
            self.notes.append(f"densities of {', '.join(densities)} are not used: they differ, and a design has one")
            for one in self.model.components:
                if str(one) in densities:
                    self.used.discard((one.id, DENSITY))
        return keys

    def own_keys(self, component: Component) -> dict[str, Any]:
        """Keys of a design that this program has written there."""
        keys = {}
        for id in [id for id in component.attributes if id.startswith(OWN)]:
            text = self.text(component, id)
            try:
                keys[id[len(OWN) :].replace("__", ".")] = json_value(text or "null", self.path)
            except FileError:
                raise self.refusal(component, id, "not a value of a design", text) from None
        return keys

    # components

    def _component(self, id: str | None) -> Component | None:
        one = self.model.component(id)
        if id is not None and one is None:
            raise FileError(self.path, reason=f"a relation refers to component {id}, which is not there")
        return one

    def gears(self) -> tuple[Component, Component]:
        """Both gears of the stage."""
        for relation in self.model.relations_of("stage", "stage", self.stage.id):
            first, second = (self._component(relation.in_role(role)) for role in ("gear_1", "gear_2"))
            if first is not None and second is not None:
                return first, second
        raise FileError(
            self.path,
            reason=f"{self.stage.in_full}: no relation of type stage says which its gears are (gear_1, gear_2)",
        )

    def flanks(self, gear: Component) -> dict[str, Component]:
        """The flanks of a gear, "left" and "right", those that the file has."""
        for relation in self.model.relations_of("flank", "gear", gear.id):
            sides = {side: self._component(relation.in_role(side)) for side in ("left", "right")}
            return {side: one for side, one in sides.items() if one is not None}
        return {}

    def steps(self, flank: Component) -> list[tuple[Component, Component | None]]:
        """Tools and settings that make a flank, in their order."""
        relations = sorted(
            self.model.relations_of("manufacturing_step", "workpiece", flank.id), key=lambda one: one.order.zfill(9)
        )
        made = [(self._component(one.in_role("tool")), one.in_role("manufacturing_settings")) for one in relations]
        return [(tool, self._component(settings)) for tool, settings in made if tool is not None]

    def references(self, origin: Component, type: str = "") -> list[Component]:
        """Components to which another one refers, of a type or all."""
        relations = self.model.relations_of("reference", "origin", origin.id)
        components = (self._component(one.in_role("referenced")) for one in relations)
        return [one for one in components if one is not None and type in ("", one.type)]

    def parts(self, assembly: Component, type: str) -> list[Component]:
        """Parts of an assembly, of a type."""
        relations = self.model.relations_of("assembly", "assembly", assembly.id)
        components = (self._component(one.in_role("part")) for one in relations)
        return [one for one in components if one is not None and one.type == type]

    def part_stages(self) -> list[Component]:
        """Stages with two gears that are parts of this one."""
        relations = self.model.relations_of("assembly", "assembly", self.stage.id)
        parts = [one for relation in relations if (one := self._component(relation.in_role("part"))) is not None]
        with_gears = {one.in_role("stage") for one in self.model.relations if one.type == "stage"}
        return [one for one in parts if one.id in with_gears]

    def assembly_of(self, part: Component, type: str) -> Component | None:
        """The assembly of a type that a part belongs to."""
        relations = self.model.relations_of("assembly", "part", part.id)
        components = (self._component(one.in_role("assembly")) for one in relations)
        return next((one for one in components if one is not None and one.type == type), None)

    def torques(self, gear: Component) -> dict[str, float]:
        """Torques on a gear, Nm, by load case ("" where it is of none): of the loads on its shaft, or what the stage transmits."""
        shaft = self.assembly_of(gear, "shaft")
        loads = [] if shaft is None else self.parts(shaft, "external_load")
        by_shaft = self._sums(loads, "torque_around_u_axis")
        return by_shaft or self._sums(self._data_of(gear), "torque")

    def _data_of(self, gear: Component) -> list[Component]:
        relations = self.model.relations_of("stage_gear_data", "gear", gear.id)
        own = [one.in_role("stage_gear_data") for one in relations if one.in_role("stage") == self.stage.id]
        return [one for one in map(self._component, own) if one is not None]

    def _sums(self, components: list[Component], attribute: str) -> dict[str, float]:
        ids, sums = {one.id for one in components}, dict[str, float]()
        of_cases = [(case.id, one) for case in self.model.load_cases for one in case.components if one.id in ids]
        for case, one in [*(("", one) for one in components), *of_cases]:
            if (torque := self.number(one, attribute)) is not None:
                sums[case] = sums.get(case, 0.0) + torque
        return sums

    def apart(self, first: Component, second: Component) -> float | None:
        """How far the second gear stands along the axis of the first, mm; None if the file does not place both in one frame."""
        places = [self.numbers(one, "support_vector") for one in (first, second)]
        frames = [self.text(one, POSITION[0]) for one in (first, second)]
        axis = self.numbers(first, "u_axis_vector")
        vectors = [*places, axis]
        if frames[0] != frames[1] or any(one is None or len(one) != 3 for one in vectors) or not any(axis or []):
            return None
        near, far, along = (one or [] for one in vectors)
        return sum(u * (b - a) for u, a, b in zip(along, near, far, strict=True)) / math.hypot(*along)

    def unused_attributes(self) -> Iterator[tuple[str, str]]:
        """(component, attribute) that nothing asked for, of all that the file has."""
        for component in self.model.components:
            for id, one in component.attributes.items():
                if (component.id, id) not in self.used:
                    yield one.moved_from or str(component), one.name
        for case in self.model.load_cases:
            for component in case.components:
                for id, one in component.attributes.items():
                    if (component.id, id) not in self.used:
                        whole = self.model.component(component.id)
                        where = f"load case {case.id}" if case.id else "accumulation"
                        yield f"{whole or component} ({where})", one.name
