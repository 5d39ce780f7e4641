"""Members with their axes, and the pairs that mesh: the result of building a design."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, fields, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.figures import Figures
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL, Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.member_names import MemberNames
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.blank.bores import BoreForm, ClosedLine, Slot, beside_circle
from gearmesh.teeth.blank.features import BodyFeatures, Boss, Drilling, Opening
from gearmesh.teeth.blank.halves import SINGLE_ROW, AxialGap, HalfGear, Rows
from gearmesh.teeth.carried_body import CarriedBody
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES, IndexAngles
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import (
    BAR_REGIONS,
    BODY_REGIONS,
    BORE_REGIONS,
    FEATURE_REGIONS,
    GAP_REGIONS,
    RARE_REGIONS,
    Region,
    Side,
)
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth import Tooth

#: Surface parameters (p, v) (...,) of a flank -> values named and counted as in the source (angles in degrees).
#: `NamedParameters` also have units and meanings.
SourceParameters = Callable[[Array, Array], dict[str, Array]]

#: largest distance between different teeth of a member where they begin at the root
MAX_ROOT_GAP_MM = 1e-9


@dataclass(frozen=True)
class Member:
    """One member of a gear set: its tooth in its own frame (axis z, tooth centred on x), its mounting and its body.

    Tooth 0 is on +x; teeth are counted as the angle of the joint grows, in every row alike. Raises DesignError for
    teeth in `others` that do not fit between their neighbours, and for index angles of another number of teeth.
    """

    #: name in the gear set, as "pinion"
    name: str
    #: tooth of the first row; all teeth are like it unless `others` says otherwise
    tooth: Tooth
    #: values of a flank point under the names of the source, from its surface parameters
    source_parameters: SourceParameters
    #: hubs, shafts, bores, keyway, holes and spokes
    features: BodyFeatures = field(default_factory=BodyFeatures)
    #: transform from the own frame to the fixed frame
    mount: Mount = field(default_factory=lambda: Mount(Rigid.identity()))
    #: `source_parameters` of the unmodified flanks; None if they were not modified
    tool_parameters: SourceParameters | None = None
    #: rows of teeth: one, or the two halves of a double helical member
    rows: Rows = SINGLE_ROW
    #: length (mm) of a rack beyond its last pitch, at either end
    overhang: float = 0.0
    #: teeth that differ from `tooth`, by number
    others: Mapping[int, Tooth] = field(default_factory=dict, hash=False)
    #: angles by which the flanks are ahead of their theoretical places
    index: IndexAngles = NO_INDEX_ANGLES
    #: True if the member passes torque from one mesh to another, and none to its bore
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

    def counted_from(self, first: int) -> Member:
        """Return the same member with another tooth on x: its mount is turned by so many pitches.

        Parameters
        ----------
        first : int
            Number of the tooth that gets the number 0.

        Returns
        -------
        Member
            It turns as before; eccentricity, index angles and teeth that differ stay where they are.

        Examples
        --------
        >>> pinion = gears.members["pinion"]
        >>> pinion.counted_from(1).tooth is pinion.tooth
        True
        """
        teeth = self.tooth.teeth
        turn = Rigid.about_z(2.0 * math.pi * first / teeth)
        x, y, _ = turn.rotation.T @ np.array([*self.mount.eccentricity, 0.0])
        mount = replace(self.mount, base=self.mount.base @ turn, eccentricity=(float(x), float(y)))
        others = {(number - first) % teeth: tooth for number, tooth in self.others.items()}
        return replace(self, mount=mount, index=self.index.from_tooth(first % teeth), others=others)

    def tooth_at(self, number: int) -> Tooth:
        """Return the tooth with a number.

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
    def declared_parameters(self) -> dict[str, SourceParameter]:
        """Declarations of the source parameters by name; empty if the member's function has none."""
        named = self.source_parameters
        return {parameter.name: parameter for parameter in named.declared} if isinstance(named, NamedParameters) else {}

    @property
    def one_tooth(self) -> Tooth:
        """The tooth of a member whose teeth are all alike. Raises DesignError where they differ."""
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
        """Different teeth, once each, in the order of their first numbers."""
        return tuple({id(tooth): tooth for tooth in self._row}.values())

    @property
    def order(self) -> NDArray[np.int64]:
        """Index into `different_teeth` of every tooth, (teeth,), by number."""
        kinds = [id(tooth) for tooth in self.different_teeth]
        return np.array([kinds.index(id(tooth)) for tooth in self._row], dtype=np.int64)

    @property
    def _row(self) -> list[Tooth]:
        """All teeth by number."""
        return [self.others.get(k, self.tooth) for k in self.tooth.joint.places(self.tooth.teeth).tolist()]

    def with_teeth(self, teeth: Mapping[int, Tooth]) -> Member:
        """Return the member with other teeth at some numbers.

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
        """Return the member with all teeth alike.

        Parameters
        ----------
        tooth : Tooth
            The tooth that all teeth become.

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
        """Return the member with all teeth like its tooth with a number.

        Parameters
        ----------
        number : int
            Number of a tooth, as in `tooth_at`.

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
        """True if both members differ only in name and mounting, as the planets of a set do.

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
            value is other_value or (name != "tooth" and value == other_value)
            for name, value, other_value in (
                (f.name, getattr(self, f.name), getattr(other, f.name)) for f in fields(self)
            )
            if name not in ("name", "mount")
        )

    @property
    def halves(self) -> tuple[HalfGear, ...]:
        """Rows of teeth: both halves of a double helical member, or the only row."""
        return self.rows.halves

    @property
    def gaps(self) -> tuple[AxialGap, ...]:
        """Gaps between halves that do not meet."""
        return self.rows.gaps

    @property
    def extent(self) -> tuple[float, float]:
        """First and last station (mm) of the whole member."""
        return self.rows.extent(self.tooth.blank.faces)

    @property
    def plain_body(self) -> Body:
        """Body under the teeth, of both halves if there are two, without hubs, shafts and steps."""
        return self.rows.body(self.tooth.blank.body)

    @property
    def body(self) -> Body:
        """Body under the teeth, with hubs, shafts and steps of the bore."""
        return self.features.turn(self.plain_body)

    @property
    def turned_body(self) -> Body | None:
        """The body if it is one of revolution under one row of teeth; None for the bar of a rack and for two rows."""
        return None if self.tooth.joint.travel is not None or len(self.halves) > 1 else self.body

    def bar_ends(self, z: Array) -> tuple[Array, Array]:
        """Return y of both ends of a rack, in the middle of a root before the first and after the last tooth.

        Parameters
        ----------
        z : numpy.ndarray
            Places (...,) along the face of the first row of teeth, mm.

        Returns
        -------
        tuple of numpy.ndarray
            y (...,) of the first and of the last end, mm.

        Examples
        --------
        >>> rack = gm.build(gm.load("samples/rack.toml")).members["rack"]
        >>> first, last = rack.bar_ends(np.zeros(1))
        >>> round(float(last[0] - first[0]), 6)
        200.000275
        """
        joint, tooth = self.tooth.joint, self.tooth
        places, middle = joint.places(tooth.teeth), tooth.root_middle(z)
        first, last = (
            float(joint.to(place * tooth.pitch_angle).translation[1]) for place in (places[0], places[-1] + 1)
        )
        return middle + first - self.overhang, middle + last + self.overhang

    @property
    def keyway(self) -> Slot | None:
        """Keyway in the bore, None if there is none."""
        return self.features.keyway

    @property
    def bore_form(self) -> BoreForm | None:
        """Form of the bore, keyways included; None if it is round."""
        return self.features.bore_form

    @property
    def hub(self) -> Boss | None:
        """Hub on the heel side, None if there is none."""
        return self.features.hub

    @property
    def holes(self) -> Drilling | None:
        """Holes that lighten the body, None if there are none."""
        return self.features.holes

    @property
    def flat_ends(self) -> bool:
        """True if the teeth end on planes."""
        return station_normal(self.tooth.blank.axial)[0] == 0.0

    @property
    def openings(self) -> tuple[Opening, ...]:
        """Openings that are cut along the axis out of the body, without bore and keyway."""
        return self.features.openings(self.body, self.flat_ends)

    @property
    def prisms(self) -> tuple[tuple[ClosedLine, float, float], ...]:
        """Outlines of everything that is cut along the axis out of the turned body, each with its two z (mm).

        The outline of a keyway excludes the bore; that of a flat, which is not cut, is clockwise.
        """
        cuts = [(opening.curves, opening.low, opening.high) for opening in self.openings]
        if self.bore_form is not None:
            band = self.body.bore_band
            (radius, low), (_, high) = self.body.profile[band : band + 2]
            cuts += [(part, low, high) for part in beside_circle(self.bore_form.in_bore(radius), radius)]
        return tuple(cuts)

    @property
    def genus(self) -> int:
        """Number of holes through the whole member."""
        return self.plain_body.genus + sum(opening.floor is None for opening in self.openings)

    @property
    def body_regions(self) -> tuple[Region, ...]:
        """Regions of the body, in the order of the files."""
        if self.tooth.joint.travel is not None:
            gap = (Region.GAP,) if self.gaps else ()
            return (*BAR_REGIONS, *gap, *(() if self.features.row is None else (self.features.row.region,)))
        features = self.features.rare_regions
        gaps = features or self.gaps
        rare = gaps or self.holes is not None or self.plain_body.web is not None
        flat = self.features.bore is not None
        lists = ((rare, RARE_REGIONS), (gaps, GAP_REGIONS), (features, FEATURE_REGIONS), (flat, BORE_REGIONS))
        return (*BODY_REGIONS, *(region for there, regions in lists if there for region in regions))

    @property
    def repeated_regions(self) -> tuple[Region, ...]:
        """Regions that look alike on every tooth; not the root of a bar, which goes on beyond the last tooth."""
        regions = self.tooth.regions
        return (
            regions if self.tooth.joint.travel is None else tuple(name for name in regions if name is not Region.ROOT)
        )

    def plain_volume(self) -> float:
        """Return the volume of teeth and body, of both halves if there are two, without the features of the body.

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
        row_volume = float(shares @ [tooth.volume() for tooth in self.different_teeth])
        if self.overhang:
            (back, low), (_, high) = self.tooth.blank.body.profile
            section = (float(self.tooth.blank.root.at(0.0)) - back) * (high - low)
            section -= sum(end.area for end in self.tooth.blank.ends if end is not None)
            row_volume += 2.0 * self.overhang * section
        return self.rows.volume(row_volume, self.tooth.blank.body)


def _mismatch(tooth: Tooth, nominal: Tooth) -> str:
    """Reason why a tooth cannot be beside a nominal tooth; empty if it can."""
    if tooth.teeth != nominal.teeth:
        return f"it is one of {tooth.teeth} teeth, they of {nominal.teeth}"
    for name in ("joint", "blank"):
        value, nominal_value = getattr(tooth, name), getattr(nominal, name)
        if value is not nominal_value and value != nominal_value:
            return f"its {name} is another"
    if tooth.regions != nominal.regions:
        return "it has other surfaces beside flanks and fillets"
    apart = float(np.linalg.norm(tooth.root_ends - nominal.root_ends, axis=-1).max())
    return "" if apart <= MAX_ROOT_GAP_MM else f"it begins {apart:.3g} mm beside them at the root"


@dataclass(frozen=True)
class Fellow:
    """A pair that shares the torque of another one: both pinions turn as one, and so do both gears."""

    #: the pair, seen in the image in which its pinion is mounted as that of the other pair
    pair: GearPair
    #: motion of this image to its place
    image: Rigid
    #: rotation (rad) of its pinion at rotation 0 of the other one
    phase: float


@dataclass(frozen=True)
class OtherMesh:
    """The other mesh of a planet."""

    #: name of the planet
    planet: str
    #: its pair, in which the planet stands as in the first one
    pair: GearPair


@dataclass(frozen=True)
class GearPair:
    """Two members that mesh, and the flanks that touch."""

    #: member whose rotation is phi1
    pinion: Member
    #: member that the pinion drives, with rotation phi2
    gear: Member
    #: touching sides of pinion and gear
    flanks: tuple[Side, Side]
    #: +1 if contact pushes the gear towards larger phi2, -1 towards smaller
    drive: int
    #: nominal d phi2 / d phi1
    ratio: float
    #: thickness of the marking compound, mm
    delta: float
    #: generation angle (rad) of pinion surface parameters, if the source counts phi1 by it; None if phi1 is the
    #: rotation
    generation: Callable[[Array, Array], Array] | None = None
    #: figures of the gear system for the pair, apart from its contact
    figures: Figures | None = None
    #: further pairs that share its torque
    fellows: tuple[Fellow, ...] = ()
    #: other mesh of its planet; None without one, and where it does not count
    other_mesh: OtherMesh | None = None
    #: number of equally loaded meshes of its central member, this one included
    around: int = 1
    #: True if the arm between its axes, at rest here, turns in use: an eccentric drives the pair
    arm_turns: bool = False

    @property
    def eccentric(self) -> bool:
        """True if a member turns about an axis that is not its own, so that no two tooth pairs are alike."""
        return any(member.mount.eccentricity != (0.0, 0.0) for member in self.both)

    @property
    def uneven(self) -> bool:
        """True if teeth of a member have pitch deviations, so that no two tooth pairs are alike."""
        return any(member.index.uneven for member in self.both)

    @property
    def even(self) -> GearPair:
        """The pair without differences of pitch deviations: every tooth of a member is at its mean place."""
        pinion, gear = (replace(member, index=member.index.even) for member in self.both)
        return replace(self, pinion=pinion, gear=gear)

    @property
    def both(self) -> tuple[Member, Member]:
        return self.pinion, self.gear

    @property
    def images(self) -> tuple[Rigid, ...]:
        """Motion in the fixed frame from the first half to each half of the pair, a reflection in the pinion's plane of
        symmetry, and to each pair that shares its torque.
        """
        base = self.pinion.mount.base
        further = zip(self.pinion.halves[1:], self.gear.halves[1:], strict=False)
        mirrored = (base @ half.motion @ base.inverse for half, _ in further)
        return (Rigid.identity(), *mirrored, *(fellow.image for fellow in self.fellows))

    @property
    def halves(self) -> tuple[GearPair, ...]:
        """The pair of the first halves, the pairs of the others, and those that share its torque, all seen in their images:
        pairs of the same teeth."""
        mount = self.gear.mount
        further = zip(self.images[1:], self.gear.halves[1:], strict=False)
        mounts = [replace(mount, base=image @ mount.base @ half.motion) for image, half in further]
        mirrored = (replace(self, gear=replace(self.gear, mount=half_mount)) for half_mount in mounts)
        return (self, *mirrored, *(fellow.pair for fellow in self.fellows))

    @property
    def own_halves(self) -> int:
        """Number of own halves, the first in `halves`; pairs that share the torque follow."""
        return len(self.halves) - len(self.fellows)

    @property
    def phases(self) -> tuple[float, ...]:
        """Rotations (rad) of the pinions of all `halves` at rotation 0 of the pinion."""
        return (*(0.0,) * self.own_halves, *(fellow.phase for fellow in self.fellows))

    def sees(self, other: GearPair) -> Fellow:
        """Return another pair whose pinion and gear turn as those of this one.

        Parameters
        ----------
        other : GearPair
            Pair of the same teeth, anywhere about the gear's axis.

        Returns
        -------
        Fellow

        Examples
        --------
        >>> pair = gears.train.pair(0)
        >>> pair.sees(pair).phase
        0.0
        """
        image = other.pinion.mount.base @ self.pinion.mount.base.inverse
        seen = replace(other.gear.mount, base=image.inverse @ other.gear.mount.base)
        # the gear is turned back to where it faces the pinion as in this pair; the pinion is ahead instead
        turned = seen.turn_from(self.gear.mount)
        facing = replace(seen, base=seen.base @ Rigid.about_z(-turned))
        pair = replace(
            other,
            pinion=replace(other.pinion, mount=replace(other.pinion.mount, base=self.pinion.mount.base)),
            gear=replace(other.gear, mount=facing),
        )
        return Fellow(pair, image, seen.sign * turned / self.ratio)

    @property
    def name(self) -> str:
        """Names of both members, as "sun-planet_1"."""
        return f"{self.pinion.name}-{self.gear.name}"

    @property
    def members(self) -> dict[str, Member]:
        """Both members by name, the pinion first."""
        return {member.name: member for member in self.both}

    @property
    def mounts(self) -> tuple[Mount, Mount]:
        return self.pinion.mount, self.gear.mount

    def middle(self, member: Member) -> float:
        """Return the middle of a member's working flank, at half height, averaged over all halves.

        Parameters
        ----------
        member : Member
            Member of the pair.

        Returns
        -------
        float
            Coordinate along the member's axis, mm, in its own frame.

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
        """Angle between the axes, rad, 0 to pi, as counted for bevel gears; 0 if they are parallel in either sense.

        Each axis has the sense in which both would coincide on parallel axes: external gears turn against each other,
        an internal gear turns with its mating gear.
        """
        first, second = (mount.sign * mount.axis for mount in self.mounts)
        across = float(np.linalg.norm(np.cross(first, second)))
        inside = any(member.tooth.blank.body.around for member in self.both)
        return (
            float(np.arctan2(across, (first @ second) * (1.0 if inside else -1.0)))
            if across > MAX_SINE_OF_PARALLEL
            else 0.0
        )

    @property
    def acute_angle(self) -> float:
        """Acute angle between the axes, rad."""
        return min(self.shaft_angle, np.pi - self.shaft_angle)

    @property
    def output(self) -> Joint:
        """Joint in which the gear moves with phi2."""
        return self.gear.mount.joint

    @property
    def pitch(self) -> float:
        """Angular pitch of the pinion, rad: phi1 between neighbouring tooth pairs."""
        return self.pinion.tooth.pitch_angle

    def index(self, name: str) -> int:
        """Return the number of a member from its name.

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
    """All members of a gear set by name, and the pairs that mesh."""

    #: kind of the gear system, as "planetary"
    kind: str
    #: pairs that mesh
    pairs: tuple[GearPair, ...]
    #: warnings about the geometry, one line each
    warnings: tuple[str, ...] = field(default=())
    #: number of the first pair that meshes like each pair, apart from the phase; empty if all are different
    alike: tuple[int, ...] = field(default=())
    #: members without a mating gear
    unpaired: tuple[Member, ...] = field(default=())
    #: table of a design that would add the mating gear
    lacking: str = ""
    #: bodies without teeth that turn with members
    carried: tuple[CarriedBody, ...] = field(default=())
    #: True if the pinions of all pairs turn as one, as discs on the same output pins, and share the torque
    shared: bool = field(default=False)

    @property
    def different(self) -> tuple[int, ...]:
        """Numbers of the pairs that are not like an earlier pair."""
        return tuple(dict.fromkeys(self.alike or range(len(self.pairs))))

    @property
    def loaded(self) -> tuple[int, ...]:
        """Numbers of the pairs whose contact under load is that of the gear set: one of those that share the torque."""
        return self.different[:1] if self.shared else self.different

    def sharing(self, which: int | str) -> GearPair:
        """Return a pair with those that share its torque, and with the other mesh of its planet, if there are some.

        Parameters
        ----------
        which : int or str
            Number of the pair, or its members as "disc_1-ring".

        Returns
        -------
        GearPair

        Raises
        ------
        DesignError
            For another pair, and where no members mesh.

        Examples
        --------
        >>> gears.train.sharing(0).fellows
        ()
        """
        pair = self.pair(which)
        planet = next((member.name for member in pair.both if member.idler), None)
        if planet is not None:
            others = (other for other in self.pairs if other.name != pair.name and planet in other.members)
            found = next((OtherMesh(planet, other) for other in others), None)
            return replace(pair, other_mesh=found, around=self.like(which))
        if not self.shared:
            return pair
        return replace(pair, fellows=tuple(pair.sees(other) for other in self.pairs if other is not pair))

    @property
    def members(self) -> dict[str, Member]:
        """Every member once, as its first pair has it: first those of the pairs, in order, then those without a mating
        gear."""
        paired = [member for pair in self.pairs for member in pair.both]
        found: dict[str, Member] = {}
        for member in (*paired, *self.unpaired):
            found.setdefault(member.name, member)
        return found

    @property
    def names(self) -> MemberNames:
        """Names of the members and of the pairs."""
        pairs = tuple((pair.pinion.name, pair.gear.name) for pair in self.pairs)
        unpaired, carried = ((part.name for part in parts) for parts in (self.unpaired, self.carried))
        return MemberNames(pairs, tuple(unpaired), self.lacking, tuple(carried))

    def with_member(self, member: Member) -> GearTrain:
        """Return the gear set with another member of that name in all its pairs.

        Pairs that were alike stay alike if both contain the member, or neither does.

        Parameters
        ----------
        member : Member
            It replaces the member with its name.

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
        """Return the gear set with every member replaced by `change(member)`; pairs that were alike must stay alike.

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
        old = self.members
        made = {name: change(member) for name, member in old.items()}

        def seen(member: Member) -> Member:
            """Return the new member as a pair sees it, in which another tooth may face the mating member."""
            whole, angle = made[member.name], member.mount.turn_from(old[member.name].mount)
            first = round(angle * whole.tooth.teeth / (2.0 * math.pi))
            return whole.counted_from(first) if first else whole

        pairs = tuple(replace(pair, pinion=seen(pair.pinion), gear=seen(pair.gear)) for pair in self.pairs)
        return replace(self, pairs=pairs, unpaired=tuple(made[member.name] for member in self.unpaired))

    def like(self, which: int | str) -> int:
        """Return the number of pairs that mesh like a pair, itself included: the number of planets of a set.

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
        kind = next(number for number, pair in zip(numbers, self.pairs, strict=True) if pair.name == name)
        return numbers.count(kind)

    def pair(self, which: int | str) -> GearPair:
        """Return a pair of the set.

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
        return self.pairs[self.names.pair_number(which)]

    def needs_pair(self, argument: str, value: object) -> DesignError:
        """Return the refusal of an argument that needs a mating gear.

        Parameters
        ----------
        argument : str
            Name of the argument.
        value : object
            Refused value.

        Returns
        -------
        DesignError
            To be raised.

        Examples
        --------
        >>> print(gm.gear(18, module=2).train.needs_pair("cycle", True))
        cycle = true: needs a mating gear: add the table [pinion]
        """
        return self.names.needs_pair(argument, value)
