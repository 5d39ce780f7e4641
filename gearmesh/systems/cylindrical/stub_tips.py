"""Stub tips and profile shifts with which an internal pair of small tooth difference runs without interference.

The sum of the shifts is fixed by the centre distance. For each division of this sum the pinion's tip is lowered step by
step. The ring's tip is then the longest that passes the pinion's tip (trochoid condition) and clears its fillet and its
base circle.

Among all pairs of tips that are thick enough, the pair with the greatest contact ratio is taken. Other divisions are
tried until the contact ratio is at least MIN_CONTACT_RATIO.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry.interference import reserves
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction, form_roll_length
from gearmesh.systems.cylindrical.geometry.measures import thickness_at
from gearmesh.systems.cylindrical.geometry.proportions import PairProportions, proportions
from gearmesh.systems.cylindrical.merit import MIN_TIP_MODULES
from gearmesh.systems.system import complete_design

#: changes of the pinion's profile shift that are tried in turn
SHIFT_CHANGES = (0.0, 0.3, -0.3, 0.6, -0.6)
#: contact ratio at which no further change is tried
MIN_CONTACT_RATIO = 1.2
#: parts of the pinion's addendum that are tried
ADDENDUM_PARTS = np.linspace(1.0, 0.3, 15)
#: least part of the ring's addendum
MIN_ADDENDUM_PART = 0.3
#: decimals (mm) of tip diameters, rounded to shorter teeth
TIP_DECIMALS = 3
#: halvings to the longest tip of the ring
BISECTION_STEPS = 14


@dataclass(frozen=True)
class StubPair:
    """A pair that does not interfere."""

    tips: tuple[float, float]
    shift: float
    contact_ratio: float


def stub_keys(keys: dict[str, Any]) -> dict[str, Any] | None:
    """Return the keys of an internal pair with the profile shift and tip diameters of the greatest contact ratio.

    None if no stub teeth pass each other.
    """
    shift = keys["pinion"]["profile_shift"]
    pairs: list[StubPair] = []
    for change in SHIFT_CHANGES:
        pair = _stub_pair(keys, round(shift + change, 4))
        if pair is not None:
            pairs.append(pair)
            if pair.contact_ratio >= MIN_CONTACT_RATIO:
                break
    if not pairs:
        return None
    best = max(pairs, key=lambda pair: pair.contact_ratio)
    step = 10.0**TIP_DECIMALS
    pinion_tip, ring_tip = math.floor(2.0 * best.tips[0] * step) / step, math.ceil(2.0 * best.tips[1] * step) / step
    return {
        **keys,
        "pinion": {**keys["pinion"], "profile_shift": best.shift, "tip_diameter": pinion_tip},
        "gear": {**keys["gear"], "tip_diameter": ring_tip},
    }


def _stub_pair(keys: dict[str, Any], shift: float) -> StubPair | None:
    """Return the best tips with a profile shift of the pinion; None if there are none."""
    try:
        design = complete_design(CylindricalDesign(**{**keys, "pinion": {**keys["pinion"], "profile_shift": shift}}))
        geometry = proportions(design)
        forms = form_roll_length(geometry.gears[0]), form_roll_length(geometry.gears[1])
    except DesignError:
        return None
    best = max(_passing(geometry, (max(0.0, forms[0]), forms[1])), default=None)
    return None if best is None else StubPair(best[1], shift, best[0])


def _passing(geometry: PairProportions, forms: tuple[float, float]) -> Iterator[tuple[float, tuple[float, float]]]:
    """Yield contact ratios and tip radii (mm) of pairs that do not interfere.

    `forms`: roll lengths of the form points.
    """
    mesh, (pinion, ring) = geometry.mesh, (geometry.mesh.pinion, geometry.mesh.gear)
    heights = pinion.radius - geometry.tips[0], geometry.tips[1] - ring.radius

    def line_of(tips: tuple[float, float]) -> LineOfAction:
        pinion_tip, second = (
            (form, own.roll_length(tip)) for form, own, tip in zip(forms, (pinion, ring), tips, strict=True)
        )
        return LineOfAction(mesh, (pinion_tip, second))

    def passes(tips: tuple[float, float]) -> bool:
        left, line = reserves(mesh, tips), line_of(tips)
        return min(left.involute, left.trochoid, line.interference_reserve(0), line.interference_reserve(1)) >= 0.0

    # for each tip of the pinion, bisect to the longest tip of the ring that passes
    for part in ADDENDUM_PARTS:
        pinion_tip = pinion.radius - part * heights[0]

        def longest(parts: Array, _: NDArray[np.intp], pinion_tip: float = pinion_tip) -> NDArray[np.bool_]:
            return np.array([passes((pinion_tip, ring.radius + share * heights[1])) for share in parts], dtype=np.bool_)

        if not passes((pinion_tip, ring.radius + MIN_ADDENDUM_PART * heights[1])):
            continue
        share = 1.0
        if not passes((pinion_tip, ring.radius + heights[1])):
            share = float(
                last_true(longest, np.array([MIN_ADDENDUM_PART]), np.array([1.0]), rounds=BISECTION_STEPS)[0][0]
            )
        tips = pinion_tip, ring.radius + share * heights[1]
        if (
            min(thickness_at(own, tip) / own.module for own, tip in zip((pinion, ring), tips, strict=True))
            >= MIN_TIP_MODULES
        ):
            yield line_of(tips).contact_ratio, tips
