"""Rotations of all members of a gear set: every pair turns as its tooth pair in contact turns it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member

#: rounds that find the rotation of a driving member from the driven member; each reduces the error to 1e-6 of itself
INVERSION_ROUNDS = 2


def pitches_around(pair: GearPair) -> int:
    """Return the pitches each way within which a tooth pair leads: half a turn of pairs that are led all round, else one."""
    return (pair.pinion.tooth.teeth + 1) // 2 if solver_pair(pair).led_all_round else 1


def leading_turns(pair: GearPair, phi1: Array, around: int | None = None) -> tuple[Array, Array]:
    """Compute rotations (N,) of pinion and gear, rad, at phi1 (N,), rad, of the pinion; NaN where no teeth touch.

    The most advanced tooth pair within `around` pitches decides, by default `pitches_around`.
    """
    around = pitches_around(pair) if around is None else around
    number = np.round(phi1 / pair.pitch)[:, None] + np.arange(-around, around + 1.0)
    rotation, phi2, touching = _tooth_pairs(pair, (phi1[:, None] - number * pair.pitch).ravel(), number.ravel())
    shifts = (number * pair.pitch).ravel()
    rotation, phi2 = rotation + shifts, phi2 + shifts * pair.ratio
    ahead = np.where(touching, pair.drive * phi2, -np.inf).reshape(number.shape)
    k = np.arange(len(phi1)) * number.shape[1] + ahead.argmax(axis=1)
    none = np.where(touching[k], 0.0, np.nan)
    return rotation[k] + none, phi2[k] + none


def _tooth_pairs(pair: GearPair, phi1: Array, number: Array) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Compute rotations (M,) of pinion and gear, rad, at which tooth pairs `number` (M,) touch, and whether they do.

    phi1 (M,), rad, and the rotations count as those of pair 0, which stands there k pitches before pair k.
    """
    if not pair.eccentric:
        path = analyse(pair, phi1)
        return path.rotation, path.phi2, path.touching
    rotation, phi2, touching = np.empty(phi1.shape), np.empty(phi1.shape), np.zeros(phi1.shape, dtype=bool)
    for each in distinct(number):
        own = number == each
        path = analyse(_displaced_alike(pair, float(each)), phi1[own])
        rotation[own], phi2[own], touching[own] = path.rotation, path.phi2, path.touching
    return rotation, phi2, touching


def _displaced_alike(pair: GearPair, number: float) -> GearPair:
    """Return a pair whose tooth pair 0 is displaced by the eccentricities as tooth pair `number` is so many pitches later."""

    def turned(member: Member, phi: float) -> Member:
        mount = member.mount
        x, y = Rigid.about_z(mount.sign * phi).rotation[:2, :2] @ np.array(mount.eccentricity)
        return replace(member, mount=replace(mount, eccentricity=(float(x), float(y))))

    later = number * pair.pitch
    return replace(pair, pinion=turned(pair.pinion, later), gear=turned(pair.gear, later * pair.ratio))


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
