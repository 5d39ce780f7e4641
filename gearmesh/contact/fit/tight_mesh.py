"""Double-flank test: members on parallel axes roll without backlash, and their centre distance changes.

At the centre distance where unshifted teeth have no play, b = 0, pitch deviations or eccentricities give it at every rotation; the
axes move by what takes it away, -b / (db/da). Quantities of the second order in the deviations are neglected, b of unshifted teeth
is not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmesh.contact.engagement.pitch_turns import pitches_until_repeat, refuse_too_many, shifted_advance
from gearmesh.contact.engagement.turns import concentric_pair, full_turns
from gearmesh.contact.fit.fit import centre_distance, play, reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import in_turn, listening, part, tell
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.micro_geometry.index_angles import NO_INDEX_ANGLES

#: positions in a pitch, of the tight mesh and of its search
PER_PITCH = 12
#: steps in which the tight centre distance is looked for, and the play (rad) that is none
STEPS, NO_PLAY = 12, 1e-9
#: first step of that search by the play at the gear's radius, and the least, mm
FIRST, SHORTEST = 1.2, 1e-3
#: part of the work that the search is
FOUND = 0.4


@dataclass(frozen=True)
class TightMesh:
    """Centre distances (P,), mm, at rotations `phi1` (P,), rad, of the pinion, `per_pitch` in a pitch; `nominal`: of the teeth
    without deviations, mm."""

    phi1: Array
    distance: Array
    nominal: float
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
    """A pair with the pitch deviations or eccentricities of its members, rolling without backlash over the turns after which it
    repeats.

    Raises DesignError where axes are not parallel or turns too many, NoSolutionError where no centre distance leaves no play.
    """
    distance = centre_distance(pair)
    if distance is None:
        raise DesignError("pair", pair.name, reason="its axes are not parallel", allowed="pairs with a centre distance")
    if pair.uneven or not pair.eccentric:
        refuse_too_many(pair)
    # the number of its steps is not known
    with listening(None):
        moved, slope = _tight(concentric_pair(_even(pair)), distance)
    tell(FOUND)
    if pair.eccentric:
        with part(FOUND, 1.0):
            turns = full_turns(_apart(pair, moved))
        displaced = distance + moved - turns.backlash / slope
        return TightMesh(turns.phi1, np.asarray(displaced), distance + moved, turns.per_pitch)
    pitches = pitches_until_repeat(pair)
    with part(FOUND, 1.0):
        b = _play(_apart(pair, moved), pitches)
    phi1 = np.arange(pitches * PER_PITCH, dtype=float) * (pair.pitch / PER_PITCH)
    return TightMesh(phi1, np.asarray(distance + moved - b / slope), distance + moved, PER_PITCH)


def _tight(pair: GearPair, distance: float) -> tuple[float, float]:
    """By how much (mm) the gear has to move away from the pinion for its unshifted teeth to have no play, and the play (rad) that
    it gains there per mm."""
    before, b_before = 0.0, _least_play(pair)
    # as involutes of 20 degrees: of members inside each other the other way round
    inside = -1.0 if np.dot(pair.mounts[0].spin, pair.mounts[1].spin) > 0.0 else 1.0
    radius = distance * abs(1.0 / pair.ratio) / abs(inside + abs(1.0 / pair.ratio))
    at = -inside * max(FIRST * radius * abs(b_before), SHORTEST) * float(np.sign(b_before) or 1.0)
    for _ in range(STEPS):
        b = _least_play(_apart(pair, at))
        slope = (b - b_before) / (at - before)
        if abs(b) < NO_PLAY:
            return at, slope
        before, b_before, at = at, b, at - b / slope
    raise NoSolutionError(reason="no centre distance was found at which the teeth have no play", topic="tight mesh")


def _even(pair: GearPair) -> GearPair:
    """The pair with all teeth at their places."""
    return replace(
        pair, pinion=replace(pair.pinion, index=NO_INDEX_ANGLES), gear=replace(pair.gear, index=NO_INDEX_ANGLES)
    )


def _least_play(pair: GearPair) -> float:
    return float(_play(pair, 1).min())


def _play(pair: GearPair, pitches: int) -> Array:
    """Rotations (P,), rad, of the gear between its first touches on both sides."""
    both = in_turn((pair, reversed_pair(pair)))
    forwards, backwards = (shifted_advance(own, pitches, PER_PITCH)[0] for own in both)
    return play(pair, forwards + backwards, wound=solver_pair(pair).wound)


def _apart(pair: GearPair, way: float) -> GearPair:
    """The pair with its gear moved (mm) away from the pinion along the line of centres."""
    first, second = pair.mounts
    apart = second.origin - first.origin
    apart = apart - float(apart @ first.axis) * first.axis
    base = Rigid(second.base.rotation, second.base.translation + way * apart / np.linalg.norm(apart))
    return replace(pair, gear=replace(pair.gear, mount=replace(second, base=base)))
