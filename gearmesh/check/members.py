"""Whole members rolled against each other: the teeth that touch first, their regions, and the backlash.

Like the roll test, this check knows only surfaces and positions of the members. It takes one half of every tooth, from
the middle of the root to the middle of the land (`tooth_half`): fillet, flank, broken edge and land. Each half is a
dense grid of exact points. The check turns the gear until the halves of all tooth pairs within reach are free
(`touch.first_touch`). The other halves are treated in the same way and turn the gear the other way; the backlash lies
between the two.

Tooth pair k has at phi1 the contact of pair 0 at phi1 - k pitches. Its teeth are the teeth of pair 0, turned back by k
pitches of the pinion and of the gear. On the coast side the pinion's tooth k meets the gear's tooth before the tooth of
pair k.

The gear's own root and land are left out. They are surfaces of revolution, or planes along a rack, so that turning
(sliding) moves them in themselves, within the eccentricity of an eccentric gear. A pinion's tip deeper than the gear's
root is not seen here; `root_clearance` sees it. A gear's tip deeper than the pinion's root touches this root: such
gears are jammed. Their phi2 differs from the contact solver's curve, which includes flanks and fillets but no root.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.check.heightfield import Field, GridFlank, PatchedFlank, along
from gearmesh.check.roll import arcs_over
from gearmesh.check.touch import first_touch
from gearmesh.check.windings import MIN_WOUND_TURNS, WoundTouch, in_mesh, middle, turns, windings
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, TIP_EDGES, Region, Side
from gearmesh.teeth.tooth import Tooth

#: cells of a flank's grid in either direction; twice as many move phi2 by less than 0.005 arcsec (tests)
FLANK_CELLS = 80
#: cells of a half tooth's grids along a flank's profile and along the face
HALF_CELLS = 40
#: cells across other links, relative to the cells across the flank
CELL_SHARES = {
    **dict.fromkeys(FILLET_REGIONS.values(), 1.0),
    **dict.fromkeys(TIP_EDGES.values(), 0.5),
    Region.LAND: 0.25,
}
#: smallest number of cells across a grid
MIN_CELLS = 4
#: links that are nowhere longer are left out
MIN_LINK_LENGTH_MM = 1e-9
#: largest distance of an examined pair from the pair nominally in mesh, in pitches
MAX_PITCHES = 12
#: lag behind the first pair, in gear pitches, at which the search ends on one side
MAX_LAG_PITCHES = 0.5


@dataclass(frozen=True)
class ToothTouch:
    """First touch of the gear."""

    #: rotation of the gear, rad
    phi2: float
    #: number of the tooth pair that touches
    tooth: int
    #: touching regions of pinion and gear
    regions: tuple[Region, Region]
    #: True for a member that touches with the rim of its region, an edge
    on_rims: tuple[bool, bool]
    #: point of contact (3,), mm, in the fixed frame
    point: Array


@dataclass(frozen=True)
class MemberRoll:
    """First touches on both sides at one rotation of the pinion."""

    #: rotation of the pinion, rad
    phi1: float
    #: +1 if the drive side pushes the gear to larger phi2, else -1
    direction: int
    #: first touch on the drive side; None if nothing is within reach
    drive: ToothTouch | None
    #: first touch on the coast side; None if nothing is within reach
    coast: ToothTouch | None
    #: phi2 (rad) of every pair within reach on the drive side, by pair number
    pairs: dict[int, float]
    #: phi2 (rad) of every pair within reach on the coast side, by pair number
    coast_pairs: dict[int, float]

    @property
    def backlash(self) -> float:
        """Rotation of the gear (rad) between the touches: negative if the members overlap, NaN without both touches."""
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

    Without `coast` only the drive side is rolled, which is half of the work. Whole turns are added to phi2 to bring it
    next to `guess_phi2` (P,) or (), by default ratio * phi1. Raises TrimError if a tooth cannot be trimmed.
    """
    angles, guesses = _rotations(pair, phi1, guess_phi2)
    drive_side = _RolledSide.of(pair, coast=False, cells=cells)
    coast_side = _RolledSide.of(pair, coast=True, cells=cells) if coast else None
    rolls = []
    for angle, guess in zip(angles.tolist(), guesses.tolist(), strict=True):
        drive, drive_pairs = drive_side.at(angle, guess)
        coast_touch, coast_pairs = (None, dict[int, float]()) if coast_side is None else coast_side.at(angle, guess)
        if coast_side is not None and drive is not None and coast_touch is None:
            coast_touch, coast_pairs = coast_side.at(angle, drive.phi2)
        rolls.append(MemberRoll(angle, pair.drive, drive, coast_touch, drive_pairs, coast_pairs))
    return tuple(rolls)


