"""Teeth as B-spline patches: quintic tensor-product splines through exact points, refined to a stated deviation.

A link of the section chain (see `tooth`) on a plane, cylinder or cone about the axis keeps this surface in CAD. Every other link
becomes a patch over (s, t), interpolated direction by direction at common nodes.

On the border of the grid, the interpolating spline is the spline through the border's points. Neighbouring patches have these
points, nodes and knots in common, so they share their border curves exactly. Where undercut begins, the form point of flank and
fillet has a corner in t: every patch is split there. A link with corners across is drawn piece by piece. The error falls with the
sixth power of the spacing.
"""

from __future__ import annotations

from dataclasses import field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from gearmesh.cad.nodes import MAX_NODES, PLACES_PER_INTERVAL, SPLINE_DEGREE, Nodes, by_interval, plan, samples
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.splines import control_net, knots_of, tensor_product
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.kernel.surface.stations import along
from gearmesh.records import dataclass
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import GeneratedLink, Grid, Sections, breaks
from gearmesh.teeth.tooth import Tooth

#: default of the largest deviation
DEFAULT_TOLERANCE_MM = 1e-4
#: share of the tolerance within which each direction alone must stay
TOLERANCE_SHARE = 0.45
#: largest distance of border curves from their planes, cylinders and cones: CAD programs refit edges that are 1e-7 mm away, and
#: the refitted solid is less exact
LEVEL_TOLERANCE_MM = 5e-8
#: rounds of measuring deviations and placing nodes; samples need three at most
MAX_ROUNDS = 12
#: least width of a link that has a face; the root between full fillets is narrower
MIN_LINK_WIDTH_MM = 1e-6
#: largest winding along the face of a land or root on a cylinder: CAD cuts cylinders open along a generatrix
MAX_WINDING_RAD = np.pi
#: largest number of steps to the ends of a crease
MAX_CREASE_STEPS = 60
#: change of the stations of these ends that is rounding
CREASE_ROUNDING = 1e-14
#: places across the planned direction at which links are sampled
PLANNED_PLACES = np.array([0.0, 0.5, 1.0])


@dataclass(frozen=True)
class Piece:
    """A link of the chain, or a smooth piece of it: s from `low` to `high`."""

    region: Region
    low: float = 0.0
    high: float = 1.0

    @staticmethod
    def of(tooth: Tooth, region: Region) -> list[Piece]:
        """Return the smooth pieces of a link, in its direction."""
        places = [0.0, *breaks(tooth.chain[region]).tolist(), 1.0]
        return [Piece(region, low, high) for low, high in pairwise(places)]

    def grid(self, tooth: Tooth, s: Array, sections: Sections) -> Grid:
        """Return `Tooth.grid` of the piece, for s from 0 to 1 over the piece."""
        return tooth.grid(self.region, self.own(s), sections)

    def own(self, s: Array) -> Array:
        """Convert s of the piece to s of the link."""
        if (self.low, self.high) == (0.0, 1.0):
            return s
        # exactly on the ends, never beyond them: the neighbouring piece begins there
        return np.where(s >= 1.0, self.high, self.low + s * (self.high - self.low))


@dataclass(frozen=True)
class _Bound:
    """A line across a tooth at which patches are split: a station, or a crease aslant across fillets and flanks."""

    #: station t; of a crease that of the root
    t: float
    #: second surface parameter of a crease; None for a station
    v: float | None = None

    def is_slanted(self, tooth: Tooth, region: Region) -> bool:
        """Return True if the line is aslant across a link."""
        return self.v is not None and isinstance(tooth.chain[region], GeneratedLink)

    def places(self, tooth: Tooth, region: Region, s: Array) -> Array:
        """Return stations t (S,) at which the line crosses the lines s (S,) of a link."""
        if not self.is_slanted(tooth, region):
            return np.full(s.size, self.t)
        link = tooth.chain[region]
        assert link.surface is not None
        (toe, heel), v = tooth.blank.extent, np.full(2, self.v)
        t, ends = np.full(2, self.t), np.zeros(2)
        # ends of the link move along the face beyond a crease
        for _ in range(MAX_CREASE_STEPS):
            first, last = link.span(tooth.sections(t))
            ends = np.array([first[0], last[1]])
            before, t = t, (link.surface.jet(ends, v).r[:, 2] - toe) / (heel - toe)
            if np.abs(t - before).max() <= CREASE_ROUNDING:
                break
        p = ends[0] + s * (ends[1] - ends[0])
        return np.asarray((link.surface.jet(p, np.full(s.size, self.v)).r[:, 2] - toe) / (heel - toe))


