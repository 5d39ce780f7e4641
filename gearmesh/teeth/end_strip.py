r"""The chamfer or rounding along the outline of an end face.

It is a strip between the tooth's section under the end face and a curve parallel to the outline:

    end face      ____outer____          outer: in the end face, `width` inside the outline that sharp edges would have
                 /             \
                /               \        straight between the two, in the plane of the development of each station
    section    |____inner________|       inner: the section of the tooth, `depth` under the end face

A rounding is a conic section between the two. It is tangent to the end face. It is also tangent to the tooth, except
for the tooth's curvature along the face within its depth. Its control points are outer, the sharp edge at the same s,
and inner; its weight is that of a quarter of a circle:

    q = sum w_k B_k(tau) q_k / sum w_k B_k(tau)    B_k = (1 - tau)^2, 2 tau (1 - tau), tau^2    w = 1, 1 / sqrt(2), 1

The conic is an arc where tooth and end face are at right angles, otherwise part of an ellipse. The share of its depth
is the same sum with 0, 0, 1 for q_k.

Every link of the section has a strip. At convex corners of the outline the parallel curves are cut off where they cross
(mitres). A strip between two curves that cross before it reaches the end face ends in a point, for example that of a
tip rounding smaller than the chamfer. At concave corners an arc about the corner joins the curves. Lengths are in mm,
in the tooth's own frame; the development is in `teeth.blank.development`.
"""

from __future__ import annotations

import math
from dataclasses import field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components
from gearmesh.kernel.numeric.polylines import first_crossing
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.records import dataclass
from gearmesh.teeth.blank.development import Development
from gearmesh.teeth.blank.end_edge import EndChamfer
from gearmesh.teeth.region import TIP_EDGES, Region
from gearmesh.teeth.section import Link, Sections

#: samples of an arc between which crossings are looked for
ARC_SAMPLES = 129
#: points of every piece of an outline
POINTS_PER_PIECE = 9
#: distance up to which ends of parallel curves are one point
SNAP_DISTANCE_MM = 1e-7
#: samples near a place whose polynomial interpolates a sampled piece
NEAREST_SAMPLES = 6
#: most Newton steps to a crossing
CROSSING_NEWTON_STEPS = 8
#: step of the differences that these use, as a share of the piece
DIFFERENCE_STEP_S = 1e-5
#: distance of two parallel curves from which one last Newton step is made
CROSSING_TOLERANCE_MM = 1e-8
#: weight of the sharp edge in a rounding: a quarter of a circle
SHARP_EDGE_WEIGHT = float(np.sqrt(0.5))
#: distance from the ends of a smooth piece, as a share of it, at which its end normals are evaluated
END_NORMAL_SHARE = 1e-9


