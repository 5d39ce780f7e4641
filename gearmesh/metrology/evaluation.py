"""Evaluation of profile and helix traces by ISO 1328-1:2013: slope, form and total deviation, crowning.

Deviations are from the design profile or helix, including its intended modifications. They lie in the transverse plane
on the tangent to the base cylinder, and are positive outside of the nominal material. Deviations measured along the
normal are divided by cos(beta_b). Positions are roll lengths, or places along the face.

    deviation        .--- excess: counts
     |        mean  /
     |      ___.--'/          |<------------- L ------------->|      evaluation range: least squares
     |_.--''___..-'        |<----------------------------------->|   design profile applies: excess material counts
     '--------------     |<---------------------------------------->| ends at which the mean line is read for the slope

    profile: L from the control diameter d_Cf, 0.95 of the way to the tip form diameter; slope from d_Cf to tip diameter
    helix: L is the face less the smaller of 5 % and one module at either end; slope between the ends of the face

Signs: a positive profile slope means material that rises to the tip, and a smaller pressure angle. A positive helix
slope means a larger amount of the helix angle than nominal, or a right-handed helix on spur gears. The standard itself
was not at hand. The slope is read at the ends of the face and at d_Cf and d_a, as in its edition of 2013. The edition
of 1995 read it at the ends of L (`TraceRange.over`). Values are evaluated without a filter.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: evaluated share of the roll length from control to tip form diameter
PROFILE_SHARE = 0.95
#: share of the face beside either end that is not evaluated
HELIX_SHARE = 0.05
#: least number of points in the range that determine a parabola
MIN_TRACE_POINTS = 3
#: share of the range beyond its ends within which a point still belongs to it
RANGE_TOLERANCE = 1e-9


@dataclass(frozen=True)
class TraceRange:
    """Ranges of a trace, each as positions (first, last) in mm. A profile begins at the root, a helix at the least
    z."""

    #: evaluation range L
    evaluated: tuple[float, float]
    #: range in which the design trace applies
    applies: tuple[float, float]
    #: positions at which the slope is read
    slope: tuple[float, float]

    @property
    def length(self) -> float:
        """Evaluation length L_alpha or L_beta, mm."""
        return abs(self.evaluated[1] - self.evaluated[0])

    @property
    def over(self) -> TraceRange:
        """Same range, with the slope read at the ends of the evaluation range."""
        return replace(self, slope=self.evaluated)


def profile_range(control: float, form: float, tip: float | None = None) -> TraceRange:
    """Return the range of a profile from roll lengths (mm) at the profile control, tip form and tip diameters; the tip
    defaults to the tip form diameter."""
    last = control + PROFILE_SHARE * (form - control)
    return TraceRange((control, last), (control, form), (control, form if tip is None else tip))


def helix_range(toe: float, heel: float, module: float) -> TraceRange:
    """Return the range of a helix on a face from `toe` to `heel` (mm along the axis) for a normal module (mm)."""
    low, high = sorted((toe, heel))
    end_length = min(HELIX_SHARE * (high - low), module)
    return TraceRange((low + end_length, high - end_length), (low, high), (low, high))


@dataclass(frozen=True)
class EvaluatedTrace:
    """Figures of a measured trace, in mm."""

    #: slope deviation f_H: rise of the mean line from the first to the last position
    slope: float
    #: form deviation f_f
    form: float
    #: total deviation F
    total: float
    #: crowning of the least-squares parabola over the evaluation range; positive if its middle is higher than its ends
    crowning: float
    #: mean line at both ends of the evaluation range
    line: tuple[float, float]
    #: ranges in which the trace was evaluated
    range: TraceRange


def evaluate_trace(positions: ArrayLike, deviations: ArrayLike, trace_range: TraceRange) -> EvaluatedTrace:
    """Evaluate deviations (N,), mm, at positions (N,), mm, in any order; values that are not finite are ignored.

    Raises DesignError if fewer than three different positions are in the range.
    """
    x, d = np.asarray(positions, dtype=float), np.asarray(deviations, dtype=float)
    x, d = x[np.isfinite(d)], d[np.isfinite(d)]
    first, last = trace_range.evaluated
    share = (x - first) / (last - first)
    inside = (share >= -RANGE_TOLERANCE) & (share <= 1.0 + RANGE_TOLERANCE)
    if np.unique(share[inside]).size < MIN_TRACE_POINTS:
        raise ArgumentError(
            "trace",
            int(inside.sum()),
            reason=f"too few measured points between {min(first, last):.6g} and {max(first, last):.6g} mm",
            allowed=f"{MIN_TRACE_POINTS} or more at different places",
        )
    mean, parabola = (np.polynomial.Polynomial.fit(share[inside], d[inside], n, domain=[0.0, 1.0]) for n in (1, 2))
    form_deviation = d - mean(share)
    slope_begin, slope_end = ((at - first) / (last - first) for at in trace_range.slope)
    # coefficients are those of a polynomial in w from -1 to 1: a + b w + c w^2
    return EvaluatedTrace(
        slope=float(mean(slope_end) - mean(slope_begin)),
        form=_spread(form_deviation, x, inside, trace_range),
        total=_spread(d, x, inside, trace_range),
        crowning=-float(parabola.coef[2]),
        line=(float(mean(0.0)), float(mean(1.0))),
        range=trace_range,
    )


def _spread(d: Array, x: Array, inside: NDArray[np.bool_], trace_range: TraceRange) -> float:
    """Return the largest minus the least value (mm) in the evaluation range; where only the design applies, excess
    material counts too."""
    low, high = sorted(trace_range.applies)
    applies = inside | ((x >= low) & (x <= high))
    return float(d[applies].max() - d[inside].min())


def in_transverse_plane(deviations: ArrayLike, base_helix: float) -> Array:
    """Return deviations along the normal as deviations on the tangent to the base cylinder; `base_helix` is the helix
    angle there, rad."""
    return np.asarray(np.asarray(deviations, dtype=float) / np.cos(base_helix))


def helix_sign(flank_sign: int, helix: float) -> int:
    """Return the sign that turns the rise of a helix trace along z into a slope deviation.

    `flank_sign` is +1 for right and -1 for left flanks. The tooth is on +x. Material that rises along z makes a left
    flank (y > 0) lean towards a right-handed helix, and a right flank towards a left-handed helix.
    """
    return -flank_sign if helix >= 0.0 else flank_sign
