"""Sizing: all pairs of cylindrical gears with a given ratio, module and centre distance, best first."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gearmesh import __version__
from gearmesh.answers.result import Result, columns
from gearmesh.answers.tables import Listing
from gearmesh.arguments import checks_arguments
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, figure
from gearmesh.formats import JSON_SUFFIX, TOML_SUFFIX
from gearmesh.lengths import Length, in_mm
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.sizing import Candidate, Wanted, candidates
from gearmesh.systems.designs import parse

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.planetary.sizing import WantedSet

#: smallest and largest value of each number of a request
REQUEST_RANGES = {
    "ratio": (1.0, 100.0),
    "center_distance": (0.1, 1e5),
    "module": (0.01, 100.0),
    "pressure_angle": (10.0, 35.0),
    "helix": (0.0, 45.0),
    "shifts": (-3.0, 5.0),
    "tolerance": (0.0, 0.2),
    "face_width": (0.01, 1e5),
}


@dataclass(frozen=True)
class CandidateFigures(Figures):
    """A pair of cylindrical gears that meets the request."""

    number: int = figure("number of the pair, the best is 1", whole=True)
    teeth_pinion: int = figure("number of teeth of the pinion", symbol="z_1", whole=True)
    teeth_gear: int = figure("number of teeth of the gear", symbol="z_2", whole=True)
    ratio: float = figure("gear ratio", symbol="u")
    helix_angle: float = figure("helix angle at the reference cylinder", "deg", "beta")
    profile_shift_pinion: float = figure("profile shift coefficient of the pinion", symbol="x_1")
    profile_shift_gear: float = figure("profile shift coefficient of the gear", symbol="x_2")
    eps_alpha: float = figure("transverse contact ratio", symbol="eps_alpha")
    eps_beta: float = figure("overlap ratio", symbol="eps_beta")
    specific_sliding_pinion: float = figure("worst specific sliding of the pinion", symbol="zeta_1")
    specific_sliding_gear: float = figure("worst specific sliding of the gear", symbol="zeta_2")
    tip_thickness_pinion: float = figure("normal tooth thickness at the pinion's tip", "modules", "s_an1")
    tip_thickness_gear: float = figure("normal tooth thickness at the gear's tip", "modules", "s_an2")
    undercut_reserve: float = figure("least reserve against undercut", "mm")
    interference_reserve: float = figure("least reserve against contact below the form diameter", "mm")
    faults: list[str] = figure("faults of the pair")


class DesignChoice(Result):
    """Designs that meet a request, numbered from 1, best first; a file with the suffix ".toml" is the first design."""

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, TOML_SUFFIX)

    @property
    @abstractmethod
    def designs(self) -> tuple[Mapping[str, Any], ...]:
        """Keys of the design files."""

    def design(self, number: int = 1) -> Design:
        """The design of a candidate.

        Parameters
        ----------
        number : int
            Number of the candidate, from 1.

        Returns
        -------
        Design
            As `parse` returns it.

        Raises
        ------
        DesignError
            For a number that does not exist.

        Examples
        --------
        >>> gm.size(2.5, 64, 2).design(1).kind
        'cylindrical'
        """
        return parse(self.keys(number))

    def keys(self, number: int = 1) -> Mapping[str, Any]:
        """The keys of a candidate's design file.

        Parameters
        ----------
        number : int
            Number of the candidate, from 1.

        Returns
        -------
        mapping of str to values
            As `toml` writes them.

        Raises
        ------
        DesignError
            For a number that does not exist.

        Examples
        --------
        >>> gm.size(2.5, 64, 2).keys()["kind"]
        'cylindrical'
        """
        if not 1 <= number <= len(self.designs):
            raise ArgumentError("choose", number, must_be=f"a number from 1 to {len(self.designs)}")
        return self.designs[number - 1]

    def _write(self, target: Path) -> None:
        from gearmesh.design.files import with_version
        from gearmesh.io.atomic import whole_text

        whole_text(target, with_version(self.keys()))


@dataclass(frozen=True, repr=False)
class Sizing(DesignChoice):
    """Pairs that meet the request, numbered from 1. Pairs without faults come first, then by worst specific sliding.

    A file with the suffix ".toml" is the first pair's design; `design(number)` returns the design of any pair.
    """

    wanted: Wanted
    candidates: tuple[Candidate, ...]

    @property
    def headline(self) -> str:
        return (
            f"{len(self.candidates)} pairs; the first {self.candidates[0].teeth[0]}/{self.candidates[0].teeth[1]} teeth"
        )

    @property
    def rows(self) -> list[CandidateFigures]:
        """Figures of the pairs, one row per pair."""
        return [
            CandidateFigures(
                number,
                *candidate.teeth,
                candidate.ratio,
                candidate.helix_angle,
                *candidate.shifts,
                candidate.eps_alpha,
                candidate.eps_beta,
                *candidate.sliding,
                *candidate.tips,
                candidate.undercut,
                candidate.interference,
                list(candidate.faults),
            )
            for number, candidate in enumerate(self.candidates, start=1)
        ]

    @property
    def listings(self) -> list[Listing]:
        return self.first_pairs(len(self.candidates))

    def first_pairs(self, most: int) -> list[Listing]:
        """The first pairs as a table.

        Parameters
        ----------
        most : int
            Limit of the number of pairs.

        Returns
        -------
        list of Listing
            Tables to print.

        Examples
        --------
        >>> len(gm.size(2.5, 64, 2).first_pairs(3)[0].rows)
        1
        """
        heads = ("", "z1", "z2", "beta", "x1", "x2", "eps_a", "eps_b", "zeta", "s_an", "")
        rows = [
            (
                number,
                *candidate.teeth,
                round(candidate.helix_angle, 3),
                *(round(shift, 4) + 0.0 for shift in candidate.shifts),
                round(candidate.eps_alpha, 3),
                round(candidate.eps_beta, 3),
                round(min(candidate.sliding), 2) if math.isfinite(min(candidate.sliding)) else None,
                round(min(candidate.tips), 3),
                ", ".join(candidate.faults),
            )
            for number, candidate in enumerate(self.candidates[:most], start=1)
        ]
        title = f"Pairs 1 to {len(rows)} of {len(self.candidates)}"
        return [Listing(f"{title} (beta in deg, s_an in modules; zeta, s_an: worse of both)", heads, rows)]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([row.row for row in self.rows])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {"gearmesh": __version__, "wanted": asdict(self.wanted), "candidates": self.rows}

    @property
    def designs(self) -> tuple[Mapping[str, Any], ...]:
        return tuple(candidate.keys for candidate in self.candidates)


@checks_arguments
def size(
    ratio: float,
    center_distance: Length,
    module: Length,
    *,
    internal: bool = False,
    pressure_angle: float = Wanted.pressure_angle,
    helix: tuple[float, float] = Wanted.helix,
    shifts: tuple[float, float] = Wanted.shifts,
    tolerance: float = Wanted.tolerance,
    face_width: Length | None = None,
) -> Sizing:
    """All pairs of cylindrical gears with a ratio z2 / z1, a centre distance and a normal module.

    Parameters
    ----------
    ratio : float
        z2 / z1.
    center_distance, module : float or str
        mm, or with a unit.
    internal : bool
        True if the gear is internal.
    pressure_angle : float
        Normal pressure angle, deg.
    helix : (float, float)
        Range of the helix angle, deg.
    shifts : (float, float)
        Range of the sum of profile shift coefficients x1 + x2.
    tolerance : float
        Relative tolerance of the ratio.
    face_width : float or str, optional
        mm, or with a unit; by default 10 modules.

    Returns
    -------
    Sizing
        Candidates, best first; `design(1)` is the design of the first.

    Raises
    ------
    DesignError
        For an invalid request and if no pair meets it; names key, value and what is allowed.

    Examples
    --------
    >>> pairs = gm.size(2.5, 64, 2)
    >>> pairs.design(1).pinion.teeth, pairs.design(1).gear.teeth
    (18, 45)
    """
    width = None if face_width is None else in_mm("face_width", face_width)
    distance, size = in_mm("center_distance", center_distance), in_mm("module", module)
    wanted = Wanted(ratio, distance, size, internal, pressure_angle, helix, shifts, tolerance, width)
    _check(wanted)
    return Sizing(wanted, tuple(candidates(wanted)))


def refuse_outside(wanted: Wanted | WantedSet, ranges: Mapping[str, tuple[float, float]]) -> None:
    """Raise ArgumentError for a number of a request that is outside its range."""
    for field in fields(wanted):
        value = getattr(wanted, field.name)
        if field.name not in ranges or value is None:
            continue
        low, high = ranges[field.name]
        for number in value if isinstance(value, tuple) else (value,):
            if not low <= number <= high:
                raise ArgumentError(field.name, number, must_be=f"from {low:g} to {high:g}")
        if isinstance(value, tuple) and value[0] > value[1]:
            both = f"{value[0]:g} to {value[1]:g}"
            raise ArgumentError(field.name, value, shown=both, reason="the first must not be above the second")


def _check(wanted: Wanted) -> None:
    refuse_outside(wanted, REQUEST_RANGES)
    if wanted.internal and wanted.ratio * (1.0 - wanted.tolerance) <= 1.0:
        raise ArgumentError(
            "ratio",
            wanted.ratio,
            reason=f"the ratio of an internal pair must be above 1 by more than the tolerance, {wanted.tolerance:g}",
        )
