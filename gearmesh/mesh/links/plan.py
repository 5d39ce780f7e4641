"""What a link asks of its mesh: how many lines across it, where on each of them the nodes are, how many triangles that
takes.

With the second form L ds^2 + 2 M ds dt + N dt^2 of a link (see `forms`), an edge (ds, dt) misses the surface by an
eighth of it. Nodes on lines of constant s are as far apart as the lines allow, |N| dt^2 <= 8 eps, on each line for
itself; then the widest strip ds between lines follows in closed form, in one of four ways:

    conjugate   diagonals run in the conjugate direction dt/ds = -M / N, whatever the nodes' places: L becomes L - M^2
                / N, M vanishes
    plain       along the sections, whatever the places
    aligned     along the sections, all lines with nodes at the same stations: the better diagonal of a cell, |L ds^2 -
                2 |M| ds dt + N dt^2|
    staggered   the same stations, on every other line half a cell further: |L ds^2 +- M ds dt + N dt^2 / 4|

Where L N < M^2 only edges count, and conjugate cells are within 2 / sqrt(5) of the largest triangles that there are.
Where L N > M^2 the distance peaks inside an acute triangle, at half the square of its circumradius in the metric of
the form. Where a surface is curved little along s, as a face gear's flanks are, M alone counts, and staggered cells
are the best. On a developable flank the conjugate diagonals are rulings and one strip is as wide as the flank; on the
thread of a worm, whose sections go round the axis as its helices do, they cross it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, spline_through
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.lines import ROUNDING

#: so much closer than they need be may nodes on lines be
CLOSER = np.geomspace(1.0, 8.0, 10)
#: the second form along a line counts as at least this share of its largest there: nodes are not farther apart
LEAST = 0.02
#: and at least this share of its largest on the link
EVER = 0.01
#: chords may leave their lines within the surface by this share of the strips beside them: more, and facets would overlap
SIDEWAYS = 0.2
#: steps of bisection for the widest strip
HALVINGS = 8
#: stations on which levels are kept: a worm's diagonals are drawn by them over several turns
STATIONS = 65
#: diagonals may run along no more than so many times the whole face
STEEP = 5.0
#: and slopes count as no more than that
SLOPE = 15.0
#: triangles that a cell of a seam costs a link that has no use for it: one on the edge, and those that are out of shape
SEAM = 2.0
#: a plan with shear is taken if it has no more than this share of the triangles of one without
WORTH = 0.97
#: on links of so few cells along the face all nodes of section curves that need no more than so many times the lines' are on lines
FEW, CLOSE = 1.5, 1.5


@dataclass(frozen=True)
class LinkPlan:
    """`across`: samples s (S,) and strips per unit of s; `along` (S, T): cells per unit of t on lines; levels (S,
    STATIONS).

    The diagonals are to follow the lines of constant level over (s, t). `alike`: all lines have nodes at the same
    stations, if `staggered` every other one half a cell further. `outline`: cells per unit of s of the section curves
    at toe and heel, as pairs (s, density). `otherwise` is the plan without shear of a link that has it. `triangles`:
    about how many it takes.
    """

    across: tuple[Array, Array]
    along: Array
    level: Array
    outline: tuple[tuple[Array, Array], tuple[Array, Array]]
    alike: bool = False
    staggered: bool = False
    triangles: float = 0.0
    otherwise: LinkPlan | None = None

    def with_more_nodes(self, s: Array, factor: Array) -> LinkPlan:
        """With so many times (n,) more nodes on and next to the lines at s (n,); if all lines are alike on all of
        them.
        """
        count = len(self.along)
        if self.alike:
            return replace(self, along=self.along * factor.max())
        more, near = np.ones(count), np.rint(s * (count - 1)).astype(int)
        for step in (-1, 0, 1):
            np.maximum.at(more, np.clip(near + step, 0, count - 1), factor)
        return replace(self, along=self.along * more[:, None])


@dataclass(frozen=True)
class _Way:
    """A way to mesh links, tried with nodes closer by each of CLOSER (C): `along`, `across` (C, R, S, T), `triangles`
    (C, R) and the `seams` (2, C, R), cells on the first and the last line.
    """

    along: Array
    across: Array
    triangles: Array
    alike: bool
    staggered: bool
    seams: Array

    @staticmethod
    def of(along: Array, across: Array, *, alike: bool, staggered: bool) -> _Way:
        s, t = (np.linspace(0.0, 1.0, n) for n in along.shape[2:])
        nodes = np.asarray(np.trapezoid(along, t, axis=-1)) + 0.5 * staggered
        strips = across.max(axis=-1)
        total = np.trapezoid(strips, s, axis=-1)
        count = np.maximum(np.ceil(total - ROUNDING), 1.0)
        if staggered:
            # the last line is a seam, and nothing is staggered there
            count = 2.0 * np.ceil(0.5 * count)
        triangles = 2.0 * count / total * np.trapezoid(strips * nodes, s, axis=-1)
        return _Way(along, across, triangles, alike, staggered, np.stack((nodes[..., 0], nodes[..., -1])))


def link_plans(
    forms: Forms, tolerance: float, at_ends: float, *, straight: bool = False, whole: bool = False
) -> list[LinkPlan]:
    """Of each link the plan with the fewest triangles, those that its seams cost its neighbours included.

    `at_ends`: tolerance (mm) of the outline of the end faces; `straight`: without shear, as where the surfaces have
    corners at stations; `whole`: the last link of a tooth ends where the next tooth begins.
    """
    samples = np.linspace(0.0, 1.0, forms.length.shape[1])
    slope = _slopes(forms, tolerance)
    ways = _ways(forms, slope, tolerance)
    every = np.arange(len(slope))
    costs = _costs(ways, whole)
    closest = np.array([cost.argmin(axis=0) for cost in costs])
    triangles = np.array([cost[of, every] for cost, of in zip(costs, closest, strict=True)])
    # the first way is the one with shear
    plain = 1 + triangles[1:].argmin(axis=0)
    sheared = (triangles[0] <= WORTH * triangles[plain, every]) & (not straight)
    level = np.tile(np.linspace(0.0, 1.0, STATIONS), (samples.size, 1))
    density = np.sqrt(forms.outline / (8.0 * at_ends))
    plans = []

    def plan(k: int, w: int, level: Array, otherwise: LinkPlan | None = None) -> LinkPlan:
        way, of = ways[w], closest[w, k]
        across = way.across[of, k].max(axis=-1)
        if np.trapezoid(way.along[of, k], dx=1.0 / (way.along.shape[-1] - 1), axis=-1).max() <= FEW:
            across = np.maximum(across, np.where(density[k] <= CLOSE * across, density[k], 0.0).max(axis=0))
        outline = (samples, density[k, 0]), (samples, density[k, 1])
        return LinkPlan(
            (samples, across),
            way.along[of, k],
            level,
            outline,
            way.alike,
            way.staggered,
            float(way.triangles[of, k]),
            otherwise,
        )

    for k in every.tolist():
        plans.append(plan(k, int(plain[k]), level))
        if sheared[k]:
            shear = _levels(slope[k])
            if np.abs(shear - level).max() <= STEEP:
                plans[k] = plan(k, 0, shear, plans[k])
    return plans


def _costs(ways: tuple[_Way, ...], whole: bool) -> list[Array]:
    """Triangles (C, R) of each way, and those that its seams cost the links on the other side of them, by the cells that these
    want there if each has the fewest triangles."""
    triangles, every = np.concatenate([way.triangles for way in ways]), np.arange(ways[0].triangles.shape[1])
    first, last = np.concatenate([way.seams for way in ways], axis=1)[:, triangles.argmin(axis=0), every]
    before, after = np.roll(last, 1), np.roll(first, -1)
    if not whole:
        before[0] = after[-1] = np.inf
    wanted = np.stack((before, after))[:, None]
    return [way.triangles + SEAM * np.maximum(way.seams - wanted, 0.0).sum(axis=0) for way in ways]


def _sizes(forms: Forms) -> Array:
    """|N| (R, S, T), or what takes its place beside stations where N passes through 0: there M^2 / |L|, at most what N
    has on the line.

    With nodes that close the diagonals lean by L / M, so that they have L, and strips are as wide as L and M let them
    be.
    """
    size = np.abs(forms.face)
    with np.errstate(divide="ignore", invalid="ignore"):
        instead = np.nan_to_num(forms.twist**2 / np.abs(forms.length), nan=0.0)
    sizes: Array = np.maximum(size, np.minimum(instead, size.max(axis=-1, keepdims=True)))
    return sizes


def _slopes(forms: Forms, tolerance: float) -> Array:
    """M / N (R, S, T), of which the conjugate direction is the negative, no larger than where N is small beside the
    rest of its line.
    """
    size = _sizes(forms)
    least = np.maximum(LEAST * size.max(axis=-1, keepdims=True), 8e-6 * tolerance)
    slopes: Array = np.clip(forms.twist / np.copysign(np.maximum(size, least), forms.face), -SLOPE, SLOPE)
    return slopes


def _ways(forms: Forms, slope: Array, tolerance: float) -> tuple[_Way, ...]:
    length, twist, face, limit = forms.length, forms.twist, forms.face, 8.0 * tolerance
    t, size, closer = np.linspace(0.0, 1.0, face.shape[-1]), np.abs(face), CLOSER[:, None, None, None]

    def whole(size: Array) -> Array:
        """Cells per unit of t, a whole number of cells on each line."""
        least = np.maximum(LEAST * size.max(axis=-1, keepdims=True), EVER * size.max(axis=(-2, -1), keepdims=True))
        size = np.maximum(size, np.maximum(least, 1e-6 * limit))
        along = closer * np.sqrt(size / limit)
        nodes = np.trapezoid(along, t, axis=-1)
        cells: Array = along * (np.maximum(np.ceil(nodes - ROUNDING), 1.0) / nodes)[..., None]
        return cells

    def not_folded(along: Array, widest: Array) -> Array:
        """More cells where chords would leave their lines by more than a part of the strips beside them."""
        least = np.sqrt(forms.sideways / (8.0 * SIDEWAYS * np.minimum(widest, 1.0)))
        return np.maximum(along, least)

    own, instead = whole(size), whole(_sizes(forms))
    alike = np.broadcast_to(whole(size.max(axis=1, keepdims=True)), own.shape)
    conjugate, rest = length - slope * (2.0 * twist - slope * face), twist - slope * face
    tried: tuple[tuple[Array, Callable[[Array], Array], bool, bool], ...] = (
        (instead, lambda dt: _widest(conjugate, rest, face, dt, limit), False, False),
        (own, lambda dt: _widest(length, twist, face, dt, limit), False, False),
        (alike, lambda dt: _widest_aligned(length, twist, face, dt, limit), True, False),
        (alike, lambda dt: _widest_staggered(length, twist, face, dt, limit), True, True),
    )
    ways = []
    for along, widest, same, staggered in tried:
        ds = widest(1.0 / along)
        closer_yet = not_folded(along, ds)
        if same:
            closer_yet = np.broadcast_to(closer_yet.max(axis=2, keepdims=True), along.shape)
        if (closer_yet > 1.001 * along).any():
            along, ds = closer_yet, widest(1.0 / closer_yet)
        ways.append(_Way.of(along, 1.0 / ds, alike=same, staggered=staggered))
    return tuple(ways)


def _widest(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Widest ds between lines whose nodes are dt apart, wherever they are: edges within `limit`, 8 eps.

    Where L N > M^2 of a right-angled triangle as the worst, of L ds^2 + |M| ds dt + N dt^2.
    """
    widest = _on_edges(length, twist, face, dt, limit)
    size, half, rest = np.maximum(np.abs(length), 1e-6 * limit), 0.5 * np.abs(twist) * dt, np.abs(face) * dt**2
    bowl = (np.sqrt(half**2 + size * np.maximum(limit - rest, 1e-9 * limit)) - half) / size
    return np.where(length * face > twist**2, np.clip(bowl, 1e-5, 1e3), widest)


