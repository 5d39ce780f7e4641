"""Axial sections of threads: cuts of a worm by a plane through the axis, as closed contours of lines and cubic splines.

Points are (z, rho) on the side of the first tooth's +x axis, and (z, -rho) on the other side. A thread meets the half plane at the
polar angle phi once in every axial pitch. The point at s of a link lies in the half plane at the height z with

    theta(s, z) = phi + 2 pi n / teeth

The iteration z <- z + P (phi + 2 pi n / teeth - theta) solves this equation. It is exact after one step for a screw surface of
parameter P, and takes some steps where the thread runs out. Flanks, fillets and broken edges are splines through exact points;
lands and roots follow their profiles.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.cad.brep import MIN_LINK_WIDTH_MM, Piece
from gearmesh.cad.contours.curves import Contour, PlaneSpline
from gearmesh.cad.section import TEETH_CONTOUR, MemberSection, section_spline
from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.plane.curves import PlaneCurve, PlaneLine
from gearmesh.kernel.surface.levels import LandLevel
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections, TurnedLink
from gearmesh.teeth.tooth import Tooth

#: largest number of steps to the half plane
MAX_PLANE_STEPS = 40
#: length of the last step
LAST_STEP_MM = 1e-12
#: points of a piece that show whether the piece lies on the face
POINTS_PER_PIECE = 9


@dataclass(frozen=True)
class _Cut:
    """Intersection of a piece of a thread's chain with a half plane."""

    #: tooth of the thread
    tooth: Tooth
    #: piece of the chain
    piece: Piece
    #: polar angle of the half plane, rad, with full turns
    angle: float
    #: screw parameter of the piece, mm/rad
    screw: float
    #: section of the tooth in mid face
    mid_face: Sections

    def at(self, s: Array) -> Array:
        """Return points (K, 2), z and rho, mm, at s (K,) of the piece; beyond the face, z continues as a screw surface."""
        tooth, (toe, heel) = self.tooth, self.tooth.blank.extent
        s = np.asarray(s, dtype=float)
        points = self.piece.grid(tooth, s, self.mid_face).points[:, 0]
        middle, theta = points[0, 2], np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
        z = middle + self.screw * (self.angle - theta)
        diagonal = np.arange(len(s))
        for _ in range(MAX_PLANE_STEPS):
            held = np.clip(z, min(toe, heel), max(toe, heel))
            grid = self.piece.grid(tooth, s, tooth.sections((held - toe) / (heel - toe)))
            points = grid.points[diagonal, diagonal]
            # add the full turns that bring the angle near to the angle of the screw
            wound = theta + (held - middle) / self.screw
            off = np.arctan2(points[:, 1], points[:, 0]) - wound
            wound = wound + (off + np.pi) % (2.0 * np.pi) - np.pi
            before, z = z, held + self.screw * (self.angle - wound)
            if np.abs(z - before).max() <= LAST_STEP_MM * max(1.0, float(np.abs(z).max())):
                return np.stack((z, np.hypot(points[:, 0], points[:, 1])), axis=-1)
        raise NoSolutionError(reason=f"the section of the {self.piece.region} was not found")

    def within(self, low: float, high: float) -> tuple[float, float] | None:
        """Return the ends in s of the part of the piece at z from `low` to `high`, None without such a part."""
        s = np.linspace(0.0, 1.0, POINTS_PER_PIECE)
        z = self.at(s)[:, 0]
        inside = (z > low) & (z < high)
        if not inside.any():
            return None
        first, last = (int(np.flatnonzero(inside)[k]) for k in (0, -1))
        return self._end(s, z, first, first - 1, (low, high)), self._end(s, z, last, last + 1, (low, high))

    def _end(self, s: Array, z: Array, inner: int, outer: int, ends: tuple[float, float]) -> float:
        if not 0 <= outer < len(s):
            return float(s[inner])
        bound = ends[0] if z[outer] <= ends[0] else ends[1]

        def beyond(x: Array, _: NDArray[np.intp]) -> Array:
            return self.at(x)[:, 0] - bound

        root = bracketed_root(beyond, np.array([s[outer]]), np.array([s[inner]]))
        return float(root.values[0])


