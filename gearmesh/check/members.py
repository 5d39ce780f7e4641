"""Whole members rolled against each other: which teeth touch first, with what, and how much play there is.

As the roll test it knows nothing but surfaces and the positions of the members. Of every tooth it takes a half, from the middle of
the root to the middle of the land: fillet, flank, broken edge and land on dense grids of exact points (`tooth_half`), and
turns the gear until the halves of all tooth pairs in reach are free (`touch.first_touch`). The same for the other halves
turns the gear the other way; what lies between is the backlash.

Tooth pair k does at phi1 what pair 0 does at phi1 - k pitches: its teeth are those of pair 0 turned back by k pitches of
the pinion and by as many of the gear. On the coast side the pinion's tooth k meets the gear's tooth before that of pair k.
The gear's own root and land, which are surfaces of revolution, or planes along a rack, are left out: turning (sliding) moves them
in themselves (within the eccentricity of a gear that has one). A pinion's tip deeper than the gear's root is not seen;
`root_clearance` sees it. A gear's tip deeper than the pinion's root touches that: such gears are jammed, and
phi2 is not that of the contact solver's curve, which is of flanks and fillets and has no root.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.check.heightfield import Field, GridFlank, PatchedFlank, along
from gearmesh.check.roll import arcs_over
from gearmesh.check.touch import first_touch
from gearmesh.check.windings import WOUND, WoundTouch, in_mesh, middle, turns, windings
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import EDGES, FILLETS, FLANKS, Region, Side
from gearmesh.teeth.tooth import Tooth

#: cells of the grids along a flank's profile and face: doubling them moves phi2 by less than 0.005 arcsec (tests)
FLANK_CELLS, HALF_CELLS = 80, 40
#: cells across other links, as a share of those across the flank
SHARE = {**dict.fromkeys(FILLETS.values(), 1.0), **dict.fromkeys(EDGES.values(), 0.5), Region.LAND: 0.25}
FEWEST_CELLS = 4
#: mm: links that are nowhere longer are left out
NOTHING = 1e-9
#: no pair is looked at farther than this many pitches from the one that is nominally in mesh
MOST_PITCHES = 12
#: pairs that are behind the first by more than this share of a gear pitch end the search on their side
BEHIND = 0.5


@dataclass(frozen=True)
class ToothTouch:
    """The gear's rotation `phi2` (rad) at which it is touched first, by which tooth pair, and where.

    `regions` of pinion and gear that touch; `on_rims`: whether either does so with the rim of that region, an edge;
    `point` (3,) in the fixed frame, mm.
    """

    phi2: float
    tooth: int
    regions: tuple[Region, Region]
    on_rims: tuple[bool, bool]
    point: Array


@dataclass(frozen=True)
class MemberRoll:
    """Both first touches at the pinion's rotation phi1 (rad); None on a side where nothing is in reach.

    `direction` +1: the drive side pushes the gear to larger phi2. `pairs` and `coast_pairs`: phi2 of every pair in reach.
    """

    phi1: float
    direction: int
    drive: ToothTouch | None
    coast: ToothTouch | None
    pairs: dict[int, float]
    coast_pairs: dict[int, float]

    @property
    def backlash(self) -> float:
        """Rotation of the gear (rad) from one touch to the other: negative where the members overlap, NaN without both."""
        if self.drive is None or self.coast is None:
            return float("nan")
        return self.direction * (self.coast.phi2 - self.drive.phi2)


def roll_members(
    pair: GearPair,
    phi1: ArrayLike,
    cells: int = HALF_CELLS,
    guess_phi2: ArrayLike | None = None,
    *,
    coast: bool = True,
) -> tuple[MemberRoll, ...]:
    """Roll whole members at pinion rotations phi1 (P,), rad: first touch on the drive side and on the coast side.

    Without `coast` the drive side alone, half of the work. Whole turns are added to phi2 to bring it next to `guess_phi2` (P,)
    or (), by default ratio * phi1. Raises TrimError where a tooth cannot be trimmed.
    """
    angles, guesses = _rotations(pair, phi1, guess_phi2)
    drive_side = _RolledSide.of(pair, coast=False, cells=cells)
    coast_side = _RolledSide.of(pair, coast=True, cells=cells) if coast else None
    rolls = []
    for angle, guess in zip(angles.tolist(), guesses.tolist(), strict=True):
        drive, drive_pairs = drive_side.at(angle, guess)
        back, back_pairs = (None, dict[int, float]()) if coast_side is None else coast_side.at(angle, guess)
        if coast_side is not None and drive is not None and back is None:
            back, back_pairs = coast_side.at(angle, drive.phi2)
        rolls.append(MemberRoll(angle, pair.drive, drive, back, drive_pairs, back_pairs))
    return tuple(rolls)


def roll_flanks(
    pair: GearPair, phi1: ArrayLike, cells: int = FLANK_CELLS, guess_phi2: ArrayLike | None = None
) -> tuple[ToothTouch | None, ...]:
    """Roll the flanks of one tooth pair alone, on exact grids; as `roll_members`. None where they never meet."""
    halves = [flank_patches(m.one_tooth, side, cells) for m, side in zip(pair.both, pair.flanks, strict=True)]
    return _RolledSide.make(pair, pair.drive, 0, (halves[0], halves[1])).alone(*_rotations(pair, phi1, guess_phi2))


def roll_teeth(
    pair: GearPair, phi1: ArrayLike, cells: int = HALF_CELLS, guess_phi2: ArrayLike | None = None
) -> tuple[ToothTouch | None, ...]:
    """Roll the teeth of one pair alone, fillets and edges with their flanks, on the drive side; as `roll_members`."""
    return _RolledSide.of(pair, coast=False, cells=cells).alone(*_rotations(pair, phi1, guess_phi2))


def _rotations(pair: GearPair, phi1: ArrayLike, guess_phi2: ArrayLike | None) -> tuple[Array, Array]:
    """Rotations (P,) of the pinion and next to which those of the gear are reported."""
    angles = np.atleast_1d(np.asarray(phi1, dtype=float))
    return angles, np.broadcast_to(pair.ratio * angles if guess_phi2 is None else np.asarray(guess_phi2), angles.shape)


# --- one side ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Half:
    """A half of a tooth, own frame: its grids and the region that each is of."""

    flank: PatchedFlank
    regions: tuple[Region, ...]

    @property
    def points(self) -> Array:
        return self.flank.points

    def between(self, low: float, high: float) -> Half | None:
        """The part of it between two z (mm), and a little more; None where there is none."""
        parts = self.flank.parts_between(low, high)
        if not parts:
            return None
        return Half(PatchedFlank(tuple(parts.values())), tuple(self.regions[k] for k in parts))


@dataclass(frozen=True)
class _RolledSide:
    """One side of all teeth: `drive` +-1 the sense in which the gear is pushed, `pinion` the pinion's half tooth, in pieces of less
    than a turn.

    `gear_arcs(k)`: the gear's half tooth that the pinion's tooth k meets, gear not turned, over circles about its axis.
    """

    pair: GearPair
    drive: int
    pinion: tuple[Half, ...]
    gear: Half
    gear_arcs: Callable[[int], Field]

    @staticmethod
    def of(pair: GearPair, coast: bool, cells: int) -> _RolledSide:
        sides = [side.other if coast else side for side in pair.flanks]
        pinion = tooth_half(pair.pinion.one_tooth, sides[0], cells)
        gear = tooth_half(pair.gear.one_tooth, sides[1], cells, turned=False)
        return _RolledSide.make(pair, -pair.drive if coast else pair.drive, -pair.drive if coast else 0, (pinion, gear))

    @staticmethod
    def make(pair: GearPair, drive: int, ahead: int, halves: tuple[Half, Half]) -> _RolledSide:
        """`ahead`: the gear's tooth counted from that of the pair, in pitches of growing phi2."""
        mount, tooth = pair.gear.mount, pair.gear.tooth

        @cache
        def gear_arcs(k: int) -> Field:
            turn = mount.sign * (ahead * tooth.pitch_angle - k * pair.pitch * pair.ratio)
            own_to_base = mount.own_to_turning @ mount.joint.to(turn)
            return arcs_over(halves[1].flank, own_to_base, drive * mount.sign, side=-1.0, joint=mount.joint)

        return _RolledSide(pair, drive, windings(halves[0], turns(pair.pinion.tooth)), halves[1], gear_arcs)

    def at(self, phi1: float, guess: float) -> tuple[ToothTouch | None, dict[int, float]]:
        """First touch of all pairs in reach, and phi2 of every one."""
        first: ToothTouch | None = None
        all_pairs: dict[int, float] = {}
        start = round(phi1 / self.pair.pitch)
        if len(self.pinion) > 1 and (nearest := self.touch(start, phi1, guess, anywhere=True)) is not None:
            guess = nearest.phi2
        for way in _outwards(start, self._reach):
            met = bool(all_pairs)
            for k in way:
                touch = self.touch(k, phi1, guess)
                if touch is None:
                    if met:
                        break
                    continue
                met, all_pairs[k] = True, touch.phi2
                if first is None or self.drive * (touch.phi2 - first.phi2) > 0.0:
                    first = touch
                elif self.drive * (first.phi2 - touch.phi2) > BEHIND * self.pair.gear.tooth.pitch_angle:
                    break
        return first, all_pairs

    @property
    def _reach(self) -> int:
        """Pairs that are looked at on either side: no tooth of the pinion twice, but for those that go round their axis."""
        return MOST_PITCHES if len(self.pinion) > 1 else min(MOST_PITCHES, (self.pair.pinion.tooth.teeth - 1) // 2)

    def alone(self, phi1: Array, guess: Array) -> tuple[ToothTouch | None, ...]:
        """First touch of tooth pair 0 alone at every phi1 (P,)."""
        return tuple(self.touch(0, a, g, anywhere=True) for a, g in zip(phi1.tolist(), guess.tolist(), strict=True))

    def touch(self, k: int, phi1: float, guess: float, *, anywhere: bool = False) -> ToothTouch | None:
        """First touch of tooth pair k alone; of a thread the winding next to phi2 = `guess`, or the nearest `anywhere`."""
        first, second = self.pair.mounts
        pinion_turn = Rigid.about_z(-first.sign * k * self.pair.pitch)
        pinion_to_base = second.base.inverse @ first.at(phi1) @ pinion_turn
        sense = self.drive * second.sign
        touches = []
        for piece in self.pinion:
            arcs = arcs_over(piece.flank, pinion_to_base, sense, side=1.0, joint=second.joint)
            first_contact = first_touch(arcs, self.gear_arcs(k), along(second.joint, sense, 0.0))
            if first_contact is not None:
                phi2 = second.joint.nearest(second.zero + self.drive * first_contact.turn, guess)
                aside = abs(float(pinion_to_base.inverse.point(first_contact.point)[2]) - middle(piece))
                touches.append(WoundTouch(piece, first_contact, phi2, aside))
        best = in_mesh(touches, guess, self.pair.ratio, self.drive, anywhere=anywhere)
        return None if best is None else self._place(best, k, second)

    def _place(self, best: WoundTouch[Half], k: int, mount: Mount) -> ToothTouch:
        first_contact = best.touch
        regions = best.piece.regions[first_contact.parts[0]], self.gear.regions[first_contact.parts[1]]
        return ToothTouch(best.phi2, k, regions, first_contact.on_rims, mount.base.point(first_contact.point))


def _outwards(start: int, most: int) -> Iterator[range]:
    """Pairs from the one nominally in mesh on, one way and then the other, so many at most."""
    yield range(start, start + most + 1)
    yield range(start - 1, start - most - 1, -1)


# --- halves of teeth --------------------------------------------------------------------------------------------------


def flank_patches(tooth: Tooth, side: Side, cells: int) -> Half:
    """The trimmed flank alone on exact grids of about `cells` cells either way, cut where its form point has corners."""
    s = np.linspace(0.0, 1.0, cells + 1)
    grids = [tooth.flank_grid(side, s, t).points for t in _spans(tooth, cells)]
    return Half(PatchedFlank(tuple(GridFlank(grid) for grid in grids)), (FLANKS[side],) * len(grids))


def tooth_half(tooth: Tooth, side: Side, cells: int, *, turned: bool = True) -> Half:
    """Half of a tooth on exact grids, `cells` along the flank's profile and its face; without `turned` no land and root.

    Raises TrimError where the tooth cannot be trimmed.
    """
    middle = (0.0, 0.5) if side is Side.RIGHT else (0.5, 1.0)
    links = [(FLANKS[side], (0.0, 1.0), 0.0), (FILLETS[side], (0.0, 1.0), 0.0), (EDGES[side], (0.0, 1.0), 0.0)]
    if turned:
        # of the right flank's root the second half, of the left one's the first half of the next
        next_root = 0.0 if side is Side.RIGHT else tooth.pitch_angle
        links += [(Region.LAND, middle, 0.0), (Region.ROOT, (1.0 - middle[1], 1.0 - middle[0]), next_root)]
    grids, regions = [], []
    for t in _spans(tooth, cells):
        sections = tooth.sections(t)
        for region, (start, end), turn in links:
            if region not in tooth.chain:
                continue
            count = max(FEWEST_CELLS, round(cells * SHARE.get(region, SHARE[Region.LAND] if not region.side else 1.0)))
            grid = tooth.grid(region, np.linspace(start, end, count + 1), sections).points
            if np.linalg.norm(np.diff(grid, axis=0), axis=-1).sum(axis=0).max() > NOTHING:
                grids.append(GridFlank(tooth.joint.to(turn).point(grid)))
                regions.append(region)
    return Half(PatchedFlank(tuple(grids)), tuple(regions))


def root_clearance(pair: GearPair, phi1: float, phi2: float, cells: int = HALF_CELLS) -> tuple[float, float]:
    """Clearance (mm) of the pinion's tips over the gear's root and of the gear's over the pinion's, negative inside.

    Of all teeth, on grids of their lands. inf where no tip is between the other member's ends.
    """
    places = [mount.at(phi) for mount, phi in zip(pair.mounts, (phi1, phi2), strict=True)]
    clearances = []
    for tip, root in ((0, 1), (1, 0)):
        tooth, blank = pair.both[tip].tooth, pair.both[root].tooth.blank
        land = tooth.grid(
            Region.LAND, np.linspace(0.0, 1.0, cells + 1), tooth.sections(np.linspace(0.0, 1.0, cells + 1))
        )
        every = tooth.joint.to(tooth.joint.places(tooth.teeth)[:, None] * tooth.pitch_angle)
        points = (places[root].inverse @ places[tip]).point(every.point(land.points.reshape(-1, 3)).reshape(-1, 3))
        station = blank.axial.value(points)
        between = (station - blank.extent[0]) * (station - blank.extent[1]) <= 0.0
        over = blank.root.value(points[between])
        clearances.append(float(over.min(initial=np.inf)))
    return clearances[0], clearances[1]


def _spans(tooth: Tooth, cells: int) -> list[Array]:
    """Stations t of grids from toe to heel, one for each part between corners of the form point of flank and fillet."""
    ends = np.concatenate(([0.0], tooth.breaks, [1.0]))
    # as many for every turn of a thread
    cells = round(cells * count) if (count := turns(tooth)) >= WOUND else cells
    return [np.linspace(a, b, max(FEWEST_CELLS, int(np.ceil(cells * (b - a)))) + 1) for a, b in pairwise(ends) if b > a]
