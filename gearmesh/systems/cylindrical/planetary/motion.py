"""How a planetary set runs: speeds and ratios [Willis], and how far its meshes are apart in phase.

Tooth numbers are positive. Speeds are positive in one sense of rotation about the common axis. Phases count pitches from where a
tooth pair begins to touch, as the sun drives the planets and these the ring, on the flanks that are in contact.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction

#: the member that drives, by the one that stands still
DRIVER = {"ring": "sun", "carrier": "sun", "sun": "ring"}
#: the member that is driven
DRIVEN = {"ring": "carrier", "carrier": "ring", "sun": "carrier"}
#: pitches; events that are nearer to each other are one
TOGETHER = 1e-9


@dataclass(frozen=True)
class Speeds:
    """Turns of the members while the driver turns once; `relative` are those of the planets to the carrier."""

    sun: float
    planet: float
    carrier: float
    ring: float

    @property
    def relative(self) -> float:
        return self.planet - self.carrier


def speeds(sun: int, planet: int, ring: int, fixed: str) -> Speeds:
    """Of a set with these tooth numbers and one fixed member, "ring", "carrier" or "sun" [Willis].

    (n_sun - n_c) z_sun = -(n_ring - n_c) z_ring = -(n_planet - n_c) z_planet.
    """
    # in the carrier's frame, a turn of the sun
    own = {"sun": 1.0, "carrier": 0.0, "ring": -sun / ring}
    own = {name: turns - own[fixed] for name, turns in own.items()}
    carrier = own["carrier"]
    driver = own[DRIVER[fixed]]
    turns = (own["sun"], carrier - sun / planet, carrier, own["ring"])
    # 0.0 rather than -0.0 of what stands still
    return Speeds(*(turn / driver + 0.0 for turn in turns))


def ratio(sun: int, ring: int, fixed: str) -> float:
    """Speed of the driver over that of the driven member; negative where they turn against each other."""
    return {"ring": 1.0 + ring / sun, "carrier": -ring / sun, "sun": 1.0 + sun / ring}[fixed]


def phases(sun: int, angles: Sequence[float], sense: int) -> list[float]:
    """How far (pitches, 0 to 1) the meshes of planets at `angles` (deg) are ahead of that of a planet at the first of them.

    `sense` is +1 where the sun drives clockwise, on its right flanks, -1 on its left ones. The same in both meshes: the teeth of
    sun and ring that are between two planets add up to whole pitches.
    """
    return [_part(sense * sun * (angle - angles[0]) / 360.0) for angle in angles]


def phase_of_ring(inner: LineOfAction, outer: LineOfAction, overlaps: tuple[float, float], share: float = 0.5) -> float:
    """How far (pitches, 0 to 1) the mesh of a planet with the ring is ahead of that with the sun.

    `overlaps`: overlap ratios of both meshes, and the `share` of them that touches before one plane, the same of both: a half
    where the faces have their middles in it.

    A flank of the planet touches where its normal lies in the line of action. Of a tooth centred at tau, half of it the angle eta_b
    at the base circle, that is at the roll angle xi_s = pi + alpha_ws + eta_b - tau of the flank towards the sun, which touches
    from its tip to its root, and at xi_r = alpha_wr + eta_b + tau of the other one, which touches from its root to its tip.
    """
    planet = inner.mesh.gear
    _, tip = inner.active(planet)
    root, _ = outer.active(outer.mesh.pinion)
    half = planet.half_angle(planet.base_radius)
    # where both are when the sun's mesh begins: tau makes xi_s that of the tip
    tau = math.pi + inner.mesh.working_angle + half - tip / planet.base_radius
    passed = outer.mesh.working_angle + half + tau - root / planet.base_radius
    return _part(passed * planet.teeth / (2.0 * math.pi) + share * (overlaps[1] - overlaps[0]))


def pairs_in_contact(ratios: Sequence[float], ahead: Sequence[float]) -> tuple[int, int]:
    """Least and most tooth pairs in contact at once of several meshes, by their contact ratios and phases (pitches).

    What lasts no longer than an instant does not count.
    """
    events = sorted({_part(end - phase) for length, phase in zip(ratios, ahead, strict=True) for end in (0.0, length)})
    counts = []
    for before, after in pairwise([*events, events[0] + 1.0]):
        if after - before > TOGETHER:
            at = 0.5 * (before + after)
            counts.append(sum(_count(length, at + phase) for length, phase in zip(ratios, ahead, strict=True)))
    return min(counts), max(counts)


def _count(length: float, at: float) -> int:
    """Pairs of teeth between the beginning of their contact and its end, `length` pitches on, at a phase."""
    return math.floor(at) - math.ceil(at - length) + 1 if length > 0.0 else 0


def _part(value: float) -> float:
    """What is over whole numbers, 0 to 1; 0 for what is whole but for rounding."""
    part = value % 1.0
    return 0.0 if 1.0 - part < TOGETHER else part
