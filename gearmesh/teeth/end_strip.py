r"""The chamfer, or rounding, along the outline of an end face: a strip between the tooth's section under it and a curve parallel to
the outline.

    end face      ____outer____          outer: in the end face, `width` inside the outline that sharp edges would have
                 /             \
                /               \        straight between the two, in the plane of the development of each station
    section    |____inner________|       inner: the section of the tooth, `depth` under the end face

A rounding is a conic section there instead, tangent to the end face and, but for the curvature along the face within its depth, to
the tooth: with the control points outer, the sharp edge at the same s, and inner, and the weight of a quarter of a circle,

    q = sum w_k B_k(tau) q_k / sum w_k B_k(tau)    B_k = (1 - tau)^2, 2 tau (1 - tau), tau^2    w = 1, 1 / sqrt(2), 1

an arc where tooth and end face are at right angles, else an ellipse's. The share of its depth is that sum of 0, 0, 1.

Every link of the section has a strip of its own. At convex corners of the outline the parallel curves are cut off where they cross
(mitres), and what lies between two that cross before it reaches the end face ends in a point, as a tip rounding smaller than the
chamfer does. At concave corners an arc about the corner joins them. Lengths in mm, in the tooth's own frame; the development is
that of `teeth.blank.development`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components
from gearmesh.kernel.numeric.polylines import first_crossing
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.teeth.blank.development import Development
from gearmesh.teeth.blank.end_edge import EndChamfer
from gearmesh.teeth.region import EDGES, Region
from gearmesh.teeth.section import Link, Sections

#: points of an arc between which crossings are looked for
SAMPLES = 129
#: points of every piece of an outline
PLACES = 9
#: ends of parallel curves that are no farther apart (mm) are one point
SNAP = 1e-7
#: of these near a place the polynomial is taken where samples are all that is looked at
NEAREST = 6
#: Newton steps to a crossing, and the step of s of its differences
STEPS, STEP = 8, 1e-5
#: distance (mm) at which two parallel curves cross: the last step is made from there
EXACT = 1e-8
#: weight of the sharp edge in a rounding
CONIC = float(np.sqrt(0.5))
#: how far inside a smooth piece of a link its normals at its ends are taken
INSIDE = 1e-9


@dataclass(frozen=True)
class _SharpPiece:
    """A smooth piece of a link of the outline with sharp edges, from `span` s to s, and the curve `width` inside it; `place`
    takes it to its tooth."""

    region: Region
    link: Link
    sections: Sections
    plane: Development
    about: Array
    span: tuple[float, float]
    width: float
    place: Rigid = field(default_factory=Rigid.identity)

    def at(self, s: Array) -> tuple[Array, Array]:
        """X, Y and unit normals out of the material (N, 2) at s (N,); at an end inside the link those of the piece itself."""
        first, last = self.span
        edge = INSIDE * (last - first)
        inside = np.clip(s, first + edge if first > 0.0 else s.min(), last - edge if last < 1.0 else s.max())
        grid = self.link.grid(inside, self.sections)
        r, n = self.place.point(grid.points[:, 0]), self.place.vector(grid.normals[:, 0])
        normal = self.plane.flat_vector(n, r, self.about)
        return self.plane.flat(r, self.about), normal / np.hypot(normal[:, 0], normal[:, 1])[:, None]

    def parallel(self, s: Array) -> Array:
        """X, Y (N, 2) of the parallel curve at s (N,)."""
        point, normal = self.at(s)
        return point - self.width * normal

    def beyond(self, step: Rigid) -> _SharpPiece:
        """The same of the next tooth, `step` away."""
        return replace(self, place=step)

    @property
    def s(self) -> Array:
        """s (SAMPLES,) of samples, close at both ends: an involute that begins near its base circle is bent sharply there."""
        share = np.linspace(0.0, 1.0, SAMPLES)
        for _ in range(2):
            share = share**2 * (3.0 - 2.0 * share)
        first, last = self.span
        return first + share * (last - first)

    @cached_property
    def samples(self) -> tuple[Array, Array]:
        """X, Y and normals (SAMPLES, 2) of samples from end to end."""
        return self.at(self.s)

    @cached_property
    def inner(self) -> Array:
        """The parallel curve (SAMPLES, 2) there."""
        point, normal = self.samples
        return point - self.width * normal

    @property
    def length(self) -> float:
        """Length of the outline, mm, about."""
        return float(np.hypot(*np.diff(self.samples[0], axis=0).T).sum())

    @cached_property
    def usable(self) -> tuple[int, int]:
        """The first and the last sample between which the parallel curve runs with the outline; both are one where it nowhere does.

        Inside a convex curve that is bent more it runs back. Raises TrimError where it does so between samples where it does not.
        """
        q, (first, last) = self.samples[0], self.samples[1][[0, -1]]
        if np.linalg.norm(q - q[0], axis=-1).max() <= SNAP and first[0] * last[1] < first[1] * last[0]:
            # a fillet without a radius: an arc about the corner
            return 0, SAMPLES - 1
        forth = (np.diff(q, axis=0) * np.diff(self.inner, axis=0)).sum(axis=-1) > 0.0
        # a rounding as wide as the chamfer shrinks to its centre
        if not forth.any() or np.linalg.norm(self.inner - self.inner[0], axis=-1).max() <= SNAP:
            return 0, 0
        first, last = int(forth.argmax()), int(SAMPLES - 1 - forth[::-1].argmax())
        if not forth[first:last].all():
            raise TrimError("end", 0.0, "the end chamfer is wider than the radius of a curve of the tooth's outline")
        return first, last


@dataclass(frozen=True)
class _SampledPiece(_SharpPiece):
    """The same by its samples alone, which are the same whatever the width: far less work, and as exact."""

    given: tuple[Array, Array] = (np.zeros((0, 2)), np.zeros((0, 2)))

    @staticmethod
    def of(piece: _SharpPiece, width: float) -> _SampledPiece:
        """The samples of a piece with another width."""
        own = (piece.region, piece.link, piece.sections, piece.plane, piece.about, piece.span)
        return _SampledPiece(*own, width, piece.place, piece.samples)

    @property
    def samples(self) -> tuple[Array, Array]:
        return self.given

    def beyond(self, step: Rigid) -> _SharpPiece:
        own = (self.region, self.link, self.sections, self.plane, self.about, self.span)
        return _SampledPiece.of(_SharpPiece(*own, self.width, step), self.width)

    def parallel(self, s: Array) -> Array:
        """By the polynomials through the NEAREST samples."""
        places = self.s
        first = np.clip(np.searchsorted(places, s) - NEAREST // 2, 0, SAMPLES - NEAREST)[:, None] + np.arange(NEAREST)
        near = places[first]
        apart = near[:, :, None] - near[:, None] + np.eye(NEAREST)
        away = np.where(np.eye(NEAREST, dtype=bool), 1.0, (s[:, None] - near)[:, None])
        return np.asarray(np.einsum("nk,nkj->nj", (away / apart).prod(axis=-1), self.inner[first]))


@dataclass(frozen=True)
class StripPiece:
    """A part of the strip: of the section's `region`, from `inner` s to s, beside the parallel curve from `outer` s to s.

    Where one of both is a point, `point` (2,), X and Y, the other one is fanned out from it; `round` is an arc round a concave
    corner: centre, radius, first angle and turn, rad.
    """

    region: Region
    _arc: _SharpPiece | None
    link: Link
    inner: tuple[float, float]
    outer: tuple[float, float]
    point: Array | None = None
    round: tuple[Array, float, float, float] | None = None

    def edge(self, sigma: Array) -> Array:
        """The sharp edge beside the piece, in the plane of the development.

        Parameters
        ----------
        sigma : ndarray
            (N,), from 0 to 1 along it.

        Returns
        -------
        ndarray
            X, Y (N, 2), mm.

        Examples
        --------
        >>> strip = gm.build(design.with_values({"pinion.end_chamfer": 0.3})).members["pinion"].tooth.end_strips[1]
        >>> strip.pieces[0].edge(np.array([0.0, 1.0])).shape
        (2, 2)
        """
        if self._arc is None:
            assert self.round is not None
            return np.broadcast_to(self.round[0], (sigma.size, 2))
        first, last = self._arc.span
        return self._arc.at(first + sigma * (last - first))[0]


class SharpOutline:
    """The outline of one tooth with sharp edges in its end face, which `step` takes to the next tooth's."""

    def __init__(self, chain: dict[Region, Link], sections: Sections, plane: Development, step: Rigid) -> None:
        """`chain` and `sections` (of one station) of the tooth at the end face."""
        sharp = chain[Region.LAND].grid([0.5], sections).points[0, 0]
        self.plane, self.step, self.about = plane, step, plane.about(sharp)
        self.on = _in_axial_plane(sharp)
        self.pieces = tuple(
            _SharpPiece(region, link, sections, plane, self.about, span, 0.0)
            for region, link in chain.items()
            for span in pairwise(_seams(link))
        )

    def inside(self, width: float) -> Array:
        """Points of the curve inside it, as the outline of a chamfered end face, by samples of this one.

        Parameters
        ----------
        width : float
            How far inside, mm.

        Returns
        -------
        ndarray
            (N, 3), own frame, mm.

        Raises
        ------
        TrimError
            Where the chamfer leaves no land, or turns back inside a curve that is bent more.

        Examples
        --------
        >>> toe, heel = gears.members["pinion"].tooth.sharp_outlines
        >>> bool(np.allclose(heel.inside(0.2)[:, 2], heel.inside(0.1)[0, 2]))
        True
        """
        arcs = [_SampledPiece.of(piece, width) for piece in self.pieces]
        pieces = _pieces(list(arcs), [(arc.link, arc.span) for arc in arcs], self.step)
        points = np.concatenate([_outer(piece, np.linspace(0.0, 1.0, PLACES)) for piece in pieces])
        return self.plane.lift(points, self.on, self.about)


