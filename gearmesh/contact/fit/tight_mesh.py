"""Double-flank test: members on parallel axes roll without backlash, and their centre distance changes.

The tight centre distance a is the distance at which teeth without deviations have no play, b = 0. Pitch deviations or
eccentricities give a play b at every rotation there. The axes move by -b / (db/da), which takes the play away. Terms of second
order in the deviations are neglected; the play of teeth without deviations is exact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.contact.engagement.pitch_turns import shifted_advances
from gearmesh.contact.engagement.turns import concentric_pair, full_turns, turns_of
from gearmesh.contact.fit.fit import centre_distance, play
from gearmesh.contact.flanks import solver_pair
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import listening, part, tell
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES

#: positions in a pitch, in the tight mesh and in its search
POSITIONS_PER_PITCH = 12
#: steps at most of the search for the tight centre distance
MAX_SEARCH_STEPS = 12
#: play (rad) below which there is none
NO_PLAY_RAD = 1e-9
#: first step of the search by the play at the gear's radius
FIRST_STEP = 1.2
#: least first step of the search, mm
MIN_FIRST_STEP_MM = 1e-3
#: share of the search in the work, for progress
SHARE_OF_SEARCH = 0.4


@dataclass(frozen=True)
class TightMesh:
    """Centre distances of a double-flank test at P rotations of the pinion."""

    #: rotations (P,) of the pinion, rad
    phi1: Array
    #: centre distances (P,), mm
    distance: Array
    #: centre distance of the teeth without deviations, mm
    nominal: float
    #: rotations in a pitch
    per_pitch: int

    @property
    def total(self) -> float:
        """F_i'', mm: the greatest less the least centre distance."""
        return float(np.ptp(self.distance))

    @property
    def tooth_to_tooth(self) -> float:
        """f_i'', mm: the greatest change within any one pitch."""
        ring = np.concatenate((self.distance, self.distance[: self.per_pitch]))
        windows = np.lib.stride_tricks.sliding_window_view(ring, self.per_pitch + 1)
        return float(np.ptp(windows, axis=1).max())


def tight_mesh(pair: GearPair) -> TightMesh:
    """Compute the double-flank test of a pair with pitch deviations or eccentricities, until the rotations repeat.

    Raises DesignError where the axes are not parallel or the turns too many, NoSolutionError where no centre distance takes the
    play away.
    """
    distance = centre_distance(pair)
    if distance is None:
        raise DesignError("pair", pair.name, reason="its axes are not parallel", allowed="pairs with a centre distance")
    pitches, _ = turns_of(pair)
    # the number of search steps is not known, so the search tells no progress
    with listening(None):
        moved, slope = _tight(concentric_pair(_even(pair)), distance)
    tell(SHARE_OF_SEARCH)
    if pair.eccentric:
        with part(SHARE_OF_SEARCH, 1.0):
            turns = full_turns(_apart(pair, moved))
        displaced = distance + moved - turns.backlash / slope
        return TightMesh(turns.phi1, np.asarray(displaced), distance + moved, turns.per_pitch)
    with part(SHARE_OF_SEARCH, 1.0):
        b = _play(_apart(pair, moved), pitches)
    phi1 = np.arange(pitches * POSITIONS_PER_PITCH, dtype=float) * (pair.pitch / POSITIONS_PER_PITCH)
    return TightMesh(phi1, np.asarray(distance + moved - b / slope), distance + moved, POSITIONS_PER_PITCH)


def _tight(pair: GearPair, distance: float) -> tuple[float, float]:
    """Solve for the movement (mm) of the gear away from the pinion that leaves no play, by secants; also return db/da (rad/mm).

    The teeth have no deviations.
    """
    before, b_before = 0.0, _least_play(pair)
    # the first step is right for involutes of 20 degrees; a ring moves in the opposite sense
    inside = -1.0 if np.dot(pair.mounts[0].spin, pair.mounts[1].spin) > 0.0 else 1.0
    radius = distance * abs(1.0 / pair.ratio) / abs(inside + abs(1.0 / pair.ratio))
    at = -inside * max(FIRST_STEP * radius * abs(b_before), MIN_FIRST_STEP_MM) * float(np.sign(b_before) or 1.0)
    for _ in range(MAX_SEARCH_STEPS):
        b = _least_play(_apart(pair, at))
        slope = (b - b_before) / (at - before)
        if abs(b) < NO_PLAY_RAD:
            return at, slope
        before, b_before, at = at, b, at - b / slope
    raise NoSolutionError(reason="no centre distance was found at which the teeth have no play", topic="tight mesh")


def _even(pair: GearPair) -> GearPair:
    """Return the pair with all teeth at their nominal index angles."""
    return replace(
        pair, pinion=replace(pair.pinion, index=NO_INDEX_ANGLES), gear=replace(pair.gear, index=NO_INDEX_ANGLES)
    )


def _least_play(pair: GearPair) -> float:
    return float(_play(pair, 1).min())


def _play(pair: GearPair, pitches: int) -> Array:
    """Compute rotations (P,), rad, of the gear between its first touches on driving and coast flanks."""
    forwards, backwards, _ = shifted_advances(pair, pitches, POSITIONS_PER_PITCH)
    return play(pair, forwards + backwards, wound=solver_pair(pair).wound)


def _apart(pair: GearPair, way: float) -> GearPair:
    """Return the pair with its gear moved by `way` (mm) away from the pinion along the line of centres."""
    first, second = pair.mounts
    apart = second.origin - first.origin
    apart = apart - float(apart @ first.axis) * first.axis
    base = Rigid(second.base.rotation, second.base.translation + way * apart / np.linalg.norm(apart))
    return replace(pair, gear=replace(pair.gear, mount=replace(second, base=base)))
