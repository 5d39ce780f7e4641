"""What a design is built into: members, each with its own axis, and the pairs of them that mesh."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.figures import Figures
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL, Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.features import BodyFeatures, Boss, ClosedLine, Drilling, Opening, Slot
from gearmesh.teeth.blank.halves import SINGLE_ROW, AxialGap, HalfGear, Rows
from gearmesh.teeth.micro_geometry.index_angles import EVEN, IndexAngles
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import (
    BAR_REGIONS,
    BODY_REGIONS,
    FEATURE_REGIONS,
    GAP_REGIONS,
    RARE_REGIONS,
    Region,
    Side,
)
from gearmesh.teeth.tooth import Tooth

#: Surface parameters (p, v) (...,) of a flank -> values named and counted as in the source (angles in degrees)
SourceParameters = Callable[[Array, Array], dict[str, Array]]

#: how far (mm) teeth that differ may be from each other where they begin at the root
SEAM = 1e-9


@dataclass(frozen=True)
class Member:
    """One member of a gear set: its tooth in its own frame (axis z, tooth centred on x), its mounting, its body's features.

    `tool_parameters`: those of the flanks as the tools leave them, where they were modified since; `rows`: how many
    rows of teeth there are, of which `tooth` is of the first; `overhang` (mm): how far a rack goes on beyond its last pitch, at
    either end; `others`: teeth that differ from `tooth`, by their numbers: 0 is on +x, they are counted as the joint's angle
    grows, in every row alike; `index`: how far their flanks are ahead of their places, counted likewise; `idler`: it passes torque
    on from one mesh to another, and none to its bore.

    Raises DesignError for other teeth that do not fit between their neighbours, and for index angles of another number of teeth.
    """

    name: str
    tooth: Tooth
    source_parameters: SourceParameters
    features: BodyFeatures = field(default_factory=BodyFeatures)
    mount: Mount = field(default_factory=lambda: Mount(Rigid.identity()))
    tool_parameters: SourceParameters | None = None
    rows: Rows = SINGLE_ROW
    overhang: float = 0.0
    others: Mapping[int, Tooth] = field(default_factory=dict, hash=False)
    index: IndexAngles = EVEN
    idler: bool = False

    def __post_init__(self) -> None:
        self.index.check(self.name, self.tooth.teeth)
        if not self.others:
            return
        self.check_teeth(self.others)
        if self.tooth.joint.travel is not None:
            raise DesignError(self.name, reason="the teeth of a rack cannot differ", allowed="gears whose teeth differ")
        for number, tooth in self.others.items():
            mismatch = _mismatch(tooth, self.tooth)
            if mismatch:
                raise DesignError(
                    self.name,
                    reason=f"tooth {number} cannot be beside the others: {mismatch}",
                    allowed="other flanks only",
                )

    def check_teeth(self, numbers: Iterable[int]) -> None:
        """Refuse numbers that no tooth has.

        Parameters
        ----------
        numbers : iterable of int
            0 is the tooth on the x axis, they are counted by growing polar angle.

        Raises
        ------
        DesignError
            Naming the first of them.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.check_teeth([0, 17])
        """
        places = self.tooth.joint.places(self.tooth.teeth)
        for number in numbers:
            if number not in places:
                raise ArgumentError("tooth", number, must_be=f"from {places[0]} to {places[-1]} for the {self.name}")

    def tooth_at(self, number: int) -> Tooth:
        """The tooth of a number.

        Parameters
        ----------
        number : int
            0 is on the x axis, counted by growing polar angle.

        Returns
        -------
        Tooth

        Raises
        ------
        DesignError
            Where none has it.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.tooth_at(3) is pinion.tooth
        True
        """
        self.check_teeth([number])
        return self.others.get(number, self.tooth)

    @property
    def one_tooth(self) -> Tooth:
        """The tooth that all are. Raises DesignError where they differ."""
        self.check_alike()
        return self.tooth

    def check_alike(self) -> None:
        """Refuse teeth that differ.

        Raises
        ------
        DesignError
            Where some do, with what can be asked of them.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.check_alike()
        """
        if self.others:
            raise DesignError(
                self.name,
                reason=f"some of its teeth differ ({', '.join(map(str, sorted(self.others)))}), as they may for its "
                "solid and its section alone",
                remedy=f'for all else choose one tooth for all, as with_teeth_like("{self.name}", {min(self.others)})',
            )

    @property
    def different_teeth(self) -> tuple[Tooth, ...]:
        """Every different tooth once, in the order of their first numbers."""
        return tuple({id(tooth): tooth for tooth in self._row}.values())

    @property
    def order(self) -> NDArray[np.int64]:
        """For all teeth by their numbers, (teeth,), which of the different ones they are."""
        kinds = [id(tooth) for tooth in self.different_teeth]
        return np.array([kinds.index(id(tooth)) for tooth in self._row], dtype=np.int64)

    @property
    def _row(self) -> list[Tooth]:
        """All teeth by their numbers."""
        return [self.others.get(k, self.tooth) for k in self.tooth.joint.places(self.tooth.teeth).tolist()]

    def with_teeth(self, teeth: Mapping[int, Tooth]) -> Member:
        """The member with other teeth of some numbers.

        Parameters
        ----------
        teeth : mapping of int to Tooth
            By their numbers.

        Returns
        -------
        Member

        Raises
        ------
        DesignError
            For numbers that no tooth has, and teeth that do not fit the member.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.with_teeth({3: pinion.tooth.unmodified_tooth}).others.keys()
        dict_keys([3])
        """
        return replace(self, others={**self.others, **teeth})

    def with_tooth(self, tooth: Tooth) -> Member:
        """The member with all teeth alike.

        Parameters
        ----------
        tooth : Tooth
            All of them are as this one.

        Returns
        -------
        Member

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.with_tooth(pinion.tooth).others
        {}
        """
        return replace(self, tooth=tooth, others={})

    def with_teeth_like(self, number: int) -> Member:
        """The member with all teeth as its tooth of a number.

        Parameters
        ----------
        number : int
            As of `tooth_at`.

        Returns
        -------
        Member

        Raises
        ------
        DesignError
            Where no tooth has it.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.with_teeth_like(3).tooth is pinion.tooth
        True
        """
        return self.with_tooth(self.tooth_at(number))

    def is_shaped_as(self, other: Member) -> bool:
        """Whether both are the same but for name and mounting, as the planets of a set are.

        Parameters
        ----------
        other : Member

        Returns
        -------
        bool

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.is_shaped_as(gears.members["gear"])
        False
        """
        return all(
            own is theirs or (name != "tooth" and own == theirs)
            for name, own, theirs in ((f.name, getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
            if name not in ("name", "mount")
        )

    @property
    def halves(self) -> tuple[HalfGear, ...]:
        """Every row of its teeth: both halves of a double helical member, or the only one."""
        return self.rows.halves

    @property
    def gaps(self) -> tuple[AxialGap, ...]:
        """What is between halves that do not meet."""
        return self.rows.gaps

    @property
    def extent(self) -> tuple[float, float]:
        """First and last station (mm) of the whole."""
        return self.rows.extent(self.tooth.blank.faces)

    @property
    def plain_body(self) -> Body:
        """The body under the teeth, of both halves if there are two, without the hub."""
        return self.rows.body(self.tooth.blank.body)

    @property
    def body(self) -> Body:
        """The body under the teeth, with hubs, shafts and steps of the bore."""
        return self.features.turn(self.plain_body)

    @property
    def turned_body(self) -> Body | None:
        """The same where it is of revolution, under one row of teeth; None of the bar of a rack and of two rows."""
        return None if self.tooth.joint.travel is not None or len(self.halves) > 1 else self.body

    @property
    def keyway(self) -> Slot | None:
        """The keyway in its bore."""
        return self.features.keyway

    @property
    def hub(self) -> Boss | None:
        """The hub on its heel."""
        return self.features.hub

    @property
    def holes(self) -> Drilling | None:
        """The holes that lighten it."""
        return self.features.holes

    @property
    def flat_ends(self) -> bool:
        """Whether the teeth end on planes."""
        return station_normal(self.tooth.blank.axial)[0] == 0.0

    @property
    def openings(self) -> tuple[Opening, ...]:
        """What is cut out of its body along the axis, but for bore and keyway."""
        return self.features.openings(self.body, self.flat_ends)

    @property
    def prisms(self) -> tuple[tuple[ClosedLine, float, float], ...]:
        """Outlines of all that is cut along the axis out of its turned body, each between two z (mm); of a keyway without the
        bore."""
        cuts = [(opening.curves, opening.low, opening.high) for opening in self.openings]
        if self.keyway is not None:
            band = self.body.bore_band
            (radius, low), (_, high) = self.body.profile[band : band + 2]
            arc, *sides = self.keyway.in_bore(radius)
            assert isinstance(arc, PlaneArc)
            mouth = PlaneArc(arc.centre, radius, arc.first, arc.width - 2.0 * np.pi)
            cuts.append(((*sides, mouth), low, high))
        return tuple(cuts)

    @property
    def genus(self) -> int:
        """Number of holes through the whole."""
        return self.plain_body.genus + sum(opening.floor is None for opening in self.openings)

    @property
    def body_regions(self) -> tuple[Region, ...]:
        """Regions of the body in the order of the files."""
        if self.tooth.joint.travel is not None:
            return BAR_REGIONS if self.features.row is None else (*BAR_REGIONS, self.features.row.region)
        features = self.features.rare_regions
        gaps = features or self.gaps
        rare = gaps or self.holes is not None or self.plain_body.web is not None
        lists = ((rare, RARE_REGIONS), (gaps, GAP_REGIONS), (features, FEATURE_REGIONS))
        return (*BODY_REGIONS, *(region for there, regions in lists if there for region in regions))

    @property
    def repeated_regions(self) -> tuple[Region, ...]:
        """Regions of the tooth that look alike on every tooth: of a bar all but the root, which goes on beyond the last."""
        regions = self.tooth.regions
        return (
            regions if self.tooth.joint.travel is None else tuple(name for name in regions if name is not Region.ROOT)
        )

    def plain_volume(self) -> float:
        """Volume of teeth and body, of both halves if there are two, without the features of the body.

        Returns
        -------
        float
            mm^3.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> round(pinion.plain_volume())
        8790
        """
        shares = np.bincount(self.order) / self.tooth.teeth
        half = float(shares @ [tooth.volume() for tooth in self.different_teeth])
        if self.overhang:
            (back, low), (_, high) = self.tooth.blank.body.profile
            section = (float(self.tooth.blank.root.at(0.0)) - back) * (high - low)
            section -= sum(end.area for end in self.tooth.blank.ends if end is not None)
            half += 2.0 * self.overhang * section
        return self.rows.volume(half, self.tooth.blank.body)


def _mismatch(tooth: Tooth, nominal: Tooth) -> str:
    """Why a tooth cannot be beside a nominal one; empty where it can."""
    if tooth.teeth != nominal.teeth:
        return f"it is one of {tooth.teeth} teeth, they of {nominal.teeth}"
    for name in ("joint", "blank"):
        own, theirs = getattr(tooth, name), getattr(nominal, name)
        if own is not theirs and own != theirs:
            return f"its {name} is another"
    if tooth.regions != nominal.regions:
        return "it has other surfaces beside flanks and fillets"
    apart = float(np.linalg.norm(tooth.root_ends - nominal.root_ends, axis=-1).max())
    return "" if apart <= SEAM else f"it begins {apart:.3g} mm beside them at the root"


@dataclass(frozen=True)
class GearPair:
    """Two members that mesh, and on which flanks.

    `pinion` is the member whose rotation phi1 counts, `gear` the one that it drives; `flanks` names the touching side of
    either; `drive` is +1 where contact pushes the gear towards larger phi2, -1 towards smaller; `ratio` is the nominal
    d phi2 / d phi1; `delta` (mm) is the marking-compound thickness; `generation` gives, for pinion surface parameters, the
    generation angle (rad) where the source counts phi1 by it, None where phi1 is the rotation. `figures`
    are the gear system's figures of the pair beside its contact.
    """

    pinion: Member
    gear: Member
    flanks: tuple[Side, Side]
    drive: int
    ratio: float
    delta: float
    generation: Callable[[Array, Array], Array] | None = None
    figures: Figures | None = None

    @property
    def eccentric(self) -> bool:
        """Whether a member turns about another axis than its own, so that no two tooth pairs are alike."""
        return any(member.mount.eccentricity != (0.0, 0.0) for member in self.both)

    @property
    def uneven(self) -> bool:
        """Whether teeth of a member have pitch deviations, so that no two tooth pairs are alike."""
        return any(member.index.uneven for member in self.both)

    @property
    def both(self) -> tuple[Member, Member]:
        return self.pinion, self.gear

    @property
    def images(self) -> tuple[Rigid, ...]:
        """For every half, of the pair as of both members, how the first is brought there in the fixed frame: reflected in the
        pinion's plane of symmetry."""
        base = self.pinion.mount.base
        further = zip(self.pinion.halves[1:], self.gear.halves[1:], strict=False)
        return (Rigid.identity(), *(base @ half.motion @ base.inverse for half, _ in further))

    @property
    def halves(self) -> tuple[GearPair, ...]:
        """The pair of the first halves, and after it those of others, seen in their images: as pairs of the same teeth."""
        mount = self.gear.mount
        further = zip(self.images[1:], self.gear.halves[1:], strict=False)
        mounts = [replace(mount, base=image @ mount.base @ half.motion) for image, half in further]
        return (self, *(replace(self, gear=replace(self.gear, mount=own)) for own in mounts))

    @property
    def name(self) -> str:
        """Names of both, as "sun-planet_1"."""
        return f"{self.pinion.name}-{self.gear.name}"

    @property
    def members(self) -> dict[str, Member]:
        """Both by their names, the pinion first."""
        return {member.name: member for member in self.both}

    @property
    def mounts(self) -> tuple[Mount, Mount]:
        return self.pinion.mount, self.gear.mount

    def middle(self, member: Member) -> float:
        """Middle of the working flank of a member, half way up, of all halves together.

        Parameters
        ----------
        member : Member
            One of the pair's.

        Returns
        -------
        float
            Place along its axis, mm, in the member's own frame.

        Examples
        --------
        >>> pair = gears.train.pair(0)
        >>> round(pair.middle(pair.gear), 9)
        0.0
        """
        side = self.flanks[0] if member is self.pinion else self.flanks[1]
        ends = member.tooth.flank_grid(side, np.array([0.5]), np.array([0.0, 1.0])).points[0]
        return float(np.mean([half.points(ends)[:, 2] for half in member.halves]))

    @property
    def shaft_angle(self) -> float:
        """Angle between the axes, rad, 0 to pi, counted as for bevel gears; 0 where they are parallel, whichever way they point.

        It is the angle between the axes taken in the senses that would lie together if the members, meshing from outside on
        parallel axes, turned against each other.
        """
        first, second = (mount.sign * mount.axis for mount in self.mounts)
        across = float(np.linalg.norm(np.cross(first, second)))
        return float(np.arctan2(across, -(first @ second))) if across > MAX_SINE_OF_PARALLEL else 0.0

    @property
    def acute_angle(self) -> float:
        """Acute angle between the axes, rad."""
        return min(self.shaft_angle, np.pi - self.shaft_angle)

    @property
    def output(self) -> Joint:
        """The joint that the gear moves in with phi2."""
        return self.gear.mount.joint

    @property
    def pitch(self) -> float:
        """Angular pitch of the pinion, rad: phi1 between neighbouring tooth pairs."""
        return self.pinion.tooth.pitch_angle

    def index(self, name: str) -> int:
        """Number of a member by its name.

        Parameters
        ----------
        name : str

        Returns
        -------
        int
            0 for the pinion, 1 for the gear.

        Raises
        ------
        ValueError
            For another name.

        Examples
        --------
        >>> pair = gears.train.pair(0)
        >>> pair.index("gear")
        1
        """
        return list(self.members).index(name)


