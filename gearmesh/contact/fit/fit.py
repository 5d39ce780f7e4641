"""Fit of a pair of gears: backlash over the mesh cycle, clearance of the tips, and interference.

The first touch of the driving flanks limits the rotation of the gear in one sense, the first touch of the coast flanks in the
other sense. The rotation between the two limits is the backlash; a negative backlash means a jammed pair. A tip that touches a
fillet before the flanks touch keeps the flanks apart. This is interference, and its depth is the depth of the tip in the fillet if
the flanks were in contact. Tips that meet beside the mesh before the flanks touch interfere too.

A tooth of the pinion stays in one space of the gear from entering to leaving the mesh. The count of tooth pairs is the same on
both sides, so the other side of the space is the next tooth of the gear. Backlash is therefore an absolute value and not a value
modulo the pitch.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.bent_lines import directions
from gearmesh.contact.conditions.even_edges import to_middle
from gearmesh.contact.conditions.lines import trace
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import Contacts
from gearmesh.contact.engagement.curve import LEVEL_SLOPE, MeshCurve
from gearmesh.contact.engagement.displaced import displaced_gears
from gearmesh.contact.engagement.engagement import NODES_PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.engagement.symmetry import ImageCurve, image
from gearmesh.contact.engagement.tip_passing import tip_meetings
from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.fit.clearance import Clearance, tip_clearance
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import FILLET_PART, HAS_FILLET, PART_PAIRS, Pair
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric.algebra import Array, distinct, dot, median
from gearmesh.kernel.numeric.roots import bracketed_root, last_true
from gearmesh.kernel.surface.nearest import tangential
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import Side

#: least advance (rad) of a fillet over the flanks that counts as interference (0.05 arcsec)
MIN_INTERFERENCE_RAD = 2.5e-7
#: lattices about the phase of the deepest interference
REFINING_ROUNDS = 4
#: backlash and clearance (mm) that miss zero by less are rounding errors
ROUNDING_MM = 1e-6
#: depths (mm) of tips that differ by less are equal
EQUAL_DEPTH_MM = 1e-9
#: error (rad) of the phase of the least backlash; the backlash is off by its square
LEVEL_PHASE_TOLERANCE_RAD = 1e-6
#: error (rad) of the phase at which tooth pairs change over; the slopes of their advances are small
CHANGE_OVER_TOLERANCE_RAD = 1e-7
#: phases of a pitch for which clearances know the gear's rotation
CLEARANCE_PHASES = 33
#: change of a lever over the length of a flank, by the lever, that is rounding
EVEN_LEVER_SHARE = 1e-10
#: phases of a pitch at which gaps of contact are looked for
GAP_PHASES = 97


@dataclass(frozen=True)
class Interference:
    """Interference of a tip with the mating gear's fillet before the flanks touch."""

    #: depth of the tip in the fillet if the flanks were in contact, mm along the fillet's normal
    depth: float
    #: rotation of the pinion, rad
    phi1: float
    #: place (3,), fixed frame, mm
    point: Array
    #: member that has the fillet: 0 pinion, 1 gear
    fillet_of: int
    #: True on the side of the driving flanks
    driving: bool


@dataclass(frozen=True)
class TipCollision:
    """Collision of tips beside the mesh, where tips pass each other, before the flanks touch."""

    #: overlap of the tips if the flanks were in contact, mm along the normal of the pinion's flank
    depth: float
    #: rotation of the pinion where the tips meet, rad
    phi1: float
    #: point (3,), fixed frame, mm
    point: Array
    #: True on the side of the driving flanks
    driving: bool
    #: advance of the gear over the nominal ratio where the tips meet, rad
    ahead: float


@dataclass(frozen=True)
class Gap:
    """Part of a pitch from `begin` to `end` (rad) without contact, on the driving or on the coast flanks."""

    begin: float
    end: float
    driving: bool


