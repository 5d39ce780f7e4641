"""Inspection of a measured gear: deviations by side, tolerance classes, and the figures that limit the gear's class."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

from gearmesh.answers.inspection.figures import (
    UM_PER_MM,
    ClassFigures,
    FlankInspectionFigures,
    FlankOrderFigures,
    InspectionFigures,
    PitchFigures,
    TraceFigures,
)
from gearmesh.answers.inspection.flank_map import DeviationMap, MeasuredTrace, helix_trace, profile_trace
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing, round_to
from gearmesh.deprecated import Deprecated
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Summary, flat
from gearmesh.metrology.measured_teeth import FlankDeviations, InspectionBasis, InvoluteFlank, MeasuredTeeth
from gearmesh.metrology.pitch import BallInSpace
from gearmesh.metrology.tolerances import GearClass, class_of
from gearmesh.records import dataclass
from gearmesh.systems.system import system_of
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: decimals of um and arc seconds in tables
TABLE_DECIMALS = 2


@dataclass(frozen=True, repr=False)
class Inspection(Result):
    """Measurements of a member, compared with the tolerances of its class."""

    #: the design
    design: Design
    #: the nominal member
    member: Member
    #: measurements of its teeth
    measured: MeasuredTeeth
    #: tolerances and ranges of evaluation; None for gears without tolerances
    _basis: InspectionBasis | None
    #: notes of the measurement, one line each
    notes: tuple[str, ...] = ()
    basis = Deprecated("_basis", "0.19.0", "`gear_class` and tolerance() have what follows from it")

    @cached_property
    def maps(self) -> dict[Side, DeviationMap]:
        """Deviations over the flanks that were measured."""
        return {side: DeviationMap.of(self.member.tooth, side, deviations) for side, deviations in self._flanks}

    @cached_property
    def profiles(self) -> dict[Side, MeasuredTrace]:
        """Profile traces; only for involute flanks."""
        return self._traces(profile_trace)

    @cached_property
    def helices(self) -> dict[Side, MeasuredTrace]:
        """Helix traces; only for involute flanks."""
        return self._traces(helix_trace)

    @property
    def _flanks(self) -> list[tuple[Side, FlankDeviations]]:
        return [(side, self.measured.flanks[side]) for side in Side if side in self.measured.flanks]

    def _traces(
        self, trace: Callable[[Tooth, Side, FlankDeviations, InvoluteFlank], MeasuredTrace]
    ) -> dict[Side, MeasuredTrace]:
        basis, tooth = self._basis, self.member.tooth
        if basis is None:
            return {}
        return {
            side: trace(tooth, side, deviations, involute)
            for side, deviations in self._flanks
            if (involute := basis.involute_of(side)) is not None
        }

    @property
    def runout(self) -> float | None:
        """Runout F_r, mm: as measured, else of a ball in the spaces if pitch deviations of both sides were measured."""
        if self.measured.runout is not None or self._ball is None:
            return self.measured.runout
        return self._ball.runout(*(self.measured.pitch[side] for side in Side))

    @property
    def eccentricity(self) -> float | None:
        """Eccentricity of the teeth to the axis, mm, if pitch deviations of both sides were measured."""
        return None if self._ball is None else self._ball.eccentricity(*(self.measured.pitch[side] for side in Side))

    @property
    def _ball(self) -> BallInSpace | None:
        known = all(side in self.measured.pitch for side in Side)
        return self._basis.ball if self._basis is not None and known else None

    @cached_property
    def deviations(self) -> dict[str, float]:
        """Deviations that may have tolerances, um, by their symbols; the larger amount of both sides."""
        by_symbol: dict[str, list[float]] = {}

        def add(symbol: str, value: float) -> None:
            by_symbol.setdefault(symbol, []).append(UM_PER_MM * value)

        for letter, traces in (("a", self.profiles), ("b", self.helices)):
            for measured_trace in traces.values():
                add(f"f_f{letter}", measured_trace.trace.form)
                add(f"f_H{letter}", measured_trace.sign * measured_trace.trace.slope)
                add(f"F_{letter}", measured_trace.trace.total)
        for pitch in self.measured.pitch.values():
            add("f_p", pitch.single_pitch)
            add("f_pt", pitch.single_pitch)
            add("F_p", pitch.cumulative)
        if self.runout is not None:
            add("F_r", self.runout)
        return {symbol: max(values, key=abs) for symbol, values in by_symbol.items()}

    @cached_property
    def gear_class(self) -> GearClass | None:
        """Classes of all figures; None without tolerances, and outside their range."""
        return None if self._basis is None else class_of(self._basis.sizes, self.deviations)

    def tolerance(self, symbol: str) -> float | None:
        r"""The tolerance of a deviation in the class that the design asks for.

        Parameters
        ----------
        symbol : str
            Symbol of the deviation, for example "F_p".

        Returns
        -------
        float or None
            um; None if there is no tolerance.

        Examples
        --------
        >>> with open("pitch.csv", "w") as file:
        ...     _ = file.write("tooth,right_um,left_um\n" + "".join(f"{k},{k % 3},{k % 2}\n" for k in range(18)))
        >>> gears.evaluate("pinion", pitch="pitch.csv").tolerance("F_p") is None
        False
        """
        if self._basis is None:
            return None
        return (self._basis.sizes.tolerances(self._basis.asked) or {}).get(f"{symbol}T")

    @property
    def headline(self) -> str:
        classes = self.gear_class
        if classes is None or not classes.deciding:
            return f"{self.member.name}: measured deviations, none of which has a tolerance"
        limits = ", ".join(classes.limiting)
        if classes.overall is None:
            return (
                f"{self.member.name}: coarser than class {classes_end(self._basis)} [{classes.standard}], by {limits}"
            )
        return f"{self.member.name}: class {classes.overall} [{classes.standard}], limited by {limits}"

    @property
    def complaints(self) -> list[str]:
        """Figures that exceed the class that the design asks for, one line each."""
        classes = self.gear_class
        if classes is None or self._basis is None:
            return []
        lines = []
        for figure_class in classes.deciding:
            limit = self.tolerance(figure_class.symbol)
            if limit is not None and (
                figure_class.tolerance_class is None or figure_class.tolerance_class > self._basis.asked
            ):
                lines.append(
                    f"{figure_class.symbol} ({figure_class.name}) is {figure_class.deviation:.4g} um; "
                    f"class {self._basis.asked} allows {limit:g} um"
                )
        return lines

    @property
    def warnings(self) -> tuple[str, ...]:
        """Notes of the measurement, and ranges of evaluation that were not measured completely, one line each."""
        lines = (
            f"the {what} trace of the {side} flank was measured over "
            f"{100.0 * (1.0 - measured_trace.missing_share):.0f} % of its range of evaluation: its "
            "form and total deviations are those of that part"
            for what, traces in (("profile", self.profiles), ("helix", self.helices))
            for side, measured_trace in traces.items()
            if measured_trace.missing_share
        )
        return (*self.notes, *lines)

    @cached_property
    def figures(self) -> InspectionFigures:
        """All figures."""
        classes, basis = self.gear_class, self._basis
        runout, eccentricity = (None if x is None else UM_PER_MM * x for x in (self.runout, self.eccentricity))
        return InspectionFigures(
            member=self.member.name,
            standard=None if basis is None else basis.sizes.standard,
            tolerance_class=None if classes is None else classes.overall,
            limited_by=[] if classes is None else list(classes.limiting),
            asked_class=None if basis is None else basis.asked,
            runout=runout,
            eccentricity=eccentricity,
            classes=[] if classes is None else [ClassFigures.of(figure_class) for figure_class in classes.figures],
            flanks={
                str(side): self._of_side(side) for side in Side if side in self.maps or side in self.measured.pitch
            },
        )

    def _of_side(self, side: Side) -> FlankInspectionFigures:
        order = self.maps[side].order if side in self.maps else None
        profile, helix, pitch = self.profiles.get(side), self.helices.get(side), self.measured.pitch.get(side)
        return FlankInspectionFigures(
            None
            if order is None
            else FlankOrderFigures.of(order, self.maps[side].spiral_error(order, self.member.tooth.joint)),
            None if profile is None else TraceFigures.of(profile.trace, profile.sign),
            None if helix is None else TraceFigures.of(helix.trace, helix.sign),
            None if pitch is None else PitchFigures.of(pitch),
        )

    @property
    def listings(self) -> list[Listing]:
        """Tables of the classes, and of the deviations of both sides next to each other."""
        tables = []
        classes = self.gear_class
        if classes is not None and classes.figures:
            rows = [
                (
                    entry.symbol,
                    entry.name,
                    round_to(entry.deviation, TABLE_DECIMALS),
                    entry.tolerance,
                    entry.tolerance_class,
                )
                for entry in classes.figures
            ]
            heads = ("", "", "um", "tolerance um", "class")
            tables.append(Listing(f"Tolerance classes of the {self.member.name} [{classes.standard}]", heads, rows))
        sides = list(self.figures.flanks)
        columns = [flat(self.figures.flanks[side].entries) for side in sides]
        shown = [
            key
            for key in dict.fromkeys(key for column in columns for key in column)
            if not key.endswith(LIST_KEY_ENDING)
        ]
        rows = [(key, *(_to_digits(column.get(key)) for column in columns)) for key in shown]
        tables.append(Listing(f"Deviations of the {self.member.name}", ("", *sides), rows))
        return tables

    def to_dict(self) -> dict[str, list[Any]]:
        r"""The classes of all figures.

        Returns
        -------
        dict of str to list
            One row per deviation.

        Examples
        --------
        >>> with open("pitch.csv", "w") as file:
        ...     _ = file.write("tooth,right_um,left_um\n" + "".join(f"{k},{k % 3},{k % 2}\n" for k in range(18)))
        >>> len(gears.evaluate("pinion", pitch="pitch.csv").to_dict()) > 0
        True
        """
        rows = [figure_class.row for figure_class in self.figures.classes]
        return {key: [row[key] for row in rows] for key in (rows[0] if rows else ())}

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), "warnings": self.warnings, **Summary(self.figures)}


#: ending of keys whose values are lists with one number per tooth
LIST_KEY_ENDING = "index_deviation_um"


def classes_end(basis: InspectionBasis | None) -> int:
    """Return the coarsest class of the standard."""
    return 0 if basis is None else basis.sizes.classes[1]


def _to_digits(value: Any) -> Any:
    return None if value is None else round_to(value, TABLE_DECIMALS)


def inspect(design: Design, train: GearTrain, name: str, measured: MeasuredTeeth) -> Inspection:
    """Return the inspection of the member `name` of a design, from measurements and its nominal gear set.

    Raises an error for an unknown member, for pitch deviations of another number of teeth, and for flanks with too few
    measured points.
    """
    if name not in train.members:
        raise ArgumentError("member", name, must_be=f"one of {', '.join(train.members)}")
    member = train.members[name]
    for side, pitch in measured.pitch.items():
        if pitch.index.size != member.tooth.teeth:
            raise ArgumentError(
                "pitch",
                pitch.index.size,
                reason=f"numbers of the {side} flanks",
                must_be=f"{member.tooth.teeth}, one a tooth",
            )
    basis = system_of(design).inspection
    return Inspection(design, member, measured, None if basis is None else basis(design, train, name))


def theoretical_involutes(inspection: Inspection) -> tuple[dict[Side, InvoluteFlank | None], str]:
    """Return the ranges of evaluation of the involutes of both sides, None where there are none, and the asked class in words."""
    basis = inspection._basis
    if basis is None:
        return dict.fromkeys(Side), ""
    return {side: basis.involute_of(side) for side in Side}, f"class {basis.asked} [{basis.sizes.standard}]"


def nominal_inspection(design: Design, train: GearTrain, name: str) -> Inspection:
    """Return the inspection of a member without measurements, for its tolerances. Raises the errors of `inspect`."""
    return inspect(design, train, name, MeasuredTeeth())
