"""Undercut and pointing of a member's teeth: limits of the tool's depth and of the tip's height [LF04 17.9].

One section of a tooth, and of the tool that generates it:

        tooth                          tool
         ____  tip              B  ----------------  h2: generates the tip where the land is only s_a wide
        /    \\                  |
       /      \\        pitch plane ------------------
      /   A    \\                |
     /  limit   \\              A  ----------------  h1: generates the singular point
    /   fillet   \\               ================  form point: the tool's flank ends and its tip rounding begins

The flank is complete if the form point is above A. Otherwise the fillet cuts it off at their intersection. Heights are
those of the tool's profile, over the pitch plane if there is one; sections are those of the blank's stations.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.limiting_line import area_density, singular_at, zeros
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot, polar_angle
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.levels import LandLevel, Level, station_normal
from gearmesh.kernel.surface.stations import TrimError, along
from gearmesh.kernel.surface.surface import GeneratedSurface, Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import Sections
from gearmesh.teeth.tooth import PROOF_STATIONS, Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.teeth.undercut import cut_off, regularity
from gearmesh.tools.description import HeightZero

#: length beyond the form point in which the prolonged flank of the tool is searched, in flank lengths
PROLONGED_FLANK_LENGTHS = 3.0
#: length beyond the ends of the face in which its limits are searched, in face widths
PROLONGED_FACE_WIDTHS = 1.0
#: stations from toe to heel, by default
LIMIT_STATIONS = 5
#: pieces across a flank that measure the area of the tool's flank, to 1e-4 of it
AREA_PIECES = 16
#: stations along the face that measure it
AREA_STATIONS = 129
#: largest residual where a land has a given width
LAND_TOLERANCE_MM = 1e-10
#: smallest number of teeth that is tried for undercut
MIN_TEETH_TRIED = 3
#: largest number of teeth that is tried
MAX_TEETH_TRIED = 10_000

#: right and left flank of a tooth, each with its parameter p near the tip, at all stations or (T,) at each
Flanks = tuple[tuple[Surface, float | Array], tuple[Surface, float | Array]]


@dataclass(frozen=True)
class LostFlank:
    """Part of the tool's flank, from its form point to the tooth's tip, that generates nothing that remains.

    The tool's other parts cut it away, or it would stand beyond the singular points. Shares are 0 and `at` is NaN for a
    side without undercut. All are NaN if the tool is not known.
    """

    #: lost share of the flank's area over the face
    share: float
    #: share of the face width that is undercut
    face: float
    #: largest lost share of the flank's length across a station
    most: float
    #: coordinate of that station, mm
    at: float


@dataclass(frozen=True)
class SideLimits:
    """Limits of one side of a tooth at T stations; lengths in mm, NaN where a limit does not exist.

    For a rack, whose `joint` is a slide, radii are heights over its reference plane.
    """

    #: first parameter (T,) of the limiting line
    p: Array
    #: second parameter (T,) of the limiting line
    v: Array
    #: points (T, 3) of the limiting line, in the tool's frame
    on_tool: Array
    #: singular points (T, 3) of the tooth, in the member's frame
    on_tooth: Array
    #: depth (T,) of the limiting line below the pitch plane
    h1: Array
    #: depth (T,) of the tool's form point below the pitch plane; a tooth is undercut if it exceeds `h1`
    form_point_depth: Array
    #: height (T,) of the tool point that generates the tip where the land has the required width
    h2: Array
    #: True (T,) where the fillet cuts the flank off
    undercut: NDArray[np.bool_]
    #: radius (T,) at which the flank begins
    flank_radius: Array
    #: height (T,) of the tool's flank that generates nothing that remains
    lost: Array
    #: station, on the face or beyond it, at which undercut begins or ends; NaN if there is none
    undercut_from: float
    #: lost part of the tool's flank over the whole face
    lost_flank: LostFlank
    #: motion from one tooth to the next
    joint: Joint = REVOLUTE_JOINT

    @property
    def singular_radius(self) -> Array:
        """Radius (T,), mm, of the singular points."""
        return self.joint.radius(self.on_tooth)


@dataclass(frozen=True)
class MemberLimits:
    """Limits of a member at T stations; lengths in mm."""

    #: station coordinates (T,)
    stations: Array
    #: limits of the right side
    right: SideLimits
    #: limits of the left side
    left: SideLimits
    #: tip radius (T,) of the tooth
    tip_radius: Array
    #: width (T,) of its top land, along the arc
    top_land: Array
    #: tip radius (T,) at which the land, without broken edges, has the required width
    land_radius: Array
    #: height (T,) of that tip over the tip of the blank
    rise: Array
    #: station at which the land on the member's own tip has that width; NaN if there is none
    pointed_from: float
    #: smallest tooth number that the same rack cuts without undercut; None for other tools
    fewest_teeth: int | None

    @property
    def sides(self) -> dict[str, SideLimits]:
        return {"right": self.right, "left": self.left}


def member_limits(member: Member, land: float = 0.0, count: int = LIMIT_STATIONS) -> MemberLimits:
    """Compute undercut and pointing of a member at `count` stations; `land` s_a (mm) is the smallest allowed top land.

    Raises TrimError where the tooth itself cannot be trimmed.
    """
    tooth = member.tooth.unmodified_tooth
    t = np.linspace(0.0, 1.0, count)
    stations, sections = tooth.stations(t), tooth.sections(t)
    tip_radius = crossing(tooth.blank.tip, tooth.blank.axial, stations)[0]
    flanks = _flanks(tooth, t)
    right, left, points = land_of_width(flanks, tooth.blank.axial, tooth.blank.tip, stations, land, tooth.joint)
    return MemberLimits(
        stations=stations,
        right=_side(tooth, Side.RIGHT, sections, right),
        left=_side(tooth, Side.LEFT, sections, left),
        tip_radius=tip_radius,
        top_land=_arms(tooth.joint, tip_radius) * (sections.left.tip_angle - sections.right.tip_angle),
        land_radius=tooth.joint.radius(points),
        rise=tooth.blank.tip.value(points),
        pointed_from=pointed_station(tooth, land),
        fewest_teeth=fewest_teeth(tooth),
    )


def lost_heights(tooth: Tooth) -> dict[Side, float]:
    """Largest height (mm) along the face of the tool's flank that undercut removes, for each undercut side."""
    tooth = tooth.unmodified_tooth
    sections = tooth.sections(np.linspace(0.0, 1.0, PROOF_STATIONS))
    heights = {}
    for which in Side:
        side, begins = tooth.side(which), sections.of(which).form_point_flank
        form_point = np.full_like(begins, side.form_point[0])
        if _undercut(tooth, which, sections).any():
            heights[which] = float((side.tool.height(begins) - side.tool.height(form_point)).max())
    return heights


