"""Plan of the mesh of a link: the lines across it, the nodes on each line, and the number of triangles.

A link has the second form L ds^2 + 2 M ds dt + N dt^2 (see `forms`). The distance of an edge (ds, dt) from the surface
is an eighth of this form. Nodes on a line of constant s are as far apart as the line allows, |N| dt^2 <= 8 eps. The
widest strip ds between lines then follows in closed form, in one of four ways:

    conjugate   Diagonals in the conjugate direction dt/ds = -M / N, nodes at any stations: L becomes L - M^2 / N, M vanishes.
    plain       Edges along the sections, nodes at any stations.
    aligned     Edges along the sections, nodes of all lines at the same stations. The better diagonal of a cell counts:
                |L ds^2 - 2 |M| ds dt + N dt^2|.
    staggered   The same stations, on every other line half a cell further: |L ds^2 +- M ds dt + N dt^2 / 4|.

Where L N < M^2, only edges count, and the area of conjugate cells is 2 / sqrt(5) of the largest possible triangles. Where
L N > M^2, the distance has its extreme inside an acute triangle: half the square of the circumradius in the metric of the
form. Where the surface is hardly curved along s, as the flanks of a face gear, M alone counts, and staggered cells are best.
On a developable flank the conjugate diagonals are rulings, and one strip is as wide as the flank. On the thread of a worm,
whose sections go around the axis as its helices do, the diagonals cross the thread.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, spline_through
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.lines import CELL_ROUNDING_SHARE
from gearmesh.records import dataclass

#: factors by which nodes on lines are tried closer than the lines need
CLOSER_FACTORS = np.geomspace(1.0, 8.0, 10)
#: least second form along a line, as a share of its largest on the line: it limits the distance of nodes
MIN_LINE_SHARE = 0.02
#: least second form along a line, as a share of its largest on the link
MIN_LINK_SHARE = 0.01
#: largest distance within the surface of a chord from its line, as a share of the strip beside it: facets must not overlap
SIDEWAYS_SHARE = 0.2
#: steps of bisection for the widest strip
BISECTION_STEPS = 8
#: stations at which levels are kept; the diagonals of a worm follow them over several turns
LEVEL_STATIONS = 65
#: longest diagonal along the face, in face widths
MAX_LEVEL_SHEAR = 5.0
#: largest slope of diagonals
MAX_SLOPE = 15.0
#: cost, in triangles, of a cell of a seam for the link that does not need it: a triangle on the edge and badly shaped ones
SEAM_CELL_COST = 2.0
#: largest number of triangles of a plan with shear, as a share of the number without shear, for the plan to be taken
SHEAR_COST_SHARE = 0.97
#: largest number of cells along the face for which nodes of the section curves are put on lines
FEW_FACE_CELLS = 1.5
#: largest density of the section curves, over the density of lines, for which this is done
CLOSE_DENSITY_RATIO = 1.5


@dataclass(frozen=True)
class LinkPlan:
    """Plan of a link: densities of lines and nodes, and the direction of diagonals."""

    #: samples s (S,), and strips per unit of s (S,)
    across: tuple[Array, Array]
    #: cells per unit of t (S, T) on lines
    along: Array
    #: levels (S, LEVEL_STATIONS) over s and t: diagonals follow the lines of constant level
    level: Array
    #: cells per unit of s of the section curves at toe and heel, as pairs (s, density)
    outline: tuple[tuple[Array, Array], tuple[Array, Array]]
    #: True if all lines have nodes at the same stations
    alike: bool = False
    #: True if every other line has them half a cell further
    staggered: bool = False
    #: estimated number of triangles
    triangles: float = 0.0
    #: plan without shear, if this plan has shear
    otherwise: LinkPlan | None = None

    def with_more_nodes(self, s: Array, factor: Array) -> LinkPlan:
        """Return the plan with more nodes on and beside the lines at s (n,), by factors (n,); if alike, on all lines."""
        count = len(self.along)
        if self.alike:
            return replace(self, along=self.along * factor.max())
        more, near = np.ones(count), np.rint(s * (count - 1)).astype(int)
        for step in (-1, 0, 1):
            np.maximum.at(more, np.clip(near + step, 0, count - 1), factor)
        return replace(self, along=self.along * more[:, None])


@dataclass(frozen=True)
class _Way:
    """A way to mesh R links, tried with nodes closer by each of C CLOSER_FACTORS."""

    #: cells per unit of t (C, R, S, T) on lines
    along: Array
    #: strips per unit of s (C, R, S, T)
    across: Array
    #: number of triangles (C, R)
    triangles: Array
    #: True if all lines have nodes at the same stations
    alike: bool
    #: True if every other line has them half a cell further
    staggered: bool
    #: number of cells (2, C, R) on the first and last line
    seams: Array

    @staticmethod
    def of(along: Array, across: Array, *, alike: bool, staggered: bool) -> _Way:
        """Return the way with its triangles counted."""
        s, t = (np.linspace(0.0, 1.0, n) for n in along.shape[2:])
        nodes = np.asarray(np.trapezoid(along, t, axis=-1)) + 0.5 * staggered
        strips = across.max(axis=-1)
        total = np.trapezoid(strips, s, axis=-1)
        count = np.maximum(np.ceil(total - CELL_ROUNDING_SHARE), 1.0)
        if staggered:
            # the last line is a seam, which is not staggered: the number of strips is even
            count = 2.0 * np.ceil(0.5 * count)
        triangles = 2.0 * count / total * np.trapezoid(strips * nodes, s, axis=-1)
        return _Way(along, across, triangles, alike, staggered, np.stack((nodes[..., 0], nodes[..., -1])))


def link_plans(
    forms: Forms, tolerance: float, at_ends: float, *, straight: bool = False, whole: bool = False
) -> list[LinkPlan]:
    """Return the plan of each link with the fewest triangles; the cost of its seams for its neighbours counts, too.

    - tolerance: mm.
    - at_ends: tolerance, mm, of the outline of the end faces.
    - straight: True for plans without shear, as surfaces with corners at stations need.
    - whole: True if the last link of a tooth ends at the first link of the next tooth.
    """
    # each link is planned in all four ways, with nodes closer by several factors; each way keeps its cheapest factor
    samples = np.linspace(0.0, 1.0, forms.length.shape[1])
    slope = _slopes(forms, tolerance)
    ways = _ways(forms, slope, tolerance)
    every = np.arange(len(slope))
    costs = _costs(ways, whole)
    closest = np.array([cost.argmin(axis=0) for cost in costs])
    triangles = np.array([cost[factor, every] for cost, factor in zip(costs, closest, strict=True)])
    # the first way is conjugate, with shear
    plain = 1 + triangles[1:].argmin(axis=0)
    sheared = (triangles[0] <= SHEAR_COST_SHARE * triangles[plain, every]) & (not straight)
    level = np.tile(np.linspace(0.0, 1.0, LEVEL_STATIONS), (samples.size, 1))
    # chords of the section curves have the sag h^2 / 8 times the second derivative
    density = np.sqrt(forms.outline / (8.0 * at_ends))
    plans = []

    def plan(k: int, w: int, level: Array, otherwise: LinkPlan | None = None) -> LinkPlan:
        """Return the plan of link k by way w."""
        way, factor = ways[w], closest[w, k]
        across = way.across[factor, k].max(axis=-1)
        # few cells along the face: lines are put on the nodes of the section curves, if these are hardly denser
        if np.trapezoid(way.along[factor, k], dx=1.0 / (way.along.shape[-1] - 1), axis=-1).max() <= FEW_FACE_CELLS:
            across = np.maximum(
                across, np.where(density[k] <= CLOSE_DENSITY_RATIO * across, density[k], 0.0).max(axis=0)
            )
        outline = (samples, density[k, 0]), (samples, density[k, 1])
        return LinkPlan(
            (samples, across),
            way.along[factor, k],
            level,
            outline,
            way.alike,
            way.staggered,
            float(way.triangles[factor, k]),
            otherwise,
        )

    for k in every.tolist():
        plans.append(plan(k, int(plain[k]), level))
        if sheared[k]:
            shear = _levels(slope[k])
            # diagonals that lean over too many face widths are not used
            if np.abs(shear - level).max() <= MAX_LEVEL_SHEAR:
                plans[k] = plan(k, 0, shear, plans[k])
    return plans


def _costs(ways: tuple[_Way, ...], whole: bool) -> list[Array]:
    """Return the costs (C, R) of each way: its triangles, and the cost of its seams for the links on their other sides.

    A neighbour wants the cells of its own cheapest way on the seam.
    """
    triangles, every = np.concatenate([way.triangles for way in ways]), np.arange(ways[0].triangles.shape[1])
    first, last = np.concatenate([way.seams for way in ways], axis=1)[:, triangles.argmin(axis=0), every]
    before, after = np.roll(last, 1), np.roll(first, -1)
    if not whole:
        before[0] = after[-1] = np.inf
    wanted = np.stack((before, after))[:, None]
    return [way.triangles + SEAM_CELL_COST * np.maximum(way.seams - wanted, 0.0).sum(axis=0) for way in ways]


def _sizes(forms: Forms) -> Array:
    """Return |N| (R, S, T); near stations where N passes through 0 it is M^2 / |L|, at most the largest |N| of the line.

    With nodes at that distance the diagonals lean by L / M, and the strips are as wide as L and M allow.
    """
    size = np.abs(forms.face)
    with np.errstate(divide="ignore", invalid="ignore"):
        instead = np.nan_to_num(forms.twist**2 / np.abs(forms.length), nan=0.0)
    sizes: Array = np.maximum(size, np.minimum(instead, size.max(axis=-1, keepdims=True)))
    return sizes


def _slopes(forms: Forms, tolerance: float) -> Array:
    """Return M / N (R, S, T), the negative slope of the conjugate direction, limited where N is small on its line."""
    size = _sizes(forms)
    least = np.maximum(MIN_LINE_SHARE * size.max(axis=-1, keepdims=True), 8e-6 * tolerance)
    slopes: Array = np.clip(forms.twist / np.copysign(np.maximum(size, least), forms.face), -MAX_SLOPE, MAX_SLOPE)
    return slopes


def _ways(forms: Forms, slope: Array, tolerance: float) -> tuple[_Way, ...]:
    """Return the four ways of the head of this module, in its order."""
    length, twist, face, limit = forms.length, forms.twist, forms.face, 8.0 * tolerance
    t, size, closer = np.linspace(0.0, 1.0, face.shape[-1]), np.abs(face), CLOSER_FACTORS[:, None, None, None]

    def whole(size: Array) -> Array:
        """Return the cells per unit of t for a form along the lines; each line has a whole number of cells."""
        least = np.maximum(
            MIN_LINE_SHARE * size.max(axis=-1, keepdims=True), MIN_LINK_SHARE * size.max(axis=(-2, -1), keepdims=True)
        )
        size = np.maximum(size, np.maximum(least, 1e-6 * limit))
        along = closer * np.sqrt(size / limit)
        nodes = np.trapezoid(along, t, axis=-1)
        cells: Array = along * (np.maximum(np.ceil(nodes - CELL_ROUNDING_SHARE), 1.0) / nodes)[..., None]
        return cells

    def not_folded(along: Array, widest: Array) -> Array:
        """Return more cells where chords would leave their lines by more than SIDEWAYS_SHARE of the strips beside them."""
        least = np.sqrt(forms.sideways / (8.0 * SIDEWAYS_SHARE * np.minimum(widest, 1.0)))
        return np.maximum(along, least)

    # N along the lines: as it is, or M^2 / |L| where N vanishes; aligned nodes need the largest N of all lines
    plain, instead = whole(size), whole(_sizes(forms))
    alike = np.broadcast_to(whole(size.max(axis=1, keepdims=True)), plain.shape)
    # second form in the basis of s along the diagonal and t: L - 2 slope M + slope^2 N, and M - slope N
    conjugate, rest = length - slope * (2.0 * twist - slope * face), twist - slope * face
    tried: tuple[tuple[Array, Callable[[Array], Array], bool, bool], ...] = (
        (instead, lambda dt: _widest(conjugate, rest, face, dt, limit), False, False),
        (plain, lambda dt: _widest(length, twist, face, dt, limit), False, False),
        (alike, lambda dt: _widest_aligned(length, twist, face, dt, limit), True, False),
        (alike, lambda dt: _widest_staggered(length, twist, face, dt, limit), True, True),
    )
    ways = []
    for along, widest, same, staggered in tried:
        ds = widest(1.0 / along)
        # if chords would leave their lines too far, nodes get closer, and the strips follow from the closer nodes
        closer_yet = not_folded(along, ds)
        if same:
            closer_yet = np.broadcast_to(closer_yet.max(axis=2, keepdims=True), along.shape)
        if (closer_yet > 1.001 * along).any():
            along, ds = closer_yet, widest(1.0 / closer_yet)
        ways.append(_Way.of(along, 1.0 / ds, alike=same, staggered=staggered))
    return tuple(ways)


def _widest(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Return the widest ds between lines with nodes dt apart at any stations, with edges within `limit` = 8 eps.

    Where L N > M^2, the worst triangle is right-angled: L ds^2 + |M| ds dt + N dt^2.
    """
    widest = _on_edges(length, twist, face, dt, limit)
    size, half, rest = np.maximum(np.abs(length), 1e-6 * limit), 0.5 * np.abs(twist) * dt, np.abs(face) * dt**2
    bowl = (np.sqrt(half**2 + size * np.maximum(limit - rest, 1e-9 * limit)) - half) / size
    return np.where(length * face > twist**2, np.clip(bowl, 1e-5, 1e3), widest)


