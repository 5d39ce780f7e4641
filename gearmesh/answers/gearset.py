"""Gears built from a design: members, their mounting, and the pairs that mesh. All answers are about these gears."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sized
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.arguments import checks_methods
from gearmesh.design.core import Design
from gearmesh.design.shown import html_table
from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.lengths import Length, tolerance_in_mm
from gearmesh.member_names import MemberNames
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.pickling import Picklable
from gearmesh.systems import system as systems
from gearmesh.teeth.carried_body import CarriedBody
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member

#: largest distance of the meshes of bodies without teeth from the exact bodies in pictures
CARRIED_TOLERANCE_MM = 0.01


def number_list(argument: str, values: ArrayLike, unit: str) -> Array:
    """Return the values (N,) of an argument that is one number or several.

    Raises ArgumentError if any value is not a finite number.
    """
    try:
        numbers = np.atleast_1d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise ArgumentError(argument, values, must_be=f"a number in {unit}, or several") from None
    if numbers.ndim > 1 or not np.isfinite(numbers).all():
        raise ArgumentError(argument, values, must_be=f"finite numbers in {unit}, one or several in a row")
    return numbers


#: limit of the positions of one call
MAX_POSITIONS = 100_000
#: largest rotation of the pinion, deg: beyond it angles are rounded by more than 1e-7 deg
MAX_ROTATION_DEG = 1e9


def refuse_rotation(phi1: float) -> None:
    """Raise ArgumentError for a rotation (deg) of the pinion that is no number or too large."""
    if not abs(phi1) <= MAX_ROTATION_DEG:
        raise ArgumentError(
            "phi1", phi1, must_be=f"a finite number of degrees, {MAX_ROTATION_DEG:g} either way at most"
        )


def position_list(phi1: ArrayLike) -> Array:
    """Return rotations (N,) of the pinion, deg. Raises ArgumentError if there is none, or any is invalid."""
    if isinstance(phi1, Sized) and len(phi1) > MAX_POSITIONS:
        raise ArgumentError(
            "phi1", shown=f"{len(phi1)} positions", value=len(phi1), must_be=f"{MAX_POSITIONS} positions at most"
        )
    positions = number_list("phi1", phi1, "deg")
    for end in (positions.min(initial=0.0), positions.max(initial=0.0)):
        refuse_rotation(float(end))
    if not positions.size:
        raise ArgumentError("phi1", [], must_be="one position at least, deg")
    return positions


class SeparateMembers(Mapping[str, Member]):
    """Members of a gear set by their names without their warnings; each is built alone at its first use."""

    def __init__(self, gears: GearSet) -> None:
        self._gears = gears

    def __getitem__(self, name: str) -> Member:
        if name not in self:
            raise KeyError(name)
        return self._gears.part(name).member

    def __contains__(self, name: object) -> bool:
        return name in systems.system_of(self._gears.design).members

    def __iter__(self) -> Iterator[str]:
        return iter(systems.system_of(self._gears.design).members)

    def __len__(self) -> int:
        return len(systems.system_of(self._gears.design).members)


@dataclass(frozen=True)
class StockFigures(Figures):
    """Stock on the flanks of a part."""

    flank_stock: float = figure("stock on the flanks, normal to them", "mm", "q")


@checks_methods
class GearSet(Picklable):
    """The gears of a design: exact teeth of all members, their mounting, and the pairs that mesh.

    Everything is computed at its first use.
    """

    def __init__(self, design: Design, train: GearTrain | None = None) -> None:
        """Keep the design.

        The `train` is built at its first use if it is not given; independent members are built separately.
        """
        self._design, self._train = design, train
        #: design as it was given; members are built of it alone
        self._given = design

    @property
    def design(self) -> Design:
        """The design. When the whole gear set has been built, it contains the defaults that depend on geometry."""
        return self._design

    @property
    def train(self) -> GearTrain:
        """All members and the pairs that mesh, with equal teeth on each member, as most answers assume.

        Raises DesignError if the teeth of a member differ, and the errors of `build` if it is not built yet.
        """
        for member in self.as_built.members.values():
            member.check_alike()
        return self.as_built

    @property
    def as_built(self) -> GearTrain:
        """All members and the pairs that mesh; their teeth may differ.

        Raises the errors of `build` if the gears are not built yet.
        """
        if self._train is None:
            self._design = systems.complete_design(self._design)
            self._train = systems.build(self._design)
        return self._train

    @cached_property
    def members(self) -> Mapping[str, Member]:
        """Members by their names: exact tooth surfaces, blank, mounting."""
        return self.as_built.members if self._alone is None else SeparateMembers(self)

    @cached_property
    def _alone(self) -> dict[str, systems.ToolPart] | None:
        """Members that were built separately; None if the gear set is built, or the kind has no such members."""
        return {} if self._train is None and systems.system_of(self.design).members else None

    @property
    def carried(self) -> Mapping[str, CarriedBody]:
        """Bodies without teeth that turn with a member, by their names, as the output pins of a cycloidal drive."""
        return {body.name: body for body in self.as_built.carried} if self.names.carried else {}

    @property
    def names(self) -> MemberNames:
        """Names of members and pairs; most designs know them before anything is built."""
        known = self.design.member_names if self._train is None else None
        return self.as_built.names if known is None else known

    @property
    def pairs(self) -> tuple[GearPair, ...]:
        """The pairs of members that mesh."""
        return self.train.pairs

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the geometry, one line each; members that are built alone have their own warnings."""
        return self.as_built.warnings if self._alone is None or self._train is not None else ()

    @property
    def title(self) -> str:
        """Title of the design, for pages and pictures."""
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
        """Meshes of the members in mesh at phi1 = 0 (fixed frame), and of bodies without teeth that turn with them.

        Parameters
        ----------
        meshes : mapping of str to TriangleMesh
            Meshes in the members' own frames, mm, by names of members.

        Returns
        -------
        dict of str to TriangleMesh
            The moved meshes.

        Examples
        --------
        >>> list(gears.place({name: gears.solid(name, 0.05).mesh for name in gears.members}))
        ['pinion', 'gear']
        """
        from gearmesh.mesh.turned_blank import blank_mesh
        from gearmesh.teeth.turned_blank import cylinder

        places = self.places
        placed = {name: meshes[name].move(place) for name, place in places.items()}
        for body in self.carried.values():
            placed[body.name] = blank_mesh(cylinder(body), CARRIED_TOLERANCE_MM)[0].move(
                body.place(places[body.member])
            )
        return placed

    def within(self, tolerance: Length | None, default: float | None = None) -> float:
        """A tolerance in mm.

        Parameters
        ----------
        tolerance : float or str or None
            mm, or with a unit.
        default : float, optional
            Tolerance, mm, if none is given; by default the design's.

        Returns
        -------
        float
            mm.

        Raises
        ------
        DesignError
            If it is not a length above 0.

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
            Name, for example "pinion" or "worm".

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
        self.names.refuse_other_member(name)
        if self._alone is None:
            return systems.ToolPart(self.as_built.members[name])
        if name not in self._alone:
            self._alone[name] = systems.member(self._given, name)
        return self._alone[name]

    def stocked_part(self, name: str) -> systems.ToolPart:
        """A part as `part` returns it, with the stock that its key `stock` leaves on the flanks.

        Parameters
        ----------
        name : str
            Name, for example "pinion" or "worm".

        Returns
        -------
        ToolPart
            The member with stock, its figures and warnings.

        Raises
        ------
        DesignError
            For another name, and for stock for which the spaces have no room, with the largest that fits.

        Examples
        --------
        >>> gears.stocked_part("gear").member is gears.member("gear")
        True
        """
        part, stock = self.part(name), self.stock(name)
        if not stock:
            return part
        from gearmesh.teeth.stock import stock_member

        try:
            stocked = stock_member(part.member, stock)
        except ArgumentError as failure:
            raise failure.rename(f"{self.design.table_named(name)}.stock") from failure
        return replace(part, member=stocked, figures=Summary(part.figures, StockFigures(stock)))

    def stock(self, name: str) -> float:
        """Stock on the flanks of a part, as its key `stock` gives it.

        Parameters
        ----------
        name : str
            Name, for example "pinion".

        Returns
        -------
        float
            mm.

        Examples
        --------
        >>> gears.stock("gear")
        0.0
        """
        table = getattr(self.design.in_mm(), self.design.table_named(name), None)
        return float(getattr(table, "stock", 0.0))

    def member(self, name: str) -> Member:
        """A member of the gear set.

        Parameters
        ----------
        name : str
            Name, for example "pinion".

        Returns
        -------
        Member
            Its teeth, in its own frame, and its mounting.

        Raises
        ------
        DesignError
            For a member that does not exist.

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
            Its number, or its members' names in either order, for example "sun-planet_1".

        Returns
        -------
        GearPair
            Its members, their flanks and mounts.

        Raises
        ------
        DesignError
            For a pair that does not exist, and if no members mesh.

        Examples
        --------
        >>> gears.pair("gear-pinion").name
        'pinion-gear'
        """
        self.names.pair_number(which)
        return self.train.pair(which)

    @cached_property
    def places(self) -> dict[str, Rigid]:
        """Transformations from the own frames of all members to the fixed frame, in contact at phi1 = 0.

        Raises NoSolutionError if a pair has no contact there.
        """
        return self.places_at(0.0)

    def places_at(self, phi1: float) -> dict[str, Rigid]:
        """Positions of the members in contact at a rotation of the pinion (fixed frame).

        Parameters
        ----------
        phi1 : float
            Rotation of the first pair's pinion, or of a gear alone, deg.

        Returns
        -------
        dict of str to Rigid
            Transformation from the own frame of each member to the fixed frame.

        Raises
        ------
        DesignError
            For an invalid angle.
        NoSolutionError
            If the pair has no contact there.

        Examples
        --------
        >>> list(gears.places_at(2.0))
        ['pinion', 'gear']
        """
        from gearmesh.contact.engagement.train_turns import leading_turns, train_turns

        refuse_rotation(phi1)
        start = np.radians([phi1])
        places = {member.name: member.mount.at(float(start[0])) for member in self.as_built.unpaired}
        if not self.pairs:
            return places
        # members that another pair has placed keep their rotations; teeth then touch whole pitches away
        first = self.pairs[0]
        turns = train_turns(self.train, first, *leading_turns(first, start))
        for pair in self.pairs:
            for member in pair.both:
                if np.isnan(turns[member.name][0]):
                    raise NoSolutionError(
                        reason=f"{pair.pinion.name} and {pair.gear.name} have no contact at phi1 = {phi1:g}, the position of "
                        "the assembly; write each member on its own"
                    )
                places.setdefault(member.name, member.mount.at(float(turns[member.name][0])))
        return places
