"""Gears written into a REXS model: what it has of them is overwritten, all else stays as it is."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from gearmesh.exchange.model import OWN, Attribute, Component, ComponentReference, Relation, RexsModel
from gearmesh.numerals import parse_whole_number


@dataclass
class StageWriter:
    """Puts components, relations and attributes into a model; those that are there are found again by their relations.

    `keys` are the leaves of the design that are still to be written; those that an attribute of the format has are taken out.
    """

    model: RexsModel
    keys: dict[str, Any] = field(default_factory=dict)

    def take(self, key: str) -> Any:
        """A key of the design that an attribute says, None if the design has it not."""
        return self.keys.pop(key, None)

    # components and relations

    def new(self, type: str, name: str = "") -> Component:
        """One more component."""
        one = Component(self._free([part.id for part in self.model.components]), type, name)
        self.model.components.append(one)
        return one

    @staticmethod
    def _free(ids: list[str]) -> str:
        return str(max((parse_whole_number(id) or 0 for id in ids), default=0) + 1)

    def relate(self, type: str, roles: Mapping[str, Component], order: str = "") -> None:
        """A relation, unless there is one of these components."""
        for one in self.model.relations:
            if one.type == type and all(one.in_role(role) == part.id for role, part in roles.items()):
                return
        references = [ComponentReference(role, part.id, part.type) for role, part in roles.items()]
        id = self._free([one.id for one in self.model.relations])
        self.model.relations.append(Relation(id, type, references, order))

    def partner(self, type: str, role: str, component: Component, other: str, wanted: str, name: str = "") -> Component:
        """The component in the role `other` of a relation of one in a `role`, of the `wanted` type; made if there is none."""
        for relation in self.model.relations_of(type, role, component.id):
            one = self.model.component(relation.in_role(other))
            if one is not None and one.type == wanted:
                return one
        one = self.new(wanted, name)
        self.relate(type, {role: component, other: one})
        return one

    def stage(self, type: str, known: Component | None, name: str = "") -> Component:
        """The stage itself: the one that is `known`, or a new one."""
        return self.new(type, name) if known is None else known

    def gears(self, stage: Component, types: tuple[str, str], names: tuple[str, str]) -> tuple[Component, Component]:
        """Both gears of a stage."""
        for relation in self.model.relations_of("stage", "stage", stage.id):
            both = [self.model.component(relation.in_role(role)) for role in ("gear_1", "gear_2")]
            if both[0] is not None and both[1] is not None:
                both[0].type, both[1].type = types
                return both[0], both[1]
        first, second = (self.new(type, name) for type, name in zip(types, names, strict=True))
        self.relate("stage", {"stage": stage, "gear_1": first, "gear_2": second})
        return first, second

    def flanks(self, gear: Component, type: str) -> dict[str, Component]:
        """Both flanks of a gear."""
        for relation in self.model.relations_of("flank", "gear", gear.id):
            sides = {side: self.model.component(relation.in_role(side)) for side in ("left", "right")}
            if all(sides.values()):
                return {side: one for side, one in sides.items() if one is not None}
        both = {side: self.new(type, f"{gear.name} ({side} flank)") for side in ("left", "right")}
        self.relate("flank", {"gear": gear, **both})
        return both

    def step(
        self, flank: Component, tool_type: str, settings_type: str, shared: Component | None = None
    ) -> tuple[Component, Component]:
        """Tool and settings of the first manufacturing step of a flank with such a tool; `shared`: a tool of another flank."""
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
        self.relate("manufacturing_step", roles, order="1")
        return tool, settings

    def refer(self, origin: Component, type: str, name: str = "") -> Component:
        """The component of a type to which another one refers."""
        return self.partner("reference", "origin", origin, "referenced", type, name)

    def forget(self, origin: Component, types: tuple[str, ...]) -> None:
        """Take away all references to components of these types."""
        gone = [
            one
            for one in self.model.relations_of("reference", "origin", origin.id)
            if (to := self.model.component(one.in_role("referenced"))) is not None and to.type in types
        ]
        self.model.relations = [one for one in self.model.relations if all(one is not part for part in gone)]
        orphans = {one.in_role("referenced") for one in gone}
        orphans -= {one.in_role("referenced") for one in self.model.relations if one.type == "reference"}
        self.model.components = [one for one in self.model.components if one.id not in orphans]

    # values

    @staticmethod
    def put(
        component: Component, id: str, value: float | int | str | bool | list[float] | None, unit: str = "none"
    ) -> None:
        """An attribute; None takes it away."""
        if value is None:
            component.attributes.pop(id, None)
            return
        if isinstance(value, list):
            component.attributes[id] = Attribute(id, [repr(float(one)) for one in value], unit, "floating_point_array")
            return
        type = {bool: "boolean", int: "integer", str: "string"}.get(value.__class__, "floating_point")
        text = value if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else repr(value)
        known = component.attributes.get(id)
        component.attributes[id] = Attribute(id, text, unit, known.type if known is not None and known.type else type)

    def choose(self, component: Component, id: str, value: str) -> None:
        """An attribute of which the format lists the values."""
        component.attributes[id] = Attribute(id, value, type="enum")

    def put_own(self, component: Component) -> None:
        """All keys that no attribute of the format has said."""
        for id in [id for id in component.attributes if id.startswith(OWN)]:
            del component.attributes[id]
        for key, value in self.keys.items():
            self.put(component, OWN + key.replace(".", "__"), json.dumps(value))
        self.keys.clear()
