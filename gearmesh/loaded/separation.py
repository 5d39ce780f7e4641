"""How far two unloaded flanks are apart where they may touch under load: exact gaps on grids that follow the contact.

For every tooth pair that comes near, x runs along the contact, the line or the major axis of the ellipse through its first
touch, y across it in the tangent plane there. The middle of the grid is the ridge, where the gap across is least, found for every
x; the gap is measured along the normal from the flanks themselves. Where the ridge leaves a flank over an edge that runs more along
x than across it, a tip, the least gap is on that, as far as it goes; x ends where one of the flanks does.

                 toe or tip                               y
        +----------------------------+                    |  ridge, least gap for this x
        |     cells dx by dy         |  2 W               o-------- x
        +----------------------------+

Units: mm, rad; the fixed frame.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import chain
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.engagement.pitch_turns import flanks_ahead
from gearmesh.contact.flanks import solver_pair, touching_jets
from gearmesh.contact.hertz import line_contact, point_contact
from gearmesh.contact.pair import MEMBERS, Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot, unit
from gearmesh.kernel.surface.curvature import contact_ellipse, principal, relative_curvature, tangent_basis
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.mount import Mount

T = TypeVar("T", ContactPath, Jet)

#: tooth pairs on either side of the one next to phi1 that are looked at, and how many more while the outermost are near; at most
PAIRS, MORE_PAIRS, MOST_PAIRS = 3, 3, 24
#: places along the contact at which it is looked for where the flanks end, and between two of these where edges do
SCAN, FINER = 33, 17
#: places across the contact at which gaps are exact; between them they are polynomials
ACROSS = 5
#: steps of the secant method to the ridge: gaps are nearly parabolas; how much wider or narrower than at first touch, at most
RIDGE_STEPS, NARROWER = 6, 5.0
#: a step goes no further than to a gap of so many mm; curvatures (1/mm) are taken as no less
FAR, LEAST_KAPPA = 0.05, 1e-3
#: half the grid's width over the Hertz semi-axes under the load
MARGIN = 1.4
#: how far a grid about a corner of a flank goes on, over the half width that a contact as long as wide has
CORNER = 2.0
#: a point of a surface is met to this, mm
MET = 1e-9
#: least length of a grid, mm: what touches at a corner of a flank has hardly any
LEAST = 0.05
#: a place is at most so many times further outside a flank than its distance from one says
LEAP = 2.0
#: a first touch on an edge lies on the flank to this, mm
ON_EDGE = 1e-3
#: an edge that touches first runs along x up to this tangent of its angle to x, seen off first touch by a share of the length
ALONG, OFF = 0.02, 0.02
#: it is followed in so many steps, no farther from x than so many mm, by slopes, over so many mm, of how far places lie outside;
#: where these are less the edge is another, beyond an end face
EDGE_STEPS, EDGE_AWAY, EDGE_STEP, STEEP = 3, 0.5, 1e-3, 0.5
#: how far beyond the end of a line at an edge grids go along that at first: to so many half widths of contact beside the line, at a
#: tangent of no less
BEYOND, FLATTEST = 2.0, 1e-3
#: cosine of the angle between x and an end face's normal from which on the face counts as one at right angles to x
SQUARE = 0.7


@dataclass(frozen=True)
class NearPairs:
    """Tooth pairs (M,) that may touch under load at rotations `phi1` (P,), rad, of the pinion; `phi2` (P,): the gear's, unloaded.

    Of every pair its `position` in phi1 and its `number`: k does at phi1 what pair 0 does at phi1 - k pitches, but for the pitch
    deviations of its flanks; so do `turns` (2, M)
    count, rad, of both members. `path`: its first touch; there `axes` (M, 3, 3), columns x, y and the normal out of the pinion, and
    relative curvatures `kappa` (M, 2), 1/mm, along x and y. `half` (M,) of double helical gears, 0 or 1: what stands here of the
    other half is where `images` bring it, by the pinion's plane of symmetry; the gear's mount in `mounts` has then a base for every
    pair.
    """

    pair: Pair
    phi1: Array
    phi2: Array
    position: NDArray[np.intp]
    number: NDArray[np.intp]
    half: NDArray[np.intp]
    turns: tuple[Array, Array]
    mounts: tuple[Mount, Mount]
    path: ContactPath
    axes: Array
    kappa: Array
    images: tuple[Rigid, ...]

    @cached_property
    def surfaces(self) -> _Surfaces:
        """The flanks over their tangent planes."""
        return _Surfaces(self)

    @cached_property
    def range(self) -> tuple[Array, Array]:
        """Between which x (M,), mm, the ridge lies on both flanks; the same for every torque."""
        return _range(self.surfaces, self)

    @cached_property
    def beyond(self) -> tuple[Array, Array]:
        """How far, mm (2, M), the ridge goes on along edges beyond the ends of `range`, and the tangents of the angles to it."""
        return _beyond(self.surfaces, self.range)

    def in_place(self, points: Array) -> Array:
        """Points (M, ..., 3) where they are, those of the other half too."""
        for k, image in enumerate(self.images[1:], 1):
            points = np.where(self._of_half(k, points), image.point(points), points)
        return points

    def turn(self, vectors: Array) -> Array:
        """Vectors (M, ..., 3) as they are, those of the other half too."""
        for k, image in enumerate(self.images[1:], 1):
            vectors = np.where(self._of_half(k, vectors), image.vector(vectors), vectors)
        return vectors

    def _of_half(self, k: int, values: Array) -> NDArray[np.bool_]:
        """Which of (M, ..., 3) values are of a half."""
        of_half: NDArray[np.bool_] = np.asarray(self.half == k).reshape(-1, *(1,) * (values.ndim - 1))
        return of_half

    def rotation(self, member: int) -> Array:
        """Angles (M,), rad, of the teeth that touch about a member's own axis, counted from the direction to the other's axis."""
        own, other = self.mounts[member], self.mounts[1 - member]
        apart = np.atleast_2d(other.origin - own.origin)
        both = np.cross(own.axis, other.axis)
        # parallel or meeting axes: out of the own axis
        along = dot(apart, both)[..., None]
        apart = np.where(np.abs(along) > 0.0, along * both, apart)
        towards = own.base.inverse.vector(apart)
        angle = np.arctan2(towards[..., 1], towards[..., 0])
        return own.sign * (self.turns[member] - own.zero) - angle

    def levers(self, member: int, points: Array, normals: Array) -> Array:
        """At which levers (M, ...), mm, above 0, pressures along `normals` at `points` (M, ..., 3) turn a member about its axis."""
        first = np.moveaxis(points, 0, -2)
        velocity = np.moveaxis(self.mounts[member].velocity(first), -2, 0)
        return np.abs(dot(normals, velocity))


def near_pairs(gears: GearPair, phi1: Array, limit: float) -> NearPairs:
    """Tooth pairs apart by less than `limit` (mm) at rotations phi1 (P,), rad, of the pinion, of both halves if there are two.

    Raises NoSolutionError where no teeth touch.
    """
    rows = gears.halves
    engagements = [_Followed(row, phi1) for row in rows]
    advance = np.max([own.advance for own in engagements], axis=0)
    for engagement in engagements:
        engagement.widen(advance, limit)
    if not np.isfinite(advance).all():
        k = int(np.argmin(np.isfinite(advance)))
        raise NoSolutionError(reason=f"no teeth touch at phi1 = {np.degrees(phi1[k]):g} deg; tca shows where they do")
    pair = engagements[0].pair
    near = [own.near(advance, limit) for own in engagements]
    position, number = (np.concatenate(column) for column in zip(*near, strict=True))
    half = np.repeat(np.arange(len(rows)), [len(numbers[0]) for numbers in near])
    first, second = _ahead(gears, number)
    own = phi1[position] - gears.pitch * number + first
    paths = [contact_path(engagement.pair, own[half == k]) for k, engagement in enumerate(engagements)]
    touching = [touching_jets(row, path) for row, path in zip(rows, paths, strict=True)]
    jets = [_join(jets_of_rows) for jets_of_rows in zip(*touching, strict=True)]
    path = _join(paths)
    turns = path.rotation, pair.ratio * (path.rotation - first) + second + pair.drive * advance[position]
    e1, e2 = tangent_basis(jets[0])
    relative = relative_curvature(jets[0], jets[1], e1, e2)
    ellipse, own_kappa = contact_ellipse(relative, e1, e2, 1.0), principal(relative)
    normal = path.normal
    along = unit(ellipse.major - dot(ellipse.major, normal)[:, None] * normal)
    axes = np.stack((along, np.cross(normal, along), normal), axis=-1)
    kappa = -np.stack((own_kappa.k1, own_kappa.k2), axis=-1)
    phi2 = pair.ratio * phi1 + pair.drive * advance
    pinion, gear = gears.mounts
    if len(rows) > 1:
        bases = [row.gear.mount.base for row in rows]
        gear = replace(
            gear,
            base=Rigid(
                np.stack([base.rotation for base in bases])[half], np.stack([base.translation for base in bases])[half]
            ),
        )
    return NearPairs(pair, phi1, phi2, position, number, half, turns, (pinion, gear), path, axes, kappa, gears.images)


def _ahead(gears: GearPair, number: NDArray[np.intp]) -> tuple[Array, Array]:
    """Angles, rad, by which flanks of tooth pairs are ahead of their places; 0 where teeth are alike."""
    return flanks_ahead(gears, number) if gears.uneven else (np.zeros(number.shape), np.zeros(number.shape))


class _Followed:
    """Advances, drive (phi2 - phi1 N1/N2), rad, of tooth pairs on either side of that next to phi1 (P,), as far as they are
    near."""

    def __init__(self, gears: GearPair, phi1: Array) -> None:
        self.pair, self._gears = solver_pair(gears), gears
        self._phi1, self._pitch = phi1, gears.pitch
        self._first = np.round(phi1 / gears.pitch).astype(np.intp)
        self._numbers = np.arange(-PAIRS, PAIRS + 1)
        self._advances, self._levers = self._solve(self._numbers)

    @property
    def advance(self) -> Array:
        """The greatest (P,); -inf where no teeth touch."""
        greatest: Array = self._advances.max(axis=1)
        return greatest

    def widen(self, advance: Array, limit: float) -> None:
        """Look at pairs further out until the outermost are no longer near, within `limit`, mm, of `advance` (P,)."""
        for out in (-1, 1):
            last = self._numbers[::out][-1]
            while self._near(advance, limit)[:, ::out][:, -1].any() and abs(last) < MOST_PAIRS:
                more = last + out * np.arange(1, MORE_PAIRS + 1)
                advances, levers = self._solve(more)
                self._numbers = np.append(self._numbers, more)
                order = np.argsort(self._numbers)
                self._numbers, last = self._numbers[order], more[-1]
                self._advances = np.concatenate((self._advances, advances), axis=1)[:, order]
                self._levers = np.concatenate((self._levers, levers), axis=1)[:, order]

    def near(self, advance: Array, limit: float) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Positions and numbers (M,) of pairs that are behind `advance` (P,) by less than `limit`, mm."""
        position, column = np.nonzero(self._near(advance, limit))
        return position, self._first[position] + self._numbers[column]

    def _near(self, advance: Array, limit: float) -> NDArray[np.bool_]:
        with np.errstate(invalid="ignore"):
            is_near: NDArray[np.bool_] = (advance[:, None] - self._advances) * self._levers < limit
        return is_near

    def _solve(self, numbers: NDArray[np.intp]) -> tuple[Array, Array]:
        """Advances, and levers at the gear, mm (P, K), of pairs of `numbers` (K,) beyond the first one."""
        every = self._first[:, None] + numbers
        first, second = _ahead(self._gears, every)
        path = contact_path(self.pair, (self._phi1[:, None] - self._pitch * every + first).ravel())
        te = path.phi2 - self.pair.ratio * path.rotation + (self.pair.ratio * first - second).ravel()
        advance = np.where(path.touching, self.pair.drive * te, -np.inf)
        lever = np.abs(dot(path.normal, self.pair.gear.mount.velocity(path.point)))
        shape = len(self._phi1), len(numbers)
        return advance.reshape(shape), lever.reshape(shape)