def lost_flank(tooth: Tooth, which: Side) -> LostFlank:
    """Part of a side's tool that undercut makes useless; NaN if the tooth cannot be trimmed at all stations."""
    tooth = tooth.unmodified_tooth
    side = tooth.side(which)
    if side.generation is None:
        return LostFlank(*(math.nan,) * 4)
    t = distinct(np.append(np.linspace(0.0, 1.0, AREA_STATIONS), tooth.breaks_of(which)))
    try:
        sections = tooth.sections(t)
    except TrimError:
        return LostFlank(*(math.nan,) * 4)
    cut = _undercut(tooth, which, sections)
    if not cut.any():
        return LostFlank(0.0, 0.0, 0.0, math.nan)
    ends, form_point = sections.of(which), np.full_like(t, side.form_point[0])
    begins = np.where(cut, ends.form_point_flank, form_point)
    (kept_length, kept_area), (lost_length, lost_area) = (
        _on_tool(side.generation[0], between, sections.stations, tooth.blank.axial)
        for between in ((ends.tip, begins), (begins, form_point))
    )
    share = lost_length / (kept_length + lost_length)
    # undercut ends at breaks, which are stations on the side that is not cut
    step, k = np.diff(t), int(np.argmax(share))
    return LostFlank(
        share=float(lost_area.sum() / (lost_area.sum() + kept_area.sum())),
        face=float(step[cut[:-1] | cut[1:]].sum()),
        most=float(share[k]),
        at=float(sections.stations[k]),
    )


