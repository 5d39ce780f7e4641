"""Composite tests of gears with pitch deviations or runout: transmission error (single flank), centre distance
(double).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.turns import TurnsDetails, turns_listing, turns_warnings
from gearmesh.answers.inspection.figures import UM_PER_MM
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing, csv_text, figures
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.contact.fit.fit import centre_distance
from gearmesh.contact.fit.tight_mesh import TightMesh, tight_mesh
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.metrology.measured_teeth import MeasuredTeeth, pitch_radius
from gearmesh.metrology.pitch import index_angles
from gearmesh.progress import part
from gearmesh.records import dataclass
from gearmesh.systems.system import system_of
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member

#: share of the single-flank test in the work of both tests
SINGLE_FLANK_SHARE = 0.4


@dataclass(frozen=True)
class CompositeFigures(Figures):
    """Composite deviations of gears that roll together, over the turns after which the same teeth meet again."""

    pair: str = figure("members")
    turns_pinion: float = figure("turns of the pinion until the same teeth meet again")
    single_flank_te: float = figure("transmission error over whole turns, peak to peak", "arcsec")
    single_flank_total: float = figure(
        "total single-flank composite deviation, on the gear's reference circle", "um", "F_i'"
    )
    single_flank_tooth: float = figure("tooth-to-tooth single-flank composite deviation", "um", "f_i'")
    double_flank_total: float | None = figure("total double-flank composite deviation", "um", "F_i''", optional=True)
    double_flank_tooth: float | None = figure(
        "tooth-to-tooth double-flank composite deviation", "um", "f_i''", optional=True
    )
    tight_center_distance: float | None = figure(
        "centre distance without backlash, of teeth without deviations", "mm", "a''", optional=True
    )


@dataclass(frozen=True)
class TightPositions(Figures):
    """Gears that roll without backlash, at every position."""

    phi1: list[float] = figure("rotations of the pinion", "deg", "phi_1")
    center_distance: list[float] = figure("centre distance without backlash", "mm", "a''")

    @staticmethod
    def of(tight: TightMesh) -> TightPositions:
        return TightPositions(np.degrees(tight.phi1).round(10).tolist(), tight.distance.tolist())


@dataclass(frozen=True, repr=False)
class CompositeTest(Result):
    """Composite test of a pair with pitch deviations or eccentric members, over whole turns."""

    #: the design
    design: Design
    #: the pair
    pair: GearPair
    #: single-flank test, on the driving flanks
    single: FullTurns
    #: double-flank test, with the gears pressed together; None if the axes are not parallel, or an eccentric drives the pair
    double: TightMesh | None
    #: radius of the gear's reference circle, mm
    radius: float
    #: warnings of the gears, one line each
    notes: tuple[str, ...] = ()

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings of the gears and of the test, one line each."""
        return (*self.notes, *turns_warnings(self.pair, self.single))

    @cached_property
    def figures(self) -> CompositeFigures:
        """All figures."""
        double = self.double
        return CompositeFigures(
            pair=self.pair.name,
            turns_pinion=self.single.pitches / self.pair.pinion.tooth.teeth,
            single_flank_te=self.single.peak_to_peak / ARCSEC,
            single_flank_total=UM_PER_MM * self.radius * self.single.peak_to_peak,
            single_flank_tooth=UM_PER_MM * self.radius * self.single.tooth_to_tooth,
            double_flank_total=None if double is None else UM_PER_MM * double.total,
            double_flank_tooth=None if double is None else UM_PER_MM * double.tooth_to_tooth,
            tight_center_distance=None if double is None else double.nominal,
        )

    @property
    def headline(self) -> str:
        values = self.figures
        line = f"{values.pair}: F_i' {values.single_flank_total:.4g} um, f_i' {values.single_flank_tooth:.4g} um"
        if values.double_flank_total is None:
            return line
        return f"{line}; F_i'' {values.double_flank_total:.4g} um, f_i'' {values.double_flank_tooth:.4g} um"

    @property
    def listings(self) -> list[Listing]:
        return [figures(f"Composite deviations of {self.pair.name}", self.figures), turns_listing(self.single)]

    def to_dict(self) -> dict[str, list[Any]]:
        return TurnsDetails.of(self.single).positions.row

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.design),
            "warnings": self.warnings,
            **Summary(self.figures),
            "turns": TurnsDetails.of(self.single),
            **({} if self.double is None else {"tight_mesh": TightPositions.of(self.double)}),
        }

    def csv(self) -> str:
        """The single-flank test as a table.

        Returns
        -------
        str
            CSV, one row per position.

        Examples
        --------
        >>> len(gears.composite().csv().splitlines()) > 10
        True
        """
        return csv_text(TurnsDetails.of(self.single).positions.rows)

    def _write(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text

        whole_text(target, self.csv())


def composite_test(
    design: Design,
    train: GearTrain,
    measured: Mapping[str, MeasuredTeeth] | None = None,
    mesh: GearPair | None = None,
) -> CompositeTest:
    """Return the composite test of a `mesh`, by default the first mesh of a gear set, with the `measured` teeth of its
    members.

    `measured` is keyed by names of members; if it is empty, the pitch deviations of the design are used. Sides without
    pitch deviations are nominal, and the eccentricity of a member is its runout. Raises an error for

    - other members, and other numbers of teeth.
    - too many turns, and teeth that do not meet (NoSolutionError).
    """
    pair = train.pairs[0] if mesh is None else mesh
    given = measured or {}
    for name in given:
        if name not in pair.members:
            raise ArgumentError("member", name, must_be=f"one of {', '.join(pair.members)}")
    radii = {name: _radius(design, train, name) for name in pair.members}

    def at_places(member: Member) -> Member:
        if member.name not in given:
            return member
        return replace(member, index=index_angles(given[member.name].pitch, radii[member.name]))

    pair = replace(pair, pinion=at_places(pair.pinion), gear=at_places(pair.gear))
    # an eccentric that drives the pair fixes the distance: no test presses such members together
    parallel = centre_distance(pair) is not None and not pair.arm_turns
    with part(0.0, SINGLE_FLANK_SHARE if parallel else 1.0):
        single = whole_turns(pair)
    with part(SINGLE_FLANK_SHARE, 1.0):
        double = tight_mesh(pair) if parallel else None
    return CompositeTest(design, pair, single, double, radii[pair.gear.name], train.warnings)


def _radius(design: Design, train: GearTrain, name: str) -> float:
    """Return the radius (mm) of the circle on which pitch deviations of a member are measured."""
    inspection = system_of(design).inspection
    return pitch_radius(train.members[name].tooth, None if inspection is None else inspection(design, train, name))
