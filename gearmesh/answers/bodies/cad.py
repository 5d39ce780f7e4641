"""CAD solids: members as bodies with named spline, plane and conical faces, for STEP."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header, times_apart
from gearmesh.answers.tables import Listing, figures
from gearmesh.cad.step import SUFFIXES, require_occ
from gearmesh.design.core import Design
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.teeth.train import Member

if TYPE_CHECKING:
    from gearmesh.cad.step import Part


@dataclass(frozen=True, repr=False)
class Cad(Result):
    """CAD solids of one part in its own frame, or of several members where they stand in mesh; figures by part."""

    design: Design
    parts: tuple[Part, ...]
    placements: tuple[Rigid, ...]
    figures: dict[str, dict[str, Any]]
    warnings: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (*SUFFIXES, ".json")

    @property
    def headline(self) -> str:
        return "; ".join(
            f"{name}, {found['faces']} faces within {found['max_deviation_um']:.3g} um"
            for name, found in self.figures.items()
        )

    @property
    def description(self) -> str:
        """What stands in the header of a STEP file."""
        largest = max(found["max_deviation_um"] for found in self.figures.values())
        return f"{self.design.name or self.design.kind}, tooth surfaces within {largest:.3g} um of the exact ones"

    @property
    def listings(self) -> list[Listing]:
        return [figures(name if len(self.figures) > 1 else "", found) for name, found in self.figures.items()]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([{"part": name, **found} for name, found in self.figures.items()])

    def document(self) -> dict[str, Any]:
        return times_apart({**header(self.design), "cad": self.figures, "warnings": list(self.warnings)})

    def _write(self, target: Path) -> None:
        from gearmesh.cad.step import write_step

        write_step(self.parts, target, self.description, self.placements)


def cad_solid(member: Member, tolerance: float, extra: Mapping[str, Any] | None = None) -> tuple[Part, dict[str, Any]]:
    """A member as a CAD solid within `tolerance` (mm) of its exact surfaces, and its figures with the `extra` ones.

    Raises DesignError for a body that does not make a solid, OutputError where OpenCASCADE is missing.
    """
    from gearmesh.cad.bar import bar_part
    from gearmesh.cad.brep import exact_volume, spline_tooth
    from gearmesh.cad.solid_part import solid_part, volume

    started = time.perf_counter()
    if member.tooth.course.drift is not None:
        part, deviation = bar_part(member)
    else:
        teeth = spline_tooth(member.tooth, tolerance)
        part, deviation = solid_part(member, teeth), max(teeth.deviation.values())
    measured = volume(part)
    found = {
        "faces": len(part.faces),
        "volume_mm3": measured,
        "volume_error": measured / exact_volume(member) - 1.0,
        "max_deviation_um": 1e3 * deviation,
        "tolerance_um": 1e3 * tolerance,
        "seconds": time.perf_counter() - started,
    }
    return part, {**found, **(extra or {})}


def cad_of(gears: GearSet, member: str | None, tolerance: float) -> Cad:
    """One member as a CAD solid, or all of them in mesh, as `Gears.cad` says; `tolerance` in mm."""
    require_occ()
    places = {} if member is not None else gears.places
    wanted = [gears.part(name) for name in ([member] if member is not None else gears.members)]
    made = [cad_solid(part.member, tolerance, part.figures) for part in wanted]
    return Cad(
        gears.design,
        tuple(part for part, _ in made),
        tuple(places.values()),
        {part.name: found for part, found in made},
        (*gears.warnings, *(line for part in wanted for line in part.warnings)),
    )