def roll_flanks(
    pair: GearPair, phi1: ArrayLike, cells: int = FLANK_CELLS, guess_phi2: ArrayLike | None = None
) -> tuple[ToothTouch | None, ...]:
    """Roll the flanks of one tooth pair alone, on exact grids. None where they never meet.

    The arguments are those of `roll_members`.
    """
    halves = [flank_patches(m.one_tooth, side, cells) for m, side in zip(pair.both, pair.flanks, strict=True)]
    return _RolledSide.make(pair, pair.drive, 0, (halves[0], halves[1])).alone(*_rotations(pair, phi1, guess_phi2))


def roll_teeth(
    pair: GearPair, phi1: ArrayLike, cells: int = HALF_CELLS, guess_phi2: ArrayLike | None = None
) -> tuple[ToothTouch | None, ...]:
    """Roll the teeth of one pair alone on the drive side, including fillets and edges.

    The arguments are those of `roll_members`.
    """
    return _RolledSide.of(pair, coast=False, cells=cells).alone(*_rotations(pair, phi1, guess_phi2))


def _rotations(pair: GearPair, phi1: ArrayLike, guess_phi2: ArrayLike | None) -> tuple[Array, Array]:
    """Return the pinion's rotations (P,), and rotations (P,) next to which the gear's rotations are reported."""
    angles = np.atleast_1d(np.asarray(phi1, dtype=float))
    return angles, np.broadcast_to(pair.ratio * angles if guess_phi2 is None else np.asarray(guess_phi2), angles.shape)


# --- one side ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Half:
    """Half of a tooth in the member's frame: its grids, and the region of each grid."""

    flank: PatchedFlank
    regions: tuple[Region, ...]

    @property
    def points(self) -> Array:
        return self.flank.points

    def between(self, low: float, high: float) -> Half | None:
        """Return the part of the half between two z (mm), slightly extended; None if there is none."""
        parts = self.flank.parts_between(low, high)
        if not parts:
            return None
        return Half(PatchedFlank(tuple(parts.values())), tuple(self.regions[k] for k in parts))


