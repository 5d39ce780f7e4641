"""Gears built from a design: members, their mounting, and the pairs that mesh; the subject of all answers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sized
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.arguments import checks_methods
from gearmesh.design.core import Design
from gearmesh.design.shown import html_table
from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.lengths import Length, tolerance_in_mm
from gearmesh.member_names import MemberNames
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.pickling import Picklable
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member


def number_list(argument: str, values: ArrayLike, unit: str) -> Array:
    """Values (N,) of an argument that is a number or several. Raises ArgumentError for what are none, or not finite."""
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise ArgumentError(argument, values, must_be=f"a number in {unit}, or several") from None
    if numbers.ndim > 1 or not np.isfinite(numbers).all():
        raise ArgumentError(argument, values, must_be=f"finite numbers in {unit}, one or several in a row")
    return numbers


#: positions of one call at most
MOST_POSITIONS = 100_000
#: largest rotation of the pinion, deg: beyond it angles are rounded by more than 1e-7 deg
LARGEST_ROTATION = 1e9


def refuse_rotation(phi1: float) -> None:
    """Raise ArgumentError for a rotation (deg) of the pinion that is no number or too large."""
    if not abs(phi1) <= LARGEST_ROTATION:
        raise ArgumentError(
            "phi1", phi1, must_be=f"a finite number of degrees, {LARGEST_ROTATION:g} either way at most"
        )


def position_list(phi1: ArrayLike) -> Array:
    """Rotations (N,) of the pinion, deg, one at least. Raises ArgumentError for none, and as `number_list`."""
    if isinstance(phi1, Sized) and len(phi1) > MOST_POSITIONS:
        raise ArgumentError(
            "phi1", shown=f"{len(phi1)} positions", value=len(phi1), must_be=f"{MOST_POSITIONS} positions at most"
        )
    positions = number_list("phi1", phi1, "deg")
    for end in (positions.min(initial=0.0), positions.max(initial=0.0)):
        refuse_rotation(float(end))
    if not positions.size:
        raise ArgumentError("phi1", [], must_be="one position at least, deg")
    return positions


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
        return name in systems.system_of(self._design).members

    def __iter__(self) -> Iterator[str]:
        return iter(systems.system_of(self._design).members)

    def __len__(self) -> int:
        return len(systems.system_of(self._design).members)


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


@checks_methods
class GearSet(Picklable):
    """The gears of a design: exact teeth of all members, their mounting, and the pairs that mesh.

    Nothing is computed before it is asked for.
    """

    def __init__(self, design: Design, train: GearTrain | None = None) -> None:
        """Without the `train` of the design it is built when it is asked for, and members that do not need each other are built one
        without the other."""
        self._design, self._train = design, train

    @property
    def design(self) -> Design:
        """The design; defaults that only geometry knows are filled in where the whole gear set has been built."""
        return self._design

    @property
    def train(self) -> GearTrain:
        """All members and the pairs that mesh, each of teeth that are alike, as most answers take them to be.

        Raises DesignError where teeth of a member differ, and as `build` where it is still to be built.
        """
        for member in self.as_built.members.values():
            member.check_alike()
        return self.as_built

    @property
    def as_built(self) -> GearTrain:
        """All members and the pairs that mesh, whose teeth may differ. Raises as `build` where it is still to be built."""
        if self._train is None:
            self._design = systems.complete_design(self._design)
            self._train = systems.build(self._design)
        return self._train

    @cached_property
    def members(self) -> Mapping[str, Member]:
        """Members by their names: exact tooth surfaces, blank, mounting."""
        return self.as_built.members if self._parts is None else MembersAlone(self._parts)

    @cached_property
    def _parts(self) -> PartsAlone | None:
        """Members that are built one without the other, None where the gear set is built, or the kind has none."""
        alone = self._train is None and systems.system_of(self.design).members
        return PartsAlone(self.design) if alone else None

    @property
    def names(self) -> MemberNames:
        """Names of members and pairs, which most designs tell before anything is built."""
        known = self.design.member_names if self._train is None else None
        return self.as_built.names if known is None else known

    @property
    def pairs(self) -> tuple[GearPair, ...]:
        """The pairs of members that mesh."""
        return self.train.pairs

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the geometry, one line each; solids of members that are built alone have their own."""
        return self.as_built.warnings if self._parts is None or self._train is not None else ()

    @property
    def title(self) -> str:
        """What heads pages and pictures: the title of the design."""
        return self.design.title

    def __repr__(self) -> str:
        members = ", ".join(f"{name} {member.tooth.teeth}" for name, member in self.members.items())
        return f"<Gears: {self.design.name or self.design.kind_in_words}, teeth {members}>"

    def _repr_html_(self) -> str:
        """The members as a short table, for notebooks."""
        rows = [
            (name, str(member.tooth.teeth), f"{member.extent[1] - member.extent[0]:.6g}")
            for name, member in self.members.items()
        ]
        return html_table(self.title, ("member", "teeth", "length along the axis, mm"), rows)

    def __dir__(self) -> list[str]:
        return [name for name in super().__dir__() if not name.startswith("_")]

    def place(self, meshes: Mapping[str, TriangleMesh]) -> dict[str, TriangleMesh]:
        """Meshes of the members where they mesh at phi1 = 0 (fixed frame).

        Parameters
        ----------
        meshes : mapping of str to TriangleMesh
            In the members' own frames, mm, by their names.

        Returns
        -------
        dict of str to TriangleMesh
            The same, moved.

        Examples
        --------
        >>> list(gears.place({name: gears.solid(name, 0.05).mesh for name in gears.members}))
        ['pinion', 'gear']
        """
        return {name: meshes[name].move(place) for name, place in self.places.items()}

    def within(self, tolerance: Length | None, default: float | None = None) -> float:
        """A tolerance in mm.

        Parameters
        ----------
        tolerance : float or str or None
            mm, or with a unit.
        default : float, optional
            What counts where none is given, mm; by default the design's.

        Returns
        -------
        float
            mm.

        Raises
        ------
        DesignError
            For what is no length above 0.

        Examples
        --------
        >>> gears.within("10um")
        0.01
        """
        if tolerance is not None:
            return tolerance_in_mm("tolerance", tolerance)
        return self.design.in_mm().mesh.tolerance if default is None else default

    def part(self, name: str) -> systems.ToolPart:
        """A member, or the worm that grinds one, with its own figures and warnings.

        Parameters
        ----------
        name : str
            As "pinion", or "worm".

        Returns
        -------
        ToolPart
            The member, its figures and warnings.

        Raises
        ------
        DesignError
            For another name.

        Examples
        --------
        >>> gears.part("gear").member.name
        'gear'
        """
        if name == "worm" and name not in self.members:
            return systems.worm(self.design)
        member = self.member(name)
        return systems.ToolPart(member) if self._parts is None else self._parts[name]

    def member(self, name: str) -> Member:
        """A member of the gear set.

        Parameters
        ----------
        name : str
            As "pinion".

        Returns
        -------
        Member
            Its teeth, in its own frame, and how it is mounted.

        Raises
        ------
        DesignError
            For one that there is not.

        Examples
        --------
        >>> gears.member("pinion").tooth.teeth
        18
        """
        self.names.refuse_other_member(name)
        return self.members[name]

    def pair(self, which: int | str = 0) -> GearPair:
        """A pair of members that mesh.

        Parameters
        ----------
        which : int or str
            Its number, or its members' names in either order, as "sun-planet_1".

        Returns
        -------
        GearPair
            Its members, their flanks and mounts.

        Raises
        ------
        DesignError
            For another, and where no members mesh.

        Examples
        --------
        >>> gears.pair("gear-pinion").name
        'pinion-gear'
        """
        self.names.pair_number(which)
        return self.train.pair(which)

    @cached_property
    def places(self) -> dict[str, Rigid]:
        """Own frames of all members to the fixed frame, at the contact of phi1 = 0.

        Raises NoSolutionError where a pair has none there.
        """
        return self.places_at(0.0)

    def places_at(self, phi1: float) -> dict[str, Rigid]:
        """Where the members are at a contact (fixed frame).

        Parameters
        ----------
        phi1 : float
            Rotation of the first pair's pinion, or of a gear alone, deg.

        Returns
        -------
        dict of str to Rigid
            From the own frame of each member to the fixed one.

        Raises
        ------
        DesignError
            For what is no angle.
        NoSolutionError
            Where the pair has no contact there.

        Examples
        --------
        >>> list(gears.places_at(2.0))
        ['pinion', 'gear']
        """
        from gearmesh.contact.engagement.train_turns import leading_turns

        refuse_rotation(phi1)
        start = float(np.radians(phi1))
        places = {member.name: member.mount.at(start) for member in self.as_built.unpaired}
        turns: dict[str, float] = {}
        for pair in self.pairs:
            if pair.gear.name in places:
                continue
            # a pinion that another pair has placed stands as that has turned it, whole pitches from where its first tooth touches
            turn = turns.get(pair.pinion.name, start)
            rotation, phi2 = (
                float(leading_turn[0]) for leading_turn in leading_turns(pair, np.array([turn]), 1 if turn else 0)
            )
            if np.isnan(phi2):
                raise NoSolutionError(
                    reason=f"{pair.pinion.name} and {pair.gear.name} have no contact at phi1 = {phi1:g}, the position of "
                    "the assembly; write each member on its own"
                )
            turns.setdefault(pair.pinion.name, rotation)
            turns[pair.gear.name] = phi2
            for member in pair.both:
                places.setdefault(member.name, member.mount.at(turns[member.name]))
        return places
