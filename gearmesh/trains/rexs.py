"""Trains of REXS models: the stages of a gearbox, the shafts with their gears, and where they are.

The u axis of a shaft is its z axis. Positions along shafts, and turns of stages about them, follow from the vectors of the gears,
else from their coordinates on the shaft, else gears stand side by side.
"""

from __future__ import annotations

import math
from dataclasses import field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.exchange import read_stage, stages_in
from gearmesh.design.core import Design
from gearmesh.exchange.model import Component, RexsModel
from gearmesh.exchange.rexs_file import read_rexs
from gearmesh.exchange.stage import StageReader
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.trains.file import TRAIN_KIND
from gearmesh.trains.stage import CARRIER_NAME

#: decimals of positions (mm) and turns (deg)
PLACE_DECIMALS = 9
#: members of planetary sets in the order in which they are taken as fixed, if their shafts hold nothing else
FIXED_ORDER = ("ring", CARRIER_NAME, "sun")
#: distance (mm) of the faces of gears whose places the file does not have
SIDE_BY_SIDE_MM = 5.0


@dataclass
class _GearboxSeat:
    """A member on a shaft of the file."""

    #: name of its stage
    stage: str
    #: name of the member in its stage
    member: str
    #: gear of the member; the gear of the sun for a carrier
    gear: Component
    #: gear that it meshes with; None for coaxial members
    mate: Component | None


@dataclass
class _GearboxFile:
    """A model, with the members on its shafts."""

    #: path of the file
    path: Path
    #: components and relations of the file
    model: RexsModel
    #: reader of the stages
    reader: StageReader
    #: members by the ids of shafts
    shafts: dict[str, list[_GearboxSeat]] = field(default_factory=dict)
    #: notes for the reader, one line each
    notes: list[str] = field(default_factory=list)

    def vector(self, component: Component, name: str) -> Array | None:
        """Return a vector (3,) of a component, None if the file has none."""
        values = self.reader.numbers(component, name)
        return None if values is None or len(values) != 3 else np.array(values)


