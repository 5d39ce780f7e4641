"""Stub tips and profile shifts with which an internal pair of few teeth difference turns without interference.

The sum of the shifts is what the centre distance leaves. For each share of it the pinion's tip is lowered step by step; the ring's
tip is then the longest that passes the pinion's (trochoid condition), clears its fillet and its base circle. Of all pairs of tips
that are broad enough the one with the greatest contact ratio is taken; other shares are tried until it is at least WANTED_RATIO.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry.interference import reserves
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction, form_roll_length
from gearmesh.systems.cylindrical.geometry.measures import thickness_at
from gearmesh.systems.cylindrical.geometry.proportions import PairProportions, proportions
from gearmesh.systems.cylindrical.merit import LEAST_TIP
from gearmesh.systems.system import complete_design

#: changes of the pinion's profile shift that are tried in turn, until the contact ratio is WANTED_RATIO
SHIFT_CHANGES, WANTED_RATIO = (0.0, 0.3, -0.3, 0.6, -0.6), 1.2
#: parts of a tooth's addendum that are tried, and the least
ADDENDUM_PARTS, LEAST_PART = np.linspace(1.0, 0.3, 15), 0.3
#: decimals (mm) of tip diameters, rounded to shorter teeth, and halvings to the longest tip of the ring
TIP_DECIMALS, HALVINGS = 3, 14


@dataclass(frozen=True)
class StubPair:
    """Tip radii (pinion, ring, mm) of a pair that does not interfere, the pinion's profile shift and the contact ratio."""

    tips: tuple[float, float]
    shift: float
    contact_ratio: float


def stub_keys(keys: dict[str, Any]) -> dict[str, Any] | None:
    """The keys of an internal pair with the profile shift and the tip diameters of the greatest contact ratio; None where no stub
    teeth pass each other."""
    shift = keys["pinion"]["profile_shift"]
    pairs: list[StubPair] = []
    for change in SHIFT_CHANGES:
        pair = _stub_pair(keys, round(shift + change, 4))
        if pair is not None:
            pairs.append(pair)
            if pair.contact_ratio >= WANTED_RATIO:
                break
    if not pairs:
        return None
    best = max(pairs, key=lambda pair: pair.contact_ratio)
    step = 10.0**TIP_DECIMALS
    first, second = math.floor(2.0 * best.tips[0] * step) / step, math.ceil(2.0 * best.tips[1] * step) / step
    return {
        **keys,
        "pinion": {**keys["pinion"], "profile_shift": best.shift, "tip_diameter": first},
        "gear": {**keys["gear"], "tip_diameter": second},
    }


def _stub_pair(keys: dict[str, Any], shift: float) -> StubPair | None:
    """The best tips with a profile shift of the pinion; None where there are none."""
    try:
        design = complete_design(CylindricalDesign(**{**keys, "pinion": {**keys["pinion"], "profile_shift": shift}}))
        geometry = proportions(design)
        forms = form_roll_length(geometry.gears[0]), form_roll_length(geometry.gears[1])
    except DesignError:
        return None
    best = max(_passing(geometry, (max(0.0, forms[0]), forms[1])), default=None)
    return None if best is None else StubPair(best[1], shift, best[0])


def _passing(geometry: PairProportions, forms: tuple[float, float]) -> Iterator[tuple[float, tuple[float, float]]]:
    """Contact ratios and tip radii (mm) of pairs that do not interfere; `forms`: roll lengths of the form points."""
    mesh, (pinion, ring) = geometry.mesh, (geometry.mesh.pinion, geometry.mesh.gear)
    heights = pinion.radius - geometry.tips[0], geometry.tips[1] - ring.radius

    def line_of(tips: tuple[float, float]) -> LineOfAction:
        first, second = (
            (form, own.roll_length(tip)) for form, own, tip in zip(forms, (pinion, ring), tips, strict=True)
        )
        return LineOfAction(mesh, (first, second))

    def passes(tips: tuple[float, float]) -> bool:
        left, line = reserves(mesh, tips), line_of(tips)
        return min(left.involute, left.trochoid, *(line.interference_reserve(own) for own in (pinion, ring))) >= 0.0

    for part in ADDENDUM_PARTS:
        first = pinion.radius - part * heights[0]

        def longest(parts: Array, _: NDArray[np.intp], first: float = first) -> NDArray[np.bool_]:
            return np.array([passes((first, ring.radius + share * heights[1])) for share in parts], dtype=np.bool_)

        if not passes((first, ring.radius + LEAST_PART * heights[1])):
            continue
        share = 1.0
        if not passes((first, ring.radius + heights[1])):
            share = float(last_true(longest, np.array([LEAST_PART]), np.array([1.0]), rounds=HALVINGS)[0][0])
        tips = first, ring.radius + share * heights[1]
        if min(thickness_at(own, tip) / own.module for own, tip in zip((pinion, ring), tips, strict=True)) >= LEAST_TIP:
            yield line_of(tips).contact_ratio, tips
