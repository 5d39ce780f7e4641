"""Search for planetary sets of a ratio and a size: module, tooth numbers, centre distance, profile shifts and rim.

For every module and helix angle all tooth numbers of sun and ring within the tolerance of the ratio are tried. The ring
must have the outside diameter with a sensible rim, or sun and planet about the centre distance. The planet fills the
space between them, except for a few teeth.

If the centre distance is open, three values are tried. At the first the shifts of sun and planet add up to 0, at the
second the shifts of planet and ring do. The third is their mean. Sun and planet share their shifts as a pair does; the
ring gets the rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from typing import Any

from gearmesh.errors import DesignError
from gearmesh.progress import in_turn
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.cutting.cutter import trimming_warnings
from gearmesh.systems.cylindrical.design import BASIC_RACKS, DEFAULT_RIM_MODULES
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, sum_of_shifts
from gearmesh.systems.cylindrical.geometry.proportions import PairProportions, proportions
from gearmesh.systems.cylindrical.merit import LENGTH_ROUNDING_MM, MeshMerit, mesh_merit
from gearmesh.systems.cylindrical.planetary import motion
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME, PlanetaryDesign
from gearmesh.systems.cylindrical.sizing import (
    DEFAULT_WIDTH_MODULES,
    MIN_PINION_TEETH,
    SHIFT_DECIMALS,
    share_shifts,
    sums_reach,
)

#: standard modules: series I of ISO 54, and DIN 780 below 1 mm
STANDARD_MODULES_MM = (
    *(0.1, 0.12, 0.16, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9),
    *(1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0),
)
#: most teeth of a ring whose module is searched
MAX_RING_TEETH = 120
#: least (the default of a design) and largest rim of the ring
RIM_RANGE_MODULES = (DEFAULT_RIM_MODULES, 8.0)
#: least and largest number of teeth by which the planet does not fill the space between sun and ring
MISSING_TEETH_RANGE = (-2, 4)
#: largest sum, of either sign, of the profile shifts of planet and ring
MAX_RING_SHIFT_SUM = 1.2
#: largest profile shift of a ring, of either sign
MAX_RING_SHIFT = 2.0
#: least gap between the tips of neighbouring planets of a sound set
MIN_TIP_GAP_MODULES = 0.5
#: least clearance between tips and roots of a sound set
MIN_CLEARANCE_MODULES = 0.1
#: reason for the rejection of a set whose planets cannot be equally spaced
UNEQUAL_SPACING = "planets cannot be equally spaced"
#: dedendum of the basic rack, modules
RACK_DEDENDUM = BASIC_RACKS["A"][1]
#: decimals (mm) of the rim
RIM_DECIMALS = 6
#: name of the mesh of sun and planet in faults
INNER_MESH = f"{SUN_NAME} and {PLANET_NAME}"
#: name of the mesh of planet and ring in faults
OUTER_MESH = f"{PLANET_NAME} and {RING_NAME}"


@dataclass(frozen=True)
class WantedSet:
    """Requirements for a planetary set: its ratio and the outside diameter of the ring, the centre distance or both."""

    #: speed ratio with the member `fixed`
    ratio: float
    #: outside diameter of the ring, mm; None if open
    outside_diameter: float | None = None
    #: centre distance, mm; None if open
    center_distance: float | None = None
    #: normal module, mm; None to search among STANDARD_MODULES_MM
    module: float | None = None
    #: number of planets
    planets: int = 3
    #: fixed member for which the ratio counts: "ring", "carrier" or "sun"
    fixed: str = RING_NAME
    #: normal pressure angle, deg
    pressure_angle: float = 20.0
    #: range of helix angles, deg
    helix: tuple[float, float] = (0.0, 0.0)
    #: range of the sum of the profile shifts of sun and planet, modules
    shifts: tuple[float, float] = (-0.5, 1.2)
    #: relative tolerance of the ratio
    tolerance: float = 0.01
    #: True to admit planets that cannot be equally spaced, at the nearest angles
    unequal: bool = False
    #: face width of all members, mm; None for the default
    face_width: float | None = None

    @property
    def ring_per_sun(self) -> tuple[float, float]:
        """Least and largest number of ring teeth per tooth of the sun."""
        ratios = [self.ratio * (1.0 + side * self.tolerance) for side in (-1.0, 1.0)]
        if self.fixed == "carrier":
            return ratios[0], ratios[1]
        own = [max(ratio - 1.0, 1e-9) for ratio in ratios]
        return (own[0], own[1]) if self.fixed == RING_NAME else (1.0 / own[1], 1.0 / own[0])


@dataclass(frozen=True)
class SetTrial:
    """Tooth numbers that are tried with a module, a helix angle and a centre distance."""

    #: teeth of sun, planet and ring
    teeth: tuple[int, int, int]
    #: normal module, mm
    module: float
    #: helix angle, deg
    helix_angle: float
    #: centre distance, mm
    distance: float


@dataclass(frozen=True)
class SetCandidate:
    """A set that meets the requirements."""

    #: keys of its design
    keys: dict[str, Any]
    #: its teeth
    trial: SetTrial
    #: merits of the mesh of sun and planet
    inner: MeshMerit
    #: merits of the mesh of planet and ring
    outer: MeshMerit
    #: profile shifts of sun, planet and ring, modules
    shifts: tuple[float, float, float]
    #: ratio with the fixed member
    ratio: float
    #: outside diameter of the ring, mm
    outside_diameter: float
    #: angles of the planets, deg
    angles: tuple[float, ...]
    #: gap between the tips of neighbouring planets, mm
    apart: float
    #: least clearance between tips and roots, modules
    clearance: float
    #: faults of the set, as text
    faults: tuple[str, ...]

    @property
    def sliding(self) -> float:
        """Worst specific sliding of both meshes."""
        return min(*self.inner.sliding, *self.outer.sliding)

    @property
    def tip(self) -> float:
        """Least tip thickness of all members, modules."""
        return min(*self.inner.tips, *self.outer.tips)


@dataclass(frozen=True)
class RejectedSet:
    """A set that is not proposed: its teeth, a short reason, and details."""

    trial: SetTrial
    reason: str
    detail: str = ""


@dataclass(frozen=True)
class SetSearch:
    """All sets that meet the requirements, the best first, and all rejected sets."""

    candidates: tuple[SetCandidate, ...]
    rejections: tuple[RejectedSet, ...]

    @property
    def reasons(self) -> dict[str, int]:
        """Number of rejected sets by reason, the most frequent first."""
        counts: dict[str, int] = {}
        for rejection in self.rejections:
            counts[rejection.reason] = counts.get(rejection.reason, 0) + 1
        return dict(sorted(counts.items(), key=lambda reason: -reason[1]))


class _Rejection(Exception):
    """Rejection of a trial: a short reason, and details."""


def search_sets(wanted: WantedSet) -> SetSearch:
    """Return all planetary sets that meet the requirements, the best first.

    The order is: sets without faults, sets of exactly the ratio, larger modules, better specific sliding.

    Raises DesignError, naming the key and the reasons of rejections, if there is none.
    """
    candidates, rejections = [], []
    for trial in in_turn(_trials(wanted)):
        try:
            candidates.append(_judge(wanted, trial))
        except _Rejection as rejection:
            rejections.append(RejectedSet(trial, *rejection.args))
    search = SetSearch(
        tuple(
            sorted(
                candidates,
                key=lambda candidate: (
                    len(candidate.faults),
                    abs(candidate.ratio / wanted.ratio - 1.0) > LENGTH_ROUNDING_MM,
                    -candidate.trial.module,
                    -candidate.sliding,
                    candidate.trial.teeth,
                    candidate.trial.helix_angle,
                ),
            )
        ),
        tuple(rejections),
    )
    if not candidates:
        raise DesignError("ratio", wanted.ratio, reason=_nothing(wanted, search))
    return search


def _trials(wanted: WantedSet) -> Iterator[SetTrial]:
    """Yield all teeth and distances that are tried."""
    low, high = wanted.helix
    helices = sorted({low, high, *map(float, range(math.ceil(low), math.floor(high) + 1))})
    for module in STANDARD_MODULES_MM if wanted.module is None else (wanted.module,):
        for helix in helices:
            transverse = module / math.cos(math.radians(helix))
            for ring in _ring_teeth(wanted, module, transverse):
                yield from _with_ring(wanted, module, helix, ring)


def _ring_teeth(wanted: WantedSet, module: float, transverse: float) -> range:
    """Return the tooth numbers of rings of about the outside diameter, or about the centre distance."""
    least, most = wanted.ring_per_sun
    if wanted.outside_diameter is not None:
        # the root is a dedendum outside the reference circle, apart from the profile shift
        radii = [0.5 * wanted.outside_diameter - (RACK_DEDENDUM + rim) * module for rim in RIM_RANGE_MODULES[::-1]]
        ends = [
            2.0 * (radius + side * MAX_RING_SHIFT * module) / transverse
            for radius, side in zip(radii, (-1, 1), strict=True)
        ]
    else:
        assert wanted.center_distance is not None
        # the distance is about a quarter of the teeth of ring and sun together, in transverse modules
        sums = [
            4.0 * wanted.center_distance / transverse + 2.0 * side * (MAX_RING_SHIFT_SUM + MISSING_TEETH_RANGE[1])
            for side in (-1, 1)
        ]
        ends = [sums[0] / (1.0 + 1.0 / least), sums[1] / (1.0 + 1.0 / most)]
    top = math.floor(max(ends)) if wanted.module is not None else min(math.floor(max(ends)), MAX_RING_TEETH)
    return range(max(3 * MIN_PINION_TEETH, math.ceil(min(ends))), top + 1)


def _with_ring(wanted: WantedSet, module: float, helix: float, ring: int) -> Iterator[SetTrial]:
    """Yield the trials with a ring: all teeth of the sun within the ratio, of the planet, and centre distances."""
    least, most = wanted.ring_per_sun
    for sun in range(
        max(MIN_PINION_TEETH, math.ceil(ring / most - LENGTH_ROUNDING_MM)),
        math.floor(ring / least + LENGTH_ROUNDING_MM) + 1,
    ):
        for less in range(MISSING_TEETH_RANGE[0], MISSING_TEETH_RANGE[1] + 1):
            planet, odd = divmod(ring - sun - less, 2)
            if odd or planet < MIN_PINION_TEETH:
                continue
            teeth = sun, planet, ring
            for distance in _distances(wanted, module, helix, teeth):
                yield SetTrial(teeth, module, helix, distance)


def _distances(wanted: WantedSet, module: float, helix: float, teeth: tuple[int, int, int]) -> list[float]:
    """Return the centre distances (mm) that are tried.

    They are the given distance, or the distances of both meshes without profile shift and their middle.
    """
    if wanted.center_distance is not None:
        return [wanted.center_distance]
    sun, planet, ring = teeth
    of_sun, of_ring = (0.5 * total * module / math.cos(math.radians(helix)) for total in (sun + planet, ring - planet))
    return sorted({round(distance, SHIFT_DECIMALS) for distance in (of_sun, 0.5 * (of_sun + of_ring), of_ring)})


def _judge(wanted: WantedSet, trial: SetTrial) -> SetCandidate:
    """Return a set with its shifts shared. Raises _Rejection if it cannot exist or misses a requirement."""
    angles = _angles(wanted, trial)
    totals = _sums_of_shifts(wanted, trial)
    try:
        # sun and planet share their shifts as a pair; the ring takes the shift that its mesh with the planet needs
        pair = share_shifts(_pair_keys(wanted, trial))
        outside = _outside(wanted, trial, totals[1] - totals[0] + pair["pinion"]["profile_shift"])
        keys = _keys(wanted, trial, pair, angles, outside.rim)
        both = meshes(PlanetaryDesign(**keys))
        inner, outer = mesh_merit(both.inner), mesh_merit(both.outer)
    except DesignError as failure:
        raise _Rejection("teeth that cannot be made", str(failure)) from failure
    inner_geometry, outer_geometry = proportions(both.inner), proportions(both.outer)
    apart = _apart(angles, trial.distance, inner_geometry.tips[1])
    if apart <= 0.0:
        raise _Rejection("neighbouring planets touch", f"their tips overlap by {-apart:.4g} mm")
    clearance = _least_clearance(inner_geometry, outer_geometry) / trial.module
    return SetCandidate(
        keys=keys,
        trial=trial,
        inner=inner,
        outer=outer,
        shifts=(*inner.shifts, outer.shifts[1]),
        ratio=abs(motion.ratio(trial.teeth[0], trial.teeth[2], wanted.fixed)),
        outside_diameter=outside.diameter,
        angles=tuple(angles),
        apart=apart,
        clearance=clearance,
        faults=(
            *(f"{INNER_MESH}: {fault}" for fault in inner.faults),
            *(f"{OUTER_MESH}: {fault}" for fault in outer.faults),
            *_set_faults(outer_geometry, apart / trial.module, clearance),
        ),
    )


def _sums_of_shifts(wanted: WantedSet, trial: SetTrial) -> tuple[float, float]:
    """Return the sums of the profile shifts of sun and planet, and of planet and ring.

    Raises _Rejection for a distance at which either sum is too large.
    """
    alpha, beta = math.radians(wanted.pressure_angle), math.radians(trial.helix_angle)
    sun, planet = (Toothing(teeth, trial.module, alpha, beta) for teeth in trial.teeth[:2])
    ring = Toothing(trial.teeth[2], trial.module, alpha, beta, internal=True)
    pairs = (sun, planet), (planet, ring)
    totals = sum_of_shifts(sun, planet, trial.distance), sum_of_shifts(planet, ring, trial.distance)
    limits = wanted.shifts, (-MAX_RING_SHIFT_SUM, MAX_RING_SHIFT_SUM)
    for name, pair, total, (low, high) in zip((INNER_MESH, OUTER_MESH), pairs, totals, limits, strict=True):
        if not sums_reach((low, high), partial(sum_of_shifts, *pair), trial.distance):
            said = "no working pressure angle" if math.isnan(total) else f"they add up to {total:.4g}"
            raise _Rejection(f"profile shifts of {name} outside {low:g} to {high:g}", said)
    return totals


def _angles(wanted: WantedSet, trial: SetTrial) -> list[float]:
    """Return the angles of the planets (deg), equally spaced, or the nearest at which they can be assembled.

    Unequal spacing must be admitted; otherwise _Rejection is raised.
    """
    total, count = trial.teeth[0] + trial.teeth[2], wanted.planets
    if total % count and not wanted.unequal:
        raise _Rejection(UNEQUAL_SPACING, f"{total} teeth of sun and ring, {count} planets")
    return [360.0 * round(k * total / count) / total for k in range(count)]


def _pair_keys(wanted: WantedSet, trial: SetTrial) -> dict[str, Any]:
    """Return sun and planet as a pair whose shifts are still to be shared."""
    width = DEFAULT_WIDTH_MODULES * trial.module if wanted.face_width is None else wanted.face_width
    first, second = ({"teeth": teeth, "face_width": width} for teeth in trial.teeth[:2])
    return {
        "kind": "cylindrical",
        "module": trial.module,
        **({} if wanted.pressure_angle == 20.0 else {"pressure_angle": wanted.pressure_angle}),
        **({} if trial.helix_angle == 0.0 else {"helix_angle": trial.helix_angle}),
        "pinion": first,
        "gear": second,
        "assembly": {"center_distance": trial.distance},
    }


def _keys(
    wanted: WantedSet, trial: SetTrial, pair: dict[str, Any], angles: list[float], rim: float | None
) -> dict[str, Any]:
    """Return the keys of the set's design, from the keys of sun and planet."""
    equal = (trial.teeth[0] + trial.teeth[2]) % wanted.planets == 0
    return {
        "kind": PlanetaryDesign.own_kind,
        **{key: value for key, value in pair.items() if key not in ("kind", "pinion", "gear", "assembly")},
        "planets": wanted.planets,
        **({} if wanted.fixed == RING_NAME else {"fixed": wanted.fixed}),
        SUN_NAME: pair["pinion"],
        PLANET_NAME: pair["gear"],
        RING_NAME: {**pair["gear"], "teeth": trial.teeth[2], **({} if rim is None else {"rim": rim})},
        "assembly": {**pair["assembly"], **({} if equal else {"planet_angles": ", ".join(map(repr, angles))})},
    }


