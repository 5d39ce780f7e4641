"""Teeth as B-spline patches: quintic tensor-product splines through exact points, refined to a stated deviation.

A link of the section chain (see `tooth`) whose surface is a plane, cylinder or cone about the axis is left to CAD as such;
every other becomes a patch over (s, t), interpolated direction by direction at common nodes. A spline that interpolates a
grid is, on the grid's border, the spline through the border's points; neighbours have these points, nodes and knots in
common and so share their border curves exactly. Where undercut begins the form point of flank and fillet has a corner in t:
there every patch is split. Where a link is not smooth across, it is drawn piece by piece. The error falls with the sixth power of
the spacing.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from gearmesh.cad.nodes import DEGREE, MOST, STEP, Nodes, by_interval, plan, samples
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.splines import control_net, knots_of, tensor_product
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.teeth.blank.halves import HalfGear
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Grid, Sections, breaks
from gearmesh.teeth.tooth import Tooth

#: largest deviation (mm) if none is asked for
TOLERANCE = 1e-4
#: nodes are added until each direction alone stays within this share of the tolerance
SHARE = 0.45
#: curves on planes, cylinders and cones keep this close (mm) to them, whatever the tolerance: CAD programs take points within
#: 1e-7 mm for the same and fit edges that are farther off anew, less exactly (read back, the error of the volume was 1e-6
#: instead of 1e-8)
ON_LEVEL = 5e-8
#: rounds of measuring and spreading nodes: on the samples 1 after the plan is usual, and 3 the most
ROUNDS = 12
#: a link narrower than this (mm) all along the face, as the root between full fillets, is no face
NARROWEST = 1e-6
#: a land or root that winds farther than this (rad) along the face, as a worm's, stays a spline: CAD cuts cylinders open
#: along a generatrix
WINDING = np.pi
#: where links are sampled in the direction across that in which nodes are planned
ACROSS = np.array([0.0, 0.5, 1.0])


@dataclass(frozen=True)
class Piece:
    """A link of the chain, or what of it is smooth across: s from `low` to `high`."""

    region: Region
    low: float = 0.0
    high: float = 1.0

    @staticmethod
    def of(tooth: Tooth, region: Region) -> list[Piece]:
        """The pieces of a link, in its direction."""
        places = [0.0, *breaks(tooth.chain[region]).tolist(), 1.0]
        return [Piece(region, low, high) for low, high in pairwise(places)]

    def grid(self, tooth: Tooth, s: Array, sections: Sections) -> Grid:
        """As `Tooth.grid`, s from 0 to 1 over the piece."""
        return tooth.grid(self.region, self.own(s), sections)

    def own(self, s: Array) -> Array:
        """s of the link, of the piece's."""
        if (self.low, self.high) == (0.0, 1.0):
            return s
        # on its very ends, and never beyond: there the other piece begins
        return np.where(s >= 1.0, self.high, self.low + s * (self.high - self.low))


@dataclass(frozen=True)
class Patch:
    """One link, or piece of it, between two breaks: control net (S, T, 3), mm, and knots (S + 6,), (T + 6,) of a clamped spline.

    `s` (S nodes) and `t` (T nodes) have their bends; the spline's own parameters, both from 0 to 1, are those before the bend.
    `between` is the span of the tooth's t.
    """

    piece: Piece
    control: Array
    s: Nodes
    t: Nodes
    s_knots: Array
    t_knots: Array
    between: tuple[float, float]

    @property
    def region(self) -> Region:
        return self.piece.region

    def at(self, s: Array, t: Array) -> Array:
        """Points (s.size, t.size, 3) of the spline."""
        return tensor_product((self.s_knots, self.t_knots), self.control, (s, t))

    def of_tooth(self, s: Array, t: Array) -> tuple[Array, Array]:
        """The link's own s and the tooth's t that belong to the spline's parameters."""
        low, high = self.between
        return self.piece.own(self.s.own(s)), low + (high - low) * self.t.own(t)