def _on_tool(
    flank: GeneratedSurface, between: tuple[Array, Array], stations: Array, axial: Level
) -> tuple[Array, Array]:
    """Measure the tool's flank between two parameters (T,) at stations (T,).

    Returns its lengths (T,), mm, across, and its areas (T - 1,), mm^2, between neighbouring stations.
    """
    share = np.linspace(0.0, 1.0, AREA_PIECES + 1)[:, None]
    p = between[0] + share * (between[1] - between[0])
    v, _ = along(flank, p, stations, axial)
    r = flank.tool.jet(*flank.on_tool(p, v)).r
    one, other = r[1:, 1:] - r[:-1, :-1], r[1:, :-1] - r[:-1, 1:]
    area = 0.5 * np.linalg.norm(cross(one, other), axis=-1)
    return np.linalg.norm(np.diff(r, axis=0), axis=-1).sum(axis=0), area.sum(axis=0)


def undercut_margin(tooth: Tooth) -> float:
    """Smallest regularity of the flanks along the face: 0 where undercut begins, negative where the flanks are
    undercut.

    It is near 1 if the tool leaves as much area near the root as near the tip.
    """
    stations, axial = tooth.even.stations, tooth.blank.axial
    least = []
    for which in Side:
        side = tooth.side(which)
        tip = along(side.flank, tooth.near_tips(which, tooth.even.t), stations, axial)[1]
        least.append(regularity(side, tip, stations, axial).min())
    return float(min(least))


def _undercut(tooth: Tooth, which: Side, sections: Sections) -> NDArray[np.bool_]:
    """True (T,) at stations where undercut, not a corner of the tool, cuts a flank off."""
    side, stations, axial = tooth.side(which), sections.stations, tooth.blank.axial
    if not side.crossed:
        changed: NDArray[np.bool_] = sections.of(which).form_point_flank != side.form_point[0]
        return changed
    return cut_off(side, along(side.flank, tooth.near_tips(which, sections.t), stations, axial)[1], stations, axial)


def ways_to_limiting_line(tooth: Tooth, which: Side, count: int, steps: int) -> tuple[Array, Array]:
    """Points (steps, count, 3) and unit normals of a flank, from its tip to the singular points of its tool's limiting
    line.

    The flank is as its tool leaves it; the stations are even from toe to heel. NaN at stations without singular points.
    """
    tooth = tooth.unmodified_tooth
    side, t = tooth.side(which), np.linspace(0.0, 1.0, count)
    stations, start = tooth.stations(t), tooth.near_tips(which, t)
    p = start + np.linspace(0.0, 1.0, steps)[:, None] * (_singular(tooth, which, t) - start)
    points, normals = np.full((2, steps, count, 3), np.nan)
    known = np.isfinite(p)
    if known.any():
        jet = along(side.flank, p[known], np.broadcast_to(stations, p.shape)[known], tooth.blank.axial)[1]
        points[known], normals[known] = jet.r, jet.n
    return points, normals


def _singular(tooth: Tooth, which: Side, t: Array) -> Array:
    """Parameter p (T,) of the singular point nearest to the tip at t (T,), NaN if there is none."""
    side, start = tooth.side(which), tooth.near_tips(which, t)
    ends = start, start + _reach(side) * (side.form_point[0] - start)
    return singular_at(side.flank, ends, tooth.stations(t), tooth.blank.axial)


def _side(tooth: Tooth, which: Side, sections: Sections, p_land: Array) -> SideLimits:
    """Return the limits of one side; `p_land` (T,): flank parameter at which the land has the required width."""
    side, stations, axial = tooth.side(which), sections.stations, tooth.blank.axial
    form_point_flank, p = sections.of(which).form_point_flank, _singular(tooth, which, sections.t)
    v, on_tool, on_tooth = (np.full((*stations.shape, *shape), np.nan) for shape in ((), (3,), (3,)))
    known = np.isfinite(p)
    if known.any():
        v[known], jet = along(side.flank, p[known], stations[known], axial)
        on_tooth[known] = jet.r
        if side.generation is not None:
            flank = side.generation[0]
            on_tool[known] = flank.tool.jet(*flank.on_tool(p[known], v[known])).r
    pitch = pitch_height(tooth, side, stations)
    form_point = np.full_like(stations, side.form_point[0])
    begins = along(side.flank, form_point_flank, stations, axial)[1].r
    return SideLimits(
        p,
        v,
        on_tool,
        on_tooth,
        h1=pitch - side.tool.height(p),
        form_point_depth=pitch - side.tool.height(form_point),
        h2=side.tool.height(p_land) - pitch,
        undercut=_undercut(tooth, which, sections),
        flank_radius=tooth.joint.radius(begins),
        lost=side.tool.height(form_point_flank) - side.tool.height(form_point),
        undercut_from=undercut_station(tooth, side),
        lost_flank=lost_flank(tooth, which),
        joint=tooth.joint,
    )


