"""Conditions of contact of two flanks, with exact Jacobians: in a point, on an edge, where two edges cross, along a line.

The unknowns of a position are x = (u1, v1, u2, v2, phi2) for a given phi1. Three equations are r1 = r2 in the fixed frame
[CR3553 1.1.12; LT02 9; LT85 19]. The other two are

    surfaces   n1 + n2 = 0 in the tangent plane of flank 1 (normals point out of the bodies) [CR3553 1.1.13; LT02 10]
    an edge    g = 0 and t . n = 0 with the edge's tangent t = n x grad g and the other flank's normal [LT02 44-46]
    a corner   g = 0 and g' = 0: two edges of one flank, or one edge of each flank
    a line     normals agree across the contact line, and the station is given

Conditions on normals and tangents are multiplied by a length, so that all residuals are in mm.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.first_touch.heights import FlankHeights, heights
from gearmesh.kernel.numeric.algebra import Array, cross, dot, polar_angle, unit
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import HEEL_END, TOE_END


@dataclass(frozen=True)
class Flank:
    """Trimmed flank with its mount."""

    #: surface of the flank, member's frame
    surface: Surface
    #: position of the member and its rotation
    mount: Mount
    #: edges of the flank by name; a level is below 0 inside the flank
    edges: dict[str, Level]
    #: station coordinate
    axial: Level
    #: stations of the ends of the face, mm
    extent: tuple[float, float]
    #: surface parameters (I, J, 2) of points over the trimmed flank, with its boundaries
    grid: Array
    #: distance (mm) of parameters and points of the member's frame past an end that is no edge, above 0 beyond it; such ends are
    #: the root of a fillet and the line of regression of a flank; None if edges are the only boundaries
    beyond_ends: Callable[[Array, Array], Array] | None = None
    #: names of the edges across which the tooth continues smoothly
    smooth: frozenset[str] = frozenset()
    #: lines inside the flank (level 0) at which it has a corner and may touch like an edge, by name
    creases: dict[str, Level] = field(default_factory=dict)
    #: surface near parameters (u, v) that continues smoothly across the creases
    smooth_surface: Callable[[float, float], Surface] | None = None
    #: stations (level 0) at which the tip line has corners, by name
    tip_corners: dict[str, Level] = field(default_factory=dict)
    #: True if no derivative of the surface jumps, as it does where a relief begins and between the points of a table
    unbroken: bool = False
    #: the same flank with its first mount; `replace` drops it, so that a different flank gets its own tables
    _unmoved: Flank | None = field(default=None, init=False, repr=False, compare=False)

    def remount(self, mount: Mount) -> Flank:
        """Return the flank with another mount; tables of the flank are shared by all mounts with the same joint."""
        if mount is self.mount:
            return self
        flank = replace(self, mount=mount)
        if mount.joint is self.mount.joint:
            object.__setattr__(flank, "_unmoved", self._unmoved or self)
        return flank

    def edge_name(self, edge: str) -> str:
        """Return the name of an edge in answers: the solver calls the end at which the face begins the toe (`end_names`)."""
        return dict(zip((TOE_END, HEEL_END), end_names(self.axial), strict=True)).get(edge, edge)

    def smooth_about(self, u: float, v: float) -> Surface | None:
        """Return the surface near parameters (u, v) that continues smoothly across creases; None without creases."""
        return self.smooth_surface(u, v) if self.creases and self.smooth_surface is not None else None

    @cached_property
    def heights(self) -> FlankHeights:
        """Table of the flank over circles about its member's axis."""
        if self._unmoved is not None:
            return self._unmoved.heights
        return heights(self.surface, self.grid, self.mount.joint, axial=self.axial, extent=self.extent)

    def azimuth(self, r: Array) -> Array:
        """Return the polar angle (...,), rad, of points r of the member's frame near the flank, from the middle of the flank on.

        The angle may exceed a turn, because teeth may wind round their axis.
        """
        stations, along_tooth = self._winding
        angle = np.interp(self.axial.value(r), stations, along_tooth)
        angle_about_middle: Array = angle - self.middle_angle + (polar_angle(r) - angle + np.pi) % (2.0 * np.pi) - np.pi
        return angle_about_middle

    @property
    def middle_angle(self) -> float:
        """Polar angle of the middle of the flank, member's frame, rad."""
        angle = self._winding[1]
        return float(angle[len(angle) // 2])

    @cached_property
    def winding(self) -> float:
        """Greatest absolute azimuth of the flank's points, rad."""
        if self._unmoved is not None:
            return self._unmoved.winding
        grid = self.grid.reshape(-1, 2)
        return float(np.abs(self.azimuth(self.surface.jet(grid[:, 0], grid[:, 1]).r)).max())

    @cached_property
    def _winding(self) -> tuple[Array, Array]:
        """Stations (J,), mm, ascending, and continuous polar angles (J,), rad, of the flank at half height."""
        if self._unmoved is not None:
            return self._unmoved._winding
        middle = self.grid[self.grid.shape[0] // 2]
        r = self.surface.jet(middle[:, 0], middle[:, 1]).r
        stations, angle = self.axial.value(r), np.unwrap(polar_angle(r))
        order = np.argsort(stations)
        return stations[order], angle[order]

    def margin(self, parameters: Array, r: Array) -> Array:
        """Return the distance (...,), mm, of points outside the trimmed flank, negative inside.

        `parameters` (..., 2) and points r (..., 3) of the member's frame belong together.
        """
        worst = np.max([level.value(r) for level in self.edges.values()], axis=0)
        if self.beyond_ends is not None:
            worst = np.maximum(worst, self.beyond_ends(parameters, r))
        outside: Array = worst
        return outside


@dataclass(frozen=True)
class Bound:
    """Condition level(r) = target (mm, a number or an array with a value for each position) on member 0 (pinion) or 1 (gear)."""

    member: int
    level: Level
    target: Array | float = 0.0

    def target_of(self, index: NDArray[np.intp]) -> Array | float:
        return self.target if np.ndim(self.target) == 0 else np.asarray(self.target)[index]

    def rows(self, index: NDArray[np.intp]) -> Bound:
        """Return the bound at the positions `index`."""
        return self if np.ndim(self.target) == 0 else replace(self, target=self.target_of(index))


@dataclass(frozen=True)
class Touch:
    """Both flanks at M unknowns."""

    #: rotations (M,) of the pinion, rad
    phi1: Array
    #: jets (M,) of pinion and gear in the members' frames
    own: tuple[Jet, Jet]
    #: jets (M,) of pinion and gear in the fixed frame
    fixed: tuple[Jet, Jet]
    #: rotations (M, 3, 3) from the members' frames to the fixed frame
    turns: tuple[Array, Array]

    def __getitem__(self, which: NDArray[np.intp]) -> Touch:
        """Return the flanks at some positions."""
        first, second = (tuple(jet[which] for jet in jets) for jets in (self.own, self.fixed))
        return Touch(
            self.phi1[which], (first[0], first[1]), (second[0], second[1]), (self.turns[0][which], self.turns[1][which])
        )


@dataclass(frozen=True)
class _Last:
    """Last two conditions of M positions, in the order bounds, normals, tangency, with intermediate results."""

    #: residuals (M, 2), mm
    values: Array
    #: rows (M, 2, 5) of the Jacobian
    rows: Array
    #: conditions on normals: positions (K,), numbers of the conditions (K,), directions (K, 3)
    normals: tuple[NDArray[np.intp], NDArray[np.intp], Array]
    #: conditions on edge tangents: positions (E,), tangents (E, 3), normals of the mating flanks (E, 3), and +1 (E,) for an edge of
    #: the pinion, -1 for an edge of the gear
    edges: tuple[NDArray[np.intp], Array, Array, Array]


@dataclass(frozen=True)
class Conditions:
    """Five equations of contact for a pair of flanks; none, one or two bounds select the kind of contact."""

    #: flanks of pinion and gear
    flanks: tuple[Flank, Flank]
    #: rotations (N,) of the pinion, rad
    phi1: Array
    #: length that scales conditions on directions, mm
    length: float
    #: bounds from which positions choose
    bounds: tuple[Bound, ...] = ()
    #: directions (N, 3) in which normals must agree in line contact, which replace edge tangency where one bound counts
    across: Array | None = None
    #: numbers (N, 2) of the bounds that count at each position, -1 for none; None if all bounds count everywhere
    choice: NDArray[np.intp] | None = None

    def touch(self, x: Array, index: NDArray[np.intp]) -> Touch:
        """Evaluate both flanks at unknowns x (M, 5) of the positions `index` (M,)."""
        pinion, gear = self.flanks
        own = (pinion.surface.jet(x[:, 0], x[:, 1]), gear.surface.jet(x[:, 2], x[:, 3]))
        first, second = self.mounts(index)
        placed = first.at(self.phi1[index]), second.at(x[:, 4])
        fixed = own[0].move(placed[0]), own[1].move(placed[1])
        return Touch(self.phi1[index], own, fixed, (placed[0].rotation, placed[1].rotation))

    def repeat(self, index: NDArray[np.intp]) -> Conditions:
        """Return the conditions of the positions `index` (M,), with repetitions, as M new positions."""
        flanks = []
        for flank in self.flanks:
            flanks.append(flank.remount(flank.mount.rows(index)))
        across = None if self.across is None else self.across[index]
        choice = None if self.choice is None else self.choice[index]
        bounds = tuple(bound.rows(index) for bound in self.bounds)
        return replace(
            self, flanks=(flanks[0], flanks[1]), phi1=self.phi1[index], bounds=bounds, across=across, choice=choice
        )

    def mounts(self, index: NDArray[np.intp]) -> tuple[Mount, Mount]:
        """Return the mounts of both members at the positions `index`."""
        return self.flanks[0].mount.rows(index), self.flanks[1].mount.rows(index)

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (M, 5), mm, and Jacobians (M, 5, 5) of the positions `index` (M,)."""
        return self._of(self.touch(x, index), index)[:2]

    def _of(self, at: Touch, index: NDArray[np.intp]) -> tuple[Array, Array, _Last]:
        """Compute residuals, Jacobians and the last two conditions from flanks that are evaluated."""
        one, two = at.fixed
        gear = self.flanks[1].mount.rows(index)
        f = np.empty((len(index), 5))
        jacobian = np.empty((len(index), 5, 5))
        f[:, :3] = one.r - two.r
        jacobian[:, :3, 0], jacobian[:, :3, 1] = one.r_u, one.r_v
        jacobian[:, :3, 2], jacobian[:, :3, 3] = -two.r_u, -two.r_v
        jacobian[:, :3, 4] = -gear.velocity(two.r)
        last = self._last(at, index, gear.spin)
        f[:, 3:], jacobian[:, 3:] = last.values, last.rows
        return f, jacobian, last

    def _chosen_bounds(self, index: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return numbers (M, 2) of the bounds that count, -1 for none."""
        if self.choice is not None:
            return self.choice[index]
        numbers = [*range(len(self.bounds)), -1, -1][:2]
        return np.full((len(index), 2), numbers)

    def _last(self, at: Touch, index: NDArray[np.intp], spin: Array) -> _Last:
        count, chosen = len(index), self._chosen_bounds(index)
        values, rows = np.empty((count, 2)), np.zeros((count, 2, 5))
        bounded = (chosen >= 0).sum(axis=1)
        tangent_to = np.flatnonzero(bounded == 1) if self.across is None else np.zeros(0, dtype=np.intp)
        where = np.full(count, -1)
        where[tangent_to] = np.arange(tangent_to.size)
        bends = np.empty((tangent_to.size, 3, 3))
        member = np.zeros(tangent_to.size, dtype=np.intp)
        for number in np.flatnonzero(np.bincount(chosen.ravel() + 1)[1:]) if self.bounds else ():
            bound = self.bounds[number]
            own, slot = np.nonzero(chosen == number)
            jet = at.own[bound.member]
            r, r_u, r_v = jet.r[own], jet.r_u[own], jet.r_v[own]
            gradient = bound.level.gradient(r)
            values[own, slot] = bound.level.value(r) - bound.target_of(index[own])
            rows[own, slot, 2 * bound.member] = dot(gradient, r_u)
            rows[own, slot, 2 * bound.member + 1] = dot(gradient, r_v)
            on = np.flatnonzero(where[own] >= 0)
            if on.size:
                k = where[own[on]]
                member[k] = bound.member
                bends[k, 0] = gradient[on]
                both = bound.level.hessian(np.tile(r[on], (2, 1)), np.concatenate((r_u[on], r_v[on])))
                bends[k, 1], bends[k, 2] = both[: on.size], both[on.size :]
        normals = self._normals(at, index, bounded, spin, values, rows)
        edges = self._tangency(at, tangent_to, bends, member, spin, values, rows)
        return _Last(values, rows, normals, edges)

    def with_phi1(self, x: Array, index: NDArray[np.intp]) -> tuple[Touch, Array, Array, Array]:
        """Return flanks, residuals (M, 5), Jacobians (M, 5, 5), and derivatives (M, 5) of the residuals by phi1."""
        at = self.touch(x, index)
        f, jacobian, last = self._of(at, index)
        one, pinion = at.fixed[0], self.flanks[0].mount.rows(index)
        by_phi1 = np.zeros((len(index), 5))
        by_phi1[:, :3] = pinion.velocity(one.r)
        own, row, direction = last.normals
        by_phi1[own, 3 + row] = self.length * dot(cross(_rows(pinion.spin, own), one.n[own]), direction)
        own, tangent, mating, sense = last.edges
        by_phi1[own, 4] = -self.length * sense * dot(tangent, cross(_rows(pinion.spin, own), mating))
        return at, f, jacobian, by_phi1

    def rate(self, x: Array, index: NDArray[np.intp]) -> Array:
        """Compute d x / d phi1 (M, 5) of solutions; NaN where the equations are singular."""
        _, _, jacobian, by_phi1 = self.with_phi1(x, index)
        rates = np.full((len(x), 5), np.nan)
        with np.errstate(all="ignore"):
            regular = np.flatnonzero(np.isfinite(jacobian).all(axis=(1, 2)))
            regular = regular[np.linalg.det(jacobian[regular]) != 0.0]
            rates[regular] = np.linalg.solve(jacobian[regular], -by_phi1[regular][..., None])[..., 0]
        return rates

    def _normals(
        self, at: Touch, index: NDArray[np.intp], bounded: NDArray[np.intp], spin: Array, values: Array, rows: Array
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
        """Put the conditions (n1 + n2) . direction into `values` and `rows`; return positions, condition numbers and directions.

        The direction is a tangent of flank 1 and is held fixed in the derivatives, which is exact where the normals agree.
        """
        one, two = at.fixed
        own = np.flatnonzero(bounded == 0)
        first = unit(one.r_u[own])
        second = cross(one.n[own], first)
        place, row = np.concatenate((own, own)), np.repeat([0, 1], own.size)
        direction = np.concatenate((first, second))
        if self.across is not None:
            held = np.flatnonzero(bounded == 1)
            place, row = np.concatenate((place, held)), np.concatenate((row, np.ones_like(held)))
            direction = np.concatenate((direction, self.across[index[held]]))
        if place.size:
            columns = (one.n_u, one.n_v, two.n_u, two.n_v, cross(spin, two.n))
            values[place, row] = self.length * dot((one.n + two.n)[place], direction)
            for k, column in enumerate(columns):
                rows[place, row, k] = self.length * dot(column[place], direction)
        return place, row, direction

    def _tangency(
        self,
        at: Touch,
        own: NDArray[np.intp],
        bends: Array,
        member: NDArray[np.intp],
        spin: Array,
        values: Array,
        rows: Array,
    ) -> tuple[NDArray[np.intp], Array, Array, Array]:
        """Put the conditions t . n = 0 of positions `own` (E,) on edges of members (E,) into `values` and `rows`.

        t = n x grad g is the tangent of the edge, and the second n the normal of the mating flank. `bends` (E, 3, 3) are the
        gradients of g and their derivatives by the member's parameters. Returns positions, tangents, mating normals and senses.
        """
        sense = np.where(member == 0, 1.0, -1.0)
        if not own.size:
            return own, np.zeros((0, 3)), np.zeros((0, 3)), sense
        pinion = (member == 0)[:, None]
        edged, mating = (
            [np.where(pinion, getattr(a, name)[own], getattr(b, name)[own]) for name in ("n", "n_u", "n_v")]
            for a, b in (at.fixed, at.fixed[::-1])
        )
        turned = np.where(pinion[..., None], at.turns[0][own], at.turns[1][own])
        gradient, by_u, by_v = np.moveaxis(bends @ np.swapaxes(turned, -1, -2), 1, 0)
        tangent = cross(edged[0], gradient)
        of_edge = (
            dot(cross(edged[1], gradient) + cross(edged[0], by_u), mating[0]),
            dot(cross(edged[2], gradient) + cross(edged[0], by_v), mating[0]),
        )
        of_mating = dot(tangent, mating[1]), dot(tangent, mating[2])
        values[own, 1] = self.length * dot(tangent, mating[0])
        for k in (0, 1):
            rows[own, 1, k] = self.length * np.where(member == 0, of_edge[k], of_mating[k])
            rows[own, 1, 2 + k] = self.length * np.where(member == 0, of_mating[k], of_edge[k])
        # only the gear turns with phi2: either its normal turns, or the tangent of its edge
        rows[own, 1, 4] = self.length * sense * dot(tangent, cross(_rows(spin, own), mating[0]))
        return own, tangent, mating[0], sense


def _rows(vector: Array, own: NDArray[np.intp]) -> Array:
    """Return rows `own` of vectors (M, 3), or the common vector (3,) itself."""
    return vector if vector.ndim == 1 else vector[own]
