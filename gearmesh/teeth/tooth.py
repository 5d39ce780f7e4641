"""A tooth: flanks, fillets and lands trimmed against each other and by the blank, on grids (s, t).

Going round the tooth counterclockwise (seen from +z) at a fixed station t the section is the chain

    root | fillet_right | flank_right | (edge_right) | land | (edge_left) | flank_left | fillet_left | next root

s in [0, 1] runs along each link of the chain, t in [0, 1] from toe to heel. Every grid point lies on its exact surface
and neighbouring links share their end points exactly. "right" is y < 0 of a tooth centred on +x (ISO 21771).
Fillets are what the tool's tip generates; where they undercut the flank, both end at their true intersection.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot, polar_angle
from gearmesh.kernel.barrel import Barrel
from gearmesh.kernel.levels import ConeLevel, Level, station_normal
from gearmesh.kernel.roots import last_true
from gearmesh.kernel.stations import TrimError, along
from gearmesh.kernel.surface import Jet, Surface
from gearmesh.teeth.tip_edge import TipEdge
from gearmesh.teeth.tooth_side import Side
from gearmesh.teeth.undercut import TRIM_TOLERANCE, cut_off, joint

#: stations at which the beginning of undercut is looked for
BREAK_SAMPLES = 17
#: halvings of the interval between two of them
BREAK_HALVINGS = 40


@dataclass(frozen=True)
class Blank:
    """What limits the teeth. `axial` is the station coordinate, from `extent[0]` (toe) to `extent[1]` (heel), mm.

    A station is a plane, cone or cylinder about z; the coordinate is the distance between stations. `tip` and `root` are
    the levels of the lands. `body` is the profile of the gear body, points (rho, z), mm, from the toe's end face (a
    station) round by the bore to the heel's; rho = 0: no bore.
    """

    axial: Level
    extent: tuple[float, float]
    tip: ConeLevel
    root: ConeLevel | Barrel
    body: tuple[tuple[float, float], ...]

    @property
    def bore_radius(self) -> float:
        """Smallest radius of the body, mm; 0 means a full disk."""
        return min(rho for rho, _ in self.body)

    @property
    def without_bore(self) -> tuple[tuple[float, float], ...]:
        """The body's profile with its bore filled."""
        return tuple((0.0 if rho == self.bore_radius else rho, z) for rho, z in self.body)


@dataclass(frozen=True)
class Grid:
    """Points and unit outward normals (S, T, 3) of one link on an (s, t) grid; `jet` where the link is a `Surface`.

    `p`, `v` (S, T) are that surface's parameters.
    """

    points: Array
    normals: Array
    jet: Jet | None = None
    p: Array | None = None
    v: Array | None = None


@dataclass(frozen=True)
class Ends:
    """Where the links of one side end, at each of T stations: parameters (T,), and points (T, 3) of the broken edge."""

    joint_flank: Array
    joint_fillet: Array
    tip: Array
    tip_angle: Array
    root_angle: Array
    edge: tuple[Array, Array, Array] | None

    def __getitem__(self, which: slice) -> Ends:
        edge = None if self.edge is None else (self.edge[0][which], self.edge[1][which], self.edge[2][which])
        return Ends(
            self.joint_flank[which],
            self.joint_fillet[which],
            self.tip[which],
            self.tip_angle[which],
            self.root_angle[which],
            edge,
        )


@dataclass(frozen=True)
class Sections:
    """Trimmed chain ends of both sides at stations t (T,) with station coordinates `stations` (T,), mm."""

    t: Array
    stations: Array
    right: Ends
    left: Ends

    def __getitem__(self, which: slice) -> Sections:
        """The sections at some of the stations."""
        return Sections(self.t[which], self.stations[which], self.right[which], self.left[which])


