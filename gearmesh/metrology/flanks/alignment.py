"""Alignment of measured points with their flanks, in the freedoms that the machine leaves.

These are the rotation about the axis (the position along the bar for racks), and the axial position if the datum is
free. A small rotation w and shift h change the distance of a point r along the normal n by w (z x r) . n + h n_z. Least
squares over all points give both, and a few rounds with new foot points make them exact. All teeth are equal, so that
points of any tooth are rotated back by whole pitches. Points of both flanks of a tooth are aligned together, which
keeps the measured thickness.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array, components
from gearmesh.metrology.flanks.projection import FlankProjection, FootPoints
from gearmesh.records import dataclass
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: rotations per pitch from which the search begins
STARTS_PER_PITCH = 90
#: largest number of points in this search
MAX_SAMPLE_POINTS = 400
#: approximate number of points of a flank that are aligned before all points
COARSE_POINTS = 2000
#: largest number of rounds
MAX_ROUNDS = 12
#: largest move of a point, mm, in a round after which the rounds end
MIN_MOVE_MM = 1e-8
#: root mean square distance, mm, above which points may belong to another flank
MAX_FIT_RMS_MM = 0.02
#: ratio of root mean square distances above which points belong to the flank that fits better
MIN_RMS_RATIO = 5.0
#: share of the points that must have foot points: a few points fit any flank somewhere
MIN_ON_FLANK_SHARE = 0.5


@dataclass(frozen=True)
class Alignment:
    """Displacement of measured points, and their foot points."""

    #: rotation about the axis, rad
    rotation: float
    #: axial shift, mm
    shift: float
    #: foot points by sides
    feet: Mapping[Side, FootPoints]

    @property
    def rms(self) -> float:
        """Root mean square distance, mm, of the aligned points from the flanks."""
        return _rms(self.feet)

    @property
    def on_flank(self) -> bool:
        """True if most of the points lie beside the flank."""
        return (
            float(np.mean(np.isfinite(np.concatenate([foot.distances for foot in self.feet.values()]))))
            > MIN_ON_FLANK_SHARE
        )


def align(tooth: Tooth, points: Mapping[Side, Array], *, axial: bool) -> Alignment:
    """Move points (N, 3), mm, of one flank or of both flanks of a tooth to the best fit.

    `axial` is True if the axial position is free. Raises DesignError if they fit the other flank, or the flank of a
    gear of the other hand, and not their own.
    """
    projections = {side: FlankProjection(tooth, side) for side in Side}
    alignment = _fit(tooth, projections, points, axial)
    if alignment.rms > MAX_FIT_RMS_MM or not alignment.on_flank:
        _refuse_mixed_up(tooth, projections, points, axial, alignment)
    return alignment


def _fit(
    tooth: Tooth, projections: Mapping[Side, FlankProjection], points: Mapping[Side, Array], axial: bool
) -> Alignment:
    place = _start(tooth, projections, points), 0.0
    few = {side: side_points[:: max(1, len(side_points) // COARSE_POINTS)] for side, side_points in points.items()}
    # a few points find the approximate place, all points the exact place
    for fitted_points, rounds in ((few, MAX_ROUNDS), (points, MAX_ROUNDS)):
        place = _refine(projections, fitted_points, place, axial, rounds)
    return Alignment(*place, _feet(projections, points, place))


def _refine(
    projections: Mapping[Side, FlankProjection],
    points: Mapping[Side, Array],
    place: tuple[float, float],
    axial: bool,
    rounds: int,
) -> tuple[float, float]:
    """Return rotation (rad) and shift (mm) after up to `rounds` steps of least squares from a nearby place."""
    rotation, shift = place
    joint = _joint(projections)
    for _ in range(rounds):
        feet = _feet(projections, points, (rotation, shift))
        r, n, d = (
            np.concatenate([getattr(foot, name) for foot in feet.values()])
            for name in ("points", "normals", "distances")
        )
        rates = components(joint.along(r, n), n[:, 2])[:, : 2 if axial else 1]
        kept = np.isfinite(d)
        step = -np.linalg.lstsq(rates[kept], d[kept], rcond=None)[0]
        rotation, shift = rotation + float(step[0]), shift + (float(step[1]) if axial else 0.0)
        if np.abs(rates[kept] @ step).max(initial=0.0) < MIN_MOVE_MM:
            break
    return rotation, shift


def _feet(
    projections: Mapping[Side, FlankProjection], points: Mapping[Side, Array], place: tuple[float, float]
) -> dict[Side, FootPoints]:
    joint = _joint(projections)
    return {
        side: projections[side].foot_points(_displace(joint, side_points, place))
        for side, side_points in points.items()
    }


def _joint(projections: Mapping[Side, FlankProjection]) -> Joint:
    """Return the joint of the member to which the flanks belong."""
    return next(iter(projections.values())).tooth.joint


def _displace(joint: Joint, points: Array, place: tuple[float, float]) -> Array:
    """Return points (N, 3) rotated about z by an angle (rad), or moved along y for racks, and shifted along z (mm)."""
    displaced: Array = joint.to(place[0]).point(points) + np.array([0.0, 0.0, place[1]])
    return displaced


def _start(tooth: Tooth, projections: Mapping[Side, FlankProjection], points: Mapping[Side, Array]) -> float:
    """Return the rotation (rad) from which the points are nearest to their flanks, among rotations that bring them to
    the tooth."""
    few = {side: side_points[:: max(1, len(side_points) // MAX_SAMPLE_POINTS)] for side, side_points in points.items()}
    joint = tooth.joint
    angles = np.concatenate([joint.angle(side_points) for side_points in few.values()])
    middle = float(angles[0] + joint.within(angles - angles[0]).mean())
    pitch = tooth.pitch_angle
    pitch_rotation = -pitch * np.round(middle / pitch)
    rotations = pitch_rotation + pitch * np.linspace(-1.0, 1.0, 2 * STARTS_PER_PITCH, endpoint=False)
    rotations = np.concatenate(([0.0], rotations))
    distances = [
        sum(
            projections[side].near_distance(_displace(joint, side_points, (float(angle), 0.0)))
            for side, side_points in few.items()
        )
        for angle in rotations
    ]
    return float(rotations[int(np.argmin(distances))])


def _rms(feet: Mapping[Side, FootPoints]) -> float:
    distances = np.concatenate([foot.distances for foot in feet.values()])
    known = distances[np.isfinite(distances)]
    return float(np.sqrt((known**2).mean())) if known.size else np.inf


def _refuse_mixed_up(
    tooth: Tooth,
    projections: Mapping[Side, FlankProjection],
    points: Mapping[Side, Array],
    axial: bool,
    alignment: Alignment,
) -> None:
    """Raise ArgumentError if the points fit better as those of other flanks, or mirrored."""
    names = " and ".join(points)
    mirrored = {side: side_points * np.array([1.0, -1.0, 1.0]) for side, side_points in points.items()}
    other_names = " and ".join(side.other for side in points)
    of_mirror = "flank of the mirror image, a gear of the other hand"
    others = {
        f"the {other_names} flank": {side.other: side_points for side, side_points in points.items()},
        f"the {names} {of_mirror}": mirrored,
        f"the {other_names} {of_mirror}": {side.other: side_points for side, side_points in mirrored.items()},
    }
    for words, candidate in others.items():
        other_fit = _fit(tooth, projections, candidate, axial)
        if other_fit.on_flank and other_fit.rms * MIN_RMS_RATIO < (
            alignment.rms if alignment.on_flank else MAX_FIT_RMS_MM
        ):
            how = f"within {1e3 * alignment.rms:.3g} um" if alignment.on_flank else "with a few of them alone"
            raise ArgumentError(
                "points",
                reason=f"they fit {words} within {1e3 * other_fit.rms:.3g} um, and the {names} flank {how}",
                allowed=f"points of the {names} flank",
            )
