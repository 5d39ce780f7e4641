"""Tooth contact analysis: where two trimmed flanks touch, position by position, all positions in one batch.

For a given phi1 the driven gear lies where it is first touched: phi2 is the largest (drive +1) or smallest (-1) value
at which some point of one flank meets the other. In the interior of both flanks that is tangency of the surfaces; where
the point would lie outside a trimmed flank, the extreme lies on an edge (tip, toe, heel) or where two edges cross.
Pairs that touch along lines make the equations singular; they are recognised by their relative curvature.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.ease_off import across, ease_off
from gearmesh.contact.meshing import Bound, Conditions, Flank
from gearmesh.contact.path import ContactPath
from gearmesh.errors import Solution, Status
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.curvature import contact_ellipse, relative_curvature, tangent_basis

#: residual (mm) below which a position counts as solved; Newton goes one step further, to rounding
TOLERANCE = 1e-11
#: a point this far (mm) outside a trimmed flank still counts as on its edge
EDGE_SLACK = 1e-7
#: relative eigenvalue of K1 - K2 below which contact is along a line
FLAT = 1e-7
#: singular values below this share of the largest are taken for the null space of line contact
RCOND = 1e-9
#: edges farther than this many cells of the start grid from a seed are not tried
EDGE_REACH = 2.5
#: contact this share of the flanks' length off them is not followed further
BEYOND = 0.3
#: points by which a contact line is traced from toe to heel
LINE_POINTS = 41
NAMES = ("pinion", "gear")


@dataclass(frozen=True)
class Pair:
    """What the solver needs to know of a gear pair: two mounted flanks, N1/N2, the side of first touch and delta (mm)."""

    pinion: Flank
    gear: Flank
    ratio: float
    drive: int
    delta: float

    @property
    def flanks(self) -> tuple[Flank, Flank]:
        return self.pinion, self.gear

    def length(self) -> float:
        """Typical flank dimension (mm), which turns conditions on normals into lengths."""
        r = self.pinion.surface.jet(self.pinion.grid[..., 0], self.pinion.grid[..., 1]).r
        return float(0.25 * np.linalg.norm(np.ptp(r.reshape(-1, 3), axis=0)))

    def max_step(self) -> Array:
        """Largest Newton step (5,): half the range of each flank's parameters, and 0.2 rad."""
        spans = [0.5 * np.ptp(f.grid.reshape(-1, 2), axis=0) for f in self.flanks]
        return np.array([*spans[0], *spans[1], 0.2])


@dataclass
class _Found:
    """Unknowns x (P, 5) and what is known of each position; filled in stage by stage."""

    x: Array
    status: NDArray[np.int64]
    residual: Array
    kind: NDArray[np.str_]
    edge: NDArray[np.str_]
    lines: list[Array | None]

    @staticmethod
    def nothing(count: int) -> _Found:
        return _Found(
            np.full((count, 5), np.nan),
            np.full(count, int(Status.NO_CONTACT)),
            np.full(count, np.nan),
            np.full(count, "none", dtype="<U5"),
            np.full(count, "", dtype="<U32"),
            [None] * count,
        )

    def take(self, index: NDArray[np.intp], solution: Solution, kind: str) -> None:
        self.x[index], self.status[index], self.residual[index] = solution.values, solution.status, solution.residual
        self.kind[index] = kind


def contact_path(
    pair: Pair, phi1: Array, count_phi1: Callable[[Array, Array], Array] | None = None, *, edges: bool = True
) -> ContactPath:
    """Contact of one tooth pair at rotations phi1 (P,), rad; TE relative to phi1 = 0.

    `count_phi1` gives, for pinion surface parameters, the angle by which the source counts phi1 (the generation
    angle of [LT85]); the rotation is then found that makes it take the values asked for. Without `edges` only
    tangency inside both flanks is looked for, which is quicker.
    Positions without contact come back as kind "none" with the reason in `status`; nothing is raised for them, and
    no floating-point warnings either: what is not finite is reported by its status.
    """
    with np.errstate(all="ignore"):
        return _contact_path(pair, phi1, count_phi1, edges)


def _contact_path(
    pair: Pair, phi1: Array, count_phi1: Callable[[Array, Array], Array] | None, edges: bool
) -> ContactPath:
    started = time.perf_counter()
    asked = np.append(np.asarray(phi1, dtype=float), 0.0)
    rotation = asked.copy()
    found = _solve(pair, rotation, None, edges)
    if count_phi1 is not None:
        for _ in range(6):
            counted = count_phi1(found.x[:, 0], found.x[:, 1])
            miss = np.where(np.isfinite(counted), asked - counted, 0.0)
            if np.abs(miss).max() <= 1e-13:
                break
            rotation = rotation + miss
            found = _solve(pair, rotation, found, edges)
    return _result(pair, asked, rotation, found, started)


