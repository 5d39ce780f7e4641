"""The jobs that the command line offers, each from a validated design: what is computed, in which order, how finely.

Nothing is computed that a job does not show: contact needs no solids, a flank picture one fine tooth.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.app.solid_job import bodies as bodies
from gearmesh.app.solid_job import member_solid
from gearmesh.app.solid_job import solid as solid
from gearmesh.contact.cycle import Cycle, mesh_cycle
from gearmesh.contact.flanks import PathHertz, hertz_path, solver_pair
from gearmesh.contact.hertz import Material
from gearmesh.contact.path import ARCSEC, ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError, OutputError
from gearmesh.kernel.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.systems import build
from gearmesh.teeth.pair import GearPair, Member

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.sheet import Sheet

#: facet tolerance (mm) of the flanks that the roll test turns against each other
ROLL_TOLERANCE = 1e-4
#: lead (arcsec) at the change of teeth from which on it is worth a warning
LEAD = 0.5
#: positions at which the roll test is made, spread over those with contact inside both flanks
ROLL_POSITIONS = 3


@dataclass(frozen=True)
class TcaResult:
    """Contact path, its parameters named as in the source (one dict a position for each member), and a summary.

    `hertz` only where a torque was asked for.
    """

    path: ContactPath
    params: dict[str, list[dict[str, float]]]
    summary: dict[str, Any]
    warnings: list[str]
    cycle: Cycle | None
    hertz: PathHertz | None = None


def pair(design: Any) -> GearPair:
    """The gear pair of a design. Raises DesignError for geometry that cannot exist."""
    return build(design)


def tca(design: Any, torque: float | None = None) -> TcaResult:
    """Contact at the design's positions, and the whole mesh cycle of the trimmed flanks.

    With a `torque` (Nm) on the pinion also its Hertz contact, all load on the one pair of teeth.
    """
    gears = pair(design)
    found = _tca(gears, design)
    if torque is None:
        return found
    steel = Material(design.material.youngs_modulus, design.material.poisson_ratio)
    hertz = hertz_path(gears, found.path, torque, (steel, steel))
    peak = hertz.peak_pressure[~np.isnan(hertz.peak_pressure)]
    figures = {"torque_nm": torque, "max_pressure_mpa": float(peak.max()) if peak.size else None}
    return replace(found, hertz=hertz, summary=found.summary | figures)


def _tca(gears: GearPair, design: Any) -> TcaResult:
    wanted = design.contact.phi1
    flanks = solver_pair(gears)
    path = contact_path(flanks, np.radians(np.linspace(wanted.start, wanted.stop, wanted.count)), gears.generation)
    cycle = mesh_cycle(flanks, gears.assembly.pitch)
    te = path.te[path.touching]
    summary: dict[str, Any] = {
        "positions": len(path.phi1),
        "converged": int(path.touching.sum()),
        "te_peak_to_peak_arcsec": float(np.ptp(te)) / ARCSEC if te.size else None,
        "max_residual_mm": float(path.residual[path.touching].max()) if te.size else None,
        "seconds": path.seconds,
        "shaft_angle_deg": float(np.degrees(gears.assembly.shaft_angle)),
    }
    if cycle is not None:
        summary |= {
            "contact_ratio": cycle.contact_ratio,
            "mesh_te_peak_to_peak_arcsec": cycle.peak_to_peak / ARCSEC,
            "mesh_te_harmonics_arcsec": [float(a) / ARCSEC for a in cycle.harmonics],
            "te_breaks_phi1_deg": [float(np.degrees(each.phi1)) for each in cycle.breaks],
        }
    params = {
        "pinion": _named(gears.pinion, path.params1),
        "gear": _named(gears.gear, path.params2),
    }
    return TcaResult(
        path, params, summary, [*gears.warnings, *_contact_warnings(gears, path), *_break_warnings(cycle)], cycle
    )


def _contact_warnings(gears: GearPair, path: ContactPath) -> list[str]:
    """What to know of the figures: a lead at the change of teeth, and teeth that are not all alike."""
    warnings = []
    if any(mount.eccentricity != (0.0, 0.0) for mount in (gears.assembly.pinion, gears.assembly.gear)):
        warnings.append(
            "eccentric members: every tooth pair has another error; the mesh cycle is that of the pair at phi1 = 0"
        )
    inside = path.kind == "point"
    if inside.sum() >= 5:
        bend = gears.drive * np.polyfit(path.phi1[inside], path.te[inside], 2)[0]
        lead = bend * (0.5 * gears.assembly.pitch) ** 2 / ARCSEC
        if lead > LEAD:
            warnings.append(
                f"the transmission error bends towards a lead of {lead:.3g} arcsec at the change of teeth: "
                "they change over on edges"
            )
    return warnings


def _break_warnings(cycle: Cycle | None) -> list[str]:
    """Where the transmission error is discontinuous, one line each."""
    warnings = []
    for each in cycle.breaks if cycle else ():
        what = "begins" if each.beginning else "ends"
        size = "before the next pair's begins"
        if not np.isnan(each.jump):
            size = f"{each.jump / ARCSEC:.3g} arcsec ahead of the {'last' if each.beginning else 'next'} pair"
        warnings.append(
            f"the transmission error is discontinuous: at phi1 = {np.degrees(each.phi1):.5g} deg the surface contact of a "
            f"pair {what} {size}; edges carry there"
        )
    return warnings


def _named(member: Member, params: Array) -> list[dict[str, float]]:
    columns = member.source_parameters(params[:, 0], params[:, 1])
    return [dict(zip(columns, map(float, row), strict=True)) for row in zip(*columns.values(), strict=True)]


def check(design: Any, tolerance: float | None = None) -> dict[str, Any]:
    """Meshes of both members against the exact surfaces, and the roll test of their flanks against the solver."""
    gears = pair(design)
    tolerance = design.in_mm().mesh.tolerance if tolerance is None else tolerance
    meshes = {name: member_solid(member, tolerance).figures for name, member in gears.members.items()}
    contact = _tca(gears, design)
    return {"mesh": meshes, "roll": roll_test(gears, contact.path).rows, "warnings": contact.warnings}


@dataclass(frozen=True)
class RollTest:
    """Comparison rows of `check --json`, and the gap maps (points in the pinion's frame, gap in mm) for pictures."""

    rows: list[dict[str, Any]]
    patches: list[tuple[Array, Array]]


def roll_test(
    gears: GearPair, path: ContactPath, positions: int = ROLL_POSITIONS, tolerance: float = ROLL_TOLERANCE
) -> RollTest:
    """Roll the meshed flanks (facets within `tolerance`, mm) at some positions of a solved path and compare."""
    from gearmesh.check.roll import roll
    from gearmesh.view.on_tooth import spread

    inside = np.flatnonzero(np.isin(path.kind, ("point", "line")))
    chosen = spread(inside if inside.size else np.flatnonzero(path.touching), positions)
    pinion, gear = flank_meshes(gears, tolerance)
    contacts = roll(pinion, gear, gears.assembly, path.rotation[chosen], gears.drive, gears.delta, path.phi2[chosen])
    rows = []
    for k, found in zip(chosen, contacts, strict=True):
        is_point = bool(path.kind[k] == "point") and not found.cut_by_edge
        twist = np.degrees(np.arccos(min(1.0, abs(float(found.major @ path.major[k]))))) if is_point else None
        rows.append(
            {
                "phi1_deg": float(np.degrees(path.phi1[k])),
                "te_difference_arcsec": float(found.phi2 - path.phi2[k]) / ARCSEC,
                "a_ratio": float(found.semi_major / path.semi_major[k]) if is_point else None,
                "b_ratio": float(found.semi_minor / path.semi_minor[k]) if is_point else None,
                "angle_difference_deg": twist,
                "centre_distance_um": 1e3 * float(np.linalg.norm(found.centre_limit - path.point[k]))
                if is_point
                else None,
            }
        )
    return RollTest(rows, [(found.map_points, found.map_gap) for found in contacts if found.touching])


def flank_meshes(gears: GearPair, tolerance: float) -> tuple[TriangleMesh, TriangleMesh]:
    """The touching flanks of one tooth each, meshed within `tolerance` (mm), in the members' own frames."""
    from gearmesh.mesh.solid import teeth_mesh
    from gearmesh.mesh.tessellate import tessellate

    first, second = (
        teeth_mesh(tessellate(member.tooth, tolerance, (f"flank_{side}",)), member.name, np.array([0]))
        for member, side in zip((gears.pinion, gears.gear), gears.flanks, strict=True)
    )
    return first, second


def sheet(design: Any) -> Sheet:
    """The settings sheet of a design of a kind that has one."""
    from gearmesh.systems.spiral_bevel.sheet import settings_sheet

    return settings_sheet(design)


def settings(design: Any) -> list[dict[str, Any]]:
    """Settings that make good the assembly errors, as rows with key, values, unit and effect."""
    from gearmesh.systems.spiral_bevel.compensation import compensate

    rows = compensate(design, _changed)
    return [
        {"key": s.key, "value_before": s.before, "value_after": s.after, "unit": s.unit, "effect": s.effect}
        for s in rows
    ]


def apply_settings(design: Any, values: dict[str, Any]) -> dict[str, Any]:
    """The resolved design with other values of some (dotted) keys."""
    return _changed(design, values).resolved()


def _changed(design: Any, values: dict[str, Any]) -> Any:
    from gearmesh.design import parse

    mapping = design.resolved()
    for key, value in values.items():
        *tables, name = key.split(".")
        table = mapping
        for part in tables:
            table = table[part]
        table[name] = value
    return parse(mapping)


def render(design: Any, path: Path | str, size: tuple[int, int] = (1600, 1200)) -> None:
    """A picture of the pinion's tooth with path of contact and ellipses.

    Raises OutputError naming the missing system package where there is no OpenGL.
    """
    from gearmesh.view import pictures
    from gearmesh.view.opengl import missing_opengl_message

    missing = missing_opengl_message()
    if missing:
        raise OutputError(missing)
    gears = pair(design)
    pictures.member(gears, "pinion", _tca(gears, design).path, path, size)


def run(design: Any, folder: Path | str, tolerance: float, progress: Callable[[float, str], None]) -> dict[str, Any]:
    """The main job: solids, contact, roll test, plots and pictures into `folder`; returns what was found and written."""
    from gearmesh import io
    from gearmesh.app import report
    from gearmesh.view import pictures
    from gearmesh.view.opengl import missing_opengl_message

    folder = Path(folder)
    gears = pair(design)
    files: list[Path] = []

    def wrote(name: str) -> Path:
        files.append(folder / name)
        return folder / name

    progress(0.05, "tooth contact")
    contact = _tca(gears, design)
    if not contact.path.touching.any():
        raise NoSolutionError(
            "contact.phi1: no position in this range has contact; reduce the range or the assembly errors"
        )
    io.whole_text(wrote("contact.json"), report.json_text(report.tca_document(design, contact)))
    io.whole_text(wrote("contact.csv"), report.tca_csv(contact))
    solids = {}
    for k, (name, member) in enumerate(gears.members.items()):
        progress(0.15 + 0.15 * k, f"solid of the {name}")
        file = wrote(f"{name}.stl")
        solids[name] = member_solid(member, tolerance, file=file)
        io.write(solids[name].mesh, file)
    placed = pictures.in_mesh(gears, {name: s.mesh for name, s in solids.items()}, contact.path)
    io.write_scene(placed, wrote("pair.vtm"))
    progress(0.45, "roll test")
    rolled = roll_test(gears, contact.path)
    result = {
        "mesh": {name: s.figures for name, s in solids.items()},
        "contact": contact.summary,
        "roll": rolled.rows,
        "warnings": contact.warnings,
    }
    io.whole_text(wrote("report.json"), report.json_text(report.check_document(design, result)))
    progress(0.6, "plots")
    pictures.plots(gears, contact.path, contact.cycle, wrote("transmission_error.png"), wrote("path_of_contact.png"))
    skipped = missing_opengl_message()
    if skipped is None:
        progress(0.7, "pictures")
        meshes = {name: s.mesh for name, s in solids.items()}
        files += pictures.all_pictures(gears, contact.path, rolled.patches, meshes, folder)
    progress(1.0, "done")
    return {**result, "files": files, "skipped": skipped}
