"""Triangulated teeth to a stated tolerance: the largest distance between facets and exact surface, in mm.

Every link of the section chain (see `tooth`) becomes a grid of n_s x n_t cells; n_t and its nodes are common to all
links, n_s and its nodes are the link's own. With the second form L ds^2 + 2 M ds dt + N dt^2 of a link, a cell
ds x dt cut along its better diagonal misses the surface by an eighth of the largest of

    |L| ds^2,   |N| dt^2,   |L ds^2 - 2 |M| ds dt + N dt^2|,

so given dt the widest ds follows in closed form, and the n_t with the fewest triangles is taken. On developable
flanks the diagonals then follow the rulings by themselves. At toe and heel the chords are the edges of the end faces: there
it is the distance from the section curve itself that counts, which is larger than that from the surface where end face
and surface meet at an acute angle (on a worm's thread more than twice as large). What this predicts is then measured
between the vertices and mended where the prediction (which is of second order) was too bold.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.algebra import Array, dot
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.section import GeneratedLink, Grid, Sections
from gearmesh.teeth.tooth import Tooth

#: points per link on which second forms are sampled, across and along
SAMPLES = (25, 9)
#: sampled deviations may reach this share of the tolerance: between the samples it is a little larger
SAFETY = 0.97
#: rounds of measuring and mending; each halves a cell at most, the usual number is 1 or 2
ROUNDS = 12
#: below this (mm) a deviation is rounding
FLOOR = 1e-9


@dataclass(frozen=True)
class PatchMesh:
    """One link's grid: exact points (S+1, T+1, 3), diagonals and, for each cell's two triangles, the exact normals.

    `rising` (S, T): the cell is cut from (i, j) to (i+1, j+1), else from (i+1, j) to (i, j+1).
    `normals` (S, T, 2, 3) at the triangles' centres. `deviation` is the largest measured distance, mm.
    """

    region: Region
    s: Array
    points: Array
    rising: NDArray[np.bool_]
    normals: Array
    deviation: float


@dataclass(frozen=True)
class ToothMesh:
    """The links of one tooth at common stations t (T+1,), and the tolerance (mm) they were made to."""

    tooth: Tooth
    t: Array
    patches: tuple[PatchMesh, ...]
    tolerance: float

    @property
    def deviation(self) -> float:
        """Largest measured distance between facets and surface, mm."""
        return max(patch.deviation for patch in self.patches)


@dataclass(frozen=True)
class _Forms:
    """Second forms of all links (R, S, T) on uniform samples of s and of tau, the graded station parameter.

    `outline` (R, S): as `length`, of the section curves at toe and heel in space, the larger one.
    """

    length: Array
    twist: Array
    face: Array
    outline: Array
    t_of_tau: Array


def tessellate(tooth: Tooth, tolerance: float, regions: tuple[Region, ...] | None = None) -> ToothMesh:
    """Mesh one tooth (or only some links of it) within `tolerance` (mm) of its exact surfaces.

    Raises TrimError where the tooth cannot be trimmed.
    """
    regions = regions or tooth.regions
    forms = _second_forms(tooth, regions)
    allowed = SAFETY * tolerance
    count, density = _cheapest(forms, SAFETY * allowed, tolerance)
    for _ in range(ROUNDS):
        t = _station_nodes(count, forms.t_of_tau, tooth.breaks)
        patches, along_face, refined = _measure_all(tooth, regions, t, density, allowed)
        if along_face <= allowed and not refined:
            break
        count = int(np.ceil(count * min(2.0, max(1.0, 1.02 * np.sqrt(along_face / allowed)))))
    return ToothMesh(tooth, t, patches, tolerance)


def _station_nodes(count: int, t_of_tau: Array, breaks: Array) -> Array:
    """About `count` cells along the face, evenly over tau between the stations that must be nodes."""
    tau = np.linspace(0.0, 1.0, t_of_tau.size)
    fixed = np.concatenate(([0.0], np.interp(breaks, t_of_tau, tau), [1.0]))
    cells = np.maximum(1, np.ceil(count * np.diff(fixed) - 1e-9).astype(int))
    spans = zip(fixed[:-1], fixed[1:], cells, strict=True)
    t = np.interp(np.concatenate([np.linspace(a, b, n + 1)[:-1] for a, b, n in spans] + [[1.0]]), tau, t_of_tau)
    t[np.cumsum(cells)[:-1]] = breaks
    found: Array = t
    return found


def _second_forms(tooth: Tooth, regions: tuple[Region, ...]) -> _Forms:
    s, t = np.linspace(0.0, 1.0, SAMPLES[0]), np.linspace(0.0, 1.0, SAMPLES[1])
    sections = tooth.sections(t)
    grids = [tooth.grid(region, s, sections) for region in regions]
    points, normals = np.stack([g.points for g in grids]), np.stack([g.normals for g in grids])
    ds, dt = s[1], t[1]
    length, face, twist = (np.zeros(points.shape[:3]) for _ in range(3))
    length[:, 1:-1] = dot(normals[:, 1:-1], np.diff(points, 2, axis=1)) / ds**2
    face[:, :, 1:-1] = dot(normals[:, :, 1:-1], np.diff(points, 2, axis=2)) / dt**2
    corners = points[:, 2:, 2:] - points[:, 2:, :-2] - points[:, :-2, 2:] + points[:, :-2, :-2]
    twist[:, 1:-1, 1:-1] = dot(normals[:, 1:-1, 1:-1], corners) / (4.0 * ds * dt)
    for form in (length, face, twist):
        form[:, 0], form[:, -1] = form[:, 1], form[:, -2]
        form[:, :, 0], form[:, :, -1] = form[:, :, 1], form[:, :, -2]
    return _graded(length, twist, face, _outline(points[:, :, [0, -1]], s), t)


def _outline(curves: Array, s: Array) -> Array:
    """Second derivatives (R, S) of section curves (R, S, 2, 3) by s, across the curve; the larger one of both ends."""
    along = curves[:, 2:] - curves[:, :-2]
    bent = np.diff(curves, 2, axis=1) / s[1] ** 2
    length = dot(along, along)
    share = np.divide(dot(bent, along), length, out=np.zeros_like(length), where=length > 0.0)
    across = bent - share[..., None] * along
    return np.pad(np.sqrt(dot(across, across)).max(axis=-1), ((0, 0), (1, 1)), mode="edge")


def _graded(length: Array, twist: Array, face: Array, outline: Array, t: Array) -> _Forms:
    """Station parameter tau with cells along the face in proportion to 1 / sqrt(N): forms with respect to it."""
    need = np.sqrt(np.abs(face).max(axis=(0, 1)))
    need = np.maximum(need, 0.25 * need.max()) if need.max() > 0.0 else np.ones_like(need)
    total = np.concatenate(([0.0], np.cumsum(0.5 * (need[1:] + need[:-1]))))
    total /= total[-1]
    uniform = np.linspace(0.0, 1.0, t.size)
    t_of_tau = np.interp(uniform, total, t)
    speed = np.gradient(t_of_tau, uniform)
    return _Forms(length, twist * speed, face * speed**2, outline, t_of_tau)


def _cheapest(forms: _Forms, tolerance: float, at_ends: float) -> tuple[int, list[tuple[Array, Array]]]:
    """Number of cells along the face with the fewest triangles, and each link's cells per unit of s, over s.

    `at_ends`: tolerance (mm) of the outline of the end faces.
    """
    least = max(1, int(np.ceil(np.sqrt(np.abs(forms.face).max() / (8.0 * tolerance)))))
    counts = np.unique(np.round(least * np.geomspace(1.0, 16.0, 25)).astype(int))
    wide = _widest(forms, 1.0 / counts[:, None, None, None], tolerance).min(axis=-1)
    per_unit = np.maximum(1.0 / wide, np.sqrt(forms.outline / (8.0 * at_ends)))
    s = np.linspace(0.0, 1.0, per_unit.shape[-1])
    cells = np.maximum(np.ceil(np.trapezoid(per_unit, s, axis=-1)), 1.0).sum(axis=-1)
    best = int(np.argmin((counts + 1.0) * cells))
    return int(counts[best]), [(s, density) for density in per_unit[best]]


def _widest(forms: _Forms, dt: Array, tolerance: float) -> Array:
    """Widest ds for cells of height dt, from the condition on the edge along s and on the better diagonal.

    L is made positive by turning the normal; then L ds^2 - 2 |M| dt ds + N dt^2 must lie within +-8 tolerance.
    """
    limit = 8.0 * tolerance
    sign = np.where(forms.length < 0.0, -1.0, 1.0)
    length = np.maximum(np.abs(forms.length), limit * 1e-6)
    half = np.abs(forms.twist) * dt
    rest = sign * forms.face * dt**2
    upper = (half + np.sqrt(np.maximum(half**2 - length * (rest - limit), 0.0))) / length
    dips = half**2 - length * (rest + limit)
    lower = (half - np.sqrt(np.maximum(dips, 0.0))) / length
    ds = np.where((dips > 0.0) & (lower > 0.0), lower, upper)
    return np.clip(np.minimum(ds, np.sqrt(limit / length)), 1e-5, 1e3)


def _measure_all(
    tooth: Tooth, regions: tuple[Region, ...], t: Array, density: list[tuple[Array, Array]], tolerance: float
) -> tuple[tuple[PatchMesh, ...], float, bool]:
    """Mesh every link at stations t, measure, and raise `density` in place where a cell misses by too much.

    Returns the meshes, the largest deviation of edges along the face, and whether any density was raised.
    """
    halves, thirds = _between(t, HALVES), _between(t, THIRDS)
    together = tooth.sections(np.concatenate((halves, thirds)))
    stations = [together[: halves.size], together[halves.size :]]
    patches, along_face, refined = [], 0.0, False
    for k, region in enumerate(regions):
        s = _nodes(*density[k])
        patch, edge, cells = _measure(tooth, region, s, t, stations)
        patches.append(patch)
        link = tooth.chain[region]
        if region.is_flank and isinstance(link, GeneratedLink):
            edge = max(edge, _joint_miss(tooth, link, stations))
        along_face = max(along_face, edge)
        if edge <= tolerance and (cells > tolerance).any():
            refined = True
            density[k] = _denser(s, cells, tolerance)
    return tuple(patches), along_face, refined


def _joint_miss(tooth: Tooth, flank: GeneratedLink, stations: list[Sections]) -> float:
    """Largest distance (mm) of the chords between stations from the joint with the fillet, where that is a sharp edge.

    Where flank and fillet pass into each other smoothly, the chord may lie beside the joint: both surfaces are near it.
    """
    start = [0.0 if flank.side is Side.RIGHT else 1.0]
    nodes = flank.grid(start, stations[0]).points[0, ::2]
    chord = np.diff(nodes, axis=0)
    worst = 0.0
    for sections, inner, each in ((stations[0], np.s_[1::2], 1), (stations[1], np.s_[:], 2)):
        sharp = (sections.of(flank.side).joint_flank != tooth.side(flank.side).joint[0])[inner]
        away = flank.grid(start, sections).points[0, inner] - np.repeat(nodes[:-1], each, axis=0)
        along_chord = np.repeat(chord, each, axis=0)
        off = away - (dot(away, along_chord) / dot(along_chord, along_chord))[:, None] * along_chord
        worst = max(worst, float(np.sqrt(dot(off, off)[sharp].max(initial=0.0))))
    return worst


HALVES = (0.0, 0.5)
THIRDS = (1.0 / 3.0, 2.0 / 3.0)


def _between(nodes: Array, fractions: tuple[float, ...]) -> Array:
    """Points at the fractions of every interval; with fraction 0 the last node is included."""
    steps = nodes[:-1, None] + np.diff(nodes)[:, None] * np.array(fractions)
    points = steps.ravel()
    return np.append(points, nodes[-1]) if fractions[0] == 0.0 else points


def _nodes(s: Array, per_unit: Array) -> Array:
    """Nodes from 0 to 1 with the given number of cells per unit of s (piecewise linear over s)."""
    total = np.concatenate(([0.0], np.cumsum(0.5 * (per_unit[1:] + per_unit[:-1]) * np.diff(s))))
    count = max(1, int(np.ceil(total[-1] - 1e-9)))
    nodes = np.interp(np.linspace(0.0, total[-1], count + 1), total, s)
    nodes[0], nodes[-1] = 0.0, 1.0
    return nodes


def _denser(s: Array, cells: Array, tolerance: float) -> tuple[Array, Array]:
    """Density over s that splits the cells which miss the tolerance and leaves the others as they are."""
    width = np.diff(s)
    factor = np.where(cells > tolerance, np.clip(1.03 * np.sqrt(cells / tolerance), 1.03, 2.0), 1.0)
    # a step function: two samples for each cell, a hair inside its ends
    inside = np.stack((s[:-1] + 1e-9 * width, s[1:] - 1e-9 * width), axis=-1).ravel()
    per_unit = np.repeat(factor / width, 2)
    inside[0], inside[-1] = 0.0, 1.0
    return inside, per_unit


def _measure(
    tooth: Tooth, region: Region, s: Array, t: Array, stations: list[Sections]
) -> tuple[PatchMesh, float, Array]:
    """Patch mesh, largest deviation of edges along the face, and largest deviation (S,) of the cells between s nodes."""
    fine = tooth.grid(region, _between(s, HALVES), stations[0])
    points = fine.points[::2, ::2]
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    across = np.abs(_distance(fine, np.s_[1::2, ::2], 0.5 * (points[1:] + points[:-1])))
    along = np.abs(_distance(fine, np.s_[::2, 1::2], 0.5 * (points[:, 1:] + points[:, :-1])))
    up = np.abs(_distance(fine, np.s_[1::2, 1::2], 0.5 * (a + c)))
    down = np.abs(_distance(fine, np.s_[1::2, 1::2], 0.5 * (b + d)))
    rising = up <= down
    centres = tooth.grid(region, _between(s, THIRDS), stations[1])
    first, second, where = _centroids(a, b, c, d, rising)
    cells = np.minimum(up, down)
    normals = np.empty((*rising.shape, 2, 3))
    for which, (centroid, (i, j)) in enumerate(zip((first, second), where, strict=True)):
        at = (i, j)
        cells = np.maximum(cells, np.abs(_distance(centres, at, centroid)))
        normals[:, :, which] = centres.normals[at]
    cells = np.maximum(cells, np.maximum(across[:, 1:], across[:, :-1])).max(axis=1)
    outline = _off_outline(fine.points[:, [0, -1]])
    cells = np.maximum(cells, SAFETY * outline)
    edge = float(along.max())
    deviation = max(edge, float(cells.max()), float(outline.max()))
    return PatchMesh(region, s, points, rising, normals, deviation), edge, np.maximum(cells, FLOOR)


def _off_outline(curves: Array) -> Array:
    """Largest distance (S,), mm, of the chords from the section curves (2 S + 1, 2, 3) at toe and heel, in their middles."""
    nodes = curves[::2]
    chord, away = np.diff(nodes, axis=0), curves[1::2] - nodes[:-1]
    length = dot(chord, chord)
    share = np.divide(dot(away, chord), length, out=np.zeros_like(length), where=length > 0.0)
    off = away - share[..., None] * chord
    found: Array = np.sqrt(dot(off, off).max(axis=1))
    return found


def _centroids(
    a: Array, b: Array, c: Array, d: Array, rising: NDArray[np.bool_]
) -> tuple[Array, Array, list[tuple[NDArray[np.intp], NDArray[np.intp]]]]:
    """Centroids (S, T, 3) of both triangles of each cell and their places on the grid of thirds.

    Rising cells are cut into a b c and a c d, with centroids at (2/3, 1/3) and (1/3, 2/3) of the cell, the others into
    a b d and b c d, at (1/3, 1/3) and (2/3, 2/3).
    """
    up = rising[..., None]
    first = np.where(up, a + b + c, a + b + d) / 3.0
    second = np.where(up, a + c + d, b + c + d) / 3.0
    i, j = np.meshgrid(2 * np.arange(rising.shape[0]), 2 * np.arange(rising.shape[1]), indexing="ij")
    return first, second, [(i + rising, j), (i + ~rising, j + 1)]


def _distance(grid: Grid, at: Any, q: Array) -> Array:
    """Signed distance (...,) of facet points q from the surface near the grid points `at`.

    n . d less the height of the surface over its tangent plane at the foot of d, which is of the same order where the
    facet point lies beside the grid point along the surface.
    """
    away = q - grid.points[at]
    normal = grid.normals[at]
    height = dot(normal, away)
    if grid.jet is None:
        return height
    r_u, r_v, n_u, n_v = (getattr(grid.jet, name)[at] for name in ("r_u", "r_v", "n_u", "n_v"))
    uu, uv, vv = dot(r_u, r_u), dot(r_u, r_v), dot(r_v, r_v)
    with np.errstate(invalid="ignore", divide="ignore"):
        area = uu * vv - uv**2
        du = (vv * dot(away, r_u) - uv * dot(away, r_v)) / area
        dv = (uu * dot(away, r_v) - uv * dot(away, r_u)) / area
        bulge = -0.5 * dot(n_u * du[..., None] + n_v * dv[..., None], r_u * du[..., None] + r_v * dv[..., None])
    # on a cusp of the surface the correction means nothing
    return height - np.where(np.abs(bulge) <= np.abs(height) + dot(away, away), bulge, 0.0)
