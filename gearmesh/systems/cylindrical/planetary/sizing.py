"""Planetary sets that have a ratio and a size: module, tooth numbers, centre distance, profile shifts and rim.

Of every module and helix angle all tooth numbers of sun and ring within the tolerance of the ratio are taken, whose ring has the
outside diameter with a sensible rim, or whose sun and planet have about the centre distance. The planet fills the space between
them but for a few teeth. Where the centre distance is open it is that at which the shifts of sun and planet add up to nothing,
that of planet and ring, and the middle of both. Sun and planet share their shifts as those of a pair; the ring has what is left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from gearmesh.errors import DesignError
from gearmesh.progress import in_turn
from gearmesh.systems.cylindrical.cutting.cutter import trimming_warnings
from gearmesh.systems.cylindrical.design import PROFILES, RIM
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, sum_of_shifts
from gearmesh.systems.cylindrical.geometry.proportions import PairProportions, proportions
from gearmesh.systems.cylindrical.merit import ROUNDING, MeshMerit, mesh_merit
from gearmesh.systems.cylindrical.planetary import motion
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET, RING, SUN, PlanetaryDesign
from gearmesh.systems.cylindrical.sizing import DECIMALS, FEWEST, WIDTH, share_shifts

#: standard modules: series I of ISO 54, and that of DIN 780 below 1 mm
MODULES = (
    *(0.1, 0.12, 0.16, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9),
    *(1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0, 50.0),
)
#: most teeth of a ring whose module is looked for
MOST_TEETH = 120
#: rim of the ring in modules, at least (the default of a design) and at most
RIMS = (RIM, 8.0)
#: teeth by which planets are fewer than fill the space between sun and ring, at least and at most
LESS = (-2, 4)
#: what the shifts of planet and ring may add up to, either way
RING_SHIFTS = 1.2
#: largest shift of a ring, modules
REACH = 2.0
#: a sound set has at least these clearances in modules: of the tips of neighbouring planets, of tips and roots
APART, CLEARANCE = 0.5, 0.1
#: why a set is rejected whose planets cannot be equally spaced
UNEQUAL = "planets cannot be equally spaced"
#: of the basic rack, modules
DEDENDUM = PROFILES["A"][1]
#: decimals (mm) of the rim
RIM_DECIMALS = 6
#: the mesh of sun and planet, that of planet and ring, as faults name them
INNER, OUTER = f"{SUN} and {PLANET}", f"{PLANET} and {RING}"


@dataclass(frozen=True)
class WantedSet:
    """What a planetary set is to be: ratio, outside diameter of the ring or centre distance or both (mm), number of planets.

    `module` (mm) is looked for among MODULES where it is None; `fixed` is the member for which the ratio counts; `helix` (deg) and
    `shifts` (the sum of those of sun and planet, in modules) are ranges, `tolerance` is that of the ratio, relative; `unequal`
    admits planets that cannot be equally spaced, at the nearest angles; `face_width` (mm) of all.
    """

    ratio: float
    outside_diameter: float | None = None
    center_distance: float | None = None
    module: float | None = None
    planets: int = 3
    fixed: str = RING
    pressure_angle: float = 20.0
    helix: tuple[float, float] = (0.0, 0.0)
    shifts: tuple[float, float] = (-0.5, 1.2)
    tolerance: float = 0.01
    unequal: bool = False
    face_width: float | None = None

    @property
    def ring_per_sun(self) -> tuple[float, float]:
        """Least and largest ring teeth per tooth of the sun."""
        ratios = [self.ratio * (1.0 + side * self.tolerance) for side in (-1.0, 1.0)]
        if self.fixed == "carrier":
            return ratios[0], ratios[1]
        own = [max(ratio - 1.0, 1e-9) for ratio in ratios]
        return (own[0], own[1]) if self.fixed == RING else (1.0 / own[1], 1.0 / own[0])


@dataclass(frozen=True)
class SetTrial:
    """Tooth numbers of sun, planet and ring of a module (mm) and a helix angle (deg), at a centre distance (mm)."""

    teeth: tuple[int, int, int]
    module: float
    helix_angle: float
    distance: float


@dataclass(frozen=True)
class SetCandidate:
    """A set that is as wanted: keys of its design, its teeth, the merits of both its meshes, shifts of sun, planet and ring.

    `ratio` with the fixed member; `outside_diameter` of the ring and `apart`, the clearance of neighbouring planets' tips: mm;
    `angles` of the planets, deg; `clearance`: least of tips and roots, modules.
    """

    keys: dict[str, Any]
    trial: SetTrial
    inner: MeshMerit
    outer: MeshMerit
    shifts: tuple[float, float, float]
    ratio: float
    outside_diameter: float
    angles: tuple[float, ...]
    apart: float
    clearance: float
    faults: tuple[str, ...]

    @property
    def sliding(self) -> float:
        """The worst specific sliding of both meshes."""
        return min(*self.inner.sliding, *self.outer.sliding)

    @property
    def tip(self) -> float:
        """The thinnest tip of all members, modules."""
        return min(*self.inner.tips, *self.outer.tips)


@dataclass(frozen=True)
class RejectedSet:
    """A set that is not proposed: its teeth, why in short, and what there is to say more."""

    trial: SetTrial
    reason: str
    detail: str = ""


@dataclass(frozen=True)
class SetSearch:
    """All sets that are as wanted, the best first, and all that were rejected."""

    candidates: tuple[SetCandidate, ...]
    rejections: tuple[RejectedSet, ...]

    @property
    def reasons(self) -> dict[str, int]:
        """How many were rejected for which reason, most first."""
        counts: dict[str, int] = {}
        for rejection in self.rejections:
            counts[rejection.reason] = counts.get(rejection.reason, 0) + 1
        return dict(sorted(counts.items(), key=lambda reason: -reason[1]))


class _Rejection(Exception):
    """Why a trial is not proposed: in short, and in detail."""


def search_sets(wanted: WantedSet) -> SetSearch:
    """All planetary sets that are as wanted: without faults first, then of exactly the ratio, then of the largest module, then by
    the worst specific sliding.

    Raises DesignError, naming the key and what was rejected, where there is none.
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
                    abs(candidate.ratio / wanted.ratio - 1.0) > ROUNDING,
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
    """All teeth and distances that are looked at."""
    low, high = wanted.helix
    helices = sorted({low, high, *map(float, range(math.ceil(low), math.floor(high) + 1))})
    for module in MODULES if wanted.module is None else (wanted.module,):
        for helix in helices:
            transverse = module / math.cos(math.radians(helix))
            for ring in _ring_teeth(wanted, module, transverse):
                yield from _with_ring(wanted, module, helix, ring)


