"""Modifications of flanks in REXS models: flanks refer to one component for each kind; amounts are in mm."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.records import dataclass

#: tables of a design, and the flanks to which they apply
FLANKS_BY_TABLE = {
    "modifications": ("left", "right"),
    "modifications_right": ("right",),
    "modifications_left": ("left",),
}
#: attribute for the end of the face, along u, with the datum face: the toe if negative or absent
FACE_ORIENTATION = "datum_face_orientation"
#: tables that are exchanged if the datum face is at the heel
OTHER_END = {"end_relief_toe": "end_relief_heel", "end_relief_heel": "end_relief_toe"}
#: shapes of a relief
RELIEF_SHAPES = ("linear", "parabolic", "circular")


@dataclass(frozen=True)
class FlankChange:
    """A kind of modification in a model and in a design."""

    #: type of the component
    type: str
    #: table of a design
    table: str
    #: attributes by key of the table; "" if the table is a single value
    keys: Mapping[str, str]
    #: attributes that repeat the amount
    equal: tuple[str, ...] = ()
    #: attribute with the shape; "" if there is none
    shape: str = ""
    #: the only shape that a design has; "" if it has a choice
    only: str = ""


#: kinds of modifications
FLANK_CHANGES = (
    FlankChange(
        "profile_crowning",
        "profile_crowning",
        {"": "profile_crowning_at_tip"},
        ("profile_crowning_at_root",),
        "shape_of_profile_crowning",
        "parabolic",
    ),
    FlankChange(
        "helix_crowning",
        "helix_crowning",
        {"": "helix_crowning_amount_datum_face"},
        ("helix_crowning_amount_non_datum_face",),
        "shape_of_helix_crowning",
        "parabolic",
    ),
    FlankChange("profile_slope", "profile_slope", {"": "profile_slope"}),
    FlankChange("helix_slope", "helix_slope", {"": "helix_slope"}),
    *(
        FlankChange(
            f"{end}_relief",
            f"{end}_relief",
            {"amount": f"{end}_relief_depth", "start_diameter": f"{end}_relief_datum_diameter"},
            shape="shape_of_relief",
        )
        for end in ("tip", "root")
    ),
    *(
        FlankChange(
            f"end_relief_{face}",
            f"end_relief_{end}",
            {"amount": f"end_relief_depth_{face}", "length": f"end_relief_length_{face}"},
            shape="shape_of_relief",
        )
        for end, face in (("toe", "datum_face"), ("heel", "non_datum_face"))
    ),
)
#: types of their components
CHANGE_TYPES = tuple(change.type for change in FLANK_CHANGES)


def read_changes(
    file: StageReader,
    gear: Component,
    flanks: Mapping[str, Component],
    start_of: Callable[[str, float], float | None],
) -> dict[str, Any]:
    """Return the keys of the modifications: those common to both flanks, then those of one flank.

    `start_of` returns the diameter at which a relief of tip or root of a given length begins. Modifications that a
    design cannot have are not used.
    """
    at_heel = file.text(gear, FACE_ORIENTATION) == "positive"
    sides = {
        side: [one for change in FLANK_CHANGES for one in _read(file, flank, change, start_of, at_heel)]
        for side, flank in flanks.items()
    }
    common = [one for one in sides.get("left", []) if one in sides.get("right", [])]
    keys: dict[str, Any] = {}
    for table, names in FLANKS_BY_TABLE.items():
        seen = common if len(names) == 2 else [one for one in sides.get(names[0], []) if one not in common]
        for change, values in seen:
            if any(f"{table}.{change}{key}" in keys for key in values):
                file.notes.append(f"{file.stage}: two modifications {change} of one flank: the first counts")
                continue
            keys |= {f"{table}.{change}{key}": value for key, value in values.items()}
    return keys


def _read(
    file: StageReader,
    flank: Component,
    change: FlankChange,
    start_of: Callable[[str, float], float | None],
    at_heel: bool,
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield table and keys of the modifications of one kind on a flank."""
    table = OTHER_END.get(change.table, change.table) if at_heel else change.table
    for component in file.references(flank, change.type):
        values: dict[str, Any] = {}
        for key, attribute in change.keys.items():
            values[f".{key}" if key else ""] = file.number(component, attribute)
        if ".start_diameter" in values and values[".start_diameter"] is None:
            length = file.number(component, f"{change.type}_datum_length")
            values[".start_diameter"] = None if length is None else start_of(change.type, length)
        amount = next(iter(values.values()))
        others = [file.number(component, id) for id in change.equal]
        shape = file.text(component, change.shape) if change.shape else None
        whole = None not in values.values() and all(other is None or math.isclose(other, amount) for other in others)
        allowed = (change.only,) if change.only else RELIEF_SHAPES
        if amount == 0.0:
            continue
        if at_heel and change.table == "helix_slope":
            whole = False
        if not whole or (shape is not None and shape not in allowed):
            file.notes.append(f"{component}: not used: a design has no such {change.table}")
            file.used -= {(component.id, id) for id in component.attributes}
        else:
            file.text(component, "is_additive_modification")
            if change.shape and not change.only and shape is not None:
                values[".shape"] = shape
            yield table, values


def write_changes(file: StageWriter, gear: Component, name: str, flanks: Mapping[str, Component]) -> None:
    """Write the modifications of the member `name`, as far as the format has them; the datum face is the toe."""
    file.put(gear, FACE_ORIENTATION, "negative")
    for flank in flanks.values():
        file.forget(flank, CHANGE_TYPES)
    for table, sides in FLANKS_BY_TABLE.items():
        for change in FLANK_CHANGES:
            stem = f"{name}.{table}.{change.table}"
            wanted = {key: f"{stem}.{key}" if key else stem for key in change.keys}
            if any(file.keys.get(key) is None for key in wanted.values()) or file.keys.get(f"{stem}.start_roll_length"):
                continue
            component = file.new(change.type)
            for key, attribute in change.keys.items():
                value = file.take(wanted[key])
                for id in (attribute, *(change.equal if key in ("", "amount") else ())):
                    file.put(component, id, value)
            if change.shape:
                file.put(component, change.shape, file.take(f"{stem}.shape") or change.only or RELIEF_SHAPES[0])
            for side in sides:
                if side in flanks:
                    file.relate("reference", {"origin": flanks[side], "referenced": component})