@dataclass(frozen=True)
class StripPatch:
    """A patch of the chamfer at the toe (`end` 0) or heel (1): control net (S, T, 3), mm, T from the outline of the end face to the
    section under it, and knots of clamped splines, those along the chain from 0 to the last parameter of the curve beneath.

    `link`: the tooth's link that it lies on, or None where it goes out from a corner, that where the link numbered `column` begins.
    `pointed`: in the outline it is a point. `deviation`: the largest, mm.
    """

    control: Array
    s_knots: Array
    t_knots: Array
    end: int
    link: int | None
    column: int
    pointed: bool
    deviation: float

    @property
    def net(self) -> tuple[Array, Array, Array]:
        """Control net from toe to heel, and the knots."""
        return (self.control[:, ::-1] if self.end else self.control), self.s_knots, self.t_knots


@dataclass(frozen=True)
class SplineTooth:
    """One tooth's faces: `links` of the chain, or their pieces, that have a width, and the `patches` of each that is no surface of
    revolution.

    Patches are counted from toe to heel, split at `bounds` (G + 1,). `corners` (L, G + 1, 3), mm, is where links begin at the
    bounds. `deviation` (mm) for each link with patches: the largest distance, measured between the nodes, of spline points
    from the exact points of the same parameters, which bounds that of the surfaces and of their borders. `half`: the row that it
    stands in. `closed`: of a space, whose last link ends where its first begins. `strips`: the chamfers at toe and heel.
    """

    tooth: Tooth
    bounds: Array
    links: tuple[Piece, ...]
    patches: dict[Piece, tuple[Patch, ...]]
    corners: Array
    deviation: dict[Piece, float]
    half: HalfGear = field(default_factory=HalfGear)
    closed: bool = False
    strips: tuple[tuple[StripPatch, ...], tuple[StripPatch, ...]] = ((), ())

    @property
    def largest_deviation(self) -> float:
        """The largest deviation (mm) of all patches."""
        return max(*self.deviation.values(), *(patch.deviation for strip in self.strips for patch in strip))

    @property
    def count(self) -> int:
        """How many of them go round."""
        return 1 if self.closed else self.tooth.teeth

    @property
    def step(self) -> float:
        """Angle (rad) from where the first link begins to where the last one ends."""
        return 0.0 if self.closed else self.tooth.pitch_angle

    def corner(self, i: int, row: int) -> Array:
        """Where link i of tooth 1, or the one after the last, begins at one of the bounds, (3,), mm."""
        if i < len(self.links):
            return np.asarray(self.corners[i, row])
        return Rigid.about_z(self.step).point(self.corners[0, row])

    def arc_width(self, i: int, row: int) -> float:
        """Angle (rad) from where link i begins to where it ends at one of the bounds, less than half a turn either way."""
        start, end = (float(np.arctan2(r[1], r[0])) for r in (self.corner(k, row) for k in (i, i + 1)))
        return float(REVOLUTE_JOINT.within(np.array(end - start)))

    def place(self, half: HalfGear) -> SplineTooth:
        """The first half's tooth in another row, from its own toe to its heel."""
        patches = {
            link: tuple(replace(patch, control=half.points(patch.control)) for patch in row)
            for link, row in self.patches.items()
        }
        toe, heel = (
            tuple(replace(patch, control=half.points(patch.control)) for patch in strip) for strip in self.strips
        )
        return replace(self, patches=patches, corners=half.points(self.corners), half=half, strips=(toe, heel))

    def level(self, link: Piece) -> ConeLevel:
        """The plane, cylinder or cone that a link without patches lies on."""
        return _level(self.tooth, link)

    @cached_property
    def outward(self) -> bool:
        """Whether the vector product of the directions along the chain and from toe to heel leaves the material, of a space
        that of the space."""
        sections = self.tooth.sections(np.array([0.49, 0.5, 0.51]))
        grid = self.tooth.grid(Region.FLANK_RIGHT, np.array([0.49, 0.5, 0.51]), sections)
        along, up = grid.points[2, 1] - grid.points[0, 1], grid.points[1, 2] - grid.points[1, 0]
        return bool(self.half.hand_sign * dot(cross(along, up), grid.normals[1, 1]) > 0.0) != self.closed