@dataclass(frozen=True)
class _Span:
    """The part of a tooth between two bounds, with places y from 0 to 1 along each line s."""

    #: exact tooth
    tooth: Tooth
    #: bound nearer to the toe
    low: _Bound
    #: bound nearer to the heel
    high: _Bound

    def sections(self, y: Array) -> Sections:
        """Return the sections at places y (T,) between the stations of the bounds."""
        return self.tooth.sections(self.low.t + (self.high.t - self.low.t) * y)

    def points(self, piece: Piece, s: Array, y: Array, sections: Sections | None = None) -> Array:
        """Return exact points (S, T, 3), mm, of a link at s (S,) and y (T,); `sections`: those at y, if they are known."""
        tooth, region = self.tooth, piece.region
        if not (self.low.is_slanted(tooth, region) or self.high.is_slanted(tooth, region)):
            return piece.grid(tooth, s, sections or self.sections(y)).points
        link = tooth.chain[region]
        assert isinstance(link, GeneratedLink)
        low, high = (bound.places(tooth, region, np.concatenate((s, [0.0, 1.0]))) for bound in (self.low, self.high))
        t = low[:, None] + (high - low)[:, None] * y
        # the ends of the link at the same y: at the same t they would have a corner where they pass the crease
        first, last = (link.span(tooth.sections(t[row]))[end] for end, row in ((0, -2), (1, -1)))
        p = first + s[:, None] * (last - first)
        return np.asarray(along(link.surface, p, tooth.stations(t[:-2]), link.axial)[1].r)


@dataclass(frozen=True)
class Patch:
    """A clamped spline for one link, or a piece of it, between two breaks; its parameters go from 0 to 1, before the bends."""

    #: link or piece
    piece: Piece
    #: control net (S, T, 3), mm
    control: Array
    #: S nodes along the chain, with their bend
    s: Nodes
    #: T nodes from toe to heel, with their bend
    t: Nodes
    #: knots (S + 6,) along the chain
    s_knots: Array
    #: knots (T + 6,) from toe to heel
    t_knots: Array
    #: span of the tooth's t
    between: tuple[float, float]

    @property
    def region(self) -> Region:
        return self.piece.region

    def at(self, s: Array, t: Array) -> Array:
        """Return points (s.size, t.size, 3) of the spline."""
        return tensor_product((self.s_knots, self.t_knots), self.control, (s, t))

    def of_tooth(self, s: Array, t: Array) -> tuple[Array, Array]:
        """Convert parameters of the spline to s of the link and t of the tooth."""
        low, high = self.between
        return self.piece.own(self.s.own(s)), low + (high - low) * self.t.own(t)


@dataclass(frozen=True)
class StripPatch:
    """A clamped spline for a piece of the chamfer of an end face."""

    #: control net (S, T, 3), mm, T from the outline of the end face to the section under it
    control: Array
    #: knots along the chain, from 0 to the last parameter of the curve on the section
    s_knots: Array
    #: knots from the outline to the section
    t_knots: Array
    #: 0 at the toe, 1 at the heel
    end: int
    #: number of the tooth's link on which the patch lies, None for a patch at a corner
    link: int | None
    #: number of the link at whose beginning the patch begins
    column: int
    #: True if the patch is a point in the outline
    pointed: bool
    #: largest deviation, mm
    deviation: float

    @property
    def net(self) -> tuple[Array, Array, Array]:
        """Control net from toe to heel, and the knots."""
        return (self.control[:, ::-1] if self.end else self.control), self.s_knots, self.t_knots


