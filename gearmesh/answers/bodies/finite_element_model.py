"""Finite-element models as answers: the common part of all models, and models of members without a mating gear."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import field, replace
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn, Self

from gearmesh.answers.bodies.extract import at_nominal_places
from gearmesh.answers.bodies.model_figures import CyclicFigures, MeshFigures, ModeFigures, UnloadedModelFigures
from gearmesh.answers.load.members import assumed_densities, material_of
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, figures, round_to
from gearmesh.deprecated import Deprecated
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.fe.gear_model import MeshRequest, check_sector, unloaded_model
from gearmesh.fe.model import Model
from gearmesh.figures import Content, Summary
from gearmesh.formats import JSON_SUFFIX
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian, volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.hexahedra.turned_body import core_radius
from gearmesh.records import dataclass
from gearmesh.teeth.blank.end_edge import SHARP_ENDS
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.region import CUT_REGIONS

if TYPE_CHECKING:
    import pyvista

#: largest number of natural frequencies
MAX_MODE_COUNT = 100
#: scaled Jacobian below which elements cause a warning
MIN_JACOBIAN = 0.2


@dataclass(frozen=True, repr=False)
class FiniteElementModel(Result):
    """Finite-element model, ready to be written, with its figures.

    Beside its mesh it has materials, supports, contacts and loads; files contain all of these.
    """

    #: the design
    design: Design
    #: the model
    _model: Model
    #: figures of the mesh
    measured: MeshFigures
    #: warnings, one line each
    warnings: tuple[str, ...]
    #: natural frequencies, if they were asked for
    modes: tuple[ModeFigures, ...] = field(default=(), kw_only=True)
    model = Deprecated("_model", "0.19.0", "`mesh` has nodes, elements and sets, and save() writes all of it")

    @property
    def mesh(self) -> HexMesh:
        """Nodes (mm), hexahedra and their sets."""
        return self._model.mesh

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        from gearmesh.fe import decks

        return (*dict.fromkeys(format.suffix for format in decks.formats().values()), JSON_SUFFIX)

    @property
    def headline(self) -> str:
        return f"{self.measured.elements} elements, scaled Jacobian {self.measured.min_scaled_jacobian:.3g} at least"

    @property
    def figures(self) -> Summary:
        """All figures, by their keys."""
        return Summary(self.measured, *self.cyclic)

    @property
    def cyclic(self) -> tuple[CyclicFigures, ...]:
        """Figures of the cyclic symmetry; none if the model is no sector."""
        symmetry = self._model.cyclic
        return () if symmetry is None else (CyclicFigures.of(symmetry, self.mesh),)

    @property
    def listings(self) -> list[Listing]:
        rows = [[mode.mode, round_to(mode.frequency, 3)] for mode in self.modes]
        heads = [ModeFigures.key_of("mode"), ModeFigures.key_of("frequency")]
        return [figures("Model", self.figures), *([Listing("Natural frequencies", heads, rows)] if rows else [])]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([self.measured.flat])

    @property
    def sections(self) -> Mapping[str, Content]:
        modes = {"natural_frequencies": list(self.modes)} if self.modes else {}
        return {**header(self.design), "model": self.figures, "solution": None, **modes}

    def with_frequencies(
        self,
        count: int,
        progress: Callable[[float, str], None] | None = None,
        *,
        keep: str | PathLike[str] | None = None,
    ) -> Self:
        """The model with its lowest natural frequencies by CalculiX: of one member, held as it is, without loads.

        Parameters
        ----------
        count : int
            Number of frequencies.
        progress : callable, optional
            As for `FiniteElements.solve`.
        keep : str or os.PathLike, optional
            As for `FiniteElements.solve`.

        Returns
        -------
        FiniteElementModel
            The same model; `modes` has the frequencies.

        Raises
        ------
        ArgumentError
            If the count is not from 1 to 100, for members in mesh, and for a sector.
        OutputError
            If CalculiX is not installed.
        NoSolutionError
            If CalculiX fails.

        Examples
        --------
        >>> gears.finite_elements(members=["pinion"]).with_frequencies(10).modes[0].frequency  # doctest: +SKIP
        """
        from gearmesh.fe import ccx

        refuse_mode_count(count)
        if self._model.contacts:
            raise ArgumentError("frequencies", count, must_be="left out for members in mesh; choose one member")
        if self._model.cyclic is not None:
            raise ArgumentError("frequencies", count, must_be="left out for a sector")
        found = ccx.frequencies(self._model, count, progress, keep=keep)
        return replace(self, modes=tuple(ModeFigures(k, each) for k, each in enumerate(found, 1)))

    def save(self, path: str | PathLike[str], *, timing: bool = True, program: str | None = None) -> Path:
        """Write the model (.inp, .bdf, .cdb, .k, .med with .comm), its mesh (.msh, .vtu) or its figures (.json).

        Parameters
        ----------
        path : str or os.PathLike
            The file.
        timing : bool
            Include run times in JSON.
        program : str, optional
            Program of an .inp file: "calculix" or "abaqus".

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
        >>> gears.finite_elements().save("pair.inp", program="abaqus").name
        'pair.inp'
        """
        target = Path(path)
        if target.suffix.lower() == JSON_SUFFIX:
            return super().save(target, timing=timing)
        from gearmesh.fe.decks import write_model

        write_model(self._model, target, program)
        return target

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """The mesh for PyVista.

        Returns
        -------
        pyvista.UnstructuredGrid
            Hexahedra, mm.

        Examples
        --------
        >>> gears.finite_elements().to_pyvista().n_cells > 1000
        True
        """
        import pyvista

        mesh = self.mesh
        kind = pyvista.CellType.QUADRATIC_HEXAHEDRON if mesh.second_order else pyvista.CellType.HEXAHEDRON
        return pyvista.UnstructuredGrid({kind: mesh.elements}, mesh.nodes)


@dataclass(frozen=True, repr=False)
class UnloadedFiniteElements(FiniteElementModel):
    """Model of a member without a mating gear, in its own frame: supported, but not loaded."""

    train: GearTrain

    def solve(
        self, progress: Callable[[float, str], None] | None = None, *, keep: str | PathLike[str] | None = None
    ) -> NoReturn:
        """Nothing loads the model: it cannot be solved.

        Parameters
        ----------
        progress : callable, optional
            As for `FiniteElements.solve`.
        keep : str or os.PathLike, optional
            As for `FiniteElements.solve`.

        Raises
        ------
        DesignError
            Always.

        Examples
        --------
        >>> gm.gear(18, module=2, face=10).finite_elements().solve()
        Traceback (most recent call last):
            ...
        gearmesh.errors.ArgumentError: solve = true: needs a mating gear: add the table [pinion]
        """
        raise self.train.needs_pair("solve", True)


def refuse_mode_count(count: int) -> None:
    """Raise ArgumentError for a number of natural frequencies that is not from 1 to `MAX_MODE_COUNT`."""
    if not 1 <= count <= MAX_MODE_COUNT:
        raise ArgumentError("frequencies", count, must_be=f"a number from 1 to {MAX_MODE_COUNT}")


def mesh_request_of(design: Design, members: Iterable[Member], sector: int | None = None) -> MeshRequest:
    """Return the mesh that the table fe of a design defines, for some teeth or a `sector`.

    `members` are both members of a pair, or one member without a mating gear. Raises DesignError for an even number of
    teeth, and for more teeth than any member has.
    """
    wanted, most_teeth = design.in_mm().fe, max(member.tooth.teeth for member in members)
    if wanted.teeth and wanted.teeth % 2 == 0:
        raise DesignError("fe.teeth", wanted.teeth, must_be="an odd number, or 0 for all teeth")
    if wanted.teeth > most_teeth and design.sets("fe.teeth"):
        odd = most_teeth - (most_teeth + 1) % 2
        raise DesignError("fe.teeth", wanted.teeth, must_be=f"an odd number up to {odd}, or 0 for all teeth")
    return MeshRequest(
        teeth=wanted.teeth or None,
        cells=Cells(wanted.flank, wanted.fillet, wanted.thickness, wanted.rim_layers, wanted.face),
        rim=wanted.rim,
        second_order=wanted.order == 2,
        sector=sector,
        whole=wanted.body == "whole",
        size=wanted.body_size,
    )


def mesh_figures(mesh: HexMesh) -> MeshFigures:
    """Return the figures of a mesh."""
    return MeshFigures(
        elements=len(mesh.elements),
        element_order=2 if mesh.second_order else 1,
        nodes=len(mesh.nodes),
        min_scaled_jacobian=float(scaled_jacobian(mesh.nodes, mesh.elements).min()),
        volume=float(volumes(mesh.nodes, mesh.elements).sum()),
    )


def unloaded_elements_of(
    design: Design,
    train: GearTrain,
    warnings: tuple[str, ...] = (),
    members: Sequence[str] | None = None,
    asked: Mapping[str, object] | None = None,
    sector: int | None = None,
) -> UnloadedFiniteElements:
    """Return the model of the member of a gear set without pairs, or of its `sector`.

    `asked` holds arguments that need a mating gear. Raises ArgumentError if any of them is neither None nor 0,
    DesignError for another member and for a design that cannot be modelled.
    """
    started = time.perf_counter()
    for argument, value in (asked or {}).items():
        if value:
            raise train.needs_pair(argument, value)
    (member,) = train.unpaired
    if members is not None and tuple(members) != (member.name,):
        raise ArgumentError("members", list(members), must_be=f"left out, or {member.name}")
    material = material_of(design, member.name)
    if sector is not None:
        check_sector(member, sector)
    request = mesh_request_of(design, [member], sector)
    model = unloaded_model(member, request, material, design.title)
    missing = [*omissions([member], request.whole, model), *assumed_densities(design, [member.name])]
    model = replace(model, notes=(*missing, *rims_alone(model, [member], request.whole)))
    measured = mesh_figures(model.mesh)
    model_figures = UnloadedModelFigures(**vars(measured), seconds=time.perf_counter() - started)
    noticed = (*warnings, *missing, *bad_shapes([measured]))
    return UnloadedFiniteElements(design, model, model_figures, noticed, train)


def bad_shapes(models: Iterable[MeshFigures]) -> list[str]:
    """Return the warning of models with badly shaped elements, once for all models."""
    least = min(model.min_scaled_jacobian for model in models)
    return (
        [f"the worst elements are badly shaped: their scaled Jacobian is {least:.3g}"] if least < MIN_JACOBIAN else []
    )


def rims_alone(model: Model, members: Collection[Member], whole: bool) -> list[str]:
    """Return the note in the head of a deck that names bodies modelled only up to a rim, without hub and bore."""
    sets = model.mesh.node_sets
    names = [
        name for name in (member.name for member in members) if f"{name}_rim" in sets and f"{name}_bore" not in sets
    ]
    if whole or not names:
        return []
    return [f"of the bodies the model has rims alone, without what is beyond them ({', '.join(names)})"]


def omissions(members: Collection[Member], whole: bool, model: Model | None = None) -> list[str]:
    """Return the notes on parts of the members' bodies that a model lacks, with the `whole` body or only a rim.

    `model`: the model, which has the cuts whose walls are sets of its mesh.
    """
    sets = {} if model is None else model.mesh.face_sets
    parts: dict[str, list[str]] = {}
    lines = [at_nominal_places(member) for member in members if member.index.off_place]
    turned = partial = False
    for member in members:
        web = ("web",) if member.plain_body.web is not None else ()
        regions = member.features.cut_regions
        cut = [name for name, region in regions.items() if f"{member.name}_{region.value}" in sets]
        partial = partial or bool(len(cut) < len(regions) and f"{member.name}_{CUT_REGIONS[0].value}" in sets)
        modelled_features = (*member.features.uncut.names, *cut, *web)
        turned = turned or bool(modelled_features and member.turned_body)
        for part in (*member.features.names, *web):
            if not (whole and part in modelled_features):
                parts.setdefault(part, []).append(member.name)
        if member.tooth.screw is not None and member.tooth.tip_edge is not None:
            # hexahedra of threads lie between half planes through the axis, where the drawn edge has no points
            parts.setdefault("chamfer or rounding of the tip", []).append(member.name)
        if member.tooth.blank.ends != SHARP_ENDS:
            parts.setdefault("ends of the face within chamfers or roundings", []).append(member.name)
        if whole and (core := core_radius(member.tooth, member.body)):
            parts.setdefault(f"core of {2.0 * core:.3g} mm round the axis", []).append(member.name)
    if not parts:
        return lines
    what = ", ".join(f"{part} ({', '.join(names)})" for part, names in parts.items())
    remedy = '; fe.body = "whole" has those that are turned' if turned and not whole else ""
    remedy = "; with all teeth it has those that are cut along the axis" if partial and whole else remedy
    return [f"the finite-element model has none of: {what}{remedy}", *lines]
