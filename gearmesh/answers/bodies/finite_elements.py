"""Finite-element models of gears in mesh, their figures, and the results of a solver."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.bodies.finite_element_model import (
    FiniteElementModel,
    bad_shapes,
    mesh_figures,
    mesh_request_of,
    omissions,
    rims_alone,
)
from gearmesh.answers.bodies.model_figures import (
    DeckFigures,
    HalfAxes,
    ModelFigures,
    Resolution,
    SolutionFigures,
    SolvedContact,
    SolvedFillets,
    SolvedToothPair,
)
from gearmesh.answers.load.members import assumed_densities, materials_of
from gearmesh.answers.result import Result, RunTime, columns, header
from gearmesh.answers.tables import Listing, cell, figures, round_to
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, OutputError
from gearmesh.fe.gear_model import (
    ELEMENTS_PER_SEMI_AXIS,
    MAX_SAG_RATIO,
    GearModel,
    Request,
    check_sector,
    gear_model,
    grid_of,
)
from gearmesh.fe.model import Model
from gearmesh.fe.placing import PlacedPair, focus_on, major_axis, minor_axis, place
from gearmesh.fe.results import ContactFigures, NodalSolution, contact_figures, largest_principal
from gearmesh.figures import Content, Entry, Summary
from gearmesh.formats import JSON_SUFFIX, VTU_SUFFIX
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.progress import part
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: programs for which decks are written
DECK_PROGRAMS = ("calculix", "abaqus")
#: limit of the elements of a model whose default numbers of lines are raised to resolve the contact pressure
MAX_DEFAULT_ELEMENTS = 150_000
#: distance from the centre of the ellipse, in semi-axes, beyond which a pressure is not its peak
RIM_SEMI_AXES = 0.9
#: largest rotation of the pinion for which a linear solution is meaningful
MAX_ROTATION_DEG = 1.0
#: largest coefficient of friction for which a solution is meaningful
MAX_FRICTION = 1.0
#: keys of the table fe for the spacing of lines near the contact
LINE_KEYS = frozenset({"flank", "thickness", "face"})


@dataclass(frozen=True, repr=False)
class FiniteElements(FiniteElementModel):
    """Model of a pair, ready to be written or solved, with its figures."""

    #: figures of the model
    measured: ModelFigures
    #: the pair
    pair: GearPair
    #: request from which the model was built
    _request: Request
    #: the built model, with positions of the gears
    _built: GearModel

    @property
    def coarse(self) -> str:
        """Reason why the model does not resolve the contact pressure of the leading teeth; empty if it does."""
        return self.measured.coarse

    def solve(
        self, progress: Callable[[float, str], None] | None = None, *, keep: str | PathLike[str] | None = None
    ) -> FiniteElementSolution:
        """Solution of the model by CalculiX; contact and rotation belong to both members in mesh.

        Parameters
        ----------
        progress : callable, optional
            Called with the finished share of the work (0 to 1) and its current step.
        keep : str or os.PathLike, optional
            Folder for the deck and the files of CalculiX (model.inp, .frd, .dat and others), also if it fails.

        Returns
        -------
        FiniteElementSolution
            Rotation under load, contact pressure, stresses.

        Raises
        ------
        OutputError
            If CalculiX is not installed.
        NoSolutionError
            If CalculiX fails.

        Examples
        --------
        >>> gears.finite_elements().solve().headline  # doctest: +SKIP
        """
        return _solve(self, progress, keep)


@dataclass(frozen=True, repr=False)
class FiniteElementSolution(Result):
    """Solution of a model, in the order of its nodes, with its figures."""

    #: the model
    problem: FiniteElements
    #: displacements and stresses of the nodes
    solution: NodalSolution
    #: contact of each tooth pair
    contacts: list[ContactFigures]
    #: figures of the solution
    measured: SolutionFigures

    @property
    def figures(self) -> Summary:
        """All figures, by their keys."""
        return Summary(self.measured)

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return VTU_SUFFIX, JSON_SUFFIX

    def save(self, path: str | PathLike[str], *, timing: bool = True) -> Path:
        """Write the mesh, its sets and the results (.vtu), or the figures (.json).

        A .vtu has displacements, stresses and contact pressures at the nodes, and stresses at the integration points
        as arrays of the elements.

        Parameters
        ----------
        path : str or os.PathLike
            The file.
        timing : bool
            Include run times in JSON.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        OutputError
            If the file cannot be written.

        Examples
        --------
        >>> gears.finite_elements().solve().save("result.vtu")  # doctest: +SKIP
        """
        target = Path(path)
        if target.suffix.lower() != VTU_SUFFIX:
            return super().save(target, timing=timing)
        from gearmesh.fe.decks.vtu import write_mesh

        model, solution = self.problem._model, self.solution
        write_mesh(model.mesh, target, solution.nodal_fields, model.note_lines, solution.element_fields)
        return target

    @property
    def headline(self) -> str:
        contact = self.measured.contact
        if contact is None:
            return self.problem.headline
        largest = f"pressure {contact.max_pressure:.5g} MPa{self._reserve}"
        by_hertz = self.problem.measured.hertz_p0
        if self.reserve and not math.isnan(by_hertz):
            largest = (
                f"pressure by Hertz {by_hertz:.5g} MPa, of the elements {contact.max_pressure:.5g} MPa{self._reserve}"
            )
        return f"{self.problem.headline}; {largest}"

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the model and of its solution, one line each."""
        contact = self.measured.contact
        if contact is None or contact.rotation >= 0.0:
            return self.problem.warnings
        return (
            *self.problem.warnings,
            f"the load turns the pinion back by {-contact.rotation:.3g} arcsec: facets of the model touch where the exact surfaces "
            "do not; more lines (fe.flank, fe.fillet) keep them apart",
        )

    @property
    def reserve(self) -> str:
        """Reason why the largest pressure is unreliable; empty if it is reliable."""
        if self.measured.contact is None or self.measured.contact.pressure_resolved:
            return ""
        if self.problem.coarse:
            return f"unresolved: {self.problem.coarse}"
        peaks = [pair.peak_pressure for pair in self._tooth_pairs]
        if self.problem._request.even or np.argmax(peaks) == _leading(self.problem):
            return "unresolved: at the rim of the ellipse, where lines are coarser"
        return "unresolved: not on the leading tooth pair, where the mesh is fine"

    @property
    def _reserve(self) -> str:
        return self.reserve and f" ({self.reserve})"

    @property
    def listings(self) -> list[Listing]:
        pairs = [pair.row for pair in self._tooth_pairs]
        rows = [[k, *(round_to(value, 3) for value in pair.values())] for k, pair in enumerate(pairs, 1)]
        tables = [Listing("Tooth pairs", ["pair", *pairs[0]], rows)] if pairs else []
        return [
            *self.problem.listings,
            *tables,
            figures("Solution", Summary(self._solution_entries)),
        ]

    @property
    def _solution_entries(self) -> list[Entry]:
        """Figures for a table; a pressure that is not resolved stands last, with the reason."""
        entries = [self._with_reserve(entry) for entry in self.figures.entries]
        peak = SolvedContact.key_of("max_pressure")
        return sorted(entries, key=lambda entry: entry.key == peak and bool(self.reserve))

    def _with_reserve(self, entry: Entry) -> Entry:
        """Return a figure for a table, with the reason appended to an unresolved pressure."""
        peak = entry.key == SolvedContact.key_of("max_pressure")
        return replace(entry, value=f"{cell(entry.value)}{self._reserve}") if peak and self.reserve else entry

    @property
    def _tooth_pairs(self) -> list[SolvedToothPair]:
        return [] if self.measured.contact is None else self.measured.contact.tooth_pairs

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([pair.row for pair in self._tooth_pairs])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.problem.design), "model": self.problem.figures, "solution": self.measured}


