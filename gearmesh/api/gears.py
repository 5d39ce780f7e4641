"""Gears built from a design: the one object from which everything else is asked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from gearmesh.answers.bodies.questions import ModelledGears
from gearmesh.answers.gearset import number_list
from gearmesh.arguments import checks_arguments_with, checks_methods
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.lengths import Length
from gearmesh.progress import Progress, in_turn, part, silent
from gearmesh.systems import system as systems
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.answers.bodies.finite_elements import FiniteElementSolution
    from gearmesh.answers.bodies.toolpath import ToolPathAnswer
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


@checks_methods
class Gears(ModelledGears):
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

        return ease_off_of(self.design, self.pair(pair))

    # ---------------------------------------------------------------- drawings, measured gears

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
        >>> correction = real.correct("pinion", settings=["radial"])
        >>> correction.save("corrected.toml").name
        'corrected.toml'
        """
        from gearmesh.answers.inspection.correction import correct_settings

        file = None if measured is None else Path(measured)
        return correct_settings(self.design, member, file, flank, settings, noise)

    def composite(self, *, pair: int | str = 0) -> CompositeTest:
        """Single-flank and double-flank test of a pair with the pitch deviations, or the eccentricities, that its design has.

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
            Where turns are too many, and for eccentric members with pitch deviations, which contain the eccentricity.
        NoSolutionError
            Where the teeth do not meet all the time.

        Examples
        --------
        >>> gears.composite().save("composite.json").name
        'composite.json'
        """
        from gearmesh.answers.inspection.composite import composite_test

        return composite_test(self.design, self.train, mesh=self.pair(pair))

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
        allowed, chosen = self.within(tolerance), self.train.different if pair is None else (pair,)
        with part(0.0, 0.2):
            contacts = {k: self.contact(pair=k) for k in in_turn(chosen)}
        with part(0.2, 0.6):
            solids = {name: self.solid(name, allowed) for name in in_turn(self.members)}
        return self.check_solved(contacts, solids)

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
        from gearmesh.answers.exchange import refuse_kind, rexs_of

        refuse_kind(self.design)
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
            ease-off of the pinion), "sliding" (with its sliding velocity instead), "zone" (contact lines of all tooth pairs on the
            flanks and in the plane of action, with their limit lines), "te" (transmission error), "backlash" (over a pitch),
            "turns" (transmission error over whole turns of eccentric members), and of all torques "loaded_flank" (pressure on the
            flanks laid into their planes), "loaded_te" (transmission error with and without load), "loaded_share" (load share of a
            tooth pair over its engagement), "loaded_stress" (bending stress), "loaded_pair" (pressure and bending stress of a tooth
            pair over its engagement).
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
        if of is not None:
            from gearmesh.reports.answer_pictures import picture_of_answer

            return picture_of_answer(of, view, member, torque, size, dpi, note)
        from gearmesh.reports.pictures import picture

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
        from gearmesh.reports.answer_pictures import save_pictures

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
        >>> gears.animation(size=(160, 120)).save("mesh.gif").name
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
        tls: Mapping[str, str | PathLike[str]] | None = None,
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
        tls : mapping of str to str or os.PathLike, optional
            Files "ca_file", "client_cert" and "client_key" for a scheduler at "tls://..."; by default those of the configuration
            of Dask.
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
        from gearmesh.study.runners import Scheduler
        from gearmesh.study.statistics import limit_of
        from gearmesh.study.study import check_record, plan_of, refuse_workers, run_study, work_and_nominal

        # what is wrong with arguments is refused before anything is built
        if tls is not None and scheduler is None:
            raise ArgumentError("tls", reason="needs a scheduler")
        refuse_workers(workers)
        for text in limits:
            limit_of(text, None)
        check_record(record, None if torque is None else number_list("torque", torque, "Nm").tolist())
        self.names.pair_number(pair)
        plan = plan_of(self.design, vary or {}, tolerance, sample, method, seed, pair)
        torques = None if torque is None else number_list("torque", torque, "Nm").tolist()
        work, nominal = work_and_nominal(self.design, plan.keys, pair, record, torques)
        cluster = None if scheduler is None else Scheduler(scheduler, tls)
        return run_study(self.design, plan, work, nominal, limits, folder, workers, cluster, progress)

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
        >>> gears.report(0.05).save("report.html").name
        'report.html'
        """
        from gearmesh.answers.load.loaded import required_torques
        from gearmesh.answers.questions import loaded_meshes
        from gearmesh.reports.report import SHOWN_TOLERANCE_MM, report_page, study_section
        from gearmesh.view.load.loaded_pictures import LoadedPictures

        # what is wrong with arguments is refused before anything is solved
        shown = self.within(tolerance, SHOWN_TOLERANCE_MM)
        for study in studies:
            study_section(Path(study))
        if torque is not None:
            required_torques(number_list("torque", torque, "Nm").tolist())
            self.pair()
        contacts = {k: self.contact(pair=k) for k in self.train.different}
        verdicts = None
        if check:
            verdicts = self.check_solved(contacts, {name: self.solid(name) for name in self.members})
        return report_page(
            self,
            contacts,
            shown,
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
        >>> gears.run("out", 0.05, page=False).skipped  # None where pictures could be drawn
        """
        from gearmesh.reports.run import run

        return run(self, Path(folder), self.within(tolerance), progress, timing, page, source, torque)


@checks_arguments_with(design="gm.load reads a file, gm.parse a mapping")
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
        With key, value and limit, for geometry that cannot exist, and for what is no design.

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
