"""Gears built from a design: the object that answers all questions."""

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
    from gearmesh.explore.explorer import Explorer
    from gearmesh.optimize.optimum import Optimum
    from gearmesh.reports.report import ReportPage
    from gearmesh.reports.run import Report
    from gearmesh.study.largest_errors import LargestErrors
    from gearmesh.study.study import Study
    from gearmesh.view.picture import Animation, Diagram, Picture


@checks_methods
class Gears(ModelledGears):
    """The gears of a design: exact teeth of all members, their mounting, and the pairs that mesh.

    Results are computed on first use. Angles are in deg, torques in Nm, lengths in mm, as in the results. Lengths may also be texts
    with a unit, as "10um" or "0.5in".
    """

    # ---------------------------------------------------------------- measured flanks

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
        """Return the gears with deviations on a flank of a member, for gears of any kind.

        Parameters
        ----------
        member : str
            Name of the member.
        flank : str
            "right" or "left".
        values : (I, J)
            Deviations, mm, along the flank's normals, positive for more material than nominal. The points are those of
            `members[member].tooth.flank_grid(flank, s, t)`, at least 2 x 2.
        s, t : (I,), (J,)
            Positions of the points from root to tip and from toe to heel, ascending in 0..1; by default evenly spaced from
            0.1 to 0.9.
        teeth : (K,)
            Numbers of the teeth with deviations, by default all teeth of a member whose teeth are alike. Tooth 0 is on the x
            axis, and numbers grow with the polar angle. `values` may then be (K, I, J), a grid for each tooth.

        Returns
        -------
        Gears
            Gears whose flank goes through all points, as a bicubic spline. Beyond the grid the deviation continues straight, and
            on the fillet it fades. All answers use this flank, except for answers that start from the design again, as studies
            and data sheets do.

        Raises
        ------
        DesignError
            For an unknown member, flank or tooth, and for deviations that are no grid of numbers, too steep or too large.

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
        """Return gears in which all teeth of a member are equal to one of its teeth, for a member whose teeth differ.

        These gears give every answer; contact without the `cycle` is the contact of this tooth.

        Parameters
        ----------
        member : str
            Name of the member, as "pinion".
        tooth : int
            Number of the tooth. Tooth 0 is on the x axis, and numbers grow with the polar angle.

        Returns
        -------
        Gears
            Gears whose teeth are alike.

        Raises
        ------
        DesignError
            For an unknown member or tooth.

        Examples
        --------
        >>> real = gears.with_deviations("pinion", "right", 0.002 * np.ones((3, 3)), teeth=[1])
        >>> real.with_teeth_like("pinion", 1).contact(0.0, cycle=False).path.touching.tolist()
        [True]
        """
        return Gears(self.design, self.as_built.with_member(self.member(member).with_teeth_like(tooth)))

    # ---------------------------------------------------------------- contact

    def ease_off(self, *, pair: int | str = 0) -> EaseOffMap:
        """Ease-off: gap between the flanks over the pinion's face when the gears turn at their nominal ratio.

        Parameters
        ----------
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".

        Returns
        -------
        EaseOffMap
            Gaps, um, on a grid over the flank.

        Raises
        ------
        NoSolutionError
            If the flanks never meet.

        Examples
        --------
        >>> len(gears.ease_off().rows()) > 100
        True
        """
        from gearmesh.answers.contact.ease_off import ease_off_of

        return ease_off_of(self.design, self.pair(pair))

    # ---------------------------------------------------------------- drawings, measured gears

    def drawing(self, member: str) -> WorkshopDrawing:
        """Return a workshop drawing of one member: axial section, view along the axis, dimensions, gear data, title block.

        Parameters
        ----------
        member : str
            Name of the member.

        Returns
        -------
        WorkshopDrawing
            Sheet A4 if the drawing fits at full size or larger, else A3, at a scale of ISO 5455; `save("pinion.pdf")` writes a
            .pdf, .svg or .png file.

        Raises
        ------
        DesignError
            For an unknown member.

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
        r"""Evaluate measured deviations of a member against its nominal teeth, with their tolerance classes.

        Parameters
        ----------
        member : str
            Name of the member, as "pinion".
        measured : str or os.PathLike, optional
            File of deviations or points; by default the file in the table `measured` of the design.
        flank : str
            "right" or "left", or "both" for all flanks of that table, and for a file with a column flank.
        pitch : str or os.PathLike, optional
            CSV file with columns tooth, right_um, left_um (index deviations) and runout_um; by default the file in that table.

        Returns
        -------
        Inspection
            Deviations, um, and classes; `inspection_chart` draws them.

        Raises
        ------
        DesignError, FileError
            For measured values that cannot be used.

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
        """Compute machine settings of a gear that remove measured deviations; `save("new.toml")` writes the design.

        Parameters
        ----------
        member : str
            Name of the member, as "pinion".
        measured, flank
            As in `evaluate`.
        settings : sequence of str
            Settings that may change: "radial", "concave.radial" for one side, "helical_motion.2" for a motion; by default the
            usual settings.
        noise : float, optional
            Standard deviation of a measured deviation, um; by default estimated from the deviations that no setting removes.

        Returns
        -------
        Correction
            Changes of the settings, and the remaining deviations.

        Raises
        ------
        DesignError, FileError
            For measured values or settings that cannot be used.

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
        """Simulate the single-flank and double-flank test of a pair with the pitch deviations or eccentricities of its design.

        Parameters
        ----------
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".

        Returns
        -------
        CompositeTest
            Test over the turns after which the same teeth meet again; `composite_chart` draws it.

        Raises
        ------
        DesignError
            For too many turns, and for eccentric members with pitch deviations, which contain the eccentricity.
        NoSolutionError
            If the teeth are not in mesh all the time.

        Examples
        --------
        >>> gears.composite().save("composite.json").name
        'composite.json'
        """
        from gearmesh.answers.inspection.composite import composite_test

        return composite_test(self.design, self.train, mesh=self.pair(pair))

    def composite_chart(self, test: CompositeTest) -> Diagram:
        """Return the charts of a composite test: transmission error and centre distance over whole turns.

        Parameters
        ----------
        test : CompositeTest
            Result of `composite`.

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
        r"""Return the chart of a measured gear: traces with tolerances, deviations over the flanks, pitch deviations.

        Parameters
        ----------
        inspection : Inspection
            Result of `evaluate`.

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
        """Return profile and helix charts of the exact flanks of a cylindrical gear, with the band of its class (K charts).

        Parameters
        ----------
        member : str
            Name of the member, as "pinion".

        Returns
        -------
        Diagram
            `save("k.svg")` draws it.

        Raises
        ------
        DesignError
            On drawing, for gears without modifications and for gears of other kinds.

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
        """Check the meshes of all members against the exact surfaces, and the contact solver against a roll test of the meshes.

        Parameters
        ----------
        tolerance : float or str, optional
            Tolerance of the meshes, mm, or with a unit; by default the design's.
        pair : int, optional
            Number of the only pair to check; by default every different pair of the gear set.

        Returns
        -------
        Check
            A verdict on each comparison.

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
        """Roll the meshed flanks at the positions of a solved contact.

        Parameters
        ----------
        contact : Contact
            Contact of a pair of these gears.

        Returns
        -------
        RollTest
            Rotations of first touch, by the meshes alone and by the solver.

        Examples
        --------
        >>> gears.roll(gears.contact([0.0, 1.0])).headline
        '2 positions, TE within 1 arcsec'
        """
        from gearmesh.answers.check import roll_test

        return roll_test(contact.pair, contact.path)

    def limits(self, land: float = 0.0) -> Limits:
        """Compute the limits against undercut and pointing of all members.

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
        """Data sheet: values derived from the design, of members and pairs, in the form of the kind.

        Parameters
        ----------
        torque : float, optional
            Torque, Nm, on the pinion or on the driving member of a planetary set; adds the forces on the members.
        speed : float, optional
            Speed, 1/min, of the same member; adds the powers.
        member : str, optional
            The only member of the sheet, without values that need a mating gear. Gears built with `alone` build no other member.

        Returns
        -------
        DesignSheet
            Tables; `save("filled.toml")` writes the design with the derived values given.

        Raises
        ------
        DesignError
            For a torque with a kind without forces, an unknown member, a member with a torque, and a speed without a torque.

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
        """Return the design with all defaults and derived values given: later versions build the same gears, to 1e-12 mm.

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
        """Return the REXS model of the gears (version 1.7).

        Parameters
        ----------
        folder : str or os.PathLike
            Folder of the model; names of files in the design are relative to it.
        torque : float, optional
            Torque, Nm, on the pinion; adds a load case with results of loaded contact.

        Returns
        -------
        RexsExport
            `save("gears.rexs")` writes the model, also as .rexsj or .rexsz. A design that was read from a REXS file keeps the whole
            content of this file.

        Raises
        ------
        DesignError
            For kinds that are not in REXS.

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
        """Compute settings that compensate the assembly errors of the design.

        Parameters
        ----------
        refinish : str, optional
            Member whose settings change, for kinds with a choice.

        Returns
        -------
        Compensation
            Settings before and after; `save("new.toml")` writes the design.

        Raises
        ------
        DesignError
            For kinds without such settings, and for a member that cannot be chosen.

        Examples
        --------
        >>> arcs = gm.build(gm.load("samples/circular_arc.toml", ["assembly.dC=0.01"]))
        >>> arcs.compensate().rows[0].key
        'pinion.b'
        """
        from gearmesh.answers.sheet import compensation_of

        return compensation_of(self, refinish)

    def vh(self, moved: tuple[str, ...] | None = None) -> VHCheck:
        """V-H check: displacements that move the contact to toe, middle and heel, on both sides.

        For worm drives the places are the entering side, the middle and the leaving side of the wheel's face.

        Parameters
        ----------
        moved : tuple of str or None, default None
            Two displacements for bevel gears, None for V and H; one for worm drives, not H, None for J. The other displacements
            keep the values of the design.

            - "V": pinion across both axes
            - "H": pinion along its axis
            - "J": gear along its axis
            - "alpha": shaft angle

        Returns
        -------
        VHCheck
            Displacements, each proved by first touch of the displaced members. A place that is out of reach is replaced by the
            nearest place within reach.

        Raises
        ------
        DesignError
            For kinds without this check, and for other displacements.
        NoSolutionError
            If the contact cannot be moved to any place between toe and heel.

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
        look: str = "plain",
    ) -> Picture | Diagram:
        """Return a picture, which is drawn when it is saved.

        Parameters
        ----------
        view : str
            Views in three dimensions:

            - "contact": path and contact ellipses on a member's tooth
            - "pattern": union of the contact ellipses
            - "gap": contact pattern found by the roll test
            - "pair": all members in mesh
            - "section": mesh cut open across the teeth
            - "tool": member with its tool, in the position that generates the middle of the flank; with the grinding worm for
              `member` "worm"
            - "contact_lines": tooth and tool, with the lines along which they touch at several generating rotations
            - "loaded": member's tooth with the largest pressure at each place of its flank
            - "stress": contact pressure and tension in colours
            - "toolpath": passes in the space, with the tool

            Diagrams; those of contact under load, "loaded_flank" and the like, show all torques:

            - "flank": both flanks, of one member or of all, in their planes: path, ellipses, pattern, ease-off of the pinion
            - "sliding": the same with the sliding velocity in place of the ease-off
            - "zone": contact lines of all tooth pairs on the flanks and in the plane of action, with limit lines
            - "te": transmission error
            - "backlash": backlash over a pitch
            - "turns": transmission error over whole turns of eccentric members
            - "loaded_flank": pressure on the flanks in their planes
            - "loaded_te": transmission error with and without load
            - "loaded_share": load share of a tooth pair over its engagement
            - "loaded_stress": bending stress
            - "loaded_pair": pressure and bending stress of a tooth pair over its engagement
        member : str, optional
            Member of the picture, in views of one member.
        of : LoadedContact, FiniteElementSolution or ToolPathAnswer, optional
            Answer shown by the views "loaded...", "stress" and "toolpath".
        torque : float, optional
            Torque, Nm, of the view "loaded"; by default the largest.
        phi1 : array_like, optional
            Positions, deg; by default the design's.
        size : (int, int), optional
            Width and height in pixels; by default 1600 x 1200, or the size of a diagram at `dpi`.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        dpi : int
            Resolution of diagrams, pixels per inch.
        note : str
            Text beside the design's name.
        look : str
            "plain", or, for the views "pattern" and "gap", "compound": teeth painted with marking compound, from which
            contact has rubbed it where the gap is smaller than its thickness `contact.delta`.

        Returns
        -------
        Picture or Diagram
            `save("contact.png")` draws it.

        Raises
        ------
        DesignError
            For an unknown view, member, torque or look.
        NoSolutionError
            If there is no contact to show.

        Examples
        --------
        >>> gears.picture("flank").save("flank.svg").name
        'flank.svg'
        """
        if of is not None:
            from gearmesh.reports.answer_pictures import picture_of_answer

            if look != "plain":
                raise ArgumentError("look", look, reason="is for pictures of gears alone; leave it or `of` out")
            if phi1 is not None:
                raise ArgumentError("phi1", phi1, reason="is for pictures of gears alone; leave it or `of` out")
            return picture_of_answer(of, view, member, torque, size, dpi, note)
        if torque is not None:
            raise ArgumentError("torque", torque, unit="Nm", reason="needs `of`, contact under load")
        from gearmesh.reports.pictures import picture

        return picture(self, view, member, phi1, size, pair, dpi, note, look)

    def save_pictures(self, of: LoadedContact | Study | Optimum, folder: str | PathLike[str]) -> tuple[Path, ...]:
        """Save all pictures of contact under load, of a study or of an optimum as PNG files; pictures of teeth need OpenGL.

        Parameters
        ----------
        of : LoadedContact, Study or Optimum
            Answer to draw.
        folder : str or os.PathLike
            Existing folder.

        Returns
        -------
        tuple of pathlib.Path
            The files.

        Raises
        ------
        OutputError
            If a file cannot be written.

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
        view: str = "section",
        member: str | None = None,
        *,
        phi1: ArrayLike | None = None,
        size: tuple[int, int] = (640, 480),
        pair: int | str = 0,
        note: str = "",
        look: str = "plain",
    ) -> Animation:
        """Return an animation of a mesh; it is drawn when it is saved.

        Parameters
        ----------
        view : str
            Views that go round, through one pitch:

            - "section": mesh cut open across the teeth, with the moving contact
            - "pair": both members in mesh, without shafts, hubs, keyways and holes

            Views of one tooth over its engagement:

            - "contact": contact ellipse or contact line that rolls over the tooth
            - "pattern": contact pattern that grows
        member : str, optional
            Member whose tooth is shown; by default the pinion.
        phi1 : array_like, optional
            Positions, deg; the section goes through the middle of the contact at these positions. By default the design's.
        size : (int, int)
            Width and height in pixels.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        note : str
            Text beside the design's name.
        look : str
            "plain", or, for the view "pattern", "compound": marking compound that is rubbed off.

        Returns
        -------
        Animation
            `save("mesh.gif")` draws it.

        Raises
        ------
        DesignError
            For an unknown view, member or look.
        NoSolutionError
            If the flanks never meet, or have no ellipses of which a pattern consists.

        Examples
        --------
        >>> gears.animation(size=(160, 120)).save("mesh.gif").name
        'mesh.gif'
        """
        from gearmesh.reports.pictures import animation

        return animation(self, view, member, phi1, size, pair, note, look)

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
        level: str = "full",
        limits: Sequence[str] = (),
        folder: str | PathLike[str] | None = None,
        workers: int | None = None,
        scheduler: str | None = None,
        tls: Mapping[str, str | PathLike[str]] | None = None,
        pair: int | str = 0,
        progress: Progress | None = None,
    ) -> Study:
        """Study many assemblies or designs: compute figures for every row.

        Parameters
        ----------
        vary : mapping of str to list or str, optional
            Values of dotted keys. Each is a list or a text "low:high:count", and all combinations are rows; with `sample` it is
            "low:high", sampled evenly.
        tolerance : mapping of str to str, or str or os.PathLike, optional
            Distributions of keys, as "normal:0:20um", or a TOML file of them. "class:6", or the key class, stands for flanks in
            this class of ISO 1328-1.
        sample : int, optional
            Number of sampled rows.
        method : str
            "lhs", "sobol", "random", or "saltelli", which has N (keys + 2) rows and finds Sobol indices.
        seed : int
            Seed of the sample.
        record : str or sequence of str
            Groups of figures (path, cycle, fit; load, which needs `torque`) or names of figures.
        torque : array_like, optional
            One or several torques on the pinion, Nm.
        level : str
            Model of contact under load: "full", or "quick", within 3 % in transmission error and load shares.
        limits : sequence of str
            Criteria of a good row, as "contact_ratio>1".
        folder : str or os.PathLike, optional
            Folder for finished rows; after a stop, the same call continues.
        workers : int, optional
            Number of processes on this machine; None for a number that fits the work. A calling script must be importable, with
            `if __name__ == "__main__"`.
        scheduler : str, optional
            Address of a Dask scheduler, whose workers compute the rows.
        tls : mapping of str to str or os.PathLike, optional
            Files "ca_file", "client_cert" and "client_key" for a scheduler at "tls://..."; by default from the configuration of
            Dask.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        progress : callable, optional
            Function of the progress (0 to 1) and the name of the stage.

        Returns
        -------
        Study
            Rows, statistics and sensitivities.

        Raises
        ------
        DesignError
            For keys that cannot be varied.
        NoSolutionError
            If the design itself has no contact.
        OutputError
            For a folder with another study.

        Examples
        --------
        >>> study = gears.study({"assembly.dx": "-0.1:0.1:3"}, record="cycle", workers=1)
        >>> len(study.numbers("assembly.dx"))
        3
        """
        from gearmesh.answers.load.loaded import required_level
        from gearmesh.study.runners import Scheduler
        from gearmesh.study.statistics import limit_of
        from gearmesh.study.study import check_record, plan_of, refuse_workers, run_study, work_and_nominal

        # refuse wrong arguments before anything is built
        cluster = Scheduler.at(scheduler, tls)
        refuse_workers(workers)
        required_level(level)
        for text in limits:
            limit_of(text, None)
        check_record(record, None if torque is None else number_list("torque", torque, "Nm").tolist())
        self.names.pair_number(pair)
        plan = plan_of(self.design, vary or {}, tolerance, sample, method, seed, pair)
        torques = None if torque is None else number_list("torque", torque, "Nm").tolist()
        work, nominal = work_and_nominal(self.design, plan.keys, pair, record, torques, level)
        return run_study(self.design, plan, work, nominal, limits, folder, workers, cluster, progress)

    def largest_errors(
        self,
        keys: Mapping[str, str | float] | Sequence[str],
        criteria: Sequence[str] = ("contact_ratio>1",),
        *,
        torque: ArrayLike | None = None,
        level: str = "full",
        pair: int | str = 0,
        progress: Progress | None = None,
    ) -> LargestErrors:
        """Find the largest values of keys with which all criteria hold, one key at a time, above and below the design's value.

        If a criterion fails and holds again farther away, the value ends at the failure, if 16 steps show it.

        Parameters
        ----------
        keys : sequence of str, or mapping of str to float or str
            Dotted keys, optionally with the searched distance from the design's value, as "0.5mm"; by default 1 mm, inch or deg.
        criteria : sequence of str
            Criteria that must hold, as "contact_ratio>1".
        torque : array_like, optional
            Torques on the pinion, Nm, for criteria under load.
        level : str
            Model of contact under load: "full", or "quick".
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        progress : callable, optional
            Function of the progress (0 to 1) and the name of the stage.

        Returns
        -------
        LargestErrors
            A range for each key.

        Raises
        ------
        DesignError
            If a criterion fails for the design itself.

        Examples
        --------
        >>> gears.largest_errors({"assembly.dx": "0.2mm"}).ranges[0].key
        'assembly.dx'
        """
        from gearmesh.answers.load.loaded import required_level
        from gearmesh.study.largest_errors import largest_errors

        required_level(level)
        torques = None if torque is None else number_list("torque", torque, "Nm").tolist()
        return largest_errors(self.design, keys, criteria, torque=torques, level=level, pair=pair, progress=progress)

    def optimize(
        self,
        vary: Mapping[str, str | Sequence[float | int | str | bool]],
        minimize: str | Sequence[str] = (),
        *,
        maximize: str | Sequence[str] = (),
        subject: Sequence[str] = (),
        robust: Mapping[str, str] | str | PathLike[str] | None = None,
        robust_rows: int = 12,
        robust_by: str = "mean+3sigma",
        method: str | None = None,
        budget: int | str | None = None,
        level: str = "full",
        seed: int = 0,
        folder: str | PathLike[str] | None = None,
        workers: int | None = None,
        scheduler: str | None = None,
        tls: Mapping[str, str | PathLike[str]] | None = None,
        pair: int | str = 0,
        source: str | None = None,
        progress: Progress = silent,
    ) -> Optimum:
        """Find the values of keys at which figures are best, within limits and over errors of assembly and flanks.

        Parameters
        ----------
        vary : mapping of str to str or list
            Dotted keys with a range "low:high", or with a list or a text "a,b,c" of values.
        minimize, maximize : str or sequence of str
            Figures that `study` records, with torques under load: `te_peak_to_peak@50,100:mean` is the mean over both torques,
            and ":max" (of `maximize` ":min") the worst, which is the default. Two or three figures make a front.
        subject : sequence of str
            Limits of figures, as `contact_ratio>1.2` or `max_pressure@100<1500`.
        robust : mapping of str to str, or str or os.PathLike, optional
            Errors of every design: distributions as `study` takes them, also "class:6", or lists "a,b,c", of which all
            combinations count. The error of a varied key is added to its value.
        robust_rows : int
            Number of rows drawn from distributions, the same for all designs.
        robust_by : str
            "worst", or "mean+3sigma" with any number of standard deviations: what counts of a figure over the errors.
        method : str, optional
            "cobyqa", for ranges of real numbers, or "evolution", for whole numbers and lists, too.
        budget : int or str, optional
            Number of designs, or a time, as "10min"; by default 100 designs.
        level : str
            Model of contact under load in the search: "full", or "quick"; the full model confirms the best design.
        seed : int
            Seed of samples, errors and evolution.
        folder : str or os.PathLike, optional
            Folder for evaluated designs; after a stop, the same call continues, and other objectives use them again.
        workers : int, optional
            Number of processes on this machine; by default one for each core. A calling script must be importable, with
            `if __name__ == "__main__"`.
        scheduler : str, optional
            Address of a Dask scheduler, whose workers compute the designs.
        tls : mapping of str to str or os.PathLike, optional
            Files "ca_file", "client_cert" and "client_key" for a scheduler at "tls://..."; by default from the configuration of
            Dask.
        pair : int or str
            Number of the mesh, or its members as "sun-planet_1".
        source : str, optional
            Text of the design's file, whose comments the file of the best design keeps.
        progress : callable, optional
            Function of the progress (0 to 1) and the best value so far.

        Returns
        -------
        Optimum
            Best design, front, sensitivities, and all designs.

        Raises
        ------
        DesignError
            For keys that cannot be varied, and for unknown figures.
        NoSolutionError
            If the design itself, or every design of the first sample, has no contact.
        OutputError
            For a folder with another optimisation.

        Examples
        --------
        >>> vary = {"pinion.modifications.profile_crowning": "1um:20um"}
        >>> optimum = gears.optimize(vary, "mesh_te_estimate", budget=6, workers=1)
        >>> list(optimum.values)
        ['pinion.modifications.profile_crowning']
        """
        from gearmesh.optimize.optimize import optimize, task_of
        from gearmesh.study.runners import Scheduler
        from gearmesh.study.study import refuse_workers

        # refuse wrong arguments before anything is built
        cluster = Scheduler.at(scheduler, tls)
        refuse_workers(workers)
        self.names.pair_number(pair)
        least, most = ([each] if isinstance(each, str) else list(each) for each in (minimize, maximize))
        task = task_of(
            self.design,
            vary,
            least,
            most,
            subject,
            robust,
            robust_rows,
            robust_by,
            method,
            budget,
            seed,
            pair,
            level,
        )
        return optimize(task, folder, workers, cluster, source, progress)

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
        """Return all results of the gears as one HTML page that needs no network, with a view that turns and rolls.

        The page of a gear without a mating gear has its solid, workshop drawing, limits and data sheet.

        Parameters
        ----------
        tolerance : float or str, optional
            Tolerance of the shown meshes, mm, or with a unit; by default 0.01 mm.
        check : bool
            True to check meshes and contact, with the verdicts on the page.
        source : str, optional
            Text of the design's file.
        studies : sequence of str or os.PathLike
            Folders of finished studies.
        torque : array_like, optional
            One or several torques, Nm, on the first pair's pinion; adds loaded contact of all different pairs.
        progress : callable, optional
            Function of the progress (0 to 1) and the name of the stage.

        Returns
        -------
        ReportPage
            `save("report.html")` writes it.

        Raises
        ------
        NoSolutionError
            If a pair has no contact at any position.
        OutputError
            For a folder without a study.
        DesignError
            For a torque without a mating gear.

        Examples
        --------
        >>> gears.report(0.05).save("report.html").name
        'report.html'
        """
        from gearmesh.answers.load.loaded import required_torques
        from gearmesh.answers.questions import loaded_meshes
        from gearmesh.reports.report import SHOWN_TOLERANCE_MM, report_page, study_section
        from gearmesh.view.load.loaded_pictures import LoadedPictures

        # refuse wrong arguments before anything is solved
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

    def explore(self, port: int = 0, *, browser: bool = True) -> Explorer:
        """Open a page in the browser on which gears and figures follow each changed key; needs `pip install "gearmesh[explore]"`.

        Parameters
        ----------
        port : int
            Port on this machine, or 0 for any free one.
        browser : bool
            Open the page in the browser.

        Returns
        -------
        Explorer
            The running page: its address, `wait()` and `close()`. As a context manager it closes itself.

        Raises
        ------
        DesignError
            For a port that is in use.
        OutputError
            Where the server library is not installed.

        Examples
        --------
        >>> with gears.explore(browser=False) as page:
        ...     page.url.startswith("http://127.0.0.1:")
        True
        """
        from gearmesh.explore.explorer import explore

        return explore(self.design, port, browser=browser)

    def compare(
        self,
        other: Gears,
        *,
        torque: ArrayLike | None = None,
        errors: Mapping[str, str | Sequence[float | int | str | bool]] | None = None,
    ) -> ReportPage:
        """Return the page that has these gears beside others: figures with their change, keys that differ, patterns.

        Parameters
        ----------
        other : Gears
            The other gears; meshes are compared by their order. Another kind is compared by what both have.
        torque : array_like, optional
            Torques, Nm, on the pinion of the first mesh: adds transmission error, pressure and root stress under load.
        errors : mapping of str to str or list, optional
            Values of one or two errors of assembly, as for `study`: adds the patterns of the first mesh at each of them.

        Returns
        -------
        ReportPage
            `save("comparison.html")` writes it.

        Raises
        ------
        NoSolutionError
            If either has no mesh, or a pair has no contact at any position.

        Examples
        --------
        >>> gears.compare(gears).save("comparison.html").name
        'comparison.html'
        """
        from gearmesh.answers.load.loaded import required_torques
        from gearmesh.reports.comparison import comparison_page

        # refuse wrong arguments before anything is solved
        torques = None if torque is None else required_torques(number_list("torque", torque, "Nm").tolist())
        if errors is not None and not 1 <= len(errors) <= 2:
            raise ArgumentError("errors", entry=", ".join(errors), must_be="values of one or two keys")
        both = (self, other)
        studies = None if errors is None else [gears.study(errors, record="path", workers=1) for gears in both]
        contacts = [{k: gears.contact(pair=k) for k in gears.train.different} for gears in both]
        loaded = None if torques is None else [gears.loaded_contact(torques) for gears in both]
        return comparison_page(
            both,
            (contacts[0], contacts[1]),
            None if loaded is None else (loaded[0], loaded[1]),
            None if studies is None else (studies[0], studies[1]),
        )

    # ---------------------------------------------------------------- the main job

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
        """Do the main job: write solids, contact, roll test, plots and pictures to a folder, with a report.

        Parameters
        ----------
        folder : str or os.PathLike
            Folder of the files.
        tolerance : float or str, optional
            Tolerance of the meshes, mm, or with a unit; by default the design's.
        progress : callable, optional
            Function of the progress (0 to 1) and the name of the stage.
        timing : bool
            True for run times in the report.
        page : bool
            True for a report.html.
        source : str, optional
            Text of the design's file, for report.html.
        torque : array_like, optional
            One or several torques, Nm, on the pinion of the first mesh. Adds loaded contact, in loaded.json and under the report's
            key "loaded"; for gear sets also of every different mesh, under "loaded_meshes".

        Returns
        -------
        Report
            Files and figures.

        Raises
        ------
        NoSolutionError
            If no position has contact.

        Examples
        --------
        >>> gears.run("out", 0.05, page=False).skipped  # None where pictures could be drawn
        """
        from gearmesh.reports.run import run

        return run(self, Path(folder), self.within(tolerance), progress, timing, page, source, torque)


@checks_arguments_with(design="gm.load reads a file, gm.parse a mapping")
def build(design: Design, *, alone: bool = False) -> Gears:
    """Build the gears of a design.

    Parameters
    ----------
    design : Design
        Design of any kind, from `load`, `parse` or its class.
    alone : bool
        True to build members on first use, independent members separately. Errors of members and of the pair are raised then.

    Returns
    -------
    Gears
        The exact teeth of all members, and the answers to all questions.

    Raises
    ------
    DesignError
        With key, value and limit, for geometry that cannot exist, and for an argument that is no design.

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
