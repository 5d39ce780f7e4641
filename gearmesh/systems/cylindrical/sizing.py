"""Pairs of cylindrical gears that have a ratio, a module and a centre distance: tooth numbers, helix angles and profile shifts.

For every pair of tooth numbers within the tolerance of the ratio the helix angle is one that the range names: its ends, the whole
degrees between, and the one with which the profile shifts add up to nothing. The sum of the shifts is what the centre distance
leaves, shared so that specific sliding is the same at both ends of contact, or nearly so where a tip would be too thin. Internal
pairs whose teeth would interfere have stub tips, and other shares, where these pass each other.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.progress import in_turn
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, sum_of_shifts
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.merit import INTERFERENCE, LEAST_TIP, MeshMerit, mesh_merit, tip_thicknesses
from gearmesh.systems.cylindrical.stub_tips import stub_keys
from gearmesh.systems.system import complete_design

#: fewest teeth of a pinion that are proposed
FEWEST = 7
#: widths of a face that is not given, in modules
WIDTH = 10.0
#: decimals of profile shifts and helix angles (deg) that are proposed
DECIMALS = 4
#: teeth that are nothing but rounding
ROUNDING = 1e-9
#: tolerances of the ratio at which the nearest pair is looked for where there is none
WIDER = (0.02, 0.05, 0.1, 0.2)
#: halvings to the shift with which no tip is too thin: to the last decimal
HALVINGS = 15


@dataclass(frozen=True)
class Wanted:
    """What a pair is to be: ratio z2 / z1, centre distance and normal module (mm), internal or external, and how freely.

    `helix` (deg) and `shifts` (the sum x1 + x2 in modules; x2 - x1 of an internal pair) are ranges, `tolerance` is that of the
    ratio, relative; `face_width` (mm) of both.
    """

    ratio: float
    center_distance: float
    module: float
    internal: bool = False
    pressure_angle: float = 20.0
    helix: tuple[float, float] = (0.0, 0.0)
    shifts: tuple[float, float] = (-0.5, 1.2)
    tolerance: float = 0.01
    face_width: float | None = None


@dataclass(frozen=True)
class Candidate(MeshMerit):
    """A pair that is as wanted: what it is worth, and the keys of its design."""

    keys: dict[str, Any]

    @property
    def ratio(self) -> float:
        return self.teeth[1] / self.teeth[0]


def candidates(wanted: Wanted) -> list[Candidate]:
    """All pairs that are as wanted, those without faults first, then by the worst specific sliding.

    Raises DesignError, naming the key and what is allowed, where there is none.
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
    """Keys of the designs whose shifts add up within the range, the shifts still to be shared."""
    for first, second in _tooth_numbers(wanted):
        for helix in _helix_angles(wanted, first, second):
            total = _total(wanted, first, second, helix)
            if wanted.shifts[0] <= total <= wanted.shifts[1]:
                yield _keys(wanted, first, second, helix)


def _tooth_numbers(wanted: Wanted) -> Iterator[tuple[int, int]]:
    """Tooth numbers within the tolerance of the ratio whose sum, or difference, comes near the centre distance."""
    sign = -1 if wanted.internal else 1
    pitches = [2.0 * wanted.center_distance * math.cos(math.radians(angle)) / wanted.module for angle in wanted.helix]
    # shifts change twice the centre distance, in modules, by about twice their sum
    reach = 2.0 * max(map(abs, wanted.shifts)) + 1.0
    for total in range(max(1, math.ceil(min(pitches) - reach)), math.floor(max(pitches) + reach) + 1):
        least, most = (total / (wanted.ratio * (1.0 + side * wanted.tolerance) + sign) for side in (1.0, -1.0))
        for first in range(max(FEWEST, math.ceil(least - ROUNDING)), math.floor(most + ROUNDING) + 1):
            yield first, total - sign * first


def _helix_angles(wanted: Wanted, first: int, second: int) -> list[float]:
    """The ends of the range, the whole degrees in it, and the angle at which no profile shift is needed; deg."""
    low, high = wanted.helix
    angles = {low, high, *(float(angle) for angle in range(math.ceil(low), math.floor(high) + 1))}
    cosine = 0.5 * abs(second + (-first if wanted.internal else first)) * wanted.module / wanted.center_distance
    if cosine <= 1.0 and low < (even := round(math.degrees(math.acos(cosine)), DECIMALS)) < high:
        angles.add(even)
    return sorted(angles)


