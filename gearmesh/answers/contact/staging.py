"""A pair of gears for a view that turns: contact closely spaced, rotations of all members, gaps over the pinion's flank."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.engagement.ease_off import ease_off, gaps_at
from gearmesh.contact.engagement.train_turns import train_turns
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.region import Side

#: positions of the slider
POSITIONS = 61
#: points across and along a flank at which gaps are known
GRID = (41, 65)
#: heights of a flank from one column to the next at most, unless that takes more columns than these
FARTHEST, MOST_COLUMNS = 0.2, 401
#: how far inside the flank's edges the outer ones are, as a part of the flank: on them it is chance whether the other has an end
INSIDE = 1e-4


@dataclass(frozen=True)
class FlankGaps:
    """Over the grid of the pinion's flank, mm: the `least` gap (I, J) of all positions, infinite where the gear has no flank; that
    at `phi1`, rad; the `ease_off`, None where there is no mesh cycle."""

    least: Array
    phi1: float
    at_phi1: Array
    ease_off: Array | None


@dataclass(frozen=True)
class StagedContact:
    """A pair, its contact at the positions of the slider (P), rotations (P,), rad, of all members, its mesh cycle, and the gaps."""

    pair: GearPair
    path: ContactPath
    turns: dict[str, Array]
    cycle: Cycle | None
    gaps: FlankGaps


def staged_contact(train: GearTrain, contact: Contact) -> StagedContact:
    """A solved contact at as many positions as the slider has, those without contact left out."""
    pair, known = contact.pair, contact.path.phi1[contact.path.touching]
    flanks = solver_pair(pair)
    phi1 = np.linspace(known.min(), known.max(), POSITIONS if np.ptp(known) else 1)
    path = contact_path(flanks, phi1, pair.generation)
    if not path.touching.all():
        path = contact_path(flanks, phi1[path.touching], pair.generation)
    return StagedContact(
        pair, path, train_turns(train, pair, path.rotation, path.phi2), contact.cycle, _gaps(contact, path)
    )


def flank_places(member: Member, side: Side) -> tuple[Array, Array]:
    """Places across (I,) and along (J,) a flank of the grid, 0 to 1: along threads so many that none is far from the next."""
    s, t = (np.linspace(INSIDE, 1.0 - INSIDE, count) for count in GRID)
    root, tip = member.tooth.flank_grid(side, s[[0, -1]], t).points
    middle = len(t) // 2
    height = np.linalg.norm(root - tip[middle], axis=-1).min()
    length = np.linalg.norm(np.diff(root, axis=0), axis=-1).sum()
    columns = int(np.clip(np.ceil(length / (FARTHEST * height)), GRID[1], MOST_COLUMNS))
    return s, np.linspace(INSIDE, 1.0 - INSIDE, columns)


def _gaps(contact: Contact, path: ContactPath) -> FlankGaps:
    pair, flanks = contact.pair, solver_pair(contact.pair)
    side = pair.flanks[0]
    parameters = pair.pinion.tooth.flank_grid(side, *flank_places(pair.pinion, side)).parameters
    least = np.nan_to_num(gaps_at(flanks, path.rotation, path.phi2, parameters), nan=np.inf).min(axis=0)
    amount = None
    if contact.engagement is not None:
        amount = ease_off(contact.engagement, pair.pitch, parameters).distance
    # at phi1 = 0, or as near as the path comes
    phi1 = np.clip(np.zeros(1), path.phi1.min(), path.phi1.max())
    rotation, phi2 = (np.interp(phi1, path.phi1, turn) for turn in (path.rotation, path.phi2))
    return FlankGaps(least, float(phi1[0]), gaps_at(flanks, rotation, phi2, parameters)[0], amount)