def _apart(angles: list[float], distance: float, tip: float) -> float:
    """Return the least gap (mm) between the tips of neighbouring planets; infinite for a single planet."""
    steps = [(after - before) % 360.0 for before, after in zip(angles, [*angles[1:], angles[0]], strict=True)]
    if len(angles) < 2:
        return math.inf
    return 2.0 * distance * math.sin(math.radians(min(*steps, *(360.0 - step for step in steps))) / 2.0) - 2.0 * tip


@dataclass(frozen=True)
class _Outside:
    """The outside of a ring: its diameter and its rim (mm); the rim is None for the default."""

    diameter: float
    rim: float | None


def _outside(wanted: WantedSet, trial: SetTrial, shift: float) -> _Outside:
    """Return the outside of a ring with a profile shift.

    Raises _Rejection for an outside diameter that leaves too little or too much rim.
    """
    module, beta = trial.module, math.radians(trial.helix_angle)
    ring = Toothing(trial.teeth[2], module, math.radians(wanted.pressure_angle), beta, internal=True)
    root = ring.radius_at((shift - RACK_DEDENDUM) * module)
    if wanted.outside_diameter is None:
        return _Outside(2.0 * (root + DEFAULT_RIM_MODULES * module), None)
    rim = 0.5 * wanted.outside_diameter - root
    for share, side, word in zip(RIM_RANGE_MODULES, (-1.0, 1.0), ("thinner", "thicker"), strict=True):
        if side * (rim - share * module) > LENGTH_ROUNDING_MM:
            raise _Rejection(f"rim {word} than {share:g} modules", f"{rim:.4g} mm")
    rim = round(rim, RIM_DECIMALS)
    return _Outside(2.0 * (root + rim), rim)


