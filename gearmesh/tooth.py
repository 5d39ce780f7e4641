"""A tooth: flanks, fillets and lands trimmed against each other and by the blank, on grids (s, t).

Going round the tooth counterclockwise (seen from +z) at a fixed station t the section is the chain

    root | fillet_right | flank_right | (edge_right) | land | (edge_left) | flank_left | fillet_left | next root

s in [0, 1] runs along each link of the chain, t in [0, 1] from toe to heel. Every grid point lies on its exact surface
and neighbouring links share their end points exactly. "right" is y < 0 of a tooth centred on +x (ISO 21771).
Fillets are what the tool's tip generates; where they undercut the flank, both end at their true intersection.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize.elementwise import find_root

from gearmesh import newton
from gearmesh.frames import Array, dot
from gearmesh.stations import TrimError, along
from gearmesh.surface import ConeLevel, ConeSurface, Jet, Level, Surface, area_normal
from gearmesh.tip_edge import TipEdge

#: stations at which the beginning of undercut is looked for
BREAK_SAMPLES = 17
#: largest residual (mm) of a trimming solve
TRIM_TOLERANCE = 1e-11


@dataclass(frozen=True)
class Side:
    """One side of a tooth: generated flank and fillet, surface parameters (p, v) with p across the profile.

    `joint` (p, q): flank and fillet parameters where the tool's flank passes into its tip rounding;
    `root`: fillet parameter where the tool's tip plane begins; `tip`: flank parameter near the tip, a start value.
    """

    flank: Surface
    fillet: Surface
    joint: tuple[float, float]
    root: float
    tip: float


@dataclass(frozen=True)
class Blank:
    """What limits the teeth. `axial` is the station coordinate, from `extent[0]` (toe) to `extent[1]` (heel), mm.

    `tip` and `root` are the cones of the lands. `body` is the profile of the gear body, points (rho, z), mm, from
    the toe's end face (plane or cone of a constant station) round by the bore to the heel's; rho = 0: no bore.
    """

    axial: Level
    extent: tuple[float, float]
    tip: ConeLevel
    root: ConeLevel
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

    Raises TrimError from its methods where the chain cannot be closed.
    """

    teeth: int
    right: Side
    left: Side
    blank: Blank
    tip_edge: TipEdge | None = None

    @property
    def pitch_angle(self) -> float:
        return 2.0 * np.pi / self.teeth

    @cached_property
    def regions(self) -> tuple[str, ...]:
        """Links of the chain in order."""
        edge = self.tip_edge is not None
        links = ("root", "fillet_right", "flank_right", "edge_right", "land", "edge_left", "flank_left", "fillet_left")
        return tuple(name for name in links if edge or not name.startswith("edge"))

    @cached_property
    def breaks(self) -> Array:
        """Stations t inside (0, 1) where undercut begins or ends: the joint of flank and fillet has a corner there."""
        t = np.linspace(0.0, 1.0, BREAK_SAMPLES)
        found = []
        for side in (self.right, self.left):
            cut = self._undercut(side, t)
            low, high = t[:-1][cut[:-1] != cut[1:]], t[1:][cut[:-1] != cut[1:]]
            was = cut[:-1][cut[:-1] != cut[1:]]
            for _ in range(40 if low.size else 0):
                middle = 0.5 * (low + high)
                same = self._undercut(side, middle) == was
                low, high = np.where(same, middle, low), np.where(same, high, middle)
            found.append(np.where(was, high, low))
        return np.unique(np.concatenate(found))

    def stations(self, t: ArrayLike) -> Array:
        """Station coordinates (T,), mm, at t (T,)."""
        toe, heel = self.blank.extent
        return toe + (heel - toe) * np.asarray(t, dtype=float)

    def sections(self, t: ArrayLike) -> Sections:
        """Trim both sides at stations t (T,)."""
        t = np.atleast_1d(np.asarray(t, dtype=float))
        stations = self.stations(t)
        right, left = self._ends(self.right, 1, t), self._ends(self.left, -1, t)
        width = left.tip_angle - right.tip_angle
        if (width <= 0.0).any():
            k = int(np.argmin(width))
            raise TrimError("pointed", float(t[k]), "the tooth is pointed")
        if (self.pitch_angle - left.root_angle + right.root_angle < -1e-12).any():
            raise TrimError("root", float(t[0]), "the fillets of neighbouring teeth overlap")
        return Sections(t, stations, right, left)

    def grid(self, region: str, s: ArrayLike, sections: Sections) -> Grid:
        """Exact points and normals of one link at s (S,), or s (S, T), by the sections' stations (T,)."""
        s = np.asarray(s, dtype=float)
        s = s[:, None] if s.ndim == 1 else s
        if region in ("root", "land"):
            return self._land(region, s, sections)
        ends = sections.right if region.endswith("right") else sections.left
        if region.startswith("edge"):
            assert ends.edge is not None
            assert self.tip_edge is not None
            return Grid(*self.tip_edge.drawn(ends.edge, s if region == "edge_right" else 1.0 - s))
        return self._generated(region, s, ends, sections.stations)

    def _generated(self, region: str, s: Array, ends: Ends, stations: Array) -> Grid:
        """Exact grid of a flank or fillet between its ends, s (S, 1)."""
        side = self.right if region.endswith("right") else self.left
        surface = side.flank if region.startswith("flank") else side.fillet
        first, last = self._span(region, ends)
        p = first + s * (last - first)
        v, jet = along(surface, p, stations, self.blank.axial)
        return Grid(jet.r, jet.n, jet, p, v)

    def surface(self, region: str) -> Surface | None:
        """The exact surface of a link, None for a broken edge (which is drawn, not generated)."""
        if region == "land":
            return ConeSurface(self.blank.tip.radius, self.blank.tip.slope)
        if region == "root":
            return ConeSurface(self.blank.root.radius, self.blank.root.slope)
        if region.startswith("edge"):
            return None
        side = self.right if region.endswith("right") else self.left
        return side.flank if region.startswith("flank") else side.fillet

    def flank_grid(self, side: str, s: ArrayLike, t: ArrayLike) -> Grid:
        """Exact grid (S, T) of the trimmed flank "right" or "left", s from joint to tip on both; the other side is not asked."""
        t, s = np.atleast_1d(np.asarray(t, dtype=float)), np.asarray(s, dtype=float)[:, None]
        right = side == "right"
        ends = self._ends(self.right if right else self.left, 1 if right else -1, t, root=False)
        return self._generated(f"flank_{side}", s if right else 1.0 - s, ends, self.stations(t))

    def volume(self, order: int = 24) -> float:
        """Volume (mm^3) of all teeth and the body, by Gauss quadrature of exact section areas.

        A section is a cone (or plane) of a constant station down to the axis; its area is that of its projection along
        the axis over the station's slope dg/dz. What the body leaves out of these full sections is a solid of revolution.
        """
        nodes, weights = np.polynomial.legendre.leggauss(order)
        nodes, weights = 0.5 * (nodes + 1.0), 0.5 * weights
        sections = self.sections(nodes)
        area = np.zeros(order)
        for region in self.regions:
            area += weights @ self._area_density(region, nodes, sections)
        (toe, heel), axial = self.blank.extent, self.blank.axial
        # stations are linear in rho and z
        slope = float(axial.gradient(np.array([1.0, 0.0, 0.0]))[2])
        on_axis = [(station - float(axial.value(np.zeros(3)))) / slope for station in (toe, heel)]
        full = (heel - toe) * self.teeth * (weights @ area) / slope
        return float(full - _revolved(np.array([(0.0, on_axis[0]), *self.blank.body, (0.0, on_axis[1])])))

    def _area_density(self, region: str, s: Array, sections: Sections) -> Array:
        """(x dy/ds - y dx/ds) / 2 on an (S, T) grid."""
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
        return 0.5 * (grid.points[..., 0] * along_s[..., 1] - grid.points[..., 1] * along_s[..., 0])

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
        else:
            span = np.full_like(ends.joint_fillet, side.root), ends.joint_fillet
        return span if region.endswith("right") else span[::-1]

    def _land(self, region: str, s: Array, sections: Sections) -> Grid:
        first, last = self._span(region, None, sections)
        surface = self.surface(region)
        assert surface is not None
        angle = first + s * (last - first)
        v, jet = along(surface, angle, sections.stations, self.blank.axial, sections.stations)
        return Grid(jet.r, jet.n, jet, angle, v)

    def _ends(self, side: Side, sign: int, t: Array, *, root: bool = True) -> Ends:
        """Where the links of one side end; without `root` the root's angle is left out (NaN)."""
        stations = self.stations(t)
        tip, tip_jet = self._tip(side, stations, t)
        tip_point = tip_jet.r
        joint_flank, joint_fillet = self._joint(side, tip, tip_jet, stations, t)
        root_angle = np.full_like(stations, np.nan)
        if root:
            root_angle = _angle(along(side.fillet, np.full_like(stations, side.root), stations, self.blank.axial)[1].r)
        edge = None
        if self.tip_edge is not None:
            tip, edge = self.tip_edge.between(side.flank, self.blank.tip, sign, (joint_flank, tip), stations)
            tip_point = edge[1]
        return Ends(joint_flank, joint_fillet, tip, _angle(tip_point), root_angle, edge)

    def _tip(self, side: Side, stations: Array, t: Array) -> tuple[Array, Jet]:
        """Flank parameter p (T,) and the flank's jet on the tip cone at each station."""
        axial, tip = self.blank.axial, self.blank.tip

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
        return found.x[:, 0], side.flank.jet(found.x[:, 0], found.x[:, 1])

    def _joint(self, side: Side, tip: Array, tip_jet: Jet, stations: Array, t: Array) -> tuple[Array, Array]:
        """Parameters (T,) of flank and fillet where they meet: the tool's joint, or their intersection if undercut."""
        p = np.full_like(stations, side.joint[0])
        q = np.full_like(stations, side.joint[1])
        cut = self._undercut(side, t, tip_jet)
        if cut.any():
            p[cut], q[cut] = self._intersect(side, tip[cut], stations[cut], t[cut])
        return p, q

    def _undercut(self, side: Side, t: Array, tip: Jet | None = None) -> NDArray[np.bool_]:
        """Stations (T,) where the flank at the tool's joint is turned inside out: the fillet has cut it off.

        `tip`: the flank's jet at the tip, if known.
        """
        stations = self.stations(t)
        joint, near_tip = np.full_like(stations, side.joint[0]), np.full_like(stations, side.tip)
        lost = along(side.flank, joint, stations, self.blank.axial)[1]
        sound = along(side.flank, near_tip, stations, self.blank.axial)[1] if tip is None else tip
        return dot(area_normal(lost), lost.n) * dot(area_normal(sound), sound.n) <= 0.0

    def _intersect(self, side: Side, tip: Array, stations: Array, t: Array) -> tuple[Array, Array]:
        """Flank and fillet parameters (T,) of the intersection curve flank x fillet at each station."""
        axial = self.blank.axial
        start = self._intersection_start(side, tip, stations, t)

        def residual(x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
            flank, fillet = side.flank.jet(x[:, 0], x[:, 1]), side.fillet.jet(x[:, 2], x[:, 3])
            gradient = axial.gradient(flank.r)
            f = np.concatenate((flank.r - fillet.r, (axial.value(flank.r) - stations[index])[:, None]), axis=-1)
            jacobian = np.zeros((x.shape[0], 4, 4))
            jacobian[:, :3, 0], jacobian[:, :3, 1] = flank.r_u, flank.r_v
            jacobian[:, :3, 2], jacobian[:, :3, 3] = -fillet.r_u, -fillet.r_v
            jacobian[:, 3, 0], jacobian[:, 3, 1] = dot(gradient, flank.r_u), dot(gradient, flank.r_v)
            return f, jacobian

        found = newton.solve(residual, start, tolerance=TRIM_TOLERANCE)
        if not found.converged.all():
            k = int(np.argmin(found.converged))
            raise TrimError(
                "undercut", float(t[k]), "flank and fillet do not intersect: the undercut removes the flank"
            )
        return found.x[:, 0], found.x[:, 2]

    def _intersection_start(self, side: Side, tip: Array, stations: Array, t: Array, count: int = 300) -> Array:
        """Start values (T, 4) from sampled sections: where the polar angles of flank and fillet cross, over the height.

        The sound branch of the flank begins at its cusp, the branch beyond leads back up to the joint, where the
        fillet starts downwards; samples crowd towards cusp and joint because the loop between them may be tiny.
        """
        crowded = np.linspace(0.0, 1.0, count)[:, None] ** 4
        cusp = self._cusp(side, tip, stations)
        p = cusp + crowded * (tip - cusp)
        q = side.joint[1] + crowded[::-1] * (side.root - side.joint[1])
        v, flank = along(side.flank, p, stations, self.blank.axial)
        w, fillet = along(side.fillet, np.broadcast_to(q, p.shape), stations, self.blank.axial)
        rho, rho_fillet = (self.blank.root.value(jet.r) for jet in (flank, fillet))
        angle, angle_fillet = _angle(flank.r), _angle(fillet.r)
        start = np.empty((stations.size, 4))
        for k in range(stations.size):
            radius = np.linspace(rho[0, k], min(rho[-1, k], rho_fillet[-1, k]), count)[1:-1]
            apart = np.interp(radius, rho[:, k], angle[:, k]) - np.interp(radius, rho_fillet[:, k], angle_fillet[:, k])
            crossing = np.flatnonzero(apart[:-1] * apart[1:] <= 0.0)
            if radius[-1] <= radius[0] or crossing.size == 0:
                raise TrimError(
                    "undercut", float(t[k]), "flank and fillet do not intersect: the undercut removes the flank"
                )
            at = radius[crossing[-1]]
            start[k, :2] = np.interp(at, rho[:, k], p[:, k]), np.interp(at, rho[:, k], v[:, k])
            start[k, 2:] = np.interp(at, rho_fillet[:, k], q[:, 0]), np.interp(at, rho_fillet[:, k], w[:, k])
        return start

    def _cusp(self, side: Side, tip: Array, stations: Array) -> Array:
        """Flank parameter (T,) of the singular point between joint and tip, just on the sound side of it."""
        lost = np.full_like(tip, side.joint[0])

        def area(p: Array, at: Array) -> Array:
            jet = along(side.flank, p, at, self.blank.axial)[1]
            return dot(area_normal(jet), jet.n)

        found = find_root(area, (lost, tip), args=(stations,), tolerances={"xrtol": 1e-12})
        sound = np.sign(found.f_bracket[0]) == np.sign(area(tip, stations))
        return np.where(sound, found.bracket[0], found.bracket[1])


def _revolved(profile: Array) -> float:
    """Volume between a profile (K, 2) of points (rho, z) and the axis, cone frustum by frustum; signed by the sense of z."""
    rho, rise = profile[:, 0], np.diff(profile[:, 1])
    return float(np.pi / 3.0 * (rise @ (rho[1:] ** 2 + rho[1:] * rho[:-1] + rho[:-1] ** 2)))


def _angle(r: Array) -> Array:
    return np.arctan2(r[..., 1], r[..., 0])
