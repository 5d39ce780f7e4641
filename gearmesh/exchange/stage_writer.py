"""Gears written into a REXS model: their data are overwritten, everything else stays."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import field
from typing import Any

from gearmesh.exchange.attributes import ATTRIBUTE_FORMS
from gearmesh.exchange.model import OWN_PREFIX, Attribute, Component, ComponentReference, Relation, RexsModel
from gearmesh.exchange.stage import DENSITY_ATTRIBUTE, KG_PER_M3, MATERIAL_ATTRIBUTES
from gearmesh.exchange.versions import free_id
from gearmesh.records import dataclass


@dataclass
class StageWriter:
    """Writer of components, relations and attributes into a model; existing components are found by their relations.

    `model`: the model. `keys`: leaves of the design that are still to be written; a key that an attribute of the format
    holds is removed. `unsaid`: keys with a value that the attribute of the format does not allow.
    """

    model: RexsModel
    keys: dict[str, Any] = field(default_factory=dict)
    unsaid: set[str] = field(default_factory=set)

    def take(self, key: str) -> Any:
        """Remove and return a key of the design that an attribute holds, None if the design does not have it."""
        return self.keys.pop(key, None)

    # components and relations

    def new(self, type: str, name: str = "") -> Component:
        """Add a component."""
        one = Component(free_id(part.id for part in self.model.components), type, name)
        self.model.components.append(one)
        return one

    def relate(self, type: str, roles: Mapping[str, Component], order: str = "") -> None:
        """Add a relation, unless these components have it."""
        for one in self.model.relations:
            if one.type == type and all(one.in_role(role) == part.id for role, part in roles.items()):
                return
        references = [ComponentReference(role, part.id, part.type) for role, part in roles.items()]
        id = free_id(one.id for one in self.model.relations)
        self.model.relations.append(Relation(id, type, references, order))

    def partner(self, type: str, role: str, component: Component, other: str, wanted: str, name: str = "") -> Component:
        """Return the component of the `wanted` type in the role `other` of a relation with a component in `role`; add
        it if missing.
        """
        for relation in self.model.relations_of(type, role, component.id):
            one = self.model.component(relation.in_role(other))
            if one is not None and one.type == wanted:
                return one
        one = self.new(wanted, name)
        self.relate(type, {role: component, other: one})
        return one

    def stage(self, type: str, known: Component | None, name: str = "") -> Component:
        """Return the component of the stage: the known one, or a new one."""
        return self.new(type, name) if known is None else known

    def gears(self, stage: Component, types: tuple[str, str], names: tuple[str, str]) -> tuple[Component, Component]:
        """Return both gears of a stage; add them if missing."""
        for relation in self.model.relations_of("stage", "stage", stage.id):
            both = [self.model.component(relation.in_role(role)) for role in ("gear_1", "gear_2")]
            if both[0] is not None and both[1] is not None:
                both[0].type, both[1].type = types
                return both[0], both[1]
        first, second = (self.new(type, name) for type, name in zip(types, names, strict=True))
        self.relate("stage", {"stage": stage, "gear_1": first, "gear_2": second})
        return first, second

    def flanks(self, gear: Component, type: str) -> dict[str, Component]:
        """Return both flanks of a gear; add them if missing."""
        for relation in self.model.relations_of("flank", "gear", gear.id):
            sides = {side: self.model.component(relation.in_role(side)) for side in ("left", "right")}
            if all(sides.values()):
                return {side: one for side, one in sides.items() if one is not None}
        new_flanks = {side: self.new(type, f"{gear.name} ({side} flank)") for side in ("left", "right")}
        self.relate("flank", {"gear": gear, **new_flanks})
        return new_flanks

    def step(
        self, flank: Component, tool_type: str, settings_type: str, shared: Component | None = None
    ) -> tuple[Component, Component]:
        """Return tool and settings of the first manufacturing step of a flank with a tool of the type; add them if
        missing.

        `shared`: a tool of another flank that a new step uses.
        """
        for relation in self.model.relations_of("manufacturing_step", "workpiece", flank.id):
            tool = self.model.component(relation.in_role("tool"))
            if tool is not None and tool.type == tool_type:
                settings = self.model.component(relation.in_role("manufacturing_settings"))
                if settings is None:
                    settings = self.new(settings_type)
                    relation.references.append(ComponentReference("manufacturing_settings", settings.id, settings.type))
                return tool, settings
        tool, settings = shared or self.new(tool_type), self.new(settings_type)
        roles = {"workpiece": flank, "tool": tool, "manufacturing_settings": settings}
        steps = sum(1 for _ in self.model.relations_of("manufacturing_step", "workpiece", flank.id))
        self.relate("manufacturing_step", roles, order=str(steps + 1))
        return tool, settings

    def put_material(self, gear: Component, name: str) -> None:
        """Write the material of a member, to which its gear refers."""
        material = self.refer(gear, "material", f"{gear.name or name} (material)")
        for key, id in MATERIAL_ATTRIBUTES.items():
            member_key = f"{name}.material.{key}"
            if self.put(material, id, self.keys.get(member_key, self.keys.get(f"material.{key}"))):
                self.keys.pop(member_key, None)
        own_density = f"{name}.material.density"
        density = self.keys.get(own_density, self.keys.get("material.density"))
        if self.put(material, DENSITY_ATTRIBUTE, None if density is None else density / KG_PER_M3):
            self.keys.pop(own_density, None)

    def refer(self, origin: Component, type: str, name: str = "") -> Component:
        """Return the component of a type to which a component refers; add it if missing."""
        return self.partner("reference", "origin", origin, "referenced", type, name)

    def forget(self, origin: Component, types: tuple[str, ...], orphans: bool = True) -> None:
        """Remove all references to components of some types; with `orphans`, also components that nothing else refers
        to.
        """
        removed = [
            one
            for one in self.model.relations_of("reference", "origin", origin.id)
            if (to := self.model.component(one.in_role("referenced"))) is not None and to.type in types
        ]
        self.model.relations = [one for one in self.model.relations if all(one is not part for part in removed)]
        lost = {one.in_role("referenced") for one in removed} if orphans else set()
        lost -= {one.in_role("referenced") for one in self.model.relations if one.type == "reference"}
        self.model.components = [one for one in self.model.components if one.id not in lost]

    # values

    @staticmethod
    def put(component: Component, id: str, value: float | int | str | bool | list[float] | None) -> bool:
        """Write an attribute with the unit and type of the format.

        Returns False, without the attribute, if there is no value or the format does not allow it.
        """
        form = ATTRIBUTE_FORMS[id]
        allowed = value in form.choices if form.choices else not isinstance(value, int | float) or form.holds(value)
        if value is None or not allowed:
            component.attributes.pop(id, None)
            return False
        component.attributes[id] = Attribute(id, _text(value, form.type), form.unit, form.type)
        return True

    def put_own(self, component: Component) -> None:
        """Write all remaining keys as attributes of this program."""
        for id in [id for id in component.attributes if id.startswith(OWN_PREFIX)]:
            del component.attributes[id]
        for key, value in self.keys.items():
            self.put_custom(component, key.replace(".", "__"), json.dumps(value))
        self.keys.clear()

    @staticmethod
    def put_custom(component: Component, name: str, value: float | str, unit: str = "none") -> None:
        """Write one attribute of this program."""
        type = "string" if isinstance(value, str) else "floating_point"
        component.attributes[OWN_PREFIX + name] = Attribute(OWN_PREFIX + name, _text(value, type), unit, type)


def _text(value: float | int | str | bool | list[float], type: str) -> str | list[str]:
    """Return the text of a value in a file."""
    if isinstance(value, list):
        return [repr(float(one)) for one in value]
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return value
    return str(int(value)) if type in ("integer", "reference_component") else repr(float(value))
