"""Transverse sections of members: what a plane across the axis cuts, as closed contours of arcs, lines and cubic splines.

Lands, roots, rounded edges and all of the body are arcs about their centres and straight lines, as they are; flanks, fillets
and what else a tool generates become cubic splines through exact points, refined to a stated deviation, one for each smooth
piece. One tooth is drawn and turned. Points are (x, y), mm, in the member's own frame; contours go counterclockwise, whether
material is inside or not.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from gearmesh.cad.bar import rounding
from gearmesh.cad.brep import NARROWEST, ROUNDS, Piece
from gearmesh.cad.nodes import MOST, STEP, by_interval, plan, samples
from gearmesh.errors import ArgumentError, DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLETS, Region
from gearmesh.teeth.section import BottomLink, DrawnLink, GeneratedLink, Sections
from gearmesh.teeth.tooth import Tooth

#: degree of the splines: what DXF readers and SVG take
DEGREE = 3
#: the contour round all teeth
TEETH = "teeth"
#: share of the tolerance that splines keep at the places between their nodes where they are measured
SHARE = 0.9
#: z may be so far (mm) beyond an end face that it was meant to lie on
ON_FACE = 1e-9


class PlaneCurve(Protocol):
    """A curve in the plane of a section."""

    @property
    def start(self) -> Array:
        """(2,), mm."""

    @property
    def end(self) -> Array:
        """(2,), mm."""

    @property
    def swept(self) -> float:
        """Area (mm^2) that the line from the origin to the curve's point sweeps, counterclockwise."""

    def at(self, s: Array) -> Array:
        """Points (K, 2), mm, at s (K,) from 0 to 1."""

    def turn(self, angle: float) -> PlaneCurve:
        """The same about the origin by an angle (rad)."""

    def move(self, way: Array) -> PlaneCurve:
        """The same moved by `way` (2,), mm."""


@dataclass(frozen=True)
class PlaneLine:
    """A straight line between two points (2,), mm."""

    start: Array
    end: Array

    @property
    def swept(self) -> float:
        return 0.5 * float(self.start[0] * self.end[1] - self.start[1] * self.end[0])

    def at(self, s: Array) -> Array:
        return np.asarray(self.start + s[:, None] * (self.end - self.start))

    def turn(self, angle: float) -> PlaneLine:
        rotation = _rotation(angle)
        return PlaneLine(rotation @ self.start, rotation @ self.end)

    def move(self, way: Array) -> PlaneLine:
        return PlaneLine(self.start + way, self.end + way)


@dataclass(frozen=True)
class PlaneArc:
    """An arc about `centre` (2,), mm, from polar angle `first` by `width` (rad), clockwise where that is negative."""

    centre: Array
    radius: float
    first: float
    width: float

    @staticmethod
    def circle(radius: float, centre: Sequence[float] | Array = (0.0, 0.0)) -> PlaneArc:
        """A full circle."""
        return PlaneArc(np.array(centre, dtype=float), radius, 0.0, 2.0 * np.pi)

    @property
    def closed(self) -> bool:
        """Whether it is a full circle."""
        return abs(self.width) == 2.0 * np.pi

    @property
    def start(self) -> Array:
        return np.asarray(self.at(np.zeros(1))[0])

    @property
    def end(self) -> Array:
        return np.asarray(self.at(np.ones(1))[0])

    @property
    def swept(self) -> float:
        (x, y), last = self.centre, self.first + self.width
        lever = x * (np.sin(last) - np.sin(self.first)) - y * (np.cos(last) - np.cos(self.first))
        return 0.5 * self.radius * float(self.radius * self.width + lever)

    def at(self, s: Array) -> Array:
        angle = self.first + s * self.width
        return np.asarray(self.centre + self.radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1))

    def turn(self, angle: float) -> PlaneArc:
        return PlaneArc(_rotation(angle) @ self.centre, self.radius, self.first + angle, self.width)

    def move(self, way: Array) -> PlaneArc:
        return PlaneArc(self.centre + way, self.radius, self.first, self.width)


