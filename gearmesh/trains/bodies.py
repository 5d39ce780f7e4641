"""Bodies of a train: one solid per member, or per shaft whose members are joined, all in mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.answers.bodies.solid import Solid, Solids, solid_of
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.mesh.joined import joined_mesh
from gearmesh.progress import in_turn
from gearmesh.records import dataclass
from gearmesh.trains.file import naming_stage
from gearmesh.trains.layout import Layout, Shaft

if TYPE_CHECKING:
    from gearmesh.answers.bodies.cad import Cad, CadFigures
    from gearmesh.cad.step import Part
    from gearmesh.teeth.gear_train import Member


@dataclass(frozen=True)
class TrainBody:
    """A body of a train: one member, or the members of a joined shaft."""

    #: name of the member, as "first.pinion", or of the shaft
    name: str
    #: members with the transformations from their own frames to that of the body
    members: Mapping[str, Rigid]
    #: frame of the body to that of the train
    place: Rigid


def bodies_of(layout: Layout, psi: float) -> tuple[TrainBody, ...]:
    """Return all bodies of a train in contact at a rotation (rad) of the input shaft, in the order of shafts and stages."""
    placed = layout.places(psi)
    turned = layout.turns(np.array([psi]))
    joined = {}
    for name in joined_shafts(layout).values():
        shaft = layout.shafts[name]
        frame = shaft.frame @ Rigid.about_z(float(turned[name][0]))
        joined[name] = TrainBody(name, _in_shaft(layout, shaft), frame)
    alone = {name: TrainBody(name, {name: Rigid.identity()}, place) for name, place in placed.items()}
    of = joined_shafts(layout)
    bodies = (joined[of[name]] if name in of else alone[name] for name in placed)
    return tuple({body.name: body for body in bodies}.values())


def joined_shafts(layout: Layout) -> dict[str, str]:
    """Return the shafts whose gears are one body, by the names of these gears."""
    gears = set(gear_names(layout))
    found: dict[str, str] = {}
    for shaft in layout.shafts.values():
        names = [member.name for member in shaft.members if member.name in gears]
        if shaft.joined and len(names) > 1:
            found |= dict.fromkeys(names, shaft.name)
    return found


def gear_names(layout: Layout) -> list[str]:
    """Return the names of all gears, as "stage.member", in the order of the stages."""
    return [f"{name}.{member}" for name, stage in layout.stages.items() for member in stage.gears.train.members]


def _in_shaft(layout: Layout, shaft: Shaft) -> dict[str, Rigid]:
    """Return transformations from the own frames of the gears of a shaft to its frame at rotation 0."""
    stages = layout.stages
    found = {}
    for member in shaft.members:
        train = stages[member.stage].gears.train
        if member.port in train.members:
            turned = Rigid.about_z(float(member.theta(np.zeros(1))[0]))
            found[member.name] = member.port_to_shaft @ turned @ train.members[member.port].mount.own_to_turning
    return found


def solids_of_train(
    layout: Layout, tolerance: float | None, file: str | PathLike[str] | None, psi: float, warnings: tuple[str, ...]
) -> Solids:
    """Return all bodies as watertight meshes in contact at a rotation (rad) of the input shaft.

    `tolerance`: mm; by default those of the designs. `file`: file for which the meshes are proved.
    """
    stages = layout.stages
    made = {}
    for body in in_turn(bodies_of(layout, psi)):
        parts = []
        for name, to_body in body.members.items():
            stage, _, member = name.partition(".")
            with naming_stage(stage):
                gears, place = stages[stage].gears, body.place @ to_body
                part = solid_of(gears, member, gears.within(tolerance), file=file, place=place)
                parts.append(_named(part.move(to_body), name))
        made[body.name] = _one_body(body, parts, file) if len(parts) > 1 else parts[0].move(body.place)
    return Solids(layout.file, made, warnings)


def _named(solid: Solid, name: str) -> Solid:
    """Return a solid under the name of its member in the train; the train has its warnings."""
    return replace(solid, facets=replace(solid.mesh, name=name), warnings=())


def _one_body(body: TrainBody, parts: list[Solid], file: str | PathLike[str] | None) -> Solid:
    """Return the parts of a joined shaft as one solid in the frame of the train."""
    from gearmesh import io
    from gearmesh.mesh.solid import prove

    try:
        mesh, genus = joined_mesh([part.mesh for part in parts], body.name)
    except DesignError as failure:
        raise failure.rename(f"shafts.{body.name}.joined") from failure
    placed = mesh.move(body.place)
    proof = prove(placed if file is None else io.mesh_in_file(placed, file), genus)
    measured = [part.measured for part in parts]
    figures = replace(
        measured[0],
        triangles=placed.triangle_count,
        watertight=proof.ok,
        volume=proof.volume,
        max_deviation=max(own.max_deviation for own in measured),
        sampled_deviation=max(own.sampled_deviation for own in measured),
        tolerance=max(own.tolerance for own in measured),
        seconds=sum(own.seconds for own in measured),
    )
    return Solid(parts[0].design, placed, figures)


def cad_of_train(layout: Layout, tolerance: float, psi: float, warnings: tuple[str, ...]) -> Cad:
    """Return all bodies as a CAD assembly in contact at a rotation (rad) of the input shaft; `tolerance` in mm.

    Every occurrence is a part of its own, with its own name: readers that share the shapes of copies lose their names.
    """
    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.cad.step import Occurrence, PartAssembly, require_occ
    from gearmesh.figures import Summary

    require_occ()
    known: list[tuple[Member, tuple[Part, CadFigures]]] = []
    occurrences: list[Occurrence] = []
    measured: dict[str, CadFigures] = {}
    for body in in_turn(bodies_of(layout, psi)):
        made = [_cad_member(layout, name, tolerance, known) for name in body.members]
        whole, measured[body.name] = made[0] if len(made) == 1 else _one_cad_body(body, made)
        occurrences.append(Occurrence(body.name, whole, body.place))
    assembly = PartAssembly(layout.file.title, tuple(occurrences))
    return Cad(layout.file, assembly, measured, {name: Summary() for name in measured}, warnings)


def _cad_member(
    layout: Layout, name: str, tolerance: float, known: list[tuple[Member, tuple[Part, CadFigures]]]
) -> tuple[Part, CadFigures]:
    """Return a member as a CAD solid with a shape of its own; members that look alike are made once and copied."""
    from gearmesh.answers.bodies.cad import cad_solid
    from gearmesh.cad.step import own_copy

    stage, _, word = name.partition(".")
    gears = layout.stages[stage].gears
    with naming_stage(stage):
        member = gears.stocked_part(word).member
        alike = next((made for other, made in known if member.is_shaped_as(other)), None)
        if alike is not None:
            return own_copy(alike[0], name), alike[1]
        part, figures = cad_solid(member, tolerance)
    known.append((member, (part, figures)))
    return replace(part, name=name), figures


def _one_cad_body(body: TrainBody, made: list[tuple[Part, CadFigures]]) -> tuple[Part, CadFigures]:
    """Return the members of a joined shaft as one CAD solid."""
    from gearmesh.cad.joined_part import joined_part
    from gearmesh.cad.volume import volume

    figures = [own for _, own in made]
    try:
        part = joined_part([own.move(to) for (own, _), to in zip(made, body.members.values(), strict=True)], body.name)
    except DesignError as failure:
        raise failure.rename(f"shafts.{body.name}.joined") from failure
    return part, replace(
        figures[0],
        faces=len(part.faces),
        volume=volume(part),
        # of the members: how much of them is common is not known in closed form
        volume_error=sum(own.volume * own.volume_error for own in figures) / sum(own.volume for own in figures),
        max_deviation=max(own.max_deviation for own in figures),
        seconds=sum(own.seconds for own in figures),
    )