@dataclass(frozen=True, repr=False)
class FiniteElementDecks(Result):
    """Decks of a pair at several positions, written into a folder."""

    #: the design
    design: Design
    #: the folder
    folder: Path
    #: figures of each deck
    rows: list[DeckFigures]
    #: warnings, one line each
    warnings: tuple[str, ...]

    @property
    def headline(self) -> str:
        return f"{len(self.rows)} decks in {self.folder}"

    @property
    def listings(self) -> list[Listing]:
        rows = [
            [
                row.deck,
                *(round_to(value, 3) for value in (model.phi1, model.elements, model.min_scaled_jacobian)),
                *(round_to(value, 3) for value in (model.normal_force, model.hertz_p0)),
                "yes" if row.pressure_resolved else "no",
            ]
            for row, model in ((row, row.model) for row in self.rows)
        ]
        heads = map(ModelFigures.key_of, ("phi1", "elements", "min_scaled_jacobian", "normal_force", "hertz_p0"))
        return [Listing("Models", ["deck", *heads, "resolved"], rows)]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.flat for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "positions": self.rows}

    @property
    def run_time(self) -> RunTime:
        """Run time of all decks."""
        return RunTime(sum(row.model.seconds for row in self.rows))


def refuse_turn_and_friction(rotation: float | None, friction: float) -> None:
    """Raise ArgumentError for a rotation (deg) or a coefficient of friction without a meaningful linear solution."""
    if rotation is not None and not 0.0 < rotation <= MAX_ROTATION_DEG:
        raise ArgumentError("rotation", rotation, must_be=f"above 0 and up to {MAX_ROTATION_DEG:g} deg")
    if not 0.0 <= friction <= MAX_FRICTION:
        raise ArgumentError("friction", friction, must_be=f"a coefficient from 0 to {MAX_FRICTION:g}")