@dataclass(frozen=True)
class PlaneSpline:
    """A clamped cubic B-spline with control points (K, 2), mm, and knots (K + 4,) from 0 to 1."""

    control: Array
    knots: Array

    @property
    def start(self) -> Array:
        return np.asarray(self.control[0])

    @property
    def end(self) -> Array:
        return np.asarray(self.control[-1])

    @property
    def swept(self) -> float:
        # Bernstein polynomials of degree 3: the integrals of b_i b_j' - b_j b_i' over 0..1
        x, y = np.moveaxis(self.beziers, -1, 0)
        i, j = np.triu_indices(DEGREE + 1, 1)
        crossed = x[:, i] * y[:, j] - x[:, j] * y[:, i]
        return 0.5 * float((crossed @ _WRONSKIANS).sum())

    @cached_property
    def beziers(self) -> Array:
        """The same curve as Bezier segments, control points (N, 4, 2), mm, neighbours' ends the same."""
        ends = np.unique(self.knots)
        wide, spline = np.diff(ends)[:, None], BSpline(self.knots, self.control, DEGREE)
        place, slope = spline(ends[:-1]), wide * spline(ends[:-1], 1)
        square, cubic = wide**2 / 2.0 * spline(ends[:-1], 2), wide**3 / 6.0 * spline(ends[:-1], 3)
        control = np.stack(
            (place, place + slope / 3.0, place + (2.0 * slope + square) / 3.0, place + slope + square + cubic), axis=1
        )
        control[1:, 0] = control[:-1, -1]
        control[0, 0], control[-1, -1] = self.start, self.end
        return np.asarray(control)

    def at(self, s: Array) -> Array:
        return np.asarray(BSpline(self.knots, self.control, DEGREE)(s))

    def between(self, start: Array, end: Array) -> PlaneSpline:
        """The same with its ends moved a little."""
        return PlaneSpline(np.concatenate(([start], self.control[1:-1], [end])), self.knots)

    def turn(self, angle: float) -> PlaneSpline:
        return PlaneSpline(self.control @ _rotation(angle).T, self.knots)

    def move(self, way: Array) -> PlaneSpline:
        return PlaneSpline(self.control + way, self.knots)


#: by pairs i < j of the Bernstein polynomials, in the order of `np.triu_indices`
_WRONSKIANS = np.array([0.6, 0.3, 0.1, 0.3, 0.3, 0.6])


@dataclass(frozen=True)
class Contour:
    """A closed loop of curves, counterclockwise, each beginning where the one before ends.

    `material`: whether that is inside. `name` is "teeth" or what part of the body it bounds.
    """

    name: str
    curves: tuple[PlaneCurve, ...]
    material: bool

    @property
    def area(self) -> float:
        """Enclosed area, mm^2."""
        return sum(curve.swept for curve in self.curves)

    @property
    def gap(self) -> float:
        """Largest distance (mm) between the end of a curve and the beginning of the next."""
        ends = np.array([curve.end for curve in self.curves])
        starts = np.array([curve.start for curve in self.curves])
        return float(np.linalg.norm(np.roll(starts, -1, axis=0) - ends, axis=-1).max())


@dataclass(frozen=True)
class MemberSection:
    """What the plane at z (mm) cuts of a member; `deviation` (mm): of its splines, between their nodes too."""

    name: str
    z: float
    contours: tuple[Contour, ...]
    deviation: float

    @property
    def area(self) -> float:
        """Area of the material, mm^2."""
        return sum(contour.area if contour.material else -contour.area for contour in self.contours)

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the contours with the member's before them; several of one kind have the same."""
        return tuple(f"{self.name}_{contour.name}" for contour in self.contours)

    @property
    def gap(self) -> float:
        """As that of its contours, the largest."""
        return max(contour.gap for contour in self.contours)

    @property
    def reach(self) -> float:
        """Largest distance (mm) of the section from the axis."""
        return max(
            float(np.linalg.norm(_places(curve), axis=-1).max())
            for contour in self.contours
            for curve in contour.curves
        )


