"""Planetary stages of REXS models read as planetary sets, and written.

A file has one mesh of the sun and one mesh of the ring for each planet, or only for one planet if all planets are
alike.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gearmesh.errors import DesignError, FileError
from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import POSITION_ATTRIBUTES, StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.rexs.gears import (
    EXTERNAL_GEAR,
    FIGURE_ROUNDING,
    INTERNAL_GEAR,
    GearReader,
    write_gear,
)
from gearmesh.systems.cylindrical.rexs.pair import STAGE_TYPE as MESH
from gearmesh.systems.cylindrical.rexs.pair import (
    WRITTEN_KEYS,
    count_shift,
    member_keys,
    put_position,
    read_allowance,
    read_toothing,
    write_allowance,
)

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign

#: component of a planetary stage
PLANETARY_STAGE = "planetary_stage"
#: largest difference of the centre distances of one set
MAX_DISTANCE_DIFFERENCE_MM = 1e-6
#: largest difference of the angles of planets from equal spacing
MAX_ANGLE_DIFFERENCE_DEG = 1e-6


@dataclass(frozen=True)
class PlanetMeshes:
    """A planet with its meshes."""

    #: gear of the planet
    planet: Component
    #: mesh with the sun
    inner: StageReader
    #: mesh with the ring
    outer: StageReader
    #: gear of the sun
    sun: Component
    #: gear of the ring
    ring: Component


def read_set(file: StageReader) -> dict[str, Any]:
    """Return the keys of the design of a planetary stage."""
    own = file.own_keys(file.stage)
    planets = _planets(file)
    first = planets[0]
    common, members = _read_planet(file, first, own)
    told = len(file.notes)
    for other in planets[1:]:
        _see_that_it_is_alike(file, first, (common, members), other, _read_planet(file, other, own))
    # notes on the first planet hold for all planets
    del file.notes[told:]
    keys: dict[str, Any] = {
        "kind": "planetary",
        "units": "mm",
        "name": file.stage.name or None,
        **own,
        **common,
        **members,
    }
    distance = _center_distance(file, planets)
    keys["assembly.center_distance"] = distance
    keys |= read_allowance(first.inner, distance)
    for one in planets:
        read_allowance(one.inner, distance)
        read_allowance(one.outer, distance)
    keys |= _count_planets(file, planets, own)
    return {key: value for key, value in keys.items() if value is not None}


def _read_planet(file: StageReader, one: PlanetMeshes, own: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the shared keys of the meshes of a planet, and the keys of sun, planet and ring."""
    sun, planet = GearReader(one.inner, one.sun, SUN_NAME), GearReader(one.inner, one.planet, PLANET_NAME)
    ring = GearReader(one.outer, one.ring, RING_NAME)
    common = read_toothing(one.inner, (sun, planet))
    read_toothing(one.outer, (planet, ring))
    count_shift(file, (planet, ring), common, one.outer.size(one.outer.stage, "center_distance"))
    members: dict[str, Any] = {}
    for gear in (sun, planet, ring):
        members |= member_keys(gear, common, own)
    members |= file.materials({gear.name: gear.gear for gear in (sun, planet, ring)})
    return common, members


def _see_that_it_is_alike(
    file: StageReader,
    first: PlanetMeshes,
    known: tuple[dict[str, Any], dict[str, Any]],
    other: PlanetMeshes,
    keys: tuple[dict[str, Any], dict[str, Any]],
) -> None:
    """Refuse a planet that differs from the first planet."""
    before, after = ({**common, **members} for common, members in (known, keys))
    for key in (*before, *after):
        if not _alike(before.get(key), after.get(key)):
            name = key.removeprefix(f"{PLANET_NAME}.")
            reason = f"all planets must be alike: {first.planet.in_full} has {name} = {before.get(key)}"
            raise FileError(
                file.path,
                reason=f"{other.planet.in_full}: {name} = {after.get(key)}: {reason}, in {file.stage.in_full}",
            )


