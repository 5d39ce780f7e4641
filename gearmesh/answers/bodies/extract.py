"""What is made of a member: the whole, a sector, the space between two teeth, or flanks alone; how far tooth surfaces are moved."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from gearmesh.errors import ArgumentError
from gearmesh.figures import Figures, figure
from gearmesh.lengths import Length, in_mm
from gearmesh.mesh.triangles import Facets, TriangleMesh
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES
from gearmesh.teeth.region import Region, Side

if TYPE_CHECKING:
    from gearmesh.mesh.deviation.bound import DeviationBound
    from gearmesh.mesh.tessellate import ToothMesh

#: what `flank_only` takes for either flank
BOTH = "both"


def at_nominal_places(member: Member) -> str:
    """What to say of a body that repeats one tooth, of a member with pitch deviations."""
    where = "its teeth are at their nominal places, as one is repeated"
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
    """A mesh, `facets`, its distance from the exact surfaces, its `genus`, None of an open surface, and the `member` of which it is
    all.

    `own`: its further figures; `warnings`: what of the member it does not have; `teeth`: the meshes of the different teeth of a
    whole member.
    """

    facets: Facets
    bound: DeviationBound
    genus: int | None
    member: Member | None = None
    own: tuple[Figures, ...] = ()
    warnings: tuple[str, ...] = ()
    teeth: tuple[ToothMesh, ...] = ()

    @property
    def mesh(self) -> TriangleMesh:
        """The mesh with arrays of all of it."""
        return self.facets.whole()


@dataclass(frozen=True)
class Extract:
    """The `space` between two teeth, `flanks` alone, a `sector` of so many pitches, or, without any, the whole.

    `offset` (mm): of all tooth surfaces along their normals, positive away from the member's material.
    """

    offset: float = 0.0
    space: bool = False
    flanks: tuple[Side, ...] = ()
    sector: int | None = None

    @staticmethod
    def of(
        offset: Length = 0.0,
        *,
        space: bool = False,
        flank_only: str | None = None,
        sector: int | None = None,
        teeth: int | None = None,
    ) -> Extract:
        """What arguments of a call ask for. Raises DesignError for another flank and for several of them at once; `teeth` are of
        flanks or the whole."""
        for name, asked in (("sector", sector is not None), ("space", space)):
            if teeth is not None and asked:
                raise ArgumentError("teeth", teeth, must_be=f"left out with {name}")
        for name, value in (("space", space or None), ("flank_only", flank_only)):
            if sector is not None and value is not None:
                raise ArgumentError(name, value, must_be="left out with sector")
        if flank_only is not None and flank_only not in (*Side, BOTH):
            raise ArgumentError("flank_only", flank_only, must_be=f"one of {', '.join((*Side, BOTH))}")
        if space and flank_only is not None:
            raise ArgumentError("flank_only", flank_only, reason="a space has both flanks, fillets and a root")
        if sector is not None and sector < 1:
            raise ArgumentError("sector", sector, must_be="a whole number above 0")
        flanks = () if flank_only is None else tuple(Side) if flank_only == BOTH else (Side(flank_only),)
        return Extract(in_mm("offset", offset), space, flanks, sector)

    def shift(self, member: Member) -> Member:
        """The member with the offset. Raises DesignError, with the largest that works, where it is too large."""
        if not self.offset:
            return member
        from gearmesh.teeth.offset import offset_member

        return offset_member(member, self.offset)

    def repeat(self, member: Member) -> tuple[Member, tuple[str, ...]]:
        """The member without what does not repeat after the pitches of a sector, if one is asked for, and lines that say what.

        Raises DesignError where there is no such sector.
        """
        if self.sector is None:
            return member, ()
        from gearmesh.mesh.extracts.sector import cyclic

        return cyclic(member, self.sector)

    def sector_figures(self, member: Member, mesh: TriangleMesh | None = None) -> tuple[SectorFigures, ...]:
        """Those of a sector, if one is asked for, and of its mesh."""
        if self.sector is None:
            return ()
        nodes = None if mesh is None else len(mesh.only(Region.CUT_RIGHT).vertices)
        return (SectorFigures(self.sector, math.degrees(self.sector * member.tooth.pitch_angle), nodes),)

    def mesh(self, member: Member, tolerance: float, teeth: int | None = None) -> ExtractMesh:
        """The mesh of it within `tolerance` (mm), of the first `teeth` teeth alone where it is not closed.

        Of a double helical member the space is that of its first half. Raises DesignError where teeth differ that must be alike.
        """
        from gearmesh.mesh.deviation.bound import body_bound, solid_bound, space_bound, teeth_bound
        from gearmesh.mesh.extracts.flank_surface import flank_meshes, join_flanks
        from gearmesh.mesh.extracts.sector import genus_of, sector
        from gearmesh.mesh.extracts.space import parts, space_mesh
        from gearmesh.mesh.solid import gear_facets, some_teeth
        from gearmesh.mesh.tessellate import tessellate, tessellate_alike
        from gearmesh.teeth.micro_geometry.placed_teeth import placed_teeth
        from gearmesh.teeth.space import Space

        if member.index.uneven:
            if self.space or self.flanks or self.sector is not None:
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
        every = tessellate_alike(member.different_teeth, tolerance)
        if teeth is not None and teeth != member.tooth.teeth:
            return ExtractMesh(some_teeth(member, every, teeth), teeth_bound(member, every), None)
        whole = gear_facets(member, tolerance, *every)
        bound = solid_bound(member, every, whole)
        if self.sector is None:
            return ExtractMesh(whole, bound, member.genus, member, teeth=every)
        mesh = sector(whole.whole(), member, self.sector)
        genus, figures = genus_of(mesh, member, self.sector), self.sector_figures(member, mesh)
        return ExtractMesh(mesh, bound, genus, own=figures, warnings=warnings)


WHOLE = Extract()
