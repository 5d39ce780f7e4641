"""Contact of a pair on both sides of its teeth: a path, the whole engagement of a tooth pair, and the ease-off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.ease_off import EaseOff, ease_off
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair

#: positions of a whole engagement
ENGAGEMENT_POSITIONS = 41


@dataclass(frozen=True)
class SideContact:
    """Contact on one side of the teeth of a pair."""

    #: the pair with the flanks of this side in contact
    pair: GearPair
    #: True for the driving side
    driving: bool
    #: path of contact
    path: ContactPath
    #: path of a tooth pair from its first to its last contact
    whole: ContactPath
    #: ease-off of the pinion's flank
    ease_off: EaseOff

    @property
    def sliding_velocity(self) -> Array:
        """Sliding velocity (I, J, 3), mm per rad of the pinion, own frame, of the pinion's points in contact against
        the gear.
        """
        return self._sliding_velocity(self.ease_off.phi1)

    @property
    def continued_sliding_velocity(self) -> Array:
        """Sliding velocity (I, J, 3) that continues beyond the edges of the gear's flank, on the extended flank."""
        return self._sliding_velocity(self.ease_off.continued_phi1)

    def _sliding_velocity(self, phi1: Array) -> Array:
        to_fixed = self.pair.pinion.mount.at(phi1)
        r = to_fixed.point(self.ease_off.points)
        between = self.pair.pinion.mount.velocity(r) - self.pair.ratio * self.pair.gear.mount.velocity(r)
        return to_fixed.inverse.vector(between)


def whole_path(pair: GearPair, engagement: Engagement) -> ContactPath:
    """Return the contact of a tooth pair from its first to its last contact, at closely spaced positions."""
    phi1 = np.linspace(*engagement_range(engagement, pair.pitch), ENGAGEMENT_POSITIONS)
    return contact_path(solver_pair(pair), phi1, None, engagement=engagement)


def side_contacts(
    pair: GearPair,
    path: ContactPath,
    engagement: Engagement | None = None,
    coast: Engagement | None = None,
    driving_whole: ContactPath | None = None,
) -> tuple[SideContact, ...]:
    """Return the contact on both sides of a pair; a side without contact is left out.

    `path` belongs to the driving side. These are computed if not given: `engagement` of the driving flanks, the
    engagement of the `coast` flanks, and the whole path of the driving side, `driving_whole`.
    """
    contacts = []
    for own_pair, driving, known in ((pair, True, engagement), (reversed_pair(pair), False, coast)):
        flanks = solver_pair(own_pair)
        followed = whole_engagement(flanks, own_pair.pitch) if known is None else known
        if followed is None or not followed.contacts.touching.any():
            continue
        whole = driving_whole if driving and driving_whole is not None else whole_path(own_pair, followed)
        side_path = path
        if not driving:
            phi1 = np.linspace(whole.rotation[0], whole.rotation[-1], len(path.phi1))
            side_path = contact_path(flanks, phi1, None, engagement=followed)
        contacts.append(SideContact(own_pair, driving, side_path, whole, ease_off(followed, own_pair.pitch)))
    return tuple(contacts)
