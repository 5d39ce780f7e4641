"""Teeth as B-spline patches: quintic tensor-product splines through exact points, refined to a stated deviation.

Every link of the section chain (see `tooth`) becomes a patch over (s, t), interpolated direction by direction at common
nodes. A spline that interpolates a grid is, on the grid's border, the spline through the border's points; neighbours
have these points, nodes and knots in common and so share their border curves exactly. Where undercut begins the joint
of flank and fillet has a corner in t: there every patch is split. The error falls with the sixth power of the spacing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import BSpline, make_interp_spline

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.algebra import Array
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Sections
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.train import Member

#: degree in both directions, and the fewest nodes it takes
DEGREE = 5
FEWEST = DEGREE + 1
#: largest deviation (mm) if none is asked for
TOLERANCE = 1e-4
#: places between neighbouring nodes, in both directions, at which the deviation is measured
BETWEEN = np.array([0.25, 0.5, 0.75])
#: how much closer nodes are at the ends of a patch: a spline without end conditions is worst there; on all samples grading
#: saves 33 % of the points at 0.1 um and 47 % at 0.01 um
GRADING = 0.7
#: nodes are added until each direction alone stays within this share of the tolerance
SHARE = 0.45
#: end curves keep this close (mm) to a conical end face, whatever the tolerance: CAD programs take points within 1e-7 mm for
#: the same and fit edges that are farther off anew, less exactly (read back, the volume was off by 1e-6 instead of 1e-8)
END_TOLERANCE = 3e-8
#: rounds of measuring and refining: 2 or 3 are usual; and most nodes in one direction: 67 reach a nanometre on all samples
ROUNDS = 12
MOST = 200
#: a link narrower than this (mm) all along the face, as the root between full fillets, is no face
NARROWEST = 1e-6


@dataclass(frozen=True)
class Patch:
    """One link between two breaks: control net (S, T, 3), mm, and knot vectors (S + 6,), (T + 6,) of a clamped spline.

    `s` (S,), `t` (T,) are the nodes; the spline is parametrised by the link's own s and t.
    """

    region: Region
    control: Array
    s: Array
    t: Array
    s_knots: Array
    t_knots: Array

    def at(self, s: Array, t: Array) -> Array:
        """Points (s.size, t.size, 3) of the spline."""
        return _evaluated(self.control, self.s_knots, self.t_knots, s, t)


@dataclass(frozen=True)
class SplineTooth:
    """One tooth's patches: `patches[link][segment]` along the chain and from toe to heel, split at `bounds` (G + 1,).

    `deviation` (mm) for each region: the largest distance, measured between the nodes, of spline points from the exact
    points of the same s and t, which bounds that of the surfaces and of their borders.
    """

    tooth: Tooth
    bounds: Array
    patches: tuple[tuple[Patch, ...], ...]
    deviation: dict[Region, float]


@dataclass(frozen=True)
class _Stations:
    """Nodes along each segment, these with the places between them, and the sections at all of the latter in order."""

    nodes: tuple[Array, ...]
    fine: tuple[Array, ...]
    sections: Sections

    @staticmethod
    def of(tooth: Tooth, bounds: Array, counts: tuple[int, ...]) -> _Stations:
        nodes = tuple(_graded(low, high, n) for low, high, n in zip(bounds[:-1], bounds[1:], counts, strict=True))
        fine = tuple(_with_between(t) for t in nodes)
        # neighbouring segments share the section between them
        return _Stations(nodes, fine, tooth.sections(np.concatenate([*(t[:-1] for t in fine), [1.0]])))


def spline_tooth(tooth: Tooth, tolerance: float = TOLERANCE) -> SplineTooth:
    """Patches of one tooth within `tolerance` (mm) of its exact surfaces.

    Raises TrimError where the tooth cannot be trimmed, NoSolutionError where the tolerance is not met.
    """
    bounds = np.concatenate(([0.0], tooth.breaks, [1.0]))
    along = (FEWEST + 1,) * (len(bounds) - 1)
    stations = _Stations.of(tooth, bounds, along)
    links = _links(tooth, stations.sections)
    across = (FEWEST + 1,) * len(links)
    for _ in range(ROUNDS):
        patches, misses = _interpolated(tooth, links, across, stations)
        if (misses[..., 0] <= tolerance).all() and (misses[..., 3] <= END_TOLERANCE).all():
            deviation = {link: float(miss) for link, miss in zip(links, misses[..., 0].max(axis=1), strict=True)}
            return SplineTooth(tooth, bounds, patches, deviation)
        excess = np.maximum(misses[..., 1] / (SHARE * tolerance), misses[..., 3] / END_TOLERANCE)
        more_across = _more(across, excess.max(axis=1))
        more_along = _more(along, misses[..., 2].max(axis=0) / (SHARE * tolerance))
        if (more_across, more_along) == (across, along):
            # each direction alone is fine and only both together are not
            more_along = tuple(n + 1 for n in along)
        if max(*more_across, *more_along) > MOST:
            break
        if more_along != along:
            stations = _Stations.of(tooth, bounds, more_along)
        across, along = more_across, more_along
    raise NoSolutionError(
        f"B-spline faces within {1e3 * tolerance:g} um: {1e3 * float(misses[..., 0].max()):.3g} um is what "
        f"{max(across)} x {max(along)} points reach; ask for a larger --tol"
    )


def exact_volume(member: Member) -> float:
    """Volume (mm^3) of a member with hub and keyway, from exact sections (`Tooth.volume`) and closed forms."""
    blank = member.tooth.blank
    bore, volume = blank.body.bore_radius, member.tooth.volume()
    low, high = blank.body.ends
    height = high - low
    if member.hub is not None:
        height += member.hub.length
        volume += np.pi * ((0.5 * member.hub.diameter) ** 2 - bore**2) * member.hub.length
    if member.keyway is not None:
        half = 0.5 * member.keyway.width
        # the slot from the axis on, less its part inside the bore
        inside = half * np.sqrt(bore**2 - half**2) + bore**2 * np.arcsin(half / bore)
        volume -= height * (member.keyway.width * (bore + member.keyway.depth) - inside)
    return float(volume)


def _links(tooth: Tooth, sections: Sections) -> tuple[Region, ...]:
    """The links of the chain that have a width."""
    ends = {region: tooth.grid(region, np.array([0.0, 1.0]), sections).points for region in tooth.regions}
    widths = {region: np.linalg.norm(points[1] - points[0], axis=-1).max() for region, points in ends.items()}
    return tuple(region for region in tooth.regions if widths[region] > NARROWEST)


def _interpolated(
    tooth: Tooth, links: tuple[Region, ...], across: tuple[int, ...], stations: _Stations
) -> tuple[tuple[tuple[Patch, ...], ...], Array]:
    """Patches with `across` nodes over each link, and their misses (L, G, 4), mm.

    These are the largest at all places, at those between nodes across only, along only, and off the end faces.
    """
    step = len(BETWEEN) + 1
    starts = np.cumsum([0, *(t.size - 1 for t in stations.fine)])
    patches, misses = [], np.zeros((len(links), len(stations.nodes), 4))
    for i, (link, count) in enumerate(zip(links, across, strict=True)):
        s = _graded(0.0, 1.0, count)
        s_fine = _with_between(s)
        exact = tooth.grid(link, s_fine, stations.sections).points
        segments = []
        for g, (t, t_fine) in enumerate(zip(stations.nodes, stations.fine, strict=True)):
            wanted = exact[:, starts[g] : starts[g] + t_fine.size]
            patch = _patch(link, wanted[::step, ::step], s, t)
            miss = np.linalg.norm(patch.at(s_fine, t_fine) - wanted, axis=-1)
            misses[i, g, :3] = miss.max(), miss[:, ::step].max(), miss[::step].max()
            segments.append(patch)
        for g, end, station in ((0, 0.0, tooth.blank.extent[0]), (-1, 1.0, tooth.blank.extent[1])):
            off = tooth.blank.axial.value(segments[g].at(s_fine, np.array([end]))) - station
            misses[i, g, 3] = max(misses[i, g, 3], np.abs(off).max())
        patches.append(tuple(segments))
    return tuple(patches), misses


def _patch(region: Region, points: Array, s: Array, t: Array) -> Patch:
    """The spline through points (S, T, 3) at nodes s, t."""
    across = make_interp_spline(s, points, k=DEGREE, axis=0)
    along = make_interp_spline(t, across.c, k=DEGREE, axis=1)
    return Patch(region, np.moveaxis(along.c, 0, 1), s, t, across.t, along.t)


def _evaluated(control: Array, s_knots: Array, t_knots: Array, s: Array, t: Array) -> Array:
    across = BSpline(s_knots, control, DEGREE, axis=0)(s)
    return np.asarray(BSpline(t_knots, across, DEGREE, axis=1)(t))


def _graded(low: float, high: float, count: int) -> Array:
    """Nodes from low to high, closer to each other at the ends."""
    even = np.linspace(0.0, 1.0, count)
    nodes = low + (high - low) * (even - GRADING * np.sin(2.0 * np.pi * even) / (2.0 * np.pi))
    nodes[0], nodes[-1] = low, high
    return nodes


def _with_between(nodes: Array) -> Array:
    """The nodes and the places between them, in order."""
    inner = nodes[:-1, None] + np.diff(nodes)[:, None] * np.array([0.0, *BETWEEN])
    return np.append(inner.ravel(), nodes[-1])


def _more(counts: tuple[int, ...], excess: Array) -> tuple[int, ...]:
    """Numbers of nodes that bring errors, as multiples of what is allowed, down to it: they go with the sixth power."""
    factor = np.clip(1.03 * np.maximum(excess, 1e-12) ** (1.0 / (DEGREE + 1)), 1.0, 2.0)
    wanted = np.where(
        excess > 1.0, np.maximum(np.ceil((np.array(counts) - 1) * factor) + 1, np.array(counts) + 1), counts
    )
    return tuple(int(n) for n in wanted)