def spline_tooth(tooth: Tooth, tolerance: float = TOLERANCE) -> SplineTooth:
    """Patches of one tooth within `tolerance` (mm) of its exact surfaces.

    Raises TrimError where the tooth cannot be trimmed, NoSolutionError where the tolerance is not met.
    """
    bounds = np.concatenate(([0.0], tooth.breaks, [1.0]))
    ends = tooth.sections(bounds)
    links = _links(tooth, ends)
    spans = list(zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True))
    patches: dict[Piece, tuple[Patch, ...]] = {}
    deviation: dict[Piece, float] = {}
    for run in _runs(tooth, links):
        for link, (drawn, miss) in _Run(tooth, run, spans, tolerance).fit().items():
            patches[link], deviation[link] = drawn, miss
    corners = np.array([link.grid(tooth, np.zeros(1), ends).points[0] for link in links])
    return SplineTooth(tooth, bounds, links, patches, corners, deviation)


def exact_volume(member: Member) -> float:
    """Volume (mm^3) of a member with hub, keyway and holes, from exact sections (`Tooth.volume`) and closed forms."""
    plain, body = member.plain_body, member.body
    # both cut off what is between them and the axis
    volume = member.plain_volume() + plain.cut_off() - body.cut_off()
    for outline, low, high in member.prisms:
        volume -= (high - low) * sum(curve.swept for curve in outline)
    return float(volume)


def _links(tooth: Tooth, sections: Sections) -> tuple[Piece, ...]:
    """The links of the chain that have a width, piece by piece."""
    ends = {region: tooth.grid(region, np.array([0.0, 1.0]), sections).points for region in tooth.regions}
    widths = {region: np.linalg.norm(points[1] - points[0], axis=-1).max() for region, points in ends.items()}
    wide = [region for region in tooth.regions if widths[region] > NARROWEST]
    return tuple(piece for region in wide for piece in Piece.of(tooth, region))


def _level(tooth: Tooth, link: Piece) -> ConeLevel:
    cone = tooth.chain[link.region].cone
    assert cone is not None
    return cone


def _is_turned(tooth: Tooth, link: Piece) -> bool:
    """Whether a link is a land or root on a plane, cylinder or cone that does not wind round the axis."""
    if tooth.chain[link.region].cone is None:
        return False
    angles = link.grid(tooth, np.array([0.0, 1.0]), tooth.sections(samples())).p
    return angles is not None and float(np.ptp(angles)) < WINDING


@dataclass(frozen=True)
class _Stretch:
    """Neighbouring links of splines, and the levels of the turned links before and after them, None for the run's own."""

    links: tuple[Piece, ...]
    before: ConeLevel | None
    after: ConeLevel | None


def _runs(tooth: Tooth, links: tuple[Piece, ...]) -> list[_Stretch]:
    """The chain parted by its turned links: what one part shares with the next is a curve on a level."""
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
    """How far a patch is off: at worst (mm), and in every interval across and along as multiples of what is allowed there."""

    largest: float
    across: Array
    along: Array