def _arms(joint: Joint, rho: Array) -> Array:
    """Distance (T,), mm/rad, that points of radii rho (T,) move per radian of the joint."""
    return joint.arm(np.stack((rho, np.zeros_like(rho), np.zeros_like(rho)), axis=-1))


# ---------------------------------------------------------------- heights of the tool


def crossing(land: LandLevel, axial: Level, stations: Array) -> tuple[Array, Array]:
    """Circles of a land, or heights of a rack, at given station coordinates: (rho, z), mm, (T,) each."""
    surface = land.surface
    r = along(surface, np.zeros_like(stations), stations, axial, surface.meeting(axial, stations))[1].r
    return r[..., 0], r[..., 2]


def pitch_height(tooth: Tooth, side: ToothSide, stations: Array) -> Array:
    """Height (T,), mm, of the pitch plane on the tool's profile at stations (T,); NaN if there is none.

    Heights of a rack count from the pitch plane. Heights of a head cutter count from its tip plane, which envelopes the
    root cone: the pitch cone is above it by the dedendum of the station.
    """
    if side.tool.zero is HeightZero.PITCH_PLANE:
        return np.zeros_like(stations)
    if side.tool.zero is HeightZero.TIP_PLANE:
        # the stations of a bevel gear are cone distances
        s, c = station_normal(tooth.blank.axial)
        return tooth.blank.root.value(np.stack((s * stations, np.zeros_like(stations), c * stations), axis=-1))
    return np.full_like(stations, np.nan)


def _reach(side: ToothSide) -> float:
    """Length of the tool's profile from the tip downwards, in flank lengths from tip to form point."""
    share = np.linspace(0.0, 1.0 + PROLONGED_FLANK_LENGTHS, 400)
    height = side.tool.height(side.tip + share * (side.form_point[0] - side.tip))
    if np.isnan(height).all():
        return 1.0 + PROLONGED_FLANK_LENGTHS
    back = np.flatnonzero(~(np.diff(height) < 0.0))
    return float(share[back[0]]) if back.size else 1.0 + PROLONGED_FLANK_LENGTHS


# ---------------------------------------------------------------- undercut


def undercut_station(tooth: Tooth, side: ToothSide) -> float:
    """Station (mm) where the limiting line crosses the tool's form point, nearest to the middle of the face; NaN if
    there is none.

    The teeth are undercut on one side of it only. For a face gear it is the inner radius.
    """
    blank = tooth.blank
    ends = np.array(blank.extent)
    # zeros of the area density along the form point line, on the face and a face width beyond
    v, _ = along(side.flank, np.full(2, side.form_point[0]), ends, blank.axial)
    prolonged = PROLONGED_FACE_WIDTHS * (v[1] - v[0])
    low, high = np.array([v[0] - prolonged]), np.array([v[1] + prolonged])
    _, crossings = zeros(lambda x, k: area_density(side.flank.jet(np.full_like(x, side.form_point[0]), x)), low, high)
    if not crossings.size:
        return float("nan")
    at = blank.axial.value(side.flank.jet(np.full_like(crossings, side.form_point[0]), crossings).r)
    return float(at[np.argmin(np.abs(at - ends.mean()))])


