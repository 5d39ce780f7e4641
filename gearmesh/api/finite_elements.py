"""Finite-element models of gears in mesh, their figures, and what a solver finds of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.api.materials import materials_of
from gearmesh.api.result import Result, columns, header, times_apart
from gearmesh.api.tables import Listing, figures, flat, rounded
from gearmesh.contact.path import ARCSEC
from gearmesh.design.core import Design
from gearmesh.errors import DesignError
from gearmesh.fe.gear_model import GearModel, Request, gear_model, grid_of
from gearmesh.fe.model import Model
from gearmesh.fe.placing import focus_on, placed
from gearmesh.fe.results import ContactFigures, NodalSolution, contact_figures, largest_principal
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.rigid import Rigid
from gearmesh.mesh.hex_quality import scaled_jacobian, volumes
from gearmesh.mesh.hexahedra import Cells
from gearmesh.teeth.train import GearPair

if TYPE_CHECKING:
    import pyvista

#: elements over a half axis of the contact ellipse below which its pressure means little
RESOLVED = 3.0
#: scaled Jacobian below which elements are worth a warning
LEAST_JACOBIAN = 0.2


@dataclass(frozen=True, repr=False)
class FiniteElements(Result):
    """A pair's model, ready to be written or solved, and its figures as they are reported."""

    design: Design
    pair: GearPair
    request: Request
    built: GearModel
    figures: dict[str, Any]
    warnings: tuple[str, ...]

    @property
    def suffixes(self) -> tuple[str, ...]:
        from gearmesh.fe import decks

        return (*dict.fromkeys(each.suffix for each in decks.formats().values()), ".json")

    @property
    def headline(self) -> str:
        found = self.figures
        return f"{found['elements']} elements, scaled Jacobian {found['min_scaled_jacobian']:.3g} at least"

    @property
    def model(self) -> Model:
        """The model itself: mesh with sets, materials, supports, contacts, loads."""
        return self.built.model

    @property
    def listings(self) -> list[Listing]:
        return [figures("Model", dict(flat(self.figures)))]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([dict(flat(self.figures))])

    def document(self) -> dict[str, Any]:
        return times_apart({**header(self.design), "model": self.figures, "solution": None})

    def save(self, path: str | PathLike[str], *, timing: bool = True, program: str | None = None) -> Path:
        """Write the model (.inp, .msh, .vtu) or its figures (.json); `program` "calculix" or "abaqus" is whose .inp.

        Raises OutputError for a file that cannot be written.
        """
        target = Path(path)
        if target.suffix.lower() == ".json":
            return super().save(target, timing=timing)
        from gearmesh.fe.decks import write_model

        write_model(self.model, target, program)
        return target

    def solve(self, progress: Callable[[float, str], None] | None = None) -> FiniteElementSolution:
        """Run CalculiX on the model; contact and rotation are those of both members in mesh.

        Raises OutputError if it is not installed, NoSolutionError if it fails.
        """
        return _solve(self, progress)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The mesh for pyvista."""
        import pyvista

        mesh = self.model.mesh
        kind = pyvista.CellType.QUADRATIC_HEXAHEDRON if mesh.second_order else pyvista.CellType.HEXAHEDRON
        return pyvista.UnstructuredGrid({kind: mesh.elements}, mesh.nodes)


@dataclass(frozen=True, repr=False)
class FiniteElementSolution(Result):
    """A solver's answer, in the model's order of nodes, and its figures as they are reported."""

    problem: FiniteElements
    solution: NodalSolution
    contacts: list[ContactFigures]
    figures: dict[str, Any]

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (".json", ".png")

    @property
    def headline(self) -> str:
        peak = self.figures.get("max_pressure_mpa")
        return f"{self.problem.headline}" + ("" if peak is None else f"; pressure {peak:.5g} MPa")

    @property
    def listings(self) -> list[Listing]:
        pairs = self.figures.get("tooth_pairs", [])
        rows = [[k, *(rounded(value, 3) for value in pair.values())] for k, pair in enumerate(pairs, 1)]
        tables = [Listing("Tooth pairs", ["pair", *pairs[0]], rows)] if pairs else []
        rest = {key: value for key, value in self.figures.items() if key != "tooth_pairs"}
        return [*self.problem.listings, *tables, figures("Solution", dict(flat(rest)))]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns(self.figures.get("tooth_pairs", []))

    def document(self) -> dict[str, Any]:
        return times_apart({**header(self.problem.design), "model": self.problem.figures, "solution": self.figures})

    def _write(self, target: Path) -> None:
        _picture(self, target)


def request_of(design: Design, pair: GearPair, members: Sequence[str], rotation: float | None = None) -> Request:
    """What a design's tables fe and material ask for; `rotation` (rad) of the pinion takes the place of the torque."""
    wanted = design.in_mm().fe
    if wanted.teeth and wanted.teeth % 2 == 0:
        raise DesignError(
            f"fe.teeth = {wanted.teeth}: must be an odd number, so that one is in the middle, or 0 for all"
        )
    return Request(
        members=tuple(members),
        teeth=wanted.teeth or None,
        cells=Cells(wanted.flank, wanted.fillet, wanted.thickness, wanted.rim_layers, wanted.face),
        ellipse=wanted.ellipse,
        even=wanted.spacing == "even",
        rim=wanted.rim,
        second_order=wanted.order == 2,
        torque=1e3 * wanted.torque,
        rotation=rotation,
        materials=materials_of(design, pair),
    )