@dataclass(frozen=True)
class SplineTooth:
    """The faces of one tooth, or of a space between teeth."""

    #: the exact tooth
    tooth: Tooth
    #: t (G + 1,) at which patches are split, from toe to heel
    bounds: Array
    #: links of the chain, or pieces of them, that have a width
    links: tuple[Piece, ...]
    #: patches, from toe to heel, of each link that is no surface of revolution
    patches: dict[Piece, tuple[Patch, ...]]
    #: points (L, G + 1, 3) where links begin at the bounds, mm
    corners: Array
    #: largest distance (mm), for each link with patches, of spline points from exact points of the same parameters; measured
    #: between the nodes, it bounds the distance of the surfaces and of their borders
    deviation: dict[Piece, float]
    #: the row in which the tooth stands
    half: HalfGear = field(default_factory=HalfGear)
    #: True for a space, whose last link ends where its first link begins
    closed: bool = False
    #: chamfers at toe and heel
    strips: tuple[tuple[StripPatch, ...], tuple[StripPatch, ...]] = ((), ())

    @property
    def largest_deviation(self) -> float:
        """Largest deviation (mm) of all patches."""
        return max(*self.deviation.values(), *(patch.deviation for strip in self.strips for patch in strip))

    @property
    def count(self) -> int:
        """Number of such teeth or spaces in the part."""
        return 1 if self.closed else self.tooth.teeth

    @property
    def step(self) -> float:
        """Angle (rad) from the beginning of the first link to the end of the last link."""
        return 0.0 if self.closed else self.tooth.pitch_angle

    def corner(self, i: int, row: int) -> Array:
        """Return the point (3,), mm, where link i of tooth 1 begins at a bound; i may be one beyond the last link."""
        if i < len(self.links):
            return np.asarray(self.corners[i, row])
        return Rigid.about_z(self.step).point(self.corners[0, row])

    def arc_width(self, i: int, row: int) -> float:
        """Return the angle (rad) from beginning to end of link i at a bound, between -pi and pi."""
        start, end = (float(np.arctan2(r[1], r[0])) for r in (self.corner(k, row) for k in (i, i + 1)))
        return float(REVOLUTE_JOINT.within(np.array(end - start)))

    def place(self, half: HalfGear) -> SplineTooth:
        """Return the tooth of the first row placed in another row, from this row's toe to its heel."""
        patches = {
            link: tuple(replace(patch, control=half.points(patch.control)) for patch in row)
            for link, row in self.patches.items()
        }
        toe, heel = (
            tuple(replace(patch, control=half.points(patch.control)) for patch in strip) for strip in self.strips
        )
        return replace(self, patches=patches, corners=half.points(self.corners), half=half, strips=(toe, heel))

    def level(self, link: Piece) -> ConeLevel:
        """Return the plane, cylinder or cone of a link without patches."""
        return _level(self.tooth, link)

    @cached_property
    def outward(self) -> bool:
        """True if the direction along the chain times the direction from toe to heel points out of the material.

        For a space it points out of the space.
        """
        sections = self.tooth.sections(np.array([0.49, 0.5, 0.51]))
        grid = self.tooth.grid(Region.FLANK_RIGHT, np.array([0.49, 0.5, 0.51]), sections)
        along, up = grid.points[2, 1] - grid.points[0, 1], grid.points[1, 2] - grid.points[1, 0]
        return bool(self.half.hand_sign * dot(cross(along, up), grid.normals[1, 1]) > 0.0) != self.closed


def spline_tooth(tooth: Tooth, tolerance: float = DEFAULT_TOLERANCE_MM) -> SplineTooth:
    """Fit patches to one tooth within `tolerance` (mm) of its exact surfaces.

    Raises TrimError for a tooth that cannot be trimmed, NoSolutionError if the tolerance is not met.
    """
    creases = [_Bound(*crease) for crease in tooth.slanted_breaks]
    straight = np.setdiff1d(tooth.breaks, tooth.face_breaks) if creases else tooth.breaks
    inner = sorted([*creases, *(_Bound(t) for t in straight.tolist())], key=lambda line: line.t)
    lines = [_Bound(0.0), *inner, _Bound(1.0)]
    bounds = np.array([line.t for line in lines])
    ends = tooth.sections(bounds)
    links = _links(tooth, ends)
    spans = [_Span(tooth, low, high) for low, high in pairwise(lines)]
    patches: dict[Piece, tuple[Patch, ...]] = {}
    deviation: dict[Piece, float] = {}
    for run in _runs(tooth, links):
        for link, (drawn, miss) in _Run(tooth, run, spans, tolerance).fit().items():
            patches[link], deviation[link] = drawn, miss
    corners = np.array([link.grid(tooth, np.zeros(1), ends).points[0] for link in links])
    if tooth.slanted_breaks:
        corners = _slanted_corners(spans, links, patches)
    return SplineTooth(tooth, bounds, links, patches, corners, deviation)


def _slanted_corners(spans: list[_Span], links: tuple[Piece, ...], patches: dict[Piece, tuple[Patch, ...]]) -> Array:
    """Return the points (L, G + 1, 3), mm, where links begin at bounds that are aslant."""
    corners = []
    for before, link in zip((links[-1], *links[:-1]), links, strict=True):
        # a turned link begins where the link before it ends
        piece, s = (link, 0.0) if link in patches or link is links[0] else (before, 1.0)
        rows = [
            span.points(piece, np.array([s]), np.array([y]))[0, 0]
            for span, y in (*((each, 0.0) for each in spans), (spans[-1], 1.0))
        ]
        corners.append(rows)
    return np.array(corners)