def axial_section(member: Member, tolerance: float) -> MemberSection:
    """Compute the axial section of a worm, through the middle of the tooth on +x, within `tolerance` (mm).

    Keyways, holes and broken edges of the ends are not drawn. Raises ArgumentError for members whose teeth are no threads,
    NoSolutionError if the tolerance is not met.
    """
    tooth = member.tooth
    if tooth.screw is None or member.others:
        raise ArgumentError(
            "section",
            "axial",
            reason=f"the teeth of the {member.name} are no threads, which a plane through the axis cuts across",
            allowed="a worm, or z along the axis",
        )
    tell(0.0)
    low, high = sorted(tooth.blank.extent)
    contours, deviation = [], 0.0
    for angle in (0.0, np.pi):
        row, missed = _row(tooth, angle, low, high, tolerance)
        body = [np.array([z, rho]) for rho, z in member.plain_body.profile]
        corners = [row[-1].end, *body[::-1], row[0].start]
        lines = [PlaneLine(a, b) for a, b in pairwise(corners) if np.linalg.norm(b - a) > MIN_LINK_WIDTH_MM]
        # the row goes from toe to heel, which is clockwise above the axis and counterclockwise below it
        around = (
            [_backwards(curve) for curve in (*row, *lines)[::-1]] if angle == 0.0 else [*map(_below, (*row, *lines))]
        )
        contours.append(Contour(TEETH_CONTOUR, tuple(around), True))
        deviation = max(deviation, missed)
    return MemberSection(member.name, None, tuple(contours), deviation)


def _row(tooth: Tooth, angle: float, low: float, high: float, tolerance: float) -> tuple[list[PlaneCurve], float]:
    """Return the outline of the threads in the half plane at `angle`, from end to end of the face, and its deviation, mm."""
    # between the breaks next to mid face the threads are exact screw surfaces: their pieces are drawn once and moved
    curves, deviation = list[PlaneCurve](), 0.0
    alike: dict[Piece, tuple[_Cut, PlaneSpline, float]] = {}
    sides = (tooth.right, tooth.left)
    breaks = np.array([low, high, *(z for side in sides for z in (*side.face_bends, *side.face_breaks))])
    middle = 0.5 * (low + high)
    even = float(breaks[breaks <= middle].max()), float(breaks[breaks >= middle].min())
    # draw flanks, fillets and edges along z, and join them along land or root
    at = np.array([low, np.nan])
    level: LandLevel | None = None
    for cut in _in_order(tooth, angle, low, high):
        land = _level(tooth, cut.piece.region)
        if land is not None:
            level = land
            continue
        ends = cut.within(low, high)
        if ends is None:
            continue
        curve, missed = _draw(cut, ends, even, alike, tolerance)
        if curve.start[0] - low > MIN_LINK_WIDTH_MM or curves:
            curves.extend(_land(level, at, curve.start, tolerance))
        curves.append(curve)
        at, deviation = curve.end, max(deviation, missed)
    if high - at[0] > MIN_LINK_WIDTH_MM:
        curves.extend(_land(level, at, np.array([high, np.nan]), tolerance))
    return _join(curves), deviation


def _draw(
    cut: _Cut,
    ends: tuple[float, float],
    even: tuple[float, float],
    alike: dict[Piece, tuple[_Cut, PlaneSpline, float]],
    tolerance: float,
) -> tuple[PlaneSpline, float]:
    """Return a piece between two of its s as a spline along z, and its deviation, mm.

    Between the `even` z the threads are screw surfaces. A whole piece there is a moved copy of the same piece in `alike`.
    """
    z = cut.at(np.array([0.0, 1.0]))[:, 0]
    first, last = ends if z[1] > z[0] else ends[::-1]
    whole = sorted(ends) == [0.0, 1.0] and even[0] <= z.min() and z.max() <= even[1]
    if whole and cut.piece in alike:
        other, curve, missed = alike[cut.piece]
        return curve.move(np.array([cut.screw * (cut.angle - other.angle), 0.0])), missed
    made = section_spline(lambda s: cut.at(first + s * (last - first)), cut.piece.region, tolerance)
    if whole:
        alike[cut.piece] = cut, *made
    return made