def request_of(
    design: Design,
    pair: GearPair,
    members: Sequence[str],
    rotation: float | None = None,
    friction: float = 0.0,
    sector: int | None = None,
) -> Request:
    """Return the model that the tables fe and material of a design define; `rotation` (rad) of the pinion replaces the
    torque.

    Raises an error for an even or too large number of teeth, for members that the pair does not have, for `friction` of
    one member, and for an impossible `sector`.
    """
    mesh_request, wanted = mesh_request_of(design, pair.members.values(), sector), design.in_mm().fe
    unknown = [name for name in members if name not in pair.members]
    if unknown or not members:
        raise ArgumentError("members", unknown[0] if unknown else [], must_be=f"members of the pair {pair.name}")
    if sector is not None:
        if len(members) > 1:
            raise ArgumentError("sector", sector, must_be="left out for members in mesh; choose one of them")
        check_sector(pair.members[members[0]], sector)
    if friction and len(members) == 1:
        raise ArgumentError("friction", friction, must_be="left out for one member alone, which has no contact")
    return Request(
        **vars(mesh_request),
        members=tuple(members),
        ellipse=wanted.ellipse,
        even=wanted.spacing == "even",
        torque=1e3 * wanted.torque,
        rotation=rotation,
        friction=friction,
        resolved=len(members) > 1 and wanted.ellipse == 0 and not LINE_KEYS & wanted.model_fields_set,
        materials=materials_of(design, pair),
    )


def finite_elements_of(
    design: Design,
    pair: GearPair,
    warnings: tuple[str, ...] = (),
    phi1: float = 0.0,
    members: Sequence[str] | None = None,
    rotation: float | None = None,
    friction: float = 0.0,
    sector: int | None = None,
) -> FiniteElements:
    """Return the model of a pair at phi1 (rad, counted as in the source), of both or only some `members`, or of a
    `sector`.

    Raises DesignError for a design that cannot be modelled, and NoSolutionError if no teeth touch.
    """
    request = _request(design, pair, members, rotation, friction, sector)
    with part(0.0, 0.3):
        placed_pair = place(pair, phi1, request.torque, request.materials)
    with part(0.3, 1.0):
        model = _make(design, request, placed_pair)
    missing = _missing_parts(design, pair, request, model._model)
    return replace(model, warnings=(*warnings, *missing, *_warnings(request, [model.measured])))


