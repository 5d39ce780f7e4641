"""Conditions of contact of two flanks, with exact Jacobians: in a point, on an edge, where two edges cross, along a line.

Unknowns of every position are x = (u1, v1, u2, v2, phi2) for a given phi1. Three equations say r1 = r2 in the fixed
frame [CR3553 1.1.12; LT02 9; LT85 19]; the other two are

    surfaces   n1 + n2 = 0 in the tangent plane of flank 1 (normals point out of the bodies) [CR3553 1.1.13; LT02 10]
    an edge    g = 0 and t . n = 0 with the edge's tangent t = n x grad g and the other flank's normal [LT02 44-46]
    a corner   g = 0 and g' = 0: two edges of one flank, or one of each
    a line     normals agree across the contact line, and the station is given

Normal and tangency conditions are multiplied by a length so that all residuals are in mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.heights import FlankHeights, heights
from gearmesh.kernel.algebra import Array, cross, dot, turn, unit
from gearmesh.kernel.levels import Level
from gearmesh.kernel.surface import Jet, Surface
from gearmesh.teeth.mount import Mount


@dataclass(frozen=True)
class Flank:
    """A trimmed flank in its mounting.

    `edges` bound it by name (value < 0 inside); `axial` and `extent` are the station coordinate and its range, mm;
    `grid` (I, J, 2) holds surface parameters of points spread over the trimmed flank, boundaries included;
    `beyond_joint` gives, for parameters and own-frame points, a length or angle > 0 where the point lies past the
    joint with the fillet (None: the flank has no such end).
    """

    surface: Surface
    mount: Mount
    edges: dict[str, Level]
    axial: Level
    extent: tuple[float, float]
    grid: Array
    beyond_joint: Callable[[Array, Array], Array] | None = None

    @cached_property
    def heights(self) -> FlankHeights:
        """The flank over circles about its member's axis, as a table."""
        return heights(self)

    def margin(self, parameters: Array, r: Array) -> Array:
        """How far (mm) points lie outside the trimmed flank, (...,): negative inside. `parameters` (..., 2), r own frame."""
        worst = np.max([level.value(r) for level in self.edges.values()], axis=0)
        if self.beyond_joint is not None:
            worst = np.maximum(worst, self.beyond_joint(parameters, r))
        found: Array = worst
        return found


@dataclass(frozen=True)
class Bound:
    """Condition level(r_member) = target (mm; scalar or one for each position) on member 0 (pinion) or 1 (gear)."""

    member: int
    level: Level
    target: Array | float = 0.0

    def target_of(self, index: NDArray[np.intp]) -> Array | float:
        return self.target if np.ndim(self.target) == 0 else np.asarray(self.target)[index]


@dataclass(frozen=True)
class Touch:
    """Both flanks at unknowns x (M, 5) and rotations phi1 (M,): jets in own frames and in the fixed frame."""

    own: tuple[Jet, Jet]
    fixed: tuple[Jet, Jet]

    def __getitem__(self, which: NDArray[np.intp]) -> Touch:
        """Some of the positions."""
        first, second = (tuple(jet[which] for jet in jets) for jets in (self.own, self.fixed))
        return Touch((first[0], first[1]), (second[0], second[1]))


