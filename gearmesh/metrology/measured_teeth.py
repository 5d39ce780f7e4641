"""What was measured of a gear: deviations over its flanks, pitch deviations, runout; and what these are evaluated by.

Whoever has deviations hands them over as functions of the place on the nominal flank:

    tip   s = 1 .-----------.
               /  deviation  \\          along the outward normal, positive outside of the nominal material
    root  s = 0 '-----------'
              t = 0 toe   t = 1 heel
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair
from gearmesh.kernel.numeric.grid_spline import GridSpline
from gearmesh.metrology.evaluation import TraceRange, helix_range, profile_range
from gearmesh.metrology.pitch import BallInSpace, PitchDeviations
from gearmesh.metrology.tolerances import ToleranceSizes
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: shares beyond the outermost points of a grid that still count as its own
EDGE = 1e-9


class FlankDeviations(Protocol):
    """Deviations over a flank."""

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """First and last share of what was measured, from form point to tip and from toe to heel."""

    def at(self, s: Array, t: Array) -> Array:
        """Deviations at places on the nominal flank.

        Parameters
        ----------
        s, t : ndarray
            Shares (...,) of the way from form point (0) to tip (1) and from toe (0) to heel (1).

        Returns
        -------
        ndarray
            Deviations (...,), mm, > 0 outside of the nominal material; NaN where nothing was measured.

        Examples
        --------
        >>> pinion = gm.build(gm.load("samples/hypoid_measured.toml")).evaluate("pinion")
        >>> deviations = pinion.measured.flanks[gm.Side.RIGHT]
        >>> bool(np.abs(deviations.at(np.array(0.5), np.array(0.5))) < 0.1)
        True
        """


@dataclass(frozen=True)
class GridDeviations:
    """Deviations (I, J), mm, at shares `s` (I,) from form point to tip and `t` (J,) from toe to heel; bicubic between them, nothing
    beyond them. Raises DesignError for what is no grid of 2 x 2 or more."""

    s: Array
    t: Array
    values: Array

    def __post_init__(self) -> None:
        ascending = all(np.ndim(x) == 1 and np.size(x) > 1 and (np.diff(x) > 0.0).all() for x in (self.s, self.t))
        if not ascending or self.values.shape != (self.s.size, self.t.size) or not np.isfinite(self.values).all():
            raise ArgumentError(
                "deviations",
                str(np.shape(self.values)),
                allowed="finite numbers, mm, a row for each of the ascending shares s, a column for each t",
            )

    @staticmethod
    def of(s: ArrayLike, t: ArrayLike, values: ArrayLike) -> GridDeviations:
        """Of lists or arrays."""
        return GridDeviations(*(np.asarray(x, dtype=float) for x in (s, t, values)))

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """First and last share of the grid, from form point to tip and from toe to heel."""
        return (float(self.s[0]), float(self.s[-1])), (float(self.t[0]), float(self.t[-1]))

    @cached_property
    def _spline(self) -> GridSpline:
        return GridSpline.through(self.s, self.t, self.values)

    def at(self, s: Array, t: Array) -> Array:
        """Deviations (...,), mm, at shares (...,)."""
        s, t = broadcast_pair(s, t)
        inside = np.ones(s.shape, dtype=bool)
        for x, (first, last) in zip((s, t), self.extent, strict=True):
            inside &= (x >= first - EDGE) & (x <= last + EDGE)
        return np.where(inside, self._spline.jet(s, t).f, np.nan)


@dataclass(frozen=True)
class MeasuredTeeth:
    """What was measured of a gear, by sides of its teeth; `runout` F_r, mm, where it was measured by itself."""

    flanks: Mapping[Side, FlankDeviations] = field(default_factory=dict)
    pitch: Mapping[Side, PitchDeviations] = field(default_factory=dict)
    runout: float | None = None


@dataclass(frozen=True)
class InvoluteFlank:
    """What traces of a cylindrical gear are evaluated by: radii (mm) of base circle, profile control circle, tip form circle and
    tip; helix angles (rad, positive right-handed) at reference and base cylinder; face from `toe` to `heel`, normal module, mm."""

    base: float
    control: float
    form: float
    tip: float
    helix: float
    base_helix: float
    toe: float
    heel: float
    module: float

    def roll_length(self, radius: ArrayLike) -> Array:
        """Roll lengths (...,), mm, at radii (...,)."""
        rho = np.asarray(radius, dtype=float)
        return np.asarray(np.sqrt(np.maximum(rho**2 - self.base**2, 0.0)))

    @property
    def profile(self) -> TraceRange:
        """Where profile traces are evaluated, roll lengths."""
        return profile_range(*(float(self.roll_length(radius)) for radius in (self.control, self.form, self.tip)))

    @property
    def helix_trace(self) -> TraceRange:
        """Where helix traces are evaluated, along the axis."""
        return helix_range(self.toe, self.heel, self.module)


@dataclass(frozen=True)
class InspectionBasis:
    """What a gear is inspected by: the `sizes` that its tolerances follow from, the class `asked` for, its involute flank where it
    has one, and the ball by which runout follows from pitch deviations of both sides."""

    sizes: ToleranceSizes
    asked: int
    involute: InvoluteFlank | None = None
    ball: BallInSpace | None = None

    def eccentric(self, size: float, phase: float, teeth: int) -> dict[Side, PitchDeviations]:
        """Pitch deviations of teeth off their axis, as of `BallInSpace`; of flanks of which no ball is known as of their middles
        across the space, alike on both sides."""
        ball = BallInSpace(0.0, math.pi / teeth) if self.ball is None else self.ball
        return ball.eccentric(size, phase, teeth)


def pitch_radius(tooth: Tooth, basis: InspectionBasis | None) -> float:
    """Radius (mm) of the circle on which pitch deviations are arcs: that of the tolerances, or, where a gear has none, through the
    middle of its flanks; of a rack its travel (mm) per rad."""
    if basis is not None:
        return 0.5 * basis.sizes.diameter
    middle = tooth.flank_grid(Side.RIGHT, [0.5], [0.5]).points[0, 0]
    return float(np.linalg.norm(tooth.joint.velocity(Rigid.identity(), middle)))
