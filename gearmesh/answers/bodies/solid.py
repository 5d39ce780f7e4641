"""Solids: one member as a watertight mesh, several members in mesh, and open surfaces of a few teeth."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.answers.bodies.extract import WHOLE_MEMBER, Extract, ExtractMesh
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, StatedDesign, columns, header
from gearmesh.answers.tables import Listing, figures
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import JSON_SUFFIX
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.mesh.triangles import Facets, TriangleMesh
from gearmesh.progress import in_turn, tell
from gearmesh.teeth.carried_body import CarriedBody
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region

if TYPE_CHECKING:
    import build123d
    import cadquery
    import manifold3d
    import pyvista
    import trimesh

    from gearmesh.cad.step import Part
    from gearmesh.mesh.tessellate import ToothMesh

#: factors of the tolerance for the next meshes, beside the ratio that the bound suggests, until one is within the
#: tolerance: rows of facets are whole, so that a slightly smaller tolerance may not change the bound
TOLERANCE_FACTORS = (0.99, 0.95, 0.8)
#: smallest reduction of the tolerance at once: a bound that is loose at one place must not cause a mesh that fills the
#: memory
MIN_TOLERANCE_FACTOR = 0.3
#: share of the tolerance above which the rounding of the file, not the mesh, is the cause of a large deviation
MAX_ROUNDING_SHARE = 0.5


#: tolerance in modules above which it was probably meant in another unit
SUSPICIOUS_TOLERANCE_MODULES = 0.1
#: names for all members in mesh, where a member could be named
ALL_MEMBERS_NAMES = ("both", "all")


@dataclass(frozen=True)
class SolidFigures(Figures):
    """A mesh of one member, as it was measured and proved."""

    triangles: int = figure("triangles of the mesh", whole=True)
    watertight: bool = figure("whether the mesh is closed, without defects and of the right genus")
    volume: float | None = figure("volume of the mesh; none of the surfaces of a few teeth", "mm3", "V")
    max_deviation: float = figure(
        "bound of the distance between the mesh and the exact surfaces, rounding of the file included", "um"
    )
    sampled_deviation: float = figure("largest distance measured between the mesh and the exact surfaces", "um")
    tolerance: float = figure("largest distance that was allowed", "um")
    seconds: float = figure("run time of the mesher", "s", timing=True)
    offset: float | None = figure(
        "distance of the tooth surfaces from those of the design, positive away from the material",
        "mm",
        optional=True,
        default=None,
    )


@dataclass(frozen=True, repr=False)
class Solid(Result):
    """One part as a triangle mesh (mm, in its own frame), with its measured figures."""

    #: the design
    design: Design
    #: triangles of the mesh; `mesh` has them as arrays
    facets: Facets
    #: figures that were measured and proved
    measured: SolidFigures
    #: warnings, one line each
    warnings: tuple[str, ...] = ()
    #: True for surfaces of a few teeth or of flanks, which cannot be watertight
    open: bool = False
    #: further figures, for example those of a worm
    own: Summary = field(default_factory=Summary)
    #: the member, if the mesh is all of it
    member: Member | None = None
    #: transformation from the member's own frame to the frame of the mesh
    place: Rigid = field(default_factory=Rigid.identity)
    #: meshes of the different teeth of a whole member, which pictures use again
    teeth: tuple[ToothMesh, ...] = field(default=(), repr=False, compare=False)
    #: a suffix, and the triangles as files with this suffix hold them
    in_file: tuple[str, Facets] | None = field(default=None, repr=False, compare=False)
    #: True if the mesh is the blank of the member
    blank: bool = False

    @cached_property
    def mesh(self) -> TriangleMesh:
        """The triangles, with vertices, regions and normals as arrays."""
        return self.facets.whole()

    @property
    def figures(self) -> Summary:
        """All figures, by their keys."""
        return Summary(self.measured, self.own)

    @property
    def name(self) -> str:
        """Name of the part."""
        return self.facets.name

    @property
    def suffixes(self) -> tuple[str, ...]:
        from gearmesh import io

        return (*io.formats(), JSON_SUFFIX)

    @property
    def headline(self) -> str:
        watertight = "" if self.open else ", watertight" if self.measured.watertight else ", not watertight"
        figures = self.measured
        return f"{self.name}, {figures.triangles} triangles within {figures.max_deviation:.2g} um{watertight}"

    @property
    def complaints(self) -> list[str]:
        """Faults of the mesh, one line each."""
        lines = []
        if not self.open and not self.measured.watertight:
            lines.append(f"the mesh of the {self.name} is not watertight")
        if self.measured.max_deviation > self.measured.tolerance:
            lines.append(
                f"the mesh of the {self.name} is {self.measured.max_deviation:.4g} um from the exact surface, more than"
                f" the tolerance of {self.measured.tolerance:.4g} um"
            )
        return lines

    @property
    def listings(self) -> list[Listing]:
        return [figures("", self.figures)]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([{"part": self.name, **self.figures}])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "mesh": {self.name: self.figures}, "warnings": self.warnings}

    def move(self, place: Rigid) -> Solid:
        """The solid in another frame.

        Parameters
        ----------
        place : Rigid
            Transformation from the present frame to the other.

        Returns
        -------
        Solid
            With the same figures.

        Examples
        --------
        >>> moved = gears.solid("gear", 0.05).move(gears.places["gear"])
        """
        return replace(self, facets=self.facets.move(place), place=place @ self.place, in_file=None)

    def to_pyvista(self) -> pyvista.PolyData:
        """The mesh for PyVista.

        Returns
        -------
        pyvista.PolyData
            Triangles, mm, with regions and exact normals as cell data.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).to_pyvista().is_manifold
        True
        """
        return mesh_to_pyvista(self.mesh)

    def to_trimesh(self) -> trimesh.Trimesh:
        """The mesh for trimesh.

        Returns
        -------
        trimesh.Trimesh
            Triangles, mm.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).to_trimesh().is_watertight
        True
        """
        import trimesh

        return trimesh.Trimesh(self.mesh.vertices, self.mesh.triangles, process=False)

    def to_manifold(self) -> manifold3d.Manifold:
        """The mesh for manifold3d, with coordinates to the last digit.

        Returns
        -------
        manifold3d.Manifold
            A body, mm.

        Raises
        ------
        DesignError
            For open surfaces.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).to_manifold().genus()
        1
        """
        from gearmesh.mesh.solid import manifold_of

        if self.open:
            raise DesignError(self.name, reason="open surfaces are no body")
        return manifold_of(self.mesh.vertices, {0: self.mesh.triangles})

    def to_build123d(self) -> build123d.Solid:
        """The CAD solid of the member for build123d, with spline faces within the mesh's tolerance, not triangles.

        Returns
        -------
        build123d.Solid
            In the same frame, mm.

        Raises
        ------
        DesignError
            If the mesh is no whole member.
        OutputError
            If build123d is missing.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).to_build123d().is_valid
        True
        """
        from gearmesh.cad.programs.shapes import build123d_shape, require_build123d

        require_build123d()
        return build123d_shape(self._part())

    def to_cadquery(self) -> cadquery.Workplane:
        """The CAD solid of the member for CadQuery, with spline faces within the mesh's tolerance, not triangles.

        Returns
        -------
        cadquery.Workplane
            The faces of each region are tagged by its name.

        Raises
        ------
        DesignError
            If the mesh is no whole member.
        OutputError
            If CadQuery is missing.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).to_cadquery().faces().size()  # doctest: +SKIP
        """
        from gearmesh.cad.programs.shapes import cadquery_shape, require_cadquery

        require_cadquery()
        return cadquery_shape(self._part())

    def _part(self) -> Part:
        """Return the CAD solid of the meshed member, in the frame of the mesh."""
        from gearmesh.answers.bodies.cad import cad_blank, cad_solid

        if self.member is None:
            raise DesignError(self.name, reason="only whole members have a CAD solid")
        part, _ = (cad_blank if self.blank else cad_solid)(self.member, 1e-3 * self.measured.tolerance)
        return part.move(self.place)

    def _write(self, target: Path) -> None:
        from gearmesh import io

        if self.in_file is not None and self.in_file[0] == target.suffix.lower():
            io.write(self.in_file[1], target, as_in_file=True)
        else:
            io.write(self.facets, target)


@dataclass(frozen=True, repr=False)
class Solids(Result):
    """Several members as triangle meshes, in mesh (fixed frame, mm)."""

    design: StatedDesign
    parts: dict[str, Solid]
    warnings: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        from gearmesh import io

        return (*io.formats(several=True), JSON_SUFFIX)

    @property
    def headline(self) -> str:
        return "; ".join(part.headline for part in self.parts.values())

    @property
    def complaints(self) -> list[str]:
        """Faults of the meshes, one line each."""
        return [line for part in self.parts.values() for line in part.complaints]

    @property
    def listings(self) -> list[Listing]:
        return [figures(name, part.figures) for name, part in self.parts.items()]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([{"part": name, **part.figures} for name, part in self.parts.items()])

    @property
    def sections(self) -> Mapping[str, Content]:
        meshes = {name: part.figures for name, part in self.parts.items()}
        return {**header(self.design), "mesh": meshes, "warnings": self.warnings}

    def to_pyvista(self) -> pyvista.MultiBlock:
        """The meshes for PyVista.

        Returns
        -------
        pyvista.MultiBlock
            Meshes by the names of the members.

        Examples
        --------
        >>> gears.solids(0.05).to_pyvista().keys()
        ['pinion', 'gear']
        """
        import pyvista

        return pyvista.MultiBlock({name: part.to_pyvista() for name, part in self.parts.items()})

    def to_trimesh(self) -> trimesh.Scene:
        """The meshes for trimesh.

        Returns
        -------
        trimesh.Scene
            Meshes by the names of the members.

        Examples
        --------
        >>> sorted(gears.solids(0.05).to_trimesh().geometry)
        ['gear', 'pinion']
        """
        import trimesh

        scene = trimesh.Scene()
        for name, part in self.parts.items():
            scene.add_geometry(part.to_trimesh(), geom_name=name)
        return scene

    def _write(self, target: Path) -> None:
        from gearmesh import io

        io.write_scene({name: part.facets for name, part in self.parts.items()}, target)


def refuse_parts(**asked: object) -> None:
    """Raise ArgumentError for arguments that apply to a part of one member, if all members are asked for."""
    for name, value in asked.items():
        if value is not None:
            raise ArgumentError(name, value, must_be="left out, or member the name of one")


def mesh_to_pyvista(mesh: TriangleMesh) -> pyvista.PolyData:
    """Return a mesh for PyVista, with cell data "region" (index into field data "region_names") and "normal"."""
    import pyvista

    made = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.triangles.astype(int))
    made.cell_data["region"] = mesh.regions
    made.cell_data["normal"] = mesh.normals
    made.field_data["region_names"] = [str(name) for name in mesh.region_names]
    poly_data: pyvista.PolyData = made
    return poly_data


def solid_of(
    gears: GearSet,
    name: str,
    tolerance: float,
    teeth: int | None = None,
    file: str | PathLike[str] | None = None,
    extract: Extract = WHOLE_MEMBER,
    place: Rigid | None = None,
) -> Solid:
    """Return one member, or its worm as a part, within `tolerance` (mm), measured and proved, or the `extract` of it.

    With `teeth` these are open surfaces of the first teeth. Proof, deviation and number of triangles apply to the mesh as
    `file` holds it at its `place`, which may be in single precision. A body without teeth is always whole.
    """
    body = gears.carried.get(name)
    if body is not None:
        if teeth is not None or extract != WHOLE_MEMBER:
            raise ArgumentError(
                "member",
                name,
                reason="has no teeth",
                remedy="leave out what applies to teeth and blanks: it is always whole",
            )
        return carried_solid(gears, body, tolerance, file, place or Rigid.identity())
    part, gear_warnings = gears.stocked_part(name), gears.warnings
    if teeth is not None and not 1 <= teeth <= part.member.tooth.teeth:
        raise ArgumentError("teeth", teeth, must_be=f"a whole number from 1 to {part.member.tooth.teeth}")
    started = time.perf_counter()
    made, written, bound = mesh_within(part.member, tolerance, teeth, extract, file, place)
    seconds = time.perf_counter() - started
    tell(0.8)
    figures = _measured(made, written, bound, tolerance, seconds, extract.offset)
    design = gears.design
    coarse = _coarse(tolerance, design.given_module * design.mm_per_unit)
    in_file = None if file is None or place is not None else (Path(file).suffix.lower(), written)
    return Solid(
        design,
        made.facets,
        figures,
        (*gear_warnings, *part.warnings, *made.warnings, *coarse),
        made.genus is None,
        Summary(part.figures, *made.own),
        made.member,
        teeth=made.teeth,
        in_file=in_file,
        blank=extract.blank,
    )


def _measured(
    made: ExtractMesh, written: Facets, bound: float, tolerance: float, seconds: float, offset: float = 0.0
) -> SolidFigures:
    """Return the figures of a mesh as it is `written`, proved if it is closed; lengths in mm."""
    from gearmesh.mesh.solid import prove

    proof = None if made.genus is None else prove(written, made.genus)
    return SolidFigures(
        triangles=written.triangle_count,
        watertight=proof is not None and proof.ok,
        volume=None if proof is None else proof.volume,
        max_deviation=1e3 * bound,
        sampled_deviation=1e3 * made.bound.sampled,
        tolerance=1e3 * tolerance,
        seconds=seconds,
        offset=offset or None,
    )


def carried_solid(
    gears: GearSet, body: CarriedBody, tolerance: float, file: str | PathLike[str] | None, place: Rigid
) -> Solid:
    """Return a body without teeth as a mesh in its own frame, proved as `file` holds it at its `place`; mm."""
    from gearmesh.mesh.turned_blank import blank_mesh
    from gearmesh.teeth.turned_blank import cylinder

    started, blank = time.perf_counter(), cylinder(body)

    def make(asked: float) -> ExtractMesh:
        mesh, bound = blank_mesh(blank, asked)
        return ExtractMesh(replace(mesh, name=body.name), bound, blank.genus)

    made, written, bound = _within(make, tolerance, tolerance, file, place)
    figures = _measured(made, written, bound, tolerance, time.perf_counter() - started)
    return Solid(gears.design, made.facets, figures)


def _coarse(tolerance: float, module: float) -> tuple[str, ...]:
    """Return a note on a tolerance (mm) that is large for these teeth, for example um that were taken as mm."""
    if tolerance <= SUSPICIOUS_TOLERANCE_MODULES * module:
        return ()
    return (
        f"the tolerance of {tolerance:g} mm is {tolerance / module:.2g} modules: numbers without a unit are in the design's unit "
        f'of length; "{tolerance:g}um" is in um',
    )


def mesh_within(
    member: Member,
    tolerance: float,
    teeth: int | None = None,
    extract: Extract = WHOLE_MEMBER,
    file: str | PathLike[str] | None = None,
    place: Rigid | None = None,
) -> tuple[ExtractMesh, Facets, float]:
    """Return the mesh within `tolerance` (mm), the mesh as the file holds it, and the bound (mm) of the latter's
    deviation.

    Arguments are those of `solid_of`. If the bound, or the rounding of the file, exceeds the tolerance, the mesh is
    made again with a smaller tolerance. This stops at once if the rounding alone is too large.
    """
    # the offset is made and proved only once for all meshes
    member, extract = extract.shift(member), replace(extract, offset=0.0)
    asked = tolerance if file is None else _less_rounding(member, tolerance, file, place)
    return _within(lambda asked: extract.mesh(member, asked, teeth), tolerance, asked, file, place)


def _within(
    make: Callable[[float], ExtractMesh],
    tolerance: float,
    asked: float,
    file: str | PathLike[str] | None,
    place: Rigid | None,
) -> tuple[ExtractMesh, Facets, float]:
    """Return the mesh that `make` returns for a tolerance, first that `asked` for, as `mesh_within` does; mm."""
    from gearmesh import io

    for less in (*TOLERANCE_FACTORS, 1.0):
        made = make(asked)
        tell(0.5)
        mesh = made.facets if place is None else made.facets.move(place)
        written = mesh if file is None else io.mesh_in_file(mesh, file)
        rounding = io.rounding(mesh, written)
        largest = made.bound.largest + rounding
        if largest <= tolerance or rounding > MAX_ROUNDING_SHARE * tolerance:
            break
        asked *= max(less * (tolerance - rounding) / made.bound.largest, MIN_TOLERANCE_FACTOR)
    return made, written, largest


def _less_rounding(member: Member, tolerance: float, file: str | PathLike[str], place: Rigid | None) -> float:
    """Return the tolerance (mm) with which the mesh, rounded in a file at its `place`, is within the tolerance."""
    from gearmesh import io
    from gearmesh.mesh.tessellate import SAMPLED_SHARE

    tooth, joint = member.tooth, member.tooth.joint
    land = tooth.grid(Region.LAND, np.array([0.5]), tooth.even).points.reshape(-1, 3)
    profile = np.insert(np.array(member.body.profile), 1, 0.0, axis=1)
    teeth_places = joint.to(joint.places(tooth.teeth)[:, None] * tooth.pitch_angle)
    points = teeth_places.point(np.concatenate((land, profile))).reshape(-1, 3)
    rounding = io.most_rounding(points if place is None else place.point(points), file)
    if SAMPLED_SHARE * tolerance + rounding <= tolerance or rounding > MAX_ROUNDING_SHARE * tolerance:
        return tolerance
    return tolerance - rounding


def solids_of(
    gears: GearSet,
    tolerance: float,
    file: str | PathLike[str] | None = None,
    extract: Extract = WHOLE_MEMBER,
    phi1: float = 0.0,
) -> Solids:
    """Return all members in mesh at `phi1` (deg), as `Gears.solids` describes them; `tolerance` in mm."""
    places = gears.places_at(phi1)
    parts = {
        name: solid_of(gears, name, tolerance, file=file, extract=extract, place=place).move(place)
        for name, place in in_turn(places.items())
    }
    for body in gears.carried.values():
        place = body.place(places[body.member])
        parts[body.name] = carried_solid(gears, body, tolerance, file, place).move(place)
    return Solids(gears.design, parts, gears.warnings)