def finite_element_decks_of(
    design: Design,
    pair: GearPair,
    folder: Path,
    phi1: Sequence[float],
    warnings: tuple[str, ...] = (),
    members: Sequence[str] | None = None,
    rotation: float | None = None,
    friction: float = 0.0,
    program: str | None = None,
    *,
    progress: Callable[[float, str], None],
) -> FiniteElementDecks:
    """Write decks of a pair at several phi1 (rad) into a folder, with a script that solves them in order.

    The folder is made if needed. Raises the errors of `finite_elements_of` before anything is written, and OutputError
    for a folder that cannot be made.
    """
    from gearmesh.io.atomic import whole_text

    if program not in (None, *DECK_PROGRAMS):
        raise ArgumentError("program", program, must_be=f"{' or '.join(DECK_PROGRAMS)}")
    request = _request(design, pair, members, rotation, friction)
    places = [place(pair, angle, request.torque, request.materials) for angle in phi1]
    jobs = [f"position_{k:0{len(str(len(places)))}d}" for k in range(1, len(places) + 1)]
    models, missing = [], list[str]()
    for k, (job, at) in enumerate(zip(jobs, places, strict=True)):
        progress(k / len(jobs), f"{job}.inp")
        made = _make(design, request, at)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError("cannot make the folder", folder, reason=error.strerror or str(error)) from None
        made.save(folder / f"{job}.inp", program=program)
        missing = _missing_parts(design, pair, request, made._model)
        models.append(made.measured)
    script = folder / "run.sh"
    whole_text(script, _script(jobs, program))
    script.chmod(0o755)
    rows = [
        DeckFigures(f"{job}.inp", float(np.degrees(asked)), not model.coarse, model)
        for job, asked, model in zip(jobs, phi1, models, strict=True)
    ]
    return FiniteElementDecks(design, folder, rows, (*warnings, *missing, *_warnings(request, models)))


def _script(jobs: Sequence[str], program: str | None) -> str:
    """Return a shell script that runs the jobs in its folder one after the other, and stops at the first that fails."""
    run = (
        'abaqus job="$job" input="$job.inp" interactive' if program == "abaqus" else '"${GEARMESH_CCX:-ccx}" -i "$job"'
    )
    return (
        '#!/bin/sh\n# Solves the positions in their order; results are written beside the decks.\nset -e\ncd "$(dirname "$0")"\n'
        f"for job in {' '.join(jobs)}; do\n    {run}\ndone\n"
    )


def _request(
    design: Design,
    pair: GearPair,
    members: Sequence[str] | None,
    rotation: float | None,
    friction: float,
    sector: int | None = None,
) -> Request:
    return request_of(design, pair, tuple(pair.members) if members is None else members, rotation, friction, sector)


def _make(design: Design, request: Request, at: PlacedPair) -> FiniteElements:
    """Return the model of a placed pair, without warnings."""
    started, pair = time.perf_counter(), at.pair
    # the default spacing is refined until it resolves the contact pressure
    with part(0.0, 0.5 if request.resolved else 0.9):
        built, elements_to_resolve = gear_model(request, at, design.title), None
    # if this takes too many elements, build the model with the plain default spacing and report the number
    if request.resolved and len(built.model.mesh.elements) > MAX_DEFAULT_ELEMENTS:
        elements_to_resolve, request = len(built.model.mesh.elements), replace(request, resolved=False)
        with part(0.5, 0.9):
            built = gear_model(request, at, design.title)
    figures = ModelFigures(
        **vars(mesh_figures(built.model.mesh)),
        phi1=float(np.degrees(at.turns[0])),
        phi2=float(np.degrees(at.turns[1])),
        torque=1e-3 * request.torque,
        friction=request.friction,
        normal_force=at.force,
        hertz_p0=at.pressure,
        hertz_a=at.semi_major,
        hertz_b=at.semi_minor,
        resolution=_resolution(request, built),
        elements_to_resolve=elements_to_resolve,
        preload=built.preload / ARCSEC,
        facets_gap=1e3 * built.gap,
        seconds=time.perf_counter() - started,
    )
    members = [pair.members[name] for name in request.members]
    notes = (*_missing_parts(design, pair, request, built.model), *rims_alone(built.model, members, request.whole))
    built = replace(built, model=replace(built.model, notes=notes))
    return FiniteElements(design, built.model, figures, (), pair, request, built)