@dataclass(frozen=True)
class _RolledSide:
    """One side of all teeth."""

    #: pair of members
    pair: GearPair
    #: +1 or -1, direction of phi2 in which the gear is pushed
    drive: int
    #: half tooth of the pinion, in pieces of less than a turn
    pinion: tuple[Half, ...]
    #: half tooth of the gear
    gear: Half
    #: half tooth of the unturned gear that meets the pinion's tooth k, over circles about the gear's axis
    gear_arcs: Callable[[int], Field]

    @staticmethod
    def of(pair: GearPair, coast: bool, cells: int) -> _RolledSide:
        sides = [side.other if coast else side for side in pair.flanks]
        pinion = tooth_half(pair.pinion.one_tooth, sides[0], cells)
        gear = tooth_half(pair.gear.one_tooth, sides[1], cells, turned=False)
        return _RolledSide.make(pair, -pair.drive if coast else pair.drive, -pair.drive if coast else 0, (pinion, gear))

    @staticmethod
    def make(pair: GearPair, drive: int, ahead: int, halves: tuple[Half, Half]) -> _RolledSide:
        """Return a rolled side.

        `ahead` is the gear's tooth counted from the tooth of the pair, in pitches of growing phi2.
        """
        mount, tooth = pair.gear.mount, pair.gear.tooth

        @cache
        def gear_arcs(k: int) -> Field:
            turn = mount.sign * (ahead * tooth.pitch_angle - k * pair.pitch * pair.ratio)
            own_to_base = mount.own_to_turning @ mount.joint.to(turn)
            return arcs_over(halves[1].flank, own_to_base, drive * mount.sign, side=-1.0, joint=mount.joint)

        return _RolledSide(pair, drive, windings(halves[0], turns(pair.pinion.tooth)), halves[1], gear_arcs)

    def at(self, phi1: float, guess: float) -> tuple[ToothTouch | None, dict[int, float]]:
        """Return the first touch of all pairs within reach, and phi2 of every pair."""
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
                # pairs farther out lag even more
                elif self.drive * (first.phi2 - touch.phi2) > MAX_LAG_PITCHES * self.pair.gear.tooth.pitch_angle:
                    break
        return first, all_pairs

    @property
    def _reach(self) -> int:
        """Number of pairs examined on either side: no tooth of the pinion occurs twice, except on wound threads."""
        return MAX_PITCHES if len(self.pinion) > 1 else min(MAX_PITCHES, (self.pair.pinion.tooth.teeth - 1) // 2)

    def alone(self, phi1: Array, guess: Array) -> tuple[ToothTouch | None, ...]:
        """Return the first touch of tooth pair 0 alone at every phi1 (P,)."""
        return tuple(self.touch(0, a, g, anywhere=True) for a, g in zip(phi1.tolist(), guess.tolist(), strict=True))

    def touch(self, k: int, phi1: float, guess: float, *, anywhere: bool = False) -> ToothTouch | None:
        """Return the first touch of tooth pair k alone.

        On a thread the winding next to phi2 = `guess` counts, or the nearest winding with `anywhere`.
        """
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
    """Yield pair numbers from the pair nominally in mesh outwards, `most` in one direction and then in the other."""
    yield range(start, start + most + 1)
    yield range(start - 1, start - most - 1, -1)


# --- halves of teeth --------------------------------------------------------------------------------------------------


def flank_patches(tooth: Tooth, side: Side, cells: int) -> Half:
    """Return the trimmed flank alone on exact grids of about `cells` x `cells`, cut at corners of its form point."""
    s = np.linspace(0.0, 1.0, cells + 1)
    grids = [tooth.flank_grid(side, s, t).points for t in _spans(tooth, cells)]
    return Half(PatchedFlank(tuple(GridFlank(grid) for grid in grids)), (FLANK_REGIONS[side],) * len(grids))


def tooth_half(tooth: Tooth, side: Side, cells: int, *, turned: bool = True) -> Half:
    """Return half of a tooth on exact grids, with `cells` cells along the flank's profile and along the face.

    Land and root are included if `turned`. Raises TrimError if the tooth cannot be trimmed.
    """
    middle = (0.0, 0.5) if side is Side.RIGHT else (0.5, 1.0)
    links = [
        (FLANK_REGIONS[side], (0.0, 1.0), 0.0),
        (FILLET_REGIONS[side], (0.0, 1.0), 0.0),
        (TIP_EDGES[side], (0.0, 1.0), 0.0),
    ]
    if turned:
        # right flank: second half of the root before the tooth; left flank: first half of the root after the tooth
        next_root = 0.0 if side is Side.RIGHT else tooth.pitch_angle
        links += [(Region.LAND, middle, 0.0), (Region.ROOT, (1.0 - middle[1], 1.0 - middle[0]), next_root)]
    grids, regions = [], []
    for t in _spans(tooth, cells):
        sections = tooth.sections(t)
        for region, (start, end), turn in links:
            if region not in tooth.chain:
                continue
            count = max(
                MIN_CELLS, round(cells * CELL_SHARES.get(region, CELL_SHARES[Region.LAND] if not region.side else 1.0))
            )
            grid = tooth.grid(region, np.linspace(start, end, count + 1), sections).points
            if np.linalg.norm(np.diff(grid, axis=0), axis=-1).sum(axis=0).max() > MIN_LINK_LENGTH_MM:
                grids.append(GridFlank(tooth.joint.to(turn).point(grid)))
                regions.append(region)
    return Half(PatchedFlank(tuple(grids)), tuple(regions))


def root_clearance(pair: GearPair, phi1: float, phi2: float, cells: int = HALF_CELLS) -> tuple[float, float]:
    """Return clearances (mm) of the pinion's tips over the gear's root, and of the gear's tips over the pinion's root.

    Clearances are negative inside the root, and inf if no tip lies between the other member's ends. All teeth are
    included, on grids of their lands.
    """
    places = [mount.at(phi) for mount, phi in zip(pair.mounts, (phi1, phi2), strict=True)]
    clearances = []
    for tip, root in ((0, 1), (1, 0)):
        tooth, blank = pair.both[tip].tooth, pair.both[root].tooth.blank
        land = tooth.grid(
            Region.LAND, np.linspace(0.0, 1.0, cells + 1), tooth.sections(np.linspace(0.0, 1.0, cells + 1))
        )
        to_teeth = tooth.joint.to(tooth.joint.places(tooth.teeth)[:, None] * tooth.pitch_angle)
        points = (places[root].inverse @ places[tip]).point(to_teeth.point(land.points.reshape(-1, 3)).reshape(-1, 3))
        station = blank.axial.value(points)
        between = (station - blank.extent[0]) * (station - blank.extent[1]) <= 0.0
        over = blank.root.value(points[between])
        clearances.append(float(over.min(initial=np.inf)))
    return clearances[0], clearances[1]


def _spans(tooth: Tooth, cells: int) -> list[Array]:
    """Return stations t of grids from toe to heel, one array per part between corners of the form point."""
    ends = np.concatenate(([0.0], tooth.breaks, [1.0]))
    # a thread gets `cells` cells per turn
    cells = round(cells * count) if (count := turns(tooth)) >= MIN_WOUND_TURNS else cells
    return [np.linspace(a, b, max(MIN_CELLS, int(np.ceil(cells * (b - a)))) + 1) for a, b in pairwise(ends) if b > a]
