"""Figures of an inspection."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearmesh.figures import Figures, figure
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.metrology.evaluation import EvaluatedTrace
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.metrology.second_order import SecondOrder
from gearmesh.metrology.tolerances import FigureClass
from gearmesh.records import dataclass

#: micrometres per millimetre
UM_PER_MM = 1e3


@dataclass(frozen=True)
class TraceFigures(Figures):
    """A profile or helix trace, evaluated [ISO 1328-1:2013]."""

    slope_deviation: float = figure("slope deviation of the mean line", "um", "f_H")
    form_deviation: float = figure("form deviation about the mean line", "um", "f_f")
    total_deviation: float = figure("total deviation", "um", "F")
    crowning: float = figure("crowning that the deviations add, of the least-squares parabola", "um", "C")
    evaluated_from: float = figure("first roll length, or place along the axis, of the range of evaluation", "mm")
    evaluated_to: float = figure("its last", "mm")

    @staticmethod
    def of(trace: EvaluatedTrace, sign: int = 1) -> TraceFigures:
        """Return the figures of a trace; `sign` is the sign of its rise."""
        return TraceFigures(
            UM_PER_MM * sign * trace.slope,
            UM_PER_MM * trace.form,
            UM_PER_MM * trace.total,
            UM_PER_MM * trace.crowning,
            *trace.range.evaluated,
        )


@dataclass(frozen=True)
class FlankOrderFigures(Figures):
    """Deviations of a flank to second order, over the grid that was measured."""

    thickness_deviation: float = figure("deviation along the normal in the middle of the flank", "um")
    pressure_angle_error: float = figure("pressure angle more than nominal", "arcsec")
    spiral_angle_error: float = figure("spiral or helix angle more than nominal", "arcsec")
    profile_crowning: float = figure("profile crowning more than nominal", "um")
    length_crowning: float = figure("lengthwise crowning more than nominal", "um")
    twist: float = figure("rise to the tip at the heel less that at the toe", "um")
    higher_order_rms: float = figure("root mean square of deviations of higher order", "um")
    higher_order_max: float = figure("largest deviation of higher order", "um")

    @staticmethod
    def of(order: SecondOrder, spiral: float) -> FlankOrderFigures:
        """Return the figures of deviations with an error of the spiral angle, rad."""
        return FlankOrderFigures(
            UM_PER_MM * order.thickness,
            order.profile_angle / ARCSEC,
            spiral / ARCSEC,
            UM_PER_MM * order.profile_crowning,
            UM_PER_MM * order.length_crowning,
            UM_PER_MM * order.twist,
            UM_PER_MM * order.rest,
            UM_PER_MM * order.largest,
        )


@dataclass(frozen=True)
class PitchFigures(Figures):
    """Pitch deviations of the flanks of one side."""

    single_pitch: float = figure("largest single pitch deviation", "um", "f_p")
    cumulative_pitch: float = figure("total cumulative pitch deviation", "um", "F_p")
    index_deviation: list[float] = figure("index deviation of each tooth, from their mean", "um", "F_pi")

    @staticmethod
    def of(pitch: PitchDeviations) -> PitchFigures:
        return PitchFigures(
            UM_PER_MM * pitch.single_pitch,
            UM_PER_MM * pitch.cumulative,
            (UM_PER_MM * (pitch.index - np.mean(pitch.index))).tolist(),
        )


@dataclass(frozen=True)
class FlankInspectionFigures(Figures):
    """Measurements of the flanks of one side."""

    second_order: FlankOrderFigures | None = figure("deviations to second order", optional=True)
    profile: TraceFigures | None = figure("profile trace in the middle of the face", optional=True)
    helix: TraceFigures | None = figure("helix trace in the middle of the profile", optional=True)
    pitch: PitchFigures | None = figure("pitch deviations", optional=True)


@dataclass(frozen=True)
class ClassFigures(Figures):
    """A deviation, the largest of both sides, and the finest tolerance class that it is within."""

    symbol: str = figure("symbol of the deviation")
    name: str = figure("what it is")
    deviation: float = figure("the deviation", "um")
    tolerance: float = figure("tolerance of its class; of the coarsest where it has none", "um")
    tolerance_class: int | None = figure("its class; none: coarser than any", whole=True)
    decides: bool = figure("whether it counts for the class of the gear")

    @staticmethod
    def of(figure_class: FigureClass) -> ClassFigures:
        return ClassFigures(
            figure_class.symbol,
            figure_class.name,
            figure_class.deviation,
            figure_class.tolerance,
            figure_class.tolerance_class,
            figure_class.decides,
        )


@dataclass(frozen=True)
class InspectionFigures(Figures):
    """A measured gear."""

    member: str = figure("name of the member")
    standard: str | None = figure("standard of the tolerances", optional=True)
    tolerance_class: int | None = figure(
        "tolerance class of the gear: that of its coarsest figure", "", "A", whole=True
    )
    limited_by: list[str] = figure("symbols of the figures that limit it")
    asked_class: int | None = figure("tolerance class that the design asks for", whole=True, optional=True)
    runout: float | None = figure("runout", "um", "F_r", optional=True)
    eccentricity: float | None = figure("eccentricity of the teeth to the axis", "um", "f_e", optional=True)
    classes: list[ClassFigures] = figure("classes of all figures")
    flanks: Mapping[str, FlankInspectionFigures] = figure("deviations of right and left flanks")