class EndStrip:
    """The chamfer of one tooth at the end 0 (toe) or 1 (heel) of its face.

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
        """`chains` and `sections` (of one station) of the tooth under the chamfer, and of that with sharp edges at the end face;
        `step` takes a tooth to the next one."""
        self._plane, self._sections, self.chamfer = plane, sections[0], chamfer
        sharp = SharpOutline(chains[1], sections[1], plane, step)
        self._about = sharp.about
        self._on = sharp.on, _in_axial_plane(chains[0][Region.LAND].grid([0.5], sections[0]).points[0, 0])
        spans = [(link, span) for link in chains[0].values() for span in pairwise(_seams(link))]
        arcs = [replace(piece, width=chamfer.width) for piece in sharp.pieces]
        self.pieces = tuple(_pieces(arcs, spans, step))

    @property
    def outline(self) -> Array:
        """Points (N, 3) of the outline of the end face."""
        points = np.concatenate([_outer(piece, np.linspace(0.0, 1.0, PLACES)) for piece in self.pieces])
        return self._plane.lift(points, self._on[0], self._about)

    def middle(self, region: Region) -> Array:
        """The line in the middle of what a link has of the strip, from the end face on, without its end on the section.

        Parameters
        ----------
        region : Region
            The link's.

        Returns
        -------
        ndarray
            (K, 3), mm: one point of a chamfer, several of a rounding.

        Examples
        --------
        >>> strip = gm.build(design.with_values({"pinion.end_chamfer": 0.3})).members["pinion"].tooth.end_strips[1]
        >>> strip.middle(gm.Region.LAND)[:, 2].tolist()
        [5.0]
        """
        pieces = [piece for piece in self.pieces if piece.region is region and piece.round is None]
        tau = np.linspace(0.0, 1.0, PLACES)[:-1] if self.chamfer.rounded else np.zeros(1)
        return self.at(pieces[len(pieces) // 2], np.full(tau.size, 0.5 if len(pieces) % 2 else 0.0), tau)

    def depth(self, tau: Array) -> tuple[Array, Array]:
        """The share of the chamfer's depth that lies over a place, and its derivative.

        Parameters
        ----------
        tau : ndarray
            (...,), from the end face (0) to the section under it (1).

        Returns
        -------
        tuple of ndarray
            Share and derivative by tau, (...,) each.

        Examples
        --------
        >>> strip = gm.build(design.with_values({"pinion.end_chamfer": 0.3})).members["pinion"].tooth.end_strips[1]
        >>> strip.depth(np.array([0.5]))[0].tolist()
        [0.5]
        """
        if not self.chamfer.rounded:
            return tau, np.ones_like(tau)
        *_, under, rate = _conic(tau)
        return under, rate

    def tau(self, share: float) -> float:
        """Where the depth under the end face is a share of the chamfer's.

        Parameters
        ----------
        share : float
            From 0 to 1.

        Returns
        -------
        float
            tau, from the end face (0) to the section under it (1).

        Examples
        --------
        >>> strip = gm.build(design.with_values({"pinion.end_chamfer": 0.3})).members["pinion"].tooth.end_strips[1]
        >>> strip.tau(0.5)
        0.5
        """
        if not self.chamfer.rounded:
            return share
        # the quadratic equation of `_conic` for tau / (1 - tau)
        ahead = CONIC * share + math.sqrt((CONIC * share) ** 2 + share * (1.0 - share))
        return ahead / (ahead + 1.0 - share)

    def at(self, piece: StripPiece, sigma: Array, tau: Array) -> Array:
        """Points of a piece of the strip.

        Parameters
        ----------
        piece : StripPiece
            One of `pieces`.
        sigma : ndarray
            (...,), from 0 to 1 along the outline.
        tau : ndarray
            (...,), from the end face (0) to the section under it (1).

        Returns
        -------
        ndarray
            (..., 3) in the tooth's frame, mm.

        Examples
        --------
        >>> strip = gm.build(design.with_values({"pinion.end_chamfer": 0.3})).members["pinion"].tooth.end_strips[1]
        >>> points = strip.at(strip.pieces[0], np.array(0.5), np.array([0.0, 1.0]))
        >>> points[:, 2].round(9).tolist()
        [5.0, 4.7]
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
        """X, Y (N, 2) of the section under the end face."""
        first, last = piece.inner
        grid = piece.link.grid(first + sigma * (last - first), self._sections)
        return self._plane.flat(grid.points[:, 0], self._about)