def exact_volume(member: Member) -> float:
    """Return the volume (mm^3) of a member with hub, keyway and holes, from exact sections (`Tooth.volume`) and closed forms."""
    plain, body = member.plain_body, member.body
    # replace the volume between the plain body and the axis by the volume between hub or bore and the axis
    volume = member.plain_volume() + plain.cut_off() - body.cut_off()
    for outline, low, high in member.prisms:
        volume -= (high - low) * sum(curve.swept for curve in outline)
    return float(volume)


def _links(tooth: Tooth, sections: Sections) -> tuple[Piece, ...]:
    """Return the links of the chain that have a width, piece by piece."""
    ends = {region: tooth.grid(region, np.array([0.0, 1.0]), sections).points for region in tooth.regions}
    widths = {region: np.linalg.norm(points[1] - points[0], axis=-1).max() for region, points in ends.items()}
    wide = [region for region in tooth.regions if widths[region] > MIN_LINK_WIDTH_MM]
    return tuple(piece for region in wide for piece in Piece.of(tooth, region))


def _level(tooth: Tooth, link: Piece) -> ConeLevel:
    cone = tooth.chain[link.region].cone
    assert cone is not None
    return cone


def _is_turned(tooth: Tooth, link: Piece) -> bool:
    """Return True for a land or root on a plane, cylinder or cone that does not wind round the axis."""
    if tooth.chain[link.region].cone is None:
        return False
    angles = link.grid(tooth, np.array([0.0, 1.0]), tooth.sections(samples())).p
    return angles is not None and float(np.ptp(angles)) < MAX_WINDING_RAD


@dataclass(frozen=True)
class _Stretch:
    """Neighbouring spline links, and the surfaces of the turned links before and after them, None without turned links."""

    links: tuple[Piece, ...]
    before: ConeLevel | None
    after: ConeLevel | None


def _runs(tooth: Tooth, links: tuple[Piece, ...]) -> list[_Stretch]:
    """Divide the chain at its turned links: neighbouring parts meet in curves on planes, cylinders or cones."""
    turned = [i for i, link in enumerate(links) if _is_turned(tooth, link)]
    if not turned:
        return [_Stretch(links, None, None)]
    runs = []
    for first, last in zip(turned, [*turned[1:], turned[0] + len(links)], strict=True):
        inside = tuple(links[i % len(links)] for i in range(first + 1, last))
        runs.append(_Stretch(inside, _level(tooth, links[first]), _level(tooth, links[last % len(links)])))
    return runs


@dataclass(frozen=True)
class _Miss:
    """Deviation of a patch: the largest (mm), and the largest of every interval across and along, over the allowed deviation."""

    largest: float
    across: Array
    along: Array


