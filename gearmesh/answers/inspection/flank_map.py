"""Deviations over one flank for evaluation and drawing: a map, a profile trace and a helix trace."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.metrology.evaluation import EvaluatedTrace, evaluate_trace, helix_sign, in_transverse_plane
from gearmesh.metrology.measured_teeth import FlankDeviations, InvoluteFlank
from gearmesh.metrology.second_order import SecondOrder, flank_coordinates, second_order, spiral_angle_error
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: points of the map across and along the flank
MAP_POINTS = (13, 25)
#: points of a trace
TRACE_POINTS = 241
#: shares of the flank between which roll lengths are interpolated
ROLL_LENGTH_POINTS = 401
#: part of the range of evaluation that may be missing
MAX_MISSING_SHARE = 1e-6


@dataclass(frozen=True)
class DeviationMap:
    """Deviations over a nominal flank, from form point to tip and from toe to heel."""

    #: points (I, J, 3) of the nominal flank, own frame, mm
    points: Array
    #: unit normals (I, J, 3)
    normals: Array
    #: deviations (I, J), mm; NaN where nothing was measured
    deviations: Array

    @staticmethod
    def of(tooth: Tooth, side: Side, measured: FlankDeviations) -> DeviationMap:
        """Return the map over the part of the flank that was measured."""
        s, t = (np.linspace(*ends, count) for ends, count in zip(measured.extent, MAP_POINTS, strict=True))
        grid = tooth.flank_grid(side, s, t)
        return DeviationMap(grid.points, grid.normals, measured.at(s[:, None], t[None, :]))

    @property
    def order(self) -> SecondOrder:
        """Deviations to second order."""
        return second_order(*flank_coordinates(self.points), self.deviations)

    def spiral_error(self, order: SecondOrder, joint: Joint) -> float:
        """Error of the spiral angle, rad, of a member with a joint."""
        return spiral_angle_error(self.points, self.normals, order.lengthwise_angle, joint)


@dataclass(frozen=True)
class MeasuredTrace:
    """Profile or helix trace of a measured flank."""

    #: positions (N,), mm
    positions: Array
    #: deviations (N,), mm, in the transverse plane
    deviations: Array
    #: the evaluated trace
    trace: EvaluatedTrace
    #: sign of the rise of the trace
    sign: int = 1

    @property
    def missing_share(self) -> float:
        """Part of the range of evaluation that was not measured."""
        known = self.positions[np.isfinite(self.deviations)]
        low, high = sorted(self.trace.range.evaluated)
        short = max(known.min() - low, 0.0) + max(high - known.max(), 0.0)
        return float(short / (high - low)) if short > MAX_MISSING_SHARE * (high - low) else 0.0


def profile_trace(tooth: Tooth, side: Side, measured: FlankDeviations, basis: InvoluteFlank) -> MeasuredTrace:
    """Return the profile trace in the middle of the face.

    Its roll lengths are equally spaced from form point to tip, with the ends of the range of evaluation added.
    """
    s = _shares(tooth, side, basis, _even(_form_lengths(tooth, side, basis), basis.profile.evaluated))
    lengths = basis.roll_length(_radii(tooth, side, s))
    deviations = in_transverse_plane(measured.at(s, np.full_like(s, 0.5)), basis.base_helix)
    return MeasuredTrace(lengths, deviations, evaluate_trace(lengths, deviations, basis.profile))


def helix_trace(tooth: Tooth, side: Side, measured: FlankDeviations, basis: InvoluteFlank) -> MeasuredTrace:
    """Return the helix trace in the middle of the profile's range of evaluation.

    Its positions along the face are equally spaced, with the ends of the range of evaluation added.
    """
    s = float(_shares(tooth, side, basis, np.array([0.5 * sum(basis.profile.evaluated)]))[0])
    toe, heel = tooth.flank_grid(side, [s], [0.0, 1.0]).points[0, :, 2]
    t = (_even((toe, heel), basis.helix_trace.evaluated) - toe) / (heel - toe)
    z = tooth.flank_grid(side, [s], t).points[0, :, 2]
    deviations = in_transverse_plane(measured.at(np.full_like(t, s), t), basis.base_helix)
    sign = helix_sign(side.sign, basis.helix)
    return MeasuredTrace(z, deviations, evaluate_trace(z, deviations, basis.helix_trace), sign)


def _even(ends: tuple[float, float], evaluated: tuple[float, float]) -> Array:
    """Return places (N,) from one end to the other, equally spaced inside the evaluated range and outside it."""
    low, high = sorted(ends)
    breaks = [low, *sorted(place for place in evaluated if low < place < high), high]
    counts = [max(2, round(TRACE_POINTS * (last - first) / (high - low))) for first, last in pairwise(breaks)]
    parts = [np.linspace(*part_ends, count)[:-1] for part_ends, count in zip(pairwise(breaks), counts, strict=True)]
    places = np.append(np.concatenate(parts), high)
    return places if ends[0] < ends[1] else places[::-1]


def _form_lengths(tooth: Tooth, side: Side, basis: InvoluteFlank) -> tuple[float, float]:
    """Return the roll lengths (mm) of form point and tip."""
    first, last = basis.roll_length(_radii(tooth, side, np.array([0.0, 1.0])))
    return float(first), float(last)


def _shares(tooth: Tooth, side: Side, basis: InvoluteFlank, lengths: Array) -> Array:
    """Return shares (N,) of the flank at roll lengths (N,), mm."""
    dense = np.linspace(0.0, 1.0, ROLL_LENGTH_POINTS)
    rolls = basis.roll_length(_radii(tooth, side, dense))
    sense = float(np.sign(rolls[-1] - rolls[0]))
    s = np.interp(sense * lengths, sense * rolls, dense)
    # one Newton step removes the error of the linear interpolation
    rest = lengths - basis.roll_length(_radii(tooth, side, s))
    return np.clip(s + rest / np.interp(s, dense, np.gradient(rolls, dense)), 0.0, 1.0)


def _radii(tooth: Tooth, side: Side, s: Array) -> Array:
    """Return radii (N,), mm, of the flank at shares s (N,), in the middle of the face."""
    points = tooth.flank_grid(side, s, [0.5]).points[:, 0]
    return np.hypot(points[:, 0], points[:, 1])