def _resolution(request: Request, built: GearModel) -> Resolution:
    """Return the numbers of elements over the loaded ellipse of each member, and the deviation of element edges along
    it.

    The numbers are elements over each semi-axis, across and along the tooth, and layers over the smaller semi-axis into
    it. The deviation of the edges from the flank is relative to the elastic approach.
    """
    half_axes: dict[str, HalfAxes] = {}
    inwards: dict[str, float] = {}
    if np.isnan(built.at.pressure):
        return Resolution(half_axes, inwards, None)
    sags = []
    for name in request.members:
        focus, grid = focus_on(name, built.at), grid_of(name, request, built.at)
        lines, k = grid.lines.flank, int(np.abs(grid.t - focus.t).argmin())
        across, middle = lines, focus.s
        if lines.ndim == 2:
            across, middle = lines[:, k], focus.s + focus.slope * (grid.t[k] - focus.t)
        half_axes[name] = HalfAxes(_cells(across, middle, focus.half_s), _cells(grid.t, focus.t, focus.half_t))
        layers = grid.lines.thickness
        inwards[name] = float(np.interp(focus.half_depth, layers, np.arange(len(layers))))
        cell = float(np.diff(grid.t)[min(k, len(grid.t) - 2)])
        sags.append(focus.bow * cell**2 / 8.0 / built.at.approach)
    return Resolution(half_axes, inwards, max(sags))


def _cells(places: Array, middle: float, half: float) -> float:
    """Return the cells between rising `places` (K,) in half a window about the middle, the mean of both sides."""
    low, high = np.interp([middle - half, middle + half], places, np.arange(len(places)))
    return float(0.5 * (high - low))


def _warnings(request: Request, models: Sequence[ModelFigures]) -> list[str]:
    """Return the warnings of models of a pair at one or several positions, once each."""
    warnings = []
    unresolved = [model for model in models if model.coarse] if len(request.members) == 2 else []
    if unresolved:
        places = f" (at {len(unresolved)} of {len(models)} positions)" if len(models) > 1 else ""
        warnings.append(
            f"the model does not resolve the contact pressure{places}: {unresolved[0].coarse}{_remedy(unresolved[0])}"
        )
    return [*warnings, *bad_shapes(models)]


def _missing_parts(design: Design, pair: GearPair, request: Request, model: Model) -> list[str]:
    """Return the notes on parts of the bodies that a model lacks, and on densities that the design does not give."""
    missing = omissions([pair.members[name] for name in request.members], request.whole, model)
    return [*missing, *assumed_densities(design, request.members)]


def _remedy(figures: ModelFigures) -> str:
    """Return the value of fe.ellipse that resolves the pressure, in words, from the deviation of the element edges."""
    sag, over = figures.resolution.sag, figures.resolution.over
    if sag is None:
        return ""
    needed = math.ceil(ELEMENTS_PER_SEMI_AXIS / figures.element_order)
    if figures.element_order == 1:
        needed = max(
            needed, math.ceil(max(half_axes.along for half_axes in over.values()) * math.sqrt(sag / MAX_SAG_RATIO))
        )
    more = figures.elements_to_resolve
    return f"; fe.ellipse = {needed} resolves it" + (
        f", and so do {more} elements with the default spacing" if more else ""
    )