@dataclass(frozen=True)
class Fit:
    """Fit of a pair of gears."""

    #: least and greatest rotation of the gear between its two first touches over the mesh cycle, rad, negative where the pair is
    #: jammed; over the part of the cycle in which both sides touch, NaN where no such part exists
    backlash: tuple[float, float]
    #: `backlash` along the normal of contact, mm
    normal_backlash: tuple[float, float]
    #: `backlash` on the gear's pitch circle, mm
    transverse_backlash: tuple[float, float]
    #: radius of the gear's pitch circle, mm: through the pitch point on parallel axes, else through the point of contact nearest to
    #: phi1 = 0 (of a line of contact, its middle)
    pitch_radius: float
    #: clearances of the tips of pinion and gear over the mating gear's root
    clearances: tuple[Clearance | None, Clearance | None]
    #: deepest interference on each side that has any
    interference: tuple[Interference, ...]
    #: phi2 (rad) of the driven gear at any phi1 (rad), NaN where contact breaks off
    turns: Callable[[Array], Array]
    #: rotation (rad) of the gear between its first touches at any phi1 (rad), by nodes where contact breaks off or fillets jam
    play: Callable[[Array], Array]
    #: distance of the normal of contact from the gear's axis, mm
    lever: float
    #: phi1 over which a tooth pair was followed, rad
    span: tuple[float, float]
    #: parts of a pitch without contact
    gaps: tuple[Gap, ...] = ()
    #: curve of the coast flanks, None where it is an image of the curve of the driving flanks
    coast_curve: MeshCurve | None = None
    #: diagonal of the map of own frames that makes this image; None where the coast flanks are no image
    exchange: Array | None = None
    #: deepest collision of tips beside the mesh on each side that has any
    collisions: tuple[TipCollision, ...] = ()

    @property
    def fits(self) -> bool | None:
        """True if the gears turn without interference.

        None if no interference is known but nothing touches on one side or in some part of the cycle.
        """
        if self.slack < -ROUNDING_MM:
            return False
        return None if self.gaps or not np.isfinite(self.normal_backlash[0]) else True

    @property
    def jammed(self) -> bool:
        """True if the gears cannot turn and thinner teeth would not help.

        Tips overlap roots, or there is no backlash and tips overlap fillets or other tips. Where only the flanks jam, thinner
        teeth would touch in the same places.
        """
        return self._tips_in_roots or (
            self.normal_backlash[0] < -ROUNDING_MM and bool(self.interference or self.collisions)
        )

    @property
    def _tips_in_roots(self) -> bool:
        return any(clearance is not None and clearance.distance < -ROUNDING_MM for clearance in self.clearances)

    def jams(self, phi1: Array) -> NDArray[np.bool_]:
        """Return the rotations of the pinion at which the gears are `jammed`.

        `phi1`: rotations, rad.
        """
        if not self.jammed:
            return np.zeros(len(phi1), dtype=bool)
        # teeth that cannot pass each other stop the gears at every rotation
        everywhere = self._tips_in_roots or bool(self.collisions)
        jamming: NDArray[np.bool_] = np.full(len(phi1), True) if everywhere else self.play(phi1) < 0.0
        return jamming

    @property
    def slack(self) -> float:
        """Distance (mm) left before anything interferes; a negative value is the depth of interference."""
        values = [self.normal_backlash[0], *(-overlap.depth for overlap in self.interference)]
        values += [-tips.depth for tips in self.collisions]
        values += [clearance.distance for clearance in self.clearances if clearance is not None]
        return least(values)


def fit(pair: GearPair, drive: MeshCurve | None = None) -> Fit | None:
    """Compute the fit of a pair; None where nothing touches.

    `drive` is the curve of the driving flanks, if it is known. Eccentric members stay displaced as at phi1 = 0.
    """
    pair = displaced_gears(pair)
    both = _both_curves(pair, _mesh_curve(pair) if drive is None else drive)
    return None if both is None else _fit(pair, *both)


def slack_of(pair: GearPair) -> float | None:
    """Compute `Fit.slack` (mm) of a pair; None where nothing touches.

    Where the nodes of the engagements show interference, the slack comes from the nodes.
    """
    pair = displaced_gears(pair)
    both = _both_curves(pair, _mesh_curve(pair))
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
    return _fit(pair, *both).slack if slack >= -ROUNDING_MM else slack


