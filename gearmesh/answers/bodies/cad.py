"""CAD solids: members as bodies with named spline, plane and conical faces, for STEP."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh.answers.bodies.extract import WHOLE_MEMBER, Extract, at_nominal_places
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, StatedDesign, columns, header
from gearmesh.answers.tables import Listing, figures
from gearmesh.cad.step import require_occ
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import JSON_SUFFIX, STEP_SUFFIXES
from gearmesh.progress import in_turn, tell
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FLANK_REGIONS, Side

if TYPE_CHECKING:
    import build123d
    import cadquery

    from gearmesh.answers.bodies.face_names import FaceNames
    from gearmesh.cad.step import Occurrence, Part, PartAssembly
    from gearmesh.kernel.motion.rigid import Rigid
    from gearmesh.systems.system import ToolPart


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


@dataclass(frozen=True)
class CadSurfaceFigures(Figures):
    """Flanks, or surfaces of some teeth, of one member as open shells for CAD, as OpenCASCADE measures them."""

    faces: int = figure("faces of the shells", whole=True)
    area: float = figure("area of all faces", "mm2", "A")
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
    """CAD solids of one part in its own frame, or of several members in mesh, or open shells of one part."""

    #: the design, or the train
    design: StatedDesign
    #: the part or the assembly
    made: Part | PartAssembly
    #: figures that were measured, by part
    measured: dict[str, CadFigures] | dict[str, CadSurfaceFigures]
    #: further figures of the parts, by part
    own: dict[str, Summary]
    #: warnings, one line each
    warnings: tuple[str, ...] = ()

    @property
    def parts(self) -> tuple[Part, ...]:
        """Parts; parts that occur several times, such as the planets of a set, are listed once."""
        from gearmesh.cad.step import Part

        return (self.made,) if isinstance(self.made, Part) else self.made.parts

    @property
    def figures(self) -> dict[str, Summary]:
        """All figures of each part, by their keys."""
        return {name: Summary(part, self.own[name]) for name, part in self.measured.items()}

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (*STEP_SUFFIXES, JSON_SUFFIX)

    @property
    def headline(self) -> str:
        return "; ".join(
            f"{name}, {part.faces} faces within {part.max_deviation:.3g} um" for name, part in self.measured.items()
        )

    @property
    def description(self) -> str:
        """Header of a STEP file."""
        largest = max(part.max_deviation for part in self.measured.values())
        return f"{self.design.title}, tooth surfaces within {largest:.3g} um of the exact ones"

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

    def face_names(self) -> FaceNames:
        """Names of the faces of the STEP file by their numbers, for programs that drop names, such as gmsh.

        Returns
        -------
        FaceNames
            Number, member, name, region, side and tooth of each face.

        Examples
        --------
        >>> gears.cad("pinion").face_names().faces[0].face
        1
        """
        from gearmesh.answers.bodies.face_names import face_names

        return face_names(self.design, self.made)

    def to_build123d(self) -> build123d.Solid | build123d.Compound:
        """The solid or the assembly for build123d, without a file.

        Returns
        -------
        build123d.Solid or build123d.Compound
            The children of a Compound have names, colours and positions.

        Raises
        ------
        OutputError
            If build123d is missing.

        Examples
        --------
        >>> gears.cad("pinion").to_build123d().is_valid
        True
        """
        from gearmesh.cad.programs.shapes import build123d_shape

        return build123d_shape(self.made)

    def to_cadquery(self) -> cadquery.Workplane | cadquery.Assembly:
        """The solid or the assembly for CadQuery, without a file.

        Returns
        -------
        cadquery.Workplane or cadquery.Assembly
            Parts and faces of an Assembly have names and colours.

        Raises
        ------
        OutputError
            If CadQuery is missing.

        Examples
        --------
        >>> gears.cad("pinion").to_cadquery().faces().size()  # doctest: +SKIP
        """
        from gearmesh.cad.programs.shapes import cadquery_shape

        return cadquery_shape(self.made)

    def _write(self, target: Path) -> None:
        from gearmesh.cad.step import write_step

        write_step(self.made, target, self.description)


def cad_solid(
    member: Member, tolerance: float, offset: float | None = None, pitches: int | None = None
) -> tuple[Part, CadFigures]:
    """Return a member as a CAD solid within `tolerance` (mm) of its exact surfaces, and its figures.

    `offset` (mm) is the distance by which its tooth surfaces have been moved. `pitches` selects a sector of a member
    that repeats after this number of pitches. Raises DesignError for a body that is no valid solid, and OutputError if
    OpenCASCADE is missing.
    """
    from gearmesh.cad.bar import bar_part, has_straight_faces, spline_bar_part
    from gearmesh.cad.brep import exact_volume, spline_tooth
    from gearmesh.cad.extracts.sector_part import sector_part
    from gearmesh.cad.faces.strip_patches import with_strips
    from gearmesh.cad.solid_part import solid_part

    started = time.perf_counter()
    slides = member.tooth.joint.travel is not None
    if slides and has_straight_faces(member):
        part, deviation = bar_part(member)
    else:
        teeth = with_strips(spline_tooth(member.one_tooth, tolerance), tolerance)
        tell(0.3)
        part = spline_bar_part(member, teeth) if slides else solid_part(member, teeth)
        part = part if pitches is None else sector_part(part, member, teeth, pitches)
        deviation = teeth.largest_deviation
    tell(0.6)
    share = 1.0 if pitches is None else pitches / member.tooth.teeth
    return part, _figures_of(part, share * exact_volume(member), deviation, tolerance, started, offset)


def cad_blank(member: Member, tolerance: float, offset: float | None = None) -> tuple[Part, CadFigures]:
    """Return the blank of a member before its teeth are cut, as `cad_solid` returns the whole member."""
    from gearmesh.cad.blank_part import blank_part
    from gearmesh.teeth.turned_blank import blank_of

    started = time.perf_counter()
    part, deviation = blank_part(member, tolerance)
    return part, _figures_of(part, blank_of(member).volume(), deviation, tolerance, started, offset)


def _figures_of(
    part: Part, exact: float, deviation: float, tolerance: float, started: float, offset: float | None = None
) -> CadFigures:
    """Return the figures of a CAD solid; `exact`: volume, mm3, of the surfaces; lengths in mm, `started` in s."""
    from gearmesh.cad.volume import volume

    measured = volume(part)
    return CadFigures(
        faces=len(part.faces),
        volume=measured,
        volume_error=measured / exact - 1.0,
        max_deviation=1e3 * deviation,
        tolerance=1e3 * tolerance,
        seconds=time.perf_counter() - started,
        offset=offset,
    )


def cad_space(member: Member, tolerance: float, offset: float | None = None) -> tuple[Part, CadFigures]:
    """Return the space before the tooth on +x of a member, as `cad_solid` returns the whole member.

    The space of a double helical member belongs to its first half. Raises DesignError if teeth differ or the space is
    no valid solid, and OutputError if OpenCASCADE is missing.
    """
    from gearmesh.cad.extracts.space_part import space_part, spline_space
    from gearmesh.cad.volume import volume
    from gearmesh.teeth.space import Space

    started, space = time.perf_counter(), Space.before(member.one_tooth.sharp_ends)
    drawn = spline_space(space, tolerance)
    part = space_part(member, drawn)
    measured = volume(part)
    return part, CadFigures(
        faces=len(part.faces),
        volume=measured,
        volume_error=measured / space.volume() - 1.0,
        max_deviation=1e3 * max(drawn.deviation.values()),
        tolerance=1e3 * tolerance,
        seconds=time.perf_counter() - started,
        offset=offset,
    )


def cad_surfaces(
    member: Member, tolerance: float, flanks: Sequence[Side], teeth: int | None = None, offset: float | None = None
) -> tuple[Part, CadSurfaceFigures]:
    """Return surfaces of a member as open shells within `tolerance` (mm) of the exact surfaces, and their figures.

    With `flanks`, these are the flanks of the first `teeth` teeth (None: all) of every row of teeth. Without flanks,
    these are all surfaces of these teeth in the first row. Raises DesignError if teeth differ or shells are not valid,
    and OutputError if OpenCASCADE is missing.
    """
    from gearmesh.cad.brep import spline_tooth
    from gearmesh.cad.extracts.surface_part import area, surface_part

    started, count = time.perf_counter(), member.tooth.teeth if teeth is None else teeth
    drawn = spline_tooth(member.one_tooth, tolerance)
    regions = [FLANK_REGIONS[side] for side in flanks] or None
    part = surface_part(member, drawn, count, regions, member.halves if flanks else member.halves[:1])
    deviations = [miss for link, miss in drawn.deviation.items() if regions is None or link.region in regions]
    return part, CadSurfaceFigures(
        faces=len(part.faces),
        area=area(part),
        max_deviation=1e3 * max(deviations),
        tolerance=1e3 * tolerance,
        seconds=time.perf_counter() - started,
        offset=offset,
    )


def cad_of(
    gears: GearSet,
    member: str | None,
    tolerance: float,
    extract: Extract = WHOLE_MEMBER,
    phi1: float = 0.0,
    teeth: int | None = None,
) -> Cad:
    """Return one member as a CAD solid, or all members in mesh, as `Gears.cad` describes them.

    `tolerance` is in mm, `phi1` in deg.
    """
    from gearmesh.cad.step import Occurrence, Part, PartAssembly

    require_occ()
    if member is not None and phi1:
        raise ArgumentError("phi1", phi1, must_be="left out for one member, which is in its own frame")
    alone = (
        ("blank", extract.blank or None),
        ("space", extract.space or None),
        ("sector", extract.sector),
        ("flank_only", "both" if len(extract.flanks) > 1 else next(iter(extract.flanks), None)),
        ("teeth", teeth),
    )
    for name, value in alone:
        if member is None and value is not None:
            raise ArgumentError(name, value, must_be="left out for several members")
    if member is not None and (extract.flanks or teeth is not None):
        tool_part = gears.stocked_part(member)
        most = tool_part.member.tooth.teeth
        if teeth is not None and not 1 <= teeth <= most:
            raise ArgumentError("teeth", teeth, must_be=f"a whole number from 1 to {most}")
        if extract.flanks or teeth != most:
            return _surfaces_of(gears, tool_part, tolerance, extract, teeth)
    make = cad_blank if extract.blank else cad_space if extract.space else partial(cad_solid, pitches=extract.sector)
    places = {} if member is not None else gears.places_at(phi1)
    wanted = [gears.stocked_part(name) for name in ([member] if member is not None else places)]
    made, measured, warnings = dict[str, Part](), dict[str, CadFigures](), list[str]()
    for alike in in_turn(_alike([part.member for part in wanted])):
        body, left_out = extract.repeat(extract.shift(alike[0]))
        warnings += left_out
        warnings += [at_nominal_places(equal_member) for equal_member in alike if equal_member.index.off_place]
        part, figures = make(body, tolerance, extract.offset or None)
        # planet_1, planet_2 and planet_3 are three occurrences of the part planet
        part = replace(part, name=part.name.rstrip("0123456789").rstrip("_")) if len(alike) > 1 else part
        made.update((equal_member.name, part) for equal_member in alike)
        measured.update((equal_member.name, figures) for equal_member in alike)
    occurrences = tuple(Occurrence(name, made[name], place) for name, place in places.items())
    carried, of_carried = _carried_occurrences(gears, places, tolerance)
    return Cad(
        gears.design,
        made[wanted[0].member.name] if member is not None else PartAssembly(gears.title, (*occurrences, *carried)),
        {part.member.name: measured[part.member.name] for part in wanted} | of_carried,
        {part.member.name: Summary(part.figures, *extract.sector_figures(part.member)) for part in wanted}
        | dict.fromkeys(of_carried, Summary()),
        (*gears.warnings, *(line for part in wanted for line in part.warnings), *warnings),
    )


def _carried_occurrences(
    gears: GearSet, places: Mapping[str, Rigid], tolerance: float
) -> tuple[list[Occurrence], dict[str, CadFigures]]:
    """Return the bodies without teeth as parts of an assembly, each with a shape of its own, and their figures.

    None if there are no `places`.
    """
    from gearmesh.cad.blank_part import turned_part
    from gearmesh.cad.step import Occurrence
    from gearmesh.teeth.turned_blank import cylinder

    occurrences, figures = list[Occurrence](), dict[str, CadFigures]()
    for body in gears.carried.values() if places else ():
        started = time.perf_counter()
        blank = cylinder(body)
        part, deviation = turned_part(blank, tolerance)
        figures[body.name] = _figures_of(part, blank.volume(), deviation, tolerance, started)
        occurrences.append(Occurrence(body.name, part, body.place(places[body.member])))
    return occurrences, figures


def _surfaces_of(gears: GearSet, tool_part: ToolPart, tolerance: float, extract: Extract, teeth: int | None) -> Cad:
    """Return open shells of a part's flanks, or of some of its teeth."""
    shifted = extract.shift(tool_part.member)
    part, figures = cad_surfaces(shifted, tolerance, extract.flanks, teeth, extract.offset or None)
    name, warnings = tool_part.member.name, (*gears.warnings, *tool_part.warnings)
    return Cad(gears.design, part, {name: figures}, {name: Summary(tool_part.figures)}, warnings)


def _alike(members: list[Member]) -> list[list[Member]]:
    """Return members in groups of the same shape."""
    groups: list[list[Member]] = []
    for member in members:
        same_shape = next((group for group in groups if group[0].is_shaped_as(member)), None)
        if same_shape is None:
            groups.append([member])
        else:
            same_shape.append(member)
    return groups
