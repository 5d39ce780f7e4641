"""Sections: the cut of a member by a plane across its axis, for drawings, lasers and wire EDM."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh.answers.bodies.extract import at_nominal_places
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, figures
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import (
    DEFAULT_DXF_VERSION,
    DXF_SUFFIX,
    DXF_VERSION_WITHOUT_SPLINES,
    DXF_VERSIONS,
    JSON_SUFFIX,
    SECTION_SUFFIXES,
)
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from gearmesh.cad.contours.curves import Contour
    from gearmesh.cad.section import MemberSection

#: largest gap between two curves of a closed contour
MAX_LOOP_GAP_MM = 1e-9


@dataclass(frozen=True)
class SectionFigures(Figures):
    """The transverse section of a member, as it was measured."""

    z: float | None = figure("place of the section along the axis; none of an axial section", "mm", "z")
    loops: int = figure("closed loops", whole=True)
    curves: int = figure("arcs, lines and splines of all loops", whole=True)
    area: float = figure("area of the material", "mm2", "A")
    max_deviation: float = figure("largest distance between the curves and the exact section", "um")
    tolerance: float = figure("largest distance that was allowed", "um")
    largest_gap: float = figure("largest gap between one curve and the next", "mm")
    offset: float = figure("distance of the curves from the exact section, positive away from the material", "mm")
    stock_left: float = figure("most stock that a tool at the offset leaves on the section, in corners", "um")


@dataclass(frozen=True)
class LoopFigures(Figures):
    """One closed loop of a section."""

    loop: str = figure("name of the loop")
    curves: int = figure("arcs, lines and splines", whole=True)
    area: float = figure("area inside the loop", "mm2", "A")
    material: bool = figure("whether the material is inside")


@dataclass(frozen=True, repr=False)
class Section(Result):
    """Transverse section of one member in its own frame (mm)."""

    #: the design
    design: Design
    #: loops of the section, with their deviation
    cut: MemberSection
    #: largest distance that was allowed, mm
    tolerance: float
    #: warnings, one line each
    warnings: tuple[str, ...] = ()
    #: kind of the curves: splines, arcs or polyline
    curves: str = "splines"
    #: distance of the curves from the exact section, mm, positive away from the material
    offset: float = 0.0
    #: largest stock that a tool at the offset leaves in corners, mm
    stock_left: float = 0.0
    #: version of a DXF file
    dxf: str = DEFAULT_DXF_VERSION

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (*SECTION_SUFFIXES, JSON_SUFFIX)

    @property
    def loops(self) -> tuple[Contour, ...]:
        """Closed loops of arcs, lines and, if drawn with splines, cubic splines, from outside inwards."""
        return self.cut.contours

    @property
    def area(self) -> float:
        """Area of the material, mm^2."""
        return self.cut.area

    @property
    def measured(self) -> SectionFigures:
        """Figures of the section."""
        return SectionFigures(
            z=self.cut.z,
            loops=len(self.loops),
            curves=sum(len(loop.curves) for loop in self.loops),
            area=self.area,
            max_deviation=1e3 * self.cut.deviation,
            tolerance=1e3 * self.tolerance,
            largest_gap=self.cut.gap,
            offset=self.offset,
            stock_left=1e3 * self.stock_left,
        )

    @property
    def figures(self) -> Summary:
        """Figures by their keys."""
        return Summary(self.measured)

    @property
    def headline(self) -> str:
        at = "in axial section" if self.cut.z is None else f"at z = {self.cut.z:g} mm"
        at = "blank in half section" if self.cut.axis is not None else at
        return (
            f"{self.cut.name} {at}, {len(self.loops)} loops of {self.measured.curves} curves within "
            f"{1e3 * self.cut.deviation:.3g} um"
        )

    @property
    def description(self) -> str:
        """Header of a file."""
        of = f"of the parallel at {self.offset:+g} mm to the exact section" if self.offset else "of the exact section"
        return f"{self.design.title}, {self.headline} {of}; mm"

    @property
    def complaints(self) -> list[str]:
        """Faults of the loops, one line each."""
        gap = self.cut.gap
        return [f"the loops of the {self.cut.name} have a gap of {gap:.3g} mm"] if gap > MAX_LOOP_GAP_MM else []

    @property
    def listings(self) -> list[Listing]:
        return [figures("", self.measured)]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([LoopFigures(loop.name, len(loop.curves), loop.area, loop.material).row for loop in self.loops])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "section": {self.cut.name: self.measured}, "warnings": self.warnings}

    def _write(self, target: Path) -> None:
        if target.suffix.lower() == DXF_SUFFIX:
            from gearmesh.cad.dxf import write_dxf

            write_dxf(self.cut, target, self.description, joined=self.curves != "splines", version=self.dxf)
        else:
            from gearmesh.cad import svg

            svg.write_svg(self.cut, target, self.description)


def section_of(
    gears: GearSet,
    member: str,
    z: float | None,
    tolerance: float,
    curves: str = "splines",
    offset: float = 0.0,
    *,
    axial: bool = False,
    blank: bool = False,
    dxf: str = DEFAULT_DXF_VERSION,
) -> Section:
    """Return the section of a member at z (default: mid face), the `axial` section of a thread, or the outline of the
    `blank`, as `Gears.section` describes it.

    Lengths are in mm.
    """
    from gearmesh.cad.blank_part import blank_section
    from gearmesh.cad.contours.axial import axial_section
    from gearmesh.cad.contours.paths import base_tolerance, drawn_section
    from gearmesh.cad.contours.redrawn import Curves
    from gearmesh.cad.section import member_section
    from gearmesh.teeth.micro_geometry.placed_teeth import has_placed_teeth, placed_teeth

    if curves not in tuple(Curves):
        raise ArgumentError("curves", curves, must_be=f"one of {', '.join(Curves)}")
    if blank and (offset or axial or z is not None):
        name, value = ("offset", offset) if offset else ("z", "axial" if axial else z)
        raise ArgumentError(name, value, must_be="left out with blank, which is drawn by its outline")
    if dxf not in DXF_VERSIONS:
        raise ArgumentError("dxf", dxf, must_be=f"one of {', '.join(DXF_VERSIONS)}")
    if dxf == DXF_VERSION_WITHOUT_SPLINES and curves == Curves.SPLINES:
        raise ArgumentError("curves", curves, reason=f"DXF {dxf} has no splines", allowed="arcs or polyline")
    kind = Curves(curves)
    part = gears.stocked_part(member)
    placed_member = placed_teeth(part.member)
    # mid face of a double helical member is the middle of its first half, where it has teeth
    low, high = placed_member.tooth.blank.body.ends
    within = base_tolerance(kind, offset, tolerance)
    exact = (
        blank_section(part.member, within)
        if blank
        else axial_section(placed_member, within)
        if axial
        else member_section(placed_member, 0.5 * (low + high) if z is None else z, within)
    )
    section = drawn_section(exact, kind, offset, tolerance)
    warnings = [*gears.warnings, *part.warnings]
    if part.member.index.off_place and not has_placed_teeth(part.member):
        warnings.append(at_nominal_places(part.member))
    stock = section.stock if section.stock > tolerance else 0.0
    if stock:
        warnings.append(
            f"{member}: a tool at this offset leaves up to {stock:.3g} mm of stock in corners sharper than itself"
        )
    return Section(gears.design, section.cut, tolerance, tuple(warnings), curves, offset, stock, dxf)
