"""Transverse sections of members: cuts by a plane across the axis, as closed contours of arcs, lines and cubic splines.

Lands, roots, rounded edges and the whole body are exact arcs and straight lines. Flanks, fillets and other generated links become
cubic splines through exact points, one for each smooth piece, refined to a stated deviation. One tooth is drawn and turned. Points
are (x, y), mm, in the member's frame; contours go counterclockwise, with material inside or outside.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from gearmesh.cad.bar import rounding
from gearmesh.cad.brep import MAX_ROUNDS, MIN_LINK_WIDTH_MM, Piece
from gearmesh.cad.contours.curves import CUBIC_DEGREE, Contour, PlaneSpline
from gearmesh.cad.nodes import MAX_NODES, PLACES_PER_INTERVAL, by_interval, plan, samples
from gearmesh.errors import ArgumentError, DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.kernel.numeric.splines import SplineCurve
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine, lines_through
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.teeth.end_strip import EndStrip, StripPiece
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLET_REGIONS, Region
from gearmesh.teeth.section import BottomLink, DrawnLink, GeneratedLink, Sections, TurnedLink
from gearmesh.teeth.tooth import Tooth

#: name of the contour round all teeth
TEETH_CONTOUR = "teeth"
#: names of the contours of openings, by the region of their walls
OPENING_CONTOURS = {Region.HOLE: "holes", Region.BOLT: "bolts", Region.SPOKE: "spokes"}
#: share of the tolerance that splines keep at the measured places between their nodes
TOLERANCE_SHARE = 0.9
#: distance of z beyond an end face at which the section still is at the end face
FACE_SLACK_MM = 1e-9


@dataclass(frozen=True)
class MemberSection:
    """Section of a member by a plane across the axis, or through the axis."""

    #: name of the member
    name: str
    #: height of the plane, mm, None for a plane through the axis
    z: float | None
    #: closed contours
    contours: tuple[Contour, ...]
    #: largest deviation of the splines, also between their nodes, mm
    deviation: float
    #: line along the axis; None for a section across it
    axis: PlaneLine | None = None

    @property
    def area(self) -> float:
        """Area of the material, mm^2."""
        return sum(contour.area if contour.material else -contour.area for contour in self.contours)

    @property
    def layers(self) -> tuple[str, ...]:
        """Names of the contours, each after the name of the member; contours of one kind have the same name."""
        return tuple(f"{self.name}_{contour.name}" for contour in self.contours)

    @property
    def axis_layer(self) -> str:
        """Name of the line along the axis."""
        return f"{self.name}_axis"

    @property
    def gap(self) -> float:
        """Largest gap of its contours, mm."""
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
    """Compute the transverse section of a member at z (mm) within `tolerance` (mm).

    Raises DesignError for members whose end faces are not planes, ArgumentError for z beyond the face, NoSolutionError if the
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
    if not low - FACE_SLACK_MM <= z <= high + FACE_SLACK_MM:
        raise ArgumentError(
            "section", z, unit="mm", must_be=f"within the face of the {member.name}, from {low:g} to {high:g} mm"
        )
    tell(0.0)
    z = min(max(z, low), high)
    if member.tooth.joint.travel is not None:
        bar, deviation = _bar(member, z, tolerance)
        holes = [Contour(name, curves, False) for name, curves in _openings(member, z)]
        return MemberSection(member.name, z, (Contour(TEETH_CONTOUR, bar, True), *holes), deviation)
    teeth, deviation = _outline(member, z, tolerance)
    circles = _circles(member, z)
    # from outside inwards contours begin and end the material in turn; the teeth bound an external gear outside, a ring inside
    bounds = [*circles, teeth] if blank.body.around else [teeth, *circles]
    contours = [Contour(name, curves, k % 2 == 0) for k, (name, curves) in enumerate(bounds)]
    contours += [Contour(name, curves, False) for name, curves in _openings(member, z)]
    return MemberSection(member.name, z, tuple(contours), deviation)


def _places(curve: PlaneCurve) -> Array:
    return curve.at(np.linspace(0.0, 1.0, PLACES_PER_INTERVAL + 1))


#: name and curves of a contour
_Bound = tuple[str, tuple[PlaneCurve, ...]]

#: function that returns a smooth piece of a link at a station as a curve, and its deviation (mm)
_Drawn = Callable[[Tooth, Piece, Sections, float], tuple[PlaneCurve, float]]


def _outline(member: Member, z: float, tolerance: float) -> tuple[_Bound, float]:
    """Return the contour opposite to bore or rim, and its deviation (mm): round all teeth of a row, or in a gap between rows."""
    for gap in member.gaps:
        low, high = gap.body.ends
        if low < z < high:
            return (Region.GAP.value, (PlaneArc.circle(0.5 * gap.diameter),)), 0.0
    return _teeth(member, member.rows.station(z), tolerance)


