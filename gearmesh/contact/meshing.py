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
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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


@dataclass(frozen=True)
class Conditions:
    """The five equations for a pair of flanks; `bounds` (none, one or two) select what kind of contact is meant.

    `across` (N, 3): with one bound, directions in which the normals must agree instead of edge tangency (line
    contact). `length` (mm) scales the conditions on directions.
    """

    flanks: tuple[Flank, Flank]
    phi1: Array
    length: float
    bounds: tuple[Bound, ...] = ()
    across: Array | None = None

    def touch(self, x: Array, index: NDArray[np.intp]) -> Touch:
        """Evaluate both flanks."""
        pinion, gear = self.flanks
        own = (pinion.surface.jet(x[:, 0], x[:, 1]), gear.surface.jet(x[:, 2], x[:, 3]))
        return Touch(own, (own[0].moved(pinion.mount.at(self.phi1[index])), own[1].moved(gear.mount.at(x[:, 4]))))

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Residuals (M, 5), mm, and Jacobians (M, 5, 5) of the positions `index` (M,)."""
        at = self.touch(x, index)
        one, two = at.fixed
        spin = self.spin(1)
        f = np.empty((len(x), 5))
        jacobian = np.zeros((len(x), 5, 5))
        f[:, :3] = one.r - two.r
        jacobian[:, :3, 0], jacobian[:, :3, 1] = one.r_u, one.r_v
        jacobian[:, :3, 2], jacobian[:, :3, 3] = -two.r_u, -two.r_v
        jacobian[:, :3, 4] = -cross(spin, two.r - self.flanks[1].mount.origin)
        if not self.bounds:
            first = unit(one.r_u)
            directions = [first, cross(one.n, first)]
        else:
            directions = [] if self.across is None else [self.across[index]]
        for row, direction in enumerate(directions, start=3):
            f[:, row], jacobian[:, row] = self._normals(at, direction, spin)
        row = 3 + len(directions)
        for bound in self.bounds:
            f[:, row], jacobian[:, row] = self._bound(at, bound, index)
            row += 1
        if row == 4:
            f[:, 4], jacobian[:, 4] = self._tangency(at, self.bounds[0], spin)
        return f, jacobian

    def by_phi1(self, x: Array, index: NDArray[np.intp]) -> Array:
        """Derivative (M, 5) of the surface conditions with respect to phi1."""
        one = self.touch(x, index).fixed[0]
        spin = self.spin(0)
        first = unit(one.r_u)
        turned = cross(spin, one.n)
        columns = [cross(spin, one.r - self.flanks[0].mount.origin)]
        columns += [self.length * dot(turned, d)[:, None] for d in (first, cross(one.n, first))]
        return np.concatenate(columns, axis=-1)

    def spin(self, member: int) -> Array:
        """Axis vector (3,) about which the member turns right-handed as its phi grows, fixed frame."""
        mount = self.flanks[member].mount
        return mount.sign * mount.axis

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
        jet = at.own[edged]
        gradient = bound.level.gradient(jet.r)
        turned = (
            cross(jet.n_u, gradient) + cross(jet.n, bound.level.hessian(jet.r, jet.r_u)),
            cross(jet.n_v, gradient) + cross(jet.n, bound.level.hessian(jet.r, jet.r_v)),
        )
        to_fixed = self._rotation(at, edged)
        tangent, tangent_u, tangent_v = (turn(to_fixed, t) for t in (cross(jet.n, gradient), *turned))
        mate = at.fixed[other]
        row = np.empty((len(jet.r), 5))
        row[:, 2 * edged], row[:, 2 * edged + 1] = dot(tangent_u, mate.n), dot(tangent_v, mate.n)
        row[:, 2 * other], row[:, 2 * other + 1] = dot(tangent, mate.n_u), dot(tangent, mate.n_v)
        # only the gear turns with phi2: the mate's normal turns with it, or the edge's tangent does
        row[:, 4] = dot(tangent, cross(spin, mate.n)) if other == 1 else dot(cross(spin, tangent), mate.n)
        return self.length * dot(tangent, mate.n), self.length * row

    def _rotation(self, at: Touch, member: int) -> Array:
        """Rotation (M, 3, 3) from the member's own frame to the fixed frame, from the frames of its jets."""
        frames = []
        for jet in (at.fixed[member], at.own[member]):
            first = unit(jet.r_v)
            frames.append(np.stack((first, cross(jet.n, first), jet.n), axis=-1))
        return frames[0] @ np.swapaxes(frames[1], -1, -2)
