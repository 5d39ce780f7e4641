"""CAD solids: members as bodies with named spline, plane and conical faces, for STEP."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh.answers.bodies.extract import WHOLE, Extract
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, figures
from gearmesh.cad.step import require_occ
from gearmesh.cad.suffixes import STEP
from gearmesh.design.core import Design
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.teeth.gear_train import Member

if TYPE_CHECKING:
    from gearmesh.cad.step import Part


@dataclass(frozen=True)
class CadFigures(Figures):
    """A CAD solid of one member, as OpenCASCADE measures it."""

    faces: int = figure("faces of the solid", whole=True)
    volume: float = figure("volume of the solid", "mm3", "V")
    volume_error: float = figure("relative error of the volume against the exact one")
    max_deviation: float = figure("largest distance between spline faces and the exact tooth surfaces", "um")
    tolerance: float = figure("largest distance that was allowed", "um")
    seconds: float = figure("run time", "s", timing=True)
    offset: float | None = figure(
        "distance of the tooth surfaces from those of the design, positive away from the material",
        "mm",
        optional=True,
        default=None,
    )


@dataclass(frozen=True, repr=False)
class Cad(Result):
    """CAD solids of one part in its own frame, or of several members in mesh; figures by part."""

    design: Design
    parts: tuple[Part, ...]
    placements: tuple[Rigid, ...]
    measured: dict[str, CadFigures]
    own: dict[str, Summary]
    warnings: tuple[str, ...] = ()

    @property
    def figures(self) -> dict[str, Summary]:
        """All figures of each part, by their keys."""
        return {name: Summary(part, self.own[name]) for name, part in self.measured.items()}

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (*STEP, ".json")

    @property
    def headline(self) -> str:
        return "; ".join(
            f"{name}, {part.faces} faces within {part.max_deviation:.3g} um" for name, part in self.measured.items()
        )

    @property
    def description(self) -> str:
        """The header of a STEP file."""
        largest = max(part.max_deviation for part in self.measured.values())
        return f"{self.design.name or self.design.kind}, tooth surfaces within {largest:.3g} um of the exact ones"

    @property
    def listings(self) -> list[Listing]:
        return [
            figures(name if len(self.figures) > 1 else "", part_figures) for name, part_figures in self.figures.items()
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([{"part": name, **part_figures} for name, part_figures in self.figures.items()])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "cad": self.figures, "warnings": self.warnings}

    def _write(self, target: Path) -> None:
        from gearmesh.cad.step import write_step

        write_step(self.parts, target, self.description, self.placements)


def cad_solid(member: Member, tolerance: float, offset: float | None = None) -> tuple[Part, CadFigures]:
    """A member as a CAD solid within `tolerance` (mm) of its exact surfaces, and its figures; `offset` (mm): how far its tooth
    surfaces have been moved.

    Raises DesignError for a body that does not make a solid, OutputError where OpenCASCADE is missing.
    """
    from gearmesh.cad.bar import bar_part, has_straight_faces, spline_bar_part
    from gearmesh.cad.brep import exact_volume, spline_tooth
    from gearmesh.cad.solid_part import solid_part, volume

    started = time.perf_counter()
    slides = member.tooth.joint.travel is not None
    if slides and has_straight_faces(member):
        part, deviation = bar_part(member)
    else:
        teeth = spline_tooth(member.one_tooth, tolerance)
        part = spline_bar_part(member, teeth) if slides else solid_part(member, teeth)
        deviation = max(teeth.deviation.values())
    measured = volume(part)
    return part, CadFigures(
        faces=len(part.faces),
        volume=measured,
        volume_error=measured / exact_volume(member) - 1.0,
        max_deviation=1e3 * deviation,
        tolerance=1e3 * tolerance,
        seconds=time.perf_counter() - started,
        offset=offset,
    )


def cad_of(gears: GearSet, member: str | None, tolerance: float, extract: Extract = WHOLE) -> Cad:
    """One member as a CAD solid, or all of them in mesh, as `Gears.cad` says; `tolerance` in mm."""
    require_occ()
    places = {} if member is not None else gears.places
    wanted = [gears.part(name) for name in ([member] if member is not None else gears.members)]
    made = [cad_solid(extract.shift(part.member), tolerance, extract.offset or None) for part in wanted]
    return Cad(
        gears.design,
        tuple(part for part, _ in made),
        tuple(places.values()),
        {part.name: measures for part, measures in made},
        {part.name: tool.figures for (part, _), tool in zip(made, wanted, strict=True)},
        (*gears.warnings, *(line for part in wanted for line in part.warnings)),
    )
