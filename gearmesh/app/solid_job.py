"""The jobs of `solid`: a member of the pair, or the worm that grinds it, as a mesh; members as CAD solids."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.rigid import Rigid
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.systems import build, worm_part
from gearmesh.teeth.pair import GearPair, Member

if TYPE_CHECKING:
    from gearmesh.cad.step import Part


@dataclass(frozen=True)
class SolidResult:
    """A part's mesh, its measured figures, and what to know of it."""

    mesh: TriangleMesh
    figures: dict[str, Any]
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True)
class BodyResult:
    """CAD solids of one part or both members, where they stand in mesh (for both), each one's figures, and warnings."""

    parts: tuple[Part, ...]
    placements: tuple[Rigid, ...]
    figures: dict[str, dict[str, Any]]
    description: str
    warnings: tuple[str, ...]


def solid(
    design: Any, member: str, tolerance: float, teeth: int | None = None, file: Path | str | None = None
) -> SolidResult:
    """The solid of "pinion", "gear" or "worm" within `tolerance` (mm), or the open surfaces of only its first `teeth` teeth.

    Proof and count of triangles are those of the mesh as `file` will hold it, which may have single precision.
    Raises DesignError for geometry that cannot exist, and for a worm that the kind has not.
    """
    part = _part(design, member)
    found = member_solid(part.member, tolerance, teeth, file)
    return replace(found, figures=found.figures | part.figures, warnings=part.warnings)


@dataclass(frozen=True)
class _Part:
    """A member with the figures that it alone has, and its warnings."""

    member: Member
    figures: dict[str, Any]
    warnings: tuple[str, ...]


def _part(design: Any, name: str) -> _Part:
    """The pinion or gear of a design, or its worm; the pair is not built for the latter."""
    if name != "worm":
        gears = build(design)
        return _Part(gears.members[name], {}, gears.warnings)
    worm = worm_part(design)
    figures = {
        "length_mm": worm.length,
        "needed_length_mm": worm.needed,
        "least_pitch_radius_mm": worm.least_radius,
    }
    short = f"worm.length = {worm.length:g} mm: grinding the whole tooth needs {worm.needed:.6g} mm"
    return _Part(worm.member, figures, (short,) if worm.length < worm.needed else ())


def member_solid(
    member: Member, tolerance: float, teeth: int | None = None, file: Path | str | None = None
) -> SolidResult:
    """As `solid`, of a member."""
    from gearmesh import io
    from gearmesh.check.deviation import deviations
    from gearmesh.mesh.solid import gear_solid, prove, teeth_mesh
    from gearmesh.mesh.tessellate import tessellate

    started = time.perf_counter()
    tooth = tessellate(member.tooth, tolerance)
    if teeth is None or teeth == member.tooth.teeth:
        mesh = gear_solid(member, tolerance, tooth)
        seconds = time.perf_counter() - started
        written = mesh if file is None else io.stored(mesh, file)
        proof = prove(written, 1 if member.tooth.blank.bore_radius else 0)
        watertight, volume = proof.ok, proof.volume
    else:
        mesh = teeth_mesh(tooth, member.name, np.arange(teeth))
        seconds = time.perf_counter() - started
        written = mesh if file is None else io.stored(mesh, file)
        watertight, volume = False, None
    measured = max(each.largest for each in deviations(tooth).values())
    figures = {
        "triangles": len(written.triangles),
        "watertight": watertight,
        "volume_mm3": volume,
        "max_deviation_um": 1e3 * max(measured, tooth.deviation),
        "tolerance_um": 1e3 * tolerance,
        "seconds": seconds,
    }
    return SolidResult(mesh, figures)


def bodies(design: Any, member: str, tolerance: float) -> BodyResult:
    """CAD solids within `tolerance` (mm) of the exact surfaces: "pinion", "gear", "worm", or "both" gears in mesh at phi1 = 0.

    Raises DesignError as `solid`, OutputError where OpenCASCADE is missing, NoSolutionError where "both" have no contact at
    phi1 = 0.
    """
    from gearmesh.cad.step import require_occ

    require_occ()
    placements: tuple[Rigid, ...] = ()
    if member == "both":
        gears = build(design)
        placements = _in_mesh(gears)
        wanted = [_Part(each, {}, gears.warnings) for each in gears.members.values()]
    else:
        wanted = [_part(design, member)]
    parts, figures = [], {}
    for each in wanted:
        part, found = _body(each.member, tolerance)
        parts.append(part)
        figures[each.member.name] = found | each.figures
    largest = max(values["max_deviation_um"] for values in figures.values())
    description = (
        f"{getattr(design, 'name', None) or design.kind}, tooth surfaces within {largest:.3g} um of the exact ones"
    )
    return BodyResult(tuple(parts), placements, figures, description, wanted[0].warnings)


def _in_mesh(gears: GearPair) -> tuple[Rigid, Rigid]:
    """Own frames of pinion and gear to the fixed frame, at the contact of phi1 = 0."""
    path = contact_path(solver_pair(gears), np.zeros(1), gears.generation)
    if not path.touching[0]:
        raise NoSolutionError(
            "the pair has no contact at phi1 = 0, where it would be put together; write each member alone"
        )
    return gears.assembly.pinion.at(path.rotation[0]), gears.assembly.gear.at(path.phi2[0])


def _body(member: Member, tolerance: float) -> tuple[Part, dict[str, Any]]:
    from gearmesh.cad.brep import exact_volume, spline_tooth
    from gearmesh.cad.solid_part import solid_part, volume

    started = time.perf_counter()
    teeth = spline_tooth(member.tooth, tolerance)
    part = solid_part(member, teeth)
    measured = volume(part)
    figures = {
        "faces": len(part.faces),
        "volume_mm3": measured,
        "volume_error": measured / exact_volume(member) - 1.0,
        "max_deviation_um": 1e3 * max(teeth.deviation.values()),
        "tolerance_um": 1e3 * tolerance,
        "seconds": time.perf_counter() - started,
    }
    return part, figures