def member_section(member: Member, z: float, tolerance: float) -> MemberSection:
    """The transverse section of a member at z (mm), within `tolerance` (mm) of the exact one.

    Raises DesignError for members whose end faces are not planes and for z beyond the face, NoSolutionError where the
    tolerance is not met, TrimError for teeth that cannot be trimmed.
    """
    blank = member.tooth.blank
    if station_normal(blank.axial)[0] != 0.0:
        raise DesignError(
            member.name,
            reason="has no transverse section: its teeth end on cones or cylinders; sections need gears between "
            "plane end faces",
        )
    low, high = member.plain_body.ends
    if not low - ON_FACE <= z <= high + ON_FACE:
        raise ArgumentError(
            "section", z, unit="mm", must_be=f"within the face of the {member.name}, from {low:g} to {high:g} mm"
        )
    z = min(max(z, low), high)
    if member.tooth.joint.travel is not None:
        bar, deviation = _bar(member, z, tolerance)
        return MemberSection(member.name, z, (Contour(TEETH, bar, True),), deviation)
    teeth, deviation = _outline(member, z, tolerance)
    circles = _circles(member, z)
    # from outside inwards material begins and ends; the teeth bound an external gear outside, an internal one inside
    bounds = [*circles, teeth] if blank.body.around else [teeth, *circles]
    contours = [Contour(name, curves, k % 2 == 0) for k, (name, curves) in enumerate(bounds)]
    contours += [Contour("holes", (hole,), False) for hole in _holes(member, z)]
    return MemberSection(member.name, z, tuple(contours), deviation)


def _places(curve: PlaneCurve) -> Array:
    return curve.at(np.linspace(0.0, 1.0, STEP + 1))


def _rotation(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(c, -s), (s, c)])


#: what a bound of a section is: its name and its curves
_Bound = tuple[str, tuple[PlaneCurve, ...]]

#: one link, or smooth piece of it, at one station, as a curve and its deviation (mm)
_Drawn = Callable[[Tooth, Piece, Sections, float], tuple[PlaneCurve, float]]


def _outline(member: Member, z: float, tolerance: float) -> tuple[_Bound, float]:
    """The contour that bounds a member opposite to its bore or rim: round all teeth of the half that is there, or in the gap."""
    for gap in member.gaps:
        low, high = gap.body.ends
        if low < z < high:
            return (Region.GAP.value, (PlaneArc.circle(0.5 * gap.diameter),)), 0.0
    return _teeth(member, member.rows.station(z), tolerance)


def _teeth(member: Member, z: float, tolerance: float) -> tuple[_Bound, float]:
    """The contour round all teeth, and the deviation (mm) of its splines."""
    pitch = member.tooth.pitch_angle
    kinds, missed = zip(*(_one_tooth(tooth, z, tolerance, _of_gear) for tooth in member.different_teeth), strict=True)
    # all of them begin where any other ends a pitch before
    last = kinds[0][-1].turn(-pitch)
    moved = max(_join(one, last) for one in kinds)
    turned = [curve.turn(k * pitch) for k, kind in enumerate(member.order.tolist()) for curve in kinds[kind]]
    return (TEETH, tuple(turned)), max(missed) + moved


