"""Data of a pair for a view that turns: dense contact, rotations of all members, gaps over the pinion's flank."""

from __future__ import annotations

import numpy as np

from gearmesh.answers.contact.contact import Contact
from gearmesh.contact.engagement.cycle import Cycle
from gearmesh.contact.engagement.ease_off import ease_off, gaps_at
from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.engagement.train_turns import train_turns
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.kept_by_tooth import KeptByTooth
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth

#: positions of the slider
SLIDER_POSITIONS = 61
#: positions of the contact that is shown before the mesh cycle is known
FIRST_POSITIONS = 21
#: fewest positions of a solved contact that are shown as they are
MIN_SOLVED_POSITIONS = 9
#: points across and along a flank at which gaps are computed
GAP_GRID = (41, 65)
#: limit of the distance between columns, in heights of the flank, unless MAX_COLUMNS is reached
MAX_COLUMN_STEP = 0.2
#: limit of the number of columns
MAX_COLUMNS = 401
#: distance of the outer points from the edges of the flank, as a part of the flank: on an edge, rounding decides
#: whether the mating flank ends there
EDGE_MARGIN = 1e-4


@dataclass(frozen=True)
class FlankGaps:
    """Gaps, mm, over a grid on the pinion's flank."""

    #: smallest gap (I, J) over all positions; infinite where the gear has no flank
    least: Array
    #: rotation of the pinion, rad, to which `at_phi1` belongs
    phi1: float
    #: gap (I, J) at `phi1`
    at_phi1: Array
    #: ease-off (I, J); None without a mesh cycle
    ease_off: Array | None


@dataclass(frozen=True)
class StagedContact:
    """A pair with its contact at the positions of the slider."""

    #: the pair
    pair: GearPair
    #: contact at the positions of the slider (P)
    path: ContactPath
    #: rotations (P,) of all members, rad
    turns: dict[str, Array]
    #: mesh cycle
    cycle: Cycle | None
    #: gaps over the pinion's flank; None where the ellipses of a first contact are enough for its pattern
    gaps: FlankGaps | None


def staged_contact(train: GearTrain, contact: Contact) -> StagedContact:
    """Return a solved contact at the positions of the slider; positions without contact are left out."""
    pair, known = contact.pair, contact.path.phi1[contact.path.touching]
    flanks = solver_pair(pair) if contact.engagement is None else contact.engagement.pair
    phi1 = np.linspace(known.min(), known.max(), SLIDER_POSITIONS if np.ptp(known) else 1)
    path = contact_path(flanks, phi1, pair.generation, engagement=contact.engagement)
    if not path.touching.all():
        path = contact_path(flanks, phi1[path.touching], pair.generation, engagement=contact.engagement)
    return StagedContact(
        pair,
        path,
        train_turns(train, pair, path.rotation, path.phi2),
        contact.cycle,
        _gaps(pair, flanks, path, contact.engagement),
    )


def solved_contact(train: GearTrain, contact: Contact) -> StagedContact | None:
    """Return a solved contact at its own positions, without ease-off; None if few of them touch."""
    pair, path = contact.pair, contact.path
    met = np.flatnonzero(path.touching)
    if met.size < MIN_SOLVED_POSITIONS or np.ptp(met) >= met.size:
        return None
    return _at_first(train, pair, path.part_of(slice(met[0], met[-1] + 1)))


def first_contact(train: GearTrain, pair: GearPair, ends: tuple[float, float]) -> StagedContact | None:
    """Return the contact of a pair at few positions between two (rad), without mesh cycle and ease-off.

    None if nothing touches. Gears that jam are not recognised: this takes the mesh cycle.
    """
    flanks = solver_pair(pair)
    path = contact_path(flanks, np.linspace(*ends, FIRST_POSITIONS if np.ptp(ends) else 1), pair.generation)
    met = np.flatnonzero(path.touching)
    if not met.size:
        return None
    path = path.part_of(slice(met[0], met[-1] + 1))
    if not path.touching.all():
        path = contact_path(flanks, path.phi1[path.touching], pair.generation)
    return _at_first(train, pair, path, flanks)


def _at_first(train: GearTrain, pair: GearPair, path: ContactPath, flanks: Pair | None = None) -> StagedContact:
    """Return the contact at positions that all touch, with gaps only where the pattern needs them.

    Members of other pairs turn at their ratios, which no eye can tell from their turns with transmission errors.

    `flanks` of the pair for the solver are made if gaps need them and they are not given.
    """
    gaps = None if np.isfinite(path.semi_major).any() else _gaps(pair, flanks or solver_pair(pair), path, None)
    turns = train_turns(train, pair, path.rotation, path.phi2, nominal=True)
    return StagedContact(pair, path, turns, None, gaps)


#: points of the last flanks
_KEPT_GRIDS = KeptByTooth[Grid]()


def shown_flank(member: Member, side: Side) -> Grid:
    """Return the points of a member's flank at `flank_places`; those of the last flanks are kept."""
    tooth = member.tooth
    return _KEPT_GRIDS.get(tooth, side, lambda: tooth.flank_grid(side, *flank_places(tooth, side)))


def flank_places(tooth: Tooth, side: Side) -> tuple[Array, Array]:
    """Return places across (I,) and along (J,) a flank, 0 to 1; long flanks of threads have more columns."""
    s, t = (np.linspace(EDGE_MARGIN, 1.0 - EDGE_MARGIN, count) for count in GAP_GRID)
    root, tip = tooth.flank_grid(side, s[[0, -1]], t).points
    middle = len(t) // 2
    height = np.linalg.norm(root - tip[middle], axis=-1).min()
    length = np.linalg.norm(np.diff(root, axis=0), axis=-1).sum()
    columns = int(np.clip(np.ceil(length / (MAX_COLUMN_STEP * height)), GAP_GRID[1], MAX_COLUMNS))
    return s, np.linspace(EDGE_MARGIN, 1.0 - EDGE_MARGIN, columns)


def _gaps(pair: GearPair, flanks: Pair, path: ContactPath, engagement: Engagement | None) -> FlankGaps:
    parameters = shown_flank(pair.pinion, pair.flanks[0]).parameters
    amount = None if engagement is None else ease_off(engagement, pair.pitch, parameters).distance
    # phi1 = 0, or the nearest position of the path
    phi1 = np.clip(np.zeros(1), path.phi1.min(), path.phi1.max())
    rotation, phi2 = (np.interp(phi1, path.phi1, turn) for turn in (path.rotation, path.phi2))
    *every, middle = gaps_at(flanks, np.append(path.rotation, rotation), np.append(path.phi2, phi2), parameters)
    least = np.nan_to_num(every, nan=np.inf).min(axis=0)
    return FlankGaps(least, float(phi1[0]), middle, amount)
