"""Modifications of flanks in REXS models: components to which flanks refer, one of each kind, amounts in mm."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_writer import StageWriter

#: tables of a design, and the flanks that they are for
TABLES = {"modifications": ("left", "right"), "modifications_right": ("right",), "modifications_left": ("left",)}
#: at which end of the face, along u, the datum face lies: at the toe if negative, as without this attribute
ORIENTATION = "datum_face_orientation"
OTHER_END = {"end_relief_toe": "end_relief_heel", "end_relief_heel": "end_relief_toe"}
SHAPES = ("linear", "parabolic", "circular")


@dataclass(frozen=True)
class FlankChange:
    """A kind of modification: component and table of a design, attributes of the table's keys; `equal`: attributes that have the
    amount too; `shape`: attribute with the shape, and the one that it must be where the design has no choice."""

    type: str
    table: str
    keys: Mapping[str, str]
    equal: tuple[str, ...] = ()
    shape: str = ""
    only: str = ""


CHANGES = (
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
TYPES = tuple(change.type for change in CHANGES)


def read_changes(
    file: StageReader,
    gear: Component,
    flanks: Mapping[str, Component],
    start_of: Callable[[str, float], float | None],
) -> dict[str, Any]:
    """Keys of the modifications of both flanks: those that both have, then those of one.

    `start_of` gives the diameter at which a relief of tip or root of some length begins. What a design cannot have is left unused.
    """
    at_heel = file.text(gear, ORIENTATION) == "positive"
    sides = {
        side: [one for change in CHANGES for one in _read(file, flank, change, start_of, at_heel)]
        for side, flank in flanks.items()
    }
    both = [one for one in sides.get("left", []) if one in sides.get("right", [])]
    keys: dict[str, Any] = {}
    for table, names in TABLES.items():
        seen = both if len(names) == 2 else [one for one in sides.get(names[0], []) if one not in both]
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
    table = OTHER_END.get(change.table, change.table) if at_heel else change.table
    for one in file.references(flank, change.type):
        values: dict[str, Any] = {}
        for key, attribute in change.keys.items():
            values[f".{key}" if key else ""] = file.number(one, attribute)
        if ".start_diameter" in values and values[".start_diameter"] is None:
            length = file.number(one, f"{change.type}_datum_length")
            values[".start_diameter"] = None if length is None else start_of(change.type, length)
        amount = next(iter(values.values()))
        others = [file.number(one, id) for id in change.equal]
        shape = file.text(one, change.shape) if change.shape else None
        whole = None not in values.values() and all(other is None or math.isclose(other, amount) for other in others)
        allowed = (change.only,) if change.only else SHAPES
        if amount == 0.0:
            continue
        if at_heel and change.table == "helix_slope":
            whole = False
        if not whole or (shape is not None and shape not in allowed):
            file.notes.append(f"{one}: not used: a design has no such {change.table}")
            file.used -= {(one.id, id) for id in one.attributes}
        else:
            file.text(one, "is_additive_modification")
            if change.shape and not change.only and shape is not None:
                values[".shape"] = shape
            yield table, values


def write_changes(file: StageWriter, gear: Component, name: str, flanks: Mapping[str, Component]) -> None:
    """Modifications of the member `name`, as far as the format has them; the datum face is the toe."""
    file.put(gear, ORIENTATION, "negative")
    for flank in flanks.values():
        file.forget(flank, TYPES)
    for table, sides in TABLES.items():
        for change in CHANGES:
            stem = f"{name}.{table}.{change.table}"
            wanted = {key: f"{stem}.{key}" if key else stem for key in change.keys}
            if any(file.keys.get(key) is None for key in wanted.values()) or file.keys.get(f"{stem}.start_roll_length"):
                continue
            one = file.new(change.type)
            for key, attribute in change.keys.items():
                value = file.take(wanted[key])
                for id in (attribute, *(change.equal if key in ("", "amount") else ())):
                    file.put(one, id, value)
            if change.shape:
                file.put(one, change.shape, file.take(f"{stem}.shape") or change.only or SHAPES[0])
            for side in sides:
                if side in flanks:
                    file.relate("reference", {"origin": flanks[side], "referenced": one})