def _bar(member: Member, z: float, tolerance: float) -> tuple[tuple[PlaneCurve, ...], float]:
    """The contour of a rack, and the deviation (mm) of its splines: its teeth from end to end, and the bar under them."""
    tooth = member.tooth
    one, deviation = _one_tooth(tooth, z, tolerance, _of_rack)
    pitch = np.asarray(tooth.joint.to(tooth.pitch_angle).translation)[:2]
    moved = _join(one, one[-1].move(-pitch))
    places = tooth.joint.places(tooth.teeth)
    row = [curve.move(place * pitch) for place in places.tolist() for curve in one]
    # from the middle of the root before the first tooth to the middle of that behind the last
    root = float(tooth.blank.root.at(z))
    rooted = abs(one[0].start[0] - root) + abs(one[0].end[0] - root) < NARROWEST
    middle = 0.5 * (one[0].start + one[0].end) if rooted else one[0].start
    ends = [middle + (places[0] + k * tooth.teeth) * pitch for k in (0, 1)]
    first, last = (end + np.array([0.0, sign * member.overhang]) for end, sign in zip(ends, (-1.0, 1.0), strict=True))
    row = row[1:] if rooted else row
    back = member.tooth.blank.body.profile[0][0]
    corners = [row[-1].end, last, np.array([back, last[1]]), np.array([back, first[1]]), first, row[0].start]
    lines = [PlaneLine(a, b) for a, b in pairwise(corners) if np.linalg.norm(b - a) > NARROWEST]
    return (*row, *lines), deviation + moved


def _one_tooth(tooth: Tooth, z: float, tolerance: float, drawn: _Drawn) -> tuple[list[PlaneCurve], float]:
    """The curves of one tooth at z (mm), and the deviation (mm) of the splines among them."""
    toe, heel = tooth.blank.extent
    station = float(tooth.blank.axial.value(np.array([0.0, 0.0, z])))
    sections = tooth.sections([min(max((station - toe) / (heel - toe), 0.0), 1.0)])
    one, deviation = list[PlaneCurve](), 0.0
    for piece in [piece for region in tooth.regions for piece in Piece.of(tooth, region)]:
        ends = piece.grid(tooth, np.array([0.0, 1.0]), sections).points[:, 0, :2]
        if np.linalg.norm(ends[1] - ends[0]) <= NARROWEST:
            continue
        curve, miss = drawn(tooth, piece, sections, tolerance)
        one.append(curve)
        deviation = max(deviation, miss)
    return one, deviation


def _join(curves: list[PlaneCurve], last: PlaneCurve) -> float:
    """Let the splines of a tooth begin and end where their neighbours do, and return how far (mm) an end was moved.

    `last`: that of the tooth before. Neighbours have their ends in common to rounding, unless a link between them was too narrow to
    be drawn.
    """
    moved = 0.0
    for k, curve in enumerate(curves):
        before = curves[k - 1] if k else last
        moved = max(moved, float(np.linalg.norm(curve.start - before.end)))
        if isinstance(curve, PlaneSpline):
            curves[k] = curve.between(before.end, curve.end)
        elif k and isinstance(before, PlaneSpline):
            curves[k - 1] = before.between(before.start, curve.start)
    return moved


def _of_gear(tooth: Tooth, piece: Piece, sections: Sections, tolerance: float) -> tuple[PlaneCurve, float]:
    """A link of a gear, or smooth piece of it, at one station, and its deviation (mm)."""
    link = tooth.chain[piece.region]
    if isinstance(link, (GeneratedLink, BottomLink)):
        return _fit(tooth, piece, sections, tolerance)
    first, last = link.grid([0.0, 1.0], sections).points[:, 0, :2]
    if not isinstance(link, DrawnLink):
        return _arc(np.zeros(2), first, last), 0.0
    if not link.edge.rounded:
        return PlaneLine(first, last), 0.0
    points = sections.of(link.side).edge
    assert points is not None
    return _arc(points[2][0, :2], first, last), 0.0


def _of_rack(tooth: Tooth, piece: Piece, sections: Sections, tolerance: float) -> tuple[PlaneCurve, float]:
    """A link of a rack at one station, and its deviation (mm): fillets are arcs of ellipses, of circles across spur teeth."""
    link = tooth.chain[piece.region]
    first, last = link.grid([0.0, 1.0], sections).points[:, 0, :2]
    if piece.region not in FILLETS.values():
        return PlaneLine(first, last), 0.0
    trace = np.diff(tooth.grid(piece.region, np.zeros(1), tooth.sections([0.0, 1.0])).points[0], axis=0)[0]
    if abs(trace[1]) > ON_FACE:
        return _fit(tooth, piece, sections, tolerance)
    grid = link.grid(np.linspace(0.0, 1.0, STEP + 1), sections)
    centre, radius = rounding(grid.points[:, 0], grid.normals[:, 0], unit(trace))
    miss = np.linalg.norm(grid.points[:, 0, :2] - centre[:2], axis=-1) - radius
    return _arc(centre[:2], first, last), float(np.abs(miss).max())