def _ring_teeth(wanted: WantedSet, module: float, transverse: float) -> range:
    """Teeth of rings of about the outside diameter, or about the centre distance."""
    least, most = wanted.ring_per_sun
    if wanted.outside_diameter is not None:
        # the root is a dedendum outside the reference circle, but for the profile shift
        radii = [0.5 * wanted.outside_diameter - (DEDENDUM + rim) * module for rim in RIMS[::-1]]
        ends = [
            2.0 * (radius + side * REACH * module) / transverse for radius, side in zip(radii, (-1, 1), strict=True)
        ]
    else:
        assert wanted.center_distance is not None
        # twice the distance is about a quarter of the teeth of ring and sun together, on either side
        sums = [4.0 * wanted.center_distance / transverse + 2.0 * side * (RING_SHIFTS + LESS[1]) for side in (-1, 1)]
        ends = [sums[0] / (1.0 + 1.0 / least), sums[1] / (1.0 + 1.0 / most)]
    top = math.floor(max(ends)) if wanted.module is not None else min(math.floor(max(ends)), MOST_TEETH)
    return range(max(3 * FEWEST, math.ceil(min(ends))), top + 1)


def _with_ring(wanted: WantedSet, module: float, helix: float, ring: int) -> Iterator[SetTrial]:
    least, most = wanted.ring_per_sun
    for sun in range(max(FEWEST, math.ceil(ring / most - ROUNDING)), math.floor(ring / least + ROUNDING) + 1):
        for less in range(LESS[0], LESS[1] + 1):
            planet, odd = divmod(ring - sun - less, 2)
            if odd or planet < FEWEST:
                continue
            teeth = sun, planet, ring
            for distance in _distances(wanted, module, helix, teeth):
                yield SetTrial(teeth, module, helix, distance)


