"""One stage of a REXS model for a gear system: its gears, their flanks and tools, and the attributes that were used."""

from __future__ import annotations

import base64
import math
import struct
from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from typing import Any

from gearmesh.errors import DesignError, FileError
from gearmesh.exchange.attributes import ATTRIBUTE_FORMS
from gearmesh.exchange.model import OWN_PREFIX, Attribute, Component, RexsModel
from gearmesh.exchange.units import factor, units_in_words
from gearmesh.files.reading import json_value
from gearmesh.numerals import parse_number
from gearmesh.records import dataclass

#: ids of attributes with a position in space
POSITION_ATTRIBUTES = ("reference_component_for_position", "support_vector", "u_axis_vector", "w_axis_vector")
#: ids of directions, whose lengths do not matter
DIRECTION_ATTRIBUTES = POSITION_ATTRIBUTES[2:]
#: attribute of each key of a member's material
MATERIAL_ATTRIBUTES = {"youngs_modulus": "elastic_modulus", "poisson_ratio": "poisson_ratio"}
#: attribute with the density
DENSITY_ATTRIBUTE = "density"
#: kg/m^3 in its unit, kg/dm^3
KG_PER_M3 = 1e3
#: byte format of each encoding of numbers
NUMBER_FORMATS = {"float64": "<d", "float32": "<f", "int32": "<i"}