@dataclass(frozen=True)
class Tooth:
    """One tooth of a member with `teeth` teeth, centred on +x at the middle station.

    Raises DesignError for a broken tip edge where stations are not planes, TrimError from its methods where the chain
    cannot be closed.
    """

    teeth: int
    right: Side
    left: Side
    blank: Blank
    tip_edge: TipEdge | None = None

    def __post_init__(self) -> None:
        if self.tip_edge is not None and station_normal(self.blank.axial)[0] != 0.0:
            raise DesignError(
                "tip_chamfer, tip_rounding: edges are broken in planes across the axis; only cylindrical gears may have them"
            )

    @property
    def pitch_angle(self) -> float:
        return 2.0 * np.pi / self.teeth

    @cached_property
    def regions(self) -> tuple[str, ...]:
        """Links of the chain in order."""
        edge = self.tip_edge is not None or self.right.crest is not None
        links = ("root", "fillet_right", "flank_right", "edge_right", "land", "edge_left", "flank_left", "fillet_left")
        return tuple(name for name in links if edge or not name.startswith("edge"))

    @cached_property
    def breaks(self) -> Array:
        """Stations t inside (0, 1) where undercut begins or ends: the joint of flank and fillet has a corner there."""
        return np.unique(np.concatenate([self._breaks(side) for side in (self.right, self.left)]))

    def _breaks(self, side: Side) -> Array:
        t = np.linspace(0.0, 1.0, BREAK_SAMPLES)
        cut = self._cut_off(side, t)
        change = np.flatnonzero(cut[:-1] != cut[1:])
        was = cut[change]
        low, high = last_true(
            lambda at, k: self._cut_off(side, at) == was[k], t[change], t[change + 1], rounds=BREAK_HALVINGS
        )
        return np.where(was, high, low)

    def _cut_off(self, side: Side, t: Array) -> NDArray[np.bool_]:
        """Stations t (T,) where the flank at the tool's joint is undercut."""
        stations, axial = self.stations(t), self.blank.axial
        return cut_off(side, along(side.flank, np.full_like(stations, side.tip), stations, axial)[1], stations, axial)

    def stations(self, t: ArrayLike) -> Array:
        """Station coordinates (T,), mm, at t (T,)."""
        toe, heel = self.blank.extent
        return toe + (heel - toe) * np.asarray(t, dtype=float)

    def sections(self, t: ArrayLike) -> Sections:
        """Trim both sides at stations t (T,)."""
        t = np.atleast_1d(np.asarray(t, dtype=float))
        stations = self.stations(t)
        right, left = self._ends(self.right, 1, t), self._ends(self.left, -1, t)
        # threads go round the axis many times: their angles run on, and lands and roots are less than half a turn wide
        right = replace(right, tip_angle=np.unwrap(right.tip_angle))
        left = replace(left, root_angle=np.unwrap(left.root_angle))
        width = _within_half_turn(left.tip_angle - right.tip_angle)
        if (width <= 0.0).any():
            k = int(np.argmin(width))
            raise TrimError("pointed", float(t[k]), "the tooth is pointed")
        before = left.root_angle - self.pitch_angle
        root = _within_half_turn(right.root_angle - before)
        if (root < -1e-12).any():
            raise TrimError("root", float(t[0]), "the fillets of neighbouring teeth overlap")
        right, left = replace(right, root_angle=before + root), replace(left, tip_angle=right.tip_angle + width)
        return Sections(t, stations, right, left)

    def grid(self, region: str, s: ArrayLike, sections: Sections) -> Grid:
        """Exact points and normals of one link at s (S,), or s (S, T), by the sections' stations (T,)."""
        s = np.asarray(s, dtype=float)
        s = s[:, None] if s.ndim == 1 else s
        if region in ("root", "land"):
            return self._land(region, s, sections)
        ends = sections.right if region.endswith("right") else sections.left
        if region.startswith("edge") and self.tip_edge is not None:
            assert ends.edge is not None
            return Grid(*self.tip_edge.drawn(ends.edge, s if region == "edge_right" else 1.0 - s))
        return self._generated(region, s, ends, sections.stations)

    def _generated(self, region: str, s: Array, ends: Ends, stations: Array) -> Grid:
        """Exact grid of a flank, fillet or crest between its ends, s (S, 1)."""
        surface = self.surface(region)
        assert surface is not None
        first, last = self._span(region, ends)
        p = first + s * (last - first)
        v, jet = along(surface, p, stations, self.blank.axial)
        return Grid(jet.r, jet.n, jet, p, v)

    def surface(self, region: str) -> Surface | None:
        """The exact surface of a link, None for a broken edge (which is drawn, not generated)."""
        if region == "land":
            return self.blank.tip.surface
        if region == "root":
            return self.blank.root.surface
        side = self.right if region.endswith("right") else self.left
        if region.startswith("edge"):
            return None if side.crest is None else side.crest.surface
        return side.flank if region.startswith("flank") else side.fillet

    def flank_grid(self, side: str, s: ArrayLike, t: ArrayLike) -> Grid:
        """Exact grid (S, T) of the trimmed flank "right" or "left", s from joint to tip on both; the other side is not asked."""
        t, s = np.atleast_1d(np.asarray(t, dtype=float)), np.asarray(s, dtype=float)[:, None]
        right = side == "right"
        ends = self._ends(self.right if right else self.left, 1 if right else -1, t, root=False)
        return self._generated(f"flank_{side}", s if right else 1.0 - s, ends, self.stations(t))

    def volume(self, order: int = 24) -> float:
        """Volume (mm^3) of all teeth and the body, by Gauss quadrature of exact section areas.

        A section is a cone, plane or cylinder of a constant station down to a floor, the straight line between the ends of
        the body's profile. With u along its generatrix its area is the integral of rho du over the polar angle, and the
        volume that of the areas over the station. Floor and profile enclose the rest, a solid of revolution.
        """
        nodes, weights = np.polynomial.legendre.leggauss(order)
        nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
        sections = self.sections(nodes)
        area = np.zeros(order)
        for region in self.regions:
            area += weights @ self._area_density(region, nodes, sections)
        toe, heel = self.blank.extent
        profile = np.array(self.blank.body)
        return float((heel - toe) * self.teeth * (weights @ area) - _revolved(np.concatenate((profile, profile[:1]))))

    def _area_density(self, region: str, s: Array, sections: Sections) -> Array:
        """d(area over the floor)/ds on an (S, T) grid: the area between generatrices is the integral of rho du."""
        grid = self.grid(region, s, sections)
        if grid.jet is None:
            step = 1e-6
            ahead = self.grid(region, s + step, sections).points
            behind = self.grid(region, s - step, sections).points
            along_s = (ahead - behind) / (2.0 * step)
        else:
            first, last = self._span(region, None, sections)
            gradient = self.blank.axial.gradient(grid.points)
            dv = -dot(gradient, grid.jet.r_u) / dot(gradient, grid.jet.r_v)
            along_s = (grid.jet.r_u + grid.jet.r_v * dv[..., None]) * (last - first)[..., None]
        x, y, z = np.moveaxis(grid.points, -1, 0)
        rho = np.hypot(x, y)
        turning = (x * along_s[..., 1] - y * along_s[..., 0]) / rho**2
        across, up = station_normal(self.blank.axial)
        first, last = np.array(self.blank.body[0]), np.array(self.blank.body[-1])
        floor, floor_z = (first + sections.t[:, None] * (last - first)).T
        # rho is linear in u
        return 0.5 * (rho + floor) * (up * (rho - floor) - across * (z - floor_z)) * turning

    def _span(self, region: str, ends: Ends | None, sections: Sections | None = None) -> tuple[Array, Array]:
        """First surface parameter at the start and the end of a link, in the chain's direction."""
        if sections is not None:
            right, left = sections.right, sections.left
            if region == "land":
                return right.tip_angle, left.tip_angle
            if region == "root":
                return left.root_angle - self.pitch_angle, right.root_angle
            ends = right if region.endswith("right") else left
        assert ends is not None
        side = self.right if region.endswith("right") else self.left
        if region.startswith("flank"):
            span = ends.joint_flank, ends.tip
        elif region.startswith("edge"):
            assert side.crest is not None
            span = np.full_like(ends.tip, side.crest.joint[1]), np.full_like(ends.tip, side.crest.end)
        else:
            span = np.full_like(ends.joint_fillet, side.root), ends.joint_fillet
        return span if region.endswith("right") else span[::-1]

    def _land(self, region: str, s: Array, sections: Sections) -> Grid:
        first, last = self._span(region, None, sections)
        surface = (self.blank.root if region == "root" else self.blank.tip).surface
        angle = first + s * (last - first)
        start = surface.meeting(self.blank.axial, sections.stations)
        v, jet = along(surface, angle, sections.stations, self.blank.axial, start)
        return Grid(jet.r, jet.n, jet, angle, v)

    def _ends(self, side: Side, sign: int, t: Array, *, root: bool = True) -> Ends:
        """Where the links of one side end; without `root` the root's angle is left out (NaN)."""
        stations = self.stations(t)
        tip, tip_jet = self._tip(side, stations, t)
        tip_point = tip_jet.r
        joint_flank, joint_fillet = joint(side, (tip, tip_jet), (t, stations), self.blank.axial, self.blank.root)
        root_angle = np.full_like(stations, np.nan)
        if root:
            root_angle = polar_angle(
                along(side.fillet, np.full_like(stations, side.root), stations, self.blank.axial)[1].r
            )
        edge = None
        if side.crest is not None:
            land = np.full_like(stations, side.crest.end)
            tip_point = along(side.crest.surface, land, stations, self.blank.axial)[1].r
        if self.tip_edge is not None:
            tip, edge = self.tip_edge.between(side.flank, self.blank.tip, sign, (joint_flank, tip), stations)
            tip_point = edge[1]
        return Ends(joint_flank, joint_fillet, tip, polar_angle(tip_point), root_angle, edge)

    def _tip(self, side: Side, stations: Array, t: Array) -> tuple[Array, Jet]:
        """Flank parameter p (T,) and the flank's jet on the tip's level, or where its crest begins, at each station."""
        axial, tip = self.blank.axial, self.blank.tip
        if side.crest is not None:
            begins = np.full_like(stations, side.crest.joint[0])
            return begins, along(side.flank, begins, stations, axial)[1]

        def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            jet = side.flank.jet(x[:, 0], x[:, 1])
            f = np.stack((axial.value(jet.r) - stations[index], tip.value(jet.r)), axis=-1)
            rows = [[dot(g.gradient(jet.r), d) for d in (jet.r_u, jet.r_v)] for g in (axial, tip)]
            return f, np.moveaxis(np.array(rows), -1, 0)

        guess = np.full_like(stations, side.tip)
        v = along(side.flank, guess, stations, axial)[0]
        found = newton.solve(residual, np.stack((guess, v), axis=-1), tolerance=TRIM_TOLERANCE)
        if not found.converged.all():
            k = int(np.argmin(found.converged))
            raise TrimError("tip", float(t[k]), "the flank does not reach the tip")
        return found.values[:, 0], side.flank.jet(found.values[:, 0], found.values[:, 1])


def _revolved(profile: Array) -> float:
    """Volume enclosed by a closed profile (K, 2) of points (rho, z), cone frustum by frustum; signed by its sense."""
    rho, rise = profile[:, 0], np.diff(profile[:, 1])
    return float(np.pi / 3.0 * (rise @ (rho[1:] ** 2 + rho[1:] * rho[:-1] + rho[:-1] ** 2)))


def _within_half_turn(angle: Array) -> Array:
    """Angles (...,) less the full turns that bring them to -pi .. pi, rad; those that are there stay to the last digit."""
    return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))
