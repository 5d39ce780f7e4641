"""How far two unloaded flanks are apart where they may touch under load: exact gaps on grids that follow the contact.

For every tooth pair that comes near, x runs along the contact, the line or the major axis of the ellipse through its first
touch, y across it in the tangent plane there. The middle of the grid is the ridge, where the gap across is least, found for every
x; the gap is measured along the normal from the flanks themselves. x ends where one of the flanks does.

                 toe or tip                               y
        +----------------------------+                    |  ridge, least gap for this x
        |     cells dx by dy         |  2 W               o-------- x
        +----------------------------+

Units: mm, rad; the fixed frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import solver_pair, touching_jets
from gearmesh.contact.hertz import line_contact, point_contact
from gearmesh.contact.meshing import Flank
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import NoSolutionError
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot, unit
from gearmesh.kernel.curvature import contact_ellipse, principal, relative_curvature, tangent_basis
from gearmesh.kernel.rigid import Rigid
from gearmesh.teeth.train import GearPair

#: tooth pairs on either side of the one that phi1 counts
PAIRS = 3
#: places along the contact at which it is looked for where the flanks end
SCAN = 33
#: places across the contact at which gaps are exact; between them they are polynomials
ACROSS = 5
#: steps of the secant method to the ridge: gaps are nearly parabolas; how much wider or narrower than at first touch, at most
RIDGE_STEPS, NARROWER = 6, 5.0
#: a step goes no further than to a gap of so many mm; curvatures (1/mm) are taken as no less
FAR, LEAST_KAPPA = 0.05, 1e-3
#: half the grid's width over the Hertz half axes under the load
MARGIN = 1.4
#: a point of a surface is met to this, mm
MET = 1e-9
#: least length of a grid, mm: what touches at a corner of a flank has hardly any
LEAST = 0.05
#: a first touch on an edge lies on the flank to this, mm
ON_EDGE = 1e-3


@dataclass(frozen=True)
class NearPairs:
    """Tooth pairs (M,) that may touch under load at rotations `phi1` (P,), rad, of the pinion; `phi2` (P,): the gear's, unloaded.

    Of every pair its `position` in phi1 and its `number`: k does at phi1 what pair 0 does at phi1 - k pitches; so do `turns` (2, M)
    count, rad, of both members. `path`: its first touch; there `axes` (M, 3, 3), columns x, y and the normal out of the pinion, and
    relative curvatures `kappa` (M, 2), 1/mm, along x and y."""

    pair: Pair
    phi1: Array
    phi2: Array
    position: NDArray[np.intp]
    number: NDArray[np.intp]
    turns: tuple[Array, Array]
    path: ContactPath
    axes: Array
    kappa: Array


def near_pairs(gears: GearPair, phi1: Array, limit: float) -> NearPairs:
    """Tooth pairs apart by less than `limit` (mm) at rotations phi1 (P,), rad, of the pinion.

    Raises NoSolutionError where no teeth touch.
    """
    pair, pitch = solver_pair(gears), gears.pitch
    numbers = np.arange(-PAIRS, PAIRS + 1)
    own = (phi1[:, None] - pitch * numbers).ravel()
    path = contact_path(pair, own)
    te = np.where(path.touching, path.phi2 - pair.ratio * path.rotation, np.nan).reshape(len(phi1), -1)
    touching = np.isfinite(te)
    if not touching.any(axis=1).all():
        k = int(np.argmin(touching.any(axis=1)))
        raise NoSolutionError(f"no teeth touch at phi1 = {np.degrees(phi1[k]):g} deg; tca shows where they do")
    lead = np.nanmax(pair.drive * te, axis=1)
    behind = np.where(touching, lead[:, None] - pair.drive * te, np.inf).ravel()
    with np.errstate(invalid="ignore"):
        lever = np.abs(dot(path.normal, pair.gear.mount.velocity(path.point)))
        near = np.flatnonzero(behind * lever < limit)
    position, number = near // len(numbers), numbers[near % len(numbers)]
    path = contact_path(pair, own[near])
    turns = path.rotation, pair.ratio * path.rotation + pair.drive * lead[position]
    jets = touching_jets(gears, path)
    e1, e2 = tangent_basis(jets[0])
    relative = relative_curvature(*jets, e1, e2)
    ellipse, own_kappa = contact_ellipse(relative, e1, e2, 1.0), principal(relative)
    normal = path.normal
    along = unit(ellipse.major - dot(ellipse.major, normal)[:, None] * normal)
    axes = np.stack((along, np.cross(normal, along), normal), axis=-1)
    kappa = -np.stack((own_kappa.k1, own_kappa.k2), axis=-1)
    phi2 = pair.ratio * phi1 + pair.drive * lead
    return NearPairs(pair, phi1, phi2, position, number, turns, path, axes, kappa)


@dataclass(frozen=True)
class Separation:
    """Grids of cells on the tooth pairs (M,), X along by Y across: sizes `dx`, `dy` (M,), mm.

    `gap` (M, X, Y), mm, along the normal, of the unloaded flanks, and whether cells are `on` both flanks; ridge points `middle` and
    normals `normal` (M, X, 3), out of the pinion; `levers` (2, M, X), mm: at which pressure there turns pinion and gear about
    their axes, positive; `places` (2, M, X, 3): ridge points in the frame of the tooth of either member that touches there.
    """

    dx: Array
    dy: Array
    gap: Array
    on: NDArray[np.bool_]
    middle: Array
    normal: Array
    levers: Array
    places: Array


def separation(near: NearPairs, force: Array, modulus: float, cells: tuple[int, int], widen: Array) -> Separation:
    """Gaps on grids of `cells` (X, Y) as wide as forces (M,), N, under E* `modulus` (MPa) want them, times `widen` (M,)."""
    surfaces = _Surfaces(near)
    low, high = _range(surfaces, near)
    along, across = _sizes(near, force, modulus, np.maximum(0.5 * (high - low), LEAST))
    low, high = np.maximum(low, -MARGIN * along), np.minimum(high, MARGIN * along)
    high = np.maximum(high, low + LEAST)
    half = MARGIN * across * widen
    dx, dy = (high - low) / cells[0], 2.0 * half / cells[1]
    x = low[:, None] + dx[:, None] * (np.arange(cells[0]) + 0.5)
    ridge = surfaces.ridge(x)
    nodes = np.cos(np.pi * np.arange(ACROSS) / (ACROSS - 1))
    every = np.repeat(x[:, :, None], ACROSS, axis=2)
    seen = surfaces.at(every, ridge[:, :, None] + half[:, None, None] * nodes)
    middle = surfaces.at(x, ridge)
    normal = unit(middle.normals[0] - middle.normals[1])
    slant = dot(normal, near.axes[:, None, :, 2])
    eta = (np.arange(cells[1]) + 0.5) * 2.0 / cells[1] - 1.0
    powers = np.polynomial.chebyshev.chebvander(eta, ACROSS - 1) @ np.linalg.inv(
        np.polynomial.chebyshev.chebvander(nodes, ACROSS - 1)
    )
    exact, margin = _continued(seen, half[:, None, None] * nodes, near.kappa[:, 1])
    gap = (exact @ powers.T) * slant[:, :, None]
    order = np.argsort(nodes)
    hat = np.stack([np.interp(eta, nodes[order], row[order]) for row in np.eye(ACROSS)], axis=-1)
    on = (margin @ hat.T <= 0.0) & np.isfinite(gap)
    levers = np.stack([np.abs(dot(normal, flank.mount.velocity(middle.points[0]))) for flank in near.pair.flanks])
    places = np.stack(
        [
            _each(own.rotation.swapaxes(1, 2), middle.points[0] - own.translation[:, None])
            for own in surfaces.own_to_fixed
        ]
    )
    return Separation(dx, dy, np.where(on, gap, 0.0), on, middle.points[0], normal, levers, places)


def _continued(seen: _Seen, y: Array, kappa: Array) -> tuple[Array, Array]:
    """Gaps and margins (M, X, ACROSS) at y (M, 1, ACROSS) from the ridge; where a surface ends, by a parabola and |y|."""
    there, middle = np.isfinite(seen.gap), ACROSS // 2
    bend = 0.5 * kappa[:, None, None] * y**2
    rest = np.where(there, seen.gap - seen.gap[:, :, middle : middle + 1] - bend, 0.0)
    away = np.where(there, y, 0.0)
    with np.errstate(all="ignore"):
        slope = np.nan_to_num((rest * away).sum(axis=2) / (away**2).sum(axis=2))
    guess = seen.gap[:, :, middle : middle + 1] + slope[:, :, None] * y + bend
    return np.where(there, seen.gap, guess), np.where(np.isfinite(seen.margin), seen.margin, np.abs(y))


def _sizes(near: NearPairs, force: Array, modulus: float, length: Array) -> tuple[Array, Array]:
    """Half axes (M,) along and across, mm, under forces (M,) of contacts at most half a `length` (M,) long."""
    small, large = near.kappa[:, 0], np.maximum(near.kappa[:, 1], 1e-9)
    ellipse = point_contact(np.maximum(small, 1e-6 * large), large, force, modulus)
    line = line_contact(large, 0.5 * force / length, modulus)
    is_line = ellipse.semi_major > length
    return np.where(is_line, length, ellipse.semi_major), np.where(is_line, line.half_width, ellipse.semi_minor)


def _range(surfaces: _Surfaces, near: NearPairs) -> tuple[Array, Array]:
    """Between which x (M,) the ridge lies on both flanks."""
    low, high = surfaces.extent()
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
        ends.append(x[every, last] + np.clip(way, 0.0, 1.0) * (x[every, beyond] - x[every, last]))
    return ends[0], ends[1]


@dataclass(frozen=True)
class _Seen:
    """Both flanks over places in the tangent planes: `gap` (...,) mm, how far (mm) the place lies outside either (`margin`), points
    and outward normals (..., 3) of both, fixed frame."""

    gap: Array
    margin: Array
    points: tuple[Array, Array]
    normals: tuple[Array, Array]


class _Surfaces:
    """The flanks of near pairs over their tangent planes."""

    def __init__(self, near: NearPairs) -> None:
        self._near = near
        self.own_to_fixed = []
        for flank, turn in zip(near.pair.flanks, near.turns, strict=True):
            own = flank.mount.at(turn)
            shape = near.path.point.shape
            self.own_to_fixed.append(
                Rigid(np.broadcast_to(own.rotation, near.axes.shape), np.broadcast_to(own.translation, shape))
            )
        self._frames = [
            Rigid(own.rotation.swapaxes(-1, -2) @ near.axes, own.inverse.point(near.path.point))
            for own in self.own_to_fixed
        ]
        self._edge = near.path.kind == "edge"

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
        """y (M, K) of the least gap at x (M, K); where an edge touches first the ridge is that edge, y = 0."""
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
        return y

    def at(self, x: Array, y: Array) -> _Seen:
        """Both flanks over places x, y (M, ...)."""
        heights, margins, points, normals = [], [], [], []
        for flank, own, frame in zip(self._near.pair.flanks, self.own_to_fixed, self._frames, strict=True):
            seen = _over(flank, frame, x, y)
            heights.append(seen[0])
            margins.append(seen[1])
            points.append(_each(own.rotation, seen[2]) + own.translation.reshape(-1, *(1,) * (x.ndim - 1), 3))
            normals.append(_each(own.rotation, seen[3]))
        return _Seen(heights[1] - heights[0], np.maximum(*margins), (points[0], points[1]), (normals[0], normals[1]))


def _each(rotation: Array, vectors: Array) -> Array:
    """Vectors (M, ..., 3), each turned by its own of rotations (M, 3, 3)."""
    found: Array = np.einsum("mij,m...j->m...i", rotation, vectors)
    return found


def _over(flank: Flank, frame: Rigid, x: Array, y: Array) -> tuple[Array, Array, Array, Array]:
    """Of a flank over places x, y (M, ...) of planes `frame` (M,), own frame: heights along the third axis, how far outside the
    flank, mm, (M, ...), points and normals (M, ..., 3); NaN where the surface has none."""
    member = np.broadcast_to(np.arange(len(x)).reshape(-1, *(1,) * (x.ndim - 1)), x.shape).ravel()
    axes, origin = frame.rotation[member], frame.translation[member]
    wanted = np.stack((x.ravel(), y.ravel()), axis=-1)
    place = origin + np.einsum("kij,kj->ki", axes[:, :, :2], wanted)
    start = flank.heights.parameters_at(flank.mount.course.reach(place), place[:, 2])

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