def _both_curves(pair: GearPair, forwards: MeshCurve | None) -> tuple[MeshCurve, MeshCurve | ImageCurve] | None:
    """Return the given curve of the driving flanks and the curve of the coast flanks; None where one side touches nowhere."""
    if forwards is None:
        return None
    backwards: MeshCurve | ImageCurve | None = None
    other = solver_pair(reversed_pair(pair))
    if not (_ahead_at_nodes(forwards) > MIN_INTERFERENCE_RAD).any() and _told_by_points(pair):
        backwards = image(forwards, other)
    if backwards is None:
        backwards = _curve(other, pair.pitch)
    return None if backwards is None else (forwards, backwards)


def _in_the_way(pair: GearPair, both: tuple[MeshCurve, MeshCurve | ImageCurve], rounds: int) -> Iterator[Interference]:
    """Yield the deepest interference of each side that has any, by the nodes and `rounds` of lattices about the deepest node."""
    for driving, curve in zip((True, False), both, strict=True):
        # an image is only made where no fillet touches before the flanks
        if isinstance(curve, MeshCurve):
            overlap = _interference(curve.engagement, pair.pitch, rounds, driving=driving)
            if overlap is not None:
                yield overlap


def _fit(pair: GearPair, forwards: MeshCurve, backwards: MeshCurve | ImageCurve) -> Fit:
    """Compute the fit of a pair from the curves of its driving and coast flanks."""
    sides = [curve for curve in (forwards, backwards) if isinstance(curve, MeshCurve)]
    lever, radius = _lever(pair, forwards.engagement)
    nodes = np.linspace(0.0, pair.pitch, NODES + 1)
    wound = forwards.pair.wound
    plays = play(pair, forwards.at_nodes() + _at_nodes(backwards, nodes), wound=wound)
    # where teeth jam in fillets the values at the nodes are deep enough: no curve is followed between the nodes
    rough = bool(
        np.nanmin(plays, initial=np.inf) * lever < -ROUNDING_MM
        and any((_ahead_at_nodes(s) > MIN_INTERFERENCE_RAD).any() for s in sides)
    )
    known = plays[np.isfinite(plays)]
    backlash = (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
    both = forwards.whole and backwards.whole
    if both and not rough:
        backlash = _backlash(pair, forwards, backwards)
    # where contact breaks off, backlash is known at the phases that touch on both sides; the other parts are gaps
    gaps: tuple[Gap, ...] = ()
    if not (both and np.isfinite(backlash).all()):
        gaps = (*_gaps(forwards, driving=True), *_gaps(backwards, driving=False))
        phase = np.linspace(0.0, pair.pitch, GAP_PHASES)
        plays = play(pair, forwards.advance_as_known(phase) + backwards.advance_as_known(phase), wound=wound)
        known = plays[np.isfinite(plays)]
        backlash = (float(known.min()), float(known.max())) if known.size else (np.nan, np.nan)
    # tips are moved with the gear as the driving flanks turn it
    turns = _turns(pair, forwards, nodes if rough else np.linspace(0.0, pair.pitch, CLEARANCE_PHASES))
    clearances = tip_clearance(pair, turns, 0), tip_clearance(pair, turns, 1)
    collisions = _collisions(pair, (forwards, backwards))
    # tips that collide beside the mesh take play away where no flank touches
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
        interference=tuple(_in_the_way(pair, (forwards, backwards), 0 if rough else REFINING_ROUNDS)),
        turns=turns,
        play=_play_at(pair, (forwards, backwards), plays, exact=both and not rough),
        lever=lever,
        span=(float(forwards.phi1[0]), float(forwards.phi1[-1])),
        gaps=gaps,
        coast_curve=backwards if isinstance(backwards, MeshCurve) else None,
        exchange=None if isinstance(backwards, MeshCurve) else backwards.exchange,
        collisions=collisions,
    )


