"""Measured points laid on the flanks that they are of, with the freedoms that the machine leaves: rotation about the axis (of racks
the place along the bar), and the axial position where the datum is free.

A small rotation w and shift h change the distance of a point r along the normal n by w (z x r) . n + h n_z: least squares over all
points give both, and a few rounds with new foot points the exact place. Teeth are alike, so that points of any of them are turned
back by whole pitches. Points of both flanks of a tooth are laid together: its thickness stays what was measured.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array, components
from gearmesh.metrology.flanks.projection import FlankProjection, FootPoints
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: rotations in a pitch from which a search begins, and points that take part in it at most
STARTS, SAMPLE = 90, 400
#: points of a flank, about, that find the place before all do
FIRST = 2000
#: rounds at most, and the largest move (mm) of the last
ROUNDS, SMALLEST_MOVE = 12, 1e-8
#: distances (mm) of another flank's or hand's points, and over those of the right one, from which on it is not this flank
FAR, CLEARLY = 0.02, 5.0
#: part of the points that must have feet on the flank: a few of them fit any flank somewhere
MOST_OF = 0.5


@dataclass(frozen=True)
class Alignment:
    """How measured points were moved, by `rotation` (rad) and `shift` (mm), and their foot points by sides; `rms` (mm) is that of
    the distances then."""

    rotation: float
    shift: float
    feet: Mapping[Side, FootPoints]

    @property
    def rms(self) -> float:
        return _rms(self.feet)

    @property
    def on_flank(self) -> bool:
        """Whether most of the points lie beside the flank."""
        return float(np.mean(np.isfinite(np.concatenate([foot.distances for foot in self.feet.values()])))) > MOST_OF


def align(tooth: Tooth, points: Mapping[Side, Array], *, axial: bool) -> Alignment:
    """Points (N, 3), mm, of one flank of a tooth or of both, moved to where they fit best; the `axial` position is free, or given.

    Raises DesignError where they fit the other flank, or the flank of a gear of the other hand, and not these.
    """
    projections = {side: FlankProjection(tooth, side) for side in Side}
    made = _fit(tooth, projections, points, axial)
    if made.rms > FAR or not made.on_flank:
        _refuse_mixed_up(tooth, projections, points, axial, made)
    return made


def _fit(
    tooth: Tooth, projections: Mapping[Side, FlankProjection], points: Mapping[Side, Array], axial: bool
) -> Alignment:
    place = _start(tooth, projections, points), 0.0
    few = {side: own[:: max(1, len(own) // FIRST)] for side, own in points.items()}
    # a few points find the place, all of them where it is exactly
    for own, rounds in ((few, ROUNDS), (points, ROUNDS)):
        place = _refine(projections, own, place, axial, rounds)
    return Alignment(*place, _feet(projections, points, place))


def _refine(
    projections: Mapping[Side, FlankProjection],
    points: Mapping[Side, Array],
    place: tuple[float, float],
    axial: bool,
    rounds: int,
) -> tuple[float, float]:
    """Rotation (rad) and shift (mm) after so many steps of least squares at most, from a place near."""
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
        if np.abs(rates[kept] @ step).max(initial=0.0) < SMALLEST_MOVE:
            break
    return rotation, shift


def _feet(
    projections: Mapping[Side, FlankProjection], points: Mapping[Side, Array], place: tuple[float, float]
) -> dict[Side, FootPoints]:
    joint = _joint(projections)
    return {side: projections[side].foot_points(_displace(joint, own, place)) for side, own in points.items()}


def _joint(projections: Mapping[Side, FlankProjection]) -> Joint:
    """In which the member moves that the flanks are of."""
    return next(iter(projections.values())).tooth.joint


def _displace(joint: Joint, points: Array, place: tuple[float, float]) -> Array:
    """Points (N, 3) turned about z by an angle (rad), of racks moved along y, and shifted along z by so many mm."""
    displaced: Array = joint.to(place[0]).point(points) + np.array([0.0, 0.0, place[1]])
    return displaced


def _start(tooth: Tooth, projections: Mapping[Side, FlankProjection], points: Mapping[Side, Array]) -> float:
    """The rotation (rad), of those that turn points to the tooth, from which they are nearest to their flanks."""
    few = {side: own[:: max(1, len(own) // SAMPLE)] for side, own in points.items()}
    joint = tooth.joint
    angles = np.concatenate([joint.angle(own) for own in few.values()])
    middle = float(angles[0] + joint.within(angles - angles[0]).mean())
    pitch = tooth.pitch_angle
    whole = -pitch * np.round(middle / pitch)
    tried = whole + pitch * np.linspace(-1.0, 1.0, 2 * STARTS, endpoint=False)
    tried = np.concatenate(([0.0], tried))
    far = [
        sum(projections[side].near_distance(_displace(joint, own, (float(angle), 0.0))) for side, own in few.items())
        for angle in tried
    ]
    return float(tried[int(np.argmin(far))])


def _rms(feet: Mapping[Side, FootPoints]) -> float:
    d = np.concatenate([foot.distances for foot in feet.values()])
    kept = d[np.isfinite(d)]
    return float(np.sqrt((kept**2).mean())) if kept.size else np.inf


def _refuse_mixed_up(
    tooth: Tooth,
    projections: Mapping[Side, FlankProjection],
    points: Mapping[Side, Array],
    axial: bool,
    made: Alignment,
) -> None:
    """Raise where the points fit better as those of other flanks, or mirrored."""
    names = " and ".join(points)
    mirrored = {side: own * np.array([1.0, -1.0, 1.0]) for side, own in points.items()}
    other_names = " and ".join(side.other for side in points)
    of_mirror = "flank of the mirror image, a gear of the other hand"
    others = {
        f"the {other_names} flank": {side.other: own for side, own in points.items()},
        f"the {names} {of_mirror}": mirrored,
        f"the {other_names} {of_mirror}": {side.other: own for side, own in mirrored.items()},
    }
    for words, tried in others.items():
        other = _fit(tooth, projections, tried, axial)
        if other.on_flank and other.rms * CLEARLY < (made.rms if made.on_flank else FAR):
            how = f"within {1e3 * made.rms:.3g} um" if made.on_flank else "with a few of them alone"
            raise ArgumentError(
                "points",
                reason=f"they fit {words} within {1e3 * other.rms:.3g} um, and the {names} flank {how}",
                allowed=f"points of the {names} flank",
            )
