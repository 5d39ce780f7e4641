"""Rotations of all members of a gear set: every pair turns as the tooth pair that leads turns it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement.uneven_teeth import farther_out, flanks_ahead
from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES
from gearmesh.teeth.micro_geometry.placed_teeth import has_placed_teeth

#: rounds that find the rotation of a driving member from the driven member; each reduces the error to 1e-6 of itself
INVERSION_ROUNDS = 2
#: pitches each way among which a tooth pair that touches is searched, and beyond which threads have none
MAX_PITCHES_AWAY = 3
#: difference of phi2, rad, below which tooth pairs are equally far ahead
EQUAL_ADVANCE_RAD = 1e-9


@dataclass(frozen=True)
class LeadingPairs:
    """Tooth pairs that touch first at N positions."""

    #: numbers (N,): pair k stands where pair 0 stood k pitches before
    number: NDArray[np.intp]
    #: rotations (N,) of the pinion, rad
    rotation: Array
    #: rotations (N,) of the gear, rad; NaN where no teeth touch
    phi2: Array


def leading_turns(pair: GearPair, phi1: Array) -> tuple[Array, Array]:
    """Compute rotations (N,) of pinion and gear, rad, at phi1 (N,), rad, as the source counts it; NaN where no teeth touch.

    The teeth are those of solids: pitch deviations count if the teeth of solids have them.
    """
    leading = leading_pairs(_as_solids(pair), phi1)
    return np.where(np.isnan(leading.phi2), np.nan, leading.rotation), leading.phi2


def leading_pairs(pair: GearPair, phi1: Array) -> LeadingPairs:
    """Find the most advanced tooth pairs at phi1 (N,), rad, as the source counts it.

    Pairs that are led all round are searched all round, others around phi1 for as long as a pair farther away may lead. Of equally
    advanced pairs the one that is nearest to phi1 leads. Eccentricities and pitch deviations count.
    """
    rotation = _counted(pair, phi1)
    middle, turn = np.round(rotation / pair.pitch).astype(np.intp), (pair.pinion.tooth.teeth + 1) // 2
    near = turn if solver_pair(pair).led_all_round else 1
    spread, farthest = _spread(pair), max(turn, MAX_PITCHES_AWAY)
    away = np.array(sorted(range(-near, near + 1), key=abs), dtype=np.intp)
    phi2 = _phi2(pair, rotation, middle[:, None] + away)
    while near < farthest:
        ahead = np.where(np.isnan(phi2), -np.inf, pair.drive * phi2)
        inner, outer = ahead[:, :-2].max(axis=1), ahead[:, -2:].max(axis=1)
        searched = np.isfinite(inner) | (near >= MAX_PITCHES_AWAY)
        if not (~searched | (outer + spread > inner + EQUAL_ADVANCE_RAD)).any():
            break
        near += 1
        away = np.append(away, (-near, near))
        phi2 = np.concatenate((phi2, _phi2(pair, rotation, middle[:, None] + away[-2:])), axis=1)
    ahead = np.where(np.isnan(phi2), -np.inf, pair.drive * phi2)
    # columns begin with the nearest pairs
    first = np.argmax(ahead >= ahead.max(axis=1, keepdims=True) - EQUAL_ADVANCE_RAD, axis=1)
    return LeadingPairs(middle + away[first], rotation, phi2[np.arange(len(first)), first])


def as_pair_0(pair: GearPair, number: int) -> GearPair:
    """Return the pair whose tooth pair 0 stands as tooth pair `number` of eccentric members stands so many pitches later.

    The members are displaced as those; concentric pairs are returned as they are.
    """
    ahead = flanks_ahead(pair, np.array(number))
    outwards = farther_out(pair, np.array(number))
    if not pair.eccentric and not any(outwards):
        return pair
    later = number * pair.pitch

    def turned(member: Member, phi: float, outward: float) -> Member:
        x, y = Rigid.about_z(member.mount.sign * phi).rotation[:2, :2] @ np.array(member.mount.eccentricity)
        return replace(member, mount=replace(member.mount, eccentricity=(float(x) + outward, float(y))))

    return replace(
        pair,
        pinion=turned(pair.pinion, later - float(ahead[0]), float(outwards[0])),
        gear=turned(pair.gear, later * pair.ratio - float(ahead[1]), float(outwards[1])),
    )


def _as_solids(pair: GearPair) -> GearPair:
    """Return the pair with the pitch deviations that teeth of solids have."""

    def member(own: Member) -> Member:
        return own if has_placed_teeth(own) else replace(own, index=NO_INDEX_ANGLES)

    return replace(pair, pinion=member(pair.pinion), gear=member(pair.gear))


def _counted(pair: GearPair, phi1: Array) -> Array:
    """Return the rotations (N,), rad, of the pinion at phi1 (N,), rad, as the source counts it."""
    if pair.generation is None:
        return phi1
    pitches = np.round(phi1 / pair.pitch) * pair.pitch
    path = analyse(pair, phi1 - pitches)
    return np.where(path.touching, path.rotation + pitches, phi1)


def _spread(pair: GearPair) -> float:
    """Return the rotation of the gear, rad, by which pitch deviations let a tooth pair be ahead of another."""
    first, second = (
        float(np.ptp(member.index.of(side, member.tooth.teeth)))
        for member, side in zip(pair.both, pair.flanks, strict=True)
    )
    return abs(pair.ratio) * first + second


def _phi2(pair: GearPair, rotation: Array, number: NDArray[np.intp]) -> Array:
    """Compute rotations (N, K), rad, of the gear at which tooth pairs `number` (N, K) touch at rotations (N,) of the pinion.

    NaN where they do not touch. All pairs have the contact of pair 0, displaced and turned as they are.
    """
    first, second = flanks_ahead(pair, number)
    phi1, phi2 = rotation[:, None] + first - number * pair.pitch, np.empty(number.shape)
    displaced = pair.eccentric or any(any(member.index.outwards) for member in pair.both)
    for each in distinct(number).tolist() if displaced else (None,):
        own = np.ones(number.shape, dtype=bool) if each is None else number == each
        path = contact_path(solver_pair(pair if each is None else as_pair_0(pair, each)), phi1[own])
        phi2[own] = np.where(path.touching, path.phi2, np.nan)
    return phi2 + number * (pair.pitch * pair.ratio) - second


def train_turns(
    train: GearTrain, pair: GearPair, rotation: Array, phi2: Array, *, nominal: bool = False
) -> dict[str, Array]:
    """Compute rotations (N,), rad, of all members when the members of one `pair` are at `rotation` and `phi2` (N,).

    With `nominal` the contact of the other pairs is solved at the middle position alone, from which their members turn at their
    ratios: their transmission errors are left out.
    """
    turns = {pair.pinion.name: rotation, pair.gear.name: phi2}
    waiting = [other for other in train.pairs if other is not pair]
    middle = len(rotation) // 2
    solved = np.array([middle]) if nominal else np.arange(len(rotation))
    # pass the rotation on, mesh by mesh, from members whose rotation is known
    while waiting:
        known = [mesh for mesh in waiting if mesh.pinion.name in turns or mesh.gear.name in turns]
        if not known:
            break
        mesh = known[0]
        waiting = [other for other in waiting if other is not mesh]
        if mesh.gear.name not in turns:
            first, second, ratio = mesh.pinion.name, mesh.gear.name, mesh.ratio
            turned = leading_turns(mesh, turns[first][solved])[1]
        elif mesh.pinion.name not in turns:
            first, second, ratio = mesh.gear.name, mesh.pinion.name, 1.0 / mesh.ratio
            wanted = turns[first][solved]
            # invert phi2(phi1) by fixed-point iteration from the nominal ratio
            turned = wanted * ratio
            for _ in range(INVERSION_ROUNDS):
                turned = turned + (wanted - leading_turns(mesh, turned)[1]) * ratio
        else:
            continue
        turns[second] = turned + ratio * (turns[first] - turns[first][middle]) if nominal else turned
    return turns