def _conic(tau: Array) -> tuple[Array, Array, Array, Array]:
    """Shares of the end face's outline, the sharp edge and the section at tau, and the derivative of the last, (...,) each."""
    outer, edge, inner = (1.0 - tau) ** 2, 2.0 * CONIC * tau * (1.0 - tau), tau**2
    total, slope = outer + edge + inner, 2.0 * (CONIC - 1.0) * (1.0 - 2.0 * tau)
    return outer / total, edge / total, inner / total, (2.0 * tau - inner / total * slope) / total


def _outer(piece: StripPiece, sigma: Array) -> Array:
    """X, Y (N, 2) of the outline of the end face at sigma (N,)."""
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
    """s where the smooth pieces of a link begin and end."""
    return 0.0, *(s for s, _ in link.seams), 1.0


def _in_axial_plane(r: Array) -> Array:
    """A point (3,) turned about z into the plane of x and z."""
    return np.array([np.hypot(r[0], r[1]), 0.0, r[2]])


def _pieces(arcs: list[_SharpPiece], spans: list[tuple[Link, tuple[float, float]]], step: Rigid) -> list[StripPiece]:
    """The strip's pieces along the outline, from the corner with the tooth before to that with the next one, `step` away."""
    kept, trimmed = _trimmed_parts(arcs, step)
    following = [*arcs[1:], arcs[0].beyond(step)]
    pieces = list[StripPiece]()
    for k, (arc, (link, inner)) in enumerate(zip(arcs, spans, strict=True)):
        if k in trimmed:
            pieces.append(StripPiece(arc.region, arc, link, inner, trimmed[k]))
            after, beyond = following[k], trimmed.get((k + 1) % len(arcs))
            whole = beyond is not None and (trimmed[k][1], beyond[0]) == (arc.span[1], after.span[0])
            if whole and (corner := _concave(arc, after)) is not None:
                pieces.append(StripPiece(arc.region, None, link, (inner[1], inner[1]), (0.0, 1.0), round=corner))
        else:
            beside = max((j for j in kept if j < k), default=kept[0])
            point = arcs[beside].parallel(np.array([trimmed[beside][beside < k]]))[0]
            pieces.append(StripPiece(arc.region, arc, link, inner, (0.0, 1.0), point=point))
    return pieces


