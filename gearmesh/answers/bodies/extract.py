"""Extracts of a member: the whole, a sector, a space between teeth, or only flanks; and offsets of tooth surfaces."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.errors import ArgumentError
from gearmesh.figures import Figures, figure
from gearmesh.lengths import Length, in_mm
from gearmesh.mesh.triangles import Facets, TriangleMesh
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES
from gearmesh.teeth.region import Region, Side

if TYPE_CHECKING:
    from gearmesh.mesh.deviation.bound import DeviationBound
    from gearmesh.mesh.tessellate import ToothMesh

#: value of `flank_only` for both flanks
BOTH_FLANKS = "both"


def at_nominal_places(member: Member) -> str:
    """Return the note on a body that repeats one tooth of a member whose teeth are off their places."""
    from gearmesh.teeth.micro_geometry.placed_teeth import can_be_placed

    if not member.index.uneven:
        return (
            f"{member.name}: its teeth are at their nominal places against its body; contact and load have them turned"
        )
    where = "its teeth are at their nominal places, as one is repeated"
    if not can_be_placed(member):
        return f"{member.name}: {where}; contact and load have pitch deviations"
    return f"{member.name}: {where}; meshes of whole solids and load have pitch deviations"


@dataclass(frozen=True)
class SectorFigures(Figures):
    """A sector of a member, between two congruent cut faces."""

    pitches: int = figure("pitches of the sector", whole=True)
    sector_angle: float = figure("angle from one cut face of the sector to the other", "deg")
    cut_nodes: int | None = figure(
        "nodes of the mesh on either cut face of the sector", whole=True, optional=True, default=None
    )


@dataclass(frozen=True)
class ExtractMesh:
    """Mesh of an extract."""

    #: triangles of the mesh
    facets: Facets
    #: bound of its distance from the exact surfaces
    bound: DeviationBound
    #: genus of the closed surface; None for an open surface
    genus: int | None
    #: the member, if the mesh is all of it
    member: Member | None = None
    #: further figures
    own: tuple[Figures, ...] = ()
    #: parts of the member that the mesh does not have, one line each
    warnings: tuple[str, ...] = ()
    #: meshes of the different teeth of a whole member
    teeth: tuple[ToothMesh, ...] = ()

    @property
    def mesh(self) -> TriangleMesh:
        """The whole mesh as arrays."""
        return self.facets.whole()


@dataclass(frozen=True)
class Extract:
    """Part of a member that is made; by default the whole member."""

    #: distance of all tooth surfaces along their normals, mm, positive away from the member's material
    offset: float = 0.0
    #: True for the space between two teeth
    space: bool = False
    #: sides of the flanks, if only flanks are made
    flanks: tuple[Side, ...] = ()
    #: number of pitches of a sector
    sector: int | None = None
    #: True for the blank before its teeth are cut
    blank: bool = False

    @staticmethod
    def of(
        offset: Length = 0.0,
        *,
        space: bool = False,
        flank_only: str | None = None,
        sector: int | None = None,
        teeth: int | None = None,
        blank: bool = False,
    ) -> Extract:
        """Return the extract for the arguments of a call.

        `teeth` applies only to flanks or the whole member. Raises ArgumentError for an unknown flank and for excluding
        arguments.
        """
        away = in_mm("offset", offset)
        for name, value in (
            ("teeth", teeth),
            ("sector", sector),
            ("space", space or None),
            ("flank_only", flank_only),
            ("offset", away or None),
        ):
            if blank and value is not None:
                raise ArgumentError(name, value, must_be="left out with blank, which has no teeth")
        for name, asked in (("sector", sector is not None), ("space", space)):
            if teeth is not None and asked:
                raise ArgumentError("teeth", teeth, must_be=f"left out with {name}")
        for name, value in (("space", space or None), ("flank_only", flank_only)):
            if sector is not None and value is not None:
                raise ArgumentError(name, value, must_be="left out with sector")
        if flank_only is not None and flank_only not in (*Side, BOTH_FLANKS):
            raise ArgumentError("flank_only", flank_only, must_be=f"one of {', '.join((*Side, BOTH_FLANKS))}")
        if space and flank_only is not None:
            raise ArgumentError("flank_only", flank_only, reason="a space has both flanks, fillets and a root")
        if sector is not None and sector < 1:
            raise ArgumentError("sector", sector, must_be="a whole number above 0")
        flanks = () if flank_only is None else tuple(Side) if flank_only == BOTH_FLANKS else (Side(flank_only),)
        return Extract(away, space, flanks, sector, blank)

    def shift(self, member: Member) -> Member:
        """Return the member with the offset. Raises DesignError, with the largest valid offset, if it is too large."""
        if not self.offset:
            return member
        from gearmesh.teeth.offset import offset_member

        return offset_member(member, self.offset)

    def repeat(self, member: Member) -> tuple[Member, tuple[str, ...]]:
        """Return the member without the parts that do not repeat after the pitches of a sector, and a note on each such
        part.

        Without a sector this is the member itself. Raises DesignError if the member has no such sector.
        """
        if self.sector is None:
            return member, ()
        from gearmesh.mesh.extracts.sector import cyclic

        return cyclic(member, self.sector)

    def sector_figures(self, member: Member, mesh: TriangleMesh | None = None) -> tuple[SectorFigures, ...]:
        """Return the figures of the sector and of its mesh; none without a sector."""
        if self.sector is None:
            return ()
        nodes = None if mesh is None else len(mesh.only(Region.CUT_RIGHT).vertices)
        return (SectorFigures(self.sector, math.degrees(self.sector * member.tooth.pitch_angle), nodes),)

    def mesh(self, member: Member, tolerance: float, teeth: int | None = None) -> ExtractMesh:
        """Return the mesh of the extract within `tolerance` (mm); open surfaces have only the first `teeth` teeth.

        The space of a double helical member belongs to its first half. Raises DesignError if teeth differ that must be
        equal.
        """
        from gearmesh.mesh.deviation.bound import body_bound, solid_bound, space_bound, teeth_bound
        from gearmesh.mesh.extracts.flank_surface import flank_meshes, join_flanks
        from gearmesh.mesh.extracts.sector import genus_of, sector
        from gearmesh.mesh.extracts.space import parts, space_mesh
        from gearmesh.mesh.solid import gear_facets, some_teeth
        from gearmesh.mesh.tessellate import tessellate, tessellate_alike
        from gearmesh.mesh.turned_blank import blank_mesh
        from gearmesh.teeth.micro_geometry.placed_teeth import has_placed_teeth, placed_teeth
        from gearmesh.teeth.space import Space
        from gearmesh.teeth.turned_blank import blank_of

        if self.blank:
            blank = blank_of(member)
            turned, bound = blank_mesh(blank, tolerance)
            return ExtractMesh(turned, bound, blank.genus, member)
        if member.index.off_place:
            if self.space or self.flanks or self.sector is not None or not has_placed_teeth(member):
                made = self.mesh(replace(member, index=NO_INDEX_ANGLES), tolerance, teeth)
                return replace(made, warnings=(*made.warnings, at_nominal_places(member)))
            member = placed_teeth(member)
        member = self.shift(member)
        if self.space:
            links = tessellate(Space.before(member.one_tooth.sharp_ends), tolerance)
            mesh = space_mesh(links, f"{member.name}_space")
            return ExtractMesh(mesh, space_bound(parts(links)).join(body_bound(mesh)), 0)
        if self.flanks:
            meshes = flank_meshes(member, self.flanks, tolerance)
            return ExtractMesh(join_flanks(member, meshes, teeth), teeth_bound(member, meshes), None)
        member, warnings = self.repeat(member)
        tooth_meshes = tessellate_alike(member.different_teeth, tolerance)
        if teeth is not None and teeth != member.tooth.teeth:
            return ExtractMesh(some_teeth(member, tooth_meshes, teeth), teeth_bound(member, tooth_meshes), None)
        whole = gear_facets(member, tolerance, *tooth_meshes)
        bound = solid_bound(member, tooth_meshes, whole)
        if self.sector is None:
            return ExtractMesh(whole, bound, member.genus, member, teeth=tooth_meshes)
        mesh = sector(whole.whole(), member, self.sector)
        genus, figures = genus_of(mesh, member, self.sector), self.sector_figures(member, mesh)
        return ExtractMesh(mesh, bound, genus, own=figures, warnings=warnings)


WHOLE_MEMBER = Extract()
