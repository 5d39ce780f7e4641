"""Sizing of planetary sets: all sets with a given ratio and size, best first, and all rejected sets."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from gearmesh import __version__
from gearmesh.answers.result import columns
from gearmesh.answers.sizing import REQUEST_RANGES, DesignChoice, refuse_outside
from gearmesh.answers.tables import Listing
from gearmesh.arguments import checks_arguments
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, figure
from gearmesh.lengths import Length, in_mm
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.planetary.motion import DRIVING_MEMBER
from gearmesh.systems.cylindrical.planetary.sizing import SetCandidate, SetSearch, WantedSet, search_sets

#: smallest and largest value of each number of a request
SET_RANGES = {**REQUEST_RANGES, "outside_diameter": (1.0, 1e5), "planets": (1, 24)}
#: members that may be fixed
FIXED_MEMBERS = tuple(DRIVING_MEMBER)


@dataclass(frozen=True)
class SetFigures(Figures):
    """A planetary set that meets the request."""

    number: int = figure("number of the set, the best is 1", whole=True)
    module: float = figure("normal module", "mm", "m_n")
    teeth_sun: int = figure("number of teeth of the sun", symbol="z_s", whole=True)
    teeth_planet: int = figure("number of teeth of the planets", symbol="z_p", whole=True)
    teeth_ring: int = figure("number of teeth of the ring", symbol="z_r", whole=True)
    ratio: float = figure("ratio with the fixed member", symbol="i")
    helix_angle: float = figure("helix angle at the reference cylinder", "deg", "beta")
    center_distance: float = figure("centre distance", "mm", "a")
    outside_diameter: float = figure("outside diameter of the ring", "mm")
    profile_shift_sun: float = figure("profile shift coefficient of the sun", symbol="x_s")
    profile_shift_planet: float = figure("profile shift coefficient of the planets", symbol="x_p")
    profile_shift_ring: float = figure("profile shift coefficient of the ring", symbol="x_r")
    eps_alpha_sun: float = figure("transverse contact ratio of sun and planet", symbol="eps_alpha_s")
    eps_alpha_ring: float = figure("transverse contact ratio of planet and ring", symbol="eps_alpha_r")
    eps_beta: float = figure("overlap ratio", symbol="eps_beta")
    specific_sliding: float = figure("worst specific sliding of both meshes", symbol="zeta")
    tip_thickness: float = figure("least normal tooth thickness at a tip", "modules", "s_an")
    tip_clearance: float = figure("least clearance of a tip and the mating root", "modules", "c")
    planet_clearance: float | None = figure("least clearance of the tips of neighbouring planets", "mm", "c_p")
    planet_angles: list[float] = figure("angles of the planets about the sun", "deg", "psi")
    faults: list[str] = figure("faults of the set")


@dataclass(frozen=True)
class RejectedFigures(Figures):
    """A planetary set that was rejected."""

    module: float = figure("normal module", "mm", "m_n")
    teeth_sun: int = figure("number of teeth of the sun", symbol="z_s", whole=True)
    teeth_planet: int = figure("number of teeth of the planets", symbol="z_p", whole=True)
    teeth_ring: int = figure("number of teeth of the ring", symbol="z_r", whole=True)
    helix_angle: float = figure("helix angle at the reference cylinder", "deg", "beta")
    center_distance: float = figure("centre distance", "mm", "a")
    reason: str = figure("why the set was rejected")
    detail: str = figure("what is wrong with it in figures")


@dataclass(frozen=True, repr=False)
class PlanetarySizing(DesignChoice):
    """Sets that meet the request, numbered from 1.

    Sets without faults come first, then sets with exactly the ratio, then by largest module, then by worst specific
    sliding. A file with the suffix ".toml" is the first set's design; `design(number)` returns the design of any set.
    """

    wanted: WantedSet
    search: SetSearch

    @property
    def candidates(self) -> tuple[SetCandidate, ...]:
        return self.search.candidates

    @property
    def headline(self) -> str:
        best = self.candidates[0].trial
        teeth = "/".join(map(str, best.teeth))
        return f"{len(self.candidates)} sets; the first {teeth} teeth of module {best.module:g} mm"

    @property
    def rows(self) -> list[SetFigures]:
        """Figures of the sets, one row per set."""
        return [_row(number, candidate) for number, candidate in enumerate(self.candidates, start=1)]

    @property
    def rejections(self) -> list[RejectedFigures]:
        """Rejected sets, one row per set."""
        return [
            RejectedFigures(
                rejection.trial.module,
                *rejection.trial.teeth,
                rejection.trial.helix_angle,
                rejection.trial.distance,
                rejection.reason,
                rejection.detail,
            )
            for rejection in self.search.rejections
        ]

    @property
    def listings(self) -> list[Listing]:
        return self.first_sets(len(self.candidates))

    def first_sets(self, most: int) -> list[Listing]:
        """The first sets and the number of rejections by reason, as tables.

        Parameters
        ----------
        most : int
            Limit of the number of sets.

        Returns
        -------
        list of Listing
            Tables to print.

        Examples
        --------
        >>> len(gm.size_planetary(5.2, outside_diameter=150, module=2).first_sets(3)[0].rows)
        3
        """
        heads: tuple[str, ...] = (
            "",
            "m",
            "zs",
            "zp",
            "zr",
            "i",
            "a",
            "xs",
            "xp",
            "xr",
            "eps",
            "zeta",
            "s_an",
            "c_p",
            "",
        )
        rows: list[tuple[Any, ...]] = [_line(row) for row in self.rows[:most]]
        helices = {row.helix_angle for row in self.rows[:most]}
        if helices != {0.0}:
            heads = (*heads[:2], "beta", *heads[2:])
            rows = [(*line[:2], row.helix_angle, *line[2:]) for line, row in zip(rows, self.rows, strict=False)]
        if not any(line[-1] for line in rows):
            heads, rows = heads[:-1], [line[:-1] for line in rows]
        title = f"Sets 1 to {len(rows)} of {len(self.candidates)}"
        first = Listing(f"{title} (mm, deg; s_an in modules; eps, zeta, s_an: the worst)", heads, rows)
        counts = [(reason, count) for reason, count in self.search.reasons.items()]
        return [first, Listing(f"Rejected: {len(self.search.rejections)}", ("", ""), counts)] if counts else [first]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            "gearmesh": __version__,
            "wanted": asdict(self.wanted),
            "candidates": self.rows,
            "rejections": self.rejections,
            "rejections_by_reason": self.search.reasons,
        }

    @property
    def designs(self) -> tuple[Mapping[str, Any], ...]:
        return tuple(candidate.keys for candidate in self.candidates)


def _row(number: int, candidate: SetCandidate) -> SetFigures:
    return SetFigures(
        number,
        candidate.trial.module,
        *candidate.trial.teeth,
        candidate.ratio,
        candidate.trial.helix_angle,
        candidate.trial.distance,
        candidate.outside_diameter,
        *candidate.shifts,
        candidate.inner.eps_alpha,
        candidate.outer.eps_alpha,
        candidate.inner.eps_beta,
        candidate.sliding,
        candidate.tip,
        candidate.clearance,
        candidate.apart if math.isfinite(candidate.apart) else None,
        list(candidate.angles),
        list(candidate.faults),
    )


def _line(row: SetFigures) -> tuple[Any, ...]:
    """Return a set as a row of a table."""
    return (
        row.number,
        row.module,
        row.teeth_sun,
        row.teeth_planet,
        row.teeth_ring,
        round(row.ratio, 3),
        round(row.center_distance, 2),
        *(round(shift, 2) + 0.0 for shift in (row.profile_shift_sun, row.profile_shift_planet, row.profile_shift_ring)),
        round(min(row.eps_alpha_sun, row.eps_alpha_ring), 2),
        round(row.specific_sliding, 1) if math.isfinite(row.specific_sliding) else None,
        round(row.tip_thickness, 2),
        None if row.planet_clearance is None else round(row.planet_clearance, 1),
        ", ".join(row.faults),
    )


@checks_arguments
def size_planetary(
    ratio: float,
    *,
    outside_diameter: Length | None = None,
    center_distance: Length | None = None,
    module: Length | None = None,
    planets: int = WantedSet.planets,
    fixed: str = WantedSet.fixed,
    pressure_angle: float = WantedSet.pressure_angle,
    helix: tuple[float, float] = WantedSet.helix,
    shifts: tuple[float, float] = WantedSet.shifts,
    tolerance: float = WantedSet.tolerance,
    unequal: bool = False,
    face_width: Length | None = None,
) -> PlanetarySizing:
    """All planetary sets with a ratio and a given outside diameter of the ring, centre distance, or both.

    Parameters
    ----------
    ratio : float
        Ratio of the speeds, with the member `fixed` at rest.
    outside_diameter, center_distance, module : float or str, optional
        mm, or with a unit; without a module all modules of ISO 54 are tried.
    planets : int
        Number of planets.
    fixed : str
        Fixed member to which the ratio applies: "ring", "carrier" or "sun".
    pressure_angle : float
        Normal pressure angle, deg.
    helix, shifts : (float, float)
        Ranges of the helix angle, deg, and of the sum of profile shift coefficients of sun and planet.
    tolerance : float
        Relative tolerance of the ratio.
    unequal : bool
        Admit planets that cannot be equally spaced.
    face_width : float or str, optional
        mm, or with a unit.

    Returns
    -------
    PlanetarySizing
        Sets, best first, and the number of rejections by reason.

    Raises
    ------
    DesignError
        For an invalid request and if no set meets it; names key, value and what is allowed.

    Examples
    --------
    >>> sets = gm.size_planetary(5.2, outside_diameter=150, module=2)
    >>> sets.design(1).ring.teeth
    63
    """
    diameter, distance, size, width = (
        None if length is None else in_mm(name, length)
        for name, length in (
            ("outside_diameter", outside_diameter),
            ("center_distance", center_distance),
            ("module", module),
            ("face_width", face_width),
        )
    )
    wanted = WantedSet(
        ratio,
        diameter,
        distance,
        size,
        planets,
        fixed,
        pressure_angle,
        helix,
        shifts,
        tolerance,
        unequal,
        width,
    )
    _check(wanted)
    return PlanetarySizing(wanted, search_sets(wanted))


def _check(wanted: WantedSet) -> None:
    refuse_outside(wanted, SET_RANGES)
    if wanted.fixed not in FIXED_MEMBERS:
        raise ArgumentError("fixed", wanted.fixed, must_be=", ".join(FIXED_MEMBERS[:-1]) + f" or {FIXED_MEMBERS[-1]}")
    if wanted.outside_diameter is None and wanted.center_distance is None:
        raise ArgumentError(
            "outside_diameter", None, reason="missing; give the ring's outside diameter or the centre distance"
        )
    low, high = wanted.ratio * (1.0 - wanted.tolerance), wanted.ratio * (1.0 + wanted.tolerance)
    if wanted.fixed == "ring" and high <= 2.0:
        raise ArgumentError("ratio", wanted.ratio, must_be="above 2 with the ring fixed: 1 + z_ring / z_sun")
    if wanted.fixed == "sun" and not (low < 2.0 and high > 1.0):
        raise ArgumentError("ratio", wanted.ratio, must_be="between 1 and 2 with the sun fixed: 1 + z_sun / z_ring")