def _result(pair: Pair, asked: Array, rotation: Array, found: _Found, started: float) -> ContactPath:
    """Everything reported, from the unknowns; the last position, phi1 = 0, only serves as the reference of TE."""
    all_positions = np.arange(len(asked))
    conditions = Conditions(pair.flanks, rotation, 1.0)
    with np.errstate(invalid="ignore"):
        touch = conditions.touch(found.x, all_positions)
        one, two = touch.fixed
        e1, e2 = tangent_basis(one)
        ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta)
        gap = np.sqrt(dot(one.r - two.r, one.r - two.r))
    te = found.x[:, 4] - pair.ratio * rotation
    touching = np.flatnonzero(found.kind != "none")
    reference = te[-1] if found.kind[-1] != "none" or not touching.size else te[touching[0]]
    keep = slice(0, len(asked) - 1)
    is_point = (found.kind == "point")[keep]

    def for_points(values: Array) -> Array:
        return np.where(is_point if values.ndim == 1 else is_point[:, None], values[keep], np.nan)

    return ContactPath(
        phi1=asked[keep],
        rotation=rotation[keep],
        phi2=found.x[keep, 4],
        te=(te - reference)[keep],
        kind=found.kind[keep],
        edge=found.edge[keep],
        status=found.status[keep],
        residual=gap[keep],
        point=one.r[keep],
        normal=one.n[keep],
        point1=touch.own[0].r[keep],
        point2=touch.own[1].r[keep],
        params1=found.x[keep, 0:2],
        params2=found.x[keep, 2:4],
        semi_major=for_points(ellipse.semi_major),
        semi_minor=for_points(ellipse.semi_minor),
        angle=for_points(ellipse.angle),
        major=for_points(ellipse.major),
        minor=for_points(ellipse.minor),
        lines=tuple(found.lines[keep]),
        seconds=time.perf_counter() - started,
    )