def _collisions(pair: GearPair, both: tuple[MeshCurve, MeshCurve | ImageCurve]) -> tuple[TipCollision, ...]:
    """Return the deepest collision of tips beside the mesh on each side that has any."""
    forwards, backwards = both
    first = _deepest_collision(forwards.pair, forwards, driving=True)
    if isinstance(backwards, MeshCurve):
        second = _deepest_collision(backwards.pair, backwards, driving=False)
    else:
        # the image collides exactly where the driving side collides
        second = first and _deepest_collision(solver_pair(reversed_pair(pair)), backwards, driving=False)
    return tuple(tips for tips in (first, second) if tips is not None)


def _deepest_collision(flanks: Pair, curve: MeshCurve | ImageCurve, *, driving: bool) -> TipCollision | None:
    """Return the deepest collision of tips beside the mesh on the side whose flanks have the `curve`; None without a collision."""
    nodes = _at_nodes(curve, np.linspace(0.0, curve.pitch, NODES + 1))
    low, high = float(np.nanmin(nodes)), float(np.nanmax(nodes))
    met = tip_meetings(flanks, high)
    # between nodes the curve may be lower by as much as the nodes differ
    met = met.rows(np.flatnonzero(met.excess > 2.0 * (low - high) + MIN_INTERFERENCE_RAD))
    if not met.phi1.size:
        return None
    phase, ahead = np.mod(met.phi1, curve.pitch), high + met.excess
    known = curve.advance(phase) if curve.whole else curve.advance_as_known(phase)
    above = ahead - np.where(np.isfinite(known), known, high)
    if not flanks.nested and (above > MIN_INTERFERENCE_RAD).any():
        # a meeting that first touch finds as well is contact in the mesh, which the curve knows only roughly
        own = np.flatnonzero(above > MIN_INTERFERENCE_RAD)
        in_mesh = touches(flanks, met.phi1[own])[0].advance > ahead[own] - MIN_INTERFERENCE_RAD
        above[own[in_mesh]] = 0.0
    depth = np.where(above > MIN_INTERFERENCE_RAD, above * met.arm, 0.0)
    # of equal depths along the face take the middle
    deepest = np.flatnonzero(depth >= depth.max() - EQUAL_DEPTH_MM)
    k = int(deepest[len(deepest) // 2])
    if not depth[k] > ROUNDING_MM:
        return None
    return TipCollision(float(depth[k]), float(met.phi1[k]), met.point[k], driving, float(ahead[k]))


def _least_play_of_tips(
    pair: GearPair, both: tuple[MeshCurve, MeshCurve | ImageCurve], collisions: tuple[TipCollision, ...]
) -> float:
    """Compute the least rotation (rad) of the gear between its first touches where tips collide.

    All tooth pairs within half a turn of the gear count.
    """
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
    """Return advances (N,), rad, at the equally spaced phases (N,) of the nodes."""
    return curve.at_nodes() if isinstance(curve, MeshCurve) else curve.advance_as_known(phase)


def _gaps(curve: MeshCurve | ImageCurve, *, driving: bool) -> Iterator[Gap]:
    """Yield the parts of a pitch in which no tooth pair touches, in ascending order."""
    pitch = curve.pitch
    phase = np.linspace(0.0, pitch, GAP_PHASES)
    apart = np.isnan(curve.advance_as_known(phase))
    for run in np.split(np.arange(GAP_PHASES), np.flatnonzero(np.diff(apart.astype(int))) + 1):
        if not apart[run[0]]:
            continue
        inner = np.array([phase[run[0]], phase[run[-1]]])
        outer = np.array([phase[max(run[0] - 1, 0)], phase[min(run[-1] + 1, GAP_PHASES - 1)]])
        ends = last_true(lambda at, _: np.isnan(curve.advance_as_known(at)), inner, outer, rounds=2, split=8)[0]
        yield Gap(float(ends[0]), float(ends[1]), driving)


def reversed_pair(pair: GearPair) -> GearPair:
    """Return the pair on its coast flanks, driven in the other sense."""
    first, second = pair.flanks
    return replace(pair, flanks=(first.other, second.other), drive=-pair.drive)


def centre_distance(pair: GearPair) -> float | None:
    """Return the distance (mm) between parallel axes of rotation; None for other axes and for members without an axis."""
    first, second = pair.mounts
    if float(np.linalg.norm(np.cross(first.spin, second.spin))) >= MAX_SINE_OF_PARALLEL * abs(
        float(first.spin @ second.spin)
    ):
        return None
    return _off_axis(second.origin - first.origin, first.axis)


def clearances_of(pair: GearPair, turns: Callable[[Array], Array]) -> list[float]:
    """Return the known clearances (mm) of the tips of pinion and gear."""
    return [clearance.distance for of in (0, 1) if (clearance := tip_clearance(pair, turns, of)) is not None]


def least(values: list[float]) -> float:
    """Return the least finite value, NaN if no value is finite."""
    return min((value for value in values if np.isfinite(value)), default=np.nan)


def _mesh_curve(pair: GearPair) -> MeshCurve | None:
    return _curve(solver_pair(pair), pair.pitch)


def _curve(flanks: Pair, pitch: float) -> MeshCurve | None:
    engagement = whole_engagement(flanks, pitch)
    if engagement is None or not engagement.contacts.touching.any():
        return None
    return MeshCurve(engagement, pitch, CHANGE_OVER_TOLERANCE_RAD)


def _told_by_points(pair: GearPair) -> bool:
    """Return True if no flank is a table: two analytic flanks that agree at many points agree everywhere."""
    return not any(member.tooth.side(side).tabulated for member in pair.both for side in Side)


def _backlash(pair: GearPair, forwards: MeshCurve, backwards: MeshCurve | ImageCurve) -> tuple[float, float]:
    """Compute the least and greatest rotation of the gear between its two first touches, rad."""
    curves = forwards, backwards
    phase = np.mod(np.concatenate([curve.marks[0] for curve in curves]), pair.pitch)
    if all(curve.arcs for curve in curves):
        phase = np.concatenate((phase, _level(curves, distinct(np.append(phase, (0.0, pair.pitch))))))
    turns = play(pair, forwards.advance(phase) + backwards.advance(phase), wound=forwards.pair.wound)
    return (float(turns.min()), float(turns.max())) if turns.size else (np.nan, np.nan)


def play(pair: GearPair, advances: Array, *, wound: bool) -> Array:
    """Compute rotations (N,), rad, of the gear between its first touches, from sums (N,) of driving and coast advances.

    Advances are counted by tooth pairs, so a space ends at the next tooth of the gear. Full turns of the gear count as zero; for a
    `wound` pinion (a worm), full turns of the thread do.
    """
    step, known = pair.gear.tooth.pitch_angle, advances[np.isfinite(advances)]
    if not known.size:
        return -advances
    turn = pair.gear.tooth.joint.cycle(pair.gear.tooth.teeth)
    if wound:
        turn = math.gcd(int(turn), pair.pinion.tooth.teeth)
    spaces = 1.0 - median(known) / step
    whole = turn * round(spaces / turn) if math.isfinite(turn) else 0
    free: Array = -advances - step * (whole - 1.0)
    return free


def _play_at(
    pair: GearPair, curves: tuple[MeshCurve, MeshCurve | ImageCurve], plays: Array, *, exact: bool
) -> Callable[[Array], Array]:
    """Return the rotation (N,), rad, of the gear between its first touches as a function of phi1 (N,), rad.

    The function is `exact` by both curves, or else interpolates `plays` (M,) at equally spaced phases of a pitch.
    """
    even = np.linspace(0.0, pair.pitch, len(plays))
    if not exact:
        return lambda phi1: np.interp(np.mod(phi1, pair.pitch), even, plays)
    # the count of teeth in the play at phase 0 holds at all phases
    apart = float(plays[0]) + sum(float(curve.advance(even[:1])[0]) for curve in curves)

    def at(phi1: Array) -> Array:
        phase = np.mod(phi1, pair.pitch)
        return np.asarray(apart - curves[0].advance(phase) - curves[1].advance(phase))

    return at


def _level(curves: tuple[MeshCurve, MeshCurve | ImageCurve], phase: Array) -> Array:
    """Solve for the phases (rad) at which the sum of two curves is level, one in each interval of `phase` (M,), ascending."""
    low, high = phase[:-1], phase[1:]
    numbers = [curve.carrier(0.5 * (low + high)) for curve in curves]

    def slope(at: Array, which: NDArray[np.intp]) -> Array:
        return curves[0].slope(at, numbers[0][which]) + curves[1].slope(at, numbers[1][which])

    ends = slope(np.concatenate((low, high)), np.tile(np.arange(len(low)), 2)).reshape(2, -1)
    k = np.flatnonzero((ends[0] * ends[1] < 0.0) & (np.abs(ends).min(axis=0) > LEVEL_SLOPE))
    roots = bracketed_root(lambda at, which: slope(at, k[which]), low[k], high[k], tolerance=LEVEL_PHASE_TOLERANCE_RAD)
    # a root is not converged where contact stands on the end of a flank, which has no slope
    return roots.values[roots.converged]


def _lever(pair: GearPair, engagement: Engagement) -> tuple[float, float]:
    """Return the distance (mm) of the normal of contact from the gear's axis, and the radius (mm) of the gear's pitch circle.

    The contact is the contact inside the flanks nearest to phi1 = 0, or on edges or fillets if no other exists. Where the axes are
    not parallel, the speed (mm/rad) of the point of contact stands for the radius. For coupled members it is the radius of the
    middle of the gear's flank.
    """
    contacts = engagement.flanks if engagement.flanks.touching.any() else engagement.contacts
    inside = contacts.touching & (contacts.edges[:, 0] < 0)
    there = np.flatnonzero(inside if inside.any() else contacts.touching)
    k = int(there[np.abs(engagement.phi1[there]).argmin()])
    first, second = pair.mounts
    apart = centre_distance(pair)
    even = _even_lever(engagement.pair, contacts, engagement.phi1, k) if apart is not None else None
    lever, point = (even, np.zeros(3)) if even is not None else _normal(engagement.pair, contacts, engagement.phi1, k)
    if engagement.pair.coupled:
        # without a pitch point: the middle of the gear's flank
        flank = engagement.pair.gear
        middle = flank.grid[flank.grid.shape[0] // 2, flank.grid.shape[1] // 2]
        return lever, float(np.hypot(*flank.surface.jet(*middle).r[:2]))
    if apart is not None:
        # external gears turn against each other, a ring with its pinion
        return lever, apart / abs(1.0 - pair.ratio * float(first.spin @ second.spin))
    return lever, float(np.linalg.norm(second.velocity(point)))


def _off_axis(r: Array, axis: Array) -> float:
    """Return the distance (mm) of a point (3,) from the axis through the origin."""
    return float(np.linalg.norm(r - (r @ axis) * axis))


def _normal(pair: Pair, contacts: Contacts, phi1: Array, k: int) -> tuple[float, Array]:
    """Return the distance (mm) of the normal at contact k from the gear's axis, and the point (3,) of contact.

    The normal is the fillet's where a fillet touches. Contact along a line or an edge counts at its middle, because the search
    may stop at any of its points.
    """
    part, own, phi1 = pair.parts[contacts.part[k]], contacts.at(np.array([k])), phi1[[k]]
    to_middle(part, phi1, own, int(own.part[0]))
    x = trace(part, phi1, own.x).x if own.line[0] else own.x
    touch = Conditions(part.flanks, phi1, pair.length).touch(x, np.array([0]))
    jet, gear = touch.fixed[_fillet_of(contacts, k)], part.gear.mount
    return float(np.abs(dot(jet.n, gear.velocity(jet.r)))[0]), jet.r[0]


def _even_lever(pair: Pair, contacts: Contacts, phi1: Array, k: int) -> float | None:
    """Return the distance (mm) of the normal at contact k from the gear's axis; None unless all of a line of contact has it.

    The middle of the line, which takes a search, is not needed then.
    """
    if not contacts.line[k]:
        return None
    part = pair.parts[contacts.part[k]]
    touch = Conditions(part.flanks, phi1[[k]], part.length).touch(contacts.x[[k]], np.array([0]))
    jet, velocity = touch.fixed[0], part.gear.mount.velocity
    along = directions(part, touch)[0]
    turning = jet.along(*tangential(jet, along))[1]
    speed = velocity(jet.r)
    lever = np.abs(dot(jet.n, speed))
    change = np.abs(dot(turning, speed) + dot(jet.n, velocity(jet.r + along) - speed))
    return float(lever[0]) if change[0] * part.length <= EVEN_LEVER_SHARE * lever[0] else None


def _ahead_at_nodes(curve: MeshCurve) -> Array:
    """Return advances (K,), rad, of fillets over flanks at the nodes of the engagement."""
    followed = curve.engagement
    return _ahead(followed.contacts, _neighbours(followed.phi1, followed.flanks.advance, curve.pitch))


def _interference(engagement: Engagement, pitch: float, rounds: int, *, driving: bool) -> Interference | None:
    """Find the tip that keeps the flanks farthest apart, by the nodes and `rounds` of lattices; None without interference."""
    pair, phi1, step = engagement.pair, engagement.phi1, float(np.diff(engagement.phi1).max())
    contacts, every = engagement.contacts, phi1
    ahead = _ahead(contacts, _neighbours(phi1, engagement.flanks.advance, pitch))
    if not ahead.max() > MIN_INTERFERENCE_RAD:
        return None
    for _ in range(rounds):
        k = int(ahead.argmax())
        if not ahead[k] > MIN_INTERFERENCE_RAD:
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
    return Interference(depth, float(phi1[k]), point, _fillet_of(contacts, k), driving) if depth > ROUNDING_MM else None


def _fillet_of(contacts: Contacts, k: int) -> int:
    """Return the member whose fillet touches at position k: 0 pinion, 1 gear; 0 where no fillet touches."""
    return int(PART_PAIRS[contacts.part[k]][1] == FILLET_PART)


def _ahead(contacts: Contacts, flanks: Array) -> Array:
    """Return advances (N,), rad, of fillets over the advances of `flanks` (N,); 0 where no fillet touches."""
    count = len(flanks)
    by_fillet = HAS_FILLET[contacts.part[:count]]
    with np.errstate(invalid="ignore"):
        apart = contacts.advance[:count] - flanks
    return np.where(by_fillet & np.isfinite(apart), apart, 0.0)


def _neighbours(phi1: Array, advance: Array, pitch: float) -> Array:
    """Return the greatest advance (K,), rad, of any tooth pair at nodes phi1 (K,), whose steps divide the pitch."""
    steps = round(pitch / float(np.diff(phi1).min()))
    best = advance.copy()
    for k in range(steps, len(advance), steps):
        best[k:] = np.maximum(best[k:], advance[:-k])
        best[:-k] = np.maximum(best[:-k], advance[k:])
    return best


def _turns(pair: GearPair, curve: MeshCurve, phase: Array) -> Callable[[Array], Array]:
    """Return phi2 (rad) of the gear as a function of phi1 (rad), by the curve at phases (M,); NaN where contact breaks off."""
    if len(phase) == NODES + 1:
        return gear_rotations(pair, phase, curve.at_nodes())
    return gear_rotations(pair, phase, curve.advance(phase) if curve.whole else curve.advance_as_known(phase))


def gear_rotations(pair: GearPair, phase: Array, advance: Array) -> Callable[[Array], Array]:
    """Return phi2 (rad) as a function of phi1 (rad), by advances (M,) at phases (M,) of a pitch, rad."""
    return lambda phi1: pair.ratio * phi1 + pair.drive * np.interp(np.mod(phi1, pair.pitch), phase, advance)