def _join(parts: Sequence[T]) -> T:
    """One record of arrays and tuples of several alike, one after the other; of numbers that of the first."""
    if len(parts) == 1:
        return parts[0]

    def together(values: list[Any]) -> Any:
        if isinstance(values[0], np.ndarray):
            return np.concatenate(values)
        return tuple(chain(*values)) if isinstance(values[0], tuple) else values[0]

    names = [field.name for field in fields(parts[0])]
    return replace(parts[0], **{name: together([getattr(part, name) for part in parts]) for name in names})


@dataclass(frozen=True)
class Separation:
    """Grids of cells on the tooth pairs (M,), X along by Y across: sizes `dx`, `dy` (M,), mm.

    `gap` (M, X, Y), mm, along the normal, of the unloaded flanks, and whether cells are `on` both flanks; ridge points `middle` and
    normals `normal` (M, X, 3), out of the pinion; `levers` (2, M, X), mm: at which pressure there turns pinion and gear about
    their axes, positive; `places` (2, M, X, 3): ridge points in the frame of the tooth of either member that touches there, from
    which `own_to_fixed` takes to the fixed one; `across` (M, 3): y; whether grids lie about a `corner` (M,) of a flank; whether
    they are `open` (2, M) at the least and the greatest x: contact was guessed to end there, flanks do not; from which `part` to
    which (2, M) of the guessed length they reach: not beyond the flanks; `ends` (2, 2, M): how far, mm along x, the end face of
    either member (first) is from the least and the greatest x of the grid (second), inf where there is none or it lies too
    obliquely to x; `edged` (M, X): where the ridge follows an edge; `ridge_ends` (2, M): how far, mm, inward from the least and the
    greatest x the ridge ends on the flanks, below 0 where it goes on beyond the grid.
    """

    dx: Array
    dy: Array
    gap: Array
    on: NDArray[np.bool_]
    middle: Array
    normal: Array
    levers: Array
    places: Array
    own_to_fixed: tuple[Rigid, Rigid]
    across: Array
    corner: NDArray[np.bool_]
    open: NDArray[np.bool_]
    part: Array
    ends: Array
    edged: NDArray[np.bool_]
    ridge_ends: Array


