"""REXS files of every form, made by hand: components and relations, written as XML or JSON of any version, zipped or not."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

#: type of a value in Python -> its name in JSON
JSON_TYPES = {bool: "boolean", int: "integer", float: "floating_point", str: "enum", list: "floating_point_array"}

DATE = "2026-11-29T00:00:00+00:00"


@dataclass
class Gearbox:
    """A file in the making. Angles have the unit of the version; "" is a value that is not given."""

    version: str = "1.7"
    components: list[tuple[str, str, dict[str, Any]]] = field(default_factory=list)
    relations: list[tuple[str, int, list[tuple[str, int]]]] = field(default_factory=list)

    @property
    def deg(self) -> str:
        return "°" if self.version < "1.4" else "deg"

    def add(self, type: str, name: str = "", /, **attributes: Any) -> int:
        """A component; attributes are values, or a value and its unit. Returns its id."""
        self.components.append((type, name, attributes))
        return len(self.components)

    def relate(self, type: str, order: int = 0, /, **roles: int) -> None:
        self.relations.append((type, order, list(roles.items())))

    def change(self, name: str, **attributes: Any) -> None:
        """Set attributes of the component of a name; None takes one away."""
        own = next(one for _, called, one in self.components if called == name)
        own.update(attributes)
        for id in [id for id, value in own.items() if value is None]:
            del own[id]

    def write(self, folder: Path, suffix: str = ".rexs") -> Path:
        file = folder / f"gearbox{suffix}"
        if "z" not in suffix:
            text = self.json() if "j" in suffix else self.xml()
            file.write_text(text, encoding="utf-8-sig" if suffix.count(".") > 1 else "utf-8")
            return file
        inside = self.write(folder, ".rexs.json" if suffix.count(".") > 1 else ".rexs")
        with zipfile.ZipFile(file, "w") as archive:
            archive.write(inside, inside.name)
            archive.writestr("data/readme.txt", "more of the gearbox")
        return file

    def _values(self, attributes: dict[str, Any]) -> list[tuple[str, Any, str]]:
        pairs = [(id, *(value if isinstance(value, tuple) else (value, "none"))) for id, value in attributes.items()]
        return [(id, value, self.deg if unit == "deg" else unit) for id, value, unit in pairs]

    def xml(self) -> str:
        head = f'version="{self.version}" applicationId="by hand" applicationVersion="1" date="{DATE}"'
        lines = [f"<model {head}>", "<relations>"]
        for number, (type, order, refs) in enumerate(self.relations, start=1):
            ordered = f' order="{order}"' if order else ""
            inside = "".join(f'<ref id="{id}" role="{role}"/>' for role, id in refs)
            lines.append(f'<relation id="{number}" type="{type}"{ordered}>{inside}</relation>')
        lines.append("</relations><components>")
        for id, (type, name, attributes) in enumerate(self.components, start=1):
            lines.append(f'<component id="{id}" type="{type}" name="{name}">')
            for attribute, value, unit in self._values(attributes):
                lines.append(f'<attribute id="{attribute}" unit="{unit}">{_xml_value(value)}</attribute>')
            lines.append("</component>")
        return "\n".join([*lines, "</components></model>"])

    def json(self) -> str:
        relations = [
            {
                "id": number,
                "type": type,
                **({"order": order} if order else {}),
                "refs": [{"id": id, "role": role} for role, id in refs],
            }
            for number, (type, order, refs) in enumerate(self.relations, start=1)
        ]
        components = [
            {
                "id": id,
                "type": type,
                "name": name,
                "attributes": [
                    {"id": attribute, "unit": unit, **({} if value == "" else {JSON_TYPES[value.__class__]: value})}
                    for attribute, value, unit in self._values(attributes)
                ],
            }
            for id, (type, name, attributes) in enumerate(self.components, start=1)
        ]
        head = {"version": self.version, "applicationId": "by hand", "applicationVersion": "1"}
        model = {**head, "date": DATE, "relations": relations, "components": components}
        return json.dumps({"model": model})


def _xml_value(value: Any) -> str:
    if isinstance(value, list):
        return f"<array>{''.join(f'<c>{one}</c>' for one in value)}</array>"
    return str(value).lower() if isinstance(value, bool) else str(value)


def flank_type(box: Gearbox, stem: str) -> str:
    """Type of a flank: of all gears the same up to version 1.2."""
    return "flank_geometry" if box.version < "1.3" else f"{stem}_flank"


def add_gear(
    box: Gearbox, type: str, name: str, teeth: int, beta: float, flank: dict[str, Any], **attributes: Any
) -> tuple[int, list[int]]:
    """A cylindrical gear of module 2 with its flanks, and their ids."""
    own = {"normal_module": (2.0, "mm"), "face_width": (20.0, "mm"), **attributes}
    gear = box.add(type, name, number_of_teeth=teeth, helix_angle_reference_diameter=(beta, "deg"), **own)
    both = {"normal_pressure_angle": (20.0, "deg"), **flank}
    flanks = [box.add(flank_type(box, "cylindrical_gear"), **both) for _ in range(2)]
    box.relate("flank", gear=gear, left=flanks[0], right=flanks[1])
    return gear, flanks


def add_tool(box: Gearbox, gear: int, flanks: Sequence[int], tool: int, by: str) -> None:
    """Relate a tool to its gear, or its flanks, by a relation of the type `by`."""
    if by == "manufacturing_step":
        for flank in flanks:
            settings = box.add("cylindrical_gear_manufacturing_settings", machining_allowance=(0.1, "mm"))
            box.relate(by, 1, workpiece=flank, tool=tool, manufacturing_settings=settings)
        return
    order = 1 if by.startswith("ordered") else 0
    first, second = ("origin", "referenced") if by.endswith("reference") else ("assembly", "part")
    box.relate(by, order, **{first: gear, second: tool})


def helical_pair(version: str = "1.7", by: str = "", of_flank: bool = False) -> Gearbox:
    """A pair 19/41 of helical gears with hobs, tolerances and materials, in the names of a version.

    `by`: type of the relation of tools, with `of_flank` to the left flank in the place of the gear.
    """
    box = Gearbox(version)
    old = version == "1.0"
    series = (
        "din_3967_deviation_tolerance_series" if old else "tooth_thickness_deviation_tolerance_series_din_3967_1978"
    )
    field = "din_3964_center_distance_tolerance_field" if old else "center_distance_tolerance_field_din_3964_1980"
    stage = box.add("cylindrical_stage", "first stage", center_distance=(63.0, "mm"), **{field: "7"})
    hob = box.add(
        "rack_shaped_tool",
        "hob",
        addendum_coefficient_reference_profile=1.4,
        tip_radius_factor=0.3,
        protuberance_amount_factor=0.05,
        protuberance_angle=(10.0, "deg"),
    )
    steel = box.add(
        "material", "steel", elastic_modulus=(210000.0, "N / mm^2"), poisson_ratio=0.29, density=(7.8, "kg / dm^3")
    )
    by = by or ("ordered_reference" if version < "1.3" else "manufacturing_step")
    gears = []
    for name, teeth, beta, shift in (("pinion", 19, 12.0, 0.35), ("wheel", 41, -12.0, 0.05)):
        flank = {"addendum_modification_coefficient": shift, "tooth_tip_chamfer": (0.0, "mm")}
        if by != "manufacturing_step":
            flank["machining_allowance"] = (0.1, "mm")
        gear, flanks = add_gear(box, "cylindrical_gear", name, teeth, beta, flank, **{series: "cd25"})
        add_tool(box, flanks[0] if of_flank else gear, flanks, hob, by)
        box.relate("reference", origin=gear, referenced=steel)
        gears.append(gear)
    box.relate("stage", stage=stage, gear_1=gears[0], gear_2=gears[1])
    return box
