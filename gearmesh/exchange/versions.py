"""Models of earlier versions in the form of REXS 1.7: units, names of attributes, types of components, relations of
tools.

Messages and the list of unused attributes keep the names in the file.
"""

from __future__ import annotations

from collections.abc import Iterable

from gearmesh.exchange.model import Attribute, Component, ComponentReference, Relation, RexsModel
from gearmesh.exchange.units import OLD_UNITS
from gearmesh.numerals import parse_whole_number

#: suffix of attributes of worms and wheels in version 1.2
WORM_SUFFIX = "_din_3975_2017"
#: types of cylindrical gears
_CYLINDRICAL_TYPES = ("cylindrical_gear", "ring_gear")
#: types of worms and wheels
_WORM_TYPES = ("worm_gear", "worm_wheel")
#: new name of each renamed attribute, by types of components
RENAMED_ATTRIBUTES: dict[tuple[str, ...], dict[str, str]] = {
    ("cylindrical_stage",): {
        "din_3964_center_distance_tolerance_field": "center_distance_tolerance_field_din_3964_1980"
    },
    _CYLINDRICAL_TYPES: {
        "din_3967_deviation_tolerance_series": "tooth_thickness_deviation_tolerance_series_din_3967_1978"
    },
    _WORM_TYPES: {
        f"axial_module{WORM_SUFFIX}": "axial_module",
        f"axial_pitch{WORM_SUFFIX}": "axial_pitch",
        f"face_width{WORM_SUFFIX}": "face_width_worm_wheel",
        f"flank_form{WORM_SUFFIX}": "flank_form",
        f"form_factor{WORM_SUFFIX}": "form_factor_worm_gear",
        f"lead{WORM_SUFFIX}": "lead",
        f"outer_diameter{WORM_SUFFIX}": "outer_diameter_worm_wheel",
        f"pressure_angle{WORM_SUFFIX}": "pressure_angle_worm_gear",
        f"reference_diameter{WORM_SUFFIX}": "reference_diameter_worm_gear",
        f"reference_lead_angle{WORM_SUFFIX}": "lead_angle_worm_gear",
        f"root_diameter{WORM_SUFFIX}": "root_diameter_worm_gear",
        f"tip_diameter{WORM_SUFFIX}": "tip_diameter_worm_gear",
    },
    ("bevel_gear",): {"mean_pitch_cone_diameter": "mean_pitch_diameter"},
}
#: new name by type of component and old name
_NEW_NAMES = {
    (type, old): new for types, names in RENAMED_ATTRIBUTES.items() for type in types for old, new in names.items()
}

#: type of flanks of all stages up to version 1.2
OLD_FLANK = "flank_geometry"
#: type of data of gears of all stages up to version 1.2
OLD_GEAR_DATA = "stage_gear_data"
#: stem of the types of flanks and tool settings, by type of gear
TYPE_STEMS = {
    **dict.fromkeys(_CYLINDRICAL_TYPES, "cylindrical_gear"),
    **dict.fromkeys(_WORM_TYPES, "worm_gear"),
    "bevel_gear": "bevel_gear",
}
#: types of flanks
FLANK_TYPES = tuple(f"{stem}_flank" for stem in dict.fromkeys(TYPE_STEMS.values()))
#: types of tools
TOOL_TYPES = (
    "rack_shaped_tool",
    "cutter_wheel_tool",
    "zero_degree_grinding_disk_tool",
    "bevel_gear_tool",
    "worm_grinding_disc_tool",
    "worm_wheel_hob_tool",
)
#: relations between a gear or flank and its tool, with the roles of workpiece and tool
TOOL_RELATIONS = {
    "reference": ("origin", "referenced"),
    "ordered_reference": ("origin", "referenced"),
    "assembly": ("assembly", "part"),
    "ordered_assembly": ("assembly", "part"),
}
#: attributes of tool settings that flanks had in earlier versions
SETTINGS_ATTRIBUTES = (
    "machining_allowance",
    "machining_allowance_tolerance",
    "generated_addendum_modification_coefficient",
)


def bring_up_to_date(model: RexsModel) -> None:
    """Bring a model into the form of version 1.7; a model in this form is not changed."""
    update = _Update(model)
    update.name_types()
    for component in [*model.components, *(one for case in model.load_cases for one in case.components)]:
        whole = update.parts.get(component.id, component)
        component.type = component.type or whole.type
        _name_attributes(component, whole.type)
    update.relate_tools()


def free_id(taken: Iterable[str]) -> str:
    """Return a number above all ids in use."""
    return str(max((parse_whole_number(id) or 0 for id in taken), default=0) + 1)


def _name_attributes(component: Component, type: str) -> None:
    """Give the attributes of a component their names and units of version 1.7."""
    attributes: dict[str, Attribute] = {}
    for id, one in component.attributes.items():
        new = _NEW_NAMES.get((type, id), id)
        if new != id and new not in component.attributes:
            one.id, one.old_id = new, id
        one.unit = OLD_UNITS.get(one.unit, one.unit)
        attributes[one.id] = one
    component.attributes = attributes


