"""First touch of two trimmed flanks, position by position: of all places where they may touch, the one that leads.

`field` finds the places, over the whole of both flanks; here the exact conditions are solved from each of them. What they give
are points that both flanks have, so none of them can lead more than the first touch does: the greatest is the contact, whether
it lies inside both flanks, on an edge or where two edges cross.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from gearmesh.contact.field import INTERIOR, candidates
from gearmesh.contact.pair import Pair
from gearmesh.contact.search import UNSEEN, looked_into
from gearmesh.contact.settle import Contacts, Trial, settle
from gearmesh.kernel.algebra import Array


def first_touch(pair: Pair, phi1: Array) -> Contacts:
    """First touch at rotations phi1 (N,); the flanks' mounts may be N of their own. Nothing is raised or warned of."""
    return touches(pair, phi1)[0]


def touches(pair: Pair, phi1: Array, *, edges: bool = True) -> tuple[Contacts, Contacts]:
    """First touch of the teeth at rotations phi1 (N,), tips on fillets too, and of the flanks alone.

    Without `edges` only tangency inside both flanks counts.
    """
    contacts = Contacts.nothing(len(phi1))
    flanks = contacts
    with np.errstate(all="ignore"):
        for number, part in enumerate(pair.parts):
            found = candidates(part, phi1, trimmed=edges)
            # on fillets only what may be ahead of the flanks
            worth = found.most > contacts.lead[found.position]
            if not edges:
                worth &= (found.edges == INTERIOR).all(axis=1)
            trial = Trial.of(found.position[worth], found.x[worth], found.edges[worth])
            trial.most = found.most[worth]
            settle(part, phi1, trial, contacts, number)
            missed = np.flatnonzero((found.best > contacts.lead + UNSEEN) & (found.top >= 0))
            if edges and missed.size:
                looked_into(part, phi1, missed, found.x[found.top[missed]], contacts, number)
            if number == 0:
                flanks = replace(
                    contacts, **{each.name: getattr(contacts, each.name).copy() for each in fields(contacts)}
                )
    return contacts, flanks