def _distances(wanted: WantedSet, module: float, helix: float, teeth: tuple[int, int, int]) -> list[float]:
    """Centre distances (mm): the one that is given, or those of either mesh without shift, and the middle of both."""
    if wanted.center_distance is not None:
        return [wanted.center_distance]
    sun, planet, ring = teeth
    first, second = (0.5 * total * module / math.cos(math.radians(helix)) for total in (sun + planet, ring - planet))
    return sorted({round(distance, DECIMALS) for distance in (first, 0.5 * (first + second), second)})


def _judge(wanted: WantedSet, trial: SetTrial) -> SetCandidate:
    """A set with its shifts shared. Raises _Rejection for one that cannot exist, or is not as wanted."""
    angles = _angles(wanted, trial)
    totals = _sums_of_shifts(wanted, trial)
    try:
        pair = share_shifts(_pair_keys(wanted, trial))
        outside = _outside(wanted, trial, totals[1] - totals[0] + pair["pinion"]["profile_shift"])
        keys = _keys(wanted, trial, pair, angles, outside.rim)
        both = meshes(PlanetaryDesign(**keys))
        inner, outer = mesh_merit(both.inner), mesh_merit(both.outer)
    except DesignError as failure:
        raise _Rejection("teeth that cannot be made", str(failure)) from failure
    first, second = proportions(both.inner), proportions(both.outer)
    apart = _apart(angles, trial.distance, first.tips[1])
    if apart <= 0.0:
        raise _Rejection("neighbouring planets touch", f"their tips overlap by {-apart:.4g} mm")
    clearance = _least_clearance(first, second) / trial.module
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
            *(f"{INNER}: {fault}" for fault in inner.faults),
            *(f"{OUTER}: {fault}" for fault in outer.faults),
            *_set_faults(second, apart / trial.module, clearance),
        ),
    )


def _sums_of_shifts(wanted: WantedSet, trial: SetTrial) -> tuple[float, float]:
    """Sums of the shifts of sun and planet, and of planet and ring; rejects a distance at which either is too much."""
    alpha, beta = math.radians(wanted.pressure_angle), math.radians(trial.helix_angle)
    sun, planet = (Toothing(teeth, trial.module, alpha, beta) for teeth in trial.teeth[:2])
    ring = Toothing(trial.teeth[2], trial.module, alpha, beta, internal=True)
    totals = sum_of_shifts(sun, planet, trial.distance), sum_of_shifts(planet, ring, trial.distance)
    limits = wanted.shifts, (-RING_SHIFTS, RING_SHIFTS)
    for name, total, (low, high) in zip((INNER, OUTER), totals, limits, strict=True):
        if not low - ROUNDING <= total <= high + ROUNDING:
            said = "no working pressure angle" if math.isnan(total) else f"they add up to {total:.4g}"
            raise _Rejection(f"profile shifts of {name} outside {low:g} to {high:g}", said)
    return totals


def _angles(wanted: WantedSet, trial: SetTrial) -> list[float]:
    """Angles of the planets (deg): equally spaced, or the nearest at which they can be assembled, where that is admitted."""
    total, count = trial.teeth[0] + trial.teeth[2], wanted.planets
    if total % count and not wanted.unequal:
        raise _Rejection(UNEQUAL, f"{total} teeth of sun and ring, {count} planets")
    return [360.0 * round(k * total / count) / total for k in range(count)]