def _alike(one: Any, other: Any) -> bool:
    """True if two values are equal up to rounding."""
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=FIGURE_ROUNDING, abs_tol=FIGURE_ROUNDING)
    return bool(one == other)


def _center_distance(file: StageReader, planets: list[PlanetMeshes]) -> float | None:
    """Return the centre distance (mm), which all meshes must share; None if the file has none."""
    known: tuple[Component, float] | None = None
    for mesh in (mesh for one in planets for mesh in (one.inner, one.outer)):
        value = mesh.size(mesh.stage, "center_distance", "assembly.center_distance")
        if value is None:
            continue
        if known is not None and abs(value - known[1]) > MAX_DISTANCE_DIFFERENCE_MM:
            reason = f"must be {known[1]:g} mm, as {known[0].in_full} of the same set has it"
            raise file.refusal(mesh.stage, "center_distance", reason, value)
        known = known or (mesh.stage, value)
    return None if known is None else known[1]


def _count_planets(file: StageReader, planets: list[PlanetMeshes], own: dict[str, Any]) -> dict[str, Any]:
    """Return the keys of the number of planets and, if they are not equally spaced, of their angles."""
    shafts = len(list(file.model.relations_of("planet_shaft", "planetary_stage", file.stage.id)))
    meshing = len(planets)
    if meshing > 1:
        if shafts > meshing:
            reason = f"has {shafts} planet shafts and {meshing} planets with a mesh of the sun and one of the ring"
            raise FileError(file.path, reason=f"{file.stage.in_full}: {reason}")
        angles = _angles(planets)
        if angles is None or own.get("assembly.planet_angles"):
            return {"planets": meshing}
        even = [360.0 * k / meshing for k in range(meshing)]
        if all(abs(angle - wanted) < MAX_ANGLE_DIFFERENCE_DEG for angle, wanted in zip(angles, even, strict=True)):
            return {"planets": meshing}
        return {"planets": meshing, "assembly.planet_angles": ", ".join(f"{angle:.9g}" for angle in angles)}
    if not shafts and "planets" not in own:
        file.notes.append(f"{file.stage}: no planet_shaft relations say how many planets there are: 3 are taken")
    return {"planets": shafts} if shafts else {}


def _angles(planets: list[PlanetMeshes]) -> list[float] | None:
    """Return the angles (deg) of the planets about the sun's axis from the first planet, in rising order.

    None if the file does not give the positions of the planets.
    """
    reader, sun = planets[0].inner, planets[0].sun
    gears = [sun, *(one.planet for one in planets)]
    places = [reader.numbers(one, POSITION_ATTRIBUTES[1]) for one in gears]
    frames = {reader.text(one, POSITION_ATTRIBUTES[0]) for one in gears}
    axis = reader.numbers(sun, POSITION_ATTRIBUTES[2])
    if len(frames) > 1 or axis is None or len(axis) != 3 or not any(axis):
        return None
    if any(place is None or len(place) != 3 for place in places):
        return None
    points = [place or [] for place in places]
    # angles are measured in the plane across the sun's axis, from the first planet
    arms = [[b - a for a, b in zip(points[0], point, strict=True)] for point in points[1:]]
    along = [one / math.hypot(*axis) for one in axis]
    across = _cross(along, arms[0])
    ahead = _cross(across, along)
    if not any(across):
        return None
    turned = [math.degrees(math.atan2(_dot(arm, across), _dot(arm, ahead))) % 360.0 for arm in arms]
    return sorted(0.0 if 360.0 - one < MAX_ANGLE_DIFFERENCE_DEG else one for one in turned)


def _dot(one: list[float], other: list[float]) -> float:
    return sum(a * b for a, b in zip(one, other, strict=True))


def _cross(one: list[float], other: list[float]) -> list[float]:
    (a, b, c), (d, e, f) = one, other
    return [b * f - c * e, c * d - a * f, a * e - b * d]