@dataclass(frozen=True)
class _SharpPiece:
    """A smooth piece of a link of the sharp outline, and the curve parallel to it."""

    #: region of the link
    region: Region
    #: link of the sharp tooth
    link: Link
    #: section (one station) of the sharp tooth at the end face
    sections: Sections
    #: development of the end face
    plane: Development
    #: angle from which the development counts, rad
    about: Array
    #: s of the link at both ends of the piece
    span: tuple[float, float]
    #: distance of the parallel curve inside the outline, mm
    width: float
    #: motion from the tooth to the tooth of this piece
    place: Rigid = field(default_factory=Rigid.identity)

    def at(self, s: Array) -> tuple[Array, Array]:
        """Return X, Y and unit normals out of the material, (N, 2), at s (N,).

        At an end inside the link the normal is evaluated on this piece, not on its neighbour.
        """
        first, last = self.span
        edge = END_NORMAL_SHARE * (last - first)
        inside = np.clip(s, first + edge if first > 0.0 else s.min(), last - edge if last < 1.0 else s.max())
        grid = self.link.grid(inside, self.sections)
        r, n = self.place.point(grid.points[:, 0]), self.place.vector(grid.normals[:, 0])
        normal = self.plane.flat_vector(n, r, self.about)
        return self.plane.flat(r, self.about), normal / np.hypot(normal[:, 0], normal[:, 1])[:, None]

    def parallel(self, s: Array) -> Array:
        """Return X, Y (N, 2) of the parallel curve at s (N,)."""
        point, normal = self.at(s)
        return point - self.width * normal

    def beyond(self, step: Rigid) -> _SharpPiece:
        """Return the piece of the next tooth, `step` away."""
        return replace(self, place=step)

    @property
    def s(self) -> Array:
        """Values of s (ARC_SAMPLES,), dense at both ends: an involute bends sharply where it begins near its base
        circle.
        """
        share = np.linspace(0.0, 1.0, ARC_SAMPLES)
        for _ in range(2):
            share = share**2 * (3.0 - 2.0 * share)
        first, last = self.span
        return first + share * (last - first)

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """X, Y and normals (ARC_SAMPLES, 2) of samples from end to end."""
        return self.at(self.s)

    @cached_property
    def inner(self) -> Array:
        """X, Y (ARC_SAMPLES, 2) of the parallel curve at the samples."""
        point, normal = self.samples
        return point - self.width * normal

    @property
    def length(self) -> float:
        """Approximate length of the outline, mm."""
        return float(np.hypot(*np.diff(self.samples[0], axis=0).T).sum())

    @cached_property
    def usable(self) -> tuple[int, int]:
        """First and last sample between which the parallel curve runs in the direction of the outline; equal if there
        are none.

        Inside a convex curve with a radius below the width the parallel curve runs backwards. Raises TrimError if it
        does so between two samples where it does not.
        """
        q, (first, last) = self.samples[0], self.samples[1][[0, -1]]
        if np.linalg.norm(q - q[0], axis=-1).max() <= SNAP_DISTANCE_MM and first[0] * last[1] < first[1] * last[0]:
            # a fillet without a radius: the parallel curve is an arc about the corner
            return 0, ARC_SAMPLES - 1
        forth = (np.diff(q, axis=0) * np.diff(self.inner, axis=0)).sum(axis=-1) > 0.0
        # a rounding as wide as the chamfer shrinks to its centre
        if not forth.any() or np.linalg.norm(self.inner - self.inner[0], axis=-1).max() <= SNAP_DISTANCE_MM:
            return 0, 0
        first, last = int(forth.argmax()), int(ARC_SAMPLES - 1 - forth[::-1].argmax())
        if not forth[first:last].all():
            raise TrimError("end", 0.0, "the end chamfer is wider than the radius of a curve of the tooth's outline")
        return first, last


@dataclass(frozen=True)
class _SampledPiece(_SharpPiece):
    """A piece whose parallel curve interpolates given samples.

    The samples do not depend on the width. They take far less time than the piece and are as exact.
    """

    given: tuple[Array, Array] = (np.zeros((0, 2)), np.zeros((0, 2)))

    @staticmethod
    def of(piece: _SharpPiece, width: float) -> _SampledPiece:
        """Return the samples of a piece with another width."""
        fields_before_width = (piece.region, piece.link, piece.sections, piece.plane, piece.about, piece.span)
        return _SampledPiece(*fields_before_width, width, piece.place, piece.samples)

    @property
    def samples(self) -> tuple[Array, Array]:
        return self.given

    def beyond(self, step: Rigid) -> _SharpPiece:
        fields_before_width = (self.region, self.link, self.sections, self.plane, self.about, self.span)
        return _SampledPiece.of(_SharpPiece(*fields_before_width, self.width, step), self.width)

    def parallel(self, s: Array) -> Array:
        """Return X, Y (N, 2) of the parallel curve, from polynomials through the NEAREST_SAMPLES around s (N,)."""
        places = self.s
        first = np.clip(np.searchsorted(places, s) - NEAREST_SAMPLES // 2, 0, ARC_SAMPLES - NEAREST_SAMPLES)[
            :, None
        ] + np.arange(NEAREST_SAMPLES)
        near = places[first]
        apart = near[:, :, None] - near[:, None] + np.eye(NEAREST_SAMPLES)
        away = np.where(np.eye(NEAREST_SAMPLES, dtype=bool), 1.0, (s[:, None] - near)[:, None])
        return np.asarray(np.einsum("nk,nkj->nj", (away / apart).prod(axis=-1), self.inner[first]))


@dataclass(frozen=True)
class StripPiece:
    """A piece of the strip, between part of a link and part of the parallel curve."""

    #: region of the link
    region: Region
    #: piece of the sharp outline; None at a concave corner
    _arc: _SharpPiece | None
    #: link of the tooth under the chamfer
    link: Link
    #: s of the link at both ends
    inner: tuple[float, float]
    #: s of the parallel curve at both ends
    outer: tuple[float, float]
    #: X, Y (2,) of the point in which the piece ends instead of a part of the parallel curve
    point: Array | None = None
    #: arc about a concave corner instead of it: centre X, Y (2,), radius (mm), first angle and turn (rad)
    round: tuple[Array, float, float, float] | None = None

    def edge(self, sigma: Array) -> Array:
        """Return the sharp edge beside the piece, in the plane of the development.

        `sigma`: (N,), from 0 to 1 along it. Result: X, Y (N, 2), mm.
        """
        if self._arc is None:
            assert self.round is not None
            return np.broadcast_to(self.round[0], (sigma.size, 2))
        first, last = self._arc.span
        return self._arc.at(first + sigma * (last - first))[0]