@dataclass(frozen=True)
class GearTrain:
    """What every further step starts from: all members by their names, and the pairs that mesh.

    `unpaired`: members that mesh with none, and `lacking` what a design calls the one that they would mesh with; `warnings`: what
    the design's owner should know of the geometry, one line each; `alike`: for every pair the number of the first one that meshes
    as it does, but for the phase; empty where all are different.
    """

    kind: str
    pairs: tuple[GearPair, ...]
    warnings: tuple[str, ...] = field(default=())
    alike: tuple[int, ...] = field(default=())
    unpaired: tuple[Member, ...] = field(default=())
    lacking: str = ""

    @property
    def different(self) -> tuple[int, ...]:
        """Numbers of the pairs that are not like one before them."""
        return tuple(dict.fromkeys(self.alike or range(len(self.pairs))))

    @property
    def members(self) -> dict[str, Member]:
        """Every member once, in the order of the pairs, and after them those without one."""
        paired = (member for pair in self.pairs for member in pair.both)
        return {member.name: member for member in (*paired, *self.unpaired)}

    def with_member(self, member: Member) -> GearTrain:
        """The same gear set with another member of that name in all its pairs; of pairs that were alike those with it stay so.

        Parameters
        ----------
        member : Member
            It takes the place of the one with its name.

        Returns
        -------
        GearTrain

        Examples
        --------
        >>> changed = gears.train.with_member(gears.members["pinion"])
        >>> list(changed.pair(0).members)
        ['pinion', 'gear']
        """

        made = self.with_members(lambda old: member if old.name == member.name else old)
        kinds = [(kind, member.name in pair.members) for kind, pair in zip(self.alike, made.pairs, strict=False)]
        return replace(made, alike=tuple(kinds.index(kind) for kind in kinds))

    def with_members(self, change: Callable[[Member], Member]) -> GearTrain:
        """The same gear set with every member as `change` makes it; pairs that were alike have to stay so.

        Parameters
        ----------
        change : callable
            Takes and returns a Member.

        Returns
        -------
        GearTrain

        Examples
        --------
        >>> gears.train.with_members(lambda member: member).pair(0).name
        'pinion-gear'
        """
        pairs = tuple(replace(pair, pinion=change(pair.pinion), gear=change(pair.gear)) for pair in self.pairs)
        return replace(self, pairs=pairs, unpaired=tuple(map(change, self.unpaired)))

    def like(self, which: int | str) -> int:
        """How many pairs mesh as one of them does, itself counted: the planets of a set.

        Parameters
        ----------
        which : int or str
            Number of the pair, or its members as "sun-planet_1".

        Returns
        -------
        int

        Raises
        ------
        DesignError
            For another pair, and where no members mesh.

        Examples
        --------
        >>> gears.train.like(0)
        1
        """
        name = self.pair(which).name
        numbers = self.alike or tuple(range(len(self.pairs)))
        own = next(number for number, pair in zip(numbers, self.pairs, strict=True) if pair.name == name)
        return numbers.count(own)

    def pair(self, which: int | str) -> GearPair:
        """A pair of the set.

        Parameters
        ----------
        which : int or str
            Its number, or its members' names in either order, as "sun-planet_1".

        Returns
        -------
        GearPair

        Raises
        ------
        DesignError
            For another, and where no members mesh.

        Examples
        --------
        >>> gears.train.pair("gear-pinion").name
        'pinion-gear'
        """
        if not self.pairs:
            raise self._without_pair()
        if not isinstance(which, str):
            if not 0 <= which < len(self.pairs):
                numbers = "0" if len(self.pairs) == 1 else f"0 to {len(self.pairs) - 1}"
                names = ", ".join(pair.name for pair in self.pairs)
                raise ArgumentError("pair", which, must_be=f"{numbers}, or one of {names}")
            return self.pairs[which]
        for pair in self.pairs:
            if which in (f"{pair.pinion.name}-{pair.gear.name}", f"{pair.gear.name}-{pair.pinion.name}"):
                return pair
        raise ArgumentError("pair", which, must_be=f"one of {', '.join(pair.name for pair in self.pairs)}")

    def needs_pair(self, argument: str, value: object) -> DesignError:
        """The refusal of an argument that needs members that mesh.

        Parameters
        ----------
        argument : str
            What it is called.
        value : object
            What was given.

        Returns
        -------
        DesignError
            To be raised.

        Examples
        --------
        >>> print(gm.gear(18, module=2).train.needs_pair("cycle", True))
        cycle = true: needs a mating gear: add the table [pinion]

        """
        return ArgumentError(argument, value, reason="needs a mating gear", remedy=f"add the table [{self.lacking}]")

    def _without_pair(self) -> DesignError:
        """The refusal of what needs members that mesh."""
        return DesignError(
            self.lacking,
            reason=f"the {', '.join(self.members)} has no mating gear, which contact, load and all figures of a mesh need",
            remedy=f"add the table [{self.lacking}]",
        )
