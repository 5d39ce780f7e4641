"""Deviations over one flank as they are evaluated and drawn: a map, a profile trace and a helix trace."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.metrology.evaluation import EvaluatedTrace, evaluate_trace, helix_sign, in_transverse_plane
from gearmesh.metrology.measured_teeth import FlankDeviations, InvoluteFlank
from gearmesh.metrology.second_order import SecondOrder, flank_coordinates, second_order, spiral_angle_error
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: points of the map across and along the flank, of a trace, and shares by which roll lengths are found
MAP, TRACE, DENSE = (13, 25), 241, 401
#: part of the range of evaluation that need not be measured
ROOM = 1e-6


@dataclass(frozen=True)
class DeviationMap:
    """Deviations (I, J), mm, at points (I, J, 3) of a nominal flank, own frame, from form point to tip and toe to heel; NaN where
    nothing was measured."""

    points: Array
    normals: Array
    deviations: Array

    @staticmethod
    def of(tooth: Tooth, side: Side, measured: FlankDeviations) -> DeviationMap:
        """Over the part of the flank that was measured."""
        s, t = (np.linspace(*ends, count) for ends, count in zip(measured.extent, MAP, strict=True))
        grid = tooth.flank_grid(side, s, t)
        return DeviationMap(grid.points, grid.normals, measured.at(s[:, None], t[None, :]))

    @property
    def order(self) -> SecondOrder:
        """To second order."""
        return second_order(*flank_coordinates(self.points), self.deviations)

    def spiral_error(self, order: SecondOrder, joint: Joint) -> float:
        """Error of the spiral angle, rad, of a member with a joint."""
        return spiral_angle_error(self.points, self.normals, order.lengthwise_angle, joint)


@dataclass(frozen=True)
class MeasuredTrace:
    """A trace: positions and deviations (N,), mm, in the transverse plane, what they are evaluated to, and the sign with which
    its rise counts."""

    positions: Array
    deviations: Array
    trace: EvaluatedTrace
    sign: int = 1

    @property
    def missing_share(self) -> float:
        """Part of the range of evaluation that was not measured."""
        known = self.positions[np.isfinite(self.deviations)]
        low, high = sorted(self.trace.range.evaluated)
        short = max(known.min() - low, 0.0) + max(high - known.max(), 0.0)
        return float(short / (high - low)) if short > ROOM * (high - low) else 0.0


def profile_trace(tooth: Tooth, side: Side, measured: FlankDeviations, basis: InvoluteFlank) -> MeasuredTrace:
    """In the middle of the face, at even roll lengths from form point to tip and at the ends of the range of evaluation."""
    s = _shares(tooth, side, basis, _even(_form_lengths(tooth, side, basis), basis.profile.evaluated))
    lengths = basis.roll_length(_radii(tooth, side, s))
    deviations = in_transverse_plane(measured.at(s, np.full_like(s, 0.5)), basis.base_helix)
    return MeasuredTrace(lengths, deviations, evaluate_trace(lengths, deviations, basis.profile))


def helix_trace(tooth: Tooth, side: Side, measured: FlankDeviations, basis: InvoluteFlank) -> MeasuredTrace:
    """In the middle of the profile's range of evaluation, at even places along the face and at the ends of their range."""
    s = float(_shares(tooth, side, basis, np.array([0.5 * sum(basis.profile.evaluated)]))[0])
    toe, heel = tooth.flank_grid(side, [s], [0.0, 1.0]).points[0, :, 2]
    t = (_even((toe, heel), basis.helix_trace.evaluated) - toe) / (heel - toe)
    z = tooth.flank_grid(side, [s], t).points[0, :, 2]
    deviations = in_transverse_plane(measured.at(np.full_like(t, s), t), basis.base_helix)
    sign = helix_sign(side.sign, basis.helix)
    return MeasuredTrace(z, deviations, evaluate_trace(z, deviations, basis.helix_trace), sign)


def _even(ends: tuple[float, float], evaluated: tuple[float, float]) -> Array:
    """Places (N,) from one end to the other, even over a range between them, and beside it."""
    low, high = sorted(ends)
    breaks = [low, *sorted(place for place in evaluated if low < place < high), high]
    counts = [max(2, round(TRACE * (last - first) / (high - low))) for first, last in pairwise(breaks)]
    parts = [np.linspace(*both, count)[:-1] for both, count in zip(pairwise(breaks), counts, strict=True)]
    places = np.append(np.concatenate(parts), high)
    return places if ends[0] < ends[1] else places[::-1]


def _form_lengths(tooth: Tooth, side: Side, basis: InvoluteFlank) -> tuple[float, float]:
    """Roll lengths (mm) of form point and tip."""
    first, last = basis.roll_length(_radii(tooth, side, np.array([0.0, 1.0])))
    return float(first), float(last)


def _shares(tooth: Tooth, side: Side, basis: InvoluteFlank, lengths: Array) -> Array:
    """Shares (N,) of the flank at roll lengths (N,), mm."""
    dense = np.linspace(0.0, 1.0, DENSE)
    rolls = basis.roll_length(_radii(tooth, side, dense))
    sense = float(np.sign(rolls[-1] - rolls[0]))
    s = np.interp(sense * lengths, sense * rolls, dense)
    # what the straight line between two of them leaves
    rest = lengths - basis.roll_length(_radii(tooth, side, s))
    return np.clip(s + rest / np.interp(s, dense, np.gradient(rolls, dense)), 0.0, 1.0)


def _radii(tooth: Tooth, side: Side, s: Array) -> Array:
    """Radii (N,), mm, of the flank at shares s (N,), in the middle of the face."""
    points = tooth.flank_grid(side, s, [0.5]).points[:, 0]
    return np.hypot(points[:, 0], points[:, 1])