@dataclass(frozen=True)
class _Run:
    """Fit of the patches of neighbouring links, which share their nodes along the face."""

    #: the exact tooth
    tooth: Tooth
    #: the links, and the surfaces beside them
    run: _Stretch
    #: parts between bounds
    spans: list[_Span]
    #: allowed deviation, mm
    tolerance: float

    def fit(self) -> dict[Piece, tuple[tuple[Patch, ...], float]]:
        """Return the patches of each link, and its deviation (mm)."""
        # plan the nodes of each direction alone, then measure the patches and place more nodes where they deviate
        along = [self._planned_along(span) for span in self.spans]
        across = {link: self._planned_across(link) for link in self.run.links}
        for turn in range(MAX_ROUNDS):
            patches, misses = self._measure(across, along)
            largest = {link: max(miss.largest for miss in link_misses) for link, link_misses in misses.items()}
            worst = {
                link: np.max([miss.across for miss in link_misses], axis=0) for link, link_misses in misses.items()
            }
            worst_along = [np.max([misses[link][g].along for link in across], axis=0) for g in range(len(along))]
            excess = max(float(miss_across.max()) for miss_across in (*worst.values(), *worst_along))
            met = max(largest.values()) <= self.tolerance
            if met and excess <= 1.0:
                return {link: (tuple(patches[link]), largest[link]) for link in across}
            # if each direction alone is within its share and only their sum is not, refine both
            enough = 1.0 if excess > 1.0 else 0.0
            across = {
                link: nodes.spread(worst[link], turn) if worst[link].max() > enough else nodes
                for link, nodes in across.items()
            }
            along = [
                nodes.spread(miss_along, turn) if miss_along.max() > enough else nodes
                for nodes, miss_along in zip(along, worst_along, strict=True)
            ]
            most = max(nodes.y.size for nodes in (*across.values(), *along))
            if most > MAX_NODES:
                break
        # the deviation is known at nodes and some places between them, where a share of the tolerance is allowed
        allowed = TOLERANCE_SHARE * self.tolerance
        missed = max(*largest.values(), excess * allowed)
        raise NoSolutionError(
            reason=f"B-spline faces of {max(nodes.y.size for nodes in across.values())} x "
            f"{max(nodes.y.size for nodes in along)} points deviate by {1000.0 * missed:.3g} um, more than the "
            f"{1000.0 * allowed:g} um allowed for a tolerance of {1000.0 * self.tolerance:g} um; choose a larger "
            f"tolerance, from about {1100.0 * missed / TOLERANCE_SHARE:.2g} um on"
        )

    def _measure(
        self, across: dict[Piece, Nodes], along: list[Nodes]
    ) -> tuple[dict[Piece, list[Patch]], dict[Piece, list[_Miss]]]:
        patches: dict[Piece, list[Patch]] = {link: [] for link in across}
        misses: dict[Piece, list[_Miss]] = {link: [] for link in across}
        for g, (nodes, span) in enumerate(zip(along, self.spans, strict=True)):
            y = nodes.own(nodes.fine)
            sections = span.sections(y)
            for link, s in across.items():
                exact = span.points(link, s.own(s.fine), y, sections)
                patch = _patch(link, exact[::PLACES_PER_INTERVAL, ::PLACES_PER_INTERVAL], s, nodes, span)
                patches[link].append(patch)
                misses[link].append(self._miss(link, g, patch.at(s.fine, nodes.fine), exact))
        return patches, misses

    def _miss(self, link: Piece, g: int, drawn: Array, exact: Array) -> _Miss:
        """Return the deviation of drawn points (4 S + 1, 4 T + 1, 3), at the nodes and between them, in span g."""
        miss = np.linalg.norm(drawn - exact, axis=-1)
        allowed = TOLERANCE_SHARE * self.tolerance
        across = miss[:, ::PLACES_PER_INTERVAL].max(axis=1) / allowed
        along = miss[::PLACES_PER_INTERVAL].max(axis=0) / allowed
        for end in (0, -1):
            if g in (0, len(self.spans) - 1) and g == end % len(self.spans):
                across = np.maximum(across, self._off_station(drawn[:, end], end))
            along = np.maximum(along, self._off_level(link, drawn[end], end))
        return _Miss(float(miss.max()), by_interval(across), by_interval(along))

    def _planned_across(self, link: Piece) -> Nodes:
        y = np.array([0.0, 0.5, 1.0])
        points = np.concatenate([span.points(link, samples(), y) for span in self.spans], axis=1)

        def excess(drawn: Array, exact: Array) -> Array:
            off = np.linalg.norm(drawn - exact, axis=-1).max(axis=1) / (TOLERANCE_SHARE * self.tolerance)
            for end in (0, -1):
                off = np.maximum(off, self._off_station(drawn[:, end], end))
            return np.asarray(off)

        return plan(points, excess)

    def _planned_along(self, span: _Span) -> Nodes:
        sections, links = span.sections(samples()), self.run.links
        drawn_links = [span.points(link, PLANNED_PLACES, samples(), sections) for link in links]
        points = np.concatenate(drawn_links).swapaxes(0, 1)

        def excess(drawn: Array, exact: Array) -> Array:
            off = np.linalg.norm(drawn - exact, axis=-1).max(axis=1) / (TOLERANCE_SHARE * self.tolerance)
            for end in (0, -1):
                off = np.maximum(off, self._off_level(links[end], drawn[:, end], end))
            return np.asarray(off)

        return plan(points, excess)

    def _off_station(self, points: Array, end: int) -> Array:
        """Return distances (K,) of a curve (K, 3) on toe (0) or heel (-1) from its station, over the allowed distance."""
        blank = self.tooth.blank
        return np.asarray(np.abs(blank.axial.value(points) - blank.extent[end]) / LEVEL_TOLERANCE_MM)

    def _off_level(self, link: Piece, points: Array, end: int) -> Array:
        """Return distances (K,) of a link's first (0) or last (-1) border from the turned link beside it, over the allowed one."""
        level = self.run.after if end else self.run.before
        if level is None or link != self.run.links[end]:
            return np.zeros(len(points))
        return np.asarray(np.abs(level.value(points)) / LEVEL_TOLERANCE_MM)


def _patch(piece: Piece, points: Array, s: Nodes, t: Nodes, span: _Span) -> Patch:
    """Return the spline through points (S, T, 3) at nodes s, t."""
    knots = knots_of(s.y, SPLINE_DEGREE), knots_of(t.y, SPLINE_DEGREE)
    return Patch(piece, control_net((s.y, t.y), points, knots), s, t, *knots, (span.low.t, span.high.t))