def train_tables(path: Path) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return the tables of the train of all stages of a REXS file, and notes, one line each.

    Raises the errors of reading stages.
    """
    model = read_rexs(path)
    found = stages_in(model, path)
    file = _GearboxFile(path, model, StageReader(str(path), model, found[0]))
    stages: dict[str, Any] = {}
    for component in found:
        reading = read_stage(model, path, component.id)
        name = f"stage_{component.id}"
        stages[name] = {key: value for key, value in reading.keys.items() if key != "rexs"}
        file.notes += [f"{name}: {line}" for line in reading.warnings]
        _seat_members(file, StageReader(str(path), model, component), name, reading.design, stages[name])
    start = _input(file)
    shafts, last = _shafts(file, start)
    tables = {"kind": TRAIN_KIND, "name": path.stem, "input": _shaft_name(start), "output": last}
    return {**tables, "stages": stages, "shafts": shafts}, tuple(file.notes)


def _shaft_name(id: str) -> str:
    return f"shaft_{id}"


def _seat_members(file: _GearboxFile, reader: StageReader, name: str, design: Design, keys: dict[str, Any]) -> None:
    """Put the central members of a stage on their shafts."""
    if any(reader.model.relations_of("stage", "stage", reader.stage.id)):
        names = design.member_names
        assert names is not None
        first, second = reader.gears()
        members = list(names.members)
        if _teeth(reader, first) != _own_teeth(design, members[0]):
            first, second = second, first
        for member, gear, mate in ((members[0], first, second), (members[1], second, first)):
            shaft = reader.assembly_of(gear, "shaft")
            # a gear without a shaft in the file has one of its own
            id = f"{name}_{member}" if shaft is None else shaft.id
            file.shafts.setdefault(id, []).append(_GearboxSeat(name, member, gear, mate))
        return
    _seat_set(file, reader, name, design, keys)


def _seat_set(file: _GearboxFile, reader: StageReader, name: str, design: Design, keys: dict[str, Any]) -> None:
    """Put sun, ring and carrier of a planetary set on their shafts; one of them is fixed."""
    relations = reader.model.relations_of("planet_shaft", "planetary_stage", reader.stage.id)
    planets = {relation.in_role("shaft") for relation in relations}
    gears = {gear.id: gear for stage in map(reader.of, reader.part_stages()) for gear in stage.gears()}
    shafts: dict[str, str] = {}
    central: dict[str, Component] = {}
    for member in ("sun", "ring"):
        for gear in gears.values():
            shaft = reader.assembly_of(gear, "shaft")
            if (shaft is None or shaft.id not in planets) and _teeth(reader, gear) == _own_teeth(design, member):
                central[member] = gear
                if shaft is not None:
                    shafts[member] = shaft.id
                break
    carriers = reader.model.relations_of("planet_carrier_shaft", "planetary_stage", reader.stage.id)
    for relation in carriers:
        shafts[CARRIER_NAME] = str(relation.in_role("shaft"))
    others = {one.in_role("assembly") for one in reader.model.relations
              if one.type == "assembly" and one.in_role("part") in _meshing(reader) - {*gears}}  # fmt: skip
    free = [member for member in FIXED_ORDER if shafts.get(member) not in others]
    # gears without a shaft are held by the casing; a carrier without one may be left out of the file
    held = [member for member in ("ring", "sun") if member not in shafts]
    fixed = (held or free or FIXED_ORDER)[0]
    keys["fixed"] = fixed
    file.notes.append(f"{name}: the {fixed} is taken as fixed")
    for member in reversed(FIXED_ORDER):
        if member != fixed:
            gear = central.get(member, central["sun"])
            # a carrier without a shaft in the file has one of its own
            file.shafts.setdefault(shafts.get(member, f"{name}_{member}"), []).append(
                _GearboxSeat(name, member, gear, None)
            )


def _meshing(reader: StageReader) -> set[str | None]:
    """Return the ids of all gears that mesh."""
    stages = (one for one in reader.model.relations if one.type == "stage")
    return {one.in_role(role) for one in stages for role in ("gear_1", "gear_2")}


def _teeth(reader: StageReader, gear: Component) -> int | None:
    """Return the number of teeth of a gear, or of threads of a worm."""
    for attribute in ("number_of_teeth", "number_of_starts"):
        if attribute in gear.attributes and (count := reader.count(gear, attribute)) is not None:
            return abs(count)
    return None


def _own_teeth(design: Design, member: str) -> int:
    """Return the number of teeth or threads of a member of a design."""
    table = getattr(design, member)
    return abs(int(getattr(table, "threads", 0) or table.teeth))


def _input(file: _GearboxFile) -> str:
    """Return the id of the shaft that defines the speed, else of the first with members of one stage alone."""
    for id in file.shafts:
        shaft = file.model.component(id)
        known = None if shaft is None else shaft.attributes.get("defines_speed")
        if known is not None and str(known.text).lower() == "true":
            return id
    ends = [id for id, seats in file.shafts.items() if len({seat.stage for seat in seats}) == 1]
    return (ends or list(file.shafts))[0]


def _shafts(file: _GearboxFile, start: str) -> tuple[dict[str, Any], str]:
    """Return the tables of the shafts in the order of the motion, and the name of the last one."""
    made: dict[str, Any] = {}
    waiting, stages = [(start, file.shafts[start][0])], set[str]()
    while waiting:
        id, reached = waiting.pop(0)
        if _shaft_name(id) in made:
            continue
        seats = [reached, *(seat for seat in file.shafts[id] if seat is not reached)]
        made[_shaft_name(id)] = {"members": _members(file, id, seats)}
        for seat in seats:
            if seat.stage not in stages:
                stages.add(seat.stage)
                waiting += [(other, own) for other, all_seats in file.shafts.items() if other != id
                            for own in all_seats if own.stage == seat.stage]  # fmt: skip
    # the same order for shafts that no stage connects, which the train refuses
    rest = {_shaft_name(id): {"members": _members(file, id, seats)} for id, seats in file.shafts.items()
            if _shaft_name(id) not in made}  # fmt: skip
    return {**made, **rest}, list(made)[-1]


def _members(file: _GearboxFile, id: str, seats: list[_GearboxSeat]) -> list[Any]:
    """Return the members of a shaft as a file has them; the first is the one through which the shaft is reached."""
    first = seats[0]
    axis = file.vector(first.gear, "u_axis_vector")
    if axis is not None:
        axis = axis / np.linalg.norm(axis)
    places = _places(file, id, seats, axis)
    members: list[Any] = [{"member": f"{first.stage}.{first.member}", "position": places[0]}]
    for seat, place in zip(seats[1:], places[1:], strict=True):
        entry: dict[str, Any] = {"member": f"{seat.stage}.{seat.member}", "position": place}
        turn = None if axis is None else _turn(file, first, seat, axis)
        own_axis = file.vector(seat.gear, "u_axis_vector")
        if axis is not None and own_axis is not None and float(axis @ own_axis) < 0.0:
            entry["reversed"] = True
        if turn:
            entry["turn"] = turn
        members.append(entry)
    return members


def _places(file: _GearboxFile, id: str, seats: list[_GearboxSeat], axis: Array | None) -> list[float]:
    """Return the positions of members along a shaft, mm."""
    points = [file.vector(seat.gear, "support_vector") for seat in seats]
    if axis is not None and all(point is not None for point in points):
        return [round(float(axis @ point), PLACE_DECIMALS) for point in points if point is not None]
    known = [file.reader.number(seat.gear, "u_coordinate_on_shaft", zero=True) for seat in seats]
    if all(value is not None for value in known):
        return [float(value) for value in known if value is not None]
    widths = [file.reader.number(seat.gear, "face_width") or 0.0 for seat in seats]
    if len(seats) > 1:
        file.notes.append(f"{_shaft_name(id)}: the file does not place its gears; they stand side by side")
    places = [0.0]
    for before, after in pairwise(widths):
        places.append(places[-1] + 0.5 * (before + after) + SIDE_BY_SIDE_MM)
    return places


def _turn(file: _GearboxFile, first: _GearboxSeat, seat: _GearboxSeat, axis: Array) -> float | None:
    """Return the turn (deg) of the stage of a seat from straight on; None where the file or the stage has no direction."""
    directions = []
    for own in (first, seat):
        if own.mate is None:
            return None
        ends = [file.vector(gear, "support_vector") for gear in (own.gear, own.mate)]
        if ends[0] is None or ends[1] is None:
            return None
        across = ends[1] - ends[0]
        directions.append(across - (across @ axis) * axis)
    back, ahead = -directions[0], directions[1]
    turn = math.degrees(math.atan2(float(np.cross(back, ahead) @ axis), float(back @ ahead)))
    return round(turn, PLACE_DECIMALS)