def _on_edges(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Return the widest ds by the edge along s and the better diagonal.

    The normal is turned so that L is positive. Then L ds^2 - 2 |M| dt ds + N dt^2 must lie within +-8 eps.
    """
    sign = np.where(length < 0.0, -1.0, 1.0)
    length = np.maximum(np.abs(length), limit * 1e-6)
    half = np.abs(twist) * dt
    rest = sign * face * dt**2
    upper = (half + np.sqrt(np.maximum(half**2 - length * (rest - limit), 0.0))) / length
    # if the parabola dips below -8 eps, ds must stay before the dip
    dips = half**2 - length * (rest + limit)
    lower = (half - np.sqrt(np.maximum(dips, 0.0))) / length
    ds = np.where((dips > 0.0) & (lower > 0.0), lower, upper)
    return np.clip(np.minimum(ds, np.sqrt(limit / length)), 1e-5, 1e3)


def _widest_aligned(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Return the widest ds between lines with nodes at the same stations."""
    bound = length * face - twist**2

    def edges(ds: Array, length: Array, twist: Array, face: Array, dt: Array) -> tuple[Array, Array, Array]:
        """Return the forms of the three edges of a triangle."""
        along, across = np.abs(face) * dt**2, np.abs(length) * ds**2
        return along, across, along + across - 2.0 * np.abs(twist) * ds * dt

    widest = _on_edges(length, twist, face, dt, limit)
    return _inside(widest, edges, (length, twist, face, dt), bound * dt**2, limit)


def _widest_staggered(length: Array, twist: Array, face: Array, dt: Array, limit: float) -> Array:
    """Return the widest ds between staggered lines: |L ds^2 + N dt^2 / 4| + |M| ds dt within 8 eps."""
    skew, quarter = np.abs(twist) * dt, 0.25 * face * dt**2
    ds = np.full_like(skew, 1e3)
    for sign in (1.0, -1.0):
        rest = limit - sign * quarter
        under = skew**2 + 4.0 * sign * length * rest
        with np.errstate(divide="ignore", invalid="ignore"):
            # smallest positive root of sign L ds^2 + skew ds = rest, without cancellation; the nearer of both limits
            # counts
            first = 2.0 * rest / (skew + np.sqrt(under))
        ds = np.where(under >= 0.0, np.fmin(ds, first), ds)
    ds = np.clip(ds, 1e-5, 1e3)

    def edges(ds: Array, length: Array, skew: Array, quarter: Array) -> tuple[Array, Array, Array]:
        """Return the forms of the three edges of a triangle."""
        even = np.abs(length) * ds**2 + np.abs(quarter)
        return 4.0 * np.abs(quarter), even + skew * ds, even - skew * ds

    return _inside(ds, edges, (length, skew, quarter), (length * face - twist**2) * dt**2, limit)


def _inside(
    widest: Array, edges: Callable[..., tuple[Array, Array, Array]], given: tuple[Array, ...], bowl: Array, limit: float
) -> Array:
    """Return the widest ds, up to `widest`, with which the inside of triangles is within `limit` = 8 eps.

    - edges: function of ds and the `given` arrays that returns the forms a, b, c of the edges of a triangle.
    - given: arrays that broadcast to the shape of `widest`.
    - bowl: (L N - M^2) dt^2; only where it is above 0 can the inside be farther than the edges.

    The distance inside an acute triangle is half the square of its circumradius, a b c / (4 ds^2 dt^2 (L N - M^2)).
    """
    curved = bowl > 0.0
    if not curved.any():
        return widest
    bowl, arguments = bowl[curved], [np.broadcast_to(array, widest.shape)[curved] for array in given]
    low, high = np.full_like(bowl, 1e-5), widest[curved]
    for _ in range(BISECTION_STEPS):
        # the first step tries the whole width
        middle = high if _ == 0 else 0.5 * (low + high)
        a, b, c = edges(middle, *arguments)
        acute = a + b + c > 2.0 * np.maximum(np.maximum(a, b), c)
        good = ~acute | (a * b * c <= limit * middle**2 * bowl)
        low, high = np.where(good, middle, low), np.where(good, high, middle)
    widest = widest.copy()
    widest[curved] = low
    return widest


def _levels(slope: Array) -> Array:
    """Return the levels (S, LEVEL_STATIONS) for slopes M / N (S, T): the t at which the line dt/ds = -slope meets s = 0.

    The lines are integrated by Heun's method, with slopes from splines: with linear interpolation, or Euler's method, the
    diagonals at a worm's root would be turned by degrees.
    """
    s, coarse, t = (np.linspace(0.0, 1.0, n) for n in (*slope.shape, LEVEL_STATIONS))
    level = np.tile(t, (s.size, 1))
    if not slope.any():
        return level
    fine = spline_through(coarse, slope.T, CUBIC_DEGREE)(t).T
    for k in range(s.size - 1, 0, -1):
        # one step of Heun's method takes the levels of all later rows from s[k] to s[k - 1]
        step = s[k] - s[k - 1]
        here = np.interp(level[k:], t, fine[k])
        there = np.interp(level[k:] + step * here, t, fine[k - 1])
        level[k:] += 0.5 * step * (here + there)
    return level