def _on_edges(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Widest ds from the edge along s and the better diagonal.

    L is made positive by turning the normal; then L ds^2 - 2 |M| dt ds + N dt^2 must lie within +-8 eps.
    """
    sign = np.where(length < 0.0, -1.0, 1.0)
    length = np.maximum(np.abs(length), limit * 1e-6)
    half = np.abs(twist) * dt
    rest = sign * face * dt**2
    upper = (half + np.sqrt(np.maximum(half**2 - length * (rest - limit), 0.0))) / length
    dips = half**2 - length * (rest + limit)
    lower = (half - np.sqrt(np.maximum(dips, 0.0))) / length
    ds = np.where((dips > 0.0) & (lower > 0.0), lower, upper)
    return np.clip(np.minimum(ds, np.sqrt(limit / length)), 1e-5, 1e3)


def _widest_aligned(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Widest ds where lines have their nodes at the same stations."""
    bound = length * face - twist**2

    def edges(ds: Array, length: Array, twist: Array, face: Array, dt: Array) -> tuple[Array, Array, Array]:
        along, across = np.abs(face) * dt**2, np.abs(length) * ds**2
        return along, across, along + across - 2.0 * np.abs(twist) * ds * dt

    widest = _on_edges(length, twist, face, dt, limit)
    return _inside(widest, edges, (length, twist, face, dt), bound * dt**2, limit)


def _widest_staggered(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Widest ds where every other line has its nodes half a cell further: |L ds^2 + N dt^2 / 4| + |M| ds dt within 8
    eps.
    """
    skew, quarter = np.abs(twist) * dt, 0.25 * face * dt**2
    ds = np.full_like(skew, 1e3)
    for sign in (1.0, -1.0):
        rest = limit - sign * quarter
        under = skew**2 + 4.0 * sign * length * rest
        with np.errstate(divide="ignore", invalid="ignore"):
            first = 2.0 * rest / (skew + np.sqrt(under))
        ds = np.where(under >= 0.0, np.fmin(ds, first), ds)
    ds = np.clip(ds, 1e-5, 1e3)

    def edges(ds: Array, length: Array, skew: Array, quarter: Array) -> tuple[Array, Array, Array]:
        even = np.abs(length) * ds**2 + np.abs(quarter)
        return 4.0 * np.abs(quarter), even + skew * ds, even - skew * ds

    return _inside(ds, edges, (length, skew, quarter), (length * face - twist**2) * dt**2, limit)


def _inside(
    widest: Array, edges: Callable[..., tuple[Array, Array, Array]], given: tuple[Array, ...], bowl: Array, limit: float
) -> Array:
    """Widest ds up to `widest` where triangles with edges of the given forms by ds keep their insides within `limit`,
    8 eps.

    `edges` of ds and of what is `given`, which broadcasts to the shape of `widest`; `bowl`: (L N - M^2) dt^2, of which only
    what is above 0 asks for that. The distance inside an acute triangle is
    half the square of its circumradius, a b c / (4 ds^2 dt^2 (L N - M^2)).
    """
    curved = bowl > 0.0
    if not curved.any():
        return widest
    bowl, own = bowl[curved], [np.broadcast_to(of, widest.shape)[curved] for of in given]
    low, high = np.full_like(bowl, 1e-5), widest[curved]
    for _ in range(HALVINGS):
        # the whole is tried first
        middle = high if _ == 0 else 0.5 * (low + high)
        a, b, c = edges(middle, *own)
        acute = a + b + c > 2.0 * np.maximum(np.maximum(a, b), c)
        good = ~acute | (a * b * c <= limit * middle**2 * bowl)
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    widest = widest.copy()
    widest[curved] = low
    return widest


def _levels(slope: Array) -> Array:
    """Level (S, STATIONS) of slopes M / N (S, T) by s and t: where the line dt/ds = -slope through each place meets s
    = 0.

    By Heun's method. Slopes that are taken straight between the samples, or at the end of a step where it begins, turn
    the diagonals of a worm's root by degrees.
    """
    s, coarse, t = (np.linspace(0.0, 1.0, n) for n in (*slope.shape, STATIONS))
    level = np.tile(t, (s.size, 1))
    if not slope.any():
        return level
    fine = spline_through(coarse, slope.T, CUBIC_DEGREE)(t).T
    for k in range(s.size - 1, 0, -1):
        step = s[k] - s[k - 1]
        here = np.interp(level[k:], t, fine[k])
        there = np.interp(level[k:] + step * here, t, fine[k - 1])
        level[k:] += 0.5 * step * (here + there)
    return level