class SharpOutline:
    """Outline of one tooth with sharp edges in its end face; `step` is the motion to the next tooth."""

    def __init__(self, chain: dict[Region, Link], sections: Sections, plane: Development, step: Rigid) -> None:
        """`chain` and `sections` (one station) are those of the tooth at the end face."""
        sharp = chain[Region.LAND].grid([0.5], sections).points[0, 0]
        self.plane, self.step, self.about = plane, step, plane.about(sharp)
        self.on = _in_axial_plane(sharp)
        self.pieces = tuple(
            _SharpPiece(region, link, sections, plane, self.about, span, 0.0)
            for region, link in chain.items()
            for span in pairwise(_seams(link))
        )

    def inside(self, width: float) -> Array:
        """Return points of the outline of a chamfered end face: the curve inside this one, from its samples.

        `width`: distance inside this outline, mm. Result: (N, 3), own frame, mm. Raises TrimError where the chamfer
        leaves no land, or turns back inside a curve that is bent more.
        """
        arcs = [_SampledPiece.of(piece, width) for piece in self.pieces]
        pieces = _pieces(list(arcs), [(arc.link, arc.span) for arc in arcs], self.step)
        points = np.concatenate([_outer(piece, np.linspace(0.0, 1.0, POINTS_PER_PIECE)) for piece in pieces])
        return self.plane.lift(points, self.on, self.about)