def _solve(pair: Pair, phi1: Array, nearby: _Found | None, edges: bool) -> _Found:
    """Contact at rotations phi1 (P,); `nearby`: a solution at slightly different rotations, to start from."""
    found = _Found.nothing(len(phi1))
    conditions = Conditions(pair.flanks, phi1, pair.length())
    anchor: tuple[int, Array, Array | None] | None
    if nearby is not None and (nearby.kind == "point").any():
        known = np.flatnonzero(nearby.kind == "point")
        middle = int(known[known.size // 2])
        anchor = (middle, nearby.x[middle], None)
    else:
        anchor = _anchor(pair, conditions, phi1)
    if anchor is not None:
        position, x, line_direction = anchor
        solution = _continue(pair, conditions, phi1, position, x, rcond=None if line_direction is None else RCOND)
        if line_direction is None:
            _take_points(pair, conditions, solution, found)
        else:
            _take_lines(pair, conditions, solution, line_direction, found)
    rest = np.flatnonzero(found.kind == "none")
    if edges and rest.size:
        _take_edges(pair, phi1, rest, found)
    return found


def _anchor(pair: Pair, conditions: Conditions, phi1: Array) -> tuple[int, Array, Array | None] | None:
    """A position with surface contact, its unknowns, and for line contact the direction across the line.

    Tried at the middle position, then at five spread over the range; None if the surfaces touch at none of them.
    """
    count = len(phi1)
    order = np.argsort(phi1, kind="stable")
    middle = order[count // 2]
    spread = np.unique(order[np.linspace(0, count - 1, min(count, 5)).round().astype(int)])
    for tries in (np.array([middle]), spread):
        anchor = _anchor_among(pair, conditions, phi1, tries)
        if anchor is not None:
            return anchor
    return None


def _anchor_among(
    pair: Pair, conditions: Conditions, phi1: Array, tries: NDArray[np.intp]
) -> tuple[int, Array, Array | None] | None:
    seeds = ease_off(pair, phi1[tries])
    solution = newton.solve(
        partial(_at, conditions, tries), seeds.x, tolerance=TOLERANCE, max_step=pair.max_step(), rcond=RCOND
    )
    one, two = conditions.touch(solution.values, tries).fixed
    with np.errstate(invalid="ignore"):
        opposed = solution.converged & (dot(one.n, two.n) < 0.0)
    if not opposed.any():
        return None
    best = int(np.argmin(np.where(opposed, np.where(seeds.interior, 0.0, 1.0), np.inf)))
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta, flat=FLAT)
    return int(tries[best]), solution.values[best], ellipse.minor[best] if ellipse.line[best] else None


def _continue(
    pair: Pair, conditions: Conditions, phi1: Array, position: int, x: Array, rcond: float | None
) -> Solution:
    """Surface contact at all positions: tangent prediction from one, Newton on all; stragglers restart from neighbours."""
    at = np.array([position])
    jacobian = conditions(x[None], at)[1]
    tangent = -(np.linalg.pinv(jacobian, rcond=rcond or 1e-15) @ conditions.by_phi1(x[None], at)[..., None])[0, :, 0]
    start = x + (phi1 - phi1[position])[:, None] * tangent
    solver = partial(
        newton.solve, tolerance=TOLERANCE, max_step=pair.max_step(), rcond=rcond, max_iterations=15, halvings=4
    )
    solution = solver(conditions, start)
    for _ in range(4):
        good, lost = np.flatnonzero(solution.converged), np.flatnonzero(~solution.converged)
        if not lost.size or not good.size:
            break
        nearest = good[np.abs(phi1[lost][:, None] - phi1[good]).argmin(axis=1)]
        if rcond is None:
            # beyond a place that is already off the flanks nothing is looked for: the surfaces may not meet at all there
            near = _margins(pair, conditions, solution.values[nearest], nearest)[0] <= BEYOND * pair.length()
            lost, nearest = lost[near], nearest[near]
        if not lost.size:
            break
        again = solver(
            partial(_at, conditions, lost), solution.values[nearest] + (phi1[lost] - phi1[nearest])[:, None] * tangent
        )
        solution.values[lost], solution.status[lost], solution.residual[lost] = (
            again.values,
            again.status,
            again.residual,
        )
        if not again.converged.any():
            break
    return solution


def _at(conditions: Conditions, positions: NDArray[np.intp], x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
    """Conditions for a solve over some positions only."""
    return conditions(x, positions[index])


def _margins(pair: Pair, conditions: Conditions, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
    """Distance outside the trimmed flanks (M,), mm (negative inside both), and n1 . n2 (M,)."""
    touch = conditions.touch(x, index)
    outside = np.maximum(pair.pinion.margin(x[:, 0:2], touch.own[0].r), pair.gear.margin(x[:, 2:4], touch.own[1].r))
    return outside, dot(touch.fixed[0].n, touch.fixed[1].n)


def _take_points(pair: Pair, conditions: Conditions, solution: Solution, found: _Found) -> None:
    everywhere = np.arange(len(solution.values))
    with np.errstate(invalid="ignore"):
        outside, facing = _margins(pair, conditions, solution.values, everywhere)
        one, two = conditions.touch(solution.values, everywhere).fixed
        e1, e2 = tangent_basis(one)
        crossing = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta).crossing
        good = solution.converged & (outside <= EDGE_SLACK) & (facing < 0.0) & ~crossing
    index = np.flatnonzero(good)
    found.take(index, _part(solution, index), "point")


def _take_lines(pair: Pair, conditions: Conditions, solution: Solution, across: Array, found: _Found) -> None:
    """Trace the line through every solved position from toe to heel and keep the part on both flanks."""
    solved = np.flatnonzero(solution.converged)
    if not solved.size:
        return
    low, high = pair.pinion.extent
    stations = np.linspace(low, high, LINE_POINTS)
    index = np.repeat(solved, LINE_POINTS)
    traced = replace(
        conditions,
        bounds=(Bound(0, pair.pinion.axial, np.tile(stations, len(solution.values))),),
        across=np.broadcast_to(across, (len(solution.values) * LINE_POINTS, 3)),
        phi1=np.repeat(conditions.phi1, LINE_POINTS),
    )
    place = (solved[:, None] * LINE_POINTS + np.arange(LINE_POINTS)).ravel()
    line = newton.solve(
        partial(_at, traced, place),
        solution.values[index],
        tolerance=TOLERANCE,
        max_step=4.0 * pair.max_step(),
        rcond=RCOND,
    )
    outside, facing = _margins(pair, traced, line.values, place)
    outside = np.where(line.converged & (facing < 0.0), outside, np.inf).reshape(-1, LINE_POINTS)
    x = line.values.reshape(-1, LINE_POINTS, 5)
    for k, position in enumerate(solved):
        on_both = _clip(outside[k], x[k])
        if on_both is None:
            continue
        middle = 0.5 * (on_both[0] + on_both[-1])
        at = np.array([position])
        found.take(at, _polish(conditions, at, middle), "line")
        where = np.full(len(on_both), position)
        found.lines[position] = conditions.touch(on_both, where).fixed[0].r


def _polish(conditions: Conditions, position: NDArray[np.intp], x: Array) -> Solution:
    return newton.solve(partial(_at, conditions, position), x[None], tolerance=TOLERANCE, rcond=RCOND)


def _clip(outside: Array, x: Array) -> Array | None:
    """Unknowns (K, 5) on the part of a traced line inside both flanks, its ends interpolated; None if there is none."""
    inside = np.flatnonzero(outside <= EDGE_SLACK)
    if not inside.size:
        return None
    first, last = inside[0], inside[-1]
    points = [*x[first : last + 1]]
    for end, beyond, at in ((first, first - 1, 0), (last, last + 1, len(points))):
        if 0 <= beyond < len(x) and np.isfinite(outside[beyond]) and outside[end] < -EDGE_SLACK:
            share = outside[end] / (outside[end] - outside[beyond])
            cut = x[end] + share * (x[beyond] - x[end])
            points.insert(0 if at == 0 else len(points), cut)
    return np.array(points)


def _take_edges(pair: Pair, phi1: Array, rest: NDArray[np.intp], found: _Found) -> None:
    """Positions without tangency inside both flanks: the edges near the seed decide, then the crossings of two edges.

    Of all solutions on both flanks the one of first touch is the contact; the seed, itself a point where the flanks
    meet, bounds it from one side and tells when crossings need not be tried.
    """
    seeds = ease_off(pair, phi1[rest])
    usable = np.flatnonzero(seeds.feasible)
    if not usable.size:
        return
    hunt = _EdgeHunt(pair, phi1, rest[usable], seeds.x[usable], found)
    hunt.attempt("", ())
    bounds = hunt.edges_near(seeds.cells)
    for name, bound, near in bounds:
        hunt.attempt(name, (bound,), near)
    for (a, p, near_a), (b, q, near_b) in combinations(bounds, 2):
        hunt.attempt(f"{a}+{b}", (p, q), near_a & near_b & ~hunt.settled())


class _EdgeHunt:
    """Candidates for contact at positions (Q,) of a path; the best one found so far is kept in `found`."""

    def __init__(self, pair: Pair, phi1: Array, positions: NDArray[np.intp], start: Array, found: _Found) -> None:
        self.pair, self.phi1, self.positions, self.start, self.found = pair, phi1, positions, start, found
        self.best = np.full(len(positions), -np.inf)
        self.seed_reach = self._reach(start, positions)

    def _reach(self, x: Array, positions: NDArray[np.intp]) -> Array:
        return self.pair.drive * (x[:, 4] - self.pair.ratio * self.phi1[positions])

    def settled(self) -> NDArray[np.bool_]:
        """Positions whose best candidate touches no later than their seed."""
        return self.best >= self.seed_reach - 1e-12

    def edges_near(self, cells: tuple[Array, Array]) -> list[tuple[str, Bound, NDArray[np.bool_]]]:
        """Every edge with the positions (Q,) whose seed lies within a few grid cells of it."""
        edges = []
        for member, (name, flank) in enumerate(zip(NAMES, self.pair.flanks, strict=True)):
            r = flank.surface.jet(self.start[:, 2 * member], self.start[:, 2 * member + 1]).r
            for edge, level in flank.edges.items():
                near = np.abs(level.value(r)) <= EDGE_REACH * across(level, r, cells[member])
                edges.append((f"{name}_{edge}", Bound(member, level), near))
        return edges

    def attempt(self, name: str, bounds: tuple[Bound, ...], where: NDArray[np.bool_] | None = None) -> None:
        """Solve for one kind of contact from the seeds of the positions `where`, keep it where it touches first."""
        chosen = np.arange(len(self.positions)) if where is None else np.flatnonzero(where)
        if not chosen.size:
            return
        positions = self.positions[chosen]
        conditions = Conditions(self.pair.flanks, self.phi1, self.pair.length(), bounds)
        solution = newton.solve(
            partial(_at, conditions, positions),
            self.start[chosen],
            tolerance=TOLERANCE,
            max_step=0.5 * self.pair.max_step(),
            max_iterations=15,
            halvings=3,
            rcond=RCOND,
        )
        with np.errstate(invalid="ignore"):
            outside, facing = _margins(self.pair, conditions, solution.values, positions)
            good = solution.converged & (outside <= EDGE_SLACK) & (facing < 0.0)
            reach = np.where(good, self._reach(solution.values, positions), -np.inf)
        better = np.flatnonzero(reach > self.best[chosen] + 1e-13)
        self.best[chosen[better]] = reach[better]
        self.found.take(positions[better], _part(solution, better), "edge" if name else "point")
        self.found.edge[positions[better]] = name


def _part(solution: Solution, index: NDArray[np.intp]) -> Solution:
    return Solution(solution.values[index], solution.status[index], solution.residual[index], solution.iterations)
