"""All tooth pairs in contact while a pair of gears rolls through one pitch."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: number of neighbouring tooth pairs on each side that may be in contact
NEIGHBOURS_PER_SIDE = 4


@dataclass(frozen=True)
class RollingContact:
    """A pair at rotations of the pinion, beginning at the middle of a path of contact."""

    #: the pair
    pair: GearPair
    #: the path of contact
    path: ContactPath
    #: index of the middle position in `path`
    middle: int
    #: rotations (N,) of the pinion, rad
    phi1: Array
    #: True (N, 2 NEIGHBOURS_PER_SIDE + 1) for tooth pairs within their engagement
    engaged: NDArray[np.bool_]
    #: contacts of these tooth pairs, one after the other
    contacts: ContactPath

    @property
    def phi2(self) -> Array:
        """Rotations (N,), rad, of the gear at its nominal ratio, beginning at the middle position."""
        k = self.middle
        phi2: Array = self.path.phi2[k] + self.pair.ratio * (self.phi1 - self.path.rotation[k])
        return phi2


def rolling_contact(pair: GearPair, path: ContactPath, pitches: ArrayLike = (0.0,)) -> RollingContact:
    """Return a pair rolled by `pitches` (N,) from the middle of a path.

    Raises NoSolutionError if the flanks never meet.
    """
    flanks = solver_pair(pair)
    followed = whole_engagement(flanks, pair.pitch)
    touching = np.flatnonzero(path.touching)
    if followed is None or not touching.size:
        raise NoSolutionError(reason="the flanks never meet", remedy="reduce the assembly errors")
    k = int(touching[len(touching) // 2])
    phi1 = path.rotation[k] + pair.pitch * np.asarray(pitches, dtype=float)
    turns = phi1[:, None] + pair.pitch * np.arange(-NEIGHBOURS_PER_SIDE, NEIGHBOURS_PER_SIDE + 1)
    low, high = engagement_range(followed, pair.pitch)
    within = (turns >= low) & (turns <= high)
    return RollingContact(pair, path, k, phi1, within, contact_path(flanks, turns[within], None))