def _planets(file: StageReader) -> list[PlanetMeshes]:
    """Return the planets of a set: each gear that a mesh without a ring gear and a mesh with one share."""
    parts = file.parts(file.stage, MESH) or _stages_of_shafts(file)
    inner: list[tuple[StageReader, tuple[Component, Component]]] = []
    outer: list[tuple[StageReader, Component, Component]] = []
    for one in map(file.of, parts):
        first, second = one.gears()
        rings = [_is_ring(file, gear) for gear in (first, second)]
        if any(rings):
            outer.append((one, first, second) if rings[0] else (one, second, first))
        else:
            inner.append((one, (first, second)))
    # a planet is the gear that a mesh of the sun and a mesh of the ring have in common
    planets = []
    for mesh, gears in inner:
        for ring_mesh, ring, planet in outer:
            if planet in gears:
                sun = gears[0] if planet is gears[1] else gears[1]
                planets.append(PlanetMeshes(planet, mesh, ring_mesh, sun, ring))
    if not planets or len(planets) < max(len(inner), len(outer)):
        counts = f"{len(inner)} cylindrical stages without a ring gear and {len(outer)} with one"
        wanted = "for each planet one of both, or one of both for all of them, which share the planet"
        raise FileError(file.path, reason=f"{file.stage.in_full}: has {counts}; read is a set that has {wanted}")
    for role in ("sun", "ring"):
        central_gears: dict[str, Component] = {getattr(one, role).id: getattr(one, role) for one in planets}
        if len(central_gears) > 1:
            named = ", ".join(gear.in_full for gear in central_gears.values())
            raise FileError(
                file.path, reason=f"{file.stage.in_full}: read is a set with one {role}; this one has {named}"
            )
    return planets


def _is_ring(file: StageReader, gear: Component) -> bool:
    """True if a gear is internal."""
    return gear.type == INTERNAL_GEAR or file.is_negative(gear, "number_of_teeth")


def _stages_of_shafts(file: StageReader) -> list[Component]:
    """Return the cylindrical stages with a gear on a planet shaft, for a set without parts."""
    relations = file.model.relations_of("planet_shaft", "planetary_stage", file.stage.id)
    shafts = {one.in_role("shaft") for one in relations}
    on_shafts = {
        one.in_role("part")
        for one in file.model.relations
        if one.type == "assembly" and one.in_role("assembly") in shafts
    }
    stages = [
        file.model.component(one.in_role("stage"))
        for one in file.model.relations
        if one.type == "stage" and {one.in_role("gear_1"), one.in_role("gear_2")} & on_shafts
    ]
    return [one for one in stages if one is not None and one.type == MESH]


def write_set(file: StageWriter, design: PlanetaryDesign, known: Component | None) -> Component:
    """Write a complete design in mm, with all its keys."""
    both = meshes(design)
    inner, outer = proportions(both.inner), proportions(both.outer)
    stage = file.stage(PLANETARY_STAGE, known, design.name or "")
    if known is None:
        _new_set(file, stage, design, inner.mesh.distance)
    reader = StageReader(design.rexs.file if design.rexs is not None else "", file.model, stage)
    planets = _planets(reader)
    first = planets[0]
    counted = _count_planets(reader, planets, {}).get("planets", design.planets)
    if counted != design.planets:
        raise DesignError(
            "planets",
            design.planets,
            must_be=f"{counted}, as in the REXS file; or leave out the table rexs for a new model",
        )
    first.ring.type = INTERNAL_GEAR
    members = (
        (first.sun, inner.gears[0], SUN_NAME),
        (first.planet, inner.gears[1], PLANET_NAME),
        (first.ring, outer.gears[1], RING_NAME),
    )
    for gear, of_gear, name in members:
        write_gear(file, gear, of_gear, name)
    for other in planets[1:]:
        _copy_gear(file, first.planet, other.planet)
    allowance = file.keys.get("assembly.center_distance_allowance")
    for mesh in {one.stage.id: one.stage for planet in planets for one in (planet.inner, planet.outer)}.values():
        file.put(mesh, "center_distance", inner.mesh.distance)
        if allowance is not None:
            file.keys["assembly.center_distance_allowance"] = allowance
        write_allowance(file, mesh, inner.mesh.distance)
    for key in ("assembly.center_distance", "planets", *WRITTEN_KEYS):
        file.take(key)
    return stage


