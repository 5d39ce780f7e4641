"""How all members of a train turn together: every pair of members as the leading one of its tooth pairs has it."""

from __future__ import annotations

import numpy as np

from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.train import GearPair, Train

#: rounds in which the rotation of a driving member is found from that of the driven one: what the transmission error moves in
#: one round is its change over itself, below 1e-6 of it
ROUNDS = 2


def leading_turns(pair: GearPair, phi1: Array, around: int = 1) -> tuple[Array, Array]:
    """Rotations (N,) of pinion and gear, rad, at phi1 (N,), rad, of the pinion; NaN where no teeth touch.

    Of the tooth pairs within so many pitches `around` the one that decides which leads.
    """
    pitches = np.round(phi1 / pair.pitch)[:, None] + np.arange(-around, around + 1.0)
    path = analyse(pair, (phi1[:, None] - pitches * pair.pitch).ravel())
    shifts = (pitches * pair.pitch).ravel()
    rotation, phi2 = path.rotation + shifts, path.phi2 + shifts * pair.ratio
    ahead = np.where(path.touching, pair.drive * phi2, -np.inf).reshape(pitches.shape)
    k = np.arange(len(phi1)) * pitches.shape[1] + ahead.argmax(axis=1)
    none = np.where(path.touching[k], 0.0, np.nan)
    return rotation[k] + none, phi2[k] + none


def train_turns(train: Train, pair: GearPair, rotation: Array, phi2: Array) -> dict[str, Array]:
    """Rotations (N,), rad, of all members when the members of one `pair` stand at `rotation` and `phi2` (N,)."""
    turns = {pair.pinion.name: rotation, pair.gear.name: phi2}
    waiting = [each for each in train.pairs if each is not pair]
    while waiting:
        known = [each for each in waiting if each.pinion.name in turns or each.gear.name in turns]
        if not known:
            break
        each = known[0]
        waiting.remove(each)
        if each.gear.name not in turns:
            turns[each.gear.name] = leading_turns(each, turns[each.pinion.name])[1]
        elif each.pinion.name not in turns:
            wanted = turns[each.gear.name]
            driving = wanted / each.ratio
            for _ in range(ROUNDS):
                driving = driving + (wanted - leading_turns(each, driving)[1]) / each.ratio
            turns[each.pinion.name] = driving
    return turns
