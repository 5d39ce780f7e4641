"""Ellipses, paths, contact lines, dots, patterns and gap maps, drawn on the exact surface of a tooth.

They are computed in the tangent plane of the contact and projected onto the exact surface by the caller's `project`.
Then they are lifted along the normal by `ToothView.lift`, a small fraction of the picture: enough to lie above the
facets of the mesh, too little to be seen as a gap:

    tangent plane  ----+----        ellipse, semi-axes a and b along `major` and `minor`
                     .. | ..        project: closest point of the trimmed flank, NaN beyond it
    exact flank   .-'   |   '-.     lift: 0.1 % of the tooth's bounding radius
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot, every_nth, unit
from gearmesh.kernel.numeric.lattice import bilinear
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.view.palette import EDGE_COLOUR, LINE_COLOUR, PATH_COLOUR
from gearmesh.view.scene import Curve, Dots, MemberContact, Project, ToothView

#: smallest extent of a path of contact that is drawn, in lifts
MIN_PATH_EXTENT_LIFTS = 10.0
#: cosine of the largest angle between neighbouring chords of a smooth curve; beyond it is a corner
MIN_SMOOTH_COSINE = 0.7
#: weight of a distance along the normal in an ellipse, relative to one along the major axis
NORMAL_DISTANCE_WEIGHT = 0.25
#: rings of points from the centre of an ellipse to its edge; chords between them are at most 0.4 pixels below the flank
#: (spiral bevel), discs are drawn at least 1.3 pixels above it
RINGS_PER_ELLIPSE = 5
#: rays from the centre of an ellipse; the last is the first
RAYS_PER_ELLIPSE = 145
#: share of a ray within which its end on the flank's edge is found
EDGE_SEARCH_SHARE = 6e-5
#: distance beyond the edges, mm, of places that have none, such as places without a closest point of the surface
BEYOND_MM = 1e3


@dataclass(frozen=True)
class _Ellipses:
    """Rays from the centres of E contact ellipses to their edges, or to the edges of the flank."""

    #: the contact
    contact: MemberContact
    #: positions (E,) of the ellipses
    chosen: NDArray[np.int64]
    #: projection onto the flank
    project: Project
    #: number of the rays; the last is the first
    rays: int

    @property
    def turn(self) -> Array:
        """Angles (E, rays) from the major axes, rad."""
        return np.broadcast_to(np.linspace(0.0, 2.0 * np.pi, self.rays), (len(self.chosen), self.rays))

    @property
    def which(self) -> NDArray[np.int64]:
        """Positions (E, rays)."""
        return np.broadcast_to(self.chosen[:, None], self.turn.shape)

    def above(self, which: NDArray[np.int64], angle: Array, part: Array) -> Array:
        """Points (..., 3) in the tangent planes, at parts of the radii of the ellipses `which`."""
        c = self.contact
        a, b = part * c.semi_major[which] * np.cos(angle), part * c.semi_minor[which] * np.sin(angle)
        point: Array = c.point[which] + a[..., None] * c.major[which] + b[..., None] * c.minor[which]
        return point

    def place(self, which: NDArray[np.int64], angle: Array, part: Array) -> Array:
        """Points (..., 3) on the flank, NaN beyond its edges."""
        return self.project(self.above(which, angle, part))

    @cached_property
    def rim(self) -> Array:
        """Edges (E, rays, 3) of whole ellipses on the flank, NaN beyond it."""
        return self.place(self.which, self.turn, np.ones(self.turn.shape))

    @property
    def outside(self) -> NDArray[np.bool_]:
        """True (E, rays) where an ellipse ends beyond the flank."""
        return np.asarray(~np.isfinite(self.rim[..., 0]))

    @cached_property
    def reach(self) -> Array:
        """Parts (E, rays) of the radii up to the edges of the flank; a nearest sample would leave steps."""
        reach, outside = np.ones(self.turn.shape), self.outside
        which, turn = self.which[outside], self.turn[outside]
        reach[outside] = _last_inside(
            lambda part, k: self.project.beyond(self.above(which[k], turn[k], part)),
            np.zeros(turn.shape),
            np.ones(turn.shape),
        )
        return reach

    @cached_property
    def edge(self) -> Array:
        """Edges (E, rays, 3) of the ellipses, cut off at the edges of the flank."""
        edge, outside = self.rim.copy(), self.outside
        edge[outside] = self.place(self.which[outside], self.turn[outside], self.reach[outside])
        return edge

    def discs(self, rings: int) -> Array:
        """Points (E, rings, rays, 3) from the centre to the edge."""
        part = np.linspace(0.0, 1.0, rings)[1:-1, None] * self.reach[:, None, :]
        which, turn = self.which[:, None], self.turn[:, None]
        within = self.place(np.broadcast_to(which, part.shape), np.broadcast_to(turn, part.shape), part)
        zero = np.zeros(len(self.chosen))
        middle = self.place(self.chosen, zero, zero)
        middle = np.broadcast_to(middle[:, None, None], (len(self.chosen), 1, self.rays, 3))
        return np.concatenate((middle, within, self.edge[:, None]), axis=1)

    def outlines(self, lift: float) -> Array:
        """Edges (E, rays + 1, 3) of whole ellipses, lifted, each with NaN as its last point.

        They end where they cross the edges of the flank.
        """
        rim, outside, turn = self.rim.copy(), self.outside, self.turn
        row, column = np.nonzero(outside[:, 1:] != outside[:, :-1])
        inner, outer = column + outside[row, column], column + ~outside[row, column]
        ends = self.which[row, 0]
        last = _last_inside(
            lambda angle, k: self.project.beyond(self.above(ends[k], angle, np.ones(angle.shape))),
            turn[row, inner],
            turn[row, outer],
        )
        rim[row, outer] = self.place(ends, last, np.ones(last.shape))
        raised = rim + 1.5 * (lift * self.contact.normal[self.chosen])[:, None]
        return np.concatenate((raised, np.full((len(self.chosen), 1, 3), np.nan)), axis=1)


def ellipse_edges(contact: MemberContact, chosen: NDArray[np.int64], project: Project, rays: int) -> Array:
    """Edges (E, rays, 3) of contact ellipses of the positions `chosen` (E,), on the surface, cut off at the flank's
    edges.
    """
    return _Ellipses(contact, chosen, project, rays).edge


def ellipse_outlines(
    contact: MemberContact, chosen: NDArray[np.int64], project: Project, lift: float, rays: int = RAYS_PER_ELLIPSE
) -> Array:
    """Outlines (E, rays + 1, 3) of contact ellipses of the positions `chosen` (E,), on the surface; each ends with NaN."""
    return _Ellipses(contact, chosen, project, rays).outlines(lift)


def ellipses_on_surface(
    contact: MemberContact,
    chosen: NDArray[np.int64],
    project: Project,
    lift: float,
    rays: int = RAYS_PER_ELLIPSE,
    rings: int = RINGS_PER_ELLIPSE,
) -> tuple[Array, Array]:
    """Return contact ellipses of the positions `chosen` (E,), on the surface and cut off at the flank's edges.

    Returns discs (E, rings, rays, 3) and outlines (E, rays + 1, 3), each of which ends with NaN.
    """
    ellipses = _Ellipses(contact, chosen, project, rays)
    return ellipses.discs(rings) + (lift * contact.normal[chosen])[:, None, None], ellipses.outlines(lift)


def path_on_surface(view: ToothView, contact: MemberContact, between: int = 8) -> tuple[Curve, ...]:
    """Return the path of contact as a curve on the surface, with `between` steps from one position to the next.

    The tuple is empty for contact along lines, and for a path too short to be seen.
    """
    point, normal = contact.path
    known = np.isfinite(point[:, 0])
    if not (known[1:] & known[:-1]).any() or np.ptp(point[known], axis=0).max() < MIN_PATH_EXTENT_LIFTS * view.lift:
        return ()
    point, normal = _refine_curve(point, between), _refine(normal, between)
    on_surface = view.project(point)
    # Edge contact lies on the trimmed edge itself, where `project` may fall to either side: the chord is near enough.
    on_surface = np.where(np.isfinite(on_surface), on_surface, point)
    return (Curve(on_surface + 2.0 * view.lift * normal, "path of contact", PATH_COLOUR, 3.0),)


def position_dots(view: ToothView, contact: MemberContact) -> tuple[Dots, ...]:
    """Return dots at the positions of edge contact."""
    edge = contact.point[contact.edge] + 2.0 * view.lift * contact.normal[contact.edge]
    return (Dots(edge, "edge contact", EDGE_COLOUR),) if len(edge) else ()


def contact_lines(view: ToothView, contact: MemberContact, count: int) -> tuple[Curve, ...]:
    """Return about `count` contact lines, evenly spaced in rotation, of a pair that touches along lines."""
    chosen = every_nth(contact.along_lines, count)
    lifted = [(contact.lines[i], 1.5 * view.lift * contact.normal[i]) for i in chosen]
    return tuple(
        Curve(line + up, "contact lines" if i == 0 else "", LINE_COLOUR, 3.0)
        for i, (line, up) in enumerate(lifted)
        if line is not None
    )


def lift_grid(grid: Array, contact: MemberContact, lift: float) -> Array:
    """Move flank points (I, J, 3) by `lift` mm along the surface normal, to the side of the contact normals."""
    normal = unit(cross(np.gradient(grid, axis=0), np.gradient(grid, axis=1)))
    side = np.sign(dot(normal, np.nanmean(contact.normal, axis=0)))
    return grid + lift * side[..., None] * normal


def area_edges(grid: Array, level: Array) -> Array:
    """Return the border of a grid (I, J, 3) where `level` (I, J) is at most 1: points (K, 3), lines separated by NaN.

    There an area hides the line between the flank and the neighbouring surface, which is drawn again.
    """
    rows = [(grid[0], level[0]), (grid[-1], level[-1]), (grid[:, 0], level[:, 0]), (grid[:, -1], level[:, -1])]
    return np.concatenate(
        [part for points, part_level in rows for part in (_below(points, part_level), np.full((1, 3), np.nan))]
    )


def _below(points: Array, level: Array) -> Array:
    """Points (N, 3) of a line where its level (N,) is at most 1, NaN elsewhere; crossings of 1 are interpolated."""
    inside = level <= 1.0
    kept = np.where(inside[:, None], points, np.nan)
    for k in np.flatnonzero(inside[1:] != inside[:-1]):
        inner, outer = (k, k + 1) if inside[k] else (k + 1, k)
        share = (1.0 - level[inner]) / (level[outer] - level[inner])
        if np.isfinite(share):
            kept[outer] = points[inner] + share * (points[outer] - points[inner])
    return kept


def union_level(contact: MemberContact, grid: Array) -> Array:
    """Return the scaled distance (I, J) from points (I, J, 3) to the nearest ellipse centre: at most 1 inside any
    ellipse.

    Positions are refined to steps of an eighth of the smallest minor semi-axis. The union is then the area swept by the
    moving ellipse, not a row of separate ellipses. Edge contact has no ellipse and adds nothing.
    """
    chosen = contact.ellipses
    if len(chosen) == 0:
        return np.full(grid.shape[:-1], np.inf)
    centre = contact.point[chosen]
    steps = np.linalg.norm(np.diff(centre, axis=0), axis=-1)
    most = int(np.ceil(8.0 * steps.max(initial=0.0) / contact.semi_minor[chosen].min()))
    between = int(np.clip(most, 1, 64))
    joined = np.flatnonzero(np.diff(chosen) > 1) + 1
    # Centres and forms of all refined positions; runs without gaps are refined separately.
    centre, form = (
        np.concatenate(parts)
        for parts in zip(*(_between(contact, run, between) for run in np.split(chosen, joined)), strict=True)
    )
    # (x - c)' F (x - c) is linear in the ten products 1, x_i, x_i x_j: one matrix product for all positions.
    origin = centre.mean(axis=0)
    x, c = (grid - origin).reshape(-1, 3), centre - origin
    pull = np.einsum("pij,pj->pi", form, c)
    row, column = np.triu_indices(3)
    products = np.concatenate((np.ones((len(x), 1)), x, x[:, row] * x[:, column]), axis=1)
    double = np.where(row == column, 1.0, 2.0)
    factors = np.concatenate((dot(pull, c)[:, None], -2.0 * pull, double * form[:, row, column]), axis=1)
    smallest = np.full(len(x), np.inf)
    for block in np.array_split(factors, -(-len(factors) // 64)):
        np.minimum(smallest, (products @ block.T).min(axis=1), out=smallest)
    level: Array = np.sqrt(np.maximum(smallest, 0.0)).reshape(grid.shape[:-1])
    return level


def _between(contact: MemberContact, run: NDArray[np.int64], between: int) -> tuple[Array, Array]:
    """Centres (N, 3) and quadratic forms (N, 3, 3) of ellipses, with `between` steps between neighbouring positions.

    The axes are rotated from one position to the next: the mean of the forms of two slender ellipses at a small angle
    would be too short.
    """
    major, normal = contact.major[run], contact.normal[run]
    turned = np.where(dot(major[1:], major[:-1]) < 0.0, -1.0, 1.0)
    major = _refine(major * np.cumprod(np.r_[1.0, turned])[:, None], between)
    normal = unit(_refine(normal, between))
    major = unit(major - dot(major, normal)[:, None] * normal)
    minor = cross(normal, major) / _refine(contact.semi_minor[run], between)[:, None]
    major = major / _refine(contact.semi_major[run], between)[:, None]
    # beyond the tangent plane too, or else the far side of a thread would lie within
    away = NORMAL_DISTANCE_WEIGHT * normal / _refine(contact.semi_major[run], between)[:, None]
    axes = np.stack((major, minor, away), axis=1)
    form: Array = np.einsum("pki,pkj->pij", axes, axes)
    return _refine_curve(contact.point[run], between), form


def closest_gap(grid: Array, patches: Sequence[tuple[Array, Array]]) -> Array:
    """Smallest gap (I, J) at flank points (I, J, 3) over patches of points (M, N, 3) and gaps (M, N); NaN outside all.

    Gaps are interpolated bilinearly in the mean plane of the flank; above this plane the flank is a graph.
    """
    flat = grid.reshape(-1, 3)
    origin = flat.mean(axis=0)
    plane = np.linalg.svd(flat - origin, full_matrices=False)[2][:2]
    places = (flat - origin) @ plane.T
    smallest = np.full(len(flat), np.inf)
    for points, gap in patches:
        known = np.isfinite(gap) & np.isfinite(points).all(axis=-1)
        if known.sum() > 3:
            # Flank points inside the patch's box; their indices in the patch; points outside its range are skipped.
            lattice = (points - origin) @ plane.T
            low, high = lattice[known].min(axis=0), lattice[known].max(axis=0)
            near = np.flatnonzero(((places >= low) & (places <= high)).all(axis=1))
            index = _index_in(lattice, known, places[near])
            within = ((index >= 0.0) & (index <= np.array(known.shape) - 1.0)).all(axis=1)
            here = bilinear(np.where(known, gap, np.nan)[..., None], index[within])[:, 0]
            smallest[near[within]] = np.fmin(smallest[near[within]], here)
    return np.where(np.isfinite(smallest), smallest, np.nan).reshape(grid.shape[:-1])


def _index_in(lattice: Array, known: NDArray[np.bool_], places: Array) -> Array:
    """Return the fractional indices (K, 2) of places (K, 2) in a lattice (M, N, 2); outside it they exceed its range.

    Newton's method on the bilinear lattice. Unknown nodes, where `known` (M, N) is False, follow the best affine map.
    """
    index = np.stack(np.meshgrid(*map(np.arange, known.shape), indexing="ij"), axis=-1).astype(float)
    affine = np.concatenate((index, np.ones((*known.shape, 1))), axis=-1)
    filled = np.where(known[..., None], lattice, affine @ np.linalg.lstsq(affine[known], lattice[known])[0])
    slopes = np.stack((np.gradient(filled, axis=0), np.gradient(filled, axis=1)), axis=-1)
    planes = np.concatenate((filled, slopes.reshape(*known.shape, 4)), axis=-1)
    last = np.array(known.shape) - 1.0
    indices = np.broadcast_to(last / 2, places.shape)
    # Worst error in cells after 3 and 10 steps: 4e-4 and 2e-12 on roll-test lattices of a beveloid pair; after 10
    # steps 5e-4 when the lattice is a whole beveloid flank, whose parameter lines crowd at the fillet.
    for _ in range(10):
        # Newton step with the bilinear values and slopes at the indices, held inside the lattice.
        base = np.clip(indices, 0.0, last)
        x, y, x_i, x_j, y_i, y_j = bilinear(planes, base).T
        dx, dy = places[:, 0] - x, places[:, 1] - y
        step = np.stack((dx * y_j - dy * x_j, dy * x_i - dx * y_i), axis=-1) / (x_i * y_j - x_j * y_i)[:, None]
        indices = base + step
    return indices


def _last_inside(beyond: Callable[[Array, NDArray[np.intp]], Array], inside: Array, outside: Array) -> Array:
    """Return the last parameter (K,), within `EDGE_SEARCH_SHARE`, at which a place is on the flank.

    `beyond` returns distances beyond the edges at parameters (M,) of the members (M,). The places at `inside` are on the
    flank, the places at `outside` are not.
    """

    def finite(x: Array, index: NDArray[np.intp]) -> Array:
        return np.minimum(beyond(x, index), BEYOND_MM)

    tolerance = EDGE_SEARCH_SHARE * float(np.abs(outside - inside).max(initial=0.0))
    return bracketed_root(finite, inside, outside, tolerance=tolerance).before


def _refine(values: Array, between: int) -> Array:
    """Values (P, ...), interpolated linearly with `between` steps from each to the next."""
    fraction = np.arange(between * (len(values) - 1) + 1) / between
    left = np.minimum(fraction.astype(int), max(len(values) - 2, 0))
    weight = (fraction - left).reshape(-1, *[1] * (values.ndim - 1))
    right = np.minimum(left + 1, len(values) - 1)
    # A weight of 0 must not carry the neighbour's NaN over.
    ahead = np.where(weight > 0, weight * values[right], 0.0)
    behind = np.where(weight < 1, (1.0 - weight) * values[left], 0.0)
    return ahead + behind


def _refine_curve(points: Array, between: int) -> Array:
    """Points (P, 3), interpolated by cubics with `between` steps from each to the next.

    The tangent at a point is the tangent of the parabola through the point and its two neighbours. Beside corners, ends
    and NaN the curve is a parabola. On a circle with chords of 20 deg the error is 0.04 % of the radius; the chords
    have 1.5 %.
    """
    straight = _refine(points, between)
    way = np.diff(points, axis=0)
    length = np.sqrt(dot(way, way))
    with np.errstate(invalid="ignore", divide="ignore"):
        direction = way / length[:, None]
        mean = length[1:, None] * direction[:-1] + length[:-1, None] * direction[1:]
        mean = mean / (length[1:] + length[:-1])[:, None]
        smooth = (dot(direction[:-1], direction[1:]) > MIN_SMOOTH_COSINE)[:, None]
    # tangents where an interval begins and ends; on a parabola their mean is the direction of its chord
    begin, end = (np.full(way.shape, np.nan) for _ in range(2))
    begin[1:], end[:-1] = np.where(smooth, mean, np.nan), np.where(smooth, mean, np.nan)
    begin, end = (
        np.where(np.isfinite(own), own, np.where(np.isfinite(other), 2.0 * direction - other, direction))
        for own, other in ((begin, end), (end, begin))
    )
    t = (np.arange(between) / between)[:, None]
    rise, fall = ((length[:, None] * tangent - way)[:, None] for tangent in (begin, end))
    bend = t * (1.0 - t) * ((1.0 - t) * rise - t * fall)
    # two equal points have no direction: the chord remains
    straight[: bend.shape[0] * between] += np.where(np.isfinite(bend), bend, 0.0).reshape(-1, 3)
    return straight