class EndStrip:
    """The chamfer of one tooth at one end of its face.

    Raises TrimError where the chamfer leaves no land, or turns back inside a curve that is bent more.
    """

    def __init__(
        self,
        chains: tuple[dict[Region, Link], dict[Region, Link]],
        sections: tuple[Sections, Sections],
        plane: Development,
        chamfer: EndChamfer,
        step: Rigid,
    ) -> None:
        """`chains` and `sections` (one station): of the tooth under the chamfer, and of the sharp tooth at the end
        face.

        `step` is the motion from a tooth to the next.
        """
        self._plane, self._sections, self.chamfer = plane, sections[0], chamfer
        sharp = SharpOutline(chains[1], sections[1], plane, step)
        self._about = sharp.about
        self._on = sharp.on, _in_axial_plane(chains[0][Region.LAND].grid([0.5], sections[0]).points[0, 0])
        spans = [(link, span) for link in chains[0].values() for span in pairwise(_seams(link))]
        arcs = [replace(piece, width=chamfer.width) for piece in sharp.pieces]
        self.pieces = tuple(_pieces(arcs, spans, step))

    @property
    def outline(self) -> Array:
        """Points (N, 3), mm, of the outline of the end face."""
        points = np.concatenate([_outer(piece, np.linspace(0.0, 1.0, POINTS_PER_PIECE)) for piece in self.pieces])
        return self._plane.lift(points, self._on[0], self._about)

    def middle(self, region: Region) -> Array:
        """Return the line in the middle of a link's part of the strip, from the end face on, without its end on the
        section.

        `region`: region of the link. Result: (K, 3), mm: one point of a chamfer, several of a rounding.
        """
        pieces = [piece for piece in self.pieces if piece.region is region and piece.round is None]
        tau = np.linspace(0.0, 1.0, POINTS_PER_PIECE)[:-1] if self.chamfer.rounded else np.zeros(1)
        return self.at(pieces[len(pieces) // 2], np.full(tau.size, 0.5 if len(pieces) % 2 else 0.0), tau)

    def depth(self, tau: Array) -> tuple[Array, Array]:
        """Return the depth under the end face, as a share of the chamfer's depth, and its derivative.

        `tau`: (...,), from the end face (0) to the section under it (1). Result: share and derivative by tau, (...,)
        each.
        """
        if not self.chamfer.rounded:
            return tau, np.ones_like(tau)
        *_, under, rate = _conic(tau)
        return under, rate

    def tau(self, share: float) -> float:
        """Return tau at a given depth under the end face.

        `share`: from 0 to 1.
        """
        if not self.chamfer.rounded:
            return share
        # the quadratic equation of `_conic` for tau / (1 - tau)
        ahead = SHARP_EDGE_WEIGHT * share + math.sqrt((SHARP_EDGE_WEIGHT * share) ** 2 + share * (1.0 - share))
        return ahead / (ahead + 1.0 - share)

    def at(self, piece: StripPiece, sigma: Array, tau: Array) -> Array:
        """Return points of a piece of the strip.

        `sigma`: (...,), from 0 to 1 along the outline. `tau`: (...,), from the end face (0) to the section under it
        (1). Result: (..., 3) in the tooth's frame, mm.
        """
        sigma, tau = broadcast_pair(sigma, tau)
        along, every = np.unique(sigma.ravel(), return_inverse=True)
        outer, inner = (q[every].reshape(*sigma.shape, 2) for q in (_outer(piece, along), self._inner(piece, along)))
        if not self.chamfer.rounded:
            q, under = outer + tau[..., None] * (inner - outer), tau
        else:
            edge = piece.edge(along)[every].reshape(*sigma.shape, 2)
            first, middle, under, _ = _conic(tau)
            q = first[..., None] * outer + middle[..., None] * edge + under[..., None] * inner
        on = self._on[0] + under[..., None] * (self._on[1] - self._on[0])
        return self._plane.lift(q, on, self._about)

    def _inner(self, piece: StripPiece, sigma: Array) -> Array:
        """Return X, Y (N, 2) of the section under the end face."""
        first, last = piece.inner
        grid = piece.link.grid(first + sigma * (last - first), self._sections)
        return self._plane.flat(grid.points[:, 0], self._about)


def _conic(tau: Array) -> tuple[Array, Array, Array, Array]:
    """Shares of the end face's outline, the sharp edge and the section at tau, and the derivative of the last, (...,)
    each.
    """
    outer, edge, inner = (1.0 - tau) ** 2, 2.0 * SHARP_EDGE_WEIGHT * tau * (1.0 - tau), tau**2
    total, slope = outer + edge + inner, 2.0 * (SHARP_EDGE_WEIGHT - 1.0) * (1.0 - 2.0 * tau)
    return outer / total, edge / total, inner / total, (2.0 * tau - inner / total * slope) / total


def _outer(piece: StripPiece, sigma: Array) -> Array:
    """Return X, Y (N, 2) of the outline of the end face at sigma (N,)."""
    if piece.round is not None:
        centre, radius, start, turn = piece.round
        angle = start + sigma * turn
        return centre - radius * components(np.cos(angle), np.sin(angle))
    if piece.point is not None:
        return np.broadcast_to(piece.point, (sigma.size, 2))
    assert piece._arc is not None
    first, last = piece.outer
    return piece._arc.parallel(first + sigma * (last - first))


def _seams(link: Link) -> tuple[float, ...]:
    """Values of s where the smooth pieces of a link begin and end."""
    return 0.0, *(s for s, _ in link.seams), 1.0


def _in_axial_plane(r: Array) -> Array:
    """Turn a point (3,) about z into the plane of x and z."""
    return np.array([np.hypot(r[0], r[1]), 0.0, r[2]])


def _pieces(arcs: list[_SharpPiece], spans: list[tuple[Link, tuple[float, float]]], step: Rigid) -> list[StripPiece]:
    """Return the strip's pieces along the outline, from the corner with the tooth before to the corner with the next,
    `step` away.
    """
    kept, trimmed = _trimmed_parts(arcs, step)
    following = [*arcs[1:], arcs[0].beyond(step)]
    pieces = list[StripPiece]()
    for k, (arc, (link, inner)) in enumerate(zip(arcs, spans, strict=True)):
        if k in trimmed:
            pieces.append(StripPiece(arc.region, arc, link, inner, trimmed[k]))
            after, beyond = following[k], trimmed.get((k + 1) % len(arcs))
            untrimmed = beyond is not None and (trimmed[k][1], beyond[0]) == (arc.span[1], after.span[0])
            if untrimmed and (corner := _concave(arc, after)) is not None:
                pieces.append(StripPiece(arc.region, None, link, (inner[1], inner[1]), (0.0, 1.0), round=corner))
        else:
            neighbour = max((j for j in kept if j < k), default=kept[0])
            point = arcs[neighbour].parallel(np.array([trimmed[neighbour][neighbour < k]]))[0]
            pieces.append(StripPiece(arc.region, arc, link, inner, (0.0, 1.0), point=point))
    return pieces


def _trimmed_parts(arcs: list[_SharpPiece], step: Rigid) -> tuple[list[int], dict[int, tuple[float, float]]]:
    """Trim the parallel curves against each other.

    Returns the numbers of the arcs that reach the end face, and the remaining part of each, s to s.
    """
    kept = [k for k, arc in enumerate(arcs) if arc.usable[0] < arc.usable[1]]
    while True:
        spans = {k: [float(arcs[k].s[n]) for n in arcs[k].usable] for k in kept}
        dropped = None
        for j, k in zip(kept, [*kept[1:], kept[0]], strict=True):
            # the last arc ends where the first arc of the next tooth begins
            after = arcs[k].beyond(step) if k <= j else arcs[k]
            untrimmed = arcs[j].usable[1] == ARC_SAMPLES - 1 and after.usable[0] == 0
            if untrimmed and _meet(arcs[j], after) and not _convex(arcs[j], after):
                continue
            crossing = _crossing(arcs[j], after)
            if crossing is None:
                dropped = min((j, k), key=lambda n: arcs[n].length)
                break
            spans[j][1], spans[k][0] = crossing
        if dropped is None:
            dropped = next((k for k, (first, last) in spans.items() if last <= first), None)
        if dropped is None:
            return kept, {k: (first, last) for k, (first, last) in spans.items()}
        if arcs[dropped].region not in TIP_EDGES.values():
            raise TrimError("end", 0.0, f"the end chamfer leaves nothing of the {arcs[dropped].region} in the end face")
        kept.remove(dropped)


def _meet(one: _SharpPiece, other: _SharpPiece) -> bool:
    """True if arc `other` begins where arc `one` ends."""
    return float(np.linalg.norm(other.samples[0][0] - one.samples[0][-1])) <= SNAP_DISTANCE_MM


def _convex(one: _SharpPiece, other: _SharpPiece) -> bool:
    """True if the material has an edge between two neighbouring arcs."""
    (q, first), (_, second) = one.samples, other.samples
    if one.width * float(np.linalg.norm(second[0] - first[-1])) <= SNAP_DISTANCE_MM:
        return False
    return float(second[0] @ (q[-1] - q[-2])) > 0.0


def _concave(one: _SharpPiece, other: _SharpPiece) -> tuple[Array, float, float, float] | None:
    """Arc about a concave corner between two arcs: centre, radius, first angle and turn (rad); None if the corner is
    not concave.
    """
    (q, normals), (_, following) = one.samples, other.samples
    first, second = normals[-1], following[0]
    if one.width * float(np.linalg.norm(second - first)) <= SNAP_DISTANCE_MM or _convex(one, other):
        return None
    start = float(np.arctan2(first[1], first[0]))
    turn = float(np.arctan2(first[0] * second[1] - first[1] * second[0], first @ second))
    return q[-1], one.width, start, turn


def _crossing(one: _SharpPiece, other: _SharpPiece) -> tuple[float, float] | None:
    """Find s on both arcs where their parallel curves cross, near the end of the first; None if they do not."""
    last, first = one.usable[1], other.usable[0]
    if np.linalg.norm(one.inner[last] - other.inner[first]) <= SNAP_DISTANCE_MM:
        return float(one.s[last]), float(other.s[first])
    parts = [slice(arc.usable[0], arc.usable[1] + 1) for arc in (one, other)]
    # start: the first crossing of the sampled curves, counted from the corner
    near = first_crossing(one.inner[parts[0]][::-1], other.inner[parts[1]])
    if near is None:
        return None
    s, t = one.s[parts[0]][::-1], other.s[parts[1]]
    x = np.array([np.interp(near[0], np.arange(s.size), s), np.interp(near[1], np.arange(t.size), t)])
    low, high = np.transpose((one.span, other.span))
    # Newton's method on the difference of both curves, with slopes from central differences
    steps = DIFFERENCE_STEP_S * (high - low)
    for _ in range(CROSSING_NEWTON_STEPS):
        (a, before, after), (b, left, right) = (
            arc.parallel(at + step * np.array([0.0, -1.0, 1.0]))
            for arc, at, step in zip((one, other), x, steps, strict=True)
        )
        slopes = np.stack(((after - before) / (2.0 * steps[0]), -(right - left) / (2.0 * steps[1])), axis=-1)
        x = x - np.linalg.solve(slopes, a - b)
        if np.linalg.norm(a - b) <= CROSSING_TOLERANCE_MM:
            break
    first, second = np.clip(x, low, high).tolist()
    return first, second