def _trimmed_parts(arcs: list[_SharpPiece], step: Rigid) -> tuple[list[int], dict[int, tuple[float, float]]]:
    """Numbers of the arcs whose parallel curves reach the end face, and the part of each, s to s, that is left of them."""
    kept = [k for k, arc in enumerate(arcs) if arc.usable[0] < arc.usable[1]]
    while True:
        spans = {k: [float(arcs[k].s[n]) for n in arcs[k].usable] for k in kept}
        dropped = None
        for j, k in zip(kept, [*kept[1:], kept[0]], strict=True):
            # the last one ends where the first one of the next tooth begins
            after = arcs[k].beyond(step) if k <= j else arcs[k]
            whole = arcs[j].usable[1] == SAMPLES - 1 and after.usable[0] == 0
            if whole and _meet(arcs[j], after) and not _convex(arcs[j], after):
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
        if arcs[dropped].region not in EDGES.values():
            raise TrimError("end", 0.0, f"the end chamfer leaves nothing of the {arcs[dropped].region} in the end face")
        kept.remove(dropped)


def _meet(one: _SharpPiece, other: _SharpPiece) -> bool:
    """Whether one arc begins where another one ends."""
    return float(np.linalg.norm(other.samples[0][0] - one.samples[0][-1])) <= SNAP


