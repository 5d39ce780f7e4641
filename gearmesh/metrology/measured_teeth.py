r"""Measured data of a gear: deviations over its flanks, pitch deviations and runout, and the basis of their evaluation.

Deviations are functions of the place on the nominal flank:

    tip   s = 1 .-----------.
               /  deviation  \          along the outward normal, positive outside of the nominal material
    root  s = 0 '-----------'
              t = 0 toe   t = 1 heel
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import field
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
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: shares beyond the outermost points of a grid within which a place still lies on it
EDGE_TOLERANCE = 1e-9


class FlankDeviations(Protocol):
    """Deviations over a flank, as functions of the place."""

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """First and last measured share, from form point to tip and from toe to heel."""

    def at(self, s: Array, t: Array) -> Array:
        """Return deviations at places on the nominal flank.

        `s, t`: shares (...,) of the way from form point (0) to tip (1) and from toe (0) to heel (1). Result:
        deviations (...,), mm, > 0 outside of the nominal material; NaN where nothing was measured.
        """


@dataclass(frozen=True)
class GridDeviations:
    """Deviations on a grid of shares, bicubic between its points and NaN beyond them.

    Raises DesignError for a grid with fewer than 2 x 2 points, or shares that do not ascend.
    """

    #: shares (I,) from form point to tip
    s: Array
    #: shares (J,) from toe to heel
    t: Array
    #: deviations (I, J), mm
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
        """Return the grid from lists or arrays."""
        return GridDeviations(*(np.asarray(x, dtype=float) for x in (s, t, values)))

    @property
    def extent(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """First and last share of the grid, from form point to tip and from toe to heel."""
        return (float(self.s[0]), float(self.s[-1])), (float(self.t[0]), float(self.t[-1]))

    @cached_property
    def _spline(self) -> GridSpline:
        return GridSpline.through(self.s, self.t, self.values)

    def at(self, s: Array, t: Array) -> Array:
        """Return deviations (...,), mm, at shares (...,)."""
        s, t = broadcast_pair(s, t)
        inside = np.ones(s.shape, dtype=bool)
        for x, (first, last) in zip((s, t), self.extent, strict=True):
            inside &= (x >= first - EDGE_TOLERANCE) & (x <= last + EDGE_TOLERANCE)
        return np.where(inside, self._spline.jet(s, t).f, np.nan)


@dataclass(frozen=True)
class MeasuredTeeth:
    """Measured data of a gear, by sides of its teeth."""

    #: deviations over the flanks
    flanks: Mapping[Side, FlankDeviations] = field(default_factory=dict)
    #: pitch deviations of all teeth
    pitch: Mapping[Side, PitchDeviations] = field(default_factory=dict)
    #: runout F_r, mm, if it was measured separately
    runout: float | None = None


@dataclass(frozen=True)
class InvoluteFlank:
    """Dimensions of a cylindrical gear that its profile and helix traces are evaluated by."""

    #: radius of the base circle, mm
    base: float
    #: radius of the profile control circle, mm
    control: float
    #: radius of the tip form circle, mm
    form: float
    #: radius of the tip circle, mm
    tip: float
    #: helix angle at the reference cylinder, rad, positive right-handed
    helix: float
    #: helix angle at the base cylinder, rad, positive right-handed
    base_helix: float
    #: position of the toe along the axis, mm
    toe: float
    #: position of the heel along the axis, mm
    heel: float
    #: normal module, mm
    module: float

    def roll_length(self, radius: ArrayLike) -> Array:
        """Return roll lengths (...,), mm, at radii (...,)."""
        rho = np.asarray(radius, dtype=float)
        return np.asarray(np.sqrt(np.maximum(rho**2 - self.base**2, 0.0)))

    @property
    def profile(self) -> TraceRange:
        """Range of roll lengths in which profile traces are evaluated."""
        return profile_range(*(float(self.roll_length(radius)) for radius in (self.control, self.form, self.tip)))

    @property
    def helix_trace(self) -> TraceRange:
        """Range along the axis in which helix traces are evaluated."""
        return helix_range(self.toe, self.heel, self.module)


@dataclass(frozen=True)
class InspectionBasis:
    """Data that a gear is inspected by."""

    #: sizes from which its tolerances follow
    sizes: ToleranceSizes
    #: class that the design asks for
    asked: int
    #: its involute flank, if it has one; that of the right side of asymmetric teeth
    involute: InvoluteFlank | None = None
    #: involute flank of the left side of asymmetric teeth
    left_involute: InvoluteFlank | None = None
    #: ball by which runout follows from pitch deviations of both sides, if known
    ball: BallInSpace | None = None

    def involute_of(self, side: Side) -> InvoluteFlank | None:
        """Return the involute flank of a side, if the gear has one."""
        return self.left_involute if side is Side.LEFT and self.left_involute is not None else self.involute

    def eccentric(self, size: float, phase: float, teeth: int) -> dict[Side, PitchDeviations]:
        """Return pitch deviations of eccentric teeth, as `BallInSpace.eccentric`.

        Without a known ball, the flanks are taken in the middle of the tooth with pressure angle 0: both sides deviate
        equally.
        """
        ball = BallInSpace(0.0, math.pi / teeth) if self.ball is None else self.ball
        return ball.eccentric(size, phase, teeth)


def pitch_radius(tooth: Tooth, basis: InspectionBasis | None) -> float:
    """Return the radius (mm) of the circle on which pitch deviations are arcs.

    It is the circle of the tolerances, or the circle through the middle of the flanks of a gear without tolerances. For
    a rack it is the travel (mm) per rad.
    """
    if basis is not None:
        return 0.5 * basis.sizes.diameter
    middle = tooth.flank_grid(Side.RIGHT, [0.5], [0.5]).points[0, 0]
    return float(np.linalg.norm(tooth.joint.velocity(Rigid.identity(), middle)))
