"""Transverse sections of members: what a plane across the axis cuts, as closed contours of arcs, lines and cubic splines.

Lands, roots, rounded edges and all of the body are arcs about their centres and straight lines, as they are; flanks, fillets
and what else a tool generates become cubic splines through exact points, refined to a stated deviation, one for each smooth
piece. One tooth is drawn and turned. Points are (x, y), mm, in the member's own frame; contours go counterclockwise, whether
material is inside or not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from gearmesh.cad.bar import rounding
from gearmesh.cad.brep import NARROWEST, ROUNDS, Piece
from gearmesh.cad.contours.curves import DEGREE, Contour, PlaneSpline
from gearmesh.cad.nodes import MOST, STEP, by_interval, plan, samples
from gearmesh.errors import ArgumentError, DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.kernel.numeric.splines import SplineCurve
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.progress import tell
from gearmesh.teeth.end_strip import EndStrip, StripPiece
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLET_REGIONS, Region
from gearmesh.teeth.section import BottomLink, DrawnLink, GeneratedLink, Sections, TurnedLink
from gearmesh.teeth.tooth import Tooth

#: the contour round all teeth
TEETH = "teeth"
#: the contours of openings by the region of their walls
OPENINGS = {Region.HOLE: "holes", Region.BOLT: "bolts", Region.SPOKE: "spokes"}
#: share of the tolerance that splines keep at the places between their nodes where they are measured
SHARE = 0.9
#: z may be so far (mm) beyond an end face that it was meant to lie on
ON_FACE = 1e-9


@dataclass(frozen=True)
class MemberSection:
    """What the plane at z (mm) cuts of a member, at None that through its axis; `deviation` (mm): of its splines, between their
    nodes too."""

    name: str
    z: float | None
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
    tell(0.0)
    z = min(max(z, low), high)
    if member.tooth.joint.travel is not None:
        bar, deviation = _bar(member, z, tolerance)
        holes = [Contour(name, curves, False) for name, curves in _openings(member, z)]
        return MemberSection(member.name, z, (Contour(TEETH, bar, True), *holes), deviation)
    teeth, deviation = _outline(member, z, tolerance)
    circles = _circles(member, z)
    # from outside inwards material begins and ends; the teeth bound an external gear outside, an internal one inside
    bounds = [*circles, teeth] if blank.body.around else [teeth, *circles]
    contours = [Contour(name, curves, k % 2 == 0) for k, (name, curves) in enumerate(bounds)]
    contours += [Contour(name, curves, False) for name, curves in _openings(member, z)]
    return MemberSection(member.name, z, tuple(contours), deviation)


def _places(curve: PlaneCurve) -> Array:
    return curve.at(np.linspace(0.0, 1.0, STEP + 1))


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
    root = float(one[0].start[0])
    rooted = abs(one[0].end[0] - root) < NARROWEST
    middle = np.array([root, float(tooth.root_middle(np.array(z)))])
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
    for end, strip in enumerate(tooth.end_strips):
        edge, face = tooth.blank.extent[end], tooth.blank.faces[end]
        if strip is not None and (station - edge) * (face - edge) > 0.0:
            return _in_chamfer(strip, strip.tau(max((station - face) / (edge - face), 0.0)), tolerance)
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


def _in_chamfer(strip: EndStrip, tau: float, tolerance: float) -> tuple[list[PlaneCurve], float]:
    """The curves of one tooth at tau of the chamfer of an end face, and their deviation (mm)."""
    one, deviation = list[PlaneCurve](), 0.0
    for piece in strip.pieces:

        def exact(sigma: Array, piece: StripPiece = piece) -> Array:
            return strip.at(piece, sigma, np.full(sigma.size, tau))[:, :2]

        if np.linalg.norm(np.diff(exact(np.linspace(0.0, 1.0, STEP + 1)), axis=0), axis=-1).sum() <= NARROWEST:
            continue
        curve, miss = section_spline(exact, f"chamfer along the {piece.region}", tolerance)
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
    return section_spline(lambda s: piece.grid(tooth, s, sections).points[:, 0, :2], piece.region, tolerance)


def section_spline(exact: Callable[[Array], Array], what: str, tolerance: float) -> tuple[PlaneSpline, float]:
    """A cubic spline through points (K, 2), mm, of an `exact` curve at s (K,) from 0 to 1, within a tolerance (mm), and its
    deviation (mm). Raises NoSolutionError where that is not met, saying of what section."""
    allowed = SHARE * tolerance

    def excess(drawn: Array, wanted: Array) -> Array:
        return np.asarray(np.linalg.norm(drawn - wanted, axis=-1).max(axis=1) / allowed)

    nodes = plan(exact(samples())[:, None], excess, DEGREE)
    for turn in range(ROUNDS):
        wanted = exact(nodes.own(nodes.fine))
        spline = SplineCurve.through(nodes.y, wanted[::STEP], DEGREE)
        miss = np.linalg.norm(spline(nodes.fine) - wanted, axis=-1)
        if miss.max() <= allowed:
            return PlaneSpline(spline.control, spline.knots), float(miss.max())
        if nodes.y.size > MOST:
            break
        nodes = nodes.spread(by_interval(miss) / allowed, turn)
    raise NoSolutionError(
        reason=f"the section of the {what} with {nodes.y.size} points deviates by {1000.0 * miss.max():.3g} um, more "
        f"than the tolerance of {1000.0 * tolerance:g} um; choose a larger tolerance"
    )


def _openings(member: Member, z: float) -> list[_Bound]:
    """Holes and the like, where the plane meets them."""
    return [
        (OPENINGS[opening.region], opening.curves)
        for opening in member.openings
        if opening.low <= z < opening.high or z == opening.high == member.plain_body.ends[1]
    ]


def _circles(member: Member, z: float) -> list[_Bound]:
    """What bounds the body at z, from outside inwards: circles, and the bore with its keyway."""
    body, high = member.body, member.plain_body.ends[1]
    circles = []
    for (rho, start), (next_rho, end), band in zip(body.profile, body.profile[1:], body.bands, strict=False):
        # where the plane lies on a step of the profile, the section is that just above it, and below it at the end
        if min(start, end) < z <= max(start, end) if z == high else min(start, end) <= z < max(start, end):
            circles.append((rho + (z - start) / (end - start) * (next_rho - rho), band))
    bounds: list[_Bound] = []
    for radius, band in sorted(circles, reverse=True):
        if radius > 0.0:
            keyway = member.keyway if band is Region.BORE else None
            circle = (PlaneArc.circle(radius),) if keyway is None else keyway.in_bore(radius)
            bounds.append((band.value, circle))
    return bounds