class _Update:
    """A model with its components by id, and the relations of its flanks."""

    def __init__(self, model: RexsModel) -> None:
        self.model = model
        self.parts = {one.id: one for one in model.components}
        self.flanks = {one.in_role("gear"): one for one in reversed(model.relations) if one.type == "flank"}
        self.steps: dict[str | None, list[Relation]] = {}
        for one in model.relations:
            if one.type == "manufacturing_step":
                self.steps.setdefault(one.in_role("workpiece"), []).append(one)
        self.next_component = int(free_id(self.parts))
        self.next_relation = int(free_id(one.id for one in model.relations))

    def part(self, relation: Relation, role: str) -> Component | None:
        """Return the component in a role of a relation."""
        return self.parts.get(relation.in_role(role) or "")

    def name_types(self) -> None:
        """Give flanks and data of gears the types of their stage."""
        ends: tuple[str, ...]
        for relation in self.model.relations:
            if relation.type == "flank":
                gear, ends, old = self.part(relation, "gear"), ("left", "right"), OLD_FLANK
                new = None if gear is None or gear.type not in TYPE_STEMS else f"{TYPE_STEMS[gear.type]}_flank"
            elif relation.type == "stage_gear_data":
                stage, ends, old = self.part(relation, "stage"), ("stage_gear_data",), OLD_GEAR_DATA
                new = None if stage is None else f"{stage.type}_gear_data"
            else:
                continue
            for one in (self.part(relation, role) for role in ends):
                if new is not None and one is not None and one.type == old:
                    one.old_type, one.type = one.type, new

    def relate_tools(self) -> None:
        """Replace each relation of a gear and its tool by manufacturing steps of the gear's flanks."""
        tool_relations = [
            (one, *ends) for one in self.model.relations if (ends := self._workpiece_and_tool(one)) is not None
        ]
        replaced = {id(relation) for relation, _, _ in tool_relations}
        self.model.relations = [one for one in self.model.relations if id(one) not in replaced]
        for _, workpiece, tool in sorted(tool_relations, key=lambda one: one[0].order.zfill(9)):
            for flank in self._flanks_of(workpiece):
                self._add_step(flank, tool)

    def _workpiece_and_tool(self, relation: Relation) -> tuple[Component, Component] | None:
        """Return workpiece and tool of a relation, None if it relates no tool."""
        if relation.type not in TOOL_RELATIONS:
            return None
        ends = [self.part(relation, role) for role in TOOL_RELATIONS[relation.type]]
        for workpiece, tool in (ends, ends[::-1]):
            if workpiece is None or tool is None or tool.type not in TOOL_TYPES:
                continue
            if workpiece.type in TYPE_STEMS or workpiece.type in FLANK_TYPES:
                return workpiece, tool
        return None

    def _flanks_of(self, workpiece: Component) -> list[Component]:
        """Return both flanks of a gear, added if the file has none; for a flank, the flank itself."""
        if workpiece.type not in TYPE_STEMS:
            return [workpiece]
        if workpiece.id not in self.flanks:
            left, right = (self._add(f"{TYPE_STEMS[workpiece.type]}_flank") for _ in range(2))
            self.flanks[workpiece.id] = self._relate("flank", {"gear": workpiece, "left": left, "right": right})
        flanks = (self.part(self.flanks[workpiece.id], side) for side in ("left", "right"))
        return [one for one in flanks if one is not None]

    def _add_step(self, flank: Component, tool: Component) -> None:
        """Add a manufacturing step to a flank, unless it has one with this tool."""
        steps = self.steps.setdefault(flank.id, [])
        if any(step.in_role("tool") == tool.id for step in steps):
            return
        settings = self._add(f"{flank.type.removesuffix('_flank')}_manufacturing_settings")
        if not steps:
            moved = [id for id in SETTINGS_ATTRIBUTES if id in flank.attributes]
            settings.attributes |= {id: flank.attributes.pop(id) for id in moved}
            for one in settings.attributes.values():
                one.moved_from = str(flank)
        roles = {"workpiece": flank, "tool": tool, "manufacturing_settings": settings}
        steps.append(self._relate("manufacturing_step", roles, str(len(steps) + 1)))

    def _add(self, type: str) -> Component:
        """Add a component of a type."""
        one = Component(str(self.next_component), type)
        self.next_component += 1
        self.model.components.append(one)
        self.parts[one.id] = one
        return one

    def _relate(self, type: str, roles: dict[str, Component], order: str = "") -> Relation:
        """Add a relation."""
        references = [ComponentReference(role, part.id, part.type) for role, part in roles.items()]
        one = Relation(str(self.next_relation), type, references, order)
        self.next_relation += 1
        self.model.relations.append(one)
        return one