def _teeth(member: Member, z: float, tolerance: float) -> tuple[_Bound, float]:
    """Return the contour round all teeth, and the deviation (mm) of its splines."""
    pitch = member.tooth.pitch_angle
    kinds, missed = zip(*(_one_tooth(tooth, z, tolerance, _of_gear) for tooth in member.different_teeth), strict=True)
    # different teeth have the same ends: each begins where any other tooth ends one pitch before
    last = kinds[0][-1].turn(-pitch)
    moved = max(_join(kind_curves, last) for kind_curves in kinds)
    turned = [curve.turn(k * pitch) for k, kind in enumerate(member.order.tolist()) for curve in kinds[kind]]
    return (TEETH_CONTOUR, tuple(turned)), max(missed) + moved


def _bar(member: Member, z: float, tolerance: float) -> tuple[tuple[PlaneCurve, ...], float]:
    """Return the contour of a rack, its teeth and the bar under them, and the deviation (mm) of its splines."""
    tooth, back = member.tooth, member.tooth.blank.body.profile[0][0]
    gap = next((gap for gap in member.gaps if gap.body.ends[0] < z < gap.body.ends[1]), None)
    z = member.rows.station(z)
    if gap is not None:
        low, high = map(float, member.bar_ends(np.array(tooth.blank.faces[1])))
        return lines_through([(back, low), (gap.floor, low), (gap.floor, high), (back, high), (back, low)]), 0.0
    tooth_curves, deviation = _one_tooth(tooth, z, tolerance, _of_rack)
    pitch = np.asarray(tooth.joint.to(tooth.pitch_angle).translation)[:2]
    moved = _join(tooth_curves, tooth_curves[-1].move(-pitch))
    places = tooth.joint.places(tooth.teeth)
    row = [curve.move(place * pitch) for place in places.tolist() for curve in tooth_curves]
    # from the middle of the root before the first tooth to the middle of the root after the last tooth
    root = float(tooth_curves[0].start[0])
    rooted = abs(tooth_curves[0].end[0] - root) < MIN_LINK_WIDTH_MM
    first, last = (np.array([root, float(y)]) for y in member.bar_ends(np.array(z)))
    row = row[1:] if rooted else row
    corners = [row[-1].end, last, np.array([back, last[1]]), np.array([back, first[1]]), first, row[0].start]
    lines = [PlaneLine(a, b) for a, b in pairwise(corners) if np.linalg.norm(b - a) > MIN_LINK_WIDTH_MM]
    return (*row, *lines), deviation + moved


def _one_tooth(tooth: Tooth, z: float, tolerance: float, drawn: _Drawn) -> tuple[list[PlaneCurve], float]:
    """Return the curves of one tooth at z (mm), and the deviation (mm) of its splines."""
    # z in the chamfer of an end face has no section of the tooth, but a line of the chamfer
    toe, heel = tooth.blank.extent
    station = float(tooth.blank.axial.value(np.array([0.0, 0.0, z])))
    for end, strip in enumerate(tooth.end_strips):
        edge, face = tooth.blank.extent[end], tooth.blank.faces[end]
        if strip is not None and (station - edge) * (face - edge) > 0.0:
            return _in_chamfer(strip, strip.tau(max((station - face) / (edge - face), 0.0)), tolerance)
    sections = tooth.sections([min(max((station - toe) / (heel - toe), 0.0), 1.0)])
    curves, deviation = list[PlaneCurve](), 0.0
    for piece in [piece for region in tooth.regions for piece in Piece.of(tooth, region)]:
        ends = piece.grid(tooth, np.array([0.0, 1.0]), sections).points[:, 0, :2]
        if np.linalg.norm(ends[1] - ends[0]) <= MIN_LINK_WIDTH_MM:
            continue
        curve, miss = drawn(tooth, piece, sections, tolerance)
        curves.append(curve)
        deviation = max(deviation, miss)
    return curves, deviation


def _in_chamfer(strip: EndStrip, tau: float, tolerance: float) -> tuple[list[PlaneCurve], float]:
    """Return the curves of one tooth at tau of the chamfer of an end face, and their deviation (mm)."""
    curves, deviation = list[PlaneCurve](), 0.0
    for piece in strip.pieces:

        def exact(sigma: Array, piece: StripPiece = piece) -> Array:
            return strip.at(piece, sigma, np.full(sigma.size, tau))[:, :2]

        if (
            np.linalg.norm(np.diff(exact(np.linspace(0.0, 1.0, PLACES_PER_INTERVAL + 1)), axis=0), axis=-1).sum()
            <= MIN_LINK_WIDTH_MM
        ):
            continue
        curve, miss = section_spline(exact, f"chamfer along the {piece.region}", tolerance)
        curves.append(curve)
        deviation = max(deviation, miss)
    return curves, deviation


