"""Files of parts, which several commands write: meshes, CAD solids and sections, by their suffixes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from gearmesh.app.terminal import refuse_folder, refuse_unwritable, show, tolerance_in_mm, warn, working
from gearmesh.cad.planes import AXIAL_PLANE
from gearmesh.errors import ArgumentError
from gearmesh.formats import (
    CSV_SUFFIX,
    DEFAULT_DXF_VERSION,
    DXF_SUFFIX,
    DXF_VERSION_WITHOUT_SPLINES,
    DXF_VERSIONS,
    JSON_SUFFIX,
    SECTION_SUFFIXES,
    STEP_SUFFIXES,
    STL_SUFFIX,
    refuse_suffix,
)
from gearmesh.lengths import in_mm
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from gearmesh import Gears
    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.answers.bodies.face_names import FaceNames
    from gearmesh.answers.bodies.section import Section
    from gearmesh.answers.bodies.solid import Solid, Solids

#: value of --member for one mesh or CAD solid with both members of a pair
BOTH_MEMBERS = "both"
#: value of --member for one mesh or CAD solid with all members
ALL_MEMBERS = "all"


@dataclass(frozen=True)
class PartFile:
    """A file of one member, or of all members, with the values of the options; lengths are texts."""

    #: file to write
    output: Path
    #: tolerance, with an optional unit
    tol: str | None = None
    #: position of a section with an optional unit, or "axial"
    section: str | None = None
    #: kind of curves of a section
    curves: str | None = None
    #: offset of surfaces or contours, with an optional unit
    offset: str | None = None
    #: number of teeth of a mesh or solid
    teeth: int | None = None
    #: flanks of open surfaces: right, left or both
    flank_only: str | None = None
    #: True for the space between two teeth
    space: bool = False
    #: rotation of the pinion for members in mesh, deg
    phi1: float | None = None
    #: number of pitches of a sector
    sector: int | None = None
    #: table of the faces of a STEP file
    names: Path | None = None
    #: True for the blank before the teeth are cut
    blank: bool = False
    #: version of a DXF file
    dxf: str | None = None

    @property
    def suffix(self) -> str:
        """Suffix of the file in lower case."""
        return self.output.suffix.lower()

    @property
    def is_whole(self) -> bool:
        """True if the format holds only whole gears."""
        return self.suffix in SECTION_SUFFIXES

    def is_folder(self, member: str) -> bool:
        """True if the output is a folder, in which each member has an STL file of its own."""
        return not self.suffix and member in (BOTH_MEMBERS, ALL_MEMBERS)

    def files(self, gears: Gears, member: str) -> dict[str, PartFile]:
        """Return the files to write, by their members: this file, or one for every member in a folder."""
        if not self.is_folder(member):
            return {member: self}
        # bodies without teeth are no blanks
        names = [*gears.members, *(() if self.blank else gears.names.carried)]
        return {name: replace(self, output=self.output / f"{name}{STL_SUFFIX}") for name in names}

    def refuse(self, member: str, others: tuple[str, ...] = ()) -> None:
        """Raise ArgumentError or OutputError for options that are wrong for any design; `others`: further suffixes."""
        if self.is_folder(member):
            self._refuse_in_folder()
            return
        from gearmesh import io

        suffix, several = self.suffix, (*io.formats(several=True), *STEP_SUFFIXES)
        known = (*io.formats(), *STEP_SUFFIXES, *SECTION_SUFFIXES)
        if suffix not in known:
            refuse_suffix(self.output, *known, *others)
        self._refuse_extract(member)
        if member in (BOTH_MEMBERS, ALL_MEMBERS) and suffix not in several:
            raise ArgumentError(
                "member", member, reason=f"{suffix} holds one part; for {member} use {', '.join(several)}"
            )
        if self.dxf is not None:
            self._refuse_version()
        for name, value in (("section", self.section), ("curves", self.curves)):
            if value is not None and suffix not in SECTION_SUFFIXES:
                raise ArgumentError(
                    name, value, must_be=f"left out for {suffix}; formats of sections are {', '.join(SECTION_SUFFIXES)}"
                )
        if self.names is not None and suffix not in STEP_SUFFIXES:
            raise ArgumentError(
                "names", self.names, must_be=f"left out for {suffix}; faces are named in {STEP_SUFFIXES[0]}"
            )
        if self.phi1 is not None and member not in (BOTH_MEMBERS, ALL_MEMBERS):
            raise ArgumentError(
                "phi1", self.phi1, must_be=f"left out for --member = {member}, which is in its own frame"
            )
        if suffix == DXF_SUFFIX:
            from gearmesh.cad.dxf import require_ezdxf

            require_ezdxf()
        if self.names is not None:
            refuse_suffix(self.names, CSV_SUFFIX, JSON_SUFFIX)
        for file in (self.output, self.names):
            refuse_unwritable(file)
        self._lengths()

    def _refuse_in_folder(self) -> None:
        """Raise ArgumentError or OutputError for options that do not apply to STL files of all members."""
        for name, value in (
            ("section", self.section),
            ("curves", self.curves),
            ("dxf", self.dxf),
            ("names", self.names),
            ("phi1", self.phi1),
            ("teeth", self.teeth),
            ("sector", self.sector),
            ("space", self.space or None),
            ("flank_only", self.flank_only),
        ):
            if value is not None:
                raise ArgumentError(name, value, must_be="left out for a folder, which holds all members as STL files")
        refuse_folder(self.output)
        self._lengths()

    def _refuse_extract(self, member: str) -> None:
        """Raise ArgumentError for a space, a sector or flanks of a part that is always whole."""
        for name, value in (("space", self.space or None), ("flank_only", self.flank_only), ("sector", self.sector)):
            if value is not None and self.is_whole:
                raise ArgumentError(name, value, must_be=f"left out for {self.suffix}, which holds whole gears")
            if value is not None and member in (BOTH_MEMBERS, ALL_MEMBERS):
                raise ArgumentError(
                    name, value, must_be=f"left out for --member = {member}, which is always made whole"
                )
        if self.blank:
            self._refuse_blank(member)
        if self.sector is not None and self.teeth is not None:
            raise ArgumentError("teeth", self.teeth, must_be="left out with --sector")
        if self.sector is not None and (self.space or self.flank_only):
            what = "space" if self.space else "flank-only"
            raise ArgumentError("sector", self.sector, must_be=f"left out with --{what}")
        if self.space and self.teeth is not None:
            raise ArgumentError("teeth", self.teeth, must_be="left out for --space, which is between two teeth")

    def _refuse_blank(self, member: str) -> None:
        """Raise ArgumentError for options that apply to teeth, and for all members in mesh."""
        if member in (BOTH_MEMBERS, ALL_MEMBERS):
            raise ArgumentError("blank", True, must_be=f"left out for --member = {member}: blanks do not mesh")
        for name, value in (
            ("teeth", self.teeth),
            ("sector", self.sector),
            ("space", self.space or None),
            ("flank_only", self.flank_only),
            ("offset", self.offset),
            ("section", self.section),
        ):
            if value is not None:
                raise ArgumentError(name, value, must_be="left out with --blank, which has no teeth")

    def _refuse_version(self) -> None:
        """Raise ArgumentError for a version of DXF that does not exist, has no splines, or is given for another file."""
        if self.suffix != DXF_SUFFIX:
            raise ArgumentError("dxf", self.dxf, must_be=f"left out for {self.suffix}")
        if self.dxf not in DXF_VERSIONS:
            raise ArgumentError("dxf", self.dxf, must_be=f"one of {', '.join(DXF_VERSIONS)}")
        if self.dxf == DXF_VERSION_WITHOUT_SPLINES and self.curves == "splines":
            raise ArgumentError(
                "curves", self.curves, reason=f"DXF {self.dxf} has no splines", allowed="arcs or polyline"
            )

    def _lengths(self) -> tuple[float | None, float | str | None, float]:
        """Return tolerance, position of the section and offset, mm. Raises DesignError for texts that are no lengths."""
        z = self.section if self.section in (None, AXIAL_PLANE) else in_mm("--section", self.section)
        return tolerance_in_mm(self.tol), z, 0.0 if self.offset is None else in_mm("--offset", self.offset)

    def make(self, gears: Gears, member: str) -> Cad | Section | Solid | Solids:
        """Make the part of a member, or of all members, for the file."""
        tolerance, z, away = self._lengths()
        every = member in (BOTH_MEMBERS, ALL_MEMBERS)
        if self.suffix in SECTION_SUFFIXES:
            version = self.dxf or DEFAULT_DXF_VERSION
            curves = self.curves or ("arcs" if version == DXF_VERSION_WITHOUT_SPLINES else "splines")
            return gears.section(member, z, tolerance, curves=curves, offset=away, blank=self.blank, dxf=version)
        if self.suffix in STEP_SUFFIXES:
            return gears.cad(
                None if every else member,
                tolerance,
                teeth=self.teeth,
                sector=self.sector,
                flank_only=self.flank_only,
                space=self.space,
                blank=self.blank,
                offset=away,
                phi1=self.phi1 or 0.0,
            )
        if every:
            return gears.solids(tolerance, offset=away, file=self.output, phi1=self.phi1 or 0.0)
        if member in gears.names.carried:
            # surfaces of teeth alone are moved by an offset
            away = 0.0
        return gears.solid(
            member,
            tolerance,
            teeth=self.teeth,
            sector=self.sector,
            flank_only=self.flank_only,
            space=self.space,
            blank=self.blank,
            offset=away,
            file=self.output,
        )

    def write(self, gears: Gears, member: str) -> None:
        """Make the part of a member, or of all members, write the file, and print the figures."""
        if self.is_folder(member):
            self._write_folder(gears, member)
            return
        every = member in (BOTH_MEMBERS, ALL_MEMBERS)
        of = "blank" if self.blank else "space" if self.space else "flanks" if self.flank_only else "solid"
        if self.suffix in SECTION_SUFFIXES and not self.blank:
            of = "section"
        with working("solids" if every else f"{of} of the {member}"):
            made = self.make(gears, member)
            made.save(self.output)
            names: Callable[[], FaceNames] | None = getattr(made, "face_names", None)
            if names is not None and self.names is not None:
                names().save(self.names)
        show(made.listings)
        warn(made.warnings, made.complaints)

    def _write_folder(self, gears: Gears, member: str) -> None:
        """Make all members, write their files, and print the figures of each."""
        made = {}
        for name, file in self.files(gears, member).items():
            with working(f"{'blank' if self.blank else 'solid'} of the {name}"):
                made[file.output] = file.make(gears, name)
        self.output.mkdir(parents=True, exist_ok=True)
        for target, solid in made.items():
            solid.save(target)
        show([replace(listing, title=target.stem) for target, solid in made.items() for listing in solid.listings])
        for solid in made.values():
            warn(solid.warnings, solid.complaints)
