"""Gears built from a design: the one object from which everything else is asked."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.design.core import Design
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.rigid import Rigid
from gearmesh.lengths import Length, in_mm, tolerance_in_mm
from gearmesh.systems import system as systems
from gearmesh.teeth.train import GearPair, Member, Train

if TYPE_CHECKING:
    from gearmesh.api.cad import Cad
    from gearmesh.api.check import Check, RollTest
    from gearmesh.api.contact import Contact
    from gearmesh.api.ease_off import EaseOffMap
    from gearmesh.api.finite_elements import FiniteElementDecks, FiniteElements
    from gearmesh.api.largest_errors import LargestErrors
    from gearmesh.api.limits import Limits
    from gearmesh.api.loaded import LoadedContact
    from gearmesh.api.picture import Animation, Diagram, Picture
    from gearmesh.api.pinned import Pinned
    from gearmesh.api.report import ReportPage
    from gearmesh.api.run import Report
    from gearmesh.api.section import Section
    from gearmesh.api.settings import Compensation, DesignSheet
    from gearmesh.api.solid import Solid, Solids
    from gearmesh.api.study import Study
    from gearmesh.api.topography import FlankTopography
    from gearmesh.api.vh import VHCheck
    from gearmesh.loaded.mounts import FlexibleMount
    from gearmesh.mesh.triangles import TriangleMesh

#: Told how far a long piece of work is (0 to 1) and what it is doing.
Progress = Callable[[float, str], None]


def _silent(fraction: float, doing: str) -> None:
    """Nobody wants to know how far the work is."""


class PartsAlone(Mapping[str, systems.ToolPart]):
    """The members of a design by their names, each built when it is asked for, without the others."""

    def __init__(self, design: Design) -> None:
        self._design = design
        self._known: dict[str, systems.ToolPart] = {}

    def __getitem__(self, name: str) -> systems.ToolPart:
        if name not in self:
            raise KeyError(name)
        if name not in self._known:
            self._known[name] = systems.member(self._design, name)
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        return name in systems.system(self._design.kind).members

    def __iter__(self) -> Iterator[str]:
        return iter(systems.system(self._design.kind).members)

    def __len__(self) -> int:
        return len(systems.system(self._design.kind).members)


class MembersAlone(Mapping[str, Member]):
    """The same without their warnings."""

    def __init__(self, parts: PartsAlone) -> None:
        self._parts = parts

    def __getitem__(self, name: str) -> Member:
        return self._parts[name].member

    def __contains__(self, name: object) -> bool:
        return name in self._parts

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)


class Gears:
    """The gears of a design: exact teeth of all members, where they stand, and which pairs of them mesh.

    Nothing is computed before it is asked for. Angles are in deg, torques in Nm, lengths in mm, as in the results, or texts with
    their unit, as "10um" or "0.5in".
    """

    def __init__(self, design: Design, train: Train | None = None) -> None:
        """Without the `train` of the design it is built when it is asked for, and members that do not need each other are built one
        without the other."""
        self._design, self._train = design, train

    @property
    def design(self) -> Design:
        """The design; defaults that only geometry knows are filled in where the whole train has been built."""
        return self._design

    @property
    def train(self) -> Train:
        """All members and the pairs that mesh. Raises as `build` where it is still to be built."""
        if self._train is None:
            self._design = systems.completed(self._design)
            self._train = systems.build(self._design)
        return self._train

    @cached_property
    def members(self) -> Mapping[str, Member]:
        """Members by their names: exact tooth surfaces, blank, mounting."""
        return self.train.members if self._parts is None else MembersAlone(self._parts)

    @cached_property
    def _parts(self) -> PartsAlone | None:
        """Members that are built one without the other, None where the train is there, or the kind has none."""
        alone = self._train is None and systems.system(self.design.kind).members
        return PartsAlone(self.design) if alone else None

    @property
    def pairs(self) -> tuple[GearPair, ...]:
        """The pairs of members that mesh."""
        return self.train.pairs

    @property
    def warnings(self) -> tuple[str, ...]:
        """What to know of the geometry, one line each; of members that are built alone their solids tell their own."""
        return self.train.warnings if self._parts is None or self._train is not None else ()

    @property
    def title(self) -> str:
        """Name of the design, by which pictures are called, or its kind."""
        return self.design.name or self.design.kind

    def __repr__(self) -> str:
        members = ", ".join(f"{name} {member.tooth.teeth}" for name, member in self.members.items())
        return f"<Gears: {self.title}, teeth {members}>"

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if not name.startswith("_")]

    # ---------------------------------------------------------------- contact

    def contact(
        self,
        phi1: ArrayLike | None = None,
        *,
        torque: float | None = None,
        load_sharing: bool = False,
        cycle: bool = True,
        turns: bool = False,
        pair: int | str = 0,
    ) -> Contact:
        """Tooth contact of a pair: the path of one pair of teeth at `phi1` (P,), deg, and the whole mesh cycle.

        Without `phi1` at the design's positions; with a `torque` (Nm) on the pinion also the Hertz pressure along the path, all
        load on the one pair of teeth or, for `load_sharing`, the share of it that `loaded` gives the pair; without `cycle` the path
        alone. With `turns` also the transmission error over whole turns of eccentric members, until the same teeth meet again.
        `pair`: its number, or its members as "sun-planet_1".
        """
        from gearmesh.api.contact import contact_of

        known = systems.system(self.design.kind).first_order
        return contact_of(
            self.design,
            self.train.pair(pair),
            self.warnings,
            phi1=None if phi1 is None else np.radians(np.atleast_1d(np.asarray(phi1, dtype=float))),
            torque=torque,
            load_sharing=load_sharing,
            cycle=cycle,
            first_order=None if known is None else known(self.design.in_mm()),
            turns=turns,
        )

    def ease_off(self, *, pair: int | str = 0) -> EaseOffMap:
        """How far the pinion's flank stays from the gear's, over its whole face, when the gears turn at their nominal ratio.

        Raises NoSolutionError where the flanks never meet.
        """
        from gearmesh.api.ease_off import ease_off_of

        return ease_off_of(self.design, self.train.pair(pair))

    def loaded(
        self,
        torque: ArrayLike,
        phi1: ArrayLike | None = None,
        *,
        pair: int | str = 0,
        progress: Progress = _silent,
        mounts: Mapping[str, FlexibleMount] | None = None,
        contact: Contact | None = None,
    ) -> LoadedContact:
        """Contact of a pair under one torque or several, Nm, on the pinion: load of every tooth pair, loaded transmission error,
        pressures, stiffness and root stress, at rotations `phi1` (P,), deg, of the pinion, by default 21 in a pitch. In a planetary
        set the torque is that of this mesh alone: of N equal planets the sun has N times as much.

        `mounts`: how shafts and bearings give way, by the members' names, as {"pinion": FlexibleMount.of([2e5, 2e5, 1e5, inf, inf,
        inf])}, in the place of the design's own; displacements are then told, and are part of the transmission error. `contact`:
        the pair's, where it is solved already, whose mesh cycle tells the transmission error without load.

        Raises DesignError for torques that are not above 0 and for eccentric members, NoSolutionError where no teeth touch without
        load.
        """
        from gearmesh.api.fit import fitted_cycle
        from gearmesh.api.loaded import loaded_contact_of, required_torques

        mesh, meshes = self.train.pair(pair), self.train.like(pair)
        one = f"{mesh.name} is one of {meshes} meshes that carry alike: the torque is that of this one alone"
        torques = required_torques(np.atleast_1d(np.asarray(torque, dtype=float)).tolist())
        return loaded_contact_of(
            self.design,
            mesh,
            torques,
            (*self.warnings, one) if meshes > 1 else self.warnings,
            None if phi1 is None else np.radians(np.atleast_1d(np.asarray(phi1, dtype=float))),
            progress,
            cycle=fitted_cycle(mesh)[1] if contact is None else contact.cycle,
            mounts=mounts,
        )

    # ---------------------------------------------------------------- solids

    def solid(
        self,
        member: str,
        tolerance: Length | None = None,
        *,
        teeth: int | None = None,
        file: str | PathLike[str] | None = None,
    ) -> Solid:
        """One member as a watertight mesh within `tolerance` (by default the design's), or its worm as a part ("worm").

        With `teeth` the open surfaces of only so many teeth. Given the `file` that it is meant for, the mesh is proved as that
        will hold it: some formats have single precision. Raises DesignError for a member that there is not.
        """
        from gearmesh.api.solid import member_solid

        part = self._part(member)
        return member_solid(
            self.design,
            part.member,
            self._tolerance(tolerance),
            teeth,
            part.figures,
            (*self.warnings, *part.warnings),
            file,
        )

    def solids(self, tolerance: Length | None = None, *, file: str | PathLike[str] | None = None) -> Solids:
        """All members as watertight meshes, placed as they mesh at phi1 = 0 (fixed frame).

        Raises NoSolutionError where the pair has no contact there.
        """
        from gearmesh.api.solid import Solids

        parts = {name: self.solid(name, tolerance, file=file).moved(place) for name, place in self._places.items()}
        return Solids(self.design, parts, self.warnings)

    def placed(self, meshes: Mapping[str, TriangleMesh]) -> dict[str, TriangleMesh]:
        """Meshes of the members, in their own frames, where they mesh at phi1 = 0 (fixed frame)."""
        return {name: meshes[name].moved(place) for name, place in self._places.items()}

    def cad(self, member: str | None = None, tolerance: Length | None = None) -> Cad:
        """One member as a CAD solid, or all of them placed as they mesh at phi1 = 0, within `tolerance` (mm; 0.0001).

        Raises OutputError where OpenCASCADE is missing, NoSolutionError where the pair has no contact at phi1 = 0.
        """
        from gearmesh.api.cad import Cad, cad_solid
        from gearmesh.cad.brep import TOLERANCE
        from gearmesh.cad.step import require_occ

        require_occ()
        within = self._tolerance(tolerance, TOLERANCE)
        places = {} if member is not None else self._places
        wanted = [self._part(name) for name in ([member] if member is not None else self.members)]
        made = [cad_solid(part.member, within, part.figures) for part in wanted]
        return Cad(
            self.design,
            tuple(part for part, _ in made),
            tuple(places.values()),
            {part.name: found for part, found in made},
            (*self.warnings, *(line for part in wanted for line in part.warnings)),
        )

    def section(self, member: str, z: Length | None = None, tolerance: Length | None = None) -> Section:
        """The transverse section of one member at z (mm, by default mid face), within `tolerance` (mm; 0.0001) of the exact one.

        Raises DesignError for a member that there is not or whose end faces are not planes, and for z beyond its face.
        """
        from gearmesh.api.section import Section
        from gearmesh.cad.brep import TOLERANCE
        from gearmesh.cad.section import member_section

        part = self._part(member)
        # of a double helical member the middle of its first half, where there are teeth
        low, high = part.member.tooth.blank.body.ends
        within = self._tolerance(tolerance, TOLERANCE)
        cut = member_section(part.member, 0.5 * (low + high) if z is None else in_mm("z", z), within)
        return Section(self.design, cut, within, (*self.warnings, *part.warnings))

    def topography(self, member: str, flank: str = "right", tolerance: Length | None = None) -> FlankTopography:
        """All that modifications remove of a "right" or "left" flank, as a grid of amounts.

        `save("right.csv")` writes the file that the key `topography` reads; its flank is within `tolerance` (mm; 1e-5).
        Raises DesignError for a member or flank that there is not, and for flanks that are not modified.
        """
        from gearmesh.api.topography import TOLERANCE, flank_topography

        within = self._tolerance(tolerance, TOLERANCE)
        return flank_topography(self.design, self._member(member), flank, within)

    # ---------------------------------------------------------------- finite elements

    def finite_elements(
        self,
        phi1: float = 0.0,
        *,
        members: Sequence[str] | None = None,
        rotation: float | None = None,
        friction: float = 0.0,
        pair: int | str = 0,
    ) -> FiniteElements:
        """A model of the teeth in mesh at `phi1` (deg), as fine as the design's table fe says, ready to be written or solved.

        `members`: only some of the pair; `rotation` (deg) of the pinion takes the place of the design's torque; `friction`:
        coefficient of Coulomb on the flanks.
        """
        from gearmesh.api.finite_elements import finite_elements_of

        angle = None if rotation is None else float(np.radians(rotation))
        return finite_elements_of(
            self.design, self.train.pair(pair), self.warnings, float(np.radians(phi1)), members, angle, friction
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
        progress: Progress = _silent,
    ) -> FiniteElementDecks:
        """Decks of the same at several `phi1` (deg), written into a folder with a script run.sh that solves them in order.

        `program`: "calculix" or "abaqus". Raises OutputError for a folder that cannot be written.
        """
        from gearmesh.api.finite_elements import finite_element_decks_of

        angle = None if rotation is None else float(np.radians(rotation))
        return finite_element_decks_of(
            self.design,
            self.train.pair(pair),
            Path(folder),
            [float(np.radians(each)) for each in phi1],
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

        Of a train with several meshes all that are different are looked at, or the `pair` asked for alone.
        """
        solids = {name: self.solid(name, tolerance) for name in self.members}
        chosen = self.train.different if pair is None else (pair,)
        return self.checked({k: self.contact(pair=k) for k in chosen}, solids)

    def checked(self, contacts: Mapping[int, Contact], solids: dict[str, Solid]) -> Check:
        """The check of solved contacts, by the numbers of their pairs, and of solids by the names of their members."""
        from gearmesh.api.check import Check, roll_test

        found = [
            Check(
                self.design, {}, roll_test(each.pair, each.path), each.warnings, each.fit, mesh=tuple(each.pair.members)
            )
            for each in contacts.values()
        ]
        warnings = tuple(dict.fromkeys(line for each in found for line in each.warnings))
        return replace(found[0], solids=solids, warnings=warnings, others=tuple(found[1:]))

    def roll(self, contact: Contact) -> RollTest:
        """The roll test of the meshed flanks at positions of a solved contact."""
        from gearmesh.api.check import roll_test

        return roll_test(contact.pair, contact.path)

    def limits(self, land: float = 0.0) -> Limits:
        """Undercut and pointing of all members; `land` in modules is the smallest top land."""
        from gearmesh.api.limits import limits_of

        return limits_of(self.design, self.train, land)

    # ---------------------------------------------------------------- settings

    def sheet(self, *, torque: float | None = None, member: str | None = None) -> DesignSheet:
        """What is derived from the design: the sheet of kinds that have one of their own, else members and pairs.

        With a `torque` (Nm) on the pinion also the forces on the members. Of one `member` what needs no mate: of gears built with
        `alone` no mate is then made. Raises DesignError for kinds that do not know forces, for a member that there is not, and for
        both at once.
        """
        from gearmesh.api.settings import DesignSheet

        if member is not None:
            if torque is not None:
                raise DesignError(f"--torque = {torque:g}: forces need both members; leave --member out")
            return self._member_sheet(member)
        from gearmesh.systems.common.plain_sheet import plain_sheet

        known = systems.system(self.design.kind)
        sheet = (known.sheet or plain_sheet)(self.design, self.train)
        tables = sheet.tables
        if torque is not None:
            if known.forces is None:
                able = [kind for kind in systems.kinds() if systems.system(kind).forces is not None]
                raise DesignError(
                    f"--torque = {torque:g}: the sheet of kind {self.design.kind} has no forces; allowed with {' or '.join(able)}"
                )
            tables = (*tables, known.forces(self.design, torque))
        return DesignSheet(self.design, tables, sheet.values, (*self.warnings, *sheet.warnings), sheet.replaced)

    def _member_sheet(self, name: str) -> DesignSheet:
        """What is derived of one member."""
        from gearmesh.api.settings import DesignSheet
        from gearmesh.systems.common.plain_sheet import member_table

        member, own = self._member(name), systems.system(self.design.kind).member_sheet
        part = systems.ToolPart(member, {}) if self._parts is None else self._parts[name]
        tables = (*(() if own is None else own(self.design, name)), member_table(member))
        left_out = f"{name}: its sheet leaves out what needs a mate: axes, ratio, backlash, contact ratios, forces"
        return DesignSheet(self.design, tables, {}, (*self.warnings, *part.warnings, left_out))

    def pinned(self) -> Pinned:
        """The design with every default and derived value given: it builds the same gears in later versions, to 1e-12 mm."""
        from gearmesh.api.pinned import pinned

        return pinned(self.design, systems.pinned(self.design, self.train))

    def compensate(self, refinish: str | None = None) -> Compensation:
        """Settings that make good the assembly errors of the design, of the member to `refinish` where the kind leaves the choice.

        Raises DesignError for kinds that have none, and for a member that cannot be chosen.
        """
        from gearmesh.api.settings import Compensation

        own = systems.system(self.design.kind)
        if own.compensate is None:
            able = [kind for kind in systems.kinds() if systems.system(kind).compensate is not None]
            raise DesignError(
                f"kind = {self.design.kind}: has no compensating settings; allowed is {' or '.join(able)}"
            )
        if refinish is None:
            return Compensation(self.design, tuple(own.compensate(self.design)), self.warnings)
        if own.refinish is None:
            able = [kind for kind in systems.kinds() if systems.system(kind).refinish is not None]
            raise DesignError(
                f"refinish = {refinish}: the settings of kind {self.design.kind} say which member it is; "
                f"the choice is there for {' or '.join(able)}"
            )
        if refinish not in self.members:
            raise DesignError(f"refinish = {refinish}: must be one of {', '.join(self.members)}")
        return Compensation(self.design, tuple(own.refinish(self.design, refinish)), self.warnings)

    def vh(self, moved: tuple[str, str] = ("V", "H")) -> VHCheck:
        """The V-H check: displacements that bring the contact to toe, middle and heel, on both sides.

        Parameters
        ----------
        moved : two of "V", "H", "J" and "alpha"
            What is displaced: the pinion across both axes, or along its own, the gear along its axis, or the shaft angle. The
            others stay what the design says.

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
        """
        from gearmesh.api.vh import VHCheck

        made = systems.system(self.design.kind).vh
        if made is None:
            able = [kind for kind in systems.kinds() if systems.system(kind).vh is not None]
            raise DesignError(f"kind = {self.design.kind}: has no V-H check; allowed is {' or '.join(able)}")
        own = systems.completed(self.design).in_mm()
        if len({*moved} & {"V", "H", "J", "alpha"}) != 2 or len(moved) != 2:
            raise DesignError(f"--move {','.join(moved)}: allowed are two of V, H, J, alpha, as V,H")
        return VHCheck(self.design, tuple(made(own, self.train, moved)), self.warnings)

    # ---------------------------------------------------------------- pictures

    def picture(
        self,
        view: str = "contact",
        member: str | None = None,
        *,
        phi1: ArrayLike | None = None,
        size: tuple[int, int] | None = None,
        pair: int | str = 0,
        dpi: int = 150,
        note: str = "",
    ) -> Picture | Diagram:
        """A picture, drawn when it is saved: "contact" (path and ellipses on a member's tooth), "pattern" (their union), "gap"
        (the pattern that the roll test finds), "pair" (all in mesh), "section" (the mesh cut open across the teeth), "tool" (a
        member with the tool that generates it, where that stands while it generates the middle of the flank) or "contact_lines"
        (the tool's surface, with the lines along which it touches the tooth at several generating rotations).

        "flank" is a figure of both flanks, of one member or of all, laid into their planes: path, ellipses and pattern, and the
        ease-off of the pinion; "sliding" has its sliding velocity instead; "te" is one of the transmission error,
        "turns" one of that over whole turns of eccentric members.

        At `phi1` (deg), by default the design's positions; `size` in pixels, by default 1600 x 1200, or what a figure needs at
        so many `dpi`; `note` stands beside the design's name.
        Raises DesignError for another view or member, NoSolutionError where there is no contact to show.
        """
        from gearmesh.api.check import roll_test
        from gearmesh.api.picture import FIGURES, VIEWS, Picture
        from gearmesh.view import pictures
        from gearmesh.view.mesh_section import at_middle, mesh_section

        if view not in VIEWS:
            raise DesignError(f"view = {view}: must be one of {', '.join(VIEWS)}")
        gears = self.train.pair(pair)
        name = gears.pinion.name if member is None else member
        if name not in gears.members:
            raise DesignError(f"member = {name}: must be one of {', '.join(gears.members)}")
        title = self.title + (f", {note}" if note else "")
        if view in ("tool", "contact_lines"):
            if phi1 is not None:
                raise DesignError(
                    f"phi1 = {phi1}: the view {view} is of generating, at no position of the mesh; leave phi1 out"
                )
            if view == "contact_lines":
                return Picture(pictures.tool_contact_picture(gears, name, size or pictures.SIZE, title))
            return self._tool_picture(gears, name, size or pictures.SIZE, title)
        contact = self.contact(phi1, cycle=view == "te", turns=view == "turns", pair=pair)
        path = contact.path
        if not path.touching.any():
            raise NoSolutionError("no contact at any position to be shown: ask for another phi1")
        if view in FIGURES:
            return self._figure(view, contact, None if member is None else (name,), title, size, dpi)
        size = size or pictures.SIZE
        if view == "contact":
            return Picture(pictures.contact_picture(gears, name, path, size, title=title))
        if view == "pattern":
            return Picture(pictures.pattern_picture(gears, name, path, size, title=title))
        if view == "gap":
            patches = roll_test(gears, path).patches(gears, name)
            return Picture(pictures.gap_picture(gears, name, path, patches, size, title=title))
        if view == "pair" and len(self.pairs) > 1:
            placed = {name: part.mesh for name, part in self.solids().parts.items()}
            return Picture(pictures.set_picture(gears, placed, size, title))
        meshes = self._meshes(gears)
        if view == "section":
            return Picture(at_middle(mesh_section(gears, meshes, path, size, f"{title}: section")))
        return Picture(pictures.pair_picture(gears, meshes, path, size, title))

    def animation(
        self,
        *,
        phi1: ArrayLike | None = None,
        size: tuple[int, int] = (640, 480),
        pair: int | str = 0,
        note: str = "",
    ) -> Animation:
        """The section through a mesh, rolling through one pitch with the contact moving; drawn when it is saved, as a GIF.

        It goes through the contact in the middle of the positions `phi1` (deg). Raises NoSolutionError where flanks never meet.
        """
        from gearmesh.api.picture import Animation
        from gearmesh.view.mesh_section import mesh_section

        gears = self.train.pair(pair)
        path = self.contact(phi1, cycle=False, pair=pair).path
        title = self.title + (f", {note}" if note else "")
        return Animation(tuple(mesh_section(gears, self._meshes(gears), path, size, title).frames()))

    def _tool_picture(self, gears: GearPair, name: str, size: tuple[int, int], title: str) -> Picture:
        from gearmesh.api.picture import Picture
        from gearmesh.mesh.solid import gear_solid
        from gearmesh.teeth.tool_in_place import tool_in_place
        from gearmesh.view.pictures import WHOLE, tool_picture

        tool, part = tool_in_place(gears.members[name].tooth, gears.flanks[gears.index(name)]), None
        if tool.is_worm:
            worm = self._part("worm")
            assert worm.own_to_tool is not None
            part = gear_solid(worm.member, WHOLE).moved(worm.own_to_tool)
        return Picture(tool_picture(gears, name, tool, part, size, title))

    def _meshes(self, gears: GearPair) -> dict[str, TriangleMesh]:
        """Both members of a pair within the design's tolerance, own frames."""
        from gearmesh.api.solid import member_solid

        return {
            name: member_solid(self.design, each, self._tolerance(None)).mesh for name, each in gears.members.items()
        }

    def _figure(
        self,
        view: str,
        contact: Contact,
        names: tuple[str, ...] | None,
        title: str,
        size: tuple[int, int] | None,
        dpi: int,
    ) -> Diagram:
        from gearmesh.api.picture import Diagram
        from gearmesh.view.flank_diagrams import plot_flanks
        from gearmesh.view.pictures import flank_rows
        from gearmesh.view.plots import plot_transmission_error
        from gearmesh.view.turns_plot import plot_turns

        gears, path = contact.pair, contact.path
        if view == "te":
            what = f"{title}: transmission error"
            return Diagram(
                what,
                lambda file: plot_transmission_error(file, path, contact.cycle, what, gears.slide, size, dpi),
            )
        if (turns := contact.turns) is not None:
            what = f"{title}:\ntransmission error over whole turns"
            return Diagram(what, lambda file: plot_turns(file, turns, what, gears.slide, size, dpi))
        what = f"{title}: contact on the flanks"
        return Diagram(
            what, lambda file: plot_flanks(file, flank_rows(gears, path, names, view == "sliding"), what, size, dpi)
        )

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

        `vary`: by dotted key a list of values or a text "low:high:count" (all combinations are rows), or with `sample` "low:high",
        to be sampled evenly. `tolerance`: by key a text as "normal:0:20um", or a TOML file of them, for `sample` rows by `method`
        (lhs, sobol, random; saltelli, which has N (keys + 2) rows and finds Sobol indices) and `seed`. `record`: groups of figures
        (path, cycle, fit; load, which needs `torque`: one or several, Nm, on the pinion) or names of figures. `limits`: what a
        good row keeps, as "contact_ratio>1". With a `folder` finished rows are kept there, and the same call goes on where it was
        stopped. Work is done in this process, on so many `workers` of this machine (None: as many as are worth it; a script that
        calls this must be importable, with `if __name__ == "__main__"`), or by those of a Dask `scheduler`.

        Raises DesignError for what cannot be varied, NoSolutionError where the design itself has no contact, OutputError for a
        folder with another study.
        """
        from gearmesh.api.study import plan_of, recorded, studied

        plan = plan_of(self.design, vary or {}, tolerance, sample, method, seed)
        torques = None if torque is None else np.atleast_1d(np.asarray(torque, dtype=float)).tolist()
        work, nominal = recorded(self.design, plan.keys, pair, record, torques)
        return studied(self.design, plan, work, nominal, limits, folder, workers, scheduler, progress)

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

        `keys`: dotted keys, or with each how far from the design's own value is looked, as "0.5mm" (1 mm, inch or deg). What fails
        and holds again farther off counts as failing, if 16 steps show it. `torque`: as of `study`, for criteria under load. Raises
        DesignError where a criterion fails for the design itself.
        """
        from gearmesh.api.largest_errors import largest_errors

        torques = None if torque is None else np.atleast_1d(np.asarray(torque, dtype=float)).tolist()
        return largest_errors(self.design, keys, criteria, torque=torques, pair=pair, progress=progress)

    def report(
        self,
        tolerance: Length | None = None,
        *,
        check: bool = False,
        source: str | None = None,
        studies: Sequence[str | PathLike[str]] = (),
        torque: ArrayLike | None = None,
        progress: Progress = _silent,
    ) -> ReportPage:
        """Everything about the gears as one HTML page that needs no network, with a view that turns and rolls.

        `tolerance` (mm; 0.01) is that of the meshes shown; with `check` meshes and contact are checked, and the verdicts in it;
        `source` is the text of the design's file; `studies` are folders of finished ones; with one `torque` or several (Nm) on the
        first pair's pinion the contact of all pairs that differ under load, too. Raises NoSolutionError where a pair has
        no contact at any position, OutputError for a folder without a study.
        """
        from gearmesh.api.loaded import loaded_meshes
        from gearmesh.api.report import SHOWN, report_page

        contacts = {k: self.contact(pair=k) for k in self.train.different}
        verdicts = None
        if check:
            verdicts = self.checked(contacts, {name: self.solid(name) for name in self.members})
        return report_page(
            self,
            contacts,
            self._tolerance(tolerance, SHOWN),
            verdicts,
            None,
            source,
            [Path(each) for each in studies],
            None if torque is None else loaded_meshes(self, torque, contacts, progress),
        )

    # ---------------------------------------------------------------- all of it

    def run(
        self,
        folder: str | PathLike[str],
        tolerance: Length | None = None,
        *,
        progress: Progress = _silent,
        timing: bool = True,
        page: bool = True,
        source: str | None = None,
        torque: ArrayLike | None = None,
    ) -> Report:
        """The main job: solids, contact, roll test, plots and pictures into a folder, and a report of them.

        Without `timing` the run times are left out of the report; without `page` there is no report.html, in which `source` is the
        text of the design's file. With a `torque` or several, Nm, on the pinion of the first mesh also what `loaded` finds, under
        the report's key "loaded" and in loaded.json, and in a set of every mesh that differs, under "loaded_meshes". Raises
        NoSolutionError where no position has contact.
        """
        from gearmesh.api.run import run

        return run(self, Path(folder), self._tolerance(tolerance), progress, timing, page, source, torque)

    # ---------------------------------------------------------------- what these share

    def _tolerance(self, tolerance: Length | None, default: float | None = None) -> float:
        """A tolerance in mm, where none is given the `default`, or the design's."""
        if tolerance is not None:
            return tolerance_in_mm("tolerance", tolerance)
        return self.design.in_mm().mesh.tolerance if default is None else default

    def _part(self, name: str) -> systems.ToolPart:
        """A member, or the worm that grinds one, with its own figures and warnings."""
        if name == "worm" and name not in self.members:
            return systems.worm(self.design)
        member = self._member(name)
        return systems.ToolPart(member, {}) if self._parts is None else self._parts[name]

    def _member(self, name: str) -> Member:
        if name not in self.members:
            raise DesignError(f"member = {name}: must be one of {', '.join(self.members)}")
        return self.members[name]

    @cached_property
    def _places(self) -> dict[str, Rigid]:
        """Own frames of all members to the fixed frame, at the contact of phi1 = 0."""
        from gearmesh.contact.train_turns import leading_turns

        places: dict[str, Rigid] = {}
        turns: dict[str, float] = {}
        for pair in self.pairs:
            if pair.gear.name in places:
                continue
            # a pinion that another pair has placed stands as that has turned it, whole pitches from where its first tooth touches
            turn = turns.get(pair.pinion.name, 0.0)
            rotation, phi2 = (float(each[0]) for each in leading_turns(pair, np.array([turn]), 1 if turn else 0))
            if np.isnan(phi2):
                raise NoSolutionError(
                    f"{pair.pinion.name} and {pair.gear.name} have no contact at phi1 = 0, where they would be put together; "
                    "write each member alone"
                )
            turns.setdefault(pair.pinion.name, rotation)
            turns[pair.gear.name] = phi2
            for member in pair.both:
                places.setdefault(member.name, member.mount.at(turns[member.name]))
        return places


def build(design: Design, *, alone: bool = False) -> Gears:
    """The gears of a design. Raises DesignError, with key, value and limit, for geometry that cannot exist.

    With `alone` nothing is made before it is asked for, and members that do not need each other are made one without the other:
    what is wrong with them, and with the pair, is raised then.
    """
    if alone:
        return Gears(design)
    whole = systems.completed(design)
    return Gears(whole, systems.build(whole))