def _in_order(tooth: Tooth, angle: float, low: float, high: float) -> Iterator[_Cut]:
    """Yield the pieces of all threads that may meet the half plane on the face, in the order of z."""
    screw = tooth.screw
    assert screw is not None
    pitch = tooth.pitch_angle
    reach = (high - low) / abs(screw * pitch) / 2.0 + 2.0
    numbers = np.arange(-np.ceil(reach), np.ceil(reach) + 1.0)
    mid_face = tooth.sections([0.5])
    pieces = [
        (piece, _own_screw(tooth, piece, mid_face) or screw)
        for region in tooth.regions
        for piece in Piece.of(tooth, region)
    ]
    for n in numbers if screw > 0.0 else numbers[::-1]:
        # theta grows along the chain, so z falls along it for a right-hand thread
        for piece, own in pieces[::-1] if screw > 0.0 else pieces:
            yield _Cut(tooth, piece, angle + float(n) * pitch, own, mid_face)


def _own_screw(tooth: Tooth, piece: Piece, mid_face: Sections) -> float | None:
    """Return the screw parameter (mm/rad) of a piece by its normal in mid face, None for lands."""
    grid = piece.grid(tooth, np.array([0.5]), mid_face)
    r, n = grid.points[0, 0], grid.normals[0, 0]
    return None if abs(n[2]) < MIN_LINK_WIDTH_MM else float((r[1] * n[0] - r[0] * n[1]) / n[2])


def _level(tooth: Tooth, region: Region) -> LandLevel | None:
    """Return the profile of a land or a root, None for other links."""
    if not isinstance(tooth.chain[region], TurnedLink):
        return None
    return tooth.blank.tip if region is Region.LAND else tooth.blank.root


def _land(level: LandLevel | None, start: Array, end: Array, tolerance: float) -> list[PlaneCurve]:
    """Return the curves that join two points (z, rho) along a profile; rho may be NaN for unknown."""
    if end[0] - start[0] <= MIN_LINK_WIDTH_MM or level is None:
        return []
    z = np.linspace(start[0], end[0], POINTS_PER_PIECE)
    rho = level.at(z)
    if np.ptp(rho) <= LAST_STEP_MM * 1e3:
        return [PlaneLine(np.array([start[0], rho[0]]), np.array([end[0], rho[-1]]))]

    def exact(s: Array) -> Array:
        along = start[0] + s * (end[0] - start[0])
        return np.stack((along, level.at(along)), axis=-1)

    return [section_spline(exact, "land", tolerance)[0]]


def _join(curves: list[PlaneCurve]) -> list[PlaneCurve]:
    """Move the beginning of each curve to the end of the curve before."""
    joined = curves[:1]
    for curve in curves[1:]:
        start = joined[-1].end
        joined.append(
            curve.between(start, curve.end) if isinstance(curve, PlaneSpline) else PlaneLine(start, curve.end)
        )
    return joined


def _backwards(curve: PlaneCurve) -> PlaneCurve:
    if isinstance(curve, PlaneSpline):
        return PlaneSpline(curve.control[::-1], 1.0 - curve.knots[::-1])
    return PlaneLine(curve.end, curve.start)


def _below(curve: PlaneCurve) -> PlaneCurve:
    """Return the curve mirrored to the other side of the axis."""
    mirror = np.array([1.0, -1.0])
    if isinstance(curve, PlaneSpline):
        return replace(curve, control=curve.control * mirror)
    return PlaneLine(curve.start * mirror, curve.end * mirror)
