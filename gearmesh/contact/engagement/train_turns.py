"""Rotations of all members of a gear set: every pair turns as its tooth pair in contact turns it."""

from __future__ import annotations

import numpy as np

from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair, GearTrain

#: rounds that find the rotation of a driving member from the driven member; each reduces the error to 1e-6 of itself
INVERSION_ROUNDS = 2


def leading_turns(pair: GearPair, phi1: Array, around: int = 1) -> tuple[Array, Array]:
    """Compute rotations (N,) of pinion and gear, rad, at phi1 (N,), rad, of the pinion; NaN where no teeth touch.

    The most advanced tooth pair within `around` pitches decides.
    """
    pitches = np.round(phi1 / pair.pitch)[:, None] + np.arange(-around, around + 1.0)
    path = analyse(pair, (phi1[:, None] - pitches * pair.pitch).ravel())
    shifts = (pitches * pair.pitch).ravel()
    rotation, phi2 = path.rotation + shifts, path.phi2 + shifts * pair.ratio
    ahead = np.where(path.touching, pair.drive * phi2, -np.inf).reshape(pitches.shape)
    k = np.arange(len(phi1)) * pitches.shape[1] + ahead.argmax(axis=1)
    none = np.where(path.touching[k], 0.0, np.nan)
    return rotation[k] + none, phi2[k] + none


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