def _convex(one: _SharpPiece, other: _SharpPiece) -> bool:
    """Whether the material has an edge between two neighbouring arcs."""
    (q, first), (_, second) = one.samples, other.samples
    if one.width * float(np.linalg.norm(second[0] - first[-1])) <= SNAP:
        return False
    return float(second[0] @ (q[-1] - q[-2])) > 0.0


def _concave(one: _SharpPiece, other: _SharpPiece) -> tuple[Array, float, float, float] | None:
    """Centre, radius, first angle and turn (rad) of the arc about a concave corner between two arcs, None where there is none."""
    (q, normals), (_, following) = one.samples, other.samples
    first, second = normals[-1], following[0]
    if one.width * float(np.linalg.norm(second - first)) <= SNAP or _convex(one, other):
        return None
    start = float(np.arctan2(first[1], first[0]))
    turn = float(np.arctan2(first[0] * second[1] - first[1] * second[0], first @ second))
    return q[-1], one.width, start, turn


def _crossing(one: _SharpPiece, other: _SharpPiece) -> tuple[float, float] | None:
    """s on both where the parallel curves of two arcs cross, next to the end of the first; None where they do not."""
    last, first = one.usable[1], other.usable[0]
    if np.linalg.norm(one.inner[last] - other.inner[first]) <= SNAP:
        return float(one.s[last]), float(other.s[first])
    parts = [slice(arc.usable[0], arc.usable[1] + 1) for arc in (one, other)]
    near = first_crossing(one.inner[parts[0]][::-1], other.inner[parts[1]])
    if near is None:
        return None
    s, t = one.s[parts[0]][::-1], other.s[parts[1]]
    x = np.array([np.interp(near[0], np.arange(s.size), s), np.interp(near[1], np.arange(t.size), t)])
    low, high = np.transpose((one.span, other.span))
    steps = STEP * (high - low)
    for _ in range(STEPS):
        (a, before, after), (b, left, right) = (
            arc.parallel(at + step * np.array([0.0, -1.0, 1.0]))
            for arc, at, step in zip((one, other), x, steps, strict=True)
        )
        slopes = np.stack(((after - before) / (2.0 * steps[0]), -(right - left) / (2.0 * steps[1])), axis=-1)
        x = x - np.linalg.solve(slopes, a - b)
        if np.linalg.norm(a - b) <= EXACT:
            break
    first, second = np.clip(x, low, high).tolist()
    return first, second