def _arc(centre: Array, first: Array, last: Array) -> PlaneArc:
    """The shorter arc about a centre between two points (2,)."""
    before, after = (np.arctan2(*(point - centre)[::-1]) for point in (first, last))
    width = (after - before + np.pi) % (2.0 * np.pi) - np.pi
    return PlaneArc(centre, float(np.linalg.norm(first - centre)), float(before), float(width))


def _fit(tooth: Tooth, piece: Piece, sections: Sections, tolerance: float) -> tuple[PlaneSpline, float]:
    """A piece of a generated link at one station as a cubic spline through exact points."""

    allowed = SHARE * tolerance

    def exact(s: Array) -> Array:
        return piece.grid(tooth, s, sections).points[:, 0, :2]

    def excess(drawn: Array, wanted: Array) -> Array:
        return np.asarray(np.linalg.norm(drawn - wanted, axis=-1).max(axis=1) / allowed)

    nodes = plan(exact(samples())[:, None], excess, DEGREE)
    for turn in range(ROUNDS):
        wanted = exact(nodes.own(nodes.fine))
        spline = make_interp_spline(nodes.y, wanted[::STEP], k=DEGREE)
        miss = np.linalg.norm(spline(nodes.fine) - wanted, axis=-1)
        if miss.max() <= allowed:
            return PlaneSpline(spline.c, spline.t), float(miss.max())
        if nodes.y.size > MOST:
            break
        nodes = nodes.spread(by_interval(miss) / allowed, turn)
    raise NoSolutionError(
        reason=f"the section of the {piece.region} with {nodes.y.size} points deviates by {1000.0 * miss.max():.3g} um, more "
        f"than the tolerance of {1000.0 * tolerance:g} um; choose a larger tolerance"
    )


def _holes(member: Member, z: float) -> list[PlaneArc]:
    """The holes, where the plane meets them."""
    low, high = member.hole_range
    through = low <= z < high or z == high == member.plain_body.ends[1]
    if member.holes is None or not through:
        return []
    return [PlaneArc.circle(0.5 * member.holes.diameter, centre) for centre in member.holes.centres]


def _circles(member: Member, z: float) -> list[_Bound]:
    """What bounds the body at z, from outside inwards: circles, and the bore with its keyway."""
    body = member.plain_body
    high = body.ends[1]
    circles = []
    for (rho, start), (next_rho, end), band in zip(body.profile, body.profile[1:], body.bands, strict=False):
        # where the plane lies on a step of the profile, the section is that just above it, and below it at the end
        if min(start, end) <= z < max(start, end) or z == high == max(start, end) > min(start, end):
            circles.append((rho + (z - start) / (end - start) * (next_rho - rho), band))
    bounds: list[_Bound] = []
    for radius, band in sorted(circles, reverse=True):
        if radius > 0.0:
            keyed = band is Region.BORE and member.keyway is not None
            bounds.append((band.value, _bore_with_keyway(member, radius) if keyed else (PlaneArc.circle(radius),)))
    return bounds


def _bore_with_keyway(member: Member, radius: float) -> tuple[PlaneCurve, ...]:
    """The bore with the keyway on +x."""
    keyway = member.keyway
    assert keyway is not None
    half, bottom = 0.5 * keyway.width, radius + keyway.depth
    first = float(np.arcsin(half / radius))
    near = radius * np.cos(first)
    corners = np.array([(near, -half), (bottom, -half), (bottom, half), (near, half)])
    arc = PlaneArc(np.zeros(2), radius, first, 2.0 * (np.pi - first))
    return arc, *(PlaneLine(corners[k], corners[k + 1]) for k in range(3))