def fewest_teeth(tooth: Tooth) -> int | None:
    """Smallest tooth number that the racks of both sides, at their depth, cut without undercut.

    Module, helix and cone angle stay, so that the pitch radius grows with the number. Teeth that a worm or disk grinds
    count as cut by the equivalent rack, without crowning. None in three cases:

    - another tool cuts the teeth.
    - the fillet is meant to cut the flank, as that of a protuberance is.
    - even MAX_TEETH_TRIED teeth are undercut.
    """
    if tooth.right.sharp or tooth.left.sharp:
        return None
    sides = (tooth.right, tooth.left)
    cut = [(side.tool.rack, side) for side in sides if side.tool.rack is not None]
    stations = tooth.stations(np.linspace(0.0, 1.0, LIMIT_STATIONS))

    def whole(teeth: int) -> bool:
        for rack, side in cut:
            rolled = Envelope(rack.surface, RackRoll(rack.radius * teeth / tooth.teeth))
            if np.isfinite(singular_at(rolled, (side.tip, side.form_point[0]), stations, tooth.blank.axial)).any():
                return False
        return True

    if len(cut) < len(sides) or not whole(MAX_TEETH_TRIED):
        return None
    # bisection: tooth numbers above the smallest sound one are sound, too
    _, fewest = last_true(
        lambda n, _: np.array([not whole(int(k)) for k in n]),
        np.array([MIN_TEETH_TRIED - 1]),
        np.array([MAX_TEETH_TRIED]),
    )
    return int(fewest[0])


# ---------------------------------------------------------------- pointing


def land_of_width(
    flanks: Flanks,
    axial: Level,
    tip: Level,
    stations: Array,
    width: float = 0.0,
    joint: Joint = REVOLUTE_JOINT,
) -> tuple[Array, Array, Array]:
    """Solve for the tip at which two flanks, prolonged, leave a top land of `width` (mm, arc in the section of the
    station).

    Returns parameters p (T,) of the right and the left flank, and the point (T, 3) of the right flank. They are NaN
    where the sound flanks do not reach so far. The lands are cones parallel to `tip`.
    """
    # start: the flanks at their nominal tip
    start = _at(flanks, axial, stations)

    def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (M, 4), mm, and Jacobian for (p, v) of both flanks: stations, equal height, width of the
        land.
        """
        right, left = _jets(flanks, x)
        arc, by_right, by_left = _arc(joint, right, left)
        level = tip.value(left.r) - tip.value(right.r)
        apart = axial.value(right.r) - stations[index], axial.value(left.r) - stations[index]
        f = np.stack((*apart, level, arc - width), axis=-1)
        jacobian = np.zeros((*f.shape, 4))
        jacobian[:, 0, :2], jacobian[:, 1, 2:] = _slopes(axial, right), _slopes(axial, left)
        jacobian[:, 2, :2], jacobian[:, 2, 2:] = -_slopes(tip, right), _slopes(tip, left)
        jacobian[:, 3, :2], jacobian[:, 3, 2:] = by_right, by_left
        return f, jacobian

    # trial steps may reach the axis, where there is no arc: the solver halves them
    with np.errstate(all="ignore"):
        solution = newton.solve(residual, start, tolerance=LAND_TOLERANCE_MM)
    sound = solution.converged.copy()
    for at_start, at_end in zip(_jets(flanks, start), _jets(flanks, solution.values), strict=True):
        # the physical root is not past a singular point of the flank: its area density keeps its sign
        sound &= area_density(at_start) * area_density(at_end) > 0.0
    x = np.where(sound[:, None], solution.values, np.nan)
    return (
        x[:, 0],
        x[:, 2],
        np.where(sound[:, None], flanks[0][0].jet(solution.values[:, 0], solution.values[:, 1]).r, np.nan),
    )


def pointed_station(tooth: Tooth, width: float = 0.0) -> float:
    """Station (mm), on the face or beyond it, where the land on the member's own tip is `width` (mm) wide; NaN if there
    is none.

    For a face gear it is the outer radius at which the land ends.
    """
    axial, tip = tooth.blank.axial, tooth.blank.tip
    ends = np.array(tooth.blank.extent)
    flanks = _flanks(tooth, np.array([0.0, 1.0]))
    start = _at(flanks, axial, ends)
    # widths of the land at both ends of the face: equal widths never reach another width
    lands = _arc(tooth.joint, *_jets(flanks, start))[0]
    if abs(lands[1] - lands[0]) <= 1e-9 * abs(lands).max():
        return float("nan")

    def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (M, 4), mm, and Jacobian for (p, v) of both flanks: tip level twice, equal station, width of
        the land.
        """
        right, left = _jets(flanks, x)
        arc, by_right, by_left = _arc(tooth.joint, right, left)
        f = np.stack(
            [tip.value(right.r), tip.value(left.r), axial.value(left.r) - axial.value(right.r), arc - width], axis=-1
        )
        jacobian = np.zeros((*f.shape, 4))
        jacobian[:, 0, :2], jacobian[:, 1, 2:] = _slopes(tip, right), _slopes(tip, left)
        jacobian[:, 2, :2], jacobian[:, 2, 2:] = -_slopes(axial, right), _slopes(axial, left)
        jacobian[:, 3, :2], jacobian[:, 3, 2:] = by_right, by_left
        return f, jacobian

    # start: the end of the face with the narrower land
    nearer = int(np.argmin(lands))
    solution = newton.solve(residual, start[nearer : nearer + 1], tolerance=LAND_TOLERANCE_MM)
    if not solution.converged[0]:
        return float("nan")
    at = float(axial.value(flanks[0][0].jet(solution.values[:, 0], solution.values[:, 1]).r)[0])
    return at if abs(at - ends.mean()) <= (0.5 + PROLONGED_FACE_WIDTHS) * (ends[1] - ends[0]) else float("nan")