def separation(
    near: NearPairs,
    force: Array,
    modulus: float,
    cells: tuple[int, int],
    widen: Array,
    part: Array | tuple[float, float] = (0.0, 1.0),
) -> Separation:
    """Gaps on grids of `cells` (X, Y) as long and wide as forces (M,), N, under E* `modulus` (MPa) want; of their width `widen`
    (M,) times as much, of their length the `part` (2, M) from one share to another, beyond 0 and 1 as far as flanks go."""
    surfaces, (low, high) = near.surfaces, near.range
    along, across = _sizes(near, force, modulus, np.maximum(0.5 * (high - low), LEAST))
    least, most = low, np.maximum(high, low + LEAST)
    # lines that an edge ends go on along it
    (before, after), bends = near.beyond
    first, second = np.minimum((before, after), BEYOND * across / bends)
    low = np.where(low < -MARGIN * along, -MARGIN * along, low - first)
    high = np.where(high > MARGIN * along, MARGIN * along, high + second)
    high = np.maximum(high, low + LEAST)
    # about a corner the flanks lie beside the ridge, and contacts are about as long as wide
    round_corner = np.cbrt(4.0 * force / (np.pi * np.maximum(near.kappa[:, 1], LEAST_KAPPA) * modulus))
    corner = high - low < round_corner
    across = np.where(corner, round_corner, across)
    low, high = np.where(corner, low - CORNER * across, low), np.where(corner, high + CORNER * across, high)
    start, length = low, high - low
    least, most = np.where(corner, -np.inf, least - before), np.where(corner, np.inf, most + after)
    low, high = (np.clip(start + share * length, least, most) for share in part)
    part = np.stack((low - start, high - start)) / length
    goes_on = np.stack((low - least, most - high)) > 1e-6 * length
    half = MARGIN * across * widen
    dx, dy = (high - low) / cells[0], 2.0 * half / cells[1]
    x = low[:, None] + dx[:, None] * (np.arange(cells[0]) + 0.5)
    ridge, bent, _ = surfaces.ridge_and_edge(x)
    nodes = np.cos(np.pi * np.arange(ACROSS) / (ACROSS - 1))
    every = np.repeat(x[:, :, None], ACROSS, axis=2)
    seen = surfaces.at(every, ridge[:, :, None] + half[:, None, None] * nodes)
    middle = surfaces.at(x, ridge)
    normal = _common(near, middle, bent)
    slant = dot(normal, near.axes[:, None, :, 2])
    eta = (np.arange(cells[1]) + 0.5) * 2.0 / cells[1] - 1.0
    powers = np.polynomial.chebyshev.chebvander(eta, ACROSS - 1) @ np.linalg.inv(
        np.polynomial.chebyshev.chebvander(nodes, ACROSS - 1)
    )
    edged = (near.path.kind == "edge")[:, None] | bent
    exact, margin = _extend(seen, half[:, None, None] * nodes, near.kappa[:, 1], edged)
    gap = (exact @ powers.T) * slant[:, :, None]
    order = np.argsort(nodes)
    hat = np.stack([np.interp(eta, nodes[order], row[order]) for row in np.eye(ACROSS)], axis=-1)
    on = (margin @ hat.T <= 0.0) & np.isfinite(gap)
    levers = np.stack([near.levers(member, middle.points[0], normal) for member in (0, 1)])
    places = np.stack(
        [
            _each(own.rotation.swapaxes(1, 2), middle.points[0] - own.translation[:, None])
            for own in surfaces.own_to_fixed
        ]
    )
    first, second = surfaces.own_to_fixed
    ends = np.stack([_ends(flank, own, dx) for flank, own in zip(near.pair.flanks, places, strict=True)])
    return Separation(
        dx,
        dy,
        np.where(on, gap, 0.0),
        on,
        middle.points[0],
        normal,
        levers,
        places,
        (first, second),
        near.axes[..., 1],
        corner,
        goes_on,
        part,
        ends,
        bent | surfaces.along_edge[:, None],
        np.stack((near.range[0] - low, high - near.range[1])),
    )


