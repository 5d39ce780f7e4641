"""Pitch deviations of a gear's teeth, and its runout [ISO 1328-1:2013].

Teeth are counted as angles grow; deviations are arcs of the reference or tolerance circle in the transverse plane, mm, positive
the same way. The index deviation of a tooth is how far its flank is from its theoretical place, counted from any tooth;
its single pitch deviation f_pi is how much more than that of the tooth before.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array


@dataclass(frozen=True)
class PitchDeviations:
    """Those of the flanks of one side of all teeth: `index` (N,), mm, the mean of which does not count."""

    index: Array

    @staticmethod
    def of_index(values: ArrayLike) -> PitchDeviations:
        """Of index deviations (N,), mm. Raises DesignError for other than finite numbers of two teeth or more."""
        index = np.asarray(values, dtype=float)
        if index.ndim != 1 or index.size < 2 or not np.isfinite(index).all():
            raise ArgumentError("pitch", str(index.shape), allowed="a finite number for each tooth, of two or more")
        return PitchDeviations(index)

    @staticmethod
    def of_single(values: ArrayLike) -> PitchDeviations:
        """Of single pitch deviations (N,), mm, that of tooth k from tooth k - 1 to it; once round they are 0 by their mean."""
        single = PitchDeviations.of_index(values).index
        return PitchDeviations(np.cumsum(single - single.mean()))

    @property
    def single(self) -> Array:
        """Single pitch deviations f_pi (N,), from tooth k - 1 to tooth k."""
        return self.index - np.roll(self.index, 1)

    @property
    def single_pitch(self) -> float:
        """f_p, the largest amount of those."""
        return float(np.abs(self.single).max())

    @property
    def cumulative(self) -> float:
        """F_p, the greatest less the least index deviation."""
        return float(np.ptp(self.index))

    def sector(self, teeth: int) -> float:
        """F_pk, the largest amount of the deviation over a number of pitches."""
        return float(np.abs(np.roll(self.index, -teeth) - self.index).max())


@dataclass(frozen=True)
class BallInSpace:
    """A ball that touches both flanks of a space on the circle of the arcs: transverse pressure angle there, and half of the
    angle of the space about the axis, rad.

    Its normals at both flanks cross in its centre, each at alpha + space to the tangential direction there: flanks that together go
    by w further into the space, along the arcs, lift it by w cos(alpha) / (2 sin(alpha + space)).
    """

    pressure_angle: float
    space: float

    def heights(self, right: PitchDeviations, left: PitchDeviations) -> Array:
        """How far outwards (N,), mm, it comes to rest in the space before tooth k, between its right flank and the left one of the
        tooth before."""
        into = np.roll(left.index, 1) - right.index
        return np.asarray(into * np.cos(self.pressure_angle) / (2.0 * np.sin(self.pressure_angle + self.space)))

    def runout(self, right: PitchDeviations, left: PitchDeviations) -> float:
        """F_r, mm: the greatest less the least height in all spaces."""
        return float(np.ptp(self.heights(right, left)))

    def eccentricity(self, right: PitchDeviations, left: PitchDeviations) -> float:
        """Of the teeth to the axis, mm: the first harmonic of the heights."""
        heights = self.heights(right, left)
        turn = np.exp(-2j * np.pi * np.arange(heights.size) / heights.size)
        return float(2.0 * np.abs(np.mean(heights * turn)))