def _flanks(tooth: Tooth, t: Array) -> Flanks:
    """Return both flanks with their parameter p near the tip at t (T,)."""
    right, left = ((tooth.side(which).flank, tooth.near_tips(which, t)) for which in Side)
    return right, left


def _at(flanks: Flanks, axial: Level, stations: Array) -> Array:
    """Return (p, v) of the right and the left flank, (T, 4), at their start parameters on stations (T,)."""
    columns = []
    for surface, p_start in flanks:
        p = np.full_like(stations, p_start)
        columns += [p, along(surface, p, stations, axial)[0]]
    return np.stack(columns, axis=-1)


def _jets(flanks: Flanks, x: Array) -> tuple[Jet, Jet]:
    """Return the jets (T,) of both flanks at parameters (T, 4)."""
    (right, _), (left, _) = flanks
    return right.jet(x[:, 0], x[:, 1]), left.jet(x[:, 2], x[:, 3])


def _arc(joint: Joint, right: Jet, left: Jet) -> tuple[Array, Array, Array]:
    """Arc (T,) on the right point's circle from the right to the left point, mm, and its derivatives (T, 2) by (p, v)
    of each flank.

    For a rack it is the distance along the bar.
    """
    if joint.travel is not None:
        ways = (np.stack((jet.r_u[:, 1], jet.r_v[:, 1]), axis=-1) for jet in (right, left))
        return left.r[:, 1] - right.r[:, 1], -next(ways), next(ways)
    rho = np.hypot(right.r[:, 0], right.r[:, 1])
    angle = polar_angle(left.r) - polar_angle(right.r)
    by_right, by_left = [], []
    for r_x in (right.r_u, right.r_v):
        growth = (right.r[:, 0] * r_x[:, 0] + right.r[:, 1] * r_x[:, 1]) / rho
        by_right.append(growth * angle - rho * _turn(right.r, r_x))
    for r_x in (left.r_u, left.r_v):
        by_left.append(rho * _turn(left.r, r_x))
    return rho * angle, np.stack(by_right, axis=-1), np.stack(by_left, axis=-1)


def _turn(r: Array, dr: Array) -> Array:
    """Change (...,) of the polar angle, rad, for a displacement dr of r."""
    return (r[..., 0] * dr[..., 1] - r[..., 1] * dr[..., 0]) / (r[..., 0] ** 2 + r[..., 1] ** 2)


def _slopes(level: Level, jet: Jet) -> Array:
    """Derivatives (T, 2) of a level by (p, v)."""
    gradient = level.gradient(jet.r)
    return np.stack((dot(gradient, jet.r_u), dot(gradient, jet.r_v)), axis=-1)
