"""Motion of a planetary set: speeds and ratios [Willis], and phases of its meshes.

Tooth numbers are positive. Speeds are positive in one sense of rotation about the common axis. Phases are in pitches
from where contact of a tooth pair begins. The sun drives the planets and these the ring, on the flanks in contact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

from gearmesh.records import dataclass

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction

#: driving member by fixed member
DRIVING_MEMBER = {"ring": "sun", "carrier": "sun", "sun": "ring"}
#: driven member by fixed member
DRIVEN_MEMBER = {"ring": "carrier", "carrier": "ring", "sun": "carrier"}
#: difference (pitches) below which two events are the same
SAME_EVENT_PITCHES = 1e-9


@dataclass(frozen=True)
class Speeds:
    """Speeds of the members per turn of the driving member."""

    #: turns of the sun
    sun: float
    #: turns of the planets
    planet: float
    #: turns of the carrier
    carrier: float
    #: turns of the ring
    ring: float

    @property
    def relative(self) -> float:
        """Turns of the planets relative to the carrier."""
        return self.planet - self.carrier


def speeds(sun: int, planet: int, ring: int, fixed: str) -> Speeds:
    """Return the speeds of a set with a fixed member, "ring", "carrier" or "sun" [Willis].

    (n_sun - n_c) z_sun = -(n_ring - n_c) z_ring = -(n_planet - n_c) z_planet. `sun`, `planet`, `ring`: tooth numbers.
    """
    # turns in the carrier's frame per turn of the sun, then relative to the fixed member
    own = {"sun": 1.0, "carrier": 0.0, "ring": -sun / ring}
    own = {name: turns - own[fixed] for name, turns in own.items()}
    carrier = own["carrier"]
    driver = own[DRIVING_MEMBER[fixed]]
    turns = (own["sun"], carrier - sun / planet, carrier, own["ring"])
    # adding 0.0 makes -0.0 of a fixed member 0.0
    return Speeds(*(turn / driver + 0.0 for turn in turns))


def ratio(sun: int, ring: int, fixed: str) -> float:
    """Return the speed of the driving member over the speed of the driven member.

    The ratio is negative if they turn in opposite senses.
    """
    return {"ring": 1.0 + ring / sun, "carrier": -ring / sun, "sun": 1.0 + sun / ring}[fixed]


def phases(sun: int, angles: Sequence[float], sense: int) -> list[float]:
    """Return the phases (pitches, 0 to 1) by which the meshes of planets are ahead of the first planet's mesh.

    `angles`: angles (deg) of the planets. `sense` is +1 if the sun drives with its right flanks, -1 with its left
    flanks. Phases are equal in both meshes, since the teeth of sun and ring between two planets add up to whole
    pitches.
    """
    return [_part(sense * sun * (angle - angles[0]) / 360.0) for angle in angles]


def phase_of_ring(inner: LineOfAction, outer: LineOfAction, overlaps: tuple[float, float], share: float = 0.5) -> float:
    """Return the phase (pitches, 0 to 1) by which the mesh of planet and ring is ahead of planet and sun.

    - overlaps: overlap ratios of both meshes.
    - share: part of the face that touches before a common plane, equal in both meshes; a half if the plane is the
      middle of the faces.

    A flank of the planet touches where its normal lies in the line of action. Take a tooth centred at tau whose half
    angle at the base circle is eta_b. Its flank towards the sun touches from tip to root, at the roll angle xi_s = pi +
    alpha_ws + eta_b - tau. Its other flank touches from root to tip, at xi_r = alpha_wr + eta_b + tau.
    """
    planet = inner.mesh.gear
    _, tip = inner.active(1)
    root, _ = outer.active(0)
    half, other = (teeth.half_angle(teeth.base_radius) for teeth in (planet, outer.mesh.pinion))
    # position at which contact with the sun begins: tau makes xi_s the roll angle of the tip
    tau = math.pi + inner.mesh.working_angle + half - tip / planet.base_radius
    passed = outer.mesh.working_angle + other + tau - root / outer.mesh.pinion.base_radius
    return _part(passed * planet.teeth / (2.0 * math.pi) + share * (overlaps[1] - overlaps[0]))


def pairs_in_contact(ratios: Sequence[float], ahead: Sequence[float]) -> tuple[int, int]:
    """Return the least and the most tooth pairs of several meshes in contact at once.

    `ratios`, `ahead`: contact ratios and phases (pitches) of the meshes. States that last only an instant do not count.
    """
    events = sorted({_part(end - phase) for length, phase in zip(ratios, ahead, strict=True) for end in (0.0, length)})
    counts = []
    for before, after in pairwise([*events, events[0] + 1.0]):
        if after - before > SAME_EVENT_PITCHES:
            at = 0.5 * (before + after)
            counts.append(sum(_count(length, at + phase) for length, phase in zip(ratios, ahead, strict=True)))
    return min(counts), max(counts)


def _count(length: float, at: float) -> int:
    """Return the number of tooth pairs in contact at a phase; contact lasts `length` pitches."""
    return math.floor(at) - math.ceil(at - length) + 1 if length > 0.0 else 0


def _part(value: float) -> float:
    """Return the fractional part, 0 to 1; 0 for a whole number up to rounding."""
    part = value % 1.0
    return 0.0 if 1.0 - part < SAME_EVENT_PITCHES else part