@dataclass(frozen=True)
class Conditions:
    """The five equations for a pair of flanks; `bounds` (none, one or two) select what kind of contact is meant.

    `choice` (N, 2): numbers of the bounds that count at each position, -1 for none; without it all count everywhere.
    `across` (N, 3): with one bound, directions in which the normals must agree instead of edge tangency (line
    contact). `length` (mm) scales the conditions on directions.
    """

    flanks: tuple[Flank, Flank]
    phi1: Array
    length: float
    bounds: tuple[Bound, ...] = ()
    across: Array | None = None
    choice: NDArray[np.intp] | None = None

    def touch(self, x: Array, index: NDArray[np.intp]) -> Touch:
        """Evaluate both flanks."""
        pinion, gear = self.flanks
        own = (pinion.surface.jet(x[:, 0], x[:, 1]), gear.surface.jet(x[:, 2], x[:, 3]))
        first, second = self.mounts(index)
        return Touch(own, (own[0].moved(first.at(self.phi1[index])), own[1].moved(second.at(x[:, 4]))))

    def repeated(self, index: NDArray[np.intp]) -> Conditions:
        """The same conditions at positions `index` (M,), which may come more than once, as positions of their own."""
        flanks = []
        for flank in self.flanks:
            mount = flank.mount.rows(index)
            flanks.append(flank if mount is flank.mount else replace(flank, mount=mount))
        across = None if self.across is None else self.across[index]
        choice = None if self.choice is None else self.choice[index]
        return replace(self, flanks=(flanks[0], flanks[1]), phi1=self.phi1[index], across=across, choice=choice)

    def mounts(self, index: NDArray[np.intp]) -> tuple[Mount, Mount]:
        """Mounts of both members at the positions `index`."""
        return self.flanks[0].mount.rows(index), self.flanks[1].mount.rows(index)

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Residuals (M, 5), mm, and Jacobians (M, 5, 5) of the positions `index` (M,)."""
        return self._of(self.touch(x, index), index)

    def _of(self, at: Touch, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Residuals and Jacobians of flanks that are known."""
        one, two = at.fixed
        gear = self.flanks[1].mount.rows(index)
        f = np.empty((len(index), 5))
        jacobian = np.zeros((len(index), 5, 5))
        f[:, :3] = one.r - two.r
        jacobian[:, :3, 0], jacobian[:, :3, 1] = one.r_u, one.r_v
        jacobian[:, :3, 2], jacobian[:, :3, 3] = -two.r_u, -two.r_v
        jacobian[:, :3, 4] = -cross(gear.spin, two.r - gear.origin)
        for own, bounds in self._kinds(index):
            f[own, 3:], jacobian[own, 3:] = self._last(at if len(own) == len(index) else at[own], index[own], bounds)
        return f, jacobian

    def _kinds(self, index: NDArray[np.intp]) -> list[tuple[NDArray[np.intp], tuple[Bound, ...]]]:
        """The positions (of `index`) of each kind of contact, with their bounds."""
        if self.choice is None:
            return [(np.arange(len(index)), self.bounds)]
        chosen = self.choice[index]
        codes = (chosen[:, 0] + 1) * (len(self.bounds) + 1) + chosen[:, 1] + 1
        order = np.argsort(codes, kind="stable")
        parts = np.split(order, np.flatnonzero(np.diff(codes[order])) + 1)
        return [(part, tuple(self.bounds[k] for k in chosen[part[0]] if k >= 0)) for part in parts if len(part)]

    def _last(self, at: Touch, index: NDArray[np.intp], bounds: tuple[Bound, ...]) -> tuple[Array, Array]:
        """The last two residuals (M, 2) and rows (M, 2, 5): normals, bounds, tangency."""
        spin = self.flanks[1].mount.rows(index).spin
        found = [self._normals(at, d, spin) for d in self._directions(at.fixed[0], index, bounds)]
        found += [self._bound(at, bound, index) for bound in bounds]
        if len(found) == 1:
            found.append(self._tangency(at, bounds[0], spin))
        values, rows = zip(*found, strict=True)
        return np.stack(values, axis=-1), np.stack(rows, axis=-2)

    def with_phi1(self, x: Array, index: NDArray[np.intp]) -> tuple[Touch, Array, Array, Array]:
        """The flanks, residuals (M, 5), Jacobians (M, 5, 5), and derivatives (M, 5) with respect to phi1."""
        at = self.touch(x, index)
        return at, *self._of(at, index), self._by_phi1(at, index)

    def _by_phi1(self, at: Touch, index: NDArray[np.intp]) -> Array:
        one = at.fixed[0]
        pinion = self.flanks[0].mount.rows(index)
        found = np.zeros((len(index), 5))
        found[:, :3] = cross(pinion.spin, one.r - pinion.origin)
        for own, bounds in self._kinds(index):
            part, spin = at[own], self.flanks[0].mount.rows(index[own]).spin
            one, two = part.fixed
            directions = self._directions(one, index[own], bounds)
            for row, direction in enumerate(directions, start=3):
                found[own, row] = self.length * dot(cross(spin, one.n), direction)
            if len(directions) + len(bounds) == 1:
                edged = bounds[0].member
                tangent, _, _ = self._edge_tangent(part, bounds[0])
                turned = cross(spin, tangent) if edged == 0 else cross(spin, one.n)
                found[own, 4] = self.length * (dot(turned, two.n) if edged == 0 else dot(tangent, turned))
        return found

    def rate(self, x: Array, index: NDArray[np.intp]) -> Array:
        """d x / d phi1 (M, 5) of solutions; NaN where the equations are singular."""
        _, _, jacobian, by_phi1 = self.with_phi1(x, index)
        found = np.full((len(x), 5), np.nan)
        with np.errstate(all="ignore"):
            regular = np.flatnonzero(np.isfinite(jacobian).all(axis=(1, 2)))
            regular = regular[np.linalg.det(jacobian[regular]) != 0.0]
            found[regular] = np.linalg.solve(jacobian[regular], -by_phi1[regular][..., None])[..., 0]
        return found

    def _directions(self, one: Jet, index: NDArray[np.intp], bounds: tuple[Bound, ...]) -> list[Array]:
        """Tangent directions (M, 3) in which the normals must agree."""
        if not bounds:
            first = unit(one.r_u)
            return [first, cross(one.n, first)]
        return [] if self.across is None else [self.across[index]]

    def _normals(self, at: Touch, direction: Array, spin: Array) -> tuple[Array, Array]:
        """(n1 + n2) . direction, the direction held fixed: exact where the normals agree."""
        one, two = at.fixed
        columns = (one.n_u, one.n_v, two.n_u, two.n_v, cross(spin, two.n))
        return (
            self.length * dot(one.n + two.n, direction),
            self.length * np.stack([dot(c, direction) for c in columns], axis=-1),
        )

    def _bound(self, at: Touch, bound: Bound, index: NDArray[np.intp]) -> tuple[Array, Array]:
        jet = at.own[bound.member]
        gradient = bound.level.gradient(jet.r)
        row = np.zeros((len(jet.r), 5))
        row[:, 2 * bound.member] = dot(gradient, jet.r_u)
        row[:, 2 * bound.member + 1] = dot(gradient, jet.r_v)
        return bound.level.value(jet.r) - bound.target_of(index), row

    def _tangency(self, at: Touch, bound: Bound, spin: Array) -> tuple[Array, Array]:
        """t . n_other with t = n x grad g along the edge of the bound's member."""
        edged, other = bound.member, 1 - bound.member
        tangent, tangent_u, tangent_v = self._edge_tangent(at, bound)
        mate = at.fixed[other]
        row = np.empty((len(mate.r), 5))
        row[:, 2 * edged], row[:, 2 * edged + 1] = dot(tangent_u, mate.n), dot(tangent_v, mate.n)
        row[:, 2 * other], row[:, 2 * other + 1] = dot(tangent, mate.n_u), dot(tangent, mate.n_v)
        # only the gear turns with phi2: the mate's normal turns with it, or the edge's tangent does
        row[:, 4] = dot(tangent, cross(spin, mate.n)) if other == 1 else dot(cross(spin, tangent), mate.n)
        return self.length * dot(tangent, mate.n), self.length * row

    def _edge_tangent(self, at: Touch, bound: Bound) -> tuple[Array, Array, Array]:
        """n x grad g (M, 3) in the fixed frame, and its derivatives by the edged member's parameters."""
        jet = at.own[bound.member]
        gradient = bound.level.gradient(jet.r)
        turned = (
            cross(jet.n, gradient),
            cross(jet.n_u, gradient) + cross(jet.n, bound.level.hessian(jet.r, jet.r_u)),
            cross(jet.n_v, gradient) + cross(jet.n, bound.level.hessian(jet.r, jet.r_v)),
        )
        to_fixed = self._rotation(at, bound.member)
        first, second, third = (turn(to_fixed, t) for t in turned)
        return first, second, third

    def _rotation(self, at: Touch, member: int) -> Array:
        """Rotation (M, 3, 3) from the member's own frame to the fixed frame, from the frames of its jets."""
        frames = []
        for jet in (at.fixed[member], at.own[member]):
            first = unit(jet.r_v)
            frames.append(np.stack((first, cross(jet.n, first), jet.n), axis=-1))
        return frames[0] @ np.swapaxes(frames[1], -1, -2)