@dataclass
class StageReader:
    """A stage in the model of a file.

    Every attribute that is read counts as used. Every method raises FileError in one line that names file, component
    and attribute. Parameter `key` is the key of the design for which an attribute is read: a refusal of the key then
    names the attribute.
    """

    #: path of the file
    path: str
    #: model of the file
    model: RexsModel
    #: component of the stage
    stage: Component
    #: (component, attribute) ids that were read
    used: set[tuple[str, str]] = field(default_factory=set)
    #: notes for the user, one line each
    notes: list[str] = field(default_factory=list)
    #: component and attribute from which each key of the design was read
    origins: dict[str, tuple[Component, Attribute]] = field(default_factory=dict)

    def of(self, stage: Component) -> StageReader:
        """Return a reader of another stage of the same model, with the same records."""
        return StageReader(self.path, self.model, stage, self.used, self.notes, self.origins)

    def refusal(self, component: Component, attribute: str, reason: str, value: Any = None) -> FileError:
        """Return the refusal of an attribute, or of a component without it."""
        known = component.attributes.get(attribute)
        name, where = attribute, component.in_full
        if known is not None:
            name, where = known.name, known.moved_from or where
        shown = "" if value is None else f" = {str(value)[:40]}"
        return FileError(self.path, reason=f"{where}: {name}{shown}: {reason}")

    def name_origin(self, refusal: DesignError) -> DesignError:
        """Return the refusal of a design from this file, naming the attribute in the file."""
        origin = self.origins.get(refusal.key)
        if origin is None:
            return FileError(self.path, reason=f"{self.stage.in_full}: {refusal}")
        component, one = origin
        unit = "" if one.unit in ("none", "") else f" {one.unit}"
        value = f"{one.text}{unit}" if isinstance(one.text, str) else None
        return self.refusal(component, one.id, f"as a design, {refusal}", value)

    # values

    def _attribute(self, component: Component, id: str, key: str) -> Attribute | None:
        """Return an attribute with a value and record it as used; None if the file has none."""
        one = component.attributes.get(id)
        if one is None or one.text == "":
            return None
        if one.type == "boolean" and id in ATTRIBUTE_FORMS and ATTRIBUTE_FORMS[id].type != "boolean":
            # some programs write a boolean for a value that they do not export
            self.notes.append(f"{one.name}: a boolean is no value of this attribute and is not used")
            return None
        self.used.add((component.id, id))
        if key:
            self.origins[key] = component, one
        return one

    def number(self, component: Component, id: str, key: str = "", zero: bool = False) -> float | None:
        """Return a number in the unit of the format; None if the file has none.

        A 0 counts as no value if the range of the attribute excludes it, except with `zero`.
        """
        one = self._attribute(component, id, key)
        if one is None:
            return None
        form = ATTRIBUTE_FORMS[id]
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
        """Return a number without its sign; some programs give it the sign of internal gears of ISO 21771."""
        one = component.attributes.get(id)
        if one is None or not isinstance(one.text, str) or not one.text.startswith("-"):
            return self.number(component, id, key)
        plain = Component(component.id, component.type, component.name, dict(component.attributes), component.old_type)
        plain.attributes[id] = replace(one, text=one.text[1:])
        return self.number(plain, id, key)

    def _finite(self, component: Component, one: Attribute, text: Any) -> float:
        """Return the finite number in a text."""
        value = parse_number(text) if isinstance(text, str) else None
        if value is None:
            raise self.refusal(component, one.id, "not a number", text)
        return value

    def numbers(self, component: Component, id: str) -> list[float] | None:
        """Return several numbers in the unit of the format, written out or encoded [REXS 1.3]."""
        one = self._attribute(component, id, "")
        if one is None:
            return None
        wanted = ATTRIBUTE_FORMS[id].unit
        scale = 1.0 if id in DIRECTION_ATTRIBUTES else factor(one.unit, wanted)
        if scale is None:
            raise self.refusal(component, id, f"must be in {units_in_words(wanted)}, is in {one.unit[:20]}")
        if not one.code:
            return (
                [self._finite(component, one, text) * scale for text in one.text]
                if isinstance(one.text, list)
                else None
            )
        form = NUMBER_FORMATS.get(one.code)
        if form is None:
            raise self.refusal(component, id, f"must be one of {', '.join(NUMBER_FORMATS)}", f'code "{one.code[:20]}"')
        try:
            content = base64.b64decode(str(one.text), validate=True)
            values = [float(value) for (value,) in struct.iter_unpack(form, content)]
        except (ValueError, struct.error):
            raise self.refusal(component, id, f"not base64 text of {one.code} numbers") from None
        if not all(map(math.isfinite, values)):
            raise self.refusal(component, id, "not finite numbers")
        return [value * scale for value in values]

    def count(self, component: Component, id: str, key: str = "") -> int | None:
        """Return a whole number, without its sign."""
        value = self.size(component, id, key)
        if value is not None and value != int(value):
            raise self.refusal(component, id, "not a whole number", value)
        return None if value is None else int(value)

    def required_count(self, component: Component, id: str, key: str = "") -> int:
        """Return a whole number that the file must have."""
        value = self.count(component, id, key)
        if value is None:
            raise self.refusal(component, id, "missing" if id not in component.attributes else "must be above 0")
        return value

    def is_negative(self, component: Component, id: str) -> bool:
        """True if a number has a minus sign."""
        one = component.attributes.get(id)
        return one is not None and str(one.text).startswith("-")

    def text(self, component: Component, id: str, key: str = "") -> str | None:
        """Return a word; for an attribute with choices, one of them in small letters."""
        one = self._attribute(component, id, key)
        if one is None:
            return None
        choices = ATTRIBUTE_FORMS[id].choices if id in ATTRIBUTE_FORMS else ()
        word = str(one.text).lower() if choices else str(one.text)
        if choices and word.endswith(".0"):
            # a choice that is a number, as some programs write it
            word = word.removesuffix(".0")
        if choices and word not in choices:
            shown = ", ".join(choices) if len(choices) < 12 else f"{choices[0]} to {choices[-1]}"
            raise self.refusal(component, id, f"must be one of {shown}", one.text)
        return word

    def required_number(self, component: Component, id: str, key: str = "") -> float:
        """Return a number that the file must have."""
        value = self.number(component, id, key)
        if value is None:
            raise self.refusal(component, id, "missing" if id not in component.attributes else "must be above 0")
        return value

    def materials(self, gears: Mapping[str, Component]) -> dict[str, float]:
        """Return material keys of a design from its gears by member name; a value of 0 counts as not given."""
        keys: dict[str, float] = {}
        densities: dict[str, float] = {}
        for name, gear in gears.items():
            for one in self.references(gear, "material"):
                for key, id in MATERIAL_ATTRIBUTES.items():
                    if value := self.number(one, id, f"{name}.material.{key}"):
                        keys[f"{name}.material.{key}"] = value
                if density := self.number(one, DENSITY_ATTRIBUTE, f"{name}.material.density"):
                    densities[f"{name}.material.density"] = KG_PER_M3 * density
        if len(set(densities.values())) == 1:
            return keys | {"material.density": next(iter(densities.values()))}
        return keys | densities

    def own_keys(self, component: Component) -> dict[str, Any]:
        """Return the keys of a design that this program wrote into a component."""
        keys = {}
        for id in [id for id in component.attributes if id.startswith(OWN_PREFIX)]:
            text = self.text(component, id)
            try:
                keys[id[len(OWN_PREFIX) :].replace("__", ".")] = json_value(text or "null", self.path)
            except FileError:
                raise self.refusal(component, id, "not a value of a design", text) from None
        return keys

    # components

    def _component(self, id: str | None) -> Component | None:
        """Return the component with an id; an id without a component is refused."""
        one = self.model.component(id)
        if id is not None and one is None:
            raise FileError(self.path, reason=f"a relation refers to component {id}, which is not there")
        return one

    def gears(self) -> tuple[Component, Component]:
        """Return both gears of the stage."""
        for relation in self.model.relations_of("stage", "stage", self.stage.id):
            first, second = (self._component(relation.in_role(role)) for role in ("gear_1", "gear_2"))
            if first is not None and second is not None:
                return first, second
        raise FileError(
            self.path,
            reason=f"{self.stage.in_full}: no relation of type stage says which its gears are (gear_1, gear_2)",
        )

    def flanks(self, gear: Component) -> dict[str, Component]:
        """Return the flanks of a gear that the file has, by "left" and "right"."""
        for relation in self.model.relations_of("flank", "gear", gear.id):
            sides = {side: self._component(relation.in_role(side)) for side in ("left", "right")}
            return {side: one for side, one in sides.items() if one is not None}
        return {}

    def steps(self, flank: Component) -> list[tuple[Component, Component | None]]:
        """Return tool and settings of each manufacturing step of a flank, in order."""
        relations = sorted(
            self.model.relations_of("manufacturing_step", "workpiece", flank.id), key=lambda one: one.order.zfill(9)
        )
        made = [(self._component(one.in_role("tool")), one.in_role("manufacturing_settings")) for one in relations]
        return [(tool, self._component(settings)) for tool, settings in made if tool is not None]

    def references(self, origin: Component, type: str = "") -> list[Component]:
        """Return the components of a type, or of all types, to which a component refers."""
        relations = self.model.relations_of("reference", "origin", origin.id)
        components = (self._component(one.in_role("referenced")) for one in relations)
        return [one for one in components if one is not None and type in ("", one.type)]

    def parts(self, assembly: Component, type: str) -> list[Component]:
        """Return the parts of an assembly that have a type."""
        relations = self.model.relations_of("assembly", "assembly", assembly.id)
        components = (self._component(one.in_role("part")) for one in relations)
        return [one for one in components if one is not None and one.type == type]

    def part_stages(self) -> list[Component]:
        """Return the stages with two gears that are parts of this stage."""
        relations = self.model.relations_of("assembly", "assembly", self.stage.id)
        parts = [one for relation in relations if (one := self._component(relation.in_role("part"))) is not None]
        with_gears = {one.in_role("stage") for one in self.model.relations if one.type == "stage"}
        return [one for one in parts if one.id in with_gears]

    def assembly_of(self, part: Component, type: str) -> Component | None:
        """Return the assembly of a type that contains a part, None if there is none."""
        relations = self.model.relations_of("assembly", "part", part.id)
        components = (self._component(one.in_role("assembly")) for one in relations)
        return next((one for one in components if one is not None and one.type == type), None)

    def torques(self, gear: Component) -> dict[str, float]:
        """Return torques on a gear, Nm, by load case, "" for none.

        They are the sum of the loads on its shaft; without such loads, the torque that the stage transmits.
        """
        shaft = self.assembly_of(gear, "shaft")
        loads = [] if shaft is None else self.parts(shaft, "external_load")
        by_shaft = self._sums(loads, "torque_around_u_axis")
        return by_shaft or self._sums(self._data_of(gear), "torque")

    def _data_of(self, gear: Component) -> list[Component]:
        """Return the data that the stage has of a gear."""
        relations = self.model.relations_of("stage_gear_data", "gear", gear.id)
        own = [one.in_role("stage_gear_data") for one in relations if one.in_role("stage") == self.stage.id]
        return [one for one in map(self._component, own) if one is not None]

    def _sums(self, components: list[Component], attribute: str) -> dict[str, float]:
        """Return the sums of an attribute over components, by load case."""
        ids, sums = {one.id for one in components}, dict[str, float]()
        of_cases = [(case.id, one) for case in self.model.load_cases for one in case.components if one.id in ids]
        for case, one in [*(("", one) for one in components), *of_cases]:
            if (torque := self.number(one, attribute)) is not None:
                sums[case] = sums.get(case, 0.0) + torque
        return sums

    def apart(self, first: Component, second: Component) -> float | None:
        """Distance of the second gear along the axis of the first, mm; None if the file does not place both in one
        frame.
        """
        places = [self.numbers(one, "support_vector") for one in (first, second)]
        frames = [self.text(one, POSITION_ATTRIBUTES[0]) for one in (first, second)]
        axis = self.numbers(first, "u_axis_vector")
        vectors = [*places, axis]
        if frames[0] != frames[1] or any(one is None or len(one) != 3 for one in vectors) or not any(axis or []):
            return None
        near, far, along = (one or [] for one in vectors)
        return sum(u * (b - a) for u, a, b in zip(along, near, far, strict=True)) / math.hypot(*along)

    def unused_attributes(self) -> Iterator[tuple[str, str]]:
        """Yield (component, attribute) of every attribute of the file that was not used."""
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