def _pair_keys(wanted: WantedSet, trial: SetTrial) -> dict[str, Any]:
    """Sun and planet as a pair whose shifts are still to be shared."""
    width = WIDTH * trial.module if wanted.face_width is None else wanted.face_width
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
    """Keys of the set's design, from those of sun and planet."""
    equal = (trial.teeth[0] + trial.teeth[2]) % wanted.planets == 0
    return {
        "kind": PlanetaryDesign.own_kind,
        **{key: value for key, value in pair.items() if key not in ("kind", "pinion", "gear", "assembly")},
        "planets": wanted.planets,
        **({} if wanted.fixed == RING else {"fixed": wanted.fixed}),
        SUN: pair["pinion"],
        PLANET: pair["gear"],
        RING: {**pair["gear"], "teeth": trial.teeth[2], **({} if rim is None else {"rim": rim})},
        "assembly": {**pair["assembly"], **({} if equal else {"planet_angles": ", ".join(map(repr, angles))})},
    }


def _apart(angles: list[float], distance: float, tip: float) -> float:
    """Least clearance (mm) of the tips of neighbouring planets; infinite of a single one."""
    steps = [(after - before) % 360.0 for before, after in zip(angles, [*angles[1:], angles[0]], strict=True)]
    if len(angles) < 2:
        return math.inf
    return 2.0 * distance * math.sin(math.radians(min(*steps, *(360.0 - step for step in steps))) / 2.0) - 2.0 * tip


@dataclass(frozen=True)
class _Outside:
    """The outside of a ring: its diameter and the rim that makes it (mm), None for the default."""

    diameter: float
    rim: float | None


def _outside(wanted: WantedSet, trial: SetTrial, shift: float) -> _Outside:
    """The outside of a ring with a profile shift. Rejects an outside diameter that leaves too little or too much rim."""
    module, beta = trial.module, math.radians(trial.helix_angle)
    ring = Toothing(trial.teeth[2], module, math.radians(wanted.pressure_angle), beta, internal=True)
    root = ring.radius_at((shift - DEDENDUM) * module)
    if wanted.outside_diameter is None:
        return _Outside(2.0 * (root + RIM * module), None)
    rim = 0.5 * wanted.outside_diameter - root
    for share, side, word in zip(RIMS, (-1.0, 1.0), ("thinner", "thicker"), strict=True):
        if side * (rim - share * module) > ROUNDING:
            raise _Rejection(f"rim {word} than {share:g} modules", f"{rim:.4g} mm")
    rim = round(rim, RIM_DECIMALS)
    return _Outside(2.0 * (root + rim), rim)


def _least_clearance(first: PairProportions, second: PairProportions) -> float:
    """Least clearance of any tip and the mating root, mm."""
    return min(geometry.clearance(k) for geometry in (first, second) for k in (0, 1))


def _set_faults(outer: PairProportions, apart: float, clearance: float) -> tuple[str, ...]:
    faults = {
        f"{OUTER}: cutter trims the tips": bool(trimming_warnings(outer.gears)),
        f"planets closer than {APART:g} modules": apart < APART,
        f"tip to root below {CLEARANCE:g} modules": clearance < CLEARANCE,
    }
    return tuple(fault for fault, there in faults.items() if there)


def _nothing(wanted: WantedSet, search: SetSearch) -> str:
    """What to say where no set is as wanted: how many were rejected and why."""
    if not search.rejections:
        sizes = "" if wanted.module is None else f" of module {wanted.module:g} mm"
        return (
            f"no numbers of teeth{sizes} have this ratio within {100.0 * wanted.tolerance:g} % in this size; "
            "choose a wider tolerance, or another module or size"
        )
    reasons = "; ".join(f"{count} {reason}" for reason, count in search.reasons.items())
    more = "; admit unequal spacing" if UNEQUAL in search.reasons else ""
    return f"none of {len(search.rejections)} sets can be used: {reasons}{more}"
