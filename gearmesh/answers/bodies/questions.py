"""Questions about the bodies of gears: solids, CAD, sections, measuring grids, tool paths, finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

import numpy as np

from gearmesh.answers.gearset import position_list
from gearmesh.answers.questions import SolvedGears
from gearmesh.arguments import checks_methods
from gearmesh.formats import DEFAULT_DXF_VERSION
from gearmesh.lengths import Length, in_mm
from gearmesh.numerals import parse_number, parse_whole_number
from gearmesh.progress import Progress, silent

if TYPE_CHECKING:
    import build123d
    import cadquery

    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.answers.bodies.finite_element_model import UnloadedFiniteElements
    from gearmesh.answers.bodies.finite_elements import FiniteElementDecks, FiniteElements
    from gearmesh.answers.bodies.measuring_grid import MeasuringGrids
    from gearmesh.answers.bodies.section import Section
    from gearmesh.answers.bodies.solid import Solid, Solids
    from gearmesh.answers.bodies.toolpath import ToolPathAnswer
    from gearmesh.answers.bodies.topography import FlankTopography


@checks_methods
class ModelledGears(SolvedGears):
    """Gears of a design, with the answers about their bodies."""

    # ---------------------------------------------------------------- solids

    @overload
    def solid(  # type: ignore[overload-overlap]  # no member has this name
        self,
        member: Literal["both", "all"],
        tolerance: Length | None = None,
        *,
        offset: Length = 0.0,
        file: str | PathLike[str] | None = None,
    ) -> Solids: ...
    @overload
    def solid(
        self,
        member: str,
        tolerance: Length | None = None,
        *,
        teeth: int | None = None,
        sector: int | None = None,
        flank_only: str | None = None,
        space: bool = False,
        blank: bool = False,
        offset: Length = 0.0,
        file: str | PathLike[str] | None = None,
    ) -> Solid: ...
    def solid(
        self,
        member: str,
        tolerance: Length | None = None,
        *,
        teeth: int | None = None,
        sector: int | None = None,
        flank_only: str | None = None,
        space: bool = False,
        blank: bool = False,
        offset: Length = 0.0,
        file: str | PathLike[str] | None = None,
    ) -> Solid | Solids:
        """One member as a watertight mesh within a tolerance, or its worm as a part.

        Parameters
        ----------
        member : str
            Its name; "worm" is the worm that grinds one, "both" or "all" are all members in mesh, as in `solids`.
        tolerance : Length, optional
            Largest distance between mesh and exact gear, in both directions, mm; by default the design's.
        teeth : int, optional
            Number of teeth whose open surfaces are meshed.
        sector : int, optional
            Number of pitches, fewer than all, closed by two cut faces through the middles of roots. They are the regions
            cut_right and cut_left, and their nodes coincide when one is turned onto the other.
        flank_only : str, optional
            The "right" or "left" flanks, or "both", as open surfaces with exact normals at their vertices.
        space : bool
            The space between two teeth up to the tip surface as a solid, as a broach or an electrode fills it.
        blank : bool
            The blank before its teeth are cut: the body turned up to the tips, with hubs, shafts, bore and web. It has no
            keyway and no holes. The blank of a rack is a bar.
        offset : float or str
            Distance by which all tooth surfaces move along their normals, mm. Positive is away from the member's
            material, for stock or a spark gap; negative is for clearance.
        file : str or os.PathLike, optional
            File for which the mesh is proved: some formats round coordinates to single precision.

        Returns
        -------
        Solid
            `save("pinion.stl")` writes it; `measured` has the proved deviation and the volume. For all members: Solids.

        Raises
        ------
        DesignError
            For a member that does not exist, and for an offset that is too large, with the largest valid offset.

        Examples
        --------
        >>> solid = gears.solid("pinion", tolerance=0.05)
        >>> solid.figures["watertight"], solid.save("pinion.stl").name
        (True, 'pinion.stl')
        """
        from gearmesh.answers.bodies.extract import Extract
        from gearmesh.answers.bodies.solid import ALL_MEMBERS_NAMES, refuse_parts, solid_of

        extract = Extract.of(offset, space=space, flank_only=flank_only, sector=sector, teeth=teeth, blank=blank)
        if member in ALL_MEMBERS_NAMES and member not in self.names.members:
            refuse_parts(teeth=teeth, sector=sector, flank_only=flank_only, space=space or None, blank=blank or None)
            return self.solids(tolerance, offset=offset, file=file)
        return solid_of(self, member, self.within(tolerance), teeth, file, extract)

    def solids(
        self,
        tolerance: Length | None = None,
        *,
        offset: Length = 0.0,
        file: str | PathLike[str] | None = None,
        phi1: float = 0.0,
    ) -> Solids:
        """All members as watertight meshes, placed as they mesh (fixed frame).

        Parameters
        ----------
        tolerance : float or str, optional
            Largest distance from the exact surfaces, mm, or with a unit; by default the design's.
        offset : float or str
            As for `solid`.
        file : str or os.PathLike, optional
            As for `solid`.
        phi1 : float
            Rotation of the first pair's pinion, deg.

        Returns
        -------
        Solids
            The solids by the names of the members.

        Raises
        ------
        NoSolutionError
            If the pair has no contact there.

        Examples
        --------
        >>> gears.solids(tolerance=0.05).save("pair.3mf").name
        'pair.3mf'
        """
        from gearmesh.answers.bodies.extract import Extract
        from gearmesh.answers.bodies.solid import solids_of

        return solids_of(self, self.within(tolerance), file, Extract.of(offset), phi1)

    def cad(
        self,
        member: str | None = None,
        tolerance: Length | None = None,
        *,
        teeth: int | None = None,
        sector: int | None = None,
        flank_only: str | None = None,
        space: bool = False,
        blank: bool = False,
        offset: Length = 0.0,
        phi1: float = 0.0,
    ) -> Cad:
        """One member as a CAD solid in its own frame, or all members in mesh; or a space, a sector, open surfaces.

        Parameters
        ----------
        member : str, optional
            Its name; by default all members.
        tolerance : float or str, optional
            Largest distance of the faces from the exact surfaces, mm, or with a unit; by default 0.0001 mm.
        teeth : int, optional
            Number of teeth whose surfaces are made, as open shells.
        sector : int, optional
            Number of pitches, between the faces cut_right and cut_left.
        flank_only : str, optional
            The "right" or "left" flanks or "both", as open shells.
        space : bool
            The space between two teeth.
        blank : bool
            As for `solid`.
        offset : float or str
            As for `solid`.
        phi1 : float
            Rotation of the first pair's pinion, deg, for the positions of all members (fixed frame).

        Returns
        -------
        Cad
            `save("pair.step")` writes it; `to_build123d` and `to_cadquery` return it without a file.

        Raises
        ------
        OutputError
            If OpenCASCADE is missing.
        NoSolutionError
            If the pair has no contact at phi1.

        Examples
        --------
        >>> gears.cad("pinion", tolerance="10um").save("pinion.step").name
        'pinion.step'
        """
        from gearmesh.answers.bodies.cad import cad_of
        from gearmesh.answers.bodies.extract import Extract
        from gearmesh.cad.brep import DEFAULT_TOLERANCE_MM

        extract = Extract.of(offset, space=space, flank_only=flank_only, sector=sector, teeth=teeth, blank=blank)
        return cad_of(self, member, self.within(tolerance, DEFAULT_TOLERANCE_MM), extract, phi1, teeth)

    def to_build123d(self, tolerance: Length | None = None, *, phi1: float = 0.0) -> build123d.Compound:
        """All members as an assembly for build123d: `cad(tolerance=tolerance, phi1=phi1).to_build123d()`.

        Parameters
        ----------
        tolerance : float or str, optional
            As for `cad`.
        phi1 : float
            As for `cad`, deg.

        Returns
        -------
        build123d.Compound
            Its children have names, colours and positions.

        Raises
        ------
        OutputError
            If build123d is missing.
        NoSolutionError
            If the pair has no contact at phi1.

        Examples
        --------
        >>> [part.label for part in gears.to_build123d().children]
        ['pinion', 'gear']
        """
        return self.cad(None, tolerance, phi1=phi1).to_build123d()

    def to_cadquery(self, tolerance: Length | None = None, *, phi1: float = 0.0) -> cadquery.Assembly:
        """All members as an assembly for CadQuery: `cad(tolerance=tolerance, phi1=phi1).to_cadquery()`.

        Parameters
        ----------
        tolerance : float or str, optional
            As for `cad`.
        phi1 : float
            As for `cad`, deg.

        Returns
        -------
        cadquery.Assembly
            Parts and faces have names and colours.

        Raises
        ------
        OutputError
            If CadQuery is missing.
        NoSolutionError
            If the pair has no contact at phi1.

        Examples
        --------
        >>> gears.to_cadquery().save("pair.step")  # doctest: +SKIP
        """
        return self.cad(None, tolerance, phi1=phi1).to_cadquery()

    def section(
        self,
        member: str,
        z: Length | None = None,
        tolerance: Length | None = None,
        *,
        curves: str = "splines",
        offset: Length = 0.0,
        blank: bool = False,
        dxf: str = DEFAULT_DXF_VERSION,
    ) -> Section:
        """The transverse section of one member, or the axial section of a worm, as contours.

        Parameters
        ----------
        member : str
            Its name, for example "pinion".
        z : float or str, optional
            Position of the section, mm, or with a unit; by default mid face. "axial" is the section through the axis of a
            worm, along z, without keyways and holes.
        tolerance : float or str, optional
            Largest distance from the exact section or its parallel, mm, or with a unit; by default 0.0001 mm.
        curves : str
            "splines", "arcs" or "polyline": flanks and fillets are cubic splines, arcs that are tangent to each other, or
            chords; "polyline" replaces all arcs by chords, too. With "arcs" and "polyline" a DXF file has one closed
            polyline per contour.
        offset : float or str
            Distance of the contours from the section, mm, or with a unit, for example the radius and spark gap of a wire.
            Positive values are away from the material, round teeth, bore, keyway and holes; negative values are into it.
            The contour is trimmed in inner corners that are sharper than the tool; `measured.stock_left` is the largest
            stock that remains there.
        blank : bool
            The outline of the blank before its teeth are cut, instead of a section. It is the half section over z and
            radius, with the axis. For a rack it is the bar across the axis.
        dxf : str
            Version of DXF files: "R12", "R2000", "R2004", "R2007", "R2010", "R2013" or "R2018". R12 has no splines, so
            that it needs other `curves`.

        Returns
        -------
        Section
            `save("pinion.dxf")` writes it.

        Raises
        ------
        DesignError
            For a member that does not exist or whose end faces are not planes, for z beyond its face, and for an offset for
            which a contour has no room; for an axial section of teeth that are not threads.
        NoSolutionError
            If the tolerance cannot be met.

        Examples
        --------
        >>> gears.section("pinion", curves="arcs", offset="0.135mm", tolerance="1um").save("pinion.dxf").name
        'pinion.dxf'
        """
        from gearmesh.answers.bodies.section import section_of
        from gearmesh.cad.brep import DEFAULT_TOLERANCE_MM
        from gearmesh.cad.planes import AXIAL_PLANE

        axial = z == AXIAL_PLANE
        place = None if z is None or axial else in_mm("z", z)
        within = self.within(tolerance, DEFAULT_TOLERANCE_MM)
        away = in_mm("offset", offset)
        return section_of(self, member, place, within, curves, away, axial=axial, blank=blank, dxf=dxf)

    def topography(self, member: str, flank: str = "right", tolerance: Length | None = None) -> FlankTopography:
        """The material that modifications remove from a flank, as a grid of amounts.

        Parameters
        ----------
        member : str
            Its name, for example "pinion".
        flank : str
            "right" or "left".
        tolerance : float or str, optional
            Largest error of a flank that is read from the grid, mm, or with a unit; by default 1e-5 mm.

        Returns
        -------
        FlankTopography
            `save("right.csv")` writes the file that the key `topography` reads.

        Raises
        ------
        DesignError
            For a member or flank that does not exist, and for flanks that are not modified.

        Examples
        --------
        >>> crowned = gm.build(design.with_values({"pinion.modifications.profile_crowning": 0.01}))
        >>> crowned.topography("pinion").save("right.csv").name
        'right.csv'
        """
        from gearmesh.answers.bodies.topography import DEFAULT_TOLERANCE_MM, flank_topography

        within = self.within(tolerance, DEFAULT_TOLERANCE_MM)
        return flank_topography(self, member, flank, within)

    def measuring_grid(
        self,
        member: str,
        flank: str = "both",
        *,
        grid: tuple[int, int] | str = (5, 9),
        margins: tuple[float, float] | str = (0.1, 0.1),
        surface: str = "flank",
        ball: Length | None = None,
    ) -> MeasuringGrids:
        """Nominal points and unit normals of the exact flanks of a member, for measuring machines.

        Parameters
        ----------
        member : str
            Name of the member.
        flank : str
            "right", "left" or "both".
        grid : tuple of int, or str
            Points from root to tip and from toe to heel, (5, 9) or "5x9"; a single row or column lies in the middle.
        margins : tuple of float, or str
            Shares of profile and face width along the edges that have no points, (0.1, 0.1) or "0.1,0.1".
        surface : str
            "flank", "fillet" or "all".
        ball : Length
            Diameter of the probe's ball, mm; its centres are written, too.

        Returns
        -------
        MeasuringGrids
            `save("pinion.csv")` writes a .csv or .txt file. With a column `deviation_um` added, the table `measured` of a
            design reads it.

        Raises
        ------
        DesignError
            For an invalid member, flank, surface, grid, margins or ball.

        Examples
        --------
        >>> gears.measuring_grid("pinion", ball="2mm").save("pinion.csv").name
        'pinion.csv'
        """
        from gearmesh.answers.bodies.measuring_grid import measuring_grid_of, numbers_of

        shape = numbers_of("grid", grid, "x", parse_whole_number)
        shares = numbers_of("margins", margins, ",", parse_number)
        size = None if ball is None else in_mm("ball", ball)
        return measuring_grid_of(self, member, flank, shape, shares, surface, size)

    def toolpath(
        self,
        member: str,
        tool: str,
        scallop: Length,
        *,
        stock: Length = 0.0,
        tolerance: Length | None = None,
        flank: str = "both",
        surfaces: str = "all",
        spaces: int | str = 0,
        order: str = "zigzag",
        lead: float | None = None,
        tilt: float | None = None,
        feed: float = 500.0,
    ) -> ToolPathAnswer:
        """The tool path of a ball-end cutter in the spaces of a member, for a five-axis machine, with proof.

        Parameters
        ----------
        member : str
            Its name.
        tool : str
            "ball:D", "ball:D,L" or "ball:D,L,H": diameter D of ball and shank; length L of the shank beyond the ball's centre,
            by default five diameters; diameter H of the holder, which begins there.
        scallop : Length
            Limit of the material left over the exact surfaces, chords included, mm.
        stock : Length
            Stock that is left on purpose, along the normals, mm.
        tolerance : Length, optional
            Part of the scallop that chords between points may use, mm; by default a tenth.
        flank, surfaces : str
            Surfaces to finish: "right", "left" or "both"; "all" (flanks with fillets and root) or "flanks".
        spaces : int or str
            Number of the space, equal to the number of the tooth after it (tooth 0 is on the x axis), or "all" spaces.
        order : str
            Feed order, "zigzag" or "one-way".
        lead, tilt : float, optional
            Angles of the tool axis from the middle of the space, deg: towards the heel, and away from the flank that is cut.
            By default the smallest angles at which the shank is clear of all teeth.
        feed : float
            Feed in mm/min, for .cls files.

        Returns
        -------
        ToolPathAnswer
            `save("pinion.cls")` writes an APT cutter location file, .csv and .vtp hold the same positions.

        Raises
        ------
        DesignError
            For a ball that does not fit into the space or its fillets, with the largest that fits, and for other invalid
            input.
        NoSolutionError
            If the shank is not clear of the teeth, with the longest that is, or if the material left exceeds the limit.

        Examples
        --------
        >>> gears.toolpath("pinion", "ball:1mm,30mm", "10um").save("pinion.cls").name
        'pinion.cls'
        """
        from gearmesh.answers.bodies.toolpath import tool_path_of
        from gearmesh.toolpath.order import PathOrder

        asked = PathOrder.of(
            scallop,
            stock=stock,
            tolerance=tolerance,
            flank=flank,
            surfaces=surfaces,
            spaces=spaces,
            order=order,
            lead=lead,
            tilt=tilt,
        )
        return tool_path_of(self, member, tool, asked, feed)

    # ---------------------------------------------------------------- finite elements

    def finite_elements(
        self,
        phi1: float = 0.0,
        *,
        members: Sequence[str] | None = None,
        rotation: float | None = None,
        friction: float = 0.0,
        pair: int | str = 0,
        sector: int | None = None,
    ) -> FiniteElements | UnloadedFiniteElements:
        """A finite-element model of the teeth in mesh, as fine as the table fe defines, to be written or solved.

        Parameters
        ----------
        phi1 : float
            Rotation of the pinion, deg.
        members : sequence of str, optional
            Members of the pair that are modelled; by default both.
        rotation : float, optional
            Rotation of the pinion under load, deg, replacing the design's torque.
        friction : float
            Coefficient of Coulomb friction on the flanks.
        pair : int or str
            Number of the mesh, or its members, for example "sun-planet_1".
        sector : int, optional
            Number of pitches of one member, a divisor of its teeth, with cyclic symmetry: loads and supports repeat in every
            sector.

        Returns
        -------
        FiniteElements or UnloadedFiniteElements
            The model; a gear without a mating gear is supported, but not loaded, with evenly spaced lines, in its own frame.

        Raises
        ------
        DesignError
            For arguments that need a mating gear, if there is none.

        Examples
        --------
        >>> gears.finite_elements().save("pair.inp").name
        'pair.inp'
        """
        if not self.names.pairs:
            from gearmesh.answers.bodies.finite_element_model import unloaded_elements_of

            asked = {"phi1": phi1, "rotation": rotation, "friction": friction, "pair": pair}
            return unloaded_elements_of(self.design, self.train, self.warnings, members, asked, sector)
        from gearmesh.answers.bodies.finite_elements import finite_elements_of, refuse_turn_and_friction

        refuse_turn_and_friction(rotation, friction)
        angle, (position,) = None if rotation is None else float(np.radians(rotation)), position_list(phi1)
        return finite_elements_of(
            self.design,
            self.pair(pair),
            self.warnings,
            float(np.radians(position)),
            members,
            angle,
            friction,
            sector,
        )

    def finite_element_decks(
        self,
        folder: str | PathLike[str],
        phi1: Sequence[float],
        *,
        members: Sequence[str] | None = None,
        rotation: float | None = None,
        friction: float = 0.0,
        pair: int | str = 0,
        program: str | None = None,
        progress: Progress = silent,
    ) -> FiniteElementDecks:
        """Decks of `finite_elements` at several positions, with a script run.sh that solves them in order.

        Parameters
        ----------
        folder : str or os.PathLike
            Folder of the decks.
        phi1 : sequence of float
            Rotations of the pinion, deg.
        members, rotation, friction, pair
            As for `finite_elements`.
        program : str, optional
            Program of the decks: "calculix" or "abaqus".
        progress : callable, optional
            Called with the finished share of the work (0 to 1) and its current step.

        Returns
        -------
        FiniteElementDecks
            The files, and the figures of the models.

        Raises
        ------
        OutputError
            If the folder cannot be written.

        Examples
        --------
        >>> len(gears.finite_element_decks("decks", [0.0, 2.0]).rows)
        2
        """
        from gearmesh.answers.bodies.finite_elements import finite_element_decks_of, refuse_turn_and_friction

        refuse_turn_and_friction(rotation, friction)
        angle, positions = None if rotation is None else float(np.radians(rotation)), position_list(phi1)
        return finite_element_decks_of(
            self.design,
            self.pair(pair),
            Path(folder),
            np.radians(positions).tolist(),
            self.warnings,
            members,
            angle,
            friction,
            program,
            progress=progress,
        )
