"""Gears built from a design: the one object from which everything else is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.answers.gearset import number_list
from gearmesh.answers.questions import SolvedGears
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.lengths import Length, in_mm
from gearmesh.progress import Progress, silent
from gearmesh.systems import system as systems
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    import build123d
    import cadquery

    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.answers.bodies.finite_element_model import UnloadedFiniteElements
    from gearmesh.answers.bodies.finite_elements import FiniteElementDecks, FiniteElements, FiniteElementSolution
    from gearmesh.answers.bodies.measuring_grid import MeasuringGrids
    from gearmesh.answers.bodies.section import Section
    from gearmesh.answers.bodies.solid import Solid, Solids
    from gearmesh.answers.bodies.toolpath import ToolPathAnswer
    from gearmesh.answers.bodies.topography import FlankTopography
    from gearmesh.answers.check import Check, RollTest
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.answers.contact.ease_off import EaseOffMap
    from gearmesh.answers.contact.vh import VHCheck
    from gearmesh.answers.exchange import RexsExport
    from gearmesh.answers.inspection.composite import CompositeTest
    from gearmesh.answers.inspection.correction import Correction
    from gearmesh.answers.inspection.inspection import Inspection
    from gearmesh.answers.limits import Limits
    from gearmesh.answers.load.loaded import LoadedContact
    from gearmesh.answers.pinned import Pinned
    from gearmesh.answers.sheet import Compensation, DesignSheet
    from gearmesh.drawing.drawing import WorkshopDrawing
    from gearmesh.reports.report import ReportPage
    from gearmesh.reports.run import Report
    from gearmesh.study.largest_errors import LargestErrors
    from gearmesh.study.study import Study
    from gearmesh.view.picture import Animation, Diagram, Picture


class Gears(SolvedGears):
    """The gears of a design: exact teeth of all members, their mounting, and the pairs that mesh.

    Nothing is computed before it is asked for. Angles are in deg, torques in Nm, lengths in mm, as in the results, or texts with
    their unit, as "10um" or "0.5in".
    """

    # ---------------------------------------------------------------- flanks as they are

    def with_deviations(
        self,
        member: str,
        flank: str,
        values: ArrayLike,
        *,
        s: ArrayLike | None = None,
        t: ArrayLike | None = None,
        teeth: Sequence[int] | None = None,
    ) -> Gears:
        """The same gears with deviations on a flank of a member, of any kind.

        Parameters
        ----------
        member : str
            Its name.
        flank : str
            "right" or "left".
        values : (I, J)
            mm along the flank's normals, positive where there is more material than nominal, at the points of a grid of 2 x 2 or
            more, as of `members[member].tooth.flank_grid(flank, s, t)`.
        s, t : (I,), (J,)
            Shares of the way from root to tip and from toe to heel at which they are, ascending in 0..1; by default evenly
            spaced from 0.1 to 0.9.
        teeth : (K,)
            Numbers of the teeth that have them, by default all of a member whose teeth are alike; 0 is on the x axis, they are
            counted by growing polar angle. `values` may then be (K, I, J), a grid for each.

        Returns
        -------
        Gears
            Their flank goes through all points, a bicubic spline between them. Beyond the grid it goes on straight, on the
            fillet it fades; every answer is about it. What starts from the design again, as studies and data sheets do, is as
            designed.

        Raises
        ------
        DesignError
            For a member, flank or tooth that there is not, and for deviations that are no grid of numbers, too steep or too
            large.

        Examples
        --------
        >>> gears = gm.build(gm.load("samples/spiral_bevel_basic.toml"))
        >>> real = gears.with_deviations("pinion", "left", 0.001 * np.random.default_rng(0).normal(size=(5, 9)))
        >>> one = gears.with_deviations("pinion", "left", 0.001 * np.ones((5, 9)), teeth=[3])
        """
        from gearmesh.teeth.micro_geometry.deviations import DeviationGrid, with_deviations, with_deviations_of_teeth

        if flank not in tuple(Side):
            raise ArgumentError("flank", flank, must_be=f"one of {', '.join(Side)}")
        own, which = self.member(member), Side(flank)
        if teeth is None:
            made = with_deviations(own, {which: DeviationGrid.of(own.one_tooth, which, values, s, t)})
        else:
            made = with_deviations_of_teeth(own, which, values, teeth, (s, t))
        return Gears(self.design, self.as_built.with_member(made))

    def with_teeth_like(self, member: str, tooth: int) -> Gears:
        """The same gears with all teeth of a member as its tooth of that number, of one whose teeth differ.

        Every answer is then possible; without the `cycle`, contact is that of the one tooth pair.

        Parameters
        ----------
        member : str
            Its name, as "pinion".
        tooth : int
            Number of the tooth; 0 is on the x axis, they are counted by growing polar angle.

        Returns
        -------
        Gears
            Gears whose teeth are alike.

        Raises
        ------
        DesignError
            For a member or tooth that there is not.

        Examples
        --------
        >>> real = gears.with_deviations("pinion", "right", 0.002 * np.ones((3, 3)), teeth=[1])
        >>> real.with_teeth_like("pinion", 1).contact(0.0, cycle=False).path.touching.tolist()
        [True]
        """
        return Gears(self.design, self.as_built.with_member(self.member(member).with_teeth_like(tooth)))

    # ---------------------------------------------------------------- contact

    def ease_off(self, *, pair: int | str = 0) -> EaseOffMap:
        """How far the pinion's flank stays from the gear's, over its whole face, when the gears turn at their nominal ratio.

        Parameters
        ----------
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".

        Returns
        -------
        EaseOffMap
            Distances, um, on a grid over the flank.

        Raises
        ------
        NoSolutionError
            Where the flanks never meet.

        Examples
        --------
        >>> len(gears.ease_off().rows()) > 100
        True
        """
        from gearmesh.answers.contact.ease_off import ease_off_of

        return ease_off_of(self.design, self.train.pair(pair))

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
        offset: Length = 0.0,
        file: str | PathLike[str] | None = None,
    ) -> Solid | Solids:
        """One member as a watertight mesh within a tolerance, or its worm as a part.

        Parameters
        ----------
        member : str
            Its name; "worm" is the worm that grinds one, "both" or "all" are all members in mesh, as of `solids`.
        tolerance : Length, optional
            Largest distance between mesh and exact gear, both ways, mm; by default the design's.
        teeth : int, optional
            The open surfaces of only so many teeth.
        sector : int, optional
            Only so many pitches, fewer than all, closed by two cut faces through the middles of roots, which are the regions
            cut_right and cut_left: one is the other, turned, to the last node.
        flank_only : str, optional
            The "right" or "left" flanks alone, or "both", as open surfaces with exact normals at their vertices.
        space : bool
            The space between two teeth as a solid, as a broach or an electrode fills it, up to the tip surface.
        offset : float or str
            By how much all surfaces of the teeth move along their normals, mm, positive away from the member's material:
            stock, or a spark gap; negative: clearance.
        file : str or os.PathLike, optional
            The file that it is meant for: the mesh is proved as that will hold it, as some formats have single precision.

        Returns
        -------
        Solid
            `save("pinion.stl")` writes it; `measured` has the bound of the deviation and the volume. Solids of all members.

        Raises
        ------
        DesignError
            For a member that there is not, and for an offset that is too large, with the largest that works.

        Examples
        --------
        >>> solid = gears.solid("pinion", tolerance=0.05)
        >>> solid.figures["watertight"], solid.save("pinion.stl").name
        (True, 'pinion.stl')
        """
        from gearmesh.answers.bodies.extract import Extract
        from gearmesh.answers.bodies.solid import TOGETHER, refuse_parts, solid_of

        extract = Extract.of(offset, space=space, flank_only=flank_only, sector=sector, teeth=teeth)
        if member in TOGETHER and member not in self.members:
            refuse_parts(teeth=teeth, sector=sector, flank_only=flank_only, space=space or None)
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
            As of `solid`.
        file : str or os.PathLike, optional
            As of `solid`.
        phi1 : float
            Rotation of the first pair's pinion, deg.

        Returns
        -------
        Solids
            The solids by the names of the members.

        Raises
        ------
        NoSolutionError
            Where the pair has no contact there.

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
        offset: Length = 0.0,
        phi1: float = 0.0,
    ) -> Cad:
        """One member as a CAD solid in its own frame, or all of them placed as they mesh; or a space, a sector, open surfaces.

        Parameters
        ----------
        member : str, optional
            Its name; by default all members.
        tolerance : float or str, optional
            Largest distance of the faces from the exact surfaces, mm, or with a unit; 0.0001 mm.
        teeth : int, optional
            All surfaces of so many teeth, as open shells.
        sector : int, optional
            So many pitches, between the faces cut_right and cut_left.
        flank_only : str, optional
            The "right" or "left" flanks or "both", as open shells.
        space : bool
            The space between two teeth.
        offset : float or str
            As of `solid`.
        phi1 : float
            Rotation of the first pair's pinion, deg, at which all members are placed (fixed frame).

        Returns
        -------
        Cad
            `save("pair.step")` writes it; `to_build123d` and `to_cadquery` hand it over in memory.

        Raises
        ------
        OutputError
            Where OpenCASCADE is missing.
        NoSolutionError
            Where the pair has no contact at phi1.

        Examples
        --------
        >>> gears.cad("pinion", tolerance="10um").save("pinion.step").name
        'pinion.step'
        """
        from gearmesh.answers.bodies.cad import cad_of
        from gearmesh.answers.bodies.extract import Extract
        from gearmesh.cad.brep import TOLERANCE

        extract = Extract.of(offset, space=space, flank_only=flank_only, sector=sector, teeth=teeth)
        return cad_of(self, member, self.within(tolerance, TOLERANCE), extract, phi1, teeth)

    def to_build123d(self, tolerance: Length | None = None, *, phi1: float = 0.0) -> build123d.Compound:
        """All members as an assembly for build123d: `cad(tolerance=tolerance, phi1=phi1).to_build123d()`.

        Parameters
        ----------
        tolerance : float or str, optional
            As of `cad`.
        phi1 : float
            As of `cad`, deg.

        Returns
        -------
        build123d.Compound
            Its children have names, colours and places.

        Raises
        ------
        OutputError
            Where build123d is missing.
        NoSolutionError
            Where the pair has no contact at phi1.

        Examples
        --------
        >>> [part.label for part in gears.to_build123d().children]  # doctest: +SKIP
        ['pinion', 'gear']
        """
        return self.cad(None, tolerance, phi1=phi1).to_build123d()

    def to_cadquery(self, tolerance: Length | None = None, *, phi1: float = 0.0) -> cadquery.Assembly:
        """All members as an assembly for CadQuery: `cad(tolerance=tolerance, phi1=phi1).to_cadquery()`.

        Parameters
        ----------
        tolerance : float or str, optional
            As of `cad`.
        phi1 : float
            As of `cad`, deg.

        Returns
        -------
        cadquery.Assembly
            Parts and faces have names and colours.

        Raises
        ------
        OutputError
            Where CadQuery is missing.
        NoSolutionError
            Where the pair has no contact at phi1.

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
    ) -> Section:
        """The transverse section of one member, as contours for drawings, wires and lasers.

        Parameters
        ----------
        member : str
            Its name, as "pinion".
        z : float or str, optional
            Its place, mm, or with a unit; mid face.
        tolerance : float or str, optional
            Largest distance from the exact section, or from its parallel, mm, or with a unit; 0.0001 mm.
        curves : str
            "splines", "arcs" or "polyline": flanks and fillets are cubic splines, arcs that are tangent to each other, or chords;
            "polyline" makes chords of all arcs too. With "arcs" and "polyline" a DXF file has one closed polyline for
            every contour.
        offset : float or str
            Distance of the contours from the section, mm, or with a unit: positive away from the material, all round teeth, bore,
            keyway and holes, as for a wire whose radius and spark gap it is; negative into the material. Where the tool does not
            reach, in inner corners sharper than itself, the contour is trimmed; `measured.stock_left` is the most that is
            left there.

        Returns
        -------
        Section
            `save("pinion.dxf")` writes it.

        Raises
        ------
        DesignError
            For a member that there is not or whose end faces are not planes, for z beyond its face, and for an offset that a
            contour has no room for.
        NoSolutionError
            Where the tolerance is not met.

        Examples
        --------
        >>> gears.section("pinion", curves="arcs", offset="0.135mm", tolerance="1um").save("pinion.dxf").name
        'pinion.dxf'
        """
        from gearmesh.answers.bodies.section import section_of
        from gearmesh.cad.brep import TOLERANCE

        place = None if z is None else in_mm("z", z)
        return section_of(self, member, place, self.within(tolerance, TOLERANCE), curves, in_mm("offset", offset))

    def drawing(self, member: str) -> WorkshopDrawing:
        """A workshop drawing of one member: axial section, view along the axis, dimensions, gear data, title block.

        Parameters
        ----------
        member : str
            Its name.

        Returns
        -------
        WorkshopDrawing
            On A4 where it fits at full size or larger, else on A3, at a scale of ISO 5455; `save("pinion.pdf")` writes a .pdf,
            .svg or .png file.

        Raises
        ------
        DesignError
            For a member that there is not.

        Examples
        --------
        >>> gears.drawing("pinion").save("pinion.svg").name
        'pinion.svg'
        """
        from gearmesh.drawing.drawing import drawing_of

        return drawing_of(self, member)

    def evaluate(
        self,
        member: str,
        measured: str | PathLike[str] | None = None,
        *,
        flank: str = "both",
        pitch: str | PathLike[str] | None = None,
    ) -> Inspection:
        r"""What was measured of a member, evaluated against its nominal teeth, with the tolerance classes that it has.

        Parameters
        ----------
        member : str
            Its name, as "pinion".
        measured : str or os.PathLike, optional
            File of deviations or points; by default those of the table `measured` of the design.
        flank : str
            The "right" or "left" flank that the file is about, or "both", as its column flank says.
        pitch : str or os.PathLike, optional
            CSV file with columns tooth, right_um, left_um (index deviations) and runout_um; by default what that table says.

        Returns
        -------
        Inspection
            Deviations, um, and classes; `inspection_chart` draws it.

        Raises
        ------
        DesignError, FileError
            Naming what cannot be used.

        Examples
        --------
        >>> with open("pitch.csv", "w") as file:
        ...     _ = file.write("tooth,right_um,left_um\n" + "".join(f"{k},{k % 3},{k % 2}\n" for k in range(18)))
        >>> gears.evaluate("pinion", pitch="pitch.csv").headline
        'pinion: class 2 [ISO 1328-1:2013], limited by f_p'
        """
        from gearmesh.answers.inspection.measured_files import inspect_files

        files = (None if file is None else Path(file) for file in (measured, pitch))
        flanks, pitches = files
        return inspect_files(self.design, member, flanks, flank, pitches)

    def correct(
        self,
        member: str,
        measured: str | PathLike[str] | None = None,
        *,
        flank: str = "both",
        settings: Sequence[str] = (),
        noise: float | None = None,
    ) -> Correction:
        """Machine settings of a bevel or hypoid gear that take measured deviations away; `save("new.toml")` writes the design.

        Parameters
        ----------
        member : str
            Its name, as "pinion".
        measured, flank
            As of `evaluate`.
        settings : sequence of str
            Those that may move, as "radial", of one side "concave.radial", of a motion "helical_motion.2"; by default the
            usual ones.
        noise : float, optional
            Standard deviation of a measured deviation, um; by default what no setting takes away.

        Returns
        -------
        Correction
            Changes of the settings, and the deviations that they leave.

        Raises
        ------
        DesignError, FileError
            Naming what cannot be used.

        Examples
        --------
        >>> real = gm.build(gm.load("samples/hypoid_measured.toml"))
        >>> correction = real.correct("pinion", settings=["radial"])  # doctest: +SKIP
        """
        from gearmesh.answers.inspection.correction import correct_settings

        file = None if measured is None else Path(measured)
        return correct_settings(self.design, member, file, flank, settings, noise)

    def composite(self, *, pair: int | str = 0) -> CompositeTest:
        """Single-flank and double-flank test of a pair with the pitch deviations that its design has.

        Parameters
        ----------
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".

        Returns
        -------
        CompositeTest
            Over the turns after which the same teeth meet again; `composite_chart` draws it.

        Raises
        ------
        DesignError
            Where turns are too many, and for eccentric members, whose eccentricity pitch deviations have in them.
        NoSolutionError
            Where the teeth do not meet all the time.

        Examples
        --------
        >>> gears.composite().save("composite.json").name
        'composite.json'
        """
        from gearmesh.answers.inspection.composite import composite_test

        return composite_test(self.design, self.train, mesh=self.train.pair(pair))

    def composite_chart(self, test: CompositeTest) -> Diagram:
        """The charts of a composite test: transmission error and centre distance over whole turns.

        Parameters
        ----------
        test : CompositeTest
            As `composite` gives it.

        Returns
        -------
        Diagram
            Drawn when it is saved.

        Examples
        --------
        >>> gears.composite_chart(gears.composite()).save("composite.png").name
        'composite.png'
        """
        from gearmesh.view.diagrams.composite_chart import plot_composite
        from gearmesh.view.picture import Diagram

        return Diagram(test.headline, lambda file: plot_composite(file, test))

    def inspection_chart(self, inspection: Inspection) -> Diagram:
        r"""The chart of a measured gear: traces with tolerances, deviations over the flanks, pitch deviations.

        Parameters
        ----------
        inspection : Inspection
            As `evaluate` gives it.

        Returns
        -------
        Diagram
            Drawn when it is saved.

        Examples
        --------
        >>> with open("pitch.csv", "w") as file:
        ...     _ = file.write("tooth,right_um,left_um\n" + "".join(f"{k},{k % 3},{k % 2}\n" for k in range(18)))
        >>> gears.inspection_chart(gears.evaluate("pinion", pitch="pitch.csv")).save("chart.png").name
        'chart.png'
        """
        from gearmesh.view.diagrams.inspection_chart import plot_inspection
        from gearmesh.view.picture import Diagram

        return Diagram(inspection.headline, lambda file: plot_inspection(file, inspection))

    def theoretical_chart(self, member: str) -> Diagram:
        """Profile and helix charts of the exact flanks of a cylindrical gear, with the band of its tolerance class (K charts).

        Parameters
        ----------
        member : str
            Its name, as "pinion".

        Returns
        -------
        Diagram
            `save("k.svg")` draws it.

        Raises
        ------
        DesignError
            When it is drawn, for gears without modifications and for other gears.

        Examples
        --------
        >>> relieved = gm.build(gm.load("samples/spur_relieved.toml"))
        >>> relieved.theoretical_chart("pinion").save("k.svg").name
        'k.svg'
        """
        from gearmesh.answers.inspection.inspection import nominal_inspection
        from gearmesh.view.diagrams.k_chart import plot_k_chart
        from gearmesh.view.picture import Diagram

        nominal = nominal_inspection(self.design, self.train, member)
        return Diagram(f"{member}: theoretical charts", lambda file: plot_k_chart(file, nominal))

    def topography(self, member: str, flank: str = "right", tolerance: Length | None = None) -> FlankTopography:
        """All that modifications remove of a flank, as a grid of amounts.

        Parameters
        ----------
        member : str
            Its name, as "pinion".
        flank : str
            "right" or "left".
        tolerance : float or str, optional
            Largest error of a flank that is read from the grid, mm, or with a unit; 1e-5 mm.

        Returns
        -------
        FlankTopography
            `save("right.csv")` writes the file that the key `topography` reads.

        Raises
        ------
        DesignError
            For a member or flank that there is not, and for flanks that are not modified.

        Examples
        --------
        >>> crowned = gm.build(design.with_values({"pinion.modifications.profile_crowning": 0.01}))
        >>> crowned.topography("pinion").save("right.csv").name
        'right.csv'
        """
        from gearmesh.answers.bodies.topography import TOLERANCE, flank_topography

        within = self.within(tolerance, TOLERANCE)
        return flank_topography(self.design, self.member(member), flank, within)

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
            Points from root to tip and from toe to heel, (5, 9) or "5x9"; one row or column lies in the middle.
        margins : tuple of float, or str
            Shares of profile and face width beside their edges that have no points, (0.1, 0.1) or "0.1,0.1".
        surface : str
            "flank", "fillet" or "all".
        ball : Length
            Diameter of the probe's ball, mm, whose centres are written too.

        Returns
        -------
        MeasuringGrids
            `save("pinion.csv")` writes a .csv or .txt file, which with a column `deviation_um` added is one that the table
            `measured` of a design reads.

        Raises
        ------
        DesignError
            For a member, flank, surface, grid, margins or ball that cannot be.

        Examples
        --------
        >>> gears.measuring_grid("pinion", ball="2mm").save("pinion.csv").name
        'pinion.csv'
        """
        from gearmesh.answers.bodies.measuring_grid import measuring_grid_of, numbers_of

        shape = numbers_of("grid", grid, "x", int)
        shares = numbers_of("margins", margins, ",", float)
        size = None if ball is None else in_mm("ball", ball)
        return measuring_grid_of(self.design, self.member(member), flank, shape, shares, surface, size)

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
        """How a ball-end cutter finishes the spaces between the teeth of a member on a five-axis machine, proved on exact surfaces.

        Parameters
        ----------
        member : str
            Its name.
        tool : str
            "ball:D", "ball:D,L" or "ball:D,L,H": diameter of ball and shank, length of the shank beyond the ball's centre, by
            default five diameters, and diameter of the holder that begins there.
        scallop : Length
            The most that is left over the exact surfaces, chords included, mm.
        stock : Length
            What is left over them on purpose, along the normals, mm.
        tolerance : Length, optional
            The part of the scallop that chords between points may take, mm; by default a tenth.
        flank, surfaces : str
            What is finished: "right", "left" or "both"; "all", flanks with fillets and root, or "flanks" alone.
        spaces : int or str
            The number of the space, that of the tooth after it (0 is on the x axis), or "all" of all rows of teeth.
        order : str
            Feed order, "zigzag" or "one-way".
        lead, tilt : float, optional
            Angles of the tool axis from the middle of the space, deg: towards the heel, and away from the flank that is cut; by
            default the least with which the shank is clear of all teeth.
        feed : float
            mm/min, for .cls files.

        Returns
        -------
        ToolPathAnswer
            `save("pinion.cls")` writes an APT cutter location file, .csv and .vtp hold the same positions.

        Raises
        ------
        DesignError
            For a ball larger than fits into the space or its fillets, with the largest that does, and for other input.
        NoSolutionError
            Where the shank is not clear of the teeth, with the longest that is, or what is left cannot be met.

        Examples
        --------
        >>> gears.toolpath("pinion", "ball:1mm,30mm", "10um").save("pinion.cls").name
        'pinion.cls'
        """
        from gearmesh.answers.bodies.toolpath import tool_path_of

        return tool_path_of(
            self,
            member,
            tool,
            scallop,
            stock=stock,
            tolerance=tolerance,
            flank=flank,
            surfaces=surfaces,
            spaces=spaces,
            order=order,
            lead=lead,
            tilt=tilt,
            feed=feed,
        )

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
        """A model of the teeth in mesh, as fine as the design's table fe says, ready to be written or solved.

        Parameters
        ----------
        phi1 : float
            Rotation of the pinion, deg.
        members : sequence of str, optional
            Only some of the pair.
        rotation : float, optional
            Of the pinion under load, deg, in place of the design's torque.
        friction : float
            Coefficient of Coulomb on the flanks.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        sector : int, optional
            So many pitches of one member, a divisor of its teeth, with cyclic symmetry: loads and supports are those of
            every sector.

        Returns
        -------
        FiniteElements or UnloadedFiniteElements
            Of a gear without a mating gear: held as in a pair, not loaded, with evenly spaced lines, in its own frame.

        Raises
        ------
        DesignError
            For what needs a mating gear where there is none.

        Examples
        --------
        >>> gears.finite_elements().save("pair.inp").name
        'pair.inp'
        """
        if not self.train.pairs:
            from gearmesh.answers.bodies.finite_element_model import unloaded_elements_of

            asked = {"phi1": phi1, "rotation": rotation, "friction": friction, "pair": pair}
            return unloaded_elements_of(self.design, self.train, self.warnings, members, asked, sector)
        from gearmesh.answers.bodies.finite_elements import finite_elements_of

        angle = None if rotation is None else float(np.radians(rotation))
        return finite_elements_of(
            self.design, self.train.pair(pair), self.warnings, float(np.radians(phi1)), members, angle, friction, sector
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
            Where they are written.
        phi1 : sequence of float
            Rotations of the pinion, deg.
        members, rotation, friction, pair
            As of `finite_elements`.
        program : str, optional
            Whose decks: "calculix" or "abaqus".
        progress : callable, optional
            Is told how far the work is (0 to 1) and what it is doing.

        Returns
        -------
        FiniteElementDecks
            The files, and the figures of the models.

        Raises
        ------
        OutputError
            For a folder that cannot be written.

        Examples
        --------
        >>> len(gears.finite_element_decks("decks", [0.0, 2.0]).rows)
        2
        """
        from gearmesh.answers.bodies.finite_elements import finite_element_decks_of

        angle = None if rotation is None else float(np.radians(rotation))
        return finite_element_decks_of(
            self.design,
            self.train.pair(pair),
            Path(folder),
            [float(np.radians(angle)) for angle in phi1],
            self.warnings,
            members,
            angle,
            friction,
            program,
            progress=progress,
        )

    # ---------------------------------------------------------------- checks and limits

    def check(self, tolerance: Length | None = None, *, pair: int | None = None) -> Check:
        """Meshes of all members against the exact surfaces, and the roll test of their flanks against the contact solver.

        Parameters
        ----------
        tolerance : float or str, optional
            Of the meshes, mm, or with a unit; by default the design's.
        pair : int, optional
            Only this mesh; by default every different mesh of the gear set.

        Returns
        -------
        Check
            A verdict on each.

        Examples
        --------
        >>> all(verdict.ok for verdict in gears.check(0.05).verdicts)
        True
        """
        chosen = self.train.different if pair is None else (pair,)
        contacts = {k: self.contact(pair=k) for k in chosen}
        return self.check_solved(contacts, {name: self.solid(name, tolerance) for name in self.members})

    def roll(self, contact: Contact) -> RollTest:
        """The roll test of the meshed flanks at positions of a solved contact.

        Parameters
        ----------
        contact : Contact
            Of a pair of these gears.

        Returns
        -------
        RollTest
            Rotations of first touch by the meshes alone, beside those of the solver.

        Examples
        --------
        >>> gears.roll(gears.contact([0.0, 1.0])).headline
        '2 positions, TE within 1 arcsec'
        """
        from gearmesh.answers.check import roll_test

        return roll_test(contact.pair, contact.path)

    def limits(self, land: float = 0.0) -> Limits:
        """Undercut and pointing of all members.

        Parameters
        ----------
        land : float
            Smallest top land, modules.

        Returns
        -------
        Limits
            Least profile shift and number of teeth, largest tip diameter.

        Examples
        --------
        >>> len(gears.limits().members)
        2
        """
        from gearmesh.answers.limits import limits_of

        return limits_of(self.design, self.train, land)

    # ---------------------------------------------------------------- settings

    def sheet(
        self, *, torque: float | None = None, speed: float | None = None, member: str | None = None
    ) -> DesignSheet:
        """What is derived from the design: the sheet of kinds that have one of their own, else members and pairs.

        Parameters
        ----------
        torque : float, optional
            Nm on the pinion, or on the driving member of a planetary set: then also the forces on the members.
        speed : float, optional
            1/min of the same member: then also the powers.
        member : str, optional
            Only what needs no mating gear: of gears built with `alone` none is then made.

        Returns
        -------
        DesignSheet
            Tables; `save("filled.toml")` writes the design with the derived values given.

        Raises
        ------
        DesignError
            For kinds that do not know forces, for a member that there is not, for both at once, and for a speed without a torque.

        Examples
        --------
        >>> gears.sheet(torque=50).listings[0].title
        'Derived keys (lengths in mm)'
        """
        from gearmesh.answers.sheet import member_sheet_of, sheet_of

        if member is None:
            return sheet_of(self, torque, speed)
        if torque is not None:
            raise ArgumentError("torque", torque, reason="forces need both members; leave member out")
        if speed is not None:
            raise ArgumentError("speed", speed, reason="needs a torque, and both members; leave member out")
        return member_sheet_of(self, member)

    def pin(self) -> Pinned:
        """The design with every default and derived value given: it builds the same gears in later versions, to 1e-12 mm.

        Returns
        -------
        Pinned
            `save("pinned.toml")` writes it.

        Examples
        --------
        >>> gears.pin().save("pinned.toml").name
        'pinned.toml'
        """
        from gearmesh.answers.pinned import pin

        return pin(self.design, systems.pin(self.design, self.train), self.pairs)

    def rexs(self, folder: str | PathLike[str] = ".", *, torque: float | None = None) -> RexsExport:
        """The REXS model of the gears (version 1.7).

        Parameters
        ----------
        folder : str or os.PathLike
            Where the model is to be, from which names of files in the design are counted.
        torque : float, optional
            Nm on the pinion: a load case with results of loaded contact.

        Returns
        -------
        RexsExport
            `save("gears.rexs")` writes it, as .rexsj or .rexsz too. A design that was read from a REXS file keeps all that the file
            has besides.

        Raises
        ------
        DesignError
            For kinds that REXS does not have.

        Examples
        --------
        >>> gears.rexs().save("gears.rexs").name
        'gears.rexs'
        """
        from gearmesh.answers.exchange import rexs_of

        results = None if torque is None else self.loaded_contact(torque)
        return rexs_of(self.pin(), Path(folder), results)

    def compensate(self, refinish: str | None = None) -> Compensation:
        """Settings that compensate the assembly errors of the design.

        Parameters
        ----------
        refinish : str, optional
            The member whose settings move, where the kind leaves the choice.

        Returns
        -------
        Compensation
            Settings before and after; `save("new.toml")` writes the design.

        Raises
        ------
        DesignError
            For kinds that have none, and for a member that cannot be chosen.

        Examples
        --------
        >>> arcs = gm.build(gm.load("samples/circular_arc.toml", ["assembly.dC=0.01"]))
        >>> arcs.compensate().rows[0].key
        'pinion.b'
        """
        from gearmesh.answers.sheet import compensation_of

        return compensation_of(self, refinish)

    def vh(self, moved: tuple[str, ...] | None = None) -> VHCheck:
        """The V-H check: displacements that bring the contact to toe, middle and heel, on both sides.

        Of worm drives to the entering side, the middle and the leaving side of the wheel's face.

        Parameters
        ----------
        moved : tuple of str or None, default None
            Two of "V", "H", "J" and "alpha": the pinion across both axes, or along its own, the gear along its axis, or the shaft
            angle; None is V and H. Of worm drives one of "V", "J" and "alpha"; None is J. The others stay what the design says.

        Returns
        -------
        VHCheck
            Every place is where the displaced members touch first; of a place that is out of reach, the nearest that is not.

        Raises
        ------
        DesignError
            For kinds that have none, and for other displacements.
        NoSolutionError
            Where the contact cannot be brought anywhere between toe and heel.

        Examples
        --------
        >>> bevel = gm.build(gm.load("samples/spiral_bevel_basic.toml"))
        >>> bevel.vh().save("vh.json").name
        'vh.json'
        """
        from gearmesh.answers.contact.vh import vh_of

        return vh_of(self, moved)

    # ---------------------------------------------------------------- pictures

    def picture(
        self,
        view: str = "contact",
        member: str | None = None,
        *,
        of: LoadedContact | FiniteElementSolution | ToolPathAnswer | None = None,
        torque: float | None = None,
        phi1: ArrayLike | None = None,
        size: tuple[int, int] | None = None,
        pair: int | str = 0,
        dpi: int = 150,
        note: str = "",
    ) -> Picture | Diagram:
        """A picture, drawn when it is saved.

        Parameters
        ----------
        view : str
            In three dimensions: "contact" (path and ellipses on a member's tooth), "pattern" (their union), "gap" (the
            pattern that the roll test finds), "pair" (all in mesh), "section" (the mesh cut open across the teeth),
            "tool" (a member with the tool
            that generates it, in its position when it generates the middle of the flank; `member` "worm": with the worm that grinds
            it), "contact_lines" (the tooth and its tool, with the lines along which they touch at several generating rotations),
            "loaded" (a member's tooth with the largest pressure that each place of its flank sees), "stress" (contact pressure and
            tension in colours), "toolpath" (passes in the space, with the tool).
            As diagrams: "flank" (both flanks, of one member or of all, laid into their planes: path, ellipses and pattern, and the
            ease-off of the pinion), "sliding" (with its sliding velocity instead), "te" (transmission error), "turns" (that over
            whole turns of eccentric members), and of all torques "loaded_flank" (pressure on the flanks laid into their planes),
            "loaded_te" (transmission error with and without load), "loaded_share" (load share of a tooth pair over its engagement),
            "loaded_stress" (bending stress), "loaded_pair" (pressure and bending stress of a tooth pair over its engagement).
        member : str, optional
            The member shown.
        of : LoadedContact, FiniteElementSolution or ToolPathAnswer, optional
            What the views "loaded...", "stress" and "toolpath" show.
        torque : float, optional
            Which torque of "loaded", Nm; the largest.
        phi1 : array_like, optional
            Positions, deg; by default the design's.
        size : (int, int), optional
            Pixels; 1600 x 1200, or what a figure needs at so many `dpi`.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        dpi : int
            Of diagrams.
        note : str
            Shown beside the design's name.

        Returns
        -------
        Picture or Diagram
            `save("contact.png")` draws it.

        Raises
        ------
        DesignError
            For another view, member or torque.
        NoSolutionError
            Where there is no contact to show.

        Examples
        --------
        >>> gears.picture("flank").save("flank.svg").name
        'flank.svg'
        """
        from gearmesh.reports.pictures import picture, picture_of_answer

        if of is not None:
            return picture_of_answer(of, view, member, torque, size, dpi, note)
        return picture(self, view, member, phi1, size, pair, dpi, note)

    def save_pictures(self, of: LoadedContact | Study, folder: str | PathLike[str]) -> tuple[Path, ...]:
        """All pictures of contact under load, or all that suit a study, as PNG files; those on teeth only where there is OpenGL.

        Parameters
        ----------
        of : LoadedContact or Study
            What is shown.
        folder : str or os.PathLike
            A folder that exists.

        Returns
        -------
        tuple of pathlib.Path
            The files.

        Raises
        ------
        OutputError
            Where one cannot be written.

        Examples
        --------
        >>> study = gears.study({"assembly.dx": "0:0.1:2"}, record="path", workers=1)
        >>> [path.suffix for path in gears.save_pictures(study, ".")][:1]
        ['.png']
        """
        from gearmesh.reports.pictures import save_pictures

        return save_pictures(of, Path(folder))

    def animation(
        self,
        *,
        phi1: ArrayLike | None = None,
        size: tuple[int, int] = (640, 480),
        pair: int | str = 0,
        note: str = "",
    ) -> Animation:
        """The section through a mesh, rolling through one pitch with the contact moving; drawn when it is saved.

        Parameters
        ----------
        phi1 : array_like, optional
            Positions, deg, through the contact in whose middle the section goes; by default the design's.
        size : (int, int)
            Pixels.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        note : str
            Shown beside the design's name.

        Returns
        -------
        Animation
            `save("mesh.gif")` draws it.

        Raises
        ------
        NoSolutionError
            Where flanks never meet.

        Examples
        --------
        >>> gears.animation(size=(160, 120)).save("mesh.gif").name  # doctest: +SKIP
        'mesh.gif'
        """
        from gearmesh.reports.pictures import animation

        return animation(self, phi1, size, pair, note)

    # ---------------------------------------------------------------- many of them

    def study(
        self,
        vary: Mapping[str, str | Sequence[float | int | str | bool]] | None = None,
        *,
        tolerance: Mapping[str, str] | str | PathLike[str] | None = None,
        sample: int | None = None,
        method: str = "lhs",
        seed: int = 0,
        record: str | Sequence[str] = ("path", "cycle"),
        torque: ArrayLike | None = None,
        limits: Sequence[str] = (),
        folder: str | PathLike[str] | None = None,
        workers: int | None = None,
        scheduler: str | None = None,
        pair: int | str = 0,
        progress: Progress | None = None,
    ) -> Study:
        """Many assemblies or designs: the figures of every row.

        Parameters
        ----------
        vary : mapping of str to list or str, optional
            By dotted key a list of values or a text "low:high:count" (all combinations are rows), or with `sample`
            "low:high", to be sampled evenly.
        tolerance : mapping of str to str, or str or os.PathLike, optional
            By key a text as "normal:0:20um", or a TOML file of them. "class:6", or of the key class, is that of flanks in
            this class of ISO 1328-1.
        sample : int, optional
            Number of sampled rows.
        method : str
            "lhs", "sobol", "random", or "saltelli", which has N (keys + 2) rows and finds Sobol indices.
        seed : int
            Of the sample.
        record : str or sequence of str
            Groups of figures (path, cycle, fit; load, which needs `torque`) or names of figures.
        torque : array_like, optional
            One or several, Nm, on the pinion.
        limits : sequence of str
            What a good row keeps, as "contact_ratio>1".
        folder : str or os.PathLike, optional
            Where finished rows are kept: the same call goes on where it was stopped.
        workers : int, optional
            Processes of this machine; None: as many as are worth it (a script that calls this must be importable, with
            `if __name__ == "__main__"`).
        scheduler : str, optional
            Address of a Dask scheduler, whose workers do it.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        progress : callable, optional
            Is told how far the work is (0 to 1) and what it is doing.

        Returns
        -------
        Study
            Rows, statistics and sensitivities.

        Raises
        ------
        DesignError
            For what cannot be varied.
        NoSolutionError
            Where the design itself has no contact.
        OutputError
            For a folder with another study.

        Examples
        --------
        >>> study = gears.study({"assembly.dx": "-0.1:0.1:3"}, record="cycle", workers=1)
        >>> len(study.numbers("assembly.dx"))
        3
        """
        from gearmesh.study.study import plan_of, run_study, work_and_nominal

        plan = plan_of(self.design, vary or {}, tolerance, sample, method, seed, pair)
        torques = None if torque is None else number_list("torque", torque, "Nm").tolist()
        work, nominal = work_and_nominal(self.design, plan.keys, pair, record, torques)
        return run_study(self.design, plan, work, nominal, limits, folder, workers, scheduler, progress)

    def largest_errors(
        self,
        keys: Mapping[str, str | float] | Sequence[str],
        criteria: Sequence[str] = ("contact_ratio>1",),
        *,
        torque: ArrayLike | None = None,
        pair: int | str = 0,
        progress: Progress | None = None,
    ) -> LargestErrors:
        """The largest values of keys, one at a time and either way from the design's own, with which all criteria hold.

        What fails and holds again farther off counts as failing, if 16 steps show it.

        Parameters
        ----------
        keys : sequence of str, or mapping of str to float or str
            Dotted keys, or with each how far from the design's own value is looked, as "0.5mm" (1 mm, inch or deg).
        criteria : sequence of str
            What has to hold, as "contact_ratio>1".
        torque : array_like, optional
            Nm on the pinion, for criteria under load.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        progress : callable, optional
            Is told how far the work is (0 to 1) and what it is doing.

        Returns
        -------
        LargestErrors
            A range for each key.

        Raises
        ------
        DesignError
            Where a criterion fails for the design itself.

        Examples
        --------
        >>> gears.largest_errors({"assembly.dx": "0.2mm"}).ranges[0].key
        'assembly.dx'
        """
        from gearmesh.study.largest_errors import largest_errors

        torques = None if torque is None else number_list("torque", torque, "Nm").tolist()
        return largest_errors(self.design, keys, criteria, torque=torques, pair=pair, progress=progress)

    def report(
        self,
        tolerance: Length | None = None,
        *,
        check: bool = False,
        source: str | None = None,
        studies: Sequence[str | PathLike[str]] = (),
        torque: ArrayLike | None = None,
        progress: Progress = silent,
    ) -> ReportPage:
        """Everything about the gears as one HTML page that needs no network, with a view that turns and rolls.

        Of a gear without a mating gear: solid, workshop drawing, limits and data sheet.

        Parameters
        ----------
        tolerance : float or str, optional
            Of the meshes shown, mm, or with a unit; 0.01 mm.
        check : bool
            Check meshes and contact, and have the verdicts in it.
        source : str, optional
            Text of the design's file.
        studies : sequence of str or os.PathLike
            Folders of finished studies.
        torque : array_like, optional
            One or several, Nm, on the first pair's pinion: the contact of all pairs that differ under load, too.
        progress : callable, optional
            Is told how far the work is (0 to 1) and what it is doing.

        Returns
        -------
        ReportPage
            `save("report.html")` writes it.

        Raises
        ------
        NoSolutionError
            Where a pair has no contact at any position.
        OutputError
            For a folder without a study.
        DesignError
            For a torque where there is no mating gear.

        Examples
        --------
        >>> gears.report(0.05).save("report.html").name  # doctest: +SKIP
        'report.html'
        """
        from gearmesh.answers.questions import loaded_meshes
        from gearmesh.reports.report import SHOWN, report_page
        from gearmesh.view.load.loaded_pictures import LoadedPictures

        if torque is not None:
            self.train.pair(0)
        contacts = {k: self.contact(pair=k) for k in self.train.different}
        verdicts = None
        if check:
            verdicts = self.check_solved(contacts, {name: self.solid(name) for name in self.members})
        return report_page(
            self,
            contacts,
            self.within(tolerance, SHOWN),
            verdicts,
            None,
            source,
            [Path(study) for study in studies],
            None
            if torque is None
            else {
                k: LoadedPictures(loaded_mesh)
                for k, loaded_mesh in loaded_meshes(self, torque, contacts, progress).items()
            },
        )

    # ---------------------------------------------------------------- all of it

    def run(
        self,
        folder: str | PathLike[str],
        tolerance: Length | None = None,
        *,
        progress: Progress = silent,
        timing: bool = True,
        page: bool = True,
        source: str | None = None,
        torque: ArrayLike | None = None,
    ) -> Report:
        """The main job: solids, contact, roll test, plots and pictures into a folder, and a report of them.

        Parameters
        ----------
        folder : str or os.PathLike
            Where the files are written.
        tolerance : float or str, optional
            Of the meshes, mm, or with a unit; by default the design's.
        progress : callable, optional
            Is told how far the work is (0 to 1) and what it is doing.
        timing : bool
            Whether run times are in the report.
        page : bool
            Whether there is a report.html.
        source : str, optional
            Text of the design's file, for report.html.
        torque : array_like, optional
            One or several, Nm, on the pinion of the first mesh: also contact under load, under the report's key "loaded" and in
            loaded.json, and in a set of every mesh that differs, under "loaded_meshes".

        Returns
        -------
        Report
            Files and figures.

        Raises
        ------
        NoSolutionError
            Where no position has contact.

        Examples
        --------
        >>> gears.run("out", page=False)  # doctest: +SKIP
        """
        from gearmesh.reports.run import run

        return run(self, Path(folder), self.within(tolerance), progress, timing, page, source, torque)


def build(design: Design, *, alone: bool = False) -> Gears:
    """The gears of a design.

    Parameters
    ----------
    design : Design
        Of any kind, as `load` or `parse` give it, or its class.
    alone : bool
        Make nothing before it is asked for, and members that do not need each other one without the other: what is wrong with
        them, and with the pair, is raised then.

    Returns
    -------
    Gears
        The exact teeth of all members, and all that can be asked of them.

    Raises
    ------
    DesignError
        With key, value and limit, for geometry that cannot exist.

    Examples
    --------
    >>> tables = {"pinion": {"teeth": 18, "face_width": 10}, "gear": {"teeth": 24, "face_width": 10}}
    >>> design = gm.parse({"kind": "cylindrical", "module": 2, **tables})
    >>> list(gm.build(design).members)
    ['pinion', 'gear']
    """
    if alone:
        return Gears(design)
    whole = systems.complete_design(design)
    return Gears(whole, systems.build(whole))
