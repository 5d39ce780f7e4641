"""All tooth pairs in contact while a pair of gears rolls through one pitch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair

#: neighbouring tooth pairs that are looked for, either way
NEIGHBOURS = 4


@dataclass(frozen=True)
class RollingContact:
    """A pair at rotations `phi1` (N,), rad, of the pinion, from the middle of a path of contact on.

    `middle`: position of that in `path`; `engaged` (N, 2 NEIGHBOURS + 1): which tooth pairs are within their engagement;
    `contacts`: where these touch, one after the other.
    """

    pair: GearPair
    path: ContactPath
    middle: int
    phi1: Array
    engaged: NDArray[np.bool_]
    contacts: ContactPath

    @property
    def phi2(self) -> Array:
        """Rotations (N,), rad, of the gear at its nominal ratio from the middle on."""
        k = self.middle
        phi2: Array = self.path.phi2[k] + self.pair.ratio * (self.phi1 - self.path.rotation[k])
        return phi2


def rolling_contact(pair: GearPair, path: ContactPath, pitches: ArrayLike = (0.0,)) -> RollingContact:
    """A pair rolled by so many `pitches` (N,) from the middle of a path on. Raises NoSolutionError where flanks never meet."""
    flanks = solver_pair(pair)
    followed = whole_engagement(flanks, pair.pitch)
    touching = np.flatnonzero(path.touching)
    if followed is None or not touching.size:
        raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
    k = int(touching[len(touching) // 2])
    phi1 = path.rotation[k] + pair.pitch * np.asarray(pitches, dtype=float)
    turns = phi1[:, None] + pair.pitch * np.arange(-NEIGHBOURS, NEIGHBOURS + 1)
    low, high = engagement_range(followed, pair.pitch)
    within = (turns >= low) & (turns <= high)
    return RollingContact(pair, path, k, phi1, within, contact_path(flanks, turns[within], None))
