"""Pitch deviations of a gear's teeth, and its runout [ISO 1328-1:2013].

Teeth are counted as angles grow; deviations are arcs of the reference or tolerance circle in the transverse plane, mm, positive
the same way. The index deviation of a tooth is how far its flank is from its theoretical place, counted from any tooth;
its single pitch deviation f_pi is how much more than that of the tooth before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.micro_geometry.index_angles import IndexAngles
from gearmesh.teeth.region import Side


@dataclass(frozen=True)
class PitchDeviations:
    """Those of the flanks of one side of all teeth: `index` (N,), mm, the mean of which does not count."""

    index: Array

    @staticmethod
    def of_index(values: ArrayLike) -> PitchDeviations:
        """Of index deviations.

        Parameters
        ----------
        values : array_like
            Index deviations (N,), mm, one for each tooth.

        Returns
        -------
        PitchDeviations
            With these.

        Raises
        ------
        ArgumentError
            Where they are other than finite numbers of two teeth or more.

        Examples
        --------
        >>> round(gm.PitchDeviations.of_index([0.0, 0.004, 0.001]).cumulative, 6)
        0.004
        """
        index = np.asarray(values, dtype=float)
        if index.ndim != 1 or index.size < 2 or not np.isfinite(index).all():
            raise ArgumentError("pitch", str(index.shape), allowed="a finite number for each tooth, of two or more")
        return PitchDeviations(index)

    @staticmethod
    def of_single(values: ArrayLike) -> PitchDeviations:
        """Of single pitch deviations, the mean of which is taken off, so that they are 0 once round.

        Parameters
        ----------
        values : array_like
            Single pitch deviations (N,), mm, number k from tooth k - 1 to tooth k.

        Returns
        -------
        PitchDeviations
            With the index deviations that they add up to.

        Raises
        ------
        ArgumentError
            Where they are other than finite numbers of two teeth or more.

        Examples
        --------
        >>> round(gm.PitchDeviations.of_single([0.002, -0.001, -0.001]).single_pitch, 6)
        0.002
        """
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
        """F_pk, the largest amount of the deviation over a number of pitches.

        Parameters
        ----------
        teeth : int
            Number k of pitches.

        Returns
        -------
        float
            mm.

        Examples
        --------
        >>> round(gm.PitchDeviations.of_index([0.0, 0.004, 0.001, 0.0]).sector(2), 6)
        0.004
        """
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
        return np.asarray(into / self._into)

    @property
    def _into(self) -> float:
        """How far both flanks together go into the space for each mm that they lift the ball."""
        return float(2.0 * np.sin(self.pressure_angle + self.space) / np.cos(self.pressure_angle))

    def other_side(self, known: Side, pitch: PitchDeviations, heights: Array) -> PitchDeviations:
        """Of the side that was not measured, where the ball rests at heights (N,), mm, in the spaces; their mean does not count."""
        into = self._into * (heights - heights.mean())
        if known is Side.RIGHT:
            return PitchDeviations(np.roll(pitch.index + into, -1))
        return PitchDeviations(np.roll(pitch.index, 1) - into)

    def eccentric(self, size: float, phase: float, teeth: int) -> dict[Side, PitchDeviations]:
        """Of teeth that are off their axis by `size`, mm, in the direction `phase`, rad, counted as angles grow from the tooth on
        x; of first order.

        A flank whose normal leans by alpha from the direction in which angles grow is displaced by e (sin u + tan(alpha) cos u)
        along the circle, u the direction seen from the flank; of right flanks, whose normals point backwards, with the other sign.
        """
        sense = np.copysign(1.0, self.space)
        half = np.pi / teeth - abs(self.space)
        seen = phase - 2.0 * np.pi * np.arange(teeth) / teeth
        lean = sense * np.tan(self.pressure_angle)
        return {
            side: PitchDeviations(size * (np.sin(u) - side.sign * lean * np.cos(u)))
            for side in Side
            for u in [seen + side.sign * half]
        }

    def both_sides(self, heights: Array) -> dict[Side, PitchDeviations]:
        """Of both sides, where nothing but heights (N,), mm, of the ball was measured: their first harmonic is an eccentricity,
        what else there is are deviations of the spaces, half of them on either flank."""
        heights = heights - heights.mean()
        spaces = 2.0 * np.pi * (np.arange(heights.size) - 0.5) / heights.size
        first = 2.0 * np.mean(heights * np.exp(1j * spaces)) * np.copysign(1.0, self.space)
        off = self.eccentric(float(np.abs(first)), float(np.angle(first)), heights.size)
        rest = 0.5 * self._into * (heights - self.heights(off[Side.RIGHT], off[Side.LEFT]))
        return {
            Side.RIGHT: PitchDeviations(off[Side.RIGHT].index - rest),
            Side.LEFT: PitchDeviations(off[Side.LEFT].index + np.roll(rest, -1)),
        }

    def runout(self, right: PitchDeviations, left: PitchDeviations) -> float:
        """F_r, mm: the greatest less the least height in all spaces."""
        return float(np.ptp(self.heights(right, left)))

    def eccentricity(self, right: PitchDeviations, left: PitchDeviations) -> float:
        """Of the teeth to the axis, mm: the first harmonic of the heights."""
        heights = self.heights(right, left)
        turn = np.exp(-2j * np.pi * np.arange(heights.size) / heights.size)
        return float(2.0 * np.abs(np.mean(heights * turn)))


@dataclass(frozen=True)
class MeasuredPitch:
    """What was measured of the places of a gear's teeth: pitch deviations by `sides`, and `heights` (N,), mm, of a ball in the
    spaces, that before tooth 0 first."""

    sides: Mapping[Side, PitchDeviations] = field(default_factory=dict)
    heights: Array | None = None

    @property
    def runout(self) -> float | None:
        """F_r, mm, where it was measured by itself."""
        return None if self.heights is None else float(np.ptp(self.heights))

    def complete(self, ball: BallInSpace | None, key: str = "runout") -> Mapping[Side, PitchDeviations]:
        """Pitch deviations of both sides, those that were not measured by the ball; where there is no ball, those that were.

        Raises DesignError, naming the `key` of runout, where that needs a ball and none is known.
        """
        if self.heights is None or len(self.sides) == len(Side):
            return self.sides
        if ball is None:
            raise DesignError(
                key,
                reason="how a ball rests in its spaces is not known",
                allowed="pitch deviations of both sides; runout of cylindrical gears alone",
            )
        if not self.sides:
            return ball.both_sides(self.heights)
        ((side, known),) = self.sides.items()
        return {side: known, side.other: ball.other_side(side, known, self.heights)}


def index_angles(pitch: Mapping[Side, PitchDeviations], radius: float) -> IndexAngles:
    """Pitch deviations on a circle of that radius, mm, as angles; the mean of a side does not count."""
    return IndexAngles.of_sides({side: (own.index - own.index.mean()) / radius for side, own in pitch.items()})