@dataclass(frozen=True)
class _Run:
    """The patches of a run of links, which have nodes along the face in common, over spans of t between breaks."""

    tooth: Tooth
    run: _Stretch
    spans: list[tuple[float, float]]
    tolerance: float

    def fit(self) -> dict[Piece, tuple[tuple[Patch, ...], float]]:
        """Patches of each link, and its deviation (mm)."""
        along = [self._planned_along(span) for span in self.spans]
        across = {link: self._planned_across(link) for link in self.run.links}
        for turn in range(ROUNDS):
            patches, misses = self._measure(across, along)
            largest = {link: max(miss.largest for miss in own) for link, own in misses.items()}
            worst = {link: np.max([miss.across for miss in own], axis=0) for link, own in misses.items()}
            worst_along = [np.max([misses[link][g].along for link in across], axis=0) for g in range(len(along))]
            excess = max(float(miss_across.max()) for miss_across in (*worst.values(), *worst_along))
            met = max(largest.values()) <= self.tolerance
            if met and excess <= 1.0:
                return {link: (tuple(patches[link]), largest[link]) for link in across}
            # where each direction alone is fine and only both together are not, both
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
            if most > MOST:
                break
        raise NoSolutionError(
            reason=f"B-spline faces of {max(nodes.y.size for nodes in across.values())} x "
            f"{max(nodes.y.size for nodes in along)} points deviate by {1000.0 * max(largest.values()):.3g} um, more than "
            f"the tolerance of {1000.0 * self.tolerance:g} um; choose a larger tolerance"
        )

    def _measure(
        self, across: dict[Piece, Nodes], along: list[Nodes]
    ) -> tuple[dict[Piece, list[Patch]], dict[Piece, list[_Miss]]]:
        patches: dict[Piece, list[Patch]] = {link: [] for link in across}
        misses: dict[Piece, list[_Miss]] = {link: [] for link in across}
        for g, (nodes, span) in enumerate(zip(along, self.spans, strict=True)):
            sections = self._sections(span, nodes.own(nodes.fine))
            for link, s in across.items():
                exact = link.grid(self.tooth, s.own(s.fine), sections).points
                patch = _patch(link, exact[::STEP, ::STEP], s, nodes, span)
                patches[link].append(patch)
                misses[link].append(self._miss(link, g, patch.at(s.fine, nodes.fine), exact))
        return patches, misses

    def _miss(self, link: Piece, g: int, drawn: Array, exact: Array) -> _Miss:
        """Of points (4 S + 1, 4 T + 1, 3) at the nodes and between them, in span g."""
        miss = np.linalg.norm(drawn - exact, axis=-1)
        allowed = SHARE * self.tolerance
        across = miss[:, ::STEP].max(axis=1) / allowed
        along = miss[::STEP].max(axis=0) / allowed
        for end in (0, -1):
            if g in (0, len(self.spans) - 1) and g == end % len(self.spans):
                across = np.maximum(across, self._off_station(drawn[:, end], end))
            along = np.maximum(along, self._off_level(link, drawn[end], end))
        return _Miss(float(miss.max()), by_interval(across), by_interval(along))

    def _planned_across(self, link: Piece) -> Nodes:
        t = np.unique([at for low, high in self.spans for at in (low, 0.5 * (low + high), high)])
        points = link.grid(self.tooth, samples(), self.tooth.sections(t)).points

        def excess(drawn: Array, exact: Array) -> Array:
            off = np.linalg.norm(drawn - exact, axis=-1).max(axis=1) / (SHARE * self.tolerance)
            for end in (0, -1):
                off = np.maximum(off, self._off_station(drawn[:, end], end))
            return np.asarray(off)

        return plan(points, excess)

    def _planned_along(self, span: tuple[float, float]) -> Nodes:
        sections, links = self._sections(span, samples()), self.run.links
        points = np.concatenate([link.grid(self.tooth, ACROSS, sections).points for link in links]).swapaxes(0, 1)

        def excess(drawn: Array, exact: Array) -> Array:
            off = np.linalg.norm(drawn - exact, axis=-1).max(axis=1) / (SHARE * self.tolerance)
            for end in (0, -1):
                off = np.maximum(off, self._off_level(links[end], drawn[:, end], end))
            return np.asarray(off)

        return plan(points, excess)

    def _sections(self, span: tuple[float, float], x: Array) -> Sections:
        low, high = span
        return self.tooth.sections(low + (high - low) * x)

    def _off_station(self, points: Array, end: int) -> Array:
        """Distances of a curve (K, 3) on toe (0) or heel (-1) from that station, as multiples of what is allowed."""
        blank = self.tooth.blank
        return np.asarray(np.abs(blank.axial.value(points) - blank.extent[end]) / ON_LEVEL)

    def _off_level(self, link: Piece, points: Array, end: int) -> Array:
        """Distances of the first (0) or last (-1) border (K, 3) of a link from the turned link beside it, likewise."""
        level = self.run.after if end else self.run.before
        if level is None or link != self.run.links[end]:
            return np.zeros(len(points))
        return np.asarray(np.abs(level.value(points)) / ON_LEVEL)


def _patch(piece: Piece, points: Array, s: Nodes, t: Nodes, span: tuple[float, float]) -> Patch:
    """The spline through points (S, T, 3) at nodes s, t."""
    knots = knots_of(s.y, DEGREE), knots_of(t.y, DEGREE)
    return Patch(piece, control_net((s.y, t.y), points, knots), s, t, *knots, span)
