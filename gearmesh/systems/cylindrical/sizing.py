"""Search for pairs of cylindrical gears of a ratio, a module and a centre distance.

All tooth numbers within the tolerance of the ratio are tried. Helix angles are the ends of the range, the whole degrees
between, and the angle at which the profile shifts add up to 0. The sum of the shifts follows from the centre distance.
It is divided so that specific sliding at both ends of contact is equal, or as nearly as thick enough tips allow.
Internal pairs whose teeth would interfere get stub tips and other shifts, if such teeth pass each other.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.progress import in_turn
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, sum_of_shifts
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.merit import (
    INTERFERENCE_FAULT,
    MIN_TIP_MODULES,
    MeshMerit,
    mesh_merit,
    tip_thicknesses,
)
from gearmesh.systems.cylindrical.stub_tips import stub_keys
from gearmesh.systems.system import complete_design

#: fewest teeth of a proposed pinion
MIN_PINION_TEETH = 7
#: default face width, modules
DEFAULT_WIDTH_MODULES = 10.0
#: decimals of proposed profile shifts, helix angles (deg) and centre distances
SHIFT_DECIMALS = 4
#: difference of tooth numbers that is rounding
TEETH_ROUNDING = 1e-9
#: difference of sums of profile shifts that is rounding
SHIFT_ROUNDING = 1e-9
#: tolerances of the ratio at which the nearest pair is searched if none is found
WIDER_TOLERANCES = (0.02, 0.05, 0.1, 0.2)
#: halvings to the shift with which no tip is too thin: to the last decimal
BISECTION_STEPS = 15


@dataclass(frozen=True)
class Wanted:
    """Requirements for a pair."""

    #: gear ratio z2 / z1
    ratio: float
    #: centre distance, mm
    center_distance: float
    #: normal module, mm
    module: float
    #: True for an internal gear
    internal: bool = False
    #: normal pressure angle, deg
    pressure_angle: float = 20.0
    #: range of helix angles, deg
    helix: tuple[float, float] = (0.0, 0.0)
    #: range of the sum x1 + x2 of the profile shifts, modules; x2 - x1 of an internal pair
    shifts: tuple[float, float] = (-0.5, 1.2)
    #: relative tolerance of the ratio
    tolerance: float = 0.01
    #: face width of pinion and gear, mm; None for the default
    face_width: float | None = None


@dataclass(frozen=True)
class Candidate(MeshMerit):
    """A pair that meets the requirements, with its merits and the keys of its design."""

    keys: dict[str, Any]

    @property
    def ratio(self) -> float:
        return self.teeth[1] / self.teeth[0]


def candidates(wanted: Wanted) -> list[Candidate]:
    """Return all pairs that meet the requirements: without faults first, then by the worst specific sliding.

    Raises DesignError, naming the key and what is allowed, if there is none.
    """
    pairs, refusal = [], None
    for keys in in_turn(_designs(wanted)):
        try:
            pairs.append(_judge(keys))
        except DesignError as failure:
            refusal = failure
    if not pairs:
        raise DesignError("center_distance", wanted.center_distance, unit="mm", reason=_nothing(wanted, refusal))
    return sorted(
        pairs,
        key=lambda candidate: (len(candidate.faults), -min(candidate.sliding), candidate.teeth, candidate.helix_angle),
    )


def _designs(wanted: Wanted) -> Iterator[dict[str, Any]]:
    """Yield the keys of designs whose profile shifts add up within the range; the shifts are still to be shared."""
    for first, second in _tooth_numbers(wanted):
        for helix in _helix_angles(wanted, first, second):
            if sums_reach(wanted.shifts, partial(_total, wanted, first, second), helix):
                yield _keys(wanted, first, second, helix)


def sums_reach(shifts: tuple[float, float], sum_at: Callable[[float], float], value: float) -> bool:
    """Return True if the sum of the profile shifts is in a range at a proposed value, or at one that is rounded to it.

    `shifts`: ends of the range. `sum_at`: sum at a value; NaN if there is none.
    """
    half = 0.5 * 10.0**-SHIFT_DECIMALS
    sums = [total for side in (-half, 0.0, half) if not math.isnan(total := sum_at(value + side))]
    return bool(sums) and min(sums) - SHIFT_ROUNDING <= shifts[1] and max(sums) + SHIFT_ROUNDING >= shifts[0]


def _tooth_numbers(wanted: Wanted) -> Iterator[tuple[int, int]]:
    """Yield the tooth numbers within the tolerance of the ratio that come near the centre distance."""
    sign = -1 if wanted.internal else 1
    pitches = [2.0 * wanted.center_distance * math.cos(math.radians(angle)) / wanted.module for angle in wanted.helix]
    # shifts change twice the centre distance, in modules, by about twice their sum
    reach = 2.0 * max(map(abs, wanted.shifts)) + 1.0
    for total in range(max(1, math.ceil(min(pitches) - reach)), math.floor(max(pitches) + reach) + 1):
        least, most = (total / (wanted.ratio * (1.0 + side * wanted.tolerance) + sign) for side in (1.0, -1.0))
        for pinion_teeth in range(
            max(MIN_PINION_TEETH, math.ceil(least - TEETH_ROUNDING)), math.floor(most + TEETH_ROUNDING) + 1
        ):
            yield pinion_teeth, total - sign * pinion_teeth


def _helix_angles(wanted: Wanted, first: int, second: int) -> list[float]:
    """Return the ends of the range, the whole degrees in it, and the angle without profile shifts; deg."""
    low, high = wanted.helix
    angles = {low, high, *(float(angle) for angle in range(math.ceil(low), math.floor(high) + 1))}
    cosine = 0.5 * abs(second + (-first if wanted.internal else first)) * wanted.module / wanted.center_distance
    if cosine <= 1.0 and low < (unshifted := round(math.degrees(math.acos(cosine)), SHIFT_DECIMALS)) < high:
        angles.add(unshifted)
    return sorted(angles)


def _total(wanted: Wanted, first: int, second: int, helix: float) -> float:
    """Return the sum of the profile shifts that the centre distance requires; NaN if there is none."""
    alpha, beta = math.radians(wanted.pressure_angle), math.radians(helix)
    pinion = Toothing(first, wanted.module, alpha, beta)
    return sum_of_shifts(
        pinion, Toothing(second, wanted.module, alpha, beta, internal=wanted.internal), wanted.center_distance
    )


def _keys(wanted: Wanted, first: int, second: int, helix: float) -> dict[str, Any]:
    """Return the keys of a design with these tooth numbers and this helix angle (deg)."""
    width = DEFAULT_WIDTH_MODULES * wanted.module if wanted.face_width is None else wanted.face_width
    return {
        "kind": CylindricalDesign.own_kind,
        "module": wanted.module,
        **({} if wanted.pressure_angle == 20.0 else {"pressure_angle": wanted.pressure_angle}),
        **({} if helix == 0.0 else {"helix_angle": helix}),
        "pinion": {"teeth": first, "face_width": width},
        "gear": {"teeth": second, "face_width": width, **({"internal": True} if wanted.internal else {})},
        "assembly": {"center_distance": wanted.center_distance},
    }


def share_shifts(keys: dict[str, Any]) -> dict[str, Any]:
    """Return the keys with the pinion's profile shift for equal specific sliding.

    If a tip would be thinner than MIN_TIP_MODULES, but not with equal shifts, the shift is moved towards equal shifts.
    """
    own = complete_design(CylindricalDesign(**keys))
    sliding, equal = own.pinion.profile_shift, 0.5 * (own.pinion.profile_shift + own.gear.profile_shift)

    def is_thick(shift: float) -> bool:
        return (
            min(tip_thicknesses(proportions(complete_design(CylindricalDesign(**_with_shift(keys, shift))))))
            >= MIN_TIP_MODULES
        )

    if not is_thick(sliding) and is_thick(equal):
        shifts, _ = last_true(
            lambda x, _: np.array([is_thick(float(shift)) for shift in x]),
            np.array([equal]),
            np.array([sliding]),
            rounds=BISECTION_STEPS,
        )
        # rounded towards equal parts, where tips are broader
        step = 10.0**-SHIFT_DECIMALS
        return _with_shift(keys, (math.floor if sliding > equal else math.ceil)(float(shifts[0]) / step) * step)
    return _with_shift(keys, sliding)


def _with_shift(keys: dict[str, Any], shift: float) -> dict[str, Any]:
    """Return the keys with a profile shift of the pinion."""
    return {**keys, "pinion": {**keys["pinion"], "profile_shift": round(shift, SHIFT_DECIMALS) + 0.0}}


def _judge(keys: dict[str, Any]) -> Candidate:
    """Return a pair with its shifts shared. Raises DesignError for teeth that cannot exist."""
    keys = share_shifts(keys)
    merit = mesh_merit(complete_design(CylindricalDesign(**keys)))
    if INTERFERENCE_FAULT in merit.faults and (stub := _with_stub_tips(keys)) is not None:
        keys, merit = stub
    return Candidate(**{field.name: getattr(merit, field.name) for field in fields(merit)}, keys=keys)


def _with_stub_tips(keys: dict[str, Any]) -> tuple[dict[str, Any], MeshMerit] | None:
    """Return an internal pair with stub teeth that do not interfere, and its merits; None if there is none."""
    if not keys["gear"].get("internal") or (stub := stub_keys(keys)) is None:
        return None
    try:
        merit = mesh_merit(complete_design(CylindricalDesign(**stub)))
    except DesignError:
        return None
    return None if INTERFERENCE_FAULT in merit.faults else (stub, merit)


def _nothing(wanted: Wanted, refusal: DesignError | None) -> str:
    """Return the message if no pair meets the requirements.

    It gives the last refusal, or the pair nearest to the ratio.
    """
    if refusal is not None:
        return f"no pair of this ratio can be made: {refusal}"
    said = (
        f"no numbers of teeth have ratio {wanted.ratio:g} within {100.0 * wanted.tolerance:g} % and profile shifts that add up to "
        f"{wanted.shifts[0]:g} to {wanted.shifts[1]:g}"
    )
    sign = -1.0 if wanted.internal else 1.0
    for tolerance in WIDER_TOLERANCES:
        if tolerance <= wanted.tolerance or wanted.ratio * (1.0 - tolerance) + sign <= 0.0:
            continue
        wider = list(_designs(replace(wanted, tolerance=tolerance)))
        if wider:
            best = min(wider, key=lambda keys: abs(keys["gear"]["teeth"] / keys["pinion"]["teeth"] - wanted.ratio))
            first, second = best["pinion"]["teeth"], best["gear"]["teeth"]
            off = 100.0 * abs(second / first / wanted.ratio - 1.0)
            return f"{said}; the nearest is {second}/{first}, with an error of {off:.2g} %"
    return f"{said}; choose another ratio, module or helix range"
