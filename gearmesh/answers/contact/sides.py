"""Contact of a pair on both sides of its teeth: a path, the whole engagement of a tooth pair, and the ease-off."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.contact.engagement.curve import MeshCurve
from gearmesh.contact.engagement.cycle import engagement_range, range_of_curve
from gearmesh.contact.engagement.ease_off import EaseOff, ease_off
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair

#: positions of a whole engagement
ENGAGEMENT_POSITIONS = 41
#: difference of rotations of the pinion that is rounding
SAME_ROTATION_RAD = 1e-12


@dataclass(frozen=True)
class SideContact:
    """Contact on one side of the teeth of a pair."""

    #: the pair with the flanks of this side in contact
    pair: GearPair
    #: True for the driving side
    driving: bool
    #: whole engagement of a tooth pair on this side; on the driving side if this side is its image
    engagement: Engagement
    #: path of a tooth pair from its first to its last contact; on the driving side if this side is its image
    whole: ContactPath
    #: path of contact of the driving side, at the positions asked for
    driving_path: ContactPath
    #: diagonal (3,) of the map of the members' own frames that makes this side of the driving side; None: no image
    exchange: Array | None = None

    @cached_property
    def path(self) -> ContactPath:
        """Path of contact; that of the coast side has as many positions over its engagement as the driving side has.

        It is on the driving side if this side is its image.
        """
        asked = self.driving_path
        if self.driving:
            return asked
        phi1 = np.linspace(self.whole.rotation[0], self.whole.rotation[-1], len(asked.phi1))
        if self.exchange is not None and np.abs(phi1 - asked.rotation).max() <= SAME_ROTATION_RAD:
            return asked
        return contact_path(self.engagement.pair, phi1, None, engagement=self.engagement)

    @cached_property
    def ease_off(self) -> EaseOff:
        """Ease-off of the pinion's flank."""
        found = ease_off(self.engagement, self.pair.pitch)
        return found if self.exchange is None else found.image(self.exchange, 2.0 * self.pair.pinion.mount.zero)

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


def whole_path(pair: GearPair, engagement: Engagement, known_range: tuple[float, float] | None = None) -> ContactPath:
    """Return the contact of a tooth pair from its first to its last contact, at closely spaced positions.

    `known_range`: the rotations (rad) of first and last contact, if they are known.
    """
    ends = engagement_range(engagement, pair.pitch) if known_range is None else known_range
    return contact_path(engagement.pair, whole_positions(ends), None, engagement=engagement)


def whole_positions(ends: tuple[float, float]) -> Array:
    """Return the closely spaced positions, rad, of a path from first to last contact at two rotations, rad."""
    return np.linspace(*ends, ENGAGEMENT_POSITIONS)


def side_contacts(
    pair: GearPair,
    path: ContactPath,
    engagement: Engagement | None = None,
    coast: MeshCurve | None = None,
    driving_whole: ContactPath | None = None,
    exchange: Array | None = None,
) -> tuple[SideContact, ...]:
    """Return the contact on both sides of a pair; a side without contact is left out.

    `path` belongs to the driving side. These are computed if not given: `engagement` of the driving flanks, the
    curve of the `coast` flanks, and the whole path of the driving side, `driving_whole`. With `exchange` (3,), the
    diagonal of a map of the members' frames, the coast side is the image of the driving side, and is not solved.
    """
    contacts: list[SideContact] = []
    for own_pair, driving, known in (
        (pair, True, engagement),
        (reversed_pair(pair), False, None if coast is None else coast.engagement),
    ):
        if contacts and exchange is not None:
            contacts.append(replace(contacts[0], pair=own_pair, driving=False, exchange=exchange))
            continue
        followed = whole_engagement(solver_pair(own_pair), own_pair.pitch) if known is None else known
        if followed is None or not followed.contacts.touching.any():
            continue
        if driving and driving_whole is not None:
            whole = driving_whole
        else:
            whole = whole_path(own_pair, followed, None if driving or coast is None else range_of_curve(coast))
        contacts.append(SideContact(own_pair, driving, followed, whole, path))
    return tuple(contacts)
