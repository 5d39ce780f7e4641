"""Whether a pair of gears fits: backlash over the mesh cycle, clearance of the tips, and what interferes.

The first touch of the driving flanks limits the rotation of the gear in one sense, that of the coast flanks in the other. The
rotation between them is the backlash; where it is negative the pair is jammed. Where a tip touches a fillet before the flanks
touch, the flanks are kept apart: this is interference, by the depth of the tip in the fillet were the flanks in contact. So it is
where tips meet beside the mesh, as they pass each other, before the flanks do.

A tooth of the pinion stays in one space of the gear from where it comes in to where it leaves. All tooth pairs are counted alike,
so the other side of that space is the next tooth of the gear, and backlash is known as it is, not modulo the pitch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.even_edges import to_middle
from gearmesh.contact.conditions.lines import trace
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.curve import LEVEL, MeshCurve
from gearmesh.contact.engagement.displaced import displaced_gears
from gearmesh.contact.engagement.engagement import PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.engagement.symmetry import ImageCurve, image
from gearmesh.contact.engagement.tip_passing import tip_meetings
from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.fit.clearance import Clearance, tip_clearance
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import FILLET, HAS_FILLET, PARTS, Pair
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.roots import bracketed_root, last_true
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import Side

#: advance (rad) of a fillet over the flanks from which on it counts as interference (0.05 arcsec)
AHEAD = 2.5e-7
#: finer lattices about the phase of the deepest interference
ROUNDS = 4
#: backlash and clearance (mm) that miss zero by less are zero: rounding
NOTHING = 1e-6
#: depths (mm) of tips that rounding alone tells apart
ALIKE = 1e-9
#: rad by which the phase of the least backlash may be off, of which the square counts
LEVELLED = 1e-6
#: rad to which it is found where tooth pairs change over, of whose advances the slopes are small
CHANGED_OVER = 1e-7
#: phases of a pitch from which the gear's place is taken for the clearances, and at which it is looked whether anything touches
PHASES, SEEN = 33, 97


@dataclass(frozen=True)
class Interference:
    """A tip that touches the mating gear's fillet before the flanks touch.

    `depth` (mm, along the fillet's normal) by which it would be in it were the flanks in contact; phi1 (rad); the place (3,), fixed
    frame, mm; whose fillet it is (0 pinion, 1 gear), and whether on the side of the flanks that drive.
    """

    depth: float
    phi1: float
    point: Array
    fillet_of: int
    driving: bool


@dataclass(frozen=True)
class TipCollision:
    """Tips that meet beside the mesh, as they pass each other, before the flanks touch.

    `depth` (mm, along the normal of the pinion's flank) by which they would overlap were the flanks in contact; phi1 (rad) where
    they meet; the point (3,), fixed frame, mm; whether on the side of the flanks that drive. `ahead`: how far (rad) the gear is
    then ahead of the nominal ratio.
    """

    depth: float
    phi1: float
    point: Array
    driving: bool
    ahead: float


@dataclass(frozen=True)
class Gap:
    """Between `begin` and `end` (rad, of a pitch) no tooth pair touches on the flanks that drive, or else on the others."""

    begin: float
    end: float
    driving: bool


@dataclass(frozen=True)
class Fit:
    """How a pair of gears fits.

    `backlash`: least and greatest rotation (rad) of the gear between its two first touches over the mesh cycle, negative where the
    pair is jammed, over the part in which both sides touch, NaN where there is none; `gaps`: the other parts;
    `normal_backlash` (mm): the same along the normal of contact;
    `transverse_backlash` (mm): on the gear's pitch circle, of radius `pitch_radius` (mm), which goes through the pitch point where
    the axes are parallel, else through the point of contact nearest to phi1 = 0, of a line through its middle; `clearances`: of
    the tips of pinion and gear over the mating gear's root; `interference`: the deepest on each side; `collisions`: the tips that
    collide deepest beside the mesh on each side; `turns`: phi2 (rad) of the
    gear as it is driven, NaN where contact breaks off; `play`: rotation (rad) of the gear between its first touches at any phi1
    (rad), by its nodes where contact breaks off or fillets jam; `lever` (mm) of the normal of contact about the gear's axis;
    `span`: phi1 (rad) over which a tooth pair was followed; `coast`: the engagement of the coast flanks, None where it has not
    been followed, as it is an image of that of the others.
    """

    backlash: tuple[float, float]
    normal_backlash: tuple[float, float]
    transverse_backlash: tuple[float, float]
    pitch_radius: float
    clearances: tuple[Clearance | None, Clearance | None]
    interference: tuple[Interference, ...]
    turns: Callable[[Array], Array]
    play: Callable[[Array], Array]
    lever: float
    span: tuple[float, float]
    gaps: tuple[Gap, ...] = ()
    coast: Engagement | None = None
    collisions: tuple[TipCollision, ...] = ()

    @property
    def fits(self) -> bool | None:
        """Whether the gears turn without interference; None where that is not known: on some side, or in some part of the
        cycle, nothing touches, and no interference is known."""
        if self.slack < -NOTHING:
            return False
        return None if self.gaps or not np.isfinite(self.normal_backlash[0]) else True

    @property
    def jammed(self) -> bool:
        """Whether the gears cannot turn and thinner teeth would not help: tips overlap roots, or fillets or each other too while
        there is no backlash. Flanks alone that jam would touch in the same places were the teeth thinner."""
        return self._in_roots or (self.normal_backlash[0] < -NOTHING and bool(self.interference or self.collisions))

    @property
    def _in_roots(self) -> bool:
        return any(clearance is not None and clearance.distance < -NOTHING for clearance in self.clearances)

    def jams(self, phi1: Array) -> NDArray[np.bool_]:
        """At which rotations of the pinion the gears are `jammed`.

        Parameters
        ----------
        phi1 : numpy.ndarray of float (N,)
            Rotations, rad.

        Returns
        -------
        numpy.ndarray of bool (N,)
            True where no rotation of the gear is free.

        Examples
        --------
        >>> bool(gears.contact().fit.jams(np.zeros(1))[0])
        False
        """
        if not self.jammed:
            return np.zeros(len(phi1), dtype=bool)
        # teeth that cannot pass each other stop the gears, wherever in the cycle that is
        everywhere = self._in_roots or bool(self.collisions)
        jamming: NDArray[np.bool_] = np.full(len(phi1), True) if everywhere else self.play(phi1) < 0.0
        return jamming

    @property
    def slack(self) -> float:
        """Distance (mm) left before anything interferes; negative: the depth of interference."""
        values = [self.normal_backlash[0], *(-overlap.depth for overlap in self.interference)]
        values += [-tips.depth for tips in self.collisions]
        values += [clearance.distance for clearance in self.clearances if clearance is not None]
        return least(values)


def fit(pair: GearPair, drive: MeshCurve | None = None) -> Fit | None:
    """How a pair fits; `drive`: the curve of its driving flanks, if it is known. None where nothing touches. Eccentric members
    stay displaced as at phi1 = 0."""
    pair = displaced_gears(pair)
    both = _both(pair, _mesh_curve(pair) if drive is None else drive)
    return None if both is None else _fit(pair, *both)


def slack_of(pair: GearPair) -> float | None:
    """`Fit.slack` (mm) of a pair, None where nothing touches; where the nodes of its engagements show interference, the
    value by the nodes."""
    pair = displaced_gears(pair)
    both = _both(pair, _mesh_curve(pair))
    if both is None:
        return None
    forwards, backwards = both
    nodes, advances = np.linspace(0.0, pair.pitch, NODES + 1), forwards.at_nodes()
    plays = play(pair, advances + _at_nodes(backwards, nodes), wound=forwards.pair.wound)
    values = (_lever(pair, forwards.engagement)[0] * plays).tolist()
    values += [-overlap.depth for overlap in _in_the_way(pair, both, 0)]
    values += [-tips.depth for tips in _collisions(pair, both)]
    values += clearances_of(pair, gear_rotations(pair, nodes, advances))
    slack = least(values)
    return _fit(pair, *both).slack if slack >= -NOTHING else slack


def _both(pair: GearPair, forwards: MeshCurve | None) -> tuple[MeshCurve, MeshCurve | ImageCurve] | None:
    """The curve of the driving flanks, which is given, and that of the others; None where either touch nowhere."""
    if forwards is None:
        return None
    backwards: MeshCurve | ImageCurve | None = None
    other = solver_pair(reversed_pair(pair))
    if not (_ahead_at_nodes(forwards) > AHEAD).any() and _told_by_points(pair):
        backwards = image(forwards, other)
    if backwards is None:
        backwards = _curve(other, pair.pitch)
    return None if backwards is None else (forwards, backwards)


def _in_the_way(pair: GearPair, both: tuple[MeshCurve, MeshCurve | ImageCurve], rounds: int) -> Iterator[Interference]:
    """The deepest interference of each side that has any, by the nodes and so many rounds about them."""
    for driving, curve in zip((True, False), both, strict=True):
        # of an image no fillet is ahead
        if isinstance(curve, MeshCurve):
            overlap = _interference(curve.engagement, pair.pitch, rounds, driving=driving)
            if overlap is not None:
                yield overlap


def _fit(pair: GearPair, forwards: MeshCurve, backwards: MeshCurve | ImageCurve) -> Fit:
    """How a pair fits, from the curves of its driving flanks and of the others."""
    sides = [curve for curve in (forwards, backwards) if isinstance(curve, MeshCurve)]
    lever, radius = _lever(pair, forwards.engagement)
    nodes = np.linspace(0.0, pair.pitch, NODES + 1)
    wound = forwards.pair.wound
    plays = play(pair, forwards.at_nodes() + _at_nodes(backwards, nodes), wound=wound)
    # the nodes give the depth of teeth jammed in fillets
    rough = bool(
        np.nanmin(plays, initial=np.inf) * lever < -NOTHING and any((_ahead_at_nodes(s) > AHEAD).any() for s in sides)
    )
    known = plays[np.isfinite(plays)]
    backlash = (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
    both = forwards.whole and backwards.whole
    if both and not rough:
        backlash = _backlash(pair, forwards, backwards)
    gaps: tuple[Gap, ...] = ()
    if not (both and np.isfinite(backlash).all()):
        gaps = (*_gaps(forwards, driving=True), *_gaps(backwards, driving=False))
        phase = np.linspace(0.0, pair.pitch, SEEN)
        plays = play(pair, forwards.advance_as_known(phase) + backwards.advance_as_known(phase), wound=wound)
        known = plays[np.isfinite(plays)]
        backlash = (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
    turns = _turns(pair, forwards, nodes if rough else np.linspace(0.0, pair.pitch, PHASES))
    clearances = tip_clearance(pair, turns, 0), tip_clearance(pair, turns, 1)
    collisions = _collisions(pair, (forwards, backwards))
    if collisions:
        least_play = _least_play_of_tips(pair, (forwards, backwards), collisions)
        backlash = float(np.fmin(backlash[0], least_play)), float(np.fmax(backlash[1], least_play))
    low, high = backlash
    return Fit(
        backlash=backlash,
        normal_backlash=(low * lever, high * lever),
        transverse_backlash=(low * radius, high * radius),
        pitch_radius=radius,
        clearances=clearances,
        interference=tuple(_in_the_way(pair, (forwards, backwards), 0 if rough else ROUNDS)),
        turns=turns,
        play=_play_at(pair, (forwards, backwards), plays, exact=both and not rough),
        lever=lever,
        span=(float(forwards.phi1[0]), float(forwards.phi1[-1])),
        gaps=gaps,
        coast=backwards.engagement if isinstance(backwards, MeshCurve) else None,
        collisions=collisions,
    )


def _collisions(pair: GearPair, both: tuple[MeshCurve, MeshCurve | ImageCurve]) -> tuple[TipCollision, ...]:
    """The tips that collide deepest beside the mesh on each side that has any."""
    forwards, backwards = both
    first = _deepest_collision(forwards.pair, forwards, driving=True)
    if isinstance(backwards, MeshCurve):
        second = _deepest_collision(backwards.pair, backwards, driving=False)
    else:
        # of an image nothing collides but the image of what does
        second = first and _deepest_collision(solver_pair(reversed_pair(pair)), backwards, driving=False)
    return tuple(tips for tips in (first, second) if tips is not None)


def _deepest_collision(flanks: Pair, curve: MeshCurve | ImageCurve, *, driving: bool) -> TipCollision | None:
    """The tips that collide deepest beside the mesh on one side, whose flanks have the `curve`; None where none do."""
    nodes = _at_nodes(curve, np.linspace(0.0, curve.pitch, NODES + 1))
    low, high = float(np.nanmin(nodes)), float(np.nanmax(nodes))
    met = tip_meetings(flanks, high)
    # between nodes the curve may be lower still by as much as they differ
    met = met.rows(np.flatnonzero(met.excess > 2.0 * (low - high) + AHEAD))
    if not met.phi1.size:
        return None
    phase, ahead = np.mod(met.phi1, curve.pitch), high + met.excess
    known = curve.advance(phase) if curve.whole else curve.advance_as_known(phase)
    above = ahead - np.where(np.isfinite(known), known, high)
    if not flanks.nested and (above > AHEAD).any():
        # what first touch finds there is contact in the mesh, which the curve has but roughly
        own = np.flatnonzero(above > AHEAD)
        in_mesh = touches(flanks, met.phi1[own])[0].advance > ahead[own] - AHEAD
        above[own[in_mesh]] = 0.0
    depth = np.where(above > AHEAD, above * met.arm, 0.0)
    # of places alike along the face the middle one
    deepest = np.flatnonzero(depth >= depth.max() - ALIKE)
    k = int(deepest[len(deepest) // 2])
    if not depth[k] > NOTHING:
        return None
    return TipCollision(float(depth[k]), float(met.phi1[k]), met.point[k], driving, float(ahead[k]))


def _least_play_of_tips(
    pair: GearPair, both: tuple[MeshCurve, MeshCurve | ImageCurve], collisions: tuple[TipCollision, ...]
) -> float:
    """Least rotation (rad) of the gear between its first touches where tips collide, of all tooth pairs within half a turn."""
    pitch, joint = pair.pitch, pair.gear.mount.joint
    phase = np.mod([tips.phi1 for tips in collisions], pitch)
    count = int(np.pi / pitch)
    total = np.zeros(len(phase))
    for driving, side in ((True, both[0]), (False, both[1])):
        if isinstance(side, ImageCurve):
            curve, place, more = side.curve, np.mod(side.sum - phase, pitch), side.more
        else:
            curve, place, more = side, phase, 0.0
        around = place + np.arange(-count, count + 1)[:, None] * pitch
        far, reference = touches(curve.pair, around.ravel())[0].advance, np.nanmax(curve.at_nodes())
        touching = np.isfinite(far)
        far[touching] = reference + joint.within(far[touching] - reference)
        far = far.reshape(around.shape).max(axis=0)
        own = [tips.ahead if tips.driving == driving else -np.inf for tips in collisions]
        total += np.max([far + more, np.nan_to_num(side.advance_as_known(phase), nan=-np.inf), own], axis=0)
    return float(play(pair, total, wound=both[0].pair.wound).min())


def _at_nodes(curve: MeshCurve | ImageCurve, phase: Array) -> Array:
    """Advances (N,), rad, at the even phases (N,) of the nodes."""
    return curve.at_nodes() if isinstance(curve, MeshCurve) else curve.advance_as_known(phase)


def _gaps(curve: MeshCurve | ImageCurve, *, driving: bool) -> Iterator[Gap]:
    """Parts of a pitch in which no tooth pair touches, one after the other."""
    pitch = curve.pitch
    phase = np.linspace(0.0, pitch, SEEN)
    apart = np.isnan(curve.advance_as_known(phase))
    for run in np.split(np.arange(SEEN), np.flatnonzero(np.diff(apart.astype(int))) + 1):
        if not apart[run[0]]:
            continue
        inner = np.array([phase[run[0]], phase[run[-1]]])
        outer = np.array([phase[max(run[0] - 1, 0)], phase[min(run[-1] + 1, SEEN - 1)]])
        ends = last_true(lambda at, _: np.isnan(curve.advance_as_known(at)), inner, outer, rounds=2, split=8)[0]
        yield Gap(float(ends[0]), float(ends[1]), driving)


def reversed_pair(pair: GearPair) -> GearPair:
    """The pair on its other flanks, driven the other way."""
    first, second = pair.flanks
    return replace(pair, flanks=(first.other, second.other), drive=-pair.drive)


def centre_distance(pair: GearPair) -> float | None:
    """Distance (mm) between parallel axes of rotation, None where they are not parallel or a member has none."""
    first, second = pair.mounts
    if float(np.linalg.norm(np.cross(first.spin, second.spin))) >= MAX_SINE_OF_PARALLEL * abs(
        float(first.spin @ second.spin)
    ):
        return None
    return _off_axis(second.origin - first.origin, first.axis)


def clearances_of(pair: GearPair, turns: Callable[[Array], Array]) -> list[float]:
    """Clearances (mm) of both members' tips, as far as there are any."""
    return [clearance.distance for of in (0, 1) if (clearance := tip_clearance(pair, turns, of)) is not None]


def least(values: list[float]) -> float:
    """The least of those that are known, NaN if none is."""
    return min((value for value in values if np.isfinite(value)), default=np.nan)


def _mesh_curve(pair: GearPair) -> MeshCurve | None:
    return _curve(solver_pair(pair), pair.pitch)


def _curve(flanks: Pair, pitch: float) -> MeshCurve | None:
    engagement = whole_engagement(flanks, pitch)
    if engagement is None or not engagement.contacts.touching.any():
        return None
    return MeshCurve(engagement, pitch, CHANGED_OVER)


def _told_by_points(pair: GearPair) -> bool:
    """Whether all flanks are surfaces that agree where so many points of them do."""
    return not any(member.tooth.side(side).tabulated for member in pair.both for side in Side)


def _backlash(pair: GearPair, forwards: MeshCurve, backwards: MeshCurve | ImageCurve) -> tuple[float, float]:
    """Least and greatest rotation of the gear between its two first touches, rad."""
    curves = forwards, backwards
    phase = np.mod(np.concatenate([curve.marks[0] for curve in curves]), pair.pitch)
    if all(curve.arcs for curve in curves):
        phase = np.concatenate((phase, _level(curves, np.unique(np.append(phase, (0.0, pair.pitch))))))
    turns = play(pair, forwards.advance(phase) + backwards.advance(phase), wound=forwards.pair.wound)
    return (float(turns.min()), float(turns.max())) if turns.size else (np.nan, np.nan)


def play(pair: GearPair, advances: Array, *, wound: bool) -> Array:
    """Rotations (N,), rad, of the gear between its first touches on driving and coast flanks, whose advances' sums are given (N,).

    Advances are counted by tooth pairs, so that a space ends at the next tooth of the gear; full turns of it count as none, and of
    pinions that are `wound` full turns of the thread.
    """
    step, known = pair.gear.tooth.pitch_angle, advances[np.isfinite(advances)]
    if not known.size:
        return -advances
    turn = pair.gear.tooth.joint.cycle(pair.gear.tooth.teeth)
    if wound:
        turn = math.gcd(int(turn), pair.pinion.tooth.teeth)
    spaces = 1.0 - float(np.median(known)) / step
    whole = turn * round(spaces / turn) if math.isfinite(turn) else 0
    free: Array = -advances - step * (whole - 1.0)
    return free


def _play_at(
    pair: GearPair, curves: tuple[MeshCurve, MeshCurve | ImageCurve], plays: Array, *, exact: bool
) -> Callable[[Array], Array]:
    """Rotation (N,), rad, of the gear between its first touches at any phi1 (N,), rad: `exact` by both curves, or else by `plays`
    (M,) at even phases of a pitch."""
    even = np.linspace(0.0, pair.pitch, len(plays))
    if not exact:
        return lambda phi1: np.interp(np.mod(phi1, pair.pitch), even, plays)
    # the same teeth at all phases
    apart = float(plays[0]) + sum(float(curve.advance(even[:1])[0]) for curve in curves)

    def at(phi1: Array) -> Array:
        phase = np.mod(phi1, pair.pitch)
        return np.asarray(apart - curves[0].advance(phase) - curves[1].advance(phase))

    return at


def _level(curves: tuple[MeshCurve, MeshCurve | ImageCurve], phase: Array) -> Array:
    """Phases (rad) between neighbouring ones of `phase` (M,), ascending, at which the sum of two curves is level."""
    low, high = phase[:-1], phase[1:]
    numbers = [curve.carrier(0.5 * (low + high)) for curve in curves]

    def slope(at: Array, which: NDArray[np.intp]) -> Array:
        return curves[0].slope(at, numbers[0][which]) + curves[1].slope(at, numbers[1][which])

    ends = slope(np.concatenate((low, high)), np.tile(np.arange(len(low)), 2)).reshape(2, -1)
    k = np.flatnonzero((ends[0] * ends[1] < 0.0) & (np.abs(ends).min(axis=0) > LEVEL))
    roots = bracketed_root(lambda at, which: slope(at, k[which]), low[k], high[k], tolerance=LEVELLED)
    # contact on the end of a flank has no slope
    return roots.values[roots.converged]


def _lever(pair: GearPair, engagement: Engagement) -> tuple[float, float]:
    """Of a contact inside the flanks near phi1 = 0, or of edges or fillets if there is none: distance (mm) of its normal from the
    gear's axis; radius of the pitch circle, or what stands for it: the speed (mm/rad) of the point of contact."""
    contacts = engagement.flanks if engagement.flanks.touching.any() else engagement.contacts
    inside = contacts.touching & (contacts.edges[:, 0] < 0)
    there = np.flatnonzero(inside if inside.any() else contacts.touching)
    k = int(there[np.abs(engagement.phi1[there]).argmin()])
    lever, point = _normal(engagement.pair, contacts, engagement.phi1, k)
    first, second = pair.mounts
    apart = centre_distance(pair)
    if apart is not None:
        # external gears turn against each other, a ring with its pinion
        return lever, apart / abs(1.0 - pair.ratio * float(first.spin @ second.spin))
    return lever, float(np.linalg.norm(second.velocity(point)))


def _off_axis(r: Array, axis: Array) -> float:
    """Distance (mm) of a point (3,) from the axis through the origin."""
    return float(np.linalg.norm(r - (r @ axis) * axis))


def _normal(pair: Pair, contacts: Contacts, phi1: Array, k: int) -> tuple[float, Array]:
    """Distance (mm) from the gear's axis of the normal at contact k, of the fillet where one touches, and its point (3,); of
    contact along a line or an edge the middle counts, as any point of it may have been found."""
    part, own, phi1 = pair.parts[contacts.part[k]], contacts.at(np.array([k])), phi1[[k]]
    to_middle(part, phi1, own, int(own.part[0]))
    x = trace(part, phi1, own.x).x if own.line[0] else own.x
    touch = Conditions(part.flanks, phi1, pair.length).touch(x, np.array([0]))
    jet, gear = touch.fixed[_fillet_of(contacts, k)], part.gear.mount
    return float(np.abs(dot(jet.n, gear.velocity(jet.r)))[0]), jet.r[0]


def _ahead_at_nodes(curve: MeshCurve) -> Array:
    """By how much (K,), rad, fillets touch before flanks do at the nodes of the engagement."""
    followed = curve.engagement
    return _ahead(followed.contacts, _neighbours(followed.phi1, followed.flanks.advance, curve.pitch))


def _interference(engagement: Engagement, pitch: float, rounds: int, *, driving: bool) -> Interference | None:
    """The tip that keeps the flanks farthest apart, by the nodes and so many rounds about them; None where none does."""
    pair, phi1, step = engagement.pair, engagement.phi1, float(np.diff(engagement.phi1).max())
    contacts, every = engagement.contacts, phi1
    ahead = _ahead(contacts, _neighbours(phi1, engagement.flanks.advance, pitch))
    if not ahead.max() > AHEAD:
        return None
    for _ in range(rounds):
        k = int(ahead.argmax())
        if not ahead[k] > AHEAD:
            return None
        best = phi1[k]
        phi1 = best + step * np.linspace(-1.0, 1.0, 9)
        every = np.concatenate([phi1 + n * pitch for n in (0, -1, 1)])
        contacts, flanks = touches(pair, every)
        ahead = _ahead(contacts, flanks.advance.reshape(3, -1).max(axis=0))
        step *= 0.25
    k = int(ahead.argmax())
    lever, point = _normal(pair, contacts, every, k)
    depth = float(ahead[k]) * lever
    return Interference(depth, float(phi1[k]), point, _fillet_of(contacts, k), driving) if depth > NOTHING else None


def _fillet_of(contacts: Contacts, k: int) -> int:
    """Member whose fillet touches at position k: 0 pinion, 1 gear; 0 where none does."""
    return int(PARTS[contacts.part[k]][1] == FILLET)


def _ahead(contacts: Contacts, flanks: Array) -> Array:
    """By how much (N,), rad, fillets touch before the flanks do, whose advances are given (N,); 0 where no fillet touches."""
    count = len(flanks)
    by_fillet = HAS_FILLET[contacts.part[:count]]
    with np.errstate(invalid="ignore"):
        apart = contacts.advance[:count] - flanks
    return np.where(by_fillet & np.isfinite(apart), apart, 0.0)


def _neighbours(phi1: Array, advance: Array, pitch: float) -> Array:
    """The greatest advance (K,) of any tooth pair at nodes phi1 (K,) whose steps are whole parts of a pitch."""
    steps = round(pitch / float(np.diff(phi1).min()))
    best = advance.copy()
    for k in range(steps, len(advance), steps):
        best[k:] = np.maximum(best[k:], advance[:-k])
        best[:-k] = np.maximum(best[:-k], advance[k:])
    return best


def _turns(pair: GearPair, curve: MeshCurve, phase: Array) -> Callable[[Array], Array]:
    """phi2 of the gears at any phi1, by the advance at even phases (M,) of a pitch; NaN where contact breaks off."""
    if len(phase) == NODES + 1:
        return gear_rotations(pair, phase, curve.at_nodes())
    return gear_rotations(pair, phase, curve.advance(phase) if curve.whole else curve.advance_as_known(phase))


def gear_rotations(pair: GearPair, phase: Array, advance: Array) -> Callable[[Array], Array]:
    """phi2 at any phi1, by advances (M,) at phases (M,) of a pitch, rad."""
    return lambda phi1: pair.ratio * phi1 + pair.drive * np.interp(np.mod(phi1, pair.pitch), phase, advance)