def finite_elements_of(
    design: Design,
    pair: GearPair,
    warnings: tuple[str, ...] = (),
    phi1: float = 0.0,
    members: Sequence[str] | None = None,
    rotation: float | None = None,
) -> FiniteElements:
    """The model of a pair at phi1 (rad, counted as the source counts it), of both or only some of its `members`.

    Raises DesignError for a design that cannot be modelled, NoSolutionError where no teeth touch.
    """
    started = time.perf_counter()
    request = request_of(design, pair, tuple(pair.members) if members is None else members, rotation)
    for name in request.members:
        if pair.members[name].tooth.course.drift is not None:
            raise DesignError(
                f"--member = {name}: finite-element models are of members that turn, and the {name} slides; allowed is "
                f"{' or '.join(each.name for each in pair.both if each.tooth.course.drift is None)}"
            )
    at = placed(pair, phi1, request.torque, request.materials)
    built = gear_model(pair, request, at, design.name or design.kind)
    mesh = built.model.mesh
    found = {
        "elements": len(mesh.elements),
        "nodes": len(mesh.nodes),
        "min_scaled_jacobian": float(scaled_jacobian(mesh.nodes, mesh.elements).min()),
        "volume_mm3": float(volumes(mesh.nodes, mesh.elements).sum()),
        "phi1_deg": float(np.degrees(at.turns[0])),
        "phi2_deg": float(np.degrees(at.turns[1])),
        "torque_nm": 1e-3 * request.torque,
        "normal_force_n": at.force,
        "hertz_p0_mpa": at.pressure,
        "hertz_a_mm": at.semi_major,
        "hertz_b_mm": at.semi_minor,
        "elements_over_half_axes": _resolution(pair, request, built),
        "preload_arcsec": built.preload / ARCSEC,
        "facets_gap_um": 1e3 * built.gap,
        "seconds": time.perf_counter() - started,
    }
    return FiniteElements(design, pair, request, built, found, (*warnings, *_warnings(pair, request, found)))


def _resolution(pair: GearPair, request: Request, built: GearModel) -> dict[str, dict[str, float]]:
    """Elements over half the loaded ellipse of each member, across and along the tooth."""
    if np.isnan(built.at.pressure):
        return {}
    found = {}
    for name in request.members:
        focus, grid = focus_on(pair, name, built.at), grid_of(pair, name, request, built.at)
        lines, k = grid.lines.flank, int(np.abs(grid.t - focus.t).argmin())
        across, middle = lines, focus.s
        if lines.ndim == 2:
            across, middle = lines[:, k], focus.s + focus.slope * (grid.t[k] - focus.t)
        found[name] = {
            "across": _cells(across, middle, focus.half_s),
            "along": _cells(grid.t, focus.t, focus.half_t),
        }
    return found


def _cells(places: Array, middle: float, half: float) -> float:
    """Cells between the rising `places` (K,) that half a window round the middle takes, on average of both sides."""
    low, high = np.interp([middle - half, middle + half], places, np.arange(len(places)))
    return float(0.5 * (high - low))