def _common(near: NearPairs, seen: _Seen, bent: NDArray[np.bool_]) -> Array:
    """Normals (M, X, 3), out of the pinion, along which the bodies press: of the flank that an edge touches, which it does first or
    where the ridge is `ridge_and_edge` (M, X), else of both."""
    first, second = seen.normals[0], -seen.normals[1]
    edged = [np.char.find(near.path.edge, name)[:, None] >= 0 for name in MEMBERS]
    alone = [(own & ~other) | (bent & (seen.over == k)) for k, (own, other) in enumerate((edged, edged[::-1]))]
    both = unit(first + second)
    normals: Array = np.where(alone[0][..., None], second, np.where(alone[1][..., None], first, both))
    return normals


def _ends(flank: Flank, places: Array, dx: Array) -> Array:
    """Distances (2, M), mm along x, of a member's end faces from the ends of grids with ridge points (M, X, 3), own frame."""
    distances = np.full((2, len(dx)), np.inf)
    for which, (last, before) in enumerate(((0, 1), (-1, -2))):
        for name in ("toe", "heel"):
            outside, inner = (flank.edges[name].value(places[:, k]) for k in (last, before))
            slope = (outside - inner) / dx
            with np.errstate(all="ignore"):
                distance = np.where(slope > SQUARE, np.maximum(-outside / slope - 0.5 * dx, 0.0), np.inf)
            distances[which] = np.fmin(distances[which], distance)
    return distances


