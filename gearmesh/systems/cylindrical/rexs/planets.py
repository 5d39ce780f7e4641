"""Planetary stages of REXS models as planetary sets, and back: two cylindrical stages that share the planet."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearmesh.errors import FileError
from gearmesh.exchange.model import Component
from gearmesh.exchange.stage import StageReader
from gearmesh.exchange.stage_form import StageForm
from gearmesh.exchange.stage_writer import StageWriter
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET, RING, SUN
from gearmesh.systems.cylindrical.rexs.gears import EXTERNAL, INTERNAL, GearReader, write_gear
from gearmesh.systems.cylindrical.rexs.pair import GIVEN, read_toothing
from gearmesh.systems.cylindrical.rexs.pair import STAGE as MESH

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign

STAGE = "planetary_stage"


def read_set(file: StageReader) -> dict[str, Any]:
    """Keys of the design of a planetary stage."""
    own = file.own_keys(file.stage)
    inner, outer = _stages(file)
    both, ring_side = inner.gears(), outer.gears()
    planet = next((gear for gear in both if gear in ring_side), None)
    if planet is None:
        raise FileError(
            file.path, reason=f"{file.stage}: {inner.stage} and {outer.stage} share no gear, which is the planet"
        )
    sun = both[0] if planet is both[1] else both[1]
    ring = ring_side[0] if planet is ring_side[1] else ring_side[1]
    readers = {SUN: GearReader(inner, sun), PLANET: GearReader(inner, planet), RING: GearReader(outer, ring)}
    common = read_toothing(inner, (readers[SUN], readers[PLANET]))
    read_toothing(outer, (readers[PLANET], readers[RING]))
    keys: dict[str, Any] = {"kind": "planetary", "units": "mm", "name": file.stage.name or None, **own, **common}
    for name, gear in readers.items():
        made = gear.keys(common["module"], common["pressure_angle"], common["helix_angle"])
        keys |= {f"{name}.{key}": value for key, value in made.items()}
        if f"{name}.dedendum" in own:
            keys.pop(f"{name}.root_diameter", None)
    distances = {abs(value) for one in (inner, outer) if (value := one.number(one.stage, "center_distance", "mm"))}
    if distances and max(distances) - min(distances) > 1e-6:
        raise outer.refusal(
            outer.stage, "center_distance", f"that of sun and planet is {min(distances):g}", max(distances)
        )
    keys["assembly.center_distance"] = min(distances, default=None)
    shafts = len(list(file.model.relations_of("planet_shaft", "planetary_stage", file.stage.id)))
    if shafts:
        keys["planets"] = shafts
    elif "planets" not in own:
        file.notes.append(f"{file.stage}: no planet_shaft relations say how many planets there are: 3 are taken")
    return {key: value for key, value in keys.items() if value is not None}


def _stages(file: StageReader) -> tuple[StageReader, StageReader]:
    """The mesh without a ring gear, and that with it."""
    stages = [file.of(one) for one in file.parts(file.stage, MESH)]
    with_ring = [any(gear.type == INTERNAL for gear in one.gears()) for one in stages]
    if sorted(with_ring) != [False, True]:
        counts = f"{len(stages)} cylindrical stages, {sum(with_ring)} with a ring gear"
        reason = f"{file.stage}: has {counts}; two, one with it, are read"
        raise FileError(file.path, reason=reason)
    return stages[with_ring.index(False)], stages[with_ring.index(True)]


def write_set(file: StageWriter, design: PlanetaryDesign, known: Component | None) -> Component:
    """A complete design in mm, all of it stated."""
    both = meshes(design)
    inner, outer = proportions(both.inner), proportions(both.outer)
    stage = file.stage(STAGE, known, design.name or "")
    names = (SUN, PLANET, RING)
    parts = [
        one
        for relation in file.model.relations_of("assembly", "assembly", stage.id)
        if (one := file.model.component(relation.in_role("part"))) is not None and one.type == MESH
    ]
    for _ in range(2 - len(parts)):
        parts.append(file.new(MESH))
        file.relate("assembly", {"assembly": stage, "part": parts[-1]})
    if _has_ring(file, parts[0]):
        parts.reverse()
    sun, planet = _gears(file, parts[0], (EXTERNAL, EXTERNAL), names[:2])
    ring = _ring(file, parts[1], planet)
    for mesh, of in zip(parts, (inner, outer), strict=True):
        file.put(mesh, "center_distance", of.mesh.distance, "mm")
    file.take("assembly.center_distance")
    for gear, of_gear, name in (
        (sun, inner.gears[0], SUN),
        (planet, inner.gears[1], PLANET),
        (ring, outer.gears[1], RING),
    ):
        write_gear(file, gear, of_gear, name)
    count = file.take("planets")
    for _ in range(count - len(list(file.model.relations_of("planet_shaft", "planetary_stage", stage.id)))):
        file.relate("planet_shaft", {"planetary_stage": stage, "shaft": file.new("shaft", PLANET)})
    for key in GIVEN:
        file.take(key)
    return stage


def _has_ring(file: StageWriter, mesh: Component) -> bool:
    relations = file.model.relations_of("stage", "stage", mesh.id)
    gears = [file.model.component(one.in_role(role)) for one in relations for role in ("gear_1", "gear_2")]
    return any(gear is not None and gear.type == INTERNAL for gear in gears)


def _gears(
    file: StageWriter, mesh: Component, types: tuple[str, str], names: tuple[str, ...]
) -> tuple[Component, Component]:
    """Sun and planet, in this order."""
    first, second = file.gears(mesh, types, (names[0], names[1]))
    with_ring = {
        relation.in_role(role)
        for relation in file.model.relations
        if relation.type == "stage" and relation.in_role("stage") != mesh.id
        for role in ("gear_1", "gear_2")
    }
    return (second, first) if first.id in with_ring else (first, second)


def _ring(file: StageWriter, mesh: Component, planet: Component) -> Component:
    for relation in file.model.relations_of("stage", "stage", mesh.id):
        for role in ("gear_1", "gear_2"):
            one = file.model.component(relation.in_role(role))
            if one is not None and one.id != planet.id:
                return one
    ring = file.new(INTERNAL, RING)
    file.relate("stage", {"stage": mesh, "gear_1": planet, "gear_2": ring})
    return ring


PLANETARY = StageForm((STAGE,), read_set, write_set)