def _new_set(file: StageWriter, stage: Component, design: PlanetaryDesign, distance: float) -> None:
    """Write gears, meshes and shafts of a new set: a shaft, a gear and two meshes for each planet."""
    sun, ring = file.new(EXTERNAL_GEAR, SUN_NAME), file.new(INTERNAL_GEAR, RING_NAME)
    for gear in (sun, ring):
        put_position(file, gear, sun, [0.0, 0.0, 0.0])
        shaft = file.new("shaft", gear.name)
        file.relate("assembly", {"assembly": shaft, "part": gear})
        file.relate("central_shaft", {"planetary_stage": stage, "shaft": shaft})
    for number, angle in enumerate(map(math.radians, design.angles), start=1):
        planet, shaft = file.new(EXTERNAL_GEAR, f"{PLANET_NAME} {number}"), file.new("shaft", f"{PLANET_NAME} {number}")
        put_position(file, planet, sun, [0.0, distance * math.cos(angle), distance * math.sin(angle)])
        file.relate("assembly", {"assembly": shaft, "part": planet})
        file.relate("planet_shaft", {"planetary_stage": stage, "shaft": shaft})
        for first, second in ((sun, planet), (planet, ring)):
            mesh = file.new(MESH, f"{first.name}, {second.name}")
            file.relate("assembly", {"assembly": stage, "part": mesh})
            file.relate("stage", {"stage": mesh, "gear_1": first, "gear_2": second})


def _copy_gear(file: StageWriter, origin: Component, gear: Component) -> None:
    """Give a planet the toothing, tool, modifications and material of the first planet; it keeps its position."""
    _copy_attributes(origin, gear, (*POSITION_ATTRIBUTES, "u_coordinate_on_shaft"))
    flanks = [file.flanks(one, "cylindrical_gear_flank") for one in (origin, gear)]
    for one, other in [(origin, gear), *((flanks[0][side], flanks[1][side]) for side in ("left", "right"))]:
        if one is not origin:
            _copy_attributes(one, other, ())
        referenced = [to.in_role("referenced") for to in file.model.relations_of("reference", "origin", one.id)]
        types = {to.type for id in referenced if (to := file.model.component(id)) is not None}
        file.forget(other, tuple(types), orphans=False)
        for to in map(file.model.component, referenced):
            if to is not None:
                file.relate("reference", {"origin": other, "referenced": to})
        steps = list(file.model.relations_of("manufacturing_step", "workpiece", one.id))
        if steps:
            gone = list(file.model.relations_of("manufacturing_step", "workpiece", other.id))
            file.model.relations = [
                relation for relation in file.model.relations if all(relation is not old for old in gone)
            ]
        for step in steps:
            roles = {role: file.model.component(step.in_role(role)) for role in ("tool", "manufacturing_settings")}
            whole = {role: part for role, part in roles.items() if part is not None}
            file.relate("manufacturing_step", {"workpiece": other, **whole}, step.order)


def _copy_attributes(origin: Component, other: Component, kept: tuple[str, ...]) -> None:
    """Give a component the attributes of another component, except the `kept` ones."""
    own = {id: one for id, one in other.attributes.items() if id in kept}
    other.attributes = {**{id: one for id, one in origin.attributes.items() if id not in kept}, **own}


#: reading and writing of planetary stages
PLANETARY_FORM = StageForm((PLANETARY_STAGE,), read_set, write_set)