def _extend(seen: _Seen, y: Array, kappa: Array, edged: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Gaps and margins (M, X, ACROSS) at y (M, 1, ACROSS) from the ridge.

    Where a surface ends, or turns back at a cusp and is suddenly far outside, by |y| and by a parabola: with its apex on the
    ridge and as curved as the gaps that there are, where it is an edge, `edged` (M, X), as sloped as they are, of curvature
    `kappa`.
    """
    middle = ACROSS // 2
    with np.errstate(invalid="ignore"):
        leap = seen.margin - seen.margin[:, :, middle : middle + 1] > LEAP * np.abs(y)
    there = np.isfinite(seen.gap) & ~leap
    lowest = seen.gap[:, :, middle : middle + 1]
    away = np.where(there, y, 0.0)
    bend = 0.5 * kappa[:, None, None] * y**2
    with np.errstate(all="ignore"):
        rise = np.where(there, seen.gap - lowest, 0.0)
        curved = np.nan_to_num((rise * away**2).sum(axis=2) / (away**4).sum(axis=2))
        sloped = np.nan_to_num(((rise - bend) * away).sum(axis=2) / (away**2).sum(axis=2))
    sides = sloped[:, :, None] * y + bend, curved[:, :, None] * y**2
    guess = lowest + np.where(edged[:, :, None], *sides)
    return np.where(there, seen.gap, guess), np.where(there & np.isfinite(seen.margin), seen.margin, np.abs(y))


def _sizes(near: NearPairs, force: Array, modulus: float, length: Array) -> tuple[Array, Array]:
    """Half axes (M,) along and across, mm, under forces (M,), of contacts at most twice a `length` (M,) long."""
    small, large = near.kappa[:, 0], np.maximum(near.kappa[:, 1], 1e-9)
    ellipse = point_contact(np.maximum(small, 1e-6 * large), large, force, modulus)
    line = line_contact(large, 0.5 * force / length, modulus)
    is_line = ellipse.semi_major > length
    return np.where(is_line, length, ellipse.semi_major), np.where(is_line, line.half_width, ellipse.semi_minor)


def _range(surfaces: _Surfaces, near: NearPairs) -> tuple[Array, Array]:
    """Between which x (M,) the ridge lies on both flanks."""
    low, high = surfaces.extent
    share = np.linspace(0.0, 1.0, SCAN)
    x = low[:, None] + (high - low)[:, None] * share
    margin = surfaces.at(x, surfaces.ridge(x)).margin
    edge = near.path.kind == "edge"
    on = np.where(np.isfinite(margin), margin, np.inf) <= np.where(edge, ON_EDGE, 0.0)[:, None]
    # the piece that first touch lies in
    nearest = np.where(on, np.abs(x), np.inf).argmin(axis=1)
    every = np.arange(len(x))
    ends = []
    for step in (-1, 1):
        last = nearest.copy()
        for _ in range(SCAN):
            further = np.clip(last + step, 0, SCAN - 1)
            last = np.where(on[every, further], further, last)
        beyond = np.clip(last + step, 0, SCAN - 1)
        inside, outside = margin[every, last], margin[every, beyond]
        with np.errstate(all="ignore"):
            way = np.where(np.isfinite(outside) & (outside > inside), -inside / (outside - inside), 0.0)
        if surfaces.along_edge.any():
            way = np.where(surfaces.along_edge, _edge_share(surfaces, x[every, last], x[every, beyond]), way)
        ends.append(x[every, last] + np.clip(way, 0.0, 1.0) * (x[every, beyond] - x[every, last]))
    return ends[0], ends[1]


def _edge_share(surfaces: _Surfaces, inside: Array, beyond: Array) -> Array:
    """Share (M,) of the way from x (M,) `inside` flanks to `beyond` that edges go on: on them margins are 0 and mean nothing."""
    share = np.linspace(0.0, 1.0, FINER)
    x = inside[:, None] + (beyond - inside)[:, None] * share
    margin = surfaces.at(x, surfaces.ridge(x)).margin
    off = ~(np.where(np.isfinite(margin), margin, np.inf) <= ON_EDGE)
    off[:, 0] = False
    return share[np.where(off.any(axis=1), off.argmax(axis=1) - 1, FINER - 1)]


def _beyond(surfaces: _Surfaces, ends: tuple[Array, Array]) -> tuple[Array, Array]:
    """How far (2, M), mm, edges go on from the `ends` of ridges, (M,) each, and how steeply to them, tangents above 0."""
    lengths, bends = [], []
    for end, far in zip(ends, surfaces.extent, strict=True):
        x = end[:, None] + (far - end)[:, None] * np.linspace(0.0, 1.0, SCAN)[1:]
        y, bent, ridge = surfaces.ridge_and_edge(x)
        last = np.where(bent.all(axis=1), bent.shape[1], bent.argmin(axis=1)) - 1
        every = np.arange(len(x))
        lengths.append(np.where(last < 0, 0.0, np.abs(x[every, last] - end)))
        with np.errstate(all="ignore"):
            slope = np.abs(y - ridge)[:, 0] / np.abs(x[:, 0] - end)
        bends.append(np.where((last < 0) | ~(slope > FLATTEST), np.inf, slope))
    return np.stack(lengths), np.stack(bends)


@dataclass(frozen=True)
class _Seen:
    """Both flanks over places in the tangent planes: `gap` (...,) mm, how far (mm) the place lies outside either (`margin`) and
    outside which, 0 or 1, further (`over`), points and outward normals (..., 3) of both, fixed frame."""

    gap: Array
    margin: Array
    over: NDArray[np.intp]
    points: tuple[Array, Array]
    normals: tuple[Array, Array]


class _Surfaces:
    """The flanks of near pairs over their tangent planes."""

    def __init__(self, near: NearPairs) -> None:
        self._near = near
        self.own_to_fixed = []
        for mount, turn in zip(near.mounts, near.turns, strict=True):
            own = mount.at(turn)
            shape = near.path.point.shape
            self.own_to_fixed.append(
                Rigid(np.broadcast_to(own.rotation, near.axes.shape), np.broadcast_to(own.translation, shape))
            )
        self._frames = [
            Rigid(own.rotation.swapaxes(-1, -2) @ near.axes, own.inverse.point(near.path.point))
            for own in self.own_to_fixed
        ]
        self._edge = near.path.kind == "edge"

    @cached_property
    def extent(self) -> tuple[Array, Array]:
        """Least and greatest x (M,) that both flanks have."""
        ends = []
        for flank, frame in zip(self._near.pair.flanks, self._frames, strict=True):
            r = flank.surface.jet(flank.grid[..., 0].ravel(), flank.grid[..., 1].ravel()).r
            x = (
                np.einsum("kj,mj->mk", r, frame.rotation[:, :, 0])
                - dot(frame.translation, frame.rotation[:, :, 0])[:, None]
            )
            ends.append((np.nanmin(x, axis=1), np.nanmax(x, axis=1)))
        return np.maximum(ends[0][0], ends[1][0]), np.minimum(ends[0][1], ends[1][1])

    def ridge(self, x: Array) -> Array:
        """y (M, K) of the least gap at x (M, K); where an edge touches first y = 0, or that edge if it runs along x."""
        y = np.zeros_like(x)
        kappa = np.maximum(self._near.kappa[:, 1:], LEAST_KAPPA)
        most, rate = np.sqrt(2.0 * FAR / kappa), np.broadcast_to(kappa, x.shape)
        way, before = np.zeros_like(y), np.zeros_like(y)
        for k in range(RIDGE_STEPS):
            seen = self.at(x, y)
            slopes = [
                -dot(n, self._near.axes[:, None, :, 1]) / dot(n, self._near.axes[:, None, :, 2]) for n in seen.normals
            ]
            slope = slopes[1] - slopes[0]
            if k:
                with np.errstate(all="ignore"):
                    rate = np.where(np.abs(way) > MET, (slope - before) / way, rate)
                rate = np.clip(np.where(np.isfinite(rate), rate, kappa), kappa / NARROWER, kappa * NARROWER)
            step = np.clip(-slope / rate, -most, most)
            way, before = np.where(np.isfinite(step) & ~self._edge[:, None], step, 0.0), slope
            y = y + way
        return self._on_edge(x, y) if self.along_edge.any() else y

    def ridge_and_edge(self, x: Array) -> tuple[Array, NDArray[np.bool_], Array]:
        """y (M, K) of the least gap on both flanks at x (M, K): the ridge, and where it has left one of them the edge over which it
        did; whether it is such an edge (M, K), edges across x, as end faces, are none; and the ridge's own y (M, K)."""
        ridge = self.ridge(x)
        margin = self.at(x, ridge).margin
        outside = (margin > 0.0) & ~self.along_edge[:, None]
        rows = np.flatnonzero(outside.any(axis=1))
        y, bent = ridge.copy(), np.zeros_like(outside)
        if rows.size:
            own, moved, here = x[rows], ridge[rows], margin[rows]
            with np.errstate(all="ignore"):
                slope = (self.at(own, moved + EDGE_STEP, rows).margin - here) / EDGE_STEP
                steep = outside[rows] & (np.abs(slope) > STEEP)
                for _ in range(EDGE_STEPS):
                    moved = moved + np.where(steep, -here / slope, 0.0)
                    here = self.at(own, moved, rows).margin
                bent[rows] = steep & (np.abs(here) < ON_EDGE)
            y[rows] = np.where(bent[rows], moved, ridge[rows])
        return y, bent, ridge

    @cached_property
    def along_edge(self) -> NDArray[np.bool_]:
        """Which pairs (M,) first touch on an edge that runs along x, as tips of spur gears do: with it, not across it.

        Seen a little off on either side: first touch may be a corner, from which one way goes off the flank.
        """
        low, high = self.extent
        way = OFF * (high - low)
        along = np.zeros(len(way), dtype=bool)
        for side in (-1.0, 1.0):
            x = side * way[:, None] * np.array([1.0, 2.0, 1.0])
            here, further, beside = self.at(x, np.broadcast_to([0.0, 0.0, EDGE_STEP], x.shape)).margin.T
            slope = np.abs(beside - here) / EDGE_STEP
            with np.errstate(invalid="ignore"):
                near = (slope > STEEP) & (np.abs(here) < 2.0 * ALONG * way)
                along |= near & (np.abs(further - here) < ALONG * way)
        return np.asarray(along & self._edge)

    def _on_edge(self, x: Array, y: Array) -> Array:
        """y (M, K) with those of edges along x moved on to them, by steps with the slope of how far places lie outside."""
        for _ in range(EDGE_STEPS):
            here, beside = (self.at(x, y + step).margin for step in (0.0, EDGE_STEP))
            slope = (beside - here) / EDGE_STEP
            with np.errstate(all="ignore"):
                step = -here / slope
            # beyond the end face the edge is another
            there = (np.abs(slope) > STEEP) & (np.abs(y + step) < EDGE_AWAY)
            y = y + np.where(self.along_edge[:, None] & there, step, 0.0)
        return y

    def at(self, x: Array, y: Array, rows: NDArray[np.intp] | None = None) -> _Seen:
        """Both flanks over places x, y (M, ...), or of some pairs, `rows` (M,), alone."""
        heights, margins, points, normals = [], [], [], []
        which = slice(None) if rows is None else rows
        for flank, whole, plane in zip(self._near.pair.flanks, self.own_to_fixed, self._frames, strict=True):
            own, frame = (Rigid(motion.rotation[which], motion.translation[which]) for motion in (whole, plane))
            seen = _over(flank, frame, x, y)
            heights.append(seen[0])
            margins.append(seen[1])
            points.append(_each(own.rotation, seen[2]) + own.translation.reshape(-1, *(1,) * (x.ndim - 1), 3))
            normals.append(_each(own.rotation, seen[3]))
        over = (margins[1] > margins[0]).astype(np.intp)
        return _Seen(
            heights[1] - heights[0], np.maximum(*margins), over, (points[0], points[1]), (normals[0], normals[1])
        )


def _each(rotation: Array, vectors: Array) -> Array:
    """Vectors (M, ..., 3), each turned by its own of rotations (M, 3, 3)."""
    rotated: Array = np.einsum("mij,m...j->m...i", rotation, vectors)
    return rotated


def _over(flank: Flank, frame: Rigid, x: Array, y: Array) -> tuple[Array, Array, Array, Array]:
    """Of a flank over places x, y (M, ...) of planes `frame` (M,), own frame: heights along the third axis, how far outside the
    flank, mm, (M, ...), points and normals (M, ..., 3); NaN where the surface has none."""
    member = np.broadcast_to(np.arange(len(x)).reshape(-1, *(1,) * (x.ndim - 1)), x.shape).ravel()
    axes, origin = frame.rotation[member], frame.translation[member]
    wanted = np.stack((x.ravel(), y.ravel()), axis=-1)
    place = origin + np.einsum("kij,kj->ki", axes[:, :, :2], wanted)
    start = flank.heights.parameters_at(flank.mount.joint.radius(place), place[:, 2])

    def residual(p: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = flank.surface.jet(p[:, 0], p[:, 1])
        plane = axes[index, :, :2]
        f = np.einsum("ki,kij->kj", jet.r - origin[index], plane) - wanted[index]
        rows = np.stack([np.einsum("ki,kij->kj", d, plane) for d in (jet.r_u, jet.r_v)], axis=-1)
        return f, rows

    with np.errstate(all="ignore"):
        spans = np.abs(np.ptp(flank.grid.reshape(-1, 2), axis=0))
        met = newton.solve(residual, start, tolerance=MET, max_step=0.5 * spans, max_iterations=15)
        jet = flank.surface.jet(met.values[:, 0], met.values[:, 1])
        good = met.converged
        height = np.where(good, dot(jet.r - origin, axes[:, :, 2]), np.nan)
        margin = np.where(good, flank.margin(met.values, jet.r), np.nan)
    shape = x.shape
    return height.reshape(shape), margin.reshape(shape), jet.r.reshape(*shape, 3), jet.n.reshape(*shape, 3)
