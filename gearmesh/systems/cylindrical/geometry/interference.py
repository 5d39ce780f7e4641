"""Interference of the teeth of an internal gear with a pinion or a shaper cutter, outside the path of contact.

There are three limits. Each is an angle or a length that is negative where the teeth interfere:

    involute    the ring's tip comes below the point where the line of action touches the pinion's base circle
    trochoid    tips of pinion and ring pass each other in rotation, on their way into mesh and out of it
    trimming    tips pass each other while the pinion, or a shaper cutter, is moved radially into the ring

Radii are in mm or any one unit. The trochoid condition compares two rotations: the ring and the pinion turn until their
tips reach the point where both tip circles meet. For trimming the pinion moves straight outwards. The two tips then
meet where their distances from the line between the axes are equal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from gearmesh.kernel.numeric.roots import last_true
from gearmesh.records import dataclass
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, involute


@dataclass(frozen=True)
class Reserves:
    """Reserve of each limit: negative where teeth interfere, infinite where tips never come near each other."""

    #: roll length of the pinion at the ring's tip
    involute: float
    #: angle of the ring, rad
    trochoid: float
    #: angle of the ring, rad
    trimming: float
    #: True if the tips overlap all round; `trochoid` is then the reserve half a turn from the mesh
    all_round: bool = False


def reserves(mesh: InvolutePair, tips: tuple[float, float]) -> Reserves:
    """Return the reserves of a mesh with an internal gear.

    `tips`: tip radii in the order of the mesh (pinion, gear). Both sides of asymmetric teeth pass each other: the reserve
    is that of the side with less.
    """
    if mesh.pinion.asymmetric:
        sides = [reserves(side, tips) for side in mesh.sides]
        return Reserves(
            min(side.involute for side in sides),
            min(side.trochoid for side in sides),
            min(side.trimming for side in sides),
            any(side.all_round for side in sides),
        )
    pinion, ring, (tip, ring_tip) = mesh.pinion, mesh.gear, tips
    if pinion.internal:
        pinion, ring, (tip, ring_tip) = ring, pinion, (ring_tip, tip)
    working = involute(mesh.working_angle)
    at_tip, at_ring_tip = (
        involute(math.acos(min(1.0, own.base_radius / r))) for own, r in ((pinion, tip), (ring, ring_tip))
    )
    left = ring.roll_length(ring_tip) - mesh.generator
    if ring_tip < ring.base_radius:
        left = -mesh.generator
    return Reserves(
        left,
        _trochoid(mesh.distance, (tip, ring_tip), (at_tip - working, at_ring_tip - working), pinion.teeth / ring.teeth),
        _trimming((pinion, ring), (tip, ring_tip), (at_tip - working, at_ring_tip - working)),
        tip - mesh.distance > ring_tip,
    )


def _trochoid(distance: float, tips: tuple[float, float], beyond: tuple[float, float], ratio: float) -> float:
    """Return the rotation of the ring (rad) left between the tips at the point where both tip circles meet.

    - distance: centre distance.
    - tips: tip radii of pinion and ring.
    - beyond: involute functions at the tips, minus the involute function of the working pressure angle.
    - ratio: teeth of the pinion over teeth of the ring.

    If the circles do not meet, one is inside the other. Tips that never reach each other have an infinite reserve. Tips
    that overlap all round have the rotation by which they are past each other half a turn from the mesh, which is
    negative.
    """
    tip, ring_tip = tips
    if tip + distance <= ring_tip or tip + ring_tip <= distance:
        return math.inf
    # each tip circle's angle from the line between the axes to the point where the circles meet
    cosines = (
        (ring_tip**2 - tip**2 - distance**2) / (2.0 * distance * tip),
        (ring_tip**2 - tip**2 + distance**2) / (2.0 * distance * ring_tip),
    )
    # -1: one circle is inside the other, and the tips are compared half a turn from the mesh
    of_pinion, of_ring = (math.acos(max(-1.0, cosine)) for cosine in cosines)
    return ratio * (of_pinion + beyond[0]) - beyond[1] - of_ring


def _trimming(members: tuple[Toothing, Toothing], tips: tuple[float, float], beyond: tuple[float, float]) -> float:
    """Return the rotation of the ring (rad) left between the tips when the pinion moves radially outwards.

    Arguments as in `_trochoid`, with the members in the place of the distance.
    """
    pinion, ring = members
    teeth = ring.teeth / pinion.teeth
    cosine, cosine_ring = (min(1.0, own.base_radius / r) for own, r in zip(members, tips, strict=True))
    if cosine_ring <= cosine:
        return math.inf
    # sines of the tips' angles about both axes where the reserve is least along the way, at equal distances from the
    # line between the axes
    sines = (
        math.sqrt((1.0 - (cosine / cosine_ring) ** 2) / (1.0 - teeth**-2)),
        math.sqrt(((cosine_ring / cosine) ** 2 - 1.0) / (teeth**2 - 1.0)),
    )
    if max(sines) > 1.0:
        # the pinion is larger than the hole of the ring and cannot be moved in radially
        return -math.inf
    of_pinion, of_ring = (math.asin(sine) for sine in sines)
    return (of_pinion + beyond[0]) / teeth - of_ring - beyond[1]


def interference_warnings(
    mesh: InvolutePair, tips: tuple[float, float], roots: tuple[float, float], names: Sequence[str]
) -> tuple[str, ...]:
    """Return a warning for every limit that an internal gear violates, with the tip diameter that avoids it.

    - tips, roots: radii in the order of the mesh.
    - names: names of pinion and gear in the warnings.
    """
    if not (mesh.pinion.internal or mesh.gear.internal):
        return ()
    ring = 0 if mesh.pinion.internal else 1
    name = names[ring]
    warnings = []
    for limit, why in (
        ("involute", "involute interference: its tip reaches below the mating gear's base circle"),
        ("trochoid", "trochoid interference: the tips of both collide in rotation, outside the path of contact"),
    ):
        left_of = reserves(mesh, tips)
        left = getattr(left_of, limit)
        if left >= 0.0:
            continue
        if limit == "trochoid" and left_of.all_round:
            why = "trochoid interference: the tips of both overlap all round, the pinion never leaves its teeth"
        how = (
            f"{-left:.4g} mm of roll length"
            if limit == "involute"
            else f"{math.degrees(-left):.4g} deg of its rotation"
        )

        def holds(tip: float, limit: str = limit) -> bool:
            moved = (tip, tips[1]) if ring == 0 else (tips[0], tip)
            return float(getattr(reserves(mesh, moved), limit)) >= 0.0

        # the least tip diameter between tip and root for which the limit holds
        bound = least_that(holds, tips[ring], roots[ring])
        remedy = (
            f"; free with {name}.tip_diameter of at least {at_least(2.0 * bound)} mm" if bound < roots[ring] else ""
        )
        warnings.append(f"{name}: {why}, by {how}{remedy}")
    return tuple(warnings)


def least_that(holds: Callable[[float], bool], low: float, high: float) -> float:
    """Return the least radius between `low` and `high` that holds, to a millionth; `high` if none below does."""
    first, _ = last_true(
        lambda r, _: np.array([not holds(float(x)) for x in r]), np.array([low]), np.array([high]), rounds=24
    )
    return float(first[0]) + (high - low) * 1e-6