def _least_clearance(first: PairProportions, second: PairProportions) -> float:
    """Return the least clearance (mm) between any tip and the mating root."""
    return min(geometry.clearance(k) for geometry in (first, second) for k in (0, 1))


def _set_faults(outer: PairProportions, apart: float, clearance: float) -> tuple[str, ...]:
    """Return the faults of the whole set: tips that the cutter trims, planets too close, too little clearance."""
    faults = {
        f"{OUTER_MESH}: cutter trims the tips": bool(trimming_warnings(outer.gears)),
        f"planets closer than {MIN_TIP_GAP_MODULES:g} modules": apart < MIN_TIP_GAP_MODULES,
        f"tip to root below {MIN_CLEARANCE_MODULES:g} modules": clearance < MIN_CLEARANCE_MODULES,
    }
    return tuple(fault for fault, there in faults.items() if there)


def _nothing(wanted: WantedSet, search: SetSearch) -> str:
    """Return the message if no set meets the requirements: the number of rejected sets and the reasons."""
    if not search.rejections:
        sizes = "" if wanted.module is None else f" of module {wanted.module:g} mm"
        return (
            f"no numbers of teeth{sizes} have this ratio within {100.0 * wanted.tolerance:g} % in this size; "
            "choose a wider tolerance, or another module or size"
        )
    reasons = "; ".join(f"{count} {reason}" for reason, count in search.reasons.items())
    more = "; admit unequal spacing" if UNEQUAL_SPACING in search.reasons else ""
    return f"none of {len(search.rejections)} sets can be used: {reasons}{more}"
