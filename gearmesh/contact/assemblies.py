"""Contact of one pair of members in many assemblies at once: each with mounts of its own, all of them one batch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.first_touch import touches
from gearmesh.contact.pair import Pair
from gearmesh.contact.settle import Contacts
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.rigid import Rigid
from gearmesh.teeth.mount import Mount

#: positions solved at once
CHUNK = 4_000


def many_assemblies(pair: Pair, bases: tuple[Rigid, Rigid], phi1: Array) -> Contacts:
    """First touch of a tooth pair in M assemblies at rotations phi1 (P,), rad: M P positions, those of an assembly together.

    `bases`: own frames of pinion and gear, not turned, to the fixed frame, rotations (M, 3, 3), translations (M, 3) each; all else
    of the mounts is the pair's.
    """
    count, each = len(bases[0].translation), len(phi1)
    found = Contacts.nothing(count * each)
    every = np.tile(phi1, count)
    for start in range(0, count * each, CHUNK):
        part = np.arange(start, min(start + CHUNK, count * each))
        there = replace(
            pair,
            pinion=replace(pair.pinion, mount=_mounted(pair.pinion.mount, bases[0], part // each)),
            gear=replace(pair.gear, mount=_mounted(pair.gear.mount, bases[1], part // each)),
        )
        found.put(part, touches(there, every[part])[0])
    return found


def _mounted(mount: Mount, base: Rigid, index: NDArray[np.intp]) -> Mount:
    return replace(mount, base=Rigid(base.rotation[index], base.translation[index]))
