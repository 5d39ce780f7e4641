"""Interference of the teeth of an internal gear with a pinion, or with the cutter that shapes it, outside the path of contact.

Three limits, each as an angle or ratio that is negative where the teeth interfere:

    involute    the ring's tip comes below the point where the line of action touches the pinion's base circle
    trochoid    tips of pinion and ring pass each other in rotation, on their way into mesh and out of it
    trimming    the same while the pinion, or a shaper cutter, is moved radially into the ring

Radii in mm or any one unit. The trochoid condition compares the turn of the ring until its tip reaches the point where both tip
circles meet with that of the pinion; for trimming the pinion goes straight outwards, and the two tips meet where their distances
from the line between the axes are equal.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.roots import last_true
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair, Toothing, involute


@dataclass(frozen=True)
class Reserves:
    """What is left of each limit: `involute` as the pinion's roll length where the ring's tip comes, `trochoid` and `trimming` as
    angles of the ring, rad. Negative: interference; infinite: the tips never come near each other; `all_round`: the tips overlap
    all round, and the trochoid reserve is that half a turn from the mesh."""

    involute: float
    trochoid: float
    trimming: float
    all_round: bool = False


def reserves(mesh: InvolutePair, tips: tuple[float, float]) -> Reserves:
    """The reserves of a mesh with an internal gear, of tip radii `tips` (pinion, gear, as in the mesh)."""
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
    """Turn of the ring (rad) left between the tips when they stand where both tip circles meet.

    `beyond`: involute functions at the tips less that of the working pressure angle. Circles that do not meet are one inside the
    other: tips that never reach each other have an infinite reserve, those that overlap all round have the turn by which they
    are past each other half a turn from the mesh, which is negative.
    """
    tip, ring_tip = tips
    if tip + distance <= ring_tip:
        return math.inf
    cosines = (
        (ring_tip**2 - tip**2 - distance**2) / (2.0 * distance * tip),
        (ring_tip**2 - tip**2 + distance**2) / (2.0 * distance * ring_tip),
    )
    of_pinion, of_ring = (math.acos(max(-1.0, cosine)) for cosine in cosines)
    return ratio * (of_pinion + beyond[0]) - beyond[1] - of_ring


def _trimming(members: tuple[Toothing, Toothing], tips: tuple[float, float], beyond: tuple[float, float]) -> float:
    """Turn of the ring (rad) left between the tips when the pinion goes radially out of the ring's middle."""
    pinion, ring = members
    teeth = ring.teeth / pinion.teeth
    cosine, cosine_ring = (min(1.0, own.base_radius / r) for own, r in zip(members, tips, strict=True))
    if cosine_ring <= cosine:
        return math.inf
    sines = (
        math.sqrt((1.0 - (cosine / cosine_ring) ** 2) / (1.0 - teeth**-2)),
        math.sqrt(((cosine_ring / cosine) ** 2 - 1.0) / (teeth**2 - 1.0)),
    )
    if max(sines) > 1.0:
        # the pinion is larger than the hole of the ring
        return -math.inf
    of_pinion, of_ring = (math.asin(sine) for sine in sines)
    return (of_pinion + beyond[0]) / teeth - of_ring - beyond[1]


def interference_warnings(
    mesh: InvolutePair, tips: tuple[float, float], roots: tuple[float, float], names: Sequence[str]
) -> tuple[str, ...]:
    """A line for every limit that an internal gear of a mesh passes, with its tip diameter from which on it holds.

    `names`: what the lines call pinion and gear.
    """
    if not (mesh.pinion.internal or mesh.gear.internal):
        return ()
    which = 0 if mesh.pinion.internal else 1
    name = names[which]
    warnings = []
    for limit, why in (
        ("involute", "involute interference: its tip reaches below the mating gear's base circle"),
        ("trochoid", "trochoid interference: the tips of both collide in rotation, outside the path of contact"),
    ):
        own = reserves(mesh, tips)
        left = getattr(own, limit)
        if left >= 0.0:
            continue
        if limit == "trochoid" and own.all_round:
            why = "trochoid interference: the tips of both overlap all round, the pinion never leaves its teeth"
        how = (
            f"{-left:.4g} mm of roll length"
            if limit == "involute"
            else f"{math.degrees(-left):.4g} deg of its rotation"
        )

        def holds(tip: float, limit: str = limit) -> bool:
            moved = (tip, tips[1]) if which == 0 else (tips[0], tip)
            return float(getattr(reserves(mesh, moved), limit)) >= 0.0

        bound = least_that(holds, tips[which], roots[which])
        remedy = (
            f"; free with {name}.tip_diameter of at least {at_least(2.0 * bound)} mm" if bound < roots[which] else ""
        )
        warnings.append(f"{name}: {why}, by {how}{remedy}")
    return tuple(warnings)


def least_that(holds: Callable[[float], bool], low: float, high: float) -> float:
    """The least radius from `low` on up to `high` that holds, to a millionth; `high` where none below does."""
    first, _ = last_true(
        lambda r, _: np.array([not holds(float(x)) for x in r]), np.array([low]), np.array([high]), rounds=24
    )
    return float(first[0]) + (high - low) * 1e-6
