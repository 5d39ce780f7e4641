"""One stage of a REXS model as a gear system reads it: its gears, their flanks and tools, and which attributes were used."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from gearmesh.errors import FileError
from gearmesh.exchange.model import OWN, Attribute, Component, RexsModel
from gearmesh.exchange.units import factor
from gearmesh.files.reading import json_value
from gearmesh.numerals import parse_number

#: ids of attributes with a position in space
POSITION = ("reference_component_for_position", "support_vector", "u_axis_vector", "w_axis_vector")


@dataclass
class StageReader:
    """A stage in the model of a file.

    All that is asked for counts as used; every question raises FileError in one line that names file, component and attribute.
    """

    path: str
    model: RexsModel
    stage: Component
    used: set[tuple[str, str]] = field(default_factory=set)
    notes: list[str] = field(default_factory=list)

    def of(self, stage: Component) -> StageReader:
        """Another stage of the same model, with the same account."""
        return StageReader(self.path, self.model, stage, self.used, self.notes)

    def refusal(self, component: Component, attribute: str, reason: str, value: Any = None) -> FileError:
        """What is wrong with an attribute."""
        shown = "" if value is None else f" = {str(value)[:40]}"
        return FileError(self.path, reason=f"{component}: {attribute}{shown}: {reason}")

    # values

    def _attribute(self, component: Component, id: str) -> Attribute | None:
        one = component.attributes.get(id)
        if one is None or one.text == "":
            return None
        self.used.add((component.id, id))
        return one

    def number(self, component: Component, id: str, unit: str = "none") -> float | None:
        """A finite number in mm, deg, N / mm^2, N m or none; None if the file has none."""
        one = self._attribute(component, id)
        if one is None:
            return None
        scale = factor(one.unit, unit)
        if scale is None:
            raise self.refusal(component, id, f"must be in {unit}, is in {one.unit[:20]}")
        return self._finite(component, one, one.text) * scale

    def _finite(self, component: Component, one: Attribute, text: Any) -> float:
        value = parse_number(text) if isinstance(text, str) else None
        if value is None:
            raise self.refusal(component, one.id, "not a number", text)
        return value

    def numbers(self, component: Component, id: str) -> list[float] | None:
        """Several of them, as the file has them."""
        one = self._attribute(component, id)
        if one is None or not isinstance(one.text, list):
            return None
        return [self._finite(component, one, text) for text in one.text]

    def count(self, component: Component, id: str) -> int | None:
        """A whole number."""
        value = self.number(component, id)
        if value is not None and value != int(value):
            raise self.refusal(component, id, "not a whole number", value)
        return None if value is None else int(value)

    def text(self, component: Component, id: str) -> str | None:
        """A word."""
        one = self._attribute(component, id)
        return None if one is None else str(one.text)

    def required_number(self, component: Component, id: str, unit: str = "none") -> float:
        """A number that must be there."""
        value = self.number(component, id, unit)
        if value is None:
            raise self.refusal(component, id, "missing")
        return value

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
        raise FileError(self.path, reason=f"{self.stage}: no relation says which its gears are (gear_1, gear_2)")

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
            if (torque := self.number(one, attribute, "N m")) is not None:
                sums[case] = sums.get(case, 0.0) + torque
        return sums

    def apart(self, first: Component, second: Component) -> float | None:
        """How far the second gear stands along the axis of the first, mm; None if the file does not place both in one frame."""
        places = [self.numbers(one, "support_vector") for one in (first, second)]
        frames = [self.text(one, POSITION[0]) for one in (first, second)]
        axis = self.numbers(first, "u_axis_vector")
        if frames[0] != frames[1] or axis is None or any(place is None or len(place) != 3 for place in places):
            return None
        near, far = (place or [] for place in places)
        return sum(u * (b - a) for u, a, b in zip(axis, near, far, strict=True)) / math.hypot(*axis)

    def unused_attributes(self) -> Iterator[tuple[str, str]]:
        """(component, attribute) that nothing asked for, of all that the file has."""
        for component in self.model.components:
            for id in component.attributes:
                if (component.id, id) not in self.used:
                    yield str(component), id
        for case in self.model.load_cases:
            for component in case.components:
                for id in component.attributes:
                    if (component.id, id) not in self.used:
                        whole = self.model.component(component.id)
                        where = f"load case {case.id}" if case.id else "accumulation"
                        yield f"{whole or component} ({where})", id