def _total(wanted: Wanted, first: int, second: int, helix: float) -> float:
    """Sum of the profile shifts that the centre distance leaves; NaN where it leaves none."""
    alpha, beta = math.radians(wanted.pressure_angle), math.radians(helix)
    pinion = Toothing(first, wanted.module, alpha, beta)
    return sum_of_shifts(
        pinion, Toothing(second, wanted.module, alpha, beta, internal=wanted.internal), wanted.center_distance
    )


def _keys(wanted: Wanted, first: int, second: int, helix: float) -> dict[str, Any]:
    width = WIDTH * wanted.module if wanted.face_width is None else wanted.face_width
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
    """The keys with the pinion's profile shift: equal specific sliding, but tips of LEAST_TIP where equal parts have them."""
    own = complete_design(CylindricalDesign(**keys))
    sliding, equal = own.pinion.profile_shift, 0.5 * (own.pinion.profile_shift + own.gear.profile_shift)

    def broad(shift: float) -> bool:
        return (
            min(tip_thicknesses(proportions(complete_design(CylindricalDesign(**_with_shift(keys, shift))))))
            >= LEAST_TIP
        )

    if not broad(sliding) and broad(equal):
        shifts, _ = last_true(
            lambda x, _: np.array([broad(float(shift)) for shift in x]),
            np.array([equal]),
            np.array([sliding]),
            rounds=HALVINGS,
        )
        # rounded towards equal parts, where tips are broader
        step = 10.0**-DECIMALS
        return _with_shift(keys, (math.floor if sliding > equal else math.ceil)(float(shifts[0]) / step) * step)
    return _with_shift(keys, sliding)


def _with_shift(keys: dict[str, Any], shift: float) -> dict[str, Any]:
    return {**keys, "pinion": {**keys["pinion"], "profile_shift": round(shift, DECIMALS) + 0.0}}


def _judge(keys: dict[str, Any]) -> Candidate:
    """A pair with its shifts shared. Raises DesignError for teeth that cannot exist."""
    keys = share_shifts(keys)
    merit = mesh_merit(complete_design(CylindricalDesign(**keys)))
    if INTERFERENCE in merit.faults and (stub := _with_stub_tips(keys)) is not None:
        keys, merit = stub
    return Candidate(**{field.name: getattr(merit, field.name) for field in fields(merit)}, keys=keys)


def _with_stub_tips(keys: dict[str, Any]) -> tuple[dict[str, Any], MeshMerit] | None:
    """An internal pair with stub teeth that pass each other, and what it is worth; None where there are none with fewer faults."""
    if not keys["gear"].get("internal") or (stub := stub_keys(keys)) is None:
        return None
    try:
        merit = mesh_merit(complete_design(CylindricalDesign(**stub)))
    except DesignError:
        return None
    return None if INTERFERENCE in merit.faults else (stub, merit)


def _nothing(wanted: Wanted, refusal: DesignError | None) -> str:
    """What to say where no pair is as wanted: why the last one was refused, or what comes nearest to the ratio."""
    if refusal is not None:
        return f"no pair of this ratio can be made: {refusal}"
    said = (
        f"no numbers of teeth have ratio {wanted.ratio:g} within {100.0 * wanted.tolerance:g} % and profile shifts that add up to "
        f"{wanted.shifts[0]:g} to {wanted.shifts[1]:g}"
    )
    sign = -1.0 if wanted.internal else 1.0
    for tolerance in WIDER:
        if tolerance <= wanted.tolerance or wanted.ratio * (1.0 - tolerance) + sign <= 0.0:
            continue
        wider = list(_designs(replace(wanted, tolerance=tolerance)))
        if wider:
            best = min(wider, key=lambda keys: abs(keys["gear"]["teeth"] / keys["pinion"]["teeth"] - wanted.ratio))
            first, second = best["pinion"]["teeth"], best["gear"]["teeth"]
            off = 100.0 * abs(second / first / wanted.ratio - 1.0)
            return f"{said}; the nearest is {second}/{first}, with an error of {off:.2g} %"
    return f"{said}; choose another ratio, module or helix range"