def _warnings(pair: GearPair, request: Request, found: dict[str, Any]) -> list[str]:
    warnings = []
    least = min((min(each.values()) for each in found["elements_over_half_axes"].values()), default=RESOLVED)
    if least < RESOLVED and len(request.members) == 2:
        warnings.append(
            f"{least:.2g} elements over a half axis of the contact ellipse do not resolve the contact pressure; "
            "fe.ellipse = 4 or more does"
        )
    if found["min_scaled_jacobian"] < LEAST_JACOBIAN:
        warnings.append(f"scaled Jacobian of {found['min_scaled_jacobian']:.3g}: the worst elements are badly shaped")
    featured = [name for name in request.members if pair.members[name].keyway or pair.members[name].hub]
    if featured:
        warnings.append(f"{' and '.join(featured)}: keyway and hub are left out of finite-element models")
    light = [name for name in request.members if pair.members[name].holes or pair.members[name].plain_body.web]
    if light:
        warnings.append(f"{' and '.join(light)}: web and holes are left out of finite-element models")
    return warnings


def _solve(problem: FiniteElements, progress: Callable[[float, str], None] | None) -> FiniteElementSolution:
    from gearmesh.fe import ccx

    started = time.perf_counter()
    solution = ccx.solve(problem.model, progress)
    back = problem.built.at.frame.inverse
    contacts = contact_figures(problem.model, solution)
    found = _contact_figures(problem, solution, contacts, back) if contacts else {}
    found |= {
        "fillets": {name: _fillet(problem.model, solution, name, back) for name in problem.request.members},
        "iterations": solution.iterations,
        "solver_seconds": time.perf_counter() - started,
    }
    return FiniteElementSolution(problem, solution, contacts, found)


def _contact_figures(
    problem: FiniteElements, solution: NodalSolution, contacts: list[ContactFigures], back: Rigid
) -> dict[str, Any]:
    reference = solution.references[f"{problem.pair.pinion.name}_held"]
    worst = int(np.argmax([each.peak_pressure for each in contacts]))
    sense = np.sign(problem.built.at.arm)
    return {
        "max_pressure_mpa": contacts[worst].peak_pressure,
        "max_pressure_point_mm": back.point(contacts[worst].place).tolist(),
        "pressure_centre_mm": back.point(contacts[worst].centre).tolist(),
        "contact_area_mm2": float(sum(each.area for each in contacts)),
        "torque_nm": 1e-3 * float(sense * reference.moment[2]),
        "rotation_arcsec": (problem.built.preload + float(sense * reference.rotation[2])) / ARCSEC,
        "tooth_pairs": [_pair_figures(each) for each in contacts],
    }


def _pair_figures(contact: ContactFigures) -> dict[str, float]:
    return {
        "force_n": float(np.linalg.norm(contact.force)),
        "peak_pressure_mpa": contact.peak_pressure,
        "area_mm2": contact.area,
    }


def _fillet(model: Model, solution: NodalSolution, member: str, back: Rigid) -> dict[str, Any]:
    """Largest tension and compression in a member's fillets, MPa, and where (fixed frame, mm)."""
    names = [name for name in model.mesh.face_sets if name.startswith(f"{member}_fillet_")]
    tension, pulled = largest_principal(model.mesh, solution, *names)
    compression, pushed = largest_principal(model.mesh, solution, *names, sense=-1.0)
    return {
        "max_tension_mpa": tension,
        "tension_point_mm": back.point(model.mesh.nodes[pulled]).tolist(),
        "max_compression_mpa": compression,
        "compression_point_mm": back.point(model.mesh.nodes[pushed]).tolist(),
    }


def _picture(solved: FiniteElementSolution, file: Path) -> None:
    """Contact pressure on the pinion and tension in both members, side by side; of one member its tension alone."""
    from matplotlib.image import imsave

    from gearmesh.io.atomic import whole_file
    from gearmesh.view.fe_views import pressure_scene, stress_scene
    from gearmesh.view.render import render

    problem = solved.problem
    scenes = (pressure_scene, stress_scene) if problem.model.contacts else (stress_scene,)
    panels = [render(scene(problem.model, solved.solution, problem.built.at)) for scene in scenes]
    with whole_file(file) as unfinished:
        imsave(unfinished, np.concatenate(panels, axis=1))
