"""Pitch deviations of a gear's teeth, and its runout [ISO 1328-1:2013].

Teeth are numbered in the direction of increasing angle. Deviations are arcs of the reference or tolerance circle in the
transverse plane, mm, positive in the same direction. The index deviation of a tooth is the distance of its flank from
its theoretical place, counted from any tooth. The single pitch deviation f_pi of a tooth is its index deviation minus
the index deviation of the tooth before.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.micro_geometry.index_angles import IndexAngles
from gearmesh.teeth.region import Side


@dataclass(frozen=True)
class PitchDeviations:
    """Pitch deviations of the flanks on one side of all teeth: `index` (N,), mm, up to a constant."""

    index: Array

    @staticmethod
    def of_index(values: ArrayLike) -> PitchDeviations:
        """Return the pitch deviations with given index deviations.

        `values`: index deviations (N,), mm, one for each tooth. Raises ArgumentError for values that are not finite
        numbers of two or more teeth.
        """
        index = np.asarray(values, dtype=float)
        if index.ndim != 1 or index.size < 2 or not np.isfinite(index).all():
            raise ArgumentError("pitch", str(index.shape), allowed="a finite number for each tooth, of two or more")
        return PitchDeviations(index)

    @staticmethod
    def of_single(values: ArrayLike) -> PitchDeviations:
        """Return the pitch deviations with given single pitch deviations, less their mean.

        `values`: single pitch deviations (N,), mm, number k from tooth k - 1 to tooth k. Raises ArgumentError for
        values that are not finite numbers of two or more teeth.
        """
        single = PitchDeviations.of_index(values).index
        return PitchDeviations(np.cumsum(single - single.mean()))

    @property
    def single(self) -> Array:
        """Single pitch deviations f_pi (N,), mm, from tooth k - 1 to tooth k."""
        return self.index - np.roll(self.index, 1)

    @property
    def single_pitch(self) -> float:
        """Single pitch deviation f_p, mm: the largest amount of f_pi."""
        return float(np.abs(self.single).max())

    @property
    def cumulative(self) -> float:
        """Total cumulative pitch deviation F_p, mm: the largest minus the least index deviation."""
        return float(np.ptp(self.index))

    def sector(self, teeth: int) -> float:
        """Return F_pk, the largest amount of the deviation over a number of pitches.

        `teeth`: number k of pitches. Result: F_pk, mm.
        """
        return float(np.abs(np.roll(self.index, -teeth) - self.index).max())


@dataclass(frozen=True)
class BallInSpace:
    """A ball that touches both flanks of a space on the circle of the arcs.

    Its normals at both flanks intersect in its centre. Each has the angle phi = alpha + space to the tangent of the
    circle. Flanks that move by w_r and w_l further into the space, along the arcs, lift the ball by

        h = (w_r cos(alpha_r) cos(phi_l) + w_l cos(alpha_l) cos(phi_r)) / sin(phi_r + phi_l)

    Both flanks of symmetric teeth have the same angles. A ball touches asymmetric teeth on two circles; it is taken on the
    one circle.
    """

    #: transverse pressure angle alpha on the circle, rad; that of right flanks of asymmetric teeth
    pressure_angle: float
    #: half of the angle of the space about the axis, on the side of right flanks, rad; negative on internal teeth
    space: float
    #: both angles on the side of left flanks, if they differ
    left: tuple[float, float] | None = None

    def _angles(self, side: Side) -> tuple[float, float]:
        """Return pressure angle and half of the angle of the space on a side, rad."""
        own = self.pressure_angle, self.space
        return self.left if side is Side.LEFT and self.left is not None else own

    def _lift(self, side: Side) -> float:
        """Return the rise of the ball for each mm that the flank of a side moves into the space."""
        (alpha, space), (other, other_space) = self._angles(side), self._angles(side.other)
        turned = other + other_space
        return float(np.cos(alpha) * np.cos(turned) / np.sin(alpha + space + turned))

    def heights(self, right: PitchDeviations, left: PitchDeviations) -> Array:
        """Return the outward displacements (N,), mm, of the ball in the space before tooth k, between its right flank
        and the left flank of the tooth before."""
        return np.asarray(np.roll(left.index, 1) * self._lift(Side.LEFT) - right.index * self._lift(Side.RIGHT))

    def other_side(self, known: Side, pitch: PitchDeviations, heights: Array) -> PitchDeviations:
        """Return the pitch deviations of the side that was not measured.

        The measured side is `known`, with the deviations `pitch`, and the ball rests at `heights` (N,), mm, in the
        spaces; their mean has no effect.
        """
        on_right, on_left, risen = self._lift(Side.RIGHT), self._lift(Side.LEFT), heights - heights.mean()
        if known is Side.RIGHT:
            return PitchDeviations(np.roll((pitch.index * on_right + risen) / on_left, -1))
        return PitchDeviations((np.roll(pitch.index, 1) * on_left - risen) / on_right)

    def eccentric(self, size: float, phase: float, teeth: int) -> dict[Side, PitchDeviations]:
        """Return the pitch deviations of teeth whose axis is displaced by `size`, mm, in first order.

        `phase`, rad, is the direction of the displacement, counted like the teeth from the tooth on x.

        A left flank, whose normal is at alpha to the direction of increasing angle, moves by e (sin u + tan(alpha) cos
        u) along the circle. Here u is the direction of the displacement relative to the flank. A right flank, whose
        normal points the other way, moves by e (sin u - tan(alpha) cos u).
        """
        sense = np.copysign(1.0, self.space)
        directions = phase - 2.0 * np.pi * np.arange(teeth) / teeth
        found = {}
        for side in Side:
            alpha, space = self._angles(side)
            u = directions + side.sign * (np.pi / teeth - abs(space))
            found[side] = PitchDeviations(size * (np.sin(u) - side.sign * sense * np.tan(alpha) * np.cos(u)))
        return found

    def both_sides(self, heights: Array) -> dict[Side, PitchDeviations]:
        """Return the pitch deviations of both sides if only heights (N,), mm, of the ball were measured.

        Their first harmonic is taken as an eccentricity. The remaining part is taken as deviations of the spaces, half
        on either flank.
        """
        heights = heights - heights.mean()
        spaces = 2.0 * np.pi * (np.arange(heights.size) - 0.5) / heights.size
        harmonic = 2.0 * np.mean(heights * np.exp(1j * spaces)) * np.copysign(1.0, self.space)
        eccentric_pitch = self.eccentric(float(np.abs(harmonic)), float(np.angle(harmonic)), heights.size)
        rest = heights - self.heights(eccentric_pitch[Side.RIGHT], eccentric_pitch[Side.LEFT])
        half_narrowing = rest / (self._lift(Side.RIGHT) + self._lift(Side.LEFT))
        return {
            Side.RIGHT: PitchDeviations(eccentric_pitch[Side.RIGHT].index - half_narrowing),
            Side.LEFT: PitchDeviations(eccentric_pitch[Side.LEFT].index + np.roll(half_narrowing, -1)),
        }

    def runout(self, right: PitchDeviations, left: PitchDeviations) -> float:
        """Return the runout F_r, mm: the largest minus the least height in all spaces."""
        return float(np.ptp(self.heights(right, left)))

    def eccentricity(self, right: PitchDeviations, left: PitchDeviations) -> float:
        """Return the eccentricity of the teeth, mm: the first harmonic of the heights."""
        heights = self.heights(right, left)
        turn = np.exp(-2j * np.pi * np.arange(heights.size) / heights.size)
        return float(2.0 * np.abs(np.mean(heights * turn)))


@dataclass(frozen=True)
class MeasuredPitch:
    """Measured positions of a gear's teeth."""

    #: pitch deviations of the measured sides
    sides: Mapping[Side, PitchDeviations] = field(default_factory=dict)
    #: heights (N,), mm, of a ball in the spaces; the first space is before tooth 0
    heights: Array | None = None

    @property
    def runout(self) -> float | None:
        """Runout F_r, mm, if it was measured separately."""
        return None if self.heights is None else float(np.ptp(self.heights))

    def complete(self, ball: BallInSpace | None, key: str = "runout") -> Mapping[Side, PitchDeviations]:
        """Return the pitch deviations of both sides; a side that was not measured follows from the ball's heights.

        Without heights only the measured sides are returned. Raises DesignError, naming the `key` of runout, if heights
        were measured but no ball is known.
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
    """Return pitch deviations on a circle of a `radius`, mm, as angles; the mean of each side is subtracted."""
    return IndexAngles.of_sides(
        {side: (deviations.index - deviations.index.mean()) / radius for side, deviations in pitch.items()}
    )
