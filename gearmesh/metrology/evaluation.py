"""Profile and helix traces evaluated as ISO 1328-1:2013 does: slope, form and total deviation, crowning.

Deviations are from the design profile or helix, which has the modifications that are wanted; in the transverse plane on the tangent
to the base cylinder, positive outside of the nominal material. What was measured along the normal is larger by 1 / cos(beta_b)
there. Positions are roll lengths, or places along the face.

    deviation        .--- excess: counts
     |        mean  /
     |      ___.--'/          |<------------- L ------------->|      evaluation range: least squares
     |_.--''___..-'        |<----------------------------------->|   design profile applies: excess material counts
     '--------------     |<---------------------------------------->| ends at which the mean line is read for the slope

    profile: L from the control diameter d_Cf on, 0.95 of the way to the tip form diameter; slope between d_Cf and the tip diameter
    helix: L is the face less the smaller of 5 % and one module at either end; slope between the ends of the face

Signs: the profile slope is positive where material rises to the tip, which is a smaller pressure angle; the helix slope is positive
where the amount of the helix angle is larger than nominal, and on spur gears where the helix is right-handed.
The standard itself was not at hand: the slope is read at the ends of the face and at d_Cf and d_a as its edition of 2013 has
it; that of 1995 read it at the ends of L (`TraceRange.over`). Values are evaluated as they are, without a filter.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array

#: share of the way from control to tip form diameter, of roll lengths, that is evaluated; share of the face beside either end
#: that is not
PROFILE_SHARE, HELIX_SHARE = 0.95, 0.05
#: points within the range without which there is no parabola
FEWEST = 3
#: part of the range by which what is beyond its ends still belongs to it
ROOM = 1e-9


@dataclass(frozen=True)
class TraceRange:
    """Where a trace is evaluated, each as positions (first, last), mm: the range of evaluation, that in which the design
    applies, and that at whose ends the slope is read. Of profiles the first is at the root, of helices at the least z."""

    evaluated: tuple[float, float]
    applies: tuple[float, float]
    slope: tuple[float, float]

    @property
    def length(self) -> float:
        """L_alpha or L_beta, mm."""
        return abs(self.evaluated[1] - self.evaluated[0])

    @property
    def over(self) -> TraceRange:
        """The same with the slope read at the ends of the range of evaluation."""
        return replace(self, slope=self.evaluated)


def profile_range(control: float, form: float, tip: float | None = None) -> TraceRange:
    """Of roll lengths (mm) at the profile control, tip form and tip diameters, the last by default the tip form diameter."""
    last = control + PROFILE_SHARE * (form - control)
    return TraceRange((control, last), (control, form), (control, form if tip is None else tip))


def helix_range(toe: float, heel: float, module: float) -> TraceRange:
    """Of a face between two places along the axis, normal module, mm."""
    low, high = sorted((toe, heel))
    less = min(HELIX_SHARE * (high - low), module)
    return TraceRange((low + less, high - less), (low, high), (low, high))


@dataclass(frozen=True)
class EvaluatedTrace:
    """A measured trace, evaluated: all in mm.

    `slope` (f_H), with the sign of its rise from first to last position; `form` (f_f), `total` (F); `crowning` of the
    least-squares parabola over the range of evaluation, positive where its middle is higher than its ends; `line`: mean line at
    both ends of the range of evaluation.
    """

    slope: float
    form: float
    total: float
    crowning: float
    line: tuple[float, float]
    range: TraceRange


def evaluate_trace(positions: ArrayLike, deviations: ArrayLike, trace_range: TraceRange) -> EvaluatedTrace:
    """Of deviations (N,), mm, at positions (N,), mm, in any order; those that are not finite are neglected.

    Raises DesignError where fewer than three different positions are left within the range.
    """
    x, d = np.asarray(positions, dtype=float), np.asarray(deviations, dtype=float)
    x, d = x[np.isfinite(d)], d[np.isfinite(d)]
    first, last = trace_range.evaluated
    share = (x - first) / (last - first)
    inside = (share >= -ROOM) & (share <= 1.0 + ROOM)
    if np.unique(share[inside]).size < FEWEST:
        raise ArgumentError(
            "trace",
            int(inside.sum()),
            reason=f"too few measured points between {min(first, last):.6g} and {max(first, last):.6g} mm",
            allowed=f"{FEWEST} or more at different places",
        )
    mean, parabola = (np.polynomial.Polynomial.fit(share[inside], d[inside], n, domain=[0.0, 1.0]) for n in (1, 2))
    rest = d - mean(share)
    begin, end = ((at - first) / (last - first) for at in trace_range.slope)
    # as a polynomial of -1..1: a + b w + c w^2
    return EvaluatedTrace(
        slope=float(mean(end) - mean(begin)),
        form=_spread(rest, x, inside, trace_range),
        total=_spread(d, x, inside, trace_range),
        crowning=-float(parabola.coef[2]),
        line=(float(mean(0.0)), float(mean(1.0))),
        range=trace_range,
    )


def _spread(d: Array, x: Array, inside: NDArray[np.bool_], trace_range: TraceRange) -> float:
    """Greatest less least value (mm) within the range of evaluation; beyond it, where the design applies, excess counts."""
    low, high = sorted(trace_range.applies)
    applies = inside | ((x >= low) & (x <= high))
    return float(d[applies].max() - d[inside].min())


def in_transverse_plane(deviations: ArrayLike, base_helix: float) -> Array:
    """Deviations along the normal as those on the tangent to the base cylinder; helix angle at that cylinder, rad."""
    return np.asarray(np.asarray(deviations, dtype=float) / np.cos(base_helix))


def helix_sign(flank_sign: int, helix: float) -> int:
    """Sign by which the rise of a helix trace, along z, is its slope deviation; +1 of right flanks, -1 of left ones.

    Material that rises along z leans a left flank (y > 0 of a tooth on +x) to the right-handed, a right one to the left-handed.
    """
    return -flank_sign if helix >= 0.0 else flank_sign