def _solve(
    problem: FiniteElements, progress: Callable[[float, str], None] | None, keep: str | PathLike[str] | None
) -> FiniteElementSolution:
    from gearmesh.fe import ccx

    started = time.perf_counter()
    solution = ccx.solve(problem._model, progress, keep=keep)
    to_fixed = problem._built.at.frame.inverse
    contacts = contact_figures(problem._model, solution)
    figures = SolutionFigures(
        contact=_contact_figures(problem, solution, contacts, to_fixed) if contacts else None,
        fillets={name: _fillet(problem._model, solution, name, to_fixed) for name in problem._request.members},
        iterations=solution.iterations,
        seconds=time.perf_counter() - started,
    )
    return FiniteElementSolution(problem, solution, contacts, figures)


def _contact_figures(
    problem: FiniteElements, solution: NodalSolution, contacts: list[ContactFigures], to_fixed: Rigid
) -> SolvedContact:
    reference = solution.references[f"{problem.pair.pinion.name}_held"]
    worst = int(np.argmax([contact.peak_pressure for contact in contacts]))
    # lines are fine about the leading tooth pair; evenly spaced lines are equal everywhere
    leading = worst if problem._request.even else _leading(problem)
    sense = np.sign(problem._built.at.arm)
    highest = to_fixed.point(contacts[worst].place).tolist()
    return SolvedContact(
        max_pressure=contacts[worst].peak_pressure,
        pressure_resolved=worst == leading and not problem.coarse and not _at_rim(problem, highest),
        max_pressure_point=highest,
        pressure_centre=to_fixed.point(contacts[worst].centre).tolist(),
        contact_area=float(sum(contact.area for contact in contacts)),
        torque=1e-3 * float(sense * reference.moment[2]),
        rotation=(problem._built.preload + float(sense * reference.rotation[2])) / ARCSEC,
        tooth_pairs=[_pair_figures(contact) for contact in contacts],
    )


def _at_rim(problem: FiniteElements, place: list[float]) -> bool:
    """Return True if a place (mm, fixed frame) is at the rim of a pressure ellipse; False for lines and edges."""
    at = problem._built.at
    if np.isnan(at.pressure) or at.path.lines[0] is not None:
        return False
    offset = np.array(place) - at.path.point[0]
    return bool(
        np.hypot(offset @ major_axis(at.path) / at.semi_major, offset @ minor_axis(at.path) / at.semi_minor)
        > RIM_SEMI_AXES
    )


def _leading(problem: FiniteElements) -> int:
    """Return the index of the contact of the leading tooth pair, which is nearest to the place of contact."""
    mesh, place = problem.mesh, problem._built.at.frame.point(problem._built.at.path.point[0])
    distances = [
        np.linalg.norm(mesh.nodes[mesh.face_nodes(contact.slave)] - place, axis=-1).min()
        for contact in problem._model.contacts
    ]
    return int(np.argmin(distances))


def _pair_figures(contact: ContactFigures) -> SolvedToothPair:
    return SolvedToothPair(float(np.linalg.norm(contact.force)), contact.peak_pressure, contact.area)


def _fillet(model: Model, solution: NodalSolution, member: str, to_fixed: Rigid) -> SolvedFillets:
    """Return the largest tension and compression in a member's fillets, MPa, and their positions (fixed frame, mm)."""
    names = [name for name in model.mesh.face_sets if name.startswith(f"{member}_fillet_")]
    tension, pulled = largest_principal(model.mesh, solution, *names)
    compression, pushed = largest_principal(model.mesh, solution, *names, sense=-1.0)
    return SolvedFillets(
        max_tension=tension,
        tension_point=to_fixed.point(model.mesh.nodes[pulled]).tolist(),
        max_compression=compression,
        compression_point=to_fixed.point(model.mesh.nodes[pushed]).tolist(),
    )