def _join(curves: list[PlaneCurve], last: PlaneCurve) -> float:
    """Move the ends of a tooth's splines to the ends of their neighbours, and return the largest movement (mm).

    `last` is the last curve of the tooth before. Neighbours have equal ends except for rounding, unless a link between them is too
    narrow to be drawn.
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
    """Return a smooth piece of a gear's link at one station as a curve, and its deviation (mm)."""
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
    """Return a link of a rack at one station as a curve, and its deviation (mm).

    Root fillets of spur racks are arcs of circles; root fillets of helical racks are ellipses, drawn as splines.
    """
    link = tooth.chain[piece.region]
    if isinstance(link, DrawnLink):
        return _of_gear(tooth, piece, sections, tolerance)
    first, last = link.grid([0.0, 1.0], sections).points[:, 0, :2]
    if isinstance(link, TurnedLink):
        return PlaneLine(first, last), 0.0
    if isinstance(link, GeneratedLink) and tooth.side(link.side).generated is not None:
        return _fit(tooth, piece, sections, tolerance)
    if piece.region not in FILLET_REGIONS.values():
        return PlaneLine(first, last), 0.0
    trace = np.diff(tooth.grid(piece.region, np.zeros(1), tooth.sections([0.0, 1.0])).points[0], axis=0)[0]
    if abs(trace[1]) > FACE_SLACK_MM:
        return _fit(tooth, piece, sections, tolerance)
    grid = link.grid(np.linspace(0.0, 1.0, PLACES_PER_INTERVAL + 1), sections)
    centre, radius = rounding(grid.points[:, 0], grid.normals[:, 0], unit(trace))
    miss = np.linalg.norm(grid.points[:, 0, :2] - centre[:2], axis=-1) - radius
    return _arc(centre[:2], first, last), float(np.abs(miss).max())


def _arc(centre: Array, first: Array, last: Array) -> PlaneArc:
    """Return the shorter arc about a centre between two points (2,)."""
    before, after = (np.arctan2(*(point - centre)[::-1]) for point in (first, last))
    width = (after - before + np.pi) % (2.0 * np.pi) - np.pi
    return PlaneArc(centre, float(np.linalg.norm(first - centre)), float(before), float(width))


def _fit(tooth: Tooth, piece: Piece, sections: Sections, tolerance: float) -> tuple[PlaneSpline, float]:
    """Return a piece of a generated link at one station as a cubic spline, and its deviation (mm)."""
    return section_spline(lambda s: piece.grid(tooth, s, sections).points[:, 0, :2], piece.region, tolerance)


def section_spline(exact: Callable[[Array], Array], what: str, tolerance: float) -> tuple[PlaneSpline, float]:
    """Fit a cubic spline to an `exact` curve, points (K, 2), mm, at s (K,) from 0 to 1, and return it with its deviation (mm).

    Raises NoSolutionError, which names the part `what` of the section, if the tolerance (mm) is not met.
    """
    allowed = TOLERANCE_SHARE * tolerance

    def excess(drawn: Array, wanted: Array) -> Array:
        return np.asarray(np.linalg.norm(drawn - wanted, axis=-1).max(axis=1) / allowed)

    nodes = plan(exact(samples())[:, None], excess, CUBIC_DEGREE)
    for turn in range(MAX_ROUNDS):
        wanted = exact(nodes.own(nodes.fine))
        spline = SplineCurve.through(nodes.y, wanted[::PLACES_PER_INTERVAL], CUBIC_DEGREE)
        miss = np.linalg.norm(spline(nodes.fine) - wanted, axis=-1)
        if miss.max() <= allowed:
            return PlaneSpline(spline.control, spline.knots), float(miss.max())
        if nodes.y.size > MAX_NODES:
            break
        nodes = nodes.spread(by_interval(miss) / allowed, turn)
    raise NoSolutionError(
        reason=f"the section of the {what} with {nodes.y.size} points deviates by {1000.0 * miss.max():.3g} um, more "
        f"than the {1000.0 * allowed:g} um allowed for a tolerance of {1000.0 * tolerance:g} um; choose a larger tolerance"
    )


def _openings(member: Member, z: float) -> list[_Bound]:
    """Return the contours of holes and other openings that the plane cuts."""
    return [
        (OPENING_CONTOURS[opening.region], opening.curves)
        for opening in member.openings
        if opening.low <= z < opening.high or z == opening.high == member.plain_body.ends[1]
    ]


def _circles(member: Member, z: float) -> list[_Bound]:
    """Return the contours of the body at z, from outside inwards: circles, and the bore in its form."""
    body, high = member.body, member.plain_body.ends[1]
    circles = []
    for (rho, start), (next_rho, end), band in zip(body.profile, body.profile[1:], body.bands, strict=False):
        # a plane on a step of the profile takes the section just above the step, at the upper end the section just below
        if min(start, end) < z <= max(start, end) if z == high else min(start, end) <= z < max(start, end):
            circles.append((rho + (z - start) / (end - start) * (next_rho - rho), band))
    bounds: list[_Bound] = []
    for radius, band in sorted(circles, reverse=True):
        if radius > 0.0:
            form = member.bore_form if band is Region.BORE else None
            circle = (PlaneArc.circle(radius),) if form is None else form.in_bore(radius)
            bounds.append((band.value, circle))
    return bounds
